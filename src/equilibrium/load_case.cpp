#include "src/equilibrium/load_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/base/parse.h"
#include "src/base/rotations.h"
#include "src/base/say.h"
#include "src/base/time_text.h"
#include "src/equilibrium/times.h"
#include "src/joint/given_values.h"
#include "src/joint/placing.h"
#include "src/model/load_curve.h"

namespace dea {

namespace {

/// A model at one time of one step.
struct Instant {
  const JointModel& model;
  const Joint& joint;
  const Settings& settings;
  int step;
  double time;
};

double finite_value(const Instant& now, const Scaled& scaled, Origin origin) {
  const double v = value(now.model, scaled, now.time);
  if (std::abs(v) <= kLargestNumber) return v;
  throw fault_at(
      now.model, origin,
      fmt::format("its value at time {} is {:g}, expected at most 1e30 (load curve {}): mend the curve's points",
                  time_text(now.time), v,
                  scaled.controller >= 0 ? now.model.controllers[at(scaled.controller)].id : 0));
}

Vector3d finite_vector(const Instant& now, const Vector3d& v, int controller, Origin origin) {
  return v * finite_value(now, {1.0, controller}, origin);
}

// ---- motions -----------------------------------------------------------------------------------------------------

/// Which contacts, ligaments, cables and connectors act, and how hard they pull.
void set_connections(const Instant& now, LoadCase& c) {
  for (const ContactPair& pair : now.joint.contacts) c.contact_active.push_back(pair.acts(now.step));
  for (const Ligament& l : now.joint.ligaments) {
    c.ligament_active.push_back(l.acts(now.step));
    c.ligament_scale.push_back(l.acts(now.step) ? finite_value(now, l.scale, l.origin) : 0.0);
  }
  for (const Cable& cable : now.joint.cables)
    c.cable_force.push_back(cable.acts(now.step) ? finite_value(now, cable.force, cable.origin) : 0.0);
  for (const Connector& j : now.joint.connectors) {
    c.connector_active.push_back(j.acts(now.step));
    c.connector_value.push_back({});
    for (std::size_t k = 0; k < kDofs; ++k)
      if (j.acts(now.step) && j.motion[k] != RigidJoint::Motion::Held)
        c.connector_value.back()[k] = finite_value(now, j.value[k], j.origin);
  }
}

/// Where prescribed nodes move a bone that the user takes as rigid: they must not turn it.
void follow_nodes(const Instant& now, const Body& body, const NodeRows& nodes, BodyConditions& c) {
  if (nodes.motions.empty()) return;
  std::vector<double> of_motion, values;
  for (const GivenMotion& m : nodes.motions) of_motion.push_back(finite_value(now, m.value, m.origin));
  double largest = 0.0;
  for (const NodeRow& row : nodes.rows) {
    values.push_back(row.motion < 0 ? 0.0 : of_motion[at(row.motion)]);
    largest = std::max(largest, std::abs(values.back()));
  }
  const RowSpan span = span_of(nodes.rows, nodes.length, values);
  int held = 0;
  for (int k = 0; k < kDofs; ++k) held += span.holds(k);
  const double close = 1e-6 * largest;
  bool agree = nodes.agree && span.conditions == held && span.motion.tail<3>().norm() <= close;
  for (std::size_t i = 0; i < values.size(); ++i)
    agree = agree && std::abs(condition(nodes.rows[i], nodes.length).dot(span.motion) - values[i]) <= close;
  const GivenMotion& mover = nodes.motions.back();
  if (!agree)
    throw fault_at(
        now.model, mover.origin,
        fmt::format("prescribed displacement \"{}\": at time {} its nodes move bone \"{}\" otherwise than by one "
                    "translation along x, y or z, which DEA cannot follow; make the bone a rigid body of the model and "
                    "prescribe its motion",
                    mover.name, time_text(now.time), body.name));
  for (int k = 0; k < 3; ++k) {
    if (!span.holds(k)) continue;
    c.value[k] = span.motion[k];
    c.relative[at(k)] = nodes.relative[at(k)] == 1;
  }
}

/// The value of a dof that follows given motions.
void follow(const Instant& now, int dof, const BodyDof& given, BodyConditions& c) {
  const auto& materials = now.model.materials;
  const GivenMotion* before = nullptr;
  for (const GivenMotion& m : given.motions) {
    const double value = finite_value(now, m.value, m.origin), other = c.value[dof];
    if (before != nullptr && before->material != m.material &&
        !(std::abs(value - other) <= 1e-9 * std::max(std::abs(value), std::abs(other))))
      throw fault_at(now.model, m.origin,
                     say("\"{}\" and \"{}\" prescribe {} of materials \"{}\" and \"{}\" differently at time {} ({:.4g} "
                         "and {:.4g}), "
                         "but these share nodes and are one body here;",
                         before->name, m.name, kDofNames[dof], materials[at(before->material)].name,
                         materials[at(m.material)].name, time_text(now.time), other, value),
                     "take one out, or mesh the bones apart");
    for (const FixedDof& f : given.fixed)
      if (f.material != m.material && value != 0)
        throw fault_at(
            now.model, m.origin,
            say("\"{}\" prescribes {} of material \"{}\", and \"{}\" fixes it of \"{}\", but these share nodes "
                "and are one body here;",
                m.name, kDofNames[dof], materials[at(m.material)].name, f.name, materials[at(f.material)].name),
            "take one out, or mesh the bones apart");
    before = &m;
    c.value[dof] = value;
    c.relative[at(dof)] = m.from_step_start();
  }
}

/// What the model and the settings say of each body in this step.
std::vector<BodyHolds> holds_now(const Instant& now) {
  std::vector<BodyHolds> holds = now.joint.conditions.steps[at(now.step)];
  for (std::size_t b = 0; b < holds.size(); ++b)
    holds[b] = with_settings(std::move(holds[b]), now.model, now.joint.bodies, static_cast<int>(b), now.settings);
  return holds;
}

/// Which dofs are held, which follow a given motion, and which points stay.
void set_motions(const Instant& now, const std::vector<BodyHolds>& holds, LoadCase& c) {
  for (std::size_t b = 0; b < holds.size(); ++b) {
    BodyConditions& body = c.bodies[b];
    follow_nodes(now, now.joint.bodies[b], holds[b].nodes, body);
    for (int k = 0; k < kDofs; ++k) {
      body.dofs[at(k)] = holds[b].dofs[at(k)].state;
      follow(now, k, holds[b].dofs[at(k)], body);
    }
    const Pose& start = c.start[b];
    for (const NodeRow& row : holds[b].coupled)
      body.held_points.push_back(
          {row.component, row.arm, start.center[row.component] + (start.rotation * row.arm)[row.component]});
  }
}

/// Rotations of one body that FEBio does not take together. `turned`: the body that a table of motions turns instead of
/// the model; -1: none.
void refuse_rotations_in_part(const Instant& now, const LoadCase& c, int turned = -1) {
  const std::vector<BodyHolds>& holds = now.joint.conditions.steps[at(now.step)];
  for (std::size_t b = 0; b < c.bodies.size(); ++b) {
    const auto& dofs = c.bodies[b].dofs;
    const bool any = std::count(dofs.begin() + 3, dofs.end(), DofState::Prescribed) > 0;
    if (any && std::count(dofs.begin() + 3, dofs.end(), DofState::Free) > 0)
      throw fault_at(now.model, {0, 0},
                     say("body \"{}\": some rotations are prescribed and others free;", now.joint.bodies[b].name),
                     "FEBio and DEA need all three prescribed or fixed (a fixed one counts as 0)");
    if (!any) continue;
    std::array<bool, 3> relative = {};  // the flag alone, also outside steps, where it counts for nothing
    for (std::size_t k = 0; k < 3; ++k)
      relative[k] = !holds[b].dofs[3 + k].motions.empty() && holds[b].dofs[3 + k].motions.back().relative;
    const auto counted = std::count(relative.begin(), relative.end(), true);
    if (counted > 0 && counted < 3 && static_cast<int>(b) != turned)
      throw fault_at(
          now.model, {0, 0},
          say("body \"{}\": some rotations are prescribed as relative and others are not;", now.joint.bodies[b].name),
          "FEBio needs all three relative, or none (a fixed one is not: prescribe it as 0, relative too)");
  }
}

// ---- loads -------------------------------------------------------------------------------------------------------

/// How much of a step has passed, 0 to 1.
double passed(const Instant& now, int step) {
  const std::vector<double> starts = step_starts(now.model);
  const double duration = starts[at(step) + 1] - starts[at(step)];
  return duration > 0 ? std::clamp((now.time - starts[at(step)]) / duration, 0.0, 1.0) : 1.0;
}

/// FEBio notes the reaction when a load becomes active: outside steps that is before anything has been solved.
bool starts_at_reaction(const RigidLoad& l) {
  return l.step >= 0 && (l.kind == RigidLoad::Kind::Target || (l.kind == RigidLoad::Kind::Dead && l.relative));
}

/// Forces and moments on a rigid body. `replaced`: per body, the user gives another one of its kind.
void add_rigid_load(const Instant& now, const RigidLoad& l, const std::vector<char>& replaced,
                    const std::vector<Vector6>* reaction, LoadCase& c) {
  const int b = now.joint.body_of(l.material);
  if (!l.acts(now.step) || b < 0) return;
  if (replaced[at(b)]) return;
  BodyConditions& body = c.bodies[at(b)];
  Vector6& load = l.kind == RigidLoad::Kind::Follower ? body.follower : body.dead;
  Scaled value = l.value;
  if (l.dof < 3) value.factor = given_value(now.settings, l.name, kForce).value_or(value.factor);
  const double full = finite_value(now, value, l.origin);
  const bool on_reaction = starts_at_reaction(l);
  const double start = on_reaction && reaction ? (*reaction)[at(b)][l.dof] : 0.0;
  body.on_reaction = body.on_reaction || on_reaction;
  if (l.kind == RigidLoad::Kind::Target) {
    const double w = passed(now, now.step);
    load[l.dof] += (1 - w) * start + w * full;
  } else {
    load[l.dof] += full + start;
  }
}

/// Forces that turn with a body, and forces at nodes.
void add_point_forces(const Instant& now, const std::vector<char>& replaced, const std::vector<char>& moments_replaced,
                      LoadCase& c) {
  for (const RigidFollower& f : now.model.rigid_followers) {
    const int b = now.joint.body_of(f.material);
    if (!f.acts(now.step) || b < 0) continue;
    const Vector3d v = finite_vector(now, f.value, f.controller, f.origin);
    if (f.moment) {
      if (moments_replaced[at(b)]) continue;
      c.bodies[at(b)].follower.tail<3>() += v;
    } else if (!replaced[at(b)]) {
      const Vector3d arm = f.from_center ? f.insertion : Vector3d(f.insertion - now.joint.bodies[at(b)].center_of_mass);
      c.bodies[at(b)].point_forces.push_back({arm, v, true});
    }
  }
  for (const PointLoad& p : now.joint.point_loads) {
    if (!p.acts(now.step) || replaced[at(p.body)]) continue;
    c.bodies[at(p.body)].point_forces.push_back({p.point - now.joint.bodies[at(p.body)].center_of_mass,
                                                 finite_vector(now, p.value, p.controller, p.origin), false});
  }
}

}  // namespace

LoadPointFound find_load_point(const Joint& joint, int body, const LoadPoint& asked) {
  LoadPointFound found;
  found.point = asked.point;
  if (!asked.sphere_center) return found;
  const std::string& name = joint.bodies[at(body)].name;
  found.fit = articular_sphere(joint, body, {"load-at", name, "sphere-center"},
                               say("name the point: {}", NamedSetting{"load-at", name, "x,y,z"}));
  found.point = found.fit.center;
  found.fitted = true;
  return found;
}

namespace {

/// What the user's settings leave of the model's loads.
struct Replaced {
  std::vector<char> forces;   ///< per body
  std::vector<char> moments;  ///< per body
};

LoadCase model_load_case(const Instant& now, const Replaced& replaced, const std::vector<Vector6>* reaction) {
  const Joint& joint = now.joint;
  LoadCase c;
  c.time = now.time;
  c.step = now.step;
  c.start = starting_poses(now.model, joint, now.settings);
  c.bodies.resize(joint.bodies.size());
  set_connections(now, c);
  set_motions(now, holds_now(now), c);
  for (const RigidLoad& l : now.model.rigid_loads)
    add_rigid_load(now, l, l.dof < 3 ? replaced.forces : replaced.moments, reaction, c);
  add_point_forces(now, replaced.forces, replaced.moments, c);
  for (const auto& entry : now.settings.load_at) {
    const int b = joint.find_body(now.model, entry.first);
    c.bodies[at(b)].arm = find_load_point(joint, b, entry.second).point - joint.bodies[at(b)].center_of_mass;
  }
  return c;
}

Replaced replaced_by(const JointModel& model, const Joint& joint, const Settings& settings) {
  Replaced replaced{std::vector<char>(joint.bodies.size(), 0), std::vector<char>(joint.bodies.size(), 0)};
  for (const auto& entry : settings.force) replaced.forces[at(joint.find_body(model, entry.first))] = 1;
  return replaced;
}

/// Forces of the settings, growing over the last step.
void add_given_forces(const Instant& now, LoadCase& c) {
  const int last = static_cast<int>(now.model.steps.size()) - 1;
  if (now.step != last) return;
  for (const auto& entry : now.settings.force)
    c.bodies[at(now.joint.find_body(now.model, entry.first))].dead.head<3>() =
        passed(now, last) * global_force(now.settings, entry.first);
}

void add_row_loads(const Instant& now, int row, const std::vector<Pose>& poses, const std::vector<Pose>& step_start,
                   LoadCase& c) {
  const LoadTable& table = now.settings.loads;
  if (table.time.empty()) return;
  const int b = now.joint.find_body(now.model, table.body);
  BodyConditions& body = c.bodies[at(b)];
  Vector6 load = table.load[at(row)];
  if (table.frame.kind == TableFrame::Kind::Named) {
    const Eigen::Matrix3d own =
        frame_axes(now.settings, table.frame.frame, {"load-frame", "", "frame:" + table.frame.frame});
    load.head<3>() = own * load.head<3>();
    load.tail<3>() = own * load.tail<3>();
  }
  const int frame = table.frame.body.empty() ? -1 : now.joint.find_body(now.model, table.frame.body);
  if (frame == b) {
    body.follower += load;
    return;
  }
  Eigen::Matrix3d axes = table.frame.axes;
  if (frame >= 0) {
    const auto& dofs = c.bodies[at(frame)].dofs;
    if (std::count(dofs.begin() + 3, dofs.end(), DofState::Free) > 0)
      throw UsageError(Fault{.given = NamedSetting{"load-frame", "", table.frame.body},
                             .found = "this body is free to turn, and its axes with it, while balance is sought;",
                             .expected = "name the loaded body, one that is held, or three axes"});
    axes = prescribed_poses(now.joint, c, poses, step_start)[at(frame)].rotation;
  }
  body.dead.head<3>() += axes * load.head<3>();
  body.dead.tail<3>() += axes * load.tail<3>();
}

/// The row's pose as what FEBio prescribes: motion of the centre of mass, rotation vector, from the starting pose.
void set_row_motion(const Instant& now, int row, LoadCase& c) {
  const MotionTable& table = now.settings.motion;
  if (table.time.empty()) return;
  const int b = now.joint.find_body(now.model, table.body);
  const Vector3d& center = now.joint.bodies[at(b)].center_of_mass;
  const Pose& begin = c.start[at(b)];
  BodyConditions& body = c.bodies[at(b)];
  const int moved = table.turns ? kDofs : 3;  // of the others the model says what holds
  for (int k = 0; k < moved; ++k) {
    body.value[k] = table.motion[at(row)][k];
    body.relative[at(k)] = false;
    body.dofs[at(k)] = DofState::Prescribed;
  }
  const auto about = now.settings.rotate_about.find(table.body);
  const bool about_point = table.turns && about != now.settings.rotate_about.end();
  if (!table.about_origin && !about_point) return;
  const Vector3d arm = table.about_origin
                           ? Vector3d(-begin.center)
                           : begin.rotation * (turn_point(now.joint, b, about->second, table.body) - center);
  body.value.head<3>() += arm - rotation(body.value.tail<3>()) * arm;
}

}  // namespace

LoadCase make_load_case(const JointModel& model, const Joint& joint, const Settings& settings, int step, double time,
                        const std::vector<Vector6>* reaction) {
  const Instant now{model, joint, settings, step, time};
  LoadCase c = model_load_case(now, replaced_by(model, joint, settings), reaction);
  refuse_rotations_in_part(now, c);
  add_given_forces(now, c);
  return c;
}

std::vector<Pose> prescribed_poses(const Joint& joint, const LoadCase& load_case, const std::vector<Pose>& now,
                                   const std::vector<Pose>& step_start) {
  std::vector<Pose> poses = now;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const BodyConditions& c = load_case.bodies[b];
    const Pose& begin = load_case.start[b];
    for (int k = 0; k < 3; ++k) {
      if (c.dofs[at(k)] != DofState::Prescribed) continue;
      poses[b].center[k] = (c.relative[at(k)] ? step_start[b].center[k] : begin.center[k]) + c.value[k];
    }
    if (std::count(c.dofs.begin() + 3, c.dofs.end(), DofState::Prescribed) == 0) continue;
    // FEBio adds to the components of the vector that the body has turned by (FERigidPrescribedBC::Activate), whatever
    // its axis
    Vector3d before = rotation_vector(step_start[b].rotation * begin.rotation.transpose());
    for (int k = 0; k < 3; ++k)
      if (!c.relative[at(3 + k)]) before[k] = 0.0;
    poses[b].rotation = rotation(before + c.value.tail<3>()) * begin.rotation;
  }
  return poses;
}

bool any_starts_at_reaction(const JointModel& model) {
  return std::any_of(model.rigid_loads.begin(), model.rigid_loads.end(), starts_at_reaction);
}

bool motion_is_given(const LoadCase& load_case) {
  return load_case.connector_active.empty() &&
         std::all_of(load_case.bodies.begin(), load_case.bodies.end(), [](const BodyConditions& body) {
           return body.held_points.empty() && std::count(body.dofs.begin(), body.dofs.end(), DofState::Free) == 0;
         });
}

LoadCase make_row_case(const JointModel& model, const Joint& joint, const Settings& settings, int row,
                       const std::vector<Pose>& poses, const std::vector<Pose>& step_start,
                       const std::vector<Vector6>* reaction) {
  const int last = static_cast<int>(model.steps.size()) - 1;
  const Instant now{model, joint, settings, last, step_starts(model).back()};
  Replaced replaced = replaced_by(model, joint, settings);
  if (!settings.loads.time.empty()) {
    const std::size_t b = at(joint.find_body(model, settings.loads.body));
    replaced.forces[b] = replaced.moments[b] = 1;
  }
  LoadCase c = model_load_case(now, replaced, reaction);
  set_row_motion(now, row, c);
  refuse_rotations_in_part(now, c, settings.motion.turns ? joint.find_body(model, settings.motion.body) : -1);
  add_given_forces(now, c);
  add_row_loads(now, row, poses, step_start, c);
  c.time = row_time(settings, at(row));
  return c;
}

}  // namespace dea

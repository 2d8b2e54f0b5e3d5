#include "src/equilibrium/load_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "src/base/decompositions.h"
#include "src/base/error.h"
#include "src/base/numbers.h"
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
  bool acts(int condition_step) const { return condition_step < 0 || condition_step == step; }
};

double finite_value(const Instant& now, const Scaled& scaled, Origin origin) {
  const double v = value(now.model, scaled, now.time);
  if (std::isfinite(v)) return v;
  throw fault_at(
      now.model, origin,
      fmt::format("its value at time {} is no finite number (load curve {}): mend the curve's points",
                  time_text(now.time), scaled.controller >= 0 ? now.model.controllers[at(scaled.controller)].id : 0));
}

Vector3d finite_vector(const Instant& now, const Vector3d& v, int controller, Origin origin) {
  return v * finite_value(now, {1.0, controller}, origin);
}

// ---- bones held and moved by their nodes -------------------------------------------------------------------------

/// What fixed and prescribed nodes ask of a bone.
struct NodeRows {
  struct Row {
    int component;
    Vector3d arm;  // of the node, from the centre of mass
    double value;
  };
  std::vector<Row> rows;
  double length = 0.0;  // of the longest arm
  bool back = false;  // fixed later than moved or free: FEBio puts such nodes back to where they were in the reference
  const PrescribedNodes* mover = nullptr;      // the last that moves the bone; nullptr: none
  bool agree = true;                           // conditions on one component are all relative, or none is
  std::array<int, 3> relative = {-1, -1, -1};  // -1: nothing moves this component

  /// A row (e_k, d x e_k / length) of conditions on the bone's motion, d the node's arm; rotations times length.
  Vector6 condition(const Row& r) const {
    Vector6 row;
    row << Vector3d::Unit(r.component), r.arm.cross(Vector3d::Unit(r.component)) / (length > 0 ? length : 1.0);
    return row;
  }
};

NodeRows rows_of_nodes(const Instant& now, int body) {
  NodeRows found;
  const auto ours = [&](const std::vector<int>& nodes) {
    return std::any_of(nodes.begin(), nodes.end(), [&](int node) { return now.joint.node_body[at(node)] == body; });
  };
  const auto add = [&](const std::vector<int>& nodes, int component, double value) {
    bool any = false;
    for (int node : nodes) {
      if (now.joint.node_body[at(node)] != body) continue;
      found.rows.push_back({component, now.model.nodes[at(node)] - now.joint.bodies[at(body)].center_of_mass, value});
      found.length = std::max(found.length, found.rows.back().arm.norm());
      any = true;
    }
    return any;
  };
  for (const FixedNodes& f : now.model.fixed_nodes)
    for (int k = 0; k < 3; ++k)
      if (now.acts(f.step) && f.xyz[at(k)]) add(f.nodes, k, 0.0);
  found.back = std::any_of(now.model.fixed_nodes.begin(), now.model.fixed_nodes.end(),
                           [&](const FixedNodes& f) { return f.step > 0 && ours(f.nodes); });
  for (const PrescribedNodes& p : now.model.prescribed_nodes) {
    if (!now.acts(p.step)) {
      found.back = found.back || ours(p.nodes);
      continue;
    }
    if (!add(p.nodes, p.component, finite_value(now, p.value, p.origin))) continue;
    const int counts = p.relative && p.step >= 0;
    found.agree = found.agree && (found.relative[at(p.component)] < 0 || found.relative[at(p.component)] == counts);
    found.relative[at(p.component)] = counts;
    found.mover = &p;
  }
  return found;
}

/// The motions that rows of conditions leave a bone, by the eigenvectors of their Gram matrix.
struct BoneMotion {
  Vector6 motion = Vector6::Zero();     // the smallest that satisfies the conditions; rotations times length
  Vector6 free_part = Vector6::Zero();  // per dof: how much of its unit vector squared no condition sees
  int conditions = 0;                   // independent ones
  double largest = 0.0;                 // of the values
};

BoneMotion bone_motion(const NodeRows& nodes) {
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  Matrix6 gram = Matrix6::Zero();
  Vector6 right = Vector6::Zero();
  BoneMotion bone;
  for (const NodeRows::Row& r : nodes.rows) {
    const Vector6 row = nodes.condition(r);
    gram += row * row.transpose();
    right += row * r.value;
    bone.largest = std::max(bone.largest, std::abs(r.value));
  }
  const Eigenvalues eigen = symmetric_eigen(gram);
  const double least = 1e-8 * eigen.values[5];  // rounding is 1e-16, the smallest real lever squared far more
  for (int i = 0; i < 6; ++i) {
    if (eigen.values[i] <= least) {
      for (int dof = 0; dof < kDofs; ++dof) bone.free_part[dof] += std::pow(eigen.vectors(dof, i), 2);
      continue;
    }
    ++bone.conditions;
    bone.motion += eigen.vectors.col(i) * (eigen.vectors.col(i).dot(right) / eigen.values[i]);
  }
  return bone;
}

/// Does the user take some of the body as rigid? FEBio ignores fixed nodes of its own rigid bodies.
bool taken_as_rigid(const Instant& now, int body) {
  const std::vector<int>& materials = now.joint.bodies[at(body)].materials;
  return std::any_of(materials.begin(), materials.end(), [&](int m) { return !now.model.materials[at(m)].rigid; });
}

/// What fixed and prescribed nodes make of a bone that the user takes as rigid: every dof whose unit vector is in the
/// span of their conditions has no freedom left. Prescribed nodes must move the bone without turning it.
void hold_by_nodes(const Instant& now, int body, BodyConditions& conditions) {
  const Body& b = now.joint.bodies[at(body)];
  if (!taken_as_rigid(now, body)) return;
  const NodeRows nodes = rows_of_nodes(now, body);
  const BoneMotion bone = bone_motion(nodes);
  int dofs_held = 0;
  for (int dof = 0; dof < kDofs; ++dof) {
    if (bone.free_part[dof] >= 1e-6) continue;
    ++dofs_held;
    conditions.dofs[at(dof)] = DofState::Held;
    if (dof < 3 && (nodes.mover != nullptr || nodes.back)) {
      conditions.dofs[at(dof)] = DofState::Prescribed;
      conditions.value[dof] = bone.motion[dof];
      conditions.relative[at(dof)] = nodes.relative[at(dof)] == 1;
    }
  }
  if (nodes.mover == nullptr) return;
  const double close = 1e-6 * bone.largest;
  bool agree = nodes.agree && bone.conditions == dofs_held && bone.motion.tail<3>().norm() <= close;
  for (const NodeRows::Row& r : nodes.rows)
    agree = agree && std::abs(nodes.condition(r).dot(bone.motion) - r.value) <= close;
  if (!agree)
    throw fault_at(
        now.model, nodes.mover->origin,
        fmt::format("prescribed displacement \"{}\": at time {} its nodes move bone \"{}\" otherwise than by one "
                    "translation along x, y or z, which DEA cannot follow; make the bone a rigid body of the model and "
                    "prescribe its motion",
                    nodes.mover->name, time_text(now.time), b.name));
}

/// Per node: is it of elements that the user takes as rigid, and not of a rigid body of the model, whose fixed nodes
/// FEBio passes over?
std::vector<char> nodes_of_bone(const Instant& now, int body) {
  std::vector<char> bone(now.model.nodes.size(), 0);
  for (const Domain& d : now.model.domains) {
    if (d.material < 0 || now.joint.body_of(d.material) != body || now.model.materials[at(d.material)].rigid) continue;
    for (const int node : d.nodes) bone[at(node)] = 1;
  }
  for (const Domain& d : now.model.domains)
    if (d.material >= 0 && now.model.materials[at(d.material)].rigid)
      for (const int node : d.nodes) bone[at(node)] = 0;
  for (const RigidNodes& set : now.model.rigid_nodes)
    for (const int node : set.nodes) bone[at(node)] = 0;
  return bone;
}

/// Refuses fixed nodes that leave a bone a hinge, a pin or a guided end: they couple dofs, of which DEA would free all.
void refuse_coupled_holds(const Instant& now, int body, const BodyConditions& conditions) {
  const Body& b = now.joint.bodies[at(body)];
  const auto is_free = [](DofState dof) { return dof == DofState::Free; };
  if (std::none_of(conditions.dofs.begin(), conditions.dofs.end(), is_free) || now.model.fixed_nodes.empty()) return;
  const std::vector<char> bone = nodes_of_bone(now, body);
  for (const FixedNodes& f : now.model.fixed_nodes) {
    if (!now.acts(f.step)) continue;
    for (const int node : f.nodes) {
      if (!bone[at(node)]) continue;
      const Vector3d arm = now.model.nodes[at(node)] - b.center_of_mass;
      for (int k = 0; k < 3; ++k) {
        if (!f.xyz[at(k)]) continue;
        Vector6 row;
        row << Vector3d::Unit(k), arm.cross(Vector3d::Unit(k));
        for (int dof = 0; dof < kDofs; ++dof) {
          const double least = 1e-3 * (dof < 3 ? 1.0 : arm.norm());  // as little as hold_by_nodes takes for held
          if (!is_free(conditions.dofs[at(dof)]) || !(std::abs(row[dof]) > least)) continue;
          throw fault_at(
              now.model, f.origin,
              say("fixed nodes \"{}\" leave bone \"{}\", which is taken as rigid, motions at time {} that are no "
                  "translation along x, y or z and no rotation about them through its centre of mass (a hinge, a pin, "
                  "a guided end), which DEA cannot follow;",
                  f.name, b.name, time_text(now.time)),
              say("make it a rigid body of the model with a joint there, or name with {} the dofs that it is free in",
                  NamedSetting{"free", b.name, "DOFS"}));
        }
      }
    }
  }
}

// ---- motions -----------------------------------------------------------------------------------------------------

/// Which contacts, ligaments, cables and connectors act, and how hard they pull.
void set_connections(const Instant& now, LoadCase& c) {
  for (const ContactPair& pair : now.joint.contacts) c.contact_active.push_back(now.acts(pair.step));
  for (const Ligament& l : now.joint.ligaments) {
    c.ligament_active.push_back(now.acts(l.step));
    c.ligament_scale.push_back(now.acts(l.step) ? finite_value(now, l.scale, l.origin) : 0.0);
  }
  for (const Cable& cable : now.joint.cables)
    c.cable_force.push_back(now.acts(cable.step) ? finite_value(now, cable.force, cable.origin) : 0.0);
  for (const Connector& j : now.joint.connectors) {
    c.connector_active.push_back(now.acts(j.step));
    c.connector_value.push_back({});
    for (std::size_t k = 0; k < kDofs; ++k)
      if (now.acts(j.step) && j.motion[k] != RigidJoint::Motion::Held)
        c.connector_value.back()[k] = finite_value(now, j.value[k], j.origin);
  }
}

/// Bodies that the model leaves out, moved by the nodes they would carry.
void move_by_nodes(const Instant& now, const Body& body, BodyConditions& c) {
  if (!body.moved_by.empty()) c.dofs.fill(DofState::Held);
  for (int i : body.moved_by) {
    const PrescribedNodes& p = now.model.prescribed_nodes[at(i)];
    DofState& dof = c.dofs[at(p.component)];
    if (!now.acts(p.step)) {  // fixed in this step: at the reference position, wherever the nodes were before
      if (dof == DofState::Held) dof = DofState::Prescribed;
      continue;
    }
    dof = DofState::Prescribed;
    c.value[p.component] = finite_value(now, p.value, p.origin);
    c.relative[at(p.component)] = p.relative && p.step >= 0;
  }
}

/// Which dofs are held, which follow a given motion.
void set_motions(const Instant& now, LoadCase& c) {
  const Joint& joint = now.joint;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b)
    if (joint.bodies[b].ground) c.bodies[b].dofs.fill(DofState::Held);
  for (const RigidFixed& f : now.model.rigid_fixed) {
    const int b = joint.body_of(f.material);
    if (!now.acts(f.step) || b < 0) continue;
    for (std::size_t k = 0; k < kDofs; ++k)
      if (f.dofs[k]) c.bodies[at(b)].dofs[k] = DofState::Held;
  }
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    if (!joint.bodies[b].ground) hold_by_nodes(now, static_cast<int>(b), c.bodies[b]);
    move_by_nodes(now, joint.bodies[b], c.bodies[b]);
  }
  for (const auto& entry : now.settings.free) {
    const int b = joint.find_body(now.model, entry.first);
    for (std::size_t k = 0; k < kDofs; ++k)
      if (c.bodies[at(b)].dofs[k] != DofState::Prescribed)
        c.bodies[at(b)].dofs[k] = entry.second[k] ? DofState::Free : DofState::Held;
  }
  std::map<std::pair<int, int>, const RigidPrescribed*> before;  // of body and dof
  for (const RigidPrescribed& p : now.model.rigid_prescribed) {
    const int b = joint.body_of(p.material);
    if (!now.acts(p.step) || b < 0) continue;
    BodyConditions& body = c.bodies[at(b)];
    const double value = finite_value(now, p.value, p.origin);
    const RigidPrescribed*& other = before[{b, p.dof}];
    if (other != nullptr && other->material != p.material &&
        !(std::abs(value - body.value[p.dof]) <= 1e-9 * std::max(std::abs(value), std::abs(body.value[p.dof]))))
      throw fault_at(now.model, p.origin,
                     say("\"{}\" and \"{}\" prescribe {} of materials \"{}\" and \"{}\" differently at time {} ({:.4g} "
                         "and {:.4g}), "
                         "but these share nodes and are one body here;",
                         other->name, p.name, kDofNames[p.dof], now.model.materials[at(other->material)].name,
                         now.model.materials[at(p.material)].name, time_text(now.time), body.value[p.dof], value),
                     "take one out, or mesh the bones apart");
    for (const RigidFixed& f : now.model.rigid_fixed)
      if (f.material != p.material && value != 0 && now.acts(f.step) && joint.body_of(f.material) == b &&
          f.dofs[at(p.dof)])
        throw fault_at(
            now.model, p.origin,
            say("\"{}\" prescribes {} of material \"{}\", and \"{}\" fixes it of \"{}\", but these share nodes "
                "and are one body here;",
                p.name, kDofNames[p.dof], now.model.materials[at(p.material)].name, f.name,
                now.model.materials[at(f.material)].name),
            "take one out, or mesh the bones apart");
    other = &p;
    body.dofs[at(p.dof)] = DofState::Prescribed;
    body.value[p.dof] = value;
    // relative to the pose when it became active: outside steps that is the reference
    body.relative[at(p.dof)] = p.relative && p.step >= 0;
  }
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const auto is_b = [&](const std::string& name) {
      return !name.empty() && joint.find_body(now.model, name) == static_cast<int>(b);
    };
    const bool told =
        std::any_of(now.settings.free.begin(), now.settings.free.end(), [&](const auto& e) { return is_b(e.first); }) ||
        is_b(now.settings.motion.body);
    if (!told && taken_as_rigid(now, static_cast<int>(b))) refuse_coupled_holds(now, static_cast<int>(b), c.bodies[b]);
  }
}

/// Rotations of one body that FEBio does not take together. `turned`: the body that a table of motions turns instead of
/// the model; -1: none.
void refuse_rotations_in_part(const Instant& now, const LoadCase& c, int turned = -1) {
  for (std::size_t b = 0; b < c.bodies.size(); ++b) {
    const auto& dofs = c.bodies[b].dofs;
    const bool any = std::count(dofs.begin() + 3, dofs.end(), DofState::Prescribed) > 0;
    if (any && std::count(dofs.begin() + 3, dofs.end(), DofState::Free) > 0)
      throw fault_at(now.model, {0, 0},
                     say("body \"{}\": some rotations are prescribed and others free;", now.joint.bodies[b].name),
                     "FEBio and DEA need all three prescribed or fixed (a fixed one counts as 0)");
    if (!any) continue;
    std::array<bool, 3> relative = {};  // the flag alone, also outside steps, where it counts for nothing
    for (const RigidPrescribed& p : now.model.rigid_prescribed)
      if (p.dof >= 3 && now.acts(p.step) && now.joint.body_of(p.material) == static_cast<int>(b))
        relative[at(p.dof - 3)] = p.relative;
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

/// Forces and moments on a rigid body. `replaced`: per body, the user gives another one of its kind.
void add_rigid_load(const Instant& now, const RigidLoad& l, const std::vector<char>& replaced,
                    const std::vector<Vector6>* reaction, LoadCase& c) {
  const int b = now.joint.body_of(l.material);
  if (!now.acts(l.step) || b < 0) return;
  if (replaced[at(b)]) return;
  BodyConditions& body = c.bodies[at(b)];
  Vector6& load = l.kind == RigidLoad::Kind::Follower ? body.follower : body.dead;
  Scaled value = l.value;
  if (l.dof < 3) value.factor = given_value(now.settings, l.name, kForce).value_or(value.factor);
  const double full = finite_value(now, value, l.origin);
  // FEBio notes the reaction when a load becomes active: outside steps that is before anything has been solved
  const bool on_reaction = l.kind == RigidLoad::Kind::Target || (l.kind == RigidLoad::Kind::Dead && l.relative);
  const double start = on_reaction && l.step >= 0 && reaction ? (*reaction)[at(b)][l.dof] : 0.0;
  body.on_reaction = body.on_reaction || (on_reaction && l.step >= 0);
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
    if (!now.acts(f.step) || b < 0) continue;
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
    if (!now.acts(p.step) || replaced[at(p.body)]) continue;
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
  set_motions(now, c);
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
  if (table.turns && about != now.settings.rotate_about.end()) {
    const Vector3d arm = begin.rotation * (turn_point(now.joint, b, about->second, table.body) - center);
    body.value.head<3>() += arm - rotation(body.value.tail<3>()) * arm;
  }
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

#include <febiodea/equilibrium/conditions.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include <febiodea/base/error.h>
#include <febiodea/base/numbers.h>
#include <febiodea/base/say.h>
#include <febiodea/model/load_curve.h>

namespace dea {

namespace {

/// Two times that differ by rounding of n * step_size only.
bool same_time(double a, double b, double scale) { return std::abs(a - b) <= 1e-9 * std::max(scale, 1e-300); }

int body_of(const Joint& joint, int material) {
  for (std::size_t b = 0; b < joint.bodies.size(); ++b)
    for (int m : joint.bodies[b].materials)
      if (m == material) return static_cast<int>(b);
  return -1;
}

double finite_value(const JointModel& model, const Scaled& scaled, double time, Origin origin) {
  const double v = value(model, scaled, time);
  if (std::isfinite(v)) return v;
  throw fault_at(model, origin,
                 fmt::format("its value at time {:g} is no finite number (load curve {}): mend the curve's points",
                             time, scaled.controller >= 0 ? model.controllers[at(scaled.controller)].id : 0));
}

/// What fixed and prescribed nodes make of a bone that the user takes as rigid. Each is a row (e_k, d x e_k / length)
/// of conditions on its motion, d the node's arm: every dof whose unit vector is in their span has no freedom left.
/// Prescribed nodes must move the bone without turning it.
void hold_by_nodes(const JointModel& model, const Joint& joint, int body, int step, double time,
                   BodyConditions& conditions) {
  const Body& b = joint.bodies[at(body)];
  const bool by_user =
      std::any_of(b.materials.begin(), b.materials.end(), [&](int m) { return !model.materials[at(m)].rigid; });
  if (!by_user) return;  // FEBio ignores fixed nodes of its own rigid bodies
  struct Row {
    int component;
    Vector3d arm;
    double value;
  };
  std::vector<Row> rows;
  double length = 0.0;
  const auto add = [&](const std::vector<int>& nodes, int component, double value) {
    bool any = false;
    for (int node : nodes) {
      if (joint.node_body[at(node)] != body) continue;
      rows.push_back({component, model.nodes[at(node)] - b.center_of_mass, value});
      length = std::max(length, rows.back().arm.norm());
      any = true;
    }
    return any;
  };
  const auto acts = [&](int condition_step) { return condition_step < 0 || condition_step == step; };
  for (const FixedNodes& f : model.fixed_nodes)
    for (int k = 0; k < 3; ++k)
      if (acts(f.step) && f.xyz[at(k)]) add(f.nodes, k, 0.0);
  const auto ours = [&](const std::vector<int>& nodes) {
    return std::any_of(nodes.begin(), nodes.end(), [&](int node) { return joint.node_body[at(node)] == body; });
  };
  // Fixed later than moved or free: FEBio puts such nodes back to where they were in the reference.
  bool back = std::any_of(model.fixed_nodes.begin(), model.fixed_nodes.end(),
                          [&](const FixedNodes& f) { return f.step > 0 && ours(f.nodes); });
  const PrescribedNodes* mover = nullptr;
  bool agree = true;
  std::array<int, 3> relative = {-1, -1, -1};  // -1: nothing moves this component
  for (const PrescribedNodes& p : model.prescribed_nodes) {
    if (!acts(p.step)) {
      back = back || ours(p.nodes);
      continue;
    }
    if (!add(p.nodes, p.component, finite_value(model, p.value, time, p.origin))) continue;
    const int counts = p.relative && p.step >= 0;
    agree = agree && (relative[at(p.component)] < 0 || relative[at(p.component)] == counts);
    relative[at(p.component)] = counts;
    mover = &p;
  }

  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  Matrix6 gram = Matrix6::Zero();
  Vector6 right = Vector6::Zero();
  double largest = 0.0;
  const auto condition = [&](const Row& r) {
    Vector6 row;
    row << Vector3d::Unit(r.component), r.arm.cross(Vector3d::Unit(r.component)) / (length > 0 ? length : 1.0);
    return row;
  };
  for (const Row& r : rows) {
    const Vector6 row = condition(r);
    gram += row * row.transpose();
    right += row * r.value;
    largest = std::max(largest, std::abs(r.value));
  }
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(gram);
  const double least = 1e-8 * eigen.eigenvalues()[5];  // rounding is 1e-16, the smallest real lever squared far more
  int conditions_held = 0, dofs_held = 0;
  Vector6 motion = Vector6::Zero();  // the smallest that satisfies the conditions; rotations times length
  for (int i = 0; i < 6; ++i) {
    if (eigen.eigenvalues()[i] <= least) continue;
    ++conditions_held;
    motion += eigen.eigenvectors().col(i) * (eigen.eigenvectors().col(i).dot(right) / eigen.eigenvalues()[i]);
  }
  for (int dof = 0; dof < kDofs; ++dof) {
    double free_part = 0.0;
    for (int i = 0; i < 6; ++i)
      if (eigen.eigenvalues()[i] <= least) free_part += std::pow(eigen.eigenvectors()(dof, i), 2);
    if (free_part >= 1e-6) continue;
    ++dofs_held;
    conditions.dofs[at(dof)] = DofState::Held;
    if (dof < 3 && (mover != nullptr || back)) {
      conditions.dofs[at(dof)] = DofState::Prescribed;
      conditions.value[dof] = motion[dof];
      conditions.relative[at(dof)] = relative[at(dof)] == 1;
    }
  }
  if (mover == nullptr) return;
  agree = agree && conditions_held == dofs_held && motion.tail<3>().norm() <= 1e-6 * largest;
  for (const Row& r : rows) agree = agree && std::abs(condition(r).dot(motion) - r.value) <= 1e-6 * largest;
  if (!agree)
    throw fault_at(
        model, mover->origin,
        fmt::format("prescribed displacement \"{}\": at time {:g} its nodes move bone \"{}\" otherwise than by one "
                    "translation along x, y or z, which DEA cannot follow; make the bone a rigid body of the model and "
                    "prescribe its motion",
                    mover->name, time, b.name));
}

}  // namespace

LoadPointFound find_load_point(const Joint& joint, int body, const LoadPoint& wanted) {
  LoadPointFound found;
  found.point = wanted.point;
  if (!wanted.sphere_center) return found;
  for (const ContactPair& pair : joint.contacts) {
    for (const Layer& layer : pair.layers) {
      if (layer.body != body) continue;
      found.fit = fit_sphere(layer.articular);
      found.point = found.fit.center;
      found.fitted = true;
      return found;
    }
  }
  throw UsageError(Fault{.given = NamedSetting{"load-at", joint.bodies[at(body)].name, "sphere-center"},
                         .found = "this body has no articular surface;",
                         .expected = "give a point x,y,z"});
}

LoadCase make_load_case(const JointModel& model, const Joint& joint, const Settings& settings, int step, double time,
                        const std::vector<Vector6>* reaction) {
  LoadCase c;
  c.time = time;
  c.step = step;
  c.bodies.resize(joint.bodies.size());
  const auto active = [&](int condition_step) { return condition_step < 0 || condition_step == step; };
  for (const ContactPair& pair : joint.contacts) c.contact_active.push_back(active(pair.step));
  for (const Ligament& l : joint.ligaments) {
    c.ligament_active.push_back(active(l.step));
    c.ligament_scale.push_back(active(l.step) ? finite_value(model, l.scale, time, l.origin) : 0.0);
  }
  for (const Cable& cable : joint.cables)
    c.cable_force.push_back(active(cable.step) ? finite_value(model, cable.force, time, cable.origin) : 0.0);
  for (const Connector& j : joint.connectors) {
    c.connector_active.push_back(active(j.step));
    c.connector_value.push_back({});
    for (std::size_t k = 0; k < kDofs; ++k)
      if (active(j.step) && j.motion[k] != RigidJoint::Motion::Held)
        c.connector_value.back()[k] = finite_value(model, j.value[k], time, j.origin);
  }

  for (std::size_t b = 0; b < joint.bodies.size(); ++b)
    if (joint.bodies[b].ground) c.bodies[b].dofs.fill(DofState::Held);
  for (const RigidFixed& f : model.rigid_fixed) {
    const int b = body_of(joint, f.material);
    if (!active(f.step) || b < 0) continue;
    for (std::size_t k = 0; k < kDofs; ++k)
      if (f.dofs[k]) c.bodies[at(b)].dofs[k] = DofState::Held;
  }
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    if (!joint.bodies[b].ground) hold_by_nodes(model, joint, static_cast<int>(b), step, time, c.bodies[b]);
    if (!joint.bodies[b].moved_by.empty()) c.bodies[b].dofs.fill(DofState::Held);
    for (int i : joint.bodies[b].moved_by) {
      const PrescribedNodes& p = model.prescribed_nodes[at(i)];
      if (!active(p.step)) {  // fixed in this step: at the reference position, wherever the nodes were before
        if (c.bodies[b].dofs[at(p.component)] == DofState::Held)
          c.bodies[b].dofs[at(p.component)] = DofState::Prescribed;
        continue;
      }
      c.bodies[b].dofs[at(p.component)] = DofState::Prescribed;
      c.bodies[b].value[p.component] = finite_value(model, p.value, time, p.origin);
      c.bodies[b].relative[at(p.component)] = p.relative && p.step >= 0;
    }
  }
  for (const auto& entry : settings.free) {
    const int b = joint.find_body(model, entry.first);
    for (std::size_t k = 0; k < kDofs; ++k)
      if (c.bodies[at(b)].dofs[k] != DofState::Prescribed)
        c.bodies[at(b)].dofs[k] = entry.second[k] ? DofState::Free : DofState::Held;
  }
  for (const RigidPrescribed& p : model.rigid_prescribed) {
    const int b = body_of(joint, p.material);
    if (!active(p.step) || b < 0) continue;
    c.bodies[at(b)].dofs[at(p.dof)] = DofState::Prescribed;
    c.bodies[at(b)].value[p.dof] = finite_value(model, p.value, time, p.origin);
    // relative to the pose when it became active: outside steps that is the reference
    c.bodies[at(b)].relative[at(p.dof)] = p.relative && p.step >= 0;
  }
  for (std::size_t b = 0; b < c.bodies.size(); ++b) {
    const auto& dofs = c.bodies[b].dofs;
    const bool any = std::count(dofs.begin() + 3, dofs.end(), DofState::Prescribed) > 0;
    if (any && std::count(dofs.begin() + 3, dofs.end(), DofState::Free) > 0)
      throw fault_at(model, {0, 0},
                     say("body \"{}\": some rotations are prescribed and others free;", joint.bodies[b].name),
                     "FEBio and DEA need all three prescribed or fixed (a fixed one counts as 0)");
  }
  std::vector<char> force_replaced(joint.bodies.size(), 0);
  for (const auto& entry : settings.force) force_replaced[at(joint.find_body(model, entry.first))] = 1;
  for (const RigidLoad& l : model.rigid_loads) {
    const int b = body_of(joint, l.material);
    if (!active(l.step) || b < 0) continue;
    if (l.dof < 3 && force_replaced[at(b)]) continue;
    Vector6& load = l.kind == RigidLoad::Kind::Follower ? c.bodies[at(b)].follower : c.bodies[at(b)].dead;
    const double full = finite_value(model, l.value, time, l.origin);
    // FEBio notes the reaction when a load becomes active: outside steps that is before anything has been solved
    const bool on_reaction = l.kind == RigidLoad::Kind::Target || (l.kind == RigidLoad::Kind::Dead && l.relative);
    const double start = on_reaction && l.step >= 0 && reaction ? (*reaction)[at(b)][l.dof] : 0.0;
    c.bodies[at(b)].on_reaction = c.bodies[at(b)].on_reaction || (on_reaction && l.step >= 0);
    if (l.kind == RigidLoad::Kind::Target) {
      const std::vector<double> starts = step_starts(model);
      const double duration = starts[at(step) + 1] - starts[at(step)];
      const double w = duration > 0 ? std::clamp((time - starts[at(step)]) / duration, 0.0, 1.0) : 1.0;
      load[l.dof] += (1 - w) * start + w * full;
    } else {
      load[l.dof] += full + start;
    }
  }
  const auto scaled_vector = [&](const Vector3d& v, int controller, Origin origin) -> Vector3d {
    return v * finite_value(model, {1.0, controller}, time, origin);
  };
  for (const RigidFollower& f : model.rigid_followers) {
    const int b = body_of(joint, f.material);
    if (!active(f.step) || b < 0) continue;
    const Vector3d v = scaled_vector(f.value, f.controller, f.origin);
    if (f.moment) {
      c.bodies[at(b)].follower.tail<3>() += v;
    } else if (!force_replaced[at(b)]) {
      const Vector3d arm = f.from_center ? f.insertion : Vector3d(f.insertion - joint.bodies[at(b)].center_of_mass);
      c.bodies[at(b)].point_forces.push_back({arm, v, true});
    }
  }
  for (const PointLoad& p : joint.point_loads) {
    if (!active(p.step) || force_replaced[at(p.body)]) continue;
    c.bodies[at(p.body)].point_forces.push_back(
        {p.point - joint.bodies[at(p.body)].center_of_mass, scaled_vector(p.value, p.controller, p.origin), false});
  }
  for (const auto& entry : settings.force) {
    const int b = joint.find_body(model, entry.first);
    const std::vector<double> starts = step_starts(model);
    const int last = static_cast<int>(model.steps.size()) - 1;
    if (step != last) continue;
    const double duration = starts[at(last) + 1] - starts[at(last)];
    const double ramp = duration > 0 ? std::clamp((time - starts[at(last)]) / duration, 0.0, 1.0) : 1.0;
    c.bodies[at(b)].dead.head<3>() = ramp * entry.second;
  }
  for (const auto& entry : settings.load_at) {
    const int b = joint.find_body(model, entry.first);
    c.bodies[at(b)].arm = find_load_point(joint, b, entry.second).point - joint.bodies[at(b)].center_of_mass;
  }
  return c;
}

std::vector<double> step_starts(const JointModel& model) {
  std::vector<double> starts = {0.0};
  for (const Step& s : model.steps) starts.push_back(starts.back() + s.duration);
  return starts;
}

namespace {

// Far beyond what anyone looks at; each costs a solution and room in the plot file.
constexpr double kMostStates = 10000, kThinned = 1000;

const NamedSetting kSomeStates = {"states", "", "t1,t2,..."};

}  // namespace

double count_time_steps(const JointModel& model) {
  double count = 0.0;
  for (const Step& step : model.steps) count += step.step_size > 0 ? step.duration / step.step_size : 1.0;
  return count;
}

bool very_many_time_steps(const JointModel& model) { return !(count_time_steps(model) <= kMostStates * (1 + 1e-9)); }

std::vector<TimePoint> model_times(const JointModel& model, bool thin) {
  std::vector<TimePoint> times = {{0.0, 0}};
  const std::vector<double> starts = step_starts(model);
  const double states = count_time_steps(model);
  const bool very_many = very_many_time_steps(model);
  if (very_many && !thin)
    throw fault_at(model, model.steps.front().origin,
                   say("{:.0f} time steps, need at most {:.0f}:", states, kMostStates),
                   say("raise step_size (equilibrium at a time needs no small steps before it), or choose the states: "
                       "{}, {}",
                       NamedSetting{"states", "", "last"}, kSomeStates));
  const double stride = very_many ? std::ceil(states / kThinned) : 1.0;
  if (!(starts.back() > 0)) {
    throw fault_at(model, model.steps.empty() ? Origin{} : model.steps.back().origin,
                   "the model ends at time 0, so there is nothing to solve: need time_steps > 0 and step_size > 0");
  }
  for (int s = 0; s < static_cast<int>(model.steps.size()); ++s) {
    const Step& step = model.steps[at(s)];
    const double start = starts[at(s)], end = starts[at(s) + 1];
    const double scale = std::max(std::abs(end), step.duration);
    std::vector<double> in_step = step.must_points;
    if (step.step_size > 0) {
      const double whole = std::floor(step.duration / step.step_size * (1 + 1e-9));
      for (double i = stride; i <= whole && std::isfinite(i); i += stride)
        in_step.push_back(start + i * step.step_size);
    }
    in_step.push_back(end);
    std::sort(in_step.begin(), in_step.end());
    for (double t : in_step) {
      if (t <= start || same_time(t, start, scale) || t > end * (1 + 1e-12) + 1e-300) continue;
      if (same_time(t, end, scale)) t = end;
      if (!same_time(t, times.back().time, scale)) times.push_back({t, s});
    }
  }
  return times;
}

std::vector<TimePoint> place_times(const JointModel& model, const std::vector<double>& times) {
  const std::vector<double> starts = step_starts(model);
  std::vector<TimePoint> placed;
  for (double t : times) {
    int s = 0;
    // plot files hold times in single precision
    while (s + 1 < static_cast<int>(model.steps.size()) && t > starts[at(s) + 1] * (1 + 1e-6)) ++s;
    placed.push_back({t, s});
  }
  return placed;
}

Sentence thinned_note(const JointModel& model, std::size_t solved) {
  return say(
      "of the model's {:.0f} time steps {} are solved, evenly chosen besides ends of steps and must points: each is an "
      "equilibrium of its own; others with {}",
      count_time_steps(model), solved, kSomeStates);
}

}  // namespace dea

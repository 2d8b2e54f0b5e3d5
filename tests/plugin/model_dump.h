// tests/plugin/model_dump.h – a JointModel as text, a statement a line: two models are the same if their texts are.
// Left out: places in files, version, names of steps, controllers and rigid conditions, FEBio's words for contacts (old
// names are new ones in FEBio's model), remarks on what is ignored.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "src/model/joint_model.h"

namespace dea::test {

template <class Numbers>
std::string list(const Numbers& numbers) {
  std::string text;
  for (const auto& number : numbers) text += fmt::format(" {}", number);
  return text;
}

inline std::string vector_dump(const Vector3d& v) { return fmt::format("({},{},{})", v.x(), v.y(), v.z()); }

/// Of a unit vector, which FEBio's Init makes a unit vector again.
inline std::string direction(const Vector3d& v) {
  std::string text;
  for (int i = 0; i < 3; ++i) text += fmt::format("{}{:.12f}", i > 0 ? "," : "", std::abs(v[i]) < 1e-13 ? 0.0 : v[i]);
  return "(" + text + ")";
}

inline std::string scaled(const Scaled& s) { return fmt::format("{}*f{}", s.factor, s.controller); }

/// Nothing for shells without thickness, given as 0 or not at all.
inline std::string thickness(const Domain& d) {
  const auto& t = d.shell_thickness;
  return std::all_of(t.begin(), t.end(), [](double h) { return h == 0.0; }) ? "" : list(t);
}

/// A curve or an expression.
inline std::string function(const LoadController& c) {
  std::string text =
      fmt::format("{} {} {}", static_cast<int>(c.interpolate), static_cast<int>(c.extend), c.unsupported);
  if (!c.expression.empty()) text += fmt::format(" {} of {}", c.expression, c.variable);
  for (const auto& p : c.points) text += fmt::format(" {},{}", p[0], p[1]);
  return text;
}

inline std::string dump(const JointModel& m) {
  std::string t = fmt::format("module {} units {}\n", m.module, m.units);
  for (std::size_t i = 0; i < m.nodes.size(); ++i)
    t += fmt::format("node {} {}\n", m.node_ids[i], vector_dump(m.nodes[i]));
  for (const Domain& d : m.domains)
    t += fmt::format("domain {} {} {} elements{} nodes{} thick{}\n", d.name, static_cast<int>(d.shape), d.material,
                     list(d.element_ids), list(d.nodes), thickness(d));
  for (const Surface& s : m.surfaces)
    t += fmt::format("surface {} begin{} nodes{}\n", s.name, list(s.begin), list(s.nodes));
  for (const NodeSet& s : m.node_sets) t += fmt::format("node_set {}{}\n", s.name, list(s.nodes));
  for (const ElementSet& s : m.element_sets) t += fmt::format("element_set {}{}\n", s.name, list(s.element_ids));
  for (const DiscreteSet& s : m.discrete_sets) {
    t += fmt::format("discrete_set {}", s.name);
    for (const auto& pair : s.pairs) t += fmt::format(" {}-{}", pair[0], pair[1]);
    t += '\n';
  }
  for (const Material& a : m.materials)
    t += fmt::format("material {} {} {} {} density {} com {} E {} nu {} {}\n", a.id, a.name, a.type, a.rigid, a.density,
                     a.center_of_mass ? vector_dump(*a.center_of_mass) : "-", a.E, a.nu, a.note);
  std::map<std::pair<int, int>, std::array<bool, kDofs>> fixed;  // 2.5 says one dof at a time
  for (const RigidFixed& c : m.rigid_fixed)
    for (std::size_t i = 0; i < kDofs; ++i) fixed[{c.material, c.step}][i] |= c.dofs[i];
  for (const auto& c : fixed)
    t += fmt::format("rigid_fixed {} step {} {}\n", c.first.first, c.first.second, list(c.second));
  for (const RigidPrescribed& c : m.rigid_prescribed)
    t += fmt::format("rigid_prescribed {} {} {} {} step {}\n", c.material, c.dof, scaled(c.value), c.relative, c.step);
  for (const RigidLoad& c : m.rigid_loads)
    t += fmt::format("rigid_load {} {} {} {} {} step {}\n", c.material, c.dof, scaled(c.value),
                     static_cast<int>(c.kind), c.relative, c.step);
  for (const RigidFollower& c : m.rigid_followers)
    t += fmt::format("rigid_follower {} {} {} {} {}*f{} step {}\n", c.material, c.moment, vector_dump(c.insertion),
                     c.from_center, vector_dump(c.value), c.controller, c.step);
  for (const RigidAxialForce& c : m.rigid_axial_forces)
    t += fmt::format("rigid_axial_force {} {} {} {} {} {} {} step {}\n", c.name, c.material_a, c.material_b,
                     vector_dump(c.point_a), vector_dump(c.point_b), c.from_centers, scaled(c.force), c.step);
  for (const RigidCable& c : m.rigid_cables) {
    t += fmt::format("rigid_cable {} {} {} {} step {}", c.name, c.from_centers, scaled(c.force), direction(c.direction),
                     c.step);
    for (const RigidCable::Point& p : c.points) t += fmt::format(" {} {}", p.material, vector_dump(p.position));
    t += '\n';
  }
  for (const RigidJoint& c : m.rigid_joints) {
    t += fmt::format("rigid_joint {} {} {} {} {} axes {} {} {} step {}", c.name, c.type, c.material_a, c.material_b,
                     vector_dump(c.joint_origin), direction(c.axes.col(0)), direction(c.axes.col(1)),
                     direction(c.axes.col(2)), c.step);
    for (std::size_t i = 0; i < kDofs; ++i)
      t += fmt::format(" {} {}", static_cast<int>(c.motion[i]), scaled(c.value[i]));
    t += '\n';
  }
  for (const NodalForce& c : m.nodal_forces)
    t += fmt::format("nodal_force {} {}*f{} nodes{} step {}\n", c.name, vector_dump(c.value), c.controller,
                     list(c.nodes), c.step);
  for (const RigidSpring& s : m.rigid_springs)
    t += fmt::format("rigid_spring {} {} {} {} {} {} {} step {}\n", s.name, s.material_a, s.material_b,
                     vector_dump(s.insertion_a), vector_dump(s.insertion_b), s.k, s.free_length, s.step);
  for (const DiscreteSprings& s : m.discrete_springs)
    t += fmt::format("discrete_springs {} {} {} step {} {} {} {}\n", s.set, s.stiffness, s.tension_only, s.step,
                     static_cast<int>(s.measure), scaled(s.scale), s.force ? function(*s.force) : "");
  for (const PrescribedNodes& p : m.prescribed_nodes)
    t += fmt::format("prescribed_nodes{} {} {} {} step {}\n", list(p.nodes), p.component, scaled(p.value), p.relative,
                     p.step);
  for (const FixedNodes& f : m.fixed_nodes)
    t += fmt::format("fixed_nodes{} {} step {}\n", list(f.nodes), list(f.xyz), f.step);
  for (const RigidNodes& r : m.rigid_nodes)
    t += fmt::format("rigid_nodes {}{} step {}\n", r.material, list(r.nodes), r.step);
  for (const Contact& c : m.contacts) {
    t += fmt::format("contact {} {} {} {} {} step {}", c.name, static_cast<int>(c.kind), c.primary, c.secondary,
                     c.max_distance, c.step);
    for (const std::string& text : c.ignored) t += "; " + text;
    t += '\n';
  }
  for (const LoadController& c : m.controllers) {
    t += fmt::format("controller {} {}\n", c.id, function(c));
  }
  for (const Step& s : m.steps) t += fmt::format("step {} {}{}\n", s.duration, s.step_size, list(s.must_points));
  for (const Remark& r : m.unsupported) t += fmt::format("unsupported {}\n", r.what);
  return t;
}

}  // namespace dea::test

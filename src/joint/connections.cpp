#include "src/joint/connections.h"

#include <cmath>
#include <utility>

#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/facts/parts.h"
#include "src/joint/given_values.h"

namespace dea {

namespace {

/// What is being put together, and of what.
struct ConnectionsDraft {
  const ModelParts& parts;
  const std::vector<int>& node_body;
  Findings& findings;
  Connections connections;
};

/// Are both ends on one body? Then it is left out, and that is told. `kind`: what the model calls such a thing.
bool joins_one_body(ConnectionsDraft& draft, int body_a, int body_b, const char* kind, const std::string& name) {
  if (body_a != body_b) return false;
  const std::string& body = draft.parts.bodies.bodies[at(body_a)].name;
  add_once(draft.findings, {{"joins-one-body", {.body = body}, {{"what", kind}, {"name", name}}}});
  return true;
}

/// A point given in reference coordinates, or counted from the body's centre of mass.
Vector3d reference_point(const ConnectionsDraft& draft, int body, const Vector3d& point, bool from_center) {
  return from_center ? Vector3d(draft.parts.bodies.bodies[at(body)].center_of_mass + point) : point;
}

/// Adds it, unless both ends are on one body.
void add_ligament(ConnectionsDraft& draft, Ligament l, const char* kind) {
  const JointModel& model = draft.parts.model;
  l.where = where(model, l.origin);
  const bool on_part = l.part_node[0] >= 0 || l.part_node[1] >= 0;  // which moves in its body
  if (!on_part && joins_one_body(draft, l.body_a, l.body_b, kind, l.name)) return;
  const double length = (l.point_b - l.point_a).norm();
  if (l.free_length <= 0) l.free_length = length;
  if (!(length > 0) || !std::isfinite(length))
    throw fault_at(model, l.origin, say("{} \"{}\" has no length:", kind, l.name), "its two points coincide, move one");
  draft.connections.ligaments.push_back(std::move(l));
}

void add_rigid_springs(ConnectionsDraft& draft) {
  for (const RigidSpring& s : draft.parts.model.rigid_springs) {
    Ligament l{s};
    l.body_a = body_of_material(draft.parts, s.material_a);
    l.body_b = body_of_material(draft.parts, s.material_b);
    l.point_a = s.insertion_a;
    l.point_b = s.insertion_b;
    l.stiffness = given_value(draft.parts.settings, s.name, kStiffness).value_or(s.k);
    l.free_length = given_value(draft.parts.settings, s.name, kSlackLength).value_or(s.free_length);
    add_ligament(draft, l, "spring");
  }
}

/// One spring of a set, between two nodes.
void add_discrete_spring(ConnectionsDraft& draft, const DiscreteSprings& set, const std::array<int, 2>& pair) {
  const JointModel& model = draft.parts.model;
  Ligament l{set};
  if (set.name.empty()) l.name = model.discrete_sets[at(set.set)].name;
  l.body_a = draft.node_body[at(pair[0])];
  l.body_b = draft.node_body[at(pair[1])];
  for (int node : pair) {
    if (draft.node_body[at(node)] >= 0) continue;
    throw fault_at(
        model, set.origin,
        say("spring \"{}\" is fastened to node {}, which belongs to no rigid body:", l.name, model.node_ids[at(node)]),
        "fasten it to a node of a bone");
  }
  for (std::size_t k = 0; k < 2; ++k)
    if (soft_region(draft.parts, draft.parts.region[at(pair[k])]) >= 0 &&
        draft.parts.holders.of_node[at(pair[k])].empty())
      l.part_node[k] = pair[k];
  l.point_a = model.nodes[at(pair[0])];
  l.point_b = model.nodes[at(pair[1])];
  const auto given = [&](const char* parameter) { return given_value(model, draft.parts.settings, set, parameter); };
  l.stiffness = given(kStiffness).value_or(set.stiffness);
  l.free_length = given(kSlackLength).value_or(0.0);
  l.tension_only = set.tension_only;
  if (set.force) {
    l.law = Ligament::Law::Curve;
    l.curve = set.force;
    l.measure = set.measure;
    l.scale = set.scale;
    if (const auto force = given(kForce)) {  // the curve is constant
      l.law = Ligament::Law::Constant;
      l.curve.reset();
      l.scale.factor = *force;
    }
  }
  add_ligament(draft, l, "spring");
}

void add_discrete_springs(ConnectionsDraft& draft) {
  const JointModel& model = draft.parts.model;
  for (const DiscreteSprings& set : model.discrete_springs) {
    if (set.force && !set.force->unsupported.empty())
      throw fault_at(
          model, set.origin,
          say("spring \"{}\": its force is given by {}, which is not supported;", set.name, set.force->unsupported),
          "give points");
    for (const auto& pair : model.discrete_sets[at(set.set)].pairs) add_discrete_spring(draft, set, pair);
  }
}

void add_axial_forces(ConnectionsDraft& draft) {
  for (const RigidAxialForce& f : draft.parts.model.rigid_axial_forces) {
    Ligament l{f};
    l.law = Ligament::Law::Constant;
    l.body_a = body_of_material(draft.parts, f.material_a);
    l.body_b = body_of_material(draft.parts, f.material_b);
    l.point_a = reference_point(draft, l.body_a, f.point_a, f.from_centers);
    l.point_b = reference_point(draft, l.body_b, f.point_b, f.from_centers);
    l.scale = f.force;
    l.scale.factor = given_value(draft.parts.settings, f.name, kForce).value_or(l.scale.factor);
    add_ligament(draft, l, "axial force");
  }
}

/// A cable runs through points that differ from one to the next.
void check_cable(const JointModel& model, const Cable& cable) {
  if (cable.points.empty())
    throw fault_at(model, cable.origin, say("cable \"{}\" has no points:", cable.name), "add those it runs through");
  for (std::size_t i = 1; i < cable.points.size(); ++i)
    if (!((cable.points[i].position - cable.points[i - 1].position).norm() > 0))
      throw fault_at(
          model, cable.origin,
          say("cable \"{}\": points {} and {} coincide, so the cable has no direction there;", cable.name, i, i + 1),
          "take one out");
}

void add_cables(ConnectionsDraft& draft) {
  for (const RigidCable& c : draft.parts.model.rigid_cables) {
    Cable cable{c};
    for (const RigidCable::Point& p : c.points) {
      const int body = body_of_material(draft.parts, p.material);
      cable.points.push_back({body, reference_point(draft, body, p.position, c.from_centers)});
    }
    cable.force = c.force;
    cable.force.factor = given_value(draft.parts.settings, c.name, kForce).value_or(c.force.factor);
    if (c.direction.norm() > 0) cable.direction = c.direction.normalized();
    check_cable(draft.parts.model, cable);
    draft.connections.cables.push_back(std::move(cable));
  }
}

void add_connectors(ConnectionsDraft& draft) {
  const ModelParts& parts = draft.parts;
  for (const RigidJoint& j : parts.model.rigid_joints) {
    Connector c{j, body_of_material(parts, j.material_a), body_of_material(parts, j.material_b)};
    if (!((c.axes.transpose() * c.axes - Eigen::Matrix3d::Identity()).norm() < 1e-6) || !(c.axes.determinant() > 0))
      throw fault_at(parts.model, j.origin, say("joint \"{}\": its axes span no right-handed frame;", j.name),
                     "give two axes that are not parallel");
    if (!joins_one_body(draft, c.body_a, c.body_b, "joint", c.name))
      draft.connections.connectors.push_back(std::move(c));
  }
}

/// Nodal forces on nodes that move with a body: of its rigid elements, or of its rigid node sets.
void add_point_loads(ConnectionsDraft& draft) {
  const ModelParts& parts = draft.parts;
  const JointModel& model = parts.model;
  if (model.nodal_forces.empty()) return;
  std::vector<int> body(model.nodes.size(), -1);
  for (const Domain& d : model.domains) {
    if (d.material < 0 || !parts.rigid[at(d.material)] || is_line(d.shape)) continue;
    for (int node : d.nodes) body[at(node)] = parts.bodies.of_material[at(d.material)];
  }
  for (const RigidNodes& set : model.rigid_nodes)
    for (int node : set.nodes)
      if (body[at(node)] < 0) body[at(node)] = parts.bodies.of_material[at(set.material)];
  for (const NodalForce& f : model.nodal_forces) {
    for (int node : f.nodes) {
      if (body[at(node)] < 0)
        throw fault_at(model, f.origin,
                       say("nodal force \"{}\" acts on node {}, which is part of no rigid body;", f.name,
                           model.node_ids[at(node)]),
                       "DEA can load rigid bodies only: load a node of the bone, or use a rigid force");
      draft.connections.point_loads.push_back({f, body[at(node)], model.nodes[at(node)], f.value, f.controller});
    }
  }
}

}  // namespace

Connections find_connections(const ModelParts& parts, const std::vector<int>& node_body, Findings& findings) {
  ConnectionsDraft draft{parts, node_body, findings, {}};
  for (const auto add :
       {add_rigid_springs, add_discrete_springs, add_axial_forces, add_cables, add_connectors, add_point_loads})
    add(draft);
  return std::move(draft.connections);
}

}  // namespace dea

#include "io/results/plot_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "src/base/numbers.h"
#include "src/version.h"

namespace dea {

namespace {

/// The format has no undefined values and viewers compute ranges from all of them.
float number(double x) { return std::isfinite(x) ? static_cast<float>(x) + 0.0f : 0.0f; }

void append(std::vector<float>& values, const Vector3d& v) {
  for (int k = 0; k < 3; ++k) values.push_back(number(v[k]));
}

std::vector<float> numbers(const Vector3d& v) { return {number(v[0]), number(v[1]), number(v[2])}; }

std::array<float, 3> point(const Vector3d& v) { return {number(v[0]), number(v[1]), number(v[2])}; }

/// The model's mesh as FEBio would write it, and where the model's parts have gone.
struct MeshMap {
  XpltMesh mesh;
  std::vector<int> material_of_domain;  ///< per domain of the file; -1: springs
  std::vector<int> surface;             ///< per model surface: 1-based region of the file, 0: left out
  std::size_t elements = 0;
};

int max_nodes(const Surface& s) {
  int most = 3;
  for (int f = 0; f < s.size(); ++f) most = std::max(most, s.begin[at(f) + 1] - s.begin[at(f)]);
  return most;
}

bool is_written(const Domain& d) {
  return d.material >= 0 && !d.element_ids.empty();  // FEBio has no domain without material
}

/// Domains with a material, element sets of the same elements. Returns the ids of the elements written.
std::unordered_set<int> add_domains(const JointModel& model, MeshMap& map) {
  std::unordered_set<int> written;
  for (const Domain& d : model.domains) {
    if (!is_written(d)) continue;
    XpltDomain domain;
    domain.element_type = xplt_element_type(d.shape);
    domain.part = d.material + 1;
    domain.name = d.name;
    domain.element_ids = d.element_ids;
    domain.nodes = d.nodes;
    written.insert(d.element_ids.begin(), d.element_ids.end());
    map.material_of_domain.push_back(d.material);
    map.mesh.domains.push_back(std::move(domain));
    map.mesh.element_sets.push_back({d.name, d.element_ids});
  }
  return written;
}

/// Discrete springs as lines. Their materials are not among the model's: one part for all of them.
void add_discrete_sets(const JointModel& model, MeshMap& map) {
  XpltMesh& mesh = map.mesh;
  int next_id = 1;
  for (const Domain& d : model.domains)
    for (int id : d.element_ids) next_id = std::max(next_id, id + 1);
  for (const DiscreteSet& set : model.discrete_sets) {
    if (set.pairs.empty()) continue;
    if (mesh.parts.size() == model.materials.size()) mesh.parts.push_back("discrete springs");
    XpltDomain domain;
    domain.element_type = xplt_element_type(ElementShape::Line2);
    domain.part = static_cast<int>(mesh.parts.size());
    domain.name = set.name;
    for (const auto& pair : set.pairs) {
      domain.element_ids.push_back(next_id++);
      domain.nodes.insert(domain.nodes.end(), pair.begin(), pair.end());
    }
    map.material_of_domain.push_back(-1);
    mesh.domains.push_back(std::move(domain));
  }
}

void add_surfaces(const JointModel& model, MeshMap& map) {
  for (const Surface& s : model.surfaces) {
    map.surface.push_back(0);
    if (s.size() == 0) continue;
    XpltFacets facets;
    facets.name = s.name;
    facets.begin = s.begin;
    facets.nodes = s.nodes;
    facets.max_nodes = max_nodes(s);
    map.mesh.surfaces.push_back(facets);
    map.surface.back() = static_cast<int>(map.mesh.surfaces.size());
    facets.max_nodes = 10;  // what FEBio has for facet sets
    map.mesh.facet_sets.push_back(std::move(facets));
  }
}

MeshMap make_mesh(const JointModel& model) {
  MeshMap map;
  XpltMesh& mesh = map.mesh;
  mesh.node_ids = model.node_ids;
  for (const Vector3d& x : model.nodes) append(mesh.coordinates, x);
  for (const Material& m : model.materials) mesh.parts.push_back(m.name);
  const std::unordered_set<int> written = add_domains(model, map);
  add_discrete_sets(model, map);
  for (const XpltDomain& d : mesh.domains) map.elements += d.element_ids.size();
  add_surfaces(model, map);
  for (const NodeSet& s : model.node_sets) mesh.node_sets.push_back({s.name, s.nodes});
  for (const ElementSet& s : model.element_sets) {
    XpltSet set;
    set.name = s.name;
    for (int id : s.element_ids)
      if (written.count(id)) set.items.push_back(id);
    mesh.element_sets.push_back(std::move(set));
  }
  return map;
}

bool left_out(const Layer& layer, int facet) {
  return !layer.facet_kinds.empty() && layer.facet_kinds[at(facet)] != FaceKind::Open;
}

/// A value per vertex of a layer's articular surface, in the slots of the surface's facets. Facets left out have none,
/// though they share nodes with the rim.
std::vector<float> per_slot(const Surface& s, const Layer& layer, const std::vector<double>& per_vertex) {
  const std::unordered_map<int, int> vertex = articular_vertices(layer);
  const int slots = max_nodes(s);
  std::vector<float> values(at(s.size()) * at(slots), 0.0f);
  for (int f = 0; f < s.size(); ++f) {
    if (left_out(layer, f)) continue;
    for (int k = s.begin[at(f)]; k < s.begin[at(f) + 1]; ++k) {
      const auto found = vertex.find(s.nodes[at(k)]);
      if (found != vertex.end())
        values[at(f) * at(slots) + at(k - s.begin[at(f)])] = number(per_vertex[at(found->second)]);
    }
  }
  return values;
}

std::vector<float> per_facet(const std::vector<double>& values) {
  std::vector<float> floats;
  for (double x : values) floats.push_back(number(x));
  return floats;
}

/// What a surface shows.
struct Shown {
  const Layer* layer = nullptr;          ///< nullptr: no contact has the surface
  std::vector<const SideFields*> sides;  ///< of all its contacts, the one that presses hardest first
};

/// Per model surface.
std::vector<Shown> shown_contacts(const JointModel& model, const Joint& joint,
                                  const std::vector<ContactFields>& fields) {
  std::vector<Shown> shown(model.surfaces.size());
  for (std::size_t c = 0; c < joint.contacts.size(); ++c)
    for (int side = 0; side < 2; ++side) {
      const Layer& layer = joint.contacts[c].layers[side];
      Shown& s = shown[at(layer.surface)];
      s.sides.push_back(&fields[c].sides[side]);
      if (s.sides.size() > 1 && !(s.sides.back()->force.norm() > s.sides.front()->force.norm())) continue;
      std::swap(s.sides.front(), s.sides.back());
      s.layer = &layer;
    }
  for (Shown& s : shown) {
    if (s.sides.size() < 2) continue;
    const SideFields& first = *s.sides.front();
    std::erase_if(s.sides, [&](const SideFields* other) {  // a contact of its own kind may take fewer facets
      return other->pressure.size() != first.pressure.size() ||
             other->vertex_pressure.size() != first.vertex_pressure.size();
    });
  }
  return shown;
}

/// A field on contact surfaces: what it is, and its values on one side of a contact.
struct SurfaceField {
  XpltVariable variable;
  std::function<std::vector<float>(const Surface&, const Layer&, const SideFields&)> values;
};

SurfaceField facet_field(const FacetField& field) {
  return {xplt_variable(XpltGroup::Surface, XpltType::Float, XpltFormat::Item, field.name, field.unit),
          [values = field.values](const Surface&, const Layer&, const SideFields& f) { return per_facet(f.*values); }};
}

/// `inside`: also of the inside of layers.
std::vector<SurfaceField> surface_fields(bool inside) {
  using S = const Surface&;
  using L = const Layer&;
  using F = const SideFields&;
  const auto surface = [](XpltType type, XpltFormat format, const std::string& name, const std::string& units) {
    return xplt_variable(XpltGroup::Surface, type, format, name, units);
  };
  std::vector<SurfaceField> fields = {facet_field(facet_fields().front())};
  // FEBio's sign: penetration. Springs push exactly at the surfaces they model: nothing penetrates.
  fields.push_back({surface(XpltType::Float, XpltFormat::Item, "contact gap", "L"),
                    [](S s, L, F) { return std::vector<float>(at(s.size()), 0.0f); }});
  fields.push_back(
      {surface(XpltType::Vec3, XpltFormat::Region, "contact force", "F"), [](S, L, F f) { return numbers(f.force); }});
  fields.push_back({surface(XpltType::Float, XpltFormat::Region, "contact area", "L^2"),
                    [](S, L, F f) { return std::vector<float>{number(f.contact_area)}; }});
  fields.push_back({surface(XpltType::Float, XpltFormat::Mult, "nodal contact pressure", "P"),
                    [](S s, L l, F f) { return per_slot(s, l, f.vertex_pressure); }});
  for (std::size_t i = 1; i < facet_fields().size(); ++i) fields.push_back(facet_field(facet_fields()[i]));
  fields.push_back({surface(XpltType::Float, XpltFormat::Mult, "cartilage thickness", "L"),
                    [](S s, L l, F f) { return per_slot(s, l, f.vertex_thickness); }});
  fields.push_back({surface(XpltType::Float, XpltFormat::Region, "springs", ""),
                    [](S, L, F f) { return std::vector<float>{f.springs ? 1.0f : 0.0f}; }});
  if (!inside) return fields;
  for (const FacetField& field : inside_facet_fields()) fields.push_back(facet_field(field));
  return fields;
}

/// Rotations about z, y, x (applied in the order x, y, z), as FEBio's Euler angles, in degrees.
Vector3d euler_degrees(const Eigen::Matrix3d& R) {
  return kDegreesPerRadian * Vector3d(std::atan2(R(2, 1), R(2, 2)), std::asin(std::clamp(-R(2, 0), -1.0, 1.0)),
                                      std::atan2(R(1, 0), R(0, 0)));
}

XpltObject rigid_body_object(const Body& body) {
  XpltObject object;
  object.name = body.name;
  object.tag = 1;
  object.position = point(body.center_of_mass);
  for (const char* item : {"Position", "Velocity", "Acceleration", "Euler angles (deg)", "Angular velocity",
                           "Angular acceleration", "Force", "Moment"})
    object.data.push_back(xplt_variable(XpltGroup::Global, XpltType::Vec3, XpltFormat::Node, item, ""));
  return object;
}

XpltObjectState rigid_body_state(const Pose& pose, const Vector6& reaction) {
  XpltObjectState s;
  s.position = point(pose.center);
  const Eigen::Quaterniond q(pose.rotation);
  s.rotation = {number(q.x()), number(q.y()), number(q.z()), number(q.w())};
  const std::vector<float> zero(3, 0.0f);  // a sequence of equilibria has no velocities
  s.data = {numbers(pose.center),
            zero,
            zero,
            numbers(euler_degrees(pose.rotation)),
            zero,
            zero,
            numbers(reaction.head<3>()),
            numbers(reaction.tail<3>())};
  return s;
}

XpltFile empty_file(const JointModel& model) {
  XpltFile file;
  file.software = fmt::format("FEBioDEA {}", kVersion);
  file.units = model.units;
  return file;
}

/// Per vertex of the articular surface what is beyond the selection's rim there: 1 nothing (free), 2 more of the layer,
/// 3 its mirror image, 4 the layer bonded to bone, 5 facets that another contact presses; the lower one where two meet;
/// 0: not on the rim.
std::vector<double> rim_at_vertices(const Layer& layer) {
  std::vector<double> rim(layer.articular.vertices.size(), 0.0);
  if (layer.face.mesh.size() == 0) return rim;
  for (const SelectionEdge& e : selection_rim(layer.face)) {
    const double kind = e.goes_on                 ? 2.0
                        : e.edge.rim == Rim::Free ? 1.0
                        : e.edge.bonded           ? 4.0
                        : e.edge.shared           ? 5.0
                                                  : 3.0;
    for (int v : e.vertices)
      if (rim[at(v)] == 0.0 || kind < rim[at(v)]) rim[at(v)] = kind;
  }
  return rim;
}

/// Per facet: 0 used, 1 left out as side wall, 2 left out as bonded to bone.
std::vector<double> left_out_facets(const Surface& s, const Layer& layer) {
  std::vector<double> kinds(at(s.size()), 0.0);
  for (int f = 0; f < s.size(); ++f)
    if (left_out(layer, f)) kinds[at(f)] = layer.facet_kinds[at(f)] == FaceKind::SideWall ? 1.0 : 2.0;
  return kinds;
}

/// Forces and places of rigid bodies, per domain of their materials; `first`: index of "rigid force".
void add_rigid_bodies(const std::vector<int>& material_of_domain, const Joint& joint, const Equilibrium& e,
                      std::size_t first, XpltState& state) {
  for (std::size_t d = 0; d < material_of_domain.size(); ++d) {
    const int b = material_of_domain[d] < 0 ? -1 : joint.body_of(material_of_domain[d]);
    if (b < 0) continue;
    const int region = static_cast<int>(d) + 1;
    state.variables[first].push_back({region, numbers(e.reaction[at(b)].head<3>())});
    state.variables[first + 1].push_back({region, numbers(e.reaction[at(b)].tail<3>())});
    state.variables[first + 2].push_back({region, numbers(e.poses[at(b)].center)});
  }
}

/// Fields on contact surfaces; `first`: index of the first of them.
void add_surface_fields(const JointModel& model, const std::vector<int>& surface, const Joint& joint,
                        const std::vector<ContactFields>& contacts, const std::vector<SurfaceField>& fields,
                        std::size_t first, XpltState& state) {
  const std::vector<Shown> shown = shown_contacts(model, joint, contacts);
  for (std::size_t s = 0; s < shown.size(); ++s) {
    if (shown[s].layer == nullptr || surface[s] == 0) continue;
    std::optional<SideFields> sum;  // one contact is the rule, and nothing to add
    if (shown[s].sides.size() > 1) sum = added_sides(shown[s].sides);
    const SideFields& side = sum ? *sum : *shown[s].sides.front();
    for (std::size_t v = 0; v < fields.size(); ++v) {
      std::vector<float> values = fields[v].values(model.surfaces[s], *shown[s].layer, side);
      if (!values.empty()) state.variables[first + v].push_back({surface[s], std::move(values)});  // bare bone: none
    }
  }
}

/// Stress and strain of elements; `first`: index of "stress".
void add_inside_fields(const JointModel& model, const std::vector<InsideDomain>& inside, std::size_t first,
                       XpltState& state) {
  std::vector<int> region;
  int next = 1;
  for (const Domain& d : model.domains) region.push_back(is_written(d) ? next++ : 0);
  const auto add = [&](std::size_t variable, int domain, const std::vector<SymmetricTensor>& tensors) {
    std::vector<float> values;
    values.reserve(6 * tensors.size());
    for (const SymmetricTensor& t : tensors)
      for (double x : t) values.push_back(number(x));
    state.variables[variable].push_back({region[at(domain)], std::move(values)});
  };
  for (const InsideDomain& d : inside) {
    add(first, d.domain, d.stress);
    add(first + 1, d.domain, d.strain);
  }
}

/// Per vertex of the articular surface: 1 where its normal (bone variant: one of a bone triangle below) meets no bone.
std::vector<double> missed_normals(const Layer& layer, const FieldMaps::LayerMap& map) {
  std::vector<double> missed(layer.articular.vertices.size(), 0.0);
  for (std::size_t v = 0; v < missed.size(); ++v) {
    if (layer.rigid) continue;
    if (layer.springs_at == SpringsAt::Articular) {
      missed[v] = layer.missed[v] ? 1.0 : 0.0;
    } else if (v < map.articular_to_bone.size() && map.articular_to_bone[v].triangle >= 0) {
      for (int corner : layer.bone.triangles[at(map.articular_to_bone[v].triangle)])
        if (layer.missed[at(corner)]) missed[v] = 1.0;
    }
  }
  return missed;
}

/// A field of the check file, and its values on one side of a contact.
struct CheckField {
  XpltVariable variable;
  std::vector<float> (*values)(const Surface&, const Layer&, const FieldMaps::LayerMap&, const SideFields&);
};

std::vector<CheckField> check_fields() {
  using S = const Surface&;
  using L = const Layer&;
  using M = const FieldMaps::LayerMap&;
  using F = const SideFields&;
  const auto surface = [](XpltFormat format, const std::string& name, const std::string& units) {
    return xplt_variable(XpltGroup::Surface, XpltType::Float, format, name, units);
  };
  return {
      {surface(XpltFormat::Mult, "cartilage thickness", "L"),
       [](S s, L l, M, F f) { return per_slot(s, l, f.vertex_thickness); }},
      {surface(XpltFormat::Item, "joint space", "L"), [](S, L, M, F f) { return per_facet(f.joint_space); }},
      {surface(XpltFormat::Mult, "missed normal", ""),
       [](S s, L l, M m, F) { return per_slot(s, l, missed_normals(l, m)); }},
      {surface(XpltFormat::Mult, "rim", ""), [](S s, L l, M, F) { return per_slot(s, l, rim_at_vertices(l)); }},
      {surface(XpltFormat::Item, "left out", ""), [](S s, L l, M, F) { return per_facet(left_out_facets(s, l)); }},
  };
}

/// Each surface once, at the first contact that has it.
void add_check_fields(const JointModel& model, const MeshMap& map, const JointCheck& check,
                      const std::vector<CheckField>& fields, XpltState& state) {
  std::vector<char> done(model.surfaces.size(), 0);
  for (std::size_t c = 0; c < check.joint.contacts.size(); ++c) {
    for (int side = 0; side < 2; ++side) {
      const Layer& layer = check.joint.contacts[c].layers[side];
      const int region = map.surface[at(layer.surface)];
      if (region == 0 || done[at(layer.surface)]) continue;
      done[at(layer.surface)] = 1;
      for (std::size_t v = 0; v < fields.size(); ++v)
        state.variables[v].push_back(
            {region, fields[v].values(model.surfaces[at(layer.surface)], layer, check.maps.contacts[c].layers[side],
                                      check.fields[c].sides[side])});
    }
  }
  for (auto& regions : state.variables)
    std::sort(regions.begin(), regions.end(),
              [](const XpltRegion& a, const XpltRegion& b) { return a.region < b.region; });
}

/// The springs of every contact as lines through both layers, as a part of their own.
void add_spring_lines(const JointCheck& check, MeshMap& map) {
  XpltMesh& mesh = map.mesh;
  int next_node = 1, next_element = 1;
  for (int id : mesh.node_ids) next_node = std::max(next_node, id + 1);
  for (const XpltDomain& d : mesh.domains)
    for (int id : d.element_ids) next_element = std::max(next_element, id + 1);
  for (std::size_t c = 0; c < check.joint.contacts.size(); ++c) {
    const ContactPair& pair = check.joint.contacts[c];
    const SpringStates& springs = check.reference.springs[c];
    XpltDomain lines;
    lines.element_type = xplt_element_type(ElementShape::Line2);
    lines.part = static_cast<int>(mesh.parts.size()) + 1;
    lines.name = fmt::format("springs {}", pair.name);
    const bool articular = pair.source_layer().springs_at == SpringsAt::Articular;
    for (int i = 0; i < springs.size(); ++i) {
      const std::size_t k = at(i);
      const double t_s = springs.t_source[k], t_t = springs.t_target[k];
      // beyond five thicknesses a spring has nothing to say about this joint
      if (springs.triangle[k] < 0 || springs.too_deep[k] || springs.gap[k] > 5.0 * (t_s + t_t)) continue;
      const Vector3d& n = springs.direction[k];
      const Vector3d from = articular ? Vector3d(springs.foot[k] - t_s * n) : springs.foot[k];
      const Vector3d to = articular ? Vector3d(springs.end[k] + t_t * n) : springs.end[k];
      for (const Vector3d& x : {from, to}) {
        lines.nodes.push_back(static_cast<int>(mesh.node_ids.size()));
        mesh.node_ids.push_back(next_node++);
        append(mesh.coordinates, x);
      }
      lines.element_ids.push_back(next_element++);
    }
    if (lines.element_ids.empty()) continue;
    map.elements += lines.element_ids.size();
    mesh.domains.push_back(std::move(lines));
  }
  if (mesh.domains.size() > map.material_of_domain.size()) mesh.parts.push_back("springs");
}

}  // namespace

PlotHead plot_head(const JointModel& model, const Joint& joint, bool compressed, bool inside) {
  MeshMap map = make_mesh(model);
  for (const Body& body : joint.bodies)
    if (!body.ground) map.mesh.objects.push_back(rigid_body_object(body));
  PlotHead head{empty_file(model), std::move(map.material_of_domain), std::move(map.surface), map.elements, inside};
  head.file.compressed = compressed;
  head.file.variables = {xplt_variable(XpltGroup::Nodal, XpltType::Vec3, XpltFormat::Node, "displacement", "L"),
                         xplt_variable(XpltGroup::Domain, XpltType::Vec3, XpltFormat::Region, "rigid force", "F"),
                         xplt_variable(XpltGroup::Domain, XpltType::Vec3, XpltFormat::Region, "rigid torque", "F.L"),
                         xplt_variable(XpltGroup::Domain, XpltType::Vec3, XpltFormat::Region, "rigid position", "L")};
  const auto tensor = [](const char* name, const char* unit) {
    return xplt_variable(XpltGroup::Domain, XpltType::Mat3s, XpltFormat::Item, name, unit);
  };
  if (inside)
    head.file.variables.insert(head.file.variables.end(), {tensor("stress", "P"), tensor("Lagrange strain", "")});
  for (const SurfaceField& f : surface_fields(inside)) head.file.variables.push_back(f.variable);
  head.file.meshes.push_back(std::move(map.mesh));
  return head;
}

XpltState plot_state(const JointModel& model, const Joint& joint, const PlotHead& head, const StateResult& result) {
  constexpr std::size_t kRigidForce = 1, kStress = 4;  // in the dictionary of plot_head
  const std::size_t on_surfaces = kStress + (head.inside ? 2 : 0);
  const Equilibrium& e = result.equilibrium;
  XpltState state;
  state.time = number(result.when.time);
  state.status = solved(e.outcome) ? kStatusConverged : kStatusNotConverged;
  state.element_flags.assign(head.elements, 1);
  state.variables.resize(head.file.variables.size());
  std::vector<float> displacements;
  displacements.reserve(3 * result.displacements.size());
  for (const Vector3d& u : result.displacements) append(displacements, u);
  state.variables[0].push_back({0, std::move(displacements)});
  add_rigid_bodies(head.material_of_domain, joint, e, kRigidForce, state);
  add_surface_fields(model, head.surface, joint, result.fields, surface_fields(head.inside), on_surfaces, state);
  if (head.inside) add_inside_fields(model, result.inside, kStress, state);
  for (std::size_t b = 0; b < joint.bodies.size(); ++b)
    if (!joint.bodies[b].ground) state.objects.push_back(rigid_body_state(e.poses[b], e.reaction[b]));
  return state;
}

XpltFile make_plot_file(const JointModel& model, const Analysis& analysis, bool compressed) {
  const bool inside = std::any_of(analysis.states.begin(), analysis.states.end(),
                                  [](const StateResult& state) { return !state.inside.empty(); });
  PlotHead head = plot_head(model, analysis.joint, compressed, inside);
  for (const StateResult& result : analysis.states)
    head.file.states.push_back(plot_state(model, analysis.joint, head, result));
  return std::move(head.file);
}

XpltMesh plot_mesh(const JointModel& model) { return make_mesh(model).mesh; }

XpltFile make_check_file(const JointModel& model, const JointCheck& check) {
  MeshMap map = make_mesh(model);
  XpltFile file = empty_file(model);
  const std::vector<CheckField> fields = check_fields();
  for (const CheckField& f : fields) file.variables.push_back(f.variable);
  XpltState state;
  state.variables.resize(file.variables.size());
  add_check_fields(model, map, check, fields, state);
  add_spring_lines(check, map);
  state.element_flags.assign(map.elements, 1);
  file.meshes.push_back(std::move(map.mesh));
  file.states.push_back(std::move(state));
  return file;
}

}  // namespace dea

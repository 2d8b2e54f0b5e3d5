#include "io/results/plot_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <optional>
#include <set>
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

int max_nodes(const Surface& s) {
  int most = 3;
  for (int f = 0; f < s.size(); ++f) most = std::max(most, s.begin[at(f) + 1] - s.begin[at(f)]);
  return most;
}

bool is_written(const Domain& d) {
  return d.material >= 0 && !d.element_ids.empty();  // FEBio has no domain without material
}

/// Domains with a material, element sets of the same elements. Returns the ids of the elements written.
std::unordered_set<int> add_domains(const JointModel& model, PlotHead& head) {
  XpltMesh& mesh = head.file.meshes.front();
  std::unordered_set<int> written;
  for (const Domain& d : model.domains) {
    if (!is_written(d)) continue;
    written.insert(d.element_ids.begin(), d.element_ids.end());
    head.material_of_domain.push_back(d.material);
    mesh.domains.push_back({xplt_element_type(d.shape), d.material + 1, d.name, d.element_ids, d.nodes});
    mesh.element_sets.push_back({d.name, d.element_ids});
  }
  return written;
}

/// Discrete springs as lines. Their materials are not among the model's: one part for all of them.
void add_discrete_sets(const JointModel& model, PlotHead& head) {
  XpltMesh& mesh = head.file.meshes.front();
  int next_id = 1;
  for (const Domain& d : model.domains)
    for (int id : d.element_ids) next_id = std::max(next_id, id + 1);
  for (const DiscreteSet& set : model.discrete_sets) {
    if (set.pairs.empty()) continue;
    if (mesh.parts.size() == model.materials.size()) mesh.parts.push_back("discrete springs");
    XpltDomain domain = {xplt_element_type(ElementShape::Line2), static_cast<int>(mesh.parts.size()), set.name, {}, {}};
    for (const auto& pair : set.pairs) {
      domain.element_ids.push_back(next_id++);
      domain.nodes.insert(domain.nodes.end(), pair.begin(), pair.end());
    }
    head.material_of_domain.push_back(-1);
    mesh.domains.push_back(std::move(domain));
  }
}

void add_surfaces(const JointModel& model, PlotHead& head) {
  XpltMesh& mesh = head.file.meshes.front();
  for (const Surface& s : model.surfaces) {
    head.surface.push_back(0);
    if (s.size() == 0) continue;
    mesh.surfaces.push_back({s.name, s.begin, s.nodes, max_nodes(s)});
    head.surface.back() = static_cast<int>(mesh.surfaces.size());
    mesh.facet_sets.push_back({s.name, s.begin, s.nodes, 10});  // slots: what FEBio has for facet sets
  }
}

/// What all files of a model have, without variables.
PlotHead make_head(const JointModel& model) {
  PlotHead head;
  head.file.software = fmt::format("FEBioDEA {}", kVersion);
  head.file.units = model.units;
  XpltMesh& mesh = head.file.meshes.emplace_back();
  mesh.node_ids = model.node_ids;
  for (const Vector3d& x : model.nodes) append(mesh.coordinates, x);
  for (const Material& m : model.materials) mesh.parts.push_back(m.name);
  const std::unordered_set<int> written = add_domains(model, head);
  add_discrete_sets(model, head);
  add_surfaces(model, head);
  for (const NodeSet& s : model.node_sets) mesh.node_sets.push_back({s.name, s.nodes});
  for (const ElementSet& s : model.element_sets) {
    mesh.element_sets.push_back({s.name, {}});
    for (int id : s.element_ids)
      if (written.count(id)) mesh.element_sets.back().items.push_back(id);
  }
  return head;
}

bool left_out(const Layer& layer, int facet) {
  return !layer.facet_kinds.empty() && layer.facet_kinds[at(facet)] != FaceKind::Open;
}

/// A surface with one side of a contact.
struct SurfaceSide {
  const Surface& surface;
  const Layer& layer;
  const SideFields& fields;
  const FieldMaps::LayerMap* map = nullptr;  ///< for the check file alone
};

/// A value per vertex of a layer's articular surface, in the slots of the surface's facets. Facets left out have none,
/// though they share nodes with the rim.
std::vector<float> per_slot(const SurfaceSide& side, const std::vector<double>& per_vertex) {
  const Surface& s = side.surface;
  const std::unordered_map<int, int> vertex = articular_vertices(side.layer);
  const int slots = max_nodes(s);
  std::vector<float> values(at(s.size()) * at(slots), 0.0f);
  for (int f = 0; f < s.size(); ++f) {
    if (left_out(side.layer, f)) continue;
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
  std::vector<const Layer*> layers;      ///< of each side
  /// Where contacts take different facets of a part's surface: values at the nodes of all, and a layer that has these.
  std::deque<SideFields> at_all_nodes;
  std::optional<Layer> of_all;
};

/// Two contacts may press different sides of one surface of a part.
void put_together(Shown& shown) {
  Layer all = *shown.layer;
  std::set<int> nodes;
  for (const Layer* layer : shown.layers) {
    nodes.insert(layer->articular.model_nodes.begin(), layer->articular.model_nodes.end());
    for (std::size_t f = 0; f < all.facet_kinds.size(); ++f)
      if (layer->facet_kinds.empty() || layer->facet_kinds[f] == FaceKind::Open) all.facet_kinds[f] = FaceKind::Open;
  }
  all.articular.model_nodes.assign(nodes.begin(), nodes.end());
  const std::unordered_map<int, int> vertex = articular_vertices(all);
  for (std::size_t k = 0; k < shown.sides.size(); ++k) {
    SideFields& there = shown.at_all_nodes.emplace_back(*shown.sides[k]);
    const std::vector<int>& own = shown.layers[k]->articular.model_nodes;
    for (auto values : {&SideFields::vertex_pressure, &SideFields::vertex_thickness, &SideFields::vertex_shortening}) {
      (there.*values).assign(nodes.size(), 0.0);
      for (std::size_t v = 0; v < own.size(); ++v)
        (there.*values)[at(vertex.at(own[v]))] = (shown.sides[k]->*values)[v];
    }
  }
  for (std::size_t k = 0; k < shown.sides.size(); ++k) shown.sides[k] = &shown.at_all_nodes[k];
  shown.of_all = std::move(all);
  shown.layer = &*shown.of_all;
}

/// Per model surface.
std::deque<Shown> shown_contacts(const JointModel& model, const Joint& joint,
                                 const std::vector<ContactFields>& fields) {
  std::deque<Shown> shown(model.surfaces.size());
  for (std::size_t c = 0; c < joint.contacts.size(); ++c)
    for (int side = 0; side < 2; ++side) {
      const Layer& layer = joint.contacts[c].layers[side];
      Shown& s = shown[at(layer.surface)];
      s.sides.push_back(&fields[c].sides[side]);
      s.layers.push_back(&layer);
      if (s.sides.size() > 1 && !(s.sides.back()->force.norm() > s.sides.front()->force.norm())) continue;
      std::swap(s.sides.front(), s.sides.back());
      std::swap(s.layers.front(), s.layers.back());
      s.layer = &layer;
    }
  for (Shown& s : shown) {
    if (s.sides.size() < 2) continue;
    if (std::all_of(s.layers.begin(), s.layers.end(), [](const Layer* layer) { return layer->part >= 0; }) &&
        std::any_of(s.layers.begin(), s.layers.end(), [&s](const Layer* layer) {
          return layer->articular.model_nodes != s.layer->articular.model_nodes;
        })) {
      put_together(s);
      continue;
    }
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
  std::function<std::vector<float>(const SurfaceSide&)> values;
};

SurfaceField surface_field(XpltType type, XpltFormat format, const std::string& name, const std::string& units,
                           std::function<std::vector<float>(const SurfaceSide&)> values) {
  return {{XpltGroup::Surface, type, format, name, units}, std::move(values)};
}

SurfaceField facet_field(const FacetField& field) {
  return surface_field(XpltType::Float, XpltFormat::Item, field.name, field.unit,
                       [values = field.values](const SurfaceSide& s) { return per_facet(s.fields.*values); });
}

SurfaceField thickness_field() {
  return surface_field(XpltType::Float, XpltFormat::Mult, "cartilage thickness", "L",
                       [](const SurfaceSide& s) { return per_slot(s, s.fields.vertex_thickness); });
}

/// `inside`: also of the inside of layers.
std::vector<SurfaceField> surface_fields(bool inside) {
  using S = const SurfaceSide&;
  std::vector<SurfaceField> fields = {facet_field(facet_fields().front())};
  // FEBio's sign: penetration. Springs push exactly at the surfaces they model: nothing penetrates.
  fields.push_back(surface_field(XpltType::Float, XpltFormat::Item, "contact gap", "L",
                                 [](S s) { return std::vector<float>(at(s.surface.size()), 0.0f); }));
  fields.push_back(surface_field(XpltType::Vec3, XpltFormat::Region, "contact force", "F",
                                 [](S s) { return numbers(s.fields.force); }));
  fields.push_back(surface_field(XpltType::Float, XpltFormat::Region, "contact area", "L^2",
                                 [](S s) { return std::vector<float>{number(s.fields.contact_area)}; }));
  fields.push_back(surface_field(XpltType::Float, XpltFormat::Mult, "nodal contact pressure", "P",
                                 [](S s) { return per_slot(s, s.fields.vertex_pressure); }));
  for (std::size_t i = 1; i < facet_fields().size(); ++i) fields.push_back(facet_field(facet_fields()[i]));
  fields.push_back(thickness_field());
  fields.push_back(surface_field(XpltType::Float, XpltFormat::Region, "springs", "",
                                 [](S s) { return std::vector<float>{s.fields.springs ? 1.0f : 0.0f}; }));
  if (!inside) return fields;
  for (const FacetField& field : inside_facet_fields()) fields.push_back(facet_field(field));
  return fields;
}

/// `first`: index of the first of the fields.
void add_field_values(const std::vector<SurfaceField>& fields, const SurfaceSide& side, int region, std::size_t first,
                      XpltState& state) {
  for (std::size_t v = 0; v < fields.size(); ++v) {
    std::vector<float> values = fields[v].values(side);
    if (!values.empty()) state.variables[first + v].push_back({region, std::move(values)});  // bare bone: none
  }
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
    object.data.push_back({XpltGroup::Global, XpltType::Vec3, XpltFormat::Node, item});
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

/// Per vertex of the articular surface what is beyond the selection's rim there: 1 nothing (free), 2 more of the layer,
/// 3 its mirror image, 4 the layer bonded to bone, 5 facets that another contact presses; the lower one where two meet;
/// 0: not on the rim.
std::vector<double> rim_at_vertices(const Layer& layer) {
  std::vector<double> rim(layer.articular.vertices.size(), 0.0);
  if (layer.face.mesh.size() == 0) return rim;
  for (const SelectionEdge& e : selection_rim(layer.face)) {
    const double kind = e.goes_on                 ? 2.0
                        : e.edge.shared           ? 5.0
                        : e.edge.rim == Rim::Free ? 1.0
                        : e.edge.bonded           ? 4.0
                                                  : 3.0;
    for (int v : e.vertices)
      if (rim[at(v)] == 0.0 || kind < rim[at(v)]) rim[at(v)] = kind;
  }
  return rim;
}

/// Per facet: 0 used, 1 left out as side wall, 2 left out as bonded to bone.
std::vector<double> left_out_facets(const SurfaceSide& side) {
  const Layer& layer = side.layer;
  std::vector<double> kinds(at(side.surface.size()), 0.0);
  for (int f = 0; f < side.surface.size(); ++f)
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
  const std::deque<Shown> shown = shown_contacts(model, joint, contacts);
  for (std::size_t s = 0; s < shown.size(); ++s) {
    if (shown[s].layer == nullptr || surface[s] == 0) continue;
    std::optional<SideFields> sum;  // one contact is the rule, and nothing to add
    if (shown[s].sides.size() > 1) sum = added_sides(shown[s].sides);
    const SideFields& side = sum ? *sum : *shown[s].sides.front();
    add_field_values(fields, {model.surfaces[s], *shown[s].layer, side}, surface[s], first, state);
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

std::vector<SurfaceField> check_fields() {
  using S = const SurfaceSide&;
  constexpr XpltType kType = XpltType::Float;
  return {
      thickness_field(),
      surface_field(kType, XpltFormat::Item, "joint space", "L", [](S s) { return per_facet(s.fields.joint_space); }),
      surface_field(kType, XpltFormat::Mult, "missed normal", "",
                    [](S s) { return per_slot(s, missed_normals(s.layer, *s.map)); }),
      surface_field(kType, XpltFormat::Mult, "rim", "", [](S s) { return per_slot(s, rim_at_vertices(s.layer)); }),
      surface_field(kType, XpltFormat::Item, "left out", "", [](S s) { return per_facet(left_out_facets(s)); })};
}

/// Each surface once, at the first contact that has it.
void add_check_fields(const JointModel& model, const PlotHead& head, const JointCheck& check,
                      const std::vector<SurfaceField>& fields, XpltState& state) {
  const FieldMaps maps = make_field_maps(model, check.joint);
  const std::vector<ContactFields> at_start = fields_at_start(check, maps);
  std::vector<char> done(model.surfaces.size(), 0);
  for (std::size_t c = 0; c < check.joint.contacts.size(); ++c) {
    for (int side = 0; side < 2; ++side) {
      const Layer& layer = check.joint.contacts[c].layers[side];
      const std::size_t surface = at(layer.surface);
      if (head.surface[surface] == 0 || done[surface]) continue;
      done[surface] = 1;
      add_field_values(fields,
                       {model.surfaces[surface], layer, at_start[c].sides[side], &maps.contacts[c].layers[side]},
                       head.surface[surface], 0, state);
    }
  }
  for (auto& regions : state.variables)
    std::sort(regions.begin(), regions.end(),
              [](const XpltRegion& a, const XpltRegion& b) { return a.region < b.region; });
}

/// The springs of every contact as lines through both layers, as a part of their own.
void add_spring_lines(const JointCheck& check, XpltMesh& mesh) {
  const std::size_t before = mesh.domains.size();
  int next_node = 1, next_element = 1;
  for (int id : mesh.node_ids) next_node = std::max(next_node, id + 1);
  for (const XpltDomain& d : mesh.domains)
    for (int id : d.element_ids) next_element = std::max(next_element, id + 1);
  for (std::size_t c = 0; c < check.joint.contacts.size(); ++c) {
    const ContactPair& pair = check.joint.contacts[c];
    const SpringStates& springs = check.springs[c];
    XpltDomain lines = {xplt_element_type(ElementShape::Line2),
                        static_cast<int>(mesh.parts.size()) + 1,
                        fmt::format("springs {}", pair.name),
                        {},
                        {}};
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
    if (!lines.element_ids.empty()) mesh.domains.push_back(std::move(lines));
  }
  if (mesh.domains.size() > before) mesh.parts.push_back("springs");
}

}  // namespace

PlotHead plot_head(const JointModel& model, const Joint& joint, bool compressed, bool inside) {
  PlotHead head = make_head(model);
  for (const Body& body : joint.bodies)
    if (!body.ground) head.file.meshes.front().objects.push_back(rigid_body_object(body));
  head.inside = inside;
  head.file.compressed = compressed;
  using T = XpltType;
  using F = XpltFormat;
  head.file.variables = {{XpltGroup::Nodal, T::Vec3, F::Node, "displacement", "L"},
                         {XpltGroup::Domain, T::Vec3, F::Region, "rigid force", "F"},
                         {XpltGroup::Domain, T::Vec3, F::Region, "rigid torque", "F.L"},
                         {XpltGroup::Domain, T::Vec3, F::Region, "rigid position", "L"}};
  if (inside || !joint.parts.empty()) {
    head.file.variables.push_back({XpltGroup::Domain, T::Mat3s, F::Item, "stress", "P"});
    head.file.variables.push_back({XpltGroup::Domain, T::Mat3s, F::Item, "Lagrange strain", ""});
  }
  for (const SurfaceField& f : surface_fields(inside)) head.file.variables.push_back(f.variable);
  return head;
}

XpltState plot_state(const JointModel& model, const Joint& joint, const PlotHead& head, const StateResult& result) {
  constexpr std::size_t kRigidForce = 1, kStress = 4;  // in the dictionary of plot_head
  const bool stress = head.inside || !joint.parts.empty();
  const std::size_t on_surfaces = kStress + (stress ? 2 : 0);
  const Equilibrium& e = result.equilibrium;
  XpltState state;
  state.time = number(result.when.time);
  state.status = solved(e.outcome) ? kStatusConverged : kStatusNotConverged;
  state.element_flags.assign(element_count(head.file.meshes.front()), 1);
  state.variables.resize(head.file.variables.size());
  std::vector<float> displacements;
  displacements.reserve(3 * result.displacements.size());
  for (const Vector3d& u : result.displacements) append(displacements, u);
  state.variables[0].push_back({0, std::move(displacements)});
  add_rigid_bodies(head.material_of_domain, joint, e, kRigidForce, state);
  add_surface_fields(model, head.surface, joint, result.fields, surface_fields(head.inside), on_surfaces, state);
  if (stress) add_inside_fields(model, with_parts(model, joint, result.parts, result.inside), kStress, state);
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

XpltMesh plot_mesh(const JointModel& model) { return std::move(make_head(model).file.meshes.front()); }

XpltFile make_check_file(const JointModel& model, const JointCheck& check) {
  PlotHead head = make_head(model);
  const std::vector<SurfaceField> fields = check_fields();
  for (const SurfaceField& f : fields) head.file.variables.push_back(f.variable);
  XpltState state;
  state.variables.resize(fields.size());
  add_check_fields(model, head, check, fields, state);
  XpltMesh& mesh = head.file.meshes.front();
  add_spring_lines(check, mesh);
  state.element_flags.assign(element_count(mesh), 1);
  head.file.states.push_back(std::move(state));
  return std::move(head.file);
}

}  // namespace dea

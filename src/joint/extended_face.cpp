#include "src/joint/extended_face.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <unordered_map>
#include <utility>

#include "src/base/numbers.h"
#include "src/geometry/ray_caster.h"
#include "src/geometry/thickness.h"
#include "src/joint/layer_support.h"

namespace dea {

namespace {

/// Does the domain belong to this body, rigid with it?
bool rigid_with(const ModelParts& parts, const Domain& d, int body) {
  return d.material >= 0 && parts.rigid[at(d.material)] && parts.bodies.of_material[at(d.material)] == body;
}

/// Per domain: solid elements of the body under a surface with a map. A layer may have several such surfaces.
std::vector<char> mapped_domains(const ModelParts& parts, int body) {
  const JointModel& model = parts.model;
  std::vector<char> mapped(model.domains.size(), 0);
  for (const Contact& c : model.contacts) {
    for (std::size_t side = 0; side < 2 && c.dea && c.primary >= 0 && c.secondary >= 0; ++side) {
      if (c.dea->layers[side].thickness_map.empty()) continue;
      const Surface& s = model.surfaces[at(side == 0 ? c.primary : c.secondary)];
      for (int f = 0; f < s.size(); ++f) {
        const ElementFace* face = carrier(parts, find_face(parts, s, f));
        if (face == nullptr) continue;
        const Domain& d = model.domains[at(face->domain)];
        if (!is_shell(d.shape) && rigid_with(parts, d, body)) mapped[at(face->domain)] = 1;
      }
    }
  }
  return mapped;
}

/// Are they as thick as the map says, within kSame for nearly all vertices inside?
bool as_thick_as(const std::vector<double>& said, const SurfaceMesh& articular, const SurfaceMesh& bone) {
  constexpr double kSame = 0.02;
  const std::vector<double> measured = measure_thickness(articular, bone).thickness;
  const std::vector<char> on_rim = rim_vertices(articular);  // whose normals are one-sided
  std::size_t same = 0, others = 0;
  for (std::size_t v = 0; v < said.size(); ++v) {
    const bool is_same = std::abs(measured[v] - said[v]) <= kSame * said[v];
    same += is_same;
    others += !is_same && !on_rim[v];
  }
  return same > 9 * others;
}

}  // namespace

std::vector<double> mapped_thickness(const Surface& s, const std::vector<double>& map, const SurfaceMesh& mesh) {
  std::unordered_map<int, std::array<double, 2>> sums;  // node -> sum, count
  for (std::size_t k = 0; k < s.nodes.size(); ++k) {
    auto& sum = sums[s.nodes[k]];
    sum[0] += map[k];
    sum[1] += 1;
  }
  std::vector<double> thickness;
  for (int node : mesh.model_nodes) thickness.push_back(sums.at(node)[0] / sums.at(node)[1]);
  return thickness;
}

LayerBoundary rigid_boundary(const ContactSide& in, const CarriedSurface& carried, const Layer& layer,
                             const std::vector<double>& map) {
  const ModelParts& parts = in.parts;
  const JointModel& model = parts.model;
  const std::vector<char> own = mapped_domains(parts, layer.body);
  std::vector<LayerElement> elements;
  std::vector<char> held(model.nodes.size(), 0);
  for (int i = 0; i < static_cast<int>(model.domains.size()); ++i) {
    const Domain& d = model.domains[at(i)];
    if (own[at(i)]) {
      for (int e = 0; e < static_cast<int>(d.element_ids.size()); ++e) elements.push_back({i, e});
    } else if (!is_line(d.shape) && rigid_with(parts, d, layer.body)) {
      for (int node : d.nodes) held[at(node)] = 1;
    }
  }
  LayerBoundary boundary = find_layer_boundary(model, elements, std::move(held));
  open_feather_facets(model, carried.facets, boundary);
  const SurfaceMesh bone = bonded_surface(model, boundary, in.in_plane);
  if (bone.size() == 0) return {};
  find_side_walls(model, bone, boundary);
  const FacetList kept = kept_facets(carried.facets, kinds_of(boundary, carried.facets));
  const SurfaceMesh articular = make_surface_mesh(kept.begin, kept.nodes, model.nodes, nullptr, in.in_plane);
  if (articular.size() == 0) return {};
  const std::vector<double> said = mapped_thickness(model.surfaces[at(layer.surface)], map, articular);
  return as_thick_as(said, articular, bone) ? boundary : LayerBoundary{};
}

bool is_pressed_by_others(const ContactSide& in, const LayerBoundary& boundary) {
  const JointModel& model = in.parts.model;
  const std::string& chosen = in.parts.settings.contact;
  std::set<int> own;  // filled where there is another contact at all
  for (const Contact& other : model.contacts) {
    if (other.kind != Contact::Kind::Sliding || other.primary < 0 || other.secondary < 0 ||
        !at_same_time(other.step, in.contact.step) || (!chosen.empty() && other.name != chosen) ||
        (other.primary == in.contact.primary && other.secondary == in.contact.secondary))
      continue;
    if (own.empty()) own.insert(boundary.faces.nodes.begin(), boundary.faces.nodes.end());
    for (const int index : {other.primary, other.secondary}) {
      const std::vector<int>& of = model.surfaces[at(index)].nodes;
      if (index != in.index && std::any_of(of.begin(), of.end(), [&](int node) { return own.count(node) > 0; }))
        return true;
    }
  }
  return false;
}

void find_layer_face(const ContactSide& in, Facets facets, const CarriedSurface& carried, const LayerBoundary& boundary,
                     Layer& layer) {
  const ModelParts& parts = in.parts;
  const JointModel& model = parts.model;
  const NodeThickness* said = node_thickness(parts.settings, model.surfaces[at(layer.surface)].name);
  double deepest = layer.max_thickness();
  if (layer.material < 0 &&
      said == nullptr) {  // rigid_boundary: as far as before the conversion, though the map knows the rim better
    const std::vector<double> measured =
        measure_thickness(layer.articular, bonded_surface(model, boundary, in.in_plane)).thickness;
    deepest = layer.thickness_scale * *std::max_element(measured.begin(), measured.end());
  }
  layer.face = grow_face(model, boundary, kept_facets(carried.facets, layer.facet_kinds), layer.articular, deepest,
                         is_pressed_by_others(in, boundary), parts.holders.held_components, in.in_plane);
  const std::size_t vertices = layer.articular.vertices.size(), triangles = layer.articular.triangles.size();
  SurfaceMesh& mesh = layer.face.mesh;
  layer.face.thickness = layer.thickness;
  if (mesh.triangles.size() == triangles) return;
  if (facets == Facets::Flat) flatten(mesh);
  // a map says nothing of what is beyond it; where a map replaced the model's own layer (rigid_boundary), the elements
  // are as thick as it says
  if (said == nullptr && (!layer.thickness_given || layer.material < 0)) {
    const MeasuredThickness measured =
        measure_thickness(mesh, layer.thickness_given ? bonded_surface(model, boundary, in.in_plane) : layer.bone);
    for (std::size_t v = vertices; v < mesh.vertices.size(); ++v)
      layer.face.thickness.push_back(layer.thickness_scale * measured.thickness[v]);
    return;
  }
  const RayCaster caster(layer.articular);
  for (std::size_t v = vertices; v < mesh.vertices.size(); ++v) {
    const double* own = said == nullptr ? nullptr : thickness_at(*said, model.node_ids[at(mesh.model_nodes[v])]);
    layer.face.thickness.push_back(
        own != nullptr ? layer.thickness_scale * *own
                       : interpolate(layer.articular, layer.thickness, caster.closest(mesh.vertices[v])));
  }
}

}  // namespace dea

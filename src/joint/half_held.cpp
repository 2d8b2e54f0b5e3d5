#include "src/joint/half_held.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "src/base/numbers.h"

namespace dea {

namespace {

/// Nodes of the layer in a plane, those of its bone aside: the bone holds them.
struct PlaneNodes {
  int all = 0, held = 0;
};

PlaneNodes nodes_in(const ModelParts& parts, const Layer& layer, int component, double coordinate, double tolerance) {
  PlaneNodes count;
  for (int node : layer.region_nodes.empty() ? layer.face.mesh.model_nodes : layer.region_nodes) {
    if (parts.bodies.of_node[at(node)] >= 0 ||
        !(std::abs(parts.model.nodes[at(node)][component] - coordinate) <= tolerance))
      continue;
    ++count.all;
    count.held += (parts.holders.mirror[at(node)] >> component & 1) != 0;
  }
  return count;
}

}  // namespace

std::vector<HalfHeldPlane> half_held_planes(const ModelParts& parts, const Layer& layer) {
  const SurfaceMesh& mesh = layer.face.mesh;
  const double tolerance = parts.holders.same_plane;
  std::vector<HalfHeldPlane> planes;
  for (const LayerFace::Edge& e : layer.face.edges) {
    const Vector3d &a = mesh.corner(e.triangle, e.edge), &b = mesh.corner(e.triangle, (e.edge + 1) % 3);
    const Vector3d out = outward_at(mesh, e.triangle, e.edge);
    for (int k = 0; k < 3; ++k) {
      if (!(std::abs(out[k]) > kIntoPlane) || !(std::abs(a[k] - b[k]) <= tolerance)) continue;
      HalfHeldPlane* plane = nullptr;
      for (HalfHeldPlane& p : planes)
        if (p.component == k && std::abs(p.coordinate - a[k]) <= tolerance) plane = &p;
      if (plane == nullptr) {
        planes.push_back({k, a[k], 0, 0});
        plane = &planes.back();
      }
      ++plane->edges;
      plane->unheld += e.rim == Rim::Free;
    }
  }
  std::vector<HalfHeldPlane> found;
  for (const HalfHeldPlane& plane : planes) {
    if (plane.unheld == 0) continue;
    const PlaneNodes nodes = nodes_in(parts, layer, plane.component, plane.coordinate, tolerance);
    if (nodes.held > 1 && 5 * nodes.held >= nodes.all) found.push_back(plane);
  }
  return found;
}

std::vector<HeldNodes> held_without_plane(const ModelParts& parts, const Layer& layer) {
  const double near_by = 2 * parts.holders.same_plane;
  std::vector<HeldNodes> found;
  for (int k = 0; k < 3; ++k) {
    std::vector<double> told;  // where another remark, or the mechanics itself, has these nodes
    for (const SymmetryPlane& plane : layer.planes)
      if (plane.axis == k) told.push_back(plane.at);
    for (const HalfHeldPlane& plane : layer.half_held)
      if (plane.component == k) told.push_back(plane.coordinate);
    for (const LayerFace::Edge& e : layer.face.edges)
      if (e.rim == Rim::Wall && !e.shared && std::abs(outward_at(layer.face.mesh, e.triangle, e.edge)[k]) > kIntoPlane)
        told.push_back(layer.face.mesh.corner(e.triangle, e.edge)[k]);
    HeldNodes held;
    held.component = k;
    for (const int node : layer.region_nodes) {
      if (parts.bodies.of_node[at(node)] >= 0 || !parts.holders.of_node[at(node)].empty()) continue;
      if ((parts.holders.mirror[at(node)] >> k & 1) == 0) continue;
      const Vector3d& x = parts.model.nodes[at(node)];
      const bool known =
          std::any_of(told.begin(), told.end(), [&](double at) { return std::abs(x[k] - at) <= near_by; }) ||
          std::any_of(layer.ends.begin(), layer.ends.end(), [&](const PartEnd& end) {
            return end.instead == k && std::abs(x[end.plane.axis] - end.plane.at) <= near_by;
          });
      if (!known) held.nodes.push_back(node);
    }
    if (!held.nodes.empty()) found.push_back(std::move(held));
  }
  return found;
}

std::vector<HeldFace> held_where_it_gives_way(const ModelParts& parts, const Layer& layer) {
  constexpr double kCartilage = 0.1;  // of the mean thickness: thinner, the layer runs out to its bone
  const auto holders_of = [&](int node) {
    std::set<int> bodies(parts.holders.of_node[at(node)].begin(), parts.holders.of_node[at(node)].end());
    if (parts.bodies.of_node[at(node)] >= 0) bodies.insert(parts.bodies.of_node[at(node)]);
    return bodies;
  };
  HeldFace face;
  face.body = layer.body;
  face.on_face = true;
  const SurfaceMesh& mesh = layer.articular;
  if (layer.thickness.size() == mesh.vertices.size() && !layer.region_nodes.empty()) {
    const std::vector<char> on_rim = rim_vertices(mesh);
    const double thick = kCartilage * layer.mean_thickness();
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
      if (!on_rim[v] && layer.thickness[v] > thick && holders_of(mesh.model_nodes[v]).count(layer.body) > 0)
        face.nodes.push_back(mesh.model_nodes[v]);
  }
  std::map<int, std::vector<int>> by_others;
  for (const int node : layer.region_nodes) {
    const std::set<int> bodies = holders_of(node);
    if (bodies.count(layer.body) > 0) continue;
    for (const int body : bodies) by_others[body].push_back(node);
  }
  std::vector<HeldFace> found;
  if (!face.nodes.empty()) found.push_back(std::move(face));
  for (auto& [body, nodes] : by_others) {
    HeldFace other;
    other.body = body;
    other.nodes = std::move(nodes);
    found.push_back(std::move(other));
  }
  return found;
}

}  // namespace dea

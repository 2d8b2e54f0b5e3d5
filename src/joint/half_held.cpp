#include <febiodea/joint/half_held.h>

#include <cmath>

#include <febiodea/base/numbers.h>

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
  constexpr double kInto = 0.7;  // the face must run into the plane, not along it
  const SurfaceMesh& mesh = layer.face.mesh;
  const double tolerance = parts.holders.same_plane;
  std::vector<HalfHeldPlane> planes;
  for (const LayerFace::Edge& e : layer.face.edges) {
    const Vector3d &a = mesh.corner(e.triangle, e.edge), &b = mesh.corner(e.triangle, (e.edge + 1) % 3);
    const Vector3d outward = (b - a).cross(mesh.normals[at(e.triangle)]).normalized();
    for (int k = 0; k < 3; ++k) {
      if (!(std::abs(outward[k]) > kInto) || !(std::abs(a[k] - b[k]) <= tolerance)) continue;
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

}  // namespace dea

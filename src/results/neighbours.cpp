#include "src/results/neighbours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "src/base/numbers.h"

namespace dea {

namespace {

using EdgeNodes = std::array<int, 2>;  // of the model, the lesser first

EdgeNodes nodes_of(const SurfaceMesh& mesh, const LayerFace::Edge& e) {
  const auto& corners = mesh.triangles[at(e.triangle)];
  const int a = mesh.model_nodes[at(corners[at(e.edge)])], b = mesh.model_nodes[at(corners[at((e.edge + 1) % 3)])];
  return {std::min(a, b), std::max(a, b)};
}

/// The edges of a layer's face beyond which another contact presses.
std::set<EdgeNodes> shared_edges(const Layer& layer) {
  std::set<EdgeNodes> edges;
  for (const LayerFace::Edge& e : layer.face.edges)
    if (e.shared) edges.insert(nodes_of(layer.face.mesh, e));
  return edges;
}

/// The ends of those edges of the layer that are among these.
std::vector<std::array<Vector3d, 2>> segments(const Layer& layer, const std::set<EdgeNodes>& edges) {
  std::vector<std::array<Vector3d, 2>> found;
  const SurfaceMesh& mesh = layer.face.mesh;
  for (const LayerFace::Edge& e : layer.face.edges)
    if (edges.count(nodes_of(mesh, e)) > 0)
      found.push_back({mesh.corner(e.triangle, e.edge), mesh.corner(e.triangle, (e.edge + 1) % 3)});
  return found;
}

/// Mean pressure of the facets whose centres are within `reach` of these lines; 0 where the contact does not act.
double mean_near(const Layer& layer, const std::vector<double>& pressure,
                 const std::vector<std::array<Vector3d, 2>>& lines, double reach) {
  const SurfaceMesh& mesh = layer.articular;
  double force = 0.0, area = 0.0;
  for (int t = 0; t < mesh.size() && !pressure.empty(); ++t) {
    const Vector3d x = mesh.centroid(t);
    const bool near = std::any_of(lines.begin(), lines.end(), [&](const std::array<Vector3d, 2>& line) {
      return distance_to_segment(x, line[0], line[1]) <= reach;
    });
    if (!near) continue;
    force += mesh.areas[at(t)] * pressure[at(mesh.facet[at(t)])];
    area += mesh.areas[at(t)];
  }
  return area > 0 ? force / area : 0.0;
}

}  // namespace

std::optional<UnevenNeighbour> uneven_neighbour(const Joint& joint, const std::vector<ContactFields>& fields, int c,
                                                double above) {
  constexpr double kAlike = 0.3, kReach = 2.0;  // thicknesses
  std::optional<UnevenNeighbour> worst;
  const auto size = [](const UnevenNeighbour& n) { return std::abs(n.own - n.beyond); };
  if (joint.contacts[at(c)].law != Law::Layer) return worst;
  for (std::size_t side = 0; side < 2; ++side) {
    const Layer& layer = joint.contacts[at(c)].layers[side];
    const std::set<EdgeNodes> own = shared_edges(layer);
    if (own.empty()) continue;
    for (int other = 0; other < static_cast<int>(joint.contacts.size()); ++other)
      for (std::size_t of = 0; of < 2 && other != c; ++of) {
        const Layer& beside = joint.contacts[at(other)].layers[of];
        if (beside.body != layer.body) continue;
        const auto lines = segments(beside, own);
        if (lines.empty()) continue;
        const double reach = kReach * layer.mean_thickness();
        UnevenNeighbour found;
        found.other = other;
        found.surface = layer.surface;
        found.own = mean_near(layer, fields[at(c)].sides[side].pressure, lines, reach);
        found.beyond = mean_near(beside, fields[at(other)].sides[of].pressure, lines, reach);
        if (found.own > above && size(found) > kAlike * std::max(found.own, found.beyond) &&
            (!worst || size(found) > size(*worst)))
          worst = found;
      }
  }
  return worst;
}

}  // namespace dea

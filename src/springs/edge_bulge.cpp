#include "src/springs/edge_bulge.h"

#include <algorithm>
#include <cmath>

#include "src/base/numbers.h"
#include "src/springs/gaps.h"

namespace dea {

namespace {

constexpr double kDecay = 0.6;  // thicknesses
constexpr double kFar = 3.0;    // beyond so many nothing is felt

/// A spring beside a free edge.
struct EdgeSpring {
  Vector3d where;       ///< the layer's reference frame
  double reach = 0.0;   ///< the edge's vertices within it know of the spring
  double weight = 1.0;  ///< among others
  double pressure = 0.0;
  double goes_on = 0.0;  ///< 1: the partner does, over the edge
};

Vector3d outward_of(const LayerMesh& layer, const LayerMesh::Edge& edge) {
  return (layer.mesh.vertices[at(edge.b)] - layer.mesh.vertices[at(edge.a)])
      .cross(layer.mesh.normals[at(edge.triangle)])
      .normalized();
}

/// The vertex of a triangle that is nearest to a free edge.
int nearest_vertex(const LayerMesh& layer, int triangle) {
  const auto& corners = layer.mesh.triangles[at(triangle)];
  const auto nearer = [&](int v, int w) { return layer.edge_distance[at(v)] < layer.edge_distance[at(w)]; };
  return *std::min_element(corners.begin(), corners.end(), nearer);
}

/// Beside the source's own free edges: of each edge the spring whose triangle it belongs to. `reach`: springs further
/// from the target have no part in the contact.
std::vector<EdgeSpring> springs_at_source(const PosedBed& posed, const SpringStates& s, double reach) {
  const SpringBed& bed = *posed.bed;
  const LayerMesh& layer = bed.layers->source.layer->mesh;
  const RelativePose relative = relative_pose(posed.source, bed.source_center, posed.target, bed.target_center);
  std::vector<int> spring(at(layer.mesh.size()), -1);
  for (int i = 0; i < s.size(); ++i)
    if (s.area[at(i)] > 0 && s.gap[at(i)] < reach) spring[at(bed.layers->source_triangle[at(i)])] = i;
  std::vector<EdgeSpring> found;
  for (const LayerMesh::Edge& edge : layer.edges) {
    const int i = spring[at(edge.triangle)];
    if (edge.rim != Rim::Free || i < 0) continue;
    const Vector3d middle = 0.5 * (layer.mesh.vertices[at(edge.a)] + layer.mesh.vertices[at(edge.b)]),
                   beyond = middle + 0.25 * bed.foot_radius * outward_of(layer, edge);
    found.push_back({middle, edge.length, 1.0, s.pressure[at(i)], faces_target(bed, relative, i, beyond) ? 1.0 : 0.0});
  }
  return found;
}

/// Beside the target's: springs that end there.
std::vector<EdgeSpring> springs_at_target(const PosedBed& posed, const SpringStates& s, double reach) {
  const SpringBed& bed = *posed.bed;
  const BedLayer& target = bed.layers->target;
  const LayerMesh& layer = target.layer->mesh;
  const SurfaceMesh& source = bed.pair.source_layer().spring_surface();
  std::vector<EdgeSpring> found;
  for (int i = 0; i < s.size(); ++i) {
    const auto k = at(i);
    if (!(s.area[k] > 0) || !(s.gap[k] < reach)) continue;
    const int near_by =
        layer.nearest_edge[at(nearest_vertex(layer, target.mesh_triangle(s.triangle[k], s.end_weights[k])))];
    if (near_by < 0) continue;
    const LayerMesh::Edge& edge = layer.edges[at(near_by)];
    const Vector3d end = bed.target_center + posed.target.rotation.transpose() * (s.end[k] - posed.target.center);
    const double distance = distance_to_segment(end, layer.mesh.vertices[at(edge.a)], layer.mesh.vertices[at(edge.b)]),
                 within = 1.5 * bed.foot_radius;
    if (distance >= within) continue;
    const auto& beside = source.neighbours[at(bed.springs.surface_triangle[k])];
    const bool goes_on = *std::min_element(beside.begin(), beside.end()) >= 0;
    found.push_back({end, 2 * within, 1 - distance / within, s.pressure[k], goes_on ? 1.0 : 0.0});
  }
  return found;
}

/// Per vertex of the layer's mesh: how far its free edge moves outwards. Empty: nowhere.
std::vector<double> edge_moves(const LayerOperator& layer, const std::vector<EdgeSpring>& springs,
                               const EdgeFlow& flow) {
  if (springs.empty()) return {};
  std::vector<double> moves(at(layer.mesh.nodes()), 0.0);
  for (const LayerOperator::EdgeVertex& v : layer.edge_vertices) {
    const Vector3d& x = layer.mesh.mesh.vertices[at(v.node)];
    double weights = 0.0, pressure = 0.0, goes_on = 0.0;
    for (const EdgeSpring& spring : springs) {
      const double weight = spring.weight * (1 - (spring.where - x).norm() / spring.reach);
      if (!(weight > 0)) continue;
      weights += weight;
      pressure += weight * spring.pressure;
      goes_on += weight * spring.goes_on;
    }
    if (goes_on > 0) moves[at(v.node)] = goes_on / weights * edge_move(layer, v.node, flow(), pressure / weights);
  }
  return moves;
}

/// How the layer's surface has moved in a triangle of its mesh.
struct SurfaceMove {
  Vector3d way = Vector3d::Zero();  ///< reference frame
  double stretch = 0.0;
};
SurfaceMove move_in(const LayerMesh& layer, const std::vector<double>& moves, int triangle) {
  SurfaceMove found;
  const int near_by = layer.nearest_edge[at(nearest_vertex(layer, triangle))];
  if (near_by < 0) return found;
  double distance = 0.0, thickness = 0.0;
  for (const int v : layer.mesh.triangles[at(triangle)]) {
    distance += layer.edge_distance[at(v)] / 3;
    thickness += layer.thickness[at(v)] / 3;
  }
  const LayerMesh::Edge& edge = layer.edges[at(near_by)];
  const double move = 0.5 * (moves[at(edge.a)] + moves[at(edge.b)]);
  if (move == 0 || !(distance < kFar * thickness)) return found;
  const double here = move * (std::exp(-distance / (kDecay * thickness)) - std::exp(-kFar / kDecay));
  found.way = here * outward_of(layer, edge);
  found.stretch = here / (kDecay * thickness);
  return found;
}

}  // namespace

void press_bulges(const PosedBed& posed, const std::array<EdgeFlow, 2>& flow, SpringStates& s) {
  constexpr double kLeastOverlap = 0.25;             // of the largest
  constexpr double kMostLost = -0.5, kMostMore = 1;  // of a foot's area, of its pressure
  const LayerBed& bed = *posed.bed->layers;
  const double deepest = *std::max_element(s.overlap.begin(), s.overlap.end()), least = kLeastOverlap * deepest;
  if (!(deepest > 0)) return;
  std::vector<double> more(at(s.size()), 0.0);  // pressure
  for (const std::size_t side : {0, 1}) {
    const LayerOperator* layer = (side == 0 ? bed.source : bed.target).layer.get();
    if (layer == nullptr || layer->edge_vertices.empty()) continue;
    const std::vector<double> moves = edge_moves(
        *layer, side == 0 ? springs_at_source(posed, s, deepest) : springs_at_target(posed, s, deepest), flow[side]);
    if (moves.empty()) continue;
    for (int i = 0; i < s.size(); ++i) {
      const auto k = at(i);
      if (!(s.pressure[k] > 0)) continue;
      const SurfaceMove move =
          move_in(layer->mesh, moves,
                  side == 0 ? bed.source_triangle[k] : bed.target.mesh_triangle(s.triangle[k], s.end_weights[k]));
      if (move.stretch == 0) continue;
      const Vector3d way = (side == 0 ? posed.source : posed.target).rotation * move.way;
      const double opening =
          side == 0 ? -way.dot(s.normal[k]) / s.direction[k].dot(s.normal[k]) : way.dot(s.direction[k]);
      s.beyond[k] = std::max(kMostLost * s.area[k], s.beyond[k] + s.area[k] * move.stretch);
      more[k] -= opening / std::max(s.overlap[k], least);
    }
  }
  for (std::size_t k = 0; k < more.size(); ++k) s.pressure[k] *= 1 + std::clamp(more[k], kMostLost, kMostMore);
}

}  // namespace dea

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
  Vector3d where;         ///< in the layer's reference frame
  double reach = 0.0;     ///< the edge's vertices within it know of the spring
  double weight = 0.0;    ///< of its pressure among others
  double pressure = 0.0;  ///< 0: none
  double judges = 0.0;    ///< weight of the next
  bool goes_on = false;   ///< the partner does, over the edge
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

/// What a contact presses of one of its layers.
struct PressedSide {
  const PosedBed& posed;
  const SpringStates& states;
  bool source;  ///< its layer is the source's
  const LayerOperator& layer;

  int triangle(std::size_t k) const {
    const LayerBed& bed = *posed.bed->layers;
    return source ? bed.source_triangle[k] : bed.target.mesh_triangle(states.triangle[k], states.end_weights[k]);
  }
  /// Where spring k stands on the layer, in its reference frame.
  Vector3d place(std::size_t k) const {
    const SpringBed& bed = *posed.bed;
    if (source) return bed.source_center + posed.source.rotation.transpose() * (states.foot[k] - posed.source.center);
    return bed.target_center + posed.target.rotation.transpose() * (states.end[k] - posed.target.center);
  }
};

/// Springs beside the layer's free edges. `reach`: those further from the target have no part in the contact.
std::vector<EdgeSpring> edge_springs(const PressedSide& side, double reach) {
  constexpr double kWindow = 0.5;  // thicknesses
  const SpringBed& bed = *side.posed.bed;
  const SpringStates& s = side.states;
  const LayerMesh& layer = side.layer.mesh;
  const SurfaceMesh& source = bed.pair.source_layer().spring_surface();
  const RelativePose relative =
      relative_pose(side.posed.source, bed.source_center, side.posed.target, bed.target_center);
  std::vector<EdgeSpring> found;
  for (int i = 0; i < s.size(); ++i) {
    const auto k = at(i);
    if (!(s.area[k] > 0) || !(s.gap[k] < reach)) continue;
    const int vertex = nearest_vertex(layer, side.triangle(k)), near_by = layer.nearest_edge[at(vertex)];
    if (near_by < 0) continue;
    const LayerMesh::Edge& edge = layer.edges[at(near_by)];
    const Vector3d &a = layer.mesh.vertices[at(edge.a)], &b = layer.mesh.vertices[at(edge.b)], place = side.place(k);
    const double distance = distance_to_segment(place, a, b),
                 window = std::max(kWindow * layer.thickness[at(vertex)], 1.5 * bed.foot_radius);
    if (distance >= window) continue;
    EdgeSpring spring{place, 2 * window, s.area[k] * (1 - distance / window), s.pressure[k]};
    spring.judges = std::max(0.0, 1 - distance / (1.5 * bed.foot_radius));
    if (spring.judges > 0 && side.source) {
      const double along = std::clamp((place - a).dot(b - a) / std::max((b - a).squaredNorm(), 1e-300), 0.0, 1.0);
      spring.goes_on =
          faces_target(bed, relative, i, a + along * (b - a) + 0.25 * bed.foot_radius * outward_of(layer, edge));
    } else if (spring.judges > 0) {
      const auto& beside = source.neighbours[at(bed.springs.surface_triangle[k])];
      spring.goes_on = *std::min_element(beside.begin(), beside.end()) >= 0;
    }
    found.push_back(spring);
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
    double weights = 0.0, pressure = 0.0, judges = 0.0, goes_on = 0.0;
    for (const EdgeSpring& spring : springs) {
      const double near_by = 1 - (spring.where - x).norm() / spring.reach;
      if (!(near_by > 0)) continue;
      weights += near_by * spring.weight;
      pressure += near_by * spring.weight * spring.pressure;
      judges += near_by * spring.judges;
      if (spring.goes_on) goes_on += near_by * spring.judges;
    }
    if (goes_on > 0) moves[at(v.node)] = goes_on / judges * edge_move(layer, v.node, flow(), pressure / weights);
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
  for (const bool source : {true, false}) {
    const LayerOperator* layer = (source ? bed.source : bed.target).layer.get();
    if (layer == nullptr || layer->edge_vertices.empty()) continue;
    const PressedSide side{posed, s, source, *layer};
    const std::vector<double> moves = edge_moves(*layer, edge_springs(side, deepest), flow[source ? 0 : 1]);
    if (moves.empty()) continue;
    for (std::size_t k = 0; k < more.size(); ++k) {
      if (!(s.pressure[k] > 0)) continue;
      const SurfaceMove move = move_in(layer->mesh, moves, side.triangle(k));
      if (move.stretch == 0) continue;
      const Vector3d way = (source ? posed.source : posed.target).rotation * move.way;
      const double opening = source ? -way.dot(s.normal[k]) / s.direction[k].dot(s.normal[k]) : way.dot(s.direction[k]);
      s.beyond[k] = std::max(kMostLost * s.area[k], s.beyond[k] + s.area[k] * move.stretch);
      more[k] -= opening / std::max(s.overlap[k], least);
    }
  }
  for (std::size_t k = 0; k < more.size(); ++k) s.pressure[k] *= 1 + std::clamp(more[k], kMostLost, kMostMore);
}

}  // namespace dea

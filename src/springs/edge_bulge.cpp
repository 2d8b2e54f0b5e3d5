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
  double goes_on = 0.0;   ///< how much the partner presses on, over the edge: 0 to 1
};

/// What a contact presses of one of its layers.
struct PressedSide {
  const PosedBed& posed;
  const SpringStates& states;
  bool source;  ///< its layer is the source's
  const LayerOperator& layer;

  /// Where spring k stands on the layer, in its reference frame.
  Vector3d point(std::size_t k) const {
    const SpringBed& bed = *posed.bed;
    if (source) return bed.source_center + posed.source.rotation.transpose() * (states.foot[k] - posed.source.center);
    return bed.target_center + posed.target.rotation.transpose() * (states.end[k] - posed.target.center);
  }
  /// On its mesh.
  SurfacePoint place(std::size_t k) const {
    const LayerBed& bed = *posed.bed->layers;
    const int t = source ? bed.source_triangle[k] : bed.target.mesh_triangle(states.triangle[k], states.end_weights[k]);
    const SurfaceMesh& mesh = layer.mesh.mesh;
    if (!(mesh.areas[at(t)] > 0)) return {t, {1.0 / 3, 1.0 / 3, 1.0 / 3}};
    return {t, weights_in({mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)}, point(k))};
  }
};

/// How much of the source's free edge at this triangle lies under target that goes on: by the triangle's image beyond,
/// which is asked only where the target's triangle `hit` is near its own rim. NaN: no such edge.
double goes_on_over(const SpringBed& bed, const RelativePose& relative, const LayerMesh& layer, int triangle, int hit,
                    double gap) {
  const bool far_from_rim = bed.rim_distance[at(hit)] >= 4.0 * bed.foot_radius;
  const auto edge = std::lower_bound(layer.edges.begin(), layer.edges.end(), triangle,
                                     [](const LayerMesh::Edge& e, int t) { return e.triangle < t; });
  double covered = 0.0, count = 0.0;
  for (auto e = edge; e != layer.edges.end() && e->triangle == triangle; ++e) {
    if (e->rim != Rim::Free) continue;
    count += 1;
    if (far_from_rim) {
      covered += 1;
      continue;
    }
    const auto& corners = layer.mesh.triangles[at(triangle)];
    const int third = corners[0] + corners[1] + corners[2] - e->a - e->b;
    const Vector3d &a = layer.mesh.vertices[at(e->a)], &b = layer.mesh.vertices[at(e->b)];
    covered += covered_part(bed, relative, {b, a, a + b - layer.mesh.vertices[at(third)]},
                            layer.mesh.normals[at(triangle)], gap);
  }
  return count > 0 ? covered / count : kNaN;
}

/// Springs beside the layer's free edges.
std::vector<EdgeSpring> edge_springs(const PressedSide& side) {
  constexpr double kWindow = 0.5, kApart = 0.1;  // thicknesses; what is further apart has no part in the contact
  const SpringBed& bed = *side.posed.bed;
  const SpringStates& s = side.states;
  const LayerMesh& layer = side.layer.mesh;
  const RelativePose relative =
      relative_pose(side.posed.source, bed.source_center, side.posed.target, bed.target_center);
  std::vector<EdgeSpring> found;
  for (std::size_t k = 0; k < at(s.size()); ++k) {
    if (!(s.area[k] > 0)) continue;
    const SurfacePoint place = side.place(k);
    const double distance = interpolate(layer.mesh, layer.edge_distance, place),
                 width = 1.1 * std::sqrt(2 * bed.springs.area[k]),  // of a foot, and a little more
        window = std::max(kWindow * interpolate(layer.mesh, layer.thickness, place), width);
    if (distance >= window) continue;
    EdgeSpring spring{side.point(k), 2 * window};
    const double partakes =
        std::clamp(1 - s.gap[k] / std::max(kApart * (s.t_source[k] + s.t_target[k]), 1e-300), 0.0, 1.0);
    spring.weight = partakes * s.area[k] * (1 - distance / window);
    spring.pressure = s.pressure[k];
    if (side.source) {
      const double covered =
          partakes > 0 ? goes_on_over(bed, relative, layer, place.triangle, s.triangle[k], s.gap[k]) : 0.0;
      spring.judges = std::isnan(covered) ? 0.0 : s.coverage[k];
      spring.goes_on = std::isnan(covered) ? 0.0 : partakes * covered;
    } else {
      spring.goes_on = bed.layers->ends[at(bed.springs.surface_triangle[k])] ? 0.0 : partakes;
      spring.judges = s.coverage[k] * std::max(0.0, 1 - distance / width);
    }
    found.push_back(spring);
  }
  return found;
}

/// How far the layer's free edges move outwards, per vertex of its mesh. Empty: nowhere.
std::vector<double> edge_moves(const PressedSide& side, const EdgeFlow& flow) {
  const LayerOperator& layer = side.layer;
  const std::vector<EdgeSpring> springs = edge_springs(side);
  if (springs.empty()) return {};
  std::vector<double> moves(at(layer.mesh.nodes()), 0.0);
  for (const LayerOperator::EdgeVertex& v : layer.edge_vertices) {
    const Vector3d& x = layer.mesh.mesh.vertices[at(v.node)];
    double weights = 0.0, pressure = 0.0, judges = 0.0, goes_on = 0.0;
    for (const EdgeSpring& spring : springs) {
      const double away2 = (spring.where - x).squaredNorm();
      if (away2 >= spring.reach * spring.reach) continue;
      const double near_by = 1 - std::sqrt(away2) / spring.reach;
      weights += near_by * spring.weight;
      pressure += near_by * spring.weight * spring.pressure;
      judges += near_by * spring.judges;
      goes_on += near_by * spring.judges * spring.goes_on;
    }
    if (goes_on > 0)
      moves[at(v.node)] = goes_on / judges * edge_move(layer, v.node, flow(side.source), pressure / weights);
  }
  return moves;
}

/// How much is left of the edge's move so far from it.
double share_left(double distance, double thickness) {
  return std::max(0.0, std::exp(-distance / (kDecay * thickness)) - std::exp(-kFar / kDecay));
}

/// How the surface has moved, per vertex of the layer's mesh.
struct SurfaceMoves {
  std::vector<double> at_edge;  ///< how far the nearest edge has
  std::vector<double> stretch;
};
SurfaceMoves surface_moves(const LayerMesh& layer, const std::vector<double>& moves) {
  const std::vector<double> none(moves.size(), 0.0);
  SurfaceMoves found{none, none};
  for (std::size_t v = 0; v < moves.size(); ++v) {
    const LayerMesh::NearestEdge& near_by = layer.nearest_edge[v];
    if (near_by.edge < 0 || !(layer.thickness[v] > 0)) continue;
    const LayerMesh::Edge& edge = layer.edges[at(near_by.edge)];
    found.at_edge[v] = (1 - near_by.along) * moves[at(edge.a)] + near_by.along * moves[at(edge.b)];
    found.stretch[v] =
        found.at_edge[v] * share_left(layer.edge_distance[v], layer.thickness[v]) / (kDecay * layer.thickness[v]);
  }
  return found;
}

}  // namespace

std::vector<double> press_bulges(const PosedBed& posed, const EdgeFlow& flow, SpringStates& s) {
  constexpr double kLeastOverlap = 0.25;             // of p t/E
  constexpr double kMostLost = -0.5, kMostMore = 1;  // of a foot's area, of its pressure
  const LayerBed& bed = *posed.bed->layers;
  const ContactPair& pair = posed.bed->pair;
  const auto compliance = [&](std::size_t k) {
    const auto of = [](const Layer& layer, double t) { return layer.rigid ? 0.0 : t / layer.elasticity.E; };
    return of(pair.source_layer(), s.t_source[k]) + of(pair.target_layer(), s.t_target[k]);
  };
  std::vector<double> more(at(s.size()), 0.0);  // pressure
  for (const bool source : {true, false}) {
    const LayerOperator* layer = (source ? bed.source : bed.target).layer.get();
    if (layer == nullptr || layer->edge_vertices.empty() || layer->law.terms < 2) continue;
    const PressedSide side{posed, s, source, *layer};
    const std::vector<double> moves = edge_moves(side, flow);
    if (moves.empty()) continue;
    const SurfaceMoves surface = surface_moves(layer->mesh, moves);
    const SurfaceMesh& target = posed.bed->target.mesh();
    for (std::size_t k = 0; k < more.size(); ++k) {
      if (!(s.pressure[k] > 0)) continue;
      const SurfacePoint place = side.place(k);
      const SurfaceMesh& mesh = layer->mesh.mesh;
      const double thickness = interpolate(mesh, layer->mesh.thickness, place),
                   move = interpolate(mesh, surface.at_edge, place);
      if (move == 0 || !(thickness > 0)) continue;
      const double left = share_left(interpolate(mesh, layer->mesh.edge_distance, place), thickness),
                   // over a triangle: three quarters of its middle, a quarter of its corners
          stretch = 0.75 * move * left / (kDecay * thickness) + 0.25 * interpolate(mesh, surface.stretch, place);
      const Vector3d way = (source ? posed.source : posed.target).rotation *
                           (move * left * interpolate(mesh, layer->mesh.outward, place));
      const Vector3d normal =
          posed.target.rotation *
          interpolate(target, target.vertex_normals, {s.triangle[k], s.end_weights[k]}).normalized();
      const double opening = source ? -way.dot(normal) / s.direction[k].dot(normal) : way.dot(s.direction[k]);
      const double overlap = std::max(s.overlap[k], kLeastOverlap * s.pressure[k] * compliance(k));
      s.carrying[k] =
          std::clamp(s.carrying[k] + s.area[k] * stretch, (1 + kMostLost) * s.area[k], (1 + kMostMore) * s.area[k]);
      if (overlap > 0 && std::isfinite(opening)) more[k] -= opening / overlap;
    }
  }
  for (std::size_t k = 0; k < more.size(); ++k) {
    more[k] = 1 + std::clamp(more[k], kMostLost, kMostMore);
    s.pressure[k] *= more[k];
  }
  return more;
}

}  // namespace dea

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

/// A place on a layer's mesh.
struct MeshPlace {
  int triangle = -1;
  Barycentric weights = {0, 0, 0};

  template <class Value>
  Value of(const SurfaceMesh& mesh, const std::vector<Value>& values) const {
    const auto& corners = mesh.triangles[at(triangle)];
    return weights[0] * values[at(corners[0])] + weights[1] * values[at(corners[1])] +
           weights[2] * values[at(corners[2])];
  }
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
  MeshPlace place(std::size_t k) const {
    const LayerBed& bed = *posed.bed->layers;
    MeshPlace found;
    found.triangle =
        source ? bed.source_triangle[k] : bed.target.mesh_triangle(states.triangle[k], states.end_weights[k]);
    const SurfaceMesh& mesh = layer.mesh.mesh;
    const Vector3d x = point(k), &a = mesh.corner(found.triangle, 0), &b = mesh.corner(found.triangle, 1),
                   &c = mesh.corner(found.triangle, 2);
    const Vector3d n = (b - a).cross(c - a);
    if (!(n.squaredNorm() > 0)) {
      found.weights = {1.0 / 3, 1.0 / 3, 1.0 / 3};
      return found;
    }
    found.weights[1] = (x - a).cross(c - a).dot(n) / n.squaredNorm();
    found.weights[2] = (b - a).cross(x - a).dot(n) / n.squaredNorm();
    found.weights[0] = 1 - found.weights[1] - found.weights[2];
    return found;
  }
};

/// How much of the source's free edge at this triangle lies under target that goes on: by the triangle's image beyond.
double goes_on_over(const PosedBed& posed, const LayerMesh& layer, int triangle, double gap) {
  const SpringBed& bed = *posed.bed;
  const RelativePose relative = relative_pose(posed.source, bed.source_center, posed.target, bed.target_center);
  const auto edge = std::lower_bound(layer.edges.begin(), layer.edges.end(), triangle,
                                     [](const LayerMesh::Edge& e, int t) { return e.triangle < t; });
  double covered = 0.0, count = 0.0;
  for (auto e = edge; e != layer.edges.end() && e->triangle == triangle; ++e) {
    if (e->rim != Rim::Free) continue;
    const auto& corners = layer.mesh.triangles[at(triangle)];
    const int third = corners[0] + corners[1] + corners[2] - e->a - e->b;
    const Vector3d &a = layer.mesh.vertices[at(e->a)], &b = layer.mesh.vertices[at(e->b)];
    covered += covered_part(bed, relative, {b, a, a + b - layer.mesh.vertices[at(third)]},
                            layer.mesh.normals[at(triangle)], gap);
    count += 1;
  }
  return count > 0 ? covered / count : kNaN;
}

/// Per vertex: the surface ends there, other than in a plane of symmetry.
std::vector<char> ends_of(const SurfaceMesh& mesh) {
  std::vector<char> ends(mesh.vertices.size(), 0);
  for (int t = 0; t < mesh.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      if (mesh.neighbours[at(t)][at(k)] >= 0) continue;
      const int a = mesh.triangles[at(t)][at(k)], b = mesh.triangles[at(t)][at((k + 1) % 3)];
      const int planes = mesh.planes.empty() ? 0 : mesh.planes[at(a)] & mesh.planes[at(b)];
      const Vector3d outward = outward_at(mesh, t, k);
      bool mirrored = false;
      for (int axis = 0; axis < 3; ++axis)
        mirrored = mirrored || ((planes >> axis & 1) != 0 && std::abs(outward[axis]) > kIntoPlane);
      if (!mirrored) ends[at(a)] = ends[at(b)] = 1;
    }
  return ends;
}

/// Springs beside the layer's free edges.
std::vector<EdgeSpring> edge_springs(const PressedSide& side) {
  constexpr double kWindow = 0.5, kApart = 0.1;  // thicknesses; what is further apart has no part in the contact
  const SpringBed& bed = *side.posed.bed;
  const SpringStates& s = side.states;
  const LayerMesh& layer = side.layer.mesh;
  const SurfaceMesh& source = bed.pair.source_layer().spring_surface();
  const std::vector<char> ends = side.source ? std::vector<char>() : ends_of(source);
  std::vector<EdgeSpring> found;
  for (std::size_t k = 0; k < at(s.size()); ++k) {
    if (!(s.area[k] > 0)) continue;
    const MeshPlace place = side.place(k);
    const double distance = place.of(layer.mesh, layer.edge_distance),
                 width = 1.1 * std::sqrt(2 * bed.springs.area[k]),  // of a foot, and a little more
        window = std::max(kWindow * place.of(layer.mesh, layer.thickness), width);
    if (distance >= window) continue;
    EdgeSpring spring{side.point(k), 2 * window};
    const double partakes =
        std::clamp(1 - s.gap[k] / std::max(kApart * (s.t_source[k] + s.t_target[k]), 1e-300), 0.0, 1.0);
    spring.weight = partakes * s.area[k] * (1 - distance / window);
    spring.pressure = s.pressure[k];
    if (side.source) {
      const double covered = partakes > 0 ? goes_on_over(side.posed, layer, place.triangle, s.gap[k]) : 0.0;
      spring.judges = std::isnan(covered) ? 0.0 : s.coverage[k];
      spring.goes_on = std::isnan(covered) ? 0.0 : partakes * covered;
    } else {
      const auto& corners = source.triangles[at(bed.springs.surface_triangle[k])];
      const auto ends_at = [&](int v) { return ends[at(v)] != 0; };
      spring.goes_on = std::any_of(corners.begin(), corners.end(), ends_at) ? 0.0 : partakes;
      spring.judges = s.coverage[k] * std::max(0.0, 1 - distance / width);
    }
    found.push_back(spring);
  }
  return found;
}

/// How far the layer's free edges move outwards, per vertex of its mesh. Empty: nowhere.
std::vector<double> edge_moves(const LayerOperator& layer, const std::vector<EdgeSpring>& springs,
                               const EdgeFlow& flow) {
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
    if (goes_on > 0) moves[at(v.node)] = goes_on / judges * edge_move(layer, v.node, flow(), pressure / weights);
  }
  return moves;
}

/// How much is left of the edge's move so far from it.
double share_left(double distance, double thickness) {
  return std::max(0.0, std::exp(-distance / (kDecay * thickness)) - std::exp(-kFar / kDecay));
}

/// How the surface has moved, per vertex of the layer's mesh.
struct SurfaceMoves {
  std::vector<double> move;       ///< of the nearest edge
  std::vector<Vector3d> outward;  ///< there; reference frame
  std::vector<double> stretch;
};
SurfaceMoves surface_moves(const LayerMesh& layer, const std::vector<double>& moves) {
  std::vector<Vector3d> outward(moves.size(), Vector3d::Zero());  // at the edges' vertices
  for (const LayerMesh::Edge& edge : layer.edges) {
    if (edge.rim != Rim::Free) continue;
    const Vector3d along = layer.mesh.vertices[at(edge.b)] - layer.mesh.vertices[at(edge.a)];
    for (const int v : {edge.a, edge.b}) outward[at(v)] += along.cross(layer.mesh.normals[at(edge.triangle)]);
  }
  const std::vector<double> none(moves.size(), 0.0);
  SurfaceMoves found{none, std::vector<Vector3d>(moves.size(), Vector3d::Zero()), none};
  for (std::size_t v = 0; v < moves.size(); ++v) {
    const int near_by = layer.nearest_edge[v];
    if (near_by < 0 || !(layer.thickness[v] > 0)) continue;
    const LayerMesh::Edge& edge = layer.edges[at(near_by)];
    const Vector3d &a = layer.mesh.vertices[at(edge.a)], &b = layer.mesh.vertices[at(edge.b)];
    const double along =
        std::clamp((layer.mesh.vertices[v] - a).dot(b - a) / std::max((b - a).squaredNorm(), 1e-300), 0.0, 1.0);
    found.move[v] = (1 - along) * moves[at(edge.a)] + along * moves[at(edge.b)];
    found.outward[v] = (1 - along) * outward[at(edge.a)].normalized() + along * outward[at(edge.b)].normalized();
    found.stretch[v] =
        found.move[v] * share_left(layer.edge_distance[v], layer.thickness[v]) / (kDecay * layer.thickness[v]);
  }
  return found;
}

}  // namespace

std::vector<double> press_bulges(const PosedBed& posed, const std::array<EdgeFlow, 2>& flow, SpringStates& s) {
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
    const std::vector<double> moves = edge_moves(*layer, edge_springs(side), flow[source ? 0 : 1]);
    if (moves.empty()) continue;
    const SurfaceMoves surface = surface_moves(layer->mesh, moves);
    const SurfaceMesh& target = posed.bed->target.mesh();
    for (std::size_t k = 0; k < more.size(); ++k) {
      if (!(s.pressure[k] > 0)) continue;
      const MeshPlace place = side.place(k);
      const SurfaceMesh& mesh = layer->mesh.mesh;
      const double thickness = place.of(mesh, layer->mesh.thickness), move = place.of(mesh, surface.move);
      if (move == 0 || !(thickness > 0)) continue;
      const double left = share_left(place.of(mesh, layer->mesh.edge_distance), thickness),
                   // over a triangle: three quarters of its middle, a quarter of its corners
          stretch = 0.75 * move * left / (kDecay * thickness) + 0.25 * place.of(mesh, surface.stretch);
      const Vector3d way =
          (source ? posed.source : posed.target).rotation * (move * left * place.of(mesh, surface.outward));
      const Vector3d normal = posed.target.rotation *
                              MeshPlace{s.triangle[k], s.end_weights[k]}.of(target, target.vertex_normals).normalized();
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

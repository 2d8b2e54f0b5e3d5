#include "src/springs/layer_operator.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <queue>
#include <stdexcept>
#include <utility>

#include "src/base/numbers.h"

namespace dea {

namespace {

// local pairs of vertices: diagonal, then the rest
constexpr std::size_t kFirst[6] = {0, 1, 2, 0, 1, 2}, kSecond[6] = {0, 1, 2, 1, 2, 0};

/// Gradients of the hat functions of a triangle's corners: the opposite edge turned inwards, over twice the area.
std::array<Vector3d, 3> hat_gradients(const SurfaceMesh& mesh, int t) {
  std::array<Vector3d, 3> gradient;
  for (int k = 0; k < 3; ++k)
    gradient[at(k)] =
        mesh.normals[at(t)].cross(mesh.corner(t, (k + 2) % 3) - mesh.corner(t, (k + 1) % 3)) / (2 * mesh.areas[at(t)]);
  return gradient;
}

/// Unit at the vertices of free edges: from the rim, in the surface.
std::vector<Vector3d> outward_at_rim(const LayerMesh& layer) {
  std::vector<Vector3d> outward(layer.mesh.vertices.size(), Vector3d::Zero());
  for (const LayerMesh::Edge& edge : layer.edges) {
    if (edge.rim != Rim::Free) continue;
    const Vector3d along = layer.mesh.vertices[at(edge.b)] - layer.mesh.vertices[at(edge.a)];
    for (const int v : {edge.a, edge.b}) outward[at(v)] += along.cross(layer.mesh.normals[at(edge.triangle)]);
  }
  for (Vector3d& direction : outward) direction.normalize();
  return outward;
}

/// Per vertex: distance from the nearest free edge, from each edge over the triangles around, as far as it is felt, and
/// the place there with the slope of its wall (`slope`: of the edges' vertices).
void find_nearest_edges(const std::vector<double>& slope, double reach, LayerMesh& layer) {
  const SurfaceMesh& mesh = layer.mesh;
  const std::vector<Vector3d> outward = outward_at_rim(layer);
  std::vector<double>& distance = layer.edge_distance;
  distance.assign(mesh.vertices.size(), reach);
  layer.wall_slope.assign(mesh.vertices.size(), 0.0);
  layer.nearest_edge.assign(mesh.vertices.size(), {});
  layer.outward.assign(mesh.vertices.size(), Vector3d::Zero());
  std::vector<int> seen(at(mesh.size()), -1), front;
  for (std::size_t k = 0; k < layer.edges.size(); ++k) {
    const LayerMesh::Edge& edge = layer.edges[k];
    if (edge.rim != Rim::Free) continue;
    const Vector3d &a = mesh.vertices[at(edge.a)], &b = mesh.vertices[at(edge.b)];
    front = {edge.triangle};
    seen[at(edge.triangle)] = static_cast<int>(k);
    // From its middle a vertex is as far as from the edge to half of its length: most are then known to be felt, or to
    // be nearer to another edge.
    const Vector3d middle = 0.5 * (a + b);
    const double half = 0.5 * (b - a).norm() + 1e-9 * reach;
    while (!front.empty()) {
      const int t = front.back();
      front.pop_back();
      bool felt = false;
      for (int v : mesh.triangles[at(t)]) {
        const Vector3d& x = mesh.vertices[at(v)];
        const double from_middle2 = (x - middle).squaredNorm(), farther = distance[at(v)] + half;
        felt = felt || (half < reach && from_middle2 < (reach - half) * (reach - half));
        if (from_middle2 > farther * farther && (felt || from_middle2 > (reach + half) * (reach + half))) continue;
        const double d = distance_to_segment(x, a, b);
        felt = felt || d < reach;
        if (d >= distance[at(v)]) continue;
        distance[at(v)] = d;
        const double along =
            edge.length > 0 ? std::clamp((x - a).dot(b - a) / (edge.length * edge.length), 0.0, 1.0) : 0.0;
        layer.nearest_edge[at(v)] = {static_cast<int>(k), along};
        layer.outward[at(v)] = (1 - along) * outward[at(edge.a)] + along * outward[at(edge.b)];
        layer.wall_slope[at(v)] = slope[at(edge.a)] + along * (slope[at(edge.b)] - slope[at(edge.a)]);
      }
      if (!felt) continue;
      for (const int next : mesh.neighbours[at(t)]) {
        if (next < 0 || seen[at(next)] == static_cast<int>(k)) continue;
        seen[at(next)] = static_cast<int>(k);
        front.push_back(next);
      }
    }
  }
}

/// The free edges, from vertex to vertex.
struct FreeRim {
  std::vector<int> out, in;  ///< per vertex: the edge that leaves it, that arrives; -1: none
  std::vector<char> walled;  ///< per vertex: in a plane of symmetry, beyond which the rim has its mirror image
  bool has(int v) const { return out[at(v)] >= 0 || in[at(v)] >= 0; }
};

FreeRim free_rim(const LayerMesh& layer) {
  const std::size_t n = layer.mesh.vertices.size();
  FreeRim rim{std::vector<int>(n, -1), std::vector<int>(n, -1), std::vector<char>(n, 0)};
  for (std::size_t k = 0; k < layer.edges.size(); ++k) {
    const LayerMesh::Edge& edge = layer.edges[k];
    if (edge.rim == Rim::Free)
      rim.out[at(edge.a)] = rim.in[at(edge.b)] = static_cast<int>(k);
    else if (edge.rim == Rim::Wall)
      rim.walled[at(edge.a)] = rim.walled[at(edge.b)] = 1;
  }
  return rim;
}

/// From a vertex along the rim to both sides, until more than `reach` is behind: visit(edge, vertex that it leads to,
/// way to there).
template <class Visit>
void walk_along(const LayerMesh& layer, const FreeRim& rim, int from, double reach, const Visit& visit) {
  for (const bool forwards : {true, false}) {
    double way = 0.0;
    int at_vertex = from;
    bool onwards = forwards;
    for (std::size_t steps = 0; steps <= layer.edges.size(); ++steps) {
      int next = onwards ? rim.out[at(at_vertex)] : rim.in[at(at_vertex)];
      if (next < 0 && rim.walled[at(at_vertex)]) {  // the mirror image: back along the same edges
        onwards = !onwards;
        next = onwards ? rim.out[at(at_vertex)] : rim.in[at(at_vertex)];
      }
      if (next < 0) break;
      const LayerMesh::Edge& edge = layer.edges[at(next)];
      way += edge.length;
      at_vertex = onwards ? edge.b : edge.a;
      visit(edge, at_vertex, way);
      if (way >= reach) break;
    }
  }
}

/// Along a rim, what is said of its vertices and edges is spread over so many thicknesses to both sides, so that a
/// mesh's zigzags cancel.
constexpr double kSpreadAlong = 2.0;

/// Curvature of the free edges within the surface: how much the rim turns at each vertex, pi less the angles of the
/// triangles there.
std::vector<double> edge_curvatures(const LayerMesh& layer, const FreeRim& rim) {
  const SurfaceMesh& mesh = layer.mesh;
  std::vector<double> curvature(mesh.vertices.size(), 0.0), angles(mesh.vertices.size(), 0.0);
  for (int t = 0; t < mesh.size(); ++t)
    for (int c = 0; c < 3; ++c) {
      const int v = mesh.triangles[at(t)][at(c)];
      if (!rim.has(v)) continue;
      const Vector3d a = mesh.corner(t, (c + 1) % 3) - mesh.corner(t, c),
                     b = mesh.corner(t, (c + 2) % 3) - mesh.corner(t, c);
      angles[at(v)] += std::atan2(a.cross(b).norm(), a.dot(b));
    }
  const auto turning = [&](int v) {
    if (rim.out[at(v)] >= 0 && rim.in[at(v)] >= 0) return kPi - angles[at(v)];
    return rim.walled[at(v)] ? kPi - 2 * angles[at(v)] : 0.0;
  };
  for (int v = 0; v < layer.nodes(); ++v) {
    const double reach = kSpreadAlong * layer.thickness[at(v)];
    if (!rim.has(v) || !(reach > 0)) continue;
    double sum = turning(v);
    walk_along(layer, rim, v, reach, [&](const LayerMesh::Edge&, int vertex, double way) {
      if (way < reach) sum += turning(vertex) * (1 - way / reach);
    });
    curvature[at(v)] = sum / reach;
  }
  return curvature;
}

/// Slope of the side wall at the vertices of free edges: the cotangent of the angle by which the surface turns there.
std::vector<double> edge_slopes(const LayerMesh& layer, const FreeRim& rim) {
  std::vector<double> slope(layer.mesh.vertices.size(), 0.0);
  for (int v = 0; v < layer.nodes(); ++v) {
    const double reach = kSpreadAlong * layer.thickness[at(v)];
    if (!rim.has(v)) continue;
    double sum = 0.0, weights = 0.0;
    walk_along(layer, rim, v, reach, [&](const LayerMesh::Edge& edge, int, double way) {
      const double weight = edge.length * std::max(1e-3, 1 - (way - 0.5 * edge.length) / std::max(reach, edge.length));
      sum += weight * std::clamp(1 / std::tan(edge.wall), kMostUndercut, kMostBevel);
      weights += weight;
    });
    if (weights > 0) slope[at(v)] = sum / weights;
  }
  return slope;
}

SymmetricPattern pattern_of(const SurfaceMesh& mesh) {
  std::vector<std::array<int, 2>> pairs;
  for (const auto& t : mesh.triangles)
    for (std::size_t e = 3; e < 6; ++e) pairs.push_back({t[kFirst[e]], t[kSecond[e]]});
  return make_pattern(static_cast<int>(mesh.vertices.size()), pairs);
}

/// (L10), with the mass lumped, so that the least and the largest thickness bound it.
std::vector<double> smeared_thickness(const SurfaceMesh& mesh, const std::vector<double>& t) {
  const double beta = layer_law({1.0, 0.3}, LayerFit::TwoTerms).beta[1];  // the same for every nu
  const SymmetricPattern pattern = pattern_of(mesh);
  std::vector<double> values(at(pattern.entries()), 0.0);
  Nodal smeared = Nodal::Zero(pattern.size(), 1);
  for (int k = 0; k < mesh.size(); ++k) {
    const auto& corner = mesh.triangles[at(k)];
    const double A = mesh.areas[at(k)], h[3] = {t[at(corner[0])], t[at(corner[1])], t[at(corner[2])]};
    const double squared = (h[0] * (h[0] + h[1] + h[2]) + h[1] * (h[1] + h[2]) + h[2] * h[2]) / 6;
    const auto gradient = hat_gradients(mesh, k);
    for (std::size_t e = 0; e < 6; ++e) {
      const std::size_t i = kFirst[e], j = kSecond[e];
      values[at(pattern.find(corner[i], corner[j]))] +=
          beta * A * squared * gradient[i].dot(gradient[j]) + (i == j ? A / 3 : 0.0);
    }
    for (std::size_t i = 0; i < 3; ++i) smeared(corner[i], 0) += A / 3 * h[i];
  }
  std::vector<int> all(at(pattern.size()));
  std::iota(all.begin(), all.end(), 0);
  try {
    solve(factorise(pattern, values), all, smeared);
  } catch (const std::runtime_error&) {  // beyond what numbers can hold
    return t;
  }
  const auto [least, most] = std::minmax_element(t.begin(), t.end());
  std::vector<double> out(t.size());
  for (std::size_t v = 0; v < t.size(); ++v)
    out[v] = std::clamp(smeared(static_cast<Eigen::Index>(v), 0), *least, *most);
  return out;
}

/// The vertices that lie no further than `reach` from some of `from`, along the mesh's edges.
std::vector<int> within_way(const LayerMesh& layer, const std::vector<int>& from, double reach) {
  std::vector<double> way(at(layer.nodes()), kInfinity);
  std::priority_queue<std::pair<double, int>, std::vector<std::pair<double, int>>, std::greater<>> front;
  for (const int v : from) {
    way[at(v)] = 0;
    front.emplace(0.0, v);
  }
  std::vector<int> found;
  while (!front.empty()) {
    const double so_far = front.top().first;
    const int v = front.top().second;
    front.pop();
    if (so_far > way[at(v)]) continue;
    found.push_back(v);
    for (const int next : layer.beside[at(v)]) {
      const double length = so_far + (layer.mesh.vertices[at(next)] - layer.mesh.vertices[at(v)]).norm();
      if (length >= way[at(next)] || length > reach) continue;
      way[at(next)] = length;
      front.emplace(length, next);
    }
  }
  return found;
}

/// Gives the vertices other numbers: `place` of each.
void renumber(SurfaceMesh& mesh, const std::vector<int>& place) {
  const SurfaceMesh old = mesh;
  for (std::size_t v = 0; v < place.size(); ++v) {
    mesh.model_nodes[at(place[v])] = old.model_nodes[v];
    mesh.vertices[at(place[v])] = old.vertices[v];
    mesh.vertex_normals[at(place[v])] = old.vertex_normals[v];
    mesh.vertex_areas[at(place[v])] = old.vertex_areas[v];
    if (!old.planes.empty()) mesh.planes[at(place[v])] = old.planes[v];
  }
  for (auto& triangle : mesh.triangles)
    for (int& v : triangle) v = place[at(v)];
}

}  // namespace

LayerMesh make_layer_mesh(const LayerFace& face, int divide) {
  LayerMesh layer;
  layer.divide = divide;
  layer.pressed = face.pressed * divide * divide;
  layer.mesh = divided(face.mesh, divide);
  renumber(layer.mesh, sparse_order(pattern_of(layer.mesh)));
  layer.thickness.assign(layer.mesh.vertices.size(), 0.0);
  const auto parts = triangle_parts(divide);
  for (int t = 0; t < face.mesh.size(); ++t) {
    const auto& corner = face.mesh.triangles[at(t)];
    for (std::size_t p = 0; p < parts.size(); ++p)
      for (std::size_t c = 0; c < 3; ++c) {
        double h = 0;
        for (std::size_t k = 0; k < 3; ++k) h += parts[p][c][k] * face.thickness[at(corner[k])];
        layer.thickness[at(layer.mesh.triangles[at(t) * parts.size() + p][c])] = h;
      }
  }
  constexpr double kOnEdge = 1e-9;
  for (const LayerFace::Edge& edge : face.edges) {
    const std::size_t across = at((edge.edge + 2) % 3);  // this coordinate is 0 along the edge
    for (std::size_t p = 0; p < parts.size(); ++p)
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t next = (c + 1) % 3;
        if (parts[p][c][across] > kOnEdge || parts[p][next][across] > kOnEdge) continue;
        const int triangle = edge.triangle * divide * divide + static_cast<int>(p);
        const auto& corner = layer.mesh.triangles[at(triangle)];
        layer.edges.push_back({corner[c], corner[next], triangle,
                               (layer.mesh.vertices[at(corner[next])] - layer.mesh.vertices[at(corner[c])]).norm(),
                               edge.rim, edge.wall});
      }
  }
  std::stable_sort(layer.edges.begin(), layer.edges.end(),
                   [](const LayerMesh::Edge& x, const LayerMesh::Edge& y) { return x.triangle < y.triangle; });
  layer.beside = vertex_neighbours(layer.mesh.vertices.size(), layer.mesh.triangles);
  const double deepest = face.thickness.empty() ? 0.0 : *std::max_element(face.thickness.begin(), face.thickness.end());
  layer.thickness = smeared_thickness(layer.mesh, layer.thickness);
  const FreeRim rim = free_rim(layer);
  layer.edge_curvature =
      edge_curvatures(layer, rim);  // by that thickness: the measured one is none where a layer runs out
  find_nearest_edges(edge_slopes(layer, rim), kEdgeReach * deepest, layer);
  return layer;
}

void add_foot(LayerFeet& feet, const LayerOperator& of, const std::vector<SurfacePart>& parts, double area) {
  const LayerMesh& layer = of.mesh;
  const double local = of.law.local;
  double sum = 0;
  for (const SurfacePart& part : parts) sum += part.area;
  double volume = 0, own = 0;
  if (sum > 0 && area > 0) {
    const double scale = area / sum;
    const std::size_t first = at(feet.begin.back());
    for (const SurfacePart& part : parts) {
      const auto& corner = layer.mesh.triangles[at(part.triangle)];
      double t[3], d[3], edge_own = 0, shape = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        t[k] = layer.thickness[at(corner[k])];
        d[k] = layer.edge_distance[at(corner[k])];
        if (!of.edge_own.empty()) edge_own += of.edge_own[at(corner[k])] / 3;
      }
      std::array<double, 3> b = {0, 0, 0};
      double part_volume = 0, part_own = 0;
      const auto piece = [&](int i) {  // fan of triangles: corners 0, i, i + 1
        return std::array<const Barycentric*, 3>{&part.corner[0], &part.corner[at(i)], &part.corner[at(i + 1)]};
      };
      const auto size = [](const std::array<const Barycentric*, 3>& p) {
        return std::abs(((*p[1])[0] - (*p[0])[0]) * ((*p[2])[1] - (*p[0])[1]) -
                        ((*p[1])[1] - (*p[0])[1]) * ((*p[2])[0] - (*p[0])[0]));
      };
      for (int i = 1; i + 1 < part.corners; ++i) shape += size(piece(i));
      if (!(shape > 0)) continue;
      for (int i = 1; i + 1 < part.corners; ++i) {
        const auto p = piece(i);
        const double a = scale * part.area * size(p) / shape;
        double at_corner[3], mean = 0, edge = 0, all[3] = {0, 0, 0};
        for (std::size_t c = 0; c < 3; ++c) {
          at_corner[c] = (*p[c])[0] * t[0] + (*p[c])[1] * t[1] + (*p[c])[2] * t[2];
          mean += at_corner[c] / 3;
          edge += ((*p[c])[0] * d[0] + (*p[c])[1] * d[1] + (*p[c])[2] * d[2]) / 3;
          for (std::size_t k = 0; k < 3; ++k) all[k] += (*p[c])[k];
        }
        for (std::size_t k = 0; k < 3; ++k)  // integral of t N: (sum t N + sum t sum N)/12
          b[k] +=
              a / 12 *
              (at_corner[0] * (*p[0])[k] + at_corner[1] * (*p[1])[k] + at_corner[2] * (*p[2])[k] + 3 * mean * all[k]);
        part_volume += a * mean;
        // nothing beyond the reach, where the distance is not known
        const double near_edge =
            edge < kEdgeReach * mean ? std::exp(-kEdgeDecay * edge / mean) - std::exp(-kEdgeDecay * kEdgeReach) : 0.0;
        part_own += a * mean * (local + edge_own * near_edge);
      }
      for (std::size_t k = 0; k < 3; ++k) {
        std::size_t i = first;
        while (i < feet.node.size() && feet.node[i] != corner[k]) ++i;
        if (i == feet.node.size()) {
          feet.node.push_back(corner[k]);
          feet.weight.push_back(0.0);
        }
        feet.weight[i] += b[k];
      }
      volume += part_volume;
      own += part_own;
    }
  } else {
    area = 0;
  }
  feet.begin.push_back(static_cast<int>(feet.node.size()));
  feet.area.push_back(area);
  feet.volume.push_back(volume);
  feet.own.push_back(area > 0 ? own / area : 0.0);
}

void append(LayerFeet& feet, const LayerFeet& more) {
  const auto add = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  const int first = feet.begin.back();
  for (std::size_t i = 1; i < more.begin.size(); ++i) feet.begin.push_back(first + more.begin[i]);
  add(feet.node, more.node);
  add(feet.weight, more.weight);
  add(feet.area, more.area);
  add(feet.volume, more.volume);
  add(feet.own, more.own);
}

LayerFeet feet_of_own_triangles(const LayerOperator& layer) {
  const LayerMesh& mesh = layer.mesh;
  LayerFeet feet;
  for (int t = 0; t < mesh.pressed; ++t) add_foot(feet, layer, {{t, mesh.mesh.areas[at(t)]}}, mesh.mesh.areas[at(t)]);
  set_reach(feet, layer);
  return feet;
}

void set_reach(LayerFeet& feet, const LayerOperator& layer) {
  const LayerMesh& mesh = layer.mesh;
  std::vector<char> seen(at(mesh.nodes()), 0);
  std::vector<int> under;
  for (int i = 0; i < feet.size(); ++i) {
    if (!(feet.area[at(i)] > 0)) continue;
    for (int k = feet.begin[at(i)]; k < feet.begin[at(i + 1)]; ++k) {
      const int v = feet.node[at(k)];
      if (!seen[at(v)]) under.push_back(v);
      seen[at(v)] = 1;
    }
  }
  std::vector<int> in_first = under;
  for (const LayerOperator::EdgeVertex& v : layer.edge_vertices)
    if (v.gained > 0) in_first.push_back(v.node);  // asked for by edge_flow
  feet.columns[0] = columns_for(layer.factor[0], in_first);
  std::erase_if(feet.columns[0], [&](int v) { return layer.edge_held[at(v)] != 0; });
  feet.columns[1].clear();
  if (layer.law.terms < 2) return;
  const double most = mesh.thickness.empty() ? 0.0 : *std::max_element(mesh.thickness.begin(), mesh.thickness.end());
  feet.columns[1] = columns_for(layer.factor[1], within_way(mesh, under, 3 * most));
}

namespace {

/// How much softer than linearly a layer answers: e = q/M - S6^-1(q) >= 0 for a pressure q, what its slope is.
struct StrainExcess {
  double strain = 0.0, slope = 0.0;
};
StrainExcess strain_excess(const Elasticity& layer, double q) {
  if (!(q > 0)) return {};
  const double per_modulus = 1 / confined_modulus(layer.E, layer.nu);
  const double strain = strain_at_pressure(Law::NeoHookean, layer, q);
  return {q * per_modulus - strain, per_modulus - 1 / layer_response(Law::NeoHookean, layer, strain).slope};
}

/// M_t, K_t3, and along the edges the integral of t^2.
struct Parts {
  std::vector<double> mass, stiffness, free_edge, open_edge;
  std::vector<double> around;  ///< along free edges, by EdgeLaw::around
};

Parts assemble(const LayerMesh& layer, const EdgeLaw& vertical, const SymmetricPattern& pattern) {
  const SurfaceMesh& surface = layer.mesh;
  const std::vector<double> none(at(pattern.entries()), 0.0);
  Parts parts = {none, none, none, none, none};
  for (int t = 0; t < surface.size(); ++t) {
    const auto& corner = surface.triangles[at(t)];
    const double A = surface.areas[at(t)];
    const auto gradient = hat_gradients(surface, t);
    const double h[3] = {layer.thickness[at(corner[0])], layer.thickness[at(corner[1])],
                         layer.thickness[at(corner[2])]},
                 sum = h[0] + h[1] + h[2];
    // integrals of linear t: t^3 is the sum of its monomials of degree 3 over 10; t N_i N_j by products of N
    const double cubed = (h[0] * h[0] * (h[0] + h[1] + h[2]) + h[1] * h[1] * (h[1] + h[2]) + h[2] * h[2] * h[2] +
                          h[0] * h[1] * (h[1] + h[2]) + h[2] * h[2] * (h[0] + h[1])) /
                         10;
    for (std::size_t e = 0; e < 6; ++e) {
      const std::size_t i = kFirst[e], j = kSecond[e], s = at(pattern.find(corner[i], corner[j]));
      parts.mass[s] += i == j ? A * (2 * sum + 4 * h[i]) / 60 : A * (sum + h[i] + h[j]) / 60;
      parts.stiffness[s] += A * cubed * gradient[i].dot(gradient[j]);
    }
  }
  for (const LayerMesh::Edge& side : layer.edges) {
    if (side.rim == Rim::Wall) continue;
    std::vector<double>& along = side.rim == Rim::Free ? parts.free_edge : parts.open_edge;
    // integral of t^2 N_i N_j along the edge, t linear
    const double ta = layer.thickness[at(side.a)], tb = layer.thickness[at(side.b)], l = side.length / 30;
    const double around =
        side.rim == Rim::Free
            ? leaning(vertical, 0.5 * (layer.wall_slope[at(side.a)] + layer.wall_slope[at(side.b)])).around
            : 0.0;
    const auto add = [&](int i, int j, double integral) {
      const std::size_t s = at(pattern.find(i, j));
      along[s] += integral;
      parts.around[s] += around * integral;
    };
    add(side.a, side.a, l * (6 * ta * ta + 3 * ta * tb + tb * tb));
    add(side.b, side.b, l * (6 * tb * tb + 3 * ta * tb + ta * ta));
    add(side.a, side.b, l * (1.5 * ta * ta + 2 * ta * tb + 1.5 * tb * tb));
  }
  return parts;
}

/// At a free edge what bulges escapes: q = 0 in the first term. The second decays within 0.4 t, which few meshes
/// resolve: held, it would make coarse edges stiff; it goes on as beyond a loaded patch, and (L7) adds what is missing.
/// Returns per vertex what the diagonal of S_0 gains where a hole's rim is not held.
std::vector<double> hold_edges(const EdgeLaw& vertical, LayerOperator& op) {
  const LayerMesh& layer = op.mesh;
  const std::size_t n = at(layer.nodes());
  std::vector<char> carries(n, 0), bare(n, 0);
  std::vector<double> share(n, 0.0);  // B_v
  std::vector<double> gained(n, 0.0);
  std::vector<char> free(n, 0);
  for (const LayerMesh::Edge& side : layer.edges) {
    if (side.rim != Rim::Free) continue;
    for (const int v : {side.a, side.b}) {
      share[at(v)] += 0.5 * side.length * layer.thickness[at(v)] * layer.thickness[at(v)];
      free[at(v)] = 1;
    }
  }
  for (const auto& corner : layer.mesh.triangles) {
    double most = 0;
    for (int v : corner) most = std::max(most, layer.thickness[at(v)]);
    for (int v : corner) (most > 0 ? carries : bare)[at(v)] = 1;
  }
  for (auto& of_term : op.held) of_term.assign(n, 0);
  op.edge_held.assign(n, 0);
  constexpr double kMostRobin = 5.0;  // keeps the operator positive; larger ones are seen no more
  for (std::size_t v = 0; v < n; ++v) {
    op.held[1][v] = !carries[v];
    op.held[0][v] = !carries[v] || bare[v];
    if (op.held[0][v] || !free[v]) continue;
    op.edge_vertices.push_back({static_cast<int>(v), share[v], 0.0, 0.0});
    const double bend = std::min(layer.edge_curvature[v] * layer.thickness[v], 1.0),
                 e = leaning(vertical, layer.wall_slope[v]).straight + vertical.curved * bend;
    if (e < 0 && op.law.weight[0] < 0 && share[v] > 0) {
      op.edge_vertices.back().gained = gained[v] =
          op.law.beta[0] * share[v] / std::min(e / op.law.weight[0], kMostRobin);
      continue;
    }
    op.held[0][v] = op.edge_held[v] = 1;
    if (e > 0 && share[v] > 0) op.edge_vertices.back().stretch = e / (op.law.beta[0] * share[v]);
  }
  return gained;
}

}  // namespace

LayerOperator make_layer_operator(LayerMesh mesh, const Elasticity& elasticity, LayerFit fit) {
  LayerOperator op;
  op.mesh = std::move(mesh);
  op.elasticity = elasticity;
  op.law = layer_law(elasticity, fit);
  const EdgeLaw vertical = op.edge = edge_law(elasticity, fit);
  if (std::any_of(op.mesh.edges.begin(), op.mesh.edges.end(),
                  [](const LayerMesh::Edge& edge) { return edge.rim == Rim::Free; }))
    for (const double slope : op.mesh.wall_slope) op.edge_own.push_back(leaning(vertical, slope).own);
  op.pattern = pattern_of(op.mesh.mesh);
  const SymmetricPattern& pattern = op.pattern;
  const std::vector<double> gained = hold_edges(vertical, op);
  const Parts parts = assemble(op.mesh, vertical, pattern);
  const std::size_t entries = parts.mass.size();
  std::vector<double> values(entries);
  const auto factor_of = [&](const std::vector<char>& held, const std::vector<char>& edge) {
    const auto is_held = [&](int v) { return held[at(v)] && (edge.empty() || !edge[at(v)]); };
    for (int column = 0; column < pattern.size(); ++column)
      for (int s = pattern.begin[at(column)]; s < pattern.begin[at(column) + 1]; ++s) {
        const int row = pattern.row[at(s)];
        if (is_held(column) || is_held(row))  // the row says q = 0; the pattern stays
          values[at(s)] = row == column ? 1.0 : 0.0;
      }
    return factorise(pattern, values, edge);
  };
  for (std::size_t k = 0; k < at(op.law.terms); ++k) {
    const double beta = op.law.beta[k], root = std::sqrt(beta);
    for (std::size_t s = 0; s < entries; ++s)
      values[s] =
          parts.mass[s] + beta * parts.stiffness[s] + root * (parts.open_edge[s] + (k == 1 ? parts.free_edge[s] : 0.0));
    for (int v = 0; k == 0 && v < pattern.size(); ++v) values[at(pattern.begin[at(v)])] += gained[at(v)];
    op.factor[k] = factor_of(op.held[k], k == 0 ? op.edge_held : std::vector<char>());
  }
  if (op.law.terms < 2) return op;
  // Beyond an edge where the layer goes on q_1 has the other half of its square: q decays like exp(-y), and
  // S_1 r = M_t q_1 there is worth sqrt(beta_1)/2 t^2 q at the edge.
  op.onwards.resize(entries);
  op.beyond.resize(entries);
  for (std::size_t s = 0; s < entries; ++s)
    op.onwards[s] =
        op.law.square * (parts.mass[s] + 0.5 * std::sqrt(op.law.beta[1]) * parts.open_edge[s]) + parts.around[s];
  for (std::size_t s = 0; s < entries; ++s) op.beyond[s] = std::sqrt(op.law.beta[1]) * parts.open_edge[s];
  op.mass = parts.mass;
  for (std::size_t s = 0; s < entries; ++s)
    values[s] = kNear.mass * parts.mass[s] + kNear.stiffness * parts.stiffness[s];
  for (int t = 0; t < op.mesh.pressed; ++t) {
    const auto& corner = op.mesh.mesh.triangles[at(t)];
    double sum = 0;
    for (const int v : corner) sum += op.mesh.thickness[at(v)];
    if (!(sum > 0)) continue;
    for (std::size_t e = 0; e < 6; ++e) {  // b_i b_j / d
      const int i = corner[kFirst[e]], j = corner[kSecond[e]];
      values[at(pattern.find(i, j))] +=
          op.mesh.mesh.areas[at(t)] * (op.mesh.thickness[at(i)] + sum) * (op.mesh.thickness[at(j)] + sum) / (48 * sum);
    }
  }
  op.near = factor_of(op.held[1], {});
  return op;
}

Nodal loads(const LayerOperator& op, const LayerFeet& feet, const Eigen::MatrixXd& p) {
  Nodal load = Nodal::Zero(op.mesh.nodes(), p.cols());
  if (p.cols() == 1) {  // most calls
    double* f = load.data();
    for (int i = 0; i < feet.size(); ++i) {
      const double pressure = p(i, 0);
      if (pressure == 0) continue;
      for (int k = feet.begin[at(i)]; k < feet.begin[at(i) + 1]; ++k)
        f[feet.node[at(k)]] += feet.weight[at(k)] * pressure;
    }
    return load;
  }
  for (int i = 0; i < feet.size(); ++i)
    for (int k = feet.begin[at(i)]; k < feet.begin[at(i) + 1]; ++k)
      load.row(feet.node[at(k)]) += feet.weight[at(k)] * p.row(i);
  return load;
}

double gathered(const LayerFeet& feet, int i, const Nodal& q, Eigen::Index c) {
  double sum = 0;
  const double* value = q.data() + c;
  const std::ptrdiff_t columns = q.cols();
  for (int k = feet.begin[at(i)]; k < feet.begin[at(i) + 1]; ++k)
    sum += feet.weight[at(k)] * value[columns * feet.node[at(k)]];
  return sum;
}

Nodal solved(const SparseFactor& factor, const std::vector<char>& held, const std::vector<int>& columns, Nodal load) {
  for (const int v : columns)
    if (held[at(v)]) load.row(v).setZero();
  solve(factor, columns, load);
  return load;
}

namespace {

/// The first half of q_0 for a load, at these vertices: at held edges the volume that flows out there, rho (L7).
Nodal half_solved(const LayerOperator& op, const std::vector<int>& columns, Nodal load) {
  for (const int v : columns)
    if (op.held[0][at(v)]) load.row(v).setZero();
  solve_down(op.factor[0], columns, load);
  return load;
}

/// weight_0 q_0 + z.
Nodal first_term(const LayerOperator& op, const LayerFeet& feet, const Nodal& load) {
  Nodal q = half_solved(op, feet.columns[0], load);
  for (const int v : feet.columns[0]) q.row(v) *= op.law.weight[0];
  for (const LayerOperator::EdgeVertex& v : op.edge_vertices)
    if (op.edge_held[at(v.node)]) q.row(v.node) *= v.stretch;
  solve_up(op.factor[0], feet.columns[0], q);
  return q;
}

/// The second half of q_0.
Nodal with_edges_held(const LayerOperator& op, const std::vector<int>& columns, Nodal q) {
  for (const LayerOperator::EdgeVertex& v : op.edge_vertices)
    if (op.edge_held[at(v.node)]) q.row(v.node).setZero();
  solve_up(op.factor[0], columns, q);
  return q;
}

/// w, with excess(i, q) the strain by which a foot answers less than linearly to the pressure q = (B p)_i; not `large`:
/// small strain.
template <class Excess>
Eigen::MatrixXd flow(const LayerOperator& op, const LayerFeet& feet, const Eigen::MatrixXd& p, const Excess& excess,
                     bool large) {
  assert(p.rows() == feet.size());
  const double own = op.law.own_share;
  const Nodal load = loads(op, feet, p);
  Nodal all = first_term(op, feet, load);
  Eigen::MatrixXd strain;
  if (large) strain = Eigen::MatrixXd::Zero(p.rows(), p.cols());
  const auto find_strain = [&](const Nodal* q) {
    for (int i = 0; i < feet.size(); ++i)
      for (Eigen::Index c = 0; c < p.cols() && feet.volume[at(i)] > 0; ++c) {
        const double around = q && own < 1 ? gathered(feet, i, *q, c) / feet.volume[at(i)] : 0.0;
        strain(i, c) = excess(i, own * p(i, c) + (1 - own) * around);
      }
  };
  if (op.law.terms == 2) {
    const Nodal q = solved(op.factor[1], op.held[1], feet.columns[1], load);
    all += op.law.weight[1] * q;
    Nodal right_side = Nodal::Zero(q.rows(), q.cols());  // the fraction's square: S^-1 M_t S^-1
    add_times(op.pattern, op.onwards, feet.columns[1], q, right_side);
    if (large) {
      find_strain(&q);
      right_side -= (1 - own) * loads(op, feet, strain);
    }
    all += solved(op.factor[1], op.held[1], feet.columns[1], std::move(right_side));
  } else if (large) {
    find_strain(nullptr);
  }
  Eigen::MatrixXd w = Eigen::MatrixXd::Zero(p.rows(), p.cols());
  for (int i = 0; i < feet.size(); ++i)
    for (Eigen::Index c = 0; c < p.cols() && feet.area[at(i)] > 0; ++c) {
      w(i, c) = feet.own[at(i)] * p(i, c) + gathered(feet, i, all, c) / feet.area[at(i)];
      if (large) w(i, c) -= own * feet.thickness(i) * strain(i, c);
    }
  return w;
}

}  // namespace

Eigen::MatrixXd sinking(const LayerOperator& layer, const LayerFeet& feet, const Eigen::MatrixXd& pressure,
                        const Eigen::VectorXd* softening) {
  const auto excess = [&](int i, double q) { return softening ? (*softening)[i] * q : 0.0; };
  return flow(layer, feet, pressure, excess, softening != nullptr);
}

Eigen::VectorXd large_sinking(const LayerOperator& layer, const LayerFeet& feet, const Eigen::VectorXd& pressure,
                              Eigen::VectorXd& softening) {
  softening.setZero(pressure.size());
  const auto excess = [&](int i, double q) {
    const StrainExcess e = strain_excess(layer.elasticity, q);
    softening[i] = e.slope;
    return e.strain;
  };
  return flow(layer, feet, pressure, excess, true);
}

std::vector<double> edge_flow(const LayerOperator& op, const LayerFeet& feet, const Eigen::VectorXd& pressure) {
  std::vector<double> flow(at(op.mesh.nodes()), 0.0);
  const Nodal half = half_solved(op, feet.columns[0], loads(op, feet, pressure)),
              q = with_edges_held(op, feet.columns[0], half);
  for (const LayerOperator::EdgeVertex& v : op.edge_vertices)
    if (v.share > 0)
      flow[at(v.node)] = op.edge_held[at(v.node)] ? half(v.node, 0) / v.share
                                                  : (v.gained / v.share + std::sqrt(op.law.beta[0])) * q(v.node, 0);
  return flow;
}

double edge_move(const LayerOperator& op, int vertex, const std::vector<double>& flow, double pressure) {
  const EdgeLaw law = leaning(op.edge, op.mesh.wall_slope[at(vertex)]);
  return op.mesh.thickness[at(vertex)] * (law.driven * flow[at(vertex)] + law.squeezed * pressure);
}

Eigen::MatrixXd fractions(const LayerOperator& op, const LayerFeet& feet, const Eigen::VectorXd& pressure, int powers) {
  assert(op.law.terms == 2 && pressure.size() == feet.size() && powers >= 1);
  const Eigen::Index n = op.mesh.nodes();
  std::vector<int> all(at(n));
  std::iota(all.begin(), all.end(), 0);
  const Nodal load = loads(op, feet, pressure), ones = Nodal::Ones(n, 1);
  Nodal volume = Nodal::Zero(n, 1);
  add_times(op.pattern, op.mass, all, ones, volume);
  Eigen::MatrixXd out(n, 2 + powers);
  for (Eigen::Index v = 0; v < n; ++v) out(v, 0) = volume(v, 0) > 0 ? load(v, 0) / volume(v, 0) : 0.0;
  std::vector<int> inner = all;
  std::erase_if(inner, [&](int v) { return op.edge_held[at(v)] != 0; });
  out.col(1) = with_edges_held(op, inner, half_solved(op, inner, load));
  out.col(2) = solved(op.factor[1], op.held[1], all, load);
  // Beyond an edge where the layer goes on q_k decays like a polynomial times exp(-y); what it drives there comes in
  // over the edge with the terms of 1 - sqrt(1 - x) = x/2 + x^2/8 + x^3/16 + ...
  for (int k = 2; k <= powers; ++k) {
    Nodal right_side = Nodal::Zero(n, 1), outside = Nodal::Zero(n, 1);
    double share = 0.5;
    for (int j = 1; j < k; ++j) {
      outside += share * out.col(1 + k - j);
      share *= (2.0 * j - 1) / (2.0 * j + 2);
    }
    add_times(op.pattern, op.mass, all, out.col(k), right_side);
    add_times(op.pattern, op.beyond, all, outside, right_side);
    out.col(1 + k) = solved(op.factor[1], op.held[1], all, std::move(right_side));
  }
  return out;
}

double own_compliance(const LayerOperator& layer, const LayerFeet& feet, int foot, const Eigen::VectorXd* softening) {
  const double own = layer.law.own_share;
  return feet.own[at(foot)] - (softening ? own * own * feet.thickness(foot) * (*softening)[foot] : 0.0);
}

}  // namespace dea

#include "layer_operator.h"

#include <cholmod.h>

#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <new>
#include <stdexcept>
#include <utility>

namespace dea {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// local pairs of vertices: diagonal, then the rest
constexpr std::size_t kFirst[6] = {0, 1, 2, 0, 1, 2}, kSecond[6] = {0, 1, 2, 1, 2, 0};

/// Gradients of the hat functions of a triangle's corners: the opposite edge turned inwards, over twice the area.
std::array<Vector3d, 3> hat_gradients(const SurfaceMesh& mesh, int t) {
  std::array<Vector3d, 3> gradient;
  for (int k = 0; k < 3; ++k)
    gradient[at(k)] = mesh.normals[at(t)].cross(mesh.corner(t, (k + 2) % 3) - mesh.corner(t, (k + 1) % 3)) /
                      (2 * mesh.areas[at(t)]);
  return gradient;
}

/// Per vertex: distance from the nearest free edge of the face, from each edge over the triangles around, as far as it
/// is felt.
std::vector<double> edge_distances(const LayerFace& face, const LayerMesh& layer) {
  const SurfaceMesh& mesh = layer.mesh;
  const double reach =
      kEdgeReach * (face.thickness.empty() ? 0.0 : *std::max_element(face.thickness.begin(), face.thickness.end()));
  std::vector<double> distance(mesh.vertices.size(), reach);
  std::vector<int> seen(at(mesh.size()), -1), front;
  for (std::size_t k = 0; k < face.edges.size(); ++k) {
    const LayerFace::Edge& edge = face.edges[k];
    if (edge.rim != Rim::Free) continue;
    const Vector3d &a = face.mesh.corner(edge.triangle, edge.edge),
                   &b = face.mesh.corner(edge.triangle, (edge.edge + 1) % 3);
    front.clear();
    for (int p = 0; p < layer.divide * layer.divide; ++p) {
      front.push_back(edge.triangle * layer.divide * layer.divide + p);
      seen[at(front.back())] = static_cast<int>(k);
    }
    while (!front.empty()) {
      const int t = front.back();
      front.pop_back();
      bool felt = false;
      for (int v : mesh.triangles[at(t)]) {
        const double d = distance_to_segment(mesh.vertices[at(v)], a, b);
        felt = felt || d < reach;
        distance[at(v)] = std::min(distance[at(v)], d);
      }
      if (!felt) continue;
      for (const int next : mesh.neighbours[at(t)]) {
        if (next < 0 || seen[at(next)] == static_cast<int>(k)) continue;
        seen[at(next)] = static_cast<int>(k);
        front.push_back(next);
      }
    }
  }
  return distance;
}

/// (L10), with the mass lumped, so that the least and the largest thickness bound it.
std::vector<double> smeared_thickness(const SurfaceMesh& mesh, const std::vector<double>& t) {
  const double beta = layer_law({1.0, 0.3}, LayerFit::TwoTerms).beta[1];  // the same for every nu
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(t.size()));
  for (int k = 0; k < mesh.size(); ++k) {
    const auto& corner = mesh.triangles[at(k)];
    const double A = mesh.areas[at(k)], h[3] = {t[at(corner[0])], t[at(corner[1])], t[at(corner[2])]};
    const double squared = (h[0] * (h[0] + h[1] + h[2]) + h[1] * (h[1] + h[2]) + h[2] * h[2]) / 6;
    const auto gradient = hat_gradients(mesh, k);
    for (std::size_t i = 0; i < 3; ++i) {
      entries.emplace_back(corner[i], corner[i], A / 3);
      right[corner[i]] += A / 3 * h[i];
      for (std::size_t j = 0; j < 3; ++j)
        entries.emplace_back(corner[i], corner[j], beta * A * squared * gradient[i].dot(gradient[j]));
    }
  }
  Eigen::SparseMatrix<double> matrix(right.size(), right.size());
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::VectorXd smeared = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(right);
  const auto [least, most] = std::minmax_element(t.begin(), t.end());
  std::vector<double> out(t.size());
  for (std::size_t v = 0; v < t.size(); ++v) out[v] = std::clamp(smeared[static_cast<Eigen::Index>(v)], *least, *most);
  return out;
}

/// Curvature of the free edges within the surface: how much the rim turns at each vertex, pi less the angles of the
/// triangles there, spread along the rim over twice the thickness to both sides, so that zigzags cancel. In a plane of
/// symmetry the rim has its mirror image beyond.
std::vector<double> edge_curvatures(const LayerMesh& layer) {
  const SurfaceMesh& mesh = layer.mesh;
  std::vector<double> curvature(mesh.vertices.size(), 0.0), angles(mesh.vertices.size(), 0.0);
  std::vector<int> out(mesh.vertices.size(), -1), in(mesh.vertices.size(), -1);  // free edge that leaves, that arrives
  std::vector<char> walled(mesh.vertices.size(), 0), beside(mesh.vertices.size(), 0);
  for (std::size_t k = 0; k < layer.edges.size(); ++k) {
    const LayerMesh::Edge& edge = layer.edges[k];
    if (edge.rim == Rim::Free) {
      out[at(edge.a)] = in[at(edge.b)] = static_cast<int>(k);
      beside[at(edge.a)] = beside[at(edge.b)] = 1;
    } else if (edge.rim == Rim::Wall) {
      walled[at(edge.a)] = walled[at(edge.b)] = 1;
    }
  }
  for (int t = 0; t < mesh.size(); ++t)
    for (int c = 0; c < 3; ++c) {
      const int v = mesh.triangles[at(t)][at(c)];
      if (!beside[at(v)]) continue;
      const Vector3d a = mesh.corner(t, (c + 1) % 3) - mesh.corner(t, c),
                     b = mesh.corner(t, (c + 2) % 3) - mesh.corner(t, c);
      angles[at(v)] += std::atan2(a.cross(b).norm(), a.dot(b));
    }
  const double pi = std::acos(-1.0);
  const auto turning = [&](int v) {
    if (out[at(v)] >= 0 && in[at(v)] >= 0) return pi - angles[at(v)];
    return walled[at(v)] ? pi - 2 * angles[at(v)] : 0.0;
  };
  for (std::size_t v = 0; v < curvature.size(); ++v) {
    const double reach = 2 * layer.thickness[v];
    if (!beside[v] || !(reach > 0)) continue;
    double sum = turning(static_cast<int>(v));
    for (const bool forwards : {true, false}) {
      double way = 0.0;
      int at_vertex = static_cast<int>(v);
      bool onwards = forwards;
      for (std::size_t steps = 0; steps <= layer.edges.size(); ++steps) {
        int next = onwards ? out[at(at_vertex)] : in[at(at_vertex)];
        if (next < 0 && walled[at(at_vertex)]) {  // the mirror image: back along the same edges
          onwards = !onwards;
          next = onwards ? out[at(at_vertex)] : in[at(at_vertex)];
        }
        if (next < 0) break;
        const LayerMesh::Edge& edge = layer.edges[at(next)];
        way += edge.length;
        at_vertex = onwards ? edge.b : edge.a;
        if (way >= reach) break;
        sum += turning(at_vertex) * (1 - way / reach);
      }
    }
    curvature[v] = sum / reach;
  }
  return curvature;
}

}  // namespace

LayerMesh make_layer_mesh(const LayerFace& face, int divide) {
  LayerMesh layer;
  layer.divide = divide;
  layer.pressed = face.pressed * divide * divide;
  layer.mesh = divided(face.mesh, divide);
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
        layer.edges.push_back(
            {corner[c], corner[next], triangle,
             (layer.mesh.vertices[at(corner[next])] - layer.mesh.vertices[at(corner[c])]).norm(), edge.rim});
      }
  }
  layer.edge_distance = edge_distances(face, layer);
  layer.edge_curvature = edge_curvatures(layer);
  layer.thickness = smeared_thickness(layer.mesh, layer.thickness);
  return layer;
}

void add_foot(LayerFeet& feet, const LayerOperator& of, const std::vector<SurfacePart>& parts, double area) {
  const LayerMesh& layer = of.mesh();
  const double local = of.law().local, edge_own = of.edge().own;
  double sum = 0;
  for (const SurfacePart& part : parts) sum += part.area;
  double volume = 0, own = 0;
  if (sum > 0 && area > 0) {
    const double scale = area / sum;
    const std::size_t first = at(feet.begin.back());
    for (const SurfacePart& part : parts) {
      const auto& corner = layer.mesh.triangles[at(part.triangle)];
      double t[3], d[3], shape = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        t[k] = layer.thickness[at(corner[k])];
        d[k] = layer.edge_distance[at(corner[k])];
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
          b[k] += a / 12 *
                  (at_corner[0] * (*p[0])[k] + at_corner[1] * (*p[1])[k] + at_corner[2] * (*p[2])[k] + 3 * mean * all[k]);
        part_volume += a * mean;
        if (mean > 0)  // nothing beyond the reach, where the distance is not known
          part_own += a * mean *
                      (local + edge_own * std::max(0.0, std::exp(-kEdgeDecay * edge / mean) -
                                                            std::exp(-kEdgeDecay * kEdgeReach)));
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
  const LayerMesh& mesh = layer.mesh();
  LayerFeet feet;
  std::vector<SurfacePart> part(1);
  part[0].corners = 3;
  part[0].corner = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (int t = 0; t < mesh.pressed; ++t) {
    part[0].triangle = t;
    part[0].area = mesh.mesh.areas[at(t)];
    add_foot(feet, layer, part, part[0].area);
  }
  return feet;
}

StrainExcess strain_excess(const Elasticity& layer, double q) {
  if (!(q > 0)) return {};
  const double per_modulus = 1 / confined_modulus(layer.E, layer.nu);
  const double strain = strain_at_pressure(Law::NeoHookean, layer, q);
  return {q * per_modulus - strain, per_modulus - 1 / layer_response(Law::NeoHookean, layer, strain).slope};
}

struct LayerOperator::State {
  std::shared_ptr<const LayerMesh> mesh;
  Elasticity elasticity;
  LayerLaw law;
  EdgeLaw edge;

  cholmod_common common;
  cholmod_sparse* matrix = nullptr;                            // lower triangle
  std::array<cholmod_factor*, 2> factor = {nullptr, nullptr};  // per term
  std::array<std::vector<char>, 2> held;                       // per term and node: q = 0
  std::vector<double> onwards;                                 // what of q_1 drives r: square M_t and the rims' parts
  /// A vertex of a free edge where q_0 = 0 and what flows out stretches the edge (L7).
  struct Outflow {
    int node = -1;
    double stretch = 0.0;  // z per rho: e / (beta_0 B)
  };
  std::vector<Outflow> outflow;
  std::vector<double> flow_matrix;  // S_0 as if nothing were held, where there is outflow
  cholmod_dense* solution = nullptr;                           // work space of cholmod_solve2
  cholmod_dense* work_y = nullptr;
  cholmod_dense* work_e = nullptr;

  State() { cholmod_start(&common); }
  ~State() {
    for (cholmod_factor*& f : factor) cholmod_free_factor(&f, &common);
    cholmod_free_sparse(&matrix, &common);
    cholmod_free_dense(&solution, &common);
    cholmod_free_dense(&work_y, &common);
    cholmod_free_dense(&work_e, &common);
    cholmod_finish(&common);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  void check() const {
    if (common.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
    if (common.status < CHOLMOD_OK) throw std::runtime_error("sparse factorisation failed");
  }

  int find(int i, int j) const {  // entry of nodes i, j in the lower triangle
    const int column = std::min(i, j), row = std::max(i, j);
    const int *begin = static_cast<const int*>(matrix->i) + static_cast<const int*>(matrix->p)[column],
              *end = static_cast<const int*>(matrix->i) + static_cast<const int*>(matrix->p)[column + 1];
    return static_cast<int>(std::lower_bound(begin, end, row) - static_cast<const int*>(matrix->i));
  }

  void make_pattern() {
    const int nodes = mesh->nodes();
    std::vector<std::pair<int, int>> entries;  // column, row
    entries.reserve(at(nodes) + 3 * mesh->mesh.triangles.size());
    for (int i = 0; i < nodes; ++i) entries.emplace_back(i, i);
    for (const auto& t : mesh->mesh.triangles)
      for (std::size_t e = 3; e < 6; ++e)
        entries.emplace_back(std::min(t[kFirst[e]], t[kSecond[e]]), std::max(t[kFirst[e]], t[kSecond[e]]));
    std::sort(entries.begin(), entries.end());
    entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
    matrix = cholmod_allocate_sparse(at(nodes), at(nodes), entries.size(), 1, 1, -1, CHOLMOD_REAL, &common);
    check();
    int *p = static_cast<int*>(matrix->p), *rows = static_cast<int*>(matrix->i);
    std::fill(p, p + nodes + 1, 0);
    for (std::size_t k = 0; k < entries.size(); ++k) {
      ++p[entries[k].first + 1];
      rows[k] = entries[k].second;
    }
    for (int i = 0; i < nodes; ++i) p[i + 1] += p[i];
    std::fill_n(static_cast<double*>(matrix->x), entries.size(), 0.0);
  }

  /// M_t, K_t3, and along the edges the integral of t^2, all with the pattern of the matrix.
  struct Parts {
    std::vector<double> mass, stiffness, free_edge, open_edge;
  };
  Parts assemble() const {
    const SurfaceMesh& surface = mesh->mesh;
    const std::vector<double> none(at(static_cast<const int*>(matrix->p)[mesh->nodes()]), 0.0);
    Parts parts = {none, none, none, none};
    for (int t = 0; t < surface.size(); ++t) {
      const auto& corner = surface.triangles[at(t)];
      const double A = surface.areas[at(t)];
      const auto gradient = hat_gradients(surface, t);
      const double h[3] = {mesh->thickness[at(corner[0])], mesh->thickness[at(corner[1])],
                           mesh->thickness[at(corner[2])]},
                   sum = h[0] + h[1] + h[2];
      // integrals of linear t: t^3 is the sum of its monomials of degree 3 over 10; t N_i N_j by products of N
      const double cubed =
          (h[0] * h[0] * (h[0] + h[1] + h[2]) + h[1] * h[1] * (h[1] + h[2]) + h[2] * h[2] * h[2] +
           h[0] * h[1] * (h[1] + h[2]) + h[2] * h[2] * (h[0] + h[1])) /
          10;
      for (std::size_t e = 0; e < 6; ++e) {
        const std::size_t i = kFirst[e], j = kSecond[e], s = at(find(corner[i], corner[j]));
        parts.mass[s] += i == j ? A * (2 * sum + 4 * h[i]) / 60 : A * (sum + h[i] + h[j]) / 60;
        parts.stiffness[s] += A * cubed * gradient[i].dot(gradient[j]);
      }
    }
    for (const LayerMesh::Edge& side : mesh->edges) {
      if (side.rim == Rim::Wall) continue;
      std::vector<double>& along = side.rim == Rim::Free ? parts.free_edge : parts.open_edge;
      // integral of t^2 N_i N_j along the edge, t linear
      const double ta = mesh->thickness[at(side.a)], tb = mesh->thickness[at(side.b)], l = side.length / 30;
      along[at(find(side.a, side.a))] += l * (6 * ta * ta + 3 * ta * tb + tb * tb);
      along[at(find(side.b, side.b))] += l * (6 * tb * tb + 3 * ta * tb + ta * ta);
      along[at(find(side.a, side.b))] += l * (1.5 * ta * ta + 2 * ta * tb + 1.5 * tb * tb);
    }
    return parts;
  }

  /// At a free edge what bulges escapes: q = 0 in the first term. The second decays within 0.4 t, which few meshes
  /// resolve: held, it would make coarse edges stiff; it goes on as beyond a loaded patch, and (L7) adds what is
  /// missing. Returns per node what S_0 gains where a hole's rim is not held.
  std::vector<double> find_held() {
    std::vector<char> carries(at(mesh->nodes()), 0), bare(at(mesh->nodes()), 0);
    std::vector<double> share(at(mesh->nodes()), 0.0), gained(at(mesh->nodes()), 0.0);  // B_v
    for (const LayerMesh::Edge& side : mesh->edges) {
      if (side.rim != Rim::Free) continue;
      for (const int v : {side.a, side.b})
        share[at(v)] += 0.5 * side.length * mesh->thickness[at(v)] * mesh->thickness[at(v)];
    }
    for (const auto& corner : mesh->mesh.triangles) {
      double most = 0;
      for (int v : corner) most = std::max(most, mesh->thickness[at(v)]);
      for (int v : corner) (most > 0 ? carries : bare)[at(v)] = 1;
    }
    for (auto& of_term : held) of_term.assign(carries.size(), 0);
    constexpr double kMostRobin = 5.0;  // keeps the operator positive; larger ones are seen no more
    for (int v = 0; v < mesh->nodes(); ++v) {
      held[1][at(v)] = !carries[at(v)];
      held[0][at(v)] = !carries[at(v)] || bare[at(v)];
      if (held[0][at(v)] || !(share[at(v)] > 0)) continue;
      const double bend = std::min(mesh->edge_curvature[at(v)] * mesh->thickness[at(v)], 1.0),
                   e = edge.straight + edge.curved * bend;
      if (e < 0 && law.weight[0] < 0) {
        gained[at(v)] = law.beta[0] * share[at(v)] / std::min(e / law.weight[0], kMostRobin);
        continue;
      }
      held[0][at(v)] = 1;
      if (e > 0) outflow.push_back({v, e / (law.beta[0] * share[at(v)])});
    }
    return gained;
  }

  void factorise() {
    const std::vector<double> gained = find_held();
    const Parts parts = assemble();
    const int *p = static_cast<const int*>(matrix->p), *rows = static_cast<const int*>(matrix->i);
    double* x = static_cast<double*>(matrix->x);
    const std::size_t entries = parts.mass.size();
    for (std::size_t k = 0; k < at(law.terms); ++k) {
      const double beta = law.beta[k], root = std::sqrt(beta);
      for (std::size_t s = 0; s < entries; ++s)
        x[s] = parts.mass[s] + beta * parts.stiffness[s] +
               root * (parts.open_edge[s] + (k == 1 ? parts.free_edge[s] : 0.0));
      if (k == 0) {
        for (int v = 0; v < mesh->nodes(); ++v) x[p[v]] += gained[at(v)];  // the diagonal comes first
        if (!outflow.empty()) flow_matrix.assign(x, x + entries);
      }
      for (int column = 0; column < mesh->nodes(); ++column)
        for (int s = p[column]; s < p[column + 1]; ++s)
          if (held[k][at(column)] || held[k][at(rows[s])])  // the row says q = 0; the pattern stays
            x[s] = rows[s] == column ? 1.0 : 0.0;
      cholmod_factorize(matrix, factor[k], &common);
      check();
      if (common.status != CHOLMOD_OK) throw std::runtime_error("sparse factorisation: not positive definite");
    }
    if (law.terms < 2) return;
    // Beyond an edge where the layer goes on q_1 has the other half of its square: q decays like exp(-y), and
    // S_1 r = M_t q_1 there is worth sqrt(beta_1)/2 t^2 q at the edge.
    onwards.resize(entries);
    for (std::size_t s = 0; s < entries; ++s)
      onwards[s] = law.square * (parts.mass[s] + 0.5 * std::sqrt(law.beta[1]) * parts.open_edge[s]) +
                   edge.around * parts.free_edge[s];
  }

  /// q of one term for a load; nodes x columns, the same memory at every call.
  Eigen::Map<const Eigen::MatrixXd> solve(std::size_t term, Eigen::MatrixXd& load) {
    for (Eigen::Index c = 0; c < load.cols(); ++c)
      for (Eigen::Index v = 0; v < load.rows(); ++v)
        if (held[term][static_cast<std::size_t>(v)]) load(v, c) = 0.0;
    cholmod_dense right{};
    right.nrow = right.d = static_cast<std::size_t>(load.rows());
    right.ncol = static_cast<std::size_t>(load.cols());
    right.nzmax = right.nrow * right.ncol;
    right.x = load.data();
    right.xtype = CHOLMOD_REAL;
    right.dtype = CHOLMOD_DOUBLE;
    cholmod_solve2(CHOLMOD_A, factor[term], &right, nullptr, &solution, nullptr, &work_y, &work_e, &common);
    check();
    return {static_cast<const double*>(solution->x), load.rows(), load.cols()};
  }

  /// A symmetric matrix with the pattern of the matrix times q.
  Eigen::MatrixXd times(const std::vector<double>& entry, const Eigen::Ref<const Eigen::MatrixXd>& q) const {
    Eigen::MatrixXd product = Eigen::MatrixXd::Zero(q.rows(), q.cols());
    const int *p = static_cast<const int*>(matrix->p), *rows = static_cast<const int*>(matrix->i);
    for (Eigen::Index c = 0; c < q.cols(); ++c)
      for (int column = 0; column < mesh->nodes(); ++column) {
        product(column, c) += entry[at(p[column])] * q(column, c);  // the diagonal comes first
        for (int s = p[column] + 1; s < p[column + 1]; ++s) {
          product(column, c) += entry[at(s)] * q(rows[s], c);
          product(rows[s], c) += entry[at(s)] * q(column, c);
        }
      }
    return product;
  }

  /// What the edges' stretch adds to q: z (L7), for the load b p and its q_0.
  Eigen::MatrixXd edge_stretch(const Eigen::MatrixXd& load, const Eigen::MatrixXd& q) {
    const Eigen::MatrixXd flow = load - times(flow_matrix, q);
    Eigen::MatrixXd z = Eigen::MatrixXd::Zero(load.rows(), load.cols());
    for (const Outflow& v : outflow) z.row(v.node) = v.stretch * flow.row(v.node);
    Eigen::MatrixXd right_side = -times(flow_matrix, z);
    return z + solve(0, right_side);  // which holds the edge
  }

  /// b p, nodes x columns
  Eigen::MatrixXd loads(const LayerFeet& feet, const Eigen::MatrixXd& p) const {
    Eigen::MatrixXd load = Eigen::MatrixXd::Zero(mesh->nodes(), p.cols());
    for (Eigen::Index c = 0; c < p.cols(); ++c)
      for (int i = 0; i < feet.size(); ++i) {
        if (p(i, c) == 0) continue;
        for (int k = feet.begin[at(i)]; k < feet.begin[at(i + 1)]; ++k)
          load(feet.node[at(k)], c) += feet.weight[at(k)] * p(i, c);
      }
    return load;
  }
  /// b_i . q of one foot
  template <class Nodal>
  static double gathered(const LayerFeet& feet, int i, const Nodal& q, Eigen::Index c) {
    double sum = 0;
    for (int k = feet.begin[at(i)]; k < feet.begin[at(i + 1)]; ++k)
      sum += feet.weight[at(k)] * q(feet.node[at(k)], c);
    return sum;
  }

  /// w, with excess(i, q) the strain by which a foot answers less than linearly to the pressure q = (B p)_i; null:
  /// small strain.
  template <class Excess>
  Eigen::MatrixXd flow(const LayerFeet& feet, const Eigen::MatrixXd& p, const Excess& excess, bool large) {
    assert(p.rows() == feet.size());
    const double own = law.own_share;
    Eigen::MatrixXd load = loads(feet, p), all, strain;
    const bool two = law.terms == 2;
    Eigen::MatrixXd right_side = load;
    if (outflow.empty()) {
      all = law.weight[0] * solve(0, right_side);
    } else {
      const Eigen::MatrixXd q = solve(0, right_side);
      all = law.weight[0] * q + edge_stretch(load, q);
    }
    if (large) strain = Eigen::MatrixXd::Zero(p.rows(), p.cols());
    const auto find_strain = [&](const auto& q) {
      for (Eigen::Index c = 0; c < p.cols(); ++c)
        for (int i = 0; i < feet.size(); ++i) {
          if (!(feet.volume[at(i)] > 0)) continue;
          const double around = own < 1 ? gathered(feet, i, q, c) / feet.volume[at(i)] : 0.0;
          strain(i, c) = excess(i, own * p(i, c) + (1 - own) * around);
        }
    };
    if (two) {
      const auto q = solve(1, load);
      all += law.weight[1] * q;
      right_side = times(onwards, q);  // the square of the fraction: S^-1 M_t S^-1
      if (large) {
        find_strain(q);
        right_side -= (1 - own) * loads(feet, strain);
      }
      all += solve(1, right_side);
    } else if (large) {
      find_strain(load);
    }
    Eigen::MatrixXd w = Eigen::MatrixXd::Zero(p.rows(), p.cols());
    for (Eigen::Index c = 0; c < p.cols(); ++c)
      for (int i = 0; i < feet.size(); ++i) {
        if (!(feet.area[at(i)] > 0)) continue;
        w(i, c) = feet.own[at(i)] * p(i, c) + gathered(feet, i, all, c) / feet.area[at(i)];
        if (large) w(i, c) -= own * feet.thickness(i) * strain(i, c);
      }
    return w;
  }
};

LayerOperator::LayerOperator(std::shared_ptr<const LayerMesh> mesh, const Elasticity& elasticity, LayerFit fit)
    : state_(new State) {
  State& s = *state_;
  s.mesh = std::move(mesh);
  s.elasticity = elasticity;
  s.law = layer_law(elasticity, fit);
  s.edge = edge_law(elasticity, fit);
  s.common.print = 0;
  s.make_pattern();
  // Simplicial, so no BLAS and no threads: up to 200,000 feet it was no slower than supernodal with the reference BLAS.
  // AMD: nested dissection took longer to find than it saved.
  s.common.supernodal = CHOLMOD_SIMPLICIAL;
  s.common.final_ll = 1;
  s.common.nmethods = 1;
  s.common.method[0].ordering = CHOLMOD_AMD;
  s.common.postorder = 1;
  s.factor[0] = cholmod_analyze(s.matrix, &s.common);
  s.check();
  if (s.law.terms == 2) s.factor[1] = cholmod_copy_factor(s.factor[0], &s.common);
  s.check();
  s.factorise();
}
LayerOperator::~LayerOperator() = default;
LayerOperator::LayerOperator(LayerOperator&&) noexcept = default;
LayerOperator& LayerOperator::operator=(LayerOperator&&) noexcept = default;

const LayerMesh& LayerOperator::mesh() const { return *state_->mesh; }
const LayerLaw& LayerOperator::law() const { return state_->law; }
const EdgeLaw& LayerOperator::edge() const { return state_->edge; }
const Elasticity& LayerOperator::elasticity() const { return state_->elasticity; }
double LayerOperator::factor_entries() const { return state_->common.lnz; }

Eigen::MatrixXd LayerOperator::sinking(const LayerFeet& feet, const Eigen::MatrixXd& pressure,
                                       const Eigen::VectorXd* softening) {
  return state_->flow(
      feet, pressure, [&](int i, double q) { return softening ? (*softening)[i] * q : 0.0; }, softening != nullptr);
}

Eigen::VectorXd LayerOperator::large_sinking(const LayerFeet& feet, const Eigen::VectorXd& pressure,
                                             Eigen::VectorXd& softening) {
  softening.setZero(pressure.size());
  const Elasticity layer = state_->elasticity;
  return state_->flow(
      feet, pressure,
      [&](int i, double q) {
        const StrainExcess e = strain_excess(layer, q);
        softening[i] = e.slope;
        return e.strain;
      },
      true);
}

double LayerOperator::own_compliance(const LayerFeet& feet, int foot, const Eigen::VectorXd* softening) const {
  const double own = state_->law.own_share;
  return feet.own[at(foot)] - (softening ? own * own * feet.thickness(foot) * (*softening)[foot] : 0.0);
}

}  // namespace dea

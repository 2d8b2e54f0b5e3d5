#include "layer_operator.h"

#include <cholmod.h>

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

// local pairs of vertices, in the order of LayerMesh::slopes
constexpr std::size_t kFirst[6] = {0, 1, 2, 0, 1, 2}, kSecond[6] = {0, 1, 2, 1, 2, 0};

}  // namespace

LayerMesh make_layer_mesh(const SurfaceMesh& surface) {
  std::vector<int> triangle(at(surface.size()));
  for (int t = 0; t < surface.size(); ++t) triangle[at(t)] = t;
  return make_layer_mesh(surface, triangle,
                         std::vector<std::array<std::array<double, 3>, 3>>(
                             triangle.size(), {{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}}));
}

LayerMesh make_layer_mesh(const SurfaceMesh& surface, const std::vector<int>& foot_triangle,
                          const std::vector<std::array<std::array<double, 3>, 3>>& corners) {
  assert(foot_triangle.size() == corners.size());
  LayerMesh mesh;
  mesh.nodes = static_cast<int>(surface.vertices.size());
  mesh.vertices = surface.vertices;
  mesh.triangles = surface.triangles;
  mesh.neighbours = surface.neighbours;
  mesh.triangle_feet.resize(at(surface.size()));
  for (int t = 0; t < surface.size(); ++t) {
    Vector3d gradient[3];  // of N_k: the opposite edge turned inwards, over twice the area
    for (int k = 0; k < 3; ++k)
      gradient[k] = surface.normals[at(t)].cross(surface.corner(t, (k + 2) % 3) - surface.corner(t, (k + 1) % 3)) /
                    (2 * surface.areas[at(t)]);
    std::array<double, 6> slopes;
    for (std::size_t e = 0; e < 6; ++e) slopes[e] = gradient[kFirst[e]].dot(gradient[kSecond[e]]);
    mesh.slopes.push_back(slopes);
    for (int k = 0; k < 3; ++k) {
      if (surface.neighbours[at(t)][at(k)] >= 0) continue;
      const int next = (k + 1) % 3;
      mesh.rim.push_back({surface.triangles[at(t)][at(k)], surface.triangles[at(t)][at(next)], t,
                          (surface.corner(t, next) - surface.corner(t, k)).norm()});
    }
  }
  mesh.foot_triangle = foot_triangle;
  mesh.corners = corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    mesh.triangle_feet[at(foot_triangle[i])].push_back(static_cast<int>(i));
    const auto& w = corners[i];
    mesh.centroid.push_back(
        {(w[0][0] + w[1][0] + w[2][0]) / 3, (w[0][1] + w[1][1] + w[2][1]) / 3, (w[0][2] + w[1][2] + w[2][2]) / 3});
    const double share = w[0][0] * (w[1][1] * w[2][2] - w[1][2] * w[2][1]) -
                         w[0][1] * (w[1][0] * w[2][2] - w[1][2] * w[2][0]) +
                         w[0][2] * (w[1][0] * w[2][1] - w[1][1] * w[2][0]);
    mesh.area.push_back(surface.areas[at(foot_triangle[i])] * std::abs(share));
  }
  return mesh;
}

struct LayerOperator::State {
  std::shared_ptr<const LayerMesh> mesh;
  LayerLaw law;
  std::vector<Rim> rim;
  std::vector<double> thickness, own;

  cholmod_common common;
  cholmod_sparse* matrix = nullptr;                            // lower triangle
  std::array<cholmod_factor*, 2> factor = {nullptr, nullptr};  // per term
  std::vector<std::array<int, 6>> slot;                        // per triangle: where its entries are in the matrix
  std::vector<int> diagonal;                                   // per node
  std::vector<int> rim_slot;                                   // per rim edge: its off-diagonal entry
  std::array<std::vector<char>, 2> held;                       // per term and node: q = 0
  std::vector<double> mass;                                    // M_t, and what of q_1 lies beyond the rim
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
    std::vector<std::pair<int, int>> entries;  // column, row
    entries.reserve(at(mesh->nodes) + 3 * mesh->triangles.size());
    for (int i = 0; i < mesh->nodes; ++i) entries.emplace_back(i, i);
    for (const auto& t : mesh->triangles)
      for (std::size_t e = 3; e < 6; ++e)
        entries.emplace_back(std::min(t[kFirst[e]], t[kSecond[e]]), std::max(t[kFirst[e]], t[kSecond[e]]));
    std::sort(entries.begin(), entries.end());
    entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
    matrix = cholmod_allocate_sparse(at(mesh->nodes), at(mesh->nodes), entries.size(), 1, 1, -1, CHOLMOD_REAL, &common);
    check();
    int *p = static_cast<int*>(matrix->p), *rows = static_cast<int*>(matrix->i);
    std::fill(p, p + mesh->nodes + 1, 0);
    for (std::size_t k = 0; k < entries.size(); ++k) {
      ++p[entries[k].first + 1];
      rows[k] = entries[k].second;
    }
    for (int i = 0; i < mesh->nodes; ++i) p[i + 1] += p[i];
    std::fill_n(static_cast<double*>(matrix->x), entries.size(), 0.0);
    for (const auto& t : mesh->triangles) {
      std::array<int, 6> s;
      for (std::size_t e = 0; e < 6; ++e) s[e] = find(t[kFirst[e]], t[kSecond[e]]);
      slot.push_back(s);
    }
    for (int i = 0; i < mesh->nodes; ++i) diagonal.push_back(p[i]);
    for (const RimEdge& edge : mesh->rim) rim_slot.push_back(find(edge.a, edge.b));
  }

  /// M_t, K_t3 and the rim's term over sqrt(beta), all with the pattern of the matrix.
  void assemble(std::vector<double>& stiffness, std::array<std::vector<double>, 2>& beyond) {
    const std::size_t entries = at(static_cast<const int*>(matrix->p)[mesh->nodes]);
    mass.assign(entries, 0.0);
    stiffness.assign(entries, 0.0);
    beyond.fill(std::vector<double>(entries, 0.0));
    std::vector<double> volume(mesh->triangles.size(), 0.0), area(mesh->triangles.size(), 0.0);
    for (std::size_t f = 0; f < mesh->area.size(); ++f) {
      const std::size_t t = at(mesh->foot_triangle[f]);
      const double A = mesh->area[f], h = thickness[f];
      volume[t] += A * h;
      area[t] += A;
      // integral over the foot of N_i N_j: its corners' values c, (sum c_i c_j + sum c_i sum c_j)/12
      const auto& c = mesh->corners[f];
      const auto& g = mesh->centroid[f];
      for (std::size_t e = 0; e < 6; ++e) {
        const std::size_t i = kFirst[e], j = kSecond[e], s = at(slot[t][e]);
        mass[s] += A * h / 12 * (c[0][i] * c[0][j] + c[1][i] * c[1][j] + c[2][i] * c[2][j] + 9 * g[i] * g[j]);
        stiffness[s] += A * h * h * h * mesh->slopes[t][e];
      }
    }
    for (std::size_t k = 0; k < rim.size(); ++k) {
      if (rim[k] == Rim::Wall) continue;
      const RimEdge& edge = mesh->rim[k];
      const double h = volume[at(edge.triangle)] / area[at(edge.triangle)];
      const double share = h * h * edge.length / 6;
      for (std::size_t term = rim[k] == Rim::Free ? 1 : 0; term < 2; ++term) {
        beyond[term][at(diagonal[at(edge.a)])] += 2 * share;
        beyond[term][at(diagonal[at(edge.b)])] += 2 * share;
        beyond[term][at(rim_slot[k])] += share;
      }
    }
  }

  /// At a free edge what bulges escapes: q = 0 in the first term. The second decays within 0.4 t, which few meshes
  /// resolve: held, it would make coarse edges stiff; it goes on as beyond a loaded patch, and (L7) adds what is
  /// missing.
  void find_held() {
    std::vector<char> carries(at(mesh->nodes), 0), edge(at(mesh->nodes), 0);
    for (std::size_t k = 0; k < rim.size(); ++k)
      if (rim[k] == Rim::Free) edge[at(mesh->rim[k].a)] = edge[at(mesh->rim[k].b)] = 1;
    for (std::size_t f = 0; f < thickness.size(); ++f)
      for (const int v : mesh->triangles[at(mesh->foot_triangle[f])]) (thickness[f] > 0 ? carries : edge)[at(v)] = 1;
    for (std::size_t term = 0; term < 2; ++term) {
      held[term].resize(carries.size());
      for (std::size_t v = 0; v < carries.size(); ++v) held[term][v] = !carries[v] || (term == 0 && edge[v]);
    }
  }

  /// t (local + edge), with (L7) from the nearest free edge: from each edge to the triangles around, as far as it is
  /// felt.
  void find_own() {
    constexpr double kFelt = 2.0;  // times the thickness: exp(-5) of the edge's own
    std::vector<double> distance(thickness.size(), std::numeric_limits<double>::infinity());
    const double reach = kFelt * *std::max_element(thickness.begin(), thickness.end());
    std::vector<int> seen(mesh->triangles.size(), -1), front;
    for (std::size_t k = 0; k < rim.size() && law.edge > 0; ++k) {
      if (rim[k] != Rim::Free) continue;
      const RimEdge& edge = mesh->rim[k];
      const Vector3d &a = mesh->vertices[at(edge.a)], &b = mesh->vertices[at(edge.b)];
      front.assign(1, edge.triangle);
      seen[at(edge.triangle)] = static_cast<int>(k);
      while (!front.empty()) {
        const std::size_t t = at(front.back());
        front.pop_back();
        const auto& corner = mesh->triangles[t];
        const auto at_weights = [&](const std::array<double, 3>& w) -> Vector3d {
          return w[0] * mesh->vertices[at(corner[0])] + w[1] * mesh->vertices[at(corner[1])] +
                 w[2] * mesh->vertices[at(corner[2])];
        };
        for (const int f : mesh->triangle_feet[t])
          distance[at(f)] = std::min(distance[at(f)], distance_to_segment(at_weights(mesh->centroid[at(f)]), a, b));
        if (distance_to_segment(at_weights({1.0 / 3, 1.0 / 3, 1.0 / 3}), a, b) > reach) continue;
        for (const int next : mesh->neighbours[t]) {
          if (next < 0 || seen[at(next)] == static_cast<int>(k)) continue;
          seen[at(next)] = static_cast<int>(k);
          front.push_back(next);
        }
      }
    }
    own.resize(thickness.size());
    for (std::size_t f = 0; f < own.size(); ++f) {
      const double t = thickness[f];
      own[f] = t > 0 ? t * (law.local + law.edge * std::exp(-kEdgeDecay * distance[f] / t)) : 0.0;
    }
  }

  void factorise() {
    find_held();
    find_own();
    std::vector<double> stiffness;
    std::array<std::vector<double>, 2> beyond;
    assemble(stiffness, beyond);
    const int *p = static_cast<const int*>(matrix->p), *rows = static_cast<const int*>(matrix->i);
    double* x = static_cast<double*>(matrix->x);
    for (std::size_t k = 0; k < at(law.terms); ++k) {
      const double beta = law.beta[k], root = std::sqrt(beta);
      for (int column = 0; column < mesh->nodes; ++column)
        for (int s = p[column]; s < p[column + 1]; ++s) {
          const bool fixed = held[k][at(column)] || held[k][at(rows[s])];  // the row says q = 0; the pattern stays
          x[s] =
              fixed ? (rows[s] == column ? 1.0 : 0.0) : mass[at(s)] + beta * stiffness[at(s)] + root * beyond[k][at(s)];
        }
      cholmod_factorize(matrix, factor[k], &common);
      check();
      if (common.status != CHOLMOD_OK) throw std::runtime_error("sparse factorisation: not positive definite");
    }
    // Beyond an edge where the layer goes on q_1 has the other half of its square: q decays like exp(-y), and
    // S_1 r = M_t q_1 there is worth sqrt(beta_1)/2 t^2 q at the edge.
    if (law.terms == 2)
      for (std::size_t s = 0; s < mass.size(); ++s) mass[s] += 0.5 * std::sqrt(law.beta[1]) * beyond[0][s];
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

  /// M_t q, with what lies beyond the rim
  Eigen::MatrixXd weighted(const Eigen::Ref<const Eigen::MatrixXd>& q) const {
    Eigen::MatrixXd product = Eigen::MatrixXd::Zero(q.rows(), q.cols());
    const int *p = static_cast<const int*>(matrix->p), *rows = static_cast<const int*>(matrix->i);
    for (Eigen::Index c = 0; c < q.cols(); ++c)
      for (int column = 0; column < mesh->nodes; ++column) {
        product(column, c) += mass[at(p[column])] * q(column, c);  // the diagonal comes first
        for (int s = p[column] + 1; s < p[column + 1]; ++s) {
          product(column, c) += mass[at(s)] * q(rows[s], c);
          product(rows[s], c) += mass[at(s)] * q(column, c);
        }
      }
    return product;
  }
};

LayerOperator::LayerOperator(std::shared_ptr<const LayerMesh> mesh, const LayerLaw& law, std::vector<Rim> rim)
    : state_(new State) {
  State& s = *state_;
  assert(rim.size() == mesh->rim.size());
  s.mesh = std::move(mesh);
  s.law = law;
  s.rim = std::move(rim);
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
  if (law.terms == 2) s.factor[1] = cholmod_copy_factor(s.factor[0], &s.common);
  s.check();
}
LayerOperator::~LayerOperator() = default;
LayerOperator::LayerOperator(LayerOperator&&) noexcept = default;
LayerOperator& LayerOperator::operator=(LayerOperator&&) noexcept = default;

void LayerOperator::set_thickness(const std::vector<double>& thickness) {
  assert(thickness.size() == state_->mesh->area.size());
  state_->thickness = thickness;
  state_->factorise();
}

const std::vector<double>& LayerOperator::own() const { return state_->own; }
const LayerMesh& LayerOperator::mesh() const { return *state_->mesh; }
const LayerLaw& LayerOperator::law() const { return state_->law; }
const std::vector<double>& LayerOperator::thickness() const { return state_->thickness; }
double LayerOperator::factor_entries() const { return state_->common.lnz; }

void LayerOperator::add_sinking(const Eigen::MatrixXd& pressure, const Eigen::VectorXd& area,
                                Eigen::MatrixXd& sinking) {
  State& s = *state_;
  const LayerMesh& mesh = *s.mesh;
  const Eigen::Index feet = mesh.feet(), columns = pressure.cols();
  assert(pressure.rows() == feet && area.size() == feet && sinking.rows() == feet && sinking.cols() == columns);
  Eigen::MatrixXd load = Eigen::MatrixXd::Zero(mesh.nodes, columns);
  for (Eigen::Index c = 0; c < columns; ++c) {
    for (Eigen::Index f = 0; f < feet; ++f) {
      const std::size_t i = static_cast<std::size_t>(f);
      const double force = area[f] * s.thickness[i] * pressure(f, c);
      if (force == 0) continue;
      const auto& t = mesh.triangles[at(mesh.foot_triangle[i])];
      for (std::size_t k = 0; k < 3; ++k) load(t[k], c) += mesh.centroid[i][k] * force;
    }
  }
  Eigen::MatrixXd q = Eigen::MatrixXd::Zero(mesh.nodes, columns);  // what the weights make of all q
  const bool two = s.law.terms == 2;
  Eigen::MatrixXd right_side = load;
  q += s.law.weight[0] * s.solve(0, right_side);
  if (two) {
    const auto solution = s.solve(1, load);
    q += s.law.weight[1] * solution;
    right_side = s.weighted(solution);  // the square of the fraction: S^-1 M_t S^-1
    q += s.law.square * s.solve(1, right_side);
  }
  for (Eigen::Index c = 0; c < columns; ++c)
    for (Eigen::Index f = 0; f < feet; ++f) {
      const std::size_t i = static_cast<std::size_t>(f);
      const auto& t = mesh.triangles[at(mesh.foot_triangle[i])];
      const auto& g = mesh.centroid[i];
      sinking(f, c) +=
          s.own[i] * pressure(f, c) + s.thickness[i] * (g[0] * q(t[0], c) + g[1] * q(t[1], c) + g[2] * q(t[2], c));
    }
}

Eigen::VectorXd LayerOperator::sinking(const Eigen::VectorXd& pressure) {
  const LayerMesh& mesh = *state_->mesh;
  Eigen::MatrixXd w = Eigen::MatrixXd::Zero(mesh.feet(), 1);
  add_sinking(pressure, Eigen::Map<const Eigen::VectorXd>(mesh.area.data(), mesh.feet()), w);
  return w.col(0);
}

}  // namespace dea

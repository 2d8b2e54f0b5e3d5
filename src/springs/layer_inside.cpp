#include "src/springs/layer_inside.h"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <numeric>

#include "src/base/decompositions.h"
#include "src/base/numbers.h"
#include "src/base/parallel.h"

namespace dea {

namespace {

using Eigen::Index;
using Eigen::Matrix3d;

constexpr int kFractions = 1 + kDepthPowers;  // without p itself
constexpr double kMostCurvature = 0.5;        // times t
constexpr Index kRow[6] = {0, 1, 2, 0, 1, 2}, kColumn[6] = {0, 1, 2, 1, 2, 0};

Matrix3d symmetric(const double* packed) {
  Matrix3d m;
  for (Index k = 0; k < 6; ++k) m(kRow[k], kColumn[k]) = m(kColumn[k], kRow[k]) = packed[k];
  return m;
}

Matrix3d along_surface(const Vector3d& normal) { return Matrix3d::Identity() - normal * normal.transpose(); }

/// Two directions that span the plane across a unit vector.
Eigen::Matrix<double, 3, 2> across(const Vector3d& normal) {
  const Vector3d first = normal.unitOrthogonal();
  Eigen::Matrix<double, 3, 2> both;
  both << first, normal.cross(first);
  return both;
}

/// What a triangle's gradient, `share` of it, adds at a vertex to the slopes of its corners.
void add_slopes(const SurfaceMesh& mesh, int t, const Matrix3d& share, std::map<int, Vector3d>& slopes) {
  constexpr Barycentric kUnit[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (std::size_t c = 0; c < 3; ++c) {
    Vector3d& slope = slopes.try_emplace(mesh.triangles[at(t)][c], Vector3d::Zero()).first->second;
    slope += share * linear_gradient(mesh, t, kUnit[c]);
  }
}

/// Gradients at each vertex. Weighted by area, a line is fitted to those of the triangles around at their middles; in a
/// plane of symmetry it has no slope across.
void set_slopes(const SurfaceMesh& mesh, InsideShape& shape) {
  std::vector<std::vector<int>> around(mesh.vertices.size());
  for (int t = 0; t < mesh.size(); ++t)
    for (const int v : mesh.triangles[at(t)]) around[at(v)].push_back(t);
  shape.begin = {0};
  std::map<int, Vector3d> slopes;
  for (std::size_t v = 0; v < around.size(); ++v) {
    const Eigen::Matrix<double, 3, 2> plane = across(mesh.vertex_normals[v]);
    const auto place = [&](int t) {
      Vector3d x = mesh.centroid(t) - mesh.vertices[v];
      for (const Vector3d& wall : shape.walls[v]) x -= x.dot(wall) * wall;
      const Eigen::Vector2d flat = plane.transpose() * x;
      return Vector3d(1, flat.x(), flat.y());
    };
    Matrix3d normal_equations = Matrix3d::Zero();
    for (const int t : around[v]) normal_equations += mesh.areas[at(t)] * place(t) * place(t).transpose();
    // too few triangles for a slope: the mean
    normal_equations.bottomRightCorner<2, 2>() +=
        1e-3 * mesh.vertex_areas[v] * 3 * mesh.vertex_areas[v] * Eigen::Matrix2d::Identity();
    Vector3d fit = Vector3d::Zero();
    if (!around[v].empty()) fit = solve_regular(normal_equations, Vector3d::UnitX());
    const Matrix3d P = along_surface(mesh.vertex_normals[v]);
    slopes.clear();
    for (const int t : around[v]) add_slopes(mesh, t, mesh.areas[at(t)] * fit.dot(place(t)) * P, slopes);
    for (const auto& [vertex, slope] : slopes) {
      shape.vertex.push_back(vertex);
      shape.slope.push_back(slope);
    }
    shape.begin.push_back(static_cast<int>(shape.vertex.size()));
  }
}

/// Gradient of what is linear in each triangle, at the vertices, along the surface. `values`: vertices x columns;
/// returns vertices x 3 columns, x y z of each.
Nodal vertex_gradients(const InsideShape& shape, const Nodal& values) {
  Nodal out = Nodal::Zero(values.rows(), 3 * values.cols());
  parallel_for(values.rows(), [&](Index v) {
    for (int k = shape.begin[at(v)]; k < shape.begin[at(v) + 1]; ++k)
      for (Index c = 0; c < values.cols(); ++c)
        out.row(v).segment<3>(3 * c) += values(shape.vertex[at(k)], c) * shape.slope[at(k)].transpose();
  });
  return out;
}

/// In a plane of symmetry nothing points out of it.
void stay_in_planes(const std::vector<std::array<Vector3d, 2>>& walls, Nodal& vectors) {
  for (Index v = 0; v < vectors.rows(); ++v)
    for (const Vector3d& wall : walls[at(v)]) {
      if (wall.isZero(0.0)) continue;
      for (Index c = 0; c < vectors.cols(); c += 3)
        vectors.row(v).segment<3>(c) -= vectors.row(v).segment<3>(c).dot(wall) * wall.transpose();
    }
}

/// Unit normals, in the surface, of the walls at each vertex: at most two that differ.
std::vector<std::array<Vector3d, 2>> walls_of(const LayerMesh& layer) {
  std::vector<std::array<Vector3d, 2>> walls(at(layer.nodes()), {Vector3d::Zero(), Vector3d::Zero()});
  for (const LayerMesh::Edge& edge : layer.edges) {
    if (edge.rim != Rim::Wall || !(edge.length > 0)) continue;
    const Vector3d along = (layer.mesh.vertices[at(edge.b)] - layer.mesh.vertices[at(edge.a)]) / edge.length;
    for (const int v : {edge.a, edge.b}) {
      auto& [first, second] = walls[at(v)];
      const Vector3d across = along.cross(layer.mesh.vertex_normals[at(v)]).normalized();
      if (first.isZero(0.0))
        first = across;
      else if (first.cross(across).norm() > 0.5 && second.isZero(0.0))
        second = (across - across.dot(first) * first).normalized();
    }
  }
  return walls;
}

/// Means around the vertices, weighted by the thickness, as the second fraction has them: over about 0.4 t.
Nodal smoothed(const LayerOperator& op, const Nodal& values) {
  std::vector<int> all(at(op.mesh.nodes()));
  std::iota(all.begin(), all.end(), 0);
  Nodal with_ones(values.rows(), values.cols() + 1), mean = Nodal::Zero(values.rows(), values.cols() + 1);
  with_ones << values, Eigen::VectorXd::Ones(values.rows());
  add_times(op.pattern, op.mass, all, with_ones, mean);
  solve(op.factor[1], all, mean);
  const Index last = values.cols();
  for (Index v = 0; v < mean.rows(); ++v) {
    const double weight = mean(v, last);
    if (weight > 0) mean.row(v) /= weight;
  }
  return mean.leftCols(last);
}

}  // namespace

InsidePlace inside_place(const LayerMesh& mesh, int triangle, const Barycentric& weights, double height) {
  if (mesh.divide == 1) return {triangle, weights, height};
  const int part = part_at(mesh.divide, weights);
  const auto corner = triangle_parts(mesh.divide)[at(part)];
  Matrix3d corners;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t k = 0; k < 3; ++k) corners(static_cast<Index>(k), static_cast<Index>(c)) = corner[c][k];
  const Vector3d in_part = solve_regular(corners, Vector3d(weights[0], weights[1], weights[2]));
  return {triangle * mesh.divide * mesh.divide + part, {in_part[0], in_part[1], in_part[2]}, height};
}

InsideMeasures measures(const InsideState& state) {
  const Vector3d stress = symmetric_eigenvalues_3(state.stress), strain = symmetric_eigenvalues_3(state.strain);
  return {0.5 * (stress[2] - stress[0]), strain[2], strain[0]};
}

InsideShape inside_shape(const LayerOperator& layer) {
  assert(layer.law.terms == 2);
  const SurfaceMesh& mesh = layer.mesh.mesh;
  const Index n = layer.mesh.nodes();
  InsideShape shape;
  shape.walls = walls_of(layer.mesh);
  set_slopes(mesh, shape);
  Nodal rise = vertex_gradients(shape, Eigen::Map<const Eigen::VectorXd>(layer.mesh.thickness.data(), n));
  stay_in_planes(shape.walls, rise);
  Nodal normals(n, 3);
  for (Index v = 0; v < n; ++v) normals.row(v) = mesh.vertex_normals[at(v)].transpose();
  const Nodal turning = vertex_gradients(shape, normals);
  Nodal packed(n, 6);
  for (Index v = 0; v < n; ++v) {
    Matrix3d G;
    for (Index c = 0; c < 3; ++c) G.row(c) = turning.row(v).segment<3>(3 * c);
    for (Index k = 0; k < 6; ++k) packed(v, k) = 0.5 * (G(kRow[k], kColumn[k]) + G(kColumn[k], kRow[k]));
  }
  packed = smoothed(layer, packed);
  for (Index v = 0; v < n; ++v) {
    const Eigen::Matrix<double, 6, 1> row = packed.row(v);
    const Matrix3d P = along_surface(mesh.vertex_normals[at(v)]);
    Matrix3d K = P * symmetric(row.data()) * P;
    const double bend = K.norm() * layer.mesh.thickness[at(v)];
    if (bend > kMostCurvature) K *= kMostCurvature / bend;
    shape.curvature.push_back(K);
    shape.rise.push_back(rise.row(v).transpose());
  }
  return shape;
}

InsideLayer look_inside(const LayerOperator& layer, const InsideShape& shape, const DepthLaws& laws,
                        const LayerFeet& feet, const Eigen::VectorXd& pressure) {
  InsideLayer inside{&layer, &shape, &laws, fractions(layer, feet, pressure, kDepthPowers), {}, {}};
  const SurfaceMesh& mesh = layer.mesh.mesh;
  const Index n = inside.value.rows();
  if (!(inside.value.col(0).cwiseAbs().maxCoeff() > 0)) {  // nothing is pressed
    inside.gradient = Nodal::Zero(n, 3 * kFractions);
    inside.spread = Nodal::Zero(n, 6 * kFractions);
    return inside;
  }
  inside.gradient = vertex_gradients(shape, inside.value.rightCols(kFractions));
  stay_in_planes(shape.walls, inside.gradient);
  const auto squared = Eigen::Map<const Eigen::VectorXd>(layer.mesh.thickness.data(), n).array().square().matrix();
  const Nodal flow = squared.asDiagonal() * inside.gradient;
  const Nodal of_flow = vertex_gradients(shape, flow);  // x y z of each component of each fraction's flow
  inside.spread.resize(n, 6 * kFractions);
  parallel_for(n, [&](Index v) {
    const Matrix3d P = along_surface(mesh.vertex_normals[at(v)]);
    for (Index f = 0; f < kFractions; ++f) {
      Matrix3d G;
      for (Index c = 0; c < 3; ++c) G.row(c) = of_flow.row(v).segment<3>(9 * f + 3 * c);
      Matrix3d H = P * (0.5 * (G + G.transpose())) * P;
      for (const Vector3d& wall : shape.walls[at(v)]) {  // what is odd there is zero
        const Vector3d odd = H * wall - wall.dot(H * wall) * wall;
        H -= odd * wall.transpose() + wall * odd.transpose();
      }
      for (Index k = 0; k < 6; ++k) inside.spread(v, 6 * f + k) = H(kRow[k], kColumn[k]);
    }
  });
  return inside;
}

namespace {

template <int size>
using Row = Eigen::Matrix<double, 1, size>;

/// What of a layer is known at a place, interpolated between the vertices.
struct Column {
  Row<2 + kDepthPowers> value = Row<2 + kDepthPowers>::Zero();
  Row<3 * kFractions> gradient = Row<3 * kFractions>::Zero();
  Row<6 * kFractions> spread = Row<6 * kFractions>::Zero();
  Vector3d normal = Vector3d::Zero(), rise = Vector3d::Zero();
  Matrix3d curvature = Matrix3d::Zero();
  double thickness = 0.0;
};
Column column_at(const InsideLayer& inside, const std::array<int, 3>& vertex, const Barycentric& weights) {
  Column c;
  for (std::size_t k = 0; k < 3; ++k) {
    const double w = weights[k];
    if (w == 0) continue;
    const int v = vertex[k];
    c.value += w * inside.value.row(v);
    c.gradient += w * inside.gradient.row(v);
    c.spread += w * inside.spread.row(v);
    c.normal += w * inside.layer->mesh.mesh.vertex_normals[at(v)];
    c.rise += w * inside.shape->rise[at(v)];
    c.curvature += w * inside.shape->curvature[at(v)];
    c.thickness += w * inside.layer->mesh.thickness[at(v)];
  }
  c.normal.normalize();
  return c;
}

double combined(const DepthFractions& of, const Row<2 + kDepthPowers>& value) {
  double sum = of.local * value[0] + of.first * value[1];
  for (int k = 0; k < kDepthPowers; ++k) sum += of.power[at(k)] * value[2 + k];
  return sum;
}

/// Sum over the fractions, `each` values of each.
template <int each>
Eigen::Matrix<double, each, 1> combined_each(const DepthFractions& of, const Row<each * kFractions>& value) {
  Eigen::Matrix<double, each, 1> sum = of.first * value.template head<each>().transpose();
  for (int k = 0; k < kDepthPowers; ++k)
    sum += of.power[at(k)] * value.template segment<each>((1 + k) * each).transpose();
  return sum;
}

/// s^2 of p: -t^2 Laplace of a fraction is the fraction before, less itself, over beta.
double combined_laplace(const DepthFractions& of, const LayerLaw& law, const Row<2 + kDepthPowers>& value) {
  double sum = of.first * (value[0] - value[1]) / law.beta[0], before = value[0];
  for (int k = 0; k < kDepthPowers; ++k) {
    sum += of.power[at(k)] * (before - value[2 + k]) / law.beta[1];
    before = value[2 + k];
  }
  return sum;
}

/// (N4) at a place: what the surface there carries, and how it is stretched in its plane.
struct Carried {
  Vector3d normal, shear;
  double pressure;
  Matrix3d stretch;  // the in-plane strain
};
Carried carried(const InsideLayer& inside, const Column& c, double height) {
  const LayerOperator& op = *inside.layer;
  const DepthLaw law = (*inside.laws)(height);
  const double nu = op.elasticity.nu, mu = op.elasticity.E / (2 * (1 + nu)), above = 1 - height, t = c.thickness,
               open = (1 - 2 * nu) / (1 - nu);  // 2 mu/M
  const double bend = t * c.curvature.trace();
  Carried out;
  out.pressure = (1 + above * bend * open) * combined(law.normal, c.value);
  out.normal = (c.normal + above * c.rise).normalized();
  const Matrix3d one = Matrix3d::Identity(), P = along_surface(out.normal), flat = along_surface(c.normal);
  const Matrix3d narrower = above * (t * c.curvature + 0.5 * bend * one);
  const Vector3d gradient = combined_each<3>(law.shear, c.gradient);
  out.shear =
      P * (-t * (one - narrower + narrower * narrower / 6).inverse() * gradient + above * open * out.pressure * c.rise);
  const Eigen::Matrix<double, 6, 1> packed = combined_each<6>(law.spread, c.spread);
  const Matrix3d uneven = -flat * symmetric(packed.data()) * flat / mu;
  const double trace = combined_laplace(law.spread, op.law, c.value) / mu;
  const double lever = 2.0 / 3 * (1 + above + above * above) / (1 + above);  // of the shear that spreads, from the top
  const Matrix3d widened = (one - lever * t * c.curvature).inverse();
  const Matrix3d stretch =
      widened / (1 - 0.5 * lever * bend) * (uneven + 0.5 * (trace - uneven.trace()) * flat) * widened -
      t / mu * combined(law.sinking, c.value) * c.curvature;
  out.stretch = P * stretch * P;
  return out;
}

InsideState small_state(const Elasticity& elasticity, const Carried& c) {
  const double nu = elasticity.nu, mu = elasticity.E / (2 * (1 + nu)), aside = nu / (1 - nu),
               per_modulus = (1 - 2 * nu) / (2 * (1 - nu)) / mu, trace = c.stretch.trace();
  const Matrix3d across = c.shear * c.normal.transpose(), nn = c.normal * c.normal.transpose(),
                 P = along_surface(c.normal);
  InsideState s;
  s.strain = c.stretch - (c.pressure * per_modulus + aside * trace) * nn + (across + across.transpose()) / (2 * mu);
  s.stress =
      2 * mu * c.stretch + aside * (2 * mu * trace - c.pressure) * P - c.pressure * nn + across + across.transpose();
  return s;
}

/// ln of the stretch along the normal at which a neo-Hookean solid, its plane stretched by the factor `area` in all,
/// carries this pressure on it.
double log_stretch(double mu, double lambda, double area, double pressure) {
  constexpr double kMostStep = 0.3;
  double x = 0;
  for (int i = 0; i < 60; ++i) {
    const double stretch = std::exp(x), J = area * stretch, log_J = x + std::log(area);
    const double f = mu / J * (stretch * stretch - 1) + lambda * log_J / J + pressure,
                 slope = mu / J * (stretch * stretch + 1) + lambda * (1 - log_J) / J;
    const double step = slope > 0 ? std::clamp(-f / slope, -kMostStep, kMostStep) : -kMostStep;
    x += step;
    if (std::abs(step) < 1e-14) break;
  }
  return x;
}

/// F = 1 + stretch + gamma n + (lambda_n - 1) n n: Cauchy stress mu/J (F F^T - 1) + lambda ln J/J has the normal stress
/// and the shear that are asked for when gamma = tau det(1 + stretch)/mu.
InsideState large_state(const Elasticity& elasticity, const Carried& c) {
  const double nu = elasticity.nu, mu = elasticity.E / (2 * (1 + nu)), lambda = 2 * mu * nu / (1 - 2 * nu);
  constexpr double kLeastArea = 0.05;
  const Matrix3d in_plane = Matrix3d::Identity() + c.stretch;
  const double area = std::max(kLeastArea, in_plane.determinant()),
               stretch = std::exp(log_stretch(mu, lambda, area, c.pressure)), J = area * stretch;
  const Matrix3d F = in_plane + (area / mu * c.shear + (stretch - 1) * c.normal) * c.normal.transpose();
  InsideState s;
  s.stress = mu / J * (F * F.transpose() - Matrix3d::Identity()) + lambda * std::log(J) / J * Matrix3d::Identity();
  s.strain = 0.5 * (F.transpose() * F - Matrix3d::Identity());
  return s;
}

InsideState state_of(const InsideLayer& inside, const Column& column, double height, StrainMeasure measure) {
  const Carried c = carried(inside, column, height);
  const Elasticity& elasticity = inside.layer->elasticity;
  InsideState state = measure == StrainMeasure::Large ? large_state(elasticity, c) : small_state(elasticity, c);
  state.normal = c.normal;
  state.pressure = c.pressure;
  state.shear = c.shear;
  return state;
}

}  // namespace

InsideState state_inside(const InsideLayer& inside, const InsidePlace& place, StrainMeasure measure) {
  const auto& corner = inside.layer->mesh.mesh.triangles[at(place.triangle)];
  return state_of(inside, column_at(inside, corner, place.weights), place.height, measure);
}

std::vector<InsideState> states_at_height(const InsideLayer& inside, double height, StrainMeasure measure) {
  std::vector<InsideState> states(at(inside.value.rows()));
  parallel_for(states.size(), [&](std::size_t v) {
    const int vertex = static_cast<int>(v);
    states[v] = state_of(inside, column_at(inside, {vertex, vertex, vertex}, {1, 0, 0}), height, measure);
  });
  return states;
}

}  // namespace dea

#include "src/equilibrium/flat_directions.h"

#include <algorithm>
#include <cmath>

#include "src/base/decompositions.h"
#include "src/equilibrium/approach.h"
#include "src/equilibrium/singular_parts.h"
#include "src/equilibrium/unknowns.h"

namespace dea {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

namespace {

/// Of the load: more than this is no roughness that a balance may be called one with, in all held directions together.
constexpr double kMostLeft = 0.01;

/// The flat direction's share of the residual that is left unbalanced: of a rotation about a point off the centre of
/// mass, which has a translation in it, the moment alone, so that forces balance to the last digit.
VectorXd moment_of(const Problem& problem, const Evaluation& e, const VectorXd& u) {
  VectorXd moment = as_free(problem, e, u);
  for (Eigen::Index i = 0; i < moment.size(); ++i)
    if (problem.free[static_cast<std::size_t>(i)] % 6 < 3) moment[i] = 0.0;
  if (problem.joined()) moment = e.tangent.basis.transpose() * moment;
  return moment.norm() > 0.3 ? VectorXd(moment.normalized()) : u;
}

/// The first, unless it lies nearly within what the columns of `others` span: then they would lose a component that
/// neither of them has, as two rotations about axes side by side lose the moment across. Else the second.
VectorXd apart_from(const MatrixXd& others, const VectorXd& first, const VectorXd& second) {
  constexpr double kApart = 0.5;
  if (others.cols() == 0) return first;
  const MatrixXd q = orthonormal_columns(others);
  return (first - q * (q.transpose() * first)).norm() > kApart ? first : second;
}

/// Newton's step where the columns of `held` are kept still and those of `left_unbalanced` need not balance:
/// K x + left_unbalanced y = r, held^T x = 0.
VectorXd bordered_step(const Sparse& K, const MatrixXd& left_unbalanced, const MatrixXd& held, const VectorXd& r) {
  const Eigen::Index n = K.rows(), lost = held.cols();
  std::vector<Eigen::Triplet<double>> entries;
  for (int k = 0; k < K.outerSize(); ++k)
    for (Sparse::InnerIterator it(K, k); it; ++it) entries.emplace_back(it.row(), it.col(), it.value());
  const double unit = K.norm() / std::sqrt(static_cast<double>(n)) + 1e-300;  // so that pivots compare
  for (Eigen::Index j = 0; j < lost; ++j) {
    for (Eigen::Index i = 0; i < n; ++i) {
      if (left_unbalanced(i, j) != 0.0) entries.emplace_back(i, n + j, unit * left_unbalanced(i, j));
      if (held(i, j) != 0.0) entries.emplace_back(n + j, i, unit * held(i, j));
    }
  }
  Sparse bordered(n + lost, n + lost);
  bordered.setFromTriplets(entries.begin(), entries.end());
  bordered.makeCompressed();
  const SparseLuFactors lu(bordered);
  VectorXd rhs = VectorXd::Zero(n + lost);
  rhs.head(n) = r;
  if (!lu.found()) return VectorXd::Zero(n);  // no step: the caller regularises
  const VectorXd x = lu.solve(rhs);
  return x.head(n);
}

/// A spring's normals: those in use, and what they differ from those averaged at the vertices.
struct SpringNormals {
  Vector3d smooth_force, rough_force;  // of the source: direction of the force
  Vector3d smooth_rate, rough_rate;    // of the target: change of the gap
};

SpringNormals normals_of(const SpringBed& bed, const SpringStates& s, std::size_t k, const Pose& source,
                         const Pose& target) {
  const SurfaceMesh &mesh_s = bed.pair.source_layer().spring_surface(), &mesh_t = bed.target.mesh();
  const auto& tri_s = mesh_s.triangles[at(bed.springs.surface_triangle[k])];
  const auto& tri_t = mesh_t.triangles[at(s.triangle[k])];
  Vector3d n = Vector3d::Zero(), m = Vector3d::Zero();
  for (std::size_t j = 0; j < 3; ++j) {
    n += (bed.springs.weights[k][0][j] + bed.springs.weights[k][1][j] + bed.springs.weights[k][2][j]) / 3.0 *
         mesh_s.vertex_normals[at(tri_s[j])];
    m += s.end_weights[k][j] * mesh_t.vertex_normals[at(tri_t[j])];
  }
  n = source.rotation * n.normalized();
  m = target.rotation * m.normalized();
  // the normal that the gap's derivative sees: of the facet, or of the smooth surface it stands for
  const Vector3d seen =
      (s.normal[k] - target.rotation * bulge_gradient(mesh_t, s.triangle[k], s.end_weights[k])).normalized();
  return {n, s.direction[k] - n, m, seen - m};
}

/// How much of the stiffness and of the force that a direction of motion (of the unknowns) feels is only the roughness
/// of the facets: with the normals in use against normals averaged at the vertices (E6).
struct FacetNoise {
  double stiffness = 0.0;
  double force = 0.0;
};
FacetNoise facet_noise(const Problem& problem, const Evaluation& e, const VectorXd& direction) {
  const VectorXd all = on_all_dofs(problem, e, direction);
  double products = 0.0, crossed = 0.0, sum = 0.0, sum2 = 0.0;
  for (std::size_t c = 0; c < e.springs.size(); ++c) {
    const SpringStates& s = e.springs[c];
    const SpringBed& bed = problem.beds.beds[c];
    if (s.size() == 0) continue;
    const Vector6 u_t = all.segment<6>(6 * bed.target_body), u_s = all.segment<6>(6 * bed.source_body);
    if (u_t.isZero(0.0) && u_s.isZero(0.0)) continue;
    const Pose &source = e.poses[at(bed.source_body)], &target = e.poses[at(bed.target_body)];
    const Vector3d v_t = u_t.head<3>(), w_t = u_t.tail<3>(), v_s = u_s.head<3>(), w_s = u_s.tail<3>();
    for (int i = 0; i < s.size(); ++i) {
      const auto k = at(i);
      if (s.pressure[k] <= 0 || s.area[k] <= 0) continue;
      const SpringNormals normals = normals_of(bed, s, k, source, target);
      const Vector3d relative = v_t + w_t.cross(s.foot[k] - target.center) - v_s - w_s.cross(s.foot[k] - source.center);
      const double smooth_force = normals.smooth_force.dot(relative), rough_force = normals.rough_force.dot(relative);
      const double smooth_rate = normals.smooth_rate.dot(relative), rough_rate = normals.rough_rate.dot(relative);
      const double stiffness = s.per_overlap[k] * s.area[k];
      products += stiffness * std::abs(rough_force * rough_rate);
      crossed += stiffness * (rough_force * smooth_rate + smooth_force * rough_rate);
      const double f = s.pressure[k] * s.area[k] * rough_force;
      sum += f;
      sum2 += f * f;
    }
  }
  return {products + std::abs(crossed), std::abs(sum) + 3.0 * std::sqrt(sum2)};
}

/// FacetNoise::stiffness from above for any direction, by one pass over the springs: |ab| <= (a^2 + b^2)/2 makes the
/// products of (E6) a quadratic form.
struct NoiseBound {
  std::vector<Matrix12> products, crossed;  // per contact: target, source

  NoiseBound(const Problem& problem, const Evaluation& e) {
    for (std::size_t c = 0; c < e.springs.size(); ++c) {
      products.push_back(Matrix12::Zero());
      crossed.push_back(Matrix12::Zero());
      const SpringStates& s = e.springs[c];
      const SpringBed& bed = problem.beds.beds[c];
      if (s.size() == 0) continue;
      const Pose &source = e.poses[at(bed.source_body)], &target = e.poses[at(bed.target_body)];
      for (int i = 0; i < s.size(); ++i) {
        const auto k = at(i);
        if (s.pressure[k] <= 0 || s.area[k] <= 0) continue;
        const SpringNormals normals = normals_of(bed, s, k, source, target);
        const double stiffness = s.per_overlap[k] * s.area[k];
        const auto line = [&](const Vector3d& n) { return unit_wrench(s.foot[k], n, source, target); };
        const Vector12 a = line(normals.rough_force), b = line(normals.rough_rate);
        products.back() += 0.5 * stiffness * (a * a.transpose() + b * b.transpose());
        crossed.back() +=
            stiffness * (a * line(normals.smooth_rate).transpose() + line(normals.smooth_force) * b.transpose());
      }
    }
  }

  double operator()(const Problem& problem, const Evaluation& e, const VectorXd& direction) const {
    const VectorXd all = on_all_dofs(problem, e, direction);
    double bound = 0.0;
    for (std::size_t c = 0; c < products.size(); ++c) {
      const SpringBed& bed = problem.beds.beds[c];
      Vector12 u;
      u << all.segment<6>(6 * bed.target_body), all.segment<6>(6 * bed.source_body);
      bound += u.dot(products[c] * u) + std::abs(u.dot(crossed[c] * u));
    }
    return bound;
  }
};

/// Of the largest stiffness: nothing. Where parts are, what presses them is known to some digits, so that their
/// surfaces stand a little askew: that resists no more than this, and pushes no more than kTilted of the load.
constexpr double kRounding = 1e-10, kTilt = 1e-7, kTilted = 1e-5;

/// Whether nothing but the facets' roughness resists a direction (E6), and how rough they are along it.
struct FlatTest {
  const Problem& problem;
  const Evaluation& e;
  const double patience;
  const Eigen::Index unknowns;
  std::optional<NoiseBound> bound = {};  // where there are many directions to be asked

  /// Nothing: the direction is stiff. `largest`: of the singular values, or a bound of it from above.
  std::optional<FacetNoise> operator()(double sigma, double largest, const VectorXd& v) {
    const bool nothing = sigma <= (problem.joint.parts.empty() ? kRounding : kTilt) * largest || largest == 0.0;
    if (sigma >= 0.1 * largest && !nothing) return std::nullopt;
    if (!nothing && unknowns > 12) {
      if (!bound) bound.emplace(problem, e);
      if (sigma > 2.0 * patience * (*bound)(problem, e, v)) return std::nullopt;
    }
    const FacetNoise noise = facet_noise(problem, e, v);
    if (!nothing && !(sigma <= 2.0 * patience * noise.stiffness)) return std::nullopt;
    return noise;
  }
};

/// Directions as columns. `lost`: per flat one, the component of the residual that is not asked to vanish; `stiff`: all
/// others where there are few unknowns, else none.
struct Split {
  MatrixXd flat, lost, stiff;
};

/// Fills d.held and d.drift too.
Split split_directions(const Problem& problem, const Evaluation& e, const SingularParts& parts, const VectorXd& r,
                       FlatTest& test, Directions& d) {
  const Eigen::Index n = r.size(), found = parts.sigma.size();
  const bool dense = n <= kDenseUnknowns;
  Split s{MatrixXd(n, found), MatrixXd(n, found), MatrixXd(n, dense ? n : 0)};
  Eigen::Index lost = 0, kept = 0;
  double left = 0.0;  // in the held directions so far, squared
  for (Eigen::Index k = 0; k < found; ++k) {
    const VectorXd u = parts.U.col(k), v = parts.V.col(k);
    const std::optional<FacetNoise> noise = test(parts.sigma[k], parts.largest, v);
    if (!noise) {
      if (dense) s.stiff.col(kept++) = v;
      continue;
    }
    s.flat.col(lost) = v;
    const double along = v.dot(r);
    const double most = std::min(test.patience * noise->force,
                                 std::sqrt(std::max(0.0, kMostLeft * e.load * kMostLeft * e.load - left)));
    if (std::abs(along) <= std::max((problem.joint.parts.empty() ? 1e-7 : kTilted) * e.load, most)) {
      left += along * along;
      d.held.push_back(v);
      s.lost.col(lost) = apart_from(s.lost.leftCols(lost), moment_of(problem, e, u), u);
    } else {
      d.drift += v * along;
      s.lost.col(lost) = u;
    }
    ++lost;
  }
  s.lost.conservativeResize(n, lost);
  s.flat.conservativeResize(n, lost);
  s.stiff.conservativeResize(n, kept);
  return s;
}

/// Does a spring under pressure press a body that moves by this?
bool moves_touched(const Problem& problem, const Evaluation& e, const VectorXd& motion) {
  if (!touching(e)) return false;
  const VectorXd all = on_all_dofs(problem, e, motion);
  const double least = 1e-6 * all.lpNorm<Eigen::Infinity>();
  for (std::size_t c = 0; c < e.springs.size(); ++c) {
    const std::vector<double>& p = e.springs[c].pressure;
    if (std::none_of(p.begin(), p.end(), [](double pressure) { return pressure > 0; })) continue;
    for (const int body : {problem.beds.beds[c].source_body, problem.beds.beds[c].target_body})
      if (all.segment<6>(6 * static_cast<Eigen::Index>(body)).lpNorm<Eigen::Infinity>() > least) return true;
  }
  return false;
}

/// Newton's step over the stiff directions, tested against the columns of `test`; and their least stiffness.
/// Along those of negative stiffness the load is followed, where Newton's step would go against it, if the problem asks
/// for that; or if no spring touches what moves so, for it is the only way to what is to carry the load. Where a flat
/// direction is loaded, that one leads to it.
void solve_stiff(const Problem& problem, const Evaluation& e, const Sparse& K, const MatrixXd& stiff,
                 const MatrixXd& test, const VectorXd& r, Directions& d) {
  if (stiff.cols() == 0) return;
  d.newton = stiff * solve_least_norm(test.transpose() * K * stiff, test.transpose() * r);
  const MatrixXd projected = stiff.transpose() * K * stiff;
  const Eigenvalues parts = symmetric_eigen(0.5 * (projected + projected.transpose()));
  d.least_stiffness = parts.values[0];
  const bool any_drift = d.drift.squaredNorm() > 0.0;
  for (Eigen::Index k = 0; k < parts.values.size() && parts.values[k] < 0; ++k) {
    const VectorXd unstable = stiff * parts.vectors.col(k);
    if (!problem.downhill && (any_drift || moves_touched(problem, e, unstable))) continue;
    d.newton -= unstable * unstable.dot(d.newton);
    d.drift += unstable * unstable.dot(r);
    d.falls = true;
  }
}

}  // namespace

Directions split_stiff_from_flat(const Problem& problem, const Evaluation& e, const VectorXd& r, double patience) {
  Directions d;
  d.stiffness = scaled_stiffness(problem, e);
  const Sparse& K = d.stiffness;
  const Eigen::Index n = K.rows();
  d.newton = d.drift = VectorXd::Zero(n);
  d.residual = r;
  d.left_unbalanced.resize(n, 0);
  if (n == 0) return d;
  const bool dense = n <= kDenseUnknowns;
  FlatTest test{problem, e, patience, n};
  // Singular values, not dof by dof: a ball joint is free about axes that are no dof's.
  SingularParts parts;
  if (dense) {
    parts = all_singular_parts(MatrixXd(K));
  } else {
    const double largest = K.norm();  // from above: asks a few more than needed
    parts = small_singular_parts(
        K, [&](double sigma, const VectorXd& v) { return test(sigma, largest, v).has_value(); }, kDenseUnknowns);
  }
  const Split split = split_directions(problem, e, parts, r, test, d);
  const Eigen::Index lost = split.lost.cols();
  MatrixXd asked = MatrixXd::Identity(dense ? n : 0, dense ? n : 0);  // components of the residual that are to vanish
  if (lost > 0) {
    if (dense) {
      const MatrixXd q = orthogonal_basis(split.lost);
      asked = q.rightCols(n - lost);
      d.left_unbalanced = q.leftCols(lost);
    } else {
      d.left_unbalanced = orthonormal_columns(split.lost);
    }
    if (d.drift.squaredNorm() == 0.0) d.residual -= d.left_unbalanced * (d.left_unbalanced.transpose() * r);
  }
  if (dense) {
    solve_stiff(problem, e, K, split.stiff, asked, r, d);
  } else {
    d.newton = bordered_step(K, d.left_unbalanced, split.flat, r);
    d.least_stiffness = least_symmetric_eigenvalue(K, split.flat, kDenseUnknowns);
  }
  return d;
}

std::optional<VectorXd> soft_motion(const Problem& problem, const Evaluation& e, const VectorXd& r) {
  if (r.size() == 0 || r.size() > kDenseUnknowns) return std::nullopt;
  const SingularParts parts = all_singular_parts(MatrixXd(scaled_stiffness(problem, e)));
  VectorXd motion = VectorXd::Zero(r.size());
  double soft = 0.0;
  for (Eigen::Index k = 0; k < parts.sigma.size(); ++k) {
    const VectorXd v = parts.V.col(k);
    const double along = parts.U.col(k).dot(r), stiffness = std::max(parts.sigma[k], 1e-12 * parts.largest);
    if (std::abs(along) * surface_motion(problem, e, v) <= 2.0 * problem.beds.least_thickness * stiffness) continue;
    soft += along * along;
    motion += along * v;
  }
  if (!(soft >= 0.25 * r.squaredNorm()) || !(motion.norm() > 0)) return std::nullopt;
  return motion;
}

}  // namespace dea

#include "src/springs/wrench.h"

#include <algorithm>
#include <cmath>

#include "src/base/decompositions.h"
#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/springs/spring_law.h"

namespace dea {

namespace {

/// dp by small motions of target and source, for rates by the target's relative to the source, about its centre.
Vector12 by_both_motions(const Eigen::MatrixXd& rates, Eigen::Index spring, const Vector3d& source_center,
                         const Vector3d& target_center) {
  const Vector3d a = rates.row(spring).head<3>(), turn = rates.row(spring).tail<3>();
  Vector12 kappa;
  kappa << a, turn, -a, -turn - Vector3d(target_center - source_center).cross(a);
  return kappa;
}

/// What the spring's force changes by, per pressure: how far a layer bulges out over its edge grows with the pressure.
double rate_area(const SpringStates& s, std::size_t k) { return 2 * s.carrying[k] - s.area[k]; }

std::vector<ContactWrench::Cross> cross_derivatives(const SpringStates& s, const Pose& source, const Pose& target) {
  std::vector<ContactWrench::Cross> all;
  for (const CrossRates& other : s.cross) {
    all.push_back({other.bodies, Matrix12::Zero()});
    for (int i = 0; i < s.size(); ++i)
      if (s.area[at(i)] > 0 && s.pressure[at(i)] != 0)
        all.back().derivative.noalias() +=
            rate_area(s, at(i)) * unit_wrench(s.foot[at(i)], s.direction[at(i)], source, target) *
            by_both_motions(other.rates, i, other.source_center, other.target_center).transpose();
  }
  return all;
}

}  // namespace

ContactWrench contact_wrench(const SpringStates& s, const Pose& source, const Pose& target) {
  // Sums are made in chunks of a fixed size, added in their order: the same bits for any number of threads.
  constexpr int kChunk = 2048;
  const int chunks = (s.size() + kChunk - 1) / kChunk;
  std::vector<ContactWrench, Eigen::aligned_allocator<ContactWrench>> partial(at(chunks));
  parallel_for(chunks, [&](int c) {
    ContactWrench& sum = partial[at(c)];
    for (int i = c * kChunk; i < std::min(s.size(), (c + 1) * kChunk); ++i) {
      const auto k = at(i);
      if (s.area[k] <= 0 || s.pressure[k] <= 0) continue;
      const Vector12 w = unit_wrench(s.foot[k], s.direction[k], source, target);
      Vector12 kappa = unit_wrench(s.end[k], s.per_motion[k], source, target);
      if (s.rates.rows() > 0) kappa = by_both_motions(s.rates, i, source.center, target.center);
      sum.wrench += s.force(k) * w;
      sum.derivative.noalias() += (rate_area(s, k) * w) * kappa.transpose();
      sum.normal_force += s.force(k);
    }
  });
  ContactWrench total;
  // Over the rim the covered area and the foot change too.
  for (const RimSpring& rim : s.rim) {
    const auto k = at(rim.spring);
    const Vector3d force = s.force(k) * s.direction[k];
    const Vector12 w = unit_wrench(s.foot[k], s.direction[k], source, target);
    total.derivative +=
        w * (s.pressure[k] * rim.area_rate.transpose() + s.area[k] * rim.pressure_gradient.transpose() * rim.foot_rate);
    total.derivative.block<3, 12>(3, 0) -= skew(force) * rim.foot_rate;
    total.derivative.block<3, 12>(9, 0) += skew(force) * rim.foot_rate;
  }
  for (const ContactWrench& part : partial) {
    total.wrench += part.wrench;
    total.derivative += part.derivative;
    total.normal_force += part.normal_force;
  }
  // The springs turn with the source: with F, M the force and moment on the target,
  //   dF = w_s x F,   dM = (v_s - v_t) x F - w_s-terms that sum to  (-[M]x + [F]x [c_t - c_s]x) w_s,   dM_s = w_s x
  //   M_s.
  const Vector3d F = total.wrench.segment<3>(0), M = total.wrench.segment<3>(3), M_s = total.wrench.segment<3>(9);
  Matrix12& K = total.derivative;
  K.block<3, 3>(0, 9) -= skew(F);
  K.block<3, 3>(6, 9) += skew(F);
  K.block<3, 3>(3, 6) -= skew(F);
  K.block<3, 3>(3, 0) += skew(F);
  K.block<3, 3>(3, 9) += -skew(M) + skew(F) * skew(Vector3d(target.center - source.center));
  K.block<3, 3>(9, 9) -= skew(M_s);
  total.cross = cross_derivatives(s, source, target);
  return total;
}

ContactWrench tie_rates(const SpringStates& s, const Pose& source, const Pose& target) {
  ContactWrench total;
  for (int i = 0; i < s.size(); ++i)
    if (s.area[at(i)] > 0)
      total.derivative.noalias() += s.area[at(i)] * unit_wrench(s.end[at(i)], s.direction[at(i)], source, target) *
                                    by_both_motions(s.rates, i, source.center, target.center).transpose();
  total.cross = cross_derivatives(s, source, target);
  return total;
}

namespace {

/// d(gap) of small motions (E2) where the dofs are free.
Vector12 opening_of(const SpringStates& s, int spring, const Pose& source, const Pose& target,
                    const std::array<bool, 12>& free) {
  const auto k = at(spring);
  Vector12 opening = unit_wrench(s.end[k], s.normal[k] / s.normal[k].dot(s.direction[k]), source, target);
  for (std::size_t d = 0; d < 12; ++d)
    if (!free[d]) opening[static_cast<Eigen::Index>(d)] = 0.0;
  return opening;
}

/// Rotations in units of a length, so that singular values of a stiffness can be told apart.
Vector12 units_of(const Matrix12& K) {
  const double length =
      std::max(1e-300, std::sqrt(K.diagonal().segment<3>(3).sum() + K.diagonal().segment<3>(9).sum()) /
                           std::sqrt(std::max(1e-300, K.trace())));
  Vector12 scale = Vector12::Ones();
  scale.segment<3>(3).setConstant(1 / std::max(length, 1e-12));
  scale.segment<3>(9) = scale.segment<3>(3);
  return scale;
}

}  // namespace

Matrix12 closing_stiffness(const SpringBed& bed, const SpringStates& s, const Pose& source, const Pose& target,
                           const Vector12& force, const std::array<bool, 12>& free) {
  const ContactPair& pair = bed.pair;
  Matrix12 K = Matrix12::Zero();
  std::vector<Vector12> opening(at(s.size()), Vector12::Zero());  // d(gap) of small motions
  double least_thickness = kInfinity;
  for (int i = 0; i < s.size(); ++i) {
    const auto k = at(i);
    if (s.triangle[k] < 0 || s.area[k] <= 0) continue;
    const SpringResponse r =
        spring_response(bed.pair.law, pair.source_layer().elasticity, pair.target_layer().elasticity, s.t_source[k],
                        s.t_target[k], 0.0, pair.interface_compliance);
    opening[k] = opening_of(s, i, source, target, free);
    K += r.per_overlap * s.area[k] * opening[k] * opening[k].transpose();
    least_thickness = std::min(least_thickness, s.t_source[k] + s.t_target[k]);
  }
  // The motion under the force.
  const Vector12 scale = units_of(K);
  Vector12 f = force;
  for (std::size_t d = 0; d < 12; ++d)
    if (!free[d]) f[static_cast<Eigen::Index>(d)] = 0.0;
  const SingularValues svd = whole_svd(scale.asDiagonal() * K * scale.asDiagonal());
  Vector12 motion = Vector12::Zero();
  for (Eigen::Index i = 0; i < 12 && svd.sigma[i] > 1e-6 * svd.sigma[0]; ++i)
    motion += svd.V.col(i) * (svd.U.col(i).dot(scale.asDiagonal() * f) / svd.sigma[i]);
  motion = scale.asDiagonal() * motion;
  double way = kInfinity, fastest = 0.0;
  for (int i = 0; i < s.size(); ++i) {
    const double closing = -opening[at(i)].dot(motion);
    if (closing > 0) way = std::min(way, std::max(0.0, s.gap[at(i)]) / closing);
    fastest = std::max(fastest, closing);
  }
  // The force opens the joint: what else holds the bodies decides. Enough to keep a solver's matrix regular, no more.
  if (!std::isfinite(way) || fastest <= 0) return force.isZero() ? K : Matrix12(1e-6 * K);
  way += 0.01 * least_thickness / fastest;
  return K / way;
}

int free_motions(const Pose& source, const Pose& target, const std::array<bool, 12>& free) {
  Eigen::Matrix<double, 6, 12> relative = Eigen::Matrix<double, 6, 12>::Zero();  // to the target, about its centre
  relative.leftCols<6>().setIdentity();
  relative.rightCols<6>() = -Eigen::Matrix<double, 6, 6>::Identity();
  const Vector3d arm = target.center - source.center;
  for (Eigen::Index k = 0; k < 3; ++k) relative.block<3, 1>(0, 9 + k) = arm.cross(Vector3d::Unit(k));
  for (std::size_t d = 0; d < 12; ++d)
    if (!free[d]) relative.col(static_cast<Eigen::Index>(d)).setZero();
  return static_cast<int>(pivoted_qr(relative.transpose(), 1e-9).rank);
}

int resisted_motions(const SpringStates& s, const Pose& source, const Pose& target, const std::array<bool, 12>& free) {
  Matrix12 K = Matrix12::Zero();
  for (int i = 0; i < s.size(); ++i) {
    if (s.area[at(i)] <= 0 || s.pressure[at(i)] <= 0) continue;
    const Vector12 opening = opening_of(s, i, source, target, free);
    K += s.area[at(i)] * opening * opening.transpose();
  }
  const Vector12 scale = units_of(K);
  const SingularValues svd = whole_svd(scale.asDiagonal() * K * scale.asDiagonal());
  int resisted = 0;
  for (Eigen::Index i = 0; i < 12 && svd.sigma[i] > 1e-2 * svd.sigma[0]; ++i) ++resisted;
  return resisted;
}

double opening_part(const SpringStates& s, const Vector12& force, const std::array<bool, 12>& free) {
  Vector3d away = Vector3d::Zero();  // how springs push the target
  for (int i = 0; i < s.size(); ++i)
    if (s.triangle[at(i)] >= 0) away += s.area[at(i)] * s.direction[at(i)];
  if (away.norm() > 0) away.normalize();
  double part = 0.0;
  for (Eigen::Index d = 0; d < 3; ++d) {
    if (free[static_cast<std::size_t>(d)]) part += away[d] * force[d];
    if (free[static_cast<std::size_t>(d + 6)]) part -= away[d] * force[d + 6];
  }
  return part;
}

}  // namespace dea

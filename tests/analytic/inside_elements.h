// tests/analytic/inside_elements.h – stress and strain inside a bonded elastic layer of any profile under a given
// frictionless pressure, by linear finite elements. Shares nothing with src/.  mm, N, MPa.
#pragma once
#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/SparseCore>
#include <cmath>
#include <functional>
#include <vector>

#include "tests/analytic/eight_nodes.h"
#include "tests/analytic/inside_layer.h"
#include "tests/analytic/linear_systems.h"

namespace dea::analytic {

/// Plane strain or axisymmetric about x = 0: eight-node quadrilaterals between the base, which is held, and the top.
struct InsideElements {
  double E = 1, nu = 0.3;
  bool axisymmetric = false;
  std::function<Eigen::Vector2d(double, double)> position;  ///< of (s, zeta): zeta 0 the base, 1 the top
  std::function<double(double)> pressure;                   ///< of s, on the top, along its normal
  double length = 1;                                        ///< 0 <= s <= length
  bool mirror_first = true, mirror_last = true;             ///< else free; mirrors are planes x = const
  int along = 100, through = 16;
};

/// At the middles of the elements' columns, height j/through: x across, y hoop (along), z up in the frame of
/// `position`.
class SolvedElements {
 public:
  explicit SolvedElements(const InsideElements& in) : in_(in), m_(in.along), n_(in.through) {
    const int nodes = (2 * m_ + 1) * (2 * n_ + 1);
    const double M = in.E * (1 - in.nu) / ((1 + in.nu) * (1 - 2 * in.nu)), lambda = M * in.nu / (1 - in.nu);
    D_ << M, lambda, 0, lambda, lambda, M, 0, lambda, 0, 0, (M - lambda) / 2, 0, lambda, lambda, 0, M;
    std::vector<int> row(static_cast<std::size_t>(2 * nodes), -1);
    for (int ex = 0; ex < m_; ++ex)
      for (int ey = 0; ey < n_; ++ey)
        for (int a = 0; a < 8; ++a) {
          const auto [i, j] = lattice(ex, ey, a);
          const bool mirror = (i == 0 && in.mirror_first) || (i == 2 * m_ && in.mirror_last);
          row[static_cast<std::size_t>(2 * id(i, j))] = j > 0 && !mirror ? 0 : -1;
          row[static_cast<std::size_t>(2 * id(i, j) + 1)] = j > 0 ? 0 : -1;
        }
    int unknowns = 0;
    for (int& r : row)
      if (r == 0) r = unknowns++;
    Eigen::VectorXd force = Eigen::VectorXd::Zero(unknowns);
    std::vector<Eigen::Triplet<double>> entries;
    for (int ex = 0; ex < m_; ++ex)
      for (int ey = 0; ey < n_; ++ey) {
        const Eigen::Matrix<double, 8, 2> X = corners(ex, ey);
        Eigen::Matrix<double, 16, 16> K = Eigen::Matrix<double, 16, 16>::Zero();
        for (int p = 0; p < 3; ++p)
          for (int q = 0; q < 3; ++q) {
            double weight = 0;
            const Eigen::Matrix<double, 4, 16> B = strain_rows(X, kGauss[p], kGauss[q], weight);
            K += B.transpose() * D_ * B * (weight * kGaussWeight[p] * kGaussWeight[q]);
          }
        for (int a = 0; a < 16; ++a)
          for (int b = 0; b < 16; ++b) {
            const int r = row[dof(ex, ey, a)], c = row[dof(ex, ey, b)];
            if (r >= 0 && c >= 0) entries.emplace_back(r, c, K(a, b));
          }
        if (ey == n_ - 1) press(ex, X, row, force);
      }
    Eigen::SparseMatrix<double> K(unknowns, unknowns);
    K.setFromTriplets(entries.begin(), entries.end());
    const Eigen::VectorXd u = solve_symmetric(K, force);
    u_ = Eigen::VectorXd::Zero(2 * nodes);
    for (std::size_t i = 0; i < row.size(); ++i)
      if (row[i] >= 0) u_[static_cast<Eigen::Index>(i)] = u[row[i]];
  }

  double s(int column) const { return in_.length * (column + 0.5) / m_; }
  StressStrain at(int column, int height) const {
    StressStrain sum;
    int found = 0;
    for (const int ey : {height - 1, height}) {
      if (ey < 0 || ey >= n_) continue;
      sum = sum_of(sum, state(column, ey, 0, ey == height ? -1 : 1), 1);
      ++found;
    }
    sum.strain /= found;
    sum.stress /= found;
    return sum;
  }
  /// The mean over the column's width at the same heights, from the 2 x 2 points where these elements are best, along
  /// lines through them: for nu near 0.5, where stress elsewhere swings about the right one.
  StressStrain mean(int column, int height) const {
    const double best = 1 / std::sqrt(3.0);
    const int below = height > 0 ? height - 1 : 0, above = height < n_ ? height : n_ - 1;
    StressStrain sum;
    for (const int ey : {below, above})
      for (const double u : {-best, best})
        for (const double v : {-best, best})
          sum = sum_of(sum, state(column, ey, u, v), 0.125 * (1 + (ey == height ? -3 : 3) * v));
    return sum;
  }

 private:
  StressStrain state(int ex, int ey, double u, double v) const {
    double weight = 0;
    Eigen::Matrix<double, 16, 1> moved;
    for (int a = 0; a < 16; ++a) moved[a] = u_[static_cast<Eigen::Index>(dof(ex, ey, a))];
    const Eigen::Vector4d e = strain_rows(corners(ex, ey), u, v, weight) * moved;
    StressStrain found;
    found.strain = tensor(e, 0.5);
    found.stress = tensor(D_ * e, 1);
    return found;
  }
  static StressStrain sum_of(StressStrain a, const StressStrain& b, double share) {
    a.strain += share * b.strain;
    a.stress += share * b.stress;
    return a;
  }
  int id(int i, int j) const { return i + (2 * m_ + 1) * j; }
  static std::pair<int, int> lattice(int ex, int ey, int a) {
    return {2 * ex + 1 + static_cast<int>(kNodeX[a]), 2 * ey + 1 + static_cast<int>(kNodeY[a])};
  }
  std::size_t dof(int ex, int ey, int a) const {
    const auto [i, j] = lattice(ex, ey, a / 2);
    return static_cast<std::size_t>(2 * id(i, j) + a % 2);
  }
  Eigen::Matrix<double, 8, 2> corners(int ex, int ey) const {
    Eigen::Matrix<double, 8, 2> X;
    for (int a = 0; a < 8; ++a) {
      const auto [i, j] = lattice(ex, ey, a);
      X.row(a) = in_.position(in_.length * i / (2 * m_), 0.5 * j / n_).transpose();
    }
    return X;
  }
  /// Rows: xx, zz, xz (twice), hoop. `weight`: of the area (volume per radian).
  Eigen::Matrix<double, 4, 16> strain_rows(const Eigen::Matrix<double, 8, 2>& X, double u, double v,
                                           double& weight) const {
    const auto [N, dN] = eight_node_shape(u, v);
    const Eigen::Matrix2d J = dN.transpose() * X;
    const Eigen::Matrix<double, 8, 2> d = dN * J.inverse().transpose();
    const double radius = N.dot(X.col(0));
    Eigen::Matrix<double, 4, 16> B = Eigen::Matrix<double, 4, 16>::Zero();
    for (int a = 0; a < 8; ++a) {
      B(0, 2 * a) = B(2, 2 * a + 1) = d(a, 0);
      B(1, 2 * a + 1) = B(2, 2 * a) = d(a, 1);
      if (in_.axisymmetric) B(3, 2 * a) = N[a] / radius;
    }
    weight = J.determinant() * (in_.axisymmetric ? radius : 1.0);
    return B;
  }
  void press(int ex, const Eigen::Matrix<double, 8, 2>& X, const std::vector<int>& row, Eigen::VectorXd& force) const {
    for (int q = 0; q < 3; ++q) {
      const auto [N, dN] = eight_node_shape(kGauss[q], 1);
      const Eigen::Vector2d along = X.transpose() * dN.col(0);  // per u
      const double s = in_.length * (ex + 0.5 + 0.5 * kGauss[q]) / m_,
                   share = kGaussWeight[q] * in_.pressure(s) * (in_.axisymmetric ? N.dot(X.col(0)) : 1.0);
      const Eigen::Vector2d traction(along.y() * share, -along.x() * share);
      for (int a = 0; a < 16; ++a) {
        const int r = row[dof(ex, n_ - 1, a)];
        if (r >= 0) force[r] += N[a / 2] * traction[a % 2];
      }
    }
  }
  static Eigen::Matrix3d tensor(const Eigen::Vector4d& v, double shear) {
    Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
    m.diagonal() << v[0], v[3], v[1];
    m(0, 2) = m(2, 0) = shear * v[2];
    return m;
  }
  InsideElements in_;
  int m_, n_;
  Eigen::Matrix4d D_;
  Eigen::VectorXd u_;
};

}  // namespace dea::analytic

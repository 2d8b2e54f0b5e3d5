// tests/analytic/inside_layer.h – stress and strain inside a flat bonded elastic layer, by collocation through its
// depth and quadrature over wave numbers: shares nothing with src/.  mm, N, MPa.
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "tests/analytic/linear_systems.h"

namespace dea::analytic {

/// What p cos(kx) does at a height zeta (0: the base) of a layer with t = mu = p = 1: sigma_zz = -normal cos,
/// sigma_xz = shear sin, u_x = aside sin, u_z = -down cos.
struct WaveInside {
  double normal = 0, shear = 0, aside = 0, down = 0;
};

/// Navier's equations for u_x = U(z) sin(sx), u_z = W(z) cos(sx), lambda = 2 nu/(1 - 2 nu):
///     U'' - s^2 (lambda + 2) U - s (lambda + 1) W' = 0,   (lambda + 2) W'' - s^2 W + s (lambda + 1) U' = 0
/// at Chebyshev's points; U = W = 0 at the base, sigma_zz = -1 and no shear on top.
class LayerWave {
 public:
  LayerWave(double nu, double s) : s_(s), lambda_(2 * nu / (1 - 2 * nu)) {
    constexpr int n = kPoints;
    for (int i = 0; i < n; ++i) z_[i] = 0.5 * (1 - std::cos(kPi * i / (n - 1)));
    Eigen::MatrixXd D = Eigen::MatrixXd::Zero(n, n);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        if (i != j) {
          D(i, j) = weight(j) / weight(i) / (z_[i] - z_[j]);
          D(i, i) -= D(i, j);
        }
    const Eigen::MatrixXd D2 = D * D, one = Eigen::MatrixXd::Identity(n, n);
    Eigen::MatrixXd A(2 * n, 2 * n);
    A << D2 - s * s * (lambda_ + 2) * one, -s * (lambda_ + 1) * D, s * (lambda_ + 1) * D,
        (lambda_ + 2) * D2 - s * s * one;
    Eigen::VectorXd b = Eigen::VectorXd::Zero(2 * n);
    for (const int row : {0, n - 1, n, 2 * n - 1}) A.row(row).setZero();
    A(0, 0) = A(n, n) = 1;
    A.row(n - 1).head(n) = D.row(n - 1);  // shear
    A(n - 1, 2 * n - 1) = -s;
    A.row(2 * n - 1).tail(n) = (lambda_ + 2) * D.row(n - 1);
    A(2 * n - 1, n - 1) = lambda_ * s;
    b[2 * n - 1] = -1;
    const Eigen::VectorXd x = solve_dense(A, b);
    U_ = x.head(n);
    W_ = x.tail(n);
    dU_ = D * U_;
    dW_ = D * W_;
  }
  WaveInside at(double zeta) const {
    const double U = value(U_, zeta), W = value(W_, zeta), dU = value(dU_, zeta), dW = value(dW_, zeta);
    return {-(lambda_ * (s_ * U + dW) + 2 * dW), dU - s_ * W, U, -W};
  }

 private:
  static constexpr int kPoints = 48;
  static constexpr double kPi = 3.14159265358979323846;
  static double weight(int i) { return (i % 2 ? -1.0 : 1.0) * (i == 0 || i == kPoints - 1 ? 0.5 : 1.0); }
  double value(const Eigen::VectorXd& f, double zeta) const {
    double above = 0, below = 0;
    for (int i = 0; i < kPoints; ++i) {
      if (std::abs(zeta - z_[i]) < 1e-14) return f[i];
      above += weight(i) / (zeta - z_[i]) * f[i];
      below += weight(i) / (zeta - z_[i]);
    }
    return above / below;
  }
  double s_, lambda_, z_[kPoints];
  Eigen::VectorXd U_, W_, dU_, dW_;
};

/// Stress [MPa] and strain below a point of the surface: x radial (across the strip), y hoop (along), z up.
struct StressStrain {
  Eigen::Matrix3d stress = Eigen::Matrix3d::Zero(), strain = Eigen::Matrix3d::Zero();
};

/// A flat layer under even pressures on rings (strips on both sides of x = 0) of the width `step`.
struct InsidePressedLayer {
  double E = 1, nu = 0.3, thickness = 1;
  bool axisymmetric = true;
  double step = 0.1;
  std::vector<double> pressure;  ///< from the middle outwards

  /// Below the distances r from the middle.
  std::vector<StressStrain> at(double zeta, const std::vector<double>& r) const {
    const double t = thickness, mu = E / (2 * (1 + nu)), top = 40 / t,
                 reach = std::max(step * static_cast<double>(pressure.size()), r.empty() ? 0.0 : r.back());
    const int panels = static_cast<int>(std::ceil(top * reach / 1.5)) + 40;
    std::vector<Sums> sums(r.size());
    // of s^2 spread for short waves: what goes with the pressure of the place itself, for it does not decay
    const double local = zeta == 1 ? -(1 - 2 * nu) / 2 : 0.0;
    for (int i = 0; i < panels; ++i)
      for (int q = 0; q < 3; ++q) {
        const double u = (i + 0.5 + 0.5 * kX[q]) / panels, k = top * u * u, s = k * t,
                     dk = top * 2 * u * 0.5 * kWeight[q] / panels;
        const WaveInside wave = LayerWave(nu, s).at(zeta);
        const double share = transform(k) * dk * (axisymmetric ? k : 1 / kPi);
        for (std::size_t j = 0; j < r.size(); ++j) {
          const double even = axisymmetric ? std::cyl_bessel_j(0, k * r[j]) : std::cos(k * r[j]),
                       odd = axisymmetric ? std::cyl_bessel_j(1, k * r[j]) : std::sin(k * r[j]);
          sums[j].normal += share * wave.normal * even;
          sums[j].shear += share * wave.shear * odd;
          sums[j].area += share * (s * wave.aside - local) * even;
          sums[j].aside += share * wave.aside * odd;
        }
      }
    std::vector<StressStrain> out(r.size());
    for (std::size_t j = 0; j < r.size(); ++j) out[j] = state(sums[j], r[j], zeta, local, mu);
    return out;
  }

  /// Even pressures, linear between the rings' middles.
  double pressure_at(double r) const {
    const double u = r / step - 0.5;
    const int i = std::max(0, static_cast<int>(std::floor(u)));
    const auto value = [&](int k) {
      return k < static_cast<int>(pressure.size()) ? pressure[static_cast<std::size_t>(k)] : 0.0;
    };
    const double share = std::max(0.0, u - i);
    return (1 - share) * value(i) + share * value(i + 1);
  }

 private:
  static constexpr double kPi = 3.14159265358979323846;
  static constexpr double kX[3] = {-0.7745966692414834, 0, 0.7745966692414834},
                          kWeight[3] = {5.0 / 9, 8.0 / 9, 5.0 / 9};
  struct Sums {
    double normal = 0, shear = 0, area = 0, aside = 0;
  };
  /// Hankel's, or Fourier's over both halves.
  double transform(double k) const {
    double sum = 0, before = 0;
    for (std::size_t i = 0; i < pressure.size(); ++i) {
      const double edge = step * static_cast<double>(i + 1),
                   next = axisymmetric ? edge * std::cyl_bessel_j(1, k * edge) / k : 2 * std::sin(k * edge) / k;
      sum += pressure[i] * (next - before);
      before = next;
    }
    return sum;
  }
  StressStrain state(const Sums& sum, double r, double zeta, double local, double mu) const {
    // u_x of a wave is (p t/mu) aside sin(kx)
    const double t = thickness, lambda = 2 * mu * nu / (1 - 2 * nu), area = (sum.area + local * pressure_at(r)) / mu;
    double hoop = 0;
    if (axisymmetric) hoop = r > 1e-9 ? t / mu * sum.aside / r : area / 2;
    const double across = area - hoop, shear = sum.shear, normal = zeta == 1 ? -pressure_at(r) : -sum.normal,
                 up = (normal - lambda * area) / (lambda + 2 * mu);
    StressStrain s;
    s.strain.diagonal() << across, hoop, up;
    s.strain(0, 2) = s.strain(2, 0) = shear / (2 * mu);
    s.stress = 2 * mu * s.strain + lambda * (area + up) * Eigen::Matrix3d::Identity();
    return s;
  }
};

}  // namespace dea::analytic

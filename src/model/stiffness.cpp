#include "src/model/stiffness.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace dea {

namespace {

/// n n^T in the order of stresses; its product with a strain is the strain along n.
Vector6d along_itself(const Vector3d& n) {
  Vector6d s;
  s << n.x() * n.x(), n.y() * n.y(), n.z() * n.z(), n.x() * n.y(), n.y() * n.z(), n.x() * n.z();
  return s;
}

}  // namespace

Matrix6d isotropic_stiffness(double E, double nu) {
  const double G = E / (2 * (1 + nu)), lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
  Matrix6d D = Matrix6d::Zero();
  D.topLeftCorner<3, 3>().setConstant(lambda);
  D.diagonal() << lambda + 2 * G, lambda + 2 * G, lambda + 2 * G, G, G, G;
  return D;
}

std::optional<Eigen::Matrix3d> axes_from(const Vector3d& a, const Vector3d& d) {
  const Vector3d c = a.cross(d);
  if (!(c.norm() > 1e-9 * a.norm() * d.norm())) return std::nullopt;
  Eigen::Matrix3d Q;
  Q << a.normalized(), c.cross(a).normalized(), c.normalized();
  return Q;
}

double fibre_modulus(const Fibres& fibres, double strain) {
  const auto& c = fibres.c;
  const double stretch = 1 + std::max(0.0, strain);
  if (fibres.law == Fibres::Law::ExpLinear) return stretch < c[3] ? c[0] * c[1] * std::exp(c[1] * (stretch - 1)) : c[2];
  if (fibres.law != Fibres::Law::ExpPow) return 0.0;
  // x = L^2 - 1: tension 2 c2 (1 + x) x^(c1 - 1) exp(c0 x^c1), dx = 2 L dL
  const double x = stretch * stretch - 1, power = c[0] * std::pow(x, c[1]), e = std::exp(power);
  const double bent = c[1] == 1 && x == 0 ? c[0] : std::pow(x, c[1] - 2) * (c[1] * power + c[1] - 1);
  return 4 * stretch * c[2] * e * (std::pow(x, c[1] - 1) + (1 + x) * bent);
}

Matrix6d fibre_stiffness(double modulus, bool deviatoric, const Vector3d& along) {
  Vector6d s = along_itself(along);
  if (deviatoric) s.head<3>().array() -= 1.0 / 3;
  return modulus * s * s.transpose();
}

std::optional<Matrix6d> orthotropic_stiffness(const std::array<double, 3>& E, const std::array<double, 3>& G,
                                              const std::array<double, 3>& nu) {
  Matrix6d S = Matrix6d::Zero();
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (!(E[k] > 0) || !(G[k] > 0)) return std::nullopt;
    S(i, i) = 1 / E[k];
    const int j = (i + 1) % 3;
    S(i, j) = S(j, i) = -nu[k] / E[k];
    S(3 + i, 3 + i) = 1 / G[k];  // 12, 23, 31
  }
  if (Eigen::LLT<Matrix6d>(S).info() != Eigen::Success) return std::nullopt;
  return Matrix6d(S.inverse());
}

Matrix6d turned_stiffness(const Matrix6d& D, const Eigen::Matrix3d& Q) {
  constexpr int kPlace[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}};
  Matrix6d T;  // of stresses, from the axes
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 6; ++c) {
      const int i = kPlace[r][0], j = kPlace[r][1], k = kPlace[c][0], l = kPlace[c][1];
      T(r, c) = Q(i, k) * Q(j, l) + (k == l ? 0.0 : Q(i, l) * Q(j, k));
    }
  return T * D * T.transpose();
}

}  // namespace dea

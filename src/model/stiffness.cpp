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
  return lame_stiffness(E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu)));
}

Matrix6d lame_stiffness(double G, double lambda) {
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

namespace {

/// `v`, turned by the least turn that brings one unit vector to another; where they are opposite, FEBio turns nothing.
Vector3d turned(const Vector3d& v, const Vector3d& from, const Vector3d& to) {
  if (from.cross(to).isZero(0)) return v;
  return Eigen::Quaterniond::FromTwoVectors(from, to) * v;
}

/// From a centre, or from an axis through it, to a place; nothing: it lies there.
std::optional<Vector3d> outwards(const Vector3d& place, const Vector3d& center, const Vector3d* axis) {
  Vector3d out = place - center;
  if (axis != nullptr) out -= *axis * axis->dot(out);
  if (!(out.norm() > 0)) return std::nullopt;
  return Vector3d(out.normalized());
}

/// Slope of the tension of Fibres::Law::ExpPow.
double power_slope(double alpha, double beta, double ksi, double from, double stretch) {
  const double x = stretch * stretch - from * from;
  if (x < 0) return 0.0;
  // tension 2 ksi L^2 x^(beta - 1) exp(alpha x^beta), dx = 2 L dL
  const double power = alpha * std::pow(x, beta), e = std::exp(power);
  const double bent = beta == 1 && x == 0 ? alpha : std::pow(x, beta - 2) * (beta * power + beta - 1);
  return 4 * stretch * ksi * e * (std::pow(x, beta - 1) + stretch * stretch * bent);
}

/// Of Fibres::Law::ExpPowLinear: ksi of its toe, and b.
std::array<double, 2> toe_and_line(const std::array<double, 4>& c) {
  const double I = c[3] * c[3], x = I - 1, power = c[0] * std::pow(x, c[1]), q = c[1] - 1 + c[1] * power;
  const double unit = c[2] / (4 * std::pow(I, 1.5) * q);
  return {unit * std::pow(x, 2 - c[1]) * std::exp(-power), unit * (2 * I * (q + 0.5) - 1)};
}

}  // namespace

std::optional<Vector3d> direction_at(const Direction& direction, const Vector3d& place) {
  const Vector3d x = Vector3d::UnitX();
  switch (direction.by) {
    case Direction::By::Vector:
      return direction.vector;
    case Direction::By::Cylindrical:
      // FEBio turns x with the axis, and not the vector
      if (const auto out = outwards(place, direction.center, &direction.axis))
        return turned(direction.vector, turned(x, Vector3d::UnitZ(), direction.axis), *out);
      return std::nullopt;
    case Direction::By::Spherical:
      if (const auto out = outwards(place, direction.center, nullptr)) return turned(direction.vector, x, *out);
      return std::nullopt;
    case Direction::By::Nodes:
    case Direction::By::Element:
    case Direction::By::Unknown:
      break;
  }
  return std::nullopt;
}

std::optional<Eigen::Matrix3d> axes_at(const Axes& axes, const Vector3d& place) {
  constexpr double kAlong = 0.99;  // FEBio's
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  switch (axes.by) {
    case Axes::By::Vectors:
      return axes_from(axes.a, axes.d);
    case Axes::By::Cylindrical:  // here x is not turned with the axis, but d with the first axis
      if (const auto out = outwards(place, axes.center, &axes.axis)) {
        const Vector3d a = turned(axes.a, x, *out), d = turned(y, x, *out);
        return axes_from(a, std::abs(a.dot(d)) > kAlong ? turned(z, x, *out) : d);
      }
      return std::nullopt;
    case Axes::By::Spherical:  // d stays
      if (const auto out = outwards(place, axes.center, nullptr)) {
        const Vector3d a = turned(axes.a, x, *out);
        return axes_from(a, std::abs(a.dot(y)) > kAlong ? z : y);
      }
      return std::nullopt;
    case Axes::By::Nodes:
    case Axes::By::Element:
    case Axes::By::Unknown:
      break;
  }
  return std::nullopt;
}

double fibre_modulus(const Fibres& fibres, double strain) {
  const auto& c = fibres.c;
  const double stretch = 1 + std::max(0.0, strain);
  switch (fibres.law) {
    case Fibres::Law::ExpLinear:
      return fibres.share * (stretch < c[3] ? c[0] * c[1] * std::exp(c[1] * (stretch - 1)) : c[2]);
    case Fibres::Law::ExpPow:
      return fibres.share * power_slope(c[0], c[1], c[2], c[3], stretch);
    case Fibres::Law::ExpPowLinear: {
      const std::array<double, 2> of = toe_and_line(c);
      return fibres.share *
             (stretch < c[3] ? power_slope(c[0], c[1], of[0], 1.0, stretch) : 4 * of[1] * stretch - c[2]);
    }
    case Fibres::Law::Logarithmic:
      return stretch < c[3] ? 0.0 : fibres.share * c[0] / stretch;
    case Fibres::Law::Unknown:
      break;
  }
  return 0.0;
}

Matrix6d fibre_stiffness(double modulus, bool deviatoric, const Vector3d& along, double even) {
  Vector6d s = along_itself(along);
  s.head<3>().array() += deviatoric ? -1.0 / 3 : even;
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

Matrix6d deviatoric_stiffness(const Matrix6d& D) {
  Matrix6d P = Matrix6d::Identity();
  P.topLeftCorner<3, 3>().array() -= 1.0 / 3;
  return P * D * P;
}

Matrix6d trapped_fluid_stiffness(const Matrix6d& drained, double nu) {
  const double normal = drained.diagonal().head<3>().sum(), shear = drained.diagonal().tail<3>().sum(),
               K = drained.topLeftCorner<3, 3>().sum() / 9, across = (9 * K - normal) / 2,
               G = (normal - across + 3 * shear) / 15;
  Matrix6d D = Matrix6d::Zero();
  D.topLeftCorner<3, 3>().setConstant(2 * G * (1 + nu) / (3 * (1 - 2 * nu)) - K);
  return D;
}

Matrix6d spread_of(const std::function<double(const Vector3d&)>& density, bool in_plane, bool deviatoric) {
  const int circles = in_plane ? 1 : 200, around = 400;  // midpoints: errors of 1e-5, and less in the plane
  const double pi = std::acos(-1.0);
  Matrix6d sum = Matrix6d::Zero();
  double weight = 0;
  for (int i = 0; i < circles; ++i)
    for (int k = 0; k < around; ++k) {
      const double turn = 2 * pi * (k + 0.5) / around;
      Vector3d n(std::cos(turn), std::sin(turn), 0);
      double area = 1;
      if (!in_plane) {  // circles about the first axis, near which densities are steep
        const double from_axis = pi * (i + 0.5) / circles;
        area = std::sin(from_axis);
        n = Vector3d(std::cos(from_axis), area * n.x(), area * n.y());
      }
      const double here = area * density(n);
      weight += here;
      sum += here * fibre_stiffness(1.0, deviatoric, n);
    }
  return sum / weight;
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

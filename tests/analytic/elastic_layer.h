// tests/analytic/elastic_layer.h – frictionless contact with flat bonded elastic layers by quadrature of their exact
// response, and plane-strain finite elements: two ways to the same answers that share nothing with src/.  mm, N, MPa.
#pragma once
#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/SparseCore>
#include <cmath>
#include <functional>
#include <vector>

#include "tests/analytic/eight_nodes.h"
#include "tests/analytic/linear_systems.h"

namespace dea::analytic {

/// Exact surface compliance w/p [mm/MPa] of a flat layer of thickness t at the wave number k > 0: the classical
/// solution, written with exponentials so that it can be evaluated for any k.
inline double flat_layer(double E, double nu, double t, double k) {
  const double s = k * t, e = std::exp(-2 * s);
  return 2 * (1 - nu * nu) / (E * k) * ((3 - 4 * nu) * (1 - e * e) - 4 * s * e) /
         ((3 - 4 * nu) * (1 + e * e) + 2 * (2 * s * s + 5 - 12 * nu + 8 * nu * nu) * e);
}

/// What a rigid punch with the parabolic profile overlap(r) = depth - r^2/(2R) does to the layers.
struct PunchResult {
  double force = 0;              ///< of the sphere; per length, of the cylinder
  double peak = 0;               ///< pressure in the middle
  double radius = 0;             ///< of the contact, or half its width
  double step = 0;               ///< width of the rings (strips)
  std::vector<double> pressure;  ///< on each in contact, from the middle outwards
};

/// A parabolic punch on layers with the total compliance w(k), half-space like 2(1-nu^2)/(E k) = c/k for large k. The
/// pressure is constant on n rings (strips) up to `reach`; collocation at their middles. Of a ring's influence the
/// half-space's part is known in closed form; the rest decays exponentially in k and is integrated by Gauss' rule.
struct ParabolicPunch {
  std::function<double(double)> compliance;
  double half_space = 0;  ///< c
  double thickness = 1;   ///< scale of the decay: the thinnest layer
  double radius = 1;      ///< of the punch

  PunchResult sphere(double depth, double reach, int n = 160) const { return solve(depth, reach, n, true); }
  PunchResult cylinder(double depth, double reach, int n = 160) const { return solve(depth, reach, n, false); }

 private:
  /// Sinking at r under a unit pressure on a disk of radius b, on a half-space: 2(1-nu^2)/E = c.
  double disk(double r, double b) const {
    if (r <= b) return c() * 2 * b / kPi * std::comp_ellint_2(r / b);
    const double m = b / r;
    return c() * 2 * r / kPi * (std::comp_ellint_2(m) - (1 - m * m) * std::comp_ellint_1(m));
  }
  double c() const { return half_space; }
  /// Integral from 0 to x of ln(1 + a^2/y^2).
  static double log_integral(double x, double a) {
    if (x == 0) return 0;
    return x * std::log(1 + a * a / (x * x)) + 2 * a * std::atan(x / a);
  }

  PunchResult solve(double depth, double reach, int n, bool axisymmetric) const {
    const double h = reach / n, top = 24 / thickness, a = thickness;
    // the rest of the compliance at Gauss' points in k: panels narrow enough for the oscillations up to `reach`
    std::vector<double> ks, rest;
    const double x[5] = {-0.9061798459386640, -0.5384693101056831, 0, 0.5384693101056831, 0.9061798459386640},
                 w[5] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889, 0.4786286704993665,
                         0.2369268850561891};
    const int panels = static_cast<int>(std::ceil(top * reach / 2)) + 20;
    for (int i = 0; i < panels; ++i)
      for (int j = 0; j < 5; ++j) {
        const double k = top * (i + 0.5 + 0.5 * x[j]) / panels;
        // a strip's comparison function c (1 - exp(-k a))/k is finite at k = 0, as the layer's is
        const double known = axisymmetric ? c() / k : -c() * std::expm1(-k * a) / k;
        ks.push_back(k);
        rest.push_back((compliance(k) - known) * w[j] * 0.5 * top / panels);
      }
    Eigen::MatrixXd edge(ks.size(), n + 1), middle(ks.size(), n);
    for (int q = 0; q < static_cast<int>(ks.size()); ++q) {
      const double k = ks[static_cast<std::size_t>(q)];
      for (int i = 0; i <= n; ++i) {
        const double b = i * h;
        edge(q, i) = axisymmetric ? b * std::cyl_bessel_j(1, k * b) : 2 / kPi * std::sin(k * b) / k;
      }
      for (int i = 0; i < n; ++i)
        middle(q, i) = axisymmetric ? std::cyl_bessel_j(0, k * (i + 0.5) * h) : std::cos(k * (i + 0.5) * h);
    }
    const Eigen::VectorXd weight = Eigen::Map<Eigen::VectorXd>(rest.data(), static_cast<Eigen::Index>(rest.size()));
    const Eigen::MatrixXd smooth = middle.transpose() * weight.asDiagonal() * edge;
    Eigen::MatrixXd C(n, n);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const double r = (i + 0.5) * h, inner = j * h, outer = (j + 1) * h;
        double known;
        if (axisymmetric) {
          known = disk(r, outer) - (j > 0 ? disk(r, inner) : 0);
        } else {  // strips at both sides; the transform of (1 - exp(-ka))/k is ln(1 + a^2/x^2)/(2 pi)
          const auto integral = [&](double from, double to) { return log_signed(to, a) - log_signed(from, a); };
          known = c() / (2 * kPi) * (integral(inner - r, outer - r) + integral(inner + r, outer + r));
        }
        C(i, j) = known + smooth(i, j + 1) - smooth(i, j);
      }
    Eigen::VectorXd overlap(n);
    for (int i = 0; i < n; ++i) overlap[i] = depth - std::pow((i + 0.5) * h, 2) / (2 * radius);
    // contact is a disk: find how many rings
    int low = 1, high = n;
    Eigen::VectorXd p;
    const auto pressures = [&](int m) -> Eigen::VectorXd {
      return solve_dense(C.topLeftCorner(m, m), overlap.head(m));
    };
    while (high - low > 1) {  // the last ring must push, not pull
      const int m = (low + high) / 2;
      (pressures(m)[m - 1] > 0 ? low : high) = m;
    }
    p = pressures(low);
    PunchResult result;
    for (int i = 0; i < low; ++i) result.force += p[i] * (axisymmetric ? kPi * h * h * (2 * i + 1) : 2 * h);
    result.peak = (9 * p[0] - p[1]) / 8;  // even in r
    result.step = h;
    result.pressure.assign(p.data(), p.data() + low);
    // where sqrt-like or linear pressure ends, to within the ring: the zero of p between the last two rings' line
    const double slope = p[low - 2] - p[low - 1];
    result.radius = (low - 0.5) * h + (slope > 0 ? std::min(1.0, p[low - 1] / slope) : 0.5) * h;
    return result;
  }
  static double log_signed(double x, double a) { return x < 0 ? -log_integral(-x, a) : log_integral(x, a); }
  static constexpr double kPi = 3.14159265358979323846;
};

/// Plane strain of a layer with a curved or flat top over the base z = -t(x), 0 <= x <= length: quadrilaterals with
/// eight nodes, 3 x 3 Gauss points. The base is held; at x = 0 there is a mirror; the other end is free or a mirror.
/// `load`: vertical pressure on the top. Returns how far the top sinks at the corner nodes x = i length/m.
inline std::vector<double> plane_strain_layer(double E, double nu, double length,
                                              const std::function<double(double)>& thickness,
                                              const std::function<double(double)>& load, bool free_end, int m, int n) {
  // serendipity nodes on a (2m+1) x (2n+1) lattice without the centres
  const auto id = [&](int i, int j) { return i + (2 * m + 1) * j; };
  const int nodes = (2 * m + 1) * (2 * n + 1);
  const auto position = [&](int i, int j) {
    const double x = length * i / (2 * m);
    return Eigen::Vector2d(x, -thickness(x) * (1 - static_cast<double>(j) / (2 * n)));
  };
  std::vector<char> held(static_cast<std::size_t>(2 * nodes), 1);
  Eigen::Matrix3d D;
  const double M = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)), lambda = M * nu / (1 - nu);
  D << M, lambda, 0, lambda, M, 0, 0, 0, (M - lambda) / 2;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd force = Eigen::VectorXd::Zero(2 * nodes);
  for (int ex = 0; ex < m; ++ex)
    for (int ey = 0; ey < n; ++ey) {
      int node[8];
      Eigen::Matrix<double, 8, 2> X;
      for (int a = 0; a < 8; ++a) {
        const int i = 2 * ex + 1 + static_cast<int>(kNodeX[a]), j = 2 * ey + 1 + static_cast<int>(kNodeY[a]);
        node[a] = id(i, j);
        X.row(a) = position(i, j).transpose();
        for (int c = 0; c < 2; ++c)
          held[static_cast<std::size_t>(2 * node[a] + c)] = j == 0 || (c == 0 && (i == 0 || (!free_end && i == 2 * m)));
      }
      Eigen::Matrix<double, 16, 16> K = Eigen::Matrix<double, 16, 16>::Zero();
      for (int p = 0; p < 3; ++p)
        for (int q = 0; q < 3; ++q) {
          const Eigen::Matrix<double, 8, 2> dN = eight_node_shape(kGauss[p], kGauss[q]).dN;
          const Eigen::Matrix2d J = dN.transpose() * X;
          const Eigen::Matrix<double, 8, 2> d = dN * J.inverse().transpose();
          Eigen::Matrix<double, 3, 16> B = Eigen::Matrix<double, 3, 16>::Zero();
          for (int a = 0; a < 8; ++a) {
            B(0, 2 * a) = B(2, 2 * a + 1) = d(a, 0);
            B(1, 2 * a + 1) = B(2, 2 * a) = d(a, 1);
          }
          K += B.transpose() * D * B * (J.determinant() * kGaussWeight[p] * kGaussWeight[q]);
        }
      for (int a = 0; a < 16; ++a)
        for (int b = 0; b < 16; ++b) entries.emplace_back(2 * node[a / 2] + a % 2, 2 * node[b / 2] + b % 2, K(a, b));
      if (ey == n - 1)
        for (int q = 0; q < 3; ++q) {
          const double u = kGauss[q], half = 0.5 * length / m, p = load(length * (ex + 0.5 + 0.5 * u) / m);
          force[2 * id(2 * ex, 2 * n) + 1] -= kGaussWeight[q] * half * p * 0.5 * u * (u - 1);
          force[2 * id(2 * ex + 1, 2 * n) + 1] -= kGaussWeight[q] * half * p * (1 - u * u);
          force[2 * id(2 * ex + 2, 2 * n) + 1] -= kGaussWeight[q] * half * p * 0.5 * u * (u + 1);
        }
    }
  std::vector<Eigen::Triplet<double>> kept;
  for (const auto& e : entries)
    if (!held[static_cast<std::size_t>(e.row())] && !held[static_cast<std::size_t>(e.col())]) kept.push_back(e);
  for (int i = 0; i < 2 * nodes; ++i)
    if (held[static_cast<std::size_t>(i)]) {
      kept.emplace_back(i, i, 1.0);
      force[i] = 0;
    }
  Eigen::SparseMatrix<double> K(2 * nodes, 2 * nodes);
  K.setFromTriplets(kept.begin(), kept.end());
  const Eigen::VectorXd u = solve_symmetric(K, force);
  std::vector<double> sinking;
  for (int i = 0; i <= m; ++i) sinking.push_back(-u[2 * id(2 * i, 2 * n) + 1]);
  return sinking;
}

}  // namespace dea::analytic

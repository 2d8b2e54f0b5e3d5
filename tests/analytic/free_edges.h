// tests/analytic/free_edges.h – flat bonded elastic layers with free edges, straight or round, by linear finite
// elements: discs, rings around a hole, strips, of any thickness; how they sink under frictionless pressure and what
// force a rigid punch takes. Shares nothing with src/.  mm, N, MPa.
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

/// A layer with a flat top z = 0 over the rigid base z = -thickness(x) it is bonded to, ends[0] <= x <= ends.back().
/// Axisymmetric (x is the radius; a disc has ends[0] = 0) or plane strain. An end that is not free is a mirror; so is
/// the axis of a disc.
struct EdgedLayer {
  double E = 1, nu = 0.3;
  std::vector<double> ends;  ///< of the strips (rings) that carry even pressures, ascending: element edges
  std::function<double(double)> thickness;
  bool axisymmetric = false;
  bool free_first = false, free_last = true;
  /// Of the last end's wall: how much further the base reaches than the top, in thicknesses; < 0: an undercut.
  double wall_slope = 0;
  int through = 10;  ///< elements through the thickness
};

/// The layer as its strips know it.
struct StripCompliance {
  Eigen::MatrixXd sinking;  ///< (i, j): mean sinking of strip i under unit pressure on strip j [mm/MPa]
  Eigen::VectorXd area;     ///< of the strips [mm^2]; of a ring over 2 pi; per length in plane strain
  Eigen::VectorXd middle;   ///< their x
  Eigen::RowVectorXd way;  ///< of the last end's top: how far it moves outwards under unit pressure on strip j [mm/MPa]
};

/// Quadrilaterals with eight nodes, 3 x 3 Gauss points; one factorisation, a right side per strip.
inline StripCompliance strip_compliance(const EdgedLayer& layer) {
  const int m = static_cast<int>(layer.ends.size()) - 1, n = layer.through;
  const auto id = [&](int i, int j) { return i + (2 * m + 1) * j; };  // a lattice; the elements' centres are not used
  const int nodes = (2 * m + 1) * (2 * n + 1);
  const auto x_at = [&](int i) {
    const std::size_t k = static_cast<std::size_t>(i / 2);
    return i % 2 == 0 ? layer.ends[k] : 0.5 * (layer.ends[k] + layer.ends[k + 1]);
  };
  Eigen::Matrix4d D = Eigen::Matrix4d::Zero();  // of xx, zz, xz, hoop
  const double M = layer.E * (1 - layer.nu) / ((1 + layer.nu) * (1 - 2 * layer.nu)),
               lambda = M * layer.nu / (1 - layer.nu);
  D << M, lambda, 0, lambda, lambda, M, 0, lambda, 0, 0, (M - lambda) / 2, 0, lambda, lambda, 0, M;
  std::vector<char> free(static_cast<std::size_t>(2 * nodes), 0);
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd force = Eigen::MatrixXd::Zero(2 * nodes, m);
  StripCompliance result;
  result.area = Eigen::VectorXd::Zero(m);
  result.middle.resize(m);
  for (int ex = 0; ex < m; ++ex)
    for (int ey = 0; ey < n; ++ey) {
      int node[8];
      Eigen::Matrix<double, 8, 2> X;
      for (int a = 0; a < 8; ++a) {
        const int i = 2 * ex + 1 + static_cast<int>(kNodeX[a]), j = 2 * ey + 1 + static_cast<int>(kNodeY[a]);
        node[a] = id(i, j);
        const double depth = layer.thickness(x_at(i)) * (1 - static_cast<double>(j) / (2 * n)),
                     beside = std::max(0.0, 1 - (x_at(2 * m) - x_at(i)) / (3 * layer.thickness(x_at(2 * m))));
        X.row(a) << x_at(i) + depth * layer.wall_slope * beside * beside, -depth;
        const bool mirror = (i == 0 && !layer.free_first) || (i == 2 * m && !layer.free_last);
        free[static_cast<std::size_t>(2 * node[a])] = j > 0 && !mirror;
        free[static_cast<std::size_t>(2 * node[a] + 1)] = j > 0;
      }
      Eigen::Matrix<double, 16, 16> K = Eigen::Matrix<double, 16, 16>::Zero();
      for (int p = 0; p < 3; ++p)
        for (int q = 0; q < 3; ++q) {
          const auto [N, dN] = eight_node_shape(kGauss[p], kGauss[q]);
          const Eigen::Matrix2d J = dN.transpose() * X;
          const Eigen::Matrix<double, 8, 2> d = dN * J.inverse().transpose();
          const double radius = N.dot(X.col(0));
          Eigen::Matrix<double, 4, 16> B = Eigen::Matrix<double, 4, 16>::Zero();
          for (int a = 0; a < 8; ++a) {
            B(0, 2 * a) = B(2, 2 * a + 1) = d(a, 0);
            B(1, 2 * a + 1) = B(2, 2 * a) = d(a, 1);
            if (layer.axisymmetric) B(3, 2 * a) = N[a] / radius;
          }
          K += B.transpose() * D * B *
               (J.determinant() * kGaussWeight[p] * kGaussWeight[q] * (layer.axisymmetric ? radius : 1.0));
        }
      for (int a = 0; a < 16; ++a)
        for (int b = 0; b < 16; ++b) entries.emplace_back(2 * node[a / 2] + a % 2, 2 * node[b / 2] + b % 2, K(a, b));
    }
  for (int e = 0; e < m; ++e) {
    const double half = 0.5 * (x_at(2 * e + 2) - x_at(2 * e));
    result.middle[e] = x_at(2 * e + 1);
    for (int q = 0; q < 3; ++q) {
      const double u = kGauss[q],
                   share = kGaussWeight[q] * half * (layer.axisymmetric ? result.middle[e] + u * half : 1.0);
      force(2 * id(2 * e, 2 * n) + 1, e) -= share * 0.5 * u * (u - 1);
      force(2 * id(2 * e + 1, 2 * n) + 1, e) -= share * (1 - u * u);
      force(2 * id(2 * e + 2, 2 * n) + 1, e) -= share * 0.5 * u * (u + 1);
      result.area[e] += share;
    }
  }
  std::vector<int> row(free.size(), -1);
  int unknowns = 0;
  for (std::size_t i = 0; i < free.size(); ++i)
    if (free[i]) row[i] = unknowns++;
  std::vector<Eigen::Triplet<double>> kept;
  for (const auto& e : entries)
    if (row[static_cast<std::size_t>(e.row())] >= 0 && row[static_cast<std::size_t>(e.col())] >= 0)
      kept.emplace_back(row[static_cast<std::size_t>(e.row())], row[static_cast<std::size_t>(e.col())], e.value());
  Eigen::SparseMatrix<double> K(unknowns, unknowns);
  K.setFromTriplets(kept.begin(), kept.end());
  Eigen::MatrixXd right(unknowns, m);
  for (std::size_t i = 0; i < free.size(); ++i)
    if (row[i] >= 0) right.row(row[i]) = force.row(static_cast<Eigen::Index>(i));
  const Eigen::MatrixXd u = solve_symmetric(K, right);
  const int top = row[static_cast<std::size_t>(2 * id(2 * m, 2 * n))];
  result.way = top < 0 ? Eigen::RowVectorXd::Zero(m) : Eigen::RowVectorXd(u.row(top));
  result.sinking = result.area.cwiseInverse().asDiagonal() * (right.transpose() * u);
  return result;
}

/// Pressures [MPa] on the strips under a rigid frictionless punch: sinking = overlap where p > 0, >= overlap where
/// p = 0. overlap(x) [mm], negative where the undeformed surfaces are apart.
inline Eigen::VectorXd rigid_punch(const StripCompliance& layer, const std::function<double(double)>& overlap) {
  const Eigen::Index m = layer.area.size();
  Eigen::VectorXd p = Eigen::VectorXd::Zero(m), depth(m);
  std::vector<char> touches(static_cast<std::size_t>(m));
  for (Eigen::Index i = 0; i < m; ++i) {
    depth[i] = overlap(layer.middle[i]);
    touches[static_cast<std::size_t>(i)] = depth[i] > 0;
  }
  for (int pass = 0; pass < 100; ++pass) {
    std::vector<int> on;
    for (Eigen::Index i = 0; i < m; ++i)
      if (touches[static_cast<std::size_t>(i)]) on.push_back(static_cast<int>(i));
    p.setZero();
    const Eigen::MatrixXd C = layer.sinking(on, on);
    const Eigen::VectorXd needed = depth(on), pressures = solve_dense(C, needed);
    p(on) = pressures;
    const Eigen::VectorXd missing = depth - layer.sinking * p;
    bool same = true;
    for (Eigen::Index i = 0; i < m; ++i) {
      char& touch = touches[static_cast<std::size_t>(i)];
      const char now = touch ? p[i] > 0 : missing[i] > 1e-12 * depth.maxCoeff();
      same = same && now == touch;
      touch = now;
    }
    if (same) break;
  }
  return p;
}

}  // namespace dea::analytic

// tests/analytic/axisymmetric_contact.h – elastic bodies of revolution in frictionless contact with each other,
// with a rigid ball, by linear finite elements of their own. Shares nothing with src/.  mm, N, MPa.
#pragma once
#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/SparseCore>
#include <array>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "tests/analytic/eight_nodes.h"
#include "tests/analytic/linear_systems.h"

namespace dea::analytic {

inline constexpr double kTwoPi = 6.283185307179586;

/// Quadrilaterals with eight nodes in (r, z), `along` x `through`. The axis, if the body reaches it, is held; so is its
/// lower side, if it is `bonded`; else nothing holds it along z, and forces on it must balance.
class BodyOfRevolution {
 public:
  using Place = std::function<Eigen::Vector2d(double, double)>;  ///< (r, z) of (s, zeta) in [0, 1]^2; zeta 0: below
  /// D: stresses rr, hoop, zz, rz per strain.
  BodyOfRevolution(Place place, int along, int through, const Eigen::Matrix4d& D, bool bonded)
      : place_(std::move(place)), m_(along), n_(through), D_(D), bonded_(bonded) {}

  int size() const { return 2 * (2 * m_ + 1) * (2 * n_ + 1); }
  bool bonded() const { return bonded_; }
  /// Where node i of 2 along + 1 lies in the lower or the upper side.
  Eigen::Vector2d node(int i, bool upper) const { return lattice(i, upper ? 2 * n_ : 0); }
  int component(int i, bool upper, int k) const { return 2 * id(i, upper ? 2 * n_ : 0) + k; }

  /// Calls use(node, N, weight, x) at each point of integration of edge e of a side; the weights add up to its area.
  template <class Use>
  void along_edge(int e, bool upper, const Use& use) const {
    for (int q = 0; q < 3; ++q) {
      const double u = kGauss[q];
      const std::array<double, 3> N = {0.5 * u * (u - 1), 1 - u * u, 0.5 * u * (u + 1)},
                                  dN = {u - 0.5, -2 * u, u + 0.5};
      Eigen::Vector2d x = Eigen::Vector2d::Zero(), t = x;
      for (std::size_t a = 0; a < 3; ++a) {
        x += N[a] * node(2 * e + static_cast<int>(a), upper);
        t += dN[a] * node(2 * e + static_cast<int>(a), upper);
      }
      use(N, kTwoPi * x[0] * t.norm() * kGaussWeight[q], x);
    }
  }

  /// u of K u = f, column by column. Of what nothing holds along z one component is held.
  Eigen::MatrixXd displacements(const Eigen::MatrixXd& force) const {
    std::vector<int> row(static_cast<std::size_t>(size()), -1);
    int unknowns = 0;
    for (int j = 0; j <= 2 * n_; ++j)
      for (int i = 0; i <= 2 * m_; ++i)
        for (int k = 0; k < 2 && (i % 2 == 0 || j % 2 == 0) && !(bonded_ && j == 0); ++k)
          if (!(k == 0 && lattice(i, j)[0] < 1e-12) && !(k == 1 && !bonded_ && i == 0 && j == 0))
            row[static_cast<std::size_t>(2 * id(i, j) + k)] = unknowns++;
    std::vector<Eigen::Triplet<double>> entries;
    for (int ex = 0; ex < m_; ++ex)
      for (int ey = 0; ey < n_; ++ey) {
        int dof[16];
        Eigen::Matrix<double, 8, 2> X;
        for (int a = 0; a < 8; ++a) {
          const int i = 2 * ex + 1 + static_cast<int>(kNodeX[a]), j = 2 * ey + 1 + static_cast<int>(kNodeY[a]);
          X.row(a) = lattice(i, j).transpose();
          for (int k = 0; k < 2; ++k) dof[2 * a + k] = row[static_cast<std::size_t>(2 * id(i, j) + k)];
        }
        Eigen::Matrix<double, 16, 16> K = Eigen::Matrix<double, 16, 16>::Zero();
        for (int p = 0; p < 3; ++p)
          for (int q = 0; q < 3; ++q) {
            const Shape s = eight_node_shape(kGauss[p], kGauss[q]);
            const Eigen::Matrix2d J = s.dN.transpose() * X;
            const Eigen::Matrix<double, 8, 2> d = s.dN * J.inverse().transpose();
            const double r = s.N.dot(X.col(0));
            Eigen::Matrix<double, 4, 16> B = Eigen::Matrix<double, 4, 16>::Zero();
            for (int a = 0; a < 8; ++a) {
              B(0, 2 * a) = B(3, 2 * a + 1) = d(a, 0);
              B(2, 2 * a + 1) = B(3, 2 * a) = d(a, 1);
              B(1, 2 * a) = s.N[a] / r;
            }
            K += B.transpose() * D_ * B * (kTwoPi * r * J.determinant() * kGaussWeight[p] * kGaussWeight[q]);
          }
        for (int a = 0; a < 16; ++a)
          for (int b = 0; b < 16; ++b)
            if (dof[a] >= 0 && dof[b] >= 0) entries.emplace_back(dof[a], dof[b], K(a, b));
      }
    Eigen::SparseMatrix<double> K(unknowns, unknowns);
    K.setFromTriplets(entries.begin(), entries.end());
    Eigen::MatrixXd f(unknowns, force.cols()), u = Eigen::MatrixXd::Zero(size(), force.cols());
    for (int i = 0; i < size(); ++i)
      if (const int r = row[static_cast<std::size_t>(i)]; r >= 0) f.row(r) = force.row(i);
    const Eigen::MatrixXd x = solve_symmetric(K, f);
    for (int i = 0; i < size(); ++i)
      if (const int r = row[static_cast<std::size_t>(i)]; r >= 0) u.row(i) = x.row(r);
    return u;
  }

 private:
  int id(int i, int j) const { return i + (2 * m_ + 1) * j; }
  Eigen::Vector2d lattice(int i, int j) const { return place_(0.5 * i / m_, 0.5 * j / n_); }
  Place place_;
  int m_, n_;
  Eigen::Matrix4d D_;
  bool bonded_;
};

/// One edge of a body's side that may be pressed, by a rigid ball or by an edge of another body with the same r.
struct Edge {
  int body = 0, edge = 0;
  bool upper = true;
  int other = -1, other_edge = 0;  ///< its lower side lies on this one's upper side; -1: the ball presses
};

struct EdgesPressed {
  std::vector<double> pressure, area, radius;  ///< per edge
  std::vector<Eigen::VectorXd> motion;         ///< per body: r and z of its nodes
};

/// Pressures, one per edge, so that no mean gap over an edge is negative, none pulls, and each gap or pressure is zero.
/// The ball of radius R has its centre at (0, z). Bodies that nothing holds find their height.
inline EdgesPressed press_edges(const std::vector<BodyOfRevolution>& bodies, const std::vector<Edge>& edges, double R,
                                double z) {
  const auto n = static_cast<Eigen::Index>(edges.size());
  const Eigen::Vector2d center(0, z);
  std::vector<Eigen::MatrixXd> N;  // forces on the bodies' nodes per pressure
  for (const BodyOfRevolution& b : bodies) N.emplace_back(Eigen::MatrixXd::Zero(b.size(), n));
  EdgesPressed found;
  Eigen::VectorXd gap = Eigen::VectorXd::Zero(n);  // times area
  for (Eigen::Index k = 0; k < n; ++k) {
    const Edge& e = edges[static_cast<std::size_t>(k)];
    const auto add = [&](int body, int edge, bool upper, double gap_sign, bool by_ball) {
      const auto b = static_cast<std::size_t>(body);
      double area = 0, moment = 0;
      bodies[b].along_edge(edge, upper,
                           [&](const std::array<double, 3>& shape, double weight, const Eigen::Vector2d& x) {
                             const Eigen::Vector2d away =
                                 by_ball ? Eigen::Vector2d((x - center).normalized()) : Eigen::Vector2d(0, gap_sign);
                             gap[k] += weight * (by_ball ? (x - center).norm() - R : gap_sign * x[1]);
                             area += weight;
                             moment += weight * x[0];
                             for (int a = 0; a < 3; ++a)
                               for (int c = 0; c < 2; ++c)
                                 N[b](bodies[b].component(2 * edge + a, upper, c), k) +=
                                     weight * shape[static_cast<std::size_t>(a)] * away[c];
                           });
      return std::pair(area, moment / area);
    };
    const std::pair<double, double> of = add(e.body, e.edge, e.upper, -1, e.other < 0);
    if (e.other >= 0) add(e.other, e.other_edge, false, 1, false);
    found.area.push_back(of.first);
    found.radius.push_back(of.second);
  }
  // unknowns: pressures, heights of the bodies that are free
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(n, n), lift(n, 0);
  std::vector<Eigen::MatrixXd> u;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    u.push_back(bodies[b].displacements(N[b]));
    C += N[b].transpose() * u[b];
    if (bodies[b].bonded()) continue;
    lift.conservativeResize(n, lift.cols() + 1);
    lift.col(lift.cols() - 1).setZero();
    for (int i = 1; i < bodies[b].size(); i += 2) lift.col(lift.cols() - 1) += N[b].row(i).transpose();
  }
  std::vector<char> pressed(edges.size(), 0);
  for (Eigen::Index k = 0; k < n; ++k)
    pressed[static_cast<std::size_t>(k)] = gap[k] < 1e-3 * found.area[static_cast<std::size_t>(k)];
  Eigen::VectorXd p, height;
  for (int step = 0; step < 100; ++step) {
    std::vector<Eigen::Index> on;
    for (Eigen::Index k = 0; k < n; ++k)
      if (pressed[static_cast<std::size_t>(k)]) on.push_back(k);
    const auto a = static_cast<Eigen::Index>(on.size()), h = lift.cols();
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(a + h, a + h);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(a + h);
    for (Eigen::Index i = 0; i < a; ++i) {
      for (Eigen::Index j = 0; j < a; ++j)
        A(i, j) = C(on[static_cast<std::size_t>(i)], on[static_cast<std::size_t>(j)]);
      A.row(i).tail(h) = lift.row(on[static_cast<std::size_t>(i)]);
      A.col(i).tail(h) = A.row(i).tail(h).transpose();
      b[i] = -gap[on[static_cast<std::size_t>(i)]];
    }
    const Eigen::VectorXd x = solve_dense(A, b);
    p = Eigen::VectorXd::Zero(n);
    for (Eigen::Index i = 0; i < a; ++i) p[on[static_cast<std::size_t>(i)]] = x[i];
    height = x.tail(h);
    const Eigen::VectorXd left = gap + C * p + lift * height;
    bool same = true;
    for (Eigen::Index k = 0; k < n; ++k) {
      char& is = pressed[static_cast<std::size_t>(k)];
      const char next = is ? p[k] > 0 : left[k] < -1e-12;
      same = same && next == is;
      is = next;
    }
    if (same) break;
  }
  found.pressure.assign(p.data(), p.data() + n);
  for (std::size_t b = 0, free = 0; b < bodies.size(); ++b) {
    found.motion.emplace_back(u[b] * p);
    if (bodies[b].bonded()) continue;
    for (int i = 1; i < bodies[b].size(); i += 2) found.motion[b][i] += height[static_cast<Eigen::Index>(free)];
    ++free;
  }
  return found;
}

}  // namespace dea::analytic

// tests/analytic/neo_hookean_layer.h – large-strain finite elements for layers bonded to rigid bone and pressed
// together without friction: the answers for large strain, sharing nothing with src/.  mm, N, MPa.
//
// Axisymmetric (about x = 0, z upwards) or plane strain (mirror at x = 0; everything per length, both halves counted).
// Solid: FEBio's compressible neo-Hookean, W = mu/2 (I1 - 3) - mu ln J + lambda/2 (ln J)^2, total Lagrangian.
// Quadrilaterals with eight nodes and 2 x 2 points: 4 volume constraints on the 6 unknowns an element brings, so that
// nothing locks at nu = 0.499 (3 x 3 points are 9 on 6); its one spurious mode does not pass from element to element.
#pragma once
#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "tests/analytic/linear_systems.h"

namespace dea::analytic {

/// A layer of even thickness on a rigid base.
struct NeoHookeanLayer {
  double E = 10;
  double nu = 0.45;
  double thickness = 2;
  double curvature = 0;  ///< 1/radius of the layer's outer surface; > 0 convex (cartilage on a ball), < 0 a socket
};

/// Columns of elements along the surface: `fine` equal ones up to `fine_length`, `coarse` growing ones up to `length`.
struct LayerGrid {
  double fine_length = 8, length = 20;
  int fine = 48, coarse = 16, through = 8;
};

/// Pressed to a prescribed depth.
struct PressedLayer {
  double depth = 0;         ///< how far the rigid bodies approached each other since first touch [mm]
  double force = 0;         ///< [N]; plane strain [N/mm]
  double peak_cauchy = 0;   ///< pressure in the middle per deformed area [MPa]
  double peak_nominal = 0;  ///< per undeformed area
  double radius = 0;        ///< of contact, deformed: half way from the last node that pushes to the next
};

/// Quadratic elements of one or two layers; unknowns are the positions of the nodes.
class NeoHookeanSolid {
 public:
  explicit NeoHookeanSolid(bool axisymmetric) : axisymmetric_(axisymmetric) {}

  /// Adds a layer whose outer surface touches z = 0 at x = 0 from below, or, `upside_down`, from above. Returns the
  /// surface's nodes from the middle outwards, corners and midsides in turn.
  std::vector<int> add(const NeoHookeanLayer& layer, const LayerGrid& grid, bool upside_down = false) {
    std::vector<double> xs{0};
    for (int i = 1; i <= grid.fine; ++i) xs.push_back(grid.fine_length * i / grid.fine);
    const double first = grid.fine_length / grid.fine, rest = grid.length - grid.fine_length;
    double low = 1, high = 4;  // the growth that fills the rest
    for (int i = 0; i < 100; ++i) {
      const double g = 0.5 * (low + high);
      double sum = 0, h = first;
      for (int j = 0; j < grid.coarse; ++j) sum += h *= g;
      (sum > rest ? high : low) = g;
    }
    double h = first;
    for (int i = 0; i < grid.coarse; ++i) xs.push_back(xs.back() + (h *= low));
    const int m = static_cast<int>(xs.size()) - 1, n = grid.through;
    std::vector<int> id(static_cast<std::size_t>((2 * m + 1) * (2 * n + 1)), -1);
    const auto at = [&](int i, int j) -> int& { return id[static_cast<std::size_t>(i + (2 * m + 1) * j)]; };
    for (int i = 0; i <= 2 * m; ++i)
      for (int j = 0; j <= 2 * n; ++j) {
        if (i % 2 == 1 && j % 2 == 1) continue;
        const std::size_t c = static_cast<std::size_t>(i / 2);
        const double s = i % 2 == 0 ? xs[c] : 0.5 * (xs[c] + xs[c + 1]), k = layer.curvature, a = s * k;
        const double below = layer.thickness * (1 - 0.5 * j / n);
        const Eigen::Vector2d surface =
            k == 0 ? Eigen::Vector2d(s, 0) : Eigen::Vector2d(std::sin(a) / k, (std::cos(a) - 1) / k);
        Eigen::Vector2d x = surface - below * Eigen::Vector2d(std::sin(a), std::cos(a));
        if (upside_down) x.y() = -x.y();
        at(i, j) = static_cast<int>(reference_.size());
        reference_.push_back(x);
        held_x_.push_back(i == 0 || j == 0);
        held_z_.push_back(j == 0);
        upper_.push_back(upside_down);
      }
    const double M = layer.E * (1 - layer.nu) / ((1 + layer.nu) * (1 - 2 * layer.nu)),
                 mu = layer.E / (2 * (1 + layer.nu));
    for (int i = 0; i < m; ++i)
      for (int j = 0; j < n; ++j) {
        Element e;
        for (int a = 0; a < 8; ++a)
          e.node[a] = at(2 * i + 1 + static_cast<int>(kX[a]), 2 * j + 1 + static_cast<int>(kY[a]));
        e.mu = mu;
        e.lambda = M - 2 * mu;
        elements_.push_back(e);
      }
    std::vector<int> surface;
    for (int i = 0; i <= 2 * m; ++i) surface.push_back(at(i, 2 * n));
    position = reference_;
    return surface;
  }

  /// Elastic forces, two per node, and their derivative (all unknowns, held ones too).
  void assemble(Eigen::VectorXd& force, std::vector<Eigen::Triplet<double>>& stiffness) const {
    force.setZero(2 * static_cast<Eigen::Index>(position.size()));
    stiffness.clear();
    stiffness.reserve(elements_.size() * 256);
    const double g = 1 / std::sqrt(3.0);
    for (const Element& e : elements_) {
      Eigen::Matrix<double, 8, 2> X, x;
      for (int a = 0; a < 8; ++a) {
        X.row(a) = reference_[static_cast<std::size_t>(e.node[a])];
        x.row(a) = position[static_cast<std::size_t>(e.node[a])];
      }
      Eigen::Matrix<double, 16, 16> K = Eigen::Matrix<double, 16, 16>::Zero();
      Eigen::Matrix<double, 16, 1> f = Eigen::Matrix<double, 16, 1>::Zero();
      for (int q = 0; q < 4; ++q) {
        Eigen::Matrix<double, 8, 1> N;
        Eigen::Matrix<double, 8, 2> dN;
        shape(q % 2 ? g : -g, q / 2 ? g : -g, N, dN);
        const Eigen::Matrix2d J0 = dN.transpose() * X;
        const Eigen::Matrix<double, 8, 2> d = dN * J0.inverse().transpose();
        const double r0 = N.dot(X.col(0)), r = N.dot(x.col(0));
        const double weight = std::abs(J0.determinant()) * (axisymmetric_ ? 2 * kPi * r0 : 2);
        const Eigen::Matrix2d F = x.transpose() * d, inverse = F.inverse();  // inverse(J, i)
        const double hoop = axisymmetric_ ? r / r0 : 1, det = F.determinant() * hoop;
        if (!(F.determinant() > 0 && hoop > 0)) throw std::runtime_error("neo_hookean_layer: an element turned over");
        const double pressure = e.lambda * std::log(det) - e.mu;  // first Piola: mu F + pressure F^-T
        const Eigen::Matrix2d P = e.mu * F + pressure * inverse.transpose();
        const Eigen::Matrix<double, 8, 2> b = d * inverse;  // gradients on the deformed body
        // of det's logarithm: b, and N/r for the hoop
        Eigen::Matrix<double, 16, 1> volume;
        for (int a = 0; a < 8; ++a) {
          volume[2 * a] = b(a, 0) + (axisymmetric_ ? N[a] / r : 0);
          volume[2 * a + 1] = b(a, 1);
        }
        const Eigen::Matrix<double, 8, 2> inner = d * P.transpose();
        for (int a = 0; a < 8; ++a) {
          f[2 * a] += weight * inner(a, 0);
          f[2 * a + 1] += weight * inner(a, 1);
          if (axisymmetric_) f[2 * a] += weight * (e.mu * hoop + pressure / hoop) * N[a] / r0;
        }
        K += weight * e.lambda * volume * volume.transpose();
        const Eigen::Matrix<double, 8, 8> same = weight * e.mu * d * d.transpose();
        for (int a = 0; a < 8; ++a)
          for (int c = 0; c < 8; ++c) {
            K(2 * a, 2 * c) += same(a, c);
            K(2 * a + 1, 2 * c + 1) += same(a, c);
            for (int i = 0; i < 2; ++i)
              for (int k = 0; k < 2; ++k) K(2 * a + i, 2 * c + k) -= weight * pressure * b(a, k) * b(c, i);
            if (axisymmetric_) K(2 * a, 2 * c) += weight * N[a] * N[c] / (r0 * r0) * (e.mu - pressure / (hoop * hoop));
          }
      }
      for (int a = 0; a < 16; ++a) {
        const int row = 2 * e.node[a / 2] + a % 2;
        force[row] += f[a];
        for (int c = 0; c < 16; ++c) stiffness.emplace_back(row, 2 * e.node[c / 2] + c % 2, K(a, c));
      }
    }
  }

  /// Lowers the base of the upper layer.
  void lower(double by) {
    for (std::size_t i = 0; i < position.size(); ++i)
      if (upper_[i]) position[i].y() -= by;
  }

  /// The pressure p_0 + p_2 x^2 + p_4 x^4 in the middle that gives these vertical forces on the surface's nodes, over
  /// the part of the contact within x < `within`; per deformed area or, `nominal`, per undeformed.
  double peak(const std::vector<int>& surface, const Eigen::VectorXd& force, double within, bool nominal) const {
    const std::vector<Eigen::Vector2d>& at = nominal ? reference_ : position;
    std::size_t edges = 2;
    while (2 * edges + 3 < surface.size() && at[static_cast<std::size_t>(surface[2 * edges + 2])].x() < within) ++edges;
    const Eigen::Index nodes = static_cast<Eigen::Index>(2 * edges);  // the last corner has a neighbour outside
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(nodes + 1, 3);
    Eigen::VectorXd f(nodes);
    for (std::size_t e = 0; e < edges; ++e) {
      double x[3];
      for (std::size_t a = 0; a < 3; ++a) x[a] = at[static_cast<std::size_t>(surface[2 * e + a])].x();
      const double g[3] = {-std::sqrt(0.6), 0, std::sqrt(0.6)}, w[3] = {5.0 / 9, 8.0 / 9, 5.0 / 9};
      for (int q = 0; q < 3; ++q) {
        const double u = g[q], N[3] = {0.5 * u * (u - 1), 1 - u * u, 0.5 * u * (u + 1)};
        const double r = N[0] * x[0] + N[1] * x[1] + N[2] * x[2];
        const double area =
            w[q] * ((u - 0.5) * x[0] - 2 * u * x[1] + (u + 0.5) * x[2]) * (axisymmetric_ ? 2 * kPi * r : 2);
        for (int a = 0; a < 3; ++a)
          for (int k = 0; k < 3; ++k)
            A(static_cast<Eigen::Index>(2 * e) + a, k) += N[a] * area * std::pow(r / within, 2 * k);
      }
    }
    for (Eigen::Index i = 0; i < nodes; ++i) f[i] = force[2 * surface[static_cast<std::size_t>(i)] + 1];
    return std::abs(least_squares(A.topRows(nodes), f)[0]);
  }

  bool held(int unknown) const {
    return unknown % 2 == 0 ? held_x_[static_cast<std::size_t>(unknown / 2)]
                            : held_z_[static_cast<std::size_t>(unknown / 2)];
  }
  bool upper(int node) const { return upper_[static_cast<std::size_t>(node)]; }
  bool axisymmetric() const { return axisymmetric_; }

  std::vector<Eigen::Vector2d> position;

 private:
  struct Element {
    int node[8];
    double mu, lambda;
  };
  static constexpr double kPi = 3.14159265358979323846;
  static constexpr double kX[8] = {-1, 1, 1, -1, 0, 1, 0, -1}, kY[8] = {-1, -1, 1, 1, -1, 0, 1, 0};

  static void shape(double u, double v, Eigen::Matrix<double, 8, 1>& N, Eigen::Matrix<double, 8, 2>& dN) {
    for (int a = 0; a < 8; ++a) {
      const double x = kX[a], y = kY[a];
      if (x != 0 && y != 0) {
        N[a] = 0.25 * (1 + u * x) * (1 + v * y) * (u * x + v * y - 1);
        dN(a, 0) = 0.25 * x * (1 + v * y) * (2 * u * x + v * y);
        dN(a, 1) = 0.25 * y * (1 + u * x) * (2 * v * y + u * x);
      } else if (x == 0) {
        N[a] = 0.5 * (1 - u * u) * (1 + v * y);
        dN(a, 0) = -u * (1 + v * y);
        dN(a, 1) = 0.5 * y * (1 - u * u);
      } else {
        N[a] = 0.5 * (1 + u * x) * (1 - v * v);
        dN(a, 0) = 0.5 * x * (1 - v * v);
        dN(a, 1) = -v * (1 + u * x);
      }
    }
  }

  bool axisymmetric_;
  std::vector<Eigen::Vector2d> reference_;
  std::vector<char> held_x_, held_z_, upper_;
  std::vector<Element> elements_;
};

/// A rigid sphere (cylinder) of radius 1/`punch_curvature`, or a rigid flat for 0, is pressed into the layer to each of
/// `depths` (increasing). Nodes in contact are held on the punch's surface and slide along it; contact is what is
/// within some radius: the node outside that gets in is added, the last one that would pull is let go.
inline std::vector<PressedLayer> press_rigid(bool axisymmetric, const NeoHookeanLayer& layer, double punch_curvature,
                                             const std::vector<double>& depths, const LayerGrid& grid,
                                             double step = 0.02) {
  NeoHookeanSolid solid(axisymmetric);
  const std::vector<int> surface = solid.add(layer, grid);
  const Eigen::Index size = 2 * static_cast<Eigen::Index>(solid.position.size());
  const double k = punch_curvature;
  double tip = 0;
  // outwards from the punch, and how deep in it a point is
  const auto normal = [&](const Eigen::Vector2d& x) -> Eigen::Vector2d {
    if (k == 0) return {0, -1};
    return (x - Eigen::Vector2d(0, tip + 1 / k)).normalized();
  };
  const auto inside = [&](const Eigen::Vector2d& x) {
    return k == 0 ? x.y() - tip : 1 / k - (x - Eigen::Vector2d(0, tip + 1 / k)).norm();
  };
  const auto point = [&](std::size_t i) -> Eigen::Vector2d& {
    return solid.position[static_cast<std::size_t>(surface[i])];
  };
  // what rounding leaves of the forces near nu = 0.5
  const double rounding = 1e-12 * layer.E * layer.thickness * layer.thickness / (1 - 2 * layer.nu);
  std::size_t touching = 1;
  Eigen::VectorXd force;
  std::vector<Eigen::Triplet<double>> all, kept;
  std::vector<PressedLayer> results;
  const auto newton = [&] {
    for (int iteration = 0; iteration < 40; ++iteration) {
      std::vector<Eigen::Vector2d> out(solid.position.size(), Eigen::Vector2d::Zero());
      for (std::size_t i = 0; i < touching; ++i) {
        out[static_cast<std::size_t>(surface[i])] = normal(point(i));
      }
      solid.assemble(force, all);
      // turned axes at the nodes that touch: along the punch, and across it (held)
      std::vector<char> fixed(static_cast<std::size_t>(size));
      for (int i = 0; i < size; ++i) fixed[static_cast<std::size_t>(i)] = solid.held(i);
      Eigen::VectorXd right = -force;
      std::vector<Eigen::Triplet<double>> turn;
      for (int i = 0; i < size / 2; ++i) {
        const Eigen::Vector2d& o = out[static_cast<std::size_t>(i)];
        if (o.isZero()) {
          turn.emplace_back(2 * i, 2 * i, 1.0);
          turn.emplace_back(2 * i + 1, 2 * i + 1, 1.0);
          continue;
        }
        turn.emplace_back(2 * i, 2 * i, -o.y());  // column 2i: along
        turn.emplace_back(2 * i + 1, 2 * i, o.x());
        turn.emplace_back(2 * i, 2 * i + 1, o.x());
        turn.emplace_back(2 * i + 1, 2 * i + 1, o.y());
        fixed[static_cast<std::size_t>(2 * i + 1)] = 1;
      }
      Eigen::SparseMatrix<double> K(size, size), T(size, size);
      K.setFromTriplets(all.begin(), all.end());
      T.setFromTriplets(turn.begin(), turn.end());
      K = Eigen::SparseMatrix<double>(T.transpose() * K * T);
      right = T.transpose() * right;
      for (std::size_t i = 0; i < touching; ++i) {
        const int node = surface[i];
        const Eigen::Vector2d f(force[2 * node], force[2 * node + 1]);
        K.coeffRef(2 * node, 2 * node) -= f.dot(out[static_cast<std::size_t>(node)]) * k;  // the punch turns away
      }
      double residual = 0, scale = 1e-9, gap = 0;
      Eigen::VectorXd d = Eigen::VectorXd::Zero(size);  // first what the punch demands
      for (std::size_t i = 0; i < touching; ++i) {
        d[2 * surface[i] + 1] = inside(point(i));
        gap = std::max(gap, std::abs(inside(point(i))));
      }
      for (int i = 0; i < size; ++i) {
        if (!fixed[static_cast<std::size_t>(i)]) residual = std::max(residual, std::abs(right[i]));
        scale = std::max(scale, std::abs(right[i]));
      }
      if (residual < 1e-9 * scale + rounding && gap < 1e-10 * layer.thickness) return;
      right -= K * d;
      kept.clear();
      for (int j = 0; j < K.outerSize(); ++j) {
        if (fixed[static_cast<std::size_t>(j)]) {
          kept.emplace_back(j, j, 1.0);
          right[j] = d[j];
          continue;
        }
        for (Eigen::SparseMatrix<double>::InnerIterator it(K, j); it; ++it)
          if (!fixed[static_cast<std::size_t>(it.row())]) kept.emplace_back(static_cast<int>(it.row()), j, it.value());
      }
      K.setZero();
      K.setFromTriplets(kept.begin(), kept.end());
      d = T * solve_symmetric(K, right);
      for (std::size_t i = 0; i < solid.position.size(); ++i)
        solid.position[i] += d.segment<2>(2 * static_cast<Eigen::Index>(i));
    }
    throw std::runtime_error("neo_hookean_layer: no equilibrium");
  };
  for (const double depth : depths) {
    const int steps = std::max(1, static_cast<int>(std::ceil((depth + tip) / (step * layer.thickness))));
    const double from = tip;
    for (int s = 1; s <= steps; ++s) {
      tip = from - (depth + from) * s / steps;
      // most of what is that far inside will touch: a start that does not dent the layer with single nodes
      while (touching < surface.size() && inside(point(touching)) > 0.5 * (depth + from) / steps) ++touching;
      bool added = false;
      for (int round = 0;; ++round) {
        newton();
        std::size_t now = touching;
        while (now < surface.size() && inside(point(now)) > 1e-12) ++now;
        if (now > touching) {
          touching = now;
          added = true;
          continue;
        }
        const int last = surface[touching - 1];
        const Eigen::Vector2d f(force[2 * last], force[2 * last + 1]);
        if (touching > 1 && !added && f.dot(normal(point(touching - 1))) < 0) {
          --touching;
          continue;
        }
        break;
      }
    }
    PressedLayer result;
    result.depth = depth;
    for (std::size_t i = 0; i < touching; ++i) result.force -= force[2 * surface[i] + 1];
    const std::size_t beyond = std::min(touching, surface.size() - 1);  // the whole surface may touch
    result.radius = 0.5 * (point(touching - 1).x() + point(beyond).x());
    result.peak_cauchy = solid.peak(surface, force, 0.35 * result.radius, false);
    result.peak_nominal = solid.peak(surface, force, 0.35 * result.radius, true);
    results.push_back(result);
  }
  return results;
}

/// Two layers, `upper` upside down over `lower`, each bonded to a rigid base; the upper base comes down to each of
/// `depths` (increasing). Contact is the energy of springs of stiffness `penalty` at two points of each edge of the
/// upper surface in the gap g = z - h(x) over the lower one. Its gradient is along the lower surface's normal, so that
/// nothing rubs, and acts on both sides alike; what the springs give way, pressure/penalty, is taken from the depth.
/// Where no equilibrium is found any more the results end: there may be fewer than depths.
inline std::vector<PressedLayer> press_layers(bool axisymmetric, const NeoHookeanLayer& lower,
                                              const NeoHookeanLayer& upper, const std::vector<double>& depths,
                                              const LayerGrid& grid, double step = 0.02) {
  NeoHookeanSolid solid(axisymmetric);
  const std::vector<int> below = solid.add(lower, grid), above = solid.add(upper, grid, true);
  const std::vector<Eigen::Vector2d> reference = solid.position;
  const Eigen::Index size = 2 * static_cast<Eigen::Index>(solid.position.size());
  const double E = std::min(lower.E, upper.E), thickness = lower.thickness + upper.thickness;
  const double final_penalty = 1e3 * E / thickness;
  double penalty = final_penalty;
  const double rounding =
      1e-12 * thickness * thickness *
      (final_penalty * thickness + std::max(lower.E / (1 - 2 * lower.nu), upper.E / (1 - 2 * upper.nu)));
  using Vector12 = Eigen::Matrix<double, 12, 1>;
  // gap of the point u on an upper edge (first three nodes of x) over a lower edge (last three), and its gradient
  const auto gap = [](const Vector12& x, double u, Vector12& gradient) {
    const auto N = [](double v) { return Eigen::Vector3d(0.5 * v * (v - 1), 1 - v * v, 0.5 * v * (v + 1)); };
    const Eigen::Vector3d Ns = N(u);
    const Eigen::Vector3d xs(x[0], x[2], x[4]), zs(x[1], x[3], x[5]), xm(x[6], x[8], x[10]), zm(x[7], x[9], x[11]);
    double v = 0, slope = 0;
    Eigen::Vector3d dN;
    for (int i = 0; i < 50; ++i) {
      dN = Eigen::Vector3d(v - 0.5, -2 * v, v + 0.5);
      const double miss = N(v).dot(xm) - Ns.dot(xs);
      if (std::abs(miss) < 1e-15) break;
      v -= miss / dN.dot(xm);
    }
    const Eigen::Vector3d Nm = N(v);
    slope = dN.dot(zm) / dN.dot(xm);
    for (int a = 0; a < 3; ++a) {
      gradient[2 * a] = -slope * Ns[a];
      gradient[2 * a + 1] = Ns[a];
      gradient[6 + 2 * a] = slope * Nm[a];
      gradient[7 + 2 * a] = -Nm[a];
    }
    return Ns.dot(zs) - Nm.dot(zm);
  };
  Eigen::VectorXd force, contact(size);
  std::vector<Eigen::Triplet<double>> all, kept;
  double edge_of_contact = 0;
  // the lower edge under each point: found when Newton's method starts and then held, or points near a node would
  // jump between two edges' slopes for ever
  std::vector<std::size_t> under(above.size());
  const auto add_contact = [&](bool search) {
    contact.setZero();
    edge_of_contact = 0;
    const auto at = [&](int node) -> const Eigen::Vector2d& { return solid.position[static_cast<std::size_t>(node)]; };
    const double g = 1 / std::sqrt(3.0);
    for (std::size_t e = 0; e + 2 < above.size(); e += 2)
      for (const double u : {-g, g}) {
        const double N[3] = {0.5 * u * (u - 1), 1 - u * u, 0.5 * u * (u + 1)}, dN[3] = {u - 0.5, -2 * u, u + 0.5};
        double x = 0, x0 = 0, dx0 = 0;
        for (std::size_t a = 0; a < 3; ++a) {
          x += N[a] * at(above[e + a]).x();
          x0 += N[a] * reference[static_cast<std::size_t>(above[e + a])].x();
          dx0 += dN[a] * reference[static_cast<std::size_t>(above[e + a])].x();
        }
        std::size_t& m = under[u < 0 ? e : e + 1];
        while (search && m + 4 < below.size() && at(below[m + 2]).x() < x) m += 2;
        while (search && m >= 2 && at(below[m]).x() > x) m -= 2;
        int node[6];
        Vector12 y, gradient, plus, minus;
        for (std::size_t a = 0; a < 3; ++a) {
          node[a] = above[e + a];
          node[3 + a] = below[m + a];
        }
        for (int a = 0; a < 6; ++a) y.segment<2>(2 * a) = at(node[a]);
        const double open = gap(y, u, gradient);
        if (open >= 0) continue;
        edge_of_contact = std::max(edge_of_contact, x);
        const double weight = penalty * dx0 * (axisymmetric ? 2 * 3.14159265358979323846 * x0 : 2);
        Eigen::Matrix<double, 12, 12> K = weight * gradient * gradient.transpose();
        for (int i = 0; i < 12; ++i) {  // the gap's own second derivative
          const double h = 1e-6 * thickness;
          Vector12 z = y;
          z[i] += h;
          gap(z, u, plus);
          z[i] -= 2 * h;
          gap(z, u, minus);
          K.col(i) += weight * std::max(open, -E / penalty) * (plus - minus) / (2 * h);
        }
        for (int a = 0; a < 12; ++a) {
          const int row = 2 * node[a / 2] + a % 2;
          contact[row] += weight * open * gradient[a];
          for (int b = 0; b < 12; ++b) all.emplace_back(row, 2 * node[b / 2] + b % 2, 0.5 * (K(a, b) + K(b, a)));
        }
      }
    force += contact;
  };
  /// Newton's method; in the first iteration the upper base comes down.
  const auto equilibrium = [&](double down) {
    double residual = 0, scale = 0;
    const auto forces = [&](bool search) {
      solid.assemble(force, all);
      add_contact(search);
      residual = scale = 0;
      for (int i = 0; i < size; ++i) {
        if (!solid.held(i)) residual = std::max(residual, std::abs(force[i]));
        scale = std::max(scale, std::abs(force[i]));
      }
    };
    forces(true);
    for (int iteration = 0; iteration < 60; ++iteration) {
      if (iteration > 0 && residual < 1e-8 * scale + rounding) return true;
      Eigen::VectorXd d = Eigen::VectorXd::Zero(size);
      if (iteration == 0)
        for (int i = 1; i < size; i += 2)
          if (solid.held(i) && solid.upper(i / 2)) d[i] = -down;
      Eigen::SparseMatrix<double> K(size, size);
      K.setFromTriplets(all.begin(), all.end());
      Eigen::VectorXd right = -force - K * d;
      kept.clear();
      for (int j = 0; j < size; ++j) {
        if (solid.held(j)) {
          kept.emplace_back(j, j, 1.0);
          right[j] = d[j];
          continue;
        }
        for (Eigen::SparseMatrix<double>::InnerIterator it(K, j); it; ++it)
          if (!solid.held(static_cast<int>(it.row()))) kept.emplace_back(static_cast<int>(it.row()), j, it.value());
      }
      K.setZero();
      K.setFromTriplets(kept.begin(), kept.end());
      d = solve_symmetric(K, right);
      // steps that make the forces worse are halved
      const std::vector<Eigen::Vector2d> before = solid.position;
      const double worst = residual;
      for (double part = 1;; part *= 0.5) {
        for (std::size_t i = 0; i < solid.position.size(); ++i)
          solid.position[i] = before[i] + part * d.segment<2>(2 * static_cast<Eigen::Index>(i));
        const bool last = (down > 0 && iteration == 0) || part < 0.02;
        try {
          forces(false);
        } catch (const std::runtime_error&) {
          if (last) throw;
          continue;
        }
        if (last || residual < worst) break;
      }
    }
    return false;
  };
  std::vector<PressedLayer> results;
  double reached = 0, stride = step * thickness;
  for (const double depth : depths) {
    while (reached < depth) {
      const double to = std::min(depth, reached + stride);
      const std::vector<Eigen::Vector2d> before = solid.position;
      bool done = false;
      try {
        penalty = final_penalty / 16;  // from soft springs to stiff ones: contact finds its edge more easily
        done = equilibrium(to - reached);
        for (int i = 0; i < 2 && done; ++i) {
          penalty *= 4;
          done = equilibrium(0);
        }
      } catch (const std::runtime_error&) {
        done = false;
      }
      if (done) {
        reached = to;
        stride = std::min(step * thickness, 1.5 * stride);
      } else {
        solid.position = before;
        if ((stride *= 0.5) < 1e-2 * step * thickness) return results;
      }
    }
    PressedLayer result;
    for (const int node : above) result.force -= contact[2 * node + 1];
    result.radius = edge_of_contact;
    result.peak_cauchy = solid.peak(above, contact, 0.35 * edge_of_contact, false);
    result.peak_nominal = solid.peak(above, contact, 0.35 * edge_of_contact, true);
    result.depth = depth - result.peak_nominal / penalty;
    results.push_back(result);
  }
  return results;
}

}  // namespace dea::analytic

// tests/analytic/eight_nodes.h – quadrilaterals with eight nodes (serendipity) for plane and axisymmetric finite
// elements.
#pragma once
#include <Eigen/Core>
#include <cmath>

namespace dea::analytic {

/// The nodes' places in the element, which is [-1, 1]^2: corners, then middles of the sides.
inline constexpr double kNodeX[8] = {-1, 1, 1, -1, 0, 1, 0, -1}, kNodeY[8] = {-1, -1, 1, 1, -1, 0, 1, 0};

/// Gauss points along each direction, and their weights.
inline const double kGauss[3] = {-std::sqrt(0.6), 0, std::sqrt(0.6)}, kGaussWeight[3] = {5.0 / 9, 8.0 / 9, 5.0 / 9};

/// The nodes' shape functions at (u, v), and their derivatives by u and v.
struct Shape {
  Eigen::Matrix<double, 8, 1> N;
  Eigen::Matrix<double, 8, 2> dN;
};
inline Shape eight_node_shape(double u, double v) {
  Shape s;
  for (int a = 0; a < 8; ++a) {
    const double x = kNodeX[a], y = kNodeY[a];
    if (x != 0 && y != 0) {
      s.N[a] = 0.25 * (1 + u * x) * (1 + v * y) * (u * x + v * y - 1);
      s.dN.row(a) << 0.25 * x * (1 + v * y) * (2 * u * x + v * y), 0.25 * y * (1 + u * x) * (2 * v * y + u * x);
    } else if (x == 0) {
      s.N[a] = 0.5 * (1 - u * u) * (1 + v * y);
      s.dN.row(a) << -u * (1 + v * y), 0.5 * y * (1 - u * u);
    } else {
      s.N[a] = 0.5 * (1 - v * v) * (1 + u * x);
      s.dN.row(a) << 0.5 * x * (1 - v * v), -v * (1 + u * x);
    }
  }
  return s;
}

}  // namespace dea::analytic

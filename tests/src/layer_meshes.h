// tests/src/layer_meshes.h – surfaces for the tests of the layer law.
#pragma once
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "layer_operator.h"

namespace dea::test {

/// m x n quads over (u, v) in [0, 1]^2; triangles turn counter-clockwise in (u, v).
inline SurfaceMesh grid(int m, int n, const std::function<Vector3d(double, double)>& patch) {
  std::vector<Vector3d> points;
  std::vector<int> begin = {0}, nodes;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= m; ++i) points.push_back(patch(static_cast<double>(i) / m, static_cast<double>(j) / n));
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < m; ++i) {
      const int a = i + (m + 1) * j;
      for (const int node : {a, a + 1, a + m + 2, a + m + 1}) nodes.push_back(node);
      begin.push_back(static_cast<int>(nodes.size()));
    }
  return make_surface_mesh(begin, nodes, points);
}

inline SurfaceMesh rectangle(int m, int n, double length, double width) {
  return grid(m, n, [=](double u, double v) { return Vector3d(length * u, width * v, 0); });
}

/// Hemisphere z >= 0 without seam: the square [-1, 1]^2 mapped onto the disk (squares to circles), then onto the sphere
/// with the angle from the pole proportional to the radius. n x n quads, rim at z = 0.
inline SurfaceMesh hemisphere(int n, double radius) {
  return grid(n, n, [=](double u, double v) -> Vector3d {
    const double a = 2 * u - 1, b = 2 * v - 1, far = std::max(std::abs(a), std::abs(b));
    if (far < 1e-14) return {0, 0, radius};
    const double scale = far / std::hypot(a, b), x = a * scale, y = b * scale, r = std::hypot(x, y);
    const double theta = r * std::acos(0.0);
    return radius * Vector3d(std::sin(theta) * x / r, std::sin(theta) * y / r, std::cos(theta));
  });
}

/// Rim conditions by the middle of each edge.
inline std::vector<Rim> rim_where(const SurfaceMesh& surface, const LayerMesh& mesh,
                                  const std::function<Rim(const Vector3d&)>& condition) {
  std::vector<Rim> rim;
  for (const RimEdge& edge : mesh.rim)
    rim.push_back(condition(0.5 * (surface.vertices[static_cast<std::size_t>(edge.a)] +
                                   surface.vertices[static_cast<std::size_t>(edge.b)])));
  return rim;
}

/// Value of a function at the centroids of the feet, one foot per triangle.
template <class Function>
Eigen::VectorXd at_feet(const SurfaceMesh& surface, const Function& function) {
  Eigen::VectorXd values(surface.size());
  for (int t = 0; t < surface.size(); ++t) values[t] = function(surface.centroid(t));
  return values;
}

inline std::vector<double> to_vector(const Eigen::VectorXd& v) { return {v.data(), v.data() + v.size()}; }

/// Each triangle cut into four feet, as springs with refine = 2.
inline LayerMesh refined_layer_mesh(const SurfaceMesh& surface) {
  using Corners = std::array<std::array<double, 3>, 3>;
  const std::array<double, 3> a = {1, 0, 0}, b = {0, 1, 0}, c = {0, 0, 1}, ab = {.5, .5, 0}, bc = {0, .5, .5},
                              ca = {.5, 0, .5};
  std::vector<int> triangle;
  std::vector<Corners> corners;
  for (int t = 0; t < surface.size(); ++t)
    for (const Corners& foot : {Corners{a, ab, ca}, Corners{ab, b, bc}, Corners{ab, bc, ca}, Corners{ca, bc, c}}) {
      triangle.push_back(t);
      corners.push_back(foot);
    }
  return make_layer_mesh(surface, triangle, corners);
}

}  // namespace dea::test

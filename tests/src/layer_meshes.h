// tests/src/layer_meshes.h – surfaces for the tests of the layer law.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "src/geometry/foot_parts.h"
#include "src/springs/layer_operator.h"

namespace dea::test {

inline constexpr LayerFit kFits[] = {LayerFit::OneTerm, LayerFit::TwoTerms};

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

/// The surface and its mirror image in the plane x = 0, on which its side x = 0 lies.
inline SurfaceMesh with_mirror_image(const SurfaceMesh& half) {
  std::vector<Vector3d> points = half.vertices;
  std::vector<int> image(points.size());
  for (std::size_t v = 0; v < image.size(); ++v) {
    const Vector3d& x = half.vertices[v];
    image[v] = std::abs(x.x()) < 1e-12 ? static_cast<int>(v) : static_cast<int>(points.size());
    if (image[v] != static_cast<int>(v)) points.emplace_back(-x.x(), x.y(), x.z());
  }
  std::vector<int> begin = {0}, nodes;
  for (const bool mirrored : {false, true})
    for (const auto& t : half.triangles) {
      for (const std::size_t k : {0, 1, 2})
        nodes.push_back(mirrored ? image[static_cast<std::size_t>(t[2 - k])] : t[k]);
      begin.push_back(static_cast<int>(nodes.size()));
    }
  return make_surface_mesh(begin, nodes, points);
}

/// The triangles whose centroids are inside first, then the others.
inline SurfaceMesh sorted(const SurfaceMesh& mesh, const std::function<bool(const Vector3d&)>& inside, int& insiders) {
  std::vector<int> begin = {0}, nodes;
  insiders = 0;
  for (const bool first : {true, false})
    for (int t = 0; t < mesh.size(); ++t) {
      if (inside(mesh.centroid(t)) != first) continue;
      insiders += first;
      for (const int v : mesh.triangles[static_cast<std::size_t>(t)]) nodes.push_back(v);
      begin.push_back(static_cast<int>(nodes.size()));
    }
  return make_surface_mesh(begin, nodes, mesh.vertices);
}

using Thickness = std::function<double(const Vector3d&)>;
using RimAt = std::function<Rim(const Vector3d&)>;  ///< by the middle of each edge
inline Thickness even(double t) {
  return [=](const Vector3d&) { return t; };
}
inline RimAt all(Rim rim) {
  return [=](const Vector3d&) { return rim; };
}

/// `pressed`: its first triangles; all of them if < 0.
inline LayerFace layer_face(const SurfaceMesh& mesh, const Thickness& thickness, const RimAt& rim, int pressed = -1) {
  LayerFace face;
  face.mesh = mesh;
  face.pressed = pressed < 0 ? mesh.size() : pressed;
  for (const Vector3d& x : mesh.vertices) face.thickness.push_back(thickness(x));
  for (int t = 0; t < mesh.size(); ++t)
    for (int k = 0; k < 3; ++k)
      if (mesh.neighbours[static_cast<std::size_t>(t)][static_cast<std::size_t>(k)] < 0)
        face.edges.push_back({t, k, rim(0.5 * (mesh.corner(t, k) + mesh.corner(t, (k + 1) % 3)))});
  return face;
}

inline LayerMesh layer_mesh(const SurfaceMesh& mesh, const Thickness& thickness, const RimAt& rim, int pressed = -1,
                            int divide = 1) {
  return make_layer_mesh(layer_face(mesh, thickness, rim, pressed), divide);
}

/// A layer and one foot on each of its pressed triangles.
struct FootedLayer {
  LayerOperator layer;
  LayerFeet feet;
  FootedLayer(LayerMesh mesh, const Elasticity& elasticity, LayerFit fit)
      : layer(make_layer_operator(std::move(mesh), elasticity, fit)), feet(feet_of_own_triangles(layer)) {}
  const SurfaceMesh& surface() const { return layer.mesh.mesh; }
  Eigen::VectorXd areas() const { return Eigen::Map<const Eigen::VectorXd>(feet.area.data(), feet.size()); }
  Eigen::VectorXd volumes() const { return Eigen::Map<const Eigen::VectorXd>(feet.volume.data(), feet.size()); }
  Eigen::VectorXd sinking(const Eigen::VectorXd& p) const { return dea::sinking(layer, feet, p).col(0); }
};

/// Feet of which only these shares stand on the layer.
inline LayerFeet covered(LayerFeet feet, const Eigen::VectorXd& share) {
  for (int i = 0; i < feet.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    for (int j = feet.begin[k]; j < feet.begin[k + 1]; ++j) feet.weight[static_cast<std::size_t>(j)] *= share[i];
    feet.volume[k] *= share[i];
    feet.area[k] *= share[i];
  }
  return feet;
}

/// Value of a function at the centroids of the triangles.
template <class Function>
Eigen::VectorXd at_feet(const SurfaceMesh& surface, const Function& function) {
  Eigen::VectorXd values(surface.size());
  for (int t = 0; t < surface.size(); ++t) values[t] = function(surface.centroid(t));
  return values;
}

/// A square in the plane z = 0 that faces -z: n x n quads, turned by `angle` about its centre, which is at `center`.
struct Underside {
  int n = 1;
  double size = 1, angle = 0;
  Vector3d center = Vector3d::Zero();

  SurfaceMesh mesh() const {
    return grid(n, n, [this](double u, double v) { return at(size * (v - 0.5), size * (u - 0.5)); });
  }
  Vector3d at(double x, double y) const {
    return center + Vector3d(std::cos(angle) * x - std::sin(angle) * y, std::sin(angle) * x + std::cos(angle) * y, 0);
  }
  /// The triangle of `mesh` at x.
  int triangle(const SurfaceMesh& mesh, const Vector3d& x) const {
    const Vector3d d = x - center;
    const auto cell = [&](double along) {
      return std::clamp(static_cast<int>(std::floor((along / size + 0.5) * n)), 0, n - 1);
    };
    const int i = cell(-std::sin(angle) * d.x() + std::cos(angle) * d.y()),
              j = cell(std::cos(angle) * d.x() + std::sin(angle) * d.y());
    int best = -1;
    double inside = -1e300;
    for (const int t : {2 * (i + n * j), 2 * (i + n * j) + 1}) {
      double least = 1e300;
      for (int k = 0; k < 3; ++k) {
        const Vector3d &a = mesh.corner(t, k), &b = mesh.corner(t, (k + 1) % 3);
        least = std::min(least, (b - a).cross(x - a).dot(mesh.normals[static_cast<std::size_t>(t)]));
      }
      if (least > inside) best = t;
      inside = std::max(inside, least);
    }
    return best;
  }
};

/// What the triangles of a surface in the plane z = 0, as feet that look up, cover of an underside in the same plane.
inline LayerFeet feet_on_underside(const SurfaceMesh& feet, const Underside& underside, const LayerOperator& layer) {
  LayerFeet result;
  const SurfaceMesh& mesh = layer.mesh.mesh;
  for (int t = 0; t < feet.size(); ++t)
    add_foot(result, layer,
             parts_under_foot({feet.corner(t, 0), feet.corner(t, 1), feet.corner(t, 2)},
                              feet.areas[static_cast<std::size_t>(t)], Vector3d::UnitZ(), mesh,
                              underside.triangle(mesh, feet.centroid(t)), layer.mesh.pressed),
             feet.areas[static_cast<std::size_t>(t)]);
  set_reach(result, layer);
  return result;
}

}  // namespace dea::test

// src/geometry/ray_caster.h – where lines meet a triangulated surface, and its closest points.
//
// A tree of boxes, a little too large, narrows the search to a few triangles. What is found does not depend on the
// tree.
#pragma once
#include <array>
#include <memory>
#include <vector>

#include "src/geometry/surface_mesh.h"

namespace dea {

/// A point of a surface: triangle number and barycentric weights of its corners.
struct SurfacePoint {
  int triangle = -1;  ///< -1: none
  std::array<double, 3> weights = {0, 0, 0};
};

/// One crossing of a line with the surface.
struct LineHit {
  SurfacePoint point;
  double distance = 0.0;  ///< signed, along the line's direction from its origin
};

class RayCaster {
 public:
  struct Tree;  ///< private to ray_caster.cpp

  /// A value: it keeps the mesh, copies share it. Queries may run side by side.
  explicit RayCaster(SurfaceMesh mesh);

  /// Of all crossings of the line origin + d * direction (direction: unit) with triangles that face against it
  /// (normal . direction < -min_facing) and d in (from, to), the one of smallest |d| with d > limit, or, if there is
  /// none, the one of smallest |d| at all (then d <= limit: a surface passed too deep). `from` <= 0 <= `to`.
  /// A crossing within 1e-9 (barycentric) of an edge goes to the lowest-numbered of the triangles there.
  LineHit nearest_facing(const Vector3d& origin, const Vector3d& direction, double from, double limit, double to,
                         double min_facing = 0.0) const;

  /// Closest point of the surface to x; the lowest-numbered triangle on ties.
  SurfacePoint closest(const Vector3d& x) const;

  /// Numbers of the triangles that have a point within `radius` of x, ascending.
  std::vector<int> within(const Vector3d& x, double radius) const;

  const SurfaceMesh& mesh() const { return *mesh_; }

 private:
  std::shared_ptr<const SurfaceMesh> mesh_;
  std::shared_ptr<const Tree> tree_;
};

/// Position of a surface point.
Vector3d position(const SurfaceMesh& mesh, const SurfacePoint& point);
/// A value given per vertex, interpolated linearly at a surface point.
template <class Value>
Value interpolate(const SurfaceMesh& mesh, const std::vector<Value>& per_vertex, const SurfacePoint& point) {
  const auto& corners = mesh.triangles[static_cast<std::size_t>(point.triangle)];
  const auto part = [&](std::size_t k) -> Value {
    return point.weights[k] * per_vertex[static_cast<std::size_t>(corners[k])];
  };
  return part(0) + part(1) + part(2);
}

}  // namespace dea

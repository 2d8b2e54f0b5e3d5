// src/geometry/triangle_surface.h – points and triangles, as scans come: nothing is known of them yet.
#pragma once
#include <Eigen/Core>
#include <array>
#include <vector>

namespace dea {

/// Corners counter-clockwise seen from outside, where the surface knows an outside.
struct TriangleSurface {
  std::vector<Eigen::Vector3d> points;        ///< length of the file
  std::vector<std::array<int, 3>> triangles;  ///< indices of points

  /// Another surface beside this one.
  void append(const TriangleSurface& more) {
    const int first = static_cast<int>(points.size());
    points.insert(points.end(), more.points.begin(), more.points.end());
    for (const auto& t : more.triangles) triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
};

}  // namespace dea

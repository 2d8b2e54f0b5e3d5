// views/study_page/study_common_grid.h – one grid for surfaces with meshes of their own, such as the sockets
// of several subjects: what their maps are averaged on.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "views/study_page/study_surfaces.h"

namespace dea {

/// Points of a square lattice over the unrolled surfaces (MapView: Lambert's equal areas about each surface's own
/// sphere and middle). A point is at the same angle from the middle and from `up` on every surface: sizes are scaled
/// away, left and right are not mirrored. All points stand for the same area.
struct CommonGrid {
  double radius = 0.0;     ///< mean of the spheres' radii
  double step = 0.0;       ///< between neighbours, at the mean radius
  Vector3d up;             ///< direction to the top of the map
  ResultSurface geometry;  ///< the points that some surface covers, x right and y up at the mean radius, z = 0
  /// Where a point takes its value from on one surface: linear between three vertices; -1: not covered.
  struct Source {
    std::array<int, 3> vertices = {-1, -1, -1};
    std::array<double, 3> weights = {0, 0, 0};
  };
  std::vector<std::vector<Source>> sources;  ///< per surface and vertex of `geometry`
  /// Values at the points; NaN: not covered.
  std::vector<double> sampled(std::size_t surface, const std::vector<double>& values) const;
};
/// Points along an edge of the square that holds all surfaces.
inline constexpr int kGridSide = 81;

/// `up`: zero: the global z, y or x axis that the first surface has on top of its map. nullopt: a surface is no part of
/// a sphere (unroll); `fault` says which.
std::optional<CommonGrid> common_grid(const std::vector<const StudySurfaceMesh*>& surfaces, const Vector3d& up,
                                      std::string& fault);

}  // namespace dea

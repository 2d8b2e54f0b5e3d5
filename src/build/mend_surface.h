// src/build/mend_surface.h – what is wrong with a scanned surface, mended where that is safe.
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

#include "src/geometry/triangle_surface.h"

namespace dea {

/// Counts of what was found. Points that lie at one place, or within 1e-7 of the surface's size, become one; those of
/// no triangle are left out.
struct SurfaceFaults {
  std::size_t degenerate = 0;        ///< triangles of no area; left out
  std::size_t duplicate = 0;         ///< triangles on the same three points; left out
  std::size_t flipped = 0;           ///< triangles turned to agree with their neighbours, the fewer of each part
  bool turned_inside_out = false;    ///< closed parts whose volume was negative
  std::size_t islands = 0;           ///< loose parts below 1 % of the area; left out
  std::size_t island_triangles = 0;  ///< in them
  std::size_t non_manifold = 0;      ///< edges of three triangles or more; all but two of each are cut loose there
  std::size_t holes = 0;             ///< closed rims of the surface
  std::size_t rim_edges = 0;         ///< edges of one triangle
  std::size_t parts = 0;             ///< connected parts that are left
  bool not_orientable = false;       ///< a part like a Moebius strip: no outside
};

struct MendedSurface {
  TriangleSurface surface;
  SurfaceFaults faults;
  bool closed() const { return faults.rim_edges == 0 && faults.non_manifold == 0; }
};

/// Empty: no triangle has an area, or the surface falls into islands, none of them large enough. Each point once,
/// triangles with area, parts oriented alike; closed parts outwards, open ones as most of their triangles were.
MendedSurface mend_surface(const TriangleSurface& surface);

/// What was found, in words: "3 holes", "12 triangles turned"; empty: nothing.
std::vector<std::string> fault_words(const SurfaceFaults& faults);

/// Connected parts, counted from 0 in the order of their first triangles. Parts join over edges.
struct SurfaceParts {
  std::vector<int> part;     ///< per triangle
  std::vector<double> area;  ///< per part
};
SurfaceParts connected_parts(const TriangleSurface& surface);

/// The triangles that are wanted, and their points.
TriangleSurface part_of(const TriangleSurface& surface, const std::vector<char>& wanted);

/// The parts with at least this area.
TriangleSurface large_parts(const TriangleSurface& surface, const SurfaceParts& parts, double least);

/// The normal of a triangle, as long as its area.
Eigen::Vector3d area_vector(const TriangleSurface& surface, const std::array<int, 3>& triangle);
double area_of(const TriangleSurface& surface);
/// The box around it.
Eigen::AlignedBox3d box_of(const TriangleSurface& surface);
/// The length of its diagonal.
double size_of(const TriangleSurface& surface);
double mean_edge(const TriangleSurface& surface);

}  // namespace dea

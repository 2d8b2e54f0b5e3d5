// src/geometry/foot_parts.h – the parts of a surface's triangles that lie under the foot of a spring (L8).
#pragma once
#include <array>
#include <vector>

#include "src/geometry/surface_mesh.h"

namespace dea {

/// A convex part of a triangle of a surface, in its barycentric coordinates; the whole of it if nothing else is said.
struct SurfacePart {
  int triangle = -1;
  double area = 0.0;  ///< of what stands on it [mm^2], in the foot's plane
  int corners = 3;    ///< to 6
  std::array<Barycentric, 7> corner = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  double share = 1.0;  ///< of the triangle's area
};

/// The foot (a triangle of this area, with its corners in the surface's frame) seen along n, its unit normal, cut by
/// the surface's triangles that face it: from triangle `first` on over its neighbours, those below `end` only, and,
/// unless it is empty, only those in `own` (per triangle). Exact where the surface does not fold over itself under the
/// foot. Empty where `first` does not lie under the foot.
std::vector<SurfacePart> parts_under_foot(const std::array<Vector3d, 3>& foot, double area, const Vector3d& n,
                                          const SurfaceMesh& surface, int first, int end,
                                          const std::vector<char>& own = {});

}  // namespace dea

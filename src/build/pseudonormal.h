// src/build/pseudonormal.h – on which side of a surface a point lies.
//
// The sign of (x - closest point) . pseudonormal is right on every closed surface, with sharp edges and triangles of
// any size (Baerentzen and Aanaes 2005, 10.1109/TVCG.2005.49); normals weighted by area are not: a large triangle
// behind an edge, such as where a scan cuts a shaft, would outweigh the small ones before it.
#pragma once
#include <vector>

#include "src/geometry/ray_caster.h"

namespace dea {

/// Per vertex: the sum of the normals of the triangles around it, weighted by their angles there; not unit.
std::vector<Vector3d> angle_weighted_normals(const SurfaceMesh& mesh);

/// Out of the surface at a point of it, not unit: within a triangle its normal, on an edge the sum of both, at a vertex
/// the one above. `at_vertices`: angle_weighted_normals of the same mesh.
Vector3d pseudonormal(const SurfaceMesh& mesh, const std::vector<Vector3d>& at_vertices, const SurfacePoint& point);

}  // namespace dea

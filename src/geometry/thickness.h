// src/geometry/thickness.h – cartilage thickness of a layer, measured between its two surfaces.
#pragma once
#include <vector>

#include "src/geometry/surface_mesh.h"

namespace dea {

struct MeasuredThickness {
  std::vector<double> thickness;  ///< per vertex, >= 0
  std::vector<char> missed;       ///< per vertex: the closest point's distance
};

/// Of a layer at the vertices of its face `from` (normals out of the layer), along inward vertex normals to the bone
/// (docs/theory.md, section 2) [Abraham et al. 2013, 2.1]. A hit counts only on an opposing face (angle below 60
/// degrees) and within twice the distance of the closest point; otherwise that distance serves, flagged.
MeasuredThickness measure_thickness(const SurfaceMesh& from, const SurfaceMesh& bone);
/// The same at the vertices of the bone surface, along their normals to the articular surface.
MeasuredThickness measure_thickness_from_bone(const SurfaceMesh& bone, const SurfaceMesh& articular);

}  // namespace dea

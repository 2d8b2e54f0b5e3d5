// src/springs/coverage.h – the part of a foot triangle that lies over the target, where its rim cuts through.
#pragma once
#include <array>
#include <vector>

#include "src/geometry/surface_mesh.h"

namespace dea {

/// A linear functional of the motion of the target relative to the source: sum of v . (delta_target - delta_source)(r)
/// over points r, stored like forces v at r: their sum and their moment about a point.
struct Functional {
  Vector3d force = Vector3d::Zero();
  Vector3d moment = Vector3d::Zero();
};

struct Coverage {
  double fraction = 0.0;  ///< of the foot triangle's area
  double area = 0.0;
  Vector3d centroid = Vector3d::Zero();                   ///< of the covered part, in the foot triangle's plane
  Vector3d e1 = Vector3d::Zero(), e2 = Vector3d::Zero();  ///< axes of that plane
  Functional area_rate, centroid_rate[2];  ///< d(area), d(centroid) along e1, e2: the rim sweeps over the foot triangle
};

/// The part of the foot triangle onto which the target triangles `candidates` project along n: exact where the target
/// does not fold over itself there. Frame: any; moments about `reference`.
Coverage coverage(const SurfaceMesh& target, const std::array<Vector3d, 3>& foot, const Vector3d& n,
                  const std::vector<int>& candidates, const Vector3d& reference);

/// Barycentric weights of a point in the plane of a triangle.
std::array<double, 3> weights_in(const std::array<Vector3d, 3>& c, const Vector3d& x);

}  // namespace dea

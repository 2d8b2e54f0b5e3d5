#include "src/build/shared_space.h"

#include <algorithm>
#include <optional>

#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/build/mend_surface.h"
#include "src/build/region.h"

namespace dea {

namespace {

using Eigen::Vector3d;
using Triangle = std::array<int, 3>;

/// Both faces of a layer as one list of points, the bone's behind the articular ones.
std::vector<Vector3d> all_points(const BuiltLayer& layer) {
  std::vector<Vector3d> points = layer.articular;
  points.insert(points.end(), layer.bone.begin(), layer.bone.end());
  return points;
}

/// From the articular surface's rims down to the bone, looking outwards.
TriangleSurface walls_of(const BuiltLayer& layer) {
  TriangleSurface walls{all_points(layer), {}};
  const int below = static_cast<int>(layer.articular.size());
  for (const auto& [a, b] : rim_edges(layer.triangles, edge_neighbours(layer.triangles))) {
    walls.triangles.push_back({a, b + below, b});
    walls.triangles.push_back({a, a + below, b + below});
  }
  return walls;
}

/// The closed surface around a layer, looking outwards.
TriangleSurface hull_of(const BuiltLayer& layer) {
  TriangleSurface hull = walls_of(layer);
  const int below = static_cast<int>(layer.articular.size());
  for (const Triangle& t : layer.triangles) {
    hull.triangles.push_back(t);
    hull.triangles.push_back({t[0] + below, t[2] + below, t[1] + below});
  }
  return hull;
}

Vector3d middle(const std::vector<Vector3d>& points, const Triangle& t) {
  return (points[at(t[0])] + points[at(t[1])] + points[at(t[2])]) / 3;
}

/// Per column of a layer how far it lies within the rim of the other one; below zero: not in that layer.
std::vector<double> depths_in(const BuiltLayer& layer, const BuiltLayer& other) {
  constexpr int kHeights = 5;
  constexpr double kTouch = 1e-3;  // of the line through the layer: faces that lie on each other share nothing
  const TriangleSurface hull = hull_of(other), walls = walls_of(other);
  const RayCaster around(mesh_of(hull));
  const std::vector<Vector3d> normals = angle_weighted_normals(around.mesh());
  const std::optional<RayCaster> rim =
      walls.triangles.empty() ? std::nullopt : std::optional(RayCaster(mesh_of(walls)));
  const auto box = box_of(hull);
  std::vector<double> depths(layer.triangles.size(), -1.0);
  parallel_for(depths.size(), [&](std::size_t t) {
    const Vector3d from = middle(layer.bone, layer.triangles[t]),
                   line = middle(layer.articular, layer.triangles[t]) - from;
    for (int k = 0; k < kHeights; ++k) {
      const Vector3d x = from + (k + 0.5) / kHeights * line;
      if (!box.contains(x) || signed_distance(around, normals, x) > -kTouch * line.norm()) continue;
      depths[t] = std::max(depths[t], rim ? distance_to(*rim, x) : kInfinity);
    }
  });
  return depths;
}

/// Columns of a layer that lie in the other one. Patches that nowhere reach farther than `touch` into it are left out.
SharedSpace columns_in(const BuiltLayer& layer, const BuiltLayer& other, double touch) {
  const std::vector<double> depths = depths_in(layer, other);
  TriangleSurface shared{layer.articular, {}};
  std::vector<double> depth;
  for (std::size_t t = 0; t < depths.size(); ++t) {
    if (depths[t] < 0) continue;
    shared.triangles.push_back(layer.triangles[t]);
    depth.push_back(depths[t]);
  }
  SharedSpace found;
  const SurfaceParts patches = connected_parts(shared);
  std::vector<double> deepest(patches.area.size(), 0.0);
  for (std::size_t t = 0; t < depth.size(); ++t)
    deepest[at(patches.part[t])] = std::max(deepest[at(patches.part[t])], depth[t]);
  for (std::size_t p = 0; p < deepest.size(); ++p)
    if (deepest[p] > touch) found.area += patches.area[p];
  if (found.area > 0)
    found.where = middle(
        shared.points,
        shared.triangles[static_cast<std::size_t>(std::max_element(depth.begin(), depth.end()) - depth.begin())]);
  return found;
}

}  // namespace

SharedSpace shared_space(const BuiltLayer& a, const BuiltLayer& b) {
  const double touch = 0.5 * std::max(mean_edge(a.face()), mean_edge(b.face()));
  const SharedSpace of_a = columns_in(a, b, touch), of_b = columns_in(b, a, touch);
  SharedSpace found = of_a.area > of_b.area ? of_a : of_b;
  found.share = std::min(1.0, found.area / std::min(area_of(a.face()), area_of(b.face())));
  return found;
}

}  // namespace dea

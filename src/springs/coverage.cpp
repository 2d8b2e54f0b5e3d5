#include "src/springs/coverage.h"

#include <algorithm>
#include <cmath>

#include "src/base/numbers.h"

namespace dea {

namespace {

using Point2 = Eigen::Vector2d;

double cross2(const Point2& a, const Point2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Corner of a clipped triangle; `rim`: the edge that starts here is part of the target's rim.
struct ClipPoint {
  Point2 x;
  bool rim;
};

/// Clips a convex polygon (counter-clockwise) by the half plane left of a -> b, in place (Sutherland-Hodgman).
void clip(std::vector<ClipPoint>& polygon, const Point2& a, const Point2& b, std::vector<ClipPoint>& scratch) {
  scratch.clear();
  const Point2 edge = b - a;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const ClipPoint &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double dp = cross2(edge, p.x - a), dq = cross2(edge, q.x - a);
    if (dp >= 0) scratch.push_back(p);
    if ((dp > 0 && dq < 0) || (dp < 0 && dq > 0))
      scratch.push_back({p.x + dp / (dp - dq) * (q.x - p.x), dp < 0 && p.rim});
  }
  polygon.swap(scratch);
}

}  // namespace

Coverage coverage(const SurfaceMesh& target, const std::array<Vector3d, 3>& foot, const Vector3d& n,
                  const std::vector<int>& candidates, const Vector3d& reference) {
  Coverage result;
  result.e1 = (foot[1] - foot[0]).normalized();
  result.e2 = n.cross(result.e1);
  const auto project = [&](const Vector3d& x) {
    return Point2((x - foot[0]).dot(result.e1), (x - foot[0]).dot(result.e2));
  };
  const Point2 corner[3] = {project(foot[0]), project(foot[1]), project(foot[2])};
  const double foot_area = 0.5 * cross2(corner[1] - corner[0], corner[2] - corner[0]);
  std::vector<ClipPoint> polygon, scratch;
  Point2 moment = Point2::Zero();
  for (const int t : candidates) {
    const Vector3d& m = target.normals[at(t)];
    if (!(m.dot(n) < 0)) continue;
    // seen along n the target's triangles run clockwise: take them the other way round, edges (0,2), (2,1), (1,0)
    const auto& next = target.neighbours[at(t)];
    polygon = {{project(target.corner(t, 0)), next[2] < 0},
               {project(target.corner(t, 2)), next[1] < 0},
               {project(target.corner(t, 1)), next[0] < 0}};
    for (int k = 0; k < 3 && !polygon.empty(); ++k) clip(polygon, corner[k], corner[(k + 1) % 3], scratch);
    if (polygon.size() < 3) continue;
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
      const double a = 0.5 * cross2(polygon[i].x - polygon[0].x, polygon[i + 1].x - polygon[0].x);
      result.area += a;
      moment += a * (polygon[0].x + polygon[i].x + polygon[i + 1].x) / 3.0;
    }
    // The rim moves against the foot triangle: d(integral of f) = sum over rim pieces of f v_normal ds, two Gauss
    // points each.
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      if (!polygon[i].rim) continue;
      const Point2 p = polygon[i].x, along = polygon[(i + 1) % polygon.size()].x - p;
      const Vector3d outward_times_length = along.y() * result.e1 - along.x() * result.e2;
      for (double s : {0.5 - 0.28867513459481287, 0.5 + 0.28867513459481287}) {
        const Point2 x = p + s * along;
        const Vector3d in_plane = foot[0] + x.x() * result.e1 + x.y() * result.e2;
        const Vector3d r = in_plane + n * ((target.corner(t, 0) - in_plane).dot(m) / n.dot(m));  // on the target
        const Vector3d v = 0.5 * outward_times_length, arm = (r - reference).cross(v);
        result.area_rate.force += v;
        result.area_rate.moment += arm;
        for (int k = 0; k < 2; ++k) {
          result.centroid_rate[k].force += x[k] * v;
          result.centroid_rate[k].moment += x[k] * arm;
        }
      }
    }
  }
  if (result.area <= 0 || foot_area <= 0) return {};
  moment /= result.area;
  result.centroid = foot[0] + moment.x() * result.e1 + moment.y() * result.e2;
  // d(centroid) = (d(area * centroid) - centroid d(area)) / area
  for (int k = 0; k < 2; ++k) {
    result.centroid_rate[k].force = (result.centroid_rate[k].force - moment[k] * result.area_rate.force) / result.area;
    result.centroid_rate[k].moment =
        (result.centroid_rate[k].moment - moment[k] * result.area_rate.moment) / result.area;
  }
  result.fraction = std::min(1.0, result.area / foot_area);
  return result;
}

std::array<double, 3> weights_in(const std::array<Vector3d, 3>& c, const Vector3d& x) {
  const Vector3d normal = (c[1] - c[0]).cross(c[2] - c[0]);
  const double twice2 = normal.squaredNorm();
  const double w0 = (c[1] - x).cross(c[2] - x).dot(normal) / twice2,
               w1 = (c[2] - x).cross(c[0] - x).dot(normal) / twice2;
  return {w0, w1, 1 - w0 - w1};
}

}  // namespace dea

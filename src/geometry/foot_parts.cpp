#include "src/geometry/foot_parts.h"

#include <algorithm>
#include <cmath>

#include "src/base/numbers.h"

namespace dea {

namespace {

using Corners = std::array<Barycentric, 7>;

/// Cuts a convex polygon by the half plane where the k-th coordinate is not negative (Sutherland-Hodgman). Returns the
/// count of corners left.
int cut_along(const Corners& polygon, int corners, std::size_t k, Corners& left) {
  int kept = 0;
  for (int i = 0; i < corners; ++i) {
    const Barycentric &p = polygon[at(i)], &q = polygon[at(i + 1 < corners ? i + 1 : 0)];
    const double dp = p[k], dq = q[k];
    if (dp >= 0) left[at(kept++)] = p;
    if ((dp > 0 && dq < 0) || (dp < 0 && dq > 0)) {
      const double s = dp / (dp - dq);
      Barycentric& cut = left[at(kept++)];
      for (std::size_t j = 0; j < 3; ++j) cut[j] = p[j] + s * (q[j] - p[j]);
      cut[k] = 0;
    }
  }
  return kept;
}

/// The part of triangle t under the foot, both seen along n, with its area along n. False: there is none. `whole`: per
/// corner of t, the foot does not go beyond the side opposite it.
bool cut_out(const std::array<Vector3d, 3>& foot, const Vector3d& n, const SurfaceMesh& surface, int t,
             SurfacePart& part, std::array<bool, 3>& whole) {
  const Vector3d& x0 = surface.corner(t, 0);
  const Vector3d side1 = surface.corner(t, 1) - x0, side2 = surface.corner(t, 2) - x0;
  const double twice = side1.cross(side2).dot(n);
  if (!(twice < 0)) return false;  // faces away
  const Vector3d slope1 = side2.cross(n) / twice, slope2 = n.cross(side1) / twice;
  Corners corner;
  for (std::size_t c = 0; c < 3; ++c) {
    const Vector3d from = foot[c] - x0;
    const double s1 = from.dot(slope1), s2 = from.dot(slope2);
    corner[c] = {1 - s1 - s2, s1, s2};
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(std::max({corner[0][k], corner[1][k], corner[2][k]}) > 0)) return false;  // beside it
    whole[k] = std::min({corner[0][k], corner[1][k], corner[2][k]}) >= 0;
  }
  int corners = 3;
  for (std::size_t k = 0; k < 3; ++k) {
    if (whole[k]) continue;
    corners = cut_along(corner, corners, k, part.corner);
    if (corners < 3) return false;
    corner = part.corner;
  }
  double share = 0;  // of the triangle
  for (int i = 1; i + 1 < corners; ++i) {
    const Barycentric &a = corner[0], &b = corner[at(i)], &c = corner[at(i + 1)];
    share += std::abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
  }
  part.triangle = t;
  part.corners = corners;
  part.corner = corner;
  part.share = share;
  part.area = -0.5 * share * twice;
  return true;
}

}  // namespace

std::vector<SurfacePart> parts_under_foot(const std::array<Vector3d, 3>& foot, double area, const Vector3d& n,
                                          const SurfaceMesh& surface, int first, int end,
                                          const std::vector<char>& own) {
  std::vector<SurfacePart> parts;
  std::vector<int> reached = {first};
  parts.reserve(16);
  reached.reserve(32);
  const double scale = area / (0.5 * std::abs((foot[1] - foot[0]).cross(foot[2] - foot[0]).dot(n)));
  SurfacePart part;
  std::array<bool, 3> whole;
  for (std::size_t next = 0; next < reached.size(); ++next) {
    if (!cut_out(foot, n, surface, reached[next], part, whole)) continue;
    part.area *= scale;
    if (part.area > 0) parts.push_back(part);
    for (std::size_t k = 0; k < 3; ++k) {  // across its side from corner k to the next
      const int beside = surface.neighbours[at(part.triangle)][k];
      if (!whole[(k + 2) % 3] && beside >= 0 && beside < end && (own.empty() || own[at(beside)]) &&
          std::find(reached.begin(), reached.end(), beside) == reached.end())
        reached.push_back(beside);
    }
  }
  return parts;
}

}  // namespace dea

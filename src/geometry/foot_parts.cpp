#include <febiodea/geometry/foot_parts.h>

#include <algorithm>
#include <cmath>

#include <febiodea/base/numbers.h>

namespace dea {

namespace {

/// The part of a foot that lies over a triangle of a surface, both seen along n: corners in the barycentric
/// coordinates of the triangle and of the foot.
struct Overlay {
  struct Corner {
    Barycentric surface, foot;
  };
  int corners = 0;
  std::array<Corner, 7> corner;
  double share = 0.0;  ///< of the foot's area
};

/// Cuts the foot (a triangle) along the triangle's three edges (Sutherland-Hodgman, in barycentric coordinates).
Overlay overlay(const std::array<Vector3d, 3>& foot, const Vector3d& n, const SurfaceMesh& surface, int t) {
  Overlay out;
  const Vector3d &x0 = surface.corner(t, 0), &x1 = surface.corner(t, 1), &x2 = surface.corner(t, 2);
  const double twice = (x1 - x0).cross(x2 - x0).dot(n);
  if (!(twice < 0)) return out;  // faces away
  const Vector3d slope[3] = {(x1 - x2).cross(n) / twice, (x2 - x0).cross(n) / twice, (x0 - x1).cross(n) / twice};
  const Vector3d* corner[3] = {&x0, &x1, &x2};
  out.corners = 3;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t k = 0; k < 3; ++k) out.corner[c].surface[k] = 1 + (foot[c] - *corner[k]).dot(slope[k]);
    out.corner[c].foot = {0, 0, 0};
    out.corner[c].foot[c] = 1;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    std::array<Overlay::Corner, 7> kept;
    int n_kept = 0;
    for (int i = 0; i < out.corners; ++i) {
      const Overlay::Corner &p = out.corner[at(i)], &q = out.corner[at((i + 1) % out.corners)];
      const double dp = p.surface[k], dq = q.surface[k];
      if (dp >= 0) kept[at(n_kept++)] = p;
      if ((dp > 0 && dq < 0) || (dp < 0 && dq > 0)) {
        const double s = dp / (dp - dq);
        Overlay::Corner& cut = kept[at(n_kept++)];
        for (std::size_t j = 0; j < 3; ++j) {
          cut.surface[j] = p.surface[j] + s * (q.surface[j] - p.surface[j]);
          cut.foot[j] = p.foot[j] + s * (q.foot[j] - p.foot[j]);
        }
        cut.surface[k] = 0;
      }
    }
    out.corners = n_kept;
    out.corner = kept;
    if (n_kept < 3) {
      out.corners = 0;
      return out;
    }
  }
  for (int i = 1; i + 1 < out.corners; ++i) {
    const Barycentric &a = out.corner[0].foot, &b = out.corner[at(i)].foot, &c = out.corner[at(i + 1)].foot;
    out.share += std::abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
  }
  return out;
}

}  // namespace

std::vector<SurfacePart> parts_under_foot(const std::array<Vector3d, 3>& foot, double area, const Vector3d& n,
                                          const SurfaceMesh& surface, int first, int end) {
  std::vector<SurfacePart> parts;
  std::vector<int> reached = {first};
  for (std::size_t next = 0; next < reached.size(); ++next) {
    const int t = reached[next];
    const Overlay over = overlay(foot, n, surface, t);
    if (over.corners == 0) continue;
    if (over.share > 0) {
      SurfacePart part;
      part.triangle = t;
      part.area = over.share * area;
      part.corners = over.corners;
      for (int j = 0; j < over.corners; ++j) part.corner[at(j)] = over.corner[at(j)].surface;
      parts.push_back(part);
    }
    for (const int beside : surface.neighbours[at(t)])
      if (beside >= 0 && beside < end && std::find(reached.begin(), reached.end(), beside) == reached.end())
        reached.push_back(beside);
  }
  return parts;
}

}  // namespace dea

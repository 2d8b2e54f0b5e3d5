#include "src/results/within_facets.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "src/base/numbers.h"

namespace dea {

namespace {

/// The heights of cut facets depend on the slopes, and the slopes of facets beside them on the heights. Of a linear
/// pressure each sweep leaves a quarter to a half of the error; it is small from the first.
constexpr int kSweeps = 4;

/// Pressure within a facet: (H2) without its max.
struct Plane {
  double height = 0.0;                ///< c_f
  Vector3d slope = Vector3d::Zero();  ///< g_f
};

/// Where a linear function of three corner values is above 0 on its triangle.
PressedPart part_of_triangle(std::array<double, 3> corners) {
  std::sort(corners.begin(), corners.end());
  const auto [a, b, c] = corners;
  const double mean = (a + b + c) / 3;
  if (a >= 0) return {1.0, mean};
  if (c <= 0) return {};
  if (b <= 0) {  // a triangle at the corner c
    const double share = c / (c - a) * (c / (c - b));
    return {share, share * c / 3};
  }
  const double below = a / (a - b) * (a / (a - c));  // a triangle at the corner a
  return {1.0 - below, mean - below * a / 3};
}

/// Triangles of a facet: from begin[f] to begin[f + 1].
std::vector<int> triangle_begin(const ResultSurface& s) {
  std::vector<int> begin(at(s.facets() + 1), 0);
  for (int f : s.mesh.facet) ++begin[at(f + 1)];
  for (std::size_t f = 1; f < begin.size(); ++f) begin[f] += begin[f - 1];
  return begin;
}

struct PressedFacets {
  const ResultSurface& surface;
  const std::vector<double>& pressure;
  const std::vector<int> begin = triangle_begin(surface);
  bool pressed(int f) const { return pressure[at(f)] > 0 && begin[at(f)] < begin[at(f + 1)]; }

  /// Calls `visit` for each other facet that shares a vertex, once.
  template <class Visit>
  void each_around(int f, const Visit& visit) const {
    const ResultSurface& s = surface;
    const auto first = s.slot_vertex.begin() + s.begin[at(f)], last = s.slot_vertex.begin() + s.begin[at(f + 1)];
    for (auto v = first; v != last; ++v) {
      if (*v < 0) continue;
      for (int k = s.around_begin[at(*v)]; k < s.around_begin[at(*v + 1)]; ++k) {
        const int g = s.around[at(k)];
        const bool met = std::any_of(s.slot_vertex.begin() + s.begin[at(g)], s.slot_vertex.begin() + s.begin[at(g + 1)],
                                     [&](int other) { return other >= 0 && std::find(first, v, other) != v; });
        if (g != f && !met) visit(g);
      }
    }
  }

  /// Has the facet, or one around it, no more than `above`?
  bool at_edge(int f, double above) const {
    const ResultSurface& s = surface;
    const auto pressed_all_round = [&](int v) {
      return v < 0 ||
             std::all_of(s.around.begin() + s.around_begin[at(v)], s.around.begin() + s.around_begin[at(v + 1)],
                         [&](int g) { return pressure[at(g)] > above; });
    };
    return !std::all_of(s.slot_vertex.begin() + s.begin[at(f)], s.slot_vertex.begin() + s.begin[at(f + 1)],
                        pressed_all_round);
  }

  /// Where the plane is above `above` on the facet.
  PressedPart part(int f, const Plane& plane, double above) const {
    const SurfaceMesh& mesh = surface.mesh;
    PressedPart sum;
    double area = 0.0;
    for (int t = begin[at(f)]; t < begin[at(f + 1)]; ++t) {
      std::array<double, 3> corners;
      for (int k = 0; k < 3; ++k)
        corners[at(k)] = plane.height - above + plane.slope.dot(mesh.corner(t, k) - surface.facet_centers[at(f)]);
      const PressedPart of = part_of_triangle(corners);
      sum.share += mesh.areas[at(t)] * of.share;
      sum.pressure += mesh.areas[at(t)] * (of.pressure + above * of.share);
      area += mesh.areas[at(t)];
    }
    return {sum.share / area, sum.pressure / area};
  }

  /// By least squares from the heights of the facets around. A direction in which these hardly spread gets no slope: of
  /// a row of facets that across it.
  Vector3d slope(int f, const std::vector<Plane>& planes) const {
    constexpr double kSpread = 1e-3;
    Vector3d normal = Vector3d::Zero();
    for (int t = begin[at(f)]; t < begin[at(f + 1)]; ++t)
      normal += surface.mesh.areas[at(t)] * surface.mesh.normals[at(t)];
    if (!(normal.norm() > 0)) return Vector3d::Zero();
    const Vector3d across = normal.unitOrthogonal(), along = normal.normalized().cross(across);
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
    Eigen::Vector2d rise = Eigen::Vector2d::Zero();
    each_around(f, [&](int g) {
      const Vector3d to = surface.facet_centers[at(g)] - surface.facet_centers[at(f)];
      const double weight = 1.0 / to.squaredNorm();
      if (!pressed(g) || !std::isfinite(weight)) return;
      const Eigen::Vector2d d(to.dot(across), to.dot(along));
      spread += weight * d * d.transpose();
      rise += weight * (planes[at(g)].height - planes[at(f)].height) * d;
    });
    const double some = kSpread * spread.trace();
    if (!(some > 0)) return Vector3d::Zero();
    const Eigen::Vector2d slope = (spread + some * Eigen::Matrix2d::Identity()).inverse() * rise;
    return slope[0] * across + slope[1] * along;
  }

  /// With which the facet has its pressure. Newton's method from above: the force is convex in the height.
  double height(int f, const Vector3d& slope) const {
    constexpr int kSteps = 60;
    constexpr double kAccurate = 1e-9;
    const double wanted = pressure[at(f)];
    Plane plane = {wanted, slope};
    for (int step = 0; step < kSteps; ++step) {
      const PressedPart now = part(f, plane, 0.0);
      if (!(now.pressure - wanted > kAccurate * wanted) || !(now.share > 0)) break;
      plane.height -= (now.pressure - wanted) / now.share;
    }
    return plane.height;
  }
};

}  // namespace

std::vector<PressedPart> pressed_parts(const ResultSurface& surface, const std::vector<double>& pressure,
                                       double above) {
  const PressedFacets facets{surface, pressure};
  std::vector<PressedPart> parts(pressure.size());
  std::vector<Plane> planes(pressure.size());
  std::vector<int> edge;
  for (int f = 0; f < surface.facets(); ++f) {
    if (!facets.pressed(f)) continue;
    planes[at(f)].height = pressure[at(f)];
    parts[at(f)] = {1.0, pressure[at(f)]};
    if (facets.at_edge(f, above)) edge.push_back(f);
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (int f : edge) planes[at(f)].slope = facets.slope(f, planes);
    for (int f : edge) planes[at(f)].height = facets.height(f, planes[at(f)].slope);
  }
  for (int f : edge) parts[at(f)] = facets.part(f, planes[at(f)], above);
  return parts;
}

}  // namespace dea

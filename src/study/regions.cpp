#include "src/study/regions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "src/base/error.h"

namespace dea {

namespace {

void require_finite(const std::vector<Vector3d>& points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!points[i].allFinite()) throw UsageError(fmt::format("point {} of {} is nowhere (NaN)", i + 1, points.size()));
}

std::vector<std::string> sector_names(int count) {
  std::vector<std::string> names;
  for (int k = 0; k < count; ++k)
    names.push_back(fmt::format("{:g} to {:g} degrees", 360.0 * k / count, 360.0 * (k + 1) / count));
  return names;
}

/// The angle between the axis and the direction from the centre, 0 to pi.
double angle_to_axis(const Vector3d& x, const SurfaceFrame& frame) {
  const Vector3d d = x - frame.center;
  return std::atan2(frame.axis.cross(d).norm(), frame.axis.dot(d));
}

}  // namespace

Regions sectors(const std::vector<Vector3d>& points, const Vector3d& center, const Vector3d& axis,
                const Vector3d& start, int count) {
  constexpr double kOnAxis = 1e-9;  // of the largest distance from the axis
  constexpr double kBorder = 1e-9;  // of a sector's angle: rounding shall not move a point over its border
  require_finite(points);
  if (count < 1) throw UsageError(fmt::format("{} sectors, expected one or more", count));
  if (!(axis.norm() > 0) || !axis.allFinite()) throw UsageError("the axis of the sectors has no direction");
  const Vector3d along = axis.normalized(), across = start - start.dot(along) * along;
  if (!(across.norm() > 1e-6 * start.norm()) || !start.allFinite())
    throw UsageError("the start of the sectors points along their axis, expected a direction across it");
  const Vector3d first = across.normalized(), second = along.cross(first);
  double farthest = 0.0;
  for (const Vector3d& x : points) farthest = std::max(farthest, along.cross(x - center).norm());
  Regions regions;
  regions.names = sector_names(count);
  for (const Vector3d& x : points) {
    const double u = (x - center).dot(first), v = (x - center).dot(second);
    if (!(std::hypot(u, v) > kOnAxis * farthest)) {
      regions.index.push_back(-1);
      continue;
    }
    const double turns = std::atan2(v, u) / (2 * kPi);
    const int sector = static_cast<int>(std::floor((turns < 0 ? turns + 1 : turns) * count + kBorder));
    regions.index.push_back(sector % count);
  }
  return regions;
}

Regions socket_regions(const std::vector<Vector3d>& points, const SurfaceFrame& frame, const Vector3d& up,
                       const Vector3d& anterior) {
  require_finite(points);
  if (!(frame.axis.norm() > 0)) throw UsageError("the surface is closed and has no axis of its own");
  const std::vector<int> third = third_of(points, frame, up, anterior);
  Regions regions;
  regions.index.assign(points.size(), -1);
  const char* names[3] = {"anterior", "superior", "posterior"};
  for (int k = 0; k < 3; ++k) {
    regions.names.push_back(std::string(names[k]) + " medial");
    regions.names.push_back(std::string(names[k]) + " lateral");
    std::vector<std::pair<double, std::size_t>> deepest_first;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (third[i] == k) deepest_first.push_back({-angle_to_axis(points[i], frame), i});
    std::sort(deepest_first.begin(), deepest_first.end());
    for (std::size_t i = 0; i < deepest_first.size(); ++i)
      regions.index[deepest_first[i].second] = 2 * k + (2 * i < deepest_first.size() ? 0 : 1);
  }
  return regions;
}

Regions laid_out(const std::vector<Vector3d>& points, const SurfaceFrame& frame, const RegionLayout& layout,
                 const Vector3d& up, const Vector3d& anterior) {
  if (layout.socket) return socket_regions(points, frame, up, anterior);
  if (layout.thirds) return {third_of(points, frame, up, anterior), {"anterior", "superior", "posterior"}};
  return sectors(points, frame.center, frame.axis, up, layout.sectors);
}

FacetMask region_mask(const Regions& regions, int region) {
  FacetMask mask;
  for (int index : regions.index) mask.push_back(index == region ? 1 : 0);
  return mask;
}

}  // namespace dea

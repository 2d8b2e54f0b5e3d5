#include "src/build/region.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/build/mend_surface.h"

namespace dea {

namespace {

using Triangle = std::array<int, 3>;

/// Points on the surface's edge.
std::vector<char> rim_points(const TriangleSurface& s) {
  return rim_vertices(s.points.size(), s.triangles, edge_neighbours(s.triangles));
}

/// Distance into the given region, negative outside.
std::vector<double> depth_in(const TriangleSurface& bone, const GivenRegion& given) {
  std::vector<double> depth(bone.points.size());
  if (given.kind == GivenRegion::Kind::Surface) {
    const RayCaster caster(mesh_of(given.surface));
    const double near = std::max(mean_edge(given.surface), mean_edge(bone));
    parallel_for(depth.size(), [&](std::size_t i) { depth[i] = near - distance_to(caster, bone.points[i]); });
    return depth;
  }
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const Eigen::Vector3d away = bone.points[i] - given.point;
    depth[i] = given.kind == GivenRegion::Kind::Sphere ? given.radius - away.norm() : away.dot(given.normal);
  }
  return depth;
}

/// Connected points below zero that are no more than a quarter of what is above, and do not reach the surface's edge,
/// are raised to `level`. Returns how many such holes there were.
int fill_holes(const TriangleSurface& s, std::vector<double>& values, double level) {
  const auto neighbours = vertex_neighbours(s.points.size(), s.triangles);
  const std::vector<double> areas = point_areas(s);
  const std::vector<char> rim = rim_points(s);
  double above = 0;
  for (std::size_t i = 0; i < values.size(); ++i) above += values[i] > 0 ? areas[i] : 0.0;
  std::vector<char> seen(values.size(), 0);
  int filled = 0;
  for (std::size_t first = 0; first < values.size(); ++first) {
    if (seen[first] || values[first] > 0) continue;
    std::vector<std::size_t> hole = {first};
    seen[first] = 1;
    double area = 0;
    bool at_rim = false;
    for (std::size_t i = 0; i < hole.size(); ++i) {
      area += areas[hole[i]];
      at_rim = at_rim || rim[hole[i]];
      for (const int n : neighbours[hole[i]])
        if (!seen[at(n)] && values[at(n)] <= 0) {
          seen[at(n)] = 1;
          hole.push_back(at(n));
        }
    }
    if (at_rim || area > 0.25 * above) continue;
    for (const std::size_t i : hole) values[i] = level;
    ++filled;
  }
  return filled;
}

/// A value within a fifth of an edge from where it passes zero: the point moves there.
void snap_to_zero(TriangleSurface& s, std::vector<double>& values) {
  constexpr double kNear = 0.2;
  const auto neighbours = vertex_neighbours(s.points.size(), s.triangles);
  const std::vector<Eigen::Vector3d> points = s.points;
  const std::vector<double> before = values;
  for (std::size_t i = 0; i < values.size(); ++i) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int count = 0;
    for (const int n : neighbours[i]) {
      if ((before[i] > 0) == (before[at(n)] > 0)) continue;
      const double fraction = before[i] / (before[i] - before[at(n)]);
      if (fraction > kNear) continue;
      sum += points[i] + fraction * (points[at(n)] - points[i]);
      ++count;
    }
    if (count == 0) continue;
    s.points[i] = sum / count;
    values[i] = 0;
  }
}

}  // namespace

SurfaceMesh mesh_of(const TriangleSurface& surface) {
  std::vector<int> begin = {0}, nodes;
  for (const Triangle& t : surface.triangles) {
    nodes.insert(nodes.end(), t.begin(), t.end());
    begin.push_back(static_cast<int>(nodes.size()));
  }
  return make_surface_mesh(begin, nodes, surface.points);
}

double distance_to(const RayCaster& surface, const Eigen::Vector3d& x) {
  return (position(surface.mesh(), surface.closest(x)) - x).norm();
}

std::vector<Eigen::Vector3d> angle_weighted_normals(const SurfaceMesh& mesh) {
  std::vector<Eigen::Vector3d> normals(mesh.vertices.size(), Eigen::Vector3d::Zero());
  for (int t = 0; t < mesh.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d a = mesh.corner(t, (k + 1) % 3) - mesh.corner(t, k),
                            b = mesh.corner(t, (k + 2) % 3) - mesh.corner(t, k);
      normals[at(mesh.triangles[at(t)][at(k)])] += std::atan2(a.cross(b).norm(), a.dot(b)) * mesh.normals[at(t)];
    }
  return normals;
}

namespace {

/// Out of the surface at a point of it, not unit: within a triangle its normal, on an edge the sum of both, at a vertex
/// that of `at_vertices`.
Eigen::Vector3d pseudonormal(const SurfaceMesh& mesh, const std::vector<Eigen::Vector3d>& at_vertices,
                             const SurfacePoint& point) {
  constexpr double kNone = 1e-9;  // barycentric: on the edge
  const std::size_t t = at(point.triangle);
  int zeros = 0;
  std::size_t last_zero = 0, other = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    if (point.weights[k] < kNone) {
      ++zeros;
      last_zero = k;
    } else {
      other = k;
    }
  }
  if (zeros >= 2) return at_vertices[at(mesh.triangles[t][other])];
  if (zeros == 0) return mesh.normals[t];
  const int across = mesh.neighbours[t][(last_zero + 1) % 3];
  return across < 0 ? mesh.normals[t] : Eigen::Vector3d(mesh.normals[t] + mesh.normals[at(across)]);
}

}  // namespace

double signed_distance(const RayCaster& surface, const std::vector<Eigen::Vector3d>& at_vertices,
                       const Eigen::Vector3d& x) {
  const SurfacePoint closest = surface.closest(x);
  const Eigen::Vector3d away = x - position(surface.mesh(), closest);
  return away.dot(pseudonormal(surface.mesh(), at_vertices, closest)) < 0 ? -away.norm() : away.norm();
}

bool on_open_edge(const SurfaceMesh& mesh, const SurfacePoint& point) {
  constexpr double kNone = 1e-9;  // barycentric: on the edge
  for (std::size_t k = 0; k < 3; ++k)
    if (point.weights[k] < kNone && mesh.neighbours[at(point.triangle)][(k + 1) % 3] < 0) return true;
  return false;
}

std::vector<Eigen::Vector3d> point_normals(const TriangleSurface& s) {
  std::vector<Eigen::Vector3d> normals(s.points.size(), Eigen::Vector3d::Zero());
  for (const Triangle& t : s.triangles) {
    const Eigen::Vector3d n = area_vector(s, t);
    for (const int p : t) normals[at(p)] += n;
  }
  for (Eigen::Vector3d& n : normals) n.normalize();
  return normals;
}

std::vector<double> facing_gaps(const std::vector<Eigen::Vector3d>& points, const std::vector<Eigen::Vector3d>& normals,
                                const RayCaster& other, double reach) {
  constexpr double kCos60 = 0.5;
  std::vector<double> gaps(points.size(), kInfinity);
  parallel_for(gaps.size(), [&](std::size_t i) {
    const LineHit hit = other.nearest_facing(points[i], normals[i], 0.0, 0.0, reach, kCos60);
    if (hit.point.triangle >= 0 && hit.distance > 0 && other.within(points[i], 0.5 * hit.distance).empty())
      gaps[i] = hit.distance;
  });
  return gaps;
}

std::vector<double> point_areas(const TriangleSurface& s) {
  std::vector<double> areas(s.points.size(), 0.0);
  for (const Triangle& t : s.triangles) {
    const double area = area_vector(s, t).norm();
    for (const int p : t) areas[at(p)] += area / 3;
  }
  return areas;
}

std::vector<double> smoothed(const TriangleSurface& s, std::vector<double> values, double length) {
  const double edge = mean_edge(s);
  const int steps = static_cast<int>(std::clamp(2 * length * length / (edge * edge), 0.0, 400.0));
  auto neighbours = vertex_neighbours(s.points.size(), s.triangles);
  const std::vector<char> rim = rim_points(s);
  for (std::size_t i = 0; i < neighbours.size(); ++i)
    if (rim[i])
      neighbours[i].erase(
          std::remove_if(neighbours[i].begin(), neighbours[i].end(), [&](int n) { return !rim[at(n)]; }),
          neighbours[i].end());
  std::vector<double> next = values;
  for (int step = 0; step < steps; ++step) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      double change = 0;  // a sum of differences: a constant stays exactly what it is
      for (const int n : neighbours[i]) change += values[at(n)] - values[i];
      next[i] = values[i] + change / static_cast<double>(neighbours[i].size() + 1);
    }
    values.swap(next);
  }
  return values;
}

namespace {

/// What lies where `values` (per point) are above zero; values are linear along edges. Points next to the line move
/// onto it, so that no slivers arise.
TriangleSurface cut_at_zero(const TriangleSurface& surface, std::vector<double> values) {
  TriangleSurface s = surface;
  snap_to_zero(s, values);
  std::map<std::array<int, 2>, int> crossing;
  const auto cross = [&](int a, int b) {
    const std::array<int, 2> edge = {std::min(a, b), std::max(a, b)};
    const auto [place, is_new] = crossing.try_emplace(edge, static_cast<int>(s.points.size()));
    if (is_new) {
      const double f = values[at(edge[0])] / (values[at(edge[0])] - values[at(edge[1])]);
      s.points.push_back(s.points[at(edge[0])] + f * (s.points[at(edge[1])] - s.points[at(edge[0])]));
    }
    return place->second;
  };
  std::vector<Triangle> kept;
  for (const Triangle& t : surface.triangles) {
    std::vector<int> polygon;
    bool inside = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      inside = inside || values[at(a)] > 0;
      if (values[at(a)] >= 0) polygon.push_back(a);
      if (values[at(a)] * values[at(b)] < 0) polygon.push_back(cross(a, b));
    }
    if (!inside || polygon.size() < 3) continue;
    if (polygon.size() == 4) {  // the shorter diagonal
      const auto length = [&](std::size_t i, std::size_t j) {
        return (s.points[at(polygon[i])] - s.points[at(polygon[j])]).norm();
      };
      if (length(1, 3) < length(0, 2)) std::rotate(polygon.begin(), polygon.begin() + 1, polygon.end());
    }
    for (std::size_t k = 1; k + 1 < polygon.size(); ++k) kept.push_back({polygon[0], polygon[k], polygon[k + 1]});
  }
  s.triangles = std::move(kept);
  return part_of(s, std::vector<char>(s.triangles.size(), 1));
}

/// Parts that are large enough.
void leave_small_parts(BoneRegion& region) {
  if (region.surface.triangles.empty()) return;
  const SurfaceParts parts = connected_parts(region.surface);
  constexpr double kLeastPart = 0.05;  // of the largest
  const double least = kLeastPart * *std::max_element(parts.area.begin(), parts.area.end());
  for (const double area : parts.area) region.parts_left_out += !(area >= least);
  region.surface = large_parts(region.surface, parts, least);
}

}  // namespace

BoneRegion find_region(const TriangleSurface& bone, const std::vector<double>& gaps, const RegionOptions& options) {
  BoneRegion region;
  std::vector<double> inside(gaps.size());
  for (std::size_t i = 0; i < gaps.size(); ++i)
    inside[i] = std::clamp(options.reach - gaps[i], -options.reach, options.reach);
  const bool found = !options.given || options.given->kind == GivenRegion::Kind::Plane;
  if (found) {
    inside = smoothed(bone, inside, options.rim_length);
    if (options.fill_holes) {
      region.holes_filled = fill_holes(bone, inside, 0.05 * options.reach);
      if (region.holes_filled > 0) inside = smoothed(bone, inside, mean_edge(bone));
    }
  }
  if (options.given) {
    const std::vector<double> depth = depth_in(bone, *options.given);
    for (std::size_t i = 0; i < inside.size(); ++i) inside[i] = found ? std::min(inside[i], depth[i]) : depth[i];
  }
  region.surface = cut_at_zero(bone, inside);
  leave_small_parts(region);
  return region;
}

void fill_unknown(const TriangleSurface& s, std::vector<double>& values, double none) {
  const auto neighbours = vertex_neighbours(s.points.size(), s.triangles);
  for (bool changed = true; changed;) {
    changed = false;
    const std::vector<double> before = values;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (std::isfinite(before[i])) continue;
      double sum = 0;
      int known = 0;
      for (const int n : neighbours[i])
        if (std::isfinite(before[at(n)])) {
          sum += before[at(n)];
          ++known;
        }
      if (known == 0) continue;
      values[i] = sum / known;
      changed = true;
    }
  }
  for (double& value : values)
    if (!std::isfinite(value)) value = none;
}

std::vector<double> distances_to_rim(const TriangleSurface& s) {
  const auto rim = rim_edges(s.triangles, edge_neighbours(s.triangles));
  std::vector<double> distances(s.points.size(), kInfinity);
  parallel_for(distances.size(), [&](std::size_t i) {
    for (const auto& edge : rim)
      distances[i] =
          std::min(distances[i], distance_to_segment(s.points[i], s.points[at(edge[0])], s.points[at(edge[1])]));
  });
  return distances;
}

}  // namespace dea

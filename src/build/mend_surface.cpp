#include "src/build/mend_surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "src/base/disjoint_sets.h"
#include "src/base/numbers.h"
#include "src/geometry/coincident.h"
#include "src/geometry/surface_mesh.h"

namespace dea {

namespace {

using Eigen::Vector3d;
using Triangle = std::array<int, 3>;

TriangleSurface with_points_once(const TriangleSurface& s, SurfaceFaults& faults) {
  std::vector<int> used;
  for (const Triangle& t : s.triangles) used.insert(used.end(), t.begin(), t.end());
  const auto stands_for = coincident_nodes(used, s.points, 1e-7 * size_of(s));
  TriangleSurface result;
  std::vector<int> now(s.points.size(), -1);
  std::set<Triangle> seen;
  for (const Triangle& t : s.triangles) {
    Triangle corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto other = stands_for.find(t[k]);
      const int point = other == stands_for.end() ? t[k] : other->second;
      if (now[at(point)] < 0) {
        now[at(point)] = static_cast<int>(result.points.size());
        result.points.push_back(s.points[at(point)]);
      }
      corners[k] = now[at(point)];
    }
    Triangle sorted = corners;
    std::sort(sorted.begin(), sorted.end());
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k)
      longest = std::max(longest, (result.points[at(corners[k])] - result.points[at(corners[(k + 1) % 3])]).norm());
    if (sorted[0] == sorted[1] || sorted[1] == sorted[2] ||
        area_vector(result, corners).norm() < 1e-9 * longest * longest)
      ++faults.degenerate;
    else if (!seen.insert(sorted).second)
      ++faults.duplicate;
    else
      result.triangles.push_back(corners);
  }
  return result;
}

/// Neighbours that run along their common edge the same way disagree; the fewer triangles of a part are turned.
void orient(TriangleSurface& s, SurfaceFaults& faults) {
  const auto neighbours = edge_neighbours(s.triangles);
  std::vector<int> side(s.triangles.size(), 0);
  for (std::size_t first = 0; first < side.size(); ++first) {
    if (side[first] != 0) continue;
    std::vector<std::size_t> part = {first};
    side[first] = 1;
    std::size_t turned = 0;
    for (std::size_t i = 0; i < part.size(); ++i) {
      const Triangle& t = s.triangles[part[i]];
      for (std::size_t k = 0; k < 3; ++k) {
        const int other = neighbours[part[i]][k];
        if (other < 0) continue;
        const Triangle& o = s.triangles[at(other)];
        bool same_way = false;
        for (std::size_t j = 0; j < 3; ++j) same_way = same_way || (o[j] == t[k] && o[(j + 1) % 3] == t[(k + 1) % 3]);
        const int wanted = same_way ? -side[part[i]] : side[part[i]];
        if (side[at(other)] == 0) {
          side[at(other)] = wanted;
          turned += wanted < 0;
          part.push_back(at(other));
        } else if (side[at(other)] != wanted) {
          faults.not_orientable = true;
        }
      }
    }
    const int turn = 2 * turned > part.size() ? 1 : -1;
    for (const std::size_t t : part)
      if (side[t] == turn) {
        std::swap(s.triangles[t][1], s.triangles[t][2]);
        ++faults.flipped;
      }
  }
}

/// Corners of a triangle that only hang together at a point, or at an edge of many triangles, become points of their
/// own: every edge then has at most two triangles.
void cut_loose(TriangleSurface& s) {
  const auto neighbours = edge_neighbours(s.triangles);
  std::vector<Vector3d> points;
  std::vector<Triangle> triangles(s.triangles.size(), Triangle{-1, -1, -1});
  for (std::size_t t = 0; t < s.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (triangles[t][k] >= 0) continue;
      const int point = s.triangles[t][k];
      std::vector<std::size_t> fan = {t};  // the triangles around the point that edges join
      points.push_back(s.points[at(point)]);
      const auto corner = [&](std::size_t of) {
        const Triangle& c = s.triangles[of];
        return static_cast<std::size_t>(c[0] == point ? 0 : c[1] == point ? 1 : 2);
      };
      triangles[t][k] = static_cast<int>(points.size()) - 1;
      for (std::size_t i = 0; i < fan.size(); ++i) {
        const std::size_t c = corner(fan[i]);
        for (const std::size_t edge : {c, (c + 2) % 3}) {
          const int other = neighbours[fan[i]][edge];
          if (other < 0 || triangles[at(other)][corner(at(other))] >= 0) continue;
          triangles[at(other)][corner(at(other))] = static_cast<int>(points.size()) - 1;
          fan.push_back(at(other));
        }
      }
    }
  }
  s = {std::move(points), std::move(triangles)};
}

/// Loose parts below 1 % of the whole area.
TriangleSurface without_islands(const TriangleSurface& s, SurfaceFaults& faults) {
  const SurfaceParts parts = connected_parts(s);
  const double least = 0.01 * area_of(s);
  for (const double area : parts.area) (area < least ? faults.islands : faults.parts) += 1;
  if (faults.islands == 0) return s;
  TriangleSurface kept = large_parts(s, parts, least);
  faults.island_triangles = s.triangles.size() - kept.triangles.size();
  return kept;
}

void count_rims(const TriangleSurface& s, SurfaceFaults& faults) {
  const auto rim = rim_edges(s.triangles, edge_neighbours(s.triangles));
  faults.rim_edges = rim.size();
  std::map<int, int> next;
  for (const auto& edge : rim) next[edge[0]] = edge[1];
  while (!next.empty()) {
    ++faults.holes;
    for (auto place = next.begin(); place != next.end();) {
      const int to = place->second;
      next.erase(place);
      place = next.find(to);
    }
  }
}

/// A part without a rim encloses a volume: its sign tells the outside.
void turn_outwards(TriangleSurface& s, SurfaceFaults& faults) {
  const SurfaceParts parts = connected_parts(s);
  const std::vector<int>& part = parts.part;
  const auto neighbours = edge_neighbours(s.triangles);
  std::vector<char> open(parts.area.size(), 0);
  std::vector<double> volume(parts.area.size(), 0.0);
  const Vector3d origin = s.points[at(s.triangles[0][0])];
  for (std::size_t t = 0; t < part.size(); ++t) {
    for (const int n : neighbours[t]) open[at(part[t])] |= n < 0;
    volume[at(part[t])] += area_vector(s, s.triangles[t]).dot(s.points[at(s.triangles[t][0])] - origin);
  }
  for (std::size_t t = 0; t < part.size(); ++t)
    if (!open[at(part[t])] && volume[at(part[t])] < 0) {
      std::swap(s.triangles[t][1], s.triangles[t][2]);
      faults.turned_inside_out = true;
    }
}

}  // namespace

Vector3d area_vector(const TriangleSurface& s, const Triangle& t) {
  const Vector3d& a = s.points[at(t[0])];
  return 0.5 * (s.points[at(t[1])] - a).cross(s.points[at(t[2])] - a);
}

SurfaceParts connected_parts(const TriangleSurface& s) {
  const auto neighbours = edge_neighbours(s.triangles);
  DisjointSets joined(s.triangles.size());
  for (std::size_t t = 0; t < neighbours.size(); ++t)
    for (const int n : neighbours[t])
      if (n >= 0) joined.join(static_cast<int>(t), n);
  SurfaceParts parts;
  for (std::size_t t = 0; t < neighbours.size(); ++t) {
    const std::size_t first = at(joined.root(static_cast<int>(t)));  // the least, so it has its part already
    if (first == t) parts.area.push_back(0.0);
    parts.part.push_back(first == t ? static_cast<int>(parts.area.size()) - 1 : parts.part[first]);
    parts.area[at(parts.part[t])] += area_vector(s, s.triangles[t]).norm();
  }
  return parts;
}

TriangleSurface large_parts(const TriangleSurface& s, const SurfaceParts& parts, double least) {
  std::vector<char> wanted(s.triangles.size());
  for (std::size_t t = 0; t < wanted.size(); ++t) wanted[t] = parts.area[at(parts.part[t])] >= least;
  return part_of(s, wanted);
}

TriangleSurface part_of(const TriangleSurface& s, const std::vector<char>& wanted) {
  TriangleSurface result;
  std::vector<int> now(s.points.size(), -1);
  for (std::size_t t = 0; t < s.triangles.size(); ++t) {
    if (!wanted[t]) continue;
    Triangle corners;
    for (std::size_t k = 0; k < 3; ++k) {
      int& p = now[at(s.triangles[t][k])];
      if (p < 0) {
        p = static_cast<int>(result.points.size());
        result.points.push_back(s.points[at(s.triangles[t][k])]);
      }
      corners[k] = p;
    }
    result.triangles.push_back(corners);
  }
  return result;
}

MendedSurface mend_surface(const TriangleSurface& surface) {
  MendedSurface mended;
  SurfaceFaults& faults = mended.faults;
  TriangleSurface& s = mended.surface;
  s = with_points_once(surface, faults);
  if (s.triangles.empty()) return mended;
  edge_neighbours(s.triangles, false, &faults.non_manifold);
  orient(s, faults);
  cut_loose(s);
  s = without_islands(s, faults);
  if (s.triangles.empty()) return mended;
  turn_outwards(s, faults);
  count_rims(s, faults);
  return mended;
}

std::vector<std::string> fault_words(const SurfaceFaults& f) {
  std::vector<std::string> words;
  const auto add = [&](std::size_t count, const char* one, const char* many) {
    if (count > 0) words.push_back(fmt::format("{} {}", count, count == 1 ? one : many));
  };
  add(f.degenerate, "triangle of no area left out", "triangles of no area left out");
  add(f.duplicate, "triangle left out that is there twice", "triangles left out that are there twice");
  add(f.flipped, "triangle turned", "triangles turned");
  if (f.turned_inside_out) words.push_back("was inside out, turned");
  if (f.islands > 0)
    words.push_back(fmt::format("{} loose part{} of {} triangles left out", f.islands, f.islands > 1 ? "s" : "",
                                f.island_triangles));
  add(f.non_manifold, "edge of more than two triangles, cut there", "edges of more than two triangles, cut there");
  add(f.holes, "open rim", "open rims");
  if (f.parts > 1) add(f.parts, "part", "parts");
  if (f.not_orientable) words.push_back("has no outside, like a Moebius strip");
  return words;
}

double area_of(const TriangleSurface& s) {
  double area = 0;
  for (const Triangle& t : s.triangles) area += area_vector(s, t).norm();
  return area;
}

Eigen::AlignedBox3d box_of(const TriangleSurface& s) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& x : s.points) box.extend(x);
  return box;
}

double size_of(const TriangleSurface& s) { return box_of(s).diagonal().norm(); }

double mean_edge(const TriangleSurface& s) {
  double sum = 0;
  for (const Triangle& t : s.triangles)
    for (std::size_t k = 0; k < 3; ++k) sum += (s.points[at(t[k])] - s.points[at(t[(k + 1) % 3])]).norm();
  return sum / std::max(1.0, 3.0 * static_cast<double>(s.triangles.size()));
}

}  // namespace dea

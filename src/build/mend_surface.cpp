#include "src/build/mend_surface.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <unordered_map>

#include "src/base/numbers.h"

namespace dea {

namespace {

using Eigen::Vector3d;
using Triangle = std::array<int, 3>;

Vector3d area_vector(const TriangleSurface& s, const Triangle& t) {
  const Vector3d& a = s.points[at(t[0])];
  return 0.5 * (s.points[at(t[1])] - a).cross(s.points[at(t[2])] - a);
}

/// Points at one place become one: cells of a grid a little larger than the tolerance, each looked up with its
/// neighbours.
class PointMerger {
 public:
  explicit PointMerger(double tolerance) : tolerance_(tolerance) {}

  int merged(const Vector3d& x, std::vector<Vector3d>& points) {
    const Eigen::Array3d scaled = x.array() / (2 * tolerance_);
    for (int corner = 0; corner < 8; ++corner) {  // the cells that the point's surroundings reach
      Eigen::Array3d cell;
      for (int c = 0; c < 3; ++c) cell[c] = std::floor(scaled[c] + ((corner >> c & 1) != 0 ? 0.5 : -0.5));
      const auto found = cells_.find(key(cell));
      if (found == cells_.end()) continue;
      for (const int other : found->second)
        if ((points[at(other)] - x).norm() <= tolerance_) return other;
    }
    points.push_back(x);
    cells_[key(scaled.floor())].push_back(static_cast<int>(points.size()) - 1);
    return static_cast<int>(points.size()) - 1;
  }

 private:
  static std::uint64_t key(const Eigen::Array3d& cell) {
    std::uint64_t k = 0;
    for (int c = 0; c < 3; ++c)
      k = (k ^ static_cast<std::uint64_t>(static_cast<std::int64_t>(cell[c]))) * 0x9E3779B97F4A7C15ULL;
    return k;
  }
  double tolerance_;
  std::unordered_map<std::uint64_t, std::vector<int>> cells_;
};

TriangleSurface with_points_once(const TriangleSurface& s, SurfaceFaults& faults) {
  PointMerger merger(std::max(1e-7 * size_of(s), 1e-300));
  TriangleSurface result;
  std::vector<int> now(s.points.size(), -1);
  std::set<Triangle> seen;
  std::size_t used = 0;
  for (const Triangle& t : s.triangles) {
    Triangle corners;
    for (std::size_t k = 0; k < 3; ++k) {
      int& p = now[at(t[k])];
      if (p < 0) {
        p = merger.merged(s.points[at(t[k])], result.points);
        ++used;
      }
      corners[k] = p;
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
  faults.unused_points = s.points.size() - used;
  faults.merged_points = used - result.points.size();
  return result;
}

/// Neighbours that run along their common edge the same way disagree; the fewer triangles of a part are turned.
void orient(TriangleSurface& s, SurfaceFaults& faults) {
  const auto neighbours = edge_neighbours(s);
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
  const auto neighbours = edge_neighbours(s);
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
  const std::vector<int> part = connected_parts(s);
  std::vector<double> area(static_cast<std::size_t>(1 + *std::max_element(part.begin(), part.end())), 0.0);
  double whole = 0;
  for (std::size_t t = 0; t < part.size(); ++t) {
    const double a = area_vector(s, s.triangles[t]).norm();
    area[at(part[t])] += a;
    whole += a;
  }
  std::vector<char> wanted(part.size());
  for (std::size_t t = 0; t < part.size(); ++t) wanted[t] = area[at(part[t])] >= 0.01 * whole;
  for (const double a : area) (a < 0.01 * whole ? faults.islands : faults.parts) += 1;
  if (faults.islands == 0) return s;
  faults.island_triangles = static_cast<std::size_t>(std::count(wanted.begin(), wanted.end(), 0));
  return part_of(s, wanted);
}

void count_rims(const TriangleSurface& s, SurfaceFaults& faults) {
  std::map<int, int> next;
  const auto neighbours = edge_neighbours(s);
  for (std::size_t t = 0; t < neighbours.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      if (neighbours[t][k] < 0) {
        next[s.triangles[t][k]] = s.triangles[t][(k + 1) % 3];
        ++faults.rim_edges;
      }
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
  const std::vector<int> part = connected_parts(s);
  const auto neighbours = edge_neighbours(s);
  const auto parts = static_cast<std::size_t>(1 + *std::max_element(part.begin(), part.end()));
  std::vector<char> open(parts, 0);
  std::vector<double> volume(parts, 0.0);
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

std::vector<std::array<int, 3>> edge_neighbours(const TriangleSurface& s, std::size_t* non_manifold) {
  struct Side {
    std::uint64_t edge;
    int triangle;
    int k;
  };
  std::vector<Side> sides;
  sides.reserve(3 * s.triangles.size());
  for (std::size_t t = 0; t < s.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto a = static_cast<std::uint64_t>(s.triangles[t][at(k)]),
                 b = static_cast<std::uint64_t>(s.triangles[t][at((k + 1) % 3)]);
      sides.push_back({std::min(a, b) << 32 | std::max(a, b), static_cast<int>(t), k});
    }
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b) { return a.edge != b.edge ? a.edge < b.edge : a.triangle < b.triangle; });
  std::vector<std::array<int, 3>> neighbours(s.triangles.size(), {-1, -1, -1});
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i;
    while (end < sides.size() && sides[end].edge == sides[i].edge) ++end;
    if (end - i == 2) {
      neighbours[at(sides[i].triangle)][at(sides[i].k)] = sides[i + 1].triangle;
      neighbours[at(sides[i + 1].triangle)][at(sides[i + 1].k)] = sides[i].triangle;
    } else if (end - i > 2 && non_manifold != nullptr) {
      ++*non_manifold;
    }
    i = end;
  }
  return neighbours;
}

std::vector<int> connected_parts(const TriangleSurface& s) {
  const auto neighbours = edge_neighbours(s);
  std::vector<int> part(s.triangles.size(), -1);
  int parts = 0;
  for (std::size_t first = 0; first < part.size(); ++first) {
    if (part[first] >= 0) continue;
    std::vector<std::size_t> open = {first};
    part[first] = parts;
    while (!open.empty()) {
      const std::size_t t = open.back();
      open.pop_back();
      for (const int n : neighbours[t])
        if (n >= 0 && part[at(n)] < 0) {
          part[at(n)] = parts;
          open.push_back(at(n));
        }
    }
    ++parts;
  }
  return part;
}

TriangleSurface part_of(const TriangleSurface& s, const std::vector<char>& wanted, std::vector<int>* from) {
  TriangleSurface result;
  std::vector<int> now(s.points.size(), -1);
  if (from != nullptr) from->clear();
  for (std::size_t t = 0; t < s.triangles.size(); ++t) {
    if (!wanted[t]) continue;
    Triangle corners;
    for (std::size_t k = 0; k < 3; ++k) {
      int& p = now[at(s.triangles[t][k])];
      if (p < 0) {
        p = static_cast<int>(result.points.size());
        result.points.push_back(s.points[at(s.triangles[t][k])]);
        if (from != nullptr) from->push_back(s.triangles[t][k]);
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
  edge_neighbours(s, &faults.non_manifold);
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

double volume_of(const TriangleSurface& s) {
  double volume = 0;
  for (const Triangle& t : s.triangles) volume += area_vector(s, t).dot(s.points[at(t[0])] - s.points[0]) / 3;
  return volume;
}

std::array<Vector3d, 2> box_of(const TriangleSurface& s) {
  std::array<Vector3d, 2> box = {Vector3d::Constant(kInfinity), Vector3d::Constant(-kInfinity)};
  for (const Vector3d& x : s.points) {
    box[0] = box[0].cwiseMin(x);
    box[1] = box[1].cwiseMax(x);
  }
  return box;
}

double size_of(const TriangleSurface& s) {
  const auto box = box_of(s);
  return (box[1] - box[0]).norm();
}

double mean_edge(const TriangleSurface& s) {
  double sum = 0;
  for (const Triangle& t : s.triangles)
    for (std::size_t k = 0; k < 3; ++k) sum += (s.points[at(t[k])] - s.points[at(t[(k + 1) % 3])]).norm();
  return sum / std::max(1.0, 3.0 * static_cast<double>(s.triangles.size()));
}

}  // namespace dea

#include "src/build/sound_columns.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/build/mend_surface.h"
#include "src/build/region.h"
#include "src/geometry/surface_mesh.h"

namespace dea {

namespace {

using Eigen::Vector3d;
using Triangle = std::array<int, 3>;

/// A column below is not sound (89 degrees).
constexpr double kLeastSound = 0.0173;
/// What columns are to have where some were not sound (87 degrees): elements are to serve, not only to be valid.
constexpr double kLeastMended = 0.05;
/// What lines from bone to surface are smoothed for, where some column is not sound: 84 degrees, and the smaller of a
/// column's triangles a tenth of the larger.
constexpr double kGoodSound = 0.1;

constexpr int kBatches = 14;          // of smoothing, each from one more ring of neighbours
constexpr int kGoalBatches = 12;      // of them where all columns are sound
constexpr int kBatchesAgain = 4;      // after something else gave way
constexpr int kSweeps = 5;            // in a batch
constexpr int kRimRounds = 4;         // in which the rim gives way
constexpr double kMostRim = 0.03;     // of the area: more is not taken from the rim before the rest has been tried
constexpr int kFirstMoveRounds = 4;   // in which points are spread before the rim gives way
constexpr int kMoveRounds = 12;       // and after it
constexpr int kFoldRounds = 4;        // in which columns are left out that cannot be seen along their lines
constexpr int kThinRounds = 12;       // in which the layer becomes thinner
constexpr double kLeastPiece = 0.05;  // of the largest: smaller parts are left out

/// Of a vertex. Means with these weights keep what is linear in a plane (mean value coordinates), however uneven the
/// triangles are.
struct Neighbour {
  int vertex;
  double weight;
};

struct Column {
  double cosine = 1.0;  ///< least
  double area = 1.0;    ///< the smallest triangle's, of the largest
};

Column column_of(const BuiltLayer& layer, const Triangle& t, int elements_through) {
  std::array<Vector3d, 3> line;
  for (std::size_t k = 0; k < 3; ++k) line[k] = layer.articular[at(t[k])] - layer.bone[at(t[k])];
  const auto normal = [&](double z) {
    const auto point = [&](std::size_t k) { return Vector3d(layer.bone[at(t[k])] + z * line[k]); };
    return Vector3d((point(1) - point(0)).cross(point(2) - point(0)));
  };
  Column column;
  double smallest = kInfinity, largest = 0;
  for (int e = 0; e <= elements_through; ++e) {
    const Vector3d n = normal(static_cast<double>(e) / elements_through);
    const double area = n.norm();
    smallest = std::min(smallest, area);
    largest = std::max(largest, area);
    for (const Vector3d& c : line) {
      const double scale = area * c.norm();
      column.cosine = std::min(column.cosine, scale > 0 ? n.dot(c) / scale : -1.0);
    }
  }
  column.area = largest > 0 ? smallest / largest : 0.0;
  const Vector3d below = normal(0), middle = normal(0.5), above = normal(1);
  for (const Vector3d& c : line) {  // the parabola between the heights that were looked at
    const double f0 = below.dot(c), f1 = above.dot(c), fh = middle.dot(c);
    const double a = 2 * f0 - 4 * fh + 2 * f1, b = -3 * f0 + 4 * fh - f1;
    double least = std::min(f0, f1);
    if (a > 0 && b < 0 && -b < 2 * a) least = f0 - b * b / (4 * a);
    if (!(least > 1e-6 * std::max(f0, f1))) column.cosine = -1;
  }
  return column;
}

/// A layer at work.
struct Sheet {
  BuiltLayer& layer;
  const SoundOptions& options;
  std::vector<Vector3d> direction;  ///< per vertex, from the side that stays
  std::vector<double> length;
  std::vector<int> was;  ///< per vertex: its number at the start
  std::vector<std::vector<Neighbour>> around;
  std::vector<std::vector<int>> neighbours;
  std::vector<char> rim;
  std::vector<double> soundness, goodness;  ///< per triangle: cosine; the least of cosine and area
  double area_lost = 0.0;
  std::vector<Vector3d> start;  ///< per vertex of the side that stays: where it was
  std::vector<Vector3d> first_direction;
  std::vector<double> first_length;
  std::vector<double> reach;  ///< per vertex: how far it may move from there

  std::vector<Vector3d>& fixed() { return options.bone_stays ? layer.bone : layer.articular; }
  std::vector<Vector3d>& moving() { return options.bone_stays ? layer.articular : layer.bone; }
};

void look_around(Sheet& s) {
  const std::vector<Vector3d>& x = s.fixed();
  s.neighbours = vertex_neighbours(x.size(), s.layer.triangles);
  s.rim = rim_vertices(x.size(), s.layer.triangles, edge_neighbours(s.layer.triangles));
  s.around.assign(x.size(), {});
  for (std::size_t v = 0; v < x.size(); ++v)
    for (const int n : s.neighbours[v]) s.around[v].push_back({n, 0.0});
  const auto add = [&](int v, int n, double weight) {
    for (Neighbour& other : s.around[at(v)])
      if (other.vertex == n) other.weight += weight;
  };
  for (const Triangle& t : s.layer.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const int v = t[k], p = t[(k + 1) % 3], q = t[(k + 2) % 3];
      const Vector3d a = x[at(p)] - x[at(v)], b = x[at(q)] - x[at(v)];
      const double half = std::tan(0.5 * std::atan2(a.cross(b).norm(), a.dot(b)));
      if (a.norm() > 0) add(v, p, std::min(half, 1e3) / a.norm());
      if (b.norm() > 0) add(v, q, std::min(half, 1e3) / b.norm());
    }
}

void judge(Sheet& s) {
  s.soundness.resize(s.layer.triangles.size());
  s.goodness.resize(s.layer.triangles.size());
  parallel_for(
      s.layer.triangles.size(),
      [&](std::size_t t) {
        const Column column = column_of(s.layer, s.layer.triangles[t], s.options.elements_through);
        s.soundness[t] = column.cosine;
        s.goodness[t] = std::min(column.cosine, column.area);
      },
      256);
}

bool any_below(const std::vector<double>& values, double least) {
  return std::any_of(values.begin(), values.end(), [&](double x) { return x < least; });
}

/// Vertices of the triangles whose value is below, and so many rings around them.
std::vector<char> vertices_below(const Sheet& s, const std::vector<double>& values, double least, int rings) {
  std::vector<char> found(s.direction.size(), 0);
  for (std::size_t t = 0; t < values.size(); ++t)
    if (values[t] < least)
      for (const int v : s.layer.triangles[t]) found[at(v)] = 1;
  for (int ring = 0; ring < rings; ++ring) {
    const std::vector<char> before = found;
    for (std::size_t v = 0; v < found.size(); ++v)
      if (before[v])
        for (const int n : s.neighbours[v]) found[at(n)] = 1;
  }
  return found;
}

void place(Sheet& s, std::size_t v) { s.moving()[v] = s.fixed()[v] + s.length[v] * s.direction[v]; }

void smooth_directions(Sheet& s, const std::vector<char>& which) {
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    const std::vector<Vector3d> before = s.direction;
    parallel_for(
        which.size(),
        [&](std::size_t v) {
          if (!which[v]) return;
          Vector3d sum = Vector3d::Zero();
          double weights = 0;
          for (const Neighbour& n : s.around[v]) {
            sum += n.weight * before[at(n.vertex)];
            weights += n.weight;
          }
          if (!(weights > 0)) return;
          sum = sum / weights + before[v];
          if (sum.norm() > 1e-3) s.direction[v] = sum.normalized();
        },
        256);
  }
  parallel_for(
      which.size(),
      [&](std::size_t v) {
        if (!which[v]) return;
        const double cast = s.options.recast ? s.options.recast(s.fixed()[v], s.direction[v], s.length[v]) : kNaN;
        if (std::isfinite(cast)) s.length[v] = cast;
        place(s, v);
      },
      64);
}

/// From the columns that are not good outwards, ring by ring.
void smooth(Sheet& s, int batches) {
  judge(s);
  for (int batch = 0; batch < batches; ++batch) {
    if (!any_below(s.goodness, kGoodSound) || (batch >= kGoalBatches && !any_below(s.soundness, kLeastMended))) return;
    smooth_directions(s, vertices_below(s, s.goodness, kGoodSound, 2 + batch));
    judge(s);
  }
}

/// Points of the side that stays towards the middle of their neighbours, across the lines through the layer: what folds
/// comes apart, and the surface's height stays.
void spread_points(Sheet& s) {
  const std::vector<char> which = vertices_below(s, s.soundness, kLeastMended, 1);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    const std::vector<Vector3d> before = s.fixed();
    for (std::size_t v = 0; v < which.size(); ++v) {
      if (!which[v] || s.rim[v] || s.neighbours[v].empty()) continue;
      Vector3d middle = Vector3d::Zero();
      for (const int n : s.neighbours[v]) middle += before[at(n)] / static_cast<double>(s.neighbours[v].size());
      Vector3d shift = 0.5 * (middle - before[v]);
      shift -= shift.dot(s.direction[v]) * s.direction[v];
      const Vector3d moved = s.fixed()[v] + shift - s.start[v];
      s.fixed()[v] = s.start[v] + std::min(1.0, s.reach[v] / std::max(1e-300, moved.norm())) * moved;
      place(s, v);
    }
  }
  look_around(s);
}

/// Points may move by half of what they are away from their neighbours: more than a fold of that size is no roughness.
void limit_moves(Sheet& s) {
  s.start = s.fixed();
  s.reach.assign(s.start.size(), 0.0);
  for (std::size_t v = 0; v < s.start.size(); ++v)
    for (const int n : s.neighbours[v])
      s.reach[v] += 0.5 * (s.start[at(n)] - s.start[v]).norm() / static_cast<double>(s.neighbours[v].size());
}

/// Where spreading did not help, points go back.
void take_back_moves(Sheet& s) {
  const std::vector<char> which = vertices_below(s, s.soundness, kLeastMended, 3);
  for (std::size_t v = 0; v < which.size(); ++v) {
    if (!which[v]) continue;
    s.fixed()[v] = s.start[v];
    place(s, v);
  }
  look_around(s);
  smooth_directions(s, which);
  judge(s);
}

void thin(Sheet& s) {
  const std::vector<char> core = vertices_below(s, s.soundness, kLeastMended, 0),
                          around = vertices_below(s, s.soundness, kLeastMended, 1);
  for (std::size_t v = 0; v < core.size(); ++v) {
    if (!around[v]) continue;
    s.length[v] *= core[v] ? 0.8 : 0.9;
    place(s, v);
  }
}

template <class Value>
void keep(std::vector<Value>& values, const std::vector<int>& from) {
  if (values.empty()) return;
  std::vector<Value> kept;
  for (const int v : from) kept.push_back(values[at(v)]);
  values = std::move(kept);
}

/// Leaves columns out, and what then is a small part by itself.
void leave_out(Sheet& s, const std::vector<char>& out) {
  const double area = area_of(s.layer.face());
  std::vector<Triangle> triangles;
  for (std::size_t t = 0; t < out.size(); ++t)
    if (!out[t]) triangles.push_back(s.layer.triangles[t]);
  TriangleSurface rest{s.fixed(), triangles};
  if (!triangles.empty()) {
    const SurfaceParts parts = connected_parts(rest);
    const double least = kLeastPiece * *std::max_element(parts.area.begin(), parts.area.end());
    std::vector<Triangle> large;
    for (std::size_t t = 0; t < triangles.size(); ++t)
      if (parts.area[at(parts.part[t])] >= least) large.push_back(triangles[t]);
    triangles = std::move(large);
  }
  std::vector<int> now(s.direction.size(), -1), from;
  for (Triangle& t : triangles)
    for (int& v : t) {
      if (now[at(v)] < 0) {
        now[at(v)] = static_cast<int>(from.size());
        from.push_back(v);
      }
      v = now[at(v)];
    }
  s.layer.triangles = std::move(triangles);
  keep(s.layer.bone, from);
  keep(s.layer.articular, from);
  keep(s.direction, from);
  keep(s.length, from);
  keep(s.was, from);
  keep(s.start, from);
  keep(s.first_direction, from);
  keep(s.first_length, from);
  keep(s.reach, from);
  s.area_lost += area - area_of(s.layer.face());
  look_around(s);
  judge(s);
}

bool any_of(const std::vector<char>& which) { return std::find(which.begin(), which.end(), 1) != which.end(); }

/// Columns that are not sound; `at_rim`: those with a corner on the rim.
std::vector<char> not_sound(const Sheet& s, bool at_rim) {
  std::vector<char> out(s.soundness.size(), 0);
  for (std::size_t t = 0; t < out.size(); ++t) {
    const Triangle& corners = s.layer.triangles[t];
    const bool on_rim = std::any_of(corners.begin(), corners.end(), [&](int v) { return s.rim[at(v)] != 0; });
    out[t] = s.soundness[t] < kLeastMended && (on_rim || !at_rim);
  }
  return out;
}

/// Columns whose triangle on the side that stays cannot be seen along the lines through the layer: no thickness helps.
std::vector<char> folded(Sheet& s) {
  const std::vector<Vector3d>& x = s.fixed();
  const double up = s.options.bone_stays ? 1 : -1;  // directions lead away from the side that stays
  std::vector<char> out(s.soundness.size(), 0);
  for (std::size_t t = 0; t < out.size(); ++t) {
    if (s.soundness[t] >= kLeastMended) continue;
    const Triangle& k = s.layer.triangles[t];
    const Vector3d n = (x[at(k[1])] - x[at(k[0])]).cross(x[at(k[2])] - x[at(k[0])]);
    for (const int v : k) out[t] |= up * n.dot(s.direction[at(v)]) < kLeastMended * n.norm();
  }
  return out;
}

/// What was smoothed around columns that are now left out is as it was wanted.
void start_again(Sheet& s) {
  s.fixed() = s.start;
  s.direction = s.first_direction;
  s.length = s.first_length;
  for (std::size_t v = 0; v < s.start.size(); ++v) place(s, v);
  look_around(s);
}

void spread(Sheet& s, int rounds) {
  for (int round = 0; round < rounds && any_of(not_sound(s, false)); ++round) {
    spread_points(s);
    smooth(s, kBatchesAgain);
  }
}

/// One thing after the other, the mildest first. Ends with sound columns alone, for the last step leaves the others
/// out.
void give_way(Sheet& s) {
  const double area = area_of(s.layer.face());
  limit_moves(s);
  for (int fold = 0; fold < kFoldRounds; ++fold) {
    smooth(s, kBatches);
    spread(s, kFirstMoveRounds);
    if (any_of(not_sound(s, true))) take_back_moves(s);
    for (int round = 0; round < kRimRounds && any_of(not_sound(s, true)) && s.area_lost < kMostRim * area; ++round) {
      leave_out(s, not_sound(s, true));
      smooth(s, kBatchesAgain);
    }
    spread(s, kMoveRounds);
    const std::vector<char> out = folded(s);
    if (!any_of(out)) break;
    leave_out(s, out);
    if (fold + 1 < kFoldRounds) start_again(s);
  }
  judge(s);
  for (int round = 0; round < kThinRounds && any_of(not_sound(s, false)); ++round) {
    thin(s);
    judge(s);
  }
  if (any_of(not_sound(s, false))) leave_out(s, not_sound(s, false));
}

/// The layer as it was.
struct Wanted {
  BuiltLayer layer;
  std::vector<Vector3d> direction;
  std::vector<double> length;
};

/// Heights above a surface, < 0: below it; of points that are where they were: 0.
std::vector<double> heights_of_moved(const RayCaster& surface, const std::vector<Vector3d>& now,
                                     const std::vector<Vector3d>& before, const std::vector<int>& was) {
  const std::vector<Vector3d> normals = angle_weighted_normals(surface.mesh());
  std::vector<double> heights(now.size(), 0.0);
  parallel_for(now.size(), [&](std::size_t v) {
    if (now[v] != before[at(was[v])]) heights[v] = signed_distance(surface, normals, now[v]);
  });
  return heights;
}

/// The thickness changes by how far either side leaves the surface that it was to lie on, or by what the line through
/// the layer is longer across it, if that is less. That does not depend on how the line is turned, nor on how rough the
/// surfaces are.
void add_changes(const Sheet& s, const Wanted& wanted, SheetChanges& changes) {
  const bool stays = s.options.bone_stays;
  const RayCaster bone = s.options.bone != nullptr ? *s.options.bone
                                                   : RayCaster(mesh_of({wanted.layer.bone, wanted.layer.triangles})),
                  face(mesh_of(wanted.layer.face()));
  std::vector<double> below = heights_of_moved(bone, s.layer.bone, wanted.layer.bone, s.was);
  const std::vector<double> above = heights_of_moved(face, s.layer.articular, wanted.layer.articular, s.was);
  double most_turned = 0;
  for (std::size_t v = 0; v < s.was.size(); ++v) {
    const std::size_t w = at(s.was[v]);
    const Vector3d &is = s.direction[v], &was = wanted.direction[w];
    const double turn = std::atan2(is.cross(was).norm(), is.dot(was));
    const double move = stays ? (s.layer.bone[v] - wanted.layer.bone[w]).norm()
                              : (s.layer.articular[v] - wanted.layer.articular[w]).norm();
    // raised to the least thickness: into the bone
    if (s.length[v] <= (1 + 1e-6) * s.options.least) below[v] = std::max(0.0, below[v]);
    // where there is no bone beneath, the length tells
    const double change = above[v] - below[v], longer = s.length[v] * std::cos(turn) - wanted.length[w];
    changes.change[v] += std::abs(longer) < std::abs(change) ? longer : change;
    changes.turned += turn > 1e-9;
    changes.moved += move > 0;
    changes.most_moved = std::max(changes.most_moved, move);
    if (turn > most_turned) changes.where = s.layer.articular[v];
    most_turned = std::max(most_turned, turn);
  }
  changes.most_turned = std::max(changes.most_turned, most_turned);
}

}  // namespace

bool much_changed(const SheetChanges& changes) {
  return changes.changed_part > kMuchArea || changes.lost_part() > kMuchArea;
}

double column_soundness(const BuiltLayer& layer, const Triangle& triangle, int elements_through) {
  return column_of(layer, triangle, elements_through).cosine;
}

void sum_changes(const BuiltLayer& layer, SheetChanges& changes) {
  changes.thinned = 0;
  changes.most_thinned = changes.mean_change = changes.most_change = changes.changed_part = 0;
  const std::vector<double> areas = point_areas(layer.face());
  double all = 0, mean = 0;
  for (std::size_t v = 0; v < areas.size(); ++v) {
    all += areas[v];
    mean += areas[v] * changes.wanted[v];
    changes.mean_change += areas[v] * std::abs(changes.change[v]);
  }
  if (!(all > 0)) return;
  changes.mean_change /= all;
  for (std::size_t v = 0; v < areas.size(); ++v) {
    const double change = std::abs(changes.change[v]), part = change / std::max(changes.wanted[v], 0.5 * mean / all);
    if (!(part > 1e-6)) continue;
    ++changes.thinned;
    if (part > kMuchThinned) changes.changed_part += areas[v] / all;
    if (part > changes.most_thinned) changes.where = layer.articular[v];
    changes.most_thinned = std::max(changes.most_thinned, part);
    changes.most_change = std::max(changes.most_change, change);
  }
}

void make_sound(BuiltLayer& layer, const SoundOptions& options, SheetChanges& changes) {
  Sheet s{layer, options, {}, {}, {}, {}, {}, {}, {}, {}, 0.0, {}, {}, {}, {}};
  Wanted wanted{layer, {}, {}};
  for (std::size_t v = 0; v < layer.bone.size(); ++v) {
    const Vector3d line = s.moving()[v] - s.fixed()[v];
    wanted.length.push_back(line.norm());
    wanted.direction.push_back(line.normalized());
    s.was.push_back(static_cast<int>(v));
  }
  if (changes.wanted_area == 0) changes.wanted_area = area_of(layer.face());
  if (changes.wanted.empty()) {
    changes.wanted = wanted.length;
    changes.change.assign(wanted.length.size(), 0.0);
  }
  s.direction = s.first_direction = wanted.direction;
  s.length = s.first_length = wanted.length;
  judge(s);
  if (any_below(s.soundness, kLeastSound)) {
    look_around(s);
    give_way(s);
    keep(changes.change, s.was);
    keep(changes.wanted, s.was);
    add_changes(s, wanted, changes);
    changes.area_lost += s.area_lost;
  }
  sum_changes(layer, changes);
}

}  // namespace dea

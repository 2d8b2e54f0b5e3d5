// Means over cases of the pressures on each surface.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "src/base/numbers.h"
#include "src/study/mean_map.h"
#include "views/study_page/study_maps.h"

namespace dea {

namespace {

constexpr int kGridSide = 81;                 ///< points along an edge of the square that holds all surfaces of a grid
constexpr std::size_t kMostMeanCases = 1500;  ///< in memory at a time, of one surface
constexpr std::size_t kMostMeanGroups = 8;

/// Points of a square lattice over the unrolled surfaces (MapView: Lambert's equal areas about each surface's own
/// sphere and middle). A point is at the same angle from the middle and from `up` on every surface: sizes are scaled
/// away, left and right are not mirrored. All points stand for the same area.
struct CommonGrid {
  double radius = 0.0;     ///< mean of the spheres' radii
  double step = 0.0;       ///< between neighbours, at the mean radius
  Vector3d up;             ///< direction to the top of the map
  ResultSurface geometry;  ///< the points that some surface covers, x right and y up at the mean radius, z = 0
  /// Where a point takes its value from on one surface: linear between three vertices; -1: not covered.
  struct Source {
    std::array<int, 3> vertices = {-1, -1, -1};
    std::array<double, 3> weights = {0, 0, 0};
  };
  std::vector<std::vector<Source>> sources;  ///< per surface and vertex of `geometry`
  /// Values at the points; NaN: not covered.
  std::vector<double> sampled(std::size_t surface, const std::vector<double>& values) const;
};

/// A surface on the map of a sphere of radius 1.
struct Unrolled {
  std::vector<Vector2d> points;
  std::vector<std::array<int, 3>> triangles;
};

Unrolled unrolled(const StudySurfaceMesh& s, const MapView& view) {
  const Projection p = project(s.map, view, std::vector<double>(s.map.triangles.size(), 0.0));
  Unrolled u;
  for (const Vector2d& x : p.points) u.points.push_back(x / view.radius);
  for (int t = 0; t < s.map.size(); ++t)
    if (p.layer[at(t)] == 0) u.triangles.push_back(s.map.triangles[at(t)]);
  return u;
}

double cross(const Vector2d& a, const Vector2d& b) { return a[0] * b[1] - a[1] * b[0]; }

/// Where each point of the lattice lies on one surface. Of triangles that share a point on their edge the first has it.
std::vector<CommonGrid::Source> lattice_sources(const Unrolled& u, double half, double step) {
  std::vector<CommonGrid::Source> sources(static_cast<std::size_t>(kGridSide) * kGridSide);
  const auto first = [&](double x) { return std::max(0, static_cast<int>(std::ceil((x + half) / step - 1e-9))); };
  const auto last = [&](double x) {
    return std::min(kGridSide - 1, static_cast<int>(std::floor((x + half) / step + 1e-9)));
  };
  for (const std::array<int, 3>& t : u.triangles) {
    const Vector2d a = u.points[at(t[0])], b = u.points[at(t[1])], c = u.points[at(t[2])];
    const double area = cross(b - a, c - a);
    if (area == 0) continue;
    const auto [x0, x1] = std::minmax({a[0], b[0], c[0]});
    const auto [y0, y1] = std::minmax({a[1], b[1], c[1]});
    for (int i = first(x0); i <= last(x1); ++i)
      for (int j = first(y0); j <= last(y1); ++j) {
        CommonGrid::Source& source = sources[at(i) * kGridSide + at(j)];
        if (source.vertices[0] >= 0) continue;
        const Vector2d x(step * i - half, step * j - half);
        const std::array<double, 3> w = {cross(b - x, c - x) / area, cross(c - x, a - x) / area,
                                         cross(a - x, b - x) / area};
        if (std::min({w[0], w[1], w[2]}) >= -1e-9) source = {t, w};
      }
  }
  return sources;
}

/// The points that some surface covers, in squares of four.
ResultSurface lattice_geometry(const std::vector<std::vector<CommonGrid::Source>>& sources, double half, double step,
                               double radius) {
  std::vector<Vector3d> positions;
  std::vector<char> covered;
  for (int i = 0; i < kGridSide; ++i)
    for (int j = 0; j < kGridSide; ++j) {
      positions.emplace_back(radius * (step * i - half), radius * (step * j - half), 0.0);
      covered.push_back(std::any_of(sources.begin(), sources.end(), [&](const auto& of_surface) {
        return of_surface[at(i) * kGridSide + at(j)].vertices[0] >= 0;
      }));
    }
  std::vector<int> begin = {0}, nodes;
  for (int i = 0; i + 1 < kGridSide; ++i)
    for (int j = 0; j + 1 < kGridSide; ++j) {
      const int a = i * kGridSide + j, b = a + kGridSide;
      for (const std::array<int, 3>& t : {std::array<int, 3>{a, b, b + 1}, std::array<int, 3>{a, b + 1, a + 1}}) {
        if (covered[at(t[0])] == 0 || covered[at(t[1])] == 0 || covered[at(t[2])] == 0) continue;
        nodes.insert(nodes.end(), t.begin(), t.end());
        begin.push_back(static_cast<int>(nodes.size()));
      }
    }
  return make_result_surface("common grid", begin, nodes, positions);
}

/// The global axis that is on top of a view, as view_from chose it.
Vector3d top_axis(const MapView& view) {
  int best = 2;
  for (int k : {1, 0})
    if (view.up[k] > view.up[best]) best = k;
  return Vector3d::Unit(best);
}

std::vector<double> CommonGrid::sampled(std::size_t surface, const std::vector<double>& values) const {
  std::vector<double> out;
  for (const Source& s : sources[surface]) {
    double sum = s.vertices[0] < 0 ? kNaN : 0.0;
    for (std::size_t k = 0; k < 3 && s.vertices[0] >= 0; ++k) sum += s.weights[k] * values[at(s.vertices[k])];
    out.push_back(sum);
  }
  return out;
}

/// `up`: zero: the global z, y or x axis that the first surface has on top of its map. nullopt: a surface is no part of
/// a sphere (unroll); `fault` says which.
std::optional<CommonGrid> common_grid(const std::vector<const StudySurfaceMesh*>& surfaces, const Vector3d& up,
                                      std::string& fault) {
  CommonGrid grid;
  grid.up = up;
  std::vector<Unrolled> maps;
  double half = 0.0;
  for (const StudySurfaceMesh* s : surfaces) {
    MapView view;
    if (!unroll(s->geometry, grid.up, view)) {
      fault = fmt::format("surface \"{}\" is no part of a sphere", s->surface);
      return std::nullopt;
    }
    if (grid.up.isZero()) grid.up = top_axis(view);
    grid.radius += view.radius / static_cast<double>(surfaces.size());
    maps.push_back(unrolled(*s, view));
    for (const Vector2d& x : maps.back().points) half = std::max({half, std::abs(x[0]), std::abs(x[1])});
  }
  const double step = 2 * half / (kGridSide - 1);
  std::vector<std::vector<CommonGrid::Source>> lattice;
  for (const Unrolled& u : maps) lattice.push_back(lattice_sources(u, half, step));
  grid.step = grid.radius * step;
  grid.geometry = lattice_geometry(lattice, half, step, grid.radius);
  for (const std::vector<CommonGrid::Source>& of_lattice : lattice) {
    grid.sources.emplace_back();
    for (int point : grid.geometry.mesh.model_nodes) grid.sources.back().push_back(of_lattice[at(point)]);
  }
  return grid;
}

/// Cases whose fields are averaged; the first group has all.
struct MeanGroup {
  std::string title;
  std::vector<std::size_t> cases;
};

std::vector<MeanGroup> mean_groups(const StudyNumbers& n, int column) {
  std::vector<MeanGroup> groups = {{"all cases", std::vector<std::size_t>(n.cases.size())}};
  std::iota(groups[0].cases.begin(), groups[0].cases.end(), std::size_t{0});
  if (column < 0) return groups;
  const StudyColumn& c = n.columns[at(column)];
  const std::vector<std::vector<std::size_t>> cases = c.cases();
  for (std::size_t l = 0; l < std::min(kMostMeanGroups, cases.size()); ++l)
    groups.push_back({fmt::format("{} = {}", c.name, c.levels[l]), cases[l]});
  return groups;
}

/// Fields by case, of one kind: a state, or the mean over the cycle.
using FieldsOfKind = std::map<std::size_t, std::vector<double>>;

/// What maps are averaged on: a surface, or a common grid of several.
struct MeanPlaces {
  std::vector<int> source;  ///< per surface: index in grid->sources; -1: its fields do not count
  const CommonGrid* grid = nullptr;
  std::vector<double> areas;  ///< per place

  std::vector<double> values(const StudyField& f, std::vector<double>&& pressure) const {
    return grid == nullptr ? std::move(pressure) : grid->sampled(at(source[at(f.surface)]), pressure);
  }
};

/// One state's fields.
FieldsOfKind fields_of_state(const std::string& path, const StudyNumbers& n, const StudyFields& fields,
                             const MeanPlaces& places, std::size_t state, const std::vector<char>& taken) {
  FieldsOfKind found;
  each_pressure(
      path, n, fields,
      [&](const StudyField& f) { return places.source[at(f.surface)] >= 0 && f.state == state && taken[f.c] != 0; },
      [&](const StudyField& f, std::vector<double>&& p) { found[f.c] = places.values(f, std::move(p)); });
  return found;
}

/// Means over each cycle: exposure over its span; of cases with all their states.
FieldsOfKind cycle_means(const std::string& path, const StudyNumbers& n, const StudyFields& fields,
                         const MeanPlaces& places, const std::vector<char>& taken) {
  FieldsOfKind means;
  std::vector<std::vector<double>> states;
  const StudyField* now = nullptr;
  const auto end_case = [&] {
    if (now == nullptr) return;
    if (std::optional<TimeSums> sums = cycle_sums(n.own_times[now->c], states))
      means[now->c] = places.values(*now, std::move(sums->exposure));
    states.clear();
  };
  each_pressure(
      path, n, fields, [&](const StudyField& f) { return places.source[at(f.surface)] >= 0 && taken[f.c] != 0; },
      [&](const StudyField& f, std::vector<double>&& p) {
        if (now == nullptr || f.c != now->c) end_case();
        now = &f;
        states.push_back(std::move(p));
      });
  end_case();
  return means;
}

std::vector<std::vector<double>> fields_of_group(const FieldsOfKind& fields, const MeanGroup& group) {
  std::vector<std::vector<double>> out;
  for (std::size_t c : group.cases)
    if (const auto found = fields.find(c); found != fields.end()) out.push_back(found->second);
  return out;
}

Json packed_map(const std::vector<double>& values, PageArrays& arrays) {
  const Codes codes = quantise(values);
  return {{"least", codes.least}, {"most", codes.most}, {"values", arrays.add(pack_codes(codes.codes))}};
}

/// Of one kind: each group's mean and deviation, differences from the second group (the first level).
Json kind_json(const std::string& kind, const FieldsOfKind& fields, const std::vector<MeanGroup>& groups,
               const MeanPlaces& places, PageArrays& arrays) {
  Json j = {{"kind", kind}, {"groups", Json::array()}, {"differences", Json::array()}};
  std::vector<std::optional<MeanMap>> means;
  for (const MeanGroup& g : groups) {
    const std::vector<std::vector<double>> of_group = fields_of_group(fields, g);
    means.emplace_back();
    if (of_group.empty()) {
      j["groups"].push_back(nullptr);
      continue;
    }
    // on a common grid places that fewer than half of the cases cover, or one alone, have no mean
    const std::size_t least = places.grid == nullptr ? 0 : std::max<std::size_t>(2, (of_group.size() + 1) / 2);
    means.back() = mean_map(of_group, places.areas, least);
    const MeanMap& m = *means.back();
    if (of_group.size() < 2) {
      j["groups"].push_back(nullptr);
      continue;
    }
    j["groups"].push_back(
        {{"cases", m.cases},
         {"area_mean", short_number(m.area_mean)},
         {"area_spread", short_number(m.area_spread)},
         {"mean", packed_map(m.mean, arrays)},
         {"sd", packed_map(m.standard_deviation, arrays)},
         {"count", least == 0 ? Json(nullptr) : arrays.add(pack_integers({m.count.begin(), m.count.end()}))}});
  }
  for (std::size_t g = 2; g < groups.size(); ++g) {
    if (!means[g] || !means[1]) {
      j["differences"].push_back(nullptr);
      continue;
    }
    const MapDifference d = map_difference(*means[g], *means[1], places.areas);
    j["differences"].push_back({{"area_mean", short_number(d.area_mean)},
                                {"area_rms", short_number(d.area_rms)},
                                {"values", packed_map(d.difference, arrays)}});
  }
  return j;
}

/// All kinds of some surfaces: each state, and over the cycle; empty: they have fewer than two cases.
Json kinds_json(const std::string& path, const StudyNumbers& n, const StudyFields& fields, const MeanPlaces& places,
                const std::vector<MeanGroup>& groups, std::vector<std::string>& notes, PageArrays& arrays) {
  std::vector<char> stored(n.cases.size(), 0), taken(n.cases.size(), 0);
  for (const StudyField& f : fields.fields)
    if (places.source[at(f.surface)] >= 0) stored[f.c] = 1;
  const auto count = static_cast<std::size_t>(std::count(stored.begin(), stored.end(), 1));
  Json kinds = Json::array();
  if (count < 2) return kinds;
  const std::size_t every = (count + kMostMeanCases - 1) / kMostMeanCases;
  for (std::size_t c = 0, i = 0; c < stored.size(); ++c)
    if (stored[c] != 0) taken[c] = i++ % every == 0 ? 1 : 0;
  if (every > 1) notes.push_back(fmt::format("mean maps are of one case in {} of {}", every, count));
  for (std::size_t k = 0; k < n.states; ++k)
    kinds.push_back(
        kind_json(fmt::format("{}", k), fields_of_state(path, n, fields, places, k, taken), groups, places, arrays));
  if (n.states > 1)
    kinds.push_back(kind_json("mean", cycle_means(path, n, fields, places, taken), groups, places, arrays));
  return kinds;
}

MeanPlaces places_of(const StudyFields& fields, const std::vector<std::size_t>& surfaces) {
  MeanPlaces places{std::vector<int>(fields.surfaces.size(), -1), nullptr, fields.surfaces[surfaces.front()].areas};
  for (std::size_t i = 0; i < surfaces.size(); ++i) places.source[surfaces[i]] = static_cast<int>(i);
  return places;
}

/// Surfaces of one contact and source: meshes of the same thing in several models.
std::vector<std::vector<std::size_t>> alike_surfaces(const StudyFields& fields) {
  std::map<std::tuple<int, std::string, std::string>, std::vector<std::size_t>> alike;
  for (std::size_t s = 0; s < fields.surfaces.size(); ++s) {
    const StudySurfaceMesh& of = fields.surfaces[s];
    alike[{of.contact_id, of.contact, of.source}].push_back(s);
  }
  std::vector<std::vector<std::size_t>> all;
  for (auto& [key, surfaces] : alike) all.push_back(std::move(surfaces));
  return all;
}

std::string grid_note(const StudyNumbers& n, const StudySurfaceMesh& of, const CommonGrid& g, std::size_t meshes) {
  const std::string unit = n.units.length.empty() ? "" : " " + n.units.length;
  return fmt::format(
      "mean maps of contact \"{}\" are of {} different meshes, each unrolled about its own sphere and laid on one grid "
      "of {} x {} points ({:.2g}{} apart at the mean radius, {:.4g}{}), {:g},{:g},{:g} on top (--up); left and right "
      "are "
      "not mirrored; a point is shown where at least half of the cases cover it",
      of.contact, meshes, kGridSide, kGridSide, g.step, unit, g.radius, unit, g.up[0], g.up[1], g.up[2]);
}

}  // namespace

Json mean_maps_json(const std::string& path, const StudyNumbers& n, const StudyFields& fields, int column,
                    const Vector3d& up, std::vector<std::string>& notes, Json& meshes, PageArrays& arrays) {
  const std::vector<MeanGroup> groups = mean_groups(n, column);
  Json j = {{"groups", list_json(groups, [](const MeanGroup& g) { return g.title; })},
            {"surfaces", std::vector<Json>(fields.surfaces.size(), Json::array())},
            {"common", Json::array()}};
  bool any = false;
  for (const std::vector<std::size_t>& surfaces : alike_surfaces(fields)) {
    const StudySurfaceMesh& first = fields.surfaces[surfaces.front()];
    std::vector<const StudySurfaceMesh*> alike;
    for (std::size_t s : surfaces) alike.push_back(&fields.surfaces[s]);
    std::string fault;
    const std::optional<CommonGrid> grid = alike.size() > 1 ? common_grid(alike, up, fault) : std::nullopt;
    if (!fault.empty())
      notes.push_back(
          fmt::format("mean maps of contact \"{}\" are of each of its {} meshes by itself: {}, which a "
                      "common grid needs",
                      first.contact, alike.size(), fault));
    if (grid) {
      MeanPlaces places = places_of(fields, surfaces);
      places.grid = &*grid;
      places.areas.assign(grid->geometry.mesh.vertices.size(), grid->step * grid->step);
      Json kinds = kinds_json(path, n, fields, places, groups, notes, arrays);
      if (kinds.empty()) continue;
      any = true;
      notes.push_back(grid_note(n, first, *grid, alike.size()));
      j["common"].push_back({{"surfaces", surfaces},
                             {"mesh", meshes.size()},
                             {"step", short_number(grid->step)},
                             {"kinds", std::move(kinds)}});
      const std::vector<int>& ids = grid->geometry.mesh.model_nodes;
      meshes.push_back(mesh_json(grid->geometry, {ids.begin(), ids.end()}, arrays));
      continue;
    }
    for (std::size_t s : surfaces) {
      j["surfaces"][s] = kinds_json(path, n, fields, places_of(fields, {s}), groups, notes, arrays);
      any = any || !j["surfaces"][s].empty();
    }
  }
  return any ? j : Json(nullptr);
}

}  // namespace dea

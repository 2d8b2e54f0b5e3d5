// Means over cases of the pressures on each surface.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "src/base/numbers.h"
#include "src/study/mean_map.h"
#include "views/study_page/study_common_grid.h"
#include "views/study_page/study_maps.h"

namespace dea {

namespace {

constexpr std::size_t kMostMeanCases = 1500;  ///< in memory at a time, of one surface
constexpr std::size_t kMostMeanGroups = 8;

/// Cases whose fields are averaged; the first group has all.
struct MeanGroup {
  std::string title;
  std::vector<char> has;  ///< per case
};

std::vector<MeanGroup> mean_groups(const StudyNumbers& n, int column) {
  std::vector<MeanGroup> groups = {{"all cases", std::vector<char>(n.cases.size(), 1)}};
  if (column < 0) return groups;
  const StudyColumn& c = n.columns[at(column)];
  for (std::size_t l = 0; l < std::min(kMostMeanGroups, c.levels.size()); ++l) {
    groups.push_back({fmt::format("{} = {}", c.name, c.levels[l]), std::vector<char>(n.cases.size(), 0)});
    for (std::size_t i = 0; i < n.cases.size(); ++i) groups.back().has[i] = at(c.level[i]) == l ? 1 : 0;
  }
  return groups;
}

/// Fields by case, of one kind: a state, or the mean over the cycle.
using FieldsOfKind = std::map<std::size_t, std::vector<double>>;

/// What maps are averaged on: a surface, or a common grid of several.
struct MeanPlaces {
  std::vector<char> surfaces;       ///< per surface: its fields count
  std::vector<std::size_t> source;  ///< per surface: index in grid->sources
  const CommonGrid* grid = nullptr;
  std::vector<double> areas;  ///< per place

  std::vector<double> values(const StudyField& f, std::vector<double>&& pressure) const {
    return grid == nullptr ? std::move(pressure) : grid->sampled(source[at(f.surface)], pressure);
  }
};

/// One state's fields.
FieldsOfKind fields_of_state(const std::string& path, const StudyNumbers& n, const StudyFields& fields,
                             const MeanPlaces& places, std::size_t state, const std::vector<char>& taken) {
  FieldsOfKind found;
  each_pressure(
      path, n, fields,
      [&](const StudyField& f) { return places.surfaces[at(f.surface)] != 0 && f.state == state && taken[f.c] != 0; },
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
    const std::vector<double>& times = n.own_times[now->c];
    const bool rising =
        std::adjacent_find(times.begin(), times.end(), [](double a, double b) { return !(b > a); }) == times.end();
    if (times.size() >= 2 && states.size() == times.size() && rising) {
      std::vector<double> mean = over_time(times, states, std::nullopt).exposure;
      for (double& x : mean) x /= times.back() - times.front();
      means[now->c] = places.values(*now, std::move(mean));
    }
    states.clear();
  };
  each_pressure(
      path, n, fields, [&](const StudyField& f) { return places.surfaces[at(f.surface)] != 0 && taken[f.c] != 0; },
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
  for (const auto& [c, values] : fields)
    if (group.has[c] != 0) out.push_back(values);
  return out;
}

Json packed_map(const std::vector<double>& values, PageArrays& arrays) {
  const Codes codes = quantise(values);
  return {{"least", codes.least}, {"most", codes.most}, {"values", arrays.add(pack_codes(codes.codes))}};
}

/// On a common grid places that fewer than half of the cases cover, or one alone, have no mean.
CoveredMeanMap mean_of(const std::vector<std::vector<double>>& fields, const MeanPlaces& places) {
  if (places.grid == nullptr) return {mean_map(fields, places.areas), {}, 0.0};
  return covered_mean_map(fields, places.areas, std::max<std::size_t>(2, (fields.size() + 1) / 2));
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
    CoveredMeanMap covered = mean_of(of_group, places);
    if (of_group.size() < 2) {
      j["groups"].push_back(nullptr);
    } else {
      j["groups"].push_back(
          {{"cases", covered.map.cases},
           {"area_mean", short_number(covered.map.area_mean)},
           {"area_spread", short_number(covered.map.area_spread)},
           {"mean", packed_map(covered.map.mean, arrays)},
           {"sd", packed_map(covered.map.standard_deviation, arrays)},
           {"count", covered.count.empty() ? Json(nullptr)
                                           : arrays.add(pack_integers({covered.count.begin(), covered.count.end()}))}});
    }
    means.back() = std::move(covered.map);
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
    if (places.surfaces[at(f.surface)] != 0) stored[f.c] = 1;
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
  MeanPlaces places{std::vector<char>(fields.surfaces.size(), 0), std::vector<std::size_t>(fields.surfaces.size(), 0),
                    nullptr, fields.surfaces[surfaces.front()].areas};
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    places.surfaces[surfaces[i]] = 1;
    places.source[surfaces[i]] = i;
  }
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

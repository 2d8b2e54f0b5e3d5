// Means over cases of the pressures on each surface.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>

#include <febiodea/base/numbers.h>
#include <febiodea/study/mean_map.h>
#include <febiodea/views/study_page/study_maps.h>

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

/// Fields of one surface by case, of one kind: a state, or the mean over the cycle.
using FieldsOfKind = std::map<std::size_t, std::vector<double>>;

struct KindMaps {
  std::string kind;
  FieldsOfKind fields;
};

/// One state's fields of a surface.
FieldsOfKind fields_of_state(const std::string& path, const StudyNumbers& n, const StudyFields& fields, int surface,
                             std::size_t state, const std::vector<char>& taken) {
  FieldsOfKind found;
  each_pressure(
      path, n, fields, [&](const StudyField& f) { return f.surface == surface && f.state == state && taken[f.c] != 0; },
      [&](const StudyField& f, std::vector<double>&& p) { found[f.c] = std::move(p); });
  return found;
}

/// Means over each cycle: exposure over its span; of cases with all their states.
FieldsOfKind cycle_means(const std::string& path, const StudyNumbers& n, const StudyFields& fields, int surface,
                         const std::vector<char>& taken) {
  FieldsOfKind means;
  std::vector<std::vector<double>> states;
  std::size_t now = n.cases.size();
  const auto end_case = [&] {
    if (now < n.cases.size() && n.own_times[now].size() >= 2 && states.size() == n.own_times[now].size()) {
      const std::vector<double>& times = n.own_times[now];
      const bool rising =
          std::adjacent_find(times.begin(), times.end(), [](double a, double b) { return !(b > a); }) == times.end();
      if (rising) {
        means[now] = over_time(times, states, std::nullopt).exposure;
        for (double& x : means[now]) x /= times.back() - times.front();
      }
    }
    states.clear();
  };
  each_pressure(
      path, n, fields, [&](const StudyField& f) { return f.surface == surface && taken[f.c] != 0; },
      [&](const StudyField& f, std::vector<double>&& p) {
        if (f.c != now) end_case();
        now = f.c;
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

/// Of one kind: each group's mean and deviation, differences from the second group (the first level).
Json kind_json(const std::string& kind, const FieldsOfKind& fields, const std::vector<MeanGroup>& groups,
               const std::vector<double>& areas, PageArrays& arrays) {
  Json j = {{"kind", kind}, {"groups", Json::array()}, {"differences", Json::array()}};
  std::vector<std::vector<std::vector<double>>> of_group;
  for (const MeanGroup& g : groups) of_group.push_back(fields_of_group(fields, g));
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (of_group[g].size() < 2) {
      j["groups"].push_back(nullptr);
      continue;
    }
    const MeanMap map = mean_map(of_group[g], areas);
    j["groups"].push_back({{"cases", map.cases},
                           {"area_mean", short_number(map.area_mean)},
                           {"area_spread", short_number(map.area_spread)},
                           {"mean", packed_map(map.mean, arrays)},
                           {"sd", packed_map(map.standard_deviation, arrays)}});
  }
  for (std::size_t g = 2; g < groups.size(); ++g) {
    if (of_group[g].empty() || of_group[1].empty()) {
      j["differences"].push_back(nullptr);
      continue;
    }
    const MapDifference d = map_difference(of_group[g], of_group[1], areas);
    j["differences"].push_back({{"area_mean", short_number(d.area_mean)},
                                {"area_rms", short_number(d.area_rms)},
                                {"values", packed_map(d.difference, arrays)}});
  }
  return j;
}

}  // namespace

Json mean_maps_json(const std::string& path, const StudyNumbers& n, const StudyFields& fields, int column,
                    std::vector<std::string>& notes, PageArrays& arrays) {
  const std::vector<MeanGroup> groups = mean_groups(n, column);
  Json j = {{"groups", list_json(groups, [](const MeanGroup& g) { return g.title; })}, {"surfaces", Json::array()}};
  bool any = false;
  for (std::size_t s = 0; s < fields.surfaces.size(); ++s) {
    std::vector<char> stored(n.cases.size(), 0), taken(n.cases.size(), 0);
    for (const StudyField& f : fields.fields)
      if (f.surface == static_cast<int>(s)) stored[f.c] = 1;
    const auto count = static_cast<std::size_t>(std::count(stored.begin(), stored.end(), 1));
    const std::size_t every = (count + kMostMeanCases - 1) / kMostMeanCases;
    for (std::size_t c = 0, i = 0; c < stored.size(); ++c)
      if (stored[c] != 0) taken[c] = i++ % every == 0 ? 1 : 0;
    if (every > 1) notes.push_back(fmt::format("mean maps are of one case in {} of {}", every, count));
    Json kinds = Json::array();
    const std::vector<double>& areas = fields.surfaces[s].areas;
    for (std::size_t k = 0; k < n.states && count > 1; ++k)
      kinds.push_back(kind_json(fmt::format("{}", k), fields_of_state(path, n, fields, static_cast<int>(s), k, taken),
                                groups, areas, arrays));
    if (n.states > 1 && count > 1)
      kinds.push_back(
          kind_json("mean", cycle_means(path, n, fields, static_cast<int>(s), taken), groups, areas, arrays));
    any = any || count > 1;
    j["surfaces"].push_back(std::move(kinds));
  }
  return any ? j : Json(nullptr);
}

}  // namespace dea

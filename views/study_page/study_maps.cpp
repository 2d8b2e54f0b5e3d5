#include "views/study_page/study_maps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/study/summary.h"
#include "views/map/map_scale.h"

namespace dea {

namespace {

constexpr double kMostFieldValues = 6e6;  ///< of states; with what is summed over them 20 MB of the page at most
constexpr int kDoseSteps = 20;            ///< levels of the curve of shares of area

/// What is shown of a case on one surface.
struct CaseFields {
  std::size_t c = 0;
  int surface = 0;
  std::vector<std::size_t> states;            ///< that are stored
  std::vector<double> contact_areas;          ///< per state of these
  std::vector<std::vector<double>> pressure;  ///< per state of these
  std::optional<TimeSums> over_cycle;         ///< none: a state is missing
  std::optional<Dose> dose;
};

std::vector<CaseFields> read_cases_fields(const std::string& path, const StudyNumbers& n, const StudyFields& fields,
                                          const std::vector<char>& kept) {
  std::vector<CaseFields> cases;
  std::map<std::pair<std::size_t, int>, std::size_t> known;
  each_pressure(
      path, n, fields, [&](const StudyField& f) { return kept[f.c] != 0; },
      [&](const StudyField& f, std::vector<double>&& pressure) {
        const auto [found, is_new] = known.emplace(std::make_pair(f.c, f.surface), cases.size());
        if (is_new) cases.push_back({f.c, f.surface, {}, {}, {}, {}, {}});
        CaseFields& of_case = cases[found->second];
        of_case.states.push_back(f.state);
        of_case.contact_areas.push_back(f.contact_area);
        of_case.pressure.push_back(std::move(pressure));
      });
  return cases;
}

/// Sums over the cycle, where all its states are there.
void sum_over_cycle(const StudyNumbers& n, const StudyMapOptions& options, CaseFields& f) {
  const std::vector<double>& times = n.own_times[f.c];
  f.over_cycle = cycle_sums(times, f.pressure);
  if (!f.over_cycle || !options.dose_above) return;
  const double span = times.back() - times.front();
  if (options.cycles_per_year)
    f.dose = chronic_dose(times, f.pressure, *options.dose_above,
                          {options.cycle_seconds.value_or(span), *options.cycles_per_year, *options.years});
  else
    f.dose = cycle_dose(times, f.pressure, *options.dose_above);
  if (options.cycles_per_year || !options.cycle_seconds) return;
  for (std::vector<double>* of : {&f.dose->exposure, &f.dose->overpressure})
    for (double& x : *of) x *= *options.cycle_seconds / span;
}

/// Values of one case as they stand on the page.
struct PackedFields {
  Json entries = Json::array();  ///< [kind, least, most, edge of contact]
  PackedArray values;
  std::map<std::string, ValueRange> ranges;
};

void add_field(const std::string& kind, const std::string& scale, const std::vector<double>& values, double edge,
               std::vector<std::uint16_t>& all, PackedFields& packed) {
  const Codes codes = quantise(values);
  all.insert(all.end(), codes.codes.begin(), codes.codes.end());
  packed.entries.push_back({kind, codes.least, codes.most, json_number(edge)});
  packed.ranges[scale].add(values);
}

PackedFields packed_fields(const StudySurfaceMesh& s, const CaseFields& f) {
  PackedFields packed;
  std::vector<std::uint16_t> all;
  for (std::size_t k = 0; k < f.states.size(); ++k) {
    const double area = f.contact_areas[k];
    const double edge = std::isfinite(area) ? level_enclosing(s.map, area, f.pressure[k]) : 1e-12;
    add_field(fmt::format("{}", f.states[k]), "pressure", f.pressure[k], edge, all, packed);
  }
  if (f.over_cycle) {
    add_field("largest", "pressure", f.over_cycle->peak, 1e-12, all, packed);
    add_field("mean", "mean", f.over_cycle->exposure, 1e-12, all, packed);
  }
  if (f.dose) {
    add_field("exposure", "exposure", f.dose->exposure, 1e-12, all, packed);
    add_field("overpressure", "overpressure", f.dose->overpressure, 1e-12, all, packed);
  }
  packed.values = pack_codes(all);
  return packed;
}

Json scale_json(const ValueRange& range) {
  const MapScale scale = map_scale({}, range);
  return {short_number(scale.low), short_number(scale.high), short_number(scale.step)};
}

/// How to look at a surface first, and where its vertices lie on the unrolled map.
void add_views(const StudySurfaceMesh& s, const std::vector<double>& load, const StudyMapOptions& options, Json& j,
               PageArrays& arrays) {
  const ResultSurface& g = s.geometry;
  const Vector3d up = options.regions.up.value_or(Vector3d::Zero());
  j["view"] = view_json(view_from(default_direction(g, load), up), g.mesh.vertices);
  j["flat"] = nullptr;
  MapView flat;
  if (!unroll(g, up, flat)) return;
  const Projection p = project(s.map, flat, std::vector<double>(s.map.triangles.size(), 0.0));
  std::vector<float> points;
  for (const Vector2d& x : p.points) {
    points.push_back(static_cast<float>(x[0]));
    points.push_back(static_cast<float>(x[1]));
  }
  std::vector<std::int32_t> triangles;
  for (int t = 0; t < s.map.size(); ++t)
    if (p.layer[at(t)] == 0)
      triangles.insert(triangles.end(), s.map.triangles[at(t)].begin(), s.map.triangles[at(t)].end());
  j["flat"] = {{"points", arrays.add(pack_floats(points))}, {"triangles", arrays.add(pack_integers(triangles))}};
}

Json surface_json(const StudySurfaceMesh& s, const std::vector<CaseFields>& cases, int index,
                  const StudyMapOptions& options, Json& meshes, PageArrays& arrays) {
  Json j = {{"contact", s.contact}, {"contact_id", s.contact_id}, {"source", s.source}, {"surface", s.surface}};
  j["mesh"] = meshes.size();
  meshes.push_back(
      mesh_json(s.geometry, {s.geometry.mesh.model_nodes.begin(), s.geometry.mesh.model_nodes.end()}, arrays));
  std::vector<double> load(at(s.geometry.facets()), 0.0);
  for (const CaseFields& f : cases)
    if (f.surface == index) {
      load = facet_average(s.geometry, f.pressure.front());
      break;
    }
  add_views(s, load, options, j, arrays);
  if (options.regions.any()) {
    const Regions regions = regions_of(s, options.regions);
    j["regions"] = {{"names", regions.names},
                    {"index", arrays.add(pack_integers({regions.index.begin(), regions.index.end()}))}};
  }
  return j;
}

/// Shares of the area with a dose above each of some levels, per case.
Json dose_json(const StudyNumbers& n, const StudyFields& fields, const std::vector<CaseFields>& cases,
               const StudyMapOptions& options) {
  if (!options.dose_above) return nullptr;
  double most = 0.0;
  for (const CaseFields& f : cases)
    if (f.dose)
      for (double x : f.dose->overpressure) most = std::max(most, std::isfinite(x) ? x : 0.0);
  Json j = {{"above", *options.dose_above}, {"left_out", 0}};
  j["cycles_per_year"] = options.cycles_per_year ? Json(*options.cycles_per_year) : Json(nullptr);
  j["years"] = options.years ? Json(*options.years) : Json(nullptr);
  j["cycle_seconds"] = options.cycle_seconds ? Json(*options.cycle_seconds) : Json(nullptr);
  std::vector<double> levels;
  for (int i = 0; i < kDoseSteps; ++i) levels.push_back(most * i / kDoseSteps);
  j["levels"] = list_json(levels, short_number);
  j["cases"] = Json::array();
  int left_out = 0;
  for (const CaseFields& f : cases) {
    if (!f.dose) {
      ++left_out;
      continue;
    }
    const std::vector<double>& areas = fields.surfaces[at(f.surface)].areas;
    const Distribution d = distribution(f.dose->overpressure, areas, 0.0);
    const Distribution e = distribution(f.dose->exposure, areas, 0.0);
    j["cases"].push_back({{"number", n.cases[f.c].number},
                          {"surface", f.surface},
                          {"span", short_number(n.own_times[f.c].back() - n.own_times[f.c].front())},
                          {"largest", short_number(d.peak > 0 ? d.peak : 0.0)},
                          {"mean", short_number(d.mean)},
                          {"exposure", short_number(e.peak)},
                          {"shares", list_json(levels, [&](double level) {
                             return short_number(share_above(f.dose->overpressure, areas, level));
                           })}});
  }
  j["left_out"] = left_out;
  return j;
}

/// The cases, as flags, whose fields the page can hold.
std::vector<char> kept_cases(const StudyNumbers& n, const StudyFields& fields, std::vector<std::string>& notes) {
  std::vector<double> values(n.cases.size(), 0.0);
  std::vector<char> stored(n.cases.size(), 0);
  for (const StudyField& f : fields.fields) {
    values[f.c] += static_cast<double>(fields.surfaces[at(f.surface)].areas.size());
    stored[f.c] = 1;
  }
  std::vector<char> kept = thinned_cases(n, stored, [&](const std::vector<char>& some) {
    double sum = 0.0;
    for (std::size_t c = 0; c < values.size(); ++c) sum += some[c] != 0 ? values[c] : 0.0;
    return sum <= kMostFieldValues;
  });
  const auto count = [](const std::vector<char>& flags) { return std::count(flags.begin(), flags.end(), 1); };
  if (count(kept) < count(stored))
    notes.push_back(fmt::format("maps are of {} of {} cases with stored pressures: all would not fit on a page",
                                count(kept), count(stored)));
  return kept;
}

}  // namespace

void check_dose(const StudyNumbers& n, const StudyMapOptions& o, const std::string& cycle_seconds) {
  if (!o.dose_above) return;
  if (!o.cycles_per_year || o.cycle_seconds) return;
  for (const std::vector<double>& times : n.own_times)
    if (times.size() > 1 && times.back() - times.front() > kLongestCycle)
      throw UsageError(
          fmt::format("a dose over years: found states over {:g} units of time, which are no seconds of a cycle ({:g} "
                      "at most; time "
                      "in percent or steps?), expected how long a cycle takes: {}",
                      times.back() - times.front(), kLongestCycle, cycle_seconds));
}

std::optional<TimeSums> cycle_sums(const std::vector<double>& times, const std::vector<std::vector<double>>& pressure) {
  if (times.size() < 2 || pressure.size() != times.size() || !rises(times)) return std::nullopt;
  TimeSums sums = over_time(times, pressure, std::nullopt);
  for (double& x : sums.exposure) x /= times.back() - times.front();
  return sums;
}

Json maps_json(const std::string& path, const StudyNumbers& n, const StudyFields& fields,
               const StudyMapOptions& options, std::vector<std::string>& notes, Json& meshes, PageArrays& arrays) {
  std::vector<std::string> own_notes;
  std::vector<CaseFields> cases = read_cases_fields(path, n, fields, kept_cases(n, fields, own_notes));
  notes.insert(notes.end(), own_notes.begin(), own_notes.end());
  if (cases.empty()) return nullptr;
  std::vector<PackedFields> packed(cases.size());
  parallel_for(cases.size(), [&](std::size_t i) {
    sum_over_cycle(n, options, cases[i]);
    packed[i] = packed_fields(fields.surfaces[at(cases[i].surface)], cases[i]);
  });
  Json j;
  j["surfaces"] = Json::array();
  for (std::size_t s = 0; s < fields.surfaces.size(); ++s)
    j["surfaces"].push_back(surface_json(fields.surfaces[s], cases, static_cast<int>(s), options, meshes, arrays));
  std::map<std::string, ValueRange> ranges;
  j["fields"] = Json::array();
  for (std::size_t i = 0; i < cases.size(); ++i) {
    for (const auto& [kind, range] : packed[i].ranges) ranges[kind].add(range);
    j["fields"].push_back({{"number", n.cases[cases[i].c].number},
                           {"surface", cases[i].surface},
                           {"levels", list_json(n.columns, [&](const StudyColumn& c) { return c.level[cases[i].c]; })},
                           {"entries", std::move(packed[i].entries)},
                           {"values", arrays.add(packed[i].values)}});
  }
  j["scales"] = Json::object();
  for (const auto& [kind, range] : ranges) j["scales"][kind] = scale_json(range);
  j["notes"] = own_notes;
  j["stored"] = fields.fields.size();
  j["dose"] = dose_json(n, fields, cases, options);
  return j;
}

}  // namespace dea

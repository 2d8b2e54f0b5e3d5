#include <pybind11/stl.h>

#include <fmt/format.h>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/tables/table.h"
#include "python/bind.h"
#include "python/errors.h"
#include "python/plain.h"
#include "python/work.h"
#include "src/base/error.h"
#include "src/study/dose.h"
#include "src/study/influence.h"
#include "src/study/mean_map.h"
#include "src/study/regions.h"
#include "views/study_page/study_page.h"
#include "views/study_page/study_statistics.h"

namespace dea::python {

namespace {

using namespace py::literals;
using Numbers = std::vector<double>;
using IntArray = py::array_t<int, py::array::c_style | py::array::forcecast>;

Numbers numbers(const DoubleArray& a) { return {a.data(), a.data() + a.size()}; }

std::vector<Numbers> rows(const DoubleArray& a, const char* what) {
  if (a.ndim() != 2) throw UsageError(fmt::format("{}: found an array of {} dimensions, expected 2", what, a.ndim()));
  std::vector<Numbers> out;
  for (py::ssize_t i = 0; i < a.shape(0); ++i)
    out.emplace_back(a.data() + i * a.shape(1), a.data() + (i + 1) * a.shape(1));
  return out;
}

std::vector<Vector3d> points(const DoubleArray& a, const char* what) {
  std::vector<Vector3d> out;
  for (const Numbers& row : rows(a, what)) {
    if (row.size() != 3) throw UsageError(fmt::format("{}: found {} columns, expected 3", what, row.size()));
    out.emplace_back(row[0], row[1], row[2]);
  }
  return out;
}

Vector3d vector_of(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

ResultSurface surface_of(const DoubleArray& vertices, const IntArray& t) {
  const std::vector<Vector3d> x = points(vertices, "vertices");
  if (t.ndim() != 2 || t.shape(1) != 3) throw UsageError("triangles: expected an array of three columns");
  std::vector<int> begin = {0}, nodes(t.data(), t.data() + t.size());
  for (int v : nodes)
    if (v < 0 || at(v) >= x.size())
      throw UsageError(fmt::format("triangles: found vertex {}, expected one from 0 to {}", v, x.size() - 1));
  for (std::size_t i = 1; 3 * i <= nodes.size(); ++i) begin.push_back(static_cast<int>(3 * i));
  return make_result_surface("surface", begin, nodes, x);
}

py::dict mean_map_dict(const MeanMap& m) {
  return py::dict("cases"_a = m.cases, "mean"_a = kept(m.mean), "standard_deviation"_a = kept(m.standard_deviation),
                  "area_mean"_a = m.area_mean, "area_spread"_a = m.area_spread);
}

py::tuple dose_of(const DoubleArray& times, const DoubleArray& pressures, double above,
                  const std::optional<std::array<double, 3>>& history) {
  const Dose dose = history ? chronic_dose(numbers(times), rows(pressures, "pressures"), above,
                                           {(*history)[0], (*history)[1], (*history)[2]})
                            : cycle_dose(numbers(times), rows(pressures, "pressures"), above);
  return py::make_tuple(kept(dose.exposure), kept(dose.overpressure));
}

py::object influence_of_arrays(const std::vector<Numbers>& factors, const Numbers& outputs) {
  const Regression r = regression(factors, outputs);
  Json j = {{"cases", r.cases}, {"left_out", r.left_out}, {"r_squared", json_number(r.r_squared)}};
  j["regression"] = list_json(r.coefficients, json_number);
  j["spearman"] = list_json(factors, [&](const Numbers& f) { return json_number(rank_correlation(f, outputs)); });
  return plain(j);
}

py::object sobol_of(const Numbers& outputs, int dimensions, int resamples, std::uint64_t seed) {
  Bootstrap bootstrap;
  bootstrap.resamples = resamples;
  bootstrap.seed = seed;
  const auto two = [](const Interval& i) -> Json { return {json_number(i.low), json_number(i.high)}; };
  return plain(list_json(sobol_indices(outputs, dimensions, bootstrap), [&](const SobolIndex& s) -> Json {
    return {{"first", json_number(s.first)},
            {"first_interval", two(s.first_interval)},
            {"total", json_number(s.total)},
            {"total_interval", two(s.total_interval)},
            {"rows", s.rows},
            {"left_out", s.left_out}};
  }));
}

/// A study's numbers, held by Python.
struct HeldNumbers {
  StudyNumbers numbers;
  StudyDesign design;
};
using Held = std::shared_ptr<HeldNumbers>;

/// A table's path as bytes, its (names, rows) as febiodea/_study_tables.py makes them, or None.
std::optional<CaseTable> subjects_of(const py::object& given) {
  if (given.is_none()) return std::nullopt;
  if (py::isinstance<py::bytes>(given)) return read_case_table(given.cast<std::string>());
  return table_of(given.cast<Cells>(), "subjects");
}

Held held_numbers(const std::string& path, const py::object& given) {
  return result_of([path, subjects = subjects_of(given)](Work&) {
    StudyNumbers n = study_numbers_with(path, subjects);
    StudyDesign design = study_design(n);
    return std::make_shared<HeldNumbers>(HeldNumbers{std::move(n), std::move(design)});
  });
}

/// Statistic, place, choice; checked by febiodea/_study_results.py.
using Which = std::array<std::size_t, 3>;
Numbers outputs(const HeldNumbers& h, const Which& w) { return h.numbers.outputs(w[0], w[1], w[2]); }

py::object influence_of_study(const HeldNumbers& h, const Which& which) {
  Json j = influence_json(h.numbers, h.design, outputs(h, which), {});
  const auto named = [&](Json& list) {
    for (Json& item : list) {
      const int column = item["column"];
      item["factor"] = column < 0 ? Json(nullptr) : Json(h.numbers.columns[at(column)].name);
      item.erase("column");
    }
  };
  named(j["factors"]);
  named(j["slopes"]);
  if (!j["sobol"].is_null()) named(j["sobol"]);
  return plain(j);
}

py::object groups_of_study(const HeldNumbers& h, const std::string& column, const Which& which) {
  const int c = study_column(h.numbers, "column", column);
  const StudyColumn& of = h.numbers.columns[at(c)];
  Json j = group_json(h.numbers, of, outputs(h, which));
  j["levels"] = of.levels;
  return plain(j);
}

py::object pairs_of_study(const HeldNumbers& h, const std::string& column, const std::string& by, const Which& which) {
  const StudyPairs pairs = study_pairs(h.numbers, "column", column, "by", by);
  Json j = pair_json(pairs, outputs(h, which));
  const std::vector<std::string>& levels = h.numbers.columns[at(pairs.column)].levels;
  j["levels"] = {levels[at(pairs.first)], levels[at(pairs.second)]};
  j["alone"] = pairs.alone;
  return plain(j);
}

StudyPageOptions page_options(const py::dict& given) {
  const auto number = [&](const char* name) { return given[name].cast<std::optional<double>>(); };
  const auto direction = [&](const char* name) -> std::optional<Vector3d> {
    if (given[name].is_none()) return std::nullopt;
    return vector_of(given[name].cast<std::array<double, 3>>());
  };
  StudyPageOptions o;
  o.names = {"group", "pair", "pair_by", "cycle_seconds"};
  o.group = given["group"].cast<std::string>();
  o.pair = given["pair"].cast<std::string>();
  o.pair_by = given["pair_by"].cast<std::string>();
  o.subjects = subjects_of(given["subjects"]);
  o.maps.regions.socket = given["socket"].cast<bool>();
  o.maps.regions.thirds = given["thirds"].cast<bool>();
  o.maps.regions.sectors = given["sectors"].cast<int>();
  o.maps.regions.up = direction("up");
  o.maps.regions.anterior = direction("anterior");
  o.maps.regions.axis = direction("axis");
  o.maps.regions.center = direction("center");
  o.maps.dose_above = number("dose_above");
  o.maps.cycles_per_year = number("cycles_per_year");
  o.maps.years = number("years");
  o.maps.cycle_seconds = number("cycle_seconds");
  o.words = {"febiodea.read_study(...).report(...)"};
  return o;
}

py::list write_study_report(const std::string& study, const std::string& path, const py::dict& given) {
  const StudyPageOptions options = page_options(given);
  return texts(result_of([study, path, options](Work&) { return write_study_page(path, study, options); }));
}

void bind_numbers_of_studies(py::module_& m) {
  py::class_<HeldNumbers, Held>(m, "StudyNumbers")
      .def_property_readonly("statistics",
                             [](const HeldNumbers& h) {
                               std::vector<std::string> names;
                               for (const StudyStatistic& s : h.numbers.statistics) names.push_back(s.name);
                               return texts(names);
                             })
      .def_property_readonly("places",
                             [](const HeldNumbers& h) {
                               std::vector<std::string> names;
                               for (const StudyPlace& p : h.numbers.places)
                                 names.push_back(p.part.empty() ? p.contact : p.contact + ": " + p.part);
                               return texts(names);
                             })
      .def_property_readonly("states", [](const HeldNumbers& h) { return h.numbers.states; })
      .def_property_readonly("choices", [](const HeldNumbers& h) { return h.numbers.choices(); })
      .def_property_readonly("cases",
                             [](const HeldNumbers& h) {
                               std::vector<std::int64_t> numbers;
                               for (const StudyCase& c : h.numbers.cases)
                                 numbers.push_back(static_cast<std::int64_t>(c.number));
                               return kept(numbers);
                             })
      .def("outputs", [](const HeldNumbers& h, const Which& w) { return kept(outputs(h, w)); })
      .def("influence", &influence_of_study)
      .def("groups", &groups_of_study)
      .def("pairs", &pairs_of_study);
  m.def("study_numbers", &held_numbers);
  m.def("study_report", &write_study_report);
}

}  // namespace

void bind_statistics(py::module_& m) {
  bind_numbers_of_studies(m);
  m.def("box_plot", [](const DoubleArray& v) { return plain(box_json(box_plot(numbers(v)))); });
  m.def("influence", &influence_of_arrays);
  m.def("sobol_indices", &sobol_of);
  m.def("pairs", [](const Numbers& a, const Numbers& b) { return plain(pair_json(a, b)); });
  m.def("difference", [](const Numbers& a, const Numbers& b) { return plain(difference_json(a, b)); });
  m.def("dose", &dose_of);
  m.def("share_above", [](const DoubleArray& values, const DoubleArray& areas, double threshold) {
    return share_above(numbers(values), numbers(areas), threshold);
  });
  m.def("mean_map", [](const DoubleArray& fields, const DoubleArray& areas) {
    return mean_map_dict(mean_map(rows(fields, "fields"), numbers(areas)));
  });
  m.def("map_difference", [](const DoubleArray& a, const DoubleArray& b, const DoubleArray& areas) {
    const MeanMap first = mean_map(rows(a, "first"), numbers(areas)),
                  second = mean_map(rows(b, "second"), numbers(areas));
    const MapDifference d = map_difference(first, second, numbers(areas));
    return py::dict("first"_a = mean_map_dict(first), "second"_a = mean_map_dict(second),
                    "difference"_a = kept(d.difference), "area_mean"_a = d.area_mean, "area_rms"_a = d.area_rms);
  });
  m.def("sectors", [](const DoubleArray& x, const std::array<double, 3>& center, const std::array<double, 3>& axis,
                      const std::array<double, 3>& start, int count) {
    const Regions r = sectors(points(x, "points"), vector_of(center), vector_of(axis), vector_of(start), count);
    return py::make_tuple(kept(r.index), texts(r.names));
  });
  m.def("socket_regions", [](const DoubleArray& vertices, const IntArray& triangles, const std::array<double, 3>& up,
                             const std::array<double, 3>& anterior) {
    const Regions r = socket_regions(points(vertices, "vertices"), surface_frame(surface_of(vertices, triangles)),
                                     vector_of(up), vector_of(anterior));
    return py::make_tuple(kept(r.index), texts(r.names));
  });
  m.def("vertex_areas", [](const DoubleArray& vertices, const IntArray& triangles) {
    const ResultSurface s = surface_of(vertices, triangles);
    Numbers areas(static_cast<std::size_t>(vertices.shape(0)), 0.0);
    const Numbers own = nodal_areas(s);
    for (std::size_t v = 0; v < own.size(); ++v) areas[at(s.mesh.model_nodes[v])] = own[v];
    return kept(areas);
  });
}

}  // namespace dea::python

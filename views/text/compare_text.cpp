#include "views/text/compare_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/time_text.h"
#include "views/compare/quantities.h"

namespace dea {

namespace {

std::string short_number(double x) { return four_digits(x == 0 ? 0.0 : x); }  // no -0
std::string percent(double x) { return std::isfinite(x) ? fmt::format("{:+.1f}%", std::abs(x) < 0.05 ? 0.0 : x) : "-"; }

/// The table's lines with all that there is beside the headline numbers.
std::vector<Quantity> detail_quantities(const ComparedRegion& region, const std::vector<double>& thresholds) {
  std::vector<Quantity> out;
  out.push_back(quantity("threshold of the lines above", region.headlines, [](const Headline& h) { return h.above; }));
  using M = const SurfaceMeasures&;
  using D = Dimension;
  const auto add = [&](const std::string& name, Dimension dimension, auto get) {
    out.push_back(quantity(name, region.results, get, dimension));
  };
  for (const DistributionNumber& number : kDistributionNumbers) {
    const std::string name = number.name;
    if (name != "peak" && name != "p99" && name != "mean" && name != "median") continue;
    add(name + ", nodes > 0", D::Pressure, [&](M m) { return m.nodes[0].*number.value; });
    add(name + ", facets > 0", D::Pressure, [&](M m) { return m.facets[0].*number.value; });
  }
  for (std::size_t t = 1; t < thresholds.size(); ++t)
    add(fmt::format("mean, nodes > {:g}", thresholds[t]), D::Pressure, [t](M m) { return m.nodes[t].mean; });
  add("area, facets > 0", D::Area, [](M m) { return m.facets[0].area; });
  for (std::size_t t = 0; t < thresholds.size(); ++t)
    add(fmt::format("area, nodes > {:g}", thresholds[t]), D::Area, [t](M m) { return m.nodes[t].area; });
  add("resultant of the map", D::Force, [](M m) { return m.resultant.norm(); });
  if (std::any_of(region.results.begin(), region.results.end(),
                  [](M m) { return std::isfinite(m.mean_penetration) && m.mean_penetration != 0; })) {
    add("penetration, mean of facets", D::Length, [](M m) { return m.mean_penetration; });
    add("penetration, largest of facets", D::Length, [](M m) { return m.max_penetration; });
  }
  return out;
}

/// The lines about the whole surface that rest on what the files say of themselves.
std::vector<Quantity> fact_quantities(const Comparison& c, const ComparedSurface& surface) {
  const bool deformed = c.areas == CompareAreas::Deformed;
  Quantity area{"area of the whole surface", {}, true, Dimension::Area},
      force{"contact force of the file", {}, true, Dimension::Force},
      share{"resultant, % of it", {}, false, Dimension::None};
  for (const SurfaceFacts& f : surface.facts) {
    area.values.push_back(deformed ? f.deformed_area : f.area);
    force.values.push_back(f.contact_force ? f.contact_force->norm() : kNaN);
    share.values.push_back(100 * share_of_contact_force(f, c.areas));
  }
  std::vector<Quantity> out = {area};
  if (std::any_of(share.values.begin(), share.values.end(), [](double x) { return std::isfinite(x); })) {
    out.push_back(force);
    out.push_back(share);
  }
  return out;
}

/// Which files' contacts give way, and what does the same in dea: a line each.
std::string interface_text(const Comparison& c, const ComparedSurface& surface) {
  std::string text;
  for (std::size_t i = 0; i < c.labels.size(); ++i) {
    const InterfaceCompliance& k = surface.facts[i].interface;
    if (!(k.compliance > 0)) continue;
    text += fmt::format(
        "{}{}: its contact gives way by {:.4g} per pressure (gap over pressure, {} facets above a tenth of the peak; "
        "90% of the force: {:.3g} to {:.3g}): --interface-stiffness {:.3g} puts the same in series",
        text.empty() ? "" : "\n", c.labels[i], k.compliance, k.facets, k.p5, k.p95, 1 / k.compliance);
  }
  return text;
}

/// A column of numbers.
void add_column(Table& table, const std::string& heading) {
  table.headings.push_back(heading);
  table.left += 'r';
}

/// A column of `first` alignment under `heading`, and one of numbers per file.
Table table_of_files(const Comparison& c, const std::string& heading = "", char first = 'l') {
  Table table;
  table.headings = {heading};
  table.left = first;
  for (const std::string& label : c.labels) add_column(table, label);
  return table;
}

/// What was measured in each file, and in per cent how far it is from the last.
Table region_table(const Comparison& c, const ComparedSurface& surface, const ComparedRegion& region, bool details) {
  const std::size_t n = c.labels.size();
  const UnitNames units = unit_names(c.units);
  Table table = table_of_files(c);
  for (std::size_t i = 0; i + 1 < n; ++i)
    add_column(table, n == 2 ? "difference" : fmt::format("difference {}", c.labels[i]));
  const auto add = [&](const Quantity& q) {
    std::vector<std::string> row = {with_unit(q.name, units, q.dimension)};
    for (double x : q.values) row.push_back(short_number(x));
    // a contact without penetration is another contact, not one with 100 % less
    const bool zero_is_none = q.name.rfind("penetration", 0) == 0;
    for (std::size_t i = 0; i + 1 < n; ++i)
      row.push_back(!q.compared || (zero_is_none && q.values[i] == 0)
                        ? "-"
                        : percent(percent_difference(q.values[i], q.values.back())));
    table.rows.push_back(std::move(row));
  };
  for (const HeadlineNumber& number : kHeadlineNumbers) add(headline_quantity(number, region));
  if (details)
    for (const Quantity& q : detail_quantities(region, c.thresholds)) add(q);
  if (details && region.name.empty())
    for (const Quantity& q : fact_quantities(c, surface)) add(q);
  if (!details && !c.dose_above) return table;
  for (const TimeNumber& number : kTimeNumbers) {
    if (number.words == nullptr) continue;
    Quantity q = quantity(number.words, region.over_time, [&](const TimeMeasures& m) { return m.*number.value; });
    if (number.value != &TimeMeasures::mean_peak) q.dimension = Dimension::None;  // times have no unit here
    if (std::any_of(q.values.begin(), q.values.end(), [](double x) { return std::isfinite(x); })) add(q);
  }
  return table;
}

/// How alike the patterns are.
Table pattern_table(const Comparison& c, const ComparedRegion& region) {
  Table patterns;
  const UnitNames units = unit_names(c.units);
  patterns.headings = {fmt::format("against {}", c.labels.back()), "correlation"};
  for (const char* name : {"rms", "mean", "largest"})
    patterns.headings.push_back(with_unit(name, units, Dimension::Pressure));
  patterns.left = "lrrrr";
  for (double t : c.thresholds) add_column(patterns, fmt::format("Dice > {:g}", t));
  patterns.headings.push_back(with_unit("centre of pressure", units, Dimension::Length));
  patterns.left += 'l';
  for (std::size_t i = 0; i + 1 < c.labels.size(); ++i) {
    const PatternDifference& d = region.differences[i];
    const Vector3d shift = region.results[i].center_of_pressure - region.results.back().center_of_pressure;
    std::vector<std::string> row = {c.labels[i],
                                    std::isfinite(d.correlation) ? fmt::format("{:.4f}", d.correlation) : "-",
                                    short_number(d.rms), short_number(d.mean), short_number(d.largest)};
    for (double dice : d.dice) row.push_back(std::isfinite(dice) ? fmt::format("{:.4f}", dice) : "-");
    row.push_back(shift.allFinite() ? fmt::format("moved by {} {}", short_number(shift.norm()), vector_text(shift))
                                    : "-");
    patterns.rows.push_back(std::move(row));
  }
  return patterns;
}

/// A row of elements under a surface.
TitledTable inside_table(const Comparison& c, const ComparedRow& row) {
  const std::size_t n = c.labels.size();
  const UnitNames units = unit_names(c.units);
  Table table = table_of_files(c);
  for (const char* what : {"difference", "correlation"})
    for (std::size_t i = 0; i + 1 < n; ++i) add_column(table, n == 2 ? what : fmt::format("{} {}", what, c.labels[i]));
  for (std::size_t m = 0; m < 3; ++m) {
    const InsideMeasure& measure = kInsideMeasures[m];
    for (const std::size_t k : {1, 2, 0}) {  // p99, mean, peak as everywhere
      const InsideNumber& number = kInsideNumbers[k];
      std::vector<std::string> cells = {with_unit(fmt::format("{}, {}", measure.words, number.name), units,
                                                  measure.stress ? Dimension::Pressure : Dimension::None)};
      for (std::size_t i = 0; i < n; ++i) cells.push_back(short_number(row.results[i].*measure.value.*number.value));
      for (std::size_t i = 0; i + 1 < n; ++i) cells.push_back(percent(inside_percent(row, i, measure, number)));
      for (std::size_t i = 0; i + 1 < n; ++i) {
        const double r = row.correlation[i][m];
        cells.push_back(k != 1 ? "" : std::isfinite(r) ? fmt::format("{:.4f}", r) : "-");
      }
      table.rows.push_back(std::move(cells));
    }
  }
  return {fmt::format("inside the cartilage, {} elements of the row at the {}, by volume", row.elements, name(row.row)),
          std::move(table)};
}

TitledTable profile_table(const Comparison& c, const ComparedSurface& surface) {
  Table table = table_of_files(c, "degrees", 'r');
  std::size_t bins = 0;
  for (const auto& profile : surface.profiles) bins = std::max(bins, profile.size());
  // bins before the first facet and behind the last one say nothing
  const auto empty = [&](std::size_t b) {
    return std::all_of(surface.profiles.begin(), surface.profiles.end(),
                       [&](const auto& profile) { return b >= profile.size() || std::isnan(profile[b].mean); });
  };
  while (bins > 0 && empty(bins - 1)) --bins;
  std::size_t first = 0;
  while (first < bins && empty(first)) ++first;
  for (std::size_t b = first; b < bins; ++b) {
    std::vector<std::string> row;
    for (const auto& profile : surface.profiles) {
      if (row.empty()) row.push_back("");
      if (b < profile.size()) row.front() = fmt::format("{:g} - {:g}", profile[b].from, profile[b].to);
      row.push_back(b < profile.size() ? short_number(profile[b].mean) : "-");
    }
    table.rows.push_back(std::move(row));
  }
  return {fmt::format("{} against the angle from {} about {}",
                      with_unit("mean pressure", unit_names(c.units), Dimension::Pressure), vector_text(surface.axis),
                      vector_text(surface.center)),
          std::move(table)};
}

std::string surface_title(const ComparedSurface& s) {
  const bool one =
      std::all_of(s.names.begin(), s.names.end(), [&](const std::string& n) { return n == s.names.front(); });
  if (one) return shown(s.names.front());
  std::string text;
  for (const std::string& n : s.names) text += fmt::format("{}{}", text.empty() ? "" : " = ", shown(n));
  return text;
}

Table bodies_table(const Comparison& c) {
  Table bodies;
  const UnitNames units = unit_names(c.units);
  bodies.headings = {"body"};
  for (const std::string& label : c.labels)
    bodies.headings.push_back(with_unit(fmt::format("position {}", label), units, Dimension::Length));
  for (std::size_t i = 0; i + 1 < c.labels.size(); ++i) {
    bodies.headings.push_back(c.labels.size() == 2 ? "difference" : fmt::format("difference {}", c.labels[i]));
    bodies.headings.push_back("rotated [degrees]");
  }
  bodies.left = std::string(bodies.headings.size(), 'l');
  for (const ComparedBody& body : c.bodies) {
    std::vector<std::string> row = {body.name};
    for (const auto& pose : body.results) row.push_back(pose ? vector_text(pose->position) : "-");
    for (const auto& d : body.differences) {
      row.push_back(d ? vector_text(d->translation) : "-");
      row.push_back(d && d->rotation ? short_number(kDegreesPerRadian * d->rotation->norm()) : "-");
    }
    bodies.rows.push_back(std::move(row));
  }
  return bodies;
}

/// Tables of one surface.
void add_surface(const Comparison& c, const ComparedSurface& surface, bool details, std::vector<TitledTable>& tables) {
  std::string remarks;
  for (std::size_t i = 0; i + 1 < c.labels.size(); ++i)
    if (!surface.same_mesh[i])
      remarks += fmt::format("; {} projected onto the mesh of {}", c.labels[i], c.labels.back());
  if (c.areas == CompareAreas::Deformed) remarks += "; deformed areas";
  for (const ComparedRegion& region : surface.regions) {
    const std::string rest = region.name.empty() ? remarks : fmt::format(", region {}", shown(region.name));
    tables.push_back(
        {fmt::format("surface {}{}", surface_title(surface), rest), region_table(c, surface, region, details)});
    tables.push_back({"", pattern_table(c, region)});
  }
  for (const ComparedRow& row : surface.inside) tables.push_back(inside_table(c, row));
  const std::string interface = interface_text(c, surface);
  if (!interface.empty()) tables.push_back({interface, {}});
  if (!surface.profiles.empty()) tables.push_back(profile_table(c, surface));
}

}  // namespace

std::vector<TitledTable> compare_tables(const Comparison& c, bool details) {
  std::vector<TitledTable> tables;
  for (const ComparedSurface& surface : c.surfaces) {
    if (surface.asked_for)
      add_surface(c, surface, details, tables);
    else
      tables.push_back({fmt::format("surface {}: not every file has pressure on it (--surface {} shows the numbers; "
                                    "JSON and CSV have them)",
                                    surface_title(surface), in_quotes(surface.names.front())),
                        {}});
  }
  if (!c.bodies.empty()) tables.push_back({"", bodies_table(c)});
  return tables;
}

std::string compare_text(const Comparison& c, bool details) {
  std::string text =
      c.units.empty() ? "units: the files' own (they name none)\n" : fmt::format("units: the files', {}\n", c.units);
  text += c.areas == CompareAreas::Deformed ? "areas: deformed, nodes moved by each file's own displacement\n"
                                            : "areas: of the mesh in the reference configuration\n";
  for (std::size_t i = 0; i < c.labels.size(); ++i)
    text += fmt::format("{}: {}, time {}{}{}\n", c.labels[i], c.paths[i], time_text(c.times[i]),
                        c.solved[i] ? "" : ", no solution: do not use its numbers",
                        i + 1 == c.labels.size() ? " (differences are relative to it)" : "");
  return text + tables_text(compare_tables(c, details));
}

}  // namespace dea

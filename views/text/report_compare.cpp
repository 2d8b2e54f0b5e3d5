#include <febiodea/views/text/report_compare.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <febiodea/base/numbers.h>
#include <febiodea/version.h>
#include <febiodea/views/data/csv.h>

namespace dea {

namespace {

constexpr double kDegrees = 57.29577951308232;

std::string short_number(double x) { return std::isfinite(x) ? fmt::format("{:.4g}", x == 0 ? 0.0 : x) : "-"; }
std::string percent(double x) { return std::isfinite(x) ? fmt::format("{:+.1f}%", std::abs(x) < 0.05 ? 0.0 : x) : "-"; }

/// A number that exists for every file, and how to call it.
struct Quantity {
  std::string name;  ///< of the table
  std::string key;   ///< of CSV
  std::vector<double> values;
  bool compared = true;  ///< false: a difference of two of them says nothing
};

template <class Get>
Quantity quantity(const std::string& name, const std::string& key, const ComparedRegion& region, Get get) {
  Quantity q{name, key, {}};
  for (const SurfaceMeasures& m : region.results) q.values.push_back(get(m));
  return q;
}

constexpr struct {
  const char* name;
  double Distribution::*value;
} kShares[] = {
    {"peak", &Distribution::peak}, {"p99", &Distribution::p99}, {"mean", &Distribution::mean},
    {"p5", &Distribution::p5},     {"p25", &Distribution::p25}, {"median", &Distribution::median},
    {"p75", &Distribution::p75},   {"p95", &Distribution::p95}, {"p99_unweighted", &Distribution::p99_unweighted},
    {"area", &Distribution::area}};

/// The table's lines.
std::vector<Quantity> table_quantities(const ComparedRegion& region, const std::vector<double>& thresholds) {
  std::vector<Quantity> out;
  for (const char* wanted : {"peak", "p99", "mean", "median"}) {
    for (const auto& share : kShares) {
      if (std::string(share.name) != wanted) continue;
      const auto value = share.value;
      out.push_back(quantity(fmt::format("{}, nodes", wanted), "", region,
                             [value](const SurfaceMeasures& m) { return m.nodes[0].*value; }));
      out.push_back(quantity(fmt::format("{}, facets", wanted), "", region,
                             [value](const SurfaceMeasures& m) { return m.facets[0].*value; }));
    }
  }
  for (std::size_t t = 1; t < thresholds.size(); ++t)
    out.push_back(quantity(fmt::format("mean, nodes > {:g}", thresholds[t]), "", region,
                           [t](const SurfaceMeasures& m) { return m.nodes[t].mean; }));
  out.push_back(quantity("area, facets > 0", "", region, [](const SurfaceMeasures& m) { return m.facets[0].area; }));
  for (std::size_t t = 0; t < thresholds.size(); ++t)
    out.push_back(quantity(fmt::format("area, nodes > {:g}", thresholds[t]), "", region,
                           [t](const SurfaceMeasures& m) { return m.nodes[t].area; }));
  out.push_back(quantity("resultant", "", region, [](const SurfaceMeasures& m) { return m.resultant.norm(); }));
  const auto penetration =
      quantity("penetration, mean", "", region, [](const SurfaceMeasures& m) { return m.mean_penetration; });
  if (std::any_of(penetration.values.begin(), penetration.values.end(),
                  [](double x) { return std::isfinite(x) && x != 0; })) {
    out.push_back(penetration);
    out.push_back(
        quantity("penetration, largest", "", region, [](const SurfaceMeasures& m) { return m.max_penetration; }));
  }
  return out;
}

/// The lines about the whole surface that rest on what the files say of themselves.
std::vector<Quantity> fact_quantities(const Comparison& c, const ComparedSurface& surface) {
  const bool deformed = c.areas == CompareAreas::Deformed;
  Quantity area{"area, whole surface", "", {}}, force{"contact force of the file", "", {}},
      share{"resultant, % of it", "", {}, false};
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

/// `title`: of the first of the two.
void add_region_tables(const Comparison& c, const ComparedSurface& surface, const ComparedRegion& region,
                       const std::string& title, std::vector<TitledTable>& tables) {
  const std::size_t n = c.labels.size();
  Table table;
  table.headings = {""};
  table.left = "l";
  for (const std::string& label : c.labels) {
    table.headings.push_back(label);
    table.left += 'r';
  }
  for (std::size_t i = 0; i + 1 < n; ++i) {
    table.headings.push_back(n == 2 ? "difference" : fmt::format("difference {}", c.labels[i]));
    table.left += 'r';
  }
  const auto add = [&](const Quantity& q) {
    std::vector<std::string> row = {q.name};
    for (double x : q.values) row.push_back(short_number(x));
    // a contact without penetration is another contact, not one with 100 % less
    const bool zero_is_none = q.name.rfind("penetration", 0) == 0;
    for (std::size_t i = 0; i + 1 < n; ++i)
      row.push_back(!q.compared || (zero_is_none && q.values[i] == 0)
                        ? "-"
                        : percent(percent_difference(q.values[i], q.values.back())));
    table.rows.push_back(std::move(row));
  };
  for (const Quantity& q : table_quantities(region, c.thresholds)) add(q);
  if (region.name.empty())
    for (const Quantity& q : fact_quantities(c, surface)) add(q);
  const auto add_time = [&](const char* name, double TimeMeasures::*value) {
    Quantity q{name, "", {}};
    for (const TimeMeasures& m : region.over_time) q.values.push_back(m.*value);
    if (std::any_of(q.values.begin(), q.values.end(), [](double x) { return std::isfinite(x); })) add(q);
  };
  if (std::any_of(region.over_time.begin(), region.over_time.end(),
                  [](const TimeMeasures& m) { return std::isfinite(m.max_exposure); }))
    add_time("peak over time, mean", &TimeMeasures::mean_peak);
  add_time("exposure, largest", &TimeMeasures::max_exposure);
  add_time("exposure, mean", &TimeMeasures::mean_exposure);
  add_time("dose, largest", &TimeMeasures::max_dose);
  add_time("dose, mean", &TimeMeasures::mean_dose);
  tables.push_back({title, std::move(table)});

  Table patterns;
  patterns.headings = {fmt::format("against {}", c.labels.back()), "correlation", "rms", "mean", "largest"};
  patterns.left = "lrrrr";
  for (double t : c.thresholds) {
    patterns.headings.push_back(fmt::format("Dice > {:g}", t));
    patterns.left += 'r';
  }
  patterns.headings.push_back("centre of pressure");
  patterns.left += 'l';
  for (std::size_t i = 0; i + 1 < n; ++i) {
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
  tables.push_back({"", std::move(patterns)});
}

TitledTable profile_table(const Comparison& c, const ComparedSurface& surface) {
  Table table;
  table.headings = {"degrees"};
  table.left = "r";
  for (const std::string& label : c.labels) {
    table.headings.push_back(label);
    table.left += 'r';
  }
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
  return {fmt::format("mean pressure against the angle from {} about {}", vector_text(surface.axis),
                      vector_text(surface.center)),
          std::move(table)};
}

std::string surface_title(const ComparedSurface& s) {
  const bool one =
      std::all_of(s.names.begin(), s.names.end(), [&](const std::string& n) { return n == s.names.front(); });
  if (one) return s.names.front();
  std::string text;
  for (const std::string& n : s.names) text += fmt::format("{}{}", text.empty() ? "" : " = ", n);
  return text;
}

Json distribution_json(const Distribution& d, double threshold) {
  Json j;
  j["above"] = threshold;
  for (const auto& share : kShares) j[share.name] = json_number(d.*share.value);
  return j;
}

Json percent_json(const Distribution& a, const Distribution& b, double threshold) {
  Json j;
  j["above"] = threshold;
  for (const auto& share : kShares) j[share.name] = json_number(percent_difference(a.*share.value, b.*share.value));
  return j;
}

Json result_json(const Comparison& c, const ComparedRegion& region, std::size_t i) {
  const SurfaceMeasures& m = region.results[i];
  const TimeMeasures& t = region.over_time[i];
  Json j;
  j["label"] = c.labels[i];
  for (const bool nodes : {true, false}) {
    Json& list = j[nodes ? "nodes" : "facets"] = Json::array();
    for (std::size_t k = 0; k < c.thresholds.size(); ++k)
      list.push_back(distribution_json(nodes ? m.nodes[k] : m.facets[k], c.thresholds[k]));
  }
  j["resultant"] = json_vector(m.resultant);
  j["center_of_pressure"] = json_vector(m.center_of_pressure);
  j["mean_penetration"] = json_number(m.mean_penetration);
  j["max_penetration"] = json_number(m.max_penetration);
  j["over_time"] = {{"max_peak", json_number(t.max_peak)},         {"mean_peak", json_number(t.mean_peak)},
                    {"max_exposure", json_number(t.max_exposure)}, {"mean_exposure", json_number(t.mean_exposure)},
                    {"max_dose", json_number(t.max_dose)},         {"mean_dose", json_number(t.mean_dose)}};
  return j;
}

Json facts_json(const Comparison& c, const SurfaceFacts& f, std::size_t i) {
  Json j;
  j["label"] = c.labels[i];
  j["area"] = {{"reference", json_number(f.area)}, {"deformed", json_number(f.deformed_area)}};
  j["deforms"] = f.deforms;
  j["resultant"] = {{"reference", json_number(f.resultant)}, {"deformed", json_number(f.deformed_resultant)}};
  j["contact_force"] = f.contact_force ? json_vector(*f.contact_force) : Json(nullptr);
  j["resultant_over_contact_force"] = {{"reference", json_number(share_of_contact_force(f, CompareAreas::Reference))},
                                       {"deformed", json_number(share_of_contact_force(f, CompareAreas::Deformed))}};
  j["carried"] = json_number(f.carried);
  j["interface"] = nullptr;
  if (f.interface.compliance > 0)
    j["interface"] = {{"compliance", json_number(f.interface.compliance)},
                      {"stiffness", json_number(1 / f.interface.compliance)},
                      {"compliance_p5", json_number(f.interface.p5)},
                      {"compliance_p95", json_number(f.interface.p95)},
                      {"facets", f.interface.facets}};
  return j;
}

Json difference_json(const Comparison& c, const ComparedSurface& surface, const ComparedRegion& region, std::size_t i) {
  const SurfaceMeasures &a = region.results[i], &b = region.results.back();
  const PatternDifference& d = region.differences[i];
  Json j;
  j["label"] = c.labels[i];
  j["against"] = c.labels.back();
  j["same_mesh"] = surface.same_mesh[i] != 0;
  j["covered"] = json_number(surface.covered[i]);
  j["correlation"] = json_number(d.correlation);
  j["facet_correlation"] = json_number(region.facet_correlation[i]);
  j["rms"] = json_number(d.rms);
  j["mean"] = json_number(d.mean);
  j["largest"] = json_number(d.largest);
  j["dice"] = Json::array();
  for (std::size_t k = 0; k < d.dice.size(); ++k)
    j["dice"].push_back({{"above", c.thresholds[k]}, {"dice", json_number(d.dice[k])}});
  const Vector3d shift = a.center_of_pressure - b.center_of_pressure;
  j["center_of_pressure"] = json_vector(shift);
  j["center_of_pressure_distance"] = json_number(shift.norm());
  Json& p = j["percent"];
  for (const bool nodes : {true, false}) {
    Json& list = p[nodes ? "nodes" : "facets"] = Json::array();
    for (std::size_t k = 0; k < c.thresholds.size(); ++k)
      list.push_back(percent_json(nodes ? a.nodes[k] : a.facets[k], nodes ? b.nodes[k] : b.facets[k], c.thresholds[k]));
  }
  p["resultant"] = json_number(percent_difference(a.resultant.norm(), b.resultant.norm()));
  return j;
}

Json pose_json(const std::optional<BodyPose>& pose) {
  if (!pose) return nullptr;
  Json j;
  j["position"] = json_vector(pose->position);
  j["rotation"] = nullptr;
  if (pose->rotation) {
    const Eigen::AngleAxisd turn(pose->rotation->normalized());
    j["rotation"] = json_vector(turn.angle() * turn.axis());
  }
  return j;
}

/// Every number of a file about a region, with its column's name.
std::vector<Quantity> csv_quantities(const Comparison& c, const ComparedSurface& surface,
                                     const ComparedRegion& region) {
  std::vector<Quantity> out;
  for (std::size_t k = 0; k < c.thresholds.size(); ++k) {
    for (const bool nodes : {true, false}) {
      for (const auto& share : kShares) {
        const auto value = share.value;
        out.push_back(
            quantity("", fmt::format("{}_{}_above_{:g}", nodes ? "nodal" : "facet", share.name, c.thresholds[k]),
                     region, [=](const SurfaceMeasures& m) { return (nodes ? m.nodes[k] : m.facets[k]).*value; }));
      }
    }
  }
  const char* xyz[3] = {"x", "y", "z"};
  for (int k = 0; k < 3; ++k)
    out.push_back(quantity("", fmt::format("resultant_{}", xyz[k]), region,
                           [k](const SurfaceMeasures& m) { return m.resultant[k]; }));
  for (int k = 0; k < 3; ++k)
    out.push_back(quantity("", fmt::format("center_of_pressure_{}", xyz[k]), region,
                           [k](const SurfaceMeasures& m) { return m.center_of_pressure[k]; }));
  out.push_back(quantity("", "mean_penetration", region, [](const SurfaceMeasures& m) { return m.mean_penetration; }));
  out.push_back(quantity("", "max_penetration", region, [](const SurfaceMeasures& m) { return m.max_penetration; }));
  const std::pair<const char*, double TimeMeasures::*> sums[] = {
      {"max_peak_over_time", &TimeMeasures::max_peak}, {"mean_peak_over_time", &TimeMeasures::mean_peak},
      {"max_exposure", &TimeMeasures::max_exposure},   {"mean_exposure", &TimeMeasures::mean_exposure},
      {"max_dose", &TimeMeasures::max_dose},           {"mean_dose", &TimeMeasures::mean_dose}};
  for (const auto& sum : sums) {
    Quantity q{"", sum.first, {}};
    for (const TimeMeasures& m : region.over_time) q.values.push_back(m.*sum.second);
    out.push_back(std::move(q));
  }
  const auto difference = [&](const std::string& key, auto get) {
    Quantity q{"", key, {}};
    for (std::size_t i = 0; i < region.differences.size(); ++i) q.values.push_back(get(i));
    q.values.push_back(kNaN);
    out.push_back(std::move(q));
  };
  difference("correlation", [&](std::size_t i) { return region.differences[i].correlation; });
  difference("facet_correlation", [&](std::size_t i) { return region.facet_correlation[i]; });
  difference("rms_difference", [&](std::size_t i) { return region.differences[i].rms; });
  difference("mean_difference", [&](std::size_t i) { return region.differences[i].mean; });
  difference("largest_difference", [&](std::size_t i) { return region.differences[i].largest; });
  for (std::size_t k = 0; k < c.thresholds.size(); ++k)
    difference(fmt::format("dice_above_{:g}", c.thresholds[k]),
               [&, k](std::size_t i) { return region.differences[i].dice[k]; });
  difference("covered", [&](std::size_t i) { return surface.covered[i]; });
  return out;
}

}  // namespace

std::vector<TitledTable> compare_tables(const Comparison& c) {
  std::vector<TitledTable> tables;
  for (const ComparedSurface& surface : c.surfaces) {
    if (!surface.asked_for) {
      tables.push_back(
          {fmt::format("surface {}: not every file has pressure on it (--surface \"{}\" shows the numbers; "
                       "JSON and CSV have them)",
                       surface_title(surface), surface.names.front()),
           {}});
      continue;
    }
    std::string how;
    for (std::size_t i = 0; i + 1 < c.labels.size(); ++i)
      if (!surface.same_mesh[i]) how += fmt::format("; {} projected onto the mesh of {}", c.labels[i], c.labels.back());
    if (c.areas == CompareAreas::Deformed) how += "; deformed areas";
    for (const ComparedRegion& region : surface.regions)
      add_region_tables(c, surface, region,
                        fmt::format("surface {}{}{}", surface_title(surface),
                                    region.name.empty() ? std::string() : fmt::format(", region {}", region.name),
                                    region.name.empty() ? how : ""),
                        tables);
    const std::string interface = interface_text(c, surface);
    if (!interface.empty()) tables.push_back({interface, {}});
    if (!surface.profiles.empty()) tables.push_back(profile_table(c, surface));
  }
  if (c.bodies.empty()) return tables;
  Table bodies;
  bodies.headings = {"body"};
  for (const std::string& label : c.labels) bodies.headings.push_back(fmt::format("position {}", label));
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
      row.push_back(d && d->rotation ? short_number(kDegrees * d->rotation->norm()) : "-");
    }
    bodies.rows.push_back(std::move(row));
  }
  tables.push_back({"", std::move(bodies)});
  return tables;
}

std::string compare_text(const Comparison& c) {
  std::string text =
      c.units.empty() ? "units: the files' own (they name none)\n" : fmt::format("units: the files', {}\n", c.units);
  text += c.areas == CompareAreas::Deformed ? "areas: deformed, nodes moved by each file's own displacement\n"
                                            : "areas: of the mesh in the reference configuration\n";
  for (std::size_t i = 0; i < c.labels.size(); ++i)
    text += fmt::format("{}: {}, time {}{}\n", c.labels[i], c.paths[i], number_text(c.times[i]),
                        i + 1 == c.labels.size() ? " (differences are relative to it)" : "");
  return text + tables_text(compare_tables(c));
}

Json compare_json(const Comparison& c) {
  Json j;
  j["schema"] = "dea.compare/1";
  j["version"] = kVersion;
  j["reference"] = c.labels.back();
  j["units"] = c.units.empty() ? Json(nullptr) : Json(c.units);
  j["thresholds"] = c.thresholds;
  j["dose_above"] = c.dose_above ? Json(*c.dose_above) : Json(nullptr);
  j["areas"] = c.areas == CompareAreas::Deformed ? "deformed" : "reference";
  j["results"] = Json::array();
  for (std::size_t i = 0; i < c.labels.size(); ++i)
    j["results"].push_back({{"label", c.labels[i]}, {"file", c.paths[i]}, {"time", json_number(c.times[i])}});
  j["surfaces"] = Json::array();
  for (const ComparedSurface& surface : c.surfaces) {
    Json s;
    s["names"] = surface.names;
    s["facets"] = surface.facets;
    s["files"] = Json::array();
    for (std::size_t i = 0; i < c.labels.size(); ++i) s["files"].push_back(facts_json(c, surface.facts[i], i));
    s["regions"] = Json::array();
    for (const ComparedRegion& region : surface.regions) {
      Json r;
      r["name"] = region.name.empty() ? Json(nullptr) : Json(region.name);
      r["results"] = Json::array();
      for (std::size_t i = 0; i < c.labels.size(); ++i) r["results"].push_back(result_json(c, region, i));
      r["differences"] = Json::array();
      for (std::size_t i = 0; i + 1 < c.labels.size(); ++i)
        r["differences"].push_back(difference_json(c, surface, region, i));
      s["regions"].push_back(std::move(r));
    }
    if (!surface.profiles.empty()) {
      Json p;
      p["axis"] = json_vector(surface.axis);
      p["center"] = json_vector(surface.center);
      p["results"] = Json::array();
      for (std::size_t i = 0; i < c.labels.size(); ++i) {
        Json bins = Json::array();
        for (const ProfileBin& b : surface.profiles[i])
          bins.push_back(
              {{"from", b.from}, {"to", b.to}, {"area", json_number(b.area)}, {"mean", json_number(b.mean)}});
        p["results"].push_back({{"label", c.labels[i]}, {"bins", std::move(bins)}});
      }
      s["profile"] = std::move(p);
    }
    j["surfaces"].push_back(std::move(s));
  }
  j["bodies"] = Json::array();
  for (const ComparedBody& body : c.bodies) {
    Json b;
    b["name"] = body.name;
    b["results"] = Json::array();
    for (const auto& pose : body.results) b["results"].push_back(pose_json(pose));
    b["differences"] = Json::array();
    for (const auto& d : body.differences) {
      Json e = nullptr;
      if (d) {
        e = {{"translation", json_vector(d->translation)}, {"rotation", nullptr}};
        if (d->rotation) e["rotation"] = json_vector(*d->rotation);
      }
      b["differences"].push_back(std::move(e));
    }
    j["bodies"].push_back(std::move(b));
  }
  j["warnings"] = c.warnings;
  return j;
}

std::string compare_csv(const Comparison& c) {
  std::string text;
  for (const ComparedSurface& surface : c.surfaces) {
    for (const ComparedRegion& region : surface.regions) {
      const std::vector<Quantity> quantities = csv_quantities(c, surface, region);
      if (text.empty()) {
        text = "label,file,time,surface,region";
        for (const Quantity& q : quantities) text += fmt::format(",{}", q.key);
        text += ",areas\n";
      }
      for (std::size_t i = 0; i < c.labels.size(); ++i) {
        text += fmt::format("{},{},{},{},{}", csv_word(c.labels[i]), csv_word(c.paths[i]), csv_number(c.times[i]),
                            csv_word(surface.names[i]), csv_word(region.name));
        for (const Quantity& q : quantities) text += fmt::format(",{}", csv_number(q.values[i]));
        text += c.areas == CompareAreas::Deformed ? ",deformed\n" : ",reference\n";
      }
    }
  }
  return text;
}

}  // namespace dea

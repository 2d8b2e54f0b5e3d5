#include "views/data/compare_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "src/base/numbers.h"
#include "src/version.h"
#include "views/compare/quantities.h"
#include "views/data/csv.h"

namespace dea {

namespace {

Json distribution_json(const Distribution& d, double threshold) {
  Json j = {{"above", threshold}};
  j.update(numbers_json(d, kDistributionNumbers));
  return j;
}

/// The numbers of a table (kHeadlineNumbers): how far those of `a` are from those of `b`.
template <class Of, class Numbers>
void add_percents(const Of& a, const Of& b, const Numbers& numbers, Json& j) {
  for (const auto& number : numbers) j[number.name] = json_number(percent_difference(a.*number.value, b.*number.value));
}

Json percent_json(const Distribution& a, const Distribution& b, double threshold) {
  Json j = {{"above", threshold}};
  add_percents(a, b, kDistributionNumbers, j);
  return j;
}

Json result_json(const Comparison& c, const ComparedRegion& region, std::size_t i) {
  const SurfaceMeasures& m = region.results[i];
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
  j["over_time"] = numbers_json(region.over_time[i], kTimeNumbers);
  j["headline"] = headline_json(region.headlines[i]);
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
  add_percents(region.headlines[i], region.headlines.back(), kHeadlineNumbers, p["headline"]);
  j["covered_by_reference"] = json_number(surface.covered_by_reference[i]);
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

/// The columns after those of csv_quantities.
std::vector<Quantity> last_csv_quantities(const ComparedRegion& region) {
  std::vector<Quantity> out;
  for (const HeadlineNumber& number : kHeadlineNumbers) {
    out.push_back(headline_quantity(number, region));
    out.back().name.insert(0, "headline_");
  }
  out.push_back(quantity("headline_above", region.headlines, [](const Headline& h) { return h.above; }));
  return out;
}

/// Columns of the rows of elements under a whole surface; none where a region, or a surface without, has them.
std::vector<Quantity> inside_quantities(const Comparison& c, const ComparedSurface& surface,
                                        const ComparedRegion& region) {
  std::vector<Quantity> out;
  for (const InsideRow which : kInsideRows) {
    const auto row = std::find_if(surface.inside.begin(), surface.inside.end(),
                                  [which](const ComparedRow& r) { return r.row == which; });
    const bool there = row != surface.inside.end() && region.name.empty();
    for (std::size_t m = 0; m < 3; ++m) {
      const InsideMeasure& measure = kInsideMeasures[m];
      const std::string key = fmt::format("inside_{}_{}", name(which), measure.name);
      for (const InsideNumber& number : kInsideNumbers) {
        out.push_back({fmt::format("{}_{}", key, number.name), std::vector<double>(c.labels.size(), kNaN)});
        for (std::size_t i = 0; there && i < c.labels.size(); ++i)
          out.back().values[i] = row->results[i].*measure.value.*number.value;
      }
      out.push_back({key + "_correlation", std::vector<double>(c.labels.size(), kNaN)});
      for (std::size_t i = 0; there && i + 1 < c.labels.size(); ++i) out.back().values[i] = row->correlation[i][m];
    }
  }
  return out;
}

/// Every number of a file about a region, with its column's name.
std::vector<Quantity> csv_quantities(const Comparison& c, const ComparedSurface& surface,
                                     const ComparedRegion& region) {
  using M = const SurfaceMeasures&;
  std::vector<Quantity> out;
  for (std::size_t k = 0; k < c.thresholds.size(); ++k) {
    for (const bool nodes : {true, false}) {
      for (const DistributionNumber& share : kDistributionNumbers) {
        out.push_back(quantity(fmt::format("{}_{}_above_{:g}", nodes ? "nodal" : "facet", share.name, c.thresholds[k]),
                               region.results, [&](M m) { return (nodes ? m.nodes[k] : m.facets[k]).*share.value; }));
      }
    }
  }
  const auto vector = [&](const std::string& key, Vector3d SurfaceMeasures::*value) {
    for (int k = 0; k < 3; ++k)
      out.push_back(quantity(key + "xyz"[k], region.results, [=](M m) { return (m.*value)[k]; }));
  };
  vector("resultant_", &SurfaceMeasures::resultant);
  vector("center_of_pressure_", &SurfaceMeasures::center_of_pressure);
  out.push_back(quantity("mean_penetration", region.results, [](M m) { return m.mean_penetration; }));
  out.push_back(quantity("max_penetration", region.results, [](M m) { return m.max_penetration; }));
  for (const TimeNumber& sum : kTimeNumbers)
    out.push_back(quantity(sum.key, region.over_time, [&](const TimeMeasures& m) { return m.*sum.value; }));
  const auto difference = [&](const std::string& key, auto get) {
    out.push_back({key, {}});
    for (std::size_t i = 0; i < region.differences.size(); ++i) out.back().values.push_back(get(i));
    out.back().values.push_back(kNaN);
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

Json region_json(const Comparison& c, const ComparedSurface& surface, const ComparedRegion& region) {
  Json j;
  j["name"] = json_word(region.name);
  j["results"] = Json::array();
  for (std::size_t i = 0; i < c.labels.size(); ++i) j["results"].push_back(result_json(c, region, i));
  j["differences"] = Json::array();
  for (std::size_t i = 0; i + 1 < c.labels.size(); ++i)
    j["differences"].push_back(difference_json(c, surface, region, i));
  return j;
}

Json profile_json(const Comparison& c, const ComparedSurface& surface) {
  Json j;
  j["axis"] = json_vector(surface.axis);
  j["center"] = json_vector(surface.center);
  const auto bin = [](const ProfileBin& b) -> Json {
    return {{"from", b.from}, {"to", b.to}, {"area", json_number(b.area)}, {"mean", json_number(b.mean)}};
  };
  j["results"] = Json::array();
  for (std::size_t i = 0; i < c.labels.size(); ++i)
    j["results"].push_back({{"label", c.labels[i]}, {"bins", list_json(surface.profiles[i], bin)}});
  return j;
}

Json row_json(const Comparison& c, const ComparedRow& row) {
  Json j = {{"row", name(row.row)}, {"elements", row.elements}, {"volume", json_number(row.volume)}};
  j["results"] = Json::array();
  for (std::size_t i = 0; i < c.labels.size(); ++i) {
    Json result = {{"label", c.labels[i]}};
    for (const InsideMeasure& measure : kInsideMeasures)
      result[measure.name] = numbers_json(row.results[i].*measure.value, kInsideNumbers);
    j["results"].push_back(std::move(result));
  }
  j["differences"] = Json::array();
  for (std::size_t i = 0; i + 1 < c.labels.size(); ++i) {
    Json difference = {{"label", c.labels[i]}, {"against", c.labels.back()}};
    for (std::size_t m = 0; m < 3; ++m) {
      const InsideMeasure& measure = kInsideMeasures[m];
      Json& of = difference[measure.name];
      of["correlation"] = json_number(row.correlation[i][m]);
      for (const InsideNumber& number : kInsideNumbers)
        of["percent"][number.name] = json_number(inside_percent(row, i, measure, number));
    }
    j["differences"].push_back(std::move(difference));
  }
  return j;
}

Json surface_json(const Comparison& c, const ComparedSurface& surface) {
  Json j;
  j["names"] = surface.names;
  j["facets"] = surface.facets;
  j["files"] = Json::array();
  for (std::size_t i = 0; i < c.labels.size(); ++i) j["files"].push_back(facts_json(c, surface.facts[i], i));
  j["regions"] = list_json(surface.regions, [&](const ComparedRegion& r) { return region_json(c, surface, r); });
  if (!surface.profiles.empty()) j["profile"] = profile_json(c, surface);
  j["inside"] = list_json(surface.inside, [&](const ComparedRow& row) { return row_json(c, row); });
  return j;
}

Json compared_body_json(const ComparedBody& body) {
  Json j;
  j["name"] = body.name;
  j["results"] = list_json(body.results, pose_json);
  j["differences"] = list_json(body.differences, [](const std::optional<PoseDifference>& d) -> Json {
    if (!d) return nullptr;
    return {{"translation", json_vector(d->translation)},
            {"rotation", d->rotation ? json_vector(*d->rotation) : Json(nullptr)}};
  });
  return j;
}

}  // namespace

Json compare_json(const Comparison& c) {
  Json j;
  j["schema"] = "dea.compare/1";
  j["version"] = kVersion;
  j["reference"] = c.labels.back();
  j["units"] = json_word(c.units);
  j["thresholds"] = c.thresholds;
  j["dose_above"] = c.dose_above ? Json(*c.dose_above) : Json(nullptr);
  j["areas"] = c.areas == CompareAreas::Deformed ? "deformed" : "reference";
  j["results"] = Json::array();
  for (std::size_t i = 0; i < c.labels.size(); ++i)
    j["results"].push_back({{"label", c.labels[i]},
                            {"file", c.paths[i]},
                            {"time", json_number(c.times[i])},
                            {"solved", c.solved[i] != 0}});
  j["surfaces"] = list_json(c.surfaces, [&](const ComparedSurface& surface) { return surface_json(c, surface); });
  j["bodies"] = list_json(c.bodies, compared_body_json);
  j["warnings"] = c.warnings;
  j["unit_names"] = units_json(c.units);
  return j;
}

std::string compare_csv(const Comparison& c) {
  const bool inside =
      std::any_of(c.surfaces.begin(), c.surfaces.end(), [](const ComparedSurface& s) { return !s.inside.empty(); });
  std::string text;
  for (const ComparedSurface& surface : c.surfaces) {
    for (const ComparedRegion& region : surface.regions) {
      const std::vector<Quantity> quantities = csv_quantities(c, surface, region);
      std::vector<Quantity> last = last_csv_quantities(region);
      if (inside)
        for (Quantity& q : inside_quantities(c, surface, region)) last.push_back(std::move(q));
      last.push_back({"covered_by_reference", surface.covered_by_reference});
      last.back().values.push_back(kNaN);
      last.push_back({"solved", std::vector<double>(c.solved.begin(), c.solved.end())});
      if (text.empty()) {
        text = "label,file,time,surface,region";
        for (const Quantity& q : quantities) text += fmt::format(",{}", q.name);
        text += ",areas";
        for (const Quantity& q : last) text += fmt::format(",{}", q.name);
        text += '\n';
      }
      for (std::size_t i = 0; i < c.labels.size(); ++i) {
        text += fmt::format("{},{},{},{},{}", csv_word(c.labels[i]), csv_word(c.paths[i]), csv_number(c.times[i]),
                            csv_word(surface.names[i]), csv_word(region.name));
        for (const Quantity& q : quantities) text += fmt::format(",{}", csv_number(q.values[i]));
        text += c.areas == CompareAreas::Deformed ? ",deformed" : ",reference";
        for (const Quantity& q : last) text += fmt::format(",{}", csv_number(q.values[i]));
        text += '\n';
      }
    }
  }
  return text;
}

}  // namespace dea

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include <fmt/format.h>

#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/rules/look.h"

namespace dea {

namespace {

/// How far force and peak were off on a sphere, by how many facets contact is wide (docs/layer_law.md, 4, Long facets).
struct CoarseError {
  double across;    ///< facets, at most
  int force, peak;  ///< per cent
};
constexpr CoarseError kCoarseErrors[] = {{1.5, 40, 80}, {2.0, 40, 70}, {2.5, 25, 55}, {4.0, 10, 30}};
constexpr double kFineFacets = 0.3;  // thicknesses
constexpr double kCoarse = 1.05;     // thicknesses
constexpr int kMostTimes = 16;       // more is no mesh to be mended by dividing it

/// The facets of a layer in thicknesses, as they are divided. 0: bare.
double facet_size(const ContactPair& pair, const Layer& layer) { return layer.facet_size() / pair.refine; }

/// "type refine = 3 (9 times the springs)": facets of half a thickness. Empty: no division mends that.
Sentence finer_springs(const ContactPair& pair, double size) {
  const double times = std::ceil(size / 0.5);
  if (!(times <= kMostTimes)) return {};
  const int n = std::max(2, static_cast<int>(times));
  return say("type {} ({} times the springs)", NamedSetting{"refine", "", std::to_string(pair.refine * n)}, n * n);
}

NamedSetting twice_as_fine(const ContactPair& pair) { return {"refine", "", std::to_string(2 * pair.refine)}; }

}  // namespace

/// Law layer follows what flows within the size of the facets: facets of half the thickness or less are within 2 %
/// where contact is 8 of them wide, facets as long as the cartilage is thick 7 % and 17 % off in force and peak where
/// it is 4 wide. How wide it is the result tells (narrow_contact).
Findings long_facets(const JointModel& model, const Joint& joint) {
  Findings found;
  for (const ContactPair& pair : joint.contacts) {
    if (pair.law != Law::Layer) continue;
    double worst = 0.0;
    std::string sizes;
    for (const Layer& layer : pair.layers) {
      const double size = facet_size(pair, layer);
      if (!(size > kFineFacets)) continue;
      worst = std::max(worst, size);
      sizes +=
          fmt::format("{}{:.2g} on \"{}\"", sizes.empty() ? "" : ", ", size, model.surfaces[at(layer.surface)].name);
    }
    if (worst == 0) continue;
    const Sentence finer = finer_springs(pair, worst);
    found.push_back({worst <= kCoarse ? "facet-size" : "long-facets",
                     {.contact = pair.name},
                     {{"size", worst}, {"sizes", sizes}, {"refine", twice_as_fine(pair)}, {"finer", finer}},
                     worst > kCoarse && finer.empty() ? 1 : 0});
  }
  return found;
}

Findings few_springs(const JointModel&, const Joint& joint, const SolvedStates& result) {
  Findings found;
  for (const JudgedContact& c : judged_contacts(joint, result)) {
    const int active = c.statistics.springs_active;
    if (active < 20 && c.fields.sides[1 - c.pair.source].contact_area > 0)
      found.push_back({"few-springs",
                       c.subject(),
                       {{"springs", active}, {"refine", NamedSetting{"refine"}}, {"source", NamedSetting{"source"}}}});
    else if (active < 60 && active > 0 && c.pair.law == Law::Layer)
      found.push_back({"few-springs", c.subject(), {{"springs", active}, {"refine", twice_as_fine(c.pair)}}, 1});
  }
  return found;
}

/// A force that rests on a handful of springs though more are pressed: the map is one of the mesh.
Findings crowded_force(const JointModel&, const Joint& joint, const SolvedStates& result) {
  constexpr int kHandful = 8;
  Findings found;
  for (const JudgedContact& c : judged_contacts(joint, result)) {
    const ContactStatistics& s = c.statistics;
    if (s.springs_active < 20 || s.springs_most >= kHandful) continue;  // fewer: few_springs
    found.push_back({"crowded-force",
                     c.subject(),
                     {{"most", s.springs_most}, {"springs", s.springs_active}, {"refine", twice_as_fine(c.pair)}}});
  }
  return found;
}

/// A map whose facets are too long to show what presses them: of two or three facets, or where pressure ends at an edge
/// within facets, their averages do not tell how much of each is pressed, as the springs do.
Findings smeared_map(const JointModel& model, const Joint& joint, const SolvedStates& result) {
  constexpr double kFar = 1.2;  // pressure that fades out: contact of 3 facets; that of a block: of 7
  Findings found;
  for (const JudgedContact& c : judged_contacts(joint, result)) {
    const ContactStatistics& s = c.statistics;
    if (s.springs_active == 0 || !(s.headline.area > kFar * s.contact_area)) continue;
    found.push_back({"smeared-map",
                     c.subject(model, c.pair.source_layer()),
                     {{"area", s.headline.area},
                      {"mean", s.headline.mean},
                      {"p99", s.headline.p99},
                      {"springs_area", s.contact_area},
                      {"springs_mean", s.mean},
                      {"springs_p99", s.p99}}});
  }
  return found;
}

/// Contact of a few facets that are long against the cartilage: what flows between springs is not followed.
Findings narrow_contact(const JointModel& model, const Joint& joint, const SolvedStates& result) {
  Findings found;
  for (const JudgedContact& c : judged_contacts(joint, result)) {
    const ContactPair& pair = c.pair;
    if (pair.law != Law::Layer) continue;
    const double enough = std::rbegin(kCoarseErrors)->across / pair.refine;
    double least = kInfinity;
    const Layer* narrow = nullptr;
    for (int side = 0; side < 2; ++side) {
      const Layer& layer = pair.layers[side];
      if (!(facet_size(pair, layer) > kFineFacets)) continue;
      const std::vector<double>& pressure = c.fields.sides[side].pressure;
      if (pressure.empty()) continue;
      const double across = pair.refine * facets_across(layer, pressure, c.statistics.headline.above, enough);
      if (!(across > 0) || !(across < least)) continue;
      least = across;
      narrow = &layer;
    }
    const auto* off = std::find_if(std::begin(kCoarseErrors), std::end(kCoarseErrors),
                                   [&](const CoarseError& e) { return least <= e.across; });
    if (off == std::end(kCoarseErrors)) continue;
    const Sentence finer = finer_springs(pair, facet_size(pair, *narrow));
    found.push_back({"narrow-contact",
                     c.subject(model, *narrow),
                     {{"across", least},
                      {"size", facet_size(pair, *narrow)},
                      {"force_percent", off->force},
                      {"peak_percent", off->peak},
                      {"finer", finer.empty() ? Sentence("mesh it finer") : finer}},
                     off == std::begin(kCoarseErrors) ? 1 : 0});
  }
  return found;
}

/// Maps that do not carry the whole force.
Findings incomplete_map(const JointModel& model, const Joint& joint, const SolvedStates& result) {
  Findings found;
  for (const JudgedSide& s : judged_sides(model, joint, result)) {
    const bool moved = s.fields.springs && s.layer.part >= 0;  // the map is its springs', its normals those at rest
    if (const double factor = s.fields.resultant_factor; std::abs(factor - 1.0) > 0.02 && !moved)
      found.push_back({"incomplete-map", s.subject, {{"percent", 100.0 * factor}}});
  }
  return found;
}

}  // namespace dea

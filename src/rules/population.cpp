#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "src/base/numbers.h"
#include "src/rules/look.h"

namespace dea {

namespace {

/// What a contact is like, in what errors depend on.
struct ContactShape {
  double across;  ///< facets of the mesh across it, at its widest
  double width;   ///< the same in thicknesses of both layers
  double strain;  ///< the largest
  double edge;    ///< share of the force within one thickness of a free edge, of the layer that has more
  double nu;      ///< of the layer that has more
  double ratio;   ///< of the greater confined modulus to the other
};

/// A contact of the population (bench/population), and what dea's result differs by from FEBio's.
struct KnownContact {
  const char* joint;
  ContactShape shape;
  struct Difference {
    double p99, mean, area;  ///< per cent of FEBio's
  };
  Difference plain;      ///< as dea runs by itself
  Difference in_series;  ///< with the give of FEBio's contact between the surfaces (S9)
};
constexpr KnownContact kPopulation[] = {
#include "src/rules/population.inc"
};

/// How near a contact has to be to count as like another.
struct Nearness {
  double (*of)(const ContactShape&);
  double within;
};
constexpr Nearness kNearness[] = {{[](const ContactShape& s) { return std::log(s.across); }, 0.5},
                                  {[](const ContactShape& s) { return std::log(s.width); }, 0.5},
                                  {[](const ContactShape& s) { return s.strain; }, 0.08},
                                  {[](const ContactShape& s) { return s.edge; }, 0.15},
                                  {[](const ContactShape& s) { return s.nu; }, 0.08},
                                  {[](const ContactShape& s) { return std::log(s.ratio); }, 0.4}};
constexpr std::size_t kEnough = 10;

bool alike(const ContactShape& a, const ContactShape& b) {
  return std::all_of(std::begin(kNearness), std::end(kNearness),
                     [&](const Nearness& n) { return std::abs(n.of(a) - n.of(b)) <= n.within; });
}

/// Does the population have less and more of everything?
bool inside_population(const ContactShape& shape) {
  return std::all_of(std::begin(kNearness), std::end(kNearness), [&](const Nearness& n) {
    const auto [least, most] = std::minmax_element(
        std::begin(kPopulation), std::end(kPopulation),
        [&](const KnownContact& a, const KnownContact& b) { return n.of(a.shape) < n.of(b.shape); });
    return n.of(least->shape) <= n.of(shape) && n.of(shape) <= n.of(most->shape);
  });
}

/// Such as the population has: two layers of neo-Hookean cartilage of one nu by law layer as it is by default, each
/// pressed by this contact alone, on bodies that do not turn.
bool of_the_kind(const JointModel& model, const Joint& joint, const SolvedStates& result, const JudgedContact& c) {
  const ContactPair& pair = c.pair;
  const auto own = [&](const Layer& layer) {
    return !layer.rigid && layer.part < 0 && layer.planes.empty() && layer.material >= 0 &&
           model.materials[at(layer.material)].type == "neo-Hookean" &&
           (at(layer.body) >= result.free_to_turn.size() || !result.free_to_turn[at(layer.body)]) &&
           std::count_if(joint.contacts.begin(), joint.contacts.end(), [&](const ContactPair& other) {
             return other.layers[0].surface == layer.surface || other.layers[1].surface == layer.surface;
           }) == 1;
  };
  return pair.law == Law::Layer && pair.layer_fit == LayerFit::TwoTerms && pair.refine == 1 &&
         pair.facets == Facets::Curved && c.statistics.springs_active > 0 &&
         pair.layers[0].elasticity.nu == pair.layers[1].elasticity.nu && !c.state.equilibrium.unstable &&
         own(pair.layers[0]) && own(pair.layers[1]);
}

/// None: it is not of the kind, or has no width, for it carries next to nothing or ends nowhere.
std::optional<ContactShape> shape_of(const JointModel& model, const Joint& joint, const SolvedStates& result,
                                     const JudgedContact& c) {
  if (!of_the_kind(model, joint, result, c)) return std::nullopt;
  const Layer &source = c.pair.source_layer(), &target = c.pair.target_layer();
  const double across = facets_across(source, c.fields.sides[c.pair.source].pressure, c.statistics.headline.above);
  if (!(across > 0) || !std::isfinite(across)) return std::nullopt;
  ContactShape shape = {.across = across,
                        .width = across * source.facet_size() * source.mean_thickness() /
                                 (source.mean_thickness() + target.mean_thickness()),
                        .strain = c.statistics.largest_strain,
                        .edge = 0.0,
                        .nu = std::max(source.elasticity.nu, target.elasticity.nu),
                        .ratio = confined_modulus(source.elasticity.E, source.elasticity.nu) /
                                 confined_modulus(target.elasticity.E, target.elasticity.nu)};
  shape.ratio = std::max(shape.ratio, 1 / shape.ratio);
  for (const int side : {0, 1})
    if (const std::vector<double>& pressure = c.fields.sides[side].pressure; !pressure.empty())
      shape.edge = std::max(shape.edge, force_at_edges(c.pair.layers[side], pressure).share);
  return shape;
}

}  // namespace

/// What a contact is like; and what those of the population that are like it differed from FEBio by: at least ten of
/// them, and this one among all in every respect.
Findings contacts_like_this(const JointModel& model, const Joint& joint, const SolvedStates& result) {
  Findings found;
  for (const JudgedContact& c : judged_contacts(joint, result)) {
    const std::optional<ContactShape> shape = shape_of(model, joint, result, c);
    if (!shape) continue;
    found.push_back({"contact-shape",
                     c.subject(),
                     {{"across", shape->across},
                      {"width", shape->width},
                      {"strain", 100 * shape->strain},
                      {"edge", 100 * shape->edge},
                      {"nu", shape->nu},
                      {"ratio", shape->ratio}}});
    if (!inside_population(*shape)) continue;
    std::vector<const KnownContact*> near_by;
    for (const KnownContact& known : kPopulation)
      if (alike(known.shape, *shape)) near_by.push_back(&known);
    if (near_by.size() < kEnough) continue;
    std::vector<NamedValue> values = {{"contacts", near_by.size()}};
    using Difference = KnownContact::Difference;
    const auto add = [&](const std::string& name, Difference KnownContact::*kind, double Difference::*of) {
      const auto [least, most] = std::minmax_element(
          near_by.begin(), near_by.end(),
          [=](const KnownContact* a, const KnownContact* b) { return a->*kind.*of < b->*kind.*of; });
      values.push_back({name + "_least", (*least)->*kind.*of});
      values.push_back({name + "_most", (*most)->*kind.*of});
    };
    const auto add_all = [&](const std::string& before, Difference KnownContact::*kind) {
      add(before + "p99", kind, &Difference::p99);
      add(before + "mean", kind, &Difference::mean);
      add(before + "area", kind, &Difference::area);
    };
    const bool plain = c.pair.interface_compliance == 0;
    if (plain) add_all("", &KnownContact::plain);
    add_all(plain ? "series_" : "", &KnownContact::in_series);
    found.push_back({"contacts-like-this", c.subject(), values, plain ? 0 : 1});
  }
  return found;
}

}  // namespace dea

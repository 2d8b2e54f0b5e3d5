#include <algorithm>

#include "src/base/numbers.h"
#include "src/rules/look.h"

namespace dea {

namespace {

// Cartilage, menisci and discs lie between 0.1 and 100 MPa, joints between a finger's and a hip's; wide bounds beyond.
constexpr double kLeastUsual = 1e-3, kMostUsual = 2e3;  // MPa
constexpr double kLeastSize = 5e-4, kMostSize = 1.0;    // m, radius of gyration of an articular surface
// Without units: cartilage in Pa has more than 1e5, in kPa and MPa less; a joint in mm is larger than 2, in m smaller
// than 0.1. Numbers between are those of blocks of size 1, which are no joint's.
constexpr double kLeastInPascals = 2e5, kLeastInMillimetres = 2.0, kMostInMetres = 0.1, kMostInMegapascals = 1e4;
constexpr double kMostThicknessOverRadius = 0.25;  // at a third a ball's force is 27 % above FEBio's
constexpr double kMostSizes = 100.0;               // one surface of a contact over the other

/// A modulus, or a size, that no joint has in these units.
Findings odd_in_units(const std::string& surface, const Layer& layer, double size, const UnitNames& units) {
  const double metres = units.metres * size;
  if (const auto megapascals = odd_modulus(layer.elasticity.E, units))
    return {{"odd-units",
             {.surface = surface},
             {{"E", layer.elasticity.E}, {"megapascals", *megapascals}, {"system", units.system}}}};
  if (metres > kMostSize || metres < kLeastSize)
    return {{"odd-units", {.surface = surface}, {{"size", size}, {"metres", metres}, {"system", units.system}}, 1}};
  return {};
}

/// The same where the model names no units.
Findings odd_together(const std::string& surface, const Layer& layer, double size) {
  const double E = layer.elasticity.E;
  const char* as_if = E >= kLeastInPascals && size >= kLeastInMillimetres ? "E in Pa and lengths in mm"
                      : E <= kMostInMegapascals && size <= kMostInMetres  ? "E in MPa and lengths in m"
                                                                          : nullptr;
  if (as_if == nullptr) return {};
  return {{"odd-units",
           {.surface = surface},
           {{"E", E}, {"size", size}, {"as_if", as_if}, {"units", NamedSetting{"units", "", "mm-N-s"}}},
           2}};
}

}  // namespace

std::optional<double> odd_modulus(double E, const UnitNames& units) {
  const double megapascals = 1e-6 * units.newtons / (units.metres * units.metres) * E;
  if (!(units.metres > 0) || (megapascals <= kMostUsual && megapascals >= kLeastUsual)) return std::nullopt;
  return megapascals;
}

Findings odd_units(const JointModel& model, const Joint& joint) {
  const UnitNames units = unit_names(model.units);
  for (const ContactPair& pair : joint.contacts)
    for (const Layer& layer : pair.layers) {
      if (layer.rigid || layer.articular.size() == 0) continue;
      const std::string& surface = model.surfaces[at(layer.surface)].name;
      const double size = surface_extent(layer.articular).radius_of_gyration;
      Findings odd = units.metres > 0 ? odd_in_units(surface, layer, size, units) : odd_together(surface, layer, size);
      if (!odd.empty()) return odd;  // told of one surface: it is the whole model's
    }
  return {};
}

/// A layer thick against the radius it is curved with: nothing is thin about it.
Findings thick_layers(const JointModel& model, const Joint& joint) {
  Findings found;
  for (const ContactPair& pair : joint.contacts)
    for (const Layer& layer : pair.layers) {
      if (layer.rigid || layer.articular.size() == 0) continue;
      const SphereFit sphere = fit_sphere(layer.articular);
      const double thickness = layer.mean_thickness();
      if (thickness > kMostThicknessOverRadius * sphere.radius &&
          roundness(layer.articular, sphere) == Roundness::Round)
        found.push_back({"thick-on-its-radius",
                         {.surface = model.surfaces[at(layer.surface)].name},
                         {{"thickness", thickness}, {"ratio", thickness / sphere.radius}, {"radius", sphere.radius}}});
    }
  return found;
}

/// One body in metres, the other in millimetres.
Findings sizes_that_differ(const JointModel& model, const Joint& joint) {
  Findings found;
  for (const ContactPair& pair : joint.contacts) {
    if (pair.layers[0].articular.size() == 0 || pair.layers[1].articular.size() == 0) continue;
    const double a = surface_extent(pair.layers[0].articular).radius_of_gyration,
                 b = surface_extent(pair.layers[1].articular).radius_of_gyration;
    if (std::max(a, b) <= kMostSizes * std::min(a, b)) continue;
    const int large = a > b ? 0 : 1;
    found.push_back({"sizes-differ",
                     {.contact = pair.name, .surface = model.surfaces[at(pair.layers[large].surface)].name},
                     {{"size", std::max(a, b)},
                      {"other", model.surfaces[at(pair.layers[1 - large].surface)].name},
                      {"other_size", std::min(a, b)}}});
  }
  return found;
}

}  // namespace dea

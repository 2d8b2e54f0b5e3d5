#include "views/text/plausibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/files/unit_names.h"
#include "src/base/numbers.h"

namespace dea {

namespace {

// Cartilage, menisci and discs lie between 0.1 and 100 MPa, joints between a finger's and a hip's; wide bounds beyond.
constexpr double kLeastModulus = 1e-3, kMostModulus = 2e3;  // MPa
constexpr double kLeastSize = 5e-4, kMostSize = 1.0;        // m, radius of gyration of an articular surface
// Without units: cartilage in Pa has more than 1e5, in kPa and MPa less; a joint in mm is larger than 2, in m smaller
// than 0.1. Numbers between are those of blocks of size 1, which are no joint's.
constexpr double kLeastInPascals = 2e5, kLeastInMillimetres = 2.0, kMostInMetres = 0.1, kMostInMegapascals = 1e4;
constexpr double kMostThicknessOverRadius = 0.25;  // at a third a ball's force is 27 % above FEBio's

/// A modulus, or a size, that no joint has in these units.
std::string odd_in_units(const std::string& surface, const Layer& layer, double size, const UnitNames& units) {
  const double metres = units.metres * size;
  if (const std::string odd = odd_modulus(layer.elasticity.E, units.system); !odd.empty())
    return fmt::format("surface \"{}\": {}", surface, odd);
  if (metres > kMostSize || metres < kLeastSize)
    return fmt::format("surface \"{}\": its size, {:.3g}, is {:.3g} m in the model's units, {}: check the units",
                       surface, size, metres, units.system);
  return "";
}

/// The same where the model names no units.
std::string odd_together(const std::string& surface, const Layer& layer, double size, const Wording& wording) {
  const double E = layer.elasticity.E;
  const char* as_if = E >= kLeastInPascals && size >= kLeastInMillimetres ? "E in Pa and lengths in mm"
                      : E <= kMostInMegapascals && size <= kMostInMetres  ? "E in MPa and lengths in m"
                                                                          : nullptr;
  if (as_if == nullptr) return "";
  return fmt::format(
      "surface \"{}\": E = {:g} on a surface of size {:.3g} looks as if {}: forces would come out wrong by a million; "
      "convert the model to one system of units ({} only names it and changes no number)",
      surface, E, size, as_if, wording({"units", "", "mm-N-s"}));
}

/// A layer thick against the radius it is curved with: nothing is thin about it.
std::string thick_on_its_radius(const std::string& surface, const Layer& layer) {
  const SphereFit sphere = fit_sphere(layer.articular);
  const double thickness = layer.mean_thickness();
  if (!(thickness > kMostThicknessOverRadius * sphere.radius) || roundness(layer.articular, sphere) != Roundness::Round)
    return "";
  return fmt::format(
      "surface \"{}\": its mean thickness, {:.3g}, is {:.2g} times the radius of its sphere, {:.3g}: springs and "
      "the layer law suppose a thin layer, and pressures may come out well above FEBio's",
      surface, thickness, thickness / sphere.radius, sphere.radius);
}

}  // namespace

std::string odd_modulus(double E, const std::string& system) {
  const UnitNames units = unit_names(system);
  const double megapascals = 1e-6 * units.newtons / (units.metres * units.metres) * E;
  const bool odd = units.metres > 0 && (megapascals > kMostModulus || megapascals < kLeastModulus);
  if (!odd) return "";
  return fmt::format(
      "E = {:g} is {:.3g} MPa in the model's units, {}; cartilage has 0.1 to 100 MPa: check the modulus and the units",
      E, megapascals, units.system);
}

std::vector<std::string> implausible_numbers(const JointModel& model, const Joint& joint, const Wording& wording) {
  std::vector<std::string> lines;
  const auto add = [&](const std::string& text) {
    const std::string line = "warning: " + text;
    if (!text.empty() && std::find(lines.begin(), lines.end(), line) == lines.end()) lines.push_back(line);
  };
  bool odd_units = false;  // told of one surface: it is the whole model's
  const UnitNames units = unit_names(model.units);
  for (const ContactPair& pair : joint.contacts)
    for (const Layer& layer : pair.layers) {
      if (layer.rigid || layer.articular.size() == 0) continue;
      const std::string& surface = model.surfaces[at(layer.surface)].name;
      const double size = surface_extent(layer.articular).radius_of_gyration;
      const std::string odd =
          units.metres > 0 ? odd_in_units(surface, layer, size, units) : odd_together(surface, layer, size, wording);
      if (!odd_units) add(odd);
      odd_units = odd_units || !odd.empty();
      add(thick_on_its_radius(surface, layer));
    }
  return lines;
}

}  // namespace dea

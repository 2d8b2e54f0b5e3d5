#include <algorithm>

#include "src/base/numbers.h"
#include "src/rules/look.h"

namespace dea {

namespace {

/// The solved state with the largest strain of a contact; nullptr: none is solved.
const StateResult* most_strained(const SolvedStates& result, std::size_t contact) {
  const StateResult* worst = nullptr;
  const auto strain = [&](const StateResult& s) { return s.statistics[contact].largest_strain; };
  for (const StateResult& state : result.states)
    if (solved(state.equilibrium.outcome) && (worst == nullptr || strain(state) > strain(*worst))) worst = &state;
  return worst;
}

}  // namespace

/// Cartilage with fluid in it, solved with the constants of its drained solid.
Findings drained_cartilage(const JointModel& model, const Joint& joint) {
  Findings found;
  for (const ContactPair& pair : joint.contacts)
    for (const Layer& layer : pair.layers) {
      if (layer.rigid || layer.material < 0) continue;
      const Material& material = model.materials[at(layer.material)];
      // what the user gives for the layer is not the drained solid's
      if (!material.fluid || layer.elasticity.E != material.E || layer.elasticity.nu != material.nu) continue;
      const std::string& surface = model.surfaces[at(layer.surface)].name;
      found.push_back({"drained-cartilage",
                       {.surface = surface},
                       {{"material", material.name},
                        {"type", material.type.substr(0, material.type.find('/'))},
                        {"E", material.E},
                        {"nu", material.nu},
                        {"give_E", NamedSetting{"E", surface, "MODULUS"}},
                        {"give_nu", NamedSetting{"nu", surface, "0.49"}}}});
    }
  return found;
}

/// Cartilage pressed together by more than half, in any state.
Findings large_strains(const JointModel&, const Joint& joint, const SolvedStates& result) {
  constexpr double kLarge = 0.5;
  Findings found;
  for (std::size_t c = 0; c < joint.contacts.size(); ++c) {
    const StateResult* worst = most_strained(result, c);
    if (worst == nullptr || !(worst->statistics[c].largest_strain > kLarge)) continue;
    found.push_back({"large-strain",
                     {.contact = joint.contacts[c].name, .time = worst->when.time},
                     {{"percent", 100 * worst->statistics[c].largest_strain}}});
  }
  return found;
}

/// Parts are linear: pressed evenly they bear too little by about their strain; a beam that is turned by 6 or 20
/// degrees goes 0.5 or 6 % too far (docs/parts.md).
Findings strained_parts(const JointModel&, const Joint& joint, const SolvedStates& result) {
  constexpr double kStrain = 0.1, kTurn = 0.1;
  Findings found;
  for (std::size_t k = 0; k < joint.parts.size(); ++k) {
    double strain = 0.0, turn = 0.0;
    for (const StateResult& state : result.states) {
      if (k >= state.parts.size()) continue;
      strain = std::max(strain, state.parts[k].largest_strain);
      turn = std::max(turn, state.parts[k].largest_turn);
    }
    if (strain > kStrain || turn > kTurn)
      found.push_back(
          {"part-strained", {}, {{"part", joint.parts[k].name}, {"strain", 100 * strain}, {"turn", turn * 180 / kPi}}});
  }
  return found;
}

/// A material that FEBio softens where cartilage stiffens: beyond small strains dea's laws are another material.
Findings softening_material(const JointModel& model, const Joint& joint, const SolvedStates& result) {
  constexpr double kSmall = 0.03;
  Findings found;
  for (std::size_t c = 0; c < joint.contacts.size(); ++c) {
    const StateResult* worst = most_strained(result, c);
    if (worst == nullptr || !(worst->statistics[c].largest_strain > kSmall)) continue;
    for (const Layer& layer : joint.contacts[c].layers)
      if (!layer.rigid && layer.material >= 0 && model.materials[at(layer.material)].type == "isotropic elastic")
        found.push_back({"softening-material",
                         {.contact = joint.contacts[c].name, .time = worst->when.time},
                         {{"percent", 100 * worst->statistics[c].largest_strain},
                          {"material", model.materials[at(layer.material)].name}}});
  }
  return found;
}

}  // namespace dea

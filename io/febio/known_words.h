// io/febio/known_words.h – the parameters that FEBio knows in a material, condition, contact or controller:
// those that DEA takes and those that it does not need. What is neither is told, or refused if one that DEA takes may
// be meant.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "io/febio/component.h"

namespace dea::febio {

/// Where a type stands in a file: one word may mean two things ("force", "prescribe").
enum class Place {
  Material,
  Rigid,     ///< conditions and loads of rigid bodies, connectors
  Boundary,  ///< conditions on nodes
  Load,      ///< loads on nodes
  Contact,
  Spring,      ///< discrete materials
  Function,    ///< the force of a spring
  Controller,  ///< load controllers
  Control,     ///< of a step
};

/// The parameters of a component, by its type. Refuses one that DEA takes or tells that is given twice
/// with different values, for FEBio takes the last. A type that DEA does not read is not looked into.
void check_words(Draft& draft, Place place, const Component& component);
/// The same of a material and of those nested in it.
void check_material_words(Draft& draft, const Component& material);
/// A child of Control that DEA does not take.
void check_control_word(Draft& draft, Origin origin, std::string_view word);
/// The types of material whose parameters are known: those of which DEA knows E and nu.
std::vector<std::string> material_types();

}  // namespace dea::febio

// src/results/compartment_loads.h – what each compartment of a contact carries.
#pragma once
#include <optional>
#include <vector>

#include "src/equilibrium/equilibrium.h"
#include "src/results/fields.h"
#include "src/results/headline.h"
#include "src/results/inside_numbers.h"

namespace dea {

/// Of one compartment. NaN: undefined, it carries nothing.
struct CompartmentLoad {
  Headline headline;                  ///< of its share of the surface with springs, above the threshold of the whole
  Vector3d force = Vector3d::Zero();  ///< on the target, global axes; over all compartments it adds up to the contact's
  Vector3d center_of_pressure = Vector3d::Constant(kNaN);  ///< of its springs, current
  std::optional<InsideEnds> inside;                        ///< of its layer's share; none: not asked for, or no layer
};

/// The side of a contact whose compartments its results are told by: the one with springs if it has some, else the
/// other; -1: both are one piece.
int compartment_side(const ContactPair& pair);
/// Of that side; empty: none.
const std::vector<std::string>& compartment_names(const ContactPair& pair);

/// One per name, of contact `contact`. A spring belongs to the compartment it stands on, or, where the target has them,
/// presses; a facet without springs to the nearest. `fields`: of the same contact and equilibrium.
std::vector<CompartmentLoad> compartment_loads(const Joint& joint, const SpringBeds& beds, const FieldMaps& maps,
                                               const Equilibrium& e, const ContactFields& fields, std::size_t contact);

}  // namespace dea

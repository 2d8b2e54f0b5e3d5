// src/equilibrium/newton.h – Newton's method for the pose at which everything balances (E1).
#pragma once
#include "src/equilibrium/flat_directions.h"
#include "src/equilibrium/forces.h"
#include "src/equilibrium/search.h"

namespace dea {

/// Where a search ended.
struct Solution : SearchEnd {
  bool counted = false;  ///< the message is to end with how long the whole search was, of which this may be a part
  Evaluation at;
  Directions directions;  ///< there
};
/// From one pose on, with flat directions held or followed and steps that are cut to half the least thickness.
Solution newton(Problem& problem, Evaluation e, const EquilibriumOptions& options);

}  // namespace dea

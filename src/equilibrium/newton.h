// src/equilibrium/newton.h – Newton's method for the pose at which everything balances (E1), and the whole search for
// one load case from one start.
#pragma once
#include <vector>

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

/// Newton's method from `start`, out of springs that are passed too deep first; where it fails, what is out of balance
/// at the start is held back and released piece by piece (continuation.cpp).
Solution search_from(Problem& problem, const std::vector<Pose>& start, const EquilibriumOptions& options);

}  // namespace dea

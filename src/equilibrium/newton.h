// src/equilibrium/newton.h – Newton's method for the pose at which everything balances (E1).
#pragma once
#include <string>
#include <vector>

#include "src/equilibrium/flat_directions.h"
#include "src/equilibrium/forces.h"
#include "src/equilibrium/search.h"

namespace dea {

/// Where a search ended.
struct Solution {
  Outcome outcome = Outcome::NotConverged;
  std::string message;
  bool counted = false;  ///< the message is to end with how long the whole search was, of which this may be a part
  Sentence advice;       ///< what to do about it; may be empty
  Evaluation at;
  Directions directions;        ///< there
  std::vector<double> history;  ///< scaled residual / load at each iterate
  int iterations = 0;
};
/// From one pose on, with flat directions held or followed and steps that are cut to half the least thickness.
Solution newton(Problem& problem, Evaluation e, const EquilibriumOptions& options);

}  // namespace dea

// src/equilibrium/continuation.h – the whole search for one load case from one start.
#pragma once
#include <vector>

#include "src/equilibrium/newton.h"

namespace dea {

/// Newton's method from `start`, out of springs that are passed too deep first; where it fails, what is out of balance
/// at the start is held back and released piece by piece.
Solution search_from(Problem& problem, const std::vector<Pose>& start, const EquilibriumOptions& options);

}  // namespace dea

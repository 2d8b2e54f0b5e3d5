// src/results/neighbours.h – contacts that press one layer side by side (docs/theory.md, 2).
#pragma once
#include <optional>
#include <vector>

#include "src/joint/joint.h"
#include "src/results/fields.h"

namespace dea {

/// A contact that presses the layer near the line where another contact's facets begin, against what that one does
/// beyond. The layer's law takes it as pressing alike (Rim::Wall).
struct UnevenNeighbour {
  int other = -1;                  ///< index into Joint::contacts
  int surface = -1;                ///< of the contact itself
  double own = 0.0, beyond = 0.0;  ///< mean pressure within two thicknesses of the line
};

/// The worst one of contact `c`: where it presses with more than `above`, and the pressures on the two sides of the
/// line differ by more than 30 % of the larger one. Empty: there is none.
std::optional<UnevenNeighbour> uneven_neighbour(const Joint& joint, const std::vector<ContactFields>& fields, int c,
                                                double above);

}  // namespace dea

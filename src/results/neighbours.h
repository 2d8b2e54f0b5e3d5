// febiodea/results/neighbours.h – contacts that press one layer side by side (docs/theory.md, 2).
#pragma once
#include <vector>

#include <febiodea/joint/joint.h>
#include <febiodea/results/fields.h>

namespace dea {

/// A contact that presses the layer near the line where another contact's facets begin, against what that one does
/// beyond. The layer's law takes it as pressing alike (Rim::Wall).
struct UnevenNeighbour {
  int contact = -1, other = -1;    ///< indices into Joint::contacts
  int surface = -1;                ///< of `contact`
  double own = 0.0, beyond = 0.0;  ///< mean pressure within two thicknesses of the line
};

/// Those of contact `c` whose pressures on the two sides of the line differ by more than 30 % of the larger one, where
/// `c` itself presses with more than `above`.
std::vector<UnevenNeighbour> uneven_neighbours(const Joint& joint, const std::vector<ContactFields>& fields, int c,
                                               double above);

}  // namespace dea

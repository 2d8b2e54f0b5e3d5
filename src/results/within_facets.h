// src/results/within_facets.h – where within its facets a surface is pressed: results have averages over facets alone,
// and the edge of contact runs through facets. docs/theory.md, 6.1.
#pragma once
#include <vector>

#include "src/results/comparison.h"

namespace dea {

/// The part of a facet where pressure is above a threshold.
struct PressedPart {
  double share = 0.0;     ///< of the facet's area, 0 to 1
  double pressure = 0.0;  ///< the force on that part over the whole facet's area: at most the facet's average
};

/// One per facet. Whole are those with more than `above` around which all have more; nothing have those without
/// pressure. Between them, at the edge, pressure within a facet is taken as
///     p(x) = max(0, c_f + g_f . (x - x_f)),                                                                  (H2)
/// g_f in the facet's plane, by least squares from the c of the facets with pressure that share a node with it, each
/// weighted by 1 / distance^2 of the centres x (whole facets: c their pressure); c_f such that the facet keeps its
/// average. Exact where a linear pressure ends at a straight line. `pressure`: per facet.
std::vector<PressedPart> pressed_parts(const ResultSurface& surface, const std::vector<double>& pressure, double above);

}  // namespace dea

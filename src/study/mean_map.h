// src/study/mean_map.h – maps of several cases on the same surface: their mean, their spread, two groups compared.
//
// A field is one value per place (vertex or facet), a map one field per case. Means over the surface are weighted by
// area. A map is of whole fields: values that are not finite, fields of different sizes, areas that are negative or all
// 0, and no field at all are refused (UsageError), so leave failed cases out first.
#pragma once
#include <cstddef>
#include <vector>

#include "src/base/numbers.h"

namespace dea {

struct MeanMap {
  std::size_t cases = 0;
  std::vector<double> mean, standard_deviation;  ///< per place over cases, as in Moments; one case: no deviation, NaN
  std::vector<std::size_t> count;                ///< per place: cases that cover it
  double area_mean = kNaN;                       ///< of `mean` over the surface: sum of A x over sum of A
  double area_spread = kNaN;                     ///< root of the mean square of `standard_deviation` over the surface
};
/// `fields`: cases x places. `areas`: per place. `least` > 0: cases need not cover all places, as of several meshes on
/// one grid: NaN in a field is a place that its case does not cover; the map is NaN where fewer than `least` cases are.
MeanMap mean_map(const std::vector<std::vector<double>>& fields, const std::vector<double>& areas,
                 std::size_t least = 0);

/// Of two means: the first less the second; over the surface: of the places where both are there.
struct MapDifference {
  std::vector<double> difference;  ///< per place
  double area_mean = kNaN;         ///< of it over the surface
  double area_rms = kNaN;          ///< root of its mean square over the surface
};
MapDifference map_difference(const MeanMap& first, const MeanMap& second, const std::vector<double>& areas);

}  // namespace dea

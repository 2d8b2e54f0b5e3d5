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
  double area_mean = kNaN;                       ///< of `mean` over the surface: sum of A x over sum of A
  double area_spread = kNaN;                     ///< root of the mean square of `standard_deviation` over the surface
};
/// `fields`: cases x places. `areas`: per place.
MeanMap mean_map(const std::vector<std::vector<double>>& fields, const std::vector<double>& areas);

/// The same where cases need not cover all places, as of several meshes on one grid: NaN in a field is a place that its
/// case does not cover.
struct CoveredMeanMap {
  MeanMap map;                     ///< NaN where fewer than `least` cases are; over the surface: of all other places
  std::vector<std::size_t> count;  ///< per place: cases that cover it
  double covered_area = 0.0;       ///< of the places with a mean
};
/// `least`: 1 or more. Throws UsageError: other lengths, no field, infinite values, areas as above.
CoveredMeanMap covered_mean_map(const std::vector<std::vector<double>>& fields, const std::vector<double>& areas,
                                std::size_t least);

struct MapDifference {
  MeanMap first, second;
  std::vector<double> difference;  ///< per place: mean of the first group less that of the second
  double area_mean = kNaN;         ///< of it over the surface
  double area_rms = kNaN;          ///< root of its mean square over the surface
};
/// Of two means: the first less the second; over the surface: of the places where both are there.
MapDifference map_difference(MeanMap first, MeanMap second, const std::vector<double>& areas);
/// Groups need not have as many cases.
MapDifference map_difference(const std::vector<std::vector<double>>& first,
                             const std::vector<std::vector<double>>& second, const std::vector<double>& areas);

}  // namespace dea

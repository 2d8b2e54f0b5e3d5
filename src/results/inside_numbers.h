// src/results/inside_numbers.h – the numbers that sum up stress and strain inside a layer. docs/layer_law.md, 8.
#pragma once
#include <vector>

#include "src/base/numbers.h"

namespace dea {

/// Over the columns of a layer that are pressed (p > 0 around the vertex), weighted by their area; NaN without any.
struct InsideDistribution {
  double peak = kNaN, p99 = kNaN, mean = kNaN;
};
/// Of values weighted by area or volume. `least`: the peak is the least value, and p99 the first percentile.
InsideDistribution inside_distribution(const std::vector<double>& values, const std::vector<double>& weights,
                                       bool least);
/// At one height of a layer.
struct InsideStatistics {
  InsideDistribution max_shear;     ///< half the difference of the greatest and the least principal stress [MPa]
  InsideDistribution first_strain;  ///< greatest principal strain
  InsideDistribution
      third_strain;  ///< least principal strain, < 0: its peak is the least value, p99 the first percentile
};
/// Where a layer is bonded, and where it is pressed.
struct InsideEnds {
  InsideStatistics bone, surface;
  /// The greatest shear at the bone lies within so many thicknesses of a free edge, where the law knows least; 0: not.
  double peak_near_free_edge = 0.0;
};
/// Further from a free edge than so many thicknesses shear at the bone is within 12% of finite elements, as means over
/// a quarter thickness. Where the side wall overhangs by more than ten degrees, it is within 19% as far as
/// kNearOverhang, within 6% beyond. docs/layer_law.md, 8.
inline constexpr double kNearEdge = 1.0, kNearOverhang = 3.0;

/// By their names, in the order in which they are shown.
struct InsideEnd {
  const char *name, *words;
  InsideStatistics InsideEnds::*value;
};
struct InsideMeasure {
  const char *name, *words;
  bool stress;  ///< else a strain
  InsideDistribution InsideStatistics::*value;
};
struct InsideNumber {
  const char* name;
  double InsideDistribution::*value;
};
inline constexpr InsideEnd kInsideEnds[] = {{"bone", "at the bone", &InsideEnds::bone},
                                            {"surface", "at the surface", &InsideEnds::surface}};
inline constexpr InsideMeasure kInsideMeasures[] = {
    {"max_shear_stress", "max shear stress", true, &InsideStatistics::max_shear},
    {"first_principal_strain", "first principal strain", false, &InsideStatistics::first_strain},
    {"third_principal_strain", "third principal strain", false, &InsideStatistics::third_strain}};
inline constexpr InsideNumber kInsideNumbers[] = {
    {"peak", &InsideDistribution::peak}, {"p99", &InsideDistribution::p99}, {"mean", &InsideDistribution::mean}};

}  // namespace dea

// febiodea/results/percentile.h – percentiles by area or force.
#pragma once
#include <vector>

namespace dea {

/// Percentile of values weighted by `weights` (> 0): each sorted value stands at the middle of its share of the weight,
/// between them linear, beyond the first and last constant. Equal weights: the usual median. NaN for no values.
double weighted_percentile(const std::vector<double>& values, const std::vector<double>& weights, double fraction);

}  // namespace dea

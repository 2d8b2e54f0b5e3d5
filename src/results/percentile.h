// src/results/percentile.h – percentiles by area or force, or of values that count once.
#pragma once
#include <vector>

namespace dea {

/// Values in rising order, each with its weight, and the sum of the weights.
struct WeightedValues {
  std::vector<double> values, weights;
  double total = 0.0;
};
/// Equal values keep their order.
WeightedValues in_rising_order(const std::vector<double>& values, const std::vector<double>& weights);

/// Percentile of values weighted by `weights` (> 0): each sorted value stands at the middle of its share of the weight,
/// between them linear, beyond the first and last constant. Equal weights: the usual median. NaN for no values.
double percentile(const WeightedValues& sorted, double fraction);
double weighted_percentile(const std::vector<double>& values, const std::vector<double>& weights, double fraction);

/// Percentile of values in rising order, every value counting once: linear between the ranks 0 .. n - 1, which is type
/// 7 of Hyndman and Fan (1996, 10.1080/00031305.1996.10473566) and what numpy does. `fraction` in [0, 1]. NaN for no
/// values.
double percentile_of_sorted(const std::vector<double>& sorted, double fraction);

/// Sets p5 to p99 and the median of a distribution, whatever else it tells.
template <class Distribution>
void set_percentiles(Distribution& d, const WeightedValues& sorted) {
  d.p99 = percentile(sorted, 0.99);
  d.p95 = percentile(sorted, 0.95);
  d.p75 = percentile(sorted, 0.75);
  d.median = percentile(sorted, 0.5);
  d.p25 = percentile(sorted, 0.25);
  d.p5 = percentile(sorted, 0.05);
}

}  // namespace dea

#include "src/results/inside_numbers.h"

#include <algorithm>

#include "src/results/percentile.h"

namespace dea {

InsideDistribution inside_distribution(const std::vector<double>& values, const std::vector<double>& weights,
                                       bool least) {
  if (values.empty()) return {};
  InsideDistribution d;
  d.peak = least ? *std::min_element(values.begin(), values.end()) : *std::max_element(values.begin(), values.end());
  d.p99 = weighted_percentile(values, weights, least ? 0.01 : 0.99);
  double sum = 0.0, whole = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum += weights[i] * values[i];
    whole += weights[i];
  }
  d.mean = sum / whole;
  return d;
}

}  // namespace dea

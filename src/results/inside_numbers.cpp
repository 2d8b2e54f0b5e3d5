#include "src/results/inside_numbers.h"

#include <algorithm>
#include <numeric>

#include "src/results/percentile.h"

namespace dea {

InsideDistribution inside_distribution(const std::vector<double>& values, const std::vector<double>& weights,
                                       bool least) {
  if (values.empty()) return {};
  InsideDistribution d;
  d.peak = least ? *std::min_element(values.begin(), values.end()) : *std::max_element(values.begin(), values.end());
  d.p99 = weighted_percentile(values, weights, least ? 0.01 : 0.99);
  d.mean = std::inner_product(weights.begin(), weights.end(), values.begin(), 0.0) /
           std::accumulate(weights.begin(), weights.end(), 0.0);
  return d;
}

}  // namespace dea

#include "src/results/percentile.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

#include "src/base/numbers.h"

namespace dea {

WeightedValues in_rising_order(const std::vector<double>& values, const std::vector<double>& weights) {
  std::vector<std::pair<double, double>> both(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) both[i] = {values[i], weights[i]};
  std::stable_sort(both.begin(), both.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  WeightedValues sorted;
  sorted.values.reserve(both.size());
  sorted.weights.reserve(both.size());
  for (const auto& [value, weight] : both) {
    sorted.values.push_back(value);
    sorted.weights.push_back(weight);
  }
  sorted.total = std::accumulate(weights.begin(), weights.end(), 0.0);
  return sorted;
}

double percentile(const WeightedValues& sorted, double fraction) {
  const std::vector<double>&values = sorted.values, &weights = sorted.weights;
  if (values.empty() || !(sorted.total > 0)) return kNaN;
  const double wanted = fraction * sorted.total;
  double below = 0.0, previous_middle = 0.0, previous_value = values.front();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double middle = below + 0.5 * weights[i];
    if (middle >= wanted) {
      if (i == 0 || middle <= previous_middle) return values[i];
      return previous_value + (values[i] - previous_value) * (wanted - previous_middle) / (middle - previous_middle);
    }
    below += weights[i];
    previous_middle = middle;
    previous_value = values[i];
  }
  return values.back();
}

double weighted_percentile(const std::vector<double>& values, const std::vector<double>& weights, double fraction) {
  return percentile(in_rising_order(values, weights), fraction);
}

double percentile_of_sorted(const std::vector<double>& sorted, double fraction) {
  if (sorted.empty()) return kNaN;
  const double rank = fraction * static_cast<double>(sorted.size() - 1);
  const std::size_t low = static_cast<std::size_t>(rank), high = std::min(low + 1, sorted.size() - 1);
  return sorted[low] + (rank - static_cast<double>(low)) * (sorted[high] - sorted[low]);
}

}  // namespace dea

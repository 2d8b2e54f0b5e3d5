#include <febiodea/results/percentile.h>

#include <algorithm>
#include <cstddef>
#include <numeric>

#include <febiodea/base/numbers.h>

namespace dea {

double weighted_percentile(const std::vector<double>& values, const std::vector<double>& weights, double fraction) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return values[a] < values[b] || (values[a] == values[b] && a < b); });
  double total = 0.0;
  for (double w : weights) total += w;
  if (order.empty() || !(total > 0)) return kNaN;
  const double wanted = fraction * total;
  double below = 0.0, previous_middle = 0.0, previous_value = values[order.front()];
  for (std::size_t i = 0; i < order.size(); ++i) {
    const double middle = below + 0.5 * weights[order[i]];
    if (middle >= wanted) {
      if (i == 0 || middle <= previous_middle) return values[order[i]];
      return previous_value +
             (values[order[i]] - previous_value) * (wanted - previous_middle) / (middle - previous_middle);
    }
    below += weights[order[i]];
    previous_middle = middle;
    previous_value = values[order[i]];
  }
  return values[order.back()];
}

double percentile_of_sorted(const std::vector<double>& sorted, double fraction) {
  if (sorted.empty()) return kNaN;
  const double rank = fraction * static_cast<double>(sorted.size() - 1);
  const std::size_t low = static_cast<std::size_t>(rank), high = std::min(low + 1, sorted.size() - 1);
  return sorted[low] + (rank - static_cast<double>(low)) * (sorted[high] - sorted[low]);
}

}  // namespace dea

#include "src/study/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "src/base/error.h"
#include "src/results/percentile.h"

namespace dea {

namespace {

std::vector<double> sorted(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values;
}

/// Summed in rising order, so that the order of cases does not matter.
Moments moments_of_sorted(const std::vector<double>& values) {
  Moments m;
  m.count = values.size();
  if (values.empty()) return m;
  const double n = static_cast<double>(m.count);
  double sum = 0.0, squares = 0.0;
  for (double x : values) sum += x;
  // rounding shall not carry the mean of equal values off them
  m.mean = std::clamp(sum / n, values.front(), values.back());
  for (double x : values) squares += (x - m.mean) * (x - m.mean);
  if (m.count > 1) m.standard_deviation = std::sqrt(squares / (n - 1));
  return m;
}

}  // namespace

FiniteValues finite_values(const std::vector<double>& values) {
  FiniteValues finite;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    finite.values.push_back(values[i]);
    finite.index.push_back(i);
  }
  finite.left_out = values.size() - finite.values.size();
  return finite;
}

Moments moments(const std::vector<double>& values) { return moments_of_sorted(sorted(values)); }

BoxPlot box_plot(const std::vector<double>& values) {
  BoxPlot b;
  const FiniteValues finite = finite_values(values);
  const std::vector<double> v = sorted(finite.values);
  b.count = v.size();
  b.left_out = finite.left_out;
  if (v.empty()) return b;
  b.least = v.front();
  b.largest = v.back();
  b.q1 = percentile_of_sorted(v, 0.25);
  b.median = percentile_of_sorted(v, 0.5);
  b.q3 = percentile_of_sorted(v, 0.75);
  const double reach = 1.5 * (b.q3 - b.q1), lowest = b.q1 - reach, highest = b.q3 + reach;
  // a quartile between two values may have none within reach on its side: then the whisker has no length
  b.lower_whisker = std::min(b.q1, *std::find_if(v.begin(), v.end(), [&](double x) { return x >= lowest; }));
  b.upper_whisker = std::max(b.q3, *std::find_if(v.rbegin(), v.rend(), [&](double x) { return x <= highest; }));
  for (std::size_t i = 0; i < finite.values.size(); ++i)
    if (finite.values[i] < lowest || finite.values[i] > highest) b.outliers.push_back(finite.index[i]);
  const Moments m = moments_of_sorted(v);
  b.mean = m.mean;
  b.standard_deviation = m.standard_deviation;
  return b;
}

CycleBand cycle_band(const std::vector<std::vector<double>>& lines, double low, double high) {
  CycleBand band;
  for (const std::vector<double>& line : lines) require_count("a line", line.size(), lines.front().size());
  const std::size_t instants = lines.empty() ? 0 : lines.front().size();
  for (std::size_t k = 0; k < instants; ++k) {
    std::vector<double> across;
    for (const std::vector<double>& line : lines) across.push_back(line[k]);
    const std::vector<double> v = sorted(finite_values(across).values);
    const Moments m = moments_of_sorted(v);
    band.count.push_back(m.count);
    band.mean.push_back(m.mean);
    band.standard_deviation.push_back(m.standard_deviation);
    band.median.push_back(percentile_of_sorted(v, 0.5));
    band.low.push_back(percentile_of_sorted(v, low));
    band.high.push_back(percentile_of_sorted(v, high));
  }
  return band;
}

std::vector<double> percent_of_cycle(const std::vector<double>& times) {
  require_rising(times);
  if (times.size() < 2) throw UsageError(fmt::format("a cycle of {} instants, expected two or more", times.size()));
  std::vector<double> percent;
  for (double t : times) percent.push_back(100.0 * ((t - times.front()) / (times.back() - times.front())));
  return percent;
}

std::vector<double> at_instants(const std::vector<double>& times, const std::vector<double>& values,
                                const std::vector<double>& instants) {
  require_rising(times);
  require_count("values over time", values.size(), times.size());
  std::vector<double> result;
  for (double t : instants) {
    const auto after = std::lower_bound(times.begin(), times.end(), t);  // NaN: the first
    if (after == times.end() || !(t >= times.front())) {
      result.push_back(kNaN);
      continue;
    }
    const std::size_t i = static_cast<std::size_t>(after - times.begin());
    if (*after == t)
      result.push_back(values[i]);
    else
      result.push_back(values[i - 1] + (values[i] - values[i - 1]) * ((t - times[i - 1]) / (times[i] - times[i - 1])));
  }
  return result;
}

bool rises(const std::vector<double>& times) {
  return std::adjacent_find(times.begin(), times.end(), [](double a, double b) { return !(b > a); }) == times.end();
}

void require_rising(const std::vector<double>& times) {
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!std::isfinite(times[i]))
      throw UsageError(fmt::format("time {} of {} is no finite number", i + 1, times.size()));
    if (i > 0 && !(times[i] > times[i - 1]))
      throw UsageError(fmt::format("time {} ({}) follows {}, expected times that rise", i + 1, times[i], times[i - 1]));
  }
}

void require_count(const char* what, std::size_t found, std::size_t expected) {
  if (found != expected) throw UsageError(fmt::format("{}: {} values, expected {}", what, found, expected));
}

}  // namespace dea

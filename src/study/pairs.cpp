#include "src/study/pairs.h"

#include <algorithm>
#include <array>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "src/results/percentile.h"

namespace dea {

namespace {

constexpr double kNormal95 = 1.959963984540054;  // 97.5 % of a standard normal distribution lie below
constexpr double kConfidence = 0.95;             // share of the intervals that hold the true number

double degrees_of_freedom(std::size_t count) { return static_cast<double>(count) - 1.0; }

/// center -+ t standard_error, where t is the (1 + kConfidence) / 2 quantile of Student's distribution. NaN where the
/// error is, or without a degree of freedom.
Interval student_interval(double center, double standard_error, double degrees) {
  if (!std::isfinite(standard_error) || !(degrees > 0)) return {};
  const boost::math::students_t_distribution<double> student(degrees);
  const double reach = boost::math::quantile(student, 0.5 * (1 + kConfidence)) * standard_error;
  return {center - reach, center + reach};
}

EffectSize effect_size(double difference, double deviation, double degrees) {
  if (!(deviation > 0)) return {};
  const double d = difference / deviation;
  return {d, hedges_correction(degrees) * d};
}

}  // namespace

CompletePairs complete_pairs(const std::vector<double>& first, const std::vector<double>& second) {
  require_count("second of the pairs", second.size(), first.size());
  CompletePairs pairs;
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (!std::isfinite(first[i]) || !std::isfinite(second[i])) continue;
    pairs.first.push_back(first[i]);
    pairs.second.push_back(second[i]);
  }
  pairs.left_out = first.size() - pairs.first.size();
  return pairs;
}

PairedDifference paired_difference(const CompletePairs& pairs) {
  std::vector<double> d;
  for (std::size_t i = 0; i < pairs.first.size(); ++i) d.push_back(pairs.first[i] - pairs.second[i]);
  std::sort(d.begin(), d.end());
  const Moments m = moments(d);
  const double n = static_cast<double>(m.count), degrees = degrees_of_freedom(m.count), s = m.standard_deviation;
  PairedDifference result;
  result.pairs = m.count;
  result.left_out = pairs.left_out;
  result.mean = m.mean;
  result.standard_deviation = s;
  result.mean_interval = student_interval(m.mean, s / std::sqrt(n), degrees);
  result.median = percentile_of_sorted(d, 0.5);
  result.effect = effect_size(m.mean, s, degrees);
  const double reach = kNormal95 * s, error = s * std::sqrt(1.0 / n + kNormal95 * kNormal95 / (2 * degrees));
  result.limits = {m.mean - reach, m.mean + reach};
  result.lower_limit_interval = student_interval(result.limits.low, error, degrees);
  result.upper_limit_interval = student_interval(result.limits.high, error, degrees);
  return result;
}

MeanDifference mean_difference(const std::vector<double>& first, const std::vector<double>& second) {
  MeanDifference result;
  const std::array<Moments, 2> m = {moments(finite_values(first).values), moments(finite_values(second).values)};
  double variance = 0.0, spread = 0.0, squares = 0.0, degrees = 0.0;
  for (std::size_t k = 0; k < 2; ++k) {
    const double own = degrees_of_freedom(m[k].count), s = m[k].standard_deviation;
    const double v = s * s / static_cast<double>(m[k].count);
    result.count[k] = m[k].count;
    variance += v;
    spread += v * v / own;
    degrees += own;
    if (m[k].count > 1) squares += own * s * s;
  }
  result.mean = m[0].mean - m[1].mean;
  if (variance > 0) result.interval = student_interval(result.mean, std::sqrt(variance), variance * variance / spread);
  if (m[0].count > 0 && m[1].count > 0 && degrees > 0)
    result.effect = effect_size(result.mean, std::sqrt(squares / degrees), degrees);
  return result;
}

double hedges_correction(double degrees_of_freedom) {
  const double half = 0.5 * degrees_of_freedom;
  if (!(half > 0.5)) return kNaN;
  return std::exp(std::lgamma(half) - std::lgamma(half - 0.5)) / std::sqrt(half);
}

}  // namespace dea

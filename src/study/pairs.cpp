#include "src/study/pairs.h"

#include <algorithm>
#include <array>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "src/results/percentile.h"

namespace dea {

namespace {

constexpr double kNormal95 = 1.959963984540054;  // 97.5 % of a standard normal distribution lie below

std::vector<double> differences(const CompletePairs& pairs) {
  std::vector<double> d;
  for (std::size_t i = 0; i < pairs.first.size(); ++i) d.push_back(pairs.first[i] - pairs.second[i]);
  return d;
}

double root_of_count(std::size_t count) { return std::sqrt(static_cast<double>(count)); }

double degrees_of_freedom(std::size_t count) { return static_cast<double>(count) - 1.0; }

/// Moments of the finite values of two groups; `result` gets how many there are and how many were left out.
template <class Result>
std::array<Moments, 2> moments_of_both(const std::vector<double>& first, const std::vector<double>& second,
                                       Result& result) {
  std::array<Moments, 2> m;
  for (std::size_t k = 0; k < 2; ++k) {
    const FiniteValues group = finite_values(k == 0 ? first : second);
    m[k] = moments(group.values);
    result.count[k] = m[k].count;
    result.left_out[k] = group.left_out;
  }
  return m;
}

/// `difference` over `deviation`, corrected.
void set_size(EffectSize& size, double difference, double deviation, double degrees) {
  if (!(deviation > 0)) return;
  size.d = difference / deviation;
  size.corrected = hedges_correction(degrees) * size.d;
}

}  // namespace

CompletePairs complete_pairs(const std::vector<double>& first, const std::vector<double>& second) {
  require_count("second of the pairs", second.size(), first.size());
  CompletePairs pairs;
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (!std::isfinite(first[i]) || !std::isfinite(second[i])) continue;
    pairs.first.push_back(first[i]);
    pairs.second.push_back(second[i]);
    pairs.index.push_back(i);
  }
  pairs.left_out = first.size() - pairs.index.size();
  return pairs;
}

Interval student_interval(double center, double standard_error, double degrees_of_freedom) {
  if (!std::isfinite(standard_error) || !(degrees_of_freedom > 0)) return {};
  const boost::math::students_t_distribution<double> student(degrees_of_freedom);
  const double reach = boost::math::quantile(student, 0.5 * (1 + kConfidence)) * standard_error;
  return {center - reach, center + reach};
}

PairedDifference paired_difference(const std::vector<double>& first, const std::vector<double>& second) {
  const CompletePairs pairs = complete_pairs(first, second);
  std::vector<double> d = differences(pairs);
  std::sort(d.begin(), d.end());
  const Moments m = moments(d);
  PairedDifference result;
  result.pairs = m.count;
  result.left_out = pairs.left_out;
  result.mean = m.mean;
  result.standard_deviation = m.standard_deviation;
  result.mean_interval =
      student_interval(m.mean, m.standard_deviation / root_of_count(m.count), degrees_of_freedom(m.count));
  result.median = percentile_of_sorted(d, 0.5);
  return result;
}

BlandAltman bland_altman(const std::vector<double>& first, const std::vector<double>& second) {
  const CompletePairs pairs = complete_pairs(first, second);
  const PairedDifference d = paired_difference(first, second);
  BlandAltman b;
  b.pairs = d.pairs;
  b.left_out = d.left_out;
  b.index = pairs.index;
  b.difference = differences(pairs);
  for (std::size_t i = 0; i < d.pairs; ++i) b.mean.push_back(0.5 * (pairs.first[i] + pairs.second[i]));
  b.bias = d.mean;
  b.standard_deviation = d.standard_deviation;
  b.bias_interval = d.mean_interval;
  const double reach = kNormal95 * d.standard_deviation, degrees = degrees_of_freedom(d.pairs);
  b.limits = {b.bias - reach, b.bias + reach};
  const double error =
      d.standard_deviation * std::sqrt(1.0 / static_cast<double>(d.pairs) + kNormal95 * kNormal95 / (2 * degrees));
  b.lower_limit_interval = student_interval(b.limits.low, error, degrees);
  b.upper_limit_interval = student_interval(b.limits.high, error, degrees);
  return b;
}

MeanDifference mean_difference(const std::vector<double>& first, const std::vector<double>& second) {
  MeanDifference result;
  const std::array<Moments, 2> m = moments_of_both(first, second, result);
  double variance = 0.0, spread = 0.0;
  for (const Moments& of : m) {
    const double v = of.standard_deviation * of.standard_deviation / static_cast<double>(of.count);
    variance += v;
    spread += v * v / degrees_of_freedom(of.count);
  }
  result.mean = m[0].mean - m[1].mean;
  if (!(variance > 0)) return result;
  result.degrees_of_freedom = variance * variance / spread;
  result.interval = student_interval(result.mean, std::sqrt(variance), result.degrees_of_freedom);
  return result;
}

EffectSize cohen_d(const std::vector<double>& first, const std::vector<double>& second) {
  EffectSize size;
  const std::array<Moments, 2> m = moments_of_both(first, second, size);
  double squares = 0.0, degrees = 0.0;
  for (const Moments& of : m) {
    const double own = degrees_of_freedom(of.count);
    degrees += own;
    if (of.count > 1) squares += own * of.standard_deviation * of.standard_deviation;
  }
  if (size.count[0] > 0 && size.count[1] > 0 && degrees > 0)
    set_size(size, m[0].mean - m[1].mean, std::sqrt(squares / degrees), degrees);
  return size;
}

EffectSize paired_d_z(const std::vector<double>& first, const std::vector<double>& second) {
  const PairedDifference d = paired_difference(first, second);
  EffectSize size;
  for (std::size_t k = 0; k < 2; ++k) {
    size.count[k] = d.pairs;
    size.left_out[k] = d.left_out;
  }
  set_size(size, d.mean, d.standard_deviation, degrees_of_freedom(d.pairs));
  return size;
}

double hedges_correction(double degrees_of_freedom) {
  const double half = 0.5 * degrees_of_freedom;
  if (!(half > 0.5)) return kNaN;
  return std::exp(std::lgamma(half) - std::lgamma(half - 0.5)) / std::sqrt(half);
}

}  // namespace dea

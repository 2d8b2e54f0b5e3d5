// src/study/pairs.h – two numbers of the same cases, or one number of two groups: differences, agreement, sizes of
// effects. Intervals say how far the samples settle a number; nothing here is called significant.
//
// A difference is always first minus second. A pair of which one value is not finite is left out and counted. Two lists
// of different lengths are no pairs: UsageError.
#pragma once
#include <cstddef>
#include <vector>

#include "src/study/summary.h"

namespace dea {

/// The pairs of which both values are finite, in their order.
struct CompletePairs {
  std::vector<double> first, second;
  std::size_t left_out = 0;
};
CompletePairs complete_pairs(const std::vector<double>& first, const std::vector<double>& second);

/// A difference of means over a standard deviation: no unit.
struct EffectSize {
  double d = kNaN;          ///< NaN: too few values, or they do not vary
  double corrected = kNaN;  ///< hedges_correction times d
};
/// What d is too large by in small samples (Hedges 1981, 10.3102/10769986006002107, exact):
///     J(m) = Gamma(m / 2) / (sqrt(m / 2) Gamma((m - 1) / 2)),  m > 1 degrees of freedom; else NaN
double hedges_correction(double degrees_of_freedom);

/// The differences within pairs, and how far two methods agree on the same cases (Bland and Altman 1986,
/// 10.1016/S0140-6736(86)90837-8). With the mean d and standard deviation s of the n differences:
///     limits of agreement            d -+ 1.96 s
///     standard error of the mean     s / sqrt(n)
///     standard error of a limit      s sqrt(1 / n + 1.96^2 / (2 (n - 1)))
/// the last one by Bland and Altman 1999 (10.1177/096228029900800204), who round it to sqrt(3 / n) s in 1986. All
/// intervals are Student's with n - 1 degrees of freedom.
struct PairedDifference {
  std::size_t pairs = 0, left_out = 0;
  double mean = kNaN, standard_deviation = kNaN;  ///< as in Moments
  Interval mean_interval;
  double median = kNaN;  ///< of the differences, not the difference of medians
  /// d_z: mean of the differences over their standard deviation (Cohen 1988, chapter 2; Lakens 2013,
  /// 10.3389/fpsyg.2013.00863), corrected with n - 1 degrees of freedom.
  EffectSize effect;
  Interval limits, lower_limit_interval, upper_limit_interval;
};
PairedDifference paired_difference(const CompletePairs& pairs);

/// Of the means of two groups, whose variances may differ (Welch 1947, 10.1093/biomet/34.1-2.28): with v_k = s_k^2 /
/// n_k
///     standard error      sqrt(v_1 + v_2)
///     degrees of freedom  (v_1 + v_2)^2 / (v_1^2 / (n_1 - 1) + v_2^2 / (n_2 - 1))
struct MeanDifference {
  std::size_t count[2] = {0, 0};  ///< finite values of the first and the second list
  double mean = kNaN;             ///< m1 - m2
  Interval interval;              ///< Student's; none where a group has fewer than two values, or neither varies
  /// Cohen's d, over the pooled standard deviation (Cohen 1988, Statistical Power Analysis, chapter 2), and Hedges' g:
  ///     d = (m1 - m2) / sqrt(((n1 - 1) s1^2 + (n2 - 1) s2^2) / (n1 + n2 - 2))
  EffectSize effect;
};
MeanDifference mean_difference(const std::vector<double>& first, const std::vector<double>& second);

}  // namespace dea

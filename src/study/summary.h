// src/study/summary.h – one number of many cases: quartiles, whiskers, mean and spread; bands over a cycle.
//
// Everywhere in a study's numbers: a value that is NaN or infinite is that of a failed case. It is left out and
// counted, never taken for a number. Nothing depends on the order of the cases, to the last bit. Units are those of the
// values.
#pragma once
#include <cstddef>
#include <vector>

#include "src/base/numbers.h"

namespace dea {

/// Ends of an interval; NaN: there is none.
struct Interval {
  double low = kNaN, high = kNaN;
};

/// The finite ones of some values, in their order.
struct FiniteValues {
  std::vector<double> values;
  std::vector<std::size_t> index;  ///< per value: where it stood
  std::size_t left_out = 0;
};
FiniteValues finite_values(const std::vector<double>& values);

/// Mean and standard deviation (of a sample: the sum of squares over n - 1) of finite values.
struct Moments {
  std::size_t count = 0;
  double mean = kNaN;                ///< NaN: no value
  double standard_deviation = kNaN;  ///< NaN: fewer than two
};
Moments moments(const std::vector<double>& values);

/// What a box plot shows. Quartiles: percentile_of_sorted (type 7 of Hyndman and Fan 1996). Whiskers reach to the last
/// values within 1.5 (q3 - q1) of the box (Tukey 1977, Exploratory Data Analysis, chapter 2), and at least to the box;
/// what is farther out is an outlier. All NaN without values.
struct BoxPlot {
  std::size_t count = 0, left_out = 0;
  double least = kNaN, largest = kNaN;
  double q1 = kNaN, median = kNaN, q3 = kNaN;
  double lower_whisker = kNaN, upper_whisker = kNaN;
  std::vector<std::size_t> outliers;              ///< indices into the values, rising
  double mean = kNaN, standard_deviation = kNaN;  ///< as in Moments
};
BoxPlot box_plot(const std::vector<double>& values);

/// Several subjects over the same instants: at each instant numbers of the values that are there.
struct CycleBand {
  std::vector<std::size_t> count;  ///< per instant, of subjects with a value there
  std::vector<double> mean, standard_deviation;
  std::vector<double> median, low, high;  ///< percentiles, type 7
};
/// `low`, `high`: fractions of the band's ends, 0 <= low <= high <= 1: 0.05 and 0.95 for nine tenths of the subjects.
/// Throws UsageError: lines of different lengths.
CycleBand cycle_band(const std::vector<std::vector<double>>& lines, double low, double high);

/// Times as percent of the cycle that they span: 0 the first, 100 the last. Throws UsageError unless they rise.
std::vector<double> percent_of_cycle(const std::vector<double>& times);
/// Values at other instants, linear in time between two of their own; NaN before the first, after the last, and between
/// two of which one is NaN. `times`: one per value, rising, else UsageError.
std::vector<double> at_instants(const std::vector<double>& times, const std::vector<double>& values,
                                const std::vector<double>& instants);

/// Is each time later than the one before?
bool rises(const std::vector<double>& times);
/// Throws UsageError unless times are finite and each is later than the one before.
void require_rising(const std::vector<double>& times);
/// Throws UsageError unless `found` values stand where `expected` should: "pressures: 3 values, expected 4".
void require_count(const char* what, std::size_t found, std::size_t expected);

}  // namespace dea

// src/study/influence.h – which factors a result depends on: regression, rank correlation, slopes, shares of its
// variance.
//
// `factors`: one list per factor, of one value per case. `outputs`: one number per case, NaN or infinite where the case
// failed. Lists of other lengths are refused: UsageError.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "src/study/summary.h"

namespace dea {

/// y = sum of b_k x_k, all standardised to mean 0 and standard deviation 1, by least squares (Saltelli et al. 2008,
/// Global Sensitivity Analysis, chapter 1: b_k^2 is factor k's share of the variance where R^2 is 1 and factors are
/// independent). No unit; the same for factors and outputs in other units.
struct Regression {
  std::size_t cases = 0, left_out = 0;  ///< left out: the output or a factor is not finite
  std::vector<double> coefficients;     ///< per factor; NaN: undetermined
  double r_squared = kNaN;              ///< share of the output's variance that the fit has
};
/// By Householder's QR with pivoting. All coefficients and R^2 are NaN where the output does not vary, or where fewer
/// than two cases more than factors are left, which any factors would fit.
Regression regression(const std::vector<std::vector<double>>& factors, const std::vector<double>& outputs);

/// Ranks from 1; equal values share the mean of their ranks. Of finite values.
std::vector<double> ranks(const std::vector<double>& values);

/// Spearman's: Pearson's correlation of the ranks (Kendall and Gibbons 1990, Rank Correlation Methods, chapter 3, with
/// ties). NaN where one of the two does not vary.
double rank_correlation(const std::vector<double>& factor, const std::vector<double>& outputs);

/// d output / d factor at a value of the factor.
struct Slope {
  enum class Kind {
    None,      ///< the case failed, or neither neighbour is there
    Forward,   ///< to the next value
    Backward,  ///< from the one before
    Central    ///< of the parabola through both: second order also where they are unequally far
  };
  Kind kind = Kind::None;
  double value = kNaN;  ///< unit of the output over that of the factor
};
/// Per factor, with all others as in the base case, whose index is `base`; none: no other case has them so. A neighbour
/// is the next larger or smaller value; it is there if its output is finite. Throws UsageError: values that are not
/// finite, or two cases with the same values in all factors.
std::vector<std::optional<Slope>> slopes_about(const std::vector<std::vector<double>>& factors,
                                               const std::vector<double>& outputs, std::size_t base);

/// Of one factor. First: the share of the variance that goes when this factor alone is fixed. Total: the share that
/// stays when all others are. NaN: the output does not vary, or no row is left.
struct SobolIndex {
  double first = kNaN, total = kNaN;
  Interval first_interval, total_interval;  ///< by bootstrap; NaN: not asked for
  std::size_t rows = 0, left_out = 0;       ///< of the design's rows: left out is one with f(A), f(B) or f(AB_i) failed
};
/// Rows drawn with replacement, again and again; the interval holds 95 % of what comes out (Archer,
/// Saltelli and Sobol 1997, 10.1080/00949659708811825). It takes rows for random: those of a Sobol sequence are more
/// even, so for them it is too wide. The draws are mt19937_64's, the arithmetic of a factor is plain and serial: the
/// same seed gives the same bits on every machine, whatever the number of threads.
struct Bootstrap {
  int resamples = 1000;  ///< 0: no intervals
  std::uint64_t seed = 1;
};

/// `outputs`: of N (d + 2) cases in the order of Design::Saltelli (plan.h): N of A, N of B, N of each AB_i, which
/// is A with column i of B. NaN or infinite: failed. Over the N_i rows that are complete for factor i, with y less
/// their mean over A and B, and V the mean square of these 2 N_i:
///     S_i  = 1 / (V N_i)    sum of f(B) (f(AB_i) - f(A))   (Saltelli et al. 2010, 10.1016/j.cpc.2009.09.018, table 2
///     b) ST_i = 1 / (2 V N_i)  sum of (f(A) - f(AB_i))^2      (Jansen 1999, 10.1016/S0010-4655(98)00154-4; table 2 f)
/// Both are estimates: S_i of a factor without influence may come out below 0. Rows that failed are not missing at
/// random as a rule: then the indices are those of the cases that could be solved. Throws UsageError: a number of
/// outputs that is no multiple of d + 2, resamples < 0, no factor.
/// Per factor.
std::vector<SobolIndex> sobol_indices(const std::vector<double>& outputs, int dimensions,
                                      const Bootstrap& bootstrap = {});

}  // namespace dea

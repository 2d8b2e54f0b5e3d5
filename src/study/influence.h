// src/study/influence.h – which factors a result depends on: regression, rank correlation, slopes.
// (sobol_indices.h has the shares of its variance.)
//
// `factors`: one list per factor, of one value per case. `outputs`: one number per case, NaN or infinite where the case
// failed. Lists of other lengths are refused: UsageError.
#pragma once
#include <cstddef>
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

}  // namespace dea

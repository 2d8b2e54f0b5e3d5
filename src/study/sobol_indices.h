// src/study/sobol_indices.h – shares of a result's variance that its factors have, from Saltelli's design.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "src/study/summary.h"

namespace dea {

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

/// `outputs`: of N (d + 2) cases in the order of Design::Saltelli (sampling.h): N of A, N of B, N of each AB_i, which
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

#include "src/study/influence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "src/base/decompositions.h"
#include "src/base/error.h"
#include "src/results/comparison.h"
#include "src/study/pairs.h"

namespace dea {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kConstant = 1e-12;  // of the largest value: a spread below is rounding
constexpr double kDependent = 1e-9;  // of the longest column; sampled values have 12 digits

void require_lists(const std::vector<std::vector<double>>& factors, std::size_t cases) {
  for (const std::vector<double>& factor : factors) require_count("a factor", factor.size(), cases);
}

void require_finite(const std::vector<double>& factor) {
  for (std::size_t i = 0; i < factor.size(); ++i)
    if (!std::isfinite(factor[i]))
      throw UsageError(fmt::format("value {} of a factor is {}, expected a finite number", i + 1, factor[i]));
}

std::vector<std::size_t> complete_cases(const std::vector<std::vector<double>>& factors,
                                        const std::vector<double>& outputs) {
  std::vector<std::size_t> cases;
  for (std::size_t i = 0; i < outputs.size(); ++i)
    if (std::isfinite(outputs[i]) &&
        std::all_of(factors.begin(), factors.end(), [&](const auto& x) { return std::isfinite(x[i]); }))
      cases.push_back(i);
  return cases;
}

/// Mean 0, standard deviation 1; all 0 where the values do not vary.
VectorXd standardised(const std::vector<double>& values, const std::vector<std::size_t>& cases) {
  VectorXd v(static_cast<Eigen::Index>(cases.size()));
  for (Eigen::Index i = 0; i < v.size(); ++i) v[i] = values[cases[at(i)]];
  const double largest = v.cwiseAbs().maxCoeff();
  v.array() -= v.mean();
  const double deviation = v.norm() / std::sqrt(static_cast<double>(v.size() - 1));
  if (!(deviation > kConstant * largest)) return VectorXd::Zero(v.size());
  return v / deviation;
}

/// Least squares X b = y, with NaN for the coefficients that some combination of columns that vanishes can change.
/// X = Q R and R P = Q2 R2: pivoting needs the small R alone.
void solve(const MatrixXd& X, const VectorXd& y, Regression& fit) {
  const MatrixXd Q = orthonormal_columns(X);
  const PivotedQr qr = pivoted_qr(Q.transpose() * X, kDependent);
  const Eigen::Index d = X.cols(), rank = qr.rank;
  const VectorXd c = (qr.Q.transpose() * (Q.transpose() * y)).head(rank);
  fit.r_squared = std::min(c.squaredNorm() / y.squaredNorm(), 1.0);
  if (rank == 0) return;
  const MatrixXd R = qr.R.topLeftCorner(rank, rank);
  const VectorXd b = solve_upper(R, c);
  for (Eigen::Index i = 0; i < rank; ++i) fit.coefficients[at(qr.order[i])] = b[i];
  for (Eigen::Index k = rank; k < d; ++k) {
    const VectorXd made_up = solve_upper(R, qr.R.col(k).head(rank));  // column k of these others
    for (Eigen::Index i = 0; i < rank; ++i)
      if (std::abs(made_up[i]) > std::sqrt(kDependent)) fit.coefficients[at(qr.order[i])] = kNaN;
  }
}

/// Derivative at x[1] of the parabola through three points.
double central_slope(const double (&x)[3], const double (&y)[3]) {
  const double before = x[1] - x[0], after = x[2] - x[1];
  return (after * ((y[1] - y[0]) / before) + before * ((y[2] - y[1]) / after)) / (before + after);
}

/// The slope at place `i` of rising values.
Slope slope_at(std::size_t i, const std::vector<double>& x, const std::vector<double>& y) {
  const bool before = i > 0 && std::isfinite(y[i - 1]), after = i + 1 < x.size() && std::isfinite(y[i + 1]);
  if (!std::isfinite(y[i]) || (!before && !after)) return {};
  if (before && after)
    return {Slope::Kind::Central, central_slope({x[i - 1], x[i], x[i + 1]}, {y[i - 1], y[i], y[i + 1]})};
  if (after) return {Slope::Kind::Forward, (y[i + 1] - y[i]) / (x[i + 1] - x[i])};
  return {Slope::Kind::Backward, (y[i] - y[i - 1]) / (x[i] - x[i - 1])};
}

/// The only factor in which a case differs from the base; -1: in none, -2: in several.
int varied_factor(const std::vector<std::vector<double>>& factors, std::size_t a, std::size_t base) {
  int varied = -1;
  for (std::size_t k = 0; k < factors.size(); ++k) {
    if (factors[k][a] == factors[k][base]) continue;
    if (varied >= 0) return -2;
    varied = static_cast<int>(k);
  }
  return varied;
}

}  // namespace

Regression regression(const std::vector<std::vector<double>>& factors, const std::vector<double>& outputs) {
  require_lists(factors, outputs.size());
  const std::vector<std::size_t> cases = complete_cases(factors, outputs);
  Regression fit;
  fit.cases = cases.size();
  fit.left_out = outputs.size() - cases.size();
  fit.coefficients.assign(factors.size(), kNaN);
  if (factors.empty() || cases.size() < factors.size() + 2) return fit;
  const VectorXd y = standardised(outputs, cases);
  if (y.isZero(0)) return fit;
  MatrixXd X(static_cast<Eigen::Index>(cases.size()), static_cast<Eigen::Index>(factors.size()));
  for (Eigen::Index k = 0; k < X.cols(); ++k) X.col(k) = standardised(factors[at(k)], cases);
  solve(X, y, fit);
  return fit;
}

std::vector<double> ranks(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<double> rank(values.size());
  for (std::size_t from = 0, to = 1; from < order.size(); from = to++) {
    while (to < order.size() && values[order[to]] == values[order[from]]) ++to;
    for (std::size_t i = from; i < to; ++i) rank[order[i]] = 0.5 * static_cast<double>(from + 1 + to);
  }
  return rank;
}

double rank_correlation(const std::vector<double>& factor, const std::vector<double>& outputs) {
  const CompletePairs pairs = complete_pairs(factor, outputs);
  return correlation(ranks(pairs.first), ranks(pairs.second), std::vector<double>(pairs.first.size(), 1.0));
}

std::vector<std::optional<Slope>> slopes_about(const std::vector<std::vector<double>>& factors,
                                               const std::vector<double>& outputs, std::size_t base) {
  require_lists(factors, outputs.size());
  for (const std::vector<double>& factor : factors) require_finite(factor);
  if (base >= outputs.size())
    throw UsageError(fmt::format("base case {} of {} cases, expected one of them", base + 1, outputs.size()));
  std::vector<std::vector<std::size_t>> cases(factors.size());  // that differ from the base in this factor alone
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const int varied = varied_factor(factors, i, base);
    for (std::size_t k = 0; k < factors.size(); ++k)
      if (varied == static_cast<int>(k) || varied == -1) cases[k].push_back(i);
  }
  std::vector<std::optional<Slope>> result(factors.size());
  for (std::size_t k = 0; k < factors.size(); ++k) {
    std::stable_sort(cases[k].begin(), cases[k].end(),
                     [&](std::size_t a, std::size_t b) { return factors[k][a] < factors[k][b]; });
    std::vector<double> x, y;
    std::size_t place = 0;
    for (std::size_t i : cases[k]) {
      if (!x.empty() && x.back() == factors[k][i])
        throw UsageError(fmt::format("two cases have the value {} of a factor, expected one of each value", x.back()));
      if (i == base) place = x.size();
      x.push_back(factors[k][i]);
      y.push_back(outputs[i]);
    }
    if (x.size() > 1) result[k] = slope_at(place, x, y);
  }
  return result;
}

}  // namespace dea

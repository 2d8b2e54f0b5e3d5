// Compiled without contraction into fused operations, which would change the last bits from machine to machine.
#include "src/study/influence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "src/base/error.h"
#include "src/base/parallel.h"
#include "src/results/percentile.h"

namespace dea {

namespace {

/// Outputs of a row of the design, for one factor.
struct Row {
  double a = 0.0, b = 0.0, ab = 0.0;
};

struct Estimate {
  double first = kNaN, total = kNaN;
};

/// Sums over rows.
struct Sums {
  double count = 0.0, values = 0.0, squares = 0.0, products = 0.0, steps = 0.0, squared_steps = 0.0;
};

void add(Sums& s, const Row& row) {
  const double step = row.ab - row.a;
  s.count += 1;
  s.values += row.a + row.b;
  s.squares += row.a * row.a + row.b * row.b;
  s.products += row.b * step;
  s.steps += step;
  s.squared_steps += step * step;
}

/// The mean that a resample's y is less by comes in afterwards: sum (b - m) step = sum b step - m sum step.
Estimate estimate(const Sums& s) {
  const double mean = s.values / (2 * s.count), variance = s.squares / (2 * s.count) - mean * mean;
  if (!(variance > 0)) return {};
  return {(s.products - mean * s.steps) / (variance * s.count), s.squared_steps / (2 * variance * s.count)};
}

/// The complete rows of factor i, less the mean of their A and B; empty also where these do not vary.
std::vector<Row> complete_rows(const std::vector<double>& y, std::size_t count, std::size_t i) {
  std::vector<Row> rows;
  for (std::size_t j = 0; j < count; ++j) {
    const Row row = {y[j], y[count + j], y[(i + 2) * count + j]};
    if (std::isfinite(row.a) && std::isfinite(row.b) && std::isfinite(row.ab)) rows.push_back(row);
  }
  double sum = 0.0;
  for (const Row& row : rows) sum += row.a + row.b;
  const double mean = sum / (2 * static_cast<double>(rows.size()));
  for (Row& row : rows) row = {row.a - mean, row.b - mean, row.ab - mean};
  return rows;
}

/// What is left of a constant less its mean is rounding, and has no variance.
bool varies(const std::vector<Row>& rows, double largest) {
  constexpr double kConstant = 1e-12;
  return std::any_of(rows.begin(), rows.end(),
                     [&](const Row& row) { return std::max(std::abs(row.a), std::abs(row.b)) > kConstant * largest; });
}

Interval between_percentiles(std::vector<double> values) {
  constexpr double kLevel = 0.95;  // share of the resamples within the interval
  values = finite_values(values).values;
  std::sort(values.begin(), values.end());
  return {percentile_of_sorted(values, 0.5 * (1 - kLevel)), percentile_of_sorted(values, 0.5 * (1 + kLevel))};
}

void set_intervals(SobolIndex& index, const std::vector<Row>& rows, const Bootstrap& bootstrap) {
  std::mt19937_64 random(bootstrap.seed);  // anew for each factor: the same draws, however many factors there are
  std::vector<double> first, total;
  for (int r = 0; r < bootstrap.resamples; ++r) {
    Sums sums;
    for (std::size_t j = 0; j < rows.size(); ++j) add(sums, rows[random() % rows.size()]);
    const Estimate e = estimate(sums);
    first.push_back(e.first);
    total.push_back(e.total);
  }
  index.first_interval = between_percentiles(std::move(first));
  index.total_interval = between_percentiles(std::move(total));
}

SobolIndex index_of(const std::vector<Row>& rows, double largest, const Bootstrap& bootstrap) {
  SobolIndex index;
  index.rows = rows.size();
  if (!varies(rows, largest)) return index;
  Sums sums;
  for (const Row& row : rows) add(sums, row);
  const Estimate e = estimate(sums);
  index.first = e.first;
  index.total = e.total;
  if (bootstrap.resamples > 0) set_intervals(index, rows, bootstrap);
  return index;
}

void require_design(std::size_t outputs, int dimensions, const Bootstrap& bootstrap) {
  if (dimensions < 1) throw UsageError(fmt::format("{} factors, expected one or more", dimensions));
  if (outputs == 0 || outputs % (at(dimensions) + 2) != 0)
    throw UsageError(
        fmt::format("{} outputs of {} factors, expected a multiple of {}: rows A, B and one for each factor", outputs,
                    dimensions, at(dimensions) + 2));
  if (bootstrap.resamples < 0) throw UsageError(fmt::format("{} resamples, expected 0 or more", bootstrap.resamples));
}

}  // namespace

std::vector<SobolIndex> sobol_indices(const std::vector<double>& outputs, int dimensions, const Bootstrap& bootstrap) {
  require_design(outputs.size(), dimensions, bootstrap);
  double largest = 0.0;
  for (double y : finite_values(outputs).values) largest = std::max(largest, std::abs(y));
  const std::size_t count = outputs.size() / (at(dimensions) + 2);
  std::vector<SobolIndex> indices(at(dimensions));
  // each factor by itself, so that threads change no bit
  parallel_for(at(dimensions), [&](std::size_t i) {
    indices[i] = index_of(complete_rows(outputs, count, i), largest, bootstrap);
    indices[i].left_out = count - indices[i].rows;
  });
  return indices;
}

}  // namespace dea

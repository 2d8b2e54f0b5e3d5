#include "src/study/mean_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "src/base/error.h"
#include "src/study/summary.h"

namespace dea {

namespace {

void require_fields(const std::vector<std::vector<double>>& fields, std::size_t places) {
  if (fields.empty()) throw UsageError("a mean of no field, expected one or more");
  for (std::size_t c = 0; c < fields.size(); ++c) {
    require_count("a field", fields[c].size(), places);
    for (std::size_t i = 0; i < places; ++i)
      if (!std::isfinite(fields[c][i]))
        throw UsageError(fmt::format("field {} has {} at place {}, expected finite numbers: leave the field out", c + 1,
                                     fields[c][i], i + 1));
  }
}

void require_areas(const std::vector<double>& areas) {
  double total = 0.0;
  for (double area : areas) {
    if (!(area >= 0)) throw UsageError(fmt::format("an area of {}, expected 0 or more", area));
    total += area;
  }
  if (!(total > 0) || !std::isfinite(total))
    throw UsageError(fmt::format("a surface of area {}, expected more than 0", total));
}

/// Of the finite ones; NaN: there is none.
double weighted_mean(const std::vector<double>& values, const std::vector<double>& areas) {
  double sum = 0.0, total = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    sum += areas[i] * values[i];
    total += areas[i];
  }
  return sum / total;
}

double weighted_rms(std::vector<double> values, const std::vector<double>& areas) {
  for (double& x : values) x *= x;
  return std::sqrt(weighted_mean(values, areas));
}

}  // namespace

MeanMap mean_map(const std::vector<std::vector<double>>& fields, const std::vector<double>& areas) {
  require_areas(areas);
  require_fields(fields, areas.size());
  MeanMap map;
  map.cases = fields.size();
  std::vector<double> across(fields.size());
  for (std::size_t i = 0; i < areas.size(); ++i) {
    for (std::size_t c = 0; c < fields.size(); ++c) across[c] = fields[c][i];
    const Moments m = moments(across);
    map.mean.push_back(m.mean);
    map.standard_deviation.push_back(m.standard_deviation);
  }
  map.area_mean = weighted_mean(map.mean, areas);
  map.area_spread = weighted_rms(map.standard_deviation, areas);
  return map;
}

CoveredMeanMap covered_mean_map(const std::vector<std::vector<double>>& fields, const std::vector<double>& areas,
                                std::size_t least) {
  require_areas(areas);
  if (fields.empty()) throw UsageError("a mean of no field, expected one or more");
  for (const std::vector<double>& field : fields) {
    require_count("a field", field.size(), areas.size());
    if (std::any_of(field.begin(), field.end(), [](double x) { return std::isinf(x); }))
      throw UsageError("a field has an infinite value, expected numbers, or NaN where it does not cover a place");
  }
  CoveredMeanMap out;
  out.map.cases = fields.size();
  std::vector<double> across(fields.size());
  for (std::size_t i = 0; i < areas.size(); ++i) {
    for (std::size_t c = 0; c < fields.size(); ++c) across[c] = fields[c][i];
    const Moments m = moments(finite_values(across).values);
    const bool enough = m.count >= least;
    out.count.push_back(m.count);
    out.map.mean.push_back(enough ? m.mean : kNaN);
    out.map.standard_deviation.push_back(enough ? m.standard_deviation : kNaN);
    out.covered_area += enough ? areas[i] : 0.0;
  }
  out.map.area_mean = weighted_mean(out.map.mean, areas);
  out.map.area_spread = weighted_rms(out.map.standard_deviation, areas);
  return out;
}

MapDifference map_difference(MeanMap first, MeanMap second, const std::vector<double>& areas) {
  MapDifference d{std::move(first), std::move(second), {}, kNaN, kNaN};
  for (std::size_t i = 0; i < areas.size(); ++i) d.difference.push_back(d.first.mean[i] - d.second.mean[i]);
  d.area_mean = weighted_mean(d.difference, areas);
  d.area_rms = weighted_rms(d.difference, areas);
  return d;
}

MapDifference map_difference(const std::vector<std::vector<double>>& first,
                             const std::vector<std::vector<double>>& second, const std::vector<double>& areas) {
  return map_difference(mean_map(first, areas), mean_map(second, areas), areas);
}

}  // namespace dea

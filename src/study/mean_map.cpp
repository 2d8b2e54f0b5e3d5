#include "src/study/mean_map.h"

#include <fmt/format.h>

#include <cmath>

#include "src/base/error.h"
#include "src/study/summary.h"

namespace dea {

namespace {

void require_fields(const std::vector<std::vector<double>>& fields, std::size_t places, bool whole) {
  if (fields.empty()) throw UsageError("a mean of no field, expected one or more");
  for (std::size_t c = 0; c < fields.size(); ++c) {
    require_count("a field", fields[c].size(), places);
    for (std::size_t i = 0; i < places; ++i) {
      if (whole && !std::isfinite(fields[c][i]))
        throw UsageError(fmt::format("field {} has {} at place {}, expected finite numbers: leave the field out", c + 1,
                                     fields[c][i], i + 1));
      if (std::isinf(fields[c][i]))
        throw UsageError("a field has an infinite value, expected numbers, or NaN where it does not cover a place");
    }
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

MeanMap mean_map(const std::vector<std::vector<double>>& fields, const std::vector<double>& areas, std::size_t least) {
  require_areas(areas);
  require_fields(fields, areas.size(), least == 0);
  MeanMap map;
  map.cases = fields.size();
  std::vector<double> across(fields.size());
  for (std::size_t i = 0; i < areas.size(); ++i) {
    for (std::size_t c = 0; c < fields.size(); ++c) across[c] = fields[c][i];
    const Moments m = least == 0 ? moments(across) : moments(finite_values(across).values);
    map.count.push_back(m.count);
    map.mean.push_back(m.count < least ? kNaN : m.mean);
    map.standard_deviation.push_back(m.count < least ? kNaN : m.standard_deviation);
  }
  map.area_mean = weighted_mean(map.mean, areas);
  map.area_spread = weighted_rms(map.standard_deviation, areas);
  return map;
}

MapDifference map_difference(const MeanMap& first, const MeanMap& second, const std::vector<double>& areas) {
  MapDifference d;
  for (std::size_t i = 0; i < areas.size(); ++i) d.difference.push_back(first.mean[i] - second.mean[i]);
  d.area_mean = weighted_mean(d.difference, areas);
  d.area_rms = weighted_rms(d.difference, areas);
  return d;
}

}  // namespace dea

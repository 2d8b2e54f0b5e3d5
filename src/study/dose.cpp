#include "src/study/dose.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "src/base/error.h"
#include "src/results/comparison.h"
#include "src/study/summary.h"

namespace dea {

namespace {

void require_cycle(const std::vector<double>& times, const std::vector<std::vector<double>>& pressures,
                   double threshold) {
  require_rising(times);
  require_count("pressures", pressures.size(), times.size());
  if (times.size() < 2) throw UsageError(fmt::format("a cycle of {} states, expected two or more", times.size()));
  for (const std::vector<double>& p : pressures)
    require_count("a state's pressures", p.size(), pressures.front().size());
  if (!(threshold >= 0) || !std::isfinite(threshold))
    throw UsageError(fmt::format("a threshold of {}, expected a pressure of 0 or more", threshold));
}

void require_positive(const char* what, double value) {
  if (!(value >= 0) || !std::isfinite(value)) throw UsageError(fmt::format("{}: {}, expected 0 or more", what, value));
}

}  // namespace

Dose cycle_dose(const std::vector<double>& times, const std::vector<std::vector<double>>& pressures, double threshold) {
  require_cycle(times, pressures, threshold);
  TimeSums sums = over_time(times, pressures, threshold);
  for (std::size_t i = 0; i < sums.exposure.size(); ++i)
    if (!std::isfinite(sums.exposure[i])) sums.exposure[i] = sums.dose[i] = kNaN;
  return {std::move(sums.exposure), std::move(sums.dose)};
}

Dose chronic_dose(const std::vector<double>& times, const std::vector<std::vector<double>>& pressures, double threshold,
                  const LoadingHistory& history) {
  require_positive("seconds per cycle", history.cycle_seconds);
  require_positive("cycles per year", history.cycles_per_year);
  require_positive("years", history.years);
  Dose dose = cycle_dose(times, pressures, threshold);
  const double seconds_per_time = history.cycle_seconds / (times.back() - times.front());
  const double factor = seconds_per_time * history.cycles_per_year * history.years / kSecondsPerYear;
  for (std::size_t i = 0; i < dose.exposure.size(); ++i) {
    dose.exposure[i] *= factor;
    dose.overpressure[i] *= factor;
  }
  return dose;
}

double share_above(const std::vector<double>& values, const std::vector<double>& areas, double threshold) {
  require_count("areas", areas.size(), values.size());
  if (std::isnan(threshold)) throw UsageError("the threshold is no number");
  double above = 0.0, total = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    require_positive("an area", areas[i]);
    if (std::isnan(values[i])) continue;
    total += areas[i];
    if (values[i] > threshold) above += areas[i];
  }
  return total > 0 ? above / total : kNaN;
}

}  // namespace dea

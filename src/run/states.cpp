#include <febiodea/run/states.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <febiodea/base/error.h>

namespace dea {

namespace {

/// Plot files hold times in single precision.
bool same_in_single_precision(double a, double b, double end) { return std::abs(a - b) <= 1e-6 * end; }

/// Puts a time among the others, in order.
void insert_time(const JointModel& model, std::vector<TimePoint>& times, double t, double end) {
  for (const TimePoint& p : times)
    if (same_in_single_precision(p.time, t, end)) return;
  const auto later = std::find_if(times.begin(), times.end(), [&](const TimePoint& p) { return p.time > t; });
  times.insert(later, place_times(model, {t}).front());
}

}  // namespace

States all_states(std::vector<TimePoint> times) {
  States states{std::move(times), {}};
  states.wanted.assign(states.times.size(), 1);
  return states;
}

ResultTimes times_of_result(const JointModel& model, const std::vector<double>& found, const std::string& path) {
  const std::vector<double> starts = step_starts(model);
  const double end = starts.back();
  const std::vector<TimePoint> own = model_times(model, true);
  ResultTimes result;
  for (const TimePoint& p : own)
    if (p.time <= 0) result.times.push_back(p);
  for (double step_end : starts)
    if (step_end > 0) insert_time(model, result.times, step_end, end);
  for (double t : found) {
    if (!(t >= -1e-6 * end && t <= end * (1 + 1e-6)))
      throw InputError(fmt::format("{}: found a state at time {:g}, expected times from 0 to {:g}, those of the model",
                                   path, t, end));
    for (const TimePoint& p : own)
      if (same_in_single_precision(p.time, t, end)) t = p.time;  // 0.05, not the single-precision 0.0500000007
    insert_time(model, result.times, t, end);
    result.of_result.push_back(t);
  }
  return result;
}

States choose_states(const JointModel& model, std::vector<TimePoint> times, const std::vector<double>& chosen,
                     const std::string& option) {
  const double end = step_starts(model).back();
  for (double t : chosen) {
    if (!(t >= 0 && t <= end * (1 + 1e-6)))
      throw UsageError(
          fmt::format("{}: found time {:g}, expected times from 0 to {:g}, those of the model", option, t, end));
    insert_time(model, times, std::min(t, end), end);
  }
  States states{std::move(times), {}};
  for (const TimePoint& p : states.times)
    states.wanted.push_back(
        std::any_of(chosen.begin(), chosen.end(), [&](double t) { return same_in_single_precision(t, p.time, end); }));
  while (!states.wanted.empty() && !states.wanted.back()) {  // nothing follows from what comes after
    states.wanted.pop_back();
    states.times.pop_back();
  }
  return states;
}

}  // namespace dea

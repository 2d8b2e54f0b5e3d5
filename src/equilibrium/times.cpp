#include "src/equilibrium/times.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "src/base/numbers.h"
#include "src/base/say.h"

namespace dea {

std::vector<double> step_starts(const JointModel& model) {
  std::vector<double> starts = {0.0};
  for (const Step& s : model.steps) starts.push_back(starts.back() + s.duration);
  return starts;
}

namespace {

/// Two times that differ by rounding of n * step_size only.
bool same_to_rounding(double a, double b, double scale) { return std::abs(a - b) <= 1e-9 * std::max(scale, 1e-300); }

// Far beyond what anyone looks at; each costs a solution and room in the plot file.
constexpr double kMostStates = 10000, kThinned = 1000;

const NamedSetting kSomeStates = {"states", "", "t1,t2,..."};

/// Ends of steps and must points: kept when time steps are thinned out, unless they are very many themselves.
double count_kept(const JointModel& model) {
  double count = 0.0;
  for (const Step& step : model.steps) count += 1.0 + static_cast<double>(step.must_points.size());
  return count;
}

/// Every so many of the times, and the last.
std::vector<TimePoint> every(const std::vector<TimePoint>& times, std::size_t stride) {
  std::vector<TimePoint> some;
  for (std::size_t i = 0; i + 1 < times.size(); i += stride) some.push_back(times[i]);
  some.push_back(times.back());
  return some;
}

}  // namespace

double count_time_steps(const JointModel& model) {
  double count = 0.0;
  for (const Step& step : model.steps) count += step.step_size > 0 ? step.duration / step.step_size : 1.0;
  return count;
}

bool very_many_time_steps(const JointModel& model) { return !(count_time_steps(model) <= kMostStates * (1 + 1e-9)); }

std::vector<TimePoint> model_times(const JointModel& model, bool thin) {
  std::vector<TimePoint> times = {{0.0, 0}};
  const std::vector<double> starts = step_starts(model);
  const double states = count_time_steps(model);
  const bool very_many = very_many_time_steps(model);
  if (very_many && !thin)
    throw fault_at(model, model.steps.front().origin,
                   say("{:.0f} time steps, need at most {:.0f}:", states, kMostStates),
                   say("raise step_size (equilibrium at a time needs no small steps before it), or choose the states: "
                       "{}, {}",
                       NamedSetting{"states", "", "last"}, kSomeStates));
  const double stride = very_many ? std::ceil(states / kThinned) : 1.0;
  if (!(starts.back() > 0)) {
    throw fault_at(model, model.steps.empty() ? Origin{} : model.steps.back().origin,
                   "the model ends at time 0, so there is nothing to solve: need time_steps > 0 and step_size > 0");
  }
  for (int s = 0; s < static_cast<int>(model.steps.size()); ++s) {
    const Step& step = model.steps[at(s)];
    const double start = starts[at(s)], end = starts[at(s) + 1];
    const double scale = std::max(std::abs(end), step.duration);
    std::vector<double> in_step = step.must_points;
    if (step.step_size > 0) {
      const double whole = std::floor(step.duration / step.step_size * (1 + 1e-9));
      for (int i = 1; i * stride <= whole && std::isfinite(i * stride); ++i)
        in_step.push_back(start + i * stride * step.step_size);
    }
    in_step.push_back(end);
    std::sort(in_step.begin(), in_step.end());
    for (double t : in_step) {
      if (t <= start || same_to_rounding(t, start, scale) || t > end * (1 + 1e-12) + 1e-300) continue;
      if (same_to_rounding(t, end, scale)) t = end;
      if (!same_to_rounding(t, times.back().time, scale)) times.push_back({t, s});
    }
  }
  if (very_many && count_kept(model) > kThinned)
    return every(times, static_cast<std::size_t>(std::ceil(static_cast<double>(times.size()) / kThinned)));
  return times;
}

std::vector<TimePoint> place_times(const JointModel& model, const std::vector<double>& times) {
  const std::vector<double> starts = step_starts(model);
  std::vector<TimePoint> placed;
  for (double t : times) {
    int s = 0;
    // plot files hold times in single precision
    while (s + 1 < static_cast<int>(model.steps.size()) && t > starts[at(s) + 1] * (1 + 1e-6)) ++s;
    placed.push_back({t, s});
  }
  return placed;
}

Finding states_thinned(const JointModel& model, std::size_t solved) {
  return {"states-thinned",
          {},
          {{"steps", count_time_steps(model)}, {"solved", solved}, {"others", kSomeStates}},
          count_kept(model) > kThinned ? 0 : 1};
}

bool many_states_left_out(const JointModel& model, const std::vector<TimePoint>& times) {
  return count_time_steps(model) > 2.0 * static_cast<double>(times.size()) &&
         times.back().time >= 0.5 * step_starts(model).back();
}

Finding states_left_out(const JointModel& model, std::size_t solved) {
  return {"states-left-out", {}, {{"steps", count_time_steps(model)}, {"solved", solved}}};
}

}  // namespace dea

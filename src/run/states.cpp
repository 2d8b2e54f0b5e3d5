#include "src/run/states.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "src/base/error.h"
#include "src/base/parse.h"
#include "src/base/time_text.h"

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

/// Wanted states, and what is solved on the way to the last of them: the ends of steps. Nothing follows from the
/// reference configuration, which is not solved.
States only_needed(const JointModel& model, const States& all, double end) {
  const std::vector<double> starts = step_starts(model);
  std::size_t count = all.times.size();
  while (count > 0 && !all.wanted[count - 1]) --count;  // nothing follows from what comes after
  States needed;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = all.times[i].time;
    const bool step_end = std::any_of(starts.begin() + 1, starts.end(),
                                      [&](double ends) { return same_in_single_precision(ends, t, end); });
    if (!all.wanted[i] && !step_end) continue;
    needed.times.push_back(all.times[i]);
    needed.wanted.push_back(all.wanted[i]);
  }
  return needed;
}

}  // namespace

bool asks_for(const StatesAsked& asked, double t) {
  return std::any_of(asked.ranges.begin(), asked.ranges.end(), [t](const std::array<double, 2>& range) {
    const double rounding = 1e-9 * std::max(std::abs(range[0]), std::abs(range[1]));
    return t >= range[0] - rounding && t <= range[1] + rounding;
  });
}

StatesAsked parse_states(const std::string& text) {
  const char* expected = "all, last, times t1,t2,... or ranges t1:t2";
  StatesAsked asked;
  asked.all = text.empty() || text == "all";
  if (asked.all) return asked;
  for (const std::string& word : split_at_commas(text)) {
    const std::size_t colon = word.find(':');
    try {
      if (word == "last")
        asked.last = true;
      else if (colon == std::string::npos)
        asked.times.push_back(parse_number(word));
      else
        asked.ranges.push_back({parse_number(word.substr(0, colon)), parse_number(word.substr(colon + 1))});
    } catch (const BadValue&) {
      const bool alone = word == text;  // "all" stands alone
      throw bad_value(word, expected,
                      alone ? std::vector<std::string>{"all", "last"} : std::vector<std::string>{"last"});
    }
    if (!asked.ranges.empty() && asked.ranges.back()[0] > asked.ranges.back()[1])
      throw bad_value(text, "a range that rises, t1:t2");
  }
  return asked;
}

States row_states(const JointModel& model, const Settings& settings, const StatesAsked& asked,
                  const std::string& option) {
  States states;
  const int last = static_cast<int>(model.steps.size()) - 1;
  const double end = step_starts(model).back();
  const std::size_t rows = row_count(settings);
  if (rows == 0) {
    const bool by_time = std::any_of(asked.times.begin(), asked.times.end(),
                                     [&](double t) { return same_in_single_precision(t, end, end); });
    if (!asked.all && !asked.last && !by_time && !asks_for(asked, end))
      throw UsageError(
          fmt::format("{}: without the model's steps its end, time {}, is the only state: expected all, last "
                      "or that time",
                      option, time_text(end)));
    return all_states({{end, last}});
  }
  if (!settings.skip_steps) {
    const std::vector<double> starts = step_starts(model);
    states.times = place_times(model, {starts.begin() + 1, starts.end()});
    states.wanted.assign(states.times.size(), 0);
  }
  std::vector<char> wanted(rows, asked.all);
  if (asked.last) wanted.back() = 1;
  const double scale = std::max(std::abs(row_time(settings, 0)), std::abs(row_time(settings, rows - 1)));
  for (double t : asked.times) {
    bool found = false;
    for (std::size_t r = 0; r < rows; ++r)
      if (same_in_single_precision(row_time(settings, r), t, scale)) {
        wanted[r] = 1;
        found = true;
      }
    if (!found)
      throw UsageError(fmt::format("{}: found time {}, expected that of a row of the table, from {} to {}", option,
                                   time_text(t), time_text(row_time(settings, 0)),
                                   time_text(row_time(settings, rows - 1))));
  }
  for (std::size_t r = 0; r < rows; ++r) wanted[r] = wanted[r] || asks_for(asked, row_time(settings, r));
  if (std::count(wanted.begin(), wanted.end(), 1) == 0)
    throw UsageError(fmt::format("{}: found no row of the table in this range, expected times from {} to {}", option,
                                 time_text(row_time(settings, 0)), time_text(row_time(settings, rows - 1))));
  for (std::size_t r = 0; r < rows; ++r)
    if (wanted[r]) {
      states.times.push_back({row_time(settings, r), last, static_cast<int>(r)});
      states.wanted.push_back(1);
    }
  return states;
}

States all_states(std::vector<TimePoint> times) {
  const std::size_t count = times.size();
  return {std::move(times), std::vector<char>(count, 1)};
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
      throw InputError(fmt::format("{}: found a state at time {}, expected times from 0 to {}, those of the model",
                                   path, time_text(t), time_text(end)));
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
      throw UsageError(fmt::format("{}: found time {}, expected times from 0 to {}, those of the model", option,
                                   time_text(t), time_text(end)));
    insert_time(model, times, std::min(t, end), end);
  }
  States states{std::move(times), {}};
  for (const TimePoint& p : states.times)
    states.wanted.push_back(
        std::any_of(chosen.begin(), chosen.end(), [&](double t) { return same_in_single_precision(t, p.time, end); }));
  return only_needed(model, states, end);
}

}  // namespace dea

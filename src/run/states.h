// src/run/states.h – which states of a model are solved, and which of these are kept.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "src/equilibrium/times.h"

namespace dea {

/// Times to solve, in order, and which of them are wanted.
struct States {
  std::vector<TimePoint> times;
  std::vector<char> wanted;  ///< one per time
};

/// All of them wanted.
States all_states(std::vector<TimePoint> times);

/// Which states a user asks for.
struct StatesAsked {
  bool all = false, last = false;
  std::vector<double> times;
  std::vector<std::array<double, 2>> ranges;  ///< from, to; both belong to it
  bool operator==(const StatesAsked&) const = default;
};
/// Does a range hold this time?
bool asks_for(const StatesAsked& asked, double t);
/// "all", or some of "last", "0.5", "0.2:0.8", separated by commas; "": all. Throws BadValue.
StatesAsked parse_states(const std::string& text);

/// The states of settings.loads and settings.motion: a row each, after the ends of the model's steps, which are solved
/// on the way and not wanted (none with settings.skip_steps). Without tables, with skip_steps: the end of the last step
/// alone. Rows that are not asked for are not solved. UsageError, with `option`: a time that no row has.
States row_states(const JointModel& model, const Settings& settings, const StatesAsked& asked,
                  const std::string& option);

/// The times of an FEA result among the model's: `times` has them, between them only the ends of steps (where motions
/// relative to a step start). `of_result`: the same times as the model writes them, not in single precision.
/// InputError, with `path` for its place: a time beyond the model's.
struct ResultTimes {
  std::vector<TimePoint> times;
  std::vector<double> of_result;
};
ResultTimes times_of_result(const JointModel& model, const std::vector<double>& found, const std::string& path);

/// Only the chosen times are wanted, also those that the model lacks; of the others, time 0 and the ends of steps
/// before the last are solved on the way (motions and loads may count from there). UsageError, with `option` for what
/// the user calls them: a time beyond the model's.
States choose_states(const JointModel& model, std::vector<TimePoint> times, const std::vector<double>& chosen,
                     const std::string& option);

}  // namespace dea

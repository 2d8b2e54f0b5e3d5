// febiodea/run/states.h – which states of a model are solved, and which of these are kept.
#pragma once
#include <string>
#include <vector>

#include <febiodea/equilibrium/times.h>

namespace dea {

/// Times to solve, in order, and which of them are wanted.
struct States {
  std::vector<TimePoint> times;
  std::vector<char> wanted;  ///< one per time
};

/// All of them wanted.
States all_states(std::vector<TimePoint> times);

/// The times of an FEA result among the model's: `times` has them, between them only the ends of steps (where motions
/// relative to a step start). `of_result`: the same times as the model writes them, not in single precision.
/// InputError, with `path` for its place: a time beyond the model's.
struct ResultTimes {
  std::vector<TimePoint> times;
  std::vector<double> of_result;
};
ResultTimes times_of_result(const JointModel& model, const std::vector<double>& found, const std::string& path);

/// Only the chosen times are wanted, those that the model lacks among the others; nothing is solved after the last.
/// UsageError, with `option` for what the user calls them: a time beyond the model's.
States choose_states(const JointModel& model, std::vector<TimePoint> times, const std::vector<double>& chosen,
                     const std::string& option);

}  // namespace dea

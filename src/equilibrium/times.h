// src/equilibrium/times.h – the times of a model's states, and the step each belongs to.
#pragma once
#include <string>
#include <vector>

#include "src/base/finding.h"
#include "src/model/joint_model.h"

namespace dea {

/// The time of a state, and the step it belongs to.
struct TimePoint {
  double time = 0.0;
  int step = 0;
  int row = -1;  ///< of settings.loads and settings.motion; -1: a state of the model's own
};
/// Times of a model's states: 0, every step_size, ends of steps, must points. More than 10000 are refused (InputError),
/// or, if `thin`, reduced evenly to about 1000 besides ends of steps and must points; where these alone are more than
/// 1000, they are thinned out too.
std::vector<TimePoint> model_times(const JointModel& model, bool thin = false);

/// How many time steps the model has, and whether that is more than 10000.
double count_time_steps(const JointModel& model);
bool very_many_time_steps(const JointModel& model);

/// Start time of each step, and the end of the last.
std::vector<double> step_starts(const JointModel& model);

/// The given times (of an FEA result, say) with the step each belongs to; time 0 and ends of steps belong to the
/// earlier step.
std::vector<TimePoint> place_times(const JointModel& model, const std::vector<double>& times);

/// That `solved` of very many time steps are solved, and how to have others.
Finding states_thinned(const JointModel& model, std::size_t solved);

/// Times chosen by the user: more than half of the time steps on the way to the last are left out, which lies in the
/// second half of the model's time. That `solved` of them are solved.
bool many_states_left_out(const JointModel& model, const std::vector<TimePoint>& times);
Finding states_left_out(const JointModel& model, std::size_t solved);

}  // namespace dea

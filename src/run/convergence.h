// src/run/convergence.h – how many springs a result needs.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "src/run/analysis.h"

namespace dea {

/// The last state with each spring triangle divided into refine^2.
struct ConvergenceRow {
  int refine = 1;
  int springs = 0, springs_hit = 0, springs_active = 0;
  Headline headline;                                               ///< of the surface with springs
  Headline change_headline;                                        ///< of its four numbers, as change_peak: they decide
  double peak = 0.0, mean = 0.0, area = 0.0;                       ///< of the springs
  double change_peak = 0.0, change_mean = 0.0, change_area = 0.0;  ///< relative to the row before; NaN in the first
  Outcome outcome = Outcome::NotConverged;
  bool changes_below(double limit) const;  ///< those of the headline, all four
};
struct Convergence {
  std::string contact;
  std::vector<ConvergenceRow> rows;
  int springs_5_percent = -1;  ///< springs of the first row from which on every change is below 5%; -1: not reached
  int springs_1_percent = -1;
};
/// refine = 1, 2, 4, 8, ...: four times the springs each time. One entry per contact. Ends when every change is below
/// `target` (relative) or at max_springs springs. Stopped: `stop` was set.
std::vector<Convergence> converge(const JointModel& model, Settings settings, double target, int max_springs,
                                  const std::function<void(const ConvergenceRow&)>& progress = {},
                                  const std::function<void(const Activity&)>& activity = {},
                                  const StopFlag* stop = nullptr);

}  // namespace dea

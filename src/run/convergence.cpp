#include "src/run/convergence.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "src/base/numbers.h"
#include "src/run/states.h"

namespace dea {

namespace {

/// Springs of the first division from which on every change stays below a limit; -1: not reached.
int springs_reaching(const std::vector<ConvergenceRow>& rows, double limit) {
  // the row before the first small change already was fine enough, if all later changes stay small
  int springs = -1;
  for (std::size_t i = rows.size(); i-- > 1 && rows[i].changes_below(limit);) springs = rows[i - 1].springs;
  return springs;
}

/// The last state, and those on the way to it from which it may start or count: as where only it is asked for.
std::vector<TimePoint> last_state(const JointModel& model, const Settings& settings) {
  if (settings.skip_steps) return row_states(model, settings, parse_states("last"), "").times;
  std::vector<TimePoint> times = model_times(model, true);
  const double last = times.back().time;
  return choose_states(model, std::move(times), {last}, "").times;
}

/// `before`: the row of the coarser division; nullptr: none.
ConvergenceRow convergence_row(int refine, const ContactStatistics& s, Outcome outcome, const ConvergenceRow* before) {
  ConvergenceRow row;
  row.refine = refine;
  row.springs = s.springs;
  row.springs_hit = s.springs_hit;
  row.springs_active = s.springs_active;
  row.headline = s.headline;
  row.peak = s.peak;
  row.mean = s.mean;
  row.area = s.contact_area;
  row.outcome = outcome;
  row.change_peak = row.change_mean = row.change_area = row.change_headline.area = kNaN;
  if (before == nullptr) return row;
  const auto change = [](double value, double previous) {
    return previous != 0 ? std::abs(value - previous) / std::abs(previous) : kNaN;
  };
  row.change_peak = change(row.peak, before->peak);
  row.change_mean = change(row.mean, before->mean);
  row.change_area = change(row.area, before->area);
  for (const HeadlineNumber& number : kHeadlineNumbers)
    row.change_headline.*number.value = change(row.headline.*number.value, before->headline.*number.value);
  return row;
}

}  // namespace

bool ConvergenceRow::changes_below(double limit) const {
  return std::all_of(std::begin(kHeadlineNumbers), std::end(kHeadlineNumbers),
                     [&](const HeadlineNumber& number) { return change_headline.*number.value < limit; });
}

std::vector<Convergence> converge(const JointModel& model, Settings settings, double target, int max_springs,
                                  const std::function<void(const ConvergenceRow&)>& progress,
                                  const std::function<void(const Activity&)>& activity, const StopFlag* stop) {
  std::vector<Convergence> result;
  AnalysisOptions options;
  options.times = last_state(model, settings);
  options.keep_state.assign(options.times.size(), 0);  // only the last is looked at
  options.keep_state.back() = 1;
  options.activity = activity;
  options.equilibrium.stop = stop;
  for (int refine = 1;; refine *= 2) {
    settings.refine = refine;
    const Analysis analysis = analyse(model, settings, options);
    const StateResult& last = analysis.states.back();
    int springs = 0;
    bool done = refine > 1;
    for (std::size_t c = 0; c < last.statistics.size(); ++c) {
      if (result.size() <= c) {
        result.emplace_back();
        result.back().contact = analysis.joint.contacts[c].name;
      }
      std::vector<ConvergenceRow>& rows = result[c].rows;
      rows.push_back(
          convergence_row(refine, last.statistics[c], last.equilibrium.outcome, rows.empty() ? nullptr : &rows.back()));
      done = done && rows.back().changes_below(target);
      springs = std::max(springs, rows.back().springs);
      if (progress) progress(rows.back());
    }
    const double next = 4.0 * springs;
    if (done || next > max_springs) break;
  }
  for (Convergence& c : result) {
    c.springs_5_percent = springs_reaching(c.rows, 0.05);
    c.springs_1_percent = springs_reaching(c.rows, 0.01);
  }
  return result;
}

}  // namespace dea

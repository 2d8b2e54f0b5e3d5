// From a model to results in files.
#include <febiodea/views/run_model.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <febiodea/base/error.h>
#include <febiodea/base/parse.h>
#include <febiodea/io/files/output.h>
#include <febiodea/io/results/plot_file.h>
#include <febiodea/io/vtu/write_vtu.h>
#include <febiodea/views/data/run_csv.h>
#include <febiodea/views/text/table.h>

namespace dea {

namespace {

/// Times to solve, and which of them are written.
struct Times {
  std::vector<TimePoint> points;
  std::vector<char> keep_state;
};

/// Plot files hold times in single precision.
bool same_time(double a, double b, double end) { return std::abs(a - b) <= 1e-6 * end; }

/// Puts a time among the others, in order; its place.
std::size_t insert_time(const JointModel& model, std::vector<TimePoint>& times, double t, double end) {
  for (std::size_t i = 0; i < times.size(); ++i)
    if (same_time(times[i].time, t, end)) return i;
  const auto later = std::find_if(times.begin(), times.end(), [&](const TimePoint& p) { return p.time > t; });
  return static_cast<std::size_t>(times.insert(later, place_times(model, {t}).front()) - times.begin());
}

/// States of an FEA result: its times, between them only the ends of steps (where motions relative to a step start).
std::vector<TimePoint> fea_times(const JointModel& model, const std::string& path, std::vector<double>& fea) {
  const XpltFile file = read_xplt(path);
  if (file.states.empty()) throw InputError(path + ": found no complete state, expected the times of at least one");
  const double end = step_starts(model).back();
  const std::vector<TimePoint> own = model_times(model, true);
  std::vector<TimePoint> times;
  for (const TimePoint& p : own)
    if (p.time <= 0) times.push_back(p);
  for (double step_end : step_starts(model))
    if (step_end > 0) insert_time(model, times, step_end, end);
  for (const XpltState& state : file.states) {
    double t = state.time;
    if (!(t >= -1e-6 * end && t <= end * (1 + 1e-6)))
      throw InputError(fmt::format("{}: found a state at time {:g}, expected times from 0 to {:g}, those of the model",
                                   path, t, end));
    for (const TimePoint& p : own)
      if (same_time(p.time, t, end)) t = p.time;  // 0.05, not the single-precision 0.0500000007
    insert_time(model, times, t, end);
    fea.push_back(t);
  }
  return times;
}

/// `option`: how the user calls `states`.
Times choose_times(const JointModel& model, const std::string& states, const std::string& option,
                   const std::string& times_from) {
  const double end = step_starts(model).back();
  Times times;
  std::vector<double> fea;
  times.points = times_from.empty() ? model_times(model, states != "all") : fea_times(model, times_from, fea);
  const bool all = states == "all" || states.empty();
  if (all && times_from.empty()) {
    times.keep_state.assign(times.points.size(), 1);
    return times;
  }
  std::vector<double> chosen;
  if (all || states == "last") {
    chosen = fea;
    if (fea.empty())
      for (const TimePoint& p : times.points) chosen.push_back(p.time);
    if (states == "last") chosen = {*std::max_element(chosen.begin(), chosen.end())};
  } else {
    try {
      chosen = parse_numbers(states);
    } catch (const BadValue&) {
      throw UsageError(fmt::format("{}: found \"{}\", expected all, last or times t1,t2,...", option, states));
    }
  }
  for (double t : chosen) {
    if (!(t >= 0 && t <= end * (1 + 1e-6)))
      throw UsageError(
          fmt::format("{}: found time {:g}, expected times from 0 to {:g}, those of the model", option, t, end));
    insert_time(model, times.points, std::min(t, end), end);
  }
  for (const TimePoint& p : times.points)
    times.keep_state.push_back(
        std::any_of(chosen.begin(), chosen.end(), [&](double t) { return same_time(t, p.time, end); }));
  while (!times.keep_state.empty() && !times.keep_state.back()) {  // nothing follows from what comes after
    times.keep_state.pop_back();
    times.points.pop_back();
  }
  return times;
}

/// What the user should know of the states that are solved.
void note_states(const JointModel& model, const RunOptions& options, const Times& times,
                 std::vector<std::string>& findings) {
  if (!options.times_from.empty()) return;
  const std::string& states = options.outputs.states;
  const double steps = count_time_steps(model);
  if (states.empty() && very_many_time_steps(model))
    findings.push_back(thinned_note(model, times.points.size()));
  else if (!states.empty() && states != "all" && steps > 2.0 * static_cast<double>(times.points.size()) &&
           times.points.back().time >= 0.5 * step_starts(model).back())
    findings.push_back(
        fmt::format("of the model's {:.0f} time steps {} were solved on the way to the states asked for: each is an "
                    "equilibrium of its own",
                    steps, times.points.size()));
}

AnalysisOptions analysis_options(const RunOptions& options, const Times& times) {
  AnalysisOptions out;
  out.times = times.points;
  out.wanted = times.keep_state;
  out.activity = options.on_activity;
  if (!options.progress && !options.on_state) return out;
  out.progress = [&options](const StateResult& s, std::size_t index, std::size_t count) {
    if (options.on_state) options.on_state(s, index, count);
    if (!options.progress) return;
    options.progress(fmt::format("state {} of {}, time {}: {}, {} iterations", index + 1, count,
                                 number_text(s.when.time), name(s.equilibrium.outcome), s.equilibrium.iterations));
  };
  return out;
}

}  // namespace

bool wants_all_states(const RunOptions& options) {
  return options.outputs.states == "all" && options.times_from.empty();
}

RunResult run_model(const Recognition& recognition, const RunOptions& options) {
  const double start = seconds();
  const JointModel& model = recognition.model;
  const OutputSettings& outputs = options.outputs;
  Times times;
  try {
    times = choose_times(model, outputs.states, options.states_option, options.times_from);
  } catch (const InputError&) {
    if (recognition.faults.empty()) throw;
  }
  RunResult result;
  Timings& timings = result.timings;
  timings.read = options.seconds_reading + seconds() - start;
  result.analysis = analyse(recognition, analysis_options(options, times));
  note_states(model, options, times, result.analysis.joint.findings);
  timings.joint = result.analysis.seconds_joint;
  timings.solve = result.analysis.seconds_solve;

  const double write_start = seconds();
  if (options.on_writing) options.on_writing(outputs.output);
  XpltFile xplt = make_plot_file(model, result.analysis, options.compress);
  write_xplt(outputs.output, xplt);
  if (!outputs.vtu.empty()) write_vtu(outputs.vtu, xplt);
  timings.write = seconds() - write_start;
  timings.total = options.seconds_reading + seconds() - start;
  if (!outputs.json.empty())
    write_text(outputs.json, json_text(run_json(model, recognition.settings, result.analysis, timings)));
  if (!outputs.csv.empty()) write_text(outputs.csv, run_csv(result.analysis));
  if (!outputs.facets_csv.empty()) write_text(outputs.facets_csv, facets_csv(model, result.analysis));
  if (options.with_plot) options.with_plot(result.analysis, std::move(xplt));
  return result;
}

bool all_solved(const Analysis& analysis) {
  return std::all_of(analysis.states.begin(), analysis.states.end(),
                     [](const StateResult& s) { return solved(s.equilibrium.outcome); });
}

std::string run_summary(const RunOptions& options, const RunResult& result) {
  const Timings& t = result.timings;
  return fmt::format("{}: {} states in {:.2f} s (read {:.2f}, joint {:.2f}, solve {:.2f}, write {:.2f})",
                     options.outputs.output, result.analysis.states.size(), t.total, t.read, t.joint, t.solve, t.write);
}

}  // namespace dea

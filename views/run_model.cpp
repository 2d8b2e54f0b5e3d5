// From a model to results in files.
#include <febiodea/views/run_model.h>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include <febiodea/base/error.h>
#include <febiodea/io/files/output.h>
#include <febiodea/io/results/plot_file.h>
#include <febiodea/io/settings/settings_xml.h>
#include <febiodea/io/vtu/write_vtu.h>
#include <febiodea/run/states.h>
#include <febiodea/views/text/report_text.h>

namespace dea {

namespace {

/// `option`: how the user calls `states`.
States wanted_states(const JointModel& model, const std::string& states, const std::string& option,
                     const std::string& times_from) {
  ResultTimes times;
  if (times_from.empty()) {
    times.times = model_times(model, states != "all");
  } else {
    const XpltFile file = read_xplt(times_from);
    if (file.states.empty())
      throw InputError(times_from + ": found no complete state, expected the times of at least one");
    std::vector<double> found;
    for (const XpltState& state : file.states) found.push_back(state.time);
    times = times_of_result(model, found, times_from);
  }
  const bool all = states == "all" || states.empty();
  if (all && times_from.empty()) return all_states(std::move(times.times));
  std::vector<double> chosen;
  if (all || states == "last") {
    chosen = times.of_result;
    if (chosen.empty())
      for (const TimePoint& p : times.times) chosen.push_back(p.time);
    if (states == "last") chosen = {*std::max_element(chosen.begin(), chosen.end())};
  } else {
    try {
      chosen = parse_numbers(states);
    } catch (const BadValue&) {
      throw UsageError(fmt::format("{}: found \"{}\", expected all, last or times t1,t2,...", option, states));
    }
  }
  return choose_states(model, std::move(times.times), chosen, option);
}

}  // namespace

bool wants_all_states(const RunOptions& options) { return options.states == "all" && options.times_from.empty(); }

RunResult run_model(const Recognition& recognition, const RunOptions& options) {
  const double start = seconds();
  const JointModel& model = recognition.model;
  const Settings& settings = recognition.settings;
  States states;
  try {
    states = wanted_states(model, options.states, options.states_option, options.times_from);
  } catch (const InputError&) {
    if (recognition.faults.empty()) throw;
  }
  RunResult result;
  result.timings.read = options.seconds_reading + seconds() - start;

  AnalysisOptions analysis;
  analysis.times = states.times;
  analysis.keep_state = states.wanted;
  analysis.activity = options.on_activity;
  analysis.equilibrium.stop = options.stop;
  if (options.progress || options.on_state) {
    analysis.progress = [&options](const StateResult& s, std::size_t index, std::size_t count) {
      if (options.on_state) options.on_state(s, index, count);
      if (!options.progress) return;
      options.progress(fmt::format("state {} of {}, time {}: {}, {} iterations", index + 1, count,
                                   number_text(s.when.time), name(s.equilibrium.outcome), s.equilibrium.iterations));
    };
  }
  result.analysis = analyse(recognition, analysis);
  if (!options.with_plot) {  // the bulk of the memory
    result.analysis.beds = {};
    result.analysis.maps = {};
  }
  if (options.times_from.empty() && options.states != "all") {
    std::vector<std::string>& findings = result.analysis.joint.findings;
    if (options.states.empty() && very_many_time_steps(model))
      findings.push_back(thinned_note(model, states.times.size()));
    else if (!options.states.empty() && many_states_left_out(model, states.times))
      findings.push_back(left_out_note(model, states.times.size()));
  }
  result.timings.joint = result.analysis.seconds_joint;
  result.timings.solve = result.analysis.seconds_solve;

  const double write_start = seconds();
  if (options.on_writing) options.on_writing(options.output);
  XpltFile plot = make_plot_file(model, result.analysis, options.compress);
  write_xplt(options.output, plot);
  end_if_stopped(options.stop);
  if (!options.vtu.empty()) write_vtu(options.vtu, plot);
  result.timings.write = seconds() - write_start;
  result.timings.total = options.seconds_reading + seconds() - start;
  end_if_stopped(options.stop);
  if (!options.json.empty())
    write_text(options.json, json_text(run_json(model, settings, result.analysis, result.timings)));
  if (!options.csv.empty()) write_text(options.csv, run_csv(model, result.analysis));
  if (!options.facets_csv.empty()) write_text(options.facets_csv, facets_csv(model, result.analysis));
  end_if_stopped(options.stop);
  if (options.with_plot) options.with_plot(result.analysis, std::move(plot));
  return result;
}

bool all_solved(const Analysis& analysis) {
  return std::all_of(analysis.states.begin(), analysis.states.end(),
                     [](const StateResult& s) { return solved(s.equilibrium.outcome); });
}

std::string run_summary(const RunOptions& options, const RunResult& result) {
  const Timings& t = result.timings;
  return fmt::format("{}: {} states in {:.2f} s (read {:.2f}, joint {:.2f}, solve {:.2f}, write {:.2f})",
                     options.output, result.analysis.states.size(), t.total, t.read, t.joint, t.solve, t.write);
}

}  // namespace dea

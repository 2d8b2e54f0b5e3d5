// `dea run`: every wanted state solved and written.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis.h"
#include "commands.h"
#include "error.h"
#include "output.h"
#include "plot_file.h"
#include "read_feb.h"
#include "report_json.h"
#include "report_text.h"
#include "settings_xml.h"

namespace dea {

namespace {

constexpr const char* kFooter = R"(
Units are the model's own everywhere; the ones in brackets are those of a model in mm, N, MPa. Names may hold spaces: put
the word in quotes, as in --thickness "femoral cartilage=1.8". A name and its value are cut at the last '='.

Standard output holds the table of results, or nothing but JSON or CSV with --json - or --csv -; all else is on standard
error.

Examples:
  dea run hip.feb
  dea run hip.feb -o walking.xplt --json walking.json --states last
  dea run hip.feb --force femur=-432,262,-1834 --load-at femur=sphere-center --law neo-Hookean
  dea run hip.feb --times-from hip.xplt --csv - -q > walking.csv)";

/// Times to solve, and which of them are written.
struct Times {
  std::vector<TimePoint> points;
  std::vector<char> wanted;
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
  const std::vector<TimePoint> own = model_times(model);
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

Times choose_times(const JointModel& model, const std::string& states, const std::string& times_from) {
  const double end = step_starts(model).back();
  Times times;
  std::vector<double> fea;
  times.points = times_from.empty() ? model_times(model) : fea_times(model, times_from, fea);
  if (states == "all" && times_from.empty()) {
    times.wanted.assign(times.points.size(), 1);
    return times;
  }
  std::vector<double> chosen;
  if (states == "all" || states == "last") {
    chosen = fea;
    if (fea.empty())
      for (const TimePoint& p : times.points) chosen.push_back(p.time);
    if (states == "last") chosen = {*std::max_element(chosen.begin(), chosen.end())};
  } else {
    try {
      chosen = parse_numbers(states);
    } catch (const BadValue&) {
      throw UsageError(fmt::format("--states {}: found \"{}\", expected all, last or times t1,t2,...", states, states));
    }
  }
  for (double t : chosen) {
    if (!(t >= 0 && t <= end * (1 + 1e-6)))
      throw UsageError(fmt::format("--states {}: found time {:g}, expected times from 0 to {:g}, those of the model",
                                   states, t, end));
    insert_time(model, times.points, std::min(t, end), end);
  }
  for (const TimePoint& p : times.points)
    times.wanted.push_back(
        std::any_of(chosen.begin(), chosen.end(), [&](double t) { return same_time(t, p.time, end); }));
  while (!times.wanted.empty() && !times.wanted.back()) {  // nothing follows from what comes after
    times.wanted.pop_back();
    times.points.pop_back();
  }
  return times;
}

}  // namespace

CLI::App* add_run(CLI::App& app, RunArguments& a) {
  CLI::App* c = app.add_subcommand("run", "Solve the contact of a model and write a plot file, a table, JSON or CSV");
  c->footer(kFooter);
  c->add_option("MODEL", a.model, "FEBio model (.feb, versions 2.5, 3.0, 4.0)")->required()->type_name("");
  c->add_option("-o", a.output, "Plot file [MODEL without .feb + _dea.xplt, beside the model]")
      ->type_name("FILE.xplt")
      ->group("Output");
  c->add_option("--json", a.json, "Also write JSON, \"-\" to standard output")->type_name("FILE|-")->group("Output");
  c->add_option("--csv", a.csv, "Also write CSV, a line per state and contact, \"-\" to standard output")
      ->type_name("FILE|-")
      ->group("Output");
  CLI::Option* q = c->add_flag("-q,--quiet", a.quiet, "Print nothing but errors")->group("Output");
  c->add_flag("-v,--verbose", a.verbose, "Print a line per state as it is solved")->excludes(q)->group("Output");
  c->add_option("--states", a.states, "States to write: all, last, or times t1,t2,... [all]")
      ->type_name("all|last|t1,t2,...")
      ->group("Output");
  c->add_option("--times-from", a.times_from, "Take the times of this FEA result instead of the model's")
      ->type_name("FEA.xplt")
      ->group("Output");
  c->add_flag("--compress", a.compress, "Compress the plot file (zlib)")->group("Output");
  add_settings_options(*c, a.settings, true, true);
  add_threads_option(*c, a.threads);
  return c;
}

int run(const RunArguments& a) {
  const double start = seconds();
  const std::string output = a.output.empty() ? default_output(a.model) : a.output;
  if (output == "-") throw UsageError("-o -: the plot file cannot go to standard output, give it a name");
  std::vector<NamedPath> inputs = {{"the model", a.model}}, outputs = {{"-o", output}};
  if (!a.times_from.empty()) inputs.push_back({"the FEA result", a.times_from});
  if (!a.settings.file.empty()) inputs.push_back({"the settings file", a.settings.file});
  if (!a.json.empty()) outputs.push_back({"--json", a.json});
  if (!a.csv.empty()) outputs.push_back({"--csv", a.csv});
  const auto threads = limit_threads(a.threads);
  const Settings settings = effective_settings(a.settings);

  Timings timings;
  const JointModel model = read_feb(a.model);
  check_outputs(inputs, outputs);
  const Times times = choose_times(model, a.states, a.times_from);
  timings.read = seconds() - start;

  AnalysisOptions options;
  options.times = times.points;
  options.wanted = times.wanted;
  if (!a.quiet && (a.verbose || stderr_is_terminal())) {
    options.progress = [](const StateResult& s, std::size_t index, std::size_t count) {
      log(fmt::format("state {} of {}, time {}: {}, {} iterations", index + 1, count, number_text(s.when.time),
                      name(s.equilibrium.outcome), s.equilibrium.iterations));
    };
  }
  const Analysis analysis = analyse(model, settings, options);
  timings.joint = analysis.seconds_joint;
  timings.solve = analysis.seconds_solve;

  const double write_start = seconds();
  write_xplt(output, make_plot_file(model, analysis, a.compress));
  timings.write = seconds() - write_start;
  timings.total = seconds() - start;
  if (!a.json.empty()) write_text(a.json, json_text(run_json(model, settings, analysis, timings)));
  if (!a.csv.empty()) write_text(a.csv, run_csv(model, analysis));

  if (!a.quiet) {
    for (const std::string& line : model_remarks(model, analysis.joint)) log(line);
    for (const std::string& line : result_remarks(model, analysis)) log(line);
    if (a.json != "-" && a.csv != "-") print(run_text(model, analysis));
    log(fmt::format("{}: {} states in {:.2f} s (read {:.2f}, joint {:.2f}, solve {:.2f}, write {:.2f})", output,
                    analysis.states.size(), timings.total, timings.read, timings.joint, timings.solve, timings.write));
  }
  const bool all_solved = std::all_of(analysis.states.begin(), analysis.states.end(),
                                      [](const StateResult& s) { return solved(s.equilibrium.outcome); });
  return all_solved ? kSolved : kNoSolution;
}

}  // namespace dea

// `dea run`: every wanted state solved and written.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/commands.h"
#include "app/interrupt.h"
#include "app/live_page.h"
#include "app/progress.h"
#include "io/feb/read_feb.h"
#include "io/files/output.h"
#include "io/results/existing_file.h"
#include "io/run/spring_memory.h"
#include "io/run/wanted_states.h"
#include "io/settings/output_options.h"
#include "io/tables/read_tables.h"
#include "src/base/error.h"
#include "src/base/time_text.h"
#include "src/rules/rules.h"
#include "views/page/write_page.h"
#include "views/run_model.h"
#include "views/text/run_text.h"

namespace dea {

namespace {

constexpr const char* kRunFooter = R"(
All units are the model's own; the ones in brackets, (mm), (N), (MPa), are those of a model in mm, N, MPa. Square brackets have
the default. If a name has spaces, put the word in quotes: --thickness "femoral cartilage=1.8". The last '=' separates name
and value.

Standard output has the table of results, or only JSON or CSV with --json -, --csv -, --compartments-csv - or --facets-csv -.
All else is on standard error.

p99, mean, area and peak have one definition, also in `dea compare`, `dea plot`, pages, JSON (headline) and CSV (headline_...).
They are of what is above 5 % of the load's mean pressure (the sum of p^2 A over the sum of p A) on the surface with springs.
Area and mean are those within the edge of contact, which runs through facets: in each facet there pressure falls linearly to 0,
as the facets around it say, and the facet keeps its force. p99 and peak are of nodes, averages of the facets around each,
weighted by area. --details prints all other numbers. docs/results.md explains every key of JSON and column of CSV.

Examples:
  dea run hip.feb
  dea run hip.feb -o walking.xplt --json walking.json --states last
  dea run hip.feb --force femur=432,-262,1834 --load-at femur=sphere-center --law neo-Hookean
  dea run hip.feb --times-from hip.xplt --csv - -q > walking.csv
  dea run hip.feb --report hip.html && xdg-open hip.html
  dea run hip.feb --live hip_live.html && xdg-open hip_live.html
  dea run hip.feb --vtu hip_paraview && paraview hip_paraview/results.pvd
  dea run hip.feb --states last --facets-csv facets.csv)";

}  // namespace

CLI::App* add_run(CLI::App& app, RunArguments& a) {
  CLI::App* c = add_model_command(
      app, "run", "Solve the contact of a model and write a plot file, a table, JSON or CSV", kRunFooter, a);
  const auto add_output = [&](const OutputOption& o) {
    add_once(*c, command_line_name(o).c_str(), a.outputs.*o.text, o.type, "Output", o.help);
  };
  for (const OutputOption& o : output_options()) {
    if (o.kind == OutputOption::Kind::Switch)
      c->add_flag_callback(
           command_line_name(o), [&a, &o] { a.outputs.*o.text = "true"; }, o.help)
          ->group("Output");
    else if (o.kind != OutputOption::Kind::States)
      add_output(o);
  }
  add_once(*c, "--live", a.live, "FILE.html", "Output",
           "Also write a page that has the joint and this program, to be turned, moved and loaded by hand; it needs "
           "dea.html beside the program");
  add_overwrite_flag(*c, a.overwrite);
  add_findings_options(*c, a.findings);
  c->add_flag("-v,--verbose", a.verbose,
              "Also print every iteration, and a line per state: iterations, residual, seconds")
      ->group("Output");
  c->add_flag("--details", a.details, "Print more numbers of every contact and state, with their full names")
      ->group("Output");
  for (const OutputOption& o : output_options())
    if (o.kind == OutputOption::Kind::States) add_output(o);
  add_once(*c, "--times-from", a.times_from, "FEA.xplt", "Output",
           "Solve the times of this FEA result instead of the model's");
  add_compress_flag(*c, a.compress);
  add_solving_options(*c, a.settings, a.threads);
  return c;
}

namespace {

void announce(Progress& progress, const std::string& what) { progress.now(what, "", what); }

/// `options` and `progress` live as long as the run.
void watch(RunOptions& options, Progress& progress) {
  options.stop = stop_flag();
  options.on_activity = [&progress](const Activity& activity) {
    now_under_way(activity.stage == Activity::Stage::State ? UnderWay::Search : UnderWay::NothingToLose);
    show_activity(progress, activity);
  };
  options.on_writing = [&progress](const std::string& path) {
    now_under_way(UnderWay::Writing);
    announce(progress, "writing " + file_name(path));
  };
  options.on_state = [&progress, last = seconds()](const StateResult& s, std::size_t index, std::size_t count) mutable {
    const Equilibrium& e = s.equilibrium;
    const std::string what = fmt::format("state {} of {}", index + 1, count);
    const double now = seconds();
    progress.step(
        what,
        fmt::format("{}, time {}: {}, {} iterations, residual {}, {:.2f} s", what, time_text(s.when.time),
                    name(e.outcome), e.iterations,
                    std::isfinite(e.residual_force) ? fmt::format("{:.1e}", e.residual_force) : "-", now - last),
        index + 1, count);
    last = now;
  };
}

bool has_compartments(const Analysis& analysis) {
  const auto divided = [](const ContactStatistics& s) { return !s.compartments.empty(); };
  return std::any_of(analysis.states.begin(), analysis.states.end(), [&](const StateResult& state) {
    return std::any_of(state.statistics.begin(), state.statistics.end(), divided);
  });
}

void print_result(const JointModel& model, const RunOptions& options, const RunResult& result, bool details) {
  const OutputSettings& o = options.outputs;
  if (o.json != "-" && o.csv != "-" && o.compartments_csv != "-" && o.facets_csv != "-")
    print(run_text(model, result.analysis, details));
  if (!o.compartments_csv.empty() && !has_compartments(result.analysis))
    log(fmt::format("note: {} has the names of its columns and no rows: every surface is in one piece",
                    o.compartments_csv == "-" ? "the table of compartments" : o.compartments_csv));
  log(run_summary(options, result));
}

/// What is odd about the model, before it is solved. Returns what was told.
Findings tell_of_model(const Recognition& recognition, const FindingsArguments& asked, Progress& progress) {
  const Findings odd = warnings(model_findings(recognition.model, recognition.joint));
  progress.clear();
  tell(odd, asked);
  return odd;
}

/// The rest, once it is solved: what was odd about the model has been told.
void tell_of_result(const Findings& findings, const Findings& told, const FindingsArguments& asked) {
  Findings rest;
  for (const Finding& f : findings)
    if (std::find(told.begin(), told.end(), f) == told.end()) rest.push_back(f);
  tell(rest, asked);
}

/// Before anything that takes long or much memory.
void tell_cost(const Recognition& recognition, bool quiet, Progress& progress) {
  const std::string note = spring_cost_note(recognition);
  if (note.empty() || quiet) return;
  progress.clear();
  log(note);
}

/// The command line over the settings file; where neither says a word, there is a plot file.
void name_plot_file(const RunArguments& a, OutputSettings& typed, OutputSettings& file) {
  const bool none = typed.no_xplt == "true" || (file.no_xplt == "true" && typed.output.empty());
  if (!none) {
    if (typed.output.empty() && file.output.empty()) typed.output = default_output(a.model);
    return;
  }
  if (!typed.output.empty())
    throw UsageError(fmt::format("--no-xplt and -o {}: found both, expected one of them", typed.output));
  if (a.compress)
    throw UsageError(fmt::format("--compress belongs to the plot file, found {} beside it",
                                 given_as(&OutputSettings::no_xplt, typed)));
  file.output.clear();
}

}  // namespace

int run(const RunArguments& a) {
  const bool quiet = quiet_altogether(a.findings);
  check_codes(a.findings, a.verbose);
  const double start = seconds();
  const auto threads = limit_threads(a.threads);
  OutputSettings typed = a.outputs, file;
  typed.states_given = "--states " + typed.states;
  Settings settings = effective_settings(a.settings, &file);
  name_plot_file(a, typed, file);
  RunOptions options;
  options.outputs = over(typed, file);
  options.times_from = a.times_from;
  options.compress = a.compress;
  const std::string &output = options.outputs.output, &page = options.outputs.report;
  const std::string output_option = given_as(&OutputSettings::output, typed);
  require_page_name(given_as(&OutputSettings::report, typed), page);
  require_page_name("--live", a.live);
  if (!a.live.empty() && !a.times_from.empty())
    throw UsageError("--live and --times-from: found both, expected one of them: a page has the model's own times");
  const std::string program = a.live.empty() ? "" : live_program();
  require_file(output_option, output);

  Progress progress(progress_style(quiet, a.verbose));
  announce(progress, "reading " + file_name(a.model));
  JointModel read = read_feb(a.model);
  std::vector<NamedPath> files = input_files(a, settings);
  if (!a.times_from.empty()) files.insert(files.begin() + 1, {"the FEA result", a.times_from});
  if (!program.empty()) files.push_back({"the page of the program", program});
  std::vector<NamedPath> outputs = named_outputs(typed, file);
  if (!a.live.empty()) outputs.push_back({"--live", a.live});
  const HeldOutputs held = claim_outputs(files, outputs);
  std::vector<NamedPath> others = outputs;
  std::erase_if(others, [&](const NamedPath& file) { return file.path == output; });
  if (!a.overwrite) refuse_to_replace(others);
  files.insert(files.end(), outputs.begin(), outputs.end());
  const std::string name_note = output.empty() ? "" : plot_name_note(output_option, output);
  const bool replaces = would_replace(output);
  options.seconds_reading = seconds() - start;
  watch(options, progress);
  show_activity(progress, {});
  settle_units(read, settings);
  read_tables(read, settings);
  const std::string live = program.empty() ? "" : live_page_of(program, a, read, settings, a.outputs.states);
  const Recognition recognition =
      recognise(std::move(read), settings, wants_all_states(options.outputs, options.times_from));
  tell_cost(recognition, quiet, progress);
  Findings told;
  options.on_times = [&](const std::vector<double>& times) {
    if (!a.overwrite) refuse_to_replace("-o", output, why_kept(output, recognition.model, times));
    if (!quiet) told = tell_of_model(recognition, a.findings, progress);
  };
  if (!page.empty()) {
    options.with_plot = [&](const Analysis& analysis, XpltFile&& xplt) {
      announce(progress, "writing " + file_name(page));
      write_run_page(page, recognition, analysis, std::move(xplt), a.model, output.empty() ? a.model : output, a.words,
                     files);
    };
  }
  const RunResult result = run_model(recognition, options);
  if (!a.live.empty()) write_text(a.live, live);
  progress.clear();

  if (!quiet) {
    if (!name_note.empty()) log(name_note);
    tell_of_result(result.analysis.findings, told, a.findings);
    print_result(recognition.model, options, result, a.details);
    if (!page.empty()) log(page + ": the report");
    if (!a.live.empty()) log(a.live + ": the joint to be taken in the hand");
    if (replaces) log(fmt::format("note: {} replaced the file that was there; -o writes another", output));
  } else {
    tell_quietly(result.analysis);
  }
  const bool refused = tell_refused(result.analysis.findings, a.findings);
  return all_solved(result.analysis) && !refused ? kSolved : kNoSolution;
}

}  // namespace dea

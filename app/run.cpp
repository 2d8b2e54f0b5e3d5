// `dea run`: every wanted state solved and written.
#include <fmt/format.h>

#include <cmath>

#include <febiodea/app/commands.h>
#include <febiodea/app/interrupt.h>
#include <febiodea/app/progress.h>
#include <febiodea/base/error.h>
#include <febiodea/io/feb/read_feb.h>
#include <febiodea/io/files/output.h>
#include <febiodea/io/settings/settings_xml.h>
#include <febiodea/views/page/write_report.h>
#include <febiodea/views/run_model.h>
#include <febiodea/views/text/report_text.h>

namespace dea {

namespace {

constexpr const char* kRunFooter = R"(
Units are the model's own everywhere; the ones in brackets are those of a model in mm, N, MPa. Names may hold spaces: put
the word in quotes, as in --thickness "femoral cartilage=1.8". A name and its value are cut at the last '='.

Standard output holds the table of results, or nothing but JSON or CSV with --json -, --csv - or --facets-csv -; all else
is on standard error.

Examples:
  dea run hip.feb
  dea run hip.feb -o walking.xplt --json walking.json --states last
  dea run hip.feb --force femur=-432,262,-1834 --load-at femur=sphere-center --law neo-Hookean
  dea run hip.feb --times-from hip.xplt --csv - -q > walking.csv
  dea run hip.feb --report hip.html && xdg-open hip.html
  dea run hip.feb --vtu hip_paraview && paraview hip_paraview/results.pvd
  dea run hip.feb --states last --facets-csv facets.csv)";

}  // namespace

CLI::App* add_run(CLI::App& app, RunArguments& a) {
  CLI::App* c = app.add_subcommand("run", "Solve the contact of a model and write a plot file, a table, JSON or CSV");
  c->footer(kRunFooter);
  c->add_option("MODEL", a.model, "FEBio model (.feb, versions 1.2, 2.0, 2.5, 3.0, 4.0)")->required()->type_name("");
  c->add_option("-o", a.output, "Plot file [MODEL without .feb + _dea.xplt, beside the model]")
      ->type_name("FILE.xplt")
      ->group("Output");
  c->add_option("--json", a.json, "Also write JSON, \"-\" to standard output")->type_name("FILE|-")->group("Output");
  c->add_option("--csv", a.csv, "Also write CSV, a line per state and contact, \"-\" to standard output")
      ->type_name("FILE|-")
      ->group("Output");
  c->add_option(
       "--facets-csv", a.facets_csv,
       "Also write CSV, a line per state, contact and facet: pressure, joint space, overlap; \"-\" to standard "
       "output")
      ->type_name("FILE|-")
      ->group("Output");
  c->add_option("--report", a.report, "Also write a page for any browser: maps, curves, tables, what was recognised")
      ->type_name("FILE.html")
      ->group("Output");
  c->add_option("--vtu", a.vtu, "Also write files for ParaView into this folder: open its results.pvd")
      ->type_name("FOLDER")
      ->group("Output");
  CLI::Option* q = c->add_flag("-q,--quiet", a.quiet, "Print nothing but errors")->group("Output");
  c->add_flag("-v,--verbose", a.verbose,
              "Print what is begun, every iteration, and a line per state: iterations, residual, seconds")
      ->excludes(q)
      ->group("Output");
  c->add_option("--states", a.states,
                "States to write: all, last, or times t1,t2,... [all; about 1000 where there are more than 10000]")
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
  const auto threads = limit_threads(a.threads);
  OutputSettings file;
  const Settings settings = effective_settings(a.settings, &file);
  const auto first = [](const std::string& typed, const std::string& in_file) {
    return typed.empty() ? in_file : typed;
  };

  RunOptions options;
  options.output = first(a.output, file.output);
  const char* output_option = a.output.empty() && !file.output.empty() ? "<output>" : "-o";
  if (options.output.empty()) options.output = default_output(a.model);
  options.json = first(a.json, file.json);
  options.csv = first(a.csv, file.csv);
  options.facets_csv = first(a.facets_csv, file.facets_csv);
  options.vtu = first(a.vtu, file.vtu);
  options.times_from = a.times_from;
  options.compress = a.compress;
  if (!a.states.empty()) {
    options.states = a.states;
    options.states_option = fmt::format("--states {}", a.states);
  } else if (!file.states.empty()) {
    options.states = file.states;
    options.states_option = fmt::format("{}: <states>", a.settings.file);
  }
  const std::string report = first(a.report, file.report);
  const char* report_option = a.report.empty() ? "<report>" : "--report";
  require_page_name(report_option, report);
  if (options.output == "-")
    throw UsageError(fmt::format("{} -: the plot file cannot go to standard output, give it a name", output_option));
  std::vector<NamedPath> inputs = {{"the model", a.model}}, outputs = {{output_option, options.output}};
  if (!a.times_from.empty()) inputs.push_back({"the FEA result", a.times_from});
  if (!a.settings.file.empty()) inputs.push_back({"the settings file", a.settings.file});
  if (!options.json.empty()) outputs.push_back({a.json.empty() ? "<json>" : "--json", options.json});
  if (!options.csv.empty()) outputs.push_back({a.csv.empty() ? "<csv>" : "--csv", options.csv});
  if (!options.facets_csv.empty())
    outputs.push_back({a.facets_csv.empty() ? "<facets-csv>" : "--facets-csv", options.facets_csv});
  if (!report.empty()) outputs.push_back({report_option, report});
  if (!options.vtu.empty()) outputs.push_back({a.vtu.empty() ? "<vtu>" : "--vtu", options.vtu, true});

  Progress progress(progress_style(a.quiet, a.verbose));
  const auto begin = [&](const std::string& what) { progress.now(what, "", what); };
  begin("reading " + file_name(a.model));
  JointModel read = read_feb(a.model);
  check_outputs(inputs, outputs);
  const std::string name_note = plot_name_note(output_option, options.output);
  options.seconds_reading = seconds() - start;
  double last = seconds();
  options.stop = stop_flag();
  options.on_activity = [&](const Activity& activity) {
    now_under_way(activity.stage == Activity::Stage::State ? UnderWay::Search : UnderWay::NothingToLose);
    show_activity(progress, activity);
  };
  options.on_writing = [&](const std::string& path) {
    now_under_way(UnderWay::Writing);
    begin("writing " + file_name(path));
  };
  options.on_state = [&](const StateResult& s, std::size_t index, std::size_t count) {
    const Equilibrium& e = s.equilibrium;
    const std::string what = fmt::format("state {} of {}", index + 1, count);
    const double now = seconds();
    progress.step(
        what,
        fmt::format("{}, time {}: {}, {} iterations, residual {}, {:.2f} s", what, number_text(s.when.time),
                    name(e.outcome), e.iterations,
                    std::isfinite(e.residual_force) ? fmt::format("{:.1e}", e.residual_force) : "-", now - last),
        index + 1, count);
    last = now;
  };
  show_activity(progress, {});
  const Recognition recognition = recognise(std::move(read), settings, wants_all_states(options));
  const JointModel& model = recognition.model;
  if (!report.empty()) {
    options.with_plot = [&](const Analysis& analysis, XpltFile&& plot) {
      std::vector<std::string> paths;
      for (const NamedPath& p : inputs) paths.push_back(p.path);
      for (const NamedPath& p : outputs) paths.push_back(p.path);
      begin("writing " + file_name(report));
      write_run_report(report, recognition, analysis, std::move(plot), a.model, options.output, a.words, paths);
    };
  }
  const RunResult result = run_model(recognition, options);
  progress.clear();

  if (!a.quiet) {
    if (!name_note.empty()) log(name_note);
    for (const std::string& line : model_remarks(model, result.analysis.joint)) log(line);
    for (const std::string& line : result_remarks(model, result.analysis)) log(line);
    if (options.json != "-" && options.csv != "-" && options.facets_csv != "-") print(run_text(model, result.analysis));
    log(run_summary(options, result));
  }
  return all_solved(result.analysis) ? kSolved : kNoSolution;
}

}  // namespace dea

// From a model to results in files.
#include "views/run_model.h"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "io/files/output.h"
#include "io/results/plot_file.h"
#include "io/run/wanted_states.h"
#include "io/vtu/write_vtu.h"
#include "src/base/error.h"
#include "src/base/parse.h"
#include "src/base/say.h"
#include "src/base/time_text.h"
#include "src/rules/rules.h"
#include "views/data/run_csv.h"

namespace dea {

namespace {

/// What is as large as the mesh, and grows with every state: on disk, but for the plot file that `with_plot` takes.
struct GrowingResults {
  const Recognition& recognition;
  const States& states;
  const RunOptions& options;
  PlotHead head;
  std::optional<XpltWriter> plot;
  std::optional<VtuWriter> vtu;
  std::optional<Spool> facets;  ///< the lines of --facets-csv
  bool inside = false;          ///< these have columns of the inside of layers
  std::vector<XpltState> kept;  ///< with_plot alone
  double seconds_writing = 0.0;

  GrowingResults(const Recognition& r, const States& s, const RunOptions& o)
      : recognition(r), states(s), options(o), head(plot_head(r.model, r.joint, o.compress, r.settings.inside)) {
    const OutputSettings& outputs = o.outputs;
    if (!outputs.output.empty()) plot.emplace(outputs.output, head.file);
    if (!outputs.vtu.empty()) vtu.emplace(outputs.vtu, head.file);
    if (!outputs.facets_csv.empty()) facets.emplace(outputs.facets_csv);
  }
  void add(const StateResult& state, std::size_t index) {
    if (!states.wanted[index]) return;
    const double start = seconds();
    if (plot || vtu || options.with_plot) add_plot(plot_state(recognition.model, recognition.joint, head, state));
    if (facets) add_facets(state);
    seconds_writing += seconds() - start;
  }
  void add_plot(XpltState&& state) {
    if (plot) plot->add(state);
    if (vtu) vtu->add(state);
    if (options.with_plot) kept.push_back(std::move(state));
  }
  void add_facets(const StateResult& state) {
    inside = inside || has_inside(state);
    facets->add(facets_csv_lines(recognition.model, recognition.joint, state, inside));
  }
};

AnalysisOptions analysis_options(const RunOptions& options, const States& states, GrowingResults& growing) {
  AnalysisOptions out;
  out.keep_fields = false;
  out.times = states.times;
  out.keep_state = states.wanted;
  out.activity = options.on_activity;
  out.equilibrium.stop = options.stop;
  out.progress = [&options, &growing](const StateResult& s, std::size_t index, std::size_t count) {
    growing.add(s, index);
    if (options.on_state) options.on_state(s, index, count);
    if (!options.progress) return;
    options.progress(fmt::format("state {} of {}, time {}: {}, {} iterations", index + 1, count, time_text(s.when.time),
                                 name(s.equilibrium.outcome), s.equilibrium.iterations));
  };
  return out;
}

std::vector<double> times_to_write(const States& states) {
  std::vector<double> times;
  for (std::size_t i = 0; i < states.times.size(); ++i)
    if (states.wanted[i]) times.push_back(states.times[i].time);
  return times;
}

/// Everything but plot file and VTK files.
void write_others(const JointModel& model, const Settings& settings, const RunOptions& options,
                  const GrowingResults& growing, const RunResult& result) {
  const OutputSettings& outputs = options.outputs;
  if (!outputs.json.empty())
    write_pieces(outputs.json,
                 [&](const auto& put) { put_run_json(model, settings, result.analysis, result.timings, put); });
  if (!outputs.csv.empty()) write_text(outputs.csv, run_csv(result.analysis));
  if (!outputs.compartments_csv.empty()) write_text(outputs.compartments_csv, compartments_csv(result.analysis));
  if (growing.facets)
    write_pieces(outputs.facets_csv, [&](const auto& put) {
      put(facets_csv_names(growing.inside));
      growing.facets->read(0, growing.facets->size(), put);
    });
}

}  // namespace

RunResult run_model(const Recognition& recognition, const RunOptions& options) {
  const double start = seconds();
  const JointModel& model = recognition.model;
  const OutputSettings& outputs = options.outputs;
  States states;
  try {
    states = wanted_states(model, recognition.settings, outputs, options.times_from);
  } catch (const InputError&) {
    if (recognition.faults.empty()) throw;
  }
  throw_if_any(recognition.faults);
  if (options.on_times) options.on_times(times_to_write(states));
  RunResult result;
  Timings& timings = result.timings;
  timings.read = options.seconds_reading + seconds() - start;
  GrowingResults growing(recognition, states, options);
  AnalysisOptions how = analysis_options(options, states, growing);
  how.found_before = findings_of_states(model, outputs, options.times_from, states);
  result.analysis = analyse(recognition, how);
  if (!options.with_plot) {  // the bulk of the memory
    result.analysis.beds = {};
    result.analysis.maps = {};
  }
  timings.joint = result.analysis.seconds_joint;
  timings.solve = result.analysis.seconds_solve - growing.seconds_writing;

  const double write_start = seconds();
  if (options.on_writing) options.on_writing(outputs.output.empty() ? "results" : outputs.output);
  if (growing.plot) growing.plot->finish();
  end_if_stopped(options.stop);
  if (growing.vtu) growing.vtu->finish();
  timings.write = seconds() - write_start + growing.seconds_writing;
  timings.total = options.seconds_reading + seconds() - start;
  end_if_stopped(options.stop);
  write_others(model, recognition.settings, options, growing, result);
  end_if_stopped(options.stop);
  if (!options.with_plot) return result;
  growing.head.file.states = std::move(growing.kept);
  options.with_plot(result.analysis, std::move(growing.head.file));
  return result;
}

std::string run_summary(const RunOptions& options, const RunResult& result) {
  const Timings& t = result.timings;
  const std::string& output = options.outputs.output;
  return fmt::format("{}{} state{} in {:.2f} s (read {:.2f}, joint {:.2f}, solve {:.2f}, write {:.2f})",
                     output.empty() ? "" : output + ": ", result.analysis.states.size(),
                     result.analysis.states.size() == 1 ? "" : "s", t.total, t.read, t.joint, t.solve, t.write);
}

}  // namespace dea

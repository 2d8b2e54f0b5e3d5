#include "plugin/dea_task.h"

#include <FEBioLib/FEBioModel.h>
#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>

#include "io/files/output.h"
#include "io/files/system.h"
#include "io/results/existing_file.h"
#include "io/run/wanted_states.h"
#include "io/settings/settings_xml.h"
#include "io/tables/read_tables.h"
#include "plugin/febio_log.h"
#include "plugin/febio_wording.h"
#include "plugin/read_fe_model.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/stop.h"
#include "src/base/time_text.h"
#include "src/rules/rules.h"
#include "views/page/write_page.h"
#include "views/run_model.h"
#include "views/text/run_text.h"

namespace {

using namespace dea;

constexpr int kSignals[2] = {SIGINT, SIGTERM};
StopFlag stop_asked = false;
static_assert(StopFlag::is_always_lock_free);  // a handler may set nothing else

void on_signal(int signal) {
  std::signal(signal, on_signal);
  if (!stop_asked.exchange(true)) return;
  remove_unfinished();
  write_all(kStandardError, "dea: stopped\n");
  std::_Exit(128 + signal);
}

/// For as long as it lives SIGINT (Ctrl-C) and SIGTERM set a flag, and a second one ends the program at once, without
/// unfinished files. FEBio's own handler of SIGINT only makes a note for FEBio's solve, which a task has no part in; it
/// is back afterwards.
class Interrupts {
 public:
  Interrupts() {
    stop_asked = false;
    for (int i = 0; i < 2; ++i) {
      before_[i] = std::signal(kSignals[i], on_signal);
      if (before_[i] == SIG_IGN) std::signal(kSignals[i], SIG_IGN);
    }
  }
  ~Interrupts() {
    for (int i = 0; i < 2; ++i) std::signal(kSignals[i], before_[i] == SIG_ERR ? SIG_DFL : before_[i]);
  }
  Interrupts(const Interrupts&) = delete;
  Interrupts& operator=(const Interrupts&) = delete;

 private:
  using Handler = void (*)(int);
  Handler before_[2];
};

/// The plot file that FEBio was told of (-p, or the model's own word); not its default name, where its own results lie.
std::string plot_file_name(FEBioModel& fem) {
  const std::string model = fem.GetInputFileName(), plot = fem.GetPlotFileName();
  const std::string usual = std::filesystem::path(model).replace_extension(".xplt").string();
  return plot.empty() || plot == usual ? default_output(model) : plot;
}

/// FEBio has no command line for these, and keeps standard output for itself.
void check_names(const OutputSettings& outputs) {
  for (const OutputOption& o : output_options())
    if (o.kind == OutputOption::Kind::File && outputs.*o.text == "-")
      throw UsageError(fmt::format("<{}> -: standard output is FEBio's, give it a file name", o.name));
  require_page_name("<report>", outputs.report);
}

std::vector<NamedPath> input_files(FEBioModel& fem, const std::string& settings_file) {
  std::vector<NamedPath> inputs = {{"the model", fem.GetInputFileName()}};
  if (!settings_file.empty()) inputs.push_back({"the settings file", settings_file});
  if (!fem.GetLogfileName().empty()) inputs.push_back({"FEBio's log file", fem.GetLogfileName()});
  return inputs;
}

/// The first state that is no solution, and how many there are.
std::string no_solution(const Analysis& analysis, const std::string& output) {
  const std::vector<StateResult>& states = analysis.states;
  const auto unsolved = [](const StateResult& s) { return !solved(s.equilibrium.outcome); };
  const auto first = std::find_if(states.begin(), states.end(), unsolved);
  return fmt::format("dea: no solution in {} of {} states, first at time {} ({}){}",
                     std::count_if(first, states.end(), unsolved), states.size(), time_text(first->when.time),
                     name(first->equilibrium.outcome), output.empty() ? "" : "; results are in " + output);
}

/// `writing` becomes true when files begin to be complete. Throws Stopped.
bool run(FEBioModel& fem, const std::string& settings_file, const StopFlag* stop, bool& writing) {
  const double start = seconds();
  SettingsFile file;
  if (!settings_file.empty()) file = read_settings_file(settings_file);
  check_names(file.outputs);
  const bool unnamed = file.outputs.output.empty() && file.outputs.no_xplt != "true";
  if (unnamed) file.outputs.output = plot_file_name(fem);
  const std::string& plot = file.outputs.output;  // "": none is wanted
  RunOptions options;
  options.outputs = file.outputs;
  options.stop = stop;
  options.on_writing = [&writing](const std::string&) { writing = true; };
  std::vector<NamedPath> files = input_files(fem, settings_file), outputs = named_outputs({}, file.outputs);
  if (unnamed) outputs.front().option = "-p";

  for (const NamedPath& table : table_files(file.settings)) files.push_back(table);
  JointModel model = read_fe_model(fem);
  const HeldOutputs held = claim_outputs(files, outputs);
  files.insert(files.end(), outputs.begin(), outputs.end());
  options.seconds_reading = seconds() - start;
  options.progress = [&fem](const std::string& line) { log_text(fem, line); };
  settle_units(model, file.settings);
  read_tables(model, file.settings);
  end_if_stopped(stop);
  const Recognition recognition = recognise(model, file.settings, wants_all_states(options.outputs, ""));
  if (!file.outputs.report.empty()) {
    options.with_plot = [&](const Analysis& analysis, XpltFile&& xplt) {
      std::vector<std::string> words = {"febio4", "-i", fem.GetInputFileName(), "-task=dea"};
      if (!settings_file.empty()) words.push_back(settings_file);
      write_run_page(file.outputs.report, recognition, analysis, std::move(xplt), fem.GetInputFileName(),
                     plot.empty() ? fem.GetInputFileName() : plot, words, files);
    };
  }
  options.on_times = [&](const std::vector<double>& times) {
    end_if_stopped(stop);
    const std::string kept = plot.empty() ? "" : why_kept(plot, recognition.model, times);
    if (!kept.empty()) throw WriteError(fmt::format("{}: {}; name another with <output>, or take it away", plot, kept));
  };
  const RunResult result = run_model(recognition, options);

  for (const std::string& line : coded_lines(result.analysis.findings, febio_wording()))
    log_text(fem, message_line(line));
  log_text(fem, run_text(model, result.analysis, false));
  log_text(fem, run_summary(options, result));
  if (all_solved(result.analysis)) return true;
  log_error(fem, no_solution(result.analysis, plot));
  return false;
}

}  // namespace

DeaTask::DeaTask(FEModel* fem) : FECoreTask(fem) {}

bool DeaTask::Init(const char* file) {
  settings_file_ = file == nullptr ? "" : file;
  return true;  // faults are told by Run: FEBio adds nothing to them there
}

bool DeaTask::Run() {
  std::string fault;
  const Interrupts interrupts;
  bool writing = false;
  try {
    auto* fem = dynamic_cast<FEBioModel*>(GetFEModel());
    if (fem == nullptr) throw UsageError("the model is none of febio4's");
    open_log_file(*fem);
    log_text(*fem, version_line() + ": task dea\n" + untested_line());
    return run(*fem, settings_file_, &stop_asked, writing);
  } catch (const Stopped&) {
    fault = writing ? "dea: stopped before all files were written" : "dea: stopped, nothing was written";
  } catch (const UsageError& e) {
    fault = "dea: " + line(e.fault, febio_wording());
  } catch (const InputError& e) {
    fault = line(e.fault, febio_wording());
  } catch (const WriteError& e) {
    fault = std::string("dea: cannot write ") + e.what();
  } catch (const std::exception& e) {
    fault = fmt::format("internal error: {}, please report", e.what());
  } catch (...) {
    fault = "internal error: unknown, please report";
  }
  log_error(*GetFEModel(), fault);
  return false;
}

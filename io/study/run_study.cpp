#include "io/study/run_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <filesystem>
#include <mutex>
#include <new>
#include <optional>
#include <system_error>
#include <thread>

#include "io/feb/read_feb.h"
#include "io/files/output.h"
#include "io/results/plot_file.h"
#include "io/run/wanted_states.h"
#include "io/settings/settings_xml.h"
#include "io/study/ready_joints.h"
#include "io/tables/read_tables.h"
#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/base/parallel.h"

namespace dea {

namespace {

/// The settings of a case, as if its options stood on the line of `dea run`.
Settings case_settings(const Plan& plan, const PlannedCase& c, const Settings& of_file) {
  Settings settings = of_file;
  std::vector<SettingValue> values;
  for (const CaseOption& option : options_of(plan, c)) {
    const SettingOption* known = find_setting_option(option.name);
    if (known == nullptr) throw UsageError(fmt::format("--{}: there is no such option", option.name));
    values.push_back(split_key(*known, option.text));
  }
  lay_over(settings, values);
  return settings;
}

/// What several threads share while cases are solved.
struct Work {
  const Plan& plan;
  const std::vector<std::size_t>& cases;
  const StudyOptions& options;
  Settings of_file;
  ReadyJoints own_joints{options.memory};
  ReadyJoints& joints = options.joints != nullptr ? *options.joints : own_joints;
  std::optional<JointUses> uses = {};  // of joints that nobody else will ask for
  std::atomic<std::size_t> next{0};
  std::mutex mutex = {};               // of what follows
  std::exception_ptr fault = nullptr;  // ends the study
};

OutputSettings states_asked(const StudyOptions& options) {
  OutputSettings asked;
  asked.states = options.states;
  asked.states_given = "--states " + options.states;
  return asked;
}

void write_plot(const std::string& path, const ReadyJoint& ready, const SolvedStates& solved, bool inside) {
  const PlotHead head = plot_head(ready.model, ready.prepared.joint, true, inside);
  XpltWriter file(path, head.file);
  for (const StateResult& state : solved.states) file.add(plot_state(ready.model, ready.prepared.joint, head, state));
  file.finish();
}

void solve(Work& work, const PlannedCase& c, const Settings& settings, CaseResult& result) {
  const StudyOptions& options = work.options;
  const std::shared_ptr<const ReadyJoint> ready =
      work.joints.get(work.plan.models[at(c.model)], settings, options.stop);
  const ReadyCase of = ready_case(*ready, settings, states_asked(options));
  AnalysisOptions solving;
  solving.times = of.states.times;
  solving.keep_state = of.states.wanted;
  solving.keep_fields = options.keep_fields || !options.plot_folder.empty();
  solving.displacements = !options.plot_folder.empty();
  if (of.settings.inside) solving.inside = &ready->inside();
  solving.equilibrium.stop = options.stop;
  if (!is_its_joint(of.settings))  // else nobody but this case may need it
    solving.known_balance = [&] { return ready->end_of_model(options.stop); };
  SolvedStates solved_states = solve_states(ready->model, of.settings, ready->prepared, ready->maps, solving);
  if (!options.plot_folder.empty())
    write_plot((std::filesystem::path(options.plot_folder) / fmt::format("{:06}.xplt", result.number)).string(), *ready,
               solved_states, of.settings.inside);
  add_states(*ready, std::move(solved_states), options.keep_fields, command_line_wording(), result);
}

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

/// At its end the joint of a case is forgotten, if no other case wants it.
struct LastUse {
  Work& work;
  const PlannedCase& c;
  const Settings& settings;
  ~LastUse() {
    if (work.uses && work.uses->was_last(c)) work.joints.forget(work.plan.models[at(c.model)], settings);
  }
};

CaseResult solve_case(Work& work, std::size_t index) {
  const auto start = std::chrono::steady_clock::now();
  CaseResult result;
  result.number = index + 1;
  const PlannedCase& c = work.plan.cases[index];
  try {
    const Settings settings = case_settings(work.plan, c, work.of_file);
    const LastUse last{work, c, settings};
    solve(work, c, settings, result);
  } catch (const BadValue& e) {
    result.message = one_line(e.what());
  } catch (const UsageError& e) {
    result.message = one_line(line(e.fault, command_line_wording()));
  } catch (const InputError& e) {
    result.message = one_line(line(e.fault, command_line_wording()));
  } catch (const std::bad_alloc&) {
    result.message = "there is not enough memory for it";
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

/// One thread's share: whatever case is next.
void solve_cases(Work& work) {
  const auto ended = [&work] {
    const std::lock_guard<std::mutex> lock(work.mutex);
    return work.fault != nullptr;
  };
  try {
    while (!ended()) {
      const std::size_t i = work.next++;
      if (i >= work.cases.size()) return;
      end_if_stopped(work.options.stop);
      CaseResult result = solve_case(work, work.cases[i]);
      const std::lock_guard<std::mutex> lock(work.mutex);
      if (!work.fault) work.options.done(std::move(result));
    }
  } catch (...) {
    const std::lock_guard<std::mutex> lock(work.mutex);
    if (!work.fault) work.fault = std::current_exception();
  }
}

}  // namespace

void run_study(const Plan& plan, const std::vector<std::size_t>& cases, const StudyOptions& options) {
  // each case on one thread: what is gained within one is lost between them
  const auto one_thread = limit_threads(1);
  Work work{plan, cases, options, {}};
  if (options.joints == nullptr) work.uses.emplace(plan, cases);
  if (!options.settings_file.empty()) work.of_file = read_settings_file(options.settings_file).settings;
  std::vector<std::thread> others;
  try {
    for (int t = 1; t < std::min(options.workers, static_cast<int>(cases.size())); ++t)
      others.emplace_back([&work] { solve_cases(work); });
  } catch (const std::system_error&) {  // no more threads are to be had: those that are there do it
  }
  solve_cases(work);
  for (std::thread& thread : others) thread.join();
  if (work.fault) std::rethrow_exception(work.fault);
}

}  // namespace dea

// `dea converge`: how many springs the result needs.
#include <fmt/format.h>

#include <algorithm>

#include "app/commands.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "io/feb/read_feb.h"
#include "io/files/output.h"
#include "io/tables/read_tables.h"
#include "src/base/error.h"
#include "src/run/convergence.h"
#include "src/run/recognise.h"
#include "views/data/run_json.h"
#include "views/text/run_text.h"

namespace dea {

namespace {

constexpr const char* kConvergeFooter = R"(
Solves the last state of the model again and again, with each spring's triangle divided into 1, 4, 16, 64, ..., and compares
p99, mean, area and peak with those of the division before. It ends when all four changes are below --target. If the next
division would need more than --max-springs, the target is not reached and the exit code is 1. The facets stay as they are:
what shorter ones would change only another mesh can tell.

Examples:
  dea converge hip.feb
  dea converge hip.feb --target 0.05 --law logarithmic
  dea converge hip.feb --max-springs 100000 --json convergence.json)";

}  // namespace

CLI::App* add_converge(CLI::App& app, ConvergeArguments& a) {
  CLI::App* c = add_model_command(app, "converge", "Find how many springs the result needs", kConvergeFooter, a);
  add_once(*c, "--target", a.target, "CHANGE", "Study", "Largest change allowed, between 0 and 1: 0.05 for 5% [0.01]");
  add_once(*c, "--max-springs", a.max_springs, "N", "Study", "Most springs per contact to try [400000]");
  add_once(*c, "--json", a.json, "FILE|-", "Output", "Also write JSON, \"-\" to standard output instead of the table");
  add_overwrite_flag(*c, a.overwrite);
  CLI::Option* q = add_quiet_flag(*c, a.quiet);
  c->add_flag("-v,--verbose", a.verbose, "Print a line per contact and division as it is solved")
      ->excludes(q)
      ->group("Output");
  add_solving_options(*c, a.settings, a.threads, {"refine", "squash", "inside"});
  return c;
}

int converge_command(const ConvergeArguments& a) {
  const double target = number_argument("target", a.target);
  if (!(target > 0 && target < 1)) throw wrong_word("target", a.target, "a number between 0 and 1");
  const int max_springs = count_argument("max-springs", a.max_springs, 1, 100000000);
  const auto threads = limit_threads(a.threads);
  Settings settings = effective_settings(a.settings);
  if (!settings.loads.file.empty() || !settings.motion.file.empty())
    throw UsageError(
        "converge: found a table of loads or motion, expected none: it divides the springs of the model's own "
        "last state");
  Progress progress(progress_style(a.quiet, a.verbose));
  progress.now("reading " + file_name(a.model), "", "reading " + file_name(a.model));
  JointModel model = read_feb(a.model);
  settle_units(model, settings);
  read_thickness(model, settings);
  const HeldOutputs held = claim_outputs(input_files(a, settings), {{"--json", a.json}});
  if (!a.overwrite) refuse_to_replace({{"--json", a.json}});

  double last = seconds();
  const auto watch = [&](const Activity& activity) {
    now_under_way(activity.stage == Activity::Stage::State ? UnderWay::Search : UnderWay::NothingToLose);
    show_activity(progress, activity);
  };
  const auto row = [&](const ConvergenceRow& r) {
    const double now = seconds();
    progress.step(
        fmt::format("{} springs solved", r.springs),
        fmt::format("{} springs: p99 {:.4g}, mean {:.4g}, area {:.4g}, peak {:.4g}, {}, {:.2f} s", r.springs,
                    r.headline.p99, r.headline.mean, r.headline.area, r.headline.peak, name(r.outcome), now - last),
        0, 0);
    last = now;
  };
  const std::vector<Convergence> studies = converge(model, settings, target, max_springs, row, watch, stop_flag());
  now_under_way(UnderWay::NothingToLose);
  progress.clear();
  if (!a.json.empty()) write_text(a.json, json_text(converge_json(model, settings, studies, target, max_springs)));
  if (!a.quiet && a.json != "-") print(converge_text(model, studies, max_springs));

  const bool reached = std::all_of(studies.begin(), studies.end(), [&](const Convergence& study) {
    const ConvergenceRow& last = study.rows.back();
    return solved(last.outcome) && last.changes_below(target);
  });
  if (!reached) log(fmt::format("warning: not all changes came below the target of {:g}%", 100.0 * target));
  return reached ? kSolved : kNoSolution;
}

}  // namespace dea

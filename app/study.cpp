// `dea study`: thousands of cases as one command, their results in one file.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "app/commands.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "app/study_reading.h"
#include "app/study_report.h"
#include "io/study/study_output.h"
#include "io/study/study_request.h"
#include "src/base/error.h"
#include "src/base/numbers.h"

namespace dea {

namespace {

constexpr const char* kStudyFooter = R"(
A factor is an option of dea run whose value differs from case to case. Its values are in braces:
  {-20:20:5}        from -20 to 20 by 5, both ends        {8|12|16}       these, numbers or words
  {uniform(8,16)}   {normal(12,2)}   {lognormal(2.5,0.2)} drawn by --sample; lognormal: mean and deviation of the logarithm
  {}                from the column of that name in --cases
The factor's name, before the colon, is a column of the results. Cases are all combinations of models and values, for each row
of --cases or point of --sample. Options act in the order in which they are given, also those of factors. All other options of
dea run hold for all cases. With --loads and --motion the rows are the states of each case.

To go on after a stop, give the same command again; --overwrite begins anew. FILE.db is a SQLite database: docs/studies.md says what is in it.

Examples:
  dea study hip.feb --vary "E: E={8|12|16}" --vary "tilt: rotate pelvis=0,1,0,{-10:10:5}" --states last -o plan.db
  dea study hip.feb --vary "tilt: rotate pelvis=0,1,0,{-20:20:5}" --dry-run
  dea study hip.feb --factor "stiffness: E={}" --factor "poisson: nu={}" --cases cases.csv --states last -o cases.db
  dea study hip.feb --vary "E: E={uniform(8,16)}" --sample sobol --count 4 --states last -o sample.db --csv -
  dea study plan.db --csv results.csv
  dea study plan.db --hdf5 results.h5
  dea study plan.db --report plan.html --group E
  dea study a.feb b.feb --states last -o hips.db
  dea study hips.db --report hips.html --subjects subjects.csv --group stage --pair stage)";

void add_case_options(CLI::App& c, StudyArguments& a) {
  const char* group = "Cases";
  add_repeated(
      c, "--vary", a.settings.values["vary"], "\"NAME: OPTION VALUE\"", group,
      "A factor: an option of dea run with {START:STOP:STEP}, {a|b|c} or a random spread as value; may be repeated");
  add_repeated(c, "--factor", a.settings.values["factor"], "\"NAME: OPTION VALUE\"", group,
               "The same; with {} the values come from --cases; may be repeated");
  add_once(c, "--cases", a.cases, "FILE", group,
           "Table (CSV), one case per row: columns are the names of factors, and \"model\" if it differs");
  add_once(c, "--sample", a.sample, "sobol|latin|saltelli", group,
           "How to draw the values of all factors with a random spread");
  add_once(c, "--count", a.count, "N", group, "Points to draw; saltelli makes N times (factors + 2) cases of them");
  add_once(c, "--seed", a.seed, "S", group, "The same seed draws the same points [1]");
  add_once(c, "--states", a.states, "all|last|t1,t2:t3,...", group, "States of every case, as in dea run [all]");
  add_once(c, "--again", a.again, "failed", group, "Solve those cases of the file again that have no solution");
  add_once(c, "--shard", a.shard, "I/N|auto", group,
           "Solve only the I-th of N parts, into FILE.I-of-N.db; auto: I and N from Slurm, Open MPI or PMI");
  c.add_flag("--dry-run", a.dry_run, "Count the cases, solve a few of them and say how long all will take")
      ->group(group);
}

}  // namespace

CLI::App* add_study(CLI::App& app, StudyArguments& a) {
  CLI::App* c = app.add_subcommand("study", "Solve thousands of cases (models and options) into one file");
  c->footer(kStudyFooter);
  c->add_option("FILE", a.files, "FEBio models, or a study's file (.db) to read")->type_name("");
  add_case_options(*c, a);
  add_once(*c, "-o", a.output, "FILE.db", "Output",
           "File of the study; results are added to it as they come; with --overwrite it begins anew");
  add_once(*c, "--csv", a.csv, "FILE|-", "Output", "Also write CSV, a line per case, state and contact");
  add_once(*c, "--hdf5", a.hdf5, "FILE.h5", "Output",
           "Also write HDF5 that netCDF's readers open: a variable per number, over case, state and contact");
  add_repeated(*c, "--keep", a.keep, "fields|xplt", "Output",
               "Also keep pressures at the nodes in the file, or a plot file per case in the folder FILE_xplt");
  c->add_flag("--merge", a.merge, "Join the files of shards into that of -o")->group("Output");
  add_overwrite_flag(*c, a.overwrite);
  add_findings_options(*c, a.findings);
  c->add_flag("-v,--verbose", a.verbose, "Print a line per case")->group("Output");
  add_study_report_options(*c, a);
  add_solving_options(*c, a.settings, a.threads);
  return c;
}

namespace {

/// All of the line but its shard and what is kept. Whatever can be wrong with it is found here, before anything is
/// solved. Throws UsageError, InputError.
Study study_of(const StudyArguments& a, Progress& progress) {
  StudyRequest request;
  request.models = a.files;
  request.options = in_their_order(a.settings);
  request.cases = a.cases;
  request.sample = a.sample;
  request.count = a.count;
  request.seed = a.seed;
  request.states = a.states;
  request.settings_file = a.settings.file;
  Study study = plan_study(request);
  if (!a.threads.empty()) study.options.workers = count_argument("threads", a.threads, 1, 1024);
  study.options.stop = stop_flag();
  const std::size_t models = study.plan.models.size();
  progress.now(models == 1 ? "reading the model" : fmt::format("reading {} models", models), "", "");
  take_digests(study);
  return study;
}

/// "tilt=-20, E=8", with the model where there are several.
std::string case_words(const Plan& plan, std::size_t index) {
  const PlannedCase& c = plan.cases[index];
  std::string text = plan.models.size() > 1 ? plan.models[at(c.model)] : "";
  for (std::size_t i = 0; i < plan.factors.size(); ++i)
    text += fmt::format("{}{}={}", text.empty() ? "" : ", ", plan.factors[i].name, c.values[i]);
  return text;
}

/// How far the cases have come, for Progress.
struct Tally {
  std::size_t total = 0;   ///< of the file
  std::size_t before = 0;  ///< were there
  std::size_t done = 0, todo = 0, failed = 0;
  double start = seconds();

  std::string words() const {
    const double rate = static_cast<double>(done) / std::max(1e-3, seconds() - start);
    return fmt::format("{} of {} cases{}{}", before + done, total, failed > 0 ? fmt::format(", {} failed", failed) : "",
                       done > 0 ? fmt::format(", {:.3g} per second", rate) : "");
  }
};

/// Solves what the file lacks. Stopped: what was done is in the file.
Tally solve(const Study& study, OpenStudy& open, Progress& progress) {
  Tally tally;
  tally.total = open.cases.last - open.cases.first;
  tally.todo = open.todo.size();
  tally.before = tally.total - tally.todo;
  progress.now(tally.words(), "", "", 0, tally.todo);
  now_under_way(UnderWay::Cases);
  solve_study(study, open, [&](const CaseEnd& end) {
    ++tally.done;
    if (end.outcome != CaseResult::Outcome::Solved) ++tally.failed;
    const std::string details =
        fmt::format("case {}: {}, {}, {:.2f} s{}{}", end.number, name(end.outcome),
                    case_words(study.plan, end.number - 1), end.seconds, end.message.empty() ? "" : ": ", end.message);
    progress.step(tally.words(), details, tally.done, tally.todo);
  });
  return tally;
}

int solve_study(const StudyArguments& a) {
  check_study_name("-o", a.output);
  StudyOutput output;
  output.path = a.output;
  output.keep = a.keep;
  output.again = !a.again.empty();
  if (output.again && lower_case(a.again) != "failed") throw wrong_word("again", a.again, "failed", {"failed"});
  output.shard = shard_of(a.shard);
  output.overwrite = a.overwrite;
  output.remedy = "--overwrite begins anew, -o FILE.db makes another";
  check_columns(a);
  study_page_options(a);  // what is wrong with them, before anything is solved
  output.others = written_beside(a);
  if (!a.overwrite) refuse_to_replace(output.others, "replaces it and begins " + a.output + " anew");
  Progress progress(progress_style(quiet_altogether(a.findings), a.verbose));
  Study study = study_of(a, progress);
  check_study_columns(a, study.plan);
  if (!a.subjects.empty()) study.inputs.push_back({"the table of subjects", a.subjects});
  OpenStudy open = open_study(study, output);
  if (open.todo.empty()) {
    progress.clear();
    return end_study(
        read_study_head(open.path), a,
        fmt::format("{}: all {} are there already", open.path, plural(open.cases.last - open.cases.first, "case")));
  }
  const Tally tally = solve(study, open, progress);
  progress.clear();
  now_under_way(UnderWay::Writing);
  const double took = seconds() - tally.start;
  return end_study(read_study_head(open.path), a,
                   fmt::format("{}: {} in {:.2f} s, {:.3g} per second{}", open.path, plural(tally.done, "case"), took,
                               static_cast<double>(tally.done) / std::max(1e-3, took),
                               tally.before > 0 ? fmt::format("; {} {} there already", tally.before,
                                                              tally.before == 1 ? "was" : "were")
                                                : ""));
}

/// A few cases from first to last, in pairs of neighbours: the second of a pair finds the work on its joint done, as
/// most do.
std::vector<std::size_t> a_few(std::size_t count) {
  std::set<std::size_t> few;
  for (const std::size_t i : {std::size_t{0}, count / 2, count - 1}) {
    few.insert(i > 0 ? i - 1 : std::min(i + 1, count - 1));
    few.insert(i);
  }
  return {few.begin(), few.end()};
}

int dry_run(const StudyArguments& a) {
  Progress progress(progress_style(quiet_altogether(a.findings), a.verbose));
  const Study study = study_of(a, progress);
  const Plan& plan = study.plan;
  std::string text = fmt::format("{}: {}", plural(plan.cases.size(), "case"), plural(plan.models.size(), "model"));
  for (const Factor& f : plan.factors)
    text +=
        fmt::format(", {} {}", f.name, f.values.empty() ? "from a table or sample" : plural(f.values.size(), "value"));
  const std::vector<std::size_t> few = a_few(plan.cases.size());
  StudyOptions options = study.options;
  options.workers = 1;
  std::vector<double> times;
  std::vector<std::string> codes;  // of warnings
  std::string failed;
  options.done = [&](CaseResult&& result) {
    times.push_back(result.seconds);
    for (const std::string& code : codes_of(result.warnings)) codes.push_back(code);
    if (result.outcome != CaseResult::Outcome::Solved && failed.empty())
      failed = fmt::format("case {}: {}: {}", result.number, case_words(plan, result.number - 1), result.message);
    progress.step("solving a few", "", times.size(), few.size());
  };
  now_under_way(UnderWay::Search);
  run_study(plan, few, options);
  progress.clear();
  std::sort(times.begin(), times.end());
  const double each = times[times.size() / 2];
  const Shard shard = shard_of(a.shard);
  const double all = each * static_cast<double>(plan.cases.size()) / study.options.workers / shard.of;
  print(fmt::format("{}\nabout {:.2g} s each (median of {}), {} with {}{}\n", text, each, times.size(), duration(all),
                    plural(static_cast<std::size_t>(study.options.workers), "thread"),
                    shard.of > 1 ? fmt::format(" for each of {} shards", shard.of) : ""));
  if (!failed.empty()) log("no solution: " + failed);
  const bool refused = refused_codes(codes, a.findings);
  return failed.empty() && !refused ? kSolved : kNoSolution;
}

}  // namespace

int study(const StudyArguments& a) {
  check_codes(a.findings, a.verbose);
  check_warning_codes(a.findings);
  if (a.merge) return merge_shards(a);
  for (const std::string& file : a.files)
    if (extension_of(file) == ".db" || is_database(file)) return read_study(a, file);
  return a.dry_run ? dry_run(a) : solve_study(a);
}

}  // namespace dea

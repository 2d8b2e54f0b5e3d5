// `dea study`: thousands of cases as one command, their results in one file.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include <febiodea/app/commands.h>
#include <febiodea/app/interrupt.h>
#include <febiodea/app/progress.h>
#include <febiodea/app/study_plan.h>
#include <febiodea/base/error.h>
#include <febiodea/base/numbers.h>
#include <febiodea/io/files/held_outputs.h>
#include <febiodea/io/files/output.h>
#include <febiodea/io/study/read_study.h>
#include <febiodea/io/study/study_file.h>
#include <febiodea/views/data/csv.h>
#include <febiodea/views/run_study.h>

namespace dea {

namespace fs = std::filesystem;

namespace {

constexpr const char* kStudyFooter = R"(
A factor is an option of dea run that differs from case to case, with its values in braces:
  {-20:20:5}        from -20 to 20 by 5, both ends        {8|12|16}       these, numbers or words
  {uniform(8,16)}   {normal(12,2)}   {lognormal(2.5,0.2)} drawn by --sample; lognormal: of the logarithm
  {}                from the column of its name in --cases
Its name, before the colon, is a column of results. Cases are all combinations of models and values, with each row of --cases
or point of --sample. Options act in the order of the line, a factor's where it stands. All other options of dea run hold for
all cases; rows of --loads and --motion are a case's states.

The same command again goes on where it stopped. FILE.db is a SQLite database: docs/studies.md says what is in it.

Examples:
  dea study hip.feb --vary "stiffness: E={8|12|16}" --vary "tilt: rotate pelvis=0,1,0,{-10:10:5}" --states last -o plan.db
  dea study hip.feb --vary "tilt: rotate pelvis=0,1,0,{-20:20:5}" --dry-run
  dea study hip.feb --factor "stiffness: E={}" --factor "poisson: nu={}" --cases cases.csv --states last -o cases.db
  dea study hip.feb --vary "E: E={uniform(8,16)}" --sample sobol --count 4 --states last -o sample.db --csv -
  dea study plan.db --csv results.csv)";

void add_case_options(CLI::App& c, StudyArguments& a) {
  const char* group = "Cases";
  add_repeated(c, "--vary", a.settings.values["vary"], "\"NAME: OPTION VALUE\"", group,
               "An option of dea run with {START:STOP:STEP}, {a|b|c} or a spread in its value; may be repeated");
  add_repeated(c, "--factor", a.settings.values["factor"], "\"NAME: OPTION VALUE\"", group,
               "The same; with {} the values come from --cases; may be repeated");
  add_once(c, "--cases", a.cases, "FILE", group,
           "Table with a row a case: CSV, columns are the names of factors, and \"model\" if it differs");
  add_once(c, "--sample", a.sample, "sobol|latin|saltelli", group, "Draw the values of all factors with a spread");
  add_once(c, "--count", a.count, "N", group, "Points to draw; saltelli makes N times (factors + 2) cases of them");
  add_once(c, "--seed", a.seed, "S", group, "The same seed draws the same points [1]");
  add_once(c, "--states", a.states, "all|last|t1,t2:t3,...", group, "States of every case, as dea run has it [all]");
  add_once(c, "--again", a.again, "failed", group, "Solve cases of the file that are no solution again");
  add_once(c, "--shard", a.shard, "I/N|auto", group,
           "Only the I-th of N parts, into FILE.I-of-N.db; auto: as Slurm, Open MPI or PMI say");
  c.add_flag("--dry-run", a.dry_run, "Count the cases, solve a few of them and tell how long all take")->group(group);
}

}  // namespace

CLI::App* add_study(CLI::App& app, StudyArguments& a) {
  CLI::App* c = app.add_subcommand("study", "Solve thousands of cases of models and options into one file");
  c->footer(kStudyFooter);
  c->add_option("FILE", a.files, "FEBio models, or a study's file to be read")->type_name("");
  add_case_options(*c, a);
  add_once(*c, "-o", a.output, "FILE.db", "Output", "The study's results; they are added to it as they come");
  add_once(*c, "--csv", a.csv, "FILE|-", "Output", "Also write CSV, a line per case, state and contact");
  add_repeated(*c, "--keep", a.keep, "fields|xplt", "Output",
               "Also keep pressures at the nodes in the file, or a plot file per case in the folder FILE_xplt");
  c->add_flag("--merge", a.merge, "Join the files of shards in the one of -o")->group("Output");
  c->add_flag("--overwrite", a.overwrite, "Begin anew where there is a file already [go on with it]")->group("Output");
  CLI::Option* q = add_quiet_flag(*c, a.quiet);
  c->add_flag("-v,--verbose", a.verbose, "Print a line per case")->excludes(q)->group("Output");
  add_solving_options(*c, a.settings, a.threads);
  return c;
}

namespace {

void check_study_name(const std::string& path) {
  if (path.empty()) throw UsageError("found no -o, expected the study's file: -o FILE.db");
  if (path == "-") throw UsageError("-o -: a study cannot go to standard output, give it a name");
  const std::string extension = extension_of(path);
  if (extension == ".feb" || extension == ".xplt" || extension == ".csv")
    throw UsageError(fmt::format("-o {}: found the ending of another kind of file, expected .db", path));
}

void remove_study(const std::string& path) {
  std::error_code error;
  for (const char* end : {"", "-journal"}) fs::remove(path + end, error);
  if (fs::exists(path)) throw WriteError(fmt::format("{}: cannot be taken away", path));
}

/// A file that is there is the same study's, or InputError. One of another study of which every case was refused, as
/// where a name was misspelt, is taken away: nothing is lost.
void check_existing(const std::string& path, const Study& study) {
  constexpr const char* kRemedy = "--overwrite begins anew, -o FILE.db makes another";
  if (!has_content(path)) return;
  std::string difference;
  try {
    const StudyHead head = read_study_head(path);
    difference = study_difference(head, study.identity);
    if (difference.empty() && head.planned != study.plan.cases.size())
      difference = fmt::format("it has {} cases, not {}", head.planned, study.plan.cases.size());
  } catch (const InputError& bad) {
    throw InputError(fmt::format("{}; {}", bad.what(), kRemedy));
  }
  if (difference.empty()) return;
  const StudyCounts counts = count_cases(path);
  if (counts.solved + counts.failed > 0) throw InputError(fmt::format("{}: {}; {}", path, difference, kRemedy));
  remove_study(path);
}

std::string plot_folder(const std::string& path) {
  const fs::path p = path;
  return (p.parent_path() / (p.stem().string() + "_xplt")).string();
}

void take_keep(const StudyArguments& a, const std::string& path, StudyOptions& options) {
  for (const std::string& keep : a.keep) {
    if (keep == "fields")
      options.keep_fields = true;
    else if (keep == "xplt")
      options.plot_folder = plot_folder(path);
    else
      throw wrong_word("keep", keep, "fields or xplt", {"fields", "xplt"});
  }
}

void write_csv(const std::string& study, const std::string& path) {
  write_pieces(path, [&](const std::function<void(const std::string&)>& put) {
    std::string text;
    read_results(study, [&](const std::vector<std::string>& cells) {
      for (std::size_t i = 0; i < cells.size(); ++i) text += (i > 0 ? "," : "") + csv_word(cells[i]);
      text += '\n';
      if (text.size() < (1 << 20)) return;
      put(text);
      text.clear();
    });
    put(text);
  });
}

// ------------------------------------------------------------------------------------------------ solving

/// "tilt=-20, E=8", with the model where there are several.
std::string case_words(const Plan& plan, std::size_t index) {
  const PlannedCase& c = plan.cases[index];
  std::string text = plan.models.size() > 1 ? plan.models[at(c.model)] : "";
  for (std::size_t i = 0; i < plan.factors.size(); ++i)
    text += fmt::format("{}{}={}", text.empty() ? "" : ", ", plan.factors[i].name, c.values[i]);
  return text;
}

std::string plural(std::size_t n, const char* word) { return fmt::format("{} {}{}", n, word, n == 1 ? "" : "s"); }

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

/// Indices of the cases that are to be solved.
std::vector<std::size_t> cases_to_solve(const std::vector<CaseThere>& there, const ShardCases& shard, bool again) {
  std::vector<std::size_t> todo;
  for (std::size_t i = shard.first; i < shard.last; ++i)
    if (there[i] == CaseThere::Missing || (again && there[i] != CaseThere::Solved)) todo.push_back(i);
  return todo;
}

/// Solves what the file lacks. Stopped: what was done is in the file.
Tally solve(const Study& study, const std::vector<std::size_t>& todo, const ShardCases& shard, StudyWriter& writer,
            Progress& progress) {
  Tally tally;
  tally.total = shard.last - shard.first;
  tally.todo = todo.size();
  tally.before = tally.total - todo.size();
  StudyOptions options = study.options;
  options.done = [&](CaseResult&& result) {
    ++tally.done;
    if (result.outcome != CaseResult::Outcome::Solved) ++tally.failed;
    const std::string details = fmt::format("case {}: {}, {}, {:.2f} s{}{}", result.number, name(result.outcome),
                                            case_words(study.plan, result.number - 1), result.seconds,
                                            result.message.empty() ? "" : ": ", result.message);
    writer.add(std::move(result));
    progress.step(tally.words(), details, tally.done, tally.todo);
  };
  progress.now(tally.words(), "", "", 0, tally.todo);
  now_under_way(UnderWay::Cases);
  try {
    run_study(study.plan, todo, options);
  } catch (const Stopped&) {
    writer.finish();
    throw;
  }
  writer.finish();
  return tally;
}

/// The last line where cases are no solution; empty: all are.
std::string failed_line(const std::string& path, const StudyHead& head) {
  const StudyCounts counts = count_cases(path);
  if (counts.failed + counts.refused == 0) return "";
  const StudyCase first = read_cases(path, true, 1).front();
  std::string words = head.models.size() > 1 ? head.models[at(first.model)] + ", " : "";
  for (std::size_t i = 0; i < head.factors.size(); ++i)
    words += fmt::format("{}={}, ", head.factors[i].name, first.values[i]);
  return fmt::format(
      "{}: {} of {} no solution ({} failed, {} refused), first case {}: {}{}; --again failed solves them "
      "again",
      path, counts.failed + counts.refused, plural(counts.all(), "case"), counts.failed, counts.refused, first.number,
      words, first.message);
}

/// What is told at the end, and the exit code.
int end(const std::string& path, const StudyArguments& a, const std::string& summary) {
  const StudyHead head = read_study_head(path);
  if (!a.csv.empty()) write_csv(path, a.csv);
  if (!a.quiet) log(summary);
  const std::string failed = failed_line(path, head);
  if (!failed.empty()) log(failed);
  return failed.empty() ? kSolved : kNoSolution;
}

bool again_failed(const StudyArguments& a) {
  if (a.again.empty()) return false;
  if (lower_case(a.again) != "failed") throw wrong_word("again", a.again, "failed", {"failed"});
  return true;
}

int solve_study(const StudyArguments& a) {
  check_study_name(a.output);
  const bool again = again_failed(a);
  const Shard shard = shard_of(a.shard);
  const std::string path = shard_path(a.output, shard);
  Progress progress(progress_style(a.quiet, a.verbose));
  Study study = study_of(a, progress);
  study.identity.shard = shard.number;
  study.identity.shards = shard.of;
  take_keep(a, path, study.options);
  std::vector<NamedPath> outputs = {{"-o", path}};
  if (!a.csv.empty()) outputs.push_back({"--csv", a.csv});
  if (!study.options.plot_folder.empty()) outputs.push_back({"--keep xplt", study.options.plot_folder, true});
  const HeldOutputs held = claim_outputs(study.inputs, outputs);
  if (a.overwrite)
    remove_study(path);
  else
    check_existing(path, study);
  if (!study.options.plot_folder.empty()) fs::create_directories(study.options.plot_folder);
  StudyWriter writer(path, study.plan, study.identity);
  const ShardCases cases = shard_cases(study.plan.cases.size(), shard.number, shard.of);
  const std::vector<std::size_t> todo = cases_to_solve(writer.there(), cases, again);
  if (todo.empty()) {
    progress.clear();
    return end(path, a, fmt::format("{}: all {} are there already", path, plural(cases.last - cases.first, "case")));
  }
  const Tally tally = solve(study, todo, cases, writer, progress);
  progress.clear();
  now_under_way(UnderWay::Writing);
  const double took = seconds() - tally.start;
  return end(path, a,
             fmt::format("{}: {} in {:.2f} s, {:.3g} per second{}", path, plural(tally.done, "case"), took,
                         static_cast<double>(tally.done) / std::max(1e-3, took),
                         tally.before > 0 ? fmt::format("; {} were there", tally.before) : ""));
}

// ------------------------------------------------------------------------------------------------ without solving all

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
  Progress progress(progress_style(a.quiet, a.verbose));
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
  std::string failed;
  options.done = [&](CaseResult&& result) {
    times.push_back(result.seconds);
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
  return failed.empty() ? kSolved : kNoSolution;
}

/// Options that have no place where nothing is solved.
void refuse_solving_options(const StudyArguments& a, const char* what) {
  std::string option;
  if (!a.settings.order.empty()) option = "--" + a.settings.order.front();
  for (const auto& [name, text] :
       {std::pair("--cases", &a.cases), std::pair("--sample", &a.sample), std::pair("--count", &a.count),
        std::pair("--seed", &a.seed), std::pair("--states", &a.states), std::pair("--again", &a.again),
        std::pair("--shard", &a.shard), std::pair("--settings", &a.settings.file)})
    if (!text->empty()) option = name;
  if (!a.keep.empty()) option = "--keep";
  if (a.dry_run) option = "--dry-run";
  if (!option.empty()) throw UsageError(fmt::format("found {} beside {}, expected models with it", option, what));
}

std::string study_text(const StudyHead& head, const StudyCounts& counts) {
  const ShardCases shard = shard_cases(head.planned, head.identity.shard, head.identity.shards);
  std::string text = fmt::format("{}: {} of {}: {} solved, {} failed, {} refused; made by dea {}\n", head.path,
                                 counts.all(), plural(shard.last - shard.first, "case"), counts.solved, counts.failed,
                                 counts.refused, head.identity.version);
  if (head.identity.shards > 1)
    text += fmt::format("shard {} of {} of {} cases\n", head.identity.shard, head.identity.shards, head.planned);
  constexpr std::size_t kMost = 8;
  for (std::size_t i = 0; i < std::min(kMost, head.models.size()); ++i) text += "model " + head.models[i] + "\n";
  if (head.models.size() > kMost) text += fmt::format("and {} more models\n", head.models.size() - kMost);
  for (const std::string& option : head.identity.options) text += "with " + option + "\n";
  return text;
}

int read_study(const StudyArguments& a, const std::string& path) {
  if (a.files.size() > 1)
    throw UsageError(fmt::format("{}: found a study beside other files, expected it alone, or --merge", path));
  if (!a.output.empty())
    throw UsageError(fmt::format("-o {}: found it beside a study that is read, expected --csv", a.output));
  refuse_solving_options(a, "a study that is read");
  const StudyHead head = read_study_head(path);
  std::vector<NamedPath> outputs;
  if (!a.csv.empty()) outputs.push_back({"--csv", a.csv});
  const HeldOutputs held = claim_outputs({{"the study", path}}, outputs);
  if (!a.csv.empty())
    write_csv(path, a.csv);
  else
    print(study_text(head, count_cases(path)));
  const std::string failed = failed_line(path, head);
  if (!failed.empty()) log(failed);
  return failed.empty() ? kSolved : kNoSolution;
}

int merge(const StudyArguments& a) {
  refuse_solving_options(a, "--merge");
  if (a.files.empty()) throw UsageError("--merge: found no file, expected those of the shards");
  check_study_name(a.output);
  std::vector<NamedPath> inputs, outputs = {{"-o", a.output}};
  for (const std::string& file : a.files) inputs.push_back({"a shard", file});
  if (!a.csv.empty()) outputs.push_back({"--csv", a.csv});
  const HeldOutputs held = claim_outputs(inputs, outputs);
  if (has_content(a.output) && !a.overwrite)
    throw WriteError(fmt::format("{}: is there already; --overwrite replaces it, -o FILE.db makes another", a.output));
  for (const std::string& file : a.files) read_study_head(file);
  remove_study(a.output);
  const MergedStudies merged = merge_studies(a.files, a.output);
  const int code = end(
      a.output, a, fmt::format("{}: {} of {}", a.output, plural(merged.cases, "case"), plural(a.files.size(), "file")));
  if (merged.missing.empty()) return code;
  log(fmt::format("{}: missing are {}cases {}; the command of the study without --shard, with -o {}, solves them",
                  a.output, merged.missing_shards.empty() ? "" : fmt::format("shards {}, ", merged.missing_shards),
                  merged.missing, a.output));
  return kNoSolution;
}

}  // namespace

int study(const StudyArguments& a) {
  if (a.merge) return merge(a);
  for (const std::string& file : a.files)
    if (extension_of(file) == ".db" || is_database(file)) return read_study(a, file);
  return a.dry_run ? dry_run(a) : solve_study(a);
}

}  // namespace dea

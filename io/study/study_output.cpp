#include "io/study/study_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <utility>

#include "io/study/read_study.h"
#include "src/base/error.h"
#include "src/base/parse.h"
#include "src/base/say.h"

namespace dea {

namespace fs = std::filesystem;

namespace {

/// A whole number that the environment has; -1: none.
int environment_number(const char* name) {
  const char* text = std::getenv(name);
  try {
    return text == nullptr ? -1 : parse_count(text, 0, std::numeric_limits<int>::max());
  } catch (const BadValue& bad) {
    throw UsageError(Fault{.given = said("shard", "auto"), .found = fmt::format("{}: {}", name, bad.what())});
  }
}

/// One task among several; none of these variables: {1, 1}.
Shard task_of_environment() {
  // SLURM_PROCID is there outside of srun too; the number of tasks of a step is not
  for (const auto& [rank, size] :
       {std::pair("SLURM_PROCID", "SLURM_STEP_NUM_TASKS"), std::pair("OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"),
        std::pair("PMI_RANK", "PMI_SIZE")}) {
    const int i = environment_number(rank), n = environment_number(size);
    if (i >= 0 && n > 1 && i < n) return {i + 1, n, true};
  }
  return {};
}

Shard automatic_shard() {
  const Shard task = task_of_environment();
  const int id = environment_number("SLURM_ARRAY_TASK_ID"), first = environment_number("SLURM_ARRAY_TASK_MIN"),
            last = environment_number("SLURM_ARRAY_TASK_MAX"), given = environment_number("SLURM_ARRAY_TASK_STEP"),
            step = std::max(1, given);
  if (id < 0 && task.of == 1)
    throw UsageError(Fault{.given = said("shard", "auto"),
                           .found = "found none of SLURM_ARRAY_TASK_ID, SLURM_PROCID with SLURM_STEP_NUM_TASKS (srun), "
                                    "OMPI_COMM_WORLD_RANK, PMI_RANK with their sizes,",
                           .expected = say("expected {}", NamedSetting{"shard", "", "I/N"})});
  if (id < 0) return task;
  const int count = environment_number("SLURM_ARRAY_TASK_COUNT"), place = (id - std::max(0, first)) / step;
  // A task that is submitted again by itself is an array of one, which would be the whole study.
  const bool alone = count == 1 && id > 1;
  if (first < 0 || last < id || id < first || (id - first) % step != 0 || count != (last - first) / step + 1 || alone)
    throw UsageError(Fault{
        .given = said("shard", "auto"),
        .found = fmt::format("found task {} of Slurm's array of {} from {} to {},", id, count, first, last),
        .expected = say("expected an array without gaps, or the shard itself: {}", NamedSetting{"shard", "", "I/N"})});
  return {place * task.of + task.number, count * task.of, true};
}

/// M of a file named as shard N of M of `path` would be, as NAME.N-of-M.EXTENSION; empty: it is none.
std::string division_in(const std::string& file, const fs::path& path) {
  const std::string before = path.stem().string() + ".", after = path.extension().string(), between = "-of-";
  if (file.size() < before.size() + after.size() || !file.starts_with(before) || !file.ends_with(after)) return "";
  const std::string numbers = file.substr(before.size(), file.size() - before.size() - after.size());
  const std::size_t at = numbers.find(between);
  if (at == numbers.npos) return "";
  const auto digits = [](const std::string& text) {
    return !text.empty() && text.find_first_not_of("0123456789") == text.npos;
  };
  const std::string number = numbers.substr(0, at), of = numbers.substr(at + between.size());
  return digits(number) && digits(of) ? of : "";
}

/// Beside `path` are shards of another number of parts alone: part of an array was submitted again, and would be
/// divided as if it were all. Throws UsageError; a shard that was said is left alone.
void refuse_other_division(const std::string& path, const Shard& shard) {
  if (!shard.automatic) return;
  const fs::path p = path, folder = p.has_parent_path() ? p.parent_path() : fs::path(".");
  std::error_code error;
  std::string found, division;
  for (const fs::directory_entry& file : fs::directory_iterator(folder, error)) {
    const std::string there = file.path().filename().string();
    const std::string of = division_in(there, p);
    if (of.empty()) continue;
    if (of == std::to_string(shard.of)) return;
    if (found.empty() || there < found) {
      found = there;
      division = of;
    }
  }
  if (!found.empty())
    throw UsageError(
        Fault{.given = said("shard", "auto"),
              .found = fmt::format("found {}, one of {} shards, where this is one of {},", found, division, shard.of),
              .expected = say("expected the shard of that division: {}, or another name",
                              NamedSetting{"shard", "", "I/" + division})});
}

/// "plan.db" as "plan.2-of-4.db".
std::string shard_path(const std::string& path, const Shard& shard) {
  if (shard.of == 1) return path;
  const fs::path p = path;
  return (p.parent_path() /
          fmt::format("{}.{}-of-{}{}", p.stem().string(), shard.number, shard.of, p.extension().string()))
      .string();
}

std::string plot_folder(const std::string& path) {
  const fs::path p = path;
  return (p.parent_path() / (p.stem().string() + "_xplt")).string();
}

/// Throws WriteError if it cannot be taken away.
void remove_study(const std::string& path) {
  std::error_code error;
  for (const char* end : {"", "-journal"}) fs::remove(path + end, error);
  for (const fs::directory_entry& plot : fs::directory_iterator(plot_folder(path), error)) {
    const std::string stem = plot.path().stem().string();
    if (plot.path().extension() == ".xplt" && stem.find_first_not_of("0123456789") == stem.npos)
      fs::remove(plot.path(), error);
  }
  if (fs::exists(path)) throw WriteError(fmt::format("{}: cannot be taken away", path));
}

/// A file that is there is the same study's, or InputError. One of another study of which every case was refused, as
/// where a name was misspelt, is taken away: nothing is lost.
void check_existing(const std::string& path, const Plan& plan, const StudyIdentity& identity,
                    const std::string& remedy) {
  if (!has_content(path)) return;
  std::string difference;
  try {
    const StudyHead head = read_study_head(path);
    difference = study_difference(head, identity);
    if (difference.empty() && head.planned != plan.cases.size())
      difference = fmt::format("it has {} cases, not {}", head.planned, plan.cases.size());
  } catch (const StudyBusy&) {
    throw;
  } catch (const InputError& bad) {
    throw InputError(fmt::format("{}; {}", bad.what(), remedy));
  }
  if (difference.empty()) return;
  const StudyCounts counts = count_cases(path);
  if (counts.solved + counts.failed > 0) throw InputError(fmt::format("{}: {}; {}", path, difference, remedy));
  remove_study(path);
}

void take_keep(const std::vector<std::string>& keep, const std::string& path, StudyOptions& options) {
  for (const std::string& word : keep) {
    if (word == "fields")
      options.keep_fields = true;
    else if (word == "xplt")
      options.plot_folder = plot_folder(path);
    else
      parsed("keep", word, [](const std::string& text) -> int {
        throw bad_value(text, "fields or xplt", {"fields", "xplt"});
      });
  }
}

struct InputChanged : InputError {
  using InputError::InputError;
};

/// To be called while cases are solved: notices that a file that they are made of is written. The study outlives it.
std::function<void()> input_watch(const StudyIdentity& identity) {
  const auto states = [&identity] {
    std::vector<std::pair<std::uintmax_t, fs::file_time_type>> all;
    std::error_code error;
    for (const auto& input : identity.inputs)
      all.push_back({fs::file_size(input[0], error), fs::last_write_time(input[0], error)});
    return all;
  };
  return [&identity, states, as_read = states()] {
    const auto now = states();
    for (std::size_t i = 0; i < now.size(); ++i)
      if (now[i] != as_read[i])
        throw InputChanged(fmt::format(
            "{}: found it changed while the study was solved, expected the same file to the end; cases that were "
            "written before are kept, those since are not",
            identity.inputs[i][0]));
  };
}

}  // namespace

Shard shard_of(const std::string& text) {
  if (text.empty()) return {};
  if (lower_case(text) == "auto") return automatic_shard();
  const std::size_t slash = text.find('/');
  return parsed("shard", text, [&](const std::string&) {
    if (slash == text.npos) throw bad_value(text, "I/N, such as 2/4, or auto", {"auto"});
    const int of = parse_count(text.substr(slash + 1), 1, 1'000'000);
    return Shard{parse_count(text.substr(0, slash), 1, of), of};
  });
}

void check_study_name(const std::string& option, const std::string& path) {
  if (path.empty()) throw UsageError(fmt::format("found no {0}, expected the study's file: {0} FILE.db", option));
  if (path == "-") throw UsageError(fmt::format("{} -: a study cannot go to standard output, give it a name", option));
  const std::string extension = extension_of(path);
  if (extension == ".feb" || extension == ".xplt" || extension == ".csv")
    throw UsageError(fmt::format("{} {}: found the ending of another kind of file, expected .db", option, path));
}

OpenStudy open_study(const Study& study, const StudyOutput& output) {
  check_study_name(output.option, output.path);
  if (!output.overwrite) refuse_other_division(output.path, output.shard);
  OpenStudy open;
  open.path = shard_path(output.path, output.shard);
  open.options = study.options;
  take_keep(output.keep, open.path, open.options);
  StudyIdentity identity = study.identity;
  identity.shard = output.shard.number;
  identity.shards = output.shard.of;
  for (const std::string& keep : output.keep) identity.options.push_back("--keep " + keep);
  std::vector<NamedPath> outputs = output.others;
  outputs.insert(outputs.begin(), {output.option, open.path});
  if (!open.options.plot_folder.empty()) outputs.push_back({"--keep xplt", open.options.plot_folder, true});
  open.held = std::make_unique<HeldOutputs>(claim_outputs(study.inputs, outputs));
  if (output.overwrite)
    remove_study(open.path);
  else
    check_existing(open.path, study.plan, identity, output.remedy);
  if (!open.options.plot_folder.empty()) fs::create_directories(open.options.plot_folder);
  try {
    open.writer = std::make_unique<StudyWriter>(open.path, study.plan, identity);
  } catch (const DatabaseBusy& busy) {
    throw StudyBusy(busy.what());
  }
  open.cases = shard_cases(study.plan.cases.size(), output.shard.number, output.shard.of);
  const CasesThere& there = open.writer->there();
  for (std::size_t i = open.cases.first; i < open.cases.last; ++i)
    if (!there[i] || (output.again && there[i] != CaseResult::Outcome::Solved)) open.todo.push_back(i);
  return open;
}

void solve_study(const Study& study, OpenStudy& open, const std::function<void(const CaseEnd&)>& on_case) {
  StudyOptions options = open.options;
  options.done = [&](CaseResult&& result) {
    const CaseEnd end{result.number, result.outcome, result.message, result.seconds};
    open.writer->add(std::move(result));
    on_case(end);
  };
  open.writer->before_writing = input_watch(study.identity);
  try {
    run_study(study.plan, open.todo, options);
  } catch (const InputChanged&) {
    throw;
  } catch (...) {
    open.writer->finish();
    throw;
  }
  open.writer->finish();
}

}  // namespace dea

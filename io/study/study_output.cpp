#include "io/study/study_output.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "io/study/read_study.h"
#include "src/base/error.h"
#include "src/base/parse.h"

namespace dea {

namespace fs = std::filesystem;

namespace {

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

std::string plot_folder(const std::string& path) {
  const fs::path p = path;
  return (p.parent_path() / (p.stem().string() + "_xplt")).string();
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

/// Notices that a file that the cases are made of is written while they are solved.
class InputWatch {
 public:
  explicit InputWatch(const StudyIdentity& identity) : identity_(identity) {
    for (const auto& input : identity.inputs) as_read_.push_back(state_of(input[0]));
  }
  void check() const {
    for (std::size_t i = 0; i < as_read_.size(); ++i)
      if (state_of(identity_.inputs[i][0]) != as_read_[i])
        throw InputChanged(fmt::format(
            "{}: found it changed while the study was solved, expected the same file to the end; cases that were "
            "written before are kept, those since are not",
            identity_.inputs[i][0]));
  }

 private:
  using State = std::pair<std::uintmax_t, fs::file_time_type>;
  static State state_of(const std::string& path) {
    std::error_code error;
    return {fs::file_size(path, error), fs::last_write_time(path, error)};
  }
  const StudyIdentity& identity_;
  std::vector<State> as_read_;
};

}  // namespace

void check_study_name(const std::string& option, const std::string& path) {
  if (path.empty()) throw UsageError(fmt::format("found no {0}, expected the study's file: {0} FILE.db", option));
  if (path == "-") throw UsageError(fmt::format("{} -: a study cannot go to standard output, give it a name", option));
  const std::string extension = extension_of(path);
  if (extension == ".feb" || extension == ".xplt" || extension == ".csv")
    throw UsageError(fmt::format("{} {}: found the ending of another kind of file, expected .db", option, path));
}

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
  const InputWatch inputs(study.identity);
  open.writer->before_writing = [&inputs] { inputs.check(); };
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

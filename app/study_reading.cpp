// `dea study` where nothing is solved: a study's file read, shards joined.
#include <fmt/format.h>

#include <algorithm>

#include "app/commands.h"
#include "app/study_reading.h"
#include "app/study_report.h"
#include "io/study/study_columns.h"
#include "io/study/study_file.h"
#include "io/study/study_output.h"
#include "src/base/error.h"
#include "src/base/numbers.h"
#include "views/data/csv.h"

namespace dea {

namespace {

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

/// The last line where cases are no solution; empty: all are.
std::string failed_line(const StudyHead& head) {
  const std::string& path = head.path;
  const StudyCounts counts = count_cases(path);
  if (counts.failed + counts.refused == 0) return "";
  const std::optional<StudyCase> first = first_failed(path);
  if (!first) return "";  // solved again since
  std::string words = head.models.size() > 1 ? head.models[at(first->model)] + ", " : "";
  for (std::size_t i = 0; i < head.factors.size(); ++i)
    words += fmt::format("{}={}, ", head.factors[i].name, first->values[i]);
  return fmt::format(
      "{}: {} of {} no solution ({} failed, {} refused), first case {}: {}{}; --again failed solves them "
      "again",
      path, counts.failed + counts.refused, plural(counts.all(), "case"), counts.failed, counts.refused, first->number,
      words, first->message);
}

/// "shard 2", "cases 4-6".
std::string numbered(const char* word, const std::string& numbers) {
  return fmt::format("{}{} {}", word, numbers.find_first_of(",-") == std::string::npos ? "" : "s", numbers);
}

/// How many cases have warnings that are not to be quiet, and one of them; empty: none has.
std::string warned_line(const std::string& path, const std::vector<std::string>& quiet) {
  const StudyWarned warned = count_warned(path, quiet);
  if (warned.cases == 0) return "";
  return fmt::format("{}: {} of {} with warnings, such as case {}: {}", path, warned.cases,
                     plural(count_cases(path).all(), "case"), warned.first, warned.text);
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

}  // namespace

std::string plural(std::size_t n, const char* word) { return fmt::format("{} {}{}", n, word, n == 1 ? "" : "s"); }

void check_columns(const StudyArguments& a) {
  if (a.hdf5.empty()) return;
  check_columns_possible();
  if (a.hdf5 == "-") throw UsageError("--hdf5 -: cannot go to standard output, give it a name");
}

std::vector<NamedPath> written_beside(const StudyArguments& a) {
  std::vector<NamedPath> outputs;
  if (!a.csv.empty()) outputs.push_back({"--csv", a.csv});
  if (!a.hdf5.empty()) outputs.push_back({"--hdf5", a.hdf5});
  if (!a.report.empty()) outputs.push_back({"--report", a.report});
  return outputs;
}

int end_study(const StudyHead& head, const StudyArguments& a, const std::string& summary) {
  if (!a.csv.empty()) write_csv(head.path, a.csv);
  if (!a.hdf5.empty()) {
    write_study_columns(head.path, a.hdf5);
    if (!quiet_altogether(a.findings))
      log(fmt::format("{}: {} of {}", a.hdf5, count_cases(head.path).all(), plural(head.planned, "case")));
  }
  write_study_report(a, head.path);
  if (!summary.empty() && !quiet_altogether(a.findings)) {
    log(summary);
    if (const std::string warned = warned_line(head.path, a.findings.quiet); !warned.empty()) log(warned);
  }
  const std::string failed = failed_line(head);
  if (!failed.empty()) log(failed);
  const bool refused = refused_codes(warned_codes(head.path), a.findings);
  return failed.empty() && !refused ? kSolved : kNoSolution;
}

int read_study(const StudyArguments& a, const std::string& path) {
  if (a.files.size() > 1)
    throw UsageError(fmt::format("{}: found a study beside other files, expected it alone, or --merge", path));
  if (!a.output.empty())
    throw UsageError(fmt::format("-o {}: found it beside a study that is read, expected --csv, --hdf5 or --report", a.output));
  refuse_solving_options(a, "a study that is read");
  check_columns(a);
  study_page_options(a);
  const StudyHead head = read_study_head(path);
  std::vector<NamedPath> inputs = {{"the study", path}};
  if (!a.subjects.empty()) inputs.push_back({"the table of subjects", a.subjects});
  const HeldOutputs held = claim_outputs(inputs, written_beside(a));
  if (!a.overwrite) refuse_to_replace(written_beside(a));
  if (written_beside(a).empty()) print(study_text(head, count_cases(path)));
  return end_study(head, a, "");
}

int merge_shards(const StudyArguments& a) {
  refuse_solving_options(a, "--merge");
  if (a.files.empty()) throw UsageError("--merge: found no file, expected those of the shards");
  check_study_name("-o", a.output);
  std::vector<NamedPath> inputs, outputs = written_beside(a);
  outputs.insert(outputs.begin(), {"-o", a.output});
  for (const std::string& file : a.files) inputs.push_back({"a shard", file});
  check_columns(a);
  study_page_options(a);
  if (!a.subjects.empty()) inputs.push_back({"the table of subjects", a.subjects});
  const HeldOutputs held = claim_outputs(inputs, outputs);
  if (has_content(a.output) && !a.overwrite)
    throw WriteError(fmt::format("{}: is there already; --overwrite replaces it, -o FILE.db makes another", a.output));
  if (!a.overwrite) refuse_to_replace(written_beside(a));
  for (const std::string& file : a.files) read_study_head(file);
  const MergedStudies merged = merge_studies(a.files, a.output);
  const int code =
      end_study(read_study_head(a.output), a,
                fmt::format("{}: {} of {}", a.output, plural(merged.cases, "case"), plural(a.files.size(), "file")));
  if (merged.missing.empty()) return code;
  const std::string shards = merged.missing_shards.empty() ? "" : numbered("shard", merged.missing_shards) + ", ";
  log(fmt::format("{}: lacks {}{}; the command of the study without --shard, with -o {}, solves what is missing",
                  a.output, shards, numbered("case", merged.missing), a.output));
  return kNoSolution;
}

}  // namespace dea

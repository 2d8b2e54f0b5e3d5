#include <febiodea/app/study_plan.h>

#include <fmt/format.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <set>

#include <febiodea/app/interrupt.h>
#include <febiodea/base/error.h>
#include <febiodea/base/parse.h>
#include <febiodea/io/feb/read_feb.h>
#include <febiodea/io/settings/settings_xml.h>
#include <febiodea/io/study/study_schema.h>
#include <febiodea/io/tables/read_tables.h>
#include <febiodea/io/tables/text_table.h>
#include <febiodea/run/states.h>
#include <febiodea/version.h>
#include <febiodea/views/memory.h>

namespace dea {

namespace fs = std::filesystem;

namespace {

/// An option as it is typed.
std::string typed(const std::string& name, const std::string& text) {
  const SettingOption* option = find_setting_option(name);
  if (option != nullptr && option->help_off != nullptr)
    return fmt::format("--{}{}", lower_case(text) == "false" ? "no-" : "", name);
  const bool quotes = text.find_first_of(" \t{}|()*?$;&<>") != text.npos;
  return fmt::format("--{0} {2}{1}{2}", name, text, quotes ? "'" : "");
}

Sampling sampling_of(const StudyArguments& a) {
  Sampling s;
  s.design = argument("sample", a.sample, parse_design);
  if (a.count.empty())
    throw UsageError(fmt::format("--sample {}: found no --count, expected the number of points", a.sample));
  s.count = count_argument("count", a.count, 1, static_cast<int>(kMostCases));
  if (!a.seed.empty())
    s.seed = static_cast<std::uint64_t>(count_argument("seed", a.seed, 0, std::numeric_limits<int>::max()));
  return s;
}

/// The options of the line in their order, and as texts.
struct Line {
  std::vector<PlanOption> options;
  std::vector<Factor> factors;
  std::vector<std::string> factor_words;  ///< one per factor: "--vary TEXT"
  std::vector<std::string> words;         ///< what the cases depend on
};

Line options_of_line(const StudyArguments& a) {
  Line line;
  std::map<std::string, std::size_t> seen;
  for (const std::string& name : a.settings.order) {
    const std::vector<std::string>& texts = a.settings.values.at(name);
    const std::size_t i = seen[name]++;
    if (i >= texts.size()) continue;
    line.words.push_back(typed(name, texts[i]));
    if (name != "vary" && name != "factor") {
      line.options.push_back({name, texts[i], -1});
      continue;
    }
    line.factors.push_back(argument(name, texts[i], parse_factor));
    line.factor_words.push_back(fmt::format("--{} {}", name, texts[i]));
    line.options.push_back({line.factors.back().option, "", static_cast<int>(line.factors.size()) - 1});
  }
  const auto add = [&](const char* name, const std::string& text) {
    if (!text.empty()) line.words.push_back(typed(name, text));
  };
  add("cases", a.cases);
  add("sample", a.sample);
  add("count", a.count);
  add("seed", a.seed);
  add("states", a.states);
  add("settings", a.settings.file);
  for (const std::string& keep : a.keep) add("keep", keep);
  return line;
}

/// Values that are alike are looked at once; a value that cannot be is a fault of the line or of its row.
class ValueCheck {
 public:
  ValueCheck(const Plan& plan, const Line& line, const std::optional<CaseTable>& table)
      : plan_(plan), line_(line), table_(table), seen_(plan.factors.size()) {}

  void check(const PlannedCase& c) {
    for (std::size_t i = 0; i < plan_.factors.size(); ++i) {
      const Factor& f = plan_.factors[i];
      const bool drawn = f.spread.kind != Spread::Kind::None;  // all of them differ
      if (!drawn && !seen_[i].insert(c.values[i]).second) continue;
      const std::string text = f.before + c.values[i] + f.after;
      try {
        Settings settings;
        set_value(settings, split_key(*find_setting_option(f.option), text));
        for (const NamedPath& file : table_files(settings)) files.push_back(file);
      } catch (const BadValue& bad) {
        refuse(i, c.values[i], bad.what());
      }
    }
  }

  std::vector<NamedPath> files;  ///< that values name

 private:
  [[noreturn]] void refuse(std::size_t factor, const std::string& value, const std::string& why) const {
    const std::string& name = plan_.factors[factor].name;
    for (std::size_t k = 0; table_ && k < table_->names.size(); ++k)
      for (std::size_t r = 0; lower_case(table_->names[k]) == lower_case(name) && r < table_->rows.size(); ++r)
        if (table_->rows[r][k] == value)
          throw InputError(table_->path, table_->lines[r], fmt::format("column \"{}\": {}", name, why));
    throw UsageError(fmt::format("{}: value {}: {}", line_.factor_words[factor], value, why));
  }

  const Plan& plan_;
  const Line& line_;
  const std::optional<CaseTable>& table_;
  std::vector<std::set<std::string>> seen_;
};

/// Throws what `dea run` would say of the options before it reads the model. Adds the tables that they name.
void check_options(Study& study, const Line& line, const std::optional<CaseTable>& table, Settings settings) {
  try {
    std::vector<SettingValue> values;
    for (const CaseOption& o : options_of(study.plan, study.plan.cases.front()))
      values.push_back(split_key(*find_setting_option(o.name), o.text));
    lay_over(settings, values);
  } catch (const BadValue& bad) {
    throw UsageError(bad.what());
  }
  ValueCheck check(study.plan, line, table);
  for (const PlannedCase& c : study.plan.cases) check.check(c);
  std::vector<NamedPath> files = table_files(settings);
  files.insert(files.end(), check.files.begin(), check.files.end());
  std::set<std::string> known;
  for (const NamedPath& file : files)
    if (known.insert(file.path).second) study.inputs.push_back(file);
}

/// The files that a model is read from; one that cannot be read is refused when its cases are solved.
std::vector<std::string> files_of_model(const std::string& model) {
  try {
    return read_feb(model).files;
  } catch (const InputError&) {
    return {model};
  }
}

/// Paths with digests: the models with all that they include, then tables, settings, cases.
void take_digests(Study& study, Progress& progress) {
  const std::vector<std::string>& models = study.plan.models;
  std::vector<std::vector<std::string>> files(models.size());
  progress.now(models.size() == 1 ? "reading the model" : fmt::format("reading {} models", models.size()), "", "");
  tbb::parallel_for(std::size_t{0}, models.size(), [&](std::size_t i) {
    file_digest(models[i]);  // is it there?
    files[i] = files_of_model(models[i]);
  });
  std::set<std::string> known;
  const auto add = [&](const std::string& path) {
    if (known.insert(path).second) study.identity.inputs.push_back({path, file_digest(path)});
  };
  for (const std::vector<std::string>& of_model : files) std::for_each(of_model.begin(), of_model.end(), add);
  for (const NamedPath& input : study.inputs) add(input.path);
  for (const std::string& model : models) study.inputs.push_back({"a model", model});
}

int workers_of(const StudyArguments& a) {
  return a.threads.empty() ? tbb::info::default_concurrency() : count_argument("threads", a.threads, 1, 1024);
}

/// Half of what is free is for joints that are ready; the rest for what solving takes.
double memory_for_joints() {
  const double half = 0.5 * free_memory();
  return std::isfinite(half) ? half : StudyOptions{}.memory;
}

void take_states(const StudyArguments& a, const OutputSettings& of_file, StudyOptions& options) {
  options.states = a.states.empty() ? of_file.states : a.states;
  if (!options.states.empty()) argument("states", options.states, parse_states);
}

/// A whole number that the environment has; -1: none.
int environment_number(const char* name) {
  const char* text = std::getenv(name);
  try {
    return text == nullptr ? -1 : parse_count(text, 0, std::numeric_limits<int>::max());
  } catch (const BadValue& bad) {
    throw UsageError(fmt::format("--shard auto: {}: {}", name, bad.what()));
  }
}

/// One task among several; none of these variables: {1, 1}.
Shard task_of_environment() {
  // SLURM_PROCID is there outside of srun too; the number of tasks of a step is not
  for (const auto& [rank, size] :
       {std::pair("SLURM_PROCID", "SLURM_STEP_NUM_TASKS"), std::pair("OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"),
        std::pair("PMI_RANK", "PMI_SIZE")}) {
    const int i = environment_number(rank), n = environment_number(size);
    if (i >= 0 && n > 1 && i < n) return {i + 1, n};
  }
  return {};
}

Shard automatic_shard() {
  const Shard task = task_of_environment();
  const int id = environment_number("SLURM_ARRAY_TASK_ID"), first = environment_number("SLURM_ARRAY_TASK_MIN"),
            last = environment_number("SLURM_ARRAY_TASK_MAX"), given = environment_number("SLURM_ARRAY_TASK_STEP"),
            step = std::max(1, given);
  if (id < 0 && task.of == 1)
    throw UsageError(
        "--shard auto: found none of SLURM_ARRAY_TASK_ID, SLURM_PROCID with SLURM_STEP_NUM_TASKS (srun), "
        "OMPI_COMM_WORLD_RANK, PMI_RANK with their sizes, expected --shard I/N");
  if (id < 0) return task;
  const int count = environment_number("SLURM_ARRAY_TASK_COUNT"), place = (id - std::max(0, first)) / step;
  if (first < 0 || last < id || id < first || (id - first) % step != 0 || count != (last - first) / step + 1)
    throw UsageError(
        fmt::format("--shard auto: found Slurm's array task {} of {} from {} to {}, expected an array without gaps: "
                    "--shard I/N",
                    id, count, first, last));
  return {place * task.of + task.number, count * task.of};
}

}  // namespace

Study study_of(const StudyArguments& a, Progress& progress) {
  if (a.sample.empty() && !a.count.empty()) throw UsageError(fmt::format("--count {}: found no --sample", a.count));
  if (a.sample.empty() && !a.seed.empty()) throw UsageError(fmt::format("--seed {}: found no --sample", a.seed));
  Line line = options_of_line(a);
  check_factor_names(line.factors);
  Settings of_file;
  OutputSettings outputs;
  if (!a.settings.file.empty()) {
    SettingsFile file = read_settings_file(a.settings.file);
    of_file = std::move(file.settings);
    outputs = std::move(file.outputs);
  }
  PlanRequest request{a.files, line.options, line.factors, {}, {}};
  if (!a.sample.empty()) request.sampling = sampling_of(a);
  if (!a.cases.empty()) request.table = read_case_table(a.cases);
  const std::optional<CaseTable> table = request.table;
  Study study;
  study.plan = make_plan(std::move(request));
  check_options(study, line, table, of_file);
  if (!a.settings.file.empty()) study.inputs.push_back({"the settings file", a.settings.file});
  if (!a.cases.empty()) study.inputs.push_back({"the table of cases", a.cases});
  take_states(a, outputs, study.options);
  study.options.settings_file = a.settings.file;
  study.options.workers = workers_of(a);
  study.options.memory = memory_for_joints();
  study.options.stop = stop_flag();
  study.identity.version = fmt::format("{} ({})", kVersion, kCommit);
  study.identity.options = std::move(line.words);
  take_digests(study, progress);
  return study;
}

Shard shard_of(const std::string& text) {
  if (text.empty()) return {};
  if (lower_case(text) == "auto") return automatic_shard();
  const std::size_t slash = text.find('/');
  return argument("shard", text, [&](const std::string&) {
    if (slash == text.npos) throw bad_value(text, "I/N, such as 2/4, or auto", {"auto"});
    const int of = parse_count(text.substr(slash + 1), 1, 1'000'000);
    return Shard{parse_count(text.substr(0, slash), 1, of), of};
  });
}

std::string shard_path(const std::string& path, const Shard& shard) {
  if (shard.of == 1) return path;
  const fs::path p = path;
  return (p.parent_path() /
          fmt::format("{}.{}-of-{}{}", p.stem().string(), shard.number, shard.of, p.extension().string()))
      .string();
}

}  // namespace dea

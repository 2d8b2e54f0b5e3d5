#include "io/study/study_request.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "io/feb/read_feb.h"
#include "io/files/free_memory.h"
#include "io/settings/settings_xml.h"
#include "io/study/study_schema.h"
#include "io/tables/read_tables.h"
#include "io/tables/table.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/parallel.h"
#include "src/base/parse.h"
#include "src/base/say.h"
#include "src/run/states.h"
#include "src/version.h"

namespace dea {

namespace {

constexpr const char* kTableInMemory = "a table in memory";  // in place of a path

/// An option as it is typed.
std::string typed(const std::string& name, const std::string& text) {
  const SettingOption* option = find_setting_option(name);
  if (option != nullptr && option->help_off != nullptr)
    return fmt::format("--{}{}", lower_case(text) == "false" ? "no-" : "", name);
  const bool quotes = text.find_first_of(" \t{}|()*?$;&<>") != text.npos;
  return fmt::format("--{0} {2}{1}{2}", name, text, quotes ? "'" : "");
}

Sampling sampling_of(const StudyRequest& r) {
  Sampling s;
  s.design = parsed("sample", r.sample, parse_design);
  if (r.count.empty())
    throw UsageError(Fault{.given = said("sample", r.sample),
                           .found = say("found no {},", NamedSetting{"count"}),
                           .expected = "expected the number of points"});
  s.count =
      parsed("count", r.count, [](const std::string& t) { return parse_count(t, 1, static_cast<int>(kMostCases)); });
  if (!r.seed.empty())
    s.seed = static_cast<std::uint64_t>(parsed(
        "seed", r.seed, [](const std::string& t) { return parse_count(t, 0, std::numeric_limits<int>::max()); }));
  return s;
}

/// The options in their order, and as texts.
struct Line {
  std::vector<PlanOption> options;
  std::vector<Factor> factors;
  std::vector<NamedSetting> factor_words;  ///< one per factor
  std::vector<std::string> words;          ///< what the cases depend on
};

void refuse_unknown(const CaseOption& option) {
  if (find_setting_option(option.name) != nullptr) return;
  throw UsageError(fmt::format("found \"{}\"{}, expected the name of an option of dea run", option.name,
                               did_you_mean(option.name, every_name(setting_options()), setting_aliases())));
}

Line line_of(const StudyRequest& r) {
  Line line;
  for (const CaseOption& o : r.options) {
    line.words.push_back(typed(o.name, o.text));
    if (o.name != "vary" && o.name != "factor") {
      refuse_unknown(o);
      line.options.push_back({o.name, o.text, -1});
      continue;
    }
    line.factors.push_back(parsed(o.name, o.text, parse_factor));
    line.factor_words.push_back(said(o.name, o.text));
    line.options.push_back({line.factors.back().option, "", static_cast<int>(line.factors.size()) - 1});
  }
  const auto add = [&](const char* name, const std::string& text) {
    if (!text.empty()) line.words.push_back(typed(name, text));
  };
  add("cases", r.cases);
  add("sample", r.sample);
  add("count", r.count);
  add("seed", r.seed);
  add("states", r.states);
  add("settings", r.settings_file);
  return line;
}

/// A value that cannot be is a fault of its row or of the line.
[[noreturn]] void refuse_value(const Plan& plan, const Line& line, const std::optional<CaseTable>& table,
                               std::size_t factor, const std::string& value, const std::string& why) {
  const std::string& name = plan.factors[factor].name;
  for (std::size_t k = 0; table && k < table->names.size(); ++k)
    for (std::size_t r = 0; lower_case(table->names[k]) == lower_case(name) && r < table->rows.size(); ++r)
      if (table->rows[r][k] == value)
        throw InputError(table->path, table->lines[r], fmt::format("column \"{}\": {}", name, why));
  throw UsageError(Fault{.given = line.factor_words[factor], .found = fmt::format("value {}: {}", value, why)});
}

/// The files that values of factors name; values that are alike are looked at once.
std::vector<NamedPath> check_values(const Plan& plan, const Line& line, const std::optional<CaseTable>& table) {
  std::vector<NamedPath> files;
  std::vector<std::set<std::string>> seen(plan.factors.size());
  for (const PlannedCase& c : plan.cases)
    for (std::size_t i = 0; i < plan.factors.size(); ++i) {
      const Factor& f = plan.factors[i];
      const bool drawn = f.spread.kind != Spread::Kind::None;  // all of them differ
      if (!drawn && !seen[i].insert(c.values[i]).second) continue;
      try {
        Settings settings;
        set_value(settings, split_key(*find_setting_option(f.option), f.before + c.values[i] + f.after));
        for (const NamedPath& file : table_files(settings)) files.push_back(file);
      } catch (const BadValue& bad) {
        refuse_value(plan, line, table, i, c.values[i], bad.what());
      }
    }
  return files;
}

/// Throws what `dea run` would say of the options before it reads the model. Adds the tables that they name.
void check_options(Study& study, const Line& line, const std::optional<CaseTable>& table, Settings settings) {
  const std::vector<NamedPath> of_values = check_values(study.plan, line, table);
  try {
    std::vector<SettingValue> values;
    for (const CaseOption& o : options_of(study.plan, study.plan.cases.front()))
      values.push_back(split_key(*find_setting_option(o.name), o.text));
    lay_over(settings, values);
  } catch (const BadValue& bad) {
    throw UsageError(bad.what());
  }
  std::vector<NamedPath> files = table_files(settings);
  files.insert(files.end(), of_values.begin(), of_values.end());
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

/// Half of what is free is for joints that are ready, the rest for what solving takes; other tasks of a batch job that
/// begin on this node want as much.
double memory_for_joints() {
  const double half = 0.5 * free_memory() / tasks_on_node();
  return std::isfinite(half) ? half : StudyOptions{}.memory;
}

int workers_here() {
  const int cores = core_count(), given = processors_of_task();
  return given > 0 ? std::min(cores, given) : cores;
}

std::string digest_of(const CaseTable& table) {
  std::string all;
  const auto add = [&](const std::vector<std::string>& cells) {
    for (const std::string& cell : cells) all += cell + '\x1f';
    all += '\n';
  };
  add(table.names);
  std::for_each(table.rows.begin(), table.rows.end(), add);
  return bytes_digest(all);
}

void refuse_count_without_sample(const StudyRequest& r) {
  for (const auto& [name, text] : {std::pair("count", &r.count), std::pair("seed", &r.seed)})
    if (r.sample.empty() && !text->empty())
      throw UsageError(Fault{.given = said(name, *text), .found = say("found no {}", NamedSetting{"sample"})});
}

std::string version_of_program() { return fmt::format("{} ({})", kVersion, kCommit); }

}  // namespace

NamedSetting said(const std::string& option, const std::string& text) { return {option, "", text, "", true}; }

Study plan_study(const StudyRequest& r) {
  refuse_count_without_sample(r);
  Line line = line_of(r);
  check_factor_names(line.factors);
  SettingsFile file;
  if (!r.settings_file.empty()) file = read_settings_file(r.settings_file);
  PlanRequest request{r.models, line.options, line.factors, r.table, {}};
  if (!r.sample.empty()) request.sampling = sampling_of(r);
  if (!r.cases.empty()) request.table = read_case_table(r.cases);
  const std::optional<CaseTable> table = request.table;
  Study study;
  study.plan = make_plan(std::move(request));
  check_options(study, line, table, file.settings);
  if (!r.settings_file.empty()) study.inputs.push_back({"the settings file", r.settings_file});
  if (!r.cases.empty()) study.inputs.push_back({"the table of cases", r.cases});
  study.options.states = r.states.empty() ? file.outputs.states : r.states;
  if (!study.options.states.empty()) parsed("states", study.options.states, parse_states);
  study.options.settings_file = r.settings_file;
  study.options.workers = workers_here();
  study.options.memory = memory_for_joints();
  study.identity.version = version_of_program();
  study.identity.options = std::move(line.words);
  study.identity.inside = file.settings.inside || std::any_of(line.options.begin(), line.options.end(), [](auto& o) {
                            return o.name == std::string("inside") && lower_case(o.text) != "false";
                          });
  if (r.table) study.identity.inputs.push_back({kTableInMemory, digest_of(*r.table)});
  return study;
}

void take_digests(Study& study) {
  const std::vector<std::string>& models = study.plan.models;
  std::vector<std::vector<std::string>> files(models.size());
  parallel_for(models.size(), [&](std::size_t i) {
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

void take_identity(Study& study, const StudyIdentity& of_other) {
  if (of_other.version != study.identity.version)
    throw InputError(fmt::format("found febiodea {}, expected {}, as the study was begun by", study.identity.version,
                                 of_other.version));
  for (const auto& [path, digest] : of_other.inputs)
    if (path != kTableInMemory && file_digest(path) != digest)
      throw InputError(
          fmt::format("{}: found another content than where the study was begun, expected the same file at "
                      "this path",
                      path));
  study.identity = of_other;
}

}  // namespace dea

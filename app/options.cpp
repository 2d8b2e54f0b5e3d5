#include "app/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "io/files/output.h"
#include "io/results/existing_file.h"
#include "io/settings/settings_xml.h"
#include "io/tables/read_tables.h"
#include "src/base/error.h"
#include "src/base/parallel.h"

namespace dea {

namespace {

/// A setting's help, with the settings that it names as the command line has them.
std::string help_of(const SettingOption& option) {
  std::string text;
  for (const std::string& part : split(option.help, '{')) {
    const std::size_t end = part.find('}');
    text += end == part.npos ? part : command_line_wording()({part.substr(0, end)}) + part.substr(end + 1);
  }
  return text;
}

void add_switch(CLI::App& command, std::vector<std::string>& values, const SettingOption& option) {
  const auto add = [&](const std::string& name, const char* value, const char* help) {
    command
        .add_flag_callback(
            name, [&values, value] { values = {value}; }, help)
        ->group(option.group);
  };
  add(fmt::format("--no-{}", option.name), "false", option.help_off);
  add(fmt::format("--{}", option.name), "true", option.help);
}

void add_value(CLI::App& command, std::vector<std::string>& values, const SettingOption& option) {
  const bool several = option.key != nullptr || option.repeatable;
  // One word per use, also when it begins with '-' or '[': the rest of the line is not ours to swallow.
  command.add_option(fmt::format("--{}", option.name), values, help_of(option))
      ->type_name(value_form(option))
      ->allow_extra_args(false)
      ->group(option.group)
      ->expected(1)
      ->multi_option_policy(several ? CLI::MultiOptionPolicy::TakeAll : CLI::MultiOptionPolicy::Throw);
}

}  // namespace

void add_solving_options(CLI::App& command, SettingsArguments& arguments, std::string& threads,
                         const std::vector<std::string>& without) {
  for (const SettingOption& option : setting_options()) {
    if (std::find(without.begin(), without.end(), option.name) != without.end()) continue;
    std::vector<std::string>& values = arguments.values[option.name];
    if (option.help_off != nullptr)
      add_switch(command, values, option);
    else
      add_value(command, values, option);
  }
  command.parse_complete_callback([&command, &arguments] {
    for (const CLI::Option* given : command.parse_order()) {
      std::string name = given->get_single_name();
      if (name.rfind("no-", 0) == 0) name.erase(0, 3);  // a switch turned off
      if (arguments.values.count(name) > 0) arguments.order.push_back(name);
    }
  });
  add_once(
      command, "--settings", arguments.file, "FILE", "Settings file",
      "XML file with any of the options above (docs/settings.md); the command line overrides it, and it overrides the "
      "model");
  add_once(command, "--threads", threads, "N", "Computer",
           "Number of threads; results do not depend on it [all cores]");
}

std::vector<CaseOption> in_their_order(const SettingsArguments& given) {
  std::vector<CaseOption> options;
  std::map<std::string, std::size_t> seen;
  for (const std::string& name : given.order) {
    const std::vector<std::string>& texts = given.values.at(name);
    const std::size_t i = seen[name]++;
    if (i < texts.size()) options.push_back({name, texts[i]});
  }
  return options;
}

Settings effective_settings(const SettingsArguments& arguments, OutputSettings* outputs) {
  Settings settings;
  if (!arguments.file.empty()) {
    const SettingsFile file = read_settings_file(arguments.file);
    settings = file.settings;
    if (outputs != nullptr) *outputs = file.outputs;
  }
  try {
    std::vector<SettingValue> values;
    for (const auto& [name, text] : in_their_order(arguments))
      values.push_back(split_key(*find_setting_option(name), text));
    lay_over(settings, values);
  } catch (const BadValue& e) {
    throw UsageError(e.what());
  }
  return settings;
}

CLI::App* add_model_command(CLI::App& app, const char* name, const char* help, const char* footer, ModelArguments& a) {
  CLI::App* command = app.add_subcommand(name, help);
  command->footer(footer);
  command->add_option("MODEL", a.model, "FEBio model (.feb, versions 1.2, 2.0, 2.5, 3.0, 4.0)")
      ->required()
      ->type_name("");
  return command;
}

void add_once(CLI::App& command, const char* name, std::string& value, const char* type, const char* group,
              const char* help) {
  const auto is_there = [](const std::string& text) {  // a script's variable without a value
    return text.empty() ? std::string("found nothing, expected a value") : std::string();
  };
  command.add_option(name, value, help)->type_name(type)->group(group)->check(CLI::Validator(is_there, ""));
}

void add_repeated(CLI::App& command, const char* name, std::vector<std::string>& values, const char* type,
                  const char* group, const char* help) {
  command.add_option(name, values, help)
      ->type_name(type)
      ->group(group)
      ->allow_extra_args(false)
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

CLI::Option* add_quiet_flag(CLI::App& command, bool& quiet) {
  return command.add_flag("-q,--quiet", quiet, "Print only errors, and what has no solution")->group("Output");
}

void add_compress_flag(CLI::App& command, bool& compress) {
  command.add_flag("--compress", compress, "Compress the plot file (zlib)")->group("Output");
}

void add_overwrite_flag(CLI::App& command, bool& overwrite) {
  command
      .add_flag("--overwrite", overwrite,
                "Replace files that are there, whatever they are [only what dea made itself, if nothing else would be "
                "lost with it]")
      ->group("Output");
}

void refuse_to_replace(const std::string& option, const std::string& path, const std::string& why,
                       const std::string& does) {
  if (!why.empty()) throw WriteError(fmt::format("{}: {}; --overwrite {}, {} writes another", path, why, does, option));
}

void refuse_to_replace(const std::vector<NamedPath>& outputs, const std::string& does) {
  for (const NamedPath& output : outputs)
    if (!output.folder && output.path != "-")
      refuse_to_replace(output.option, output.path, why_kept_file(output.path), does);
}

std::vector<NamedPath> input_files(const ModelArguments& a, const Settings& settings) {
  std::vector<NamedPath> inputs = {{"the model", a.model}};
  if (!a.settings.file.empty()) inputs.push_back({"the settings file", a.settings.file});
  for (const NamedPath& table : table_files(settings)) inputs.push_back(table);
  return inputs;
}

std::shared_ptr<void> limit_threads(const std::string& threads) {
  return threads.empty() ? nullptr : limit_threads(count_argument("threads", threads, 1, 1024));
}

UsageError wrong_argument(const std::string& option, const std::string& text, const BadValue& why) {
  return UsageError(fmt::format("--{} {}: {}", option, text, why.what()));
}

int count_argument(const char* option, const std::string& text, int least, int most) {
  return argument(option, text, [&](const std::string& t) { return parse_count(t, least, most); });
}

double number_argument(const char* option, const std::string& text) { return argument(option, text, parse_number); }

double positive_argument(const char* option, const std::string& text) {
  const double value = number_argument(option, text);
  if (!(value > 0)) throw wrong_word(option, text, "a number above 0");
  return value;
}

Eigen::Vector3d vector_argument(const char* option, const std::string& text) {
  return argument(option, text, parse_vector);
}

Eigen::Vector3d direction_argument(const char* option, const std::string& text) {
  const Eigen::Vector3d v = vector_argument(option, text);
  if (!(v.norm() > 0)) throw wrong_word(option, text, "a direction that is not 0");
  return v;
}

bool read_region_layout(const std::string& word, RegionLayout& layout) {
  const std::string sectors = "sectors=";
  if (word == "socket")
    layout = {.socket = true};
  else if (word == "anterior-superior-posterior")
    layout = {.thirds = true};
  else if (word.starts_with(sectors))
    layout = {.sectors = count_argument("regions", word.substr(sectors.size()), 2, 72)};
  else
    return false;
  return true;
}

UsageError wrong_word(const char* option, const std::string& text, const std::string& expected,
                      const std::vector<std::string>& words) {
  return wrong_argument(option, text, bad_value(text, expected, words));
}

void show_activity(Progress& progress, const Activity& a) {
  if (a.stage != Activity::Stage::State) {
    const std::string what = a.stage == Activity::Stage::Joint ? "joint and thickness" : "springs and layers";
    progress.now(what, "", what);
    return;
  }
  std::string within, details;
  if (a.search.iterations > 0 && std::isfinite(a.search.residual)) {
    within = fmt::format("iteration {}, unbalanced {:.0e}", a.search.iterations, a.search.residual);
    details = fmt::format("  iteration {}, pose {}: unbalanced {:.1e} of the load before", a.search.iterations,
                          a.search.casts, a.search.residual);
  }
  progress.now(fmt::format("state {} of {}", a.index + 1, a.count), within, details, a.index, a.count);
}

void require_file(const std::string& option, const std::string& path) {
  if (path == "-")
    throw UsageError(fmt::format("{} -: the plot file cannot go to standard output, give it a name", option));
}

std::string plot_name_note(const std::string& option, const std::string& path) {
  const std::string extension = extension_of(path);
  std::error_code error;
  if (extension == ".feb")
    throw UsageError(
        fmt::format("{} {}: found the ending of a model file, which would be lost; expected .xplt", option, path));
  if (extension == ".xplt" || std::filesystem::is_character_file(path, error)) return "";  // /dev/null
  return fmt::format(
      "note: {} {}: PostView and FEBio Studio know plot files by the ending .xplt; written as it was asked", option,
      path);
}

std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }

}  // namespace dea

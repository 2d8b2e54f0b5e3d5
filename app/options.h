// app/options.h – options that commands share: what takes the place of the model's own statements.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "app/progress.h"
#include "io/settings/output_options.h"
#include "src/base/error.h"
#include "src/base/parse.h"
#include "src/model/settings.h"
#include "src/run/analysis.h"
#include "src/study/plan.h"
#include "src/study/regions.h"

namespace dea {

/// The options as typed, by name; read later, so that a fault is one line of ours.
struct SettingsArguments {
  std::string file;  ///< --settings
  std::map<std::string, std::vector<std::string>> values;
  std::vector<std::string> order;  ///< names of those that were given, once for each time, in the order of the line
};

/// What every command on one model takes.
struct ModelArguments {
  std::string model, threads;
  SettingsArguments settings;
};

/// All of setting_options, but for those of the names `without`; --settings, --threads.
void add_solving_options(CLI::App& command, SettingsArguments& arguments, std::string& threads,
                         const std::vector<std::string>& without = {});

/// Names and texts of those that were given, in the order of the line.
std::vector<CaseOption> in_their_order(const SettingsArguments& given);

/// Command line over settings file over the model's own. Throws UsageError, InputError (settings file). `outputs`: what
/// the file says of output files and states; nullptr: of no interest.
Settings effective_settings(const SettingsArguments& arguments, OutputSettings* outputs = nullptr);

/// A command on one MODEL; add_solving_options come last.
CLI::App* add_model_command(CLI::App& app, const char* name, const char* help, const char* footer, ModelArguments& a);

/// An option that is given once, and one that may be repeated, a value each time. `type`: how the help calls the value.
void add_once(CLI::App& command, const char* name, std::string& value, const char* type, const char* group,
              const char* help);
void add_repeated(CLI::App& command, const char* name, std::vector<std::string>& values, const char* type,
                  const char* group, const char* help);

/// -q, --compress as all commands that have them spell them.
CLI::Option* add_quiet_flag(CLI::App& command, bool& quiet);
void add_compress_flag(CLI::App& command, bool& compress);
/// --overwrite: one meaning for all commands that write files.
void add_overwrite_flag(CLI::App& command, bool& overwrite);
/// WriteError that ends in what to do; `why` (existing_file.h) is empty: nothing. `does`: what --overwrite would do.
void refuse_to_replace(const std::string& option, const std::string& path, const std::string& why,
                       const std::string& does = "replaces it");
/// The same of each output that is a file but no model, plot file or study: only one that dea made gives way.
void refuse_to_replace(const std::vector<NamedPath>& outputs, const std::string& does = "replaces it");

/// What must not be written over: the model, the settings file, the tables that `settings` name.
std::vector<NamedPath> input_files(const ModelArguments& a, const Settings& settings);

/// Holds for as long as the result lives; empty `threads`: all cores.
std::shared_ptr<void> limit_threads(const std::string& threads);

/// "--OPTION VALUE: found ..., expected ..."
UsageError wrong_argument(const std::string& option, const std::string& text, const BadValue& why);
/// `parse` of a text; the BadValue that it throws becomes a fault of this option.
template <class Parse>
auto argument(const std::string& option, const std::string& text, Parse parse) {
  try {
    return parse(text);
  } catch (const BadValue& why) {
    throw wrong_argument(option, text, why);
  }
}
/// Values of other options. Throws UsageError: "--OPTION VALUE: found ..., expected ...".
int count_argument(const char* option, const std::string& text, int least, int most);
double number_argument(const char* option, const std::string& text);
double positive_argument(const char* option, const std::string& text);
Eigen::Vector3d vector_argument(const char* option, const std::string& text);
Eigen::Vector3d direction_argument(const char* option, const std::string& text);  ///< longer than 0

/// Is this word of --regions one of a layout, which is then set: "socket", "anterior-superior-posterior", "sectors=6"?
bool read_region_layout(const std::string& word, RegionLayout& layout);

/// "--OPTION TEXT: found ..., expected ...", for a value that is none of its words, or does not fit.
UsageError wrong_word(const char* option, const std::string& text, const std::string& expected,
                      const std::vector<std::string>& words = {});

/// What an analysis is at: "thickness", "springs", "state 4 of 23: iteration 2, unbalanced 3e-04".
void show_activity(Progress& progress, const Activity& activity);
/// Throws UsageError for a plot file "-".
void require_file(const std::string& option, const std::string& path);
/// What to tell of a plot file's name that does not end in .xplt, in whatever letters; empty: nothing.
std::string plot_name_note(const std::string& option, const std::string& path);
/// A path's last part.
std::string file_name(const std::string& path);

}  // namespace dea

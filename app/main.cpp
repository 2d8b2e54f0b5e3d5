// app/main.cpp – the program `dea`: reads the command line, runs a command, turns faults into exit codes.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <exception>
#include <filesystem>
#include <new>
#include <set>
#include <sstream>

#include "app/commands.h"
#include "app/interrupt.h"
#include "app/process.h"
#include "io/files/free_memory.h"
#include "io/files/output.h"
#include "io/settings/setting_words.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/model/settings_table.h"

namespace {

using namespace dea;

constexpr const char* kFooter = R"(
Exit codes: 0 solved; 1 not all results are solutions (not converged, surfaces apart): do not use those; 2 wrong use; 3 input refused; 4 output cannot be written; 70 a fault of the program, please report; 130 stopped by Ctrl-C
(143: by SIGTERM).

Examples:
  dea run hip.feb                    pressure in every state: a table, and hip_dea.xplt beside the model
  dea study hip.feb --vary "E: E={8|12}" -o moduli.db  thousands of cases into one file
  dea info hip.feb                   what is recognised in the model, without solving
  dea converge hip.feb               how many springs the result needs
  dea convert hip.feb                the same joint for FEBio with the plugin, as hip_dea.feb
)"
#ifdef DEA_HAS_BUILD
                                "  dea build --help                   a model from surfaces of bones and cartilage\n"
#endif
                                R"(  dea plugin-build /opt/febio        the plugin for the FEBio in this folder
  dea compare hip_dea.xplt hip.xplt  differences between dea's result and FEBio's
  dea plot hip_dea.xplt              its pressure map as hip_dea.png
  dea cite hip.feb                   a paragraph for the methods of a paper, with references
  dea run --help                     all options of a command
  dea man run | man -l -             the same as a manual page)";

int refuse(const std::string& prefix, const std::string& what, int code) {
  log(prefix + what);
  return code;
}

/// "dea rnu": the word that is no command, and the one that may have been meant; "": all is well, or no command is
/// given.
std::string unknown_command(const CLI::App& app, int argc, char** argv) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  if (argc < 2 || argv[1][0] == '-' || argv[1][0] == '\0') return "";
  const std::string word = argv[1];
  if (std::find(names.begin(), names.end(), word) != names.end()) return "";
  const auto ends = [&](const std::string& end) {
    return word.size() > end.size() && word.compare(word.size() - end.size(), end.size(), end) == 0;
  };
  const char* reader = ends(".feb") ? "run" : ends(".xplt") ? "plot" : "";
  return fmt::format("\"{}\" is no command{}; commands are {}", word,
                     *reader ? fmt::format(" (did you mean \"dea {} {}\"?)", reader, word) : did_you_mean(word, names),
                     name_list(names));
}

/// "--unrolled": the option one of whose words this is: " (did you mean --view unrolled?)"; "": none.
std::string value_for_option(const CLI::App& command, const std::string& word) {
  for (const CLI::Option* option : command.get_options()) {
    const std::string words = "|" + option->get_type_name() + "|";
    if (word.size() > 2 && words.find("|" + word.substr(2) + "|") != std::string::npos && !option->get_lnames().empty())
      return fmt::format(" (did you mean --{} {}?)", option->get_lnames().front(), word.substr(2));
  }
  return "";
}

/// "--output": the main output's option has one letter alone; "": the word means something else.
std::string main_output(const CLI::App& command, const std::string& word) {
  const bool meant = word.rfind("--out", 0) == 0 && std::string("--output-file").rfind(word, 0) == 0;
  return meant && command.get_option_no_throw("-o") != nullptr ? " (did you mean \"-o\"?)" : "";
}

/// Of its options, with their dashes.
std::vector<std::string> long_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// "--lwa": the options on the command line that the command does not have, and those that may have been meant.
std::string unknown_options(const CLI::App& command, int argc, char** argv) {
  const std::vector<std::string> names = long_names(command);
  std::string text;
  for (int i = 1; i < argc; ++i) {
    const std::string word = std::string(argv[i]).substr(0, std::string(argv[i]).find('='));
    if (word.rfind("--", 0) != 0 || word.size() < 3 || std::find(names.begin(), names.end(), word) != names.end())
      continue;
    std::string meant = main_output(command, word);
    if (meant.empty()) meant = value_for_option(command, word);
    if (meant.empty()) meant = did_you_mean(word, names, setting_aliases());
    text += fmt::format("{}no option {}{}", text.empty() ? "" : ", ", word, meant);
  }
  return text;
}

/// Is `word` there as a whole, not as a part of another one?
bool has_word(const std::string& text, const std::string& word) {
  const auto joins = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_'; };
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || !joins(text[at - 1])) && (end == text.size() || !joins(text[end]))) return true;
  }
  return false;
}

/// "smooth", which no option takes as its value: it was to be --smooth. `fault`: names what was not expected.
std::string option_without_dashes(const CLI::App& command, int argc, char** argv, const std::string& fault) {
  const std::vector<std::string> names = long_names(command);
  for (int i = 2; i < argc; ++i) {
    const std::string word = argv[i], option = "--" + word;
    if (has_word(fault, word) && std::find(names.begin(), names.end(), option) != names.end())
      return fmt::format("found \"{}\" (did you mean \"{}\"?)", word, option);
  }
  return "";
}

/// "--json --no-xplt" without a file between them. Empty: there is no such thing.
std::string option_taken_for_value(const CLI::App& command) {
  const std::vector<std::string> long_ones = long_names(command);
  std::set<std::string> names(long_ones.begin(), long_ones.end());
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_snames()) names.insert("-" + name);
  for (const CLI::Option* option : command.get_options())
    for (const std::string& value : option->results())
      if (option->get_type_size() != 0 && names.count(value) > 0)
        return fmt::format("{}: found the option {}, expected a value before it", option->get_name(), value);
  return "";
}

/// "smooth", which is taken as a file and is none: it was to be --smooth. Empty: there is no such thing.
std::string option_taken_for_file(const CLI::App& command) {
  const std::vector<std::string> names = long_names(command);
  for (const CLI::Option* option : command.get_options()) {
    const std::string place = option->get_name(true);
    if (!option->get_positional() || place == "COMMAND" || place == "SHELL") continue;
    for (const std::string& word : option->results()) {
      std::error_code unknown;
      if (std::find(names.begin(), names.end(), "--" + word) != names.end() && !std::filesystem::exists(word, unknown))
        return fmt::format("found \"{0}\", which is no file (did you mean \"--{0}\"?)", word);
    }
  }
  return "";
}

/// The other faults of a model are counted: they may be many.
std::string more_text(const InputError& e) {
  return e.others.empty() ? ""
                          : fmt::format(" (and {} more reason{}: dea info lists them)", e.others.size(),
                                        e.others.size() > 1 ? "s" : "");
}

/// "dea help" and "dea help run" as "dea --help" and "dea run --help".
std::vector<std::string> help_words(int argc, char** argv) {
  std::vector<std::string> words(argv, argv + argc);
  if (argc < 2 || words[1] != "help") return words;
  words.erase(words.begin() + 1);
  words.resize(std::min<std::size_t>(words.size(), 2));
  words.push_back("--help");
  return words;
}

int parse_and_run(int argc, char** argv) {
  CLI::App app("Discrete element analysis of joint contact: FEBio model in, pressure on its surfaces out.", "dea");
  app.footer(kFooter);
  app.set_version_flag("--version", version_text(), "Version, commit and libraries");
  app.require_subcommand(1);
  RunArguments run_arguments;
  StudyArguments study_arguments;
  InfoArguments info_arguments;
  ConvergeArguments converge_arguments;
  ConvertArguments convert_arguments;
  CompareArguments compare_arguments;
  PlotArguments plot_arguments;
#ifdef DEA_HAS_BUILD
  BuildArguments build_arguments;
  build_arguments.words = {argv, argv + argc};
#endif
  PluginBuildArguments plugin_build_arguments;
  CiteArguments cite_arguments;
  ManArguments man_arguments;
  CompletionArguments completion_arguments;
  run_arguments.words = compare_arguments.words = study_arguments.words = {argv, argv + argc};
  const CLI::App* run_command = add_run(app, run_arguments);
  const CLI::App* study_app = add_study(app, study_arguments);
  const CLI::App* info_command = add_info(app, info_arguments);
  const CLI::App* converge_app = add_converge(app, converge_arguments);
  const CLI::App* convert_app = add_convert(app, convert_arguments);
  const CLI::App* compare_app = add_compare(app, compare_arguments);
  const CLI::App* plot_app = add_plot(app, plot_arguments);
#ifdef DEA_HAS_BUILD
  const CLI::App* build_app = add_build(app, build_arguments);
#endif
  const CLI::App* plugin_build_app = add_plugin_build(app, plugin_build_arguments);
  const CLI::App* cite_app = add_cite(app, cite_arguments);
  const CLI::App* man_app = add_man(app, man_arguments);
  const CLI::App* completion_app = add_completion(app, completion_arguments);
  for (CLI::App* command : app.get_subcommands(nullptr)) command->get_formatter()->column_width(38);

  const std::string no_command = unknown_command(app, argc, argv);
  if (!no_command.empty()) return refuse("dea: ", no_command + " (dea --help says what they do)", kWrongUse);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {  // --help, --version
    std::ostringstream out;
    app.exit(e, out, out);
    print(out.str());
    return kSolved;
  } catch (const CLI::ParseError& e) {
    const std::vector<CLI::App*> chosen = app.get_subcommands();
    const std::string command = chosen.empty() ? "dea" : "dea " + chosen.front()->get_name();
    std::string fault = e.what();
    if (chosen.empty() && argc < 2) fault = "no command is given, expected for example dea run MODEL.feb";
    const int code = e.get_exit_code();  // of two faults, a misspelt option is what is to be mended first
    if (code == static_cast<int>(CLI::ExitCodes::ExtrasError) ||
        code == static_cast<int>(CLI::ExitCodes::RequiredError)) {
      const CLI::App& asked = chosen.empty() ? app : *chosen.front();
      std::string unknown = unknown_options(asked, argc, argv);
      if (unknown.empty()) unknown = option_without_dashes(asked, argc, argv, fault);
      if (!unknown.empty()) fault = unknown;
    }
    return refuse(command + ": ", fmt::format("{} ({} --help lists the options)", fault, command), kWrongUse);
  }

  for (const CLI::App* command : app.get_subcommands()) {
    std::string taken = option_taken_for_value(*command);
    if (taken.empty()) taken = option_taken_for_file(*command);
    if (!taken.empty()) return refuse("dea " + command->get_name() + ": ", taken, kWrongUse);
  }
  if (run_command->parsed()) return run(run_arguments);
  if (study_app->parsed()) return study(study_arguments);
  if (info_command->parsed()) return info(info_arguments);
  if (converge_app->parsed()) return converge_command(converge_arguments);
  if (convert_app->parsed()) return convert(convert_arguments);
  if (compare_app->parsed()) return compare_command(compare_arguments);
  if (plot_app->parsed()) return plot_command(plot_arguments);
#ifdef DEA_HAS_BUILD
  if (build_app->parsed()) return build(build_arguments);
#endif
  if (plugin_build_app->parsed()) return plugin_build(plugin_build_arguments);
  if (cite_app->parsed()) return cite(cite_arguments);
  if (man_app->parsed()) return man(app, man_arguments);
  if (completion_app->parsed()) return completion(app, completion_arguments);
  return kWrongUse;
}

}  // namespace

int main(int argc, char** argv) {
  outlive_file_size_limit();
  watch_interrupts();
  try {
    std::vector<std::string> words = help_words(argc, argv);
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    return parse_and_run(static_cast<int>(words.size()), pointers.data());
  } catch (const Stopped&) {
    return refuse("", stopped_line(), stopped_code());
  } catch (const UsageError& e) {
    return refuse("dea: ", line(e.fault, command_line_wording()), kWrongUse);
  } catch (const InputError& e) {
    return refuse("", line(e.fault, command_line_wording()) + more_text(e), kInputRefused);
  } catch (const WriteError& e) {
    return refuse("dea: cannot write ", e.what(), kCannotWrite);
  } catch (const std::bad_alloc&) {
    return refuse("dea: ",
                  fmt::format("the memory is full ({} are free), expected more for this: fewer springs or "
                              "states, smaller files, or a machine with more",
                              gigabytes(free_memory())),
                  kInputRefused);
  } catch (const std::exception& e) {
    return refuse("internal error: ", std::string(e.what()) + ", please report", kInternalError);
  } catch (...) {
    return refuse("internal error: ", "unknown, please report", kInternalError);
  }
}

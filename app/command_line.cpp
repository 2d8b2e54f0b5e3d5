#include "app/command_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <exception>
#include <filesystem>
#include <new>
#include <sstream>

#include "app/commands.h"
#include "app/interrupt.h"
#include "app/process.h"
#include "io/files/free_memory.h"
#include "io/files/output.h"
#include "io/settings/settings_xml.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/model/settings_table.h"

namespace dea {

namespace {

int refuse(const std::string& prefix, const std::string& what, int code) {
  log(prefix + what);
  return code;
}

/// "dea rnu": the word that is no command, and the one that may have been meant; "": all is well, or no command is
/// given.
std::string unknown_command(const CLI::App& app, const std::vector<std::string>& words) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  if (words.size() < 2 || words[1].empty() || words[1][0] == '-') return "";
  const std::string& word = words[1];
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
std::string unknown_options(const CLI::App& command, const std::vector<std::string>& words) {
  const std::vector<std::string> names = long_names(command);
  std::string text;
  for (std::size_t i = 1; i < words.size(); ++i) {
    const std::string word = words[i].substr(0, words[i].find('='));
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
std::string option_without_dashes(const CLI::App& command, const std::vector<std::string>& words,
                                  const std::string& fault) {
  const std::vector<std::string> names = long_names(command);
  for (std::size_t i = 2; i < words.size(); ++i) {
    const std::string &word = words[i], option = "--" + word;
    if (has_word(fault, word) && std::find(names.begin(), names.end(), option) != names.end())
      return fmt::format("found \"{}\" (did you mean \"{}\"?)", word, option);
  }
  return "";
}

/// "--json --no-xplt" without a file between them. Empty: there is no such thing.
std::string option_taken_for_value(const CLI::App& command) {
  std::vector<std::string> names = long_names(command);
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  for (const CLI::Option* option : command.get_options())
    for (const std::string& value : option->results())
      if (option->get_type_size() != 0 && std::find(names.begin(), names.end(), value) != names.end())
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

}  // namespace

std::optional<int> parse(CLI::App& app, const std::vector<std::string>& words) {
  for (CLI::App* command : app.get_subcommands(nullptr)) command->get_formatter()->column_width(38);
  const std::string no_command = unknown_command(app, words);
  if (!no_command.empty()) return refuse("dea: ", no_command + " (dea --help says what they do)", kWrongUse);
  try {
    app.parse(std::vector<std::string>(words.rbegin(), words.rend() - 1));  // it takes the last word first
  } catch (const CLI::Success& e) {                                         // --help, --version
    std::ostringstream out;
    app.exit(e, out, out);
    print(out.str());
    return kSolved;
  } catch (const CLI::ParseError& e) {
    const std::vector<CLI::App*> chosen = app.get_subcommands();
    const std::string command = chosen.empty() ? "dea" : "dea " + chosen.front()->get_name();
    std::string fault = e.what();
    if (chosen.empty() && words.size() < 2) fault = "no command is given, expected for example dea run MODEL.feb";
    const int code = e.get_exit_code();  // of two faults, a misspelt option is what is to be mended first
    if (code == static_cast<int>(CLI::ExitCodes::ExtrasError) ||
        code == static_cast<int>(CLI::ExitCodes::RequiredError)) {
      const CLI::App& asked = chosen.empty() ? app : *chosen.front();
      std::string unknown = unknown_options(asked, words);
      if (unknown.empty()) unknown = option_without_dashes(asked, words, fault);
      if (!unknown.empty()) fault = unknown;
    }
    return refuse(command + ": ", fmt::format("{} ({} --help lists the options)", fault, command), kWrongUse);
  }

  for (const CLI::App* command : app.get_subcommands()) {
    std::string taken = option_taken_for_value(*command);
    if (taken.empty()) taken = option_taken_for_file(*command);
    if (!taken.empty()) return refuse("dea " + command->get_name() + ": ", taken, kWrongUse);
  }
  return std::nullopt;
}

int run_program(const std::function<int()>& work) {
  outlive_file_size_limit();
  watch_interrupts();
  try {
    return work();
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

}  // namespace dea

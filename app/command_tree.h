// app/command_tree.h – the commands and options of the program as plain text, read from what --help is made
// of. Manual pages and shell completion are made of it and of nothing else.
#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace dea {

struct OptionWords {
  std::vector<std::string> names;  ///< as typed: "-q", "--quiet"
  std::string value;               ///< as --help calls it: "FILE.xplt", "linear|layer"; empty: none is typed
  std::string help, group;
  bool repeats = false;
};

struct ArgumentWords {
  std::string name, help;  ///< "MODEL"
  bool required = false, repeats = false;
};

struct CommandWords {
  std::string name;          ///< "dea", "run"
  std::string help, footer;  ///< footer: paragraphs as --help prints them
  std::vector<ArgumentWords> arguments;
  std::vector<OptionWords> options;    ///< in the order of --help, group by group
  std::vector<CommandWords> commands;  ///< of "dea"
};

CommandWords command_tree(const CLI::App& app);

/// What may be typed for a value.
struct ValueWords {
  std::vector<std::string> words;  ///< those to choose from; empty: numbers, names of the model
  bool file = false;               ///< a file's or folder's name
};
/// From what --help calls the value: "linear|layer" are words; FILE and DIR are files; x,y,z and names in capitals
/// stand for what nobody but the user knows.
ValueWords value_words(const std::string& value);

/// Manual page in the language of troff, section 1. `command`: the program itself or one of its commands.
std::string manual_page(const CommandWords& program, const CommandWords& command);
/// "dea", "dea-run": what its page is called.
std::string manual_name(const CommandWords& program, const CommandWords& command);

/// Completion for one of completion_shells().
std::string completion_script(const CommandWords& program, const std::string& shell);
const std::vector<std::string>& completion_shells();

}  // namespace dea

// `dea completion`: what a shell offers after the tab key, made of what --help prints; and the same as JSON.
#include <fmt/format.h>

#include <algorithm>

#include "app/command_tree.h"
#include "app/commands.h"
#include "app/options.h"
#include "io/files/output.h"
#include "src/base/error.h"
#include "views/data/json.h"
#include "views/data/result_schema.h"

namespace dea {

namespace {

constexpr const char* kCompletionFooter = R"(
Prints what the shell needs to complete commands, options and their values with the tab key. cmake --install and Debian's
packages put it where the shells look. Otherwise, for one user:

  bash   dea completion bash > ~/.local/share/bash-completion/completions/dea
  zsh    dea completion zsh > FOLDER/_dea, where FOLDER is one of $fpath
  fish   dea completion fish > ~/.config/fish/completions/dea.fish

With json: all commands and options, their groups, help, and the words that may be typed, for a program that offers them itself.

Examples:
  dea completion bash > dea.bash     then, in a shell: source dea.bash)";

std::string join(const std::vector<std::string>& words, const char* between = " ") {
  return fmt::format("{}", fmt::join(words, between));
}

std::vector<std::string> option_names(const CommandWords& command) {
  std::vector<std::string> names;
  for (const OptionWords& o : command.options) names.insert(names.end(), o.names.begin(), o.names.end());
  return names;
}

std::vector<std::string> command_names(const CommandWords& program) {
  std::vector<std::string> names;
  for (const CommandWords& c : program.commands) names.push_back(c.name);
  return names;
}

/// Of commands whose argument is the name of a command or shell: those words; else none, and files are meant.
std::vector<std::string> argument_choices(const CommandWords& program, const CommandWords& command) {
  for (const ArgumentWords& a : command.arguments) {
    if (a.name == "COMMAND") return command_names(program);
    if (a.name == "SHELL") return completion_shells();
    if (a.name == "SCHEMA") return schema_names();
  }
  return {};
}

/// In single quotes, for any shell of the three.
std::string single_quoted(const std::string& text, bool fish = false) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'')
      result += fish ? "\\'" : "'\\''";
    else if (c == '\\' && fish)
      result += "\\\\";
    else
      result += c;
  }
  return result + "'";
}

// Where the function offers nothing, readline completes the names of files. Bash cuts words at '=': "--law=li" is
// three.
constexpr const char* kBashBegin = R"(# bash completion of dea: what "dea completion bash" prints
_dea() {
  local cur=${COMP_WORDS[COMP_CWORD]} option=${COMP_WORDS[COMP_CWORD-1]} command=${COMP_WORDS[1]} words=
  COMPREPLY=()
  if [[ $cur == = ]]; then
    cur=
  elif [[ $option == = && $COMP_CWORD -gt 2 ]]; then
    option=${COMP_WORDS[COMP_CWORD-2]}
  fi
)";

std::string bash_script(const CommandWords& program) {
  std::string text = kBashBegin;
  text += fmt::format(
      "  if [[ $COMP_CWORD -eq 1 ]]; then\n    COMPREPLY=($(compgen -W {} -- \"$cur\"))\n    return\n  fi\n",
      single_quoted(join(command_names(program)) + " " + join(option_names(program))));
  text += "  case \"$command $option\" in\n";
  for (const CommandWords& c : program.commands) {
    std::vector<std::string> other;
    for (const OptionWords& o : c.options) {
      if (o.value.empty()) continue;
      std::vector<std::string> patterns;
      for (const std::string& name : o.names) patterns.push_back(fmt::format("'{} {}'", c.name, name));
      const std::vector<std::string> words = value_words(o.value).words;
      if (words.empty())
        other.insert(other.end(), patterns.begin(), patterns.end());
      else
        text += fmt::format("    {}) words={} ;;\n", join(patterns, "|"), single_quoted(join(words)));
    }
    if (!other.empty()) text += fmt::format("    {}) return ;;\n", join(other, "|"));
  }
  text += "    *)\n      case \"$command\" in\n";
  for (const CommandWords& c : program.commands)
    text += fmt::format("        {}) words={} ;;\n", c.name, single_quoted(join(option_names(c))));
  text += "      esac\n      if [[ $cur != -* ]]; then\n        case \"$command\" in\n";
  for (const CommandWords& c : program.commands)
    if (const auto choices = argument_choices(program, c); !choices.empty())
      text += fmt::format("          {}) words={} ;;\n", c.name, single_quoted(join(choices)));
  text += "          *) return ;;\n        esac\n      fi ;;\n  esac\n";
  text += "  COMPREPLY=($(compgen -W \"$words\" -- \"$cur\"))\n}\ncomplete -o default -F _dea dea\n";
  return text;
}

/// Text inside the brackets of _arguments or before a colon of _describe.
std::string zsh_escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\' || c == ':' || c == '[' || c == ']') result += '\\';
    result += c;
  }
  return result;
}

std::string zsh_option(const OptionWords& o, const std::string& name) {
  std::string spec = o.repeats ? "*" : "";
  if (!o.repeats && o.names.size() > 1) spec += fmt::format("({})", join(o.names));
  spec += name;
  if (!o.value.empty() && name.rfind("--", 0) == 0) spec += "=";
  spec += fmt::format("[{}]", zsh_escaped(o.help));
  if (!o.value.empty()) {
    const ValueWords value = value_words(o.value);
    spec += fmt::format(":{}:{}", zsh_escaped(o.value),
                        value.file            ? "_files"
                        : value.words.empty() ? " "
                                              : fmt::format("({})", join(value.words)));
  }
  return single_quoted(spec);
}

std::string zsh_options(const CommandWords& command, const char* indent) {
  std::string text;
  for (const OptionWords& o : command.options)
    for (const std::string& name : o.names) text += fmt::format(" \\\n{}{}", indent, zsh_option(o, name));
  return text;
}

std::string zsh_script(const CommandWords& program) {
  std::string text = "#compdef dea\n# zsh completion of dea: what \"dea completion zsh\" prints\n_dea() {\n";
  text += "  local -a commands\n  commands=(\n";
  for (const CommandWords& c : program.commands)
    text += fmt::format("    {}\n", single_quoted(fmt::format("{}:{}", c.name, zsh_escaped(c.help))));
  text += "  )\n  if (( CURRENT == 2 )); then\n    _describe command commands\n";
  text += "    _arguments" + zsh_options(program, "      ") + "\n    return\n  fi\n";
  text += "  local command=$words[2]\n  shift words\n  (( CURRENT-- ))\n  case $command in\n";
  for (const CommandWords& c : program.commands) {
    text += fmt::format("    {})\n      _arguments{}", c.name, zsh_options(c, "        "));
    const std::vector<std::string> choices = argument_choices(program, c);
    const std::string action = choices.empty() ? "_files" : fmt::format("({})", join(choices));
    for (const ArgumentWords& a : c.arguments)
      text += fmt::format(" \\\n        {}",
                          single_quoted(fmt::format("{}:{}:{}", a.repeats ? "*" : "", zsh_escaped(a.name), action)));
    text += " ;;\n";
  }
  text += "  esac\n}\n";
  // autoloaded from a folder of $fpath, the file is the function's body; sourced, it must announce it
  text += "if [ \"$funcstack[1]\" = \"_dea\" ]; then\n  _dea \"$@\"\nelse\n  compdef _dea dea\nfi\n";
  return text;
}

std::string fish_option(const OptionWords& o) {
  std::string text;
  for (const std::string& name : o.names)
    text += name.rfind("--", 0) == 0 ? " -l " + name.substr(2) : " -s " + name.substr(1);
  if (!o.value.empty()) {
    const ValueWords value = value_words(o.value);
    text += value.file ? " -r -F" : " -x";
    if (!value.words.empty()) text += " -a " + single_quoted(join(value.words), true);
  }
  return text + " -d " + single_quoted(o.help, true);
}

std::string fish_script(const CommandWords& program) {
  std::string text = "# fish completion of dea: what \"dea completion fish\" prints\n";
  text += "function __dea_command\n  set -l words (commandline -opc)\n  test \"$words[2]\" = \"$argv[1]\"\nend\n";
  for (const CommandWords& c : program.commands)
    text +=
        fmt::format("complete -c dea -n '__dea_command \"\"' -f -a {} -d {}\n", c.name, single_quoted(c.help, true));
  for (const OptionWords& o : program.options)
    text += fmt::format("complete -c dea -n '__dea_command \"\"'{}\n", fish_option(o));
  for (const CommandWords& c : program.commands) {
    const std::vector<std::string> choices = argument_choices(program, c);
    if (!choices.empty())
      text +=
          fmt::format("complete -c dea -n '__dea_command {}' -f -a {}\n", c.name, single_quoted(join(choices), true));
    for (const OptionWords& o : c.options)
      text += fmt::format("complete -c dea -n '__dea_command {}'{}\n", c.name, fish_option(o));
  }
  return text;
}

Json tree_json(const CommandWords& command) {
  const auto option = [](const OptionWords& o) -> Json {
    const ValueWords value = value_words(o.value);
    return {{"names", o.names}, {"value", o.value},     {"words", value.words},    {"file", value.file},
            {"help", o.help},   {"repeats", o.repeats}, {"group", o.group}};
  };
  return {{"name", command.name},
          {"help", command.help},
          {"options", list_json(command.options, option)},
          {"commands", list_json(command.commands, tree_json)}};
}

}  // namespace

const std::vector<std::string>& completion_shells() {
  static const std::vector<std::string> shells = {"bash", "zsh", "fish", "json"};
  return shells;
}

std::string completion_script(const CommandWords& program, const std::string& shell) {
  if (shell == "bash") return bash_script(program);
  if (shell == "zsh") return zsh_script(program);
  return shell == "json" ? json_text(tree_json(program)) : fish_script(program);
}

CLI::App* add_completion(CLI::App& app, CompletionArguments& a) {
  CLI::App* c = app.add_subcommand("completion", "Print what a shell needs to complete commands and options, or all of them as JSON");
  a.program = &app;
  c->footer(kCompletionFooter);
  c->add_option("SHELL", a.shell, "bash, zsh, fish or json")->required()->type_name("");
  return c;
}

int completion(const CompletionArguments& a) {
  const std::vector<std::string>& shells = completion_shells();
  if (std::find(shells.begin(), shells.end(), a.shell) == shells.end())
    throw UsageError(fmt::format("completion {}: {}", a.shell, bad_value(a.shell, "bash, zsh, fish or json", shells).what()));
  print(completion_script(command_tree(*a.program), a.shell));
  return kSolved;
}

}  // namespace dea

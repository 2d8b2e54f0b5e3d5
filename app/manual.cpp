// `dea man`: the pages of man(1), made of what --help prints.
#include "src/version.h"

#include <fmt/format.h>

#include <filesystem>
#include <sstream>

#include "app/command_tree.h"
#include "app/commands.h"
#include "app/options.h"
#include "io/files/output.h"
#include "src/base/error.h"
#include "src/base/names.h"

namespace dea {

namespace {

constexpr const char* kManFooter = R"(
Each page has what --help has. If dea was installed by cmake --install or as a Debian package, `man dea-run` shows
the page of dea run.

Examples:
  dea man run | man -l -             a command's page
  dea man | man -l -                 the program's
  dea man -o man1                    all of them as files in the folder man1: dea.1, dea-run.1, ...)";

/// Text that troff prints as it is. Hyphens stay hyphens, so that options can be copied from the page.
std::string troff(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\')
      result += "\\e";
    else if (c == '-')
      result += "\\-";
    else
      result += c;
  }
  if (!result.empty() && (result[0] == '.' || result[0] == '\'')) result = "\\&" + result;
  return result;
}

/// Paragraphs as --help prints them: indented lines stay as they are.
std::string troff_paragraphs(const std::string& paragraphs) {
  std::string result;
  std::istringstream lines(paragraphs);
  bool verbatim = false, paragraph = true;  // a heading stands before it
  const auto end_verbatim = [&] {
    if (verbatim) result += ".fi\n";
    verbatim = false;
  };
  for (std::string line; std::getline(lines, line);) {
    if (line.empty()) {
      end_verbatim();
      paragraph = result.empty();
    } else if (line[0] == ' ') {
      if (!verbatim) result += ".nf\n";
      verbatim = true;
      result += troff(line) + "\n";
    } else {
      end_verbatim();
      if (!paragraph) result += ".PP\n";
      paragraph = true;
      result += troff(line) + "\n";
    }
  }
  end_verbatim();
  return result;
}

/// The one-line description without its full stop, as the other pages of section 1 have it.
std::string what_it_does(const CommandWords& command) {
  const std::string& help = command.help;
  return help.empty() || help.back() != '.' ? help : help.substr(0, help.size() - 1);
}

std::string synopsis(const CommandWords& program, const CommandWords& command) {
  std::string text = fmt::format("\\fB{}\\fR", troff(program.name));
  if (&command == &program) return text + " \\fICOMMAND\\fR [\\fIOPTIONS\\fR] ...\n";
  text += fmt::format(" \\fB{}\\fR [\\fIOPTIONS\\fR]", troff(command.name));
  for (const ArgumentWords& a : command.arguments)
    text += fmt::format(" {}\\fI{}\\fR{}{}", a.required ? "" : "[", troff(a.name), a.repeats ? " ..." : "",
                        a.required ? "" : "]");
  return text + "\n";
}

std::string options_section(const CommandWords& command) {
  std::string text, group;
  for (const ArgumentWords& a : command.arguments)
    text += fmt::format(".TP\n\\fI{}\\fR\n{}\n", troff(a.name), troff(a.help));
  for (const OptionWords& o : command.options) {
    if (o.group != group) text += fmt::format(".SS {}\n", troff(o.group));
    group = o.group;
    std::string names;
    for (const std::string& name : o.names)
      names += fmt::format("{}\\fB{}\\fR", names.empty() ? "" : ", ", troff(name));
    text += fmt::format(".TP\n{}{}\n{}\n", names, o.value.empty() ? "" : fmt::format(" \\fI{}\\fR", troff(o.value)),
                        troff(o.help));
  }
  return text;
}

}  // namespace

std::string manual_name(const CommandWords& program, const CommandWords& command) {
  return &command == &program ? program.name : program.name + "-" + command.name;
}

std::string manual_page(const CommandWords& program, const CommandWords& command) {
  const std::string page = manual_name(program, command);
  std::string title = page;
  for (char& c : title) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::string text = "'\\\" -*- coding: utf-8 -*-\n";
  text += fmt::format(".TH {} 1 \"\" \"FEBioDEA {}\" \"User Commands\"\n", troff(title), kVersion);
  text += fmt::format(".nh\n.ad l\n.SH NAME\n{} \\- {}\n", troff(page), troff(what_it_does(command)));
  text += ".SH SYNOPSIS\n" + synopsis(program, command);
  if (!command.commands.empty()) {
    text += ".SH COMMANDS\n";
    for (const CommandWords& c : command.commands)
      text += fmt::format(".TP\n\\fB{}\\fR\n{}\n", troff(c.name), troff(c.help));
  }
  const std::string heading = "\nExamples:\n";
  const std::size_t examples = command.footer.find(heading);
  const std::string description = troff_paragraphs(command.footer.substr(0, examples));
  if (!description.empty()) text += ".SH DESCRIPTION\n" + description;
  text += ".SH OPTIONS\n" + options_section(command);
  if (examples != std::string::npos)
    text += ".SH EXAMPLES\n" + troff_paragraphs(command.footer.substr(examples + heading.size()));
  std::vector<std::string> others;
  for (const CommandWords& c : program.commands)
    others.push_back(fmt::format("\\fB{}\\fR(1)", troff(manual_name(program, c))));
  if (&command != &program) others = {fmt::format("\\fB{}\\fR(1)", troff(program.name))};
  return text + fmt::format(".SH SEE ALSO\n{}\n", fmt::join(others, ",\n"));
}

CLI::App* add_man(CLI::App& app, ManArguments& a) {
  CLI::App* c = app.add_subcommand("man", "Print the manual page of the program or of a command");
  a.program = &app;
  c->footer(kManFooter);
  c->add_option("COMMAND", a.command, "The command [the program itself]")->type_name("");
  add_once(*c, "-o", a.output, "DIR", "Output", "Write all pages into this folder, made if it is missing");
  add_overwrite_flag(*c, a.overwrite);
  return c;
}

int man(const ManArguments& a) {
  const CommandWords program = command_tree(*a.program);
  if (!a.output.empty()) {
    std::error_code error;
    if (!a.command.empty())
      throw UsageError(fmt::format("man {} -o {}: found both, expected one: -o writes all pages", a.command, a.output));
    const std::filesystem::path folder = a.output;
    if (!std::filesystem::is_directory(folder, error) && !std::filesystem::create_directory(folder, error))
      cannot_write(a.output, error);
    std::vector<std::pair<std::string, std::string>> pages;  // path, text
    const auto add = [&](const CommandWords& command) {
      pages.emplace_back((folder / (manual_name(program, command) + ".1")).string(), manual_page(program, command));
    };
    add(program);
    for (const CommandWords& command : program.commands) add(command);
    for (const auto& page : pages)
      if (!a.overwrite) refuse_to_replace({{"-o", page.first}});
    for (const auto& [path, text] : pages) write_text(path, text);
    return kSolved;
  }
  const CommandWords* chosen = a.command.empty() ? &program : nullptr;
  std::vector<std::string> names;
  for (const CommandWords& command : program.commands) {
    names.push_back(command.name);
    if (command.name == a.command) chosen = &command;
  }
  if (chosen == nullptr)
    throw UsageError(fmt::format("man {}: found no command of this name{}, expected one of {}", a.command,
                                 did_you_mean(a.command, names), name_list(names)));
  print(manual_page(program, *chosen));
  return kSolved;
}

}  // namespace dea

#include "app/command_tree.h"

#include <algorithm>

#include "src/base/parse.h"

namespace dea {

namespace {

OptionWords option_words(const CLI::Option& option) {
  OptionWords words;
  for (const std::string& name : option.get_snames()) words.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) words.names.push_back("--" + name);
  if (option.get_items_expected_max() > 0) words.value = option.get_type_name();
  words.help = option.get_description();
  words.group = option.get_group();
  words.repeats = option.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll;
  return words;
}

}  // namespace

CommandWords command_tree(const CLI::App& app) {
  CommandWords words;
  words.name = app.get_name();
  words.help = app.get_description();
  words.footer = app.get_footer();
  for (const CLI::Option* option : app.get_options())
    if (option->get_positional())
      words.arguments.push_back({option->get_name(true), option->get_description(), option->get_required(),
                                 option->get_items_expected_max() > 1});
  for (const std::string& group : app.get_groups()) {
    if (group.empty()) continue;  // hidden
    for (const CLI::Option* option : app.get_options())
      if (!option->get_positional() && option->get_group() == group) words.options.push_back(option_words(*option));
  }
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    words.commands.push_back(command_tree(*command));
  return words;
}

ValueWords value_words(const std::string& value) {
  ValueWords result;
  for (const std::string& part : split(value, '|')) {
    const std::string name = part.substr(part.rfind('=') + 1);  // NAME=FILE, [SURFACE=]FILE
    const std::size_t dot = name.rfind('.');
    const bool ending = dot != name.npos && dot > 0 && dot + 1 < name.size() && name[dot - 1] != '.';  // check.xplt
    if (name.find(',') == name.npos && (name.starts_with("FILE") || name == "DIR" || name == "FOLDER" || ending))
      result.file = true;
    else if (part.find_first_of("=,:/.[{\" ") == part.npos && part != "-" &&
             std::any_of(part.begin(), part.end(), [](unsigned char c) { return std::islower(c) || std::isdigit(c); }))
      result.words.push_back(part);
  }
  const std::string first = value.substr(0, value.find('|'));
  if (result.file || first.find('=') != first.npos) result.words.clear();  // FILE.png|svg|pdf; BODY=x,y,z|com
  return result;
}

}  // namespace dea

#include "io/settings/settings_xml.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <optional>
#include <set>

#include "io/files/encoded_text.h"
#include "io/files/free_memory.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/parse.h"
#include "src/run/states.h"

namespace dea {

namespace {

using tinyxml2::XMLElement;

/// Once per option and name, of those that are not repeatable.
using Given = std::set<std::pair<std::string, std::string>>;

/// All places in a settings file where something is wrong look like this.
InputError fault(const std::string& path, int line, const std::string& text) {
  return InputError(path, std::max(line, 1), text);
}

const OutputOption* find_output_option(const std::string& name) {
  for (const OutputOption& o : output_options())
    if (name == o.name) return &o;
  return nullptr;
}

/// An element that is none of the settings.
InputError unknown_element(const std::string& path, const XMLElement& e) {
  std::vector<std::string> names;
  std::string settings, outputs;
  for (const OutputOption& o : output_options()) {
    names.push_back(o.name);
    outputs += fmt::format(", <{}>", o.name);
  }
  for (const SettingOption& o : setting_options()) {
    names.push_back(o.name);
    settings += fmt::format("{}<{}>", settings.empty() ? "" : ", ", o.name);
  }
  return fault(path, e.GetLineNum(),
               fmt::format("found <{}>{}, expected one of {}{}", e.Name(),
                           did_you_mean(e.Name(), names, setting_aliases()), settings, outputs));
}

/// An element that is one text: no children, no attributes.
std::string read_text_element(const std::string& path, const XMLElement& e, const char* expected) {
  if (e.FirstAttribute())
    throw fault(path, e.GetLineNum(),
                fmt::format("<{}>: found attribute \"{}\", expected none", e.Name(), e.FirstAttribute()->Name()));
  if (e.FirstChildElement())
    throw fault(path, e.FirstChildElement()->GetLineNum(),
                fmt::format("<{}>: found <{}>, expected {}", e.Name(), e.FirstChildElement()->Name(), expected));
  const std::string text = trimmed(e.GetText() ? e.GetText() : "");
  if (text.empty())
    throw fault(path, e.GetLineNum(), fmt::format("<{}>: found nothing, expected {}", e.Name(), expected));
  return text;
}

void check_states(const std::string& path, int line, const std::string& states) {
  try {
    parse_states(states);
  } catch (const BadValue& bad) {
    throw fault(path, line, fmt::format("<states>: {}", bad.what()));
  }
}

SettingValue read_element(const std::string& path, const XMLElement& e) {
  SettingValue v;
  v.option = find_setting_option(e.Name());
  const int line = e.GetLineNum();
  if (!v.option) throw unknown_element(path, e);
  v.where = fmt::format("<{}>", e.Name());
  if (e.FirstChildElement())
    throw fault(path, e.FirstChildElement()->GetLineNum(),
                fmt::format("<{}>: found <{}>, expected {}", e.Name(), e.FirstChildElement()->Name(), v.option->value));
  for (const tinyxml2::XMLAttribute* a = e.FirstAttribute(); a; a = a->Next()) {
    if (!v.option->key || std::string(a->Name()) != v.option->key)
      throw fault(path, line,
                  fmt::format("<{}>: found attribute \"{}\", expected {}", e.Name(), a->Name(),
                              v.option->key ? fmt::format("\"{}\"", v.option->key) : std::string("none")));
    v.key = a->Value();
  }
  if (v.option->key && v.key.empty() && !v.option->per_surface)
    throw fault(
        path, line,
        fmt::format("<{}>: found no attribute \"{}\", expected {}=\"NAME\"", e.Name(), v.option->key, v.option->key));
  v.value = trimmed(e.GetText() ? e.GetText() : "");
  return v;
}

/// The root of a settings file. `document` is what it belongs to.
const XMLElement& read_root(const std::string& path, tinyxml2::XMLDocument& document) {
  constexpr double kMemoryPerByte = 10;  // of a file: its text and its elements
  const std::optional<std::string> text = whole_file(path, kMemoryPerByte);
  if (!text) throw InputError(fmt::format("{}: found no readable file, expected a settings file", path));
  if (document.Parse(text->data(), text->size()) != tinyxml2::XML_SUCCESS)
    throw fault(path, document.ErrorLineNum(), "found no well-formed XML, expected <febiodea_settings version=\"1\">");
  const XMLElement* root = document.RootElement();
  if (!root || std::string(root->Name()) != "febiodea_settings")
    throw fault(path, root ? root->GetLineNum() : 1,
                fmt::format("found {}, expected <febiodea_settings version=\"1\">",
                            root ? fmt::format("<{}>", root->Name()) : std::string("nothing")));
  const char* version = root->Attribute("version");
  if (!version || std::string(version) != "1")
    throw fault(path, root->GetLineNum(), fmt::format("found version \"{}\", expected \"1\"", version ? version : ""));
  return *root;
}

void read_output(const std::string& path, const XMLElement& e, const OutputOption& option, OutputSettings& outputs) {
  std::string& text = outputs.*option.text;
  if (!text.empty())
    throw fault(path, e.GetLineNum(), fmt::format("<{}>: found a second one, expected it once", e.Name()));
  text = read_text_element(path, e, option.expected);
  if (option.kind == OutputOption::Kind::Switch) {
    text = lower_case(text);
    if (text != "true" && text != "false")
      throw fault(path, e.GetLineNum(),
                  fmt::format("<{}>: {}", e.Name(), bad_value(text, option.expected, {"true", "false"}).what()));
  }
  if (option.kind != OutputOption::Kind::States) return;
  check_states(path, e.GetLineNum(), text);
  outputs.states_given = fmt::format("{}:{}: <{}>", path, e.GetLineNum(), e.Name());
}

void read_setting(const std::string& path, const XMLElement& e, Given& given, Settings& settings) {
  const SettingValue v = read_element(path, e);
  if (!v.option->repeatable && !given.insert({v.option->name, v.key}).second)
    throw fault(path, e.GetLineNum(),
                fmt::format("{}: found a second one, expected it once{}", v.where,
                            v.key.empty() ? "" : fmt::format(" for \"{}\"", v.key)));
  try {
    set_value(settings, v);
  } catch (const BadValue& bad) {
    throw fault(path, e.GetLineNum(), fmt::format("{}: {}", v.where, bad.what()));
  }
}

/// Names may hold spaces.
bool has_name(const NamedSetting& s) {
  if (!s.of.empty()) return true;
  const SettingOption* option = find_setting_option(s.setting);
  const std::string value = option == nullptr ? "" : option->value;
  return value == "NAME" || value == "BODY" || value == "MATERIAL" || value == "SURFACE";
}

std::string option_text(const NamedSetting& s) {
  const std::string value = s.of + (s.of.empty() || s.value.empty() ? "" : "=") + s.value,
                    quote = has_name(s) && !s.bare ? "\"" : "";
  return "--" + s.setting + (value.empty() ? "" : " " + quote + value + quote);
}

std::string element_text(const NamedSetting& s) {
  const SettingOption* option = find_setting_option(s.setting);
  const std::string key = option == nullptr || option->key == nullptr ? "" : option->key;
  const std::string start = s.setting + (s.of.empty() ? "" : " " + key + "=\"" + escaped(s.of) + "\"");
  return "<" + start + ">" + (s.value.empty() ? "" : escaped(s.value) + "</" + s.setting + ">");
}

}  // namespace

Wording command_line_wording() { return option_text; }
Wording settings_file_wording() { return element_text; }

SettingValue split_key(const SettingOption& option, const std::string& text) {
  SettingValue v;
  v.option = &option;
  v.value = text;
  v.where = fmt::format("--{} {}", option.name, text);
  if (!option.key) return v;
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos) {
    if (option.per_surface) return v;
    throw BadValue(fmt::format("{}: found no '=', expected {}={}", v.where, key_form(option), option.value));
  }
  v.key = text.substr(0, equals);
  v.value = text.substr(equals + 1);
  if (v.key.empty())
    throw BadValue(
        fmt::format("{}: found no name before '=', expected {}", v.where,
                    std::string(option.key) == "name" ? key_form(option) : fmt::format("that of a {}", option.key)));
  return v;
}

SettingsFile read_settings_file(const std::string& path) {
  tinyxml2::XMLDocument document;
  const XMLElement& root = read_root(path, document);
  SettingsFile file;
  Given given;
  // One element after the other, so that a fault is reported with its own line.
  for (const XMLElement* e = root.FirstChildElement(); e; e = e->NextSiblingElement()) {
    if (const OutputOption* option = find_output_option(e->Name()))
      read_output(path, *e, *option, file.outputs);
    else
      read_setting(path, *e, given, file.settings);
    if (file.outputs.no_xplt == "true" && !file.outputs.output.empty())
      throw fault(path, e->GetLineNum(), "found both <no-xplt> and <output>, expected one of them");
  }
  return file;
}

}  // namespace dea

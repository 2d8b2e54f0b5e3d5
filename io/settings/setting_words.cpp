#include "io/settings/setting_words.h"

#include <string>

#include "io/files/encoded_text.h"
#include "io/settings/settings_xml.h"

namespace dea {

namespace {

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

}  // namespace dea

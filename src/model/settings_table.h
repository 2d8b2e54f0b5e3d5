// src/model/settings_table.h – the settings one by one: name, form, help, how a text becomes a part of Settings
// and how that is shown. Command line, settings file, JSON and manual walk through this table: a new setting is a
// member of Settings and a row of it.
#pragma once
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "src/base/names.h"
#include "src/base/parse.h"
#include "src/model/settings.h"

namespace dea {

/// What a setting holds, for those who show it. Nothing: it was not given.
using SettingItem =
    std::variant<std::monostate, bool, int, double, std::string, std::vector<std::string>, Eigen::Vector3d>;
/// The same by the name of a surface or body, where a setting is given per such.
using SettingContent = std::variant<SettingItem, std::map<std::string, SettingItem>>;

struct SettingOption {
  const char* name;        ///< "springs-at"
  const char* key;         ///< "surface", "body" or "name": what the value belongs to; nullptr: no key
  bool repeatable;         ///< may be given again without a key
  const char* value;       ///< form of the value: "curved|flat", "NUMBER"; "true|false" is a switch
  const char* help_value;  ///< what help calls the value; nullptr: `value`
  const char* group;       ///< options that stand together in help
  const char* help;        ///< {load-at}: another setting, which each front end words
  /// Throws BadValue. `text` is not empty; `key` is empty without one.
  void (*set)(Settings& settings, const std::string& key, const std::string& text);
  SettingContent (*content)(const Settings& settings);
  /// Numbers per surface that also may come without a key, for all surfaces (""); nullptr: the key is needed.
  std::map<std::string, double> Settings::*per_surface = nullptr;
  const char* help_off = nullptr;  ///< of a switch: what it does when it is off
  bool places = false;             ///< adds to Settings::placements, in the order in which it is given
};

/// In the order in which help lists them.
const std::vector<SettingOption>& setting_options();
/// nullptr: there is none of this name.
const SettingOption* find_setting_option(const std::string& name);
/// What these are called elsewhere.
Aliases setting_aliases();

/// What stands before the value: "SURFACE", "BODY", "NAME" or "NAME.PARAMETER". For options with a key.
std::string key_form(const SettingOption& option);
/// Its name in JSON and Python: "springs_at" for "springs-at".
std::string setting_keyword(std::string name);
/// What is typed behind its name: "[SURFACE=]LENGTH"
std::string value_form(const SettingOption& option);

/// As it is typed: "pelvis=0,1,0,10", "pelvis=frame:pelvis,0,0,1,10".
std::string placement_text(const Placement& placement);

/// One value as the user wrote it.
struct SettingValue {
  const SettingOption* option = nullptr;
  std::string key;  ///< "" without
  std::string value;
  std::string where;  ///< put before the fault: the setting as it was given
};

/// Sets one value. Throws BadValue.
void set_value(Settings& settings, const SettingValue& value);

/// Lays the values of one source over `settings` (those of weaker sources): they replace values with the same key; one
/// for all surfaces also replaces weaker ones for single surfaces. Throws BadValue ("WHERE: fault"), also when the
/// source contradicts itself.
void lay_over(Settings& settings, const std::vector<SettingValue>& values);

}  // namespace dea

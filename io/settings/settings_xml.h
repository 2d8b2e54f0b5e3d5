// febiodea/io/settings/settings_xml.h – settings as text: one value of an option, and the settings file that holds
// several. Command line and file share the options' names, their values and the words that refuse a bad one.
#pragma once
#include <stdexcept>
#include <string>
#include <vector>

#include <febiodea/model/settings.h>

namespace dea {

/// A value that cannot be used. what(): `found "1,2", expected three numbers x,y,z`. Who asked adds where.
struct BadValue : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// An option of Settings that takes a value. On the command line `--NAME VALUE` or `--NAME KEY=VALUE`, in the
/// settings file `<NAME>VALUE</NAME>` or `<NAME surface="KEY">VALUE</NAME>`.
struct SettingOption {
  const char* name;
  const char* key;    ///< "surface" or "body": what the value belongs to; nullptr: no key
  bool key_optional;  ///< without a key it holds for all surfaces
  bool repeatable;    ///< may be given again without a key
  const char* value;  ///< the value as help writes it
};
const std::vector<SettingOption>& setting_options();
/// nullptr: there is none of this name.
const SettingOption* find_setting_option(const std::string& name);

/// One value as the user wrote it.
struct SettingValue {
  const SettingOption* option = nullptr;
  std::string key;  ///< "" without
  std::string value;
  std::string where;  ///< put before the fault: "--E S=x"
};

/// "KEY=VALUE" or "VALUE" of the command line, cut at the last '=' (names may hold one, numbers cannot).
/// Throws BadValue where a needed key is missing.
SettingValue split_key(const SettingOption& option, const std::string& text);

/// Sets one value. Throws BadValue.
void set_value(Settings& settings, const SettingValue& value);

/// Lays the values of one source over `settings` (those of weaker sources): they replace values with the same key; one
/// for all surfaces also replaces weaker ones for single surfaces. Throws BadValue ("WHERE: fault"), also when the
/// source contradicts itself.
void lay_over(Settings& settings, const std::vector<SettingValue>& values);

/// What a settings file says of the files to write and the states in them; empty: nothing.
struct OutputSettings {
  std::string output, json, csv, facets_csv;
  std::string report;  ///< a page
  std::string vtu;     ///< a folder
  std::string states;  ///< all, last or times t1,t2,...
};

struct SettingsFile {
  Settings settings;
  OutputSettings outputs;
};

/// Reads a settings file (docs/settings.md). Throws InputError ("file:line: found ..., expected ...").
SettingsFile read_settings_file(const std::string& path);
Settings read_settings(const std::string& path);

/// Numbers as every option wants them: the whole text, finite, with a decimal point in any locale.
double parse_number(const std::string& text);
std::vector<double> parse_numbers(const std::string& text);  ///< separated by commas
int parse_count(const std::string& text, int least, int most);

}  // namespace dea

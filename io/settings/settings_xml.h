// io/settings/settings_xml.h – settings as text: one word of the command line, the settings file, and how a user types
// them there.
#pragma once
#include <string>

#include "io/settings/output_options.h"
#include "src/base/sentence.h"
#include "src/model/settings_table.h"

namespace dea {

/// "KEY=VALUE" or "VALUE" of the command line, cut at the last '=' (names may hold one, numbers cannot).
/// Throws BadValue where a needed key is missing.
SettingValue split_key(const SettingOption& option, const std::string& text);

struct SettingsFile {
  Settings settings;
  OutputSettings outputs;
};

/// Reads a settings file (docs/settings.md): `<NAME>VALUE</NAME>` or `<NAME surface="KEY">VALUE</NAME>` of every row of
/// setting_options and output_options. Throws InputError ("file:line: found ..., expected ...").
SettingsFile read_settings_file(const std::string& path);

/// `--thickness "knee=1.8"`; bare: `--thickness knee=1.8`
Wording command_line_wording();

/// `<thickness surface="knee">1.8</thickness>` (docs/settings.md)
Wording settings_file_wording();

}  // namespace dea

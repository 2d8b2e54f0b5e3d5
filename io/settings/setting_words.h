// io/settings/setting_words.h – settings as a user types them: on the command line, in a settings file.
#pragma once
#include "src/base/sentence.h"

namespace dea {

/// `--thickness "knee=1.8"`; bare: `--thickness knee=1.8`
Wording command_line_wording();

/// `<thickness surface="knee">1.8</thickness>` (docs/settings.md)
Wording settings_file_wording();

}  // namespace dea

#include "plugin/febio_wording.h"

#include <fmt/format.h>

#include "io/settings/settings_xml.h"

namespace dea {

Wording febio_wording() {
  return [](const NamedSetting& s) {
    if (s.parameter.empty()) return settings_file_wording()(s);
    const std::string start = "<" + s.parameter + ">";
    return s.value.empty() ? start : start + s.value + "</" + s.parameter + ">";
  };
}

std::string untested_line(const std::string& verified, const std::string& compiled) {
  if ((" " + verified + " ").find(" " + compiled + " ") != std::string::npos) return "";
  return fmt::format(
      "dea: this plugin was verified with FEBio {} and is compiled for {}; before you rely on it, compare it with dea "
      "run: febio4 -i M.feb -p task.xplt -task=dea; dea run M.feb -o run.xplt; dea compare task.xplt run.xplt\n",
      verified, compiled);
}

}  // namespace dea

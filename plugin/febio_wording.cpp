#include "plugin/febio_wording.h"

#include "io/settings/settings_xml.h"

namespace dea {

Wording febio_wording() {
  return [](const NamedSetting& s) {
    if (s.parameter.empty()) return settings_file_wording()(s);
    const std::string start = "<" + s.parameter + ">";
    return s.value.empty() ? start : start + s.value + "</" + s.parameter + ">";
  };
}

}  // namespace dea

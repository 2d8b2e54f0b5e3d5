// src/base/fault.h – a fault of the user as data, to be worded by each front end.
#pragma once
#include <optional>
#include <string>

#include "src/base/sentence.h"

namespace dea {

/// A reason for which something cannot be done.
struct Fault {
  std::string place = {};                  ///< file and line, "hip.feb:214"; empty: no one place
  std::optional<NamedSetting> given = {};  ///< in place of it: the setting that cannot be followed
  Sentence found = {};                     ///< what there is; ends in the mark that leads to `expected`: "...;"
  Sentence expected = {};                  ///< what is needed, what to do: its settings are remedies; may be empty
  bool operator==(const Fault&) const = default;
};

/// "hip.feb:214: what was found; what is expected".
std::string line(const Fault& fault, const Wording& wording = plain_wording());

}  // namespace dea

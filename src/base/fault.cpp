#include "src/base/fault.h"

namespace dea {

std::string line(const Fault& fault, const Wording& wording) {
  std::string before = fault.place;
  if (fault.given) {
    NamedSetting given = *fault.given;
    given.bare = true;
    before = wording(given);
  }
  if (!before.empty()) before += ": ";
  const std::string after = fault.expected.empty() ? "" : " " + worded(fault.expected, wording);
  return before + worded(fault.found, wording) + after;
}

}  // namespace dea

#include "app/build_names.h"

#include <fmt/format.h>

#include <algorithm>

#include "src/base/names.h"
#include "src/base/numbers.h"

namespace dea {

UsageError wrong(const std::string& option, const std::string& text, const std::string& found,
                 const std::string& expected) {
  return UsageError(fmt::format("--{} {}: found {}, expected {}", option, text, found, expected));
}

Named named(const char* option, const std::string& text, const char* form) {
  const std::size_t cut = text.find('=');
  const std::string name = trimmed(text.substr(0, cut));
  if (cut == std::string::npos || name.empty() || cut + 1 == text.size()) throw wrong_word(option, text, form);
  if (std::any_of(text.begin(), text.end(), [](char c) { return c >= 0 && c < ' '; }))
    throw UsageError(
        fmt::format("--{}: found a control character in the name, expected letters, digits, spaces", option));
  return {name, trimmed(text.substr(cut + 1))};
}

std::vector<std::string> bone_names(const BuildRequest& request) { return every_name(request.bones); }

int bone_of(const BuildRequest& request, const char* option, const std::string& name) {
  const std::vector<std::string> names = bone_names(request);
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw UsageError(fmt::format("--{} {}: no bone has this name{}; bones are {}", option, name,
                                 did_you_mean(name, names), name_list(names)));
  return static_cast<int>(found - names.begin());
}

void refuse_second(const char* option, const std::string& text, bool there) {
  if (there) throw wrong(option, text, "a second one for this bone", "one");
}

}  // namespace dea

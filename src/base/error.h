// src/base/error.h – the faults a user can cause. Our own faults are asserts.
#pragma once
#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "src/base/fault.h"

namespace dea {

/// A fault in what the user gave us (exit code 3). what() is its line, settings in plain words; line 0: unknown.
/// `others`: further faults of the same model; the command line counts them, `dea info` lists them.
struct InputError : std::runtime_error {
  Fault fault;
  std::vector<Fault> others;
  explicit InputError(Fault what_is_wrong) : std::runtime_error(line(what_is_wrong)), fault(std::move(what_is_wrong)) {}
  explicit InputError(const std::string& text) : InputError(Fault{.found = text}) {}
  InputError(const std::string& file, int line, const std::string& text)
      : InputError(Fault{.place = line > 0 ? file + ":" + std::to_string(line) : file, .found = text}) {}
};

/// All faults as one InputError; none: nothing happens.
inline void throw_if_any(const std::vector<Fault>& faults) {
  if (faults.empty()) return;
  InputError error(faults.front());
  error.others.assign(faults.begin() + 1, faults.end());
  throw error;
}

/// Adds those that are not there yet.
inline void add_once(std::vector<Fault>& faults, const std::vector<Fault>& more) {
  for (const Fault& fault : more)
    if (std::find(faults.begin(), faults.end(), fault) == faults.end()) faults.push_back(fault);
}
inline void add_once(std::vector<Fault>& faults, const InputError& error) {
  add_once(faults, std::vector<Fault>{error.fault});
  add_once(faults, error.others);
}

/// A fault in how the program was asked (exit code 2): an override that names nothing in the model.
struct UsageError : std::runtime_error {
  Fault fault;
  explicit UsageError(Fault what_is_wrong) : std::runtime_error(line(what_is_wrong)), fault(std::move(what_is_wrong)) {}
  explicit UsageError(const std::string& text) : UsageError(Fault{.found = text}) {}
};
/// The value of a setting, and what is wrong with it.
inline UsageError wrong_setting(const char* setting, const std::string& value, Sentence found, Sentence expected) {
  return UsageError(
      Fault{.given = NamedSetting{setting, "", value}, .found = std::move(found), .expected = std::move(expected)});
}

/// The output cannot be written (exit code 4).
struct WriteError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace dea

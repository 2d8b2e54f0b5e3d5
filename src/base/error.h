// febiodea/base/error.h – the faults a user can cause. Our own faults are asserts.
#pragma once
#include <stdexcept>
#include <string>
#include <vector>

namespace dea {

/// A fault in what the user gave us (exit code 3). what() is one line: "hip.feb:214: <fault>"; line 0: unknown.
/// `others`: further faults of the same model, a line each; the command line counts them, `dea info` lists them.
struct InputError : std::runtime_error {
  std::vector<std::string> others;
  std::string place;  ///< what what() begins with before ": ", if it is a place
  using std::runtime_error::runtime_error;
  InputError(const std::string& file, int line, const std::string& fault)
      : std::runtime_error(line > 0 ? file + ":" + std::to_string(line) + ": " + fault : file + ": " + fault),
        place(line > 0 ? file + ":" + std::to_string(line) : file) {}
};

/// A fault in how the program was asked (exit code 2): an override that names nothing in the model.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The output cannot be written (exit code 4).
struct WriteError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace dea

// app/findings.h – which findings a user wants to see, and which end a script: --quiet CODE, --error-on CODE.
#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "src/run/analysis.h"

namespace dea {

struct FindingsArguments {
  std::vector<std::string> quiet;     ///< codes; "true": -q by itself
  std::vector<std::string> error_on;  ///< codes, or "warning": any
};

/// -q, --quiet CODE and --error-on CODE.
void add_findings_options(CLI::App& command, FindingsArguments& arguments);

/// UsageError: a code that no rule has; -q by itself beside -v.
void check_codes(const FindingsArguments& arguments, bool verbose);
/// UsageError: --error-on names a code that is never a warning, and a study keeps warnings alone.
void check_warning_codes(const FindingsArguments& arguments);

/// -q by itself.
bool quiet_altogether(const FindingsArguments& arguments);

/// Prints them on standard error, but those that ask nobody to act and those whose codes are to be quiet.
void tell(const Findings& findings, const FindingsArguments& arguments);

/// What is printed even if nothing else is: loads without effect, and states that are no solution.
void tell_quietly(const Analysis& result);

/// The codes that --error-on may name for them.
std::vector<std::string> codes_of(const Findings& findings);
/// Does --error-on name one of them? Prints which.
bool tell_refused(const Findings& findings, const FindingsArguments& arguments);
/// The same of codes of warnings.
bool refused_codes(const std::vector<std::string>& codes, const FindingsArguments& arguments);

/// `--quiet CODE` in two words becomes `--quiet=CODE`; -q takes no code.
std::vector<std::string> with_joined_codes(const std::vector<std::string>& words);

}  // namespace dea

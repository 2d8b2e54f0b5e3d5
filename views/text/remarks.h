// views/text/remarks.h – what was concluded, left out or is doubtful, a line each, each once: "note: ...",
// "ignored: ...", "warning: ...".
#pragma once
#include <string>
#include <vector>

#include "io/settings/setting_words.h"
#include "src/run/analysis.h"

namespace dea {

/// Of a model that was recognised. Files (JSON, the page) have the words of the command line, whoever writes them.
std::vector<std::string> model_remarks(const JointModel& model, const Joint& joint,
                                       const Wording& wording = command_line_wording());
/// Of the states that were solved.
std::vector<std::string> result_remarks(const JointModel& model, const Joint& joint, const SolvedStates& result,
                                        const Wording& wording = command_line_wording());
std::vector<std::string> result_remarks(const JointModel& model, const Analysis& analysis,
                                        const Wording& wording = command_line_wording());
/// Both.
std::vector<std::string> run_remarks(const JointModel& model, const Analysis& analysis,
                                     const Wording& wording = command_line_wording());

/// The warnings among these lines, without "warning: ".
std::vector<std::string> warnings_in(const std::vector<std::string>& lines);

/// The states that are no solution, a line each, and how many they are; none: nothing.
std::vector<std::string> no_solution_lines(const Analysis& analysis, const Wording& wording = command_line_wording());

/// Loads that were asked for and have no effect, a line each: what is printed even if nothing else is.
std::vector<std::string> idle_load_lines(const SolvedStates& result, const Wording& wording = command_line_wording());

/// The sentence behind a state's outcome.
std::string outcome_text(const Equilibrium& e, const Wording& wording = command_line_wording());

}  // namespace dea

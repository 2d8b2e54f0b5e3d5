// febiodea/views/text/remarks.h – what was concluded, left out or is doubtful, a line each, each once: "note: ...",
// "ignored: ...", "warning: ...".
#pragma once
#include <string>
#include <vector>

#include <febiodea/run/analysis.h>

namespace dea {

/// Of a model that was recognised.
std::vector<std::string> model_remarks(const JointModel& model, const Joint& joint);
/// Of the states that were solved.
std::vector<std::string> result_remarks(const JointModel& model, const Analysis& analysis);
/// Both.
std::vector<std::string> run_remarks(const JointModel& model, const Analysis& analysis);

}  // namespace dea

// views/text/plausibility.h – numbers of a model that are no joint's: units mixed up, layers that are none.
#pragma once
#include <string>
#include <vector>

#include "io/settings/setting_words.h"
#include "src/joint/joint.h"

namespace dea {

/// "E = 1.2e+07 is ... MPa in the model's units, ...", if no cartilage has such a modulus in a system of units of
/// FEBio's ("mm-N-s"); else, and where nobody names one: "".
std::string odd_modulus(double E, const std::string& units);

/// "warning: ..." lines, each once; empty: nothing is odd. Where the model names its system of units (or the user
/// does), moduli and sizes are judged in it; else by how they go together.
std::vector<std::string> implausible_numbers(const JointModel& model, const Joint& joint, const Wording& wording);

}  // namespace dea

// views/text/methods_text.h – what dea run does with a model, as a paragraph for the methods of a paper.
#pragma once
#include <string>

#include "src/run/check.h"

namespace dea {

/// Sentences about bodies, cartilage, springs, loads, states and the numbers that are reported, each only where it
/// holds for this model with these settings; the settings given; and the papers they rest on. Lengths, pressures and
/// forces are the model's, with their units where these are known. `joint`: recognised, without errors. `febio`: the
/// program that wrote a result that is compared with ("FEBio 4.11.0"); empty: none. `bibtex`: the program and these
/// papers alone, as BibTeX.
std::string methods_text(const JointModel& model, const Settings& settings, const JointCheck& joint,
                         const std::string& febio, bool bibtex = false);

}  // namespace dea

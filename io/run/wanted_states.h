// io/run/wanted_states.h – the states that a run is asked for: of the model, or at the times of another result.
#pragma once
#include <string>

#include "io/settings/output_options.h"
#include "src/base/finding.h"
#include "src/run/states.h"

namespace dea {

/// The states that `outputs` ask for (none: all, or about 1000 of very many), and those on the way to them.
/// `times_from`: an FEA result whose times to take; "": the model's. Throws UsageError, InputError.
States wanted_states(const JointModel& model, const Settings& settings, const OutputSettings& outputs,
                     const std::string& times_from);

/// Are all states of the model wanted, however many these are?
bool wants_all_states(const OutputSettings& outputs, const std::string& times_from);

/// What the user should know of the states that are solved.
Findings findings_of_states(const JointModel& model, const OutputSettings& outputs, const std::string& times_from,
                            const States& states);

}  // namespace dea

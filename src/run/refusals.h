// febiodea/run/refusals.h – every reason for which a model is refused, not only the first that was met.
#pragma once
#include <string>
#include <vector>

#include <febiodea/base/error.h>
#include <febiodea/model/joint_model.h>
#include <febiodea/model/settings.h>

namespace dea {

/// One line each, "hip.feb:214: <what was found, what is expected, what to do>", the most basic first: no sliding
/// contact, no rigid body; then what is not supported, in the order of the file; then layers that cannot be
/// recognised, in the order of the contacts; then motions, loads and times. Empty: none is known before solving. What
/// could only be found once something else is mended is not in it. Throws UsageError as make_joint does.
/// `all_states`: every state of the model is wanted, so there must not be too many.
std::vector<std::string> refusals(const JointModel& model, const Settings& settings, bool all_states = true);

/// The same fault with all the others of the model: what() is the most basic one, `others` the rest. `found`: what was
/// met first, the answer if the others know of nothing. Throws UsageError as make_joint does.
InputError all_refusals(const JointModel& model, const Settings& settings, const InputError& found,
                        bool all_states = true);

/// A remark of `JointModel::unsupported` as lines, one per place that is known.
std::vector<std::string> unsupported_lines(const JointModel& model, const Remark& remark);

}  // namespace dea

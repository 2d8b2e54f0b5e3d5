// febiodea/run/idle_settings.h – settings that nothing uses.
#pragma once
#include <vector>

#include <febiodea/base/sentence.h>
#include <febiodea/joint/joint.h>

namespace dea {

/// A sentence each: of a surface that no solved contact has; points of turning (rotate-about) of a body that nothing
/// turns; frames that no setting names. Loads and their points are in idle_loads.h.
std::vector<Sentence> idle_settings(const JointModel& model, const Joint& joint, const Settings& settings);

}  // namespace dea

// src/rules/idle_settings.h – settings that nothing uses.
#pragma once
#include "src/base/finding.h"
#include "src/joint/joint.h"

namespace dea {

/// Of a surface that no sliding contact has; points of turning (rotate-about) of a body that nothing
/// turns. Not frames: a settings file has all of a bone's. Loads and their points are in idle_loads.h.
Findings idle_settings(const JointModel& model, const Joint& joint, const Settings& settings);

}  // namespace dea

// src/facts/left_out.h – deformable materials that the user leaves out of a model.
#pragma once
#include "src/base/finding.h"
#include "src/model/joint_model.h"
#include "src/model/settings.h"

namespace dea {

/// Takes the elements of Settings::leave_out out of the model, with what has to do with them alone: facets, contacts,
/// springs, held and loaded nodes. Its nodes stay where they are. Returns what was left out. UsageError: a name is no
/// deformable material.
Findings leave_out(JointModel& model, const Settings& settings);

}  // namespace dea

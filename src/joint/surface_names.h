// src/joint/surface_names.h – surfaces that settings call by what lies under them.
#pragma once
#include <vector>

#include "src/base/finding.h"
#include "src/base/sentence.h"
#include "src/model/joint_model.h"
#include "src/model/settings.h"

namespace dea {

/// Settings that call surfaces by their own names. Where one names no surface, but a material, an element set or a body
/// that has exactly one articular surface (side of a sliding contact), that surface is meant, and `findings` say so;
/// other names stay as they are. Throws UsageError: several surfaces may be meant, or the one that is meant is given
/// too.
Settings name_surfaces(const JointModel& model, const Settings& settings, Findings& findings);

}  // namespace dea

// src/equilibrium/rows.h – what tables of loads and motion say, checked and in words.
#pragma once
#include <vector>

#include "src/base/finding.h"
#include "src/joint/joint.h"

namespace dea {

/// Tables that do not fit each other, the joint or the other settings: UsageError.
void check_rows(const JointModel& model, const Joint& joint, const Settings& settings);

/// How tables were taken, a sentence each; of loads also the first row in global axes.
Findings row_findings(const JointModel& model, const Joint& joint, const Settings& settings);

/// That the matrices of a table of motion may be in metres; none where it has no doubt. `give`: what names their unit.
Findings matrix_units(const MotionTable& motion, const NamedSetting& give);

/// Steps that seem to serve finite elements alone, as they bring bodies into contact by a motion that a later step lets
/// go: they can be skipped. Empty: none.
Findings seating_steps(const JointModel& model, const Joint& joint, const Settings& settings);

}  // namespace dea

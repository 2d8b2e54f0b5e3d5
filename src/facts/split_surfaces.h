// src/facts/split_surfaces.h – contact surfaces that lie on parts that give way and on others.
#pragma once
#include "src/base/finding.h"
#include "src/model/joint_model.h"
#include "src/model/settings.h"

namespace dea {

/// Divides such a surface: its facets on a part become a surface of their own, "socket: labrum", with a contact of
/// their own for each contact of the surface; it keeps the others. Returns what was divided; empty: nothing, and the
/// model is as it was. The mesh must be sound.
Findings split_surfaces(JointModel& model, const Settings& settings);

}  // namespace dea

// src/springs/press.h – what the springs of a contact do at a pose of its two bodies.
#pragma once
#include <vector>

#include "src/springs/layer_bed.h"
#include "src/springs/springs.h"

namespace dea {

/// Gaps, pressures and their derivatives at a pose (S1-S5, E2-E4; law layer: L1-L11). Pure: a bed may be pressed by
/// several callers at a time, each with a memory of its own. `memory`: where the search for pressures starts, and what
/// the next may start from; nullptr: from nothing. The result does not depend on the number of threads. Stopped:
/// options.stop was set; `memory` is as it was.
SpringStates press_springs(const SpringBed& bed, const Pose& source, const Pose& target,
                           const PressOptions& options = {}, PressMemory* memory = nullptr);

/// The same of contacts whose layers other contacts of them press too: one problem. `options.motions`: not read, each
/// bed has its own. Of a bed that is not active: an empty state.
std::vector<SpringStates> press_together(const std::vector<PosedBed>& beds, const PressOptions& options = {},
                                         PressMemory* memory = nullptr);

}  // namespace dea

// src/facts/find_parts.h – finds the parts of a model.
#pragma once
#include "src/facts/parts.h"

namespace dea {

/// Throws UsageError for a material to be taken as rigid that is none.
ModelParts find_parts(const JointModel& model, const Settings& settings);

}  // namespace dea

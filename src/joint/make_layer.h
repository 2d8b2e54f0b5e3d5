// src/joint/make_layer.h – recognition of one layer (docs/theory.md, section 2).
#pragma once
#include <vector>

#include "src/base/fault.h"
#include "src/facts/parts.h"
#include "src/joint/layer.h"

namespace dea {

struct LayerFound {
  Layer layer;
  std::vector<Fault> faults;  ///< not empty: there is no layer; what else is known to be missing follows the first
};

/// The layer under one surface of a contact that has both: 0: primary, 1: secondary. Throws UsageError for a setting
/// of this surface that cannot be followed.
LayerFound make_layer(const ModelParts& parts, const Contact& contact, int side);

}  // namespace dea

// src/joint/make_layer.h – recognition of one layer (docs/theory.md, section 2).
#pragma once
#include "src/facts/parts.h"
#include "src/joint/layer.h"

namespace dea {

/// The layer under one surface of a contact that has both: 0: primary, 1: secondary. InputError: there is none; what
/// else is known to be missing follows the first fault. Throws UsageError for a setting of this surface that cannot be
/// followed.
Layer make_layer(const ModelParts& parts, const Contact& contact, int side);

}  // namespace dea

// src/facts/separate_pieces.h – bones that a material taken as rigid would make one body of.
#pragma once
#include <vector>

#include "src/base/fault.h"
#include "src/facts/parts.h"

namespace dea {

/// A fault for each body that the user takes as rigid and that is several bones in the model: pieces without a common
/// node, of which more than one has something to do with the rest (cartilage, a contact, a load, a spring, a hold), and
/// are not all held or moved in every step by their nodes or by a rigid body of the model. FEBio moves each by itself.
std::vector<Fault> separate_pieces(const ModelParts& parts);

}  // namespace dea

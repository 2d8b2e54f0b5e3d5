// src/facts/soft_regions.h – which deformable regions are parts of their own (menisci, discs, labra), no layers on
// bone.
#pragma once
#include "src/facts/parts.h"

namespace dea {

/// Finds ModelParts::soft. Named by the user; or pressed by two contacts or more and held by nothing at all; or held by
/// nodes that lie behind less than half of what is pressed of it, as a meniscus is by its horns, a labrum by the rim:
/// no layer on a bone. Of a region with several materials one may be a part and the rest a layer: nodes of the part
/// alone get a region of their own, those between both are the layer's. Bodies of those that are free are put before
/// the ground: then holders must be found anew. Throws UsageError for a name that is no deformable material.
void find_soft_regions(ModelParts& parts);

}  // namespace dea

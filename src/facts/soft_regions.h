// src/facts/soft_regions.h – which deformable regions are parts of their own (menisci, discs, labra), no layers on
// bone.
#pragma once
#include <string>
#include <vector>

#include "src/model/joint_model.h"

namespace dea {

/// A deformable region that gives way as its elements do.
struct SoftRegion {
  int region = -1;       ///< its root node; beyond all nodes: it shares nodes with a layer
  int within = -1;       ///< the root node of both
  std::string material;  ///< that most of its elements have
  std::string name;   ///< the material's; of several parts of one material that of the elements, or another of its own
  int body = -1;      ///< index into Bodies::bodies: what holds it; where nothing does, a body of its own
  int other = -1;     ///< a second body that holds it, -1: none
  bool free = false;  ///< nothing holds it
  double volume = 0.0;                 ///< of a free one
  Vector3d center = Vector3d::Zero();  ///< of a free one: of its volume
  int form = 0;                        ///< how it was told: of the rule `part-recognised`
};

struct ModelParts;

/// Finds ModelParts::soft. Named by the user; or pressed by two contacts or more and held by nothing at all; or held by
/// nodes that lie behind less than half of what is pressed of it, as a meniscus is by its horns, a labrum by the rim:
/// no layer on a bone. Of a region with several materials one may be a part and the rest a layer: nodes of the part
/// alone get a region of their own, those between both are the layer's. Bodies of those that are free are put before
/// the ground: then holders must be found anew. Throws UsageError for a name that is no deformable material.
void find_soft_regions(ModelParts& parts);

}  // namespace dea

// src/facts/soft_regions.h – which deformable regions are parts of their own (menisci, discs, labra), no layers on
// bone.
#pragma once
#include <string>
#include <vector>

#include "src/facts/bodies.h"
#include "src/facts/holders.h"
#include "src/model/joint_model.h"
#include "src/model/settings.h"

namespace dea {

/// A deformable region that gives way as its elements do.
struct SoftRegion {
  int region = -1;       ///< its root node
  std::string material;  ///< that most of its elements have
  std::string name;   ///< the material's; of several parts of one material that of the elements, or another of its own
  int body = -1;      ///< index into Bodies::bodies: what holds it; where nothing does, a body of its own
  int other = -1;     ///< a second body that holds it, -1: none
  bool free = false;  ///< nothing holds it
  int form = 0;       ///< how it was told: of the rule `part-recognised`
};

/// Named by the user; or pressed on two surfaces or more and held by nothing at all, or by nodes that lie behind less
/// than half of what is pressed of it, as a meniscus is by its horns: no layer on a bone. Bodies of those that are free
/// are put before the ground: then `holders` must be found anew. Throws UsageError for a name that is no deformable
/// material.
std::vector<SoftRegion> find_soft_regions(const JointModel& model, const Settings& settings,
                                          const std::vector<char>& rigid, const std::vector<int>& region,
                                          const Holders& holders, Bodies& bodies);

}  // namespace dea

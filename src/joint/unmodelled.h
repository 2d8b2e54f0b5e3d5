// src/joint/unmodelled.h – deformable parts between bodies of which nothing is made.
#pragma once
#include <string>
#include <vector>

#include "src/facts/conditions.h"
#include "src/facts/parts.h"
#include "src/joint/contacts.h"

namespace dea {

/// Ligaments, discs, capsules of solids, shells or trusses, no layer of a contact: fastened to two bodies or more, or
/// to one that can move and to the ground in some components.
struct UnmodelledPart {
  std::vector<std::string> names;  ///< of the domains
  int elements = 0;
  std::vector<int> bodies;  ///< rising; what the parts are fastened to: all of them to the same bodies
  unsigned held = 0;        ///< of one body: bit k set, nodes are held by the ground in component k, not in all
};
std::vector<UnmodelledPart> find_unmodelled_parts(const ModelParts& parts, const Conditions& conditions,
                                                  const std::vector<ContactPair>& contacts);

/// A tied contact, or a rigid node set, that fastens what stands apart for DEA.
struct DroppedTie {
  std::string name;         ///< "contact \"tie\"", "rigid node set \"set\""
  std::vector<int> bodies;  ///< two rigid bodies; or one: two pieces of cartilage on it, side by side
};
std::vector<DroppedTie> find_dropped_ties(const ModelParts& parts, const Conditions& conditions);

}  // namespace dea

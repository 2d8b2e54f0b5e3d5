// src/joint/unmodelled.h – deformable parts between bodies of which nothing is made.
#pragma once
#include <vector>

#include "src/base/finding.h"
#include "src/facts/conditions.h"
#include "src/facts/parts.h"
#include "src/joint/contacts.h"

namespace dea {

/// Ligaments, discs, capsules of solids, shells or trusses, no layer of a contact: fastened to two bodies or more, or
/// to one that can move and to the ground in some components (part-not-modelled, one finding for all that join the
/// same).
Findings unmodelled_parts(const ModelParts& parts, const Conditions& conditions,
                          const std::vector<ContactPair>& contacts);

/// Tied contacts, and rigid node sets, that fasten what stands apart for DEA: two rigid bodies of which one can move
/// (tie-left-out), or two pieces of cartilage on one body, side by side (pieces-side-by-side).
Findings dropped_ties(const ModelParts& parts, const Conditions& conditions);

}  // namespace dea

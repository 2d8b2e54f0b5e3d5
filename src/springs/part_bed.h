// src/springs/part_bed.h – deformable parts under the springs of contacts: where their surfaces have moved, what feet
// press on them (P1)-(P4).
#pragma once
#include <map>
#include <memory>
#include <vector>

#include "src/springs/posed_bed.h"

namespace dea {

/// The operator of a part of the joint.
std::shared_ptr<const PartOperator> make_part(const Joint& joint, const SoftPart& part);

/// What joins a part to the second body that holds it (P3): springs so stiff that what they give is nothing beside the
/// part, along all axes at nodes far apart. None where one body holds it. Its frame's end is the source.
std::vector<PartTie> part_holds(const SoftPart& part, const PartOperator& made);

/// How the nodes of parts have moved, nodes x 3, in their frames; a part that is not there has not moved.
using PartMotions = std::map<const PartOperator*, Eigen::MatrixX3d>;

/// Parts, each once: of a bed's source and target, of all beds.
std::vector<const PartOperator*> parts_of(const SpringBed& bed);
std::vector<const PartOperator*> parts_of(const std::vector<PosedBed>& beds);

/// What the ties of a bed do at a pose, as springs: `direction` from the target's end to the source's, `gap` minus what
/// would be their elongation if they were straight lines through their tension and slope here; overlaps and pressures
/// are zero.
SpringStates tie_states(const SpringBed& bed, const Pose& source, const Pose& target, const TieLaw& law);

/// Appends a foot for each spring of a bed, with_parts_moved, to those on one of its parts; nothing where it does not
/// press that part. Without columns (set_reach).
void add_feet(const SpringBed& bed, const SpringStates& states, const Pose& source, const Pose& target,
              const PartOperator& part, PartFeet& feet);

/// Of a half-space's own compliance under a foot, what two feet side by side resist each other (P4): enough for
/// pressures without a checkerboard, too little to be seen in any of them.
inline constexpr double kPairCompliance = 0.1;

/// Neighbours among the springs of a bed that has parts and no layer on either side (P4).
std::vector<FootPair> foot_pairs(const Springs& springs, const LayerBed& layers);

}  // namespace dea

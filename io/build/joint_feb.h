// io/build/joint_feb.h – a joint made of surfaces, as a model file that FEBio and dea solve.
#pragma once
#include <string>

#include "src/build/built_joint.h"

namespace dea {

/// FEBio 4.0: prisms of neo-Hookean cartilage, rigid bones as triangle shells that share the cartilage's nodes,
/// sliding-elastic contacts, ligaments as nonlinear springs, a step that moves the free dofs by settings.seat and one
/// that loads them (times 0 to 1 and 1 to 2; with several loads on until 1 + their number, load i, counted from 0, at
/// time 2 + i). Motion: in all steps, from the pose as built to the first row's at time 1, row i's at time 2 + i.
/// A body's rotations are all free or held, or all moved or held: FEBio mixes no free with moved ones. Numbers
/// round-trip.
std::string joint_feb(const BuiltJoint& joint, const BuiltModelSettings& settings);

}  // namespace dea

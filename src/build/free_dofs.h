// src/build/free_dofs.h – in which dofs the bones of a joint are free, where nobody says so.
#pragma once
#include "src/build/build_joint.h"

namespace dea {

/// For each loaded bone that the request leaves open (dofs_given):
///   two compartments, and ligaments   all but flexion, the turn about the global axis that is nearest to the line
///                                     through both compartments
///   a ball, and everything else       x, y, z
/// less what the request holds. Tells what each bone that is not held as a whole is free to do, and why.
void choose_dofs(const BuildRequest& request, BuiltJoint& joint, BuildReport& report);

/// Motions that turn a bone about the global origin become those of its centre.
void count_motion_from_centers(BuiltJoint& joint);

/// "x, y, Ru"; "none".
std::string dof_names(const DofFlags& flags);

}  // namespace dea

// src/equilibrium/separation.h – whether a contact could carry the load at all at a pose (E8).
#pragma once
#include "src/equilibrium/forces.h"

namespace dea {

/// Where pressures on the surfaces, however they were spread, could not balance the load at this pose: how much of the
/// load is left at best, and whether the motion that then follows opens the contact (E8).
struct Separation {
  double left = 0.0;     ///< of what is to be balanced
  double opening = 0.0;  ///< mean over the springs of the cosine between that motion and the spring's push
};
Separation separation(const Problem& problem, const Evaluation& e);

/// Whether any spring finds the opposite surface at this pose.
bool any_faces(const Evaluation& e);

/// Whether pressures at this pose could balance the opposite load: the load's sign may be wrong then.
bool opposite_load_presses(const Problem& problem, const Evaluation& e);

}  // namespace dea

// src/springs/wrench.h – force and moment of a contact on its two bodies, and their derivative (E1-E5).
#pragma once
#include <array>
#include <vector>

#include "src/springs/springs.h"

namespace dea {

/// Force and moment of the contact on target and source, about their current centres of mass, and their
/// derivative with respect to small motions of both.
struct ContactWrench {
  /// By small motions of the bodies of another contact that presses the same layer.
  struct Cross {
    BodyPair bodies;
    Matrix12 derivative = Matrix12::Zero();  ///< rows: this contact's target and source; columns: the other's
  };
  Vector12 wrench = Vector12::Zero();
  Matrix12 derivative = Matrix12::Zero();
  double normal_force = 0.0;  ///< sum of p A: the scale of the contact's forces
  std::vector<Cross> cross;
};
ContactWrench contact_wrench(const SpringStates& states, const Pose& source, const Pose& target);

/// Of ties: only how their tensions change with the bodies' motions, through what gives way; their own lines are
/// body_forces.h's.
ContactWrench tie_rates(const SpringStates& states, const Pose& source, const Pose& target);

/// A unit force along n at x on the target, and its opposite on the source; also how a length along n at x changes with
/// small motions of both.
inline Vector12 unit_wrench(const Vector3d& x, const Vector3d& n, const Pose& source, const Pose& target) {
  Vector12 w;
  w << n, (x - target.center).cross(n), -n, -(x - source.center).cross(n);
  return w;
}

/// For surfaces apart, whose springs give Newton's method nothing to go by: a stiffness K (12x12, positive
/// semidefinite, order of ContactWrench) under which `force` closes the gap in one step, K u = force with u the motion
/// to just beyond first touch. It is that of all springs facing the target, taken as touching, divided by the way
/// there; `force`: on target and source; `free`: of the 12 dofs, those that can move. Zero if no spring faces anything.
Matrix12 closing_stiffness(const SpringBed& bed, const SpringStates& states, const Pose& source, const Pose& target,
                           const Vector12& force, const std::array<bool, 12>& free);

/// How many ways there are to move the bodies against each other, 0 to 6. `free`: of the 12 dofs, those that can move.
int free_motions(const Pose& source, const Pose& target, const std::array<bool, 12>& free);

/// How many of the free motions of both bodies press or relieve springs that carry pressure: 0 to 6, those with a
/// stiffness above 1e-2 of the largest. Little or nothing in the contact resists the others: along them even a small
/// load goes far. `free`: of the 12 dofs, those that can move.
int resisted_motions(const SpringStates& states, const Pose& source, const Pose& target,
                     const std::array<bool, 12>& free);

/// Of a force on target and source: its part along the mean direction of the springs that face the target. > 0: it
/// opens the joint, < 0: it closes it.
double opening_part(const SpringStates& states, const Vector12& force, const std::array<bool, 12>& free);

}  // namespace dea

// src/equilibrium/load_case.h – what holds, moves and loads the bodies at one time.
#pragma once
#include <array>
#include <vector>

#include "src/geometry/pose.h"
#include "src/joint/joint.h"

namespace dea {

/// A force at a point of a body.
struct PointForce {
  Vector3d arm = Vector3d::Zero();    ///< from the centre of mass, reference directions; turns with the body
  Vector3d force = Vector3d::Zero();  ///< global directions; `turns`: reference directions
  bool turns = false;                 ///< the vector turns with the body
};

/// A point of a body that stays where it is in one component: e_k . (centre + R arm) = place.
struct HeldPoint {
  int component = 0;
  Vector3d arm = Vector3d::Zero();  ///< from the centre of mass, reference directions
  double place = 0.0;
};

struct BodyConditions {
  std::array<DofState, kDofs> dofs = {};  ///< all Free
  Vector6 value = Vector6::Zero();        ///< prescribed: translation of the centre of mass, rotation vector [rad]
  std::array<bool, kDofs> relative = {};  ///< prescribed from the pose at the start of the step
  std::vector<HeldPoint> held_points;     ///< hold what the dofs alone do not: a hinge, a pin, a guided end
  Vector6 dead = Vector6::Zero();         ///< force and moment with fixed directions
  Vector6 follower = Vector6::Zero();     ///< force that turns with the body (reference directions)
  Vector3d arm = Vector3d::Zero();        ///< where the force acts, from the centre of mass (turns with the body)
  std::vector<PointForce> point_forces;   ///< forces that have points of their own
  bool on_reaction = false;  ///< the reaction when the step began is part of `dead`, or would be if it were known
};

struct LoadCase {
  double time = 0.0;
  int step = 0;
  std::vector<Pose> start;                                 ///< where each body begins, and given motions count from
  std::vector<BodyConditions> bodies;                      ///< one per body of the joint
  std::vector<char> contact_active;                        ///< one per contact
  std::vector<char> ligament_active;                       ///< one per ligament
  std::vector<double> ligament_scale;                      ///< one per ligament: value of Ligament::scale
  std::vector<double> cable_force;                         ///< one per cable; 0 where it is not active
  std::vector<char> connector_active;                      ///< one per connector
  std::vector<std::array<double, kDofs>> connector_value;  ///< one per connector: motions, forces and moments
};

/// Conditions at `time` in `step`, overrides of the settings included:
///   free: of the dofs that are not prescribed, these are free and the others held, in every step
///   force: takes the place of all forces (not moments) that the model puts on the body, rigid, following or nodal,
///   growing from 0 to its value over the last step
///   load_at: where the force acts
///   placements: where bodies start (starting_poses)
/// `reaction`: per body, Equilibrium::reaction when the step began, for loads of kind Target and relative ones of this
/// step; nullptr: none (0), as FEBio has it in the first step.
/// Throws InputError where rotations are prescribed in part.
LoadCase make_load_case(const JointModel& model, const Joint& joint, const Settings& settings, int step, double time,
                        const std::vector<Vector6>* reaction = nullptr);

/// Where the bodies are that a load case moves; the others where they are `now`. `step_start`: when the step began, for
/// relative motions.
std::vector<Pose> prescribed_poses(const Joint& joint, const LoadCase& load_case, const std::vector<Pose>& now,
                                   const std::vector<Pose>& step_start);

/// Whether all bodies are where prescribed_poses puts them: none is free to move, no connector or held point is to be
/// closed.
bool motion_is_given(const LoadCase& load_case);

/// Whether some step's loads start from the reaction at the end of the one before.
bool any_starts_at_reaction(const JointModel& model);

/// A row of settings.loads and settings.motion: conditions at the end of the model's last step, but for what the row
/// says. Its force and moment replace all that the model puts on that body; its pose takes the place of what the model
/// says of those dofs. `now`: current poses, for a frame whose body is held where it is; `step_start`: as in
/// prescribed_poses, for one that is moved. Throws UsageError where that body is free to turn and not the loaded one:
/// its axes would turn while balance is sought.
LoadCase make_row_case(const JointModel& model, const Joint& joint, const Settings& settings, int row,
                       const std::vector<Pose>& now, const std::vector<Pose>& step_start,
                       const std::vector<Vector6>* reaction = nullptr);

/// Reference coordinates where the force on a body acts by settings.load_at; for sphere-center the fit is returned
/// too (through the body's articular surface of the first contact that has it).
struct LoadPointFound {
  Vector3d point = Vector3d::Zero();
  bool fitted = false;
  SphereFit fit;
};
LoadPointFound find_load_point(const Joint& joint, int body, const LoadPoint& asked);

}  // namespace dea

// src/run/prepared.h – a joint made ready once, to serve any number of load cases and poses.
//
//   const Prepared joint = prepare(recognise(model, settings));
//   const LoadCase loads = make_load_case(model, joint.joint, settings, 0, 1.0);
//   const Equilibrium balance = solve(joint, loads, at_rest(joint));
//   const Pressed pressed = press(joint, balance.poses);
//
// Frame: global. Units: the model's own. A Prepared never changes: several threads may use one at a time, each with a
// memory of its own, and the same arguments give the same bits.
#pragma once
#include <vector>

#include "src/equilibrium/equilibrium.h"
#include "src/run/recognise.h"

namespace dea {

struct Prepared {
  Joint joint;      ///< as recognised
  SpringBeds beds;  ///< one bed per contact; law layer: the layers factorised
};
/// Places the springs of every contact and factorises its layers. InputError: the recognition has faults. Stopped:
/// `stop` was set (looked at between contacts).
Prepared prepare(const Recognition& recognition, const StopFlag* stop = nullptr);
Prepared prepare(Recognition&& recognition, const StopFlag* stop = nullptr);  ///< takes the joint out of it

/// Where a solution starts, one pose per body of the joint each.
struct Start {
  std::vector<Pose> poses;
  std::vector<Pose> step_poses;  ///< when the step began: what relative motions count from
};
/// All bodies in their reference positions.
Start at_rest(const Prepared& prepared);
/// All bodies where settings.placements put them.
Start at_start(const Recognition& recognition);

/// `placed`, but in the dofs that are free to move `free`.
Pose free_part(const BodyConditions& body, const Pose& placed, const Pose& free);

/// The pose at which one load case balances (E1), searched from `start`; a motion that is given in full is followed
/// without a search. A load that cannot be carried is an outcome. `memory`: where searches for pressures start, and
/// where the next may start (law layer; only the time changes with it, and results in the last digits of their
/// tolerance); nullptr: from nothing. InputError: a ligament's force is undefined where it starts. Stopped:
/// options.stop was set.
Equilibrium solve(const Prepared& prepared, const LoadCase& load_case, const Start& start,
                  const EquilibriumOptions& options = {}, std::vector<PressMemory>* memory = nullptr);

/// What a contact does at given poses.
struct PressedSprings {
  SpringStates springs;                  ///< one entry per spring: gap, pressure, area, foot, direction, ...
  Vector6 on_target = Vector6::Zero();   ///< force and moment about the target's current centre of mass: force = sum
                                         ///  of pressure times area times direction (S8, E1)
  Vector6 on_source = Vector6::Zero();   ///< the opposite force at the same points; moment about the source's centre
  Matrix6 derivative = Matrix6::Zero();  ///< of on_target (rows: force, moment) by small motions of the target
                                         ///  (columns: translation of its centre of mass, rotation, along global
                                         ///  axes), the source held (E2-E5; law layer: and what touches)
  double normal_force = 0.0;             ///< sum of pressure times area
};
struct Pressed {
  std::vector<PressedSprings> contacts;  ///< one per contact of the joint, whatever step it acts in
  std::vector<Vector6> on_body;  ///< per body: force and moment of all contacts about its current centre of mass
};
/// All contacts at given poses (one per body), without a search for the poses. Contacts that press one layer are
/// pressed together if they act at the same time; one that acts in all steps, with those of the last of them. Bodies
/// that pass through each other are no fault: the springs' strain and `too_deep` tell. `memory`: as in solve.
/// `ligaments`: those on deformable parts pull as in this load case. Stopped: options.stop was set. UsageError: there
/// are such ligaments, and no load case.
Pressed press(const Prepared& prepared, const std::vector<Pose>& poses, const PressOptions& options = {},
              std::vector<PressMemory>* memory = nullptr, const LoadCase* ligaments = nullptr);

/// Where partners press one place of a layer at once: more than kMostTwice means that the pressures mean nothing.
PressedTwice pressed_twice(const Prepared& prepared, const Pressed& pressed, const std::vector<Pose>& poses);

}  // namespace dea

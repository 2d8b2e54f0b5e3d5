// src/equilibrium/spring_beds.h – the beds of all contacts of a joint, ready for any load case.
#pragma once
#include <vector>

#include "src/joint/joint.h"
#include "src/springs/press.h"
#include "src/springs/wrench.h"

namespace dea {

/// The beds of all contacts of a joint, and lengths that scale its unknowns.
struct SpringBeds {
  std::vector<SpringBed> beds;  ///< one per contact
  /// Contacts that are pressed together, for they share layers (Law::Layer); each contact in one. In an order that does
  /// not depend on that of the contacts.
  std::vector<std::vector<int>> groups;
  std::vector<SpringBed> ties;               ///< ligaments that have to do with parts, by the bodies they join
  std::vector<std::vector<int>> group_ties;  ///< per group: those of `ties` that its parts have to do with
  double length = 1.0;           ///< radius of gyration of the articular surfaces: scales moments and rotations
  double reach = 1.0;            ///< largest distance of an articular vertex from its body's centre of mass
  double stiffest = 0.0;         ///< stiffest_layer
  double least_thickness = 1.0;  ///< of the layers
  double longest_step = 0.5;     ///< a pose step moves no surface by more
};
/// `stop`: looked at between the contacts; throws Stopped.
SpringBeds make_spring_beds(const Joint& joint, const StopFlag* stop = nullptr);

/// What a load is measured against: modulus times area of the stiffest layer.
double stiffest_layer(const Joint& joint);

/// What springs and ligaments do at one set of poses.
struct PosedSprings {
  std::vector<Pose> poses;                 ///< one per body
  std::vector<SpringStates> springs;       ///< one per contact; empty states where the contact is not active
  std::vector<Vector6> contact_on_target;  ///< per contact: force and moment about the target's current centre of mass
  std::vector<double> ligament_force;      ///< per ligament, tension > 0
  double load = 0.0;  ///< scale of all forces, which residuals are measured against: the largest of external, ligament,
                      ///< contact
};

/// One contact at a pose: its springs, and their force and moment on its two bodies.
struct PressedContact {
  SpringStates springs;
  ContactWrench wrench;
};
/// All contacts of a group. `poses`: one per body of the joint. `motions`, `active`: per contact of the joint.
/// `options.motions` is not read. `memory`: as in press_springs. One result per contact of the group; empty states
/// where the contact is not active. `law`: of the ligaments; those of the group's ties come behind the contacts,
/// without a wrench (tie_rates); empty: they do not act.
std::vector<PressedContact> press_group(const SpringBeds& beds, const std::vector<int>& group,
                                        const std::vector<Pose>& poses, const std::vector<Motions>& motions,
                                        const std::vector<char>& active, const PressOptions& options = {},
                                        PressMemory* memory = nullptr, const TieLaw& law = {});

/// Where several contacts press one place of a shared layer at once: their partners run through each other there.
struct PressedTwice {
  double force = 0.0;  ///< of all of them there, sum of p A
  double area = 0.0;
  double share = 0.0;         ///< of the force on the layer
  std::vector<int> contacts;  ///< that press there, ascending
};
/// The layer with the greatest share. A place is counted by its triangles: as much of each as the parts that the
/// contacts press are larger together than the triangle. `springs`: per contact; empty: it does not act.
PressedTwice pressed_twice(const Joint& joint, const SpringBeds& beds, const std::vector<SpringStates>& springs,
                           const std::vector<Pose>& poses);
/// A state with more than this share is no solution: loads are counted twice.
inline constexpr double kMostTwice = 0.01;

}  // namespace dea

// src/equilibrium/spring_beds.h – the beds of all contacts of a joint, ready for any load case.
#pragma once
#include <vector>

#include "src/joint/joint.h"
#include "src/springs/springs.h"
#include "src/springs/wrench.h"

namespace dea {

/// The beds of all contacts of a joint, and lengths that scale its unknowns.
struct SpringBeds {
  std::vector<SpringBed> beds;   ///< one per contact
  double length = 1.0;           ///< radius of gyration of the articular surfaces: scales moments and rotations
  double reach = 1.0;            ///< largest distance of an articular vertex from its body's centre of mass
  double least_thickness = 1.0;  ///< of the layers: a pose step moves no surface by more than half of it
};
/// `stop`: looked at between the contacts; throws Stopped.
SpringBeds make_spring_beds(const Joint& joint, const StopFlag* stop = nullptr);

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
/// `poses`: one per body of the joint. `memory`: as in press_springs.
PressedContact press_contact(const SpringBed& bed, const std::vector<Pose>& poses, const PressOptions& options = {},
                             PressMemory* memory = nullptr);

}  // namespace dea

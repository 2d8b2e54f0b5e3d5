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

/// One contact at a pose: its springs, and their force and moment on its two bodies.
struct PressedContact {
  SpringStates springs;
  ContactWrench wrench;
};
/// `poses`: one per body of the joint. `memory`: as in press_springs.
PressedContact press_contact(const SpringBed& bed, const std::vector<Pose>& poses, const PressOptions& options = {},
                             PressMemory* memory = nullptr);

}  // namespace dea

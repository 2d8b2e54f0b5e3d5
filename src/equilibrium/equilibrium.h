// src/equilibrium/equilibrium.h – the pose at which springs, ligaments and loads balance.
#pragma once
#include <string>
#include <vector>

#include "src/equilibrium/body_forces.h"
#include "src/equilibrium/load_case.h"
#include "src/equilibrium/search.h"
#include "src/equilibrium/spring_beds.h"
#include "src/joint/placing.h"

namespace dea {

struct Equilibrium : SearchEnd, PosedSprings {
  std::vector<Vector6> reaction;    ///< per body: force and moment on it by what loads and holds it, = minus those of
                                    ///  contacts, ligaments, cables and connectors: FEBio's `rigid force` and
                                    ///  `rigid torque`
  std::vector<double> cable_force;  ///< per cable, tension
  std::vector<Vector6> connector_force;  ///< per connector: force and moment on B about its current point on B, global;
                                         ///  least squares where conditions are redundant; NaN: neither body can move
  std::vector<Vector6> connector_motion;  ///< per connector: of B as seen from A (connectors.h)
  double residual_force = 0.0;            ///< over free dofs; NaN: no free translation
  double residual_moment = 0.0;           ///< over free dofs; NaN: no free rotation
  int casts = 0;                          ///< how often all rays were cast
  std::vector<std::string> held;          ///< flat directions that were held, in words
  double least_stiffness =
      0.0;                ///< least eigenvalue of the symmetric part of the stiffness (translations and rotations
                          ///  times length), flat directions left out; NaN: nothing free
  bool unstable = false;  ///< solved, and the bodies leave this balance when touched (E6b)
};

/// Solves one load case from `start` (docs/theory.md, section 4). `step_start`: poses when the step began (for relative
/// motions). `memory`: per group of contacts (SpringBeds), where searches for pressures start and where the next may
/// start; nullptr: from nothing. The same arguments give the same bits, whoever solved what before or does at the same
/// time. Never throws for a load that cannot be carried: that is an outcome. InputError: a ligament's force is
/// undefined where it starts. Stopped: options.stop was set.
Equilibrium solve_equilibrium(const Joint& joint, const SpringBeds& beds, const LoadCase& load_case,
                              const std::vector<Pose>& start, const std::vector<Pose>& step_start,
                              const EquilibriumOptions& options = {}, std::vector<PressMemory>* memory = nullptr);

/// Everything at given poses, without solving: contact, ligaments, reactions. Outcome: Prescribed.
/// `stop`: as in EquilibriumOptions.
Equilibrium state_at(const Joint& joint, const SpringBeds& beds, const LoadCase& load_case,
                     const std::vector<Pose>& poses, std::vector<PressMemory>* memory = nullptr,
                     const StopFlag* stop = nullptr);

}  // namespace dea

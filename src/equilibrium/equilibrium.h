// febiodea/equilibrium/equilibrium.h – the pose at which springs, ligaments and loads balance.
#pragma once
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <febiodea/equilibrium/body_forces.h>
#include <febiodea/equilibrium/conditions.h>
#include <febiodea/joint/joint.h>
#include <febiodea/springs/springs.h>

namespace dea {

enum class Outcome {
  Prescribed,           ///< no free dof: the motion was given
  Balanced,             ///< forces and moments of all free dofs balance to the tolerance
  BalancedToOneSpring,  ///< balanced up to the force of one spring that jumps on and off a rim
  SurfacesApart,        ///< the loads move the surfaces apart: no contact can carry them
  NoEquilibrium,        ///< a direction nothing resists is loaded
  NotConverged,         ///< none of the above was reached within the iterations
  BeyondStrainLimit     ///< springs strained beyond 0.9 (C1): prescribed, balanced, or not to be balanced (message)
};
const char* name(Outcome outcome);
/// True for Prescribed, Balanced and BalancedToOneSpring.
bool solved(Outcome outcome);

/// How far a search has come, for whoever watches; told before each pose that is tried.
struct SearchStatus {
  int iterations = 0;     ///< Newton steps begun
  int casts = 0;          ///< poses tried, with this one
  double residual = NAN;  ///< unbalanced / applied force at the last iterate; NaN: none is known yet
};

struct EquilibriumOptions {
  double tolerance = 1e-9;  ///< unbalanced / applied force; far below the error of any mesh, and Newton gets there
  int max_iterations = 60;  ///< a stop for loads that no contact can carry
  int max_casts = 160;      ///< poses tried for one load case; solved ones need some ten, seldom a hundred
  int patience = 20;        ///< poses tried in which the residual falls by less than 7%: then the search is given up
  std::function<void(const SearchStatus&)> watch;  ///< may be empty; changes nothing
};

/// The beds of all contacts of a joint, and lengths that scale its unknowns.
struct SpringBeds {
  std::vector<SpringBed> beds;   ///< one per contact
  double length = 1.0;           ///< radius of gyration of the articular surfaces: scales moments and rotations
  double reach = 1.0;            ///< largest distance of an articular vertex from its body's centre of mass
  double least_thickness = 1.0;  ///< of the layers: a pose step moves no surface by more than half of it
};
SpringBeds make_spring_beds(const Joint& joint);

struct Equilibrium {
  Outcome outcome = Outcome::NotConverged;
  std::string message;                     ///< one sentence with the numbers behind the outcome
  Sentence advice;                            ///< what to do about it, goes on from the message; empty: nothing is known
  std::vector<Pose> poses;                 ///< one per body
  std::vector<SpringStates> springs;       ///< one per contact; empty states where the contact is not active
  std::vector<Vector6> contact_on_target;  ///< per contact: force and moment about the target's current centre of mass
  std::vector<Vector6> reaction;  ///< per body: force and moment on it by what loads and holds it, = minus those of
                                  ///  contacts, ligaments, cables and connectors: FEBio's `rigid force` and
                                  ///  `rigid torque`
  std::vector<double> ligament_force;    ///< per ligament, tension > 0
  std::vector<double> cable_force;       ///< per cable, tension
  std::vector<Vector6> connector_force;  ///< per connector: force and moment on B about its current point on B, global;
                                         ///  least squares where conditions are redundant; NaN: neither body can move
  std::vector<Vector6> connector_motion;  ///< per connector: of B as seen from A (connectors.h)
  double residual_force = 0.0;            ///< over free dofs; NaN: no free translation
  double residual_moment = 0.0;           ///< over free dofs; NaN: no free rotation
  double load = 0.0;                      ///< the forces' scale the residual is measured against
  int iterations = 0;                     ///< Newton steps
  int casts = 0;                          ///< how often all rays were cast
  std::vector<double> history;            ///< scaled residual / load at each iterate
  std::vector<std::string> held;          ///< flat directions that were held, in words
  double least_stiffness =
      0.0;  ///< least eigenvalue of the symmetric part of the stiffness (translations and rotations
            ///  times length), flat directions left out; < 0: unstable; NaN: nothing free
};

/// Poses of all bodies at rest in their reference positions.
std::vector<Pose> reference_poses(const Joint& joint);

/// All that acts on the bodies at given poses but the connectors' reactions: 6 numbers per body (E1), and the
/// derivative by small motions of the bodies. For tests and tools.
BodyForces forces_at(const Joint& joint, const SpringBeds& beds, const LoadCase& load_case,
                     const std::vector<Pose>& poses);

/// Solves one load case from `start` (docs/theory.md, section 4). `step_start`: poses when the step began (for relative
/// motions). `memory`: per contact, where searches for pressures start and where the next may start; nullptr: from
/// nothing. The same arguments give the same bits, whoever solved what before or does at the same time. Never throws
/// for a load that cannot be carried: that is an outcome. InputError: a ligament's force is undefined where it starts.
Equilibrium solve_equilibrium(const Joint& joint, const SpringBeds& beds, const LoadCase& load_case,
                              const std::vector<Pose>& start, const std::vector<Pose>& step_start,
                              const EquilibriumOptions& options = {}, std::vector<PressMemory>* memory = nullptr);

/// Everything at given poses, without solving: contact, ligaments, reactions. Outcome: Prescribed.
Equilibrium state_at(const Joint& joint, const SpringBeds& beds, const LoadCase& load_case,
                     const std::vector<Pose>& poses, std::vector<PressMemory>* memory = nullptr);

}  // namespace dea

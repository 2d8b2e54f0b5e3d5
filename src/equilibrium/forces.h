// src/equilibrium/forces.h – all that acts on the bodies at one set of poses, and how it changes with them (E1).
#pragma once
#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "src/equilibrium/body_forces.h"
#include "src/equilibrium/connectors.h"
#include "src/equilibrium/load_case.h"
#include "src/equilibrium/search.h"
#include "src/equilibrium/spring_beds.h"

namespace dea {

/// Everything known at one set of poses. Vectors over all dofs of all bodies, 6 per body: force, and moment about the
/// current centre of mass, global frame; those ON the bodies.
struct Evaluation : PosedSprings {
  std::vector<SpringStates> ties;                ///< per bed of SpringBeds::ties; empty states: they do not act
  Eigen::VectorXd contact, ligaments, external;  ///< `ligaments`: cables and the connectors' loads too; `external`:
                                                 ///  what holds points of bodies, too
  BlockMatrix derivative;                        ///< of their sum and of the reactions
  double normal_force = 0.0;                     ///< sum of p A over all contacts
  double tolerance = 0.0;                        ///< of the layers' pressures; 0: exact
  // connectors and held points: their conditions, the motions these leave, and what connectors transmit
  std::vector<ConnectorRow> rows;
  Tangent tangent;
  Eigen::VectorXd reactions;
  Eigen::VectorXd residual() const { return contact + ligaments + external + reactions; }
};

/// One load case to be balanced: what is given, and what a search keeps on its way.
struct Problem {
  const Joint& joint;
  const SpringBeds& beds;
  const LoadCase& load_case;
  std::vector<int> free;                  ///< dof numbers 6 * body + k
  Eigen::VectorXd scale;                  ///< per free dof: 1 for translations, length for rotations
  Eigen::VectorXd offset;                 ///< per dof: part of the load held back (continuation)
  std::vector<PressMemory>& memory;       ///< per group of contacts: where searches for pressures start
  int casts = 0;                          ///< poses tried
  double tolerance = kPressureTolerance;  ///< of the layers' pressures at the next poses
  bool downhill = false;  ///< follow the load where a balance would be unstable, not Newton's step to it
  std::string undefined;  ///< why a step was refused, if a ligament's force had no value where it led
  ConnectorGroups connectors;
  SearchStatus status = {};
  const std::function<void(const SearchStatus&)>* watch = nullptr;
  const StopFlag* stop = nullptr;
  bool joined() const { return !connectors.groups.empty(); }
};
/// With nothing free yet; `memory` gets one entry per group of contacts.
Problem make_problem(const Joint& joint, const SpringBeds& beds, const LoadCase& load_case,
                     std::vector<PressMemory>& memory);

/// Forces over all dofs as those on the free dofs, moments divided by the length.
Eigen::VectorXd free_part(const Problem& problem, const Eigen::VectorXd& all);

/// Ligaments on parts, as they pull in a load case. It looks into both of its arguments.
TieLaw tie_law(const Joint& joint, const LoadCase& load_case);

/// Contacts, ligaments, cables, loads and what the connectors transmit at these poses; one more pose tried. Throws
/// Stopped.
Evaluation evaluate(Problem& problem, std::vector<Pose> poses);

/// Tolerance of the layers' pressures after a step: far from balance they need not be known closely, only to a
/// fiftieth of what the next step leaves. `residual`: unbalanced / load at the pose it starts from.
double tolerance_after(double residual);

}  // namespace dea

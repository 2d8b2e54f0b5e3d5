// src/equilibrium/approach.h – surfaces that are apart or passed through each other, brought into contact.
#pragma once
#include <Eigen/Core>

#include "src/equilibrium/forces.h"

namespace dea {

/// Force of springs that had a target and have none (or are passed too deep) after a step: such a loss is no progress.
double lost_force(const Evaluation& before, const Evaluation& after);

bool touching(const Evaluation& e);

/// Area of the springs whose target lies deeper under the foot than both layers are thick.
double too_deep_area(const Problem& problem, const Evaluation& e);

/// The most that any spring under pressure closes or opens by a motion of the unknowns (unknowns.h), to first order
/// (E2).
double closing_motion(const Problem& problem, const Evaluation& e, const Eigen::VectorXd& motion);

/// Separated surfaces: along the load to first touch, and on until the contact carries most of it. `direction`: a
/// motion of the unknowns. False: they do not touch where `e` ends.
bool advance(Problem& problem, Evaluation& e, Eigen::VectorXd direction);

/// Surfaces passed through each other: back along the normals of the springs that are too deep. False: some still are.
bool back_out(Problem& problem, Evaluation& e);

}  // namespace dea

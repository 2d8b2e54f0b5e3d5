// src/equilibrium/unknowns.h – the unknowns of a search: its free dofs, or the motions that connectors leave.
//
// A vector of unknowns is one number per free dof (Problem::free), rotations times Problem::scale; where there are
// connectors, one per motion they leave at the pose (Tangent::basis). Forces on them are all in units of force.
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <optional>
#include <vector>

#include "src/equilibrium/forces.h"

namespace dea {

/// A motion of the unknowns as one of the free dofs (scaled).
Eigen::VectorXd as_free(const Problem& problem, const Evaluation& e, const Eigen::VectorXd& motion);

/// A motion of the unknowns as a motion of all dofs, 6 per body, unscaled.
Eigen::VectorXd on_all_dofs(const Problem& problem, const Evaluation& e, const Eigen::VectorXd& motion);

/// Forces and moments on all dofs as those on the unknowns: all in units of force.
Eigen::VectorXd on_unknowns(const Problem& problem, const Evaluation& e, const Eigen::VectorXd& all);

/// A motion of all dofs as one of the unknowns at another pose, `e`: connectors leave other motions there.
Eigen::VectorXd motion_at_new_pose(const Problem& problem, const Evaluation& e, const Eigen::VectorXd& all);

/// What is out of balance (E1), less what is held back.
Eigen::VectorXd scaled_residual(const Problem& problem, const Evaluation& e);

/// Stiffness K = -dr/du over the unknowns.
Eigen::SparseMatrix<double> scaled_stiffness(const Problem& problem, const Evaluation& e);

/// Poses after a small motion of the unknowns; connectors closed again. Nothing: they cannot be, a ligament's force is
/// undefined there (Problem::undefined), or a pose is no finite number.
std::optional<std::vector<Pose>> poses_after(Problem& problem, const Evaluation& e, const Eigen::VectorXd& motion);

/// The farthest any articular surface moves on its partner by a motion of the unknowns, to first order.
double surface_motion(const Problem& problem, const Evaluation& e, const Eigen::VectorXd& motion);

/// Does a motion of the unknowns move all bodies together, none on its partner? To a millionth of it.
bool moves_together(const Problem& problem, const Evaluation& e, const Eigen::VectorXd& motion);

}  // namespace dea

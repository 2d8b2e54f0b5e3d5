// src/equilibrium/connectors.h – joints that hold bodies together exactly (docs/theory.md, section 4: J1-J4).
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "src/equilibrium/body_forces.h"

namespace dea {

/// Motion of B as seen from A: d . a_k along A's current axes (d from the joint's point on A to that on B), then the
/// rotation vector of B's axes in A's, [rad] (J1).
Vector6 connector_motion(const Joint& joint, const Connector& connector, const std::vector<Pose>& poses);

/// One condition that a connector puts on its bodies: `gap` = 0 (J2).
struct ConnectorRow {
  int connector = -1;
  int dof = 0;                          ///< which of the six motions; an angle if >= 3
  double gap = 0.0;                     ///< length, or angle [rad] to first order
  Eigen::Matrix<double, 12, 1> wrench;  ///< of a unit multiplier on A and B, = the gap's derivative where it is 0 (J3)
};

/// The conditions of all active connectors at these poses, connector by connector.
std::vector<ConnectorRow> connector_rows(const Joint& joint, const LoadCase& load_case, const std::vector<Pose>& poses);

/// Adds the wrenches of the rows times their multipliers; the derivative is that at constant multipliers (J4).
void add_reactions(const Joint& joint, const std::vector<ConnectorRow>& rows, const Eigen::VectorXd& multipliers,
                   const std::vector<Pose>& poses, BodyForces& forces);

/// Adds the forces and moments given along a connector's free motions: `value` on A, its opposite on B.
/// Returns the largest of them, moments divided by `length`.
double add_connector_loads(const Joint& joint, const LoadCase& load_case, double length, const std::vector<Pose>& poses,
                           BodyForces& forces);

/// What each connector transmits: force and moment on B about the joint's current point on B, global frame. NaN where
/// neither body can move: nothing says what it carries.
std::vector<Vector6> connector_forces(const Joint& joint, const LoadCase& load_case,
                                      const std::vector<ConnectorRow>& rows, const Eigen::VectorXd& multipliers,
                                      const std::vector<Pose>& poses);

/// Dofs the connectors act on, in groups that share no body that can move. Unknowns: the free dofs, rotations times
/// `length`.
struct ConnectorGroups {
  struct Group {
    std::vector<int> connectors;
    std::vector<int> free;  ///< positions in `free` of make_groups
    int rank = -1;          ///< independent conditions; -1: not known yet
  };
  std::vector<Group> groups;
  std::vector<int> free;              ///< dof numbers 6 * body + k
  Eigen::VectorXd scale;              ///< per free dof: 1, or length for rotations
  double length = 1.0;                ///< rotations' scale
  double size = 1.0;                  ///< of the joint: gaps below 1e-11 of it are none
  std::vector<int> group_of;          ///< per connector: group, -1: none (not active, or neither body can move)
  std::vector<int> sides_a, sides_b;  ///< per connector: its bodies
};
ConnectorGroups make_groups(const Joint& joint, const LoadCase& load_case, const std::vector<int>& free, double length,
                            double size, const std::vector<Pose>& poses);

/// The free motions that keep all conditions to first order, and the multipliers that come nearest to given forces.
struct Tangent {
  Eigen::SparseMatrix<double> basis;  ///< free dofs x remaining motions, orthonormal columns; scaled unknowns
  Eigen::VectorXd multipliers;        ///< per row; least squares, of least size where conditions are redundant
};
/// `unbalanced`: residual over the free dofs, scaled (moments divided by the length).
Tangent tangent_of(const ConnectorGroups& groups, const std::vector<ConnectorRow>& rows,
                   const Eigen::VectorXd& unbalanced);

/// Moves bodies until all conditions hold (Gauss-Newton, the least motion of the free dofs). False: they cannot be
/// made to; `worst` is then the row with the largest gap.
bool close_connectors(const Joint& joint, const LoadCase& load_case, const ConnectorGroups& groups,
                      std::vector<Pose>& poses, ConnectorRow* worst = nullptr);

/// Turns and moves bodies: 6 numbers per body, translation of the centre and rotation vector, global.
void move_bodies(std::vector<Pose>& poses, const Eigen::VectorXd& motion);

/// Joints that the starting poses pull apart: motions they hold would be broken from the start.
std::vector<Fault> broken_connectors(const JointModel& model, const Joint& joint, const std::vector<Pose>& start);

}  // namespace dea

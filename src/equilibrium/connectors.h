// src/equilibrium/connectors.h – joints that hold bodies together exactly, and points of bodies that stay at their
// place (docs/theory.md, section 4: J1-J4).
//
// Both are links: those of the connectors come first, in their order, then one for the held points of each body.
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "src/equilibrium/body_forces.h"

namespace dea {

/// Motion of B as seen from A: d . a_k along A's current axes (d from the joint's point on A to that on B), then the
/// rotation vector of B's axes in A's, [rad] (J1).
Vector6 connector_motion(const Joint& joint, const Connector& connector, const std::vector<Pose>& poses);

/// One condition that a link puts on its bodies: `gap` = 0 (J2).
struct ConnectorRow {
  int link = -1;
  int dof = 0;                      ///< which of the six motions; an angle if >= 3. Of a held point: along x, y, z
  double gap = 0.0;                 ///< length, or angle [rad] to first order
  Vector12 wrench;                  ///< of a unit multiplier on A and B, = the gap's derivative where it is 0 (J3)
  Vector3d arm = Vector3d::Zero();  ///< of a held point, from the body's centre
};

/// The conditions of all active links at these poses, link by link.
std::vector<ConnectorRow> connector_rows(const Joint& joint, const LoadCase& load_case, const std::vector<Pose>& poses);

/// Adds the wrenches of the connectors' rows times their multipliers; the derivative is that at constant multipliers
/// (J4).
void add_reactions(const Joint& joint, const std::vector<ConnectorRow>& rows, const Eigen::VectorXd& multipliers,
                   const std::vector<Pose>& poses, BodyForces& forces);

/// The same of held points: what holds the bodies from outside.
void add_hold_reactions(const Joint& joint, const std::vector<ConnectorRow>& rows, const Eigen::VectorXd& multipliers,
                        BodyForces& forces);

/// Adds the forces and moments given along a connector's free motions: `value` on A, its opposite on B.
/// Returns the largest of them, moments divided by `length`.
double add_connector_loads(const Joint& joint, const LoadCase& load_case, double length, const std::vector<Pose>& poses,
                           BodyForces& forces);

/// What each connector transmits: force and moment on B about the joint's current point on B, global frame. NaN where
/// neither body can move: nothing says what it carries.
std::vector<Vector6> connector_forces(const Joint& joint, const LoadCase& load_case,
                                      const std::vector<ConnectorRow>& rows, const Eigen::VectorXd& multipliers,
                                      const std::vector<Pose>& poses);

/// Dofs the links act on, in groups that share no body that can move. Unknowns: the free dofs, rotations times
/// `length`.
struct ConnectorGroups {
  struct Group {
    std::vector<int> links;
    std::vector<int> free;  ///< positions in `free` of make_groups
    int rank = -1;          ///< independent conditions; -1: not known yet
  };
  std::vector<Group> groups;
  std::vector<int> free;              ///< dof numbers 6 * body + k
  Eigen::VectorXd scale;              ///< per free dof: 1, or length for rotations
  double length = 1.0;                ///< rotations' scale
  double size = 1.0;                  ///< of the joint: gaps below 1e-11 of it are none
  std::vector<int> sides_a, sides_b;  ///< per link: its bodies; of held points: twice the same
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

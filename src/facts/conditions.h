// src/facts/conditions.h – what holds and moves the bodies in each step, and by which statement.
//
// The lists of a model that hold and move (JointModel) are read here, once. What lies above asks here.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "src/facts/bodies.h"
#include "src/model/joint_model.h"
#include "src/model/settings.h"

namespace dea {

using Vector6 = Eigen::Matrix<double, 6, 1>;

/// What the model asks of one dof of a body (order of kDofs).
enum class DofState {
  Free,       ///< an unknown of the equilibrium
  Held,       ///< stays where it is
  Prescribed  ///< follows a given motion
};

/// Whose statement holds or moves a dof.
enum class HeldBy { Nothing, Body, Nodes, Settings };

/// A motion that the model prescribes of a dof of a body, or of nodes.
struct GivenMotion {
  std::string name;
  Origin origin;
  int material = -1;  ///< of which it is said; -1: of nodes
  Scaled value;
  bool relative = false;  ///< as it is stated
  bool in_step = false;   ///< of one step alone
  /// From the pose when it became active: outside steps that is the reference.
  bool from_step_start() const { return relative && in_step; }
};

/// A statement that fixes a dof of one material of a body.
struct FixedDof {
  std::string name;
  int material = -1;
};

struct BodyDof {
  DofState state = DofState::Free;
  HeldBy by = HeldBy::Nothing;
  std::vector<GivenMotion> motions;  ///< in the order of the model; the last one counts; none: back to the reference
  std::vector<FixedDof> fixed;
};

/// A node holds or moves its bone in one component: e_k . (v + w x arm) is given, v and w the bone's motion.
struct NodeRow {
  int component = 0;
  Vector3d arm = Vector3d::Zero();  ///< of the node from the centre of mass, reference
  int motion = -1;                  ///< index into NodeRows::motions; -1: fixed
  bool of_bone = true;              ///< its elements are taken as rigid by the user, and of no rigid body of the model
};
/// (e_k, arm x e_k / length): of a motion (v, w times length).
Vector6 condition(const NodeRow& row, double length);

/// The nodes that hold or move a bone which the user takes as rigid.
struct NodeRows {
  std::vector<NodeRow> rows;
  std::vector<GivenMotion> motions;
  std::array<int, 3> relative = {-1, -1, -1};  ///< per component: what moves it counts from the step's start; -1: none
  bool agree = true;                           ///< what moves one component is all relative, or none is
  double length = 1.0;                         ///< of the longest arm; 1 where all are 0
};

/// What rows leave of a body's motion, by the eigenvectors of their Gram matrix.
struct RowSpan {
  Vector6 motion = Vector6::Zero();     ///< the smallest that satisfies the rows; rotations times length
  Vector6 free_part = Vector6::Zero();  ///< per dof: how much of its unit vector squared no row sees
  int conditions = 0;                   ///< independent rows
  /// No freedom is left in this dof.
  bool holds(int dof) const { return free_part[dof] < 1e-6; }
};
/// `values`: per row, what it is given; empty: 0.
RowSpan span_of(const std::vector<NodeRow>& rows, double length, const std::vector<double>& values = {});

/// One body in one step.
struct BodyHolds {
  std::array<BodyDof, kDofs> dofs;
  NodeRows nodes;  ///< where prescribed nodes move the bone
  /// Fixed nodes that leave a bone a hinge, a pin or a guided end: independent rows, which hold it at any pose in place
  /// of the dofs `coupled_dofs`. Empty: all that nodes hold is dofs.
  std::vector<NodeRow> coupled;
  std::array<bool, kDofs> coupled_dofs = {};
  int first_coupled = -1;  ///< the first such condition: index into JointModel::fixed_nodes
};

/// steps[step][body]
struct Conditions {
  std::vector<std::vector<BodyHolds>> steps;
};

/// Of the model alone. `node_body`: per node, the body that carries it, -1: none.
Conditions find_conditions(const JointModel& model, const Bodies& bodies, const std::vector<int>& node_body);

/// The settings laid over what the model says of a body in a step. `free`: of the dofs that no statement moves, these
/// are free and the others held. A body of which the settings say how it moves is not held by coupled rows.
BodyHolds with_settings(BodyHolds holds, const JointModel& model, const std::vector<Body>& bodies, int body,
                        const Settings& settings);

}  // namespace dea

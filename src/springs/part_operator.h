// src/springs/part_operator.h – a deformable part as an operator: from forces on its nodes to how they move, small
// strain, in a frame that moves with it (P1)-(P3). Factorised once; poses change nothing in it.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "src/joint/part.h"
#include "src/springs/sparse_factor.h"

namespace dea {

/// Who holds a node of the part. `Frame`: the body the part's frame moves with. `Other`: a second body.
enum class PartHold : unsigned char { None, Frame, Other };

/// K u = f over the nodes that nobody holds.                                                                       (P1)
///
/// Nothing holds it (a disc): its frame is where it is itself on average, by volume, and its motion an unknown of the
/// search like a bone's. Forces that do not balance are met by a body force that does, l:
///     [K  M R; (M R)^T  0] (u, l) = (f, 0)                                                                       (P2)
/// M: the nodes' volumes, R: rigid motions. Three nodes are held in six components, K_p; with Z = K_p^-1 M R,
/// G = R^T M R, S = Z^T M R, for any f
///     c = G^-1 R^T f,   v = K_p^-1 f - Z c,   u = v - R G^-1 (Z^T f - S c)
/// which needs a sparse solution at the nodes asked for alone.
///
/// A second body holds it, too: the nodes that it holds move as one rigid piece by theta, small, about `center`,
///     u = K^-1 f + W theta,   S theta = W^T f + R^T f_h                                                          (P3)
/// with f_h the forces on them. Holds (PartTie) join the piece to that body.
struct PartOperator {
  PartMesh mesh;
  std::vector<PartHold> hold;  ///< per node
  std::vector<int> unknown;    ///< 3 per node; -1: held
  SparseFactor factor;         ///< of K over the unknowns
  std::vector<double> volume;  ///< per node: its share of the elements'
  double softness = 0.0;       ///< strain per stress along its stiffest axis, of its softest element [1/MPa]
  /// U, 3 per node x columns: U U^T is K^-1 for the forces that it was learnt of, and nearly for what is like them:
  /// pressures that push and bend it (learn_soft). It leads searches, no more.
  Nodal soft;
  bool free = false;  ///< nothing holds it
  Vector3d center =
      Vector3d::Zero();  ///< R, theta are about this point: the part's centre of volume; of the nodes held by `Other`
  Eigen::MatrixXd Z;     ///< free: unknowns x 6
  Eigen::Matrix<double, 6, 6> G_inverse, S;
  Eigen::MatrixXd W;                      ///< held by two bodies: unknowns x 6
  Eigen::Matrix<double, 6, 6> S_inverse;  ///< of P3's S; where turning the piece strains nothing, zero
};

/// `held`: per node, bit k set, it stays where it is along axis k; empty: none does. Throws std::runtime_error where what
/// holds it leaves it a motion, or a piece of it hangs on nothing.
PartOperator make_part_operator(PartMesh mesh, std::vector<PartHold> hold, const std::vector<unsigned char>& held = {});

/// Sets `soft` by forces on nodes, 3 per node x columns: U = K^-1 F (F^T K^-1 F)^(-1/2).
void learn_soft(PartOperator& part, const Nodal& forces);

/// What feet press on: for each foot the forces on nodes per unit of pressure, in the part's frame.
struct PartFeet {
  std::vector<int> begin = {0};
  std::vector<int> node;
  std::vector<Vector3d> weight;  ///< [mm^2]: area times direction, times the node's share
  std::vector<double> area;      ///< per foot [mm^2]; 0: it stands on nothing
  std::vector<double> scale;     ///< about how far it sinks for itself per pressure [mm/MPa]: leads searches, no more
  // of the part that they press (set_reach):
  std::vector<int> columns;  ///< of the factor: those that feet have to do with
  Eigen::MatrixXd on_rest;   ///< feet x 6, N_i^T Z (P2) or N_i^T W (P3)
  Eigen::MatrixXd wrench;    ///< feet x 6, N_i^T R of a free part
  int size() const { return static_cast<int>(area.size()); }
};
void set_reach(PartFeet& feet, const PartOperator& part);

/// w per foot [mm], along its force, per pressure [MPa]; both feet x columns. A_i w_i = N_i^T u: symmetric, not
/// negative.
Eigen::MatrixXd sinking(const PartOperator& part, const PartFeet& feet, const Eigen::MatrixXd& pressure);

/// Per foot: how far it goes along its force as the nodes move (nodes x 3), N_i^T u / A_i; 0 where it stands on
/// nothing.
Eigen::VectorXd along_forces(const PartFeet& feet, const Eigen::MatrixX3d& motion);
/// The same for columns of motions, 3 per node.
Nodal along_forces(const PartFeet& feet, const Nodal& motions);

/// Displacements of all nodes under forces on them, both 3 per node x columns, in the frame.
Nodal displacements(const PartOperator& part, const Nodal& force);
/// Displacements of all nodes [mm, nodes x 3] under forces on them [N, nodes x 3], in the frame.
Eigen::MatrixX3d displacements(const PartOperator& part, const Eigen::MatrixX3d& force);
/// Forces of the feet on all nodes, 3 per node x columns.
Nodal nodal_forces(const PartOperator& part, const PartFeet& feet, const Eigen::MatrixXd& pressure);
/// A column of 3 per node as nodes x 3.
Eigen::MatrixX3d by_node(const Nodal& column);

}  // namespace dea

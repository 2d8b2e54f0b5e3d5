// src/model/solid_element.h – solid elements at small strain: stiffness, volume and strain, any shape, any material.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "src/model/element_shape.h"
#include "src/model/joint_model.h"
#include "src/model/stiffness.h"

namespace dea {

/// Is the shape's stiffness known? Not that of tetrahedra with a node inside (they lock), cubic ones, and of pyramids
/// with 13 nodes.
bool has_stiffness(ElementShape shape);

/// How an element's strains follow from its nodes' displacements (u, v, w of the first node, of the second, ...): at
/// its points of integration, with their share of its volume. Hexahedra of 8 nodes, prisms of 6 and pyramids of 5 have
/// the element's mean dilatation at every point, so that they do not lock where the material hardly changes its volume
/// (Hughes 1980, Int J Numer Meth Eng 15:1413); those of 20 nodes are integrated at 2 x 2 x 2 points.
struct ElementPoint {
  double volume = 0.0;                              ///< > 0 when the nodes are in FEBio's order
  Eigen::Matrix<double, 6, Eigen::Dynamic> strain;  ///< 6 x 3 nodes, per displacement [1/mm]
};
std::vector<ElementPoint> element_points(ElementShape shape, const std::vector<Vector3d>& nodes);

/// Integral of B^T D B [N/mm]. `of_volume`: the part of D that acts on the dilatation alone and is left out, D less
/// of_volume m m^T; tetrahedra of four nodes have it at their nodes (src/springs/part_operator.h).
Eigen::MatrixXd element_stiffness(const std::vector<ElementPoint>& points, const Matrix6d& D, double of_volume = 0.0);

}  // namespace dea

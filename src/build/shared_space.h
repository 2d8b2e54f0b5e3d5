// src/build/shared_space.h – layers of one bone that take up the same space.
//
// Each of them would bear the load there, and their elements would lie within each other. A column of one layer (over a
// triangle) is in the other where one of five points along its middle is inside the other's surface: both faces and
// the walls between their rims. So it is found whichever of the two is thicker.
#pragma once
#include <vector>

#include "src/build/built_joint.h"

namespace dea {

/// What two layers share.
struct SharedSpace {
  double area = 0.0;   ///< of the articular surface over the columns that lie in the other layer; of both the larger
  double share = 0.0;  ///< of the smaller layer's area
  Eigen::Vector3d where = Eigen::Vector3d::Zero();  ///< articular surface, farthest within the other's rim
};

/// Columns that lie within each other. Layers that meet at their rims share nothing: a strip of columns that reaches
/// into the other layer by less than half of its triangles' edge is a touch, for no rim is known closer than that.
SharedSpace shared_space(const BuiltLayer& a, const BuiltLayer& b);

}  // namespace dea

// src/geometry/coincident.h – nodes that lie at one place.
#pragma once
#include <unordered_map>
#include <vector>

#include "src/base/numbers.h"
#include "src/model/joint_model.h"

namespace dea {

/// Of the nodes that lie within `tolerance` of an earlier one in the list: the node that stands for them. Nodes that
/// stand for themselves are not in it.
std::unordered_map<int, int> coincident_nodes(const std::vector<int>& nodes, const std::vector<Vector3d>& positions,
                                              double tolerance);

}  // namespace dea

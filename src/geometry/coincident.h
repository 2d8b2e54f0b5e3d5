// src/geometry/coincident.h – nodes that lie at one place, found by cells of a grid.
#pragma once
#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "src/base/numbers.h"
#include "src/model/joint_model.h"

namespace dea {

/// The cell of a grid of this width that holds x; what no number of a cell reaches lies in the outermost one.
using GridCell = std::array<std::int64_t, 3>;
GridCell grid_cell(const Vector3d& x, double width);

/// Of the nodes that lie within `tolerance` of an earlier one in the list: the node that stands for them. Nodes that
/// stand for themselves are not in it.
std::unordered_map<int, int> coincident_nodes(const std::vector<int>& nodes, const std::vector<Vector3d>& positions,
                                              double tolerance);

}  // namespace dea

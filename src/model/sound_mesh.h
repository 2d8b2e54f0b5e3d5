// src/model/sound_mesh.h – coordinates out of all proportion, found before anything is computed from them.
#pragma once
#include <vector>

#include "src/base/fault.h"
#include "src/model/joint_model.h"

namespace dea {

/// Per node, squared distances.
struct NodeSpacing {
  std::vector<double> nearest2;  ///< to the nearest node of its elements that lies elsewhere; infinity: there is none
  std::vector<double> around2;   ///< the largest `nearest2` of the other nodes of its elements
};

/// Element or facet i has the nodes[begin[i]] .. nodes[begin[i + 1]].
NodeSpacing node_spacing(const std::vector<Vector3d>& positions, const std::vector<int>& begin,
                         const std::vector<int>& nodes);

/// A slip of the keyboard, or damage: a thousand times farther from the nodes of its elements than these lie apart.
bool is_flung(const NodeSpacing& spacing, int node);

/// "is 1e+09 away from its other nodes, which are 1.2 apart;"
std::string flung_words(const NodeSpacing& spacing, int node);

/// Nodes that are flung away; nodes and points so far from the origin that a plot file, whose numbers have seven
/// digits, could not tell the nodes of an element apart. The first of each kind are named; a sound mesh has none.
std::vector<Fault> mesh_faults(const JointModel& model);

}  // namespace dea

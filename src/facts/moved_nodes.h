// src/facts/moved_nodes.h – nodes whose displacement is prescribed, as bodies.
//
// A model may leave a bone out and move the nodes on the cartilage's bone side instead. Nodes whose x, y and z are all
// given, and alike, move together and do not turn: a body without material.
#pragma once
#include <string>
#include <vector>

#include "src/base/fault.h"
#include "src/model/joint_model.h"

namespace dea {

/// Nodes that move alike.
struct MovedNodes {
  std::string name;             ///< of the first condition that moves them
  std::vector<int> nodes;       ///< node indices, ascending
  std::vector<int> conditions;  ///< indices into JointModel::prescribed_nodes: those of each node
};

/// Are there nodes whose displacement is prescribed?
inline bool moves_nodes(const JointModel& model) { return !model.prescribed_nodes.empty(); }

/// Nodes of no body, grouped by their motion in all steps; components that are fixed stay at, or go back to, the
/// reference. Nodes that are free in a component, or both fixed and moved in one, are no body: one fault per
/// condition. `body_of_node`: per node, >= 0: a body has it.
std::vector<MovedNodes> find_moved_nodes(const JointModel& model, const std::vector<int>& body_of_node,
                                         std::vector<Fault>& faults);

}  // namespace dea

// src/facts/node_holds.h – who holds or moves which component of a node, and in which step; nodes whose displacement is
// prescribed, as bodies.
//
// A model may leave a bone out and move the nodes on the cartilage's bone side instead. Nodes whose x, y and z are all
// given, and alike, move together and do not turn: a body without material.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "src/base/fault.h"
#include "src/model/joint_model.h"

namespace dea {

/// What a statement says of one component of a node.
struct NodeHold {
  int component = 0;
  int step = -1;      ///< -1: all
  bool fixed = true;  ///< else its displacement is prescribed
  bool acts(int in_step) const { return step < 0 || step == in_step; }
};

struct NodeHolds {
  std::vector<int> begin;  ///< of node i: holds[begin[i]] .. holds[begin[i + 1]], fixed ones first
  std::vector<NodeHold> holds;
  std::span<const NodeHold> of(int node) const {
    return {holds.data() + begin[at(node)], holds.data() + begin[at(node) + 1]};
  }
};
NodeHolds find_node_holds(const JointModel& model);

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

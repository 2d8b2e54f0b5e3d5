// src/facts/node_holds.h – who holds or moves which component of a node, and in which step.
#pragma once
#include <span>
#include <vector>

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

}  // namespace dea

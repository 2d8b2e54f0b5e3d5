#include "src/facts/node_holds.h"

namespace dea {

namespace {

template <class Use>
void each_hold(const JointModel& model, const Use& use) {
  for (const FixedNodes& f : model.fixed_nodes)
    for (const int node : f.nodes)
      for (int k = 0; k < 3; ++k)
        if (f.xyz[at(k)]) use(node, NodeHold{k, f.step, true});
  for (const PrescribedNodes& p : model.prescribed_nodes)
    for (const int node : p.nodes) use(node, NodeHold{p.component, p.step, false});
}

}  // namespace

NodeHolds find_node_holds(const JointModel& model) {
  NodeHolds found;
  found.begin.assign(model.nodes.size() + 1, 0);
  each_hold(model, [&](int node, const NodeHold&) { ++found.begin[at(node) + 1]; });
  for (std::size_t i = 1; i < found.begin.size(); ++i) found.begin[i] += found.begin[i - 1];
  found.holds.resize(at(found.begin.back()));
  std::vector<int> next = found.begin;
  each_hold(model, [&](int node, const NodeHold& hold) { found.holds[at(next[at(node)]++)] = hold; });
  return found;
}

}  // namespace dea

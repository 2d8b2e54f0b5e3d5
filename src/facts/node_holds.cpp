#include "src/facts/node_holds.h"

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

#include "src/base/numbers.h"
#include "src/base/say.h"

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

constexpr int kFree = -1, kFixed = -2, kTwice = -3;  // else: class of a motion

/// What happens to a node: per step and component kFree, kFixed, kTwice or the class of its motion.
using NodeMotion = std::vector<std::array<int, 3>>;

/// Conditions with the same value over time have the same class.
std::vector<int> motion_classes(const JointModel& model) {
  std::map<std::tuple<double, int, bool>, int> classes;
  std::vector<int> of_condition;
  for (const PrescribedNodes& p : model.prescribed_nodes)
    of_condition.push_back(classes
                               .try_emplace({p.value.factor, p.value.controller, p.relative && p.step >= 0},
                                            static_cast<int>(classes.size()))
                               .first->second);
  return of_condition;
}

/// Conditions of one node: prescribed_nodes as they are counted, fixed_nodes behind them.
NodeMotion motion_of(const JointModel& model, const std::vector<int>& conditions, const std::vector<int>& classes) {
  NodeMotion motion(std::max<std::size_t>(model.steps.size(), 1), {kFree, kFree, kFree});
  const int prescribed = static_cast<int>(model.prescribed_nodes.size());
  for (std::size_t s = 0; s < motion.size(); ++s) {
    for (int c : conditions) {
      if (c < prescribed) {
        const PrescribedNodes& p = model.prescribed_nodes[at(c)];
        if (!p.acts(static_cast<int>(s))) continue;
        int& state = motion[s][at(p.component)];
        state = state == kFree || state == classes[at(c)] ? classes[at(c)] : kTwice;
      } else {
        const FixedNodes& f = model.fixed_nodes[at(c - prescribed)];
        if (!f.acts(static_cast<int>(s))) continue;
        for (std::size_t k = 0; k < 3; ++k)
          if (f.xyz[k]) motion[s][k] = motion[s][k] == kFree || motion[s][k] == kFixed ? kFixed : kTwice;
      }
    }
  }
  return motion;
}

/// "x, y and z" of the components with this state in some step.
std::string components(const NodeMotion& motion, int state) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < 3; ++k)
    if (std::any_of(motion.begin(), motion.end(), [&](const auto& step) { return step[k] == state; }))
      names.push_back(std::string(1, static_cast<char>('x' + k)));
  return and_list(names);
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

std::vector<MovedNodes> find_moved_nodes(const JointModel& model, const std::vector<int>& body_of_node,
                                         std::vector<Fault>& faults) {
  const int prescribed = static_cast<int>(model.prescribed_nodes.size());
  std::map<int, std::vector<int>> conditions_of_node;
  for (int c = 0; c < prescribed; ++c)
    for (int node : model.prescribed_nodes[at(c)].nodes)
      if (body_of_node[at(node)] < 0) conditions_of_node[node].push_back(c);
  if (conditions_of_node.empty()) return {};
  for (int f = 0; f < static_cast<int>(model.fixed_nodes.size()); ++f)
    for (int node : model.fixed_nodes[at(f)].nodes) {
      const auto place = conditions_of_node.find(node);
      if (place != conditions_of_node.end()) place->second.push_back(prescribed + f);
    }

  std::map<std::vector<int>, std::vector<int>> nodes_of_conditions;
  for (const auto& entry : conditions_of_node) nodes_of_conditions[entry.second].push_back(entry.first);

  const std::vector<int> classes = motion_classes(model);
  std::map<NodeMotion, MovedNodes> groups;
  std::vector<char> told(at(prescribed), 0);
  for (const auto& entry : nodes_of_conditions) {
    const int first = entry.first.front();
    const PrescribedNodes& condition = model.prescribed_nodes[at(first)];
    const NodeMotion motion = motion_of(model, entry.first, classes);
    const std::string free = components(motion, kFree), twice = components(motion, kTwice);
    if (!free.empty() || !twice.empty()) {
      if (told[at(first)]) continue;
      told[at(first)] = 1;
      const std::string who = fmt::format("prescribed displacement \"{}\": node {}", condition.name,
                                          model.node_ids[at(entry.second.front())]);
      faults.push_back(
          !twice.empty()
              ? make_fault(model, condition.origin, say("{} has two different conditions in {}:", who, twice),
                           "take one of them out")
              : make_fault(model, condition.origin,
                           say("{} is moved in {} and free in {}{}, so it is no bone;", who,
                               std::string(1, static_cast<char>('x' + condition.component)), free,
                               motion.size() > 1 ? " (in some step)" : ""),
                           "DEA moves bones: prescribe or fix these nodes in x, y and z in every step, or make the "
                           "part behind them a rigid body"));
      continue;
    }
    MovedNodes& group = groups[motion];
    if (group.nodes.empty()) {
      group.name = condition.name;
      for (int c : entry.first)
        if (c < prescribed) group.conditions.push_back(c);
    }
    group.nodes.insert(group.nodes.end(), entry.second.begin(), entry.second.end());
  }
  std::vector<MovedNodes> moved;
  for (auto& entry : groups) {
    std::sort(entry.second.nodes.begin(), entry.second.nodes.end());
    moved.push_back(std::move(entry.second));
  }
  std::sort(moved.begin(), moved.end(),
            [](const MovedNodes& a, const MovedNodes& b) { return a.nodes.front() < b.nodes.front(); });
  return moved;
}

}  // namespace dea

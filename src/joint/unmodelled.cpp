#include "src/joint/unmodelled.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "src/base/disjoint_sets.h"
#include "src/base/numbers.h"

namespace dea {

namespace {

/// Per node: the bodies it moves with. Empty: it moves freely.
std::vector<std::set<int>> bodies_of_nodes(const ModelParts& parts, const std::vector<ContactPair>& contacts) {
  const JointModel& model = parts.model;
  std::vector<std::set<int>> bodies(model.nodes.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    bodies[i].insert(parts.holders.of_node[i].begin(), parts.holders.of_node[i].end());
    if (parts.bodies.of_node[i] >= 0) bodies[i].insert(parts.bodies.of_node[i]);
    if (parts.moved[i] >= 0) bodies[i].insert(parts.moved[i]);
    if (parts.holders.fixed[i]) bodies[i].insert(parts.bodies.ground());
  }
  for (const RigidNodes& set : model.rigid_nodes)
    for (int node : set.nodes) bodies[at(node)].insert(parts.bodies.of_material[at(set.material)]);
  for (const ContactPair& pair : contacts)
    for (const Layer& layer : pair.layers)
      for (int node : layer.region_nodes) bodies[at(node)].insert(layer.body);
  return bodies;
}

/// Per node: of an element of a layer.
std::vector<char> nodes_of_layers(const ModelParts& parts, const std::vector<ContactPair>& contacts) {
  std::vector<char> in_layer(parts.model.nodes.size(), 0);
  for (const ContactPair& pair : contacts)
    for (const Layer& layer : pair.layers)
      for (int node : layer.region_nodes) in_layer[at(node)] = 1;
  return in_layer;
}

/// The dofs of a body that no step leaves free. `moved_too`: those that a step moves among them.
std::array<bool, kDofs> dofs_never_free(const ModelParts& parts, const Conditions& conditions, int body,
                                        bool moved_too) {
  std::array<bool, kDofs> never;
  never.fill(true);
  for (const std::vector<BodyHolds>& step : conditions.steps) {
    const BodyHolds holds = with_settings(step[at(body)], parts.model, parts.bodies.bodies, body, parts.settings);
    for (std::size_t k = 0; k < kDofs; ++k) {
      const BodyDof& dof = holds.dofs[k];
      const bool back = dof.by == HeldBy::Nodes && dof.motions.empty() && holds.nodes.motions.empty();
      never[k] =
          never[k] && (dof.state == DofState::Held || (dof.state == DofState::Prescribed && (moved_too || back)));
    }
  }
  return never;
}

/// Is the body where it is in every step? Then what fastens it carries nothing that the joint would feel.
bool stays(const ModelParts& parts, const Conditions& conditions, int body) {
  const std::array<bool, kDofs> held = dofs_never_free(parts, conditions, body, false);
  return std::all_of(held.begin(), held.end(), [](bool h) { return h; });
}

/// Of the components in which nodes are held: those in which the body moves, as no half of a symmetric joint does.
unsigned held_against(const ModelParts& parts, const Conditions& conditions, int body, unsigned held) {
  const std::array<bool, kDofs> given = dofs_never_free(parts, conditions, body, true);
  unsigned against = 0;
  for (unsigned k = 0; k < 3; ++k)
    if ((held >> k & 1u) != 0 && !(given[k] && given[3 + (k + 1) % 3] && given[3 + (k + 2) % 3])) against |= 1u << k;
  return against;
}

}  // namespace

Findings unmodelled_parts(const ModelParts& parts, const Conditions& conditions,
                          const std::vector<ContactPair>& contacts) {
  const JointModel& model = parts.model;
  const std::vector<std::set<int>> bodies = bodies_of_nodes(parts, contacts);
  const std::vector<char> in_layer = nodes_of_layers(parts, contacts);
  const auto each_element = [&](const auto& use) {
    for (const Domain& d : model.domains) {
      if (d.material < 0 || parts.rigid[at(d.material)]) continue;
      const int n = nodes_per_element(d.shape);
      for (std::size_t e = 0; e < d.element_ids.size(); ++e) {
        const int* nodes = d.nodes.data() + e * at(n);
        // of a layer, or its skin; a truss goes from one layer to another
        if (is_line(d.shape) || !std::all_of(nodes, nodes + n, [&](int node) { return in_layer[at(node)] != 0; }))
          use(d, nodes, n);
      }
    }
  };
  // Parts that meet at a bone alone are two: nodes that move with a body join nothing.
  DisjointSets sets(model.nodes.size());
  each_element([&](const Domain&, const int* nodes, int n) {
    int first = -1;
    for (int k = 0; k < n; ++k) {
      if (!bodies[at(nodes[k])].empty()) continue;
      if (first >= 0) sets.join(first, nodes[k]);
      first = nodes[k];
    }
  });
  struct Piece {
    std::set<int> bodies;
    unsigned held = 0;
    std::vector<std::string> names;
    int elements = 0;
  };
  std::vector<Piece> alone;  // elements of which every node moves with a body
  std::map<int, Piece> pieces;
  each_element([&](const Domain& d, const int* nodes, int n) {
    const int* free = std::find_if(nodes, nodes + n, [&](int node) { return bodies[at(node)].empty(); });
    if (free == nodes + n) alone.emplace_back();
    Piece& piece = free == nodes + n ? alone.back() : pieces[sets.root(*free)];
    for (int k = 0; k < n; ++k) {
      const std::set<int>& with = bodies[at(nodes[k])];
      piece.bodies.insert(with.begin(), with.end());
      if (with.empty()) piece.held |= parts.holders.mirror[at(nodes[k])];
    }
    if (piece.names.empty() || piece.names.back() != d.name) piece.names.push_back(d.name);
    ++piece.elements;
  });
  for (auto& entry : pieces) alone.push_back(std::move(entry.second));
  std::map<std::pair<std::set<int>, unsigned>, Piece> found;  // by what they are fastened to
  for (const Piece& piece : alone) {
    const unsigned held =
        piece.bodies.size() == 1 ? held_against(parts, conditions, *piece.bodies.begin(), piece.held) : 0;
    if (piece.bodies.size() < 2 && held == 0) continue;
    if (std::all_of(piece.bodies.begin(), piece.bodies.end(), [&](int b) { return stays(parts, conditions, b); }))
      continue;
    Piece& part = found[{piece.bodies, held}];
    for (const std::string& name : piece.names)
      if (std::find(part.names.begin(), part.names.end(), name) == part.names.end()) part.names.push_back(name);
    part.elements += piece.elements;
  }
  Findings all;
  for (const auto& [fastened, part] : found) {
    std::vector<std::string> bodies, components;
    for (const int b : fastened.first) bodies.push_back(parts.bodies.bodies[at(b)].name);
    for (unsigned k = 0; k < 3; ++k)
      if ((fastened.second >> k & 1u) != 0) components.emplace_back(1, "xyz"[k]);
    all.push_back({"part-not-modelled",
                   {.body = bodies.front()},
                   {{"parts", part.names}, {"elements", part.elements}, {"bodies", bodies}, {"components", components}},
                   components.empty() ? 1 : 0});
  }
  return all;
}

namespace {

/// What the nodes of a surface belong to.
struct SurfaceEnd {
  std::set<int> bodies;   ///< of nodes of rigid elements
  std::set<int> regions;  ///< deformable parts of the others
};
SurfaceEnd end_of(const ModelParts& parts, const Surface& s) {
  SurfaceEnd end;
  for (int node : s.nodes) {
    if (parts.bodies.of_node[at(node)] >= 0)
      end.bodies.insert(parts.bodies.of_node[at(node)]);
    else if (parts.region[at(node)] >= 0)
      end.regions.insert(parts.region[at(node)]);
  }
  return end;
}

/// The one body that holds all these parts; -1: there is none.
int holder_of(const ModelParts& parts, const std::set<int>& regions) {
  int body = -1;
  for (int region : regions) {
    const auto held = parts.holders.of_region.find(region);
    if (held == parts.holders.of_region.end() || held->second.size() != 1) return -1;
    if (body >= 0 && held->second.begin()->first != body) return -1;
    body = held->second.begin()->first;
  }
  return body;
}

}  // namespace

Findings dropped_ties(const ModelParts& parts, const Conditions& conditions) {
  const JointModel& model = parts.model;
  Findings dropped;
  const auto body_name = [&](int body) { return parts.bodies.bodies[at(body)].name; };
  const auto add_pair = [&](const std::string& name, int a, int b) {
    if (!stays(parts, conditions, a) || !stays(parts, conditions, b))
      dropped.push_back({"tie-left-out", {.body = body_name(a)}, {{"tie", name}, {"other", body_name(b)}}});
  };
  for (const Contact& c : model.contacts) {
    if (c.kind != Contact::Kind::Tied || c.primary < 0 || c.secondary < 0) continue;
    const SurfaceEnd a = end_of(parts, model.surfaces[at(c.primary)]),
                     b = end_of(parts, model.surfaces[at(c.secondary)]);
    const std::string name = fmt::format("contact \"{}\"", c.name);
    if (a.regions.empty() && b.regions.empty() && a.bodies.size() == 1 && b.bodies.size() == 1 &&
        a.bodies != b.bodies) {
      add_pair(name, *a.bodies.begin(), *b.bodies.begin());
    } else if (!a.regions.empty() && !b.regions.empty() && a.regions != b.regions) {
      const auto soft = [&](const std::set<int>& regions) {
        return std::any_of(regions.begin(), regions.end(), [&](int r) { return parts.holders.soft_ties.count(r) > 0; });
      };
      const int body = holder_of(parts, a.regions);
      if (body >= 0 && body == holder_of(parts, b.regions) && !soft(a.regions) && !soft(b.regions))
        dropped.push_back({"pieces-side-by-side", {.body = body_name(body)}, {{"tie", name}}});
    }
  }
  for (const RigidNodes& set : model.rigid_nodes) {
    const int body = parts.bodies.of_material[at(set.material)];
    std::set<int> others;
    for (int node : set.nodes)
      if (const int other = parts.bodies.of_node[at(node)]; other >= 0 && other != body) others.insert(other);
    for (int other : others) add_pair(fmt::format("rigid node set \"{}\"", set.name), body, other);
  }
  return dropped;
}

}  // namespace dea

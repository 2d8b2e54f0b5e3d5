// Bones that a material taken as rigid would make one body of.
#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "src/base/disjoint_sets.h"
#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/facts/conditions.h"
#include "src/facts/parts.h"

namespace dea {

namespace {

/// Elements of rigid materials that nodes, rigid bodies of the model or ties join.
struct LoosePiece {
  int elements = 0;
  Vector3d at_node = Vector3d::Zero();  ///< one of its nodes, for words
  bool matters = false;                 ///< the rest of the model has to do with it
  int taken = -1;                       ///< a material of it that the user takes as rigid, -1: none
  std::vector<int> in_model;            ///< materials of it that the model has rigid
  std::vector<int> held;                ///< its nodes that are fixed or prescribed
};

/// Sets of nodes, and of materials behind them. Those of a material that is rigid in the model are one.
DisjointSets joined_nodes(const ModelParts& parts) {
  const JointModel& model = parts.model;
  const auto nodes = static_cast<int>(model.nodes.size());
  DisjointSets sets(model.nodes.size() + model.materials.size());
  for (const Domain& d : model.domains) {
    if (d.material < 0 || !parts.rigid[at(d.material)] || is_line(d.shape)) continue;
    const std::size_t n = at(nodes_per_element(d.shape));
    const bool whole = model.materials[at(d.material)].rigid;
    for (std::size_t i = 0; i < d.nodes.size(); ++i)
      sets.join(d.nodes[i], whole ? nodes + d.material : d.nodes[i / n * n]);
  }
  for (const RigidNodes& set : model.rigid_nodes)
    for (const int node : set.nodes)
      if (parts.bodies.of_node[at(node)] >= 0) sets.join(node, nodes + set.material);
  for (const Contact& c : model.contacts) {  // a tie of one bone to one other
    if (c.kind != Contact::Kind::Tied || c.primary < 0 || c.secondary < 0 || c.step >= 0) continue;
    std::set<int> roots[2];
    for (int side = 0; side < 2; ++side)
      for (const int node : model.surfaces[at(side == 0 ? c.primary : c.secondary)].nodes)
        if (parts.bodies.of_node[at(node)] >= 0) roots[side].insert(sets.root(node));
    if (roots[0].size() == 1 && roots[1].size() == 1) sets.join(*roots[0].begin(), *roots[1].begin());
  }
  return sets;
}

/// Per node: is it cartilage, on a contact, loaded, at a spring, held or moved?
std::vector<char> nodes_that_matter(const ModelParts& parts) {
  const JointModel& model = parts.model;
  std::vector<char> matters(model.nodes.size(), 0);
  const auto mark = [&](const std::vector<int>& nodes) {
    for (const int node : nodes) matters[at(node)] = 1;
  };
  for (const Domain& d : model.domains)
    if (deformable(parts, d)) mark(d.nodes);
  for (const Contact& c : model.contacts)
    for (const int surface : {c.primary, c.secondary})
      if (surface >= 0) mark(model.surfaces[at(surface)].nodes);
  for (const NodalForce& f : model.nodal_forces) mark(f.nodes);
  for (std::size_t i = 0; i < matters.size(); ++i)
    if (!parts.node_holds.of(static_cast<int>(i)).empty()) matters[i] = 1;
  for (const RigidNodes& set : model.rigid_nodes) mark(set.nodes);
  for (const DiscreteSet& set : model.discrete_sets)
    for (const auto& [a, b] : set.pairs) matters[at(a)] = matters[at(b)] = 1;
  return matters;
}

/// Do its nodes, or the rigid body that it hangs on, leave it no motion of its own in this step?
bool is_held(const ModelParts& parts, const LoosePiece& piece, int step) {
  const JointModel& model = parts.model;
  std::array<bool, kDofs> dofs = {};
  const auto on_this_body = [&](int material) {
    return std::find(piece.in_model.begin(), piece.in_model.end(), material) != piece.in_model.end();
  };
  for (const RigidFixed& f : model.rigid_fixed)
    for (std::size_t k = 0; k < kDofs; ++k)
      dofs[k] = dofs[k] || (f.dofs[k] && f.acts(step) && on_this_body(f.material));
  for (const RigidPrescribed& p : model.rigid_prescribed)
    if (p.acts(step) && on_this_body(p.material)) dofs[at(p.dof)] = true;
  if (std::all_of(dofs.begin(), dofs.end(), [](bool held) { return held; })) return true;
  double length = 0.0;
  std::vector<NodeRow> rows;
  for (const int node : piece.held) {
    const Vector3d arm = model.nodes[at(node)] - piece.at_node;
    length = std::max(length, arm.norm());
    for (const NodeHold& hold : parts.node_holds.of(node))
      if (hold.acts(step)) rows.push_back({hold.component, arm, -1, true});
  }
  return span_of(rows, length > 0 ? length : 1.0).conditions == kDofs;
}

/// Do the settings say of the whole body how it moves?
bool is_told(const ModelParts& parts, int body) {
  const auto names = [&](const std::string& name) { return names_body(parts.model, parts.bodies.bodies, name, body); };
  for (const auto& [name, dofs] : parts.settings.free)
    if (names(name) && std::none_of(dofs.begin(), dofs.end(), [](bool free) { return free; })) return true;
  return parts.settings.motion.turns && names(parts.settings.motion.body);
}

}  // namespace

std::vector<Fault> separate_pieces(const ModelParts& parts) {
  const JointModel& model = parts.model;
  const auto by_user = [&](int m) { return parts.rigid[at(m)] && !model.materials[at(m)].rigid; };
  std::vector<Fault> faults;
  if (parts.settings.rigid.empty()) return faults;
  DisjointSets sets = joined_nodes(parts);
  const std::vector<char> matters = nodes_that_matter(parts);
  std::vector<std::map<int, LoosePiece>> pieces(parts.bodies.bodies.size());
  for (const Domain& d : model.domains) {
    if (d.material < 0 || !parts.rigid[at(d.material)] || is_line(d.shape)) continue;
    const int n = nodes_per_element(d.shape);
    for (std::size_t e = 0; e < d.element_ids.size(); ++e) {
      const int* nodes = d.nodes.data() + e * at(n);
      LoosePiece& piece = pieces[at(parts.bodies.of_material[at(d.material)])][sets.root(nodes[0])];
      if (piece.elements++ == 0) piece.at_node = model.nodes[at(nodes[0])];
      if (by_user(d.material))
        piece.taken = d.material;
      else if (piece.in_model.empty() || piece.in_model.back() != d.material)
        piece.in_model.push_back(d.material);
      piece.matters = piece.matters || std::any_of(nodes, nodes + n, [&](int node) { return matters[at(node)] != 0; });
    }
  }
  for (int node = 0; node < static_cast<int>(model.nodes.size()); ++node) {
    const int body = parts.bodies.of_node[at(node)];
    if (body < 0 || parts.node_holds.of(node).empty()) continue;
    const auto piece = pieces[at(body)].find(sets.root(node));
    if (piece != pieces[at(body)].end()) piece->second.held.push_back(node);
  }
  const auto stays = [&](const LoosePiece& piece) {
    for (int step = 0; step < static_cast<int>(model.steps.size()); ++step)
      if (!is_held(parts, piece, step)) return false;
    return true;
  };
  for (std::size_t b = 0; b < pieces.size(); ++b) {
    std::vector<const LoosePiece*> apart;
    int taken = -1;
    for (const auto& entry : pieces[b]) {
      if (!entry.second.matters) continue;
      apart.push_back(&entry.second);
      if (entry.second.taken >= 0) taken = entry.second.taken;
    }
    if (apart.size() < 2 || taken < 0 || is_told(parts, static_cast<int>(b)) ||
        std::all_of(apart.begin(), apart.end(), [&](const LoosePiece* piece) { return stays(*piece); }))
      continue;
    std::string list;
    for (std::size_t i = 0; i < std::min<std::size_t>(apart.size(), 3); ++i)
      list += fmt::format("{}{} elements at {:.4g},{:.4g},{:.4g}", i > 0 ? ", " : "", apart[i]->elements,
                          apart[i]->at_node[0], apart[i]->at_node[1], apart[i]->at_node[2]);
    if (apart.size() > 3) list += ", ...";
    const Material& material = model.materials[at(taken)];
    faults.push_back(make_fault(
        model, material.origin,
        say("material \"{}\" is taken as rigid ({}), and its body is {} pieces that nothing rigid joins ({}): one body "
            "of them would move them together, where FEBio moves each by itself;",
            material.name, NamedSetting{"rigid"}, apart.size(), list),
        "give each piece a material of its own, or take what joins them as rigid too"));
  }
  return faults;
}

}  // namespace dea

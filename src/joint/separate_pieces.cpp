#include <febiodea/joint/separate_pieces.h>

#include <algorithm>
#include <map>

#include <febiodea/base/decompositions.h>
#include <febiodea/base/disjoint_sets.h>
#include <febiodea/base/numbers.h>
#include <febiodea/base/say.h>

namespace dea {

namespace {

/// Elements of rigid materials that nodes, rigid bodies of the model or ties join.
struct Piece {
  int elements = 0;
  Vector3d at_node = Vector3d::Zero();    ///< one of its nodes, for words
  bool matters = false;                   ///< the rest of the model has to do with it
  std::vector<std::pair<int, int>> held;  ///< nodes fixed in all steps, and their component
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
  for (const Contact& c : model.contacts) {
    if (c.kind != Contact::Kind::Tied || c.primary < 0 || c.secondary < 0) continue;
    int first = -1;
    for (const int surface : {c.primary, c.secondary})
      for (const int node : model.surfaces[at(surface)].nodes) {
        if (parts.bodies.of_node[at(node)] < 0) continue;
        if (first >= 0) sets.join(first, node);
        first = node;
      }
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
  for (const FixedNodes& f : model.fixed_nodes) mark(f.nodes);
  for (const PrescribedNodes& p : model.prescribed_nodes) mark(p.nodes);
  for (const RigidNodes& set : model.rigid_nodes) mark(set.nodes);
  for (const DiscreteSet& set : model.discrete_sets)
    for (const auto& [a, b] : set.pairs) matters[at(a)] = matters[at(b)] = 1;
  return matters;
}

/// Do its fixed nodes leave it no motion?
bool is_held(const JointModel& model, const Piece& piece) {
  Eigen::Matrix<double, 6, 6> gram = Eigen::Matrix<double, 6, 6>::Zero();
  double length = 0.0;
  for (const auto& [node, component] : piece.held)
    length = std::max(length, (model.nodes[at(node)] - piece.at_node).norm());
  for (const auto& [node, component] : piece.held) {
    const Vector3d arm = (model.nodes[at(node)] - piece.at_node) / (length > 0 ? length : 1.0);
    Eigen::Matrix<double, 6, 1> row;
    row << Vector3d::Unit(component), arm.cross(Vector3d::Unit(component));
    gram += row * row.transpose();
  }
  const Eigenvalues eigen = symmetric_eigen(gram);
  return eigen.values[0] > 1e-8 * eigen.values[5];
}

}  // namespace

std::vector<Fault> separate_pieces(const ModelParts& parts) {
  const JointModel& model = parts.model;
  const auto by_user = [&](int m) { return parts.rigid[at(m)] && !model.materials[at(m)].rigid; };
  std::vector<Fault> faults;
  if (parts.settings.rigid.empty()) return faults;
  DisjointSets sets = joined_nodes(parts);
  const std::vector<char> matters = nodes_that_matter(parts);
  std::vector<std::map<int, Piece>> pieces(parts.bodies.bodies.size());
  for (const Domain& d : model.domains) {
    if (d.material < 0 || !parts.rigid[at(d.material)] || is_line(d.shape)) continue;
    const int n = nodes_per_element(d.shape);
    for (std::size_t e = 0; e < d.element_ids.size(); ++e) {
      const int* nodes = d.nodes.data() + e * at(n);
      Piece& piece = pieces[at(parts.bodies.of_material[at(d.material)])][sets.root(nodes[0])];
      if (piece.elements++ == 0) piece.at_node = model.nodes[at(nodes[0])];
      piece.matters = piece.matters || std::any_of(nodes, nodes + n, [&](int node) { return matters[at(node)] != 0; });
    }
  }
  for (const FixedNodes& f : model.fixed_nodes)
    for (const int node : f.nodes) {
      const int body = parts.bodies.of_node[at(node)];
      if (body < 0 || f.step >= 0) continue;
      const auto piece = pieces[at(body)].find(sets.root(node));
      for (int k = 0; k < 3 && piece != pieces[at(body)].end(); ++k)
        if (f.xyz[at(k)]) piece->second.held.emplace_back(node, k);
    }
  for (std::size_t b = 0; b < pieces.size(); ++b) {
    const std::vector<int>& materials = parts.bodies.bodies[b].materials;
    const auto taken = std::find_if(materials.begin(), materials.end(), by_user);
    if (taken == materials.end()) continue;
    std::vector<const Piece*> apart;
    for (const auto& entry : pieces[b])
      if (entry.second.matters) apart.push_back(&entry.second);
    if (apart.size() < 2 ||
        std::all_of(apart.begin(), apart.end(), [&](const Piece* piece) { return is_held(model, *piece); }))
      continue;
    std::string list;
    for (std::size_t i = 0; i < std::min<std::size_t>(apart.size(), 3); ++i)
      list += fmt::format("{}{} elements at {:.4g},{:.4g},{:.4g}", i > 0 ? ", " : "", apart[i]->elements,
                          apart[i]->at_node[0], apart[i]->at_node[1], apart[i]->at_node[2]);
    if (apart.size() > 3) list += ", ...";
    const Material& material = model.materials[at(*taken)];
    faults.push_back(make_fault(model, material.origin,
                                say("material \"{}\" is taken as rigid ({}), and is {} pieces that nothing joins ({}): "
                                    "one body of them would move them together, where FEBio moves each by itself;",
                                    material.name, NamedSetting{"rigid"}, apart.size(), list),
                                "give each piece a material of its own"));
  }
  return faults;
}

}  // namespace dea

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/facts/parts.h"
#include "src/joint/part.h"

namespace dea {

namespace {

/// The stiffness of a material at small strain. InputError: the model does not tell it.
Matrix6d elastic_of(const JointModel& model, const Material& m, const std::string& part) {
  if (m.E > 0 && m.nu > -1 && m.nu < 0.5) return isotropic_stiffness(m.E, m.nu);
  throw fault_at(
      model, m.origin,
      say("material \"{}\" of part \"{}\": E = {:g}, nu = {:g} ({});", m.name, part, m.E, m.nu, m.note),
      say("give the part a material with a stiffness, or take it as rigid with {}", NamedSetting{"rigid", "", m.name}));
}

/// Calls `use(domain, nodes, n)` for each element of a region.
template <class Use>
void for_each_element(const ModelParts& parts, int region, const Use& use) {
  for (const Domain& d : parts.model.domains) {
    if (!deformable(parts, d)) continue;
    const int n = nodes_per_element(d.shape);
    for (std::size_t e = 0; e < d.element_ids.size(); ++e)
      if (const int* nodes = d.nodes.data() + e * at(n); parts.region[at(nodes[0])] == region) use(d, nodes, n);
  }
}

/// Two bodies hold it: how it joins them is not known here.
InputError held_by_two(const ModelParts& parts, const SoftRegion& soft) {
  const std::vector<Body>& bodies = parts.bodies.bodies;
  return fault_at(parts.model, {0, 0},
                  say("part \"{}\" is held by two bodies, \"{}\" and \"{}\", which is not modelled;", soft.name,
                      bodies[at(soft.body)].name, bodies[at(soft.other)].name),
                  "hold its nodes by one of them, or fasten it to the other with springs");
}

SoftPart make_part(const ModelParts& parts, const SoftRegion& soft) {
  const JointModel& model = parts.model;
  if (soft.other >= 0) throw held_by_two(parts, soft);
  SoftPart part;
  part.name = soft.name;
  part.body = soft.body;
  part.other = soft.other;
  std::vector<int>& nodes_of = part.model_nodes;
  for_each_element(parts, soft.region,
                   [&](const Domain&, const int* nodes, int n) { nodes_of.insert(nodes_of.end(), nodes, nodes + n); });
  std::sort(nodes_of.begin(), nodes_of.end());
  nodes_of.erase(std::unique(nodes_of.begin(), nodes_of.end()), nodes_of.end());
  Eigen::AlignedBox3d box;
  for (const int node : nodes_of) {
    part.mesh.nodes.push_back(model.nodes[at(node)]);
    box.extend(model.nodes[at(node)]);
    const std::vector<int>& holders = parts.holders.of_node[at(node)];
    part.holder.push_back(holders.empty() ? -1 : holders.front());
  }
  part.depth = 0.5 * box.sizes().minCoeff();
  for_each_element(parts, soft.region, [&](const Domain& d, const int* nodes, int n) {
    const Material& material = model.materials[at(d.material)];
    if (!has_stiffness(d.shape))
      throw fault_at(
          model, material.origin,
          say("part \"{}\" has elements {}, whose stiffness is not known;", part.name, element_type(d.shape).name),
          "mesh it with hex8, hex20, hex27, penta6, penta15, tet4, tet10, tet15 or pyra5");
    part.mesh.shape.push_back(d.shape);
    part.mesh.material.push_back(d.material);
    part.mesh.elastic.push_back(elastic_of(model, material, part.name));
    for (int k = 0; k < n; ++k) part.mesh.element_node.push_back(part.node_of(nodes[k]));
    part.mesh.begin.push_back(static_cast<int>(part.mesh.element_node.size()));
  });
  return part;
}

}  // namespace

std::vector<SoftPart> make_parts(const ModelParts& parts) {
  std::vector<SoftPart> made;
  for (const SoftRegion& soft : parts.soft) made.push_back(make_part(parts, soft));
  return made;
}

}  // namespace dea

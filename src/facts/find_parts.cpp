#include "src/facts/find_parts.h"

#include <algorithm>
#include <utility>

#include "src/base/disjoint_sets.h"
#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/facts/given_layer.h"
#include "src/facts/soft_regions.h"

namespace dea {

namespace {

std::vector<int> find_regions(const ModelParts& parts) {
  const JointModel& model = parts.model;
  DisjointSets sets(model.nodes.size());
  std::vector<char> of_layer(model.nodes.size(), 0);
  for (const Domain& d : model.domains) {
    if (!deformable(parts, d)) continue;
    const int n = nodes_per_element(d.shape);
    for (std::size_t e = 0; e < d.element_ids.size(); ++e) {
      const int* nodes = d.nodes.data() + e * at(n);
      for (int k = 0; k < n; ++k) {
        of_layer[at(nodes[k])] = 1;
        sets.join(nodes[0], nodes[k]);
      }
    }
  }
  std::vector<int> region(model.nodes.size(), -1);
  for (std::size_t i = 0; i < model.nodes.size(); ++i)
    if (of_layer[i]) region[i] = sets.root(static_cast<int>(i));
  return region;
}

FaceMap find_faces(const JointModel& model, const Settings& settings) {
  std::vector<char> on_surface(model.nodes.size(), 0);
  const auto mark = [&](int surface) {
    if (surface < 0) return;
    for (int node : model.surfaces[at(surface)].nodes) on_surface[at(node)] = 1;
  };
  for (const Contact& c : model.contacts) {
    mark(c.primary);
    mark(c.secondary);
  }
  for (const auto& entry : settings.bone) mark(surface_index(model, entry.second));
  FaceMap found;
  int face_nodes[9];
  for (int d = 0; d < static_cast<int>(model.domains.size()); ++d) {
    const Domain& domain = model.domains[at(d)];
    const int n = nodes_per_element(domain.shape);
    const auto& faces = element_faces(domain.shape);
    for (int e = 0; e < static_cast<int>(domain.element_ids.size()); ++e) {
      const int* nodes = domain.nodes.data() + static_cast<std::ptrdiff_t>(e) * n;
      for (int f = 0; f < static_cast<int>(faces.size()); ++f) {
        const int corners = facet_corners(static_cast<int>(faces[at(f)].size()));
        bool all = true;
        for (int k = 0; k < corners && all; ++k) {
          face_nodes[k] = nodes[faces[at(f)][at(k)]];
          all = on_surface[at(face_nodes[k])];
        }
        if (all) found[face_key(face_nodes, corners)].push_back({d, e, f});
      }
    }
  }
  return found;
}

/// Contacts of type "dea" whose layer is to be measured: the elements under the surface are the cartilage, though
/// rigid.
std::vector<char> find_layer_domains(const ModelParts& parts) {
  const JointModel& model = parts.model;
  std::vector<char> layer_domains(model.domains.size(), 0);
  for (const Contact& c : model.contacts) {
    if (!c.dea || c.primary < 0 || c.secondary < 0) continue;
    for (int side = 0; side < 2; ++side) {
      const GivenLayer given = given_layer(model, parts.settings, c, side);
      if (given.has_thickness() || (!given.E && !given.nu)) continue;
      const Surface& s = model.surfaces[at(side == 0 ? c.primary : c.secondary)];
      for (int f = 0; f < s.size(); ++f) {
        const auto* found = find_face(parts, s, f);
        if (found == nullptr) continue;
        for (const ElementFace& face : *found)
          if (!is_shell(model.domains[at(face.domain)].shape)) layer_domains[at(face.domain)] = 1;
      }
    }
  }
  return layer_domains;
}

/// Bodies of moved nodes, put before the ground.
void add_moved_bodies(ModelParts& parts) {
  const JointModel& model = parts.model;
  Bodies& bodies = parts.bodies;
  parts.moved.assign(model.nodes.size(), -1);
  std::vector<int> body = bodies.of_node;
  for (const RigidNodes& set : model.rigid_nodes)
    for (int node : set.nodes) body[at(node)] = bodies.of_material[at(set.material)];
  for (const MovedNodes& moved : find_moved_nodes(model, body, parts.faults)) {
    Body found;
    found.name = moved.name;
    found.moved_by = moved.conditions;
    for (int node : moved.nodes)
      found.center_of_mass += model.nodes[at(node)] / static_cast<double>(moved.nodes.size());
    const int index = add_body(bodies, std::move(found));
    for (int node : moved.nodes) parts.moved[at(node)] = index;
    parts.findings.push_back(
        {"nodes-taken-as-bone", {.body = bodies.bodies[at(index)].name}, {{"nodes", moved.nodes.size()}}});
  }
}

}  // namespace

ModelParts find_parts(const JointModel& model, const Settings& settings) {
  ModelParts parts{model, settings, rigid_materials(model, settings), {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}};
  parts.node_holds = find_node_holds(model);
  parts.faces = find_faces(model, settings);
  parts.layer_domains = find_layer_domains(parts);
  parts.bodies = find_bodies(model, parts.rigid, parts.layer_domains);
  parts.region = find_regions(parts);
  add_moved_bodies(parts);
  parts.holders = find_holders(model, parts.bodies, parts.region, parts.node_holds, parts.moved);
  find_soft_regions(parts);
  add_once(parts.findings, far_ties(model, parts.holders));
  add_once(parts.findings, holds_of_some_steps(model, parts.holders, parts.region, parts.node_holds, parts.moved));
  return parts;
}

}  // namespace dea

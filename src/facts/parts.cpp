#include "src/facts/parts.h"

#include <algorithm>

#include "src/base/numbers.h"

namespace dea {

int region_of(const ModelParts& parts, const Domain& d, int element) {
  const int region = parts.region[at(d.nodes[at(element * nodes_per_element(d.shape))])];
  if (parts.beside.empty()) return region;
  const auto part = parts.beside.find({region, d.material});
  return part == parts.beside.end() ? region : part->second;
}

int soft_region(const ModelParts& parts, int region) {
  for (std::size_t k = 0; k < parts.soft.size() && region >= 0; ++k)
    if (parts.soft[k].region == region) return static_cast<int>(k);
  return -1;
}

bool deformable(const ModelParts& parts, const Domain& d) {
  if (d.material < 0 || is_line(d.shape) || is_shell(d.shape)) return false;
  const auto index = static_cast<std::size_t>(&d - parts.model.domains.data());
  return !parts.rigid[at(d.material)] || parts.layer_domains[index];
}

const std::vector<ElementFace>* find_face(const ModelParts& parts, const int* nodes, int count) {
  const auto found = parts.faces.find(face_key(nodes, facet_corners(count)));
  return found == parts.faces.end() ? nullptr : &found->second;
}

const std::vector<ElementFace>* find_face(const ModelParts& parts, const Surface& s, int facet) {
  return find_face(parts, s.nodes.data() + s.begin[at(facet)], s.begin[at(facet) + 1] - s.begin[at(facet)]);
}

const ElementFace* carrier(const ModelParts& parts, const std::vector<ElementFace>* candidates) {
  if (candidates == nullptr) return nullptr;
  const ElementFace* best = nullptr;
  int best_rank = 4;
  for (const ElementFace& c : *candidates) {
    const Domain& d = parts.model.domains[at(c.domain)];
    const int rank = deformable(parts, d) ? 0 : is_shell(d.shape) ? 2 : d.material >= 0 ? 1 : 3;
    if (rank < best_rank) {
      best = &c;
      best_rank = rank;
    }
  }
  return best;
}

int body_of_material(const ModelParts& parts, int material) {
  return material < 0 ? parts.bodies.ground() : parts.bodies.of_material[at(material)];
}

int body_by_name(const JointModel& model, const std::vector<Body>& bodies, const std::string& name) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (bodies[b].name == name) return static_cast<int>(b);
    for (int m : bodies[b].materials)
      if (model.materials[at(m)].name == name) return static_cast<int>(b);
  }
  return -1;
}

bool names_body(const JointModel& model, const std::vector<Body>& bodies, const std::string& name, int body) {
  return !name.empty() && body_by_name(model, bodies, name) == body;
}

int surface_index(const JointModel& model, const std::string& name) {
  for (std::size_t i = 0; i < model.surfaces.size(); ++i)
    if (model.surfaces[i].name == name) return static_cast<int>(i);
  return -1;
}

}  // namespace dea

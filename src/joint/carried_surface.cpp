#include "src/joint/carried_surface.h"

#include <algorithm>
#include <set>

#include "src/base/numbers.h"
#include "src/base/say.h"

namespace dea {

namespace {

Vector3d area_vector(const JointModel& model, const int* nodes, int count) {
  Vector3d sum = Vector3d::Zero();
  for (const auto& t : split_facet(nodes, count, model.nodes))
    sum += (model.nodes[at(t[1])] - model.nodes[at(t[0])]).cross(model.nodes[at(t[2])] - model.nodes[at(t[0])]);
  return sum;
}

/// Turns the facet to the sense of rotation of the element's outward face. Asked by area, for a collapsed face repeats
/// a node. True: it was the other one.
bool turn_outward(const JointModel& model, const ElementFace& c, std::vector<int>& facet) {
  const Domain& d = model.domains[at(c.domain)];
  const auto& face = element_faces(d.shape)[at(c.face)];
  int face_nodes[9];
  for (std::size_t k = 0; k < face.size(); ++k)
    face_nodes[k] = d.nodes[at(c.element * nodes_per_element(d.shape) + face[k])];
  const int count = static_cast<int>(facet.size());
  if (area_vector(model, facet.data(), count).dot(area_vector(model, face_nodes, static_cast<int>(face.size()))) >= 0)
    return false;
  turn_round(facet);
  return true;
}

InputError no_face(const JointModel& model, const Surface& s, int facet) {
  std::string ids;
  for (int i = s.begin[at(facet)]; i < s.begin[at(facet) + 1]; ++i)
    ids += fmt::format("{}{}", ids.empty() ? "" : ",", model.node_ids[at(s.nodes[at(i)])]);
  return fault_at(model, s.origin,
                  say("surface \"{}\": facet {} (nodes {}) is no face of any element; the surface and the mesh do "
                      "not fit together,",
                      s.name, facet + 1, ids),
                  "define the surface again on this mesh");
}

}  // namespace

void turn_round(std::vector<int>& facet) {
  const int count = static_cast<int>(facet.size()), corners = facet_corners(count);
  std::reverse(facet.begin() + 1, facet.begin() + corners);
  if (count >= 2 * corners) std::reverse(facet.begin() + corners, facet.begin() + 2 * corners);
}

void check_volume(const JointModel& model, const Domain& d, int element) {
  const double volume = element_volume(model, d, element).volume;
  if (volume > 0) return;
  const std::string which = fmt::format("element {} of \"{}\"", d.element_ids[at(element)], d.name);
  if (volume < 0)
    throw fault_at(model, d.origin, say("{} is inside out (volume {:g});", which, volume),
                   "check the node order of its elements, and the coordinates of its nodes");
  throw fault_at(model, d.origin, say("{} has no volume;", which),
                 "check its thickness and the positions of its nodes");
}

CarriedSurface carry(const ModelParts& parts, int surface) {
  const JointModel& model = parts.model;
  const Surface& s = model.surfaces[at(surface)];
  CarriedSurface out;
  if (s.size() == 0)
    throw fault_at(model, s.origin, say("surface \"{}\" has no facets:", s.name),
                   "define it again, or take its contact out");
  for (int f = 0; f < s.size(); ++f) {
    const ElementFace* c = carrier(parts, find_face(parts, s, f));
    if (c == nullptr) throw no_face(model, s, f);
    out.carriers.push_back(*c);
    std::vector<int> facet(s.nodes.begin() + s.begin[at(f)], s.nodes.begin() + s.begin[at(f) + 1]);
    if (is_shell(model.domains[at(c->domain)].shape)) {
      out.on_shells = true;
    } else {
      check_volume(model, model.domains[at(c->domain)], c->element);
      out.turned += turn_outward(model, *c, facet) ? 1 : 0;
    }
    out.facets.add(facet);
  }
  return out;
}

std::string deformable_shells(const ModelParts& parts, const Surface& s) {
  std::set<std::string> names;
  for (int f = 0; f < s.size(); ++f) {
    const std::vector<ElementFace>* faces = find_face(parts, s, f);
    if (faces == nullptr) continue;
    for (const ElementFace& face : *faces) {
      const Domain& d = parts.model.domains[at(face.domain)];
      if (is_shell(d.shape) && d.material >= 0 && !parts.rigid[at(d.material)]) names.insert("\"" + d.name + "\"");
    }
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace dea

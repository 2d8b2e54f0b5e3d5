#include "src/joint/carried_surface.h"

#include <algorithm>

#include "src/base/numbers.h"
#include "src/base/say.h"

namespace dea {

namespace {

/// Turns the facet to the sense of rotation of the element's outward face. Asked by area, for a collapsed face repeats
/// a node. True: it was the other one.
bool turn_outward(const JointModel& model, const ElementFace& c, std::vector<int>& facet) {
  const Domain& d = model.domains[at(c.domain)];
  const auto& face = element_faces(d.shape)[at(c.face)];
  std::vector<int> face_nodes;
  for (const int k : face) face_nodes.push_back(d.nodes[at(c.element * nodes_per_element(d.shape) + k)]);
  if (area_vector(facet, model.nodes).dot(area_vector(face_nodes, model.nodes)) >= 0) return false;
  facet = turned_round(facet);
  return true;
}

InputError no_face(const JointModel& model, const Surface& s, int facet) {
  std::string ids;
  for (const int node : s.facet(facet)) ids += fmt::format("{}{}", ids.empty() ? "" : ",", model.node_ids[at(node)]);
  return fault_at(model, s.origin,
                  say("surface \"{}\": facet {} (nodes {}) is no face of any element; the surface and the mesh do "
                      "not fit together,",
                      s.name, facet + 1, ids),
                  "define the surface again on this mesh");
}

}  // namespace

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
    std::vector<int> facet = s.facet(f);
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

}  // namespace dea

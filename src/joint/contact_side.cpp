#include "src/joint/contact_side.h"

#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/facts/symmetry_planes.h"

namespace dea {

ContactSide contact_side(const ModelParts& parts, const Contact& contact, int side) {
  const int index = side == 0 ? contact.primary : contact.secondary;
  return {parts,
          contact,
          side,
          index,
          parts.model.surfaces[at(index)],
          given_layer(parts.model, parts.settings, contact, side),
          {},
          {}};
}

void find_planes(ContactSide& in) {
  const Holders& holders = in.parts.holders;
  in.planes = planes_of_contact(in.parts.model, in.contact, in.parts.region, holders.ends, holders.same_plane);
  in.in_plane = nodes_in_planes(in.parts.model.nodes, in.planes, holders.same_plane);
}

InputError refusal_of(const ContactSide& in, const Sentence& found, const Sentence& expected) {
  return fault_at(in.parts.model, in.surface.origin,
                  say("contact \"{}\", surface \"{}\": {}", in.contact.name, in.surface.name, found), expected);
}

InputError unmeasured(const ContactSide& in, const char* why) {
  return refusal_of(in, say("the thickness of its layer cannot be measured, for {};", why),
                    say("give it in the contact as <{}>, or with {}", parameter_of(in, "thickness"),
                        NamedSetting{"thickness", in.surface.name, "VALUE"}));
}

NamedSetting setting_of(const ContactSide& in, const char* setting, const char* value) {
  const std::string name = setting;
  const bool parameter = in.contact.dea && (name == "thickness" || name == "E" || name == "nu");
  return {name, in.surface.name, value, parameter ? parameter_of(in, setting) : ""};
}

Sentence modulus_settings(const ContactSide& in) { return say("{} {}", setting_of(in, "E"), setting_of(in, "nu")); }

std::string parameter_of(const ContactSide& in, const char* setting) {
  return fmt::format("{}_{}", in.side == 0 ? "primary" : "secondary", setting);
}

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

CarriedSurface carried_surface(const ModelParts& parts, int surface) {
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

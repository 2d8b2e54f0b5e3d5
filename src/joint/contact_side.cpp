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

}  // namespace dea

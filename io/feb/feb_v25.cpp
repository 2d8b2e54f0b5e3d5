// What is special in version 2.5: Boundary holds rigid bodies too, Rx is a rotation, numbers name materials.
#include <fmt/format.h>

#include "feb_reading.h"

namespace dea::feb {
namespace {

void read_boundary(Reading& reading, const XMLElement& section) {
  for (const XMLElement* child = section.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    const std::string_view tag = child->Name();
    if (tag == "fix") {
      fix_nodes(reading, *child, need_attribute(reading, *child, "bc"));
    } else if (tag == "prescribe") {
      const XMLElement* scale = child->FirstChildElement("scale");
      prescribe_nodes(reading, *child, need_attribute(reading, *child, "bc"),
                      scale != nullptr ? scale : child->FirstChildElement("value"));
    } else if (tag == "rigid") {
      rigid_nodes(reading, *child, need_attribute(reading, *child, "rb"));
    } else if (tag == "rigid_body") {
      read_rigid_body(reading, *child);
    } else {
      unsupported(reading, *child, fmt::format("<{}> in Boundary", tag),
                  "expected fix, prescribe, rigid or rigid_body");
    }
  }
}

void read_constraints_25(Reading& reading, const XMLElement& section) {
  for (const XMLElement* child = section.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    if (std::string_view(child->Name()) == "rigid_body")
      unsupported(reading, *child, "rigid_body in Constraints", "move it to Boundary");
    else
      read_constraint(reading, *child);
  }
}

}  // namespace

const Rules kRules25{"2.5",         true,          true,         read_mesh,
                     read_boundary, nullptr,       read_contact, read_constraints_25,
                     read_loads,    read_discrete, true};

}  // namespace dea::feb

// What is special in version 2.5: Boundary holds rigid bodies too, Rx is a rotation, numbers name materials.
#include <fmt/format.h>

#include "feb_reading.h"

namespace dea::feb {
namespace {

int rigid_dof(const Reading& reading, const XMLElement& element) {
  return read_dof(reading, element, need_attribute(reading, element, "bc"), {"x", "y", "z", "Rx", "Ry", "Rz"});
}

void read_rigid_body(Reading& reading, const XMLElement& section) {
  const int material = need_rigid(reading, section, need_attribute(reading, section, "mat"));
  const std::string name = attribute(section, "name");
  RigidFixed fixed{material, {}, reading.step, name, origin_of(reading, section)};
  bool any_fixed = false;
  for (const XMLElement* child = section.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    const std::string_view tag = child->Name();
    const std::string type = attribute(*child, "type");
    if (tag == "fixed") {
      fixed.dofs[static_cast<std::size_t>(rigid_dof(reading, *child))] = any_fixed = true;
    } else if (tag == "prescribed") {
      reading.model.rigid_prescribed.push_back({material, rigid_dof(reading, *child), read_scaled(reading, *child),
                                                type == "relative", reading.step, name, origin_of(reading, *child)});
    } else if (tag == "force") {
      const int dof = rigid_dof(reading, *child);
      const char* what = dof < 3 ? "rigid force" : "rigid moment";
      if (type == "ramp")
        unsupported(reading, *child, fmt::format("{} with load_type TARGET", what));
      else if (type == "follow" && dof >= 3)
        unsupported(reading, *child, "rigid moment with load_type FOLLOW");
      else if (!type.empty() && type != "follow")
        unsupported(reading, *child, fmt::format("{} with type {}", what, quote(type)));
      else
        reading.model.rigid_loads.push_back({material, dof, read_scaled(reading, *child),
                                             type == "follow" ? RigidLoad::Kind::Follower : RigidLoad::Kind::Dead, false,
                                             reading.step, name, origin_of(reading, *child)});
    } else if (tag == "initial_velocity" || tag == "initial_angular_velocity") {
      ignore(reading, *child, "initial velocity of a rigid body");
    } else {
      unsupported(reading, *child, fmt::format("<{}> in rigid_body", tag));
    }
  }
  if (any_fixed) reading.model.rigid_fixed.push_back(std::move(fixed));
}

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
      unsupported(reading, *child, fmt::format("<{}> in Boundary", tag));
    }
  }
}

void read_constraints_25(Reading& reading, const XMLElement& section) {
  for (const XMLElement* child = section.FirstChildElement("rigid_body"); child != nullptr;
       child = child->NextSiblingElement("rigid_body")) {
    unsupported(reading, *child, "rigid_body in Constraints: move it to Boundary");
  }
  read_constraints(reading, section);
}

}  // namespace

const Rules kRules25{"2.5", true, read_boundary, nullptr, read_constraints_25};

}  // namespace dea::feb

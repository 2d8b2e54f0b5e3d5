// What is special in version 2.0: facets and nodes listed inside contacts and conditions, or named by `set`.
#include <fmt/format.h>

#include "feb_reading.h"

namespace dea::feb {
namespace {

void read_boundary(Reading& reading, const XMLElement& section) {
  for (const XMLElement* child = section.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    const std::string_view tag = child->Name();
    if (tag == "fix") {
      read_old_fix(reading, *child);
    } else if (tag == "prescribe") {
      read_old_prescribe(reading, *child);
    } else {
      unsupported(reading, *child, fmt::format("<{}> in Boundary", tag), "expected fix or prescribe");
    }
  }
}

void read_contacts(Reading& reading, const XMLElement& section) {
  for (const XMLElement* child = section.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    if (std::string_view(child->Name()) == "contact")
      read_old_contact(reading, *child);
    else
      unsupported(reading, *child, fmt::format("<{}> in Contact", child->Name()), "expected <contact type=>");
  }
}

void read_constraints_20(Reading& reading, const XMLElement& section) {
  for (const XMLElement* child = section.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    if (std::string_view(child->Name()) == "rigid_body")
      read_rigid_body(reading, *child);
    else
      read_constraint(reading, *child);
  }
}

void read_loads_20(Reading& reading, const XMLElement& section) {
  for (const XMLElement* child = section.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    if (std::string_view(child->Name()) == "nodal_load")
      read_old_nodal_force(reading, *child);
    else
      read_load(reading, *child);
  }
}

void read_discrete_20(Reading& reading, const XMLElement& section) {
  for (const XMLElement* child = section.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    const std::string_view tag = child->Name();
    if (tag == "spring")
      read_old_spring(reading, *child);
    else if (tag == "rigid_axial_force")
      read_axial_force(reading, *child);
    else
      unsupported(reading, *child, fmt::format("<{}> in Discrete", tag), "expected spring or rigid_axial_force");
  }
}

}  // namespace

const Rules kRules20{"2.0",         true,
                     false,         read_mesh,
                     read_boundary, nullptr,
                     read_contacts, read_constraints_20,
                     read_loads_20, read_discrete_20,
                     true};

}  // namespace dea::feb

// What is special in version 4.0: bc types in words, one flag per fixed dof, rigid_bc and rigid_load.
#include <fmt/format.h>

#include <febiodea/io/feb/feb_reading.h>

namespace dea::feb {
namespace {

bool has(const std::string& text, const char* word) { return text.find(word) != text.npos; }

void read_zero_displacement(Reading& reading, const XMLElement& element) {
  std::string dofs;
  for (const char* name : {"x", "y", "z"}) {
    if (child_bool(reading, element, fmt::format("{}_dof", name).c_str(), false)) dofs += fmt::format("{},", name);
  }
  if (dofs.empty()) {
    ignore(reading, element, "zero displacement of no component");
    return;
  }
  dofs.pop_back();  // the last comma
  fix_nodes(reading, element, dofs);
}

void read_boundary_40(Reading& reading, const XMLElement& section) {
  for (const XMLElement& child : children(section)) {
    const std::string type = attribute(child, "type");
    const std::string what =
        type.empty() ? fmt::format("<{}> in Boundary", child.Name()) : fmt::format("bc {}", quote(type));
    if (type == "zero displacement") {
      read_zero_displacement(reading, child);
    } else if (type == "prescribed displacement") {
      prescribe_nodes(reading, child, child_text(child, "dof"), child.FirstChildElement("value"));
    } else if (type == "rigid") {
      rigid_nodes(reading, child, child_text(child, "rb"));
    } else if (type == "zero rotation" || type == "zero shell displacement" || has(type, "fluid") ||
               has(type, "concentration") || has(type, "temperature")) {
      ignore(reading, child, what);
    } else {
      unsupported_word(reading, child, what, febio::WordOf::Boundary, type);
    }
  }
}

void read_rigid_40(Reading& reading, const XMLElement& section) {
  for (const XMLElement& child : children(section)) {
    const std::string type = attribute(child, "type");
    if (rigid_condition(reading, child, type) || rigid_connector(reading, child, type)) continue;
    unsupported_word(reading, child, fmt::format("{} {}", child.Name(), quote(type)), febio::WordOf::RigidCondition,
                     type);
  }
}

}  // namespace

const Rules kRules40{
    .version = "4.0",
    .nested_k_adds = false,
    .unique_materials = true,
    .mesh = read_mesh,
    .boundary = read_boundary_40,
    .rigid = read_rigid_40,
    .contact = read_contact,
    .constraints = read_constraints,
    .loads = read_loads,
    .discrete = read_discrete,
    .tag_per_step = false,
};

}  // namespace dea::feb

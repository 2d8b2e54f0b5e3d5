// What is special in version 3.0: bc types fix and prescribe, rigid_constraint.
#include <fmt/format.h>

#include <febiodea/io/feb/feb_reading.h>

namespace dea::feb {
namespace {

void read_boundary_30(Reading& reading, const XMLElement& section) {
  for (const XMLElement& child : children(section)) {
    const std::string type = attribute(child, "type");
    if (type == "fix") {
      fix_nodes(reading, child, child_text(child, "dofs"));
    } else if (type == "prescribe") {
      prescribe_nodes(reading, child, child_text(child, "dof"), child.FirstChildElement("scale"));
    } else if (type == "rigid") {
      rigid_nodes(reading, child, child_text(child, "rb"));
    } else {
      unsupported(reading, child,
                  type.empty() ? fmt::format("<{}> in Boundary", child.Name()) : fmt::format("bc {}", quote(type)),
                  febio::word_advice(febio::WordOf::Boundary, type));
    }
  }
}

void read_fix(Reading& reading, const XMLElement& element) {
  RigidFixed fixed;
  fixed.material = need_rigid(reading, element, child_text(element, "rb"));
  for (const std::string& word : split_words(child_text(element, "dofs"))) {
    const int dof = read_dof(reading, element, word, {"Rx", "Ry", "Rz", "Ru", "Rv", "Rw"});
    fixed.dofs[static_cast<std::size_t>(dof)] = true;
  }
  fixed.step = reading.step;
  fixed.name = attribute(element, "name");
  fixed.origin = origin_of(reading, element);
  reading.model.rigid_fixed.push_back(std::move(fixed));
}

void read_rigid_30(Reading& reading, const XMLElement& section) {
  for (const XMLElement& child : children(section)) {
    const std::string type = attribute(child, "type");
    if (type == "fix")
      read_fix(reading, child);
    else if (rigid_condition(reading, child, type) || rigid_connector(reading, child, type))
      continue;
    else
      unsupported_word(reading, child, fmt::format("{} {}", child.Name(), quote(type)), febio::WordOf::RigidCondition,
                       type);
  }
}

}  // namespace

const Rules kRules30{
    .version = "3.0",
    .nested_k_adds = false,
    .unique_materials = true,
    .mesh = read_mesh,
    .boundary = read_boundary_30,
    .rigid = read_rigid_30,
    .contact = read_contact,
    .constraints = read_constraints,
    .loads = read_loads,
    .discrete = read_discrete,
    .tag_per_step = false,
};

}  // namespace dea::feb

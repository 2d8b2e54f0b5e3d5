// What is special in version 2.5: Boundary holds rigid bodies too, Rx is a rotation, numbers name materials.
#include <fmt/format.h>

#include "io/feb/feb_reading.h"

namespace dea::feb {
namespace {

void read_fixed_nodes(Reading& reading, const XMLElement& element) {
  febio::fix_nodes(reading, on_nodes(reading, element), need_attribute(reading, element, "bc"));
}

void read_prescribed_nodes(Reading& reading, const XMLElement& element) {
  prescribe_nodes(reading, element, need_attribute(reading, element, "bc"),
                  element.FirstChildElement("scale") != nullptr ? "scale" : "value");
}

void read_rigid_nodes_25(Reading& reading, const XMLElement& element) {
  rigid_nodes(reading, element, need_attribute(reading, element, "rb"));
}

void read_boundary_25(Reading& reading, const XMLElement& section) {
  read_children(reading, section,
                {{"fix", read_fixed_nodes},
                 {"prescribe", read_prescribed_nodes},
                 {"rigid", read_rigid_nodes_25},
                 {"rigid_body", read_rigid_body}});
}

void refuse_rigid_body(Reading& reading, const XMLElement& element) {
  unsupported(reading, element, "rigid_body in Constraints", "move it to Boundary");
}

void read_constraints_25(Reading& reading, const XMLElement& section) {
  read_children(reading, section, {{"rigid_body", refuse_rigid_body}}, read_constraint);
}

}  // namespace

const Rules kRules25{
    .version = "2.5", .up_to_25 = true, .boundary = read_boundary_25, .constraints = read_constraints_25};

}  // namespace dea::feb

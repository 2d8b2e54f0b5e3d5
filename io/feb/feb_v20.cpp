// What is special in version 2.0: facets and nodes listed inside contacts and conditions, or named by `set`.
#include <fmt/format.h>

#include "io/feb/feb_reading.h"

namespace dea::feb {
namespace {

void read_boundary_20(Reading& reading, const XMLElement& section) {
  read_children(reading, section, {{"fix", read_old_fix}, {"prescribe", read_old_prescribe}});
}

void read_contacts_20(Reading& reading, const XMLElement& section) {
  read_children(reading, section, {{"contact", read_old_contact}});
}

void read_constraints_20(Reading& reading, const XMLElement& section) {
  read_children(reading, section, {{"rigid_body", read_rigid_body}}, read_constraint);
}

void read_loads_20(Reading& reading, const XMLElement& section) {
  read_children(reading, section, {{"nodal_load", read_old_nodal_force}}, read_load);
}

void read_discrete_20(Reading& reading, const XMLElement& section) {
  read_children(reading, section, {{"spring", read_old_spring}, {"rigid_axial_force", read_axial_force}});
}

}  // namespace

const Rules kRules20{.version = "2.0",
                     .up_to_25 = true,
                     .unique_materials = false,
                     .boundary = read_boundary_20,
                     .contact = read_contacts_20,
                     .constraints = read_constraints_20,
                     .loads = read_loads_20,
                     .discrete = read_discrete_20};

}  // namespace dea::feb

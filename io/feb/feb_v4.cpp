// What is special in version 4.0: bc types in words, one flag per fixed dof, rigid_bc and rigid_load.
#include <fmt/format.h>

#include "io/feb/feb_reading.h"
#include "io/febio/known_words.h"

namespace dea::feb {
namespace {

void read_boundary_40(Reading& reading, const XMLElement& section) {
  for (const XMLElement& child : children(section)) {
    const std::string type = attribute(child, "type");
    const std::string what =
        type.empty() ? fmt::format("<{}> in Boundary", child.Name()) : fmt::format("bc {}", quote(type));
    if (type == "zero displacement") {
      const febio::Component component = component_of(reading, child);
      febio::check_words(reading, febio::Place::Boundary, component);
      febio::zero_displacement(reading, component, on_nodes(reading, child));
    } else if (type == "prescribed displacement") {
      prescribe_nodes(reading, child, child_text(child, "dof"), "value");
    } else if (type == "rigid") {
      rigid_nodes(reading, child, child_text(child, "rb"));
    } else {
      febio::other_boundary_condition(reading, component_of(reading, child), what);
    }
  }
}

}  // namespace

const Rules kRules40{.version = "4.0", .boundary = read_boundary_40};

}  // namespace dea::feb

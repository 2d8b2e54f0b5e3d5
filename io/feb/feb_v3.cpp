// What is special in version 3.0: bc types fix and prescribe, rigid_constraint.
#include <fmt/format.h>

#include "io/feb/feb_reading.h"
#include "io/febio/known_words.h"

namespace dea::feb {
namespace {

void read_boundary_30(Reading& reading, const XMLElement& section) {
  for (const XMLElement& child : children(section)) {
    const std::string type = attribute(child, "type");
    if (type == "fix") {
      febio::check_words(reading, febio::Place::Boundary, component_of(reading, child));
      febio::fix_nodes(reading, on_nodes(reading, child), child_text(child, "dofs"));
    } else if (type == "prescribe") {
      prescribe_nodes(reading, child, child_text(child, "dof"), "scale");
    } else if (type == "rigid") {
      rigid_nodes(reading, child, child_text(child, "rb"));
    } else {
      unsupported(reading, child,
                  type.empty() ? fmt::format("<{}> in Boundary", child.Name()) : fmt::format("bc {}", quote(type)),
                  febio::word_advice(febio::WordOf::Boundary, type));
    }
  }
}

}  // namespace

const Rules kRules30{.version = "3.0", .boundary = read_boundary_30};

}  // namespace dea::feb

// Springs between nodes: discrete materials and sets of node pairs (2.5 and later).
#include <fmt/format.h>

#include <cmath>

#include "io/feb/feb_reading.h"
#include "src/base/error.h"
#include "src/model/load_curve.h"

namespace dea::feb {
namespace {

void read_discrete_material(Reading& reading, const XMLElement& element) {
  need_attribute(reading, element, "type");
  const febio::Component component = checked(reading, febio::Place::Spring, element);
  reading.discrete_materials.push_back(febio::discrete_material(reading, component));
}

void read_cable(Reading& reading, const XMLElement& element) {
  const febio::Component component = checked(reading, febio::Place::Rigid, element);
  febio::rigid_cable(reading, component, steps_of(reading));
}

void read_discrete_springs(Reading& reading, const XMLElement& element) {
  const int set = need_named(reading, element, "discrete_set", "DiscreteSet", reading.discrete_set_index);
  const std::string dmat = need_attribute(reading, element, "dmat");
  const auto number = whole_int(dmat);
  if (!number || *number < 1 || *number > static_cast<int>(reading.discrete_materials.size())) {
    fail(reading, element,
         fmt::format("dmat = {}, expected the number of one of the {} discrete materials above it", quote(dmat),
                     reading.discrete_materials.size()));
  }
  const std::string type = attribute(element, "type");
  const febio::DiscreteMaterial& material = reading.discrete_materials[at(*number) - 1];
  if (!type.empty() && type != "spring") {
    unsupported(reading, element, fmt::format("discrete elements of type {}", quote(type)),
                "make it type spring, or take it out");
    return;
  }
  add_springs(reading, element, material, set);
}

}  // namespace

void read_axial_force(Reading& reading, const XMLElement& element) {
  const febio::Component component = checked(reading, febio::Place::Rigid, element);
  febio::rigid_axial_force(reading, component, steps_of(reading));
}

void add_springs(Reading& reading, const XMLElement& element, const febio::DiscreteMaterial& material, int set) {
  if (!material.unsupported.empty()) {
    unsupported(reading, element, material.unsupported, material.advice);
    return;
  }
  DiscreteSprings springs = material.springs;
  springs.set = set;
  springs.step = reading.step;
  springs.name = attribute(element, "name");
  if (springs.name.empty()) springs.name = reading.model.discrete_sets[at(set)].name;
  springs.origin = origin_of(reading, element);
  if (material.function > 0) {
    reading.function_uses.push_back(
        {static_cast<int>(reading.model.discrete_springs.size()), material.function, material.function_scale});
  }
  reading.model.discrete_springs.push_back(std::move(springs));
}

void resolve_functions(Reading& reading) {
  JointModel& model = reading.model;
  for (const FunctionUse& use : reading.function_uses) {
    DiscreteSprings& springs = model.discrete_springs[at(use.springs)];
    const int index = febio::need_controller(model, use.id, springs.origin);
    const LoadController& curve = model.controllers[at(index)];
    if (!curve.unsupported.empty() || !curve.expression.empty()) {
      febio::unsupported(reading, springs.origin,
                         fmt::format("springs whose force is load controller {} with {}", curve.id,
                                     curve.unsupported.empty() ? "an expression" : curve.unsupported),
                         "give the force as points: <force type=\"point\">");
    }
    springs.force = curve;
    for (auto& point : springs.force->points) point[1] *= use.scale;
  }
}

void read_discrete(Reading& reading, const XMLElement& section) {
  constexpr TagReader kReaders[] = {{"discrete_material", read_discrete_material},
                                    {"discrete", read_discrete_springs},
                                    {"rigid_axial_force", read_axial_force},
                                    {"rigid_cable", read_cable}};
  read_children(reading, section, kReaders);
}

}  // namespace dea::feb

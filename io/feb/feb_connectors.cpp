// Constraints that join rigid bodies: where they stand, and in which steps they act. What they are: io/febio.
#include <fmt/format.h>

#include "io/feb/feb_reading.h"

namespace dea::feb {

void name_connector_again(Reading& reading, const XMLElement& element) {
  const std::string name = need_attribute(reading, element, "name");
  if (reading.connector_names.count(name) == 0)
    fail(reading, element,
         fmt::format("<constraint name={}> without a type, expected the name of a constraint above it", quote(name)));
  if (reading.step < 0) return;
  const auto act_too = [&](auto& list, std::size_t i) {
    if (list[i].step == reading.step) return;
    if (list[i].step < 0) {  // of all steps until a step names it
      list[i].step = reading.step;
      return;
    }
    auto again = list[i];
    again.step = reading.step;
    list.push_back(std::move(again));
  };
  const auto in_this_step = [&](auto& list) {
    for (std::size_t i = list.size(); i-- > 0;)
      if (list[i].name == name) return act_too(list, i);
  };
  const auto moments = reading.moments_of.find(name);  // of a spherical joint: loads of their own
  if (moments != reading.moments_of.end()) {
    std::vector<std::size_t> now;
    for (const std::size_t i : moments->second) {
      const std::size_t before = reading.model.rigid_loads.size();
      act_too(reading.model.rigid_loads, i);
      now.push_back(reading.model.rigid_loads.size() > before ? before : i);
    }
    moments->second = now;
  }
  in_this_step(reading.model.rigid_springs);
  in_this_step(reading.model.rigid_joints);
  in_this_step(reading.model.rigid_axial_forces);
}

bool rigid_connector(Reading& reading, const febio::Component& component) {
  reading.connector_names.insert(component.name);
  const std::size_t before = reading.model.rigid_loads.size();
  if (!febio::rigid_connector(reading, component, steps_of(reading))) return false;
  for (std::size_t i = before; i < reading.model.rigid_loads.size(); ++i)
    reading.moments_of[component.name].push_back(i);
  return true;
}

}  // namespace dea::feb

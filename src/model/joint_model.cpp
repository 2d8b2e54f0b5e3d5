#include "src/model/joint_model.h"

#include <fmt/format.h>

#include <algorithm>

namespace dea {

std::string place_of(const JointModel& model, Origin origin) {
  if (origin.file < 0 || origin.file >= static_cast<int>(model.files.size())) return {};
  const std::string& file = model.files[static_cast<std::size_t>(origin.file)];
  return origin.line > 0 ? fmt::format("{}:{}", file, origin.line) : file;
}

std::string where(const JointModel& model, Origin origin) {
  const std::string place = place_of(model, origin);
  return place.empty() ? place : place + ": ";
}

Fault make_fault(const JointModel& model, Origin origin, Sentence found, Sentence expected) {
  return {.place = place_of(model, origin), .found = std::move(found), .expected = std::move(expected)};
}

InputError fault_at(const JointModel& model, Origin origin, Sentence found, Sentence expected) {
  return InputError(make_fault(model, origin, std::move(found), std::move(expected)));
}

std::vector<int> nodes_of_surface(const Surface& surface) {
  std::vector<int> nodes = surface.nodes;
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

bool ties_by_search_radius(const std::string& type) {
  return type == "tied-elastic" || type == "tied-biphasic" || type == "tied-multiphasic";
}

bool double_contact(const Contact& a, const Contact& b) {
  return at_same_time(a.step, b.step) && ((a.primary == b.primary && a.secondary == b.secondary) ||
                                          (a.primary == b.secondary && a.secondary == b.primary));
}

}  // namespace dea

#include "python/views.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/files/encoded_text.h"
#include "src/base/names.h"

namespace dea::python {

StateView view_of(const std::shared_ptr<const Analysed>& a, std::size_t state) {
  return {a,
          a->recognised.get(),
          &a->analysis.joint,
          &a->analysis.beds,
          &a->analysis.maps,
          &a->analysis.states[state],
          &a->springs[state]};
}

StateView view_of(const std::shared_ptr<const SolvedLoad>& s) {
  return {s,         s->joint->recognised.get(),   &s->joint->prepared.joint, &s->joint->prepared.beds, &s->joint->maps,
          &s->state, &s->state.equilibrium.springs};
}

std::vector<std::string> body_names(const Joint& joint) {
  std::vector<std::string> names;
  for (const Body& body : joint.bodies) names.push_back(utf8(body.name));
  return names;
}

std::vector<std::string> contact_names(const Joint& joint) {
  std::vector<std::string> names;
  for (const ContactPair& pair : joint.contacts) names.push_back(utf8(pair.name));
  return names;
}

std::size_t find_name(const char* what, const std::string& name, const std::vector<std::string>& names) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  if (name.empty() && names.size() == 1) return 0;
  throw UsageError(
      Fault{.place = what,
            .found = name.empty() ? "found no name," : fmt::format("found \"{}\"{},", name, did_you_mean(name, names)),
            .expected = fmt::format("expected one of {}", name_list(names, name))});
}

std::size_t find_contact(const Joint& joint, const std::string& name) {
  return find_name("contact", name, contact_names(joint));
}

std::size_t find_named_body(const Joint& joint, const std::string& name) {
  return find_name("body", name, body_names(joint));
}

}  // namespace dea::python

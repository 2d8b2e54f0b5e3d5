#include "python/views.h"

#include <fmt/format.h>

#include <algorithm>

#include "src/base/names.h"

namespace dea::python {

StateView view_of(const std::shared_ptr<const Analysed>& a, std::size_t state) {
  return {
      a, a->recognised.get(), &a->analysis.joint, &a->analysis.maps, &a->analysis.states[state], &a->springs[state]};
}

StateView view_of(const std::shared_ptr<const SolvedLoad>& s) {
  return {s,         s->joint->recognised.get(),   &s->joint->prepared.joint, &s->joint->maps,
          &s->state, &s->state.equilibrium.springs};
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

}  // namespace dea::python

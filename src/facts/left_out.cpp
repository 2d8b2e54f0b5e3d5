#include "src/facts/left_out.h"

#include <algorithm>

#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/say.h"

namespace dea {

namespace {

using Marks = std::vector<char>;  // per node

/// Takes out facets of which no element is left: with a node of none that is left, and all nodes of some that went.
void drop_facets(Surface& surface, const Marks& went, const Marks& gone) {
  FacetList kept;
  for (int f = 0; f < surface.size(); ++f) {
    const std::vector<int> facet = surface.facet(f);
    const bool out = std::all_of(facet.begin(), facet.end(), [&](int node) { return went[at(node)] != 0; }) &&
                     std::any_of(facet.begin(), facet.end(), [&](int node) { return gone[at(node)] != 0; });
    if (!out) kept.add(facet);
  }
  static_cast<FacetList&>(surface) = std::move(kept);
}

/// Takes the elements of a material out; `went`, `gone`: their nodes, those that no other element has.
int drop_elements(JointModel& model, int material, Marks& went, Marks& gone) {
  int count = 0;
  Marks left(model.nodes.size(), 0);
  for (const Domain& d : model.domains)
    for (const int node : d.nodes) (d.material == material ? went : left)[at(node)] = 1;
  for (std::size_t i = 0; i < left.size(); ++i) gone[i] = went[i] && !left[i];
  for (Domain& d : model.domains) {
    if (d.material != material) continue;
    count += static_cast<int>(d.element_ids.size());
    d.element_ids.clear();
    d.nodes.clear();
    d.shell_thickness.clear();
    d.fibre.clear();
    d.axes.clear();
  }
  return count;
}

/// Takes out the nodes that are gone; conditions of which none is left go, too.
template <class Conditions>
void drop_nodes(Conditions& conditions, const Marks& gone) {
  for (auto& c : conditions) std::erase_if(c.nodes, [&](int node) { return gone[at(node)] != 0; });
  std::erase_if(conditions, [](const auto& c) { return c.nodes.empty(); });
}

/// Springs with an end that is gone; how many.
int drop_springs(JointModel& model, const Marks& gone) {
  int count = 0;
  for (DiscreteSet& set : model.discrete_sets)
    count += static_cast<int>(std::erase_if(
        set.pairs, [&](const std::array<int, 2>& pair) { return gone[at(pair[0])] || gone[at(pair[1])]; }));
  return count;
}

Finding leave_out_one(JointModel& model, const std::string& name) {
  const auto of = std::find_if(model.materials.begin(), model.materials.end(),
                               [&](const Material& m) { return m.name == name && !m.rigid; });
  if (of == model.materials.end()) {
    std::vector<std::string> names;
    for (const Material& m : model.materials)
      if (!m.rigid) names.push_back(m.name);
    throw UsageError(
        Fault{.given = NamedSetting{"leave-out", "", name}, .found = no_such_name("deformable material", name, names)});
  }
  Marks went(model.nodes.size(), 0), gone = went;
  const int elements = drop_elements(model, static_cast<int>(of - model.materials.begin()), went, gone);
  std::vector<char> emptied;  // per surface
  for (Surface& s : model.surfaces) {
    const bool had = s.size() > 0;
    drop_facets(s, went, gone);
    emptied.push_back(had && s.size() == 0);
  }
  std::vector<std::string> contacts;
  std::erase_if(model.contacts, [&](const Contact& c) {
    const bool out =
        (c.primary >= 0 && emptied[at(c.primary)] != 0) || (c.secondary >= 0 && emptied[at(c.secondary)] != 0);
    if (out) contacts.push_back(c.name);
    return out;
  });
  const int springs = drop_springs(model, gone);
  drop_nodes(model.fixed_nodes, gone);
  drop_nodes(model.prescribed_nodes, gone);
  const std::size_t forces = model.nodal_forces.size();
  drop_nodes(model.nodal_forces, gone);
  drop_nodes(model.rigid_nodes, gone);
  return {"left-out",
          {},
          {{"material", name},
           {"elements", elements},
           {"springs", springs},
           {"forces", forces - model.nodal_forces.size()},
           {"contacts", contacts}},
          contacts.empty() ? 0 : 1};
}

}  // namespace

Findings leave_out(JointModel& model, const Settings& settings) {
  Findings findings;
  for (const std::string& name : settings.leave_out) findings.push_back(leave_out_one(model, name));
  return findings;
}

}  // namespace dea

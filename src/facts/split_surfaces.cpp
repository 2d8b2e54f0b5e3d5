#include "src/facts/split_surfaces.h"

#include <algorithm>
#include <map>
#include <set>

#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/facts/find_parts.h"

namespace dea {

namespace {

/// Index into ModelParts::soft of the part that a facet lies on, -1: none.
int part_of_facet(const ModelParts& parts, const Surface& s, int facet) {
  const ElementFace* face = carrier(parts, find_face(parts, s, facet));
  if (face == nullptr || !deformable(parts, parts.model.domains[at(face->domain)])) return -1;
  return soft_region(parts, region_of(parts, parts.model.domains[at(face->domain)], face->element));
}

}  // namespace

Findings split_surfaces(JointModel& model, const Settings& settings) {
  struct Split {
    int surface;
    std::map<int, std::vector<int>> facets;  // per part, -1: of none
  };
  std::vector<Split> splits;
  std::vector<std::string> names;  // of parts
  {
    const ModelParts parts = find_parts(model, settings);
    for (const SoftRegion& soft : parts.soft) names.push_back(soft.name);
    std::set<int> in_contact;
    for (const Contact& c : model.contacts)
      if (c.kind == Contact::Kind::Sliding) in_contact.insert({c.primary, c.secondary});
    for (const int s : in_contact) {
      if (s < 0 || parts.soft.empty()) continue;
      Split split{s, {}};
      for (int f = 0; f < model.surfaces[at(s)].size(); ++f)
        split.facets[part_of_facet(parts, model.surfaces[at(s)], f)].push_back(f);
      if (split.facets.size() > 1) splits.push_back(std::move(split));
    }
  }
  std::set<std::string> surface_names, contact_names;
  for (const Surface& s : model.surfaces) surface_names.insert(s.name);
  for (const Contact& c : model.contacts) contact_names.insert(c.name);
  Findings findings;
  for (const Split& split : splits) {
    const Surface whole = model.surfaces[at(split.surface)];
    const auto some = [&whole](const std::vector<int>& facets, const std::string& name) {
      Surface part;
      part.name = name;
      part.origin = whole.origin;
      for (const int f : facets) part.add(whole.facet(f));
      return part;
    };
    const auto rest = split.facets.begin();  // of no part, else of the first
    model.surfaces[at(split.surface)] = some(rest->second, whole.name);
    for (auto of = std::next(rest); of != split.facets.end(); ++of) {
      const auto index = static_cast<int>(model.surfaces.size());
      const std::string& part = names[at(of->first)];
      model.surfaces.push_back(some(of->second, take_free_name(whole.name + ": " + part, surface_names)));
      findings.push_back({"surface-divided",
                          {.surface = whole.name},
                          {{"facets", of->second.size()},
                           {"all", whole.size()},
                           {"part", part},
                           {"name", model.surfaces.back().name}}});
      const std::size_t contacts = model.contacts.size();
      for (std::size_t c = 0; c < contacts; ++c) {
        Contact other = model.contacts[c];
        if (other.primary != split.surface && other.secondary != split.surface) continue;
        if (other.primary == split.surface) other.primary = index;
        if (other.secondary == split.surface) other.secondary = index;
        other.name = take_free_name(other.name + ": " + part, contact_names);
        model.contacts.push_back(std::move(other));
      }
    }
  }
  return findings;
}

}  // namespace dea

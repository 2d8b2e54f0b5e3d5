#include "src/facts/soft_regions.h"

#include <algorithm>
#include <map>
#include <set>

#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/say.h"

namespace dea {

namespace {

/// What a region is made of.
struct Elements {
  std::map<int, int> of_material;  // elements
  std::set<int> nodes;
  double volume = 0.0;
  Vector3d sum = Vector3d::Zero();  // of volume times centroid
};

std::map<int, Elements> elements_by_region(const JointModel& model, const std::vector<char>& rigid,
                                           const std::vector<int>& region) {
  std::map<int, Elements> regions;
  for (const Domain& d : model.domains) {
    if (d.material < 0 || rigid[at(d.material)] || is_shell(d.shape) || is_line(d.shape)) continue;
    const int n = nodes_per_element(d.shape);
    for (int e = 0; e < static_cast<int>(d.element_ids.size()); ++e) {
      const int* nodes = d.nodes.data() + static_cast<std::ptrdiff_t>(e) * n;
      Elements& of = regions[region[at(nodes[0])]];
      ++of.of_material[d.material];
      of.nodes.insert(nodes, nodes + n);
      const ElementVolume v = element_volume(model, d, e);
      of.volume += v.volume;
      of.sum += v.volume * v.centroid;
    }
  }
  return regions;
}

std::set<int> regions_in_contact(const JointModel& model, const std::vector<int>& region) {
  std::set<int> in_contact;
  for (const Contact& c : model.contacts)
    if (c.kind == Contact::Kind::Sliding)
      for (const int surface : {c.primary, c.secondary})
        if (surface >= 0)
          for (const int node : model.surfaces[at(surface)].nodes) in_contact.insert(region[at(node)]);
  in_contact.erase(-1);
  return in_contact;
}

void check_names(const JointModel& model, const Settings& settings, const std::vector<char>& rigid) {
  for (const std::string& name : settings.part) {
    std::vector<std::string> names;
    for (std::size_t m = 0; m < model.materials.size(); ++m)
      if (!rigid[m]) names.push_back(model.materials[m].name);
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw UsageError(Fault{.given = NamedSetting{"part", "", name},
                             .found = no_such_name("deformable material", name, names)});
  }
}

}  // namespace

std::vector<SoftRegion> find_soft_regions(const JointModel& model, const Settings& settings,
                                          const std::vector<char>& rigid, const std::vector<int>& region,
                                          const Holders& holders, Bodies& bodies) {
  check_names(model, settings, rigid);
  const std::set<int> in_contact = regions_in_contact(model, region);
  std::vector<SoftRegion> found;
  for (const auto& [root, of] : elements_by_region(model, rigid, region)) {
    SoftRegion soft;
    soft.region = root;
    const auto main = std::max_element(of.of_material.begin(), of.of_material.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    soft.name = model.materials[at(main->first)].name;
    const bool named = std::any_of(of.of_material.begin(), of.of_material.end(), [&](const auto& entry) {
      return std::count(settings.part.begin(), settings.part.end(), model.materials[at(entry.first)].name) > 0;
    });
    const auto held = holders.of_region.find(root);
    const bool holds = held != holders.of_region.end() && !held->second.empty();
    const bool in_components = std::any_of(of.nodes.begin(), of.nodes.end(), [&](int node) {
      return holders.held_components[at(node)] != 0;
    });
    const bool alone = !holds && !in_components && holders.soft_ties.count(root) == 0 && in_contact.count(root) > 0;
    if (!named && !alone) continue;
    if (holds) {
      soft.body = held->second.begin()->first;
      if (held->second.size() > 1) soft.other = std::next(held->second.begin())->first;
    } else {
      soft.free = true;
      Body own;
      own.name = soft.name;
      own.mass = of.volume;
      own.center_of_mass = of.volume > 0 ? Vector3d(of.sum / of.volume) : Vector3d::Zero();
      const auto taken = [&](const std::string& name) {
        return std::any_of(bodies.bodies.begin(), bodies.bodies.end(), [&](const Body& b) { return b.name == name; });
      };
      for (int i = 2; taken(own.name); ++i) own.name = fmt::format("{} ({})", soft.name, i);
      soft.name = own.name;
      soft.body = bodies.ground();
      bodies.bodies.insert(bodies.bodies.end() - 1, std::move(own));
    }
    soft.why = named ? "named by the user" : "in contact, and nothing holds it";
    found.push_back(std::move(soft));
  }
  return found;
}

}  // namespace dea

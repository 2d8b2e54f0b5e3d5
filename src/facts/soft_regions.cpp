#include "src/facts/soft_regions.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/geometry/thickness.h"
#include "src/model/element_faces.h"

namespace dea {

namespace {

/// What a region is made of.
struct Elements {
  std::map<int, int> of_material;  // elements
  std::set<int> nodes;
  double volume = 0.0;
  Vector3d sum = Vector3d::Zero();  // of volume times centroid
};

/// Of the regions that are asked for.
std::map<int, Elements> elements_by_region(const JointModel& model, const std::vector<char>& rigid,
                                           const std::vector<int>& region, const std::set<int>& asked) {
  std::map<int, Elements> regions;
  if (asked.empty()) return regions;
  for (const Domain& d : model.domains) {
    if (d.material < 0 || rigid[at(d.material)] || is_shell(d.shape) || is_line(d.shape)) continue;
    const int n = nodes_per_element(d.shape);
    for (int e = 0; e < static_cast<int>(d.element_ids.size()); ++e) {
      const int* nodes = d.nodes.data() + static_cast<std::ptrdiff_t>(e) * n;
      if (asked.count(region[at(nodes[0])]) == 0) continue;
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

/// The regions that have elements of a material that the user names.
std::set<int> named_regions(const JointModel& model, const Settings& settings, const std::vector<int>& region) {
  std::set<int> named;
  for (const Domain& d : model.domains) {
    if (d.material < 0 ||
        std::count(settings.part.begin(), settings.part.end(), model.materials[at(d.material)].name) == 0)
      continue;
    for (const int node : d.nodes) named.insert(region[at(node)]);
  }
  return named;
}

/// Per region, its surfaces that sliding contacts press.
std::map<int, std::set<int>> surfaces_in_contact(const JointModel& model, const std::vector<int>& region) {
  std::map<int, std::set<int>> surfaces;
  for (const Contact& c : model.contacts)
    if (c.kind == Contact::Kind::Sliding)
      for (const int surface : {c.primary, c.secondary})
        if (surface >= 0)
          for (const int node : model.surfaces[at(surface)].nodes)
            if (region[at(node)] >= 0) surfaces[region[at(node)]].insert(surface);
  return surfaces;
}

/// Does the user say of a surface on the region what only a layer has?
bool layers_said(const JointModel& model, const Settings& settings, const std::vector<int>& region, int root) {
  const auto on_region = [&](const std::string& name) {
    return std::any_of(model.surfaces.begin(), model.surfaces.end(), [&](const Surface& s) {
      return s.name == name && !s.nodes.empty() && region[at(s.nodes.front())] == root;
    });
  };
  const auto any_of = [&](const auto& values) {
    return std::any_of(values.begin(), values.end(),
                       [&](const auto& entry) { return entry.first.empty() || on_region(entry.first); });
  };
  return any_of(settings.thickness) || any_of(settings.thickness_from) || any_of(settings.bone);
}

/// The facets of contacts that lie on the region.
SurfaceMesh pressed_facets(const JointModel& model, const std::vector<int>& region, int root) {
  FacetList facets;
  std::set<std::vector<int>> known;
  for (const Contact& c : model.contacts)
    for (const int surface : {c.primary, c.secondary}) {
      if (c.kind != Contact::Kind::Sliding || surface < 0) continue;
      const Surface& s = model.surfaces[at(surface)];
      for (int f = 0; f < s.size(); ++f)
        if (const std::vector<int> facet = s.facet(f); region[at(facet.front())] == root && known.insert(facet).second)
          facets.add(facet);
    }
  return make_surface_mesh(facets.begin, facets.nodes, model.nodes);
}

/// How much of what contacts press of a region has a face behind it that is held with all its nodes, seen along the
/// normals: a layer of cartilage all of it. 1 where no face is held so: that is no hint.
double bone_behind(const JointModel& model, const std::vector<char>& rigid, const std::vector<int>& region, int root,
                   const Holders& holders) {
  std::map<FaceKey, std::vector<int>> held;  // faces of one element alone
  std::set<FaceKey> inner;
  for (const Domain& d : model.domains) {
    if (d.material < 0 || rigid[at(d.material)] || is_shell(d.shape) || is_line(d.shape)) continue;
    const int n = nodes_per_element(d.shape);
    for (std::size_t e = 0; e < d.element_ids.size(); ++e) {
      const int* nodes = d.nodes.data() + e * at(n);
      if (region[at(nodes[0])] != root) continue;
      for (const std::vector<int>& local : element_faces(d.shape)) {
        std::vector<int> face;
        for (const int k : local) face.push_back(nodes[k]);
        if (!std::all_of(face.begin(), face.end(), [&](int node) { return !holders.of_node[at(node)].empty(); }))
          continue;
        const FaceKey key = face_key(face);
        std::reverse(face.begin(), face.end());  // out of the bone
        if (!held.emplace(key, face).second) inner.insert(key);
      }
    }
  }
  FacetList bone;
  for (auto& [key, face] : held)
    if (inner.count(key) == 0) bone.add({face.end() - facet_corners(static_cast<int>(face.size())), face.end()});
  const SurfaceMesh pressed = pressed_facets(model, region, root),
                    behind = make_surface_mesh(bone.begin, bone.nodes, model.nodes);
  if (pressed.size() == 0 || behind.size() == 0) return 1.0;
  const MeasuredThickness measured = measure_thickness(pressed, behind);
  double seen = 0.0, all = 0.0;
  for (std::size_t v = 0; v < measured.missed.size(); ++v) {
    all += pressed.vertex_areas[v];
    if (!measured.missed[v]) seen += pressed.vertex_areas[v];
  }
  return seen / all;
}

void check_names(const JointModel& model, const Settings& settings, const std::vector<char>& rigid) {
  for (const std::string& name : settings.part) {
    std::vector<std::string> names;
    for (std::size_t m = 0; m < model.materials.size(); ++m)
      if (!rigid[m]) names.push_back(model.materials[m].name);
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw UsageError(
          Fault{.given = NamedSetting{"part", "", name}, .found = no_such_name("deformable material", name, names)});
  }
}

/// Parts of one material, as both menisci of a knee, have the names of their elements, if these tell them apart.
void name_apart(const JointModel& model, const std::vector<int>& region, std::vector<SoftRegion>& parts) {
  std::set<std::string> taken;
  for (SoftRegion& part : parts) {
    const bool several = std::count_if(parts.begin(), parts.end(),
                                       [&](const SoftRegion& other) { return other.material == part.material; }) > 1;
    if (several && !part.free)
      for (const Domain& d : model.domains)
        if (!d.nodes.empty() && region[at(d.nodes.front())] == part.region && !d.name.empty()) {
          part.name = d.name;
          break;
        }
    if (!part.free) part.name = take_free_name(part.name, taken);
  }
}

}  // namespace

std::vector<SoftRegion> find_soft_regions(const JointModel& model, const Settings& settings,
                                          const std::vector<char>& rigid, const std::vector<int>& region,
                                          const Holders& holders, Bodies& bodies) {
  check_names(model, settings, rigid);
  const std::set<int> named_by_user = named_regions(model, settings, region);
  std::set<int> asked = named_by_user, pressed_twice;
  for (const auto& [root, surfaces] : surfaces_in_contact(model, region))
    if (surfaces.size() > 1) pressed_twice.insert(root);
  asked.insert(pressed_twice.begin(), pressed_twice.end());
  std::vector<SoftRegion> found;
  for (const auto& [root, of] : elements_by_region(model, rigid, region, asked)) {
    SoftRegion soft;
    soft.region = root;
    const auto main = std::max_element(of.of_material.begin(), of.of_material.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    soft.name = soft.material = model.materials[at(main->first)].name;
    const bool named = named_by_user.count(root) > 0, pressed = pressed_twice.count(root) > 0;
    const auto held = holders.of_region.find(root);
    const bool holds = held != holders.of_region.end() && !held->second.empty();
    const bool in_components =
        std::any_of(of.nodes.begin(), of.nodes.end(), [&](int node) { return holders.held_components[at(node)] != 0; });
    const bool alone = !holds && !in_components && holders.soft_ties.count(root) == 0 && pressed;
    const bool hangs = !named && holds && pressed && !layers_said(model, settings, region, root) &&
                       bone_behind(model, rigid, region, root, holders) < 0.5;
    if (!named && !alone && !hangs) continue;
    if (holds) {
      soft.body = held->second.begin()->first;
      if (held->second.size() > 1) soft.other = std::next(held->second.begin())->first;
    } else {
      soft.free = true;
      Body own;
      own.name = soft.name;
      own.mass = of.volume;
      own.center_of_mass = of.volume > 0 ? Vector3d(of.sum / of.volume) : Vector3d::Zero();
      soft.body = add_body(bodies, std::move(own));
      soft.name = bodies.bodies[at(soft.body)].name;
    }
    soft.form = named ? 0 : alone ? 1 : 2;
    found.push_back(std::move(soft));
  }
  name_apart(model, region, found);
  return found;
}

}  // namespace dea

#include "src/facts/soft_regions.h"

#include <algorithm>
#include <array>
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

/// Of a deformable material: what is rigid under a contact of type dea is no part.
bool soft_solid(const ModelParts& parts, const Domain& d) {
  return deformable(parts, d) && !parts.rigid[at(d.material)];
}

bool named_part(const ModelParts& parts, int material) {
  const std::vector<std::string>& named = parts.settings.part;
  return std::count(named.begin(), named.end(), parts.model.materials[at(material)].name) > 0;
}

/// What contacts press of a region: facets wound out of their elements, each once.
struct OnContacts {
  std::vector<std::vector<int>> facets;
  std::vector<int> material;  ///< per facet: of the element it is a face of
  std::set<int> contacts;
};

/// A deformable region that may be a part.
struct SoftCandidate {
  std::map<int, int> of_material;  ///< elements
  std::set<int> nodes;
  double volume = 0.0;
  Vector3d sum = Vector3d::Zero();  ///< of volume times centroid
  OnContacts pressed;
};

/// Per region that sliding contacts press: by which, and what tells cheaply whether it is a layer of one material on
/// bone: the area vectors of what is pressed and of faces that are held, octant by octant around its middle.
struct PressedOutline {
  std::set<int> contacts, materials;
  Vector3d middle = Vector3d::Zero();  ///< of nodes of pressed facets
  double nodes = 0.0;
  std::array<Vector3d, 8> pressed, held;
  PressedOutline() {
    pressed.fill(Vector3d::Zero());
    held.fill(Vector3d::Zero());
  }
  std::size_t octant(const Vector3d& x) const {
    const Vector3d from = x - middle / nodes;
    return (from[0] > 0 ? 1u : 0u) + (from[1] > 0 ? 2u : 0u) + (from[2] > 0 ? 4u : 0u);
  }
  /// How much of what is pressed has as much held opposite, if that is even and flat.
  double held_opposite() const {
    double both = 0.0, all = 0.0;
    for (std::size_t k = 0; k < 8; ++k) {
      both += std::min(std::abs(held[k].dot(pressed[k])), pressed[k].squaredNorm());
      all += pressed[k].squaredNorm();
    }
    return all > 0 ? both / all : 0.0;
  }
};

/// Calls `use(region, face)` for each face of an element all of whose nodes bodies hold, in regions that are `wanted`.
template <class Wanted, class Use>
void for_each_held_face(const ModelParts& parts, const Wanted& wanted, const Use& use) {
  const auto held = [&parts](int node) { return !parts.holders.of_node[at(node)].empty(); };
  std::vector<int> face;
  for (const Domain& d : parts.model.domains) {
    if (!soft_solid(parts, d)) continue;
    const int n = nodes_per_element(d.shape);
    for (std::size_t e = 0; e < d.element_ids.size(); ++e) {
      const int* nodes = d.nodes.data() + e * at(n);
      const int region = parts.region[at(nodes[0])];
      if (!wanted(region) || std::count_if(nodes, nodes + n, held) < 3) continue;
      for (const std::vector<int>& local : element_faces(d.shape)) {
        face.clear();
        for (const int k : local) face.push_back(nodes[k]);
        if (std::all_of(face.begin(), face.end(), held)) use(region, face);
      }
    }
  }
}

std::map<int, PressedOutline> outlines(const ModelParts& parts) {
  const JointModel& model = parts.model;
  std::map<int, PressedOutline> all;
  std::vector<PressedOutline*> of(model.nodes.size(), nullptr);  // by root
  for (std::size_t c = 0; c < model.contacts.size(); ++c) {
    if (model.contacts[c].kind != Contact::Kind::Sliding) continue;
    for (const int surface : {model.contacts[c].primary, model.contacts[c].secondary})
      for (std::size_t k = 0; surface >= 0 && k < model.surfaces[at(surface)].nodes.size(); ++k) {
        const int node = model.surfaces[at(surface)].nodes[k], region = parts.region[at(node)];
        if (region < 0) continue;
        PressedOutline*& outline = of[at(region)];
        if (outline == nullptr) outline = &all[region];
        if (outline->contacts.empty() || *outline->contacts.rbegin() != static_cast<int>(c))
          outline->contacts.insert(static_cast<int>(c));
        outline->middle += model.nodes[at(node)];
        outline->nodes += 1;
      }
  }
  std::set<int> surfaces;
  for (const Contact& c : model.contacts)
    if (c.kind == Contact::Kind::Sliding) surfaces.insert({c.primary, c.secondary});
  for (const int surface : surfaces)
    for (int f = 0; surface >= 0 && f < model.surfaces[at(surface)].size(); ++f) {
      const std::vector<int> facet = model.surfaces[at(surface)].facet(f);
      if (const int region = parts.region[at(facet.front())]; region >= 0) {
        PressedOutline& outline = *of[at(region)];
        outline.pressed[outline.octant(model.nodes[at(facet.front())])] += area_vector(facet, model.nodes);
      }
    }
  for (const Domain& d : model.domains)
    for (std::size_t e = 0; soft_solid(parts, d) && e < d.element_ids.size(); ++e)
      if (PressedOutline* outline = of[at(parts.region[at(d.nodes[e * at(nodes_per_element(d.shape))])])];
          outline != nullptr && outline->materials.count(d.material) == 0)
        outline->materials.insert(d.material);
  for_each_held_face(
      parts, [&of](int region) { return of[at(region)] != nullptr; },
      [&](int region, const std::vector<int>& face) {  // those between two elements cancel
        PressedOutline& outline = *of[at(region)];
        outline.held[outline.octant(model.nodes[at(*std::min_element(face.begin(), face.end()))])] +=
            area_vector(face, model.nodes);
      });
  return all;
}

/// The elements of the regions that are asked for, and what presses them.
std::map<int, SoftCandidate> candidates(const ModelParts& parts, const std::set<int>& asked) {
  const JointModel& model = parts.model;
  std::map<int, SoftCandidate> regions;
  if (asked.empty()) return regions;
  for (const Domain& d : model.domains) {
    if (!soft_solid(parts, d)) continue;
    const int n = nodes_per_element(d.shape);
    for (int e = 0; e < static_cast<int>(d.element_ids.size()); ++e) {
      const int* nodes = d.nodes.data() + static_cast<std::ptrdiff_t>(e) * n;
      if (asked.count(parts.region[at(nodes[0])]) == 0) continue;
      SoftCandidate& of = regions[parts.region[at(nodes[0])]];
      ++of.of_material[d.material];
      of.nodes.insert(nodes, nodes + n);
      const ElementVolume v = element_volume(model, d, e);
      of.volume += v.volume;
      of.sum += v.volume * v.centroid;
    }
  }
  std::set<FaceKey> known;
  for (std::size_t c = 0; c < model.contacts.size(); ++c) {
    if (model.contacts[c].kind != Contact::Kind::Sliding) continue;
    for (const int surface : {model.contacts[c].primary, model.contacts[c].secondary})
      for (int f = 0; surface >= 0 && f < model.surfaces[at(surface)].size(); ++f) {
        const ElementFace* face = carrier(parts, find_face(parts, model.surfaces[at(surface)], f));
        if (face == nullptr || !soft_solid(parts, model.domains[at(face->domain)])) continue;
        const Domain& d = model.domains[at(face->domain)];
        const int* nodes = d.nodes.data() + static_cast<std::ptrdiff_t>(face->element) * nodes_per_element(d.shape);
        const auto of = regions.find(parts.region[at(nodes[0])]);
        if (of == regions.end()) continue;
        OnContacts& pressed = of->second.pressed;
        pressed.contacts.insert(static_cast<int>(c));
        std::vector<int> facet;
        for (const int k : element_faces(d.shape)[at(face->face)]) facet.push_back(nodes[k]);
        if (!known.insert(face_key(facet)).second) continue;
        pressed.facets.push_back(std::move(facet));
        pressed.material.push_back(d.material);
      }
  }
  return regions;
}

/// The regions that have elements of a material that the user names.
std::set<int> named_regions(const ModelParts& parts) {
  std::set<int> named;
  for (const Domain& d : parts.model.domains)
    if (soft_solid(parts, d) && named_part(parts, d.material))
      for (const int node : d.nodes) named.insert(parts.region[at(node)]);
  return named;
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

/// How much of what contacts press of a region has a face behind it that is held with all its nodes, seen along the
/// normals: a layer of cartilage all of it. Per material.
std::map<int, double> bone_behind(const ModelParts& parts, int root, const OnContacts& pressed) {
  const JointModel& model = parts.model;
  std::map<FaceKey, std::vector<int>> held;  // faces of one element alone
  std::set<FaceKey> inner;
  for_each_held_face(
      parts, [root](int region) { return region == root; },
      [&](int, const std::vector<int>& face) {
        const std::vector<int> out_of_bone(face.rbegin(), face.rend());
        if (const FaceKey key = face_key(face); !held.emplace(key, out_of_bone).second) inner.insert(key);
      });
  FacetList bone;
  for (auto& [key, face] : held)
    if (inner.count(key) == 0) bone.add({face.end() - facet_corners(static_cast<int>(face.size())), face.end()});
  const SurfaceMesh behind = make_surface_mesh(bone.begin, bone.nodes, model.nodes);
  std::map<int, double> seen;
  for (const int material : std::set<int>(pressed.material.begin(), pressed.material.end())) {
    seen[material] = 0.0;
    if (behind.size() == 0) continue;
    FacetList facets;
    for (std::size_t f = 0; f < pressed.facets.size(); ++f)
      if (pressed.material[f] == material) facets.add(pressed.facets[f]);
    const SurfaceMesh mesh = make_surface_mesh(facets.begin, facets.nodes, model.nodes);
    const MeasuredThickness measured = measure_thickness(mesh, behind);
    double of = 0.0, all = 0.0;
    for (std::size_t v = 0; v < measured.missed.size(); ++v) {
      all += mesh.vertex_areas[v];
      if (!measured.missed[v]) of += mesh.vertex_areas[v];
    }
    seen[material] = of / all;
  }
  return seen;
}

void check_part_names(const ModelParts& parts) {
  for (const std::string& name : parts.settings.part) {
    std::vector<std::string> names;
    for (std::size_t m = 0; m < parts.model.materials.size(); ++m)
      if (!parts.rigid[m]) names.push_back(parts.model.materials[m].name);
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw UsageError(
          Fault{.given = NamedSetting{"part", "", name}, .found = no_such_name("deformable material", name, names)});
  }
}

/// The two bodies that hold most of these nodes, the one with more first; -1: there is none.
std::array<int, 2> most_holders(const std::set<int>& nodes, const Holders& holders) {
  std::map<int, int> count;
  for (const int node : nodes)
    for (const int body : holders.of_node[at(node)]) ++count[body];
  std::array<int, 2> most = {-1, -1};
  for (const auto& [body, n] : count) {
    if (most[0] < 0 || n > count.at(most[0]))
      most = {body, most[0]};
    else if (most[1] < 0 || n > count.at(most[1]))
      most[1] = body;
  }
  return most;
}

/// Parts of one material, as both menisci of a knee, have the names of their elements, if these tell them apart.
/// `regions`: what they are made of; a free part's body is where its volume is.
void name_apart(ModelParts& parts, const std::map<int, SoftCandidate>& regions) {
  std::vector<std::string> names;
  for (const SoftRegion& part : parts.soft) {
    const bool several = std::count_if(parts.soft.begin(), parts.soft.end(), [&part](const SoftRegion& other) {
                           return other.material == part.material;
                         }) > 1;
    names.push_back(part.material);
    for (const Domain& d : parts.model.domains)
      if (several && !d.nodes.empty() && !d.name.empty() && soft_solid(parts, d) &&
          region_of(parts, d, 0) == part.region) {
        names.back() = d.name;
        break;
      }
  }
  std::set<std::string> taken;
  for (std::size_t k = 0; k < parts.soft.size(); ++k) {
    SoftRegion& part = parts.soft[k];
    if (part.free) {
      Body own;
      own.name = names[k];
      const SoftCandidate& of = regions.at(part.within);
      own.center_of_mass = of.volume > 0 ? of.sum / of.volume : of.sum;
      own.mass = of.volume;
      part.body = add_body(parts.bodies, std::move(own));
      part.name = parts.bodies.bodies[at(part.body)].name;
    } else {
      part.name = take_free_name(names[k], taken);
    }
  }
}

/// What of a region of several materials is a part beside a layer, as a labrum that shares nodes with the cartilage:
/// materials that are pressed. Empty: all of it, or none.
std::set<int> materials_beside_layer(const ModelParts& parts, const std::map<int, double>& behind) {
  std::set<int> beside;
  bool layer = false;
  const bool named =
      std::any_of(behind.begin(), behind.end(), [&parts](const auto& of) { return named_part(parts, of.first); });
  for (const auto& [material, seen] : behind)
    if (named ? named_part(parts, material) : seen < 0.5)
      beside.insert(material);
    else
      layer = layer || seen >= 0.5;
  return layer ? beside : std::set<int>();
}

/// Does bone hold the part beside a layer, at nodes of a face or more of its own? Else it goes along with the layer.
bool held_by_itself(const ModelParts& parts, int root, const std::set<int>& materials) {
  std::set<int> held;
  for (const Domain& d : parts.model.domains)
    if (soft_solid(parts, d) && materials.count(d.material) > 0)
      for (const int node : d.nodes)
        if (parts.region[at(node)] == root && !parts.holders.of_node[at(node)].empty()) held.insert(node);
  for (const Domain& d : parts.model.domains)
    if (soft_solid(parts, d) && materials.count(d.material) == 0)
      for (const int node : d.nodes) held.erase(node);
  return held.size() >= 3;
}

/// Gives the nodes of elements of these materials, but those that others share, a region of their own.
int split_off(ModelParts& parts, int root, const std::set<int>& materials, std::size_t number) {
  const int region = static_cast<int>(parts.model.nodes.size() + number);
  std::set<int> own, others;
  for (const Domain& d : parts.model.domains) {
    if (!soft_solid(parts, d)) continue;
    for (const int node : d.nodes)
      if (parts.region[at(node)] == root) (materials.count(d.material) > 0 ? own : others).insert(node);
  }
  for (const int node : own)
    if (others.count(node) == 0) parts.region[at(node)] = region;
  for (const int material : materials) parts.beside[{root, material}] = region;
  return region;
}

/// Bodies of their own stand before the ground, which so has another number: holders are found anew.
void follow_ground(ModelParts& parts, int ground, const std::vector<int>& region) {
  parts.holders = find_holders(parts.model, parts.bodies, region, parts.node_holds, parts.moved);
  for (SoftRegion& soft : parts.soft)
    for (int* body : {&soft.body, &soft.other})
      if (*body == ground && !soft.free) *body = parts.bodies.ground();
}

}  // namespace

void find_soft_regions(ModelParts& parts) {
  check_part_names(parts);
  const std::vector<int> region = parts.region;
  const int ground = parts.bodies.ground();
  const std::set<int> named_by_user = named_regions(parts);
  std::set<int> asked = named_by_user;
  for (const auto& [root, outline] : outlines(parts))
    if (outline.contacts.size() > 1 || outline.materials.size() > 1 || outline.held_opposite() < 0.6)
      asked.insert(root);
  const std::map<int, SoftCandidate> regions = candidates(parts, asked);
  for (const auto& [root, of] : regions) {
    SoftRegion soft;
    soft.region = root;
    const bool named = named_by_user.count(root) > 0;
    const auto held = parts.holders.of_region.find(root);
    const bool holds = held != parts.holders.of_region.end() && !held->second.empty();
    const bool in_components = std::any_of(of.nodes.begin(), of.nodes.end(),
                                           [&parts](int node) { return parts.holders.held_components[at(node)] != 0; });
    const bool alone =
        !holds && !in_components && parts.holders.soft_ties.count(root) == 0 && of.pressed.contacts.size() > 1;
    const bool layer = layers_said(parts.model, parts.settings, parts.region, root);
    std::map<int, double> behind;
    if (holds && (named || !layer)) behind = bone_behind(parts, root, of.pressed);
    const std::set<int> beside = materials_beside_layer(parts, behind);
    const bool hangs = !behind.empty() && !layer &&
                       std::all_of(behind.begin(), behind.end(), [](const auto& seen) { return seen.second < 0.5; });
    if (!named && !alone && !hangs && beside.empty()) continue;
    const auto main =
        std::max_element(of.of_material.begin(), of.of_material.end(), [&beside](const auto& a, const auto& b) {
          const bool a_in = beside.empty() || beside.count(a.first) > 0,
                     b_in = beside.empty() || beside.count(b.first) > 0;
          return a_in != b_in ? b_in : a.second < b.second;
        });
    soft.material = parts.model.materials[at(main->first)].name;
    soft.within = root;
    const bool own_hold = !beside.empty() && held_by_itself(parts, root, beside);
    if (own_hold) soft.region = split_off(parts, root, beside, parts.soft.size());
    soft.free = !holds && !in_components;
    if (holds) {
      std::set<int> own = of.nodes;
      std::erase_if(own, [&](int node) { return parts.region[at(node)] != soft.region; });
      const auto by = most_holders(own, parts.holders);
      soft.body = by[0];
      soft.other = by[1];
    } else if (in_components) {
      soft.body = ground;
    }
    soft.form = named ? 0 : alone ? 1 : hangs ? 2 : own_hold ? 3 : 4;
    parts.soft.push_back(std::move(soft));
  }
  name_apart(parts, regions);
  if (parts.bodies.ground() != ground) follow_ground(parts, ground, region);
  for (const SoftRegion& soft : parts.soft)
    if (soft.region != soft.within) {
      parts.holders.of_region[soft.region] = parts.holders.of_region[soft.within];
    }
}

}  // namespace dea

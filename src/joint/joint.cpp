#include <febiodea/joint/joint.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <unordered_map>

#include <febiodea/base/error.h>
#include <febiodea/base/names.h>
#include <febiodea/base/numbers.h>
#include <febiodea/geometry/ray_caster.h>
#include <febiodea/joint/bodies.h>
#include <febiodea/joint/moved_nodes.h>
#include <febiodea/joint/thickness.h>
#include <febiodea/model/element_faces.h>

namespace dea {

namespace {

/// About 10 GB of springs: more is a slip of the keyboard.
constexpr double kMostSprings = 2e7;
/// Beyond, forces could overflow.
constexpr double kMostModulus = 1e100;

/// A face of an element, found by its corner nodes.
struct ElementFace {
  int domain, element, face;
};

using FaceMap = std::unordered_map<FaceKey, std::vector<ElementFace>, FaceKeyHash>;

/// Everything that recognition looks up again and again.
struct Recognition {
  const JointModel& model;
  const Settings& settings;
  std::vector<char> rigid;          // per material
  std::vector<char> layer_domains;  // per domain: cartilage of a rigid material (contacts of type "dea")
  Bodies bodies;
  std::vector<int> region;  // per node: root node of its deformable region, -1: in no deformable solid element
  FaceMap faces;            // element faces all of whose corners are nodes of a contact surface
  std::map<int, std::map<int, std::string>> held;  // region root -> body -> how
  std::vector<std::vector<int>> node_holders;      // per node: all bodies that hold it
  std::vector<char> fixed;                         // per node: held by the ground in x, y and z
  std::vector<unsigned char> mirror;               // per node: held by the ground in some of x, y, z, not in all
  std::vector<int> moved;                          // per node: body of nodes that are moved together, -1: none
};

int surface_index(const JointModel& model, const std::string& name) {
  for (std::size_t i = 0; i < model.surfaces.size(); ++i)
    if (model.surfaces[i].name == name) return static_cast<int>(i);
  return -1;
}

std::vector<std::string> surface_names(const JointModel& model) {
  std::vector<std::string> names;
  for (const Surface& s : model.surfaces) names.push_back(s.name);
  return names;
}

/// Cartilage: of a deformable material, or rigid with its bone under a contact that knows its modulus.
bool deformable(const Recognition& r, const Domain& d) {
  if (d.material < 0 || is_line(d.shape) || is_shell(d.shape)) return false;
  const auto index = static_cast<std::size_t>(&d - r.model.domains.data());
  return !r.rigid[at(d.material)] || r.layer_domains[index];
}

void find_regions(Recognition& r) {
  const JointModel& model = r.model;
  std::vector<int> parent(model.nodes.size(), -1);
  const auto root = [&](int i) {
    while (parent[at(i)] != i) {
      parent[at(i)] = parent[at(parent[at(i)])];
      i = parent[at(i)];
    }
    return i;
  };
  for (const Domain& d : model.domains) {
    if (!deformable(r, d)) continue;
    const int n = nodes_per_element(d.shape);
    for (std::size_t e = 0; e < d.element_ids.size(); ++e) {
      const int* nodes = d.nodes.data() + e * at(n);
      for (int k = 0; k < n; ++k)
        if (parent[at(nodes[k])] < 0) parent[at(nodes[k])] = nodes[k];
      int a = root(nodes[0]);
      for (int k = 1; k < n; ++k) {
        const int b = root(nodes[k]);
        parent[at(std::max(a, b))] = std::min(a, b);
        a = std::min(a, b);
      }
    }
  }
  r.region.assign(model.nodes.size(), -1);
  for (std::size_t i = 0; i < model.nodes.size(); ++i)
    if (parent[i] >= 0) r.region[i] = root(static_cast<int>(i));
}

void find_faces(Recognition& r) {
  const JointModel& model = r.model;
  std::vector<char> on_surface(model.nodes.size(), 0);
  const auto mark = [&](int surface) {
    if (surface < 0) return;
    for (int node : model.surfaces[at(surface)].nodes) on_surface[at(node)] = 1;
  };
  for (const Contact& c : model.contacts) {
    mark(c.primary);
    mark(c.secondary);
  }
  for (const auto& entry : r.settings.bone) mark(surface_index(model, entry.second));
  int face_nodes[9];
  for (int d = 0; d < static_cast<int>(model.domains.size()); ++d) {
    const Domain& domain = model.domains[at(d)];
    const int n = nodes_per_element(domain.shape);
    const auto& faces = element_faces(domain.shape);
    for (int e = 0; e < static_cast<int>(domain.element_ids.size()); ++e) {
      const int* nodes = domain.nodes.data() + static_cast<std::ptrdiff_t>(e) * n;
      for (int f = 0; f < static_cast<int>(faces.size()); ++f) {
        const int corners = facet_corners(static_cast<int>(faces[at(f)].size()));
        bool all = true;
        for (int k = 0; k < corners && all; ++k) {
          face_nodes[k] = nodes[faces[at(f)][at(k)]];
          all = on_surface[at(face_nodes[k])];
        }
        if (all) r.faces[face_key(face_nodes, corners)].push_back({d, e, f});
      }
    }
  }
}

const std::vector<ElementFace>* find_face(const Recognition& r, const int* nodes, int count) {
  const auto found = r.faces.find(face_key(nodes, facet_corners(count)));
  return found == r.faces.end() ? nullptr : &found->second;
}

/// The element that carries a facet: a deformable solid before a rigid solid before a shell.
const ElementFace* carrier(const Recognition& r, const std::vector<ElementFace>& candidates) {
  const ElementFace* best = nullptr;
  int best_rank = 4;
  for (const ElementFace& c : candidates) {
    const Domain& d = r.model.domains[at(c.domain)];
    const int rank = deformable(r, d) ? 0 : is_shell(d.shape) ? 2 : d.material >= 0 ? 1 : 3;
    if (rank < best_rank) {
      best = &c;
      best_rank = rank;
    }
  }
  return best;
}

/// Notes that a body holds a node of a deformable region.
void hold(Recognition& r, int node, int body, const std::string& how) {
  if (r.region[at(node)] < 0) return;
  r.held[r.region[at(node)]].try_emplace(body, how);
  auto& holders = r.node_holders[at(node)];
  if (std::find(holders.begin(), holders.end(), body) == holders.end()) holders.push_back(body);
}

/// Does this body hold every deformable region the surface lies on (or has it none)?
bool held_already(const Recognition& r, const Surface& s, int body) {
  for (int node : s.nodes) {
    if (r.region[at(node)] < 0) continue;
    const auto found = r.held.find(r.region[at(node)]);
    if (found == r.held.end() || found->second.count(body) == 0) return false;
  }
  return true;
}

/// The body of a surface as far as it is known: -1 not (yet).
int body_of_surface_nodes(const Recognition& r, const Surface& s) {
  int body = -1;
  for (int node : s.nodes) {
    int b = r.bodies.of_node[at(node)];
    if (r.region[at(node)] >= 0 && b < 0) {
      const auto found = r.held.find(r.region[at(node)]);
      if (found != r.held.end() && found->second.size() == 1) b = found->second.begin()->first;
    }
    if (b >= 0 && body >= 0 && b != body) return -1;
    if (b >= 0) body = b;
  }
  return body;
}

/// Bodies of moved nodes, before the ground.
void find_moved_bodies(Recognition& r, std::vector<std::string>& findings, std::vector<std::string>& faults) {
  const JointModel& model = r.model;
  r.moved.assign(model.nodes.size(), -1);
  std::vector<int> body = r.bodies.of_node;
  for (const RigidNodes& set : model.rigid_nodes)
    for (int node : set.nodes) body[at(node)] = r.bodies.of_material[at(set.material)];
  for (const MovedNodes& moved : find_moved_nodes(model, body, faults)) {
    Body found;
    found.name = moved.name;
    const auto taken = [&](const std::string& name) {
      return std::any_of(r.bodies.bodies.begin(), r.bodies.bodies.end(),
                         [&](const Body& other) { return other.name == name; });
    };
    for (int i = 2; taken(found.name); ++i) found.name = fmt::format("{} ({})", moved.name, i);
    found.moved_by = moved.conditions;
    for (int node : moved.nodes)
      found.center_of_mass += model.nodes[at(node)] / static_cast<double>(moved.nodes.size());
    const int index = r.bodies.ground();
    for (int node : moved.nodes) r.moved[at(node)] = index;
    findings.push_back(fmt::format(
        "{} moved together (\"{}\"): taken as a bone that the model leaves out",
        moved.nodes.size() == 1 ? "1 node is" : fmt::format("{} nodes are", moved.nodes.size()), found.name));
    r.bodies.bodies.insert(r.bodies.bodies.end() - 1, std::move(found));
  }
}

void find_holders(Recognition& r) {
  const JointModel& model = r.model;
  r.node_holders.resize(model.nodes.size());
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    const int b = r.bodies.of_node[i];
    if (b >= 0)
      hold(r, static_cast<int>(i), b, fmt::format("shares nodes with rigid body \"{}\"", r.bodies.bodies[at(b)].name));
  }
  for (const RigidNodes& set : model.rigid_nodes) {
    const int b = r.bodies.of_material[at(set.material)];
    for (int node : set.nodes)
      hold(r, node, b, fmt::format("rigid node set \"{}\" on body \"{}\"", set.name, r.bodies.bodies[at(b)].name));
  }
  // fixed in all three components, by one condition or several; in fewer it is a symmetry plane
  std::vector<std::array<bool, 3>> fixed;
  for (const FixedNodes& f : model.fixed_nodes) {
    if (fixed.empty()) fixed.resize(model.nodes.size(), {false, false, false});
    for (int node : f.nodes)
      for (std::size_t k = 0; k < 3; ++k) fixed[at(node)][k] = fixed[at(node)][k] || f.xyz[k];
  }
  r.fixed.assign(model.nodes.size(), 0);
  r.mirror.assign(model.nodes.size(), 0);
  for (std::size_t i = 0; i < fixed.size(); ++i) {
    if (r.moved[i] >= 0) continue;  // fixed in some components or steps, moved in others
    if (!(fixed[i][0] && fixed[i][1] && fixed[i][2])) {
      for (std::size_t k = 0; k < 3; ++k)
        if (fixed[i][k]) r.mirror[i] = static_cast<unsigned char>(r.mirror[i] | (1u << k));
      continue;
    }
    if (r.bodies.of_node[i] >= 0) continue;  // they hold that body, or are FEBio's to ignore
    r.fixed[i] = 1;
    hold(r, static_cast<int>(i), r.bodies.ground(), "nodes fixed in x, y and z");
  }
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    if (r.moved[i] < 0) continue;
    hold(r, static_cast<int>(i), r.moved[i],
         fmt::format("nodes moved together by \"{}\"", r.bodies.bodies[at(r.moved[i])].name));
  }

  // Tied contacts: a surface takes the body of the one it is tied to. Passes, for layers tied to layers: each decides
  // from what was known before it, so that a layer tied to two bodies is held by both, whatever the order. Every pass
  // but the last adds a body to a region, so there is an end.
  struct Tie {
    const Contact* contact;
    const Surface *surface, *to;
    int body;
  };
  for (;;) {
    std::vector<Tie> ties;
    for (const Contact& c : model.contacts) {
      if (c.kind != Contact::Kind::Tied || c.primary < 0 || c.secondary < 0) continue;
      const Surface *a = &model.surfaces[at(c.primary)], *b = &model.surfaces[at(c.secondary)];
      for (int side = 0; side < 2; ++side, std::swap(a, b)) {
        const int from = body_of_surface_nodes(r, *b);
        if (from >= 0 && !held_already(r, *a, from)) ties.push_back({&c, a, b, from});
      }
    }
    std::size_t held_before = 0, held_after = 0;
    for (const auto& h : r.held) held_before += h.second.size();
    for (const Tie& tie : ties) {
      const SurfaceMesh mesh = make_surface_mesh(tie.to->begin, tie.to->nodes, model.nodes);
      if (mesh.size() == 0) continue;
      const RayCaster caster(mesh);
      for (int node : tie.surface->nodes) {
        const Vector3d& x = model.nodes[at(node)];
        if (tie.contact->max_distance > 0 && (position(mesh, caster.closest(x)) - x).norm() > tie.contact->max_distance)
          continue;
        hold(r, node, tie.body,
             fmt::format("tied contact \"{}\" to body \"{}\"", tie.contact->name, r.bodies.bodies[at(tie.body)].name));
      }
    }
    for (const auto& h : r.held) held_after += h.second.size();
    if (held_after == held_before) break;
  }
}

/// Facets of a surface with their carrying elements, oriented out of them.
struct CarriedSurface {
  FacetList facets;
  std::vector<ElementFace> carriers;  // one per facet
  bool on_shells = false;
};

InputError no_volume(const JointModel& model, const Domain& d, int element, double volume) {
  const std::string which = fmt::format("element {} of \"{}\"", d.element_ids[at(element)], d.name);
  if (volume < 0)
    return fault_at(model, d.origin,
                    fmt::format("{} is inside out (volume {:g}); check the node order of its elements", which, volume));
  return fault_at(model, d.origin,
                  fmt::format("{} has no volume; check its thickness and the positions of its nodes", which));
}

CarriedSurface carry(const Recognition& r, int surface) {
  const JointModel& model = r.model;
  const Surface& s = model.surfaces[at(surface)];
  if (s.size() == 0)
    throw fault_at(model, s.origin,
                   fmt::format("surface \"{}\" has no facets: define it again, or take its contact out", s.name));
  CarriedSurface out;
  int face_nodes[9];
  for (int f = 0; f < s.size(); ++f) {
    const int first = s.begin[at(f)], count = s.begin[at(f) + 1] - first;
    const std::vector<ElementFace>* candidates = find_face(r, s.nodes.data() + first, count);
    const ElementFace* c = candidates ? carrier(r, *candidates) : nullptr;
    if (!c) {
      std::string ids;
      for (int k = 0; k < count; ++k)
        ids += fmt::format("{}{}", k ? "," : "", model.node_ids[at(s.nodes[at(first + k)])]);
      throw fault_at(model, s.origin,
                     fmt::format("surface \"{}\": facet {} (nodes {}) is no face of any element; the surface and the "
                                 "mesh do not fit together, define the surface again on this mesh",
                                 s.name, f + 1, ids));
    }
    const Domain& d = model.domains[at(c->domain)];
    out.carriers.push_back(*c);
    std::vector<int> facet(s.nodes.begin() + first, s.nodes.begin() + first + count);
    if (is_shell(d.shape)) {
      out.on_shells = true;  // a shell has two sides: the surface's own orientation tells which
    } else {
      const ElementVolume v = element_volume(model, d, c->element);
      if (!(v.volume > 0)) throw no_volume(model, d, c->element, v.volume);
      const auto& face = element_faces(d.shape)[at(c->face)];
      for (std::size_t k = 0; k < face.size(); ++k)
        face_nodes[k] = d.nodes[at(c->element * nodes_per_element(d.shape) + face[k])];
      // same sense of rotation as the element's outward face? Asked by area, for a collapsed face repeats a node
      const int corners = facet_corners(count);
      const auto area_vector = [&](const int* n, int n_nodes) {
        Vector3d sum = Vector3d::Zero();
        for (const auto& t : split_facet(n, n_nodes, model.nodes))
          sum += (model.nodes[at(t[1])] - model.nodes[at(t[0])]).cross(model.nodes[at(t[2])] - model.nodes[at(t[0])]);
        return sum;
      };
      if (area_vector(facet.data(), count).dot(area_vector(face_nodes, static_cast<int>(face.size()))) < 0) {
        std::reverse(facet.begin() + 1, facet.begin() + corners);
        if (count >= 2 * corners) std::reverse(facet.begin() + corners, facet.begin() + 2 * corners);
      }
    }
    out.facets.add(facet);
  }
  return out;
}

/// Deformable shells on the facets of a layer of solid elements: their names, quoted.
std::string coating(const Recognition& r, const Layer& layer) {
  std::set<std::string> names;
  const Surface& s = r.model.surfaces[at(layer.surface)];
  for (int f = 0; f < s.size() && layer.material >= 0; ++f) {
    const int first = s.begin[at(f)], count = s.begin[at(f) + 1] - first;
    const std::vector<ElementFace>* faces = find_face(r, s.nodes.data() + first, count);
    if (faces == nullptr) continue;
    for (const ElementFace& face : *faces) {
      const Domain& d = r.model.domains[at(face.domain)];
      if (is_shell(d.shape) && d.material >= 0 && !r.rigid[at(d.material)]) names.insert("\"" + d.name + "\"");
    }
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string surface_override(const std::map<std::string, std::string>& values, const std::string& surface) {
  const auto found = values.find(surface);
  return found == values.end() ? std::string() : found->second;
}

std::optional<double> surface_override(const std::map<std::string, double>& values, const std::string& surface) {
  auto found = values.find(surface);
  if (found == values.end()) found = values.find("");
  return found == values.end() ? std::nullopt : std::optional<double>(found->second);
}

int body_by_name(const JointModel& model, const std::vector<Body>& bodies, const std::string& name) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (bodies[b].name == name) return static_cast<int>(b);
    for (int m : bodies[b].materials)
      if (model.materials[at(m)].name == name) return static_cast<int>(b);
  }
  return -1;
}

/// Per node: held by the body?
std::vector<char> held_by(const Recognition& r, int body) {
  std::vector<char> is_held(r.model.nodes.size(), 0);
  for (std::size_t i = 0; i < is_held.size(); ++i) {
    const auto& holders = r.node_holders[i];
    is_held[i] = std::find(holders.begin(), holders.end(), body) != holders.end();
  }
  return is_held;
}

std::vector<LayerElement> region_elements(const Recognition& r, int root) {
  std::vector<LayerElement> elements;
  for (int i = 0; i < static_cast<int>(r.model.domains.size()); ++i) {
    const Domain& d = r.model.domains[at(i)];
    if (!deformable(r, d)) continue;
    for (int e = 0; e < static_cast<int>(d.element_ids.size()); ++e)
      if (r.region[at(d.nodes[at(e * nodes_per_element(d.shape))])] == root) elements.push_back({i, e});
  }
  return elements;
}

FacetList kept_facets(const FacetList& facets, const std::vector<FaceKind>& kinds) {
  FacetList kept;
  for (int f = 0; f < facets.size(); ++f) {
    if (kinds.empty() || kinds[at(f)] == FaceKind::Open)
      kept.add({facets.nodes.begin() + facets.begin[at(f)], facets.nodes.begin() + facets.begin[at(f) + 1]});
    else
      kept.add({});
  }
  return kept;
}

/// Why a selection is no articular surface: most of it would be left out. Empty: it is one.
std::string mostly_left_out(const JointModel& model, const FacetList& facets, const std::vector<FaceKind>& kinds,
                            const std::string& surface) {
  const SurfaceMesh all = make_surface_mesh(facets.begin, facets.nodes, model.nodes);
  std::array<double, 3> area = {0, 0, 0};
  std::array<long, 3> count = {0, 0, 0};
  for (int t = 0; t < all.size(); ++t) area[static_cast<std::size_t>(kinds[at(all.facet[at(t)])])] += all.areas[at(t)];
  for (FaceKind kind : kinds) ++count[static_cast<std::size_t>(kind)];
  const auto open = static_cast<std::size_t>(FaceKind::Open), bonded = static_cast<std::size_t>(FaceKind::Bonded),
             wall = static_cast<std::size_t>(FaceKind::SideWall);
  // a selection closed all round has as much bone side as articular side
  if (count[open] > 0 && area[wall] <= area[open]) return "";
  return fmt::format(
      "{} of its {} facets turn away from the articular face (side wall) and {} are bonded to bone, which leaves {}: "
      "select the articular face alone, or take all facets as they are with --keep-facets \"{}\"",
      count[wall], facets.size(), count[bonded], count[open] > 0 ? fmt::format("{} facets", count[open]) : "none",
      surface);
}

/// Rims that are neither one thing nor the other, as a sentence; empty: none to speak of.
std::string rim_note(const std::string& surface, const LayerFace& face) {
  double rim = 0.0, stepped = 0.0, highest = 0.0;
  for (const LayerFace::Edge& e : face.edges) {
    const double length =
        (face.mesh.corner(e.triangle, e.edge) - face.mesh.corner(e.triangle, (e.edge + 1) % 3)).norm();
    rim += length;
    if (e.step > 0.0) stepped += length;
    highest = std::max(highest, e.step);
  }
  constexpr double kWorthSaying = 0.02;
  std::string text;
  if (face.bevelled > kWorthSaying * rim)
    text = fmt::format(
        "the layer ends in a bevel along {:.3g} of its rim (the next face turns by 20 to 65 degrees), which is taken "
        "as "
        "going on below 40 degrees and as a free edge above: pressures within a thickness of it may be a third off",
        face.bevelled);
  if (stepped > kWorthSaying * rim)
    text += fmt::format(
        "{}steps or notches of up to {:.3g} cross its face along {:.3g} of edges; they are taken as free edges, though "
        "the layer goes on below them: pressures beside them come out too low; smooth the mesh, or merge its nodes",
        text.empty() ? "" : "; ", highest, stepped);
  return text.empty() ? text : fmt::format("surface \"{}\": {}", surface, text);
}

/// What was left out of a surface, as a sentence; empty: nothing.
std::string left_out_note(const std::string& surface, const std::vector<FaceKind>& kinds) {
  const auto turned = std::count(kinds.begin(), kinds.end(), FaceKind::SideWall),
             bonded = std::count(kinds.begin(), kinds.end(), FaceKind::Bonded);
  if (turned + bonded == 0) return "";
  const std::string away = fmt::format("{} away from its articular face (side wall)", turned == 1 ? "turns" : "turn"),
                    held = fmt::format("{} bonded to bone", bonded == 1 ? "is" : "are");
  return fmt::format("surface \"{}\": {} of {} facets {}{}: left out (--keep-facets keeps them)", surface,
                     turned > 0 ? turned : bonded, kinds.size(), turned > 0 ? away : held,
                     turned > 0 && bonded > 0 ? fmt::format(" and {} {}", bonded, held) : "");
}

/// The material under most of the facets.
int layer_material(const std::map<int, int>& facets_of_material) {
  return std::max_element(facets_of_material.begin(), facets_of_material.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

/// A layer nothing holds: usually its bone is deformable, of another material of the same part.
std::string not_held(const Recognition& r, int root, int cartilage, const std::string& surface) {
  const JointModel& model = r.model;
  std::set<int> others;
  for (const Domain& d : model.domains)
    if (deformable(r, d) && d.material != cartilage && !d.nodes.empty() && r.region[at(d.nodes[0])] == root)
      others.insert(d.material);
  std::string bones, bodies;
  for (int m : others)
    bones += fmt::format("{}--rigid \"{}\"", bones.empty() ? "" : " or ", model.materials[at(m)].name);
  for (std::size_t b = 0; b + 1 < r.bodies.bodies.size(); ++b)
    bodies += (b ? ", " : "") + fmt::format("\"{}\"", r.bodies.bodies[b].name);
  const std::string found =
      "its layer is held by no rigid body (no shared nodes, rigid node set, tied contact or nodes fixed in x, y and "
      "z); ";
  const std::string attach = fmt::format(
      "name the body with --attach \"{}=BODY\" (bodies: {}), and the layer's bone surface with --bone "
      "\"{}=SURFACE\" or its thickness with --thickness \"{}=VALUE\"",
      surface, bodies.empty() ? "none" : bodies, surface, surface);
  return found + (bones.empty() ? attach : fmt::format("take its bone as rigid with {}, or {}", bones, attach));
}

Law law_of(const Recognition& r, const Contact& contact) {
  // layers know nothing of springs that stand on the bone
  const Law usual = r.settings.springs_at == SpringsAt::Articular ? Law::Layer : Law::Linear;
  return r.settings.law.value_or(contact.dea ? contact.dea->law.value_or(usual) : usual);
}

Facets facets_of(const Recognition& r, const Contact& contact) {
  return r.settings.facets.value_or(contact.dea ? contact.dea->facets.value_or(Facets::Curved) : Facets::Curved);
}

/// What is said of a layer, the user before the contact.
struct GivenLayer {
  std::optional<double> E, nu, thickness;
  bool map = false;  ///< thickness by the contact's map
};

GivenLayer given_layer(const Recognition& r, const Contact& contact, int side) {
  const std::string& name = r.model.surfaces[at(side == 0 ? contact.primary : contact.secondary)].name;
  GivenLayer given = {surface_override(r.settings.E, name), surface_override(r.settings.nu, name),
                      surface_override(r.settings.thickness, name), false};
  if (!contact.dea) return given;
  const DeaLayer& stated = contact.dea->layers[side];
  if (!given.E) given.E = stated.E;
  if (!given.nu) given.nu = stated.nu;
  given.map = !given.thickness && !stated.thickness_map.empty();
  if (!given.thickness) given.thickness = stated.thickness;
  return given;
}

/// Contacts of type "dea" whose layer is to be measured: the elements under the surface are the cartilage, though
/// rigid.
void find_layer_domains(Recognition& r) {
  r.layer_domains.assign(r.model.domains.size(), 0);
  for (const Contact& c : r.model.contacts) {
    if (!c.dea || c.primary < 0 || c.secondary < 0) continue;
    for (int side = 0; side < 2; ++side) {
      const GivenLayer given = given_layer(r, c, side);
      if (given.thickness || given.map || (!given.E && !given.nu)) continue;
      const Surface& s = r.model.surfaces[at(side == 0 ? c.primary : c.secondary)];
      for (int f = 0; f < s.size(); ++f) {
        const auto* found = find_face(r, s.nodes.data() + s.begin[at(f)], s.begin[at(f) + 1] - s.begin[at(f)]);
        if (found == nullptr) continue;
        for (const ElementFace& face : *found)
          if (!is_shell(r.model.domains[at(face.domain)].shape)) r.layer_domains[at(face.domain)] = 1;
      }
    }
  }
}

/// Thickness at the vertices of the articular surface: the mean of what the map says of a node in the facets around it.
std::vector<double> mapped_thickness(const Surface& s, const std::vector<double>& map, const SurfaceMesh& mesh) {
  std::unordered_map<int, std::array<double, 2>> sums;  // node -> sum, count
  for (std::size_t k = 0; k < s.nodes.size(); ++k) {
    auto& sum = sums[s.nodes[k]];
    sum[0] += map[k];
    sum[1] += 1;
  }
  std::vector<double> thickness;
  for (int node : mesh.model_nodes) thickness.push_back(sums.at(node)[0] / sums.at(node)[1]);
  return thickness;
}

/// How far the face is followed beyond the selection, in thicknesses: what is squeezed out decays within
/// sqrt(2) of them (layer_kernel.h), by then to 3 %.

/// The boundary of a layer whose elements are rigid with their bone, as `dea convert` writes them: the solid elements
/// under the surface, bonded where they share nodes with others of their body. They are the layer if they are as thick
/// as its map says, within kSame for nearly all vertices inside; else they are bone, and nothing is known of the
/// cartilage beyond the selection: no faces.
LayerBoundary rigid_boundary(const Recognition& r, const CarriedSurface& carried, const Layer& layer,
                             const std::vector<double>& map) {
  constexpr double kSame = 0.02;
  const JointModel& model = r.model;
  std::vector<char> own(model.domains.size(), 0);
  for (const Contact& c : model.contacts) {  // a layer may have several surfaces
    for (std::size_t side = 0; side < 2 && c.dea && c.primary >= 0 && c.secondary >= 0; ++side) {
      if (c.dea->layers[side].thickness_map.empty()) continue;
      const Surface& s = model.surfaces[at(side == 0 ? c.primary : c.secondary)];
      for (int f = 0; f < s.size(); ++f) {
        const auto* faces = find_face(r, s.nodes.data() + s.begin[at(f)], s.begin[at(f) + 1] - s.begin[at(f)]);
        const ElementFace* face = faces ? carrier(r, *faces) : nullptr;
        if (face == nullptr) continue;
        const Domain& d = model.domains[at(face->domain)];
        if (d.material >= 0 && !is_shell(d.shape) && r.rigid[at(d.material)] &&
            r.bodies.of_material[at(d.material)] == layer.body)
          own[at(face->domain)] = 1;
      }
    }
  }
  std::vector<LayerElement> elements;
  std::vector<char> held(model.nodes.size(), 0);
  for (int i = 0; i < static_cast<int>(model.domains.size()); ++i) {
    const Domain& d = model.domains[at(i)];
    if (own[at(i)]) {
      for (int e = 0; e < static_cast<int>(d.element_ids.size()); ++e) elements.push_back({i, e});
    } else if (d.material >= 0 && !is_line(d.shape) && r.rigid[at(d.material)] &&
               r.bodies.of_material[at(d.material)] == layer.body) {
      for (int node : d.nodes) held[at(node)] = 1;
    }
  }
  LayerBoundary boundary = find_layer_boundary(model, elements, std::move(held));
  open_feather_facets(model, carried.facets, boundary);
  const SurfaceMesh bone = bonded_surface(model, boundary);
  if (bone.size() == 0) return {};
  find_side_walls(model, bone, boundary);
  const FacetList kept = kept_facets(carried.facets, kinds_of(boundary, carried.facets));
  const SurfaceMesh articular = make_surface_mesh(kept.begin, kept.nodes, model.nodes);
  if (articular.size() == 0) return {};
  const std::vector<double> said = mapped_thickness(model.surfaces[at(layer.surface)], map, articular),
                            measured = measure_thickness(articular, bone).thickness;
  std::vector<char> on_rim(said.size(), 0);  // whose normals are one-sided
  for (int t = 0; t < articular.size(); ++t)
    for (int k = 0; k < 3; ++k)
      if (articular.neighbours[at(t)][at(k)] < 0)
        for (int end : {k, (k + 1) % 3}) on_rim[at(articular.triangles[at(t)][at(end)])] = 1;
  std::size_t same = 0, others = 0;
  for (std::size_t v = 0; v < said.size(); ++v) {
    const bool is_same = std::abs(measured[v] - said[v]) <= kSame * said[v];
    same += is_same;
    others += !is_same && !on_rim[v];
  }
  return same > 9 * others ? boundary : LayerBoundary{};
}

/// The face of a layer with elements. Gaps and thickness of the selection stay its own: at its rim they know the facets
/// on one side only.
void find_layer_face(const Recognition& r, const Contact& contact, const CarriedSurface& carried,
                     const LayerBoundary& boundary, Layer& layer) {
  const JointModel& model = r.model;
  double deepest = layer.max_thickness();
  if (layer.material < 0) {  // rigid_boundary: as far as before the conversion, though the map knows the rim better
    const std::vector<double> measured = measure_thickness(layer.articular, bonded_surface(model, boundary)).thickness;
    deepest = *std::max_element(measured.begin(), measured.end());
  }
  layer.face = grow_face(model, boundary, kept_facets(carried.facets, layer.facet_kinds), layer.articular,
                         kFaceReach * deepest, r.mirror);
  const std::size_t vertices = layer.articular.vertices.size(), triangles = layer.articular.triangles.size();
  SurfaceMesh& mesh = layer.face.mesh;
  if (mesh.triangles.size() == triangles) {
    layer.face.thickness = layer.thickness;
    return;
  }
  if (facets_of(r, contact) == Facets::Flat) mesh.bulge.assign(mesh.bulge.size(), {0, 0, 0});
  layer.face.thickness = layer.thickness;
  // a map says nothing of what is beyond it; where a map replaced the model's own layer (rigid_boundary), the elements
  // are as thick as it says
  if (!layer.thickness_given || layer.material < 0) {
    const MeasuredThickness measured =
        measure_thickness(mesh, layer.thickness_given ? bonded_surface(model, boundary) : layer.bone);
    layer.face.thickness.insert(layer.face.thickness.end(),
                                measured.thickness.begin() + static_cast<std::ptrdiff_t>(vertices),
                                measured.thickness.end());
    return;
  }
  const RayCaster caster(layer.articular);
  for (std::size_t v = vertices; v < mesh.vertices.size(); ++v)
    layer.face.thickness.push_back(interpolate(layer.articular, layer.thickness, caster.closest(mesh.vertices[v])));
}

Layer make_layer(const Recognition& r, const Contact& contact, int side) {
  const int surface = side == 0 ? contact.primary : contact.secondary;
  const JointModel& model = r.model;
  const Settings& settings = r.settings;
  const Surface& s = model.surfaces[at(surface)];
  const auto refuse = [&](const std::string& text) -> InputError {
    return fault_at(model, s.origin, fmt::format("contact \"{}\", surface \"{}\": {}", contact.name, s.name, text));
  };
  const CarriedSurface carried = carry(r, surface);
  std::map<FaceKey, int> facet_at;
  for (int f = 0; f < s.size(); ++f) {
    const auto first = facet_at.try_emplace(
        face_key(s.nodes.data() + s.begin[at(f)], facet_corners(s.begin[at(f) + 1] - s.begin[at(f)])), f);
    if (!first.second)
      throw refuse(fmt::format("facets {} and {} are the same; its springs would count twice: list each facet once",
                               first.first->second + 1, f + 1));
  }

  Layer layer;
  layer.surface = surface;
  layer.springs_at = settings.springs_at;

  // What carries the facets: one deformable region, or one rigid body.
  std::set<int> roots, bodies;
  std::map<int, int> materials;  // deformable material -> facets
  for (const ElementFace& c : carried.carriers) {
    const Domain& d = model.domains[at(c.domain)];
    if (d.material < 0)
      throw refuse(
          fmt::format("its elements \"{}\" have no material (no domain in MeshDomains); give them one", d.name));
    if (r.rigid[at(d.material)] && !deformable(r, d)) {
      bodies.insert(r.bodies.of_material[at(d.material)]);
    } else if (is_shell(d.shape)) {
      throw refuse(fmt::format(
          "lies on deformable shells (\"{}\"); DEA needs a solid cartilage layer or a rigid surface: "
          "mesh the layer with solid elements, or take the shells as rigid with --rigid \"{}\" (and, if the other "
          "side is rigid too, give cartilage with --thickness \"{}=VALUE\" --E \"{}=VALUE\" --nu "
          "\"{}=VALUE\")",
          d.name, model.materials[at(d.material)].name, s.name, s.name, s.name));
    } else {
      roots.insert(r.region[at(d.nodes[at(c.element * nodes_per_element(d.shape))])]);
      ++materials[d.material];
    }
  }
  if (!roots.empty() && !bodies.empty())
    throw refuse("lies partly on rigid, partly on deformable elements; split it into two surfaces");
  if (roots.size() > 1)
    throw refuse(fmt::format("lies on {} separate deformable parts; split it into one surface per part", roots.size()));

  std::vector<int> zero;
  layer.articular = make_surface_mesh(carried.facets.begin, carried.facets.nodes, model.nodes, &zero);
  if (!zero.empty()) {
    const int f = zero.front();
    throw refuse(fmt::format("facet {} has no area ({} such facets); repair the mesh", f + 1, zero.size()));
  }

  LayerBoundary boundary;  // of a layer with elements
  const std::string attach = surface_override(settings.attach, s.name);
  if (!attach.empty()) {
    layer.body = attach == "ground" ? r.bodies.ground() : body_by_name(model, r.bodies.bodies, attach);
    if (layer.body < 0) {
      std::vector<std::string> names;
      for (const Body& b : r.bodies.bodies) names.push_back(b.name);
      throw UsageError(fmt::format("--attach {}={}: the model has no rigid body of this name; it has {}", s.name,
                                   attach, name_list(names, attach)));
    }
    layer.attached_by = "attached by the user";
  }
  const GivenLayer given = given_layer(r, contact, side);
  const std::optional<double>&given_thickness = given.thickness, &given_E = given.E, &given_nu = given.nu;
  // A layer in zones, or beside another tissue: one modulus for all is told, and refused where it would mean little.
  const auto note_other_material = [&](int material, double E) {
    const Material &other = model.materials[at(material)], &own = model.materials[at(layer.material)];
    const double nu = given_nu.value_or(own.nu), ratio = other.E / E;
    if ((given_E && given_nu) || (std::abs(ratio - 1) < 0.01 && std::abs(other.nu - nu) < 0.002)) return;
    constexpr double kMostRatio = 1.25;
    const std::string both = fmt::format("\"{}\" (E {:g}, nu {:g}) and \"{}\" (E {:g}, nu {:g})", own.name, E, nu,
                                         other.name, other.E, other.nu);
    if (ratio > kMostRatio || ratio < 1 / kMostRatio)
      throw refuse(
          fmt::format("its part consists of {}, but a layer has one modulus here; give one for all of it with --E "
                      "\"{}=VALUE\" --nu \"{}=VALUE\", or make parts that are no cartilage rigid with --rigid \"{}\"",
                      both, s.name, s.name, other.name));
    layer.notes.push_back(fmt::format(
        "surface \"{}\": its part consists of {}; the springs take the first for all of it (others with --E, --nu)",
        s.name, both));
  };

  // E and nu of a layer that is not rigid; why there are none.
  const auto set_modulus = [&]() -> std::string {
    if (layer.rigid) return "";
    const double none = std::numeric_limits<double>::quiet_NaN();
    const Material* material = layer.material >= 0 ? &model.materials[at(layer.material)] : nullptr;
    layer.elasticity.E = given_E.value_or(material ? material->E : none);
    layer.elasticity.nu = given_nu.value_or(material ? material->nu : none);
    const double E = layer.elasticity.E, nu = layer.elasticity.nu;
    if (std::isnan(E) || std::isnan(nu)) {
      const std::string who = material ? fmt::format("material \"{}\" (type {})", material->name, material->type)
                                       : std::string("the rigid surface");
      const std::string note = material ? material->note : "no cartilage material";
      const char* tag = side == 0 ? "primary" : "secondary";
      return fmt::format("{} gives no E and nu{}; give them {}with --E \"{}=VALUE\" --nu \"{}=VALUE\"", who,
                         note.empty() ? "" : " (" + note + ")",
                         contact.dea ? fmt::format("in the contact as <{0}_E> and <{0}_nu>, or ", tag) : "", s.name,
                         s.name);
    }
    if (E > 0 && E <= kMostModulus && nu > -1 && nu < 0.5) return "";
    return fmt::format(
        "E = {:g}, nu = {:g}; need 0 < E <= 1e100 and -1 < nu < 0.5 (an incompressible layer is rigid for a spring "
        "bed): mend its material, or give others with --E \"{}=VALUE\" --nu \"{}=VALUE\"",
        E, nu, s.name, s.name);
  };
  // No thickness: what else is missing is told too.
  const auto refuse_thickness = [&](const std::string& text) {
    InputError error = refuse(text);
    const std::string modulus = set_modulus();
    if (!modulus.empty()) error.others.push_back(refuse(modulus).what());
    return error;
  };

  const auto leave_out_facets = [&] {
    layer.facet_kinds = kinds_of(boundary, carried.facets);
    const auto of_kind = [&](FaceKind kind) {
      return std::count(layer.facet_kinds.begin(), layer.facet_kinds.end(), kind);
    };
    // A block on rollers or held by its sides: no facet looks at the bone. With a thickness given that need not matter.
    const bool all_turned = of_kind(FaceKind::SideWall) == s.size();
    if (std::count(settings.keep_facets.begin(), settings.keep_facets.end(), s.name) > 0 ||
        of_kind(FaceKind::Open) == s.size() || (all_turned && (given_thickness || given.map)))
      layer.facet_kinds.clear();
    if (layer.facet_kinds.empty()) return;
    if (all_turned)
      throw refuse_thickness(
          fmt::format("all its facets ({}) turn away from the bone of body \"{}\", as side walls do: this is no layer "
                      "of cartilage on a bone; select the articular face, name the bone surface with --bone "
                      "\"{}=SURFACE\" or give --thickness \"{}=VALUE\"",
                      s.size(), r.bodies.bodies[at(layer.body)].name, s.name, s.name));
    const std::string why = mostly_left_out(model, carried.facets, layer.facet_kinds, s.name);
    if (!why.empty()) throw refuse(why);
    const FacetList kept = kept_facets(carried.facets, layer.facet_kinds);
    layer.articular = make_surface_mesh(kept.begin, kept.nodes, model.nodes);
    if (facets_of(r, contact) == Facets::Flat) layer.articular.bulge.assign(layer.articular.bulge.size(), {0, 0, 0});
  };

  if (roots.empty()) {  // a rigid surface
    if (bodies.size() > 1) throw refuse("lies on several rigid bodies; split it into one surface per body");
    if (layer.body < 0) {
      layer.body = *bodies.begin();
      layer.attached_by = "is a surface of the rigid body itself";
    }
    if (contact.dea && !given_thickness && !given.map && (given_E || given_nu))
      throw refuse(
          fmt::format("the thickness of its layer cannot be measured, for it does not lie on solid elements; give it "
                      "in the contact as <{}_thickness>, or with --thickness \"{}=VALUE\"",
                      side == 0 ? "primary" : "secondary", s.name));
    layer.rigid = !given.map && (!given_thickness || *given_thickness == 0.0);
    if (!layer.rigid && layer.springs_at == SpringsAt::Bone)
      throw refuse(
          "a thickness given for a bare rigid surface lies under that surface, and the bone under it is not in the "
          "model: use --springs-at articular");
    layer.bone = layer.articular;
  } else {
    const int root = *roots.begin();
    const auto held = r.held.find(root);
    if (layer.body < 0) {
      if ((held == r.held.end() || held->second.empty()) && contact.dea && r.rigid[at(layer_material(materials))])
        throw refuse(
            fmt::format("the thickness of its layer cannot be measured, for its elements share no nodes with the bone "
                        "under them; give it in the contact as <{}_thickness>, or with --thickness \"{}=VALUE\"",
                        side == 0 ? "primary" : "secondary", s.name));
      if (held == r.held.end() || held->second.empty()) {
        throw refuse(not_held(r, root, layer_material(materials), s.name));
      }
      if (held->second.size() > 1) {
        std::string list;
        for (const auto& h : held->second) list += (list.empty() ? "" : "; ") + h.second;
        const auto moved = std::count_if(held->second.begin(), held->second.end(),
                                         [&](const auto& h) { return !r.bodies.bodies[at(h.first)].moved_by.empty(); });
        throw refuse(fmt::format(
            "its layer is held by {} bodies ({}){}; choose with --attach \"{}=BODY\"", held->second.size(), list,
            moved > 0 ? ", and moved nodes move otherwise than the rest, so it is not bonded to one "
                        "bone: move all alike, or divide the layer"
                      : "",
            s.name));
      }
      layer.body = held->second.begin()->first;
      layer.attached_by = held->second.begin()->second;
    }
    layer.material = layer_material(materials);

    // Another, much stiffer material in the same deformable part is a deformable bone: the "layer" would be bone and
    // all.
    std::set<int> region_materials;
    std::set<int> nodes;
    for (const Domain& d : model.domains) {
      if (!deformable(r, d)) continue;
      const int n = nodes_per_element(d.shape);
      for (std::size_t e = 0; e < d.element_ids.size(); ++e) {
        if (r.region[at(d.nodes[e * at(n)])] != root) continue;
        region_materials.insert(d.material);
        for (int k = 0; k < n; ++k) nodes.insert(d.nodes[e * at(n) + at(k)]);
        if (!is_shell(d.shape)) {
          const ElementVolume v = element_volume(model, d, static_cast<int>(e));
          if (!(v.volume > 0)) throw no_volume(model, d, static_cast<int>(e), v.volume);
        }
      }
    }
    layer.region_nodes.assign(nodes.begin(), nodes.end());
    const double E = given_E.value_or(model.materials[at(layer.material)].E);
    for (const auto& m : materials) {
      const Material &one = model.materials[at(m.first)], &main = model.materials[at(layer.material)];
      if (m.first == layer.material || (one.E == main.E && one.nu == main.nu) || (given_E && given_nu)) continue;
      const auto modulus = [](const Material& x) {
        return std::isnan(x.E) ? std::string("no modulus known") : fmt::format("E {:g}, nu {:g}", x.E, x.nu);
      };
      throw refuse(
          fmt::format("its facets lie on several materials (\"{}\": {}; \"{}\": {}), but a layer has one modulus here; "
                      "split the surface, or give the modulus with --E \"{}=VALUE\" --nu \"{}=VALUE\"",
                      main.name, modulus(main), one.name, modulus(one), s.name, s.name));
    }
    for (int m : region_materials) {
      const double other = model.materials[at(m)].E;
      if (m == layer.material || given_thickness || given.map) continue;
      if (!(other <= 5.0 * E))
        throw refuse(fmt::format(
            "its part also holds material \"{}\" ({}), a deformable bone? DEA keeps bones rigid: type --rigid \"{}\"",
            model.materials[at(m)].name,
            std::isnan(other)
                ? "no modulus known"
                : fmt::format("E = {:g} against {:g} of \"{}\"", other, E, model.materials[at(layer.material)].name),
            model.materials[at(m)].name));
      note_other_material(m, E);
    }

    const std::string bone = surface_override(settings.bone, s.name);
    boundary.node_held = held_by(r, layer.body);
    if (!bone.empty() && surface_index(model, bone) >= 0)
      for (int node : model.surfaces[at(surface_index(model, bone))].nodes) boundary.node_held[at(node)] = 1;
    boundary = find_layer_boundary(model, region_elements(r, root), std::move(boundary.node_held));
    open_feather_facets(model, carried.facets, boundary);
    if (!bone.empty()) {
      const int b = surface_index(model, bone);
      if (b < 0)
        throw UsageError(fmt::format("--bone {}={}: the model has no surface \"{}\"; it has {}", s.name, bone, bone,
                                     name_list(surface_names(model), bone)));
      const CarriedSurface facets = carry(r, b);
      layer.bone = make_surface_mesh(facets.facets.begin, facets.facets.nodes, model.nodes);
      // out of the bone means: towards the articular surface
      const FacetList above = kept_facets(carried.facets, kinds_of(boundary, carried.facets));
      SurfaceMesh articular = make_surface_mesh(above.begin, above.nodes, model.nodes);
      if (articular.size() == 0) articular = layer.articular;
      const RayCaster caster(articular);
      double towards = 0.0;
      for (int t = 0; t < layer.bone.size(); ++t)
        towards += layer.bone.areas[at(t)] *
                   layer.bone.normals[at(t)].dot(position(articular, caster.closest(layer.bone.centroid(t))) -
                                                 layer.bone.centroid(t));
      if (towards < 0) {
        std::vector<int> begin = {0}, list;
        for (int t = 0; t < layer.bone.size(); ++t) {
          const auto& tri = layer.bone.triangles[at(t)];
          for (int v : {tri[0], tri[2], tri[1]}) list.push_back(layer.bone.model_nodes[at(v)]);
          begin.push_back(static_cast<int>(list.size()));
        }
        layer.bone = make_surface_mesh(begin, list, model.nodes);
      }
    } else {
      layer.bone = bonded_surface(model, boundary);
    }
    if (layer.bone.size() > 0)
      find_side_walls(model, layer.bone, boundary);
    else
      find_side_walls(model, carried.facets, boundary);
    leave_out_facets();
    if (layer.bone.size() == 0) {
      if (!given_thickness && !given.map)
        throw refuse_thickness(
            fmt::format("no face of its layer is held by body \"{}\" with all its nodes, so there is no bone surface "
                        "to measure the "
                        "thickness to; name it with --bone \"{}=SURFACE\" or give --thickness \"{}=VALUE\"",
                        r.bodies.bodies[at(layer.body)].name, s.name, s.name));
      if (layer.springs_at == SpringsAt::Bone)
        throw refuse(fmt::format("--springs-at bone needs a bone surface; name it with --bone \"{}=SURFACE\"", s.name));
      layer.bone = layer.articular;
    }
  }

  if (facets_of(r, contact) == Facets::Flat) {
    layer.articular.bulge.assign(layer.articular.bulge.size(), {0, 0, 0});
    layer.bone.bulge.assign(layer.bone.bulge.size(), {0, 0, 0});
  }

  for (int node : layer.articular.model_nodes) layer.mirror.push_back(r.mirror[at(node)]);

  const std::string modulus = set_modulus();
  if (!modulus.empty()) throw refuse(modulus);

  // Thickness.
  const std::size_t n = layer.spring_surface().vertices.size();
  if (layer.rigid) {
    layer.thickness.assign(n, 0.0);
    layer.missed.assign(n, 0);
  } else if (given.map) {
    if (layer.springs_at == SpringsAt::Bone)
      throw refuse("its thickness is a map on the articular surface: use --springs-at articular");
    layer.thickness = mapped_thickness(s, contact.dea->layers[side].thickness_map, layer.articular);
    layer.missed.assign(n, 0);
    layer.thickness_given = true;
    if (!(layer.mean_thickness() > 0))
      throw refuse("its thickness map is zero everywhere: mend the map, or give --thickness");
  } else if (given_thickness) {
    if (!(*given_thickness > 0) || !std::isfinite(*given_thickness))
      throw UsageError(
          fmt::format("--thickness {}={:g}: surface \"{}\" lies on deformable cartilage, whose thickness must be > 0; "
                      "only a surface of a rigid body may have 0, which is no cartilage",
                      s.name, *given_thickness, s.name));
    layer.thickness.assign(n, *given_thickness);
    layer.missed.assign(n, 0);
    layer.thickness_given = true;
  } else {
    MeasuredThickness measured = layer.springs_at == SpringsAt::Bone
                                     ? measure_thickness_from_bone(layer.bone, layer.articular)
                                     : measure_thickness(layer.articular, layer.bone);
    layer.thickness = std::move(measured.thickness);
    layer.missed = std::move(measured.missed);
    if (2 * layer.missed_count() > static_cast<int>(layer.missed.size()))
      throw refuse_thickness(
          fmt::format("its normals meet no bone surface of body \"{}\" ({} of {} miss): this is no layer of cartilage "
                      "on a bone, and closest points would "
                      "give it a thickness that means nothing; name the bone surface with --bone \"{}=SURFACE\" or "
                      "give --thickness \"{}=VALUE\"",
                      r.bodies.bodies[at(layer.body)].name, layer.missed_count(), layer.missed.size(), s.name, s.name));
    const double mean = layer.mean_thickness();
    if (!(mean > 0))
      throw refuse(
          fmt::format("its layer has no thickness: the articular and the bone surface are the same; name the bone "
                      "surface with --bone \"{}=SURFACE\" or give --thickness \"{}=VALUE\"",
                      s.name, s.name));
  }
  if (roots.empty() && given.map && layer.springs_at == SpringsAt::Articular) {
    boundary = rigid_boundary(r, carried, layer, contact.dea->layers[side].thickness_map);
    if (boundary.faces.size() > 0) {
      leave_out_facets();
      layer.bone = layer.articular;
      layer.thickness = mapped_thickness(s, contact.dea->layers[side].thickness_map, layer.articular);
      layer.missed.assign(layer.thickness.size(), 0);
    }
  }
  if (!layer.rigid && boundary.faces.size() > 0 && layer.springs_at == SpringsAt::Articular)
    find_layer_face(r, contact, carried, boundary, layer);
  return layer;
}

/// The triangles that two surfaces share.
int shared_triangles(const SurfaceMesh& a, const SurfaceMesh& b) {
  const auto nodes = [](const SurfaceMesh& mesh, int t) {
    std::array<int, 3> n;
    for (std::size_t k = 0; k < 3; ++k) n[k] = mesh.model_nodes[at(mesh.triangles[at(t)][k])];
    std::sort(n.begin(), n.end());
    return n;
  };
  std::set<std::array<int, 3>> of_a;
  for (int t = 0; t < a.size(); ++t) of_a.insert(nodes(a, t));
  int shared = 0;
  for (int t = 0; t < b.size(); ++t) shared += static_cast<int>(of_a.count(nodes(b, t)));
  return shared;
}

/// Contacts of different names that press facets of the same cartilage. InputError: the same facets twice, between the
/// same bodies.
void note_shared_layers(const JointModel& model, Joint& joint, const ContactPair& pair) {
  for (const ContactPair& other : joint.contacts) {
    if (pair.step >= 0 && other.step >= 0 && pair.step != other.step) continue;
    for (int side = 0; side < 2; ++side)
      for (int other_side = 0; other_side < 2; ++other_side) {
        const Layer &a = pair.layers[side], &b = other.layers[other_side];
        if (a.rigid || b.rigid || a.body != b.body) continue;
        const std::set<int> nodes(a.articular.model_nodes.begin(), a.articular.model_nodes.end());
        if (std::none_of(b.articular.model_nodes.begin(), b.articular.model_nodes.end(),
                         [&](int node) { return nodes.count(node) > 0; }))
          continue;
        const std::string &one = model.surfaces[at(b.surface)].name, &two = model.surfaces[at(a.surface)].name;
        const bool same_partner = pair.layers[1 - side].body == other.layers[1 - other_side].body;
        const int twice = same_partner ? shared_triangles(a.articular, b.articular) : 0;
        if (twice > 0)
          throw fault_at(
              model, model.contacts[at(pair.contact)].origin,
              fmt::format("contacts \"{}\" and \"{}\" both press {} facets of the same layer (surfaces \"{}\" "
                          "and \"{}\"), which would count twice: give each facet to one of them, or keep one "
                          "contact with --contact \"{}\"",
                          other.name, pair.name, (twice + 1) / 2, one, two, other.name));
        joint.findings.push_back(fmt::format(
            "contacts \"{}\" and \"{}\" press the same layer side by side (surfaces \"{}\", \"{}\"): each is solved as "
            "if the other did not press; where both press within two thicknesses of each other their pressures come "
            "out too high or too low there: one contact with one surface tells it right",
            other.name, pair.name, one, two));
      }
  }
}

/// Does a shell surface look away from its partner? Compared at the closest points, area-weighted.
bool looks_away(const SurfaceMesh& surface, const SurfaceMesh& partner) {
  const RayCaster caster(partner);
  double facing = 0.0;
  for (int t = 0; t < surface.size(); ++t) {
    const SurfacePoint p = caster.closest(surface.centroid(t));
    facing += surface.areas[at(t)] * surface.normals[at(t)].dot(partner.normals[at(p.triangle)]);
  }
  return facing > 0;
}

void flip(SurfaceMesh& mesh, const JointModel& model) {
  std::vector<int> begin = {0}, list, facet = mesh.facet;
  const int facets = mesh.facets;
  for (const auto& tri : mesh.triangles) {
    for (int v : {tri[0], tri[2], tri[1]}) list.push_back(mesh.model_nodes[at(v)]);
    begin.push_back(static_cast<int>(list.size()));
  }
  mesh = make_surface_mesh(begin, list, model.nodes);
  mesh.facet = facet;
  mesh.facets = facets;
}

void check_names(const JointModel& model, const Settings& settings, const Joint& joint) {
  const auto check_surface = [&](const std::string& option, const std::string& name) {
    if (!name.empty() && surface_index(model, name) < 0)
      throw UsageError(fmt::format("--{} {}: the model has no surface of this name; it has {}", option, name,
                                   name_list(surface_names(model), name)));
  };
  for (const auto& e : settings.attach) check_surface("attach", e.first);
  for (const auto& e : settings.bone) check_surface("bone", e.first);
  for (const std::string& name : settings.keep_facets) check_surface("keep-facets", name);
  for (const auto& e : settings.thickness) check_surface("thickness", e.first);
  for (const auto& e : settings.E) check_surface("E", e.first);
  for (const auto& e : settings.nu) check_surface("nu", e.first);
  const auto check_body = [&](const std::string& option, const std::string& name) {
    if (joint.find_body(model, name) >= 0) return;
    std::vector<std::string> names;
    for (const Body& b : joint.bodies) names.push_back(b.name);
    throw UsageError(fmt::format("--{} {}: the model has no rigid body of this name; it has {}", option, name,
                                 name_list(names, name)));
  };
  for (const auto& e : settings.free) {
    check_body("free", e.first);
    if (joint.bodies[at(joint.find_body(model, e.first))].ground)
      throw UsageError(fmt::format("--free {}: the ground never moves; name a rigid body", e.first));
  }
  for (const auto& e : settings.force) check_body("force", e.first);
  for (const auto& e : settings.load_at) check_body("load-at", e.first);
  if (!settings.source.empty()) check_body("source", settings.source);
}

// ---- what joins bodies besides contact -----------------------------------------------------------------------------

/// Adds it, unless both ends are on one body. `kind`: what the model calls such a thing.
void add_ligament(Joint& joint, const JointModel& model, Ligament l, const char* kind, Origin origin) {
  l.origin = origin;
  l.where = where(model, origin);
  if (l.body_a == l.body_b) {
    joint.findings.push_back(fmt::format("{} \"{}\" joins two points of body \"{}\": left out", kind, l.name,
                                         joint.bodies[at(l.body_a)].name));
    return;
  }
  const double length = (l.point_b - l.point_a).norm();
  if (l.free_length <= 0) l.free_length = length;
  if (!(length > 0) || !std::isfinite(length))
    throw fault_at(model, origin,
                   fmt::format("{} \"{}\" has no length: its two points coincide, move one", kind, l.name));
  joint.ligaments.push_back(std::move(l));
}

/// Body of a rigid material; no material: the ground.
int body_of_material(const Recognition& r, int material) {
  return material < 0 ? r.bodies.ground() : r.bodies.of_material[at(material)];
}

/// A point given in reference coordinates, or counted from the body's centre of mass.
Vector3d reference_point(const Joint& joint, int body, const Vector3d& point, bool from_center) {
  return from_center ? Vector3d(joint.bodies[at(body)].center_of_mass + point) : point;
}

void find_springs(const Recognition& r, Joint& joint) {
  const JointModel& model = r.model;
  for (const RigidSpring& s : model.rigid_springs) {
    Ligament l;
    l.name = s.name;
    l.body_a = body_of_material(r, s.material_a);
    l.body_b = body_of_material(r, s.material_b);
    l.point_a = s.insertion_a;
    l.point_b = s.insertion_b;
    l.stiffness = s.k;
    l.free_length = s.free_length;
    l.step = s.step;
    add_ligament(joint, model, l, "spring", s.origin);
  }
  for (const DiscreteSprings& set : model.discrete_springs) {
    if (set.force && !set.force->unsupported.empty())
      throw fault_at(model, set.origin,
                     fmt::format("spring \"{}\": its force is given by {}, which is not supported; give points",
                                 set.name, set.force->unsupported));
    for (const auto& pair : model.discrete_sets[at(set.set)].pairs) {
      Ligament l;
      l.name = set.name.empty() ? model.discrete_sets[at(set.set)].name : set.name;
      l.body_a = joint.node_body[at(pair[0])];
      l.body_b = joint.node_body[at(pair[1])];
      for (int k = 0; k < 2; ++k)
        if (joint.node_body[at(pair[at(k)])] < 0)
          throw fault_at(
              model, set.origin,
              fmt::format("spring \"{}\" is fastened to node {}, which belongs to no rigid body: fasten it to "
                          "a node of a bone",
                          l.name, model.node_ids[at(pair[at(k)])]));
      l.point_a = model.nodes[at(pair[0])];
      l.point_b = model.nodes[at(pair[1])];
      l.stiffness = set.stiffness;
      l.tension_only = set.tension_only;
      if (set.force) {
        l.law = Ligament::Law::Curve;
        l.curve = set.force;
        l.measure = set.measure;
        l.scale = set.scale;
      }
      l.step = set.step;
      add_ligament(joint, model, l, "spring", set.origin);
    }
  }
  for (const RigidAxialForce& f : model.rigid_axial_forces) {
    Ligament l;
    l.name = f.name;
    l.law = Ligament::Law::Constant;
    l.body_a = body_of_material(r, f.material_a);
    l.body_b = body_of_material(r, f.material_b);
    l.point_a = reference_point(joint, l.body_a, f.point_a, f.from_centers);
    l.point_b = reference_point(joint, l.body_b, f.point_b, f.from_centers);
    l.scale = f.force;
    l.step = f.step;
    add_ligament(joint, model, l, "axial force", f.origin);
  }
}

void find_cables(const Recognition& r, Joint& joint) {
  for (const RigidCable& c : r.model.rigid_cables) {
    Cable cable;
    cable.name = c.name;
    for (const RigidCable::Point& p : c.points) {
      const int body = body_of_material(r, p.material);
      cable.points.push_back({body, reference_point(joint, body, p.position, c.from_centers)});
    }
    if (cable.points.empty())
      throw fault_at(r.model, c.origin, fmt::format("cable \"{}\" has no points: add those it runs through", c.name));
    for (std::size_t i = 1; i < cable.points.size(); ++i)
      if (!((cable.points[i].position - cable.points[i - 1].position).norm() > 0))
        throw fault_at(r.model, c.origin,
                       fmt::format("cable \"{}\": points {} and {} coincide, so the cable has no direction there; "
                                   "take one out",
                                   c.name, i, i + 1));
    cable.force = c.force;
    if (c.direction.norm() > 0) cable.direction = c.direction.normalized();
    cable.step = c.step;
    cable.origin = c.origin;
    joint.cables.push_back(std::move(cable));
  }
}

void find_connectors(const Recognition& r, Joint& joint) {
  for (const RigidJoint& j : r.model.rigid_joints) {
    Connector c;
    c.name = j.name;
    c.type = j.type;
    c.body_a = body_of_material(r, j.material_a);
    c.body_b = body_of_material(r, j.material_b);
    c.point = j.joint_origin;
    c.axes = j.axes;
    c.motion = j.motion;
    c.value = j.value;
    c.step = j.step;
    c.origin = j.origin;
    if (!((c.axes.transpose() * c.axes - Eigen::Matrix3d::Identity()).norm() < 1e-6) || !(c.axes.determinant() > 0))
      throw fault_at(r.model, j.origin,
                     fmt::format("joint \"{}\": its axes span no right-handed frame; give two axes that are not "
                                 "parallel",
                                 j.name));
    if (c.body_a == c.body_b) {
      joint.findings.push_back(fmt::format("joint \"{}\" joins two points of body \"{}\": left out", c.name,
                                           joint.bodies[at(c.body_a)].name));
      continue;
    }
    joint.connectors.push_back(std::move(c));
  }
}

/// Nodal forces on nodes that move with a body: of its rigid elements, or of its rigid node sets.
void find_point_loads(const Recognition& r, Joint& joint) {
  const JointModel& model = r.model;
  if (model.nodal_forces.empty()) return;
  std::vector<int> body(model.nodes.size(), -1);
  for (const Domain& d : model.domains) {
    if (d.material < 0 || !r.rigid[at(d.material)] || is_line(d.shape)) continue;
    for (int node : d.nodes) body[at(node)] = r.bodies.of_material[at(d.material)];
  }
  for (const RigidNodes& set : model.rigid_nodes)
    for (int node : set.nodes)
      if (body[at(node)] < 0) body[at(node)] = r.bodies.of_material[at(set.material)];
  for (const NodalForce& f : model.nodal_forces) {
    for (int node : f.nodes) {
      if (body[at(node)] < 0)
        throw fault_at(model, f.origin,
                       fmt::format("nodal force \"{}\" acts on node {}, which is part of no rigid body; DEA can load "
                                   "rigid bodies only: load a node of the bone, or use a rigid force",
                                   f.name, model.node_ids[at(node)]));
      joint.point_loads.push_back(
          {f.name, body[at(node)], model.nodes[at(node)], f.value, f.controller, f.step, f.origin});
    }
  }
}

void find_connections(const Recognition& r, Joint& joint) {
  find_springs(r, joint);
  find_cables(r, joint);
  find_connectors(r, joint);
  find_point_loads(r, joint);
}

}  // namespace

double Layer::facet_size() const {
  double sum = 0.0, area = 0.0;
  if (rigid || springs_at == SpringsAt::Bone) return 0.0;
  for (int t = 0; t < articular.size(); ++t) {
    double mean = 0.0;
    for (int v : articular.triangles[at(t)]) mean += thickness[at(v)] / 3;
    if (!(mean > 0)) continue;
    sum += articular.areas[at(t)] * std::sqrt(2 * articular.areas[at(t)]) / mean;
    area += articular.areas[at(t)];
  }
  return area > 0 ? sum / area : 0.0;
}

double Layer::min_thickness() const {
  return thickness.empty() ? 0.0 : *std::min_element(thickness.begin(), thickness.end());
}
double Layer::max_thickness() const {
  return thickness.empty() ? 0.0 : *std::max_element(thickness.begin(), thickness.end());
}
double Layer::mean_thickness() const {
  double sum = 0.0, area = 0.0;
  for (std::size_t v = 0; v < thickness.size(); ++v) {
    sum += thickness[v] * spring_surface().vertex_areas[v];
    area += spring_surface().vertex_areas[v];
  }
  return area > 0 ? sum / area : 0.0;
}
int Layer::missed_count() const { return static_cast<int>(std::count(missed.begin(), missed.end(), 1)); }

int Joint::find_body(const JointModel& model, const std::string& name) const {
  return body_by_name(model, bodies, name);
}

std::string no_sliding_contact(const JointModel& model) {
  std::string found;
  Origin first;
  const auto list = [&](const std::string& what, Origin origin) {
    if (found.empty()) first = origin;
    found += (found.empty() ? "" : ", ") + what;
  };
  for (const Contact& c : model.contacts)
    if (c.kind == Contact::Kind::Tied) list(fmt::format("\"{}\" of type {}", c.name, c.type), c.origin);
  const bool tied = !found.empty();
  for (const Remark& r : model.unsupported)
    if (r.what.rfind("contact ", 0) == 0 || r.what.rfind("constraint \"rigid_wall", 0) == 0) {
      const std::size_t question = r.advice.rfind("did you mean ", 0) == 0 ? r.advice.find('?') : std::string::npos;
      list(r.what + (question == std::string::npos ? "" : " (" + r.advice.substr(0, question + 1) + ")"), r.origin);
    }
  return where(model, first) +
         fmt::format(
             "no sliding contact in the model; DEA needs one between two bodies (Contact section, e.g. type "
             "\"sliding-elastic\"){}{}",
             found.empty() ? ", and there is no contact at all: add one, or there is nothing to solve for DEA"
                           : "; found " + found,
             tied ? ", which fastens surfaces: change its type if they are to slide" : "");
}

Joint make_joint(const JointModel& model, const Settings& settings) {
  Recognition r{model, settings, rigid_materials(model, settings), {}, {}, {}, {}, {}, {}, {}, {}, {}};
  find_faces(r);
  find_layer_domains(r);
  r.bodies = find_bodies(model, r.rigid, r.layer_domains);
  find_regions(r);
  Joint joint;
  std::vector<std::string> faults;  // all are told at once
  find_moved_bodies(r, joint.findings, faults);
  find_holders(r);
  joint.bodies = r.bodies.bodies;
  check_names(model, settings, joint);
  for (const RigidNodes& set : model.rigid_nodes)
    if (set.step >= 0)
      joint.findings.push_back(
          fmt::format("rigid node set \"{}\" is given for step {} only; it is taken to hold its nodes in all steps",
                      set.name, set.step + 1));
  for (const std::string& name : settings.rigid)
    joint.findings.push_back(fmt::format("material \"{}\" is taken as rigid (--rigid)", name));

  // Contact pairs.
  bool named = settings.contact.empty();
  int sliding = 0;
  std::vector<std::string> names;
  for (int i = 0; i < static_cast<int>(model.contacts.size()); ++i) {
    const Contact& c = model.contacts[at(i)];
    if (c.kind != Contact::Kind::Sliding) continue;
    ++sliding;
    names.push_back(c.name);
    if (!settings.contact.empty() && c.name != settings.contact) continue;
    named = true;
    if (c.primary < 0 || c.secondary < 0)
      throw fault_at(model, c.origin, fmt::format("contact \"{}\" lacks a surface: give it two", c.name));
    ContactPair pair;
    pair.name = c.name;
    pair.contact = i;
    pair.step = c.step;
    pair.source = c.dea ? c.dea->source : 0;
    pair.law = law_of(r, c);
    pair.layer_fit = settings.layer_fit;
    if (settings.interface_stiffness) pair.interface_compliance = 1.0 / *settings.interface_stiffness;
    if (pair.law == Law::Layer && settings.springs_at == SpringsAt::Bone)
      throw UsageError(
          "--springs-at bone: the layer law needs springs at the articular surface; use --law linear, logarithmic or "
          "neo-Hookean");
    if (pair.law != Law::Layer && settings.layer_fit == LayerFit::OneTerm)
      throw UsageError(
          fmt::format("--layer-terms 1: contact \"{}\" has law {}; only law layer has terms", c.name, name(pair.law)));
    pair.facets = facets_of(r, c);
    pair.refine = settings.refine.value_or(c.dea ? c.dea->refine.value_or(1) : 1);
    bool good = true;
    for (int side = 0; side < 2; ++side) {
      try {
        pair.layers[side] = make_layer(r, c, side);
      } catch (const InputError& error) {
        good = false;
        std::vector<std::string> lines = error.others;
        lines.insert(lines.begin(), error.what());
        for (const std::string& line : lines)
          if (std::find(faults.begin(), faults.end(), line) == faults.end()) faults.push_back(line);
      }
    }
    if (!good) continue;
    const double springs = static_cast<double>(pair.refine) * pair.refine * pair.source_layer().spring_surface().size();
    if (springs > kMostSprings)
      throw UsageError(fmt::format("--refine {}: {:.0f} springs for contact \"{}\", need at most {:.0f}", pair.refine,
                                   springs, c.name, kMostSprings));
    for (const ContactPair& other : joint.contacts) {
      const Contact& o = model.contacts[at(other.contact)];
      if (double_contact(o, c))
        throw fault_at(model, c.origin,
                       fmt::format("contacts \"{}\" and \"{}\" join the same surfaces at the same time and would "
                                   "share the load between them; "
                                   "keep one: --contact \"{}\"",
                                   o.name, c.name, o.name));
    }
    if (pair.layers[0].body == pair.layers[1].body) {
      joint.findings.push_back(fmt::format("contact \"{}\": both surfaces belong to body \"{}\": left out", c.name,
                                           joint.bodies[at(pair.layers[0].body)].name));
      continue;
    }
    if (pair.layers[0].rigid && pair.layers[1].rigid)
      throw fault_at(
          model, c.origin,
          fmt::format("contact \"{}\": both surfaces are bare rigid surfaces, there is no cartilage to "
                      "compress; give one a layer {}"
                      "with --thickness \"SURFACE=VALUE\" --E \"SURFACE=VALUE\" --nu \"SURFACE=VALUE\"",
                      c.name, c.dea ? "in the contact as <primary_thickness>, <primary_E>, <primary_nu>, or " : ""));
    // A shell surface has two sides: turn it to its partner. Solids know their outside.
    for (int side = 0; side < 2; ++side) {
      Layer& layer = pair.layers[side];
      if (layer.material >= 0 || !carry(r, layer.surface).on_shells ||
          !looks_away(layer.articular, pair.layers[1 - side].articular))
        continue;
      flip(layer.articular, model);
      if (facets_of(r, c) == Facets::Flat) layer.articular.bulge.assign(layer.articular.bulge.size(), {0, 0, 0});
      layer.bone = layer.articular;
      joint.findings.push_back(
          fmt::format("surface \"{}\" lies on rigid shells and looked away from its partner: turned round",
                      model.surfaces[at(layer.surface)].name));
    }
    for (Layer& layer : pair.layers)
      if (!layer.rigid && layer.springs_at == SpringsAt::Articular && layer.face.mesh.size() == 0) {
        layer.face = selected_face(layer.articular, r.mirror);
        layer.face.thickness = layer.thickness;
      }
    for (const Layer& layer : pair.layers) {
      joint.findings.insert(joint.findings.end(), layer.notes.begin(), layer.notes.end());
      const std::string rim = rim_note(model.surfaces[at(layer.surface)].name, layer.face);
      if (!rim.empty()) joint.findings.push_back(rim);
      const std::string left_out = left_out_note(model.surfaces[at(layer.surface)].name, layer.facet_kinds);
      if (!left_out.empty()) joint.findings.push_back(left_out);
      const std::string shells = coating(r, layer);
      if (!shells.empty())
        joint.findings.push_back(fmt::format(
            "surface \"{}\": deformable shells {} cover its cartilage; their stiffness and thickness are left out",
            model.surfaces[at(layer.surface)].name, shells));
      const double thickness = layer.mean_thickness(),
                   radius = std::sqrt(surface_extent(layer.articular).area / std::numbers::pi);
      if (thickness > radius)
        joint.findings.push_back(fmt::format(
            "surface \"{}\": cartilage of mean thickness {:.3g} is no thin layer on a surface as large as a "
            "circle of radius {:.3g}; springs and the layer law suppose one: check --thickness or --bone",
            model.surfaces[at(layer.surface)].name, thickness, radius));
    }
    if (!settings.source.empty()) {
      const int body = joint.find_body(model, settings.source);
      if (pair.layers[0].body == body) pair.source = 0;
      if (pair.layers[1].body == body) pair.source = 1;
    }
    note_shared_layers(model, joint, pair);
    joint.contacts.push_back(std::move(pair));
  }
  if (!named)
    throw UsageError(fmt::format("--contact {}: the model has no sliding contact of this name; it has {}",
                                 settings.contact, name_list(names, settings.contact)));
  if (!faults.empty()) {
    InputError error(faults.front());
    error.others.assign(faults.begin() + 1, faults.end());
    throw error;
  }
  if (joint.contacts.empty()) {
    if (sliding == 0) throw InputError(no_sliding_contact(model));
    throw InputError(where(model, {0, 0}) + "no sliding contact joins two different bodies: " + joint.findings.back() +
                     "; name the body of one side with --attach \"SURFACE=BODY\"");
  }

  joint.node_body = r.bodies.of_node;
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    if (joint.node_body[i] >= 0) continue;
    if (r.region[i] >= 0) {
      const auto held = r.held.find(r.region[i]);
      if (held != r.held.end() && held->second.size() == 1) joint.node_body[i] = held->second.begin()->first;
    }
  }
  for (const RigidNodes& set : model.rigid_nodes)
    for (int node : set.nodes)
      if (joint.node_body[at(node)] < 0) joint.node_body[at(node)] = r.bodies.of_material[at(set.material)];
  for (const ContactPair& pair : joint.contacts)
    for (const Layer& layer : pair.layers)
      for (int node : layer.region_nodes)
        if (r.bodies.of_node[at(node)] < 0) joint.node_body[at(node)] = layer.body;
  for (std::size_t i = 0; i < model.nodes.size(); ++i)
    if (joint.node_body[i] < 0) joint.node_body[i] = r.fixed[i] ? r.bodies.ground() : r.moved[i];

  find_connections(r, joint);
  return joint;
}

}  // namespace dea

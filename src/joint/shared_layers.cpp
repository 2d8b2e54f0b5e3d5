#include "src/joint/shared_layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "src/base/disjoint_sets.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/facts/given_layer.h"
#include "src/facts/parts.h"

namespace dea {

namespace {

/// A triangle by its nodes in the model, the least first, in their order round: the same triangle seen from its other
/// side is another one.
using TriangleKey = std::array<int, 3>;

struct KeyedTriangle {
  TriangleKey key;
  unsigned char turn = 0;  ///< corner k of the triangle is corner k + turn of the key
};

KeyedTriangle keyed(const SurfaceMesh& mesh, int t) {
  TriangleKey nodes;
  for (std::size_t k = 0; k < 3; ++k) nodes[k] = mesh.model_nodes[at(mesh.triangles[at(t)][k])];
  const auto least = std::min_element(nodes.begin(), nodes.end()) - nodes.begin();
  std::rotate(nodes.begin(), nodes.begin() + least, nodes.end());
  return {nodes, static_cast<unsigned char>((3 - least) % 3)};
}

using Keys = std::vector<TriangleKey>;  // sorted, each once

void add_keys(Keys& keys, const SurfaceMesh& mesh) {
  for (int t = 0; t < mesh.size(); ++t) keys.push_back(keyed(mesh, t).key);
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
}
Keys keys_of(const SurfaceMesh& mesh) {
  Keys keys;
  add_keys(keys, mesh);
  return keys;
}
bool has(const Keys& keys, const TriangleKey& key) { return std::binary_search(keys.begin(), keys.end(), key); }
int number_of(const Keys& keys, const TriangleKey& key) {
  return static_cast<int>(std::lower_bound(keys.begin(), keys.end(), key) - keys.begin());
}
bool meet(const Keys& a, const Keys& b) {
  return std::any_of(a.begin(), a.end(), [&](const TriangleKey& key) { return has(b, key); });
}

using EdgeKey = std::array<int, 2>;
EdgeKey edge_key(const SurfaceMesh& mesh, int t, int k) {
  const auto& corners = mesh.triangles[at(t)];
  const int a = mesh.model_nodes[at(corners[at(k)])], b = mesh.model_nodes[at(corners[at((k + 1) % 3)])];
  return {std::min(a, b), std::max(a, b)};
}
std::set<EdgeKey> edges_of(const SurfaceMesh& mesh) {
  std::set<EdgeKey> edges;
  for (int t = 0; t < mesh.size(); ++t)
    for (int k = 0; k < 3; ++k) edges.insert(edge_key(mesh, t, k));
  return edges;
}

/// A side of a contact with what is asked of it again and again.
struct Side {
  int contact, side;
  const Layer* layer;
  Keys selected, face;  // triangles of the articular surface, of the whole face
};

bool share_nodes(std::vector<int> a, std::vector<int> b) {
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  std::vector<int> both;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  return !both.empty();
}

/// Nodes by which layers are told to hang together.
const std::vector<int>& nodes_of(const Layer& layer) {
  if (!layer.region_nodes.empty()) return layer.region_nodes;
  return layer.face.mesh.size() > 0 ? layer.face.mesh.model_nodes : layer.articular.model_nodes;
}

/// Does what one side presses flow to where the other presses?
bool run_into_each_other(const Side& a, const Side& b) {
  if (meet(a.selected, b.selected) || meet(a.selected, b.face) || meet(b.selected, a.face)) return true;
  if (!a.layer->region_nodes.empty() || !b.layer->region_nodes.empty()) return false;
  const std::set<EdgeKey> edges = edges_of(a.layer->articular);  // of layers without elements nothing is known beyond
  for (int t = 0; t < b.layer->articular.size(); ++t)
    for (int k = 0; k < 3; ++k)
      if (edges.count(edge_key(b.layer->articular, t, k)) > 0) return true;
  return false;
}

/// "surface \"a\"", or "surfaces \"a\", \"b\"".
std::string surfaces_of(const std::string& first, const std::string& second) {
  return first == second ? "surface " + in_quotes(first)
                         : fmt::format("surfaces {}, {}", in_quotes(first), in_quotes(second));
}

/// Refuses what is said of one layer in two ways; false: the elements themselves are of two materials there. Springs
/// that know nothing of each other may differ from contact to contact, but not where they stand on the same facets.
bool agree(const ModelParts& parts, const std::vector<ContactPair>& contacts, const Side& a, const Side& b) {
  const JointModel& model = parts.model;
  const ContactPair &one = contacts[at(a.contact)], &two = contacts[at(b.contact)];
  const std::string &first = model.surfaces[at(a.layer->surface)].name,
                    &second = model.surfaces[at(b.layer->surface)].name;
  const auto refuse = [&](const Sentence& what, const char* setting, bool of_surface = true) {
    const NamedSetting of_first = {setting, of_surface ? first : "", "VALUE"};
    throw fault_at(model, two.origin,
                   say("contacts {} and {} press one layer ({}), and {};", in_quotes(one.name), in_quotes(two.name),
                       surfaces_of(first, second), what),
                   !of_surface || first == second
                       ? say("give one for both with {}", of_first)
                       : say("give both the same with {} and {}", of_first, NamedSetting{setting, second, "VALUE"}));
  };
  const auto differ = [&](const char* what, const char* setting, double x, double y) {
    refuse(say("its {} is {:.4g} for the one and {:.4g} for the other", what, x, y), setting);
  };
  const bool coupled = one.law == Law::Layer || two.law == Law::Layer, same_facets = meet(a.selected, b.selected);
  if (!coupled && !same_facets) return true;
  if (coupled && one.law != two.law)
    refuse(say("the law is {} for the one and {} for the other", name(one.law), name(two.law)), "law", false);
  const auto said = [&](const Side& side) {
    const GivenLayer given =
        given_layer(model, parts.settings, model.contacts[at(contacts[at(side.contact)].contact)], side.side);
    return given.E || given.nu;
  };
  const Elasticity &E_a = a.layer->elasticity, &E_b = b.layer->elasticity;
  if (E_a.E != E_b.E || E_a.nu != E_b.nu) {
    if (!said(a) && !said(b) && !same_facets) return false;
    if (E_a.E != E_b.E) differ("E", "E", E_a.E, E_b.E);
    differ("nu", "nu", E_a.nu, E_b.nu);
  }
  if (coupled && one.refine != two.refine)
    refuse(say("triangles are divided by {} for the one and by {} for the other", one.refine, two.refine), "refine",
           false);
  const Layer &la = *a.layer, &lb = *b.layer;
  if (la.thickness_scale != lb.thickness_scale)
    differ("thickness-scale", "thickness-scale", la.thickness_scale, lb.thickness_scale);
  if (la.thickness_given != lb.thickness_given)
    refuse(say("its thickness is given for {} and measured for {}", in_quotes(la.thickness_given ? first : second),
               in_quotes(la.thickness_given ? second : first)),
           "thickness");
  if (!la.thickness_given) return true;
  constexpr double kAlike = 0.05;
  const auto [least_a, most_a] = std::minmax_element(la.thickness.begin(), la.thickness.end());
  const auto [least_b, most_b] = std::minmax_element(lb.thickness.begin(), lb.thickness.end());
  if (*least_a == *most_a && *least_b == *most_b && *least_a != *least_b)
    differ("thickness", "thickness", *least_a, *least_b);
  std::map<int, double> of_node;
  const SurfaceMesh &mesh_a = la.spring_surface(), &mesh_b = lb.spring_surface();
  for (std::size_t v = 0; v < mesh_a.model_nodes.size(); ++v) of_node[mesh_a.model_nodes[v]] = la.thickness[v];
  for (std::size_t v = 0; v < mesh_b.model_nodes.size(); ++v) {
    const auto other = of_node.find(mesh_b.model_nodes[v]);
    const double t = lb.thickness[v];
    if (other != of_node.end() && std::abs(t - other->second) > kAlike * std::max(t, other->second))
      differ("thickness", "thickness", other->second, t);
  }
  return true;
}

/// What is beyond an edge of the faces together: a mirror image rather than nothing, anything rather than more of the
/// layer, beyond which another side's face goes on.
int precedence(const LayerFace::Edge& e) { return e.rim == Rim::Wall ? 2 : e.rim == Rim::Free ? 1 : 0; }

/// Thickness at a node, by the side that has most facets around it; of equals the thicker.
struct BestThickness {
  double area = -1.0, thickness = 0.0;
  void offer(double a, double t) {
    if (std::tie(a, t) > std::tie(area, thickness)) *this = {a, t};
  }
};

/// The faces of all sides as one, its first triangles those that are pressed.
LayerFace merged_face(const JointModel& model, const std::vector<const Layer*>& layers, const Keys& pressed) {
  Keys beyond;
  std::map<EdgeKey, LayerFace::Edge> rim;
  std::map<int, BestThickness> thickness;
  std::vector<unsigned char> planes;
  for (const Layer* layer : layers) {
    const SurfaceMesh& mesh = layer->face.mesh;
    add_keys(beyond, mesh);
    for (const LayerFace::Edge& e : layer->face.edges) {
      const auto [known, is_new] = rim.emplace(edge_key(mesh, e.triangle, e.edge), e);
      if (!is_new && precedence(e) > precedence(known->second)) known->second = e;
    }
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      const bool selected = v < layer->articular.vertices.size();
      thickness[mesh.model_nodes[v]].offer(selected ? layer->articular.vertex_areas[v] : 0.0, layer->face.thickness[v]);
    }
    if (mesh.planes.empty()) continue;
    planes.resize(model.nodes.size(), 0);
    for (std::size_t v = 0; v < mesh.planes.size(); ++v) planes[at(mesh.model_nodes[v])] |= mesh.planes[v];
  }
  beyond.erase(std::remove_if(beyond.begin(), beyond.end(), [&](const TriangleKey& k) { return has(pressed, k); }),
               beyond.end());
  std::vector<int> begin = {0}, nodes;
  for (const Keys* keys : {&pressed, static_cast<const Keys*>(&beyond)})
    for (const TriangleKey& key : *keys) {
      nodes.insert(nodes.end(), key.begin(), key.end());
      begin.push_back(static_cast<int>(nodes.size()));
    }
  LayerFace face;
  face.mesh = make_surface_mesh(begin, nodes, model.nodes, nullptr, planes);
  face.pressed = static_cast<int>(pressed.size());
  for (const int node : face.mesh.model_nodes) face.thickness.push_back(thickness.at(node).thickness);
  for (int t = 0; t < face.mesh.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      if (face.mesh.neighbours[at(t)][at(k)] >= 0) continue;
      const auto known = rim.find(edge_key(face.mesh, t, k));
      LayerFace::Edge edge = known == rim.end() ? LayerFace::Edge{} : known->second;
      edge.triangle = t;
      edge.edge = k;
      face.edges.push_back(edge);
    }
  return face;
}

/// Marks in a side's own face what others press: triangles, and edges beyond which the layer goes on.
void mark_others(const SharedLayer& shared, const Keys& pressed, Layer& layer) {
  LayerFace& face = layer.face;
  face.pressed_by_others.assign(at(face.mesh.size()), 0);
  for (int t = face.pressed; t < face.mesh.size(); ++t)
    face.pressed_by_others[at(t)] = has(pressed, keyed(face.mesh, t).key);
  std::set<EdgeKey> rim;
  for (const LayerFace::Edge& e : shared.face.edges) rim.insert(edge_key(shared.face.mesh, e.triangle, e.edge));
  for (LayerFace::Edge& e : face.edges) {
    if (rim.count(edge_key(face.mesh, e.triangle, e.edge)) > 0) continue;
    e.rim = Rim::Continues;
    e.shared = true;
  }
}

SharedLayer share(const JointModel& model, std::vector<ContactPair>& contacts, const std::vector<const Side*>& sides) {
  SharedLayer shared;
  Keys pressed;
  for (const Side* side : sides) add_keys(pressed, side->layer->spring_surface());
  shared.pressed = static_cast<int>(pressed.size());
  shared.area.assign(pressed.size(), 0.0);
  std::vector<const Layer*> layers;
  std::set<std::string> names;
  for (const Side* side : sides) {
    names.insert(model.surfaces[at(side->layer->surface)].name);
    LayerUse use{side->contact, side->side, {}, {}};
    const SurfaceMesh& mesh = side->layer->spring_surface();
    for (int t = 0; t < mesh.size(); ++t) {
      const KeyedTriangle triangle = keyed(mesh, t);
      use.triangle.push_back(number_of(pressed, triangle.key));
      use.turn.push_back(triangle.turn);
      shared.area[at(use.triangle.back())] = mesh.areas[at(t)];
    }
    shared.uses.push_back(std::move(use));
    layers.push_back(side->layer);
  }
  for (const std::string& name : names) shared.name += (shared.name.empty() ? "" : " + ") + name;
  if (layers.front()->springs_at == SpringsAt::Bone) return shared;
  shared.face = merged_face(model, layers, pressed);
  for (const Side* side : sides) mark_others(shared, pressed, contacts[at(side->contact)].layers[side->side]);
  return shared;
}

Finding told(const JointModel& model, const std::vector<ContactPair>& contacts, const SharedLayer& shared) {
  std::set<std::string> names, surfaces;
  for (const LayerUse& use : shared.uses) {
    names.insert(contacts[at(use.contact)].name);
    surfaces.insert(model.surfaces[at(contacts[at(use.contact)].layers[use.side].surface)].name);
  }
  return {"shared-layer",
          {.surface = *surfaces.begin()},
          {{"contacts", std::vector<std::string>(names.begin(), names.end())},
           {"surfaces", std::vector<std::string>(surfaces.begin(), surfaces.end())}},
          surfaces.size() > 1 ? 1 : 0};
}

}  // namespace

std::vector<SharedLayer> find_shared_layers(const ModelParts& parts, std::vector<ContactPair>& contacts,
                                            Findings& findings) {
  const JointModel& model = parts.model;
  std::vector<Side> sides;
  for (std::size_t c = 0; c < contacts.size(); ++c)
    for (int side = 0; side < 2; ++side)
      if (!contacts[c].layers[side].rigid)
        sides.push_back({static_cast<int>(c), side, &contacts[c].layers[side], {}, {}});
  DisjointSets sets(sides.size());
  for (std::size_t a = 0; a < sides.size(); ++a)
    for (std::size_t b = a + 1; b < sides.size(); ++b) {
      const ContactPair &one = contacts[at(sides[a].contact)], &two = contacts[at(sides[b].contact)];
      if (sides[a].contact == sides[b].contact || sides[a].layer->body != sides[b].layer->body ||
          !at_same_time(one.step, two.step) || !share_nodes(nodes_of(*sides[a].layer), nodes_of(*sides[b].layer)))
        continue;
      for (Side* side : {&sides[a], &sides[b]})
        if (side->selected.empty()) {
          side->selected = keys_of(side->layer->articular);
          side->face = keys_of(side->layer->face.mesh);
        }
      if (!run_into_each_other(sides[a], sides[b])) continue;
      if (agree(parts, contacts, sides[a], sides[b])) {
        sets.join(static_cast<int>(a), static_cast<int>(b));
      } else if (one.law == Law::Layer || two.law == Law::Layer) {
        findings.push_back(
            {"contacts-side-by-side",
             {.contact = two.name, .surface = model.surfaces[at(sides[b].layer->surface)].name},
             {{"other", one.name}, {"other_surface", model.surfaces[at(sides[a].layer->surface)].name}}});
      }
    }
  std::map<int, std::vector<const Side*>> members;
  for (int i = 0; i < static_cast<int>(sides.size()); ++i) members[sets.root(i)].push_back(&sides[at(i)]);
  std::vector<SharedLayer> shared;
  for (const auto& [root, of] : members) {
    if (of.size() < 2) continue;
    shared.push_back(share(model, contacts, of));
    if (contacts[at(of.front()->contact)].law == Law::Layer) findings.push_back(told(model, contacts, shared.back()));
  }
  return shared;
}

}  // namespace dea

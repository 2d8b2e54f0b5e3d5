// Nodes, elements, sets, shell thickness and axes of elements: Geometry (up to 2.5), Mesh, MeshDomains and MeshData
// (3.0, 4.0).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <limits>
#include <set>
#include <utility>

#include "io/feb/feb_reading.h"
#include "src/base/error.h"
#include "src/base/parse.h"
#include "src/model/element_faces.h"

namespace dea::feb {
namespace {

/// Is the word this name, or this name with FEBio's integration rule: "HEX20G8", "TET10G4_S3", "hex8ri"?
bool is_element_name(const std::string& word, std::string_view name) {
  if (word.compare(0, name.size(), name) != 0) return false;
  const std::string_view rule = std::string_view(word).substr(name.size());
  return rule.empty() || rule.front() == 'g' || rule == "ri";
}

/// "hex8", or with FEBio's integration rule; FEBio has further names for some shapes.
std::optional<ElementShape> shape_of(const std::string& type) {
  constexpr std::pair<const char*, ElementShape> kOtherNames[] = {
      {"truss2", ElementShape::Line2}, {"ut4", ElementShape::Tet4},  {"q4eas", ElementShape::Quad4},
      {"q4ans", ElementShape::Quad4},  {"q4s", ElementShape::Quad4}, {"tri3s", ElementShape::Tri3}};
  const std::string word = lower_case(type);
  for (const ElementType& row : element_types())
    if (is_element_name(word, row.name)) return row.shape;
  for (const auto& other : kOtherNames)
    if (is_element_name(word, other.first)) return other.second;
  return std::nullopt;
}

}  // namespace

ElementShape need_shape(const Reading& reading, const XMLElement& element, const std::string& type) {
  const auto shape = shape_of(type);
  if (!shape)
    fail(reading, element,
         fmt::format("element type {} is unknown, expected one like hex8, tet4, tet10, penta6, quad4, tri3",
                     quote(type)));
  return *shape;
}

namespace {

/// Nodes of a facet that is called like a shell, or is one of those that are no shells; 0: there is none of this name.
int facet_nodes(std::string_view tag) {
  for (const ElementType& row : element_types())
    if (row.kind == ElementKind::Shell && tag == row.name) return row.nodes;
  return tag == "tri7" ? 7 : tag == "tri10" ? 10 : 0;
}

}  // namespace

int read_id(const Reading& reading, const XMLElement& element, const char* name) {
  const char* text = element.Attribute(name);
  const auto id = text == nullptr ? std::nullopt : whole_int(text);
  if (!id || *id < 1) {
    fail(reading, element,
         fmt::format("<{}> with {} = {}, expected a positive whole number", element.Name(), name,
                     quote(text == nullptr ? "" : text)));
  }
  return *id;
}

namespace {

/// A number list of the wrong form: what is wrong with it.
[[noreturn]] void fail_list(const Reading& reading, const XMLElement& element, std::string_view rest) {
  rest = trim(rest);
  const bool number = !rest.empty() && (rest.front() == '-' || (rest.front() >= '0' && rest.front() <= '9'));
  fail(reading, element,
       fmt::format("<{}> lists {}, expected whole numbers and commas{}", element.Name(), quote(rest),
                   number ? ": a comma is missing before it, or it is no whole number" : ""));
}

/// Appends the nodes of an element, facet or edge. count 0: any number.
void append_nodes(const Reading& reading, const XMLElement& element, int count, const std::string& what,
                  std::vector<int>& nodes) {
  std::string store;
  std::string_view rest = text_of(element, store);
  int found = 0;
  while (true) {
    int id = 0;
    if (take_int(rest, id) != Number::Ok) {
      if (trim(rest).empty()) break;  // also after a trailing comma
      fail_list(reading, element, rest);
    }
    const int node = find_node(reading, id);
    if (node < 0)
      fail(reading, element,
           fmt::format("{} uses node {}, which does not exist: mend the number, or add the node", what, id));
    ++found;
    if (count == 0 || found <= count) nodes.push_back(node);
    if (!take_comma(rest)) {
      if (!trim(rest).empty()) fail_list(reading, element, rest);
      break;
    }
  }
  if (found == 0 || (count > 0 && found != count)) {
    fail(reading, element, fmt::format("{} has {} nodes, expected {}", what, found, count > 0 ? count : 1));
  }
}

/// Ranges and nested sets can name far more nodes than the file is long: not more than the memory holds.
void count_entries(Reading& reading, const XMLElement& element, std::size_t more) {
  constexpr std::size_t kMost = 100'000'000;
  reading.set_entries += more;
  if (reading.set_entries > kMost)
    fail(reading, element,
         fmt::format("the sets list more than {} nodes or elements: is one listed again and again?", kMost));
}

/// 1,2,5:9,10:20:2 – `add` gets every id.
template <class Add>
void read_ranges(const Reading& reading, const XMLElement& element, Add add) {
  std::string store;
  std::string_view rest = text_of(element, store);
  while (!trim(rest).empty()) {
    int range[3] = {0, 0, 1};
    int parts = 0;
    for (; parts < 3; ++parts) {
      if (take_int(rest, range[parts]) != Number::Ok) fail_list(reading, element, rest);
      rest = trim(rest);
      if (parts == 2 || rest.empty() || rest.front() != ':') break;
      rest.remove_prefix(1);
    }
    if (parts == 0) {
      add(range[0]);
    } else {
      if (range[2] < 1 || range[0] > range[1]) {
        fail(reading, element,
             fmt::format("range {}:{}:{}, expected first:last:step going up", range[0], range[1], range[2]));
      }
      for (long long id = range[0]; id <= range[1]; id += range[2]) add(static_cast<int>(id));
    }
    if (!take_comma(rest) && !trim(rest).empty()) fail_list(reading, element, rest);
  }
}

// -- nodes and elements ------------------------------------------------------------------------------

/// An id of the model for a node or element of an instance: the part's own unless it is taken.
int free_id(const Reading& reading, const XMLElement& element, const IdTable& ids, int id) {
  if (ids.find(id) < 0) return id;
  if (ids.largest() == std::numeric_limits<int>::max()) fail(reading, element, "no number is left: renumber the part");
  return ids.largest() + 1;
}

}  // namespace

void read_nodes(Reading& reading, const XMLElement& section) {
  JointModel& model = reading.model;
  const int begin = reading.nodes.size();
  Instance* instance = reading.instance;
  for (const XMLElement& child : children(section)) {
    if (std::strcmp(child.Name(), "node") != 0) {
      ignore(reading, child, fmt::format("<{}> in Nodes", child.Name()));
      continue;
    }
    const int id = read_id(reading, child);
    const bool is_new = instance == nullptr
                            ? reading.nodes.add(id)
                            : instance->nodes.add(id) && reading.nodes.add(free_id(reading, child, reading.nodes, id));
    if (!is_new) fail(reading, child, fmt::format("node {} exists twice: renumber one", id));
    std::string store;
    std::string_view rest = text_of(child, store);
    Vector3d x;
    for (int i = 0; i < 3; ++i) {
      const Number found = (i == 0 || take_comma(rest)) ? take_double(rest, x[i]) : Number::None;
      if (found == Number::Ok) continue;
      const char* expected = found == Number::None ? "three numbers x,y,z" : "numbers of at most 1e30";
      fail(reading, child, fmt::format("node {} is {}, expected {}", id, quote(trim(text_of(child))), expected));
    }
    if (!trim(rest).empty()) {
      fail(reading, child, fmt::format("node {} is {}, expected three numbers x,y,z", id, quote(trim(text_of(child)))));
    }
    if (instance != nullptr) x = instance->turn * instance->scale.cwiseProduct(x) + instance->translation;
    model.nodes.push_back(x);
  }
  const std::string name = attribute(section, section.Attribute("name") != nullptr ? "name" : "set");
  if (!name.empty()) reading.node_ranges.push_back({full_name(reading, name), begin, reading.nodes.size()});
}

namespace {

/// Gives a domain its material: by name, or by id where the format allows it.
void assign_material(Reading& reading, const XMLElement& element, int domain, const std::string& mat, bool by_id) {
  int material = febio::find_material(reading, origin_of(reading, element), mat);
  if (material < 0 && by_id) material = febio::material_of_id(reading, mat);
  if (material < 0) {
    fail(reading, element,
         fmt::format("<{}> with mat = {}, expected the {} of a material{}", element.Name(), quote(mat),
                     by_id ? "name or id" : "name", those_there(mat, reading.material_index)));
  }
  reading.model.domains[at(domain)].material = material;
}

}  // namespace

void append_element(const Reading& reading, const XMLElement& element, const std::string& type, int id,
                    Domain& domain) {
  const int count = nodes_per_element(domain.shape);
  const std::size_t before = domain.nodes.size();
  std::string store;
  std::string_view rest = text_of(element, store);
  for (int i = 0; i < count; ++i) {  // the usual case without a message to build
    int node_id = 0;
    if ((i > 0 && !take_comma(rest)) || take_int(rest, node_id) != Number::Ok) break;
    const int node = find_node(reading, node_id);
    if (node < 0) break;
    domain.nodes.push_back(node);
  }
  if (domain.nodes.size() != before + at(count) || !trim(rest).empty()) {
    domain.nodes.resize(before);
    append_nodes(reading, element, count, fmt::format("{} element {}", type, id), domain.nodes);
  }
  domain.element_ids.push_back(id);
}

void read_elements(Reading& reading, const XMLElement& section) {
  JointModel& model = reading.model;
  const std::string type = need_attribute(reading, section, "type");
  const int domain_number = static_cast<int>(model.domains.size());
  Domain domain;
  const std::string own_name = attribute(section, section.Attribute("name") != nullptr ? "name" : "elset");
  domain.name = full_name(reading, own_name);
  domain.shape = need_shape(reading, section, type);
  domain.origin = origin_of(reading, section);
  reading.first_element.push_back(reading.elements.size());
  for (const XMLElement& child : children(section)) {
    if (std::strcmp(child.Name(), "elem") != 0 && std::strcmp(child.Name(), "e") != 0) {
      ignore(reading, child, fmt::format("<{}> in Elements", child.Name()));
      continue;
    }
    int id = read_id(reading, child);
    if (reading.instance != nullptr) id = free_id(reading, child, reading.elements, id);
    if (!reading.elements.add(id)) fail(reading, child, fmt::format("element {} exists twice: renumber one", id));
    append_element(reading, child, type, id, domain);
  }
  if (!domain.name.empty()) {
    auto& same_name = reading.domain_index[domain.name];
    if (!same_name.empty() && !reading.rules->up_to_25) {
      fail(reading, section, fmt::format("Elements {} exists twice: rename one", quote(domain.name)));
    }
    same_name.push_back(domain_number);
  }
  domain.element_ids.shrink_to_fit();
  domain.nodes.shrink_to_fit();
  model.domains.push_back(std::move(domain));
  std::string mat = attribute(section, "mat");
  if (reading.instance != nullptr) {
    const auto other = reading.instance->materials.find(own_name);
    if (other != reading.instance->materials.end()) mat = other->second;
    if (mat.empty()) {
      fail(reading, section,
           fmt::format("Elements {} of an instance without a material: add <Elements name= mat=/> to its <Instance>",
                       quote(own_name)));
    }
  }
  if (!mat.empty() || section.Attribute("mat") != nullptr) {
    assign_material(reading, section, domain_number, mat, true);
  }
}

namespace {

// -- sets --------------------------------------------------------------------------------------------

void append_node_id(Reading& reading, const XMLElement& element, int id, std::vector<int>& nodes) {
  nodes.push_back(need_node(reading, element, id));
  count_entries(reading, element, 1);
}

}  // namespace

void read_node_set(Reading& reading, const XMLElement& section) {
  NodeSet set = {full_name(reading, need_attribute(reading, section, "name")), {}, origin_of(reading, section)};
  if (is_leaf(section)) {
    read_ranges(reading, section, [&](int id) { append_node_id(reading, section, id, set.nodes); });
  }
  for (const XMLElement& child : children(section)) {
    const std::string_view tag = child.Name();
    if (tag == "n" || tag == "node") {
      append_node_id(reading, child, read_id(reading, child), set.nodes);
    } else if (tag == "node_list") {
      read_ranges(reading, child, [&](int id) { append_node_id(reading, child, id, set.nodes); });
    } else if (tag == "NodeSet") {
      const std::string other = attribute(child, child.Attribute("node_set") != nullptr ? "node_set" : "set");
      const std::vector<int> nodes = need_node_set(reading, child, other);
      set.nodes.insert(set.nodes.end(), nodes.begin(), nodes.end());
    } else {
      ignore(reading, child, fmt::format("<{}> in NodeSet", tag));
    }
  }
  // FEBio Studio wrote some sets of 2.5 twice. The same nodes: no harm. Others: a fault where the name is used.
  auto& sets = reading.model.node_sets;
  const auto [place, is_new] = reading.node_set_index.try_emplace(set.name, static_cast<int>(sets.size()));
  if (is_new) {
    sets.push_back(std::move(set));
  } else if (sets[at(place->second)].nodes != set.nodes) {
    reading.ambiguous_node_sets.insert(set.name);
  }
}

namespace {

void read_element_set(Reading& reading, const XMLElement& section) {
  ElementSet set = {need_attribute(reading, section, "name"), {}, origin_of(reading, section)};
  const auto add = [&](const XMLElement& element, int id) {
    if (reading.elements.find(id) < 0) {
      fail(reading, element,
           fmt::format("element set {} has element {}, which does not exist: take it out", quote(set.name), id));
    }
    set.element_ids.push_back(id);
    count_entries(reading, element, 1);
  };
  if (is_leaf(section)) read_ranges(reading, section, [&](int id) { add(section, id); });
  for (const XMLElement& child : children(section)) {
    add(child, read_id(reading, child));
  }
  add_named(reading, section, reading.element_set_index, set.name, static_cast<int>(reading.model.element_sets.size()),
            "element set");
  reading.model.element_sets.push_back(std::move(set));
}

void check_facet(const Reading& reading, const XMLElement& element, const Surface& surface, int count,
                 const std::string& what) {
  for (auto a = surface.nodes.end() - count; a != surface.nodes.end(); ++a) {
    if (std::find(a + 1, surface.nodes.end(), *a) != surface.nodes.end()) {
      std::string text = text_of(element);
      fail(reading, element, fmt::format("{} has a node twice ({}): repair the mesh", what, quote(trim(text))));
    }
  }
}

/// "element,face": the nodes of a face of an element, both counted from 1.
void append_face(const Reading& reading, const XMLElement& element, int count, const std::string& what,
                 std::vector<int>& nodes) {
  std::string store;
  std::string_view rest = text_of(element, store);
  int id = 0, face = 0;
  if (take_int(rest, id) != Number::Ok || !take_comma(rest) || take_int(rest, face) != Number::Ok ||
      !trim(rest).empty()) {
    fail(reading, element,
         fmt::format("{} is {}, expected the number of an element and of its face", what,
                     quote(trim(text_of(element)))));
  }
  const auto place = find_element(reading, id);
  if (!place)
    fail(reading, element,
         fmt::format("{} is on element {}, which does not exist: mend the number, or add the node", what, id));
  const Domain& domain = reading.model.domains[at(place->domain)];
  const auto& faces = element_faces(domain.shape);
  if (face < 1 || face > static_cast<int>(faces.size()) || static_cast<int>(faces[at(face) - 1].size()) != count) {
    fail(reading, element,
         fmt::format("{}: element {} has no such face {}, expected 1 to {}", what, id, face, faces.size()));
  }
  const std::size_t first = at(place->index) * at(nodes_per_element(domain.shape));
  for (const int local : faces[at(face) - 1]) {
    nodes.push_back(domain.nodes[first + at(local)]);
  }
}

/// <Surface surface="name"/> in a surface: its facets too.
void append_surface(Reading& reading, const XMLElement& element, Surface& surface) {
  const std::string name = need_attribute(reading, element, "surface");
  const int other = need_entry(reading, element, fmt::format("surface {} names", quote(surface.name)), name,
                               "Surface above it", reading.surface_index);
  const Surface& added = reading.model.surfaces[at(other)];
  count_entries(reading, element, added.nodes.size());
  const int before = surface.begin.back();
  for (int i = 0; i < added.size(); ++i) surface.begin.push_back(before + added.begin[at(i) + 1]);
  surface.nodes.insert(surface.nodes.end(), added.nodes.begin(), added.nodes.end());
}

}  // namespace

void read_named_surface(Reading& reading, const XMLElement& section) {
  read_surface(reading, section, full_name(reading, need_attribute(reading, section, "name")));
}

int read_surface(Reading& reading, const XMLElement& section, const std::string& name, bool element_faces) {
  Surface surface = {{}, name, origin_of(reading, section)};
  for (const XMLElement& child : children(section)) {
    if (std::strcmp(child.Name(), "Surface") == 0) {
      append_surface(reading, child, surface);
      continue;
    }
    const int count = facet_nodes(child.Name());
    if (count == 0) {
      fail(reading, child,
           fmt::format("<{}> in surface {}, expected tri3, tri6, quad4, quad8 or another facet", child.Name(),
                       quote(surface.name)));
    }
    const std::string what =
        fmt::format("{} facet {} of surface {}", child.Name(), surface.size() + 1, quote(surface.name));
    if (element_faces)
      append_face(reading, child, count, what, surface.nodes);
    else
      append_nodes(reading, child, count, what, surface.nodes);
    check_facet(reading, child, surface, count, what);
    surface.begin.push_back(static_cast<int>(surface.nodes.size()));
  }
  const int place = static_cast<int>(reading.model.surfaces.size());
  add_named(reading, section, reading.surface_index, surface.name, place, "surface");
  reading.model.surfaces.push_back(std::move(surface));
  return place;
}

namespace {

void read_edge(Reading& reading, const XMLElement& section) {
  const std::string name = need_attribute(reading, section, "name");
  std::vector<int> nodes;
  for (const XMLElement& child : children(section)) {
    append_nodes(reading, child, 0, fmt::format("edge {}", quote(name)), nodes);
  }
  add_named(reading, section, reading.edges, name, std::move(nodes), "edge");
}

void read_discrete_set(Reading& reading, const XMLElement& section) {
  DiscreteSet set = {need_attribute(reading, section, "name"), {}, origin_of(reading, section)};
  for (const XMLElement& child : children(section)) {
    set.pairs.push_back(read_node_pair(
        reading, child, fmt::format("spring {} of discrete set {}", set.pairs.size() + 1, quote(set.name))));
  }
  add_named(reading, section, reading.discrete_set_index, set.name,
            static_cast<int>(reading.model.discrete_sets.size()), "discrete set");
  reading.model.discrete_sets.push_back(std::move(set));
}

void read_part_list(Reading& reading, const XMLElement& section) {
  const std::string name = need_attribute(reading, section, "name");
  std::vector<std::string> parts = split_words(text_of(section));
  for (std::string& part : parts) {
    if (reading.domain_index.find(part) == reading.domain_index.end()) part = trim(part);
    if (reading.domain_index.find(part) == reading.domain_index.end()) {
      fail(reading, section,
           fmt::format("part list {} names {}, expected the name of an Elements section", quote(name), quote(part)));
    }
  }
  add_named(reading, section, reading.part_lists, name, std::move(parts), "part list");
}

/// The surface "@part_list:NAME": faces of the parts' elements that no second element of them has, and their shells.
int part_list_surface(Reading& reading, const XMLElement& element, const std::string& name) {
  const auto list = reading.part_lists.find(name.substr(name.find(':') + 1));
  if (list == reading.part_lists.end()) {
    fail(reading, element, fmt::format("{} names no part list, expected the name of a PartList above it", quote(name)));
  }
  std::map<std::vector<int>, int> uses;  // by sorted corners
  Surface surface = {{}, name, origin_of(reading, element)};
  for (const bool counting : {true, false}) {
    for (const std::string& part : list->second) {
      for (const int index : reading.domain_index.find(part)->second) {
        const Domain& domain = reading.model.domains[at(index)];
        const std::size_t count = at(nodes_per_element(domain.shape));
        for (std::size_t first = 0; first < domain.nodes.size(); first += count) {
          for (const std::vector<int>& face : element_faces(domain.shape)) {
            std::vector<int> nodes, key;
            for (const int local : face) nodes.push_back(domain.nodes[first + at(local)]);
            key.assign(nodes.begin(), nodes.begin() + facet_corners(static_cast<int>(nodes.size())));
            std::sort(key.begin(), key.end());
            key.erase(std::unique(key.begin(), key.end()), key.end());
            if (key.size() < 3) continue;  // the side of a degenerate element that is no area
            if (counting) {
              ++uses[key];
            } else if (uses[key] == 1) {
              surface.nodes.insert(surface.nodes.end(), nodes.begin(), nodes.end());
              surface.begin.push_back(static_cast<int>(surface.nodes.size()));
            }
          }
        }
      }
    }
  }
  const int place = static_cast<int>(reading.model.surfaces.size());
  reading.surface_index.emplace(name, place);
  reading.model.surfaces.push_back(std::move(surface));
  return place;
}

/// `new_tag` or `old_tag`, the surface as text (3.0, 4.0) or attribute (2.5).
int pair_surface(Reading& reading, const XMLElement& section, const char* new_tag, const char* old_tag) {
  const XMLElement* child = section.FirstChildElement(new_tag);
  if (child == nullptr) child = section.FirstChildElement(old_tag);
  if (child == nullptr) {
    fail(reading, section,
         fmt::format("surface pair {} without <{}>: add it, with the name of a surface",
                     quote(attribute(section, "name")), new_tag));
  }
  std::string name = attribute(*child, "surface");
  if (name.empty()) name = text_of(*child);
  const int trimmed = find_name(reading.surface_index, std::string(trim(name)));
  if (trimmed >= 0 && find_name(reading.surface_index, name) < 0) return trimmed;
  if (name.rfind("@part_list:", 0) == 0 && find_name(reading.surface_index, name) < 0)
    return part_list_surface(reading, *child, name);
  return need_entry(reading, *child, fmt::format("surface pair {} names", quote(attribute(section, "name"))), name,
                    "Surface above it", reading.surface_index);
}

void read_surface_pair(Reading& reading, const XMLElement& section) {
  const std::string name = need_attribute(reading, section, "name");
  SurfacePair pair;
  pair.primary = pair_surface(reading, section, "primary", "slave");
  pair.secondary = pair_surface(reading, section, "secondary", "master");
  add_named(reading, section, reading.surface_pairs, name, pair, "surface pair");
}

// -- data of elements: shell thickness, fibres, axes -------------------------------------------------

/// Places of the elements of a set, in its order; domains come in file order.
std::vector<ElementPlace> places_of_set(const Reading& reading, const XMLElement& element, const std::string& name) {
  std::vector<ElementPlace> places;
  const JointModel& model = reading.model;
  const int set = find_name(reading.element_set_index, name);
  if (set >= 0) {
    for (const int id : model.element_sets[at(set)].element_ids) {
      places.push_back(*find_element(reading, id));
    }
    return places;
  }
  const auto domains = reading.domain_index.find(name);
  if (domains == reading.domain_index.end()) {
    auto there = reading.element_set_index;
    for (const auto& entry : reading.domain_index) there.emplace(entry.first, 0);
    fail(reading, element,
         fmt::format("elem_set = {}, expected the name of an ElementSet or Elements section{}", quote(name),
                     those_there(name, there)));
  }
  for (const int domain : domains->second) {
    const std::size_t count = model.domains[at(domain)].element_ids.size();
    for (std::size_t i = 0; i < count; ++i) places.push_back({domain, static_cast<int>(i)});
  }
  return places;
}

/// Thickness at each node of a shell.
void set_thickness(Reading& reading, const XMLElement& element, const ElementPlace& place) {
  Domain& domain = reading.model.domains[at(place.domain)];
  const std::size_t count = at(nodes_per_element(domain.shape));
  domain.shell_thickness.resize(domain.nodes.size(), 0.0);
  std::string store;
  std::string_view rest = text_of(element, store);
  for (std::size_t i = 0; i < count; ++i) {
    double value = 0.0;
    if ((i > 0 && !take_comma(rest)) || take_double(rest, value) != Number::Ok || value < 0) {
      fail(reading, element,
           fmt::format("shell thickness {}, expected {} numbers >= 0, one per node", quote(trim(text_of(element))),
                       count));
    }
    domain.shell_thickness[at(place.index) * count + i] = value;
  }
}

/// The direction of an element's fibres. `path`: which, as Fibres::path.
void set_fibre(Reading& reading, const XMLElement& element, const ElementPlace& place, const std::string& path = "") {
  Domain& domain = reading.model.domains[at(place.domain)];
  std::vector<Vector3d>& fibre = domain.fibre[path];
  fibre.resize(domain.element_ids.size(), Vector3d::Zero());
  fibre[at(place.index)] = read_vector(reading, element).normalized();
}

/// "solid[1]" of "solid[1].fiber", "" of "fiber"; FEBio counts from 0, the first has no number.
std::string fibre_path(const std::string& variable) {
  std::string path = variable.substr(0, variable.size() - std::min(variable.size(), std::strlen(".fiber")));
  for (std::size_t first; (first = path.find("[0]")) != path.npos;) path.erase(first, 3);
  return path;
}

/// The direction of an element's fibres that say that this map has it.
void set_mapped_fibre(Reading& reading, const XMLElement& element, const ElementPlace& place, const std::string& map) {
  const int material = reading.model.domains[at(place.domain)].material;
  if (material < 0) return;
  for (const Fibres& fibres : reading.model.materials[at(material)].fibres)
    if (fibres.direction.map == map) set_fibre(reading, element, place, fibres.path);
}

/// Its material axes, <a> and <d>.
void set_axes(Reading& reading, const XMLElement& element, const ElementPlace& place) {
  const XMLElement *a = element.FirstChildElement("a"), *d = element.FirstChildElement("d");
  const auto axes = a != nullptr && d != nullptr ? axes_from(read_vector(reading, *a), read_vector(reading, *d))
                                                 : std::optional<Eigen::Matrix3d>();
  if (!axes)
    fail(reading, element,
         "material axes, expected <a> and <d>, two vectors that do not lie along each other: mend them");
  Domain& domain = reading.model.domains[at(place.domain)];
  domain.axes.resize(domain.element_ids.size(), Eigen::Matrix3d::Zero());
  domain.axes[at(place.index)] = *axes;
}

using SetOfElement = std::function<void(Reading&, const XMLElement&, const ElementPlace&)>;

/// Calls `set` for each <e lid="k"> of a section of MeshData, or for all elements where the section is a value itself.
void read_by_element(Reading& reading, const XMLElement& section, const SetOfElement& set) {
  const std::vector<ElementPlace> places =
      places_of_set(reading, section, need_attribute(reading, section, "elem_set"));
  if (is_leaf(section)) {
    for (const ElementPlace& place : places) set(reading, section, place);
  }
  for (const XMLElement& child : children(section)) {
    const int lid = read_id(reading, child, "lid");
    if (lid > static_cast<int>(places.size())) {
      fail(reading, child,
           fmt::format("lid = {}, but the element set has {} elements: mend the number", lid, places.size()));
    }
    set(reading, child, places[at(lid) - 1]);
  }
}

/// Data of the elements at these places.
void read_data(Reading& reading, const XMLElement& element, const std::vector<ElementPlace>& places) {
  for (const XMLElement& child : children(element)) {
    const std::string_view tag = child.Name();
    for (const ElementPlace& place : places) {
      if (tag == "fiber") set_fibre(reading, child, place);
      if (tag == "mat_axis") set_axes(reading, child, place);
      if (tag != "thickness") continue;
      if (is_shell(reading.model.domains[at(place.domain)].shape)) {
        set_thickness(reading, child, place);
      } else {
        ignore(reading, child, "thickness of an element that is no shell");
      }
    }
  }
}

// -- maps on surfaces --------------------------------------------------------------------------------

/// Reads one <face lid="k">: a value for all nodes of the facet, or one per node of the surface's largest facet (those
/// beyond the facet's own are padding), as FEBio does. The fault, if any.
std::string read_face(const XMLElement& element, const Surface& surface, int largest, std::vector<char>& seen,
                      std::vector<double>& values) {
  const auto lid = whole_int(attribute(element, "lid"));
  if (!lid || *lid < 1 || *lid > surface.size()) {
    return fmt::format("<{}> with lid = {}, expected the number of one of the {} facets of surface {}", element.Name(),
                       quote(attribute(element, "lid")), surface.size(), quote(surface.name));
  }
  const std::size_t facet = at(*lid) - 1;
  if (seen[facet]) return fmt::format("facet {} is given twice", *lid);
  seen[facet] = 1;
  const std::string text = text_of(element);
  std::string_view rest = text;
  std::vector<double> numbers;
  do {
    double value = 0.0;
    const Number found = take_double(rest, value);
    if (found == Number::NotFinite) {
      return fmt::format("facet {} has {}, expected numbers of at most 1e30", *lid, quote(trim(text)));
    }
    if (found == Number::None) break;
    numbers.push_back(value);
  } while (take_comma(rest));
  const int count = static_cast<int>(numbers.size());
  if (!trim(rest).empty() || (count != 1 && count != largest)) {
    return fmt::format("facet {} has {}, expected one number, or {}: as many as the surface's largest facet has nodes",
                       *lid, quote(trim(text)), largest);
  }
  const int first = surface.begin[facet], nodes = surface.begin[facet + 1] - first;
  for (int k = 0; k < nodes; ++k) {
    values[at(first + k)] = numbers[count == 1 ? 0 : at(k)];
  }
  return "";
}

/// Fills the values of a map whose surface is known or -1. Why it cannot be used, "" if it can.
std::string read_map_values(const Reading& reading, const XMLElement& section, SurfaceMap& map) {
  const std::string data_type = attribute(section, section.Attribute("datatype") != nullptr ? "datatype" : "data_type");
  if (map.surface < 0)
    return fmt::format("surface = {}, expected the name of a Surface", quote(attribute(section, "surface")));
  if (section.Attribute("type") != nullptr || section.Attribute("generator") != nullptr)
    return "its values are made by a generator, expected <face lid=\"1\"> with numbers for every facet";
  if (!data_type.empty() && data_type != "scalar")
    return fmt::format("data_type = {}, expected scalar", quote(data_type));
  const Surface& surface = reading.model.surfaces[at(map.surface)];
  int largest = 0;
  for (int f = 0; f < surface.size(); ++f) largest = std::max(largest, surface.begin[at(f + 1)] - surface.begin[at(f)]);
  map.values.assign(surface.nodes.size(), 0.0);
  std::vector<char> seen(at(surface.size()), 0);
  for (const XMLElement& child : children(section)) {
    map.fault_origin = origin_of(reading, child);
    const std::string fault = read_face(child, surface, largest, seen, map.values);
    if (!fault.empty()) return fault;
  }
  map.fault_origin = map.origin;
  const auto missing = std::find(seen.begin(), seen.end(), 0);
  if (missing == seen.end()) return "";
  return fmt::format("facet {} of surface {} has no value ({} such facets)", missing - seen.begin() + 1,
                     quote(surface.name), std::count(seen.begin(), seen.end(), 0));
}

void read_surface_map(Reading& reading, const XMLElement& section, const std::string& what) {
  SurfaceMap map;
  map.name = attribute(section, "name");
  map.what = what;
  map.origin = map.fault_origin = origin_of(reading, section);
  map.surface = find_name(reading.surface_index, attribute(section, "surface"));
  map.fault = read_map_values(reading, section, map);
  reading.surface_maps.push_back(std::move(map));
}

}  // namespace

void read_element_data(Reading& reading, const XMLElement& element) {
  const std::string_view tag = element.Name();
  if (tag == "element") {
    const int id = read_id(reading, element);
    const auto place = find_element(reading, id);
    if (!place) fail(reading, element, fmt::format("ElementData of element {}, which does not exist: take it out", id));
    read_data(reading, element, {*place});
  } else if (tag == "elset") {
    read_data(reading, element, places_of_set(reading, element, need_attribute(reading, element, "set")));
  } else {
    pass_over(reading, element);
  }
}

void resolve_surface_maps(Reading& reading) {
  JointModel& model = reading.model;
  for (const MapUse& use : reading.map_uses) {
    Contact& contact = model.contacts[at(use.contact)];
    const int index = use.side == 0 ? contact.primary : contact.secondary;
    const Surface& surface = model.surfaces[at(index)];
    const auto map = std::find_if(reading.surface_maps.begin(), reading.surface_maps.end(),
                                  [&](const SurfaceMap& candidate) { return candidate.name == use.name; });
    if (map == reading.surface_maps.end()) {
      throw fault_at(model, use.origin,
                     fmt::format("{} names no map, expected the name of a SurfaceData in MeshData", quote(use.name)));
    }
    map->used = true;
    if (!map->fault.empty()) {
      throw fault_at(model, map->fault_origin, fmt::format("SurfaceData {}: {}", quote(map->name), map->fault));
    }
    if (map->surface != index) {
      throw fault_at(model, use.origin,
                     fmt::format("map {} is of surface {}, expected one of surface {}", quote(use.name),
                                 quote(model.surfaces[at(map->surface)].name), quote(surface.name)));
    }
    for (const double value : map->values) {
      if (value < 0) {
        throw fault_at(
            model, map->origin,
            fmt::format("SurfaceData {} has a thickness of {:g}, need thickness >= 0", quote(map->name), value));
      }
    }
    contact.dea->layers[use.side].thickness_map = map->values;
  }
  for (const SurfaceMap& map : reading.surface_maps) {
    if (!map.used) ignore(reading, map.origin, map.what);
  }
}

std::array<int, 2> read_node_pair(const Reading& reading, const XMLElement& element, const std::string& what) {
  std::vector<int> nodes;
  append_nodes(reading, element, 2, what, nodes);
  return {nodes[0], nodes[1]};
}

int find_node(const Reading& reading, int id) {
  if (reading.instance == nullptr) return reading.nodes.find(id);
  const int node = reading.instance->nodes.find(id);
  return node < 0 ? -1 : node + reading.instance->first_node;
}

std::optional<ElementPlace> find_element(const Reading& reading, int id) {
  const int number = reading.elements.find(id);
  if (number < 0) return std::nullopt;
  if (!reading.element_places.empty()) return reading.element_places[at(number)];
  const auto after = std::upper_bound(reading.first_element.begin(), reading.first_element.end(), number);
  const int domain = static_cast<int>(after - reading.first_element.begin()) - 1;
  return ElementPlace{domain, number - reading.first_element[at(domain)]};
}

std::string full_name(const Reading& reading, const std::string& name) {
  return reading.instance == nullptr || name.empty() ? name : reading.instance->prefix + name;
}

int need_node(const Reading& reading, const XMLElement& element, int id) {
  const int node = find_node(reading, id);
  if (node < 0)
    fail(reading, element,
         fmt::format("<{}> uses node {}, which does not exist: mend the number, or add the node", element.Name(), id));
  return node;
}

int need_listed_node(const Reading& reading, const XMLElement& element) {
  const std::string text = need_attribute(reading, element, "id");
  const auto id = whole_int(text);
  if (!id)
    fail(reading, element, fmt::format("<{}> with id = {}, expected a whole number", element.Name(), quote(text)));
  return need_node(reading, element, *id);
}

std::vector<int> need_node_set(Reading& reading, const XMLElement& element, const std::string& name) {
  const JointModel& model = reading.model;
  const int set = find_name(reading.node_set_index, name);
  if (reading.ambiguous_node_sets.count(name) > 0) {
    fail(reading, element, fmt::format("node set {} exists twice with different nodes: rename one", quote(name)));
  }
  if (set >= 0) {
    const std::vector<int>& nodes = model.node_sets[at(set)].nodes;
    count_entries(reading, element, nodes.size());
    return nodes;
  }

  std::vector<int> nodes;
  bool found = false;
  for (const NodeRange& range : reading.node_ranges) {
    if (range.name != name) continue;
    found = true;
    for (int node = range.begin; node < range.end; ++node) nodes.push_back(node);
  }
  count_entries(reading, element, nodes.size());
  if (found) return nodes;

  const std::size_t colon = name.find(':');
  const std::string kind = name.substr(0, colon);
  const std::string rest = colon == name.npos ? "" : name.substr(colon + 1);
  const auto add_domains = [&](const std::string& domain_name) {
    for (const int domain : reading.domain_index.find(domain_name)->second) {
      const std::vector<int>& more = model.domains[at(domain)].nodes;
      nodes.insert(nodes.end(), more.begin(), more.end());
    }
  };
  if (kind == "@surface" && find_name(reading.surface_index, rest) >= 0) {
    nodes = model.surfaces[at(find_name(reading.surface_index, rest))].nodes;
  } else if (kind == "@edge" && reading.edges.count(rest) > 0) {
    nodes = reading.edges.find(rest)->second;
  } else if (kind == "@part_list" && reading.part_lists.count(rest) > 0) {
    for (const std::string& part : reading.part_lists.find(rest)->second) add_domains(part);
  } else if (kind == "@elem_set" &&
             (find_name(reading.element_set_index, rest) >= 0 || reading.domain_index.count(rest) > 0)) {
    for (const ElementPlace& place : places_of_set(reading, element, rest)) {
      const Domain& domain = model.domains[at(place.domain)];
      const int count = nodes_per_element(domain.shape);
      const auto first = domain.nodes.begin() + static_cast<std::ptrdiff_t>(place.index) * count;
      nodes.insert(nodes.end(), first, first + count);
    }
  } else {
    auto there = reading.node_set_index;
    for (const NodeRange& range : reading.node_ranges) there.emplace(range.name, 0);
    fail(reading, element, fmt::format("{} names no node set{}", quote(name), those_there(name, there)));
  }
  count_entries(reading, element, nodes.size());
  // Each node once, in the order of its first appearance.
  std::vector<char> seen(model.nodes.size(), 0);
  std::erase_if(nodes, [&](int node) { return std::exchange(seen[at(node)], 1) != 0; });
  return nodes;
}

void read_mesh(Reading& reading, const XMLElement& section) {
  // by the constraints they are for
  constexpr SectionReader kNamedElsewhere = [](Reading&, const XMLElement&) {};
  constexpr TagReader kReaders[] = {{"Nodes", read_nodes},
                                    {"Elements", read_elements},
                                    {"NodeSet", read_node_set},
                                    {"ElementSet", read_element_set},
                                    {"Surface", read_named_surface},
                                    {"Edge", read_edge},
                                    {"DiscreteSet", read_discrete_set},
                                    {"PartList", read_part_list},
                                    {"SurfacePair", read_surface_pair},
                                    {"ElementData", read_each<read_element_data>},
                                    {"NodeSetSet", kNamedElsewhere},
                                    {"NodeSetPair", kNamedElsewhere},
                                    {"Part", read_part},
                                    {"Instance", read_instance}};
  read_children(reading, section, kReaders, pass_over);
}

void read_mesh_domains(Reading& reading, const XMLElement& section) {
  std::set<std::string> seen;
  for (const XMLElement& child : children(section)) {
    const std::string_view tag = child.Name();
    if (tag.size() < 6 || tag.substr(tag.size() - 6) != "Domain") {
      ignore(reading, child, fmt::format("<{}> in MeshDomains", tag));
      continue;
    }
    const std::string name = need_attribute(reading, child, "name");
    const auto domains = reading.domain_index.find(name);
    if (domains == reading.domain_index.end()) {
      fail(reading, child,
           fmt::format("{} {} names no Elements section: expected the name of one in Mesh{}", tag, quote(name),
                       those_there(name, reading.domain_index)));
    }
    if (!seen.insert(fmt::format("{} {}", tag, name)).second)
      fail(reading, child,
           fmt::format("a second {} {}, expected one: FEBio would make two domains of its elements, one over the other",
                       tag, quote(name)));
    const std::string mat = need_attribute(reading, child, "mat");
    if (const XMLElement* axes = child.FirstChildElement("mat_axis"))
      ignore(reading, *axes, fmt::format("<mat_axis> of {}: give it in the material, or as ElementData", tag));
    const XMLElement* thickness = child.FirstChildElement("shell_thickness");
    for (const int index : domains->second) {
      assign_material(reading, child, index, mat, false);
      Domain& domain = reading.model.domains[at(index)];
      if (thickness == nullptr || !is_shell(domain.shape)) continue;
      const double value = read_double(reading, *thickness);
      if (value > 0) domain.shell_thickness.assign(domain.nodes.size(), value);
    }
  }
}

/// "fem.material[0].E": a parameter of a material that its stiffness follows from.
bool names_modulus(const std::string& variable) {
  const std::string last = variable.substr(variable.find_last_of('.') + 1);
  static const std::set<std::string> moduli = {"E", "v", "mu", "k", "K", "G", "lam", "lambda", "c1", "c2"};
  return variable.find("material") != std::string::npos && moduli.count(last) > 0;
}

/// Do fibres of a material say that this map has their directions?
bool names_fibres(const Reading& reading, const std::string& map) {
  const std::vector<Material>& materials = reading.model.materials;
  return !map.empty() && std::any_of(materials.begin(), materials.end(), [&](const Material& m) {
    return std::any_of(m.fibres.begin(), m.fibres.end(),
                       [&](const Fibres& fibres) { return fibres.direction.map == map; });
  });
}

void read_mesh_data(Reading& reading, const XMLElement& element) {
  const std::string variable = attribute(element, element.Attribute("var") != nullptr ? "var" : "type");
  const std::string what = fmt::format("{} {}", element.Name(), quote(variable));
  const bool of_elements = std::strcmp(element.Name(), "ElementData") == 0;
  const std::string last = variable.substr(variable.find_last_of('.') + 1);  // of "solid[0].fiber", too
  if (of_elements && variable == "shell thickness") {
    read_by_element(reading, element, set_thickness);
  } else if (of_elements && last == "mat_axis" && !is_leaf(element)) {
    read_by_element(reading, element, set_axes);
  } else if (of_elements && last == "fiber" && !is_leaf(element)) {
    const std::string path = fibre_path(variable);
    read_by_element(reading, element,
                    [&](Reading& r, const XMLElement& e, const ElementPlace& place) { set_fibre(r, e, place, path); });
  } else if (const std::string map = attribute(element, "name"); of_elements && names_fibres(reading, map)) {
    read_by_element(reading, element, [&](Reading& r, const XMLElement& e, const ElementPlace& place) {
      set_mapped_fibre(r, e, place, map);
    });
  } else if (std::strcmp(element.Name(), "SurfaceData") == 0 && element.Attribute("name") != nullptr) {
    read_surface_map(reading, element, what);
  } else if (of_elements && names_modulus(variable)) {
    fail(reading, element,
         fmt::format("ElementData gives {} element by element, expected one value for a material: a layer has one "
                     "modulus here; take this ElementData out, and give the modulus in the material",
                     quote(variable)));
  } else {
    ignore(reading, element, what);
  }
}

}  // namespace dea::feb

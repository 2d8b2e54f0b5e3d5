// What versions 1.2 and 2.0 share: nodes, facets and springs listed where they are used, not as named sets.
#include <fmt/format.h>

#include <map>
#include <tuple>

#include "io/feb/feb_reading.h"
#include "io/febio/known_words.h"

namespace dea::feb {
namespace {

/// A name that no other surface has.
std::string free_surface_name(const Reading& reading, const std::string& wish) {
  std::string name = wish;
  for (int i = 2; reading.surface_index.count(name) > 0; ++i) name = fmt::format("{} ({})", wish, i);
  return name;
}

/// The surface of a <surface type="master|slave">: named by `set`, or listed inside.
int surface_of(Reading& reading, const XMLElement& element, const std::string& wish) {
  if (element.Attribute("set") != nullptr) {
    const std::string name = attribute(element, "set");
    const auto place = reading.surface_index.find(name);
    if (place == reading.surface_index.end()) {
      fail(reading, element,
           fmt::format("set = {}, expected the name of a Surface above it{}", quote(name),
                       those_there(name, reading.surface_index)));
    }
    return place->second;
  }
  const std::string format = attribute(element, "format");
  if (!format.empty() && format != "face nodes" && format != "element face") {
    fail(reading, element, fmt::format("format = {}, expected face nodes or element face", quote(format)));
  }
  return read_surface(reading, element, free_surface_name(reading, wish), format == "element face");
}

/// Nodes that move with a body: <node id="12" rb="2"/>. Runs with one body become one condition, as in FEBio.
void read_rigid_nodes(Reading& reading, const XMLElement& element) {
  std::vector<RigidNodes> runs;
  std::string body;
  for (const XMLElement& child : children(element)) {
    const std::string rb = need_attribute(reading, child, "rb");
    if (runs.empty() || rb != body) {
      RigidNodes rigid;
      rigid.material = need_rigid(reading, child, rb);
      rigid.step = reading.step;
      rigid.name = attribute(element, "name");
      rigid.origin = origin_of(reading, child);
      runs.push_back(std::move(rigid));
      body = rb;
    }
    runs.back().nodes.push_back(need_listed_node(reading, child));
  }
  for (RigidNodes& rigid : runs) reading.model.rigid_nodes.push_back(std::move(rigid));
}

/// Nodes listed as children with one and the same value.
struct NodeValues {
  std::string dof;
  int controller = 0;  ///< id, 0: none
  double value = 0.0;
  const XMLElement* element = nullptr;
  std::vector<int> nodes;
};

/// Children <node id="" bc="" lc="">value</node>; bc and lc may stand at the element. In the order of the file.
std::vector<NodeValues> node_values(Reading& reading, const XMLElement& element, double usual) {
  std::vector<NodeValues> groups;
  std::map<std::tuple<std::string, int, double>, std::size_t> index;
  const std::string bc = attribute(element, "bc");
  const int lc = read_lc(reading, element);
  for (const XMLElement& child : children(element, "node")) {
    NodeValues group;
    group.dof = child.Attribute("bc") != nullptr ? attribute(child, "bc") : bc;
    if (group.dof.empty()) need_attribute(reading, child, "bc");
    check_attributes(reading, child);
    group.controller = child.Attribute("lc") != nullptr ? read_lc(reading, child) : lc;
    group.value = trim(text_of(child)).empty() ? usual : read_double(reading, child);
    group.element = &child;
    const int node = need_listed_node(reading, child);
    const auto [place, is_new] =
        index.try_emplace(std::make_tuple(group.dof, group.controller, group.value), groups.size());
    if (is_new) groups.push_back(std::move(group));
    groups[place->second].nodes.push_back(node);
  }
  return groups;
}

/// `scale` of the element, or its text, or 1.
double value_of_all(const Reading& reading, const XMLElement& element) {
  if (is_leaf(element) && !trim(text_of(element)).empty()) return read_double(reading, element);
  const std::string scale = attribute(element, "scale");
  if (scale.empty()) return 1.0;
  const auto value = whole_double(scale);
  if (!value) fail(reading, element, fmt::format("scale = {}, expected a number of at most 1e30", quote(scale)));
  return *value;
}

/// What a <spring> says of itself, in the words of a discrete material.
febio::DiscreteMaterial old_material(Reading& reading, const XMLElement& element) {
  febio::Component component = component_of(reading, element);
  std::string& type = component.type;
  if (type.empty() || type == "linear" || type == "tension-only linear" || type == "nonlinear")
    type += type.empty() ? "linear spring" : " spring";
  febio::check_words(reading, febio::Place::Spring, component);
  febio::DiscreteMaterial material = febio::discrete_material(reading, component);
  if (!material.advice.empty()) material.unsupported = fmt::format("spring {}", quote(type));
  return material;
}

}  // namespace

void read_old_contact(Reading& reading, const XMLElement& element) {
  const std::string type = need_attribute(reading, element, "type");
  if (type == "rigid") return read_rigid_nodes(reading, element);
  const febio::Component component = component_of(reading, element);
  febio::check_words(reading, febio::Place::Rigid, component);
  if (rigid_connector(reading, component)) return;
  if (!febio::contact_kind(type))
    return unsupported_word(reading, element, fmt::format("contact {}", quote(type)), febio::WordOf::Contact, type);
  std::string name = attribute(element, "name");
  if (name.empty()) name = fmt::format("contact {}", reading.model.contacts.size() + 1);
  int primary = -1, secondary = -1;
  for (const XMLElement& child : children(element, "surface")) {
    const bool master = need_attribute(reading, child, "type") == "master";
    int& side = master ? secondary : primary;
    if (side >= 0) {
      fail(reading, child, fmt::format("contact with two {} surfaces, expected one", master ? "master" : "slave"));
    }
    side = surface_of(reading, child, name + (master ? " master" : " slave"));
  }
  if (primary < 0 || secondary < 0) {
    fail(reading, element,
         fmt::format("contact without <surface type=\"{}\">: add it", primary < 0 ? "slave" : "master"));
  }
  add_contact(reading, element, primary, secondary);
}

void read_old_spring(Reading& reading, const XMLElement& element) {
  const febio::DiscreteMaterial material = old_material(reading, element);
  DiscreteSet set;
  set.name = attribute(element, "name");
  set.origin = origin_of(reading, element);
  for (const XMLElement& child : children(element, "node")) {
    set.pairs.push_back(read_node_pair(reading, child, fmt::format("spring {}", set.pairs.size() + 1)));
  }
  if (set.pairs.empty()) fail(reading, element, "spring without <node>n1,n2</node>: add the nodes it joins");
  const int place = static_cast<int>(reading.model.discrete_sets.size());
  if (set.name.empty()) set.name = fmt::format("spring {}", place + 1);
  for (int i = 2; !reading.discrete_set_index.emplace(set.name, place).second; ++i) {
    set.name = fmt::format("spring {} ({})", place + 1, i);
  }
  reading.model.discrete_sets.push_back(std::move(set));
  add_springs(reading, element, material, place);
}

void read_old_fix(Reading& reading, const XMLElement& element) {
  if (element.Attribute("bc") != nullptr)
    return febio::fix_nodes(reading, on_nodes(reading, element), attribute(element, "bc"));
  for (NodeValues& group : node_values(reading, element, 0.0)) {
    febio::fix_nodes(reading, on_nodes(reading, *group.element, std::move(group.nodes)), group.dof);
  }
}

void read_old_prescribe(Reading& reading, const XMLElement& element) {
  const bool relative = attribute(element, "type") == "relative";
  if (element.FirstChildElement("node") == nullptr) {
    const Scaled value = {value_of_all(reading, element), read_lc(reading, element)};
    febio::prescribe_nodes(reading, on_nodes(reading, element), need_attribute(reading, element, "bc"), value,
                           relative);
    return;
  }
  for (NodeValues& group : node_values(reading, element, value_of_all(reading, element))) {
    febio::prescribe_nodes(reading, on_nodes(reading, *group.element, std::move(group.nodes)), group.dof,
                           Scaled{group.value, group.controller}, relative);
  }
}

void read_old_nodal_force(Reading& reading, const XMLElement& element) {
  if (element.FirstChildElement("node") == nullptr) {
    const Scaled force = {value_of_all(reading, element), read_lc(reading, element)};
    febio::nodal_force(reading, on_nodes(reading, element), need_attribute(reading, element, "bc"), force);
    return;
  }
  for (NodeValues& group : node_values(reading, element, value_of_all(reading, element))) {
    febio::nodal_force(reading, on_nodes(reading, *group.element, std::move(group.nodes)), group.dof,
                       {group.value, group.controller});
  }
}

}  // namespace dea::feb

// What versions 1.2, 2.0 and 2.5 say otherwise: nodes, facets and springs listed where they are used (1.2, 2.0), rigid
// bodies in Constraints or Boundary; Rx is a rotation.
#include <fmt/format.h>

#include <map>
#include <tuple>

#include "io/feb/feb_reading.h"

namespace dea::feb {
namespace {

// -- 1.2 and 2.0 ---------------------------------------------------------------------------------------

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
    return need_entry(reading, element, "set =", name, "Surface above it", reading.surface_index);
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
      const Condition condition = {reading.step, attribute(element, "name"), origin_of(reading, child)};
      runs.push_back({condition, need_rigid(reading, child, rb), {}});
      body = rb;
    }
    runs.back().nodes.push_back(need_listed_node(reading, child));
  }
  for (RigidNodes& rigid : runs) reading.model.rigid_nodes.push_back(std::move(rigid));
}

/// Nodes listed as children with one and the same value.
struct NodeValues {
  std::string dof;
  Scaled value;  ///< its controller: an id, 0: none
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
    group.value.controller = child.Attribute("lc") != nullptr ? read_lc(reading, child) : lc;
    group.value.factor = trim(text_of(child)).empty() ? usual : read_double(reading, child);
    group.element = &child;
    const int node = need_listed_node(reading, child);
    const auto [place, is_new] =
        index.try_emplace(std::make_tuple(group.dof, group.value.controller, group.value.factor), groups.size());
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

/// Of a condition whose value may stand at the element, for all nodes of a set or for those listed without one.
std::vector<NodeValues> values_of_nodes(Reading& reading, const XMLElement& element) {
  const double all = value_of_all(reading, element);
  if (element.FirstChildElement("node") != nullptr) return node_values(reading, element, all);
  const int controller = read_lc(reading, element);
  return {{need_attribute(reading, element, "bc"), {all, controller}, &element, nodes_of(reading, element)}};
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

/// One `<contact>`: rigid nodes, a connector, or two surfaces inside it.
void read_old_contact(Reading& reading, const XMLElement& element) {
  const std::string type = need_attribute(reading, element, "type");
  if (type == "rigid") return read_rigid_nodes(reading, element);
  const febio::Component component = checked(reading, febio::Place::Rigid, element);
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

/// Springs between nodes listed inside.
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

/// `<node id="" bc="">value</node>`; values at the element are for all nodes.
void read_old_prescribe(Reading& reading, const XMLElement& element) {
  for (NodeValues& group : values_of_nodes(reading, element))
    febio::prescribe_nodes(reading, on_nodes(reading, *group.element, std::move(group.nodes)), group.dof, group.value,
                           attribute(element, "type") == "relative");
}

void read_old_nodal_force(Reading& reading, const XMLElement& element) {
  for (NodeValues& group : values_of_nodes(reading, element))
    febio::nodal_force(reading, on_nodes(reading, *group.element, std::move(group.nodes)), group.dof, group.value);
}

// -- rigid bodies ------------------------------------------------------------------------------------

/// A `<rigid_body>`: what `read` makes of each child; what it fixes gathers in `body`.
void read_body(Reading& reading, const XMLElement& section,
               void (*read)(Reading& reading, const XMLElement& child, RigidFixed& body)) {
  RigidFixed body = {{reading.step, attribute(section, "name"), origin_of(reading, section)},
                     need_rigid(reading, section, need_attribute(reading, section, "mat"))};
  for (const XMLElement& child : children(section)) read(reading, child, body);
  if (body.dofs != std::array<bool, kDofs>{}) febio::add_old_fix(reading, std::move(body));
}

void prescribe_body(Reading& reading, const XMLElement& element, const RigidFixed& body, int dof, bool relative) {
  reading.model.rigid_prescribed.push_back({{reading.step, body.name, origin_of(reading, element)},
                                            body.material,
                                            dof,
                                            read_scaled(reading, element),
                                            relative});
}

/// A force or moment, the element's number.
RigidLoad rigid_load(const Reading& reading, const XMLElement& element, const RigidFixed& body, int dof) {
  return {{reading.step, body.name, origin_of(reading, element)}, body.material, dof, read_scaled(reading, element)};
}

int rigid_dof(const Reading& reading, const XMLElement& element) {
  return febio::need_place_of_word(reading, origin_of(reading, element), element.Name(),
                                   need_attribute(reading, element, "bc"), {"x", "y", "z", "Rx", "Ry", "Rz"});
}

void add_body_load(Reading& reading, const XMLElement& element, const RigidFixed& body) {
  const int dof = rigid_dof(reading, element);
  const std::string type = attribute(element, "type");
  RigidLoad load = rigid_load(reading, element, body, dof);
  if (type == "ramp") load.kind = RigidLoad::Kind::Target;
  if (type == "follow") load.kind = RigidLoad::Kind::Follower;
  if (!one_of(type, {"", "ramp", "follow"})) {
    unsupported(reading, element, fmt::format("{} with type {}", dof < 3 ? "rigid force" : "rigid moment", quote(type)),
                "expected no type, ramp or follow");
  } else if (dof >= 3 && !type.empty()) {
    unsupported(reading, element, fmt::format("rigid moment with type {}, which FEBio 4 leaves out", quote(type)),
                "remove the type, or save as 4.0");
  } else {
    reading.model.rigid_loads.push_back(std::move(load));
  }
}

/// fixed, prescribed, force and initial_velocity (2.0, 2.5).
void read_body_child(Reading& reading, const XMLElement& child, RigidFixed& body) {
  const std::string_view tag = child.Name();
  if (tag == "fixed") {
    body.dofs[at(rigid_dof(reading, child))] = true;
  } else if (tag == "prescribed") {
    prescribe_body(reading, child, body, rigid_dof(reading, child), attribute(child, "type") == "relative");
  } else if (tag == "force") {
    add_body_load(reading, child, body);
  } else if (tag == "initial_velocity" || tag == "initial_angular_velocity") {
    ignore(reading, child, "initial velocity of a rigid body");
  } else {
    unsupported(reading, child, fmt::format("<{}> in rigid_body", tag),
                "expected fixed, prescribed, force or initial_velocity");
  }
}

void read_rigid_body(Reading& reading, const XMLElement& section) { read_body(reading, section, read_body_child); }

// -- 1.2: elements by tag with a material each, trans_ and rot_ ----------------------------------------

/// Elements of one shape and one material become a domain; ids are counted anew, as FEBio does.
void read_mixed_elements(Reading& reading, const XMLElement& section) {
  JointModel& model = reading.model;
  std::map<std::pair<int, ElementShape>, int> domains;
  for (std::size_t i = 0; i < model.domains.size(); ++i) {
    domains[{model.domains[i].material, model.domains[i].shape}] = static_cast<int>(i);
  }
  for (const XMLElement& child : children(section)) {
    const std::string type = child.Name();
    const ElementShape shape = need_shape(reading, child, type);
    const std::string mat = need_attribute(reading, child, "mat");
    const int material = febio::material_of_id(reading, mat);
    if (material < 0) {
      fail(reading, child, fmt::format("<{}> with mat = {}, expected the id of a material", type, quote(mat)));
    }
    const auto [place, is_new] =
        domains.try_emplace(std::make_pair(material, shape), static_cast<int>(model.domains.size()));
    if (is_new) {
      Domain domain;
      domain.shape = shape;
      domain.material = material;
      domain.origin = origin_of(reading, child);
      model.domains.push_back(std::move(domain));
      reading.first_element.push_back(reading.elements.size());
    }
    Domain& domain = model.domains[at(place->second)];
    const int number = reading.elements.size() + 1;
    reading.elements.add(number);
    reading.element_places.push_back({place->second, static_cast<int>(domain.element_ids.size())});
    append_element(reading, child, type, number, domain);
  }
}

void read_geometry(Reading& reading, const XMLElement& section) {
  constexpr TagReader kReaders[] = {{"Nodes", read_nodes},
                                    {"Elements", read_mixed_elements},
                                    {"ElementData", read_each<read_element_data>},
                                    {"NodeSet", read_node_set}};
  read_children(reading, section, kReaders, pass_over);
}

/// trans_x, rot_z: the dof; -1: another tag.
int dof_of(std::string_view tag) {
  constexpr const char* kTags[kDofs] = {"trans_x", "trans_y", "trans_z", "rot_x", "rot_y", "rot_z"};
  for (int i = 0; i < kDofs; ++i) {
    if (tag == kTags[i]) return i;
  }
  return -1;
}

bool is_relative(const Reading& reading, const XMLElement& element) {
  const std::string word = attribute(element, "relative");
  if (!word.empty() && word != "true" && word != "false") {
    fail(reading, element, fmt::format("relative = {}, expected true or false", quote(word)));
  }
  return word == "true";
}

/// trans_x and the like, with a type: fixed, prescribed, force.
void read_body_child_12(Reading& reading, const XMLElement& child, RigidFixed& body) {
  const int dof = dof_of(child.Name());
  if (dof < 0)
    return unsupported(reading, child, fmt::format("<{}> in rigid_body", child.Name()),
                       "expected trans_x, trans_y, trans_z, rot_x, rot_y or rot_z");
  const std::string type = need_attribute(reading, child, "type");
  if (type == "fixed") {
    body.dofs[at(dof)] = true;
  } else if (type == "prescribed") {
    prescribe_body(reading, child, body, dof, is_relative(reading, child));
  } else if (type == "force") {
    reading.model.rigid_loads.push_back(rigid_load(reading, child, body, dof));
  } else {
    fail(reading, child,
         fmt::format("{} with type {}, expected fixed, prescribed or force", child.Name(), quote(type)));
  }
}

void read_body_12(Reading& reading, const XMLElement& section) { read_body(reading, section, read_body_child_12); }

/// Loads on facets: <quad4 scale="">; without `scale` they are 1.
bool facets_are_zero(const XMLElement& element) {
  for (const XMLElement& child : children(element)) {
    const auto scale = whole_double(attribute(child, "scale"));
    if (!scale || *scale != 0.0) return false;
  }
  return true;
}

void read_body_force(Reading& reading, const XMLElement& element) {
  if (febio::is_zero_load(component_of(reading, element)))
    ignore(reading, element, "body_force of zero");
  else
    unsupported(reading, element, "body_force", febio::load_advice("body_force", ""));
}

/// A load on the facets listed inside.
void read_surface_load(Reading& reading, const XMLElement& element) {
  const std::string tag = element.Name();
  const bool of_fluid = tag == "fluidflux" || tag == "soluteflux" || tag == "concentration" || tag == "heatflux";
  if (facets_are_zero(element))
    ignore(reading, element, tag + " of zero");
  else if (of_fluid)
    ignore(reading, element, tag);
  else
    unsupported(reading, element, tag, febio::load_advice("surface_load", tag));
}

// -- 2.5 -----------------------------------------------------------------------------------------------

void read_fixed_nodes(Reading& reading, const XMLElement& element) {
  febio::fix_nodes(reading, on_nodes(reading, element), need_attribute(reading, element, "bc"));
}

void read_prescribed_nodes(Reading& reading, const XMLElement& element) {
  prescribe_nodes(reading, element, need_attribute(reading, element, "bc"),
                  element.FirstChildElement("scale") != nullptr ? "scale" : "value");
}

void read_rigid_nodes_25(Reading& reading, const XMLElement& element) {
  rigid_nodes(reading, element, need_attribute(reading, element, "rb"));
}

void refuse_rigid_body(Reading& reading, const XMLElement& element) {
  unsupported(reading, element, "rigid_body in Constraints", "move it to Boundary");
}

void ignore_heat_source(Reading& reading, const XMLElement& element) { ignore(reading, element, "heat_source"); }

// -- sections --------------------------------------------------------------------------------------------

constexpr TagReader kBoundary12[] = {{"fix", read_old_fix},
                                     {"prescribe", read_old_prescribe},
                                     {"contact", read_old_contact},
                                     {"spring", read_old_spring}};
constexpr TagReader kConstraints12[] = {{"rigid_body", read_body_12}};
constexpr TagReader kLoads12[] = {
    {"force", read_old_nodal_force}, {"heat_source", ignore_heat_source}, {"body_force", read_body_force}};

constexpr TagReader kBoundary20[] = {{"fix", read_old_fix}, {"prescribe", read_old_prescribe}};
constexpr TagReader kContact20[] = {{"contact", read_old_contact}};
constexpr TagReader kConstraints20[] = {{"rigid_body", read_rigid_body}};
constexpr TagReader kLoads20[] = {{"nodal_load", read_old_nodal_force}};
void read_discrete_20(Reading& reading, const XMLElement& section) {
  constexpr TagReader kReaders[] = {{"spring", read_old_spring}, {"rigid_axial_force", read_axial_force}};
  read_children(reading, section, kReaders);
}

constexpr TagReader kBoundary25[] = {{"fix", read_fixed_nodes},
                                     {"prescribe", read_prescribed_nodes},
                                     {"rigid", read_rigid_nodes_25},
                                     {"rigid_body", read_rigid_body}};
constexpr TagReader kConstraints25[] = {{"rigid_body", refuse_rigid_body}};

}  // namespace

const Rules kRules12{.version = "1.2",
                     .up_to_25 = true,
                     .unique_materials = false,
                     .mesh = read_geometry,
                     .boundary = {kBoundary12},
                     .constraints = {kConstraints12, read_constraint},
                     .loads = {kLoads12, read_surface_load}};

const Rules kRules20{.version = "2.0",
                     .up_to_25 = true,
                     .unique_materials = false,
                     .boundary = {kBoundary20},
                     .contact = {kContact20},
                     .constraints = {kConstraints20, read_constraint},
                     .loads = {kLoads20, read_load},
                     .discrete = read_discrete_20};

const Rules kRules25{
    .version = "2.5", .up_to_25 = true, .boundary = {kBoundary25}, .constraints = {kConstraints25, read_constraint}};

}  // namespace dea::feb

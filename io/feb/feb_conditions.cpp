// Conditions shared by the versions: held nodes, rigid bodies, contacts, springs, loads.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "feb_reading.h"

namespace dea::feb {
namespace {

std::string name_of(const XMLElement& element) { return attribute(element, "name"); }

bool one_of(std::string_view word, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(), [&](const char* candidate) { return word == candidate; });
}

/// Nodes of `node_set` (`set` in some old files), or listed as children.
std::vector<int> nodes_of(Reading& reading, const XMLElement& element) {
  for (const char* name : {"node_set", "set"}) {
    if (element.Attribute(name) != nullptr) return need_node_set(reading, element, attribute(element, name));
  }
  std::vector<int> nodes;
  for (const XMLElement* child = element.FirstChildElement("node"); child != nullptr;
       child = child->NextSiblingElement("node")) {
    const auto id = whole_int(need_attribute(reading, *child, "id"));
    if (!id)
      fail(reading, *child,
           fmt::format("<node> with id = {}, expected a whole number", quote(attribute(*child, "id"))));
    nodes.push_back(need_node(reading, *child, *id));
  }
  if (nodes.empty()) fail(reading, element, fmt::format("<{}> without attribute node_set", element.Name()));
  return nodes;
}

/// True for FEBio's older "xy", "xyz", "uvw": letters in their order; "wx" is a fluid velocity.
bool is_joined(std::string_view dof) {
  constexpr std::string_view kLetters = "xyzuvw";
  std::size_t next = 0;
  for (const char letter : dof) {
    const std::size_t place = kLetters.find(letter, next);
    if (place == kLetters.npos) return false;
    next = place + 1;
  }
  return dof.size() > 1;
}

/// "x,y" and "xy" as single dof names.
std::vector<std::string> split_dofs(std::string_view text) {
  std::vector<std::string> dofs;
  for (const std::string& word : split_words(text)) {
    const std::string dof(trim(word));
    if (is_joined(dof)) {
      for (const char letter : dof) dofs.emplace_back(1, letter);
    } else {
      dofs.push_back(dof);
    }
  }
  return dofs;
}

}  // namespace

int read_dof(const Reading& reading, const XMLElement& element, std::string_view word,
             std::initializer_list<const char*> names) {
  int i = 0;
  for (const char* name : names) {
    if (same_word(trim(word), name)) return i;
    ++i;
  }
  const auto number = whole_int(word);
  if (number && *number >= 0 && *number < i) return *number;
  std::string expected;
  for (const char* name : names) expected += fmt::format("{}{}", expected.empty() ? "" : ", ", name);
  fail(reading, element, fmt::format("<{}> with dof {}, expected one of {}", element.Name(), quote(word), expected));
}

// -- nodes -------------------------------------------------------------------------------------------

void fix_nodes(Reading& reading, const XMLElement& element, std::string_view dofs) {
  FixedNodes fixed;
  for (const std::string& dof : split_dofs(dofs)) {
    if (one_of(dof, {"x", "y", "z"})) {
      fixed.xyz[static_cast<std::size_t>(dof[0] - 'x')] = true;
    } else {
      ignore(reading, element, fmt::format("fixed dof {}: no displacement", quote(dof)));
    }
  }
  fixed.nodes = nodes_of(reading, element);
  if (!fixed.xyz[0] && !fixed.xyz[1] && !fixed.xyz[2]) return;
  fixed.step = reading.step;
  fixed.name = name_of(element);
  fixed.origin = origin_of(reading, element);
  reading.model.fixed_nodes.push_back(std::move(fixed));
}

void prescribe_nodes(Reading& reading, const XMLElement& element, std::string_view dof, const XMLElement* value) {
  const std::string name(trim(dof));
  if (!one_of(name, {"x", "y", "z"})) {
    if (one_of(name, {"u", "v", "w", "sx", "sy", "sz"})) {
      unsupported(reading, element, fmt::format("prescribed shell dof {}", quote(name)));
    } else {
      ignore(reading, element, fmt::format("prescribed dof {}: no displacement", quote(name)));
    }
    return;
  }
  const auto number = value == nullptr ? std::nullopt : whole_double(text_of(*value));
  const bool plain = value != nullptr && (value->Attribute("type") == nullptr || attribute(*value, "type") == "const");
  if (plain && number && *number == 0.0) {
    fix_nodes(reading, element, name);
    return;
  }
  nodes_of(reading, element);  // a dangling set is a fault even so
  unsupported(reading, element, "prescribed displacement of nodes");
}

void rigid_nodes(Reading& reading, const XMLElement& element, const std::string& body) {
  RigidNodes rigid;
  rigid.material = need_rigid(reading, element, body);
  rigid.nodes = nodes_of(reading, element);
  rigid.step = reading.step;
  rigid.name = name_of(element);
  rigid.origin = origin_of(reading, element);
  reading.model.rigid_nodes.push_back(std::move(rigid));
}

// -- rigid bodies ------------------------------------------------------------------------------------

namespace {

int body_of(const Reading& reading, const XMLElement& element, const char* tag = "rb") {
  const XMLElement* child = element.FirstChildElement(tag);
  if (child == nullptr) fail(reading, element, fmt::format("<{}> without <{}>", element.Name(), tag));
  return need_rigid(reading, *child, text_of(*child));
}

void add_prescribed(Reading& reading, const XMLElement& element, int dof, const XMLElement* value) {
  RigidPrescribed motion;
  motion.material = body_of(reading, element);
  motion.dof = dof;
  if (value != nullptr)
    motion.value = read_scaled(reading, *value);
  else
    motion.value.controller = 0;
  motion.relative = child_bool(reading, element, "relative", false);
  motion.step = reading.step;
  motion.name = name_of(element);
  motion.origin = origin_of(reading, value == nullptr ? element : *value);
  reading.model.rigid_prescribed.push_back(std::move(motion));
}

void add_load(Reading& reading, const XMLElement& element, int dof) {
  const XMLElement* value = element.FirstChildElement("value");
  if (value == nullptr) fail(reading, element, fmt::format("<{}> without <value>", element.Name()));
  RigidLoad load;
  load.material = body_of(reading, element);
  load.dof = dof;
  load.value = read_scaled(reading, *value);
  load.step = reading.step;
  load.name = name_of(element);
  load.origin = origin_of(reading, *value);
  const char* what = dof < 3 ? "rigid force" : "rigid moment";
  const XMLElement* type = element.FirstChildElement("load_type");
  const int load_type = type == nullptr ? 0 : read_word(*type, {"LOAD", "FOLLOW", "TARGET"});
  if (load_type < 0)
    fail(reading, *type, fmt::format("load_type = {}, expected LOAD, FOLLOW or TARGET", quote(text_of(*type))));
  if (load_type == 2) {
    unsupported(reading, element, fmt::format("{} with load_type TARGET", what));
  } else if (load_type == 1 && dof >= 3) {
    unsupported(reading, element, "rigid moment with load_type FOLLOW");
  } else if (child_bool(reading, element, "relative", false)) {
    unsupported(reading, element, fmt::format("{} with relative = 1", what));
  } else {
    load.kind = load_type == 1 ? RigidLoad::Kind::Follower : RigidLoad::Kind::Dead;
    reading.model.rigid_loads.push_back(std::move(load));
  }
}

}  // namespace

bool rigid_condition(Reading& reading, const XMLElement& element, const std::string& type) {
  const XMLElement* value = element.FirstChildElement("value");
  const std::string dof = child_text(element, "dof");
  if (type == "rigid_fixed") {
    RigidFixed fixed;
    fixed.material = body_of(reading, element);
    constexpr const char* kFlags[kDofs] = {"Rx_dof", "Ry_dof", "Rz_dof", "Ru_dof", "Rv_dof", "Rw_dof"};
    for (std::size_t i = 0; i < kDofs; ++i) fixed.dofs[i] = child_bool(reading, element, kFlags[i], false);
    fixed.step = reading.step;
    fixed.name = name_of(element);
    fixed.origin = origin_of(reading, element);
    reading.model.rigid_fixed.push_back(std::move(fixed));
  } else if (type == "rigid_displacement") {
    const bool letter = !trim(dof).empty() && lower(trim(dof))[0] == 'r';
    add_prescribed(
        reading, element,
        letter ? read_dof(reading, element, dof, {"Rx", "Ry", "Rz"}) : read_dof(reading, element, dof, {"x", "y", "z"}),
        value);
  } else if (type == "rigid_rotation") {
    add_prescribed(reading, element, 3 + read_dof(reading, element, dof, {"Ru", "Rv", "Rw"}), value);
  } else if (type == "rigid_rotation_vector") {
    add_prescribed(reading, element, 3, element.FirstChildElement("vx"));
    add_prescribed(reading, element, 4, element.FirstChildElement("vy"));
    add_prescribed(reading, element, 5, element.FirstChildElement("vz"));
  } else if (type == "rigid_force") {
    add_load(reading, element, read_dof(reading, element, dof, {"Rx", "Ry", "Rz"}));
  } else if (type == "rigid_moment") {
    add_load(reading, element, 3 + read_dof(reading, element, dof, {"Ru", "Rv", "Rw"}));
  } else if (type == "force") {  // 3.0
    add_load(reading, element, read_dof(reading, element, dof, {"Rx", "Ry", "Rz", "Ru", "Rv", "Rw"}));
  } else if (type == "prescribe") {  // 3.0
    add_prescribed(reading, element, read_dof(reading, element, dof, {"Rx", "Ry", "Rz", "Ru", "Rv", "Rw"}), value);
  } else if (one_of(type, {"initial_rigid_velocity", "initial_rigid_angular_velocity"})) {
    ignore(reading, element, "initial velocity of a rigid body");
  } else if (type.find("euler") != type.npos || type.find("follower") != type.npos ||
             one_of(type, {"rigid_axial_force", "rigid_cable"})) {
    unsupported(reading, element, fmt::format("{} {}", element.Name(), quote(type)));
  } else {
    return false;
  }
  return true;
}

bool rigid_connector(Reading& reading, const XMLElement& element, const std::string& type) {
  if (type.rfind("rigid ", 0) != 0 && type != "generic rigid joint") return false;
  if (febio::is_damper(type)) {
    ignore(reading, element, fmt::format("{}: statics has no velocity", type));
    return true;
  }
  if (type != "rigid spring") {
    unsupported(reading, element, fmt::format("rigid connector {}", quote(type)));
    return true;
  }
  RigidSpring spring;
  spring.material_a = body_of(reading, element, "body_a");
  spring.material_b = body_of(reading, element, "body_b");
  const XMLElement* a = element.FirstChildElement("insertion_a");
  const XMLElement* b = element.FirstChildElement("insertion_b");
  if (a != nullptr) spring.insertion_a = read_vector(reading, *a);
  if (b != nullptr) spring.insertion_b = read_vector(reading, *b);
  spring.k = child_double(reading, element, "k", 1.0);
  spring.free_length = child_double(reading, element, "free_length", 0.0);
  for (const char* name : {"k", "free_length", "insertion_a", "insertion_b"}) {
    const XMLElement* child = element.FirstChildElement(name);
    if (child != nullptr && child->Attribute("lc") != nullptr) {
      unsupported(reading, *child, fmt::format("rigid spring whose {} follows a load controller", name));
    }
  }
  spring.step = reading.step;
  spring.name = name_of(element);
  spring.origin = origin_of(reading, element);
  reading.model.rigid_springs.push_back(std::move(spring));
  return true;
}

// -- contact -----------------------------------------------------------------------------------------

namespace {

/// Parameters that could change the result and that DEA does not use, where they are away from their defaults.
std::vector<std::string> ignored_parameters(const XMLElement& element, const std::string& type) {
  std::vector<std::string> ignored;
  for (const febio::ContactParameter& parameter : febio::unused_contact_parameters(type)) {
    const XMLElement* child = element.FirstChildElement(parameter.name);
    if (child == nullptr) continue;
    const std::string text(trim(text_of(*child)));
    const auto value = whole_double(text);
    if (value && *value == parameter.usual && child->Attribute("lc") == nullptr) continue;
    ignored.push_back(fmt::format("{} = {}", parameter.name, value ? fmt::format("{:g}", *value) : quote(text)));
  }
  return ignored;
}

/// Position of the element's word, or a fault that lists them.
int need_word(const Reading& reading, const XMLElement& element, std::initializer_list<const char*> words) {
  const int position = read_word(element, words);
  if (position >= 0) return position;
  std::string expected;
  for (const char* word : words) expected += fmt::format("{}{}", expected.empty() ? "" : ", ", word);
  fail(reading, element,
       fmt::format("{} = {}, expected one of {}", element.Name(), quote(trim(text_of(element))), expected));
}

/// primary_E, secondary_thickness and so on; false: the element is none of these.
bool read_dea_layer(Reading& reading, const XMLElement& element, DeaContact& dea) {
  const std::string tag = element.Name();
  const int side = tag.rfind("primary_", 0) == 0 ? 0 : tag.rfind("secondary_", 0) == 0 ? 1 : -1;
  if (side < 0) return false;
  DeaLayer& layer = dea.layers[side];
  const std::string what = tag.substr(tag.find('_') + 1);
  const std::string type = attribute(element, "type");
  const auto need = [&](bool good, double value, const char* needed) {
    if (!good) fail(reading, element, fmt::format("{} = {:g}, need {}", tag, value, needed));
    return value;
  };
  if (what == "E" || what == "nu" || what == "thickness") {
    if (what == "thickness" && type == "map") {
      reading.map_uses.push_back({static_cast<int>(reading.model.contacts.size()), side,
                                  std::string(trim(text_of(element))), origin_of(reading, element)});
      return true;
    }
    if ((!type.empty() && type != "const") || read_lc(reading, element) != 0) {
      fail(reading, element,
           fmt::format("{} is given as type {} or follows a load controller, expected a number{}", tag, quote(type),
                       what == "thickness" ? " or type \"map\"" : ""));
    }
    const double value = read_double(reading, element);
    // FEBio writes out parameters at their defaults: E = 0 and thickness = -1 say nothing
    if (what == "E" && value != 0)
      layer.E = need(value > 0, value, "E > 0");
    else if (what == "nu")
      layer.nu = need(value > -1 && value < 0.5, value, "-1 < nu < 0.5");
    else if (what == "thickness" && value != -1)
      layer.thickness = need(value >= 0, value, "thickness >= 0");
    return true;
  }
  return false;
}

/// A contact of type dea: the spring bed, stated in the model.
DeaContact read_dea(Reading& reading, const XMLElement& element) {
  DeaContact dea;
  for (const XMLElement* child = element.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    const std::string_view tag = child->Name();
    if (tag == "law") {
      dea.law = static_cast<Law>(need_word(reading, *child, {"linear", "logarithmic", "neo-Hookean", "layer"}));
    } else if (tag == "facets") {
      dea.facets = static_cast<Facets>(need_word(reading, *child, {"curved", "flat"}));
    } else if (tag == "source") {
      dea.source = need_word(reading, *child, {"primary", "secondary"});
    } else if (tag == "refine") {
      const int refine = read_int(reading, *child);
      if (refine < 1 || refine > 1000) fail(reading, *child, fmt::format("refine = {}, need 1 to 1000", refine));
      dea.refine = refine;
    } else if (!read_dea_layer(reading, *child, dea)) {
      fail(reading, *child,
           fmt::format("<{}> in a contact of type dea, expected law, facets, source, refine, or E, nu, thickness with "
                       "primary_ or secondary_ before",
                       tag));
    }
  }
  for (DeaLayer& layer : dea.layers)
    if (!layer.E) layer.nu.reset();
  return dea;
}

}  // namespace

void read_contact(Reading& reading, const XMLElement& section) {
  for (const XMLElement* child = section.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    if (std::string_view(child->Name()) != "contact") {
      unsupported(reading, *child, fmt::format("<{}> in Contact", child->Name()));
      continue;
    }
    Contact contact;
    contact.type = need_attribute(reading, *child, "type");
    const auto kind = febio::contact_kind(contact.type);
    if (!kind) {
      unsupported(reading, *child, fmt::format("contact {}", quote(contact.type)));
      continue;
    }
    const std::string pair_name = need_attribute(reading, *child, "surface_pair");
    const auto place = reading.surface_pairs.find(pair_name);
    if (place == reading.surface_pairs.end()) {
      fail(reading, *child, fmt::format("surface_pair = {}, expected the name of a SurfacePair", quote(pair_name)));
    }
    const SurfacePair& pair = place->second;
    if (!pair.unsupported.empty()) {
      unsupported(reading, *child, "contact with " + pair.unsupported);
      continue;
    }
    for (const int index : {pair.primary, pair.secondary}) {
      const Surface& surface = reading.model.surfaces[static_cast<std::size_t>(index)];
      if (surface.size() == 0) {
        fail(reading, *child,
             fmt::format("contact {} uses surface {}, which has no facets", quote(name_of(*child)),
                         quote(surface.name)));
      }
    }
    contact.name = name_of(*child);
    contact.kind = *kind;
    contact.primary = pair.primary;
    contact.secondary = pair.secondary;
    contact.max_distance = child_double(reading, *child, "max_distance", 0.0);
    contact.ignored = ignored_parameters(*child, contact.type);
    if (contact.type == "dea") contact.dea = read_dea(reading, *child);
    contact.step = reading.step;
    contact.origin = origin_of(reading, *child);
    reading.model.contacts.push_back(std::move(contact));
  }
}

// -- springs between nodes ---------------------------------------------------------------------------

namespace {

void read_discrete_material(Reading& reading, const XMLElement& element) {
  DiscreteMaterial material;
  material.type = need_attribute(reading, element, "type");
  const XMLElement* E = element.FirstChildElement("E");
  if (material.type != "linear spring" && material.type != "tension-only linear spring") {
    material.unsupported = fmt::format("discrete material {}", quote(material.type));
  } else if (E != nullptr) {
    const bool plain =
        E->Attribute("lc") == nullptr && (E->Attribute("type") == nullptr || attribute(*E, "type") == "const");
    if (plain)
      material.stiffness = read_double(reading, *E);
    else
      material.unsupported = "spring whose E is not one number";
  }
  reading.discrete_materials.push_back(std::move(material));
}

void read_discrete_springs(Reading& reading, const XMLElement& element) {
  const std::string set_name = need_attribute(reading, element, "discrete_set");
  const auto set = reading.discrete_set_index.find(set_name);
  if (set == reading.discrete_set_index.end()) {
    fail(reading, element, fmt::format("discrete_set = {}, expected the name of a DiscreteSet", quote(set_name)));
  }
  const std::string dmat = need_attribute(reading, element, "dmat");
  const auto number = whole_int(dmat);
  if (!number || *number < 1 || *number > static_cast<int>(reading.discrete_materials.size())) {
    fail(reading, element,
         fmt::format("dmat = {}, expected the number of one of the {} discrete materials above it", quote(dmat),
                     reading.discrete_materials.size()));
  }
  const DiscreteMaterial& material = reading.discrete_materials[static_cast<std::size_t>(*number) - 1];
  if (!material.unsupported.empty()) {
    unsupported(reading, element, material.unsupported);
    return;
  }
  const std::string name = name_of(element);
  DiscreteSprings springs;
  springs.set = set->second;
  springs.stiffness = material.stiffness;
  springs.tension_only = material.type != "linear spring";
  springs.step = reading.step;
  springs.name = name.empty() ? set_name : name;
  springs.origin = origin_of(reading, element);
  reading.model.discrete_springs.push_back(springs);
}

}  // namespace

void read_discrete(Reading& reading, const XMLElement& section) {
  for (const XMLElement* child = section.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    const std::string_view tag = child->Name();
    if (tag == "discrete_material")
      read_discrete_material(reading, *child);
    else if (tag == "discrete")
      read_discrete_springs(reading, *child);
    else
      unsupported(reading, *child, fmt::format("<{}> in Discrete", tag));
  }
}

// -- loads and the rest ------------------------------------------------------------------------------

bool is_zero_load(const XMLElement& element) {
  bool found = false;
  for (const XMLElement* child = element.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    if (!one_of(child->Name(), {"pressure", "scale", "traction", "value", "force", "x", "y", "z"})) continue;
    found = true;
    const std::string text = text_of(*child);
    for (const std::string& word : split_words(text)) {
      const auto number = whole_double(word);
      if (!number || *number != 0.0) return false;
    }
  }
  return found;
}

void read_loads(Reading& reading, const XMLElement& section) {
  for (const XMLElement* child = section.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    const std::string type = attribute(*child, "type");
    if (rigid_condition(reading, *child, type)) continue;
    const std::string what =
        type.empty() ? std::string(child->Name()) : fmt::format("{} {}", child->Name(), quote(type));
    const bool of_fluid =
        type.rfind("fluid", 0) == 0 || type.rfind("solute", 0) == 0 || type.rfind("concentration", 0) == 0;
    if (is_zero_load(*child))
      ignore(reading, *child, what + " of zero");
    else if (of_fluid && type.find("FSI") == type.npos)
      ignore(reading, *child, what);
    else
      unsupported(reading, *child, what);
  }
}

void read_initial(Reading& reading, const XMLElement& section) {
  for (const XMLElement* child = section.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    const std::string type = attribute(*child, "type");
    if (type.find("prestrain") != type.npos)
      unsupported(reading, *child, fmt::format("initial {}", quote(type)));
    else
      ignore(reading, *child, "initial conditions");
  }
}

void read_constraints(Reading& reading, const XMLElement& section) {
  for (const XMLElement* child = section.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    const std::string type = attribute(*child, "type");
    if (std::string_view(child->Name()) != "constraint") {
      unsupported(reading, *child, fmt::format("<{}> in Constraints", child->Name()));
    } else if (type.empty()) {
      ignore(reading, *child, "constraint without a type: names one given before");
    } else if (type == "symmetry plane") {
      ignore(reading, *child, "symmetry plane");
    } else if (!rigid_connector(reading, *child, type)) {
      unsupported(reading, *child, fmt::format("constraint {}", quote(type)));
    }
  }
}

}  // namespace dea::feb

// Conditions shared by the versions: held nodes, rigid bodies, contacts, springs, loads.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <febiodea/io/feb/feb_reading.h>
#include <febiodea/model/load_curve.h>

namespace dea::feb {
namespace {

std::string name_of(const XMLElement& element) { return attribute(element, "name"); }

bool one_of(std::string_view word, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(), [&](const char* candidate) { return word == candidate; });
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
    if (dof == "xyzsxyz") {  // 2.0
      for (const char* each : {"x", "y", "z", "sxyz"}) dofs.emplace_back(each);
    } else if (is_joined(dof)) {
      for (const char letter : dof) dofs.emplace_back(1, letter);
    } else {
      dofs.push_back(dof);
    }
  }
  return dofs;
}

}  // namespace

std::vector<int> nodes_of(Reading& reading, const XMLElement& element) {
  for (const char* name : {"node_set", "set"}) {
    if (element.Attribute(name) != nullptr) return need_node_set(reading, element, attribute(element, name));
  }
  std::vector<int> nodes;
  for (const XMLElement& child : children(element, "node")) {
    nodes.push_back(need_listed_node(reading, child));
  }
  if (nodes.empty())
    fail(reading, element,
         fmt::format("<{}> without attribute node_set: add it, with the name of a node set", element.Name()));
  return nodes;
}

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
  fix_nodes(reading, element, dofs, nodes_of(reading, element));
}

void fix_nodes(Reading& reading, const XMLElement& element, std::string_view dofs, std::vector<int> nodes) {
  FixedNodes fixed;
  for (const std::string& dof : split_dofs(dofs)) {
    if (one_of(dof, {"x", "y", "z"})) {
      fixed.xyz[static_cast<std::size_t>(dof[0] - 'x')] = true;
    } else {
      ignore(reading, element, fmt::format("fixed dof {}: no displacement", quote(dof)));
    }
  }
  fixed.nodes = std::move(nodes);
  if (!fixed.xyz[0] && !fixed.xyz[1] && !fixed.xyz[2]) return;
  fixed.step = reading.step;
  fixed.name = name_of(element);
  fixed.origin = origin_of(reading, element);
  reading.model.fixed_nodes.push_back(std::move(fixed));
}

namespace {

bool is_relative(const Reading& reading, const XMLElement& element) {
  return child_bool(reading, element, "relative", false);
}

std::string node_set_name(const XMLElement& element) {
  const std::string set = attribute(element, "node_set");
  return set.empty() ? attribute(element, "set") : set;
}

}  // namespace

void prescribe_nodes(Reading& reading, const XMLElement& element, std::string_view dof, const XMLElement* value) {
  if (value != nullptr && !whole_double(text_of(*value))) {  // a map or an expression of the place
    unsupported(reading, element, febio::kMovedApart, febio::kMovedApartAdvice);
    return;
  }
  const Scaled number = value == nullptr ? Scaled{} : read_scaled(reading, *value);
  prescribe_nodes(reading, element, dof, number, is_relative(reading, element), nodes_of(reading, element));
}

void prescribe_nodes(Reading& reading, const XMLElement& element, std::string_view dof, const Scaled& value,
                     bool relative, std::vector<int> nodes) {
  const std::string name(trim(dof));
  if (one_of(name, {"u", "v", "w", "sx", "sy", "sz"})) {
    unsupported(reading, element, fmt::format("prescribed shell dof {}", quote(name)),
                "take it out: DEA has no deformable shells, take their material as rigid with --rigid");
  } else if (!one_of(name, {"x", "y", "z"})) {
    ignore(reading, element, fmt::format("prescribed dof {}: no displacement", quote(name)));
  } else if (value.factor == 0.0 && !relative) {
    fix_nodes(reading, element, name, std::move(nodes));
  } else {
    PrescribedNodes prescribed;
    prescribed.nodes = std::move(nodes);
    prescribed.component = name[0] - 'x';
    prescribed.value = value;
    prescribed.relative = relative;
    prescribed.step = reading.step;
    prescribed.name = name_of(element);
    if (prescribed.name.empty()) prescribed.name = node_set_name(element);
    if (prescribed.name.empty()) prescribed.name = "moved nodes";
    prescribed.origin = origin_of(reading, element);
    reading.model.prescribed_nodes.push_back(std::move(prescribed));
  }
}

void remark_double_motion(Reading& reading) {
  const std::vector<RigidPrescribed>& all = reading.model.rigid_prescribed;
  std::map<std::pair<int, int>, const RigidPrescribed*> before;  // of a material and dof
  for (const RigidPrescribed& motion : all) {
    const RigidPrescribed*& other = before[{motion.material, motion.dof}];
    if (other != nullptr && (other->step == motion.step || other->step < 0)) {
      ignore(reading, other->origin,
             fmt::format("prescribed {} of {}: it is prescribed again in line {}, and the last one counts, as in FEBio",
                         kDofNames[motion.dof],
                         quote(reading.model.materials[static_cast<std::size_t>(motion.material)].name),
                         motion.origin.line));
    }
    other = &motion;
  }
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

void add_prescribed(Reading& reading, const XMLElement& element, int dof, const XMLElement* value) {
  RigidPrescribed motion;
  motion.material = child_body(reading, element);
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
  if (value == nullptr) fail(reading, element, fmt::format("<{}> without <value>: add it", element.Name()));
  RigidLoad load;
  load.material = child_body(reading, element);
  load.dof = dof;
  load.value = read_scaled(reading, *value);
  load.step = reading.step;
  load.name = name_of(element);
  load.origin = origin_of(reading, *value);
  const XMLElement* type = element.FirstChildElement("load_type");
  const int load_type = type == nullptr ? 0 : read_word(*type, {"LOAD", "FOLLOW", "TARGET"});
  if (load_type < 0)
    fail(reading, *type, fmt::format("load_type = {}, expected LOAD, FOLLOW or TARGET", quote(text_of(*type))));
  if (load_type == 1 && dof >= 3) {
    unsupported(reading, element, "rigid moment with load_type FOLLOW", "use rigid_follower_moment, or load_type LOAD");
    return;
  }
  load.kind = static_cast<RigidLoad::Kind>(load_type);
  load.relative = load.kind == RigidLoad::Kind::Dead && child_bool(reading, element, "relative", false);
  reading.model.rigid_loads.push_back(std::move(load));
}

/// Euler angles [degrees]: x, then y, then z about the fixed axes. As a rotation vector if they are constant; a single
/// angle may follow a load controller.
void add_euler_angles(Reading& reading, const XMLElement& element) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  RigidPrescribed motion;
  motion.material = child_body(reading, element);
  motion.step = reading.step;
  motion.name = name_of(element);
  motion.origin = origin_of(reading, element);
  std::array<Scaled, 3> angles;
  int turning = 0, steered = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const XMLElement* child = element.FirstChildElement(std::array{"Ex", "Ey", "Ez"}[i]);
    angles[i] = child == nullptr ? Scaled{0.0, 0} : read_scaled(reading, *child);
    if (angles[i].factor == 0) angles[i].controller = 0;
    angles[i].factor *= kDegree;
    turning += angles[i].factor != 0 ? 1 : 0;
    steered += angles[i].controller != 0 ? 1 : 0;
  }
  if (turning > 1 && steered > 0) {
    unsupported(reading, element, "rigid_euler_angles of which several turn and one follows a load controller",
                "give rigid_rotation_vector, or let one angle alone turn");
    return;
  }
  if (turning > 1) {
    const Eigen::Quaterniond q = Eigen::AngleAxisd(angles[2].factor, Vector3d::UnitZ()) *
                                 Eigen::AngleAxisd(angles[1].factor, Vector3d::UnitY()) *
                                 Eigen::AngleAxisd(angles[0].factor, Vector3d::UnitX());
    const Eigen::AngleAxisd turn(q);
    for (int i = 0; i < 3; ++i) angles[static_cast<std::size_t>(i)].factor = turn.angle() * turn.axis()[i];
  }
  for (std::size_t i = 0; i < 3; ++i) {
    motion.dof = 3 + static_cast<int>(i);
    motion.value = angles[i];
    reading.model.rigid_prescribed.push_back(motion);
  }
}

/// Force or moment that turns with the body.
void add_follower(Reading& reading, const XMLElement& element, bool moment) {
  const char* tag = moment ? "moment" : "force";
  const XMLElement* value = element.FirstChildElement(tag);
  if (value == nullptr)
    fail(reading, element, fmt::format("<{}> without <{}>: add it, three numbers", element.Name(), tag));
  RigidFollower follower;
  follower.material = child_body(reading, element);
  follower.moment = moment;
  follower.value = read_vector(reading, *value);
  follower.controller = read_lc(reading, *value);
  if (!moment) {
    follower.insertion = child_vector(reading, element, "insertion", Vector3d::Zero());
    follower.from_center = child_bool(reading, element, "relative", false);
  }
  follower.step = reading.step;
  follower.name = name_of(element);
  follower.origin = origin_of(reading, *value);
  reading.model.rigid_followers.push_back(std::move(follower));
}

}  // namespace

bool rigid_condition(Reading& reading, const XMLElement& element, const std::string& type) {
  const XMLElement* value = element.FirstChildElement("value");
  const std::string dof = child_text(element, "dof");
  if (type == "rigid_fixed") {
    RigidFixed fixed;
    fixed.material = child_body(reading, element);
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
  } else if (type == "rigid_euler_angles") {
    add_euler_angles(reading, element);
  } else if (one_of(type, {"rigid_follower_force", "follower force"})) {
    add_follower(reading, element, false);
  } else if (one_of(type, {"rigid_follower_moment", "follower moment"})) {
    add_follower(reading, element, true);
  } else if (type == "rigid_axial_force") {
    read_axial_force(reading, element);
  } else if (type == "rigid_cable") {
    read_cable(reading, element);
  } else {
    return false;
  }
  return true;
}

namespace {

int rigid_dof(const Reading& reading, const XMLElement& element) {
  return read_dof(reading, element, need_attribute(reading, element, "bc"), {"x", "y", "z", "Rx", "Ry", "Rz"});
}

void add_body_load(Reading& reading, const XMLElement& element, int material, const std::string& name) {
  const int dof = rigid_dof(reading, element);
  const std::string type = attribute(element, "type");
  RigidLoad load;
  load.material = material;
  load.dof = dof;
  load.value = read_scaled(reading, element);
  load.step = reading.step;
  load.name = name;
  load.origin = origin_of(reading, element);
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

}  // namespace

void read_rigid_body(Reading& reading, const XMLElement& section) {
  const int material = need_rigid(reading, section, need_attribute(reading, section, "mat"));
  const std::string name = name_of(section);
  RigidFixed fixed{material, {}, reading.step, name, origin_of(reading, section)};
  bool any_fixed = false;
  for (const XMLElement& child : children(section)) {
    const std::string_view tag = child.Name();
    if (tag == "fixed") {
      fixed.dofs[static_cast<std::size_t>(rigid_dof(reading, child))] = any_fixed = true;
    } else if (tag == "prescribed") {
      reading.model.rigid_prescribed.push_back({material, rigid_dof(reading, child), read_scaled(reading, child),
                                                attribute(child, "type") == "relative", reading.step, name,
                                                origin_of(reading, child)});
    } else if (tag == "force") {
      add_body_load(reading, child, material, name);
    } else if (tag == "initial_velocity" || tag == "initial_angular_velocity") {
      ignore(reading, child, "initial velocity of a rigid body");
    } else {
      unsupported(reading, child, fmt::format("<{}> in rigid_body", tag),
                  "expected fixed, prescribed, force or initial_velocity");
    }
  }
  if (any_fixed) reading.model.rigid_fixed.push_back(std::move(fixed));
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
  for (const XMLElement& child : children(element)) {
    const std::string_view tag = child.Name();
    if (tag == "law") {
      dea.law = static_cast<Law>(need_word(reading, child, {"linear", "logarithmic", "neo-Hookean", "layer"}));
    } else if (tag == "facets") {
      dea.facets = static_cast<Facets>(need_word(reading, child, {"curved", "flat"}));
    } else if (tag == "source") {
      dea.source = need_word(reading, child, {"primary", "secondary"});
    } else if (tag == "refine") {
      const int refine = read_int(reading, child);
      if (refine < 1 || refine > 1000) fail(reading, child, fmt::format("refine = {}, need 1 to 1000", refine));
      dea.refine = refine;
    } else if (!read_dea_layer(reading, child, dea)) {
      fail(reading, child,
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

void add_contact(Reading& reading, const XMLElement& element, int primary, int secondary) {
  Contact contact;
  contact.type = need_attribute(reading, element, "type");
  for (const int index : {primary, secondary}) {
    const Surface& surface = reading.model.surfaces[static_cast<std::size_t>(index)];
    if (surface.size() == 0) {
      fail(reading, element,
           fmt::format("contact {} uses surface {}, which has no facets: define it again, or take the contact out",
                       quote(name_of(element)), quote(surface.name)));
    }
  }
  contact.name = name_of(element);
  if (contact.name.empty()) contact.name = fmt::format("contact {}", reading.model.contacts.size() + 1);
  contact.kind = *febio::contact_kind(contact.type);
  contact.primary = primary;
  contact.secondary = secondary;
  contact.max_distance = child_double(reading, element, "max_distance", 0.0);
  contact.ignored = ignored_parameters(element, contact.type);
  if (contact.type == "dea") contact.dea = read_dea(reading, element);
  contact.step = reading.step;
  contact.origin = origin_of(reading, element);
  reading.model.contacts.push_back(std::move(contact));
}

void read_contact(Reading& reading, const XMLElement& section) {
  for (const XMLElement& child : children(section)) {
    if (std::string_view(child.Name()) != "contact") {
      unsupported(reading, child, fmt::format("<{}> in Contact", child.Name()),
                  "expected <contact type= surface_pair=>");
      continue;
    }
    const std::string type = need_attribute(reading, child, "type");
    if (!febio::contact_kind(type)) {
      unsupported_word(reading, child, fmt::format("contact {}", quote(type)), febio::WordOf::Contact, type);
      continue;
    }
    const std::string pair_name = need_attribute(reading, child, "surface_pair");
    const auto pair = reading.surface_pairs.find(pair_name);
    if (pair == reading.surface_pairs.end()) {
      fail(reading, child,
           fmt::format("surface_pair = {}, expected the name of a SurfacePair{}", quote(pair_name),
                       those_there(pair_name, reading.surface_pairs)));
    }
    add_contact(reading, child, pair->second.primary, pair->second.secondary);
  }
}

// -- loads and the rest ------------------------------------------------------------------------------

bool is_zero_load(const XMLElement& element) {
  bool found = false;
  for (const XMLElement& child : children(element)) {
    if (!one_of(child.Name(), {"pressure", "scale", "traction", "value", "force", "x", "y", "z"})) continue;
    found = true;
    const std::string text = text_of(child);
    for (const std::string& word : split_words(text)) {
      const auto number = whole_double(word);
      if (!number || *number != 0.0) return false;
    }
  }
  return found;
}

void add_nodal_force(Reading& reading, const XMLElement& element, std::string_view dof, const Scaled& force,
                     std::vector<int> nodes) {
  const std::string name(trim(dof));
  if (one_of(name, {"u", "v", "w", "sx", "sy", "sz"})) {
    unsupported(reading, element, fmt::format("nodal load on the shell dof {}", quote(name)),
                "take it out, or load x, y or z");
  } else if (!one_of(name, {"x", "y", "z"})) {
    ignore(reading, element, fmt::format("nodal load on dof {}: no force", quote(name)));
  } else if (force.factor == 0) {
    ignore(reading, element, "nodal load of zero");
  } else {
    NodalForce load;
    load.nodes = std::move(nodes);
    load.value[name[0] - 'x'] = force.factor;
    load.controller = force.controller;
    load.step = reading.step;
    load.name = name_of(element);
    load.origin = origin_of(reading, element);
    reading.model.nodal_forces.push_back(std::move(load));
  }
}

bool nodal_load(Reading& reading, const XMLElement& element) {
  const std::string type = attribute(element, "type");
  const bool vector = type == "nodal_force";
  if (!vector && type != "nodal_load" && !type.empty()) return false;
  const XMLElement* value = element.FirstChildElement(vector ? "value" : "scale");
  const std::string dof = element.Attribute("bc") != nullptr ? attribute(element, "bc") : child_text(element, "dof");
  std::vector<int> nodes = nodes_of(reading, element);
  for (const char* flag : {"relative", "shell_bottom"}) {
    if (!child_bool(reading, element, flag, false)) continue;
    unsupported(reading, element, fmt::format("nodal load with {} = 1", flag), fmt::format("set {} to 0", flag));
    return true;
  }
  if (value == nullptr) {
    const bool other = element.FirstChildElement("value") != nullptr || element.FirstChildElement("scale") != nullptr;
    if (other)
      unsupported(reading, element, fmt::format("nodal load without <{}>", vector ? "value" : "scale"),
                  fmt::format("add <{}>", vector ? "value" : "scale"));
    else
      ignore(reading, element, "nodal load of zero");
    return true;
  }
  const std::string kind = attribute(*value, "type");
  const std::string text = text_of(*value);
  if (!kind.empty() && kind != "const" && kind != "vector") {
    unsupported(reading, *value, fmt::format("nodal load whose {} is a {}", value->Name(), quote(kind)),
                "give a number, with lc=\"ID\" if it changes");
  } else if (!vector && kind.empty() && !expression_variables(text).empty()) {
    unsupported(reading, *value, fmt::format("nodal load whose scale is {}", quote(trim(text))),
                "give a number, with lc=\"ID\" if it changes");
  } else if (vector) {
    NodalForce load;
    load.nodes = std::move(nodes);
    load.value = read_vector(reading, *value);
    load.controller = read_lc(reading, *value);
    load.step = reading.step;
    load.name = name_of(element);
    load.origin = origin_of(reading, *value);
    if (load.value.isZero(0))
      ignore(reading, element, "nodal load of zero");
    else
      reading.model.nodal_forces.push_back(std::move(load));
  } else {
    Scaled force = read_scaled(reading, *value);
    add_nodal_force(reading, element, dof, force, std::move(nodes));
  }
  return true;
}

void read_load(Reading& reading, const XMLElement& element) {
  const std::string type = attribute(element, "type");
  if (rigid_condition(reading, element, type)) return;
  if (std::string_view(element.Name()) == "nodal_load" && nodal_load(reading, element)) return;
  const std::string what =
      type.empty() ? std::string(element.Name()) : fmt::format("{} {}", element.Name(), quote(type));
  const bool of_fluid =
      type.rfind("fluid", 0) == 0 || type.rfind("solute", 0) == 0 || type.rfind("concentration", 0) == 0;
  if (is_zero_load(element))
    ignore(reading, element, what + " of zero");
  else if (of_fluid && type.find("FSI") == type.npos)
    ignore(reading, element, what);
  else
    unsupported(reading, element, what, febio::load_advice(element.Name(), type));
}

void read_loads(Reading& reading, const XMLElement& section) {
  for (const XMLElement& child : children(section)) {
    read_load(reading, child);
  }
}

void read_initial(Reading& reading, const XMLElement& section) {
  for (const XMLElement& child : children(section)) {
    const std::string type = attribute(child, "type");
    if (type.find("prestrain") != type.npos)
      unsupported(reading, child, fmt::format("initial {}", quote(type)),
                  "take it out: DEA's cartilage starts without stress");
    else
      ignore(reading, child, "initial conditions");
  }
}

void read_constraint(Reading& reading, const XMLElement& element) {
  const std::string type = attribute(element, "type");
  if (std::string_view(element.Name()) != "constraint") {
    unsupported(reading, element, fmt::format("<{}> in Constraints", element.Name()), "expected <constraint type=>");
  } else if (type.empty()) {
    name_connector_again(reading, element);
  } else if (type == "symmetry plane") {
    reading.connector_names.insert(attribute(element, "name"));
    const int place = find_name(reading.surface_index, attribute(element, "surface"));
    const int axis =
        place < 0 ? -1 : febio::plane_axis(reading.model, reading.model.surfaces[static_cast<std::size_t>(place)]);
    if (axis < 0)
      unsupported(reading, element, "constraint \"symmetry plane\"", febio::kPlaneAdvice);
    else
      fix_nodes(reading, element, std::string(1, "xyz"[axis]),
                febio::nodes_of_surface(reading.model.surfaces[static_cast<std::size_t>(place)]));
  } else if (!rigid_connector(reading, element, type)) {
    const std::string wall = "mesh the wall as rigid shells and give it a sliding contact, or take it out";
    unsupported(reading, element, fmt::format("constraint {}", quote(type)),
                type == "rigid_wall" ? wall : febio::word_advice(febio::WordOf::Connector, type));
  }
}

void read_constraints(Reading& reading, const XMLElement& section) {
  for (const XMLElement& child : children(section)) {
    read_constraint(reading, child);
  }
}

}  // namespace dea::feb

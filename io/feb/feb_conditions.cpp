// Conditions shared by the versions: held nodes, rigid bodies, contacts, springs, loads.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "io/feb/feb_reading.h"
#include "io/febio/known_words.h"
#include "io/febio/symmetry_words.h"
#include "src/model/load_curve.h"

namespace dea::feb {
namespace {

std::string name_of(const XMLElement& element) { return attribute(element, "name"); }

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

// -- nodes -------------------------------------------------------------------------------------------

febio::OnNodes on_nodes(const Reading& reading, const XMLElement& element, std::vector<int> nodes) {
  const std::string set = attribute(element, "node_set");
  return {std::move(nodes), name_of(element), set.empty() ? attribute(element, "set") : set,
          origin_of(reading, element), steps_of(reading)};
}

febio::OnNodes on_nodes(Reading& reading, const XMLElement& element) {
  return on_nodes(reading, element, nodes_of(reading, element));
}

void prescribe_nodes(Reading& reading, const XMLElement& element, std::string_view dof, const char* value) {
  const febio::Component component = component_of(reading, element);
  febio::check_words(reading, febio::Place::Boundary, component);
  febio::prescribe_nodes(reading, on_nodes(reading, element), dof, febio::find(component, value),
                         febio::flag_of(reading, component, "relative"));
}

void rigid_nodes(Reading& reading, const XMLElement& element, const std::string& body) {
  febio::check_words(reading, febio::Place::Boundary, component_of(reading, element));
  RigidNodes rigid;
  rigid.material = need_rigid(reading, element, body);
  rigid.nodes = nodes_of(reading, element);
  rigid.step = reading.step;
  rigid.name = name_of(element);
  rigid.origin = origin_of(reading, element);
  reading.model.rigid_nodes.push_back(std::move(rigid));
}

// -- rigid bodies ------------------------------------------------------------------------------------

void read_rigid(Reading& reading, const XMLElement& section) {
  for (const XMLElement& child : children(section)) {
    const febio::Component component = component_of(reading, child);
    febio::check_words(reading, febio::Place::Rigid, component);
    if (febio::rigid_condition(reading, component, steps_of(reading)) || rigid_connector(reading, component)) continue;
    unsupported_word(reading, child, fmt::format("{} {}", child.Name(), quote(component.type)),
                     febio::WordOf::RigidCondition, component.type);
  }
}

namespace {

int rigid_dof(const Reading& reading, const XMLElement& element) {
  return febio::need_place_of_word(reading, origin_of(reading, element), element.Name(),
                                   need_attribute(reading, element, "bc"), {"x", "y", "z", "Rx", "Ry", "Rz"});
}

void add_body_load(Reading& reading, const XMLElement& element, int material, const std::string& name) {
  const int dof = rigid_dof(reading, element);
  const std::string type = attribute(element, "type");
  RigidLoad load = rigid_load(reading, element, material, dof, name);
  if (type == "ramp") load.kind = RigidLoad::Kind::Target;
  if (type == "follow") load.kind = RigidLoad::Kind::Follower;
  if (!febio::one_of(type, {"", "ramp", "follow"})) {
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

RigidLoad rigid_load(const Reading& reading, const XMLElement& element, int material, int dof,
                     const std::string& name) {
  RigidLoad load;
  load.material = material;
  load.dof = dof;
  load.value = read_scaled(reading, element);
  load.step = reading.step;
  load.name = name;
  load.origin = origin_of(reading, element);
  return load;
}

void read_rigid_body(Reading& reading, const XMLElement& section) {
  const int material = need_rigid(reading, section, need_attribute(reading, section, "mat"));
  const std::string name = name_of(section);
  RigidFixed fixed{{reading.step, name, origin_of(reading, section)}, material};
  bool any_fixed = false;
  for (const XMLElement& child : children(section)) {
    const std::string_view tag = child.Name();
    if (tag == "fixed") {
      fixed.dofs[static_cast<std::size_t>(rigid_dof(reading, child))] = any_fixed = true;
    } else if (tag == "prescribed") {
      reading.model.rigid_prescribed.push_back({{reading.step, name, origin_of(reading, child)},
                                                material,
                                                rigid_dof(reading, child),
                                                read_scaled(reading, child),
                                                attribute(child, "type") == "relative"});
    } else if (tag == "force") {
      add_body_load(reading, child, material, name);
    } else if (tag == "initial_velocity" || tag == "initial_angular_velocity") {
      ignore(reading, child, "initial velocity of a rigid body");
    } else {
      unsupported(reading, child, fmt::format("<{}> in rigid_body", tag),
                  "expected fixed, prescribed, force or initial_velocity");
    }
  }
  if (any_fixed) febio::add_old_fix(reading, std::move(fixed));
}

// -- contact -----------------------------------------------------------------------------------------

namespace {

/// Position of the element's word, or a fault that lists them.
int need_word(const Reading& reading, const XMLElement& element, std::initializer_list<const char*> words) {
  const int position = febio::place_of_word(text_of(element), words);
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
    const std::string text(trim(text_of(element)));
    const febio::ThicknessText thickness =
        what == "thickness" ? febio::thickness_text(type, text) : febio::ThicknessText::Number;
    if (thickness == febio::ThicknessText::Nothing) return true;
    if (thickness == febio::ThicknessText::Map) {
      reading.map_uses.push_back(
          {static_cast<int>(reading.model.contacts.size()), side, text, origin_of(reading, element)});
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
    } else if (tag == "symmetry_planes") {
      const auto planes = febio::planes_of_text(text_of(child));
      if (!planes)
        fail(reading, child,
             fmt::format("symmetry_planes = {}, {}", quote(trim(text_of(child))), febio::kPlanesExpected));
      dea.symmetry_planes = *planes;
    } else if (!read_dea_layer(reading, child, dea)) {
      fail(reading, child,
           fmt::format("<{}> in a contact of type dea, expected law, facets, source, refine, symmetry_planes, or E, "
                       "nu, thickness with "
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
  const febio::Component component = component_of(reading, element);
  febio::check_words(reading, febio::Place::Contact, component);
  contact.max_distance = febio::tie_reach(reading, component);
  contact.closes_gap = febio::closes_gap(component);
  contact.ignored = febio::ignored_contact_parameters(component);
  febio::refuse_contact_parameters(reading, component);
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
    const SurfacePair pair = need_named(reading, child, "surface_pair", "SurfacePair", reading.surface_pairs);
    add_contact(reading, child, pair.primary, pair.secondary);
  }
}

// -- loads and the rest ------------------------------------------------------------------------------

bool nodal_load(Reading& reading, const XMLElement& element, febio::Component component) {
  if (!component.type.empty() && component.type != "nodal_load" && component.type != "nodal_force") return false;
  febio::check_words(reading, febio::Place::Load, component);
  if (element.Attribute("bc") != nullptr) {  // 2.5
    component.parts.insert(component.parts.begin(), febio::Component());
    component.parts.front().tag = "dof";
    component.parts.front().text = attribute(element, "bc");
  }
  febio::nodal_load(reading, component, on_nodes(reading, element));
  return true;
}

void read_load(Reading& reading, const XMLElement& element) {
  const febio::Component component = component_of(reading, element);
  if (component.tag == "rigid_load") febio::check_words(reading, febio::Place::Rigid, component);
  if (febio::rigid_condition(reading, component, steps_of(reading))) return;
  if (component.tag == "nodal_load" && nodal_load(reading, element, component)) return;
  febio::other_load(reading, component);
}

void read_loads(Reading& reading, const XMLElement& section) {
  for (const XMLElement& child : children(section)) {
    read_load(reading, child);
  }
}

void read_initial(Reading& reading, const XMLElement& section) {
  for (const XMLElement& child : children(section)) {
    febio::initial_condition(reading, component_of(reading, child));
  }
}

void read_constraint(Reading& reading, const XMLElement& element) {
  const febio::Component component = component_of(reading, element);
  const std::string& type = component.type;
  febio::check_words(reading, febio::Place::Rigid, component);
  if (std::string_view(element.Name()) != "constraint") {
    unsupported(reading, element, fmt::format("<{}> in Constraints", element.Name()), "expected <constraint type=>");
  } else if (type.empty()) {
    name_connector_again(reading, element);
  } else if (type == "symmetry plane") {
    reading.connector_names.insert(component.name);
    febio::symmetry_plane(reading, component, find_name(reading.surface_index, attribute(element, "surface")),
                          steps_of(reading));
  } else if (!rigid_connector(reading, component)) {
    febio::other_constraint(reading, component);
  }
}

void read_constraints(Reading& reading, const XMLElement& section) {
  for (const XMLElement& child : children(section)) {
    read_constraint(reading, child);
  }
}

}  // namespace dea::feb

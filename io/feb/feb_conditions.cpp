// Conditions: held nodes, rigid bodies and what joins them, contacts, loads. Where they stand, on which nodes, and in
// which steps they act; what they are: io/febio.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "io/feb/feb_reading.h"
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
  const febio::Component component = checked(reading, febio::Place::Boundary, element);
  febio::prescribe_nodes(reading, on_nodes(reading, element), dof, febio::find(component, value),
                         febio::flag_of(reading, component, "relative"));
}

void rigid_nodes(Reading& reading, const XMLElement& element, const std::string& body) {
  checked(reading, febio::Place::Boundary, element);
  reading.model.rigid_nodes.push_back({{reading.step, name_of(element), origin_of(reading, element)},
                                       need_rigid(reading, element, body),
                                       nodes_of(reading, element)});
}

// -- rigid bodies, and what joins them -----------------------------------------------------------------

bool rigid_connector(Reading& reading, const febio::Component& component) {
  reading.connector_names.insert(component.name);
  const std::size_t before = reading.model.rigid_loads.size();
  if (!febio::rigid_connector(reading, component, steps_of(reading))) return false;
  for (std::size_t i = before; i < reading.model.rigid_loads.size(); ++i)
    reading.moments_of[component.name].push_back(i);
  return true;
}

void read_rigid(Reading& reading, const XMLElement& element) {
  const febio::Component component = checked(reading, febio::Place::Rigid, element);
  if (febio::rigid_condition(reading, component, steps_of(reading)) || rigid_connector(reading, component)) return;
  unsupported_word(reading, element, fmt::format("{} {}", element.Name(), quote(component.type)),
                   febio::WordOf::RigidCondition, component.type);
}

// -- contact -----------------------------------------------------------------------------------------

namespace {

/// Position of the element's word, or a fault that lists them.
int need_word(const Reading& reading, const XMLElement& element, std::initializer_list<const char*> words) {
  const int position = febio::place_of_word(text_of(element), words);
  if (position >= 0) return position;
  fail(reading, element,
       fmt::format("{} = {}, expected one of {}", element.Name(), quote(trim(text_of(element))),
                   fmt::join(words, ", ")));
}

/// primary_E, secondary_thickness and so on; false: the element is none of these.
bool read_dea_layer(Reading& reading, const XMLElement& element, DeaContact& dea) {
  const std::string tag = element.Name();
  const int side = tag.rfind("primary_", 0) == 0 ? 0 : tag.rfind("secondary_", 0) == 0 ? 1 : -1;
  if (side < 0) return false;
  DeaLayer& layer = dea.layers[side];
  const std::string what = tag.substr(tag.find('_') + 1);
  if (!one_of(what, {"E", "nu", "thickness"})) return false;
  const std::string type = attribute(element, "type");
  const auto need = [&](bool good, double value, const char* needed) {
    if (!good) fail(reading, element, fmt::format("{} = {:g}, need {}", tag, value, needed));
    return value;
  };
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
  for (const int index : {primary, secondary}) {
    const Surface& surface = reading.model.surfaces[at(index)];
    if (surface.size() == 0) {
      fail(reading, element,
           fmt::format("contact {} uses surface {}, which has no facets: define it again, or take the contact out",
                       quote(name_of(element)), quote(surface.name)));
    }
  }
  Contact contact = febio::contact_of(reading, checked(reading, febio::Place::Contact, element));
  contact.primary = primary;
  contact.secondary = secondary;
  if (contact.type == "dea") contact.dea = read_dea(reading, element);
  contact.step = reading.step;
  contact.origin = origin_of(reading, element);
  reading.model.contacts.push_back(std::move(contact));
}

void read_contact(Reading& reading, const XMLElement& element) {
  if (std::string_view(element.Name()) != "contact")
    return unsupported(reading, element, fmt::format("<{}> in Contact", element.Name()),
                       "expected <contact type= surface_pair=>");
  const std::string type = need_attribute(reading, element, "type");
  if (!febio::contact_kind(type))
    return unsupported_word(reading, element, fmt::format("contact {}", quote(type)), febio::WordOf::Contact, type);
  const SurfacePair pair = need_named(reading, element, "surface_pair", "SurfacePair", reading.surface_pairs);
  add_contact(reading, element, pair.primary, pair.secondary);
}

// -- loads and the rest ------------------------------------------------------------------------------

namespace {

/// A load on nodes of 2.5 and later; false: none.
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

}  // namespace

void read_load(Reading& reading, const XMLElement& element) {
  const febio::Component component = component_of(reading, element);
  if (component.tag == "rigid_load") febio::check_words(reading, febio::Place::Rigid, component);
  if (febio::rigid_condition(reading, component, steps_of(reading))) return;
  if (component.tag == "nodal_load" && nodal_load(reading, element, component)) return;
  febio::other_load(reading, component);
}

void read_initial(Reading& reading, const XMLElement& element) {
  febio::initial_condition(reading, component_of(reading, element));
}

namespace {

/// A constraint without a type: the one of this name acts in this step too; one given outside steps only where steps
/// name it, as in FEBio.
void name_connector_again(Reading& reading, const XMLElement& element) {
  const std::string name = need_attribute(reading, element, "name");
  if (reading.connector_names.count(name) == 0)
    fail(reading, element,
         fmt::format("<constraint name={}> without a type, expected the name of a constraint above it", quote(name)));
  if (reading.step < 0) return;
  const auto act_too = [&](auto& list, std::size_t i) {
    if (list[i].step == reading.step) return;
    if (list[i].step < 0) {  // of all steps until a step names it
      list[i].step = reading.step;
      return;
    }
    auto again = list[i];
    again.step = reading.step;
    list.push_back(std::move(again));
  };
  const auto in_this_step = [&](auto& list) {
    for (std::size_t i = list.size(); i-- > 0;)
      if (list[i].name == name) return act_too(list, i);
  };
  const auto moments = reading.moments_of.find(name);  // of a spherical joint: loads of their own
  if (moments != reading.moments_of.end()) {
    std::vector<std::size_t> now;
    for (const std::size_t i : moments->second) {
      const std::size_t before = reading.model.rigid_loads.size();
      act_too(reading.model.rigid_loads, i);
      now.push_back(reading.model.rigid_loads.size() > before ? before : i);
    }
    moments->second = now;
  }
  in_this_step(reading.model.rigid_springs);
  in_this_step(reading.model.rigid_joints);
  in_this_step(reading.model.rigid_axial_forces);
}

}  // namespace

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

// -- Boundary of 3.0 and 4.0 ---------------------------------------------------------------------------

namespace {

/// How remarks call it.
std::string boundary_condition(const XMLElement& element, const std::string& type) {
  return type.empty() ? fmt::format("<{}> in Boundary", element.Name()) : fmt::format("bc {}", quote(type));
}

/// Types fix and prescribe.
void read_bc_30(Reading& reading, const XMLElement& element) {
  const std::string type = attribute(element, "type");
  if (type == "fix") {
    checked(reading, febio::Place::Boundary, element);
    febio::fix_nodes(reading, on_nodes(reading, element), child_text(element, "dofs"));
  } else if (type == "prescribe") {
    prescribe_nodes(reading, element, child_text(element, "dof"), "scale");
  } else if (type == "rigid") {
    rigid_nodes(reading, element, child_text(element, "rb"));
  } else {
    unsupported_word(reading, element, boundary_condition(element, type), febio::WordOf::Boundary, type);
  }
}

/// Types in words, one flag per fixed dof.
void read_bc_40(Reading& reading, const XMLElement& element) {
  const std::string type = attribute(element, "type");
  if (type == "zero displacement") {
    const febio::Component component = checked(reading, febio::Place::Boundary, element);
    febio::zero_displacement(reading, component, on_nodes(reading, element));
  } else if (type == "prescribed displacement") {
    prescribe_nodes(reading, element, child_text(element, "dof"), "value");
  } else if (type == "rigid") {
    rigid_nodes(reading, element, child_text(element, "rb"));
  } else {
    febio::other_boundary_condition(reading, component_of(reading, element), boundary_condition(element, type));
  }
}

}  // namespace

const Rules kRules30{.version = "3.0", .boundary = {.others = read_bc_30}};
const Rules kRules40{.version = "4.0", .boundary = {.others = read_bc_40}};

}  // namespace dea::feb

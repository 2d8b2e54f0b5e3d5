// What is special in version 1.2: elements by tag with a material each, contacts and springs in Boundary, trans_ and
// rot_.
#include <fmt/format.h>

#include <map>

#include "io/feb/feb_reading.h"

namespace dea::feb {
namespace {

/// Elements of one shape and one material become a domain; ids are counted anew, as FEBio does.
void read_mixed_elements(Reading& reading, const XMLElement& section) {
  JointModel& model = reading.model;
  std::map<std::pair<int, ElementShape>, int> domains;
  for (std::size_t i = 0; i < model.domains.size(); ++i) {
    domains[{model.domains[i].material, model.domains[i].shape}] = static_cast<int>(i);
  }
  for (const XMLElement& child : children(section)) {
    const std::string type = child.Name();
    const auto shape = shape_of(type);
    if (!shape) {
      fail(reading, child,
           fmt::format("element type {} is unknown, expected one like hex8, tet4, tet10, penta6, quad4, tri3",
                       quote(type)));
    }
    const std::string mat = need_attribute(reading, child, "mat");
    const auto id = whole_int(mat);
    int material = -1;
    for (std::size_t i = 0; i < model.materials.size() && id; ++i) {
      if (model.materials[i].id == *id) material = static_cast<int>(i);
    }
    if (material < 0) {
      fail(reading, child, fmt::format("<{}> with mat = {}, expected the id of a material", type, quote(mat)));
    }
    const auto [place, is_new] =
        domains.try_emplace(std::make_pair(material, *shape), static_cast<int>(model.domains.size()));
    if (is_new) {
      Domain domain;
      domain.shape = *shape;
      domain.material = material;
      domain.origin = origin_of(reading, child);
      model.domains.push_back(std::move(domain));
      reading.first_element.push_back(reading.elements.size());
    }
    Domain& domain = model.domains[static_cast<std::size_t>(place->second)];
    const int number = reading.elements.size() + 1;
    reading.elements.add(number);
    reading.element_places.push_back({place->second, static_cast<int>(domain.element_ids.size())});
    append_element(reading, child, type, number, domain);
  }
}

void read_geometry(Reading& reading, const XMLElement& section) {
  read_children(reading, section,
                {{"Nodes", read_nodes},
                 {"Elements", read_mixed_elements},
                 {"ElementData", read_element_data},
                 {"NodeSet", read_node_set}},
                pass_over);
}

void read_boundary(Reading& reading, const XMLElement& section) {
  read_children(reading, section,
                {{"fix", read_old_fix},
                 {"prescribe", read_old_prescribe},
                 {"contact", read_old_contact},
                 {"spring", read_old_spring}});
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

void read_body(Reading& reading, const XMLElement& section) {
  const int material = need_rigid(reading, section, need_attribute(reading, section, "mat"));
  const std::string name = attribute(section, "name");
  RigidFixed fixed{{reading.step, name, origin_of(reading, section)}, material};
  bool any_fixed = false;
  for (const XMLElement& child : children(section)) {
    const int dof = dof_of(child.Name());
    if (dof < 0) {
      unsupported(reading, child, fmt::format("<{}> in rigid_body", child.Name()),
                  "expected trans_x, trans_y, trans_z, rot_x, rot_y or rot_z");
      continue;
    }
    const std::string type = need_attribute(reading, child, "type");
    if (type == "fixed") {
      fixed.dofs[static_cast<std::size_t>(dof)] = any_fixed = true;
    } else if (type == "prescribed") {
      reading.model.rigid_prescribed.push_back({{reading.step, name, origin_of(reading, child)},
                                                material,
                                                dof,
                                                read_scaled(reading, child),
                                                is_relative(reading, child)});
    } else if (type == "force") {
      reading.model.rigid_loads.push_back(rigid_load(reading, child, material, dof, name));
    } else {
      fail(reading, child,
           fmt::format("{} with type {}, expected fixed, prescribed or force", child.Name(), quote(type)));
    }
  }
  if (any_fixed) febio::add_old_fix(reading, std::move(fixed));
}

void read_constraints_12(Reading& reading, const XMLElement& section) {
  read_children(reading, section, {{"rigid_body", read_body}}, read_constraint);
}

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

void read_loads_12(Reading& reading, const XMLElement& section) {
  static constexpr SectionReader heat = [](Reading& r, const XMLElement& e) { ignore(r, e, "heat_source"); };
  read_children(reading, section,
                {{"force", read_old_nodal_force}, {"heat_source", heat}, {"body_force", read_body_force}},
                read_surface_load);
}

}  // namespace

const Rules kRules12{.version = "1.2",
                     .up_to_25 = true,
                     .unique_materials = false,
                     .mesh = read_geometry,
                     .boundary = read_boundary,
                     .constraints = read_constraints_12,
                     .loads = read_loads_12};

}  // namespace dea::feb

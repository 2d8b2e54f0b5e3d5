#include "io/convert/write_feb.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "io/febio/febio_text.h"
#include "io/files/encoded_text.h"
#include "src/base/names.h"
#include "src/base/numbers.h"

namespace dea {

namespace {

/// An element to be changed is not in the model's own file.
struct NotHere {
  std::string what;
};

struct Editing {
  const JointModel& model;
  ConversionPlan& plan;
  const XmlPlaces& places;
  XmlEdits& edits;
  std::set<int> used;  ///< elements found for something
};

/// The element the reader met at this place: the first of its name on the line that was not found before.
int need_element(Editing& e, Origin origin, const std::string& name, const std::string& what) {
  if (origin.file == 0) {
    for (std::size_t i = 0; i < e.places.elements.size(); ++i) {
      const int element = static_cast<int>(i);
      if (e.places.elements[i].line != origin.line || e.places.elements[i].name != name) continue;
      if (e.used.insert(element).second) return element;
    }
  }
  throw NotHere{what};
}

int need_section(const Editing& e, const char* name) {
  const int section = e.places.child(0, name);
  if (section < 0 || e.places.at(section).attribute("from") != nullptr) throw NotHere{fmt::format("<{}>", name)};
  return section;
}

void edit_materials(Editing& e) {
  for (std::size_t i = 0; i < e.model.materials.size(); ++i) {
    const Material &before = e.model.materials[i], &after = e.plan.target.materials[i];
    if (before.rigid == after.rigid && before.center_of_mass == after.center_of_mass) continue;
    const int element = need_element(e, before.origin, "material", fmt::format("material \"{}\"", before.name));
    if (!before.rigid) {
      e.edits.set_attribute(element, "type", "rigid body");
      e.edits.set_content(element, rigid_material_lines(after));
      continue;
    }
    const std::string center = exact(*after.center_of_mass);
    const int child = e.places.child(element, "center_of_mass");
    if (child >= 0)
      e.edits.set_content(child, center);
    else
      e.edits.append_child(element, {{0, "<center_of_mass>" + center + "</center_of_mass>"}});
  }
  if (e.plan.ground < 0) return;
  e.edits.append_child(need_section(e, "Material"), material_lines(e.plan.target.materials[at(e.plan.ground)]));
}

void edit_domains(Editing& e) {
  std::set<std::string> rigid_now;
  const int section = need_section(e, "MeshDomains");
  for (std::size_t i = 0; i < e.model.domains.size(); ++i) {
    const Domain &before = e.model.domains[i], &after = e.plan.target.domains[i];
    const bool became = !e.model.materials[at(before.material < 0 ? 0 : before.material)].rigid &&
                        after.material >= 0 && e.plan.target.materials[at(after.material)].rigid;
    if (before.material < 0 || (before.material == after.material && !became)) continue;
    rigid_now.insert(before.name);
    int element = -1;
    for (int child : e.places.at(section).children)
      if (e.places.at(child).value("name") == before.name) element = child;
    if (element < 0) throw NotHere{fmt::format("domain \"{}\" in <MeshDomains>", before.name)};
    if (before.material != after.material)
      e.edits.set_attribute(element, "mat", e.plan.target.materials[at(after.material)].name);
    // a class of deformable elements ("three-field-solid") and its parameters
    if (!is_shell(before.shape) && e.places.at(element).attribute("type") != nullptr) {
      e.edits.remove_attribute(element, "type");
      e.plan.changes.push_back(fmt::format("domain \"{}\": type \"{}\" taken out, it is one of deformable elements",
                                           before.name, e.places.at(element).value("type")));
    }
    if (!is_shell(before.shape) && !e.places.at(element).children.empty()) {
      e.edits.set_content(element, std::string());
      e.plan.changes.push_back(
          fmt::format("domain \"{}\": its parameters taken out, they are of deformable elements", before.name));
    }
  }
  // Directions of fibres and axes of a deformable material: the rigid one has none to give them to.
  for (int data : e.places.children(0, "MeshData")) {
    for (int child : e.places.children(data, "ElementData")) {
      const XmlPlace& place = e.places.at(child);
      const std::string type = place.value("type");
      const bool direction = type == "mat_axis" || type == "fiber" || type.find(".fiber") != type.npos;
      if (!direction || rigid_now.count(place.value("elem_set")) == 0) continue;
      e.edits.remove(child);
      e.plan.changes.push_back(fmt::format("ElementData \"{}\" of \"{}\": taken out, its elements are rigid now", type,
                                           place.value("elem_set")));
    }
  }
}

template <class Condition>
void edit_node_conditions(Editing& e, const std::vector<Condition>& before, const std::vector<Condition>& after,
                          const std::vector<char>& gone, std::set<std::string>& taken) {
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (!gone[i] && before[i].nodes.size() == after[i].nodes.size()) continue;
    const int element = need_element(e, before[i].origin, "bc", fmt::format("condition \"{}\"", before[i].name));
    if (gone[i]) {
      e.edits.remove(element);
      continue;
    }
    const std::string name = take_free_name(e.places.at(element).value("node_set") + "_not_rigid", taken);
    std::string list;
    for (int node : after[i].nodes) list += fmt::format("{}{}", list.empty() ? "" : ",", e.model.node_ids[at(node)]);
    e.edits.append_child(need_section(e, "Mesh"),
                         {{0, fmt::format("<NodeSet name=\"{}\">{}</NodeSet>", escaped(name), list)}});
    e.edits.set_attribute(element, "node_set", name);
    e.plan.changes.push_back(fmt::format("node set \"{}\": new, what is left for \"{}\"", name, before[i].name));
  }
}

void edit_conditions(Editing& e) {
  std::set<std::string> taken;
  for (const NodeSet& s : e.model.node_sets) taken.insert(s.name);
  edit_node_conditions(e, e.model.rigid_nodes, e.plan.target.rigid_nodes, e.plan.rigid_nodes_gone, taken);
  edit_node_conditions(e, e.model.fixed_nodes, e.plan.target.fixed_nodes, e.plan.fixed_nodes_gone, taken);
  for (std::size_t i = 0; i < e.model.contacts.size(); ++i) {
    const Contact& c = e.model.contacts[i];
    if (!e.plan.contact_gone[i] && !e.plan.converted[i]) continue;
    const int element = need_element(e, c.origin, "contact", fmt::format("contact \"{}\"", c.name));
    if (e.plan.contact_gone[i]) {
      e.edits.remove(element);
      continue;
    }
    e.edits.set_attribute(element, "type", "dea");
    e.edits.set_content(element, dea_contact_lines(e.plan, e.plan.target.contacts[i]));
  }
  const auto is_rigid = [&](int node) { return e.plan.node_rigid[at(node)] != 0; };
  // Fluid pressures and concentrations given at nodes that are rigid now: FEBio refuses them there.
  for (std::size_t i = 0; i < e.places.elements.size(); ++i) {
    const XmlPlace& place = e.places.elements[i];
    const std::string type = place.value("type");
    const bool of_fluid = type.find("fluid pressure") != type.npos || type.find("concentration") != type.npos;
    if (place.name != "bc" || !of_fluid) continue;
    const auto set = std::find_if(e.model.node_sets.begin(), e.model.node_sets.end(),
                                  [&](const NodeSet& s) { return s.name == place.value("node_set"); });
    if (set == e.model.node_sets.end() || std::none_of(set->nodes.begin(), set->nodes.end(), is_rigid)) continue;
    e.edits.remove(static_cast<int>(i));
    e.plan.changes.push_back(
        fmt::format("condition \"{}\" ({}): taken out, its nodes are rigid now", place.value("name"), type));
  }
  // A plane of symmetry on nodes that are rigid now.
  for (std::size_t i = 0; i < e.places.elements.size(); ++i) {
    const XmlPlace& place = e.places.elements[i];
    if (place.name != "constraint" || place.value("type") != "symmetry plane") continue;
    const auto surface = std::find_if(e.model.surfaces.begin(), e.model.surfaces.end(),
                                      [&](const Surface& s) { return s.name == place.value("surface"); });
    if (surface == e.model.surfaces.end() || !std::all_of(surface->nodes.begin(), surface->nodes.end(), is_rigid))
      continue;
    e.edits.remove(static_cast<int>(i));
    e.plan.changes.push_back(
        fmt::format("constraint \"{}\" (symmetry plane): taken out, its surface is rigid now", place.value("name")));
  }
}

/// Thickness maps, and the conditions that hold the ground's cartilage and bones taken as rigid.
void add_sections(Editing& e) {
  XmlLines maps;
  for (std::size_t s = 0; s < e.plan.map_of_surface.size(); ++s) {
    append(maps, thickness_map_lines(e.plan, s));
  }
  const int domains = need_section(e, "MeshDomains");
  XmlLines sections;  // new ones, behind MeshDomains
  if (!maps.empty()) {
    const int data = e.places.child(0, "MeshData");
    if (data > domains && e.places.at(data).attribute("from") == nullptr)
      e.edits.append_child(data, maps);
    else
      append(sections, element_lines("MeshData", maps));
  }
  if (e.plan.target.rigid_fixed.size() > e.model.rigid_fixed.size()) {
    XmlLines held;
    for (std::size_t i = e.model.rigid_fixed.size(); i < e.plan.target.rigid_fixed.size(); ++i)
      append(held, rigid_fixed_lines(e.plan.target, e.plan.target.rigid_fixed[i]));
    const int rigid = e.places.child(0, "Rigid"), step = e.places.child(0, "Step");
    if (rigid >= 0 && (step < 0 || rigid < step) && e.places.at(rigid).attribute("from") == nullptr)
      e.edits.append_child(rigid, held);
    else
      append(sections, element_lines("Rigid", held));
  }
  if (!sections.empty()) e.edits.insert_after(domains, sections);
}

/// The linear solver of a <solver> is the one asked for, else its own. Returns its name; "": none is named.
std::string edit_linear_solver(Editing& e, int solver) {
  const std::string& wanted = e.plan.linear_solver.type;
  const int own = e.places.child(solver, "linear_solver");
  if (own < 0) {
    if (!wanted.empty()) e.edits.append_child(solver, linear_solver_lines(e.plan.linear_solver));
    return wanted;
  }
  const XmlPlace& place = e.places.at(own);
  if (wanted.empty() || place.value("type") == wanted) return place.value("type");
  if (place.attribute("type") == nullptr) throw NotHere{"the type of a <linear_solver>"};
  e.edits.set_attribute(own, "type", wanted);
  if (!place.children.empty()) e.edits.set_content(own, std::string());
  return wanted;
}

/// One <solver>. Returns what was changed, "" if nothing.
std::string edit_solver(Editing& e, int solver) {
  std::string changed;
  const auto note = [&](const std::string& what) { changed += (changed.empty() ? "" : ", ") + what; };
  const int own = e.places.child(solver, "linear_solver");
  const std::string linear_solver = edit_linear_solver(e, solver);
  if (own < 0 ? !linear_solver.empty() : linear_solver != e.places.at(own).value("type"))
    note(fmt::format("linear_solver {}", linear_solver));
  for (const SolverParameter& p : solver_parameters(linear_solver)) {
    const int child = e.places.child(solver, p.name);
    const std::string line = fmt::format("<{0}>{1}</{0}>", p.name, p.value);
    if (child < 0) {
      e.edits.append_child(solver, {{0, line}});
    } else {
      const std::string text(febio::trim(e.places.content(child)));
      const auto now = febio::whole_double(text), wanted = febio::whole_double(p.value);
      const bool as_good = febio::same_word(text, p.value) || (*p.number != '\0' && text == p.number) ||
                           (now && wanted && p.largest && *now > 0 && *now <= *wanted) ||
                           (now && wanted && p.smallest && *now >= *wanted);
      if (as_good) continue;
      e.edits.set_content(child, p.value);
    }
    note(fmt::format("{} {}", p.name, p.value));
  }
  const int method = e.places.child(solver, "qn_method");
  if (method < 0) {
    e.edits.append_child(solver, full_newton_lines());
  } else {
    const std::string type = e.places.at(method).value("type");
    const int ups = e.places.child(method, "max_ups");
    if (!type.empty() && type != "BFGS") {
      e.edits.set_attribute(method, "type", "BFGS");
      e.edits.set_content(method, XmlLines{{0, "<max_ups>0</max_ups>"}});
    } else if (ups < 0) {
      e.edits.append_child(method, {{0, "<max_ups>0</max_ups>"}});
    } else if (febio::trim(e.places.content(ups)) == "0") {
      return changed;
    } else {
      e.edits.set_content(ups, std::string("0"));
    }
  }
  note("qn_method BFGS, max_ups 0");
  return changed;
}

/// What a new one is, in words.
std::string new_solver(const ConversionPlan& plan) {
  const std::string& linear = plan.linear_solver.type;
  return fmt::format(", full Newton, {}, tight tolerances{}", symmetric_only(linear) ? "symmetric" : "not symmetric",
                     linear.empty() ? "" : ", linear_solver " + linear);
}

std::string edit_control(Editing& e, int control) {
  if (e.places.at(control).attribute("from") != nullptr) throw NotHere{"<Control>"};
  const int solver = e.places.child(control, "solver");
  if (solver >= 0) return edit_solver(e, solver);
  e.edits.append_child(control, solver_lines(e.model.module, e.plan.linear_solver));
  return "new <solver>" + new_solver(e.plan);
}

/// The Control blocks: of the model, which the first step starts from, and of each step.
void edit_controls(Editing& e) {
  const auto said = [&](const std::string& which, const std::string& changed) {
    if (!changed.empty()) e.plan.changes.push_back(fmt::format("solver {}: {}", which, changed));
  };
  const int top = e.places.child(0, "Control");
  if (top >= 0) said("of the model", edit_control(e, top));
  std::vector<int> steps;
  for (int section : e.places.children(0, "Step")) {
    if (e.places.at(section).attribute("from") != nullptr) throw NotHere{"<Step>"};
    const std::vector<int> inside = e.places.children(section, "step");
    steps.insert(steps.end(), inside.begin(), inside.end());
    if (inside.empty() && !e.places.at(section).children.empty()) steps.push_back(section);
  }
  if (!steps.empty() && steps.size() != e.model.steps.size()) throw NotHere{"a step"};
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (e.places.at(steps[i]).attribute("from") != nullptr) throw NotHere{"a step"};
    const std::string which = fmt::format("of step {}", i + 1);
    const int control = e.places.child(steps[i], "Control");
    if (control >= 0) {
      said(which, edit_control(e, control));
    } else if (i > 0 || top < 0) {
      e.edits.append_child(steps[i], element_lines("Control", solver_lines(e.model.module, e.plan.linear_solver)));
      said(which, "new <Control>" + new_solver(e.plan));
    }
  }
  if (steps.empty() && top < 0) throw NotHere{"<Control>"};
}

void edit_output(Editing& e) {
  const int output = e.places.child(0, "Output");
  const int plotfile = output < 0 ? -1 : e.places.child(output, "plotfile");
  if (plotfile < 0) {
    e.edits.append_child(std::max(output, 0),
                         output < 0 ? element_lines("Output", plotfile_lines()) : plotfile_lines());
    e.plan.changes.push_back("plot file: new, with the variables of contact");
    return;
  }
  std::string added;
  for (const char* variable : plot_variables()) {
    bool there = false;
    for (int var : e.places.children(plotfile, "var")) {
      const XmlPlace& place = e.places.at(var);
      const std::string type = place.value("type");
      const bool everywhere = place.attribute("surface") == nullptr && place.attribute("elem_set") == nullptr;
      there = there || (everywhere && type.substr(0, type.find('=')) == variable);
    }
    if (there) continue;
    e.edits.append_child(plotfile, {{0, fmt::format("<var type=\"{}\"/>", variable)}});
    added += (added.empty() ? "" : ", ") + std::string(variable);
  }
  if (!added.empty()) e.plan.changes.push_back(fmt::format("plot file: {} added", added));
}

}  // namespace

std::optional<std::string> edit_feb(const JointModel& model, ConversionPlan& plan, const std::string& text,
                                    std::string& why) {
  const std::optional<XmlPlaces> places = find_places(text);
  if (!places) {
    why = "its XML holds what this program does not edit";
    return std::nullopt;
  }
  const std::vector<Sentence> changes = plan.changes;
  XmlEdits edits(*places);
  Editing e{model, plan, *places, edits, {}};
  try {
    edit_materials(e);
    edit_domains(e);
    edit_conditions(e);
    add_sections(e);
    edit_controls(e);
    edit_output(e);
  } catch (const NotHere& missing) {
    why = fmt::format("{} is not in this file itself", missing.what);
    plan.changes = changes;
    return std::nullopt;
  }
  return edits.apply();
}

}  // namespace dea

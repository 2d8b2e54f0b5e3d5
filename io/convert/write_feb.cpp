#include "io/convert/write_feb.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <set>

#include "io/febio/febio_rules.h"
#include "io/febio/febio_text.h"
#include "io/files/encoded_text.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"

namespace dea {

namespace {

std::string leaf(const std::string& name, const std::string& value) {
  return fmt::format("<{}>{}</{}>", name, escaped(value), name);
}

/// A rigid body where FEBio takes a number for an id and else a name.
std::string body_reference(const Material& material) {
  return febio::whole_int(material.name) ? std::to_string(material.id) : material.name;
}

/// The thickness map of a surface in any of the converted contacts.
const std::vector<double>& map_values(const ConversionPlan& plan, int surface) {
  static const std::vector<double> kNone;
  for (std::size_t i = 0; i < plan.target.contacts.size(); ++i) {
    const Contact& c = plan.target.contacts[i];
    if (!plan.converted[i]) continue;
    if (c.primary == surface) return c.dea->layers[0].thickness_map;
    if (c.secondary == surface) return c.dea->layers[1].thickness_map;
  }
  return kNone;
}

/// `<name>value</name>`, as a line.
XmlLine leaf_line(const std::string& name, const std::string& value) { return {0, leaf(name, value)}; }

/// name="...", as an attribute.
std::string named(const std::string& name) { return fmt::format("name=\"{}\"", escaped(name)); }

}  // namespace

std::string exact(double value) { return fmt::format("{}", value); }
std::string exact(const Vector3d& v) { return fmt::format("{},{},{}", v.x(), v.y(), v.z()); }

XmlLines dea_contact_lines(const ConversionPlan& plan, const Contact& contact) {
  const DeaContact& dea = *contact.dea;
  XmlLines lines = {leaf_line("law", name(*dea.law)), leaf_line("facets", name(*dea.facets)),
                    leaf_line("source", dea.source == 0 ? "primary" : "secondary"),
                    leaf_line("refine", std::to_string(*dea.refine))};
  if (!dea.symmetry_planes.empty())
    lines.push_back(leaf_line("symmetry_planes", febio::text_of_planes(dea.symmetry_planes)));
  for (std::size_t side = 0; side < 2; ++side) {
    const DeaLayer& layer = dea.layers[side];
    const std::string prefix = side == 0 ? "primary_" : "secondary_";
    if (layer.E) lines.push_back(leaf_line(prefix + "E", exact(*layer.E)));
    if (layer.nu) lines.push_back(leaf_line(prefix + "nu", exact(*layer.nu)));
    if (layer.thickness)
      lines.push_back(leaf_line(prefix + "thickness", exact(*layer.thickness)));
    else
      lines.push_back(
          {0, fmt::format("<{0}thickness type=\"map\">{1}</{0}thickness>", prefix,
                          escaped(plan.map_of_surface[at(side == 0 ? contact.primary : contact.secondary)]))});
  }
  return lines;
}

XmlLines thickness_map_lines(const ConversionPlan& plan, std::size_t index) {
  const std::string& name = plan.map_of_surface[index];
  if (name.empty()) return {};
  const Surface& surface = plan.target.surfaces[index];
  const std::vector<double>& values = map_values(plan, static_cast<int>(index));
  int largest = 0;
  for (std::size_t f = 0; f + 1 < surface.begin.size(); ++f)
    largest = std::max(largest, surface.begin[f + 1] - surface.begin[f]);
  XmlLines faces;
  for (std::size_t f = 0; f + 1 < surface.begin.size(); ++f) {
    std::string text;
    for (int k = 0; k < largest; ++k)
      text +=
          fmt::format("{}{:.17g}", k ? "," : "", values[at(std::min(surface.begin[f] + k, surface.begin[f + 1] - 1))]);
    faces.push_back({0, fmt::format("<face lid=\"{}\">{}</face>", f + 1, text)});
  }
  return element_lines(
      fmt::format("SurfaceData name=\"{}\" surface=\"{}\" data_type=\"scalar\"", escaped(name), escaped(surface.name)),
      faces);
}

XmlLines rigid_material_lines(const Material& material) {
  XmlLines lines = {leaf_line("density", exact(material.density))};
  if (material.center_of_mass) lines.push_back(leaf_line("center_of_mass", exact(*material.center_of_mass)));
  return lines;
}

XmlLines material_lines(const Material& material) {
  return element_lines(fmt::format("material id=\"{}\" {} type=\"rigid body\"", material.id, named(material.name)),
                       rigid_material_lines(material));
}

XmlLines rigid_fixed_lines(const JointModel& model, const RigidFixed& fixed) {
  constexpr const char* kFlags[kDofs] = {"Rx_dof", "Ry_dof", "Rz_dof", "Ru_dof", "Rv_dof", "Rw_dof"};
  XmlLines lines = {leaf_line("rb", body_reference(model.materials[at(fixed.material)]))};
  for (std::size_t i = 0; i < kDofs; ++i) lines.push_back(leaf_line(kFlags[i], fixed.dofs[i] ? "1" : "0"));
  return element_lines("rigid_bc " + named(fixed.name) + " type=\"rigid_fixed\"", lines);
}

std::vector<SolverParameter> solver_parameters(const std::string& linear_solver) {
  // rtol and etol are squares of forces and products, dtol is a ratio of lengths. min_residual, a square too, ends a
  // step that begins in balance, where a residual of rounding errors can become no smaller.
  const bool symmetric = symmetric_only(linear_solver);
  return {
      {"symmetric_stiffness", symmetric ? "symmetric" : "non-symmetric", symmetric ? "1" : "0", false, false},
      {"dtol", "1e-06", "", true, false},
      {"etol", "1e-08", "", true, false},
      {"rtol", "1e-10", "", true, false},
      {"min_residual", "1e-12", "", false, true},
      {"max_refs", "30", "", false, true},
  };
}

XmlLines linear_solver_lines(const LinearSolver& linear_solver) {
  const auto& [type, content] = linear_solver;
  if (type.empty()) return {};
  const std::string start = fmt::format("<linear_solver type=\"{}\"", escaped(type));
  return {{0, content.empty() ? start + "/>" : start + ">" + content + "</linear_solver>"}};
}

XmlLines full_newton_lines() { return element_lines("qn_method type=\"BFGS\"", {leaf_line("max_ups", "0")}); }

XmlLines solver_lines(const std::string& module, const LinearSolver& linear_solver) {
  XmlLines lines;
  for (const SolverParameter& p : solver_parameters(linear_solver.type)) lines.push_back(leaf_line(p.name, p.value));
  append(lines, full_newton_lines());
  append(lines, linear_solver_lines(linear_solver));
  return element_lines(fmt::format("solver type=\"{}\"", module.empty() ? "solid" : escaped(module)), lines);
}

const std::vector<const char*>& plot_variables() {
  static const std::vector<const char*> kVariables = {"contact pressure", "contact gap",         "contact force",
                                                      "contact area",     "cartilage thickness", "joint space",
                                                      "spring strain"};
  return kVariables;
}

XmlLines plotfile_lines() {
  std::vector<const char*> variables = plot_variables();
  variables.insert(variables.begin(), "displacement");
  variables.insert(variables.end(), {"rigid force", "rigid position"});
  XmlLines lines;
  for (const char* variable : variables) lines.push_back({0, fmt::format("<var type=\"{}\"/>", variable)});
  return element_lines("plotfile type=\"febio\"", lines);
}

namespace {

/// Everything written anew is on its way into one text, a section at a time.
struct Writer {
  const ConversionPlan& plan;
  std::vector<std::string>& dropped;
  JointModel model;  ///< with names and ids as they are written
  std::string text = {};
  std::vector<char> domain_kept = {};
  std::vector<int> node_order = {};  ///< by id
  std::vector<std::string> domain_names = {};
  std::vector<std::string> pair_of_contact = {};
  std::vector<int> controller_id = {};  ///< per controller: as written, 0: not written
  int dtmax_controllers = 0;
  int discrete_materials = 0;
  std::vector<std::vector<double>> dtmax_points =
      {};  ///< per step that has must points, for controllers behind the others

  void line(int depth, const std::string& what) { text += std::string(at(depth), '\t') + what + "\n"; }
  void lines(int depth, const XmlLines& all) {
    for (const XmlLine& one : all) line(depth + one.depth, one.text);
  }
  int node_id(int node) const { return model.node_ids[at(node)]; }
};

void drop(Writer& w, const std::string& what) { w.dropped.push_back(what); }

void write_materials(Writer& w) {
  w.line(1, "<Material>");
  int id = 0;
  for (Material& m : w.model.materials) {
    if (!m.rigid) {
      drop(w, fmt::format("material \"{}\" ({})", m.name, m.type));
      continue;
    }
    m.id = ++id;
    w.lines(2, material_lines(m));
  }
  w.line(1, "</Material>");
}

std::string list(const Writer& w, const int* nodes, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += fmt::format("{}{}", i ? "," : "", w.node_id(nodes[i]));
  return text;
}

void write_nodes(Writer& w) {
  const JointModel& m = w.model;
  w.node_order.resize(m.nodes.size());
  std::iota(w.node_order.begin(), w.node_order.end(), 0);
  std::sort(w.node_order.begin(), w.node_order.end(), [&](int a, int b) { return w.node_id(a) < w.node_id(b); });
  w.line(2, "<Nodes name=\"all_nodes\">");
  for (int n : w.node_order) w.line(3, fmt::format("<node id=\"{}\">{}</node>", w.node_id(n), exact(m.nodes[at(n)])));
  w.line(2, "</Nodes>");
}

void write_elements(Writer& w) {
  std::set<std::string> names;
  for (const Domain& d : w.model.domains) {
    const bool kept =
        d.material >= 0 && w.model.materials[at(d.material)].rigid && !is_line(d.shape) && !d.element_ids.empty();
    w.domain_kept.push_back(kept);
    w.domain_names.push_back(kept ? take_free_name(d.name.empty() ? "part" : d.name, names) : d.name);
    if (!kept) {
      drop(w, fmt::format("elements \"{}\" ({})", d.name, d.element_ids.size()));
      continue;
    }
    const std::size_t n = at(nodes_per_element(d.shape));
    std::vector<std::size_t> order(d.element_ids.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return d.element_ids[a] < d.element_ids[b]; });
    w.line(2, fmt::format("<Elements type=\"{}\" name=\"{}\">", element_type(d.shape).name,
                          escaped(w.domain_names.back())));
    for (std::size_t e : order)
      w.line(3, fmt::format("<elem id=\"{}\">{}</elem>", d.element_ids[e], list(w, d.nodes.data() + e * n, n)));
    w.line(2, "</Elements>");
  }
}

void write_surfaces(Writer& w) {
  for (const Surface& s : w.model.surfaces) {
    w.line(2, fmt::format("<Surface name=\"{}\">", escaped(s.name)));
    for (std::size_t f = 0; f + 1 < s.begin.size(); ++f) {
      const int count = s.begin[f + 1] - s.begin[f];
      w.line(3, fmt::format("<{0}{1} id=\"{2}\">{3}</{0}{1}>", count % 4 == 0 || count == 9 ? "quad" : "tri", count,
                            f + 1, list(w, s.nodes.data() + s.begin[f], at(count))));
    }
    w.line(2, "</Surface>");
  }
}

/// Node sets of the model, and one per condition on nodes that stays. Conditions on nodes of parts that are left out,
/// and nodes nothing is fastened to, are left out.
struct NodeCondition {
  std::string set;
  bool fixed = false;
  std::size_t index = 0;
};

std::vector<NodeCondition> write_node_sets(Writer& w) {
  std::set<std::string> names = {"all_nodes"};
  for (const NodeSet& s : w.model.node_sets) {
    if (s.nodes.empty() || !names.insert(s.name).second) continue;
    w.line(2,
           fmt::format("<NodeSet name=\"{}\">{}</NodeSet>", escaped(s.name), list(w, s.nodes.data(), s.nodes.size())));
  }
  std::set<int> fastened;
  for (const DiscreteSet& s : w.model.discrete_sets)
    for (const auto& pair : s.pairs) fastened.insert(pair.begin(), pair.end());
  std::vector<NodeCondition> conditions;
  const auto keep = [&](auto& list_of, const std::vector<char>& gone, bool fixed, const char* what) {
    for (std::size_t i = 0; i < list_of.size(); ++i) {
      if (gone[i]) continue;
      std::vector<int>& nodes = list_of[i].nodes;
      std::erase_if(nodes, [&](int n) { return fastened.count(n) == 0 || w.plan.node_rigid[at(n)]; });
      if (nodes.empty()) {
        drop(w, fmt::format("{} \"{}\"", what, list_of[i].name));
        continue;
      }
      const std::string set = take_free_name(list_of[i].name.empty() ? "held_nodes" : list_of[i].name, names);
      w.line(2, fmt::format("<NodeSet name=\"{}\">{}</NodeSet>", escaped(set), list(w, nodes.data(), nodes.size())));
      conditions.push_back({set, fixed, i});
    }
  };
  keep(w.model.rigid_nodes, w.plan.rigid_nodes_gone, false, "rigid node set");
  keep(w.model.fixed_nodes, w.plan.fixed_nodes_gone, true, "fixed nodes");
  for (const PrescribedNodes& p : w.model.prescribed_nodes)
    drop(w, fmt::format("prescribed displacement \"{}\"", p.name));
  return conditions;
}

void write_pairs(Writer& w) {
  std::set<std::string> names;
  w.pair_of_contact.assign(w.model.contacts.size(), "");
  for (std::size_t i = 0; i < w.model.contacts.size(); ++i) {
    const Contact& c = w.model.contacts[i];
    if (!c.dea) {
      if (!w.plan.contact_gone[i]) drop(w, fmt::format("contact \"{}\" ({})", c.name, c.type));
      continue;
    }
    w.pair_of_contact[i] = take_free_name(c.name.empty() ? "joint" : c.name, names);
    w.lines(2, element_lines("SurfacePair " + named(w.pair_of_contact[i]),
                             {leaf_line("primary", w.model.surfaces[at(c.primary)].name),
                              leaf_line("secondary", w.model.surfaces[at(c.secondary)].name)}));
  }
  for (const DiscreteSet& s : w.model.discrete_sets) {
    w.line(2, fmt::format("<DiscreteSet name=\"{}\">", escaped(s.name)));
    for (const auto& pair : s.pairs) w.line(3, fmt::format("<delem>{}</delem>", list(w, pair.data(), 2)));
    w.line(2, "</DiscreteSet>");
  }
}

bool uniform(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [&](double v) { return v == values.front(); });
}

void write_domains(Writer& w) {
  w.line(1, "<MeshDomains>");
  for (std::size_t i = 0; i < w.model.domains.size(); ++i) {
    if (!w.domain_kept[i]) continue;
    const Domain& d = w.model.domains[i];
    const std::string start = fmt::format("{} {} mat=\"{}\"", is_shell(d.shape) ? "ShellDomain" : "SolidDomain",
                                          named(w.domain_names[i]), escaped(w.model.materials[at(d.material)].name));
    if (is_shell(d.shape) && (d.shell_thickness.empty() || uniform(d.shell_thickness)))
      w.lines(2, element_lines(start, {leaf_line("shell_thickness",
                                                 exact(d.shell_thickness.empty() ? 0.0 : d.shell_thickness.front()))}));
    else
      w.line(2, "<" + start + "/>");
  }
  w.line(1, "</MeshDomains>");

  w.line(1, "<MeshData>");
  for (std::size_t i = 0; i < w.model.domains.size(); ++i) {
    const Domain& d = w.model.domains[i];
    if (!w.domain_kept[i] || d.shell_thickness.empty() || uniform(d.shell_thickness)) continue;
    w.line(2, fmt::format("<ElementData type=\"shell thickness\" elem_set=\"{}\">", escaped(w.domain_names[i])));
    const std::size_t n = at(nodes_per_element(d.shape));
    for (std::size_t e = 0; e < d.element_ids.size(); ++e) {
      std::string values;
      for (std::size_t k = 0; k < n; ++k) values += fmt::format("{}{}", k ? "," : "", d.shell_thickness[e * n + k]);
      w.line(3, fmt::format("<e lid=\"{}\">{}</e>", e + 1, values));
    }
    w.line(2, "</ElementData>");
  }
  for (std::size_t s = 0; s < w.plan.map_of_surface.size(); ++s) w.lines(2, thickness_map_lines(w.plan, s));
  w.line(1, "</MeshData>");
}

std::string body(const Writer& w, int material) { return body_reference(w.model.materials[at(material)]); }

std::string scaled(const Writer& w, const Scaled& s) {
  const std::string lc = s.controller < 0 ? "" : fmt::format(" lc=\"{}\"", w.controller_id[at(s.controller)]);
  return fmt::format("<value{}>{}</value>", lc, exact(s.factor));
}

XmlLines rigid_lines(const Writer& w, int step) {
  constexpr const char* kForces[kDofs] = {"Rx", "Ry", "Rz", "Ru", "Rv", "Rw"};
  XmlLines lines;
  for (const RigidFixed& f : w.model.rigid_fixed)
    if (f.step == step) append(lines, rigid_fixed_lines(w.model, f));
  const auto add = [&](const char* tag, const auto& condition, const char* type, const XmlLines& parameters) {
    if (condition.step == step)
      append(lines, element_lines(fmt::format("{} {} type=\"{}\"", tag, named(condition.name), type), parameters));
  };
  for (const RigidPrescribed& p : w.model.rigid_prescribed)
    add("rigid_bc", p, p.dof < 3 ? "rigid_displacement" : "rigid_rotation",
        {leaf_line("rb", body(w, p.material)),
         leaf_line("dof", p.dof < 3 ? kDofNames[p.dof] : kForces[p.dof]),
         {0, scaled(w, p.value)},
         leaf_line("relative", p.relative ? "1" : "0")});
  for (const RigidLoad& l : w.model.rigid_loads)
    add("rigid_load", l, l.dof < 3 ? "rigid_force" : "rigid_moment",
        {leaf_line("rb", body(w, l.material)),
         leaf_line("dof", kForces[l.dof]),
         {0, scaled(w, l.value)},
         leaf_line("load_type", word_of(l.kind, {"LOAD", "FOLLOW", "TARGET"})),
         leaf_line("relative", l.relative ? "1" : "0")});
  for (const RigidSpring& s : w.model.rigid_springs)
    add("rigid_connector", s, "rigid spring",
        {leaf_line("body_a", body(w, s.material_a)), leaf_line("body_b", body(w, s.material_b)),
         leaf_line("k", exact(s.k)), leaf_line("insertion_a", exact(s.insertion_a)),
         leaf_line("insertion_b", exact(s.insertion_b)), leaf_line("free_length", exact(s.free_length))});
  return lines;
}

/// The sections Boundary, Rigid, Contact and Discrete of one step, or of all (-1).
void write_conditions(Writer& w, int depth, int step, const std::vector<NodeCondition>& on_nodes) {
  const auto section = [&](const char* name, const XmlLines& lines) {
    if (!lines.empty()) w.lines(depth, element_lines(name, lines));
  };
  XmlLines boundary;
  const auto add = [&](const auto& condition, const NodeCondition& on, const char* type, const XmlLines& parameters) {
    if (condition.step == step)
      append(boundary, element_lines(fmt::format("bc {} type=\"{}\" node_set=\"{}\"", named(condition.name), type,
                                                 escaped(on.set)),
                                     parameters));
  };
  for (const NodeCondition& c : on_nodes) {
    if (c.fixed) {
      const FixedNodes& f = w.model.fixed_nodes[c.index];
      XmlLines flags;
      for (std::size_t k = 0; k < 3; ++k)
        flags.push_back(leaf_line(fmt::format("{}_dof", kDofNames[k]), f.xyz[k] ? "1" : "0"));
      add(f, c, "zero displacement", flags);
    } else {
      const RigidNodes& r = w.model.rigid_nodes[c.index];
      add(r, c, "rigid", {leaf_line("rb", body(w, r.material))});
    }
  }
  section("Boundary", boundary);
  section("Rigid", rigid_lines(w, step));

  XmlLines contact;
  for (std::size_t i = 0; i < w.model.contacts.size(); ++i) {
    const Contact& c = w.model.contacts[i];
    if (c.dea && c.step == step)
      append(contact, element_lines(fmt::format("contact {} type=\"dea\" surface_pair=\"{}\"", named(c.name),
                                                escaped(w.pair_of_contact[i])),
                                    dea_contact_lines(w.plan, c)));
  }
  section("Contact", contact);

  XmlLines discrete;
  for (const DiscreteSprings& s : w.model.discrete_springs) {
    if (s.step != step) continue;
    ++w.discrete_materials;
    append(discrete,
           element_lines(fmt::format("discrete_material id=\"{}\" {} type=\"{}\"", w.discrete_materials, named(s.name),
                                     s.tension_only ? "tension-only linear spring" : "linear spring"),
                         {leaf_line("E", exact(s.stiffness))}));
    discrete.push_back({0, fmt::format("<discrete dmat=\"{}\" discrete_set=\"{}\"/>", w.discrete_materials,
                                       escaped(w.model.discrete_sets[at(s.set)].name))});
  }
  section("Discrete", discrete);
}

void choose_controllers(Writer& w) {
  std::set<int> used;
  for (const RigidPrescribed& p : w.model.rigid_prescribed) used.insert(p.value.controller);
  for (const RigidLoad& l : w.model.rigid_loads) used.insert(l.value.controller);
  int id = 0;
  for (std::size_t i = 0; i < w.model.controllers.size(); ++i) {
    const LoadController& c = w.model.controllers[i];
    const bool kept = used.count(static_cast<int>(i)) > 0;
    w.controller_id.push_back(kept ? ++id : 0);
    if (!kept) drop(w, fmt::format("load controller {}: nothing follows it here", c.id));
  }
  w.dtmax_controllers = id;
}

void write_steps(Writer& w, const std::vector<NodeCondition>& on_nodes) {
  w.line(1, "<Step>");
  for (std::size_t i = 0; i < w.model.steps.size(); ++i) {
    const Step& s = w.model.steps[i];
    w.line(2, fmt::format("<step id=\"{}\" name=\"{}\">", i + 1,
                          escaped(s.name.empty() ? fmt::format("Step{:02}", i + 1) : s.name)));
    XmlLines control = {leaf_line("analysis", "STATIC")};
    // FEBio ends a step after its number of steps, or at its final time where must points make steps of other sizes.
    const double steps = std::round(s.duration / s.step_size);
    const bool whole = std::abs(steps * s.step_size - s.duration) <= 1e-9 * s.duration;
    control.push_back(leaf_line("time_steps", whole ? exact(steps) : "-1"));
    if (!whole) control.push_back(leaf_line("final_time", exact(s.duration)));
    control.push_back(leaf_line("step_size", exact(s.step_size)));
    XmlLines stepper = {leaf_line("max_retries", "10"), leaf_line("opt_iter", "20"),
                        leaf_line("dtmin", exact(s.step_size / 1000))};
    std::string lc;
    if (!s.must_points.empty()) {
      w.dtmax_points.push_back(s.must_points);
      lc = fmt::format(" lc=\"{}\"", w.dtmax_controllers + static_cast<int>(w.dtmax_points.size()));
    }
    stepper.push_back({0, fmt::format("<dtmax{}>{}</dtmax>", lc, exact(s.step_size))});
    append(control, element_lines("time_stepper type=\"default\"", stepper));
    append(control, solver_lines("solid", w.plan.linear_solver));
    w.lines(3, element_lines("Control", control));
    write_conditions(w, 3, static_cast<int>(i), on_nodes);
    w.line(2, "</step>");
  }
  w.line(1, "</Step>");
}

void write_load_data(Writer& w) {
  std::vector<LoadController> curves;
  for (std::size_t i = 0; i < w.model.controllers.size(); ++i)
    if (w.controller_id[i] > 0) curves.push_back(w.model.controllers[i]);
  for (const auto& times : w.dtmax_points) {
    LoadController curve;
    curve.name = "must points";
    for (double t : times) curve.points.push_back({t, 1.0});
    curves.push_back(curve);
  }
  XmlLines lines;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const LoadController& c = curves[i];
    const bool math = !c.expression.empty();
    XmlLines content = {leaf_line("math", c.expression)};
    if (!math) {
      XmlLines points;
      for (const auto& p : c.points) points.push_back({0, fmt::format("<pt>{},{}</pt>", p[0], p[1])});
      content = {
          leaf_line("interpolate", word_of(c.interpolate, {"LINEAR", "STEP", "SMOOTH", "CUBIC SPLINE", "CONTROL POINTS",
                                                           "APPROXIMATION", "SMOOTH STEP", "C2-SMOOTH"})),
          leaf_line("extend", word_of(c.extend, {"CONSTANT", "EXTRAPOLATE", "REPEAT", "REPEAT OFFSET"}))};
      append(content, element_lines("points", points));
    }
    append(lines, element_lines(fmt::format("load_controller id=\"{}\" {} type=\"{}\"", i + 1,
                                            named(c.name.empty() ? fmt::format("LC{}", i + 1) : c.name),
                                            math ? "math" : "loadcurve"),
                                content));
  }
  if (!lines.empty()) w.lines(1, element_lines("LoadData", lines));
}

/// What is read, but has no lines here: rather no file than one without it.
void refuse_unwritable(const JointModel& model) {
  const auto refuse = [&](Origin origin, const std::string& what) {
    throw fault_at(model, origin,
                   fmt::format("{} cannot be written into a new file: save the model as 4.0 in FEBio Studio, then "
                               "dea convert leaves it as it is",
                               what));
  };
  for (const RigidJoint& j : model.rigid_joints) refuse(j.origin, j.type);
  for (const RigidFollower& f : model.rigid_followers) refuse(f.origin, "a follower force or moment");
  for (const RigidAxialForce& f : model.rigid_axial_forces) refuse(f.origin, "a force between two bodies");
  for (const RigidCable& c : model.rigid_cables) refuse(c.origin, "a rigid cable");
  for (const NodalForce& f : model.nodal_forces) refuse(f.origin, "a nodal load");
  for (const DiscreteSprings& s : model.discrete_springs) {
    if (s.force) refuse(s.origin, "a nonlinear spring");
  }
}

}  // namespace

std::string write_feb(const JointModel& model, const ConversionPlan& plan, const std::string& encoding,
                      std::vector<std::string>& dropped) {
  refuse_unwritable(model);
  Writer w{plan, dropped, plan.target};
  w.line(0, fmt::format("<?xml version=\"1.0\" encoding=\"{}\"?>", encoding));
  w.line(0, "<febio_spec version=\"4.0\">");
  if (model.units.empty())
    w.line(1, "<Module type=\"solid\"/>");
  else
    w.lines(1, element_lines("Module type=\"solid\"", {leaf_line("units", model.units)}));
  write_materials(w);
  w.line(1, "<Mesh>");
  write_nodes(w);
  write_elements(w);
  const std::vector<NodeCondition> on_nodes = write_node_sets(w);
  write_surfaces(w);
  write_pairs(w);
  w.line(1, "</Mesh>");
  write_domains(w);
  choose_controllers(w);
  write_conditions(w, 1, -1, on_nodes);
  write_steps(w, on_nodes);
  write_load_data(w);
  w.lines(1, element_lines("Output", plotfile_lines()));
  w.line(0, "</febio_spec>");
  for (const ElementSet& s : model.element_sets) drop(w, fmt::format("element set \"{}\"", s.name));
  for (const Remark& r : model.ignored) drop(w, r.count > 1 ? fmt::format("{} ({} times)", r.what, r.count) : r.what);
  return w.text;
}

}  // namespace dea

#include "io/convert/write_feb.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <set>

#include "io/feb/feb_xml.h"
#include "io/febio/symmetry_words.h"
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
  return feb::whole_int(material.name) ? std::to_string(material.id) : material.name;
}

}  // namespace

std::string exact(double value) { return fmt::format("{}", value); }
std::string exact(const Vector3d& v) { return fmt::format("{},{},{}", v.x(), v.y(), v.z()); }

XmlLines dea_contact_lines(const ConversionPlan& plan, const Contact& contact) {
  const DeaContact& dea = *contact.dea;
  XmlLines lines = {{0, leaf("law", name(*dea.law))},
                    {0, leaf("facets", name(*dea.facets))},
                    {0, leaf("source", dea.source == 0 ? "primary" : "secondary")},
                    {0, leaf("refine", std::to_string(*dea.refine))}};
  if (!dea.symmetry_planes.empty())
    lines.push_back({0, leaf("symmetry_planes", febio::text_of_planes(dea.symmetry_planes))});
  for (std::size_t side = 0; side < 2; ++side) {
    const DeaLayer& layer = dea.layers[side];
    const std::string prefix = side == 0 ? "primary_" : "secondary_";
    if (layer.E) lines.push_back({0, leaf(prefix + "E", exact(*layer.E))});
    if (layer.nu) lines.push_back({0, leaf(prefix + "nu", exact(*layer.nu))});
    if (layer.thickness)
      lines.push_back({0, leaf(prefix + "thickness", exact(*layer.thickness))});
    else
      lines.push_back(
          {0, fmt::format("<{0}thickness type=\"map\">{1}</{0}thickness>", prefix,
                          escaped(plan.map_of_surface[at(side == 0 ? contact.primary : contact.secondary)]))});
  }
  return lines;
}

XmlLines thickness_map_lines(const Surface& surface, const std::vector<double>& values, const std::string& name) {
  XmlLines lines = {{0, fmt::format("<SurfaceData name=\"{}\" surface=\"{}\" data_type=\"scalar\">", escaped(name),
                                    escaped(surface.name))}};
  int largest = 0;
  for (std::size_t f = 0; f + 1 < surface.begin.size(); ++f)
    largest = std::max(largest, surface.begin[f + 1] - surface.begin[f]);
  for (std::size_t f = 0; f + 1 < surface.begin.size(); ++f) {
    std::string text;
    for (int k = 0; k < largest; ++k)
      text +=
          fmt::format("{}{:.17g}", k ? "," : "", values[at(std::min(surface.begin[f] + k, surface.begin[f + 1] - 1))]);
    lines.push_back({1, fmt::format("<face lid=\"{}\">{}</face>", f + 1, text)});
  }
  lines.push_back({0, "</SurfaceData>"});
  return lines;
}

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

XmlLines rigid_material_lines(const Material& material) {
  XmlLines lines = {{0, leaf("density", exact(material.density))}};
  if (material.center_of_mass) lines.push_back({0, leaf("center_of_mass", exact(*material.center_of_mass))});
  return lines;
}

XmlLines rigid_fixed_lines(const JointModel& model, const RigidFixed& fixed) {
  constexpr const char* kFlags[kDofs] = {"Rx_dof", "Ry_dof", "Rz_dof", "Ru_dof", "Rv_dof", "Rw_dof"};
  XmlLines lines = {{0, fmt::format("<rigid_bc name=\"{}\" type=\"rigid_fixed\">", escaped(fixed.name))},
                    {1, leaf("rb", body_reference(model.materials[at(fixed.material)]))}};
  for (std::size_t i = 0; i < kDofs; ++i) lines.push_back({1, leaf(kFlags[i], fixed.dofs[i] ? "1" : "0")});
  lines.push_back({0, "</rigid_bc>"});
  return lines;
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

XmlLines solver_lines(const std::string& module, const LinearSolver& linear_solver) {
  XmlLines lines = {{0, fmt::format("<solver type=\"{}\">", module.empty() ? "solid" : escaped(module))}};
  for (const SolverParameter& p : solver_parameters(linear_solver.type)) lines.push_back({1, leaf(p.name, p.value)});
  for (const XmlLine& line :
       XmlLines{{1, "<qn_method type=\"BFGS\">"}, {2, "<max_ups>0</max_ups>"}, {1, "</qn_method>"}})
    lines.push_back(line);
  for (const XmlLine& line : linear_solver_lines(linear_solver)) lines.push_back({1, line.text});
  lines.push_back({0, "</solver>"});
  return lines;
}

const std::vector<const char*>& plot_variables() {
  static const std::vector<const char*> kVariables = {"contact pressure", "contact gap",         "contact force",
                                                      "contact area",     "cartilage thickness", "joint space",
                                                      "spring strain"};
  return kVariables;
}

XmlLines plotfile_lines() {
  XmlLines lines = {{0, "<plotfile type=\"febio\">"}, {1, "<var type=\"displacement\"/>"}};
  for (const char* variable : plot_variables()) lines.push_back({1, fmt::format("<var type=\"{}\"/>", variable)});
  lines.push_back({1, "<var type=\"rigid force\"/>"});
  lines.push_back({1, "<var type=\"rigid position\"/>"});
  lines.push_back({0, "</plotfile>"});
  return lines;
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
    w.line(2, fmt::format("<material id=\"{}\" name=\"{}\" type=\"rigid body\">", id, escaped(m.name)));
    w.lines(3, rigid_material_lines(m));
    w.line(2, "</material>");
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
      nodes.erase(std::remove_if(nodes.begin(), nodes.end(),
                                 [&](int n) { return fastened.count(n) == 0 || w.plan.node_rigid[at(n)]; }),
                  nodes.end());
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
    w.line(2, fmt::format("<SurfacePair name=\"{}\">", escaped(w.pair_of_contact[i])));
    w.line(3, leaf("primary", w.model.surfaces[at(c.primary)].name));
    w.line(3, leaf("secondary", w.model.surfaces[at(c.secondary)].name));
    w.line(2, "</SurfacePair>");
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
    const std::string start =
        fmt::format("<{} name=\"{}\" mat=\"{}\"", is_shell(d.shape) ? "ShellDomain" : "SolidDomain",
                    escaped(w.domain_names[i]), escaped(w.model.materials[at(d.material)].name));
    if (is_shell(d.shape) && (d.shell_thickness.empty() || uniform(d.shell_thickness))) {
      w.line(2, start + ">");
      w.line(3, leaf("shell_thickness", exact(d.shell_thickness.empty() ? 0.0 : d.shell_thickness.front())));
      w.line(2, "</ShellDomain>");
    } else {
      w.line(2, start + "/>");
    }
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
  for (std::size_t s = 0; s < w.plan.map_of_surface.size(); ++s) {
    if (w.plan.map_of_surface[s].empty()) continue;
    w.lines(
        2, thickness_map_lines(w.model.surfaces[s], map_values(w.plan, static_cast<int>(s)), w.plan.map_of_surface[s]));
  }
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
  const auto add = [&](const XmlLines& more) { lines.insert(lines.end(), more.begin(), more.end()); };
  for (const RigidFixed& f : w.model.rigid_fixed)
    if (f.step == step) add(rigid_fixed_lines(w.model, f));
  for (const RigidPrescribed& p : w.model.rigid_prescribed) {
    if (p.step != step) continue;
    add({{0, fmt::format("<rigid_bc name=\"{}\" type=\"{}\">", escaped(p.name),
                         p.dof < 3 ? "rigid_displacement" : "rigid_rotation")},
         {1, leaf("rb", body(w, p.material))},
         {1, leaf("dof", p.dof < 3 ? kDofNames[p.dof] : kForces[p.dof])},
         {1, scaled(w, p.value)},
         {1, leaf("relative", p.relative ? "1" : "0")},
         {0, "</rigid_bc>"}});
  }
  for (const RigidLoad& l : w.model.rigid_loads) {
    if (l.step != step) continue;
    add({{0, fmt::format("<rigid_load name=\"{}\" type=\"{}\">", escaped(l.name),
                         l.dof < 3 ? "rigid_force" : "rigid_moment")},
         {1, leaf("rb", body(w, l.material))},
         {1, leaf("dof", kForces[l.dof])},
         {1, scaled(w, l.value)},
         {1, leaf("load_type", std::array{"LOAD", "FOLLOW", "TARGET"}[static_cast<std::size_t>(l.kind)])},
         {1, leaf("relative", l.relative ? "1" : "0")},
         {0, "</rigid_load>"}});
  }
  for (const RigidSpring& s : w.model.rigid_springs) {
    if (s.step != step) continue;
    add({{0, fmt::format("<rigid_connector name=\"{}\" type=\"rigid spring\">", escaped(s.name))},
         {1, leaf("body_a", body(w, s.material_a))},
         {1, leaf("body_b", body(w, s.material_b))},
         {1, leaf("k", exact(s.k))},
         {1, leaf("insertion_a", exact(s.insertion_a))},
         {1, leaf("insertion_b", exact(s.insertion_b))},
         {1, leaf("free_length", exact(s.free_length))},
         {0, "</rigid_connector>"}});
  }
  return lines;
}

/// The sections Boundary, Rigid, Contact and Discrete of one step, or of all (-1).
void write_conditions(Writer& w, int depth, int step, const std::vector<NodeCondition>& on_nodes) {
  const auto section = [&](const char* name, const XmlLines& lines) {
    if (lines.empty()) return;
    w.line(depth, fmt::format("<{}>", name));
    w.lines(depth + 1, lines);
    w.line(depth, fmt::format("</{}>", name));
  };
  XmlLines boundary;
  for (const NodeCondition& c : on_nodes) {
    if (c.fixed) {
      const FixedNodes& f = w.model.fixed_nodes[c.index];
      if (f.step != step) continue;
      boundary.push_back({0, fmt::format("<bc name=\"{}\" type=\"zero displacement\" node_set=\"{}\">", escaped(f.name),
                                         escaped(c.set))});
      for (std::size_t k = 0; k < 3; ++k)
        boundary.push_back({1, leaf(fmt::format("{}_dof", kDofNames[k]), f.xyz[k] ? "1" : "0")});
    } else {
      const RigidNodes& r = w.model.rigid_nodes[c.index];
      if (r.step != step) continue;
      boundary.push_back(
          {0, fmt::format("<bc name=\"{}\" type=\"rigid\" node_set=\"{}\">", escaped(r.name), escaped(c.set))});
      boundary.push_back({1, leaf("rb", body(w, r.material))});
    }
    boundary.push_back({0, "</bc>"});
  }
  section("Boundary", boundary);
  section("Rigid", rigid_lines(w, step));

  XmlLines contact;
  for (std::size_t i = 0; i < w.model.contacts.size(); ++i) {
    const Contact& c = w.model.contacts[i];
    if (!c.dea || c.step != step) continue;
    contact.push_back({0, fmt::format("<contact name=\"{}\" type=\"dea\" surface_pair=\"{}\">", escaped(c.name),
                                      escaped(w.pair_of_contact[i]))});
    for (const XmlLine& one : dea_contact_lines(w.plan, c)) contact.push_back({1, one.text});
    contact.push_back({0, "</contact>"});
  }
  section("Contact", contact);

  XmlLines discrete;
  for (const DiscreteSprings& s : w.model.discrete_springs) {
    if (s.step != step) continue;
    ++w.discrete_materials;
    discrete.push_back(
        {0, fmt::format("<discrete_material id=\"{}\" name=\"{}\" type=\"{}\">", w.discrete_materials, escaped(s.name),
                        s.tension_only ? "tension-only linear spring" : "linear spring")});
    discrete.push_back({1, leaf("E", exact(s.stiffness))});
    discrete.push_back({0, "</discrete_material>"});
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
    w.line(3, "<Control>");
    w.line(4, leaf("analysis", "STATIC"));
    // FEBio ends a step after its number of steps, or at its final time where must points make steps of other sizes.
    const double steps = std::round(s.duration / s.step_size);
    if (std::abs(steps * s.step_size - s.duration) <= 1e-9 * s.duration) {
      w.line(4, leaf("time_steps", exact(steps)));
    } else {
      w.line(4, leaf("time_steps", "-1"));
      w.line(4, leaf("final_time", exact(s.duration)));
    }
    w.line(4, leaf("step_size", exact(s.step_size)));
    w.line(4, "<time_stepper type=\"default\">");
    w.line(5, leaf("max_retries", "10"));
    w.line(5, leaf("opt_iter", "20"));
    w.line(5, leaf("dtmin", exact(s.step_size / 1000)));
    if (s.must_points.empty()) {
      w.line(5, leaf("dtmax", exact(s.step_size)));
    } else {
      w.dtmax_points.push_back(s.must_points);
      w.line(5, fmt::format("<dtmax lc=\"{}\">{}</dtmax>",
                            w.dtmax_controllers + static_cast<int>(w.dtmax_points.size()), exact(s.step_size)));
    }
    w.line(4, "</time_stepper>");
    w.lines(4, solver_lines("solid", w.plan.linear_solver));
    w.line(3, "</Control>");
    write_conditions(w, 3, static_cast<int>(i), on_nodes);
    w.line(2, "</step>");
  }
  w.line(1, "</Step>");
}

void write_load_data(Writer& w) {
  constexpr const char* kInterpolate[] = {"LINEAR",         "STEP",          "SMOOTH",      "CUBIC SPLINE",
                                          "CONTROL POINTS", "APPROXIMATION", "SMOOTH STEP", "C2-SMOOTH"};
  constexpr const char* kExtend[] = {"CONSTANT", "EXTRAPOLATE", "REPEAT", "REPEAT OFFSET"};
  std::vector<LoadController> curves;
  for (std::size_t i = 0; i < w.model.controllers.size(); ++i)
    if (w.controller_id[i] > 0) curves.push_back(w.model.controllers[i]);
  for (const auto& times : w.dtmax_points) {
    LoadController curve;
    curve.name = "must points";
    for (double t : times) curve.points.push_back({t, 1.0});
    curves.push_back(curve);
  }
  if (curves.empty()) return;
  w.line(1, "<LoadData>");
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const LoadController& c = curves[i];
    w.line(2, fmt::format("<load_controller id=\"{}\" name=\"{}\" type=\"{}\">", i + 1,
                          escaped(c.name.empty() ? fmt::format("LC{}", i + 1) : c.name),
                          c.expression.empty() ? "loadcurve" : "math"));
    if (!c.expression.empty()) {
      w.line(3, leaf("math", c.expression));
      w.line(2, "</load_controller>");
      continue;
    }
    w.line(3, leaf("interpolate", kInterpolate[static_cast<int>(c.interpolate)]));
    w.line(3, leaf("extend", kExtend[static_cast<int>(c.extend)]));
    w.line(3, "<points>");
    for (const auto& p : c.points) w.line(4, fmt::format("<pt>{},{}</pt>", p[0], p[1]));
    w.line(3, "</points>");
    w.line(2, "</load_controller>");
  }
  w.line(1, "</LoadData>");
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
  if (model.units.empty()) {
    w.line(1, "<Module type=\"solid\"/>");
  } else {
    w.line(1, "<Module type=\"solid\">");
    w.line(2, leaf("units", model.units));
    w.line(1, "</Module>");
  }
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
  w.line(1, "<Output>");
  w.lines(2, plotfile_lines());
  w.line(1, "</Output>");
  w.line(0, "</febio_spec>");
  for (const ElementSet& s : model.element_sets) drop(w, fmt::format("element set \"{}\"", s.name));
  for (const Remark& r : model.ignored) drop(w, r.count > 1 ? fmt::format("{} ({} times)", r.what, r.count) : r.what);
  return w.text;
}

}  // namespace dea

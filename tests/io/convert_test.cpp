// A converted model is the same joint: `dea run` finds the same poses, pressures and statistics in it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>

#include "io/convert/convert_feb.h"
#include "io/convert/xml_places.h"
#include "io/feb/read_feb.h"
#include "io/settings/settings_xml.h"
#include "src/base/error.h"
#include "src/model/settings_table.h"
#include "src/run/analysis.h"
#include "tests/program.h"

namespace dea::convert_test {

namespace fs = std::filesystem;

// ---- small joints in every version
// -----------------------------------------------------------------------------------

enum class Held { SharedNodes, RigidNodes, Tied, Ground };

struct JointText {
  std::string version = "4.0";
  Held held = Held::SharedNodes;
  bool quadratic = false;  ///< hex20 and quad8
  bool upper_layer = false;
  bool one_section = false;  ///< both layers in one Elements section
  bool ligament = false;
  bool more = false;  ///< what is ignored and stays: comments, a fixed node that is not cartilage, a contact left out
};

/// A layer of 3 x 3 hexahedra, thickness 2 to 2.6, and a plate above it (rigid shells, or a second layer held by it),
/// moved down in the first step, loaded in the second.
struct Mesh {
  std::string nodes, lower, upper, base, plate, top, bottom, lower_back, base_front;
  std::vector<int> lower_foot, upper_foot;
  int next_node = 1, next_element = 1;
};

using Lattice = std::map<std::array<int, 3>, int>;

/// A block of hexahedra over [0, 3]^2; z runs from z0 to z1 of (x, y).
template <class Height>
Lattice add_block(Mesh& m, bool quadratic, std::string& elements, Height z0, Height z1) {
  const int n = 3, step = 2;
  Lattice ids;
  for (int k = 0; k <= step; k += quadratic ? 1 : 2)
    for (int j = 0; j <= step * n; j += quadratic ? 1 : 2)
      for (int i = 0; i <= step * n; i += quadratic ? 1 : 2) {
        if (i % 2 + j % 2 + k % 2 > 1) continue;
        const double x = 0.5 * i, y = 0.5 * j, t = 0.5 * k;
        ids[{i, j, k}] = m.next_node;
        m.nodes +=
            fmt::format("<node id=\"{}\">{},{},{}</node>\n", m.next_node++, x, y, (1 - t) * z0(x, y) + t * z1(x, y));
      }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int x = 2 * i, y = 2 * j;
      std::vector<std::array<int, 3>> list = {{x, y, 0}, {x + 2, y, 0}, {x + 2, y + 2, 0}, {x, y + 2, 0},
                                              {x, y, 2}, {x + 2, y, 2}, {x + 2, y + 2, 2}, {x, y + 2, 2}};
      if (quadratic) {
        for (int k : {0, 2})
          for (const auto& p : {std::array<int, 3>{x + 1, y, k}, {x + 2, y + 1, k}, {x + 1, y + 2, k}, {x, y + 1, k}})
            list.push_back(p);
        for (const auto& p : {std::array<int, 3>{x, y, 1}, {x + 2, y, 1}, {x + 2, y + 2, 1}, {x, y + 2, 1}})
          list.push_back(p);
      }
      std::string text;
      for (const auto& p : list) text += fmt::format("{}{}", text.empty() ? "" : ",", ids.at(p));
      elements += fmt::format("<elem id=\"{}\">{}</elem>\n", m.next_element++, text);
    }
  return ids;
}

/// Facets of one side of a block, as "1,2,3,4" (with the middle nodes when quadratic).
std::vector<std::string> side(const Lattice& ids, bool quadratic, int k) {
  std::vector<std::string> facets;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) {
      const int x = 2 * i, y = 2 * j;
      std::vector<std::array<int, 3>> list = {{x, y, k}, {x + 2, y, k}, {x + 2, y + 2, k}, {x, y + 2, k}};
      if (quadratic)
        for (const auto& p : {std::array<int, 3>{x + 1, y, k}, {x + 2, y + 1, k}, {x + 1, y + 2, k}, {x, y + 1, k}})
          list.push_back(p);
      std::string text;
      for (const auto& p : list) text += fmt::format("{}{}", text.empty() ? "" : ",", ids.at(p));
      facets.push_back(text);
    }
  return facets;
}

std::string list_of(const std::vector<std::string>& facets, const std::string& tag, int first) {
  std::string text;
  for (const std::string& f : facets) text += fmt::format("<{0} id=\"{1}\">{2}</{0}>\n", tag, first++, f);
  return text;
}
std::string elements_of(Mesh& m, const std::vector<std::string>& facets) {
  std::string text;
  for (const std::string& f : facets) text += fmt::format("<elem id=\"{}\">{}</elem>\n", m.next_element++, f);
  return text;
}

/// A sheet of nodes of its own, and its facets.
template <class Height>
std::vector<std::string> add_sheet(Mesh& m, Height z) {
  std::map<std::array<int, 2>, int> ids;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) {
      ids[{i, j}] = m.next_node;
      m.nodes += fmt::format("<node id=\"{}\">{},{},{}</node>\n", m.next_node++, i, j, z(i, j));
    }
  std::vector<std::string> facets;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i)
      facets.push_back(fmt::format("{},{},{},{}", ids[{i, j}], ids[{i + 1, j}], ids[{i + 1, j + 1}], ids[{i, j + 1}]));
  return facets;
}

std::string node_list(const Lattice& ids, int k) {
  std::string text;
  for (const auto& entry : ids)
    if (entry.first[2] == k) text += fmt::format("{}{}", text.empty() ? "" : ",", entry.second);
  return text;
}

std::string model_text(const JointText& t) {
  const bool v25 = t.version == "2.5", v30 = t.version == "3.0", v40 = t.version == "4.0";
  const auto bottom = [](double x, double y) { return -2.0 - 0.2 * x + 0.0 * y; };
  const auto top = [](double, double) { return 0.0; };
  const auto plate_low = [](double x, double y) { return 0.1 + 0.01 * (x - 1.5) * (x - 1.5) + 0.0 * y; };
  const auto plate_high = [](double x, double y) { return 1.6 + 0.02 * x * y; };
  Mesh m;
  const Lattice lower = add_block(m, t.quadratic, m.lower, +bottom, +top);
  const std::string facet = t.quadratic ? "quad8" : "quad4";
  const int first_upper = m.next_element;
  Lattice upper;
  std::vector<std::string> plate;
  if (t.upper_layer) {
    upper = add_block(m, t.quadratic, m.upper, +plate_low, +plate_high);
    plate = side(upper, t.quadratic, 2);
  } else {
    plate = add_sheet(m, plate_low);
  }
  std::vector<std::string> base;
  if (t.held == Held::SharedNodes) base = side(lower, t.quadratic, 0);
  if (t.held == Held::Tied) base = add_sheet(m, bottom);
  const std::string facet_plate = t.upper_layer ? facet : "quad4";
  const std::string facet_base = t.held == Held::Tied ? "quad4" : facet;
  if (!base.empty()) m.base = elements_of(m, base);
  m.plate = elements_of(m, plate);
  const int ligament_foot = m.next_node++;
  m.nodes += fmt::format("<node id=\"{}\">1,1,-9</node>\n", ligament_foot);
  const int loose = m.next_node++;
  m.nodes += fmt::format("<node id=\"{}\">9,9,9</node>\n", loose);
  (void)first_upper;

  const auto mat = [&](const char* name) { return v25 ? fmt::format(" mat=\"{}\"", name) : std::string(); };
  const auto section = [&](const std::string& type, const char* name, const char* material, const std::string& list) {
    return fmt::format("<Elements type=\"{}\" name=\"{}\"{}>\n{}</Elements>\n", type, name, mat(material), list);
  };
  const std::string hex = t.quadratic ? "hex20" : "hex8";
  std::string mesh = "<Nodes name=\"all\">\n" + m.nodes + "</Nodes>\n";
  if (t.one_section) {
    mesh += section(hex, "layer", "cartilage", m.lower + m.upper);
  } else {
    mesh += section(hex, "layer", "cartilage", m.lower);
    if (t.upper_layer) mesh += section(hex, "layer above", "cartilage", m.upper);
  }
  if (!base.empty()) mesh += section(facet_base, "base", "base", m.base);
  mesh += section(facet_plate, "plate", "plate", m.plate);
  const auto node_set = [&](const char* name, const std::string& list) {
    if (v40) return fmt::format("<NodeSet name=\"{}\">{}</NodeSet>\n", name, list);
    std::string children;
    std::string_view rest = list;
    while (!rest.empty()) {
      const std::size_t comma = rest.find(',');
      children += fmt::format("<{} id=\"{}\"/>", v25 ? "node" : "n", rest.substr(0, comma));
      rest = comma == rest.npos ? std::string_view() : rest.substr(comma + 1);
    }
    return fmt::format("<NodeSet name=\"{}\">{}</NodeSet>\n", name, children);
  };
  const bool held_nodes = t.held == Held::RigidNodes || t.held == Held::Ground;
  if (held_nodes) mesh += node_set("foot", node_list(lower, 0) + (t.more ? fmt::format(",{}", ligament_foot) : ""));
  if (t.more) mesh += node_set("loose", std::to_string(loose));
  const auto surface = [](const char* name, const std::string& list) {
    return fmt::format("<Surface name=\"{}\">\n{}</Surface>\n", name, list);
  };
  mesh += surface("top", list_of(side(lower, t.quadratic, 2), facet, 1));
  mesh += surface("plate face",
                  t.upper_layer ? list_of(side(upper, t.quadratic, 0), facet, 1) : list_of(plate, facet_plate, 1));
  if (t.held == Held::Tied) {
    mesh += surface("back", list_of(side(lower, t.quadratic, 0), facet, 1));
    mesh += surface("base face", list_of(base, "quad4", 1));
  }
  const auto pair = [&](const char* name, const char* primary, const char* secondary) {
    return v25 ? fmt::format("<SurfacePair name=\"{}\"><master surface=\"{}\"/><slave surface=\"{}\"/></SurfacePair>\n",
                             name, secondary, primary)
               : fmt::format("<SurfacePair name=\"{}\"><primary>{}</primary><secondary>{}</secondary></SurfacePair>\n",
                             name, primary, secondary);
  };
  mesh += pair("joint", "top", "plate face");
  if (t.held == Held::Tied) mesh += pair("glue", "back", "base face");
  if (t.ligament)
    mesh += fmt::format("<DiscreteSet name=\"band\"><delem>{},{}</delem></DiscreteSet>\n",
                        t.more && held_nodes ? ligament_foot : lower.at({0, 0, 0}),
                        plate.front().substr(0, plate.front().find(',')));

  std::string text = fmt::format(R"(<?xml version="1.0" encoding="ISO-8859-1"?>
<febio_spec version="{}">
<Module type="solid"><units>mm-N-s</units></Module>
<!-- a comment stays -->
<Material>
<material id="1" name="cartilage" type="neo-Hookean"><density>1</density><E>10</E><v>0.3</v></material>
<material id="2" name="base" type="rigid body"><density>1</density></material>
<material id="3" name="plate" type="rigid body"><density>2</density><center_of_mass>1.5,1.5,3</center_of_mass></material>
</Material>
<{}>
{}</{}>
)",
                                 t.version, v25 ? "Geometry" : "Mesh", mesh, v25 ? "Geometry" : "Mesh");
  if (!v25) {
    text += "<MeshDomains>\n<SolidDomain name=\"layer\" mat=\"cartilage\"/>\n";
    if (t.upper_layer && !t.one_section) text += "<SolidDomain name=\"layer above\" mat=\"cartilage\"/>\n";
    const auto shell = [&](const char* name) {
      return fmt::format("<ShellDomain name=\"{0}\" mat=\"{0}\"><shell_thickness>0.5</shell_thickness></ShellDomain>\n",
                         name);
    };
    if (!base.empty()) text += shell("base");
    text += shell("plate") + "</MeshDomains>\n";
  } else {
    text += "<MeshData>";
    for (const char* name : {"base", "plate"}) {
      if (std::string(name) == "base" && base.empty()) continue;
      text += fmt::format("<ElementData var=\"shell thickness\" elem_set=\"{}\">", name);
      const bool quad8 = (std::string(name) == "plate" ? facet_plate : facet_base) == "quad8";
      for (int i = 1; i <= 9; ++i)
        text +=
            fmt::format("<elem lid=\"{}\">{}</elem>", i, quad8 ? "0.5,0.5,0.5,0.5,0.5,0.5,0.5,0.5" : "0.5,0.5,0.5,0.5");
      text += "</ElementData>";
    }
    text += "</MeshData>\n";
  }

  // conditions
  const std::string rigid_set = v25   ? "<rigid rb=\"2\" node_set=\"foot\"/>\n"
                                : v30 ? "<bc name=\"glued\" type=\"rigid\" node_set=\"foot\"><rb>2</rb></bc>\n"
                                      : "<bc name=\"glued\" type=\"rigid\" node_set=\"foot\">\n<rb>base</rb>\n</bc>\n";
  const auto fix = [&](const char* set) {
    return v25   ? fmt::format("<fix bc=\"x,y,z\" node_set=\"{}\"/>\n", set)
           : v30 ? fmt::format("<bc name=\"fixed {0}\" type=\"fix\" node_set=\"{0}\"><dofs>x,y,z</dofs></bc>\n", set)
                 : fmt::format(
                       "<bc name=\"fixed {0}\" type=\"zero displacement\" node_set=\"{0}\">\n<x_dof>1</x_dof>\n"
                       "<y_dof>1</y_dof>\n<z_dof>1</z_dof>\n</bc>\n",
                       set);
  };
  std::string boundary;
  if (t.held == Held::RigidNodes) boundary += rigid_set;
  if (t.held == Held::Ground) boundary += fix("foot");
  if (t.more) boundary += fix("loose");
  const std::string base_bc =
      v25   ? "<rigid_body mat=\"2\"><fixed bc=\"x\"/><fixed bc=\"y\"/><fixed bc=\"z\"/><fixed "
              "bc=\"Rx\"/><fixed bc=\"Ry\"/><fixed bc=\"Rz\"/></rigid_body>\n"
      : v30 ? "<rigid_constraint type=\"fix\"><rb>2</rb><dofs>Rx,Ry,Rz,Ru,Rv,Rw</dofs></rigid_constraint>\n"
            : "<rigid_bc type=\"rigid_fixed\"><rb>base</rb><Rx_dof>1</Rx_dof><Ry_dof>1</Ry_dof><Rz_dof>1"
              "</Rz_dof><Ru_dof>1</Ru_dof><Rv_dof>1</Rv_dof><Rw_dof>1</Rw_dof></rigid_bc>\n";
  // the plate may tilt about x; the second step turns with it
  const std::string plate_bc =
      v25   ? "<rigid_body mat=\"3\"><fixed bc=\"x\"/><fixed bc=\"y\"/><fixed bc=\"Ry\"/><fixed "
              "bc=\"Rz\"/></rigid_body>\n"
      : v30 ? "<rigid_constraint type=\"fix\"><rb>plate</rb><dofs>Rx,Ry,Rv,Rw</dofs></rigid_constraint>\n"
            : "<rigid_bc "
              "type=\"rigid_fixed\"><rb>plate</rb><Rx_dof>1</Rx_dof><Ry_dof>1</Ry_dof><Rv_dof>1</Rv_dof><Rw_dof>1"
              "</Rw_dof></rigid_bc>\n";
  const std::string rigid = base_bc + plate_bc;
  const std::string down =
      v25 ? "<rigid_body mat=\"3\"><prescribed bc=\"z\" lc=\"1\">-0.3</prescribed></rigid_body>"
      : v30
          ? "<rigid_constraint type=\"prescribe\"><rb>plate</rb><dof>Rz</dof><value "
            "lc=\"1\">-0.3</value></rigid_constraint>"
          : "<rigid_bc name=\"down\" type=\"rigid_displacement\"><rb>plate</rb><dof>z</dof><value lc=\"1\">-0.3</value>"
            "<relative>0</relative></rigid_bc>";
  const std::string push =
      v25   ? "<rigid_body mat=\"3\"><force bc=\"z\" lc=\"2\">-30</force></rigid_body>"
      : v30 ? "<rigid_constraint type=\"force\"><rb>3</rb><dof>2</dof><value lc=\"2\">-30</value></rigid_constraint>"
            : "<rigid_load name=\"push\" type=\"rigid_force\"><rb>plate</rb><dof>Rz</dof><value lc=\"2\">-30</value>"
              "</rigid_load>";
  const std::string spring =
      "><body_a>3</body_a><body_b>2</body_b><k>2</k><insertion_a>0,0,3</insertion_a>"
      "<insertion_b>0,0.5,-3</insertion_b><free_length>5.5</free_length>";
  std::string connectors;
  if (t.ligament && !v25)
    connectors = "<rigid_connector name=\"lig\" type=\"rigid spring\"" + spring + "</rigid_connector>\n";
  if (v25) {
    text += "<Boundary>\n" + boundary + rigid + "</Boundary>\n";
  } else {
    if (!boundary.empty()) text += "<Boundary>\n" + boundary + "</Boundary>\n";
    text += "<Rigid>\n" + rigid + connectors + "</Rigid>\n";
  }
  text +=
      "<Contact>\n<contact name=\"joint\" type=\"sliding-elastic\" surface_pair=\"joint\">\n<penalty>20</penalty>\n"
      "</contact>\n";
  if (t.held == Held::Tied)
    text += "<contact name=\"glue\" type=\"tied-elastic\" surface_pair=\"glue\">\n<penalty>10</penalty>\n</contact>\n";
  text += "</Contact>\n";
  if (t.ligament && v25)
    text += "<Constraints><constraint name=\"lig\" type=\"rigid spring\"" + spring + "</constraint></Constraints>\n";
  if (t.ligament)
    text +=
        "<Discrete><discrete_material id=\"1\" name=\"band\" type=\"tension-only linear spring\"><E>3</E>"
        "</discrete_material><discrete dmat=\"1\" discrete_set=\"band\"/></Discrete>\n";
  const std::string control =
      v25 ? "<Control><time_steps>3</time_steps><step_size>0.5</step_size><time_stepper><dtmax lc=\"3\"></dtmax>"
            "</time_stepper></Control>"
          : "<Control>\n<time_steps>3</time_steps>\n<step_size>0.5</step_size>\n<time_stepper><dtmax "
            "lc=\"3\">0.5</dtmax>"
            "</time_stepper>\n<solver type=\"solid\">\n<dtol>0.001</dtol>\n</solver>\n</Control>";
  const std::string in = v25 ? "Boundary" : "Rigid";
  const auto step = [&](int id, const std::string& what) {
    return v25 ? fmt::format("<Step name=\"s{0}\">{1}<{2}>{3}</{2}></Step>\n", id, control, in, what)
               : fmt::format("<step id=\"{0}\" name=\"s{0}\">\n{1}\n<{2}>{3}</{2}></step>\n", id, control, in, what);
  };
  text += v25 ? step(1, down) + step(2, push) : "<Step>\n" + step(1, down) + step(2, push) + "</Step>\n";
  const auto curve = [&](int id, const std::string& points) {
    return v25 ? fmt::format("<loadcurve id=\"{}\" type=\"linear\">{}</loadcurve>\n", id, points)
               : fmt::format("<load_controller id=\"{}\" type=\"loadcurve\"><points>{}</points></load_controller>\n",
                             id, points);
  };
  const std::string ramp = "<pt>0,0</pt><pt>1.5,1</pt>", later = "<pt>1.5,0.5</pt><pt>3,1</pt>",
                    must = "<pt>0.7,0.5</pt><pt>2.2,0.5</pt>";
  text += "<LoadData>\n" + curve(1, ramp) + curve(2, later) + curve(3, must) + "</LoadData>\n";
  text +=
      "<Output>\n<plotfile type=\"febio\">\n<var type=\"displacement\"/>\n<var type=\"contact "
      "pressure=p\"/>\n</plotfile>\n"
      "</Output>\n</febio_spec>\n";
  return text;
}

// ---- the same result
// -------------------------------------------------------------------------------------------------

void write(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

/// Writes a model and returns its path.
std::string write_model(const test::TemporaryFolder& folder, const JointText& t) {
  const std::string path = (folder.path / "model.feb").string();
  write(path, model_text(t));
  return path;
}

/// Equal to 1e-9 of the larger of themselves and `scale` (NaN: none).
void near(double a, double b, double scale, const std::string& what) {
  if (std::isnan(a) && std::isnan(b)) return;
  const double largest = std::max({std::isnan(scale) ? 0.0 : scale, std::abs(a), 1e-3});
  if (std::abs(a - b) <= 1e-9 * largest) return;
  ADD_FAILURE() << what << ": " << a << " and " << b;
}

/// Poses, pressures and statistics of every state.
void expect_same(const Analysis& a, const Analysis& b) {
  ASSERT_EQ(a.states.size(), b.states.size());
  ASSERT_EQ(a.joint.contacts.size(), b.joint.contacts.size());
  for (std::size_t i = 0; i < a.states.size(); ++i) {
    const StateResult &x = a.states[i], &y = b.states[i];
    const std::string at = fmt::format("state {}", i);
    EXPECT_EQ(x.when.time, y.when.time);
    EXPECT_EQ(x.equilibrium.outcome, y.equilibrium.outcome) << at;
    for (std::size_t p = 0; p + 1 < a.joint.bodies.size(); ++p) {  // the last one is the ground
      const auto q = std::find_if(b.joint.bodies.begin(), b.joint.bodies.end(),
                                  [&](const Body& body) { return body.name == a.joint.bodies[p].name; });
      ASSERT_NE(q, b.joint.bodies.end()) << a.joint.bodies[p].name;
      const Pose &u = x.equilibrium.poses[p],
                 &v = y.equilibrium.poses[static_cast<std::size_t>(q - b.joint.bodies.begin())];
      EXPECT_LT((u.center - v.center).norm(), 1e-9) << at << a.joint.bodies[p].name;
      EXPECT_LT((u.rotation - v.rotation).norm(), 1e-9) << at;
    }
    for (std::size_t c = 0; c < x.statistics.size(); ++c) {
      const ContactStatistics &s = x.statistics[c], &t = y.statistics[c];
      EXPECT_EQ(s.springs, t.springs);
      EXPECT_EQ(s.springs_active, t.springs_active) << at;
      near(s.peak, t.peak, s.peak, at + " peak");
      near(s.mean, t.mean, s.peak, at + " mean");
      near(s.median, t.median, s.peak, at + " median");
      near(s.contact_area, t.contact_area, 0, at + " area");
      near(s.largest_strain, t.largest_strain, 0, at + " strain");
      for (int k = 0; k < 3; ++k) {
        near(s.force[k], t.force[k], s.force.norm(), at + " force");
        near(s.moment[k], t.moment[k], s.moment.norm(), at + " moment");
      }
      for (std::size_t side = 0; side < 2; ++side) {
        const SideFields &f = x.fields[c].sides[side], &g = y.fields[c].sides[side];
        ASSERT_EQ(f.pressure.size(), g.pressure.size());
        for (std::size_t k = 0; k < f.pressure.size(); ++k) {
          near(f.pressure[k], g.pressure[k], s.peak, at + " pressure");
          near(f.joint_space[k], g.joint_space[k], 1, at + " joint space");
        }
        for (std::size_t k = 0; k < f.vertex_thickness.size(); ++k)
          near(f.vertex_thickness[k], g.vertex_thickness[k], 1, at + " thickness");
      }
    }
  }
}

struct Converted {
  Conversion conversion;
  JointModel model;  ///< read back
  std::string path;
};

Converted convert(const fs::path& folder, const std::string& path, const Settings& settings = {}) {
  Converted c;
  c.path = (folder / "converted.feb").string();
  c.conversion = convert_feb(read_feb(path), settings, c.path);
  write(c.path, c.conversion.text);
  c.model = read_feb(c.path);
  return c;
}

/// Converts a file and compares what the analyses find.
Converted expect_same_joint(const fs::path& folder, const std::string& path, const Settings& settings = {}) {
  const Converted c = convert(folder, path, settings);
  Settings of_rest = settings;  // those that are not in the file
  of_rest.law.reset();
  of_rest.facets.reset();
  of_rest.refine.reset();
  of_rest.source.clear();
  of_rest.attach.clear();
  of_rest.bone.clear();
  of_rest.rigid.clear();
  of_rest.thickness.clear();
  of_rest.thickness_from.clear();
  of_rest.thickness_scale.clear();
  of_rest.E.clear();
  of_rest.nu.clear();
  const Analysis before = analyse(read_feb(path), settings);
  EXPECT_TRUE(solved(before.states.back().equilibrium.outcome)) << before.states.back().equilibrium.message;
  EXPECT_GT(before.states.back().statistics[0].peak, 0);
  expect_same(before, analyse(c.model, of_rest));
  return c;
}

std::string all_of(const std::vector<std::string>& lines) { return fmt::format("{}", fmt::join(lines, "\n")); }
std::string all_of(const std::vector<Sentence>& sentences) {
  std::vector<std::string> lines;
  for (const Sentence& words : sentences) lines.push_back(worded(words, command_line_wording()));
  return all_of(lines);
}

std::string fault(const std::string& path, const Settings& settings = {}) {
  try {
    convert_feb(read_feb(path), settings, path + ".out");
  } catch (const std::exception& e) {
    std::string text = e.what();
    if (const auto* wrong_use = dynamic_cast<const UsageError*>(&e))
      text = line(wrong_use->fault, command_line_wording());
    if (const auto* refused = dynamic_cast<const InputError*>(&e)) text = line(refused->fault, command_line_wording());
    const std::string folder = fs::path(path).parent_path().string() + "/";
    for (std::size_t at = text.find(folder); at != text.npos; at = text.find(folder)) text.erase(at, folder.size());
    return text;
  }
  return "no fault";
}

// ---- tests
// -----------------------------------------------------------------------------------------------------------

TEST(Convert, EverySampleIsTheSameJoint) {
  const test::TemporaryFolder folder;
  for (const char* sample : {"hip/hip_walking.feb", "spheres/one_layer.feb", "spheres/two_layers.feb",
                             "ligament/ligament.feb", "sphere_on_flat/sphere_on_flat.feb", "plateaus/plateaus.feb"}) {
    SCOPED_TRACE(sample);
    EXPECT_TRUE(expect_same_joint(folder.path, std::string(DEA_SAMPLES_DIR "/") + sample).conversion.edited);
  }
}

TEST(Convert, EveryReferenceModelIsTheSameJoint) {
  if (!fs::is_directory(DEA_REFERENCE_DIR)) GTEST_SKIP() << "no " << DEA_REFERENCE_DIR;
  const test::TemporaryFolder folder;
  for (const auto& entry : fs::directory_iterator(DEA_REFERENCE_DIR)) {
    if (entry.path().extension() != ".feb") continue;
    SCOPED_TRACE(entry.path().string());
    EXPECT_TRUE(expect_same_joint(folder.path, entry.path().string()).conversion.edited);
  }
}

// What FEBio users made: whatever `dea run` takes is the same joint when converted.
TEST(Convert, EveryModelOfTheCorpusThatRunsIsTheSameJoint) {
  if (!fs::is_directory(DEA_CORPUS_DIR)) GTEST_SKIP() << "no " << DEA_CORPUS_DIR;
  const test::TemporaryFolder folder;
  int compared = 0;
  Settings settings;
  settings.law = Law::Linear;  // which any of them can have
  for (const char* version : {"v2.5", "v3.0", "v4.0"}) {
    if (!fs::is_directory(fs::path(DEA_CORPUS_DIR) / version)) continue;
    for (const auto& entry : fs::directory_iterator(fs::path(DEA_CORPUS_DIR) / version)) {
      if (entry.path().extension() != ".feb") continue;
      const JointModel model = read_feb(entry.path().string());
      AnalysisOptions options;  // the first states: some models have thousands, or loads nothing can carry
      Analysis before;
      try {
        options.times = model_times(model);
        options.times.resize(std::min<std::size_t>(options.times.size(), 4));
        before = analyse(model, settings, options);
      } catch (const std::runtime_error&) {
        continue;
      }
      SCOPED_TRACE(entry.path().string());
      if (!model.prescribed_nodes.empty()) {  // a bone that the model leaves out has no material to make rigid
        try {
          convert(folder.path, entry.path().string(), settings);
          ADD_FAILURE() << "converted";
        } catch (const InputError& error) {
          EXPECT_NE(std::string(error.what()).find("FEBio moves no nodes of rigid bodies"), std::string::npos)
              << error.what();
        }
        continue;
      }
      const auto left_out = [](const Layer& layer) { return !layer.facet_kinds.empty(); };
      const auto& contacts = before.joint.contacts;
      if (std::any_of(contacts.begin(), contacts.end(), [&](const ContactPair& pair) {
            return left_out(pair.layers[0]) || left_out(pair.layers[1]);
          })) {  // no elements tell the converted model which facets are side walls
        EXPECT_THROW(convert(folder.path, entry.path().string(), settings), InputError);
        continue;
      }
      const Converted c = convert(folder.path, entry.path().string(), settings);
      EXPECT_EQ(c.conversion.edited, std::string(version) == "v4.0");
      expect_same(before, analyse(c.model, {}, options));
      ++compared;
    }
  }
  fmt::print("{} models compared\n", compared);
  EXPECT_GT(compared, 0);
}

TEST(Convert, AnyVersionAnyWayALayerIsHeld) {
  const test::TemporaryFolder folder;
  for (const std::string version : {"4.0", "3.0", "2.5"})
    for (const Held held : {Held::SharedNodes, Held::RigidNodes, Held::Tied, Held::Ground})
      for (const int variant : {0, 1, 2, 3}) {
        JointText t;
        t.version = version;
        t.held = held;
        t.quadratic = variant == 1;
        t.upper_layer = variant == 1 || variant == 2;
        t.one_section = variant == 2;
        t.ligament = variant >= 2;
        t.more = variant == 3;
        SCOPED_TRACE(fmt::format("{}, held {}, variant {}", version, static_cast<int>(held), variant));
        const std::string path = write_model(folder, t);
        Settings settings;
        settings.law = Law::Linear;  // on these few facets the plate would tip over on softer layers
        const Converted c = expect_same_joint(folder.path, path, settings);
        EXPECT_EQ(c.conversion.edited, version == "4.0" && !t.one_section) << all_of(c.conversion.changes);
        EXPECT_EQ(c.model.version, "4.0");
        EXPECT_TRUE(c.model.unsupported.empty());
        // Nothing deformable is left, nothing holds nodes of rigid elements, and every body says where its centre is.
        for (const Domain& d : c.model.domains)
          EXPECT_TRUE(c.model.materials[static_cast<std::size_t>(d.material)].rigid) << d.name;
        for (const Material& material : c.model.materials)
          EXPECT_TRUE(!material.rigid || material.center_of_mass) << material.name;
        EXPECT_EQ(c.model.rigid_nodes.size() + c.model.fixed_nodes.size(),
                  t.more && version == "4.0" && (held == Held::RigidNodes || held == Held::Ground) ? 2u
                  : t.more && version == "4.0"                                                     ? 1u
                  : t.more && (held == Held::RigidNodes || held == Held::Ground)                   ? 1u
                                                                                                   : 0u);
        for (const Contact& contact : c.model.contacts) EXPECT_TRUE(contact.dea) << contact.name;
      }
}

TEST(Convert, SettingsAreSaidInTheFile) {
  const test::TemporaryFolder folder;
  const std::string path = write_model(folder, {.upper_layer = true});
  Settings s;
  s.law = Law::NeoHookean;
  s.facets = Facets::Flat;
  s.refine = 2;
  s.source = "plate";
  s.E[""] = 7;
  s.nu["top"] = 0.2;
  s.thickness["plate face"] = 1.25;
  const Converted c = expect_same_joint(folder.path, path, s);
  const DeaContact& dea = *c.model.contacts[0].dea;
  EXPECT_EQ(dea.law, Law::NeoHookean);
  EXPECT_EQ(dea.facets, Facets::Flat);
  EXPECT_EQ(dea.refine, 2);
  EXPECT_EQ(dea.source, 1);
  EXPECT_EQ(dea.layers[0].E, 7);
  EXPECT_EQ(dea.layers[0].nu, 0.2);
  EXPECT_EQ(dea.layers[1].thickness, 1.25);
  EXPECT_EQ(dea.layers[0].thickness_map.size(), 36u);
}

// Thickness per node and its factor are in the file as maps and numbers.
TEST(Convert, ThicknessSaidAndScaledIsSaidInTheFile) {
  const test::TemporaryFolder folder;
  const std::string path = write_model(folder, {.upper_layer = true});
  Settings s;
  s.law = Law::Linear;
  s.thickness_scale[""] = 0.5;
  s.thickness["plate face"] = 1.25;
  const JointModel model = read_feb(path);
  for (std::size_t i = 0; i < model.nodes.size(); ++i)
    s.thickness_from["top"].at_node[model.node_ids[i]] = 1 + 0.01 * static_cast<double>(i);
  const Converted c = expect_same_joint(folder.path, path, s);
  const DeaContact& dea = *c.model.contacts[0].dea;
  EXPECT_EQ(dea.layers[1].thickness, 0.625);
  const Surface& top = c.model.surfaces[static_cast<std::size_t>(c.model.contacts[0].primary)];
  ASSERT_EQ(dea.layers[0].thickness_map.size(), top.nodes.size());
  for (std::size_t k = 0; k < top.nodes.size(); ++k)
    EXPECT_NEAR(dea.layers[0].thickness_map[k], 0.5 * (1 + 0.01 * top.nodes[k]), 1e-12);
}

// --rigid: a deformable bone. Its material becomes a rigid body.
TEST(Convert, BoneTakenAsRigid) {
  const test::TemporaryFolder folder;
  const std::string path = (folder.path / "model.feb").string();
  std::string text = model_text({});
  const std::string base = "<material id=\"2\" name=\"base\" type=\"rigid body\"><density>1</density></material>";
  ASSERT_NE(text.find(base), text.npos);
  text.replace(text.find(base), base.size(),
               "<material id=\"2\" name=\"base\" type=\"neo-Hookean\"><E>1000</E><v>0.3</v></material>");
  const std::size_t bc = text.find("<rigid_bc type=\"rigid_fixed\"><rb>base</rb>");
  text.erase(bc, text.find('\n', bc) + 1 - bc);
  write(path, text);
  Settings s;
  s.rigid = {"base"};
  s.free["base"] = {};
  EXPECT_EQ(fault(path, s).substr(0, 12), "--free base:");
  s.free.clear();
  const Converted c = convert(folder.path, path, s);
  EXPECT_TRUE(c.model.materials[1].rigid);
  EXPECT_TRUE(c.model.materials[1].center_of_mass);
  EXPECT_NE(all_of(c.conversion.changes).find("material \"base\": type neo-Hookean becomes rigid body (--rigid)"),
            std::string::npos);
  const Joint before = make_joint(read_feb(path), s), after = make_joint(c.model, {});
  EXPECT_EQ(before.bodies[0].center_of_mass, after.bodies[0].center_of_mass);
  EXPECT_EQ(before.contacts[0].layers[0].thickness, after.contacts[0].layers[0].thickness);

  // held by its nodes: the rigid body is held instead
  std::string ids;
  const JointModel plain = read_feb(path);
  for (const Domain& d : plain.domains)
    if (d.name == "base")
      for (int node : d.nodes)
        ids += fmt::format("{}{}", ids.empty() ? "" : ",", plain.node_ids[static_cast<std::size_t>(node)]);
  text.insert(text.find("</Mesh>"), "<NodeSet name=\"far\">" + ids + "</NodeSet>\n");
  text.insert(text.find("<Rigid>"),
              "<Boundary>\n<bc name=\"far\" type=\"zero displacement\" node_set=\"far\">\n<x_dof>1</x_dof>\n"
              "<y_dof>1</y_dof>\n<z_dof>1</z_dof>\n</bc>\n</Boundary>\n");
  write(path, text);
  s.law = Law::Linear;
  const Converted held = convert(folder.path, path, s);
  EXPECT_NE(all_of(held.conversion.changes).find("body \"base\": held in x, y, z, Ru, Rv, Rw, as its fixed nodes did"),
            std::string::npos)
      << all_of(held.conversion.changes);
  const Analysis solved = analyse(read_feb(path), s);
  EXPECT_GT(solved.states.back().statistics[0].peak, 0.0);
  expect_same(solved, analyse(held.model, {}));
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// Lines that are only in one of the texts, found by looking for the next three lines they share.
void differing_lines(const std::string& a, const std::string& b, std::vector<std::string>& only_a,
                     std::vector<std::string>& only_b) {
  const std::vector<std::string> x = lines_of(a), y = lines_of(b);
  const auto same = [&](std::size_t i, std::size_t j) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (i + k == x.size() && j + k == y.size()) return true;
      if (i + k >= x.size() || j + k >= y.size() || x[i + k] != y[j + k]) return false;
    }
    return true;
  };
  std::size_t i = 0, j = 0;
  while (i < x.size() || j < y.size()) {
    if (i < x.size() && j < y.size() && x[i] == y[j]) {
      ++i;
      ++j;
      continue;
    }
    std::size_t skip = 1, in_a = 0;
    for (bool found = false; !found; ++skip)
      for (in_a = 0; in_a <= skip && !found; ++in_a) found = same(i + in_a, j + skip - in_a);
    --skip;
    --in_a;
    for (std::size_t k = 0; k < in_a; ++k) only_a.push_back(x[i + k]);
    for (std::size_t k = 0; k < skip - in_a; ++k) only_b.push_back(y[j + k]);
    i += in_a;
    j += skip - in_a;
  }
}

TEST(Convert, OnlyTheListedElementsChange) {
  const test::TemporaryFolder folder;
  const std::string path = DEA_SAMPLES_DIR "/hip/hip_walking.feb";
  const std::string before = test::file_text(path);
  std::vector<std::string> gone, come;
  differing_lines(before, convert(folder.path, path).conversion.text, gone, come);
  const auto starts = [](const std::string& line, std::initializer_list<const char*> words) {
    const std::string rest = line.substr(std::min(line.find_first_not_of("\t"), line.size()));
    return std::any_of(words.begin(), words.end(), [&](const char* w) { return rest.rfind(w, 0) == 0; });
  };
  EXPECT_EQ(gone.size(), 2u + 9u + 2u * 3u);
  for (const std::string& line : gone)
    EXPECT_TRUE(starts(line, {"<SolidDomain", "<contact name", "<laugon>", "<penalty>", "<auto_penalty>", "<two_pass>",
                              "<symmetric_stiffness>0", "<search_radius>", "<search_tol>", "<fric_coeff>", "<dtol>",
                              "<etol>", "<rtol>"}))
        << line;
  for (const std::string& line : come)
    EXPECT_TRUE(starts(line, {"<SolidDomain", "<MeshData>", "</MeshData>", "<SurfaceData", "</SurfaceData>",
                              "<face lid", "<contact name", "<law>", "<facets>", "<source>", "<refine>", "<primary_",
                              "<secondary_", "<dtol>", "<etol>", "<rtol>", "<min_residual>", "<var type"}))
        << line;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  std::size_t at = text.find(from);
  EXPECT_NE(at, text.npos) << from;
  for (; at != text.npos; at = text.find(from, at + to.size())) text.replace(at, from.size(), to);
  return text;
}

// Line ends, comments and bytes that are no UTF-8 stay; the whole text is known.
TEST(Convert, EveryByteOfASmallModel) {
  const test::TemporaryFolder folder;
  const std::string path = (folder.path / "model.feb").string();
  JointText t;
  t.held = Held::Ground;
  t.more = true;
  t.ligament = true;
  std::string before = replaced(model_text(t), "a comment stays", "a comment <contact> stays, \xE4\xF6");
  before = replaced(before, "name=\"down\"", "name='down &amp; up'");
  Settings s;
  s.thickness["top"] = 2;
  for (const bool windows : {false, true}) {
    std::string from = windows ? replaced(before, "\n", "\r\n") : before;
    write(path, from);
    std::string expected = before;
    expected = replaced(expected, "</material>\n</Material>",
                        "</material>\n<material id=\"4\" name=\"ground\" type=\"rigid body\">\n<density>1</density>\n"
                        "<center_of_mass>0,0,0</center_of_mass>\n</material>\n</Material>");
    expected =
        replaced(expected, "<density>1</density></material>\n<material id=\"3\"",
                 "<density>1</density>\n<center_of_mass>0,0,0</center_of_mass>\n</material>\n<material id=\"3\"");
    expected = replaced(expected, "\n</Mesh>", "\n<NodeSet name=\"foot_not_rigid\">49</NodeSet>\n</Mesh>");
    expected = replaced(expected, "name=\"layer\" mat=\"cartilage\"", "name=\"layer\" mat=\"ground\"");
    expected = replaced(expected, "type=\"zero displacement\" node_set=\"foot\"",
                        "type=\"zero displacement\" node_set=\"foot_not_rigid\"");
    expected =
        replaced(expected, "</rigid_connector>\n",
                 "</rigid_connector>\n<rigid_bc name=\"ground held\" type=\"rigid_fixed\">\n<rb>ground</rb>\n"
                 "<Rx_dof>1</Rx_dof>\n<Ry_dof>1</Ry_dof>\n<Rz_dof>1</Rz_dof>\n<Ru_dof>1</Ru_dof>\n<Rv_dof>1</Rv_dof>\n"
                 "<Rw_dof>1</Rw_dof>\n</rigid_bc>\n");
    expected =
        replaced(expected, "type=\"sliding-elastic\" surface_pair=\"joint\">\n<penalty>20</penalty>\n",
                 "type=\"dea\" surface_pair=\"joint\">\n<law>layer</law>\n<facets>curved</facets>\n<source>primary"
                 "</source>\n<refine>1</refine>\n<primary_E>10</primary_E>\n<primary_nu>0.3</primary_nu>\n"
                 "<primary_thickness>2</primary_thickness>\n<secondary_thickness>0</secondary_thickness>\n");
    expected =
        replaced(expected, "<dtol>0.001</dtol>\n",
                 "<dtol>1e-06</dtol>\n<symmetric_stiffness>non-symmetric</symmetric_stiffness>\n<etol>1e-08</etol>\n"
                 "<rtol>1e-10</rtol>\n<min_residual>1e-12</min_residual>\n<max_refs>30</max_refs>\n"
                 "<qn_method type=\"BFGS\">\n<max_ups>0</max_ups>\n</qn_method>\n");
    expected =
        replaced(expected, "\n</plotfile>",
                 "\n<var type=\"contact gap\"/>\n<var type=\"contact force\"/>\n<var type=\"contact area\"/>\n"
                 "<var type=\"cartilage thickness\"/>\n<var type=\"joint space\"/>\n<var type=\"spring strain\"/>\n"
                 "</plotfile>");
    if (windows) expected = replaced(expected, "\n", "\r\n");
    const Converted c = expect_same_joint(folder.path, path, s);
    std::vector<std::string> gone, come;
    differing_lines(expected, c.conversion.text, gone, come);
    EXPECT_EQ(all_of(gone), "");
    EXPECT_EQ(all_of(come), "");
    EXPECT_TRUE(expected == c.conversion.text);
  }
}

// The one asked for, else the model's own, in every step; a matrix that it takes.
TEST(Convert, LinearSolver) {
  const test::TemporaryFolder folder;
  const std::string path = (folder.path / "model.feb").string();
  const auto converted = [&](const std::string& model, const std::string& linear_solver) {
    write(path, model);
    return convert_feb(read_feb(path), {}, (folder.path / "c.feb").string(), linear_solver);
  };
  const auto count = [](const std::string& text, const std::string& what) {
    int found = 0;
    for (std::size_t at = text.find(what); at != text.npos; at = text.find(what, at + 1)) ++found;
    return found;
  };
  constexpr const char *kSymmetric = "<symmetric_stiffness>symmetric<", *kNot = "<symmetric_stiffness>non-symmetric<";
  const std::string plain = model_text({});

  const Conversion without = converted(plain, "");
  EXPECT_EQ(count(without.text, "linear_solver"), 0);
  EXPECT_EQ(count(without.text, kNot), 2);
  const Conversion given = converted(plain, "skyline");
  EXPECT_TRUE(given.edited);
  EXPECT_EQ(count(given.text, "<linear_solver type=\"skyline\"/>"), 2) << given.text;
  EXPECT_EQ(count(given.text, kSymmetric), 2);
  EXPECT_NE(all_of(given.changes).find("solver of step 2: linear_solver skyline, symmetric_stiffness symmetric, dtol"),
            std::string::npos)
      << all_of(given.changes);

  const std::string own = "<linear_solver type=\"fgmres\"><max_iter>9</max_iter></linear_solver>";
  const std::string named = replaced(plain, "<dtol>", own + "<dtol>");
  const Conversion kept = converted(named, "");
  EXPECT_EQ(count(kept.text, own), 2);
  EXPECT_EQ(count(kept.text, kNot), 2);
  EXPECT_EQ(all_of(kept.changes).find("linear_solver"), std::string::npos);
  const Conversion other = converted(named, "pardiso");
  EXPECT_EQ(count(other.text, "<linear_solver type=\"pardiso\"></linear_solver>"), 2) << other.text;
  EXPECT_EQ(count(other.text, "linear_solver type"), 2);
  // one for symmetric matrices, which the model already gives it by FEBio's number
  const Conversion symmetric = converted(replaced(plain, "<dtol>",
                                                  "<linear_solver type=\"skyline\"/><symmetric_stiffness>1"
                                                  "</symmetric_stiffness><dtol>"),
                                         "");
  EXPECT_EQ(count(symmetric.text, "<symmetric_stiffness>1<"), 2);

  // what stands there empty, FEBio takes for 0: no check at all
  const Conversion empty =
      converted(replaced(plain, "<dtol>", "<rtol></rtol><etol/><max_refs> </max_refs><min_residual/><dtol>"), "");
  for (const char* line :
       {"<rtol>1e-10</rtol>", "<etol>1e-08</etol>", "<max_refs>30</max_refs>", "<min_residual>1e-12</min_residual>"})
    EXPECT_EQ(count(empty.text, line), 2) << line << empty.text;

  // a model of an older version is written anew
  const auto old = [](const std::string& solver) {
    return replaced(model_text({.version = "2.5"}), "<time_steps>", solver + "<time_steps>");
  };
  const Conversion anew = converted(old(own), "");
  EXPECT_FALSE(anew.edited);
  EXPECT_EQ(count(anew.text, own), 2) << anew.text;
  EXPECT_NE(all_of(anew.changes).find("solver and plot file: new, linear_solver fgmres as in the model"),
            std::string::npos)
      << all_of(anew.changes);
  EXPECT_EQ(count(converted(old(own), "skyline").text, "<linear_solver type=\"skyline\"/>"), 2);
  const Conversion gone = converted(old("<linear_solver type=\"psldlt\"/>"), "");
  EXPECT_EQ(count(gone.text, "linear_solver"), 0);
  EXPECT_NE(
      all_of(gone.changes).find("the model's linear_solver \"psldlt\" is left out, FEBio 4.11 has none of this name"),
      std::string::npos)
      << all_of(gone.changes);
}

TEST(Convert, IncludedFiles) {
  const test::TemporaryFolder folder;
  const std::string path = (folder.path / "model.feb").string();
  const std::string whole = model_text({});
  const auto cut = [&](const std::string& tag, std::string& rest) {
    const std::size_t begin = rest.find("<" + tag + ">"), end = rest.find("</" + tag + ">") + tag.size() + 3;
    const std::string part = rest.substr(begin, end - begin);
    rest.replace(begin, end - begin, fmt::format("<Include>{}.feb</Include>", tag));
    write(folder.path / (tag + ".feb"),
          "<?xml version=\"1.0\"?>\n<febio_spec version=\"4.0\">\n" + part + "\n</febio_spec>\n");
  };
  // The mesh, of which nothing changes: edited. Into another folder the include would not be found: written anew.
  std::string rest = whole;
  cut("Mesh", rest);
  write(path, rest);
  EXPECT_TRUE(expect_same_joint(folder.path, path).conversion.edited);
  const Conversion elsewhere = convert_feb(read_feb(path), {}, (fs::temp_directory_path() / "x.feb").string());
  EXPECT_FALSE(elsewhere.edited);
  EXPECT_NE(elsewhere.changes[0].text.find("it includes files from its own folder"), std::string::npos);
  // The materials, of which one changes: not here.
  rest = whole;
  cut("Material", rest);
  write(path, rest);
  const Converted other = expect_same_joint(folder.path, path);
  EXPECT_FALSE(other.conversion.edited);
  EXPECT_NE(other.conversion.changes[0].text.find("material \"base\" is not in this file itself"), std::string::npos)
      << other.conversion.changes[0].text;
  // The domains: not here.
  rest = whole;
  cut("MeshDomains", rest);
  write(path, rest);
  const Converted anew = expect_same_joint(folder.path, path);
  EXPECT_FALSE(anew.conversion.edited);
  EXPECT_NE(anew.conversion.changes[0].text.find("<MeshDomains> is not in this file itself"), std::string::npos)
      << anew.conversion.changes[0].text;
}

TEST(Convert, Refusals) {
  const test::TemporaryFolder folder;
  const std::string path = write_model(folder, {.upper_layer = true});
  Settings s;
  s.springs_at = SpringsAt::Bone;
  EXPECT_EQ(fault(path, s),
            "--springs-at bone: a contact of type dea has its springs on the articular surface; leave it out");
  constexpr const char* kOwn = "a converted file keeps the model's own motion and loads; change them in the model";
  s = {};
  s.force["plate"] = {0, 0, 1};
  EXPECT_EQ(fault(path, s), fmt::format("--force plate: {}", kOwn));
  s = {};
  s.load_at["plate"] = {};
  EXPECT_EQ(fault(path, s), fmt::format("--load-at plate: {}", kOwn));
  s = {};
  s.free["plate"] = {};
  EXPECT_EQ(fault(path, s), fmt::format("--free plate: {}", kOwn));
  s = {};
  s.set_values["load.force"] = 2;
  EXPECT_EQ(fault(path, s),
            "--set load.force: a converted file keeps the model's own springs and forces; change them in the model");
  s = {};
  s.layer_fit = LayerFit::OneTerm;
  EXPECT_EQ(fault(path, s), "--layer-terms 1: a contact of type dea takes two; leave it out");
  for (const char* option : {"loads", "motion", "skip-steps"}) {
    s = {};
    find_setting_option(option)->set(s, "", std::string(option) == "skip-steps" ? "true" : "t.csv");
    EXPECT_EQ(fault(path, s),
              fmt::format("--{}: a converted file keeps the model's own motion, loads and steps; change "
                          "them in the model",
                          option));
  }
  // --attach to the other body: rigid with it, the layer would make both one body.
  s = {};
  s.attach["top"] = "plate";
  s.thickness["top"] = 2;
  EXPECT_NE(fault(path, s), "no fault");

  const Converted c = convert(folder.path, path);
  EXPECT_NE(fault(c.path).find("contact \"joint\" is of type dea already: nothing to convert"), std::string::npos)
      << fault(c.path);
}

/// A text with others in it: each replaces the first of its kind.
std::string changed(std::string text, const std::vector<std::pair<std::string, std::string>>& changes) {
  for (const auto& [from, to] : changes) {
    const std::size_t at = text.find(from);
    if (at == text.npos) throw std::logic_error("not in the model: " + from);
    text.replace(at, from.size(), to);
  }
  return text;
}

// What the converted file could not say, or would say differently.
TEST(Convert, RefusalsOfModels) {
  struct Case {
    std::string name, model;
    std::vector<std::array<std::string, 3>> settings;  ///< option, name, value
    std::string says;
  };
  const auto nodes = [](const std::string& name, const std::string& ids) {
    return std::pair<std::string, std::string>(
        "<Surface name=\"top\">", "<NodeSet name=\"" + name + "\">" + ids + "</NodeSet>\n<Surface name=\"top\">");
  };
  const std::string plain = model_text({}),
                    connector = "type=\"{}\"><body_a>base</body_a><body_b>plate</body_b></rigid_connector>\n</Rigid>",
                    fix =
                        "<Boundary>\n<bc name=\"fix\" type=\"zero displacement\" node_set=\"{}\">\n<x_dof>1</x_dof>\n"
                        "<y_dof>{}</y_dof>\n<z_dof>{}</z_dof>\n</bc>\n</Boundary>\n<Rigid>";
  std::string step_rigid = "</Control>\n<Rigid>";
  const std::string soft_base = changed(
      plain,
      {{"<material id=\"2\" name=\"base\" type=\"rigid body\"><density>1</density></material>",
        "<material id=\"2\" name=\"base\" type=\"neo-Hookean\"><E>1000</E><v>0.3</v></material>"},
       {"<rigid_bc type=\"rigid_fixed\"><rb>base</rb><Rx_dof>1</Rx_dof><Ry_dof>1</Ry_dof><Rz_dof>1</Rz_dof><Ru_dof>1"
        "</Ru_dof><Rv_dof>1</Rv_dof><Rw_dof>1</Rw_dof></rigid_bc>\n",
        ""}});
  const Case cases[] = {
      {"a plane that is held in part",
       changed(plain, {nodes("side", "1,5,9,13,17,21,25"), {"<Rigid>", fmt::format(fmt::runtime(fix), "side", 0, 0)}}),
       {{"law", "", "layer"}},
       "2 edges of its rim are held across an axis; converted it would be 3, for a contact of type dea knows whole "
       "planes "
       "of symmetry alone: hold all nodes where the layer ends, or none, and put them into one plane, or convert"},
      {"a contact that is of type dea, beside another",
       changed(plain, {{"type=\"sliding-elastic\" surface_pair=\"joint\">\n<penalty>20</penalty>\n",
                        "type=\"dea\" surface_pair=\"joint\">\n"},
                       {"</Contact>",
                        "<contact name=\"other\" type=\"sliding-elastic\" surface_pair=\"joint\"/>\n</Contact>"}}),
       {{"contact", "", "joint"}},
       "contact \"joint\" is of type dea already: nothing to convert"},
      {"one layer of two bodies",
       changed(plain, {{"<material id=\"3\"",
                        "<material id=\"4\" name=\"other\" type=\"rigid body\"><density>1</density>"
                        "<center_of_mass>0,0,1</center_of_mass></material>\n<material id=\"3\""},
                       {"<Surface name=\"plate face\">",
                        "<Surface name=\"side\">\n<quad4 id=\"1\">4,8,24,20</quad4>\n</Surface>\n<Surface "
                        "name=\"plate face\">"},
                       {"<SurfacePair",
                        "<SurfacePair name=\"more\"><primary>side</primary><secondary>plate face</secondary>"
                        "</SurfacePair>\n<SurfacePair"},
                       {"</Contact>",
                        "<contact name=\"other\" type=\"sliding-elastic\" surface_pair=\"more\"/>\n</Contact>"}}),
       {{"attach", "side", "other"}, {"thickness", "side", "2"}, {"thickness", "top", "2"}},
       "the cartilage under surface \"side\" belongs to body \"base\" for one contact and to \"other\" for another; it "
       "can "
       "be rigid with one of them only"},
      {"a bone that is held in one step",
       changed(soft_base, {nodes("low", "1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16"),
                           {step_rigid, "</Control>\n" + fmt::format(fmt::runtime(fix), "low", 1, 1)}}),
       {{"rigid", "", "base"}},
       "fixed nodes \"fix\" hold bone \"base\", which becomes a rigid body, in one step only: make it a rigid body of "
       "the "
       "model and hold that"},
      {"a bone that holds two rigid materials together",
       changed(
           soft_base,
           {{"<material id=\"3\"",
             "<material id=\"4\" name=\"holder\" type=\"rigid body\"><density>1</density><center_of_mass>0,0,-5"
             "</center_of_mass></material>\n<material id=\"5\" name=\"other\" type=\"rigid body\"><density>1</density>"
             "<center_of_mass>0,0,-5</center_of_mass></material>\n<material id=\"3\""},
            nodes("left", "1,2,3,4"),
            nodes("right", "13,14,15,16"),
            {"<Rigid>",
             "<Boundary>\n<bc name=\"a\" type=\"rigid\" node_set=\"left\">\n<rb>holder</rb>\n</bc>\n<bc name=\"b\" "
             "type=\"rigid\" node_set=\"right\">\n<rb>other</rb>\n</bc>\n</Boundary>\n<Rigid>"}}),
       {{"rigid", "", "base"}},
       "materials \"holder\" and \"other\" are one body through rigid node sets; as rigid materials they would be two: "
       "give "
       "their elements one material"},
      {"cartilage with nodes of both bodies",
       changed(plain, {{"<Elements type=\"quad4\" name=\"plate\">\n",
                        "<Elements type=\"quad4\" name=\"plate\">\n<elem id=\"999\">17,18,34,33</elem>\n"}}),
       {{"attach", "top", "base"}},
       "the cartilage shares nodes with bodies \"base\" and \"plate\", which would become one rigid body; give each "
       "its own "
       "nodes"},
      {"cartilage beyond the surface",
       changed(model_text({.held = Held::RigidNodes}), {{"<quad4 id=\"1\">17,18,22,21</quad4>\n", ""}}),
       {{"law", "", "layer"}},
       "surface \"top\": its cartilage goes on beyond the selected facets, which the converted model cannot tell (it "
       "knows "
       "those under contact surfaces that share nodes with their bone): select the whole face, or convert with --law "
       "linear"},
      {"a connector that dea does not know, in a file that is written anew",
       changed(model_text({.upper_layer = true, .one_section = true}),
               {{"</Rigid>", "<rigid_connector name=\"x\" " + fmt::format(fmt::runtime(connector), "rigid muscle")}}),
       {},
       "rigid connector \"rigid muscle\" cannot be carried over: the file would have to be written anew, for an "
       "Elements "
       "section holds cartilage of several bodies, or other parts too, and is divided; open it in FEBio Studio and "
       "save "
       "it as one file of version 4.0"},
      {"a joint, in a file that is written anew",
       changed(model_text({.upper_layer = true, .one_section = true}),
               {{"</Rigid>", "<rigid_connector name=\"x\" " + fmt::format(fmt::runtime(connector), "rigid joint")}}),
       {},
       "rigid joint cannot be written into a new file: save the model as 4.0 in FEBio Studio, then dea convert leaves "
       "it as "
       "it is"},
      {"a load that turns with its body, which is placed turned",
       changed(plain, {{"<dof>Rz</dof>", "<dof>Rz</dof><load_type>1</load_type>"}}),
       {{"rotate", "plate", "0,0,1,5"}, {"rotate-about", "plate", "0,0,0"}},
       "load \"push\" turns with a body that is placed turned; turn its components in the model, or place the body "
       "without "
       "turning it"},
      {"a spring whose end is placed",
       model_text({.ligament = true}),
       {{"move", "plate", "0,0,-0.01"}},
       "and they are placed 2."},
  };
  const test::TemporaryFolder folder;
  const std::string path = (folder.path / "model.feb").string();
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    write(path, c.model);
    Settings s;
    for (const auto& [option, name, value] : c.settings) find_setting_option(option)->set(s, name, value);
    const std::string found = fault(path, s);
    EXPECT_NE(found.find(c.says), std::string::npos) << found;
  }
}

// ---- the program
// -----------------------------------------------------------------------------------------------------

TEST(ConvertProgram, WritesBesideTheModelAndListsWhatChanged) {
  const test::TemporaryFolder folder;
  write(folder.path / "hip.feb", model_text({}));
  const test::Finished f = test::run_program(folder.path, {DEA_PROGRAM, "convert", "hip.feb"}, 60);
  EXPECT_EQ(f.code, 0) << f.err;
  EXPECT_TRUE(fs::exists(folder.path / "hip_dea.feb"));
  EXPECT_NE(f.out.find("hip_dea.feb\n"), std::string::npos);
  EXPECT_NE(f.out.find("domain \"layer\": material \"cartilage\" becomes \"base\", rigid\n"), std::string::npos)
      << f.out;
  EXPECT_EQ(test::file_text(folder.path / "hip.feb"), model_text({}));
  const test::Finished run = test::run_program(folder.path, {DEA_PROGRAM, "run", "hip_dea.feb", "-q"}, 60);
  EXPECT_EQ(run.code, 0) << run.err;

  const auto code = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {DEA_PROGRAM, "convert"});
    const test::Finished g = test::run_program(folder.path, words, 60);
    EXPECT_EQ(std::count(g.err.begin(), g.err.end(), '\n'), 1) << g.err;
    EXPECT_EQ(g.out, "");
    return g.code;
  };
  EXPECT_EQ(code({"hip.feb", "-o", "hip.feb"}), 2);
  EXPECT_EQ(code({"hip.feb", "-o", "-"}), 2);
  EXPECT_EQ(code({"hip.feb", "--springs-at", "bone"}), 2);
  EXPECT_EQ(code({"none.feb"}), 3);
  EXPECT_EQ(code({"hip_dea.feb"}), 3);
  EXPECT_EQ(code({"hip.feb", "-o", "nowhere/x.feb"}), 4);

  const test::Finished unknown =
      test::run_program(folder.path, {DEA_PROGRAM, "convert", "hip.feb", "--linear-solver", "mumps"}, 60);
  EXPECT_EQ(unknown.code, 2);
  EXPECT_EQ(unknown.err,
            "dea: --linear-solver mumps: found \"mumps\", expected accelerate, mkl_dss, pardiso, pardiso-project, "
            "pardiso_64, skyline, superlu_mt\n");
  ASSERT_EQ(test::run_program(folder.path,
                              {DEA_PROGRAM, "convert", "hip.feb", "--linear-solver", "Skyline", "-o", "sky.feb"}, 60)
                .code,
            0);
  EXPECT_NE(test::file_text(folder.path / "sky.feb").find("<linear_solver type=\"skyline\"/>"), std::string::npos);

  // a model of somebody else's stays; one that this command made gives way, and so does an empty file
  write(folder.path / "other.feb", "<febio_spec version=\"4.0\"></febio_spec>\n");
  write(folder.path / "empty.feb", "");
  EXPECT_EQ(code({"hip.feb", "-o", "other.feb"}), 4);
  EXPECT_EQ(test::file_text(folder.path / "other.feb"), "<febio_spec version=\"4.0\"></febio_spec>\n");
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"-o", "other.feb", "--overwrite"}, {"--law", "linear"}, {"-o", "empty.feb"}}) {
    std::vector<std::string> all = {DEA_PROGRAM, "convert", "hip.feb", "-q"};
    all.insert(all.end(), words.begin(), words.end());
    EXPECT_EQ(test::run_program(folder.path, all, 60).code, 0) << words.back();
  }
  for (const char* name : {"other.feb", "empty.feb", "hip_dea.feb"})
    EXPECT_NE(test::file_text(folder.path / name).find("type=\"dea\""), std::string::npos) << name;
  const test::Finished help = test::run_program(folder.path, {DEA_PROGRAM, "convert", "--help"}, 60);
  EXPECT_EQ(help.code, 0);
  EXPECT_NE(help.out.find("Examples:"), std::string::npos);
}

}  // namespace dea::convert_test

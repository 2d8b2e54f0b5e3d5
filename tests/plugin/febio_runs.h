// tests/plugin/febio_runs.h – febio4 with the plugin on models made here: run it, read its errors and valgrind's.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "tests/program.h"

namespace dea::test {

// -- models ------------------------------------------------------------------------------------------

struct Block {
  std::string nodes, layer, plate, bottom, bottom_list, top;
};

/// A layer of 2 x 2 elements of 1.5 x 1.5 x 2 on a rigid base (its lowest nodes), 0.1 under a rigid plate.
inline Block block(bool quadratic) {
  Block b;
  std::map<std::array<int, 3>, int> ids;
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 5; ++i) {
        const int odd = i % 2 + j % 2 + k % 2;
        if (odd > (quadratic ? 1 : 0)) continue;
        const int id = static_cast<int>(ids.size()) + 1;
        ids[{i, j, k}] = id;
        b.nodes += fmt::format("<node id=\"{}\">{},{},{}</node>\n", id, 0.75 * i, 0.75 * j, k - 2);
        if (k > 0) continue;
        b.bottom += fmt::format("<n id=\"{}\"/>", id);
        b.bottom_list += fmt::format("{}{}", b.bottom_list.empty() ? "" : ",", id);
      }
  const int n = static_cast<int>(ids.size());
  for (int c = 0; c < 4; ++c)
    b.nodes += fmt::format("<node id=\"{}\">{},{},0.1</node>\n", n + 1 + c, c == 1 || c == 2 ? 4 : -1, c >= 2 ? 4 : -1);
  b.plate = fmt::format("{},{},{},{}", n + 1, n + 2, n + 3, n + 4);
  constexpr int kCorner[4][2] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}}, kMiddle[4][2] = {{1, 0}, {2, 1}, {1, 2}, {0, 1}};
  int element = 0;
  for (int y = 0; y < 4; y += 2)
    for (int x = 0; x < 4; x += 2) {
      const auto ring = [&](const int(&corners)[4][2], int k) {
        std::string text;
        for (const auto& c : corners) text += fmt::format(",{}", ids.at({x + c[0], y + c[1], k}));
        return text;
      };
      std::string nodes = ring(kCorner, 0) + ring(kCorner, 2), facet = ring(kCorner, 2);
      if (quadratic) {
        nodes += ring(kMiddle, 0) + ring(kMiddle, 2) + ring(kCorner, 1);
        facet += ring(kMiddle, 2);
      }
      ++element;
      b.layer += fmt::format("<elem id=\"{}\">{}</elem>\n", element, nodes.substr(1));
      b.top += fmt::format("<{0} id=\"{1}\">{2}</{0}>\n", quadratic ? "quad8" : "quad4", element, facet.substr(1));
    }
  return b;
}

struct Parts {
  std::string material = R"(type="neo-Hookean"><E>10</E><v>0.3</v>)";
  std::string contact_parameters = "<penalty>1</penalty>";
  std::string more;       ///< sections before LoadData
  std::string more_mesh;  ///< of 4.0
  std::string motion =
      R"(<rigid_bc name="down" type="rigid_displacement"><rb>plate</rb><dof>z</dof><value lc="1">-0.3</value></rigid_bc>)";
  std::string bottom = R"(<Boundary><bc name="glue" type="rigid" node_set="bottom"><rb>base</rb></bc></Boundary>)";
};

inline std::string materials(const Parts& p) {
  return fmt::format(
      "<Material><material id=\"1\" name=\"cartilage\" {}</material>\n"
      "<material id=\"2\" name=\"base\" type=\"rigid "
      "body\"><density>1</density><center_of_mass>1.5,1.5,-2</center_of_mass>"
      "</material>\n<material id=\"3\" name=\"plate\" type=\"rigid body\"><density>2</density><center_of_mass>1,1,1"
      "</center_of_mass></material></Material>\n",
      p.material);
}

inline constexpr const char* kHead = "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>\n<febio_spec version=\"{}\">\n";
inline constexpr const char* kControl = "<Control><time_steps>4</time_steps><step_size>0.25</step_size></Control>";
inline constexpr const char* kControl4 =
    "<Control><time_steps>4</time_steps><step_size>0.25</step_size><solver type=\"solid\"/></Control>";

inline std::string model_25(bool quadratic, const Parts& p = {}) {
  const Block b = block(quadratic);
  std::string nodes = b.bottom;
  for (std::size_t at; (at = nodes.find("<n ")) != nodes.npos;) nodes.replace(at, 3, "<node ");
  return fmt::format(kHead, "2.5") + "<Module type=\"solid\"/>\n" + kControl + materials(p) +
         fmt::format(
             "<Geometry><Nodes>{}</Nodes><Elements type=\"{}\" mat=\"1\" name=\"layer\">{}</Elements>\n"
             "<Elements type=\"quad4\" mat=\"3\" name=\"plate\"><elem id=\"5\">{}</elem></Elements>\n"
             "<NodeSet name=\"bottom\">{}</NodeSet><Surface name=\"top\">{}</Surface><Surface name=\"under\">"
             "<quad4 id=\"1\">{}</quad4></Surface><SurfacePair name=\"pair\"><master surface=\"under\"/>"
             "<slave surface=\"top\"/></SurfacePair></Geometry>\n"
             "<MeshData><ElementData var=\"shell thickness\" elem_set=\"plate\"><elem lid=\"1\">0.5,0.5,0.5,0.5</elem>"
             "</ElementData></MeshData>\n",
             b.nodes, quadratic ? "hex20" : "hex8", b.layer, b.plate, nodes, b.top, b.plate) +
         R"(<Boundary><rigid rb="2" node_set="bottom"/>
<rigid_body mat="2"><fixed bc="x"/><fixed bc="y"/><fixed bc="z"/><fixed bc="Rx"/><fixed bc="Ry"/><fixed bc="Rz"/></rigid_body>
<rigid_body mat="3"><fixed bc="x"/><fixed bc="y"/><fixed bc="Rx"/><fixed bc="Ry"/><fixed bc="Rz"/>
<prescribed bc="z" lc="1">-0.3</prescribed></rigid_body></Boundary>
<Contact><contact name="touch" type="facet-to-facet sliding" surface_pair="pair"><penalty>1</penalty></contact></Contact>
<LoadData><loadcurve id="1" type="smooth"><point>0,0</point><point>1,1</point></loadcurve></LoadData>
</febio_spec>
)";
}

/// Mesh of 3.0 and 4.0. `thickness`: of the plate's domain; FEBio reads it in 3.0 and does not use it.
inline std::string mesh_3(const Block& b, bool quadratic, const std::string& bottom, const std::string& more,
                          const std::string& thickness) {
  return fmt::format(
      "<Mesh><Nodes name=\"all\">{}</Nodes><Elements type=\"{}\" name=\"layer\">{}</Elements>\n"
      "<Elements type=\"quad4\" name=\"plate\"><elem id=\"5\">{}</elem></Elements>\n"
      "<NodeSet name=\"bottom\">{}</NodeSet><Surface name=\"top\">{}</Surface><Surface name=\"under\">"
      "<quad4 id=\"1\">{}</quad4></Surface>{}<SurfacePair name=\"pair\"><primary>top</primary>"
      "<secondary>under</secondary></SurfacePair></Mesh>\n"
      "<MeshDomains><SolidDomain name=\"layer\" mat=\"cartilage\"/><ShellDomain name=\"plate\" mat=\"plate\">"
      "{}</ShellDomain></MeshDomains>\n",
      b.nodes, quadratic ? "hex20" : "hex8", b.layer, b.plate, bottom, b.top, b.plate, more, thickness);
}

constexpr const char* kCurve3 =
    R"(<LoadData><load_controller id="1" type="loadcurve"><interpolate>SMOOTH</interpolate><points><point>0,0</point><point>1,1</point></points></load_controller></LoadData>
</febio_spec>
)";

inline std::string model_30(bool quadratic, const Parts& p = {}) {
  const Block b = block(quadratic);
  return fmt::format(kHead, "3.0") + "<Module type=\"solid\"/>\n" + kControl + materials(p) +
         mesh_3(b, quadratic, b.bottom, "", "") +
         "<MeshData><ElementData var=\"shell thickness\" elem_set=\"plate\"><elem lid=\"1\">0.5,0.5,0.5,0.5</elem>"
         "</ElementData></MeshData>\n" +
         R"(<Boundary><bc name="glue" type="rigid" node_set="bottom"><rb>base</rb></bc></Boundary>
<Rigid><rigid_constraint name="a" type="fix"><rb>base</rb><dofs>Rx,Ry,Rz,Ru,Rv,Rw</dofs></rigid_constraint>
<rigid_constraint name="b" type="fix"><rb>plate</rb><dofs>Rx,Ry,Ru,Rv,Rw</dofs></rigid_constraint>
<rigid_constraint name="c" type="prescribe"><rb>plate</rb><dof>Rz</dof><value lc="1">-0.3</value></rigid_constraint></Rigid>
<Contact><contact name="touch" type="sliding-facet-on-facet" surface_pair="pair"><penalty>1</penalty></contact></Contact>
)" + kCurve3;
}

inline std::string model_40(bool quadratic, const Parts& p = {}) {
  const Block b = block(quadratic);
  return fmt::format(kHead, "4.0") + "<Module type=\"solid\"><units>mm-N-s</units></Module>\n" + kControl4 +
         materials(p) + mesh_3(b, quadratic, b.bottom_list, p.more_mesh, "<shell_thickness>0.5</shell_thickness>") +
         p.bottom +
         R"(<Rigid><rigid_bc name="a" type="rigid_fixed"><rb>base</rb><Rx_dof>1</Rx_dof><Ry_dof>1</Ry_dof><Rz_dof>1</Rz_dof><Ru_dof>1</Ru_dof><Rv_dof>1</Rv_dof><Rw_dof>1</Rw_dof></rigid_bc>
<rigid_bc name="b" type="rigid_fixed"><rb>plate</rb><Rx_dof>1</Rx_dof><Ry_dof>1</Ry_dof><Ru_dof>1</Ru_dof><Rv_dof>1</Rv_dof><Rw_dof>1</Rw_dof></rigid_bc>
)" + p.motion +
         "</Rigid>\n<Contact><contact name=\"touch\" type=\"sliding-elastic\" surface_pair=\"pair\">" +
         p.contact_parameters + "</contact></Contact>\n" + p.more + kCurve3;
}

/// One of everything that has a place in a JointModel.
inline std::string rich_model() {
  Parts p;
  p.material =
      R"(type="uncoupled solid mixture"><k>10</k><solid type="Mooney-Rivlin"><c1>1</c1><k>5</k></solid><solid type="Mooney-Rivlin"><c1>2</c1></solid>)";
  p.more_mesh =
      "<NodeSet name=\"corner\">1:3</NodeSet><ElementSet name=\"some\">1,3</ElementSet>"
      "<DiscreteSet name=\"strings\"><delem>1,3</delem><delem>2,19</delem></DiscreteSet>"
      "<SurfacePair name=\"tie\"><primary>top</primary><secondary>under</secondary></SurfacePair>";
  p.contact_parameters = "<fric_coeff>0.2</fric_coeff><search_radius>3</search_radius><offset>0.1</offset>";
  p.bottom =
      R"(<Boundary><bc name="glue" type="rigid" node_set="@surface:top"><rb>base</rb></bc>
<bc name="stuck" type="zero displacement" node_set="corner"><x_dof>1</x_dof><z_dof>1</z_dof></bc>
<bc name="still" type="prescribed displacement" node_set="bottom"><dof>y</dof><value lc="2">0</value></bc>
<bc name="turn" type="zero rotation" node_set="corner"><u_dof>1</u_dof></bc></Boundary>
)";
  p.motion =
      R"(<rigid_load name="push" type="rigid_force"><rb>plate</rb><dof>Rz</dof><value lc="3">-7</value></rigid_load>
<rigid_load name="follow" type="rigid_force"><rb>plate</rb><dof>Rx</dof><value>2</value><load_type>FOLLOW</load_type></rigid_load>
<rigid_load name="twist" type="rigid_moment"><rb>3</rb><dof>Rv</dof><value lc="2">0.5</value></rigid_load>
<rigid_connector name="string" type="rigid spring"><body_a>base</body_a><body_b>plate</body_b><k>7</k><insertion_a>1,2,-2</insertion_a><insertion_b>1,2,3.25</insertion_b><free_length>2.5</free_length></rigid_connector>
<rigid_connector name="oil" type="rigid damper"><body_a>base</body_a><body_b>plate</body_b></rigid_connector>
)";
  p.more =
      R"(<Discrete><discrete_material id="1" name="s" type="linear spring"><E>3</E></discrete_material>
<discrete_material id="2" name="t" type="tension-only linear spring"><E>4</E></discrete_material>
<discrete dmat="2" discrete_set="strings"/></Discrete>
<Step><step id="1" name="one"><Control><time_steps>-1</time_steps><final_time>0.7</final_time><step_size>0.1</step_size><time_stepper><dtmax lc="3">0.1</dtmax></time_stepper><solver type="solid"/></Control>
<Rigid><rigid_bc name="turn" type="rigid_rotation"><rb>plate</rb><dof>Rw</dof><value lc="1">0.1</value><relative>1</relative></rigid_bc>
<rigid_load name="lift" type="rigid_force"><rb>plate</rb><dof>Ry</dof><value lc="1">3</value></rigid_load></Rigid></step>
<step id="2" name="two"><Control><time_steps>3</time_steps><step_size>0.2</step_size><time_stepper><dtmax lc="3">0</dtmax></time_stepper><solver type="solid"/></Control>
<Rigid><rigid_bc name="vector" type="rigid_rotation_vector"><rb>plate</rb><vx lc="1">0.1</vx><vy>0</vy><vz>-0.2</vz></rigid_bc>
<rigid_bc name="slide" type="rigid_displacement"><rb>plate</rb><dof>x</dof><value>0.5</value></rigid_bc>
<rigid_bc name="b" type="rigid_fixed"><rb>plate</rb><Rz_dof>1</Rz_dof></rigid_bc></Rigid>
<Contact><contact name="later" type="tied-node-on-facet" surface_pair="tie"><max_distance>0.3</max_distance></contact></Contact></step></Step>
)";
  std::string text = model_40(false, p);
  const std::string old = "</load_controller></LoadData>";
  text.replace(text.find(old), old.size(), R"(</load_controller>
<load_controller id="2" name="steps" type="loadcurve"><interpolate>STEP</interpolate><extend>REPEAT OFFSET</extend><points><pt>0,0.5</pt><pt>1,2</pt></points></load_controller>
<load_controller id="3" name="must" type="loadcurve"><interpolate>LINEAR</interpolate><extend>EXTRAPOLATE</extend><points><pt>0,0.1</pt><pt>0.35,0.1</pt><pt>0.7,0.2</pt><pt>0.9,0.1</pt><pt>2,0.1</pt></points></load_controller></LoadData>)");
  return text;
}

// -- running -----------------------------------------------------------------------------------------

inline void write(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

inline Finished febio(const fs::path& folder, const std::string& model, const std::string& task,
                      const std::string& control = "", std::vector<std::string> more = {},
                      const std::string& plugin = DEA_PLUGIN) {
  std::vector<std::string> words = {DEA_FEBIO4, "-nosplash", "-i", model, "-import", plugin};
  words.insert(words.end(), more.begin(), more.end());
  words.push_back("-task=" + task);
  if (!control.empty()) words.push_back(control);
  return run_program(folder, words, 300);
}

inline std::vector<fs::path> models_in(const fs::path& folder) {
  std::vector<fs::path> models;
  std::error_code error;
  for (const auto& entry : fs::recursive_directory_iterator(folder, error))
    if (entry.path().extension() == ".feb") models.push_back(entry.path());
  std::sort(models.begin(), models.end());
  return models;
}

inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// What febio4 prints in boxes of errors (or warnings), as one line each; words that are longer than a box is wide are
/// in pieces.
inline std::vector<std::string> errors_of(const std::string& out, const std::string& title = "ERROR") {
  std::vector<std::string> errors;
  bool in_error = false;
  for (const std::string& line : lines_of(out)) {
    if (line.rfind(" ***", 0) == 0) {
      in_error = false;
    } else if (line.rfind(" *", 0) == 0) {
      std::string text = line.substr(2, line.rfind('*') - 2);
      text.erase(text.find_last_not_of(' ') + 1);
      text.erase(0, std::min(text.find_first_not_of(' '), text.size()));
      if (text == title) {
        in_error = true;
        errors.emplace_back();
      } else if (in_error) {
        errors.back() += (errors.back().empty() ? "" : " ") + text;
      }
    }
  }
  return errors;
}

/// Records of valgrind, leaks or accesses, that go through our library or what it loads. FEBio never deletes a task.
inline std::vector<std::string> memory_faults(const std::string& valgrind_log) {
  std::vector<std::string> faults;
  std::string record;
  for (const std::string& line : lines_of(valgrind_log)) {
    const std::size_t text = line.find("== ");
    if (text != line.npos && line.size() > text + 3) {
      record += line.substr(text + 3) + "\n";
      continue;
    }
    const auto through = [&](const char* what) { return record.find(what) != record.npos; };
    const bool stack = through("   at ") && (through("libfebio_dea") || through("libtbb"));
    if (stack && !through("FERegisterClass_T<DeaTask>::Create")) faults.push_back(record);
    record.clear();
  }
  return faults;
}

}  // namespace dea::test

// The plugin from outside: febio4 and `dea run` on the same models, and everything that can go wrong.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <set>

#include "error.h"
#include "model_dump.h"
#include "program.h"
#include "read_feb.h"

namespace dea::test {
namespace {

using Json = nlohmann::json;

// -- models ------------------------------------------------------------------------------------------

struct Block {
  std::string nodes, layer, plate, bottom, bottom_list, top;
};

/// A layer of 2 x 2 elements of 1.5 x 1.5 x 2 on a rigid base (its lowest nodes), 0.1 under a rigid plate.
Block block(bool quadratic) {
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

std::string materials(const Parts& p) {
  return fmt::format(
      "<Material><material id=\"1\" name=\"cartilage\" {}</material>\n"
      "<material id=\"2\" name=\"base\" type=\"rigid "
      "body\"><density>1</density><center_of_mass>1.5,1.5,-2</center_of_mass>"
      "</material>\n<material id=\"3\" name=\"plate\" type=\"rigid body\"><density>2</density><center_of_mass>1,1,1"
      "</center_of_mass></material></Material>\n",
      p.material);
}

constexpr const char* kHead = "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>\n<febio_spec version=\"{}\">\n";
constexpr const char* kControl = "<Control><time_steps>4</time_steps><step_size>0.25</step_size></Control>";
constexpr const char* kControl4 =
    "<Control><time_steps>4</time_steps><step_size>0.25</step_size><solver type=\"solid\"/></Control>";

std::string model_25(bool quadratic, const Parts& p = {}) {
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
std::string mesh_3(const Block& b, bool quadratic, const std::string& bottom, const std::string& more,
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

std::string model_30(bool quadratic, const Parts& p = {}) {
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

std::string model_40(bool quadratic, const Parts& p = {}) {
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
std::string rich_model() {
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

void write(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

Finished febio(const fs::path& folder, const std::string& model, const std::string& task,
               const std::string& control = "", std::vector<std::string> more = {},
               const std::string& plugin = DEA_PLUGIN) {
  std::vector<std::string> words = {DEA_FEBIO4, "-nosplash", "-i", model, "-import", plugin};
  words.insert(words.end(), more.begin(), more.end());
  words.push_back("-task=" + task);
  if (!control.empty()) words.push_back(control);
  return run_program(folder, words, 300);
}

std::vector<fs::path> models_in(const fs::path& folder) {
  std::vector<fs::path> models;
  std::error_code error;
  for (const auto& entry : fs::recursive_directory_iterator(folder, error))
    if (entry.path().extension() == ".feb") models.push_back(entry.path());
  std::sort(models.begin(), models.end());
  return models;
}

/// Largest relative difference of two JSON values, their times of day left out; 1e300: not the same kind of thing.
double difference(const Json& a, const Json& b) {
  if (a.is_number() && b.is_number()) {
    const double x = a.get<double>(), y = b.get<double>();
    return x == y ? 0.0 : std::abs(x - y) / std::max(std::abs(x), std::abs(y));
  }
  if (a.type() != b.type() || a.size() != b.size()) return 1e300;
  if (!a.is_structured()) return a == b ? 0.0 : 1e300;
  double largest = 0.0;
  for (const auto& item : a.items()) {
    if (item.key() == "timings") continue;
    if (a.is_object() && !b.contains(item.key())) return 1e300;
    const Json& other = a.is_object() ? b.at(item.key()) : b.at(std::stoul(item.key()));
    largest = std::max(largest, difference(item.value(), other));
  }
  return largest;
}

/// febio4 and dea on one model: the same JSON, CSV and plot file.
void expect_the_same(const fs::path& folder, const std::string& model, const std::string& settings = "") {
  SCOPED_TRACE(model + " " + settings);
  write(folder / "task.xml",
        "<febiodea_settings version=\"1\"><output>task.xplt</output><json>task.json</json><csv>task.csv</csv>" +
            settings + "</febiodea_settings>");
  write(folder / "cli.xml", "<febiodea_settings version=\"1\">" + settings + "</febiodea_settings>");
  const Finished task = febio(folder, model, "dea", "task.xml");
  const Finished cli = run_program(
      folder,
      {DEA_PROGRAM, "run", model, "-o", "cli.xplt", "--json", "cli.json", "--csv", "cli.csv", "--settings", "cli.xml"},
      300);
  ASSERT_EQ(cli.code == 0, task.code == 0) << cli.err << task.out;
  ASSERT_TRUE(fs::exists(folder / "task.json")) << task.out << task.err;
  const Json a = Json::parse(file_text(folder / "task.json")), b = Json::parse(file_text(folder / "cli.json"));
  EXPECT_GE(a["states"].size(), 1u);
  EXPECT_LE(difference(a, b), 1e-9);
  EXPECT_EQ(file_text(folder / "task.csv"), file_text(folder / "cli.csv"));
  EXPECT_EQ(file_text(folder / "task.xplt"), file_text(folder / "cli.xplt"));
}

TEST(Plugin, OnlyTheEntryPointsAreExported) {
  const TemporaryFolder folder;
  const Finished nm = run_program(folder.path, {DEA_NM, "-D", "--defined-only", DEA_PLUGIN}, 60);
  std::set<std::string> names;
  std::istringstream lines(nm.out);
  for (std::string address, kind, name; lines >> address >> kind >> name;) names.insert(name);
  EXPECT_EQ(names, (std::set<std::string>{"GetSDKVersion", "GetPluginVersion", "PluginInitialize", "PluginCleanup"}));
}

TEST(Plugin, SamplesAsDeaRunSolvesThem) {
  const TemporaryFolder folder;
  for (const fs::path& model : models_in(DEA_SAMPLES_DIR)) {
    fs::copy(model, folder.path / model.filename());
    expect_the_same(folder.path, model.filename().string());
  }
}

TEST(Plugin, ReferenceModelsAsDeaRunSolvesThem) {
  const std::vector<fs::path> models = models_in(DEA_REFERENCE_DIR);
  if (models.empty()) GTEST_SKIP() << "no models in " << DEA_REFERENCE_DIR;
  const TemporaryFolder folder;
  for (const fs::path& model : models) {
    fs::copy(model, folder.path / model.filename());
    expect_the_same(folder.path, model.filename().string());
  }
}

TEST(Plugin, EveryVersionAndQuadraticElements) {
  const TemporaryFolder folder;
  for (const bool quadratic : {false, true}) {
    write(folder.path / "m25.feb", model_25(quadratic));
    write(folder.path / "m30.feb", model_30(quadratic));
    write(folder.path / "m40.feb", model_40(quadratic));
    for (const char* model : {"m25.feb", "m30.feb", "m40.feb"}) expect_the_same(folder.path, model);
  }
}

TEST(Plugin, SettingsHoldForTheTask) {
  const TemporaryFolder folder;
  write(folder.path / "m.feb", model_40(false));
  for (const char* settings :
       {"<law>logarithmic</law><refine>3</refine><states>last</states>",
        "<thickness>1.5</thickness><E surface=\"top\">3</E>", "<source>plate</source><states>0.3,1</states>",
        "<facets>flat</facets><squash>false</squash>",
        "<free body=\"plate\">x,y</free><force body=\"plate\">0,0,-3</force><load-at body=\"plate\">1,1,1</load-at>"})
    expect_the_same(folder.path, "m.feb", settings);
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// What febio4 prints in boxes of errors, as one line each; words that are longer than a box is wide are in pieces.
std::vector<std::string> errors_of(const std::string& out) {
  std::vector<std::string> errors;
  bool in_error = false;
  for (const std::string& line : lines_of(out)) {
    if (line.rfind(" ***", 0) == 0) {
      in_error = false;
    } else if (line.rfind(" *", 0) == 0) {
      std::string text = line.substr(2, line.rfind('*') - 2);
      text.erase(text.find_last_not_of(' ') + 1);
      text.erase(0, std::min(text.find_first_not_of(' '), text.size()));
      if (text == "ERROR") {
        in_error = true;
        errors.emplace_back();
      } else if (in_error) {
        errors.back() += (errors.back().empty() ? "" : " ") + text;
      }
    }
  }
  return errors;
}

TEST(Plugin, EveryFaultIsOneErrorAndAnExitCode) {
  const TemporaryFolder folder;
  write(folder.path / "m.feb", model_40(false));
  std::string text = model_40(false);
  const std::string contact =
      text.substr(text.find("<Contact>"), text.find("</Contact>") + 10 - text.find("<Contact>"));
  text.replace(text.find(contact), contact.size(), "");
  write(folder.path / "none.feb", text);
  Parts loose;
  loose.bottom = "";
  write(folder.path / "loose.feb", model_40(false, loose));
  Parts pressed;
  pressed.more =
      "<Loads><surface_load name=\"l\" type=\"pressure\" surface=\"under\"><pressure lc=\"1\">1</pressure>"
      "</surface_load></Loads>";
  write(folder.path / "pressed.feb", model_40(false, pressed));
  const auto settings = [&](const std::string& elements) {
    write(folder.path / "s.xml", "<febiodea_settings version=\"1\">" + elements + "</febiodea_settings>");
    return "s.xml";
  };
  const auto expect = [&](const std::string& model, const std::string& control, const std::string& fault) {
    const Finished f = febio(folder.path, model, "dea", control);
    EXPECT_EQ(f.code, 1) << fault;
    EXPECT_EQ(errors_of(f.out), std::vector<std::string>{fault});
    EXPECT_EQ(lines_of(f.err).size(), 1u) << f.err;  // FEBio's, that the plugin is there
    const fs::path log = fs::path(control.empty() ? model : control).replace_extension(".log");
    EXPECT_EQ(errors_of(file_text(folder.path / log)), std::vector<std::string>{fault});
  };
  expect("m.feb", "missing.xml", "missing.xml: found no readable file, expected a settings file");
  expect("m.feb", settings("<law>cubic</law>"),
         "s.xml:1: <law>: found \"cubic\", expected linear, logarithmic or neo-Hookean");
  expect("m.feb", settings("<source>100% femur</source>"),
         "dea: --source 100% femur: the model has no rigid body of this name; it has \"base\", \"plate\", \"ground\"");
  expect("m.feb", settings("<output>no/such/folder.xplt</output>"),
         "dea: cannot write no/such/folder.xplt: there is no folder no/such");
  expect("m.feb", settings("<output>m.feb</output>"), "dea: <output> m.feb: would overwrite the model");
  expect("m.feb", settings("<json>s.xml</json>"), "dea: <json> s.xml: would overwrite the settings file");
  expect("m.feb", settings("<csv>s.log</csv>"), "dea: <csv> s.log: would overwrite FEBio's log file");
  expect("m.feb", settings("<json>-</json>"), "dea: <json> -: standard output is FEBio's, give it a file name");
  expect("m.feb", settings("<states>7</states>"),
         "dea: s.xml: <states>: found time 7, expected times from 0 to 1, those of the model");
  expect("none.feb", "",
         "none.feb: no sliding contact in the model; DEA needs one between two bodies (Contact section, e.g. type "
         "\"sliding-elastic\")");
  expect("loose.feb", "",
         "loose.feb: contact \"touch\", surface \"top\": its layer is held by no rigid body (no shared nodes, rigid "
         "node set, "
         "tied contact or nodes fixed in x, y and z); name the body with --attach \"top=BODY\" (bodies: \"base\", "
         "\"plate\")");
  expect("pressed.feb", "",
         "pressed.feb: surface_load \"pressure\" is not supported and would change the result: take it out, or use "
         "what DEA "
         "supports (docs/formats.md)");
}

/// Records of valgrind, leaks or accesses, that go through our library or what it loads. FEBio never deletes a task.
std::vector<std::string> memory_faults(const std::string& valgrind_log) {
  std::vector<std::string> faults;
  std::string record;
  for (const std::string& line : lines_of(valgrind_log)) {
    const std::size_t text = line.find("== ");
    if (text != line.npos && line.size() > text + 3) {
      record += line.substr(text + 3) + "\n";
      continue;
    }
    const auto through = [&](const char* what) { return record.find(what) != record.npos; };
    const bool stack = through("   at ") && (through("libfebio_dea") || through("libembree") || through("libtbb"));
    if (stack && !through("FERegisterClass_T<DeaTask>::Create")) faults.push_back(record);
    record.clear();
  }
  return faults;
}

TEST(Plugin, NoMemoryFaults) {
  const std::string valgrind = DEA_VALGRIND;
  if (valgrind.find("NOTFOUND") != valgrind.npos) GTEST_SKIP() << "no valgrind";
  const TemporaryFolder folder;
  write(folder.path / "linear.feb", model_40(false));
  write(folder.path / "quadratic.feb", model_30(true));
  write(folder.path / "rich.feb", rich_model());
  write(folder.path / "good.xml",
        "<febiodea_settings version=\"1\"><json>j.json</json><csv>c.csv</csv></febiodea_settings>");
  write(folder.path / "bad.xml", "<febiodea_settings version=\"1\"><law>cubic</law></febiodea_settings>");
  const std::pair<const char*, const char*> runs[] = {
      {"linear.feb", "good.xml"}, {"quadratic.feb", "good.xml"}, {"rich.feb", "good.xml"}, {"linear.feb", "bad.xml"}};
  for (const auto& r : runs) {
    run_program(
        folder.path,
        {valgrind, "--leak-check=full", "--show-leak-kinds=definite", "--num-callers=40", "--log-file=memory.log",
         DEA_FEBIO4, "-nosplash", "-i", r.first, "-import", DEA_PLUGIN, "-task=dea", r.second},
        300);
    const std::string log = file_text(folder.path / "memory.log");
    EXPECT_NE(log.find("ERROR SUMMARY"), log.npos) << log;
    EXPECT_EQ(memory_faults(log), std::vector<std::string>{}) << r.first << " " << r.second;
  }
}

TEST(Plugin, NoSolutionIsWrittenAndSaid) {
  const TemporaryFolder folder;
  Parts pulled;
  pulled.motion =
      "<rigid_load name=\"pull\" type=\"rigid_force\"><rb>plate</rb><dof>Rz</dof><value "
      "lc=\"1\">5</value></rigid_load>";
  write(folder.path / "m.feb", model_40(false, pulled));
  const Finished f = febio(folder.path, "m.feb", "dea");
  EXPECT_EQ(f.code, 1);
  EXPECT_EQ(errors_of(f.out), std::vector<std::string>{"dea: no solution in 4 of 5 states, first at time 0.25 "
                                                       "(SurfacesApart); results are in m_dea.xplt"});
  EXPECT_TRUE(fs::exists(folder.path / "m_dea.xplt"));
  EXPECT_FALSE(fs::exists(folder.path / "m.xplt"));
}

TEST(Plugin, PlotFileLogAndTable) {
  const TemporaryFolder folder;
  write(folder.path / "m.feb", model_40(false));
  const Finished f = febio(folder.path, "m.feb", "dea", "", {"-p", "given.xplt", "-o", "given.log"});
  EXPECT_EQ(f.code, 0) << f.out;
  EXPECT_TRUE(fs::exists(folder.path / "given.xplt"));
  const std::string log = file_text(folder.path / "given.log");
  for (const char* text : {"state 5 of 5, time 1: Prescribed, 0 iterations\n", "given.xplt: 5 states in ", "123.5%",
                           "touch    Prescribed"}) {
    EXPECT_NE(log.find(text), log.npos) << text << log;
    EXPECT_NE(f.out.find(text), f.out.npos) << text;
  }
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder.path)) names.insert(entry.path().filename().string());
  EXPECT_EQ(names, (std::set<std::string>{"m.feb", "given.xplt", "given.log"}));
  EXPECT_EQ(febio(folder.path, "m.feb", "dea", "", {"-no_log"}).code, 0);
  EXPECT_FALSE(fs::exists(folder.path / "m.log"));
}

// -- the model ---------------------------------------------------------------------------------------

/// Lines that only one of the two has; sets that FEBio makes for itself are of no interest.
std::string difference_of(const std::string& from_file, const std::string& from_model) {
  std::multiset<std::string> file, model;
  for (const std::string& line : lines_of(from_file)) file.insert(line);
  std::string text;
  for (const std::string& line : lines_of(from_model)) {
    const auto place = file.find(line);
    if (place != file.end())
      file.erase(place);
    else if (line.rfind("node_set", 0) != 0 && line.rfind("element_set", 0) != 0)
      text += "  FEBio: " + line.substr(0, 200) + "\n";
  }
  for (const std::string& line : file) text += "  file:  " + line.substr(0, 200) + "\n";
  return text;
}

/// The model as FEBio's reader leaves it; "cannot read: ..." if FEBio refuses the file.
std::string febio_dump(const fs::path& folder, const std::string& model, const std::string& task) {
  fs::remove(folder / "dump.txt");
  const Finished f = febio(folder, model, task, "dump.txt", {}, DEA_DUMP_PLUGIN);
  std::string text = fs::exists(folder / "dump.txt") ? file_text(folder / "dump.txt") : "cannot read: " + f.out + f.err;
  const std::string own = "unsupported constraint \"\"\n";  // what the test puts into the model
  if (const std::size_t at = text.find(own); at != text.npos) text.erase(at, own.size());
  return text;
}

TEST(ReadFeModel, TheSameAsTheFileBeforeAndInInit) {
  const TemporaryFolder folder;
  for (const fs::path& model : models_in(DEA_SAMPLES_DIR)) fs::copy(model, folder.path / model.filename());
  write(folder.path / "rich.feb", rich_model());
  for (const bool quadratic : {false, true}) {
    const std::string end = quadratic ? "q.feb" : "l.feb";
    write(folder.path / ("m25" + end), model_25(quadratic));
    write(folder.path / ("m30" + end), model_30(quadratic));
    write(folder.path / ("m40" + end), model_40(quadratic));
  }
  for (const fs::path& model : models_in(folder.path)) {
    for (const char* task : {"dea_dump", "dea_dump_in_init"}) {
      const std::string from_model = febio_dump(folder.path, model.filename().string(), task);
      EXPECT_EQ(difference_of(dump(read_feb(model.string())), from_model), "") << model.filename() << " " << task;
    }
  }
}

TEST(ReadFeModel, CorpusTheSameAsTheFiles) {
  const TemporaryFolder folder;
  int compared = 0, refused = 0;
  for (const fs::path& model : models_in(DEA_CORPUS_DIR)) {
    std::string from_file;
    try {
      from_file = dump(read_feb(model.string()));
    } catch (const InputError&) {
      ++refused;
      continue;
    }
    const std::string from_model = febio_dump(folder.path, model.string(), "dea_dump");
    if (from_model.rfind("cannot read", 0) == 0) {
      ++refused;
      continue;
    }
    ++compared;
    EXPECT_EQ(difference_of(from_file, from_model), "") << model;
  }
  if (compared == 0) GTEST_SKIP() << "no models in " << DEA_CORPUS_DIR;
  std::cout << compared << " models compared, " << refused << " refused by one reader\n";
}

}  // namespace
}  // namespace dea::test

// Everything a user may do wrong, through the program: one line on standard error that says where, what was found and
// what to do; the right exit code; nothing left behind.
//
// Every case is one small model with a few edits: a cube of cartilage, 2 x 2 x 2, bonded to a rigid base, and a rigid
// plate above it that is pushed down.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "tests/program.h"

namespace dea::bad_input_test {

namespace fs = std::filesystem;
using Edits = std::vector<std::pair<std::string, std::string>>;
using Words = std::vector<std::string>;

const std::string kModel = R"FEB(<?xml version="1.0" encoding="ISO-8859-1"?>
<febio_spec version="4.0">
<Module type="solid"/>
<Material>
<material id="1" name="cartilage" type="neo-Hookean"><density>1</density><E>10</E><v>0.3</v></material>
<material id="2" name="base" type="rigid body"><density>1</density><center_of_mass>0,0,-2</center_of_mass></material>
<material id="3" name="plate" type="rigid body"><density>1</density><center_of_mass>0,0,1</center_of_mass></material>
</Material>
<Mesh>
<Nodes name="all">
<node id="1">-1,-1,-2</node>
<node id="2">1,-1,-2</node>
<node id="3">1,1,-2</node>
<node id="4">-1,1,-2</node>
<node id="5">-1,-1,0</node>
<node id="6">1,-1,0</node>
<node id="7">1,1,0</node>
<node id="8">-1,1,0</node>
<node id="9">-2,-2,0.1</node>
<node id="10">2,-2,0.1</node>
<node id="11">2,2,0.1</node>
<node id="12">-2,2,0.1</node>
</Nodes>
<Elements type="hex8" name="layer">
<elem id="1">1,2,3,4,5,6,7,8</elem>
</Elements>
<Elements type="quad4" name="base">
<elem id="2">1,2,3,4</elem>
</Elements>
<Elements type="quad4" name="plate">
<elem id="3">9,10,11,12</elem>
</Elements>
<NodeSet name="corner">
5,6
</NodeSet>
<Surface name="top">
<quad4 id="1">5,6,7,8</quad4>
</Surface>
<Surface name="under">
<quad4 id="1">9,12,11,10</quad4>
</Surface>
<SurfacePair name="pair">
<primary>top</primary>
<secondary>under</secondary>
</SurfacePair>
</Mesh>
<MeshDomains>
<SolidDomain name="layer" mat="cartilage"/>
<ShellDomain name="base" mat="base"/>
<ShellDomain name="plate" mat="plate"/>
</MeshDomains>
<Rigid>
<rigid_bc name="hold base" type="rigid_fixed">
<rb>base</rb>
<Rx_dof>1</Rx_dof><Ry_dof>1</Ry_dof><Rz_dof>1</Rz_dof><Ru_dof>1</Ru_dof><Rv_dof>1</Rv_dof><Rw_dof>1</Rw_dof>
</rigid_bc>
<rigid_bc name="hold plate" type="rigid_fixed">
<rb>plate</rb>
<Rx_dof>1</Rx_dof><Ry_dof>1</Ry_dof><Rz_dof>0</Rz_dof><Ru_dof>1</Ru_dof><Rv_dof>1</Rv_dof><Rw_dof>1</Rw_dof>
</rigid_bc>
<rigid_load name="push" type="rigid_force">
<rb>plate</rb>
<dof>Rz</dof>
<value lc="1">-5</value>
</rigid_load>
</Rigid>
<Contact>
<contact name="touch" type="sliding-elastic" surface_pair="pair"/>
</Contact>
<Step>
<step id="1" name="press">
<Control>
<analysis>STATIC</analysis>
<time_steps>2</time_steps>
<step_size>0.5</step_size>
</Control>
</step>
</Step>
<LoadData>
<load_controller id="1" type="loadcurve">
<interpolate>LINEAR</interpolate>
<points>
<pt>0,0</pt>
<pt>1,1</pt>
</points>
</load_controller>
</LoadData>
</febio_spec>
)FEB";

// Seconds of processor time; nearly all need less than a tenth. Sanitizers cost ten times as much.
#ifdef DEA_SANITIZE_ADDRESS
constexpr double kLimit = 200;
#else
constexpr double kLimit = 20;
#endif

/// kModel with texts replaced, each the first time it occurs.
std::string edited(const Edits& edits, std::string text = kModel) {
  for (const auto& edit : edits) {
    const std::size_t place = text.find(edit.first);
    if (place == std::string::npos) throw std::logic_error("not in the model: " + edit.first);
    text.replace(place, edit.first.size(), edit.second);
  }
  return text;
}

/// Without what lies between two texts, both included.
std::string without(const std::string& from, const std::string& to, const std::string& text = kModel) {
  const std::size_t a = text.find(from), b = text.find(to, a);
  if (a == std::string::npos || b == std::string::npos) throw std::logic_error("not in the model: " + from);
  return text.substr(0, a) + text.substr(b + to.size());
}

/// 1-based line of the first occurrence.
int line_of(const std::string& text, const std::string& what) {
  const std::size_t place = text.find(what);
  if (place == std::string::npos) throw std::logic_error("not in the model: " + what);
  return 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(place), '\n'));
}

struct Case {
  std::string name;
  std::string model;  ///< text of the model
  int code = 3;
  std::string at;  ///< the message starts with "FILE:LINE: ", the line of this text; "": with what comes next
  Words says;      ///< all in the message
  Words options = {};
  std::map<std::string, std::string> files = {};  ///< besides the model
  std::string model_name = "model.feb";
  std::string at_file = {};  ///< the message names this file of `files` instead
};

std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> found;
  for (const auto& entry : fs::directory_iterator(folder))
    found[entry.path().filename().string()] = entry.is_regular_file() ? test::file_text(entry.path()) : "";
  return found;
}

Words lines(const std::string& text) {
  Words all;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) all.push_back(line);
  return all;
}

bool starts_with(const std::string& text, const std::string& start) { return text.rfind(start, 0) == 0; }

/// The error: the only line that is no warning. A slow machine sees what is being done before it.
std::string error_of(const test::Finished& f) {
  Words errors;
  for (const std::string& line : lines(f.err))
    if (!starts_with(line, "warning: ") && !starts_with(line, "note: ") && !starts_with(line, "reading ") &&
        !starts_with(line, "joint and thickness") && !starts_with(line, "springs and layers"))
      errors.push_back(line);
  EXPECT_EQ(errors.size(), 1u) << f.err;
  return errors.empty() ? "" : errors.front();
}

using test::has_nan;

void check(const Case& c) {
  SCOPED_TRACE(c.name);
  const test::TemporaryFolder folder;
  if (!c.model_name.empty() && c.model_name != ".")
    std::ofstream(folder.path / c.model_name, std::ios::binary) << c.model;
  for (const auto& file : c.files) std::ofstream(folder.path / file.first, std::ios::binary) << file.second;
  const auto before = contents(folder.path);
  Words words = {DEA_PROGRAM, "run", c.model_name.empty() ? "model.feb" : c.model_name};
  words.insert(words.end(), c.options.begin(), c.options.end());
  const test::Finished f = test::run_program(folder.path, words, kLimit);
  EXPECT_FALSE(f.timed_out);
  EXPECT_EQ(f.code, c.code) << f.err;
  EXPECT_EQ(contents(folder.path), before) << "files changed or left behind";
  EXPECT_EQ(f.out, "");
  const std::string error = error_of(f);
  EXPECT_GT(error.size(), 20u);
  if (!c.at.empty()) {
    const std::string& file = c.at_file.empty() ? c.model : c.files.at(c.at_file);
    EXPECT_TRUE(
        starts_with(error, fmt::format("{}:{}: ", c.at_file.empty() ? c.model_name : c.at_file, line_of(file, c.at))))
        << error;
  }
  for (const std::string& what : c.says)
    EXPECT_NE(error.find(what), std::string::npos) << error << "\n  lacks: " << what;
  EXPECT_TRUE(std::all_of(error.begin(), error.end(), [](unsigned char ch) { return ch >= 32 && ch < 127; })) << error;
  if (c.code == 3) {  // `dea info` prints what it can, and comes to the same end or finds nothing wrong
    words[1] = "info";
    words.resize(3);
    const test::Finished g = test::run_program(folder.path, words, kLimit);
    EXPECT_FALSE(g.timed_out);
    EXPECT_TRUE(g.code == 3 || (g.code == 0 && !c.options.empty())) << g.code << g.err;
    EXPECT_EQ(contents(folder.path), before);
  }
}

const Edits kFarBase = {{"<elem id=\"2\">1,2,3,4</elem>", "<elem id=\"2\">13,14,15,16</elem>"},
                        {"</Nodes>",
                         "<node id=\"13\">-1,-1,-4</node>\n<node id=\"14\">1,-1,-4</node>\n<node "
                         "id=\"15\">1,1,-4</node>\n<node id=\"16\">-1,1,-4</node>\n</Nodes>"}};

/// The base as solid elements of a deformable material. `fixed`: with its lowest nodes fixed.
std::string deformable_bone(bool fixed) {
  std::string text = edited({{"<elem id=\"2\">1,2,3,4</elem>", "<elem id=\"2\">13,14,15,16,1,2,3,4</elem>"},
                             {"type=\"quad4\" name=\"base\"", "type=\"hex8\" name=\"base\""},
                             {"ShellDomain name=\"base\"", "SolidDomain name=\"base\""},
                             {"type=\"rigid body\"><density>1</density><center_of_mass>0,0,-2</center_of_mass>",
                              "type=\"neo-Hookean\"><density>1</density><E>17000</E><v>0.3</v>"},
                             kFarBase[1]});
  text = without("<rigid_bc name=\"hold base\"", "</rigid_bc>\n", text);
  if (!fixed) return text;
  return edited({{"<Surface name=\"top\">", "<NodeSet name=\"low\">\n13,14,15,16\n</NodeSet>\n<Surface name=\"top\">"},
                 {"<Rigid>",
                  "<Boundary>\n<bc type=\"zero displacement\" "
                  "node_set=\"low\">\n<x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof>\n</bc>\n</Boundary>\n<Rigid>"}},
                text);
}

TEST(BadInput, FilesThatAreNoModel) {
  const std::string xml = "<?xml version=\"1.0\"?>\n";
  for (const Case& c : {
           Case{"empty", "", 3, "", {"model.feb: ", "empty", "save it again"}},
           Case{"white space", "\n\n", 3, "", {"model.feb:1: ", "expected \"<?xml\""}},
           Case{"binary", std::string("\0\1\2\x7f\xff\xfe ELF", 10), 3, "", {"model.feb:1: ", "no FEBio model"}},
           Case{"UTF-16", std::string("\xff\xfe<\0?\0x\0", 8), 3, "", {"model.feb:1: ", "UTF-16", "expected UTF-8"}},
           Case{"cut in the middle", kModel.substr(0, kModel.size() / 2), 3, "", {"model.feb:", "cut off"}},
           Case{"cut at an element", kModel.substr(0, kModel.find("<elem id")), 3, "", {"model.feb:", "cut off"}},
           Case{"tags that do not match", edited({{"</Nodes>", "</Nods>"}}), 3, "", {"model.feb:", "damaged", "XML"}},
           Case{"nothing but brackets", xml + std::string(15000, '<'), 3, "", {"model.feb:", "cut off"}},
           Case{"old version",
                edited({{"version=\"4.0\"", "version=\"1.1\""}}),
                3,
                "<febio_spec",
                {"\"1.1\"", "expected 1.2, 2.0, 2.5, 3.0 or 4.0", "save as 4.0"}},
           Case{"future version",
                edited({{"version=\"4.0\"", "version=\"5.0\""}}),
                3,
                "<febio_spec",
                {"\"5.0\"", "expected 1.2, 2.0, 2.5, 3.0 or 4.0"}},
           Case{"no version",
                edited({{" version=\"4.0\"", ""}}),
                3,
                "<febio_spec",
                {"expected 1.2, 2.0, 2.5, 3.0 or 4.0"}},
           Case{"wrong root",
                edited({{"<febio_spec", "<abaqus"}, {"</febio_spec", "</abaqus"}}),
                3,
                "<abaqus",
                {"\"abaqus\"", "expected <febio_spec>"}},
           Case{"no root", xml, 3, "", {"model.feb:1: ", "expected <febio_spec>"}},
           Case{"project file",
                kModel,
                3,
                "",
                {"model.fsm: ", "FEBio Studio project", "Export FE model"},
                {},
                {},
                "model.fsm"},
           Case{"old project file",
                kModel,
                3,
                "",
                {"model.fs2: ", "FEBio Studio project", "Export FE model"},
                {},
                {},
                "model.fs2"},
           Case{"folder", "", 3, "", {".: ", "folder", "expected a .feb file"}, {}, {}, "."},
           Case{"missing", "", 3, "", {"model.feb: ", "no such file", "check the path"}, {}, {}, ""},
       })
    check(c);
}

TEST(BadInput, MissingSections) {
  for (const Case& c : {
           Case{"Mesh", without("<Mesh>", "</Mesh>"), 3, "<SolidDomain", {"names no Elements section"}},
           Case{"Material",
                without("<Material>", "</Material>"),
                3,
                "<SolidDomain",
                {"\"cartilage\"", "expected the name of a material"}},
           Case{"Contact",
                without("<Contact>", "</Contact>"),
                3,
                "",
                {"model.feb: ", "no sliding contact", "needs one between two bodies"}},
           Case{"a domain twice",
                edited({{"<SolidDomain name=\"layer\" mat=\"cartilage\"/>",
                         "<SolidDomain name=\"layer\" mat=\"cartilage\"/>\n<SolidDomain mat=\"cartilage\" "
                         "name=\"layer\"/>"}}),
                3,
                "<SolidDomain mat",
                {"a second SolidDomain \"layer\", expected one"}},
           Case{"a condition that is switched off",
                edited({{"<rigid_load ", "<rigid_load active=\"0\" "}}),
                3,
                "<rigid_load active",
                {"<rigid_load> with active = \"0\", which FEBio does not know"}},
           Case{"MeshDomains",
                without("<MeshDomains>", "</MeshDomains>"),
                3,
                "<Surface name=\"top\"",
                {"\"layer\" have no material", "give them one"}},
           Case{"all",
                "<?xml version=\"1.0\"?>\n<febio_spec version=\"4.0\">\n</febio_spec>\n",
                3,
                "",
                {"model.feb: ", "no sliding contact"}},
       })
    check(c);
  // A model without Step has one step with FEBio's own defaults, and is solved (FEBio would do so, too).
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "model.feb") << without("<Step>", "</Step>");
  EXPECT_EQ(test::run_program(folder.path, {DEA_PROGRAM, "run", "model.feb", "-q"}, kLimit).code, 0);
}

TEST(BadInput, DanglingNames) {
  for (const Case& c : {
           Case{"part that its file lacks",
                "<?xml version=\"1.0\"?>\n<febio_spec version=\"2.5\">\n<Geometry>\n<Part name=\"femur\" "
                "from=\"parts.feb\"/>\n</Geometry>\n</febio_spec>\n",
                3,
                "<febio_spec",
                {"no Part \"femur\" in its Geometry, which \"model.feb\" takes from this file"},
                {},
                {{"parts.feb",
                  "<?xml version=\"1.0\"?>\n<febio_spec version=\"2.5\">\n<Geometry>\n<Part "
                  "name=\"tibia\"/>\n</Geometry>\n</febio_spec>\n"}},
                "model.feb",
                "parts.feb"},
           Case{"node of an element",
                edited({{"5,6,7,8</elem>", "5,6,7,99</elem>"}}),
                3,
                "<elem id=\"1\">",
                {"element 1", "node 99", "does not exist"}},
           Case{"too few nodes",
                edited({{"5,6,7,8</elem>", "5,6,7</elem>"}}),
                3,
                "<elem id=\"1\">",
                {"has 7 nodes", "expected 8"}},
           Case{"node of a facet",
                edited({{">5,6,7,8</q", ">5,6,7,88</q"}}),
                3,
                "5,6,7,88",
                {"facet 1 of surface \"top\"", "node 88"}},
           Case{"node of a set", edited({{"5,6\n", "5,66\n"}}), 3, "<NodeSet", {"node 66", "does not exist"}},
           Case{"node twice",
                edited({{"<node id=\"2\">", "<node id=\"1\">"}}),
                3,
                "<node id=\"1\">1",
                {"node 1 exists twice", "renumber"}},
           Case{"negative id",
                edited({{"<node id=\"2\">", "<node id=\"-2\">"}}),
                3,
                "id=\"-2\"",
                {"expected a positive whole number"}},
           Case{"id beyond integers",
                edited({{"<node id=\"2\">", "<node id=\"99999999999\">"}}),
                3,
                "99999999999",
                {"expected a positive whole number"}},
           Case{
               "two coordinates", edited({{">1,-1,-2<", ">1,-1<"}}), 3, ">1,-1<", {"node 2", "expected three numbers"}},
           Case{"element type", edited({{"\"hex8\"", "\"hex9\""}}), 3, "hex9", {"\"hex9\" is unknown", "hex8"}},
           Case{"surface of a pair",
                edited({{"<primary>top", "<primary>tip"}}),
                3,
                "<primary>tip",
                {"\"tip\"", "expected the name of a Surface"}},
           Case{"surface pair",
                edited({{"surface_pair=\"pair\"", "surface_pair=\"piar\""}}),
                3,
                "\"piar\"",
                {"\"piar\"", "expected the name of a SurfacePair"}},
           Case{"material of a domain",
                edited({{"mat=\"cartilage\"", "mat=\"cartilag\""}}),
                3,
                "\"cartilag\"",
                {"expected the name of a material"}},
           Case{"domain",
                edited({{"SolidDomain name=\"layer\"", "SolidDomain name=\"lager\""}}),
                3,
                "\"lager\"",
                {"names no Elements section", "expected the name of one in Mesh"}},
           Case{"rigid body",
                edited({{"<rb>plate</rb>", "<rb>plata</rb>"}}),
                3,
                "<rb>plata</rb>",
                {"\"plata\"", "expected the id or name of a rigid body"}},
           Case{"load controller",
                edited({{"lc=\"1\"", "lc=\"7\""}}),
                3,
                "",
                {"model.feb:", "lc = 7", "no load controller 7"}},
           Case{"dof",
                edited({{"<dof>Rz</dof>", "<dof>z</dof>"}}),
                3,
                "<rigid_load",
                {"\"z\"", "expected one of Rx, Ry, Rz"}},
           Case{"empty surface",
                edited({{"<quad4 id=\"1\">5,6,7,8</quad4>\n", ""}}),
                3,
                "<contact ",
                {"\"top\"", "no facets"}},
           Case{"file included",
                edited({{"<Contact>", "<Include from=\"a.feb\"/>\n<Contact>"}}),
                3,
                "<Include",
                {"\"a.feb\"", "no such file"}},
           Case{"circle of includes",
                edited({{"<Contact>", "<Include from=\"a.feb\"/>\n<Contact>"}}),
                3,
                "<Include",
                {"includes itself", "remove one include"},
                {},
                {{"a.feb",
                  "<?xml version=\"1.0\"?>\n<febio_spec version=\"4.0\">\n<Include "
                  "from=\"model.feb\"/>\n</febio_spec>\n"}},
                "model.feb",
                "a.feb"},
           Case{"section from its own file",
                edited({{"<Contact>\n", "<Contact from=\"model.feb\">\n"}}),
                3,
                "<Contact from",
                {"includes itself"}},
       })
    check(c);
}

TEST(BadInput, Numbers) {
  for (const Case& c : {
           Case{"coordinate nan",
                edited({{"1,1,0</node>", "1,nan,0</node>"}}),
                3,
                "1,nan,0",
                {"node 7", "at most 1e30"}},
           Case{"coordinate inf",
                edited({{"1,1,0</node>", "1,inf,0</node>"}}),
                3,
                "1,inf,0",
                {"node 7", "at most 1e30"}},
           Case{"coordinate 1e300",
                edited({{"1,1,0</node>", "1,1e300,0</node>"}}),
                3,
                "1e300",
                {"node 7", "at most 1e30"}},
           Case{"load nan", edited({{">-5<", ">nan<"}}), 3, ">nan<", {"value = \"nan\"", "expected a number"}},
           Case{"E nan",
                edited({{"<E>10", "<E>nan"}}),
                3,
                "<material id=\"1\"",
                {"\"cartilage\"", "E = \"nan\" is not one number", "--E \"top=VALUE\""}},
           Case{"E negative", edited({{"<E>10", "<E>-10"}}), 3, "<E>-10", {"E = -10", "need E > 0"}},
           Case{"E zero", edited({{"<E>10", "<E>0"}}), 3, "<E>0", {"E = 0", "need E > 0"}},
           Case{"E missing", edited({{"<E>10</E>", ""}}), 3, "<material id=\"1\"", {"E is missing", "need E > 0"}},
           Case{"incompressible", edited({{"<v>0.3", "<v>0.5"}}), 3, "<v>0.5", {"v = 0.5", "need -1 < v < 0.5"}},
           Case{"no time steps",
                edited({{"<time_steps>2", "<time_steps>0"}}),
                3,
                "<Control>",
                {"ends at time 0", "need time_steps > 0"}},
           Case{"time steps without end",
                edited({{"<time_steps>2", "<time_steps>2000000000"}}),
                3,
                "<Control>",
                {"2000000000 time steps, need at most 10000", "raise step_size"},
                {"--states", "all"}},
           Case{"step size negative",
                edited({{"<step_size>0.5", "<step_size>-0.5"}}),
                3,
                "<step_size>",
                {"step_size = -0.5", "need step_size > 0"}},
           Case{"step size nan",
                edited({{"<step_size>0.5", "<step_size>nan"}}),
                3,
                "<step_size>",
                {"\"nan\"", "expected a number"}},
           Case{"curve backwards",
                edited({{"<pt>0,0</pt>", "<pt>2,0</pt>"}}),
                3,
                "<value lc",
                {"times that go back", "not supported"}},
       })
    check(c);
}

TEST(BadInput, Meshes) {
  std::string flat = kModel;
  for (const char* top : {">-1,-1,", ">1,-1,", ">1,1,", ">-1,1,"})
    flat = edited({{fmt::format("{}0<", top), fmt::format("{}-2<", top)}}, flat);
  for (const Case& c : {
           Case{"layer without thickness",
                flat,
                3,
                "<Elements type=\"hex8\"",
                {"element 1", "no volume", "check its thickness"}},
           Case{"inside out",
                edited({{"1,2,3,4,5,6,7,8", "5,6,7,8,1,2,3,4"}}),
                3,
                "<Elements type=\"hex8\"",
                {"element 1", "inside out", "node order"}},
           Case{"facet without area",
                edited({{">2,-2,0.1", ">-2,-2,0.1"}, {">2,2,0.1", ">-2,-2,0.1"}, {">-2,2,0.1", ">-2,-2,0.1"}}),
                3,
                "<Surface name=\"under\"",
                {"facet 1 has no area", "repair the mesh"}},
           Case{"facet with a node twice",
                edited({{">9,12,11,10</q", ">9,9,9,9</q"}}),
                3,
                "9,9,9,9",
                {"node twice", "repair the mesh"}},
           Case{"surface off the mesh",
                edited({{">5,6,7,8</q", ">5,6,10,9</q"}}),
                3,
                "<Surface name=\"top\"",
                {"nodes 5,6,10,9", "no face of any element", "define the surface again"}},
           Case{"shell layer",
                edited({{"type=\"hex8\" name=\"layer\"", "type=\"quad4\" name=\"layer\""},
                        {"1,2,3,4,5,6,7,8", "5,6,7,8"},
                        {"SolidDomain name=\"layer\"", "ShellDomain name=\"layer\""}}),
                3,
                "<Surface name=\"top\"",
                {"deformable shells", "solid elements", "--rigid \"cartilage\""}},
       })
    check(c);
}

TEST(BadInput, Joints) {
  const std::string two = edited({{"9,10,11,12</elem>", "9,10,11,12</elem>\n<elem id=\"4\">5,6,10,9</elem>"}});
  for (const Case& c : {
           Case{"one surface twice",
                edited({{"<secondary>under", "<secondary>top"}}),
                3,
                "",
                {"model.feb: ", "joins two different bodies", "both surfaces belong to body \"base\""}},
           Case{"unattached",
                edited(kFarBase),
                3,
                "<Surface name=\"top\"",
                {"held by no rigid body", "--attach \"top=BODY\"", "\"base\", \"plate\""}},
           Case{"attached to what does not touch it",
                edited(kFarBase),
                3,
                "<Surface name=\"top\"",
                {"no bone surface", "--bone \"top=SURFACE\"", "--thickness \"top=VALUE\""},
                {"--attach", "top=base"}},
           Case{"held by two bodies",
                two,
                3,
                "<Surface name=\"top\"",
                {"held by 2 bodies", "\"base\"", "\"plate\"", "--attach \"top=BODY\""}},
           Case{
               "turned about the sphere of two surfaces",
               edited(
                   {{"<node id=\"12\">-2,2,0.1</node>",
                     "<node id=\"12\">-2,2,0.1</node>\n<node id=\"13\">3,-1,-2</node>\n<node id=\"14\">5,-1,-2</node>\n"
                     "<node id=\"15\">5,1,-2</node>\n<node id=\"16\">3,1,-2</node>\n<node id=\"17\">3,-1,0</node>\n"
                     "<node id=\"18\">5,-1,0</node>\n<node id=\"19\">5,1,0</node>\n<node id=\"20\">3,1,0</node>"},
                    {"6,7,8</elem>", "6,7,8</elem>\n<elem id=\"4\">13,14,15,16,17,18,19,20</elem>"},
                    {"1,2,3,4</elem>\n</Elements>", "1,2,3,4</elem>\n<elem id=\"5\">13,14,15,16</elem>\n</Elements>"},
                    {"<SurfacePair",
                     "<Surface name=\"top 2\">\n<quad4 id=\"1\">17,18,19,20</quad4>\n</Surface>\n<SurfacePair "
                     "name=\"pair 2\">\n<primary>top 2</primary>\n<secondary>under</secondary>\n</SurfacePair>\n"
                     "<SurfacePair"},
                    {"</Contact>",
                     "<contact name=\"touch 2\" type=\"sliding-elastic\" surface_pair=\"pair 2\"/>\n</Contact>"}}),
               2,
               "",
               {"--rotate base: this body has 2 articular surfaces, each with a sphere of its own;",
                "--rotate-about \"base=x,y,z\""},
               {"--rotate", "base=0,0,1,5"}},
           Case{"no rigid body at all",
                edited({{"type=\"rigid body\"><density>1</density><center_of_mass>0,0,-2</center_of_mass>",
                         "type=\"neo-Hookean\"><E>1</E><v>0</v>"},
                        {"type=\"rigid body\"><density>1</density><center_of_mass>0,0,1</center_of_mass>",
                         "type=\"neo-Hookean\"><E>1</E><v>0</v>"},
                        {kModel.substr(kModel.find("<Rigid>"), kModel.find("</Rigid>") + 8 - kModel.find("<Rigid>")),
                         ""}}),
                3,
                "",
                {"model.feb: no rigid body in the model", "material of type \"rigid body\"", "--rigid \"MATERIAL\"",
                 "\"cartilage\", \"base\", \"plate\""}},
           Case{"deformable bone",
                deformable_bone(false),
                3,
                "<Surface name=\"top\"",
                {"held by no rigid body", "--rigid \"base\""}},
           Case{"deformable bone, fixed",
                deformable_bone(true),
                3,
                "<Surface name=\"top\"",
                {"E = 17000 against 10", "deformable bone", "--rigid \"base\""}},
       })
    check(c);
}

// What the message for deformable bones advises works: the bone's own fixed nodes hold it. 5 N on 2 x 2: 1.25 MPa.
TEST(BadInput, DeformableBoneRunsWhenTakenAsRigid) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "model.feb") << deformable_bone(true);
  const test::Finished f = test::run_program(
      folder.path, {DEA_PROGRAM, "run", "model.feb", "--rigid", "base", "--law", "linear", "--json", "r.json"}, kLimit);
  ASSERT_EQ(f.code, 0) << f.err;
  const auto last = nlohmann::json::parse(test::file_text(folder.path / "r.json"))["states"].back();
  EXPECT_EQ(last["outcome"], "Balanced");
  EXPECT_NEAR(last["contacts"][0]["peak_pressure"].get<double>(), 1.25,
              1e-9);  // plane surfaces: exact but for the solver's 1e-9
}

TEST(BadInput, Unsupported) {
  const auto with = [](const std::string& before, const std::string& added) {
    return edited({{before, added + "\n" + before}});
  };
  for (
      const Case& c : {
          Case{"moved nodes",
               with("<Rigid>",
                    "<Boundary>\n<bc type=\"prescribed displacement\" node_set=\"corner\">\n<dof>z</dof>\n<value "
                    "lc=\"1\">0.1</value>\n</bc>\n</Boundary>"),
               3,
               "<bc type",
               {"prescribed displacement \"corner\": node 5 is moved in z and free in x and y", "DEA moves bones"}},
          Case{"offset of a contact",
               edited({{"surface_pair=\"pair\"/>", "surface_pair=\"pair\">\n<offset>0.1</offset></contact>"}}),
               3,
               "<offset>",
               {"offset = 0.1 of contact \"touch\"", "take it out, and mesh or place the bodies"}},
          Case{"rigid cable",
               with("</Rigid>", "<rigid_load name=\"cable\" type=\"rigid_cable\">\n<force>1</force>\n</rigid_load>"),
               3,
               "\"rigid_cable\"",
               {"rigid_cable without <rigid_cable_point>"}},
          Case{"rigid lock",
               with("</Rigid>",
                    "<rigid_connector name=\"lock\" type=\"rigid "
                    "lock\">\n<body_a>base</body_a>\n<body_b>plate</body_b>\n</rigid_connector>"),
               3,
               "\"rigid lock\"",
               {"rigid lock without <first_axis>", "add it, a direction"}},
          Case{"rigid revolute joint with a torsion spring",
               with("</Rigid>",
                    "<rigid_connector name=\"hinge\" type=\"rigid revolute "
                    "joint\">\n<body_a>base</body_a>\n<body_b>plate</body_b>\n<torsion_stiffness>2</torsion_stiffness>"
                    "\n</rigid_connector>"),
               3,
               "<torsion_stiffness",
               {"rigid revolute joint with torsion_stiffness", "not supported"}},
          Case{
              "spring of no length",
              with("</Rigid>",
                   "<rigid_connector name=\"ACL\" type=\"rigid spring\">\n<body_a>base</body_a>\n<body_b>plate</body_b>"
                   "\n<k>1</k>\n<insertion_a>0,0,1</insertion_a>\n<insertion_b>0,0,1</insertion_b>\n<free_length>0"
                   "</free_length>\n</rigid_connector>"),
              3,
              "\"rigid spring\"",
              {"spring \"ACL\" has no length: its two points coincide, move one"}},
          Case{
              "cable through one point twice",
              with(
                  "</Rigid>",
                  "<rigid_load name=\"cable\" type=\"rigid_cable\">\n<force>1</force>\n<relative>0</relative>"
                  "<rigid_cable_point><rigid_body_id>base</rigid_body_id><position>0,0,1</position></rigid_cable_point>"
                  "<rigid_cable_point><rigid_body_id>plate</rigid_body_id><position>0,0,1</position>"
                  "</rigid_cable_point></rigid_load>"),
              3,
              "\"rigid_cable\"",
              {"cable \"cable\": points 1 and 2 coincide, so the cable has no direction there; take one out"}},
          Case{
              "spring fastened to nothing",
              edited({{"</Nodes>", "<node id=\"13\">0,0,5</node>\n</Nodes>"},
                      {"<SurfacePair", "<DiscreteSet name=\"ACL\">\n<delem>9,13</delem>\n</DiscreteSet>\n<SurfacePair"},
                      {"<Rigid>",
                       "<Discrete>\n<discrete_material id=\"1\" name=\"spring\" type=\"linear "
                       "spring\"><E>1</E></discrete_material>\n<discrete dmat=\"1\" "
                       "discrete_set=\"ACL\"/>\n</Discrete>\n<Rigid>"}}),
              3,
              "<discrete dmat",
              {"spring \"ACL\" is fastened to node 13, which belongs to no rigid body: fasten it to a node of a bone"}},
          Case{"joint pulled apart",
               with("</Rigid>",
                    "<rigid_connector name=\"hinge\" type=\"rigid revolute joint\">\n<body_a>base</body_a>\n"
                    "<body_b>plate</body_b>\n<joint_origin>0,0,0</joint_origin>\n<rotation_axis>0,0,1</rotation_axis>\n"
                    "<transverse_axis>1,0,0</transverse_axis>\n</rigid_connector>"),
               3,
               "\"rigid revolute joint\"",
               {"joint \"hinge\" holds together its two bodies, and as these are placed they are 0.1 apart along its "
                "axis 1;",
                "place both bodies alike"},
               {"--move", "plate=0,0,0.1"}},
          Case{"one rotation moved, another free",
               edited({{"<Ru_dof>1</Ru_dof><Rv_dof>1</Rv_dof><Rw_dof>1</Rw_dof>\n</rigid_bc>\n<rigid_load",
                        "<Ru_dof>1</Ru_dof><Rv_dof>0</Rv_dof><Rw_dof>0</Rw_dof>\n</rigid_bc>\n<rigid_bc name=\"turn\" "
                        "type=\"rigid_rotation\">\n<rb>plate</rb>\n<dof>Rv</dof>\n<value "
                        "lc=\"1\">0.1</value>\n<relative>0</relative>\n</rigid_bc>\n<rigid_load"}}),
               3,
               "",
               {"model.feb: body \"plate\": some rotations are prescribed and others free;",
                "need all three prescribed or fixed"}},
          Case{"pressure load",
               with("<Contact>",
                    "<Loads>\n<surface_load type=\"pressure\" surface=\"top\">\n<pressure "
                    "lc=\"1\">1</pressure>\n</surface_load>\n</Loads>"),
               3,
               "<surface_load",
               {"pressure", "not supported"}},
      })
    check(c);
}

// A parameter that is not found has its default: one that may be meant for it is refused.
TEST(BadInput, MisspeltParameters) {
  const auto constants = [](const std::string& what) { return edited({{"<E>10</E><v>0.3</v>", what}}); };
  const auto material = [](const std::string& what) {
    return edited({{"type=\"neo-Hookean\"><density>1</density><E>10</E><v>0.3</v>", what}});
  };
  const auto connector = [](const std::string& what) {
    return edited({{"</Rigid>", "<rigid_connector name=\"join\" " + what + "\n</rigid_connector>\n</Rigid>"}});
  };
  const std::string spring =
      "<Discrete>\n<discrete_material id=\"1\" name=\"d\" type=\"linear spring\"><e>3</e></discrete_material>\n"
      "<discrete dmat=\"1\" discrete_set=\"d\"/>\n</Discrete>";
  for (const Case& c : {
           Case{"nu",
                constants("<E>10</E>\n<nu>0.45</nu>"),
                3,
                "<nu>",
                {"<nu> in material \"cartilage\" is none of FEBio's words: did you mean <v>?"}},
           Case{"poisson", constants("<E>10</E>\n<poisson>0.45</poisson>"), 3, "<poisson>", {"did you mean <v>?"}},
           Case{"V", constants("<E>10</E>\n<V>0.45</V>"), 3, "<V>", {"did you mean <v>?"}},
           Case{"e", constants("<e>10</e><v>0.45</v>"), 3, "<e>", {"did you mean <E>?"}},
           Case{"nu of a biphasic's solid",
                material("type=\"biphasic\"><solid type=\"neo-Hookean\"><E>10</E>\n<nu>0.45</nu></solid>"),
                3,
                "<nu>",
                {"<nu> in solid \"neo-Hookean\" of material \"cartilage\"", "did you mean <v>?"}},
           Case{"solid of a mixture",
                material("type=\"solid mixture\"><solid type=\"neo-Hookean\"><E>10</E><v>0.3</v></solid>\n"
                         "<sold type=\"neo-Hookean\"><E>10</E><v>0.3</v></sold>"),
                3,
                "<sold",
                {"did you mean <solid>?"}},
           Case{"C1 of Mooney-Rivlin",
                material("type=\"Mooney-Rivlin\">\n<C1>1</C1><c2>1</c2><k>100</k>"),
                3,
                "<C1>",
                {"<C1> in material \"cartilage\"", "did you mean <c1>?"}},
           Case{"centre of mass",
                edited({{"<center_of_mass>0,0,1</center_of_mass>", "<center_of_mas>0,0,1</center_of_mas>"}}),
                3,
                "<center_of_mas>",
                {"<center_of_mas> in material \"plate\"", "did you mean <center_of_mass>?"}},
           Case{"fixed dof",
                edited({{"<rb>plate</rb>\n<Rx_dof>1</Rx_dof>", "<rb>plate</rb>\n<Rxdof>1</Rxdof>"}}),
                3,
                "<Rxdof>",
                {"<Rxdof> in rigid_bc \"hold plate\"", "did you mean <Rx_dof>?"}},
           Case{"kind of load",
                edited({{"<value lc=\"1\">-5</value>", "<value lc=\"1\">-5</value>\n<load_typ>FOLLOW</load_typ>"}}),
                3,
                "<load_typ>",
                {"<load_typ> in rigid_load \"push\"", "did you mean <load_type>?"}},
           Case{"load controller of a value",
                edited({{"<value lc=\"1\">", "<value LC=\"1\">"}}),
                3,
                "<value LC",
                {"<value> with LC = \"1\": did you mean lc?"}},
           Case{"fixed nodes",
                edited({{"<Rigid>",
                         "<Boundary>\n<bc name=\"hold\" type=\"zero displacement\" node_set=\"corner\">"
                         "<x_dof>1</x_dof>\n<ydof>1</ydof>\n</bc>\n</Boundary>\n<Rigid>"}}),
                3,
                "<ydof>",
                {"<ydof> in bc \"hold\"", "did you mean <y_dof>?"}},
           Case{"stiffness of a connector",
                connector("type=\"rigid spring\"><body_a>base</body_a><body_b>plate</body_b>\n<K>3</K>"),
                3,
                "<K>",
                {"<K> in rigid_connector \"join\"", "did you mean <k>?"}},
           Case{
               "prescribed motion of a joint",
               connector("type=\"rigid cylindrical joint\"><body_a>base</body_a><body_b>plate</body_b><joint_axis>0,0,1"
                         "</joint_axis><transverse_axis>1,0,0</transverse_axis>\n<prescribed_translaton>1"
                         "</prescribed_translaton>"),
               3,
               "<prescribed_translaton>",
               {"did you mean <prescribed_translation>?"}},
           Case{"spring between nodes",
                edited({{"</Surface>\n<SurfacePair",
                         "</Surface>\n<DiscreteSet name=\"d\">\n<delem>1,9</delem>\n</DiscreteSet>\n<SurfacePair"},
                        {"</Contact>", "</Contact>\n" + spring}}),
                3,
                "<discrete_material",
                {"<e> in discrete_material \"d\"", "did you mean <E>?"}},
           Case{"tied contact",
                edited({{"</Contact>",
                         "<contact name=\"tie\" type=\"tied-node-on-facet\" surface_pair=\"pair\">\n<max_distanc>1"
                         "</max_distanc>\n</contact>\n</Contact>"}}),
                3,
                "<max_distanc>",
                {"<max_distanc> in contact \"tie\"", "did you mean <max_distance>?"}},
           Case{"load controller",
                edited({{"<interpolate>LINEAR</interpolate>", "<interpolat>STEP</interpolat>"}}),
                3,
                "<interpolat>",
                {"<interpolat> in load_controller \"loadcurve\"", "did you mean <interpolate>?"}},
       })
    check(c);
}

// FEBio takes the last of two, and dea took the first.
TEST(BadInput, ParametersGivenTwice) {
  const std::string E = edited({{"<E>10</E>", "<E>10</E>\n<E>1</E>"}});
  for (const Case& c : {
           Case{"E",
                E,
                3,
                "<E>1</E>",
                {fmt::format("<E> = \"1\" in material \"cartilage\", which has <E> = \"10\" in line {} already",
                             line_of(E, "<E>10")),
                 "keep one"}},
           Case{"offset of a contact",
                edited({{"surface_pair=\"pair\"/>",
                         "surface_pair=\"pair\">\n<offset>0</offset>\n<offset>0.1</offset></contact>"}}),
                3,
                "<offset>0.1",
                {"<offset> = \"0.1\" in contact \"touch\"", "keep one"}},
           Case{"a parameter of a contact that is told alone",
                edited({{"surface_pair=\"pair\"/>",
                         "surface_pair=\"pair\">\n<tension>0</tension>\n<tension>1</tension></contact>"}}),
                3,
                "<tension>1",
                {"<tension> = \"1\" in contact \"touch\"", "keep one"}},
           Case{"force",
                edited({{"<value lc=\"1\">-5</value>", "<value lc=\"1\">-5</value>\n<value>-5</value>"}}),
                3,
                "<value>-5",
                {"<value> = \"-5\" in rigid_load \"push\"", "with lc = \"1\""}},
           Case{"points",
                edited({{"</points>", "</points>\n<points><pt>0,0</pt></points>"}}),
                3,
                "<points><pt>0,0",
                {"<points> in load_controller \"loadcurve\", which has <points> in line"}},
       })
    check(c);
  const test::TemporaryFolder folder;  // the same value twice says nothing else
  std::ofstream(folder.path / "model.feb") << edited({{"<E>10</E>", "<E>10</E><E> 1e1 </E>"}});
  EXPECT_EQ(test::run_program(folder.path, {DEA_PROGRAM, "info", "model.feb"}, kLimit).code, 0);
}

// What dea passes over or repairs is told, by dea run and dea info.
TEST(BadInput, WhatIsPassedOverOrRepairedIsTold) {
  const std::pair<Edits, const char*> cases[] = {
      {{{"<v>0.3</v>", "<v>0.3</v>\n<stickiness>3</stickiness>"}},
       "ignored: model.feb:6: <stickiness> in material \"neo-Hookean\", none of FEBio's words"},
      {{{"surface_pair=\"pair\"/>",
         "surface_pair=\"pair\">\n<fric_coef>0.3</fric_coef><penalty>1</penalty></contact>"}},
       "<fric_coef> in contact \"sliding-elastic\", none of FEBio's words (did you mean \"fric_coeff\"?)"},
      {{{"<v>0.3</v>", ""}}, "note: model.feb:5: material \"cartilage\": \"neo-Hookean\" without <v>: 0, as in FEBio"},
      {{{"<quad4 id=\"1\">5,6,7,8</quad4>", "<quad4 id=\"1\">8,7,6,5</quad4>"}},
       "note: surface \"top\": 1 of its 1 facets have their nodes in the reverse order, facing into their elements: "
       "turned outwards"},
      {{{"</Nodes>",
         "<node id=\"13\">0,-1,-2</node><node id=\"14\">0,1,-2</node><node id=\"15\">0,-1,0</node>"
         "<node id=\"16\">0,1,0</node></Nodes>"},
        {"1,2,3,4,5,6,7,8</elem>", "1,13,14,4,5,15,16,8</elem><elem id=\"4\">13,2,3,14,15,6,7,16</elem>"},
        {"1,2,3,4</elem>", "1,13,14,4</elem><elem id=\"5\">13,2,3,14</elem>"},
        {"5,6,7,8</quad4>", "5,15,16,8</quad4><quad4 id=\"2\">16,7,6,15</quad4>"}},
       "note: surface \"top\": 1 of its 2 facets have their nodes in the reverse order"},
  };
  for (const auto& c : cases) {
    const test::TemporaryFolder folder;
    std::ofstream(folder.path / "model.feb") << edited(c.first);
    const test::Finished info = test::run_program(folder.path, {DEA_PROGRAM, "info", "model.feb"}, kLimit);
    EXPECT_EQ(info.code, 0) << info.err;
    EXPECT_NE(info.out.find(c.second), std::string::npos) << info.out;
    EXPECT_EQ(info.out.find("<penalty>"), std::string::npos) << info.out;
    const test::Finished run = test::run_program(folder.path, {DEA_PROGRAM, "run", "model.feb"}, kLimit);
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_NE(run.err.find(c.second), std::string::npos) << run.err;
  }
}

// What a file leaves unsaid, or says twice: FEBio's default, and what FEBio lets count, are told.
TEST(BadInput, WhatFebioTakesInsteadIsTold) {
  const auto with_rigid = [](const std::string& more) { return Edits{{"</Rigid>", more + "</Rigid>"}}; };
  const auto connector = [&](const std::string& type, const std::string& more) {
    return with_rigid("\n<rigid_connector name=\"c\" type=\"" + type +
                      "\"><body_a>base</body_a><body_b>plate</body_b>" + more + "</rigid_connector>\n");
  };
  const auto moved = [](const std::string& name, const std::string& more) {
    return "<rigid_bc name=\"" + name + "\" type=\"rigid_displacement\"><rb>plate</rb>" + more + "</rigid_bc>";
  };
  const std::string spring = "<insertion_a>0,0,0</insertion_a><insertion_b>0,0,1</insertion_b>";
  const Edits held = {{"<Rz_dof>0", "<Rz_dof>1"}};
  Edits held_and_moved = with_rigid(moved("sink", "<dof>z</dof><value lc=\"1\">-0.2</value>"));
  held_and_moved.insert(held_and_moved.end(), held.begin(), held.end());
  Edits step_moves = with_rigid(moved("sink", "<dof>z</dof><value lc=\"1\">-0.1</value>"));
  step_moves.push_back(
      {"</Control>\n</step>", "</Control>\n<Rigid>" + moved("again", "<dof>z</dof><value lc=\"1\">-0.2</value>") +
                                  "</Rigid></step>\n<step id=\"2\" name=\"more\"><Control><analysis>STATIC</analysis>"
                                  "<time_steps>2</time_steps><step_size>0.5</step_size></Control></step>"});
  const auto in_first_step = [](const std::string& conditions) {
    return Edits{
        {"</Control>\n</step>", "</Control>\n" + conditions +
                                    "</step>\n<step id=\"2\" name=\"more\"><Control><analysis>STATIC</analysis>"
                                    "<time_steps>2</time_steps><step_size>0.5</step_size></Control></step>"}};
  };
  const std::string side = "<NodeSet name=\"side\">1,2</NodeSet>\n</Mesh>";
  const auto nodes_held = [](const std::string& inside) {
    return "<Boundary><bc name=\"n\" type=\"zero displacement\" node_set=\"side\">" + inside + "</bc></Boundary>\n";
  };
  Edits fixed_nodes_twice = in_first_step(nodes_held("<y_dof>1</y_dof>"));
  fixed_nodes_twice.push_back({"</Mesh>", side});
  fixed_nodes_twice.push_back({"<Contact>", nodes_held("<x_dof>1</x_dof><y_dof>1</y_dof>") + "<Contact>"});
  const std::pair<Edits, const char*> cases[] = {
      {in_first_step(
           "<Rigid><rigid_bc name=\"r\" type=\"rigid_fixed\"><rb>plate</rb><Rx_dof>1</Rx_dof></rigid_bc></Rigid>"),
       "x of \"plate\" is fixed in all steps (line 57) and in step 1: that ends with the step, and dea then goes on as "
       "before, where FEBio leaves it free"},
      {fixed_nodes_twice,
       "y of nodes is fixed in all steps (line 68) and in step 1: that ends with the step, and dea then goes on as "
       "before, where FEBio leaves it free"},
      {connector("rigid spring", spring + "<free_length>1</free_length>"),
       "note: model.feb:67: rigid spring without <k>: 1, as in FEBio"},
      {connector("rigid spring", spring + "<k>1</k>"),
       "rigid spring without <free_length>: its length at the start, as in FEBio"},
      {connector("rigid spring", "<insertion_a>0,0,0</insertion_a><k>1</k><free_length>1</free_length>"),
       "rigid spring without <insertion_b>: 0,0,0, as in FEBio"},
      {connector("rigid revolute joint", ""), "rigid revolute joint without <joint_origin>: 0,0,0, as in FEBio"},
      {connector("rigid revolute joint", ""), "rigid revolute joint without <rotation_axis>: 0,0,1, as in FEBio"},
      {{{"<pt>0,0</pt>\n<pt>1,1</pt>\n", ""}}, "load controller 1 without <points>: 0 at all times, as in FEBio"},
      {with_rigid(moved("sink", "<dof>z</dof>")), "rigid_displacement without <value>: 0, as in FEBio"},
      {held_and_moved,
       "note: model.feb:66: z of \"plate\" is fixed (line 57) and prescribed: it is prescribed, as in FEBio"},
      {step_moves,
       "z of \"plate\" is prescribed in all steps (line 66) and prescribed in step 1: that ends with the step, "
       "and dea then goes on as before, where FEBio leaves it free"},
      {{{"</Material>",
         "<material id=\"4\" name=\"lid\" type=\"rigid body\"><center_of_mass>0,0,2</center_of_mass></material>\n"
         "</Material>"},
        {"</Elements>\n<NodeSet",
         "</Elements>\n<Elements type=\"quad4\" name=\"lid\"><elem id=\"9\">9,10,11,12</elem></Elements>\n<NodeSet"},
        {"</MeshDomains>", "<ShellDomain name=\"lid\" mat=\"lid\"/>\n</MeshDomains>"}},
       "note: material \"lid\": its centre of mass 0,0,2 is left out, as in FEBio: it shares nodes with \"plate\", is "
       "one "
       "body with it, and the centre of mass of that counts (0,0,1)"},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.second);
    const test::TemporaryFolder folder;
    std::ofstream(folder.path / "model.feb") << edited(c.first);
    const test::Finished info = test::run_program(folder.path, {DEA_PROGRAM, "info", "model.feb"}, kLimit);
    EXPECT_NE(info.out.find(c.second), std::string::npos) << info.out << info.err;
    std::ofstream(folder.path / "model.feb") << kModel;
    EXPECT_EQ(test::run_program(folder.path, {DEA_PROGRAM, "info", "model.feb"}, kLimit).out.find("as in FEBio"),
              std::string::npos);
  }
}

// FEBio's <override_com>: what is written behind the centre of mass counts.
TEST(BadInput, OverrideComIsFollowed) {
  const auto info = [](const std::string& com) {
    const test::TemporaryFolder folder;
    std::ofstream(folder.path / "model.feb") << edited({{"<center_of_mass>0,0,1</center_of_mass>", com}});
    const test::Finished f = test::run_program(folder.path, {DEA_PROGRAM, "info", "model.feb"}, kLimit);
    EXPECT_EQ(f.code, 0) << f.err;
    const std::size_t plate = f.out.find("plate: material");
    return f.out.substr(plate, f.out.find('\n', plate) - plate) + f.out.substr(f.out.find("remarks"));
  };
  const std::string com = "<center_of_mass>0,0,1</center_of_mass>";
  const std::string left_out = "<center_of_mass> of rigid body \"plate\", for <override_com> is 0";
  EXPECT_NE(info(com).find("(0, 0, 1) (given)"), std::string::npos);
  EXPECT_NE(info("<override_com>0</override_com>" + com).find("(0, 0, 1) (given)"), std::string::npos);
  EXPECT_NE(info(com + "<override_com>1</override_com>").find("(0, 0, 1) (given)"), std::string::npos);
  const std::string without = info(com + "<override_com>0</override_com>");
  EXPECT_EQ(without.find("(given)"), std::string::npos) << without;
  EXPECT_NE(without.find(left_out), std::string::npos) << without;
  const std::string origin = info("<override_com>1</override_com>");
  EXPECT_NE(origin.find("(0, 0, 0) (given)"), std::string::npos) << origin;
  EXPECT_NE(origin.find("rigid body \"plate\" without <center_of_mass>: 0,0,0, as in FEBio"), std::string::npos)
      << origin;
}

// Face centres of 27-node elements are held by a bone of 9-node ones as the rest of the face is.
TEST(Solved, LayersOfHex27OnQuad9) {
  std::string nodes, ids;
  int id = 0;
  const auto add = [&](double x, double y, double z) {
    nodes += fmt::format("<node id=\"{}\">{},{},{}</node>\n", ++id, x, y, z - 1);
    ids += fmt::format("{}{}", id > 1 ? "," : "", id);
  };
  for (const double z : {-1.0, 1.0})
    for (const auto& [x, y] : {std::pair(-1.0, -1.0), {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}}) add(x, y, z);
  const std::pair<double, double> sides[] = {{0.0, -1.0}, {1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}};
  for (const double z : {-1.0, 1.0})
    for (const auto& [x, y] : sides) add(x, y, z);
  for (const auto& [x, y] : {std::pair(-1.0, -1.0), {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}}) add(x, y, 0);
  for (const auto& [x, y] : sides) add(x, y, 0);
  for (const double z : {-1.0, 1.0, 0.0}) add(0, 0, z);
  std::string text = without("<node id=\"1\">", "<node id=\"8\">-1,1,0</node>\n");
  text = edited({{"<Nodes name=\"all\">\n", "<Nodes name=\"all\">\n" + nodes}}, text);
  const auto moved = [](int id) { return fmt::format("<node id=\"{}\">", id); };
  text = edited({{moved(9) + "-2,-2,0.1", moved(39) + "-2,-2,0.1"},
                 {moved(10) + "2,-2,0.1", moved(40) + "2,-2,0.1"},
                 {moved(11) + "2,2,0.1", moved(41) + "2,2,0.1"},
                 {moved(12) + "-2,2,0.1", moved(42) + "-2,2,0.1"},
                 {"9,10,11,12</elem>", "39,40,41,42</elem>"},
                 {"9,12,11,10</quad4>", "39,42,41,40</quad4>"},
                 {"<Elements type=\"hex8\" name=\"layer\">", "<Elements type=\"hex27\" name=\"layer\">"},
                 {"1,2,3,4,5,6,7,8</elem>", ids + "</elem>"},
                 {"<Elements type=\"quad4\" name=\"base\">", "<Elements type=\"quad9\" name=\"base\">"},
                 {"1,2,3,4</elem>", "1,2,3,4,9,10,11,12,25</elem>"}},
                text);
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "model.feb") << text;
  std::ofstream(folder.path / "plain.feb") << kModel;
  const auto sunk = [&](const char* model) {
    const test::Finished f = test::run_program(
        folder.path, {DEA_PROGRAM, "run", model, "--no-xplt", "--law", "linear", "--json", "r.json"}, kLimit);
    EXPECT_EQ(f.code, 0) << f.err;
    return nlohmann::json::parse(test::file_text(folder.path / "r.json"))["states"]
        .back()["bodies"]["plate"]["translation"][2]
        .get<double>();
  };
  EXPECT_NEAR(sunk("model.feb"), sunk("plain.feb"), 1e-12);
}

// Commands with lists of files take an option without its dashes for one more.
TEST(BadInput, AnOptionTakenForAFileIsNamed) {
  const test::TemporaryFolder folder;
  const auto error = [&](const Words& words) {
    Words all = {DEA_PROGRAM};
    all.insert(all.end(), words.begin(), words.end());
    const test::Finished f = test::run_program(folder.path, all, kLimit);
    EXPECT_EQ(f.code, 2);
    return f.err;
  };
  EXPECT_EQ(error({"plot", "a.xplt", "smooth"}),
            "dea plot: found \"smooth\", which is no file (did you mean \"--smooth\"?)\n");
  EXPECT_EQ(error({"compare", "a.xplt", "b.xplt", "details"}),
            "dea compare: found \"details\", which is no file (did you mean \"--details\"?)\n");
  EXPECT_EQ(error({"study", "a.feb", "inside"}).rfind("dea study: found \"inside\"", 0), 0u);
  EXPECT_EQ(error({"completion", "help"}).find("which is no file"), std::string::npos);
}

// Settings that nothing uses: refused where no model could use them, told where another one might.
TEST(Solved, SettingsWithoutEffectAreTold) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "model.feb") << edited(
      {{"<SurfacePair", "<Surface name=\"bottom\">\n<quad4 id=\"1\">1,4,3,2</quad4>\n</Surface>\n<SurfacePair"}});
  const auto run = [&](Words options) {
    const Words words = {DEA_PROGRAM, "run", "model.feb", "-q", "--no-xplt"};
    options.insert(options.begin(), words.begin(), words.end());
    return test::run_program(folder.path, options, kLimit);
  };
  EXPECT_EQ(run({"--E", "top=5", "--nu", "top=0.2"}).err, "");
  const test::Finished bare = run({"--E", "under=5"});
  EXPECT_EQ(bare.code, 2);
  EXPECT_EQ(bare.err,
            "dea: --E under=5: surface \"under\" is a bare rigid surface, without cartilage; leave it out, or give a "
            "thickness with --thickness \"under=VALUE\"\n");
  EXPECT_EQ(run({"--nu", "under=0.3"}).code, 2);
  const std::pair<Words, const char*> idle[] = {
      {{"--E", "bottom=5"}, "--E bottom: it has no effect, for no sliding contact has this surface"},
      {{"--thickness", "bottom=5"}, "--thickness bottom: it has no effect, for no sliding contact has this surface"},
      {{"--rotate-about", "plate=com"},
       "--rotate-about plate: it has no effect, for no setting turns body \"plate\"; turn it with --rotate "
       "\"plate=x,y,z,DEGREES\", or leave it out"},
  };
  for (const auto& [options, what] : idle) {
    const test::Finished f = run(options);
    EXPECT_EQ(f.code, 0) << f.err;
    EXPECT_EQ(f.err, std::string("warning: ") + what + " [idle-setting]\n");
  }
  EXPECT_EQ(run({"--rotate-about", "plate=com", "--rotate", "plate=0,0,1,1"}).err, "");
  EXPECT_EQ(run({"--frame", "hip=1,0,0/0,1,0/0,0,1"}).err, "");  // a settings file has all of a bone's
}

// A material that FEBio softens in compression, and one that it does not.
TEST(Solved, AMaterialThatSoftensIsTold) {
  const auto warned = [](const Edits& edits) {
    const test::TemporaryFolder folder;
    std::ofstream(folder.path / "model.feb") << edited(edits);
    const test::Finished f = test::run_program(folder.path, {DEA_PROGRAM, "run", "model.feb", "--no-xplt"}, kLimit);
    EXPECT_EQ(f.code, 0) << f.err;
    return f.err.find("\"isotropic elastic\", which in FEBio gets softer") != std::string::npos;
  };
  const std::pair<std::string, std::string> softens = {"type=\"neo-Hookean\"", "type=\"isotropic elastic\""};
  EXPECT_TRUE(warned({softens}));
  EXPECT_FALSE(warned({}));
  EXPECT_FALSE(warned({softens, {">-5<", ">-0.5<"}}));  // small strains
}

// Where a body starts beside the surface that is to carry it, that is why the surfaces part, not its load.
TEST(NoSolution, SurfacesBesideEachOtherAreNamed) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "model.feb") << edited(
      {{"-2,-2,0.1<", "8,-2,0.1<"}, {"2,-2,0.1<", "12,-2,0.1<"}, {"2,2,0.1<", "12,2,0.1<"}, {"-2,2,0.1<", "8,2,0.1<"}});
  const test::Finished f = test::run_program(folder.path, {DEA_PROGRAM, "run", "model.feb", "--no-xplt"}, kLimit);
  EXPECT_EQ(f.code, 1);
  EXPECT_NE(f.err.find("(no spring finds the opposite surface from where the bodies start: do the surfaces lie beside "
                       "each other, or look the same way?)"),
            std::string::npos)
      << f.err;
}

// Coordinates, motions, loads and times out of all proportion.
TEST(BadInput, OutOfAllProportion) {
  const auto corner = [](const char* x) { return edited({{">1,1,0</node>", std::string(">1,") + x + ",0</node>"}}); };
  const auto shifted = [](double far) {
    std::string text = kModel;
    for (const auto& [x, y] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
      for (const double z : {-2.0, 0.0})
        text = edited(
            {{fmt::format(">{},{},{:g}</node>", x, y, z), fmt::format(">{:.9g},{},{:g}</node>", far + x, y, z)}}, text);
    return text;
  };
  const std::string away =
      "node 7 of element 1 of \"layer\" is 1e+09 away from its other nodes, which are 2 apart; check "
      "its coordinates (1, 1e+09, 0)";
  const Words moved = {"--motion", "t.csv", "--motion-body", "plate"},
              loaded = {"--loads", "t.csv", "--load-body", "plate"};
  for (const Case& c : {
           Case{"a corner", corner("1e9"), 3, "<Elements type=\"hex8\"", {away}},
           Case{"a corner, farther",
                corner("-1e30"),
                3,
                "<Elements type=\"hex8\"",
                {"node 7 of element 1", "1e+30 away"}},
           Case{"a bone's corner",
                edited({{">2,2,0.1<", ">2,2,1e9<"}}),
                3,
                "<Elements type=\"quad4\" name=\"plate\"",
                {"node 11 of element 3 of \"plate\" is 1e+09 away"}},
           Case{"all of a body",
                shifted(1e8),
                3,
                "<Surface name=\"top\"",
                {"surface \"top\" is too far from the origin (node 5 at (1e+08, -1, 0))",
                 "cannot tell nodes 2 apart there", "move the model to the origin"}},
           Case{"a centre of mass",
                edited({{"<center_of_mass>0,0,1<", "<center_of_mass>0,0,1e19<"}}),
                3,
                "<material id=\"3\"",
                {"the centre of mass of \"plate\" is at (0, 0, 1e+19)", "check its coordinates"}},
           Case{"a load", edited({{">-5<", ">-5e20<"}, {"<pt>1,1<", "<pt>1,1e20<"}}), 3, "", {"at most 1e30"}},
           Case{"a motion of a table",
                kModel,
                3,
                "",
                {"t.csv:2: column \"tz\": found \"1e308\"", "at most 1e30"},
                moved,
                {{"t.csv", "time,tx,ty,tz\n0,0,0,1e308\n"}}},
           Case{"a time of a table",
                kModel,
                3,
                "",
                {"t.csv:2: column \"time\": found \"-1e300\"", "at most 1e30"},
                loaded,
                {{"t.csv", "time,fx,fy,fz\n-1e300,0,0,-5\n"}}},
           Case{"a setting",
                kModel,
                2,
                "",
                {"--move plate=0,0,1e308: found \"0,0,1e308\""},
                {"--move", "plate=0,0,1e308"}},
       })
    check(c);
}

// What lies far beyond the other surface is apart from it; nothing that looks for contact may come to grief over it.
TEST(NoSolution, BodiesMovedOutOfReach) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "model.feb") << kModel;
  std::ofstream(folder.path / "t.csv") << "time,tx,ty,tz\n0,9.2e18,0,0\n";
  for (const Words& options :
       {Words{"--motion", "t.csv", "--motion-body", "plate"}, Words{"--move", "plate=0,1e19,0"},
        Words{"--move", "plate=0,0,1e30"}, Words{"--rotate", "plate=0,0,1,30", "--rotate-about", "plate=1e19,0,0"}}) {
    Words words = {DEA_PROGRAM, "run", "model.feb", "-q", "--no-xplt"};
    words.insert(words.end(), options.begin(), options.end());
    const test::Finished f = test::run_program(folder.path, words, kLimit);
    EXPECT_TRUE(f.code == 0 || f.code == 1) << f.code << f.err;  // a motion that is given needs no balance
    EXPECT_FALSE(has_nan(f.err)) << f.err;
  }
}

// Any damage to a model ends in an answer or in a line. The same damage each time.
TEST(BadInput, DamagedModelsAreAnsweredOrRefused) {
  std::mt19937 random(20);
  const auto any = [&](std::size_t count) { return static_cast<std::size_t>(random()) % count; };
  const Words numbers = {"1e9", "-1e30", "1e15", "1e-30", "-1", "0", "1e300", "nan", "", "99999999999", "1e5", "7"};
  for (int i = 0; i < 150; ++i) {
    Words text = lines(kModel);
    std::string& line = text[any(text.size())];
    const std::size_t place = line.find_first_of("0123456789", any(line.size() + 1));
    switch (any(6)) {
      case 0:
        line.clear();
        break;
      case 1:
        line += line;
        break;
      case 2:
        std::swap(line, text[any(text.size())]);
        break;
      default:
        if (place == std::string::npos) continue;
        line.replace(place, line.find_first_not_of("0123456789.", place) - place, numbers[any(numbers.size())]);
    }
    const test::TemporaryFolder folder;
    std::ofstream(folder.path / "model.feb") << fmt::format("{}", fmt::join(text, "\n"));
    const test::Finished f = test::run_program(folder.path, {DEA_PROGRAM, "run", "model.feb", "-q"}, kLimit);
    SCOPED_TRACE(line);
    EXPECT_TRUE(f.code >= 0 && f.code <= 3) << f.code << f.err;
    EXPECT_FALSE(f.timed_out);
    EXPECT_EQ(f.code == 3, !fs::exists(folder.path / "model_dea.xplt")) << f.err;
  }
}

// What stands there, what may have been meant, and what there is.
TEST(BadInput, Misspelt) {
  const auto prescribed = [](const std::string& type) {
    return edited({{"</Rigid>", "<rigid_bc name=\"turn\" type=\"" + type +
                                    "\">\n<rb>plate</rb>\n<dof>Ru</dof>\n<value>0.1</value>\n</rigid_bc>\n</Rigid>"}});
  };
  for (const Case& c : {
           Case{"contact type",
                edited({{"type=\"sliding-elastic\"", "type=\"slidng-elastic\""}}),
                3,
                "<contact name",
                {"no sliding contact in the model",
                 "found contact \"slidng-elastic\" (did you mean \"sliding-elastic\"?)", "and 1 more reason"}},
           Case{"contact type of FEBio",
                edited({{"</Contact>", "<contact type=\"periodic boundary\" surface_pair=\"pair\"/>\n</Contact>"}}),
                3,
                "<contact type=\"periodic",
                {"contact \"periodic boundary\" is not supported", "DEA reads \"sliding-elastic\", ", "choose one"}},
           Case{
               "curve of a seating step",
               edited(
                   {{"LINEAR", "LINAER"},
                    {"</Control>\n</step>",
                     "</Control>\n<Rigid><rigid_bc name=\"seat\" type=\"rigid_displacement\"><rb>plate</rb><dof>z</dof>"
                     "<value lc=\"1\">-0.2</value></rigid_bc></Rigid>\n</step>\n<step id=\"2\" name=\"load\"><Control>"
                     "<analysis>STATIC</analysis><time_steps>2</time_steps><step_size>0.5</step_size></Control></"
                     "step>"}}),
               3,
               "<value lc=\"1\">-0.2",
               {"load controller 1 with interpolation \"LINAER\" (did you mean \"linear\"?) is not supported",
                "give its points"}},
           Case{"rigid condition",
                prescribed("rigid_rotatoin"),
                3,
                "<rigid_bc name=\"turn\"",
                {"\"rigid_rotatoin\" is not supported", "did you mean \"rigid_rotation\"?"}},
           Case{"connector",
                edited({{"</Rigid>", "<rigid_connector type=\"rigid sphrical joint\"/>\n</Rigid>"}}),
                3,
                "<rigid_connector",
                {"did you mean \"rigid spherical joint\"?"}},
           Case{"spring",
                edited({{"</Surface>\n<SurfacePair",
                         "</Surface>\n<DiscreteSet name=\"d\">\n<delem>1,9</delem>\n</DiscreteSet>\n<SurfacePair"},
                        {"</Contact>",
                         "</Contact>\n<Discrete>\n<discrete_material id=\"1\" type=\"liner spring\"/>\n"
                         "<discrete dmat=\"1\" discrete_set=\"d\"/>\n</Discrete>"}}),
                3,
                "<discrete dmat",
                {"discrete material \"liner spring\"", "did you mean \"linear spring\"?"}},
           Case{"spring without its stiffness",
                edited({{"</Surface>\n<SurfacePair",
                         "</Surface>\n<DiscreteSet name=\"d\">\n<delem>1,9</delem>\n</DiscreteSet>\n<SurfacePair"},
                        {"</Contact>",
                         "</Contact>\n<Discrete>\n<discrete_material id=\"1\" type=\"tension-only linear spring\"/>\n"
                         "<discrete dmat=\"1\" discrete_set=\"d\"/>\n</Discrete>"}}),
                3,
                "<discrete_material",
                {"tension-only linear spring without <E>, which has no default: add it"}},
           Case{"axis of another joint",
                edited({{"</Rigid>",
                         "<rigid_connector name=\"slide\" type=\"rigid prismatic joint\"><body_a>base</body_a>"
                         "<body_b>plate</body_b><joint_origin>0,0,0</joint_origin>\n<joint_axis>0,0,1</joint_axis>"
                         "</rigid_connector>\n</Rigid>"}}),
                3,
                "<joint_axis>",
                {"is none of FEBio's words", "did you mean <translation_axis>?"}},
           Case{"type of a load controller",
                edited({{"type=\"loadcurve\"", "type=\"lodcurve\""}}),
                3,
                "<value lc=\"1\">",
                {"load controller 1 with type \"lodcurve\" (did you mean \"loadcurve\"?)"}},
           Case{"module",
                edited({{"type=\"solid\"", "type=\"biphasci\""}}),
                3,
                "<Module",
                {"did you mean \"biphasic\"?"}},
           Case{"section",
                edited({{"<Contact>", "<Contakt>"}, {"</Contact>", "</Contakt>"}}),
                3,
                "<Contakt>",
                {"did you mean <Contact>?"}},
           Case{"surface pair",
                edited({{"surface_pair=\"pair\"", "surface_pair=\"piar\""}}),
                3,
                "<contact name",
                {"surface_pair = \"piar\"", "did you mean \"pair\"?"}},
           Case{
               "node set",
               edited({{"<Rigid>",
                        "<Boundary>\n<bc type=\"rigid\" node_set=\"cornr\"><rb>base</rb></bc>\n</Boundary>\n<Rigid>"}}),
               3,
               "<bc type",
               {"\"cornr\" names no node set", "did you mean \"corner\"?", "\"all\""}},
           Case{"body",
                edited({{"<rb>plate</rb>", "<rb>palte</rb>"}}),
                3,
                "<rb>palte",
                {"did you mean \"plate\"?", "\"base\""}},
           Case{"load controller",
                edited({{"<value lc=\"1\">", "<value lc=\"4\">"}}),
                3,
                "<value lc",
                {"no load controller 4", "ids \"1\""}},
           Case{"surface of a setting",
                kModel,
                2,
                "",
                {"--thickness tpo: the model has no surface of this name (did you mean \"top\"?); it has"},
                {"--thickness", "tpo=2"}},
           Case{"surface to keep", kModel, 2, "", {"(did you mean \"under\"?)"}, {"--keep-facets", "undre"}},
           Case{"bone surface",
                kModel,
                2,
                "",
                {"--bone top=undre: ", "(did you mean \"under\"?)"},
                {"--bone", "top=undre"}},
           Case{"surface that is attached", kModel, 2, "", {"(did you mean \"top\"?)"}, {"--attach", "tpo=base"}},
           Case{"body that a surface is attached to",
                kModel,
                2,
                "",
                {"(did you mean \"base\"?)"},
                {"--attach", "top=bsae"}},
           Case{"body of a force", kModel, 2, "", {"(did you mean \"plate\"?)"}, {"--force", "palte=0,0,-1"}},
           Case{"body that is free", kModel, 2, "", {"(did you mean \"plate\"?)"}, {"--free", "plat=x"}},
           Case{"body that is moved", kModel, 2, "", {"(did you mean \"plate\"?)"}, {"--move", "plat=0,0,1"}},
           Case{"body of the source", kModel, 2, "", {"(did you mean \"plate\"?)"}, {"--source", "Plat"}},
           Case{"contact", kModel, 2, "", {"(did you mean \"touch\"?)"}, {"--contact", "toch"}},
           Case{"material", kModel, 2, "", {"(did you mean \"cartilage\"?)"}, {"--rigid", "cartilge"}},
           Case{"law",
                kModel,
                2,
                "",
                {"found \"linar\" (did you mean \"linear\"?), expected linear, "},
                {"--law", "linar"}},
           Case{"place of springs", kModel, 2, "", {"(did you mean \"bone\"?)"}, {"--springs-at", "bon"}},
           Case{"facets", kModel, 2, "", {"(did you mean \"curved\"?)"}, {"--facets", "curvd"}},
           Case{"point of a load",
                kModel,
                2,
                "",
                {"(did you mean \"sphere-center\"?)"},
                {"--load-at", "plate=sphere-centre"}},
           Case{"turning point",
                kModel,
                2,
                "",
                {"(did you mean \"sphere-center\"?)"},
                {"--rotate-about", "plate=sphere_center"}},
           Case{"states",
                kModel,
                2,
                "",
                {"found \"lst\" (did you mean \"last\"?), expected all, "},
                {"--states", "lst"}},
           Case{"states in a list",
                kModel,
                2,
                "",
                {"found \"lats\" (did you mean \"last\"?)"},
                {"--states", "0.5,lats"}},
           Case{"rotations of a table", kModel, 2, "", {"(did you mean \"vector\"?)"}, {"--motion-rotation", "vektor"}},
           Case{"system of units", kModel, 2, "", {"(did you mean \"mm-N-s\"?)"}, {"--units", "mm-N"}},
           Case{"column of a table",
                kModel,
                2,
                "",
                {"has no column \"hip_fxx\" (did you mean \"hip_fx\"?)"},
                {"--loads", "walk.csv", "--load-body", "plate", "--load-columns", "hip_fxx,hip_fy,hip_fz"},
                {{"walk.csv", "time,hip_fx,hip_fy,hip_fz\n0,0,0,-1\n1,0,0,-2\n"}}},
           Case{"body of a table",
                kModel,
                2,
                "",
                {"(did you mean \"plate\"?)"},
                {"--loads", "walk.csv", "--load-body", "palte"},
                {{"walk.csv", "time,hip_fx,hip_fy,hip_fz\n0,0,0,-1\n1,0,0,-2\n"}}},
           Case{"setting of a file",
                kModel,
                3,
                "<thicknes",
                {"found <thicknes> (did you mean \"thickness\"?)"},
                {"--settings", "s.xml"},
                {{"s.xml", "<febiodea_settings version=\"1\">\n<thicknes>2</thicknes>\n</febiodea_settings>\n"}},
                "model.feb",
                "s.xml"},
           Case{"option", kModel, 2, "", {"no option --thicknes", "did you mean \"--thickness\"?"}, {"--thicknes=2"}},
           Case{"option by its usual name",
                kModel,
                2,
                "",
                {"no option --modulus (did you mean \"--E\"?)"},
                {"--modulus=2"}},
           Case{"option without its dashes",
                kModel,
                2,
                "",
                {"found \"inside\" (did you mean \"--inside\"?)"},
                {"inside"}},
           Case{"setting of a file by its usual name",
                kModel,
                3,
                "<poisson_ratio",
                {"found <poisson_ratio> (did you mean \"nu\"?)"},
                {"--settings", "s.xml"},
                {{"s.xml",
                  "<febiodea_settings version=\"1\">\n<poisson_ratio>2</poisson_ratio>\n</febiodea_settings>\n"}},
                "model.feb",
                "s.xml"},
           Case{"capitals and dashes", kModel, 2, "", {"(did you mean \"neo-Hookean\"?)"}, {"--law", "NEOHOOKEAN"}},
           Case{"type of a material",
                edited({{"neo-Hookean", "neo-hookean"}}),
                3,
                "<material id=\"1\"",
                {"type \"neo-hookean\": did you mean \"neo-Hookean\"?"}},
           Case{"a letter typed twice",
                edited({{"<E>10</E>", "<EE>10</EE>"}}),
                3,
                "<EE>",
                {"<EE> in material \"cartilage\" is none of FEBio's words: did you mean <E>?"}},
           Case{"axis of a turn",
                edited({{"type=\"rigid_force\"", "type=\"rigid_moment\""}, {"<dof>Rz", "<dof>rz"}}),
                3,
                "<rigid_load",
                {"dof \"rz\" (did you mean \"Rw\"?), expected one of Ru, Rv, Rw"}},
           Case{"axis of a turn as an option",
                kModel,
                2,
                "",
                {"\"rx\" (x is the way along x, Ru the turn about it)"},
                {"--free", "plate=rx"}},
           Case{"end of a curve",
                edited({{"<interpolate>", "<extend>CONSTAN</extend>\n<interpolate>"}}),
                3,
                "<value lc=\"1\">",
                {"extend \"CONSTAN\" (did you mean \"constant\"?)"}},
           Case{"a page without its ending",
                kModel,
                2,
                "",
                {"--report hip: found no ending, expected a name that ends in .html or .htm: hip.html"},
                {"--report", "hip"}},
       })
    check(c);
  const test::TemporaryFolder folder;
  const test::Finished f = test::run_program(folder.path, {DEA_PROGRAM, "rnu", "model.feb"}, kLimit);
  EXPECT_EQ(f.code, 2);
  EXPECT_NE(f.err.find("\"rnu\" is no command (did you mean \"run\"?)"), std::string::npos) << f.err;
}

// A bone of deformable shells is made rigid as one of solids is.
TEST(BadInput, ADeformableBoneOfShells) {
  std::string text = edited({{"type=\"rigid body\"><density>1</density><center_of_mass>0,0,-2</center_of_mass>",
                              "type=\"neo-Hookean\"><density>1</density><E>17000</E><v>0.3</v>"}});
  text = without("<rigid_bc name=\"hold base\"", "</rigid_bc>\n", text);
  check({"shells",
         text,
         3,
         "<Surface name=\"top\"",
         {"is held by no rigid body", "take its bone as rigid with --rigid \"base\", or"}});
}

// What is missing is said, where it is missing.
TEST(BadInput, AMaterialThatLacksOneConstant) {
  const std::string other = edited({{"type=\"neo-Hookean\"", "type=\"orthotropic CLE\""}});
  check({"both",
         other,
         3,
         "<material id=\"1\"",
         {"surface \"top\": material \"cartilage\" (type orthotropic CLE) gives no E and nu",
          "give them with --E \"top=VALUE\" --nu \"top=VALUE\""}});
  check({"E is given",
         other,
         3,
         "<material id=\"1\"",
         {"gives no nu (", "give it with --nu \"top=VALUE\""},
         {"--E", "5"}});
  check({"nu is given",
         other,
         3,
         "<material id=\"1\"",
         {"gives no E (", "give it with --E \"top=VALUE\""},
         {"--nu", "0.4"}});
}

// A body that nothing loads finds no balance for that reason alone, whatever the search has run into.
TEST(Solved, ABodyThatNothingLoadsIsNamed) {
  const test::TemporaryFolder folder;
  std::string text = test::file_text(DEA_SAMPLES_DIR "/hip/hip_walking.feb");
  for (std::size_t a = text.find("<rigid_load "); a != std::string::npos; a = text.find("<rigid_load "))
    text.erase(a, text.find("</rigid_load>", a) + 13 - a);
  std::ofstream(folder.path / "hip.feb") << text;
  const test::Finished f = test::run_program(
      folder.path, {DEA_PROGRAM, "run", "hip.feb", "-o", "r.xplt", "--states", "last", "--law", "linear"}, kLimit);
  EXPECT_EQ(f.code, 1) << f.err;
  EXPECT_NE(
      f.err.find("nothing loads body \"femur\", which is free to move along x, y, z: the contact pushes it away and "
                 "nothing pushes back; give it a load with --force \"femur=x,y,z\" or a rigid force in the model, or "
                 "hold or prescribe its motion [no-solution]\n"),
      std::string::npos)
      << f.err;
  EXPECT_EQ(f.err.find("springs carry"), std::string::npos) << f.err;
  const auto dea = [&](const Words& words) {
    Words all = {DEA_PROGRAM};
    all.insert(all.end(), words.begin(), words.end());
    return test::run_program(folder.path, all, kLimit);
  };
  const std::string warning = "warning: r.xplt: the state at time 2 is no solution; do not use its numbers\n";
  const test::Finished plotted = dea({"plot", "r.xplt"});
  EXPECT_NE(plotted.err.find(warning), std::string::npos) << plotted.err;
  const test::Finished compared = dea({"compare", "r.xplt", "r.xplt"});
  EXPECT_NE(compared.err.find(warning), std::string::npos) << compared.err;
  EXPECT_NE(compared.out.find("time 2, no solution: do not use its numbers"), std::string::npos) << compared.out;
  std::ofstream(folder.path / "plate.feb") << without("<rigid_load", "</rigid_load>\n");
  const test::Finished apart = test::run_program(folder.path, {DEA_PROGRAM, "run", "plate.feb", "--no-xplt"}, kLimit);
  EXPECT_NE(apart.err.find("nothing loads body \"plate\", though it is free to move, and nothing touches"),
            std::string::npos)
      << apart.err;
  EXPECT_NE(apart.err.find("give a load with --force \"plate=x,y,z\""), std::string::npos) << apart.err;
}

// Where a force acts matters to a body that can turn and is loaded.
TEST(Solved, APointOfALoadWithoutEffectIsTold) {
  const auto told = [](const std::string& text, const Words& options) {
    const test::TemporaryFolder folder;
    std::ofstream(folder.path / "model.feb") << text;
    Words words = {DEA_PROGRAM, "run", "model.feb", "-q", "--no-xplt"};
    words.insert(words.end(), options.begin(), options.end());
    return test::run_program(folder.path, words, kLimit).err;
  };
  const std::string turning = told(kModel, {"--load-at", "plate=0,0,1", "--free", "plate=z,Ru"});
  EXPECT_EQ(turning.find("--load-at"), std::string::npos) << turning;
  EXPECT_NE(
      told(kModel, {"--load-at", "plate=0,0,1"})
          .find(
              "warning: --load-at plate: it has no effect, for body \"plate\" is not free to turn [idle-load-point]\n"),
      std::string::npos);
  EXPECT_NE(told(kModel, {"--load-at", "base=0,0,1"})
                .find("warning: --load-at base: it has no effect, for no rigid force acts on body \"base\" (other "
                      "forces have points of their own); give one with "
                      "--force \"base=x,y,z\", or leave it out [idle-load-point]\n"),
            std::string::npos);
}

// Names of results, and words of the commands that look at them.
TEST(BadInput, MisspeltNamesOfResults) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "model.feb") << kModel;
  ASSERT_EQ(test::run_program(folder.path, {DEA_PROGRAM, "run", "model.feb", "-q", "-o", "r.xplt"}, kLimit).code, 0);
  const std::vector<std::pair<Words, std::string>> cases = {
      {{"plot", "--surface", "tpo"}, "top"},
      {{"plot", "--field", "contact presure"}, "contact pressure"},
      {{"plot", "--states", "lst"}, "last"},
      {{"plot", "--scale", "al"}, "all"},
      {{"plot", "--view", "unroled"}, "unrolled"},
      {{"plot", "--contours", "non"}, "none"},
      {{"compare", "r.xplt", "--surface", "tpo"}, "top"},
      {{"compare", "r.xplt", "--regions", "layr"}, "layer"},
      {{"compare", "r.xplt", "--areas", "deformd"}, "deformed"},
  };
  for (const auto& c : cases) {
    Words words = c.first;
    words.insert(words.begin(), DEA_PROGRAM);
    words.insert(words.begin() + 2, "r.xplt");
    const test::Finished f = test::run_program(folder.path, words, kLimit);
    EXPECT_TRUE(f.code == 2 || f.code == 3) << f.code << f.err;
    EXPECT_NE(f.err.find(fmt::format("(did you mean \"{}\"?)", c.second)), std::string::npos) << f.err;
    EXPECT_EQ(std::count(f.err.begin(), f.err.end(), '\n'), 1) << f.err;
    EXPECT_EQ(contents(folder.path).size(), 2u);
  }
}

// A surface called by what lies under it, where only one can be meant.
TEST(BadInput, SurfacesCalledByWhatLiesUnderThem) {
  const auto with = [](const Words& options) {
    const test::TemporaryFolder folder;
    std::ofstream(folder.path / "model.feb") << kModel;
    Words words = {DEA_PROGRAM, "run", "model.feb", "--no-xplt", "--json", "r.json"};
    words.insert(words.end(), options.begin(), options.end());
    test::Finished f = test::run_program(folder.path, words, kLimit);
    f.out = test::file_text(folder.path / "r.json");
    return f;
  };
  const auto states = [](const test::Finished& f) { return nlohmann::json::parse(f.out)["states"]; };
  const auto by_name = states(with({"--thickness", "top=1.5"}));
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"cartilage", "material \"cartilage\""}, {"layer", "element set \"layer\""}, {"base", "body \"base\""}};
  for (const auto& c : cases) {
    const test::Finished f = with({"--thickness", c.first + "=1.5"});
    EXPECT_EQ(f.code, 0) << f.err;
    EXPECT_EQ(states(f), by_name) << c.first;
    EXPECT_NE(f.err.find(fmt::format("note: --thickness \"{}\" names no surface; it is taken for \"top\", the only "
                                     "articular surface of {} [surface-meant]\n",
                                     c.first, c.second)),
              std::string::npos)
        << f.err;
  }
  EXPECT_NE(states(with({})), by_name);
  const test::Finished twice = with({"--thickness", "base=1.5", "--thickness", "top=2"});
  EXPECT_EQ(twice.code, 2);
  EXPECT_EQ(twice.err,
            "dea: --thickness base: it is taken for surface \"top\", which is given too; give one of them\n");
  const std::string two = edited(
      {{"<Surface name=\"under\">",
        "<Surface name=\"top 2\">\n<quad4 id=\"1\">5,6,7,8</quad4>\n</Surface>\n<Surface "
        "name=\"under\">"},
       {"</Mesh>",
        "<SurfacePair name=\"pair 2\">\n<primary>top "
        "2</primary>\n<secondary>under</secondary>\n</SurfacePair>\n</Mesh>"},
       {"</Contact>", "<contact name=\"again\" type=\"sliding-elastic\" surface_pair=\"pair 2\"/>\n</Contact>"}});
  check({"several surfaces of a material",
         two,
         2,
         "",
         {"--E cartilage: the model has no surface of this name, and material \"cartilage\" has 2 articular surfaces: "
          "\"top\", \"top 2\"; name one of them"},
         {"--E", "cartilage=5"}});
}

// Model and result taken for each other.
TEST(BadInput, APlotFileIsNoModel) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "hip.xplt", std::ios::binary) << std::string("BEF\0\0\0\0\1", 8);
  std::ofstream(folder.path / "hip.feb") << kModel;
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"run", "hip.xplt"}, "hip.xplt: this is a plot file, expected a FEBio model (.feb): dea plot and dea compare"},
      {{"info", "hip.xplt"}, "hip.xplt: this is a plot file"},
      {{"hip.xplt"}, "\"hip.xplt\" is no command (did you mean \"dea plot hip.xplt\"?)"},
      {{"compare", "hip.feb", "hip.xplt"},
       "hip.feb: this is a FEBio model, not a plot file: \"dea run hip.feb\" writes hip_dea.xplt, take that"},
  };
  for (const auto& c : cases) {
    std::vector<std::string> words = c.first;
    words.insert(words.begin(), DEA_PROGRAM);
    const test::Finished f = test::run_program(folder.path, words, kLimit);
    EXPECT_EQ(f.code, words.size() == 2 ? 2 : 3);
    EXPECT_NE(f.err.find(c.second), std::string::npos) << f.err;
    EXPECT_EQ(std::count(f.err.begin(), f.err.end(), '\n'), 1) << f.err;
  }
}

// All that is wrong is told at once, the most basic first, and by both commands.
TEST(BadInput, SeveralReasons) {
  std::string text = edited({{"<Rigid>",
                              "<Boundary>\n<bc name=\"push\" type=\"prescribed displacement\" node_set=\"corner\">\n"
                              "<dof>z</dof>\n<value>0.1*X</value>\n</bc>\n<bc type=\"linear constraint\"/>\n"
                              "</Boundary>\n<Rigid>"},
                             {"type=\"sliding-elastic\"", "type=\"tied-elastic\""},
                             {"<time_steps>2<", "<time_steps>0<"}});
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "model.feb") << text;
  const test::Finished run = test::run_program(folder.path, {DEA_PROGRAM, "run", "model.feb"}, kLimit);
  const test::Finished info = test::run_program(folder.path, {DEA_PROGRAM, "info", "model.feb"}, kLimit);
  EXPECT_EQ(run.code, 3);
  EXPECT_EQ(run.err, info.err);
  EXPECT_NE(run.err.find("found \"touch\" of type tied-elastic, which fastens surfaces"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("(and 3 more reasons: dea info lists them)"), std::string::npos) << run.err;
  for (const char* what : {"nodes that differs from node to node", "bc \"linear constraint\"", "ends at time 0"})
    EXPECT_NE(info.out.find(what), std::string::npos) << info.out;
}

// Nodes of a rigid body: the body is named.
TEST(BadInput, MovedNodesOfARigidBodyNameIt) {
  check({"moved nodes of a rigid body",
         edited(
             {{"<NodeSet name=\"corner\">\n5,6\n", "<NodeSet name=\"corner\">\n9,10\n"},
              {"<Rigid>",
               "<Boundary>\n<bc type=\"prescribed displacement\" node_set=\"corner\">\n<dof>z</dof>\n<value>0.1</value>"
               "\n</bc>\n</Boundary>\n<Rigid>"}}),
         3,
         "<bc type",
         {"of rigid body \"plate\"", "prescribe the motion of that body (rigid_bc of type rigid_displacement)"}});
}

TEST(Solved, TwoMotionsOfOneDofAreRemarkedAndTheLastOneCounts) {
  const std::string motion =
      "<rigid_bc type=\"rigid_displacement\">\n<rb>plate</rb>\n<dof>z</dof>\n<value>{}</value>\n</rigid_bc>\n";
  const std::string text = edited({{"</Rigid>", fmt::format(fmt::runtime(motion), "-0.3") +
                                                    fmt::format(fmt::runtime(motion), "-0.2") + "</Rigid>"}});
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "model.feb") << text;
  const test::Finished f =
      test::run_program(folder.path, {DEA_PROGRAM, "run", "model.feb", "--json", "r.json"}, kLimit);
  EXPECT_EQ(f.code, 0) << f.err;
  EXPECT_NE(f.err.find("prescribed z of \"plate\": it is prescribed again in line"), std::string::npos) << f.err;
  EXPECT_NE(f.out.find("(0, 0, -0.2)"), std::string::npos) << f.out;
}

// Of more time steps than anyone looks at some are chosen, unless all are asked for.
TEST(Solved, SomeOfVeryManyTimeSteps) {
  const std::string text =
      edited({{"<time_steps>2<", "<time_steps>1000000<"}, {"<step_size>0.5<", "<step_size>1e-6<"}});
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "model.feb") << text;
  const test::Finished all =
      test::run_program(folder.path, {DEA_PROGRAM, "run", "model.feb", "--states", "all"}, kLimit);
  EXPECT_EQ(all.code, 3);
  const test::Finished some =
      test::run_program(folder.path, {DEA_PROGRAM, "run", "model.feb", "--json", "some.json"}, kLimit);
  EXPECT_EQ(some.code, 0) << some.err;
  EXPECT_NE(some.err.find("note: of the model's 1000000 time steps 1001 are solved"), std::string::npos) << some.err;
  const test::Finished info = test::run_program(folder.path, {DEA_PROGRAM, "info", "model.feb"}, kLimit);
  EXPECT_NE(info.out.find("note: of the model's 1000000 time steps 1001 are solved"), std::string::npos) << info.out;
  const nlohmann::json states = nlohmann::json::parse(test::file_text(folder.path / "some.json"))["states"];
  ASSERT_EQ(states.size(), 1001u);
  EXPECT_NEAR(states[500]["time"].get<double>(), 0.5, 1e-12);
  EXPECT_NEAR(states[500]["contacts"][0]["force"][2].get<double>(), 2.5, 2.5e-6);  // half of the push
  const test::Finished last = test::run_program(
      folder.path, {DEA_PROGRAM, "run", "model.feb", "--states", "last", "--json", "r.json", "--overwrite"}, kLimit);
  EXPECT_EQ(last.code, 0) << last.err;
  EXPECT_NE(last.err.find("note: of the model's 1000000 time steps"), std::string::npos) << last.err;
  const nlohmann::json result = nlohmann::json::parse(test::file_text(folder.path / "r.json"));
  ASSERT_EQ(result["states"].size(), 1u);
  EXPECT_EQ(result["states"][0]["time"], 1.0);
  EXPECT_NEAR(result["states"][0]["contacts"][0]["force"][2].get<double>(), 5.0, 5e-6);  // balances the push of 5
}

TEST(Solved, SomeOfVeryManySteps) {
  std::string steps;
  for (int s = 1; s <= 12000; ++s)
    steps += fmt::format(
        "<step id=\"{}\"><Control><time_steps>1</time_steps><step_size>0.5</step_size></Control></step>\n", s);
  const std::string text = without("<step id=\"1\"", "</step>");
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "model.feb") << edited({{"<Step>", "<Step>" + steps}}, text);
  const test::Finished some =
      test::run_program(folder.path, {DEA_PROGRAM, "run", "model.feb", "--json", "some.json"}, kLimit);
  EXPECT_EQ(some.code, 0) << some.err;
  EXPECT_NE(some.err.find("note: of the model's 12000 time steps 925 are solved, evenly chosen: each"),
            std::string::npos)
      << some.err;
  const nlohmann::json states = nlohmann::json::parse(test::file_text(folder.path / "some.json"))["states"];
  ASSERT_EQ(states.size(), 925u);  // of time 0 and 12000 ends of steps each 13th, and the last
  EXPECT_NEAR(states[1]["time"].get<double>(), 13 * 0.5, 1e-9);
  EXPECT_NEAR(states.back()["time"].get<double>(), 12000 * 0.5, 1e-6);
  EXPECT_NEAR(states.back()["contacts"][0]["force"][2].get<double>(), 5.0, 5e-6);  // balances the push of 5
  const test::Finished info = test::run_program(folder.path, {DEA_PROGRAM, "info", "model.feb"}, kLimit);
  EXPECT_NE(info.out.find("... 11975 more steps"), std::string::npos) << info.out;
  EXPECT_NE(info.out.find("step 12000"), std::string::npos) << info.out;
}

TEST(BadInput, OptionsAndSettings) {
  const std::string kLoads = "time,fx,fy,fz\n0,0,0,-5\n1,0,0,-5\n", kMotion = "time,tx,ty,tz\n0,0,0,-0.5\n",
                    kTurns = "time,tx,ty,tz,rx,ry,rz\n0,0,0,-0.5,0,0,0\n";
  const auto settings = [](const std::string& body) {
    return std::map<std::string, std::string>{
        {"s.xml", "<?xml version=\"1.0\"?>\n<febiodea_settings version=\"1\">\n" + body + "\n</febiodea_settings>\n"}};
  };
  for (const Case& c : {
           Case{"thickness zero",
                kModel,
                2,
                "",
                {"--thickness", "deformable cartilage", "must be > 0"},
                {"--thickness", "0"}},
           Case{"thickness in metres",
                kModel,
                3,
                "",
                {"of 4 vertices its given thickness, 0.0004 in the mean, is less than 0.5% of the facets' size",
                 "give it in the model's unit of length", "or take --law linear"},
                {"--thickness", "top=0.0004"}},
           Case{"auxetic cartilage",
                kModel,
                3,
                "",
                {"nu = -0.35, and law layer has no answer for less than -0.3", "take --law neo-Hookean"},
                {"--nu=-0.35"}},
           Case{"thickness negative",
                kModel,
                2,
                "",
                {"--thickness -1", "expected a number >= 0"},
                {"--thickness", "-1"}},
           Case{"thickness nan", kModel, 2, "", {"--thickness nan", "expected a number"}, {"--thickness", "nan"}},
           Case{"thickness of no surface",
                kModel,
                2,
                "",
                {"--thickness tip", "it has \"top\", \"under\""},
                {"--thickness", "tip=2"}},
           Case{"thickness scale zero",
                kModel,
                2,
                "",
                {"--thickness-scale top=0", "expected a number > 0"},
                {"--thickness-scale", "top=0"}},
           Case{"thickness far beyond the surface's width",
                kModel,
                3,
                "<Surface name=\"top\">",
                {"its thickness is 1e+20, and the whole surface 2.82843 across; give it in the model's length"},
                {"--thickness", "top=1e20"}},
           Case{"thickness scale far beyond the surface's width",
                kModel,
                3,
                "<Surface name=\"top\">",
                {"its thickness is 2e+29, and"},
                {"--thickness-scale", "1e29"}},
           Case{"thickness scale of a bare surface",
                kModel,
                2,
                "",
                {"--thickness-scale under=2", "a bare rigid surface, without thickness"},
                {"--thickness-scale", "under=2"}},
           Case{"thickness from no file",
                kModel,
                3,
                "",
                {"t.csv: found no readable file, expected a table"},
                {"--thickness-from", "top=t.csv"}},
           Case{"thickness from a file and as a number",
                kModel,
                2,
                "",
                {"--thickness-from top=t.csv", "--thickness \"top\" says the thickness of the same surface"},
                {"--thickness-from", "top=t.csv", "--thickness", "top=2"},
                {{"t.csv", "node,thickness\n5,2\n6,2\n7,2\n8,2\n"}}},
           Case{"thickness from a file without some nodes",
                kModel,
                3,
                "",
                {"t.csv: found no thickness for 2 of the 4 nodes of surface \"top\" (6, 8); give one for every node"},
                {"--thickness-from", "top=t.csv"},
                {{"t.csv", "node,thickness\n5,2\n7,2\n"}}},
           Case{"thickness from a file twice",
                kModel,
                3,
                "7,3",
                {"found thickness 3 of node 7, and 2 in line 2, expected one for each node"},
                {"--thickness-from", "top=t.csv"},
                {{"t.csv", "node,thickness\n7,2\n7,3\n"}},
                "model.feb",
                "t.csv"},
           Case{"thickness from a file negative",
                kModel,
                3,
                "6,-2",
                {"found thickness -2, expected a number >= 0"},
                {"--thickness-from", "top=t.csv"},
                {{"t.csv", "node,thickness\n5,2\n6,-2\n"}},
                "model.feb",
                "t.csv"},
           Case{"set of nothing that is there",
                kModel,
                2,
                "",
                {"--set Push.force=3", "did you mean \"push\"?", "it has \"push\""},
                {"--set", "Push.force=3"}},
           Case{"set of another parameter",
                kModel,
                2,
                "",
                {"--set push.stiffness=3", "rigid force \"push\" has no stiffness; it has force"},
                {"--set", "push.stiffness=3"}},
           Case{"set without a parameter",
                kModel,
                2,
                "",
                {"--set push=3", "expected NAME.PARAMETER"},
                {"--set", "push=3"}},
           Case{"set to no number",
                kModel,
                2,
                "",
                {"--set push.force=much", "expected a number"},
                {"--set", "push.force=much"}},
           Case{"set and replaced",
                kModel,
                2,
                "",
                {"--set push.force=3", "takes the place of all forces on body \"plate\"; leave one out"},
                {"--set", "push.force=3", "--force", "plate=0,0,-1"}},
           Case{"rigid unknown",
                kModel,
                2,
                "",
                {"--rigid bone", "\"cartilage\", \"base\", \"plate\""},
                {"--rigid", "bone"}},
           Case{"attach unknown",
                kModel,
                2,
                "",
                {"--attach top=bass", "it has \"base\", \"plate\""},
                {"--attach", "top=bass"}},
           Case{"contact unknown", kModel, 2, "", {"--contact tooch", "it has \"touch\""}, {"--contact", "tooch"}},
           Case{"source unknown", kModel, 2, "", {"--source bass", "it has \"base\""}, {"--source", "bass"}},
           Case{"option unknown", kModel, 2, "", {"--foo", "--help"}, {"--foo"}},
           Case{"time beyond the end", kModel, 2, "", {"--states 5", "from 0 to 1"}, {"--states", "5"}},
           Case{"loads on the ground",
                kModel,
                2,
                "",
                {"--load-body ground: the ground never moves; name a rigid body"},
                {"--loads", "t.csv", "--load-body", "ground"},
                {{"t.csv", kLoads}}},
           Case{"motion of the ground",
                kModel,
                2,
                "",
                {"--motion-body ground: the ground never moves; name a rigid body"},
                {"--motion", "t.csv", "--motion-body", "ground"},
                {{"t.csv", kMotion}}},
           Case{"ground set free",
                kModel,
                2,
                "",
                {"--free ground: the ground never moves; name a rigid body"},
                {"--free", "ground=x"}},
           Case{"loads on no body",
                kModel,
                2,
                "",
                {"--loads t.csv: no body is named", "--load-body \"BODY\""},
                {"--loads", "t.csv"},
                {{"t.csv", kLoads}}},
           Case{"motion of no body",
                kModel,
                2,
                "",
                {"--motion t.csv: no body is named", "--motion-body \"BODY\""},
                {"--motion", "t.csv"},
                {{"t.csv", kMotion}}},
           Case{"loads without a force",
                kModel,
                3,
                "",
                {"t.csv: found no columns fx, fy, fz among \"time\", \"tx\"", "--load-columns FX,FY,FZ,MX,MY,MZ"},
                {"--loads", "t.csv", "--load-body", "plate"},
                {{"t.csv", kMotion}}},
           Case{"motion without a translation",
                kModel,
                3,
                "",
                {"t.csv: found no columns tx, ty, tz among \"time\", \"fx\"", "--motion-columns TX,TY,TZ,RX,RY,RZ"},
                {"--motion", "t.csv", "--motion-body", "plate"},
                {{"t.csv", kLoads}}},
           Case{"rotations of no kind",
                kModel,
                2,
                "",
                {"--motion t.csv: its rows have rotations, and nobody says what their three numbers are",
                 "--motion-rotation vector", "--motion-rotation zxy"},
                {"--motion", "t.csv", "--motion-body", "plate"},
                {{"t.csv", kTurns}}},
           Case{"rotations without a unit",
                kModel,
                2,
                "",
                {"--motion t.csv: its rows have rotations, and nobody says whether in degrees or radians",
                 "--motion-units deg-mm"},
                {"--motion", "t.csv", "--motion-body", "plate", "--motion-rotation", "xyz"},
                {{"t.csv", kTurns}}},
           Case{"four columns",
                kModel,
                2,
                "",
                {"--load-columns fx,fy,fz,time: these are 4 columns; name three, or six"},
                {"--loads", "t.csv", "--load-body", "plate", "--load-columns", "fx,fy,fz,time"},
                {{"t.csv", kLoads}}},
           Case{"states between the rows",
                kModel,
                2,
                "",
                {"--states 0.3:0.4: found no row of the table in this range, expected times from 0 to 1"},
                {"--loads", "t.csv", "--load-body", "plate", "--states", "0.3:0.4"},
                {{"t.csv", kLoads}}},
           Case{"states between the model's",
                kModel,
                2,
                "",
                {"--states 0.3:0.4: found no state of the model in this range, expected times from 0 to 1"},
                {"--states", "0.3:0.4"}},
           Case{"times from a result beside a table",
                kModel,
                2,
                "",
                {"--times-from r.xplt: found a table of loads or motion beside it, expected the model's own steps"},
                {"--loads", "t.csv", "--load-body", "plate", "--times-from", "r.xplt"},
                {{"t.csv", kLoads}}},
           Case{"times from a result without steps",
                kModel,
                2,
                "",
                {"--times-from r.xplt: found --skip-steps beside it, expected the model's own steps"},
                {"--skip-steps", "--times-from", "r.xplt"}},
           Case{"terms of another law",
                kModel,
                2,
                "",
                {"--layer-terms 1: contact \"touch\" has law linear; only law layer has terms"},
                {"--layer-terms", "1", "--law", "linear"}},
           Case{"set beside a table of loads",
                kModel,
                2,
                "",
                {"--set push.force=3: --loads t.csv takes the place of all loads on body \"plate\"; leave one out"},
                {"--loads", "t.csv", "--load-body", "plate", "--set", "push.force=3"},
                {{"t.csv", kLoads}}},
           Case{"load at the sphere of no surface",
                kModel,
                2,
                "",
                {"--load-at ground=sphere-center: this body has no articular surface, so no sphere; name the point: "
                 "--load-at \"ground=x,y,z\""},
                {"--load-at", "ground=sphere-center"}},
           Case{"load in axes that turn freely",
                kModel,
                2,
                "",
                {"--load-frame plate: this body is free to turn",
                 "name the loaded body, one that is held, or three axes"},
                {"--loads", "t.csv", "--load-body", "base", "--load-frame", "plate", "--free", "plate=z,Ru"},
                {{"t.csv", kLoads}}},
           Case{"left-handed axes",
                kModel,
                2,
                "",
                {"--load-frame 1,0,0/0,1,0/0,0,-1: found", "expected three axes at right angles, right-handed"},
                {"--loads", "t.csv", "--load-body", "plate", "--load-frame", "1,0,0/0,1,0/0,0,-1"},
                {{"t.csv", kLoads}}},
           Case{"axes of letters",
                kModel,
                2,
                "",
                {"--load-frame 1,0,0/0,1,0/0,0,z: found", "expected three axes at right angles"},
                {"--loads", "t.csv", "--load-body", "plate", "--load-frame", "1,0,0/0,1,0/0,0,z"},
                {{"t.csv", kLoads}}},
           Case{"settings missing", kModel, 3, "", {"s.xml: ", "expected a settings file"}, {"--settings", "s.xml"}},
           Case{"settings no XML",
                kModel,
                3,
                "law",
                {"expected <febiodea_settings"},
                {"--settings", "s.xml"},
                {{"s.xml", "law=linear\n"}},
                "model.feb",
                "s.xml"},
           Case{"settings another root",
                kModel,
                3,
                "<foo>",
                {"found <foo>", "expected <febiodea_settings"},
                {"--settings", "s.xml"},
                {{"s.xml", "<?xml version=\"1.0\"?>\n<foo>\n</foo>\n"}},
                "model.feb",
                "s.xml"},
           Case{"settings unknown word",
                kModel,
                3,
                "<lawn>",
                {"lawn"},
                {"--settings", "s.xml"},
                settings("<lawn>linear</lawn>"),
                "model.feb",
                "s.xml"},
           Case{"settings unknown value",
                kModel,
                3,
                "<law>",
                {"linar", "expected"},
                {"--settings", "s.xml"},
                settings("<law>linar</law>"),
                "model.feb",
                "s.xml"},
       })
    check(c);
}

TEST(BadInput, OutputsThatCannotBeWritten) {
  for (const Case& c : {
           Case{"no such folder", kModel, 4, "", {"no/where.xplt", "there is no folder no"}, {"-o", "no/where.xplt"}},
           Case{"full device", kModel, 4, "", {"/dev/full", "No space left"}, {"-o", "/dev/full"}},
           Case{"folder", kModel, 4, "", {"is a folder"}, {"-o", "."}},
           Case{"no such folder for JSON",
                kModel,
                4,
                "",
                {"no/where.json", "there is no folder no"},
                {"--json", "no/where.json"}},
           Case{"over the model", kModel, 2, "", {"-o model.feb", "would overwrite the model"}, {"-o", "model.feb"}},
           Case{"over the model, another spelling",
                kModel,
                2,
                "",
                {"would overwrite the model"},
                {"-o", "././model.feb"}},
           Case{"JSON over the model",
                kModel,
                2,
                "",
                {"--json model.feb", "would overwrite the model"},
                {"--json", "model.feb"}},
           Case{"CSV over the settings",
                kModel,
                2,
                "",
                {"--csv s.xml", "would overwrite the settings file"},
                {"--csv", "s.xml", "--settings", "s.xml"},
                {{"s.xml", "<?xml version=\"1.0\"?>\n<febiodea_settings version=\"1\">\n</febiodea_settings>\n"}}},
       })
    check(c);
}

// A folder without permission to write. Root may write anywhere: nothing to see then.
TEST(BadInput, FolderThatIsReadOnly) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write anywhere";
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "model.feb") << kModel;
  fs::permissions(folder.path, fs::perms::owner_read | fs::perms::owner_exec);
  const test::Finished f = test::run_program(folder.path, {DEA_PROGRAM, "run", "model.feb"}, kLimit);
  fs::permissions(folder.path, fs::perms::owner_all);
  EXPECT_EQ(f.code, 4);
  EXPECT_NE(error_of(f).find("model_dea.xplt"), std::string::npos) << f.err;
  EXPECT_EQ(contents(folder.path).size(), 1u);
}

// A valid answer that is no solution: exit code 1, written and marked as what it is in every place.
TEST(NoSolution, IsWrittenAndMarked) {
  struct NoSolution {
    const char* name;
    Edits edits;
    const char* outcome;
  };
  const NoSolution cases[] = {
      {"pulled apart", {{">-5<", ">5<"}}, "SurfacesApart"},
      {"pushed aside",
       {{"<rb>plate</rb>\n<Rx_dof>1", "<rb>plate</rb>\n<Rx_dof>0"}, {"<dof>Rz</dof>", "<dof>Rx</dof>"}},
       "SurfacesApart"},
      {"more than cartilage can carry", {{">-5<", ">-5000<"}}, "BeyondStrainLimit"},
      {"a load out of this world", {{">-5<", ">-1e29<"}}, "NoEquilibrium"},
  };
  for (const NoSolution& c : cases) {
    SCOPED_TRACE(c.name);
    const test::TemporaryFolder folder;
    std::ofstream(folder.path / "model.feb") << edited(c.edits);
    const test::Finished f =
        test::run_program(folder.path, {DEA_PROGRAM, "run", "model.feb", "--json", "r.json"}, kLimit);
    EXPECT_EQ(f.code, 1) << f.err;
    EXPECT_FALSE(f.timed_out);
    EXPECT_NE(f.out.find(c.outcome), std::string::npos) << f.out;
    EXPECT_NE(f.err.find(std::string("warning: times 0.5 to 1 (2 states): ") + c.outcome + "; at time 1: "),
              std::string::npos)
        << f.err;
    EXPECT_FALSE(has_nan(f.out + f.err)) << f.out << f.err;
    EXPECT_EQ(contents(folder.path).size(), 3u);
    EXPECT_GT(fs::file_size(folder.path / "model_dea.xplt"), 1000u);
    const std::string text = test::file_text(folder.path / "r.json");
    EXPECT_FALSE(has_nan(text));
    EXPECT_EQ(nlohmann::json::parse(text)["states"].back()["outcome"], c.outcome);
  }
}

// What is read from a plot file later knows it too.
TEST(NoSolution, IsMarkedInPlotAndCompare) {
  const test::TemporaryFolder folder;
  const auto dea = [&](const Words& words) {
    Words all = {DEA_PROGRAM};
    all.insert(all.end(), words.begin(), words.end());
    return test::run_program(folder.path, all, kLimit);
  };
  std::ofstream(folder.path / "good.feb") << kModel;
  std::ofstream(folder.path / "apart.feb") << edited({{">-5<", ">5<"}});
  EXPECT_EQ(dea({"run", "good.feb"}).code, 0);
  EXPECT_EQ(dea({"run", "apart.feb"}).code, 1);
  EXPECT_EQ(dea({"plot", "good_dea.xplt"}).code, 0);
  const std::string warning = "warning: apart_dea.xplt: the state at time 1 is no solution; do not use its numbers\n";
  const test::Finished plotted = dea({"plot", "apart_dea.xplt", "-q", "-o", "a.png"});
  EXPECT_EQ(plotted.code, 1);
  EXPECT_EQ(plotted.err, warning);
  EXPECT_TRUE(fs::exists(folder.path / "a.png"));
  EXPECT_EQ(dea({"plot", "apart_dea.xplt", "-q", "-o", "b.png", "--at", "0"}).code, 0);  // the reference state
  EXPECT_EQ(dea({"plot", "good_dea.xplt", "--minus", "apart_dea.xplt", "-q", "-o", "c.png"}).code, 1);
  EXPECT_EQ(dea({"plot", "apart_dea.xplt", "-q", "--animate", "a.gif"}).code, 1);
  EXPECT_EQ(dea({"compare", "good_dea.xplt", "good_dea.xplt"}).code, 0);
  const test::Finished f =
      dea({"compare", "apart_dea.xplt", "good_dea.xplt", "-q", "--json", "c.json", "--csv", "c.csv"});
  EXPECT_EQ(f.code, 1);
  EXPECT_EQ(f.err, warning);
  const auto results = nlohmann::json::parse(test::file_text(folder.path / "c.json"))["results"];
  EXPECT_EQ(results[0]["solved"], false);
  EXPECT_EQ(results[1]["solved"], true);
  const std::string csv = test::file_text(folder.path / "c.csv");
  EXPECT_NE(csv.find(",solved\napart_dea,"), std::string::npos) << csv;
  EXPECT_NE(csv.find(",0\ngood_dea,"), std::string::npos) << csv;
}

// Models no one here wrote: solved, refused with one line, or no solution; never a crash, a hang or half a file.
TEST(Corpus, EveryModelIsSolvedOrRefused) {
  const fs::path corpus = DEA_CORPUS_DIR;
  if (!fs::exists(corpus)) GTEST_SKIP() << "no corpus";
  std::vector<fs::path> models;
  for (const char* version : {"v2.5", "v3.0", "v4.0"})
    for (const auto& entry : fs::directory_iterator(corpus / version))
      if (entry.path().extension() == ".feb") models.push_back(entry.path());
  std::sort(models.begin(), models.end());
  ASSERT_GT(models.size(), 100u);
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::map<std::string, int> outcomes;
  const auto work = [&] {
    for (std::size_t i; (i = next++) < models.size();) {
      for (const char* command : {"info", "run"}) {
        const test::TemporaryFolder folder;
        Words words = {DEA_PROGRAM, command, models[i].string()};
        if (std::string(command) == "run") words.insert(words.end(), {"-o", "out.xplt", "--threads", "1"});
        if (words[1] == "run" && models[i].stem() == "ex01")
          words.insert(words.end(), {"--states", "last"});  // of 1000
        const test::Finished f = test::run_program(folder.path, words, kLimit);
        const std::lock_guard<std::mutex> lock(mutex);
        SCOPED_TRACE(fmt::format("{} {}", command, models[i].string()));
        EXPECT_FALSE(f.timed_out);
        EXPECT_TRUE(f.code == 0 || f.code == 3 || (f.code == 1 && words[1] == "run")) << f.code << " " << f.err;
        if (f.code == 3) {
          EXPECT_TRUE(starts_with(error_of(f), models[i].string() + ":")) << f.err;
        }
        EXPECT_FALSE(has_nan(f.out + f.err)) << f.out << f.err;
        EXPECT_EQ(contents(folder.path).size(), words[1] == "run" && f.code != 3 ? 1u : 0u);
        ++outcomes[fmt::format("dea {:4} {} exit {}", command, models[i].parent_path().filename().string(),
                               f.timed_out ? -1 : f.code)];
        if (words[1] == "run" && f.code != 3) fmt::print("{} exit {}\n", models[i].string(), f.code);
      }
    }
  };
  std::thread second(work);
  work();
  second.join();
  for (const auto& outcome : outcomes) fmt::print("{}: {}\n", outcome.first, outcome.second);
}

}  // namespace dea::bad_input_test

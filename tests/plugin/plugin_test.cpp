// The plugin from outside: febio4 and `dea run` on the same models, and everything that can go wrong.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "io/feb/read_feb.h"
#include "src/base/error.h"
#include "tests/plugin/connected_models.h"
#include "tests/plugin/febio_runs.h"
#include "tests/plugin/model_dump.h"
#include "tests/program.h"

namespace dea::test {
namespace {

using Json = nlohmann::json;

/// A message without its line, which FEBio's model does not have, and without the count of other reasons.
std::string without_place(const std::string& line) {
  const std::string text = std::regex_replace(line, std::regex(R"(\.feb:\d+:)"), ".feb:");
  return std::regex_replace(text, std::regex(R"( \(and \d+ more reasons?: dea info lists them\)|\n)"), "");
}

/// What is ignored stands in the file's order, which FEBio does not keep: without places, sorted.
std::vector<std::string> findings(const Json& list) {
  std::vector<std::string> all;
  for (const Json& line : list) all.push_back(without_place(line));
  std::sort(all.begin(), all.end());
  return all;
}

/// Largest relative difference of two JSON values, their times of day and lines left out; 1e300: not the same kind of
/// thing.
double difference(const Json& a, const Json& b) {
  if (a.is_number() && b.is_number()) {
    const double x = a.get<double>(), y = b.get<double>();
    return x == y ? 0.0 : std::abs(x - y) / std::max(std::abs(x), std::abs(y));
  }
  if (a.type() != b.type() || a.size() != b.size()) return 1e300;
  if (a.is_string()) return without_place(a) == without_place(b) ? 0.0 : 1e300;
  if (!a.is_structured()) return a == b ? 0.0 : 1e300;
  double largest = 0.0;
  for (const auto& item : a.items()) {
    if (item.key() == "timings" || item.key() == "finding_values") continue;  // the same as findings, with places
    if (a.is_object() && !b.contains(item.key())) return 1e300;
    if (item.key() == "findings") {
      if (findings(item.value()) != findings(b.at("findings"))) return 1e300;
      continue;
    }
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
  for (const char* old : {"task.xplt", "task.json", "task.csv", "cli.xplt", "cli.json", "cli.csv"})
    fs::remove(folder / old);
  const Finished task = febio(folder, model, "dea", "task.xml");
  const Finished cli = run_program(folder,
                                   {DEA_PROGRAM, "run", model, "-o", "cli.xplt", "--json", "cli.json", "--csv",
                                    "cli.csv", "--settings", "cli.xml", "--overwrite"},
                                   300);
  ASSERT_LE(cli.code, 1) << cli.err;
  ASSERT_EQ(cli.code == 0, task.code == 0) << cli.err << task.out;
  ASSERT_TRUE(fs::exists(folder / "task.json")) << task.out << task.err;
  const Json a = Json::parse(file_text(folder / "task.json")), b = Json::parse(file_text(folder / "cli.json"));
  EXPECT_GE(a["states"].size(), 1u);
  EXPECT_LE(difference(a, b), 1e-12);
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

// Axes of elements in one meniscus, fibres of elements in the other: FEBio keeps them apart from the material.
TEST(Plugin, FibresAndAxesOfElementsAsDeaRunTakesThem) {
  const TemporaryFolder folder;
  std::string text = file_text(fs::path(DEA_SAMPLES_DIR) / "menisci" / "menisci.feb"), axes, fibres;
  for (int i = 1; i <= 108; ++i) {
    const char* along = i <= 54 ? "1,0,0" : "0,1,0";  // of length 1 without rounding
    axes += fmt::format("<e lid=\"{}\"><a>{}</a><d>0,0,1</d></e>\n", i, along);
    fibres += fmt::format("<e lid=\"{}\">{}</e>\n", i, along);
  }
  const std::string local = "<fiber type=\"local\">1,2</fiber>";
  text.replace(text.find(local), local.size(), "<fiber type=\"vector\">1,0,0</fiber>");
  text.replace(text.find(local), local.size(), "<fiber type=\"user\"/>");
  const std::string end = "</MeshDomains>\n";
  text.insert(text.find(end) + end.size(),
              fmt::format("<MeshData>\n<ElementData type=\"mat_axis\" elem_set=\"medial_meniscus\">\n{}</ElementData>\n"
                          "<ElementData type=\"fiber\" elem_set=\"lateral_meniscus\">\n{}</ElementData>\n</MeshData>\n",
                          axes, fibres));
  write(folder.path / "directions.feb", text);
  expect_the_same(folder.path, "directions.feb");
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

/// Remedies as the plugin words them: --bone "S=SURFACE" as <bone surface="S">SURFACE</bone>.
std::string in_settings_file(const std::string& fault) {
  const std::string keyed = std::regex_replace(fault, std::regex(R"re(--(\w[\w-]*) "([^"]*)=([^"=]*)")re"),
                                               R"(<$1 surface="$2">$3</$1>)"),
                    named = std::regex_replace(keyed, std::regex(R"re(--(\w[\w-]*) "([^"]*)")re"), "<$1>$2</$1>");
  const std::string valued =
      std::regex_replace(named, std::regex("--(states|law|springs-at) ([^ ,;]+(,[^ ,;]+)*)"), "<$1>$2</$1>");
  const std::string forced =
      std::regex_replace(valued, std::regex("--force BODY=x,y,z"), R"(<force body="BODY">x,y,z</force>)");
  return std::regex_replace(forced, std::regex("--(rigid)\\b"), "<$1>");
}

TEST(Plugin, ForeignModelsEndAsWithDeaRun) {
  const TemporaryFolder folder;
  int solved = 0, refused = 0, unread = 0;
  for (const fs::path& model : models_in(DEA_CORPUS_DIR)) {
    SCOPED_TRACE(model);
    const std::string name = model.filename().string();
    for (const char* old : {"task.json", "cli.json", "o.xplt"}) fs::remove(folder.path / old);
    fs::copy(model, folder.path / name, fs::copy_options::overwrite_existing);
    write(folder.path / "s.xml",
          "<febiodea_settings version=\"1\"><output>o.xplt</output><json>task.json</json></febiodea_settings>");
    const Finished task = febio(folder.path, name, "dea", "s.xml");
    if (task.out.find("task dea\n") == task.out.npos) {  // FEBio does not take the file
      ++unread;
      continue;
    }
    const Finished cli =
        run_program(folder.path, {DEA_PROGRAM, "run", name, "-q", "-o", "o.xplt", "--json", "cli.json"}, 300);
    EXPECT_EQ(task.code, cli.code == 0 ? 0 : 1);
    if (cli.code <= 1) {
      const Json a = Json::parse(file_text(folder.path / "task.json"));
      const Json b = Json::parse(file_text(folder.path / "cli.json"));
      EXPECT_LE(difference(a, b), 1e-12);
      ++solved;
      continue;
    }
    // What the file says of a list of nodes and of a contact's name, and the words of older versions, FEBio forgets.
    std::string fault = in_settings_file(without_place(cli.err));
    fault = std::regex_replace(fault, std::regex("the nodes listed here"), "a list of nodes");
    fault =
        std::regex_replace(fault, std::regex(R"(instead \([^)]*\))"), "instead (rigid_bc of type rigid_displacement)");
    if (model.parent_path().filename() == "v2.0")
      fault = std::regex_replace(fault, std::regex("found \"Sticky01\""), "found \"contact 1\"");
    fault = std::regex_replace(fault, std::regex("; found contact \"rigid\", which fastens nodes to a rigid body"),
                               ", and there is no contact at all: add one, or there is nothing to solve for DEA");
    const std::vector<std::string> errors = errors_of(task.out);
    ASSERT_FALSE(errors.empty());
    EXPECT_EQ(errors.back(), fault);  // the others are FEBio's
    ++refused;
  }
  if (solved == 0) GTEST_SKIP() << "no models in " << DEA_CORPUS_DIR;
  std::cout << solved << " models with results, " << refused << " refused, " << unread << " not taken by FEBio\n";
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

TEST(Plugin, EveryLoadJointAndSpringAsDeaRunSolvesIt) {
  const TemporaryFolder folder;
  for (const auto& [name, text] : connected_models()) {
    write(folder.path / (name + ".feb"), text);
    expect_the_same(folder.path, name + ".feb");
    const std::set<std::string> solved = {"Prescribed", "Balanced", "BalancedToOneSpring"};
    const Json result = Json::parse(file_text(folder.path / "cli.json"));  // the states apart are found apart by both
    EXPECT_EQ(solved.count(result["states"].back()["outcome"]), 1u) << name;
  }
}

TEST(Plugin, WhatDeaRunRefusesIsRefusedWithTheSameWordsButSettings) {
  const TemporaryFolder folder;
  for (const auto& [name, text] : refused_models()) {
    write(folder.path / (name + ".feb"), text);
    const Finished cli = run_program(folder.path, {DEA_PROGRAM, "run", name + ".feb"}, 60);
    const Finished task = febio(folder.path, name + ".feb", "dea");
    EXPECT_EQ(cli.code, 3) << name << cli.out;
    EXPECT_EQ(task.code, 1) << name << task.out;
    EXPECT_EQ(errors_of(task.out), std::vector<std::string>{in_settings_file(without_place(cli.err))})
        << name << task.err;
  }
}

TEST(Plugin, SettingsHoldForTheTask) {
  const TemporaryFolder folder;
  write(folder.path / "m.feb", model_40(false));
  for (const char* settings :
       {"<law>logarithmic</law><refine>3</refine><states>last</states>",
        "<thickness surface=\"top\">1.5</thickness><E surface=\"top\">3</E>",
        "<source>plate</source><states>0.3,1</states>", "<facets>flat</facets><squash>false</squash>",
        "<free body=\"plate\">x,y</free><force body=\"plate\">0,0,-3</force><load-at body=\"plate\">1,1,1</load-at>"})
    expect_the_same(folder.path, "m.feb", settings);
}

// A socket turned by 10 degrees, and a table of loads: the task's settings are those of the file.
TEST(Plugin, PlacesAndLoadsAsDeaRunDoes) {
  const TemporaryFolder folder;
  fs::copy(fs::path(DEA_SAMPLES_DIR) / "hip" / "hip_walking.feb", folder.path / "hip.feb");
  expect_the_same(folder.path, "hip.feb", "<rotate body=\"pelvis\">0,1,0,10</rotate>");
  write(folder.path / "gait.csv", "time,fx,fy,fz\n0,200,-100,900\n0.5,432,-262,1834\n");
  expect_the_same(folder.path, "hip.feb",
                  "<move body=\"pelvis\">0.5,0,0</move><loads>gait.csv</loads><load-body>femur</load-body>");
}

TEST(Plugin, ThePageIsThatOfDeaRun) {
  const TemporaryFolder folder;
  write(folder.path / "m.feb", model_40(false));
  write(folder.path / "s.xml",
        "<febiodea_settings version=\"1\"><output>o.xplt</output><report>page.html</report></febiodea_settings>");
  const auto data = [&](const Finished& f) {
    EXPECT_EQ(f.code, 0) << f.out << f.err;
    const std::string html = file_text(folder.path / "page.html"), begin = "id=\"report\">";
    const std::size_t from = html.find(begin) + begin.size();
    fs::remove(folder.path / "page.html");
    return Json::parse(html.substr(from, html.find("</script>", from) - from));
  };
  Json task = data(febio(folder.path, "m.feb", "dea", "s.xml"));
  Json cli = data(run_program(folder.path, {DEA_PROGRAM, "run", "m.feb", "--settings", "s.xml"}, 60));
  EXPECT_EQ(task["command"], "febio4 -i m.feb -task=dea s.xml");
  EXPECT_EQ(task["title"], "m");
  for (const char* key : {"surfaces", "frames", "charts", "tables", "meshes"}) {
    EXPECT_FALSE(cli[key].empty()) << key;
    EXPECT_LE(difference(task[key], cli[key]), 1e-6) << key;
  }
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
         "s.xml:1: <law>: found \"cubic\", expected linear, logarithmic, neo-Hookean or layer");
  expect("m.feb", settings("<source>100% femur</source>"),
         "dea: <source>100% femur</source>: the model has no rigid body of this name; it has \"base\", \"plate\", "
         "\"ground\"");
  expect("m.feb", settings("<output>no/such/folder.xplt</output>"),
         "dea: cannot write no/such/folder.xplt: there is no folder no/such");
  expect("m.feb", settings("<output>m.feb</output>"), "dea: <output> m.feb: would overwrite the model");
  expect("m.feb", settings("<json>s.xml</json>"), "dea: <json> s.xml: would overwrite the settings file");
  expect("m.feb", settings("<report>-</report>"), "dea: <report> -: standard output is FEBio's, give it a file name");
  expect("m.feb", settings("<report>page.txt</report>"),
         "dea: <report> page.txt: found \".txt\", expected a name that ends in .html or .htm");
  expect("m.feb", settings("<report>a.html</report><json>a.html</json>"),
         "dea: <report> a.html: is the file of <json> too");
  expect("m.feb", settings("<csv>s.log</csv>"), "dea: <csv> s.log: would overwrite FEBio's log file");
  expect("m.feb", settings("<json>-</json>"), "dea: <json> -: standard output is FEBio's, give it a file name");
  expect("m.feb", settings("<states>7</states>"),
         "dea: s.xml:1: <states>: found time 7, expected times from 0 to 1, those of the model");
  expect("m.feb", settings("\n<states>some</states>"),
         "s.xml:2: <states>: found \"some\", expected all, last, times t1,t2,... or ranges t1:t2");
  expect("m.feb", settings("<no-xplt>yes</no-xplt>"), "s.xml:1: <no-xplt>: found \"yes\", expected true or false");
  expect("none.feb", "",
         "none.feb: no sliding contact in the model; DEA needs one between two bodies (Contact section, e.g. type "
         "\"sliding-elastic\"), and there is no contact at all: add one, or there is nothing to solve for DEA");
  expect("loose.feb", "",
         "loose.feb: contact \"touch\", surface \"top\": its layer is held by no rigid body (no shared nodes, rigid "
         "node set, "
         "tied contact or nodes fixed in x, y and z); name the body with <attach surface=\"top\">BODY</attach> "
         "(bodies: \"base\" without elements, "
         "\"plate\"), and the layer's bone surface with <bone surface=\"top\">SURFACE</bone> or its thickness with "
         "<thickness surface=\"top\">VALUE</thickness>");
  expect(
      "pressed.feb", "",
      "pressed.feb: surface_load \"pressure\" is not supported and would change the result: surfaces carry the "
      "pressure of contact only; give the load to the rigid body behind them as a force (rigid force of the file, or "
      "<force body=\"BODY\">x,y,z</force>), and take this one out");
}

TEST(Plugin, AFaultReadsAsInDeaRun) {
  const TemporaryFolder folder;
  // FEBio's reader keeps no lines; all else is the same
  const auto expect = [&](const Extra& extra, const std::string& fault) {
    write(folder.path / "m.feb", pressed_model(extra));
    const Finished run = run_program(folder.path, {DEA_PROGRAM, "run", "m.feb"}, 60);
    EXPECT_EQ(run.code, 3);
    EXPECT_EQ(std::regex_replace(run.err, std::regex("m\\.feb:[0-9]+: "), "m.feb: "), "m.feb: " + fault + "\n");
    const Finished task = febio(folder.path, "m.feb", "dea");
    EXPECT_EQ(task.code, 1);
    EXPECT_EQ(errors_of(task.out), std::vector<std::string>{"m.feb: " + fault});
  };
  expect(springs("type=\"experimental spring\"><E>3</E><sM>0</sM><sm>1</sm>"),
         "experimental spring with E = 3, sM = 0, sm = 1, need E >= 0, sM > 0 and sm > 0");
  expect({connector("rigid revolute joint", "<rotation_axis>0,0,0</rotation_axis>")},
         "rigid revolute joint: rotation_axis is zero, expected a direction x,y,z");
  expect({connector("rigid prismatic joint",
                    "<translation_axis>1,2,0</translation_axis><transverse_axis>2,4,0</transverse_axis>")},
         "rigid prismatic joint: translation_axis and transverse_axis have the same direction, expected two different "
         "ones");
  expect({rigid_load("rigid_cable",
                     "<force>1</force><force_direction>0,0,0</force_direction><rigid_cable_point><rigid_body_id>plate"
                     "</rigid_body_id><position>1,1,1</position></rigid_cable_point>")},
         "force_direction is zero, expected a direction");
  expect({connector("rigid cylindrical joint",
                    "<joint_axis>0,0,1</joint_axis><prescribed_rotation>1"
                    "</prescribed_rotation><rotation>1</rotation><moment>2</moment>")},
         "rigid cylindrical joint with prescribed_rotation = 1 and a moment of 2, expected one of them");
}

TEST(Plugin, ANodeThatFebioDoesNotMissIsRefused) {
  const TemporaryFolder folder;
  Extra strings = springs("type=\"linear spring\"><E>3</E>");
  strings.mesh.replace(strings.mesh.find(",19"), 3, ",30");
  std::string text = pressed_model(strings);  // with a gap: FEBio does not notice numbers above the last one
  text = std::regex_replace(text, std::regex("<node id=\"22\">"), "<node id=\"40\">");
  text = std::regex_replace(text, std::regex("19,20,21,22"), "19,20,21,40");
  write(folder.path / "m.feb", text);
  EXPECT_EQ(run_program(folder.path, {DEA_PROGRAM, "run", "m.feb"}, 60).code, 3);
  const Finished task = febio(folder.path, "m.feb", "dea");
  EXPECT_EQ(task.code, 1);
  EXPECT_EQ(errors_of(task.out),
            std::vector<std::string>{
                "m.feb: discrete set \"strings\" uses a node that does not exist: mend the number, or add the node"});
}

TEST(Plugin, AMotionPrescribedTwiceIsNoted) {
  const TemporaryFolder folder;
  Extra extra;
  for (const char* value : {"0.1", "0.2"})
    extra.rigid += plate_motion("rigid_displacement", fmt::format("<dof>x</dof><value>{}</value>", value));
  extra.held = "Ry Ru Rv Rw";
  write(folder.path / "m.feb", pressed_model(extra));
  write(folder.path / "s.xml", "<febiodea_settings version=\"1\"><json>m.json</json></febiodea_settings>");
  const Finished task = febio(folder.path, "m.feb", "dea", "s.xml");
  EXPECT_EQ(task.code, 0) << task.out;
  const Json result = Json::parse(file_text(folder.path / "m.json"));
  const std::string note =
      "ignored: m.feb: prescribed x of \"plate\": it is prescribed again, and the last one counts, as in FEBio";
  EXPECT_NE(result["findings"].dump().find(Json(note).dump()), std::string::npos) << result["findings"];
  EXPECT_DOUBLE_EQ(result["states"].back()["bodies"]["plate"]["translation"][0].get<double>(), 0.2);
}

TEST(Plugin, NoMemoryFaults) {
  const std::string valgrind = DEA_VALGRIND;
  if (valgrind.find("NOTFOUND") != valgrind.npos) GTEST_SKIP() << "no valgrind";
  const TemporaryFolder folder;
  write(folder.path / "linear.feb", model_40(false));
  write(folder.path / "quadratic.feb", model_30(true));
  write(folder.path / "rich.feb", rich_model());
  write(folder.path / "connected.feb", connected_30());
  write(folder.path / "good.xml",
        "<febiodea_settings version=\"1\"><json>j.json</json><csv>c.csv</csv></febiodea_settings>");
  write(folder.path / "bad.xml", "<febiodea_settings version=\"1\"><law>cubic</law></febiodea_settings>");
  const std::pair<const char*, const char*> runs[] = {{"linear.feb", "good.xml"},
                                                      {"quadratic.feb", "good.xml"},
                                                      {"rich.feb", "good.xml"},
                                                      {"connected.feb", "good.xml"},
                                                      {"linear.feb", "bad.xml"}};
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

// As dea run: a result of FEBio's, another file, and states that would be lost stay.
TEST(Plugin, WhatIsThereAlreadyStays) {
  const TemporaryFolder folder;
  write(folder.path / "m.feb", model_40(false));
  const auto settings = [&](const std::string& elements) {
    write(folder.path / "s.xml", "<febiodea_settings version=\"1\">" + elements + "</febiodea_settings>");
  };
  const auto kept = [&](const std::string& name, const std::string& why) {
    const std::string before = file_text(folder.path / name);
    const Finished f = febio(folder.path, "m.feb", "dea", "s.xml");
    EXPECT_EQ(f.code, 1) << name;
    EXPECT_EQ(errors_of(f.out),
              std::vector<std::string>{
                  fmt::format("dea: cannot write {}: it is there already, {}; name another with <output>, or take "
                              "it away",
                              name, why)});
    EXPECT_TRUE(file_text(folder.path / name) == before) << name;
  };
  write(folder.path / "notes.txt", "notes\n");
  settings("<output>notes.txt</output>");
  kept("notes.txt", "and is no whole plot file");
  settings("");
  ASSERT_EQ(febio(folder.path, "m.feb", "dea", "s.xml").code, 0);
  ASSERT_EQ(febio(folder.path, "m.feb", "dea", "s.xml").code, 0);  // the same again
  settings("<states>last</states>");
  kept("m_dea.xplt", "results of this model with 4 states that would be lost (times 0 to 0.75)");
}

TEST(Plugin, NoPlotFileWhereNoneIsWanted) {
  const TemporaryFolder folder;
  write(folder.path / "m.feb", model_40(false));
  write(folder.path / "s.xml",
        "<febiodea_settings version=\"1\"><no-xplt>true</no-xplt><json>r.json</json><report>r.html</report>"
        "</febiodea_settings>");
  const Finished f = febio(folder.path, "m.feb", "dea", "s.xml");
  EXPECT_EQ(f.code, 0) << f.out;
  EXPECT_NE(f.out.find("\n5 states in "), f.out.npos) << f.out;
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder.path)) names.insert(entry.path().filename().string());
  EXPECT_EQ(names, (std::set<std::string>{"m.feb", "s.xml", "s.log", "r.json", "r.html"}));
}

/// FEBio's own handler of Ctrl-C only makes a note. The largest sample with sixteen times the springs takes many
/// seconds.
TEST(Plugin, CtrlCEndsTheTask) {
  for (const char* signal : {"INT", "TERM"}) {
    const TemporaryFolder folder;
    fs::copy(fs::path(DEA_SAMPLES_DIR) / "hip" / "hip_walking.feb", folder.path / "m.feb");
    write(folder.path / "s.xml",
          "<febiodea_settings version=\"1\"><refine>4</refine><json>r.json</json><vtu>paraview</vtu>"
          "</febiodea_settings>");
    const std::string script = fmt::format(
        "'{}' -nosplash -i m.feb -import '{}' -task=dea s.xml >out & febio=$!; until grep -q 'state 2 of' out; do kill "
        "-0 $febio || exit 98; sleep 0.05; done; kill -{} $febio; wait $febio",
        DEA_FEBIO4, DEA_PLUGIN, signal);
    EXPECT_EQ(run_program(folder.path, {"/bin/sh", "-c", script}, 300).code, 1);
    const std::string out = file_text(folder.path / "out");
    EXPECT_EQ(errors_of(out), std::vector<std::string>{"dea: stopped, nothing was written"}) << out;
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder.path)) names.insert(entry.path().filename().string());
    EXPECT_EQ(names, (std::set<std::string>{"m.feb", "s.xml", "s.log", "out"}));
  }
}

/// At once: the first one is not waited for. What was begun is taken away. febio4 stands still in between, so that it
/// cannot have ended before the second one comes.
TEST(Plugin, ASecondCtrlCEndsFebio) {
  const TemporaryFolder folder;
  fs::copy(fs::path(DEA_SAMPLES_DIR) / "hip" / "hip_walking.feb", folder.path / "m.feb");
  write(folder.path / "s.xml",
        "<febiodea_settings version=\"1\"><refine>4</refine><json>r.json</json></febiodea_settings>");
  const std::string script = fmt::format(
      "'{}' -nosplash -i m.feb -import '{}' -task=dea s.xml >out & febio=$!; until grep -q 'state 2 of' out; do kill "
      "-0 $febio || exit 98; sleep 0.05; done; ls -A >begun; kill -INT $febio; kill -STOP $febio; until grep -q "
      "'^State:.T' /proc/$febio/status; do sleep 0.01; done; kill -INT $febio; kill -CONT $febio; wait $febio",
      DEA_FEBIO4, DEA_PLUGIN);
  const Finished f = run_program(folder.path, {"/bin/sh", "-c", script}, 300);
  EXPECT_EQ(f.code, 130) << f.out << f.err;
  EXPECT_NE(f.err.find("\ndea: stopped\n"), std::string::npos) << f.err;
  EXPECT_EQ(errors_of(file_text(folder.path / "out")), std::vector<std::string>{});
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder.path)) names.insert(entry.path().filename().string());
  EXPECT_EQ(names, (std::set<std::string>{"m.feb", "s.xml", "s.log", "out", "begun"}));
  EXPECT_NE(file_text(folder.path / "begun").find("m_dea"), std::string::npos) << file_text(folder.path / "begun");
}

TEST(Plugin, PlotFileLogAndTable) {
  const TemporaryFolder folder;
  write(folder.path / "m.feb", model_40(false));
  write(folder.path / "s.xml", "<febiodea_settings version=\"1\"><law>linear</law></febiodea_settings>");
  const Finished f = febio(folder.path, "m.feb", "dea", "s.xml", {"-p", "given.xplt", "-o", "given.log"});
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
  EXPECT_EQ(names, (std::set<std::string>{"m.feb", "s.xml", "given.xplt", "given.log"}));
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
  for (const auto& [name, text] : connected_models()) write(folder.path / (name + ".feb"), text);
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

/// A constraint acts in the steps that name it again, a section Discrete in all.
TEST(ReadFeModel, StepsAreThoseOfFebio) {
  const TemporaryFolder folder;
  std::string text = model_25(false);
  const std::string control = "<Control><time_steps>2</time_steps><step_size>0.5</step_size></Control>";
  const std::string own =
      R"(<constraint name="s" type="rigid spring"><body_a>2</body_a><body_b>3</body_b><k>2</k></constraint>)";
  const auto step = [&](const std::string& inside) {
    return "<Step>" + control + "<Constraints>" + inside + "</Constraints></Step>\n";
  };
  const std::string again = R"(<constraint name="s"/>)", damper = R"(<constraint type="rigid damper"/>)";
  text.insert(text.find("</febio_spec>"), step(own) + step(damper) + step(again));
  text.insert(
      text.find("</febio_spec>"),
      "<Discrete><rigid_axial_force><rbA>2</rbA><rbB>3</rbB><force lc=\"1\">1</force></rigid_axial_force></Discrete>");
  write(folder.path / "m.feb", text);
  std::vector<std::string> found, pulls;
  for (const std::string& line : lines_of(febio_dump(folder.path, "m.feb", "dea_dump"))) {
    if (line.rfind("rigid_spring", 0) == 0) found.push_back(line);
    if (line.rfind("rigid_axial_force", 0) == 0) pulls.push_back(line);
  }
  EXPECT_EQ(pulls, std::vector<std::string>{"rigid_axial_force  1 2 (0,0,0) (0,0,0) false 1*f0 step -1"});
  const std::string spring = "rigid_spring s 1 2 (0,0,0) (0,0,0) 2 0 step ";
  EXPECT_EQ(found, (std::vector<std::string>{spring + "0", spring + "2"}));
  EXPECT_EQ(
      difference_of(dump(read_feb((folder.path / "m.feb").string())), febio_dump(folder.path, "m.feb", "dea_dump")),
      "");
  // outside of steps it acts in all, unless a step names it
  text = model_25(false);
  text.insert(text.find("</febio_spec>"),
              "<Constraints>" + own + "</Constraints>" + step("") + step(again) + step("") + step(again));
  write(folder.path / "m.feb", text);
  const std::string from_file = dump(read_feb((folder.path / "m.feb").string()));
  EXPECT_NE(from_file.find(spring + "1\n"), std::string::npos) << from_file;
  EXPECT_NE(from_file.find(spring + "3\n"), std::string::npos) << from_file;
  EXPECT_EQ(difference_of(from_file, febio_dump(folder.path, "m.feb", "dea_dump")), "");
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
    std::string from_model = febio_dump(folder.path, model.string(), "dea_dump");
    if (from_model.rfind("cannot read", 0) == 0) {
      ++refused;
      continue;
    }
    ++compared;
    if (model.parent_path().filename() == "v2.0") {  // FEBio forgets the names of these contacts
      const std::regex name("(^|\n)contact (contact \\d+|\\S*) ");
      from_file = std::regex_replace(from_file, name, "$1contact  ");
      from_model = std::regex_replace(from_model, name, "$1contact  ");
    }
    EXPECT_EQ(difference_of(from_file, from_model), "") << model;
  }
  if (compared == 0) GTEST_SKIP() << "no models in " << DEA_CORPUS_DIR;
  std::cout << compared << " models compared, " << refused << " refused by one reader\n";
}

}  // namespace
}  // namespace dea::test

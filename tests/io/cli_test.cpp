// The program from outside: what it prints, writes and returns.
//
// Model of most tests, with its answer on paper: a square layer of cartilage, 3 x 3, thickness h = 2, bonded to a rigid
// base, and a rigid plate that covers it, 0.1 above. Moved down by 0.3 the plate overlaps the layer by d = 0.2
// everywhere, so that p = M d / h with the confined modulus M, on the area 9.
#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "io/files/encoded_text.h"
#include "io/xplt/xplt.h"
#include "tests/program.h"

namespace dea::cli_test {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using test::file_text;
using test::Finished;

constexpr double kE = 10.0, kNu = 0.3;
constexpr double kM = kE * (1 - kNu) / ((1 + kNu) * (1 - 2 * kNu));

/// A folder of its own for every test, in which the program runs.
class Cli : public ::testing::Test {
 protected:
  static pid_t start(const fs::path& in, std::vector<std::string> words, const fs::path& out, const fs::path& err,
                     std::string program = DEA_PROGRAM) {
    const pid_t child = ::fork();
    if (child != 0) return child;
    std::vector<char*> argv;
    argv.push_back(program.data());
    for (std::string& w : words) argv.push_back(w.data());
    argv.push_back(nullptr);
    const int o = ::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600),
              e = ::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (::chdir(in.c_str()) != 0 || o < 0 || e < 0) ::_exit(99);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::signal(signal, SIG_DFL);  // whatever starts the tests ignores
    ::dup2(o, 1);
    ::dup2(e, 2);
    ::execv(program.c_str(), argv.data());
    ::_exit(99);
  }

  Finished dea(const std::vector<std::string>& arguments, const std::string& out_path = "") {
    const fs::path out = out_path.empty() ? folder.string() + ".out" : out_path, err = folder.string() + ".err";
    return end_of(start(folder, arguments, out, err), out_path.empty() ? out : "", err);
  }

  /// Waits for the end of a program and takes its streams away. `out`: "" leaves that one.
  static Finished end_of(pid_t child, const fs::path& out, const fs::path& err) {
    int status = 0;
    ::waitpid(child, &status, 0);
    Finished f;
    f.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    if (!out.empty()) {
      f.out = file_text(out);
      fs::remove(out);
    }
    f.err = file_text(err);
    fs::remove(err);
    return f;
  }

  /// Sends a signal to the program as soon as it says `word` on standard error. `seconds`: from then to its end, of
  /// processor time, since others may keep the machine busy (so it is to have one thread), or a tenth of the clock's.
  Finished interrupted(const std::vector<std::string>& arguments, const std::string& word, int signal,
                       double& seconds) {
    const fs::path out = folder.string() + ".out", err = folder.string() + ".err";
    const auto now = [] { return std::chrono::steady_clock::now(); };
    const double before = test::processor_seconds_of_ended();
    const pid_t child = start(folder, arguments, out, err);
    const auto started = now();
    while (file_text(err).find(word) == std::string::npos && now() - started < std::chrono::minutes(5))
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const double worked = test::processor_seconds(child);
    ::kill(child, signal);
    const auto asked = now();
    const Finished f = end_of(child, out, err);
    seconds = std::max(test::processor_seconds_of_ended() - before - worked,
                       std::chrono::duration<double>(now() - asked).count() / 10);
    return f;
  }

  void write(const std::string& name, const std::string& text) {
    std::ofstream(folder / name, std::ios::binary) << text;
  }

  /// `push`: force on the plate that is free along z; NaN: its displacement is prescribed instead.
  void write_model(const std::string& name = "flat.feb", double push = std::nan("")) {
    std::string nodes, layer, base, plate, primary, secondary;
    const auto id = [](int i, int j, int k) { return 1 + i + 4 * j + 16 * k; };
    for (int k = 0; k < 2; ++k)
      for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i)
          nodes += fmt::format("<node id=\"{}\">{},{},{}</node>\n", id(i, j, k), i, j, 2 * k - 2);
    for (int c = 0; c < 4; ++c)
      nodes += fmt::format("<node id=\"{}\">{},{},0.1</node>\n", 33 + c, c == 1 || c == 2 ? 4 : -1, c >= 2 ? 4 : -1);
    int element = 0;
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) {
        const auto quad = [&](int k) {
          return fmt::format("{},{},{},{}", id(i, j, k), id(i + 1, j, k), id(i + 1, j + 1, k), id(i, j + 1, k));
        };
        ++element;
        layer += fmt::format("<elem id=\"{}\">{},{}</elem>\n", element, quad(0), quad(1));
        base += fmt::format("<elem id=\"{}\">{}</elem>\n", element + 9, quad(0));
        primary += fmt::format("<quad4 id=\"{}\">{}</quad4>\n", element, quad(1));
      }
    }
    const bool prescribed = std::isnan(push);
    const std::string motion =
        prescribed ? "<rigid_bc name=\"down\" type=\"rigid_displacement\"><rb>plate</rb><dof>z</dof><value "
                     "lc=\"1\">-0.3</value><relative>0</relative></rigid_bc>"
                   : "";
    const std::string load =
        prescribed ? ""
                   : fmt::format(
                         "<rigid_load name=\"push\" type=\"rigid_force\"><rb>plate</rb><dof>Rz</dof><value "
                         "lc=\"1\">{}</value><load_type>LOAD</load_type></rigid_load>",
                         push);
    write(name, fmt::format(R"(<?xml version="1.0" encoding="ISO-8859-1"?>
<febio_spec version="4.0">
<Module type="solid"><units>mm-N-s</units></Module>
<Material>
<material id="1" name="cartilage" type="neo-Hookean"><density>1</density><E>{}</E><v>{}</v></material>
<material id="2" name="base" type="rigid body"><density>1</density><center_of_mass>1.5,1.5,-2</center_of_mass></material>
<material id="3" name="plate" type="rigid body"><density>1</density><center_of_mass>1.5,1.5,1</center_of_mass></material>
</Material>
<Mesh>
<Nodes name="all">
{}</Nodes>
<Elements type="hex8" name="layer">
{}</Elements>
<Elements type="quad4" name="base">
{}</Elements>
<Elements type="quad4" name="plate">
<elem id="19">33,34,35,36</elem>
</Elements>
<Surface name="top">
{}</Surface>
<Surface name="under">
<quad4 id="1">33,36,35,34</quad4>
</Surface>
<SurfacePair name="pair"><primary>top</primary><secondary>under</secondary></SurfacePair>
</Mesh>
<MeshDomains>
<SolidDomain name="layer" mat="cartilage"/>
<ShellDomain name="base" mat="base"/>
<ShellDomain name="plate" mat="plate"/>
</MeshDomains>
<Rigid>
<rigid_bc name="hold base" type="rigid_fixed"><rb>base</rb><Rx_dof>1</Rx_dof><Ry_dof>1</Ry_dof><Rz_dof>1</Rz_dof><Ru_dof>1</Ru_dof><Rv_dof>1</Rv_dof><Rw_dof>1</Rw_dof></rigid_bc>
<rigid_bc name="hold plate" type="rigid_fixed"><rb>plate</rb><Rx_dof>1</Rx_dof><Ry_dof>1</Ry_dof><Rz_dof>0</Rz_dof><Ru_dof>1</Ru_dof><Rv_dof>1</Rv_dof><Rw_dof>1</Rw_dof></rigid_bc>
{}
{}
</Rigid>
<Contact><contact name="touch" type="sliding-elastic" surface_pair="pair"/></Contact>
<Step><step id="1" name="press"><Control><analysis>STATIC</analysis><time_steps>4</time_steps><step_size>0.25</step_size></Control></step></Step>
<LoadData><load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate><points><pt>0,0</pt><pt>1,1</pt></points></load_controller></LoadData>
</febio_spec>
)",
                            kE, kNu, nodes, layer, base, primary, motion, load));
  }

  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  }

  const test::TemporaryFolder temporary;
  const fs::path folder = temporary.path;
};

using Names = std::vector<std::string>;

Names keys(const Json& j) {
  Names names;
  for (const auto& item : j.items()) names.push_back(item.key());
  return names;
}

/// The first keys are fixed; more may follow.
void expect_keys(const Json& j, const Names& expected) {
  Names found = keys(j);
  ASSERT_GE(found.size(), expected.size());
  found.resize(expected.size());
  EXPECT_EQ(found, expected);
}

TEST_F(Cli, PlatePressedOnALayerGivesTheAnswerOnPaper) {
  write_model();
  const Finished f = dea({"run", "flat.feb", "--json", "r.json", "--law", "linear"});
  ASSERT_EQ(f.code, 0) << f.err;
  EXPECT_EQ(files(), (Names{"flat.feb", "flat_dea.xplt", "r.json"}));
  const Json j = Json::parse(file_text(folder / "r.json"));
  ASSERT_EQ(j["states"].size(), 5u);
  const Json last = j["states"][4], contact = last["contacts"][0];
  const double p = kM * 0.2 / 2.0;
  EXPECT_NEAR(contact["peak_pressure"].get<double>(), p, 1e-12);  // plane surfaces: exact but for rounding
  EXPECT_NEAR(contact["mean_pressure"].get<double>(), p, 1e-12);
  EXPECT_NEAR(contact["nodal_peak_pressure"].get<double>(), p, 1e-12);
  EXPECT_NEAR(contact["contact_area"].get<double>(), 9.0, 1e-12);
  EXPECT_NEAR(contact["force"][2].get<double>(), 9.0 * p, 1e-11);
  EXPECT_EQ(last["outcome"], "Prescribed");
  EXPECT_NEAR(last["bodies"]["plate"]["translation"][2].get<double>(), -0.3, 1e-15);
  EXPECT_NEAR(last["bodies"]["plate"]["force"][2].get<double>(), -9.0 * p, 1e-11);  // what holds the plate is pushed
  EXPECT_TRUE(j["states"][0]["contacts"][0]["peak_pressure"].is_null());            // nothing touches

  const XpltFile plot = read_xplt((folder / "flat_dea.xplt").string());
  EXPECT_EQ(plot.units, "mm-N-s");
  ASSERT_EQ(plot.states.size(), 5u);
  EXPECT_EQ(plot.meshes[0].parts, (Names{"cartilage", "base", "plate"}));
  ASSERT_EQ(plot.meshes[0].domains.size(), 3u);
  ASSERT_EQ(plot.meshes[0].surfaces.size(), 2u);
  EXPECT_EQ(plot.meshes[0].surfaces[0].name, "top");
  ASSERT_EQ(plot.meshes[0].objects.size(), 2u);
  EXPECT_EQ(plot.meshes[0].objects[1].name, "plate");
  const XpltState& state = plot.states.back();
  EXPECT_EQ(state.element_flags, std::vector<std::uint32_t>(19, 1));
  const auto values = [&](XpltGroup group, const char* name) {
    return state.variables[static_cast<std::size_t>(find_variable(plot, group, name))];
  };
  const auto displacement = values(XpltGroup::Nodal, "displacement")[0].values;
  EXPECT_NEAR(displacement[3 * 35 + 2], -0.3, 1e-6);  // the plate
  EXPECT_NEAR(displacement[3 * 31 + 2], -0.2, 1e-6);  // the layer's top, compressed
  EXPECT_NEAR(displacement[3 * 5 + 2], 0.0, 1e-6);    // its bottom
  const auto pressure = values(XpltGroup::Surface, "contact pressure");
  ASSERT_EQ(pressure.size(), 2u);
  EXPECT_EQ(pressure[0].region, 1);
  ASSERT_EQ(pressure[0].values.size(), 9u);
  for (float x : pressure[0].values) EXPECT_NEAR(x, p, 1e-6);
  const auto thickness = values(XpltGroup::Surface, "cartilage thickness");
  for (float x : thickness[0].values) EXPECT_NEAR(x, 2.0, 1e-6);
  EXPECT_EQ(thickness[1].values, std::vector<float>(4, 0.0f));
  const auto position = values(XpltGroup::Domain, "rigid position");
  ASSERT_EQ(position.size(), 2u);
  EXPECT_EQ(position[1].region, 3);
  EXPECT_NEAR(position[1].values[2], 0.7, 1e-6);
  EXPECT_NEAR(state.objects[1].data[6][2], -9.0 * p, 1e-5);
}

TEST_F(Cli, SettingsFileNamesOutputsAndTheCommandLineComesFirst) {
  write_model();
  write("s.xml",
        "<febiodea_settings version=\"1\"><output>o.xplt</output><json>o.json</json><csv>o.csv</csv>"
        "<states>last</states></febiodea_settings>");
  ASSERT_EQ(dea({"run", "flat.feb", "-q", "--settings", "s.xml", "--csv", "typed.csv"}).code, 0);
  EXPECT_EQ(Json::parse(file_text(folder / "o.json"))["states"].size(), 1u);
  for (const char* name : {"o.xplt", "typed.csv"}) EXPECT_TRUE(fs::exists(folder / name)) << name;
  for (const char* name : {"flat_dea.xplt", "o.csv"}) EXPECT_FALSE(fs::exists(folder / name)) << name;
  ASSERT_EQ(dea({"run", "flat.feb", "-q", "--settings", "s.xml", "--states", "all"}).code, 0);
  EXPECT_EQ(Json::parse(file_text(folder / "o.json"))["states"].size(), 5u);
  write("t.xml", "<febiodea_settings version=\"1\"><states>9</states></febiodea_settings>");
  EXPECT_EQ(dea({"run", "flat.feb", "--settings", "t.xml"}).err,
            "dea: t.xml:1: <states>: found time 9, expected times from 0 to 1, those of the model\n");
  write("u.xml", "<febiodea_settings version=\"1\"><json>flat.feb</json></febiodea_settings>");
  EXPECT_EQ(dea({"run", "flat.feb", "--settings", "u.xml"}).err, "dea: <json> flat.feb: would overwrite the model\n");
  EXPECT_EQ(dea({"info", "flat.feb", "--settings", "s.xml"}).code, 0);
}

TEST_F(Cli, ForceControlBalancesAndApartIsAnAnswer) {
  write_model("push.feb", -12.0);
  const Finished f = dea({"run", "push.feb", "--law", "linear", "--states", "last", "--json", "-"});
  ASSERT_EQ(f.code, 0) << f.err;
  const Json last = Json::parse(f.out)["states"][0];
  EXPECT_EQ(last["outcome"], "Balanced");
  EXPECT_NEAR(last["contacts"][0]["mean_pressure"].get<double>(), 12.0 / 9.0, 1e-8);

  write_model("pull.feb", 12.0);
  const Finished apart = dea({"run", "pull.feb", "--json", "pull.json"});
  EXPECT_EQ(apart.code, 1) << apart.err;
  EXPECT_EQ(Json::parse(file_text(folder / "pull.json"))["states"].back()["outcome"], "SurfacesApart");
  EXPECT_NE(apart.err.find("warning: times 0.25 to 1 (4 states): SurfacesApart; at time 1: "), std::string::npos)
      << apart.err;
  EXPECT_TRUE(fs::exists(folder / "pull_dea.xplt"));
}

TEST_F(Cli, JsonHasTheAgreedKeysInTheAgreedOrder) {
  write_model();
  const Finished f = dea({"run", "flat.feb", "--json", "-"});
  ASSERT_EQ(f.code, 0);
  EXPECT_EQ(f.out.find("{\n \"schema\": \"dea.run/1\""), 0u);
  const Json j = Json::parse(f.out);  // nothing else on standard output
  expect_keys(j, {"schema", "model", "version", "settings", "timings", "bodies", "states"});
  expect_keys(j["timings"], {"read", "joint", "solve", "write", "total"});
  EXPECT_EQ(j["bodies"], Json::array({"base", "plate"}));
  const Json& s = j["states"][4];
  expect_keys(s, {"time", "outcome", "iterations", "residual_force", "residual_moment", "bodies", "contacts"});
  EXPECT_TRUE(s["residual_force"].is_null());  // nothing is free
  EXPECT_EQ(keys(s["bodies"]), (Names{"base", "plate"}));
  expect_keys(s["bodies"]["plate"], {"translation", "rotation", "force", "moment"});
  expect_keys(s["contacts"][0], {"name",
                                 "source",
                                 "target",
                                 "springs",
                                 "springs_hit",
                                 "springs_active",
                                 "peak_pressure",
                                 "p99_pressure",
                                 "mean_pressure",
                                 "median_pressure",
                                 "p5_pressure",
                                 "p25_pressure",
                                 "p75_pressure",
                                 "p95_pressure",
                                 "contact_area",
                                 "facet_peak_pressure",
                                 "nodal_peak_pressure",
                                 "nodal_mean_pressure",
                                 "nodal_median_pressure",
                                 "facet_contact_area",
                                 "center_of_pressure",
                                 "force",
                                 "moment",
                                 "largest_strain"});
  EXPECT_EQ(s["contacts"][0]["source"], "base");
  EXPECT_EQ(s["contacts"][0]["target"], "plate");
  EXPECT_TRUE(j["settings"]["law"].is_null());  // nothing was said; what holds is the contact's
  EXPECT_EQ(s["contacts"][0]["law"], "layer");
}

TEST_F(Cli, CsvHasALinePerStateAndContact) {
  write_model();
  const Finished f = dea({"run", "flat.feb", "--csv", "-", "-q"});
  ASSERT_EQ(f.code, 0);
  EXPECT_EQ(f.err, "");
  std::istringstream lines(f.out);
  std::string line, header;
  std::getline(lines, header);
  EXPECT_EQ(header.rfind("time,contact,outcome,", 0), 0u);
  int count = 0;
  while (std::getline(lines, line)) {
    ++count;
    const std::size_t quote = line.find('"'),
                      end = line.rfind('"');  // what is to be known of all: in the first line alone
    EXPECT_EQ(quote != line.npos && quote < end, count == 1) << line;
    if (quote != line.npos) line.erase(quote, end - quote);
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), std::count(header.begin(), header.end(), ',')) << line;
  }
  EXPECT_EQ(count, 5);
}

TEST_F(Cli, QuietPrintsNothing) {
  write_model();
  const Finished f = dea({"run", "flat.feb", "-q"});
  EXPECT_EQ(f.code, 0);
  EXPECT_EQ(f.out, "");
  EXPECT_EQ(f.err, "");
  const Finished loud = dea({"run", "flat.feb", "-v"});
  EXPECT_NE(loud.err.find("state 5 of 5, time 1: Prescribed"), std::string::npos) << loud.err;
  EXPECT_NE(loud.out.find("mm-N-s"), std::string::npos);
}

TEST_F(Cli, QuietNamesTheStatesThatAreNoSolution) {
  write_model("pull.feb", 12.0);  // apart as soon as it is pulled: states 2 to 5 of 5
  const Finished f = dea({"run", "pull.feb", "-q"});
  EXPECT_EQ(f.code, 1);
  EXPECT_EQ(f.out, "");
  std::istringstream lines(f.err);
  Names found;
  for (std::string line; std::getline(lines, line);) found.push_back(line);
  ASSERT_EQ(found.size(), 2u) << f.err;
  const std::string start = "warning: times 0.25 to 1 (4 states): SurfacesApart; at time 1: ";
  EXPECT_EQ(found[0].substr(0, start.size()), start);
  EXPECT_GT(found[0].size(), start.size() + 10);  // and why
  EXPECT_EQ(found[1], "warning: no solution in 4 of 5 states");
  EXPECT_EQ(dea({"run", "pull.feb", "-q", "--states", "0", "--overwrite"}).err,
            "");  // the reference state is none that failed
}

// Forces that somebody asks for and nothing follows: told with -q too. The plate is free along z alone.
TEST_F(Cli, QuietNamesForcesWithoutEffect) {
  write_model("push.feb", -12.0);
  const auto quiet = [&](const std::string& force) {
    const Finished f = dea({"run", "push.feb", "-q", "--no-xplt", "--force", force});
    EXPECT_EQ(f.code, 0) << f.err;
    return f.err;
  };
  EXPECT_EQ(quiet("plate=0,0,-9"), "");
  EXPECT_EQ(quiet("base=0,0,0"), "");
  EXPECT_EQ(
      quiet("base=0,0,-9"),
      "warning: --force base: body \"base\" is not free to move along z at the end of the last step; this load has "
      "no effect [idle-load]\n");
  EXPECT_EQ(quiet("plate=1,0,-9"),
            "warning: --force plate: body \"plate\" is not free to move along x at the end of the last step; this part "
            "of the force has no effect [idle-load]\n");
  write_model();  // the plate's motion is prescribed
  const Finished f =
      dea({"run", "flat.feb", "--no-xplt", "--force", "plate=1,0,-9", "--json", "r.json", "--csv", "r.csv"});
  const std::string line =
      "--force plate: body \"plate\" is not free to move along x, z at the end of the last step; this load has no "
      "effect";
  EXPECT_NE(f.err.find("warning: " + line), std::string::npos) << f.err;
  const Json findings = Json::parse(file_text(folder / "r.json"))["findings"];
  EXPECT_EQ(std::count(findings.begin(), findings.end(), Json("warning: " + line)), 1) << findings;
  EXPECT_NE(file_text(folder / "r.csv").find("this load has no effect"), std::string::npos);
}

// A force beside the centre of mass turns a body that cannot follow it.
TEST_F(Cli, ForcesThatTurnABodyHaveAnEffect) {
  write_model("push.feb", -12.0);
  const auto quiet = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"run",           "push.feb", "-q",           "--no-xplt", "--free",
                                      "plate=z,Ru,Rv", "--force",  "plate=1,0,-9", "--load-at"};
    words.insert(words.end(), more.begin(), more.end());
    return dea(words).err;
  };
  EXPECT_NE(quiet({"plate=1.5,1.5,1"}).find("along x at the end"), std::string::npos);
  EXPECT_EQ(quiet({"plate=1.5,1.5,1.001"}).find("along x at the end"), std::string::npos);
}

TEST_F(Cli, ATableOfCompartmentsWithoutRowsIsExplained) {
  write_model();
  const Finished f = dea({"run", "flat.feb", "--no-xplt", "--compartments-csv", "parts.csv"});
  ASSERT_EQ(f.code, 0) << f.err;
  const std::string csv = file_text(folder / "parts.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1) << csv;
  EXPECT_NE(f.err.find("note: parts.csv has the names of its columns and no rows: every surface is in one piece\n"),
            std::string::npos)
      << f.err;
}

TEST_F(Cli, CiteHasFourDigitsUnitsAndFebiosPaper) {
  write_model();
  const Finished f = dea({"cite", "flat.feb", "--thickness", "top=1.581793", "--E", "8.123456"});
  ASSERT_EQ(f.code, 0) << f.err;
  for (const char* text : {"of the FEBio model flat.feb (Maas et al., 2012; format 4.0,", "was 1.582 mm thick",
                           "E = 8.123 MPa", "* Maas SA, Ellis BJ"})
    EXPECT_NE(f.out.find(text), std::string::npos) << text << "\n" << f.out;
  EXPECT_EQ(f.out.find("1.58179 "), std::string::npos) << f.out;
}

TEST_F(Cli, TimesArePrintedAsTheyWereMeant) {
  write_model();
  std::string text = file_text(folder / "flat.feb");
  const auto replace = [&](const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
  };
  replace("<time_steps>4</time_steps><step_size>0.25</step_size>",
          "<time_steps>10</time_steps><step_size>0.1</step_size>");
  write("ten.feb", text);
  const Finished f = dea({"run", "ten.feb", "-v", "--states", "0.7,0.123456789,last"});
  ASSERT_EQ(f.code, 0) << f.err;
  for (const char* what : {", time 0.7: ", ", time 0.123456789: ", ", time 1: "})
    EXPECT_NE(f.err.find(what), std::string::npos) << f.err;
  EXPECT_NE(f.out.find("\n0.123456789  touch"), std::string::npos) << f.out;
  EXPECT_NE(f.out.find("\n        0.7  touch"), std::string::npos) << f.out;
  const Finished c = dea({"compare", "ten_dea.xplt", "ten_dea.xplt", "--at", "0.7"});  // in single precision there
  EXPECT_NE(c.out.find("ten_dea.xplt, time 0.7\n"), std::string::npos) << c.out;
}

TEST_F(Cli, PlotFilesOfOtherEndingsAreWrittenWithANote) {
  write_model();
  const auto notes = [&](const std::string& name, std::vector<std::string> more = {}) {
    std::vector<std::string> words = {"run", "flat.feb", "-o", name};
    words.insert(words.end(), more.begin(), more.end());
    const Finished f = dea(words);
    EXPECT_EQ(f.code, 0) << f.err;
    EXPECT_TRUE(fs::exists(folder / name)) << name;
    std::string found;
    std::istringstream lines(f.err);
    for (std::string line; std::getline(lines, line);)
      if (line.find("PostView") != std::string::npos) found += line + "\n";
    return found;
  };
  EXPECT_EQ(
      notes("walking"),
      "note: -o walking: PostView and FEBio Studio know plot files by the ending .xplt; written as it was asked\n");
  EXPECT_NE(notes("a.dat"), "");
  EXPECT_EQ(notes("a.dat", {"-q"}), "");
  EXPECT_EQ(notes("a.xplt"), "");
  EXPECT_EQ(notes("B.XPLT"), "");
  std::ofstream(folder / "keep.feb") << "a model";  // no plot file goes over a model
  const Finished over = dea({"run", "flat.feb", "-o", "keep.feb", "-q"});
  EXPECT_EQ(over.code, 2);
  EXPECT_NE(over.err.find("-o keep.feb: found the ending of a model file"), std::string::npos) << over.err;
  EXPECT_EQ(file_text(folder / "keep.feb"), "a model");
  EXPECT_EQ(dea({"run", "flat.feb", "-o", "/dev/null"}).err.find("PostView"), std::string::npos);
}

TEST_F(Cli, CommandLineBeforeSettingsFileBeforeModel) {
  write_model();
  write("s.xml", "<febiodea_settings version=\"1\">\n<E>20</E>\n<law>logarithmic</law>\n</febiodea_settings>\n");
  const auto peak = [&](std::vector<std::string> more) {
    std::vector<std::string> words = {"run", "flat.feb", "--states", "last", "--json", "-"};
    words.insert(words.end(), more.begin(), more.end());
    const Finished f = dea(words);
    EXPECT_EQ(f.code, 0) << f.err;
    return Json::parse(f.out)["states"][0]["contacts"][0]["peak_pressure"].get<double>();
  };
  const double e = 0.1;
  EXPECT_NEAR(peak({"--law", "linear"}), kM * e, 1e-12);
  EXPECT_GT(std::abs(peak({}) - kM * e), 0.01 * kM * e);  // law layer
  EXPECT_NEAR(peak({"--settings", "s.xml"}), -2 * kM * std::log(1 - e), 1e-11);
  EXPECT_NEAR(peak({"--settings", "s.xml", "--law", "LINEAR"}), 2 * kM * e, 1e-11);
  EXPECT_NEAR(peak({"--settings", "s.xml", "--law", "linear", "--E", "top=30"}), 3 * kM * e, 1e-11);
  EXPECT_NEAR(peak({"--law", "linear", "--thickness", "top=4"}), kM * e / 2, 1e-12);
}

TEST_F(Cli, VectorsMayBeginWithAMinus) {
  write_model("push.feb", -12.0);
  const Finished f =
      dea({"run", "push.feb", "--force", "plate=-1,2,-3", "--states", "last", "--nu", "-0.1", "--json", "-"});
  ASSERT_EQ(f.code, 0) << f.err;
  const Json j = Json::parse(f.out);
  EXPECT_EQ(j["settings"]["force"]["plate"], Json::array({-1.0, 2.0, -3.0}));
  EXPECT_EQ(j["settings"]["nu"][""], -0.1);
  EXPECT_NEAR(j["states"][0]["contacts"][0]["force"][2].get<double>(), 3.0, 1e-8);
  EXPECT_EQ(dea({"run", "push.feb", "--force", "-1,2,3"}).err,
            "dea: --force -1,2,3: found no '=', expected BODY=x,y,z\n");
}

TEST_F(Cli, StatesAndTimesFrom) {
  write_model();
  const auto times = [&](std::vector<std::string> more) {
    std::vector<std::string> words = {"run", "flat.feb", "--overwrite", "--json", "-"};
    words.insert(words.end(), more.begin(), more.end());
    const Finished f = dea(words);
    EXPECT_EQ(f.code, 0) << f.err;
    std::vector<double> t;
    const Json j = Json::parse(f.out);
    for (const Json& s : j["states"]) t.push_back(s["time"].get<double>());
    return t;
  };
  using Times = std::vector<double>;
  EXPECT_EQ(times({}), (Times{0, 0.25, 0.5, 0.75, 1}));
  EXPECT_EQ(times({"--states", "last"}), (Times{1}));
  EXPECT_EQ(times({"--states", "0.75,0.1"}), (Times{0.1, 0.75}));
  EXPECT_EQ(times({"--states", "0.1,0.75", "-o", "fea.xplt"}), (Times{0.1, 0.75}));
  const Times from = times({"--times-from", "fea.xplt"});
  ASSERT_EQ(from.size(), 2u);
  EXPECT_NEAR(from[0], 0.1, 1e-8);  // single precision in the file
  EXPECT_EQ(from[1], 0.75);         // a time of the model: exactly
  EXPECT_EQ(times({"--times-from", "fea.xplt", "--states", "last"}), (Times{0.75}));
  EXPECT_EQ(dea({"run", "flat.feb", "--states", "2"}).err,
            "dea: --states 2: found time 2, expected times from 0 to 1, those of the model\n");
  EXPECT_EQ(dea({"run", "flat.feb", "--states", "some"}).err,
            "dea: --states some: found \"some\", expected all, last, times t1,t2,... or ranges t1:t2\n");
  EXPECT_EQ(dea({"run", "flat.feb", "--states", "-1"}).code, 2);
  // A result of later times than the model's, and one that was cut off before its first state was complete.
  std::ofstream(folder / "late.csv") << "time,fx,fy,fz\n0,0,0,0\n5,0,0,0\n";
  ASSERT_NE(dea({"run", "flat.feb", "--loads", "late.csv", "--load-body", "plate", "-o", "late.xplt"}).code, 3);
  const Finished late = dea({"run", "flat.feb", "--times-from", "late.xplt"});
  EXPECT_EQ(late.code, 3);
  EXPECT_EQ(late.err, "late.xplt: found a state at time 5, expected times from 0 to 1, those of the model\n");
  ASSERT_EQ(dea({"run", "flat.feb", "--states", "last", "-o", "one.xplt"}).code, 0);
  fs::resize_file(folder / "one.xplt", fs::file_size(folder / "one.xplt") - 100);
  const Finished cut = dea({"run", "flat.feb", "--times-from", "one.xplt"});
  EXPECT_EQ(cut.code, 3);
  EXPECT_EQ(cut.err, "one.xplt: found no complete state, expected the times of at least one\n");
  const Finished no_fea = dea({"run", "flat.feb", "--times-from", "flat.feb"});
  EXPECT_EQ(no_fea.code, 3);
  EXPECT_EQ(no_fea.err.rfind("flat.feb", 0), 0u) << no_fea.err;
}

TEST_F(Cli, HelpIsACommandToo) {
  EXPECT_EQ(dea({"help"}).code, 0);
  EXPECT_EQ(dea({"help"}).out, dea({"--help"}).out);
  EXPECT_EQ(dea({"help", "plot"}).out, dea({"plot", "--help"}).out);
  EXPECT_EQ(dea({"help", "plto"}).code, 2);
}

TEST_F(Cli, WrongUseIsOneLineAndCodeTwo) {
  write_model();
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{}, "dea: no command is given, expected for example dea run MODEL.feb (dea --help lists the options)\n"},
      {{"run"}, "dea run: MODEL is required (dea run --help lists the options)\n"},
      {{"--hepl"}, "dea: no option --hepl (did you mean \"--help\"?) (dea --help lists the options)\n"},
      {{"run", "--hlp"}, "dea run: no option --hlp (did you mean \"--help\"?) (dea run --help lists the options)\n"},
      {{"run", "flat.feb", "--out", "x"},
       "dea run: no option --out (did you mean \"-o\"?) (dea run --help lists the options)\n"},
      {{"run", "flat.feb", "--output=x"},
       "dea run: no option --output (did you mean \"-o\"?) (dea run --help lists the options)\n"},
      {{"run", "flat.feb", "--speed"}, "dea run: no option --speed (dea run --help lists the options)\n"},
      {{"run", "flat.feb", "--law", "cubic"},
       "dea: --law cubic: found \"cubic\", expected linear, logarithmic, neo-Hookean or layer\n"},
      {{"run", "flat.feb", "--E", "top=1x"}, "dea: --E top=1x: found \"1x\", expected a number\n"},
      {{"run", "flat.feb", "--E", "inf"}, "dea: --E inf: found \"inf\", expected a number\n"},
      {{"run", "flat.feb", "--threads", "0"},
       "dea: --threads 0: found \"0\", expected a whole number from 1 to 1024\n"},
      {{"run", "flat.feb", "--vtu", "-"}, "dea: --vtu -: a folder cannot go to standard output, give it a name\n"},
      {{"run", "flat.feb", "-o", "-"}, "dea: -o -: the plot file cannot go to standard output, give it a name\n"},
      {{"run", "flat.feb", "--no-xplt", "-o", "r.xplt"},
       "dea: --no-xplt and -o r.xplt: found both, expected one of them\n"},
      {{"run", "flat.feb", "--no-xplt", "--compress"},
       "dea: --compress belongs to the plot file, found --no-xplt beside it\n"},
      {{"run", "flat.feb", "-o", "./flat.feb"}, "dea: -o ./flat.feb: would overwrite the model\n"},
      {{"run", "flat.feb", "--json", "-", "--csv", "-"},
       "dea: only one of --json and --csv can go to standard output\n"},
      {{"run", "flat.feb", "--json", "a", "--csv", "./a"}, "dea: --csv ./a: is the file of --json too\n"},
      {{"run", "flat.feb", "--contact", "hip"},
       "dea: --contact hip: the model has no sliding contact of this name; it has \"touch\"\n"},
      {{"run", "flat.feb", "--thickness", "side=1"},
       "dea: --thickness side: the model has no surface of this name; it has \"top\", \"under\"\n"},
      {{"run", "flat.feb", "--force", "femur=1,2,3"},
       "dea: --force femur: the model has no rigid body of this name; it has \"base\", \"plate\", \"ground\"\n"},
      {{"converge", "flat.feb", "--target", "2"}, "dea: --target 2: found \"2\", expected a number between 0 and 1\n"},
      {{"converge", "flat.feb", "--loads", "t.csv", "--load-body", "plate"},
       "dea: converge: found a table of loads or motion, expected none: it divides the springs of the model's own last "
       "state\n"},
      {{"converge", "flat.feb", "--max-springs", "many"},
       "dea: --max-springs many: found \"many\", expected a whole number from 1 to 100000000\n"},
  };
  for (const auto& c : cases) {
    const Finished f = dea(c.first);
    EXPECT_EQ(f.code, 2) << c.second;
    EXPECT_EQ(f.err, c.second);
    EXPECT_EQ(f.out, "") << c.second;
  }
  for (const char* option : {"--rigid", "--source", "--free", "--load-at", "--attach", "--bone"}) {
    const std::string name = option, value = name == "--rigid" || name == "--source" ? "nobody"
                                             : name == "--free"                      ? "nobody=x"
                                             : name == "--load-at"                   ? "nobody=1,2,3"
                                                                                     : "nobody=plate";
    const Finished f = dea({"run", "flat.feb", name, value});
    EXPECT_EQ(f.code, 2) << f.err;
    EXPECT_NE(f.err.find("nobody"), std::string::npos) << f.err;
    EXPECT_EQ(std::count(f.err.begin(), f.err.end(), '\n'), 1) << f.err;
  }
  EXPECT_EQ(files(), Names{"flat.feb"});
}

// p = M d / t with d = 0.2 of the plate in the file: thickness scaled, from a file, both; and every command that takes
// settings knows them.
TEST_F(Cli, ThicknessScaledAndFromAFile) {
  write_model();
  std::string csv = "node,thickness\n";
  for (int node = 17; node <= 32; ++node) csv += fmt::format("{},1.6\n", node);
  write("t.csv", csv + "33,9\n");
  const auto peak = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"run", "flat.feb", "--law", "linear", "--json", "-"});
    const Finished f = dea(options);
    EXPECT_EQ(f.code, 0) << f.err;
    return Json::parse(f.out)["states"].back()["contacts"][0]["peak_pressure"].get<double>();
  };
  const double M_d = kM * 0.2;
  EXPECT_NEAR(peak({"--thickness-scale", "0.8"}), M_d / 1.6, 1e-11);
  EXPECT_NEAR(peak({"--thickness-from", "top=t.csv"}), M_d / 1.6, 1e-11);
  EXPECT_NEAR(peak({"--thickness-from", "top=t.csv", "--thickness-scale", "top=0.5"}), M_d / 0.8, 1e-11);
  write("s.xml",
        "<febiodea_settings version=\"1\"><thickness-from surface=\"top\">t.csv</thickness-from>"
        "<thickness-scale>0.5</thickness-scale></febiodea_settings>");
  EXPECT_NEAR(peak({"--settings", "s.xml"}), M_d / 0.8, 1e-11);
  EXPECT_NEAR(peak({"--settings", "s.xml", "--thickness", "top=4"}), M_d / 2, 1e-11);

  const Finished info = dea({"info", "flat.feb", "--settings", "s.xml"});
  EXPECT_NE(info.out.find("thickness (from t.csv, times 0.5): min 0.8, mean 0.8, max 0.8 mm\n"), std::string::npos)
      << info.out;
  EXPECT_NE(info.out.find("thickness from t.csv, 16 nodes; 1 of the file's nodes are not on it and passed over"),
            std::string::npos);
  const Json j = Json::parse(dea({"info", "flat.feb", "--settings", "s.xml", "--json", "-"}).out);
  const Json& layer = j["contacts"][0]["primary"];
  EXPECT_NEAR(layer["thickness_mean"].get<double>(), 0.8, 1e-12);
  EXPECT_EQ(layer["thickness_scale"], 0.5);
  EXPECT_EQ(layer["thickness_from"], "t.csv");
  EXPECT_EQ(j["settings"]["thickness_scale"][""], 0.5);
  EXPECT_EQ(j["settings"]["thickness_from"]["top"], "t.csv");
  EXPECT_TRUE(j["settings"]["set"].empty());
  EXPECT_EQ(dea({"converge", "flat.feb", "-q", "--law", "linear", "--settings", "s.xml"}).code, 0);
  ASSERT_EQ(dea({"convert", "flat.feb", "-q", "--law", "linear", "--settings", "s.xml", "-o", "c.feb"}).code, 0);
  const Finished converted = dea({"run", "c.feb", "--json", "-"});
  EXPECT_NEAR(Json::parse(converted.out)["states"].back()["contacts"][0]["peak_pressure"].get<double>(), M_d / 0.8,
              1e-11);

  const Finished over = dea({"run", "flat.feb", "--thickness-from", "top=t.csv", "--csv", "t.csv"});
  EXPECT_EQ(over.code, 2);
  EXPECT_EQ(over.err, "dea: --csv t.csv: would overwrite the table of thickness\n");
  EXPECT_EQ(file_text(folder / "t.csv"), csv + "33,9\n");
}

// A ligament of samples/knee set on the command line, in a settings file and in the model's text: one result.
TEST_F(Cli, SetIsTheSameAsInTheModel) {
  const std::string knee = file_text(DEA_SAMPLES_DIR "/knee/knee.feb");
  const std::string cruciates = "<E>80</E>";
  ASSERT_NE(knee.find(cruciates), std::string::npos);
  std::string softer = knee;
  softer.replace(knee.find(cruciates), cruciates.size(), "<E>65</E>");
  write("knee.feb", knee);
  write("softer.feb", softer);
  write("s.xml",
        "<febiodea_settings version=\"1\"><set name=\"ACL.stiffness\">65</set><set name=\"PCL.stiffness\">65</set>"
        "</febiodea_settings>");
  const auto last = [&](const std::vector<std::string>& options) {
    std::vector<std::string> words = {"run", options[0], "--law", "linear", "--states", "last", "--json", "-"};
    words.insert(words.end(), options.begin() + 1, options.end());
    const Finished f = dea(words);
    EXPECT_EQ(f.code, 0) << f.err;
    return Json::parse(f.out)["states"].back();
  };
  const Json written = last({"softer.feb"});
  EXPECT_EQ(last({"knee.feb", "--set", "ACL.stiffness=65", "--set", "PCL.stiffness=65"}), written);
  EXPECT_EQ(last({"knee.feb", "--settings", "s.xml"}), written);
  EXPECT_EQ(last({"knee.feb", "--settings", "s.xml", "--set", "ACL.stiffness=80", "--set", "PCL.stiffness=80"}),
            last({"knee.feb"}));
  EXPECT_NE(last({"knee.feb"}), written);

  const Finished info = dea({"info", "knee.feb", "--set", "ACL.stiffness=65"});
  EXPECT_NE(info.out.find("note: set: ACL.stiffness 65 for all 2 of this name (model: 80) [value-set]\n"),
            std::string::npos);
  EXPECT_NE(info.out.find("stiffness 65, free length"), std::string::npos);
  const Finished run = dea({"run", "knee.feb", "--law", "linear", "--states", "last", "--set", "ACL.stiffness=65"});
  EXPECT_NE(run.err.find("set: ACL.stiffness 65 for all 2 of this name (model: 80) [value-set]\n"), std::string::npos)
      << run.err;
  const Finished refused = dea({"convert", "knee.feb", "--set", "ACL.stiffness=65"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_EQ(refused.err,
            "dea: --set ACL.stiffness: a converted file keeps the model's own springs and forces; change them in the "
            "model\n");
}

TEST_F(Cli, InputRefusedIsOneLineAndCodeThree) {
  const Finished missing = dea({"run", "no.feb"});
  EXPECT_EQ(missing.code, 3);
  EXPECT_EQ(missing.err.rfind("no.feb: ", 0), 0u) << missing.err;
  EXPECT_EQ(std::count(missing.err.begin(), missing.err.end(), '\n'), 1);
  write_model();
  write("s.xml", "<febiodea_settings version=\"1\">\n<law>cubic</law>\n</febiodea_settings>\n");
  const Finished settings = dea({"run", "flat.feb", "--settings", "s.xml"});
  EXPECT_EQ(settings.code, 3);
  EXPECT_EQ(settings.err, "s.xml:2: <law>: found \"cubic\", expected linear, logarithmic, neo-Hookean or layer\n");
  write("text.feb", "not a model\n");
  EXPECT_EQ(dea({"run", "text.feb"}).code, 3);
  EXPECT_EQ(dea({"info", "text.feb"}).code, 3);
  EXPECT_EQ(dea({"converge", "text.feb"}).code, 3);
  EXPECT_EQ(dea({"run", "."}).code, 3);
  EXPECT_EQ(files(), (Names{"flat.feb", "s.xml", "text.feb"}));
}

/// Notes on the model stand before it.
std::string last_line(std::string text) {
  if (!text.empty() && text.back() == '\n') text.pop_back();
  return text.substr(text.rfind('\n') + 1);
}

TEST_F(Cli, UnwritableOutputIsCodeFourAndLeavesNothing) {
  write_model();
  fs::create_directory(folder / "folder");
  const Finished no_folder = dea({"run", "flat.feb", "-o", "nowhere/r.xplt"});
  EXPECT_EQ(no_folder.code, 4);
  EXPECT_EQ(no_folder.err, "dea: cannot write nowhere/r.xplt: there is no folder nowhere\n");
  EXPECT_EQ(dea({"run", "flat.feb", "--json", "folder"}).err, "dea: cannot write folder: is a folder\n");
  const Finished full = dea({"run", "flat.feb", "-o", "/dev/full"});
  EXPECT_EQ(full.code, 4);
  EXPECT_EQ(last_line(full.err), "dea: cannot write /dev/full: No space left on device");
  const Finished json = dea({"run", "flat.feb", "-o", "r.xplt", "--json", "/dev/full"});
  EXPECT_EQ(json.code, 4);
  EXPECT_EQ(last_line(json.err), "dea: cannot write /dev/full: No space left on device");
  EXPECT_EQ(dea({"run", "flat.feb", "-o", "r.xplt", "--csv", "-"}, "/dev/full").code, 4);
  EXPECT_EQ(dea({"info", "flat.feb"}, "/dev/full").code, 4);
  EXPECT_EQ(files(), (Names{"flat.feb", "folder", "r.xplt"}));
}

TEST_F(Cli, FileSizeLimitLeavesTheOlderResultAndNoTemporaryFile) {
  write_model();
  write("r.xplt", "older");
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{1024, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);  // inherited by the program
  const Finished f = dea({"run", "flat.feb", "-o", "r.xplt", "-q", "--overwrite"});
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  EXPECT_EQ(f.code, 4);
  EXPECT_EQ(f.err, "dea: cannot write r.xplt: File too large\n");
  EXPECT_EQ(files(), (Names{"flat.feb", "r.xplt"}));
  EXPECT_EQ(file_text(folder / "r.xplt"), "older");
}

TEST_F(Cli, OutputReplacesAnOlderOneAndMayBeADevice) {
  write_model();
  write("r.json", "{\n \"schema\": \"dea.run/1\"\n}\n");  // of an older dea
  ASSERT_EQ(dea({"run", "flat.feb", "--json", "r.json", "-o", "/dev/null", "-q"}).code, 0);
  EXPECT_EQ(Json::parse(file_text(folder / "r.json"))["schema"], "dea.run/1");
  EXPECT_EQ(files(), (Names{"flat.feb", "r.json"}));
}

// 18 triangles: their springs are counted, and refused where they need more memory than there is.
TEST_F(Cli, FineDivisionsTellTheirCost) {
  write_model();
  const Finished few = dea({"info", "flat.feb", "--refine", "20", "--law", "linear"});
  EXPECT_EQ(few.err, "");
  const Finished many = dea({"run", "flat.feb", "--refine", "240", "--law", "linear", "--states", "last", "--no-xplt"});
  EXPECT_EQ(many.code, 0) << many.err;
  const std::string note =
      "note: --refine 240: 1036800 springs (18 triangles, each divided into 240 x 240), about 0.75 GB of memory\n";
  EXPECT_NE(many.err.find(note), std::string::npos) << many.err;
#ifndef DEA_SANITIZE_ADDRESS  // takes all addresses for itself
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_AS, &before), 0);
  const rlimit small{rlim_t{3} << 30, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_AS, &small), 0);  // inherited by the program
  const Finished f = dea({"run", "flat.feb", "--refine", "1000", "--law", "linear"});
  ASSERT_EQ(::setrlimit(RLIMIT_AS, &before), 0);
  EXPECT_EQ(f.code, 2) << f.err;
  EXPECT_EQ(f.err.rfind("dea: --refine 1000: 18000000 springs need about 13 GB of memory, and ", 0), 0u) << f.err;
  const std::size_t place = f.err.find("GB are free; --refine ");
  ASSERT_NE(place, std::string::npos) << f.err;
  const int fits = std::stoi(f.err.substr(place + 22));
  EXPECT_GT(fits, 300);                                                              // 1.6 million springs
  EXPECT_LT(fits, static_cast<int>(std::sqrt(double(rlim_t{3} << 30) / 720 / 18)));  // less than all of the 3 GiB
  EXPECT_EQ(files(), Names{"flat.feb"});
#endif
}

// With too few addresses for the search of the hip's bones: one line, whichever library runs out first.
TEST_F(Cli, AFullMemoryIsSaid) {
#ifndef DEA_SANITIZE_ADDRESS  // takes all addresses for itself
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_AS, &before), 0);
  for (const rlim_t megabytes : {42, 61}) {
    const rlimit small{megabytes << 20, before.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_AS, &small), 0);  // inherited by the program
    const Finished f = dea({"run", DEA_SAMPLES_DIR "/hip/hip_walking.feb", "-q", "--states", "last", "--no-xplt"});
    ASSERT_EQ(::setrlimit(RLIMIT_AS, &before), 0);
    EXPECT_EQ(f.code, 3) << megabytes << ": " << f.err;
    EXPECT_EQ(f.err.rfind("dea: the memory is full", 0), 0u) << f.err;
    EXPECT_EQ(std::count(f.err.begin(), f.err.end(), '\n'), 1) << f.err;
  }
#endif
}

// Units stand where they are known, by the model or by --units, and nowhere else.
TEST_F(Cli, UnitsOfTables) {
  write_model();
  std::string text = file_text(folder / "flat.feb");
  const std::string named = "<units>mm-N-s</units>";
  text.erase(text.find(named), named.size());
  write("silent.feb", text);
  const auto heading = [](const std::string& out, const std::string& start) {
    const std::size_t begin = out.find("\n" + start);
    return begin == std::string::npos ? "" : out.substr(begin + 1, out.find('\n', begin + 1) - begin - 1);
  };
  const std::vector<std::vector<std::string>> known = {{"flat.feb"}, {"silent.feb", "--units", "mm-N-s"}};
  for (const std::vector<std::string>& model : known) {
    const auto with = [&](const std::string& command, std::vector<std::string> more) {
      std::vector<std::string> words = {command};
      words.insert(words.end(), model.begin(), model.end());
      words.insert(words.end(), more.begin(), more.end());
      const Finished f = dea(words);
      EXPECT_TRUE(f.code == 0 || (f.code == 1 && command == "converge")) << f.err;
      return f.out;
    };
    const std::string run = with("run", {"--json", "r.json", "-o", "r.xplt"});
    for (const char* word : {"p99 [MPa]  ", "mean [MPa]  ", "area [mm²]  ", "peak [MPa]  ", "force [N]  "})
      EXPECT_NE(heading(run, "time  contact").find(word), std::string::npos) << run;
    for (const char* word : {"translation [mm]  ", "force [N]  ", "moment [N mm]"})
      EXPECT_NE(heading(run, "body ").find(word), std::string::npos) << run;
    const Json units = {{"length", "mm"}, {"force", "N"}, {"pressure", "MPa"}, {"area", "mm²"}};
    const Json j = Json::parse(file_text(folder / "r.json"));
    EXPECT_EQ(j["units"], "mm-N-s");
    EXPECT_EQ(j["unit_names"], units);
    EXPECT_EQ(read_xplt((folder / "r.xplt").string()).units, "mm-N-s");
    const std::string info = with("info", {"--json", "i.json"});
    for (const char* word : {"area 9 mm²\n", ", E 10 MPa, nu 0.3, ", "thickness: min 2, mean 2, max 2 mm; "})
      EXPECT_NE(info.find(word), std::string::npos) << word << info;
    EXPECT_EQ(Json::parse(file_text(folder / "i.json"))["unit_names"], units);
    EXPECT_NE(with("converge", {"--max-springs", "20"}).find("area [mm²]  area changes"), std::string::npos);
    const Finished compare = dea({"compare", "r.xplt", "r.xplt", "--details"});
    for (const char* word : {"\np99 [MPa] ", "\narea [mm²] ", "\nresultant of the map [N] ", "position r [mm]"})
      EXPECT_NE(compare.out.find(word), std::string::npos) << word << compare.out;
    fs::remove(folder / "r.xplt");
  }
  const Finished silent = dea({"run", "silent.feb", "--json", "s.json"});
  EXPECT_EQ(silent.out.find(" [m"), std::string::npos) << silent.out;
  EXPECT_EQ(silent.out.find(" [N"), std::string::npos) << silent.out;
  EXPECT_TRUE(Json::parse(file_text(folder / "s.json"))["unit_names"].is_null());
  EXPECT_EQ(dea({"info", "silent.feb"}).out.find("mm"), std::string::npos);
  const Finished other = dea({"run", "flat.feb", "--units", "SI"});
  EXPECT_EQ(other.code, 2);
  EXPECT_EQ(other.err, "dea: --units SI: the model says that it is in \"mm-N-s\"; leave it out\n");
}

TEST_F(Cli, NoPlotFileWhereNoneIsWanted) {
  write_model();
  const Finished table = dea({"run", "flat.feb", "--no-xplt"});
  EXPECT_EQ(table.code, 0) << table.err;
  EXPECT_NE(table.out.find("\n   1  touch"), std::string::npos) << table.out;
  EXPECT_EQ(table.err.find("xplt"), std::string::npos) << table.err;
  EXPECT_EQ(files(), Names{"flat.feb"});
  write("s.xml", "<febiodea_settings version=\"1\"><output>o.xplt</output></febiodea_settings>");
  const Finished f = dea({"run", "flat.feb", "--no-xplt", "-q", "--settings", "s.xml", "--json", "r.json", "--csv",
                          "r.csv", "--facets-csv", "f.csv", "--vtu", "paraview", "--report", "r.html"});
  EXPECT_EQ(f.code, 0) << f.err;
  EXPECT_EQ(files(), (Names{"f.csv", "flat.feb", "paraview", "r.csv", "r.html", "r.json", "s.xml"}));
  EXPECT_TRUE(fs::exists(folder / "paraview" / "results.pvd"));
  // a settings file says the same, and -o overrides it
  const Names before = files();
  write("s.xml", "<febiodea_settings version=\"1\">\n<no-xplt>True</no-xplt><states>last</states></febiodea_settings>");
  ASSERT_EQ(dea({"run", "flat.feb", "-q", "--settings", "s.xml"}).code, 0);
  EXPECT_EQ(files(), before);
  EXPECT_EQ(dea({"run", "flat.feb", "-q", "--settings", "s.xml", "--compress"}).err,
            "dea: --compress belongs to the plot file, found <no-xplt> beside it\n");
  ASSERT_EQ(dea({"run", "flat.feb", "-q", "--settings", "s.xml", "-o", "named.xplt"}).code, 0);
  EXPECT_TRUE(fs::exists(folder / "named.xplt"));
  // a time that the model does not have is told with the file's line
  write("s.xml", "<febiodea_settings version=\"1\">\n<states>7</states></febiodea_settings>");
  EXPECT_EQ(dea({"run", "flat.feb", "-q", "--settings", "s.xml"}).err,
            "dea: s.xml:2: <states>: found time 7, expected times from 0 to 1, those of the model\n");
  ASSERT_EQ(dea({"run", "flat.feb", "-q", "--json", "with.json"}).code, 0);
  EXPECT_EQ(Json::parse(file_text(folder / "r.json"))["states"],
            Json::parse(file_text(folder / "with.json"))["states"]);
}

// What is there already is replaced unasked only if it is ours, of the same mesh, and no state is lost.
TEST_F(Cli, PlotFilesThatAreThereAlready) {
  write_model();
  write_model("push.feb", -12.0);
  const auto run = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"run", "flat.feb", "-q"});
    return dea(more);
  };
  const auto expect_kept = [&](const Finished& f, const std::string& name, const std::string& why,
                               const std::string& before) {
    EXPECT_EQ(f.code, 4);
    EXPECT_EQ(f.err, fmt::format("dea: cannot write {}: it is there already, {}; --overwrite replaces it, -o "
                                 "writes another\n",
                                 name, why));
    EXPECT_TRUE(file_text(folder / name) == before) << name;
  };
  const std::string note = "note: flat_dea.xplt replaced the file that was there; -o writes another\n";
  EXPECT_EQ(dea({"run", "flat.feb", "--states", "last"}).err.find("replaced"), std::string::npos);
  EXPECT_NE(dea({"run", "flat.feb", "--states", "last"}).err.find(note), std::string::npos);
  ASSERT_EQ(run({"--states", "last"}).err, "");
  ASSERT_EQ(run({}).code, 0);  // with more states: nothing is lost
  ASSERT_EQ(run({"--law", "linear"}).code, 0);
  const std::string all = file_text(folder / "flat_dea.xplt");
  expect_kept(run({"--states", "last"}), "flat_dea.xplt",
              "results of this model with 4 states that would be lost (times 0 to 0.75)", all);
  expect_kept(run({"--states", "0,0.25,0.75,last"}), "flat_dea.xplt",
              "results of this model with 1 state that would be lost (time 0.5)", all);
  expect_kept(run({"--states", "last", "-o", "flat_dea.xplt"}), "flat_dea.xplt",
              "results of this model with 4 states that would be lost (times 0 to 0.75)", all);
  EXPECT_EQ(dea({"run", "push.feb", "-q", "-o", "flat_dea.xplt"}).code, 0);  // the same mesh and times
  ASSERT_EQ(run({"--states", "last", "--overwrite"}).code, 0);
  EXPECT_EQ(read_xplt((folder / "flat_dea.xplt").string()).states.size(), 1u);
  ASSERT_EQ(run({"--states", "last", "--compress", "-o", "z.xplt"}).code, 0);
  EXPECT_EQ(run({"--states", "0", "-o", "z.xplt"}).code, 4);  // also where the states must be unpacked
  EXPECT_EQ(run({"-o", "z.xplt"}).code, 0);

  std::string text = file_text(folder / "flat.feb");
  const std::string node = "<node id=\"37\">9,9,9</node>\n</Nodes>";
  text.replace(text.find("</Nodes>"), 8, node);
  write("other.feb", text);
  const std::string ours = file_text(folder / "flat_dea.xplt");
  expect_kept(dea({"run", "other.feb", "-q", "-o", "flat_dea.xplt"}), "flat_dea.xplt",
              "results of another mesh: 36 nodes and 19 elements, not 37 nodes and 19 elements", ours);

  XpltFile foreign = read_xplt((folder / "flat_dea.xplt").string());
  foreign.software = "FEBio 4.7.0";
  write_xplt((folder / "fea.xplt").string(), foreign);
  const std::string fea = file_text(folder / "fea.xplt");
  expect_kept(run({"--states", "last", "-o", "fea.xplt"}), "fea.xplt", "written by FEBio 4.7.0", fea);
  expect_kept(dea({"info", "flat.feb", "-o", "fea.xplt"}), "fea.xplt", "written by FEBio 4.7.0", fea);
  expect_kept(dea({"compare", "flat_dea.xplt", "flat_dea.xplt", "-o", "fea.xplt"}), "fea.xplt",
              "written by FEBio 4.7.0", fea);
  EXPECT_EQ(dea({"info", "flat.feb", "-o", "fea.xplt", "--overwrite"}).code, 0);
  EXPECT_EQ(dea({"info", "flat.feb", "-o", "fea.xplt"}).code, 0);  // its own may be replaced
  expect_kept(run({"-o", "fea.xplt"}), "fea.xplt", "what dea info -o writes", file_text(folder / "fea.xplt"));
  ASSERT_EQ(dea({"compare", "flat_dea.xplt", "flat_dea.xplt", "-q", "-o", "both.xplt"}).code, 0);
  EXPECT_EQ(dea({"compare", "flat_dea.xplt", "flat_dea.xplt", "-q", "-o", "both.xplt"}).code, 0);
  expect_kept(run({"-o", "both.xplt"}), "both.xplt", "what dea compare -o writes", file_text(folder / "both.xplt"));
  expect_kept(dea({"info", "flat.feb", "-o", "flat_dea.xplt"}), "flat_dea.xplt", "results of dea run", ours);

  write("text.xplt", "not a plot file");
  const Finished no_plot = run({"-o", "text.xplt"});
  EXPECT_EQ(no_plot.code, 4);
  EXPECT_NE(no_plot.err.find("it is there already, and is no whole plot file;"), std::string::npos) << no_plot.err;
  write("cut.xplt", ours.substr(0, ours.size() / 2));
  EXPECT_EQ(run({"-o", "cut.xplt"}).code, 4);
  EXPECT_EQ(run({"-o", "cut.xplt", "--overwrite"}).code, 0);
  write("empty.xplt", "");  // as mktemp leaves it: nothing to lose
  EXPECT_EQ(run({"-o", "empty.xplt"}).code, 0);
}

/// `--live` needs the page that has the program; without it, and for files that a page cannot have, there is one line.
TEST_F(Cli, TheJointOfARunAsAPage) {
  write_model();
  const Finished none = dea({"run", "flat.feb", "-q", "--no-xplt", "--live", "a.html"});
  EXPECT_EQ(none.code, 2);
  EXPECT_EQ(none.err.rfind("dea: --live: found no dea.html beside the program", 0), 0u) << none.err;
  EXPECT_FALSE(fs::exists(folder / "a.html"));
  write_model("flat.feb", -1.0);
  const fs::path place = folder / "program";
  fs::create_directory(place);
  fs::copy_file(DEA_PROGRAM, place / "dea");
  write("program/dea.html",
        "<meta name=\"generator\" content=\"FEBioDEA\"><script type=\"text/plain\" "
        "id=\"sample-model\" data-gives-way=\"1\">x</script>\n");
  const auto beside = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"run", "flat.feb", "-q", "--no-xplt"});
    return end_of(start(folder, words, folder / "out", folder / "err", (place / "dea").string()), folder / "out",
                  folder / "err");
  };
  const Finished made = beside({"--E", "9", "--no-squash", "--live", "a.html"});
  EXPECT_EQ(made.code, 0) << made.err;
  const std::string page = file_text(folder / "a.html");
  EXPECT_NE(page.find("class=\"given\" data-name=\"flat.feb\" data-kind=\"model\""), std::string::npos);
  EXPECT_NE(page.find(base64(R"(["--E","9","--no-squash"])")), std::string::npos);
  EXPECT_EQ(beside({"--live", "a.html"}).code, 0) << "its own page gives way";
  const std::string before = file_text(place / "dea.html");
  EXPECT_EQ(beside({"--live", "program/dea.html"}).code, 2) << "the page that it is made of does not";
  EXPECT_EQ(file_text(place / "dea.html"), before);
  EXPECT_EQ(beside({"--live", "a.txt"}).code, 2);
  EXPECT_EQ(beside({"--live", "no_folder/a.html"}).code, 4);
  // two files of one name, and a table that a settings file names in another folder
  fs::create_directory(folder / "one");
  write("one/t.csv", "time,Fx,Fy,Fz\n0,0,0,-1\n");
  write("s.xml",
        "<febiodea_settings version=\"1\"><loads>one/t.csv</loads><load-body>plate</load-body></febiodea_settings>\n");
  const Finished apart = beside({"--settings", "s.xml", "--live", "b.html"});
  EXPECT_EQ(apart.code, 2) << apart.err;
  EXPECT_NE(apart.err.find("a page has no folders"), std::string::npos) << apart.err;
}

// The same of every other file that a command writes: what dea made gives way, anything else only to --overwrite.
TEST_F(Cli, OtherFilesThatAreThereAlready) {
  write_model();
  ASSERT_EQ(dea({"run", "flat.feb", "-q"}).code, 0);
  struct Case {
    std::vector<std::string> words;
    std::string option, name;
  };
  const std::vector<std::string> run = {"run", "flat.feb", "-q", "--states", "last", "--no-xplt"},
                                 compare = {"compare", "flat_dea.xplt", "flat_dea.xplt", "-q"},
                                 plot = {"plot", "flat_dea.xplt", "-q"};
  const std::string foreign = "x,y\n1,2\n";
  for (const Case& c : {
           Case{run, "--json", "a.json"},
           {run, "--csv", "a.csv"},
           {run, "--compartments-csv", "b.csv"},
           {run, "--facets-csv", "c.csv"},
           {run, "--report", "a.html"},
           {{"info", "flat.feb"}, "--json", "i.json"},
           {{"converge", "flat.feb", "-q", "--target", "0.5"}, "--json", "n.json"},
           {compare, "--json", "k.json"},
           {compare, "--csv", "k.csv"},
           {compare, "--report", "k.html"},
           {plot, "-o", "p.png"},
           {plot, "-o", "p.svg"},
           {plot, "-o", "p.pdf"},
           {plot, "--animate", "p.gif"},
       }) {
    const auto again = [&](bool overwrite) {
      std::vector<std::string> words = c.words;
      words.insert(words.end(), {c.option, c.name});
      if (overwrite) words.emplace_back("--overwrite");
      return dea(words);
    };
    write(c.name, foreign);
    const Finished refused = again(false);
    EXPECT_EQ(refused.code, 4) << c.name;
    EXPECT_EQ(refused.err,
              fmt::format("dea: cannot write {}: it is there already, not made by dea; --overwrite replaces it, {} "
                          "writes another\n",
                          c.name, c.option));
    EXPECT_EQ(file_text(folder / c.name), foreign) << c.name;
    EXPECT_EQ(again(true).code, 0) << c.name;
    const std::string made = file_text(folder / c.name);
    EXPECT_NE(made, foreign) << c.name;
    const Finished second = again(false);  // its own
    EXPECT_EQ(second.code, 0) << c.name << second.err;
    write(c.name, "");  // nothing to lose
    EXPECT_EQ(again(false).code, 0) << c.name;
  }
  // results of another command are made by dea, too; a picture that is not, whatever its head
  write("p.png", file_text(folder / "p.png").substr(0, 33));
  EXPECT_EQ(dea({"plot", "flat_dea.xplt", "-q", "-o", "p.png"}).code, 4);

  ASSERT_EQ(dea({"man", "-o", "man"}).code, 0);
  EXPECT_EQ(dea({"man", "-o", "man"}).code, 0);
  write("man/dea-run.1", foreign);
  EXPECT_EQ(dea({"man", "-o", "man"}).code, 4);
  EXPECT_EQ(file_text(folder / "man/dea-run.1"), foreign);
  EXPECT_EQ(dea({"man", "-o", "man", "--overwrite"}).code, 0);
}

// One sentence for one meaning.
TEST_F(Cli, OverwriteIsHelpedAlikeEverywhere) {
  for (const char* command :
       {"run", "study", "info", "converge", "convert", "build", "plugin-build", "compare", "plot", "man"}) {
    std::string help = dea({command, "--help"}).out;
    help.erase(std::unique(help.begin(), help.end(),
                           [](char a, char b) { return (a == ' ' || a == '\n') && (b == ' ' || b == '\n'); }),
               help.end());
    std::replace(help.begin(), help.end(), '\n', ' ');
    EXPECT_NE(help.find("--overwrite Replace files that are there, whatever they are [only what dea made itself, if "
                        "nothing else would be lost with it]"),
              std::string::npos)
        << command << help;
  }
}

// -v and the codes that are to be quiet go together; -q by itself does not.
TEST_F(Cli, VerboseGoesWithQuietCodes) {
  write_model();
  const auto run = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"run", "flat.feb", "--states", "last", "--no-xplt", "-v"});
    return dea(more);
  };
  EXPECT_EQ(run({"--quiet", "narrow-contact"}).code, 0);
  for (const char* word : {"-q", "--quiet"})
    EXPECT_EQ(run({word}).err, "dea: -q and -v: found both, expected one of them\n");
}

// Two runs truly at once: the second one is told, and whoever is killed stands in nobody's way.
TEST_F(Cli, TwoRunsAtOnceShareNoOutput) {
  write_model();
  const std::string hip = DEA_SAMPLES_DIR "/hip/hip_walking.feb";
  const fs::path out = folder.string() + ".first.out", err = folder.string() + ".first.err";
  const pid_t first =
      start(folder, {"run", hip, "--refine", "4", "-v", "-o", "flat_dea.xplt", "--json", "j", "--vtu", "pv"}, out, err);
  const auto started = std::chrono::steady_clock::now();
  while (file_text(err).find("springs and layers") == std::string::npos &&
         std::chrono::steady_clock::now() - started < std::chrono::minutes(5))
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const auto refused = [&](const std::string& name, const std::string& option, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"run", "flat.feb", "-q"};
    words.insert(words.end(), more.begin(), more.end());
    const Finished f = dea(words);
    EXPECT_EQ(f.code, 4) << name;
    EXPECT_EQ(f.err,
              fmt::format("dea: cannot write {}: another run (process {}) is at work on it; wait for its end, or "
                          "give {} another name\n",
                          name, first, option));
  };
  fs::create_symlink("flat_dea.xplt", folder / "link.xplt");
  refused("flat_dea.xplt", "-o", {});  // its default name
  refused("./flat_dea.xplt", "-o", {"-o", "./flat_dea.xplt"});
  refused("j", "--csv", {"--no-xplt", "--csv", "j"});
  refused("pv/", "--vtu", {"-o", "mine.xplt", "--vtu", "pv/"});
  EXPECT_EQ(dea({"run", "flat.feb", "-q", "-o", "mine.xplt", "--json", "mine.json"}).code, 0);
  ASSERT_EQ(::kill(first, SIGKILL), 0);
  end_of(first, out, err);
  EXPECT_EQ(dea({"run", "flat.feb", "-q", "--json", "j", "--vtu", "pv"}).code, 0);
  EXPECT_EQ(files(), (Names{"flat.feb", "flat_dea.xplt", "j", "link.xplt", "mine.json", "mine.xplt", "pv"}));
}

// Started at one moment, again and again: each run either writes its whole result or is told; nothing is left behind.
TEST_F(Cli, ManyRunsAtOnce) {
  write_model();
  int solved = 0;
  for (int round = 0; round < 8; ++round) {
    std::vector<pid_t> all;
    const auto stream = [&](int i, const char* which) { return fmt::format("{}.{}.{}", folder.string(), i, which); };
    for (int i = 0; i < 4; ++i)
      all.push_back(start(folder, {"run", "flat.feb", "-q", "--json", "r.json"}, stream(i, "out"), stream(i, "err")));
    int solved_now = 0;
    for (int i = 0; i < 4; ++i) {
      const Finished f = end_of(all[static_cast<std::size_t>(i)], stream(i, "out"), stream(i, "err"));
      EXPECT_TRUE(f.code == 0 || (f.code == 4 && f.err.find("is at work on it; wait") != std::string::npos))
          << f.code << f.err;
      solved_now += f.code == 0;
    }
    EXPECT_GE(solved_now, 1);
    solved += solved_now;
    EXPECT_EQ(files(), (Names{"flat.feb", "flat_dea.xplt", "r.json"}));
    EXPECT_EQ(read_xplt((folder / "flat_dea.xplt").string()).states.size(), 5u);
    EXPECT_EQ(Json::parse(file_text(folder / "r.json"))["states"].size(), 5u);
  }
  EXPECT_LT(solved, 32);  // they did meet
}

TEST_F(Cli, CompressedPlotHoldsTheSame) {
  write_model();
  ASSERT_EQ(dea({"run", "flat.feb", "-q"}).code, 0);
  ASSERT_EQ(dea({"run", "flat.feb", "-q", "--compress", "-o", "z.xplt"}).code, 0);
  XpltFile a = read_xplt((folder / "flat_dea.xplt").string()), b = read_xplt((folder / "z.xplt").string());
  EXPECT_TRUE(b.compressed);
  b.compressed = false;
  EXPECT_TRUE(a == b);
}

TEST_F(Cli, NoSquashLeavesTheCartilageAsItIs) {
  write_model();
  ASSERT_EQ(dea({"run", "flat.feb", "-q", "--no-squash"}).code, 0);
  const XpltFile plot = read_xplt((folder / "flat_dea.xplt").string());
  EXPECT_EQ(plot.states.back().variables[0][0].values[3 * 31 + 2], 0.0f);
}

TEST_F(Cli, InfoSaysWhatIsRecognised) {
  write_model();
  const Finished f = dea({"info", "flat.feb", "-o", "check.xplt", "--json", "i.json"});
  ASSERT_EQ(f.code, 0) << f.err;
  for (const char* text :
       {"units: the model's, mm-N-s", "plate: material \"plate\"; centre of mass (1.5, 1.5, 1) (given)",
        "\"touch\": type sliding-elastic, springs on base", "thickness: min 2, mean 2, max 2", "initial gap min 0.1",
        "z prescribed -0.3", "0 0.25 0.5 0.75 1", "rim of the selected facets: free 12\n",
        "least-squares sphere: none, the surface is flat or not round\n"})
    EXPECT_NE(f.out.find(text), std::string::npos) << text << "\n" << f.out;
  const Json j = Json::parse(file_text(folder / "i.json"));
  EXPECT_EQ(j["schema"], "dea.info/1");
  EXPECT_EQ(keys(j).front(), "schema");
  EXPECT_NEAR(j["contacts"][0]["gap_min"].get<double>(), 0.1, 1e-12);
  EXPECT_NEAR(j["contacts"][0]["primary"]["confined_modulus"].get<double>(), kM, 1e-12);
  EXPECT_EQ(j["steps"][0]["bodies"]["plate"]["dofs"]["z"], "prescribed");
  EXPECT_NEAR(j["contacts"][0]["primary"]["rim"]["free"].get<double>(), 12, 1e-12);  // 3 x 3
  EXPECT_EQ(j["contacts"][0]["primary"]["rim"]["area_beyond"], 0.0);
  EXPECT_TRUE(j["contacts"][0]["secondary"]["rim"].is_null());  // bare
  const XpltFile check = read_xplt((folder / "check.xplt").string());
  const XpltDomain& springs = check.meshes[0].domains.back();
  EXPECT_EQ(springs.name, "springs touch");
  EXPECT_EQ(springs.element_ids.size(), 18u);
  const float* x = check.meshes[0].coordinates.data() + 3 * springs.nodes[0];
  EXPECT_NEAR(x[2], -2.0, 1e-6);  // from bone
  EXPECT_NEAR(x[5], 0.1, 1e-6);   // to the bare plate
}

// Side walls among the facets: said, shown in the check file, and without pressure in the plot file.
TEST_F(Cli, InfoShowsRimsAndFacetsLeftOut) {
  write_model();
  std::string text = file_text(folder / "flat.feb");
  const auto end = text.find("</Surface>", text.find("<Surface name=\"top\">"));
  text.insert(end, "<quad4 id=\"10\">1,2,18,17</quad4>\n<quad4 id=\"11\">2,3,19,18</quad4>\n");  // y = 0
  write("walls.feb", text);
  const Finished f = dea({"info", "walls.feb", "-o", "check.xplt", "--json", "i.json"});
  ASSERT_EQ(f.code, 0) << f.err;
  EXPECT_NE(f.out.find("left out: 2 facets, 2 side wall, 0 bonded to bone; area of those kept 9"), std::string::npos)
      << f.out;
  const Json j = Json::parse(file_text(folder / "i.json"));
  EXPECT_EQ(j["contacts"][0]["primary"]["left_out"]["side_wall"], 2);
  const auto values = [&](const XpltFile& file, const std::string& name) {
    for (std::size_t v = 0; v < file.variables.size(); ++v)
      if (file.variables[v].name == name) return file.states.back().variables[v].at(0).values;
    ADD_FAILURE() << "no " << name;
    return std::vector<float>();
  };
  const XpltFile check = read_xplt((folder / "check.xplt").string());
  const std::vector<float> rim = values(check, "rim"), left_out = values(check, "left out");
  // of the 36 corners of nine facets 4 x 4 lie at the four inner nodes; those of the walls are no face
  ASSERT_EQ(rim.size(), 44u);
  EXPECT_EQ(std::count(rim.begin(), rim.end(), 1.0f), 20);
  EXPECT_EQ(std::count(rim.begin(), rim.end(), 0.0f), 24);
  ASSERT_EQ(left_out.size(), 11u);
  EXPECT_EQ(std::count(left_out.begin(), left_out.end(), 0.0f), 9);
  EXPECT_EQ(left_out[9] + left_out[10], 2.0f);

  ASSERT_EQ(dea({"run", "walls.feb", "-q"}).code, 0);
  const std::vector<float> nodal = values(read_xplt((folder / "walls_dea.xplt").string()), "nodal contact pressure");
  ASSERT_EQ(nodal.size(), 44u);
  EXPECT_GT(*std::min_element(nodal.begin(), nodal.begin() + 36), 0.0f);
  EXPECT_EQ(*std::max_element(nodal.begin() + 36, nodal.end()), 0.0f);
  EXPECT_NE(dea({"info", "walls.feb", "--keep-facets", "top"}).out.find("surface \"top\", 11 facets, area 13"),
            std::string::npos);
  EXPECT_EQ(dea({"info", "walls.feb", "--keep-facets", "side"}).code, 2);
}

TEST_F(Cli, InfoPrintsWhatItCanOfARefusedModel) {
  write_model();
  std::string text = file_text(folder / "flat.feb");
  text.replace(text.find("type=\"sliding-elastic\""), 22, "type=\"tied-elastic\"");
  write("tied.feb", text);
  const Finished f = dea({"info", "tied.feb"});
  EXPECT_EQ(f.code, 3);
  EXPECT_NE(f.out.find("tied.feb: FEBio 4.0"), std::string::npos) << f.out;
  EXPECT_EQ(f.err.rfind("tied.feb", 0), 0u) << f.err;
  EXPECT_EQ(std::count(f.err.begin(), f.err.end(), '\n'), 1) << f.err;
}

TEST_F(Cli, ConvergeOnAPlaneLayerNeedsNoMoreSprings) {
  write_model();
  const Finished f = dea({"converge", "flat.feb", "--law", "linear", "--json", "-"});
  ASSERT_EQ(f.code, 0) << f.err;
  const Json j = Json::parse(f.out);
  expect_keys(j, {"schema", "model", "version", "settings", "target", "max_springs", "contacts"});
  EXPECT_EQ(j["schema"], "dea.converge/1");
  ASSERT_EQ(j["contacts"][0]["rows"].size(), 2u);
  EXPECT_EQ(j["contacts"][0]["rows"][1]["springs"], 72);
  EXPECT_EQ(j["contacts"][0]["springs_1_percent"], 18);
  EXPECT_TRUE(j["contacts"][0]["rows"][0]["change_headline"]["area"].is_null());
  for (const char* number : {"p99", "mean", "area", "peak"}) {  // a change is what the shown numbers say it is
    const double before = j["contacts"][0]["rows"][0]["headline"][number];
    const double after = j["contacts"][0]["rows"][1]["headline"][number];
    EXPECT_DOUBLE_EQ(j["contacts"][0]["rows"][1]["change_headline"][number], std::abs(after - before) / before);
  }
  const Finished run = dea({"run", "flat.feb", "--law", "linear", "--states", "last", "--no-xplt", "--json", "-"});
  EXPECT_EQ(j["contacts"][0]["rows"][0]["headline"]["p99"],
            Json::parse(run.out)["states"][0]["contacts"][0]["headline"]["p99"]);
  const Finished few = dea({"converge", "flat.feb", "--max-springs", "20"});
  EXPECT_EQ(few.code, 1);  // one row says nothing about change
  EXPECT_NE(few.out.find("refine  springs  p99 [MPa]  p99 changes  mean [MPa]  mean changes"), std::string::npos)
      << few.out;
  EXPECT_NE(few.out.find("changes below 1%: not reached"), std::string::npos) << few.out;
}

/// What it compiles is tested in tests/plugin, where an SDK is.
TEST_F(Cli, PluginBuildWithoutAnSdk) {
  const auto expect = [&](const std::vector<std::string>& words, int code, const std::string& fault) {
    const Finished f = dea(words);
    EXPECT_EQ(f.code, code) << fault;
    EXPECT_EQ(f.err, fault + "\n");
    EXPECT_EQ(f.out, "");
  };
  fs::create_directories(folder / "empty");
  fs::create_directories(folder / "half" / "sdk" / "lib" / "cmake" / "FEBio");
  fs::create_directories(folder / "sdk" / "include" / "FECore");
  fs::create_directories(folder / "sdk" / "lib" / "cmake" / "FEBio");
  std::ofstream(folder / "half" / "sdk" / "lib" / "cmake" / "FEBio" / "FEBioConfig.cmake") << "";
  std::ofstream(folder / "sdk" / "lib" / "cmake" / "FEBio" / "FEBioConfig.cmake") << "";
  std::ofstream(folder / "sdk" / "include" / "FECore" / "version.h") << "";
  const Names before = files();
  expect({"plugin-build"}, 2, "dea plugin-build: FEBIO_DIR is required (dea plugin-build --help lists the options)");
  expect({"plugin-build", "nowhere"}, 3, "nowhere: no such folder");
  expect({"plugin-build", "empty"}, 3,
         "empty: no SDK of FEBio, expected lib/cmake/FEBio/FEBioConfig.cmake there or in sdk");
  expect({"plugin-build", "half"}, 3, "half/sdk: no include/FECore/version.h, so no SDK of FEBio");
  expect({"plugin-build", "sdk", "-o", "nowhere"}, 4,
         "dea: cannot write " + (fs::canonical(folder) / "nowhere").string() + ": there is no such folder");
  expect({"plugin-build", "sdk", "--threads", "0"}, 2,
         "dea: --threads 0: found \"0\", expected a whole number from 1 to 1024");
  EXPECT_EQ(files(), before);
}

TEST_F(Cli, HelpAndVersion) {
  for (const std::vector<std::string>& words :
       {Names{"--help"}, Names{"run", "--help"}, Names{"info", "-h"}, Names{"converge", "--help"},
        Names{"plugin-build", "--help"}, Names{"--version"}}) {
    const Finished f = dea(words);
    EXPECT_EQ(f.code, 0);
    EXPECT_EQ(f.err, "");
    EXPECT_FALSE(f.out.empty());
  }
  const std::string help = dea({"run", "--help"}).out;
  for (const char* option :
       {"--contact", "--source",   "--springs-at", "--law",    "--facets",     "--refine",    "--rigid",
        "--attach",  "--bone",     "--thickness",  "--E",      "--nu",         "--free",      "--force",
        "--load-at", "--settings", "--times-from", "--states", "--compress",   "--no-squash", "--threads",
        "--json",    "--no-xplt",  "--overwrite",  "--csv",    "--facets-csv", "--vtu",       "-q",
        "-v"})
    EXPECT_NE(help.find(option), std::string::npos) << option;
  EXPECT_NE(dea({"--version"}).out.find("Eigen"), std::string::npos);
}

// A search that takes many seconds: the largest sample with sixteen times the springs. It ends within a second or so,
// with nothing written.
TEST_F(Cli, CtrlCEndsASearch) {
  const std::string hip = DEA_SAMPLES_DIR "/hip/hip_walking.feb";
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    double seconds = 0.0;
    const Finished f = interrupted({"run", hip, "--law", "layer", "--refine", "4", "--threads", "1", "-v", "-o",
                                    "hip.xplt", "--json", "hip.json", "--vtu", "paraview"},
                                   "state 2 of", signal, seconds);
    EXPECT_EQ(f.code, 128 + signal) << f.err;
    EXPECT_LT(seconds, 2.0);
    EXPECT_EQ(f.out, "");
    const std::string last = "dea: stopped, nothing was written\n";
    ASSERT_GE(f.err.size(), last.size());
    EXPECT_EQ(f.err.substr(f.err.size() - last.size()), last) << f.err;
    EXPECT_TRUE(fs::is_empty(folder)) << fs::directory_iterator(folder)->path();
  }
}

TEST_F(Cli, CtrlCBeforeTheSearchEndsAtOnce) {
  double seconds = 0.0;
  const Finished f = interrupted({"run", DEA_SAMPLES_DIR "/hip/hip_walking.feb", "--law", "layer", "--refine", "4",
                                  "--threads", "1", "-v", "-o", "hip.xplt"},
                                 "springs and layers", SIGINT, seconds);
  EXPECT_EQ(f.code, 130) << f.err;
  EXPECT_LT(seconds, 2.0);
  EXPECT_NE(f.err.find("\ndea: stopped"), std::string::npos) << f.err;
  EXPECT_TRUE(fs::is_empty(folder));
}

// A cmake that does not end when it is asked to: the first Ctrl-C waits for it, the second one ends it and dea at once.
TEST_F(Cli, SecondCtrlCEndsPluginBuildAtOnce) {
  fs::create_directories(folder / "sdk/lib/cmake/FEBio");
  fs::create_directories(folder / "sdk/include/FECore");
  write("sdk/lib/cmake/FEBio/FEBioConfig.cmake", "");
  write("sdk/include/FECore/version.h", "");
  fs::create_directory(folder / "bin");
  fs::create_directory(folder / "tmp");
  const fs::path started = folder / "started";
  write("bin/cmake", fmt::format("#!/bin/sh\ntrap '' TERM\necho $$ >'{0}.part'\nmv '{0}.part' '{0}'\n"
                                 "while :; do sleep 0.1; done\n",
                                 started.string()));
  fs::permissions(folder / "bin/cmake", fs::perms::owner_all);
  const std::string path = ::getenv("PATH");
  const fs::path out = folder.string() + ".out", err = folder.string() + ".err";
  ::setenv("PATH", ((folder / "bin").string() + ":" + path).c_str(), 1);
  ::setenv("TMPDIR", (folder / "tmp").c_str(), 1);
  const pid_t child = start(folder, {"plugin-build", "sdk"}, out, err);
  ::setenv("PATH", path.c_str(), 1);
  ::unsetenv("TMPDIR");
  const auto now = [] { return std::chrono::steady_clock::now(); };
  const auto pause = [](int milliseconds) { std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds)); };
  for (const auto begin = now(); !fs::exists(started) && now() - begin < std::chrono::minutes(1);) pause(5);
  const pid_t cmake = std::atoi(file_text(started).c_str());
  ASSERT_GT(cmake, 0);
  ::kill(child, SIGINT);
  pause(300);
  EXPECT_EQ(::waitpid(child, nullptr, WNOHANG), 0);  // it waits
  // what has ended may still stand there as a zombie
  const auto runs = [](pid_t process) {
    const fs::path status = fmt::format("/proc/{}/status", process);
    return fs::exists(status) && file_text(status).find("State:\tZ") == std::string::npos;
  };
  EXPECT_TRUE(runs(cmake));
  ::kill(child, SIGINT);
  const auto asked = now();
  const Finished f = end_of(child, out, err);
  EXPECT_LT(now() - asked, std::chrono::seconds(3));  // before its patience with cmake is over
  EXPECT_EQ(f.code, 130) << f.err;
  EXPECT_NE(f.err.find("dea: stopped\n"), std::string::npos) << f.err;
  for (const auto begin = now(); runs(cmake) && now() - begin < std::chrono::seconds(5);) pause(5);
  EXPECT_FALSE(runs(cmake));  // nothing goes on behind our backs
}

TEST_F(Cli, ResultsDoNotDependOnThreads) {
  write_model("push.feb", -12.0);
  ASSERT_EQ(dea({"run", "push.feb", "-q", "--refine", "20", "--threads", "1", "-o", "a.xplt"}).code, 0);
  ASSERT_EQ(dea({"run", "push.feb", "-q", "--refine", "20", "--threads", "2", "-o", "b.xplt"}).code, 0);
  EXPECT_EQ(file_text(folder / "a.xplt"), file_text(folder / "b.xplt"));
}

/// Beside FEBio's own result of a hip: the same mesh, names and order, and a result in its neighbourhood.
TEST_F(Cli, ReferenceHipLiesBesideFebiosResult) {
  const fs::path reference = fs::path(DEA_REFERENCE_DIR) / "hip_walking.feb",
                 febio = fs::path(DEA_REFERENCE_DIR) / "hip_walking_febio_penalty20.xplt";
  if (!fs::exists(reference) || !fs::exists(febio)) GTEST_SKIP() << "no reference models";
  const Finished f = dea({"run", reference.string(), "-o", "hip.xplt", "--times-from", febio.string(), "--json", "-"});
  ASSERT_EQ(f.code, 0) << f.err;
  const XpltFile ours = read_xplt((folder / "hip.xplt").string()), theirs = read_xplt(febio.string());
  ASSERT_EQ(ours.states.size(), theirs.states.size());
  EXPECT_EQ(ours.states[0].time, theirs.states[0].time);
  const XpltMesh &a = ours.meshes[0], &b = theirs.meshes[0];
  EXPECT_EQ(a.node_ids, b.node_ids);
  EXPECT_EQ(a.coordinates, b.coordinates);
  EXPECT_EQ(a.parts, b.parts);
  EXPECT_EQ(a.element_sets, b.element_sets);
  ASSERT_EQ(a.domains.size(), b.domains.size());
  for (std::size_t d = 0; d < a.domains.size(); ++d) {
    EXPECT_EQ(a.domains[d].element_type, b.domains[d].element_type);
    EXPECT_EQ(a.domains[d].part, b.domains[d].part);
    EXPECT_EQ(a.domains[d].element_ids, b.domains[d].element_ids);
    EXPECT_EQ(a.domains[d].nodes, b.domains[d].nodes);
  }
  EXPECT_EQ(a.surfaces, b.surfaces);
  EXPECT_EQ(a.facet_sets.size(), b.facet_sets.size());
  EXPECT_EQ(a.objects, b.objects);
  for (const char* name : {"rigid force", "rigid position"}) {
    const auto& x = ours.states[0].variables[static_cast<std::size_t>(find_variable(ours, XpltGroup::Domain, name))];
    const auto& y =
        theirs.states[0].variables[static_cast<std::size_t>(find_variable(theirs, XpltGroup::Domain, name))];
    ASSERT_EQ(x.size(), y.size());
    for (std::size_t r = 0; r < x.size(); ++r) {
      EXPECT_EQ(x[r].region, y[r].region);
      // the same load to FEBio's own tolerance; a position within 0.1 mm, the softness of its penalty
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(x[r].values[k], y[r].values[k], std::string(name) == "rigid force" ? 0.01 : 0.1);
    }
  }
}

}  // namespace dea::cli_test

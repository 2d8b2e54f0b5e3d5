// Contacts of type dea inside febio4, against `dea run` on the model they were converted from.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "io/results/result_file.h"
#include "tests/plugin/febio_runs.h"

namespace dea::test {
namespace {

/// febio4's own solve with the plugin, and a linear solver that takes matrices without symmetry.
Finished solve(const fs::path& folder, const std::string& model, std::vector<std::string> before = {}) {
  write(folder / "febio.xml", fmt::format("<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>\n<febio_config "
                                          "version=\"3.0\"><import>{}</import><import>{}</import>"
                                          "<default_linear_solver type=\"sparse_lu\"></default_linear_solver>"
                                          "</febio_config>\n",
                                          DEA_DUMP_PLUGIN, DEA_PLUGIN));
  before.insert(before.end(), {DEA_FEBIO4, "-nosplash", "-config", "febio.xml", "-i", model});
  return run_program(folder, before, 300);
}

void convert(const fs::path& folder, const std::string& from, const std::string& to,
             std::vector<std::string> options = {}) {
  std::vector<std::string> words = {DEA_PROGRAM, "convert", from, "-o", to};
  words.insert(words.end(), options.begin(), options.end());
  const Finished f = run_program(folder, words, 60);
  ASSERT_EQ(f.code, 0) << f.err;
}

void replace(std::string& text, const std::string& old, const std::string& by) {
  const std::size_t place = text.find(old);
  ASSERT_NE(place, text.npos) << old;
  text.replace(place, old.size(), by);
}

/// Without the element <NAME>...</NAME>.
std::string without(std::string text, const std::string& name) {
  const std::size_t begin = text.find("<" + name);
  const std::string end = "</" + name + ">";
  return text.erase(begin, text.find(end, begin) + end.size() - begin);
}

struct Agreement {
  int states = 0, with_pressure = 0;
  double position = 0.0;  // largest difference of a centre of mass
  double rotation = 0.0;  // and of a rotation matrix' entry
  double pressure = 0.0;  // of a facet, relative to the state's peak
};

/// Every state of `b` beside the one of `a` at its time.
Agreement compare(const fs::path& a, const fs::path& b) {
  Agreement result;
  const ResultFile x = read_result(a.string(), "a"), y = read_result(b.string(), "b");
  for (int i = 0; i < static_cast<int>(x.xplt.states.size()); ++i) {
    const int j = find_state(y, x.xplt.states[static_cast<std::size_t>(i)].time);
    ++result.states;
    const std::vector<BodyPose> p = body_poses(x, i), q = body_poses(y, j);
    EXPECT_EQ(p.size(), q.size());
    for (const BodyPose& one : p)
      for (const BodyPose& other : q) {
        if (one.name != other.name || !one.rotation || !other.rotation) continue;
        result.position = std::max(result.position, (one.position - other.position).cwiseAbs().maxCoeff());
        result.rotation =
            std::max(result.rotation,
                     (one.rotation->toRotationMatrix() - other.rotation->toRotationMatrix()).cwiseAbs().maxCoeff());
      }
    const XpltMesh& mesh = mesh_of(x, i);
    for (int s = 0; s < static_cast<int>(mesh.surfaces.size()); ++s) {
      const int t = find_surface(y, j, mesh.surfaces[static_cast<std::size_t>(s)].name);
      if (t < 0) continue;
      const std::vector<double> u = facet_values(x, i, s, "contact pressure"),
                                v = facet_values(y, j, t, "contact pressure");
      EXPECT_EQ(u.size(), v.size());
      double peak = 0.0, largest = 0.0;
      for (std::size_t f = 0; f < u.size(); ++f) {
        peak = std::max(peak, v[f]);
        largest = std::max(largest, std::abs(u[f] - v[f]));
      }
      if (peak > 0) ++result.with_pressure;
      result.pressure = std::max(result.pressure, peak > 0 ? largest / peak : largest);
    }
  }
  return result;
}

/// Equilibrium iterations of each time step, in febio4's words.
std::vector<int> iterations_of(const std::string& log) {
  std::vector<int> iterations;
  for (const std::string& line : lines_of(log)) {
    if (line.find("beginning time step") != line.npos) iterations.push_back(0);
    if (!iterations.empty() && line.find("Nonlinear solution status") != line.npos) ++iterations.back();
  }
  return iterations;
}

/// The model's poses and pressures from febio4 against those of `dea run` on the model before.
/// `slack` times the usual tolerances.
void expect_the_same_equilibrium(const fs::path& folder, const std::string& model,
                                 const std::vector<std::string>& options = {}, double slack = 1) {
  SCOPED_TRACE(model);
  convert(folder, model, "converted.feb", options);
  const Finished f = solve(folder, "converted.feb");
  ASSERT_EQ(f.code, 0) << f.out.substr(f.out.size() < 4000 ? 0 : f.out.size() - 4000);
  std::vector<std::string> words = {DEA_PROGRAM,      "run",        model, "-o", "run.xplt", "--times-from",
                                    "converted.xplt", "--overwrite"};
  words.insert(words.end(), options.begin(), options.end());
  ASSERT_EQ(run_program(folder, words, 60).code, 0);
  const Agreement a = compare(folder / "converted.xplt", folder / "run.xplt");
  EXPECT_GT(a.with_pressure, 0);
  EXPECT_LE(a.position, 1e-5 * slack);  // mm; plot files hold about 1e-6 of a coordinate
  EXPECT_LE(a.rotation, 1e-6 * slack);
  EXPECT_LE(a.pressure, 1e-4 * slack);
  const std::vector<int> iterations = iterations_of(f.out);
  const int most = iterations.empty() ? 0 : *std::max_element(iterations.begin(), iterations.end());
  EXPECT_LE(most, slack > 1 ? 15 : 12);
  std::cout << fmt::format("{}: {} states, position {:.1e}, rotation {:.1e}, pressure {:.1e}, at most {} iterations\n",
                           model, a.states, a.position, a.rotation, a.pressure, most);
}

TEST(ContactDea, SamplesAsDeaRunSolvesThem) {
  const TemporaryFolder folder;
  for (const fs::path& model : models_in(DEA_SAMPLES_DIR)) {
    if (model.stem() == "menisci") continue;  // parts that give way are not converted (words.py)
    fs::copy(model, folder.path / model.filename());
    // FEBio's own tolerance lets the knee's bones rest 3 micrometres from where they balance
    expect_the_same_equilibrium(folder.path, model.filename().string(), {}, model.stem() == "knee" ? 500 : 1);
  }
}

/// The sample with a sphere on a flat layer, the sphere in two halves: each has a contact with the whole layer.
/// `layer_first`: it is the primary one, and carries the springs.
std::string two_halves_on_one_layer(bool layer_first) {
  std::string text = file_text(fs::path(DEA_SAMPLES_DIR) / "sphere_on_flat" / "sphere_on_flat.feb");
  const std::size_t begin = text.find("<Surface name=\"sphere_articular\">"), end = text.find("</Surface>", begin) + 11;
  std::vector<std::string> lines = lines_of(text.substr(begin, end - begin));
  const std::size_t facets = lines.size() - 2;
  std::string halves, pairs;
  for (const bool second : {false, true}) {
    const std::string name = second ? "right" : "left";
    halves += "<Surface name=\"" + name + "\">\n";
    for (std::size_t f = 0; f < facets / 2; ++f) halves += lines[1 + f + (second ? facets / 2 : 0)] + "\n";
    halves += "</Surface>\n";
    pairs += fmt::format("<SurfacePair name=\"{0}\"><primary>{1}</primary><secondary>{2}</secondary></SurfacePair>\n",
                         name, layer_first ? "base_articular" : name, layer_first ? name : "base_articular");
  }
  text.replace(begin, end - begin, halves);
  const std::size_t pair = text.find("<SurfacePair name=\"joint\">"), after = text.find("</SurfacePair>", pair) + 15;
  text.replace(pair, after - pair, pairs);
  const std::size_t contact = text.find("<contact name=\"joint\""), last = text.find("</contact>", contact) + 11;
  const std::string one = text.substr(contact, last - contact);
  std::string contacts;
  for (const char* name : {"left", "right"}) {
    std::string of = one;
    replace(of, "name=\"joint\"", fmt::format("name=\"{}\"", name));
    replace(of, "surface_pair=\"joint\"", fmt::format("surface_pair=\"{}\"", name));
    contacts += of;
  }
  text.replace(contact, last - contact, contacts);
  return text;
}

// Contacts that press one layer are one problem there, too.
TEST(ContactDea, ContactsThatShareALayerAsDeaRunSolvesThem) {
  const TemporaryFolder folder;
  for (const bool layer_first : {true, false}) {
    write(folder.path / "shared.feb", two_halves_on_one_layer(layer_first));
    expect_the_same_equilibrium(folder.path, "shared.feb");
  }
}

/// A socket turned by 10 degrees: febio4 on the model that was written turned, `dea run` on the model as it was.
TEST(ContactDea, APlacedModelAsDeaRunSolvesIt) {
  const TemporaryFolder folder;
  fs::copy(fs::path(DEA_SAMPLES_DIR) / "hip" / "hip_walking.feb", folder.path / "hip.feb");
  const std::vector<std::string> turned = {"--rotate", "pelvis=0,1,0,10"};
  convert(folder.path, "hip.feb", "turned.feb", turned);
  const Finished f = solve(folder.path, "turned.feb");
  ASSERT_EQ(f.code, 0) << f.out.substr(f.out.size() < 4000 ? 0 : f.out.size() - 4000);
  std::vector<std::string> words = {DEA_PROGRAM, "run", "hip.feb", "-o", "run.xplt", "--times-from", "turned.xplt"};
  words.insert(words.end(), turned.begin(), turned.end());
  ASSERT_EQ(run_program(folder.path, words, 60).code, 0);
  const Agreement a = compare(folder.path / "turned.xplt", folder.path / "run.xplt");
  EXPECT_GT(a.with_pressure, 0);
  EXPECT_LE(a.position, 1e-5);
  EXPECT_LE(a.pressure, 1e-4);
  EXPECT_NEAR(a.rotation, std::sin(kPi / 18), 1e-5);  // of the pelvis: in the written model it is its reference
}

TEST(ContactDea, ReferenceModelsAsDeaRunSolvesThem) {
  const std::vector<fs::path> models = models_in(DEA_REFERENCE_DIR);
  if (models.empty()) GTEST_SKIP() << "no models in " << DEA_REFERENCE_DIR;
  const TemporaryFolder folder;
  for (const fs::path& model : models) {
    fs::copy(model, folder.path / model.filename());
    expect_the_same_equilibrium(folder.path, model.filename().string(), {});
  }
}

TEST(ContactDea, LawsSourceFacetsAndRefinement) {
  const TemporaryFolder folder;
  fs::copy(fs::path(DEA_SAMPLES_DIR) / "ligament" / "ligament.feb", folder.path / "ligament.feb");
  for (const std::vector<std::string>& options :
       std::vector<std::vector<std::string>>{{"--law", "neo-Hookean"},
                                             {"--law", "layer"},
                                             {"--law", "logarithmic", "--facets", "flat"},
                                             {"--source", "femur"},
                                             {"--refine", "2"}})
    expect_the_same_equilibrium(folder.path, "ligament.feb", options);
}

TEST(ContactDea, EveryVersionAndQuadraticElements) {
  const TemporaryFolder folder;
  Parts pushed;  // a force instead of a given motion, so that there is something to solve
  pushed.motion =
      "<rigid_load name=\"push\" type=\"rigid_force\"><rb>plate</rb><dof>Rz</dof><value "
      "lc=\"1\">-5</value></rigid_load>";
  for (const bool quadratic : {false, true}) {
    write(folder.path / "m25.feb", model_25(quadratic));
    write(folder.path / "m30.feb", model_30(quadratic));
    write(folder.path / "m40.feb", model_40(quadratic, pushed));
    for (const char* model : {"m25.feb", "m30.feb", "m40.feb"}) expect_the_same_equilibrium(folder.path, model);
  }
}

/// The stiffness is the derivative of the forces but for one thing: it holds what of the target's triangles each foot
/// covers. So FEBio's Newton method gains at least two digits with each iteration (FEBio prints norms squared).
TEST(ContactDea, NewtonsMethodIsFast) {
  const TemporaryFolder folder;
  fs::copy(fs::path(DEA_SAMPLES_DIR) / "spheres" / "two_layers.feb", folder.path / "m.feb");
  convert(folder.path, "m.feb", "converted.feb");
  const Finished f = solve(folder.path, "converted.feb");
  ASSERT_EQ(f.code, 0);
  std::vector<double> norms;  // of the first time step
  for (const std::string& line : lines_of(f.out)) {
    if (line.find("beginning time step 2") != line.npos) break;
    std::istringstream words(line);
    std::string word;
    double first, now, required;
    if (!(words >> word >> first >> now >> required) || word != "residual") continue;
    if (norms.empty()) norms.push_back(first);
    norms.push_back(now);
  }
  ASSERT_GE(norms.size(), 4u);
  for (std::size_t i = 2; i < norms.size() && norms[i] > 1e-18 * norms[0]; ++i)
    EXPECT_LT(norms[i], 1e-4 * norms[i - 1]) << i;
  EXPECT_LT(norms.back(), 1e-18 * norms[0]);
}

/// "warning: contact "knee" [narrow-contact]" of each warning in these lines, which FEBio's log indents.
std::vector<std::string> warnings_of(const std::string& text) {
  std::vector<std::string> warnings;
  for (std::string line : lines_of(text)) {
    line.erase(0, line.find_first_not_of(' '));
    if (line.rfind("warning: ", 0) == 0)
      warnings.push_back(line.substr(0, line.find(':', 9)) + " " + line.substr(line.rfind('[')));
  }
  std::sort(warnings.begin(), warnings.end());
  return warnings;
}

/// What `dea run` finds in the results, once, behind FEBio's last step.
TEST(ContactDea, TellsOfResultsWhatDeaRunTells) {
  const TemporaryFolder folder;
  for (const char* name : {"knee/knee.feb", "spheres/two_layers.feb"}) {
    fs::copy(fs::path(DEA_SAMPLES_DIR) / name, folder.path / "m.feb", fs::copy_options::overwrite_existing);
    convert(folder.path, "m.feb", "converted.feb", {"--overwrite"});
    const Finished f = solve(folder.path, "converted.feb");
    ASSERT_EQ(f.code, 0);
    const Finished run = run_program(folder.path, {DEA_PROGRAM, "run", "m.feb", "--no-xplt"}, 60);
    EXPECT_EQ(warnings_of(f.out), warnings_of(run.err)) << name;
  }
}

/// Thickness as a number, and measured through the rigid cartilage: what `dea run` makes of the same file.
TEST(ContactDea, ThicknessGivenAndMeasured) {
  const TemporaryFolder folder;
  fs::copy(fs::path(DEA_SAMPLES_DIR) / "hip" / "hip_walking.feb", folder.path / "hip.feb");
  convert(folder.path, "hip.feb", "map.feb");
  std::string measured = file_text(folder.path / "map.feb");
  for (const char* side : {"primary_thickness", "secondary_thickness"}) measured = without(measured, side);
  write(folder.path / "measured.feb", measured);
  std::string constant = measured;
  replace(constant, "<primary_E>", "<primary_thickness>1.5</primary_thickness><primary_E>");
  replace(constant, "<secondary_E>", "<secondary_thickness>1.3</secondary_thickness><secondary_E>");
  write(folder.path / "constant.feb", constant);
  for (const std::string name : {"measured", "constant"}) {
    SCOPED_TRACE(name);
    const Finished f = solve(folder.path, name + ".feb");
    ASSERT_EQ(f.code, 0) << f.out.substr(0, 3000);
    EXPECT_NE(f.out.find(name == "measured" ? "mean 1.58179, measured" : "mean 1.5, given"), f.out.npos);
    const std::vector<std::string> reference =
        name == "measured" ? std::vector<std::string>{"hip.feb"} : std::vector<std::string>{"constant.feb"};
    ASSERT_EQ(run_program(folder.path,
                          {DEA_PROGRAM, "run", reference[0], "-o", "run.xplt", "--times-from", name + ".xplt"}, 60)
                  .code,
              0);
    const Agreement a = compare(folder.path / (name + ".xplt"), folder.path / "run.xplt");
    EXPECT_GT(a.with_pressure, 0);
    EXPECT_LE(a.position, 1e-5);
    EXPECT_LE(a.pressure, 1e-4);
  }
}

/// Without a type: what is no number is a map's name, here as in `dea run`.
TEST(ContactDea, ThicknessByAMapWhoseNameBeginsWithADigit) {
  const TemporaryFolder folder;
  write(folder.path / "m.feb", model_40(false));
  convert(folder.path, "m.feb", "converted.feb");
  std::string text = file_text(folder.path / "converted.feb");
  replace(text, "<SurfaceData name=\"top_thickness\"", "<SurfaceData name=\"3T_map\"");
  replace(text, " type=\"map\">top_thickness<", ">3T_map<");
  write(folder.path / "named.feb", text);
  const Finished f = solve(folder.path, "named.feb");
  EXPECT_EQ(f.code, 0) << f.out;
  EXPECT_NE(f.out.find("mean 2, given"), f.out.npos) << f.out;
  const Finished run = run_program(folder.path, {DEA_PROGRAM, "run", "named.feb", "--no-xplt"}, 60);
  EXPECT_EQ(run.code, 0) << run.err;
}

/// The task dea solves a converted model too, by the same statement of the contact.
TEST(ContactDea, TheTaskTakesTheContactsStatement) {
  const TemporaryFolder folder;
  write(folder.path / "m.feb", model_40(false));
  convert(folder.path, "m.feb", "converted.feb");
  ASSERT_EQ(febio(folder.path, "converted.feb", "dea").code, 0);
  ASSERT_EQ(run_program(folder.path, {DEA_PROGRAM, "run", "m.feb", "-o", "run.xplt"}, 60).code, 0);
  const Agreement a = compare(folder.path / "converted_dea.xplt", folder.path / "run.xplt");
  EXPECT_GT(a.with_pressure, 0);
  EXPECT_LE(a.pressure, 1e-6);
}

TEST(ContactDea, FillsPlotVariables) {
  const TemporaryFolder folder;
  write(folder.path / "m.feb", model_40(false));
  convert(folder.path, "m.feb", "converted.feb");
  ASSERT_EQ(solve(folder.path, "converted.feb").code, 0);
  ASSERT_EQ(
      run_program(folder.path, {DEA_PROGRAM, "run", "m.feb", "-o", "run.xplt", "--times-from", "converted.xplt"}, 60)
          .code,
      0);
  const XpltFile x = read_xplt((folder.path / "converted.xplt").string()),
                 y = read_xplt((folder.path / "run.xplt").string());
  for (const char* name : {"contact pressure", "contact gap", "contact force", "contact area", "cartilage thickness",
                           "joint space", "spring strain"}) {
    SCOPED_TRACE(name);
    const int i = find_variable(x, XpltGroup::Surface, name), j = find_variable(y, XpltGroup::Surface, name);
    ASSERT_GE(i, 0);
    ASSERT_GE(j, 0);
    EXPECT_EQ(x.variables[static_cast<std::size_t>(i)].format, y.variables[static_cast<std::size_t>(j)].format);
    const auto& a = x.states.back().variables[static_cast<std::size_t>(i)];
    const auto& b = y.states.back().variables[static_cast<std::size_t>(j)];
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t r = 0; r < a.size(); ++r) {
      ASSERT_EQ(a[r].values.size(), b[r].values.size());
      for (std::size_t k = 0; k < a[r].values.size(); ++k)
        EXPECT_NEAR(a[r].values[k], b[r].values[k], 1e-5f * (1 + std::abs(b[r].values[k]))) << r << " " << k;
    }
  }
}

/// A joint in front of the first ligament, by its start tag.
constexpr const char* kHinge =
    "<rigid_connector name=\"hinge\" type=\"rigid revolute joint\"><tolerance>0</tolerance><gaptol>1e-4</gaptol>"
    "<angtol>1e-4</angtol><force_penalty>1e4</force_penalty><moment_penalty>1e6</moment_penalty>"
    "<auto_penalty>0</auto_penalty><body_a>femur</body_a><body_b>tibia</body_b><joint_origin>0,0,25</joint_origin>"
    "<rotation_axis>0,1,0</rotation_axis><transverse_axis>1,0,0</transverse_axis><maxaug>50</maxaug>"
    "</rigid_connector>\n<rigid_connector ";

/// What a rigid joint bears comes after the contacts in FEBio's forces: with surfaces that it holds apart, Newton's
/// method must stay quadratic.
TEST(ContactDea, HeldApartByAJoint) {
  const TemporaryFolder folder;
  fs::copy(fs::path(DEA_SAMPLES_DIR) / "ligament" / "ligament.feb", folder.path / "m.feb");
  convert(folder.path, "m.feb", "converted.feb");
  std::string text = file_text(folder.path / "converted.feb");
  replace(text, "<rigid_connector ", kHinge);
  write(folder.path / "hinge.feb", text);
  const Finished f = solve(folder.path, "hinge.feb");
  ASSERT_EQ(f.code, 0) << f.out.substr(f.out.size() < 4000 ? 0 : f.out.size() - 4000);
  int iterations = 0;
  for (int i : iterations_of(f.out)) iterations += i;
  EXPECT_LE(iterations, 60);
}

/// A load away from the socket, carried by the ligaments: the springs have nothing to say, and say nothing.
TEST(ContactDea, ALoadThatOpensTheJoint) {
  const TemporaryFolder folder;
  std::string text = file_text(fs::path(DEA_SAMPLES_DIR) / "ligament" / "ligament.feb");
  replace(text, ">-300<", ">300<");
  write(folder.path / "m.feb", text);
  convert(folder.path, "m.feb", "converted.feb");
  const Finished f = solve(folder.path, "converted.feb");
  ASSERT_EQ(f.code, 0) << f.out.substr(f.out.size() < 4000 ? 0 : f.out.size() - 4000);
  ASSERT_EQ(
      run_program(folder.path, {DEA_PROGRAM, "run", "m.feb", "-o", "run.xplt", "--times-from", "converted.xplt"}, 60)
          .code,
      0);
  EXPECT_LE(compare(folder.path / "converted.xplt", folder.path / "run.xplt").position, 1e-5);
}

/// FEBio holds joints by penalties and multipliers, `dea run` exactly: the same pose within the gap FEBio is given.
TEST(ContactDea, JointsAgreeWithFebio) {
  struct Case {
    const char *type, *frame;
  };
  const Case cases[] = {
      {"rigid spherical joint", ""},
      {"rigid revolute joint", "<rotation_axis>0,1,0.2</rotation_axis><transverse_axis>1,0,0</transverse_axis>"},
      {"rigid prismatic joint", "<translation_axis>0.1,0,1</translation_axis><transverse_axis>0,1,0</transverse_axis>"},
      {"rigid cylindrical joint", "<joint_axis>0.1,0,1</joint_axis><transverse_axis>0,1,0</transverse_axis>"},
      {"rigid planar joint", "<rotation_axis>0,1,0</rotation_axis><translation_axis_1>1,0,0</translation_axis_1>"},
      {"rigid lock", "<first_axis>1,0,0</first_axis><second_axis>0,1,0</second_axis>"},
  };
  for (const Case& c : cases) {
    const TemporaryFolder folder;
    std::string text = file_text(fs::path(DEA_SAMPLES_DIR) / "ligament" / "ligament.feb");
    replace(text, "<rigid_connector ",
            fmt::format("<rigid_connector name=\"joint\" type=\"{}\"><tolerance>0</tolerance><gaptol>1e-6</gaptol>"
                        "<angtol>1e-7</angtol><force_penalty>1e4</force_penalty><moment_penalty>1e6</moment_penalty>"
                        "<auto_penalty>0</auto_penalty><body_a>tibia</body_a><body_b>femur</body_b>"
                        "<joint_origin>12,0,10</joint_origin>{}<maxaug>200</maxaug></rigid_connector>\n"
                        "<rigid_connector ",
                        c.type, c.frame));
    write(folder.path / "m.feb", text);
    convert(folder.path, "m.feb", "converted.feb");
    const Finished f = solve(folder.path, "converted.feb");
    ASSERT_EQ(f.code, 0) << c.type << f.out.substr(f.out.size() < 4000 ? 0 : f.out.size() - 4000);
    const Finished run =
        run_program(folder.path, {DEA_PROGRAM, "run", "m.feb", "-o", "run.xplt", "--times-from", "converted.xplt"}, 60);
    ASSERT_EQ(run.code, 0) << c.type << run.out << run.err;
    const Agreement a = compare(folder.path / "converted.xplt", folder.path / "run.xplt");
    std::cout << c.type << ": position within " << a.position << ", pressure within " << a.pressure << "\n";
    EXPECT_LE(a.position, 2e-5) << c.type;
  }
}

/// FEBio goes on from a dump file without Init.
TEST(ContactDea, GoesOnAfterARestart) {
  const TemporaryFolder folder;
  fs::copy(fs::path(DEA_SAMPLES_DIR) / "ligament" / "ligament.feb", folder.path / "m.feb");
  convert(folder.path, "m.feb", "converted.feb");
  ASSERT_EQ(solve(folder.path, "converted.feb").code, 0);  // writes febio.xml
  const auto febio4 = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {DEA_FEBIO4, "-nosplash", "-config", "febio.xml"});
    const Finished f = run_program(folder.path, words, 60);
    ASSERT_EQ(f.code, 0) << f.out;
  };
  std::string longer = file_text(folder.path / "converted.feb");
  replace(longer, "<time_steps>2</time_steps>\n<step_size>0.5</step_size>",
          "<time_steps>3</time_steps>\n<step_size>0.3333333333333333</step_size>");
  write(folder.path / "longer.feb", longer);
  febio4({"-i", "longer.feb", "-dump=1", "-dump_stride=2"});  // time 2/3
  fs::copy(folder.path / "longer.xplt", folder.path / "longer_whole.xplt");
  febio4({"-r", "longer.dmp"});
  const Agreement a = compare(folder.path / "longer.xplt", folder.path / "longer_whole.xplt");
  EXPECT_EQ(a.states, 5);  // FEBio appends to the four states of the run before
  EXPECT_GT(a.with_pressure, 0);
  EXPECT_LE(a.position, 1e-12);  // law layer starts its search afresh
  EXPECT_LE(a.pressure, 1e-9);
}

TEST(ContactDea, EveryFaultIsOneErrorAndAnExitCode) {
  const TemporaryFolder folder;
  write(folder.path / "m.feb", model_40(false));
  convert(folder.path, "m.feb", "good.feb");
  const std::string good = file_text(folder.path / "good.feb");
  const auto expect = [&](std::string text, const std::string& fault) {
    write(folder.path / "bad.feb", text);
    const Finished f = solve(folder.path, "bad.feb");
    EXPECT_EQ(f.code, 1) << fault << f.out;
    const std::vector<std::string> errors = errors_of(f.out);
    ASSERT_FALSE(errors.empty()) << fault << f.out;
    EXPECT_NE(errors.front().find(fault), std::string::npos) << errors.front();
  };
  // the cartilage is still deformable
  std::string deformable = good;
  replace(deformable, "<SolidDomain name=\"layer\" mat=\"base\"", "<SolidDomain name=\"layer\" mat=\"cartilage\"");
  expect(deformable, "belongs to no rigid body");
  expect(without(good, "primary_E"),
         "give them in the contact as <primary_E> and <primary_nu>, or with <E surface=\"top\">");
  std::string negative = without(good, "primary_thickness");
  replace(negative, "<primary_E>", "<primary_thickness type=\"math\">1+X</primary_thickness><primary_E>");
  expect(negative, "<primary_thickness> is given as type \"math\", expected a number or type \"map\"");
  std::string curve = good;
  replace(curve, "<primary_E>", "<primary_E lc=\"1\">");
  expect(curve, "<primary_E> follows a load controller");
  std::string thin = without(good, "primary_thickness");
  replace(thin, "<primary_E>", "<primary_thickness>-3</primary_thickness><primary_E>");
  expect(thin, "<primary_thickness>: found -3, need a thickness >= 0");
  // FEBio reads 11,85 as 11, and of a map that is missing it says std::exception
  const auto line_of = [](const std::string& text, const std::string& what) {
    return std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find(what)), '\n') + 1;
  };
  std::string comma = without(good, "primary_E");
  replace(comma, "<primary_nu>", "<primary_E>11,85</primary_E><primary_nu>");
  expect(comma, fmt::format("bad.feb:{}: contact \"touch\": <primary_E>: found \"11,85\", expected a number with a "
                            "decimal point",
                            line_of(comma, "11,85")));
  std::string nowhere = good;
  replace(nowhere, "<primary_E>", "<symmetry_planes>x:0</symmetry_planes><primary_E>");
  expect(nowhere, fmt::format("bad.feb:{}: contact \"touch\": <symmetry_planes>: found \"x:0\", expected planes across "
                              "axes, as in \"x=0, y=-12.5\"",
                              line_of(nowhere, "x:0")));
  std::string lost = without(good, "primary_thickness");
  replace(lost, "<primary_E>", "<primary_thickness type=\"map\">lost</primary_thickness><primary_E>");
  expect(lost, fmt::format("bad.feb:{}: contact \"touch\": <primary_thickness>: found \"lost\", expected the name of a "
                           "SurfaceData in MeshData (there: ",
                           line_of(lost, ">lost<")));
  const auto thickness = [&](const char* text) {
    std::string model = without(good, "primary_thickness");
    replace(model, "<primary_E>", fmt::format("<primary_thickness{}</primary_thickness><primary_E>", text));
    return model;
  };
  expect(thickness(" type=\"map\">1.8"), "<primary_thickness>: found \"1.8\", expected the name of a SurfaceData in");
  expect(thickness(" type=\"math\">0"), "<primary_thickness> is given as type \"math\", expected a number or type");
  expect(thickness(">1,8"), "<primary_thickness>: found \"1,8\", expected a number with a decimal point");
  expect(thickness(">3T"),
         "<primary_thickness>: found \"3T\", expected a number with a decimal point, or the name of a SurfaceData in");
  for (const char* refine : {"1e1", "2.5", "0", "1001"}) {
    std::string model = without(good, "refine");
    replace(model, "<primary_E>", fmt::format("<refine>{}</refine><primary_E>", refine));
    expect(model, fmt::format("<refine>: found \"{}\", expected a whole number from 1 to 1000", refine));
  }
  std::string doubled = good;
  const std::size_t begin = good.find("<contact "), end = good.find("</contact>") + 10;
  doubled.insert(end, good.substr(begin, end - begin));
  expect(doubled, "join the same surfaces at the same time");
  expect(without(good, "primary_nu"), "<primary_E> without <primary_nu>; give both");
  std::string same_body = good;
  replace(same_body, "<SolidDomain name=\"layer\" mat=\"base\"", "<SolidDomain name=\"layer\" mat=\"plate\"");
  expect(same_body, "no sliding contact joins two different bodies");
}

// The layer ends in x = 0 for a plane of symmetry: a plate that moves across it has a mirror image that moves the other
// way.
TEST(ContactDea, ABodyThatLeavesAPlaneOfSymmetryIsAFault) {
  const TemporaryFolder folder;
  Parts p;
  p.motion +=
      R"(<rigid_bc name="across" type="rigid_displacement"><rb>plate</rb><dof>x</dof><value lc="1">0.2</value></rigid_bc>)";
  std::string text = model_40(false, p);
  replace(text, "<rb>plate</rb><Rx_dof>1</Rx_dof>", "<rb>plate</rb>");
  replace(text, ">-1,-1,0.1<", ">0,-1,0.1<");  // the plate ends there, too, with three nodes
  replace(text, "-1,4,0.1</node>", "0,4,0.1</node><node id=\"23\">0,1.5,0.1</node><node id=\"24\">4,1.5,0.1</node>");
  replace(text, "<elem id=\"5\">19,20,21,22</elem>",
          "<elem id=\"5\">19,20,24,23</elem><elem id=\"6\">23,24,21,22</elem>");
  replace(text, "<quad4 id=\"1\">19,20,21,22</quad4>",
          "<quad4 id=\"1\">19,20,24,23</quad4><quad4 id=\"2\">23,24,21,22</quad4>");
  write(folder.path / "m.feb", text);
  convert(folder.path, "m.feb", "free.feb");
  std::string model = file_text(folder.path / "free.feb");
  EXPECT_EQ(solve(folder.path, "free.feb").code, 0);
  replace(model, "<primary_E>", "<symmetry_planes>x=0</symmetry_planes><primary_E>");
  write(folder.path / "half.feb", model);
  const Finished f = solve(folder.path, "half.feb");
  EXPECT_EQ(f.code, 1) << f.out;
  const std::vector<std::string> errors = errors_of(f.out);
  ASSERT_FALSE(errors.empty()) << f.out;
  EXPECT_NE(errors.front().find("contact \"touch\": the model ends in the plane of symmetry x = 0, and at time"),
            std::string::npos)
      << errors.front();
}

/// FEBio gives up in its own words ("NAN detected ..."); each contact says why in one warning, or nothing.
class SaysWhyFebioFindsNoBalance : public ::testing::Test {
 protected:
  static std::string load(const char* dof, const char* force) {
    return fmt::format(
        "<rigid_load name=\"push\" type=\"rigid_force\"><rb>plate</rb><dof>R{}</dof><value "
        "lc=\"1\">{}</value></rigid_load>",
        dof, force);
  }
  static std::string model(const std::string& motion) {
    Parts p;
    p.motion = motion;
    return model_40(false, p);
  }
  /// The plate's corners at `left` and `right` in z.
  static std::string placed(std::string text, const char* left, const char* right) {
    for (const char* z : {left, right, right, left}) replace(text, ",0.1</node>", fmt::format(",{}</node>", z));
    return text;
  }
  static std::string free_plate(std::string text, const char* dof) {
    const std::size_t plate = text.find("<rb>plate</rb>");
    const std::string held = fmt::format("<R{}_dof>1<", dof);
    return text.replace(text.find(held, plate), held.size(), fmt::format("<R{}_dof>0<", dof));
  }
  void expect(const std::string& model, const std::vector<std::string>& reasons) {
    expect_converted(converted(model), reasons);
  }
  /// Of few iterations.
  void expect_unfinished(const std::string& model, const std::vector<std::string>& reasons,
                         const std::string& iterations = "1", const std::string& stiffness = "non-symmetric") {
    std::string text = converted(model);
    replace(text, "<max_refs>30<", fmt::format("<max_refs>{}<", iterations));
    replace(text, ">non-symmetric<", fmt::format(">{}<", stiffness));
    expect_converted(text, reasons);
  }
  std::string converted(const std::string& model) {
    write(folder_.path / "m.feb", model);
    convert(folder_.path, "m.feb", "converted.feb", {"--overwrite", "--law", law_});
    return file_text(folder_.path / "converted.feb");
  }
  void expect_converted(const std::string& text, const std::vector<std::string>& reasons) {
    write(folder_.path / "converted.feb", text);
    const Finished f = solve(folder_.path, "converted.feb");
    EXPECT_EQ(f.code, 1) << f.out;
    expect_said(f.out, reasons);
  }
  static void expect_said(const std::string& out, const std::vector<std::string>& reasons) {
    std::vector<std::string> said;
    for (const std::string& warning : errors_of(out, "WARNING"))
      if (warning.find("FEBio found no balance") != warning.npos) said.push_back(warning);
    ASSERT_EQ(said.size(), reasons.size()) << out.substr(out.size() < 4000 ? 0 : out.size() - 4000);
    for (std::size_t i = 0; i < said.size(); ++i) EXPECT_NE(said[i].find(reasons[i]), said[i].npos) << said[i];
  }

  const TemporaryFolder folder_;
  std::string law_ = "layer";
};

TEST_F(SaysWhyFebioFindsNoBalance, TheLoadOpensTheJoint) {
  expect(model(load("z", "5")), {"at time 0.25: the load opens the joint, and springs do not pull;"});
  std::string away = model(load("z", "-5"));
  replace(away, "<point>1,1</point>", "<point>0.5,1</point><point>1,-1</point>");
  expect(away, {"at time 1: the load opens the joint after time 0.75, and springs do not pull;"});
  // from a dump file of time 0.75
  for (const std::vector<std::string>& model :
       {std::vector<std::string>{"-i", "converted.feb", "-dump=1"}, std::vector<std::string>{"-r", "converted.dmp"}}) {
    std::vector<std::string> words = {DEA_FEBIO4, "-nosplash", "-config", "febio.xml"};
    words.insert(words.end(), model.begin(), model.end());
    const Finished f = run_program(folder_.path, words, 60);
    expect_said(f.out, {"at time 1: the load opens the joint after time 0.75, and springs do not pull;"});
  }
}

/// The base is pushed up against the plate: stiffness times its way is no load.
TEST_F(SaysWhyFebioFindsNoBalance, APrescribedMotionIsNoLoad) {
  std::string pushed = placed(model(load("z", "-1")), "-0.02", "-0.02");
  replace(pushed, "<rb>base</rb><Rx_dof>1</Rx_dof><Ry_dof>1</Ry_dof><Rz_dof>1</Rz_dof>",
          "<rb>base</rb><Rx_dof>1</Rx_dof><Ry_dof>1</Ry_dof>");
  replace(pushed, "<Rigid>",
          "<Rigid><rigid_bc name=\"up\" type=\"rigid_displacement\"><rb>base</rb><dof>z</dof><value "
          "lc=\"1\">0.8</value></rigid_bc>");
  expect_unfinished(pushed, {"at time 0.25: 8 of 8 springs carry pressure, strained up to 0."});
  expect_unfinished(pushed, {"try smaller time steps (step_size) or more iterations (max_refs)"});
  expect_unfinished(pushed, {"set symmetric_stiffness to non-symmetric, with a linear solver that takes it"}, "1",
                    "symmetric");
}

TEST_F(SaysWhyFebioFindsNoBalance, SurfacesApart) {
  expect(free_plate(model(load("z", "-5")), "x"), {"the surfaces do not touch, so that no spring holds the bodies;"});
}

/// Pushed aside until nothing lies under it.
TEST_F(SaysWhyFebioFindsNoBalance, LostAgain) {
  const std::string aside =
      "<rigid_bc name=\"aside\" type=\"rigid_displacement\"><rb>plate</rb><dof>x</dof><value "
      "lc=\"1\">80</value></rigid_bc>";
  std::string text = placed(model(aside + load("z", "-1")), "-0.02", "-0.02");
  replace(text, "<rb>plate</rb><Rx_dof>1</Rx_dof>", "<rb>plate</rb>");
  expect(text, {"at time 0.25: the bodies met, and Newton's method lost them again; check thickness"});
}

TEST_F(SaysWhyFebioFindsNoBalance, LooseMotions) {
  expect(placed(free_plate(model(load("z", "-5")), "x"), "-0.1", "-0.1"),
         {"its springs resist 1 of 2 free motions of the bodies, and little or nothing the other 1"});
  // a plate with springs that is all but level, pulled along: 0.01 % of the load opens the joint
  for (const char* force : {"5", "-5"}) {
    const std::string along = free_plate(free_plate(model(load("x", force)), "x"), "y");
    std::string text = converted(placed(along, "-0.1001", "-0.0996"));
    replace(text, "<source>primary<", "<source>secondary<");
    replace(text, ">non-symmetric<", ">symmetric<");
    replace(text, "<solver type=\"solid\">", "<solver type=\"solid\"><linear_solver type=\"skyline\"/>");  // solves on
    expect_converted(text, {"its springs resist 1 of 3 free motions of the bodies"});
  }
}

TEST_F(SaysWhyFebioFindsNoBalance, TooDeep) {
  expect(model(load("z", "-2000")),
         {"on the way 8 of 8 springs were strained beyond 0.9; check thickness, E, the load"});
}

/// Springs do not resist sliding, but here ligaments do: FEBio's equations have a solution.
TEST_F(SaysWhyFebioFindsNoBalance, HeldByLigaments) {
  expect_unfinished(file_text(fs::path(DEA_SAMPLES_DIR) / "ligament" / "ligament.feb"),
                    {" springs carry pressure, strained up to"});
  std::string knee = file_text(fs::path(DEA_SAMPLES_DIR) / "knee" / "knee.feb");
  replace(knee, "<max_retries>10<", "<max_retries>0<");
  expect_unfinished(knee, std::vector<std::string>(4, " springs carry pressure, strained up to"), "2");
}

/// Two compartments under one plate, of which one is lifted off.
TEST_F(SaysWhyFebioFindsNoBalance, ACompartmentThatIsLiftedOff) {
  law_ = "linear";  // to the layer law, cartilage ends where its contact surface does
  const std::vector<std::string> top = lines_of(block(false).top);
  const auto compartment = [&](const char* name, int first) {
    return fmt::format(
        "<Surface name=\"{0}\">{1}{2}</Surface><SurfacePair name=\"{0}\"><primary>{0}</primary>"
        "<secondary>under</secondary></SurfacePair>",
        name, top.at(static_cast<std::size_t>(first)), top.at(static_cast<std::size_t>(first + 2)));
  };
  Parts p;
  p.motion = load("z", "-1");
  p.more_mesh = compartment("left", 0) + compartment("right", 1);
  std::string text = placed(model_40(false, p), "-0.2", "0.3");
  replace(text, "name=\"touch\" type=\"sliding-elastic\" surface_pair=\"pair\"",
          "name=\"left\" type=\"sliding-elastic\" surface_pair=\"left\"");
  replace(text, "</contact>",
          "</contact><contact name=\"right\" type=\"sliding-elastic\" surface_pair=\"right\"></contact>");
  expect_unfinished(text, {"contact \"left\": FEBio found no balance at time 0.25: 2 of 4 springs carry"});
}

/// Something else fails, and the contact's bodies cannot move.
TEST_F(SaysWhyFebioFindsNoBalance, BothBodiesHeld) {
  for (const char* way : {"-0.3", "0.3"}) {
    std::string text =
        model(fmt::format("<rigid_bc name=\"down\" type=\"rigid_displacement\"><rb>plate</rb><dof>z</dof><value "
                          "lc=\"1\">{}</value></rigid_bc><rigid_bc name=\"l\" type=\"rigid_fixed\"><rb>lone</rb>"
                          "<Ru_dof>1</Ru_dof><Rv_dof>1</Rv_dof><Rw_dof>1</Rw_dof></rigid_bc><rigid_load name=\"push\" "
                          "type=\"rigid_force\"><rb>lone</rb><dof>Rx</dof><value lc=\"1\">1</value></rigid_load>",
                          way));
    replace(text, "</Material>",
            "<material id=\"4\" name=\"lone\" type=\"rigid body\"><density>1</density><center_of_mass>20,0,0"
            "</center_of_mass></material></Material>");
    replace(text, "</Nodes>",
            "<node id=\"901\">19,0,0</node><node id=\"902\">21,0,0</node><node id=\"903\">21,1,0</node><node "
            "id=\"904\">19,1,0</node></Nodes>");
    replace(text, "<NodeSet",
            "<Elements type=\"quad4\" name=\"lone\"><elem id=\"90\">901,902,903,904</elem></Elements><NodeSet");
    replace(
        text, "</MeshDomains>",
        "<ShellDomain name=\"lone\" mat=\"lone\"><shell_thickness>0.5</shell_thickness></ShellDomain></MeshDomains>");
    expect(text, {});
  }
}

/// Ctrl-C leads to FEBio's prompt, and quit ends its solve: nothing has failed.
TEST_F(SaysWhyFebioFindsNoBalance, NotAtTheUsersQuit) {
  fs::copy(fs::path(DEA_SAMPLES_DIR) / "hip" / "hip_walking.feb", folder_.path / "m.feb");
  convert(folder_.path, "m.feb", "converted.feb", {"--refine", "2", "--linear-solver", "skyline"});
  const std::string script = fmt::format(
      "mkfifo typed; '{}' -nosplash -i converted.feb -import '{}' <typed >out & febio=$!; exec 3>typed; until grep -q "
      "'beginning time step 12' out; do kill -0 $febio || exit 98; sleep 0.02; done; kill -INT $febio; echo quit >&3; "
      "wait $febio",
      DEA_FEBIO4, DEA_PLUGIN);
  EXPECT_EQ(run_program(folder_.path, {"/bin/sh", "-c", script}, 300).code, 1);
  const std::string out = file_text(folder_.path / "out");
  EXPECT_NE(out.find("febio>"), out.npos) << out.substr(out.size() < 4000 ? 0 : out.size() - 4000);
  expect_said(out, {});
}

/// Newton's method may throw a body anywhere: the step is given up, febio4 does not crash.
TEST(ContactDea, ABodyThrownFarAway) {
  const fs::path model = fs::path(DEA_CORPUS_DIR) / "v3.0" / "co56.feb";  // a cylinder pressed through its layer
  if (!fs::exists(model)) GTEST_SKIP() << "no " << model;
  const TemporaryFolder folder;
  fs::copy(model, folder.path / "m.feb");
  convert(folder.path, "m.feb", "converted.feb", {"--law", "linear"});
  const Finished f = solve(folder.path, "converted.feb");
  EXPECT_EQ(f.code, 1);
  EXPECT_NE(f.out.find("E R R O R   T E R M I N A T I O N"), f.out.npos);
}

TEST(ContactDea, NoMemoryFaults) {
  const std::string valgrind = DEA_VALGRIND;
  if (valgrind.find("NOTFOUND") != valgrind.npos) GTEST_SKIP() << "no valgrind";
  const TemporaryFolder folder;
  Parts pushed;
  pushed.motion =
      "<rigid_load name=\"push\" type=\"rigid_force\"><rb>plate</rb><dof>Rz</dof><value "
      "lc=\"1\">-5</value></rigid_load>";
  write(folder.path / "m.feb", model_40(true, pushed));
  convert(folder.path, "m.feb", "converted.feb");
  write(folder.path / "bad.feb", without(file_text(folder.path / "converted.feb"), "primary_E"));
  for (const char* model : {"converted.feb", "bad.feb"}) {
    solve(folder.path, model,
          {valgrind, "--leak-check=full", "--show-leak-kinds=definite", "--num-callers=40", "--log-file=memory.log"});
    const std::string log = file_text(folder.path / "memory.log");
    EXPECT_NE(log.find("ERROR SUMMARY"), log.npos) << log;
    EXPECT_EQ(memory_faults(log), std::vector<std::string>{}) << model;
  }
}

}  // namespace
}  // namespace dea::test

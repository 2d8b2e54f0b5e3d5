// What is told of numbers that no joint has: one line each, and none for joints.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "io/feb/read_feb.h"
#include "io/settings/settings_xml.h"
#include "src/base/numbers.h"
#include "src/rules/rules.h"
#include "src/run/analysis.h"
#include "src/run/states.h"
#include "tests/findings.h"
#include "tests/src/test_models.h"

namespace dea::plausibility_test {

using Lines = std::vector<std::string>;

Lines told(JointModel model, double E, const std::string& units, double length = 1.0) {
  for (Vector3d& x : model.nodes) x *= length;
  for (Material& m : model.materials)
    if (!m.rigid) m.E = E;
  model.units = units;
  Findings odd;
  for (const Finding& f : model_findings(model, make_joint(model, {})))
    if (f.code == "odd-units" || f.code == "thick-on-its-radius") odd.push_back(f);
  return dea::lines(odd, command_line_wording());
}

bool has(const Lines& lines, const std::string& text) {
  for (const std::string& line : lines)
    if (line.find(text) != std::string::npos) return true;
  return false;
}

// 12 MPa on 40 mm, written in each system as it should be: nothing is odd.
TEST(Plausibility, AJointIsPlausibleInEverySystemOfUnits) {
  const JointModel plates = test::flat_plates(4, 40, 2, 0.0);
  EXPECT_EQ(told(plates, 12, ""), Lines());
  EXPECT_EQ(told(plates, 12, "mm-N-s"), Lines());
  EXPECT_EQ(told(plates, 12e3, "mm-kg-s"), Lines());
  EXPECT_EQ(told(plates, 12e3, ""), Lines());
  EXPECT_EQ(told(plates, 12e6, "SI", 1e-3), Lines());
  EXPECT_EQ(told(plates, 12e6, "", 1e-3), Lines());
  EXPECT_EQ(told(plates, 12e7, "CGS", 0.1), Lines());
  EXPECT_EQ(told(plates, 1, "", 1 / 40.0), Lines());  // a block of size 1
}

TEST(Plausibility, MixedUnitsAreToldOnce) {
  const JointModel plates = test::flat_plates(4, 40, 2, 0.0);
  const Lines pascals = told(plates, 12e6, "");
  ASSERT_EQ(pascals.size(), 1u);
  EXPECT_TRUE(has(pascals, "as if E in Pa and lengths in mm")) << pascals[0];
  EXPECT_TRUE(has(told(plates, 12e6, "mm-N-s"), "E = 1.2e+07 is 1.2e+07 MPa in the model's units, mm-N-s"));
  EXPECT_TRUE(has(told(plates, 12, "", 1e-3), "as if E in MPa and lengths in m"));
  EXPECT_TRUE(has(told(plates, 12, "SI", 1e-3), "E = 12 is 1.2e-05 MPa"));
  EXPECT_TRUE(has(told(plates, 12e6, "SI"), "m in the model's units, SI: check the units"));
  EXPECT_EQ(told(test::concentric_spheres(6, 100, true), 12e6, "").size(), 1u);  // two layers
}

// A ball of radius 4, the outer `thick` of it cartilage, under a plate.
JointModel thick_ball(double thick) {
  JointModel model = test::empty_model();
  const int cartilage = test::add_material(model, "cartilage", false), ball = test::add_material(model, "ball", true),
            plate = test::add_material(model, "plate", true);
  const int a = test::add_layer(
      model, "ball articular", 8, 8, 1, [thick](double u, double v) { return test::hemisphere(4.0 - thick, u, v); },
      [](double u, double v) { return test::hemisphere(4.0, u, v); }, cartilage, ball);
  const int b = test::add_rigid_surface(
      model, "plate", 4, 4, [](double u, double v) { return Vector3d(20 * (v - 0.5), 20 * (u - 0.5), 4.0); }, plate);
  test::add_contact(model, "press", a, b);
  return model;
}

TEST(Plausibility, ALayerThickOnItsBallIsToldAndAPlaneHasNoRadius) {
  EXPECT_TRUE(has(told(thick_ball(3.0), 12, "mm-N-s"), " times the radius of its sphere, 4:"));
  EXPECT_TRUE(has(told(thick_ball(1.2), 12, "mm-N-s"), "is 0.3 times the radius of its sphere, 4:"));
  EXPECT_FALSE(has(told(thick_ball(0.8), 12, "mm-N-s"), "radius"));
  EXPECT_FALSE(has(told(test::concentric_spheres(6, 100), 12, ""), "radius"));
  EXPECT_FALSE(has(told(test::flat_plates(2, 4, 3.9, 0.0), 12, ""), "radius"));
}

/// Half of a ball of radius 40, pressed 0.5 deep into half of a layer of 2: both end in the plane x = 0. `held`: there
/// the layer's nodes are held in x.
JointModel half_ball(bool held) {
  JointModel model = test::empty_model();
  const int cartilage = test::add_material(model, "cartilage", false), base = test::add_material(model, "base", true),
            ball = test::add_material(model, "ball", true);
  const auto flat = [](double z) { return [z](double u, double v) { return Vector3d(12 * u, 24 * (v - 0.5), z); }; };
  const int a = test::add_layer(model, "layer", 12, 12, 2, flat(-2), flat(0), cartilage, base);
  const int b = test::add_rigid_surface(
      model, "ball", 24, 24,
      [](double u, double v) {
        const double x = 12 * v, y = 24 * (u - 0.5);
        return Vector3d(x, y, 40 - std::sqrt(1600 - x * x - y * y));
      },
      ball);
  test::add_contact(model, "press", a, b);
  test::fix(model, base, {true, true, true, true, true, true});
  test::fix(model, ball, {true, true, false, true, true, true});
  test::prescribe(model, ball, 2, -0.5);
  if (!held) return model;
  FixedNodes plane;
  plane.xyz[0] = true;
  for (std::size_t i = 0; i < model.nodes.size(); ++i)
    if (model.nodes[i].x() == 0) plane.nodes.push_back(static_cast<int>(i));
  model.fixed_nodes.push_back(plane);
  return model;
}

// Half a joint whose cut is not held looks like a joint that ends there; two plates of one size are no half.
TEST(Plausibility, ACutThatIsNotHeldIsWarnedOf) {
  const std::string cut = "both surfaces end in the plane x = 0 under pressure";
  const JointModel free = half_ball(false), held = half_ball(true);
  EXPECT_TRUE(has(dea::lines(warnings(test::findings_of(free, analyse(free, test::linear())))), cut));
  EXPECT_FALSE(has(dea::lines(test::findings_of(held, analyse(held, test::linear()))), "both surfaces end"));
  JointModel plates = test::flat_plates(4, 4, 2, 0.0, 4);
  test::fix(plates, 2, {true, true, false, true, true, true});
  test::prescribe(plates, 2, 2, -0.2);
  EXPECT_FALSE(has(dea::lines(test::findings_of(plates, analyse(plates, test::linear()))), "both surfaces end"));
}

/// A ball of radius 40 over a layer of 2, whose facets are 2.4 long, pressed `depth` deep: the surfaces as they were
/// meet within sqrt(2 R depth) of the middle.
JointModel ball_on_long_facets(double depth) {
  JointModel model = test::empty_model();
  const int cartilage = test::add_material(model, "cartilage", false), base = test::add_material(model, "base", true),
            ball = test::add_material(model, "ball", true);
  const auto flat = [](double z) {
    return [z](double u, double v) { return Vector3d(36 * (u - 0.5), 36 * (v - 0.5), z); };
  };
  const int a = test::add_layer(model, "layer", 15, 15, 2, flat(-2), flat(0), cartilage, base);
  const int b = test::add_rigid_surface(
      model, "ball", 120, 120,
      [](double u, double v) {
        const double x = 36 * (v - 0.5), y = 36 * (u - 0.5);
        return Vector3d(x, y, 40 - std::sqrt(1600 - x * x - y * y));
      },
      ball);
  test::add_contact(model, "press", a, b);
  test::fix(model, base, {true, true, true, true, true, true});
  test::fix(model, ball, {true, true, false, true, true, true});
  test::prescribe(model, ball, 2, -depth);
  return model;
}

// Long facets are no fault by themselves: what counts is how many of them contact is wide (docs/layer_law.md, 4).
TEST(Plausibility, LongFacetsAreOnlyWarnedOfWhereContactIsNarrow) {
  const JointModel narrow = ball_on_long_facets(0.1), wide = ball_on_long_facets(1.0);
  for (const JointModel& model : {narrow, wide}) {
    const Lines lines = dea::lines(model_findings(model, make_joint(model, {})));
    EXPECT_TRUE(has(lines, "note: contact \"press\": facets are long against the cartilage's thickness (1.2 on"));
    EXPECT_FALSE(has(lines, "warning: "));
  }
  EXPECT_TRUE(
      has(dea::lines(warnings(test::findings_of(narrow, analyse(narrow, {})))), "facets wide on surface \"layer\""));
  EXPECT_FALSE(has(dea::lines(test::findings_of(wide, analyse(wide, {}))), "facets wide"));
  Settings finer;  // what the warning asks for ends it
  finer.refine = 3;
  EXPECT_FALSE(has(dea::lines(test::findings_of(narrow, analyse(narrow, finer))), "facets wide"));
}

/// The largest strain is (d / h) everywhere (S2): 0.6.
TEST(Plausibility, StrainsAboveOneHalfAreTold) {
  JointModel model = test::flat_plates(8, 10, 2, 0.0);
  test::fix(model, 2, {true, true, false, true, true, true});
  test::prescribe(model, 2, 2, -1.2);
  const Lines lines = dea::lines(test::findings_of(model, analyse(model, test::linear())));
  EXPECT_TRUE(has(lines, "at time 1 cartilage is pressed together by 60% of its thickness"));
  model.rigid_prescribed.back().value.factor = -0.8;
  EXPECT_FALSE(has(dea::lines(test::findings_of(model, analyse(model, test::linear()))), "pressed together"));
}

// A layer of 2: springs look 8 deep. A plate that is moved by 9 is behind them; one that stays away is not.
TEST(Plausibility, BodiesThatPassedEachOtherAreTold) {
  JointModel model = test::flat_plates(8, 10, 2, 0.0);
  test::fix(model, 2, {true, true, false, true, true, true});
  test::prescribe(model, 2, 2, -9.0);
  EXPECT_TRUE(has(dea::lines(test::findings_of(model, analyse(model, test::linear()))),
                  "at time 1 the surfaces have passed through"));
  model.rigid_prescribed.back().value.factor = 9.0;
  const Lines apart = dea::lines(test::findings_of(model, analyse(model, test::linear())));
  EXPECT_FALSE(has(apart, "passed through"));
  model.rigid_prescribed.back().value.factor = -1.0;
  EXPECT_FALSE(has(dea::lines(test::findings_of(model, analyse(model, test::linear()))), "passed through"));
}

// A plate presses 128 springs alike: 116 of them carry nine tenths. With one node of it 0.5 lower than the rest, which
// hardly touches, the few facets around that node carry it all.
TEST(Plausibility, AForceOnAHandfulOfSpringsIsTold) {
  JointModel model = test::flat_plates(8, 10, 2, 0.0);
  test::fix(model, 2, {true, true, false, true, true, true});
  test::prescribe(model, 2, 2, -0.01);
  const Analysis even = analyse(model, test::linear());
  EXPECT_EQ(even.states.back().statistics[0].springs_most, 116);
  EXPECT_FALSE(has(dea::lines(test::findings_of(model, even)), "nine tenths"));
  for (std::size_t i = 0; i < model.nodes.size(); ++i)  // the plate's middle node: the last such
    if (model.nodes[i].head<2>().norm() < 1e-9 && i + 82 > model.nodes.size()) model.nodes[i].z() -= 0.5;
  model.rigid_prescribed.back().value.factor = -0.0005;
  const Analysis pointed = analyse(model, test::linear("plate"));
  const ContactStatistics& s = pointed.states.back().statistics[0];
  EXPECT_LT(s.springs_most, 8);
  EXPECT_TRUE(has(dea::lines(test::findings_of(model, pointed)), "springs carry nine tenths of the force"));
  EXPECT_EQ(s.springs_active, 128);
}

/// A block of 8 mm presses 4 x 4 facets of 2 mm, and all of each: map and springs agree. One of 3 mm presses 9/16 of
/// each of four facets, and nothing in the map says so: their area is 16 mm2, the mean 9/16 of what the springs see,
/// which are finer.
TEST(Plausibility, AMapTooCoarseForItsContactIsTold) {
  const auto pressed = [](double block) {
    JointModel model = test::flat_plates(10, 20, 2, 0.0, block);
    test::fix(model, 2, {true, true, false, true, true, true});
    test::prescribe(model, 2, 2, -0.01);
    Settings settings = test::linear();
    settings.refine = 8;
    const Analysis analysis = analyse(model, settings);
    return std::pair(analysis.states.back().statistics[0], dea::lines(test::findings_of(model, analysis)));
  };
  const auto [s, quiet] = pressed(8.0);
  EXPECT_NEAR(s.contact_area, 64.0, 1e-9);
  EXPECT_NEAR(s.headline.area, 64.0, 1e-4);
  EXPECT_NEAR(s.headline.mean / s.mean, 1.0, 1e-6);
  EXPECT_FALSE(has(quiet, "too long for this contact's map"));
  const auto [coarse, lines] = pressed(3.0);
  EXPECT_NEAR(coarse.headline.area, 16.0, 1e-4);
  EXPECT_NEAR(coarse.headline.mean / coarse.mean, coarse.contact_area / 16.0, 1e-6);
  EXPECT_NEAR(coarse.contact_area, 9.0, 1.0);  // of springs 0.25 long, whole ones
  EXPECT_TRUE(has(lines, "their averages give area 16, ")) << lines.back();
  EXPECT_TRUE(has(lines, "the springs themselves ")) << lines.back();
}

/// A force of the model along a motion that the model prescribes or holds presses nothing.
TEST(Plausibility, LoadsOfTheModelThatMoveNothingAreTold) {
  JointModel model = test::flat_plates(4, 10, 2, 0.0);
  test::fix(model, 2, {true, true, false, true, true, true});
  const auto add = [&model](int material, int dof, double value, const char* name) {
    RigidLoad load;
    load.material = material;
    load.dof = dof;
    load.value.factor = value;
    load.name = name;
    model.rigid_loads.push_back(load);
  };
  add(2, 2, -5, "down");
  add(2, 4, 1, "twist");
  add(1, 0, 0.0, "nothing");
  Settings given = test::linear();
  const auto lines = [&] { return dea::lines(test::findings_of(model, analyse(model, given))); };
  EXPECT_FALSE(has(lines(), "\"down\""));  // the plate is free to move so
  EXPECT_TRUE(has(lines(), "moment \"twist\" about y has no effect: body \"plate\" is held about that axis"));
  add(1, 4, -1, "twist");
  EXPECT_FALSE(has(lines(), "\"twist\""));  // a joint's moments act on both bodies
  add(2, 5, 2, "spin");
  test::prescribe(model, 2, 3, 0.0);
  test::prescribe(model, 2, 4, 0.0);
  test::prescribe(model, 2, 5, 0.01);
  EXPECT_TRUE(
      has(lines(), "moment \"spin\" about z has no effect: body \"plate\" is turned as prescribed about that axis"));
  model.rigid_prescribed.clear();
  model.rigid_fixed.back().dofs[5] = false;
  EXPECT_FALSE(has(lines(), "\"spin\""));
  given.free["plate"] = {false, false, true, false, false, false};
  EXPECT_TRUE(has(lines(), "moment \"spin\" about z has no effect: body \"plate\" is held about that axis"));
  given.free.clear();
  model.rigid_loads.pop_back();
  EXPECT_FALSE(has(lines(), "\"nothing\""));
  add(1, 1, -2, "aside");
  EXPECT_FALSE(has(lines(), "\"aside\""));  // "down" presses: this is the other end of something
  model.rigid_loads.erase(model.rigid_loads.begin());
  EXPECT_TRUE(has(lines(), "force \"aside\" along y has no effect: body \"base\" is held along that axis"));
  add(2, 2, -5, "down");
  test::prescribe(model, 2, 2, -0.01);
  EXPECT_TRUE(
      has(lines(), "force \"down\" along z has no effect: body \"plate\" is moved as prescribed along that axis"));
  given.force["plate"] = Vector3d(0, 0, -3);  // takes its place, and is told for itself
  EXPECT_FALSE(has(lines(), "\"down\""));
  EXPECT_TRUE(has(lines(), "not free to move along z"));
}

/// 2.5 where 2500 N were meant.
TEST(Plausibility, ALoadThatIsNextToNothingIsTold) {
  JointModel model = test::flat_plates(8, 20, 2, 0.0);
  test::fix(model, 2, {true, true, false, true, true, true});
  RigidLoad load;
  load.material = 2;
  load.dof = 2;
  model.rigid_loads.push_back(load);
  const auto lines = [&](double share) {
    model.rigid_loads.back().value.factor = -share * model.materials[0].E * 400;
    return dea::lines(test::findings_of(model, analyse(model, test::linear())));
  };
  EXPECT_TRUE(has(lines(5e-5), "are next to nothing for this cartilage (5e-05 of its modulus times its area)"));
  EXPECT_FALSE(has(lines(1e-3), "next to nothing"));
}

/// A plate that its load brings down by 30 to a layer of 10 x 10 is told; one that rests on it and goes down by 30 with
/// its base is not. Unloaded at the end, the layer was pressed all the same.
TEST(Plausibility, ABodyThatTravelsFarBeforeItTouchesIsTold) {
  const auto codes = [](double gap, double lift, double last_load) {
    JointModel model = test::flat_plates(8, 10, 2, gap);
    model.rigid_fixed.clear();
    test::fix(model, 1, {true, true, false, true, true, true});
    test::prescribe(model, 1, 2, lift);
    test::fix(model, 2, {true, true, false, true, true, true});
    Settings settings = test::linear();
    settings.skip_steps = true;
    settings.loads.body = "plate";
    settings.loads.time = {0, 1};
    settings.loads.load.assign(2, Vector6::Zero());
    settings.loads.load[0][2] = -60 * confined_modulus(model.materials[0].E, model.materials[0].nu);
    settings.loads.load[1][2] = last_load * settings.loads.load[0][2];
    AnalysisOptions options;
    options.times = row_states(model, settings, parse_states("all"), "").times;
    std::vector<std::string> found;
    for (const Finding& f : test::findings_of(model, analyse(model, settings, options))) found.push_back(f.code);
    return found;
  };
  const auto holds = [](const std::vector<std::string>& found, const char* code) {
    return std::count(found.begin(), found.end(), code) == 1;
  };
  EXPECT_TRUE(holds(codes(30.0, 0.0, 1.0), "far-travel"));
  EXPECT_FALSE(holds(codes(0.0, -30.0, 1.0), "far-travel"));
  EXPECT_TRUE(holds(codes(0.0, 0.0, 1.0), "large-strain"));
  EXPECT_TRUE(holds(codes(0.0, 0.0, 0.0), "large-strain"));
}

/// In a socket springs press each other too: their sum is no force that anyone knows. What is told is what the tables
/// show, here the load.
TEST(Plausibility, ALoadThatIsNextToNothingIsTheOneInTheTables) {
  const JointModel model = read_feb(std::string(DEA_SAMPLES_DIR) + "/hip/hip_walking.feb");
  Settings settings;
  settings.skip_steps = true;
  settings.force["femur"] = 1e-3 * Vector3d(432, -262, 1834);  // 1.902 of 1902 N
  AnalysisOptions options;
  options.times = place_times(model, {2});
  const Analysis analysis = analyse(model, settings, options);
  ASSERT_GT(analysis.states.back().equilibrium.load, 2.0);
  EXPECT_TRUE(has(dea::lines(test::findings_of(model, analysis)),
                  "forces of at most 1.9 are next to nothing for this cartilage"));
}

}  // namespace dea::plausibility_test

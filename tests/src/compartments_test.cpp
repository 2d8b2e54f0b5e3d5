// Surfaces in several pieces: what each carries, on paper.
#include "src/joint/compartments.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "io/results/plot_file.h"
#include "io/xplt/xplt.h"
#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/run/analysis.h"
#include "tests/src/test_models.h"

namespace dea::compartments_test {

/// One surface of all facets of several.
int join_surfaces(JointModel& model, const std::string& name, const std::vector<int>& surfaces) {
  Surface all;
  all.name = name;
  for (int index : surfaces) {
    const Surface& s = model.surfaces[at(index)];
    for (int f = 0; f < s.size(); ++f) {
      all.nodes.insert(all.nodes.end(), s.nodes.begin() + s.begin[at(f)], s.nodes.begin() + s.begin[at(f) + 1]);
      all.begin.push_back(static_cast<int>(all.nodes.size()));
    }
  }
  model.surfaces.push_back(all);
  return static_cast<int>(model.surfaces.size()) - 1;
}

struct Pad {
  std::string name;
  Vector3d center;
  double width = 10.0;
};

/// Flat layers 2 thick with their tops at z = 0, all of them one surface on body "base", under one rigid plate of body
/// "plate" that is far larger, pressed 0.1 deep. Materials: 0 cartilage, 1 base, 2 plate.
JointModel pads(const std::vector<Pad>& all, int n = 4) {
  JointModel model = test::empty_model();
  const int cartilage = test::add_material(model, "cartilage", false), base = test::add_material(model, "base", true),
            plate = test::add_material(model, "plate", true);
  std::vector<int> tops;
  for (const Pad& pad : all) {
    const auto level = [&pad](double z) {
      return [&pad, z](double u, double v) -> Vector3d {
        return pad.center + Vector3d(pad.width * (u - 0.5), pad.width * (v - 0.5), z);
      };
    };
    tops.push_back(test::add_layer(model, pad.name, n, n, 1, level(-2), level(0), cartilage, base));
  }
  const int source = join_surfaces(model, "tops", tops);
  const int target = test::add_rigid_surface(
      model, "plate", 20, 20, [](double u, double v) { return Vector3d(100 * (v - 0.5), 100 * (u - 0.5), 0); }, plate);
  test::add_contact(model, "press", source, target);
  test::fix(model, base, {true, true, true, true, true, true});
  test::fix(model, plate, {true, true, false, true, true, true});
  test::prescribe(model, plate, 2, -0.1);
  return model;
}

std::string refusal_of_model(const JointModel& model) {
  try {
    make_joint(model, {});
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}

std::vector<std::string> names_of(const JointModel& model) {
  return compartment_names(make_joint(model, {}).contacts[0]);
}

// p = M d / h everywhere (S3): each pad carries p times its own area, and its centre of pressure is its middle,
// whichever side has the springs.
TEST(Compartments, EachPadCarriesItsOwnArea) {
  const double M = test::kE * (1 - test::kNu) / ((1 + test::kNu) * (1 - 2 * test::kNu)), p = M * 0.1 / 2.0;
  const std::vector<Pad> two = {{"medial", {-20, 3, 0}, 10.0}, {"lateral", {15, 0, 0}, 6.0}};
  for (const char* source : {"base", "plate"}) {
    SCOPED_TRACE(source);
    const bool on_pads = std::string(source) == "base";
    const Analysis analysis = analyse(pads(two), test::linear(source));
    const ContactStatistics& all = analysis.states.back().statistics[0];
    ASSERT_EQ(all.compartments.size(), 2u);
    EXPECT_EQ(compartment_names(analysis.joint.contacts[0]), (std::vector<std::string>{"medial", "lateral"}));
    Vector3d sum = Vector3d::Zero();
    double area = 0.0;
    for (std::size_t i = 0; i < 2; ++i) {
      const CompartmentLoad& load = all.compartments[i];
      const double expected = p * two[i].width * two[i].width;
      // springs of the plate stand on facets of 5 mm: what they cover of a pad is known exactly, its middle too
      EXPECT_NEAR((on_pads ? 1 : -1) * load.force.z(), expected, 1e-9 * expected);
      EXPECT_LT((load.center_of_pressure - two[i].center).head<2>().norm(), 1e-9 * 100);
      sum += load.force;
      area += load.headline.area;
      if (on_pads) {
        EXPECT_NEAR(load.headline.area, two[i].width * two[i].width, 1e-5);
        EXPECT_NEAR(load.headline.mean, p, 1e-6 * p);
        EXPECT_NEAR(load.headline.peak, p, 1e-6 * p);
      }
    }
    EXPECT_LT((sum - all.force).norm(), 1e-12 * all.force.norm());
    EXPECT_NEAR(area, all.headline.area, 1e-9 * area);
  }
}

// A plate over two layers, a contact with each: in the plot file it has the pressure of both (facets of 2 mm, 25 over
// each layer), and their forces together.
TEST(Compartments, ASurfaceOfTwoContactsShowsBoth) {
  JointModel model = test::empty_model();
  const int cartilage = test::add_material(model, "cartilage", false), base = test::add_material(model, "base", true),
            plate = test::add_material(model, "plate", true);
  int layers[2];
  for (int k = 0; k < 2; ++k) {
    const auto flat = [k](double z) {
      return [k, z](double u, double v) { return Vector3d(10 * (u - 0.5) + (k == 0 ? -7 : 7), 10 * (v - 0.5), z); };
    };
    layers[k] = test::add_layer(model, k == 0 ? "medial" : "lateral", 5, 5, 1, flat(-2), flat(0), cartilage, base);
  }
  const int above = test::add_rigid_surface(
      model, "plate", 12, 5, [](double u, double v) { return Vector3d(24 * (0.5 - u), 10 * (v - 0.5), 0); }, plate);
  for (int k = 0; k < 2; ++k) test::add_contact(model, k == 0 ? "medial" : "lateral", layers[k], above);
  test::fix(model, base, {true, true, true, true, true, true});
  test::fix(model, plate, {true, true, false, true, true, true});
  test::prescribe(model, plate, 2, -0.1);
  const Recognition recognition = recognise(model, test::linear());
  ASSERT_TRUE(recognition.faults.empty());
  const Analysis analysis = analyse(recognition);
  const XpltFile plot = make_plot_file(recognition, analysis);
  const double M = test::kE * (1 - test::kNu) / ((1 + test::kNu) * (1 - 2 * test::kNu)), p = M * 0.1 / 2.0;
  const auto values = [&](const char* name) {
    const auto& regions =
        plot.states.back().variables[static_cast<std::size_t>(find_variable(plot, XpltGroup::Surface, name))];
    const auto surface = std::find_if(plot.meshes.front().surfaces.begin(), plot.meshes.front().surfaces.end(),
                                      [](const XpltFacets& s) { return s.name == "plate"; });
    const int region = static_cast<int>(surface - plot.meshes.front().surfaces.begin()) + 1;
    return std::find_if(regions.begin(), regions.end(), [&](const XpltRegion& r) { return r.region == region; })
        ->values;
  };
  const std::vector<float> pressure = values("contact pressure"), force = values("contact force");
  ASSERT_EQ(pressure.size(), 60u);
  EXPECT_EQ(std::count_if(pressure.begin(), pressure.end(), [&](float x) { return std::abs(x - p) < 1e-5 * p; }), 50);
  EXPECT_EQ(std::count(pressure.begin(), pressure.end(), 0.0f), 10);
  EXPECT_NEAR(std::abs(force[2]), 2 * p * 100, 1e-5 * p * 200);
  EXPECT_NEAR(values("contact area")[0], 200, 1e-3);
}

// Law layer: pads so far apart feel nothing of each other. Each gives what it gives alone.
TEST(Compartments, AreAsIfAlone) {
  const Pad left = {"left pad", {-20, 0, 0}, 10.0}, right = {"right pad", {20, 0, 0}, 7.0};
  const Analysis both = analyse(pads({left, right}, 8), Settings());
  const ContactStatistics& all = both.states.back().statistics[0];
  ASSERT_EQ(all.compartments.size(), 2u);
  int i = 0;
  for (const Pad& pad : {left, right}) {
    const ContactStatistics alone = analyse(pads({pad}, 8), Settings()).states.back().statistics[0];
    EXPECT_TRUE(alone.compartments.empty());
    EXPECT_NEAR(all.compartments[at(i)].force.z(), alone.force.z(), 1e-6 * alone.force.z());
    EXPECT_NEAR(all.compartments[at(i)].headline.peak, alone.headline.peak, 1e-5 * alone.headline.peak);
    ++i;
  }
}

TEST(Compartments, AreNamedByPartsElseBySidesElseByNumbers) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(names_of(pads({{"a", {20, 0, 0}}, {"b", {-20, 0, 0}}})), (Names{"a", "b"}));
  EXPECT_EQ(names_of(pads({{"same", {20, 0, 0}}, {"same", {-20, 1, 0}}})), (Names{"+x", "-x"}));
  EXPECT_EQ(names_of(pads({{"same", {0, -20, 0}}, {"same", {0, 20, 0}}})), (Names{"-y", "+y"}));
  EXPECT_EQ(names_of(pads({{"same", {-20, -20, 0}}, {"same", {20, 20, 0}}})), (Names{"1", "2"}));
  EXPECT_EQ(names_of(pads({{"same", {-20, 0, 0}}, {"same", {20, 0, 0}}, {"same", {0, 30, 0}}})),
            (Names{"1", "2", "3"}));
  EXPECT_EQ(names_of(pads({{"a", {-20, 0, 0}}, {"b", {20, 0, 0}}, {"c", {0, 30, 0}, 0.5}})), (Names{"a", "b", "rest"}));
  EXPECT_EQ(names_of(pads({{"a", {0, 0, 0}}})), Names());
}

// Two halves of one cartilage whose nodes were not merged: nothing that is squeezed could flow across.
TEST(Compartments, PartsThatTouchAreRefused) {
  const char* touch = "lies on 2 deformable parts that touch, as nodes ";
  EXPECT_NE(refusal_of_model(pads({{"a", {-5, 0, 0}}, {"b", {5, 0, 0}}})).find(touch), std::string::npos);
  // no two nodes at one place: shifted along the seam
  const std::string shifted = refusal_of_model(pads({{"a", {-5, 0, 0}}, {"b", {5, 1, 0}}}));
  EXPECT_NE(shifted.find("lies on 2 deformable parts that touch, but share no nodes"), std::string::npos) << shifted;
  EXPECT_EQ(refusal_of_model(pads({{"a", {-5, 0, 0}}, {"b", {5.1, 0, 0}}})), "");
}

TEST(Compartments, PartsOnDifferentBonesAreRefused) {
  JointModel model = pads({{"a", {-20, 0, 0}}, {"b", {20, 0, 0}}});
  const int other = test::add_material(model, "other bone", true);
  for (Domain& d : model.domains)
    if (d.name == "b bone") d.material = other;
  test::fix(model, other, {true, true, true, true, true, true});
  const std::string text = refusal_of_model(model);
  EXPECT_NE(text.find("the 2 parts of its layer are held by 2 bodies"), std::string::npos) << text;
  for (Domain& d : model.domains)
    if (d.name == "b bone") d.material = -1;  // no bone at all
  EXPECT_NE(refusal_of_model(model).find("one of its layer's parts is held by no rigid body"), std::string::npos);
}

}  // namespace dea::compartments_test

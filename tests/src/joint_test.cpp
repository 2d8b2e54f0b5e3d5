#include "src/joint/joint.h"
#include "tests/findings.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <set>

#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/base/rotations.h"
#include "src/facts/bodies.h"
#include "src/joint/shared_ends.h"
#include "src/results/percentile.h"
#include "src/results/statistics.h"
#include "src/run/analysis.h"
#include "tests/src/test_models.h"

namespace dea::joint_test {

using namespace test;

/// A layer without bone of its own between z = 0 and z = h, its lower side a surface "base side", upper "layer"; and
/// rigid plates "left" and "right" under its halves, plate "top" above.
JointModel floating_layer(double h) {
  JointModel model = empty_model();
  const int cartilage = add_material(model, "cartilage", false), left = add_material(model, "left", true),
            right = add_material(model, "right", true), top = add_material(model, "top", true);
  const auto flat = [](double u, double v, double z) { return Vector3d(10 * (u - 0.5), 10 * (v - 0.5), z); };
  const int n = 4;
  const int layer = add_layer(
      model, "layer", n, n, 1, [&](double u, double v) { return flat(u, v, 0); },
      [&](double u, double v) { return flat(u, v, h); }, cartilage, left);
  model.domains.pop_back();  // no shells on its underside: it floats
  add_surface(model, "base side", grid_quads(0, n, n, true));
  add_rigid_surface(
      model, "left plate", n, n, [&](double u, double v) { return flat(0.5 * u, v, 0); }, left);
  add_rigid_surface(
      model, "right plate", n, n, [&](double u, double v) { return flat(0.5 + 0.5 * u, v, 0); }, right);
  const int plate = add_rigid_surface(
      model, "top", n, n, [&](double u, double v) { return flat(v, u, h); }, top);
  add_contact(model, "press", layer, plate);
  for (int m : {left, right, top}) fix(model, m, {true, true, true, true, true, true});
  return model;
}

std::vector<std::string> names_in(const Finding& finding, const char* value) {
  return test::value_of<std::vector<std::string>>(finding, value);
}

bool told_of(const Joint& joint, const char* code) { return !of_code(joint.findings, code).empty(); }

/// Is there a finding with this text?
bool told(const JointModel& model, const std::string& text, const Settings& settings = {}) {
  return test::words_of(make_joint(model, settings).findings).find(text) != std::string::npos;
}

void tie(JointModel& model, int primary, int secondary) {
  add_contact(model, "tie", primary, secondary);
  model.contacts.back().kind = Contact::Kind::Tied;
  model.contacts.back().type = "tied-elastic";
}

std::string refusal(const JointModel& model, const Settings& settings = {}) {
  try {
    make_joint(model, settings);
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}

TEST(Recognition, TiedLayerTakesTheBodyItIsTiedTo) {
  JointModel model = floating_layer(2.0);
  EXPECT_NE(refusal(model).find("held by no rigid body"), std::string::npos);
  tie(model, 1, 2);
  const Joint joint = make_joint(model, {});
  EXPECT_EQ(joint.bodies[static_cast<std::size_t>(joint.contacts[0].layers[0].body)].name, "left");
  const Layer& layer = joint.contacts[0].layers[0];
  for (std::size_t v = 0; v < layer.thickness.size(); ++v) {
    if (layer.articular.vertices[v].x() > 0.1) continue;
    EXPECT_NEAR(layer.thickness[v], 2.0, 1e-12);  // over that half there is bone
  }
}

// FEBio pulls some ties' nodes onto the surface they are tied to; dea leaves the layer where it is meshed.
TEST(Recognition, TiesThatFebioClosesAreTold) {
  const auto doubts = [](double gap, bool closes) {
    JointModel model = floating_layer(2.0);
    tie(model, 1, 2);
    model.contacts.back().type = closes ? "tied-node-on-facet" : "tied-elastic";
    model.contacts.back().closes_gap = closes;
    for (const int node : nodes_of_surface(model.surfaces[2])) model.nodes[static_cast<std::size_t>(node)].z() -= gap;
    return of_code(make_joint(model, {}).findings, "tie-closes-gap");
  };
  EXPECT_TRUE(doubts(0, true).empty());
  EXPECT_TRUE(doubts(0.05, false).empty());
  for (const double gap : {0.05, -0.05}) {
    const Findings told = doubts(gap, true);
    ASSERT_EQ(told.size(), 1u);
    EXPECT_EQ(told[0].subject.contact, "tie");
    EXPECT_NEAR(test::number(told[0], "mean"), 0.05, 1e-12);
    EXPECT_NEAR(test::number(told[0], "most"), 0.05, 1e-12);
  }
}

TEST(Recognition, ABodyWithoutElementsIsToldWhereABodyIsAskedFor) {
  JointModel model = floating_layer(2.0);
  add_material(model, "ghost", true);
  EXPECT_NE(refusal(model).find("\"top\", \"ghost\" without elements)"), std::string::npos) << refusal(model);
}

// The part under the tie gives way: its upper side is no bone, and 2 no thickness of what lies on bone.
TEST(Recognition, ALayerTiedToADeformablePartIsRefusedUnlessTheUserSaysWhatItLiesOn) {
  JointModel model = floating_layer(2.0);
  const int deep = add_material(model, "deep", false, 1.0, 0.3);
  const auto flat = [](double z) {
    return [z](double u, double v) { return Vector3d(10 * (u - 0.5), 10 * (v - 0.5), z); };
  };
  const int below = add_layer(model, "deep", 4, 4, 1, flat(-1), flat(0), deep, 1);
  add_surface(model, "deep bone", model.domains.back().nodes);
  tie(model, 1, below);
  EXPECT_NE(
      refusal(model).find("contact \"press\", surface \"layer\": its layer is tied (\"tie\") to a deformable part of "
                          "material \"deep\", not to bone"),
      std::string::npos)
      << refusal(model);
  const auto thickness = [&](const Settings& settings) {
    return make_joint(model, settings).contacts[0].layers[0].mean_thickness();
  };
  Settings rigid, bone, given;
  rigid.rigid = {"deep"};
  EXPECT_NEAR(thickness(rigid), 2.0, 1e-12);
  bone.bone["layer"] = "deep bone";
  EXPECT_NEAR(thickness(bone), 3.0, 1e-12);
  const std::string gap =
      "up to bone surface \"deep bone\" its cartilage is 3 thick (the median), but its own elements are 2: the gap "
      "between them counts as cartilage";
  EXPECT_TRUE(told(model, gap, bone));
  EXPECT_FALSE(told(model, gap, rigid));
  given.thickness["layer"] = 2.5;
  EXPECT_NEAR(thickness(given), 2.5, 1e-12);
}

/// A cube of side 1 with a corner at `x`, of the material; its lower and upper four nodes move with these bodies.
void add_cube(JointModel& model, const std::string& name, int material, const Vector3d& x, int low, int high) {
  Domain d;
  d.name = name;
  d.shape = ElementShape::Hex8;
  d.material = material;
  d.element_ids = {1};
  RigidNodes ends[2];
  for (int k = 0; k < 2; ++k)
    for (const auto& [i, j] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
      d.nodes.push_back(static_cast<int>(model.nodes.size()));
      ends[k].nodes.push_back(d.nodes.back());
      model.node_ids.push_back(static_cast<int>(model.nodes.size()) + 1);
      model.nodes.push_back(x + Vector3d(i, j, k));
    }
  model.domains.push_back(d);
  ends[0].material = low;
  ends[1].material = high;
  for (const RigidNodes& end : ends)
    if (end.material >= 0) model.rigid_nodes.push_back(end);
}

TEST(Recognition, DeformablePartsBetweenBodiesAreTold) {
  JointModel model = flat_plates(2, 10, 2, 0.0);
  const int base = 1, plate = 2;
  const int ligament = add_material(model, "ligament", false);
  add_cube(model, "fat", ligament, {20, 0, 0}, base, -1);
  EXPECT_TRUE(of_code(make_joint(model, {}).findings, "part-not-modelled").empty());  // hangs on one bone
  add_cube(model, "medial", ligament, {30, 0, 0}, base, plate);
  add_cube(model, "lateral", ligament, {40, 0, 0}, base, plate);
  const Findings found = of_code(make_joint(model, {}).findings, "part-not-modelled");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(names_in(found[0], "parts"), (std::vector<std::string>{"medial", "lateral"}));
  EXPECT_EQ(test::number(found[0], "elements"), 2);
  EXPECT_EQ(names_in(found[0], "bodies").size(), 2u);
  // a truss from the fat's free corner to the plate: a chain of two
  Domain truss;
  truss.name = "truss";
  truss.shape = ElementShape::Line2;
  truss.material = ligament;
  truss.element_ids = {9};
  for (const Domain& d : model.domains) {
    if (d.name == "fat") truss.nodes.push_back(d.nodes.back());
    if (d.name == "medial") truss.nodes.push_back(d.nodes.back());
  }
  model.domains.push_back(truss);
  EXPECT_EQ(names_in(of_code(make_joint(model, {}).findings, "part-not-modelled")[0], "parts"),
            (std::vector<std::string>{"medial", "lateral", "fat", "truss"}));
  // one from the layer itself to the plate
  truss.name = "string";
  truss.nodes = {model.surfaces[0].nodes[0], model.surfaces[1].nodes[0]};
  model.domains.push_back(truss);
  const std::vector<std::string> names =
      names_in(of_code(make_joint(model, {}).findings, "part-not-modelled")[0], "parts");
  EXPECT_EQ(std::count(names.begin(), names.end(), "string"), 1);
}

// A pad between the plate and nodes that are held in one component resists the plate there, unless it cannot move so.
TEST(Recognition, PartsBetweenABodyAndHeldNodesAreTold) {
  JointModel model = flat_plates(2, 10, 2, 0.0);
  const int base = 1, plate = 2;
  const int soft = add_material(model, "pad", false);
  add_cube(model, "pad", soft, {20, 0, 0}, plate, -1);
  FixedNodes held;
  for (int k = 1; k <= 4; ++k) held.nodes.push_back(static_cast<int>(model.nodes.size()) - k);
  held.xyz = {false, false, true};
  model.fixed_nodes.push_back(held);
  const auto found = [&] { return of_code(make_joint(model, {}).findings, "part-not-modelled"); };
  ASSERT_EQ(found().size(), 1u);
  EXPECT_EQ(names_in(found()[0], "parts"), std::vector<std::string>{"pad"});
  EXPECT_EQ(names_in(found()[0], "bodies"), std::vector<std::string>{"plate"});
  EXPECT_EQ(names_in(found()[0], "components"), std::vector<std::string>{"z"});
  Settings along;
  along.free["plate"] = {true, true, false, false, false, true};
  EXPECT_TRUE(of_code(make_joint(model, along).findings, "part-not-modelled").empty());
  fix(model, plate, {false, false, false, true, true, false});
  EXPECT_EQ(found().size(), 1u);
  prescribe(model, plate, 2, -0.1);
  EXPECT_TRUE(found().empty());
  model.rigid_prescribed.back().step = 0;
  EXPECT_TRUE(found().empty());
  model.steps.push_back(model.steps.back());
  EXPECT_EQ(found().size(), 1u) << "free in the second step";
  along.free["plate"] = {false, false, false, false, false, false};  // the model's prescribed motion stays
  EXPECT_TRUE(of_code(make_joint(model, along).findings, "part-not-modelled").empty());
  model.rigid_nodes.back().material = base;
  EXPECT_TRUE(found().empty());
}

// What holds a layer ends with its step in FEBio, here never: it is told.
TEST(Recognition, HoldsOfSomeStepsAreTold) {
  JointModel model = floating_layer(2.0);
  FixedNodes held;
  for (int i = 0; i < 25; ++i) held.nodes.push_back(i);
  held.xyz = {true, true, true};
  held.step = 0;
  model.fixed_nodes.push_back(held);
  const std::string fixed = "25 nodes of deformable parts are fixed in x, y and z at once in ";
  EXPECT_FALSE(told(model, fixed)) << "the only step";
  model.steps.push_back(model.steps.back());
  EXPECT_TRUE(told(model, fixed + "step 1 only of the model; dea takes that for all steps"));
  held.step = 1;
  model.fixed_nodes.push_back(held);
  EXPECT_FALSE(told(model, fixed));
  model.fixed_nodes[0].xyz = {true, true, false};
  model.fixed_nodes[1].xyz = {false, false, true};
  EXPECT_TRUE(told(model, fixed + "none of the steps of the model"));
  model.fixed_nodes.clear();
  tie(model, 1, 2);
  held.nodes.resize(5);
  held.xyz = {true, false, false};
  model.fixed_nodes = {held};
  EXPECT_TRUE(told(model, "5 nodes of deformable parts are held in x in step 2 only of the model"));
  model.fixed_nodes[0].step = -1;
  EXPECT_FALSE(told(model, "of deformable parts are held in x"));
  model.fixed_nodes.clear();
  const std::string ties = "contact \"tie\" ties its surfaces in step 2 only";
  EXPECT_FALSE(told(model, ties));
  model.contacts.back().step = 1;
  EXPECT_TRUE(told(model, ties));
}

TEST(Recognition, TiesThatDeaDropsAreTold) {
  JointModel plates = flat_plates(2, 10, 2, 0.0);
  const int post = add_material(plates, "post", true);
  const int top = add_rigid_surface(
      plates, "post side", 2, 2, [](double u, double v) { return Vector3d(10 * u, 10 * v, 3); }, post);
  EXPECT_TRUE(of_code(make_joint(plates, {}).findings, "tie-left-out").empty());
  tie(plates, 1, top);  // the plate to the post: both are rigid
  RigidNodes set;
  set.name = "pins";
  set.material = 2;
  set.nodes = {plates.surfaces.back().nodes[0]};  // nodes of the post that are to move with the plate
  plates.rigid_nodes.push_back(set);
  const Findings dropped = of_code(make_joint(plates, {}).findings, "tie-left-out");
  ASSERT_EQ(dropped.size(), 2u);
  EXPECT_EQ(test::text(dropped[0], "tie"), "contact \"tie\"");
  EXPECT_NE(dropped[0].subject.body, test::text(dropped[0], "other"));
  EXPECT_EQ(test::text(dropped[1], "tie"), "rigid node set \"pins\"");
  // two pieces of cartilage on one bone, tied side to side
  JointModel pieces = flat_plates(2, 10, 2, 0.0);
  const auto beside = [](double z) {
    return [z](double u, double v) { return Vector3d(10 * (u - 0.5) + 10, 10 * (v - 0.5), z); };
  };
  const int other = add_layer(pieces, "beside", 2, 2, 1, beside(-2), beside(0), 0, 1);
  tie(pieces, 0, other);
  EXPECT_EQ(of_code(make_joint(pieces, {}).findings, "pieces-side-by-side").size(), 1u);
  EXPECT_TRUE(of_code(make_joint(pieces, {}).findings, "tie-left-out").empty());
}

// A piece tied to bone, and to the side of a piece that shares nodes with bone: bone holds it.
TEST(Recognition, APieceOnBoneMayBeTiedToItsNeighbourToo) {
  JointModel model = floating_layer(2.0);  // x and y from -5 to 5
  // bone under all of it, and a piece beside it that shares nodes with the bone
  const auto at_height = [](double x0, double z) {
    return [x0, z](double u, double v) { return Vector3d(10 * (u - 0.5) + x0, 10 * (v - 0.5), z); };
  };
  const int bone = add_rigid_surface(model, "bone", 4, 4, at_height(0, 0), 1);
  add_layer(model, "beside", 4, 4, 1, at_height(-10, 0), at_height(-10, 2), 0, 1);
  const std::vector<Vector3d> nodes = model.nodes;
  const auto side = [&](const std::string& name, int low, int high) {  // four facets at x = -5
    std::vector<int> quads;
    for (int j = 0; j < 4; ++j)
      for (const int n : {low + 5 * j, low + 5 * (j + 1), high + 5 * (j + 1), high + 5 * j}) quads.push_back(n);
    return add_surface(model, name, quads);
  };
  const int first = static_cast<int>(nodes.size()) - 50;  // of the piece beside: 25 below, 25 above
  const int own_side = side("own side", 0, 25), its_side = side("its side", first + 4, first + 29);
  tie(model, 1, bone);
  tie(model, own_side, its_side);
  ASSERT_EQ(refusal(model), "");
  const Layer layer = make_joint(model, {}).contacts[0].layers[0];
  EXPECT_NEAR(layer.min_thickness(), 2.0, 1e-12);  // its side is not bonded to bone
  EXPECT_EQ(layer.missed_count(), 0);
}

// Two elements of 1 through the layer; nodes between them are held too: it is 1 thick there, not 2.
TEST(Recognition, NodesHeldInsideALayerAreRefused) {
  JointModel model = flat_plates(2, 10, 2, 0.0);
  RigidNodes set;
  set.name = "too deep";
  set.material = 1;
  for (std::size_t i = 0; i < model.nodes.size(); ++i)
    if (std::abs(model.nodes[i].z() + 1) < 1e-9 && model.nodes[i].head<2>().norm() < 1e-9)
      set.nodes.push_back(static_cast<int>(i));
  ASSERT_EQ(set.nodes.size(), 1u);  // the one in the middle
  model.rigid_nodes.push_back(set);
  EXPECT_NE(refusal(model).find("1 node is inside its layer (node"), std::string::npos) << refusal(model);
  Settings settings;
  settings.thickness["layer"] = 1.5;
  EXPECT_EQ(refusal(model, settings), "");
}

// Bone under one half of a layer: its nodes beyond are not bonded to it.
TEST(Recognition, NodesBeyondTheSurfaceTheyAreTiedToAreNotHeld) {
  JointModel model = floating_layer(2.0);
  tie(model, 1, 2);  // to the plate "left", under x < 0
  const Layer layer = make_joint(model, {}).contacts[0].layers[0];
  for (int t = 0; t < layer.bone.size(); ++t) EXPECT_LT(layer.bone.centroid(t).x(), 0.0);
  EXPECT_GT(layer.missed_count(), 0);
}

// Plates 1.5 below the layer: tied from a reach of 1.5 on, else told, and why nothing holds the layer.
TEST(Recognition, TiesHaveTheirReach) {
  const auto model = [](double reach) {
    JointModel m = floating_layer(2.0);
    for (const Domain& d : m.domains)
      if (m.materials[static_cast<std::size_t>(d.material)].name == "left" ||
          m.materials[static_cast<std::size_t>(d.material)].name == "right")
        for (const int node : std::set<int>(d.nodes.begin(), d.nodes.end()))
          m.nodes[static_cast<std::size_t>(node)].z() -= 1.5;
    tie(m, 1, 2);
    m.contacts.back().max_distance = reach;
    return m;
  };
  for (const double reach : {0.0, 1.51, 3.0})
    EXPECT_FALSE(told(model(reach), "they are not tied, in FEBio neither")) << reach;
  const std::string why = refusal(model(1.49));
  EXPECT_NE(why.find("contact \"tie\" of type tied-elastic reaches 1.49"), std::string::npos) << why;
  EXPECT_NE(why.find("lie 1.5 or more from the surface they would be tied to: they are not tied, in FEBio neither; if "
                     "they are to be, write a larger <search_radius>"),
            std::string::npos)
      << why;
}

TEST(Recognition, AThicknessForAllIsToldWhereItLiesOnABareSurface) {
  const JointModel model = flat_plates(2, 10, 2, 0.0);
  Settings settings;
  settings.thickness[""] = 2;
  settings.E[""] = 10;
  settings.nu[""] = 0.3;
  const std::string given = "a bare surface of body \"plate\" is given 2 of cartilage";
  EXPECT_TRUE(told(model, given, settings));
  settings.thickness = {{"layer", 2.0}, {"plate", 2.0}};
  EXPECT_FALSE(told(model, given, settings));  // meant
}

TEST(Recognition, ALayerTiedToTwoBodiesIsHeldByTwo) {
  JointModel model = floating_layer(2.0);
  tie(model, 1, 2);
  tie(model, 1, 3);
  EXPECT_NE(refusal(model).find("held by 2 bodies"), std::string::npos) << refusal(model);
}

TEST(Recognition, ALayerTiedToOneHeldByTwoComesToAnEnd) {
  JointModel model = floating_layer(2.0);
  RigidNodes a, b;
  a.material = 1;
  a.nodes = {0};
  b.material = 2;
  b.nodes = {4};
  model.rigid_nodes = {a, b};
  tie(model, 4, 1);  // the top plate's surface tied to a layer that two bodies hold
  tie(model, 1, 4);
  EXPECT_NE(refusal(model).find("held by"), std::string::npos) << refusal(model);
}

TEST(Recognition, NodesFixedInAllComponentsAreGroundAndInOneASymmetryPlane) {
  JointModel model = floating_layer(2.0);
  FixedNodes f;
  for (int i = 0; i < 25; ++i) f.nodes.push_back(i);
  f.xyz = {true, false, false};
  model.fixed_nodes.push_back(f);
  EXPECT_NE(refusal(model).find("held by no rigid body"), std::string::npos);
  f.xyz = {false, true, true};  // two conditions together
  model.fixed_nodes.push_back(f);
  const Joint joint = make_joint(model, {});
  EXPECT_TRUE(joint.bodies[static_cast<std::size_t>(joint.contacts[0].layers[0].body)].ground);
}

TEST(Recognition, SeveralModuliOnOneSurfaceAreRefusedUnlessOneIsGiven) {
  JointModel model = flat_plates(4, 10, 2, 0.0);
  const int other = add_material(model, "other", false, 3.0, 0.4);
  Domain half = model.domains[0];
  half.name = "other half";
  half.material = other;
  std::vector<int> first, second, first_ids, second_ids;
  for (std::size_t e = 0; e < 32; ++e) {
    auto& to = e % 16 < 8 ? first : second;
    to.insert(to.end(), half.nodes.begin() + static_cast<std::ptrdiff_t>(8 * e),
              half.nodes.begin() + static_cast<std::ptrdiff_t>(8 * e) + 8);
    (e % 16 < 8 ? first_ids : second_ids).push_back(static_cast<int>(e) + 1);
  }
  model.domains[0].nodes = first;
  model.domains[0].element_ids = first_ids;
  half.nodes = second;
  half.element_ids = second_ids;
  model.domains.push_back(half);
  EXPECT_NE(refusal(model).find("several materials"), std::string::npos) << refusal(model);
  Settings settings;
  settings.E["layer"] = 10.0;
  settings.nu["layer"] = 0.4;
  EXPECT_EQ(refusal(model, settings), "");
}

// A layer in zones: what lies under the facets counts, too.
TEST(Recognition, ALayerOfSeveralMaterialsIsRefusedOrTold) {
  JointModel model = flat_plates(4, 10, 2, 0.0);
  const Material own = model.materials[static_cast<std::size_t>(model.domains[0].material)];
  const int other = add_material(model, "deep zone", false, own.E, own.nu);
  Domain deep = model.domains[0];  // elements 1 to 16 lie on the bone
  deep.material = other;
  Domain& upper = model.domains[0];
  deep.element_ids.assign(upper.element_ids.begin(), upper.element_ids.begin() + 16);
  deep.nodes.assign(upper.nodes.begin(), upper.nodes.begin() + 128);
  upper.element_ids.erase(upper.element_ids.begin(), upper.element_ids.begin() + 16);
  upper.nodes.erase(upper.nodes.begin(), upper.nodes.begin() + 128);
  model.domains.push_back(deep);
  Material& zone = model.materials[static_cast<std::size_t>(other)];
  EXPECT_TRUE(make_joint(model, {}).findings.empty());
  for (const double factor : {0.01, 0.5, 0.7, 1.3, 4.9, 100.0}) {
    zone.E = factor * own.E;
    EXPECT_NE(refusal(model).find("deep zone"), std::string::npos) << factor << refusal(model);
    Settings settings;
    settings.E["layer"] = own.E;
    settings.nu["layer"] = own.nu;
    EXPECT_EQ(refusal(model, settings).empty(), factor < 5) << factor;
  }
  zone.E = own.E;  // the confined modulus counts, too: here less than half of the other
  zone.nu = 0.3;
  EXPECT_NE(refusal(model).find("deep zone"), std::string::npos) << refusal(model);
  Settings for_all;  // one nu for the whole part: its zones are alike then
  for_all.nu[""] = 0.4;
  EXPECT_EQ(refusal(model, for_all), "");
  zone.nu = own.nu;
  zone.E = 1.1 * own.E;
  const Joint told = make_joint(model, {});
  ASSERT_EQ(told.findings.size(), 1u);
  EXPECT_EQ(told.findings[0].code, "first-material-for-all");
  EXPECT_NE(test::text(told.findings[0], "materials").find("deep zone"), std::string::npos);
  // close to 0.5 a fifth of the confined modulus is 0.0004 of nu
  zone.E = own.E;
  zone.nu = 0.4999;
  model.materials[static_cast<std::size_t>(upper.material)].nu = 0.4995;
  EXPECT_NE(refusal(model).find("deep zone"), std::string::npos) << refusal(model);
  // a thickness that is given leaves out what lies below, and says so
  Settings given;
  given.thickness["layer"] = 2.0;
  EXPECT_TRUE(told_of(make_joint(model, given), "other-material-rigid"));
}

// Surfaces that share facets, and surfaces side by side, are one layer, and none of springs that know nothing of each
// other is told. Where their materials differ each goes alone, and that is told.
TEST(Recognition, ContactsThatShareALayer) {
  for (const bool overlap : {true, false}) {
    JointModel model = flat_plates(4, 10, 2, 0.0);
    Surface& whole = model.surfaces[static_cast<std::size_t>(model.contacts[0].primary)];
    Surface half = whole;
    half.name = "half";
    half.nodes.resize(32);
    half.begin.resize(9);
    if (!overlap) {
      whole.nodes.erase(whole.nodes.begin(), whole.nodes.begin() + 32);
      whole.begin.resize(9);
    }
    const int secondary = model.contacts[0].secondary;
    model.surfaces.push_back(half);
    add_contact(model, "second", static_cast<int>(model.surfaces.size()) - 1, secondary);
    const Joint joint = make_joint(model, {});
    ASSERT_EQ(joint.findings.size(), 1u);
    EXPECT_EQ(joint.findings[0].code, "shared-layer");
    ASSERT_EQ(joint.shared_layers.size(), 1u);
    EXPECT_EQ(joint.shared_layers[0].pressed, 32);  // triangles, those of both once
    EXPECT_EQ(joint.shared_layers[0].uses.size(), 2u);
    EXPECT_TRUE(make_joint(model, linear()).findings.empty());
    // 10 long, beside the other's facets; a selection in another one has none beside it that is its own
    EXPECT_NEAR(rim_lengths(joint.contacts[1].layers[0].face).shared, 10, 1e-9);
    EXPECT_NEAR(rim_lengths(joint.contacts[0].layers[0].face).shared, overlap ? 0 : 10, 1e-9);
  }
}

// A roof of two flat halves, and of two with a rounded ridge between them: what is flat stays flat. A prism of 12
// sides stands for the cylinder around it: (1 - cos 15 degrees) R high over the middle of its sides.
TEST(SurfaceMesh, CreasesAreNotRounded) {
  const auto strip = [](const std::vector<Eigen::Vector2d>& profile, int rows) {
    JointModel model = empty_model();
    std::vector<int> begin = {0}, nodes;
    const int columns = static_cast<int>(profile.size());
    for (int r = 0; r <= rows; ++r)
      for (const auto& p : profile) model.nodes.emplace_back(p.x(), r, p.y());
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c + 1 < columns; ++c) {
        for (int n : {r * columns + c, r * columns + c + 1, (r + 1) * columns + c + 1, (r + 1) * columns + c})
          nodes.push_back(n);
        begin.push_back(static_cast<int>(nodes.size()));
      }
    return make_surface_mesh(begin, nodes, model.nodes);
  };
  for (const double degrees : {16.0, 25.0, 39.0, 45.0, 59.0, 80.0}) {
    const double slope = std::tan(degrees * kPi / 180);
    std::vector<Eigen::Vector2d> roof;
    for (int i = 0; i <= 8; ++i) roof.emplace_back(i, i <= 4 ? 0 : (4 - i) * slope);
    for (const auto& b : strip(roof, 5).bulge)
      for (const double height : b) EXPECT_NEAR(height, 0, 1e-12) << degrees;
  }
  std::vector<Eigen::Vector2d> prism;
  const double step = kPi / 6;
  for (int i = 0; i <= 6; ++i) prism.emplace_back(-std::cos(i * step), std::sin(i * step));
  const SurfaceMesh mesh = strip(prism, 5);
  double highest = 0;
  for (int t = 0; t < mesh.size(); ++t) highest = std::max(highest, bulge_height(mesh, t, {0.5, 0.5, 0}));
  EXPECT_NEAR(highest, 1 - std::cos(step / 2), 0.02 * highest);
}

// The face of a collapsed hex repeats a node; however the facet is written, it looks out of its element.
TEST(Recognition, CollapsedFacetsKeepTheirSide) {
  for (int rotation = 0; rotation < 4; ++rotation) {
    JointModel model = flat_plates(1, 10, 2, 0.0);
    const std::vector<int> top = model.surfaces[0].nodes;  // four nodes of the only facet
    const int gone = top[3], kept = top[2];
    for (Domain& d : model.domains)
      if (d.shape == ElementShape::Hex8)
        for (int& n : d.nodes)
          if (n == gone) n = kept;
    std::vector<int> facet = {top[0], top[1], kept, kept};
    std::rotate(facet.begin(), facet.begin() + rotation, facet.end());
    model.surfaces[0].nodes = facet;
    const Joint joint = make_joint(model, {});
    ASSERT_EQ(joint.contacts[0].layers[0].articular.size(), 1);
    EXPECT_GT(joint.contacts[0].layers[0].articular.normals[0].z(), 0.99) << rotation;
    EXPECT_TRUE(joint.findings.empty()) << joint.findings.front().code;
  }
}

// Planes of symmetry at x = -5 and, as it is asked for, x = 5, y = -5, y = 5: of a plate of 10 x 10.
JointModel plate_between_planes(double h, const std::vector<std::pair<int, double>>& planes) {
  JointModel model = flat_plates(4, 10, h, 0.0);
  for (const auto& plane : planes) {
    FixedNodes f;
    f.xyz[static_cast<std::size_t>(plane.first)] = true;
    for (std::size_t i = 0; i < model.nodes.size(); ++i)
      if (std::abs(model.nodes[i][plane.first] - plane.second) < 1e-9) f.nodes.push_back(static_cast<int>(i));
    model.fixed_nodes.push_back(f);
  }
  return model;
}

// The circle of 100 has a radius of 5.64, of 200 one of 7.98, of 400 one of 11.3; a strip 10 wide has 5.
TEST(Recognition, WhetherALayerIsThinIsAskedOfItsMirrorImagesToo) {
  struct Case {
    double h;
    std::vector<std::pair<int, double>> planes;
    const char* told;
  };
  for (const Case& c :
       std::vector<Case>{{5, {}, ""},
                         {7, {}, "a surface as large as a circle of radius 5.64;"},
                         {7, {{0, -5}}, ""},
                         {9, {{0, -5}}, "a surface as large as a circle of radius 7.98;"},
                         {9, {{0, -5}, {1, 5}}, ""},
                         {12, {{0, -5}, {1, 5}}, "a surface as large as a circle of radius 11.3;"},
                         {7, {{0, -5}, {0, 5}}, "a strip between planes of symmetry whose half width is 5;"},
                         {30, {{0, -5}, {0, 5}, {1, -5}, {1, 5}}, ""}}) {
    std::string told;
    for (const Finding& finding : of_code(make_joint(plate_between_planes(c.h, c.planes), {}).findings, "not-thin"))
      told = worded(finding);
    EXPECT_EQ(told.empty(), std::string(c.told).empty()) << c.h << " " << c.planes.size() << " " << told;
    EXPECT_NE(told.find(c.told), std::string::npos) << c.h << " " << c.planes.size() << " " << told;
  }
}

TEST(Recognition, FaultsNameSettingsAsData) {
  const JointModel model = floating_layer(2.0);
  const JointFound found = find_joint(model, {});
  ASSERT_EQ(found.faults.size(), 1u);
  EXPECT_EQ(found.faults[0].expected.settings,
            (std::vector<NamedSetting>{
                {"attach", "layer", "BODY"}, {"bone", "layer", "SURFACE"}, {"thickness", "layer", "VALUE"}}));
  EXPECT_FALSE(found.faults[0].given);
  Settings settings;
  settings.attach["layer"] = "nobody";
  try {
    find_joint(model, settings);
    ADD_FAILURE() << "attached to nobody";
  } catch (const UsageError& e) {
    EXPECT_EQ(e.fault.given, (NamedSetting{"attach", "layer", "nobody"}));
    EXPECT_TRUE(e.fault.place.empty());
  }
}

// Without a thickness the modulus that is missing too is told, as a fault of its own.
TEST(Recognition, AllThatALayerLacksIsTold) {
  JointModel model = floating_layer(2.0);
  model.materials[0].E = std::nan("");
  Settings settings;
  settings.attach["layer"] = "left";
  const JointFound found = find_joint(model, settings);
  ASSERT_EQ(found.faults.size(), 2u);
  EXPECT_EQ(found.faults[0].found.text.substr(0, 50), "contact \"press\", surface \"layer\": no face of its l");
  EXPECT_EQ(found.faults[1].expected.settings, (std::vector<NamedSetting>{{"E", "layer", "VALUE"}}));  // nu is known
  model.materials[0].nu = std::nan("");
  EXPECT_EQ(find_joint(model, settings).faults.at(1).expected.settings,
            (std::vector<NamedSetting>{{"E", "layer", "VALUE"}, {"nu", "layer", "VALUE"}}));
}

TEST(Recognition, TheSamePairTwiceIsRefused) {
  JointModel model = flat_plates(4, 10, 2, 0.0);
  add_contact(model, "again", 1, 0);
  EXPECT_NE(refusal(model).find("join the same surfaces"), std::string::npos);
  Settings settings;
  settings.contact = "press";
  EXPECT_EQ(refusal(model, settings), "");
}

TEST(Recognition, AFacetTwiceIsRefused) {
  JointModel model = flat_plates(4, 10, 2, 0.0);
  Surface& s = model.surfaces[0];
  s.nodes.insert(s.nodes.end(), s.nodes.begin(), s.nodes.begin() + 4);
  s.begin.push_back(static_cast<int>(s.nodes.size()));
  EXPECT_NE(refusal(model).find("facets 1 and 17 are the same"), std::string::npos) << refusal(model);
}

// The readers of files refuse these before; who fills a JointModel otherwise is told here.
TEST(Recognition, WhatNoFileSaysIsRefusedToo) {
  const JointModel plates = flat_plates(4, 10, 2, 0.0);
  JointModel model = plates;
  model.contacts[0].secondary = -1;
  EXPECT_NE(refusal(model).find("contact \"press\" lacks a surface: give it two"), std::string::npos) << refusal(model);
  model = plates;
  Surface& s = model.surfaces[static_cast<std::size_t>(model.contacts[0].primary)];
  s.nodes.clear();
  s.begin = {0};
  EXPECT_NE(refusal(model).find(" has no facets: define it again, or take its contact out"), std::string::npos)
      << refusal(model);
  model = plates;
  model.rigid_cables.push_back({});
  model.rigid_cables[0].name = "muscle";
  EXPECT_NE(refusal(model).find("cable \"muscle\" has no points: add those it runs through"), std::string::npos)
      << refusal(model);
  model = plates;
  DiscreteSprings springs;
  springs.set = 0;
  springs.name = "ACL";
  springs.force = LoadController{};
  springs.force->unsupported = "type PID";
  model.discrete_sets.push_back({"ACL", {{0, 1}}, {}});
  model.discrete_springs.push_back(springs);
  EXPECT_NE(refusal(model).find("spring \"ACL\": its force is given by type PID, which is not supported; give points"),
            std::string::npos)
      << refusal(model);
}

// Relative to the pose when it became active: outside steps at the start, inside a step at the step's start.
TEST(Conditions, RelativeMotion) {
  for (bool in_step : {false, true}) {
    JointModel model = flat_plates(4, 10, 2, 0.0);
    model.steps.push_back(model.steps[0]);
    fix(model, 2, {true, true, false, true, true, true});
    for (int step = 0; step < (in_step ? 2 : 1); ++step) {
      prescribe(model, 2, 2, -0.1);
      model.rigid_prescribed.back().value = {-0.1, -1};
      model.rigid_prescribed.back().relative = true;
      model.rigid_prescribed.back().step = in_step ? step : -1;
    }
    const Analysis analysis = analyse(model, {});
    EXPECT_NEAR(analysis.states.back().equilibrium.poses[1].center.z(), in_step ? -0.2 : -0.1, 1e-12);
  }
}

// FEBio adds a relative rotation to the components of the vector that the body has turned by; it does not turn it once
// more.
TEST(Conditions, RelativeRotationAddsToTheRotationVector) {
  JointModel model = flat_plates(4, 10, 2, 5.0);  // apart: the poses alone count
  model.steps.push_back(model.steps[0]);
  fix(model, 2, {true, true, true, false, false, false});
  const double values[2][3] = {{0, 0, 1.2}, {0.3, 0, 0}};
  for (int step = 0; step < 2; ++step)
    for (int k = 0; k < 3; ++k) {
      prescribe(model, 2, 3 + k, values[step][k]);
      model.rigid_prescribed.back().value = {values[step][k], -1};
      model.rigid_prescribed.back().relative = step == 1;
      model.rigid_prescribed.back().step = step;
    }
  const Eigen::AngleAxisd turned(analyse(model, {}).states.back().equilibrium.poses[1].rotation);
  const Vector3d vector = turned.angle() * turned.axis();
  EXPECT_NEAR((vector - Vector3d(0.3, 0, 1.2)).norm(), 0, 1e-12) << vector.transpose();
}

// FEBio 4.11 counts the mass of shells twice beside solids (FERigidShellDomain::detJ0 has the whole thickness and the
// weights across it add up to 2): a block of volume 3 under a lid of volume 1.5.
TEST(Bodies, CentreOfMassOfSolidsAndShellsIsFebios) {
  JointModel model = empty_model();
  const int bone = add_material(model, "bone", true);
  model.materials[at(bone)].density = 2.0;
  model.materials[at(bone)].center_of_mass.reset();
  model.nodes = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 3}, {1, 0, 3}, {1, 1, 3}, {0, 1, 3}};
  Domain cube, lid;
  cube.material = lid.material = bone;
  cube.element_ids = {1};
  cube.nodes = {0, 1, 2, 3, 4, 5, 6, 7};
  lid.shape = ElementShape::Quad4;
  lid.element_ids = {2};
  lid.nodes = {4, 5, 6, 7};
  lid.shell_thickness.assign(4, 1.5);
  const auto center = [&](const std::vector<Domain>& domains) {
    model.domains = domains;
    return find_bodies(model, std::vector<char>(model.materials.size(), 1)).bodies[0].center_of_mass;
  };
  EXPECT_LT((center({cube}) - Vector3d(0.5, 0.5, 1.5)).norm(), 1e-12);
  EXPECT_LT((center({lid}) - Vector3d(0.5, 0.5, 3)).norm(), 1e-12);
  EXPECT_LT((center({cube, lid}) - Vector3d(0.5, 0.5, (3 * 1.5 + 2 * 1.5 * 3) / (3 + 2 * 1.5))).norm(), 1e-12);
}

// The flag counts outside steps too, though a rotation has nothing there to be relative to.
TEST(Conditions, RotationsThatAreRelativeInAndOutsideStepsGoTogether) {
  const auto turned = [](bool others) {
    JointModel model = flat_plates(4, 10, 2, 5.0);
    model.steps.push_back(model.steps[0]);
    fix(model, 2, {true, true, true, false, false, false});
    const std::array<std::array<int, 2>, 4> given = {{{3, 0}, {3, 1}, {4, -1}, {5, -1}}};  // dof and step
    for (const auto& [dof, step] : given) {
      prescribe(model, 2, dof, 0.1);
      model.rigid_prescribed.back().value = {0.1, -1};
      model.rigid_prescribed.back().relative = dof == 3 || others;
      model.rigid_prescribed.back().step = step;
    }
    return rotation_vector(analyse(model, {}).states.back().equilibrium.poses[1].rotation);
  };
  EXPECT_NEAR((turned(true) - Vector3d(0.2, 0.1, 0.1)).norm(), 0, 1e-12) << turned(true).transpose();
  EXPECT_THROW(turned(false), InputError);
}

// FEBio stops with "All or none rigid rotations must have relative flag set"; a fixed one counts as not set.
TEST(Conditions, RotationsOfWhichSomeAreRelativeAreRefused) {
  for (const bool fixed : {false, true}) {
    JointModel model = flat_plates(4, 10, 2, 5.0);
    model.steps.push_back(model.steps[0]);
    fix(model, 2, {true, true, true, fixed, fixed, false});
    for (int k = fixed ? 2 : 0; k < 3; ++k) {
      prescribe(model, 2, 3 + k, 0.1);
      model.rigid_prescribed.back().value = {0.1, -1};
      model.rigid_prescribed.back().relative = k == 2;
      model.rigid_prescribed.back().step = 1;
    }
    try {
      analyse(model, {});
      ADD_FAILURE() << fixed;
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find("some rotations are prescribed as relative and others are not"),
                std::string::npos)
          << e.what();
    }
  }
}

// A load that slides the plate off, for one state only: the next starts from the last pose that was solved.
TEST(Conditions, AnUnsolvedStateDoesNotSpoilTheNext) {
  JointModel model = flat_plates(8, 20, 2, 0.05, 10);
  model.steps[0].step_size = 0.25;
  fix(model, 2, {false, true, false, true, true, true});
  force(model, 2, {0, 0, -200});
  LoadController spike;
  spike.id = 2;
  spike.points = {{0, 0}, {0.4, 0}, {0.5, 1}, {0.6, 0}, {1, 0}};
  model.controllers.push_back(spike);
  RigidLoad side;
  side.material = 2;
  side.dof = 0;
  side.value = {100.0, 1};
  model.rigid_loads.push_back(side);
  const Analysis analysis = analyse(model, {});
  ASSERT_EQ(analysis.states.size(), 5u);
  EXPECT_FALSE(solved(analysis.states[2].equilibrium.outcome));
  EXPECT_EQ(analysis.states[3].equilibrium.outcome, Outcome::Balanced);
  EXPECT_EQ(analysis.states[4].equilibrium.outcome, Outcome::Balanced);
}

TEST(Conditions, AnInfiniteLoadIsRefused) {
  JointModel model = flat_plates(4, 10, 2, 0.0);
  fix(model, 2, {true, true, false, true, true, true});
  force(model, 2, {0, 0, -1e300});
  model.rigid_loads.back().value.factor = -1e300;
  model.controllers[0].points = {{0, 0}, {1, 1e300}};
  EXPECT_THROW(analyse(model, {}), InputError);
}

// Six of each: sphere on a flat layer, coarse and fine facets on either side; the target's map is the contact, not a
// smear.
TEST(Fields, TargetMapKeepsTheContactArea) {
  const double R = 25, h = 2, d = 0.3;
  const int counts[][2] = {{40, 40}, {8, 60}};
  for (const auto& n : counts) {
    JointModel model = empty_model();
    const int cartilage = add_material(model, "cartilage", false), base = add_material(model, "base", true),
              ball = add_material(model, "ball", true);
    const int a = add_layer(
        model, "layer", n[0], n[0], 1, [=](double u, double v) { return Vector3d(12 * (u - 0.5), 12 * (v - 0.5), -h); },
        [=](double u, double v) { return Vector3d(12 * (u - 0.5), 12 * (v - 0.5), 0); }, cartilage, base);
    const int b = add_rigid_surface(
        model, "ball", n[1], n[1],
        [=](double u, double v) {
          const double x = 14 * (v - 0.5), y = 14 * (u - 0.5);
          return Vector3d(x, y, R - std::sqrt(R * R - x * x - y * y));
        },
        ball);
    add_contact(model, "press", a, b);
    fix(model, base, {true, true, true, true, true, true});
    fix(model, ball, {true, true, false, true, true, true});
    prescribe(model, ball, 2, -d);
    const StateResult s = analyse(model, test::linear()).states.back();
    const double exact = kPi * d * (2 * R - d);  // of the cap's circle: 46.8
    const SideFields& target = s.fields[0].sides[1];
    EXPECT_NEAR(target.contact_area / exact, 1.0, 0.15) << n[0] << " " << n[1];
    EXPECT_NEAR(target.resultant_factor, 1.0, 0.1) << n[0] << " " << n[1];
  }
}

TEST(Statistics, WeightedPercentile) {
  EXPECT_EQ(weighted_percentile({3, 1, 2}, {1, 1, 1}, 0.5), 2.0);
  EXPECT_EQ(weighted_percentile({4, 1, 3, 2}, {1, 1, 1, 1}, 0.5), 2.5);
  EXPECT_EQ(weighted_percentile({1, 2}, {3, 1}, 0.375), 1.0);  // the middle of the first one's share
  EXPECT_EQ(weighted_percentile({1, 2}, {3, 1}, 0.875), 2.0);
  EXPECT_NEAR(weighted_percentile({1, 2}, {3, 1}, 0.625), 1.5, 1e-15);
  EXPECT_TRUE(std::isnan(weighted_percentile({}, {}, 0.5)));
  // equal values: their shares follow each other, whatever their order
  const double between = 2 + (3.0 - 2.5) / (5.5 - 2.5);
  EXPECT_NEAR(weighted_percentile({1, 3, 1, 1}, {1, 3, 1, 2}, 2.5 / 7), 1.0, 1e-15);
  EXPECT_NEAR(weighted_percentile({2, 1, 2, 3}, {1, 1, 1, 5}, 3.0 / 8), between, 1e-15);
  EXPECT_NEAR(weighted_percentile({3, 2, 1, 2}, {5, 1, 1, 1}, 3.0 / 8), between, 1e-15);
}

TEST(SurfaceMesh, SphereFit) {
  const Joint joint = make_joint(concentric_spheres(12, 1.0), {});
  const SphereFit fit = fit_sphere(joint.contacts[0].layers[1].articular);
  EXPECT_LT(fit.center.norm(), 1e-9);
  EXPECT_NEAR(fit.radius, 20.0, 1e-9);
  EXPECT_LT(fit.rms, 1e-9);
}

// A sphere goes through the corners of every rectangle, about its middle; only its normals tell that it is none.
TEST(SurfaceMesh, CornersOfAFlatAreNoSphere) {
  const auto rises = [](double height) {  // the middle of a square of side 2, lifted
    return make_surface_mesh({0, 3, 6, 9, 12}, {0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4},
                             {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {0, 0, height}});
  };
  const SurfaceMesh square = make_surface_mesh({0, 4}, {0, 1, 2, 3}, {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}});
  const SphereFit fit = fit_sphere(square);
  EXPECT_NEAR(fit.radius, std::sqrt(2.0), 1e-12);
  EXPECT_LT(fit.rms, 1e-12);
  EXPECT_EQ(roundness(square, fit), Roundness::Flat);
  // five points on a sphere of radius R = (2 + h^2)/(2h)
  EXPECT_EQ(roundness(rises(0.5), fit_sphere(rises(0.5))), Roundness::Round);
  EXPECT_NEAR(fit_sphere(rises(0.5)).radius, 2.25, 1e-12);
  EXPECT_EQ(roundness(rises(0.05), fit_sphere(rises(0.05))), Roundness::Flat);  // R = 20, radius of gyration .82
}

/// Triangles over a grid of squares of side `size`, on both sides of x = 0 and y = 0 each other's mirror images: of the
/// whole, or of its quarter x, y >= 0 alone.
struct GridSurface {
  std::vector<int> begin = {0}, nodes;
  std::vector<Vector3d> points;
  std::vector<unsigned char> planes;  // per point
};

GridSurface grid_surface(int n, double size, bool quarter, const std::function<double(double, double)>& height) {
  GridSurface grid;
  const int least = quarter ? 0 : -n, row = n - least + 1;
  for (int j = least; j <= n; ++j)
    for (int i = least; i <= n; ++i) {
      grid.points.emplace_back(size * i, size * j, height(size * i, size * j));
      grid.planes.push_back(static_cast<unsigned char>((i == 0 ? 1 : 0) | (j == 0 ? 2 : 0)));
    }
  for (int j = least; j < n; ++j)
    for (int i = least; i < n; ++i) {
      const int v = (j - least) * row + i - least;
      const std::array<int, 4> q = {v, v + 1, v + row + 1, v + row};
      const bool rising = (i >= 0) == (j >= 0);  // the diagonal points to the middle
      for (const std::array<int, 3>& t : rising ? std::array<std::array<int, 3>, 2>{{{0, 1, 2}, {0, 2, 3}}}
                                                : std::array<std::array<int, 3>, 2>{{{0, 1, 3}, {1, 2, 3}}}) {
        for (const int k : t) grid.nodes.push_back(q[static_cast<std::size_t>(k)]);
        grid.begin.push_back(static_cast<int>(grid.nodes.size()));
      }
    }
  return grid;
}

// Normals and bulges of a quarter are those of the whole: on a sphere, a saddle, and roofs too sharp and not too sharp
// for a round surface.
TEST(SurfaceMesh, AQuarterIsRoundAsTheWholeIs) {
  constexpr int n = 4;
  const std::function<double(double, double)> heights[] = {
      [](double x, double y) { return std::sqrt(1600 - x * x - y * y); },
      [](double x, double y) { return 0.02 * x * x - 0.01 * y * y; },
      [](double x, double y) { return 0.5 * std::abs(x) + 0.01 * y * y; },
      [](double x, double y) { return 0.2 * std::abs(y) + 0.01 * x * x; },
      [](double x, double y) { return 0.08 * std::abs(x) + 0.1 * std::abs(y); },
      [](double x, double y) { return 2.0 * std::abs(x) + 0.01 * y * y; },
  };
  for (std::size_t h = 0; h < std::size(heights); ++h) {
    SCOPED_TRACE(h);
    const GridSurface all = grid_surface(n, 4.0, false, heights[h]), part = grid_surface(n, 4.0, true, heights[h]);
    const SurfaceMesh whole = make_surface_mesh(all.begin, all.nodes, all.points);
    const SurfaceMesh quarter = make_surface_mesh(part.begin, part.nodes, part.points, nullptr, part.planes);
    std::map<std::array<double, 6>, double> bulges;  // by the edge's ends
    std::map<std::array<double, 2>, Vector3d> normals;
    const auto ends = [](const SurfaceMesh& mesh, int t, int k) {
      const Vector3d a = mesh.corner(t, k), b = mesh.corner(t, (k + 1) % 3);
      return std::array<double, 6>{a.x(), a.y(), a.z(), b.x(), b.y(), b.z()};
    };
    for (int t = 0; t < whole.size(); ++t)
      for (int k = 0; k < 3; ++k)
        bulges[ends(whole, t, k)] = whole.bulge[static_cast<std::size_t>(t)][static_cast<std::size_t>(k)];
    for (std::size_t v = 0; v < whole.vertices.size(); ++v)
      normals[{whole.vertices[v].x(), whole.vertices[v].y()}] = whole.vertex_normals[v];
    for (int t = 0; t < quarter.size(); ++t)
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(quarter.bulge[static_cast<std::size_t>(t)][static_cast<std::size_t>(k)],
                    bulges.at(ends(quarter, t, k)), 1e-13);
    for (std::size_t v = 0; v < quarter.vertices.size(); ++v)
      EXPECT_LT((quarter.vertex_normals[v] - normals.at({quarter.vertices[v].x(), quarter.vertices[v].y()})).norm(),
                1e-13);
  }
  // on the sphere every edge at the pole rises as the circle through its ends does, to a^4/R^3
  const GridSurface part = grid_surface(n, 4.0, true, heights[0]);
  const auto error_at_pole = [](const SurfaceMesh& mesh) {
    double worst = 0.0;
    for (int t = 0; t < mesh.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        const Vector3d &a = mesh.corner(t, k), &b = mesh.corner(t, (k + 1) % 3);
        if (a.head<2>().norm() > 0 && b.head<2>().norm() > 0) continue;
        const double rise = 0.25 * mesh.bulge[static_cast<std::size_t>(t)][static_cast<std::size_t>(k)],
                     exact = (a - b).squaredNorm() / (8 * 40);
        worst = std::max(worst, std::abs(rise / exact - 1));
      }
    return worst;
  };
  EXPECT_GT(error_at_pole(make_surface_mesh(part.begin, part.nodes, part.points)), 0.2);
  EXPECT_LT(error_at_pole(make_surface_mesh(part.begin, part.nodes, part.points, nullptr, part.planes)), 0.01);
  // parts of it keep the planes, and so do vertices on them
  const SurfaceMesh parts = divided(make_surface_mesh(part.begin, part.nodes, part.points, nullptr, part.planes), 2);
  ASSERT_EQ(parts.planes.size(), parts.vertices.size());
  for (std::size_t v = 0; v < parts.vertices.size(); ++v)
    EXPECT_EQ(parts.planes[v], (parts.vertices[v].x() == 0 ? 1 : 0) | (parts.vertices[v].y() == 0 ? 2 : 0));
}

/// A rigid ball of radius 40 over flat cartilage, 2 thick, or, `domed`, bare rigid flat under a ball with cartilage of
/// even thickness; a quarter, x and y >= 0, or the whole. Facets of the ball: `size`.
JointModel ball_on_flat(double size, bool quarter, bool domed) {
  JointModel model = empty_model();
  const int cartilage = add_material(model, "cartilage", false), flat = add_material(model, "flat", true),
            ball = add_material(model, "ball", true);
  const double low = quarter ? 0.0 : -16.0, width = 16.0 - low;
  const auto over = [=](double height) {
    return [=](double u, double v) { return Vector3d(low + width * u, low + width * v, height); };
  };
  const auto sphere = [=](double R) {
    return [=](double u, double v) {  // du x dv points down
      const Vector3d x(low + width * v, low + width * u, 0);
      return Vector3d(x.x() * R / 40, x.y() * R / 40, 40 - R / 40 * std::sqrt(1600 - x.squaredNorm()));
    };
  };
  const int n = static_cast<int>(std::lround(width / size)), fine = static_cast<int>(std::lround(width));
  const int below = domed ? add_rigid_surface(model, "below", fine, fine, over(0), flat)
                          : add_layer(model, "below", fine, fine, 3, over(-2), over(0), cartilage, flat);
  const int above = domed ? add_layer(model, "above", n, n, 1, sphere(38), sphere(40), cartilage, ball)
                          : add_rigid_surface(model, "above", n, n, sphere(40), ball);
  add_contact(model, "press", above, below);
  fix(model, flat, {true, true, true, true, true, true});
  fix(model, ball, {true, true, false, true, true, true});
  prescribe(model, ball, 2, -0.3);
  if (quarter)
    for (std::size_t k = 0; k < 2; ++k) {
      FixedNodes plane;
      plane.xyz[k] = true;
      for (std::size_t i = 0; i < model.nodes.size(); ++i)
        if (model.nodes[i][static_cast<int>(k)] == 0) plane.nodes.push_back(static_cast<int>(i));
      model.fixed_nodes.push_back(plane);
    }
  return model;
}

// Linear springs under a ball pressed in by d: F = K/t pi R d^2, whatever the facets, for the whole and for a quarter,
// and a layer between two spheres is as thick as their radii differ, up to the planes of symmetry.
TEST(Planes, AQuarterCarriesAQuarter) {
  const double K = kE * (1 - kNu) / ((1 + kNu) * (1 - 2 * kNu)), exact = K / 2 * kPi * 40 * 0.09;
  for (const bool domed : {false, true})
    for (const double size : {1.0, 2.0, 4.0}) {
      SCOPED_TRACE(fmt::format("{} facets of {}", domed ? "domed" : "bare", size));
      const auto carried = [&](bool quarter) {
        const Analysis run = analyse(ball_on_flat(size, quarter, domed), test::linear("flat"));
        EXPECT_EQ(run.joint.symmetry_planes.size(), quarter ? 2u : 0u);
        if (domed) {
          const Layer& layer = run.joint.contacts[0].layers[0];
          for (std::size_t v = 0; v < layer.thickness.size(); ++v) {
            const bool free_edge = layer.articular.vertices[v].head<2>().cwiseAbs().maxCoeff() > 15.9;
            EXPECT_EQ(layer.missed[v] != 0, free_edge);
            EXPECT_NEAR(layer.thickness[v], 2.0, 0.005);
          }
        }
        return (quarter ? 4 : 1) * std::abs(run.states.back().fields[0].sides[0].force.z());
      };
      const double whole = carried(false), quarter = carried(true);
      EXPECT_NEAR(whole / exact, 1.0, 0.03);
      EXPECT_NEAR(quarter / whole, 1.0, 0.01);
    }
}

// The mirror image of a bone that crosses a plane of symmetry would cross it the other way: that is no joint. Along the
// planes a body may move, and both together may go anywhere.
TEST(Planes, BodiesKeepToThem) {
  const JointModel model = ball_on_flat(2.0, true, false);
  const auto placed = [&](Vector3d shift, Vector3d turn, bool both) {
    const Joint joint = make_joint(model, test::linear("flat"));
    std::vector<Pose> poses = reference_poses(joint);
    const double angle = turn.norm();
    const Eigen::Matrix3d R =
        angle > 0 ? Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() : Eigen::Matrix3d::Identity();
    for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
      if (joint.bodies[b].ground || (joint.bodies[b].name == "flat" && !both)) continue;
      poses[b] = {shift + R * joint.bodies[b].center_of_mass, R};
    }
    return left_plane(joint.contacts[0], joint.bodies, poses);
  };
  EXPECT_FALSE(placed({0, 0, -0.3}, {0, 0, 0}, false));
  EXPECT_FALSE(placed({1, 2, 3}, {0.1, 0.2, 0.3}, true));
  const auto crossed = placed({0, 0.25, 0}, {0, 0, 0}, false), turned = placed({0, 0, 0}, {0, 0.1, 0}, false);
  ASSERT_TRUE(crossed && turned);
  EXPECT_EQ(crossed->plane, (SymmetryPlane{1, 0.0}));
  EXPECT_NEAR(crossed->shift, 0.25, 1e-12);
  EXPECT_EQ(turned->plane, (SymmetryPlane{0, 0.0}));  // the turn is about y
  EXPECT_TRUE(placed({0, 0, 0}, {0, 0, 0.1}, false));
  Settings moved = test::linear("flat");
  moved.placements.push_back({Placement::Kind::Move, "ball", {0.25, 0, 0}});
  EXPECT_THROW(analyse(model, moved), InputError);
  EXPECT_NO_THROW(analyse(ball_on_flat(2.0, false, false), moved));
}

// Where both surfaces end in one plane across an axis, held or not.
TEST(Planes, EndsThatSurfacesShare) {
  JointModel model = ball_on_flat(2.0, true, false);
  const auto ends = [&] {
    std::vector<std::pair<double, bool>> found;
    for (const SharedEnd& end : shared_ends(make_joint(model, test::linear("flat")).contacts[0]))
      found.push_back({end.plane.at, end.symmetry});
    return found;
  };
  EXPECT_EQ(ends(), (std::vector<std::pair<double, bool>>{{0, true}, {16, false}, {0, true}, {16, false}}));
  model.fixed_nodes.erase(model.fixed_nodes.end() - 2);
  EXPECT_EQ(ends(), (std::vector<std::pair<double, bool>>{{0, false}, {16, false}, {0, true}, {16, false}}));
}

// Only where a part ends, and at more than half its nodes: a few held nodes, or nodes held inside, make no plane.
TEST(Planes, AreWhereAPartEndsAndIsHeld) {
  const auto planes_of = [](double where, int axis, int most) {
    JointModel model = ball_on_flat(2.0, false, false);
    FixedNodes held;
    held.xyz[static_cast<std::size_t>(axis)] = true;
    for (std::size_t i = 0; i < model.nodes.size() && static_cast<int>(held.nodes.size()) < most; ++i)
      if (model.nodes[i][axis] == where) held.nodes.push_back(static_cast<int>(i));
    model.fixed_nodes.push_back(held);
    return make_joint(model, {}).symmetry_planes;
  };
  EXPECT_EQ(planes_of(-16, 0, 1000), (std::vector<SymmetryPlane>{{0, -16.0}}));
  EXPECT_EQ(planes_of(16, 1, 1000), (std::vector<SymmetryPlane>{{1, 16.0}}));
  EXPECT_TRUE(planes_of(16, 1, 6).empty());
  JointModel top = ball_on_flat(2.0, true, false);  // of the planes the articular edge alone is held: told
  for (FixedNodes& held : top.fixed_nodes)
    held.nodes.erase(std::remove_if(held.nodes.begin(), held.nodes.end(),
                                    [&](int node) { return top.nodes[static_cast<std::size_t>(node)].z() < 0; }),
                     held.nodes.end());
  const std::string alone = "32 edges of its rim are held across an axis, but lie in no plane in which more than half";
  EXPECT_FALSE(told(ball_on_flat(2.0, true, false), alone));
  EXPECT_TRUE(make_joint(top, {}).symmetry_planes.empty());
  EXPECT_TRUE(told(top, alone));
  EXPECT_TRUE(planes_of(0, 0, 1000).empty());
  JointModel stated = ball_on_flat(2.0, true, false);  // its cartilage is rigid, and a contact says where they are
  const std::vector<SymmetryPlane> planes = make_joint(stated, {}).symmetry_planes;
  stated.fixed_nodes.clear();
  EXPECT_TRUE(make_joint(stated, {}).symmetry_planes.empty());
  stated.contacts[0].dea = DeaContact();
  stated.contacts[0].dea->symmetry_planes = planes;
  const Joint joint = make_joint(stated, {});
  EXPECT_EQ(joint.symmetry_planes, planes);
  EXPECT_EQ(joint.findings.front().code, "symmetry-planes");
  EXPECT_EQ(test::text(joint.findings.front(), "planes"), "x = 0, y = 0");
}

int node_at(const JointModel& model, const Vector3d& x) {
  for (std::size_t i = 0; i < model.nodes.size(); ++i)
    if ((model.nodes[i] - x).norm() < 1e-9) return static_cast<int>(i);
  return -1;
}

/// A joint and what is carried across it.
struct HeldQuarter {
  Joint joint;
  double force = 0.0;
};

HeldQuarter held_quarter(const JointModel& model) {
  Analysis run = analyse(model, test::linear("flat"));
  return {std::move(run.joint), std::abs(run.states.back().fields[0].sides[0].force.z())};
}

/// Of this code, at planes across this axis.
Findings told_across(const Joint& joint, const char* code, const std::string& axis) {
  Findings found;
  for (const Finding& f : of_code(joint.findings, code))
    if (test::text(f, "axis") == axis) found.push_back(f);
  return found;
}

// Rounding leaves noise on a plane: up to a thousandth of the facets it is the same plane.
TEST(Planes, NoiseOfCoordinatesDoesNotMatter) {
  const JointModel exact = ball_on_flat(2.0, true, false);
  JointModel noisy = exact;
  for (std::size_t i = 0; i < noisy.nodes.size(); ++i)
    for (int k = 0; k < 2; ++k)
      if (noisy.nodes[i][k] == 0) noisy.nodes[i][k] = 4e-4 * std::sin(7.0 * static_cast<double>(i) + k);
  const HeldQuarter a = held_quarter(exact), b = held_quarter(noisy);
  EXPECT_EQ(b.joint.symmetry_planes, a.joint.symmetry_planes);
  EXPECT_NEAR(b.force / a.force, 1.0, 1e-3);
  EXPECT_EQ(b.joint.contacts[0].layers[1].missed_count(), 0);
  noisy.nodes[at(node_at(exact, {0, 5, 0}))].x() = -0.1;  // no noise: the part ends there
  EXPECT_EQ(held_quarter(noisy).joint.symmetry_planes, (std::vector<SymmetryPlane>{{1, 0.0}}));
}

// One node of 51 is forgotten: the others leave it no way, and it is named.
TEST(Planes, AForgottenNodeIsHeldWithTheOthers) {
  const JointModel exact = ball_on_flat(2.0, true, false);
  JointModel model = exact;
  const int forgotten = node_at(model, {0, 3, 0});
  std::vector<int>& held = model.fixed_nodes[0].nodes;
  held.erase(std::remove(held.begin(), held.end(), forgotten), held.end());
  const HeldQuarter a = held_quarter(exact), b = held_quarter(model);
  EXPECT_EQ(a.force, b.force);
  const Findings told = told_across(b.joint, "plane-node-forgotten", "x");
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(test::number(told[0], "of"), 17 * 3);  // three rows above the bone
  EXPECT_EQ(test::number(told[0], "forgotten"), 1);
  EXPECT_EQ(test::value_of<std::vector<int>>(told[0], "nodes"), std::vector<int>{model.node_ids[at(forgotten)]});
  EXPECT_FALSE(told_of(a.joint, "plane-node-forgotten"));
}

// Held in y where the part ends in x: no plane, and not silent. A strip that is held in y all through is none of these.
TEST(Planes, HeldInTheWrongComponentIsTold) {
  JointModel model = ball_on_flat(2.0, true, false);
  std::swap(model.fixed_nodes[0].xyz[0], model.fixed_nodes[0].xyz[1]);
  const Joint joint = make_joint(model, {});
  EXPECT_EQ(joint.symmetry_planes, (std::vector<SymmetryPlane>{{1, 0.0}}));
  const Findings told = told_across(joint, "plane-held-across", "x");
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(test::text(told[0], "instead"), "y");
  JointModel strip = ball_on_flat(2.0, true, false);
  for (std::size_t i = 0; i < strip.nodes.size(); ++i) strip.fixed_nodes[1].nodes.push_back(static_cast<int>(i));
  EXPECT_FALSE(told_of(make_joint(strip, {}), "plane-held-across"));
}

/// The model with the nodes held in `component` where `where` says so.
JointModel with_held(JointModel model, int component, const std::function<bool(const Vector3d&)>& where) {
  FixedNodes nodes;
  nodes.xyz[static_cast<std::size_t>(component)] = true;
  for (std::size_t i = 0; i < model.nodes.size(); ++i)
    if (where(model.nodes[i])) nodes.nodes.push_back(static_cast<int>(i));
  model.fixed_nodes.push_back(nodes);
  return model;
}

/// A block of cartilage, x from 0 to 8, y from 0 to 4, under a plate; nodes where `where` says are held in
/// `component`.
JointModel held_block(int nx, int ny, int component, const std::function<bool(const Vector3d&)>& where) {
  JointModel model = empty_model();
  const int cartilage = add_material(model, "cartilage", false), bone = add_material(model, "bone", true),
            plate = add_material(model, "plate", true);
  const auto over = [](double z) { return [z](double u, double v) { return Vector3d(8 * u, 4 * v, z); }; };
  const int top = add_layer(model, "layer", nx, ny, 2, over(-1), over(0), cartilage, bone);
  const int above = add_rigid_surface(
      model, "above", 2, 2, [](double u, double v) { return Vector3d(8 * v, 4 * u, 0.1); }, plate);
  add_contact(model, "press", above, top);
  return with_held(std::move(model), component, where);
}

// However few nodes there are, at one end or both, in either other component: that end is told, and no other one.
TEST(Planes, TheEndThatIsHeldInTheWrongComponentIsTold) {
  for (const int n : {3, 4, 6, 10})
    for (const int component : {1, 2})
      for (const bool both : {false, true}) {
        SCOPED_TRACE(fmt::format("{} elements, held in {}, {}", n, component, both));
        const JointModel model = held_block(
            n, n, component, [&](const Vector3d& x) { return x.z() > -1 && (x.x() == 0 || (both && x.x() == 8)); });
        const Joint joint = make_joint(model, {});
        EXPECT_TRUE(joint.symmetry_planes.empty());
        std::vector<double> told;
        for (const Finding& f : of_code(joint.findings, "plane-held-across")) {
          EXPECT_EQ(test::text(f, "axis"), "x");
          EXPECT_EQ(test::text(f, "instead"), std::string(1, "xyz"[component]));
          told.push_back(test::number(f, "at"));
        }
        EXPECT_EQ(told, both ? (std::vector<double>{0, 8}) : std::vector<double>{0});
      }
  // Walls without friction along y: nothing else is meant
  for (const int n : {1, 4})
    EXPECT_FALSE(
        told_of(make_joint(held_block(8, n, 1, [](const Vector3d& x) { return x.y() == 0 || x.y() == 4; }), {}),
                "plane-held-across"));
}

// Held in the plane too, or inside: what the layer's law has no place for, and the corners of two planes are no such.
TEST(Planes, NodesHeldWhereNoPlaneIsAreTold) {
  const auto found = [](const JointModel& model) {
    std::vector<std::pair<int, std::size_t>> all;
    const Joint joint = make_joint(model, {});
    for (const Finding& f : of_code(joint.findings, "held-in-no-plane"))
      all.emplace_back(test::text(f, "component")[0] - 'x', test::value_of<std::vector<int>>(f, "nodes").size());
    return all;
  };
  using Found = std::vector<std::pair<int, std::size_t>>;
  const auto in_x = [](const Vector3d& x) { return x.x() == 0; };
  const auto in_y = [](const Vector3d& x) { return x.y() == 0; };
  const JointModel one = held_block(6, 6, 0, in_x), both = with_held(one, 1, in_y);
  EXPECT_EQ(found(one), Found());
  EXPECT_EQ(found(both), Found());
  EXPECT_EQ(found(with_held(one, 1, in_x)), (Found{{1, 14}}));  // two rows of seven above the bone
  EXPECT_EQ(found(with_held(both, 1, in_x)), (Found{{1, 12}}));
  EXPECT_EQ(found(with_held(both, 2, [](const Vector3d& x) { return x.x() == 4 && x.y() == 2; })), (Found{{2, 2}}));
  EXPECT_EQ(found(with_held(both, 1, [](const Vector3d& x) { return x.x() == 4 && x.y() == 2 && x.z() == 0; })),
            (Found{{1, 1}}));
  // between two planes all of it is held along them: the inner five of seven rows, above the bone
  EXPECT_EQ(found(held_block(6, 6, 1, [](const Vector3d&) { return true; })), (Found{{1, 7 * 5 * 2}}));
  // the pressed face itself is no plane
  const JointModel face = held_block(6, 6, 2, [](const Vector3d& x) { return x.z() == 0; });
  EXPECT_TRUE(make_joint(face, {}).symmetry_planes.empty());
  EXPECT_EQ(found(face), (Found{{2, 49}}));
}

// Glued to its own bone the pressed face cannot give way, though its springs do; its rim may be, as in a bowl of bone.
TEST(Recognition, APressedFaceThatIsHeldIsTold) {
  const auto found = [](const std::function<bool(const Vector3d&)>& where, int body, const std::string& attach = "") {
    JointModel model = held_block(6, 6, 0, [](const Vector3d&) { return false; });
    RigidNodes glue;
    glue.material = body;
    for (std::size_t i = 0; i < model.nodes.size(); ++i)
      if (where(model.nodes[i]) && model.nodes[i].z() <= 0) glue.nodes.push_back(static_cast<int>(i));
    model.rigid_nodes.push_back(glue);
    Settings settings;
    if (!attach.empty()) settings.attach["layer"] = attach;
    return of_code(make_joint(model, settings).findings, "held-in-layer");
  };
  const auto on_top = [](const Vector3d& x) { return x.z() == 0; };
  ASSERT_EQ(found(on_top, 1).size(), 1u);
  EXPECT_EQ(found(on_top, 1)[0].form, 0) << "on its face";
  EXPECT_EQ(test::value_of<std::vector<int>>(found(on_top, 1)[0], "nodes").size(), 25u);
  EXPECT_TRUE(found([](const Vector3d& x) { return x.x() == 0; }, 1).empty());
  const Findings by_plate = found([](const Vector3d& x) { return x.x() == 8 && x.z() > -0.9; }, 2, "bone");
  ASSERT_EQ(by_plate.size(), 1u);
  EXPECT_EQ(by_plate[0].form, 1) << "anywhere in it";
  EXPECT_EQ(test::value_of<std::vector<int>>(by_plate[0], "nodes").size(), 14u);
}

// Noise that is wider than a thousandth of the facets leaves no plane, not one of the three outermost nodes either.
TEST(Planes, MuchNoiseLeavesNone) {
  JointModel model = held_block(10, 10, 0, [](const Vector3d& x) { return x.x() == 0; });
  EXPECT_EQ(make_joint(model, {}).symmetry_planes, (std::vector<SymmetryPlane>{{0, 0.0}}));
  for (const int node : model.fixed_nodes[0].nodes) model.nodes[at(node)].x() = 0.004 * std::sin(11.0 * node);
  EXPECT_TRUE(make_joint(model, {}).symmetry_planes.empty());
}

TEST(Planes, StepsInWhichTheyAreNotHeldAreTold) {
  JointModel model = ball_on_flat(2.0, true, false);
  model.steps.push_back(model.steps.back());
  const auto steps = [&](const char* axis) {  // none: it is held in all
    const Findings told = told_across(make_joint(model, {}), "plane-in-some-steps", axis);
    return told.empty() ? std::vector<std::string>() : names_in(told[0], "held");
  };
  EXPECT_TRUE(steps("y").empty());
  model.fixed_nodes[1].step = 1;
  EXPECT_TRUE(steps("x").empty());
  EXPECT_EQ(steps("y"), std::vector<std::string>{"2"});
  FixedNodes first = model.fixed_nodes[1];
  first.step = 0;
  model.fixed_nodes.push_back(first);
  EXPECT_TRUE(steps("y").empty());
}

/// A ball on a flat, pressed at a height above its centre. It may roll about x and y; slide and spin only where it is
/// told.
struct RollingBall {
  Equilibrium state;
  double length = 0.0;  ///< by which its rotations are scaled
};
RollingBall rolling_ball(double force_down, double height, bool slides) {
  JointModel model = ball_on_flat(1.0, false, false);
  model.rigid_prescribed.clear();
  if (slides)
    model.rigid_fixed.pop_back();
  else
    model.rigid_fixed.back().dofs = {true, true, false, false, false, true};
  constexpr int kBall = 2;  // the third material
  model.materials[kBall].center_of_mass = Vector3d(0, 0, 40 + height);
  force(model, kBall, {0, 0, -force_down});
  const Analysis run = analyse(model, test::linear("flat"));
  return {run.states.back().equilibrium, make_spring_beds(run.joint).length};
}

// Held against sliding, a force F that acts at a height d above the ball's centre has the turning stiffness -F d,
// whatever presses below; the flat's facets of 1 mm are 2 % off.
TEST(Stability, OfABallIsItsLoadsHeightAboveItsCentre) {
  for (const double height : {2.0, 8.0, 16.0, -8.0, -16.0}) {
    SCOPED_TRACE(height);
    const auto [state, length] = rolling_ball(2000, height, false);
    EXPECT_TRUE(solved(state.outcome)) << state.message;
    EXPECT_TRUE(state.held.empty());
    EXPECT_NEAR(state.least_stiffness * length * length / (-2000 * height), 1.0, 0.03);
    EXPECT_EQ(state.unstable, height > 0);
  }
}

// Nothing resists its sliding: what the facets leave of that, whatever its sign, is no instability.
TEST(Stability, ABallThatMaySlideIsNeutral) {
  bool negative = false;
  for (const double force_down : {5.0, 10.0, 20.0, 100.0, 500.0, 2000.0}) {
    SCOPED_TRACE(force_down);
    const Equilibrium state = rolling_ball(force_down, 0, true).state;
    EXPECT_TRUE(solved(state.outcome)) << state.message;
    EXPECT_LT(std::abs(state.least_stiffness), 1e-5 * force_down);
    EXPECT_FALSE(state.unstable);
    negative = negative || state.least_stiffness < 0;
  }
  EXPECT_TRUE(negative) << "of no use: no trace below zero";
}

TEST(SurfaceMesh, AnEllipsoidIsUneven) {
  const Joint joint = make_joint(concentric_spheres(12, 1.0), {});
  SurfaceMesh stretched = joint.contacts[0].layers[1].articular;
  for (Vector3d& x : stretched.vertices) x.x() *= 2.5;
  EXPECT_EQ(roundness(stretched, fit_sphere(stretched)), Roundness::Uneven);
}

// Squares of side 0.5, 20 by 20 of them, of which some are pressed.
TEST(Statistics, FacetsAcrossContact) {
  constexpr int kSquares = 20;
  std::vector<Vector3d> points;
  for (int j = 0; j <= kSquares; ++j)
    for (int i = 0; i <= kSquares; ++i) points.emplace_back(0.5 * i, 0.5 * j, 0);
  std::vector<int> begin = {0}, nodes;
  for (int j = 0; j < kSquares; ++j)
    for (int i = 0; i < kSquares; ++i) {
      const int n = j * (kSquares + 1) + i;
      for (const int corner : {n, n + 1, n + kSquares + 2, n + kSquares + 1}) nodes.push_back(corner);
      begin.push_back(static_cast<int>(nodes.size()));
    }
  Layer layer;
  layer.articular = make_surface_mesh(begin, nodes, points);
  const auto across = [&](const auto& is_pressed) {
    std::vector<double> pressure;
    for (int j = 0; j < kSquares; ++j)
      for (int i = 0; i < kSquares; ++i) pressure.push_back(is_pressed(i, j) ? 2.0 : 0.1);
    return facets_across(layer, pressure, 0.1);
  };
  EXPECT_EQ(across([](int, int) { return false; }), 0.0);
  EXPECT_NEAR(across([](int, int j) { return j >= 4 && j < 8; }), 4.0, 1e-12);  // a strip has its width
  EXPECT_NEAR(across([](int i, int j) { return i >= 2 && i < 10 && j >= 3 && j < 9; }), 6.0,
              1e-12);                            // the shorter side
  for (const double radius : {3.0, 5.0, 8.0}) {  // a disc its diameter, but for half a square's diagonal on each side
    const double diameter = across([&](int i, int j) { return std::hypot(i - 9.5, j - 9.5) < radius; });
    EXPECT_NEAR(diameter, 2 * radius, std::sqrt(2.0));
  }
  EXPECT_NEAR(across([](int, int) { return true; }), 20.0, 1e-12);  // as far as the surface
  // half of a strip of width 8, cut by the plane of symmetry y = 0
  const auto half = [](int, int j) { return j < 4; };
  EXPECT_NEAR(across(half), 4.0, 1e-12);
  for (const Vector3d& x : points) layer.mirror.push_back(x.y() == 0 ? 2 : 0);
  EXPECT_NEAR(across(half), 8.0, 1e-12);
}

// -- contacts of type "dea": the cartilage is rigid with its bone, its modulus and thickness are the contact's
// ----------

/// Two-layered spheres whose cartilage is of the bones' own materials.
JointModel spheres_of_bone() {
  JointModel model = concentric_spheres(8, 2000, true);
  for (Domain& d : model.domains) {
    if (d.name == "socket articular") d.material = 1;
    if (d.name == "ball articular") d.material = 2;
  }
  DeaContact dea;
  for (DeaLayer& layer : dea.layers) {
    layer.E = kE;
    layer.nu = kNu;
  }
  model.contacts[0].dea = dea;
  model.contacts[0].type = "dea";
  return model;
}

/// A map that says of every facet node what was measured at its vertex.
std::vector<double> map_of(const JointModel& model, const Layer& layer) {
  std::map<int, double> at_node;
  for (std::size_t v = 0; v < layer.thickness.size(); ++v) at_node[layer.articular.model_nodes[v]] = layer.thickness[v];
  std::vector<double> map;
  for (int node : model.surfaces[static_cast<std::size_t>(layer.surface)].nodes) map.push_back(at_node.at(node));
  return map;
}

void expect_same_layers(const ContactPair& a, const ContactPair& b) {
  for (int side = 0; side < 2; ++side) {
    EXPECT_EQ(a.layers[side].body, b.layers[side].body);
    EXPECT_EQ(a.layers[side].elasticity.E, b.layers[side].elasticity.E);
    EXPECT_EQ(a.layers[side].elasticity.nu, b.layers[side].elasticity.nu);
    EXPECT_EQ(a.layers[side].rigid, b.layers[side].rigid);
    EXPECT_EQ(a.layers[side].articular.triangles, b.layers[side].articular.triangles);
    ASSERT_EQ(a.layers[side].thickness.size(), b.layers[side].thickness.size());
    for (std::size_t v = 0; v < a.layers[side].thickness.size(); ++v)
      EXPECT_NEAR(a.layers[side].thickness[v], b.layers[side].thickness[v], 1e-14 * a.layers[side].thickness[v]);
  }
}

TEST(DeaContact, MeasuresTheLayerUnderItsSurfaceThoughItIsRigid) {
  const Joint original = make_joint(concentric_spheres(8, 2000, true), {});
  const Joint joint = make_joint(spheres_of_bone(), {});
  expect_same_layers(original.contacts[0], joint.contacts[0]);
  EXPECT_EQ(original.node_body, joint.node_body);
}

TEST(DeaContact, TakesThicknessFromItsMap) {
  const JointModel deformable = concentric_spheres(8, 2000, true);
  const Joint original = make_joint(deformable, {});
  JointModel model = spheres_of_bone();
  for (int side = 0; side < 2; ++side)
    model.contacts[0].dea->layers[side].thickness_map = map_of(deformable, original.contacts[0].layers[side]);
  const Joint joint = make_joint(model, {});
  expect_same_layers(original.contacts[0], joint.contacts[0]);
  // and the whole analysis is the same
  const Analysis a = analyse(deformable, {}), b = analyse(model, {});
  const ContactStatistics &x = a.states.back().statistics[0], &y = b.states.back().statistics[0];
  EXPECT_NEAR(x.peak, y.peak, 1e-12 * x.peak);
  EXPECT_NEAR(x.mean, y.mean, 1e-12 * x.mean);
  EXPECT_NEAR((x.force - y.force).norm(), 0, 1e-9 * x.force.norm());
}

TEST(DeaContact, MapOfDifferentValuesAtOneNodeCountsTheirMean) {
  JointModel model = spheres_of_bone();
  const Surface& s = model.surfaces[static_cast<std::size_t>(model.contacts[0].primary)];
  std::vector<double> map(s.nodes.size(), 2.0);
  const int node = s.nodes[0];
  int facets = 0;
  for (int other : s.nodes) facets += other == node;
  map[0] = 2.0 + facets;  // one of the facets around the node
  model.contacts[0].dea->layers[0].thickness_map = map;
  const Layer layer = make_joint(model, {}).contacts[0].layers[0];
  for (std::size_t v = 0; v < layer.thickness.size(); ++v)
    EXPECT_NEAR(layer.thickness[v], layer.articular.model_nodes[v] == node ? 3.0 : 2.0, 1e-12);
}

TEST(DeaContact, SettingsComeBeforeTheContactAndTheContactBeforeDefaults) {
  JointModel model = spheres_of_bone();
  DeaContact& dea = *model.contacts[0].dea;
  dea.law = Law::NeoHookean;
  dea.facets = Facets::Flat;
  dea.refine = 2;
  dea.source = 1;
  dea.layers[0].thickness = 3.0;
  dea.layers[1].thickness = 0.0;  // a bare rigid surface
  ContactPair pair = make_joint(model, {}).contacts[0];
  EXPECT_EQ(pair.law, Law::NeoHookean);
  EXPECT_EQ(pair.facets, Facets::Flat);
  EXPECT_EQ(pair.refine, 2);
  EXPECT_EQ(pair.source, 1);
  EXPECT_EQ(pair.layers[0].thickness.front(), 3.0);
  EXPECT_TRUE(pair.layers[1].rigid);
  EXPECT_EQ(pair.layers[0].articular.bulge.front(), (std::array<double, 3>{0, 0, 0}));

  Settings settings;
  settings.law = Law::Logarithmic;
  settings.facets = Facets::Curved;
  settings.refine = 1;
  settings.source = "socket";
  settings.thickness["socket articular"] = 1.5;
  settings.E[""] = 7.0;
  pair = make_joint(model, settings).contacts[0];
  EXPECT_EQ(pair.law, Law::Logarithmic);
  EXPECT_EQ(pair.facets, Facets::Curved);
  EXPECT_EQ(pair.refine, 1);
  EXPECT_EQ(pair.source, 0);
  EXPECT_EQ(pair.layers[0].thickness.front(), 1.5);
  EXPECT_EQ(pair.layers[0].elasticity.E, 7.0);
  EXPECT_EQ(pair.layers[0].elasticity.nu, kNu);
}

TEST(DeaContact, ASideOfWhichNothingIsSaidIsBare) {
  JointModel model = spheres_of_bone();
  model.contacts[0].dea->layers[1] = {};
  const ContactPair pair = make_joint(model, {}).contacts[0];
  EXPECT_FALSE(pair.layers[0].rigid);
  EXPECT_TRUE(pair.layers[1].rigid);
}

TEST(DeaContact, RefusesALayerItCannotMeasure) {
  JointModel on_shells = flat_plates(4, 10, 2, 0.1);
  on_shells.domains[0].material = 1;
  on_shells.contacts[0].dea = DeaContact{};
  on_shells.contacts[0].dea->layers[1].E = kE;
  on_shells.contacts[0].dea->layers[1].nu = kNu;
  EXPECT_NE(refusal(on_shells).find("<secondary_thickness>"), std::string::npos) << refusal(on_shells);

  JointModel floating = floating_layer(2.0);
  floating.domains[0].material = 1;
  floating.contacts[0].dea = DeaContact{};
  floating.contacts[0].dea->layers[0].E = kE;
  floating.contacts[0].dea->layers[0].nu = kNu;
  EXPECT_NE(refusal(floating).find("<primary_thickness>"), std::string::npos) << refusal(floating);

  JointModel no_modulus = spheres_of_bone();
  no_modulus.contacts[0].dea->layers[0].E.reset();
  EXPECT_NE(refusal(no_modulus).find("the contact gives nu, and no E; give it in the contact as <primary_E>, or with"),
            std::string::npos)
      << refusal(no_modulus);

  // a parameter of the contact where the text names none, else a setting
  JointModel unbonded = floating_layer(2.0);
  unbonded.contacts[0].dea = DeaContact{};
  Settings settings;
  settings.attach["layer"] = "left";
  const JointFound found = find_joint(unbonded, settings);
  ASSERT_EQ(found.faults.size(), 1u);
  EXPECT_EQ(found.faults[0].expected.settings[1], (NamedSetting{"thickness", "layer", "VALUE", "primary_thickness"}));
}

}  // namespace dea::joint_test

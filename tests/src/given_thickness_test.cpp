// Thickness times a factor, and per node from a file: answers on paper, the same as other ways to say it, and what is
// refused.
#include <gtest/gtest.h>

#include "src/base/error.h"
#include "src/run/analysis.h"
#include "src/run/check.h"
#include "tests/findings.h"
#include "tests/src/test_models.h"

namespace dea::given_thickness_test {

using namespace test;

constexpr double kSize = 10, kThick = 2, kDown = 0.1;

/// A plate pressed into a flat layer by kDown, its numbers of nodes no indices.
JointModel pressed_plate(int n = 6) {
  JointModel model = flat_plates(n, kSize, kThick, 0.0);
  fix(model, 2, {true, true, false, true, true, true});
  prescribe(model, 2, 2, -kDown);
  for (int& id : model.node_ids) id = 2 * id + 100;
  return model;
}

/// The same with the selection's facets near the rim taken out: its cartilage goes on beyond.
JointModel pressed_within() {
  JointModel model = pressed_plate(8);
  Surface& s = model.surfaces[0];
  Surface inner;
  inner.name = s.name;
  for (int f = 0; f < s.size(); ++f) {
    bool in = true;
    for (int k = s.begin[at(f)]; k < s.begin[at(f + 1)]; ++k) {
      const Vector3d& x = model.nodes[at(s.nodes[at(k)])];
      in = in && std::abs(x.x()) < 0.31 * kSize && std::abs(x.y()) < 0.31 * kSize;
    }
    if (!in) continue;
    inner.nodes.insert(inner.nodes.end(), s.nodes.begin() + s.begin[at(f)], s.nodes.begin() + s.begin[at(f + 1)]);
    inner.begin.push_back(static_cast<int>(inner.nodes.size()));
  }
  s = inner;
  return model;
}

/// A layer that gets thinner along x: its bone rises.
void tilt_bone(JointModel& model) {
  for (Vector3d& x : model.nodes)
    if (x.z() < 0) x.z() *= 1 - 0.03 * x.x();
}

Settings of(Law law) {
  Settings settings;
  settings.law = law;
  return settings;
}

/// What was measured, of both faces' vertices: as a file would say it.
void say_measured(const JointModel& model, const Joint& joint, Settings& settings) {
  for (const Layer& layer : joint.contacts[0].layers) {
    if (layer.rigid) continue;
    NodeThickness& said = settings.thickness_from[model.surfaces[at(layer.surface)].name];
    said.file = "said.csv";
    for (std::size_t v = 0; v < layer.thickness.size(); ++v)
      said.at_node[model.node_ids[at(layer.articular.model_nodes[v])]] = layer.thickness[v];
    for (std::size_t v = 0; v < layer.face.thickness.size(); ++v)
      said.at_node[model.node_ids[at(layer.face.mesh.model_nodes[v])]] = layer.face.thickness[v];
  }
}

void expect_same_result(const Analysis& a, const Analysis& b, double tolerance) {
  ASSERT_TRUE(solved(a.states.back().equilibrium.outcome));
  const ContactStatistics &x = a.states.back().statistics[0], &y = b.states.back().statistics[0];
  EXPECT_GT(x.peak, 0);
  EXPECT_NEAR(x.peak, y.peak, tolerance * x.peak);
  EXPECT_NEAR(x.mean, y.mean, tolerance * x.mean);
  EXPECT_NEAR(x.contact_area, y.contact_area, tolerance * x.contact_area);
  EXPECT_LE((x.force - y.force).norm(), tolerance * x.force.norm());
}

std::string refusal(const JointModel& model, const Settings& settings) {
  try {
    make_joint(model, settings);
  } catch (const InputError& e) {
    return e.what();
  } catch (const UsageError& e) {
    return e.what();
  }
  return "taken";
}

// p = M d / (s h) at the same pose, d the overlap: the articular surfaces stay, and the gap between them.
TEST(ThicknessScale, PressureGoesAsOneOverIt) {
  const JointModel model = pressed_plate();
  const double M = confined_modulus(kE, kNu);
  for (const double scale : {0.5, 0.8, 1.0, 1.7}) {
    Settings settings = of(Law::Linear);
    settings.thickness_scale["layer"] = scale;
    const Analysis a = analyse(model, settings);
    EXPECT_NEAR(a.states.back().statistics[0].peak, M * kDown / (scale * kThick), 1e-10) << scale;
    EXPECT_NEAR(a.states.back().statistics[0].force.norm(), M * kDown / (scale * kThick) * kSize * kSize, 1e-7);
    const Layer& layer = a.joint.contacts[0].layers[0];
    EXPECT_NEAR(layer.min_thickness(), scale * kThick, 1e-12);  // statistics show the scaled one
    EXPECT_NEAR(layer.mean_thickness(), scale * kThick, 1e-12);
    EXPECT_NEAR(check_joint(recognise(model, settings)).contacts[0].gap_median, 0.0, 1e-12);
  }
}

// Two curved layers, springs of any law but layer: p depends on d / (t_1 + t_2) alone, so half as thick is what twice
// the moduli are for law linear. Both are exact, whatever the gaps.
TEST(ThicknessScale, IsTheInverseOfTheModulusForLawLinear) {
  const JointModel model = concentric_spheres(8, 2000, true);
  Settings thin = of(Law::Linear), stiff = of(Law::Linear);
  thin.thickness_scale[""] = 0.5;
  stiff.E[""] = 2 * kE;
  const Analysis a = analyse(model, thin), b = analyse(model, stiff);
  expect_same_result(a, b, 1e-9);
  EXPECT_LT((a.states.back().equilibrium.poses[1].center - b.states.back().equilibrium.poses[1].center).norm(), 1e-9);
}

// Measured and scaled, given and scaled, given as the product: one thickness for every law, beyond the selection too.
TEST(ThicknessScale, ActsOnWhatIsMeasuredAndWhatIsGiven) {
  for (const JointModel& model : {pressed_plate(), pressed_within()}) {
    for (const Law law : {Law::Linear, Law::NeoHookean, Law::Layer}) {
      Settings measured = of(law), given = of(law), product = of(law);
      measured.thickness_scale["layer"] = 0.75;
      given.thickness_scale[""] = 0.75;
      given.thickness["layer"] = kThick;
      product.thickness["layer"] = 0.75 * kThick;
      const Analysis a = analyse(model, product);
      expect_same_result(a, analyse(model, measured), 1e-9);
      expect_same_result(a, analyse(model, given), 1e-9);
      if (law != Law::Layer) continue;
      const LayerFace face = make_joint(model, measured).contacts[0].layers[0].face;
      ASSERT_GT(face.thickness.size(), 0u);
      for (const double t : face.thickness) EXPECT_NEAR(t, 0.75 * kThick, 1e-9);
    }
  }
  EXPECT_GT(make_joint(pressed_within(), of(Law::Layer)).contacts[0].layers[0].face.mesh.size(),
            make_joint(pressed_within(), of(Law::Layer)).contacts[0].layers[0].articular.size());
}

// The picture of the cartilage compressed spreads the shortening over the mesh, as thick as it is drawn.
TEST(ThicknessScale, TheMeshIsCompressedAsThickAsItIs) {
  const JointModel model = pressed_plate();
  Settings scaled = of(Law::Linear), given = of(Law::Linear);
  scaled.thickness_scale[""] = 0.5;
  given.thickness["layer"] = 0.5 * kThick;
  const auto depth = [&](const Settings& settings) {
    return make_field_maps(model, make_joint(model, settings)).contacts[0].layers[0].node_depth;
  };
  const std::vector<double> plain = depth(of(Law::Linear));
  EXPECT_GT(*std::max_element(plain.begin(), plain.end()), 0.99);
  EXPECT_EQ(depth(scaled), plain);
  EXPECT_EQ(depth(given), plain);
}

TEST(ThicknessScale, Refusals) {
  const JointModel model = pressed_plate();
  Settings s;
  s.thickness_scale["plate"] = 0.8;
  EXPECT_EQ(
      refusal(model, s),
      "thickness-scale of \"plate\" = 0.8: surface \"plate\" is a bare rigid surface, without thickness; leave it "
      "out, or give a thickness with thickness of \"plate\" = VALUE");
  s.thickness_scale = {{"", 0.8}};  // all that have one
  EXPECT_EQ(refusal(model, s), "taken");
  s.springs_at = SpringsAt::Bone;
  EXPECT_EQ(refusal(model, s).find("thickness-scale = 0.8: springs at the bone stand on the mesh's bone surface"), 0u);
  s = {};
  s.thickness_scale["layr"] = 0.8;
  EXPECT_EQ(refusal(model, s),
            "thickness-scale of \"layr\": the model has no surface of this name (did you mean \"layer\"?); it has "
            "\"layer\", \"plate\"");
}

// A file that says what is measured changes nothing.
TEST(ThicknessFrom, WhatIsMeasuredIsTheSameAsMeasuring) {
  JointModel tilted = pressed_plate(), within = pressed_within();
  tilt_bone(tilted);
  tilt_bone(within);
  for (const JointModel& model : {tilted, within, concentric_spheres(8, 2000, true)}) {
    for (const Law law : {Law::Linear, Law::Layer}) {
      Settings settings = of(law);
      const Analysis measured = analyse(model, settings);
      say_measured(model, measured.joint, settings);
      const Analysis said = analyse(model, settings);
      expect_same_result(measured, said, 1e-9);
      EXPECT_EQ(said.joint.contacts[0].layers[0].thickness, measured.joint.contacts[0].layers[0].thickness);
      EXPECT_EQ(said.joint.contacts[0].layers[0].face.thickness, measured.joint.contacts[0].layers[0].face.thickness);
      EXPECT_TRUE(said.joint.contacts[0].layers[0].thickness_given);
      settings.thickness_scale[""] = 0.9;  // acts on it too
      Settings scaled = of(law);
      scaled.thickness_scale[""] = 0.9;
      expect_same_result(analyse(model, scaled), analyse(model, settings), 1e-9);
    }
  }
}

// Cartilage that is rigid with its bone, of a contact of type dea with a map: what is beyond the rim stays known.
TEST(ThicknessFrom, TakesThePlaceOfAMap) {
  JointModel model = pressed_within();
  tilt_bone(model);
  const Joint joint = make_joint(model, {});
  const Layer& layer = joint.contacts[0].layers[0];
  model.domains[0].material = 1;
  DeaContact dea;
  dea.layers[0] = {kE, kNu, {}, {}};
  std::map<int, double> measured;
  for (std::size_t v = 0; v < layer.thickness.size(); ++v)
    measured[layer.articular.model_nodes[v]] = layer.thickness[v];
  for (int node : model.surfaces[0].nodes) dea.layers[0].thickness_map.push_back(measured.at(node));
  model.contacts[0].dea = dea;
  Settings settings;
  say_measured(model, joint, settings);
  expect_same_result(analyse(model, {}), analyse(model, settings), 1e-9);
  for (auto& entry : settings.thickness_from["layer"].at_node) entry.second *= 0.5;
  Settings scaled;
  scaled.thickness_scale[""] = 0.5;
  expect_same_result(analyse(model, scaled), analyse(model, settings), 1e-9);
}

// One number at every node, of a layer and of a bare surface: the same as the number.
TEST(ThicknessFrom, ConstantIsTheSameAsTheNumber) {
  for (const JointModel& model : {pressed_plate(), pressed_within()}) {
    for (const char* surface : {"layer", "plate"}) {
      for (const Law law : {Law::Linear, Law::Layer}) {
        Settings number = of(law);
        if (surface == std::string("plate")) {  // bare but for the thickness that it is given
          number.E["plate"] = kE;
          number.nu["plate"] = kNu;
        }
        Settings file = number;
        number.thickness[surface] = 1.3;
        for (const Surface& s : model.surfaces)
          for (int node : s.nodes) file.thickness_from[surface].at_node[model.node_ids[at(node)]] = 1.3;
        expect_same_result(analyse(model, number), analyse(model, file), 1e-9);
      }
    }
  }
}

TEST(ThicknessFrom, NodesThatAreNotOnTheSurfaceAreCounted) {
  const JointModel model = pressed_plate();
  Settings s;
  say_measured(model, make_joint(model, s), s);
  s.thickness_from["layer"].at_node[1] = 7;                  // no node of the model
  s.thickness_from["layer"].at_node[model.node_ids[0]] = 7;  // of the bone
  const Joint joint = make_joint(model, s);
  EXPECT_NEAR(joint.contacts[0].layers[0].max_thickness(), kThick, 1e-12);
  const Findings told = of_code(joint.findings, "thickness-from-file");
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(test::number(told[0], "nodes"), 49);
  EXPECT_EQ(test::number(told[0], "passed_over"), 2);
}

TEST(ThicknessFrom, Refusals) {
  const JointModel model = pressed_plate();
  Settings all;
  say_measured(model, make_joint(model, all), all);
  Settings s = all;
  const int first = model.node_ids[at(model.surfaces[0].nodes[0])];
  s.thickness_from["layer"].at_node.erase(first);
  EXPECT_EQ(refusal(model, s), "said.csv: found no thickness for 1 of the 49 nodes of surface \"layer\" (" +
                                   std::to_string(first) + "); give one for every node");
  s.thickness_from["layer"].at_node.clear();
  EXPECT_NE(refusal(model, s).find("for 49 of the 49 nodes of surface \"layer\" (" + std::to_string(first) + ", "),
            std::string::npos);
  EXPECT_NE(refusal(model, s).find(", ...); give one for every node"), std::string::npos);
  s = all;
  for (auto& entry : s.thickness_from["layer"].at_node) entry.second = 0;
  EXPECT_EQ(refusal(model, s), "said.csv: found thickness 0 at every node of surface \"layer\"; give the cartilage's");
  s = all;
  s.thickness["layer"] = 2;
  EXPECT_EQ(
      refusal(model, s),
      "thickness-from of \"layer\" = said.csv: thickness of \"layer\" says the thickness of the same surface; leave "
      "one out");
  s.thickness = {{"", 2.0}};  // of all others
  EXPECT_NE(refusal(model, s).find("gives no E and nu"), std::string::npos) << refusal(model, s);
  s = all;
  s.springs_at = SpringsAt::Bone;
  EXPECT_NE(refusal(model, s).find("its thickness is given at nodes of the articular surface"), std::string::npos);
  s = {};
  s.thickness_from["layr"].file = "said.csv";
  EXPECT_EQ(refusal(model, s),
            "thickness-from of \"layr\": the model has no surface of this name (did you mean \"layer\"?); it has "
            "\"layer\", \"plate\"");
}

}  // namespace dea::given_thickness_test

// Stress and strain of a model's elements.
#include "src/results/inside_fields.h"
#include "tests/findings.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "src/run/analysis.h"
#include "tests/src/test_models.h"

namespace dea::inside_fields_test {

using namespace test;
using Eigen::Matrix3d;

Settings looking_inside() {
  Settings s;
  s.inside = true;
  return s;
}

StateResult last_state(const Analysis& analysis) { return analysis.states.back(); }

Matrix3d tensor(const SymmetricTensor& t) {
  Matrix3d m;
  m << t[0], t[3], t[5], t[3], t[1], t[4], t[5], t[4], t[2];
  return m;
}

double far_off(const SymmetricTensor& a, const Matrix3d& b) { return (tensor(a) - b).norm(); }

bool said(const Analysis& analysis, const std::string& what) {
  return test::words_of(analysis.joint.findings).find(what) != std::string::npos;
}

/// A wide layer under a plate, squeezed by a tenth: far from its edges it is confined.
JointModel wide_layer(double squeezed) {
  JointModel model = flat_plates(24, 24, 0.5, 0.0, 26);
  prescribe(model, 2, 2, -0.5 * squeezed);
  return model;
}

// Confined compression of FEBio's neo-Hookean solid, on paper: F = diag(1, 1, 1 - d).
TEST(InsideFields, ConfinedLayer) {
  const double d = 0.1, lambda_z = 1 - d, mu = kE / (2 * (1 + kNu)), lambda = 2 * mu * kNu / (1 - 2 * kNu);
  const Analysis analysis = analyse(wide_layer(d), looking_inside());
  const StateResult state = last_state(analysis);
  Matrix3d stress = lambda * std::log(lambda_z) / lambda_z * Matrix3d::Identity(), strain = Matrix3d::Zero();
  stress(2, 2) += mu / lambda_z * (lambda_z * lambda_z - 1);
  strain(2, 2) = 0.5 * (lambda_z * lambda_z - 1);
  ASSERT_EQ(state.inside.size(), 1u);
  ASSERT_EQ(state.inside[0].stress.size(), 2u * 24 * 24);
  for (const int row : {0, 1}) {  // 24 thicknesses from the edges
    const std::size_t middle = static_cast<std::size_t>(row * 24 * 24 + 12 * 24 + 12);
    EXPECT_LT(far_off(state.inside[0].stress[middle], stress), 1e-3 * stress.norm());
    EXPECT_LT(far_off(state.inside[0].strain[middle], strain), 1e-3 * strain.norm());
  }
  EXPECT_TRUE(said(analysis, "1152 elements of \"cartilage\" in 2 rows, their centroids at 0.25 to 0.75"));
  // the same at both ends, as fields and as numbers; the median column is confined, and its max shear on paper
  const SideFields& side = state.fields[0].sides[0];
  const double shear = 0.5 * (stress(0, 0) - stress(2, 2));
  EXPECT_NEAR(side.bone_max_shear[12 * 24 + 12], shear, 1e-3 * shear);
  EXPECT_NEAR(side.surface_max_shear[12 * 24 + 12], shear, 1e-3 * shear);
  EXPECT_NEAR(side.bone_third_strain[12 * 24 + 12], strain(2, 2), 1e-4);
  ASSERT_TRUE(state.statistics[0].inside[0].has_value());
  EXPECT_FALSE(state.statistics[0].inside[1].has_value());  // the plate is bare
  EXPECT_TRUE(state.fields[0].sides[1].bone_max_shear.empty());
  EXPECT_GE(state.statistics[0].inside[0]->bone.max_shear.peak, shear * 0.999);
}

// A plate over the whole layer has its greatest shear at the free edge, which reaches further where the wall overhangs;
// a ball in its middle has not.
TEST(InsideFields, PeakNearAFreeEdge) {
  const auto near_edge = [](const JointModel& model) {
    return last_state(analyse(model, looking_inside())).statistics[0].inside[0]->peak_near_free_edge;
  };
  EXPECT_EQ(near_edge(wide_layer(0.1)), kNearEdge);
  JointModel overhanging = wide_layer(0.1);
  for (Vector3d& x : overhanging.nodes)
    if (x.z() < 0) x.head<2>() *= 1 + 0.5 * x.z() / 12;  // of the layer, half width 12: slope -0.5
  EXPECT_EQ(near_edge(overhanging), kNearOverhang);
  JointModel model = flat_plates(24, 24, 1, 100.0);
  for (std::size_t i = model.nodes.size() - 25 * 25; i < model.nodes.size(); ++i) {
    Vector3d& x = model.nodes[i];
    x.z() = 0.01 * (x.x() * x.x() + x.y() * x.y());  // R = 50
  }
  prescribe(model, 2, 2, -0.15);
  EXPECT_EQ(near_edge(model), 0);
}

// Nothing is looked into unless it is asked for.
TEST(InsideFields, OffByDefault) {
  const StateResult state = last_state(analyse(wide_layer(0.1), Settings{}));
  EXPECT_TRUE(state.inside.empty());
  EXPECT_TRUE(state.fields[0].sides[0].bone_max_shear.empty());
  EXPECT_FALSE(state.statistics[0].inside[0].has_value());
}

// Turned with all its bones a joint has its stress turned, and its strain, which refers to the reference, too.
TEST(InsideFields, TurnsWithTheModel) {
  const Matrix3d R = Eigen::AngleAxisd(0.7, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  JointModel model = concentric_spheres(8, 300, true), turned = model;
  for (Vector3d& x : turned.nodes) x = R * x;
  turned.rigid_loads.clear();
  force(turned, 2, R * Vector3d(0, 0, 300));
  const StateResult a = last_state(analyse(model, looking_inside())), b = last_state(analyse(turned, looking_inside()));
  ASSERT_EQ(a.inside.size(), 2u);
  double most = 0;
  for (const SymmetricTensor& t : a.inside[0].stress) most = std::max(most, tensor(t).norm());
  EXPECT_GT(most, 0.05);
  for (std::size_t d = 0; d < 2; ++d)
    for (std::size_t e = 0; e < a.inside[d].stress.size(); ++e) {
      EXPECT_LT(far_off(b.inside[d].stress[e], R * tensor(a.inside[d].stress[e]) * R.transpose()), 1e-4 * most);
      EXPECT_LT(far_off(b.inside[d].strain[e], R * tensor(a.inside[d].strain[e]) * R.transpose()), 1e-4 * most / kE);
    }
}

// A body that turns takes its cartilage's stress along; Lagrange strain stays in the axes of the reference.
TEST(InsideFields, StressFollowsTheBody) {
  JointModel model = wide_layer(0.1);
  Settings turned = looking_inside();
  for (const char* body : {"base", "plate"}) {
    Placement p;
    p.kind = Placement::Kind::Rotate;
    p.body = body;
    p.vector = Vector3d::UnitX();
    p.degrees = 90;
    turned.placements.push_back(p);
    turned.rotate_about[body] = {TurnPoint::Kind::Point, Vector3d::Zero()};
  }
  model.rigid_prescribed.clear();
  for (std::size_t i = model.nodes.size() - 25 * 25; i < model.nodes.size(); ++i) model.nodes[i].z() -= 0.05;
  fix(model, 2, {true, true, true, true, true, true});
  const StateResult a = last_state(analyse(model, looking_inside())), b = last_state(analyse(model, turned));
  Matrix3d R;
  R << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  const std::size_t middle = 12 * 24 + 12;
  const Matrix3d stress = tensor(a.inside[0].stress[middle]);
  EXPECT_GT(stress.norm(), 0.1);
  EXPECT_LT(far_off(b.inside[0].stress[middle], R * stress * R.transpose()), 1e-5 * stress.norm());
  EXPECT_LT(far_off(b.inside[0].strain[middle], tensor(a.inside[0].strain[middle])), 1e-6);
}

// Cartilage that no contact touches: its elements are there and show 0, and that is said.
TEST(InsideFields, PartsUnderNoContact) {
  JointModel model = wide_layer(0.1);
  add_layer(
      model, "other", 2, 2, 1, [](double u, double v) { return Vector3d(u + 50, v, 0); },
      [](double u, double v) { return Vector3d(u + 50, v, 1); }, 0, 1);
  const Analysis analysis = analyse(model, looking_inside());
  const StateResult state = last_state(analysis);
  ASSERT_EQ(state.inside.size(), 2u);
  for (const SymmetricTensor& t : state.inside[1].stress) EXPECT_EQ(tensor(t), Matrix3d::Zero());
  EXPECT_GT(tensor(state.inside[0].stress[12 * 24 + 12]).norm(), 0.1);
  EXPECT_TRUE(said(analysis, "4 of the model's 1156 deformable elements lie under no contact"));
}

// A thickness given for a bare surface: there are no elements, and the surface has its fields all the same.
TEST(InsideFields, LayersWithoutElements) {
  JointModel model = wide_layer(0.1);
  Settings settings = looking_inside();
  settings.thickness["plate"] = 0.5;
  settings.E["plate"] = 5;
  settings.nu["plate"] = 0.3;
  const Analysis analysis = analyse(model, settings);
  const StateResult state = last_state(analysis);
  EXPECT_TRUE(state.statistics[0].inside[1].has_value());
  EXPECT_GT(state.fields[0].sides[1].bone_max_shear[12 * 24 + 12], 0.01);
  EXPECT_EQ(state.inside.size(), 1u);
  EXPECT_TRUE(said(analysis, "surface \"plate\": its layer has no deformable elements"));
}

// Divided springs leave every facet and element its place: refine 2 is within the mesh's own error of refine 1.
TEST(InsideFields, Refined) {
  JointModel model = concentric_spheres(10, 300);
  Settings fine = looking_inside();
  fine.refine = 2;
  const StateResult a = last_state(analyse(model, looking_inside())), b = last_state(analyse(model, fine));
  double most = 0, difference = 0;
  for (std::size_t e = 0; e < a.inside[0].stress.size(); ++e) {
    most = std::max(most, tensor(a.inside[0].stress[e]).norm());
    difference = std::max(difference, far_off(a.inside[0].stress[e], tensor(b.inside[0].stress[e])));
  }
  EXPECT_GT(most, 0.05);
  EXPECT_LT(difference, 0.3 * most);  // a coarse mesh; a wrong place would be off by all of it
  const std::vector<double>&p = a.fields[0].sides[0].bone_max_shear, &q = b.fields[0].sides[0].bone_max_shear;
  ASSERT_EQ(p.size(), q.size());
  EXPECT_GT(correlation(p, q, std::vector<double>(p.size(), 1.0)), 0.9);
}

// Elements under a thickness that is not the mesh's, without a bone in the model: by depth over thickness.
TEST(InsideFields, PlacesWithoutBone) {
  Layer layer;
  layer.articular = make_surface_mesh({0, 4}, {0, 1, 2, 3}, {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}});
  layer.bone = layer.articular;
  layer.face = selected_face(layer.articular, std::vector<unsigned char>(4, 0));
  layer.face.thickness.assign(4, 2.0);
  const std::vector<InsidePlace> places = inside_places(layer, layer.face, make_layer_mesh(layer.face),
                                                        {{1, 1, -0.5}, {2, 2, -1.5}, {2, 1, -2.5}, {2, 2, -3.5}});
  EXPECT_NEAR(places[0].height, 0.75, 1e-12);
  EXPECT_NEAR(places[1].height, 0.25, 1e-12);
  EXPECT_EQ(places[2].height, 0.0);
  EXPECT_EQ(places[3].triangle, -1);
}

// Laws that know nothing of the inside are refused.
TEST(InsideFields, OtherLawsAreRefused) {
  const JointModel model = wide_layer(0.1);
  Settings settings = looking_inside();
  settings.law = Law::Linear;
  const auto fault = [&] {
    try {
      analyse(model, settings);
    } catch (const UsageError& e) {
      return line(e.fault);
    }
    return std::string();
  };
  EXPECT_NE(fault().find("found law linear, expected"), std::string::npos) << fault();
  settings.law = Law::Layer;
  settings.layer_fit = LayerFit::OneTerm;
  EXPECT_NE(fault().find("found law layer of one term, expected"), std::string::npos) << fault();
}

}  // namespace dea::inside_fields_test

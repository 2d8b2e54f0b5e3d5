#include "src/facts/node_holds.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/run/analysis.h"
#include "tests/src/test_models.h"

namespace dea::moved_nodes_test {

void move_nodes(JointModel& model, const std::vector<int>& nodes, int component, double value, int step = -1,
                bool relative = false) {
  PrescribedNodes p;
  p.nodes = nodes;
  p.component = component;
  p.value = {value, 0};
  p.step = step;
  p.relative = relative;
  p.name = "top";
  model.prescribed_nodes.push_back(p);
}

void fix_nodes(JointModel& model, const std::vector<int>& nodes, std::array<bool, 3> xyz) {
  FixedNodes f;
  f.nodes = nodes;
  f.xyz = xyz;
  model.fixed_nodes.push_back(f);
}

/// Nodes of the elements of a material.
std::vector<int> nodes_of(const JointModel& model, int material) {
  std::vector<int> nodes;
  for (const Domain& d : model.domains)
    if (d.material == material) nodes.insert(nodes.end(), d.nodes.begin(), d.nodes.end());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

/// Leaves out a bone: its elements and its conditions. Its nodes, which are the cartilage's too.
std::vector<int> leave_out(JointModel& model, int material) {
  const std::vector<int> nodes = nodes_of(model, material);
  const auto gone = [&](const auto& of) { return of.material == material; };
  std::erase_if(model.domains, gone);
  std::erase_if(model.rigid_fixed, gone);
  std::erase_if(model.rigid_prescribed, gone);
  return nodes;
}

std::vector<std::string> faults_of(const JointModel& model) {
  std::vector<Fault> faults;
  find_moved_nodes(model, std::vector<int>(model.nodes.size(), -1), faults);
  std::vector<std::string> lines;
  for (const Fault& fault : faults) lines.push_back(line(fault));
  return lines;
}

JointModel twelve_nodes() {
  JointModel model = test::empty_model();
  test::add_nodes(model, 3, 2, [](double u, double v) { return Vector3d(u, v, 0); });
  return model;
}

/// A socket that comes down 0.3 and goes sideways, around a ball that a force holds against it.
JointModel moved_socket() {
  JointModel model = test::concentric_spheres(16, 800, false, 3);
  std::erase_if(model.rigid_fixed, [](const RigidFixed& f) { return f.material == 1; });
  test::fix(model, 1, {false, false, false, true, true, true});
  test::prescribe(model, 1, 0, 0.2);
  test::prescribe(model, 1, 1, -0.1);
  test::prescribe(model, 1, 2, -0.3);
  return model;
}

void expect_same(const Analysis& found, const Analysis& expected) {
  ASSERT_EQ(found.states.size(), expected.states.size());
  for (std::size_t s = 0; s < found.states.size(); ++s) {
    const StateResult &a = found.states[s], &b = expected.states[s];
    EXPECT_EQ(a.equilibrium.outcome, b.equilibrium.outcome);
    for (std::size_t n = 0; n < a.displacements.size(); ++n)
      ASSERT_LT((a.displacements[n] - b.displacements[n]).norm(), 1e-9) << "node " << n << " of state " << s;
    EXPECT_NEAR(a.statistics[0].peak, b.statistics[0].peak, 1e-7 * b.statistics[0].peak);
    EXPECT_NEAR(a.statistics[0].mean, b.statistics[0].mean, 1e-7 * b.statistics[0].mean);
  }
}

TEST(MovedNodes, AreGroupedByTheirMotion) {
  JointModel model = twelve_nodes();
  move_nodes(model, {0, 1, 2, 3}, 2, -0.1);
  move_nodes(model, {3, 2, 5}, 0, 0.3);
  move_nodes(model, {4, 5}, 2, -0.1);
  fix_nodes(model, {0, 1, 4}, {true, true, false});
  fix_nodes(model, {0, 2, 3, 5}, {false, true, false});  // node 0 twice: the same as once
  std::vector<Fault> faults;
  std::vector<int> body(model.nodes.size(), -1);
  const std::vector<MovedNodes> moved = find_moved_nodes(model, body, faults);
  EXPECT_TRUE(faults.empty()) << line(faults.front());
  ASSERT_EQ(moved.size(), 2u);
  EXPECT_EQ(moved[0].nodes, (std::vector<int>{0, 1, 4}));
  EXPECT_EQ(moved[1].nodes, (std::vector<int>{2, 3, 5}));
  EXPECT_EQ(moved[1].conditions, (std::vector<int>{0, 1}));
  body[1] = 7;  // a bone's own
  EXPECT_EQ(find_moved_nodes(model, body, faults)[0].nodes, (std::vector<int>{0, 4}));
}

TEST(MovedNodes, FreeInOneComponentOrGivenTwiceAreNoBone) {
  JointModel model = twelve_nodes();
  move_nodes(model, {6, 7}, 2, 0.1);
  fix_nodes(model, {6, 7}, {false, true, false});
  ASSERT_EQ(faults_of(model).size(), 1u);
  EXPECT_NE(faults_of(model)[0].find("node 7 is moved in z and free in x,"), std::string::npos) << faults_of(model)[0];
  fix_nodes(model, {6, 7}, {true, false, false});
  EXPECT_TRUE(faults_of(model).empty());
  fix_nodes(model, {7}, {false, false, true});
  EXPECT_NE(faults_of(model)[0].find("node 8 has two different conditions in z"), std::string::npos)
      << faults_of(model)[0];
  model.fixed_nodes.pop_back();
  move_nodes(model, {6}, 2, 0.2);
  EXPECT_NE(faults_of(model)[0].find("two different conditions in z"), std::string::npos) << faults_of(model)[0];
  model.prescribed_nodes.back().value.factor = 0.1;  // twice the same
  EXPECT_TRUE(faults_of(model).empty());
}

TEST(MovedNodes, MustBeHeldInEveryStep) {
  JointModel model = twelve_nodes();
  model.steps.push_back(model.steps[0]);
  move_nodes(model, {0, 1}, 2, 0.1, 0);
  fix_nodes(model, {0, 1}, {true, true, false});
  EXPECT_NE(faults_of(model)[0].find("free in z (in some step)"), std::string::npos) << faults_of(model)[0];
  fix_nodes(model, {0, 1}, {false, false, true});
  model.fixed_nodes.back().step = 1;
  EXPECT_TRUE(faults_of(model).empty());
}

TEST(MovedNodes, AreTheBoneThatTheModelLeavesOut) {
  const JointModel with_bone = moved_socket();
  JointModel model = with_bone;
  const std::vector<int> nodes = leave_out(model, 1);
  move_nodes(model, nodes, 0, 0.2);
  move_nodes(model, nodes, 1, -0.1);
  move_nodes(model, nodes, 2, -0.3);
  for (const Law law : {Law::Linear, Law::Layer}) {
    Settings settings;
    settings.law = law;
    const Analysis found = analyse(model, settings);
    EXPECT_EQ(found.states.back().equilibrium.outcome, Outcome::Balanced);
    expect_same(found, analyse(with_bone, settings));
    const Body& body = found.joint.bodies[at(found.joint.contacts[0].layers[0].body)];
    EXPECT_EQ(body.name, "top");
    EXPECT_EQ(body.moved_by.size(), 3u);
    EXPECT_TRUE(body.materials.empty());
  }
}

// A bone of deformable elements that the user takes as rigid.
TEST(MovedNodes, MoveABoneThatIsTakenAsRigid) {
  const JointModel with_bone = moved_socket();
  JointModel model = with_bone;
  const std::vector<int> nodes = nodes_of(model, 1);
  std::erase_if(model.rigid_fixed, [](const RigidFixed& f) { return f.material == 1; });
  std::erase_if(model.rigid_prescribed, [](const RigidPrescribed& p) { return p.material == 1; });
  model.materials[1].rigid = false;
  model.materials[1].center_of_mass.reset();
  const std::vector<int> some(nodes.begin(), nodes.begin() + 60);
  move_nodes(model, some, 0, 0.2);
  move_nodes(model, some, 1, -0.1);
  move_nodes(model, some, 2, -0.3);
  Settings settings = test::linear();
  settings.rigid = {"socket"};
  expect_same(analyse(model, settings), analyse(with_bone, test::linear()));

  // nodes that turn it, or leave it a hinge, are no translation
  model.prescribed_nodes[2].nodes.resize(30);
  move_nodes(model, {some.begin() + 30, some.end()}, 2, -0.4);
  const auto refusal = [&] {
    try {
      analyse(model, settings);
      return std::string();
    } catch (const InputError& error) {
      return std::string(error.what());
    }
  };
  EXPECT_NE(refusal().find("move bone \"socket\" otherwise than by one translation"), std::string::npos) << refusal();
  model.prescribed_nodes.clear();
  move_nodes(model, {some[0]}, 2, -0.3);
  EXPECT_NE(refusal().find("otherwise than by one translation"), std::string::npos) << refusal();
}

// Fixed after they were moved they go back to the reference, as FEBio has it, and are one body all the time.
TEST(MovedNodes, FixedInALaterStepGoBack) {
  for (const bool rigid_bone : {false, true}) {
    JointModel model = test::flat_plates(4, 10, 2, 0.0);
    Settings settings = test::linear();
    std::vector<int> nodes = nodes_of(model, 1);
    if (rigid_bone) {
      std::erase_if(model.rigid_fixed, [](const RigidFixed& f) { return f.material == 1; });
      model.materials[1].rigid = false;
      settings.rigid = {"base"};
    } else {
      nodes = leave_out(model, 1);
    }
    test::fix(model, 2, {true, true, true, true, true, true});
    model.steps.push_back(model.steps[0]);
    fix_nodes(model, nodes, {true, true, false});
    move_nodes(model, nodes, 2, 0.1, 0);
    fix_nodes(model, nodes, {false, false, true});
    model.fixed_nodes.back().step = 1;
    const Analysis found = analyse(model, settings);
    ASSERT_EQ(found.states.size(), 3u);
    EXPECT_NEAR(found.states[1].displacements[at(nodes[0])].z(), 0.1, 1e-12);
    EXPECT_GT(found.states[1].statistics[0].peak, 0.1);
    EXPECT_NEAR(found.states[2].displacements[at(nodes[0])].z(), 0.0, 1e-12);
    EXPECT_EQ(found.states[2].statistics[0].springs_active, 0) << "contact";
    EXPECT_FALSE(found.joint.bodies[at(found.joint.node_body[at(nodes[0])])].ground);
  }
}

TEST(MovedNodes, RelativeInSomeStepsIsAnotherMotion) {
  JointModel model = twelve_nodes();
  model.steps.push_back(model.steps[0]);
  move_nodes(model, {0, 1}, 2, 0.1, -1, true);
  move_nodes(model, {2, 3}, 2, 0.1, 0, true);
  move_nodes(model, {2, 3}, 2, 0.1, 1, true);
  fix_nodes(model, {0, 1, 2, 3}, {true, true, false});
  std::vector<Fault> faults;
  EXPECT_EQ(find_moved_nodes(model, std::vector<int>(model.nodes.size(), -1), faults).size(), 2u);
  EXPECT_TRUE(faults.empty());
}

TEST(MovedNodes, RelativeMotionStartsWhereTheStepDoes) {
  JointModel model = test::flat_plates(4, 10, 2, 0.0);
  const std::vector<int> nodes = leave_out(model, 1);
  test::fix(model, 2, {true, true, true, true, true, true});
  model.steps.push_back(model.steps[0]);
  LoadController second;  // from 0 to 1 in the second step
  second.id = 2;
  second.points = {{1, 0}, {2, 1}};
  model.controllers.push_back(second);
  fix_nodes(model, nodes, {true, true, false});
  move_nodes(model, nodes, 2, 0.1, 0);
  move_nodes(model, nodes, 2, 0.05, 1, true);
  model.prescribed_nodes.back().value.controller = 1;
  const Analysis found = analyse(model, test::linear());
  const double modulus = (1 - test::kNu) * test::kE / ((1 + test::kNu) * (1 - 2 * test::kNu));
  ASSERT_EQ(found.states.size(), 3u);
  EXPECT_NEAR(found.states[1].statistics[0].peak, modulus * 0.1 / 2, 1e-9);
  EXPECT_NEAR(found.states[2].statistics[0].peak, modulus * 0.15 / 2, 1e-9);
  EXPECT_NEAR(found.states[2].displacements[at(nodes[0])].z(), 0.15, 1e-12);
}

}  // namespace dea::moved_nodes_test

// Numbers of springs, muscles and forces in place of the model's: answers on paper, the same as in the model itself,
// and what is refused.
#include "src/joint/given_values.h"
#include "tests/findings.h"

#include <gtest/gtest.h>

#include "src/base/error.h"
#include "src/run/analysis.h"
#include "tests/src/test_models.h"

namespace dea::given_values_test {

constexpr double kSize = 10, kThick = 2;

/// A plate 5 above a layer, free along z alone, pulled up by `load` [N], in `states` states.
JointModel lifted_plate(double load, int states = 1) {
  JointModel model = test::flat_plates(1, kSize, kThick, 5.0);
  model.steps[0].step_size = 1.0 / states;
  test::fix(model, 2, {true, true, false, true, true, true});
  test::force(model, 2, {0, 0, load});
  if (load != 0) model.rigid_loads[0].name = "lift";
  return model;
}

/// A spring along z from the base to the plate, 40 long.
RigidSpring& add_spring(JointModel& model, double k, double free_length) {
  RigidSpring& s = test::add_rigid_spring(model, 1, {0, 0, -30}, 2, {0, 0, 10}, k);
  s.name = "ACL";
  s.free_length = free_length;
  return s;
}

/// Springs between the four corners of the base's bone and of the plate above them, all alike: 7 long.
DiscreteSprings& add_springs_at_corners(JointModel& model) {
  DiscreteSet set;
  set.name = "corners";
  for (std::size_t a = 0; a < model.nodes.size(); ++a)
    for (std::size_t b = 0; b < model.nodes.size(); ++b)
      if ((model.nodes[b] - model.nodes[a] - Vector3d(0, 0, 7)).norm() < 1e-12)
        set.pairs.push_back({static_cast<int>(a), static_cast<int>(b)});
  model.discrete_sets.push_back(set);
  DiscreteSprings springs;
  springs.set = 0;
  springs.name = "PCL";
  springs.stiffness = 10;
  model.discrete_springs.push_back(springs);
  return model.discrete_springs.back();
}

Settings with(const std::string& key, double value) {
  Settings settings = test::linear();
  settings.set_values[key] = value;
  return settings;
}

/// z of the plate in the last state.
double height(const JointModel& model, const Settings& settings) {
  const StateResult state = analyse(model, settings).states.back();
  EXPECT_EQ(state.equilibrium.outcome, Outcome::Balanced) << state.equilibrium.message;
  return state.equilibrium.poses[1].center.z();
}

std::string refusal(const JointModel& model, const Settings& settings) {
  try {
    make_joint(model, settings);
  } catch (const UsageError& e) {
    return e.what();
  }
  return "taken";
}

/// The sentence of the only number that is set.
std::string words(const JointModel& model, const Settings& settings) {
  const Findings told = of_code(make_joint(model, settings).findings, "value-set");
  return told.empty() ? "nothing said" : worded(told.front());
}

// A spring alone carries the load: k (L - L0) = F, and L = 40 + z.
TEST(GivenValues, StiffnessAndSlackLengthOfASpring) {
  JointModel model = lifted_plate(100);
  add_spring(model, 60, 39);
  EXPECT_NEAR(height(model, test::linear()), 39 + 100.0 / 60 - 40, 1e-9);
  Settings settings = with("ACL.stiffness", 80);
  EXPECT_NEAR(height(model, settings), 39 + 100.0 / 80 - 40, 1e-9);
  EXPECT_EQ(words(model, settings), "set: ACL.stiffness 80 (model: 60)");
  settings.set_values["ACL.slack-length"] = 38.5;
  EXPECT_NEAR(height(model, settings), 38.5 + 100.0 / 80 - 40, 1e-9);
  EXPECT_EQ(words(model, with("ACL.slack-length", 38.5)), "set: ACL.slack-length 38.5 (model: 39)");
  model.rigid_springs[0].free_length = 0;  // the reference distance
  EXPECT_NEAR(height(model, with("ACL.slack-length", 39.5)), 39.5 + 100.0 / 60 - 40, 1e-9);
  EXPECT_EQ(words(model, with("ACL.slack-length", 39.5)), "set: ACL.slack-length 39.5 (model: 40)");
}

// Four springs of a set and two more: all of the name are meant. 4 k (L - L0) = F, and L = 7 + z.
TEST(GivenValues, AllOfASetByItsNameOrTheSprings) {
  JointModel model = lifted_plate(100);
  add_springs_at_corners(model);
  for (const std::string name : {"PCL", "corners"}) {
    EXPECT_NEAR(height(model, with(name + ".stiffness", 25)), 100.0 / (4 * 25), 1e-9);
    EXPECT_NEAR(height(model, with(name + ".slack-length", 6.5)), 6.5 + 100.0 / (4 * 10) - 7, 1e-9);
    EXPECT_EQ(words(model, with(name + ".stiffness", 25)),
              "set: " + name + ".stiffness 25 for all 4 of this name (model: 10)");
  }
  add_spring(model, 60, 39).name = "PCL";
  EXPECT_EQ(words(model, with("PCL.stiffness", 25)), "set: PCL.stiffness 25 for all 5 of this name (model: 10 to 60)");
  EXPECT_NEAR(height(model, with("PCL.stiffness", 25)), (100 - 25.0) / (5 * 25), 1e-9);
}

// A name may hold dots: the last one counts.
TEST(GivenValues, NamesMayHoldDots) {
  JointModel model = lifted_plate(100);
  add_spring(model, 60, 39).name = "M.C.L";
  EXPECT_NEAR(height(model, with("M.C.L.stiffness", 80)), 39 + 100.0 / 80 - 40, 1e-9);
}

// A ligament by a curve, 30 per strain: 4 * 30 (L / L0 - 1) = F.
TEST(GivenValues, SlackLengthOfACurve) {
  JointModel model = lifted_plate(10);
  DiscreteSprings& springs = add_springs_at_corners(model);
  springs.measure = DiscreteSprings::Measure::Strain;
  springs.force.emplace().points = {{-1, -30}, {0, 0}, {1, 30}};
  EXPECT_NEAR(height(model, with("PCL.slack-length", 6)), 6 * (1 + 10.0 / 120) - 7, 1e-9);
  EXPECT_EQ(refusal(model, with("PCL.stiffness", 80)),
            "set of \"PCL.stiffness\" = 80: spring by a curve \"PCL\" has no stiffness; it has slack-length");
}

// A stretched spring of 60 N / mm stops the plate that muscle, cable or constant springs pull down: z = -F / k.
TEST(GivenValues, ForceOfPulls) {
  JointModel model = lifted_plate(0, 2);
  add_spring(model, 60, 40);
  test::add_muscle(model, 2, {0, 0, 0}, 1, {0, 0, -30}, 30);
  EXPECT_NEAR(height(model, with("muscle.force", 90)), -90.0 / 60, 1e-9);
  // the ramp of the model's force is that of the user's
  const Analysis ramped = analyse(model, with("muscle.force", 90));
  ASSERT_EQ(ramped.states.size(), 3u);
  EXPECT_NEAR(ramped.states[1].equilibrium.ligament_force[1], 45, 1e-12);
  EXPECT_EQ(words(model, with("muscle.force", 90)),
            "set: muscle.force 90 (model: 30), times load controller 1, which is 1 at time 1");

  RigidCable cable;
  cable.name = "tendon";
  cable.points = {{1, {0, 0, -30}}, {2, {0, 0, 20}}};
  cable.force = {15, -1};
  model.rigid_cables.push_back(cable);
  EXPECT_NEAR(height(model, with("tendon.force", 24)), -(30 + 24.0) / 60, 1e-9);
  EXPECT_EQ(words(model, with("tendon.force", 24)), "set: tendon.force 24 (model: 15)");

  model.rigid_cables.clear();
  DiscreteSprings& springs = add_springs_at_corners(model);
  springs.force.emplace().points = {{0, 3}};
  springs.scale = {2.0, 0};  // 6 each, by the ramp
  EXPECT_NEAR(height(model, test::linear()), -(30 + 4 * 6.0) / 60, 1e-9);
  EXPECT_NEAR(height(model, with("PCL.force", 9)), -(30 + 4 * 9.0) / 60, 1e-9);
  EXPECT_EQ(words(model, with("PCL.force", 9)),
            "set: PCL.force 9 for all 4 of this name (model: 6), times load "
            "controller 1, which is 1 at time 1");
  EXPECT_NE(refusal(model, with("PCL.slack-length", 9)).find("it has force"), std::string::npos);
}

TEST(GivenValues, ForceOnABody) {
  JointModel model = lifted_plate(100);
  add_spring(model, 60, 40);
  EXPECT_NEAR(height(model, with("lift.force", 30)), 30.0 / 60, 1e-9);
  EXPECT_NEAR(height(model, with("lift.force", -30)), -30.0 / 60, 1e-9);  // along an axis: either sense
  Settings both = with("lift.force", 30);
  both.force["plate"] = {0, 0, 5};
  EXPECT_EQ(refusal(model, both),
            "set of \"lift.force\" = 30: force of \"plate\" takes the place of all forces on body \"plate\"; leave one "
            "out");
  both.force = {{"base", {0, 0, 5}}};
  EXPECT_EQ(refusal(model, both), "taken");
}

// Components of one name: which of them the number would be for, nobody can tell.
TEST(GivenValues, ForceAlongSeveralAxesIsRefused) {
  JointModel model = lifted_plate(100);
  add_spring(model, 60, 40);
  RigidLoad second = model.rigid_loads[0];
  model.rigid_loads.push_back(second);  // along the same axis: both are meant
  EXPECT_NEAR(height(model, with("lift.force", 30)), 60.0 / 60, 1e-9);
  model.rigid_loads[1].dof = 0;
  EXPECT_EQ(
      refusal(model, with("lift.force", 30)),
      "set of \"lift.force\" = 30: rigid force \"lift\" acts along z and x, and one number cannot say both; give the "
      "whole force with force of \"plate\" = x,y,z");
}

// Said or written in the model: the same bits, whatever else is there.
TEST(GivenValues, TheSameAsInTheModel) {
  for (const double k : {60.0, 81.5}) {
    JointModel model = test::bone_chain(4, 6, 60.0), edited = model;
    Settings settings = test::linear();
    settings.set_values["ligament 3.stiffness"] = k;
    settings.set_values["ligament 3.slack-length"] = 8.5;
    settings.set_values["tether.stiffness"] = 23;
    for (RigidSpring& s : edited.rigid_springs) {
      if (s.name == "ligament 3") {
        s.k = k;
        s.free_length = 8.5;
      }
      if (s.name == "tether") s.k = 23;
    }
    const Analysis said = analyse(model, settings), written = analyse(edited, test::linear());
    const Analysis before = analyse(model, test::linear());
    bool moved = false;
    for (std::size_t b = 0; b < said.joint.bodies.size(); ++b) {
      const auto& pose = said.states.back().equilibrium.poses[b];
      EXPECT_EQ(pose.center, written.states.back().equilibrium.poses[b].center);
      moved = moved || pose.center != before.states.back().equilibrium.poses[b].center;
    }
    EXPECT_TRUE(moved);
  }
}

TEST(GivenValues, Refusals) {
  JointModel model = lifted_plate(100);
  add_spring(model, 60, 39);
  test::add_muscle(model, 2, {0, 0, 0}, 1, {0, 0, -30}, -30);  // of a controller that is negative, say
  EXPECT_EQ(
      refusal(model, with("acl.stiffness", 80)),
      "set of \"acl.stiffness\" = 80: the model has no spring, axial force, cable or rigid force of this name (did "
      "you mean \"ACL\"?); it has \"ACL\", \"muscle\", \"lift\"");
  EXPECT_EQ(refusal(model, with("ACL.stifness", 80)),
            "set of \"ACL.stifness\" = 80: spring \"ACL\" has no stifness; it has stiffness, slack-length");
  EXPECT_EQ(refusal(model, with("lift.stiffness", 80)),
            "set of \"lift.stiffness\" = 80: rigid force \"lift\" has no stiffness; it has force");
  EXPECT_EQ(refusal(model, with("ACL.stiffness", -1)),
            "set of \"ACL.stiffness\" = -1: a stiffness is not negative; give a number >= 0");
  EXPECT_EQ(refusal(model, with("ACL.slack-length", 0)),
            "set of \"ACL.slack-length\" = 0: a length is positive; give a number > 0");
  EXPECT_EQ(refusal(model, with("muscle.force", 30)),
            "set of \"muscle.force\" = 30: axial force \"muscle\" would push where it pulls in the model (-30); give a "
            "number <= 0");
  EXPECT_EQ(
      refusal(model, with("ACL.stiffness", kNaN)).find("set of \"ACL.stiffness\" = nan: this is no finite number"), 0u);
  EXPECT_EQ(refusal(model, with("ACL.stiffness", 0)), "taken");  // cut
  EXPECT_EQ(refusal(model, with("muscle.force", 0)), "taken");
}

}  // namespace dea::given_values_test

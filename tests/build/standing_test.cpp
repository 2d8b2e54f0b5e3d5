// Where bones of dea build stand, in what they are free, and the ligaments between them: against answers on paper.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "io/build/joint_feb.h"
#include "io/build/ligaments.h"
#include "io/build/placement.h"
#include "io/feb/read_feb.h"
#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/base/parse.h"
#include "src/build/free_dofs.h"
#include "src/build/mend_surface.h"
#include "src/model/load_curve.h"

#include "tests/build/build_shapes.h"
#include "tests/io/text_file.h"

namespace dea::test {
namespace {

std::string refusal(const std::function<void()>& act) {
  try {
    act();
  } catch (const InputError& e) {
    return line(e.fault);
  } catch (const BadValue& e) {
    return e.what();
  }
  return "";
}

#define EXPECT_REFUSED(act, words) \
  EXPECT_NE(refusal([&] { act; }).find(words), std::string::npos) << refusal([&] { act; })

// ---- ligaments -----------------------------------------------------------------------------------------------------

BuiltLigament ligament(double toe) {
  BuiltLigament l;
  l.name = "MCL & co";
  l.bone_a = 0;
  l.bone_b = 1;
  l.point_a = {0, 0, 0};
  l.point_b = {0, 3, 4};  // 5 long
  l.stiffness = 2000;
  l.slack_length = 4.9;
  l.toe_strain = toe;
  return l;
}

TEST(Ligament, BlankevoortsCurveIsAParabolaAndThenALine) {
  const BuiltLigament l = ligament(0.06);
  const auto at_strain = [&](double e) { return force_of(l, l.slack_length * (1 + e)); };
  EXPECT_EQ(at_strain(-0.1), 0);
  EXPECT_NEAR(at_strain(0.03), 2000 * 0.03 * 0.03 / 0.12, 1e-9);  // k e^2 / (4 e_l), e_l = 0.03: 15
  EXPECT_NEAR(at_strain(0.06), 2000 * (0.06 - 0.03), 1e-9);       // both laws: 60
  EXPECT_NEAR(at_strain(0.1), 2000 * (0.1 - 0.03), 1e-9);         // k (e - e_l): 140
  EXPECT_NEAR(force_of(ligament(0), 4.9 * 1.05), 100, 1e-9);
  EXPECT_NEAR(slack_length(105, 0.05), 100, 1e-12);
}

/// Two plates with a gap, bonded layers 1 thick; the second is loaded.
BuiltJoint plates() {
  BuiltJoint joint;
  const auto plate = [&](const char* name, double bone, double articular, bool up) {
    BuiltBody body;
    body.name = name;
    body.shell = square(2, 10, bone, !up);
    joint.bodies.push_back(body);
    const TriangleSurface s = square(2, 10, articular, up);
    joint.layers.push_back({std::string(name) + "_cartilage", static_cast<int>(joint.bodies.size()) - 1, false,
                            s.points, square(2, 10, bone, up).points, s.triangles});
  };
  plate("low", -1, 0, true);
  plate("high", 1.1, 0.1, false);
  joint.contacts.push_back({"contact", 0, 1});
  joint.bodies[1].fixed = false;
  joint.bodies[1].force = {0, 0, -100};
  return joint;
}

JointModel read_back(const BuiltJoint& joint, const BuiltModelSettings& settings = {}) {
  return read_feb(file("standing.feb", joint_feb(joint, settings)));
}

TEST(Ligament, TheModelHasItsCurveExactly) {
  for (const double toe : {0.06, 0.0, 0.1}) {
    BuiltJoint joint = plates();
    joint.ligaments = {ligament(toe)};
    joint.ligaments.push_back(ligament(toe));
    joint.ligaments[1].name = "slack where it is built";
    joint.ligaments[1].slack_length = 6;
    const JointModel model = read_back(joint);
    ASSERT_EQ(model.discrete_springs.size(), 2u);
    EXPECT_TRUE(model.unsupported.empty());
    for (std::size_t i = 0; i < 2; ++i) {
      const BuiltLigament& l = joint.ligaments[i];
      const DiscreteSprings& springs = model.discrete_springs[i];
      const DiscreteSet& set = model.discrete_sets[at(springs.set)];
      EXPECT_EQ(set.name, l.name);
      ASSERT_EQ(set.pairs.size(), 1u);
      EXPECT_EQ(model.nodes[at(set.pairs[0][0])], l.point_a);
      EXPECT_EQ(model.nodes[at(set.pairs[0][1])], l.point_b);
      EXPECT_EQ(springs.measure, DiscreteSprings::Measure::Elongation);
      for (const double e : {-0.5, -0.01, 0.0, 0.001, 0.03, 0.0599, 0.0601, 0.1, 0.3}) {
        const double length = l.slack_length * (1 + e);
        // the expression takes squares from each other: a few digits of k e^2 / e_l go
        EXPECT_NEAR(value(*springs.force, length - length_of(l)), force_of(l, length), 1e-9) << toe << " " << e;
      }
    }
    // both ends are nodes of their bone
    ASSERT_EQ(model.rigid_nodes.size(), 2u);
    EXPECT_EQ(model.rigid_nodes[0].nodes.size(), 2u);
  }
}

TEST(Ligament, TablesAreReadOrRefusedByLine) {
  const std::string head =
      "name,body_a,x_a [mm],y_a,z_a,body_b,x_b,y_b,z_b,stiffness [N],slack_length,reference_strain,curve,toe_strain\n";
  const auto read = [&](const std::string& rows) { return read_ligaments(file("l.csv", head + rows), "mm"); };
  const std::vector<LigamentRow> rows = read(
      "ACL,femur,1,2,3,tibia,4,5,6,5000,,0.06,,\nMCL,tibia,0,0,0,femur,1,1,1,2750,80,,linear,\nLCL,a,0,0,0,b,1,1,1,"
      "2000,60,,,0.04\n");
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].point_b, Vector3d(4, 5, 6));
  EXPECT_EQ(rows[0].reference_strain, 0.06);
  EXPECT_FALSE(rows[0].slack_length);
  EXPECT_EQ(rows[0].toe_strain, 0.06);
  EXPECT_EQ(rows[1].toe_strain, 0);
  EXPECT_EQ(rows[1].slack_length, 80);
  EXPECT_EQ(rows[2].toe_strain, 0.04);
  EXPECT_EQ(rows[2].line, 4);
  const std::string start = "A,f,1,2,3,t,4,5,6,";
  const std::pair<std::string, const char*> bad[] = {
      {start + "500,,,,\n", ":2: A: found neither slack_length and reference_strain, expected one of them"},
      {start + "500,50,0.1,,\n", "found both slack_length and reference_strain"},
      {start + "0,50,,,\n", "found a stiffness of 0, expected a force per strain above 0"},
      {start + "500,,6,,\n", "found a reference strain of 6, expected -0.5 to 0.5 (5 % is 0.05)"},
      {start + "500,-5,,,\n", "found a slack length of -5"},
      {start + "500,50,,stiff,\n", "found the curve \"stiff\", expected blankevoort or linear"},
      {start + "500,50,,linear,0.06\n", "found a toe strain of a linear curve"},
      {start + "500,50,,,6\n", "found a toe strain of 6"},
      {start + "five,50,,,\n", "stiffness: found \"five\", expected a number"},
      {start + ",50,,,\n", "stiffness: found nothing, expected a number"},
      {start + "500,50,,,\n" + start + "500,50,,,\n", ":3: found the name \"A\" twice"},
      {",f,1,2,3,t,4,5,6,500,50,,,\n", "found no name"}};
  for (const auto& one : bad) EXPECT_REFUSED(read(one.first), one.second);
  EXPECT_REFUSED(read_ligaments(file("u.csv", "name,body_a,x_a [m]\nA,f,1\n"), "mm"),
                 "found the unit \"m\" in \"x_a [m]\", expected mm");
  EXPECT_REFUSED(read_ligaments(file("n.csv", "name,body_a,stifness\nA,f,1\n"), "mm"), "did you mean \"stiffness\"?");
  EXPECT_REFUSED(read_ligaments(file("m.csv", "name,body_a,x_a\nA,f,1\n"), "mm"), "found no column y_a");
  EXPECT_REFUSED(read_ligaments(file("k.csv", "stiffness [N/mm],name\n1,A\n"), "mm"), "expected N, force per strain");
}

// ---- poses ---------------------------------------------------------------------------------------------------------

TEST(Placement, AMatrixAsTextIsAPose) {
  // 90 degrees about z, then by (1, 2, 3): (1, 0, 0) comes to (1, 3, 3)
  for (const char* text :
       {"0 -1 0 1\n1 0 0 2\n0 0 1 3\n0 0 0 1\n", "# pose\n[[0, -1, 0, 1],\n [1, 0, 0, 2],\r\n[0,0,1,3];0;0;0;1]"}) {
    const FilePose pose = read_pose(file("pose.txt", text));
    EXPECT_LT((pose.pose * Vector3d(1, 0, 0) - Vector3d(1, 3, 3)).norm(), 1e-12);
    EXPECT_FALSE(pose.itk);
    EXPECT_LT(pose.corrected, 1e-12);
  }
  const FilePose rounded = read_pose(file("rounded.txt", "0.866 -0.5 0 0 0.5 0.866 0 0 0 0 1 0 0 0 0 1"));
  EXPECT_NEAR(rounded.corrected, std::cos(kPi / 6) - 0.866, 1e-4);  // sqrt(3)/2 with three digits
  EXPECT_LT((rounded.pose.linear().transpose() * rounded.pose.linear() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
}

TEST(Placement, AnItkTransformTurnsAboutItsCentre) {
  // 90 degrees about z through (1, 0, 0), then by (0, 0, 5): (2, 0, 0) comes to (1, 1, 5)
  const FilePose pose =
      read_pose(file("T.tfm",
                     "#Insight Transform File V1.0\n#Transform 0\nTransform: AffineTransform_double_3_3\n"
                     "Parameters: 0 -1 0 1 0 0 0 0 1 0 0 5\nFixedParameters: 1 0 0\n"));
  EXPECT_TRUE(pose.itk);
  EXPECT_LT((pose.pose * Vector3d(2, 0, 0) - Vector3d(1, 1, 5)).norm(), 1e-12);
}

TEST(Placement, WhatIsNoPoseIsRefused) {
  const std::pair<const char*, const char*> bad[] = {
      {"1 0 0 0 0 1 0 0 0 0 1 0", "found 12 numbers, expected 16 numbers"},
      {"1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 2", "found more than 16 numbers"},
      {"1 0 0 0 0 1 0 0 0 0 1 0 5 6 7 1", "found the last row 5 6 7 1, expected 0 0 0 1"},
      {"2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1", "found axes 2, 2 and 2 long, expected 1: a pose does not scale"},
      {"1 0.01 0 0 0 1 0 0 0 0 1 0 0 0 0 1", "found axes that are not at right angles"},
      {"-1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1", "found a mirror image"},
      {"time,tx\n1,2\n", ":1: found \"time,tx\", expected 16 numbers"},
      {"#Insight Transform File V1.0\nTransform: BSplineTransform_double_3_3\nParameters: 1\n",
       ":2: found \"BSplineTransform_double_3_3\", expected AffineTransform_double_3_3"},
      {"#Insight Transform File V1.0\nTransform: AffineTransform_double_3_3\nParameters: 1 0 0 0 1 0 0 0 1 0 0\n",
       ":3: found 11 numbers, expected 12"},
      {"#Insight Transform File V1.0\nTransform: AffineTransform_double_3_3\nParameters: 2 0 0 0 1 0 0 0 1 0 0 0\n",
       ":3: found axes 2, 1 and 1 long"},
      {"#Insight Transform File V1.0\nTransform: a\nTransform: b\n", ":3: found a second \"Transform:\""},
      {"#Insight Transform File V1.0\n", "the file is cut off"},
      {"", "found 0 numbers"}};
  for (const auto& one : bad) EXPECT_REFUSED(read_pose(file("bad.txt", one.first)), one.second);
  EXPECT_REFUSED(read_pose("none.tfm"), "none.tfm: found no file that can be read");
}

// ---- free, held, moved ---------------------------------------------------------------------------------------------

/// What a dof of the second body is in both steps of the model: 'f'ixed, 'p'rescribed, 'o'pen.
std::string dofs_in_step(const JointModel& model, int step) {
  std::string all(6, 'o');
  for (const RigidFixed& f : model.rigid_fixed)
    for (std::size_t k = 0; k < 6; ++k)
      if (f.acts(step) && f.material == 2 && f.dofs[k]) all[k] = 'f';
  for (const RigidPrescribed& p : model.rigid_prescribed)
    if (p.acts(step) && p.material == 2) all[at(p.dof)] = 'p';
  return all;
}

TEST(FreeDofs, TheModelFreesAndHoldsThem) {
  BuiltJoint joint = plates();
  EXPECT_EQ(dofs_in_step(read_back(joint), 0), "pppfff");
  EXPECT_EQ(dofs_in_step(read_back(joint), 1), "ooofff");
  // x held, free to turn about x and y: FEBio takes all three rotations of the seat or none
  joint.bodies[1].held = {true, false, false, false, false, true};
  BuiltModelSettings settings;
  settings.seat = {Vector3d::Zero(), {0, 1, 2}};
  settings.seat_turn = {Vector3d::Zero(), {0.1, 0.2, 0.3}};
  const JointModel model = read_back(joint, settings);
  EXPECT_EQ(dofs_in_step(model, 0), "fppppp");
  EXPECT_EQ(dofs_in_step(model, 1), "foooof");
  const double seat[] = {0, 1, 2, 0.1, 0.2, 0.3};
  for (const RigidPrescribed& p : model.rigid_prescribed) EXPECT_NEAR(value(model, p.value, 1.0), seat[p.dof], 1e-15);
}

TEST(FreeDofs, AMotionIsPrescribedRowByRow) {
  BuiltJoint joint = plates();
  BuiltBody& high = joint.bodies[1];
  high.held.fill(false);
  high.held[0] = true;
  high.moved = {false, false, true, true, true, true};
  high.force.setZero();
  for (int i = 0; i < 3; ++i) {
    high.motion.emplace_back();
    high.motion.back() << 0, 0, -0.1 * (i + 1), 0.01 * i, 0.02 * i, 0.03 * (i + 1);
  }
  EXPECT_EQ(joint.loads(), 3u);
  const JointModel model = read_back(joint);
  EXPECT_EQ(dofs_in_step(model, 0), "fppppp");
  EXPECT_EQ(dofs_in_step(model, 1), "fopppp");
  EXPECT_TRUE(model.rigid_loads.empty());
  for (const RigidPrescribed& p : model.rigid_prescribed) {
    if (p.step >= 0) continue;  // the seat's, of y
    const auto pose = [&](std::size_t row) { return high.motion[row][p.dof]; };
    EXPECT_NEAR(value(model, p.value, 0.0), 0, 1e-15);
    EXPECT_NEAR(value(model, p.value, 0.5), pose(0) / 2, 1e-15);
    for (const double t : {1.0, 1.5, 2.0}) EXPECT_NEAR(value(model, p.value, t), pose(0), 1e-15);
    EXPECT_NEAR(value(model, p.value, 3.0), pose(1), 1e-15);
    EXPECT_NEAR(value(model, p.value, 3.5), (pose(1) + pose(2)) / 2, 1e-15);
    EXPECT_NEAR(value(model, p.value, 4.0), pose(2), 1e-15);
  }
}

TEST(FreeDofs, AMotionAboutTheOriginIsThatOfTheCentre) {
  BuiltJoint joint;
  joint.bodies.resize(1);
  BuiltBody& body = joint.bodies[0];
  body.center = {2, 0, 5};
  body.about_origin = true;
  body.motion.resize(1);
  body.motion[0] << 1, 1, 1, 0, 0, kPi / 2;  // (2, 0, 5) comes to (0, 2, 5), then to (1, 3, 6)
  count_motion_from_centers(joint);
  EXPECT_LT((body.motion[0].head<3>() - Vector3d(-1, 3, 1)).norm(), 1e-12);
  EXPECT_NEAR(body.motion[0][5], kPi / 2, 1e-15);
  EXPECT_FALSE(body.about_origin);
}

TEST(FreeDofs, MomentsActOnWhatTurns) {
  BuiltJoint joint = plates();
  BuiltBody& high = joint.bodies[1];
  high.held = {false, false, false, false, true, true};
  high.forces = {{0, 0, -100}, {0, 0, -200}};
  high.moments = {{5, 6, 7}, {8, 9, 10}};
  const JointModel model = read_back(joint);
  ASSERT_EQ(model.rigid_loads.size(), 4u);  // three forces, and the moment about x
  const RigidLoad& moment = model.rigid_loads.back();
  EXPECT_EQ(moment.dof, 3);
  EXPECT_NEAR(value(model, moment.value, 2.0), 5, 1e-15);
  EXPECT_NEAR(value(model, moment.value, 3.0), 8, 1e-15);
}

/// Two plateaus side by side along `axis`, and what stands on both.
struct TwoCompartments {
  BuildRequest request;
  BuiltJoint joint;
  BuildReport report;
  explicit TwoCompartments(int axis) {
    request.bones.resize(2);
    joint.bodies.resize(2);
    for (std::size_t b = 0; b < 2; ++b) request.bones[b].name = joint.bodies[b].name = b == 0 ? "tibia" : "femur";
    joint.bodies[1].fixed = false;
    joint.bodies[1].force = {0, 0, -700};
    for (const double side : {-20.0, 20.0}) {
      TriangleSurface s = square(2, 10, 0, true);
      for (Vector3d& x : s.points) x[axis] += side;
      joint.layers.push_back({"plateau", 0, true, s.points, {}, s.triangles});
    }
    joint.layers.push_back(
        {"condyles", 1, true, square(2, 40, 1, false).points, {}, square(2, 40, 1, false).triangles});
    joint.contacts = {{"a", 0, 2}, {"b", 1, 2}};
  }
  DofFlags held() {
    choose_dofs(request, joint, report);
    return joint.bodies[1].held;
  }
};

TEST(FreeDofs, AreChosenByWhatIsKnown) {
  const DofFlags translations = {false, false, false, true, true, true};
  for (const int axis : {0, 1}) {
    TwoCompartments alone(axis);
    EXPECT_EQ(alone.held(), translations);
    EXPECT_NE(alone.report.findings[0].find(axis == 0 ? "z,Rv" : "z,Ru"), std::string::npos)
        << alone.report.findings[0];
    TwoCompartments knee(axis);
    knee.joint.ligaments = {ligament(0)};
    DofFlags flexion = {};
    flexion[at(3 + axis)] = true;
    EXPECT_EQ(knee.held(), flexion);
    EXPECT_NE(knee.report.findings[0].find(
                  fmt::format("flexion, about {}, is held: the compartments lie 0.0 degrees", "xyz"[axis])),
              std::string::npos)
        << knee.report.findings[0];
  }
  TwoCompartments held(0);
  held.joint.ligaments = {ligament(0)};
  held.request.bones[1].hold = {true, false, false, false, false, true};
  EXPECT_EQ(held.held(), (DofFlags{true, false, false, true, false, true}));
  TwoCompartments ball(0);
  ball.joint.ligaments = {ligament(0)};
  ball.joint.bodies[1].ball = true;
  EXPECT_EQ(ball.held(), translations);
  TwoCompartments given(0);
  given.joint.ligaments = {ligament(0)};
  given.request.bones[1].dofs_given = true;
  given.joint.bodies[1].held = {true, true, false, true, true, true};
  EXPECT_EQ(given.held(), (DofFlags{true, true, false, true, true, true}));
  EXPECT_EQ(given.report.findings[0], "femur: free in z: as given");
  TwoCompartments elsewhere(0);
  elsewhere.joint.ligaments = {ligament(0)};
  elsewhere.joint.ligaments[0].bone_b = 2;  // of a third bone
  EXPECT_EQ(elsewhere.held(), translations);
  TwoCompartments one(0);
  one.joint.ligaments = {ligament(0)};
  one.joint.contacts.pop_back();
  EXPECT_EQ(one.held(), translations);
}

TEST(FreeDofs, MomentsOnWhatDoesNotTurnAreTold) {
  TwoCompartments knee(0);
  knee.joint.bodies[1].moments = {{1, 2, 3}};
  knee.held();
  EXPECT_TRUE(knee.joint.bodies[1].moments.empty());
  EXPECT_EQ(knee.report.findings.back(), "femur: the table's moments have no effect, for the bone does not turn");
}

}  // namespace
}  // namespace dea::test

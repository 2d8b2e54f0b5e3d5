// Bodies placed before they start, and rows of loads and motion: answers on paper, and the same model turned by hand.
#include "src/joint/placing.h"
#include "tests/findings.h"

#include <gtest/gtest.h>

#include <cmath>

#include "src/base/error.h"
#include "src/base/parse.h"
#include "src/base/rotations.h"
#include "src/run/analysis.h"
#include "src/run/states.h"
#include "tests/src/test_models.h"

namespace dea::placing_test {

using Eigen::Matrix3d;

constexpr double kDegree = kPi / 180;

Placement turned(const std::string& body, const Vector3d& axis, double degrees) {
  return {Placement::Kind::Rotate, body, axis, degrees};
}
Placement moved(const std::string& body, const Vector3d& by) { return {Placement::Kind::Move, body, by}; }

Matrix3d turn(const Vector3d& axis, double degrees) { return rotation(degrees * kDegree * axis.normalized()); }

Analysis solved_with(const JointModel& model, const Settings& settings) {
  AnalysisOptions options;
  options.times = row_states(model, settings, parse_states(""), "--states").times;
  if (row_count(settings) == 0 && !settings.skip_steps) options.times.clear();
  return analyse(model, settings, options);
}

StateResult last_state(const JointModel& model, const Settings& settings = {}) {
  return solved_with(model, settings).states.back();
}

/// Ball in socket with a slanted load: no symmetry. Materials: 0 cartilage, 1 socket, 2 ball.
JointModel slanted() {
  JointModel model = test::concentric_spheres(16, 1500.0, true);
  test::force(model, 2, {300, -150, 0});
  return model;
}

/// Moves a body's nodes and centre of mass in the model itself.
void by_hand(JointModel& model, int material, const Matrix3d& R, const Vector3d& about, const Vector3d& shift) {
  const Joint joint = make_joint(model, {});
  const int body = joint.find_body(model, model.materials[static_cast<std::size_t>(material)].name);
  for (std::size_t i = 0; i < model.nodes.size(); ++i)
    if (joint.node_body[i] == body) model.nodes[i] = about + R * (model.nodes[i] - about) + shift;
  Vector3d& center = *model.materials[static_cast<std::size_t>(material)].center_of_mass;
  center = about + R * (center - about) + shift;
}

void expect_same(const StateResult& a, const StateResult& b, double tolerance) {
  ASSERT_EQ(a.equilibrium.outcome, b.equilibrium.outcome) << a.equilibrium.message << b.equilibrium.message;
  ASSERT_EQ(a.fields.size(), b.fields.size());
  for (std::size_t c = 0; c < a.statistics.size(); ++c) {
    const ContactStatistics &p = a.statistics[c], &q = b.statistics[c];
    EXPECT_NEAR(p.peak, q.peak, tolerance * q.peak);
    EXPECT_NEAR(p.mean, q.mean, tolerance * q.mean);
    EXPECT_NEAR(p.contact_area, q.contact_area, tolerance * q.contact_area);
    EXPECT_LT((p.force - q.force).norm(), tolerance * q.force.norm());
  }
}

TEST(Placing, IsTheModelTurnedByHand) {
  const Vector3d axis(1, -2, 0.5), about(3, 1, -2), shift(0.2, -0.1, 0.3);
  Settings settings;
  settings.placements = {turned("ball", axis, 25), moved("ball", shift)};
  settings.rotate_about["ball"] = {TurnPoint::Kind::Point, about};
  JointModel hand = slanted();
  by_hand(hand, 2, turn(axis, 25), about, shift);
  const StateResult placed = last_state(slanted(), settings), same = last_state(hand);
  expect_same(placed, same, 1e-7);  // a search stops where its residual is small
  const Vector3d center = placed.equilibrium.poses[1].center;
  EXPECT_LT((center - same.equilibrium.poses[1].center).norm(), 1e-6);
}

// The model with its bodies placed, as dea convert writes it, is the placed one.
TEST(Placing, AModelWrittenPlacedIsTheSame) {
  JointModel model = slanted();
  test::add_rigid_spring(model, 1, {30, 0, 0}, 2, {10, 0, -5},
                         40);  // as long as in the reference, before all is placed
  Settings settings;
  settings.placements = {turned("ball", {0, 1, 0}, 12), moved("socket", {0.1, 0, -0.1})};
  const StateResult placed = last_state(model, settings);
  const StateResult written = last_state(placed_model(model, make_joint(model, settings), settings));
  expect_same(placed, written, 1e-7);
  ASSERT_EQ(placed.equilibrium.ligament_force.size(), 1u);
  EXPECT_GT(std::abs(placed.equilibrium.ligament_force[0]), 1.0);
  EXPECT_NEAR(placed.equilibrium.ligament_force[0], written.equilibrium.ligament_force[0], 1e-5);
}

// A force that pulls the bones apart would press them with the other sign, and that is said.
TEST(Rows, ALoadOfTheWrongSignIsTold) {
  const JointModel model = test::concentric_spheres(16, -500.0);
  const Equilibrium e = last_state(model).equilibrium;
  EXPECT_EQ(e.outcome, Outcome::SurfacesApart);
  EXPECT_NE(e.advice.text.find("opposite load"), std::string::npos);
}

// What the plot file shows is counted from the file's mesh: the placement is part of it.
TEST(Placing, IsPartOfTheDisplacement) {
  Settings settings;
  settings.placements = {moved("ball", {0.25, 0, 0.5})};
  settings.squash = false;
  const Analysis a = solved_with(slanted(), settings);
  const StateResult& first = a.states.front();
  ASSERT_EQ(first.when.time, 0.0);
  for (std::size_t i = 0; i < first.displacements.size(); ++i)
    if (a.joint.node_body[i] == 1) {
      EXPECT_LT((first.displacements[i] - Vector3d(0.25, 0, 0.5)).norm(), 1e-9) << i;
    }
}

// A ball about the centre of its concentric socket: only its own pose changes. Its facets move, so not to the last
// digit.
TEST(Placing, ABallTurnedInItsSocketChangesNothingElse) {
  const JointModel model = test::concentric_spheres(32, 2000.0);
  Settings settings;
  settings.placements = {turned("ball", {1, 1, 3}, 15)};
  const StateResult before = last_state(model), after = last_state(model, settings);
  expect_same(after, before, 3e-3);
  EXPECT_LT((after.equilibrium.poses[1].rotation - turn({1, 1, 3}, 15)).norm(), 1e-12);
  EXPECT_LT((after.equilibrium.poses[1].center - before.equilibrium.poses[1].center).norm(), 2e-3);
}

// A round body turned about a point off its centre is the body moved by what its centre moves: (Q - 1)(centre - point).
TEST(Placing, AnEccentricBallTurnedIsABallMoved) {
  JointModel model = test::concentric_spheres(32, 0.0);
  test::fix(model, 2, {true, true, true, true, true, true});
  const Vector3d point(0, 12, -1), axis(1, 0, 0);
  Settings turn_it, move_it;
  turn_it.placements = {turned("ball", axis, -4)};
  turn_it.rotate_about["ball"] = {TurnPoint::Kind::Point, point};
  move_it.placements = {moved("ball", (turn(axis, -4) - Matrix3d::Identity()) * (-point))};
  const StateResult a = last_state(model, turn_it), b = last_state(model, move_it);
  EXPECT_GT(b.statistics[0].peak, 0.1);
  expect_same(a, b, 5e-3);
}

TEST(Placing, OrderOfTurnsMatters) {
  const JointModel model = slanted();
  const Joint joint = make_joint(model, {});
  Settings ab, ba;
  ab.placements = {turned("ball", {0, 0, 1}, 90), turned("ball", {1, 0, 0}, 90)};
  ba.placements = {ab.placements[1], ab.placements[0]};
  ab.rotate_about["ball"] = ba.rotate_about["ball"] = {TurnPoint::Kind::CenterOfMass};
  const Matrix3d A = turn({0, 0, 1}, 90), B = turn({1, 0, 0}, 90);
  EXPECT_LT((starting_poses(model, joint, ab)[1].rotation - B * A).norm(), 1e-15);
  EXPECT_LT((starting_poses(model, joint, ba)[1].rotation - A * B).norm(), 1e-15);
}

// The point of the turn goes along with what moved the body before.
TEST(Placing, APointGoesAlongWithItsBody) {
  const JointModel model = slanted();
  const Joint joint = make_joint(model, {});
  const Vector3d point(4, 0, 0), shift(0, 0, 7), axis(0, 1, 0);
  Settings settings;
  settings.placements = {moved("ball", shift), turned("ball", axis, 90)};
  settings.rotate_about["ball"] = {TurnPoint::Kind::Point, point};
  const Pose pose = starting_poses(model, joint, settings)[1];
  // the centre of mass, at the origin, is at -4 x from the point; turned about y: at +4 z
  EXPECT_LT((pose.center - Vector3d(4, 0, 11)).norm(), 1e-12);
}

TEST(Placing, PrescribedMotionsCountFromThePlace) {
  JointModel model = test::flat_plates(6, 10, 2, 0.5);
  test::fix(model, 2, {true, true, false, true, true, true});
  test::prescribe(model, 2, 2, -0.4);
  Settings settings;
  settings.placements = {moved("plate", {0, 0, -0.3})};
  const StateResult s = last_state(model, settings);
  EXPECT_NEAR(s.equilibrium.poses[1].center.z(), -0.7, 1e-12);
  EXPECT_GT(s.statistics[0].peak, 0);
}

TEST(Placing, RefusesASphereThatSaysLittle) {
  const JointModel flat = test::flat_plates(4, 10, 2, 0.5);
  Settings settings;
  settings.placements = {turned("plate", {0, 0, 1}, 5)};
  EXPECT_THROW(recognise(flat, settings), UsageError);
  settings.rotate_about["plate"] = {TurnPoint::Kind::CenterOfMass};
  EXPECT_NO_THROW(recognise(flat, settings));
  settings.placements = {moved("ground", {0, 0, 1})};
  EXPECT_THROW(recognise(flat, settings), UsageError);
}

// -- rows ------------------------------------------------------------------------------------------------------------

using Vector6 = Eigen::Matrix<double, 6, 1>;

Vector6 six(const Vector3d& force, const Vector3d& moment = Vector3d::Zero()) {
  Vector6 all;
  all << force, moment;
  return all;
}

/// Rows of loads on the ball of slanted().
Settings rows(const std::vector<Vector6>& loads) {
  Settings settings;
  settings.loads.body = "ball";
  settings.loads.load = loads;
  for (std::size_t r = 0; r < loads.size(); ++r) settings.loads.time.push_back(0.1 * static_cast<double>(r));
  return settings;
}

// The model's own load, as a row, is the model's own last state; and rows replace it.
TEST(Rows, ReplaceTheModelsLoads) {
  const JointModel model = slanted();
  const StateResult own = last_state(model);
  const Analysis a = solved_with(model, rows({six({300, -150, 1500}), six({0, 0, 800})}));
  const StateResult &first = a.states[a.states.size() - 2], &second = a.states.back();
  expect_same(first, own, 1e-7);
  EXPECT_NEAR(second.statistics[0].force.norm(), 800, 1e-3);
  EXPECT_EQ(second.when.time, 0.1);
}

TEST(Rows, WithoutStepsStartFromRest) {
  const JointModel model = slanted();
  Settings settings = rows({six({300, -150, 1500})});
  const StateResult after = last_state(model, settings);
  settings.skip_steps = true;
  const Analysis alone = solved_with(model, settings);
  ASSERT_EQ(alone.states.size(), 1u);
  expect_same(alone.states.back(), after, 1e-6);
}

// The same load, told in three frames of a ball that does not turn.
TEST(Rows, FramesGiveOneAnswer) {
  const JointModel model = slanted();
  const Vector6 load = six({300, -150, 1500}, {200, 100, -50});
  const StateResult global = last_state(model, rows({load}));

  const Matrix3d axes = turn({1, 2, 3}, 40);
  Settings custom = rows({six(axes.transpose() * load.head<3>(), axes.transpose() * load.tail<3>())});
  custom.loads.frame.kind = TableFrame::Kind::Axes;
  custom.loads.frame.axes = axes;
  expect_same(last_state(model, custom), global, 1e-9);

  // the socket is held where it was placed: its axes are those of its placement
  const Matrix3d R = turn({0, 1, 0}, 20);
  for (const char* body : {"ball", "socket"}) {
    Settings both = rows({load});
    both.loads.frame.kind = TableFrame::Kind::Body;
    both.loads.frame.body = body;
    both.placements = {turned("ball", {0, 1, 0}, 20), turned("socket", {0, 1, 0}, 20)};
    for (const char* name : {"ball", "socket"}) both.rotate_about[name] = {TurnPoint::Kind::CenterOfMass};
    const StateResult turned_too = last_state(model, both);
    EXPECT_NEAR(turned_too.statistics[0].peak, global.statistics[0].peak, 1e-8 * global.statistics[0].peak) << body;
    EXPECT_LT((turned_too.statistics[0].force - R * global.statistics[0].force).norm(), 1e-5) << body;
  }
}

// A plate on a layer, free to tilt: a force at a point is the force at the centre and its moment about it.
TEST(Rows, AMomentIsAboutTheLoadPoint) {
  JointModel model = test::flat_plates(8, 10, 2, 0.0);
  test::fix(model, 2, {true, true, false, false, false, true});
  const Vector3d force(0, 0, -60), point(0.4, -0.3, 0), moment(-5, 8, 0);
  Settings at_point = rows({six(force, moment)}), at_center = rows({six(force, moment + point.cross(force))});
  at_point.loads.body = at_center.loads.body = "plate";
  at_point.load_at["plate"] = {false, point};
  at_point.skip_steps = at_center.skip_steps = true;
  const StateResult a = last_state(model, at_point), b = last_state(model, at_center);
  ASSERT_EQ(a.equilibrium.outcome, Outcome::Balanced) << a.equilibrium.message;
  // the arm tilts with the plate: of second order
  expect_same(a, b, 1e-4);
  const Vector6 on_plate = a.equilibrium.contact_on_target[0].head<6>();
  const Vector3d arm = a.equilibrium.poses[1].rotation * point;
  EXPECT_LT((on_plate.head<3>() + force).norm(), 1e-6 * force.norm());
  EXPECT_LT((on_plate.tail<3>() + moment + arm.cross(force)).head<2>().norm(), 1e-5 * moment.norm());
}

// Poses of a table are what the model would have prescribed.
TEST(Rows, MotionIsAPrescribedPose) {
  JointModel model = test::flat_plates(6, 10, 2, 0.1);
  const Vector3d w = 0.01 * Vector3d(1, -0.5, 0.2);
  Settings table;
  table.motion.body = "plate";
  table.motion.time = {0.0};
  table.motion.motion = {six({0.05, 0, -0.4}, w)};
  table.motion.turns = true;
  const StateResult a = last_state(model, table);
  EXPECT_EQ(a.equilibrium.outcome, Outcome::Prescribed);
  EXPECT_LT((a.equilibrium.poses[1].rotation - rotation(w)).norm(), 1e-14);
  EXPECT_LT((a.equilibrium.poses[1].center - Vector3d(0.05, 0, -0.4)).norm(), 1e-14);

  // about a point: that point moves by the translation alone
  const Vector3d point(2, 1, 0);
  table.rotate_about["plate"] = {TurnPoint::Kind::Point, point};
  const Pose pose = last_state(model, table).equilibrium.poses[1];
  EXPECT_LT((pose.center + pose.rotation * point - (point + Vector3d(0.05, 0, -0.4))).norm(), 1e-12);
}

// Rows that turn about the global origin move every point of the body as it starts: x = R x + p, whatever its centre of
// mass, its placement and the point that it is turned about.
TEST(Rows, MotionAboutTheOriginMovesEveryPointOfTheBodyAsItStarts) {
  JointModel model = test::flat_plates(6, 10, 2, 0.1);
  const Vector3d w = 0.01 * Vector3d(1, -0.5, 0.2), p(0.05, 0.3, -0.4), shift(0.2, 0, 0.1);
  Settings table;
  table.placements = {{Placement::Kind::Move, "plate", shift}};
  table.rotate_about["plate"] = {TurnPoint::Kind::Point, Vector3d(2, 1, 0)};
  table.motion.body = "plate";
  table.motion.time = {0.0};
  table.motion.motion = {six(p, w)};
  table.motion.turns = table.motion.about_origin = true;
  const StateResult a = last_state(model, table);
  const Pose pose = a.equilibrium.poses[1];
  const Vector3d point(-3, 4, 1), center = Vector3d::Zero();  // of mass, in the reference: where other tests have it
  EXPECT_LT((pose.rotation - rotation(w)).norm(), 1e-14);
  EXPECT_LT((pose.center + pose.rotation * (point - center) - (rotation(w) * (point + shift) + p)).norm(), 1e-12);
}

// A table of translations leaves the rotation that the model prescribes as it is.
TEST(Rows, TranslationsAloneLeaveTheModelsRotation) {
  JointModel model = test::flat_plates(6, 10, 2, 0.5);
  test::fix(model, 2, {false, false, false, false, true, true});
  test::prescribe(model, 2, 3, 0.03);
  Settings table;
  table.motion.body = "plate";
  table.motion.time = {0.0};
  table.motion.motion = {six({0.05, 0, -0.1})};
  const Pose pose = last_state(model, table).equilibrium.poses[1];
  EXPECT_LT((pose.rotation - rotation(Vector3d(0.03, 0, 0))).norm(), 1e-14);
  EXPECT_LT((pose.center - Vector3d(0.05, 0, -0.1)).norm(), 1e-14);
}

/// The socket of slanted(), turned by 0.2 rad about x in the first step and by another 0.1, relative, in the second.
JointModel turned_in_two_steps() {
  JointModel model = slanted();
  model.rigid_fixed.erase(model.rigid_fixed.begin());  // the socket's
  test::fix(model, 1, {true, true, true, false, false, false});
  model.steps.push_back(model.steps[0]);
  model.controllers[0].points = {{0, 0}, {1, 1}, {2, 1}};
  for (int step = 0; step < 2; ++step) {
    for (int k = 0; k < 3; ++k) {
      test::prescribe(model, 1, 3 + k, k > 0 ? 0.0 : step == 0 ? 0.2 : 0.1);
      model.rigid_prescribed.back().step = step;
      model.rigid_prescribed.back().relative = step == 1;
    }
  }
  return model;
}

// The axes of a body that is moved relative to its pose at the start of the step: 0.3 rad about x.
TEST(Rows, AFrameTurnsWithABodyThatIsMovedRelatively) {
  const JointModel model = turned_in_two_steps();
  const Vector3d load(300, -150, 1500);
  Settings frame = rows({six(load)}), axes = frame;
  frame.loads.frame.kind = TableFrame::Kind::Body;
  frame.loads.frame.body = "socket";
  axes.loads.frame.kind = TableFrame::Kind::Axes;
  axes.loads.frame.axes = rotation(Vector3d(0.3, 0, 0));
  const StateResult a = last_state(model, frame);
  ASSERT_LT((a.equilibrium.poses[0].rotation - rotation(Vector3d(0.3, 0, 0))).norm(), 1e-12);
  expect_same(a, last_state(model, axes), 1e-9);
}

// ---------------------------------------------------------------------------------------------------------------------
// Frames with names

Settings with_frame(const Matrix3d& axes, Settings settings = {}) {
  settings.frames["pelvis"] = axes;
  return settings;
}

/// Every way to name a frame gives what the same numbers in global directions give.
TEST(Frames, NumbersAlongThemAreThoseInGlobalDirections) {
  const JointModel model = slanted();
  const Matrix3d axes = turn({1, 2, 3}, 40);
  Settings named = with_frame(axes), plain;
  named.placements = {turned("ball", {0, 0, 1}, 12), moved("ball", {0.1, 0.2, -0.1})};
  for (Placement& p : named.placements) p.frame = "pelvis";
  plain.placements = {turned("ball", axes.col(2), 12), moved("ball", axes * Vector3d(0.1, 0.2, -0.1))};
  named.force["ball"] = axes.transpose() * Vector3d(300, -150, 1500);
  named.force_frame["ball"] = "pelvis";
  plain.force["ball"] = {300, -150, 1500};
  for (Settings* s : {&named, &plain}) s->rotate_about["ball"] = {TurnPoint::Kind::CenterOfMass};
  expect_same(last_state(model, named), last_state(model, plain), 1e-8);

  const Vector6 load = six({300, -150, 1500}, {200, 100, -50});
  Settings table = with_frame(axes, rows({six(axes.transpose() * load.head<3>(), axes.transpose() * load.tail<3>())}));
  table.loads.frame.kind = TableFrame::Kind::Named;
  table.loads.frame.frame = "pelvis";
  expect_same(last_state(model, table), last_state(model, rows({load})), 1e-9);
}

/// A frame's axes never turn by themselves; with a body they do, the loaded one too.
TEST(Frames, TurnWithABodyThatIsNamed) {
  const JointModel model = slanted();
  const Matrix3d axes = turn({1, 2, 3}, 40), R = turn({0, 1, 0}, 20);
  const Vector3d load(300, -150, 1500);
  for (const char* body : {"", "ball", "socket"}) {
    Settings named = with_frame(axes, rows({six(axes.transpose() * load)}));
    named.loads.frame = {TableFrame::Kind::Named, body, Matrix3d::Identity(), "pelvis"};
    named.placements = {turned("ball", {0, 1, 0}, 20), turned("socket", {0, 1, 0}, 20)};
    Settings plain = rows({six(*body == '\0' ? load : Vector3d(R * load))});
    plain.placements = named.placements;
    for (Settings* s : {&named, &plain})
      for (const char* name : {"ball", "socket"}) s->rotate_about[name] = {TurnPoint::Kind::CenterOfMass};
    expect_same(last_state(model, named), last_state(model, plain), 1e-8);
  }
}

TEST(Frames, AreToldAndThoseThatAreNotThereAreRefused) {
  Matrix3d axes;
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  Settings settings = with_frame(axes);
  settings.force["ball"] = {0, 0, 1};
  settings.force_frame["ball"] = "pelvis";
  const std::string text = test::words_of(recognise(slanted(), settings).joint.findings);
  EXPECT_NE(
      text.find("frame \"pelvis\" in the model's axes: x (0.0000, -1.0000, 0.0000), y (0.0000, 0.0000, -1.0000), z "
                "(1.0000, 0.0000, 0.0000)"),
      std::string::npos)
      << text;
  settings.force_frame["ball"] = "pelvs";
  try {
    recognise(slanted(), settings);
    FAIL();
  } catch (const UsageError& e) {
    EXPECT_NE(std::string(e.what()).find("there is no frame \"pelvs\" (did you mean \"pelvis\"?)"), std::string::npos)
        << e.what();
  }
}

// What is printed of the first row: the axes of a body that is held where it was placed are turned with it.
TEST(Rows, FirstRowIsToldInGlobalAxes) {
  Settings settings = rows({six({100, 0, 0})});
  settings.loads.frame.kind = TableFrame::Kind::Body;
  settings.loads.frame.body = "socket";
  settings.placements = {turned("socket", {0, 1, 0}, 90)};
  settings.rotate_about["socket"] = {TurnPoint::Kind::CenterOfMass};
  const std::string text = test::words_of(recognise(slanted(), settings).joint.findings);
  EXPECT_NE(text.find(", -100), moment"), std::string::npos) << text;
}

TEST(Rows, AnalysisKnowsWhereBodiesStartAndWhichMayTurn) {
  Settings settings;
  settings.placements = {turned("socket", {0, 0, 1}, 90)};
  settings.rotate_about["socket"] = {TurnPoint::Kind::CenterOfMass};
  const Analysis a = solved_with(slanted(), settings);
  EXPECT_LT((a.start[0].rotation - turn({0, 0, 1}, 90)).norm(), 1e-14);
  EXPECT_EQ(a.free_to_turn, (std::vector<char>{0, 0, 0}));  // the ball is free to move, not to turn
}

TEST(Rows, RefuseTablesInPart) {
  Settings settings = rows({six({0, 0, 800}), six({0, 0, 900})});
  settings.loads.load.pop_back();
  EXPECT_THROW(recognise(slanted(), settings), UsageError);
  settings = rows({six({0, 0, 800})});
  settings.loads.body.clear();
  EXPECT_THROW(recognise(slanted(), settings), UsageError);
  settings = {};
  settings.motion.body = "ball";
  settings.motion.time = {0.0, 1.0};
  settings.motion.motion = {Vector6::Zero()};
  EXPECT_THROW(recognise(slanted(), settings), UsageError);
}

TEST(Rows, RefuseWhatDoesNotFit) {
  const JointModel model = slanted();
  Settings settings = rows({six({0, 0, 800})});
  settings.force["ball"] = {0, 0, 1};
  EXPECT_THROW(recognise(model, settings), UsageError);
  settings.force.clear();
  settings.motion.body = "socket";
  settings.motion.time = {5.0};
  settings.motion.motion = {Vector6::Zero()};
  EXPECT_THROW(recognise(model, settings), UsageError);  // other times than the loads'
}

// -- which states ----------------------------------------------------------------------------------------------------

TEST(States, AreParsed) {
  const StatesAsked asked = parse_states("0.5,last,1:2");
  EXPECT_EQ(asked.times, std::vector<double>{0.5});
  EXPECT_TRUE(asked.last);
  ASSERT_EQ(asked.ranges.size(), 1u);
  EXPECT_EQ(asked.ranges[0][1], 2.0);
  EXPECT_TRUE(parse_states("all").all);
  EXPECT_THROW(parse_states("some"), BadValue);
  EXPECT_THROW(parse_states("2:1"), BadValue);
}

TEST(Numbers, ADecimalCommaIsTold) {
  const auto refusal = [](const std::string& text) -> std::string {
    try {
      parse_number(text);
    } catch (const BadValue& e) {
      return e.what();
    }
    return "";
  };
  for (const char* text : {"11,85", "-0,5", "1,5e3", "+1,5"})
    EXPECT_EQ(refusal(text), std::string("found \"") + text + "\", expected a number with a decimal point");
  for (const char* text : {"1,2,3", ",5x", "1.5,2", "a,5", "1,", "-,5"})
    EXPECT_EQ(refusal(text), std::string("found \"") + text + "\", expected a number");
  std::string many = "1";  // as a hostile file may have it: refused at once
  for (int i = 0; i < 200000; ++i) many += ",1";
  EXPECT_EQ(refusal(many), "found \"" + many + "\", expected a number");
}

TEST(States, ARangeHoldsItsEnds) {
  const StatesAsked asked = parse_states("0.1:0.3");
  EXPECT_TRUE(asks_for(asked, 6 * 0.05));  // 0.30000000000000004
  EXPECT_TRUE(asks_for(asked, 0.1));
  EXPECT_FALSE(asks_for(asked, 0.31));
}

TEST(States, WithoutStepsThereIsOneAndNoOther) {
  Settings settings;
  settings.skip_steps = true;
  for (const char* asked : {"all", "last", "1", "0.5:1"})
    EXPECT_EQ(row_states(slanted(), settings, parse_states(asked), "--states").times.size(), 1u) << asked;
  try {
    row_states(slanted(), settings, parse_states("0.5"), "--states 0.5");
    ADD_FAILURE();
  } catch (const UsageError& e) {
    EXPECT_STREQ(
        e.what(),
        "--states 0.5: without the model's steps its end, time 1, is the only state: expected all, last or that "
        "time");
  }
  EXPECT_THROW(row_states(slanted(), settings, parse_states("0:0.5"), "--states 0:0.5"), UsageError);
}

// Of a table only what is asked for is solved, after the ends of the model's steps.
TEST(States, OfRowsSolveNoOthers) {
  const JointModel model = slanted();
  const Settings settings = rows(std::vector<Vector6>(20, six({0, 0, 800})));
  const States last = row_states(model, settings, parse_states("last"), "--states");
  ASSERT_EQ(last.times.size(), 2u);  // the end of the only step, the row
  EXPECT_EQ(last.times.back().row, 19);
  EXPECT_EQ(last.wanted, (std::vector<char>{0, 1}));
  EXPECT_EQ(row_states(model, settings, parse_states("0.2:0.4"), "--states").times.size(), 1u + 3u);
  EXPECT_THROW(row_states(model, settings, parse_states("7"), "--states"), UsageError);
}

}  // namespace dea::placing_test

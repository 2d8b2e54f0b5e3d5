// Fixed nodes of a bone that is taken as rigid, where they leave it a hinge, a pin or a guided end: answers on paper.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "src/base/rotations.h"
#include "src/equilibrium/connectors.h"
#include "src/equilibrium/spring_beds.h"
#include "src/run/analysis.h"
#include "tests/src/test_models.h"

namespace dea::held_points_test {

constexpr int kPlate = 2;
constexpr double kSize = 10.0, kLayer = 2.0, kHalf = 6.0;  // the plate reaches beyond the layer on all sides

/// A plate of deformable shells at z = gap over a layer with z in -2 .. 0, pushed with `push` at each of its nodes.
JointModel plate_over_layer(const Vector3d& push, double gap = 0.0) {
  JointModel model = test::flat_plates(6, kSize, kLayer, gap, 2 * kHalf);
  model.materials[kPlate].rigid = false;
  model.materials[kPlate].center_of_mass = Vector3d(0, 0, gap);
  NodalForce force;
  force.nodes = model.domains.back().nodes;
  std::sort(force.nodes.begin(), force.nodes.end());
  force.nodes.erase(std::unique(force.nodes.begin(), force.nodes.end()), force.nodes.end());
  force.value = push;
  force.controller = 0;
  model.nodal_forces.push_back(force);
  return model;
}

/// Holds the plate's nodes of which `where` is true.
template <class Where>
void hold(JointModel& model, std::array<bool, 3> xyz, Where where) {
  FixedNodes f;
  f.name = "held";
  f.xyz = xyz;
  for (const int node : model.nodal_forces.front().nodes)
    if (where(model.nodes[at(node)])) f.nodes.push_back(node);
  ASSERT_FALSE(f.nodes.empty());
  model.fixed_nodes.push_back(f);
}
constexpr std::array<bool, 3> kAll = {true, true, true};
bool at_edge(const Vector3d& x) { return x.x() < 1e-9 - kHalf; }
bool at_corner(const Vector3d& x) { return at_edge(x) && x.y() < 1e-9 - kHalf; }

Settings plate_as_rigid() {
  Settings settings = test::linear();
  settings.rigid = {"plate"};
  return settings;
}

/// The end of a run, and what its springs see.
struct Solved {
  Analysis analysis;
  const Equilibrium& end() const { return analysis.states.back().equilibrium; }
  const Pose& plate() const { return end().poses[1]; }
  /// Sum of area times f(foot) over the springs that press.
  template <class F>
  double sum(F f) const {
    const SpringBed& bed = analysis.beds.beds[0];
    const SpringStates s = press_springs(bed, end().poses[at(bed.source_body)], end().poses[at(bed.target_body)]);
    double total = 0.0;
    for (std::size_t i = 0; i < s.area.size(); ++i)
      if (s.pressure[i] > 0) total += s.area[i] * f(s.foot[i]);
    return total;
  }
};
Solved solved_plate(const JointModel& model) {
  Solved result{analyse(model, plate_as_rigid())};
  EXPECT_EQ(result.end().outcome, Outcome::Balanced) << result.end().message;
  return result;
}

/// Where the plate's nodes are that are held, less where they were: only in the held components.
double largest_shift(const JointModel& model, const Solved& solved) {
  const Vector3d center = solved.analysis.joint.bodies[1].center_of_mass;
  double largest = 0.0;
  for (const FixedNodes& f : model.fixed_nodes)
    for (const int node : f.nodes) {
      const Vector3d& x = model.nodes[at(node)];
      const Vector3d shift = solved.plate().center + solved.plate().rotation * (x - center) - x;
      for (int k = 0; k < 3; ++k)
        if (f.xyz[at(k)]) largest = std::max(largest, std::abs(shift[k]));
    }
  return largest;
}

/// Pressure per overlap of the linear law (S3).
double bed_stiffness() { return confined_modulus(test::kE, test::kNu) / kLayer; }

Vector3d turn_of(const Solved& solved) { return rotation_vector(solved.plate().rotation); }

// A hinge along y at x = -6: the plate is at z = -(x + 6) tan t over the layer, and the moment of the springs about the
// hinge is  M/h tan t sum(a (x + 6)^2),  that of the nodes' loads  sum(F (x + 6)) cos t.
TEST(HeldPoints, AHingeTurnsUntilMomentsAboutItBalance) {
  JointModel model = plate_over_layer({0, 0, -1});
  hold(model, kAll, at_edge);
  const Solved solved = solved_plate(model);
  const double bed = bed_stiffness() * solved.sum([](const Vector3d& x) { return std::pow(x.x() + kHalf, 2); });
  double load = 0.0;
  for (const int node : model.nodal_forces[0].nodes) load += model.nodes[at(node)].x() + kHalf;
  const Vector3d turn = turn_of(solved);
  EXPECT_NEAR(std::tan(turn.y()) / std::cos(turn.y()) * bed / load, 1.0, 1e-8);
  EXPECT_NEAR(turn.x(), 0, 1e-12);
  EXPECT_NEAR(turn.z(), 0, 1e-12);
  EXPECT_LT(largest_shift(model, solved), 1e-9);
  // as of held dofs: what holds and loads the body is the opposite of what the contact does to it
  EXPECT_NEAR((solved.end().reaction[1] + solved.end().contact_on_target[0]).norm(), 0, 1e-9);
  EXPECT_LT(solved.end().residual_force, 1e-8 * solved.end().load);
}

// Three nodes on the hinge, or two of them at its ends, or these with the middle held once more: the same hinge.
TEST(HeldPoints, RedundantNodesOfAHingeChangeNothing) {
  JointModel ends = plate_over_layer({0, 0, -1}), edge = ends;
  hold(ends, kAll, [](const Vector3d& x) { return at_edge(x) && std::abs(x.y()) > kHalf - 1e-9; });
  hold(edge, kAll, at_edge);
  JointModel rounded = edge;  // to the digits of a file: a line that is none to the last digit
  for (const int node : rounded.fixed_nodes[0].nodes) rounded.nodes[at(node)].z() += 1e-6 * (node % 3 - 1);
  const Vector3d turn = turn_of(solved_plate(ends));
  EXPECT_LT((turn_of(solved_plate(edge)) - turn).norm(), 1e-9 * turn.norm());
  EXPECT_LT((turn_of(solved_plate(rounded)) - turn).norm(), 1e-3 * turn.norm());
}

// A line of fixed nodes through the centre of mass is a hinge with or without the node at the centre itself, and the
// hinge holds dofs alone: whatever rounding makes of that node's arm.
TEST(HeldPoints, ANodeAtTheCentreOfMassCouplesNothing) {
  JointModel model = plate_over_layer({0, 0, -1});
  model.materials[kPlate].center_of_mass = Vector3d(1e-16, -1e-16, 1e-16);
  hold(model, kAll, [](const Vector3d& x) { return std::abs(x.y()) < 1e-9; });
  const Joint joint = make_joint(model, plate_as_rigid());
  EXPECT_TRUE(joint.conditions.steps[0][1].coupled.empty());
  for (int k = 0; k < kDofs; ++k)
    EXPECT_EQ(joint.conditions.steps[0][1].dofs[at(k)].state, k == 3 ? DofState::Free : DofState::Held);
}

// A pin at a corner leaves three rotations. With d = x - pin and small turns the plate sinks by d_x t_y - d_y t_x, so
//   M/h sum(a [d_y^2, -d_x d_y; -d_x d_y, d_x^2]) (t_x, t_y) = F sum(-d_y, d_x),
// and by symmetry t_x = -t_y. Nothing resists a spin about the normal.
TEST(HeldPoints, APinTurnsAboutItsNodeAlone) {
  JointModel model = plate_over_layer({0, 0, -0.01});
  hold(model, kAll, at_corner);
  const Solved solved = solved_plate(model);
  const double k = bed_stiffness();
  Eigen::Matrix2d K;
  const auto dx = [](const Vector3d& x) { return x.x() + kHalf; };
  const auto dy = [](const Vector3d& x) { return x.y() + kHalf; };
  K(0, 0) = k * solved.sum([&](const Vector3d& x) { return dy(x) * dy(x); });
  K(1, 1) = k * solved.sum([&](const Vector3d& x) { return dx(x) * dx(x); });
  K(0, 1) = K(1, 0) = -k * solved.sum([&](const Vector3d& x) { return dx(x) * dy(x); });
  Eigen::Vector2d load(0, 0);
  for (const int node : model.nodal_forces[0].nodes)
    load += 0.01 * Eigen::Vector2d(-dy(model.nodes[at(node)]), dx(model.nodes[at(node)]));
  const Eigen::Vector2d expected = K.inverse() * load;
  const Vector3d turn = turn_of(solved);
  EXPECT_LT((turn.head<2>() - expected).norm(), 1e-4 * expected.norm());  // of the turns' squares
  EXPECT_NEAR(turn.x() / turn.y(), -1.0, 1e-6);
  EXPECT_LT(largest_shift(model, solved), 1e-9);
}

// Guided along x by a row of nodes held in y and z, with a spring of stiffness k that pulls back: the row slides by
// F/k, and the plate turns about it until the moments about x balance. The centre of mass lies 5 above the row.
TEST(HeldPoints, AGuidedEndSlidesAndTurns) {
  JointModel model = plate_over_layer({0.02, 0, -1});
  model.materials[kPlate].center_of_mass = Vector3d(0, 0, 5);
  hold(model, {false, true, true}, [](const Vector3d& x) { return x.y() < 1e-9 - kHalf; });
  const int pot = test::add_material(model, "post", true);
  model.materials[at(pot)].center_of_mass = Vector3d(-50, -kHalf, 0);
  test::fix(model, pot, {true, true, true, true, true, true});
  test::add_rigid_spring(model, pot, {-46, -kHalf, 0}, kPlate, {-kHalf, -kHalf, 0}, 4.0);
  const Solved solved = solved_plate(model);
  const auto lever = [](const Vector3d& x) { return x.y() + kHalf; };
  double load = 0.0, nodes = 0.0;
  for (const int node : model.nodal_forces[0].nodes) {
    load += lever(model.nodes[at(node)]);
    ++nodes;
  }
  const double bed = bed_stiffness() * solved.sum([&](const Vector3d& x) { return lever(x) * lever(x); });
  const Vector3d turn = turn_of(solved), arm(-kHalf, -kHalf, -5);
  EXPECT_NEAR(-std::tan(turn.x()) / std::cos(turn.x()) * bed / load, 1.0, 1e-8);
  EXPECT_NEAR((solved.plate().center + solved.plate().rotation * arm).x() + kHalf, nodes * 0.02 / 4.0, 1e-9);
  EXPECT_LT(largest_shift(model, solved), 1e-9);
}

/// A plate that falls from 6 above the layer, hinged or pinned at x = -6: it turns by 30 degrees and more until it
/// touches.
JointModel falling_plate(bool pin) {
  JointModel model = plate_over_layer({0, 0, -0.1}, 6.0);
  if (pin)
    hold(model, kAll, at_corner);
  else
    hold(model, kAll, at_edge);
  return model;
}

TEST(HeldPoints, HeldNodesStayAtTheirPlaceAtLargeRotations) {
  for (const bool pin : {false, true}) {
    const JointModel model = falling_plate(pin);
    const Solved solved = solved_plate(model);
    EXPECT_GT(turn_of(solved).norm(), (pin ? 15 : 30) * kPi / 180);
    EXPECT_LT(largest_shift(model, solved), 1e-9);
  }
}

/// The model with its x axis along y, y along z, z along x.
JointModel turned(JointModel model) {
  const auto turn = [](Vector3d& v) { v = Vector3d(v.z(), v.x(), v.y()); };
  for (Vector3d& x : model.nodes) turn(x);
  for (Material& m : model.materials)
    if (m.center_of_mass) turn(*m.center_of_mass);
  for (NodalForce& f : model.nodal_forces) turn(f.value);
  for (FixedNodes& f : model.fixed_nodes) f.xyz = {f.xyz[2], f.xyz[0], f.xyz[1]};
  return model;
}

TEST(HeldPoints, AModelThatIsTurnedGivesTheTurnedPose) {
  JointModel hinge = plate_over_layer({0, 0, -1});
  hold(hinge, kAll, at_edge);
  Eigen::Matrix3d axes;
  axes << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  for (const JointModel& model : {hinge, falling_plate(false)}) {
    const Solved a = solved_plate(model), b = solved_plate(turned(model));
    EXPECT_LT((b.plate().rotation - axes * a.plate().rotation * axes.transpose()).norm(), 1e-9);
    EXPECT_LT((b.plate().center - axes * a.plate().center).norm(), 1e-8);
    EXPECT_NEAR((b.end().reaction[1].head<3>() - axes * a.end().reaction[1].head<3>()).norm(), 0, 1e-6);
  }
}

/// One body, with points held in the components at the arms, turned and moved from where they hold.
struct Moved {
  Joint joint;
  LoadCase load_case;
  std::vector<Pose> poses;
  Moved() {
    joint.bodies.resize(1);
    load_case.bodies.resize(1);
    poses.resize(1);
    poses[0].center = Vector3d(0.3, -0.2, 0.7);
    poses[0].rotation = rotation({0.4, -0.9, 0.5});
    for (int k = 0; k < 3; ++k) {
      load_case.bodies[0].held_points.push_back({k, {1.0 + k, -2, 0.5}, 0.1});
      load_case.bodies[0].held_points.push_back({k, {-3, 1, 2.0 - k}, -0.4});
    }
  }
};

// A gap less its linear part falls with the square of the motion: halved, to a quarter.
TEST(HeldPoints, GapsAreLinearToSecondOrder) {
  const Moved moved;
  const auto rows = connector_rows(moved.joint, moved.load_case, moved.poses);
  ASSERT_EQ(rows.size(), 6u);
  Vector6 way;
  way << 0.3, -0.5, 0.2, 0.6, 0.4, -0.7;
  const auto left = [&](double size, std::size_t row) {
    std::vector<Pose> poses = moved.poses;
    move_bodies(poses, size * way);
    return connector_rows(moved.joint, moved.load_case, poses)[row].gap - rows[row].gap -
           size * way.dot(rows[row].wrench.tail<6>());
  };
  for (std::size_t row = 0; row < rows.size(); ++row) EXPECT_NEAR(left(1e-3, row) / left(5e-4, row), 4.0, 0.01);
}

// The derivative of the reactions at constant multipliers meets central differences.
TEST(HeldPoints, ReactionsMeetFiniteDifferences) {
  const Moved moved;
  Eigen::VectorXd multipliers(6);
  multipliers << 1, -2, 0.5, 3, 0.7, -1;
  const auto reactions = [&](const std::vector<Pose>& poses) {
    BodyForces forces(1);
    add_hold_reactions(moved.joint, connector_rows(moved.joint, moved.load_case, poses), multipliers, forces);
    return forces;
  };
  const Eigen::MatrixXd derivative = reactions(moved.poses).derivative.dense(1);
  constexpr double d = 1e-5;
  for (int k = 0; k < kDofs; ++k) {
    std::vector<Pose> up = moved.poses, down = moved.poses;
    move_bodies(up, d * Vector6::Unit(k));
    move_bodies(down, -d * Vector6::Unit(k));
    EXPECT_LT(((reactions(up).value - reactions(down).value) / (2 * d) - derivative.col(k)).norm(), 1e-8);
  }
}

// Held in a step of its own: the bone is pushed down freely first, and goes back to the hinge then.
TEST(HeldPoints, NodesThatAreFixedLaterGoBackToTheReference) {
  JointModel model = plate_over_layer({0, 0, -1});
  hold(model, kAll, at_edge);
  model.steps.push_back(model.steps[0]);
  model.controllers[0].points = {{0, 0}, {1, 1}, {2, 1}};
  model.fixed_nodes[0].step = 1;
  const Solved solved = solved_plate(model);
  JointModel at_once = plate_over_layer({0, 0, -1});
  hold(at_once, kAll, at_edge);
  EXPECT_LT(largest_shift(model, solved), 1e-9);
  EXPECT_NEAR(turn_of(solved).y() / turn_of(solved_plate(at_once)).y(), 1.0, 1e-6);
}

// What the user says of the body's dofs counts in place of the nodes.
TEST(HeldPoints, SettingsTakeTheirPlace) {
  JointModel model = plate_over_layer({0, 0, -1});
  hold(model, kAll, at_edge);
  Settings settings = plate_as_rigid();
  settings.free["plate"] = {false, false, true, false, false, false};
  const Joint joint = make_joint(model, settings);
  const LoadCase c = make_load_case(model, joint, settings, 0, 1.0);
  EXPECT_TRUE(c.bodies[1].held_points.empty());
  EXPECT_EQ(c.bodies[1].dofs[2], DofState::Free);
  EXPECT_EQ(c.bodies[1].dofs[4], DofState::Held);
  EXPECT_FALSE(make_load_case(model, joint, plate_as_rigid(), 0, 1.0).bodies[1].held_points.empty());
}

}  // namespace dea::held_points_test

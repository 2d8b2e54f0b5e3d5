// Ligaments, cables, loads at points and joints: derivatives, and equilibria with answers on paper.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

#include "src/base/error.h"
#include "src/equilibrium/body_forces.h"
#include "src/equilibrium/connectors.h"
#include "src/equilibrium/singular_parts.h"
#include "src/joint/placing.h"
#include "src/run/analysis.h"
#include "tests/src/test_models.h"

namespace dea::connections_test {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Motion = RigidJoint::Motion;

// ---- derivatives against finite differences -------------------------------------------------------------------------

/// Three bodies and the ground in poses that nothing makes special.
struct Scene {
  Joint joint;
  std::vector<Pose> poses;
  LoadCase load_case;
  Scene() {
    for (int b = 0; b < 4; ++b) {
      Body body;
      body.name = b < 3 ? "body" : "ground";
      body.ground = b == 3;
      body.center_of_mass = b < 3 ? Vector3d(10.0 * b, 3.0 - b, 2.0 * b * b) : Vector3d::Zero();
      joint.bodies.push_back(body);
      Pose pose;
      pose.center = body.center_of_mass;
      if (b < 3) {
        pose.center += Vector3d(0.7 - b, 0.3 * b, 0.5);
        pose.rotation = Eigen::AngleAxisd(0.3 + 0.2 * b, Vector3d(1, 2 - b, -1 + b).normalized()).toRotationMatrix();
      }
      poses.push_back(pose);
    }
    load_case.start = reference_poses(joint);
    load_case.bodies.resize(4);
    load_case.bodies[3].dofs.fill(DofState::Held);
  }
  void connect(std::array<Motion, 6> motion, std::array<double, 6> value) {
    Connector c;
    c.name = "joint";
    c.body_a = 0;
    c.body_b = 1;
    c.joint_origin = {4, 5, -2};
    c.axes = Eigen::AngleAxisd(0.8, Vector3d(1, -1, 2).normalized()).toRotationMatrix();
    c.motion = motion;
    joint.connectors.push_back(c);
    load_case.connector_active.push_back(1);
    load_case.connector_value.push_back(value);
  }
};

/// Central differences of forces(poses) by small motions of the bodies.
template <class Forces>
MatrixXd differences(const std::vector<Pose>& poses, const Forces& forces) {
  const auto n = 6 * static_cast<Eigen::Index>(poses.size());
  MatrixXd D(n, n);
  const double h = 1e-5;
  for (Eigen::Index j = 0; j < n; ++j) {
    std::vector<Pose> plus = poses, minus = poses;
    move_bodies(plus, h * VectorXd::Unit(n, j));
    move_bodies(minus, -h * VectorXd::Unit(n, j));
    D.col(j) = (forces(plus) - forces(minus)) / (2 * h);
  }
  return D;
}

template <class Add>
void expect_derivative(const Scene& scene, const Add& add, const char* what) {
  BodyForces forces(scene.poses.size());
  add(scene.poses, forces);
  const MatrixXd exact = forces.derivative.dense(4);
  const MatrixXd measured = differences(scene.poses, [&](const std::vector<Pose>& poses) {
    BodyForces f(poses.size());
    add(poses, f);
    return f.value;
  });
  // (1e-5)^2 of the third derivative, and rounding 1e-16 / 1e-5 of forces of 100 with arms of 10
  EXPECT_LT((exact - measured).norm(), 1e-7 * (1 + measured.norm())) << what << "\n" << exact - measured;
  EXPECT_GT(measured.norm(), 0.1) << what;
}

LoadController curve(std::vector<std::array<double, 2>> points,
                     LoadController::Interpolate interpolate = LoadController::Interpolate::Linear) {
  LoadController c;
  c.points = std::move(points);
  c.interpolate = interpolate;
  c.extend = LoadController::Extend::Extrapolate;
  return c;
}

Ligament between(int a, int b) {
  Ligament l;
  l.name = "ligament";
  l.body_a = a;
  l.body_b = b;
  l.point_a = {3, 1, 1};
  l.point_b = {12, 6, -3};
  l.free_length = 9.0;
  return l;
}

TEST(BodyForces, LigamentsMeetFiniteDifferences) {
  const Scene scene;
  std::vector<Ligament> ligaments;
  Ligament l = between(0, 1);
  l.stiffness = 7;
  ligaments.push_back(l);
  l.tension_only = true;
  l.free_length = 5;
  ligaments.push_back(l);
  l = between(2, 3);
  l.law = Ligament::Law::Curve;
  for (const auto measure :
       {DiscreteSprings::Measure::Elongation, DiscreteSprings::Measure::Strain, DiscreteSprings::Measure::Stretch}) {
    l.measure = measure;
    l.curve = curve({{-2, 1}, {0.5, 3}, {30, 40}});
    ligaments.push_back(l);
    l.curve = curve({{-3, 1}, {0.2, 3}, {9, 50}, {40, 90}}, LoadController::Interpolate::Smooth);
    ligaments.push_back(l);
  }
  l = between(1, 2);
  l.law = Ligament::Law::Constant;
  ligaments.push_back(l);
  for (const Ligament& one : ligaments) {
    expect_derivative(
        scene,
        [&](const std::vector<Pose>& poses, BodyForces& f) {
          const double tension = add_ligament(scene.joint, one, 13.0, poses, f);
          EXPECT_NE(tension, 0.0);
        },
        one.name.c_str());
  }
}

// A tension that depends on the length alone has a potential: its derivative is symmetric, in the sense of moments
// about moving centres, when the forces' own moment is taken off. Total force and moment of any element are zero.
TEST(BodyForces, LigamentsAndCablesPullWithoutNetForce) {
  const Scene scene;
  BodyForces f(4);
  add_ligament(scene.joint, between(0, 2), 1.0, scene.poses, f);
  Cable cable;
  cable.points = {{0, {1, 2, 3}}, {1, {9, 4, 4}}, {1, {11, 4, 5}}, {2, {20, 0, 7}}};
  add_cable(scene.joint, cable, 55.0, scene.poses, f);
  Vector3d force = Vector3d::Zero(), moment = Vector3d::Zero();
  for (int b = 0; b < 4; ++b) {
    force += f.value.segment<3>(6 * b);
    moment += f.value.segment<3>(6 * b + 3) +
              scene.poses[static_cast<std::size_t>(b)].center.cross(Vector3d(f.value.segment<3>(6 * b)));
  }
  EXPECT_LT(force.norm(), 1e-12);
  EXPECT_LT(moment.norm(), 1e-10);
}

TEST(BodyForces, CablesAndLoadsMeetFiniteDifferences) {
  const Scene scene;
  Cable cable;
  cable.points = {{0, {1, 2, 3}}, {1, {9, 4, 4}}, {1, {11, 4, 5}}, {2, {20, 0, 7}}};
  cable.direction = Vector3d(0, 3, 4) / 5;
  expect_derivative(
      scene, [&](const std::vector<Pose>& poses, BodyForces& f) { add_cable(scene.joint, cable, 55.0, poses, f); },
      "cable");
  BodyConditions c;
  c.dead << 3, -4, 5, 6, 7, 8;
  c.follower << -1, 2, 9, 4, 4, -2;
  c.arm = {1, -2, 6};
  c.point_forces = {{{3, 4, -5}, {10, 20, 30}, true}, {{-3, 1, 5}, {7, -20, 3}, false}};
  expect_derivative(
      scene, [&](const std::vector<Pose>& poses, BodyForces& f) { add_loads(c, 1, poses[1], 1.0, f); }, "loads");
}

// At the last point the cable's end pulls along the direction; at the one between both neighbours pull.
TEST(BodyForces, CablePullsAtEveryPoint) {
  Scene scene;
  for (std::size_t b = 0; b < 4; ++b) scene.poses[b] = {scene.joint.bodies[b].center_of_mass, Matrix3d::Identity()};
  Cable cable;
  cable.points = {{0, {0, 0, 0}}, {1, {3, 4, 0}}, {2, {3, 4, 7}}};
  cable.direction = {1, 0, 0};
  BodyForces f(4);
  add_cable(scene.joint, cable, 10.0, scene.poses, f);
  EXPECT_LT((f.value.segment<3>(0) - Vector3d(6, 8, 0)).norm(), 1e-12);
  EXPECT_LT((f.value.segment<3>(6) - Vector3d(-6, -8, 10)).norm(), 1e-12);
  EXPECT_LT((f.value.segment<3>(12) - Vector3d(10, 0, -10)).norm(), 1e-12);
}

TEST(BodyForces, SlopeOfACurveThatBendsOrJumps) {
  Ligament l = between(0, 1);
  l.law = Ligament::Law::Curve;
  l.curve = curve({{-1, 0}, {0, 0}, {1, 30}});
  EXPECT_NEAR(tension(l, 9.0 + 0.5, 2.0).force, 30.0, 1e-12);
  EXPECT_NEAR(tension(l, 9.0 + 0.5, 2.0).slope, 60.0, 1e-4);
  EXPECT_NEAR(tension(l, 9.0 - 0.5, 2.0).slope, 0.0, 1e-6);
  EXPECT_NEAR(tension(l, 9.0, 2.0).slope, 30.0, 1e-4);  // at the kink: between 0 and 60
  l.curve = curve({{-1, 5}, {0, 5}, {0, 25}, {1, 45}});
  for (double x : {-1e-9, 0.0, 1e-9, 1e-7}) {
    const double slope = tension(l, 9.0 + x, 1.0).slope;
    EXPECT_GE(slope, -1e-3) << x;
    EXPECT_LE(slope, 20.0 + 1e-3) << x << ": a jump is no stiffness";
  }
}

/// A plate 5 above a layer, free along z, on a spring from a node of the base to the node of the plate above it.
JointModel plate_on_expression(const std::string& expression, double load) {
  JointModel model = test::flat_plates(1, 10.0, 2.0, 5.0);
  test::fix(model, 2, {true, true, false, true, true, true});
  test::force(model, 2, {0, 0, load});
  DiscreteSet set;
  set.name = "spring";
  for (std::size_t a = 0; a < model.nodes.size() && set.pairs.empty(); ++a)
    for (std::size_t b = 0; b < model.nodes.size(); ++b)
      if ((model.nodes[b] - model.nodes[a] - Vector3d(0, 0, 7)).norm() < 1e-12)
        set.pairs.push_back({static_cast<int>(a), static_cast<int>(b)});
  EXPECT_EQ(set.pairs.size(), 1u);
  model.discrete_sets.push_back(set);
  DiscreteSprings springs;
  springs.set = 0;
  springs.name = "log";
  springs.force.emplace().expression = expression;
  springs.force->variable = "x";
  springs.origin = {0, 12};
  model.discrete_springs.push_back(springs);
  return model;
}

// T = k ln(1 + x/d) carries -F at x = d (exp(-F/k) - 1). Newton's first step, -F d/k = -2d, goes where T has no value.
TEST(Ligaments, StepsKeepToWhereAnExpressionHasAValue) {
  const StateResult state = analyse(plate_on_expression("30*ln(1+x/0.1)", -60), test::linear()).states.back();
  EXPECT_EQ(state.equilibrium.outcome, Outcome::Balanced) << state.equilibrium.message;
  EXPECT_NEAR(state.equilibrium.poses[1].center.z(), 0.1 * (std::exp(-2.0) - 1), 1e-9);
  EXPECT_NEAR(state.equilibrium.ligament_force[0], -60, 1e-6);
}

TEST(Ligaments, ExpressionWithoutAValueAtTheStartIsNamed) {
  try {
    analyse(plate_on_expression("30*ln(x)", -60), test::linear());
    FAIL() << "taken";
  } catch (const InputError& error) {
    EXPECT_STREQ(
        error.what(),
        "test.feb:12: spring \"log\" at time 0: its force \"30*ln(x)\" has no finite value at x = 0 (length 7, "
        "free length 7); write it for every length, such as with max(x, 0)");
  }
}

// ---- connectors -----------------------------------------------------------------------------------------------------

const std::array<Motion, 6> kHeld = {};
std::array<Motion, 6> held_but(std::initializer_list<int> free) {
  std::array<Motion, 6> m = kHeld;
  for (int k : free) m[static_cast<std::size_t>(k)] = Motion::Free;
  return m;
}

const std::array<Motion, 6> kKinds[] = {
    kHeld,                                                                                            // lock
    held_but({3, 4, 5}),                                                                              // spherical
    held_but({3}),                                                                                    // revolute
    held_but({0}),                                                                                    // prismatic
    held_but({0, 3}),                                                                                 // cylindrical
    held_but({1, 2, 3}),                                                                              // planar
    held_but({1, 4, 5}),                                                                              // generic
    {Motion::Prescribed, Motion::Free, Motion::Held, Motion::Prescribed, Motion::Held, Motion::Held}  // driven
};

// (J3): the wrench is the gap's derivative wherever the gap is zero, and (J4) the wrenches' own derivative.
TEST(Connectors, DerivativesMeetFiniteDifferences) {
  for (const auto& kind : kKinds) {
    Scene scene;
    scene.connect(kind, {0.4, 0, 0, 0.3, 0, 0});
    const auto free = [] {
      std::vector<int> all;
      for (int dof = 0; dof < 18; ++dof) all.push_back(dof);
      return all;
    }();
    const ConnectorGroups groups = make_groups(scene.joint, scene.load_case, free, 5.0, 20.0, scene.poses);
    ASSERT_TRUE(close_connectors(scene.joint, scene.load_case, groups, scene.poses));
    const auto rows = connector_rows(scene.joint, scene.load_case, scene.poses);
    ASSERT_EQ(static_cast<std::ptrdiff_t>(rows.size()), 6 - std::count(kind.begin(), kind.end(), Motion::Free));
    MatrixXd gaps(rows.size(), 12);
    const double h = 1e-6;
    for (int j = 0; j < 12; ++j) {
      std::vector<Pose> plus = scene.poses, minus = scene.poses;
      move_bodies(plus, h * VectorXd::Unit(24, j));
      move_bodies(minus, -h * VectorXd::Unit(24, j));
      const auto p = connector_rows(scene.joint, scene.load_case, plus),
                 m = connector_rows(scene.joint, scene.load_case, minus);
      for (std::size_t i = 0; i < rows.size(); ++i)
        gaps(static_cast<Eigen::Index>(i), j) = (p[i].gap - m[i].gap) / (2 * h);
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
      EXPECT_LT(std::abs(rows[i].gap), 1e-10);
      EXPECT_LT((gaps.row(static_cast<Eigen::Index>(i)).transpose() - rows[i].wrench).norm(), 1e-7) << rows[i].dof;
    }
    VectorXd multipliers(rows.size());
    for (Eigen::Index i = 0; i < multipliers.size(); ++i) multipliers[i] = 3.0 + 2.0 * static_cast<double>(i);
    expect_derivative(
        scene,
        [&](const std::vector<Pose>& poses, BodyForces& f) {
          add_reactions(scene.joint, connector_rows(scene.joint, scene.load_case, poses), multipliers, poses, f);
        },
        "reactions");
    if (std::count(kind.begin(), kind.end(), Motion::Free) > 0) {
      Scene loaded = scene;
      loaded.load_case.connector_value[0] = {5, -6, 7, 8, 9, -4};
      expect_derivative(
          loaded,
          [&](const std::vector<Pose>& poses, BodyForces& f) {
            add_connector_loads(loaded.joint, loaded.load_case, 1.0, poses, f);
          },
          "loads along free motions");
    }
  }
}

// ---- joints in equilibrium ------------------------------------------------------------------------------------------

constexpr double kSize = 10, kThick = 2;
double bed_stiffness() { return confined_modulus(test::kE, test::kNu) * kSize * kSize / kThick; }

/// Material `name`, a small rigid plate far from any contact, with its centre of mass.
int add_bone(JointModel& model, const std::string& name, const Vector3d& center) {
  const int m = test::add_material(model, name, true);
  model.materials[static_cast<std::size_t>(m)].center_of_mass = center;
  test::add_rigid_surface(
      model, name, 1, 1,
      [&](double u, double v) { return Vector3d(center + Vector3d(u, v, 500.0 + static_cast<double>(m))); }, m);
  return m;
}

RigidJoint& join(JointModel& model, int a, int b, const Vector3d& at, std::array<Motion, 6> motion,
                 const Matrix3d& axes = Matrix3d::Identity()) {
  RigidJoint j;
  j.name = "joint " + std::to_string(model.rigid_joints.size() + 1);
  j.type = "rigid joint of this test";
  j.material_a = a;
  j.material_b = b;
  j.joint_origin = at;
  j.axes = axes;
  j.motion = motion;
  model.rigid_joints.push_back(j);
  return model.rigid_joints.back();
}

StateResult last_state(const JointModel& model, const Settings& settings = test::linear()) {
  return analyse(model, settings).states.back();
}

/// Forces on every body that can move: contact, ligaments, joints and loads, by what is reported.
void expect_balanced(const StateResult& state, double load, double tolerance = 1e-7) {
  EXPECT_EQ(state.equilibrium.outcome, Outcome::Balanced) << state.equilibrium.message;
  if (std::isfinite(state.equilibrium.residual_force)) {
    EXPECT_LT(state.equilibrium.residual_force, tolerance * load);
  }
}

// A plate hinged beside the layer: (M/h) theta times the second moment about the hinge carries the load's moment.
TEST(Joints, RevoluteLever) {
  JointModel model = test::flat_plates(20, kSize, kThick, 0.0);
  const double arm = 20, F = 40;
  join(model, 1, 2, {-arm, 0, 0}, held_but({4}));  // about y
  test::force(model, 2, {0, 0, -F});
  const StateResult state = last_state(model);
  expect_balanced(state, F);
  const double second = bed_stiffness() * (arm * arm + kSize * kSize / 12);
  const double theta = F * arm / second;  // small: 2e-4
  const Vector6& motion = state.equilibrium.connector_motion[0];
  EXPECT_LT(motion.head<3>().norm(), 1e-10);
  EXPECT_NEAR(motion[4], theta, 1e-3 * theta);
  EXPECT_NEAR(std::hypot(motion[3], motion[5]), 0, 1e-12);
  const double carried = bed_stiffness() * theta * arm;
  EXPECT_NEAR(state.equilibrium.connector_force[0][2], F - carried, 1e-3 * F);
  EXPECT_NEAR(state.equilibrium.connector_force[0][4], 0, 1e-8) << "no moment about the free axis";
  EXPECT_NEAR(state.equilibrium.reaction[1].norm(), F, 1e-6) << "what holds the plate is the load alone";
}

// The hinge turned by a given angle: its moment is that of the bed under the tilted plate.
TEST(Joints, RevoluteDriven) {
  JointModel model = test::flat_plates(20, kSize, kThick, 0.0);
  const double arm = 20, theta = 1e-3;
  RigidJoint& j = join(model, 1, 2, {-arm, 0, 0}, held_but({}));
  j.motion[4] = Motion::Prescribed;
  j.value[4] = {theta, 0};
  const StateResult state = last_state(model);
  EXPECT_EQ(state.equilibrium.outcome, Outcome::Balanced) << state.equilibrium.message;
  EXPECT_NEAR(state.equilibrium.connector_motion[0][4], theta, 1e-12);
  const double second = bed_stiffness() * (arm * arm + kSize * kSize / 12);
  // the bed pushes the plate up, which turns it about -y: the joint turns it about +y
  EXPECT_NEAR(state.equilibrium.connector_force[0][4], second * theta, 5e-3 * second * theta);
}

// A slide that is not free to tilt takes the whole moment of an eccentric load.
TEST(Joints, PrismaticTakesTheMoment) {
  JointModel model = test::flat_plates(6, kSize, kThick, 0.0);
  const double F = 100;
  Matrix3d axes;
  axes << 0, 1, 0, 0, 0, 1, 1, 0, 0;  // first column: z
  join(model, 1, 2, {3, 1, 0}, held_but({0}), axes);
  test::force(model, 2, {0, 0, -F});
  Settings settings = test::linear();
  settings.load_at["plate"].point = {2, 0, 5};
  const StateResult state = last_state(model, settings);
  expect_balanced(state, F);
  EXPECT_NEAR(state.equilibrium.poses[1].center.z(), -F / bed_stiffness(), 1e-9);
  // the joint's moment about its point on the plate: all moments about the centre of mass, no force in the joint
  EXPECT_LT(state.equilibrium.connector_force[0].head<3>().norm(), 1e-8);
  EXPECT_NEAR(state.equilibrium.connector_force[0][4], -2 * F, 1e-6);
}

// Load along the free axis: +value on A, -value on B, as FEBio has it.
TEST(Joints, ForceAlongTheFreeAxis) {
  JointModel model = test::flat_plates(6, kSize, kThick, 0.0);
  RigidJoint& j = join(model, 1, 2, {0, 0, 0}, held_but({2}));
  j.value[2] = {100.0, 0};
  const StateResult state = last_state(model);
  expect_balanced(state, 100);
  EXPECT_NEAR(state.equilibrium.poses[1].center.z(), -100 / bed_stiffness(), 1e-9);
  EXPECT_NEAR(state.equilibrium.connector_force[0][2], -100, 1e-9);
}

// A weight on a rod that hangs from a ball joint swings down from wherever it starts; its turn about itself is held.
TEST(Joints, SphericalPendulumHangsDown) {
  JointModel model = test::flat_plates(4, kSize, kThick, 0.0);
  test::fix(model, 2, {true, true, true, true, true, true});
  const Vector3d hook(50, 0, 100);
  const int bob = add_bone(model, "bob", hook + Vector3d(6, 3, -8));
  const double length = std::sqrt(36 + 9 + 64);
  join(model, 1, bob, hook, held_but({3, 4, 5}));
  test::force(model, bob, {0, 0, -7});
  const StateResult state = last_state(model);
  expect_balanced(state, 7);
  EXPECT_LT((state.equilibrium.poses[2].center - hook - Vector3d(0, 0, -length)).norm(), 1e-6);
  EXPECT_LT((state.equilibrium.connector_force[0].head<3>() - Vector3d(0, 0, 7)).norm(), 1e-6);
  EXPECT_EQ(state.equilibrium.held.size(), 1u);
  EXPECT_GT(state.equilibrium.least_stiffness, 0);
}

// A body hinged far to the side comes down on the surface, however high its load acts, from a gap too: a load above the
// hinge would topple it the other way, and a step to where it balances on the hinge's top leads away from the surface.
TEST(Joints, LoadAboveTheHingePressesOnTheSurface) {
  const double arm = 50, F = 40;
  for (const double height : {-5.0, 0.0, 5.0, 30.0})
    for (const double gap : {0.0, 0.05, 0.3}) {
      JointModel model = test::flat_plates(20, kSize, kThick, gap);
      model.materials[2].center_of_mass = Vector3d(5, 0, height);
      join(model, 1, 2, {-arm, 0, 2}, held_but({4}));
      test::force(model, 2, {0, 0, -F});
      const StateResult state = last_state(model);
      expect_balanced(state, F);
      EXPECT_LT(std::abs(state.equilibrium.connector_motion[0][4]), 0.02) << height << " " << gap;
      // moments about the hinge: the bed's force acts somewhere on the layer
      const double moment = F * (state.equilibrium.poses[1].center.x() + arm),
                   carried = std::abs(state.equilibrium.contact_on_target[0][2]);
      EXPECT_GT(carried, moment / (arm + kSize / 2)) << height << " " << gap;
      EXPECT_LT(carried, moment / (arm - kSize / 2)) << height << " " << gap;
      EXPECT_FALSE(state.equilibrium.unstable) << height << " " << gap;
    }
}

// One that stands on its hook has no surface to fall on: it hangs from the hook in the end, or it is told how it falls;
// on top of the hook is no balance.
TEST(Joints, APendulumOnTopOfItsHookFalls) {
  for (const double pressed : {0.0, 0.1}) {  // what touches elsewhere does not hold it
    JointModel model = test::flat_plates(4, kSize, kThick, 0.0);
    test::fix(model, 2, {true, true, false, true, true, true});
    test::prescribe(model, 2, 2, -pressed);
    const Vector3d hook(50, 0, 100);
    const int bob = add_bone(model, "bob", hook + Vector3d(6, 3, 8));
    join(model, 1, bob, hook, held_but({3, 4, 5}));
    test::force(model, bob, {0, 0, -7});
    const StateResult state = last_state(model);
    const Vector3d from_hook = state.equilibrium.poses[2].center - hook;
    SCOPED_TRACE(
        fmt::format("{} at ({}, {}, {})", state.equilibrium.message, from_hook.x(), from_hook.y(), from_hook.z()));
    if (solved(state.equilibrium.outcome)) {
      EXPECT_LT((from_hook + Vector3d(0, 0, std::sqrt(36 + 9 + 64))).norm(), 1e-6) << "hangs from it";
    } else {
      EXPECT_NE(state.equilibrium.message.find("rotation of \"bob\""), std::string::npos);
      EXPECT_LT(from_hook.z(), 8) << "downwards";
    }
  }
}

// Locked to the plate, a body that carries the load is the plate.
TEST(Joints, LockMakesOneBodyOfTwo) {
  JointModel model = test::flat_plates(6, kSize, kThick, 0.0);
  const double F = 60;
  const int handle = add_bone(model, "handle", {1, 0, 30});
  join(model, 2, handle, {0.5, 0, 15}, kHeld);
  test::force(model, handle, {0, 0, -F});
  test::fix(model, 2, {true, true, false, true, false, true});
  const StateResult state = last_state(model);
  expect_balanced(state, F);
  JointModel one = test::flat_plates(6, kSize, kThick, 0.0);
  test::fix(one, 2, {true, true, false, true, false, true});
  test::force(one, 2, {0, 0, -F});
  Settings settings = test::linear();
  settings.load_at["plate"].point = {1, 0, 30};
  const StateResult expected = last_state(one, settings);
  EXPECT_LT((state.equilibrium.poses[1].center - expected.equilibrium.poses[1].center).norm(), 1e-9);
  EXPECT_LT((state.equilibrium.poses[1].rotation - expected.equilibrium.poses[1].rotation).norm(), 1e-9);
  EXPECT_LT((state.equilibrium.poses[2].rotation - state.equilibrium.poses[1].rotation).norm(), 1e-12);
  EXPECT_LT((state.equilibrium.connector_force[0].head<3>() - Vector3d(0, 0, F)).norm(), 1e-7);
}

// A parallelogram of four hinges with parallel axes: three conditions too many. It sinks under its load against a
// spring; moments about the lower hinges give the spring's force.
TEST(Joints, LoopOfHingesHasRedundantConditions) {
  JointModel model = test::flat_plates(4, kSize, kThick, 0.0);
  test::fix(model, 2, {true, true, true, true, true, true});
  const Vector3d shift(100, 0, 0);
  const int left = add_bone(model, "left", shift + Vector3d(0, 0, 10)),
            right = add_bone(model, "right", shift + Vector3d(30, 0, 10)),
            top = add_bone(model, "top", shift + Vector3d(15, 0, 20));
  join(model, 1, left, shift, held_but({4}));
  join(model, 1, right, shift + Vector3d(30, 0, 0), held_but({4}));
  join(model, left, top, shift + Vector3d(0, 0, 20), held_but({4}));
  join(model, right, top, shift + Vector3d(30, 0, 20), held_but({4}));
  test::force(model, top, {12, 0, -5});
  test::add_rigid_spring(model, top, shift + Vector3d(0, 0, 20), 1, shift + Vector3d(-40, 0, 20), 3);
  const StateResult state = last_state(model);
  expect_balanced(state, 12);
  // the top moves along a circle of radius 20: t from upright; forces along the motion balance
  const double t = state.equilibrium.connector_motion[0][4];
  const double x = 20 * std::sin(t), z = 20 * std::cos(t), L = std::hypot(40 + x, z - 20);
  const double pull = 3 * (L - 40);
  const double fx = 12 - pull * (40 + x) / L, fz = -5 - pull * (z - 20) / L;
  EXPECT_NEAR(fx * std::cos(t) - fz * std::sin(t), 0, 1e-6);
  EXPECT_GT(t, 0.05);
  EXPECT_NEAR(state.equilibrium.connector_motion[1][4], t, 1e-9);
  EXPECT_LT((state.equilibrium.poses[static_cast<std::size_t>(top - 1)].rotation - Matrix3d::Identity()).norm(), 1e-9);
  // what the two upper hinges carry is the load and the spring's pull, whatever share is whose
  const Vector6 upper = state.equilibrium.connector_force[2] + state.equilibrium.connector_force[3];
  EXPECT_NEAR(upper[0], -fx, 1e-6);
  EXPECT_NEAR(upper[2], -fz, 1e-6);
}

// Bars of length 10 and weight W, pinned to each other and at both ends to the ground: a chain that hangs. The pull
// across it, H, is the same in every pin, the upright part falls by W from pin to pin, and moments about a bar's pin
// give its slope: tan = (V at its one end + V at its other)/2 / H.
TEST(Joints, LongChainsHang) {
  for (const int bars : {4, 12, 40}) {
    JointModel model = test::flat_plates(2, kSize, kThick, 0.0);
    test::fix(model, 2, {true, true, true, true, true, true});
    const double W = 2, length = 10;
    // from an arc of three quarters of a half circle, symmetric
    const auto slope_of = [&](int i) { return 0.75 * test::kPi / 2 * (2.0 * (i + 0.5) / bars - 1); };
    Vector3d pin(100, 0, 0);
    int before = 1;
    std::vector<int> bar;
    for (int i = 0; i < bars; ++i) {
      const Vector3d along = length * Vector3d(std::cos(slope_of(i)), 0, std::sin(slope_of(i)));
      bar.push_back(add_bone(model, "bar " + std::to_string(i + 1), pin + along / 2));
      join(model, before, bar.back(), pin, held_but({4}));
      test::force(model, bar.back(), {0, 0, -W});
      pin += along;
      before = bar.back();
    }
    join(model, before, 1, pin, held_but({4}));
    const StateResult state = last_state(model);
    expect_balanced(state, W * bars, 1e-6);
    const auto& force = state.equilibrium.connector_force;  // on the right one of each pair
    ASSERT_EQ(force.size(), static_cast<std::size_t>(bars) + 1);
    const double H = force[0][0];
    EXPECT_LT(H, 0);
    for (int i = 0; i < bars; ++i) {
      const auto k = static_cast<std::size_t>(i);
      EXPECT_NEAR(force[k][0], H, 1e-6 * W * bars) << bars << " bars, pin " << i;
      EXPECT_NEAR(force[k][2] - force[k + 1][2], W, 1e-6 * W * bars) << bars << " bars, pin " << i;
      EXPECT_NEAR(force[k][2], W * (bars / 2.0 - i), 1e-5 * W * bars) << bars << " bars, pin " << i << ": symmetric";
      const auto body = static_cast<std::size_t>(bar[k] - 1);
      const Vector3d along =
          state.equilibrium.poses[body].rotation * Vector3d(std::cos(slope_of(i)), 0, std::sin(slope_of(i)));
      EXPECT_NEAR(along.z() / along.x(), 0.5 * (force[k][2] + force[k + 1][2]) / H, 1e-5) << bars << " bars, bar " << i;
    }
  }
}

TEST(Joints, ContradictionIsAnOutcomeThatNamesTheJoint) {
  JointModel model = test::flat_plates(4, kSize, kThick, 0.1);
  const int bone = add_bone(model, "bone", {20, 0, 0});
  for (double z : {0.0, 0.5}) {
    RigidJoint& j = join(model, 1, bone, {20, 0, 0}, kHeld);
    j.motion[2] = Motion::Prescribed;
    j.value[2] = {z, 0};
  }
  test::fix(model, 2, {true, true, true, true, true, true});
  const StateResult state = last_state(model);
  EXPECT_EQ(state.equilibrium.outcome, Outcome::NoEquilibrium);
  EXPECT_NE(state.equilibrium.message.find("\"joint "), std::string::npos) << state.equilibrium.message;
  for (const Pose& pose : state.equilibrium.poses) EXPECT_TRUE(pose.center.allFinite());
}

// Two equal locks share the load evenly: multipliers of least size.
TEST(Joints, TwoLocksShareTheLoad) {
  JointModel model = test::flat_plates(4, kSize, kThick, 0.1);
  test::fix(model, 2, {true, true, true, true, true, true});
  const int bone = add_bone(model, "bone", {20, 0, 0});
  for (int i = 0; i < 2; ++i) join(model, 1, bone, {20, 0, 0}, kHeld);
  test::force(model, bone, {0, 8, -6});
  const StateResult state = last_state(model);
  EXPECT_TRUE(solved(state.equilibrium.outcome)) << state.equilibrium.message;
  for (int i = 0; i < 2; ++i)
    EXPECT_LT((state.equilibrium.connector_force[static_cast<std::size_t>(i)].head<3>() - Vector3d(0, -4, 3)).norm(),
              1e-9);
}

TEST(Joints, AxesThatAreNoFrameAreRefused) {
  JointModel model = test::flat_plates(4, kSize, kThick, 0.1);
  Matrix3d axes = Matrix3d::Identity();
  axes.col(1) = axes.col(0);
  join(model, 1, 2, {0, 0, 0}, kHeld, axes).origin = {0, 77};
  try {
    last_state(model);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("test.feb:77: joint"), std::string::npos) << e.what();
  }
}

// ---- loads ----------------------------------------------------------------------------------------------------------

TEST(Loads, NodalForcesActOnTheBodyAtTheirNodes) {
  JointModel model = test::flat_plates(6, kSize, kThick, 0.0);
  test::fix(model, 2, {true, true, false, true, false, true});
  const int first = static_cast<int>(model.nodes.size()) - 49;  // of the plate: 7 x 7
  NodalForce f;
  f.name = "push";
  f.nodes = {first, first + 6, first + 42, first + 48};  // its corners
  f.value = {0, 0, -25};
  f.controller = 0;
  model.nodal_forces.push_back(f);
  StateResult state = last_state(model);
  expect_balanced(state, 100);
  EXPECT_NEAR(state.equilibrium.poses[1].center.z(), -100 / bed_stiffness(), 1e-9);
  EXPECT_NEAR(state.equilibrium.poses[1].rotation(0, 2), 0, 1e-10);

  model.nodal_forces[0].nodes = {0};  // the base's bone: rigid, and held
  EXPECT_NO_THROW(last_state(model));
  model.nodal_forces[0].nodes = {2 * 49};  // top of the cartilage
  model.nodal_forces[0].origin = {0, 12};
  try {
    last_state(model);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("test.feb:12: nodal force \"push\" acts on node 99"), std::string::npos)
        << e.what();
  }
}

// A follower's line of action turns with the body; a dead load's does not. On a plate that has been turned by 90
// degrees about z a follower along x pulls along y.
TEST(Loads, FollowersTurnWithTheBody) {
  JointModel model = test::flat_plates(4, kSize, kThick, 1.0);
  test::fix(model, 2, {false, false, false, true, true, true});
  for (int k = 0; k < 3; ++k) test::prescribe(model, 2, 3 + k, k == 2 ? test::kPi / 2 : 0.0);
  for (int k = 0; k < 3; ++k)  // tethers to the base along each axis, far away
    test::add_rigid_spring(model, 2, Vector3d::Zero(), 1, 1e6 * Vector3d::Unit(k), 10);
  RigidFollower f;
  f.material = 2;
  f.value = {8, 0, 0};
  f.insertion = {0, 5, 0};
  f.controller = 0;
  model.rigid_followers.push_back(f);
  const StateResult state = last_state(model);
  expect_balanced(state, 8);
  EXPECT_LT((state.equilibrium.poses[1].center - Vector3d(0, 0.8, 0)).norm(), 1e-5);
  // the moment about the centre of mass: arm (-5, 0, 0), force (0, 8, 0); held, so it is in no residual
  const LoadCase c = make_load_case(model, analyse(model, test::linear()).joint, {}, 0, 1.0);
  ASSERT_EQ(c.bodies[1].point_forces.size(), 1u);
  EXPECT_TRUE(c.bodies[1].point_forces[0].turns);
}

// Step 1 presses the plate down by its motion; step 2 lets go and takes the load over: from the reaction to the target,
// linear in time.
TEST(Loads, TargetStartsFromTheReaction) {
  JointModel model = test::flat_plates(6, kSize, kThick, 0.0);
  test::fix(model, 2, {true, true, false, true, true, true});
  Step second = model.steps[0];
  second.step_size = 0.25;
  model.steps.push_back(second);
  test::prescribe(model, 2, 2, -0.1);
  model.rigid_prescribed[0].step = 0;
  RigidLoad target;
  target.material = 2;
  target.dof = 2;
  target.value = {-50, -1};
  target.kind = RigidLoad::Kind::Target;
  target.step = 1;
  model.rigid_loads.push_back(target);
  Analysis a = analyse(model, test::linear());
  const double start = -0.1 * bed_stiffness();
  for (const StateResult& s : a.states) {
    if (s.when.time <= 1.0) continue;
    const double w = s.when.time - 1.0;
    EXPECT_EQ(s.equilibrium.outcome, Outcome::Balanced);
    EXPECT_NEAR(s.equilibrium.reaction[1][2], (1 - w) * start + w * -50, 1e-6) << s.when.time;
  }
  // the same as a relative dead load: it adds to the reaction
  model.rigid_loads[0].kind = RigidLoad::Kind::Dead;
  model.rigid_loads[0].relative = true;
  a = analyse(model, test::linear());
  EXPECT_NEAR(a.states.back().equilibrium.reaction[1][2], start - 50, 1e-6);
}

// Muscle, cable over a pulley body, toe region: z of the plate from one equation each.
TEST(Loads, MusclesAndCablesInEquilibrium) {
  JointModel model = test::flat_plates(6, kSize, kThick, 0.0);
  test::fix(model, 2, {true, true, false, true, true, true});
  test::add_muscle(model, 2, {0, 0, 10}, 1, {0, 0, -30}, 70).from_centers = true;  // which are at the origin here
  RigidCable cable;
  cable.name = "tendon";
  cable.points = {{1, {0, 0, -30}}, {2, {0, 0, 20}}};
  cable.direction = {0, 0, 2};
  cable.force = {30, 0};
  model.rigid_cables.push_back(cable);
  StateResult state = last_state(model);
  expect_balanced(state, 70);
  // the cable pulls the plate down by 30 and its end up by 30
  EXPECT_NEAR(state.equilibrium.poses[1].center.z(), -70 / bed_stiffness(), 1e-9);
  EXPECT_NEAR(state.equilibrium.ligament_force[0], 70, 1e-12);
  EXPECT_NEAR(state.equilibrium.cable_force[0], 30, 1e-12);
}

// ---- many bodies ----------------------------------------------------------------------------------------------------

/// Forces and moments about each centre of mass of all that is reported, against the loads: by contact, by ligament.
void expect_each_body_balanced(const JointModel& model, const Analysis& a, double tolerance) {
  const StateResult& s = a.states.back();
  const auto n = 6 * static_cast<Eigen::Index>(a.joint.bodies.size());
  VectorXd total = VectorXd::Zero(n);
  const auto& poses = s.equilibrium.poses;
  const auto push = [&](int body, const Vector3d& point, const Vector3d& f) {
    total.segment<3>(6 * body) += f;
    total.segment<3>(6 * body + 3) += (point - poses[static_cast<std::size_t>(body)].center).cross(f);
  };
  const auto point_of = [&](int body, const Vector3d& reference) -> Vector3d {
    const auto b = static_cast<std::size_t>(body);
    return poses[b].center + poses[b].rotation * (reference - a.joint.bodies[b].center_of_mass);
  };
  for (std::size_t c = 0; c < a.joint.contacts.size(); ++c) {
    const Vector6& w = s.equilibrium.contact_on_target[c];
    const int t = a.joint.contacts[c].target_layer().body, source = a.joint.contacts[c].source_layer().body;
    total.segment<6>(6 * t) += w;
    total.segment<3>(6 * source) -= w.head<3>();
    const Vector3d lever = poses[static_cast<std::size_t>(t)].center - poses[static_cast<std::size_t>(source)].center;
    total.segment<3>(6 * source + 3) -= w.tail<3>() + lever.cross(Vector3d(w.head<3>()));
  }
  for (std::size_t i = 0; i < a.joint.ligaments.size(); ++i) {
    const Ligament& l = a.joint.ligaments[i];
    const Vector3d p = point_of(l.body_a, l.point_a), q = point_of(l.body_b, l.point_b);
    const Vector3d f = s.equilibrium.ligament_force[i] * (q - p).normalized();
    push(l.body_a, p, f);
    push(l.body_b, q, -f);
  }
  for (const RigidLoad& l : model.rigid_loads)
    for (std::size_t b = 0; b < a.joint.bodies.size(); ++b)
      if (!a.joint.bodies[b].materials.empty() && a.joint.bodies[b].materials[0] == l.material)
        total[6 * static_cast<Eigen::Index>(b) + l.dof] += l.value.factor;
  const LoadCase c = make_load_case(model, a.joint, {}, 0, 1.0);
  for (std::size_t b = 0; b < a.joint.bodies.size(); ++b)
    for (std::size_t k = 0; k < 6; ++k)
      if (c.bodies[b].dofs[k] == DofState::Free) {
        EXPECT_NEAR(total[static_cast<Eigen::Index>(6 * b + k)], 0, tolerance * (k < 3 ? 1 : 10)) << b << " " << k;
      }
}

// Ten bones by dense algebra, sixty by sparse; the first ten of a row feel the others only through their load.
TEST(ManyBodies, RowOfBonesBalances) {
  for (int bones : {10, 60}) {
    const JointModel model = test::bone_chain(bones, 6, 60.0);
    const Analysis a = analyse(model, test::linear());
    ASSERT_EQ(a.states.back().equilibrium.outcome, Outcome::Balanced) << a.states.back().equilibrium.message;
    EXPECT_GT(a.states.back().equilibrium.least_stiffness, 0);
    EXPECT_LE(a.states.back().equilibrium.iterations, 15);
    expect_each_body_balanced(model, a, 1e-5);
  }
}

// Each bone free to spin about its own axis: as many flat directions as bones, found by iteration, held and said.
TEST(ManyBodies, FlatDirectionsOfManyBodiesAreHeld) {
  const int plates = 50;
  JointModel model = test::empty_model();
  const int cartilage = test::add_material(model, "cartilage", false), base = test::add_material(model, "base", true);
  for (int i = 0; i < plates; ++i) {
    const double x = 30.0 * i;
    const int plate = test::add_material(model, "plate " + std::to_string(i), true);
    model.materials[static_cast<std::size_t>(plate)].center_of_mass = Vector3d(x, 0, 0);
    const int a = test::add_layer(
        model, "layer " + std::to_string(i), 3, 3, 1,
        [=](double u, double v) { return Vector3d(x + 10 * u - 5, 10 * v - 5, -2); },
        [=](double u, double v) { return Vector3d(x + 10 * u - 5, 10 * v - 5, 0); }, cartilage, base);
    const int b = test::add_rigid_surface(
        model, "plate " + std::to_string(i), 3, 3,
        [=](double u, double v) { return Vector3d(x + 20 * v - 10, 20 * u - 10, 0.1); }, plate);
    test::add_contact(model, "press " + std::to_string(i), a, b);
    test::force(model, plate, {0, 0, -10.0 - i});
  }
  test::fix(model, base, {true, true, true, true, true, true});
  const StateResult state = last_state(model);
  expect_balanced(state, 60);
  EXPECT_EQ(state.equilibrium.held.size(), static_cast<std::size_t>(3 * plates));  // x, y and the spin of each
  for (int i = 0; i < plates; ++i) {
    EXPECT_NEAR(state.equilibrium.poses[static_cast<std::size_t>(i + 1)].center.z(),
                -0.1 - (10.0 + i) / bed_stiffness(), 1e-8);
  }
}

// ---- loads that cannot be carried -----------------------------------------------------------------------------------

TEST(HardLoads, OverloadEndsBeyondTheStrainLimit) {
  JointModel model = test::concentric_spheres(16, 2e5);
  const StateResult state = last_state(model);
  EXPECT_EQ(state.equilibrium.outcome, Outcome::BeyondStrainLimit) << state.equilibrium.message;
  EXPECT_NE(state.equilibrium.message.find("of the load is not carried"), std::string::npos)
      << state.equilibrium.message;
}

// Deep in the socket, then pulled out sideways: no pressures of a hemisphere can hold the ball.
TEST(HardLoads, PulledOutObliquelySurfacesComeApart) {
  for (const Vector3d& load : {Vector3d(0, 0, -500), Vector3d(300, 0, -200), Vector3d(0, 900, -300)}) {
    JointModel model = test::concentric_spheres(16, 1000.0);
    model.rigid_loads[0].step = 0;
    model.steps.push_back(model.steps[0]);
    for (int k = 0; k < 3; ++k) {
      RigidLoad l = model.rigid_loads[0];
      l.dof = k;
      l.value = {load[k], -1};
      l.step = 1;
      model.rigid_loads.push_back(l);
    }
    const Analysis a = analyse(model, test::linear());
    EXPECT_EQ(a.states[1].equilibrium.outcome, Outcome::Balanced);
    EXPECT_EQ(a.states.back().equilibrium.outcome, Outcome::SurfacesApart)
        << load.transpose() << ": " << a.states.back().equilibrium.message;
  }
}

// ---- the parts of a stiffness ---------------------------------------------------------------------------------------

TEST(SingularParts, SmallOnesOfASparseMatrixAreThoseOfTheDenseOne) {
  const int n = 400;  // a chain with weak links: as many small singular values
  Eigen::SparseMatrix<double> K(n, n);
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, i % 40 == 7 ? 1e-9 : i % 40 == 20 ? 1e-4 * (1 + i) : 10.0 + std::sin(i));
    if (i > 0 && i % 40 != 7 && i % 40 != 8) entries.emplace_back(i, i - 1, 0.3);
    if (i > 0 && i % 40 != 7 && i % 40 != 8) entries.emplace_back(i - 1, i, 0.2);
  }
  K.setFromTriplets(entries.begin(), entries.end());
  const auto small = [](double sigma, const VectorXd&) { return sigma < 1e-3; };
  const SingularParts sparse = small_singular_parts(K, small, 100), dense = all_singular_parts(MatrixXd(K));
  const Eigen::Index expected = (dense.sigma.array() < 1e-3).count();
  ASSERT_GE(expected, 10);
  ASSERT_EQ(sparse.sigma.size(), expected);
  VectorXd sorted = sparse.sigma;
  std::sort(sorted.data(), sorted.data() + sorted.size());
  for (Eigen::Index k = 0; k < expected; ++k) {
    EXPECT_NEAR(sorted[k], dense.sigma[n - 1 - k], 1e-6 * dense.sigma[n - 1 - k] + 1e-12);
    EXPECT_LT((K * sparse.V.col(k) - sparse.sigma[k] * sparse.U.col(k)).norm(), 1e-8);
  }
  EXPECT_LT((sparse.V.transpose() * sparse.V - MatrixXd::Identity(expected, expected)).norm(), 1e-9);
  EXPECT_LT((sparse.U.transpose() * sparse.U - MatrixXd::Identity(expected, expected)).norm(), 1e-9);

  // all of it in one piece, by inverse iteration, and stored zeros that couple nothing
  for (int i = 1; i < n; ++i) K.coeffRef(i, i - 1) += i % 40 == 7 || i % 40 == 8 ? 1e-6 : 0.0;
  K.coeffRef(0, n - 1) = 0.0;
  const SingularParts whole = small_singular_parts(K, small, 100), all = all_singular_parts(MatrixXd(K));
  ASSERT_EQ(whole.sigma.size(), (all.sigma.array() < 1e-3).count());
  for (Eigen::Index k = 0; k < whole.sigma.size(); ++k) {
    EXPECT_NEAR(whole.sigma[k], all.sigma[n - 1 - k], 1e-5 * all.sigma[n - 1 - k] + 1e-11);
    EXPECT_LT((K * whole.V.col(k)).norm(), whole.sigma[k] * 1.001 + 1e-9);
    EXPECT_LT((K.transpose() * whole.U.col(k)).norm(), 1e-3);
  }

  const MatrixXd none(n, 0);
  EXPECT_NEAR(least_symmetric_eigenvalue(K, none, 1000) / least_symmetric_eigenvalue(K, none, 100), 1, 1e-3);
  K.coeffRef(5, 5) = -3;
  EXPECT_NEAR(least_symmetric_eigenvalue(K, none, 1000) / least_symmetric_eigenvalue(K, none, 100), 1, 1e-2);
  EXPECT_NEAR(least_symmetric_eigenvalue(K, dense.V.rightCols(10), 1000), -3, 0.1);
}

}  // namespace dea::connections_test

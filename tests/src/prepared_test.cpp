// A joint made ready once: the same bits whoever uses it, forces that are the integral of the pressures, and a stop.
#include "src/run/prepared.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <ctime>
#include <thread>

#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/run/analysis.h"
#include "tests/src/test_models.h"

namespace dea::prepared_test {

using Law::Layer;

Settings with_law(Law law) {
  Settings settings;
  settings.law = law;
  return settings;
}

/// A ball in a socket, both with cartilage, under a slanted load: no symmetry. Materials: 0 cartilage, 1 socket, 2
/// ball.
JointModel slanted(int n) {
  JointModel model = test::concentric_spheres(n, 1500.0, true);
  test::force(model, 2, {300, -150, 0});
  return model;
}

template <class Matrix>
bool same_bits(const Matrix& a, const Matrix& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(*a.data())) == 0;
}

bool same_bits(const Equilibrium& a, const Equilibrium& b) {
  bool same = a.outcome == b.outcome && same_bits(a.history, b.history) && a.casts == b.casts;
  for (std::size_t i = 0; i < a.poses.size(); ++i)
    same =
        same && same_bits(a.poses[i].center, b.poses[i].center) && same_bits(a.poses[i].rotation, b.poses[i].rotation);
  for (std::size_t c = 0; c < a.springs.size(); ++c)
    same = same && same_bits(a.springs[c].pressure, b.springs[c].pressure) &&
           same_bits(a.contact_on_target[c], b.contact_on_target[c]);
  return same;
}

/// The loads of a model at the end, `share` of them.
LoadCase loads(const JointModel& model, const Prepared& joint, const Settings& settings, double share) {
  return make_load_case(model, joint.joint, settings, 0, share);
}

class EachLaw : public ::testing::TestWithParam<Law> {};
INSTANTIATE_TEST_SUITE_P(Prepared, EachLaw, ::testing::Values(Law::Linear, Layer));

TEST_P(EachLaw, SolveGivesTheSameBitsWhoeverSolvedBefore) {
  const JointModel model = slanted(10);
  const Settings settings = with_law(GetParam());
  const Prepared joint = prepare(recognise(model, settings));
  const LoadCase one = loads(model, joint, settings, 1.0), other = loads(model, joint, settings, 0.4);
  Start start = at_rest(joint);
  start.poses[1].center += Vector3d(0.01, -0.02, 0.005);
  const Equilibrium first = solve(joint, one, start);
  ASSERT_TRUE(solved(first.outcome)) << first.message;
  std::vector<PressMemory> memory;
  solve(joint, other, at_rest(joint), {}, &memory);
  press(joint, first.poses);
  EXPECT_TRUE(same_bits(solve(joint, one, start), first));
  EXPECT_TRUE(same_bits(solve(prepare(recognise(model, settings)), one, start), first));
  // a memory is an argument like the others
  std::vector<PressMemory> copy = memory;
  EXPECT_TRUE(same_bits(solve(joint, one, start, {}, &memory), solve(joint, one, start, {}, &copy)));
}

TEST_P(EachLaw, TwoThreadsOnOneJointGiveTheSameBits) {
  const JointModel model = slanted(10);
  const Settings settings = with_law(GetParam());
  const Prepared joint = prepare(recognise(model, settings));
  const LoadCase cases[2] = {loads(model, joint, settings, 1.0), loads(model, joint, settings, 0.4)};
  Equilibrium alone[2], beside[2];
  for (int i = 0; i < 2; ++i) alone[i] = solve(joint, cases[i], at_rest(joint));
  std::thread threads[2];
  for (int i = 0; i < 2; ++i) threads[i] = std::thread([&, i] { beside[i] = solve(joint, cases[i], at_rest(joint)); });
  for (std::thread& t : threads) t.join();
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(same_bits(alone[i], beside[i])) << i;
}

// On paper: force = integral of pressure times direction, moment = integral of (x - c) x the same, on the target; on
// the source their opposites at the same points.
TEST_P(EachLaw, ForcesAreTheIntegralOfThePressures) {
  const JointModel model = slanted(10);
  const Prepared joint = prepare(recognise(model, with_law(GetParam())));
  std::vector<Pose> poses = at_rest(joint).poses;
  poses[1].center += Vector3d(0.02, -0.05, -0.2);
  const Pressed pressed = press(joint, poses);
  ASSERT_EQ(pressed.contacts.size(), 1u);
  const SpringStates& s = pressed.contacts[0].springs;
  const SpringBed& bed = joint.beds.beds[0];
  Vector6 on_target = Vector6::Zero(), on_source = Vector6::Zero();
  double normal_force = 0.0;
  for (std::size_t i = 0; i < s.pressure.size(); ++i) {
    const Vector3d f = s.force(i) * s.direction[i];  // with what bulges out over an edge
    on_target.head<3>() += f;
    on_target.tail<3>() += (s.foot[i] - poses[at(bed.target_body)].center).cross(f);
    on_source.head<3>() -= f;
    on_source.tail<3>() -= (s.foot[i] - poses[at(bed.source_body)].center).cross(f);
    normal_force += s.force(i);
  }
  ASSERT_GT(normal_force, 10.0);
  const double rounding = 1e-12 * normal_force, lever = joint.beds.length;
  EXPECT_LT((pressed.contacts[0].on_target - on_target).head<3>().norm(), rounding);
  EXPECT_LT((pressed.contacts[0].on_target - on_target).tail<3>().norm(), rounding * lever);
  EXPECT_LT((pressed.contacts[0].on_source - on_source).head<3>().norm(), rounding);
  EXPECT_LT((pressed.contacts[0].on_source - on_source).tail<3>().norm(), rounding * lever);
  EXPECT_NEAR(pressed.contacts[0].normal_force, normal_force, rounding);
  EXPECT_EQ(pressed.on_body[at(bed.target_body)], pressed.contacts[0].on_target);
  EXPECT_EQ(pressed.on_body[at(bed.source_body)], pressed.contacts[0].on_source);
}

// A plate pressed d into a flat layer of thickness h: p = M d / h everywhere (S3), force = p times the area, along z.
TEST(Prepared, PlateOnAFlatLayerCarriesPressureTimesArea) {
  const double size = 10.0, h = 2.0, d = 0.1;
  const JointModel model = test::flat_plates(6, size, h, 0.0);
  const Prepared joint = prepare(recognise(model, test::linear()));
  std::vector<Pose> poses = at_rest(joint).poses;
  const int plate = joint.joint.find_body(model, "plate");
  poses[at(plate)].center.z() -= d;
  const Pressed pressed = press(joint, poses);
  const double M = test::kE * (1 - test::kNu) / ((1 + test::kNu) * (1 - 2 * test::kNu)),
               force = M * d / h * size * size;
  EXPECT_NEAR(pressed.on_body[at(plate)][2], force, 1e-9 * force);
  EXPECT_LT(pressed.on_body[at(plate)].head<2>().norm(), 1e-9 * force);
}

// Central differences of the force and moment by the target's motions. Their error falls with the square of the step,
// that of springs which come to touch or let go in between with the step: 1e-4 holds both below half a percent. Law
// layer: what of the target each foot covers is held in the derivative, which tells where the ball turns in its socket.
TEST_P(EachLaw, DerivativeIsTheOneOfDifferences) {
  const JointModel model = slanted(14);
  const Prepared joint = prepare(recognise(model, with_law(GetParam())));
  std::vector<Pose> poses = at_rest(joint).poses;
  poses[1].center += Vector3d(0.02, -0.05, -0.2);
  PressOptions options;
  const Matrix6 derivative = press(joint, poses, options).contacts[0].derivative;
  const std::size_t target = at(joint.beds.beds[0].target_body);
  Matrix6 differences;
  const double step = 1e-4;
  for (int k = 0; k < 6; ++k) {
    Vector6 side[2];
    for (int sign = 0; sign < 2; ++sign) {
      const double x = sign == 0 ? step : -step, turn = x / joint.beds.length;
      std::vector<Pose> moved = poses;
      if (k < 3)
        moved[target].center[k] += x;
      else
        moved[target].rotation =
            Eigen::AngleAxisd(turn, Vector3d::Unit(k - 3)).toRotationMatrix() * moved[target].rotation;
      side[sign] = press(joint, moved, options).contacts[0].on_target;
    }
    differences.col(k) = (side[0] - side[1]) / (2 * (k < 3 ? step : step / joint.beds.length));
  }
  // in units of force per length: moments and rotations by the length
  Vector6 unit = Vector6::Ones();
  unit.tail<3>().setConstant(1 / joint.beds.length);
  const Matrix6 a = unit.asDiagonal() * derivative * unit.asDiagonal(),
                b = unit.asDiagonal() * differences * unit.asDiagonal();
  EXPECT_LT((a - b).norm(), (GetParam() == Layer ? 1e-2 : 5e-3) * b.norm()) << a << "\n\n" << b;
}

TEST(Prepared, FaultsAreRefused) {
  JointModel model = test::flat_plates(4, 10, 2, 0.1);
  model.contacts.clear();
  EXPECT_THROW(prepare(recognise(model, test::linear())), InputError);
}

// ---- a stop ------------------------------------------------------------------------------------------------------

TEST(Stop, AnAnalysisEndsWhereItsActivitySaysSo) {
  JointModel model = test::concentric_spheres(10, 1000.0, true, 5);
  StopFlag stop = false;
  AnalysisOptions options;
  options.equilibrium.stop = &stop;
  int poses_after = 0;
  std::size_t solved = 0;
  options.activity = [&](const Activity& a) {
    poses_after += stop;
    if (a.stage == Activity::Stage::State && a.index == 2 && a.search.casts == 2) stop = true;
  };
  options.progress = [&](const StateResult&, std::size_t, std::size_t) { ++solved; };
  EXPECT_THROW(analyse(model, with_law(Layer), options), Stopped);
  EXPECT_EQ(solved, 2u);
  EXPECT_EQ(poses_after, 0);  // not even one more pose is tried
  stop = false;
  options.activity = {};
  EXPECT_EQ(analyse(model, with_law(Layer), options).states.size(), 6u);
}

TEST(Stop, IsNoFaultOfTheInput) {
  const std::runtime_error& stopped = Stopped();
  EXPECT_EQ(dynamic_cast<const InputError*>(&stopped), nullptr);
}

// Another thread sets the flag while one contact is being pressed: a search that ends far sooner than it would have.
// Processor time counts, since others may keep the machine busy.
TEST(Stop, EndsWithinAContact) {
  Settings settings = with_law(Layer);
  settings.refine = 8;
  const JointModel model = slanted(20);
  const Prepared joint = prepare(recognise(model, settings));
  std::vector<Pose> poses = at_rest(joint).poses;
  poses[1].center += Vector3d(0.02, -0.05, -0.3);
  StopFlag stop = false;
  PressOptions options;
  options.stop = &stop;
  const auto now = [] { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; };
  const double begun = now();
  press(joint, poses, options);
  const double whole = now() - begun;
  const double again = now();
  double asked = 0.0;
  std::atomic<bool> over = false;
  std::thread other([&] {
    while (!over && now() - again < 0.1 * whole) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    asked = now();
    stop = true;
  });
  EXPECT_THROW(press(joint, poses, options), Stopped);
  const double ended = now();
  over = true;
  other.join();
  EXPECT_LT(ended - asked, 0.25 * whole);
  stop = true;  // asked for before
  EXPECT_THROW(press(joint, poses, options), Stopped);
  EquilibriumOptions search;
  search.stop = &stop;
  EXPECT_THROW(solve(joint, loads(model, joint, settings, 1.0), at_rest(joint), search), Stopped);
}

}  // namespace dea::prepared_test

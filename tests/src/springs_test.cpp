#include "src/springs/springs.h"

#include <gtest/gtest.h>

#include <cmath>

#include "src/base/parallel.h"
#include "src/equilibrium/equilibrium.h"
#include "src/springs/place.h"
#include "src/springs/press.h"
#include "src/springs/wrench.h"
#include "tests/analytic/linear_systems.h"
#include "tests/src/finite_differences.h"
#include "tests/src/test_models.h"

namespace dea::springs_test {

using test::kPi;

Pose small_pose(const Body& body, const Vector3d& shift, const Vector3d& turn) {
  Pose p;
  p.center = body.center_of_mass + shift;
  p.rotation = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  return p;
}

/// A saddle on a saddle, both with varying thickness and different moduli: nothing special about it.
JointModel saddles() {
  using namespace test;
  JointModel model = empty_model();
  const int soft = add_material(model, "soft", false, 11.85, 0.45),
            stiff = add_material(model, "stiff", false, 20.0, 0.3);
  const int low = add_material(model, "low", true), high = add_material(model, "high", true);
  model.materials[static_cast<std::size_t>(high)].center_of_mass = Vector3d(3, -2, 25);
  const auto z = [](double x, double y) { return 0.02 * x * x - 0.015 * y * y; };
  const auto at = [&](double u, double v, double up, double size) {
    const double x = size * (u - 0.5), y = size * (v - 0.5);
    return Vector3d(x, y, z(x, y) + up);
  };
  const int a = add_layer(
      model, "lower", 14, 14, 2, [&](double u, double v) { return at(u, v, -2 - 0.3 * std::sin(3 * u), 20); },
      [&](double u, double v) { return at(u, v, 0, 20); }, soft, low);
  const int b = add_layer(
      model, "upper", 11, 11, 2, [&](double u, double v) { return at(v, u, 2.2 + 0.4 * std::cos(2 * v), 26); },
      [&](double u, double v) { return at(v, u, 0.01 * std::sin(5 * u), 26); }, stiff, high);
  add_contact(model, "saddles", a, b);
  fix(model, low, {true, true, true, true, true, true});
  return model;
}

// Forces and moments on both bodies against central differences (E2-E4 and the turning of n): the error of the
// difference is of second order, and springs that change facet in between add jumps of the derivative, hence the step
// and tolerance.
TEST(Springs, DerivativeMeetsFiniteDifferences) {
  const JointModel model = saddles();
  for (SpringsAt where : {SpringsAt::Articular, SpringsAt::Bone}) {
    for (Law law : {Law::Linear, Law::Logarithmic, Law::NeoHookean}) {
      for (const char* source : {"low", "high"}) {
        Settings settings = test::linear();
        settings.springs_at = where;
        settings.law = law;
        settings.source = source;
        const Joint joint = make_joint(model, settings);
        const SpringBeds beds = make_spring_beds(joint);
        const SpringBed& bed = beds.beds[0];
        Pose s = small_pose(joint.bodies[static_cast<std::size_t>(bed.source_body)],
                            {0.05, -0.02, bed.source_body == 0 ? 0.3 : -0.3}, {0.01, -0.02, 0.015});
        Pose t = small_pose(joint.bodies[static_cast<std::size_t>(bed.target_body)], {-0.03, 0.04, 0.0},
                            {-0.005, 0.01, 0.02});
        const ContactWrench w = contact_wrench(press_springs(bed, s, t), s, t);
        ASSERT_GT(w.normal_force, 100.0);
        const Eigen::Matrix<double, 12, 12> numeric = test::numeric_derivative(bed, s, t, 1e-7);
        // springs over the rim have a covered area that changes with the pose, which (E2-E4) leave out
        const double error = (numeric - w.derivative).norm() / numeric.norm();
        EXPECT_LT(error, 2e-4) << name(where) << " " << name(law) << " source " << source;
      }
    }
  }
}

TEST(Springs, ContactForcesAreOppositeAndActAlongTheSameLines) {
  const JointModel model = saddles();
  const Joint joint = make_joint(model, test::linear());
  const SpringBeds beds = make_spring_beds(joint);
  const Pose s = small_pose(joint.bodies[0], {0, 0, 0.4}, {0.01, 0.02, 0.01}),
             t = small_pose(joint.bodies[1], {0.1, 0, 0}, {0, 0.01, 0});
  const ContactWrench w = contact_wrench(press_springs(beds.beds[0], s, t), s, t);
  const Vector3d F = w.wrench.segment<3>(0), M = w.wrench.segment<3>(3);
  EXPECT_LT((F + w.wrench.segment<3>(6)).norm(), 1e-12 * F.norm());
  // the moments about one common point, the origin, cancel
  const Vector3d about_origin = M + t.center.cross(F) + w.wrench.segment<3>(9) - s.center.cross(F);
  EXPECT_LT(about_origin.norm(), 1e-11 * M.norm());
}

// A plate pressed d deep into a flat layer of thickness h: p = M d / h everywhere, F = p * size^2.
TEST(Springs, FlatPlates) {
  const double size = 10, h = 2, d = 0.3;
  const JointModel model = test::flat_plates(7, size, h, 0.0);
  for (SpringsAt where : {SpringsAt::Articular, SpringsAt::Bone}) {
    for (int refine : {1, 3}) {
      Settings settings = test::linear();
      settings.springs_at = where;
      settings.refine = refine;
      const Joint joint = make_joint(model, settings);
      const SpringBeds beds = make_spring_beds(joint);
      std::vector<Pose> poses = reference_poses(joint);
      poses[1].center.z() -= d;
      const SpringStates s = press_springs(beds.beds[0], poses[0], poses[1]);
      const double p = confined_modulus(test::kE, test::kNu) * d / h;
      EXPECT_EQ(s.size(), 2 * 49 * refine * refine);
      for (int i = 0; i < s.size(); ++i) {
        EXPECT_NEAR(s.pressure[static_cast<std::size_t>(i)], p, 1e-9 * p);
        EXPECT_NEAR(s.coverage[static_cast<std::size_t>(i)], 1.0, 1e-9);
      }
      const ContactWrench w = contact_wrench(s, poses[0], poses[1]);
      EXPECT_NEAR(w.wrench[2], p * size * size, 1e-9 * p * size * size);  // on the plate, upwards
      EXPECT_NEAR(w.derivative(2, 2), -confined_modulus(test::kE, test::kNu) / h * size * size, 1e-6);
    }
  }
}

// A smaller plate over a larger layer, shifted by parts of a facet: the covered area is exactly the plate's.
TEST(Springs, CoverageIsTheOverlappingArea) {
  const double size = 10, plate = 6.3, h = 2, d = 0.1;
  const JointModel model = test::flat_plates(9, size, h, 0.0, plate);
  const Joint joint = make_joint(model, test::linear());
  const SpringBeds beds = make_spring_beds(joint);
  const double p = confined_modulus(test::kE, test::kNu) * d / h;
  for (double shift : {0.0, 0.1, 0.37, 1.0, 1.4, 2.0, 4.0}) {
    for (double turn : {0.0, 0.2}) {
      std::vector<Pose> poses = reference_poses(joint);
      poses[1].center += Vector3d(shift, 0.0, -d);
      poses[1].rotation = Eigen::AngleAxisd(turn, Vector3d::UnitZ()).toRotationMatrix();
      if (turn > 0 && shift > 1.0) continue;  // then its corner leaves the layer: the area below would not hold
      const double width = std::min(plate, 0.5 * (size + plate) - shift);
      const ContactWrench w = contact_wrench(press_springs(beds.beds[0], poses[0], poses[1]), poses[0], poses[1]);
      EXPECT_NEAR(w.wrench[2] / (p * plate * width), 1.0, 1e-6) << "shift " << shift << " turn " << turn;
      // the resultant goes through the middle of the covered strip
      const double x = -w.wrench[4] / w.wrench[2] + poses[1].center.x();
      EXPECT_NEAR(x, shift + 0.5 * plate - 0.5 * plate + (width - plate) * 0.5, 0.02) << "shift " << shift;
    }
  }
}

// A rigid sphere R pressed d deep into a flat layer h. Source = the layer: cap volume, F = (M/h) pi d^2 (3R - d)/3.
// Source = the sphere: along its own radii, F = M pi R d^2 / h (1 + O(d/R)): the ratio 1 + d/(3R) stays.
JointModel sphere_on_flat(int n, double R, double h, double size) {
  using namespace test;
  JointModel model = empty_model();
  const int cartilage = add_material(model, "cartilage", false), base = add_material(model, "base", true),
            ball = add_material(model, "ball", true);
  const int a = add_layer(
      model, "layer", n, n, 1, [=](double u, double v) { return Vector3d(size * (u - 0.5), size * (v - 0.5), -h); },
      [=](double u, double v) { return Vector3d(size * (u - 0.5), size * (v - 0.5), 0); }, cartilage, base);
  const double wide = 1.2 * size;
  const int b = add_rigid_surface(
      model, "ball", 2 * n, 2 * n,
      [=](double u, double v) {
        const double x = wide * (v - 0.5), y = wide * (u - 0.5);
        return Vector3d(x, y, R - std::sqrt(R * R - x * x - y * y));
      },
      ball);
  add_contact(model, "press", a, b);
  fix(model, base, {true, true, true, true, true, true});
  return model;
}

// The error of the sum over facets falls with the square of their size; flat facets have the larger one.
TEST(Springs, SphereOnFlatLayerCarriesTheCapVolume) {
  const double R = 25, h = 2, d = 0.4, M = confined_modulus(test::kE, test::kNu);
  const double exact = M / h * kPi * d * d * (3 * R - d) / 3;
  for (Facets facets : {Facets::Flat, Facets::Curved}) {
    double error[2];
    for (int level = 0; level < 2; ++level) {
      const JointModel model = sphere_on_flat(20 << level, R, h, 12.0);
      Settings settings = test::linear();
      settings.facets = facets;
      const Joint joint = make_joint(model, settings);
      const SpringBeds beds = make_spring_beds(joint);
      std::vector<Pose> poses = reference_poses(joint);
      poses[1].center.z() -= d;
      error[level] =
          contact_wrench(press_springs(beds.beds[0], poses[0], poses[1]), poses[0], poses[1]).wrench[2] / exact - 1;
    }
    EXPECT_LT(std::abs(error[1]), facets == Facets::Flat ? 6e-3 : 3e-4) << name(facets);
    if (facets == Facets::Flat) {
      EXPECT_GT(std::abs(error[0] / error[1]), 3.0) << "second order: " << error[0] << " " << error[1];
    }
  }
}

// From the sphere along its radii the overlap is R - (R - d)/cos(theta): F = (M/h) * integral of it over the sphere's
// area times cos(theta), theta up to cos(theta_0) = 1 - d/R: pi R^2 (M/h) [R (1 - c^2) - 2 (R - d)(1 - c)], c = 1 -
// d/R, = M pi R d^2 / h. No refinement brings it to the cap volume: the ratio is 3R / (3R - d).
TEST(Springs, SphereAsSourceCarriesPiRdSquared) {
  const double R = 25, h = 2, M = confined_modulus(test::kE, test::kNu);
  for (double d : {0.4, 0.2}) {
    const JointModel model = sphere_on_flat(60, R, h, d == 0.4 ? 12.0 : 8.5);
    Settings settings = test::linear("ball");
    const Joint joint = make_joint(model, settings);
    const SpringBeds beds = make_spring_beds(joint);
    std::vector<Pose> poses = reference_poses(joint);
    poses[1].center.z() -= d;
    const double F = -contact_wrench(press_springs(beds.beds[0], poses[1], poses[0]), poses[1], poses[0]).wrench[2];
    EXPECT_NEAR(F / (M * kPi * R * d * d / h), 1.0, 5e-4) << d;
  }
}

// Exact on a sphere: the middle of a facet is lifted onto it, whatever the shape of the facets.
TEST(SurfaceMesh, BulgeLiftsFacetsOntoTheirSphere) {
  const JointModel model = test::concentric_spheres(24, 1.0);
  const Joint joint = make_joint(model, test::linear());
  const SurfaceMesh& ball = joint.contacts[0].layers[1].articular;
  double worst_flat = 0, worst = 0;
  for (int t = 0; t < ball.size(); ++t) {
    if (ball.centroid(t).z() < -4) continue;  // rim facets: tested by the whole-joint answers
    const std::array<double, 3> middle = {1.0 / 3, 1.0 / 3, 1.0 / 3};
    const Vector3d lifted =
        ball.centroid(t) + bulge_height(ball, t, middle) * ball.normals[static_cast<std::size_t>(t)];
    worst_flat = std::max(worst_flat, std::abs(ball.centroid(t).norm() - 20));
    worst = std::max(worst, std::abs(lifted.norm() - 20));
  }
  EXPECT_GT(worst_flat, 0.03);
  EXPECT_LT(worst, 6e-4);  // size^4 / R^3
}

TEST(SurfaceMesh, BulgeGradientMeetsFiniteDifferences) {
  const JointModel model = saddles();
  const Joint joint = make_joint(model, test::linear());
  const SurfaceMesh& mesh = joint.contacts[0].layers[0].articular;
  const std::array<double, 3> w = {0.2, 0.3, 0.5};
  for (int t = 0; t < mesh.size(); t += 7) {
    const Vector3d gradient = bulge_gradient(mesh, t, w);
    for (int k = 0; k < 2; ++k) {
      const double d = 1e-6;
      std::array<double, 3> up = w, down = w;
      up[2] -= d, up[static_cast<std::size_t>(k)] += d;
      down[2] += d, down[static_cast<std::size_t>(k)] -= d;
      const Vector3d dx = d * (mesh.corner(t, k) - mesh.corner(t, 2));
      EXPECT_NEAR(bulge_height(mesh, t, up) - bulge_height(mesh, t, down), 2 * gradient.dot(dx), 1e-12);
    }
  }
}

TEST(Springs, SameBitsForAnyNumberOfThreads) {
  const JointModel model = saddles();
  Settings settings = test::linear();
  settings.refine = 6;
  const Joint joint = make_joint(model, settings);
  const SpringBeds beds = make_spring_beds(joint);
  const Pose s = small_pose(joint.bodies[0], {0, 0, 0.4}, {0.01, 0.02, 0.01}),
             t = small_pose(joint.bodies[1], {0.1, 0, 0}, {0, 0.01, 0});
  std::vector<ContactWrench, Eigen::aligned_allocator<ContactWrench>> w;
  for (int threads : {1, 2, 4}) {
    const auto control = limit_threads(threads);
    w.push_back(contact_wrench(press_springs(beds.beds[0], s, t), s, t));
  }
  EXPECT_EQ(w[0].wrench, w[1].wrench);
  EXPECT_EQ(w[0].derivative, w[1].derivative);
  EXPECT_EQ(w[0].wrench, w[2].wrench);
}

/// Surfaces apart have no stiffness of their own: the closing one takes a force to just beyond first touch.
TEST(ClosingStiffness, TakesAForceToFirstTouch) {
  // flat plates 0.3 apart: the motion along z is the gap and a hundredth of the layer's 2 mm
  const Joint flat = make_joint(test::flat_plates(4, 10, 2, 0.3), test::linear());
  const SpringBeds plates = make_spring_beds(flat);
  const SpringBed& bed = plates.beds[0];
  std::vector<Pose> poses = reference_poses(flat);
  const auto source = static_cast<std::size_t>(bed.source_body), target = static_cast<std::size_t>(bed.target_body);
  SpringStates s = press_springs(bed, poses[source], poses[target]);
  Eigen::Matrix<double, 12, 1> force = Eigen::Matrix<double, 12, 1>::Zero();
  force[2] = -5;  // on the target, the plate above
  std::array<bool, 12> free = {};
  free[2] = true;
  const Eigen::Matrix<double, 12, 12> K = closing_stiffness(bed, s, poses[source], poses[target], force, free);
  EXPECT_NEAR(force[2] / K(2, 2), -(0.3 + 0.02), 1e-12);
  EXPECT_NEAR(K.norm(), K(2, 2), 1e-12 * K(2, 2));  // held dofs: nothing

  // a ball in a socket, pushed sideways after it was drawn back: it lands on the springs, none deeper than 2% of 4 mm
  const Joint spheres = make_joint(test::concentric_spheres(10, 2000), test::linear());
  const SpringBeds beds = make_spring_beds(spheres);
  poses = reference_poses(spheres);
  const SpringBed& ball = beds.beds[0];
  Pose& moving = poses[static_cast<std::size_t>(ball.target_body)];
  moving.center.z() -= 1.0;
  s = press_springs(ball, poses[static_cast<std::size_t>(ball.source_body)], moving);
  ASSERT_EQ(contact_wrench(s, poses[static_cast<std::size_t>(ball.source_body)], moving).normal_force, 0.0);
  force << 30, -20, 100, 0, 0, 0, 0, 0, 0, 0, 0, 0;
  free = {true, true, true};
  const Eigen::Matrix<double, 12, 12> stiffness =
      closing_stiffness(ball, s, poses[static_cast<std::size_t>(ball.source_body)], moving, force, free);
  moving.center += analytic::solve_dense(stiffness.block<3, 3>(0, 0), force.segment<3>(0));
  s = press_springs(ball, poses[static_cast<std::size_t>(ball.source_body)], moving);
  const double deepest = *std::max_element(s.overlap.begin(), s.overlap.end());
  EXPECT_GT(deepest, 0.0);
  EXPECT_LT(deepest, 0.08);

  // a force that opens the joint closes nothing: a stiffness all the same, so that a solver can go on
  const Eigen::Matrix<double, 12, 12> away =
      closing_stiffness(ball, s, poses[static_cast<std::size_t>(ball.source_body)], moving, -force, free);
  EXPECT_TRUE(away.allFinite());
}

/// Plates slide on each other and turn about their normal; apart, nothing is resisted.
TEST(ResistedMotions, OfPlates) {
  std::array<bool, 12> one_body = {}, both;
  for (std::size_t d = 0; d < 6; ++d) one_body[d] = true;
  both.fill(true);
  const Joint flat = make_joint(test::flat_plates(4, 10, 2, -0.3), test::linear());
  const SpringBeds plates = make_spring_beds(flat);
  std::vector<Pose> poses = reference_poses(flat);
  Pose& source = poses[static_cast<std::size_t>(plates.beds[0].source_body)];
  Pose& target = poses[static_cast<std::size_t>(plates.beds[0].target_body)];
  const auto resisted = [](const SpringBed& bed, const Pose& s, const Pose& t, const std::array<bool, 12>& free) {
    return resisted_motions(press_springs(bed, s, t), s, t, free);
  };
  EXPECT_EQ(resisted(plates.beds[0], source, target, one_body), 3);
  EXPECT_EQ(resisted(plates.beds[0], source, target, both), 3);
  EXPECT_EQ(resisted(plates.beds[0], source, target, {}), 0);
  target.center.z() += 1;
  EXPECT_EQ(resisted(plates.beds[0], source, target, one_body), 0);
}

/// A motion that both bodies can make is one; where one body turns and the other slides, there are two.
TEST(FreeMotions, OfTwoBodies) {
  Pose source, target;
  target.center = {10, 20, 30};
  std::array<bool, 12> free = {};
  EXPECT_EQ(free_motions(source, target, free), 0);
  free[0] = free[6] = true;
  EXPECT_EQ(free_motions(source, target, free), 1);
  free[5] = true;
  EXPECT_EQ(free_motions(source, target, free), 2);
  free[11] = true;  // turned about another centre, a body slides along y too
  EXPECT_EQ(free_motions(source, target, free), 3);
  free.fill(true);
  EXPECT_EQ(free_motions(source, target, free), 6);
}

/// The target is the plate above: a force up on it opens, and one up on the layer closes. Held bodies do neither.
TEST(OpeningPart, OfPlates) {
  const Joint flat = make_joint(test::flat_plates(4, 10, 2, 0.3), test::linear());
  const SpringBeds plates = make_spring_beds(flat);
  const std::vector<Pose> poses = reference_poses(flat);
  const SpringStates s = press_springs(plates.beds[0], poses[static_cast<std::size_t>(plates.beds[0].source_body)],
                                       poses[static_cast<std::size_t>(plates.beds[0].target_body)]);
  std::array<bool, 12> free;
  free.fill(true);
  Eigen::Matrix<double, 12, 1> force = Eigen::Matrix<double, 12, 1>::Zero();
  force[0] = 7;
  EXPECT_NEAR(opening_part(s, force, free), 0, 1e-12);
  force[2] = 5;
  EXPECT_NEAR(opening_part(s, force, free), 5, 1e-12);
  force[8] = 11;
  EXPECT_NEAR(opening_part(s, force, free), -6, 1e-12);
  free[8] = false;
  EXPECT_NEAR(opening_part(s, force, free), 5, 1e-12);
}

}  // namespace dea::springs_test

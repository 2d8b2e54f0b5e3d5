// The answers on paper against independent quadrature, and against the figures printed in the documentation.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/analytic/concentric_spheres.h"
#include "tests/analytic/sphere_on_flat.h"

namespace dea::analytic_test {
using namespace analytic;

const ConcentricSpheres kCases[] = {one_layer_socket(), one_layer_ball(), two_layers_socket(),
                                    two_layers_ball(),  bone_socket(),    bone_ball()};

// Tolerance: Simpson's rule with 2000 intervals on a smooth function is exact to rounding.
TEST(ConcentricSpheres, ClosedFormIsTheIntegralOfThePressure) {
  for (const ConcentricSpheres& spheres : kCases) {
    const auto linear = [&](double e) { return spheres.modulus * e; };
    for (const double u : {1e-3, 0.2, 0.5, 2.0}) EXPECT_NEAR(spheres.force(u, linear) / spheres.force(u), 1, 1e-10);
  }
}

TEST(ConcentricSpheres, OverlapIsZeroInThePlaneHalfWayBetweenTheCentres) {
  const double u = 0.7;
  for (const ConcentricSpheres& spheres : kCases) {
    EXPECT_NEAR(spheres.overlap(spheres.contact_angle(u), u), 0, 1e-13);
    EXPECT_NEAR(spheres.overlap(0, u), u, 1e-13);
  }
}

// The overlap is the distance, along the spring, between points found by geometry alone.
TEST(ConcentricSpheres, OverlapIsADistanceAlongTheSpring) {
  const double u = 0.5;
  for (const ConcentricSpheres& spheres : kCases) {
    const bool from_socket = spheres.source == ConcentricSpheres::Source::Socket;
    for (const double theta : {0.1, 0.7, 1.4}) {
      // Walk outwards from the source's centre by r until the other body's sphere is met.
      const double other_center = from_socket ? u : -u;
      const double r =
          bisect([&](double s) { return std::hypot(s * std::sin(theta), s * std::cos(theta) - other_center); },
                 spheres.end_radius, 1, 40);
      const double overlap = from_socket ? r - spheres.end_radius : spheres.end_radius - r;
      EXPECT_NEAR(spheres.overlap(theta, u), overlap, 1e-12);
    }
  }
}

// Figures of docs/theory.md and samples/spheres/README.md, rounded to six digits there.
TEST(ConcentricSpheres, PrintedFigures) {
  struct Row {
    ConcentricSpheres spheres;
    double at_100, at_2000, at_4000;
  };
  const Row rows[] = {
      {one_layer_socket(), 0.119390, 2.39691, 4.81331},   {one_layer_ball(), 0.119342, 2.37789, 4.73720},
      {two_layers_socket(), 0.0986645, 1.97894, 3.96990}, {two_layers_ball(), 0.0986350, 1.96713, 3.92265},
      {bone_socket(), 0.0829047, 1.66248, 3.33428},       {bone_ball(), 0.119346, 2.37945, 4.74336}};
  for (const Row& row : rows) {
    EXPECT_NEAR(row.spheres.peak_pressure(100), row.at_100, 1e-6);
    EXPECT_NEAR(row.spheres.peak_pressure(2000), row.at_2000, 1e-5);
    EXPECT_NEAR(row.spheres.peak_pressure(4000), row.at_4000, 1e-5);
  }
  EXPECT_NEAR(one_layer_socket().small_load_peak_pressure(2000), 2.3873, 5e-5);
  EXPECT_NEAR(two_layers_socket().small_load_peak_pressure(2000), 1.9730, 5e-5);
  EXPECT_NEAR(bone_socket().small_load_peak_pressure(2000), 1.6579, 5e-5);
}

TEST(SphereOnFlat, ClosedFormsAreTheIntegralsOfThePressure) {
  const SphereOnFlat joint;
  const double R = joint.radius, d = 0.4, k = joint.modulus / joint.thickness;
  const double from_layer = simpson([&](double r) { return k * (d - R + std::sqrt(R * R - r * r)) * 2 * kPi * r; }, 0,
                                    std::sqrt(d * (2 * R - d)));
  // A spring of the sphere at the angle a meets the plane after (height of its foot) / cos(a).
  const double from_sphere = simpson(
      [&](double a) {
        return k * (d - R * (1 - std::cos(a))) / std::cos(a) * std::cos(a) * 2 * kPi * R * R * std::sin(a);
      },
      0, std::acos(1 - d / R));
  EXPECT_NEAR(joint.force_from_layer(d) / from_layer, 1, 1e-10);
  EXPECT_NEAR(joint.force_from_sphere(d) / from_sphere, 1, 1e-10);
  EXPECT_NEAR(joint.force_from_layer(d), 280.912, 5e-4);
  EXPECT_NEAR(joint.force_from_sphere(d), 282.418, 5e-4);
}

// Figures of samples/ligament/README.md.
TEST(CondyleWithLigaments, PrintedFigures) {
  const CondyleWithLigaments knee;
  EXPECT_NEAR(knee.depth_from_layer(150), 0.367889, 1e-6);
  EXPECT_NEAR(knee.depth_from_layer(300), 0.462159, 1e-6);
  EXPECT_NEAR(knee.depth_from_sphere(300), 0.460845, 1e-6);
  EXPECT_NEAR(knee.demand(300, knee.depth_from_layer(300)), 374.689, 1e-3);
}

}  // namespace dea::analytic_test

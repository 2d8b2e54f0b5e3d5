// Stress per strain of materials with directions, against answers on paper.
#include "src/model/stiffness.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

namespace dea::stiffness_test {
namespace {

Eigen::Matrix3d some_turn() { return Eigen::AngleAxisd(0.7, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix(); }

/// The tension of fibres at a stretch, as stiffness.h has it; of ExpPowLinear by its toe alone, or by its line alone.
double tension(const Fibres& f, double stretch, bool line = false) {
  const auto& c = f.c;
  const auto power = [](double a, double b, double ksi, double from, double L) {
    const double x = L * L - from * from;
    return x < 0 ? 0.0 : 2 * ksi * L * L * std::pow(x, b - 1) * std::exp(a * std::pow(x, b));
  };
  if (f.law == Fibres::Law::ExpLinear) {
    const auto toe = [&](double L) { return c[0] * (std::exp(c[1] * (L - 1)) - 1); };
    return stretch < c[3] ? toe(stretch) : toe(c[3]) + c[2] * (stretch - c[3]);
  }
  if (f.law == Fibres::Law::Logarithmic) return stretch < c[3] ? 0.0 : c[0] * std::log(stretch / c[3]);
  if (f.law == Fibres::Law::ExpPow) return power(c[0], c[1], c[2], c[3], stretch);
  // FEBio's constants of fiber-exp-pow-linear
  const double I = c[3] * c[3], p = c[0] * std::pow(I - 1, c[1]), below = 4 * std::pow(I, 1.5) * (c[1] - 1 + c[1] * p);
  const double ksi = c[2] * std::pow(I - 1, 2 - c[1]) * std::exp(-p) / below,
               b = c[2] * (2 * I * (c[1] - 0.5 + c[1] * p) - 1) / below;
  return line ? 2 * b * stretch * stretch - c[2] * stretch : power(c[0], c[1], ksi, 1, stretch);
}

TEST(Stiffness, FibresHaveTheSlopeOfTheirTension) {
  const Fibres toe{Fibres::Law::ExpLinear, {0.1, 50, 100, 1.05}, true, {}},
      power{Fibres::Law::ExpPow, {20, 2, 3, 1}, false, {}}, cubic{Fibres::Law::ExpPow, {0, 3, 5, 1}, false, {}},
      slack{Fibres::Law::ExpPow, {2, 2.5, 5, 1.02}, false, {}},
      line{Fibres::Law::ExpPowLinear, {30, 3, 9, 1.05}, false, {}},
      straight{Fibres::Law::ExpPowLinear, {0, 2, 9, 1.05}, false, {}},
      log{Fibres::Law::Logarithmic, {7, 0, 0, 1}, false, {}};
  EXPECT_DOUBLE_EQ(fibre_modulus(toe, 0), 0.1 * 50);
  EXPECT_DOUBLE_EQ(fibre_modulus(toe, -0.1), 0.1 * 50);
  EXPECT_DOUBLE_EQ(fibre_modulus(toe, 0.06), 100);
  EXPECT_DOUBLE_EQ(fibre_modulus(power, 0), 4 * 3);  // W = ksi/2 (L^2 - 1)^2
  EXPECT_DOUBLE_EQ(fibre_modulus(cubic, 0), 0);
  EXPECT_DOUBLE_EQ(fibre_modulus(slack, 0.019), 0);
  EXPECT_DOUBLE_EQ(fibre_modulus(straight, 0), 9 / std::pow(1.05, 3));  // 4 ksi
  EXPECT_DOUBLE_EQ(fibre_modulus(log, 0), 7);
  EXPECT_DOUBLE_EQ(fibre_modulus({}, 0.03), 0) << "of fibres that are not known";
  for (const Fibres* f : {&toe, &power, &cubic, &slack, &line, &straight, &log})
    for (const double strain : {0.01, 0.03, 0.04, 0.08}) {
      const double d = 1e-6;
      const bool beyond = strain > 0.05;
      const double slope = (tension(*f, 1 + strain + d, beyond) - tension(*f, 1 + strain - d, beyond)) / (2 * d);
      EXPECT_NEAR(fibre_modulus(*f, strain), slope, 1e-6 * slope) << strain;
    }
  for (const Fibres* f : {&line, &straight}) {  // no step of tension or slope where the toe ends
    EXPECT_NEAR(tension(*f, 1.05), tension(*f, 1.05, true), 1e-12);
    EXPECT_NEAR(fibre_modulus(*f, 0.05 - 1e-9), fibre_modulus(*f, 0.05), 1e-4);
  }
  Fibres relaxed = toe;
  relaxed.share = 0.3;
  EXPECT_DOUBLE_EQ(fibre_modulus(relaxed, 0.02), 0.3 * fibre_modulus(toe, 0.02));
}

TEST(Stiffness, FibresPullAlongThemselves) {
  const Vector3d n = Vector3d(0.3, -0.5, 0.7).normalized();
  Vector6d drawn, tension;  // strain n n^T, as engineering strains; stress n n^T
  drawn << n.x() * n.x(), n.y() * n.y(), n.z() * n.z(), 2 * n.x() * n.y(), 2 * n.y() * n.z(), 2 * n.x() * n.z();
  tension << drawn.head<3>(), 0.5 * drawn.tail<3>();
  EXPECT_LT((fibre_stiffness(7, false, n) * drawn - 7 * tension).norm(), 1e-14);
  // without change of volume: two thirds of the strain stretch them, and their stress has no pressure
  Vector6d without_pressure = tension;
  without_pressure.head<3>().array() -= 1.0 / 3;
  EXPECT_LT((fibre_stiffness(7, true, n) * drawn - 7 * 2.0 / 3 * without_pressure).norm(), 1e-14);
  const Eigen::Matrix3d Q = some_turn();
  for (const bool deviatoric : {false, true})
    EXPECT_LT((turned_stiffness(fibre_stiffness(7, deviatoric, n), Q) - fibre_stiffness(7, deviatoric, Q * n)).norm(),
              1e-13);
}

TEST(Stiffness, OfOrthotropicMaterials) {
  const double E = 10, nu = 0.3, G = E / (2 * (1 + nu));
  const auto even = orthotropic_stiffness({E, E, E}, {G, G, G}, {nu, nu, nu});
  ASSERT_TRUE(even);
  EXPECT_LT((*even - isotropic_stiffness(E, nu)).norm(), 1e-12 * even->norm());
  EXPECT_LT((turned_stiffness(*even, some_turn()) - isotropic_stiffness(E, nu)).norm(), 1e-12 * even->norm())
      << "no axes in an isotropic material";
  const auto D = orthotropic_stiffness({140, 20, 30}, {50, 11, 60}, {0.4, 0.3, 0.1});
  ASSERT_TRUE(D);
  const Matrix6d S = D->inverse();
  EXPECT_NEAR(S(1, 0), -0.4 / 140, 1e-12);  // stress along 1: strain 2 is -v12 of strain 1
  EXPECT_NEAR(S(2, 1), -0.3 / 20, 1e-12);
  EXPECT_NEAR(S(0, 2), -0.1 / 30, 1e-12);
  EXPECT_NEAR(1 / S(3, 3), 50, 1e-9);  // xy
  EXPECT_NEAR(1 / S(5, 5), 60, 1e-9);  // xz
  const Eigen::Matrix3d Q = some_turn();
  EXPECT_LT((turned_stiffness(turned_stiffness(*D, Q), Q.transpose()) - *D).norm(), 1e-11 * D->norm());
  EXPECT_FALSE(orthotropic_stiffness({140, 20, 30}, {50, 11, 60}, {3, 0.3, 0.1})) << "energy below zero";
}

/// Of a pressure alone nothing is left, of what changes no volume everything that is no pressure.
TEST(Stiffness, WithoutChangeOfVolume) {
  const double G = 3, K = 40;
  EXPECT_LT((deviatoric_stiffness(lame_stiffness(G, K - 2 * G / 3)) - lame_stiffness(G, -2 * G / 3)).norm(), 1e-13);
  const Matrix6d D = *orthotropic_stiffness({140, 20, 30}, {50, 11, 60}, {0.4, 0.3, 0.1}),
                 dev = deviatoric_stiffness(D);
  Vector6d even = Vector6d::Zero(), drawn;
  even.head<3>().setOnes();
  drawn << 2, -3, 1, 4, 5, -6;
  EXPECT_LT((dev * even).norm(), 1e-12);
  EXPECT_LT((even.transpose() * dev).norm(), 1e-12);
  EXPECT_NEAR(drawn.dot(dev * drawn), drawn.dot(D * drawn), 1e-10);  // the same energy
  EXPECT_LT(
      (fibre_stiffness(7, true, Vector3d::UnitY()) - deviatoric_stiffness(fibre_stiffness(7, false, Vector3d::UnitY())))
          .norm(),
      1e-14);
}

/// The fluid makes an isotropic solid one of its shear modulus and of the Poisson's ratio given; of one with axes it
/// adds a pressure alone.
TEST(Stiffness, OfTrappedFluid) {
  const double E = 0.5, nu = 0.1, G = E / (2 * (1 + nu));
  const Matrix6d solid = isotropic_stiffness(E, nu);
  EXPECT_LT((solid + trapped_fluid_stiffness(solid, 0.499) - isotropic_stiffness(2 * G * 1.499, 0.499)).norm(), 1e-9);
  EXPECT_LT(trapped_fluid_stiffness(solid, nu).norm(), 1e-14);
  const Matrix6d D = *orthotropic_stiffness({140, 20, 30}, {50, 11, 60}, {0.4, 0.3, 0.1});
  const Matrix6d fluid = trapped_fluid_stiffness(D, 0.499);
  EXPECT_LT((fluid - turned_stiffness(fluid, some_turn())).norm(), 1e-9 * fluid.norm());
  EXPECT_LT(deviatoric_stiffness(fluid).norm(), 1e-9 * fluid.norm());
  // whichever way it is turned, it has the same mean
  EXPECT_NEAR(trapped_fluid_stiffness(turned_stiffness(D, some_turn()), 0.499)(0, 1), fluid(0, 1), 1e-9 * fluid(0, 1));
}

/// Means of n n n n on paper: on the sphere 1/15 (3 along itself, 1 across and in shear), in a plane 1/8.
TEST(Stiffness, OfFibresInManyDirections) {
  const auto even = [](const Vector3d&) { return 1.0; };
  EXPECT_LT((spread_of(even, false, false) - lame_stiffness(1.0 / 15, 1.0 / 15)).norm(), 1e-4);
  const Matrix6d flat = spread_of(even, true, false);
  EXPECT_NEAR(flat(0, 0), 3.0 / 8, 1e-12);
  EXPECT_NEAR(flat(1, 0), 1.0 / 8, 1e-12);
  EXPECT_NEAR(flat(3, 3), 1.0 / 8, 1e-12);
  EXPECT_NEAR(flat(2, 2), 0, 1e-12);
  EXPECT_LT((spread_of(even, false, true) - lame_stiffness(1.0 / 15, -2.0 / 45)).norm(), 1e-4);
  // all but along x
  const Matrix6d along = spread_of([](const Vector3d& n) { return std::exp(400 * (n.x() * n.x() - 1)); }, false, false);
  EXPECT_NEAR(along(0, 0), 1 - 2.0 / 400, 1e-4);  // the square of the angle to x is 1/400 in the mean
  EXPECT_NEAR(along(1, 0), 0.5 / 400, 1e-4);
}

/// The ring of a meniscus about z, and what FEBio makes of an axis along y: x alone is turned with it.
TEST(Stiffness, DirectionsRoundAnAxis) {
  Direction ring;
  ring.by = Direction::By::Cylindrical;
  ring.center = Vector3d(1, 2, 3);
  ring.vector = Vector3d::UnitY();
  for (const double turn : {0.0, 0.4, 2.0, 3.1, -1.0}) {
    const Vector3d out(std::cos(turn), std::sin(turn), 0), place = ring.center + 5 * out + Vector3d(0, 0, 7);
    EXPECT_LT((*direction_at(ring, place) - Vector3d::UnitZ().cross(out)).norm(), 1e-12);
    Axes axes;
    axes.by = Axes::By::Cylindrical;
    axes.center = ring.center;
    Eigen::Matrix3d Q = *axes_at(axes, place);  // FEBio's default: outwards, around, along
    EXPECT_LT((Q.col(0) - out).norm() + (Q.col(2) - Vector3d::UnitZ()).norm(), 1e-12);
    axes.a = Vector3d::UnitY();  // d lies along it, then: z
    Q = *axes_at(axes, place);
    EXPECT_LT((Q.col(0) - Vector3d::UnitZ().cross(out)).norm() + (Q.col(1) - Vector3d::UnitZ()).norm(), 1e-12);
  }
  EXPECT_EQ(*direction_at(ring, ring.center - Vector3d::UnitX()), Vector3d::UnitY()) << "FEBio does not turn by pi";
  EXPECT_FALSE(direction_at(ring, ring.center + Vector3d::UnitZ())) << "on the axis";
  ring.axis = Vector3d::UnitY();
  EXPECT_LT((*direction_at(ring, ring.center + Vector3d(2, 1, 2)) - Vector3d::UnitY()).norm(), 1e-12);
  ring.vector = Vector3d::UnitX();
  EXPECT_LT((*direction_at(ring, ring.center + Vector3d(2, 1, 2)) - Vector3d(1, 0, 1).normalized()).norm(), 1e-12);
}

TEST(Stiffness, DirectionsFromACenter) {
  Direction out;
  out.by = Direction::By::Spherical;
  out.center = Vector3d(1, 0, 0);
  EXPECT_LT((*direction_at(out, Vector3d(1, 3, 4)) - Vector3d(0, 0.6, 0.8)).norm(), 1e-12);
  out.vector = Vector3d::UnitY();  // turned from x to y: y goes to -x
  EXPECT_LT((*direction_at(out, Vector3d(1, 2, 0)) + Vector3d::UnitX()).norm(), 1e-12);
  Axes axes;
  axes.by = Axes::By::Spherical;
  axes.center = out.center;
  const Eigen::Matrix3d Q = *axes_at(axes, Vector3d(1, 3, 4)), above = *axes_at(axes, Vector3d(1, 2, 0));
  EXPECT_LT((Q.col(0) - Vector3d(0, 0.6, 0.8)).norm() + (Q.col(2) + Vector3d::UnitX()).norm(), 1e-12);
  EXPECT_LT((above.col(0) - Vector3d::UnitY()).norm() + (above.col(1) - Vector3d::UnitZ()).norm(), 1e-12);
}

TEST(Stiffness, AxesStandOnEachOther) {
  const auto Q = axes_from({0, 2, 0}, {1, 1, 0});
  ASSERT_TRUE(Q);
  Eigen::Matrix3d expected;
  expected.col(0) = Vector3d::UnitY();
  expected.col(1) = Vector3d::UnitX();
  expected.col(2) = -Vector3d::UnitZ();
  EXPECT_LT((*Q - expected).norm(), 1e-15);
  EXPECT_FALSE(axes_from({0, 2, 0}, {0, -1, 0}));
}

}  // namespace
}  // namespace dea::stiffness_test

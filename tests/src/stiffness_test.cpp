// Stress per strain of materials with directions, against answers on paper.
#include "src/model/stiffness.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace dea::stiffness_test {
namespace {

Eigen::Matrix3d some_turn() { return Eigen::AngleAxisd(0.7, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix(); }

/// The tension of fibres at a stretch, as stiffness.h has it.
double tension(const Fibres& f, double stretch) {
  const auto& c = f.c;
  if (f.law == Fibres::Law::ExpLinear) {
    const auto toe = [&](double L) { return c[0] * (std::exp(c[1] * (L - 1)) - 1); };
    return stretch < c[3] ? toe(stretch) : toe(c[3]) + c[2] * (stretch - c[3]);
  }
  const double x = stretch * stretch - 1;
  return 2 * c[2] * stretch * stretch * std::pow(x, c[1] - 1) * std::exp(c[0] * std::pow(x, c[1]));
}

TEST(Stiffness, FibresHaveTheSlopeOfTheirTension) {
  const Fibres toe{Fibres::Law::ExpLinear, {0.1, 50, 100, 1.05}, true, {}},
      power{Fibres::Law::ExpPow, {20, 2, 3, 0}, false, {}}, cubic{Fibres::Law::ExpPow, {0, 3, 5, 0}, false, {}};
  EXPECT_DOUBLE_EQ(fibre_modulus(toe, 0), 0.1 * 50);
  EXPECT_DOUBLE_EQ(fibre_modulus(toe, -0.1), 0.1 * 50);
  EXPECT_DOUBLE_EQ(fibre_modulus(toe, 0.06), 100);
  EXPECT_DOUBLE_EQ(fibre_modulus(power, 0), 4 * 3);  // W = ksi/2 (L^2 - 1)^2
  EXPECT_DOUBLE_EQ(fibre_modulus(cubic, 0), 0);
  EXPECT_DOUBLE_EQ(fibre_modulus({}, 0.03), 0) << "of fibres that are not known";
  for (const Fibres* f : {&toe, &power, &cubic})
    for (const double strain : {0.01, 0.03, 0.04, 0.08}) {
      const double d = 1e-6, slope = (tension(*f, 1 + strain + d) - tension(*f, 1 + strain - d)) / (2 * d);
      EXPECT_NEAR(fibre_modulus(*f, strain), slope, 1e-6 * slope) << strain;
    }
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

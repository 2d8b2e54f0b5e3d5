#include "src/springs/spring_law.h"

#include <gtest/gtest.h>

#include <cmath>

namespace dea::spring_law_test {

const Elasticity kSoft{11.85, 0.45}, kStiff{20.0, 0.3};
const Law kLaws[] = {Law::Linear, Law::Logarithmic, Law::NeoHookean};

TEST(SpringLaw, ConfinedModulusIsLambdaPlusTwoMu) {
  const double E = 11.85, nu = 0.45;
  const double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = E / (2 * (1 + nu));
  EXPECT_NEAR(confined_modulus(E, nu), lambda + 2 * mu, 1e-12 * E);
}

TEST(SpringLaw, AllLawsStartWithTheConfinedModulus) {
  for (Law law : kLaws) {
    EXPECT_EQ(layer_response(law, kSoft, 0.0).pressure, 0.0) << name(law);
    EXPECT_NEAR(layer_response(law, kSoft, 0.0).slope / confined_modulus(kSoft.E, kSoft.nu), 1.0, 1e-13) << name(law);
  }
}

// e = 0.5: linear M/2; logarithmic M ln 2; neo-Hookean with J = 1/2: mu (2 - 1/2) + 2 lambda ln 2.
TEST(SpringLaw, ValuesAtHalfStrain) {
  const double M = confined_modulus(kSoft.E, kSoft.nu), mu = kSoft.E / 2.9, lambda = M - 2 * mu;
  EXPECT_NEAR(layer_response(Law::Linear, kSoft, 0.5).pressure, M / 2, 1e-12 * M);
  EXPECT_NEAR(layer_response(Law::Logarithmic, kSoft, 0.5).pressure, M * std::log(2.0), 1e-12 * M);
  EXPECT_NEAR(layer_response(Law::NeoHookean, kSoft, 0.5).pressure, 1.5 * mu + 2 * lambda * std::log(2.0), 1e-12 * M);
}

TEST(SpringLaw, SlopeIsTheDerivativeAndLawsAreContinuousAtTheLimit) {
  for (Law law : kLaws) {
    for (double e : {0.01, 0.3, 0.89, 0.95, 1.5}) {
      const double d = 1e-6;
      const double numeric =
          (layer_response(law, kSoft, e + d).pressure - layer_response(law, kSoft, e - d).pressure) / (2 * d);
      EXPECT_NEAR(layer_response(law, kSoft, e).slope / numeric, 1.0, 1e-7) << name(law) << " at " << e;
    }
    const double below = layer_response(law, kSoft, kStrainLimit - 1e-12).pressure,
                 above = layer_response(law, kSoft, kStrainLimit + 1e-12).pressure;
    EXPECT_NEAR(above / below, 1.0, 1e-9) << name(law);
  }
}

TEST(SpringLaw, StrainAtPressureInverts) {
  for (Law law : kLaws)
    for (double e : {1e-9, 0.1, 0.5, 0.9, 1.3})
      EXPECT_NEAR(strain_at_pressure(law, kSoft, layer_response(law, kSoft, e).pressure) / e, 1.0, 1e-12)
          << name(law) << " at " << e;
}

TEST(SpringLaw, TwoLayersShareThePressureAndTheOverlap) {
  for (Law law : kLaws) {
    const double t_s = 1.2, t_t = 2.1, overlap = 0.7;
    const SpringResponse r = spring_response(law, kSoft, kStiff, t_s, t_t, overlap);
    EXPECT_NEAR(layer_response(law, kSoft, r.strain_source).pressure / r.pressure, 1.0, 1e-11) << name(law);
    EXPECT_NEAR(layer_response(law, kStiff, r.strain_target).pressure / r.pressure, 1.0, 1e-11) << name(law);
    EXPECT_NEAR(r.strain_source * t_s + r.strain_target * t_t, overlap, 1e-12) << name(law);
    const double d = 1e-6;
    const double per_overlap = (spring_response(law, kSoft, kStiff, t_s, t_t, overlap + d).pressure -
                                spring_response(law, kSoft, kStiff, t_s, t_t, overlap - d).pressure) /
                               (2 * d);
    const double per_t = (spring_response(law, kSoft, kStiff, t_s, t_t + d, overlap).pressure -
                          spring_response(law, kSoft, kStiff, t_s, t_t - d, overlap).pressure) /
                         (2 * d);
    EXPECT_NEAR(r.per_overlap / per_overlap, 1.0, 1e-7) << name(law);
    EXPECT_NEAR(-r.strain_target * r.per_overlap / per_t, 1.0, 1e-7) << name(law);
  }
}

// k = A / (t_s/M_s + t_t/M_t): springs in series (S5).
TEST(SpringLaw, LinearLayersInSeries) {
  const double M_s = confined_modulus(kSoft.E, kSoft.nu), M_t = confined_modulus(kStiff.E, kStiff.nu);
  EXPECT_NEAR(spring_response(Law::Linear, kSoft, kStiff, 1.0, 3.0, 0.2).pressure, 0.2 / (1.0 / M_s + 3.0 / M_t),
              1e-12);
}

TEST(SpringLaw, EqualLayersAreOneLayer) {
  for (Law law : kLaws) {
    const Elasticity almost{kSoft.E * (1 + 1e-10), kSoft.nu};  // through the branch for unequal layers
    const SpringResponse one = spring_response(law, kSoft, kSoft, 1.0, 2.0, 0.6),
                         two = spring_response(law, kSoft, almost, 1.0, 2.0, 0.6);
    EXPECT_NEAR(two.pressure / one.pressure, 1.0, 1e-9) << name(law);
    EXPECT_NEAR(two.strain_target / one.strain_target, 1.0, 1e-8) << name(law);
    EXPECT_NEAR(two.per_overlap / one.per_overlap, 1.0, 1e-8) << name(law);
  }
}

TEST(SpringLaw, AZeroLayerDropsOut) {
  for (Law law : kLaws)
    EXPECT_EQ(spring_response(law, kSoft, Elasticity{}, 2.0, 0.0, 0.5).pressure,
              layer_response(law, kSoft, 0.25).pressure)
        << name(law);
}

TEST(SpringLaw, OnlyCompressionCarries) {
  EXPECT_EQ(spring_response(Law::NeoHookean, kSoft, kSoft, 1.0, 1.0, -0.5).pressure, 0.0);
  EXPECT_EQ(spring_response(Law::NeoHookean, kSoft, kSoft, 1.0, 1.0, 0.0).pressure, 0.0);
}

}  // namespace dea::spring_law_test

#include "src/springs/layer_kernel.h"

#include <gtest/gtest.h>

#include <cmath>

namespace dea::layer_kernel_test {

double relative_error(const Elasticity& layer, LayerFit fit, double up_to) {
  const LayerLaw law = layer_law(layer, fit);
  double worst = 0.0;
  for (double s = 0.01; s <= up_to * (1 + 1e-12); s += 0.01)
    worst = std::max(worst, std::abs(law(s) / layer_compliance(layer, s) - 1));
  return worst;
}

/// (L1) as printed, in long double: right where nothing cancels or overflows.
double as_printed(double nu, double s) {
  const long double n = nu, x = s;
  return static_cast<double>(2 * (1 - n * n) / x * ((3 - 4 * n) * std::sinh(2 * x) - 2 * x) /
                             ((3 - 4 * n) * std::cosh(2 * x) + 2 * x * x + 5 - 12 * n + 8 * n * n));
}

// Softer than the bed of springs by 1.39, 1.84 and 2.07 at s = 0.5, 1 and 2 for nu = 0.45, then like 1/s.
TEST(LayerKernel, ValuesOfTheDesign) {
  const Elasticity layer{11.85, 0.45};
  const double M = confined_modulus(layer.E, layer.nu);
  EXPECT_NEAR(M * layer_compliance(layer, 0.5), 1.39, 0.005);
  EXPECT_NEAR(M * layer_compliance(layer, 1), 1.84, 0.005);
  EXPECT_NEAR(M * layer_compliance(layer, 2), 2.07, 0.005);
  const LayerLaw law = layer_law(layer, LayerFit::OneTerm);
  EXPECT_NEAR(law.beta[0], 1.603, 5e-4);
  EXPECT_NEAR(law.local * M * law.beta[0], 3.785, 5e-4);  // alpha
}

TEST(LayerKernel, IsTheFormulaWhereTheFormulaCanBeEvaluated) {
  for (double nu : {0.0, 0.2, 0.3, 0.45, 0.49})
    for (double s : {0.05, 0.2, 0.499, 0.501, 1.0, 3.0, 20.0})
      EXPECT_NEAR(layer_compliance({2.0, nu}, s) * 2.0 / as_printed(nu, s), 1, 1e-13) << nu << " " << s;
}

TEST(LayerKernel, LimitsOfLongAndShortWaves) {
  for (double nu : {0.0, 0.1, 0.25, 0.3, 0.45, 0.4999}) {
    const Elasticity layer{11.85, nu};
    EXPECT_NEAR(layer_compliance(layer, 0) * confined_modulus(layer.E, nu), 1, 1e-13);
    for (double s : {30.0, 1e3, 1e6})  // half-space
      EXPECT_NEAR(layer_compliance(layer, s) * layer.E * s / (2 * (1 - nu * nu)), 1, 1e-12) << nu << " " << s;
  }
  // continuous where the way of evaluation changes
  for (double nu : {0.3, 0.5})
    for (double s : {1e-8, 0.5})
      EXPECT_NEAR(layer_compliance({1, nu}, s * (1 - 1e-12)) / layer_compliance({1, nu}, s * (1 + 1e-12)), 1, 1e-11);
}

// Incompressible: the spring bed is rigid, and what is left of (L1) starts with s^2/2 * 3/E.
TEST(LayerKernel, NothingBlowsUpAtNuOneHalf) {
  const Elasticity layer{3.0, 0.5};
  EXPECT_EQ(layer_compliance(layer, 0), 0);
  for (double s : {1e-9, 1e-4}) EXPECT_NEAR(layer_compliance(layer, s) / (s * s / 3.0), 1, 1e-7);
  for (LayerFit fit : {LayerFit::OneTerm, LayerFit::TwoTerms}) {
    const LayerLaw at = layer_law(layer, fit), near = layer_law({3.0, 0.5 - 1e-9}, fit);
    EXPECT_EQ(at.confined, 0) << name(fit);
    EXPECT_TRUE(std::isfinite(at.local) && at.local > 0) << name(fit);
    for (double s : {0.1, 1.0, 10.0}) EXPECT_NEAR(at(s) / near(s), 1, 1e-6) << name(fit);
  }
}

// (law - exact)/M^-1 must be of fourth order in s when the first term is right, of sixth when the second is too.
TEST(LayerKernel, RationalLawHasTheFirstTermsOfTheSeries) {
  const auto order = [](double nu, LayerFit fit) {
    const Elasticity layer{1.0, nu};
    const LayerLaw law = layer_law(layer, fit);
    const auto error = [&](double s) { return std::abs(law(s) - layer_compliance(layer, s)); };
    return std::log2(error(0.04) / error(0.02));
  };
  for (double nu : {0.3, 0.35, 0.45, 0.49, 0.4999}) {
    EXPECT_NEAR(order(nu, LayerFit::OneTerm), 6, 0.05) << nu;
    EXPECT_NEAR(order(nu, LayerFit::TwoTerms), 4, 0.05) << nu;
  }
  for (double nu : {0.1, 0.2, 0.29}) EXPECT_NEAR(order(nu, LayerFit::OneTerm), 4, 0.05) << nu;
}

// Bounds are measured ones, rounded up: 1% for s <= 1 is what (L2) was chosen for; it holds at 0.3 (0.97%) and is
// missed by a hair at 0.4999 (1.03%). Beyond, one term runs into its constant while (L1) falls like 1/s; two terms
// follow it.
TEST(LayerKernel, RationalLawAgainstTheExactOne) {
  struct Row {
    double nu, one_to_1, one_to_2, one_to_3;
  };
  for (const Row& row : {Row{0.3, 0.010, 0.12, 0.38}, Row{0.4, 0.005, 0.08, 0.30}, Row{0.45, 0.002, 0.052, 0.25},
                         Row{0.49, 0.008, 0.023, 0.20}, Row{0.4999, 0.0105, 0.015, 0.185}}) {
    const Elasticity layer{11.85, row.nu};
    EXPECT_LT(relative_error(layer, LayerFit::OneTerm, 1), row.one_to_1) << row.nu;
    EXPECT_LT(relative_error(layer, LayerFit::OneTerm, 2), row.one_to_2) << row.nu;
    EXPECT_LT(relative_error(layer, LayerFit::OneTerm, 3), row.one_to_3) << row.nu;
  }
  for (double nu : {0.0, 0.1, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.48, 0.49, 0.4999, 0.5}) {
    EXPECT_LT(relative_error({11.85, nu}, LayerFit::TwoTerms, 1), 0.0085) << nu;
    EXPECT_LT(relative_error({11.85, nu}, LayerFit::TwoTerms, 3), 0.0135) << nu;
    EXPECT_LT(relative_error({11.85, nu}, LayerFit::TwoTerms, 10), 0.017) << nu;
  }
  for (double nu : {-0.99, -0.5, -0.1}) EXPECT_LT(relative_error({11.85, nu}, LayerFit::TwoTerms, 10), 0.12) << nu;
}

TEST(LayerKernel, RationalLawsArePositiveWithRealPoles) {
  for (LayerFit fit : {LayerFit::OneTerm, LayerFit::TwoTerms}) {
    for (double nu = -0.999; nu <= 0.5; nu += 0.001) {
      const LayerLaw law = layer_law({1, nu}, fit);
      double sum = law.local + law.square;
      for (std::size_t k = 0; k < static_cast<std::size_t>(law.terms); ++k) {
        EXPECT_GT(law.beta[k], 0) << nu;
        sum += law.weight[k];
      }
      EXPECT_NEAR(sum, law.confined, 1e-12) << nu;
      for (double s : {0.01, 0.3, 1.0, 3.0, 10.0, 100.0}) {
        EXPECT_GT(law(s), 0) << nu;
        EXPECT_LE(law(s), law.largest()) << nu;
      }
    }
  }
}

// (L9) about any state: a wave of any length on a layer softened by x = 1/M - 1/S6'(e) meets law(s) - b(s)^2 x > 0,
// with b the share of the wave's own pressure that stiffens; also in the limit x = 1/M of endless strain. One term has
// b = 1 and is not positive there: with it only the strains that a foot alone allows.
TEST(LayerKernel, LargeStrainStaysPositive) {
  for (double nu = 0; nu < 0.49995; nu += 0.0049) {
    const Elasticity layer{1, nu};
    const LayerLaw law = layer_law(layer, LayerFit::TwoTerms);
    for (const double strain : {0.1, 0.3, 0.5, 0.7, 0.9, 1.0}) {
      const double softening =
          law.confined - (strain < 1 ? 1 / layer_response(Law::NeoHookean, layer, strain).slope : 0.0);
      EXPECT_GE(softening, 0);
      for (double s = 0; s < 60; s = 1.02 * s + 0.005) {
        const double share = law.own_share + (1 - law.own_share) / (1 + law.beta[1] * s * s);
        const double left = (law(s) - share * share * softening) / law(s);
        EXPECT_TRUE(strain < 1 ? left > 1e-3 : left > -1e-9) << "nu " << nu << " strain " << strain << " s " << s;
      }
    }
  }
  // with more of a foot's own pressure it would not hold: law.own_share is no accident
  const LayerLaw law = layer_law({1, 0.0}, LayerFit::TwoTerms);
  EXPECT_LT(law(60) - 0.4 * 0.4 * law.confined, law(60) - law.own_share * law.own_share * law.confined);
  EXPECT_LT(law(60), 0.4 * 0.4 * law.confined);
  for (const double nu : {-0.9, -0.5, -0.1}) EXPECT_EQ(layer_law({1, nu}, LayerFit::TwoTerms).own_share, 0);
}

// What a free edge adds is no less than nothing, nothing with one term, and per E.
TEST(LayerKernel, FreeEdges) {
  for (const double nu : {-0.5, 0.0, 0.2, 0.3, 0.45, 0.5}) {
    const EdgeLaw edge = edge_law({2, nu}, LayerFit::TwoTerms), twice = edge_law({4, nu}, LayerFit::TwoTerms);
    for (const double EdgeLaw::*value : {&EdgeLaw::straight, &EdgeLaw::curved, &EdgeLaw::around, &EdgeLaw::own}) {
      EXPECT_GE(edge.*value, 0);
      EXPECT_NEAR(twice.*value, edge.*value / 2, 1e-15);
      EXPECT_EQ(edge_law({2, nu}, LayerFit::OneTerm).*value, 0);
    }
    // an even load sinks a half-line's end by 0.52 t p/E more: sum of what the three add there
    const LayerLaw law = layer_law({2, nu}, LayerFit::TwoTerms);
    EXPECT_NEAR(2 * (edge.own + edge.around / (4 * std::sqrt(law.beta[1])) + edge.straight / std::sqrt(law.beta[0])),
                0.52, nu > 0 ? 1e-12 : 0.15);
  }
}

}  // namespace dea::layer_kernel_test

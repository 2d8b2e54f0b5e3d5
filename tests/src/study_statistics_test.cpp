// The numbers of a study: on paper, by scipy (study_statistics_numbers.py), and what must not change them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "src/base/error.h"
#include "src/study/dose.h"
#include "src/study/influence.h"
#include "src/study/mean_map.h"
#include "src/study/pairs.h"
#include "src/study/plan.h"
#include "src/study/regions.h"
#include "src/study/summary.h"

#include "tests/src/study_statistics_numbers.h"

namespace dea::study_statistics_test {

using Values = std::vector<double>;

template <std::size_t n>
Values list(const double (&values)[n]) {
  return Values(values, values + n);
}

void expect_near(const Values& found, const Values& expected, double tolerance) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], tolerance) << i;
}

Values changed(Values values, const std::function<double(double)>& f) {
  std::transform(values.begin(), values.end(), values.begin(), f);
  return values;
}

/// 53 bits of a generator as a number in [0, 1).
double unit(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

Values random_values(int count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Values values;
  for (int i = 0; i < count; ++i) values.push_back(unit(random));
  return values;
}

std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const UsageError& e) {
    return e.what();
  }
  return "not refused";
}

// ------------------------------------------------------------------------------------------------- boxes and bands

TEST(StudyStatistics, QuartilesMeanAndDeviationAreScipys) {
  const BoxPlot b = box_plot(list(test::kFirst));
  expect_near({b.q1, b.median, b.q3}, list(test::kQuartiles), 1e-12);
  EXPECT_NEAR(b.mean, test::kMean[0], 1e-12);
  EXPECT_NEAR(b.standard_deviation, test::kDeviation[0], 1e-12);
  EXPECT_EQ(b.count, std::size(test::kFirst));
}

TEST(StudyStatistics, WhiskersReachOneAndAHalfBoxes) {
  const BoxPlot b = box_plot({100, 3, 1, 4, 2, -1});
  // sorted -1 1 2 3 4 100: q1 at rank 1.25, q3 at rank 3.75; reach 1.5 * 2.5 = 3.75
  EXPECT_EQ(b.q1, 1.25);
  EXPECT_EQ(b.median, 2.5);
  EXPECT_EQ(b.q3, 3.75);
  EXPECT_EQ(b.lower_whisker, -1);
  EXPECT_EQ(b.upper_whisker, 4);
  EXPECT_EQ(b.outliers, (std::vector<std::size_t>{0}));
  EXPECT_EQ(b.largest, 100);
}

TEST(StudyStatistics, AWhiskerStartsAtItsBox) {
  const BoxPlot b =
      box_plot({0, 100, 100, 100});  // q1 = 75, fence 37.5: the nearest value inside is above the quartile
  EXPECT_EQ(b.q1, 75);
  EXPECT_EQ(b.lower_whisker, 75);
  EXPECT_EQ(b.outliers, (std::vector<std::size_t>{0}));
}

TEST(StudyStatistics, FailedCasesAreLeftOutAndCounted) {
  const BoxPlot b = box_plot({kNaN, 1, kInfinity, 2, 3, -kInfinity, 50});
  EXPECT_EQ(b.count, 4u);
  EXPECT_EQ(b.left_out, 3u);
  EXPECT_EQ(b.outliers, (std::vector<std::size_t>{6}));
  EXPECT_EQ(b.mean, 14);
  const BoxPlot none = box_plot({kNaN});
  EXPECT_EQ(none.left_out, 1u);
  EXPECT_TRUE(std::isnan(none.median) && std::isnan(none.mean) && std::isnan(none.lower_whisker));
  const BoxPlot one = box_plot({7});
  EXPECT_EQ(one.q1, 7);
  EXPECT_EQ(one.upper_whisker, 7);
  EXPECT_TRUE(std::isnan(one.standard_deviation));
}

TEST(StudyStatistics, TheOrderOfCasesChangesNoBit) {
  Values values = random_values(1000, 3);
  const BoxPlot before = box_plot(values);
  std::reverse(values.begin(), values.begin() + 700);
  const BoxPlot after = box_plot(values);
  EXPECT_EQ(before.mean, after.mean);
  EXPECT_EQ(before.standard_deviation, after.standard_deviation);
  EXPECT_EQ(before.q1, after.q1);
}

TEST(StudyStatistics, ABoxGoesWithItsUnits) {
  const Values mpa = list(test::kFirst);
  const BoxPlot a = box_plot(mpa), b = box_plot(changed(mpa, [](double x) { return 1e6 * x + 5e5; }));
  EXPECT_NEAR(b.median, 1e6 * a.median + 5e5, 1e-6);
  EXPECT_NEAR(b.upper_whisker, 1e6 * a.upper_whisker + 5e5, 1e-6);
  EXPECT_NEAR(b.standard_deviation, 1e6 * a.standard_deviation, 1e-6);
  EXPECT_EQ(a.outliers, b.outliers);
}

TEST(StudyStatistics, EqualValuesHaveTheirMeanAndNoDeviation) {
  const Moments m = moments(Values(10, 0.1));
  EXPECT_EQ(m.mean, 0.1);
  EXPECT_EQ(m.standard_deviation, 0);
}

TEST(StudyStatistics, BandsOverACycleAreThoseOfEachInstant) {
  const std::vector<Values> lines = {{1, 2, kNaN}, {3, 2, kNaN}, {5, kNaN, kNaN}};
  const CycleBand band = cycle_band(lines, 0.25, 0.75);
  EXPECT_EQ(band.count, (std::vector<std::size_t>{3, 2, 0}));
  EXPECT_EQ(band.mean[0], 3);
  EXPECT_EQ(band.standard_deviation[0], 2);
  EXPECT_EQ(band.low[0], 2);  // ranks 0.5 and 1.5 of 1, 3, 5
  EXPECT_EQ(band.high[0], 4);
  EXPECT_EQ(band.median[1], 2);
  EXPECT_TRUE(std::isnan(band.mean[2]) && std::isnan(band.low[2]));
  const CycleBand tenths = cycle_band(
      [] {
        std::vector<Values> one_instant;
        for (double x : test::kFirst) one_instant.push_back({x});
        return one_instant;
      }(),
      0.1, 0.9);
  expect_near({tenths.low[0], tenths.high[0]}, list(test::kTenths), 1e-12);
}

TEST(StudyStatistics, LinesAreCarriedToOtherInstants) {
  const Values percent = percent_of_cycle({2, 3, 6});
  EXPECT_EQ(percent, (Values{0, 25, 100}));
  const Values y = at_instants(percent, {10, 20, 80}, {0, 12.5, 25, 75, 100});
  EXPECT_EQ(y, (Values{10, 15, 20, 60, 80}));
  const Values holes = at_instants({0, 1, 2}, {1, kNaN, 3}, {-1, 0, 0.5, 2, 2.1, kNaN});
  EXPECT_EQ(holes[1], 1);
  EXPECT_EQ(holes[3], 3);
  for (std::size_t i : {0u, 2u, 4u, 5u}) EXPECT_TRUE(std::isnan(holes[i])) << i;
}

// --------------------------------------------------------------------------------------------------------- pairs

PairedDifference difference_of(const Values& first, const Values& second) {
  return paired_difference(complete_pairs(first, second));
}

TEST(StudyStatistics, PairedDifferencesAreScipys) {
  const PairedDifference d = difference_of(list(test::kFirst), list(test::kSecond));
  EXPECT_NEAR(d.mean, test::kPairedMean[0], 1e-12);
  expect_near({d.mean_interval.low, d.mean_interval.high}, list(test::kPairedInterval), 1e-11);
  EXPECT_NEAR(d.median, test::kPairedMedian[0], 1e-12);
}

TEST(StudyStatistics, LimitsOfAgreementAreScipys) {
  const PairedDifference b = difference_of(list(test::kFirst), list(test::kSecond));
  expect_near({b.limits.low, b.limits.high}, list(test::kLimits), 1e-11);
  expect_near({b.lower_limit_interval.low, b.lower_limit_interval.high, b.upper_limit_interval.low,
               b.upper_limit_interval.high},
              list(test::kLimitIntervals), 1e-11);
}

// Bland and Altman 1986, table 1: peak flow of 17 subjects by two meters. The paper has the mean difference -2.1, its
// standard deviation 38.8, the interval -22.0 to 17.8 of the mean, and with 2 s for 1.96 s the limits -79.7 and 75.5,
// each with a standard error sqrt(3 / 17) s = 16.3. With 1.96: -2.1 -+ 76.0, sqrt(1 / 17 + 1.96^2 / 32) = 0.4229 for
// 0.4201, so 16.4; Student's t with 16 degrees of freedom is 2.12.
TEST(StudyStatistics, LimitsOfAgreementOfBlandAndAltmansPeakFlows) {
  const Values wright = {494, 395, 516, 434, 476, 557, 413, 442, 650, 433, 417, 656, 267, 478, 178, 423, 427};
  const Values mini = {512, 430, 520, 428, 500, 600, 364, 380, 658, 445, 432, 626, 260, 477, 259, 350, 451};
  const PairedDifference b = difference_of(wright, mini);
  EXPECT_NEAR(b.mean, -2.1, 0.05);
  EXPECT_NEAR(b.standard_deviation, 38.8, 0.05);
  EXPECT_NEAR(b.mean_interval.low, -22.0, 0.1);
  EXPECT_NEAR(b.mean_interval.high, 17.8, 0.1);
  EXPECT_NEAR(b.limits.low, -78.1, 0.1);
  EXPECT_NEAR(b.limits.high, 73.9, 0.1);
  EXPECT_NEAR(b.lower_limit_interval.low, -78.1 - 2.12 * 16.4, 0.2);
  EXPECT_NEAR(b.upper_limit_interval.high, 73.9 + 2.12 * 16.4, 0.2);
}

TEST(StudyStatistics, PairsGoWithTheirUnitsAndSides) {
  const Values a = list(test::kFirst), b = list(test::kSecond);
  const auto pascal = [](double x) { return 1e6 * x; };
  const PairedDifference mpa = difference_of(a, b), pa = difference_of(changed(a, pascal), changed(b, pascal));
  EXPECT_NEAR(pa.upper_limit_interval.high, 1e6 * mpa.upper_limit_interval.high, 1e-5);
  const PairedDifference turned = difference_of(b, a);
  EXPECT_NEAR(turned.mean, -mpa.mean, 1e-14);
  EXPECT_NEAR(turned.limits.low, -mpa.limits.high, 1e-14);
  EXPECT_NEAR(pa.effect.d, mpa.effect.d, 1e-13);
}

TEST(StudyStatistics, EffectSizesAreScipys) {
  const Values a = list(test::kFirst), b = list(test::kSecond);
  const EffectSize paired = difference_of(a, b).effect,
                   groups = mean_difference(a, Values(b.begin(), b.begin() + 15)).effect;
  EXPECT_NEAR(paired.d, test::kPairedDz[0], 1e-12);
  EXPECT_NEAR(groups.d, test::kCohenD[0], 1e-12);
  EXPECT_NEAR(paired.corrected, test::kPairedDz[0] * test::kHedges[2], 1e-12);  // 22 degrees of freedom
  EXPECT_NEAR(groups.corrected, test::kCohenD[0] * test::kHedges[3], 1e-12);    // 36
  expect_near({hedges_correction(2), hedges_correction(5)}, {test::kHedges[0], test::kHedges[1]}, 1e-13);
  EXPECT_TRUE(std::isnan(hedges_correction(1)));
  // {1, 2, 3} and {3, 4, 5, 6}: squares 2 and 5 over 5 degrees of freedom
  EXPECT_NEAR(mean_difference({1, 2, 3}, {3, 4, 5, 6}).effect.d, (2 - 4.5) / std::sqrt(7.0 / 5), 1e-14);
  EXPECT_NEAR(mean_difference({1, 2, 3}, {5}).effect.d, -3, 1e-14);  // all spread is that of the first
}

TEST(StudyStatistics, DifferencesOfGroupsAreWelchs) {
  const Values a = list(test::kFirst), all = list(test::kSecond), b(all.begin(), all.begin() + 15);
  const MeanDifference d = mean_difference(a, b);
  EXPECT_NEAR(d.mean, moments(a).mean - moments(b).mean, 1e-14);
  const MeanDifference turned = mean_difference(b, a);
  EXPECT_NEAR(turned.interval.low, -d.interval.high, 1e-13);
  // {1, 3} and {5, 7}: v = 1 and 1, two degrees of freedom, whose t is algebraic; {1, 3} and {2, 6}: v = 1 and 4
  const MeanDifference alike = mean_difference({5, 7}, {1, 3});
  const double t2 = 0.95 * std::sqrt(2 / (1 - 0.95 * 0.95));
  expect_near({alike.interval.low, alike.interval.high}, {4 - t2 * std::sqrt(2), 4 + t2 * std::sqrt(2)}, 1e-12);
  // 25 / 17 degrees of freedom, whose t is scipy.stats.t.ppf(0.975, 25 / 17)
  const MeanDifference unlike = mean_difference({1, 3}, {2, 6});
  EXPECT_NEAR(unlike.interval.high - unlike.mean, 6.1881149408 * std::sqrt(5), 1e-8);
  // {1, 3} and {5, 5, 5}: v = 1 and 0, one degree of freedom: Cauchy's
  const MeanDifference one = mean_difference({1, kNaN, 3}, {5, 5, 5});
  EXPECT_EQ(one.count[0], 2u);
  EXPECT_NEAR(one.interval.high - one.mean, std::tan(0.475 * kPi), 1e-9);
  EXPECT_TRUE(std::isnan(mean_difference({1}, {2, 3}).interval.low));
  EXPECT_TRUE(std::isnan(mean_difference({1, 1}, {2, 2}).interval.low));
  EXPECT_TRUE(std::isnan(mean_difference({}, {2, 3}).mean));
}

TEST(StudyStatistics, PairsOfFailedCasesAreLeftOut) {
  const Values a = {1, kNaN, 3, 4, 7}, b = {0, 1, kNaN, 2, 4};
  const PairedDifference d = difference_of(a, b);
  EXPECT_EQ(d.pairs, 3u);
  EXPECT_EQ(d.left_out, 2u);
  EXPECT_EQ(d.mean, 2);
  EXPECT_EQ(complete_pairs(a, b).second, (Values{0, 2, 4}));
  const PairedDifference one = difference_of({3}, {1});
  EXPECT_EQ(one.mean, 2);
  EXPECT_TRUE(std::isnan(one.mean_interval.low));
  EXPECT_TRUE(std::isnan(difference_of({}, {}).limits.low));
  EXPECT_TRUE(std::isnan(difference_of({2, 3}, {1, 2}).effect.d));  // differences that do not vary
  EXPECT_TRUE(std::isnan(mean_difference({1}, {2}).effect.d));
}

// ------------------------------------------------------------------------------------- regression, ranks, slopes

TEST(StudyStatistics, RegressionIsNumpys) {
  Values product;
  for (std::size_t i = 0; i < std::size(test::kFirst); ++i) product.push_back(test::kFirst[i] * test::kThird[i]);
  const Regression fit = regression({list(test::kFirst), list(test::kThird), product}, list(test::kSecond));
  expect_near(fit.coefficients, list(test::kRegression), 1e-11);
  EXPECT_NEAR(fit.r_squared, test::kRSquared[0], 1e-12);
}

TEST(StudyStatistics, RegressionKnowsNoUnitsAndNoOrder) {
  const std::vector<Values> x = {random_values(200, 1), random_values(200, 2)};
  Values y;
  for (std::size_t i = 0; i < 200; ++i) y.push_back(3 * x[0][i] - x[1][i] * x[1][i]);
  const Regression fit = regression(x, y);
  Regression other = regression({changed(x[0], [](double v) { return 273.15 + 100 * v; }), x[1]},
                                changed(y, [](double v) { return -1e6 * v + 4; }));
  expect_near(other.coefficients, {-fit.coefficients[0], -fit.coefficients[1]}, 1e-11);
  EXPECT_NEAR(other.r_squared, fit.r_squared, 1e-12);
  const auto reversed = [](Values v) { return Values(v.rbegin(), v.rend()); };
  other = regression({reversed(x[0]), reversed(x[1])}, reversed(y));
  expect_near(other.coefficients, fit.coefficients, 1e-12);
}

// Independent factors with equal spread: b_k^2 is c_k^2 / sum of c^2.
TEST(StudyStatistics, CoefficientsOfALinearModelAreItsShares) {
  std::vector<Values> x(2);
  Values y;
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j) {
      x[0].push_back(i);
      x[1].push_back(j);
      y.push_back(3 * i - 4 * j + 10);
    }
  const Regression fit = regression(x, y);
  expect_near(fit.coefficients, {0.6, -0.8}, 1e-13);
  EXPECT_NEAR(fit.r_squared, 1, 1e-13);
}

TEST(StudyStatistics, FactorsThatOthersMakeUpHaveNoCoefficient) {
  const std::vector<Values> x = {random_values(60, 4), random_values(60, 5)};
  Values y, copy;
  for (std::size_t i = 0; i < 60; ++i) {
    y.push_back(x[0][i] + 2 * x[1][i] + 0.1 * std::sin(40.0 * x[0][i]));
    copy.push_back(5 - 2 * x[0][i]);
  }
  const Regression alone = regression(x, y), fit = regression({x[0], copy, x[1], Values(60, 0.1)}, y);
  EXPECT_TRUE(std::isnan(fit.coefficients[0]) && std::isnan(fit.coefficients[1]) && std::isnan(fit.coefficients[3]));
  EXPECT_NEAR(fit.coefficients[2], alone.coefficients[1], 1e-10);
  EXPECT_NEAR(fit.r_squared, alone.r_squared, 1e-10);
}

TEST(StudyStatistics, RegressionLeavesOutFailedCases) {
  std::vector<Values> x = {random_values(30, 6), random_values(30, 7)};
  Values y;
  for (std::size_t i = 0; i < 30; ++i) y.push_back(x[0][i] * x[1][i]);
  const Regression whole = regression(x, y);
  for (Values* v : {&x[0], &x[1], &y}) v->insert(v->begin() + 3, 1e3);
  y[3] = kNaN;
  const Regression fit = regression(x, y);
  EXPECT_EQ(fit.cases, 30u);
  EXPECT_EQ(fit.left_out, 1u);
  EXPECT_EQ(fit.coefficients, whole.coefficients);
  const Regression few = regression({{1, 2, 4}, {1, 3, 2}}, {1, 2, 3});
  EXPECT_TRUE(std::isnan(few.coefficients[0]) && std::isnan(few.r_squared));
  const Regression constant = regression({random_values(9, 1)}, Values(9, 0.3));
  EXPECT_TRUE(std::isnan(constant.coefficients[0]) && std::isnan(constant.r_squared));
}

TEST(StudyStatistics, RankCorrelationWithTiesIsScipys) {
  EXPECT_NEAR(rank_correlation(list(test::kFirst), list(test::kSecond)), test::kSpearman[0], 1e-13);
  EXPECT_NEAR(rank_correlation(list(test::kThird), list(test::kSecond)), test::kSpearman[1], 1e-13);
  EXPECT_EQ(ranks(list(test::kThird)), list(test::kRanks));
}

TEST(StudyStatistics, RanksKnowOnlyOrder) {
  const Values x = random_values(50, 8);
  EXPECT_EQ(rank_correlation(x, changed(x, [](double v) { return std::exp(5 * v); })), 1);
  EXPECT_EQ(rank_correlation(x, changed(x, [](double v) { return -v * v * v; })), -1);
  EXPECT_EQ(rank_correlation({1, 2, 3, 4}, {2, kNaN, 4, 9}), 1);
  EXPECT_TRUE(std::isnan(rank_correlation({1, 1, 1}, {1, 2, 3})));
  EXPECT_EQ(ranks({kNaN}).size(), 1u);
}

/// At each value of the one factor that there is.
std::vector<Slope> slopes(const Values& x, const Values& y) {
  std::vector<Slope> all;
  for (std::size_t base = 0; base < x.size(); ++base) all.push_back(slopes_about({x}, y, base).at(0).value());
  return all;
}

TEST(StudyStatistics, SlopesOfAParabolaAreExactInside) {
  const Values x = {4, 0, 1, 7, 2};  // any order, unequal steps
  const std::vector<Slope> s = slopes(x, changed(x, [](double v) { return v * v; }));
  for (std::size_t i : {0u, 2u, 4u}) {
    EXPECT_EQ(s[i].kind, Slope::Kind::Central);
    EXPECT_NEAR(s[i].value, 2 * x[i], 1e-14);
  }
  EXPECT_EQ(s[1].kind, Slope::Kind::Forward);
  EXPECT_EQ(s[1].value, 1);
  EXPECT_EQ(s[3].kind, Slope::Kind::Backward);
  EXPECT_EQ(s[3].value, 11);
}

TEST(StudyStatistics, SlopesBesideAFailedCaseAreOneSided) {
  const std::vector<Slope> s = slopes({0, 1, 2, 3, 4}, {0, 1, kNaN, 9, kNaN});
  EXPECT_EQ(s[1].kind, Slope::Kind::Backward);
  EXPECT_EQ(s[1].value, 1);
  EXPECT_EQ(s[2].kind, Slope::Kind::None);
  EXPECT_TRUE(std::isnan(s[2].value));
  EXPECT_EQ(s[3].kind, Slope::Kind::None);
}

TEST(StudyStatistics, OneFactorAtATimeAboutABase) {
  // base (1, 10); two more of the first factor, one of the second, one that differs in both
  const std::vector<Values> x = {{2, 1, 0, 1, 0}, {10, 10, 10, 30, 30}};
  const auto slopes = slopes_about(x, {7, 4, 3, kNaN, 0}, 1);
  EXPECT_EQ(slopes[0]->kind, Slope::Kind::Central);
  EXPECT_EQ(slopes[0]->value, 2);
  EXPECT_EQ(slopes[1]->kind, Slope::Kind::None);  // the neighbour failed
  EXPECT_FALSE(slopes_about({{1, 2}, {5, 5}}, {3, 4}, 0)[1]);
}

// ------------------------------------------------------------------------------------------------ Sobol indices

using Function = std::function<double(const Values&)>;

/// Outputs of Saltelli's design: A, B, AB_1 .. AB_d, of random points.
Values saltelli_outputs(const Function& f, std::size_t d, std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Values> a(count, Values(d)), b = a;
  for (std::vector<Values>* points : {&a, &b})
    for (Values& point : *points)
      for (double& x : point) x = unit(random);
  Values outputs;
  for (const Values& point : a) outputs.push_back(f(point));
  for (const Values& point : b) outputs.push_back(f(point));
  for (std::size_t i = 0; i < d; ++i)
    for (std::size_t j = 0; j < count; ++j) {
      Values mixed = a[j];
      mixed[i] = b[j][i];
      outputs.push_back(f(mixed));
    }
  return outputs;
}

/// Ishigami's function, x uniform in -pi to pi: sin x1 + a sin^2 x2 + b x3^4 sin x1.
constexpr double kA = 7, kB = 0.1;
double ishigami(const Values& u) {
  const auto x = [&](std::size_t i) { return kPi * (2 * u[i] - 1); };
  return std::sin(x(0)) + kA * std::pow(std::sin(x(1)), 2) + kB * std::pow(x(2), 4) * std::sin(x(0));
}

/// Its variance is that of x1 alone, 1/2 (1 + b E[x3^4])^2 with E[x3^4] = pi^4 / 5; of x2 alone, a^2 Var(sin^2) = a^2 /
/// 8; and of x1 with x3, b^2 / 2 Var(x3^4) with Var(x3^4) = pi^8 (1 / 9 - 1 / 25).
struct Known {
  double first[3], total[3];
};
Known ishigami_indices() {
  const double pi4 = std::pow(kPi, 4);
  const double v1 = 0.5 * std::pow(1 + kB * pi4 / 5, 2), v2 = kA * kA / 8;
  const double v13 = 0.5 * kB * kB * pi4 * pi4 * (1.0 / 9 - 1.0 / 25), v = v1 + v2 + v13;
  return {{v1 / v, v2 / v, 0}, {(v1 + v13) / v, v2 / v, v13 / v}};
}

/// Root mean square error of all six over random designs.
double ishigami_error(std::size_t count, int designs) {
  const Known known = ishigami_indices();
  double squares = 0.0;
  for (int seed = 1; seed <= designs; ++seed) {
    const Values outputs = saltelli_outputs(ishigami, 3, count, static_cast<std::uint64_t>(seed));
    const std::vector<SobolIndex> found = sobol_indices(outputs, 3, {.resamples = 0});
    for (std::size_t i = 0; i < 3; ++i)
      squares += std::pow(found[i].first - known.first[i], 2) + std::pow(found[i].total - known.total[i], 2);
  }
  return std::sqrt(squares / (6 * designs));
}

TEST(StudyStatistics, IshigamisIndices) {
  const Known known = ishigami_indices();
  EXPECT_NEAR(known.first[0], 0.3139, 5e-5);  // as they are quoted
  EXPECT_NEAR(known.total[2], 0.2437, 5e-5);
  const std::vector<SobolIndex> found = sobol_indices(saltelli_outputs(ishigami, 3, 1 << 17, 1), 3, {.resamples = 0});
  for (std::size_t i = 0; i < 3; ++i) {
    // errors are about 1.5 / sqrt(N) = 0.004; three times that
    EXPECT_NEAR(found[i].first, known.first[i], 0.0125) << i;
    EXPECT_NEAR(found[i].total, known.total[i], 0.0125) << i;
    EXPECT_TRUE(std::isnan(found[i].first_interval.low));
  }
}

TEST(StudyStatistics, IndicesOfTheDesignThatStudiesHave) {
  const Known known = ishigami_indices();
  Values outputs;
  for (const Values& point : unit_points(Design::Saltelli, 3, 4096, 1)) outputs.push_back(ishigami(point));
  const std::vector<SobolIndex> found = sobol_indices(outputs, 3, {.resamples = 0});
  for (std::size_t i = 0; i < 3; ++i) {
    // random rows would err by 1.5 / sqrt(4096) = 0.02: these are more even
    EXPECT_NEAR(found[i].first, known.first[i], 0.01) << i;
    EXPECT_NEAR(found[i].total, known.total[i], 0.01) << i;
  }
}

TEST(StudyStatistics, IndicesConvergeWithTheRootOfRandomRows) {
  // 16 times the rows, a quarter of the error; the ratio of two root mean squares of 60 designs is known to a tenth
  EXPECT_NEAR(ishigami_error(128, 60) / ishigami_error(2048, 60), 4, 1.2);
}

TEST(StudyStatistics, NineteenOfTwentyBootstrapIntervalsHoldTheIndex) {
  const Known known = ishigami_indices();
  int held = 0;
  constexpr int kDesigns = 60;
  for (std::uint64_t seed = 1; seed <= kDesigns; ++seed) {
    const std::vector<SobolIndex> found =
        sobol_indices(saltelli_outputs(ishigami, 3, 512, seed), 3, {.resamples = 200});
    for (std::size_t i = 0; i < 3; ++i) {
      const SobolIndex& f = found[i];
      if (f.first_interval.low <= known.first[i] && known.first[i] <= f.first_interval.high) ++held;
      if (f.total_interval.low <= known.total[i] && known.total[i] <= f.total_interval.high) ++held;
      EXPECT_LT(f.first_interval.low, f.first);
      EXPECT_GT(f.total_interval.high, f.total);
    }
  }
  // 342 of 360; the six of a design hang together, so the spread is up to sqrt(6) sqrt(360 * 0.95 * 0.05) = 10
  EXPECT_NEAR(held, 0.95 * 6 * kDesigns, 20);
}

TEST(StudyStatistics, BootstrapHasTheSameBitsEverywhere) {
  const std::vector<SobolIndex> found = sobol_indices(list(test::kDesign), 2, {.resamples = 50, .seed = 7});
  Values bits;
  for (const SobolIndex& f : found)
    for (double x :
         {f.first, f.total, f.first_interval.low, f.first_interval.high, f.total_interval.low, f.total_interval.high})
      bits.push_back(x);
  EXPECT_EQ(bits, list(test::kBootstrapped));
  const std::vector<SobolIndex> other = sobol_indices(list(test::kDesign), 2, {.resamples = 50, .seed = 8});
  EXPECT_EQ(other[0].first, found[0].first);
  EXPECT_NE(other[0].first_interval.low, found[0].first_interval.low);
}

TEST(StudyStatistics, IndicesKnowNoUnits) {
  const Values mpa = saltelli_outputs(ishigami, 3, 256, 2);
  const std::vector<SobolIndex> a = sobol_indices(mpa, 3),
                                b = sobol_indices(changed(mpa, [](double y) { return 1e8 - 1e6 * y; }), 3);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(a[i].first, b[i].first, 1e-10);
    EXPECT_NEAR(a[i].total_interval.high, b[i].total_interval.high, 1e-10);
  }
}

TEST(StudyStatistics, RowsThatFailedAreLeftOutOfTheirFactor) {
  constexpr std::size_t n = 64;
  Values outputs = saltelli_outputs(ishigami, 3, n, 3);
  const auto without_row = [&](std::size_t row) {
    Values kept;
    for (std::size_t i = 0; i < outputs.size(); ++i)
      if (i % n != row) kept.push_back(outputs[i]);
    return sobol_indices(kept, 3);
  };
  const std::vector<SobolIndex> whole = sobol_indices(outputs, 3), without = without_row(9);
  outputs[3 * n + 9] = kNaN;  // AB_2
  const std::vector<SobolIndex> one = sobol_indices(outputs, 3);
  EXPECT_EQ(one[0].first, whole[0].first);
  EXPECT_EQ(one[1].first, without[1].first);
  EXPECT_EQ(one[1].total_interval.low, without[1].total_interval.low);
  EXPECT_EQ(one[1].left_out, 1u);
  EXPECT_EQ(one[1].rows, n - 1);
  outputs[9] = kInfinity;  // A, which all factors need
  const std::vector<SobolIndex> all = sobol_indices(outputs, 3);
  EXPECT_EQ(all[2].total, without[2].total);
}

TEST(StudyStatistics, NoIndexWithoutVarianceOrRows) {
  const std::vector<SobolIndex> constant = sobol_indices(Values(5 * 10, 0.1), 3);
  EXPECT_TRUE(std::isnan(constant[0].first) && std::isnan(constant[2].total_interval.low));
  const std::vector<SobolIndex> failed = sobol_indices(Values(3 * 10, kNaN), 1);
  EXPECT_EQ(failed[0].rows, 0u);
  EXPECT_TRUE(std::isnan(failed[0].total));
}

// ---------------------------------------------------------------------------------------------------------- dose

TEST(StudyStatistics, DoseOfAConstantPressure) {
  const Dose dose = cycle_dose({0, 0.5, 2}, {{3, 1}, {3, 1}, {3, 1}}, 1.0);
  EXPECT_EQ(dose.exposure, (Values{6, 2}));
  EXPECT_EQ(dose.overpressure, (Values{4, 0}));
}

// From 0 to P and back within T: the part above p_d is a triangle of height P - p_d and width T (P - p_d) / P.
TEST(StudyStatistics, DoseOfATriangleWaveIsExactWhereItCrosses) {
  const double P = 5, T = 1.2, threshold = 2;
  const Dose dose = cycle_dose({0, 0.7, T}, {{0}, {P}, {0}}, threshold);  // one flank steeper
  EXPECT_NEAR(dose.exposure[0], 0.5 * P * T, 1e-14);
  EXPECT_NEAR(dose.overpressure[0], 0.5 * T * (P - threshold) * (P - threshold) / P, 1e-14);
}

TEST(StudyStatistics, DoseConvergesWithTheSquareOfTheStep) {
  // p = sin(pi t) above 1/2, from t = 1/6 to 5/6: sqrt(3) / pi - 1/3
  const auto error = [](int n) {
    Values times;
    std::vector<Values> p;
    for (int i = 0; i <= n; ++i) {
      times.push_back(static_cast<double>(i) / n);
      p.push_back({std::sin(kPi * times.back())});
    }
    return std::abs(cycle_dose(times, p, 0.5).overpressure[0] - (std::sqrt(3.0) / kPi - 1.0 / 3));
  };
  EXPECT_NEAR(std::log2(error(60) / error(240)) / 2, 2, 0.1);
}

TEST(StudyStatistics, DoseOverYears) {
  // Russell et al.: 2 million cycles a year for 20 years, of a second each: 4e7 s
  const LoadingHistory history = {1.0, 2e6, 20};
  const double years = 4e7 / (365.25 * 24 * 3600);
  const Dose dose = chronic_dose({0, 1}, {{3, 1}, {3, 1}}, 2.0, history);
  EXPECT_NEAR(dose.overpressure[0], 1 * years, 1e-12);
  EXPECT_NEAR(dose.exposure[0], 3 * years, 1e-12);
  EXPECT_EQ(dose.overpressure[1], 0);
  const Dose model_time = chronic_dose({2, 9}, {{3, 1}, {3, 1}}, 2.0, history);  // a model's time is any
  EXPECT_NEAR(model_time.overpressure[0], dose.overpressure[0], 1e-12);
  // twice as long a cycle, half as often
  EXPECT_NEAR(chronic_dose({0, 1}, {{3}, {3}}, 2.0, {2.0, 1e6, 20}).exposure[0], dose.exposure[0], 1e-12);
}

TEST(StudyStatistics, DoseOfAPlaceWithAHoleIsNone) {
  const Dose dose = cycle_dose({0, 1, 2}, {{1, 1}, {kNaN, 1}, {1, 1}}, 0.5);
  EXPECT_TRUE(std::isnan(dose.exposure[0]) && std::isnan(dose.overpressure[0]));
  EXPECT_EQ(dose.overpressure[1], 1);
}

TEST(StudyStatistics, ShareOfTheAreaAbove) {
  EXPECT_EQ(share_above({1, 2, 3, kNaN}, {1, 1, 2, 100}, 2), 0.5);  // 2 is not above 2
  EXPECT_TRUE(std::isnan(share_above({}, {}, 1)));
}

// ---------------------------------------------------------------------------------------------------------- maps

TEST(StudyStatistics, MeanMapsAndTheirDifference) {
  const std::vector<Values> first = {{1, 2}, {3, 2}, {5, 2}}, second = {{1, 6}};
  const Values areas = {3, 1};
  const MeanMap map = mean_map(first, areas);
  EXPECT_EQ(map.cases, 3u);
  EXPECT_EQ(map.mean, (Values{3, 2}));
  EXPECT_EQ(map.standard_deviation, (Values{2, 0}));
  EXPECT_EQ(map.area_mean, (3 * 3 + 1 * 2) / 4.0);
  EXPECT_NEAR(map.area_spread, std::sqrt(3 * 4 / 4.0), 1e-15);
  const MeanMap other = mean_map(second, areas);
  const MapDifference d = map_difference(map, other, areas);
  EXPECT_EQ(d.difference, (Values{2, -4}));
  EXPECT_EQ(d.area_mean, (3 * 2 - 4) / 4.0);
  EXPECT_NEAR(d.area_rms, std::sqrt((3 * 4 + 16) / 4.0), 1e-15);
  EXPECT_TRUE(std::isnan(other.standard_deviation[0]));
  const MapDifference turned = map_difference(other, map, areas);
  EXPECT_EQ(turned.area_mean, -d.area_mean);
  // a finer mesh: each place cut into two halves
  EXPECT_EQ(mean_map({{1, 1, 2}, {3, 3, 2}, {5, 5, 2}}, {1.5, 1.5, 1}).area_mean, map.area_mean);
}

TEST(StudyStatistics, MeanMapsOfCasesThatDoNotCoverAll) {
  const std::vector<Values> fields = {{1, kNaN, 3, kNaN}, {3, 5, kNaN, kNaN}, {5, 7, kNaN, kNaN}};
  const Values areas = {1, 3, 1, 5};
  const MeanMap covered = mean_map(fields, areas, 2);
  EXPECT_EQ(covered.count, (std::vector<std::size_t>{3, 2, 1, 0}));
  EXPECT_EQ(covered.cases, 3u);
  EXPECT_EQ(covered.mean[0], 3);
  EXPECT_EQ(covered.mean[1], 6);
  EXPECT_TRUE(std::isnan(covered.mean[2]) && std::isnan(covered.mean[3]));
  EXPECT_EQ(covered.standard_deviation[0], 2);
  EXPECT_NEAR(covered.standard_deviation[1], std::sqrt(2), 1e-15);
  EXPECT_EQ(covered.area_mean, (1 * 3 + 3 * 6) / 4.0);
  EXPECT_NEAR(covered.area_spread, std::sqrt((1 * 4 + 3 * 2) / 4.0), 1e-15);
  EXPECT_EQ(mean_map(fields, areas, 1).mean[2], 3);
  // of two means only where both are
  const MapDifference d = map_difference(covered, mean_map({{1, kNaN, 1, 1}}, areas, 1), areas);
  EXPECT_EQ(d.difference[0], 2);
  EXPECT_TRUE(std::isnan(d.difference[1]) && std::isnan(d.difference[2]));
  EXPECT_EQ(d.area_mean, 2);
  // where all cases cover all places it is the mean map
  const std::vector<Values> whole = {{1, 2}, {3, 2}, {5, 2}};
  EXPECT_EQ(mean_map(whole, {3, 1}, 2).area_spread, mean_map(whole, {3, 1}).area_spread);
}

// ------------------------------------------------------------------------------------------------------- regions

Vector3d at_angle(double degrees, double height) {
  const double a = degrees * kPi / 180;
  return {std::cos(a), std::sin(a), height};
}

TEST(StudyStatistics, SectorsGoRoundTheAxis) {
  std::vector<Vector3d> points;
  for (int k = 0; k < 12; ++k) points.push_back(at_angle(30 * k, k));
  const Regions six = sectors(points, {0, 0, 5}, {0, 0, 2}, {1, 0, 9}, 6);
  for (int k = 0; k < 12; ++k) EXPECT_EQ(six.index[at(k)], k / 2) << k;  // borders, too: 0, 60, 120 begin a sector
  EXPECT_EQ(six.names[1], "60 to 120 degrees");
  const Regions turned = sectors(points, Vector3d::Zero(), -Vector3d::UnitZ(), Vector3d::UnitY(), 4);
  for (int k = 0; k < 12; ++k) EXPECT_EQ(turned.index[at(k)], ((15 - k) % 12) / 3) << k;
  EXPECT_EQ(sectors({{0, 0, 1}, {1, 0, 0}}, Vector3d::Zero(), Vector3d::UnitZ(), Vector3d::UnitX(), 3).index,
            (std::vector<int>{-1, 0}));
}

TEST(StudyStatistics, SectorsMoveWithTheirSurface) {
  std::mt19937_64 random(5);
  std::vector<Vector3d> points, moved;
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(1.1, Vector3d(1, 2, -1).normalized()));
  const Vector3d shift(3, 4, 5);
  for (int i = 0; i < 200; ++i) {
    points.emplace_back(unit(random) - 0.5, unit(random) - 0.5, unit(random));
    moved.push_back(1000 * (turn * points.back()) + shift);
  }
  const Regions a = sectors(points, Vector3d::Zero(), Vector3d::UnitZ(), Vector3d::UnitX(), 7);
  const Regions b = sectors(moved, shift, turn * Vector3d::UnitZ(), turn * Vector3d::UnitX(), 7);
  EXPECT_EQ(a.index, b.index);
  EXPECT_EQ(*std::max_element(a.index.begin(), a.index.end()), 6);
}

// A bowl about the origin, open towards z: rings of 12 points at 20, 40, 60 and 80 degrees from its bottom.
TEST(StudyStatistics, RegionsOfASocket) {
  std::vector<Vector3d> points;
  for (double polar : {20, 40, 60, 80})
    for (int k = 0; k < 12; ++k) {
      const Vector3d round = at_angle(15 + 30 * k, 0);
      points.push_back(25 * (std::sin(polar * kPi / 180) * round - std::cos(polar * kPi / 180) * Vector3d::UnitZ()));
    }
  const SurfaceFrame frame = {Vector3d::UnitZ(), Vector3d::Zero()};
  const Regions r = socket_regions(points, frame, {1, 0, 3}, {0, 1, 0});  // up x, anterior y
  ASSERT_EQ(r.names.size(), 6u);
  EXPECT_EQ(r.names[3], "superior lateral");
  for (std::size_t i = 0; i < points.size(); ++i) {
    const int third = i % 12 >= 2 && i % 12 < 6 ? 0 : i % 12 < 2 || i % 12 >= 10 ? 1 : 2;  // 75 to 165: anterior
    EXPECT_EQ(r.index[i], 2 * third + (i / 12 < 2 ? 0 : 1)) << i;
  }
  EXPECT_THROW(socket_regions(points, {Vector3d::Zero(), Vector3d::Zero()}, {1, 0, 3}, {0, 1, 0}), UsageError);
  const FacetMask mask = region_mask(r, 4);
  EXPECT_EQ(std::accumulate(mask.begin(), mask.end(), 0), 8);
}

// ------------------------------------------------------------------------------------------------------ refusals

struct Refused {
  const char* text;
  std::function<void()> call;
};
void expect_refused(const std::vector<Refused>& refused) {
  for (const Refused& r : refused) EXPECT_EQ(refusal(r.call), r.text);
}

TEST(StudyStatistics, LinesAndPairsThatMakeNoSenseAreRefused) {
  expect_refused({{"a line: 1 values, expected 2",
                   [] {
                     cycle_band({{1, 2}, {1}}, 0, 1);
                   }},
                  {"a cycle of 1 instants, expected two or more", [] { percent_of_cycle({1}); }},
                  {"time 3 (1) follows 1, expected times that rise",
                   [] {
                     percent_of_cycle({0, 1, 1});
                   }},
                  {"time 2 of 2 is no finite number",
                   [] {
                     percent_of_cycle({0, kNaN});
                   }},
                  {"second of the pairs: 1 values, expected 2", [] {
                     complete_pairs({1, 2}, {1});
                   }}});
}

TEST(StudyStatistics, DesignsThatMakeNoSenseAreRefused) {
  expect_refused({{"a factor: 1 values, expected 2",
                   [] {
                     regression({{1}}, {1, 2});
                   }},
                  {"two cases have the value 1 of a factor, expected one of each value",
                   [] {
                     slopes({1, 1}, {1, 2});
                   }},
                  {"value 2 of a factor is nan, expected a finite number",
                   [] {
                     slopes({1, kNaN}, {1, 2});
                   }},
                  {"base case 3 of 2 cases, expected one of them",
                   [] {
                     slopes_about({{1, 2}}, {1, 2}, 2);
                   }},
                  {"7 outputs of 2 factors, expected a multiple of 4: rows A, B and one for each factor",
                   [] { sobol_indices(Values(7, 1.0), 2); }},
                  {"0 factors, expected one or more",
                   [] {
                     sobol_indices({1, 2}, 0);
                   }},
                  {"-1 resamples, expected 0 or more", [] { sobol_indices(Values(4, 1.0), 2, {.resamples = -1}); }}});
}

TEST(StudyStatistics, DosesAndMapsThatMakeNoSenseAreRefused) {
  expect_refused({{"a cycle of 1 states, expected two or more", [] { cycle_dose({0}, {{1}}, 1); }},
                  {"a state's pressures: 2 values, expected 1",
                   [] {
                     cycle_dose({0, 1}, {{1}, {1, 2}}, 1);
                   }},
                  {"a threshold of -1, expected a pressure of 0 or more",
                   [] {
                     cycle_dose({0, 1}, {{1}, {1}}, -1);
                   }},
                  {"years: nan, expected 0 or more",
                   [] {
                     chronic_dose({0, 1}, {{1}, {1}}, 1, {1, 1, kNaN});
                   }},
                  {"areas: 1 values, expected 2",
                   [] {
                     share_above({1, 2}, {1}, 1);
                   }},
                  {"an area: -1, expected 0 or more", [] { share_above({1}, {-1}, 1); }},
                  {"a mean of no field, expected one or more", [] { mean_map({}, {1}); }},
                  {"a field: 2 values, expected 1",
                   [] {
                     mean_map({{1}, {1, 2}}, {1});
                   }},
                  {"field 2 has nan at place 1, expected finite numbers: leave the field out",
                   [] {
                     mean_map({{1}, {kNaN}}, {1});
                   }},
                  {"a field has an infinite value, expected numbers, or NaN where it does not cover a place",
                   [] { mean_map({{kInfinity}}, {1}, 1); }},
                  {"a surface of area 0, expected more than 0", [] { mean_map({{1}}, {0}); }},
                  {"an area of nan, expected 0 or more", [] { mean_map({{1}}, {kNaN}); }}});
}

TEST(StudyStatistics, SectorsThatMakeNoSenseAreRefused) {
  const Vector3d z = Vector3d::UnitZ(), o = Vector3d::Zero();
  expect_refused({{"0 sectors, expected one or more", [&] { sectors({}, o, z, Vector3d::UnitX(), 0); }},
                  {"the axis of the sectors has no direction", [&] { sectors({}, o, o, z, 4); }},
                  {"the start of the sectors points along their axis, expected a direction across it",
                   [&] { sectors({}, o, z, 2 * z, 4); }},
                  {"point 1 of 1 is nowhere (NaN)", [&] {
                     sectors({{kNaN, 0, 0}}, o, z, Vector3d::UnitX(), 4);
                   }}});
}

}  // namespace dea::study_statistics_test

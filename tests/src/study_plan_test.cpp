// Studies as they are planned: factors as they are written, samples, tables of cases, the order of cases and options.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "src/base/error.h"
#include "src/base/parse.h"
#include "src/study/plan.h"

namespace dea::study_plan_test {

using Texts = std::vector<std::string>;

std::string bad_factor(const std::string& text) {
  try {
    parse_factor(text);
  } catch (const BadValue& bad) {
    return bad.what();
  }
  return "";
}

template <class Fault>
std::string refusal(const PlanRequest& request) {
  try {
    make_plan(request);
  } catch (const Fault& fault) {
    return fault.what();
  }
  return "";
}

PlanRequest request(const Texts& factors, const Texts& models = {"hip.feb"}) {
  PlanRequest r;
  r.models = models;
  for (const std::string& text : factors) {
    r.factors.push_back(parse_factor(text));
    r.options.push_back({r.factors.back().option, "", static_cast<int>(r.factors.size()) - 1});
  }
  return r;
}

CaseTable table(const Texts& names, const std::vector<Texts>& rows) {
  CaseTable t{"cases.csv", 1, names, rows, {}};
  for (std::size_t i = 0; i < rows.size(); ++i) t.lines.push_back(static_cast<int>(i) + 2);
  return t;
}

TEST(StudyFactor, RangesHoldBothEndsAndAreExact) {
  EXPECT_EQ(parse_factor("a: E={-20:20:10}").values, (Texts{"-20", "-10", "0", "10", "20"}));
  EXPECT_EQ(parse_factor("a: E={0:1:0.3}").values, (Texts{"0", "0.3", "0.6", "0.9"}));
  EXPECT_EQ(parse_factor("a: E={1:0:-0.25}").values, (Texts{"1", "0.75", "0.5", "0.25", "0"}));
  EXPECT_EQ(parse_factor("a: E={5:5:1}").values, (Texts{"5"}));
  EXPECT_EQ(parse_factor("a: E={ 1e3 : 2e3 : 5e2 }").values, (Texts{"1000", "1500", "2000"}));
  EXPECT_EQ(parse_factor("a: E={1e-3:3e-3:1e-3}").values, (Texts{"0.001", "0.002", "0.003"}));
  EXPECT_EQ(parse_factor("a: E={0:0.3:0.1}").values.back(), "0.3");
  const Texts many = parse_factor("a: E={0:100000:0.1}").values;
  ASSERT_EQ(many.size(), 1000001u);
  EXPECT_EQ(many[777777], "77777.7");
}

TEST(StudyFactor, KeepsTheTextAroundTheValue) {
  const Factor tilt = parse_factor("tilt: rotate pelvis=0,1,0,{-5:5:5}");
  EXPECT_EQ(tilt.name, "tilt");
  EXPECT_EQ(tilt.option, "rotate");
  EXPECT_EQ(tilt.before, "pelvis=0,1,0,");
  EXPECT_EQ(tilt.after, "");
  const Factor push = parse_factor("push : --force femur={0|1 | 2},3,4");
  EXPECT_EQ(push.option, "force");
  EXPECT_EQ(push.before + push.values[2] + push.after, "femur=2,3,4");
  EXPECT_EQ(parse_factor("law: law {linear|layer}").values, (Texts{"linear", "layer"}));
  EXPECT_EQ(parse_factor("law: law{linear|layer}").before, "");
  EXPECT_EQ(parse_factor("from: thickness-from knee={a.csv|b.csv}").before, "knee=");
  EXPECT_TRUE(parse_factor("t: E={}").values.empty());
}

TEST(StudyFactor, SpreadsAreRead) {
  const Spread normal = parse_factor("a: E={normal(12, 2)}").spread;
  EXPECT_EQ(normal.kind, Spread::Kind::Normal);
  EXPECT_EQ(normal.a, 12);
  EXPECT_EQ(normal.b, 2);
  EXPECT_EQ(parse_factor("a: E={Uniform(8,16)}").spread.kind, Spread::Kind::Uniform);
  EXPECT_EQ(parse_factor("a: E={lognormal(2,0.1)}").spread.kind, Spread::Kind::LogNormal);
}

TEST(StudyFactor, WhatIsWrongIsSaid) {
  const std::vector<std::array<std::string, 2>> wrong = {
      {"E={8|12}", "expected NAME: OPTION VALUE with one {...}"},
      {"a: E=8", "expected NAME: OPTION VALUE with one {...}"},
      {"a: E={1|2},{3|4}", "expected NAME: OPTION VALUE with one {...}"},
      {"a: E=}{", "expected NAME: OPTION VALUE with one {...}"},
      {"2nd: E={1|2}", "expected a factor's name of letters, digits and _"},
      {": E={1|2}", "expected a factor's name of letters, digits and _"},
      {"my tilt: E={1|2}", "found \"my tilt\""},
      {"a: rotat pelvis=0,1,0,{0:1:1}", "did you mean \"rotate\"?"},
      {"a: json={a|b}", "found no setting \"json\""},
      {"a: E={8}", "expected {START:STOP:STEP}, {a|b|c}"},
      {"a: E={0:1}", "expected START:STOP:STEP"},
      {"a: E={0:1:0}", "expected a step that is not 0"},
      {"a: E={0:1:-0.1}", "expected a step of the other sign"},
      {"a: E={1:0:0.1}", "expected a step of the other sign"},
      {"a: E={0:1000000000:1}", "found 1000000001 values in {0:1000000000:1}, expected at most 10000000"},
      {"a: E={0:1e9:1e-3}", "found 1000000000001 values"},
      {"a: E={0:1e29:1}", "expected numbers that differ by fewer powers of ten"},
      {"a: E={0:1e18:1e-18}", "expected numbers that differ by fewer powers of ten"},
      {"a: E={0:one:1}", "found \"one\", expected a number"},
      {"a: E={0:nan:1}", "found \"nan\", expected a number"},
      {"a: E={8||9}", "expected a value on both sides of each |"},
      {"a: E={8|9|8}", "found 8 twice"},
      {"a: E={unifrom(8,9)}", "did you mean \"uniform\"?"},
      {"a: E={uniform(9,8)}", "expected the smaller number first"},
      {"a: E={uniform(9)}", "expected two numbers"},
      {"a: E={normal(9,0)}", "expected a standard deviation > 0"},
  };
  for (const auto& [text, expected] : wrong)
    EXPECT_NE(bad_factor(text).find(expected), std::string::npos) << text << "\n" << bad_factor(text);
}

TEST(StudyPlan, ModelsAreTheSlowestThenFactorsInOrder) {
  const Plan plan = make_plan(request({"a: E={1|2}", "b: nu={3|4|5}"}, {"x.feb", "y.feb"}));
  ASSERT_EQ(plan.cases.size(), 12u);
  EXPECT_EQ(plan.cases[0].values, (Texts{"1", "3"}));
  EXPECT_EQ(plan.cases[1].values, (Texts{"1", "4"}));
  EXPECT_EQ(plan.cases[3].values, (Texts{"2", "3"}));
  EXPECT_EQ(plan.cases[5].model, 0);
  EXPECT_EQ(plan.cases[6].model, 1);
  EXPECT_EQ(plan.cases[11].values, (Texts{"2", "5"}));
}

TEST(StudyPlan, OptionsActInTheOrderOfTheLine) {
  PlanRequest r = request({"a: rotate pelvis=0,1,0,{5|10}"});
  r.options.insert(r.options.begin(), {"move", "pelvis=1,0,0", -1});
  r.options.push_back({"move", "pelvis=0,0,1", -1});
  const Plan plan = make_plan(r);
  const std::vector<CaseOption> options = options_of(plan, plan.cases[1]);
  ASSERT_EQ(options.size(), 3u);
  EXPECT_EQ(options[0].text, "pelvis=1,0,0");
  EXPECT_EQ(options[1].name, "rotate");
  EXPECT_EQ(options[1].text, "pelvis=0,1,0,10");
  EXPECT_EQ(options[2].text, "pelvis=0,0,1");
}

TEST(StudyPlan, WithoutFactorsEachModelIsACase) {
  EXPECT_EQ(make_plan(request({}, {"a.feb", "b.feb"})).cases.size(), 2u);
}

TEST(StudyPlan, ATableFillsEmptyBracesAndCrossesWithValues) {
  PlanRequest r = request({"a: E={}", "b: nu={0.3|0.4}"});
  r.table = table({"A"}, {{"8"}, {"9"}, {"10"}});
  const Plan plan = make_plan(r);
  ASSERT_EQ(plan.cases.size(), 6u);
  EXPECT_EQ(plan.cases[1].values, (Texts{"9", "0.3"}));
  EXPECT_EQ(plan.cases[3].values, (Texts{"8", "0.4"}));
}

TEST(StudyPlan, ATableMayNameTheModels) {
  PlanRequest r = request({"a: E={}"}, {});
  r.table = table({"model", "a"}, {{"y.feb", "1"}, {"x.feb", "2"}, {"y.feb", "3"}});
  const Plan plan = make_plan(r);
  EXPECT_EQ(plan.models, (Texts{"y.feb", "x.feb"}));
  ASSERT_EQ(plan.cases.size(), 3u);
  EXPECT_EQ(plan.cases[1].model, 1);
  EXPECT_EQ(plan.cases[2].model, 0);
  EXPECT_EQ(plan.cases[2].values, (Texts{"3"}));
  r.models = {"x.feb", "z.feb"};
  EXPECT_NE(refusal<InputError>(r).find("cases.csv:2: column \"model\": found \"y.feb\""), std::string::npos);
}

TEST(StudyPlan, WhatDoesNotFitTogetherIsSaid) {
  PlanRequest r = request({"tilt: E={}", "b: nu={0.3|0.4}"});
  EXPECT_NE(refusal<UsageError>(r).find("factor \"tilt\": found {}"), std::string::npos) << refusal<UsageError>(r);
  r.table = table({"tlit"}, {{"8"}});
  EXPECT_NE(refusal<InputError>(r).find("cases.csv:1: found column \"tlit\" (did you mean \"tilt\"?)"),
            std::string::npos);
  r.table = table({"b"}, {{"8"}});
  EXPECT_NE(refusal<InputError>(r).find("this factor has values of its own"), std::string::npos);
  r.table = table({"model"}, {{"hip.feb"}});
  EXPECT_NE(refusal<InputError>(r).find("found no column \"tilt\""), std::string::npos);
  r.table = table({"tilt", "TILT"}, {{"8", "8"}});
  EXPECT_NE(refusal<InputError>(r).find("found column \"TILT\" twice"), std::string::npos);
  for (const char* cell : {"", "NaN", "NA", "-inf"}) {
    r.table = table({"tilt"}, {{"8"}, {cell}});
    EXPECT_NE(refusal<InputError>(r).find("cases.csv:3: column \"tilt\": found"), std::string::npos) << cell;
  }
  r.sampling = Sampling{Design::Sobol, 4, 1};
  EXPECT_NE(refusal<UsageError>(r).find("expected one of them"), std::string::npos);
  EXPECT_NE(refusal<UsageError>(request({"a: E={1|2}", "A: nu={0.1|0.2}"})).find("two factors named \"A\""),
            std::string::npos);
  EXPECT_NE(refusal<UsageError>(request({"a: E={uniform(1,2)}"})).find("found a spread"), std::string::npos);
  EXPECT_NE(refusal<UsageError>(request({"model: E={1|2}"})).find("named \"model\""), std::string::npos);
  EXPECT_NE(refusal<UsageError>(request({}, {})).find("found no model"), std::string::npos);
  EXPECT_NE(refusal<UsageError>(request({}, {"a.feb", "a.feb"})).find("a.feb twice"), std::string::npos);
}

TEST(StudyPlan, TooManyCasesAreCountedNotMade) {
  EXPECT_NE(refusal<UsageError>(request({"a: E={1:10000:1}", "b: nu={1:10000:1}"})).find("found 100000000 cases"),
            std::string::npos);
  Texts factors;
  for (int i = 0; i < 30; ++i) factors.push_back("f" + std::to_string(i) + ": E={1:1000:1}");
  EXPECT_NE(refusal<UsageError>(request(factors)).find("expected at most 10000000"), std::string::npos);
  PlanRequest r = request({"a: E={uniform(1,2)}", "b: nu={uniform(0.1,0.2)}"});
  r.sampling = Sampling{Design::Saltelli, 9'000'000, 1};
  EXPECT_NE(refusal<UsageError>(r).find("makes 36000000 cases"), std::string::npos);
}

TEST(StudyPlan, SamplesFillFactorsWithASpread) {
  PlanRequest r = request({"a: E={uniform(8,16)}", "m: law={linear|layer}", "b: nu={normal(0.4,0.01)}"});
  r.sampling = Sampling{Design::Saltelli, 8, 3};
  const Plan plan = make_plan(r);
  ASSERT_EQ(plan.cases.size(), 2u * 8 * 4);
  for (const PlannedCase& c : plan.cases) {
    const double E = parse_number(c.values[0]);
    EXPECT_TRUE(E >= 8 && E < 16) << c.values[0];
    EXPECT_LE(c.values[0].size(), 14u) << c.values[0];
  }
  EXPECT_EQ(plan.cases[31].values[1], "linear");
  EXPECT_EQ(plan.cases[32].values[0], plan.cases[0].values[0]);
  r = request({"a: E={uniform(8,16)}"});
  r.sampling = Sampling{Design::Saltelli, 8, 3};
  EXPECT_NE(refusal<UsageError>(r).find("found one factor with a spread"), std::string::npos);
  r = request({"a: E={1|2}"});
  r.sampling = Sampling{Design::Sobol, 8, 3};
  EXPECT_NE(refusal<UsageError>(r).find("found no factor with a spread"), std::string::npos);
}

// The first points of Sobol's sequence in two dimensions, but for the shift: (1/2, 1/2), (3/4, 1/4), (1/4, 3/4),
// (3/8, 3/8), (7/8, 7/8), (5/8, 1/8), (1/8, 5/8).
TEST(StudySampling, SobolIsTheSequenceShifted) {
  const double known[][2] = {{0.5, 0.5},     {0.75, 0.25},   {0.25, 0.75},  {0.375, 0.375},
                             {0.875, 0.875}, {0.625, 0.125}, {0.125, 0.625}};
  for (const std::uint64_t seed : {1u, 7u}) {
    const auto points = unit_points(Design::Sobol, 2, 7, seed);
    for (std::size_t i = 0; i < 7; ++i)
      for (std::size_t k = 0; k < 2; ++k) {
        const double step = points[i][k] - points[0][k], wanted = known[i][k] - known[0][k];
        EXPECT_NEAR(step - wanted, std::round(step - wanted), 1e-15)
            << i << " " << k;  // the same but for a whole number
      }
  }
  EXPECT_NE(unit_points(Design::Sobol, 2, 1, 1), unit_points(Design::Sobol, 2, 1, 2));
  EXPECT_EQ(unit_points(Design::Sobol, 2, 9, 1), unit_points(Design::Sobol, 2, 9, 1));
}

TEST(StudySampling, LatinHasEachSliceOnce) {
  const int n = 101;
  const auto points = unit_points(Design::Latin, 3, n, 5);
  ASSERT_EQ(points.size(), 101u);
  for (std::size_t k = 0; k < 3; ++k) {
    std::set<int> slices;
    for (const auto& p : points) slices.insert(static_cast<int>(std::floor(p[k] * n)));
    EXPECT_EQ(slices.size(), 101u);
    EXPECT_EQ(*slices.rbegin(), 100);
  }
  EXPECT_NE(points[0][0], points[0][1]);
}

TEST(StudySampling, SaltelliChangesOneColumnAtATime) {
  const std::size_t n = 4, d = 3;
  const auto points = unit_points(Design::Saltelli, 3, 4, 1), both = unit_points(Design::Sobol, 6, 4, 1);
  ASSERT_EQ(points.size(), n * (d + 2));
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < d; ++k) {
      EXPECT_EQ(points[i][k], both[i][k]);
      EXPECT_EQ(points[n + i][k], both[i][d + k]);
      for (std::size_t f = 0; f < d; ++f) EXPECT_EQ(points[(2 + f) * n + i][k], points[(k == f ? n : 0) + i][k]);
    }
}

TEST(StudySampling, Quantiles) {
  const double phi1 = 0.84134474606854293;  // the normal distribution function at 1
  EXPECT_NEAR(quantile({Spread::Kind::Normal, 12, 2}, phi1), 14, 1e-13);
  EXPECT_NEAR(quantile({Spread::Kind::Normal, 12, 2}, 0.5), 12, 1e-15);
  EXPECT_NEAR(quantile({Spread::Kind::LogNormal, 2, 0.5}, phi1), std::exp(2.5), 1e-12);
  EXPECT_EQ(quantile({Spread::Kind::Uniform, 8, 16}, 0.25), 10);
  EXPECT_EQ(quantile({Spread::Kind::Uniform, 8, 16}, 0.0), 8);
  EXPECT_TRUE(std::isfinite(quantile({Spread::Kind::Normal, 12, 2}, 0.0)));
}

}  // namespace dea::study_plan_test

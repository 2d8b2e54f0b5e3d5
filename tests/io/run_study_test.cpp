// Cases of a study: each depends on itself alone, whoever solves what beside it, and is what `analyse` makes of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "io/feb/read_feb.h"
#include "io/study/run_study.h"
#include "src/run/analysis.h"
#include "src/run/states.h"

namespace dea::run_study_test {

const std::string kHip = DEA_SAMPLES_DIR "/hip/hip_walking.feb";

/// The socket turned about y by each angle, cartilage of each stiffness.
Plan turned_sockets(const std::vector<std::string>& degrees, const std::vector<std::string>& E) {
  Plan plan;
  plan.models = {kHip};
  plan.options = {{"skip-steps", "true", -1}, {"rotate", "", 0}, {"E", "", 1}};
  plan.factors = {Factor{"tilt", "rotate", "pelvis=0,1,0,", "", degrees, {}}, Factor{"stiffness", "E", "", "", E, {}}};
  for (const std::string& angle : degrees)
    for (const std::string& stiffness : E) plan.cases.push_back({0, {angle, stiffness}});
  return plan;
}

std::vector<CaseResult> solved(const Plan& plan, const std::vector<std::size_t>& cases, StudyOptions options = {}) {
  std::map<std::size_t, CaseResult> by_number;
  options.states = "last";
  options.done = [&](CaseResult&& result) { by_number[result.number] = std::move(result); };
  run_study(plan, cases, options);
  std::vector<CaseResult> results;
  for (auto& entry : by_number) results.push_back(std::move(entry.second));
  return results;
}

void expect_same_bits(const CaseResult& a, const CaseResult& b) {
  ASSERT_EQ(a.number, b.number);
  ASSERT_EQ(a.outcome, b.outcome) << a.message << b.message;
  ASSERT_EQ(a.states.size(), b.states.size());
  for (std::size_t i = 0; i < a.states.size(); ++i) {
    const CaseState &s = a.states[i], &t = b.states[i];
    EXPECT_EQ(s.statistics[0].headline.p99, t.statistics[0].headline.p99) << a.number;
    EXPECT_EQ(s.statistics[0].force, t.statistics[0].force) << a.number;
    EXPECT_EQ(s.iterations, t.iterations) << a.number;
    for (std::size_t body = 0; body < s.poses.size(); ++body) EXPECT_EQ(s.poses[body].center, t.poses[body].center);
  }
}

TEST(RunStudy, BitsDoNotDependOnWhoeverSolvesWhat) {
  const Plan plan = turned_sockets({"-8", "0", "8"}, {"9", "12"});
  const std::vector<CaseResult> alone = solved(plan, {0, 1, 2, 3, 4, 5});
  ASSERT_EQ(alone.size(), 6u);
  StudyOptions three;
  three.workers = 3;
  const std::vector<CaseResult> together = solved(plan, {5, 2, 4, 0, 3, 1}, three);
  StudyOptions forgetful;
  forgetful.memory = 1;  // no joint is kept for the case after the next
  const std::vector<CaseResult> again = solved(plan, {1, 4, 0, 5}, forgetful);
  for (std::size_t i = 0; i < alone.size(); ++i) expect_same_bits(alone[i], together[i]);
  for (const CaseResult& result : again) expect_same_bits(alone[result.number - 1], result);
}

// Where a search starts changes no more than the last digits of its tolerance.
TEST(RunStudy, ACaseIsWhatAnalyseMakesOfIt) {
  const Plan plan = turned_sockets({"-12", "12"}, {"12"});
  for (const CaseResult& result : solved(plan, {0, 1})) {
    ASSERT_EQ(result.outcome, CaseResult::Outcome::Solved) << result.message;
    Settings settings;
    settings.skip_steps = true;
    settings.E[""] = 12;
    settings.placements.push_back(
        {Placement::Kind::Rotate, "pelvis", {0, 1, 0}, std::stod(plan.cases[result.number - 1].values[0])});
    const Recognition recognition = recognise(read_feb(kHip), settings);
    AnalysisOptions options;
    options.times = row_states(recognition.model, settings, parse_states("last"), "").times;
    const Analysis analysis = analyse(recognition, options);
    const ContactStatistics &a = result.states.back().statistics[0], &b = analysis.states.back().statistics[0];
    EXPECT_NEAR(a.headline.p99, b.headline.p99, 1e-6 * b.headline.p99);
    EXPECT_NEAR(a.headline.area, b.headline.area, 1e-6 * b.headline.area);
    EXPECT_LT((a.force - b.force).norm(), 1e-6 * b.force.norm());
    const std::vector<Pose>& poses = analysis.states.back().equilibrium.poses;
    for (std::size_t body = 0; body < poses.size(); ++body)
      EXPECT_LT((result.states.back().poses[body].center - poses[body].center).norm(), 1e-6);
    EXPECT_EQ(result.contacts[0].name, analysis.joint.contacts[0].name);
  }
}

// Free to turn, the head may balance in several poses: the search's start is that of `dea run`, so that its end is,
// too.
TEST(RunStudy, FreeToTurnTheStartIsThatOfAnalyse) {
  Plan plan = turned_sockets({"0"}, {"12"});
  plan.options.push_back({"law", "linear", -1});
  plan.options.push_back({"free", "femur=x,y,z,Ru,Rv,Rw", -1});
  const CaseResult result = solved(plan, {0}).front();
  Settings settings;
  settings.skip_steps = true;
  settings.E[""] = 12;
  settings.law = Law::Linear;
  settings.free["femur"].fill(true);
  const Recognition recognition = recognise(read_feb(kHip), settings);
  AnalysisOptions options;
  options.times = row_states(recognition.model, settings, parse_states("last"), "").times;
  const Analysis analysis = analyse(recognition, options);
  EXPECT_EQ(result.states.back().statistics[0].headline.p99, analysis.states.back().statistics[0].headline.p99);
  EXPECT_EQ(result.states.back().iterations, analysis.states.back().equilibrium.iterations);
}

// What the model's own conditions are refused for is no fault where the case's settings replace them.
TEST(RunStudy, TheModelsLoadsAreNotAskedForWhereTheCaseHasItsOwn) {
  JointModel model = read_feb(kHip);
  EXPECT_TRUE(recognise_joint(model).faults.empty());
  Settings unknown;
  unknown.force["femur"] = {0, 0, 1};
  EXPECT_TRUE(recognise_joint(model, unknown).faults.empty());
  unknown.force["fmur"] = {0, 0, 1};
  EXPECT_THROW(recognise_joint(model, unknown), UsageError);
}

TEST(RunStudy, WhatIsRefusedIsACaseAndTheOthersGoOn) {
  Plan plan = turned_sockets({"0", "x", "5"}, {"12"});
  plan.models.push_back("nowhere.feb");
  plan.cases.push_back({1, {"0", "12"}});
  plan.cases.push_back({0, {"0", "-3"}});
  plan.cases.push_back({0, {"80", "12"}});
  StudyOptions two;
  two.workers = 2;
  const std::vector<CaseResult> results = solved(plan, {0, 1, 2, 3, 4, 5}, two);
  ASSERT_EQ(results.size(), 6u);
  using Outcome = CaseResult::Outcome;
  EXPECT_EQ(results[0].outcome, Outcome::Solved);
  EXPECT_EQ(results[1].outcome, Outcome::Refused);
  EXPECT_NE(results[1].message.find("x"), std::string::npos);
  EXPECT_EQ(results[2].outcome, Outcome::Solved);
  EXPECT_EQ(results[3].outcome, Outcome::Refused);
  EXPECT_NE(results[3].message.find("nowhere.feb"), std::string::npos);
  EXPECT_EQ(results[4].outcome, Outcome::Refused);
  EXPECT_EQ(results[5].outcome, Outcome::Failed) << "a socket turned by 80 degrees";
  EXPECT_FALSE(results[5].message.empty());
}

TEST(RunStudy, FieldsAndTheirSurface) {
  StudyOptions options;
  options.keep_fields = true;
  const std::vector<CaseResult> results = solved(turned_sockets({"0"}, {"12"}), {0}, options);
  ASSERT_EQ(results[0].surfaces.size(), 1u);
  const CaseSurface& surface = results[0].surfaces[0];
  const std::vector<float>& pressure = results[0].states[0].fields[0];
  ASSERT_EQ(pressure.size(), surface.vertices.size());
  // the force that the field carries along the surface's normals, third of each triangle's area to a vertex
  double p_area = 0;
  for (const auto& t : surface.triangles) {
    const double a =
        0.5 *
        (surface.vertices[static_cast<std::size_t>(t[1])] - surface.vertices[static_cast<std::size_t>(t[0])])
            .cross(surface.vertices[static_cast<std::size_t>(t[2])] - surface.vertices[static_cast<std::size_t>(t[0])])
            .norm();
    for (int v : t) {
      if (pressure[static_cast<std::size_t>(v)] <= 0) continue;
      p_area += a / 3 * static_cast<double>(pressure[static_cast<std::size_t>(v)]);
    }
  }
  const ContactStatistics& s = results[0].states[0].statistics[0];
  EXPECT_GT(p_area, s.force.norm());  // pressures point in different directions
  EXPECT_LT(p_area, 1.5 * s.force.norm());
  EXPECT_FLOAT_EQ(*std::max_element(pressure.begin(), pressure.end()), static_cast<float>(s.headline.peak));
}

TEST(RunStudy, AStopEndsIt) {
  StopFlag stop = false;
  StudyOptions options;
  options.workers = 2;
  options.stop = &stop;
  std::size_t count = 0;
  options.states = "last";
  options.done = [&](CaseResult&&) {
    ++count;
    stop = true;
  };
  const Plan plan = turned_sockets({"-4", "-2", "0", "2", "4", "6", "8"}, {"12"});
  EXPECT_THROW(run_study(plan, {0, 1, 2, 3, 4, 5, 6}, options), Stopped);
  EXPECT_LT(count, 4u);
}

}  // namespace dea::run_study_test

// The memory of joints that are ready: what is said of it is what the kernel counts, and no more than was allowed is
// kept.
#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "io/study/ready_joints.h"
#include "io/study/run_study.h"
#include "src/base/error.h"
#include "src/run/cost.h"
#include "tests/io/resident.h"

namespace dea::ready_joints_test {

using test::resident;
using Joints = std::vector<std::shared_ptr<const ReadyJoint>>;

Settings of_stiffness(Law law, int refine, double E) {
  Settings settings;
  settings.law = law;
  settings.refine = refine;
  settings.E[""] = E;
  return settings;
}

double bytes_of(const ReadyJoint& joint) { return kept_bytes(joint.model, joint.prepared.joint); }

struct MemoryOfJoint {
  const char *name, *model;
  Law law;
  int refine;
};
void PrintTo(const MemoryOfJoint& j, std::ostream* out) { *out << j.name; }

class JointMemory : public testing::TestWithParam<MemoryOfJoint> {};

TEST_P(JointMemory, IsWhatIsSaid) {
#ifdef DEA_SANITIZE_ADDRESS
  GTEST_SKIP() << "the sanitizer keeps what was given back";
#endif
  const MemoryOfJoint& p = GetParam();
  constexpr int kMore = 3;
  ReadyJoints ready(std::numeric_limits<double>::infinity());
  Joints held;
  double before = 0;
  for (int i = 0; i <= kMore; ++i) {
    if (i == 1) before = resident();  // what is made once, whatever the joints, is there
    held.push_back(ready.get(DEA_SAMPLES_DIR + std::string(p.model), of_stiffness(p.law, p.refine, 10 + i), nullptr));
  }
  const double measured = (resident() - before) / kMore, said = bytes_of(*held.back());
  EXPECT_GT(said, 0.8 * measured) << said << " bytes said, " << measured << " measured";
  EXPECT_LT(said, 1.7 * measured) << said << " bytes said, " << measured << " measured";
}

INSTANTIATE_TEST_SUITE_P(ReadyJoints, JointMemory,
                         testing::Values(MemoryOfJoint{"hip_linear", "/hip/hip_walking.feb", Law::Linear, 1},
                                         MemoryOfJoint{"hip_layer", "/hip/hip_walking.feb", Law::Layer, 1},
                                         MemoryOfJoint{"hip_layer_fine", "/hip/hip_walking.feb", Law::Layer, 2},
                                         MemoryOfJoint{"knee_layer", "/knee/knee.feb", Law::Layer, 1},
                                         MemoryOfJoint{"chain_linear", "/chain/chain.feb", Law::Linear, 1}),
                         [](const auto& info) { return std::string(info.param.name); });

// Two joints fit, the third takes the place of the one that was used longest ago; one is kept in any case.
TEST(ReadyJoints, NoMoreAreKeptThanFit) {
  const std::string ball = DEA_SAMPLES_DIR "/spheres/one_layer.feb";
  const auto made = [&](ReadyJoints& ready, double E) {
    return ready.get(ball, of_stiffness(Law::Linear, 1, E), nullptr);
  };
  double one = 0;
  {
    ReadyJoints ready(1.0);
    const std::weak_ptr<const ReadyJoint> first = made(ready, 8);
    ASSERT_FALSE(first.expired());
    EXPECT_EQ(made(ready, 8), first.lock());
    one = bytes_of(*first.lock());
    made(ready, 9);
    EXPECT_TRUE(first.expired());
  }
  ReadyJoints ready(2.5 * one);
  const std::weak_ptr<const ReadyJoint> a = made(ready, 8), b = made(ready, 9);
  EXPECT_FALSE(a.expired());
  made(ready, 8);
  const std::weak_ptr<const ReadyJoint> c = made(ready, 10);
  EXPECT_FALSE(a.expired()) << "was used after b";
  EXPECT_TRUE(b.expired());
  EXPECT_FALSE(c.expired());
  EXPECT_THROW(ready.get("nowhere.feb", {}, nullptr), InputError);
  EXPECT_FALSE(a.expired());
  EXPECT_FALSE(c.expired());
}

// Two models, three stiffnesses, two tilts: a joint is wanted by the two tilts of its model and stiffness, in any
// order.
TEST(JointUses, TheLastCaseOfEachJoint) {
  Plan plan;
  plan.models = {"a.feb", "b.feb"};
  plan.factors = {Factor{"tilt", "rotate", "pelvis=0,1,0,", "", {"0", "5"}, {}},
                  Factor{"E", "E", "", "", {"8", "9", "x"}, {}}};
  for (int model : {0, 1})
    for (const char* tilt : {"0", "5"})
      for (const char* E : {"8", "9", "x"}) plan.cases.push_back({model, {tilt, E}});
  const std::vector<std::size_t> cases{0, 1, 2, 3, 4, 5, 6, 7, 9};  // of model b with E = 8 both, with 9 one
  JointUses uses(plan, cases);
  std::vector<bool> last;
  for (const std::size_t i : cases) last.push_back(uses.was_last(plan.cases[i]));
  EXPECT_EQ(last, (std::vector<bool>{false, false, false, true, true, true, false, true, true}));
  EXPECT_FALSE(uses.was_last(plan.cases[11])) << "a case that was not to be solved";
  JointUses none(plan, {});
  EXPECT_FALSE(none.was_last(plan.cases[0]));
}

// Ten times as many cases, each with a joint of its own, hold no more memory.
TEST(JointUses, MemoryOfAStudyDoesNotGrowWithItsCases) {
#ifdef DEA_SANITIZE_ADDRESS
  GTEST_SKIP() << "the sanitizer keeps what was given back";
#endif
  Plan plan;
  plan.models = {DEA_SAMPLES_DIR "/spheres/one_layer.feb"};
  plan.options = {{"law", "linear", -1}, {"E", "", 0}};
  plan.factors = {Factor{"E", "E", "", "", {}, {}}};
  std::vector<std::size_t> cases;
  for (std::size_t i = 0; i < 44; ++i) {
    plan.cases.push_back({0, {std::to_string(8 + i)}});
    cases.push_back(i);
  }
  StudyOptions options;
  options.states = "last";
  std::vector<double> held;
  options.done = [&](CaseResult&& result) {
    EXPECT_EQ(result.outcome, CaseResult::Outcome::Solved) << result.message;
    held.push_back(resident());
  };
  run_study(plan, cases, options);
  ReadyJoints one(1.0);
  const double joint = bytes_of(*one.get(plan.models[0], of_stiffness(Law::Linear, 1, 8), nullptr));
  EXPECT_LT(held.back() - held[3], 4 * joint) << "of 40 joints";
}

}  // namespace dea::ready_joints_test

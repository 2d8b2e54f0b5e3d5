// A joint in the hand: what it answers is what dea run has of the same settings, whatever was asked before.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io/feb/read_feb.h"
#include "io/run/wanted_states.h"
#include "io/settings/settings_xml.h"
#include "io/tables/read_tables.h"
#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/model/settings_table.h"
#include "src/run/analysis.h"
#include "views/data/run_json.h"
#include "views/live/live_joint.h"

namespace dea::live_joint_test {

using Options = std::vector<std::pair<std::string, std::string>>;

LiveRequest asked(const std::string& model, const Options& options, bool quick = false) {
  LiveRequest request;
  request.model = DEA_SAMPLES_DIR + model;
  std::vector<SettingValue> values;
  for (const auto& [name, text] : options) values.push_back(split_key(*find_setting_option(name), text));
  lay_over(request.settings, values);
  request.outputs.states = "last";
  request.quick = quick;
  return request;
}

/// The state as `dea run` has it.
Json run_of(const LiveRequest& request) {
  Settings settings = request.settings;
  JointModel model = read_feb(request.model);
  settle_units(model, settings);
  read_tables(model, settings);
  const Recognition recognition = recognise(std::move(model), settings);
  const States states = wanted_states(recognition.model, recognition.settings, request.outputs, "");
  AnalysisOptions options;
  options.times = states.times;
  options.keep_state = states.wanted;
  const Analysis analysis = analyse(recognition, options);
  return state_json(recognition.model, analysis.joint, analysis.states.back());
}

TEST(LiveJoint, AnswersAsTheRunDoes) {
  for (const std::string model : {"/hip/hip_walking.feb", "/knee/knee.feb"}) {
    LiveJoint live;
    const std::vector<Options> hand =
        model[1] == 'h'
            ? std::vector<Options>{{}, {{"force", "femur=300,-200,1200"}}, {{"E", "9"}}, {{"law", "linear"}}}
            : std::vector<Options>{{}, {{"E", "9"}}};
    for (const Options& options : hand) {
      live_answer(live, asked(model, {}, true));
      const LiveAnswer quick = live_answer(live, asked(model, options, true));
      EXPECT_TRUE(quick.text["quick"].get<bool>());
      const LiveRequest request = asked(model, options);
      const LiveAnswer answer = live_answer(live, request);
      EXPECT_EQ(answer.text["schema"], "dea.live/1");
      EXPECT_EQ(answer.text["state"].dump(), run_of(request).dump()) << model;
      double most = 0.0, largest = 0.0;
      for (const Json& surface : answer.text["surfaces"]) {
        ASSERT_LE(surface["begin"].get<std::size_t>() + surface["count"].get<std::size_t>(), answer.pressure.size());
        for (std::size_t k = 0; k < surface["count"].get<std::size_t>(); ++k)
          most = std::max<double>(most, answer.pressure[surface["begin"].get<std::size_t>() + k]);
      }
      for (const Json& contact : answer.text["state"]["contacts"])
        largest = std::max(largest, contact["peak_pressure"].get<double>());
      EXPECT_GT(most, 0.3 * largest) << "the map is not of this state";
      EXPECT_LT(most, 1.5 * largest);
    }
  }
}

/// A quick answer starts from the last one, and is that of springs that know nothing of each other.
TEST(LiveJoint, QuickAnswersAreThoseOfLawLinear) {
  LiveJoint live;
  const std::string model = "/hip/hip_walking.feb";
  int before = 0;
  for (int step = 0; step < 6; ++step) {
    const std::string force = fmt::format("femur={},-262,1834", 430 + 4 * step);
    const LiveAnswer quick = live_answer(live, asked(model, {{"force", force}}, true));
    const Json exact = run_of(asked(model, {{"force", force}, {"law", "linear"}}));
    const Json &mine = quick.text["state"]["contacts"][0], &of_run = exact["contacts"][0];
    for (const char* number : {"p99", "mean", "area"})
      EXPECT_NEAR(mine["headline"][number].get<double>(), of_run["headline"][number].get<double>(),
                  0.01 * of_run["headline"][number].get<double>())
          << number;
    const int iterations = quick.text["state"]["iterations"].get<int>();
    if (step == 0) before = iterations;
    if (step > 0) {
      EXPECT_LT(iterations, before);
    }
  }
}

TEST(LiveJoint, AFaultIsThatOfTheRunAndChangesNothing) {
  LiveJoint live;
  const LiveRequest good = asked("/hip/hip_walking.feb", {});
  const std::string before = live_answer(live, good).text.dump();
  const LiveRequest wrong = asked("/hip/hip_walking.feb", {{"force", "fibula=1,0,0"}});
  std::string told, of_run;
  try {
    live_answer(live, wrong);
  } catch (const UsageError& e) {
    told = e.what();
  }
  try {
    run_of(wrong);
  } catch (const UsageError& e) {
    of_run = e.what();
  }
  EXPECT_FALSE(told.empty());
  EXPECT_EQ(told, of_run);
  EXPECT_THROW(live_answer(live, asked("/hip/no_such.feb", {})), InputError);
  EXPECT_EQ(live_answer(live, good).text.dump(), before);
}

}  // namespace dea::live_joint_test

// A joint in the hand: what it answers is what dea run has of the same settings, whatever was asked before.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io/feb/read_feb.h"
#include "io/files/encoded_text.h"
#include "io/files/output.h"
#include "io/run/wanted_states.h"
#include "io/settings/settings_xml.h"
#include "io/tables/read_tables.h"
#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/model/settings_table.h"
#include "src/run/analysis.h"
#include "tests/program.h"
#include "views/data/run_json.h"
#include "views/live/live_joint.h"
#include "views/page/live_page.h"

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

/// A quick answer starts from the one before, and is that of the run but for a thousandth of the load.
TEST(LiveJoint, QuickAnswersFollow) {
  LiveJoint live;
  const std::string model = "/hip/hip_walking.feb";
  Json from;
  for (int step = 0; step < 10; ++step) {
    const bool changes = step >= 6;
    Options options = {{"force", fmt::format("femur={},-262,1834", 430 + 4 * step)}};
    if (changes) options.push_back({"E", fmt::format("{}", 9 + 0.2 * step)});
    LiveRequest request = asked(model, options, true);
    request.from = from;
    const LiveAnswer quick = live_answer(live, request);
    from = quick.text["bodies"];
    EXPECT_TRUE(quick.text["quick"].get<bool>());
    const Json exact = run_of(asked(model, options));
    const Json &mine = quick.text["state"]["contacts"][0], &of_run = exact["contacts"][0];
    for (const char* number : {"p99", "mean", "area"})
      EXPECT_NEAR(mine["headline"][number].get<double>(), of_run["headline"][number].get<double>(),
                  0.003 * of_run["headline"][number].get<double>())
          << number;
  }
}

/// Of bodies that are free to turn, too: the same balance, sooner.
TEST(LiveJoint, AnswersFollowFromWhereTheBodiesAre) {
  LiveJoint live;
  const std::string model = "/knee/knee.feb";
  for (const bool quick : {true, false}) {
    const LiveAnswer before = live_answer(live, asked(model, {}, quick));
    LiveRequest request = asked(model, {{"E", "9.1"}}, quick);
    const Json cold = live_answer(live, request).text;
    request.from = before.text["bodies"];
    const Json warm = live_answer(live, request).text;
    EXPECT_LT(warm["state"]["iterations"].get<int>(), cold["state"]["iterations"].get<int>()) << quick;
    for (std::size_t b = 0; b < cold["bodies"].size(); ++b)
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(warm["bodies"][b]["center"][k].get<double>(), cold["bodies"][b]["center"][k].get<double>(),
                    quick ? 0.3 : 5e-3);  // a soft direction: 1e-6 of the load is 2e-3 mm
  }
}

/// The held dofs of a body that the hand has turned are where the hand has them.
TEST(LiveJoint, APlacedBodyFollowsInItsFreeDofsOnly) {
  LiveJoint live;
  const std::string model = "/hip/hip_walking.feb";
  const LiveAnswer before = live_answer(live, asked(model, {}));
  LiveRequest request = asked(model, {{"rotate", "femur=1,0,0,2"}});
  const Json exact = live_answer(live, request).text;
  request.from = before.text["bodies"];
  const Json follows = live_answer(live, request).text;
  EXPECT_EQ(follows["bodies"][0]["rotation"].size(), 3u);
  for (std::size_t b = 0; b < exact["bodies"].size(); ++b) {
    EXPECT_EQ(follows["bodies"][b]["rotation"], exact["bodies"][b]["rotation"]);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(follows["bodies"][b]["center"][k].get<double>(), exact["bodies"][b]["center"][k].get<double>(), 1e-6);
  }
}

/// The page that solves gets a joint in place of its sample: the files' bytes and the words, whatever is in them.
TEST(LiveJoint, APageHasTheFilesAndTheWords) {
  const test::TemporaryFolder folder;
  const std::string program = (folder.path / "dea.html").string(), table = (folder.path / "a table.csv").string();
  write_text(program,
             "<html>\n<script type=\"text/plain\" id=\"sample-model\" data-gives-way=\"1\" data-bytes=\"3\" "
             "data-name=\"x.feb\">abc</script>\n<script>rest</script>\n</html>\n");
  write_text(table, "time,x\n0,</script>\n");
  const std::string page = live_page(program, {{"a \"b\".csv", table, "table"}}, {"--E", "femur </script>=9"});
  const auto part = [&](const std::string& before) {
    const std::size_t begin = page.find(before) + before.size();
    return bytes_of_base64(page.substr(begin, page.find("</script>", begin) - begin)).value();
  };
  EXPECT_EQ(unpacked_bytes(part("class=\"given\" data-name=\"a &quot;b&quot;.csv\" data-kind=\"table\">")),
            "time,x\n0,</script>\n");
  EXPECT_EQ(Json::parse(part("id=\"given-words\">")), Json::array({"--E", "femur </script>=9"}));
  EXPECT_EQ(page.find("abc"), std::string::npos);
  EXPECT_NE(page.find("\n<script>rest</script>\n</html>\n"), std::string::npos);
  EXPECT_THROW(live_page(table, {}, {}), InputError);
  EXPECT_THROW(live_page(program, {{"x", (folder.path / "none").string(), "model"}}, {}), InputError);
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

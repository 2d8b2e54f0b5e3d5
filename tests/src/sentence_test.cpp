// Sentences that name settings, and how each front end words them.
#include "src/base/sentence.h"

#include <gtest/gtest.h>

#include "io/settings/settings_xml.h"
#include "plugin/febio_wording.h"
#include "src/base/error.h"
#include "src/base/say.h"

namespace dea::sentence_test {

const NamedSetting kThickness = {"thickness", "knee", "VALUE", "primary_thickness"}, kRigid = {"rigid", "", "a bone"};

TEST(Sentence, SettingsAreApartFromTheText) {
  const Sentence words = say("{} of {:.2g}: give {} or {}", "a layer", 0.123, kThickness, kRigid);
  EXPECT_EQ(words.text, "a layer of 0.12: give {0} or {1}");
  EXPECT_EQ(words.settings, (std::vector<NamedSetting>{kThickness, kRigid}));
}

TEST(Sentence, PartsKeepTheirSettings) {
  const Sentence part = say("{} or {}", kThickness, kRigid), whole = say("{}, {}, {}", kRigid, part, part);
  EXPECT_EQ(whole.text, "{0}, {1} or {2}, {3} or {4}");
  EXPECT_EQ(worded(whole, [](const NamedSetting& s) { return s.setting; }),
            "rigid, thickness or rigid, thickness or rigid");
}

TEST(Sentence, BracesOfNamesAreText) {
  const std::string name = "{0} {{a}} {";
  EXPECT_EQ(worded(name, plain_wording()), name);
  EXPECT_EQ(worded(say("{} {}", name, say("{}{}", kRigid, name)), plain_wording()), name + " rigid = a bone" + name);
}

TEST(Sentence, EveryFrontEndHasItsOwn) {
  struct Case {
    NamedSetting setting;
    const char *plain, *command_line, *settings_file, *febio;
  };
  for (const Case& c : std::vector<Case>{
           {kThickness, "thickness of \"knee\" = VALUE", "--thickness \"knee=VALUE\"",
            "<thickness surface=\"knee\">VALUE</thickness>", "<primary_thickness>VALUE</primary_thickness>"},
           {kRigid, "rigid = a bone", "--rigid \"a bone\"", "<rigid>a bone</rigid>", "<rigid>a bone</rigid>"},
           {{"free", "femur & co", "x,y,z"},
            "free of \"femur & co\" = x,y,z",
            "--free \"femur & co=x,y,z\"",
            "<free body=\"femur &amp; co\">x,y,z</free>",
            "<free body=\"femur &amp; co\">x,y,z</free>"},
           {{"law", "", "linear"}, "law = linear", "--law linear", "<law>linear</law>", "<law>linear</law>"},
           {{"states", "", "last"}, "states = last", "--states last", "<states>last</states>", "<states>last</states>"},
           {{"E"}, "E", "--E", "<E>", "<E>"}}) {
    EXPECT_EQ(plain_wording()(c.setting), c.plain);
    EXPECT_EQ(command_line_wording()(c.setting), c.command_line);
    EXPECT_EQ(settings_file_wording()(c.setting), c.settings_file);
    EXPECT_EQ(febio_wording()(c.setting), c.febio);
  }
}

TEST(Fault, ALineBeginsWithThePlaceOrTheSettingThatWasGiven) {
  const Fault at_place = {.place = "hip.feb:3", .found = "no thickness;", .expected = say("give {}", kThickness)};
  EXPECT_EQ(line(at_place, command_line_wording()), "hip.feb:3: no thickness; give --thickness \"knee=VALUE\"");
  EXPECT_EQ(line(Fault{.found = "no thickness"}), "no thickness");
  const Fault given = {.given = NamedSetting{"attach", "knee", "tibia"}, .found = "there is no such body"};
  EXPECT_EQ(line(given, command_line_wording()), "--attach knee=tibia: there is no such body");
  EXPECT_EQ(line(given, settings_file_wording()), "<attach surface=\"knee\">tibia</attach>: there is no such body");
  EXPECT_STREQ(UsageError(given).what(), "attach of \"knee\" = tibia: there is no such body");
  EXPECT_STREQ(InputError("hip.feb", 3, "a {brace}").what(), "hip.feb:3: a {brace}");
}

}  // namespace dea::sentence_test

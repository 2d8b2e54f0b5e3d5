// Distances counted by hand.
#include "src/base/names.h"

#include <gtest/gtest.h>

#include <set>

namespace dea::names_test {

TEST(Names, EditDistance) {
  EXPECT_EQ(edit_distance("hip", "hip"), 0);
  EXPECT_EQ(edit_distance("hip", "Hip"), 0);   // capitals are small letters
  EXPECT_EQ(edit_distance("hip", "hop"), 1);   // changed
  EXPECT_EQ(edit_distance("hip", "hips"), 1);  // added
  EXPECT_EQ(edit_distance("hip", "ip"), 1);    // left out
  EXPECT_EQ(edit_distance("run", "rnu"), 1);   // neighbours swapped
  EXPECT_EQ(edit_distance("", "knee"), 4);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3);
  EXPECT_EQ(edit_distance("femur", "tibia"), 5);
  const std::string a(1000, 'a'), b(1000, 'b');
  EXPECT_EQ(edit_distance(a, b), 100);  // cut
}

TEST(Names, EditDistanceIsTheSameBothWays) {
  for (const char* a : {"", "a", "ab", "ba", "abc", "acb", "sliding"})
    for (const char* b : {"", "b", "ab", "cab", "slidng", "tied"}) EXPECT_EQ(edit_distance(a, b), edit_distance(b, a));
}

TEST(Names, TheNearestIsASlipOfTheKeyboardOrNothing) {
  const std::vector<std::string> names = {"sliding-elastic", "sliding-biphasic", "tied-elastic", "run"};
  EXPECT_EQ(nearest_name("slidng-elastic", names), "sliding-elastic");
  EXPECT_EQ(nearest_name("rnu", names), "run");
  EXPECT_EQ(nearest_name("periodic boundary", names), "");
  EXPECT_EQ(nearest_name("x", names), "");
  EXPECT_EQ(nearest_name("", names), "");
  EXPECT_EQ(nearest_name("run", {}), "");
  EXPECT_EQ(did_you_mean("rnu", names), " (did you mean \"run\"?)");
  EXPECT_EQ(did_you_mean("bone", names), "");
}

TEST(Names, APartOfOneNameIsEnough) {
  const std::vector<std::string> names = {"acetabular_articulating", "femoral_articulating", "femoral_bone", "tin"};
  EXPECT_EQ(did_you_mean("acetabul", names), " (did you mean \"acetabular_articulating\"?)");
  EXPECT_EQ(did_you_mean("Bone", names), " (did you mean \"femoral_bone\"?)");
  EXPECT_EQ(did_you_mean("femoral", names), "");                       // of two
  EXPECT_EQ(did_you_mean("ac", names), "");                            // hardly a word
  EXPECT_EQ(did_you_mean("tiny", names), " (did you mean \"tin\"?)");  // the nearest comes first
  EXPECT_EQ(nearest_name("acetabul", names), "");
}

TEST(Names, CapitalsAndDashesDoNotCount) {
  EXPECT_EQ(nearest_name("SPHERE_CENTER", {"sphere-center", "sphere"}), "sphere-center");
  EXPECT_EQ(nearest_name("bodyweight", {"body-weight", "bone"}), "body-weight");
  EXPECT_EQ(nearest_name("load-type", {"load_type", "load"}), "load_type");
  EXPECT_EQ(nearest_name("neo_hookean", {"neo-Hookean", "Ogden"}), "neo-Hookean");
  EXPECT_EQ(did_you_mean("Articular-", {"femoral_articular_surface"}),
            " (did you mean \"femoral_articular_surface\"?)");
  EXPECT_EQ(nearest_name("--", {"a", "--"}), "");
}

TEST(Names, AKeyPressedTwiceForANameOfOneLetter) {
  EXPECT_EQ(nearest_name("EE", {"E", "v"}), "E");
  EXPECT_EQ(nearest_name("vv", {"E", "v"}), "v");
  EXPECT_EQ(nearest_name("Ev", {"E", "v"}), "");
}

TEST(Names, WordsThatAreUsualElsewhere) {
  constexpr Alias kAliases[] = {{"modulus", "E"}, {"Rx", "Ru"}, {"poissons_ratio", "v"}};
  EXPECT_EQ(nearest_name("modulus", {"E", "v"}, kAliases), "E");
  EXPECT_EQ(nearest_name("rx", {"Ru", "Rv", "Rw"}, kAliases), "Ru");
  EXPECT_EQ(nearest_name("Poissons-Ratio", {"E", "v"}, kAliases), "v");
  EXPECT_EQ(nearest_name("modulus", {"module"}, kAliases), "module");  // E is no name there
  EXPECT_EQ(did_you_mean("modulus", {"E", "v"}, kAliases), " (did you mean \"E\"?)");
}

TEST(Names, ListsAreShortAndOneLine) {
  EXPECT_EQ(name_list({}), "none");
  EXPECT_EQ(name_list({"b", "a"}), "\"b\", \"a\"");
  EXPECT_EQ(name_list({"far", "hop", "hip"}, "hip", 2), "\"hip\", \"hop\", ...");
  EXPECT_EQ(name_list({"two\nlines"}), "\"two\\nlines\"");
  EXPECT_EQ(name_list({std::string(1000, 'x')}), in_quotes(std::string(1000, 'x')));
}

TEST(Names, WhatSteersATerminalIsShown) {
  struct Case {
    std::string text, shown;
  };
  const Case cases[] = {
      {"femoral cartilage (left), 2.5 mm", "femoral cartilage (left), 2.5 mm"},
      {"\xc3\xbc \xe9\xaa\xa8 \xf0\x9f\xa6\xb4", "\xc3\xbc \xe9\xaa\xa8 \xf0\x9f\xa6\xb4"},  // UTF-8 of 2, 3, 4 bytes
      {"\x1b[31mred\x07\x7f", "\\x1b[31mred\\x07\\x7f"},
      {"a\r\nb\tc", "a\\x0d\\nb\\tc"},
      {std::string("a\0b", 3), "a\\x00b"},
      {"\xc2\x9b[31m", "\\u009b[31m"},                        // an escape sequence's begin as one character
      {"a\xe2\x80\xae z\xe2\x81\xa6", "a\\u202e z\\u2066"},   // what follows is to be written from the right; isolated
      {"\xfc z", "\\xfc z"},                                  // Latin 1
      {"\xe9\xaa", "\\xe9\\xaa"},                             // half a character
      {"\xc0\xaf\xed\xa0\x80", "\\xc0\\xaf\\xed\\xa0\\x80"},  // "/" in two bytes; half of a pair of UTF-16
      {"back\\slash \"quoted\"", "back\\slash \"quoted\""},
      {"", ""},
  };
  for (const Case& c : cases) {
    EXPECT_EQ(one_line(c.text), c.shown);
    EXPECT_EQ(shown(c.text), c.shown);
    EXPECT_EQ(message_line(c.text), c.shown);
    EXPECT_EQ(one_line(c.shown), c.shown);  // twice is once
  }
  EXPECT_EQ(printable("time\tp99\n\x1b"), "time\tp99\n\\x1b");  // a table's own
}

TEST(Names, LongNamesKeepTheirEnds) {
  const std::string begin(60, 'b'), end(20, 'e');
  EXPECT_EQ(shown(begin + end), begin + end);
  EXPECT_EQ(shown(begin + std::string(1000000, 'm') + end), begin + "..." + end);
  std::string letters;
  for (int i = 0; i < 1000; ++i) letters += "\xe9\xaa\xa8";
  EXPECT_EQ(shown(letters + "x").find("\\x"), std::string::npos);  // no half characters
  EXPECT_LE(shown(std::string(1000, '\x80')).size(), 4 * 83u);
}

TEST(Names, MessagesAreNoLongerThanAPage) {
  const std::string name(1000000, 'm'), text = "surface \"" + name + "\" lies on \"femur\": draw it again";
  EXPECT_EQ(message_line(text), "surface " + in_quotes(name) + " lies on \"femur\": draw it again");
  std::string quotes;
  for (int i = 0; i < 100000; ++i) quotes += "a\"";
  EXPECT_LT(message_line(quotes).size(), 5000u);
  const std::string much = "contacts " + name_list(std::vector<std::string>(40, std::string(40, 'n')), "", 40);
  EXPECT_EQ(message_line(much), much);  // long because there is much to say
}

TEST(Names, FreeNameCountsOn) {
  std::set<std::string> names = {"part"};
  EXPECT_EQ(take_free_name("ground", names), "ground");
  EXPECT_EQ(take_free_name("part", names), "part_2");
  EXPECT_EQ(take_free_name("part", names), "part_3");
  EXPECT_EQ(names.size(), 4u);
}

}  // namespace dea::names_test

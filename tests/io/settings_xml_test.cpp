// Settings as text: every option, every refusal, and what lies over what.
#include "io/settings/settings_xml.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>

#include "src/base/error.h"

namespace dea::settings_xml_test {

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::exception& e) {
    return e.what();
  }
  return "nothing thrown";
}

SettingValue value(const char* option, const char* text) { return split_key(*find_setting_option(option), text); }

Settings with(const std::vector<SettingValue>& values) {
  Settings s;
  lay_over(s, values);
  return s;
}

struct SettingsFile {
  std::string path =
      (std::filesystem::temp_directory_path() / ("dea_settings_" + std::to_string(::getpid()) + ".xml")).string();
  explicit SettingsFile(const std::string& text) { std::ofstream(path) << text; }
  ~SettingsFile() { std::filesystem::remove(path); }
  std::string fault() const {
    const std::string what = message_of([&] { read_settings_file(path); });
    return what.rfind(path, 0) == 0 ? what.substr(path.size()) : what;
  }
};

std::string fault(const std::string& elements) {
  return SettingsFile("<febiodea_settings version=\"1\">\n" + elements + "\n</febiodea_settings>\n").fault();
}

TEST(Numbers, WholeTextFiniteDecimalPoint) {
  EXPECT_EQ(parse_number("-1.5e-3"), -1.5e-3);
  EXPECT_EQ(parse_number("+2"), 2.0);
  EXPECT_EQ(parse_number(" 7 "), 7.0);
  for (const char* text : {"", "nan", "inf", "-inf", "1e999", "1.5x", "1,5", "0x10", "+-1", "--1", "1 2"})
    EXPECT_THROW(parse_number(text), BadValue) << text;
  EXPECT_EQ(parse_numbers("-1, 2,3"), (std::vector<double>{-1, 2, 3}));
  EXPECT_THROW(parse_numbers("1,,2"), BadValue);
  EXPECT_EQ(parse_vector("-1, 2,3"), Eigen::Vector3d(-1, 2, 3));
  EXPECT_EQ(message_of([] { parse_vector("1,2"); }), "found \"1,2\", expected three numbers x,y,z");
  EXPECT_EQ(parse_count("12", 1, 1000), 12);
  for (const char* text : {"0", "1.5", "1001", "-3", "", "99999999999999"})
    EXPECT_THROW(parse_count(text, 1, 1000), BadValue) << text;
}

TEST(SettingWords, EveryOption) {
  const Settings s = with({value("contact", "hip contact"),
                           value("source", "femur"),
                           value("springs-at", "BONE"),
                           value("law", "neo-hookean"),
                           value("facets", "flat"),
                           value("refine", "3"),
                           value("rigid", "bone a"),
                           value("rigid", "bone b"),
                           value("attach", "s 1=ground"),
                           value("bone", "s=t"),
                           value("thickness", "2"),
                           value("thickness", "a=b=1.5"),
                           value("E", "s=10"),
                           value("nu", "-0.2"),
                           value("free", "femur=x,z,Rw"),
                           value("free", "tibia=none"),
                           value("force", "femur=-1,2,-3e2"),
                           value("load-at", "femur=sphere-center"),
                           value("load-at", "tibia=1,2,3"),
                           value("keep-facets", "s 1"),
                           value("keep-facets", "s=2"),
                           value("keep-facets", "s 1"),
                           value("set", "a.b c.stiffness=-2.5"),
                           value("thickness-scale", "0.8"),
                           value("thickness-scale", "s=1.2"),
                           value("thickness-from", "t=a b.csv"),
                           value("squash", "false")});
  EXPECT_EQ(s.contact, "hip contact");
  EXPECT_EQ(s.source, "femur");
  EXPECT_EQ(s.springs_at, SpringsAt::Bone);
  EXPECT_EQ(s.law, Law::NeoHookean);
  EXPECT_EQ(s.facets, Facets::Flat);
  EXPECT_EQ(s.refine, 3);
  EXPECT_EQ(s.rigid, (std::vector<std::string>{"bone a", "bone b"}));
  EXPECT_EQ(s.attach.at("s 1"), "ground");
  EXPECT_EQ(s.bone.at("s"), "t");
  EXPECT_EQ(s.thickness.at(""), 2.0);
  EXPECT_EQ(s.thickness.at("a=b"), 1.5);  // cut at the last '='
  EXPECT_EQ(s.set_values, (std::map<std::string, double>{{"a.b c.stiffness", -2.5}}));
  EXPECT_EQ(s.thickness_scale, (std::map<std::string, double>{{"", 0.8}, {"s", 1.2}}));
  EXPECT_EQ(s.thickness_from.at("t").file, "a b.csv");
  EXPECT_EQ(s.E.at("s"), 10.0);
  EXPECT_EQ(s.nu.at(""), -0.2);
  EXPECT_EQ(s.free.at("femur"), (std::array<bool, 6>{true, false, true, false, false, true}));
  EXPECT_EQ(s.free.at("tibia"), (std::array<bool, 6>{}));
  EXPECT_EQ(s.force.at("femur"), Eigen::Vector3d(-1, 2, -300));
  EXPECT_TRUE(s.load_at.at("femur").sphere_center);
  EXPECT_EQ(s.load_at.at("tibia").point, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(s.keep_facets, (std::vector<std::string>{"s 1", "s=2"}));
  EXPECT_FALSE(s.squash);
}

TEST(SettingWords, NumbersAlongAFramesAxes) {
  Settings s = with({value("frame", "pelvis=0,-1,0/0,0,1/-1,0,0"), value("rotate", "hip=frame:pelvis,z,-10"),
                     value("rotate", "hip=frame:the pelvis,1,2,3,10"), value("move", "hip=frame:pelvis,1,2,3"),
                     value("force", "femur=frame:pelvis,4,5,6"), value("load-frame", "frame:pelvis,femur")});
  EXPECT_EQ(s.frames.at("pelvis").col(2), Eigen::Vector3d(-1, 0, 0));
  ASSERT_EQ(s.placements.size(), 3U);
  EXPECT_EQ(s.placements[0].frame, "pelvis");
  EXPECT_EQ(s.placements[0].vector, Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(s.placements[0].degrees, -10);
  EXPECT_EQ(s.placements[1].frame, "the pelvis");
  EXPECT_EQ(s.placements[1].vector, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(s.placements[2].vector, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(s.force.at("femur"), Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(s.force_frame.at("femur"), "pelvis");
  EXPECT_EQ(s.loads.frame.kind, TableFrame::Kind::Named);
  EXPECT_EQ(s.loads.frame.body, "femur");
  EXPECT_EQ(find_setting_option("load-frame")->content(s),
            SettingContent(SettingItem(std::string("frame:pelvis,femur"))));
  EXPECT_EQ(find_setting_option("rotate")->content(s),
            SettingContent(
                SettingItem(std::vector<std::string>{"hip=frame:pelvis,0,0,1,-10", "hip=frame:the pelvis,1,2,3,10"})));
  lay_over(s, {value("force", "femur=7,8,9")});  // the stronger one is in global directions
  EXPECT_TRUE(s.force_frame.empty());
  const auto refusal = [](const char* option, const char* text) {
    return message_of([&] { with({value(option, text)}); });
  };
  EXPECT_EQ(refusal("rotate", "hip=frame:pelvis,w,10"),
            "--rotate hip=frame:pelvis,w,10: found \"frame:pelvis,w,10\", expected an axis and an angle: "
            "frame:NAME,AXIS,DEGREES, AXIS being x, y, z or three numbers");
  EXPECT_EQ(refusal("force", "femur=frame:pelvis,1,2"),
            "--force femur=frame:pelvis,1,2: found \"frame:pelvis,1,2\", expected three numbers: frame:NAME,x,y,z");
  EXPECT_EQ(refusal("force", "femur=frame:,1,2,3"),
            "--force femur=frame:,1,2,3: found \"frame:,1,2,3\", expected a frame's name after frame:");
  EXPECT_EQ(refusal("move", "hip=frame:pelvis"),
            "--move hip=frame:pelvis: found \"frame:pelvis\", expected a comma and numbers after the frame's name: "
            "frame:NAME,...");
  EXPECT_EQ(refusal("frame", "pelvis=0,1,0/0,0,1/0,-1,0"),
            "--frame pelvis=0,1,0/0,0,1/0,-1,0: found \"0,1,0/0,0,1/0,-1,0\", expected three axes at right angles, "
            "right-handed, each in global directions: x,y,z/x,y,z/x,y,z");
  EXPECT_EQ(refusal("frame", "pelvis=femur"),
            "--frame pelvis=femur: found \"femur\", expected three axes at right angles, right-handed, each in global "
            "directions: x,y,z/x,y,z/x,y,z");
  EXPECT_EQ(refusal("frame", "pelvis"), "--frame pelvis: found no '=', expected NAME=x,y,z/x,y,z/x,y,z");
}

TEST(SettingWords, RefusalsSayWhatWasFoundAndExpected) {
  const auto refusal = [](const char* option, const char* text) {
    return message_of([&] { with({value(option, text)}); });
  };
  EXPECT_EQ(refusal("law", "quadratic"),
            "--law quadratic: found \"quadratic\", expected linear, logarithmic, neo-Hookean or layer");
  EXPECT_EQ(refusal("springs-at", "top"), "--springs-at top: found \"top\", expected articular or bone");
  EXPECT_EQ(refusal("facets", "round"), "--facets round: found \"round\", expected curved or flat");
  EXPECT_EQ(refusal("refine", "0"), "--refine 0: found \"0\", expected a whole number from 1 to 1000");
  EXPECT_EQ(refusal("thickness", "S=nan"), "--thickness S=nan: found \"nan\", expected a number");
  EXPECT_EQ(refusal("thickness", "-1"), "--thickness -1: found \"-1\", expected a number >= 0");
  EXPECT_EQ(refusal("E", "0"), "--E 0: found \"0\", expected a number > 0");
  EXPECT_EQ(refusal("nu", "0.5"), "--nu 0.5: found \"0.5\", expected a number with -1 < nu < 0.5");
  EXPECT_EQ(refusal("force", "femur=1,2"), "--force femur=1,2: found \"1,2\", expected three numbers x,y,z");
  EXPECT_EQ(refusal("force", "1,2,3"), "--force 1,2,3: found no '=', expected BODY=x,y,z");
  EXPECT_EQ(refusal("attach", "S"), "--attach S: found no '=', expected SURFACE=BODY");
  EXPECT_EQ(refusal("attach", "=B"), "--attach =B: found no name before '=', expected that of a surface");
  EXPECT_EQ(refusal("free", "femur=x,Rx"),
            "--free femur=x,Rx: found \"x,Rx\" (x is the way along x, Ru the turn about it), expected some of "
            "x,y,z,Ru,Rv,Rw, or none");
  EXPECT_EQ(refusal("load-at", "femur=middle"),
            "--load-at femur=middle: found \"middle\", expected three numbers x,y,z, or sphere-center");
  EXPECT_EQ(refusal("set", "80"), "--set 80: found no '=', expected NAME.PARAMETER=NUMBER");
  EXPECT_EQ(refusal("set", "=80"), "--set =80: found no name before '=', expected NAME.PARAMETER");
  for (const std::string key : {"ACL", ".force", "ACL."})
    EXPECT_EQ(refusal("set", (key + "=80").c_str()),
              "--set " + key + "=80: found \"" + key +
                  "\", expected NAME.PARAMETER, the parameter being stiffness, slack-length or force");
  EXPECT_EQ(refusal("set", "ACL.force=much"), "--set ACL.force=much: found \"much\", expected a number");
  EXPECT_EQ(refusal("thickness-scale", "s=0"), "--thickness-scale s=0: found \"0\", expected a number > 0");
  EXPECT_EQ(refusal("thickness-scale", "-1"), "--thickness-scale -1: found \"-1\", expected a number > 0");
  EXPECT_EQ(refusal("thickness-from", "a.csv"), "--thickness-from a.csv: found no '=', expected SURFACE=FILE");
  EXPECT_EQ(refusal("contact", " "), "--contact  : found nothing, expected NAME");
  EXPECT_EQ(message_of([] { with({value("E", "S=1"), value("E", "S=2")}); }), "--E S=2: given twice for \"S\"");
}

TEST(SettingWords, StrongerValueForAllSilencesWeakerOnes) {
  Settings s = with({value("E", "S=1"), value("nu", "S=0.1"), value("E", "9")});
  lay_over(s, {value("E", "5"), value("E", "T=6"), value("nu", "T=0.2")});
  EXPECT_EQ(s.E, (std::map<std::string, double>{{"", 5.0}, {"T", 6.0}}));
  EXPECT_EQ(s.nu, (std::map<std::string, double>{{"S", 0.1}, {"T", 0.2}}));
}

// One number and a file say the same thing of a surface: the stronger source's way holds.
TEST(SettingWords, StrongerThicknessTakesThePlaceOfTheOtherWay) {
  Settings s = with({value("thickness", "S=1"), value("thickness", "T=2"), value("thickness-from", "U=u.csv")});
  lay_over(s, {value("thickness-from", "S=s.csv"), value("thickness", "U=3")});
  EXPECT_EQ(s.thickness, (std::map<std::string, double>{{"T", 2.0}, {"U", 3.0}}));
  ASSERT_EQ(s.thickness_from.size(), 1u);
  EXPECT_EQ(s.thickness_from.at("S").file, "s.csv");
  lay_over(s, {value("thickness", "4")});
  EXPECT_TRUE(s.thickness_from.empty());
  s = with({value("thickness", "S=1"), value("thickness-from", "S=s.csv")});  // one source: refused with the model
  EXPECT_EQ(s.thickness.size() + s.thickness_from.size(), 2u);
}

TEST(SettingsXml, ReadsEveryKindOfElement) {
  const SettingsFile file(
      "<?xml version=\"1.0\"?>\n<febiodea_settings version=\"1\">\n <!-- a comment -->\n <law> logarithmic </law>\n"
      " <set name=\"ACL.stiffness\">80</set>\n <thickness-scale surface=\"U\">0.8</thickness-scale>\n"
      " <thickness-from surface=\"U\"> u.csv </thickness-from>\n"
      " <thickness>2</thickness>\n <thickness surface=\"S &amp; T\">1.5</thickness>\n <rigid>a</rigid>\n "
      "<rigid>b</rigid>\n"
      " <force body=\"femur\">1, -2,3</force>\n <load-at body=\"femur\">sphere-center</load-at>\n "
      "<squash>false</squash>\n</febiodea_settings>\n");
  const Settings s = read_settings_file(file.path).settings;
  EXPECT_EQ(s.law, Law::Logarithmic);
  EXPECT_EQ(s.thickness, (std::map<std::string, double>{{"", 2.0}, {"S & T", 1.5}}));
  EXPECT_EQ(s.set_values, (std::map<std::string, double>{{"ACL.stiffness", 80.0}}));
  EXPECT_EQ(s.thickness_scale, (std::map<std::string, double>{{"U", 0.8}}));
  EXPECT_EQ(s.thickness_from.at("U").file, "u.csv");
  EXPECT_EQ(s.rigid, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(s.force.at("femur"), Eigen::Vector3d(1, -2, 3));
  EXPECT_TRUE(s.load_at.at("femur").sphere_center);
  EXPECT_FALSE(s.squash);
}

TEST(SettingsXml, OutputFilesAndStates) {
  const SettingsFile file(
      "<febiodea_settings version=\"1\"><output> a b.xplt </output><json>a.json</json><csv>a.csv</csv>"
      "<facets-csv>f.csv</facets-csv><report>a b.html</report><vtu>folder</vtu><states>0.5, "
      "1</states><law>logarithmic</law></febiodea_settings>");
  const dea::SettingsFile read = read_settings_file(file.path);
  EXPECT_EQ(read.outputs.output, "a b.xplt");
  EXPECT_EQ(read.outputs.json, "a.json");
  EXPECT_EQ(read.outputs.csv, "a.csv");
  EXPECT_EQ(read.outputs.facets_csv, "f.csv");
  EXPECT_EQ(read.outputs.report, "a b.html");
  EXPECT_EQ(read.outputs.vtu, "folder");
  EXPECT_EQ(read.outputs.states, "0.5, 1");
  EXPECT_EQ(read.settings.law, Law::Logarithmic);
  EXPECT_EQ(fault("<states>some</states>"),
            ":2: <states>: found \"some\", expected all, last, times t1,t2,... or ranges t1:t2");
  EXPECT_EQ(fault("<json/>"), ":2: <json>: found nothing, expected a file name");
  EXPECT_EQ(fault("<report>a.html</report>\n<report>a.html</report>"),
            ":3: <report>: found a second one, expected it once");
  EXPECT_EQ(fault("<vtu/>"), ":2: <vtu>: found nothing, expected the name of a folder");
  EXPECT_EQ(fault("<csv a=\"1\">x</csv>"), ":2: <csv>: found attribute \"a\", expected none");
  EXPECT_EQ(fault("<output>a<b/></output>"), ":2: <output>: found <b>, expected a file name");
  EXPECT_EQ(fault("<json>a</json>\n<json>b</json>"), ":3: <json>: found a second one, expected it once");
  EXPECT_EQ(fault("<no-xplt>yes</no-xplt>"), ":2: <no-xplt>: found \"yes\", expected true or false");
  EXPECT_EQ(fault("<no-xplt>true</no-xplt>\n<output>a.xplt</output>"),
            ":3: found both <no-xplt> and <output>, expected one of them");
}

std::string text_of(const std::string& path) {
  std::ifstream in(std::string(DEA_SAMPLES_DIR) + "/../" + path);
  return std::string(std::istreambuf_iterator<char>(in), {});
}

// A setting that nobody can read of is none.
TEST(SettingsTable, TheManualNamesEveryOption) {
  const std::string manual = text_of("docs/settings.md");
  const auto names = [](const std::string& text, const std::string& word) {
    for (const char* after : {" ", "`", ",", ":"})
      if (text.find(word + after) != std::string::npos) return true;
    return false;
  };
  for (const SettingOption& o : setting_options()) {
    const std::string name = o.name;
    EXPECT_TRUE(names(manual, "--" + name)) << name;
    EXPECT_NE(manual.find("</" + name + ">`"), std::string::npos) << name;
  }
  for (const OutputOption& o : output_options()) {
    EXPECT_TRUE(names(manual, command_line_name(o))) << o.name;
    EXPECT_NE(manual.find(std::string("</") + o.name + ">`"), std::string::npos) << o.name;
  }
}

// What is set is shown, and nothing is shown before.
TEST(SettingsTable, ShowsWhatWasSet) {
  const Settings s = with({value("law", "layer"), value("nu", "s=0.3"), value("free", "femur=x,Rw"),
                           value("load-at", "femur=sphere-center"), value("layer-terms", "1"),
                           value("set", "ACL.force=7"), value("thickness-from", "s=f.csv")});
  const auto shown = [&](const char* option) { return find_setting_option(option)->content(s); };
  using Items = std::map<std::string, SettingItem>;
  EXPECT_EQ(shown("law"), SettingContent(SettingItem(std::string("layer"))));
  EXPECT_EQ(shown("facets"), SettingContent(SettingItem()));
  EXPECT_EQ(shown("layer-terms"), SettingContent(SettingItem(1)));
  EXPECT_EQ(shown("nu"), SettingContent(Items{{"s", 0.3}}));
  EXPECT_EQ(shown("E"), SettingContent(Items{}));
  EXPECT_EQ(shown("set"), SettingContent(Items{{"ACL.force", 7.0}}));
  EXPECT_EQ(shown("thickness-from"), SettingContent(Items{{"s", std::string("f.csv")}}));
  EXPECT_EQ(shown("free"), SettingContent(Items{{"femur", std::vector<std::string>{"x", "Rw"}}}));
  EXPECT_EQ(shown("load-at"), SettingContent(Items{{"femur", std::string("sphere-center")}}));
}

TEST(SettingsXml, RefusalsNameTheLine) {
  EXPECT_EQ(fault("<law>cubic</law>"),
            ":2: <law>: found \"cubic\", expected linear, logarithmic, neo-Hookean or layer");
  std::string all;  // in the order of the tables
  for (const SettingOption& o : setting_options()) all += (all.empty() ? "<" : ", <") + std::string(o.name) + ">";
  for (const OutputOption& o : output_options()) all += ", <" + std::string(o.name) + ">";
  EXPECT_EQ(fault("\n<Law>linear</Law>"), ":3: found <Law> (did you mean \"law\"?), expected one of " + all);
  EXPECT_EQ(fault("<force>1,2,3</force>"), ":2: <force>: found no attribute \"body\", expected body=\"NAME\"");
  EXPECT_EQ(fault("<force surface=\"S\">1,2,3</force>"), ":2: <force>: found attribute \"surface\", expected \"body\"");
  EXPECT_EQ(fault("<set>80</set>"), ":2: <set>: found no attribute \"name\", expected name=\"NAME\"");
  EXPECT_EQ(fault("<set name=\"ACL\">80</set>"),
            ":2: <set>: found \"ACL\", expected NAME.PARAMETER, the parameter being stiffness, slack-length or force");
  EXPECT_EQ(fault("<law a=\"b\">linear</law>"), ":2: <law>: found attribute \"a\", expected none");
  EXPECT_EQ(fault("<law/>"), ":2: <law>: found nothing, expected linear|logarithmic|neo-Hookean|layer");
  EXPECT_EQ(fault("<law>\n<linear/></law>"),
            ":3: <law>: found <linear>, expected linear|logarithmic|neo-Hookean|layer");
  EXPECT_EQ(fault("<E>1</E>\n<E>2</E>"), ":3: <E>: found a second one, expected it once");
  EXPECT_EQ(SettingsFile("<settings/>").fault(), ":1: found <settings>, expected <febiodea_settings version=\"1\">");
  EXPECT_EQ(SettingsFile("<febiodea_settings version=\"2\"/>").fault(), ":1: found version \"2\", expected \"1\"");
  EXPECT_EQ(SettingsFile("<febiodea_settings version=\"1\">\n<law>linear</E>\n").fault(),
            ":2: found no well-formed XML, expected <febiodea_settings version=\"1\">");
  std::string deep;
  for (int i = 0; i < 100'000; ++i) deep += "<a>";
  EXPECT_EQ(SettingsFile(deep).fault(), ":1: found no well-formed XML, expected <febiodea_settings version=\"1\">");
  EXPECT_EQ(SettingsFile("").fault(), ":1: found no well-formed XML, expected <febiodea_settings version=\"1\">");
  EXPECT_EQ(message_of([] { read_settings_file("/nonexistent/s.xml"); }),
            "/nonexistent/s.xml: found no readable file, expected a settings file");
  EXPECT_NE(message_of([] { read_settings_file("/tmp"); }), "nothing thrown");
}

}  // namespace dea::settings_xml_test

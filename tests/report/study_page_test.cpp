// The page of a study, without a browser: what stands in its JSON and arrays against answers on paper.
#include <gtest/gtest.h>
#include <zlib.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "io/tables/table.h"
#include "src/base/error.h"
#include "tests/program.h"
#include "tests/report/made_study.h"
#include "tests/report/page_arrays.h"
#include "views/study_page/study_page.h"
#include "views/study_page/study_statistics.h"
#include "views/study_page/study_subjects.h"

namespace dea::study_page_test {

using nlohmann::json;
using test::TemporaryFolder;

struct Page {
  std::string html;
  json data;

  std::string between(const std::string& start, const std::string& end) const {
    const std::size_t a = html.find(start) + start.size();
    return html.substr(a, html.find(end, a) - a);
  }
  std::vector<double> floats(const json& array) const {
    return test::floats(between("id=\"array" + array["id"].dump() + "\">", "</script>"), array);
  }
  std::vector<double> codes(const json& array) const {
    return test::integers(between("id=\"array" + array["id"].dump() + "\">", "</script>"), array);
  }
  std::vector<double> values(int statistic, int place) const {
    return floats(data["values"][static_cast<std::size_t>(statistic)][static_cast<std::size_t>(place)]);
  }
};

struct StudyPage : ::testing::Test {
  TemporaryFolder folder;
  std::string path = (folder.path / "plan.db").string(), html = (folder.path / "plan.html").string();

  Page page(const StudyPageOptions& options = {}) {
    write_study_page(html, path, options);
    Page p;
    p.html = test::file_text(html);
    p.data = json::parse(p.between("<script type=\"application/json\" id=\"report\">", "</script>"));
    return p;
  }
  std::string fault(const StudyPageOptions& options) {
    try {
      page(options);
    } catch (const UsageError& e) {
      return e.what();
    }
    return "no fault";
  }
  /// One state a case, with the number that `number` has for it, counted from 0; NaN: it is not solved yet.
  void write_numbers(const Plan& plan, const std::function<double(int)>& number) {
    StudyWriter writer(path, plan, {"0.1", {}, {}, 1, 1});
    for (std::size_t i = 0; i < plan.cases.size(); ++i) {
      const double x = number(static_cast<int>(i));
      if (std::isnan(x)) continue;
      CaseResult r = test::solved(i + 1, "hip");
      r.states = {test::state(0, x)};
      writer.add(std::move(r));
    }
    writer.finish();
  }
};

double area_of(const CaseSurface& on) {
  double whole = 0.0;
  for (const auto& t : on.triangles) {
    const Vector3d a = on.vertices[at(t[0])];
    whole += 0.5 * (on.vertices[at(t[1])] - a).cross(on.vertices[at(t[2])] - a).norm();
  }
  return whole;
}

/// Cases of one factor x = 1, 2, ...: pressure x times `shape` of the state's number everywhere. `contact`: the area
/// that the contact's headline has, over that of the surface.
void write_uniform(const std::string& path, int cases, const std::vector<double>& shape, double duration = 1.0,
                   double contact = 1.0) {
  const Plan plan = test::grid({fmt::format("x: E={{1:{}:1}}", cases)});
  StudyWriter writer(path, plan, {"0.1", {}, {}, 1, 1});
  const CaseSurface on = test::surface();
  for (int i = 1; i <= cases; ++i) {
    CaseResult r = test::solved(static_cast<std::size_t>(i), "hip");
    for (std::size_t k = 0; k < shape.size(); ++k) {
      r.states.push_back(
          test::state(duration * static_cast<double>(k) / static_cast<double>(shape.size() - 1), i * shape[k]));
      r.states.back().fields = {{std::vector<float>(on.vertices.size(), static_cast<float>(i * shape[k]))}};
      r.states.back().statistics[0].headline.area = contact * area_of(on);
    }
    if (i == 1) r.surfaces = {on};
    writer.add(std::move(r));
  }
  writer.finish();
}

TEST_F(StudyPage, StatesThatAreNoSolutionAreInNoNumber) {
  test::write_awkward(path);
  const Page p = page();
  EXPECT_EQ(p.data["failures"]["cases"], 2);
  EXPECT_EQ(p.data["study"]["failed"], 1);
  EXPECT_EQ(p.data["study"]["refused"], 1);
  EXPECT_EQ(p.data["failures"]["states"], 1);
  for (int s = 0; s < 5; ++s)
    for (double x : p.values(s, 0)) EXPECT_FALSE(x > 1e5) << s;
  // of the case with a state that is none the others are there, and no largest
  const std::vector<double> p99 = p.values(0, 0);
  const std::size_t choices = p.data["choices"].size();
  ASSERT_EQ(choices, 4u);
  EXPECT_NEAR(p99[10 * choices], 13, 1e-6);
  EXPECT_TRUE(std::isnan(p99[10 * choices + 2]));
  EXPECT_TRUE(std::isnan(p99[10 * choices + 3]));
  EXPECT_NEAR(p99[9 * choices + 3], 12, 1e-6);
  EXPECT_EQ(p.data["summary"][0][0][3]["left_out"], 2);
  EXPECT_EQ(p.data["summary"][0][0][3]["count"], 10);
  for (const json& f : p.data["maps"]["fields"])
    if (f["number"] == 11) {
      EXPECT_EQ(f["entries"].size(), 2u);  // two states, nothing over the cycle
    }
}

TEST_F(StudyPage, NamesAreEscaped) {
  test::write_awkward(path);
  const Page p = page();
  const std::string data = p.between("id=\"report\">", "</script>");
  EXPECT_EQ(data.find('<'), std::string::npos);
  EXPECT_EQ(p.data["columns"][1]["name"].get<std::string>().substr(0, 12), "</script><b>");
}

TEST_F(StudyPage, AStateWithoutContactDoesNotHideTheLargest) {
  const Plan plan = test::grid({"x: E={1|2}"});
  StudyWriter writer(path, plan, {"0.1", {}, {}, 1, 1});
  for (std::size_t i = 1; i <= 2; ++i) {
    CaseResult r = test::solved(i, "hip");
    r.states = {test::state(0, kNaN), test::state(1, 5), test::state(2, 3)};
    writer.add(std::move(r));
  }
  writer.finish();
  const std::vector<double> p99 = page().values(0, 0);
  EXPECT_TRUE(std::isnan(p99[0]));
  EXPECT_EQ(p99[3], 5);
}

TEST_F(StudyPage, IshigamisIndicesAreTheKnownOnes) {
  test::write_sample(path);
  const Page p = page();
  EXPECT_EQ(p.data["influence"]["no_sobol"], "");
  const json& of = p.data["influence"]["numbers"][0][0][0]["sobol"];
  const double V = 49.0 / 8 + 0.1 * std::pow(kPi, 4) / 5 + 0.01 * std::pow(kPi, 8) / 18 + 0.5;
  const double V1 = 0.5 * std::pow(1 + 0.1 * std::pow(kPi, 4) / 5, 2), V2 = 49.0 / 8;
  const double first[] = {V1 / V, V2 / V, 0}, total[] = {1 - V2 / V, V2 / V, 1 - (V1 + V2) / V};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(of[k]["first"], first[k], 0.06) << k;  // 512 rows of a Sobol sequence
    EXPECT_NEAR(of[k]["total"], total[k], 0.06) << k;
    EXPECT_LT(of[k]["first_interval"][0], first[k]);
    EXPECT_GT(of[k]["first_interval"][1], first[k]);
  }
  EXPECT_TRUE(p.data["influence"]["numbers"][0][0][0]["slopes"].empty());  // points that are drawn have no neighbours
}

TEST_F(StudyPage, SlopesAndRegressionOfAPlane) {
  const Plan plan = test::grid({"a: E={1:5:1}", "b: nu={0|1|2}", "c: law={linear|layer}"});
  write_numbers(plan, [&](int i) {
    const std::vector<std::string>& of = plan.cases[at(i)].values;
    return 10 + 3 * parse_number(of[0]) - parse_number(of[1]);
  });
  const Page p = page();
  const json& of = p.data["influence"]["numbers"][0][0][0];
  EXPECT_NEAR(of["r_squared"], 1, 1e-9);
  // variances of 1..5 and 0..2 are 2 and 2/3: shares 18 and 2/3 of 18 + 2/3
  EXPECT_NEAR(of["factors"][0]["coefficient"], std::sqrt(18 / (18 + 2.0 / 3)), 1e-8);
  EXPECT_NEAR(of["factors"][1]["coefficient"], -std::sqrt(2.0 / 3 / (18 + 2.0 / 3)), 1e-8);
  ASSERT_EQ(of["slopes"].size(), 2u);
  EXPECT_EQ(p.data["influence"]["base"], 15);  // a = 3, b = 1, the first law
  EXPECT_NEAR(of["slopes"][0]["slope"], 3, 1e-9);
  EXPECT_NEAR(of["slopes"][1]["slope"], -1, 1e-9);
  EXPECT_NEAR(of["slopes"][0]["relative"], 3 * 3 / 18.0, 1e-9);
  EXPECT_EQ(of["slopes"][0]["kind"], "central");
}

/// Force is what the load gives: to the search's tolerance it is the same in all cases, and no factor moves it.
/// Pressure differs, and is told as before.
TEST_F(StudyPage, RoundingIsNoInfluence) {
  const Plan plan = test::grid({"x: E={1:6:1}"});
  StudyWriter writer(path, plan, {"0.1", {}, {}, 1, 1});
  for (std::size_t i = 1; i <= plan.cases.size(); ++i) {
    CaseResult r = test::solved(i, "hip");
    r.states = {test::state(0, static_cast<double>(i))};
    r.states[0].statistics[0].force = {0, 0, 1800 + 1e-6 * static_cast<double>(i)};
    writer.add(std::move(r));
  }
  writer.finish();
  StudyPageOptions options;
  options.group = "x";
  const Page p = page(options);
  const json &of = p.data["influence"]["numbers"], &pressure = of[0][0][0], &force = of[4][0][0];
  EXPECT_NEAR(pressure["r_squared"].get<double>(), 1, 1e-9);
  EXPECT_TRUE(force["r_squared"].is_null()) << force;
  EXPECT_TRUE(force["factors"][0]["coefficient"].is_null()) << force;
  EXPECT_TRUE(force["factors"][0]["rho"].is_null()) << force;
  EXPECT_EQ(p.data["groups"]["numbers"][4][0][0]["differences"][0]["mean"], 0);
}

TEST_F(StudyPage, AGridWithoutItsMiddleHasSlopes) {
  const Plan plan = test::grid({"x: E={1|2|3}", "y: nu={0.1|0.2|0.3}"});
  write_numbers(plan, [](int i) { return i == 4 ? kNaN : i / 3; });
  const Page p = page();
  EXPECT_EQ(p.data["influence"]["no_slopes"], "");
  ASSERT_EQ(p.data["influence"]["numbers"][0][0][0]["slopes"].size(), 2u);
  EXPECT_NEAR(p.data["influence"]["numbers"][0][0][0]["slopes"][0]["slope"].get<double>(), 1, 1e-6);
}

TEST_F(StudyPage, ValuesWithCommasMakePairs) {
  const Plan plan = test::grid({"axis: rotate pelvis={0,1,0,5|1,0,0,5|0,0,1,5}"});
  write_numbers(plan, [](int i) { return i + 1; });
  StudyPageOptions options;
  options.pair = "axis=0,1,0,5,0,0,1,5";
  EXPECT_EQ(page(options).data["pairs"]["cases"], json::parse("[[0, 2]]"));
  options.pair = "axis=0,1,0,5";
  EXPECT_NE(fault(options).find("expected two of"), std::string::npos) << fault(options);
}

TEST_F(StudyPage, PairsAreCasesThatDifferInNothingElse) {
  const Plan plan = test::grid({"side: E={1|2}", "x: nu={1:4:1}"});
  write_numbers(plan, [](int i) {
    if (i == 3) return kNaN;  // 4 of the first side is not there
    return i < 4 ? 10.0 + i : 20.0 + 2 * (i % 4);
  });
  StudyPageOptions o;
  o.pair = "side";
  o.group = "side";
  const Page p = page(o);
  EXPECT_EQ(p.data["pairs"]["cases"], json::parse("[[0,3],[1,4],[2,5]]"));  // places of cases 1 .. 3 and 5 .. 7
  EXPECT_EQ(p.data["pairs"]["alone"], 1);
  const json& of = p.data["pairs"]["numbers"][0][0][0];  // differences -10, -11, -12
  EXPECT_NEAR(of["mean"], -11, 1e-9);
  EXPECT_NEAR(of["sd"], 1, 1e-9);
  EXPECT_NEAR(of["limits"][0], -11 - 1.959963985, 1e-6);
  const json& groups = p.data["groups"]["numbers"][0][0][0];
  EXPECT_NEAR(groups["boxes"][0]["median"], 11, 1e-9);
  EXPECT_NEAR(groups["differences"][0]["mean"], 23 - 11, 1e-9);  // of 20, 22, 24, 26 and 10, 11, 12
  o.pair = "side=2,1";
  EXPECT_NEAR(page(o).data["pairs"]["numbers"][0][0][0]["mean"], 11, 1e-9);
  const auto with = [](const std::string& pair, const std::string& group) {
    StudyPageOptions wrong;
    wrong.pair = pair;
    wrong.group = group;
    return wrong;
  };
  EXPECT_EQ(fault(with("x", "")), "--pair x: found 4 values of x, expected two: --pair x=A,B");
  EXPECT_EQ(fault(with("side=1,3", "")), "--pair side=1,3: found no value \"3\" of side, expected two of \"1\", \"2\"");
  EXPECT_EQ(fault(with("side=1", "")), "--pair side=1: found one value, expected two: side=A,B");
  EXPECT_EQ(fault(with("", "sise")),
            "--group sise: found no column \"sise\" that differs from case to case (did you mean \"side\"?); there are "
            "\"side\", \"x\"");
}

TEST_F(StudyPage, DoseOfAConstantPressure) {
  write_uniform(path, 4, {1, 1, 1});
  StudyPageOptions o;
  o.maps.dose_above = 2.5;
  o.maps.cycles_per_year = 2e6;
  o.maps.years = 20;
  o.maps.cycle_seconds = 1.1;
  const Page p = page(o);
  const double years = 1.1 * 2e6 * 20 / 31557600;
  const json& cases = p.data["maps"]["dose"]["cases"];
  ASSERT_EQ(cases.size(), 4u);
  for (int x = 1; x <= 4; ++x) {
    const json& of = cases[static_cast<std::size_t>(x - 1)];
    EXPECT_NEAR(of["largest"], std::max(0.0, x - 2.5) * years, 1e-6);
    EXPECT_NEAR(of["exposure"], x * years, 1e-6);
    EXPECT_NEAR(of["shares"][0], x > 2.5 ? 1 : 0, 1e-12);
  }
  o.maps.cycles_per_year.reset();
  o.maps.years.reset();
  EXPECT_NEAR(page(o).data["maps"]["dose"]["cases"][3]["exposure"], 4 * 1.1, 1e-6);  // of one cycle, in seconds
  o.maps.cycles_per_year = 2e6;
  o.maps.years = 20;
  write_uniform((folder.path / "percent.db").string(), 2, {1, 1}, 100.0);
  path = (folder.path / "percent.db").string();
  o.maps.cycle_seconds.reset();
  EXPECT_EQ(
      fault(o),
      "a dose over years: found states over 100 units of time, which are no seconds of a cycle (10 at most; time in "
      "percent or steps?), expected how long a cycle takes: --cycle-seconds");
  o.maps.cycle_seconds = 1.0;
  EXPECT_EQ(fault(o), "no fault");
}

TEST_F(StudyPage, PressuresComeBackAndTheirMeansAreThere) {
  write_uniform(path, 3, {0.5, 1, 2});
  const Page p = page();
  const json& maps = p.data["maps"];
  ASSERT_EQ(maps["fields"].size(), 3u);
  const std::size_t nodes = static_cast<std::size_t>(test::kSide * test::kSide);
  for (const json& f : maps["fields"]) {
    const double x = f["number"].get<double>();
    const double expected[] = {0.5 * x, x, 2 * x, 2 * x, x * (0.25 * (0.5 + 1) + 0.25 * (1 + 2))};  // largest, mean
    const std::vector<double> codes = p.codes(f["values"]);
    ASSERT_EQ(f["entries"].size(), 5u);
    ASSERT_EQ(codes.size(), 5 * nodes);
    for (std::size_t e = 0; e < 5; ++e) {
      const double least = f["entries"][e][1], most = f["entries"][e][2];
      EXPECT_NEAR(least + codes[e * nodes] * (most - least) / 65534, expected[e], 1e-5 * expected[e]) << e;
    }
  }
  const json& kinds = p.data["means"]["surfaces"][0];
  ASSERT_EQ(kinds.size(), 4u);
  EXPECT_NEAR(kinds[1]["groups"][0]["area_mean"], 2, 1e-6);  // of 1, 2, 3
  EXPECT_NEAR(kinds[1]["groups"][0]["area_spread"], 1, 1e-6);
  EXPECT_NEAR(kinds[3]["groups"][0]["area_mean"], 2.25, 1e-6);  // 2 times (0.75 + 1.5) / 2
}

TEST_F(StudyPage, TheEdgeOfContactEnclosesTheAreaOfTheFacets) {
  test::write_grid(path, test::grid({"a: E={0|8}", "b: nu={0|1}", "c: move pelvis={1|2},0,0"}), true);
  const Page p = page();
  const CaseSurface on = test::surface();
  std::vector<int> begin = {0}, nodes;
  for (const auto& t : on.triangles) {
    nodes.insert(nodes.end(), t.begin(), t.end());
    begin.push_back(static_cast<int>(nodes.size()));
  }
  const MapMesh map = make_map_mesh(make_result_surface("socket", begin, nodes, on.vertices));
  const json& f = p.data["maps"]["fields"][3];
  const std::vector<double> codes = p.codes(f["values"]);
  for (std::size_t e : {0u, 6u, 12u}) {
    const double least = f["entries"][e][1], most = f["entries"][e][2];
    std::vector<double> values;
    for (std::size_t v = 0; v < on.vertices.size(); ++v)
      values.push_back(least + codes[e * on.vertices.size() + v] * (most - least) / 65534);
    EXPECT_NEAR(area_above(map, values, f["entries"][e][3]), 400, 0.1) << e;  // facet_contact_area of made_study.h
  }
}

TEST_F(StudyPage, RegionsAddUpToTheContact) {
  StudyPageOptions o;
  o.maps.regions.sectors = 4;
  o.maps.regions.up = Vector3d(0, 1, 0);
  o.maps.regions.axis = Vector3d(0, 0, 1);
  o.maps.regions.center = Vector3d(0.3, 0.2, 0);  // no vertex on the axis
  for (double contact : {1.0, 0.9}) {
    path = (folder.path / fmt::format("{}.db", contact)).string();
    write_uniform(path, 2, {1, 2}, 1.0, contact);
    const Page p = page(o);
    ASSERT_EQ(p.data["places"].size(), 5u);
    double area = 0.0;
    for (std::size_t r = 1; r <= 4; ++r) {
      EXPECT_NEAR(p.values(1, static_cast<int>(r))[2], 2, 1e-6);  // the mean in each: the largest state of case 1
      area += p.values(2, static_cast<int>(r))[1];
    }
    EXPECT_NEAR(area, contact * area_of(test::surface()), 1e-4 * area);
  }
  o.maps.regions = {};
  o.maps.regions.socket = true;
  o.maps.regions.up = Vector3d(0, 1, 0);
  o.maps.regions.anterior = Vector3d(1, 0, 0);
  EXPECT_EQ(page(o).data["places"][2]["part"], "anterior lateral");
}

/// Of the source's layer alone, at the bone two of three: no others are offered.
TEST_F(StudyPage, NumbersOfTheInsideAreThoseThatSomeContactHas) {
  test::write_subjects(path);
  const Page p = page();
  std::vector<std::string> names, dimensions;
  for (const json& s : p.data["statistics"]) {
    names.push_back(s["name"]);
    dimensions.push_back(s["dimension"]);
  }
  EXPECT_EQ(names,
            (std::vector<std::string>{"headline_p99", "headline_mean", "headline_area", "headline_peak", "force",
                                      "source_bone_max_shear_stress_p99", "source_bone_third_principal_strain_p99"}));
  EXPECT_EQ(dimensions[5], "pressure");
  EXPECT_EQ(dimensions[6], "none");
  EXPECT_EQ(p.data["statistics"][5]["title"], "Max shear stress at the bone, source (p99)");
  EXPECT_EQ(p.data["statistics"][6]["title"], "Third principal strain at the bone, source (1st percentile)");
  const std::vector<double> shear = p.values(5, 0), strain = p.values(6, 0);
  ASSERT_EQ(shear.size(), 3u * 2 * test::kSubjects);  // two states, and the largest of them
  EXPECT_NEAR(shear[1], 0.3 * test::before(1), 1e-6);
  EXPECT_NEAR(shear[2], 0.3 * test::before(1), 1e-6);
  EXPECT_NEAR(strain[0], -0.01 * test::before(1), 1e-7);
  EXPECT_NEAR(strain[2], -0.02 * test::before(1), 1e-7);  // of compression the largest is the least number
  EXPECT_EQ(p.data["contacts"], json::parse(R"([["hip", "pelvis", "femur"]])"));
}

TEST(StudyNumbers, NamesOfFilesAreAsShortAsTellsThemApart) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(short_names({"/a/b/one.feb", "two.feb"}), (Names{"one.feb", "two.feb"}));
  EXPECT_EQ(short_names({"/a/b/hip.feb", "/a/c/hip.feb", "/a/c/knee.feb"}),
            (Names{"b/hip.feb", "c/hip.feb", "knee.feb"}));
  EXPECT_EQ(short_names({"/x/before/S1/hip.feb", "/x/after/S1/hip.feb", "/x/after/S2/hip.feb"}),
            (Names{"before/S1/hip.feb", "after/S1/hip.feb", "S2/hip.feb"}));
  EXPECT_EQ(short_names({"hip.feb", "b/hip.feb", "/hip.feb"}), (Names{"hip.feb", "b/hip.feb", "/hip.feb"}));
  EXPECT_EQ(short_names({"/only/one.feb"}), Names{"one.feb"});
}

struct StudySubjects : StudyPage {
  CaseTable table(const std::string& text) {
    const std::string csv = (folder.path / "subjects.csv").string();
    std::ofstream(csv) << text;
    return read_case_table(csv);
  }
  StudyPageOptions with(const std::string& group, const std::string& pair, const std::string& by = "") {
    StudyPageOptions o;
    o.subjects = table(test::subjects_table());
    o.group = group;
    o.pair = pair;
    o.pair_by = by;
    return o;
  }
  std::string refusal(const std::string& text) {
    const CaseTable subjects = table(text);
    try {
      study_numbers_with(path, subjects);
    } catch (const InputError& e) {
      const std::string what = e.what(), start = (folder.path / "subjects.csv").string();
      return what.rfind(start, 0) == 0 ? what.substr(start.size()) : what;
    }
    return "no fault";
  }
};

TEST_F(StudySubjects, ColumnsOfATableMakeGroups) {
  test::write_subjects(path);
  const Page p = page(with("sex", ""));
  EXPECT_EQ(p.data["columns"][0]["name"], "model");
  EXPECT_TRUE(p.data["columns"][0]["of"].is_null());
  EXPECT_EQ(p.data["columns"][0]["levels"][1], "before/S2.feb");
  EXPECT_EQ(p.data["columns"][2]["name"], "sex");
  EXPECT_EQ(p.data["columns"][2]["of"], "model");
  EXPECT_TRUE(p.data["grid"]);  // of the study's own columns
  EXPECT_EQ(p.data["subjects"], "subjects.csv");
  const json& groups = p.data["groups"]["numbers"][0][0][2];
  // men: 11, 13, 15 before and 9.5, 12.5, 15.5 after; women 12, 14, 16 and 11, 14, 17
  EXPECT_NEAR(groups["boxes"][0]["mean"], 76.5 / 6, 1e-7);
  EXPECT_NEAR(groups["boxes"][1]["mean"], 84.0 / 6, 1e-7);
  EXPECT_NEAR(groups["differences"][0]["mean"], 7.5 / 6, 1e-7);
  // angle is a number: it is in the regression, but no case lies beside another by it alone
  const json& of = p.data["influence"]["numbers"][0][0][2];
  EXPECT_EQ(of["factors"][0]["column"], 4);
  EXPECT_TRUE(of["slopes"].empty());
}

TEST_F(StudySubjects, SubjectsAreTheirOwnPartners) {
  test::write_subjects(path);
  // the angle differs too: nobody has a partner unless only the subject counts
  EXPECT_EQ(
      fault(with("", "stage")),
      "--pair stage: found no two cases that differ in stage alone, expected pairs; --pair-by COLUMN names the one "
      "column of the table that partners share");
  EXPECT_EQ(
      fault(with("", "stage", "sex")),
      "--pair stage: found cases 1 and 3 with the same values, expected one case each: another column of the table "
      "must tell who is who, such as \"subject\"");
  const Page p = page(with("", "stage", "subject"));
  ASSERT_EQ(p.data["pairs"]["cases"].size(), 6u);
  EXPECT_EQ(p.data["pairs"]["cases"][1], json::parse("[1, 7]"));
  const json& of = p.data["pairs"]["numbers"][0][0][2];  // differences 2 - k / 2: 1.5, 1, ... -1
  EXPECT_NEAR(of["mean"], 0.25, 1e-7);
  EXPECT_NEAR(of["sd"], std::sqrt(0.25 * 3.5), 1e-7);  // of 1 .. 6 the variance is 3.5
  EXPECT_EQ(fault(with("", "stage", "stage")).find("--pair-by stage: belongs to pairs by a column of the table"), 0u);
  EXPECT_EQ(fault(with("", "model=before/S1.feb,after/S1.feb")), "no fault");
}

/// Pressure is p (1 + x / R) on spheres of six radii, on twelve meshes none of which is another's: their mean is that
/// of p at the same angles.
TEST_F(StudySubjects, MapsOfDifferentMeshesAreAveragedOnOneGrid) {
  test::write_subjects(path);
  const Page p = page(with("stage", ""));
  ASSERT_EQ(p.data["means"]["common"].size(), 1u);
  const json& common = p.data["means"]["common"][0];
  EXPECT_EQ(common["surfaces"].size(), 6u);  // before and after stand on the same mesh
  const std::vector<double> xyz = p.floats(p.data["meshes"][common["mesh"].get<std::size_t>()]["vertices"]);
  const double radius = 33.5;  // mean of 31 .. 36
  const auto map = [&](const json& packed) {
    std::vector<double> values;
    const double least = packed["least"], most = packed["most"];
    for (double code : p.codes(packed["values"]))
      values.push_back(code == 65535 ? kNaN : least + code * (most - least) / 65534);
    return values;
  };
  /// x / R of the place that an equal-area map shows there.
  const auto across = [&](std::size_t v) {
    const double r = std::hypot(xyz[3 * v], xyz[3 * v + 1]);
    return r > 0 ? std::sin(2 * std::asin(r / (2 * radius))) * xyz[3 * v] / r : 0.0;
  };
  double mean = 0.0, square = 0.0;
  for (int k = 1; k <= test::kSubjects; ++k) {
    mean += (test::before(k) + test::after(k)) / 12;
    square += std::pow(test::before(k), 2) + std::pow(test::after(k), 2);
  }
  const double sd = std::sqrt((square - 12 * mean * mean) / 11);
  const json& kind = common["kinds"][1];  // the second state
  EXPECT_EQ(kind["groups"][0]["cases"], 12);
  const std::vector<double> means = map(kind["groups"][0]["mean"]), sds = map(kind["groups"][0]["sd"]);
  const std::vector<double> less = map(kind["differences"][0]["values"]);
  const std::vector<double> count = p.codes(kind["groups"][0]["count"]);
  ASSERT_EQ(3 * means.size(), xyz.size());
  std::size_t shown = 0, all = 0;
  // linear between nodes 40 / 16 apart on a sphere of 31: off by h^2 / 8 of the curvature, (2.5 / 31)^2 / 8 = 0.0008 of
  // p, twice that where the map is stretched
  for (std::size_t v = 0; v < means.size(); ++v) {
    if (count[v] == 12) ++all;
    if (!std::isfinite(means[v])) continue;
    ++shown;
    EXPECT_NEAR(means[v], mean * (1 + across(v)), 0.0016 * mean) << v;
    if (count[v] < 12) continue;
    EXPECT_NEAR(sds[v], sd * (1 + across(v)), 0.0016 * mean) << v;
    EXPECT_NEAR(less[v], -0.25 * (1 + across(v)), 0.0016 * 0.5) << v;  // after less before: 13.25 less 13.5
  }
  EXPECT_GT(shown, 0.97 * static_cast<double>(means.size()));
  EXPECT_GT(all, 0.9 * static_cast<double>(means.size()));
  // points stand for the area of the surfaces at the mean radius
  const CaseSurface on = test::surface(61, radius);
  double area = 0.0;
  for (const auto& t : on.triangles) {
    const Vector3d a = on.vertices[at(t[0])];
    area += 0.5 * (on.vertices[at(t[1])] - a).cross(on.vertices[at(t[2])] - a).norm();
  }
  const double step = common["step"];
  EXPECT_NEAR(static_cast<double>(means.size()) * step * step, area, 0.02 * area);  // the rim's points are half outside
  EXPECT_TRUE(p.data["means"]["surfaces"][0].empty());
  EXPECT_NE(p.data["notes"][0].get<std::string>().find("of 6 different meshes"), std::string::npos) << p.data["notes"];
}

TEST_F(StudySubjects, SurfacesThatAreNoSphereHaveNoCommonGrid) {
  Plan plan;
  plan.models = {"/a/one.feb", "/b/two.feb"};
  for (int i = 0; i < 4; ++i) plan.cases.push_back({i / 2, {}});
  StudyWriter writer(path, plan, {"0.1", {}, {}, 1, 1});
  for (std::size_t i = 0; i < 4; ++i) {
    CaseResult r = test::solved(i + 1, "knee");
    if (i % 2 == 0) r.surfaces = {test::surface(5 + static_cast<int>(i))};
    for (CaseSurface& s : r.surfaces)
      for (Vector3d& v : s.vertices) v[2] = 0.0;
    const std::size_t nodes = i < 2 ? 25 : 49;
    r.states = {test::state(0, 1)};
    r.states[0].fields = {{std::vector<float>(nodes, static_cast<float>(i + 1))}};
    writer.add(std::move(r));
  }
  writer.finish();
  const Page p = page();
  EXPECT_EQ(p.data["means"]["common"].size(), 0u);
  ASSERT_EQ(p.data["means"]["surfaces"].size(), 2u);  // two cases each, of its own mesh
  EXPECT_NEAR(p.data["means"]["surfaces"][1][0]["groups"][0]["area_mean"], 3.5, 1e-6);
  EXPECT_EQ(p.data["notes"][0],
            "mean maps of contact \"knee\" are of each of its 2 meshes by itself: surface \"socket\" is no part of a "
            "sphere, which a common grid needs");
}

TEST_F(StudySubjects, TablesThatDoNotFitAreRefused) {
  test::write_subjects(path);
  std::string text = test::subjects_table();
  EXPECT_EQ(refusal(text), "no fault");
  EXPECT_EQ(refusal(text + "S9.feb,S9,F,before,1\n").find(":14: found model \"S9.feb\""), 0u);
  EXPECT_EQ(refusal(text + "after/S1,S1,F,after,1\n"),
            ":14: found model \"after/S1\" as in line 8, expected one row each");
  EXPECT_EQ(refusal(text + "S1.feb,S1,F,after,1\n"),
            ":14: column \"model\": found \"S1.feb\", which may be \"/data/before/S1.feb\", \"/data/after/S1.feb\", "
            "expected more of its path");
  EXPECT_EQ(refusal(text.substr(0, text.find("after/S6"))),
            ": found no row of model \"after/S6.feb\", expected one row each");
  EXPECT_EQ(refusal("subject,sex\nS1,F\n"),
            ":1: found columns \"subject\", \"sex\", expected one column that says what a row is of: \"model\", "
            "\"case_id\"");
  EXPECT_EQ(refusal("model\nS1\n"),
            ":1: found no column but \"model\", expected others, such as \"subject\" or \"sex\"");
  text.replace(text.find(",M,"), 3, ",NA,");
  EXPECT_EQ(refusal(text), ":2: column \"sex\": found \"NA\", expected a value");
}

TEST_F(StudySubjects, RowsMayBeOfCasesAndOfValues) {
  write_uniform(path, 3, {1, 2});
  const StudyNumbers by_case = study_numbers_with(path, table("case_id,who\n3,c\n1,a\n2,b\n"));
  ASSERT_EQ(by_case.columns.size(), 2u);
  EXPECT_EQ(by_case.columns[1].levels, (std::vector<std::string>{"a", "b", "c"}));
  EXPECT_EQ(by_case.own_columns(), 1u);
  const StudyNumbers by_value = study_numbers_with(path, table("x,who\n1.0,a\n2e0,b\n3,a\n"));
  EXPECT_EQ(by_value.columns[1].level, (std::vector<int>{0, 1, 0}));
  EXPECT_EQ(by_value.columns[1].of, "x");
  EXPECT_NE(refusal("x,who\n1,a\n2,b\n4,a\n").find(":4: found x \"4\""), std::string::npos);
}

TEST_F(StudyPage, ValuesOfPairsAreNumbers) {
  const Plan plan = test::grid({"E: E={8|10.5}", "x: nu={0.1|0.2}"});
  write_numbers(plan, [](int i) { return i + 1; });
  StudyPageOptions o;
  o.pair = "E=8.0,1.05e1";
  EXPECT_EQ(page(o).data["pairs"]["cases"], json::parse("[[0, 2], [1, 3]]"));
  o.pair = "E=8.1,10.5";
  EXPECT_EQ(fault(o), "--pair E=8.1,10.5: found no value \"8.1\" of E, expected two of \"8\", \"10.5\"");
}

/// More cases than all pairs of which could be looked at, as a grid with a hole in its middle. The number is 2 x - 3 y.
TEST_F(StudyPage, ALargeGridWithoutItsMiddleHasSlopes) {
  constexpr int kLevels = 65;
  const Plan plan = test::grid({fmt::format("x: E={{1:{}:1}}", kLevels), fmt::format("y: nu={{1:{}:1}}", kLevels)});
  write_numbers(
      plan, [](int i) { return i == kLevels * kLevels / 2 ? kNaN : 1000 + 2.0 * (i / kLevels) - 3.0 * (i % kLevels); });
  const StudyNumbers n = read_study_numbers(path);
  const StudyDesign design = study_design(n);
  EXPECT_EQ(design.no_slopes, "");
  ASSERT_GE(design.base, 0);
  // beside the hole diagonally: all its neighbours are there
  const std::size_t base = n.cases[at(design.base)].number - 1;
  EXPECT_EQ(base, static_cast<std::size_t>(31 * kLevels + 31));
  const Json slopes = influence_json(n, design, n.outputs(0, 0, 0), {})["slopes"];
  ASSERT_EQ(slopes.size(), 2u);
  EXPECT_EQ(slopes[0]["kind"], "central");
  EXPECT_NEAR(slopes[0]["slope"], 2, 1e-9);
  EXPECT_NEAR(slopes[1]["slope"], -3, 1e-9);
}

TEST_F(StudyPage, AThinnedGridIsAGridWithItsEnds) {
  test::write_grid(path, test::grid({"a: E={1:9:1}", "b: nu={1:5:1}", "c: move pelvis={1|2},0,0"}), false);
  const StudyNumbers n = read_study_numbers(path);
  ASSERT_TRUE(n.grid);
  const std::vector<char> kept =
      thinned_cases(n, std::vector<char>(n.cases.size(), 1),
                    [](const std::vector<char>& some) { return std::count(some.begin(), some.end(), 1) <= 20; });
  std::set<int> levels[3];
  for (std::size_t c = 0; c < kept.size(); ++c)
    for (std::size_t k = 0; k < 3 && kept[c] != 0; ++k) levels[k].insert(n.columns[k].level[c]);
  EXPECT_EQ(static_cast<std::size_t>(std::count(kept.begin(), kept.end(), 1)),
            levels[0].size() * levels[1].size() * levels[2].size());
  EXPECT_EQ(*levels[0].begin(), 0);
  EXPECT_EQ(*levels[0].rbegin(), 8);
  EXPECT_EQ(levels[2].size(), 2u);
}

TEST_F(StudyPage, WithoutPressuresThereAreNoDosesAndRegions) {
  test::write_sample(path);
  StudyPageOptions o;
  o.maps.dose_above = 2;
  EXPECT_EQ(fault(o),
            "a dose: found no stored pressures in the study, expected one that was solved with pressures at "
            "nodes kept (fields)");
  EXPECT_FALSE(std::filesystem::exists(html));
}

}  // namespace dea::study_page_test

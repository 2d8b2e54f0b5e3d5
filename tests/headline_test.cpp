// The one set of numbers that stands for a pressure map: on paper, and the same digits wherever it is printed.
#include "src/results/headline.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "io/results/result_file.h"
#include "views/data/json.h"
#include "views/map/map_figure.h"
#include "views/text/table.h"

#include "tests/program.h"

namespace dea::headline_test {

/// nx by ny squares of side h from (left, 0).
ResultSurface squares(int nx, int ny, double h, double left = 0.0) {
  std::vector<Vector3d> x;
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) x.emplace_back(left + i * h, left + j * h, 0.0);
  std::vector<int> begin = {0}, nodes;
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      const int a = j * (nx + 1) + i;
      nodes.insert(nodes.end(), {a, a + 1, a + nx + 2, a + nx + 1});
      begin.push_back(static_cast<int>(nodes.size()));
    }
  }
  return make_result_surface("squares", begin, nodes, x);
}

TEST(Headline, RampOnAStripIsAsOnPaper) {
  // p = 2 x: facet f of 200 unit squares has 2 f + 1. Sum of A p = 40000, of A p^2 = 200 (4 200^2 - 1) / 3 = 10666600.
  // 0.05 of their ratio is 13.33325, above which is what lies at x > 6.666625: the edge runs through facet 6. A row of
  // facets gives its slope to a thousandth, the edge to as much of its 0.17 from the facet's middle.
  const ResultSurface s = squares(200, 1, 1.0);
  std::vector<double> p;
  for (int f = 0; f < 200; ++f) p.push_back(2 * f + 1);
  const Headline h = headline(s, p);
  EXPECT_NEAR(h.above, 0.05 * 10666600 / 40000, 1e-10);
  EXPECT_NEAR(h.area, 200 - 6.666625, 3e-4);
  EXPECT_NEAR(h.mean, 200 + 6.666625, 3e-4);
  // The two nodes at x = k have 2 k and together the area 1, at the ends 1 and 399 and half of it: above are those from
  // x = 7 on, 193.5. 0.99 of it is 191.565: the pair at x = 198 stands at 191.25 and 191.75.
  EXPECT_DOUBLE_EQ(h.peak, 399);
  EXPECT_NEAR(h.p99, 396, 1e-10);

  // half of the strip, with the threshold of the whole; its last node has half of its area there
  FacetMask half(200, 0);
  std::fill(half.begin(), half.begin() + 100, char{1});
  const Headline left = headline(s, p, half);
  EXPECT_EQ(left.above, h.above);
  EXPECT_NEAR(left.area, 100 - 6.666625, 3e-4);
  EXPECT_NEAR(left.mean, 100 + 6.666625, 3e-4);
  EXPECT_NEAR(left.peak, 200, 1e-10);
}

TEST(Headline, ATriangleGivesAThirdToEachOfItsNodes) {
  const ResultSurface s =
      make_result_surface("two", {0, 3, 6}, {0, 1, 2, 0, 2, 3}, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  const Headline h = headline(s, {3, 9});  // facets of area 1/2; nodes 6, 3, 6, 9 with areas 1/3, 1/6, 1/3, 1/6
  EXPECT_NEAR(h.above, 0.05 * 45 / 6, 1e-12);
  EXPECT_NEAR(h.mean, 6, 1e-12);
  EXPECT_NEAR(h.area, 1, 1e-12);
  EXPECT_NEAR(h.peak, 9, 1e-12);
}

TEST(Headline, NoPressureHasNoNumbersAndNoArea) {
  const Headline h = headline(squares(3, 2, 1.0), std::vector<double>(6, 0.0));
  EXPECT_EQ(h.area, 0);
  for (double x : {h.above, h.p99, h.mean, h.peak}) EXPECT_TRUE(std::isnan(x));
}

TEST(Headline, UnitsChangeNothing) {
  std::vector<double> p = {0, 0.02, 3, 1, 5, 0, 0, 0.7, 2}, pascal;
  for (double x : p) pascal.push_back(1e6 * x);
  const Headline mm = headline(squares(3, 3, 1.0), p), m = headline(squares(3, 3, 1e-3), pascal);
  EXPECT_NEAR(m.above, 1e6 * mm.above, 1e-6 * m.above);
  EXPECT_NEAR(m.area, 1e-6 * mm.area, 1e-12 * mm.area);
  for (double Headline::*number : {&Headline::p99, &Headline::mean, &Headline::peak})
    EXPECT_NEAR(m.*number, 1e6 * (mm.*number), 1e-9 * m.*number);
}

// ---- the program ----

/// Without units in brackets.
std::vector<std::string> words(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> out;
  for (std::string word; in >> word;)
    if (word.front() != '[') out.push_back(word);
  return out;
}

std::vector<std::string> cells(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> out;
  for (std::string cell; std::getline(in, cell, ',');) out.push_back(cell);
  return out;
}

std::string line_with(const std::string& text, const std::string& start) {
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);)
    if (line.rfind(start, 0) == 0) return line;
  return "";
}

/// The numbers of the last line of a CSV by their columns.
std::vector<double> headline_of_csv(const std::string& csv, std::size_t line) {
  std::istringstream in(csv);
  std::vector<std::vector<std::string>> rows;
  for (std::string text; std::getline(in, text);) rows.push_back(cells(text));
  std::vector<double> out;
  for (const HeadlineNumber& number : kHeadlineNumbers)
    for (std::size_t c = 0; c < rows[0].size(); ++c)
      if (rows[0][c] == std::string("headline_") + number.name) out.push_back(std::stod(rows[line][c]));
  return out;
}

std::vector<double> headline_of_json(const Json& j) {
  std::vector<double> out;
  for (const HeadlineNumber& number : kHeadlineNumbers) out.push_back(j[number.name].get<double>());
  return out;
}

Json page_json(const std::filesystem::path& path) {
  const std::string html = test::file_text(path), start = "<script type=\"application/json\" id=\"report\">";
  const std::size_t from = html.find(start) + start.size();
  return Json::parse(html.substr(from, html.find("</script>", from) - from));
}

struct Case {
  std::string model, source;  ///< source: of the springs; empty: the primary surface
};

class HeadlineProgram : public ::testing::TestWithParam<Case> {};

TEST_P(HeadlineProgram, PrintsTheSameDigitsEverywhere) {
  const test::TemporaryFolder folder;
  const auto dea = [&](std::vector<std::string> line) {
    line.insert(line.begin(), DEA_PROGRAM);
    test::Finished f = test::run_program(folder.path, line, 120);
    EXPECT_EQ(f.code, 0) << f.err;
    return f;
  };
  std::vector<std::string> line = {"run",      std::string(DEA_SAMPLES_DIR) + "/" + GetParam().model,
                                   "-o",       "a.xplt",
                                   "--json",   "run.json",
                                   "--csv",    "run.csv",
                                   "--report", "run.html",
                                   "--states", "last"};
  if (!GetParam().source.empty()) line.insert(line.end(), {"--source", GetParam().source});
  const test::Finished run = dea(line);
  const Json run_json = Json::parse(test::file_text(folder.path / "run.json"));
  const Json contact = run_json["states"].back()["contacts"][0]["headline"];
  const std::vector<double> numbers = headline_of_json(contact);
  ASSERT_GT(numbers[2], 0);
  std::vector<std::string> digits;
  for (double x : numbers) digits.push_back(four_digits(x));

  // dea run: the table's first numbers, CSV and the page's table
  const std::vector<std::string> heads = words(line_with(run.out, "time"));
  ASSERT_GE(heads.size(), 7u);
  EXPECT_EQ((std::vector<std::string>{heads[3], heads[4], heads[5], heads[6]}),
            (std::vector<std::string>{"p99", "mean", "area", "peak"}));
  const std::vector<std::string> row = words(line_with(run.out.substr(run.out.find("\ntime")), "   "));
  ASSERT_GE(row.size(), 7u) << run.out;
  EXPECT_EQ((std::vector<std::string>{row[3], row[4], row[5], row[6]}), digits);
  EXPECT_EQ(headline_of_csv(test::file_text(folder.path / "run.csv"), 1), numbers);
  const Json run_page = page_json(folder.path / "run.html");
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(run_page["tables"][0]["rows"][0][3 + k], digits[k]);
  EXPECT_EQ(run_page["surfaces"][0]["names"][0], contact["surface"]);  // springs lead
  EXPECT_EQ(headline_of_json(run_page["surfaces"][0]["measures"][0].back()[0]["headline"]), numbers);

  // dea compare, of the plot file with itself
  const test::Finished compare = dea({"compare", "a.xplt", "a.xplt", "--json", "c.json", "--csv", "c.csv", "--report",
                                      "c.html", "--label", "one", "--label", "two"});
  const Json json = Json::parse(test::file_text(folder.path / "c.json"));
  EXPECT_EQ(json["surfaces"][0]["names"][0], contact["surface"]);
  const Json& results = json["surfaces"][0]["regions"][0]["results"];
  for (std::size_t i : {0u, 1u}) {
    EXPECT_EQ(headline_of_json(results[i]["headline"]), numbers);
    EXPECT_EQ(headline_of_csv(test::file_text(folder.path / "c.csv"), i + 1), numbers);
  }
  EXPECT_EQ(results[0]["headline"]["above"], contact["above"]);
  const Json compare_page = page_json(folder.path / "c.html");
  EXPECT_EQ(headline_of_json(compare_page["surfaces"][0]["measures"][1].back()[0]["headline"]), numbers);
  const std::string table =
      compare.out.substr(compare.out.find("surface " + contact["surface"].get<std::string>() + "\n"));
  for (std::size_t k = 0; k < 4; ++k) {
    const std::vector<std::string> line_of = words(line_with(table, std::string(kHeadlineNumbers[k].name) + " "));
    ASSERT_EQ(line_of.size(), 4u) << table;
    EXPECT_EQ(line_of[1], digits[k]);
    EXPECT_EQ(compare_page["tables"][0]["rows"][k][1], digits[k]);
  }

  // dea plot, facets and nodes
  const ResultFile file = read_result((folder.path / "a.xplt").string(), "a");
  for (bool smooth : {false, true}) {
    MapOptions options;
    options.smooth = smooth;
    const MapFigure figure = make_map_figure({file}, nullptr, options);
    EXPECT_EQ(figure.surfaces[0].name, contact["surface"].get<std::string>());
    const std::vector<std::string> parts = cells(figure.panels[0].numbers[0]);
    ASSERT_EQ(parts.size(), 4u) << figure.panels[0].numbers[0];
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_EQ(words(parts[k])[0], kHeadlineNumbers[k].name);
      EXPECT_EQ(words(parts[k])[1], digits[k]);
    }
  }

  // the rest, and only when asked for
  EXPECT_EQ(run.out.find("peak, springs"), std::string::npos);
  EXPECT_EQ(compare.out.find("peak, facets"), std::string::npos);
  const test::Finished more = dea({"compare", "a.xplt", "a.xplt", "-o", "x.xplt", "--details"});
  for (const char* name : {"peak, facets > 0", "p99, nodes > 0 ", "area, nodes > 0.1", "mean, nodes > 0.5"})
    EXPECT_NE(more.out.find(name), std::string::npos) << more.out;
  line.push_back("--details");
  const test::Finished details = dea(line);
  for (const char* name : {"peak, facets > 0", "peak, springs", "area, springs", "mean, nodes > 0, unweighted"})
    EXPECT_NE(details.out.find(name), std::string::npos) << details.out;
}

INSTANTIATE_TEST_SUITE_P(Samples, HeadlineProgram,
                         ::testing::Values(Case{"hip/hip_walking.feb", ""}, Case{"hip/hip_walking.feb", "femur"},
                                           Case{"sphere_on_flat/sphere_on_flat.feb", ""}),
                         [](const auto& info) {
                           return info.index == 1 ? std::string("springs_on_the_other_side")
                                                  : info.param.model.substr(0, info.param.model.find('/'));
                         });

}  // namespace dea::headline_test

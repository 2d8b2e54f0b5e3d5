// The page of dea build: its numbers against answers on paper, names that look like markup.
#include "views/build_page/build_page.h"

#include <gtest/gtest.h>

#include <cmath>

#include "src/build/mend_surface.h"
#include "views/data/json.h"
#include "views/text/build_text.h"

#include "tests/build/build_shapes.h"
#include "tests/report/page_arrays.h"

namespace dea::test {
namespace {

struct Page {
  std::string html;
  Json report;
  std::string between(const std::string& from, const std::string& to) const {
    const std::size_t begin = html.find(from) + from.size();
    return html.substr(begin, html.find(to, begin) - begin);
  }
  std::vector<double> values(const Json& array) const {
    return test::floats(between("id=\"array" + array["id"].dump() + "\">", "</script>"), array);
  }
};

/// Two squares 3 apart, 1 of cartilage on each.
struct Squares {
  BuildRequest request;
  BuildReport report;
  BuiltJoint joint;
  BuiltModelSettings model;
  std::vector<BuildBalance> balances;
  std::vector<double> times;
  Anatomy anatomy;
  Findings of_run;
  std::string output = "folder/joint.feb";

  explicit Squares(const std::string& name) {
    for (const auto& [bone, surface] :
         {std::pair{name, square(9, 10, 0, true)}, std::pair{std::string("upper"), square(7, 10, 3, false)}}) {
      BoneRequest b;
      b.name = bone;
      b.surface = mend_surface(surface).surface;
      b.closed = false;
      request.bones.push_back(b);
      CartilageRequest c;
      c.bone = static_cast<int>(request.cartilages.size());
      c.way = CartilageRequest::Way::Uniform;
      c.thickness = 1;
      request.cartilages.push_back(c);
    }
    request.bones[1].fixed = false;
    request.bones[1].force = {0, 0, -10};
    request.reach = 5;
    joint = build_joint(request, report);
    report.findings.push_back("folder/</script><b>.stl: found");
    balances.resize(1);
    balances[0].words = "no balance </script>";
    balances[0].displacement.assign(2, Vector3d::Zero());
    of_run.push_back({"never-touching"});
  }
  Page page() const {
    const BuildSummary summary{output, joint, report, model, balances, times, anatomy, of_run};
    Page p;
    p.html = build_page_html({summary,
                              request,
                              {request.bones[0].surface, request.bones[1].surface},
                              {"dea", "build", "folder/</script><b>.stl"},
                              {"folder/</script><b>.stl"}});
    p.report = Json::parse(p.between("<script type=\"application/json\" id=\"report\">", "</script>"));
    return p;
  }
};

TEST(BuildPage, ItsMapsAreTheAnswerOnPaper) {
  const Page page = Squares("lower").page();
  ASSERT_EQ(page.report["layers"].size(), 2U);
  for (const Json& layer : page.report["layers"]) {
    // in single precision: exact
    for (const double t : page.values(layer["thickness"])) EXPECT_EQ(t, 1.0);
    for (const double g : page.values(layer["gap"])) EXPECT_FLOAT_EQ(static_cast<float>(g), 1.0F);
    // a right isosceles triangle: sin 45 degrees over sin 60 degrees
    const double exact = std::sqrt(0.5) / std::sqrt(0.75);
    for (const double j : page.values(layer["jacobian"])) EXPECT_NEAR(j, exact, 1e-6);
    const Json& counts = layer["jacobians"]["counts"];
    int all = 0;
    for (std::size_t k = 0; k < counts.size(); ++k) {
      const double from = static_cast<double>(k) / static_cast<double>(counts.size());
      if (counts[k] != 0) {
        EXPECT_TRUE(from <= exact && exact < from + 1.0 / static_cast<double>(counts.size())) << k;
      }
      all += counts[k].get<int>();
    }
    EXPECT_EQ(all, layer["name"] == "lower_cartilage" ? 2 * 2 * 81 : 2 * 2 * 49);  // two elements a triangle
  }
  EXPECT_EQ(page.report["scales"]["thickness"][0], 0);
  EXPECT_EQ(page.report["scales"]["jacobian"][1], 1);
}

TEST(BuildPage, ItsTablesAreThoseOfTheProgram) {
  const Squares squares("lower");
  const Page page = squares.page();
  const BuildSummary s{squares.output,   squares.joint, squares.report,  squares.model,
                       squares.balances, squares.times, squares.anatomy, squares.of_run};
  const std::vector<TitledTable> tables = build_tables(s);
  ASSERT_EQ(page.report["tables"].size(), tables.size() + 1);  // and the options
  for (std::size_t i = 0; i < tables.size(); ++i)
    EXPECT_EQ(page.report["tables"][i]["rows"], Json(tables[i].table.rows));
  EXPECT_EQ(page.report["tables"].back()["rows"][0], Json({"reach", "5 mm", "as given"}));
  EXPECT_EQ(page.report["title"], "joint");
  EXPECT_TRUE(page.report["hip_figure"].is_null());
  ASSERT_EQ(page.report["warnings"].size(), 2U);  // its own, and that of dea run
  EXPECT_EQ(page.report["warnings"][1],
            "the surfaces touch in no state: the motions that are prescribed bring them nowhere together "
            "[never-touching]");
  EXPECT_EQ(build_json(s)["warnings"], page.report["warnings"]);
  EXPECT_EQ(build_json(s)["finding_values"][0]["code"], "never-touching");
}

TEST(BuildPage, NamesAreNoMarkup) {
  const Squares squares("</script><b>&\"'\xc3\xa9\xff");
  const Page page = squares.page(), plain = Squares("lower").page();
  const auto times = [](const std::string& text, const std::string& word) {
    int n = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
    return n;
  };
  EXPECT_EQ(times(page.html, "</script>"), times(page.html, "<script"));
  EXPECT_EQ(times(page.html, "</script>"), times(plain.html, "</script>"));
  EXPECT_EQ(page.html.find("<b>"), plain.html.find("<b>"));
  EXPECT_EQ(page.report["bodies"][0]["name"], "</script><b>&\"'\xc3\xa9\xef\xbf\xbd");
  EXPECT_EQ(page.html.find("folder/"), std::string::npos);
  EXPECT_EQ(page.html, squares.page().html);
}

}  // namespace
}  // namespace dea::test

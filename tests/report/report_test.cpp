// The page's writer: what is packed comes back, names stay names, numbers are those of compare, files stay whole.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "tests/io/plot_files.h"
#include "tests/program.h"
#include "tests/report/page_arrays.h"
#include "tests/report/synthetic.h"
#include "views/map/map_figure.h"
#include "views/map/map_geometry.h"
#include "views/map/map_scale.h"
#include "views/page/page_parts.h"
#include "views/page/write_page.h"

namespace dea::report_test {

using Json = nlohmann::json;
namespace fs = std::filesystem;

using test::words;

std::vector<std::uint32_t> words(const PackedArray& a) { return words(a.base64, a.count, a.bytes, a.delta); }

float as_float(std::uint32_t word) {
  float x = 0;
  std::memcpy(&x, &word, sizeof x);
  return x;
}

/// A page taken apart.
struct PageParts {
  std::string html;
  Json report;

  explicit PageParts(const std::string& text) : html(text) {
    const std::string begin = "<script type=\"application/json\" id=\"report\">";
    const std::size_t at = html.find(begin) + begin.size();
    report = Json::parse(html.substr(at, html.find("</script>", at) - at));
  }
  std::vector<std::uint32_t> array(const Json& about) const {
    const std::string begin = "<script type=\"text/plain\" id=\"array" + std::to_string(about["id"].get<int>()) + "\">";
    const std::size_t at = html.find(begin);
    if (at == std::string::npos) throw std::runtime_error("no such array");
    const std::size_t from = at + begin.size();
    return words(html.substr(from, html.find("</script>", from) - from), about["count"], about["bytes"],
                 about["delta"]);
  }
};

std::string page_of(const std::vector<ResultFile>& files, const CompareOptions& options = {}) {
  return page_html(compare_page(files, options, compare_files(files, options), {"dea", "compare"}));
}

std::size_t times_in(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t i = text.find(what); i != std::string::npos; i = text.find(what, i + 1)) ++n;
  return n;
}

// ---- packing ----

/// As page/data.js reads a code (views/page/page_parts.h).
double restore(const Codes& c, std::size_t i) {
  if (c.codes[i] == 65535) return std::numeric_limits<double>::quiet_NaN();
  const double fraction = c.codes[i] / 65534.0;
  return c.least * (1.0 - fraction) + c.most * fraction;
}

TEST(ReportPack, IntegersComeBack) {
  std::mt19937 random(1);
  std::vector<std::int32_t> values = {-1, 0, 2147483647, -2147483647 - 1, 5, 5, -1};
  for (int i = 0; i < 5000; ++i) values.push_back(static_cast<std::int32_t>(random()));
  const std::vector<std::uint32_t> back = words(pack_integers(values));
  ASSERT_EQ(back.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) ASSERT_EQ(static_cast<std::int32_t>(back[i]), values[i]) << i;
  EXPECT_TRUE(words(pack_integers({})).empty());
}

TEST(ReportPack, FloatsComeBackToTheBit) {
  std::vector<float> values = {0.0f, -0.0f, 1.5f, -3e38f, 1e-40f, std::numeric_limits<float>::quiet_NaN()};
  const std::vector<std::uint32_t> back = words(pack_floats(values));
  ASSERT_EQ(back.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::uint32_t word = 0;
    std::memcpy(&word, &values[i], sizeof word);
    EXPECT_EQ(back[i], word) << i;
  }
  EXPECT_TRUE(std::isnan(as_float(back.back())));
}

TEST(ReportPack, CodesKeepWithinHalfAStep) {
  std::mt19937 random(2);
  for (const double range : {1e-30, 1.0, 7.3, 1e30, std::numeric_limits<double>::max()}) {
    for (const double offset : {0.0, -0.5, -1.0}) {
      std::uniform_real_distribution<double> uniform(0.0, 1.0);
      std::vector<double> values = {offset * range, (1 + offset) * range};
      for (int i = 0; i < 4000; ++i) values.push_back((uniform(random) + offset) * range);
      const Codes codes = quantise(values);
      const double step = codes.most / 65534.0 - codes.least / 65534.0;
      ASSERT_TRUE(std::isfinite(step));
      for (std::size_t i = 0; i < values.size(); ++i) {
        const bool lifted = values[i] > codes.least && values[i] < codes.least + 0.5 * step;
        ASSERT_LE(std::abs(restore(codes, i) - values[i]), (lifted ? 1.0 : 0.5001) * step) << range << " " << i;
      }
      const std::vector<std::uint32_t> back = words(pack_codes(codes.codes));
      for (std::size_t i = 0; i < values.size(); ++i) ASSERT_EQ(back[i], codes.codes[i]);
    }
  }
}

TEST(ReportPack, NoPressureStaysNoneAndLittlePressureStaysSome) {
  const Codes codes = quantise({0.0, 1e-9, 5.0, std::nan(""), 0.0});
  EXPECT_EQ(restore(codes, 0), 0.0);
  EXPECT_GT(restore(codes, 1), 0.0);
  EXPECT_DOUBLE_EQ(restore(codes, 2), 5.0);
  EXPECT_TRUE(std::isnan(restore(codes, 3)));
  EXPECT_EQ(restore(codes, 4), 0.0);
}

TEST(ReportPack, ConstantsAndNothingButUndefined) {
  const Codes constant = quantise({2.5, 2.5});
  EXPECT_EQ(restore(constant, 0), 2.5);
  EXPECT_EQ(restore(constant, 1), 2.5);
  const Codes undefined = quantise({std::nan(""), std::nan("")});
  EXPECT_TRUE(std::isnan(restore(undefined, 0)));
  EXPECT_EQ(undefined.least, 0.0);
  EXPECT_TRUE(quantise({}).codes.empty());
}

// ---- the page ----

TEST(ReportPage, NamesAreNeverMarkup) {
  const PageParts page(page_of(test::awkward_results()));
  EXPECT_EQ(page.html.find("<b>"), std::string::npos);
  EXPECT_EQ(page.html.find("<i>mesh"), std::string::npos);
  EXPECT_EQ(page.html.find("<img"), std::string::npos);
  EXPECT_NE(page.html.find("<title>&lt;/script&gt;&lt;b&gt;&amp;"), std::string::npos);
  EXPECT_EQ(times_in(page.html, "</script>"), times_in(page.html, "<script"));
  // the names themselves are all there; the byte that is no UTF-8 has become the sign for that
  EXPECT_EQ(page.report["results"][0]["label"], "</script><b>&\"'\xc3\xa9\xef\xbf\xbd");
  EXPECT_EQ(page.report["surfaces"][0]["title"], "</script><b>&\"'\xc3\xa9\xef\xbf\xbd");
  EXPECT_EQ(page.report["context"]["parts"][0], "<img src=x onerror=alert(1)>");
}

/// A result of one shell, whose nodes are moved in each state as told.
ResultFile moved(const std::vector<std::function<Vector3d(const Vector3d&)>>& motions) {
  const test::PlotPatch p = test::sheet(6, 4, 6, 4, [](double x, double y) { return Vector3d(x, y, 0.1 * x * y); });
  ResultFile file =
      test::result_of("moved", p, std::vector<std::vector<double>>(motions.size(), std::vector<double>(24, 1)));
  file.xplt.variables.push_back(XpltVariable{XpltGroup::Nodal, XpltType::Vec3, XpltFormat::Node, "displacement"});
  for (std::size_t s = 0; s < motions.size(); ++s) {
    std::vector<float> values;
    for (const Vector3d& x : p.nodes)
      for (int k = 0; k < 3; ++k) values.push_back(static_cast<float>((motions[s](x) - x)[k]));
    file.xplt.states[s].variables.push_back({{0, values}});
  }
  return file;
}

TEST(ReportPage, PartsMoveAsTheirNodesDo) {
  // On paper: a turn of 30 degrees about (1, 2, 2) / 3 and a shift; nothing; and a stretch along x about the middle,
  // whose nearest rigid motion is none.
  const Eigen::AngleAxisd turn(kPi / 6, Vector3d(1, 2, 2) / 3);
  const Vector3d shift(3, -1, 0.5);
  const ResultFile file =
      moved({[&](const Vector3d& x) { return Vector3d(turn * x + shift); }, [](const Vector3d& x) { return x; },
             [](const Vector3d& x) { return Vector3d(x[0] + 0.2 * (x[0] - 3), x[1], x[2]); }});
  PageContext context = make_context(file.xplt.meshes[0]);
  add_motion(file, 0, {0}, context);
  ASSERT_EQ(context.parts_move.size(), 3u);
  for (const auto* of : {&context.parts_move, &context.surfaces_move}) {
    ASSERT_EQ((*of)[0].size(), 1u);
    const PagePose& first = *(*of)[0][0];
    EXPECT_LT(first.rotation.angularDistance(Eigen::Quaterniond(turn)), 1e-6);  // displacements are single
    EXPECT_LT((first.translation - shift).norm(), 1e-5);
    EXPECT_LT((*of)[1][0]->rotation.angularDistance(Eigen::Quaterniond::Identity()), 1e-7);
    EXPECT_LT((*of)[1][0]->translation.norm(), 1e-7);
  }
  // A body that is stretched along x and is not a plane across y and z turns a little; nodes of a line have no pose.
  EXPECT_TRUE(motion_of(file, 2, {0, 6, 28, 34}));
  EXPECT_FALSE(motion_of(file, 0, {0, 1, 2, 3}));
  EXPECT_FALSE(motion_of(file, 0, {0, 1}));

  // Nothing is said where nothing moves, or where the file has no displacement.
  for (ResultFile still : {moved({[](const Vector3d& x) { return x; }}),
                           test::result_of("still", test::sheet(2, 2, 1, 1), {{1, 1, 1, 1}})}) {
    PageContext none = make_context(still.xplt.meshes[0]);
    add_motion(still, 0, {0}, none);
    EXPECT_TRUE(none.parts_move.empty() && none.surfaces_move.empty());
  }
}

TEST(ReportPage, DomainsOfOneMaterialMoveApart) {
  // Three strips of a shell: the first stays, the last is lifted by 5. Both are cartilage, of one material or of two
  // that have no name.
  const Vector3d lift(0, 0, 5);
  ResultFile file = moved({[&](const Vector3d& x) { return x.y() < 2.5 ? x : Vector3d(x + lift); }});
  XpltMesh& mesh = file.xplt.meshes[0];
  const XpltDomain whole = mesh.domains[0];
  const auto strip = [&](int part, std::ptrdiff_t begin, std::ptrdiff_t end) {
    XpltDomain d = whole;
    d.part = part;
    d.element_ids = {whole.element_ids.begin() + begin, whole.element_ids.begin() + end};
    d.nodes = {whole.nodes.begin() + 4 * begin, whole.nodes.begin() + 4 * end};
    return d;
  };
  mesh.parts = {"", "between", ""};
  for (const int of_last : {1, 3}) {
    mesh.domains = {strip(1, 0, 6), strip(2, 6, 18), strip(of_last, 18, 24)};
    PageContext context = make_context(mesh);
    add_motion(file, 0, {0}, context);
    ASSERT_EQ(context.parts_move.size(), 1u);
    ASSERT_EQ(context.parts_move[0].size(), 3u);
    EXPECT_LT(context.parts_move[0][0]->translation.norm(), 1e-5);
    EXPECT_LT((context.parts_move[0][2]->translation - lift).norm(), 1e-5);
  }
}

TEST(ReportPage, HoldsTheFilesNumbersExactlyWhenFew) {
  const std::vector<ResultFile> files = test::awkward_results();
  const PageParts page(page_of(files));
  ASSERT_EQ(page.report["exact"], true);
  const Json& surface = page.report["surfaces"][0];
  for (std::size_t i = 0; i < files.size(); ++i) {
    const Json& field = surface["fields"]["pressure"][i];
    const std::vector<std::uint32_t> back = page.array(field["values"]);
    std::size_t at = 0;
    for (const XpltState& state : files[i].xplt.states)
      for (float x : state.variables[0][0].values) ASSERT_EQ(as_float(back.at(at++)), x);
    EXPECT_EQ(at, back.size());
  }
  // undefined joint space stays undefined
  const std::vector<std::uint32_t> space = page.array(surface["fields"]["space"][0]["values"]);
  std::size_t undefined = 0, at = 0;
  for (const XpltState& state : files[0].xplt.states)
    for (float x : state.variables[1][0].values) {
      ASSERT_EQ(std::isnan(as_float(space.at(at))), std::isnan(x));
      undefined += std::isnan(as_float(space.at(at++)));
    }
  EXPECT_GT(undefined, 100u);
  EXPECT_TRUE(surface["fields"]["space"][1].is_null());
}

TEST(ReportPage, NumbersAreThoseOfCompare) {
  const std::vector<ResultFile> files = test::awkward_results();
  CompareOptions options;
  options.profile = true;
  options.at = 0.5;
  const Comparison c = compare_files(files, options);
  const PageData data = compare_page(files, options, c, {"dea"});
  const PageParts page(page_html(data));
  const ComparedSurface& compared = c.surfaces[0];
  const Json& surface = page.report["surfaces"][0];
  for (std::size_t i = 0; i < files.size(); ++i) {
    const Json& m = surface["measures"][i][static_cast<std::size_t>(c.states[i])][0];
    const SurfaceMeasures& expected = compared.regions[0].results[i];
    EXPECT_NEAR(m["nodes"]["peak"].get<double>(), expected.nodes[0].peak, 1e-8);
    EXPECT_NEAR(m["nodes"]["p25"].get<double>(), expected.nodes[0].p25, 1e-8);
    EXPECT_NEAR(m["facets"]["mean"].get<double>(), expected.facets[0].mean, 1e-8);
    EXPECT_NEAR(m["nodes"]["area"].get<double>(), expected.nodes[0].area, 1e-6);
    EXPECT_NEAR(m["force"].get<double>(), expected.resultant.norm(), 1e-6);
  }
  const std::size_t frame = page.report["frame"];
  EXPECT_EQ(page.report["frames"][frame]["time"], 0.5);
  for (std::size_t i = 0; i + 1 < files.size(); ++i) {
    const Json& p = surface["patterns"][frame][0][i];
    EXPECT_NEAR(p["r"].get<double>(), compared.regions[0].differences[i].correlation, 1e-8);
    EXPECT_NEAR(p["rms"].get<double>(), compared.regions[0].differences[i].rms, 1e-8);
    EXPECT_NEAR(p["largest"].get<double>(), compared.regions[0].differences[i].largest, 1e-8);
  }
  EXPECT_TRUE(surface["patterns"][frame][0][2].is_null());
  for (std::size_t b = 0; b < compared.profiles[0].size(); ++b) {
    const Json& mean = surface["profiles"][frame][0][b];
    if (std::isnan(compared.profiles[0][b].mean))
      EXPECT_TRUE(mean.is_null());
    else
      EXPECT_NEAR(mean.get<double>(), compared.profiles[0][b].mean, 1e-8);
  }
  // without contact nothing is defined but the area, and nothing is 0 that is not
  const Json& none = surface["measures"][0][0][0];
  EXPECT_TRUE(none["nodes"]["peak"].is_null());
  EXPECT_TRUE(none["center"][0].is_null());
  EXPECT_EQ(none["nodes"]["area"], 0.0);
}

TEST(ReportPage, EdgesEncloseTheFacetsAreaAndTheViewIsThePictures) {
  const std::vector<ResultFile> files = test::awkward_results();
  const Comparison c = compare_files(files, {});
  const PageData data = compare_page(files, {}, c, {"dea"});
  const PageParts page(page_html(data));
  const Json& surface = page.report["surfaces"][0];
  int compared = 0;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const PageField& field = *data.surfaces[0].pressure[i];
    const ResultSurface own = result_surface(files[i], 0, 0);
    const MapMesh mesh = make_map_mesh(own);
    ASSERT_EQ(surface["fields"]["pressure"][i]["edges"].size(), field.states.size());
    for (std::size_t k = 0; k < field.states.size(); ++k) {
      const Json& edge = surface["fields"]["pressure"][i]["edges"][k];
      double area = 0.0;
      for (int t = 0; t < mesh.size(); ++t) {
        const auto j = static_cast<std::size_t>(t);
        if (field.states[k][static_cast<std::size_t>(mesh.facet[j])] > 0) area += mesh.areas[j];
      }
      if (area == 0) {
        EXPECT_TRUE(edge.is_null());
        continue;
      }
      const std::vector<double> points = point_values(mesh, nodal_average(own, field.states[k]));
      EXPECT_NEAR(area_above(mesh, points, edge.get<double>()), area, 1e-6 * area);
      EXPECT_GT(area_above(mesh, points, 1e-9), 1.05 * area);  // what averages would claim
      ++compared;
    }
  }
  EXPECT_GE(compared, 9);
  EXPECT_TRUE(surface["fields"]["space"][0]["edges"].empty());

  MapOptions o;
  o.surfaces = {c.surfaces[0].names[0]};
  const MapView view = make_map_figure({files[0]}, nullptr, o).surfaces[0].view;
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(surface["view"]["axis"][static_cast<std::size_t>(k)].get<double>(), view.toward[k], 1e-12);
    EXPECT_NEAR(surface["view"]["up"][static_cast<std::size_t>(k)].get<double>(), view.up[k], 1e-12);
  }
}

/// Ends, lines and largest value of a picture as the page has them.
void expect_scale_of(const MapFigure& figure, const PageScale& page, const std::string& what) {
  EXPECT_DOUBLE_EQ(page.scale.low, figure.low) << what;
  EXPECT_DOUBLE_EQ(page.scale.high, figure.high) << what;
  EXPECT_EQ(scale_lines(page.scale, figure.map), figure.contours) << what;
}

TEST(ReportPage, ScalesAreThoseOfPictures) {
  const std::vector<ResultFile> files = test::large_results(14, 5);
  CompareOptions options;
  const PageData data = compare_page(files, options, compare_files(files, options), {"dea", "compare"});
  ASSERT_EQ(data.surfaces.size(), 1u);
  const PageSurface& s = data.surfaces.front();
  const std::map<std::string, std::string> fields = {
      {"pressure", "contact pressure"}, {"space", "joint space"}, {"thickness", "cartilage thickness"}};
  ASSERT_EQ(s.scales.size(), 3u);
  ASSERT_EQ(data.frames.size(), 5u);
  for (const bool smooth : {true, false}) {
    for (const PageQuantity& q : s.scales) {
      const PageScales& scales = smooth ? q.nodes : q.facets;
      MapOptions o;
      o.smooth = smooth;
      o.field = fields.at(q.field);
      std::vector<ResultFile> with = files;
      if (q.field != "pressure") with.pop_back();  // FEA has none of the others
      expect_scale_of(make_map_figure(with, nullptr, o), scales.all, q.field);
      o.scale_of_shown = true;
      ASSERT_EQ(scales.frames.size(), 5u);
      for (std::size_t f = 1; f < 5; ++f) {  // nothing presses in state 0
        o.states = std::to_string(data.frames[f].time);
        expect_scale_of(make_map_figure(with, nullptr, o), scales.frames[f], q.field + " at " + o.states);
      }
    }
    int compared = 0;
    for (const PageQuantity& q : s.differences) {
      MapOptions o;
      o.smooth = smooth;
      o.field = fields.at(q.field);
      const auto file = [&](int i) { return files[static_cast<std::size_t>(i)]; };
      const ResultFile minus = file(q.b);
      if (q.field == "thickness") continue;  // the same in both
      expect_scale_of(make_map_figure({file(q.a)}, &minus, o), (smooth ? q.nodes : q.facets).all,
                      "difference of " + q.field);
      ++compared;
    }
    EXPECT_EQ(compared, 4);  // pressure: three pairs, joint space: one
  }
}

TEST(ReportPage, DifferencesAreOfTimesThatBothHave) {
  std::vector<ResultFile> files = test::large_results(14, 5);
  files.erase(files.begin() + 1);
  files.back().xplt.states.erase(files.back().xplt.states.begin(), files.back().xplt.states.end() - 1);
  const PageData data = compare_page(files, {}, compare_files(files, {}), {"dea"});
  ASSERT_EQ(data.frames.size(), 5u);
  const PageQuantity& q = data.surfaces.front().differences.front();
  MapOptions o;
  expect_scale_of(make_map_figure({files[0]}, &files[1], o), q.facets.all, "one time");
  for (std::size_t f = 0; f < 4; ++f) EXPECT_TRUE(q.nodes.frames[f].range.empty()) << f;
  EXPECT_FALSE(q.nodes.frames[4].range.empty());
}

TEST(ReportPage, CarriesValuesToTheReferencesNodesAsCompareDoes) {
  const std::vector<ResultFile> files = test::awkward_results();
  const Comparison c = compare_files(files, {});
  const PageData data = compare_page(files, {}, c, {"dea"});
  const PageSurface& s = data.surfaces[0];
  ASSERT_FALSE(s.carry[0]);  // the reference's own mesh
  ASSERT_TRUE(s.carry[1]);
  const std::vector<double> nodal = nodal_average(s.geometry[1], s.pressure[1]->states.back());
  const std::vector<double> expected = carry_values(match_nodes(s.geometry[2], s.geometry[1]), s.geometry[1], nodal);
  for (std::size_t v = 0; v < expected.size(); ++v) {
    double sum = 0.0;
    for (std::size_t k = 3 * v; k < 3 * v + 3; ++k) {
      ASSERT_GE(s.carry[1]->vertices[k], 0);
      sum += s.carry[1]->weights[k] * nodal[static_cast<std::size_t>(s.carry[1]->vertices[k])];
    }
    ASSERT_NEAR(sum, expected[v], 1e-6);
  }
}

TEST(ReportPage, SlopeOfAMultiple) {
  test::Dome dome;
  const test::Field b = test::wandering(4.0, 6.0, 0.2);
  const test::Field a = [b](double x, double y, double t) { return 2.5 * b(x, y, t); };
  const std::vector<ResultFile> files = {
      test::make_dome_result("a.xplt", "a", dome, {0.0, 1.0}, {{"contact pressure", a}}),
      test::make_dome_result("b.xplt", "b", dome, {0.0, 1.0}, {{"contact pressure", b}})};
  const PageData data = compare_page(files, {}, compare_files(files, {}), {"dea"});
  const Json& p = data.surfaces[0].patterns[1][0][0];
  EXPECT_NEAR(p["slope"].get<double>(), 2.5, 1e-5);
  EXPECT_NEAR(p["intercept"].get<double>(), 0.0, 1e-4);
  EXPECT_NEAR(p["r"].get<double>(), 1.0, 1e-9);
  EXPECT_TRUE(data.surfaces[0].patterns[0][0][0]["slope"].is_null());  // nothing touches
}

TEST(ReportPage, FramesPairTimes) {
  const PageData data = compare_page(test::awkward_results(), {}, compare_files(test::awkward_results(), {}), {"dea"});
  ASSERT_EQ(data.frames.size(), 4u);  // the second result has no state at 0.75
  EXPECT_EQ(data.frames[3].states, (std::vector<int>{4, 3, 4}));
  EXPECT_EQ(data.frame, 3);
  test::Dome dome;
  const auto at = [&](const char* name, const std::vector<double>& times) {
    return test::make_dome_result(name, name, dome, times, {{"contact pressure", test::wandering(5, 6, 0)}});
  };
  const std::vector<ResultFile> apart = {at("a", {0.4}), at("b", {0.2, 0.5})};
  const PageData other = compare_page(apart, {}, compare_files(apart, {}), {"dea"});
  ASSERT_EQ(other.frames.size(), 4u);  // each time by itself, then the compared states
  EXPECT_EQ(other.frames[0].states, (std::vector<int>{-1, 0}));
  EXPECT_EQ(other.frames[1].states, (std::vector<int>{0, -1}));
  EXPECT_TRUE(std::isnan(other.frames[3].time));
  EXPECT_EQ(other.frames[3].states, (std::vector<int>{0, 1}));
  EXPECT_EQ(other.frame, 3);
}

TEST(ReportPage, FramesSayWhichStatesAreNoSolution) {
  test::Dome dome;
  const auto at = [&](const char* name, const std::vector<double>& times) {
    return test::make_dome_result(name, name, dome, times, {{"contact pressure", test::wandering(5, 6, 0)}});
  };
  std::vector<ResultFile> files = {at("a", {0.5, 1}), at("b", {0.5, 1})};
  files[1].xplt.states[1].status = kStatusNotConverged;
  files[1].xplt.software = "FEBioDEA 1.0.0";
  const Json frames = PageParts(page_of(files)).report["frames"];
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[0]["unsolved"], Json::array());
  EXPECT_EQ(frames[1]["unsolved"], Json({1}));
}

TEST(ReportPage, SaysNothingOfFoldersAndIsTheSameTwice) {
  const std::vector<ResultFile> files = test::awkward_results();
  std::vector<std::string> words = {"/opt/bin/dea",        "compare",   "--report",
                                    "/root/secret/r.html", "--surface", "a=/b c"};
  for (const ResultFile& f : files) words.push_back(f.path);
  Comparison c = compare_files(files, {});
  c.warnings.push_back("warning: /some/where/first.xplt: something");
  const std::string page = page_html(compare_page(files, {}, c, words));
  EXPECT_EQ(page.find("/some/where"), std::string::npos);
  EXPECT_EQ(page.find("secret"), std::string::npos);
  const PageParts parts(page);
  EXPECT_EQ(parts.report["command"],
            "dea compare --report r.html --surface 'a=/b c' first.xplt second.xplt third.xplt");
  EXPECT_EQ(parts.report["warnings"].back(), "warning: first.xplt: something");
  EXPECT_EQ(page, page_html(compare_page(files, {}, c, words)));
}

TEST(ReportPage, UnitsOnlyWhereTheFilesNameThem) {
  EXPECT_EQ(unit_names("mm-N-s").pressure, "MPa");
  EXPECT_EQ(unit_names("SI").area, "m²");
  EXPECT_EQ(unit_names("").pressure, "");
  EXPECT_EQ(unit_names("furlongs").length, "");
}

TEST(ReportPage, FiftyThousandFacetsAndFiftyStatesStayBelowThirtyMegabytes) {
  const std::vector<ResultFile> files = test::large_results(224, 50, true);
  ASSERT_GE(files[0].xplt.meshes[0].surfaces[0].size(), 50000);
  const PageParts page(page_of(files));
  EXPECT_LT(page.html.size(), 30u * 1000 * 1000);
  EXPECT_GT(page.html.size(), 1000u * 1000);
  RecordProperty("megabytes", std::to_string(page.html.size() / 1e6));
  ASSERT_EQ(page.report["exact"], false);
  for (std::size_t i = 0; i < files.size(); ++i) {
    const Json& field = page.report["surfaces"][0]["fields"]["pressure"][i];
    const std::vector<std::uint32_t> codes = page.array(field["values"]);
    const std::size_t n = field["facets"];
    ASSERT_EQ(codes.size(), 50 * n);
    for (std::size_t s = 0; s < 50; s += 7) {
      const double least = field["ranges"][s][0], most = field["ranges"][s][1];
      const std::vector<float>& values = files[i].xplt.states[s].variables[0][0].values;
      for (std::size_t f = 0; f < n; f += 3) {
        const double code = codes[s * n + f], x = least * (1 - code / 65534) + most * code / 65534;
        ASSERT_LE(std::abs(x - values[f]), (most - least) / 65534) << s << " " << f;
        ASSERT_EQ(x > 0, values[f] > 0);
      }
    }
  }
}

TEST(ReportPage, LibrariesCannotEndTheirScript) {
  int files = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(DEA_VENDOR_DIR)) {
    const std::string name = entry.path().filename().string();
    if (name.find(".min.js") == std::string::npos && name.find(".txt") == std::string::npos) continue;
    ++files;
    const std::string text = test::file_text(entry.path());
    EXPECT_EQ(text.find("</script"), std::string::npos) << name;
    EXPECT_EQ(text.find("<!--"), std::string::npos) << name;
  }
  EXPECT_EQ(files, 3);
}

// ---- the program ----

test::Finished dea_in(const fs::path& folder, std::vector<std::string> words) {
  words.insert(words.begin(), DEA_PROGRAM);
  return test::run_program(folder, words, 60);
}

TEST(ReportProgram, RunAndCompareWriteAPage) {
  const test::TemporaryFolder folder;
  const std::string model = std::string(DEA_SAMPLES_DIR) + "/hip/hip_walking.feb";
  test::Finished f = dea_in(folder.path, {"run", model, "-o", "a.xplt", "--report", "run.html", "-q"});
  ASSERT_EQ(f.code, 0) << f.err;
  EXPECT_TRUE(f.out.empty());
  const PageParts run(test::file_text(folder.path / "run.html"));
  EXPECT_EQ(run.report["kind"], "run");
  EXPECT_EQ(run.report["title"], "hip_walking");
  EXPECT_EQ(run.report["command"], "dea run hip_walking.feb -o a.xplt --report run.html -q");
  EXPECT_EQ(run.html.find(DEA_SAMPLES_DIR), std::string::npos);
  EXPECT_NE(run.report["texts"][0]["text"].get<std::string>().find("springs on pelvis"), std::string::npos);
  EXPECT_EQ(run.report["surfaces"].size(), 2u);
  EXPECT_EQ(run.report["tables"][0]["headings"][0], "time");
  EXPECT_EQ(run.report["results"][0]["times"].size(), 23u);
  ASSERT_EQ(dea_in(folder.path, {"run", model, "-o", "b.xplt", "--law", "linear", "-q"}).code, 0);
  f = dea_in(folder.path, {"compare", "a.xplt", "b.xplt", "--report", "c.html"});
  ASSERT_EQ(f.code, 0) << f.err;
  EXPECT_NE(f.out.find("\np99 "), std::string::npos);
  const PageParts compare(test::file_text(folder.path / "c.html"));
  EXPECT_EQ(compare.report["title"], "a against b");
  EXPECT_EQ(compare.report["frames"].size(), 23u);
}

TEST(ReportProgram, LigamentsOfOneNameAreNumberedInTableAndCurves) {
  const test::TemporaryFolder folder;
  const test::Finished f = dea_in(folder.path, {"run", std::string(DEA_SAMPLES_DIR) + "/ligament/ligament.feb", "-o",
                                                "a.xplt", "--report", "r.html"});
  ASSERT_EQ(f.code, 0) << f.err;
  const PageParts page(test::file_text(folder.path / "r.html"));
  const auto titled = [&](const char* list, const char* key, const std::string& start) {
    for (const Json& x : page.report[list])
      if ((x[key].is_array() ? x[key][0] : x[key]).get<std::string>().rfind(start, 0) == 0) return x;
    return Json();
  };
  std::vector<std::string> names;
  const Json table = titled("tables", "headings", "spring");
  for (const Json& row : table["rows"]) names.push_back(row[0]);
  EXPECT_EQ(names, (std::vector<std::string>{"medial ligament", "lateral ligament", "tethers", "tethers (2)"}));
  EXPECT_EQ(titled("charts", "title", "Ligaments")["names"].get<std::vector<std::string>>(), names);
  for (const std::string& name : names) EXPECT_NE(f.out.find("\n" + name + " "), std::string::npos) << f.out;
}

TEST(ReportProgram, TheSettingsFileMayNameThePage) {
  const test::TemporaryFolder folder;
  const std::string model = std::string(DEA_SAMPLES_DIR) + "/hip/hip_walking.feb";
  const auto run = [&](const std::string& elements, std::vector<std::string> more = {}) {
    std::ofstream(folder.path / "s.xml") << "<febiodea_settings version=\"1\">\n<law>linear</law>" << elements
                                         << "</febiodea_settings>";
    std::vector<std::string> words = {"run", model, "-o", "a.xplt", "--states", "last", "-q", "--settings", "s.xml"};
    words.insert(words.end(), more.begin(), more.end());
    return dea_in(folder.path, words);
  };
  test::Finished f = run("<report>a b.html</report>");
  ASSERT_EQ(f.code, 0) << f.err;
  const PageParts page(test::file_text(folder.path / "a b.html"));
  EXPECT_EQ(page.report["title"], "hip_walking");
  fs::remove(folder.path / "a b.html");
  ASSERT_EQ(run("<report>a b.html</report>", {"--report", "typed.html"}).code, 0);
  EXPECT_TRUE(fs::exists(folder.path / "typed.html"));
  EXPECT_FALSE(fs::exists(folder.path / "a b.html"));
  fs::remove(folder.path / "a.xplt");
  f = run("<report>page.pdf</report>");
  EXPECT_EQ(f.code, 2);
  EXPECT_EQ(f.err, "dea: <report> page.pdf: found \".pdf\", expected a name that ends in .html or .htm\n");
  f = run("<report>p.html</report>", {"--json", "p.html"});
  EXPECT_EQ(f.code, 2);
  EXPECT_EQ(f.err, "dea: <report> p.html: is the file of --json too\n");
  f = run("<report>nowhere/p.html</report>");
  EXPECT_EQ(f.code, 4);
  EXPECT_FALSE(fs::exists(folder.path / "a.xplt"));
}

TEST(ReportProgram, RefusesAndLeavesNothing) {
  const test::TemporaryFolder folder;
  const std::string model = std::string(DEA_SAMPLES_DIR) + "/hip/hip_walking.feb";
  ASSERT_EQ(dea_in(folder.path, {"run", model, "-o", "a.xplt", "--states", "last", "-q"}).code, 0);
  const std::vector<std::string> base = {"compare", "a.xplt", "a.xplt", "-q", "--report"};
  const auto with = [&](const std::string& path) {
    std::vector<std::string> words = base;
    words.push_back(path);
    return dea_in(folder.path, words);
  };
  test::Finished f = with("nowhere/r.html");
  EXPECT_EQ(f.code, 4);
  EXPECT_EQ(f.err, "dea: cannot write nowhere/r.html: there is no folder nowhere\n");
  f = with("-");
  EXPECT_EQ(f.code, 2);
  EXPECT_EQ(f.err, "dea: --report -: the page cannot go to standard output, give it a name\n");
  for (const char* name : {"a.xplt", "report.jpg", "report", "html", ".html", "."}) {
    f = with(name);
    EXPECT_EQ(f.code, 2) << name;
    EXPECT_NE(f.err.find("expected a name that ends in .html or .htm"), std::string::npos) << f.err;
  }
  EXPECT_EQ(with("report.jpg").err,
            "dea: --report report.jpg: found \".jpg\", expected a name that ends in .html or .htm\n");
  EXPECT_EQ(dea_in(folder.path, {"run", model, "-o", "b.xplt", "--report", "b.pdf", "-q"}).code, 2);
  fs::create_directory(folder.path / "folder.html");
  EXPECT_EQ(with("folder.html").code, 4);
  fs::remove(folder.path / "folder.html");
  f = dea_in(folder.path, {"run", model, "-o", "b.xplt", "--report", "b.xplt", "-q"});
  EXPECT_EQ(f.code, 2);
  f = dea_in(folder.path, {"run", model, "-o", "b.xplt", "--report", "-", "-q"});
  EXPECT_EQ(f.code, 2);
  EXPECT_FALSE(fs::exists(folder.path / "b.xplt"));
  fs::create_symlink("/dev/full", folder.path / "full.html");
  f = with("full.html");
  EXPECT_EQ(f.code, 4) << f.err;
  fs::remove(folder.path / "full.html");
  EXPECT_EQ(with("small.HTM").code, 0);
  fs::remove(folder.path / "small.HTM");
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(folder.path)) files += entry.path().filename() != "a.xplt";
  EXPECT_EQ(files, 0u);
}

}  // namespace dea::report_test

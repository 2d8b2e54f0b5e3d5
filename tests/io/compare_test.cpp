// Plot files side by side: files made here with known pressures, and the program `dea compare` from outside.
//
// The mesh of most tests: n x n hexahedra of the unit square, 0.1 thick; surface "top" is z = 0.1, "bottom" z = 0.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>

#include "compare_files.h"
#include "error.h"
#include "program.h"

namespace dea {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Field = std::function<double(double x, double y, double t)>;

XpltVariable variable(XpltGroup group, XpltType type, XpltFormat format, const std::string& name) {
  XpltVariable v;
  v.group = group;
  v.type = type;
  v.format = format;
  v.name = name;
  return v;
}

XpltMesh make_mesh(int n) {
  XpltMesh mesh;
  const auto id = [n](int i, int j, int k) { return i + (n + 1) * (j + (n + 1) * k); };
  for (int k = 0; k < 2; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        mesh.node_ids.push_back(static_cast<int>(mesh.node_ids.size()) + 1);
        for (double x : {static_cast<double>(i) / n, static_cast<double>(j) / n, 0.1 * k})
          mesh.coordinates.push_back(static_cast<float>(x));
      }
  mesh.parts = {"layer", "plate"};
  XpltDomain domain;
  domain.name = "layer";
  XpltDomain plate;  // rigid, one shell on the first nodes
  plate.element_type = 3;
  plate.part = 2;
  plate.name = "plate";
  plate.element_ids = {n * n + 1};
  plate.nodes = {id(0, 0, 0), id(0, 1, 0), id(1, 1, 0), id(1, 0, 0)};
  XpltFacets top, bottom, left;
  top.name = "top";
  bottom.name = "bottom";
  left.name = "left half";
  XpltSet low{"low elements", {}};
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      domain.element_ids.push_back(static_cast<int>(domain.element_ids.size()) + 1);
      if (2 * j < n) low.items.push_back(domain.element_ids.back());
      for (int k = 0; k < 2; ++k)
        for (int node : {id(i, j, k), id(i + 1, j, k), id(i + 1, j + 1, k), id(i, j + 1, k)})
          domain.nodes.push_back(node);
      const std::vector<int> up = {id(i, j, 1), id(i + 1, j, 1), id(i + 1, j + 1, 1), id(i, j + 1, 1)};
      const std::vector<int> down = {id(i, j, 0), id(i, j + 1, 0), id(i + 1, j + 1, 0), id(i + 1, j, 0)};
      const auto add = [](XpltFacets& facets, const std::vector<int>& nodes) {
        facets.nodes.insert(facets.nodes.end(), nodes.begin(), nodes.end());
        facets.begin.push_back(static_cast<int>(facets.nodes.size()));
      };
      add(top, up);
      add(bottom, down);
      if (2 * i < n) add(left, {up[2], up[3], up[0], up[1]});
    }
  }
  mesh.domains = {domain, plate};
  mesh.surfaces = {bottom, top};
  mesh.facet_sets = {left};
  mesh.element_sets = {low};
  XpltObject body;
  body.name = "plate";
  mesh.objects = {body};
  return mesh;
}

/// Pressure on "top" at the facets' middles at each time; "bottom" has no values at all.
XpltFile make_file(int n, const std::vector<double>& times, const Field& pressure, double gap = 0.0) {
  XpltFile file;
  file.software = "test";
  file.meshes = {make_mesh(n)};
  file.variables = {variable(XpltGroup::Nodal, XpltType::Vec3, XpltFormat::Node, "displacement"),
                    variable(XpltGroup::Domain, XpltType::Vec3, XpltFormat::Region, "rigid position"),
                    variable(XpltGroup::Surface, XpltType::Float, XpltFormat::Item, "contact pressure"),
                    variable(XpltGroup::Surface, XpltType::Float, XpltFormat::Item, "contact gap")};
  for (double t : times) {
    XpltState state;
    state.time = static_cast<float>(t);
    const float z = static_cast<float>(-0.25 * t);
    std::vector<float> values;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) values.push_back(static_cast<float>(pressure((i + 0.5) / n, (j + 0.5) / n, t)));
    state.variables = {{{0, std::vector<float>(file.meshes[0].coordinates.size(), z)}},
                       {{2, {1, 2, z}}},
                       {{2, values}},
                       {{2, std::vector<float>(values.size(), static_cast<float>(gap))}}};
    XpltObjectState object;
    object.rotation = {0, 0, static_cast<float>(std::sin(0.05 * t)), static_cast<float>(std::cos(0.05 * t))};
    state.objects = {object};
    file.states.push_back(state);
  }
  return file;
}

double hill(double x, double y, double t) {
  return t * std::max(0.0, 4 * std::cos(2 * (x - 0.5)) * std::cos(2 * (y - 0.4)) - 2.5);
}

ResultFile named(const std::string& label, XpltFile file) { return {label + ".xplt", label, std::move(file)}; }

TEST(CompareFiles, ScaledPressureIsRecoveredInEveryNumber) {
  const std::vector<ResultFile> files = {
      named("a", make_file(12, {0, 1}, [](double x, double y, double t) { return 1.25 * hill(x, y, t); })),
      named("b", make_file(12, {0, 0.5, 1}, hill, 0.02))};
  const Comparison c = compare_files(files, {});
  ASSERT_EQ(c.surfaces.size(), 1u);  // "bottom" has no data
  EXPECT_EQ(c.thresholds, (std::vector<double>{0, 0.1, 0.5}));
  const ComparedRegion& r = c.surfaces[0].regions[0];
  EXPECT_TRUE(c.surfaces[0].same_mesh[0]);
  EXPECT_NEAR(percent_difference(r.results[0].nodes[0].mean, r.results[1].nodes[0].mean), 25,
              1e-4);  // single precision
  EXPECT_NEAR(percent_difference(r.results[0].facets[0].peak, r.results[1].facets[0].peak), 25, 1e-4);
  EXPECT_NEAR(r.differences[0].correlation, 1, 1e-12);
  EXPECT_NEAR(r.facet_correlation[0], 1, 1e-12);
  EXPECT_EQ(r.differences[0].dice[0], 1.0);
  EXPECT_NEAR(r.results[1].mean_penetration, 0.02, 1e-8);
  EXPECT_NEAR(r.over_time[1].max_exposure, 0.5 * r.results[1].nodes[0].peak, 1e-6);  // p grows linearly from 0 at 0
  EXPECT_NEAR(r.over_time[0].mean_peak, r.results[0].nodes[0].mean, 1e-12);
  ASSERT_EQ(c.bodies.size(), 1u);
  EXPECT_EQ(c.bodies[0].name, "plate");
  EXPECT_EQ(c.bodies[0].results[0]->position, Vector3d(1, 2, -0.25));
  EXPECT_EQ(c.bodies[0].differences[0]->translation, Vector3d::Zero());
  ASSERT_EQ(c.warnings.size(), 1u);
  EXPECT_NE(c.warnings[0].find("a has 2 states and b has 3"), std::string::npos);
}

TEST(CompareFiles, StatesPairByTimeAndPosesFollow) {
  const std::vector<ResultFile> files = {named("a", make_file(4, {0, 1, 2}, hill)),
                                         named("b", make_file(4, {0, 1}, hill))};
  const Comparison last = compare_files(files, {});
  EXPECT_EQ(last.times, (std::vector<double>{2, 1}));
  ASSERT_EQ(last.warnings.size(), 2u);
  EXPECT_NE(last.warnings[0].find("the last state of a is at time 2, that of b at 1"), std::string::npos);
  EXPECT_NE(last.warnings[1].find("a has 3 states and b has 2, at other times: peaks"), std::string::npos);
  const PoseDifference& d = *last.bodies[0].differences[0];
  EXPECT_EQ(d.translation, Vector3d(0, 0, -0.25));
  EXPECT_NEAR((*d.rotation - Vector3d(0, 0, 0.1)).norm(), 0,
              1e-7);  // half the angle in the quaternion, single precision

  CompareOptions options;
  options.at = 1.0;
  const Comparison at_1 = compare_files(files, options);
  EXPECT_EQ(at_1.surfaces[0].regions[0].differences[0].rms, 0.0);
  EXPECT_TRUE(at_1.warnings.empty());
  options.at = 1.5;
  try {
    compare_files(files, options);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "a.xplt: found no state at time 1.5, expected one of 0, 1, 2");
  }
}

TEST(CompareFiles, RegionsAreFacetSetsAndElementSets) {
  CompareOptions options;
  options.regions = {"left half", "low elements", "top"};
  const auto step = [](double x, double y, double) { return x < 0.5 ? 1.0 : y < 0.5 ? 2.0 : 4.0; };
  const std::vector<ResultFile> files = {named("a", make_file(8, {1}, step)), named("b", make_file(8, {1}, step))};
  const Comparison c = compare_files(files, options);
  const std::vector<ComparedRegion>& r = c.surfaces[0].regions;
  ASSERT_EQ(r.size(), 4u);
  EXPECT_NEAR(r[0].results[0].facets[0].mean, 0.5 + 0.5 + 1, 1e-6);
  EXPECT_NEAR(r[1].results[0].facets[0].mean, 1, 1e-6);
  EXPECT_NEAR(r[1].results[0].facets[0].area, 0.5, 1e-6);
  EXPECT_NEAR(r[1].results[0].nodes[0].area, 0.5, 1e-6);
  EXPECT_NEAR(r[2].results[0].facets[0].mean, 1.5, 1e-6);
  EXPECT_NEAR(r[2].results[0].center_of_pressure.x(), (0.25 + 2 * 0.75) / 3, 1e-6);
  EXPECT_EQ(r[3].results[0].facets[0].mean, r[0].results[0].facets[0].mean);
  options.regions = {"rim"};
  try {
    compare_files(files, options);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(),
                 "a.xplt: found no facet set, surface or element set \"rim\", expected one of \"left half\", "
                 "\"bottom\", \"top\", \"low elements\"");
  }
  options.regions = {"bottom"};
  EXPECT_THROW(compare_files(files, options), InputError);  // exists, but holds none of top's facets
}

TEST(CompareFiles, DifferentMeshesAndNamesAreProjected) {
  XpltFile fine = make_file(30, {1}, hill);
  fine.meshes[0].surfaces[1].name = "cartilage";
  const std::vector<ResultFile> files = {named("a", make_file(20, {1}, hill)), named("b", std::move(fine))};
  EXPECT_THROW(compare_files(files, {}), InputError);
  CompareOptions options;
  options.surfaces = {"top=cartilage"};
  const Comparison c = compare_files(files, options);
  const ComparedRegion& r = c.surfaces[0].regions[0];
  EXPECT_FALSE(c.surfaces[0].same_mesh[0]);
  EXPECT_EQ(c.surfaces[0].covered[0], 1.0);
  EXPECT_GT(r.differences[0].correlation, 0.998);
  EXPECT_LT(r.differences[0].correlation, 1.0);
  EXPECT_TRUE(std::isnan(r.facet_correlation[0]));
  EXPECT_NEAR(percent_difference(r.results[0].resultant.norm(), r.results[1].resultant.norm()), 0, 0.5);

  const XpltFile both = make_compare_file(files, options, c, false, false);
  ASSERT_EQ(both.meshes[0].surfaces[1].size(), 400);
  const ResultFile read = named("both", both);
  const std::vector<double> a = facet_values(read, 0, 1, "contact pressure a"),
                            b = facet_values(read, 0, 1, "contact pressure b");
  for (std::size_t f = 0; f < a.size(); ++f) EXPECT_NEAR(a[f], b[f], 0.15);  // rims of the contact are one facet wide
}

TEST(CompareFiles, OneFileWithBothPressuresTheirDifferenceAndItsResultants) {
  const std::vector<ResultFile> files = {
      named("a", make_file(9, {0, 1, 2}, [](double x, double y, double t) { return hill(x, y, t) + 0.5 * t * x; })),
      named("b", make_file(9, {0, 2}, hill))};
  CompareOptions options;
  options.dose_above = 1.0;
  const Comparison c = compare_files(files, options);
  const ResultFile both =
      named("both", xplt_from_bytes(xplt_bytes(make_compare_file(files, options, c, true, true)), "both.xplt"));
  ASSERT_EQ(both.plot.states.size(), 2u);  // b has nothing at 1
  EXPECT_EQ(both.plot.states[1].time, 2.0f);
  EXPECT_EQ(both.plot.states[1].variables[0], files[0].plot.states[2].variables[0]);  // displacement
  EXPECT_EQ(both.plot.states[1].objects, files[0].plot.states[2].objects);
  const ResultSurface top = result_surface(both, 1, 1);
  const std::vector<double> a = facet_values(both, 1, 1, "contact pressure a"),
                            b = facet_values(both, 1, 1, "contact pressure b"),
                            d = facet_values(both, 1, 1, "pressure difference"),
                            exposure = facet_values(both, 1, 1, "exposure b");
  EXPECT_EQ(a, facet_values(files[0], 2, 1, "contact pressure"));
  EXPECT_EQ(b, facet_values(files[1], 1, 1, "contact pressure"));
  for (std::size_t f = 0; f < a.size(); ++f) EXPECT_NEAR(d[f], a[f] - b[f], 1e-6);
  for (std::size_t f = 0; f < b.size(); ++f) EXPECT_NEAR(exposure[f], b[f], 1e-6);  // (0 + p) / 2 over two seconds
  EXPECT_EQ(measure(top, {a, {}}, {0.0}).resultant, c.surfaces[0].regions[0].results[0].resultant);
  const std::vector<double> dose = facet_values(both, 1, 1, "overpressure dose b");
  EXPECT_GT(*std::max_element(dose.begin(), dose.end()), 0.1);
  EXPECT_TRUE(facet_values(both, 0, 1, "overpressure dose b") == std::vector<double>(81, 0.0));
  EXPECT_TRUE(facet_values(both, 1, 0, "contact pressure a").empty());
}

TEST(CompareFiles, PressureMayBeGivenPerSlotOrPerNode) {
  XpltFile slots = make_file(2, {1}, hill), nodes = slots;
  slots.variables[2].format = XpltFormat::Mult;
  nodes.variables[2].format = XpltFormat::Node;
  slots.states[0].variables[2][0].values = {1, 2, 3, 6, 0, 0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 4};
  nodes.states[0].variables[2][0].values = {1, 2, 5, 4, 8,
                                            8, 0, 0, 0};  // order of first appearance: facet 0, then the new ones
  EXPECT_EQ(facet_values(named("s", slots), 0, 1, "contact pressure"), (std::vector<double>{3, 0, 1, 1}));
  EXPECT_EQ(facet_values(named("n", nodes), 0, 1, "contact pressure"), (std::vector<double>{3, 5.75, 2.25, 3.25}));
}

TEST(CompareFiles, AStateIsReadOnItsOwnMesh) {
  XpltFile file = make_file(3, {1}, hill);
  XpltFile remeshed = make_file(6, {2}, hill);
  remeshed.meshes[0].objects.clear();
  file.meshes.push_back(remeshed.meshes[0]);
  file.states.push_back(remeshed.states[0]);
  file.states[1].mesh = 1;
  const std::vector<ResultFile> files = {named("a", xplt_from_bytes(xplt_bytes(file), "a.xplt")),
                                         named("b", make_file(6, {2}, hill))};
  const Comparison c = compare_files(files, {});
  EXPECT_EQ(c.surfaces[0].facets, (std::vector<int>{36, 36}));
  EXPECT_EQ(c.surfaces[0].regions[0].differences[0].correlation, 1.0);
  ASSERT_EQ(c.warnings.size(), 1u);
  EXPECT_NE(c.warnings[0].find("1 states with another mesh"), std::string::npos);
}

TEST(CompareFiles, WithoutPressureThereIsNothingToCompare) {
  const auto fault = [](std::vector<ResultFile> files, const CompareOptions& options = {}) {
    try {
      compare_files(files, options);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("none");
  };
  const ResultFile good = named("good", make_file(4, {1}, hill));
  EXPECT_EQ(fault({named("flat", make_file(4, {1}, [](double, double, double) { return 0.0; })),
                   named("flat too", make_file(4, {1}, [](double, double, double) { return 0.0; }))}),
            "flat.xplt: found no \"contact pressure\" above 0 on any common surface in any file");
  XpltFile other = good.plot;
  other.variables[2].name = "contact traction";
  EXPECT_EQ(fault({good, named("other", other)}),
            "other.xplt: found no surface with \"contact pressure\" at time 1, expected one");
  other = good.plot;
  other.meshes[0].surfaces[1].name = "lid";
  EXPECT_EQ(fault({good, named("other", other)}),
            "found no surface with \"contact pressure\" that all files have, expected --surface A=B: good.xplt has "
            "\"top\"; other.xplt has \"lid\"");
  CompareOptions options;
  options.surfaces = {"bottom"};
  EXPECT_EQ(fault({good, good}, options),
            "good.xplt: found no surface \"bottom\" with \"contact pressure\", expected one of \"top\"");
  other = good.plot;
  for (float& x : other.meshes[0].coordinates) x += 50.0f;
  EXPECT_EQ(fault({good, named("far", other)}), "good.xplt: surface \"top\" lies nowhere on \"top\" of far.xplt");
  other = good.plot;
  other.states[0].variables[2][0].values[3] = std::nanf("");
  EXPECT_EQ(fault({good, named("other", other)}),
            "other.xplt: surface \"top\", time 1: \"contact pressure\" is not a number somewhere");
  options.surfaces = {"top", "top=top"};
  EXPECT_THROW(compare_files({good, good}, options), UsageError);
  options.surfaces = {"a=b=c"};
  EXPECT_THROW(compare_files({good, good}, options), UsageError);
}

TEST(CompareFiles, ASurfaceWithoutPressureInOneFileIsKeptButMarked) {
  XpltFile one = make_file(4, {1}, hill), two = one;
  one.states[0].variables[2].insert(one.states[0].variables[2].begin(), {1, std::vector<float>(16, 2.0f)});
  two.states[0].variables[2].insert(two.states[0].variables[2].begin(), {1, std::vector<float>(16, 0.0f)});
  const Comparison c = compare_files({named("one", one), named("two", two)}, {});
  ASSERT_EQ(c.surfaces.size(), 2u);
  EXPECT_EQ(c.surfaces[0].names[0], "top");
  EXPECT_TRUE(c.surfaces[0].asked_for);
  EXPECT_EQ(c.surfaces[1].names[0], "bottom");
  EXPECT_FALSE(c.surfaces[1].asked_for);
  ASSERT_EQ(c.warnings.size(), 1u);
  EXPECT_NE(c.warnings[0].find("\"bottom\" has no pressure anywhere in two"), std::string::npos);
}

/// The numbers that come with the reference files, made by another program.
TEST(CompareFiles, ReferenceFilesHaveThePublishedNumbers) {
  const fs::path folder = DEA_REFERENCE_DIR;
  if (!fs::exists(folder / "hip_walking_febio_penalty20.xplt")) GTEST_SKIP() << "no reference results";
  const struct {
    const char *file, *surface;
    double facet_peak, facet_p99, peak, p99, mean, facet_area, area_01, area_05, penetration;
  } kRows[] = {{"hip_walking_febio_penalty20", "acetabular_articulating", 6.47, 5.66, 6.05, 5.50, 2.100, 1208, 1263,
                1170, 0.0237},
               {"hip_walking_febio_penalty50", "acetabular_articulating", 6.96, 5.88, 6.39, 5.69, 2.149, 1169, 1238,
                1160, 0.0100},
               {"hip_stairs_up_febio_penalty20", "acetabular_articulating", 6.46, 5.66, 6.13, 5.66, 2.191, 1189, 1235,
                1144, 0.0246},
               {"hip_stairs_down_febio_penalty20", "acetabular_articulating", 7.22, 6.26, 6.71, 6.01, 2.237, 1263, 1310,
                1201, 0.0250},
               {"ball_loose_febio", "socket_articulating", 2.55, 2.42, 2.45, 2.39, 1.196, 84, 83, 68, 0.0034},
               {"ball_tight_febio", "socket_articulating", 4.49, 4.43, 4.49, 4.45, 2.016, 270, 268, 238, 0.0060}};
  for (const auto& row : kRows) {
    const ResultFile file = read_result((folder / (std::string(row.file) + ".xplt")).string(), row.file);
    const Comparison c = compare_files({file, file}, {});
    ASSERT_EQ(c.surfaces.size(), 1u);
    EXPECT_EQ(c.surfaces[0].names[0], row.surface);
    const SurfaceMeasures& m = c.surfaces[0].regions[0].results[0];
    // printed digits: half a unit of the last one, and 2e-4 for facets that are not plane
    EXPECT_NEAR(m.facets[0].peak, row.facet_peak, 0.0051) << row.file;
    EXPECT_NEAR(m.facets[0].p99_unweighted, row.facet_p99, 0.0051) << row.file;
    EXPECT_NEAR(m.nodes[1].peak, row.peak, 0.0051) << row.file;
    EXPECT_NEAR(m.nodes[1].p99_unweighted, row.p99, 0.0051) << row.file;
    EXPECT_NEAR(m.nodes[1].mean, row.mean, 0.0006) << row.file;
    EXPECT_NEAR(m.facets[0].area, row.facet_area, 0.51) << row.file;
    EXPECT_NEAR(m.nodes[1].area, row.area_01, 0.51) << row.file;
    EXPECT_NEAR(m.nodes[2].area, row.area_05, 0.51) << row.file;
    EXPECT_NEAR(m.mean_penetration, row.penetration, 0.00016) << row.file;
    EXPECT_EQ(c.surfaces[0].regions[0].differences[0].correlation, 1.0);
  }
  const Comparison penalties =
      compare_files({read_result((folder / "hip_walking_febio_penalty20.xplt").string(), "20"),
                     read_result((folder / "hip_walking_febio_penalty50.xplt").string(), "50")},
                    {});
  EXPECT_NEAR(penalties.surfaces[0].regions[0].facet_correlation[0], 0.9955, 0.00005);
}

class CompareCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    write_xplt((folder / "a.xplt").string(),
               make_file(6, {0, 1}, [](double x, double y, double t) { return 1.1 * hill(x, y, t); }));
    write_xplt((folder / "b.xplt").string(), make_file(6, {0, 1}, hill));
  }

  /// `arguments` as typed into a shell.
  test::Finished compare(const std::string& arguments) {
    return test::run_program(folder, {"/bin/sh", "-c", fmt::format("exec '{}' compare {}", DEA_PROGRAM, arguments)},
                             60);
  }

  test::TemporaryFolder own;
  const fs::path& folder = own.path;
};

TEST_F(CompareCommand, PrintsATableAndNothingElse) {
  const test::Finished f = compare("a.xplt b.xplt --label ours --label FEA");
  EXPECT_EQ(f.code, 0) << f.err;
  EXPECT_EQ(f.err, "");
  EXPECT_NE(f.out.find("FEA: b.xplt, time 1 (differences are relative to it)"), std::string::npos) << f.out;
  EXPECT_NE(f.out.find("surface top"), std::string::npos);
  EXPECT_NE(f.out.find("+10.0%"), std::string::npos);
  EXPECT_NE(f.out.find("ours              1.0000"), std::string::npos) << f.out;
  EXPECT_EQ(compare("a.xplt b.xplt -q").out, "");
}

TEST_F(CompareCommand, AFileAgainstItselfHasNoDifference) {
  const test::Finished f = compare("b.xplt b.xplt --json -");
  ASSERT_EQ(f.code, 0) << f.err;
  const Json j = Json::parse(f.out);
  EXPECT_EQ(j["schema"], "dea.compare/1");
  EXPECT_EQ(j["reference"], "b 2");  // labels stay different
  const Json& d = j["surfaces"][0]["regions"][0]["differences"][0];
  EXPECT_EQ(d["correlation"], 1.0);
  EXPECT_EQ(d["facet_correlation"], 1.0);
  EXPECT_EQ(d["rms"], 0.0);
  EXPECT_EQ(d["largest"], 0.0);
  EXPECT_EQ(d["center_of_pressure_distance"], 0.0);
  for (const Json& dice : d["dice"]) EXPECT_EQ(dice["dice"], 1.0);
  for (const char* places : {"nodes", "facets"})
    for (const Json& percent : d["percent"][places])
      for (const auto& item : percent.items()) EXPECT_TRUE(item.key() == "above" || item.value() == 0.0) << item.key();
  EXPECT_EQ(j["bodies"][0]["differences"][0]["rotation"], Json::array({0.0, 0.0, 0.0}));
}

TEST_F(CompareCommand, CsvHasALinePerSurfaceRegionAndFile) {
  const test::Finished f = compare("a.xplt b.xplt --regions 'left half' --threshold 0.3 --csv -");
  ASSERT_EQ(f.code, 0) << f.err;
  std::istringstream in(f.out);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 5u);
  EXPECT_EQ(lines[0].substr(0, 52), "label,file,time,surface,region,nodal_peak_above_0,no");
  EXPECT_NE(lines[0].find(",facet_area_above_0.3,"), std::string::npos);
  EXPECT_EQ(lines[3].substr(0, 27), "a,a.xplt,1,top,left half,1.");
  for (const std::string& line : lines)
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), std::count(lines[0].begin(), lines[0].end(), ','));
}

TEST_F(CompareCommand, WritesOneFileForTheViewer) {
  const test::Finished f = compare("a.xplt b.xplt --label dea --label FEA -o both.xplt --compress -q");
  ASSERT_EQ(f.code, 0) << f.err;
  const XpltFile both = read_xplt((folder / "both.xplt").string());
  EXPECT_TRUE(both.compressed);
  ASSERT_EQ(both.variables.size(), 4u);
  EXPECT_EQ(both.variables[1].name, "contact pressure dea");
  EXPECT_EQ(both.variables[2].name, "contact pressure FEA");
  EXPECT_EQ(both.variables[3].name, "pressure difference");
  EXPECT_EQ(both.states.size(), 2u);
  ASSERT_EQ(compare("a.xplt b.xplt --at 1 -o both.xplt --time-fields --dose-above 1 -q").code, 0);
  const XpltFile one = read_xplt((folder / "both.xplt").string());
  EXPECT_EQ(one.states.size(), 1u);
  EXPECT_EQ(one.variables.size(), 10u);
}

TEST_F(CompareCommand, ThirdsInJson) {
  const test::Finished f =
      compare("a.xplt b.xplt --regions anterior-superior-posterior --up 0,1,0 --anterior -1,0,0 --json -");
  ASSERT_EQ(f.code, 0) << f.err;
  const Json regions = Json::parse(f.out)["surfaces"][0]["regions"];
  ASSERT_EQ(regions.size(), 4u);
  const char* names[] = {"anterior", "superior", "posterior"};
  const double x[] = {0.3, 0.5, 0.7};  // about where the centres of pressure must be: the front is at small x
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(regions[k + 1]["name"], names[k]);
    EXPECT_NEAR(regions[k + 1]["results"][0]["center_of_pressure"][0].get<double>(), x[k], 0.1);
  }
}

TEST_F(CompareCommand, ProfileTableHasNoEmptyBinsAtItsEnds) {
  const std::string words = "a.xplt b.xplt --profile --axis -1,0,0 --center 0,0,0.1 --bin 30";
  const test::Finished table = compare(words);
  ASSERT_EQ(table.code, 0) << table.err;
  EXPECT_EQ(table.out.find("60 - 90"), std::string::npos) << table.out;
  EXPECT_NE(table.out.find("90 - 120"), std::string::npos) << table.out;
  EXPECT_NE(table.out.find("150 - 180"), std::string::npos) << table.out;
  const test::Finished f = compare(words + " --json -");
  const Json profile = Json::parse(f.out)["surfaces"][0]["profile"]["results"];
  EXPECT_EQ(profile[0]["bins"].size(), 6u);
}

TEST_F(CompareCommand, ProfileInJson) {
  const test::Finished f = compare("a.xplt b.xplt --profile --axis 1,0,0 --center 0,0,0.1 --bin 30 --json -");
  ASSERT_EQ(f.code, 0) << f.err;
  const Json profile = Json::parse(f.out)["surfaces"][0]["profile"]["results"];
  ASSERT_EQ(profile[0]["bins"].size(), 3u);  // the square seen from its corner: 0 to 90 degrees
  double area = 0.0;
  for (const Json& bin : profile[1]["bins"]) area += bin["area"].get<double>();
  EXPECT_NEAR(area, 1, 1e-6);
  EXPECT_NEAR(profile[0]["bins"][1]["mean"].get<double>() / profile[1]["bins"][1]["mean"].get<double>(), 1.1, 1e-6);
}

TEST_F(CompareCommand, ACutOffFileIsReadUpToItsLastWholeState) {
  const std::string bytes = test::file_text(folder / "b.xplt");
  std::ofstream(folder / "cut.xplt", std::ios::binary) << bytes.substr(0, bytes.size() - 40);
  const test::Finished f = compare("cut.xplt b.xplt --at 0 --surface top");
  EXPECT_EQ(f.code, 0) << f.err;
  EXPECT_EQ(f.err, "warning: cut.xplt: the last state is cut off and left out; the one before is at time 0\n");
}

TEST_F(CompareCommand, RefusesWithOneLineAndTheRightCode) {
  std::ofstream(folder / "text.xplt") << "no plot file";
  const struct {
    const char* arguments;
    int code;
    const char* says;
  } kCases[] = {
      {"", 2, "dea compare: FILES is required"},
      {"a.xplt", 2, "dea: compare a.xplt: found one file, expected two or more"},
      {"a.xplt b.xplt --label x", 2, "dea: --label: found 1 labels, expected one per file (2)"},
      {"a.xplt b.xplt --label x --label x", 2, "dea: --label x: given twice"},
      {"a.xplt b.xplt --threshold 0", 2, "dea: --threshold 0: found \"0\", expected a pressure above 0"},
      {"a.xplt b.xplt --at soon", 2, "dea: --at soon: found \"soon\""},
      {"a.xplt b.xplt --regions anterior-superior-posterior --up 0,0,1", 2,
       "dea: --regions anterior-superior-posterior, --up x,y,z and --anterior x,y,z go together"},
      {"a.xplt b.xplt --regions anterior-superior-posterior --up 0,0,1 --anterior 1,0,0", 2,
       "dea: up points along the surface's axis"},
      {"a.xplt b.xplt --profile --axis 1,2", 2, "dea: --axis 1,2: found \"1,2\", expected three numbers x,y,z"},
      {"a.xplt b.xplt --profile --axis 0,0,0", 2,
       "dea: --axis 0,0,0: found \"0,0,0\", expected a direction that is not 0"},
      {"a.xplt b.xplt --bin 3", 2, "dea: --bin belongs to --profile"},
      {"a.xplt b.xplt --profile --bin 0", 2, "dea: --bin 0: found \"0\", expected degrees from 0.1 to 180"},
      {"a.xplt b.xplt --compress", 2, "dea: --compress belongs to -o"},
      {"a.xplt b.xplt -o -", 2, "dea: -o -: the plot file cannot go to standard output"},
      {"a.xplt b.xplt --json - --csv -", 2, "dea: only one of --json and --csv can go to standard output"},
      {"a.xplt b.xplt -o b.xplt", 2, "dea: -o b.xplt: would overwrite b.xplt"},
      {"a.xplt none.xplt", 3, "none.xplt: "},
      {"a.xplt text.xplt", 3, "text.xplt: "},
      {"a.xplt b.xplt --at 0.5", 3, "a.xplt: found no state at time 0.5, expected one of 0, 1"},
      {"a.xplt b.xplt --surface lid", 3,
       "a.xplt: found no surface \"lid\" with \"contact pressure\", expected one of \"top\""},
      {"a.xplt b.xplt --at 0", 3, "a.xplt: found no \"contact pressure\" above 0 on any common surface in any file"},
      {"a.xplt b.xplt -o nowhere/both.xplt", 4, "dea: cannot write nowhere/both.xplt: there is no folder nowhere"},
      {"a.xplt b.xplt --json /dev/full", 4, "dea: cannot write /dev/full: "},
  };
  for (const auto& c : kCases) {
    const test::Finished f = compare(c.arguments);
    EXPECT_EQ(f.code, c.code) << c.arguments;
    EXPECT_EQ(f.err.substr(0, std::string(c.says).size()), c.says) << c.arguments;
    EXPECT_EQ(std::count(f.err.begin(), f.err.end(), '\n'), 1) << c.arguments << "\n" << f.err;
    EXPECT_EQ(f.out, "") << c.arguments;
  }
}

TEST_F(CompareCommand, HelpHasExamples) {
  const test::Finished f = compare("--help");
  EXPECT_EQ(f.code, 0);
  EXPECT_NE(f.out.find("dea compare hip_dea.xplt hip.xplt"), std::string::npos);
}

}  // namespace
}  // namespace dea

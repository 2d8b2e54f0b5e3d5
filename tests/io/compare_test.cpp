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
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "src/base/error.h"
#include "tests/program.h"
#include "views/compare/compare_files.h"

namespace dea::compare_test {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Field = std::function<double(double x, double y, double t)>;

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
  file.variables = {XpltVariable{XpltGroup::Nodal, XpltType::Vec3, XpltFormat::Node, "displacement"},
                    XpltVariable{XpltGroup::Domain, XpltType::Vec3, XpltFormat::Region, "rigid position"},
                    XpltVariable{XpltGroup::Surface, XpltType::Float, XpltFormat::Item, "contact pressure"},
                    XpltVariable{XpltGroup::Surface, XpltType::Float, XpltFormat::Item, "contact gap"}};
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

TEST(CompareFiles, StatesWithoutASolutionAreTold) {
  std::vector<ResultFile> files = {named("a", make_file(4, {0, 1, 2}, hill)),
                                   named("b", make_file(4, {0, 1, 2}, hill))};
  files[0].xplt.states[2].status = kStatusNotConverged;
  files[1].xplt.states[1].status = kStatusNotConverged;
  EXPECT_TRUE(compare_files(files, {}).warnings.empty());  // FEBio means something else by it
  for (ResultFile& file : files) file.xplt.software = "FEBioDEA 1.0.0";
  EXPECT_EQ(compare_files(files, {}).warnings,
            (std::vector<std::string>{
                "warning: a.xplt: the state at time 2 is no solution; do not use its numbers",
                "warning: b.xplt: 1 of the 2 states before the compared one is no solution; peaks and integrals over "
                "time count them too"}));
}

TEST(CompareFiles, ThresholdsOfMegapascalsAreTooLowForOtherUnits) {
  std::vector<ResultFile> files = {named("a", make_file(4, {1}, hill)), named("b", make_file(4, {1}, hill))};
  for (ResultFile& file : files) file.xplt.units = "mm-N-s";
  EXPECT_TRUE(compare_files(files, {}).warnings.empty());
  for (ResultFile& file : files) file.xplt.units = "SI";
  EXPECT_EQ(
      compare_files(files, {}).warnings,
      (std::vector<std::string>{"note: thresholds 0.1 and 0.5 are in the files' unit, Pa, where 1 MPa is 1e+06: all "
                                "contact is above them; give others with --threshold"}));
  CompareOptions own;
  own.thresholds = {1e5};
  EXPECT_TRUE(compare_files(files, own).warnings.empty());
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

/// The same file with all places moved along x.
XpltFile shifted(XpltFile file, float by) {
  std::vector<float>& x = file.meshes[0].coordinates;
  for (std::size_t i = 0; i < x.size(); i += 3) x[i] += by;
  return file;
}

/// The same file, twice as wide along x.
XpltFile widened(XpltFile file) {
  std::vector<float>& x = file.meshes[0].coordinates;
  for (std::size_t i = 0; i < x.size(); i += 3) x[i] *= 2;
  return file;
}

// Squares of 1 x 1 and 2 x 1, 20 facets along an edge: a node counts as covered within a facet of the other's rim, and
// stands for half a facet on either side.
TEST(CompareFiles, TellsHowMuchOfTheLargerSurfaceIsCovered) {
  const auto one = [](double, double, double) { return 1.0; };
  const ResultFile narrow = named("narrow", make_file(20, {1}, one)),
                   wide = named("wide", widened(make_file(20, {1}, one)));
  const double facet = 0.1, tolerance = 1.5 * facet / 2;
  const auto said = [](const Comparison& c, const std::string& text) {
    return std::count_if(c.warnings.begin(), c.warnings.end(),
                         [&](const std::string& line) { return line.find(text) != std::string::npos; });
  };
  const Comparison larger = compare_files({wide, narrow}, {});
  EXPECT_EQ(larger.surfaces[0].covered[0], 1.0);
  EXPECT_NEAR(larger.surfaces[0].covered_by_reference[0], 0.5, tolerance);
  EXPECT_EQ(said(larger, "warning: surface \"top\" of wide reaches beyond: only 5"), 1);
  EXPECT_EQ(said(larger, "covers only"), 0);
  const Comparison smaller = compare_files({narrow, wide}, {});
  EXPECT_NEAR(smaller.surfaces[0].covered[0], 0.5, tolerance);
  EXPECT_EQ(smaller.surfaces[0].covered_by_reference[0], 1.0);
  EXPECT_EQ(said(smaller, "warning: surface \"top\" of narrow covers only 5"), 1);
  EXPECT_EQ(said(smaller, "reaches beyond"), 0);
  // each goes on where the other ends
  const Comparison beside = compare_files({named("moved", shifted(make_file(20, {1}, one), 0.5F)), narrow}, {});
  EXPECT_NEAR(beside.surfaces[0].covered[0], 0.5, 1.5 / 20);
  EXPECT_NEAR(beside.surfaces[0].covered_by_reference[0], 0.5, 1.5 / 20);
  EXPECT_EQ(said(beside, "covers only"), 1);
  EXPECT_EQ(said(beside, "covered by"), 1);
  const Comparison same = compare_files({narrow, narrow}, {});
  EXPECT_EQ(same.surfaces[0].covered_by_reference[0], 1.0);
  EXPECT_EQ(said(same, "cover"), 0);
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
  ASSERT_EQ(both.xplt.states.size(), 2u);  // b has nothing at 1
  EXPECT_EQ(both.xplt.states[1].time, 2.0f);
  EXPECT_EQ(both.xplt.states[1].variables[0], files[0].xplt.states[2].variables[0]);  // displacement
  EXPECT_EQ(both.xplt.states[1].objects, files[0].xplt.states[2].objects);
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
  XpltFile other = good.xplt;
  other.variables[2].name = "contact traction";
  EXPECT_EQ(fault({good, named("other", other)}),
            "other.xplt: found no surface with \"contact pressure\" at time 1, expected one");
  other = good.xplt;
  other.meshes[0].surfaces[1].name = "lid";
  EXPECT_EQ(fault({good, named("other", other)}),
            "found no surface with \"contact pressure\" that all files have, expected --surface A=B: good.xplt has "
            "\"top\"; other.xplt has \"lid\"");
  CompareOptions options;
  options.surfaces = {"bottom"};
  EXPECT_EQ(fault({good, good}, options),
            "good.xplt: found no surface \"bottom\" with \"contact pressure\", expected one of \"top\"");
  other = good.xplt;
  for (float& x : other.meshes[0].coordinates) x += 50.0f;
  EXPECT_EQ(fault({good, named("far", other)}), "good.xplt: surface \"top\" lies nowhere on \"top\" of far.xplt");
  other = good.xplt;
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

/// Left facets have pressure 1, right ones 4, on a square cut in four; the line between them is at x = 0.5.
XpltFile two_halves() {
  return make_file(2, {1}, [](double x, double, double) { return x < 0.5 ? 1.0 : 4.0; });
}

/// The displacement of every node as a function of its place.
void displace(XpltFile& file, const std::function<Vector3d(const Vector3d&)>& u) {
  std::vector<float>& values = file.states.back().variables[0][0].values;
  const std::vector<float>& x = file.meshes[0].coordinates;
  for (std::size_t i = 0; i < x.size(); i += 3) {
    const Vector3d moved = u(Vector3d(x[i], x[i + 1], x[i + 2]));
    for (std::size_t k = 0; k < 3; ++k) values[i + k] = static_cast<float>(moved[static_cast<int>(k)]);
  }
}

void add_contact_force(XpltFile& file, float z) {
  file.variables.push_back(XpltVariable{XpltGroup::Surface, XpltType::Vec3, XpltFormat::Region, "contact force"});
  file.states.back().variables.push_back({{2, {0, 0, z}}});
}

TEST(CompareFiles, DeformedAreasAreThoseOfTheMovedNodesAndPlacesStay) {
  XpltFile stretched = two_halves();  // the middle line moves by 0.1: left facets 0.6 wide, right ones 0.4; all sink
  displace(stretched, [](const Vector3d& x) { return Vector3d(0.2 * (0.5 - std::abs(x.x() - 0.5)), 0, -0.05); });
  add_contact_force(stretched, -2.2f);
  const std::vector<ResultFile> files = {named("dea", two_halves()), named("fea", stretched)};
  CompareOptions options;
  options.areas = CompareAreas::Deformed;
  const Comparison c = compare_files(files, options);
  const ComparedRegion& r = c.surfaces[0].regions[0];
  const double eps = 1e-6;  // single precision
  EXPECT_NEAR(r.results[1].facets[0].mean, 0.6 * 1 + 0.4 * 4, eps);
  EXPECT_NEAR(r.results[1].resultant.z(), 2.2, eps);
  EXPECT_NEAR(r.results[1].center_of_pressure.x(), (0.6 * 0.25 + 1.6 * 0.75) / 2.2, eps);  // places of the reference
  // nodes: 1 on the left edge with 0.3 of the area, 2.2 on the line with 0.5, 4 on the right edge with 0.2
  EXPECT_NEAR(r.results[1].nodes[0].mean, 0.3 * 1 + 0.5 * 2.2 + 0.2 * 4, eps);
  EXPECT_NEAR(r.results[0].facets[0].mean, 2.5, eps);
  EXPECT_TRUE(c.surfaces[0].same_mesh[0]);
  const SurfaceFacts &dea = c.surfaces[0].facts[0], &fea = c.surfaces[0].facts[1];
  EXPECT_TRUE(fea.deforms);
  EXPECT_FALSE(dea.deforms);
  EXPECT_NEAR(fea.deformed_area, 1, eps);
  EXPECT_NEAR(share_of_contact_force(fea, CompareAreas::Deformed), 1, eps);
  EXPECT_NEAR(share_of_contact_force(fea, CompareAreas::Reference), 2.5 / 2.2, eps);
  EXPECT_TRUE(std::isnan(share_of_contact_force(dea, CompareAreas::Deformed)));
  EXPECT_EQ(c.warnings,
            (std::vector<std::string>{
                "note: dea: surface \"top\" does not deform in its file: its areas are those of the mesh"}));

  const Comparison reference = compare_files(files, {});
  EXPECT_NEAR(reference.surfaces[0].regions[0].results[1].facets[0].mean, 2.5, eps);
  EXPECT_EQ(reference.warnings, (std::vector<std::string>{
                                    "note: fea: pressure on \"top\" times the reference mesh's areas is 113.6% of its "
                                    "contact force, times deformed areas 100.0%: --areas deformed"}));
}

/// Its files draw the layers as squeezed, but its springs push on the areas of the mesh.
TEST(CompareFiles, FilesOfDeaKeepTheAreasOfTheMesh) {
  XpltFile drawn = two_halves();
  drawn.software = "FEBioDEA 0.1.0";
  displace(drawn, [](const Vector3d& x) { return Vector3d(0.2 * x.x(), 0, 0); });
  add_contact_force(drawn, -2.5f);
  CompareOptions options;
  options.areas = CompareAreas::Deformed;
  const Comparison c = compare_files({named("ours", drawn), named("b", two_halves())}, options);
  const SurfaceFacts& facts = c.surfaces[0].facts[0];
  EXPECT_FALSE(facts.deforms);
  EXPECT_EQ(facts.deformed_area, facts.area);
  EXPECT_NEAR(c.surfaces[0].regions[0].results[0].resultant.z(), 2.5, 1e-6);
  EXPECT_NEAR(share_of_contact_force(facts, CompareAreas::Deformed), 1, 1e-6);
  ASSERT_FALSE(c.warnings.empty());
  EXPECT_EQ(c.warnings[0],
            "note: ours: dea's pressure is per area of the mesh: areas of \"top\" are those of the mesh");
}

TEST(CompareFiles, ABodyThatTurnsKeepsItsAreas) {
  XpltFile turned = two_halves();
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.4, Vector3d(1, 2, 0.5).normalized()).toRotationMatrix();
  displace(turned, [&](const Vector3d& x) { return Vector3d(R * x - x + Vector3d(5, -3, 2)); });
  CompareOptions options;
  options.areas = CompareAreas::Deformed;
  const Comparison c = compare_files({named("turned", turned), named("still", two_halves())}, options);
  const ComparedRegion& r = c.surfaces[0].regions[0];
  EXPECT_FALSE(c.surfaces[0].facts[0].deforms);
  EXPECT_NEAR(r.results[0].facets[0].mean, 2.5, 1e-5);
  EXPECT_NEAR((r.results[0].resultant - 2.5 * R.col(2)).norm(), 0, 1e-5);  // areas turn with the body
  EXPECT_NEAR(r.differences[0].correlation, 1, 1e-9);
}

TEST(CompareFiles, DeformedAreasNeedADisplacement) {
  XpltFile bare = two_halves();
  bare.variables.erase(bare.variables.begin());
  bare.states[0].variables.erase(bare.states[0].variables.begin());
  CompareOptions options;
  EXPECT_NO_THROW(compare_files({named("bare", bare), named("b", two_halves())}, options));
  options.areas = CompareAreas::Deformed;
  try {
    compare_files({named("bare", bare), named("b", two_halves())}, options);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(
        e.what(),
        "bare.xplt: found no \"displacement\" of the nodes at time 1, expected one for --areas deformed; --areas "
        "reference needs none");
  }
}

// The program reads no file with such positions or facets; others that fill the structs may have them.
TEST(CompareFiles, FacetsThatAreNoneAreRefused) {
  const auto refusal = [](const XpltFile& file, CompareAreas areas) {
    CompareOptions options;
    options.areas = areas;
    try {
      compare_files({named("bad", file), named("b", two_halves())}, options);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  XpltFile five = two_halves();
  for (XpltFacets& facets : five.meshes[0].surfaces) {
    facets.nodes.insert(facets.nodes.end(), {0, 1, 2, 3, 4});
    facets.begin.push_back(static_cast<int>(facets.nodes.size()));
  }
  EXPECT_NE(refusal(five, CompareAreas::Reference).find("found a facet of 5 nodes, expected triangles and quads"),
            std::string::npos);
  XpltFile nowhere = two_halves();
  for (float& x : nowhere.states[0].variables[0][0].values) x = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(refusal(nowhere, CompareAreas::Deformed),
            "bad.xplt: surface \"top\": found a node whose position is not a number");
}

// The sum of its areas is 0 but for rounding, which is no axis.
TEST(CompareFiles, AClosedSurfaceHasNoAxis) {
  XpltFile file = make_file(7, {1}, hill);
  XpltFacets& top = file.meshes[0].surfaces[1];
  const int facets = top.size();
  for (int f = 0; f < facets; ++f) {  // each once more, from below
    const std::vector<int> nodes(top.nodes.begin() + 4 * f, top.nodes.begin() + 4 * f + 4);
    top.nodes.insert(top.nodes.end(), nodes.rbegin(), nodes.rend());
    top.begin.push_back(static_cast<int>(top.nodes.size()));
  }
  for (std::size_t v : {std::size_t{2}, std::size_t{3}})
    file.states[0].variables[v][0].values.resize(static_cast<std::size_t>(2 * facets), 0.0f);
  CompareOptions options;
  options.profile = true;
  try {
    compare_files({named("a", file), named("b", file)}, options);
    FAIL();
  } catch (const UsageError& e) {
    EXPECT_STREQ(e.what(), "surface \"top\" is closed and has no axis of its own: --axis x,y,z");
  }
  options.axis = Vector3d(0, 0, 1);
  EXPECT_NO_THROW(compare_files({named("a", file), named("b", file)}, options));
}

TEST(CompareFiles, AMapThatCarriesNotAllOfItsForceIsNamed) {
  XpltFile half_lost = two_halves();
  add_contact_force(half_lost, -5.0f);  // sum of p A is 2.5
  EXPECT_EQ(compare_files({named("lost", half_lost), named("b", two_halves())}, {}).warnings,
            (std::vector<std::string>{"note: lost: the pressure map of \"top\" carries 50.0% of its contact force"}));

  XpltFile left = two_halves();  // a surface of the left facets only: 0.5 of the other's 2.5 lie on it
  XpltFacets& top = left.meshes[0].surfaces[1];
  top.nodes = {top.nodes[0], top.nodes[1], top.nodes[2],  top.nodes[3],
               top.nodes[8], top.nodes[9], top.nodes[10], top.nodes[11]};
  top.begin = {0, 4, 8};
  for (std::size_t v : {2, 3}) left.states[0].variables[v][0].values.resize(2);
  XpltFile even = make_file(2, {1}, [](double, double, double) { return 3.0; });
  const Comparison c = compare_files({named("whole", even), named("left", left)}, {});
  EXPECT_NEAR(c.surfaces[0].facts[0].carried, 0.5, 1e-6);
  EXPECT_EQ(c.surfaces[0].facts[1].carried, 1.0);
  ASSERT_EQ(c.warnings.size(), 1u);
  EXPECT_EQ(
      c.warnings[0],
      "note: whole: its map of \"top\", projected onto the mesh of left, carries 50.0% of its own resultant there; "
      "correlation, rms and Dice are of that");
}

/// FEBio's sliding-elastic contact integrates over the current surface, and a stiffer penalty gives way in proportion.
TEST(CompareFiles, ReferenceFilesCarryTheirContactForceOnDeformedAreasAndGiveWayByTheirPenalty) {
  const fs::path folder = DEA_REFERENCE_DIR;
  if (!fs::exists(folder / "hip_walking_febio_penalty20.xplt")) GTEST_SKIP() << "no reference results";
  std::vector<double> compliance;
  for (const char* name :
       {"hip_walking_febio_penalty20", "hip_walking_febio_penalty50", "hip_stairs_up_febio_penalty20",
        "hip_stairs_down_febio_penalty20", "ball_loose_febio", "ball_tight_febio"}) {
    const ResultFile file = read_result((folder / (std::string(name) + ".xplt")).string(), name);
    const SurfaceFacts facts = compare_files({file, file}, {}).surfaces[0].facts[0];
    EXPECT_TRUE(facts.deforms) << name;
    // a facet's mean pressure times its area for an integral over it: facets at the edge of contact are not uniform
    EXPECT_NEAR(share_of_contact_force(facts, CompareAreas::Deformed), 1, 1e-3) << name;
    EXPECT_LT(share_of_contact_force(facts, CompareAreas::Reference), 0.99) << name;
    compliance.push_back(facts.interface.compliance);
  }
  // the README there: 0.0107 and 0.0043, of means over all facets with pressure
  EXPECT_NEAR(compliance[0], 0.0107, 0.03 * 0.0107);
  EXPECT_NEAR(compliance[1], 0.0043, 0.03 * 0.0043);
  EXPECT_NEAR(compliance[0] / compliance[1], 50.0 / 20.0, 0.05);  // other pressures weigh the same facets' penalties
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

TEST_F(CompareCommand, SaysWhichAreasAndHowFarTheContactGivesWay) {
  XpltFile b = make_file(6, {0, 1}, hill);
  std::vector<float>& gap = b.states[1].variables[3][0].values;
  for (std::size_t f = 0; f < gap.size(); ++f) gap[f] = 0.0125f * b.states[1].variables[2][0].values[f];
  displace(b, [](const Vector3d& x) { return Vector3d(0.1 * x.x(), 0, 0); });
  write_xplt((folder / "b.xplt").string(), b);
  const test::Finished plain = compare("a.xplt b.xplt");
  ASSERT_EQ(plain.code, 0) << plain.err;
  EXPECT_NE(plain.out.find("areas: of the mesh in the reference configuration\n"), std::string::npos) << plain.out;
  EXPECT_NE(plain.out.find("b: its contact gives way by 0.0125 per pressure"), std::string::npos) << plain.out;
  EXPECT_NE(plain.out.find("--interface-stiffness 80 puts the same in series\n"), std::string::npos) << plain.out;
  EXPECT_EQ(plain.out.find("a: its contact"), std::string::npos) << plain.out;  // no gap, nothing to put in series
  const test::Finished f = compare("a.xplt b.xplt --areas deformed --json -");
  ASSERT_EQ(f.code, 0) << f.err;
  const Json j = Json::parse(f.out), files = j["surfaces"][0]["files"];
  EXPECT_EQ(j["areas"], "deformed");
  EXPECT_NEAR(files[1]["area"]["reference"].get<double>(), 1, 1e-5);
  EXPECT_NEAR(files[1]["area"]["deformed"].get<double>(), 1.1, 1e-5);
  EXPECT_EQ(files[1]["deforms"], true);
  EXPECT_EQ(files[0]["deforms"], false);
  EXPECT_TRUE(files[0]["contact_force"].is_null());
  EXPECT_TRUE(files[0]["interface"].is_null());
  EXPECT_NEAR(files[1]["interface"]["stiffness"].get<double>(), 80, 1e-4);
  const test::Finished text = compare("a.xplt b.xplt --areas deformed");
  EXPECT_NE(text.out.find("areas: deformed, nodes moved by each file's own displacement\n"), std::string::npos);
  EXPECT_NE(text.out.find("surface top; deformed areas\n"), std::string::npos) << text.out;
  const test::Finished csv = compare("a.xplt b.xplt --areas deformed --csv -");
  std::istringstream lines(csv.out);
  std::string line;
  ASSERT_TRUE(std::getline(lines, line));
  const std::string last =
      ",areas,headline_p99,headline_mean,headline_area,headline_peak,headline_above,covered_by_reference,solved";
  EXPECT_EQ(line.substr(line.size() - last.size()), last);
  ASSERT_TRUE(std::getline(lines, line));
  EXPECT_NE(line.find(",deformed,"), std::string::npos);
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

// A socket's six regions are halves of its thirds, and sectors leave nothing out.
TEST_F(CompareCommand, RegionsInTheWordsOfStudies) {
  const auto areas = [&](const std::string& words) {
    const test::Finished f = compare("a.xplt b.xplt --up 0,1,0 --json - --regions " + words);
    EXPECT_EQ(f.code, 0) << f.err;
    std::map<std::string, double> found;
    const Json report = Json::parse(f.out);
    for (const Json& region : report["surfaces"][0]["regions"])
      found[region["name"].is_null() ? "" : region["name"].get<std::string>()] =
          region["results"][1]["facets"][0]["area"];
    return found;
  };
  std::map<std::string, double> thirds = areas("anterior-superior-posterior --anterior -1,0,0"),
                                socket = areas("socket --anterior -1,0,0"), sectors = areas("sectors=4");
  EXPECT_EQ(socket.size(), 7u);
  for (const std::string name : {"anterior", "superior", "posterior"})
    EXPECT_NEAR(socket[name + " medial"] + socket[name + " lateral"], thirds[name], 1e-9) << name;
  double all = 0;
  for (const auto& [name, area] : sectors) all += name.empty() ? 0.0 : area;
  EXPECT_EQ(sectors.size(), 5u);
  EXPECT_NEAR(all, sectors[""], 1e-9);
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
      {"a.xplt b.xplt --label x --label ''", 2, "dea: --label : found 0 bytes, expected 1 to 40"},
      {"a.xplt b.xplt --label x --label 12345678901234567890123456789012345678901", 2,
       "dea: --label 12345678901234567890123456789012345678901: found 41 bytes, expected 1 to 40"},
      {"a.xplt b.xplt --axis 0,0,1", 2,
       "dea: --axis and --center belong to --profile or --regions socket|anterior-superior-posterior|sectors=N"},
      {"a.xplt b.xplt --threshold 0", 2, "dea: --threshold 0: found \"0\", expected a pressure above 0"},
      {"a.xplt b.xplt --areas current", 2, "dea: --areas current: found \"current\", expected reference or deformed"},
      {"a.xplt b.xplt --at soon", 2, "dea: --at soon: found \"soon\""},
      {"a.xplt b.xplt --regions anterior-superior-posterior --up 0,0,1", 2,
       "dea: --regions socket|anterior-superior-posterior|sectors=N, --up x,y,z and --anterior x,y,z go together"},
      {"a.xplt b.xplt --regions socket,sectors=3 --up 0,1,0 --anterior -1,0,0", 2,
       "dea: --regions socket,sectors=3: found two of socket|anterior-superior-posterior|sectors=N, expected one"},
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

}  // namespace dea::compare_test

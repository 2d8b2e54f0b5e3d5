// Measures of results against answers on paper: flat grids and caps of a sphere with pressures given as formulas.
#include "src/results/comparison.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numeric>

#include "src/base/error.h"
#include "src/base/numbers.h"

namespace dea::comparison_test {

using Field = std::function<double(const Vector3d&)>;

/// [0, 1] x [0, 1] x 0 in n x m quads, facet (i, j) is number i + n j; normals along z.
ResultSurface grid(int n, int m, double shift_x = 0.0) {
  std::vector<int> begin = {0}, nodes;
  std::vector<Vector3d> x;
  for (int j = 0; j <= m; ++j)
    for (int i = 0; i <= n; ++i) x.push_back({shift_x + static_cast<double>(i) / n, static_cast<double>(j) / m, 0});
  for (int j = 0; j < m; ++j) {
    for (int i = 0; i < n; ++i) {
      const int a = i + (n + 1) * j;
      nodes.insert(nodes.end(), {a, a + 1, a + n + 2, a + n + 1});
      begin.push_back(static_cast<int>(nodes.size()));
    }
  }
  return make_result_surface("grid", begin, nodes, x);
}

/// Cap of a sphere about the z axis up to `opening`, n rings of 4 n facets, triangles at the pole; normals outwards.
ResultSurface cap(int n, double radius, double opening) {
  std::vector<int> begin = {0}, nodes;
  std::vector<Vector3d> x = {{0, 0, radius}};
  const int around = 4 * n;
  for (int i = 1; i <= n; ++i) {
    for (int k = 0; k < around; ++k) {
      const double theta = opening * i / n, phi = 2 * kPi * k / around;
      x.push_back(radius * Vector3d(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)));
    }
  }
  const auto id = [&](int i, int k) { return i == 0 ? 0 : 1 + (i - 1) * around + k % around; };
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < around; ++k) {
      if (i == 0)
        nodes.insert(nodes.end(), {0, id(1, k), id(1, k + 1)});
      else
        nodes.insert(nodes.end(), {id(i, k), id(i + 1, k), id(i + 1, k + 1), id(i, k + 1)});
      begin.push_back(static_cast<int>(nodes.size()));
    }
  }
  return make_result_surface("cap", begin, nodes, x);
}

std::vector<double> at_centers(const ResultSurface& s, const Field& field) {
  std::vector<double> values;
  for (const Vector3d& x : s.facet_centers) values.push_back(field(x));
  return values;
}

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

/// Pressure of a ball in a socket: cos of the angle from a tilted axis, 0 behind it.
double tilted_cosine(const Vector3d& x) { return std::max(0.0, 5 * x.normalized().dot(Vector3d(0.6, 0, 0.8)) - 1); }

TEST(Comparison, NodesHaveAQuarterOfEachQuadAndAThirdOfEachTriangle) {
  // a quad 2 x 1, a triangle of area 1 and a quad collapsed to a triangle of area 0.5, in a row
  const std::vector<Vector3d> x = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}, {4, 0, 0}, {4, 0.5, 0}};
  const ResultSurface s = make_result_surface("s", {0, 4, 7, 11}, {0, 1, 2, 3, 1, 4, 2, 4, 5, 2, 2}, x);
  EXPECT_EQ(s.facet_areas, (std::vector<double>{2, 1, 0.5}));
  std::vector<double> by_node(6, 0.0);
  const std::vector<double> areas = nodal_areas(s), only_quad = nodal_areas(s, {1, 0, 0});
  for (std::size_t v = 0; v < areas.size(); ++v) by_node[static_cast<std::size_t>(s.mesh.model_nodes[v])] = areas[v];
  const std::vector<double> expected = {0.5, 0.5 + 1.0 / 3, 0.5 + 1.0 / 3 + 0.5 / 3, 0.5, 1.0 / 3 + 0.5 / 3, 0.5 / 3};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(by_node[i], expected[i], 1e-15);
  EXPECT_NEAR(sum(only_quad), 2, 1e-15);
  // average at node 2: (2 * 1 + 1 * 4 + 0.5 * 10) / 3.5
  const std::vector<double> average = nodal_average(s, {1, 4, 10});
  for (std::size_t v = 0; v < average.size(); ++v) {
    const double expected_average[] = {1, 1.0 * (2 + 4) / 3, 11 / 3.5, 1, (4 + 0.5 * 10) / 1.5, 10};
    EXPECT_NEAR(average[v], expected_average[s.mesh.model_nodes[v]], 1e-14);
  }
}

TEST(Comparison, DistributionOfValuesWithEqualAndUnequalAreas) {
  std::vector<double> values, ones;
  for (int i = 11; i >= 0; --i) {
    values.push_back(i);
    ones.push_back(2.0);
  }
  const Distribution d = distribution(values, ones, 0.0);  // 1 .. 11; 0 is not above 0
  EXPECT_EQ(d.area, 22);
  EXPECT_EQ(d.peak, 11);
  EXPECT_EQ(d.mean, 6);
  EXPECT_EQ(d.median, 6);
  EXPECT_DOUBLE_EQ(d.p99_unweighted, 10.9);  // rank 0.99 * 10 of 0 .. 10
  EXPECT_DOUBLE_EQ(d.p25, 3.25);             // middles of the shares at 1/22, 3/22, ...: 0.25 * 11 = 2.75 -> 3 + 0.25
  EXPECT_DOUBLE_EQ(d.p75, 8.75);
  EXPECT_EQ(distribution(values, ones, 9.0).area, 4);
  const Distribution two = distribution({1, 3}, {3, 1}, 0.0);
  EXPECT_EQ(two.mean, 1.5);
  const Distribution none = distribution({0, -1}, {1, 1}, 0.0);
  EXPECT_EQ(none.area, 0);
  EXPECT_TRUE(std::isnan(none.peak) && std::isnan(none.mean) && std::isnan(none.median));
}

TEST(Comparison, ResultantOfUniformPressureIsThatOfTheRimsPolygon) {
  // closing the cap with the plane of its rim gives a closed polyhedron: sum of A n over it is 0
  const int n = 6;
  const double radius = 20, opening = 1.2, p = 3;
  const ResultSurface s = cap(n, radius, opening);
  const SurfaceMeasures m = measure(s, {std::vector<double>(static_cast<std::size_t>(s.facets()), p), {}}, {0.0});
  const double rim = radius * std::sin(opening), polygon = 0.5 * 4 * n * rim * rim * std::sin(2 * kPi / (4 * n));
  EXPECT_NEAR(m.resultant.z(), p * polygon, 1e-10 * p * polygon);
  EXPECT_NEAR(m.resultant.head<2>().norm(), 0, 1e-10 * p * polygon);
  EXPECT_NEAR(m.center_of_pressure.head<2>().norm(), 0, 1e-10);
  EXPECT_NEAR(m.facets[0].area, sum(s.facet_areas), 1e-9);
  EXPECT_NEAR(m.nodes[0].area, m.facets[0].area, 1e-9);
}

TEST(Comparison, CenterOfPressureAndPenetrationAreThoseOfFacetsWithPressure) {
  const ResultSurface s = grid(4, 1);
  const SurfaceMeasures m = measure(s, {{0, 1, 3, 0}, {9, 0.1, 0.3, 9}}, {0.0, 2.0});
  EXPECT_NEAR(m.center_of_pressure.x(), (0.375 + 3 * 0.625) / 4, 1e-14);
  EXPECT_NEAR(m.center_of_pressure.y(), 0.5, 1e-14);
  EXPECT_NEAR(m.resultant.z(), 1.0, 1e-14);  // (1 + 3) / 4
  EXPECT_NEAR(m.mean_penetration, 0.2, 1e-14);
  EXPECT_EQ(m.max_penetration, 0.3);
  EXPECT_NEAR(m.facets[1].area, 0.25, 1e-14);
  const SurfaceMeasures half = measure(s, {{0, 1, 3, 0}, {}}, {0.0}, {1, 1, 0, 0});
  EXPECT_NEAR(half.resultant.z(), 0.25, 1e-14);
  EXPECT_TRUE(std::isnan(half.mean_penetration));
}

TEST(Comparison, ComplianceOfAContactIsGapOverPressureWeightedByForce) {
  // penalties 1/0.01 under force 1 x 8 and 1/0.02 under 2 x 2; the rest is a facet half in contact and one without any
  const InterfaceCompliance c = interface_compliance({8, 2, 0.5, 0}, {0.08, 0.04, -0.3, -1}, {1, 2, 5, 5});
  EXPECT_NEAR(c.compliance, (8 * 0.01 + 4 * 0.02) / 12, 1e-15);
  EXPECT_EQ(c.facets, 2);
  EXPECT_NEAR(c.p5, 0.01, 1e-15);
  EXPECT_NEAR(c.p95, 0.02, 1e-15);
  EXPECT_EQ(interface_compliance({8, 2}, {0, 0}, {1, 1}).compliance, 0.0);
  EXPECT_TRUE(std::isnan(interface_compliance({8, 2}, {}, {1, 1}).compliance));
  EXPECT_TRUE(std::isnan(interface_compliance({0, 0}, {0.1, 0.1}, {1, 1}).compliance));
}

TEST(Comparison, AResultAgainstItselfDiffersByExactlyNothing) {
  const ResultSurface s = cap(9, 24, 1.4);
  const std::vector<double> nodal = nodal_average(s, at_centers(s, tilted_cosine)), areas = nodal_areas(s);
  const NodeMatch match = match_nodes(s, s);
  EXPECT_TRUE(match.same_mesh);
  EXPECT_EQ(match.covered, 1.0);
  EXPECT_EQ(carry_values(match, s, nodal), nodal);
  const PatternDifference d = pattern_difference(nodal, nodal, areas, {0.0, 0.5});
  EXPECT_EQ(d.correlation, 1.0);
  EXPECT_EQ(d.rms, 0.0);
  EXPECT_EQ(d.mean, 0.0);
  EXPECT_EQ(d.largest, 0.0);
  EXPECT_EQ(d.dice, (std::vector<double>{1.0, 1.0}));
  EXPECT_EQ(percent_difference(3.7, 3.7), 0.0);
  EXPECT_EQ(percent_difference(0.0, 0.0), 0.0);
  EXPECT_TRUE(std::isnan(percent_difference(1.0, 0.0)));
}

TEST(Comparison, ATenthMoreIsTenPercentMoreInEveryMeasure) {
  const ResultSurface s = cap(9, 24, 1.4);
  const std::vector<double> b = at_centers(s, tilted_cosine);
  std::vector<double> a = b;
  for (double& p : a) p *= 1.1;
  const SurfaceMeasures ma = measure(s, {a, {}}, {0.0}), mb = measure(s, {b, {}}, {0.0});
  for (const bool nodes : {true, false}) {
    const Distribution &da = nodes ? ma.nodes[0] : ma.facets[0], &db = nodes ? mb.nodes[0] : mb.facets[0];
    for (const auto value :
         {&Distribution::peak, &Distribution::p99, &Distribution::mean, &Distribution::p5, &Distribution::p25,
          &Distribution::median, &Distribution::p75, &Distribution::p95, &Distribution::p99_unweighted})
      EXPECT_NEAR(percent_difference(da.*value, db.*value), 10, 1e-10);
    EXPECT_EQ(da.area, db.area);
  }
  EXPECT_NEAR(percent_difference(ma.resultant.norm(), mb.resultant.norm()), 10, 1e-10);
  EXPECT_NEAR((ma.center_of_pressure - mb.center_of_pressure).norm(), 0, 1e-12);
  const std::vector<double> na = nodal_average(s, a), nb = nodal_average(s, b), areas = nodal_areas(s);
  const PatternDifference d = pattern_difference(na, nb, areas, {0.0});
  EXPECT_NEAR(d.correlation, 1, 1e-14);
  EXPECT_NEAR(d.largest, 0.1 * mb.nodes[0].peak, 1e-12);
  EXPECT_NEAR(d.mean, 0.1 * mb.nodes[0].mean, 1e-12);
  EXPECT_EQ(d.dice[0], 1.0);
  double squares = 0;
  for (std::size_t v = 0; v < nb.size(); ++v) squares += areas[v] * nb[v] * nb[v];
  EXPECT_NEAR(d.rms, 0.1 * std::sqrt(squares / mb.nodes[0].area), 1e-12);
}

TEST(Comparison, DiceAndCorrelationOnPaper) {
  const std::vector<double> areas = {1, 2, 3, 4};
  const PatternDifference d = pattern_difference({1, 1, 0, 0}, {0, 1, 2, 0}, areas, {0.0, 1.5, 5.0});
  EXPECT_DOUBLE_EQ(d.dice[0], 2 * 2.0 / (3 + 5));
  EXPECT_EQ(d.dice[1], 0.0);
  EXPECT_TRUE(std::isnan(d.dice[2]));
  EXPECT_DOUBLE_EQ(d.rms, std::sqrt((1 * 1 + 3 * 4) / 6.0));  // the fourth node has no pressure on either side
  EXPECT_EQ(d.largest, -2);
  EXPECT_DOUBLE_EQ(correlation({1, 2, 3}, {6, 4, 2}, {1, 5, 1}), -1.0);
  EXPECT_DOUBLE_EQ(correlation({0, 1, 0, 1}, {0, 0, 1, 1}, {3, 1, 1, 3}), 0.5);  // means 1/2; (3 + 3 - 1 - 1) / 8
  EXPECT_TRUE(std::isnan(correlation({0.1, 0.1, 0.1}, {1, 2, 3}, {1, 1, 1})));
  const double nan = std::nan("");
  EXPECT_DOUBLE_EQ(pattern_difference({nan, 2}, {5, 1}, {1, 1}, {0.0}).rms, 1.0);
}

// Carried between meshes of size h, a smooth pressure must be met with an error that falls with h^2: averages around
// nodes of even grids and linear interpolation both are of second order. The pressure vanishes with its slope before
// the rim, where averages are one-sided.
TEST(Comparison, ProjectionBetweenMeshesIsOfSecondOrder) {
  const Field bump = [](const Vector3d& x) {
    const double r2 = (x.x() - 0.5) * (x.x() - 0.5) + (x.y() - 0.5) * (x.y() - 0.5);
    return r2 < 0.16 ? std::pow(1 - r2 / 0.16, 3) : 0.0;
  };
  const auto rms = [&](int n) {
    const ResultSurface a = grid(n, n), b = grid(n * 7 / 5, n * 7 / 5);
    const NodeMatch match = match_nodes(b, a);
    EXPECT_FALSE(match.same_mesh);
    EXPECT_EQ(match.covered, 1.0);
    std::vector<double> exact;
    for (const Vector3d& x : b.mesh.vertices) exact.push_back(bump(x));
    return pattern_difference(carry_values(match, a, nodal_average(a, at_centers(a, bump))), exact, nodal_areas(b),
                              {0.0})
        .rms;
  };
  const double coarse = rms(20), middle = rms(40), fine = rms(80);
  EXPECT_NEAR(std::log2(coarse / middle), 2, 0.2);
  EXPECT_NEAR(std::log2(middle / fine), 2, 0.1);
  EXPECT_LT(fine, 1e-3);
}

TEST(Comparison, RenumberedFacetsAreMatchedByPosition) {
  const ResultSurface a = grid(6, 5);
  // the same facets in reverse order, each starting at another corner
  std::vector<int> begin = {0}, nodes;
  std::vector<Vector3d> x;
  for (int f = a.facets() - 1; f >= 0; --f) {
    for (int k = 0; k < 4; ++k) {
      nodes.push_back(static_cast<int>(x.size()));
      x.push_back(a.slot_position[static_cast<std::size_t>(4 * f + (k + 2) % 4)]);
    }
    begin.push_back(static_cast<int>(nodes.size()));
  }
  const ResultSurface b = make_result_surface("b", begin, nodes, x);
  const Field plane = [](const Vector3d& p) { return 1 + p.x(); };
  const NodeMatch match = match_nodes(b, a);
  EXPECT_FALSE(match.same_mesh);
  std::vector<double> nodal;
  for (const Vector3d& p : a.mesh.vertices) nodal.push_back(plane(p));
  const std::vector<double> carried = carry_values(match, a, nodal);
  for (std::size_t v = 0; v < carried.size(); ++v) EXPECT_NEAR(carried[v], plane(b.mesh.vertices[v]), 1e-12);
}

TEST(Comparison, WhatLiesBesideASurfaceIsNotCovered) {
  const ResultSurface a = grid(10, 10), b = grid(20, 20, 0.52);
  // a ends at 1 and counts up to one facet (0.1) farther: the nodes of b at 0.52, 0.57, ..., 1.07, with their shares up
  // to 1.095
  const NodeMatch match = match_nodes(b, a);
  EXPECT_NEAR(match.covered, 1.095 - 0.52, 1e-9);
  const std::vector<double> carried = carry_values(match, a, std::vector<double>(a.mesh.vertices.size(), 2.0));
  for (std::size_t v = 0; v < carried.size(); ++v) EXPECT_EQ(std::isnan(carried[v]), b.mesh.vertices[v].x() > 1.1);
  EXPECT_EQ(match_nodes(grid(4, 4, 5.0), a).covered, 0.0);
}

TEST(Comparison, ThirdsOfASocketFollowUpAndAnterior) {
  const ResultSurface s = cap(6, 24, 1.4);
  const SurfaceFrame frame = surface_frame(s);
  EXPECT_NEAR((frame.axis - Vector3d::UnitZ()).norm(), 0, 1e-12);
  EXPECT_NEAR(frame.center.norm(), 0, 1e-9);
  const std::vector<int> third = third_of(s.facet_centers, frame, {1, 0, 3},
                                          {0, 2, 1});  // only what lies across the axis counts: up x, anterior y
  const Vector3d middle[3] = {
      {-0.5, std::sqrt(0.75), 0}, {1, 0, 0}, {-0.5, -std::sqrt(0.75), 0}};  // 120 degrees each, cut below
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(std::count(third.begin(), third.end(), static_cast<int>(k)), s.facets() / 3);
    for (int f = 0; f < s.facets(); ++f) {
      const auto i = static_cast<std::size_t>(f);
      const Vector3d d(s.facet_centers[i].x(), s.facet_centers[i].y(), 0);
      EXPECT_EQ(third[i] == static_cast<int>(k), d.normalized().dot(middle[k]) > 0.5) << f;
    }
  }
  EXPECT_THROW(third_of(s.facet_centers, frame, {0, 0, 1}, {0, 1, 0}), UsageError);
  EXPECT_THROW(third_of(s.facet_centers, frame, {1, 0, 0}, {-2, 0, 1}), UsageError);
}

TEST(Comparison, FrameOfAFlatSurfaceIsItsCentroid) {
  const SurfaceFrame frame = surface_frame(grid(3, 3));
  EXPECT_NEAR((frame.axis - Vector3d::UnitZ()).norm(), 0, 1e-14);
  EXPECT_NEAR((frame.center - Vector3d(0.5, 0.5, 0)).norm(), 0, 1e-9);
}

// The mean of cos(theta) over the zone between a and b of a sphere is (cos a + cos b) / 2.
TEST(Comparison, ProfileOfACosineIsItsMeanOverEachZone) {
  const auto error = [](int n) {
    const ResultSurface s = cap(n, 24, kPi / 3);
    const auto bins = pressure_profile(s, at_centers(s, [](const Vector3d& x) { return x.normalized().z(); }),
                                       Vector3d(0, 0, 2), Vector3d::Zero(), 10);
    EXPECT_EQ(bins.size(), 6u);
    double worst = 0.0;
    for (const ProfileBin& bin : bins)
      worst =
          std::max(worst, std::abs(bin.mean - 0.5 * (std::cos(bin.from * kPi / 180) + std::cos(bin.to * kPi / 180))));
    return worst;
  };
  EXPECT_NEAR(std::log2(error(12) / error(24)), 2, 0.1);  // one value per facet: midpoint rule
  EXPECT_LT(error(24), 1e-3);
}

TEST(Comparison, SumsOverTimeAreExactForPressureLinearBetweenStates) {
  const TimeSums sums = over_time({0, 1, 3}, {{0, 4, 1}, {2, 0, 1}, {2, 0, 5}}, 1.0);
  EXPECT_EQ(sums.peak, (std::vector<double>{2, 4, 5}));
  EXPECT_EQ(sums.exposure, (std::vector<double>{1 + 4, 2, 1 + 6}));
  // above 1: 0 -> 2 in 1: half of 1/2 * 1; then 1 * 2; 4 -> 0 in 1: 1/2 * 3 * 3/4; 1 -> 5 in 2: 1/2 * 4 * 2
  EXPECT_DOUBLE_EQ(sums.dose[0], 0.25 + 2);
  EXPECT_DOUBLE_EQ(sums.dose[1], 1.125);
  EXPECT_DOUBLE_EQ(sums.dose[2], 4);
  EXPECT_TRUE(over_time({0}, {{1}}, std::nullopt).dose.empty());
}

TEST(Comparison, PoseDifferenceTakesTheSecondPoseToTheFirst) {
  BodyPose a, b;
  a.position = {1, 2, 3};
  b.position = {1, 1, 1};
  EXPECT_FALSE(pose_difference(a, b).rotation);
  b.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Vector3d::UnitZ()));
  a.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(0.1, Vector3d::UnitX())) * *b.rotation;
  const PoseDifference d = pose_difference(a, b);
  EXPECT_EQ(d.translation, Vector3d(0, 1, 2));
  ASSERT_TRUE(d.rotation);
  EXPECT_NEAR((*d.rotation - Vector3d(0.1, 0, 0)).norm(), 0, 1e-14);
  EXPECT_EQ(pose_difference(b, b).rotation->norm(), 0.0);
}

}  // namespace dea::comparison_test

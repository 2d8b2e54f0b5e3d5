// Queries of many triangles against the same queries of each triangle by itself: a tree may leave out nothing.
#include "src/geometry/ray_caster.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "src/base/numbers.h"

namespace dea::ray_caster_test {

/// What a ray caster asks of a surface; triangles may have no area here.
SurfaceMesh surface(std::vector<Vector3d> vertices, std::vector<std::array<int, 3>> triangles) {
  SurfaceMesh mesh;
  mesh.vertices = std::move(vertices);
  mesh.triangles = std::move(triangles);
  for (int t = 0; t < mesh.size(); ++t)
    mesh.normals.push_back(
        (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0)).normalized());
  return mesh;
}

struct Random {
  std::mt19937 engine;
  double number(double low, double high) { return std::uniform_real_distribution<>(low, high)(engine); }
  int index(std::size_t count) { return static_cast<int>(engine() % count); }
  Vector3d point(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }
  Vector3d direction() {
    if (engine() % 3 == 0) return (engine() % 2 == 0 ? 1.0 : -1.0) * Vector3d::Unit(index(3));
    return point(1).normalized();
  }
};

/// n x n squares of side 1 in a plane, each cut in two; heights up to `rough`.
SurfaceMesh grid(int n, double rough, Random& random) {
  std::vector<Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) vertices.emplace_back(i - n / 2, j - n / 2, random.number(0, rough));
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const int a = i * (n + 1) + j, b = a + n + 1;
      triangles.push_back({a, b, b + 1});
      triangles.push_back({a, b + 1, a + 1});
    }
  std::shuffle(triangles.begin(), triangles.end(), random.engine);
  return surface(vertices, triangles);
}

/// Triangles that have nothing to do with each other; some are there twice, some are a segment or a point.
SurfaceMesh soup(int count, Random& random) {
  std::vector<Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
  for (int t = 0; t < count; ++t) {
    if (t > 0 && random.index(8) == 0) {
      triangles.push_back(triangles[at(random.index(triangles.size()))]);
      continue;
    }
    const int first = static_cast<int>(vertices.size());
    const Vector3d a = random.point(4);
    const int kind = random.index(8);
    vertices.push_back(a);
    vertices.push_back(kind == 0 ? a : kind == 1 ? Vector3d(a + Vector3d::UnitX()) : Vector3d(a + random.point(1)));
    vertices.push_back(kind == 0 ? a : kind == 1 ? Vector3d(a + 2 * Vector3d::UnitX()) : Vector3d(a + random.point(1)));
    triangles.push_back({first, first + 1, first + 2});
  }
  return surface(vertices, triangles);
}

double extent(const SurfaceMesh& mesh) {
  Vector3d low = mesh.vertices.front(), high = low;
  for (const Vector3d& x : mesh.vertices) low = low.cwiseMin(x), high = high.cwiseMax(x);
  return (high - low).norm();
}

/// The surface's triangles, each a surface of its own with all vertices: tolerances hang on their extent.
std::vector<RayCaster> one_by_one(const SurfaceMesh& mesh) {
  std::vector<RayCaster> casters;
  for (const auto& triangle : mesh.triangles) casters.emplace_back(surface(mesh.vertices, {triangle}));
  return casters;
}

/// The queries' definitions (ray_caster.h), word by word.
LineHit nearest_of(const std::vector<RayCaster>& single, const Vector3d& origin, const Vector3d& direction, double from,
                   double limit, double to, double min_facing, double tolerance) {
  std::vector<LineHit> hits;
  bool valid = false;
  for (const RayCaster& caster : single) {
    hits.push_back(caster.nearest_facing(origin, direction, from, limit, to, min_facing));
    valid = valid || (hits.back().point.triangle >= 0 && hits.back().distance > limit);
  }
  const auto counts = [&](const LineHit& h) { return h.point.triangle >= 0 && (!valid || h.distance > limit); };
  double best = kInfinity;
  for (const LineHit& h : hits)
    if (counts(h)) best = std::min(best, std::abs(h.distance));
  for (std::size_t t = 0; t < hits.size(); ++t)
    if (counts(hits[t]) && std::abs(hits[t].distance) <= best + tolerance) {
      hits[t].point.triangle = static_cast<int>(t);
      return hits[t];
    }
  return {};
}

void expect_the_same(const SurfaceMesh& mesh, int queries, Random& random) {
  const RayCaster all(mesh);
  const std::vector<RayCaster> single = one_by_one(mesh);
  const double size = extent(mesh);
  int hits = 0, near_by = 0;
  for (int q = 0; q < queries; ++q) {
    // half of all lines and points touch a vertex, a middle of an edge or a box's wall: there triangles tie
    const Vector3d direction = random.direction();
    Vector3d x = random.point(6);
    if (q % 2 == 0) {
      const int t = random.index(mesh.triangles.size());
      x = mesh.corner(t, 0);
      if (q % 4 == 0) x = 0.5 * (x + mesh.corner(t, 1));
      x -= random.index(4) * direction;
    }
    const double from = q % 3 == 0 ? -kInfinity : -random.number(0, 8),
                 to = q % 5 == 0 ? kInfinity : random.number(0, 8), limit = q % 7 == 0 ? 0.0 : -random.number(0, 4),
                 facing = q % 2 == 0 ? 0.0 : 0.5;
    const LineHit hit = all.nearest_facing(x, direction, from, limit, to, facing),
                  expected = nearest_of(single, x, direction, from, limit, to, facing, 1e-9 * size);
    ASSERT_EQ(hit.point.triangle, expected.point.triangle) << "line " << q;
    ASSERT_EQ(hit.distance, expected.distance) << "line " << q;
    ASSERT_EQ(hit.point.weights, expected.point.weights) << "line " << q;
    hits += hit.point.triangle >= 0;

    SurfacePoint closest;
    double least = kInfinity;
    std::vector<SurfacePoint> points;
    std::vector<int> within;
    const double radius = q % 9 == 0 ? 0.0 : q % 10 == 0 ? kInfinity : random.number(0, 3);
    for (std::size_t t = 0; t < single.size(); ++t) {
      points.push_back(single[t].closest(x));
      const double d = (position(single[t].mesh(), points[t]) - x).norm();
      if (mesh.corner(static_cast<int>(t), 0) != mesh.corner(static_cast<int>(t), 1)) least = std::min(least, d);
      if (!single[t].within(x, radius).empty()) within.push_back(static_cast<int>(t));
    }
    const SurfacePoint found = all.closest(x);
    ASSERT_GE(found.triangle, 0);
    for (int t = 0; t < mesh.size(); ++t) {  // a triangle that is a point has nothing to be close by
      if (mesh.corner(t, 0) == mesh.corner(t, 1)) continue;
      if ((position(mesh, {t, points[at(t)].weights}) - x).norm() > least + 1e-12 * size) continue;
      closest = {t, points[at(t)].weights};
      break;
    }
    if (closest.triangle >= 0) {
      ASSERT_EQ(found.triangle, closest.triangle) << "point " << q;
      ASSERT_EQ(found.weights, closest.weights) << "point " << q;
    }
    ASSERT_EQ(all.within(x, radius), within) << "point " << q << ", radius " << radius;
    near_by += !within.empty();
  }
  EXPECT_TRUE(mesh.size() <= 50 || (hits > queries / 20 && near_by > queries / 20)) << hits << ", " << near_by;
}

TEST(RayCaster, FindsInAPlaneWithItsTiesWhatTrianglesFindByThemselves) {
  Random random{std::mt19937(1)};
  expect_the_same(grid(9, 0.0, random), 2000, random);
}

TEST(RayCaster, FindsInARoughSurfaceWhatTrianglesFindByThemselves) {
  Random random{std::mt19937(2)};
  expect_the_same(grid(10, 1.0, random), 2000, random);
}

TEST(RayCaster, FindsInAnyTrianglesWhatTheyFindByThemselves) {
  for (int count = 1; count <= 40; ++count) {  // each way in which the last nodes are filled
    Random random{std::mt19937(100 + static_cast<unsigned>(count))};
    expect_the_same(soup(count, random), 100, random);
  }
  for (unsigned seed = 0; seed < 8; ++seed) {
    Random random{std::mt19937(seed)};
    expect_the_same(soup(300, random), 200, random);
  }
}

// Where sorting tells nothing apart, halves are halves all the same.
TEST(RayCaster, OfManyTrianglesInOnePlaceTheFirst) {
  const RayCaster caster(surface({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, std::vector<std::array<int, 3>>(50000, {0, 1, 2})));
  const LineHit hit = caster.nearest_facing({0.25, 0.25, 2}, {0, 0, -1}, 0, 0, kInfinity);
  EXPECT_EQ(hit.point.triangle, 0);
  EXPECT_EQ(hit.distance, 2);
  EXPECT_EQ(caster.closest({0.25, 0.25, 2}).triangle, 0);
  EXPECT_EQ(caster.within({0.25, 0.25, 2}, 2).size(), 50000);
  EXPECT_EQ(caster.within({0.25, 0.25, 2}, 1.9).size(), 0);
}

TEST(RayCaster, ASurfaceOfNoTrianglesIsNowhere) {
  for (const RayCaster& nothing : {RayCaster(SurfaceMesh{}), RayCaster(surface({{1, 2, 3}}, {}))}) {
    EXPECT_EQ(nothing.nearest_facing({0, 0, 0}, {0, 0, 1}, -kInfinity, 0, kInfinity).point.triangle, -1);
    EXPECT_EQ(nothing.closest({0, 0, 0}).triangle, -1);
    EXPECT_TRUE(nothing.within({0, 0, 0}, kInfinity).empty());
  }
}

// A millionth of the surface's size is what 16 digits leave at 1e9 times that distance.
TEST(RayCaster, LinesAndPointsFromFarAway) {
  Random random{std::mt19937(3)};
  const RayCaster plane(grid(8, 0.0, random));
  for (const double far : {1e2, 1e5, 1e9}) {
    const Vector3d from(0.3, 0.2, far);
    const LineHit hit = plane.nearest_facing(from, {0, 0, -1}, 0, 0, kInfinity);
    ASSERT_GE(hit.point.triangle, 0) << far;
    EXPECT_EQ(hit.distance, far);
    EXPECT_LT((position(plane.mesh(), hit.point) - Vector3d(0.3, 0.2, 0)).norm(), 1e-15 * far + 1e-14);
    EXPECT_EQ(plane.nearest_facing({5.3, 0.2, far}, {0, 0, -1}, 0, 0, kInfinity).point.triangle, -1) << far;
    const SurfacePoint corner = plane.closest({far, far, 0});
    EXPECT_LT((position(plane.mesh(), corner) - Vector3d(4, 4, 0)).norm(), 1e-9) << far;
    // how far to the side of the foot a distance is the same to rounding
    const double beside = std::sqrt(2 * far * (1e-11 + 2e-15 * far));
    EXPECT_LT((position(plane.mesh(), plane.closest(from)) - Vector3d(0.3, 0.2, 0)).norm(), beside) << far;
  }
  EXPECT_LT((position(plane.mesh(), plane.closest({-1e100, -1e100, 0})) - Vector3d(-4, -4, 0)).norm(), 1e-9);
}

// Nothing is found where numbers end, and nothing hangs or reads beyond the surface.
TEST(RayCaster, WhatIsNoNumber) {
  Random random{std::mt19937(4)};
  const SurfaceMesh mesh = grid(8, 1.0, random);
  const RayCaster sound(mesh);
  for (const double bad : {kInfinity, -kInfinity, kNaN}) {
    EXPECT_EQ(sound.nearest_facing({0, 0, bad}, {0, 0, -1}, 0, 0, kInfinity).point.triangle, -1);
    EXPECT_EQ(sound.nearest_facing({0, 0, 5}, {bad, bad, bad}, 0, 0, kInfinity).point.triangle, -1);
    const SurfacePoint point = sound.closest({bad, 0, 0});
    EXPECT_TRUE(point.triangle >= 0 && point.triangle < mesh.size());
    EXPECT_TRUE(sound.within({bad, 0, 0}, 1).empty());
    SurfaceMesh damaged = mesh;
    for (std::size_t v = 0; v < damaged.vertices.size(); v += 7) damaged.vertices[v] = {bad, 0, bad};
    const RayCaster caster(damaged);
    caster.nearest_facing({0.3, 0.2, 5}, {0, 0, -1}, -kInfinity, 0, kInfinity);
    caster.closest({0.3, 0.2, 5});
    for (const int t : caster.within({0.3, 0.2, 0.5}, kInfinity)) EXPECT_TRUE(t >= 0 && t < mesh.size());
  }
}

}  // namespace dea::ray_caster_test

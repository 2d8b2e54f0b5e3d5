// Contact area and mean pressure from averages over facets alone, against what is known.
//
// Pressures of which area and mean above any threshold are known, as facets' averages on squares, turned squares,
// uneven quads and triangles, with a few to twenty facets over the radius:
//   paraboloid   p = 1 - r^2, of springs under a sphere: above t it is pi (1 - t) wide, with the mean (1 + t) / 2
//   ellipsoid    p = sqrt(1 - r^2), Hertz: above t it is pi (1 - t^2) wide, with the mean 2 (1 - t^3) / (3 (1 - t^2))
//   flat end     p = (1 - r^2)^2, as of incompressible layers: pi (1 - sqrt(t)), mean (1 - t^1.5) / (3 (1 - sqrt(t)))
//   ring         p = (1 - r) (r - 0.4) / 0.09: its radii are the roots of a quadratic
//   two patches  paraboloids of radius sqrt(0.2) about (+-0.55, 0), one half as high as the other
// A plane that ends at a straight line has both exactly, however it lies; a pressure that ends at the surface's own
// edge has all of the surface; a quarter with planes of symmetry has a quarter. Under a contact of one or two facets
// nobody can know how much of them is pressed: never more than the facets that carry, never less than half of the
// truth.
#include "src/results/within_facets.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "src/base/numbers.h"
#include "src/results/headline.h"

namespace dea::within_facets_test {

constexpr double kPi = std::numbers::pi;

enum class Cut { Squares, Triangles, UnevenQuads, UnevenTriangles };

struct Grid {
  Cut cut = Cut::Squares;
  double h = 0.1, from = -1.2, to = 1.2;  ///< size of the facets; extent in x and y
  double turned = 0.0;                    ///< about z
  double shift_x = 0.0, shift_y = 0.0;    ///< in h
};

ResultSurface surface_of(const Grid& g) {
  const int n = static_cast<int>(std::lround((g.to - g.from) / g.h));
  const bool uneven = g.cut == Cut::UnevenQuads || g.cut == Cut::UnevenTriangles;
  const bool triangles = g.cut == Cut::Triangles || g.cut == Cut::UnevenTriangles;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> off(-0.25, 0.25);
  std::vector<Vector3d> x;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      double a = g.from + (i + g.shift_x) * g.h, b = g.from + (j + g.shift_y) * g.h;
      if (uneven) {
        a += g.h * off(random);
        b += g.h * off(random);
      }
      x.emplace_back(a * std::cos(g.turned) - b * std::sin(g.turned), a * std::sin(g.turned) + b * std::cos(g.turned),
                     0.0);
    }
  std::vector<int> begin = {0}, nodes;
  const auto facet = [&](std::vector<int> corners) {
    nodes.insert(nodes.end(), corners.begin(), corners.end());
    begin.push_back(static_cast<int>(nodes.size()));
  };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i, b = a + 1, c = a + n + 2, d = a + n + 1;
      if (triangles) {
        facet({a, b, c});
        facet({a, c, d});
      } else {
        facet({a, b, c, d});
      }
    }
  return make_result_surface("made up", begin, nodes, x);
}

using Field = std::function<double(double, double)>;

/// Each triangle's mean of 256 places.
std::vector<double> averages(const ResultSurface& s, const Field& p) {
  constexpr int n = 16;
  std::vector<double> out(at(s.facets()), 0.0);
  for (int t = 0; t < s.mesh.size(); ++t) {
    double sum = 0.0;
    const auto add = [&](double a, double b) {
      const Vector3d x = (1 - a - b) * s.mesh.corner(t, 0) + a * s.mesh.corner(t, 1) + b * s.mesh.corner(t, 2);
      sum += p(x[0], x[1]);
    };
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        add((i + 1.0 / 3) / n, (j + 1.0 / 3) / n);
        if (i + j + 2 <= n) add((i + 2.0 / 3) / n, (j + 2.0 / 3) / n);
      }
    const std::size_t f = at(s.mesh.facet[at(t)]);
    out[f] += sum / (n * n) * s.mesh.areas[at(t)] / s.facet_areas[f];
  }
  return out;
}

/// The known pressures. `above`: a twentieth of the load's mean, sum of p^2 over sum of p.
struct Known {
  const char* name;
  Field pressure;
  double above, area, mean;
};

std::vector<Known> known_pressures() {
  const auto outside = [](double x, double y) { return 1 - x * x - y * y; };
  std::vector<Known> all;
  double t = kHeadlineShare * 2 / 3;  // integrals of p^2 and p: pi / 3 and pi / 2
  all.push_back(
      {"paraboloid", [=](double x, double y) { return std::max(0.0, outside(x, y)); }, t, kPi * (1 - t), (1 + t) / 2});
  t = kHeadlineShare * 3 / 4;  // pi / 2 and 2 pi / 3
  all.push_back({"ellipsoid", [=](double x, double y) { return std::sqrt(std::max(0.0, outside(x, y))); }, t,
                 kPi * (1 - t * t), 2 * (1 - t * t * t) / (3 * (1 - t * t))});
  t = kHeadlineShare * 3 / 5;  // pi / 5 and pi / 3
  all.push_back({"flat end", [=](double x, double y) { return std::pow(std::max(0.0, outside(x, y)), 2); }, t,
                 kPi * (1 - std::sqrt(t)), (1 - std::pow(t, 1.5)) / (3 * (1 - std::sqrt(t)))});
  // With u = r - 0.7: p = 1 - u^2 / 0.09, and the odd part of r = 0.7 + u gives nothing. Over |u| < 0.3: integrals of p
  // and p^2 are 0.3 and 0.3 times 4/3 and 16/15.
  t = kHeadlineShare * 4 / 5;
  const double half = 0.3 * std::sqrt(1 - t);
  all.push_back({"ring",
                 [](double x, double y) {
                   const double u = (std::hypot(x, y) - 0.7) / 0.3;
                   return std::max(0.0, 1 - u * u);
                 },
                 t, 2 * kPi * 0.7 * 2 * half, 1 - half * half / (3 * 0.09)});
  // Per radius^2: integrals of p^2 and p are pi / 3 (1 + 1/4) and pi / 2 (1 + 1/2). Above t: 1 - t and 1 - 2 t wide.
  t = kHeadlineShare * (5.0 / 4 / 3) / (3.0 / 2 / 2);
  all.push_back({"two patches",
                 [](double x, double y) {
                   const double a = 1 - (std::pow(x - 0.55, 2) + y * y) / 0.2,
                                b = 1 - (std::pow(x + 0.55, 2) + y * y) / 0.2;
                   return std::max({0.0, a, b / 2});
                 },
                 t, 0.2 * kPi * (2 - 3 * t), ((1 - t * t) / 2 + (0.25 - t * t)) / (2 - 3 * t)});
  return all;
}

/// Mean over places and turns of the mesh.
struct Errors {
  double area = 0.0, mean = 0.0, worst = 0.0;
};
Errors errors_of(const Known& known, Cut cut, int facets_over_radius) {
  constexpr int kPlaces = 5;
  Errors e;
  for (int k = 0; k < kPlaces; ++k) {
    Grid g{cut, 1.0 / facets_over_radius};
    g.from = -1.0 - 4 * g.h;
    g.to = 1.0 + 4 * g.h;
    g.turned = 0.3 * k;
    g.shift_x = 0.37 * k - 0.5;
    g.shift_y = 0.21 * k - 0.5;
    const ResultSurface s = surface_of(g);
    const Headline h = headline(s, averages(s, known.pressure));
    const double area = h.area / known.area - 1, mean = h.mean / known.mean - 1;
    e.area += area / kPlaces;
    e.mean += mean / kPlaces;
    e.worst = std::max({e.worst, std::abs(area), std::abs(mean)});
  }
  return e;
}

TEST(WithinFacets, KnownPressuresConverge) {
  fmt::print("errors of area, mean, and the worst of either [%], by facets over the radius\n");
  for (const Known& known : known_pressures()) {
    for (const auto& [cut, name] :
         std::vector<std::pair<Cut, std::string>>{{Cut::Squares, "squares"},
                                                  {Cut::Triangles, "triangles"},
                                                  {Cut::UnevenQuads, "uneven quads"},
                                                  {Cut::UnevenTriangles, "uneven triangles"}}) {
      std::vector<Errors> errors;
      fmt::print("{:12s}{:17s}", known.name, name);
      for (int n : {3, 5, 10, 20}) {
        errors.push_back(errors_of(known, cut, n));
        fmt::print("  {:2d}: {:+6.2f} {:+6.2f} {:5.2f}", n, 100 * errors.back().area, 100 * errors.back().mean,
                   100 * errors.back().worst);
      }
      fmt::print("\n");
      const bool round = known.name == std::string("paraboloid") || known.name == std::string("flat end");
      const bool steep = known.name == std::string("ellipsoid");
      // The ring and the patches are 0.3 and 0.45 of the radius from middle to edge: compare them so.
      EXPECT_LT(errors[1].worst, round ? 0.03 : steep ? 0.08 : 0.16) << known.name << name;
      EXPECT_LT(errors[2].worst, round ? 0.01 : 0.035) << known.name << name;
      EXPECT_LT(errors[3].worst, steep ? 0.013 : 0.008) << known.name << name;
      // second order where the slope at the edge is finite; of Hertz's it is not: better than first
      EXPECT_GT(std::log2(errors[2].worst / errors[3].worst), steep ? 1.2 : 1.7) << known.name << name;
    }
  }
}

/// Why not nodes: one counts with all of its area where contact ends, and has pressure if one facet around it has.
TEST(WithinFacets, NodesWidenTheContact) {
  const Known known = known_pressures().front();
  fmt::print(
      "area of the paraboloid on squares, by facets over the radius: error of nodes with pressure, of nodes above "
      "the threshold, within facets [%]\n");
  std::vector<double> nodes;
  for (int n : {5, 10, 20}) {
    double all = 0.0, above = 0.0;
    for (int k = 0; k < 5; ++k) {
      const Grid g{Cut::Squares, 1.0 / n, -1.0 - 4.0 / n, 1.0 + 4.0 / n, 0.0, 0.2 * k - 0.5, 0.2 * k - 0.5};
      const ResultSurface s = surface_of(g);
      const std::vector<double> nodal = nodal_average(s, averages(s, known.pressure)), areas = nodal_areas(s);
      all += distribution(nodal, areas, 0.0).area / 5;
      above += distribution(nodal, areas, known.above).area / 5;
    }
    nodes.push_back(above / known.area - 1);
    fmt::print("{:2d}: {:+.1f} {:+.1f} {:+.2f}\n", n, 100 * (all / kPi - 1), 100 * nodes.back(),
               100 * errors_of(known, Cut::Squares, n).area);
    EXPECT_GT(nodes.back(), 5 * errors_of(known, Cut::Squares, n).area);
  }
  EXPECT_NEAR(nodes[1], 0.065, 0.01);
}

/// A ramp of slope 1 that ends at a straight line, in any direction: the part of a facet that is pressed is exact, but
/// where only a corner is, too small to matter. What is left of the error are four sweeps.
TEST(WithinFacets, ARampIsExactHoweverItLies) {
  for (double turned : {0.0, 0.2, 0.5, kPi / 4})
    for (double place : {0.0, 0.03, 0.05, 0.08})
      for (Cut cut : {Cut::Squares, Cut::UnevenTriangles}) {
        const ResultSurface s = surface_of({cut, 0.1, -1.0, 1.0, turned});
        const std::vector<double> p = averages(s, [&](double x, double) { return std::max(0.0, x - place); });
        double exact = 0.0, found = 0.0;  // area of facets in |y| < 0.5: the ramp's edge in the grid's middle
        const std::vector<PressedPart> parts = pressed_parts(s, p, 0.0);
        const std::vector<double> share = averages(s, [&](double x, double) { return x > place ? 1.0 : 0.0; });
        for (int f = 0; f < s.facets(); ++f) {
          if (s.facet_centers[at(f)].norm() > 0.7) continue;
          exact += share[at(f)] * s.facet_areas[at(f)];
          found += parts[at(f)].share * s.facet_areas[at(f)];
          EXPECT_NEAR(parts[at(f)].pressure, p[at(f)], 1e-8 * p[at(f)]);  // keeps its force
        }
        // 1.4 of edge, 0.1 wide facets: a twentieth of a facet, of which 256 places see a sixteenth
        EXPECT_NEAR(found, exact, 1.4 * 0.1 * 0.05) << turned << ' ' << place;
      }
}

TEST(WithinFacets, PressureThatEndsAtTheSurfacesEdgeHasAllOfIt) {
  for (Cut cut : {Cut::Squares, Cut::UnevenQuads, Cut::UnevenTriangles}) {
    const ResultSurface s = surface_of({cut, 0.2, -1.0, 1.0});
    double whole = 0.0;
    for (double a : s.facet_areas) whole += a;
    for (const Field& p : {Field([](double, double) { return 2.0; }), Field([](double x, double) { return 2 + x; })}) {
      const std::vector<double> pressure = averages(s, p);
      const Headline h = headline(s, pressure);
      double force = 0.0;
      for (std::size_t f = 0; f < pressure.size(); ++f) force += pressure[f] * s.facet_areas[f];
      EXPECT_NEAR(h.area, whole, 1e-12 * whole);
      EXPECT_NEAR(h.mean, force / whole, 1e-12);
    }
  }
}

TEST(WithinFacets, AQuarterHasAQuarter) {
  const Known known = known_pressures().front();
  const ResultSurface quarter = surface_of({Cut::Squares, 0.1, 0.0, 1.2}), whole = surface_of({Cut::Squares, 0.1});
  const Headline q = headline(quarter, averages(quarter, known.pressure));
  const Headline w = headline(whole, averages(whole, known.pressure));
  // slopes beside the planes are of the facets on one side: off by the curvature, where the edge meets the planes
  EXPECT_NEAR(4 * q.area / w.area, 1, 2e-3);
  EXPECT_NEAR(q.mean / w.mean, 1, 2e-3);
  EXPECT_NEAR(q.peak, w.peak, 1e-12);
}

TEST(WithinFacets, ContactOfAFewFacetsStaysWithinThem) {
  const Known known = known_pressures().front();
  for (Cut cut : {Cut::Squares, Cut::UnevenQuads, Cut::UnevenTriangles})
    for (double n : {0.7, 1.0, 1.5, 2.0})
      for (double shift : {0.0, 0.2, 0.4, 0.6, 0.8}) {
        Grid g{cut, 1.0 / n};
        g.from = -6 * g.h;
        g.to = 6 * g.h;
        g.shift_x = shift;
        g.shift_y = 0.7 * shift;
        const ResultSurface s = surface_of(g);
        const std::vector<double> p = averages(s, known.pressure);
        const Headline h = headline(s, p);
        double carry = 0.0, most = 0.0;
        for (std::size_t f = 0; f < p.size(); ++f) {
          if (p[f] > 0) carry += s.facet_areas[f];
          most = std::max(most, p[f]);
        }
        EXPECT_LE(h.area, carry * (1 + 1e-12));
        EXPECT_GT(h.area, 0.9 * known.area);
        if (n >= 1) {
          EXPECT_LT(h.area, (n < 2 ? 2.0 : 1.2) * known.area) << n;
        }
        EXPECT_LE(h.mean, most);
        EXPECT_LE(h.mean, h.p99);
        EXPECT_LE(h.p99, h.peak);
      }
  // one facet alone: it is all there is to know
  const ResultSurface s = surface_of({Cut::Squares, 1.0, -2.0, 2.0});
  std::vector<double> p(16, 0.0);
  p[5] = 3.0;
  const Headline h = headline(s, p);
  for (double number : {h.area, h.mean / 3, h.p99 / 3, h.peak / 3}) EXPECT_DOUBLE_EQ(number, 1);
}

/// Pressure 1 that ends within facets of which it presses the share s: they have the average s, the next ones 1. A ramp
/// with these averages presses s + sqrt(s^2 + s) of them, at most all: at s = 1/3 two thirds of a facet too much.
TEST(WithinFacets, ASharpEdgeIsOffByTwoThirdsOfAFacetAtMost) {
  for (double turned : {0.0, 0.3, 0.7})
    for (double half : {0.5, 0.53, 0.55, 0.57}) {
      const ResultSurface s = surface_of({Cut::Squares, 0.1, -1.2, 1.2, turned});
      const Headline h = headline(
          s, averages(s, [&](double x, double y) { return std::abs(x) < half && std::abs(y) < half ? 1.0 : 0.0; }));
      const double exact = 4 * half * half;
      EXPECT_GT(h.area, exact * (1 - 1e-3));
      EXPECT_LT(h.area, 4 * std::pow(half + 0.1 * 2 / 3, 2));
    }
}

/// Noise of finite elements: 30 % on each facet. Area and mean stay; a checkerboard has the area of the facets that
/// carry.
TEST(WithinFacets, NoiseMovesThemLittle) {
  const Known known = known_pressures().front();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> noise(0.7, 1.3);
  for (Cut cut : {Cut::Squares, Cut::UnevenTriangles}) {
    const ResultSurface s = surface_of({cut, 0.1});
    std::vector<double> p = averages(s, known.pressure);
    const Headline calm = headline(s, p);
    for (double& x : p) x *= noise(random);
    const Headline h = headline(s, p);
    EXPECT_NEAR(h.area / calm.area, 1, 0.015);
    EXPECT_NEAR(h.mean / calm.mean, 1, 0.03);
  }
  const ResultSurface s = surface_of({Cut::Squares, 1.0, -5.0, 5.0});
  std::vector<double> board, wild;
  std::exponential_distribution<double> steep(1.0);
  for (int f = 0; f < 100; ++f) {
    board.push_back((f % 10 + f / 10) % 2 == 0 ? 6.0 : 0.0);
    wild.push_back(f % 3 == 0 ? 0.0 : std::pow(steep(random), 6));
  }
  const Headline h = headline(s, board);
  EXPECT_NEAR(h.area, 50, 1e-9);
  EXPECT_NEAR(h.mean, 6, 1e-9);
  const std::vector<PressedPart> parts = pressed_parts(s, wild, 0.1);
  for (std::size_t f = 0; f < wild.size(); ++f) {
    EXPECT_GE(parts[f].share, 0);
    EXPECT_LE(parts[f].share, wild[f] > 0 ? 1.0 : 0.0);
    EXPECT_GE(parts[f].pressure, 0.1 * parts[f].share * (1 - 1e-9));
    EXPECT_LE(parts[f].pressure, wild[f] * (1 + 1e-6));
  }
}

/// Pressures c times as high, lengths in m, the surface elsewhere and turned: the same map.
TEST(WithinFacets, UnitsAndPlacesChangeNothing) {
  const ResultSurface s = surface_of({Cut::UnevenQuads, 0.2});
  const std::vector<double> p = averages(s, known_pressures()[3].pressure);
  const Headline h = headline(s, p);
  std::vector<double> scaled = p;
  for (double& x : scaled) x *= 1e6;
  std::vector<Vector3d> moved;
  const Eigen::Matrix3d turn = (Eigen::AngleAxisd(1.1, Vector3d(1, 2, 3).normalized())).toRotationMatrix();
  for (const Vector3d& x : s.slot_position) moved.push_back(1e-3 * (turn * x + Vector3d(5, -7, 11)));
  std::vector<int> nodes;  // one per place
  std::vector<Vector3d> places(s.mesh.vertices.size());
  for (std::size_t k = 0; k < s.slot_vertex.size(); ++k) {
    nodes.push_back(s.slot_vertex[k]);
    places[at(s.slot_vertex[k])] = moved[k];
  }
  const Headline other = headline(make_result_surface("moved", s.begin, nodes, places), scaled);
  EXPECT_NEAR(other.area, 1e-6 * h.area, 1e-14 * h.area);
  for (double Headline::*number : {&Headline::above, &Headline::mean, &Headline::p99, &Headline::peak})
    EXPECT_NEAR(other.*number, 1e6 * (h.*number), 1e-2 * (h.*number));
}

/// Parts of a surface add up to it.
TEST(WithinFacets, PartsAddUp) {
  const ResultSurface s = surface_of({Cut::UnevenTriangles, 0.1});
  const std::vector<double> p = averages(s, known_pressures()[4].pressure);
  FacetMask left, right;
  for (const Vector3d& x : s.facet_centers) {
    left.push_back(x[0] < 0.3);
    right.push_back(!left.back());
  }
  const Headline h = headline(s, p), a = headline(s, p, left), b = headline(s, p, right);
  EXPECT_NEAR(a.area + b.area, h.area, 1e-12);
  EXPECT_NEAR(a.area * a.mean + b.area * b.mean, h.area * h.mean, 1e-12);
}

}  // namespace dea::within_facets_test

#include "src/springs/layer_operator.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <utility>

#include "tests/analytic/linear_systems.h"
#include "tests/src/layer_meshes.h"

namespace dea::layer_operator_test {

using Eigen::VectorXd;
using namespace test;

const Elasticity kCartilage{11.85, 0.45};

/// A curved patch with nothing special about it.
SurfaceMesh saddle(int n) {
  return test::grid(n, n + 3, [](double u, double v) {
    const double x = 14 * (u + 0.1 * v * v), y = 11 * (v - 0.15 * u);
    return Vector3d(x, y, 0.03 * x * x - 0.02 * x * y);
  });
}

double wavy_thickness(const Vector3d& x) { return 2 + 0.9 * std::sin(0.5 * x.x()) * std::cos(0.4 * x.y()); }

// p = cos(kx) between mirrors at x = 0 and pi/k is a periodic wave: w = law(kt) t p. The error must fall fourfold when
// the mesh is halved, down to waves of s = 3.
TEST(LayerOperator, FlatLayerHasTheSymbolOfTheLawToSecondOrder) {
  const double t = 2.0;
  for (LayerFit fit : kFits) {
    const LayerLaw law = layer_law(kCartilage, fit);
    for (double s : {0.5, 1.0, 3.0}) {
      const double k = s / t, length = kPi / k;
      const auto error = [&](int n) {
        const SurfaceMesh surface = test::rectangle(n, 4, length, 4 * length / n);
        FootedLayer layer(layer_mesh(surface, even(t), all(Rim::Wall)), kCartilage, fit);
        const VectorXd p = at_feet(surface, [&](const Vector3d& x) { return std::cos(k * x.x()); });
        return (layer.sinking(p) - law(s) * t * p).lpNorm<Eigen::Infinity>() / (law(s) * t);
      };
      EXPECT_GT(std::log2(error(24) / error(48)), 1.9) << name(fit) << " s = " << s;
      EXPECT_LT(error(48), 0.01) << name(fit) << " s = " << s;
    }
  }
}

/// Work of the feet's pressures, symmetric but for rounding, scaled by their local compliances.
Eigen::MatrixXd scaled_work(const LayerOperator& layer, const LayerFeet& feet, const VectorXd* softening = nullptr) {
  const int n = feet.size();
  VectorXd scale(n);
  for (int i = 0; i < n; ++i)
    scale[i] = 1 / std::sqrt(feet.area[static_cast<std::size_t>(i)] * layer.law.local * feet.thickness(i));
  const Eigen::MatrixXd work = Eigen::Map<const VectorXd>(feet.area.data(), n).asDiagonal() *
                               sinking(layer, feet, Eigen::MatrixXd::Identity(n, n), softening);
  return scale.asDiagonal() * work * scale.asDiagonal();
}

double asymmetry(const Eigen::MatrixXd& work) { return (work - work.transpose()).norm() / work.norm(); }

double least_eigenvalue(const Eigen::MatrixXd& work) {
  return analytic::eigenvalues(0.5 * (work + work.transpose()))[0];
}

// Any thickness, any rim, whole and partly covered feet, one or four feet per triangle: work is symmetric, and positive
// also for the pressures that resist least (checkerboards) and most (even ones).
TEST(LayerOperator, WorkIsSymmetricAndPositive) {
  const SurfaceMesh surface = saddle(5);
  for (const int divide : {1, 2}) {
    for (Rim rim : {Rim::Free, Rim::Wall, Rim::Continues}) {
      const auto mesh = layer_mesh(surface, wavy_thickness, all(rim), -1, divide);
      for (double nu : {0.1, 0.45, 0.4999}) {
        for (LayerFit fit : kFits) {
          FootedLayer whole(mesh, {11.85, nu}, fit);
          const LayerOperator& layer = whole.layer;
          const int n = whole.feet.size();
          const LayerFeet feet =
              test::covered(whole.feet, (VectorXd::Random(n).array() * 0.5 + 0.5).max(0.01).matrix());
          const Eigen::MatrixXd work = scaled_work(layer, feet);
          EXPECT_LT(asymmetry(work), 1e-12);
          // the least eigenvalue is at least that of the law
          double least = 1;
          for (double s = 0; s < 100; s += 0.05) least = std::min(least, layer.law(s) / layer.law.local);
          EXPECT_GT(least_eigenvalue(work), least * (1 - 1e-6))
              << "nu " << nu << " " << name(fit) << " rim " << static_cast<int>(rim) << " " << divide;
          if (fit == LayerFit::OneTerm) continue;
          // about large strains: each foot's softening is anything up to 1/M
          const VectorXd softening = (VectorXd::Random(n).array() * 0.5 + 0.5).matrix() * layer.law.confined * 0.9999;
          const Eigen::MatrixXd strained = scaled_work(layer, feet, &softening);
          EXPECT_LT(asymmetry(strained), 1e-12);
          EXPECT_GT(least_eigenvalue(strained), 0) << "nu " << nu << " rim " << static_cast<int>(rim);
        }
      }
    }
  }
}

// Edges that turn both ways, so that some of their vertices are held and others are not (L7): a hole of 0.75 t in a
// square with sharp corners, and a strip whose edges zigzag. Nothing is asked for but what a solver needs.
TEST(LayerOperator, AnyFreeEdgeLeavesItPositive) {
  const auto with_hole = [](double u, double v) {
    const double a = 0.5 * kPi * v, far = 8 / std::max(std::cos(a), std::sin(a));
    return Vector3d((1.5 + (far - 1.5) * u) * std::cos(a), (1.5 + (far - 1.5) * u) * std::sin(a), 0);
  };
  const auto zigzag = [](double u, double v) {
    return Vector3d(9 * u, (v - 0.5) * (5 + 1.2 * (static_cast<int>(std::lround(9 * u)) % 2)), 0);
  };
  for (const bool hole : {true, false}) {
    const SurfaceMesh surface = hole ? test::grid(9, 10, with_hole) : test::grid(9, 6, zigzag);
    const auto mesh = layer_mesh(surface, even(2), [=](const Vector3d& x) {
      return hole && std::min(x.x(), x.y()) < 1e-9 ? Rim::Wall : Rim::Free;
    });
    double least_bend = 0, most_bend = 0;
    for (const double bend : mesh.edge_curvature) {
      least_bend = std::min(least_bend, 2 * bend);
      most_bend = std::max(most_bend, 2 * bend);
    }
    if (hole) {
      EXPECT_LT(least_bend, -0.8);  // -1.33 but for the few triangles
      EXPECT_GT(most_bend, 0.3);
    }
    for (const double nu : {0.0, 0.2, 0.3, 0.45, 0.4999})
      for (LayerFit fit : kFits) {
        FootedLayer layer(mesh, {11.85, nu}, fit);
        const Eigen::MatrixXd work = scaled_work(layer.layer, layer.feet);
        EXPECT_LT(asymmetry(work), 1e-12) << hole << " nu " << nu << " " << name(fit);
        EXPECT_GT(least_eigenvalue(work), 0.05) << hole << " nu " << nu << " " << name(fit);
        if (fit == LayerFit::OneTerm) continue;
        const VectorXd softening = VectorXd::Constant(surface.size(), 0.9999 * layer.layer.law.confined);
        EXPECT_GT(least_eigenvalue(scaled_work(layer.layer, layer.feet, &softening)), 0) << hole << " nu " << nu;
      }
  }
}

// Between walls the volume pressed in is that of the bed of springs, sum of A t p / M, whatever the thickness does:
// bulging moves volume and makes none. With a free rim some of it escapes, so more is pressed in.
TEST(LayerOperator, VolumeIsConservedBetweenWalls) {
  const SurfaceMesh surface = saddle(15);
  for (const int divide : {1, 2}) {
    for (LayerFit fit : kFits) {
      for (double nu : {0.3, 0.45, 0.4999}) {
        const auto layer_between = [&](Rim rim) {
          return FootedLayer(layer_mesh(surface, wavy_thickness, all(rim), -1, divide), {11.85, nu}, fit);
        };
        FootedLayer walled = layer_between(Rim::Wall), free = layer_between(Rim::Free),
                    open = layer_between(Rim::Continues);
        const VectorXd A = walled.areas();
        VectorXd p(A.size());
        for (int i = 0; i < p.size(); ++i) p[i] = std::max(0.0, std::sin(0.1 * i * divide * divide));
        const double springs = walled.volumes().dot(p) * walled.layer.law.confined;
        const double scale = walled.volumes().dot(p) * walled.layer.law.local;  // what is moved about
        EXPECT_NEAR(A.dot(walled.sinking(p)) / scale, springs / scale, 1e-11) << nu;
        // what is pressed in beyond the rim, as the second term has it, is not counted
        if (fit == LayerFit::OneTerm) {
          EXPECT_GT(A.dot(open.sinking(p)), springs) << nu;
        }
        EXPECT_GT(A.dot(free.sinking(p)), A.dot(open.sinking(p))) << nu;
      }
    }
  }
}

// A wave of pressure over a wedge-shaped layer: the solution for four feet per triangle and for one approach each
// other with the square of the facets' size.
TEST(LayerOperator, FeetMayDivideTriangles) {
  const auto difference = [&](int n) {
    const SurfaceMesh surface = test::rectangle(2 * n, n, 12, 6);
    double volume[2];
    for (const int divide : {1, 2}) {
      FootedLayer layer(layer_mesh(
                            surface, [](const Vector3d& x) { return 1 + x.x() / 8; }, all(Rim::Free), -1, divide),
                        kCartilage, LayerFit::OneTerm);
      const VectorXd p = at_feet(layer.surface(), [](const Vector3d& x) { return std::sin(kPi / 12 * x.x()); });
      volume[divide - 1] = (layer.areas().array() * p.array() * layer.sinking(p).array()).sum();
    }
    return std::abs(volume[0] / volume[1] - 1);
  };
  EXPECT_NEAR(std::log2(difference(12) / difference(24)), 2, 0.25);
}

// An even load on a strip with a free end: one term has the closed form q = p (1 - cosh(x/l)/cosh(L/l)), l = t
// sqrt(beta). An end beyond which the layer continues has q = p (1 - exp(-L/l) cosh(x/l)).
TEST(LayerOperator, EndsOfAStrip) {
  const double length = 9, t = 2;
  const LayerLaw law = layer_law(kCartilage, LayerFit::OneTerm);
  const double l = t * std::sqrt(law.beta[0]);
  const auto error = [&](Rim end, int n) {
    const SurfaceMesh surface = test::rectangle(n, 2, length, 2 * length / n);
    FootedLayer layer(
        layer_mesh(surface, even(t), [&](const Vector3d& x) { return x.x() > 0.9999 * length ? end : Rim::Wall; }),
        kCartilage, LayerFit::OneTerm);
    const VectorXd exact = at_feet(surface, [&](const Vector3d& x) {
      const double c = std::cosh(x.x() / l);
      const double q =
          end == Rim::Wall ? 1 : 1 - c * (end == Rim::Free ? 1 / std::cosh(length / l) : std::exp(-length / l));
      return t * (law.local + law.weight[0] * q);
    });
    return (layer.sinking(VectorXd::Ones(surface.size())) - exact).lpNorm<Eigen::Infinity>() / (t * law.local);
  };
  EXPECT_LT(error(Rim::Wall, 20), 1e-12);
  for (Rim end : {Rim::Free, Rim::Continues}) {
    EXPECT_LT(error(end, 90), 2e-3);
    EXPECT_NEAR(std::log2(error(end, 30) / error(end, 60)), 2, 0.25) << static_cast<int>(end);
  }
}

// Where there is no layer nothing sinks, and its border is an edge.
TEST(LayerOperator, PlacesWithoutLayer) {
  const SurfaceMesh surface = saddle(16);
  const VectorXd p = VectorXd::Ones(surface.size());
  for (LayerFit fit : kFits) {
    FootedLayer layer(
        layer_mesh(
            surface, [](const Vector3d& x) { return x.x() < 6 ? 0.0 : wavy_thickness(x); }, all(Rim::Continues)),
        kCartilage, fit);
    const VectorXd w = layer.sinking(p);
    int bare = 0;
    for (int i = 0; i < p.size(); ++i) {
      const bool none = layer.feet.volume[static_cast<std::size_t>(i)] == 0;
      bare += none;
      EXPECT_TRUE(none ? w[i] == 0 : w[i] > 0) << i;
    }
    EXPECT_GT(bare, surface.size() / 4);
    EXPECT_LT(bare, surface.size() / 2);
    FootedLayer nowhere(layer_mesh(surface, even(0), all(Rim::Continues)), kCartilage, fit);
    EXPECT_EQ(nowhere.sinking(p).lpNorm<Eigen::Infinity>(), 0);
  }
}

// A layer that runs out to nothing: whether its measured thickness there is zero or a rounding error is all the same.
TEST(LayerOperator, WhereALayerRunsOutRoundingDoesNotMatter) {
  const SurfaceMesh mesh = rectangle(12, 12, 12, 12);
  const auto sinks = [&](double least) {
    const auto thickness = [&](const Vector3d& x) { return std::max(least, std::min(2.0, 0.5 * x.x())); };
    FootedLayer layer(layer_mesh(mesh, thickness, all(Rim::Free)), kCartilage, LayerFit::TwoTerms);
    return layer.sinking(VectorXd::Ones(mesh.size()));
  };
  const VectorXd zero = sinks(0.0);
  for (const double rounding : {1e-18, 1e-16, 1e-13})
    EXPECT_LT((sinks(rounding) - zero).norm() / zero.norm(), 1e-9) << rounding;
}

// As nu -> 0.5 the operator tends to that of nu = 0.5.
TEST(LayerOperator, NearlyIncompressible) {
  const SurfaceMesh surface = saddle(8);
  const auto mesh = layer_mesh(surface, wavy_thickness, all(Rim::Free));
  const VectorXd p = at_feet(surface, [](const Vector3d& x) { return 1 + std::sin(x.x()); });
  for (LayerFit fit : kFits) {
    VectorXd w[2];
    int k = 0;
    for (double nu : {0.5, 0.5 - 1e-8}) {
      FootedLayer layer(mesh, {11.85, nu}, fit);
      w[k++] = layer.sinking(p);
    }
    EXPECT_LT((w[0] - w[1]).norm() / w[0].norm(), 1e-6);
  }
}

// A strip cut off at the end of its load, where the layer goes on, is the long strip with nothing on the rest of it.
TEST(LayerOperator, BeyondTheRimTheLayerGoesOn) {
  const double t = 2.0, length = 8.0;
  const int m = 160;
  for (const LayerFit fit : {LayerFit::OneTerm, LayerFit::TwoTerms})
    for (const double nu : {0.3, 0.45, 0.4999}) {
      const auto sinking = [&](int times, Rim end) {
        const double whole = times * length;
        const SurfaceMesh surface = test::rectangle(times * m, 2, whole, 2 * length / m);
        FootedLayer layer(
            layer_mesh(surface, even(t), [&](const Vector3d& x) { return x.x() > 0.9999 * whole ? end : Rim::Wall; }),
            {10, nu}, fit);
        std::vector<std::pair<double, double>> w;
        const Eigen::VectorXd load =
            test::at_feet(surface, [&](const Vector3d& x) { return x.x() < length ? 1.0 : 0.0; });
        const Eigen::VectorXd sunk = layer.sinking(load);
        for (int i = 0; i < surface.size(); ++i)
          if (load[i] > 0) w.emplace_back(surface.centroid(i).x(), sunk[i]);
        std::sort(w.begin(), w.end());
        return w;
      };
      const auto cut = sinking(1, Rim::Continues), whole = sinking(4, Rim::Wall), walled = sinking(1, Rim::Wall);
      ASSERT_EQ(cut.size(), whole.size());
      double worst = 0, largest = 0, wall = 0;
      for (std::size_t i = 0; i < cut.size(); ++i) {
        worst = std::max(worst, std::abs(cut[i].second - whole[i].second));
        wall = std::max(wall, std::abs(walled[i].second - whole[i].second));
        largest = std::max(largest, std::abs(whole[i].second));
      }
      EXPECT_LT(worst, 0.01 * largest) << name(fit) << " nu " << nu;
      EXPECT_GT(wall, 5 * worst) << name(fit) << " nu " << nu;
    }
}

// The same for the middle of a plate under a load that fades out: with all the rest of the layer there, but no foot on
// it; with some of it, which then goes on; and cut off at once where it goes on. The condition knows the flow across an
// edge only, not that it also spreads along it: with the load up to the cut it is up to 2.6% off the greater the
// further the layer flows, one thickness beyond it no more than 1%.
TEST(LayerOperator, TheRestOfTheFaceIsThere) {
  const double t = 2.0, half = 4.0;
  const auto inside = [&](const Vector3d& x) { return std::max(std::abs(x.x()), std::abs(x.y())) < half; };
  const auto load = [&](const Vector3d& x) {
    return std::cos(0.5 * kPi * x.x() / half) * std::cos(0.5 * kPi * x.y() / half);
  };
  const auto square = [](int n, double size) {
    return test::grid(n, n, [=](double u, double v) { return Vector3d(size * (u - 0.5), size * (v - 0.5), 0); });
  };
  int pressed = 0;
  const SurfaceMesh small = square(32, 2 * half), larger = test::sorted(square(48, 3 * half), inside, pressed),
                    largest = test::sorted(square(128, 8 * half), inside, pressed);
  ASSERT_EQ(pressed, small.size());
  for (const LayerFit fit : kFits)
    for (const auto& [nu, cut_off] : {std::pair(0.3, 0.01), std::pair(0.45, 0.015), std::pair(0.4999, 0.03)}) {
      const VectorXd p = at_feet(small, load);
      const auto sinking = [&, nu = nu](const SurfaceMesh& mesh, Rim rim) {
        FootedLayer layer(layer_mesh(mesh, even(t), all(rim), pressed), {10, nu}, fit);
        EXPECT_EQ(layer.feet.size(), pressed);
        return layer.sinking(p);
      };
      const VectorXd exact = sinking(largest, Rim::Wall);
      const auto error = [&](const VectorXd& w) {
        return (w - exact).lpNorm<Eigen::Infinity>() / exact.lpNorm<Eigen::Infinity>();
      };
      EXPECT_LT(error(sinking(larger, Rim::Continues)), 0.01) << name(fit) << " nu " << nu;
      const double cut = error(sinking(small, Rim::Continues));
      EXPECT_LT(cut, cut_off) << name(fit) << " nu " << nu;
      EXPECT_GT(error(sinking(small, Rim::Wall)), 2 * cut) << name(fit) << " nu " << nu;
    }
}

// Half a disc with a wall along its diameter is the whole disc, with its round edge free or going on: to rounding.
TEST(LayerOperator, AWallIsThePlaneOfSymmetry) {
  const double radius = 5;
  const SurfaceMesh half = test::grid(9, 18, [=](double u, double v) -> Vector3d {  // the square onto the disc
    const double a = u, b = 2 * v - 1, far = std::max(std::abs(a), std::abs(b));
    if (far < 1e-14) return {0, 0, 0};
    return radius * far / std::hypot(a, b) * Vector3d(a, b, 0);
  });
  const SurfaceMesh whole = test::with_mirror_image(half);
  ASSERT_EQ(whole.size(), 2 * half.size());
  const auto load = [](const Vector3d& x) { return 1 + 0.3 * x.y() - 0.04 * x.x() * x.x(); };
  const auto thickness = [](const Vector3d& x) { return 2 + 0.2 * x.y() + 0.02 * x.x() * x.x(); };
  for (const Rim round : {Rim::Free, Rim::Continues})
    for (const LayerFit fit : kFits) {
      FootedLayer all_of_it(layer_mesh(whole, thickness, all(round)), kCartilage, fit),
          half_of_it(layer_mesh(half, thickness, [=](const Vector3d&x) { return x.x() < 1e-9 ? Rim::Wall : round; }),
                     kCartilage, fit);
      const VectorXd w = half_of_it.sinking(at_feet(half, load)), both = all_of_it.sinking(at_feet(whole, load));
      EXPECT_LT((both.head(w.size()) - w).norm() / w.norm(), 1e-10) << static_cast<int>(round) << " " << name(fit);
    }
}

// At small strain (L9) is (L3): the difference falls like the pressure.
TEST(LayerOperator, LargeStrainStartsLinearly) {
  const SurfaceMesh surface = saddle(8);
  const auto mesh = layer_mesh(surface, wavy_thickness, all(Rim::Free));
  const VectorXd shape = at_feet(surface, [](const Vector3d& x) { return 1 + std::sin(x.x()); });
  for (LayerFit fit : kFits)
    for (double nu : {0.1, 0.45, 0.499}) {
      FootedLayer layer(mesh, {11.85, nu}, fit);
      const auto difference = [&](double strain) {
        VectorXd softening;
        const VectorXd p = strain / layer.layer.law.confined * shape;
        const VectorXd linear = layer.sinking(p);
        return (large_sinking(layer.layer, layer.feet, p, softening) - linear).norm() / p.norm() *
               layer.layer.law.confined;
      };
      EXPECT_NEAR(std::log2(difference(2e-4) / difference(1e-4)), 1, 1e-3) << name(fit) << " nu " << nu;
    }
}

// The softenings are those of the state: against central differences.
TEST(LayerOperator, SofteningIsTheDerivative) {
  const SurfaceMesh surface = saddle(6);
  const auto mesh = layer_mesh(surface, wavy_thickness, all(Rim::Free));
  const VectorXd shape = at_feet(surface, [](const Vector3d&x) { return 1 + std::sin(x.x()); }),
                 step = at_feet(surface, [](const Vector3d&x) { return std::cos(0.7 * x.y()); });
  for (LayerFit fit : kFits)
    for (double nu : {0.1, 0.45, 0.499}) {
      FootedLayer layer(mesh, {11.85, nu}, fit);
      const double pressure = 0.3 / layer.layer.law.confined, d = 1e-4 * pressure;
      VectorXd softening, ignored;
      const VectorXd w = large_sinking(layer.layer, layer.feet, pressure * shape, softening);
      const VectorXd numeric = (large_sinking(layer.layer, layer.feet, pressure * shape + d * step, ignored) -
                                large_sinking(layer.layer, layer.feet, pressure * shape - d * step, ignored)) /
                               (2 * d);
      const VectorXd tangent = sinking(layer.layer, layer.feet, step, &softening).col(0);
      EXPECT_LT((tangent - numeric).norm(), 1e-6 * numeric.norm()) << name(fit) << " nu " << nu;
      EXPECT_GT((layer.sinking(step) - numeric).norm(), 1e-3 * numeric.norm()) << "softening makes no difference";
      EXPECT_GE(softening.minCoeff(), 0);
    }
}

// A foot over a grid of unit squares that look down, each cut in two: the areas on each square, and the integrals of t
// and t x for t = 1 + x, are known. x + y <= 2, x, y >= 1/2.
TEST(FootParts, OnPaper) {
  const SurfaceMesh grid = test::grid(3, 3, [](double u, double v) { return Vector3d(3 * v, 3 * u, 0); });
  const std::array<Vector3d, 3> foot = {Vector3d(0.5, 0.5, 1), Vector3d(1.5, 0.5, 1), Vector3d(0.5, 1.5, 1)};
  int first = -1;
  for (int t = 0; t < grid.size(); ++t)
    if (std::max(grid.centroid(t).x(), grid.centroid(t).y()) < 1) first = t;
  ASSERT_GE(first, 0);
  const std::vector<SurfacePart> parts = parts_under_foot(foot, 0.5, Vector3d::UnitZ(), grid, first, grid.size());
  double on_square[3][3] = {}, sum = 0;
  for (const SurfacePart& part : parts) {
    const Vector3d x = grid.centroid(part.triangle);
    on_square[static_cast<int>(x.x())][static_cast<int>(x.y())] += part.area;
    sum += part.area;
  }
  EXPECT_NEAR(sum, 0.5, 1e-14);
  EXPECT_NEAR(on_square[0][0], 0.25, 1e-14);
  EXPECT_NEAR(on_square[1][0], 0.125, 1e-14);
  EXPECT_NEAR(on_square[0][1], 0.125, 1e-14);

  LayerMesh mesh = make_layer_mesh(test::layer_face(grid, even(1), all(Rim::Wall)));
  for (std::size_t v = 0; v < mesh.thickness.size(); ++v) mesh.thickness[v] = 1 + mesh.mesh.vertices[v].x();
  mesh.edge_distance.assign(mesh.thickness.size(), 1e9);  // the reach was that of another thickness
  const LayerOperator layer = make_layer_operator(mesh, kCartilage, LayerFit::TwoTerms);
  LayerFeet feet;
  add_foot(feet, layer, parts, 0.5);
  add_foot(feet, layer, parts, 0.25);  // half of it covered
  add_foot(feet, layer, {}, 0.0);
  EXPECT_NEAR(feet.volume[0], 11.0 / 12, 1e-14);
  EXPECT_NEAR(feet.thickness(0), 11.0 / 6, 1e-14);
  EXPECT_NEAR(feet.own[0], layer.law.local * 11.0 / 6, 1e-14);
  double total = 0, moment = 0;
  for (int k = 0; k < feet.begin[1]; ++k) {
    const auto i = static_cast<std::size_t>(k);
    total += feet.weight[i];
    moment += feet.weight[i] * mesh.mesh.vertices[static_cast<std::size_t>(feet.node[i])].x();
  }
  EXPECT_NEAR(total, 11.0 / 12, 1e-14);
  EXPECT_NEAR(moment, 5.0 / 12 + 3.0 / 8, 1e-14);
  EXPECT_NEAR(feet.volume[1], 11.0 / 24, 1e-14);
  EXPECT_EQ(feet.area[2], 0);
  EXPECT_EQ(feet.own[2], 0);
  // nothing of it on triangles that are no part of the contact, nor on those that look away
  for (const SurfacePart& part : parts_under_foot(foot, 0.5, Vector3d::UnitZ(), grid, first, first + 1))
    EXPECT_LE(part.triangle, first);
  EXPECT_TRUE(parts_under_foot({foot[0], foot[2], foot[1]}, 0.5, -Vector3d::UnitZ(), grid, first, grid.size()).empty());
}

// Feet on meshes finer and coarser than they are, turned: no part of a foot is lost, work is symmetric, whatever is
// pressed sinks, and an even pressure sinks an unbounded layer evenly.
TEST(FootParts, OnTurnedMeshes) {
  const double t = 1.0, h = 0.5;
  const SurfaceMesh few = test::grid(
                        8, 8, [=](double u, double v) -> Vector3d { return 8 * h * Vector3d(u - 0.5, v - 0.5, 0); }),
                    many = test::grid(
                        56, 56, [=](double u, double v) -> Vector3d { return 56 * h * Vector3d(u - 0.5, v - 0.5, 0); });
  for (const double ratio : {0.3, 0.5, 1.0, 2.0}) {
    test::Underside below{static_cast<int>(60 / ratio), 60 * h, 0.4, {0.1, -0.07, 0}};
    const auto mesh = layer_mesh(below.mesh(), even(t), all(Rim::Continues));
    for (const double nu : {0.3, 0.4999}) {
      const LayerOperator layer = make_layer_operator(mesh, {11.85, nu}, LayerFit::TwoTerms);
      const LayerFeet feet = test::feet_on_underside(few, below, layer);
      ASSERT_EQ(feet.size(), few.size());
      for (int i = 0; i < feet.size(); ++i) {
        const auto k = static_cast<std::size_t>(i);
        double area = 0;
        for (const SurfacePart& part :
             parts_under_foot({few.corner(i, 0), few.corner(i, 1), few.corner(i, 2)}, few.areas[k], Vector3d::UnitZ(),
                              layer.mesh.mesh, below.triangle(layer.mesh.mesh, few.centroid(i)), layer.mesh.pressed))
          area += part.area;
        EXPECT_NEAR(area, few.areas[k], 1e-12 * few.areas[k]);
        EXPECT_NEAR(feet.volume[k], few.areas[k] * t, 1e-12);
      }
      const Eigen::MatrixXd work = scaled_work(layer, feet);
      EXPECT_LT(asymmetry(work), 1e-11) << ratio;
      EXPECT_GT(least_eigenvalue(work), 0.1) << ratio;
      // far from the rim of what is pressed
      const LayerFeet wide = test::feet_on_underside(many, below, layer);
      const VectorXd w = sinking(layer, wide, VectorXd::Ones(wide.size())).col(0);
      double least = 1e300, most = -1e300;
      for (int i = 0; i < many.size(); ++i)
        if (many.centroid(i).norm() < 1) {
          least = std::min(least, w[i]);
          most = std::max(most, w[i]);
        }
      EXPECT_LT(most - least, 0.005 * layer.law.local * t) << ratio << " nu " << nu;
      EXPECT_NEAR(least, layer.law.confined * t, 0.01 * layer.law.local * t) << ratio << " nu " << nu;
    }
  }
}

// The feet move over the target's triangles: what the layer does is a continuous function of the place, also where
// their edges meet. A jump would be as large as for a thousandth of a foot.
TEST(FootParts, ContinuousInThePose) {
  const SurfaceMesh feet =
      test::grid(6, 6, [](double u, double v) -> Vector3d { return 3 * Vector3d(u - 0.5, v - 0.5, 0); });
  for (const double angle : {0.0, 0.3}) {
    const test::Underside below{24, 9.6, angle, Vector3d::Zero()};
    const LayerOperator layer =
        make_layer_operator(layer_mesh(below.mesh(), even(1), all(Rim::Continues)), kCartilage, LayerFit::TwoTerms);
    const VectorXd p = at_feet(feet, [](const Vector3d& x) { return std::max(0.0, 1 - x.squaredNorm()); });
    const auto sinking = [&](double shift) {
      SurfaceMesh moved = feet;
      for (Vector3d& x : moved.vertices) x += Vector3d(shift, 0.3 * shift, 0);
      return VectorXd(dea::sinking(layer, test::feet_on_underside(moved, below, layer), p).col(0));
    };
    for (const double shift : {0.0, 0.1, 0.2, 0.4, 0.7}) {
      const VectorXd w = sinking(shift);
      EXPECT_LT((sinking(shift + 1e-6) - w).lpNorm<Eigen::Infinity>(), 1e-5 * w.lpNorm<Eigen::Infinity>()) << shift;
      EXPECT_LT((sinking(shift - 1e-6) - w).lpNorm<Eigen::Infinity>(), 1e-5 * w.lpNorm<Eigen::Infinity>()) << shift;
      EXPECT_GT((sinking(shift + 1e-2) - w).lpNorm<Eigen::Infinity>(), 0) << "nothing moves";
    }
  }
}

}  // namespace dea::layer_operator_test

#include "layer_operator.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "src/layer_meshes.h"

namespace dea {
namespace {

using Eigen::VectorXd;
using test::at_feet;
using test::to_vector;

const double kPi = std::acos(-1.0);
const Elasticity kCartilage{11.85, 0.45};
const LayerFit kFits[] = {LayerFit::OneTerm, LayerFit::TwoTerms};

VectorXd areas(const LayerMesh& mesh) { return Eigen::Map<const VectorXd>(mesh.area.data(), mesh.feet()); }

/// A curved patch with nothing special about it.
SurfaceMesh saddle(int n) {
  return test::grid(n, n + 3, [](double u, double v) {
    const double x = 14 * (u + 0.1 * v * v), y = 11 * (v - 0.15 * u);
    return Vector3d(x, y, 0.03 * x * x - 0.02 * x * y);
  });
}

VectorXd wavy_thickness(const SurfaceMesh& surface, int feet_per_triangle = 1) {
  VectorXd t(surface.size() * feet_per_triangle);
  for (Eigen::Index i = 0; i < t.size(); ++i) {
    const Vector3d x = surface.centroid(static_cast<int>(i) / feet_per_triangle);
    t[i] = 2 + 0.9 * std::sin(0.5 * x.x()) * std::cos(0.4 * x.y()) + 0.1 * static_cast<double>(i % 3);
  }
  return t;
}

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
        const auto mesh = std::make_shared<LayerMesh>(make_layer_mesh(surface));
        LayerOperator layer(mesh, law, std::vector<Rim>(mesh->rim.size(), Rim::Wall));
        layer.set_thickness(std::vector<double>(mesh->area.size(), t));
        const VectorXd p = at_feet(surface, [&](const Vector3d& x) { return std::cos(k * x.x()); });
        return (layer.sinking(p) - law(s) * t * p).lpNorm<Eigen::Infinity>() / (law(s) * t);
      };
      EXPECT_GT(std::log2(error(24) / error(48)), 1.9) << name(fit) << " s = " << s;
      EXPECT_LT(error(48), 0.01) << name(fit) << " s = " << s;
    }
  }
}

// Any thickness, any rim, whole and partly covered feet, one or four feet per triangle: work is symmetric, and positive
// also for the pressures that resist least (checkerboards) and most (even ones).
TEST(LayerOperator, WorkIsSymmetricAndPositive) {
  const SurfaceMesh surface = saddle(5);
  for (const int per_triangle : {1, 4}) {
    const auto mesh =
        std::make_shared<LayerMesh>(per_triangle == 1 ? make_layer_mesh(surface) : test::refined_layer_mesh(surface));
    for (double nu : {0.1, 0.45, 0.4999}) {
      for (LayerFit fit : kFits) {
        for (Rim rim : {Rim::Free, Rim::Wall, Rim::Continues}) {
          LayerOperator layer(mesh, layer_law({11.85, nu}, fit), std::vector<Rim>(mesh->rim.size(), rim));
          layer.set_thickness(to_vector(wavy_thickness(surface, per_triangle)));
          const int n = mesh->feet();
          const VectorXd covered =
              areas(*mesh).cwiseProduct((VectorXd::Random(n).array() * 0.5 + 0.5).max(0.01).matrix());
          Eigen::MatrixXd w = Eigen::MatrixXd::Zero(n, n);
          layer.add_sinking(Eigen::MatrixXd::Identity(n, n), covered, w);
          const Eigen::MatrixXd work = covered.asDiagonal() * w;
          EXPECT_LT((work - work.transpose()).norm() / work.norm(), 1e-12);
          // scaled by the local compliance, the least eigenvalue is at least that of the law
          VectorXd scale(n);
          for (int i = 0; i < n; ++i)
            scale[i] = 1 / std::sqrt(covered[i] * layer.law().local * layer.thickness()[static_cast<std::size_t>(i)]);
          const Eigen::MatrixXd scaled = scale.asDiagonal() * (0.5 * (work + work.transpose())) * scale.asDiagonal();
          double least = 1;
          for (double s = 0; s < 100; s += 0.05) least = std::min(least, layer.law()(s) / layer.law().local);
          EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled).eigenvalues()[0], least * (1 - 1e-6))
              << "nu " << nu << " " << name(fit) << " rim " << static_cast<int>(rim) << " " << per_triangle;
        }
      }
    }
  }
}

// Between walls the volume pressed in is that of the bed of springs, sum of A t p / M, whatever the thickness does:
// bulging moves volume and makes none. With a free rim some of it escapes, so more is pressed in.
TEST(LayerOperator, VolumeIsConservedBetweenWalls) {
  const SurfaceMesh surface = saddle(15);
  for (const int per_triangle : {1, 4}) {
    const auto mesh =
        std::make_shared<LayerMesh>(per_triangle == 1 ? make_layer_mesh(surface) : test::refined_layer_mesh(surface));
    const VectorXd t = wavy_thickness(surface, per_triangle), A = areas(*mesh);
    VectorXd p(mesh->feet());
    for (int i = 0; i < p.size(); ++i) p[i] = std::max(0.0, std::sin(0.1 * i * per_triangle));
    for (LayerFit fit : kFits) {
      for (double nu : {0.3, 0.45, 0.4999}) {
        const LayerLaw law = layer_law({11.85, nu}, fit);
        LayerOperator walled(mesh, law, std::vector<Rim>(mesh->rim.size(), Rim::Wall)),
            free(mesh, law, std::vector<Rim>(mesh->rim.size(), Rim::Free)),
            open(mesh, law, std::vector<Rim>(mesh->rim.size(), Rim::Continues));
        for (LayerOperator* layer : {&walled, &free, &open}) layer->set_thickness(to_vector(t));
        const double springs = (A.array() * t.array() * p.array()).sum() * law.confined;
        const double scale = (A.array() * t.array() * p.array()).sum() * law.local;  // what is moved about
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
    const auto one = std::make_shared<LayerMesh>(make_layer_mesh(surface));
    const auto four = std::make_shared<LayerMesh>(test::refined_layer_mesh(surface));
    double volume[2];
    int k = 0;
    for (const auto& mesh : {one, four}) {
      LayerOperator layer(mesh, layer_law(kCartilage, LayerFit::OneTerm),
                          std::vector<Rim>(mesh->rim.size(), Rim::Free));
      VectorXd x(mesh->feet()), t(mesh->feet());
      for (int i = 0; i < x.size(); ++i) {
        const auto f = static_cast<std::size_t>(i);
        x[i] = 0;
        for (std::size_t c = 0; c < 3; ++c)
          x[i] += mesh->centroid[f][c] * surface.corner(mesh->foot_triangle[f], static_cast<int>(c)).x();
        t[i] = 1 + x[i] / 8;
      }
      layer.set_thickness(to_vector(t));
      const VectorXd p = (x * (kPi / 12)).array().sin().matrix();
      volume[k++] = (areas(*mesh).array() * p.array() * layer.sinking(p).array()).sum();
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
    const auto mesh = std::make_shared<LayerMesh>(make_layer_mesh(surface));
    LayerOperator layer(mesh, law, test::rim_where(surface, *mesh, [&](const Vector3d& x) {
                          return x.x() > 0.9999 * length ? end : Rim::Wall;
                        }));
    layer.set_thickness(std::vector<double>(mesh->area.size(), t));
    const VectorXd exact = at_feet(surface, [&](const Vector3d& x) {
      const double c = std::cosh(x.x() / l);
      const double q =
          end == Rim::Wall ? 1 : 1 - c * (end == Rim::Free ? 1 / std::cosh(length / l) : std::exp(-length / l));
      return t * (law.local + law.weight[0] * q);
    });
    return (layer.sinking(VectorXd::Ones(mesh->feet())) - exact).lpNorm<Eigen::Infinity>() / (t * law.local);
  };
  EXPECT_LT(error(Rim::Wall, 20), 1e-12);
  for (Rim end : {Rim::Free, Rim::Continues}) {
    EXPECT_LT(error(end, 90), 2e-3);
    EXPECT_NEAR(std::log2(error(end, 30) / error(end, 60)), 2, 0.25) << static_cast<int>(end);
  }
}

// What the layer does does not depend on what was factorised before, and a foot without a layer is an edge.
TEST(LayerOperator, RefactorisesAndTakesFeetWithoutLayer) {
  const SurfaceMesh surface = saddle(8);
  const auto mesh = std::make_shared<LayerMesh>(make_layer_mesh(surface));
  const LayerLaw law = layer_law(kCartilage, LayerFit::OneTerm);
  const std::vector<Rim> rim(mesh->rim.size(), Rim::Continues);
  LayerOperator once(mesh, law, rim), again(mesh, law, rim);
  VectorXd t = wavy_thickness(surface);
  for (int i = 0; i < 40; ++i) t[i] = 0;
  again.set_thickness(std::vector<double>(mesh->area.size(), 1.5));
  again.set_thickness(to_vector(t));
  once.set_thickness(to_vector(t));
  const VectorXd p = VectorXd::Ones(t.size()), w = once.sinking(p);
  EXPECT_EQ((w - again.sinking(p)).lpNorm<Eigen::Infinity>(), 0);
  EXPECT_EQ(w.head(40).lpNorm<Eigen::Infinity>(), 0);
  EXPECT_GT(w.tail(t.size() - 40).minCoeff(), 0);
  once.set_thickness(std::vector<double>(mesh->area.size(), 0.0));  // no layer anywhere
  EXPECT_EQ(once.sinking(p).lpNorm<Eigen::Infinity>(), 0);
}

// As nu -> 0.5 the operator tends to that of nu = 0.5.
TEST(LayerOperator, NearlyIncompressible) {
  const SurfaceMesh surface = saddle(8);
  const auto mesh = std::make_shared<LayerMesh>(make_layer_mesh(surface));
  const VectorXd p = at_feet(surface, [](const Vector3d& x) { return 1 + std::sin(x.x()); });
  for (LayerFit fit : kFits) {
    VectorXd w[2];
    int k = 0;
    for (double nu : {0.5, 0.5 - 1e-8}) {
      LayerOperator layer(mesh, layer_law({11.85, nu}, fit), std::vector<Rim>(mesh->rim.size(), Rim::Free));
      layer.set_thickness(to_vector(wavy_thickness(surface)));
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
      const LayerLaw law = layer_law({10, nu}, fit);
      const auto sinking = [&](int times, Rim end) {
        const double whole = times * length;
        const SurfaceMesh surface = test::rectangle(times * m, 2, whole, 2 * length / m);
        const auto mesh = std::make_shared<LayerMesh>(make_layer_mesh(surface));
        LayerOperator layer(mesh, law, test::rim_where(surface, *mesh, [&](const Vector3d& x) {
                              return x.x() > 0.9999 * whole ? end : Rim::Wall;
                            }));
        layer.set_thickness(std::vector<double>(mesh->area.size(), t));
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

}  // namespace
}  // namespace dea

#include "src/springs/layer_contact.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>

#include "src/base/parallel.h"
#include "src/springs/near_inverse.h"
#include "tests/analytic/elastic_layer.h"
#include "tests/analytic/free_edges.h"
#include "tests/analytic/linear_systems.h"
#include "tests/analytic/neo_hookean_layer.h"
#include "tests/src/layer_meshes.h"

namespace dea::layer_contact_test {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using namespace test;

const double kE = 11.85;

/// A layer under feet, as one side of a contact.
PressedLayer side(FootedLayer& layer) { return {&layer.layer, &layer.feet, {}}; }

/// Of this layer with what is rigid, or with another layer.
LayerContact contact_of(FootedLayer& source, FootedLayer* target = nullptr) {
  LayerContact contact;
  contact.layers = {side(source)};
  if (target != nullptr) contact.layers.push_back(side(*target));
  contact.area = source.areas();
  return contact;
}

LayerContactOptions small_strain() {
  LayerContactOptions options;
  options.large_strain = false;
  return options;
}

/// Two layers of varying thickness on a curved patch, pressed by a bumpy overlap that leaves islands and holes.
struct Bumpy {
  SurfaceMesh surface;
  FootedLayer source, target;
  LayerFeet source_feet, target_feet;
  LayerContact contact;
  VectorXd overlap;

  Bumpy(int n, double nu, LayerFit fit)
      : surface(test::grid(n, n, [](double u, double v) { return Vector3d(16 * u, 14 * v, 2 * u * v + u * u); })),
        source(layer_mesh(
                   surface, [](const Vector3d& x) { return 2 + std::sin(0.4 * x.x()); }, all(Rim::Free)),
               {kE, nu}, fit),
        target(layer_mesh(
                   surface, [](const Vector3d& x) { return 1 + 0.5 * std::cos(x.y()); }, all(Rim::Continues)),
               {kE, nu}, fit) {
    VectorXd share = VectorXd::Ones(surface.size());
    for (int i = 0; i < surface.size(); i += 7) share[i] = 0.3;   // partly over the target
    for (int i = 0; i < surface.size(); i += 11) share[i] = 0.0;  // not at all
    source_feet = test::covered(source.feet, share);
    target_feet = test::covered(target.feet, share);
    contact.layers = {{&source.layer, &source_feet, {}}, {&target.layer, &target_feet, {}}};
    contact.area = source.areas().cwiseProduct(share);
    overlap =
        at_feet(surface, [](const Vector3d& x) { return 0.1 + 0.2 * std::sin(0.7 * x.x()) * std::cos(0.6 * x.y()); });
  }
  Bumpy(const Bumpy&) = delete;
  Bumpy& operator=(const Bumpy&) = delete;
};

// The conditions themselves, for compliances from mild to nearly incompressible, from nothing and from a wrong guess.
TEST(LayerContact, MeetsItsConditions) {
  for (double nu : {0.2, 0.3, 0.45, 0.4999})
    for (LayerFit fit : kFits)
      for (const bool large : {false, true}) {
        Bumpy b(24, nu, fit);
        LayerContactOptions options;
        options.large_strain = large;
        const std::string what =
            std::string(name(fit)) + " nu " + std::to_string(nu) + (large ? " large strain" : " small strain");
        const LayerPressure r = solve_contact(b.contact, b.overlap, {}, options);
        ASSERT_TRUE(r.converged) << what;
        EXPECT_LT(r.applications, large ? 250 : 120) << what;
        VectorXd w = sinking(b.contact, r.pressure).col(0), softening;
        if (large)
          w = large_sinking(b.source.layer, b.source_feet, r.pressure, softening) +
              large_sinking(b.target.layer, b.target_feet, r.pressure, softening);
        EXPECT_LT((w - r.sunk[0] - r.sunk[1]).lpNorm<Eigen::Infinity>(), 1e-12 * w.maxCoeff()) << what;
        const VectorXd local = local_compliance(b.contact);
        const double peak = r.pressure.maxCoeff(), tolerance = 3e-9;
        int active = 0, bulged = 0;
        for (int i = 0; i < w.size(); ++i) {
          EXPECT_GE(r.pressure[i], 0);
          if (b.contact.area[i] == 0) {
            EXPECT_EQ(r.pressure[i], 0);
            continue;
          }
          const double missing = (w[i] - b.overlap[i]) / local[i] / peak;
          EXPECT_GT(missing, -tolerance) << what;
          if (r.pressure[i] > tolerance * peak) {
            EXPECT_NEAR(missing, 0, tolerance) << what;
          }
          active += r.active[static_cast<std::size_t>(i)];
          bulged += r.pressure[i] > 0 && b.overlap[i] < 0;
        }
        EXPECT_GT(active, 100) << what;
        EXPECT_LT(active, w.size() - 100) << what;
        if (nu > 0.4) {
          EXPECT_GT(bulged, 0) << what;
        }  // touches where the springs would be apart
        const LayerPressure again = solve_contact(b.contact, b.overlap, VectorXd::Constant(w.size(), 3.0), options);
        EXPECT_LT((again.pressure - r.pressure).lpNorm<Eigen::Infinity>() / peak, 1e-7) << what;
        const LayerPressure warm = solve_contact(b.contact, b.overlap, r.pressure, options);
        EXPECT_LE(warm.applications, 10) << what;  // found: what is left is the last digits
        EXPECT_LT((warm.pressure - r.pressure).lpNorm<Eigen::Infinity>() / peak, 1e-7) << what;
      }
}

// Symmetric and positive, as conjugate gradients need it, on some of the feet; and so near to the inverse that they end
// soon: the eigenvalues of its product with the compliance lie closer together than those of the compliance.
TEST(LayerContact, NearInverseIsOne) {
  for (const double nu : {0.0, 0.3, 0.45, 0.49}) {
    Bumpy b(14, nu, LayerFit::TwoTerms);
    for (const std::size_t layers : {2, 1}) {
      LayerContact contact = b.contact;
      contact.layers.resize(layers);
      const VectorXd local = local_compliance(contact), weight = contact.area.cwiseProduct(local);
      std::vector<char> asked(static_cast<std::size_t>(weight.size()), 0);
      std::vector<Eigen::Index> feet;
      for (Eigen::Index i = 0; i < weight.size(); ++i)
        if (weight[i] > 0 && i % 100 < 70) {
          asked[static_cast<std::size_t>(i)] = 1;
          feet.push_back(i);
        }
      const MatrixXd one = MatrixXd::Identity(weight.size(), weight.size());
      MatrixXd all = MatrixXd::Zero(weight.size(), weight.size());
      for (const Eigen::Index i : feet) all(i, i) = 1;
      for (const PressedLayer& of : contact.layers) add_near_inverse(*of.layer, *of.feet, weight, asked, one, all);
      for (Eigen::Index i = 0; i < weight.size(); ++i) {
        if (asked[static_cast<std::size_t>(i)]) continue;
        EXPECT_TRUE(all.row(i).isZero(0) && all.col(i).isZero(0));
      }
      // in the inner product of areas times local compliance: by its roots from both sides
      const auto symmetric = [&](const MatrixXd& m) {
        const VectorXd root = weight(feet).cwiseSqrt();
        const MatrixXd scaled = root.asDiagonal() * m(feet, feet) * root.cwiseInverse().asDiagonal();
        EXPECT_LT((scaled - scaled.transpose()).norm(), 1e-12 * scaled.norm());
        return MatrixXd(0.5 * (scaled + scaled.transpose()));
      };
      const MatrixXd P = symmetric(all),
                     B = symmetric(local.cwiseInverse()
                                       .unaryExpr([](double x) { return std::isfinite(x) ? x : 0.0; })
                                       .asDiagonal() *
                                   sinking(contact, one));
      const Eigen::SelfAdjointEigenSolver<MatrixXd> of_p(P), of_b(B);
      ASSERT_GT(of_p.eigenvalues().minCoeff(), 0.05) << nu;
      const MatrixXd root = of_p.operatorSqrt();
      const VectorXd product = Eigen::SelfAdjointEigenSolver<MatrixXd>(root * B * root).eigenvalues();
      const double spread = product.maxCoeff() / product.minCoeff(),
                   before = of_b.eigenvalues().maxCoeff() / of_b.eigenvalues().minCoeff();
      EXPECT_LT(spread, layers == 1 ? 0.6 * before : 0.75 * before) << nu << ", " << layers << " layers";
    }
  }
}

TEST(LayerContact, ApartIsNoPressure) {
  Bumpy b(8, 0.45, LayerFit::OneTerm);
  const LayerPressure r = solve_contact(b.contact, VectorXd::Constant(b.overlap.size(), -0.1));
  EXPECT_TRUE(r.converged);
  EXPECT_EQ(r.pressure.maxCoeff(), 0);
}

// Against a dense solution of the same active set, and against finite differences of the contact itself.
TEST(LayerContact, RatesAreTheDerivative) {
  for (LayerFit fit : kFits) {
    Bumpy b(16, 0.45, fit);
    const LayerContactOptions closely{1e-13, 2000, true};
    const LayerPressure r = solve_contact(b.contact, b.overlap, {}, closely);
    MatrixXd motions(b.overlap.size(), 3);
    motions.col(0).setOnes();
    motions.col(1) = at_feet(b.surface, [](const Vector3d& x) { return x.x() - 8; });
    motions.col(2) = at_feet(b.surface, [](const Vector3d& x) { return x.y() - 7; });
    const ActiveRates rates = solve_active(b.contact, r.active, motions, 1e-11);
    ASSERT_TRUE(rates.converged);
    // the same, dense
    std::vector<int> active;
    for (int i = 0; i < r.pressure.size(); ++i)
      if (r.active[static_cast<std::size_t>(i)]) active.push_back(i);
    const MatrixXd C = sinking(b.contact, MatrixXd::Identity(r.pressure.size(), r.pressure.size()))(active, active);
    const MatrixXd dense = analytic::solve_dense(C, motions(active, Eigen::all));
    EXPECT_LT((rates.pressure(active, Eigen::all) - dense).norm() / dense.norm(), 1e-9);
    // central differences: in the mean over feet whose neighbours do not change sides
    for (int c = 0; c < 3; ++c) {
      const double d = 1e-7;
      const VectorXd difference =
          (solve_contact(b.contact, b.overlap + d * motions.col(c), r.pressure, closely).pressure -
           solve_contact(b.contact, b.overlap - d * motions.col(c), r.pressure, closely).pressure) /
          (2 * d);
      EXPECT_LT((difference - rates.pressure.col(c)).norm() / difference.norm(), 1e-3) << c;
    }
  }
}

// From rates that are wrong by a hundredth and more, columns mixed: the stiffness they make is wrong by the square of
// what they are wrong by, and never too stiff.
TEST(LayerContact, StiffnessIsWrongByTheSquare) {
  for (LayerFit fit : kFits) {
    Bumpy b(16, 0.45, fit);
    const LayerPressure r = solve_contact(b.contact, b.overlap, {}, {1e-13, 2000, true});
    MatrixXd motions(b.overlap.size(), 2);
    motions.col(0).setOnes();
    motions.col(1) = at_feet(b.surface, [](const Vector3d& x) { return x.x() - 8; });
    for (Eigen::Index i = 0; i < motions.rows(); ++i)
      if (!r.active[static_cast<std::size_t>(i)]) motions.row(i).setZero();
    const MatrixXd exact = solve_active(b.contact, r.active, motions, 1e-12).pressure;
    const auto stiffness = [&](const MatrixXd& rates) -> MatrixXd {
      return motions.transpose() * b.contact.area.asDiagonal() * rates;
    };
    MatrixXd start(exact.rows(), 2);
    start.col(0) = exact.col(0) - 0.3 * exact.col(1);
    start.col(1) = 2 * exact.col(1);
    for (Eigen::Index i = 0; i < start.rows(); ++i) start.row(i) *= 1 + 0.05 * std::sin(7.0 * static_cast<double>(i));
    for (const double tolerance : {0.1, 0.03, 0.01}) {
      const MatrixXd rates = solve_active(b.contact, r.active, motions, tolerance, start).pressure;
      const double wrong = (rates - exact).norm() / exact.norm();
      const MatrixXd missing = stiffness(exact) - stiffness(rates);
      EXPECT_GT(wrong, 1e-5) << "the start is no test";
      EXPECT_LT(missing.norm() / stiffness(exact).norm(), 10 * wrong * wrong) << name(fit) << " " << tolerance;
      EXPECT_GT(missing.diagonal().minCoeff(), -1e-10 * stiffness(exact).norm());
    }
  }
}

TEST(LayerContact, DoesNotDependOnThreads) {
  VectorXd p[2];
  for (const int threads : {1, 2}) {
    const auto limit = limit_threads(threads);
    Bumpy b(20, 0.45, LayerFit::TwoTerms);
    p[threads - 1] = solve_contact(b.contact, b.overlap).pressure;
  }
  EXPECT_EQ((p[0] - p[1]).lpNorm<Eigen::Infinity>(), 0);
}

// A ball in a hemispherical socket of 4 mm cartilage (rigid radii 20 and 24 mm), moved by u: the overlap u cos(theta)
// is a spherical harmonic of the sphere, and with q = 0 on the rim it stays one, so p keeps its shape to the rim and is
// the bed of springs' at the same force, 2.3873 cos(theta) at 2000 N. Errors relative to the peak. With two
// terms the edge is softer than that (L7): within a thickness of it the small pressures there are less by what
// StripWithAFreeEndAgainstFiniteElements knows, up to 6% of the peak; further away 1% is left.
TEST(LayerContact, HemispheresKeepTheCosine) {
  for (LayerFit fit : kFits) {
    const auto error = [&](int n, Rim rim, double from_rim) {
      const SurfaceMesh surface = test::hemisphere(n, 20.0);
      FootedLayer layer(layer_mesh(surface, even(4.0), all(rim)), {kE, 0.45}, fit);
      LayerContact contact = contact_of(layer);
      const VectorXd cosine = at_feet(surface, [](const Vector3d& x) { return x.z() / x.norm(); });
      const LayerPressure r = solve_contact(contact, 0.1 * cosine, {}, small_strain());
      EXPECT_TRUE(r.converged);
      const double p_0 = (contact.area.array() * r.pressure.array() * cosine.array()).sum() / (2 * kPi * 400 / 3);
      double worst = 0;
      for (int i = 0; i < cosine.size(); ++i)
        if (20 * std::asin(cosine[i]) > from_rim) worst = std::max(worst, std::abs(r.pressure[i] / p_0 - cosine[i]));
      return worst;
    };
    const bool one = fit == LayerFit::OneTerm;
    EXPECT_LT(error(30, Rim::Free, 0), one ? 0.02 : 0.07) << name(fit);
    EXPECT_LT(error(60, Rim::Free, 0), one ? 0.01 : 0.05) << name(fit);
    EXPECT_LT(error(60, Rim::Free, 4), 0.01) << name(fit);
    EXPECT_GT(error(30, Rim::Wall, 0), 0.10) << name(fit);  // walled in, it is another problem
  }
}

// A rigid paraboloid and a parabolic cylinder on one layer, and between two, against quadrature of the exact response.
// Tolerances: the errors of the rational laws, rounded up. One term runs into a constant for short waves, so its
// pressure ends like a spring bed's and the contact is too wide; force and peak do not care once the contact is twice
// as wide as the layer is thick. Two terms have force and peak within 0.8%, the area within 1.6%, of contacts as narrow
// as the layer 4%.
TEST(LayerContact, ParabolicPunchesAgainstTheExactResponse) {
  const double t_s = 2.0, t_t = 1.5, R = 25;
  struct Row {
    double nu, depth;
    bool two_layers, cylinder;
    double force[2], peak[2], extent[2];  // one term, two terms
  };
  const Row rows[] = {
      {0.45, 0.4, false, false, {0.006, 0.008}, {0.006, 0.008}, {0.13, 0.016}},
      {0.45, 0.4, true, false, {0.006, 0.008}, {0.006, 0.008}, {0.12, 0.016}},
      {0.45, 0.4, true, true, {0.003, 0.008}, {0.003, 0.008}, {0.07, 0.016}},
      {0.45, 0.4, false, true, {0.003, 0.008}, {0.003, 0.008}, {0.07, 0.016}},
      {0.45, 0.1, false, false, {0.045, 0.008}, {0.04, 0.008}, {0.27, 0.035}},
      {0.45, 0.1, true, false, {0.04, 0.008}, {0.03, 0.008}, {0.25, 0.035}},
      {0.45, 0.1, false, true, {0.012, 0.008}, {0.006, 0.008}, {0.13, 0.02}},
      {0.45, 1.25, false, false, {0.003, 0.008}, {0.003, 0.008}, {0.07, 0.016}},
      {0.49, 0.4, false, false, {0.003, 0.008}, {0.01, 0.008}, {0.12, 0.016}},
      {0.4999, 0.4, false, false, {0.006, 0.008}, {0.012, 0.008}, {0.12, 0.016}},
      {0.4999, 0.1, false, false, {0.025, 0.008}, {0.003, 0.008}, {0.25, 0.035}},
      {0.4999, 0.4, false, true, {0.006, 0.008}, {0.006, 0.008}, {0.06, 0.016}},
      {0.3, 0.4, false, false, {0.015, 0.008}, {0.005, 0.008}, {0.16, 0.016}},
      {0.3, 0.1, false, false, {0.08, 0.008}, {0.09, 0.008}, {0.31, 0.04}},
  };
  for (const Row& row : rows) {
    analytic::ParabolicPunch punch;
    punch.compliance = [&](double k) {
      return analytic::flat_layer(kE, row.nu, t_s, k) + (row.two_layers ? analytic::flat_layer(kE, row.nu, t_t, k) : 0);
    };
    punch.half_space = (row.two_layers ? 2 : 1) * 2 * (1 - row.nu * row.nu) / kE;
    punch.thickness = row.two_layers ? t_t : t_s;
    punch.radius = R;
    const double a = std::sqrt(2 * R * row.depth), reach = 1.45 * a;
    const analytic::PunchResult exact =
        row.cylinder ? punch.cylinder(row.depth, reach) : punch.sphere(row.depth, reach);
    const double length = 1.6 * a + 3 * t_s;  // a quarter, between planes of symmetry
    const int n = row.cylinder ? 300 : 90;
    const double width = row.cylinder ? 2 * length / n : length;
    const SurfaceMesh surface = test::rectangle(n, row.cylinder ? 2 : n, length, width);
    const auto rim = [&](const Vector3d& x) {
      return x.x() > 0.9999 * length || (!row.cylinder && x.y() > 0.9999 * length) ? Rim::Continues : Rim::Wall;
    };
    for (std::size_t k = 0; k < 2; ++k) {
      FootedLayer source(layer_mesh(surface, even(t_s), rim), {kE, row.nu}, kFits[k]),
          target(layer_mesh(surface, even(t_t), rim), {kE, row.nu}, kFits[k]);
      LayerContact contact = contact_of(source, row.two_layers ? &target : nullptr);
      const VectorXd overlap = at_feet(surface, [&](const Vector3d& x) {
        return row.depth - (x.x() * x.x() + (row.cylinder ? 0 : x.y() * x.y())) / (2 * R);
      });
      const LayerPressure r = solve_contact(contact, overlap, {}, small_strain());
      ASSERT_TRUE(r.converged);
      double area = 0;
      for (int i = 0; i < surface.size(); ++i) area += r.active[static_cast<std::size_t>(i)] * contact.area[i];
      const double force = contact.area.dot(r.pressure) * (row.cylinder ? 2 / width : 4),
                   extent = row.cylinder ? area / width / exact.radius : 4 * area / (kPi * exact.radius * exact.radius);
      const std::string what = std::string(name(kFits[k])) + (row.cylinder ? " cylinder" : " sphere") + " nu " +
                               std::to_string(row.nu) + " depth " + std::to_string(row.depth);
      EXPECT_NEAR(force / exact.force, 1, row.force[k]) << what;
      EXPECT_NEAR(r.pressure.maxCoeff() / exact.peak, 1, row.peak[k]) << what;
      EXPECT_NEAR(extent, 1, row.extent[k]) << what;
    }
  }
}

// The quadrature against a limit of its own: a layer much thicker than the contact is Hertz's half-space.
TEST(LayerContact, QuadratureOfAThickLayerIsHertz) {
  const double E = 10, nu = 0.3, R = 25, depth = 0.01, E_star = E / (1 - nu * nu);
  analytic::ParabolicPunch punch;
  punch.compliance = [&](double k) { return analytic::flat_layer(E, nu, 200, k); };
  punch.half_space = 2 / E_star;
  punch.thickness = 200;
  punch.radius = R;
  const analytic::PunchResult r = punch.sphere(depth, 1.3 * std::sqrt(R * depth));
  // the base 200 mm below adds a little stiffness: of the order of a/t = 0.25%
  EXPECT_NEAR(r.force / (4.0 / 3 * E_star * std::sqrt(R) * std::pow(depth, 1.5)), 1, 0.006);
  EXPECT_NEAR(r.radius / std::sqrt(R * depth), 1, 0.01);
}

// A strip whose end is free, against plane-strain finite elements: a load that fades out at the end, a load away from
// it, and one that goes on to the corner; flat, and three times as thick in the middle as at the end. Error of the
// sinking relative to its greatest value, further than one thickness from the end, and closer. With two terms the
// edge's own softness (L7) is there too; walling the end in is wrong far into the strip.
TEST(LayerContact, StripWithAFreeEndAgainstFiniteElements) {
  const double E = kE, t_0 = 2, length = 12;
  const int m = 120;
  enum Load { Fading, Away, Even };
  struct Row {
    double nu;
    bool wedge;
    Load load;
    double far[2], near[2];  // one term, two terms: upper bounds
    double far_wall;         // a lower one
  };
  for (const Row& row :
       {Row{0.45, false, Fading, {0.02, 0.02}, {0.30, 0.28}, 0.15},
        Row{0.45, false, Away, {0.05, 0.03}, {0.19, 0.16}, 0.12},
        Row{0.45, false, Even, {0.09, 0.05}, {0.70, 0.10}, 0.4},
        Row{0.45, true, Fading, {0.035, 0.03}, {0.07, 0.06}, 0.0},
        Row{0.45, true, Away, {0.07, 0.02}, {0.11, 0.11}, 0.0}, Row{0.3, false, Even, {0.05, 0.03}, {0.70, 0.10}, 0.0},
        Row{0.4999, false, Even, {0.14, 0.09}, {1.10, 0.20}, 0.4}}) {
    const auto thickness = [&](double x) { return row.wedge ? t_0 * (1 + 0.5 * std::cos(kPi * x / length)) : t_0; };
    const auto load = [&](double x) {
      if (row.load == Even) return 1.0;
      if (row.load == Fading) return std::cos(kPi * x / (2 * length));
      return x > length / 2 ? 0.5 - 0.5 * std::cos(4 * kPi * x / length) : 0.0;
    };
    const std::vector<double> exact = analytic::plane_strain_layer(E, row.nu, length, thickness, load, true, m, 12);
    const double scale = *std::max_element(exact.begin(), exact.end() - m / 6);
    for (std::size_t fit = 0; fit < 2; ++fit)
      for (Rim end : {Rim::Free, Rim::Wall}) {
        const SurfaceMesh surface = test::rectangle(m, 2, length, 2 * length / m);
        FootedLayer layer(layer_mesh(
                              surface, [&](const Vector3d& x) { return thickness(x.x()); },
                              [&](const Vector3d& x) { return x.x() > 0.9999 * length ? end : Rim::Wall; }),
                          {E, row.nu}, kFits[fit]);
        const VectorXd w = layer.sinking(at_feet(surface, [&](const Vector3d& x) { return load(x.x()); }));
        double far = 0, near = 0;
        for (int i = 0; i < surface.size(); ++i) {
          const double x = surface.centroid(i).x(), u = x / length * m;
          const std::size_t k = static_cast<std::size_t>(u);
          const double reference = exact[k] + (u - static_cast<double>(k)) * (exact[k + 1] - exact[k]);
          double& worst = x < length - t_0 ? far : near;
          worst = std::max(worst, std::abs(w[i] - reference) / scale);
        }
        const std::string what = std::string(name(kFits[fit])) + " nu " + std::to_string(row.nu) +
                                 (row.wedge ? " wedge" : " flat") + " load " + std::to_string(row.load);
        if (end == Rim::Free) {
          EXPECT_LT(far, row.far[fit]) << what;
          EXPECT_LT(near, row.near[fit]) << what;
        } else {
          EXPECT_GT(far, row.far_wall) << what;
        }
      }
  }
}

// The finite elements themselves: a periodic load on a flat layer has the answer (L1).
TEST(LayerContact, FiniteElementsConfirmTheExactResponse) {
  const double t = 2;
  for (double nu : {0.3, 0.45})
    for (double s : {0.5, 1.0, 2.0, 3.0}) {
      const double k = s / t;
      const std::vector<double> w = analytic::plane_strain_layer(
          kE, nu, kPi / k, [&](double) { return t; }, [&](double x) { return std::cos(k * x); }, false, 30, 15);
      EXPECT_NEAR(w[0] / t / layer_compliance({kE, nu}, s), 1, 1e-4) << nu << " " << s;
    }
}

// Long waves of a large strain give the spring's own law; two moduli then share the overlap as springs in series do.
TEST(LayerContact, LargeStrainOfLongWavesIsTheSprings) {
  const SurfaceMesh surface = test::rectangle(6, 6, 10, 10);
  for (const Elasticity& other : {Elasticity{kE, 0.45}, Elasticity{30.0, 0.3}}) {
    const Elasticity soft{kE, 0.45};
    FootedLayer source(layer_mesh(surface, even(1.2), all(Rim::Wall)), soft, LayerFit::OneTerm),
        target(layer_mesh(surface, even(2.1), all(Rim::Wall)), other, LayerFit::TwoTerms);
    LayerContact contact = contact_of(source, &target);
    for (const bool large : {false, true}) {
      LayerContactOptions options;
      options.large_strain = large;
      const LayerPressure r = solve_contact(contact, VectorXd::Constant(surface.size(), 1.1), {}, options);
      ASSERT_TRUE(r.converged) << large;
      const SpringResponse spring = spring_response(large ? Law::NeoHookean : Law::Linear, soft, other, 1.2, 2.1, 1.1);
      for (int i = 0; i < surface.size(); ++i) {
        EXPECT_NEAR(r.pressure[i] / spring.pressure, 1, 1e-7) << large;
        EXPECT_NEAR(r.sunk[0][i] / 1.2, spring.strain_source, 1e-7) << large;
        EXPECT_NEAR(r.sunk[1][i] / 2.1, spring.strain_target, 1e-7) << large;
      }
    }
  }
  // not so long waves, small strains: the linear law
  Bumpy b(16, 0.45, LayerFit::TwoTerms);
  const VectorXd linear = solve_contact(b.contact, 1e-5 * b.overlap, {}, small_strain()).pressure,
                 large = solve_contact(b.contact, 1e-5 * b.overlap).pressure;
  EXPECT_LT((large - linear).lpNorm<Eigen::Infinity>(), 1e-4 * linear.maxCoeff());
}

/// Force and peak of the layer law under an axisymmetric punch or between layers: a quarter of the plane.
struct Pressed {
  double force = 0, peak = 0, deepest_strain = 0;
};
Pressed press_quarter(const std::vector<std::pair<Elasticity, double>>& layers, double reach, int n, bool cylinder,
                      const std::function<double(double)>& overlap_at) {
  const double length = reach, width = cylinder ? 2 * length / n : length;
  const auto finer = [](double u) { return u * (0.4 + 0.6 * u); };  // in the middle
  const SurfaceMesh surface = test::grid(n, cylinder ? 2 : n, [=](double u, double v) {
    return Vector3d(length * finer(u), width * (cylinder ? v : finer(v)), 0);
  });
  const auto rim = [&](const Vector3d& x) {
    return x.x() > 0.9999 * length || (!cylinder && x.y() > 0.9999 * length) ? Rim::Continues : Rim::Wall;
  };
  std::vector<FootedLayer> all_layers;
  for (const auto& [material, t] : layers)
    all_layers.emplace_back(layer_mesh(surface, even(t), rim), material, LayerFit::TwoTerms);
  LayerContact contact = contact_of(all_layers[0], all_layers.size() > 1 ? &all_layers[1] : nullptr);
  const LayerPressure r = solve_contact(contact, at_feet(surface, [&](const Vector3d& x) {
                                          return overlap_at(cylinder ? x.x() : std::hypot(x.x(), x.y()));
                                        }));
  EXPECT_TRUE(r.converged);
  return {contact.area.dot(r.pressure) * (cylinder ? 2 / width : 4), r.pressure.maxCoeff(),
          std::max(r.sunk[0].maxCoeff() / layers[0].second, 0.0)};
}

/// Depth of a sphere (cylinder) of radius R below its tip; 0: flat, < 0: hollow.
double sagitta(double R, double r) {
  return R == 0 ? 0 : R - std::copysign(std::sqrt(std::max(0.0, R * R - r * r)), R);
}

// Large strains against finite elements of the same solids, which bench/large_strain.cpp made (their own error, by
// their convergence and by FEBio's answers to some, is 0.5%; the peak between two layers is known to 1.5% only). 3% is
// what (L9) was asked for. Worse are: cylinders on contacts no wider than the layer is thick; layers on a base whose
// radius is ten thicknesses, 10%, for the law sees a flat one; and thirty of them, 5%. Without large strain these are
// up to 17% off.
TEST(LayerContact, LargeStrainsAgainstFiniteElements) {
  std::ifstream file(DEA_ANALYTIC_DIR "/large_strain.csv");
  std::string line;
  int rows = 0;
  while (std::getline(file, line)) {
    if (line[0] == '#' || line.rfind("case", 0) == 0) continue;
    ++rows;
    std::vector<std::string> cell;
    std::stringstream cells(line);
    for (std::string c; std::getline(cells, c, ',');) cell.push_back(c);
    ASSERT_EQ(cell.size(), 14u) << line;
    const auto number = [&](std::size_t i) { return cell[i].empty() ? 0.0 : std::stod(cell[i]); };
    const double nu = number(1), t = number(3), base = number(4), punch = number(8), depth = number(9),
                 h = t + number(7);
    const bool cylinder = cell[0] == "cylinder";
    std::vector<std::pair<Elasticity, double>> layers = {{{number(2), nu}, t}};
    if (number(7) > 0) layers.push_back({{number(6), number(5)}, number(7)});
    const double curvature = (base == 0 ? 0 : 1 / base) + (punch == 0 ? 0 : 1 / punch),
                 reach = 1.2 * std::sqrt(2 * depth / curvature) + 4 * t;
    const Pressed p = press_quarter(layers, reach, cylinder ? 200 : 56, cylinder, [&](double r) {
      const double within = 0.95 * std::min(base == 0 ? 1e9 : std::abs(base), punch == 0 ? 1e9 : punch);
      return r > within ? -h : depth - sagitta(punch, r) - sagitta(base, r);
    });
    const bool one_flat = base == 0 && layers.size() == 1;
    const double tolerance = cylinder                        ? 0.04
                             : one_flat || layers.size() > 1 ? 0.03
                             : std::abs(base) < 30           ? 0.1
                                                             : 0.05,
                 peak_tolerance = cylinder ? 0.055 : tolerance;
    EXPECT_NEAR(p.force / number(10), 1, tolerance) << line;
    EXPECT_NEAR(p.peak / number(12), 1, peak_tolerance) << line;
  }
  EXPECT_GT(rows, 60);
}

// The elements themselves: one row of the file again, coarser.
TEST(LayerContact, StoredLargeStrainsAreThoseOfTheElements) {
  analytic::NeoHookeanLayer layer;
  analytic::LayerGrid grid;
  grid.fine_length = std::sqrt(2 * 20.4 * 0.4) * 1.05 + 0.5;
  grid.length = grid.fine_length + 12;
  grid.through = 4;
  grid.fine = 10;
  grid.coarse = 8;
  const auto r = analytic::press_rigid(true, layer, 1 / 20.4, {0.2, 0.4}, grid, 0.05);
  EXPECT_NEAR(r[1].force / 124.4, 1, 0.03);
  EXPECT_NEAR(r[1].peak_cauchy / 4.515, 1, 0.03);
}

/// A quarter of a ring (a disc, nearly, for r_0 small) with walls on its straight sides.
SurfaceMesh quarter_ring(double r_0, double r_1, int across, int around) {
  return test::grid(across, around, [=](double u, double v) {
    const double r = r_0 + (r_1 - r_0) * u, a = 0.5 * kPi * v;
    return Vector3d(r * std::cos(a), r * std::sin(a), 0);
  });
}

// A disc three times as wide as thick under a sphere that reaches over its edge, and a hole three times as wide under
// one about it, against axisymmetric finite elements, on triangles as large as t/3 (L7). Their own error is below 0.6%.
// Without what (L7) knows of curved edges the disc was 12 to 17%, the hole 2 to 7% off.
TEST(LayerContact, RoundFreeEdgesAgainstFiniteElements) {
  for (const double nu : {0.3, 0.45, 0.49})
    for (const bool hole : {false, true}) {
      const double inner = hole ? 3 : 0, outer = hole ? 12 : 3;
      const auto overlap = [&](double r) { return hole ? 1 - r * r / 49 : 1 - 0.5 * r * r / 9; };
      analytic::EdgedLayer edged;
      edged.nu = nu;
      edged.axisymmetric = true;
      edged.thickness = [](double) { return 1.0; };
      edged.free_first = hole;
      edged.free_last = !hole;
      edged.through = 8;
      const int m = hole ? 110 : 45;
      for (int i = 0; i <= m; ++i) edged.ends.push_back(inner + (outer - inner) * i / m);
      const analytic::StripCompliance strips = analytic::strip_compliance(edged);
      const VectorXd exact = analytic::rigid_punch(strips, overlap);
      const double force = strips.area.dot(exact) * 0.5 * kPi;  // of a quarter
      const SurfaceMesh surface =
          hole ? quarter_ring(inner, outer, 27, 30) : test::grid(10, 10, [=](double u, double v) -> Vector3d {
            const double far = std::max(u, v);
            if (far < 1e-14) return {0, 0, 0};
            return outer * far / std::hypot(u, v) * Vector3d(u, v, 0);
          });
      FootedLayer layer(layer_mesh(surface, even(1.0),
                                   [&](const Vector3d& x) {
                                     return std::min(x.x(), x.y()) > 1e-9 && (x.norm() < 6) ? Rim::Free : Rim::Wall;
                                   }),
                        {1.0, nu}, LayerFit::TwoTerms);
      LayerContact contact = contact_of(layer);
      const LayerPressure r = solve_contact(
          contact, at_feet(surface, [&](const Vector3d& x) { return overlap(x.norm()); }), {}, small_strain());
      ASSERT_TRUE(r.converged);
      EXPECT_NEAR(contact.area.dot(r.pressure) / force, 1, 0.05) << (hole ? "hole" : "disc") << " nu " << nu;
      if (!hole) {
        EXPECT_NEAR(r.pressure.maxCoeff() / exact.maxCoeff(), 1, 0.05) << nu;
      }
    }
}

// Rims whose wall leans, against plane-strain elements: bevels of 45 and 70 degrees, a vertical wall, an undercut of
// 110. Pressed by a flat and by a cylinder up to the edge, and by these a thickness inside of it: force within 5%;
// taken for vertical, the bevels were up to 39% too soft, the undercut 70% too stiff. The edge's way outwards (L11)
// within 0.07 of what an even pressure of E moves a thickness.
TEST(LayerContact, LeaningWallsAgainstFiniteElements) {
  const double length = 9;
  const int m = 90;
  const std::function<double(double)> overlaps[] = {[](double) { return 1.0; },
                                                    [](double d) { return 1 - d * d / 4; },
                                                    [](double d) { return 1 - d * d; },
                                                    [](double d) { return 1 - (d - 1) * (d - 1) / 4; },
                                                    [](double d) { return 1 - (d - 3) * (d - 3) / 4; },
                                                    [](double d) { return d > 1 ? 1.0 : -9.0; }};
  for (const double nu : {0.3, 0.45, 0.49})
    for (const double degrees : {45.0, 70.0, 90.0, 110.0}) {
      const double wall = degrees * kPi / 180;
      analytic::EdgedLayer edged;
      edged.nu = nu;
      edged.thickness = [](double) { return 1.0; };
      edged.wall_slope = 1 / std::tan(wall);
      edged.through = 12;
      // towards the edge finer: the elements' corner is singular
      for (int i = 0; i <= m; ++i) edged.ends.push_back(length * (1 - std::pow(1 - static_cast<double>(i) / m, 1.6)));
      const analytic::StripCompliance strips = analytic::strip_compliance(edged);
      const SurfaceMesh surface =
          test::grid(54, 1, [&](double u, double v) { return Vector3d(length * u, 0.17 * v, 0); });
      LayerFace face = test::layer_face(
          surface, even(1.0), [&](const Vector3d& x) { return x.x() > 0.9999 * length ? Rim::Free : Rim::Wall; });
      for (LayerFace::Edge& edge : face.edges) edge.wall = wall;
      FootedLayer layer(make_layer_mesh(face), {1.0, nu}, LayerFit::TwoTerms);
      LayerContact contact = contact_of(layer);
      for (const auto& overlap : overlaps) {
        const std::string what =
            fmt::format("nu {} wall {} overlap at 0, 1: {} {}", nu, degrees, overlap(0), overlap(1));
        const VectorXd exact = analytic::rigid_punch(strips, [&](double x) { return overlap(length - x); });
        const LayerPressure r = solve_contact(
            contact, at_feet(surface, [&](const Vector3d& x) { return overlap(length - x.x()); }), {}, small_strain());
        ASSERT_TRUE(r.converged) << what;
        EXPECT_NEAR(contact.area.dot(r.pressure) / (0.17 * strips.area.dot(exact)), 1, 0.05) << what;
        // the overlap as a pressure on both
        const auto pressure = [&](double x) { return std::max(0.0, overlap(length - x)); };
        VectorXd on_strips(strips.middle.size());
        for (int i = 0; i < on_strips.size(); ++i) on_strips[i] = pressure(strips.middle[i]);
        int vertex = -1;
        for (int v = 0; v < layer.layer.mesh.nodes(); ++v)
          if (layer.surface().vertices[at(v)].x() > 0.9999 * length) vertex = v;
        const VectorXd on_feet = at_feet(surface, [&](const Vector3d& x) { return pressure(x.x()); });
        double p = 0, weights = 0;  // within half a thickness of the edge, as a contact has it
        for (int t = 0; t < surface.size(); ++t) {
          const double weight = std::max(0.0, 1 - 2 * (length - surface.centroid(t).x()));
          p += weight * on_feet[t];
          weights += weight;
        }
        EXPECT_NEAR(edge_move(layer.layer, vertex, edge_flow(layer.layer, layer.feet, on_feet), p / weights),
                    strips.way.dot(on_strips), 0.09)
            << what;
      }
    }
}

// Where the bone bends, so that the layer grows thicker or thinner by half its length, against plane-strain finite
// elements: error of the pressure near the bend, relative to its greatest value there. 5%; with the thickness as it is,
// not smeared (L10), the layer was 12% too stiff beside a growing one.
TEST(LayerContact, BendsOfTheBoneAgainstFiniteElements) {
  const double nu = 0.45;
  for (const double slope : {0.5, -0.5}) {
    const double bend = slope > 0 ? 4 : 5, length = slope > 0 ? 10 : 6, near = slope > 0 ? 2 : 0.8;
    const auto thickness = [&](double x) { return x < bend ? 1.0 : std::max(0.2, 1 + slope * (x - bend)); };
    analytic::EdgedLayer edged;
    edged.nu = nu;
    edged.thickness = thickness;
    edged.free_last = false;
    edged.through = 10;
    const int m = static_cast<int>(std::lround(length / 0.05));
    for (int i = 0; i <= m; ++i) edged.ends.push_back(length * i / m);
    const analytic::StripCompliance strips = analytic::strip_compliance(edged);
    for (const bool cylinder : {false, true}) {
      const auto overlap = [&](double x) { return cylinder ? 1 - 0.5 * (x - bend) * (x - bend) / 9 : 1.0; };
      const VectorXd exact = analytic::rigid_punch(strips, overlap);
      for (const int n : {m, m / 4}) {  // fine, and feet of t/5
        const double width = 2 * length / n;
        const SurfaceMesh surface = test::rectangle(n, 2, length, width);
        FootedLayer layer(layer_mesh(
                              surface, [&](const Vector3d& x) { return thickness(x.x()); }, all(Rim::Wall)),
                          {1.0, nu}, LayerFit::TwoTerms);
        LayerContact contact = contact_of(layer);
        const LayerPressure r = solve_contact(
            contact, at_feet(surface, [&](const Vector3d& x) { return overlap(x.x()); }), {}, small_strain());
        ASSERT_TRUE(r.converged);
        double peak = 0, worst = 0;
        for (int i = 0; i < m; ++i)
          if (std::abs(strips.middle[i] - bend) < near) peak = std::max(peak, exact[i]);
        for (int i = 0; i < surface.size(); ++i) {
          const double x = surface.centroid(i).x(), u = x / length * m - 0.5;
          if (std::abs(x - bend) >= near) continue;
          const int k = std::clamp(static_cast<int>(std::floor(u)), 0, m - 2);
          worst = std::max(worst, std::abs(r.pressure[i] - exact[k] - (u - k) * (exact[k + 1] - exact[k])) / peak);
        }
        EXPECT_LT(worst, 0.05) << "slope " << slope << (cylinder ? " cylinder " : " plane ") << n;
      }
    }
  }
}

// Two layers of which the target has a mesh of its own, turned, shifted, with triangles from a quarter of the feet to
// four times as large: what a paraboloid does is compared with meshes that match. Up to twice the feet's size force
// within 1%, peak within 2%; four times as large, which may be triangles twice as large as the layer is thick, 5%.
TEST(LayerContact, UnlikeMeshes) {
  const double t = 2, R = 20, depth = 0.4;
  for (const double h : {0.5, 1.0}) {
    const int n = static_cast<int>(std::lround(16 / h));
    const SurfaceMesh surface =
        test::grid(n, n, [](double u, double v) -> Vector3d { return 16 * Vector3d(u - 0.5, v - 0.5, 0); });
    const VectorXd overlap = at_feet(surface, [&](const Vector3d& x) { return depth - x.squaredNorm() / (2 * R); });
    for (const double nu : {0.45, 0.49, 0.4999}) {
      const auto mesh = layer_mesh(surface, even(t), all(Rim::Continues));
      FootedLayer source(mesh, {kE, nu}, LayerFit::TwoTerms), mirrored(mesh, {kE, nu}, LayerFit::TwoTerms);
      LayerContact contact = contact_of(source, &mirrored);
      const LayerPressure matched = solve_contact(contact, overlap, {}, small_strain());
      ASSERT_TRUE(matched.converged);
      for (const double ratio : {0.25, 0.5, 1.0, 2.0, 4.0}) {
        const test::Underside below{static_cast<int>(std::lround(24 / (h * ratio))), 24.0, 0.5, {0.13, -0.06, 0}};
        const LayerOperator target =
            make_layer_operator(layer_mesh(below.mesh(), even(t), all(Rim::Continues)), {kE, nu}, LayerFit::TwoTerms);
        const LayerFeet feet = test::feet_on_underside(surface, below, target);
        contact.layers.at(1) = {&target, &feet, {}};
        const LayerPressure r = solve_contact(contact, overlap, {}, small_strain());
        ASSERT_TRUE(r.converged);
        const double force = contact.area.dot(r.pressure) / contact.area.dot(matched.pressure) - 1,
                     peak = r.pressure.maxCoeff() / matched.pressure.maxCoeff() - 1;
        const std::string what =
            "h " + std::to_string(h) + " nu " + std::to_string(nu) + " ratio " + std::to_string(ratio);
        EXPECT_LT(std::abs(force), ratio > 2 ? 0.05 : 0.01) << what;
        EXPECT_LT(std::abs(peak), ratio > 2 ? 0.05 : 0.02) << what;
      }
    }
  }
}

}  // namespace dea::layer_contact_test

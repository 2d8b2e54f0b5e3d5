#include "layer_contact.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Dense>
#include <cmath>

#include "analytic/elastic_layer.h"
#include "src/layer_meshes.h"

namespace dea {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::at_feet;
using test::to_vector;

const double kPi = std::acos(-1.0);
const double kE = 11.85;
const LayerFit kFits[] = {LayerFit::OneTerm, LayerFit::TwoTerms};

VectorXd areas(const LayerMesh& mesh) { return Eigen::Map<const VectorXd>(mesh.area.data(), mesh.feet()); }

/// Two layers of varying thickness on a curved patch, pressed by a bumpy overlap that leaves islands and holes.
struct Bumpy {
  SurfaceMesh surface;
  std::shared_ptr<const LayerMesh> mesh;
  LayerOperator source, target;
  LayerContact contact;
  VectorXd overlap;

  Bumpy(int n, double nu, LayerFit fit)
      : surface(test::grid(n, n, [](double u, double v) { return Vector3d(16 * u, 14 * v, 2 * u * v + u * u); })),
        mesh(std::make_shared<LayerMesh>(make_layer_mesh(surface))),
        source(mesh, layer_law({kE, nu}, fit), std::vector<Rim>(mesh->rim.size(), Rim::Free)),
        target(mesh, layer_law({kE, nu}, fit), std::vector<Rim>(mesh->rim.size(), Rim::Continues)) {
    source.set_thickness(to_vector(at_feet(surface, [](const Vector3d& x) { return 2 + std::sin(0.4 * x.x()); })));
    target.set_thickness(to_vector(at_feet(surface, [](const Vector3d& x) { return 1 + 0.5 * std::cos(x.y()); })));
    contact.source = &source;
    contact.target = &target;
    contact.area = areas(*mesh);
    overlap =
        at_feet(surface, [](const Vector3d& x) { return 0.1 + 0.2 * std::sin(0.7 * x.x()) * std::cos(0.6 * x.y()); });
    for (int i = 0; i < mesh->feet(); i += 7) contact.area[i] *= 0.3;  // partly over the target
    for (int i = 0; i < mesh->feet(); i += 11) contact.area[i] = 0.0;  // not at all
  }
};

// The conditions themselves, for compliances from mild to nearly incompressible, from nothing and from a wrong guess.
TEST(LayerContact, MeetsItsConditions) {
  for (double nu : {0.2, 0.3, 0.45, 0.4999}) {
    for (LayerFit fit : kFits) {
      Bumpy b(24, nu, fit);
      const LayerPressure r = solve_contact(b.contact, b.overlap);
      ASSERT_TRUE(r.converged) << nu << " " << name(fit);
      EXPECT_LT(r.applications, 120) << nu << " " << name(fit);
      const VectorXd w = sinking(b.contact, r.pressure).col(0), local = local_compliance(b.contact);
      const double peak = r.pressure.maxCoeff();
      int active = 0, bulged = 0;
      for (int i = 0; i < w.size(); ++i) {
        const double missing = (w[i] - b.overlap[i]) / local[i] / peak;
        EXPECT_GE(r.pressure[i], 0);
        if (b.contact.area[i] == 0) {
          EXPECT_EQ(r.pressure[i], 0);
          continue;
        }
        EXPECT_GT(missing, -2e-9);
        if (r.pressure[i] > 2e-9 * peak) {
          EXPECT_NEAR(missing, 0, 2e-9);
        }
        active += r.active[static_cast<std::size_t>(i)];
        bulged += r.pressure[i] > 0 && b.overlap[i] < 0;
      }
      EXPECT_GT(active, 100);
      EXPECT_LT(active, w.size() - 100);
      if (nu > 0.4) {
        EXPECT_GT(bulged, 0);
      }  // touches where the springs would be apart
      const LayerPressure again = solve_contact(b.contact, b.overlap, VectorXd::Constant(w.size(), 3.0));
      EXPECT_LT((again.pressure - r.pressure).lpNorm<Eigen::Infinity>() / peak, 1e-7) << nu << " " << name(fit);
      const LayerPressure warm = solve_contact(b.contact, b.overlap, r.pressure);
      EXPECT_EQ(warm.applications, 2);  // the residual, and the same again for certain
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
    const LayerPressure r = solve_contact(b.contact, b.overlap, {}, {1e-13, 1000});
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
    const MatrixXd dense = C.partialPivLu().solve(MatrixXd(motions(active, Eigen::all)));
    EXPECT_LT((rates.pressure(active, Eigen::all) - dense).norm() / dense.norm(), 1e-9);
    // central differences: in the mean over feet whose neighbours do not change sides
    for (int c = 0; c < 3; ++c) {
      const double d = 1e-7;
      const VectorXd difference =
          (solve_contact(b.contact, b.overlap + d * motions.col(c), r.pressure, {1e-13, 1000}).pressure -
           solve_contact(b.contact, b.overlap - d * motions.col(c), r.pressure, {1e-13, 1000}).pressure) /
          (2 * d);
      EXPECT_LT((difference - rates.pressure.col(c)).norm() / difference.norm(), 1e-3) << c;
    }
  }
}

TEST(LayerContact, DoesNotDependOnThreads) {
  VectorXd p[2];
  for (const int threads : {1, 2}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    Bumpy b(20, 0.45, LayerFit::TwoTerms);
    p[threads - 1] = solve_contact(b.contact, b.overlap).pressure;
  }
  EXPECT_EQ((p[0] - p[1]).lpNorm<Eigen::Infinity>(), 0);
}

// A ball in a hemispherical socket of 4 mm cartilage (rigid radii 20 and 24 mm), moved by u: the overlap u cos(theta)
// is a spherical harmonic of the sphere, and with q = 0 on the rim it stays one, so p keeps its shape to the rim and is
// the bed of springs' at the same force, 2.3873 cos(theta) at 2000 N. Errors relative to the peak. With two
// terms the edge is softer than that (L7), for half a thickness.
TEST(LayerContact, HemispheresKeepTheCosine) {
  for (LayerFit fit : kFits) {
    const auto error = [&](int n, Rim rim) {
      const SurfaceMesh surface = test::hemisphere(n, 20.0);
      const auto mesh = std::make_shared<LayerMesh>(make_layer_mesh(surface));
      LayerOperator layer(mesh, layer_law({kE, 0.45}, fit), std::vector<Rim>(mesh->rim.size(), rim));
      layer.set_thickness(std::vector<double>(mesh->area.size(), 4.0));
      LayerContact contact;
      contact.source = &layer;
      contact.area = areas(*mesh);
      const VectorXd cosine = at_feet(surface, [](const Vector3d& x) { return x.z() / x.norm(); });
      const LayerPressure r = solve_contact(contact, 0.1 * cosine);
      EXPECT_TRUE(r.converged);
      const double p_0 = (contact.area.array() * r.pressure.array() * cosine.array()).sum() / (2 * kPi * 400 / 3);
      return (r.pressure / p_0 - cosine).lpNorm<Eigen::Infinity>();
    };
    EXPECT_LT(error(30, Rim::Free), fit == LayerFit::OneTerm ? 0.02 : 0.035) << name(fit);
    EXPECT_LT(error(60, Rim::Free), fit == LayerFit::OneTerm ? 0.01 : 0.03) << name(fit);
    EXPECT_GT(error(30, Rim::Wall), 0.10) << name(fit);  // walled in, it is another problem
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
    const auto mesh = std::make_shared<LayerMesh>(make_layer_mesh(surface));
    const std::vector<Rim> rim = test::rim_where(surface, *mesh, [&](const Vector3d& x) {
      return x.x() > 0.9999 * length || (!row.cylinder && x.y() > 0.9999 * length) ? Rim::Continues : Rim::Wall;
    });
    for (std::size_t k = 0; k < 2; ++k) {
      const LayerLaw law = layer_law({kE, row.nu}, kFits[k]);
      LayerOperator source(mesh, law, rim), target(mesh, law, rim);
      source.set_thickness(std::vector<double>(mesh->area.size(), t_s));
      target.set_thickness(std::vector<double>(mesh->area.size(), t_t));
      LayerContact contact;
      contact.source = &source;
      if (row.two_layers) contact.target = &target;
      contact.area = areas(*mesh);
      const LayerPressure r =
          solve_contact(contact, at_feet(surface, [&](const Vector3d& x) {
                          return row.depth - (x.x() * x.x() + (row.cylinder ? 0 : x.y() * x.y())) / (2 * R);
                        }));
      ASSERT_TRUE(r.converged);
      double area = 0;
      for (int i = 0; i < mesh->feet(); ++i) area += r.active[static_cast<std::size_t>(i)] * contact.area[i];
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
        const auto mesh = std::make_shared<LayerMesh>(make_layer_mesh(surface));
        LayerOperator layer(mesh, layer_law({E, row.nu}, kFits[fit]),
                            test::rim_where(surface, *mesh, [&](const Vector3d& x) {
                              return x.x() > 0.9999 * length ? end : Rim::Wall;
                            }));
        layer.set_thickness(to_vector(at_feet(surface, [&](const Vector3d& x) { return thickness(x.x()); })));
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
  const auto mesh = std::make_shared<LayerMesh>(make_layer_mesh(surface));
  const std::vector<Rim> walls(mesh->rim.size(), Rim::Wall);
  for (const Elasticity& other : {Elasticity{kE, 0.45}, Elasticity{30.0, 0.3}}) {
    const Elasticity soft{kE, 0.45};
    LayerOperator source(mesh, layer_law(soft, LayerFit::OneTerm), walls),
        target(mesh, layer_law(other, LayerFit::TwoTerms), walls);
    source.set_thickness(std::vector<double>(mesh->area.size(), 1.2));
    target.set_thickness(std::vector<double>(mesh->area.size(), 2.1));
    LayerContact contact;
    contact.source = &source;
    contact.target = &target;
    contact.area = areas(*mesh);
    for (Law law : {Law::Linear, Law::NeoHookean, Law::Logarithmic}) {
      const LayerSprings r = solve_layer_springs(contact, law, soft, other, VectorXd::Constant(mesh->feet(), 1.1));
      ASSERT_TRUE(r.linear.converged) << name(law);
      EXPECT_LE(r.repetitions, 20);
      const SpringResponse spring = spring_response(law, soft, other, 1.2, 2.1, 1.1);
      for (const SpringResponse& foot : r.springs) EXPECT_NEAR(foot.pressure / spring.pressure, 1, 1e-6) << name(law);
    }
  }
  // not so long waves, small strains: the linear law
  Bumpy b(16, 0.45, LayerFit::OneTerm);
  const LayerPressure linear = solve_contact(b.contact, 1e-5 * b.overlap);
  const LayerSprings large = solve_layer_springs(b.contact, Law::NeoHookean, {kE, 0.45}, {kE, 0.45}, 1e-5 * b.overlap);
  EXPECT_EQ(large.repetitions, 1);
  for (int i = 0; i < b.overlap.size(); ++i)
    EXPECT_NEAR(large.springs[static_cast<std::size_t>(i)].pressure, linear.pressure[i],
                1e-4 * linear.pressure.maxCoeff());
}

}  // namespace
}  // namespace dea

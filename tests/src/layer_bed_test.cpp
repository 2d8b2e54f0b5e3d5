// The layer law wired into springs and equilibrium: answers on paper, derivative, symmetry, invariance.
#include "src/springs/layer_bed.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "src/base/error.h"
#include "src/base/parallel.h"
#include "src/run/analysis.h"
#include "src/springs/place.h"
#include "src/springs/press.h"
#include "src/springs/wrench.h"
#include "tests/analytic/neo_hookean_layer.h"
#include "tests/src/finite_differences.h"
#include "tests/src/test_models.h"

namespace dea::layer_bed_test {

using namespace test;

Settings layer_settings(LayerFit fit = LayerFit::TwoTerms) {
  Settings s;
  s.law = Law::Layer;
  s.layer_fit = fit;
  return s;
}

Pose at_rest(const Body& body) { return {body.center_of_mass, Eigen::Matrix3d::Identity()}; }

/// A plate pressed `depth` into a flat layer: the springs of the only contact.
SpringStates pressed(const JointModel& model, const Settings& settings, double depth) {
  const Joint joint = make_joint(model, settings);
  const SpringBeds beds = make_spring_beds(joint);
  const SpringBed& bed = beds.beds[0];
  Pose source = at_rest(joint.bodies[static_cast<std::size_t>(bed.source_body)]),
       target = at_rest(joint.bodies[static_cast<std::size_t>(bed.target_body)]);
  target.center.z() -= depth;
  return press_springs(bed, source, target);
}

/// A layer 7 wide on one that reaches `beyond` further on all sides, both 2 thick; the upper one, which has the
/// springs, is pressed 0.2 into it. Force per quarter of the upper rim's facets, and of all.
struct RimForces {
  double side[4] = {0, 0, 0, 0};
  double total = 0.0;
};
RimForces on_a_wider_layer(double beyond, int refine) {
  constexpr double kWidth = 7.0, kThick = 2.0;
  JointModel model = empty_model();
  const int cartilage = add_material(model, "cartilage", false), base = add_material(model, "base", true),
            top = add_material(model, "top", true);
  const double wide = kWidth + 2 * beyond;
  const int lower = add_layer(
      model, "lower", static_cast<int>(wide / 0.79), static_cast<int>(wide / 0.79), 1,
      [=](double u, double v) { return Vector3d(wide * (u - 0.5), wide * (v - 0.5), -kThick); },
      [=](double u, double v) { return Vector3d(wide * (u - 0.5), wide * (v - 0.5), 0); }, cartilage, base);
  const int upper = add_layer(
      model, "upper", 12, 12, 1,
      [=](double u, double v) { return Vector3d(kWidth * (v - 0.5), kWidth * (u - 0.5), kThick); },
      [=](double u, double v) { return Vector3d(kWidth * (v - 0.5), kWidth * (u - 0.5), 0); }, cartilage, top);
  add_contact(model, "press", upper, lower);
  Settings settings = layer_settings();
  settings.refine = refine;
  const SpringStates s = pressed(model, settings, -0.2);
  RimForces forces;
  for (int f = 0; f < s.size(); ++f) {
    const Vector3d& x = s.foot[static_cast<std::size_t>(f)];
    const double force = s.pressure[static_cast<std::size_t>(f)] * s.area[static_cast<std::size_t>(f)];
    forces.total += force;
    const double inner = 0.5 * kWidth - kWidth / 12;
    if (x.x() > inner) forces.side[0] += force;
    if (x.x() < -inner) forces.side[1] += force;
    if (x.y() > inner) forces.side[2] += force;
    if (x.y() < -inner) forces.side[3] += force;
  }
  return forces;
}

/// Holds the nodes on the layer's sides in the direction of their plane's normal, as symmetry planes do.
void wall_in(JointModel& model, double size) {
  for (int k = 0; k < 2; ++k) {
    FixedNodes plane;
    plane.xyz[static_cast<std::size_t>(k)] = true;
    for (std::size_t i = 0; i < model.nodes.size(); ++i)
      if (std::abs(std::abs(model.nodes[i][k]) - size / 2) < 1e-9 && model.nodes[i].z() <= 0)
        plane.nodes.push_back(static_cast<int>(i));
    model.fixed_nodes.push_back(plane);
  }
}

// What the target is beyond the source's rim counts as what it is: the more of it the less gives way, ever less so, and
// without a step. The same on all sides, for any triangles and rounding.
TEST(LayerRim, IsTheSameOnAllSidesAndForAnyRefinement) {
  double before = 0.0, rise = 1e300;
  for (const double beyond : {1.0, 2.0, 3.0, 4.0, 5.0}) {
    const RimForces coarse = on_a_wider_layer(beyond, 1);
    EXPECT_GT(coarse.total, 30.0);
    for (const int refine : {1, 2, 3}) {
      SCOPED_TRACE(fmt::format("{} beyond, refine {}", beyond, refine));
      const RimForces forces = on_a_wider_layer(beyond, refine);
      for (const double side : forces.side) EXPECT_NEAR(side, forces.side[0], 0.02 * forces.side[0]);
      EXPECT_NEAR(forces.total, coarse.total, 0.015 * coarse.total);
    }
    if (before > 0) {
      EXPECT_GT(coarse.total, before);
      EXPECT_LT(coarse.total - before, 0.7 * rise);
      rise = coarse.total - before;
    }
    before = coarse.total;
  }
  EXPECT_LT(rise, 0.005 * before);
  for (const double beyond : {1.0, 2.0, 2.5, 3.0})
    EXPECT_NEAR(on_a_wider_layer(beyond + 0.01, 1).total / on_a_wider_layer(beyond, 1).total, 1, 1e-3) << beyond;
}

/// A domed layer, 2 thick, pressed 0.3 into a flat one, 1.5 thick; their facets are unlike. The springs stand on the
/// dome or, `swapped`, on the flat layer.
struct Domed {
  JointModel model = empty_model();
  explicit Domed(bool swapped) {
    const int cartilage = add_material(model, "cartilage", false), base = add_material(model, "base", true),
              top = add_material(model, "top", true);
    const int flat = add_layer(
        model, "flat", 23, 23, 1, [](double u, double v) { return Vector3d(16 * u - 8, 16 * v - 8, -1.5); },
        [](double u, double v) { return Vector3d(16 * u - 8, 16 * v - 8, 0); }, cartilage, base);
    const auto dome = [](double above) {
      return [=](double u, double v) {
        const double a = 14 * (v - 0.5), b = 14 * (u - 0.5), x = 0.8 * a - 0.6 * b, y = 0.6 * a + 0.8 * b;
        return Vector3d(x, y, above + (x * x + y * y) / 80);
      };
    };
    const int domed = add_layer(model, "dome", 20, 20, 1, dome(2), dome(0), cartilage, top);
    add_contact(model, "press", swapped ? flat : domed, swapped ? domed : flat);
  }
};

// What of the target the feet stand on is what they cover, whatever the facets; and who has the springs matters by the
// discretisation only.
TEST(LayerBed, FeetOnTheTarget) {
  double force[2], peak[2];
  for (const bool swapped : {false, true})
    for (const int refine : {1, 2}) {
      Domed domed(swapped);
      Settings settings = layer_settings();
      settings.refine = refine;
      const Joint joint = make_joint(domed.model, settings);
      const SpringBeds beds = make_spring_beds(joint);
      const SpringBed& bed = beds.beds[0];
      Pose source = at_rest(joint.bodies[static_cast<std::size_t>(bed.source_body)]),
           target = at_rest(joint.bodies[static_cast<std::size_t>(bed.target_body)]);
      target.center.z() += swapped ? -0.3 : 0.3;
      target.rotation = Eigen::AngleAxisd(0.013, Vector3d(1, 2, 0).normalized()).toRotationMatrix();
      const SpringStates s = press_springs(bed, source, target);
      const LayerFeet feet = feet_on_target(bed, s, source, target, 1e9);
      double total = 0, most = 0;
      for (int i = 0; i < s.size(); ++i) {
        const auto k = static_cast<std::size_t>(i);
        EXPECT_EQ(feet.area[k] > 0, s.area[k] > 0 && s.triangle[k] >= 0) << i;
        if (feet.area[k] == 0) continue;
        EXPECT_NEAR(feet.area[k], s.area[k], 1e-12);
        EXPECT_NEAR(feet.thickness(i), s.t_target[k], 0.03 * s.t_target[k]);
        double weight = 0;
        for (int j = feet.begin[k]; j < feet.begin[k + 1]; ++j) weight += feet.weight[static_cast<std::size_t>(j)];
        EXPECT_NEAR(weight, feet.volume[k], 1e-12);
        total += s.pressure[k] * s.area[k];
        most = std::max(most, s.pressure[k]);
      }
      if (refine == 2) continue;
      force[swapped] = total;
      peak[swapped] = most;
    }
  EXPECT_GT(force[0], 20.0);
  EXPECT_NEAR(force[1] / force[0], 1, 0.02);
  EXPECT_NEAR(peak[1] / peak[0], 1, 0.02);
}

// A strip with a free end under a rigid flat, or a cylinder whose axis is over its middle, that reach over the end:
// force per length against neo-Hookean elements, which know nothing of what bulges out but that it touches. Within 4%
// for a tenth of the thickness.
TEST(LayerBed, WhatBulgesOutOverAFreeEdgeIsPressedToo) {
  const double t = 2, length = 8, width = 0.6;
  for (const double nu : {0.3, 0.4, 0.45})
    for (const double radius : {0.0, 240.0}) {
      analytic::NeoHookeanLayer elements;
      elements.nu = nu;
      elements.thickness = t;
      analytic::LayerGrid grid;
      grid.fine_length = 0.75 * length;  // so the others are as long
      grid.length = length;
      grid.fine = 24;
      grid.coarse = 8;
      grid.through = 6;
      const double sagitta = radius > 0 ? radius - std::sqrt(radius * radius - length * length) : 0.0;
      const std::vector<double> depths = {sagitta + 0.05 * t, sagitta + 0.1 * t};
      const auto exact = analytic::press_rigid(false, elements, radius > 0 ? 1 / radius : 0.0, depths, grid, 0.01);
      JointModel model = empty_model();
      const int cartilage = add_material(model, "cartilage", false, elements.E, nu),
                base = add_material(model, "base", true), punch = add_material(model, "punch", true);
      const int layer = add_layer(
          model, "layer", 13, 1, 1, [=](double u, double v) { return Vector3d(length * u, width * v, -t); },
          [=](double u, double v) { return Vector3d(length * u, width * v, 0); }, cartilage, base);
      const int rigid = add_rigid_surface(
          model, "punch", 60, 2,
          [=](double v, double u) {
            const double x = 1.3 * length * u, z = radius > 0 ? radius - std::sqrt(radius * radius - x * x) : 0.0;
            return Vector3d(x, 1.4 * width * (v - 0.15), z);
          },
          punch);
      add_contact(model, "press", layer, rigid);
      for (int k = 0; k < 2; ++k) {  // the middle, and the slice's sides
        FixedNodes plane;
        plane.xyz[at(k)] = true;
        for (std::size_t i = 0; i < model.nodes.size(); ++i) {
          const Vector3d& x = model.nodes[i];
          const bool on = k == 0 ? std::abs(x.x()) < 1e-9 : std::abs(x.y()) < 1e-9 || std::abs(x.y() - width) < 1e-9;
          if (on && x.z() <= 0 && x.z() >= -t) plane.nodes.push_back(static_cast<int>(i));
        }
        model.fixed_nodes.push_back(plane);
      }
      for (std::size_t d = 0; d < depths.size(); ++d) {
        const SpringStates s = pressed(model, layer_settings(), depths[d]);
        double force = 0, without = 0;
        for (std::size_t k = 0; k < at(s.size()); ++k) {
          force += s.force(k) * 2 / width;
          without += s.pressure[k] * s.area[k] * 2 / width;
        }
        const std::string what =
            fmt::format("nu {} radius {} depth {}: {} {} of {}", nu, radius, depths[d], force, without, exact[d].force);
        EXPECT_NEAR(force / exact[d].force, 1, 0.04) << what;
        if (radius == 0) {
          EXPECT_LT(force - without, exact[d].force - without + 0.01 * exact[d].force) << what;
          EXPECT_GT(force, 1.006 * without) << what;
        }
      }
    }
}

TEST(LayerBed, WalledInLayerIsConfined) {
  // between planes of symmetry nothing flows sideways: the confined response (S6), the same everywhere
  JointModel model = flat_plates(8, 10, 2, 0.0, 12);
  wall_in(model, 10);
  for (const LayerFit fit : {LayerFit::OneTerm, LayerFit::TwoTerms}) {
    const SpringStates s = pressed(model, layer_settings(fit), 0.3);
    const double p = layer_response(Law::NeoHookean, {kE, kNu}, 0.15).pressure;
    for (int i = 0; i < s.size(); ++i) EXPECT_NEAR(s.pressure[static_cast<std::size_t>(i)], p, 1e-7 * p);
  }
}

TEST(LayerBed, FreeEdgesLetTheLayerEscape) {
  // without walls the same layer is softer, most of all at its edges, and nowhere stiffer
  const JointModel model = flat_plates(8, 10, 2, 0.0, 12);
  const double confined = layer_response(Law::NeoHookean, {kE, kNu}, 0.15).pressure;
  const SpringStates s = pressed(model, layer_settings(), 0.3);
  double middle = 0.0, edge = 1e300;
  for (int i = 0; i < s.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    EXPECT_LT(s.pressure[k], confined);
    EXPECT_GT(s.pressure[k], 0.0);
    const double from_middle = std::max(std::abs(s.foot[k].x()), std::abs(s.foot[k].y()));
    if (from_middle < 1) middle = std::max(middle, s.pressure[k]);
    if (from_middle > 4) edge = std::min(edge, s.pressure[k]);
  }
  EXPECT_GT(middle, 1.5 * edge);
}

// A nearly incompressible layer that can escape to its sides carries little of what confines it, but its strain is what
// it is pressed together by: 95% of its thickness is beyond the limit.
TEST(LayerBed, StrainIsTheShorteningOverTheThickness) {
  JointModel model = flat_plates(8, 10, 2, 0.0, 12);
  model.materials[0].nu = 0.499;
  const SpringStates s = pressed(model, layer_settings(), 1.9);
  EXPECT_TRUE(s.complementary);
  for (int i = 0; i < s.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    EXPECT_NEAR(s.strain[k], 0.95, 1e-6);
    EXPECT_LT(strain_at_pressure(Law::NeoHookean, {kE, 0.499}, s.pressure[k]), 0.8);
  }
  EXPECT_EQ(spring_depth(s).strained, s.size());
  prescribe(model, 2, 2, -1.9);
  fix(model, 2, {true, true, false, true, true, true});
  const Analysis analysis = analyse(model, layer_settings());
  EXPECT_EQ(analysis.states.back().equilibrium.outcome, Outcome::BeyondStrainLimit);
  model.rigid_prescribed[0].value.factor = -0.6;
  EXPECT_NE(analyse(model, layer_settings()).states.back().equilibrium.outcome, Outcome::BeyondStrainLimit);
}

TEST(LayerBed, InterfaceIsInSeries) {
  // small strain, walled in: 1/k = h/M + c
  JointModel model = flat_plates(4, 10, 2, 0.0, 12);
  wall_in(model, 10);
  const double depth = 1e-6, M = confined_modulus(kE, kNu);
  for (const Law law : {Law::Linear, Law::Logarithmic, Law::NeoHookean, Law::Layer}) {
    Settings settings = layer_settings();
    settings.law = law;
    settings.interface_stiffness = 20.0;
    const SpringStates s = pressed(model, settings, depth);
    EXPECT_NEAR(s.pressure[0], depth / (2 / M + 1 / 20.0), 1e-5 * s.pressure[0]) << name(law);
  }
}

/// Concentric spheres under a small load: cos(theta) to the rim, and the size of (7.1): the layer's bulge escapes
/// there.
TEST(LayerBed, ConcentricSpheresKeepTheCosine) {
  const JointModel model = concentric_spheres(24, 200);
  Settings settings = layer_settings(LayerFit::OneTerm);
  const Analysis linear = analyse(model, test::linear()), layer = analyse(model, settings);
  const StateResult& state = layer.states.back();
  EXPECT_EQ(state.equilibrium.outcome, Outcome::Balanced) << state.equilibrium.message;
  EXPECT_LT(state.equilibrium.residual_force, 1e-8 * 200);
  EXPECT_LE(state.statistics[0].complementarity, 1e-9);
  EXPECT_NEAR(state.statistics[0].peak, linear.states.back().statistics[0].peak,
              0.012 * linear.states.back().statistics[0].peak);
  const std::vector<double>&p = state.fields[0].sides[0].pressure,
        &q = linear.states.back().fields[0].sides[0].pressure;
  for (std::size_t f = 0; f < p.size(); ++f) EXPECT_NEAR(p[f], q[f], 0.03 * state.statistics[0].peak);
}

/// Forces and moments against central differences. The active set and the target's thickness under the springs are held
/// in the derivative, hence the tolerance.
TEST(LayerBed, DerivativeMeetsFiniteDifferences) {
  JointModel model = flat_plates(12, 10, 2, 0.0, 14);
  for (std::size_t i = 0; i < model.nodes.size(); ++i)  // a bowl, so that the plate's edge and tilt matter
    if (model.nodes[i].z() == 0 && std::abs(model.nodes[i].x()) <= 5)
      model.nodes[i].z() = -0.004 * model.nodes[i].squaredNorm();
  for (const LayerFit fit : {LayerFit::OneTerm, LayerFit::TwoTerms}) {
    const Joint joint = make_joint(model, layer_settings(fit));
    const SpringBeds beds = make_spring_beds(joint);
    const SpringBed& bed = beds.beds[0];
    Pose s = at_rest(joint.bodies[static_cast<std::size_t>(bed.source_body)]),
         t = at_rest(joint.bodies[static_cast<std::size_t>(bed.target_body)]);
    t.center.z() -= 0.15;
    t.rotation = Eigen::AngleAxisd(0.01, Vector3d::UnitX()).toRotationMatrix();
    const ContactWrench w = contact_wrench(press_springs(bed, s, t), s, t);
    ASSERT_GT(w.normal_force, 10.0);
    const Eigen::Matrix<double, 12, 12> numeric = test::numeric_derivative(bed, s, t, 1e-5);
    // compare in units of force per length
    Eigen::Matrix<double, 12, 1> scale = Eigen::Matrix<double, 12, 1>::Ones();
    scale.segment<3>(3).setConstant(1 / beds.length);
    scale.segment<3>(9).setConstant(1 / beds.length);
    const Eigen::Matrix<double, 12, 12> a = scale.asDiagonal() * w.derivative * scale.asDiagonal(),
                                        b = scale.asDiagonal() * numeric * scale.asDiagonal();
    EXPECT_LT((a - b).norm(), 0.01 * b.norm()) << name(fit);
  }
}

TEST(LayerBed, PressureIsNeverNegativeAndThreadsDoNotMatter) {
  const JointModel model = concentric_spheres(12, 500, true, 3);
  std::vector<std::vector<double>> pressures;
  for (const int threads : {1, 3}) {
    const auto control = limit_threads(threads);
    const Analysis analysis = analyse(model, layer_settings());
    for (const StateResult& state : analysis.states) {
      EXPECT_TRUE(solved(state.equilibrium.outcome)) << state.equilibrium.message;
      for (const SideFields& side : state.fields[0].sides)
        for (double p : side.pressure) EXPECT_GE(p, 0.0);
    }
    pressures.push_back(analysis.states.back().fields[0].sides[1].pressure);
  }
  EXPECT_EQ(pressures[0], pressures[1]);
}

/// The whole map moves with the model.
// Four callers press one bed at poses of their own, at the same time: the bits of one after the other. A copy of the
// bed serves as well when the first is gone.
TEST(LayerBed, OneBedServesManyCallersAtATime) {
  const JointModel model = concentric_spheres(12, 500, true, 3);
  const Joint joint = make_joint(model, layer_settings());
  SpringBeds beds = make_spring_beds(joint);
  const SpringBed bed = beds.beds[0];
  beds = {};
  constexpr int kCallers = 4, kPoses = 3;
  using Pressures = std::array<std::vector<double>, kPoses>;
  const auto press = [&](int caller, Pressures& pressures) {
    PressMemory memory;
    for (int i = 0; i < kPoses; ++i) {
      Pose source = at_rest(joint.bodies[static_cast<std::size_t>(bed.source_body)]),
           target = at_rest(joint.bodies[static_cast<std::size_t>(bed.target_body)]);
      target.center += Vector3d(0.01 * caller, 0.005 * i, -0.02 * (i + 1));
      pressures[static_cast<std::size_t>(i)] = press_springs(bed, source, target, {}, &memory).pressure;
    }
  };
  std::array<Pressures, kCallers> alone, together;
  for (int c = 0; c < kCallers; ++c) press(c, alone[static_cast<std::size_t>(c)]);
  std::vector<std::thread> threads;
  for (int c = 0; c < kCallers; ++c) threads.emplace_back([&, c] { press(c, together[static_cast<std::size_t>(c)]); });
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(alone, together);
  EXPECT_GT(*std::max_element(alone[3][2].begin(), alone[3][2].end()), 0.0);
}

// What was solved before does not matter, nor do other analyses that run at the same time.
TEST(LayerBed, AnalysesDoNotFeelEachOther) {
  const JointModel one = concentric_spheres(12, 500, true, 3), two = concentric_spheres(10, 300, false, 2);
  const auto last = [](const JointModel& model) {
    return analyse(model, layer_settings()).states.back().fields[0].sides[1].pressure;
  };
  const auto alone_one = last(one), alone_two = last(two);
  std::vector<double> with_one, with_two;
  std::thread first([&] { with_one = last(one); }), second([&] { with_two = last(two); });
  first.join();
  second.join();
  EXPECT_EQ(alone_one, with_one);
  EXPECT_EQ(alone_two, with_two);
}

TEST(LayerBed, RigidMotionOfTheModel) {
  const JointModel model = concentric_spheres(10, 300, true);
  JointModel turned = model;
  const Eigen::Matrix3d R = Eigen::AngleAxisd(1.1, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  for (Vector3d& x : turned.nodes) x = R * x + Vector3d(3, -40, 7);
  for (Material& m : turned.materials)
    if (m.center_of_mass) m.center_of_mass = Vector3d(R * *m.center_of_mass + Vector3d(3, -40, 7));
  turned.rigid_loads.clear();
  force(turned, 2, R * Vector3d(0, 0, 300));
  const ContactStatistics a = analyse(model, layer_settings()).states.back().statistics[0],
                          b = analyse(turned, layer_settings()).states.back().statistics[0];
  EXPECT_NEAR(a.peak, b.peak, 1e-6 * a.peak);
  EXPECT_NEAR(a.mean, b.mean, 1e-6 * a.mean);
  EXPECT_NEAR(a.contact_area, b.contact_area, 1e-9 * a.contact_area);
}

TEST(LayerBed, NeedsArticularSprings) {
  Settings settings = layer_settings();
  settings.springs_at = SpringsAt::Bone;
  EXPECT_THROW(make_joint(concentric_spheres(4, 100), settings), UsageError);
  settings.law.reset();  // what nobody asked for gives way
  EXPECT_EQ(make_joint(concentric_spheres(8, 100, true), settings).contacts[0].law, Law::Linear);
  settings.springs_at = SpringsAt::Articular;
  EXPECT_EQ(make_joint(concentric_spheres(8, 100, true), settings).contacts[0].law, Law::Layer);
}

}  // namespace dea::layer_bed_test

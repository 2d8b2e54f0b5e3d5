// Joints whose map once looked right and was wrong: selections that slip, planes of symmetry, free edges, deep strain,
// rough surfaces. Each by a stored model (when present) and by another of its kind made here.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>

#include <febiodea/base/numbers.h>
#include <febiodea/io/feb/read_feb.h>
#include <febiodea/run/analysis.h>
#include <febiodea/views/text/remarks.h>
#include "program.h"
#include "src/test_models.h"

namespace dea {
namespace {

namespace fs = std::filesystem;
using test::Patch;

const fs::path kCases = DEA_CASES_DIR;

struct Solved {
  StateResult state;
  double force = 0.0, peak = 0.0;
  std::vector<double> facet_force[2];  // per facet of primary, secondary
};

Solved solve(const JointModel& model, const Settings& settings) {
  const Analysis analysis = analyse(model, settings);
  Solved solved;
  solved.state = analysis.states.back();
  solved.force = solved.state.statistics[0].force.norm();
  solved.peak = solved.state.statistics[0].peak;
  for (int side = 0; side < 2; ++side) {
    const SurfaceMesh& mesh = analysis.joint.contacts[0].layers[side].articular;
    solved.facet_force[side].assign(at(mesh.facets), 0.0);
    for (int t = 0; t < mesh.size(); ++t)
      solved.facet_force[side][at(mesh.facet[at(t)])] +=
          mesh.areas[at(t)] * solved.state.fields[0].sides[side].pressure[at(mesh.facet[at(t)])];
  }
  return solved;
}

Solved solve(const std::string& name, double nu, int refine = 1) {
  const JointModel model = read_feb((kCases / name).string());
  Settings settings;
  settings.refine = refine;
  if (nu > 0) settings.nu["lay_art"] = nu;
  return solve(model, settings);
}

/// 1 %: half a row of springs at the contact's edge, where the pressure vanishes.
void expect_the_same(const std::string& name, const std::string& other_name, double nu) {
  const Solved a = solve(name, nu), b = solve(other_name, nu);
  EXPECT_NEAR(b.force / a.force, 1, 0.01) << nu;
  EXPECT_NEAR(b.peak / a.peak, 1, 0.01) << nu;
}

#define NEEDS_CASES() \
  if (!fs::is_directory(kCases)) GTEST_SKIP() << "no " << kCases

const double kNus[] = {0.45, 0.49};

/// Pressed by a rigid body: the facets of the articular surface that are selected, and what else the model has.
struct Pressed {
  JointModel model = test::empty_model();
  int cartilage = test::add_material(model, "cartilage", false, 10, 0.45),
      base = test::add_material(model, "base", true), body = test::add_material(model, "body", true);
  int layer = -1, indenter = -1;
  Settings settings;

  Pressed(int nu, int nv, const Patch& bone, const Patch& articular, int n, const Patch& rigid, double depth,
          double poisson)
      : layer(test::add_layer(model, "layer", nu, nv, 2, bone, articular, cartilage, base)),
        indenter(test::add_rigid_surface(
            model, "rigid", n, n, [&](double u, double v) { return rigid(v, u); }, body)) {
    test::fix(model, base, {true, true, true, true, true, true});
    test::fix(model, body, {true, true, false, true, true, true});
    test::prescribe(model, body, 2, -depth);
    settings.nu["layer"] = poisson;
  }
  Pressed(const Pressed&) = delete;
  Pressed& operator=(const Pressed&) = delete;

  Vector3d center(const Surface& s, int f) const {
    Vector3d sum = Vector3d::Zero();
    for (int k = 4 * f; k < 4 * f + 4; ++k) sum += model.nodes[at(s.nodes[at(k)])] / 4;
    return sum;
  }
  /// Leaves facets out of the selection.
  void forget(const std::function<bool(const Vector3d&)>& which) {
    Surface& s = model.surfaces[at(layer)];
    Surface kept = s;
    kept.nodes.clear();
    kept.begin = {0};
    for (int f = 0; f < s.size(); ++f) {
      if (which(center(s, f))) continue;
      kept.nodes.insert(kept.nodes.end(), s.nodes.begin() + 4 * f, s.nodes.begin() + 4 * f + 4);
      kept.begin.push_back(static_cast<int>(kept.nodes.size()));
    }
    s = kept;
  }
  Solved run(bool layer_first = true) {
    JointModel with_contact = model;
    test::add_contact(with_contact, "press", layer_first ? layer : indenter, layer_first ? indenter : layer);
    return solve(with_contact, settings);
  }
};

/// Slab of thickness 2 from x = `from` to 14, y = -14 to 14, under a paraboloid of radius 100 that touches at the
/// origin and is pressed in by 0.05: contact radius about 3.2.
struct SlabUnderBall : Pressed {
  static constexpr int kN = 56;  // facets of 0.5

  explicit SlabUnderBall(double poisson, double from = -14)
      : Pressed(
            static_cast<int>((14 - from) * 2), kN, [=](double u, double v) { return place(u, v, from, -2); },
            [=](double u, double v) { return place(u, v, from, 0); }, kN,
            [=](double u, double v) {
              const Vector3d x = place(u, v, from, 0);
              return Vector3d(x.x(), x.y(), x.head<2>().squaredNorm() / 200);
            },
            0.05, poisson) {
    if (from < 0) return;
    FixedNodes fixed;
    fixed.xyz = {true, false, false};
    // the rigid bodies' nodes are theirs
    std::vector<char> rigid(model.nodes.size(), 0);
    for (const Domain& d : model.domains)
      if (d.material != cartilage)
        for (int node : d.nodes) rigid[at(node)] = 1;
    for (int i = 0; i < static_cast<int>(model.nodes.size()); ++i)
      if (!rigid[at(i)] && std::abs(model.nodes[at(i)].x() - from) < 1e-9) fixed.nodes.push_back(i);
    model.fixed_nodes.push_back(fixed);
  }
  static Vector3d place(double u, double v, double from, double z) {
    return {from + (14 - from) * u, 28 * (v - 0.5), z};
  }
};

// ---- planes of symmetry

// Layer first or rigid body first: what differs is whose facets carry the springs.
TEST(KnownAnswers, QuarterModelEitherWayRound) {
  NEEDS_CASES();
  for (double nu : kNus) expect_the_same("quarter.feb", "quarter_rigid_primary.feb", nu);
}

// Two contacts side by side, each with half of the facets that a ball presses: by symmetry each is half of the whole,
// whichever body carries the springs. Where the layer goes on without load beside the line they share (as from a
// contact of other bodies), the peak is a punch's, far too high.
TEST(KnownAnswers, TwoHalvesOfAContactAreTheWhole) {
  for (double nu : kNus) {
    const SlabUnderBall slab(nu);
    SlabUnderBall halves(nu);
    const Solved whole = SlabUnderBall(nu).run();
    const auto half = [&](const char* name, bool right) {
      const Surface& s = slab.model.surfaces[at(slab.layer)];
      Surface part;
      part.name = name;
      for (int f = 0; f < s.size(); ++f) {
        if ((slab.center(s, f).x() > 0) != right) continue;
        part.nodes.insert(part.nodes.end(), s.nodes.begin() + 4 * f, s.nodes.begin() + 4 * f + 4);
        part.begin.push_back(static_cast<int>(part.nodes.size()));
      }
      halves.model.surfaces.push_back(part);
      halves.settings.nu[name] = nu;
      return static_cast<int>(halves.model.surfaces.size()) - 1;
    };
    const int left = half("left", false), right = half("right", true);
    test::add_contact(halves.model, "left", left, halves.indenter);
    test::add_contact(halves.model, "right", right, halves.indenter);
    halves.settings.nu.erase("layer");
    const Analysis analysis = analyse(halves.model, halves.settings);
    for (int c = 0; c < 2; ++c) {
      const ContactStatistics& of = analysis.states.back().statistics[at(c)];
      EXPECT_NEAR(std::abs(of.force.z()) / whole.force, 0.5, 0.002) << nu;
      EXPECT_NEAR(of.peak / whole.peak, 1, 0.002) << nu;
      EXPECT_NEAR(rim_lengths(analysis.joint.contacts[at(c)].layers[0].face).shared, 28, 1e-9);
    }
  }
}

TEST(KnownAnswers, HalfIsHalfOfTheWhole) {
  for (double nu : kNus) {
    SlabUnderBall whole(nu), half(nu, 0);
    const Solved all = whole.run();
    for (const bool layer_first : {true, false}) {
      const Solved found = half.run(layer_first);
      EXPECT_NEAR(2 * std::abs(found.state.statistics[0].force.z()) / all.force, 1, 0.01) << nu << layer_first;
      EXPECT_NEAR(found.peak / all.peak, 1, 0.01) << nu << layer_first;
    }
  }
}

// ---- selections that miss facets of the layer

// Cut off at x = 1 under a ball whose contact reaches to 3.2: the pressed end is the chord where pressure exceeds a
// fifth of the peak, about 2 sqrt(3.2^2 - 1) less its ends, in facets of 0.5; none where the whole face is selected.
TEST(KnownAnswers, ASelectionThatEndsUnderPressureIsTold) {
  const auto pressed_end = [](SlabUnderBall& slab) {
    JointModel model = slab.model;
    test::add_contact(model, "press", slab.layer, slab.indenter);
    const Analysis analysis = analyse(model, slab.settings);
    const StateResult& state = analysis.states.back();
    const int lines = static_cast<int>(result_remarks(model, analysis).size());
    return std::pair(pressed_end_of_selection(analysis.joint.contacts[0].layers[0], state.fields[0].sides[0].pressure,
                                              0.2 * state.statistics[0].peak),
                     lines);
  };
  SlabUnderBall whole(0.45), cut(0.45);
  cut.forget([](const Vector3d& x) { return x.x() > 1; });
  const auto all = pressed_end(whole), less = pressed_end(cut);
  EXPECT_EQ(all.first, 0);
  EXPECT_NEAR(less.first, 5.5, 0.8);
  EXPECT_EQ(less.second, all.second + 1);
}

TEST(KnownAnswers, ForgottenFacet) {
  NEEDS_CASES();
  const JointModel whole = read_feb((kCases / "intact.feb").string()),
                   less = read_feb((kCases / "missing_facet.feb").string());
  // the one that is missing
  const Surface &all = whole.surfaces[0], &some = less.surfaces[0];
  ASSERT_EQ(all.size(), some.size() + 1);
  int missing = 0;
  while (missing < some.size() && std::equal(all.nodes.begin() + 4 * missing, all.nodes.begin() + 4 * missing + 4,
                                             some.nodes.begin() + 4 * missing))
    ++missing;
  for (double nu : kNus) {
    const Solved a = solve("intact.feb", nu), b = solve("missing_facet.feb", nu);
    EXPECT_NEAR(b.force / (a.force - a.facet_force[0][at(missing)]), 1, 0.01) << nu;
    EXPECT_GT(a.facet_force[0][at(missing)], 0);
  }
}

// An L of facets. Beside the contact it carries nothing: the same answer, for the layer is the same. Within it the rest
// takes over some of its load, not more than all of it.
TEST(KnownAnswers, ForgottenPatch) {
  for (double nu : kNus) {
    SlabUnderBall whole(nu);
    const Solved all = whole.run();
    const auto shape = [](const Vector3d& x, double corner) {
      const double a = x.x() - corner, b = x.y();
      return a > 0 && a < 1 && b > -1 && b < 1 && (a < 0.5 || b < -0.5);
    };
    SlabUnderBall beside(nu), within(nu);
    const auto outside = [&](const Vector3d& x) { return shape(x, 5); };
    beside.forget(outside);
    ASSERT_EQ(whole.model.surfaces[at(whole.layer)].size() - beside.model.surfaces[at(beside.layer)].size(), 5);
    const Solved found = beside.run();
    EXPECT_NEAR(found.force / all.force, 1, 1e-3) << nu;
    EXPECT_NEAR(found.peak / all.peak, 1, 1e-3) << nu;

    double lost = 0;
    const auto inside = [&](const Vector3d& x) { return shape(x, 1); };
    const Surface& s = whole.model.surfaces[at(whole.layer)];
    for (int f = 0; f < s.size(); ++f)
      if (inside(whole.center(s, f))) lost += all.facet_force[0][at(f)];
    within.forget(inside);
    const Solved rest = within.run();
    EXPECT_LT(rest.force, all.force) << nu;
    EXPECT_GT(rest.force, (all.force - lost) * 0.99) << nu;  // 1 %: the pressure of a facet is its mean
    EXPECT_GT(lost, 0.01 * all.force);
    fmt::print("nu {}: patch carries {:.4g}, forgotten it costs {:.4g} of {:.4g}\n", nu, lost, all.force - rest.force,
               all.force);
  }
}

TEST(KnownAnswers, SelectionCutOutOfTheLayer) {
  NEEDS_CASES();
  for (double nu : kNus) expect_the_same("intact.feb", "cutout_r5.feb", nu);
}

// A groove of radius 20, lined by 2, under a barrel; selected to half a thickness beyond the contact.
TEST(KnownAnswers, SelectionCutOutOfAGroove) {
  for (double nu : kNus) {
    const auto groove = [](double radius, double u, double v) {
      const double phi = 1.4 * (u - 0.5);
      return Vector3d(radius * std::sin(phi), 28 * (v - 0.5), 20 - radius * std::cos(phi));
    };
    const auto make = [&](double poisson) {
      return std::make_unique<Pressed>(
          56, 56, [&](double u, double v) { return groove(22, u, v); },
          [&](double u, double v) { return groove(20, u, v); }, 56,
          [](double u, double v) {
            const double phi = 1.6 * (u - 0.5), y = 24 * (v - 0.5);
            return Vector3d(15 * std::sin(phi), y, 15 - 15 * std::cos(phi) + y * y / 120);
          },
          0.06, poisson);
    };
    const auto whole = make(nu), cut = make(nu);
    cut->forget([](const Vector3d& x) { return std::abs(x.x()) > 3.5 || std::abs(x.y()) > 3.5; });
    const Solved a = whole->run(), b = cut->run();
    EXPECT_NEAR(std::sqrt(a.state.statistics[0].contact_area / test::kPi), 2.5, 0.2);  // within the selection
    EXPECT_NEAR(b.force / a.force, 1, 0.01) << nu;
    EXPECT_NEAR(b.peak / a.peak, 1, 0.01) << nu;
    fmt::print("groove, nu {}: force {:.5g}, cut out {:+.3f} %, area {:.4g}\n", nu, a.force,
               100 * (b.force / a.force - 1), a.state.statistics[0].contact_area);
  }
}

// ---- free edges

// The walls carry nothing: the same springs, the same numbers. 1e-9: the solution's own tolerance.
TEST(KnownAnswers, DiscAndItsSideWalls) {
  NEEDS_CASES();
  for (double nu : kNus) {
    const Solved a = solve("disc.feb", nu), b = solve("disc_sidewalls.feb", nu),
                 c = solve("disc_rigid_primary.feb", nu);
    EXPECT_NEAR(b.force / a.force, 1, 1e-9) << nu;
    EXPECT_NEAR(b.peak / a.peak, 1, 1e-9) << nu;
    EXPECT_NEAR(c.force / a.force, 1, 0.05) << nu;
    EXPECT_NEAR(c.peak / a.peak, 1, 0.05) << nu;
  }
}

TEST(KnownAnswers, SquarePlateAndItsSideWalls) {
  for (double nu : kNus) {
    const int n = 24;
    const auto make = [&] {
      return std::make_unique<Pressed>(
          n, n, [](double u, double v) { return Vector3d(12 * (u - 0.5), 12 * (v - 0.5), -2); },
          [](double u, double v) { return Vector3d(12 * (u - 0.5), 12 * (v - 0.5), 0); }, 40,
          [](double u, double v) { return Vector3d(20 * (u - 0.5), 20 * (v - 0.5), 0); }, 0.002, nu);
    };
    const auto bare = make(), with_walls = make();
    const Domain& d = with_walls->model.domains[0];
    Surface& s = with_walls->model.surfaces[at(with_walls->layer)];
    const int sides[4][4] = {{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
    for (std::size_t e = 0; e < d.element_ids.size(); ++e)
      for (const auto& side : sides) {
        Vector3d center = Vector3d::Zero();
        for (int k : side) center += with_walls->model.nodes[at(d.nodes[8 * e + at(k)])] / 4;
        if (center.head<2>().lpNorm<Eigen::Infinity>() < 6 - 1e-9) continue;
        for (int k : side) s.nodes.push_back(d.nodes[8 * e + at(k)]);
        s.begin.push_back(static_cast<int>(s.nodes.size()));
      }
    ASSERT_EQ(s.size(), n * n + 4 * n * 2);  // two elements high
    const Solved a = bare->run(), b = with_walls->run(), c = bare->run(false), e = with_walls->run(false);
    EXPECT_NEAR(b.force / a.force, 1, 1e-9) << nu;
    EXPECT_NEAR(b.peak / a.peak, 1, 1e-9) << nu;
    EXPECT_NEAR(e.force / c.force, 1, 1e-9) << nu;
    EXPECT_NEAR(c.force / a.force, 1, 0.05) << nu;
    EXPECT_NEAR(c.peak / a.peak, 1, 0.05) << nu;
    const std::vector<double>& pressure = b.state.fields[0].sides[0].pressure;
    ASSERT_EQ(static_cast<int>(pressure.size()), s.size());
    for (std::size_t f = at(n * n); f < pressure.size(); ++f) EXPECT_EQ(pressure[f], 0.0);
    fmt::print("plate, nu {}: force {:.5g}, rigid body first {:+.2f} %\n", nu, a.force, 100 * (c.force / a.force - 1));
  }
}

// ---- deep strain, rough surfaces

// Pressed to 95 % of its thickness: not a result.
TEST(KnownAnswers, DeepStrainIsBeyondTheLimit) {
  NEEDS_CASES();
  const test::TemporaryFolder folder;
  const test::Finished f = test::run_program(
      folder.path, {DEA_PROGRAM, "run", (kCases / "deep_nu499.feb").string(), "-o", "out.xplt", "--json", "-"}, 60);
  EXPECT_EQ(f.code, 1) << f.err;
  for (double nu : {0.0, 0.45, 0.3}) {
    const Solved s = solve("deep_nu499.feb", nu);
    EXPECT_EQ(s.state.equilibrium.outcome, Outcome::BeyondStrainLimit) << nu;
    EXPECT_NEAR(s.state.statistics[0].largest_strain, 0.95, 0.01) << nu;
  }
}

TEST(KnownAnswers, DeepUnderABall) {
  for (double nu : {0.3, 0.45, 0.499}) {
    SlabUnderBall slab(nu);
    slab.model.rigid_prescribed.back().value.factor = -1.9;
    const Solved s = slab.run();
    EXPECT_EQ(s.state.equilibrium.outcome, Outcome::BeyondStrainLimit) << nu;
    EXPECT_GT(s.state.statistics[0].largest_strain, 0.9) << nu;
  }
}

// Bumps as long as three facets. With facets 4 times finer the peak is 0.0368; 5 %.
TEST(KnownAnswers, RefineResolvesRoughness) {
  NEEDS_CASES();
  EXPECT_NEAR(solve("eggbox.feb", 0, 4).peak / 0.0368, 1, 0.05);
}

// A curved quarter: at its planes of symmetry a normal is known from one side only, and the closest point is right.
TEST(Remarks, NormalsThatMissOnAPlaneOfSymmetryAreNotTold) {
  JointModel model;
  model.surfaces.resize(1);
  model.surfaces[0].name = "ball";
  model.contacts.resize(1);
  Joint joint;
  joint.contacts.resize(1);
  joint.contacts[0].contact = 0;
  for (Layer& layer : joint.contacts[0].layers) layer.surface = 0;
  Layer& ball = joint.contacts[0].layers[1];
  ball.missed = {1, 1, 1, 0};
  ball.mirror = {1, 0, 3, 0};
  ASSERT_EQ(model_remarks(model, joint).size(), 1u);
  EXPECT_NE(model_remarks(model, joint)[0].find("surface \"ball\": at 1 of 4 vertices"), std::string::npos)
      << model_remarks(model, joint)[0];
  ball.mirror[1] = 2;
  EXPECT_TRUE(model_remarks(model, joint).empty());
}

}  // namespace
}  // namespace dea

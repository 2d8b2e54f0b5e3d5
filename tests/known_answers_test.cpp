// Joints whose map once looked right and was wrong: selections that slip, planes of symmetry, free edges, deep strain,
// rough surfaces. Each by a stored model (when present) and by another of its kind made here.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <utility>

#include "io/feb/read_feb.h"
#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/rules/rules.h"
#include "src/run/analysis.h"
#include "tests/findings.h"
#include "tests/program.h"
#include "tests/src/test_models.h"

namespace dea::known_answers_test {

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

// Two contacts side by side on one slab.
struct DividedSlab {
  JointModel model;
  Settings settings;
  Analysis analysis;

  /// Facets of the slab left and right of x = `split`, a contact each, "left" and "right".
  DividedSlab(double nu, double split) {
    SlabUnderBall slab(nu);
    for (const bool right : {false, true}) {
      const Surface& s = slab.model.surfaces[at(slab.layer)];
      Surface part;
      part.name = right ? "right" : "left";
      for (int f = 0; f < s.size(); ++f) {
        if ((slab.center(s, f).x() > split) != right) continue;
        part.nodes.insert(part.nodes.end(), s.nodes.begin() + 4 * f, s.nodes.begin() + 4 * f + 4);
        part.begin.push_back(static_cast<int>(part.nodes.size()));
      }
      slab.model.surfaces.push_back(part);
      slab.settings.nu[part.name] = nu;
      test::add_contact(slab.model, part.name, static_cast<int>(slab.model.surfaces.size()) - 1, slab.indenter);
    }
    slab.settings.nu.erase("layer");
    model = slab.model;
    settings = slab.settings;
    analysis = analyse(model, settings);
  }
};

// Each with half of the facets that a ball presses: by symmetry each is half of the whole,
// whichever body carries the springs. Where the layer goes on without load beside the line they share (as from a
// contact of other bodies), the peak is a punch's, far too high.
TEST(KnownAnswers, TwoHalvesOfAContactAreTheWhole) {
  for (double nu : kNus) {
    const Solved whole = SlabUnderBall(nu).run();
    const DividedSlab halves(nu, 0);
    for (int c = 0; c < 2; ++c) {
      const ContactStatistics& of = halves.analysis.states.back().statistics[at(c)];
      EXPECT_NEAR(std::abs(of.force.z()) / whole.force, 0.5, 0.002) << nu;
      EXPECT_NEAR(of.peak / whole.peak, 1, 0.002) << nu;
      EXPECT_NEAR(rim_lengths(halves.analysis.joint.contacts[at(c)].layers[0].face).shared, 28, 1e-9);
    }
  }
}

// Divided at the edge of contact instead, the left part carries all: what it squeezes flows on under the right one.
TEST(KnownAnswers, WhereALayerIsDividedDoesNotMatter) {
  for (double nu : kNus) {
    const Solved whole = SlabUnderBall(nu).run();
    const DividedSlab parts(nu, 3);
    const ContactStatistics &left = parts.analysis.states.back().statistics[0],
                            &right = parts.analysis.states.back().statistics[1];
    EXPECT_NEAR(std::abs(left.force.z() + right.force.z()) / whole.force, 1, 1e-6) << nu;
    EXPECT_NEAR(left.peak / whole.peak, 1, 1e-6) << nu;
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
    const int lines = static_cast<int>(dea::lines(test::findings_of(model, analysis)).size());
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

// ---- bare surfaces

/// All that is said of a model before and after it is solved, and its analysis.
struct Told {
  Analysis analysis;
  std::string text;
  bool says(const std::string& what) const { return text.find(what) != std::string::npos; }
};

Told told(const Pressed& pressed, bool layer_first = true) {
  JointModel model = pressed.model;
  test::add_contact(model, "press", layer_first ? pressed.layer : pressed.indenter,
                    layer_first ? pressed.indenter : pressed.layer);
  Told t;
  t.analysis = analyse(model, pressed.settings);
  t.text = fmt::format("{}", fmt::join(dea::lines(t.analysis.findings), "\n"));
  return t;
}

/// Turns facets of the rigid body's surface, and leaves its elements as they are.
void flip(Pressed& pressed, const std::function<bool(int, const Vector3d&)>& which) {
  Surface& s = pressed.model.surfaces[at(pressed.indenter)];
  for (int f = 0; f < s.size(); ++f)
    if (which(f, pressed.center(s, f))) std::swap(s.nodes[at(4 * f + 1)], s.nodes[at(4 * f + 3)]);
}

/// Selects those facets of the rigid body's surface alone; `mesh`: its elements too end there.
void select(Pressed& pressed, const std::function<bool(const Vector3d&)>& which, bool mesh = false) {
  Surface& s = pressed.model.surfaces[at(pressed.indenter)];
  std::vector<int> nodes;
  for (int f = 0; f < s.size(); ++f)
    if (which(pressed.center(s, f))) nodes.insert(nodes.end(), s.nodes.begin() + 4 * f, s.nodes.begin() + 4 * f + 4);
  if (mesh) pressed.model.domains.back() = test::quad_domain("rigid", pressed.body, nodes);
  s.nodes = nodes;
  s.begin = {0};
  for (int k = 4; k <= static_cast<int>(nodes.size()); k += 4) s.begin.push_back(k);
}

/// As SlabUnderBall, the ball of n x n facets.
struct SlabUnderCoarseBall : Pressed {
  explicit SlabUnderCoarseBall(int n, double poisson = 0.45)
      : Pressed(
            SlabUnderBall::kN, SlabUnderBall::kN,
            [](double u, double v) { return SlabUnderBall::place(u, v, -14, -2); },
            [](double u, double v) { return SlabUnderBall::place(u, v, -14, 0); }, n,
            [](double u, double v) {
              const Vector3d x = SlabUnderBall::place(u, v, -14, 0);
              return Vector3d(x.x(), x.y(), x.head<2>().squaredNorm() / 200);
            },
            0.05, poisson) {}
  /// Each facet gets nodes of its own.
  void unmerge() {
    Surface& s = model.surfaces[at(indenter)];
    for (int& node : s.nodes) {
      const Vector3d x = model.nodes[at(node)];  // a copy: the list grows
      model.node_ids.push_back(static_cast<int>(model.nodes.size()) + 1);
      model.nodes.push_back(x);
      node = static_cast<int>(model.nodes.size()) - 1;
    }
    model.domains.back() = test::quad_domain("rigid", body, s.nodes);
  }
};

// However the facets of rigid shells are wound, they are the same surface: a band through the contact, every second, a
// few, all. 1e-9: the order of a triangle's corners.
TEST(KnownAnswers, FacetsOfShellsAreWoundToOneSide) {
  const std::pair<const char*, std::function<bool(int, const Vector3d&)>> cases[] = {
      {"and 448 of its 3136 facets looked away", [](int, const Vector3d& x) { return std::abs(x.x()) < 2; }},
      {"and 1568 of its 3136 facets looked away", [](int f, const Vector3d&) { return f % 2 == 1; }},
      {"and 85 of its 3136 facets looked away", [](int f, const Vector3d&) { return f % 37 == 5; }},
      {"and looked away from its partner: turned round", [](int, const Vector3d&) { return true; }},
  };
  for (const bool layer_first : {true, false}) {
    const Solved whole = SlabUnderBall(0.45).run(layer_first);
    for (const auto& c : cases) {
      SlabUnderBall slab(0.45);
      flip(slab, c.second);
      const Told found = told(slab, layer_first);
      const ContactStatistics& s = found.analysis.states.back().statistics[0];
      EXPECT_NEAR(s.force.norm() / whole.force, 1, 1e-9) << c.first;
      EXPECT_NEAR(s.peak / whole.peak, 1, 1e-9) << c.first;
      EXPECT_TRUE(found.says(std::string("surface \"rigid\" lies on rigid shells")) && found.says(c.first))
          << found.text;
    }
  }
}

// A surface of two parts beside each other, one of them turned; and the other side of a shell, behind the one that
// touches, which looks away and stays so.
TEST(KnownAnswers, EachPieceOfShellsIsTurnedByItself) {
  SlabUnderBall whole(0.45), parts(0.45), both_sides(0.45);
  const auto apart = [](const Vector3d& x) { return std::abs(x.x() - 1.25) > 0.3; };
  select(whole, apart);
  select(parts, apart);
  flip(parts, [](int, const Vector3d& x) { return x.x() > 1.25; });
  const Told a = told(whole), b = told(parts);
  EXPECT_NEAR(b.analysis.states.back().statistics[0].force.norm() / a.analysis.states.back().statistics[0].force.norm(),
              1, 1e-9);
  EXPECT_TRUE(b.says("and 1400 of its 3080 facets looked away")) << b.text;

  Surface& s = both_sides.model.surfaces[at(both_sides.indenter)];
  std::map<int, int> above;
  const std::vector<int> front = s.nodes;
  for (std::size_t f = 0; f < front.size(); f += 4)
    for (int k : {0, 3, 2, 1}) {
      const int node = front[f + at(k)];
      if (above.try_emplace(node, static_cast<int>(both_sides.model.nodes.size())).second) {
        const Vector3d x = both_sides.model.nodes[at(node)] + Vector3d(0, 0, 0.03);
        both_sides.model.node_ids.push_back(static_cast<int>(both_sides.model.nodes.size()) + 1);
        both_sides.model.nodes.push_back(x);
      }
      s.nodes.push_back(above[node]);
    }
  for (std::size_t k = front.size() + 4; k <= s.nodes.size(); k += 4) s.begin.push_back(static_cast<int>(k));
  both_sides.model.domains.back() = test::quad_domain("rigid", both_sides.body, s.nodes);
  EXPECT_NEAR(both_sides.run().force / SlabUnderBall(0.45).run().force, 1, 1e-9);
}

// Facets that share no nodes: as if they did. Flat facets of 3.5 would leave 20 to 60 % of the force.
TEST(KnownAnswers, FacetsThatShareNoNodesAreOneSurface) {
  for (const bool layer_first : {true, false}) {
    SlabUnderCoarseBall merged(layer_first ? 8 : 28), loose(layer_first ? 8 : 28), turned(layer_first ? 8 : 28);
    loose.unmerge();
    turned.unmerge();
    flip(turned, [](int f, const Vector3d&) { return f % 3 == 0; });
    const Solved a = merged.run(layer_first);
    for (const SlabUnderCoarseBall* of : {&loose, &turned}) {
      const Told b = told(*of, layer_first);
      const ContactStatistics& s = b.analysis.states.back().statistics[0];
      EXPECT_NEAR(s.force.norm() / a.force, 1, 1e-9) << layer_first;
      EXPECT_NEAR(s.peak / a.peak, 1, 1e-9) << layer_first;
      EXPECT_TRUE(b.says("nodes lie where another one is and are taken for it")) << b.text;
    }
  }
  EXPECT_FALSE(told(SlabUnderCoarseBall(8)).says("lie where another one is"));
}

std::string refusal(const Pressed& pressed) {
  try {
    told(pressed);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

// A third facet on an edge, and a strip joined to itself half turned.
TEST(KnownAnswers, ShellsWithoutTwoSidesAreRefused) {
  SlabUnderCoarseBall rib(8);
  Surface& s = rib.model.surfaces[at(rib.indenter)];
  const int a = s.nodes[4 * 27], b = s.nodes[4 * 27 + 1], first = static_cast<int>(rib.model.nodes.size());
  for (int node : {b, a}) {
    rib.model.node_ids.push_back(static_cast<int>(rib.model.nodes.size()) + 1);
    rib.model.nodes.push_back(Vector3d(rib.model.nodes[at(node)] + Vector3d(0, 0, 3)));
  }
  s.nodes.insert(s.nodes.end(), {a, b, first, first + 1});
  s.begin.push_back(static_cast<int>(s.nodes.size()));
  rib.model.domains.back() = test::quad_domain("rigid", rib.body, s.nodes);
  EXPECT_NE(refusal(rib).find("a surface of shells with 3 facets at one edge has no two sides; select one sheet"),
            std::string::npos)
      << refusal(rib);

  SlabUnderCoarseBall strip(8);
  const int n = 24, ring = static_cast<int>(strip.model.nodes.size());
  for (int i = 0; i < n; ++i)
    for (const double side : {-1.0, 1.0}) {
      const double angle = 2 * kPi * i / n, r = 5 + side * std::cos(angle / 2);
      strip.model.node_ids.push_back(static_cast<int>(strip.model.nodes.size()) + 1);
      strip.model.nodes.push_back({r * std::cos(angle), r * std::sin(angle), 2 + side * std::sin(angle / 2)});
    }
  std::vector<int> quads;
  for (int i = 0; i < n; ++i) {
    const int next = (i + 1) % n, over = i + 1 == n;
    quads.insert(quads.end(), {ring + 2 * i, ring + 2 * i + 1, ring + 2 * next + 1 - over, ring + 2 * next + over});
  }
  strip.model.domains.back() = test::quad_domain("rigid", strip.body, quads);
  Surface& band = strip.model.surfaces[at(strip.indenter)];
  band.nodes = quads;
  band.begin = {0};
  for (int k = 4; k <= 4 * n; k += 4) band.begin.push_back(k);
  EXPECT_NE(refusal(strip).find("cannot be turned to one side (a Moebius strip has but one)"), std::string::npos)
      << refusal(strip);
}

// Cut off at x = 1 under a contact that reaches to 3.2, by its selection or by its mesh: the chord of about 6, less its
// ends, of a rim of 56 + 2 * 30. A hole of one facet of 0.5 has a rim of 2. Not where contact ends inside the surface.
TEST(KnownAnswers, ABareSurfaceThatEndsUnderPressureIsTold) {
  const std::function<bool(const Vector3d&)> left = [](const Vector3d& x) { return x.x() < 1; };
  for (const Law law : {Law::Layer, Law::Linear})
    for (const bool layer_first : {true, false}) {
      SlabUnderBall whole(0.45), cut(0.45), ends(0.45), hole(0.45);
      select(cut, left);
      select(ends, left, true);
      select(hole, [](const Vector3d& x) { return (x - Vector3d(0.25, 0.25, x.z())).norm() > 0.1; });
      const auto rim = [&](SlabUnderBall& slab) {
        slab.settings.law = law;
        const Told t = told(slab, layer_first);
        const StateResult& state = t.analysis.states.back();
        return std::pair(state.statistics[0].pressed_rim[layer_first ? 1 : 0],
                         t.says("pressure reaches the end of bare surface \"rigid\""));
      };
      const auto all = rim(whole), by_selection = rim(cut), by_mesh = rim(ends), one = rim(hole);
      EXPECT_EQ(all.first.selection + all.first.mesh, 0);
      EXPECT_FALSE(all.second);
      EXPECT_NEAR(by_selection.first.selection, 5.5, 0.8);
      EXPECT_EQ(by_selection.first.mesh, 0);
      EXPECT_NEAR(by_selection.first.whole, 2 * (28 + 15), 1);  // along the paraboloid
      EXPECT_TRUE(by_selection.second);
      EXPECT_NEAR(by_mesh.first.mesh, 5.5, 0.8);
      EXPECT_EQ(by_mesh.first.selection, 0);
      EXPECT_TRUE(by_mesh.second);
      EXPECT_NEAR(one.first.selection, 2, 0.01);
      EXPECT_TRUE(one.second);
    }
}

// No end: the rim of a half model in its plane of symmetry, and of a plate as large as the layer under it.
TEST(KnownAnswers, ABareSurfaceThatEndsWithTheCartilageIsNotTold) {
  for (const bool layer_first : {true, false})
    EXPECT_FALSE(told(SlabUnderBall(0.45, 0), layer_first).says("bare surface"));
  JointModel model = test::flat_plates(12, 12, 2, 0);
  test::fix(model, 2, {true, true, false, true, true, true});
  test::prescribe(model, 2, 2, -0.05);
  const Analysis analysis = analyse(model, {});
  EXPECT_GT(analysis.states.back().statistics[0].peak, 0);
  for (const std::string& line : dea::lines(test::findings_of(model, analysis)))
    EXPECT_EQ(line.find("bare surface"), std::string::npos) << line;
}

// ---- planes of symmetry of which nodes were forgotten

// The half slab's face has 56 edges in its plane x = 0. A node that is not held frees the two at it; none held at the
// top frees all. Nodes held where no plane was meant say nothing.
TEST(KnownAnswers, ForgottenNodesOfAPlaneOfSymmetryAreTold) {
  const auto said = [](const std::function<bool(const Vector3d&)>& forgotten) {
    SlabUnderBall half(0.45, 0);
    std::vector<int>& nodes = half.model.fixed_nodes.back().nodes;
    nodes.erase(
        std::remove_if(nodes.begin(), nodes.end(), [&](int node) { return forgotten(half.model.nodes[at(node)]); }),
        nodes.end());
    const Told t = told(half);
    if (t.says("plane x = 0: 1 of ") && t.says("taken as held")) return std::string("named");
    const auto place = t.text.find(" edges of its rim in the plane x = 0 have nodes that are not held in x");
    if (place == std::string::npos) return std::string();
    const auto start = t.text.rfind(": ", place) + 2;
    return t.text.substr(start, place - start);
  };
  EXPECT_EQ(said([](const Vector3d&) { return false; }), "");
  EXPECT_EQ(said([](const Vector3d& x) { return x.norm() < 1e-9; }), "named");  // and counts as held
  EXPECT_EQ(said([](const Vector3d& x) { return std::abs(x.y()) < 2.2; }), "10 of 56");
  EXPECT_EQ(said([](const Vector3d& x) { return x.z() > -1e-9; }), "56 of 56");
  EXPECT_EQ(said([](const Vector3d& x) { return std::abs(std::remainder(x.y(), 1.0)) > 0.1; }), "56 of 56");
  EXPECT_EQ(said([](const Vector3d& x) { return std::abs(x.y() - 3) > 0.1; }), "");  // one column: no plane
}

// ---- what is said of a layer's thickness, its facets, and of steps without a load

TEST(Remarks, BoneThatEndsUnderTheContactIsTold) {
  SlabUnderBall half(0.45), whole(0.45);
  Domain& bone = half.model.domains[1];  // shells
  std::vector<int> kept;
  for (std::size_t f = 0; f < bone.nodes.size(); f += 4) {
    double x = 0;
    for (std::size_t k = f; k < f + 4; ++k) x += half.model.nodes[at(bone.nodes[k])].x() / 4;
    if (x < 0.5)
      kept.insert(kept.end(), bone.nodes.begin() + static_cast<std::ptrdiff_t>(f),
                  bone.nodes.begin() + static_cast<std::ptrdiff_t>(f) + 4);
  }
  bone = test::quad_domain(bone.name, bone.material, kept);
  const Told t = told(half);
  EXPECT_TRUE(t.says("farther than two thicknesses from its rim: does its bone have a hole, or end too soon?"))
      << t.text;
  EXPECT_TRUE(t.says("of the vertices whose normals meet no bone carry pressure, up to")) << t.text;
  EXPECT_FALSE(told(whole).says("meet no bone"));
}

// A wedge that runs out to nothing at one side, and a layer as thin as a slip of the units.
TEST(Remarks, NoThicknessIsTold) {
  const auto layer = [](const std::function<double(double)>& thickness) {
    return std::make_unique<Pressed>(
        12, 12, [=](double u, double v) { return Vector3d(12 * (u - 0.5), 12 * (v - 0.5), -thickness(u)); },
        [](double u, double v) { return Vector3d(12 * (u - 0.5), 12 * (v - 0.5), 0); }, 12,
        [](double u, double v) { return Vector3d(20 * (u - 0.5), 20 * (v - 0.5), 0); }, 1e-8, 0.45);
  };
  const Told wedge = told(*layer([](double u) { return 1e-9 + 8 * u; }));
  EXPECT_TRUE(wedge.says("at 13 of 169 vertices its thickness is zero or next to it")) << wedge.text;
  EXPECT_TRUE(of_code(wedge.analysis.findings, "few-springs").empty()) << wedge.text;
  EXPECT_TRUE(of_code(wedge.analysis.findings, "narrow-contact").empty()) << wedge.text;
  const Told thin = told(*layer([](double) { return 0.006; }));
  EXPECT_TRUE(thin.says("at 165 of 169 vertices its thickness is zero or next to it")) << thin.text;
  EXPECT_TRUE(thin.says("this is hardly a layer of cartilage")) << thin.text;
  const Told coarse = told(*layer([](double) { return 0.02; }));
  EXPECT_TRUE(coarse.says("mesh it finer, or is its thickness wrong?")) << coarse.text;
  EXPECT_TRUE(told(*layer([](double) { return 0.5; })).says("force may be 40%, peak 70% off")) << coarse.text;
}

// Pressed by a prescribed motion, then let go: nothing presses, and that is an outcome of its own; no few springs.
TEST(Remarks, AStepWithoutALoadIsNoContact) {
  SlabUnderBall slab(0.45);
  slab.model.rigid_prescribed.back().step = 0;
  Step second = slab.model.steps.back();
  second.name = "let go";
  slab.model.steps.push_back(second);
  const Told t = told(slab);
  EXPECT_EQ(t.analysis.states.back().equilibrium.outcome, Outcome::NoContact) << t.text;
  EXPECT_FALSE(all_solved(t.analysis));
  EXPECT_TRUE(t.says("nothing loads body \"body\", though it is free to move")) << t.text;
  EXPECT_FALSE(t.says("springs carry")) << t.text;
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

// Also on planes of symmetry, where rays meet the bone if it is there.
TEST(Remarks, NormalsThatMissAreTold) {
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
  ASSERT_EQ(dea::lines(model_findings(model, joint)).size(), 1u);
  EXPECT_NE(dea::lines(model_findings(model, joint))[0].find("surface \"ball\": at 3 of 4 vertices"), std::string::npos)
      << dea::lines(model_findings(model, joint))[0];
  ball.missed = {0, 0, 0, 0};
  EXPECT_TRUE(dea::lines(model_findings(model, joint)).empty());
}

}  // namespace dea::known_answers_test

// Contacts that press one layer: the flow that one drives is felt by the others.
#include "src/joint/shared_layers.h"

#include <gtest/gtest.h>

#include <complex>
#include <numeric>

#include "src/base/error.h"
#include "src/run/analysis.h"
#include "src/run/prepared.h"
#include "tests/analytic/elastic_layer.h"
#include "tests/findings.h"
#include "tests/src/test_models.h"

namespace dea {
namespace {

using namespace test;

constexpr double kThick = 2.0;

/// A rigid paraboloid z = z_0 + r^2/(2 R) over (x, 0), on a square of +-`half`.
struct Ball {
  double x = 0.0, depth = 0.05, radius = 100.0, half = 3.4;
};

/// A slab of `length` x `width`, its top at z = 0, under balls.
struct Slab {
  JointModel model = empty_model();
  int base = -1, layer = -1;
  std::vector<int> body, surface;  ///< materials and surfaces of the balls
  int facets = 16;                 ///< of a ball, along its side

  explicit Slab(double length = 28, double width = 14, double facet = 1.0) {
    const int cartilage = add_material(model, "cartilage", false);
    base = add_material(model, "base", true);
    const auto plane = [=](double z) {
      return [=](double u, double v) { return Vector3d(length * (u - 0.5), width * (v - 0.5), z); };
    };
    layer = add_layer(model, "layer", static_cast<int>(length / facet), static_cast<int>(width / facet), 2,
                      plane(-kThick), plane(0), cartilage, base);
    fix(model, base, {true, true, true, true, true, true});
  }
  int add_body(const std::string& name) {
    body.push_back(add_material(model, name, true));
    return body.back();
  }
  int add_ball(const std::string& name, const Ball& b, int material) {
    surface.push_back(add_rigid_surface(
        model, name, facets, facets,
        [&](double u, double v) {
          const double x = b.half * (2 * v - 1), y = b.half * (2 * u - 1);
          return Vector3d(b.x + x, y, (x * x + y * y) / (2 * b.radius) - b.depth);
        },
        material));
    return surface.back();
  }
  /// Both surfaces as one more.
  int both(int one, int two) {
    std::vector<int> nodes = model.surfaces[at(one)].nodes;
    nodes.insert(nodes.end(), model.surfaces[at(two)].nodes.begin(), model.surfaces[at(two)].nodes.end());
    return add_surface(model, "both", nodes);
  }
  void contact(const std::string& name, int other, bool layer_first) {
    test::add_contact(model, name, layer_first ? layer : other, layer_first ? other : layer);
  }
};

Prepared prepared(const JointModel& model, const Settings& settings = {}) {
  return prepare(recognise(model, settings));
}

PressOptions closely() {
  PressOptions options;
  options.tolerance = 1e-12;
  options.rate_tolerance = 1e-10;
  return options;
}

Pressed pressed(const Prepared& joint) { return press(joint, at_rest(joint).poses, closely()); }

/// Force along z on the balls, of all contacts.
double pushed(const Pressed& p) {
  double sum = 0;
  for (const PressedSprings& c : p.contacts) sum += c.normal_force;
  return sum;
}

/// Pressure times area per triangle of the layer, of all contacts whose springs stand on it.
std::vector<double> on_layer(const Prepared& joint, const Pressed& p) {
  std::vector<double> sum;
  for (std::size_t c = 0; c < p.contacts.size(); ++c) {
    const SpringStates& s = p.contacts[c].springs;
    sum.resize(at(joint.joint.contacts[c].source_layer().articular.size()), 0.0);
    for (int i = 0; i < s.size(); ++i)
      sum[at(joint.beds.beds[c].springs.surface_triangle[at(i)])] += s.pressure[at(i)] * s.area[at(i)];
  }
  return sum;
}

// Two balls of one body over one layer: as two contacts, in either order, as one contact. Which side has the springs
// does not matter here; unlike depths, so that the deeper one's cut-offs must be the layer's.
TEST(SharedLayers, TwoContactsAreTheOneThatHasBoth) {
  for (const bool layer_first : {true, false})
    for (const double other_depth : {0.05, 0.003}) {
      double force[3] = {};
      std::vector<double> map[3];
      for (int way = 0; way < 3; ++way) {
        Slab slab;
        const int ball = slab.add_body("balls"), one = slab.add_ball("one", {-3.6, 0.05}, ball),
                  two = slab.add_ball("two", {3.6, other_depth}, ball);
        if (way == 0) slab.contact("all", slab.both(one, two), layer_first);
        for (int k = 0; k < 2 && way > 0; ++k) {
          const bool first = (k == 0) == (way == 1);
          slab.contact(first ? "a" : "b", first ? one : two, layer_first);
        }
        const Prepared joint = prepared(slab.model);
        ASSERT_EQ(joint.joint.shared_layers.size(), way == 0 ? 0u : 1u);
        const Pressed p = pressed(joint);
        force[way] = pushed(p);
        if (layer_first) map[way] = on_layer(joint, p);
      }
      EXPECT_GT(force[0], 0);
      EXPECT_NEAR(force[1] / force[0], 1, 1e-9) << layer_first;
      EXPECT_NEAR(force[2], force[1], 1e-12 * force[0]) << layer_first;  // the same problem, in the same order
      for (std::size_t t = 0; t < map[0].size(); ++t) {
        EXPECT_NEAR(map[1][t], map[0][t], 1e-9 * force[0]) << t;
        EXPECT_NEAR(map[2][t], map[1][t], 1e-12 * force[0]) << t;
      }
    }
}

// The same after a search for the pose, with a load beside the middle.
TEST(SharedLayers, TheBalanceIsTheSame) {
  for (const bool layer_first : {true, false}) {
    Pose pose[2];
    for (const int way : {0, 1}) {
      Slab slab;
      const int ball = slab.add_body("balls"), one = slab.add_ball("one", {-3.6, 0.0}, ball),
                two = slab.add_ball("two", {3.6, 0.0}, ball);
      if (way == 0) {
        slab.contact("all", slab.both(one, two), layer_first);
      } else {
        slab.contact("a", one, layer_first);
        slab.contact("b", two, layer_first);
      }
      fix(slab.model, ball, {true, true, false, true, false, true});
      force(slab.model, ball, {0, 0, -8});
      RigidLoad moment;
      moment.material = ball;
      moment.dof = 4;
      moment.value = {-6, 0};
      slab.model.rigid_loads.push_back(moment);
      const Analysis run = analyse(slab.model, {});
      const Equilibrium& e = run.states.back().equilibrium;
      ASSERT_EQ(e.outcome, Outcome::Balanced) << e.message;
      pose[way] = e.poses[at(run.joint.body_of(ball))];
      if (way == 0) continue;
      EXPECT_NEAR(run.states.back().statistics[0].force.z() + run.states.back().statistics[1].force.z(),
                  layer_first ? 8 : -8, 1e-6);
    }
    EXPECT_LT((pose[0].center - pose[1].center).norm(), 1e-7 * kThick) << layer_first;
    EXPECT_LT((pose[0].rotation - pose[1].rotation).norm(), 1e-7) << layer_first;
  }
}

// 30 thicknesses apart neither feels the other: the first term decays over two thicknesses.
TEST(SharedLayers, FarApartEachIsAlone) {
  const auto force = [](int balls) {
    Slab slab(88, 14);
    for (int k = 0; k < balls; ++k) {
      const int ball = slab.add_ball(std::to_string(k), {k == 0 ? -30.0 : 30.0, 0.05}, slab.add_body("body"));
      slab.contact(std::to_string(k), ball, true);
    }
    return pushed(pressed(prepared(slab.model)));
  };
  EXPECT_NEAR(force(2) / (2 * force(1)), 1, 1e-9);
}

/// Two parabolic punches on the exact layer: cells of side `step` in a periodic box, their pressures by Polonsky and
/// Keer's method (1999, Wear 231:206). Shares nothing with src/.
struct ExactPair {
  int nx, ny;
  double step;
  Eigen::MatrixXcd fx, fy;
  Eigen::MatrixXd symbol, overlap;

  ExactPair(double length, double width, double h, double nu, const std::vector<Ball>& balls)
      : nx(static_cast<int>(std::lround(length / h))), ny(static_cast<int>(std::lround(width / h))), step(h) {
    const auto dft = [](int n) {
      Eigen::MatrixXcd f(n, n);
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
          f(i, j) = std::polar(1 / std::sqrt(static_cast<double>(n)), -2 * kPi * ((i * j) % n) / n);
      return f;
    };
    fx = dft(nx);
    fy = dft(ny);
    symbol.resize(nx, ny);
    overlap.resize(nx, ny);
    const auto sinc = [](double x) { return x == 0 ? 1.0 : std::sin(x) / x; };
    for (int i = 0; i < nx; ++i)
      for (int j = 0; j < ny; ++j) {
        const double kx = 2 * kPi * (i <= nx / 2 ? i : i - nx) / length,
                     ky = 2 * kPi * (j <= ny / 2 ? j : j - ny) / width, k = std::max(std::hypot(kx, ky), 1e-6);
        symbol(i, j) = analytic::flat_layer(kE, nu, kThick, k) * sinc(kx * h / 2) * sinc(ky * h / 2);
        const double x = (i + 0.5) * h - length / 2, y = (j + 0.5) * h - width / 2;
        overlap(i, j) = -1e3;
        for (const Ball& b : balls)
          overlap(i, j) = std::max(overlap(i, j), b.depth - ((x - b.x) * (x - b.x) + y * y) / (2 * b.radius));
      }
  }
  Eigen::MatrixXd sinking(const Eigen::MatrixXd& p) const {
    const Eigen::MatrixXcd wave =
        (fx * p.cast<std::complex<double>>() * fy).cwiseProduct(symbol.cast<std::complex<double>>());
    return (fx.conjugate() * wave * fy.conjugate()).real();
  }
  /// Forces left and right of x = 0.
  std::array<double, 2> forces() const {
    Eigen::MatrixXd p = overlap.cwiseMax(0.0) / symbol(0, 0), t = Eigen::MatrixXd::Zero(nx, ny);
    double last = 1, conjugate = 0;
    for (int n = 0; n < 400; ++n) {
      const Eigen::MatrixXd gap = sinking(p) - overlap;
      double size = 0;
      for (Eigen::Index i = 0; i < p.size(); ++i)
        if (p(i) > 0) size += gap(i) * gap(i);
      if (size < 1e-18 * overlap.maxCoeff() * overlap.maxCoeff()) break;
      for (Eigen::Index i = 0; i < p.size(); ++i) t(i) = p(i) > 0 ? gap(i) + conjugate * size / last * t(i) : 0.0;
      last = size;
      const Eigen::MatrixXd r = sinking(t);
      double up = 0, down = 0;
      for (Eigen::Index i = 0; i < p.size(); ++i)
        if (p(i) > 0) {
          up += gap(i) * t(i);
          down += r(i) * t(i);
        }
      const double tau = up / down;
      bool more = false;
      for (Eigen::Index i = 0; i < p.size(); ++i) {
        p(i) = p(i) > 0 ? std::max(0.0, p(i) - tau * t(i)) : 0.0;
        if (p(i) == 0 && gap(i) < 0 && t(i) == 0) {
          more = true;
          p(i) = -tau * gap(i);
        }
      }
      conjugate = more ? 0 : 1;
    }
    return {step * step * p.topRows(nx / 2).sum(), step * step * p.bottomRows(nx - nx / 2).sum()};
  }
};

// Brought together until their flows meet: the exact layer under both. Of the force the law itself is 1 % off; what one
// takes from the other is known closer.
TEST(SharedLayers, FlowsThatMeetAreThoseOfTheExactLayer) {
  for (const double nu : {0.45, 0.49}) {
    const std::vector<Ball> balls = {{-3.5, 0.01, 500}, {3.5, 0.006, 500}};
    const std::array<double, 2> exact = ExactPair(32, 20, 0.25, nu, balls).forces();
    const auto solved = [&](std::size_t first, std::size_t last) {
      Slab slab(28, 20, 0.5);
      for (std::size_t k = first; k < last; ++k)
        slab.contact(std::to_string(k), slab.add_ball(std::to_string(k), balls[k], slab.add_body("body")), true);
      Settings settings;
      settings.nu["layer"] = nu;
      return pressed(prepared(slab.model, settings));
    };
    const Pressed both = solved(0, 2);
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_NEAR(both.contacts[k].normal_force / exact[k], 1, 0.01) << nu << " " << k;
      const std::array<double, 2> alone = ExactPair(32, 20, 0.25, nu, {balls[k]}).forces();
      const double change = exact[k] / alone[k] - 1;
      EXPECT_GT(std::abs(change), 0.015) << nu;
      EXPECT_NEAR(both.contacts[k].normal_force / solved(k, k + 1).contacts[0].normal_force - 1, change,
                  0.1 * std::abs(change))
          << nu;
    }
  }
}

// Each of three bodies that find their own places on one layer carries its load, and the derivative of each contact's
// wrench by the others' motions is that of differences.
TEST(SharedLayers, ThreeBodiesOnOneLayer) {
  Slab slab(24, 14);
  const double x[3] = {-7.0, 0.0, 7.0}, load[3] = {3.0, 5.0, 2.0};
  for (int k = 0; k < 3; ++k) {
    const int body = slab.add_body("body " + std::to_string(k));
    slab.contact(std::to_string(k), slab.add_ball(std::to_string(k), {x[k], 0.0}, body), k != 1);
    fix(slab.model, body, {true, true, false, true, true, true});
    force(slab.model, body, {0, 0, -load[k]});
  }
  const Analysis run = analyse(slab.model, {});
  const Equilibrium& e = run.states.back().equilibrium;
  ASSERT_EQ(e.outcome, Outcome::Balanced) << e.message;
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(std::abs(run.states.back().statistics[at(k)].force.z()), load[k], 1e-7);
  ASSERT_EQ(run.beds.groups.size(), 1u);
  const std::vector<int>& group = run.beds.groups[0];
  const std::vector<Motions> motions(3, kAllMotions);
  const std::vector<char> active(3, 1);
  const auto wrenches = [&](const std::vector<Pose>& poses) {
    return press_group(run.beds, group, poses, motions, active, closely());
  };
  const std::vector<PressedContact> at_balance = wrenches(e.poses);
  for (std::size_t a = 0; a < 3; ++a) {
    const SpringBed& bed_a = run.beds.beds[at(group[a])];
    ASSERT_EQ(at_balance[a].wrench.cross.size(), bed_a.source_body == bed_a.target_body ? 0u : 2u);
    for (const ContactWrench::Cross& cross : at_balance[a].wrench.cross)
      for (int k = 0; k < 12; ++k) {
        constexpr double kStep = 1e-6;
        const int body = k < 6 ? cross.bodies.target : cross.bodies.source;
        if (body == bed_a.source_body || body == bed_a.target_body) continue;  // the layer's own body moves both
        Vector12 side[2];
        for (const int sign : {0, 1}) {
          std::vector<Pose> poses = e.poses;
          const double step = sign == 0 ? kStep : -kStep;
          if (k % 6 < 3)
            poses[at(body)].center[k % 6] += step;
          else
            poses[at(body)].rotation =
                Eigen::AngleAxisd(step, Vector3d::Unit(k % 6 - 3)).toRotationMatrix() * poses[at(body)].rotation;
          side[sign] = wrenches(poses)[a].wrench.wrench;
        }
        const Vector12 numeric = (side[0] - side[1]) / (2 * kStep);
        // to 1 %: within one derivative feet stay where they are on the target's layer
        EXPECT_LT((numeric - cross.derivative.col(k)).norm(), 0.01 * cross.derivative.norm()) << a << " " << k;
      }
  }
}

// Springs on the layer or on the balls: they agree to first order in depth over radius.
TEST(SharedLayers, SwappedSidesAgreeToFirstOrder) {
  const auto force = [](double depth, bool layer_first) {
    Slab slab(16, 8, 0.25);
    slab.facets = 32;
    const int ball = slab.add_body("balls");
    for (const double x : {-2.6, 2.6}) {
      const std::string name = x < 0 ? "a" : "b";
      slab.contact(name, slab.add_ball(name, {x, depth, 5.0, 2.5}, ball), layer_first);
    }
    return pushed(pressed(prepared(slab.model)));
  };
  const auto differs = [&](double depth) { return std::abs(force(depth, true) / force(depth, false) - 1); };
  const double deep = differs(0.4), half = differs(0.2);
  EXPECT_LT(deep, 0.08);  // depth over radius
  EXPECT_NEAR(half / deep, 0.5, 0.15);
}

// Two bodies at the same place press the same cartilage: that is no answer, and it says so with force and area.
TEST(SharedLayers, PressedByTwoAtOnceIsNoSolution) {
  for (const bool layer_first : {true, false})
    for (const Law law : {Law::Layer, Law::Linear})
      for (const double apart : {0.0, 12.0}) {
        Slab slab;
        for (const double x : {-apart / 2, apart / 2}) {
          const std::string name = slab.surface.empty() ? "a" : "b";
          slab.contact(name, slab.add_ball(name, {x, 0.05, 100.0, 5.0}, slab.add_body(name)), layer_first);
        }
        for (const int body : slab.body) fix(slab.model, body, {true, true, true, true, true, true});
        Settings settings;
        settings.law = law;
        const Analysis run = analyse(slab.model, settings);
        const Equilibrium& e = run.states.back().equilibrium;
        EXPECT_EQ(e.outcome, apart == 0 ? Outcome::PressedTwice : Outcome::Prescribed) << e.message;
        const Prepared joint = prepared(slab.model, settings);
        const PressedTwice twice = pressed_twice(joint, pressed(joint), e.poses);
        // all of it, but for facets that are pressed in part
        EXPECT_NEAR(twice.share, apart == 0 ? 1 : 0, 0.07);
        EXPECT_EQ(twice.contacts.size(), apart == 0 ? 2u : 0u);
      }
}

std::string refused(const JointModel& model, const Settings& settings) {
  try {
    make_joint(model, settings);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// One layer has one modulus and one thickness.
TEST(SharedLayers, WhatIsSaidInTwoWaysIsRefused) {
  Slab slab;
  Surface& whole = slab.model.surfaces[at(slab.layer)];
  Surface left = whole, right = whole;
  left.name = "left";
  right.name = "right";
  for (Surface* half : {&left, &right}) {
    half->nodes.clear();
    half->begin = {0};
    for (int f = 0; f < whole.size(); ++f) {
      double x = 0;
      for (int k = 4 * f; k < 4 * f + 4; ++k) x += slab.model.nodes[at(whole.nodes[at(k)])].x();
      if ((x < 0) != (half == &left)) continue;
      half->nodes.insert(half->nodes.end(), whole.nodes.begin() + 4 * f, whole.nodes.begin() + 4 * f + 4);
      half->begin.push_back(static_cast<int>(half->nodes.size()));
    }
  }
  const int ball = slab.add_body("balls"), one = slab.add_ball("one", {-3.6, 0.05}, ball),
            two = slab.add_ball("two", {3.6, 0.05}, ball);
  slab.model.surfaces.push_back(left);
  slab.model.surfaces.push_back(right);
  const int l = static_cast<int>(slab.model.surfaces.size()) - 2;
  test::add_contact(slab.model, "a", l, one);
  test::add_contact(slab.model, "b", l + 1, two);
  EXPECT_EQ(refused(slab.model, {}), "");
  const Findings findings = make_joint(slab.model, {}).findings;
  EXPECT_EQ(std::count_if(findings.begin(), findings.end(), [](const Finding& f) { return f.code == "shared-layer"; }),
            1);
  Settings settings;
  settings.E["left"] = 5;
  EXPECT_NE(refused(slab.model, settings).find("its E is 5 for the one and 11.85 for the other"), std::string::npos)
      << refused(slab.model, settings);
  settings.E["right"] = 5;
  EXPECT_EQ(refused(slab.model, settings), "");
  settings.nu["right"] = 0.4;
  EXPECT_NE(refused(slab.model, settings).find("its nu is 0.45 for the one and 0.4"), std::string::npos);
  settings = {};
  settings.thickness["left"] = 1;
  EXPECT_NE(refused(slab.model, settings).find("its thickness is given for \"left\" and measured for \"right\""),
            std::string::npos)
      << refused(slab.model, settings);
  settings.thickness["right"] = 2;
  EXPECT_NE(refused(slab.model, settings).find("its thickness is 1 for the one and 2 for the other"), std::string::npos)
      << refused(slab.model, settings);
  settings.law = Law::Linear;  // springs know nothing of each other
  EXPECT_EQ(refused(slab.model, settings), "");
}

// Contacts of different steps do not press each other; what presses in all steps goes with those of the last.
TEST(SharedLayers, ContactsOfDifferentStepsDoNotMeet) {
  const auto forces = [](const std::vector<int>& steps) {
    Slab slab;
    slab.model.steps.push_back(slab.model.steps.front());
    for (std::size_t k = 0; k < steps.size(); ++k) {
      const std::string name = std::to_string(k);
      const double x[3] = {-3.6, 3.6, 3.6};
      slab.contact(name, slab.add_ball(name, {x[k], 0.05}, slab.add_body(name)), true);
      slab.model.contacts.back().step = steps[k];
    }
    std::vector<double> all;
    for (const PressedSprings& contact : pressed(prepared(slab.model)).contacts) all.push_back(contact.normal_force);
    return all;
  };
  const double alone = forces({0})[0], beside = forces({-1, -1})[0];
  EXPECT_GT(std::abs(beside / alone - 1), 1e-3);
  const std::vector<double> apart = forces({0, 1}), three = forces({-1, 0, 1});
  EXPECT_NEAR(apart[0] / alone, 1, 1e-9);
  EXPECT_NEAR(three[0] / beside, 1, 1e-9);
  EXPECT_NEAR(three[1] / three[2], 1, 1e-9);
}

// A selection that ends under pressure is told, unless another contact presses the facets beyond alike.
TEST(SharedLayers, EndsOfSelectionsAreToldWhereNobodyPressesBeyond) {
  for (const bool both : {true, false}) {
    Slab slab;
    const Surface whole = slab.model.surfaces[at(slab.layer)];
    const int ball = slab.add_body("ball"), surface = slab.add_ball("ball", {0, 0.05}, ball),
              other = slab.add_ball("other", {0, -5}, slab.add_body("other"));
    for (const bool right : {false, true}) {
      std::vector<int> nodes;
      for (int f = 0; f < whole.size(); ++f) {
        double x = 0;
        for (int k = 4 * f; k < 4 * f + 4; ++k) x += slab.model.nodes[at(whole.nodes[at(k)])].x();
        if ((x > 0) == right) nodes.insert(nodes.end(), whole.nodes.begin() + 4 * f, whole.nodes.begin() + 4 * f + 4);
      }
      test::add_contact(slab.model, right ? "right" : "left", add_surface(slab.model, right ? "r" : "l", nodes),
                        right && !both ? other : surface);
    }
    for (const int body : slab.body) fix(slab.model, body, {true, true, true, true, true, true});
    const Analysis run = analyse(slab.model, {});
    const Findings found = findings_of(slab.model, run);
    const auto told = std::count_if(found.begin(), found.end(),
                                    [](const Finding& f) { return f.code == "selection-ends-under-pressure"; });
    EXPECT_EQ(told, both ? 0 : 1);
  }
}

// What is selected in two halves is one layer: each half's contact has what the whole surface's would.
TEST(SharedLayers, TheInsideIsThatOfTheOneContact) {
  Settings settings;
  settings.inside = true;
  std::vector<double> shear[2];
  for (const int way : {0, 1}) {
    Slab slab;
    const int ball = slab.add_body("balls"), one = slab.add_ball("one", {-3.6, 0.05}, ball),
              two = slab.add_ball("two", {3.6, 0.03}, ball);
    fix(slab.model, ball, {true, true, true, true, true, true});
    if (way == 0) {
      slab.contact("all", slab.both(one, two), true);
    } else {
      slab.contact("a", one, true);
      slab.contact("b", two, true);
    }
    const Analysis run = analyse(slab.model, settings);
    const StateResult& state = run.states.back();
    shear[way] = state.fields[0].sides[0].bone_max_shear;
    if (way == 0) continue;
    EXPECT_EQ(state.fields[1].sides[0].bone_max_shear, shear[1]);  // of the layer, whoever presses
    EXPECT_GT(state.statistics[0].inside[0]->bone.max_shear.peak,
              1.2 * state.statistics[1].inside[0]->bone.max_shear.peak);
  }
  ASSERT_EQ(shear[0].size(), shear[1].size());
  const double most = *std::max_element(shear[0].begin(), shear[0].end());
  for (std::size_t f = 0; f < shear[0].size(); ++f) EXPECT_NEAR(shear[1][f], shear[0][f], 1e-6 * most) << f;
}

}  // namespace
}  // namespace dea

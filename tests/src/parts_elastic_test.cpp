// Deformable parts in a joint against the theory of elasticity: a ring under a ball against finite elements of
// revolution; beams; layers.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "src/joint/part.h"
#include "src/model/stiffness.h"
#include "tests/analytic/axisymmetric_contact.h"
#include "tests/analytic/elastic_layer.h"
#include "tests/src/part_models.h"

namespace dea::parts_elastic_test {
namespace {

using namespace test;

/// A ring of wedge section between a ball and a flat layer on bone, which the ball touches in the middle: a stylised
/// meniscus. Its sides are rounder than what they lie on, so that contact ends within them.
struct Ring {
  double ball = 25, inner = 6, outer = 14;
  double upper = 27.5, lower = 150;   ///< radii of its sides
  double E = 20, hoop = 1, nu = 0.3;  ///< hoop: modulus along the ring over E
  double thickness = 2, E_layer = 5, nu_layer = 0.45;
  double depth = 0.1;  ///< by which the ball comes down
  double ball_at(double r) const { return ball - std::sqrt(ball * ball - r * r); }
  /// (r, z) of (s, zeta) in [0, 1]^2. The upper side touches the ball half-way.
  Eigen::Vector2d place(double s, double zeta) const {
    const double r = inner + s * (outer - inner), middle = 0.5 * (inner + outer), sine = middle / ball;
    const double x = r - middle + upper * sine;
    const double top = ball_at(middle) + upper * std::sqrt(1 - sine * sine) - std::sqrt(upper * upper - x * x),
                 bottom = std::pow(r - middle, 2) / (2 * lower);
    return {r, bottom + zeta * (top - bottom)};
  }
  /// In axes along the ring, outwards, up.
  Matrix6d stiffness() const {
    const double G = E / (2 * (1 + nu));
    return *orthotropic_stiffness({hoop * E, E, E}, {G, G, G}, {nu, nu, nu / hoop});
  }
};

/// Of the contacts of the ring with the ball and the layer, and of the ball with the layer.
struct RingPressed {
  std::array<double, 3> force = {}, mean = {}, peak = {};  ///< along z; pressures, the mean weighted with themselves
  double outwards = 0;                                     ///< how far the ring's lower outer edge moves
  /// A patch with this pressure, area and slope.
  void add(std::size_t contact, double pressure, double area, double up) {
    force[contact] += pressure * area * up;
    all[contact] += pressure * area;
    mean[contact] += pressure * pressure * area;
    peak[contact] = std::max(peak[contact], pressure);
  }
  void end() {
    for (std::size_t c = 0; c < 3; ++c) mean[c] /= all[c];
  }

 private:
  std::array<double, 3> all = {};
};

RingPressed by_elements_of_revolution(const Ring& in, int m) {
  const Matrix6d own = in.stiffness(), of_layer = isotropic_stiffness(in.E_layer, in.nu_layer);
  const auto plane = [](const Matrix6d& D, const std::array<int, 4>& order) {  // r, hoop, z, rz
    Eigen::Matrix4d of;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j) of(static_cast<int>(i), static_cast<int>(j)) = D(order[i], order[j]);
    return of;
  };
  const analytic::BodyOfRevolution ring([&](double s, double zeta) { return in.place(s, zeta); }, m, m / 4,
                                        plane(own, {1, 0, 2, 4}), false);
  const int inside = 3 * m / 4, beyond = m / 2, all = inside + m + beyond;
  const auto radius = [&](double s) {  // nodes of the layer lie under those of the ring
    const double i = s * all;
    if (i <= inside) return in.inner * i / inside;
    if (i <= inside + m) return in.inner + (in.outer - in.inner) * (i - inside) / m;
    return in.outer + 6 * (i - inside - m) / beyond;
  };
  const analytic::BodyOfRevolution layer(
      [&](double s, double zeta) { return Eigen::Vector2d(radius(s), in.thickness * (zeta - 1)); }, all, m / 3,
      plane(of_layer, {0, 1, 2, 5}), true);
  std::vector<analytic::Edge> edges;
  for (int e = 0; e < m; ++e) edges.push_back({0, e, true, -1, 0});
  for (int e = 0; e < m; ++e) edges.push_back({1, inside + e, true, 0, e});
  for (int e = 0; e < inside; ++e) edges.push_back({1, e, true, -1, 0});
  const analytic::EdgesPressed found = press_edges({ring, layer}, edges, in.ball, in.ball - in.depth);
  RingPressed pressed;
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const double slope = found.radius[k] / in.ball;
    const std::size_t contact = std::min<std::size_t>(2, k / at(m));
    pressed.add(contact, found.pressure[k], found.area[k], contact == 1 ? 1.0 : std::sqrt(1 - slope * slope));
  }
  pressed.end();
  pressed.outwards = found.motion[0][ring.component(2 * m, false, 0)];
  return pressed;
}

RingPressed by_dea(const Ring& in, int around, int m, int through, double facet) {
  PartMesh ring;
  std::vector<Eigen::Matrix3d> axes;
  const auto node = [&](int i, int j, int k) { return (k * (m + 1) + j) * around + i % around; };
  for (int k = 0; k <= through; ++k)
    for (int j = 0; j <= m; ++j)
      for (int i = 0; i < around; ++i) {
        const Eigen::Vector2d x = in.place(static_cast<double>(j) / m, static_cast<double>(k) / through);
        const double a = 2 * kPi * i / around;
        ring.nodes.emplace_back(x[0] * std::cos(a), x[0] * std::sin(a), x[1]);
      }
  for (int k = 0; k < through; ++k)
    for (int j = 0; j < m; ++j)
      for (int i = 0; i < around; ++i) {
        for (const int up : {k, k + 1})
          for (const int n : {node(i, j, up), node(i, j + 1, up), node(i + 1, j + 1, up), node(i + 1, j, up)})
            ring.element_node.push_back(n);
        ring.begin.push_back(static_cast<int>(ring.element_node.size()));
        ring.shape.push_back(ElementShape::Hex8);
        const double a = 2 * kPi * (i + 0.5) / around;
        axes.push_back(*axes_from(Vector3d(-std::sin(a), std::cos(a), 0), Vector3d(std::cos(a), std::sin(a), 0)));
      }
  JointModel model = empty_model();
  add_mesh(model, ring, "ring", in.E, in.nu);
  model.materials[0].stiffness = {{in.stiffness(), {Axes{}}}};
  model.domains[0].axes = axes;
  const auto side = [&](const std::string& name, double zeta, double up) {
    const auto on = [&](const Vector3d& x) {
      const double s = (x.head<2>().norm() - in.inner) / (in.outer - in.inner);
      return std::abs(x.z() - in.place(s, zeta)[1]) < 1e-9;
    };
    return add_facets(model, name, ring, on, [&](const Vector3d&) { return Vector3d(0, 0, up); });
  };
  const int top = side("top", 1, 1), bottom = side("bottom", 0, -1);
  const int ball = add_material(model, "ball", true), bone = add_material(model, "bone", true),
            cartilage = add_material(model, "cartilage", false, in.E_layer, in.nu_layer);
  const double half = in.outer + 2, wide = in.outer + 4;
  const int sphere = add_rigid_square(model, "sphere", ball, static_cast<int>(2 * half / facet), half, false,
                                      [&](double x, double y) { return in.ball_at(std::hypot(x, y)); });
  const auto flat = [&](double z) {
    return [=](double u, double v) { return Vector3d(wide * (2 * u - 1), wide * (2 * v - 1), z); };
  };
  const int cells = static_cast<int>(2 * wide / facet);
  const int plateau = add_layer(model, "plateau", cells, cells, 1, flat(-in.thickness), flat(0), cartilage, bone);
  add_contact(model, "top", top, sphere);
  add_contact(model, "bottom", bottom, plateau);
  add_contact(model, "middle", plateau, sphere);
  fix(model, bone, {true, true, true, true, true, true});
  fix(model, ball, {true, true, false, true, true, true});
  prescribe(model, ball, 2, -in.depth);
  const Solved s = solve(model);
  EXPECT_EQ(s.e.outcome, Outcome::Balanced) << s.e.message;
  EXPECT_TRUE(s.joint.parts.size() == 1 && s.joint.parts[0].free());
  RingPressed pressed;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < s.e.springs[c].pressure.size(); ++i)
      pressed.add(c, s.e.springs[c].pressure[i], s.e.springs[c].carrying[i], std::abs(s.e.springs[c].direction[i].z()));
  pressed.end();
  const Eigen::MatrixX3d u = moved(s, 0);
  for (int i = 0; i < around; ++i) {
    const int k = node(i, m, 0);
    pressed.outwards += u.row(k).dot(ring.nodes[at(k)].transpose()) / in.outer / around;
  }
  return pressed;
}

/// Forces on the ball, what of it the ring carries, how far the ring is pushed outwards and its pressures, with
/// and without fibres along it. The finite elements of revolution have converged to half a per cent.
TEST(ElasticParts, RingUnderABall) {
  for (const double hoop : {1.0, 7.0}) {
    SCOPED_TRACE(hoop);
    Ring in;
    in.hoop = hoop;
    const RingPressed exact = by_elements_of_revolution(in, 24), found = by_dea(in, 32, 8, 3, 1.2);
    const auto near = [](double value, double known, double within) { EXPECT_NEAR(value / known, 1, within); };
    near(found.force[0] + found.force[2], exact.force[0] + exact.force[2], 0.02);
    near(found.force[0], exact.force[0], 0.02);
    EXPECT_NEAR(found.force[0], found.force[1], 1e-5 * found.force[0]) << "it balances";
    near(found.outwards, exact.outwards, 0.03);
    near(found.mean[0], exact.mean[0], 0.03);
    near(found.mean[1], exact.mean[1], 0.02);
    near(found.peak[0], exact.peak[0], 0.05);
    near(found.peak[1], exact.peak[1], 0.03);
  }
}

// ---- a sphere on a block that is bonded below -----------------------------------------------------------------------

struct Block {
  double E = 10, nu = 0.45, thickness = 4, radius = 20, depth = 0.1;
  double half = 8;  ///< of its sides
  ElementShape shape = ElementShape::Hex8;
  int n = 12, through = 3;
  double uneven = 0;  ///< by how much of the cells nodes inside are moved
};

analytic::PunchResult exact_of(const Block& in) {
  const analytic::ParabolicPunch punch{[&](double k) { return analytic::flat_layer(in.E, in.nu, in.thickness, k); },
                                       2 * (1 - in.nu * in.nu) / in.E, in.thickness, in.radius};
  return punch.sphere(in.depth, 1.6 * std::sqrt(in.radius * in.depth));
}

/// The mesh is finer in the middle and above.
Solved press_block(const Block& in) {
  const double t = in.thickness, half = in.half;
  PartMesh mesh = block_of(
      in.shape, {in.n, in.n, in.through}, {2 * half, 2 * half, t}, isotropic_stiffness(in.E, in.nu), [&](Vector3d x) {
        x -= Vector3d(half, half, t);
        const bool inside = std::abs(x[0]) < half - 1e-9 && std::abs(x[1]) < half - 1e-9;
        const double cell = inside ? in.uneven * 2 * half / in.n : 0.0;
        const Vector3d by(cell * std::sin(37 * x[0] + 11 * x[1]), cell * std::sin(23 * x[1] - 7 * x[0]), 0);
        x += by;
        for (int k = 0; k < 2; ++k) x[k] *= 0.35 + 0.65 * std::abs(x[k]) / half;
        x[2] *= 0.5 + 0.5 * std::abs(x[2]) / t;
        return x;
      });
  JointModel model = empty_model();
  add_mesh(model, mesh, "block", in.E, in.nu);
  FixedNodes base;
  base.xyz = {true, true, true};
  for (int i = 0; i < mesh.size(); ++i)
    if (mesh.nodes[at(i)][2] < 1e-9 - t) base.nodes.push_back(i);
  model.fixed_nodes.push_back(base);
  const auto above = [&](const Vector3d& x) { return x.z() > -1e-9; };
  const int top = add_facets(model, "top", mesh, above, [](const Vector3d&) { return Vector3d(0, 0, 1); });
  const int ball = add_material(model, "ball", true);
  const double wide = std::min(0.6 * in.radius, 2 * std::sqrt(2 * in.radius * in.depth));
  const int sphere = add_rigid_square(model, "sphere", ball, 40, wide, false, [&](double x, double y) {
    return in.radius - std::sqrt(in.radius * in.radius - x * x - y * y);
  });
  add_contact(model, "contact", top, sphere);
  fix(model, ball, {true, true, false, true, true, true});
  prescribe(model, ball, 2, -in.depth);
  Settings settings;
  settings.part = {"block"};
  return solve(model, settings);
}

/// Force and pressures, and that pressures of triangles side by side do not alternate: how far, of the largest, a
/// triangle is off the mean of its neighbours, taken beside what the exact pressures do there. Elements with nodes on
/// their edges, too: their facets are told by these.
TEST(ElasticParts, PressuresHaveNoCheckerboard) {
  for (const ElementShape shape : {ElementShape::Hex8, ElementShape::Hex20, ElementShape::Penta15, ElementShape::Tet10})
    for (const double uneven : {0.0, 0.15}) {
      SCOPED_TRACE(element_type(shape).name + (uneven > 0 ? std::string(", uneven") : ""));
      Block in;
      in.shape = shape;
      in.uneven = uneven;
      const analytic::PunchResult exact = exact_of(in);
      const Solved s = press_block(in);
      const SpringStates& springs = s.e.springs[0];
      const double peak = *std::max_element(springs.pressure.begin(), springs.pressure.end());
      EXPECT_NEAR(s.e.contact_on_target[0].head<3>().norm() / exact.force, 1, 0.04);
      EXPECT_NEAR(peak / exact.peak, 1, 0.12);
      const auto off = [&](int i) {
        const double at_ring = springs.foot[at(i)].head<2>().norm() / exact.step;
        const std::size_t ring = static_cast<std::size_t>(at_ring);
        return springs.pressure[at(i)] - (ring < exact.pressure.size() ? exact.pressure[ring] : 0.0);
      };
      const SurfaceMesh& mesh = s.joint.contacts[0].source_layer().spring_surface();
      ASSERT_EQ(mesh.size(), springs.size());
      double sum = 0;
      int count = 0;
      for (int i = 0; i < mesh.size(); ++i) {
        if (springs.foot[at(i)].head<2>().norm() > 0.75 * exact.radius) continue;
        double around = 0;
        for (const int j : mesh.neighbours[at(i)]) around += off(j) / 3;
        sum += std::pow((off(i) - around) / 2, 2);
        ++count;
      }
      EXPECT_LT(std::sqrt(sum / count), 0.08 * exact.peak);
    }
}

// ---- beams ----------------------------------------------------------------------------------------------------------

/// A beam along x, held at one end or at both, that a rigid cylinder across it presses down.
struct Beam {
  double E = 10, nu = 0.3, length = 20, height = 2, width = 2, depth = 0.2;
  bool both = false;  ///< held at both ends, and pressed in the middle; else nine tenths from its end
  ElementShape shape = ElementShape::Hex8;
  int along = 40, through = 4;
};

/// How far the beam's axis goes down under the cylinder, over what Timoshenko says of the force.
double bent_over_theory(const Beam& in) {
  PartMesh mesh = block_of(in.shape, {in.along, in.through, in.through}, {in.length, in.width, in.height},
                           isotropic_stiffness(in.E, in.nu));
  JointModel model = empty_model();
  add_mesh(model, mesh, "beam", in.E, in.nu);
  FixedNodes ends;
  ends.xyz = {true, true, true};
  for (int i = 0; i < mesh.size(); ++i)
    if (const double x = mesh.nodes[at(i)][0]; x < 1e-9 || (in.both && x > in.length - 1e-9)) ends.nodes.push_back(i);
  model.fixed_nodes.push_back(ends);
  const auto above = [&](const Vector3d& x) { return x.z() > in.height - 1e-9; };
  const int top = add_facets(model, "top", mesh, above, [](const Vector3d&) { return Vector3d(0, 0, 1); });
  const int roller = add_material(model, "roller", true);
  const double place = in.both ? 0.5 * in.length : 0.9 * in.length, R = 20;
  const int under = add_rigid_surface(
      model, "under", 40, 4,
      [&](double u, double v) {
        const double x = 4 * (2 * u - 1);
        return Vector3d(place + x, in.width * (2 - 3 * v), in.height + R - std::sqrt(R * R - x * x));
      },
      roller);
  add_contact(model, "contact", top, under);
  fix(model, roller, {true, true, false, true, true, true});
  prescribe(model, roller, 2, -in.depth);
  Settings settings;
  settings.part = {"beam"};
  const Solved s = solve(model, settings);
  double force = 0, a = 0;
  const SpringStates& springs = s.e.springs[0];
  for (std::size_t i = 0; i < springs.pressure.size(); ++i) {
    force += springs.force(i);
    a += springs.force(i) * springs.foot[i].x();
  }
  a /= force;
  // where its axis has gone there, between nodes
  const Eigen::MatrixX3d u = moved(s, 0);
  double low = -1e9, high = 1e9, down_low = 0, down_high = 0;
  for (int i = 0; i < mesh.size(); ++i) {
    const Vector3d& x = mesh.nodes[at(i)];
    if (std::abs(x[2] - in.height / 2) > 1e-9 || std::abs(x[1] - in.width / 2) > 1e-9) continue;
    if (x[0] <= a && x[0] > low) low = x[0], down_low = -u(i, 2);
    if (x[0] > a && x[0] < high) high = x[0], down_high = -u(i, 2);
  }
  const double down = down_low + (a - low) / (high - low) * (down_high - down_low);
  const double I = in.width * std::pow(in.height, 3) / 12, A = in.width * in.height, G = in.E / (2 * (1 + in.nu)),
               k = 10 * (1 + in.nu) / (12 + 11 * in.nu);
  const double L = in.length, b = L - a;
  const double theory = in.both ? std::pow(a * b, 3) / (3 * in.E * I * L * L * L) + a * b / L / (k * G * A)
                                : std::pow(a, 3) / (3 * in.E * I) + a / (k * G * A);
  return down / (force * theory);
}

/// Theory leaves out that the ends cannot widen; hexahedra of 8 nodes are too stiff in bending, the less, the more of
/// them.
TEST(ElasticParts, BeamsBend) {
  Beam in;
  EXPECT_NEAR(bent_over_theory(in), 1, 0.025);
  in.through = 2;
  for (const ElementShape shape : {ElementShape::Hex20, ElementShape::Penta15, ElementShape::Tet10}) {
    in.shape = shape;
    in.along = 20;
    EXPECT_NEAR(bent_over_theory(in), 1, 0.025) << element_type(shape).name;
  }
  in.both = true;
  in.shape = ElementShape::Hex20;
  EXPECT_NEAR(bent_over_theory(in), 1, 0.04);
}

}  // namespace
}  // namespace dea::parts_elastic_test

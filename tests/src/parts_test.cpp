// Deformable parts in a joint: recognition, contact, ligaments, balance; against answers on paper.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "src/springs/press.h"
#include "tests/analytic/elastic_layer.h"
#include "tests/src/part_models.h"

namespace dea::parts_test {
namespace {

using namespace test;

/// The facets of a block's mesh in a plane across the z axis, wound to look along `side`.
std::vector<int> facets_at(const PartMesh& mesh, double z, int side, double within = 1e9) {
  std::vector<int> quads;
  for (int e = 0; e < mesh.elements(); ++e)
    for (const std::vector<int>& face : element_faces(mesh.shape[at(e)])) {
      std::vector<int> nodes;
      bool there = true;
      for (int k : face) {
        const Vector3d& x = mesh.nodes[at(mesh.element_node[at(mesh.begin[at(e)] + k)])];
        there = there && std::abs(x[2] - z) < 1e-9 && std::abs(x[0]) < within && std::abs(x[1]) < within;
        nodes.push_back(mesh.element_node[at(mesh.begin[at(e)] + k)]);
      }
      const Vector3d a = mesh.nodes[at(nodes[1])] - mesh.nodes[at(nodes[0])],
                     b = mesh.nodes[at(nodes[2])] - mesh.nodes[at(nodes[0])];
      if (there && a.cross(b)[2] * side > 0) quads.insert(quads.end(), nodes.begin(), nodes.end());
    }
  return quads;
}

/// A block of 6 x 6 x 3 between two rigid plates of which the upper comes down by `depth`.
struct Pressed {
  JointModel model = empty_model();
  int upper = -1, lower = -1;
};
Pressed block_between_plates(double E, double nu, double depth) {
  Pressed in;
  const PartMesh mesh = block_of(ElementShape::Hex8, {6, 6, 3}, {6, 6, 3}, isotropic_stiffness(E, nu));
  add_mesh(in.model, mesh, "disc", E, nu);
  const int top = add_surface(in.model, "top", facets_at(mesh, 3, 1)),
            bottom = add_surface(in.model, "bottom", facets_at(mesh, 0, -1));
  in.upper = add_material(in.model, "upper", true);
  in.lower = add_material(in.model, "lower", true);
  const auto plate = [](double z, bool up) {
    return [=](double u, double v) {
      return up ? Vector3d(-2 + 10 * u, -2 + 10 * v, z) : Vector3d(-2 + 10 * v, -2 + 10 * u, z);
    };
  };
  const int above = add_rigid_surface(in.model, "above", 5, 5, plate(3, false), in.upper),
            below = add_rigid_surface(in.model, "below", 5, 5, plate(0, true), in.lower);
  add_contact(in.model, "top", top, above);
  add_contact(in.model, "bottom", bottom, below);
  fix(in.model, in.lower, {true, true, true, true, true, true});
  fix(in.model, in.upper, {true, true, false, true, true, true});
  prescribe(in.model, in.upper, 2, -depth);
  return in;
}

/// Nothing holds it, contacts press it: a part of its own, with a body of its own. Its force is E A d/h, its pressure
/// even, it goes down by half of what the plate does, and no motion that nothing resists drifts.
TEST(Parts, DiscBetweenPlates) {
  const double E = 10, d = 0.1;
  for (const double nu : {0.0, 0.3, 0.49}) {
    const Solved s = solve(block_between_plates(E, nu, d).model);
    ASSERT_EQ(s.joint.parts.size(), 1u);
    const SoftPart& part = s.joint.parts[0];
    EXPECT_TRUE(part.free());
    EXPECT_EQ(s.joint.bodies[at(part.body)].name, "disc");
    EXPECT_EQ(s.e.outcome, Outcome::Balanced) << s.e.message;
    const double F = E * 36 * d / 3;
    EXPECT_NEAR(std::abs(s.e.contact_on_target[0][2]), F, 1e-6 * F);
    EXPECT_NEAR(s.e.contact_on_target[1][2], -F, 1e-6 * F) << "the lower plate is pushed down";
    EXPECT_LT((s.e.contact_on_target[0] + s.e.contact_on_target[1]).head<3>().norm(), 1e-8 * F);
    const Pose& pose = s.e.poses[at(part.body)];
    EXPECT_LT((pose.center - Vector3d(3, 3, 1.5 - d / 2)).norm(), 1e-7);
    EXPECT_LT((pose.rotation - Eigen::Matrix3d::Identity()).norm(), 1e-7);
    // even pressure on what has become wider by nu d/h
    for (int i = 0; i < s.e.springs[0].size(); ++i)
      EXPECT_NEAR(s.e.springs[0].pressure[at(i)] * std::pow(1 + nu * d / 3, 2), F / 36, 1e-5 * F / 36);
    const Eigen::MatrixX3d& u =
        s.e.springs[0].part_motion[s.joint.contacts[0].layers[s.joint.contacts[0].source].part >= 0 ? 0 : 1];
    ASSERT_EQ(u.rows(), part.mesh.size());
    for (int i = 0; i < part.mesh.size(); ++i) {
      const Vector3d x = part.mesh.nodes[at(i)] - Vector3d(3, 3, 1.5);
      EXPECT_LT((u.row(i).transpose() - d / 3 * Vector3d(nu * x[0], nu * x[1], -x[2])).norm(), 1e-7);
    }
  }
}

/// Springs from both its ends along x to the lower plate press back as it widens: three unknown stresses and strains on
/// paper. It needs the part's own motion at its ends, not that of its body, which stays.
TEST(Parts, SpringsOnItsNodes) {
  const double E = 10, nu = 0.3, d = 0.02, k = 30, L = 5;
  Pressed in = block_between_plates(E, nu, d);
  JointModel& model = in.model;
  RigidNodes anchors;
  anchors.material = in.lower;
  const int block = 7 * 7 * 4;
  for (int weight : {1, 2, 4}) {  // by the quarters of facets around a node
    DiscreteSet set;
    set.name = "springs " + std::to_string(weight);
    for (int i = 0; i < block; ++i) {
      const Vector3d x = model.nodes[at(i)];
      if (std::abs(x[0] * (x[0] - 6)) > 1e-9) continue;
      const int of = (std::abs(x[1] * (x[1] - 6)) < 1e-9 ? 1 : 2) * (std::abs(x[2] * (x[2] - 3)) < 1e-9 ? 1 : 2);
      if (of != weight) continue;
      const int anchor = static_cast<int>(model.nodes.size());
      model.nodes.push_back(x + Vector3d(x[0] > 3 ? L : -L, 0, 0));
      model.node_ids.push_back(anchor + 1);
      anchors.nodes.push_back(anchor);
      set.pairs.push_back({i, anchor});
    }
    model.discrete_sets.push_back(set);
    DiscreteSprings springs;
    springs.name = set.name;
    springs.set = static_cast<int>(model.discrete_sets.size()) - 1;
    springs.stiffness = k * weight / (6 * 3 * 4);
    model.discrete_springs.push_back(springs);
  }
  model.rigid_nodes.push_back(anchors);
  const Solved s = solve(model);
  EXPECT_EQ(s.e.outcome, Outcome::Balanced) << s.e.message;
  // E ex = sx - nu sz,  E ez = sz - nu sx,  ez = -d/h,  sx A = -k ex 6/2 with A = 18
  const double ez = -d / 3, c = k * 3 / 18;
  const double ex = -nu * ez * E / (E + c * (1 - nu * nu)), sx = -c * ex, sz = E * ez + nu * sx;
  EXPECT_NEAR(s.e.contact_on_target[1][2], sz * 36, 1e-3 * 36 * std::abs(sz));
  double pull = 0;
  for (double force : s.e.ligament_force) pull += force / 2;
  EXPECT_NEAR(pull, sx * 18, 5e-3 * std::abs(sx * 18)) << "they lean a little: the block's nodes go down";
  EXPECT_LT(sx, -0.001);
}

/// The nodes of a block of 6 x 6 x 3, the first of the model, with this x, on a body of their own; its material.
int hold_end(JointModel& model, double x, const std::string& body) {
  RigidNodes end;
  end.material = add_material(model, body, true);
  for (int i = 0; i < 7 * 7 * 4; ++i)
    if (std::abs(model.nodes[at(i)][0] - x) < 1e-9) end.nodes.push_back(i);
  model.rigid_nodes.push_back(end);
  return end.material;
}

/// Takes the facets of a surface with nodes at x = 0 or 6 out.
void leave_ends(const JointModel& model, Surface& surface) {
  FacetList inner;
  for (int f = 0; f < surface.size(); ++f) {
    const std::vector<int> facet = surface.facet(f);
    if (std::all_of(facet.begin(), facet.end(), [&model](int node) {
          const double x = model.nodes[at(node)][0];
          return x > 0.5 && x < 5.5;
        }))
      inner.add(facet);
  }
  static_cast<FacetList&>(surface) = inner;
}

/// A part between two bodies, one of which can move (P3). Both at rest: as one that one body holds. A force along the
/// part: F L/(E A), exact for nu = 0, whatever presses it from above.
TEST(Parts, TwoBodiesHoldIt) {
  const double E = 10, d = 0.1;
  const auto ends = [&](double nu, double depth, bool apart, bool frame_moves, double F) {
    Pressed in = block_between_plates(E, nu, depth);
    for (const int surface : {0, 1}) leave_ends(in.model, in.model.surfaces[at(surface)]);
    const int left = hold_end(in.model, 0, "left");
    const int right = apart ? hold_end(in.model, 6, "right") : left;
    if (!apart)
      for (int i = 0; i < 7 * 7 * 4; ++i)
        if (std::abs(in.model.nodes[at(i)][0] - 6) < 1e-9) in.model.rigid_nodes[0].nodes.push_back(i);
    const int moves = frame_moves ? left : right;
    for (const int end : {left, right})
      if (end != moves || F == 0) fix(in.model, end, {true, true, true, true, true, true});
    Settings settings;
    if (F != 0) settings.force[frame_moves ? "left" : "right"] = {frame_moves ? -F : F, 0, 0};
    return solve(in.model, settings);
  };
  const Solved one = ends(0.3, d, false, false, 0), two = ends(0.3, d, true, false, 0);
  ASSERT_EQ(two.joint.parts.size(), 1u);
  EXPECT_GE(two.joint.parts[0].other, 0);
  EXPECT_EQ(two.e.outcome, one.e.outcome);
  const double pressed = one.e.contact_on_target[0].norm();
  EXPECT_GT(pressed, E * 24 * d / 3);
  EXPECT_LT((two.e.contact_on_target[0] - one.e.contact_on_target[0]).norm(), 1e-3 * pressed);
  for (const bool frame_moves : {false, true}) {
    const double F = 4;
    const Solved s = ends(0.0, 0.01, true, frame_moves, F);
    ASSERT_EQ(s.e.outcome, Outcome::Balanced) << s.e.message;
    const auto went = [&s](const std::string& name) {
      const Vector3d end(name == "left" ? 0 : 6, 3, 1.5);
      for (std::size_t b = 0; b < s.joint.bodies.size(); ++b)
        if (s.joint.bodies[b].name == name)
          return Vector3d(s.e.poses[b].center + s.e.poses[b].rotation * (end - s.joint.bodies[b].center_of_mass) - end);
      return Vector3d(Vector3d::Constant(1e9));
    };
    EXPECT_NEAR(went("right")[0] - went("left")[0], F * 6 / (E * 18), 2e-3 * F * 6 / (E * 18)) << frame_moves;
  }
}

/// Three planes of symmetry hold a part: a quarter of the disc between plates, its lower half. On a hinge it could
/// turn.
TEST(Parts, BesidePlanesOfSymmetry) {
  const double E = 10, d = 0.1;
  Pressed in = block_between_plates(E, 0.3, d);
  in.model.contacts.pop_back();
  for (int axis = 0; axis < 3; ++axis) {
    FixedNodes plane;
    plane.xyz[at(axis)] = true;
    for (int i = 0; i < 7 * 7 * 4; ++i)
      if (in.model.nodes[at(i)][axis] < 1e-9) plane.nodes.push_back(i);
    in.model.fixed_nodes.push_back(plane);
  }
  Settings settings;
  settings.part = {"disc"};
  const Solved s = solve(in.model, settings);
  ASSERT_EQ(s.joint.parts.size(), 1u);
  EXPECT_FALSE(s.joint.parts[0].free());
  EXPECT_EQ(s.e.outcome, Outcome::Prescribed) << s.e.message;
  EXPECT_NEAR(s.e.contact_on_target[0].head<3>().norm(), E * 36 * d / 3, 1e-6 * E * 36 * d / 3);
  in.model.fixed_nodes.resize(1);
  in.model.fixed_nodes[0].xyz = {true, true, true};
  std::erase_if(in.model.fixed_nodes[0].nodes, [&](int node) { return in.model.nodes[at(node)][2] > 1e-9; });
  try {
    make_joint(in.model, {});
    ADD_FAILURE() << "a part on a hinge is taken";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("which leave it a motion as a whole"), std::string::npos) << e.what();
  }
}

/// A labrum that shares nodes with the cartilage: a part beside a layer in one region of the model, held by the layer's
/// bone where they meet, as if all of it were a part and its cartilage did not give way.
TEST(Parts, BesideALayerInOneRegion) {
  Pressed in = block_between_plates(10, 0.3, 0.1);
  JointModel& model = in.model;
  Domain labrum = model.domains[0];
  labrum.name = "labrum";
  labrum.material = add_material(model, "labrum", false, 40, 0.3);
  Domain& cartilage = model.domains[0];
  const auto take = [&model](Domain& d, bool left) {
    std::vector<int> nodes;
    for (std::size_t e = 0; e < 6 * 6 * 3; ++e)
      if ((model.nodes[at(d.nodes[8 * e])][0] < 2.5) == left)
        nodes.insert(nodes.end(), d.nodes.begin() + static_cast<std::ptrdiff_t>(8 * e),
                     d.nodes.begin() + static_cast<std::ptrdiff_t>(8 * e + 8));
    d.nodes = nodes;
    d.element_ids.resize(nodes.size() / 8);
  };
  take(cartilage, true);
  take(labrum, false);
  model.domains.push_back(labrum);
  const std::vector<int> top = model.surfaces[0].nodes;
  std::vector<int> of_left, of_right;
  for (std::size_t f = 0; f < top.size(); f += 4) {
    double x = 0;
    for (std::size_t k = 0; k < 4; ++k) x += model.nodes[at(top[f + k])][0] / 4;
    std::vector<int>& of = x < 3 ? of_left : of_right;
    of.insert(of.end(), top.begin() + static_cast<std::ptrdiff_t>(f), top.begin() + static_cast<std::ptrdiff_t>(f + 4));
  }
  const int left = add_surface(model, "left", of_left), right = add_surface(model, "right", of_right);
  const int above = model.contacts[0].secondary;
  model.contacts.clear();
  add_contact(model, "left", left, above);
  add_contact(model, "right", right, above);
  RigidNodes bone;
  bone.material = in.lower;
  for (int i = 0; i < 7 * 7 * 4; ++i)
    if ((model.nodes[at(i)][2] < 1e-9 && model.nodes[at(i)][0] < 3 + 1e-9) || model.nodes[at(i)][0] > 6 - 1e-9)
      bone.nodes.push_back(i);
  model.rigid_nodes.push_back(bone);
  const Joint joint = make_joint(model, {});
  ASSERT_EQ(joint.parts.size(), 1u);
  const SoftPart& part = joint.parts[0];
  EXPECT_EQ(part.name, "labrum");
  EXPECT_EQ(part.mesh.elements(), 3 * 6 * 3);
  for (int i = 0; i < part.mesh.size(); ++i)
    EXPECT_EQ(part.holder[at(i)] >= 0, std::abs(part.mesh.nodes[at(i)][0] - 4.5) > 1.5 - 1e-9);
  EXPECT_EQ(joint.contacts[0].layers[0].part, -1);
  EXPECT_EQ(joint.contacts[0].layers[0].elasticity.E, 10);
  EXPECT_EQ(joint.contacts[1].layers[0].part, 0);
  const Solved both = solve(model);
  JointModel alone = model;
  alone.domains.erase(alone.domains.begin());  // the labrum alone, held where they met
  alone.contacts.erase(alone.contacts.begin());
  RigidNodes cut;
  cut.material = in.lower;
  for (int i = 0; i < 7 * 7 * 4; ++i)
    if (std::abs(model.nodes[at(i)][0] - 4.5) > 1.5 - 1e-9 && model.nodes[at(i)][0] > 2) cut.nodes.push_back(i);
  alone.rigid_nodes = {cut};
  const Solved held = solve(alone);
  EXPECT_GT(held.e.contact_on_target[0].norm(), 1);
  // not on bone itself it goes along with the cartilage: all is one part
  std::erase_if(model.rigid_nodes.back().nodes, [&](int node) { return model.nodes[at(node)][0] > 3 + 1e-9; });
  const Joint hanging = make_joint(model, {});
  ASSERT_EQ(hanging.parts.size(), 1u);
  EXPECT_EQ(hanging.parts[0].mesh.elements(), 6 * 6 * 3);
  EXPECT_LT((both.e.contact_on_target[1] - held.e.contact_on_target[0]).norm(),
            1e-6 * held.e.contact_on_target[0].norm());
}

/// A sphere on a block bonded below, against the exact layer; the block 6 thicknesses of the contact wide. `--part`
/// names it: it would be a layer of cartilage otherwise.
TEST(Parts, SphereOnABlockIsTheExactLayer) {
  const double E = 10, nu = 0.45, t = 4, R = 20, d = 0.1;
  const analytic::ParabolicPunch punch{[&](double k) { return analytic::flat_layer(E, nu, t, k); },
                                       2 * (1 - nu * nu) / E, t, R};
  const analytic::PunchResult exact = punch.sphere(d, 1.6 * std::sqrt(R * d));
  std::vector<double> off;
  for (const int n : {16, 24}) {
    JointModel model = empty_model();
    PartMesh mesh = block_of(ElementShape::Hex8, {n, n, n / 4}, {16, 16, t}, isotropic_stiffness(E, nu));
    for (Vector3d& x : mesh.nodes) {
      x -= Vector3d(8, 8, t);
      for (int k = 0; k < 2; ++k) x[k] *= 0.35 + 0.65 * std::abs(x[k]) / 8;  // finer in the middle
      x[2] *= 0.5 + 0.5 * std::abs(x[2]) / t;
    }
    add_mesh(model, mesh, "block", E, nu);
    FixedNodes base;
    base.xyz = {true, true, true};
    for (int i = 0; i < mesh.size(); ++i)
      if (mesh.nodes[at(i)][2] < 1e-9 - t) base.nodes.push_back(i);
    model.fixed_nodes.push_back(base);
    const int top = add_surface(model, "top", facets_at(mesh, 0, 1, 4));
    const int ball = add_material(model, "ball", true);
    const int sphere = add_rigid_surface(
        model, "sphere", 20, 20,
        [&](double u, double v) {
          const double x = 10 * v - 5, y = 10 * u - 5;
          return Vector3d(x, y, R - std::sqrt(R * R - x * x - y * y));
        },
        ball);
    add_contact(model, "contact", top, sphere);
    fix(model, ball, {true, true, false, true, true, true});
    prescribe(model, ball, 2, -d);
    Settings settings;
    settings.part = {"block"};
    const Solved s = solve(model, settings);
    ASSERT_EQ(s.joint.parts.size(), 1u);
    EXPECT_FALSE(s.joint.parts[0].free());
    const double force = s.e.contact_on_target[0][2];
    off.push_back(force / exact.force - 1);
    EXPECT_NEAR(force / exact.force, 1, 0.02);
    const double peak = *std::max_element(s.e.springs[0].pressure.begin(), s.e.springs[0].pressure.end());
    EXPECT_NEAR(peak / exact.peak, 1, n == 16 ? 0.08 : 0.04);
    // no checkerboard: well inside, two halves of a facet differ little
    double most = 0;
    for (int i = 0; i + 1 < s.e.springs[0].size(); i += 2) {
      const double a = s.e.springs[0].pressure[at(i)], b = s.e.springs[0].pressure[at(i + 1)];
      if (std::min(a, b) > 0.5 * peak) most = std::max(most, std::abs(a - b));
    }
    EXPECT_LT(most, 0.2 * peak);
  }
  EXPECT_LT(std::abs(off[1]), std::max(0.01, std::abs(off[0])));
}

/// The same disc, plates and motion turned by a right angle about x: the same force and the same shape.
TEST(Parts, TurnedJointIsTheSame) {
  const Pressed in = block_between_plates(10, 0.3, 0.1);
  Pressed turned = in;
  Eigen::Matrix3d R;
  R << 1, 0, 0, 0, 0, -1, 0, 1, 0;  // z becomes -y
  for (Vector3d& x : turned.model.nodes) x = R * x;
  turned.model.rigid_fixed[1].dofs = {true, false, true, true, true, true};
  turned.model.rigid_prescribed[0].dof = 1;
  turned.model.rigid_prescribed[0].value.factor = 0.1;
  const Solved a = solve(in.model), b = solve(turned.model);
  EXPECT_LT((R * Vector3d(a.e.contact_on_target[0].head<3>()) - b.e.contact_on_target[0].head<3>()).norm(), 1e-8);
  for (int i = 0; i < a.e.springs[0].size(); ++i)
    EXPECT_NEAR(a.e.springs[0].pressure[at(i)], b.e.springs[0].pressure[at(i)], 1e-8);
}

/// Fibres along the load, whichever way the model tells where they lie: with nu = 0 the force is (E + Ef) A d/h.
TEST(Parts, FibresStiffenAlongThemselves) {
  const double E = 10, d = 0.1;
  const Fibres fibres{Fibres::Law::ExpLinear, {0.5, 40, 100, 1.05}, false, {}};
  const auto force = [&](const auto& change, const Settings& settings = {}) {
    JointModel model = block_between_plates(E, 0.0, d).model;
    Material& m = model.materials[at(model.domains[0].material)];
    m.fibres = {fibres};
    change(m, model.domains[0]);
    const Solved s = solve(model, settings);
    EXPECT_EQ(s.e.outcome, Outcome::Balanced) << s.e.message;
    const auto told = std::find_if(s.joint.findings.begin(), s.joint.findings.end(),
                                   [](const Finding& f) { return f.code == "part-fibres"; });
    EXPECT_NE(told, s.joint.findings.end());
    return std::pair(std::abs(s.e.contact_on_target[0][2]) / (36 * d / 3), told->form);
  };
  const auto expect = [&](const std::pair<double, int>& found, double modulus) {
    EXPECT_NEAR(found.first, modulus, 1e-6 * modulus);
    EXPECT_EQ(found.second, 0);
  };
  const double along = E + 0.5 * 40;
  expect(force([](Material& m, Domain&) { m.fibres[0].direction.vector = Vector3d::UnitZ(); }), along);
  expect(force([](Material&, Domain&) {}), E);  // FEBio's default: along x
  expect(force([](Material& m, Domain&) {
           m.fibres[0].direction = {Direction::By::Nodes, Vector3d::UnitX(), {0, 4}};
         }),
         along);
  expect(force([](Material& m, Domain&) {
           m.fibres[0].axes = {{Axes::By::Vectors, Vector3d::UnitZ(), Vector3d::UnitX(), {0, 1, 3}}};
         }),
         along);
  expect(force([](Material& m, Domain&) {
           m.fibres[0].axes = {{Axes::By::Nodes, Vector3d::UnitX(), Vector3d::UnitY(), {0, 4, 1}}};
         }),
         along);
  const auto per_element = [](Material& m, Domain& of) {
    m.fibres[0].direction.by = Direction::By::Unknown;  // the elements' own count
    of.fibre[""].assign(of.element_ids.size(), Vector3d::UnitZ());
  };
  expect(force(per_element), along);
  expect(force([](Material& m, Domain& of) {
           m.fibres[0].direction.by = Direction::By::Element;
           of.axes.assign(of.element_ids.size(), *axes_from(Vector3d::UnitZ(), Vector3d::UnitX()));
         }),
         along);
  Settings drawn;
  drawn.fibre_strain = 0.06;
  expect(force(per_element, drawn), E + 100);
  const Axes to_z{Axes::By::Vectors, Vector3d::UnitZ(), Vector3d::UnitX()},  // axes y, z, x: twice is z, x, y
      y_z_x{Axes::By::Vectors, Vector3d::UnitY(), Vector3d::UnitZ()};
  expect(force([&](Material& m, Domain&) { m.fibres[0].axes = {y_z_x, y_z_x}; }), along);
  expect(force([&](Material& m, Domain& of) {  // those of an element take the place of the first
           m.fibres[0].axes = {to_z, y_z_x};
           of.axes.assign(of.element_ids.size(), *axes_from(y_z_x.a, y_z_x.d));
         }),
         along);
  expect(force([](Material& m, Domain&) {  // from a centre far below
           m.fibres[0].direction.by = Direction::By::Spherical;
           m.fibres[0].direction.center = Vector3d(3, 3, -1e9);
         }),
         along);
  expect(force([](Material& m, Domain& of) {  // data of other fibres of a mixture
           m.fibres.push_back(m.fibres[0]);
           m.fibres[1].path = "solid[1]";
           of.fibre["solid[1]"].assign(of.element_ids.size(), Vector3d::UnitZ());
         }),
         along);
  const auto unknown = force([](Material& m, Domain&) { m.fibres[0].direction.by = Direction::By::Unknown; });
  EXPECT_NEAR(unknown.first, E, 1e-5);
  EXPECT_EQ(unknown.second, 1) << "told as left out";
}

/// A stiffness that no E and nu tell: the force of a disc that may widen is that of its modulus along the load, and it
/// widens by its two Poisson's ratios. Fung's without change of volume have their own K: on paper, by the compliance.
TEST(Parts, StiffnessInAxes) {
  const double d = 0.02;
  const Matrix6d own = *orthotropic_stiffness({140, 20, 30}, {50, 11, 60}, {0.4, 0.3, 0.1}),
                 fung = deviatoric_stiffness(own) + lame_stiffness(0, 90);
  for (const bool uncoupled : {false, true}) {
    JointModel model = block_between_plates(1, 0.0, d).model;
    Material& m = model.materials[at(model.domains[0].material)];
    m.E = m.nu = kNaN;
    const Axes second_up{Axes::By::Vectors, Vector3d::UnitX(), Vector3d::UnitZ()};  // 1, 2, 3: x, z, -y
    m.stiffness = {{uncoupled ? deviatoric_stiffness(own) : own, {second_up}}};
    if (uncoupled) m.stiffness.push_back({lame_stiffness(0, 90), {}});
    const Solved s = solve(model);
    EXPECT_EQ(s.e.outcome, Outcome::Balanced) << s.e.message;
    const Matrix6d compliance = (uncoupled ? fung : own).inverse();
    const double F = 36 * d / 3 / compliance(1, 1);
    EXPECT_NEAR(std::abs(s.e.contact_on_target[0][2]), F, 1e-6 * F);
    if (!uncoupled) {
      EXPECT_NEAR(1 / compliance(1, 1), 20, 1e-9);
    }
    const int side = s.joint.contacts[0].layers[s.joint.contacts[0].source].part >= 0 ? 0 : 1;
    const Eigen::MatrixX3d& u = s.e.springs[0].part_motion[side];
    const double wider = -compliance(0, 1) / compliance(1, 1) * d / 3,
                 thicker = -compliance(2, 1) / compliance(1, 1) * d / 3;
    for (int i = 0; i < u.rows(); ++i) {
      const Vector3d x = s.joint.parts[0].mesh.nodes[at(i)] - Vector3d(3, 3, 1.5);
      EXPECT_LT((u.row(i).transpose() - Vector3d(wider * x[0], thicker * x[1], -d / 3 * x[2])).norm(), 1e-7);
    }
  }
}

/// A disc with fluid in it: free to widen it has E of its solid, at once 3 G (less 0.07% for nu is 0.499); between
/// walls it would have the aggregate modulus of these.
TEST(Parts, OfAFluidFilledSolid) {
  const double E = 0.5, nu = 0.1, d = 0.02, G = E / (2 * (1 + nu));
  for (const bool instant : {false, true}) {
    JointModel model = block_between_plates(E, nu, d).model;
    Material& m = model.materials[at(model.domains[0].material)];
    m.fluid = true;
    m.type = "biphasic/neo-Hookean";
    Settings settings;
    settings.instant = instant;
    const double modulus = instant ? 2 * G * 1.499 : E, ratio = instant ? 0.499 : nu;
    const Solved s = solve(model, settings);
    EXPECT_EQ(s.e.outcome, Outcome::Balanced) << s.e.message;
    EXPECT_NEAR(std::abs(s.e.contact_on_target[0][2]), 36 * modulus * d / 3, 1e-5 * 36 * modulus * d / 3);
    const double aggregate = modulus * (1 - ratio) / ((1 + ratio) * (1 - 2 * ratio));
    EXPECT_NEAR(s.joint.parts[0].mesh.elastic[0](2, 2), aggregate, 1e-9 * aggregate);
    const auto told = std::find_if(s.joint.findings.begin(), s.joint.findings.end(),
                                   [](const Finding& f) { return f.code == "part-fluid"; });
    ASSERT_NE(told, s.joint.findings.end());
    EXPECT_EQ(told->form, instant ? 1 : 0);
    EXPECT_EQ(told->values[2], (NamedValue{"type", "biphasic"}));
    EXPECT_NEAR(std::get<double>(told->values[3].value.is), E / (3 * (1 - 2 * nu)), 1e-12);
    EXPECT_NEAR(std::get<double>(told->values[4].value.is), 2 * G * 1.499 / (3 * 0.002), 1e-9);
  }
}

/// Where nothing presses a part at first, and then something does.
TEST(Parts, AreMetOnTheWay) {
  JointModel model = block_between_plates(10, 0.3, 0.1).model;
  const Joint joint = make_joint(model, {});
  const SpringBeds beds = make_spring_beds(joint);
  const std::vector<Pose> start = reference_poses(joint);
  Equilibrium e = solve_equilibrium(joint, beds, make_load_case(model, joint, {}, 0, 0.0), start, start);
  for (const double time : {0.5, 1.0})
    e = solve_equilibrium(joint, beds, make_load_case(model, joint, {}, 0, time), e.poses, start);
  EXPECT_EQ(e.outcome, Outcome::Balanced) << e.message;
  EXPECT_NEAR(e.contact_on_target[1][2], -12, 1e-5);
  PressMemory memory;  // of a pose at which the plates are far away
  const SpringBed& bed = beds.beds[0];
  Pose away = start[at(bed.target_body)];
  away.center[2] += 5;
  press_springs(bed, start[at(bed.source_body)], away, {}, &memory);
  away.center[2] -= 5.01;
  const SpringStates met = press_springs(bed, start[at(bed.source_body)], away, {}, &memory);
  EXPECT_GT(*std::max_element(met.pressure.begin(), met.pressure.end()), 0.0);
}

/// What cannot be taken into account is refused, with what to do.
TEST(Parts, AreRefusedWithAReason) {
  Pressed in = block_between_plates(10, 0.3, 0.1);
  Settings linear;
  linear.law = Law::Linear;
  EXPECT_THROW(make_joint(in.model, linear), InputError);
  Settings wrong;
  wrong.part = {"upper"};
  EXPECT_THROW(make_joint(in.model, wrong), UsageError) << "it is rigid";
  for (const double x : {0.0, 3.0, 6.0}) hold_end(in.model, x, "body at " + std::to_string(x));
  EXPECT_THROW(make_joint(in.model, {}), InputError) << "three bodies hold it";
}

}  // namespace
}  // namespace dea::parts_test

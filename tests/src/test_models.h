// tests/src/test_models.h – small joint models made in memory, with answers known on paper.
#pragma once
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "src/base/numbers.h"
#include "src/model/joint_model.h"

namespace dea::test {

/// The law whose answers on paper the tests know.
inline Settings linear(const std::string& source = "") {
  Settings settings;
  settings.law = Law::Linear;
  settings.source = source;
  return settings;
}

using dea::kPi;
inline constexpr double kE = 11.85, kNu = 0.45;

/// Point of a patch for parameters u, v in [0, 1].
using Patch = std::function<Vector3d(double, double)>;

inline int add_material(JointModel& model, const std::string& name, bool rigid, double E = kE, double nu = kNu) {
  Material m;
  m.id = static_cast<int>(model.materials.size()) + 1;
  m.name = name;
  m.type = rigid ? "rigid body" : "neo-Hookean";
  m.rigid = rigid;
  if (rigid) m.center_of_mass = Vector3d::Zero();
  if (!rigid) {
    m.E = E;
    m.nu = nu;
  }
  model.materials.push_back(m);
  return m.id - 1;
}

inline int add_nodes(JointModel& model, int nu, int nv, const Patch& patch) {
  const int first = static_cast<int>(model.nodes.size());
  for (int j = 0; j <= nv; ++j) {
    for (int i = 0; i <= nu; ++i) {
      model.node_ids.push_back(static_cast<int>(model.nodes.size()) + 1);
      model.nodes.push_back(patch(static_cast<double>(i) / nu, static_cast<double>(j) / nv));
    }
  }
  return first;
}

/// Quads over a grid of nodes starting at `first`; `flip`: the other way round.
inline std::vector<int> grid_quads(int first, int nu, int nv, bool flip) {
  std::vector<int> q;
  for (int j = 0; j < nv; ++j) {
    for (int i = 0; i < nu; ++i) {
      const int a = first + j * (nu + 1) + i, b = a + 1, c = b + nu + 1, d = a + nu + 1;
      if (flip)
        q.insert(q.end(), {a, d, c, b});
      else
        q.insert(q.end(), {a, b, c, d});
    }
  }
  return q;
}

inline Domain quad_domain(const std::string& name, int material, std::vector<int> nodes) {
  Domain d;
  d.name = name;
  d.shape = ElementShape::Quad4;
  d.material = material;
  for (std::size_t i = 0; i < nodes.size() / 4; ++i) d.element_ids.push_back(static_cast<int>(i) + 1);
  d.nodes = std::move(nodes);
  return d;
}

inline int add_surface(JointModel& model, const std::string& name, const std::vector<int>& quads) {
  Surface s;
  s.name = name;
  s.nodes = quads;
  for (std::size_t i = 4; i <= quads.size(); i += 4) s.begin.push_back(static_cast<int>(i));
  model.surfaces.push_back(s);
  return static_cast<int>(model.surfaces.size()) - 1;
}

/// A layer of hex8 elements between the bone patch (rigid shells of material `bone`) and the articular patch, with
/// `elements` through the thickness. d/du x d/dv of both patches must point from the bone to the articular side.
/// Returns the articular surface.
inline int add_layer(JointModel& model, const std::string& name, int nu, int nv, int elements, const Patch& bone_patch,
                     const Patch& articular_patch, int cartilage, int bone) {
  std::vector<int> first;
  for (int k = 0; k <= elements; ++k) {
    const double z = static_cast<double>(k) / elements;
    first.push_back(add_nodes(model, nu, nv, [&](double u, double v) -> Vector3d {
      return (1 - z) * bone_patch(u, v) + z * articular_patch(u, v);
    }));
  }
  Domain d;
  d.name = name;
  d.shape = ElementShape::Hex8;
  d.material = cartilage;
  for (int k = 0; k < elements; ++k) {
    const std::vector<int> low = grid_quads(first[static_cast<std::size_t>(k)], nu, nv, false);
    const std::vector<int> high = grid_quads(first[static_cast<std::size_t>(k) + 1], nu, nv, false);
    for (std::size_t q = 0; q < low.size(); q += 4) {
      d.nodes.insert(d.nodes.end(), low.begin() + static_cast<std::ptrdiff_t>(q),
                     low.begin() + static_cast<std::ptrdiff_t>(q) + 4);
      d.nodes.insert(d.nodes.end(), high.begin() + static_cast<std::ptrdiff_t>(q),
                     high.begin() + static_cast<std::ptrdiff_t>(q) + 4);
      d.element_ids.push_back(static_cast<int>(d.element_ids.size()) + 1);
    }
  }
  model.domains.push_back(d);
  model.domains.push_back(quad_domain(name + " bone", bone, grid_quads(first.front(), nu, nv, true)));
  return add_surface(model, name, grid_quads(first.back(), nu, nv, false));
}

/// A bare rigid surface; du x dv points to its partner.
inline int add_rigid_surface(JointModel& model, const std::string& name, int nu, int nv, const Patch& patch,
                             int material) {
  const std::vector<int> quads = grid_quads(add_nodes(model, nu, nv, patch), nu, nv, false);
  model.domains.push_back(quad_domain(name, material, quads));
  return add_surface(model, name, quads);
}

inline void add_contact(JointModel& model, const std::string& name, int primary, int secondary) {
  Contact c;
  c.name = name;
  c.type = "sliding-elastic";
  c.primary = primary;
  c.secondary = secondary;
  model.contacts.push_back(c);
}

inline void fix(JointModel& model, int material, std::array<bool, 6> dofs) {
  RigidFixed f;
  f.material = material;
  f.dofs = dofs;
  model.rigid_fixed.push_back(f);
}

inline void force(JointModel& model, int material, const Vector3d& f) {
  for (int k = 0; k < 3; ++k) {
    if (f[k] == 0) continue;
    RigidLoad l;
    l.material = material;
    l.dof = k;
    l.value = {f[k], 0};
    model.rigid_loads.push_back(l);
  }
}

inline void prescribe(JointModel& model, int material, int dof, double value) {
  RigidPrescribed p;
  p.material = material;
  p.dof = dof;
  p.value = {value, 0};
  model.rigid_prescribed.push_back(p);
}

/// A spring between points of two rigid materials.
inline RigidSpring& add_rigid_spring(JointModel& model, int a, const Vector3d& on_a, int b, const Vector3d& on_b,
                                     double k) {
  RigidSpring& s = model.rigid_springs.emplace_back();
  s.name = "ligament";
  s.material_a = a;
  s.material_b = b;
  s.insertion_a = on_a;
  s.insertion_b = on_b;
  s.k = k;
  return s;
}

/// A force along the line between points of two rigid materials.
inline RigidAxialForce& add_muscle(JointModel& model, int a, const Vector3d& on_a, int b, const Vector3d& on_b,
                                   double force) {
  RigidAxialForce& muscle = model.rigid_axial_forces.emplace_back();
  muscle.name = "muscle";
  muscle.material_a = a;
  muscle.material_b = b;
  muscle.point_a = on_a;
  muscle.point_b = on_b;
  muscle.force = {force, 0};
  return muscle;
}

/// A model with one step from 0 to 1 in `states` states and a ramp as controller 0.
inline JointModel empty_model(int states = 1) {
  JointModel model;
  model.files = {"test.feb"};
  model.version = "4.0";
  LoadController ramp;
  ramp.id = 1;
  ramp.points = {{0, 0}, {1, 1}};
  model.controllers.push_back(ramp);
  Step step;
  step.name = "step";
  step.duration = 1.0;
  step.step_size = 1.0 / states;
  model.steps.push_back(step);
  return model;
}

/// Square [-1, 1]^2 onto the hemisphere z >= 0 of radius R without a singular point;
/// du x dv points outwards.
inline Vector3d hemisphere(double R, double u, double v) {
  const double a = 2 * u - 1, b = 2 * v - 1;
  double r, phi;
  if (a == 0 && b == 0) return {0, 0, R};
  if (std::abs(a) >= std::abs(b)) {
    r = a;
    phi = kPi / 4 * (b / a);
  } else {
    r = b;
    phi = kPi / 2 - kPi / 4 * (a / b);
  }
  // Rings closer together at the equator than the nodes along it: the quads at the square's corners, which have three
  // nodes on the rim, are then cut from the corner inwards and no triangle lies in the rim's plane.
  const double theta = kPi / 2 * (1.3 * std::abs(r) - 0.3 * r * r), s = r < 0 ? -std::sin(theta) : std::sin(theta);
  return R * Vector3d(s * std::cos(phi), s * std::sin(phi), std::cos(theta));
}

/// Concentric spheres (docs/theory.md, section 7.1): rigid ball of radius 20 in a socket of radius 24, its 4 mm layer
/// on the socket (n x n facets); the ball reaches beyond the equator. Materials: 0 cartilage, 1 socket, 2 ball.
inline JointModel concentric_spheres(int n, double load, bool two_layers = false, int states = 1) {
  JointModel model = empty_model(states);
  const int cartilage = add_material(model, "cartilage", false), socket = add_material(model, "socket", true),
            ball = add_material(model, "ball", true);
  const double R = two_layers ? 22.0 : 20.0;
  // the socket's layer faces inwards: u and v exchanged turn the normal
  const int s = add_layer(
      model, "socket articular", n, n, 1, [](double u, double v) { return hemisphere(24, v, u); },
      [&](double u, double v) { return hemisphere(R, v, u); }, cartilage, socket);
  int b;
  if (two_layers) {
    b = add_layer(
        model, "ball articular", n, n, 1, [](double u, double v) { return hemisphere(20, u, v); },
        [](double u, double v) { return hemisphere(22, u, v); }, cartilage, ball);
  } else {
    // a longitude-latitude cap would have a singular pole: six-sided cube sphere, lower sides too
    b = add_rigid_surface(
        model, "ball articular", n, n,
        [](double u, double v) -> Vector3d {
          // polar angle up to 110 degrees
          const Vector3d x = hemisphere(1.0, u, v);
          const double theta = std::acos(std::min(1.0, x.z())) * 110.0 / 90.0, rho = std::hypot(x.x(), x.y());
          if (rho == 0) return {0, 0, 20};
          return 20.0 * Vector3d(std::sin(theta) * x.x() / rho, std::sin(theta) * x.y() / rho, std::cos(theta));
        },
        ball);
  }
  add_contact(model, "joint", s, b);
  fix(model, socket, {true, true, true, true, true, true});
  fix(model, ball, {false, false, false, true, true, true});
  force(model, ball, {0, 0, load});
  return model;
}

/// A flat layer of thickness h, `size` wide, centred at the origin, top at z = 0, on rigid material "base", under a
/// rigid plate of the same size at z = gap of material "plate". Materials: 0 cartilage, 1 base, 2 plate.
inline JointModel flat_plates(int n, double size, double h, double gap, double plate_size = 0.0) {
  JointModel model = empty_model();
  const int cartilage = add_material(model, "cartilage", false), base = add_material(model, "base", true),
            plate = add_material(model, "plate", true);
  const double top = plate_size > 0 ? plate_size : size;
  const int a = add_layer(
      model, "layer", n, n, 2, [=](double u, double v) { return Vector3d(size * (u - 0.5), size * (v - 0.5), -h); },
      [=](double u, double v) { return Vector3d(size * (u - 0.5), size * (v - 0.5), 0); }, cartilage, base);
  const int b = add_rigid_surface(
      model, "plate", n, n, [=](double u, double v) { return Vector3d(top * (v - 0.5), top * (u - 0.5), gap); }, plate);
  add_contact(model, "press", a, b);
  fix(model, base, {true, true, true, true, true, true});
  return model;
}

/// A row of bones along z, 20 apart: each stands with a ball (radius 10) in the dish of cartilage (radius 12, 1.5
/// thick) of the one below, four stretched ligaments across each joint, and each is tethered sideways to the ground.
/// The lowest is held, the highest carries `load` downwards, every fifth is pushed sideways. Materials: 0 cartilage, 1
/// .. bones.
inline JointModel bone_chain(int bones, int n, double load) {
  JointModel model = empty_model();
  const int cartilage = add_material(model, "cartilage", false);
  for (int b = 0; b < bones; ++b) {
    const int m = add_material(model, "bone " + std::to_string(b + 1), true);
    model.materials[static_cast<std::size_t>(m)].center_of_mass = Vector3d(0, 0, 20.0 * b);
  }
  const auto cap = [](double radius, double z, double half, double u, double v) {
    const double x = half * (2 * u - 1), y = half * (2 * v - 1);
    return Vector3d(x, y, z + radius - std::sqrt(radius * radius - x * x - y * y));
  };
  std::vector<int> dish, ball;
  for (int b = 0; b < bones; ++b) {
    const double z = 20.0 * b;
    if (b > 0)
      ball.push_back(add_rigid_surface(
          model, "ball " + std::to_string(b + 1), n, n, [&](double u, double v) { return cap(10, z - 10, 6, v, u); },
          1 + b));
    if (b + 1 < bones)
      dish.push_back(add_layer(
          model, "dish " + std::to_string(b + 1), n, n, 1,
          [&](double u, double v) { return cap(13.5, z + 8.5, 6.9, u, v); },
          [&](double u, double v) { return cap(12, z + 10, 6, u, v); }, cartilage, 1 + b));
  }
  for (int b = 0; b + 1 < bones; ++b) {
    add_contact(model, "joint " + std::to_string(b + 1), dish[static_cast<std::size_t>(b)],
                ball[static_cast<std::size_t>(b)]);
    for (int k = 0; k < 4; ++k) {
      RigidSpring s;
      s.name = "ligament " + std::to_string(4 * b + k + 1);
      s.material_a = 1 + b;
      s.material_b = 2 + b;
      const Vector3d side = (k < 2 ? 10.0 : -10.0) * (k % 2 ? Vector3d::UnitX() : Vector3d::UnitY());
      s.insertion_a = side + Vector3d(0, 0, 20.0 * b + 5);
      s.insertion_b = side + Vector3d(0, 0, 20.0 * b + 15);
      s.k = 150;
      s.free_length = 9;
      model.rigid_springs.push_back(s);
    }
    for (int k = 0; k < 2; ++k) {
      RigidSpring s;
      s.name = "tether";
      s.material_a = 2 + b;
      s.material_b = 1;
      s.insertion_a = Vector3d(0, 0, 20.0 * (b + 1));
      s.insertion_b = s.insertion_a + 1e4 * (k == 0 ? Vector3d::UnitX() : Vector3d::UnitY());
      s.k = 20;
      model.rigid_springs.push_back(s);
    }
    if (b % 5 == 2) force(model, 2 + b, {5, 2, 0});
  }
  fix(model, 1, {true, true, true, true, true, true});
  force(model, bones, {0, 0, -load});
  return model;
}

}  // namespace dea::test

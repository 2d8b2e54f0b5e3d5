#include "src/joint/placing.h"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/base/rotations.h"
#include "src/base/say.h"

namespace dea {

namespace {

constexpr double kDegree = kPi / 180.0;

/// What a body is turned about, and how that is called.
struct Turn {
  Vector3d reference = Vector3d::Zero();
  std::string name;
};
Turn turn_of(const Joint& joint, int body, const TurnPoint& about, const std::string& name) {
  switch (about.kind) {
    case TurnPoint::Kind::Point:
      return {about.point, "the point"};
    case TurnPoint::Kind::CenterOfMass:
      return {joint.bodies[at(body)].center_of_mass, "its centre of mass"};
    case TurnPoint::Kind::SphereCenter:
      break;
  }
  const SphereFit sphere =
      articular_sphere(joint, body, {"rotate", name},
                       say("name the point to turn about: {}", NamedSetting{"rotate-about", name, "x,y,z"}));
  return {sphere.center,
          fmt::format("the centre of its articular surface's sphere (radius {:.4g}, rms distance {:.2g}),",
                      sphere.radius, sphere.rms)};
}

int placed_body(const JointModel& model, const Joint& joint, const Placement& p) {
  const int body = joint.find_body(model, p.body);
  if (joint.bodies[at(body)].ground)
    throw UsageError(Fault{.given = NamedSetting{p.kind == Placement::Kind::Rotate ? "rotate" : "move", p.body},
                           .found = "the ground never moves;",
                           .expected = "name a rigid body"});
  return body;
}

/// Each placement in turn. `done(placement, turn, point)`: after one, with the place about which it turned.
template <class Done>
std::vector<Pose> place_bodies(const JointModel& model, const Joint& joint, const Settings& settings,
                               const Done& done) {
  std::vector<Pose> poses = reference_poses(joint);
  for (const Placement& p : settings.placements) {
    const int body = placed_body(model, joint, p);
    Pose& pose = poses[at(body)];
    const Vector3d vector = global_vector(settings, p);
    if (p.kind == Placement::Kind::Move) {
      pose.center += vector;
      done(p, Turn{}, pose.center);
      continue;
    }
    const auto given = settings.rotate_about.find(p.body);
    const Turn turn = turn_of(joint, body, given == settings.rotate_about.end() ? TurnPoint{} : given->second, p.body);
    const Vector3d point = pose.center + pose.rotation * (turn.reference - joint.bodies[at(body)].center_of_mass);
    const Eigen::Matrix3d Q = rotation(p.degrees * kDegree * vector.normalized());
    pose.center = point + Q * (pose.center - point);
    pose.rotation = Q * pose.rotation;
    done(p, turn, point);
  }
  return poses;
}

}  // namespace

SphereFit articular_sphere(const Joint& joint, int body, const NamedSetting& given, const Sentence& expected) {
  const auto refuse = [&](Sentence found) {
    throw UsageError(Fault{.given = given, .found = std::move(found), .expected = expected});
  };
  std::set<int> surfaces;
  const Layer* layer = nullptr;
  for (const ContactPair& pair : joint.contacts)
    for (const Layer& l : pair.layers)
      if (l.body == body && surfaces.insert(l.surface).second) layer = &l;
  if (!layer) refuse("this body has no articular surface, so no sphere;");
  if (surfaces.size() > 1)
    refuse(say("this body has {} articular surfaces, each with a sphere of its own;", surfaces.size()));
  const SphereFit sphere = fit_sphere(layer->articular);
  const Roundness shape = roundness(layer->articular, sphere);
  if (shape == Roundness::Uneven)
    refuse(
        say("its articular surface is no sphere: the points lie {:.3g} from one of radius {:.3g} (root mean square);",
            sphere.rms, sphere.radius));
  if (shape == Roundness::Flat)  // it has no centre: that of its sphere lies anywhere
    refuse(say("its articular surface is nearly flat (sphere of radius {:.3g});", sphere.radius));
  return sphere;
}

std::vector<Pose> reference_poses(const Joint& joint) {
  std::vector<Pose> poses;
  for (const Body& b : joint.bodies) poses.push_back({b.center_of_mass, Eigen::Matrix3d::Identity()});
  return poses;
}

Vector3d turn_point(const Joint& joint, int body, const TurnPoint& about, const std::string& name) {
  return turn_of(joint, body, about, name).reference;
}

std::vector<Pose> starting_poses(const JointModel& model, const Joint& joint, const Settings& settings) {
  return place_bodies(model, joint, settings, [](const Placement&, const Turn&, const Vector3d&) {});
}

Findings placement_findings(const JointModel& model, const Joint& joint, const Settings& settings) {
  Findings found;
  place_bodies(model, joint, settings, [&](const Placement& p, const Turn& turn, const Vector3d& point) {
    const Vector3d v = global_vector(settings, p);
    const std::string frame = p.frame.empty() ? "" : fmt::format(" (given in frame \"{}\")", p.frame);
    std::vector<NamedValue> values = {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}, {"frame", frame}};
    if (p.kind == Placement::Kind::Rotate)
      values.insert(values.end(), {{"degrees", p.degrees},
                                   {"center", turn.name},
                                   {"center_x", point.x()},
                                   {"center_y", point.y()},
                                   {"center_z", point.z()}});
    found.push_back({"placed", {.body = p.body}, std::move(values), p.kind == Placement::Kind::Move ? 0 : 1});
  });
  return found;
}

JointModel placed_model(const JointModel& model, const Joint& joint, const Settings& settings) {
  const std::vector<Pose> start = starting_poses(model, joint, settings);
  JointModel placed = model;
  const auto place = [&](int body, const Vector3d& x) -> Vector3d {
    if (body < 0) return x;
    return start[at(body)].center + start[at(body)].rotation * (x - joint.bodies[at(body)].center_of_mass);
  };
  const auto move_point = [&](int material, Vector3d& x) { x = place(joint.body_of(material), x); };
  const auto turn = [&](int material, Vector3d& v) {  // from a centre of mass, or a direction of the body
    const int b = joint.body_of(material);
    if (b >= 0) v = start[at(b)].rotation * v;
  };
  const auto put = [&](int material, bool from_center, Vector3d& x) {
    from_center ? turn(material, x) : move_point(material, x);
  };
  for (std::size_t i = 0; i < placed.nodes.size(); ++i) placed.nodes[i] = place(joint.node_body[i], model.nodes[i]);
  for (std::size_t m = 0; m < placed.materials.size(); ++m)
    if (placed.materials[m].center_of_mass) move_point(static_cast<int>(m), *placed.materials[m].center_of_mass);
  for (RigidSpring& s : placed.rigid_springs) {
    if (s.free_length == 0.0) s.free_length = (s.insertion_b - s.insertion_a).norm();
    move_point(s.material_a, s.insertion_a);
    move_point(s.material_b, s.insertion_b);
  }
  for (RigidFollower& f : placed.rigid_followers) {
    put(f.material, f.from_center, f.insertion);
    turn(f.material, f.value);
  }
  for (RigidLoad& l : placed.rigid_loads)
    if (l.kind == RigidLoad::Kind::Follower && joint.body_of(l.material) >= 0 &&
        !start[at(joint.body_of(l.material))].rotation.isIdentity(1e-15))
      throw fault_at(model, l.origin, say("load \"{}\" turns with a body that is placed turned;", l.name),
                     "turn its components in the model, or place the body without turning it");
  for (RigidAxialForce& f : placed.rigid_axial_forces) {
    put(f.material_a, f.from_centers, f.point_a);
    put(f.material_b, f.from_centers, f.point_b);
  }
  for (RigidCable& c : placed.rigid_cables)
    for (RigidCable::Point& p : c.points) put(p.material, c.from_centers, p.position);
  for (RigidJoint& j : placed.rigid_joints) {  // its frame goes with body A
    move_point(j.material_a, j.joint_origin);
    const int a = joint.body_of(j.material_a);
    if (a >= 0) j.axes = start[at(a)].rotation * j.axes;
  }
  for (const DiscreteSprings& s : model.discrete_springs)
    for (const auto& pair : model.discrete_sets[at(s.set)].pairs) {
      const double before = (model.nodes[at(pair[1])] - model.nodes[at(pair[0])]).norm(),
                   after = (placed.nodes[at(pair[1])] - placed.nodes[at(pair[0])]).norm();
      if (std::abs(after - before) <= 1e-9 * before) continue;
      throw fault_at(model, s.origin,
                     say("spring \"{}\" has its free length from where its nodes stand ({:.4g}), and they are placed "
                         "{:.4g} apart;",
                         s.name, before, after),
                     "a converted file cannot say that; make it a rigid spring with a free_length of its own");
    }
  return placed;
}

}  // namespace dea

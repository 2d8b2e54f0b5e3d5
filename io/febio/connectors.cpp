// What joins two rigid bodies: springs, forces along a line, cables, joints. FEBio's conventions are those of
// `RigidJoint` (src/model/joint_model.h): motion of B relative to A, columns e0, e1, e2 of FEBio's joint frame.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/febio/interpret.h"
#include "src/base/numbers.h"

namespace dea::febio {
namespace {

using Motion = RigidJoint::Motion;

constexpr Scaled kNothing = {0.0, 0};

template <class Connector>
void set_bodies(const Draft& draft, const Component& component, Connector& connector, const char* tag_a = "body_a",
                const char* tag_b = "body_b") {
  connector.material_a = body_of(draft, component, tag_a);
  connector.material_b = body_of(draft, component, tag_b);
}

/// A point or direction that may follow a load controller as far as this reader cares.
Vector3d plain_vector(const Draft& draft, const Component& component, const char* tag) {
  const Component* part = find(component, tag);
  return part == nullptr ? Vector3d(0, 0, 0) : to_vector(draft, part->origin, tag, part->text);
}

void rigid_spring(Draft& draft, const Component& component, const Steps& steps) {
  RigidSpring spring;
  set_bodies(draft, component, spring);
  for (const char* tag : {"insertion_a", "insertion_b"}) assume_unless_given(draft, component, tag, "0,0,0");
  assume_unless_given(draft, component, "k", "1");
  assume_unless_given(draft, component, "free_length", "its length at the start");
  spring.insertion_a = plain_vector(draft, component, "insertion_a");
  spring.insertion_b = plain_vector(draft, component, "insertion_b");
  spring.k = number_of(draft, component, "k", 1.0);
  spring.free_length = number_of(draft, component, "free_length", 0.0);
  for (const char* tag : {"k", "free_length", "insertion_a", "insertion_b"}) {
    const Component* part = find(component, tag);
    if (part != nullptr && part->lc)
      unsupported(draft, part->origin, fmt::format("rigid spring whose {} follows a load controller", tag),
                  "take out its lc: DEA keeps it constant");
  }
  add(draft.model.rigid_springs, std::move(spring), component.name, component.origin, steps);
}

/// What a force along the line between two bodies calls its parameters.
struct PullWords {
  const char *body_a, *body_b, *point_a, *point_b, *force;
  const char* relative;  ///< null: the points are never counted from the centres of mass
};

void add_pull(Draft& draft, const Component& component, const PullWords& words, const Steps& steps) {
  RigidAxialForce pull;
  set_bodies(draft, component, pull, words.body_a, words.body_b);
  pull.from_centers = words.relative != nullptr && flag_of(draft, component, words.relative);
  for (const char* tag : {words.point_a, words.point_b})
    if (!pull.from_centers) assume_unless_given(draft, component, tag, "0,0,0");
  assume_unless_given(draft, component, words.force, "0");
  pull.point_a = vector_of(draft, component, words.point_a, Vector3d::Zero());
  pull.point_b = vector_of(draft, component, words.point_b, Vector3d::Zero());
  pull.force = scaled_of(draft, component, words.force);
  add(draft.model.rigid_axial_forces, std::move(pull), component.name, component.origin, steps);
}

// -- joints --------------------------------------------------------------------------------------------

/// A direction of FEBio's joint frame: the parameter, or its default. Zero: it has none.
struct Direction {
  const char* tag;
  Vector3d fallback;
};

/// The direction, or a fault if FEBio has no default for it. `any`: it may be anything, zero too.
Vector3d direction_of(Draft& draft, const Component& component, const Direction& direction, bool any) {
  if (!any && find(component, direction.tag) == nullptr && direction.fallback.isZero(0))
    fail(
        draft, component.origin,
        fmt::format("{} without <{}>, which has no default: add it, a direction x,y,z", component.type, direction.tag));
  return vector_of(draft, component, direction.tag, direction.fallback);
}

/// Columns along `first`, in the plane of `first` and `second`, and normal to both, right-handed. `any_second`: the
/// joint does not need the second direction, so it may be anything.
Eigen::Matrix3d axes_of(Draft& draft, const Component& component, const Direction& first, const Direction& second,
                        bool any_second) {
  const Vector3d a = direction_of(draft, component, first, false);
  Vector3d b = direction_of(draft, component, second, any_second);
  if (!(a.norm() > 0))
    fail(draft, component.origin, fmt::format("{}: {} is zero, expected a direction x,y,z", component.type, first.tag));
  Eigen::Matrix3d axes;
  axes.col(0) = a.normalized();
  if (!(b.norm() > 0) || axes.col(0).cross(b.normalized()).norm() < 1e-6) {
    if (!any_second)
      fail(draft, component.origin,
           fmt::format("{}: {} and {} have the same direction, expected two different ones", component.type, first.tag,
                       second.tag));
    b = axes.col(0).unitOrthogonal();
  }
  axes.col(2) = axes.col(0).cross(b).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

/// One free motion of a joint: FEBio's flag and value where it is prescribed, force or moment where it is not.
struct Free {
  int dof;            ///< of the joint: 0-2 along, 3-5 about the columns
  const char* flag;   ///< "prescribed_rotation"
  const char* value;  ///< "rotation"
  const char* load;   ///< "moment"; null: none
};

/// FEBio's Lagrange multipliers know neither prescribed motion nor loads.
void refuse_lagrange(Draft& draft, const Component& component, const char* what) {
  if (place_of_word(text_of(component, "laugon"), {"PENALTY", "AUGLAG", "LAGMULT"}) != 2) return;
  unsupported(draft, component.origin,
              fmt::format("{} with laugon LAGMULT, where FEBio leaves out its {}", component.type, what),
              "choose AUGLAG");
}

void set_free(Draft& draft, const Component& component, const Free& free, RigidJoint& joint) {
  const Scaled load = free.load == nullptr ? kNothing : scaled_of(draft, component, free.load);
  if (!flag_of(draft, component, free.flag)) {
    joint.motion[at(free.dof)] = Motion::Free;
    joint.value[at(free.dof)] = load;
    if (load.factor != 0) refuse_lagrange(draft, component, free.load);
    return;
  }
  refuse_lagrange(draft, component, free.flag);
  joint.motion[at(free.dof)] = Motion::Prescribed;
  joint.value[at(free.dof)] = scaled_of(draft, component, free.value);
  if (load.factor != 0)
    fail(draft, component.origin,
         fmt::format("{} with {} = 1 and a {} of {:g}, expected one of them", joint.type, free.flag, free.load,
                     load.factor));
}

constexpr std::array kMoments = {"moment_x", "moment_y", "moment_z"};

/// Moments of a spherical joint have global directions, whatever the bodies do: a moment on A, its opposite on B.
void add_moments(Draft& draft, const Component& component, const RigidJoint& joint, const Steps& steps) {
  for (int i = 0; i < 3; ++i) {
    const Component* part = find(component, kMoments[at(i)]);
    if (part == nullptr) continue;
    const Scaled moment = scaled(draft, *part);
    if (moment.factor == 0) continue;
    refuse_lagrange(draft, component, kMoments[at(i)]);
    for (const bool a : {true, false}) {
      const Scaled value = {a ? moment.factor : -moment.factor, moment.controller};
      add(draft.model.rigid_loads, RigidLoad{{}, a ? joint.material_a : joint.material_b, 3 + i, value}, component.name,
          part->origin, steps);
    }
  }
}

void set_spherical(Draft& draft, const Component& component, RigidJoint& joint, const Steps& steps) {
  constexpr std::array kRotations = {"rotation_x", "rotation_y", "rotation_z"};
  const bool prescribed = flag_of(draft, component, "prescribed_rotation");
  for (std::size_t i = 0; i < 3; ++i) {
    joint.motion[3 + i] = prescribed ? Motion::Prescribed : Motion::Free;
    if (!prescribed) continue;
    joint.value[3 + i] = scaled_of(draft, component, kRotations[i]);
    for (const char* moment : kMoments)
      if (scaled_of(draft, component, moment).factor != 0)
        fail(draft, component.origin,
             fmt::format("{} with prescribed_rotation = 1 and a {}, expected one of them", joint.type, moment));
  }
  if (prescribed)
    refuse_lagrange(draft, component, "prescribed_rotation");
  else
    add_moments(draft, component, joint, steps);
}

/// Each motion with its `prescribe_` is held at that value, the others are free. FEBio holds products of axes, which is
/// our rotation only where at most one turns, and is free only about one.
void set_generic(Draft& draft, const Component& component, RigidJoint& joint) {
  constexpr std::array kValues = {"prescribe_x",  "prescribe_y",  "prescribe_z",
                                  "prescribe_Rx", "prescribe_Ry", "prescribe_Rz"};
  int turning = 0, free = 0;
  for (std::size_t i = 0; i < kValues.size(); ++i) {
    const bool given = find(component, kValues[i]) != nullptr;
    const Scaled value = scaled_of(draft, component, kValues[i]);
    joint.motion[i] = !given ? Motion::Free : value.factor == 0 ? Motion::Held : Motion::Prescribed;
    if (joint.motion[i] == Motion::Prescribed) joint.value[i] = value;
    if (i < 3) continue;
    free += given ? 0 : 1;
    turning += joint.motion[i] == Motion::Prescribed ? 1 : 0;
    if (joint.motion[i] == Motion::Prescribed && value.controller <= 0 && std::abs(value.factor) >= kPi / 2)
      unsupported(draft, component.origin, fmt::format("{} with {} beyond a right angle", joint.type, kValues[i]),
                  "prescribe less, or use a rigid revolute joint");
  }
  const bool same = (free == 0 && turning <= 1) || (free == 1 && turning == 0) || free == 3;
  if (!same)
    unsupported(draft, component.origin,
                fmt::format("{} with {} free and {} prescribed rotations", joint.type, free, turning),
                "have no more than one of them, or three free");
}

/// Frame and free motions of the joints that have a frame.
void set_motions(Draft& draft, const Component& c, RigidJoint& joint) {
  const Vector3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), none(0, 0, 0);
  if (joint.type == "rigid revolute joint") {
    assume_unless_given(draft, c, "rotation_axis", "0,0,1");
    joint.axes = axes_of(draft, c, {"rotation_axis", z}, {"transverse_axis", x}, true);
    set_free(draft, c, {3, "prescribed_rotation", "rotation", "moment"}, joint);
    const Component* torsion = find(c, "torsion_stiffness");
    if (torsion != nullptr && to_number(draft, torsion->origin, torsion->tag, torsion->text) != 0)
      unsupported(draft, torsion->origin, "rigid revolute joint with torsion_stiffness",
                  "set it to 0, or give its moment as <moment>");
  } else if (joint.type == "rigid prismatic joint") {
    assume_unless_given(draft, c, "translation_axis", "1,0,0");
    joint.axes = axes_of(draft, c, {"translation_axis", x}, {"transverse_axis", y}, false);
    set_free(draft, c, {0, "prescribed_translation", "translation", "force"}, joint);
  } else if (joint.type == "rigid cylindrical joint") {
    joint.axes = axes_of(draft, c, {"joint_axis", none}, {"transverse_axis", none}, true);
    set_free(draft, c, {0, "prescribed_translation", "translation", "force"}, joint);
    set_free(draft, c, {3, "prescribed_rotation", "rotation", "moment"}, joint);
  } else if (joint.type == "rigid planar joint") {
    const bool any_second =
        !flag_of(draft, c, "prescribed_translation_1") && !flag_of(draft, c, "prescribed_translation_2");
    joint.axes = axes_of(draft, c, {"rotation_axis", none}, {"translation_axis_1", none}, any_second);
    set_free(draft, c, {3, "prescribed_rotation", "rotation", nullptr}, joint);
    set_free(draft, c, {1, "prescribed_translation_1", "translation_1", nullptr}, joint);
    set_free(draft, c, {2, "prescribed_translation_2", "translation_2", nullptr}, joint);
  } else {  // rigid lock
    joint.axes = axes_of(draft, c, {"first_axis", none}, {"second_axis", none}, false);
  }
}

/// False: no joint.
bool rigid_joint(Draft& draft, const Component& component, const Steps& steps) {
  RigidJoint joint;
  joint.type = component.type;
  const bool old = joint.type == "rigid joint", generic = joint.type == "generic rigid joint";
  if (!old && !generic &&
      !one_of(joint.type, {"rigid spherical joint", "rigid revolute joint", "rigid prismatic joint",
                           "rigid cylindrical joint", "rigid planar joint", "rigid lock"}))
    return false;
  joint.value.fill(kNothing);
  set_bodies(draft, component, joint);
  const char* origin = old || generic ? "joint" : "joint_origin";
  assume_unless_given(draft, component, origin, "0,0,0");
  joint.joint_origin = vector_of(draft, component, origin, Vector3d::Zero());
  if (old)
    std::fill(joint.motion.begin() + 3, joint.motion.end(), Motion::Free);
  else if (generic)
    set_generic(draft, component, joint);
  else if (joint.type == "rigid spherical joint")
    set_spherical(draft, component, joint, steps);
  else
    set_motions(draft, component, joint);
  add(draft.model.rigid_joints, std::move(joint), component.name, component.origin, steps);
  return true;
}

}  // namespace

void check_joints(Draft& draft) {
  const JointModel& model = draft.model;
  for (const RigidJoint& joint : model.rigid_joints) {
    if (joint.type != "rigid spherical joint" || joint.motion[3] != Motion::Prescribed) continue;
    std::array<bool, 3> held = {};
    for (const RigidFixed& fixed : model.rigid_fixed) {
      if (fixed.material != joint.material_a || (fixed.step != -1 && fixed.step != joint.step)) continue;
      for (std::size_t i = 0; i < 3; ++i) held[i] = held[i] || fixed.dofs[3 + i];
    }
    for (const RigidPrescribed& motion : model.rigid_prescribed)
      if (motion.material == joint.material_a && motion.dof >= 3) held[at(motion.dof - 3)] = false;
    if (held[0] && held[1] && held[2]) continue;
    unsupported(draft, joint.origin,
                "rigid spherical joint with prescribed_rotation, which has global directions, while body_a can rotate",
                "fix body_a's rotations");
  }
}

void rigid_axial_force(Draft& draft, const Component& component, const Steps& steps) {
  add_pull(draft, component, {"rbA", "rbB", "ra", "rb", "force", "relative"}, steps);
}

void rigid_cable(Draft& draft, const Component& component, const Steps& steps) {
  RigidCable cable;
  cable.from_centers = flag_of(draft, component, "relative", true);
  assume_unless_given(draft, component, "force", "0");
  assume_unless_given(draft, component, "force_direction", "0,0,-1");
  cable.force = scaled_of(draft, component, "force");
  cable.direction = vector_of(draft, component, "force_direction", Vector3d(0, 0, -1));
  if (!(cable.direction.norm() > 0)) fail(draft, component.origin, "force_direction is zero, expected a direction");
  cable.direction.normalize();
  for (const Component& part : component.parts) {
    if (part.tag != "rigid_cable_point") continue;
    if (!cable.from_centers) assume_unless_given(draft, part, "position", "0,0,0");
    cable.points.push_back(
        {body_of(draft, part, "rigid_body_id"), vector_of(draft, part, "position", Vector3d::Zero())});
  }
  if (cable.points.empty())
    fail(draft, component.origin, "rigid_cable without <rigid_cable_point>: add the points it runs through");
  add(draft.model.rigid_cables, std::move(cable), component.name, component.origin, steps);
}

bool rigid_connector(Draft& draft, const Component& component, const Steps& steps) {
  const std::string& type = component.type;
  if (type.rfind("rigid ", 0) != 0 && type != "generic rigid joint") return false;
  if (one_of(type, {"rigid damper", "rigid angular damper"}))
    ignore(draft, component.origin, fmt::format("{}: statics has no velocity", type));
  else if (type == "rigid spring")
    rigid_spring(draft, component, steps);
  else if (type == "rigid contractile force")
    add_pull(draft, component, {"body_a", "body_b", "insertion_a", "insertion_b", "f0", nullptr}, steps);
  else if (!rigid_joint(draft, component, steps))
    unsupported(draft, component.origin, fmt::format("rigid connector {}", quote(type)),
                word_advice(WordOf::Connector, type));
  return true;
}

void other_constraint(Draft& draft, const Component& component) {
  const std::string& type = component.type;
  unsupported(draft, component.origin, fmt::format("constraint {}", quote(type)),
              type == "rigid_wall" ? "mesh the wall as rigid shells and give it a sliding contact, or take it out"
                                   : word_advice(WordOf::Connector, type));
}

}  // namespace dea::febio

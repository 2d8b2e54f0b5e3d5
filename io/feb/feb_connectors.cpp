// What joins two rigid bodies: springs, forces along a line, cables, joints. FEBio's conventions are those of
// `RigidJoint` (src/model/joint_model.h): motion of B relative to A, columns e0, e1, e2 of FEBio's joint frame.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <febiodea/io/feb/feb_reading.h>

namespace dea::feb {
namespace {

using Motion = RigidJoint::Motion;

template <class Condition>
void set_place(const Reading& reading, const XMLElement& element, Condition& condition) {
  condition.step = reading.step;
  condition.name = attribute(element, "name");
  condition.origin = origin_of(reading, element);
}

void set_bodies(const Reading& reading, const XMLElement& element, int& a, int& b, const char* tag_a = "body_a",
                const char* tag_b = "body_b") {
  a = child_body(reading, element, tag_a);
  b = child_body(reading, element, tag_b);
}

void read_spring(Reading& reading, const XMLElement& element) {
  RigidSpring spring;
  set_bodies(reading, element, spring.material_a, spring.material_b);
  const XMLElement* a = element.FirstChildElement("insertion_a");
  const XMLElement* b = element.FirstChildElement("insertion_b");
  if (a != nullptr) spring.insertion_a = read_vector(reading, *a);
  if (b != nullptr) spring.insertion_b = read_vector(reading, *b);
  spring.k = child_double(reading, element, "k", 1.0);
  spring.free_length = child_double(reading, element, "free_length", 0.0);
  for (const char* name : {"k", "free_length", "insertion_a", "insertion_b"}) {
    const XMLElement* child = element.FirstChildElement(name);
    if (child != nullptr && child->Attribute("lc") != nullptr) {
      unsupported(reading, *child, fmt::format("rigid spring whose {} follows a load controller", name),
                  "take out its lc: DEA keeps it constant");
    }
  }
  set_place(reading, element, spring);
  reading.model.rigid_springs.push_back(std::move(spring));
}

/// A number of the file with its controller, 0 if it is not there.
Scaled child_scaled(const Reading& reading, const XMLElement& parent, const char* name) {
  const XMLElement* child = parent.FirstChildElement(name);
  return child == nullptr ? Scaled{0.0, 0} : read_scaled(reading, *child);
}

void read_contractile_force(Reading& reading, const XMLElement& element) {
  RigidAxialForce pull;
  set_bodies(reading, element, pull.material_a, pull.material_b);
  pull.point_a = child_vector(reading, element, "insertion_a", Vector3d::Zero());
  pull.point_b = child_vector(reading, element, "insertion_b", Vector3d::Zero());
  pull.force = child_scaled(reading, element, "f0");
  set_place(reading, element, pull);
  reading.model.rigid_axial_forces.push_back(std::move(pull));
}

// -- joints --------------------------------------------------------------------------------------------

/// A direction of FEBio's joint frame: the child, or its default.
struct Direction {
  const char* tag;
  Vector3d fallback;
};

/// Columns along `first`, in the plane of `first` and `second`, and normal to both, right-handed. `any_second`: the
/// joint does not need the second direction, so it may be anything.
void set_axes(Reading& reading, const XMLElement& element, const Direction& first, const Direction& second,
              bool any_second, RigidJoint& joint) {
  const Vector3d a = child_vector(reading, element, first.tag, first.fallback);
  Vector3d b = child_vector(reading, element, second.tag, second.fallback);
  const auto need = [&](const Direction& direction) {
    if (direction.fallback.norm() > 0 || element.FirstChildElement(direction.tag) != nullptr) return;
    fail(reading, element,
         fmt::format("{} without <{}>, which has no default: add it, a direction x,y,z", joint.type, direction.tag));
  };
  need(first);
  if (!any_second) need(second);
  if (!(a.norm() > 0))
    fail(reading, element, fmt::format("{}: {} is zero, expected a direction x,y,z", joint.type, first.tag));
  const Vector3d e0 = a.normalized();
  if (!(b.norm() > 0) || e0.cross(b.normalized()).norm() < 1e-6) {
    if (!any_second) {
      fail(reading, element,
           fmt::format("{}: {} and {} have the same direction, expected two different ones", joint.type, first.tag,
                       second.tag));
    }
    b = e0.unitOrthogonal();
  }
  joint.axes.col(0) = e0;
  joint.axes.col(2) = e0.cross(b).normalized();
  joint.axes.col(1) = joint.axes.col(2).cross(e0);
}

/// One free motion of a joint: FEBio's flag and value where it is prescribed, force or moment where it is not.
struct Free {
  int dof;            ///< of the joint: 0-2 along, 3-5 about the columns
  const char* flag;   ///< "prescribed_rotation"
  const char* value;  ///< "rotation"
  const char* load;   ///< "moment"; null: none
};

Scaled opposite(Scaled load) {
  load.factor = -load.factor;
  return load;
}

/// FEBio's Lagrange multipliers know neither prescribed motion nor loads.
bool is_lagrange(const XMLElement& element) {
  const XMLElement* laugon = element.FirstChildElement("laugon");
  return laugon != nullptr && read_word(*laugon, {"PENALTY", "AUGLAG", "LAGMULT"}) == 2;
}

void refuse_lagrange(Reading& reading, const XMLElement& element, const std::string& type, const char* what) {
  if (!is_lagrange(element)) return;
  unsupported(reading, element, fmt::format("{} with laugon LAGMULT, where FEBio leaves out its {}", type, what),
              "choose AUGLAG");
}

void set_free(Reading& reading, const XMLElement& element, const Free& free, RigidJoint& joint) {
  const std::size_t dof = static_cast<std::size_t>(free.dof);
  const Scaled load = free.load == nullptr ? Scaled{0.0, 0} : child_scaled(reading, element, free.load);
  if (child_bool(reading, element, free.flag, false)) {
    refuse_lagrange(reading, element, joint.type, free.flag);
    joint.motion[dof] = Motion::Prescribed;
    joint.value[dof] = child_scaled(reading, element, free.value);
    if (load.factor != 0) {
      fail(reading, element,
           fmt::format("{} with {} = 1 and a {} of {:g}, expected one of them", joint.type, free.flag, free.load,
                       load.factor));
    }
    return;
  }
  joint.motion[dof] = Motion::Free;
  joint.value[dof] = load;
  if (load.factor != 0) refuse_lagrange(reading, element, joint.type, free.load);
}

/// Moments of a spherical joint have global directions, whatever the bodies do: a moment on A, its opposite on B.
void add_moments(Reading& reading, const XMLElement& element, const RigidJoint& joint) {
  for (int i = 0; i < 3; ++i) {
    const char* tag = std::array{"moment_x", "moment_y", "moment_z"}[static_cast<std::size_t>(i)];
    const XMLElement* child = element.FirstChildElement(tag);
    if (child == nullptr) continue;
    const Scaled moment = read_scaled(reading, *child);
    if (moment.factor == 0) continue;
    refuse_lagrange(reading, element, joint.type, tag);
    for (const bool a : {true, false}) {
      RigidLoad load;
      load.material = a ? joint.material_a : joint.material_b;
      load.dof = 3 + i;
      load.value = a ? moment : opposite(moment);
      set_place(reading, *child, load);
      load.name = joint.name;
      reading.moments_of[joint.name].push_back(reading.model.rigid_loads.size());
      reading.model.rigid_loads.push_back(std::move(load));
    }
  }
}

void set_spherical(Reading& reading, const XMLElement& element, RigidJoint& joint) {
  const bool prescribed = child_bool(reading, element, "prescribed_rotation", false);
  for (std::size_t i = 0; i < 3; ++i) {
    joint.motion[3 + i] = prescribed ? Motion::Prescribed : Motion::Free;
    joint.value[3 + i] = {0.0, 0};
    if (!prescribed) continue;
    joint.value[3 + i] = child_scaled(reading, element, std::array{"rotation_x", "rotation_y", "rotation_z"}[i]);
    for (const char* moment : {"moment_x", "moment_y", "moment_z"}) {
      if (child_scaled(reading, element, moment).factor != 0)
        fail(reading, element,
             fmt::format("{} with prescribed_rotation = 1 and a {}, expected one of them", joint.type, moment));
    }
  }
  if (prescribed)
    refuse_lagrange(reading, element, joint.type, "prescribed_rotation");
  else
    add_moments(reading, element, joint);
}

/// Each motion with its `prescribe_` is held at that value, the others are free. FEBio holds products of axes, which is
/// our rotation only where at most one turns, and is free only about one.
void set_generic(Reading& reading, const XMLElement& element, RigidJoint& joint) {
  int turning = 0, free = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    const char* tag =
        std::array{"prescribe_x", "prescribe_y", "prescribe_z", "prescribe_Rx", "prescribe_Ry", "prescribe_Rz"}[i];
    const bool given = element.FirstChildElement(tag) != nullptr;
    joint.value[i] = child_scaled(reading, element, tag);
    joint.motion[i] = !given ? Motion::Free : joint.value[i].factor == 0 ? Motion::Held : Motion::Prescribed;
    if (joint.motion[i] == Motion::Held) joint.value[i] = {0.0, 0};
    if (i < 3) continue;
    free += given ? 0 : 1;
    turning += joint.motion[i] == Motion::Prescribed ? 1 : 0;
    if (joint.motion[i] == Motion::Prescribed && joint.value[i].controller == 0 &&
        std::abs(joint.value[i].factor) >= std::numbers::pi / 2) {
      unsupported(reading, element, fmt::format("{} with {} beyond a right angle", joint.type, tag),
                  "prescribe less, or use a rigid revolute joint");
    }
  }
  const bool same = (free == 0 && turning <= 1) || (free == 1 && turning == 0) || free == 3;
  if (!same) {
    unsupported(reading, element, fmt::format("{} with {} free and {} prescribed rotations", joint.type, free, turning),
                "have no more than one of them, or three free");
  }
}

/// False: no joint.
bool read_joint(Reading& reading, const XMLElement& element, const std::string& type) {
  RigidJoint joint;
  joint.type = type;
  const char* place = type == "rigid joint" || type == "generic rigid joint" ? "joint" : "joint_origin";
  const Vector3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), none(0, 0, 0);
  for (Scaled& value : joint.value) value = {0.0, 0};

  const bool known = type == "rigid joint" || type == "rigid spherical joint" || type == "rigid revolute joint" ||
                     type == "rigid prismatic joint" || type == "rigid cylindrical joint" ||
                     type == "rigid planar joint" || type == "rigid lock" || type == "generic rigid joint";
  if (!known) return false;
  set_bodies(reading, element, joint.material_a, joint.material_b);
  set_place(reading, element, joint);
  joint.joint_origin = child_vector(reading, element, place, Vector3d::Zero());
  if (type == "rigid joint") {
    for (std::size_t i = 3; i < 6; ++i) joint.motion[i] = Motion::Free;
  } else if (type == "rigid spherical joint") {
    set_spherical(reading, element, joint);
  } else if (type == "rigid revolute joint") {
    set_axes(reading, element, {"rotation_axis", z}, {"transverse_axis", x}, true, joint);
    set_free(reading, element, {3, "prescribed_rotation", "rotation", "moment"}, joint);
    const XMLElement* torsion = element.FirstChildElement("torsion_stiffness");
    if (torsion != nullptr && (read_double(reading, *torsion) != 0))
      unsupported(reading, *torsion, "rigid revolute joint with torsion_stiffness",
                  "set it to 0, or give its moment as <moment>");
  } else if (type == "rigid prismatic joint") {
    set_axes(reading, element, {"translation_axis", x}, {"transverse_axis", y}, false, joint);
    set_free(reading, element, {0, "prescribed_translation", "translation", "force"}, joint);
  } else if (type == "rigid cylindrical joint") {
    set_axes(reading, element, {"joint_axis", none}, {"transverse_axis", none}, true, joint);
    set_free(reading, element, {0, "prescribed_translation", "translation", "force"}, joint);
    set_free(reading, element, {3, "prescribed_rotation", "rotation", "moment"}, joint);
  } else if (type == "rigid planar joint") {
    const bool any_second = !child_bool(reading, element, "prescribed_translation_1", false) &&
                            !child_bool(reading, element, "prescribed_translation_2", false);
    set_axes(reading, element, {"rotation_axis", none}, {"translation_axis_1", none}, any_second, joint);
    set_free(reading, element, {3, "prescribed_rotation", "rotation", nullptr}, joint);
    set_free(reading, element, {1, "prescribed_translation_1", "translation_1", nullptr}, joint);
    set_free(reading, element, {2, "prescribed_translation_2", "translation_2", nullptr}, joint);
  } else if (type == "rigid lock") {
    set_axes(reading, element, {"first_axis", none}, {"second_axis", none}, false, joint);
  } else {
    set_generic(reading, element, joint);
  }
  reading.model.rigid_joints.push_back(std::move(joint));
  return true;
}

}  // namespace

void check_joints(Reading& reading) {
  const JointModel& model = reading.model;
  for (const RigidJoint& joint : model.rigid_joints) {
    if (joint.type != "rigid spherical joint" || joint.motion[3] != Motion::Prescribed) continue;
    std::array<bool, 3> held = {};
    for (const RigidFixed& fixed : model.rigid_fixed) {
      if (fixed.material != joint.material_a || (fixed.step != -1 && fixed.step != joint.step)) continue;
      for (std::size_t i = 0; i < 3; ++i) held[i] = held[i] || fixed.dofs[3 + i];
    }
    for (const RigidPrescribed& motion : model.rigid_prescribed) {
      if (motion.material == joint.material_a && motion.dof >= 3)
        held[static_cast<std::size_t>(motion.dof) - 3] = false;
    }
    if (held[0] && held[1] && held[2]) continue;
    unsupported(reading, joint.origin,
                "rigid spherical joint with prescribed_rotation, which has global directions, while body_a can rotate",
                "fix body_a's rotations");
  }
}

void read_axial_force(Reading& reading, const XMLElement& element) {
  RigidAxialForce pull;
  set_bodies(reading, element, pull.material_a, pull.material_b, "rbA", "rbB");
  pull.point_a = child_vector(reading, element, "ra", Vector3d::Zero());
  pull.point_b = child_vector(reading, element, "rb", Vector3d::Zero());
  pull.from_centers = child_bool(reading, element, "relative", false);
  pull.force = child_scaled(reading, element, "force");
  set_place(reading, element, pull);
  reading.model.rigid_axial_forces.push_back(std::move(pull));
}

void read_cable(Reading& reading, const XMLElement& element) {
  RigidCable cable;
  cable.from_centers = child_bool(reading, element, "relative", true);
  cable.force = child_scaled(reading, element, "force");
  cable.direction = child_vector(reading, element, "force_direction", Vector3d(0, 0, -1));
  if (!(cable.direction.norm() > 0)) fail(reading, element, "force_direction is zero, expected a direction");
  cable.direction.normalize();
  for (const XMLElement& child : children(element, "rigid_cable_point")) {
    RigidCable::Point point;
    point.material = child_body(reading, child, "rigid_body_id");
    point.position = child_vector(reading, child, "position", Vector3d::Zero());
    cable.points.push_back(point);
  }
  if (cable.points.empty())
    fail(reading, element, "rigid_cable without <rigid_cable_point>: add the points it runs through");
  set_place(reading, element, cable);
  reading.model.rigid_cables.push_back(std::move(cable));
}

void name_connector_again(Reading& reading, const XMLElement& element) {
  const std::string name = need_attribute(reading, element, "name");
  if (reading.connector_names.count(name) == 0)
    fail(reading, element,
         fmt::format("<constraint name={}> without a type, expected the name of a constraint above it", quote(name)));
  if (reading.step < 0) return;
  const auto act_too = [&](auto& list, std::size_t i) {
    if (list[i].step == reading.step) return;
    if (list[i].step < 0) {  // of all steps until a step names it
      list[i].step = reading.step;
      return;
    }
    auto again = list[i];
    again.step = reading.step;
    list.push_back(std::move(again));
  };
  const auto in_this_step = [&](auto& list) {
    for (std::size_t i = list.size(); i-- > 0;)
      if (list[i].name == name) return act_too(list, i);
  };
  const auto moments = reading.moments_of.find(name);  // of a spherical joint: loads of their own
  if (moments != reading.moments_of.end()) {
    std::vector<std::size_t> now;
    for (const std::size_t i : moments->second) {
      const std::size_t before = reading.model.rigid_loads.size();
      act_too(reading.model.rigid_loads, i);
      now.push_back(reading.model.rigid_loads.size() > before ? before : i);
    }
    moments->second = now;
  }
  in_this_step(reading.model.rigid_springs);
  in_this_step(reading.model.rigid_joints);
  in_this_step(reading.model.rigid_axial_forces);
}

bool rigid_connector(Reading& reading, const XMLElement& element, const std::string& type) {
  reading.connector_names.insert(attribute(element, "name"));
  if (type.rfind("rigid ", 0) != 0 && type != "generic rigid joint") return false;
  if (febio::is_damper(type)) {
    ignore(reading, element, fmt::format("{}: statics has no velocity", type));
  } else if (type == "rigid spring") {
    read_spring(reading, element);
  } else if (type == "rigid contractile force") {
    read_contractile_force(reading, element);
  } else if (!read_joint(reading, element, type)) {
    unsupported_word(reading, element, fmt::format("rigid connector {}", quote(type)), febio::WordOf::Connector, type);
  }
  return true;
}

}  // namespace dea::feb

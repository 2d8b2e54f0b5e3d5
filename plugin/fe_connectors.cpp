// What joins two rigid bodies: springs, muscles, joints. FEBio's conventions are those of `RigidJoint`
// (src/model/joint_model.h); what makes a joint is the same in io/feb/feb_connectors.cpp.
#include <FEBioMech/FERigidBody.h>
#include <FEBioMech/FERigidConnector.h>
#include <FECore/FENLConstraint.h>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include <febiodea/plugin/fe_reading.h>

namespace dea::fe {

namespace {

using Motion = RigidJoint::Motion;

/// FEBio's Init turns a connector's material numbers into bodies; the pointers, protected, tell that it has been
/// called.
struct Connected : FERigidConnector {
  static FERigidBody* a(FERigidConnector& c) { return c.*&Connected::m_rbA; }
  static FERigidBody* b(FERigidConnector& c) { return c.*&Connected::m_rbB; }
};

int connected_material(const Reading& reading, FERigidConnector& fe, FERigidBody* body, const char* name) {
  return need_rigid(reading, fe, body == nullptr ? need_int(reading, fe, name) : body->m_mat + 1);
}

void set_bodies(const Reading& reading, FERigidConnector& fe, int& a, int& b) {
  a = connected_material(reading, fe, Connected::a(fe), "body_a");
  b = connected_material(reading, fe, Connected::b(fe), "body_b");
}

void read_spring(Reading& reading, FERigidConnector& fe) {
  RigidSpring spring;
  set_bodies(reading, fe, spring.material_a, spring.material_b);
  spring.insertion_a = need_vector(reading, fe, "insertion_a");
  spring.insertion_b = need_vector(reading, fe, "insertion_b");
  spring.k = need_number(reading, fe, "k");
  spring.free_length = need_number(reading, fe, "free_length");
  for (const char* name : {"k", "free_length", "insertion_a", "insertion_b"}) {
    if (controller_of(reading, need_parameter(reading, fe, name)) >= 0)
      unsupported(reading, fmt::format("rigid spring whose {} follows a load controller", name),
                  "take out its lc: DEA keeps it constant");
  }
  add(reading, fe, reading.model.rigid_springs, std::move(spring));
}

void read_contractile_force(Reading& reading, FERigidConnector& fe) {
  RigidAxialForce pull;
  set_bodies(reading, fe, pull.material_a, pull.material_b);
  pull.point_a = constant_vector(reading, fe, "insertion_a");
  pull.point_b = constant_vector(reading, fe, "insertion_b");
  pull.force = need_scaled(reading, fe, "f0");
  add(reading, fe, reading.model.rigid_axial_forces, std::move(pull));
}

// -- joints --------------------------------------------------------------------------------------------

/// Columns along `first`, in the plane of `first` and `second`, and normal to both, right-handed. `any_second`: the
/// joint does not need the second direction, so it may be anything.
void set_axes(Reading& reading, FECoreBase& fe, const char* first, const char* second, bool any_second,
              RigidJoint& joint) {
  const Vector3d a = constant_vector(reading, fe, first);
  Vector3d b = constant_vector(reading, fe, second);
  if (!(a.norm() > 0)) {
    unsupported(reading, fmt::format("{} whose {} is zero", joint.type, first), "give it a direction x,y,z");
    return;
  }
  const Vector3d e0 = a.normalized();
  if (!(b.norm() > 0) || e0.cross(b.normalized()).norm() < 1e-6) {
    if (!any_second)
      unsupported(reading, fmt::format("{} whose {} and {} have the same direction", joint.type, first, second),
                  "give two different ones");
    b = e0.unitOrthogonal();
  }
  joint.axes.col(0) = e0;
  joint.axes.col(2) = e0.cross(b).normalized();
  joint.axes.col(1) = joint.axes.col(2).cross(e0);
}

/// FEBio's Lagrange multipliers know neither prescribed motion nor loads.
void refuse_lagrange(Reading& reading, FECoreBase& fe, const std::string& type, const char* what) {
  if (need_int(reading, fe, "laugon") != 2) return;
  unsupported(reading, fmt::format("{} with laugon LAGMULT, where FEBio leaves out its {}", type, what),
              "choose AUGLAG");
}

/// One free motion of a joint: FEBio's flag and value where it is prescribed, force or moment where it is not.
struct Free {
  int dof;            ///< of the joint: 0-2 along, 3-5 about the columns
  const char* flag;   ///< "prescribed_rotation"
  const char* value;  ///< "rotation"
  const char* load;   ///< "moment"; null: none
};

void set_free(Reading& reading, FECoreBase& fe, const Free& free, RigidJoint& joint) {
  const std::size_t dof = static_cast<std::size_t>(free.dof);
  const Scaled load = free.load == nullptr ? Scaled{} : need_scaled(reading, fe, free.load);
  if (!flag(fe, free.flag)) {
    joint.motion[dof] = Motion::Free;
    joint.value[dof] = load;
    if (load.factor != 0) refuse_lagrange(reading, fe, joint.type, free.load);
    return;
  }
  refuse_lagrange(reading, fe, joint.type, free.flag);
  joint.motion[dof] = Motion::Prescribed;
  joint.value[dof] = need_scaled(reading, fe, free.value);
  if (load.factor != 0)
    fail(reading, fmt::format("{} with {} = 1 and a {} of {:g}, expected one of them", joint.type, free.flag, free.load,
                              load.factor));
}

/// Moments of a spherical joint have global directions, whatever the bodies do: a moment on A, its opposite on B.
void set_spherical(Reading& reading, FENLConstraint& fe, RigidJoint& joint) {
  constexpr std::array kRotations = {"rotation_x", "rotation_y", "rotation_z"};
  constexpr std::array kMoments = {"moment_x", "moment_y", "moment_z"};
  const bool prescribed = flag(fe, "prescribed_rotation");
  if (prescribed) refuse_lagrange(reading, fe, joint.type, "prescribed_rotation");
  for (std::size_t i = 0; i < 3; ++i) {
    joint.motion[3 + i] = prescribed ? Motion::Prescribed : Motion::Free;
    if (prescribed) joint.value[3 + i] = need_scaled(reading, fe, kRotations[i]);
    const Scaled moment = need_scaled(reading, fe, kMoments[i]);
    if (moment.factor == 0) continue;
    if (prescribed)
      fail(reading,
           fmt::format("{} with prescribed_rotation = 1 and a {}, expected one of them", joint.type, kMoments[i]));
    refuse_lagrange(reading, fe, joint.type, kMoments[i]);
    for (const bool a : {true, false}) {
      RigidLoad load;
      load.material = a ? joint.material_a : joint.material_b;
      load.dof = 3 + static_cast<int>(i);
      load.value = {a ? moment.factor : -moment.factor, moment.controller};
      add(reading, fe, reading.model.rigid_loads, std::move(load));
    }
  }
}

/// Whether the file gives this parameter; FEBio keeps that of a few only.
bool is_given(FEParam& parameter) {
  const bool* given = parameter.GetWatchVariable();
  return given != nullptr && *given;
}

/// Each motion with its `prescribe_` is held at that value, the others are free. FEBio holds products of axes, which is
/// our rotation only where at most one turns, and is free only about one.
void set_generic(Reading& reading, FECoreBase& fe, RigidJoint& joint) {
  int turning = 0, free = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    const char* name =
        std::array{"prescribe_x", "prescribe_y", "prescribe_z", "prescribe_Rx", "prescribe_Ry", "prescribe_Rz"}[i];
    const bool given = is_given(need_parameter(reading, fe, name));
    const Scaled value = given ? need_scaled(reading, fe, name) : Scaled{};
    joint.motion[i] = !given ? Motion::Free : value.factor == 0 ? Motion::Held : Motion::Prescribed;
    if (joint.motion[i] == Motion::Prescribed) joint.value[i] = value;
    if (i < 3) continue;
    free += given ? 0 : 1;
    turning += joint.motion[i] == Motion::Prescribed ? 1 : 0;
    if (joint.motion[i] == Motion::Prescribed && value.controller < 0 && std::abs(value.factor) >= std::numbers::pi / 2)
      unsupported(reading, fmt::format("{} with {} beyond a right angle", joint.type, name),
                  "prescribe less, or use a rigid revolute joint");
  }
  const bool same = (free == 0 && turning <= 1) || (free == 1 && turning == 0) || free == 3;
  if (!same)
    unsupported(reading, fmt::format("{} with {} free and {} prescribed rotations", joint.type, free, turning),
                "have no more than one of them, or three free");
}

/// False: no joint.
bool read_joint(Reading& reading, FERigidConnector& fe) {
  RigidJoint joint;
  joint.type = type_of(fe);
  const std::string& type = joint.type;
  const bool old = type == "rigid joint", generic = type == "generic rigid joint";
  if (!old && !generic &&
      !one_of(type, {"rigid spherical joint", "rigid revolute joint", "rigid prismatic joint",
                     "rigid cylindrical joint", "rigid planar joint", "rigid lock"}))
    return false;
  set_bodies(reading, fe, joint.material_a, joint.material_b);
  joint.joint_origin = constant_vector(reading, fe, old || generic ? "joint" : "joint_origin");
  if (old) {
    for (std::size_t i = 3; i < 6; ++i) joint.motion[i] = Motion::Free;
  } else if (generic) {
    set_generic(reading, fe, joint);
  } else if (type == "rigid spherical joint") {
    set_spherical(reading, fe, joint);
  } else if (type == "rigid revolute joint") {
    set_axes(reading, fe, "rotation_axis", "transverse_axis", true, joint);
    set_free(reading, fe, {3, "prescribed_rotation", "rotation", "moment"}, joint);
    if (need_number(reading, fe, "torsion_stiffness") != 0)
      unsupported(reading, "rigid revolute joint with torsion_stiffness",
                  "set it to 0, or give its moment as <moment>");
  } else if (type == "rigid prismatic joint") {
    set_axes(reading, fe, "translation_axis", "transverse_axis", false, joint);
    set_free(reading, fe, {0, "prescribed_translation", "translation", "force"}, joint);
  } else if (type == "rigid cylindrical joint") {
    set_axes(reading, fe, "joint_axis", "transverse_axis", true, joint);
    set_free(reading, fe, {0, "prescribed_translation", "translation", "force"}, joint);
    set_free(reading, fe, {3, "prescribed_rotation", "rotation", "moment"}, joint);
  } else if (type == "rigid planar joint") {
    const bool any_second = !flag(fe, "prescribed_translation_1") && !flag(fe, "prescribed_translation_2");
    set_axes(reading, fe, "rotation_axis", "translation_axis_1", any_second, joint);
    set_free(reading, fe, {3, "prescribed_rotation", "rotation", nullptr}, joint);
    set_free(reading, fe, {1, "prescribed_translation_1", "translation_1", nullptr}, joint);
    set_free(reading, fe, {2, "prescribed_translation_2", "translation_2", nullptr}, joint);
  } else {
    set_axes(reading, fe, "first_axis", "second_axis", false, joint);
  }
  add(reading, fe, reading.model.rigid_joints, std::move(joint));
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
    unsupported(reading,
                "rigid spherical joint with prescribed_rotation, which has global directions, while body_a can rotate",
                "fix body_a's rotations");
  }
}

bool read_connector(Reading& reading, FENLConstraint& constraint) {
  const std::string type = type_of(constraint);
  auto* fe = dynamic_cast<FERigidConnector*>(&constraint);
  if (fe == nullptr) return false;
  if (febio::is_damper(type))
    ignore(reading, fmt::format("{}: statics has no velocity", type));
  else if (type == "rigid spring")
    read_spring(reading, *fe);
  else if (type == "rigid contractile force")
    read_contractile_force(reading, *fe);
  else if (!read_joint(reading, *fe))
    unsupported(reading, fmt::format("rigid connector {}", quote(type)),
                febio::word_advice(febio::WordOf::Connector, type));
  return true;
}

}  // namespace dea::fe

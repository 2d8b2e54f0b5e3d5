// Conditions on nodes and rigid bodies, loads, contacts.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "io/febio/interpret.h"
#include "src/base/numbers.h"
#include "src/base/parse.h"
#include "src/base/say.h"
#include "src/model/load_curve.h"

namespace dea::febio {

// -- nodes -------------------------------------------------------------------------------------------

namespace {

/// True for FEBio's older "xy", "xyz", "uvw": letters in their order; "wx" is a fluid velocity.
bool is_joined(std::string_view dof) {
  constexpr std::string_view kLetters = "xyzuvw";
  std::size_t next = 0;
  for (const char letter : dof) {
    const std::size_t place = kLetters.find(letter, next);
    if (place == kLetters.npos) return false;
    next = place + 1;
  }
  return dof.size() > 1;
}

/// 0, 1, 2 for x, y, z; -1: no displacement.
int component_of(std::string_view dof) { return dof.size() == 1 && dof[0] >= 'x' && dof[0] <= 'z' ? dof[0] - 'x' : -1; }

bool is_shell_dof(std::string_view dof) { return one_of(dof, {"u", "v", "w", "sx", "sy", "sz"}); }

}  // namespace

std::vector<std::string> split_dofs(std::string_view text) {
  std::vector<std::string> dofs;
  for (const std::string& word : split_words(text)) {
    const std::string dof(trim(word));
    if (dof == "xyzsxyz") {  // 2.0
      for (const char* each : {"x", "y", "z", "sxyz"}) dofs.emplace_back(each);
    } else if (is_joined(dof)) {
      for (const char letter : dof) dofs.emplace_back(1, letter);
    } else {
      dofs.push_back(dof);
    }
  }
  return dofs;
}

void fix_nodes(Draft& draft, const OnNodes& on, std::string_view dofs) {
  std::array<bool, 3> xyz = {};
  for (const std::string& dof : split_dofs(dofs)) {
    const int component = component_of(dof);
    if (component >= 0)
      xyz[at(component)] = true;
    else
      ignore(draft, on.origin, fmt::format("fixed dof {}: no displacement", quote(dof)));
  }
  fix_nodes(draft, on, xyz);
}

void fix_nodes(Draft& draft, const OnNodes& on, const std::array<bool, 3>& xyz) {
  if (!xyz[0] && !xyz[1] && !xyz[2]) return;
  add(draft.model.fixed_nodes, FixedNodes{{}, on.nodes, xyz}, on.name, on.origin, on.steps);
}

void prescribe_nodes(Draft& draft, const OnNodes& on, std::string_view dof, const Scaled& value, bool relative) {
  const std::string_view name = trim(dof);
  const int component = component_of(name);
  if (is_shell_dof(name)) {
    unsupported(
        draft, on.origin, fmt::format("prescribed shell dof {}", quote(name)),
        say("take it out: DEA has no deformable shells, take their material as rigid with {}", NamedSetting{"rigid"}));
  } else if (component < 0) {
    ignore(draft, on.origin, fmt::format("prescribed dof {}: no displacement", quote(name)));
  } else if (value.factor == 0.0 && !relative) {
    fix_nodes(draft, on, name);
  } else {
    const std::string& called = !on.name.empty() ? on.name : on.node_set;
    add(draft.model.prescribed_nodes, PrescribedNodes{{}, on.nodes, component, value, relative},
        called.empty() ? "moved nodes" : called, on.origin, on.steps);
  }
}

void prescribe_nodes(Draft& draft, const OnNodes& on, std::string_view dof, const Component* value, bool relative) {
  if (value != nullptr && !whole_double(value->text))
    return unsupported(draft, on.origin, kMovedApart, kMovedApartAdvice);
  prescribe_nodes(draft, on, dof, value == nullptr ? Scaled{} : scaled(draft, *value), relative);
}

void zero_displacement(Draft& draft, const Component& component, const OnNodes& on) {
  const std::array<bool, 3> xyz = {flag_of(draft, component, "x_dof"), flag_of(draft, component, "y_dof"),
                                   flag_of(draft, component, "z_dof")};
  if (!xyz[0] && !xyz[1] && !xyz[2]) ignore(draft, component.origin, "zero displacement of no component");
  fix_nodes(draft, on, xyz);
}

void other_boundary_condition(Draft& draft, const Component& component, const std::string& what) {
  const std::string& type = component.type;
  const auto has = [&](const char* word) { return type.find(word) != type.npos; };
  if (one_of(type, {"zero rotation", "zero shell displacement"}) || has("fluid") || has("concentration") ||
      has("temperature"))
    ignore(draft, component.origin, what);
  else
    unsupported(draft, component.origin, what, word_advice(WordOf::Boundary, type));
}

void symmetry_plane(Draft& draft, const Component& component, int surface, const Steps& steps) {
  const int axis = surface < 0 ? -1 : plane_axis(draft.model, draft.model.surfaces[at(surface)]);
  if (axis < 0) return unsupported(draft, component.origin, "constraint \"symmetry plane\"", kPlaneAdvice);
  const OnNodes on = {nodes_of_surface(draft.model.surfaces[at(surface)]), component.name, "", component.origin, steps};
  fix_nodes(draft, on, std::string(1, "xyz"[axis]));
}

void nodal_force(Draft& draft, const OnNodes& on, std::string_view dof, const Scaled& force) {
  const std::string_view name = trim(dof);
  const int component = component_of(name);
  if (is_shell_dof(name)) {
    unsupported(draft, on.origin, fmt::format("nodal load on the shell dof {}", quote(name)),
                "take it out, or load x, y or z");
  } else if (component < 0) {
    ignore(draft, on.origin, fmt::format("nodal load on dof {}: no force", quote(name)));
  } else if (force.factor == 0) {
    ignore(draft, on.origin, "nodal load of zero");
  } else {
    NodalForce load;
    load.nodes = on.nodes;
    load.value[component] = force.factor;
    load.controller = force.controller;
    add(draft.model.nodal_forces, std::move(load), on.name, on.origin, on.steps);
  }
}

namespace {

/// A force vector on each of the nodes.
void nodal_force_vector(Draft& draft, const Component& value, OnNodes on) {
  const Vector3d force = to_vector(draft, value.origin, value.tag, value.text);
  const int controller = controller_of(draft, value);
  if (force.isZero(0)) return ignore(draft, on.origin, "nodal load of zero");
  add(draft.model.nodal_forces, NodalForce{{}, std::move(on.nodes), force, controller}, on.name, value.origin,
      on.steps);
}

}  // namespace

void nodal_load(Draft& draft, const Component& component, OnNodes on) {
  const bool vector = component.type == "nodal_force";
  const char* tag = vector ? "value" : "scale";
  const Component* value = find(component, tag);
  for (const char* flag : {"relative", "shell_bottom"}) {
    if (!flag_of(draft, component, flag)) continue;
    return unsupported(draft, on.origin, fmt::format("nodal load with {} = 1", flag), fmt::format("set {} to 0", flag));
  }
  if (value == nullptr) {
    if (find(component, "value") != nullptr || find(component, "scale") != nullptr)
      return unsupported(draft, on.origin, fmt::format("nodal load without <{}>", tag), fmt::format("add <{}>", tag));
    return ignore(draft, on.origin, "nodal load of zero");
  }
  constexpr const char* kAdvice = "give a number, with lc=\"ID\" if it changes";
  if (!one_of(value->type, {"", "const", "vector"}))
    unsupported(draft, value->origin, fmt::format("nodal load whose {} is a {}", tag, quote(value->type)), kAdvice);
  else if (!vector && value->type.empty() && !expression_variables(value->text).empty())
    unsupported(draft, value->origin, fmt::format("nodal load whose scale is {}", quote(trim(value->text))), kAdvice);
  else if (vector)
    nodal_force_vector(draft, *value, std::move(on));
  else
    nodal_force(draft, on, text_of(component, "dof"), scaled(draft, *value));
}

// -- rigid bodies ------------------------------------------------------------------------------------

namespace {

constexpr std::initializer_list<const char*> kDisplacements = {"x", "y", "z"}, kForces = {"Rx", "Ry", "Rz"},
                                             kRotations = {"Ru", "Rv", "Rw"},
                                             kAll = {"Rx", "Ry", "Rz", "Ru", "Rv", "Rw"};

int dof_of(const Draft& draft, const Component& component, std::initializer_list<const char*> names) {
  return need_place_of_word(draft, component.origin, component.tag, text_of(component, "dof"), names);
}

/// The flagged dofs, or those listed by `fix` of 3.0.
void rigid_fixed(Draft& draft, const Component& component, const Steps& steps) {
  constexpr const char* kFlags[kDofs] = {"Rx_dof", "Ry_dof", "Rz_dof", "Ru_dof", "Rv_dof", "Rw_dof"};
  RigidFixed fixed;
  fixed.material = body_of(draft, component);
  if (component.type == "fix") {
    for (const std::string& word : split_words(text_of(component, "dofs")))
      fixed.dofs[at(need_place_of_word(draft, component.origin, component.tag, word, kAll))] = true;
  } else {
    for (std::size_t i = 0; i < kDofs; ++i) fixed.dofs[i] = flag_of(draft, component, kFlags[i]);
  }
  const std::size_t before = draft.model.rigid_fixed.size();
  add(draft.model.rigid_fixed, std::move(fixed), component.name, component.origin, steps);
  for (std::size_t i = before; i < draft.model.rigid_fixed.size() && component.type == "fix"; ++i)
    draft.old_fixes.push_back(i);
}

/// `value`: null: 0.
void rigid_prescribed(Draft& draft, const Component& component, int dof, const Component* value, const Steps& steps) {
  add(draft.model.rigid_prescribed,
      RigidPrescribed{{},
                      body_of(draft, component),
                      dof,
                      value == nullptr ? Scaled{0.0, 0} : scaled(draft, *value),
                      flag_of(draft, component, "relative")},
      component.name, value == nullptr ? component.origin : value->origin, steps);
}

/// In 4.0 the dofs of a displacement are x, y, z; a letter R before them is taken too.
void rigid_displacement(Draft& draft, const Component& component, const Steps& steps) {
  const std::string dof = lower_case(std::string(trim(text_of(component, "dof"))));
  const bool r = !dof.empty() && dof[0] == 'r';
  assume_unless_given(draft, component, "value", "0");
  rigid_prescribed(draft, component, dof_of(draft, component, r ? kForces : kDisplacements), find(component, "value"),
                   steps);
}

/// Euler angles [degrees]: x, then y, then z about the fixed axes. As a rotation vector if they are constant; a single
/// angle may follow a load controller.
void rigid_euler_angles(Draft& draft, const Component& component, const Steps& steps) {
  constexpr std::array kAngles = {"Ex", "Ey", "Ez"};
  RigidPrescribed motion;
  motion.material = body_of(draft, component);
  std::array<Scaled, 3> angles;
  int turning = 0, steered = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    angles[i] = scaled_of(draft, component, kAngles[i]);
    if (angles[i].factor == 0) angles[i].controller = 0;
    angles[i].factor *= kPi / 180.0;
    turning += angles[i].factor != 0 ? 1 : 0;
    steered += angles[i].controller != 0 ? 1 : 0;
  }
  if (turning > 1 && steered > 0) {
    unsupported(draft, component.origin, "rigid_euler_angles of which several turn and one follows a load controller",
                "give rigid_rotation_vector, or let one angle alone turn");
    return;
  }
  if (turning > 1) {
    const Eigen::Quaterniond q = Eigen::AngleAxisd(angles[2].factor, Vector3d::UnitZ()) *
                                 Eigen::AngleAxisd(angles[1].factor, Vector3d::UnitY()) *
                                 Eigen::AngleAxisd(angles[0].factor, Vector3d::UnitX());
    const Eigen::AngleAxisd turn(q);
    for (int i = 0; i < 3; ++i) angles[at(i)].factor = turn.angle() * turn.axis()[i];
  }
  for (std::size_t i = 0; i < 3; ++i) {
    motion.dof = 3 + static_cast<int>(i);
    motion.value = angles[i];
    add(draft.model.rigid_prescribed, motion, component.name, component.origin, steps);
  }
}

/// LOAD, FOLLOW or TARGET as 0, 1, 2.
int load_type_of(Draft& draft, const Component& component, int dof) {
  const Component* type = find(component, "load_type");
  if (type == nullptr) return 0;
  const int load_type = place_of_word(type->text, {"LOAD", "FOLLOW", "TARGET"});
  const bool old =
      component.type == "force";  // version 3.0: FEBio passes over the type of a moment, and reads a word as 0
  if (load_type < 0 && !(old && dof >= 3))
    fail(draft, type->origin, fmt::format("load_type = {}, expected LOAD, FOLLOW or TARGET", quote(type->text)));
  if (!old || load_type == 0 || (dof < 3 && whole_double(type->text))) return load_type;
  note(draft, type->origin,
       fmt::format("load_type {} of a {}: LOAD, as in FEBio, which {} in version 3.0", trim(type->text),
                   dof < 3 ? "force" : "moment", dof < 3 ? "takes numbers alone" : "has no other for moments"));
  return 0;
}

/// Force (dof 0-2) or moment (3-5).
void rigid_load(Draft& draft, const Component& component, int dof, const Steps& steps) {
  const Component* value = find(component, "value");
  if (value == nullptr) fail(draft, component.origin, fmt::format("<{}> without <value>: add it", component.tag));
  RigidLoad load;
  load.material = body_of(draft, component);
  load.dof = dof;
  load.value = scaled(draft, *value);
  const int load_type = load_type_of(draft, component, dof);
  if (load_type == 1 && dof >= 3)
    return unsupported(draft, component.origin, "rigid moment with load_type FOLLOW",
                       "use rigid_follower_moment, or load_type LOAD");
  load.kind = static_cast<RigidLoad::Kind>(load_type);
  load.relative = load.kind == RigidLoad::Kind::Dead && flag_of(draft, component, "relative");
  add(draft.model.rigid_loads, std::move(load), component.name, value->origin, steps);
}

/// Force or moment that turns with the body.
void rigid_follower(Draft& draft, const Component& component, bool moment, const Steps& steps) {
  const char* tag = moment ? "moment" : "force";
  const Component* value = find(component, tag);
  if (value == nullptr)
    fail(draft, component.origin, fmt::format("<{}> without <{}>: add it, three numbers", component.tag, tag));
  RigidFollower follower;
  follower.material = body_of(draft, component);
  follower.moment = moment;
  follower.value = to_vector(draft, value->origin, tag, value->text);
  follower.controller = controller_of(draft, *value);
  if (!moment) {
    follower.from_center = flag_of(draft, component, "relative");
    if (!follower.from_center) assume_unless_given(draft, component, "insertion", "0,0,0");
    follower.insertion = vector_of(draft, component, "insertion", Vector3d::Zero());
  }
  add(draft.model.rigid_followers, std::move(follower), component.name, value->origin, steps);
}

/// Motions; false: none.
bool rigid_motion(Draft& draft, const Component& c, const Steps& steps) {
  const std::string& type = c.type;
  if (type == "rigid_fixed" || type == "fix") {
    rigid_fixed(draft, c, steps);
  } else if (type == "rigid_displacement") {
    rigid_displacement(draft, c, steps);
  } else if (type == "rigid_rotation") {
    assume_unless_given(draft, c, "value", "0");
    rigid_prescribed(draft, c, 3 + dof_of(draft, c, kRotations), find(c, "value"), steps);
  } else if (type == "rigid_rotation_vector") {
    rigid_prescribed(draft, c, 3, find(c, "vx"), steps);
    rigid_prescribed(draft, c, 4, find(c, "vy"), steps);
    rigid_prescribed(draft, c, 5, find(c, "vz"), steps);
  } else if (type == "prescribe") {  // 3.0
    assume_unless_given(draft, c, "value", "0");
    rigid_prescribed(draft, c, dof_of(draft, c, kAll), find(c, "value"), steps);
  } else if (type == "rigid_euler_angles") {
    rigid_euler_angles(draft, c, steps);
  } else if (one_of(type, {"initial_rigid_velocity", "initial_rigid_angular_velocity"})) {
    ignore(draft, c.origin, "initial velocity of a rigid body");
  } else {
    return false;
  }
  return true;
}

}  // namespace

void add_old_fix(Draft& draft, RigidFixed fixed) {
  draft.old_fixes.push_back(draft.model.rigid_fixed.size());
  draft.model.rigid_fixed.push_back(std::move(fixed));
}

bool rigid_condition(Draft& draft, const Component& component, const Steps& steps) {
  const std::string& type = component.type;
  if (rigid_motion(draft, component, steps)) return true;
  if (type == "rigid_force")
    rigid_load(draft, component, dof_of(draft, component, kForces), steps);
  else if (type == "rigid_moment")
    rigid_load(draft, component, 3 + dof_of(draft, component, kRotations), steps);
  else if (type == "force" && component.tag != "surface_load")  // 3.0; on surfaces FEBio has another of this name
    rigid_load(draft, component, dof_of(draft, component, kAll), steps);
  else if (one_of(type, {"rigid_follower_force", "follower force"}))
    rigid_follower(draft, component, false, steps);
  else if (one_of(type, {"rigid_follower_moment", "follower moment"}))
    rigid_follower(draft, component, true, steps);
  else if (type == "rigid_axial_force")
    rigid_axial_force(draft, component, steps);
  else if (type == "rigid_cable")
    rigid_cable(draft, component, steps);
  else
    return false;
  return true;
}

namespace {

std::string in_line(Origin origin) { return origin.line > 0 ? fmt::format(" (line {})", origin.line) : ""; }

/// `what` in all steps, and again (`again`: "in step", "prescribed in step") in one: FEBio leaves it free when that
/// ends. Nothing for the last step, after which nothing runs, and for -1.
void note_opened(Draft& draft, const std::string& what, Origin all, const char* again, int step, Origin origin) {
  if (step < 0 || step + 1 >= static_cast<int>(draft.model.steps.size())) return;
  note(draft, origin,
       fmt::format("{} in all steps{} and {} {}: that ends with the step, and dea then goes on as before, where "
                   "FEBio leaves it free",
                   what, in_line(all), again, step + 1));
}

/// What is fixed in all steps and again in one, unless the next step fixes it too, or moves it.
void remark_double_fix(Draft& draft) {
  const JointModel& model = draft.model;
  std::set<std::array<int, 3>> in_step;  // material, dof, step
  for (const RigidFixed& f : model.rigid_fixed)
    for (int k = 0; k < kDofs; ++k)
      if (f.dofs[at(k)]) in_step.insert({f.material, k, f.step});
  for (const RigidPrescribed& p : model.rigid_prescribed) in_step.insert({p.material, p.dof, p.step});
  for (const RigidFixed& all : model.rigid_fixed) {
    if (all.step >= 0) continue;
    for (const RigidFixed& f : model.rigid_fixed)
      for (int k = 0; k < kDofs && f.material == all.material; ++k)
        if (f.dofs[at(k)] && all.dofs[at(k)] && in_step.count({f.material, k, f.step + 1}) == 0)
          note_opened(draft,
                      fmt::format("{} of {} is fixed", kDofNames[k], quote(model.materials[at(f.material)].name)),
                      all.origin, "in step", f.step, f.origin);
  }
  for (const FixedNodes& all : model.fixed_nodes) {
    if (all.step >= 0) continue;
    const std::set<int> held(all.nodes.begin(), all.nodes.end());
    const auto shares = [&](const FixedNodes& f) {
      return std::any_of(f.nodes.begin(), f.nodes.end(), [&](int node) { return held.count(node) > 0; });
    };
    const auto goes_on = [&](int k, int step) {
      return std::any_of(model.fixed_nodes.begin(), model.fixed_nodes.end(),
                         [&](const FixedNodes& next) { return next.step == step && next.xyz[at(k)] && shares(next); });
    };
    for (const FixedNodes& f : model.fixed_nodes)
      for (int k = 0; k < 3 && f.step >= 0; ++k)
        if (f.xyz[at(k)] && all.xyz[at(k)] && shares(f) && !goes_on(k, f.step + 1))
          note_opened(draft, fmt::format("{} of nodes is fixed", "xyz"[k]), all.origin, "in step", f.step, f.origin);
  }
}

}  // namespace

void hold_from_the_start(Draft& draft) {
  std::map<std::pair<int, int>, int> first;  // of material and dof: the step that fixes or moves it first
  const auto note_step = [&](int material, int dof, int step) {
    if (step < 0) return;
    const auto [entry, is_new] = first.insert({{material, dof}, step});
    if (!is_new) entry->second = std::min(entry->second, step);
  };
  const std::vector<RigidFixed> given = draft.model.rigid_fixed;
  for (const RigidFixed& f : given)
    for (int k = 0; k < kDofs; ++k)
      if (f.dofs[at(k)]) note_step(f.material, k, f.step);
  for (const RigidPrescribed& p : draft.model.rigid_prescribed) note_step(p.material, p.dof, p.step);
  std::map<std::pair<int, int>, const RigidFixed*> old;  // of material and dof: the earliest of them
  for (const std::size_t i : draft.old_fixes)
    for (int k = 0; k < kDofs; ++k) {
      if (!given[i].dofs[at(k)] || given[i].step < 0) continue;
      const RigidFixed*& earliest = old[{given[i].material, k}];
      if (earliest == nullptr || given[i].step < earliest->step) earliest = &given[i];
    }
  for (const auto& [of, fixed] : old) {
    const int until = first.at(of);
    for (int step = 0; step < until; ++step) {
      RigidFixed early = *fixed;
      early.dofs = {};
      early.dofs[at(of.second)] = true;
      early.step = step;
      draft.model.rigid_fixed.push_back(std::move(early));
    }
    if (until > 0)
      note(draft, fixed->origin,
           fmt::format(
               "{} of {} is fixed in step {}, and from the first step on until step {} ends, as FEBio 4 does with "
               "files before 4.0 (save as 4.0 to fix it in that step alone)",
               kDofNames[of.second], quote(draft.model.materials[at(of.first)].name), fixed->step + 1,
               until == fixed->step ? until + 1 : until));
  }
}

void remark_double_motion(Draft& draft) {
  std::map<std::pair<int, int>, const RigidPrescribed*> before;  // of a material and dof
  for (const RigidPrescribed& motion : draft.model.rigid_prescribed) {
    const RigidPrescribed*& other = before[{motion.material, motion.dof}];
    if (other != nullptr && (other->step == motion.step || other->step < 0))
      ignore(draft, other->origin,
             fmt::format("prescribed {} of {}: it is prescribed again{}, and the last one counts, as in FEBio",
                         kDofNames[motion.dof], quote(draft.model.materials[at(motion.material)].name),
                         motion.origin.line > 0 ? fmt::format(" in line {}", motion.origin.line) : ""));
    other = &motion;
  }
  remark_double_fix(draft);
  for (const RigidPrescribed& motion : draft.model.rigid_prescribed) {
    const std::string which =
        fmt::format("{} of {}", kDofNames[motion.dof], quote(draft.model.materials[at(motion.material)].name));
    const auto tell = [&](const char* held, int step, Origin origin) {
      if (step < 0)
        note_opened(draft, fmt::format("{} is {}", which, held), origin, "prescribed in step", motion.step,
                    motion.origin);
    };
    for (const RigidFixed& fixed : draft.model.rigid_fixed) {
      if (fixed.material != motion.material || !fixed.dofs[at(motion.dof)] || !at_same_time(fixed.step, motion.step))
        continue;
      if (motion.value.factor != 0)
        note(draft, motion.origin,
             fmt::format("{} is fixed{} and prescribed: it is prescribed, as in FEBio", which, in_line(fixed.origin)));
      tell("fixed", fixed.step, fixed.origin);
    }
    for (const RigidPrescribed& other : draft.model.rigid_prescribed)
      if (other.material == motion.material && other.dof == motion.dof) tell("prescribed", other.step, other.origin);
  }
}

// -- loads, contact, initial conditions --------------------------------------------------------------

namespace {

/// Numbers separated by commas, all zero.
bool is_zero(std::string_view text) {
  const std::vector<std::string> words = split_words(text);
  return std::all_of(words.begin(), words.end(), [](const std::string& word) {
    const auto number = whole_double(word);
    return number && *number == 0.0;
  });
}

}  // namespace

bool is_zero_load(const Component& component) {
  const Component* scale = find(component, "scale");
  if (scale != nullptr && is_zero(scale->text)) return true;
  bool found = false;
  for (const Component& part : component.parts) {
    if (!one_of(part.tag, {"pressure", "traction", "value", "force", "x", "y", "z"})) continue;
    if (!is_zero(part.text)) return false;
    found = true;
  }
  return found;
}

void other_load(Draft& draft, const Component& component) {
  const std::string& type = component.type;
  const std::string what = type.empty() ? component.tag : fmt::format("{} {}", component.tag, quote(type));
  const bool of_fluid =
      type.rfind("fluid", 0) == 0 || type.rfind("solute", 0) == 0 || type.rfind("concentration", 0) == 0;
  if (is_zero_load(component))
    ignore(draft, component.origin, what + " of zero");
  else if (of_fluid && type.find("FSI") == type.npos)
    ignore(draft, component.origin, what);
  else
    unsupported(draft, component.origin, what, load_advice(component.tag, type));
}

void initial_condition(Draft& draft, const Component& component) {
  if (component.type.find("prestrain") != component.type.npos)
    unsupported(draft, component.origin, fmt::format("initial {}", quote(component.type)),
                "take it out: DEA's cartilage starts without stress");
  else
    ignore(draft, component.origin, "initial conditions");
}

namespace {

/// How far a tie reaches: facets farther apart are not tied. 0: any distance.
double tie_reach(const Draft& draft, const Component& component) {
  constexpr double kNoReach = 1e-300;  // what a search radius of 0 ties: nothing, where 0 is no limit
  return ties_by_search_radius(component.type) ? std::max(number_of(draft, component, "search_radius", 1.0), kNoReach)
                                               : number_of(draft, component, "max_distance", 0.0);
}

/// Does FEBio pull tied nodes onto the surface that they are tied to, through gaps and overlaps of the mesh?
bool closes_gap(const Component& component) {
  const Component* keeps = find(component, "gap_offset");
  const auto offset = keeps == nullptr ? std::optional<double>(0.0) : whole_double(keeps->text);
  return offset && *offset == 0 &&
         one_of(component.type, {"tied-node-on-facet", "tied-facet-on-facet", "tied", "facet-to-facet tied", "sticky"});
}

/// "fric_coeff = 0.2", unless that is `usual`; "": it is, or not given.
std::string unusual(const Component& contact, const ContactParameter& parameter) {
  const Component* part = find(contact, parameter.name);
  if (part == nullptr) return "";
  const auto value = whole_double(part->text);
  if (value && *value == parameter.usual && !part->lc) return "";
  return fmt::format("{} = {}", parameter.name,
                     value ? fmt::format("{:g}", *value) : std::string(quote(trim(part->text))));
}

}  // namespace

Contact contact_of(Draft& draft, const Component& component) {
  Contact contact;
  contact.type = component.type;
  contact.name = component.name;
  if (contact.name.empty()) contact.name = fmt::format("contact {}", draft.model.contacts.size() + 1);
  contact.kind = *contact_kind(contact.type);
  contact.max_distance = tie_reach(draft, component);
  contact.closes_gap = closes_gap(component);
  for (const ContactParameter& parameter : unused_contact_parameters(contact.type))
    if (const std::string text = unusual(component, parameter); !text.empty()) contact.ignored.push_back(text);
  const std::string offset = unusual(component, {"offset", 0});
  if (contact.kind != Contact::Kind::Sliding || offset.empty()) return contact;
  const Origin origin = find(component, "offset")->origin;
  unsupported(draft, origin.line > 0 ? origin : component.origin,
              fmt::format("{} of contact {}", offset, quote(component.name)),
              "take it out, and mesh or place the bodies as far apart as it says");
  return contact;
}

}  // namespace dea::febio

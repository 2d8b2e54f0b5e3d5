// Loads on rigid bodies and their nodes: forces, moments, followers, forces along a line, cables.
#include <FECore/FEModelLoad.h>
#include <FECore/FEModelParam.h>
#include <FECore/FENodalLoad.h>
#include <FECore/FENodeSet.h>
#include <FECore/FEProperty.h>
#include <fmt/format.h>

#include <cmath>

#include <febiodea/plugin/fe_reading.h>

namespace dea::fe {

namespace {

void read_force(Reading& reading, FEModelLoad& fe, bool moment) {
  RigidLoad load;
  const int load_type = need_int(reading, fe, "load_type");
  const int dof = need_int(reading, fe, "dof");
  if (dof < 0 || dof > 2) fail(reading, fmt::format("rigid {} without a dof", moment ? "moment" : "force"));
  if (load_type < 0 || load_type > 2)
    fail(reading, fmt::format("load_type = {}, expected LOAD, FOLLOW or TARGET", load_type));
  if (load_type == 1 && moment) {
    unsupported(reading, "rigid moment with load_type FOLLOW", "use rigid_follower_moment, or load_type LOAD");
    return;
  }
  load.material = body_of(reading, fe);
  load.dof = moment ? 3 + dof : dof;
  load.value = need_scaled(reading, fe, "value");
  load.kind = static_cast<RigidLoad::Kind>(load_type);
  load.relative = load.kind == RigidLoad::Kind::Dead && flag(fe, "relative");
  add(reading, fe, reading.model.rigid_loads, std::move(load));
}

/// Force or moment that turns with the body.
void read_follower(Reading& reading, FEModelLoad& fe, bool moment) {
  const char* what = moment ? "moment" : "force";
  RigidFollower follower;
  follower.material = renamed_body_of(reading, fe, "rb");
  follower.moment = moment;
  follower.value = need_vector(reading, fe, what);
  follower.controller = controller_of(reading, need_parameter(reading, fe, what));
  if (!moment) {
    follower.insertion = constant_vector(reading, fe, "insertion");
    follower.from_center = flag(fe, "relative");
  }
  add(reading, fe, reading.model.rigid_followers, std::move(follower));
}

void read_axial_force(Reading& reading, FEModelLoad& fe) {
  RigidAxialForce pull;
  pull.material_a = renamed_body_of(reading, fe, "rbA");
  pull.material_b = renamed_body_of(reading, fe, "rbB");
  pull.point_a = constant_vector(reading, fe, "ra");
  pull.point_b = constant_vector(reading, fe, "rb");
  pull.from_centers = flag(fe, "relative");
  pull.force = need_scaled(reading, fe, "force");
  add(reading, fe, reading.model.rigid_axial_forces, std::move(pull));
}

void read_cable(Reading& reading, FEModelLoad& fe) {
  RigidCable cable;
  cable.from_centers = flag(fe, "relative");
  cable.force = need_scaled(reading, fe, "force");
  cable.direction = constant_vector(reading, fe, "force_direction");
  if (!(cable.direction.norm() > 0)) {
    unsupported(reading, "rigid_cable whose force_direction is zero", "give it a direction");
    return;
  }
  cable.direction.normalize();
  FEProperty* points = fe.FindProperty("rigid_cable_point");
  for (int i = 0; points != nullptr && i < points->size(); ++i) {
    FECoreBase& point = *points->get(i);
    cable.points.push_back(
        {renamed_body_of(reading, point, "rigid_body_id"), constant_vector(reading, point, "position")});
  }
  if (cable.points.empty()) {
    unsupported(reading, "rigid_cable without <rigid_cable_point>", "add the points it runs through");
    return;
  }
  add(reading, fe, reading.model.rigid_cables, std::move(cable));
}

/// Forces on nodes: `nodal_load`, one component, and `nodal_force`, a vector.
void read_nodal_load(Reading& reading, FENodalLoad& fe, bool vector) {
  NodalForce load;
  for (const char* name : {"relative", "shell_bottom"}) {
    if (!flag(fe, name)) continue;
    unsupported(reading, fmt::format("nodal load with {} = 1", name), fmt::format("set {} to 0", name));
    return;
  }
  const char* name = vector ? "value" : "scale";
  FEParam& value = need_parameter(reading, fe, name);
  const int dof = vector ? 0 : need_int(reading, fe, "dof");
  const int place = vector ? 0 : xyz_of(reading, dof);
  if (place < 0) {
    const std::string word = dof_name(reading, dof);
    if (one_of(word, {"u", "v", "w", "sx", "sy", "sz"}))
      unsupported(reading, fmt::format("nodal load on the shell dof {}", quote(word)),
                  "take it out, or load x, y or z");
    else
      ignore(reading, fmt::format("nodal load on dof {}: no force", quote(word)));
    return;
  }
  if (is_zero(value)) {
    ignore(reading, "nodal load of zero");
    return;
  }
  const bool plain = vector ? value.type() == FE_PARAM_VEC3D_MAPPED && value.value<FEParamVec3>().isConst()
                            : number_of(value).has_value();
  if (!plain) {
    unsupported(reading, fmt::format("nodal load whose {} is a {}", name, quote(kind_of(value))),
                "give a number, with lc=\"ID\" if it changes");
    return;
  }
  const FENodeSet* set = fe.GetNodeSet();
  if (set == nullptr)
    fail(reading, "nodal_load without a node set: FEBio 4 forgets it in files of version 2.0, save the file as 4.0");
  if (vector)
    load.value = need_vector(reading, fe, name);
  else
    load.value[place] = need_number(reading, fe, name);
  load.controller = controller_of(reading, value);
  for (int i = 0; i < set->Size(); ++i) load.nodes.push_back((*set)[i]);
  add(reading, fe, reading.model.nodal_forces, std::move(load));
}

}  // namespace

bool read_rigid_load(Reading& reading, FEModelLoad& load) {
  const std::string type = type_of(load);
  auto* nodal = dynamic_cast<FENodalLoad*>(&load);
  if (type == "rigid_force" || type == "rigid_moment")
    read_force(reading, load, type == "rigid_moment");
  else if (type == "rigid_follower_force" || type == "rigid_follower_moment")
    read_follower(reading, load, type == "rigid_follower_moment");
  else if (type == "rigid_axial_force")
    read_axial_force(reading, load);
  else if (type == "rigid_cable")
    read_cable(reading, load);
  else if (nodal != nullptr && (type == "nodal_load" || type == "nodal_force"))
    read_nodal_load(reading, *nodal, type == "nodal_force");
  else
    return false;
  return true;
}

}  // namespace dea::fe

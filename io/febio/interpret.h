// io/febio/interpret.h – what FEBio's components mean for DEA, with FEBio's defaults for what they leave out:
// the one place that says so, whoever brings the components.
//
// Each function adds conditions to the draft's model, one for each of `steps` (-1: active in all steps). It throws
// InputError at the component's place for what no model may say; what DEA cannot take into account becomes a remark in
// JointModel::unsupported, what changes nothing one in JointModel::ignored.
#pragma once
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "io/febio/component.h"

namespace dea::febio {

using Steps = std::vector<int>;

/// Adds a condition once for each of the steps.
template <class Condition>
void add(std::vector<Condition>& list, Condition condition, const std::string& name, Origin origin,
         const Steps& steps) {
  condition.name = name;
  condition.origin = origin;
  for (const int step : steps) {
    condition.step = step;
    list.push_back(condition);
  }
}

// -- nodes -------------------------------------------------------------------------------------------

/// Of a condition on nodes: which, what it is called, where it stands.
struct OnNodes {
  std::vector<int> nodes;
  std::string name, node_set;  ///< may be empty
  Origin origin;
  Steps steps;
};

/// "x,y", "xy" and 2.0's "xyzsxyz" as single names of dofs.
std::vector<std::string> split_dofs(std::string_view text);
/// Holds nodes in the dofs listed, and says which of them are no displacements.
void fix_nodes(Draft& draft, const OnNodes& on, std::string_view dofs);
/// Holds nodes in the flagged components, if any is.
void fix_nodes(Draft& draft, const OnNodes& on, const std::array<bool, 3>& xyz);
/// Displaces nodes in one dof; by zero: holds them.
void prescribe_nodes(Draft& draft, const OnNodes& on, std::string_view dof, const Scaled& value, bool relative);
/// The same by a parameter (null: 0), which may be a map or an expression: unsupported.
void prescribe_nodes(Draft& draft, const OnNodes& on, std::string_view dof, const Component* value, bool relative);
/// `zero displacement` of 4.0: x_dof, y_dof, z_dof.
void zero_displacement(Draft& draft, const Component& component, const OnNodes& on);
/// A condition on nodes that DEA does not take: of flow or rotation it changes nothing. `what`: how remarks call it.
void other_boundary_condition(Draft& draft, const Component& component, const std::string& what);
/// Holds the nodes of a plane of symmetry; `surface`: index of its surface, -1: unknown.
void symmetry_plane(Draft& draft, const Component& component, int surface, const Steps& steps);
/// A force on each of the nodes along one dof.
void nodal_force(Draft& draft, const OnNodes& on, std::string_view dof, const Scaled& force);
/// nodal_load (one dof) and nodal_force (a vector).
void nodal_load(Draft& draft, const Component& component, OnNodes on);

// -- rigid bodies ------------------------------------------------------------------------------------

/// Conditions and loads of rigid bodies; false: it is none of them.
bool rigid_condition(Draft& draft, const Component& component, const Steps& steps);
/// Adds what a file before 4.0 fixes; hold_from_the_start looks at it when all conditions have been read.
void add_old_fix(Draft& draft, RigidFixed fixed);
/// When all conditions have been read: what files before 4.0 fix in a step acts in FEBio from the first step on
/// (FERigidFixedBCOld), until a step ends that fixes or moves the same dof. Adds those steps, with a remark.
void hold_from_the_start(Draft& draft);
/// Then: motions of one body that another one overrides, and what is fixed twice.
void remark_double_motion(Draft& draft);

// -- what joins rigid bodies -------------------------------------------------------------------------

/// Springs, forces along a line, joints: FEBio's conventions are those of `RigidJoint`. False: it is no connector.
bool rigid_connector(Draft& draft, const Component& component, const Steps& steps);
void rigid_axial_force(Draft& draft, const Component& component, const Steps& steps);
void rigid_cable(Draft& draft, const Component& component, const Steps& steps);
/// A constraint that is no rigid connector.
void other_constraint(Draft& draft, const Component& component);
/// When all conditions have been read: joints whose directions only agree with FEBio's if a body does not turn.
void check_joints(Draft& draft);

// -- loads, contact, initial conditions --------------------------------------------------------------

/// A load that is neither on rigid bodies nor on nodes: zero, of flow, or unsupported.
void other_load(Draft& draft, const Component& component);
/// True if the numbers of a load are all zero.
bool is_zero_load(const Component& component);
void initial_condition(Draft& draft, const Component& component);
/// A contact of a type that contact_kind knows, without its surfaces and step. Lists as unsupported what changes a
/// sliding contact and DEA does not know: an offset.
Contact contact_of(Draft& draft, const Component& component);

// -- springs between nodes ---------------------------------------------------------------------------

struct DiscreteMaterial {
  DiscreteSprings springs;  ///< what the material says of them
  int function = 0;         ///< id of the load curve that is their force, 0: none
  double function_scale = 1.0;
  std::string unsupported, advice;  ///< why it cannot be used, and what to do about it
};
DiscreteMaterial discrete_material(Draft& draft, const Component& component);

}  // namespace dea::febio

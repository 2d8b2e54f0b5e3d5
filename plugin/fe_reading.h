// febiodea/plugin/fe_reading.h – inside of read_fe_model only: what is known while FEBio's model is read, parameters by
// name.
#pragma once
#include <FEBioMech/FEMechModel.h>
#include <FECore/FEDomain.h>
#include <FECore/FEMaterial.h>
#include <FECore/FENodalLoad.h>
#include <FECore/FEStepComponent.h>

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <febiodea/io/febio/febio_rules.h>
#include <febiodea/model/joint_model.h>

class FEFacetSet;
class FEFunction1D;
class FEModelLoad;

namespace dea::fe {

using febio::quote;

inline constexpr Origin kNowhere = {0, 0};

struct Reading {
  FEMechModel& fem;
  bool in_init = false;  ///< FEModel::Init has begun: some loads name bodies by then, not materials
  JointModel model;
  std::map<const FEMaterial*, int> materials;                   ///< index into JointModel::materials
  std::map<const FEFacetSet*, int> surfaces;                    ///< index into JointModel::surfaces
  std::map<const FEStepComponent*, std::vector<int>> steps_of;  ///< of what is active in some steps only
  febio::RemarkIndex ignored_index, unsupported_index;
};

void ignore(Reading& reading, const std::string& what);
/// `advice`: what to do about it; empty: take it out.
void unsupported(Reading& reading, const std::string& what, const std::string& advice = {});
[[noreturn]] void fail(const Reading& reading, const std::string& fault);

Vector3d vector_of(const vec3d& v);
std::string type_of(FECoreBase& object);
bool one_of(const std::string& word, std::initializer_list<const char*> words);
bool has(const std::string& text, const char* word);

// -- parameters, by their names in a file of version 4.0 ------------------------------------------------

/// Index of the load controller that a parameter follows; -1: none.
int controller_of(Reading& reading, FEParam& parameter);
FEParam& need_parameter(const Reading& reading, FECoreBase& object, const char* name);
/// A parameter that is one number now; nothing for a map, an expression, a vector.
std::optional<double> number_of(const FEParam& parameter);
double need_number(const Reading& reading, FECoreBase& object, const char* name);
int need_int(const Reading& reading, FECoreBase& object, const char* name);
Vector3d need_vector(const Reading& reading, FECoreBase& object, const char* name);
/// A vector that DEA keeps constant: one that follows a load controller is unsupported.
Vector3d constant_vector(Reading& reading, FECoreBase& object, const char* name);
Scaled need_scaled(Reading& reading, FECoreBase& object, const char* name);
/// False also if there is no such parameter.
bool flag(FECoreBase& object, const char* name);
/// Whether a load's vector or number is zero, whatever its load controller.
bool is_zero(FEParam& parameter);
/// A text without spaces around it; "" if there is none.
std::string text_of(FECoreBase& object, const char* name);
/// FEBio's word for what gives a mapped parameter its values: "const", "math", "map", ...
std::string kind_of(FEParam& parameter);

// -- names and steps -----------------------------------------------------------------------------------

/// Index of the rigid material with this 1-based number, as rigid conditions name it.
int need_rigid(const Reading& reading, FECoreBase& object, int id);
/// The same of parameter `name`.
int body_of(const Reading& reading, FECoreBase& object, const char* name = "rb");
/// The same for what counts bodies instead of materials once FEModel::Init has begun.
int renamed_body_of(const Reading& reading, FECoreBase& object, const char* name);
/// Place of a degree of freedom of nodes: 0, 1, 2 for x, y, z; -1: another one.
int xyz_of(Reading& reading, int dof);
std::string dof_name(Reading& reading, int dof);

/// The steps in which a component is active: {-1}: all.
std::vector<int> steps_of(const Reading& reading, const FEStepComponent& component);

/// Adds a condition with the component's name, once for each of its steps.
template <class Condition>
void add(const Reading& reading, FEStepComponent& component, std::vector<Condition>& list, Condition condition) {
  condition.name = component.GetName();
  condition.origin = kNowhere;
  for (const int step : steps_of(reading, component)) {
    condition.step = step;
    list.push_back(condition);
  }
}

// -- parts of the model ----------------------------------------------------------------------------------

/// Interpolation, extension and points of a curve.
void set_curve(LoadController& curve, int interpolate, int extend, const std::vector<vec2d>& points);

/// Loads on rigid bodies and nodes; false: it is none of them.
bool read_rigid_load(Reading& reading, FEModelLoad& load);
/// What joins two rigid bodies: springs, joints; false: it is none of them.
bool read_connector(Reading& reading, FENLConstraint& constraint);
/// After all rigid conditions have been read.
void check_joints(Reading& reading);
/// Springs between nodes.
void read_discrete(Reading& reading);

}  // namespace dea::fe

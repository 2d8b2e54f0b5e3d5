// plugin/fe_reading.h – inside of read_fe_model only: what is known while FEBio's model is read, parameters by
// name.
#pragma once
#include <FEBioMech/FEMechModel.h>
#include <FECore/FEDomain.h>
#include <FECore/FEMaterial.h>
#include <FECore/FENodalLoad.h>
#include <FECore/FEStepComponent.h>

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "io/febio/component.h"
#include "io/febio/interpret.h"
#include "src/model/joint_model.h"

class FEFacetSet;
class FEModelLoad;
class FERigidConnector;

namespace dea::fe {

using febio::quote;

inline constexpr Origin kNowhere = {0, 0};

struct Reading : febio::Draft {
  explicit Reading(FEMechModel& mechanics) : fem(mechanics), in_init(mechanics.RigidBodies() > 0) {}
  FEMechModel& fem;
  bool in_init;  ///< FEModel::Init has begun: some loads name bodies by then, not materials
  std::map<const FEMaterial*, int> materials;                   ///< index into JointModel::materials
  std::map<const FEFacetSet*, int> surfaces;                    ///< index into JointModel::surfaces
  std::map<const FEStepComponent*, std::vector<int>> steps_of;  ///< of what is active in some steps only
};

void ignore(Reading& reading, const std::string& what);
/// `advice`: what to do about it; empty: take it out.
void unsupported(Reading& reading, const std::string& what, const Sentence& advice = {});
[[noreturn]] void fail(const Reading& reading, const std::string& fault);

Vector3d vector_of(const vec3d& v);
std::string type_of(FECoreBase& object);

// -- parameters, by their names in a file of version 4.0 ------------------------------------------------

/// Index of the load controller that a parameter follows; -1: none.
int controller_of(Reading& reading, FEParam& parameter);
FEParam& need_parameter(const Reading& reading, FECoreBase& object, const char* name);
/// A text without spaces around it; "" if there is none.
std::string text_of(FECoreBase& object, const char* name);
/// FEBio's word for what gives a mapped parameter its values: "const", "math", "map", ...
std::string kind_of(FEParam& parameter);

// -- components ----------------------------------------------------------------------------------------

/// An object of FEBio's as it would stand in a file of version 4.0: `tag` names its element there.
febio::Component component_of(Reading& reading, FECoreBase& fe, const std::string& tag);
/// The same of what joins two bodies, and of a load: they name materials, whatever Init has made of them.
febio::Component connector_of(Reading& reading, FERigidConnector& fe);
febio::Component load_of(Reading& reading, FEModelLoad& fe, const std::string& tag);

/// The steps in which a component is active: {-1}: all.
febio::Steps steps_of(const Reading& reading, const FEStepComponent& component);

/// Springs between nodes.
void read_discrete(Reading& reading);

}  // namespace dea::fe

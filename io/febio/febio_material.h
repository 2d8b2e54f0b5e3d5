// io/febio/febio_material.h – FEBio's materials reduced to small-strain E and nu, whoever brings them: a .feb
// file (io/feb) or FEBio's own model (plugin).
#pragma once
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "src/model/joint_model.h"

namespace dea {

/// A material as FEBio names it: type, constants, nested materials.
struct MaterialTree {
  struct Constant {
    double value = std::numeric_limits<double>::quiet_NaN();
    std::string why;  ///< why it is not one number ("E follows a load controller"); empty: it is
    Origin origin;
  };
  std::string tag;   ///< of a nested one: its part in the one around it ("solid", "elastic")
  std::string type;  ///< FEBio's word
  std::map<std::string, Constant> constants;
  std::vector<MaterialTree> parts;
  Origin origin;
};

/// The value, or `fallback` if there is none of this name; NaN with the reason added to `why` if it is not one number.
double constant_of(const MaterialTree& material, const char* name, double fallback, std::string& why);

/// Fills type, E, nu and note of a deformable material. `nested_k_adds`: the k of uncoupled materials nested in
/// uncoupled ones is added to the k above, as FEBio does with files up to version 2.5 (its model then holds the sum).
/// What of it has no place in E and nu is listed in `model.ignored`, a missing v in `model.assumed`. Throws InputError
/// at the constant's place for values that no material may have.
void set_elasticity(Material& material, const MaterialTree& tree, bool nested_k_adds, JointModel& model);

/// Density of a material. Throws InputError if negative; a rigid body without a centre of mass needs one number, `why`
/// says why there is none ("" otherwise).
void set_density(Material& material, const MaterialTree& tree, const JointModel& model, std::string& why);

}  // namespace dea

// io/febio/febio_material.h – FEBio's materials reduced to small-strain E and nu, whoever brings them: a .feb
// file (io/feb) or FEBio's own model (plugin).
#pragma once
#include <string>

#include "io/febio/component.h"

namespace dea {

/// Fills type, E, nu and note of a deformable material from what is given of it: constants and nested materials.
/// `nested_k_adds`: the k of uncoupled materials nested in uncoupled ones is added to the k above, as FEBio does with
/// files up to version 2.5 (its model then holds the sum). What of it has no place in E and nu is listed in
/// `model.ignored`, a missing v in `model.assumed`. Throws InputError at the constant's place for values that no
/// material may have.
void set_elasticity(Material& material, const febio::Component& given, bool nested_k_adds, JointModel& model);

/// Density of a material. Throws InputError if negative; a rigid body without a centre of mass needs one number, `why`
/// says why there is none ("" otherwise).
void set_density(Material& material, const febio::Component& given, const JointModel& model, std::string& why);

}  // namespace dea

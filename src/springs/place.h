// src/springs/place.h – springs between the layers of a contact, with all that does not depend on the pose.
#pragma once
#include "src/springs/layer_bed.h"
#include "src/springs/springs.h"

namespace dea {

/// The springs of a contact; law layer: the layers as operators, factorised (layer_bed.h). Frame: reference.
SpringBed place_springs(const Joint& joint, const ContactPair& pair);
/// `shared`: of the contacts before; takes up the operators of layers that others press too.
SpringBed place_springs(const Joint& joint, const ContactPair& pair, SharedOperators& shared);

}  // namespace dea

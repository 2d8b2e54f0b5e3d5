// src/springs/place.h – springs between the layers of a contact, with all that does not depend on the pose.
#pragma once
#include "src/springs/layer_bed.h"
#include "src/springs/springs.h"

namespace dea {

/// The springs of a contact, for their geometry: law layer's cannot be pressed. Frame: reference.
SpringBed place_springs_alone(const Joint& joint, const ContactPair& pair);
/// The bed with the surfaces and ties of its parts where these have moved.
SpringBed with_parts_moved(const SpringBed& bed, const PartMotions& moved);
/// The springs of a contact; law layer: with the layers as operators, factorised (layer_bed.h). `shared`: of the
/// contacts before; takes up the operators of layers that others press too.
SpringBed place_springs(const Joint& joint, const ContactPair& pair, SharedOperators& shared);

}  // namespace dea

// src/springs/place.h – springs between the layers of a contact, with all that does not depend on the pose.
#pragma once
#include "src/springs/springs.h"

namespace dea {

/// One spring per triangle of the source's spring surface, each divided into refine^2 equal ones.
Springs make_springs(const Layer& source, int refine);

/// The springs of a contact; law layer: the layers as operators, factorised (layer_bed.h). Frame: reference.
SpringBed place_springs(const Joint& joint, const ContactPair& pair);

}  // namespace dea

// src/springs/place.h – springs between the layers of a contact, with all that does not depend on the pose.
#pragma once
#include "src/springs/layer_bed.h"
#include "src/springs/springs.h"

namespace dea {

/// The springs of a contact, for their geometry: law layer's cannot be pressed. Frame: reference.
SpringBed place_springs_alone(const Joint& joint, const ContactPair& pair);
/// The same springs and target with the vertices of both spring surfaces elsewhere, in the bodies' reference frames;
/// empty: as they are.
SpringBed with_surfaces_at(SpringBed bed, const std::vector<Vector3d>& source, const std::vector<Vector3d>& target);
/// The springs of a contact; law layer: with the layers as operators, factorised (layer_bed.h). `shared`: of the
/// contacts before; takes up the operators of layers that others press too.
SpringBed place_springs(const Joint& joint, const ContactPair& pair, SharedOperators& shared);

}  // namespace dea

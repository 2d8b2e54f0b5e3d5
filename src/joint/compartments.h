// src/joint/compartments.h – the pieces of an articular surface that hang together: a tibia's medial and lateral
// plateau.
#pragma once
#include <string>
#include <vector>

#include "src/joint/contact_side.h"
#include "src/joint/layer.h"

namespace dea {

/// Pieces whose triangles share vertices. Named by the model's part under each, where every piece has one of its own;
/// else two of them by the side of the axis that sets them apart, "-x" and "+x"; else by their numbers. Pieces below a
/// hundredth of the surface are one compartment together, the last, "rest". No names: it is one piece.
Compartments find_compartments(const JointModel& model, const CarriedSurface& carried, const SurfaceMesh& articular);

/// Deformable parts of one layer that touch without sharing nodes: in FEBio they slide past each other there, and each
/// would have a free rim here: InputError.
void refuse_touching_parts(const ContactSide& in, const Layer& layer);

}  // namespace dea

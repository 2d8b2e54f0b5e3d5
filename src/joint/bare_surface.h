// src/joint/bare_surface.h – the facets of a rigid body's surface as one surface with one outside.
#pragma once
#include <unordered_map>
#include <vector>

#include "src/base/finding.h"
#include "src/joint/contact_side.h"
#include "src/joint/layer.h"

namespace dea {

/// Facets that join where their nodes lie at one place, and that look to one side in each connected piece of shells.
struct BareSurface {
  FacetList facets;                         ///< of nodes that stand for all at their place
  std::vector<char> turned;                 ///< per facet: wound the other way than the model says
  std::unordered_map<int, int> stands_for;  ///< node -> the one at its place; of those that are not their own
  Findings findings;
};

/// InputError: the surface has no sides. Solids know their outside; facets on shells follow those beside them, in a
/// piece of shells alone the greater part of its area. Which side is which partners tell (face_partner). `merge`: nodes
/// that lie at one place, within 1e-6 of the facets' size, count as one.
BareSurface bare_surface(const ContactSide& in, const CarriedSurface& carried, bool merge);

/// Where a bare surface ends, and whether its body's mesh goes on there.
std::vector<BareRimEdge> bare_rim(const ModelParts& parts, const Layer& layer);

/// Turns the pieces of a bare surface on shells that look away from their partner, but for the back of another piece.
/// Tells how many facets look the other way than the model winds them.
Findings face_partner(const ModelParts& parts, Facets facets, const SurfaceMesh& partner, Layer& layer);

/// Of a part whose whole surface a contact has, facets that do not look at the partner are left out: what stands on the
/// far side would be found to overlap it from within. With --keep-facets none is.
void leave_out_far_side(const ModelParts& parts, Facets facets, const SurfaceMesh& partner, Layer& layer);

}  // namespace dea

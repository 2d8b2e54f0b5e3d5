// src/joint/carried_surface.h – a surface of the model with the elements its facets are faces of.
#pragma once
#include <vector>

#include "src/facts/parts.h"
#include "src/joint/layer_face.h"

namespace dea {

/// Facets of a surface with their carrying elements, oriented out of them.
struct CarriedSurface {
  FacetList facets;
  std::vector<ElementFace> carriers;  ///< one per facet
  bool on_shells = false;             ///< a shell has two sides: the surface's own orientation tells which
  int turned = 0;                     ///< facets that the model winds into their solid element
};
/// InputError: a fault of the surface or an element.
CarriedSurface carry(const ModelParts& parts, int surface);

/// InputError: a solid element is inside out or has no volume.
void check_volume(const JointModel& model, const Domain& domain, int element);

}  // namespace dea

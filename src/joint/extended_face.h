// src/joint/extended_face.h – what a layer's face goes on to beyond the selected facets.
#pragma once
#include <vector>

#include "src/facts/parts.h"
#include "src/joint/contact_side.h"
#include "src/joint/layer.h"

namespace dea {

/// Thickness at the vertices of the articular surface: the mean of what the map says of a node in the facets around it.
/// `map`: per facet and node of the surface.
std::vector<double> mapped_thickness(const Surface& s, const std::vector<double>& map, const SurfaceMesh& mesh);

/// The boundary of a layer whose elements are rigid with their bone, as `dea convert` writes them: the solid elements
/// under the surface, bonded where they share nodes with others of their body. They are the layer if they are as thick
/// as its map says, within 2 % for nearly all vertices inside; else they are bone, and nothing is known of the
/// cartilage beyond the selection: no faces.
LayerBoundary rigid_boundary(const ContactSide& in, const CarriedSurface& carried, const Layer& layer,
                             const std::vector<double>& map);

/// Do other contacts that act at the same time press these elements, with surfaces of their own? Then the layer's face
/// is followed to its end.
bool is_pressed_by_others(const ContactSide& in, const LayerBoundary& boundary);

/// Fills the face of a layer with elements. Gaps and thickness of the selection stay its own: at its rim they know the
/// facets on one side only.
void find_layer_face(const ContactSide& in, Facets facets, const CarriedSurface& carried, const LayerBoundary& boundary,
                     Layer& layer);

}  // namespace dea

// src/layer_face.h – the whole face of a cartilage layer: the facets that slide, and where the cartilage goes on beyond.
#pragma once
#include <vector>

#include "surface_mesh.h"

namespace dea {

/// What is beyond an edge of a layer's face.
enum class Rim {
  Free,      ///< nothing, the bulge escapes: q = 0 in the first term; the second as in Continues, and (L7)
  Wall,      ///< its mirror image (plane of symmetry): dq/dn = 0
  Continues  ///< more of the layer, without load: beta t^3 dq/dn = -sqrt(beta) t^2 q
};

/// The face of a layer, reference frame. It begins with the vertices and triangles of Layer::articular, in their order;
/// triangles behind these are cartilage that was not selected for the contact: it carries no pressure, but what is
/// squeezed flows into it.
struct LayerFace {
  struct Edge {
    int triangle = -1, edge = -1;  ///< from corner `edge` of the triangle to the next
    Rim rim = Rim::Free;
  };
  SurfaceMesh mesh;
  int pressed = 0;                ///< triangles of Layer::articular: the first ones
  std::vector<double> thickness;  ///< per vertex of `mesh`, >= 0
  std::vector<Edge> edges;        ///< of one triangle alone, sorted by triangle and edge
};

}  // namespace dea

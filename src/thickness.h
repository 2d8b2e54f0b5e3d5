// src/thickness.h – cartilage thickness of a layer, measured between its two surfaces.
#pragma once
#include "joint.h"

namespace dea {

/// Fills layer.thickness and layer.missed for the vertices of layer.spring_surface() (docs/theory.md, section 2): from
/// articular vertices along inward vertex normals to the bone surface, or, for springs at the bone, from bone vertices
/// along their normals to the articular surface [Abraham et al. 2013, 2.1]. A hit counts only on an opposing face
/// (angle below 60 degrees) and within twice the distance of the closest point; otherwise that distance serves,
/// flagged.
void measure_thickness(Layer& layer);

}  // namespace dea

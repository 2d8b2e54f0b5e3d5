// src/build/clear_overlap.h – gaps between articular surfaces, and layers made here that would overlap.
#pragma once
#include <vector>

#include "src/build/built_joint.h"
#include "src/geometry/ray_caster.h"

namespace dea {

/// Per vertex of an articular surface the gap along its normal to the other, < 0: they overlap; infinite: the other
/// does not face it within reach.
std::vector<double> joint_gaps(const BuiltLayer& layer, const RayCaster& other, double reach);

/// Per vertex of a layer the least of these to the layers that it has a contact with.
std::vector<double> layer_gaps(const BuiltJoint& joint, int layer, double reach);

/// How much thinner layers became.
struct Thinned {
  int vertices = 0;
  double most = 0.0;  ///< length
};

/// Layers that may change (`made`) are thinned where they overlap a layer of another body, each of two by half of it;
/// to no less than a fifth of their thickness.
std::vector<Thinned> clear_overlaps(std::vector<BuiltLayer>& layers, const std::vector<char>& made, double reach);

}  // namespace dea

// febiodea/joint/half_held.h – planes of symmetry of which nodes were forgotten.
#pragma once
#include <vector>

#include <febiodea/joint/layer.h>
#include <febiodea/joint/parts.h>

namespace dea {

/// Planes across an axis in which at least a fifth of the layer's nodes are held along that axis, and its face ends
/// there in edges that are not: free edges, where a plane of symmetry was meant.
std::vector<HalfHeldPlane> half_held_planes(const ModelParts& parts, const Layer& layer);

}  // namespace dea

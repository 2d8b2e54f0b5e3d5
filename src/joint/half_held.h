// src/joint/half_held.h – planes of symmetry of which nodes were forgotten, and nodes held where no plane is.
#pragma once
#include <vector>

#include "src/facts/parts.h"
#include "src/joint/layer.h"

namespace dea {

/// Planes across an axis in which at least a fifth of the layer's nodes are held along that axis, and its face ends
/// there in edges that are not: free edges, where a plane of symmetry was meant.
std::vector<HalfHeldPlane> half_held_planes(const ModelParts& parts, const Layer& layer);

/// Nodes of the layer that the ground holds in a component without a plane of symmetry across it: what the layer's law
/// knows nothing of. Nodes that its bone holds, and those of which another remark tells (ends held in another
/// component, planes half held, edges that count as walls), are left out; `layer.half_held` and `layer.ends` are known.
std::vector<HeldNodes> held_without_plane(const ModelParts& parts, const Layer& layer);

/// Nodes of the layer's pressed face, inside its rim, that its own body holds though cartilage lies under them; and
/// nodes anywhere in it that another body holds (a user's choice where several do). The springs know nothing of it.
std::vector<HeldFace> held_where_it_gives_way(const ModelParts& parts, const Layer& layer);

}  // namespace dea

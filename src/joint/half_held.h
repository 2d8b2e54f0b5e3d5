// src/joint/half_held.h – planes of symmetry of which nodes were forgotten, and nodes held where no plane is.
#pragma once
#include <vector>

#include "src/base/finding.h"
#include "src/facts/parts.h"
#include "src/joint/layer.h"

namespace dea {

/// How the model holds a layer's nodes otherwise than its user may have meant: `ends`, those of its deformable part.
/// Planes across an axis in which at least a fifth of the layer's nodes are held along that axis, and its face ends
/// there in edges that are not (plane-half-held). Ends held across another axis, with nodes forgotten, in some steps
/// (plane-held-across, plane-node-forgotten, plane-in-some-steps). Nodes that the ground holds in a component without a
/// plane of symmetry across it, of which the layer's law knows nothing (held-in-no-plane). Nodes of the pressed face,
/// inside its rim, that its own body holds though cartilage lies under them, and nodes anywhere in it that another body
/// holds, a user's choice where several do (held-in-layer).
Findings held_findings(const ModelParts& parts, const Layer& layer, const std::vector<PartEnd>& ends);

}  // namespace dea

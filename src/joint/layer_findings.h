// src/joint/layer_findings.h – what the user should know of a layer: how it is held, where it ends, how thin it is.
#pragma once
#include "src/base/finding.h"
#include "src/facts/parts.h"
#include "src/joint/layer.h"

namespace dea {

/// In order, those of Layer::findings first.
Findings layer_findings(const ModelParts& parts, const Layer& layer);

}  // namespace dea

// src/joint/left_out.h – facets of a selection that belong to no articular face, and what to say of them.
#pragma once
#include <string>
#include <vector>

#include "src/base/finding.h"
#include "src/base/sentence.h"
#include "src/joint/layer_face.h"

namespace dea {

/// The facets that are Open, the others without nodes; no kinds: all.
FacetList kept_facets(const FacetList& facets, const std::vector<FaceKind>& kinds);

/// Why a selection is no articular surface: most of it would be left out. Empty: it is one.
std::string mostly_left_out(const JointModel& model, const FacetList& facets, const std::vector<FaceKind>& kinds);

/// What was left out of a surface.
Findings left_out_findings(const std::string& surface, const std::vector<FaceKind>& kinds);

/// Rims that are neither one thing nor the other.
Findings rim_findings(const std::string& surface, const LayerFace& face);

}  // namespace dea

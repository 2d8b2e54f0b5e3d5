// src/joint/layer_material.h – modulus of a layer, and the materials beside it.
#pragma once
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "src/base/finding.h"
#include "src/joint/contact_side.h"
#include "src/model/elasticity.h"

namespace dea {

/// E and nu of a layer that is not rigid, NaN where nothing says them. `material`: of its elements, -1: it has none.
Elasticity layer_elasticity(const ContactSide& in, int material);
/// Why a layer cannot have this modulus.
std::optional<Fault> elasticity_fault(const ContactSide& in, int material, const Elasticity& elasticity);

/// One modulus stands for the whole layer. `under_facets`: material -> facets; `in_part`: all materials of its
/// deformable part. A little difference is told; another tissue, or a bone that is deformable, is an InputError.
Findings other_materials(const ContactSide& in, int material, const std::map<int, int>& under_facets,
                         const std::set<int>& in_part);

}  // namespace dea

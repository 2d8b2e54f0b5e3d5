// src/springs/edge_bulge.h – beside a pressed free edge a layer's surface moves outwards, and pressures with it (L11).
#pragma once
#include <functional>
#include <vector>

#include "src/springs/posed_bed.h"

namespace dea {

/// What flows out over the free edges (edge_flow) of the source's layer, or the target's; found when it is asked for.
using EdgeFlow = std::function<const std::vector<double>&(bool source)>;

/// Pressures are those of the deformed surface at the deformed place. Inside a layer that place may be taken for the
/// undeformed one (L9); beside a free edge, which moves outwards by u, it may not: what lies d from the edge has moved
/// by about u exp(-d/(0.6 t)). So a spring there presses more area than it stands on, and it meets the partner
/// elsewhere:
///     carrying = area (1 + u/(0.6 t) exp(-d/(0.6 t))),      p -> p (1 - opening u exp(-d/(0.6 t)) / overlap) (L11)
/// opening: of the gap per way outwards, between the planes of both surfaces; the overlap is taken for a quarter of
/// p t/E at least. Where the partner does not go on over the edge there is neither. Sets SpringStates::carrying and
/// changes pressures; returns by what factors.
std::vector<double> press_bulges(const PosedBed& posed, const EdgeFlow& flow, SpringStates& states);

}  // namespace dea

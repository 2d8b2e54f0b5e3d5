// src/springs/layer_bed.h – the spring bed of Law::Layer: its springs share what the layers give way sideways
// (L1-L11).
#pragma once
#include <map>
#include <memory>
#include <vector>

#include "src/springs/part_bed.h"
#include "src/springs/posed_bed.h"

namespace dea {

/// The operators of layers that several contacts press, and of parts, made as they are asked for: by the index of the
/// joint's shared layer, of its part.
struct SharedOperators {
  std::map<int, std::shared_ptr<const LayerOperator>> layers;
  std::map<int, std::shared_ptr<const PartOperator>> parts;
};

std::shared_ptr<LayerBed> make_layer_bed(const Joint& joint, const ContactPair& pair, SharedOperators& shared);

/// What of the target's layer each foot covers at a pose (L8): its triangle, seen along its direction, cut by the
/// target's triangles, from the one at its spring's end on over their neighbours. Feet further from the target than
/// `reach` stand on nothing: nobody presses there. Without columns (set_reach).
LayerFeet feet_on_target(const SpringBed& bed, const SpringStates& states, const Pose& source_pose,
                         const Pose& target_pose, double reach);

/// The source's feet at a pose: one that lies over the target only in part carries its pressure on that part.
/// `area`: of each spring that carries one. Without columns.
LayerFeet feet_on_source(const LayerBed& layers, const Eigen::VectorXd& area);

/// How parts have probably moved at these poses: by what the memory has of the last ones.
PartMotions motions_to_start_from(const std::vector<PosedBed>& beds, const PressMemory& memory);

/// Fills pressures, strains, rates and the target's parts of springs that carry nothing yet; their gaps, overlaps, feet
/// and areas must be there. All contacts that share layers are one problem (L4) over the union of their feet. `states`:
/// one per bed; of those that are not active, empty. `memory`: as in press_springs.
/// `moved`: how parts had moved where the gaps were found (SpringStates::part_motion; they are added up to where
/// nothing had); set to how they move now. True: pressures fit these gaps, and all is filled; else find gaps there and
/// call again. Without parts always true; with them `memory` must be there. `misfit`: set to how far the pressures it
/// began with were from fitting, of the greatest (LayerPressure).
bool press_layers(const std::vector<PosedBed>& beds, std::vector<SpringStates>& states, const PressOptions& options,
                  PressMemory* memory, PartMotions& moved, double& misfit);

}  // namespace dea

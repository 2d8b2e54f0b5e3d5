// src/springs/layer_bed.h – the spring bed of Law::Layer: its springs share what the layers give way sideways
// (L1-L10).
#pragma once
#include <optional>

#include "src/springs/layer_contact.h"
#include "src/springs/springs.h"

namespace dea {

/// The two layers of a contact as operators, each on its own mesh: factorised once, whatever the poses.
struct LayerBed {
  std::optional<LayerOperator> source, target;  ///< empty: a bare rigid surface
  LayerFeet whole;                              ///< the springs' whole feet on the source's layer
};

std::shared_ptr<const LayerBed> make_layer_bed(const ContactPair& pair);

/// What of the target's layer each foot covers at a pose (L8): its triangle, seen along its direction, cut by the
/// target's triangles, from the one at its spring's end on over their neighbours. Feet further from the target than
/// `reach` stand on nothing: nobody presses there.
LayerFeet feet_on_target(const SpringBed& bed, const LayerOperator& target, const SpringStates& states,
                         const Pose& source_pose, const Pose& target_pose, double reach);

/// The source's feet at a pose: one that lies over the target only in part carries its pressure on that part.
/// `area`: of each spring that carries one.
LayerFeet feet_on_source(const LayerBed& layers, const Eigen::VectorXd& area);

/// Fills pressures, strains, `rates` and the target's parts of springs that carry nothing yet; their gaps, overlaps,
/// feet and areas must be there. `source`, `target`: their poses. `memory`: as in press_springs.
void press_layers(const LayerBed& layers, const SpringBed& bed, SpringStates& states, const Pose& source,
                  const Pose& target, const PressOptions& options, PressMemory* memory);

}  // namespace dea

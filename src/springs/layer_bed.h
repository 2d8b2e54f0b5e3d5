// src/springs/layer_bed.h – the spring bed of Law::Layer: its springs share what the layers give way sideways
// (L1-L11).
#pragma once
#include <map>
#include <memory>
#include <vector>

#include "src/springs/layer_contact.h"
#include "src/springs/springs.h"

namespace dea {

/// A layer as one contact presses it.
struct BedLayer {
  std::shared_ptr<const LayerOperator> layer;  ///< the same for all contacts that press it; none: a bare rigid surface
  /// Where other contacts press it too, per triangle of the contact's own surface: its number in the layer's face, and
  /// how many corners it is turned there (corner k of the one is corner k + turn of the other). Empty: as they are.
  std::vector<int> triangle;
  std::vector<unsigned char> turn;
  std::vector<char> own;  ///< per triangle of the layer's mesh: of the contact's surface; empty: the pressed ones are

  /// The triangle of the layer's mesh at a point of the surface's triangle `t`.
  int mesh_triangle(int t, const Barycentric& w) const;
};

/// The two layers of a contact as operators, each on its own mesh: factorised once, whatever the poses.
struct LayerBed {
  BedLayer source, target;
  LayerFeet whole;                   ///< the springs' whole feet on the source's layer
  std::vector<int> source_triangle;  ///< per spring: the triangle of the source's mesh it stands on
};

/// The operators of layers that several contacts press, made as they are asked for: one per shared layer of the joint.
using SharedOperators = std::map<int, std::shared_ptr<const LayerOperator>>;

std::shared_ptr<const LayerBed> make_layer_bed(const Joint& joint, const ContactPair& pair, SharedOperators& shared);

/// What of the target's layer each foot covers at a pose (L8): its triangle, seen along its direction, cut by the
/// target's triangles, from the one at its spring's end on over their neighbours. Feet further from the target than
/// `reach` stand on nothing: nobody presses there. Without columns (set_reach).
LayerFeet feet_on_target(const SpringBed& bed, const SpringStates& states, const Pose& source_pose,
                         const Pose& target_pose, double reach);

/// The source's feet at a pose: one that lies over the target only in part carries its pressure on that part.
/// `area`: of each spring that carries one. Without columns.
LayerFeet feet_on_source(const LayerBed& layers, const Eigen::VectorXd& area);

/// A contact with Law::Layer at a pose.
struct PosedBed {
  const SpringBed* bed = nullptr;  ///< not owned
  Pose source, target;
  Motions motions = kAllMotions;  ///< whose rates are asked for
  bool active = true;             ///< false: it does not press
};

/// Fills pressures, strains, rates and the target's parts of springs that carry nothing yet; their gaps, overlaps, feet
/// and areas must be there. All contacts that share layers are one problem (L4) over the union of their feet. `states`:
/// one per bed; of those that are not active, empty. `memory`: as in press_springs.
void press_layers(const std::vector<PosedBed>& beds, std::vector<SpringStates>& states, const PressOptions& options,
                  PressMemory* memory);

}  // namespace dea

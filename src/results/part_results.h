// src/results/part_results.h – stress and strain in the deformable parts of a joint (docs/parts.md).
#pragma once
#include <vector>

#include "src/equilibrium/equilibrium.h"
#include "src/joint/joint.h"
#include "src/results/inside_fields.h"

namespace dea {

/// Over the elements of a part, weighted by volume.
struct PartNumber {
  double p99 = kNaN, peak = kNaN;
};

/// One part at one equilibrium. Stress and strain at element centres: means over the element, small strain.
struct PartStress {
  std::vector<SymmetricTensor> stress;  ///< per element of its mesh, current global axes [MPa]
  std::vector<SymmetricTensor> strain;  ///< global axes of the reference
  PartNumber principal;                 ///< first principal stress [MPa]
  PartNumber fibre;                     ///< stress along its fibres, the hoop of a meniscus [MPa]; NaN: it has none
  double largest_strain = 0.0;          ///< largest principal strain of an element, drawn or pressed
  double largest_turn = 0.0;            ///< by which an element has turned in the part's frame [rad]
  double largest_displacement = 0.0;    ///< of a node, from where the model has it [mm]
};

/// One per part of the joint, at an equilibrium that still has its springs.
std::vector<PartStress> part_stress(const Joint& joint, const Equilibrium& e);

/// With the stress and strain of parts in the place of their elements.
std::vector<InsideDomain> with_parts(const JointModel& model, const Joint& joint, const std::vector<PartStress>& parts,
                                     std::vector<InsideDomain> inside);

}  // namespace dea

// src/run/cost.h – what the springs of a joint will cost, before they are placed.
#pragma once
#include "src/joint/joint.h"

namespace dea {

struct SpringCost {
  double springs = 0;          ///< of all contacts
  double layer_triangles = 0;  ///< law layer: of both layers' meshes; else 0
  double bytes = 0;        ///< of memory, while a state is solved: an estimate, within a fifth for law linear and for
                           ///< half a million layer triangles, coarser beyond
  double layer_bytes = 0;  ///< law layer: of these, the layers' matrices
};

/// With every contact divided `refine` times; 0: each as it is (ContactPair::refine).
SpringCost spring_cost(const Joint& joint, int refine = 0);

/// Bytes of memory that a joint takes between two solutions (Prepared), with its model: an estimate.
double kept_bytes(const JointModel& model, const Joint& joint);

/// The largest division of all contacts that fits in so many bytes; 0: none does. At most 1000.
int largest_refine(const Joint& joint, double bytes);

}  // namespace dea

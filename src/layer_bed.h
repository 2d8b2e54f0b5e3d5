// src/layer_bed.h – the spring bed of `--law layer`: its springs share what the layers give way sideways (L1-L6).
#pragma once
#include <optional>

#include "layer_contact.h"
#include "springs.h"

namespace dea {

/// The two layers of a contact as operators on the source's mesh. The target's thickness is that at the springs' ends,
/// so its factorisation is renewed at every pose. One bed serves one caller at a time.
struct LayerBed {
  std::shared_ptr<const LayerMesh> mesh;
  std::vector<Rim> rim;                         ///< of the source's layer, per edge of mesh->rim
  std::optional<LayerOperator> source, target;  ///< empty: a bare rigid surface

  // where the next search starts: P of the last pose, its rates (feet x 6, as SpringStates::rates) and that pose
  Eigen::VectorXd last;
  Eigen::MatrixXd last_rates;
  Pose last_source, last_target;
};

/// Throws InputError for springs that do not stand on the articular surface. `bed`: all but its layers.
std::shared_ptr<LayerBed> make_layer_bed(const SpringBed& bed);

/// Fills pressures, strains and `rates` of springs that carry nothing yet; their gaps, overlaps, feet and areas must be
/// there. `source`, `target`: their poses.
void press_layers(LayerBed& layers, const SpringBed& bed, SpringStates& states, const Pose& source, const Pose& target);

}  // namespace dea

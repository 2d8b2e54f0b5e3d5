// src/joint/joint.h – the joint behind a model: rigid bodies, cartilage layers, what holds and moves them.
#pragma once
#include <string>
#include <vector>

#include "src/base/fault.h"
#include "src/base/finding.h"
#include "src/facts/bodies.h"
#include "src/facts/conditions.h"
#include "src/joint/connections.h"
#include "src/joint/contacts.h"
#include "src/joint/layer.h"
#include "src/joint/part.h"
#include "src/joint/shared_layers.h"
#include "src/model/joint_model.h"
#include "src/model/settings.h"

namespace dea {

struct Joint : Connections {
  std::vector<Body> bodies;
  std::vector<ContactPair> contacts;
  std::vector<SharedLayer> shared_layers;  ///< that more than one of them press
  std::vector<SoftPart> parts;
  std::vector<int> node_body;  ///< per model node: body that carries it, -1: none (stays where it is)
  Conditions conditions;       ///< of the model, without what the settings say of them
  std::vector<SymmetryPlane> symmetry_planes;
  Findings findings;  ///< what was concluded, left out or is taken otherwise than in FEBio, in order

  /// Index of the body with this name (of any of its materials), -1: none.
  int find_body(const JointModel& model, const std::string& name) const;
  /// Index of the body that a rigid material became, -1: none.
  int body_of(int material) const;
};

/// Where a side of a contact is among a joint's shared layers.
struct LayerPlace {
  int layer = -1;  ///< index into Joint::shared_layers; -1: no other contact presses its layer
  const LayerUse* use = nullptr;
};
LayerPlace place_in_shared_layer(const Joint& joint, const ContactPair& pair, int side);

struct JointFound {
  Joint joint;
  std::vector<Fault> faults;  ///< why the joint cannot be made of the model; not empty: the joint is not complete
};

/// Finds bodies, layers, thicknesses and moduli (docs/theory.md, section 2). Throws UsageError when a setting names
/// nothing in the model.
JointFound find_joint(const JointModel& model, const Settings& settings);

/// UsageError: a setting names a body that is not among these.
void check_body_names(const JointModel& model, const std::vector<Body>& bodies, const Settings& settings);

/// The joint alone. Throws InputError where there are faults.
Joint make_joint(const JointModel& model, const Settings& settings);

/// Why a model has no contact that DEA could solve, where no sliding contact is there at all: names those that are.
Fault no_sliding_contact(const JointModel& model);

}  // namespace dea

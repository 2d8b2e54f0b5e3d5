// src/joint/contacts.h – pairs of layers that slide on each other.
#pragma once
#include <string>
#include <vector>

#include "src/base/fault.h"
#include "src/base/finding.h"
#include "src/joint/layer.h"

namespace dea {

struct ModelParts;

/// Two layers that slide on each other. layers[source] carries the springs, layers[1 - source] is their target.
struct ContactPair : Condition {
  int contact = -1;      ///< index into JointModel::contacts
  Layer layers[2] = {};  ///< primary, secondary
  int source = 0;
  Law law = Law::Linear;
  LayerFit layer_fit = LayerFit::TwoTerms;
  double interface_compliance = 0.0;  ///< gap per pressure in series with the layers (S9)
  Facets facets = Facets::Curved;
  /// Each spring triangle, and with Law::Layer each triangle of both layers' faces, is divided into refine^2.
  int refine = 1;
  const Layer& source_layer() const { return layers[source]; }
  const Layer& target_layer() const { return layers[1 - source]; }
};

/// What the sliding contacts of a model were taken for.
struct FoundContacts {
  std::vector<ContactPair> contacts;
  Findings findings;
  std::vector<Fault> faults;  ///< not empty: the rest is not complete
  int sliding = 0;            ///< sliding contacts of the model
};

/// Recognises every contact that is wanted. Layers that cannot be recognised are told all at once, after `faults`,
/// those met before; a contact that can be none ends the search, and is told alone. Throws UsageError.
FoundContacts find_contacts(const ModelParts& parts, std::vector<Fault> faults);

}  // namespace dea

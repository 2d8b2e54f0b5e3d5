// src/joint/shared_layers.h – layers of cartilage that several contacts press: tibia medial, lateral and patella on a
// femur, two heads in one fossa.
#pragma once
#include <string>
#include <vector>

#include "src/base/finding.h"
#include "src/joint/contacts.h"

namespace dea {

struct ModelParts;

/// One side of a contact that presses a shared layer.
struct LayerUse {
  int contact = -1;  ///< index into Joint::contacts
  int side = -1;     ///< 0: primary, 1: secondary
  /// Per triangle of the side's spring surface: its number among the layer's triangles, and how many corners it is
  /// turned there: corner k of the one is corner k + turn of the other.
  std::vector<int> triangle;
  std::vector<unsigned char> turn;
};

/// A layer that two or more contacts press at the same time. Numbers do not depend on the order of the contacts.
struct SharedLayer {
  std::string name;  ///< of its surfaces: "medial + lateral"
  std::vector<LayerUse> uses;
  int pressed = 0;           ///< triangles of all uses' spring surfaces together, those that several have counted once
  std::vector<double> area;  ///< per such triangle
  /// Springs at the articular surface: the face of all uses, its first triangles those. Else empty.
  LayerFace face;
};

/// Which sides of the contacts press one layer: of one body, of elements that hang together, with faces that run into
/// each other. Tells it in `findings`; marks in each side's face the facets that others press. InputError: what is said
/// of the layer's E, nu, thickness or division differs from contact to contact.
std::vector<SharedLayer> find_shared_layers(const ModelParts& parts, std::vector<ContactPair>& contacts,
                                            Findings& findings);

}  // namespace dea

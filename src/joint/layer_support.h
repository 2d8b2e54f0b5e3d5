// src/joint/layer_support.h – what a layer rests on: the parts under its facets, the body it moves with.
#pragma once
#include <map>
#include <set>
#include <string>
#include <vector>

#include "src/joint/carried_surface.h"
#include "src/joint/contact_side.h"

namespace dea {

/// What carries the facets: deformable parts, such as the two plateaus of a tibia, or one rigid body.
struct Support {
  std::set<int> regions;         ///< deformable parts; empty: rigid
  std::set<int> bodies;          ///< rigid ones under the facets
  std::map<int, int> materials;  ///< deformable material -> facets
  /// The material under most of the facets.
  int main_material() const;
};
/// InputError: they are none, or both.
Support find_support(const ContactSide& in, const CarriedSurface& carried);

/// The body a layer moves with.
struct Attachment {
  int body = -1;
  std::string by;  ///< the rule that found it, as a sentence
};
/// As the user says, or what bears the facets, or what holds all their parts. InputError: there is not one body. Throws
/// UsageError for a body there is not.
Attachment find_attachment(const ContactSide& in, const Support& support);

/// The elements of the layer's parts.
struct LayerElements {
  std::vector<int> nodes;  ///< ascending
  std::set<int> materials;
};
/// InputError: one has no volume.
LayerElements find_layer_elements(const ModelParts& parts, const std::set<int>& regions);

}  // namespace dea

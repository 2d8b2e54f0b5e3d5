// src/joint/layer_support.h – what a layer rests on and is made of: the parts under its facets, the body it moves with,
// its modulus.
#pragma once
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "src/base/finding.h"
#include "src/joint/contact_side.h"
#include "src/model/elasticity.h"

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

/// E and nu of a layer that is not rigid, NaN where nothing says them. `material`: of its elements, -1: it has none.
Elasticity layer_elasticity(const ContactSide& in, int material);
/// Why a layer cannot have this modulus.
std::optional<Fault> elasticity_fault(const ContactSide& in, int material, const Elasticity& elasticity);

/// One modulus stands for the whole layer. `under_facets`: material -> facets; `in_part`: all materials of its
/// deformable part. A little difference is told; another tissue, or a bone that is deformable, is an InputError.
Findings other_materials(const ContactSide& in, int material, const std::map<int, int>& under_facets,
                         const std::set<int>& in_part);

}  // namespace dea

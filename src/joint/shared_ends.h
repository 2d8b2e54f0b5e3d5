// src/joint/shared_ends.h – where both surfaces of a contact end in one plane, as where a joint is cut in two.
#pragma once
#include <optional>
#include <vector>

#include "src/facts/bodies.h"
#include "src/geometry/pose.h"
#include "src/joint/contacts.h"

namespace dea {

/// Both articular surfaces end in this plane of the reference configuration, on one side of it.
struct SharedEnd {
  SymmetryPlane plane;
  double tolerance = 0.0;  ///< vertices nearer to the plane lie in it
  bool symmetry = false;   ///< one of the contact's planes of symmetry; else both have free edges there
};
std::vector<SharedEnd> shared_ends(const ContactPair& pair);

/// A plane of symmetry that two bodies no longer share: one has crossed it, or turned out of it, as seen from the
/// other. Its mirror image has done the opposite, so the model no longer stands for a whole joint.
struct LeftPlane {
  SymmetryPlane plane;
  double shift = 0.0;  ///< largest change of a distance from the plane, over the primary's articular surface
  int body = -1;       ///< the one of the two that has moved more across it
};
/// `poses`: per body. The worst plane whose shift is beyond a hundredth of the layers' mean thickness together.
std::optional<LeftPlane> left_plane(const ContactPair& pair, const std::vector<Body>& bodies,
                                    const std::vector<Pose>& poses);

}  // namespace dea

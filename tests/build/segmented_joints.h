// tests/build/segmented_joints.h – joints as scanners and segmentation give them: closed bones, closed cartilages or
// open sheets, with the faults they come with. Each seed is a joint of its own.
#pragma once
#include <string>
#include <vector>

#include "src/build/build_joint.h"

namespace dea::test {

/// What a seed has drawn.
struct SegmentedJoint {
  std::string kind;     ///< "patella", "plateaus", ...
  std::string words;    ///< edge, rim, noise, faults
  bool shares = false;  ///< two contacts have one layer: solved once such contacts are
  BuildRequest request;
};

SegmentedJoint segmented_joint(unsigned seed);

}  // namespace dea::test

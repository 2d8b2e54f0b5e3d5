#include "src/springs/springs.h"

#include <algorithm>

#include "src/base/numbers.h"
#include "src/springs/spring_law.h"

namespace dea {

SpringDepth spring_depth(const SpringStates& s) {
  SpringDepth depth;
  for (int i = 0; i < s.size(); ++i) {
    depth.through += s.too_deep[at(i)];
    depth.strained += s.strain[at(i)] > kStrainLimit;
    depth.largest = std::max(depth.largest, s.strain[at(i)]);
  }
  return depth;
}

}  // namespace dea

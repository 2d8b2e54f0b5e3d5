#include "src/joint/part.h"

#include <algorithm>

namespace dea {

std::vector<Vector3d> PartMesh::corners(int element) const {
  std::vector<Vector3d> places;
  for (int i = begin[at(element)]; i < begin[at(element) + 1]; ++i) places.push_back(nodes[at(element_node[at(i)])]);
  return places;
}

bool SoftPart::free() const {
  return std::all_of(holder.begin(), holder.end(), [](int body) { return body < 0; });
}

}  // namespace dea

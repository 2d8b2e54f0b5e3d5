#include "src/joint/part.h"

#include <algorithm>

namespace dea {

std::vector<Vector3d> PartMesh::corners(int element) const {
  std::vector<Vector3d> places;
  for (int i = begin[at(element)]; i < begin[at(element) + 1]; ++i) places.push_back(nodes[at(element_node[at(i)])]);
  return places;
}

int SoftPart::node_of(int model_node) const {
  const auto place = std::lower_bound(model_nodes.begin(), model_nodes.end(), model_node);
  const bool there = place != model_nodes.end() && *place == model_node;
  return there ? static_cast<int>(place - model_nodes.begin()) : -1;
}

bool SoftPart::free() const {
  return std::all_of(holder.begin(), holder.end(), [](int body) { return body < 0; }) &&
         std::all_of(held.begin(), held.end(), [](unsigned char along) { return along == 0; });
}

}  // namespace dea

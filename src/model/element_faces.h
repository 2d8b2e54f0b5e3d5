// src/model/element_faces.h – facets: their corners, what two elements that share one agree on, how it is cut into
// triangles.
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "src/model/joint_model.h"

namespace dea {

/// Number of corners of a facet with this many nodes (3, 6, 7, 10: triangle; 4, 8, 9: quad); 0: no such facet.
int facet_corners(int facet_nodes);

/// What two elements that share a face agree on: its distinct corner nodes, sorted, -1 padded. A collapsed quad is the
/// triangle of its distinct corners.
using FaceKey = std::array<int, 4>;
FaceKey face_key(const int* nodes, int corners);
FaceKey face_key(const std::vector<int>& facet);
struct FaceKeyHash {
  std::size_t operator()(const FaceKey& key) const;
};

/// The facet's nodes the other way round.
std::vector<int> turned_round(std::vector<int> facet);

/// Edges of facets from corner to corner.
struct FacetEdge {
  int low, high;    ///< corner nodes
  int facet, edge;  ///< from corner `edge` to the next
};
/// Those of one place together.
std::vector<FacetEdge> facet_edges(const std::vector<std::vector<int>>& facets);
/// Calls f(first, last) for the edges of each place.
template <class F>
void for_each_place(const std::vector<FacetEdge>& edges, F f) {
  for (std::size_t i = 0, j = 0; i < edges.size(); i = j) {
    while (j < edges.size() && edges[j].low == edges[i].low && edges[j].high == edges[i].high) ++j;
    f(i, j);
  }
}

/// Triangles of one facet, at most 8: there are too many facets for memory to be asked for each.
class FacetTriangles {
 public:
  void push_back(const std::array<int, 3>& nodes) { nodes_[static_cast<std::size_t>(count_++)] = nodes; }
  const std::array<int, 3>* begin() const { return nodes_.data(); }
  const std::array<int, 3>* end() const { return nodes_.data() + count_; }

 private:
  std::array<std::array<int, 3>, 8> nodes_;
  int count_ = 0;
};

/// The facet cut into triangles of its own nodes, orientation kept. Quadratic facets are split through their
/// mid-side nodes so that they keep their curvature; a quad (also the inner quad of an 8-node facet and the four
/// of a 9-node facet) on its shorter diagonal, on a tie (equal to 1e-5, so that the rounding of coordinates in a file
/// chooses nothing) at the lowest node number. `facet`: node indices; `positions`: of all nodes of the model. Returns
/// triples of node indices.
FacetTriangles split_facet(const int* facet, int facet_nodes, const std::vector<Vector3d>& positions);
FacetTriangles split_facet(const std::vector<int>& facet, const std::vector<Vector3d>& positions);

/// Twice the area, along the normal.
Vector3d area_vector(const std::array<int, 3>& triangle, const std::vector<Vector3d>& positions);
Vector3d area_vector(const std::vector<int>& facet, const std::vector<Vector3d>& positions);

}  // namespace dea

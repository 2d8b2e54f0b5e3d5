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
struct FaceKeyHash {
  std::size_t operator()(const FaceKey& key) const;
};

/// The facet cut into triangles of its own nodes, orientation kept. Quadratic facets are split through their
/// mid-side nodes so that they keep their curvature; a quad (also the inner quad of an 8-node facet and the four
/// of a 9-node facet) on its shorter diagonal, on a tie (equal to 1e-5, so that the rounding of coordinates in a file
/// chooses nothing) at the lowest node number. `facet`: node indices; `positions`: of all nodes of the model. Returns
/// triples of node indices.
std::vector<std::array<int, 3>> split_facet(const int* facet, int facet_nodes, const std::vector<Vector3d>& positions);

}  // namespace dea

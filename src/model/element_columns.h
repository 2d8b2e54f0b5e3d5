// src/model/element_columns.h – columns of solid elements under the facets of a surface, one element behind the
// other.
#pragma once
#include <vector>

#include "src/model/element_shape.h"

namespace dea {

/// Elements of one shape. Not owned: nodes_per_element(shape) node numbers each.
struct ElementBlock {
  ElementShape shape = ElementShape::Hex8;
  const std::vector<int>* nodes = nullptr;
  int size() const { return static_cast<int>(nodes->size()) / nodes_per_element(shape); }
};

/// Elements are counted through all blocks, those of the first one first.
struct ElementColumns {
  std::vector<std::vector<int>> of_facet;  ///< from the facet on inwards; empty: no element has this face
  /// Per facet: followed to the far side, through elements that have a face opposite to another one (hexes, and
  /// pentas through their triangles).
  std::vector<char> whole;
};
/// Facet i: facet_nodes[begin[i]] .. facet_nodes[begin[i + 1]]. Solid blocks only count. A face with an element on
/// either side belongs to no surface: its column is empty.
ElementColumns element_columns(const std::vector<ElementBlock>& blocks, const std::vector<int>& begin,
                               const std::vector<int>& facet_nodes);

}  // namespace dea

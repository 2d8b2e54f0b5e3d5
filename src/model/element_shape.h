// src/model/element_shape.h – the element shapes: one table of their names, nodes and faces. Numbers that a file
// format has for them are in its own place (io/xplt/xplt.cpp, io/vtu/write_vtu.cpp).
#pragma once
#include <vector>

namespace dea {

/// FEBio's node order (docs/formats.md).
enum class ElementShape {
  Hex8,
  Hex20,
  Hex27,
  Penta6,
  Penta15,
  Tet4,
  Tet5,
  Tet10,
  Tet15,
  Tet20,
  Pyra5,
  Pyra13,
  Tri3,
  Tri6,
  Quad4,
  Quad8,
  Quad9,
  Line2,
  Line3
};

/// Shells are triangles and quads; lines are trusses, beams, springs.
enum class ElementKind { Solid, Shell, Line };

struct ElementType {
  ElementShape shape;
  const char* name;  ///< FEBio's, without an integration rule: "hex8"
  ElementKind kind;
  int nodes;
  /// Faces of a solid element as lists of local node numbers, corners first, then mid-edge nodes (edge k joins corners
  /// k and k + 1), then the centre node if the shape has one. Corners run counter-clockwise seen from outside, so that
  /// the right-hand normal points out of the element. A shell has one face: itself. Lines: none.
  std::vector<std::vector<int>> faces;
};

/// A row per shape, in the order of ElementShape.
const std::vector<ElementType>& element_types();
const ElementType& element_type(ElementShape shape);

inline const std::vector<std::vector<int>>& element_faces(ElementShape shape) { return element_type(shape).faces; }
inline int nodes_per_element(ElementShape shape) { return element_type(shape).nodes; }
inline bool is_shell(ElementShape shape) { return element_type(shape).kind == ElementKind::Shell; }
inline bool is_line(ElementShape shape) { return element_type(shape).kind == ElementKind::Line; }

}  // namespace dea

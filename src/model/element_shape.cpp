#include "src/model/element_shape.h"

#include <cassert>
#include <cstddef>

namespace dea {

namespace {

using Faces = std::vector<std::vector<int>>;

const Faces kHexFaces = {{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}, {0, 3, 2, 1}, {4, 5, 6, 7}};
const Faces kHex20Faces = {{0, 1, 5, 4, 8, 17, 12, 16},  {1, 2, 6, 5, 9, 18, 13, 17}, {2, 3, 7, 6, 10, 19, 14, 18},
                           {3, 0, 4, 7, 11, 16, 15, 19}, {0, 3, 2, 1, 11, 10, 9, 8},  {4, 5, 6, 7, 12, 13, 14, 15}};
const Faces kTetFaces = {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {0, 2, 1}};
const Faces kTet10Faces = {{0, 1, 3, 4, 8, 7}, {1, 2, 3, 5, 9, 8}, {2, 0, 3, 6, 7, 9}, {0, 2, 1, 6, 5, 4}};
const Faces kPenta15Faces = {{0, 1, 4, 3, 6, 13, 9, 12},
                             {1, 2, 5, 4, 7, 14, 10, 13},
                             {2, 0, 3, 5, 8, 12, 11, 14},
                             {0, 2, 1, 8, 7, 6},
                             {3, 4, 5, 9, 10, 11}};
const Faces kPyra13Faces = {
    {0, 1, 4, 5, 10, 9}, {1, 2, 4, 6, 11, 10}, {2, 3, 4, 7, 12, 11}, {3, 0, 4, 8, 9, 12}, {0, 3, 2, 1, 8, 7, 6, 5}};

}  // namespace

const std::vector<ElementType>& element_types() {
  using S = ElementShape;
  constexpr ElementKind solid = ElementKind::Solid, shell = ElementKind::Shell, line = ElementKind::Line;
  static const std::vector<ElementType> types = {
      {S::Hex8, "hex8", solid, 8, kHexFaces},
      {S::Hex20, "hex20", solid, 20, kHex20Faces},
      {S::Hex27, "hex27", solid, 27, kHex20Faces},  // without face centres: they may be in any order
      {S::Penta6, "penta6", solid, 6, {{0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}, {0, 2, 1}, {3, 4, 5}}},
      {S::Penta15, "penta15", solid, 15, kPenta15Faces},
      {S::Tet4, "tet4", solid, 4, kTetFaces},
      {S::Tet5, "tet5", solid, 5, kTetFaces},
      {S::Tet10, "tet10", solid, 10, kTet10Faces},
      {S::Tet15, "tet15", solid, 15, kTet10Faces},
      {S::Tet20, "tet20", solid, 20, kTetFaces},  // a cubic face is taken as its flat triangle
      {S::Pyra5, "pyra5", solid, 5, {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {0, 3, 2, 1}}},
      {S::Pyra13, "pyra13", solid, 13, kPyra13Faces},
      {S::Tri3, "tri3", shell, 3, {{0, 1, 2}}},
      {S::Tri6, "tri6", shell, 6, {{0, 1, 2, 3, 4, 5}}},
      {S::Quad4, "quad4", shell, 4, {{0, 1, 2, 3}}},
      {S::Quad8, "quad8", shell, 8, {{0, 1, 2, 3, 4, 5, 6, 7}}},
      {S::Quad9, "quad9", shell, 9, {{0, 1, 2, 3, 4, 5, 6, 7, 8}}},
      {S::Line2, "line2", line, 2, {}},
      {S::Line3, "line3", line, 3, {}},
  };
  return types;
}

const ElementType& element_type(ElementShape shape) {
  const ElementType& type = element_types()[static_cast<std::size_t>(shape)];
  assert(type.shape == shape);
  return type;
}

}  // namespace dea

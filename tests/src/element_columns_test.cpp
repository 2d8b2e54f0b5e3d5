#include "src/model/element_columns.h"

#include <gtest/gtest.h>

namespace dea::element_columns_test {

using Column = std::vector<int>;

/// Two stacks of `rows` hexes side by side along x; node (i, j, k) of 3 x 2 x (rows + 1). Element 2 k + i.
std::vector<int> two_stacks(int rows) {
  const auto node = [](int i, int j, int k) { return i + 3 * j + 6 * k; };
  std::vector<int> nodes;
  for (int k = 0; k < rows; ++k)
    for (int i = 0; i < 2; ++i)
      for (const int up : {0, 1})
        for (const auto& [a, b] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 1)})
          nodes.push_back(node(i + a, b, k + up));
  return nodes;
}

TEST(ElementColumns, HexesFromEitherEndAndFromTheSide) {
  const std::vector<int> nodes = two_stacks(3);
  const std::vector<ElementBlock> blocks = {{ElementShape::Hex8, &nodes}};
  // the top of the first stack, its bottom, the outer side of element 2, the face between elements 0 and 1
  const ElementColumns c =
      element_columns(blocks, {0, 4, 8, 12, 16}, {18, 19, 22, 21, 0, 3, 4, 1, 6, 9, 15, 12, 1, 4, 10, 7});
  EXPECT_EQ(c.of_facet[0], (Column{4, 2, 0}));
  EXPECT_EQ(c.of_facet[1], (Column{0, 2, 4}));
  EXPECT_EQ(c.of_facet[2], (Column{2, 3}));
  EXPECT_TRUE(c.of_facet[3].empty());
  EXPECT_EQ(c.whole, (std::vector<char>{1, 1, 1, 0}));
}

// Elements of several blocks are counted one after the other, and a column goes on from one into the next.
TEST(ElementColumns, ThroughBlocks) {
  const std::vector<int> all = two_stacks(2), low(all.begin(), all.begin() + 16), high(all.begin() + 16, all.end());
  const ElementColumns c =
      element_columns({{ElementShape::Hex8, &high}, {ElementShape::Hex8, &low}}, {0, 4}, {13, 14, 17, 16});
  EXPECT_EQ(c.of_facet[0], (Column{1, 3}));
  EXPECT_TRUE(c.whole[0]);
}

TEST(ElementColumns, PentasThroughTheirTriangles) {
  const std::vector<int> nodes = {0, 1, 2, 3, 4, 5, 3, 4, 5, 6, 7, 8};
  const ElementColumns c = element_columns({{ElementShape::Penta6, &nodes}}, {0, 3, 7}, {6, 7, 8, 0, 1, 4, 3});
  EXPECT_EQ(c.of_facet[0], (Column{1, 0}));
  EXPECT_TRUE(c.whole[0]);
  EXPECT_EQ(c.of_facet[1], (Column{0}));  // a side has none across
  EXPECT_FALSE(c.whole[1]);
}

// Of a tetrahedron the one with the facet is known and nothing behind it; shells are none.
TEST(ElementColumns, TetrahedraAndShells) {
  const std::vector<int> tet = {0, 1, 2, 3}, shell = {4, 5, 6};
  const ElementColumns c =
      element_columns({{ElementShape::Tri3, &shell}, {ElementShape::Tet4, &tet}}, {0, 3, 6}, {0, 1, 3, 4, 5, 6});
  EXPECT_EQ(c.of_facet[0], (Column{1}));
  EXPECT_FALSE(c.whole[0]);
  EXPECT_TRUE(c.of_facet[1].empty());
}

// A closed ring of elements ends the search.
TEST(ElementColumns, Ring) {
  std::vector<int> nodes;
  for (int e = 0; e < 4; ++e)
    for (const int end : {e, (e + 1) % 4})
      for (int k = 0; k < 4; ++k) nodes.push_back(4 * end + k);
  const ElementColumns c = element_columns({{ElementShape::Hex8, &nodes}}, {0, 4}, {0, 1, 2, 3});
  EXPECT_TRUE(c.of_facet[0].empty());  // two elements have this face
}

}  // namespace dea::element_columns_test

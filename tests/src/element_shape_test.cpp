// The table of element shapes against itself.
#include "src/model/element_shape.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace dea::element_shape_test {

// The table is looked up by place, and its faces are faces of the element itself.
TEST(ElementTypes, RowsInOrderWithNodesOfTheirOwn) {
  std::set<std::string> names;
  for (const ElementType& type : element_types()) {
    EXPECT_EQ(&element_type(type.shape), &type) << type.name;
    EXPECT_TRUE(names.insert(type.name).second) << type.name;
    EXPECT_EQ(type.faces.empty(), type.kind == ElementKind::Line) << type.name;
    for (const std::vector<int>& face : type.faces)
      for (int node : face) EXPECT_TRUE(node >= 0 && node < type.nodes) << type.name;
    if (type.kind != ElementKind::Shell) continue;
    EXPECT_EQ(static_cast<int>(type.faces.front().size()), type.nodes) << type.name;
  }
  EXPECT_EQ(element_types().size(), static_cast<std::size_t>(ElementShape::Line3) + 1);
}

}  // namespace dea::element_shape_test

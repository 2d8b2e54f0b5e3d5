// Which nodes are out of all proportion, and which only look like it.
#include "src/model/sound_mesh.h"

#include <gtest/gtest.h>

#include <cmath>

namespace dea {

namespace {

/// The nodes that are flung.
std::vector<int> flung(const std::vector<Vector3d>& positions, const std::vector<std::vector<int>>& elements) {
  std::vector<int> begin = {0}, nodes, found;
  for (const std::vector<int>& element : elements) {
    nodes.insert(nodes.end(), element.begin(), element.end());
    begin.push_back(static_cast<int>(nodes.size()));
  }
  const NodeSpacing spacing = node_spacing(positions, begin, nodes);
  for (int i = 0; i < static_cast<int>(positions.size()); ++i)
    if (is_flung(spacing, i)) found.push_back(i);
  return found;
}

}  // namespace

// A thousand times farther away than the others lie apart, and no nearer.
TEST(SoundMesh, ACornerFlungAwayIsFound) {
  for (const double far : {2000.0, 1e9, -1e30}) {
    EXPECT_EQ(flung({{0, 0, 0}, {1, 0, 0}, {1, far, 0}, {0, 1, 0}}, {{0, 1, 2, 3}}), std::vector<int>{2}) << far;
    EXPECT_EQ(flung({{far, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}), std::vector<int>{0}) << far;
  }
  EXPECT_TRUE(flung({{0, 0, 0}, {1, 0, 0}, {1, 900, 0}, {0, 1, 0}}, {{0, 1, 2, 3}}).empty());
}

// Sizes that rise a hundredfold from one element to the next; a needle; a cone's tip; nodes at one place; a plate of
// one element.
TEST(SoundMesh, WhatIsOnlyUnevenIsSound) {
  std::vector<Vector3d> line;
  std::vector<std::vector<int>> elements;
  double x = 0.0;
  for (int i = 0; i < 8; ++i) {
    const double size = std::pow(100.0, i);
    line.insert(line.end(), {{x, 0, 0}, {x, size, 0}});
    if (i > 0) elements.push_back({2 * i - 2, 2 * i, 2 * i + 1, 2 * i - 1});
    x += size;
  }
  EXPECT_TRUE(flung(line, elements).empty());
  EXPECT_TRUE(flung({{0, 0, 0}, {1e9, 0, 0}, {1e9, 1, 0}, {0, 1, 0}}, {{0, 1, 2, 3}}).empty());
  std::vector<Vector3d> cone = {{0, 0, 10}};
  std::vector<std::vector<int>> fan;
  constexpr int kFan = 500;  // 10 sqrt(2) from the tip, 0.126 apart
  for (int i = 0; i < kFan; ++i) {
    cone.emplace_back(10 * std::cos(2 * kPi * i / kFan), 10 * std::sin(2 * kPi * i / kFan), 0);
    fan.push_back({0, 1 + i, 1 + (i + 1) % kFan});
  }
  EXPECT_TRUE(flung(cone, fan).empty());
  EXPECT_TRUE(flung({{0, 0, 0}, {0, 0, 0}, {5, 0, 0}, {5, 0, 0}}, {{0, 1, 2, 3}}).empty());
  EXPECT_TRUE(flung({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {{0, 1, 2}}).empty());
}

}  // namespace dea

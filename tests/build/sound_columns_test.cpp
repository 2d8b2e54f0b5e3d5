// Columns of prisms: when they are sound, and what gives way where they are not, against answers on paper.
#include "src/build/sound_columns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/build/build_joint.h"
#include "src/build/mend_surface.h"
#include "src/build/remesh.h"

#include "tests/build/build_shapes.h"

namespace dea::test {
namespace {

/// A column on an equilateral triangle of side 1 and height 1, its upper triangle turned about the axis and shifted.
BuiltLayer column(double turn, const Vector3d& shift) {
  BuiltLayer layer;
  layer.triangles = {{0, 1, 2}};
  for (int k = 0; k < 3; ++k) {
    const double angle = 2 * kPi * k / 3, radius = 1 / std::sqrt(3.0);
    layer.bone.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
    layer.articular.push_back(
        {radius * std::cos(angle + turn) + shift.x(), radius * std::sin(angle + turn) + shift.y(), 1 + shift.z()});
  }
  return layer;
}

TEST(SoundColumns, SoundnessIsTheCosineOfTheLines) {
  EXPECT_NEAR(column_soundness(column(0, {0, 0, 0}), {0, 1, 2}, 2), 1, 1e-12);
  EXPECT_NEAR(column_soundness(column(0, {std::sqrt(3.0), 0, 0}), {0, 1, 2}, 2), 0.5, 1e-12);  // 60 degrees
  EXPECT_EQ(column_soundness(column(0, {0, 0, -2}), {0, 1, 2}, 2), -1);                        // inside out
}

/// Turned by 180 degrees the triangle at height z is (1 - 2 z) times the lower one: its normal is (1 - 2 z)^2 times it,
/// nothing at the middle, and right at both ends, which is all that one prism's corners would see.
TEST(SoundColumns, AColumnThatIsNothingBetweenItsEndsIsNotSound) {
  EXPECT_EQ(column_soundness(column(kPi, {0, 0, 0}), {0, 1, 2}, 1), -1);
  EXPECT_GT(column_soundness(column(0.5, {0, 0, 0}), {0, 1, 2}, 1), 0.5);
}

/// Cartilage of 1 over a plane, on a grid of n x n squares of side 20 / n.
BuiltLayer plate(int n) {
  BuiltLayer layer;
  const TriangleSurface s = square(n, 10, 1, true);
  layer.articular = s.points;
  layer.triangles = s.triangles;
  for (const Vector3d& x : s.points) layer.bone.push_back({x.x(), x.y(), 0});
  return layer;
}

TEST(SoundColumns, ASoundLayerStaysToTheLastBit) {
  const BuiltLayer was = plate(9);
  BuiltLayer layer = was;
  SheetChanges changes;
  make_sound(layer, {}, changes);
  EXPECT_EQ(layer.articular, was.articular);
  EXPECT_EQ(layer.bone, was.bone);
  EXPECT_EQ(layer.triangles, was.triangles);
  EXPECT_EQ(changes.turned + changes.thinned + changes.moved, 0);
  EXPECT_EQ(changes.area_lost, 0);
  EXPECT_NEAR(changes.wanted_area, 400, 1e-9);
}

/// One line of a plate leans so far that it crosses its neighbours. The bone is a plane: its end goes back to it, so
/// the thickness is what it was, to rounding.
TEST(SoundColumns, ALineThatCrossesOthersIsTurnedAndTheThicknessStays) {
  const TriangleSurface plane = square(2, 60, 0, true);
  const RayCaster bone(mesh_of(plane));
  const auto down_to_bone = [&](const Vector3d& from, const Vector3d& direction, double) {
    return direction.z() < 0 ? -from.z() / direction.z() : kNaN;
  };
  BuiltLayer layer = plate(10);
  layer.bone[60] += Vector3d(5, 3, 0);
  SheetChanges changes;
  make_sound(layer, {2, false, &bone, 0.0, down_to_bone}, changes);
  EXPECT_GT(changes.turned, 0);
  EXPECT_EQ(changes.area_lost, 0);
  EXPECT_LT(changes.most_change, 1e-9);
  for (const auto& t : layer.triangles) EXPECT_GE(column_soundness(layer, t, 2), 0.05);
  for (const Vector3d& x : layer.bone) EXPECT_NEAR(x.z(), 0, 1e-9);
}

/// A strip at the rim is folded back over the plate: it cannot be seen along the lines. It is left out, and nothing
/// else.
TEST(SoundColumns, AFoldAtTheRimIsLeftOut) {
  const int n = 10;
  BuiltLayer layer = plate(n);
  for (std::size_t v = 0; v < layer.bone.size(); ++v)
    if (layer.articular[v].x() > 9.9) {  // the last row
      layer.articular[v] = {7.0, layer.articular[v].y(), 0.8};
      layer.bone[v] = {7.0, layer.bone[v].y(), -0.2};
    }
  const double flap = 20 * std::hypot(1.0, 0.2);  // from x = 8 at height 1 back to x = 7 at height 0.8
  SheetChanges changes;
  make_sound(layer, {2, false, nullptr, 0.0, {}}, changes);
  EXPECT_NEAR(changes.area_lost, flap, 1e-9);
  EXPECT_NEAR(area_of(layer.face()), 360, 1e-9);
  EXPECT_EQ(layer.triangles.size(), static_cast<std::size_t>(2 * n * (n - 1)));
  EXPECT_EQ(changes.change.size(), layer.bone.size());
}

BuildRequest plates(const TriangleSurface& cartilage) {
  return joint_request(bone_request("lower", square(20, 12, 0, true)), bone_request("upper", square(20, 12, 4, false)),
                       cartilage);
}

/// 2 mm of cartilage with a square dent, 4 x 4 of 20 x 20, that lies 0.5 in the bone: raised there to a tenth of the
/// mean thickness, and told as changed over the dent's part of the area (3 x 3 points lie in it, each with 1 mm^2).
TEST(SoundColumns, CartilageThatPokesThroughItsBoneIsToldByItsArea) {
  TriangleSurface s = square(20, 10, 2, true);
  for (Vector3d& x : s.points)
    if (std::max(std::abs(x.x()), std::abs(x.y())) < 1.5) x.z() = -0.5;
  BuildReport report;
  const BuiltJoint joint = build_joint(plates(s), report);
  const LayerReport& r = report.layers[0];
  for (const auto& t : joint.layers[0].triangles) EXPECT_GT(column_soundness(joint.layers[0], t, 2), 0);
  EXPECT_EQ(r.changes.area_lost, 0);
  EXPECT_EQ(r.under, 9);
  // the walls of the dent are 2.5 high and 1 wide: a point at their foot has more area than one in a plane
  const double area = area_of(s);
  EXPECT_GT(r.changes.changed_part, 9 / area);
  EXPECT_LT(r.changes.changed_part, 25 / area * 2.7);
  EXPECT_NEAR(r.changes.most_change, r.quality.least_thickness, 1e-9);
  EXPECT_TRUE(much_changed(r.changes));
}

/// Points of a sheet thrown about: no column of it is sound, and one line says so.
TEST(SoundColumns, WhatCannotBeMeshedIsRefusedInOneLine) {
  TriangleSurface s = square(20, 10, 2, true);
  std::mt19937 dice(7);
  for (std::size_t i = s.points.size() - 1; i > 0; --i) std::swap(s.points[i], s.points[dice() % (i + 1)]);
  BuildReport report;
  try {
    build_joint(plates(s), report);
    FAIL() << "built";
  } catch (const InputError& e) {
    const std::string words = e.what();
    EXPECT_NE(words.find("lower_cartilage: found no sound elements between its surface and the bone over"),
              std::string::npos)
        << words;
    EXPECT_NE(words.find("expected a surface that lies over the bone without folds"), std::string::npos) << words;
    EXPECT_EQ(words.find('\n'), std::string::npos);
  }
}

/// Every triangle has a point put in by one corner, 0.001 of the way to the others: three slivers less, or none.
TEST(SoundColumns, SliversAreMergedAndOthersStay) {
  const TriangleSurface whole = square(6, 10, 0, true);
  EXPECT_EQ(without_slivers(whole).triangles, whole.triangles);
  TriangleSurface s = whole;
  s.triangles.clear();
  for (const auto& t : whole.triangles) {
    const Vector3d &a = whole.points[at(t[0])], &b = whole.points[at(t[1])], &c = whole.points[at(t[2])];
    const int m = static_cast<int>(s.points.size());
    s.points.push_back(0.998 * a + 0.001 * (b + c));
    for (std::size_t k = 0; k < 3; ++k) s.triangles.push_back({t[k], t[(k + 1) % 3], m});
  }
  const TriangleSurface merged = without_slivers(s);
  EXPECT_EQ(merged.triangles.size(), whole.triangles.size());
  EXPECT_NEAR(area_of(merged), 400, 0.5);  // a corner on the rim may go to the point beside it, 0.005 within
}

}  // namespace
}  // namespace dea::test

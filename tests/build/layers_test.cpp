// Layers of one bone that take up the same space, and the thickness that dea build tells: against answers on paper.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "io/build/joint_feb.h"
#include "io/feb/read_feb.h"
#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/build/build_joint.h"
#include "src/build/layer_sheet.h"
#include "src/build/region.h"
#include "src/build/shared_space.h"
#include "src/run/recognise.h"

#include "tests/build/build_shapes.h"
#include "tests/program.h"

namespace dea::test {
namespace {

/// x0 to x1 and 0 to 10 in y, triangles of 1 mm, at this height.
TriangleSurface strip(double x0, double x1, double height, double y0 = 0, double y1 = 10) {
  return sheet(static_cast<int>(std::lround(x1 - x0)), static_cast<int>(std::lround(y1 - y0)),
               [=](double u, double v) { return Vector3d(x0 + u * (x1 - x0), y0 + v * (y1 - y0), height); });
}

/// Between a surface and the same at height `bottom`, moved along x.
BuiltLayer layer_of(const TriangleSurface& top, double bottom, double slip = 0) {
  BuiltLayer layer;
  layer.articular = top.points;
  layer.triangles = top.triangles;
  for (const Vector3d& x : top.points) layer.bone.push_back({x.x() + slip, x.y(), bottom});
  return layer;
}

// Sheets of 12 x 10 that overlap over 2 x 10, one thicker than the other: 20 mm^2, a sixth.
TEST(SharedSpace, IsTheAreaOverWhichFlatLayersOverlap) {
  const BuiltLayer a = layer_of(strip(-10, 2, 2), 0), b = layer_of(strip(0, 12, 1.5), 0);
  for (const SharedSpace& s : {shared_space(a, b), shared_space(b, a)}) {
    EXPECT_NEAR(s.area, 20, 1e-9);
    EXPECT_NEAR(s.share, 1.0 / 6, 1e-9);
    EXPECT_GT(s.where.x(), 0);
    EXPECT_LT(s.where.x(), 2);
  }
}

// The thinner one lies wholly in the thicker; the same twice; a small one within the columns of a large one.
TEST(SharedSpace, IsAllOfALayerThatIsThereTwice) {
  const BuiltLayer a = layer_of(strip(0, 12, 2), 0);
  EXPECT_NEAR(shared_space(a, a).share, 1, 1e-9);
  EXPECT_NEAR(shared_space(a, layer_of(strip(0, 12, 2.001), 0)).share, 1, 1e-9);
  EXPECT_NEAR(shared_space(a, layer_of(strip(0, 12, 0.2), 0)).share, 1, 1e-9);
  const SharedSpace part = shared_space(a, layer_of(strip(4, 8, 1, 3, 6), 0));
  EXPECT_NEAR(part.area, 12, 1e-9);
  EXPECT_NEAR(part.share, 1, 1e-9);
}

// Side by side, one upon the other, or with a strip of less than half an edge between their rims.
TEST(SharedSpace, IsNothingWhereLayersTouch) {
  const BuiltLayer a = layer_of(strip(-10, 0, 2), 0);
  EXPECT_EQ(shared_space(a, layer_of(strip(0, 10, 1.5), 0)).area, 0);
  EXPECT_EQ(shared_space(a, layer_of(strip(-10, 0, 4), 2)).area, 0);
  EXPECT_EQ(shared_space(a, layer_of(strip(-0.4, 9.6, 2), 0)).area, 0);
  EXPECT_NEAR(shared_space(a, layer_of(strip(-1, 9, 2), 0)).area, 10, 1e-9);  // and a strip of an edge is counted
  // both halves of the lining of a ball's socket: columns lean towards each other
  const TriangleSurface whole = dome(20, 20, 0.9, false);
  std::vector<BuiltLayer> halves;
  for (const bool right : {false, true}) {
    std::vector<char> wanted;
    for (const auto& t : whole.triangles) {
      const double x = whole.points[at(t[0])].x() + whole.points[at(t[1])].x() + whole.points[at(t[2])].x();
      wanted.push_back((x > 0) == right);
    }
    const TriangleSurface half = part_of(whole, wanted);
    BuiltLayer layer{"", 0, false, half.points, {}, half.triangles};
    const std::vector<Vector3d> normals = point_normals(half);
    for (std::size_t v = 0; v < half.points.size(); ++v) layer.bone.push_back(half.points[v] - 3 * normals[v]);
    halves.push_back(layer);
  }
  EXPECT_EQ(shared_space(halves[0], halves[1]).area, 0);
}

/// A plate with these sheets of cartilage, all in one file, under a bare plate.
BuildRequest plate_with(const TriangleSurface& sheets) {
  return joint_request(bone_request("tibia", square(40, 20, 0, true)),
                       bone_request("femur", square(40, 20, 2.2, false)), sheets);
}

TriangleSurface together(TriangleSurface a, const TriangleSurface& b) {
  a.append(b);
  return a;
}

std::string fault_of(const BuildRequest& request) {
  BuildReport report;
  try {
    build_joint(request, report);
  } catch (const InputError& e) {
    return e.what();
  }
  return "built";
}

TEST(SharedSpace, IsRefusedInOneLineThatNamesLayersShareAndPlace) {
  const std::string fault = fault_of(plate_with(together(strip(-10, 2, 2, -5, 5), strip(0, 12, 1.5, -5, 5))));
  EXPECT_NE(fault.find("tibia_cartilage_1 and tibia_cartilage_2: found 20 mm^2 of articular surface, 16.7 % of the "
                       "smaller one's, whose columns lie in the other, as at ("),
            std::string::npos)
      << fault;
  EXPECT_NE(fault.find("expected layers of one bone side by side"), std::string::npos) << fault;
  EXPECT_EQ(fault.find('\n'), std::string::npos);
  const TriangleSurface s = strip(-10, 2, 2, -5, 5);
  EXPECT_NE(fault_of(plate_with(together(s, strip(-10, 2, 1.99, -5, 5)))).find("100 % of"), std::string::npos);
  // the very same sheet twice is one sheet
  BuildReport report;
  EXPECT_EQ(build_joint(plate_with(together(s, s)), report).layers.size(), 2U);  // and the bare one
}

// 2 mm^2 of 270: told, for it is less than a hundredth. Sheets that touch: nothing is told.
TEST(SharedSpace, IsANoteWhereItIsSmall) {
  const auto notes = [](const TriangleSurface& other) {
    BuildReport report;
    build_joint(plate_with(together(strip(-18, 2, 2, -10, 5), other)), report);
    std::string all;
    for (const std::string& finding : report.findings)
      if (finding.find("columns lie in the other") != std::string::npos) all += finding + "\n";
    return all;
  };
  EXPECT_EQ(notes(strip(2, 18, 1.5, -10, 5)), "");
  EXPECT_NE(notes(strip(0, 18, 1.5, 4, 19)).find("2 mm^2 of articular surface, 0.741 % of"), std::string::npos);
}

TEST(SharedSpace, OneSurfaceIsNotTwoBones) {
  BuildRequest request;
  const TriangleSurface open = square(10, 10, 0, true);
  for (const TriangleSurface& s : {ball(8, 20), open}) {
    request.bones = {bone_request("tibia", s), bone_request("femur", s)};
    const std::string fault = fault_of(request);
    EXPECT_NE(fault.find("bones \"tibia\" and \"femur\": found "), std::string::npos) << fault;
    EXPECT_NE(fault.find("are both given the same file?"), std::string::npos) << fault;
  }
}

// Lines through a flat layer of 1 mm that lean by 60 degrees are 2 mm long. A point's normal meets the bone's side
// where that is beneath it, and elsewhere the nearest point is its edge, d away sideways: sqrt(1 + d^2).
TEST(LayerThickness, IsMeasuredAlongTheNormalNotAlongTheLines) {
  const double slip = std::sqrt(3.0);
  const BuiltLayer layer = layer_of(strip(0, 12, 1), 0, slip);
  const std::vector<double> thickness = layer_thickness(layer);
  for (std::size_t v = 0; v < thickness.size(); ++v) {
    const double beside = std::max(0.0, slip - layer.articular[v].x());
    EXPECT_NEAR(thickness[v], std::hypot(1.0, beside), 1e-9);
  }
  const SheetQuality q = sheet_quality(layer, 2);
  EXPECT_NEAR(q.least_thickness, 1, 1e-9);
  EXPECT_NEAR(q.most_thickness, 2, 1e-9);
  EXPECT_NEAR(q.mean_line, 2, 1e-9);
}

// One point of the bone rises to 0.3 below a layer of 1 mm: of four or eight triangles of 0.5 mm^2 a third is its own.
TEST(LayerThickness, TellsThePlacesThatAreThinnerThanTheLeast) {
  BuiltLayer layer = layer_of(strip(0, 10, 1), 0);
  const auto tip = static_cast<std::size_t>(
      std::find(layer.articular.begin(), layer.articular.end(), Vector3d(5, 5, 1)) - layer.articular.begin());
  ASSERT_LT(tip, layer.articular.size());
  layer.bone[tip].z() = 0.7;
  const auto around = std::count_if(layer.triangles.begin(), layer.triangles.end(), [&](const auto& t) {
    return std::find(t.begin(), t.end(), static_cast<int>(tip)) != t.end();
  });
  const ThinPlaces thin = thin_places(layer, layer_thickness(layer), 0.5);
  EXPECT_NEAR(thin.thinnest, 0.3, 1e-9);
  EXPECT_NEAR(thin.part, static_cast<double>(around) * 0.5 / 3 / 100, 1e-9);
  EXPECT_EQ(thin.where, layer.articular[tip]);
  EXPECT_EQ(thin_places(layer, layer_thickness(layer), 0.32).part, 0);  // by less than a tenth
}

// What the table tells is what dea recognises in the written model, to the digits that the file has. The bone's side of
// a lining of 2.5 mm is turned by 4 degrees about the socket's axis: lines lean, and are longer than the layer is
// thick.
TEST(LayerThickness, IsTheOneThatDeaFindsInTheModel) {
  BuildRequest request = joint_request(bone_request("socket", dome(12, 24, 0.7, false)),
                                       bone_request("ball", ball(12, 20)), dome(14, 21.5, 0.6, false));
  BuildReport report;
  BuiltJoint joint = build_joint(request, report);
  for (Vector3d& x : joint.layers[0].bone) x = Eigen::AngleAxisd(4 / kDegreesPerRadian, Vector3d::UnitZ()) * x;
  const TemporaryFolder folder;
  const std::string path = (folder.path / "joint.feb").string();
  std::ofstream(path) << joint_feb(joint, {});
  const Recognition found = recognise(read_feb(path));
  ASSERT_EQ(found.joint.contacts.size(), 1U);
  const Layer& layer = found.joint.contacts[0].layers[0];
  ASSERT_EQ(layer.articular.vertices.size(), joint.layers[0].articular.size());  // no facet is left out
  const SheetQuality q = sheet_quality(joint.layers[0], 2);
  EXPECT_NEAR(q.least_thickness, layer.min_thickness(), 1e-5);
  EXPECT_NEAR(q.mean_thickness, layer.mean_thickness(), 1e-5);
  EXPECT_NEAR(q.most_thickness, layer.max_thickness(), 1e-5);
  EXPECT_GT(q.mean_line, 1.01 * q.mean_thickness);
}

}  // namespace
}  // namespace dea::test

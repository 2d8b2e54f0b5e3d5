// Frames from landmarks, and the measures of a hip: against answers on paper, mirrored, moved, refused.
#include "src/build/anatomy.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <functional>

#include "io/build/landmarks.h"
#include "io/settings/settings_xml.h"
#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/build/mend_surface.h"

#include "tests/build/build_shapes.h"
#include "tests/program.h"

namespace dea::test {
namespace {

using Eigen::Matrix3d;

constexpr double kDegree = kPi / 180;

/// A motion of everything, or a mirror.
struct Map {
  Matrix3d turn = Matrix3d::Identity();
  Vector3d shift = Vector3d::Zero();
  Vector3d operator()(const Vector3d& x) const { return turn * x + shift; }
  bool mirrors() const { return turn.determinant() < 0; }
};

Map motion() { return {Eigen::AngleAxisd(1.1, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix(), {40, -300, 120}}; }
/// Right becomes left, in the axes of the body that made_hip has: z to the right.
Map mirror() { return {Eigen::DiagonalMatrix<double, 3>(1, 1, -1).toDenseMatrix(), {0, 0, 0}}; }

TriangleSurface mapped(const Map& map, TriangleSurface s) {
  for (Vector3d& x : s.points) x = map(x);
  return map.mirrors() ? turned_over(s) : s;
}

/// A right hip in the body's axes (x forwards, y up, z to the right): a spherical socket that ends in a plane, with a
/// fossa about its axis, and a ball.
struct MadeHip {
  double R = 26, head_radius = 23;
  double inclination = 42, anteversion = 17;  ///< radiographic [degrees]
  double rim = 82, fossa = 25;                ///< half angles at the socket's centre [degrees]
  Vector3d center = {10, -80, 85};            ///< of the socket
  Vector3d offset = Vector3d::Zero();         ///< of the ball's centre from it

  /// Out of the socket (Murray): anteversion above the coronal plane, inclination within it.
  Vector3d axis() const {
    const double i = inclination * kDegree, a = anteversion * kDegree;
    return {std::sin(a), -std::cos(i) * std::cos(a), std::sin(i) * std::cos(a)};
  }
  /// The rim's points in the plane through the ball's centre across `normal`, as angles from straight up towards
  /// `across`: the socket's points x have (x - center) . axis = -R cos(rim). The larger one.
  double edge(const Vector3d& normal, const Vector3d& across) const {
    return angle(normal, across, -R * std::cos(rim * kDegree));
  }
  double roof_end(const Vector3d& normal, const Vector3d& across) const {
    return angle(normal, across, -R * std::cos(fossa * kDegree));
  }
  /// Sphere about 0, the plane x . axis = height, the plane x . normal = offset . normal: two points.
  double angle(const Vector3d& normal, const Vector3d& across, double height) const {
    const Vector3d up = Vector3d::UnitY(), n = axis();
    // x = h normal + p, p in the section: p . n_s = height - h n . normal, |p|^2 = R^2 - h^2
    const double h = offset.dot(normal);
    const Vector3d in_section = n - n.dot(normal) * normal;
    const double m = in_section.norm(), d = (height - h * n.dot(normal)) / m;
    const Vector3d along = in_section / m, beside = normal.cross(along);
    const double b = std::sqrt(R * R - h * h - d * d);
    double most = -1e9;
    for (const double sign : {-1.0, 1.0}) {
      const Vector3d x = h * normal + d * along + sign * b * beside - offset;
      most = std::max(most, std::atan2(x.dot(across), x.dot(up)) / kDegree);
    }
    return most;
  }
  double lateral() const { return edge(Vector3d::UnitX(), Vector3d::UnitZ()); }
  double anterior() const { return edge(Vector3d::UnitZ(), Vector3d::UnitX()); }

  /// Rings about the axis, from the rim to the deepest point; within the fossa the radius is an eighth larger.
  TriangleSurface socket(int n) const {
    const Vector3d deep = -axis(), a = deep.cross(Vector3d::UnitY()).normalized(), b = deep.cross(a);
    const int outer = 3 * n, inner = n;
    const TriangleSurface s = sheet(8 * n, outer + 1 + inner, [&](double u, double v) {
      const int ring = static_cast<int>(std::lround(v * (outer + 1 + inner)));
      const bool deeper = ring > outer;
      const double azimuth = 2 * kPi * u,
                   angle = kDegree * (deeper ? fossa * (1 - 1e-4) * (1 - static_cast<double>(ring - outer - 1) / inner)
                                             : rim + (fossa - rim) * ring / outer);
      const Vector3d out = std::cos(azimuth) * a + std::sin(azimuth) * b;
      return Vector3d(center + (deeper ? 1.12 : 1.0) * R * (std::cos(angle) * deep + std::sin(angle) * out));
    });
    TriangleSurface mended = mend_surface(s).surface;
    return inwards(mended, center) ? mended : turned_over(mended);
  }
  TriangleSurface head(int n) const {
    TriangleSurface s = mend_surface(ball(n, head_radius)).surface;
    for (Vector3d& x : s.points) x += center + offset;
    return s;
  }
  static bool inwards(const TriangleSurface& s, const Vector3d& center) {
    const auto& t = s.triangles.front();
    const Vector3d &p = s.points[at(t[0])], &q = s.points[at(t[1])], &r = s.points[at(t[2])];
    return (q - p).cross(r - p).dot(center - p) > 0;
  }
  /// Spines and epicondyles, at places of no symmetry.
  std::vector<Landmark> landmarks() const {
    return {{"RASIS", {60, 0, 120}},   {"LASIS", {60, 0, -120}}, {"RPSIS", {-90, 5, 45}},
            {"LPSIS", {-90, -5, -45}}, {"RMFE", {14, -480, 60}}, {"RLFE", {10, -480, 140}}};
  }
};

std::string other_side(std::string name) {
  if (name[0] == 'R')
    name[0] = 'L';
  else if (name[0] == 'L')
    name[0] = 'R';
  return name;
}

std::vector<Landmark> mapped(const Map& map, std::vector<Landmark> landmarks) {
  for (Landmark& l : landmarks) {
    l.point = map(l.point);
    if (map.mirrors()) l.name = other_side(l.name);
  }
  return landmarks;
}

std::vector<BoneRequest> bones_of(const MadeHip& hip, int n, const Map& map = {}) {
  std::vector<BoneRequest> bones(2);
  bones[0].name = "femur";
  bones[0].surface = mapped(map, hip.head(n));
  bones[1].name = "pelvis";
  bones[1].surface = mapped(map, hip.socket(n));
  return bones;
}

AnatomyRequest request_of(const MadeHip& hip, const Map& map = {}) {
  AnatomyRequest request;
  request.landmarks = mapped(map, hip.landmarks());
  return request;
}

const AnatomicalFrame& frame_called(const Anatomy& anatomy, const std::string& name) {
  for (const AnatomicalFrame& f : anatomy.frames)
    if (f.name == name) return f;
  throw std::runtime_error("no frame " + name);
}

std::string refused(const std::function<void()>& what) {
  try {
    what();
  } catch (const InputError& e) {
    return e.what();
  } catch (const UsageError& e) {
    return e.what();
  }
  return "nothing was refused";
}

// ---- frames --------------------------------------------------------------------------------------------------------

/// Landmarks in known axes: the frame is those axes, to rounding, wherever the body lies.
TEST(Frames, AreThoseOfTheBodyWhereverItLies) {
  const MadeHip hip;
  for (const Map& map : {Map{}, motion()}) {
    FramesRequest request;
    request.landmarks = mapped(map, hip.landmarks());
    for (const Landmark& l :
         mapped(map, {{"MC", {3, -500, 55}}, {"LC", {3, -500, 125}}, {"MM", {20, -880, 60}}, {"LM", {-20, -890, 120}}}))
      request.landmarks.push_back(l);
    request.side = BodySide::Right;
    request.hip_center = map(hip.center);
    const FramesFound found = make_frames(request);
    ASSERT_EQ(found.frames.size(), 3U);
    EXPECT_LT((found.frames[0].axes - map.turn).norm(), 1e-14);
    EXPECT_LT((found.frames[0].origin - map(hip.center)).norm(), 1e-12);
    // femur: y from (12, -480, 100) to the hip's centre (10, -80, 85); z right, in their plane with the epicondyles
    const Vector3d y = Vector3d(-2, 400, -15).normalized(), across = Vector3d(-4, 0, 80);
    const Vector3d z = (across - across.dot(y) * y).normalized();
    EXPECT_LT((found.frames[1].axes.col(1) - map.turn * y).norm(), 1e-14);
    EXPECT_LT((found.frames[1].axes.col(2) - map.turn * z).norm(), 1e-14);
    // tibia: y from (0, -885, 90) to (3, -500, 90), z of the body
    const Vector3d shaft = Vector3d(3, 385, 0).normalized();
    EXPECT_LT((found.frames[2].axes.col(1) - map.turn * shaft).norm(), 1e-14);
    EXPECT_LT((found.frames[2].axes.col(2) - map.turn * Vector3d::UnitZ()).norm(), 1e-14);
    EXPECT_LT((found.frames[2].origin - map(Vector3d(3, -500, 90))).norm(), 1e-12);
    for (const AnatomicalFrame& f : found.frames) {
      EXPECT_LT((f.axes.transpose() * f.axes - Matrix3d::Identity()).norm(), 1e-14);
      EXPECT_NEAR(f.axes.determinant(), 1, 1e-14);  // right-handed
    }
  }
}

/// A left limb is the mirrored right one: x and y are mirrored, z still points to the right of the body.
TEST(Frames, OfALeftLimbAreTheMirroredOnes) {
  const MadeHip hip;
  FramesRequest request;
  request.landmarks = hip.landmarks();
  request.side = BodySide::Right;
  request.hip_center = hip.center;
  const FramesFound right = make_frames(request);
  request.landmarks = mapped(mirror(), hip.landmarks());
  request.side = BodySide::Left;
  request.hip_center = mirror()(hip.center);
  const FramesFound left = make_frames(request);
  ASSERT_EQ(left.frames.size(), 2U);
  for (std::size_t f = 0; f < 2; ++f) {
    const Matrix3d expected =
        mirror().turn * right.frames[f].axes * Eigen::DiagonalMatrix<double, 3>(1, 1, -1).toDenseMatrix();
    EXPECT_LT((left.frames[f].axes - expected).norm(), 1e-14) << left.frames[f].name;
  }
}

TEST(Frames, WhatDoesNotFitIsRefusedInALine) {
  const MadeHip hip;
  const auto with = [&](const std::function<void(FramesRequest&)>& change) {
    FramesRequest request;
    request.landmarks = hip.landmarks();
    request.side = BodySide::Right;
    request.hip_center = hip.center;
    change(request);
    return refused([&] { make_frames(request); });
  };
  EXPECT_EQ(with([](FramesRequest&) {}), "nothing was refused");
  EXPECT_EQ(
      with([](FramesRequest& r) { r.landmarks.erase(r.landmarks.begin() + 2); }),
      "landmarks of the pelvis: found RASIS, LASIS, LPSIS without RPSIS, expected all of RASIS, LASIS, RPSIS, LPSIS, "
      "or none of them");
  EXPECT_EQ(with([](FramesRequest& r) { r.landmarks.pop_back(); }),
            "landmarks of the femur: found MFE without LFE, expected all of MFE, LFE, or none of them");
  EXPECT_EQ(with([](FramesRequest& r) {
              r.landmarks.push_back({"r.asis", {0, 0, 0}});
            }),
            "landmarks: found \"r.asis\" twice, expected it once");
  EXPECT_EQ(
      with([](FramesRequest& r) { std::swap(r.landmarks[0].name, r.landmarks[1].name); }),
      "landmarks of the pelvis: found the hip's centre 80 above the front spines, expected it below them; are right "
      "and left, or front and back, exchanged?");
  EXPECT_EQ(
      with([](FramesRequest& r) {
        r.side = BodySide::Left;
        r.landmarks.resize(4);
      }),
      "landmarks of the pelvis: found the hip's centre on the right of the middle of RASIS and LASIS, expected it on "
      "the left, the joint's side; are the landmarks in the bones' axes?");
  EXPECT_EQ(
      with([](FramesRequest& r) { std::swap(r.landmarks[4].name, r.landmarks[5].name); }),
      "landmarks: found the right of the femur opposite to that of the pelvis, expected them alike; are medial and "
      "lateral, or right and left, exchanged?");
  EXPECT_EQ(with([](FramesRequest& r) { r.side.reset(); }),
            "landmarks of the femur: found MFE and LFE, expected their side too: R or L before a name, as in RMFE, or "
            "side = left|right");
  EXPECT_EQ(
      with([](FramesRequest& r) {
        r.landmarks[2].point = r.landmarks[3].point = {60, 0, 3};
      }),
      "landmarks of the pelvis: found RASIS, LASIS and the middle of RPSIS and LPSIS on one line, or at one place, "
      "expected a triangle");
}

TEST(Frames, LandmarksOfTheOtherLegAreSaid) {
  const MadeHip hip;
  const auto with = [&](const std::vector<const char*>& names, std::optional<BodySide> side) {
    FramesRequest request;
    request.side = side;
    request.hip_center = hip.center;
    for (const char* name : names)
      request.landmarks.push_back(
          {name, {14, -480, std::string(name).find("MFE") != std::string::npos ? 60.0 : 140.0}});
    return refused([&] { make_frames(request); });
  };
  EXPECT_EQ(with({"LMFE", "RLFE"}, BodySide::Left),
            "landmarks of the femur: found RLFE of the right and LMFE of the left, expected MFE, LFE of one side");
  EXPECT_EQ(with({"LMFE", "RLFE"}, {}),
            "landmarks of the femur: found RLFE of the right and LMFE of the left, expected MFE, LFE of one side");
  EXPECT_EQ(with({"RMFE", "LMFE", "RLFE", "LLFE"}, {}),
            "landmarks of the femur: found RMFE, RLFE of the right and LMFE, LLFE of the left, expected the joint's "
            "side too: side = left|right");
  EXPECT_EQ(with({"RMFE", "LMFE", "RLFE", "LLFE"}, BodySide::Right), "nothing was refused");
}

TEST(Frames, AFemurWithoutEpicondylesHasNone) {
  FramesRequest request;
  request.landmarks = MadeHip().landmarks();
  request.landmarks.resize(4);
  request.landmarks.push_back({"RASSIS", {0, 0, 0}});
  request.side = BodySide::Right;
  request.hip_center = MadeHip().center;
  const FramesFound found = make_frames(request);
  EXPECT_EQ(found.frames.size(), 1U);
  ASSERT_EQ(found.findings.size(), 2U);
  EXPECT_EQ(
      found.findings[0],
      "landmarks that no frame needs: \"RASSIS\" (did you mean \"RASIS\"?); known are RASIS, LASIS, RPSIS, LPSIS, "
      "HJC, MFE, LFE, MC, LC, MM, LM, all but the first four also with R or L before them");
  EXPECT_EQ(found.findings[1], "no frame of the femur: found no landmarks MFE and LFE, its epicondyles");
}

// ---- the hip -------------------------------------------------------------------------------------------------------

/// Spheres and rim plane are exact: all of the mesh's points lie on them. Tolerances: rounding.
TEST(Hip, SpheresAndRimPlaneOfAMadeHipAreExact) {
  MadeHip hip;
  hip.offset = {0.8, -1.1, 0.6};
  const Anatomy anatomy = find_anatomy(bones_of(hip, 6), request_of(hip));
  ASSERT_TRUE(anatomy.hip);
  const HipMeasures& m = *anatomy.hip;
  EXPECT_EQ(m.socket_bone, "pelvis");
  EXPECT_EQ(m.head_bone, "femur");
  EXPECT_EQ(m.side, BodySide::Right);
  EXPECT_NEAR(m.head.radius, hip.head_radius, 1e-8);
  EXPECT_NEAR(m.socket.radius, hip.R, 1e-8);
  EXPECT_LT((m.head.center - hip.center - hip.offset).norm(), 1e-8);
  EXPECT_LT((m.socket.center - hip.center).norm(), 1e-8);
  EXPECT_LT((m.offset - hip.offset).norm(), 1e-8);
  EXPECT_LT((m.rim_normal - hip.axis()).norm(), 1e-9);
  EXPECT_EQ(m.rim.size(), 360U);
  EXPECT_NEAR(m.inclination_radiographic, hip.inclination, 1e-7);
  EXPECT_NEAR(m.anteversion_radiographic, hip.anteversion, 1e-7);
  // Murray 1993: cos AI = cos RI cos RA, tan AA = tan RA / sin RI
  const double ri = hip.inclination * kDegree, ra = hip.anteversion * kDegree;
  EXPECT_NEAR(m.inclination_anatomic, std::acos(std::cos(ri) * std::cos(ra)) / kDegree, 1e-7);
  EXPECT_NEAR(m.anteversion_anatomic, std::atan2(std::tan(ra), std::sin(ri)) / kDegree, 1e-7);
  EXPECT_TRUE(m.missing.empty());
}

/// The angles converge with the square of the triangles' size: chords of the rim's circle. Index: the roof is a chord
/// of the socket's circle between two known angles, and its slope is minus their mean.
TEST(Hip, AnglesOfAMadeHipConvergeToTheAnswerOnPaper) {
  for (const double inclination : {38.0, 55.0}) {
    MadeHip hip;
    hip.inclination = inclination;
    const double lateral = hip.lateral(), anterior = hip.anterior(),
                 index = -(lateral + hip.roof_end(Vector3d::UnitX(), Vector3d::UnitZ())) / 2;
    std::vector<std::array<double, 3>> errors;
    for (const int n : {4, 8, 16}) {
      const Anatomy anatomy = find_anatomy(bones_of(hip, n), request_of(hip));
      ASSERT_TRUE(anatomy.hip);
      const HipMeasures& m = *anatomy.hip;
      errors.push_back(
          {m.lateral_center_edge - lateral, m.anterior_center_edge - anterior, m.acetabular_index - index});
    }
    fmt::print("inclination {}: LCE {:.4f}, ACE {:.4f}, index {:.4f}; errors of n = 4, 8, 16:\n", inclination, lateral,
               anterior, index);
    for (const auto& e : errors) fmt::print("  {:.2e} {:.2e} {:.2e}\n", e[0], e[1], e[2]);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LT(std::abs(errors[2][k]), 0.05) << k;  // degrees
      // a chord's height depends on where in the chord the plane cuts: order two as an upper bound, halved twice
      EXPECT_LT(std::abs(errors[2][k]), std::max(0.15 * std::abs(errors[0][k]), 0.01)) << k;
    }
  }
}

/// A hemisphere without anteversion: CE is what is left of 90 degrees by the inclination.
TEST(Hip, CenterEdgeOfAHemisphere) {
  MadeHip hip;
  hip.rim = 90;
  hip.anteversion = 0;
  hip.inclination = 48;
  EXPECT_NEAR(hip.lateral(), 42, 1e-12);  // the formula of these tests
  const Anatomy anatomy = find_anatomy(bones_of(hip, 8), request_of(hip));
  EXPECT_NEAR(anatomy.hip->lateral_center_edge, 42, 1e-6);  // a corner of the mesh lies there
}

/// The ball off the socket's centre: the angle is at the ball's.
TEST(Hip, AnglesAreAtTheHeadsCentre) {
  MadeHip hip;
  hip.offset = {1.5, -1, 2};
  const Anatomy anatomy = find_anatomy(bones_of(hip, 16), request_of(hip));
  ASSERT_TRUE(anatomy.hip);
  EXPECT_GT(std::abs(hip.lateral() - MadeHip().lateral()), 1);
  EXPECT_NEAR(anatomy.hip->lateral_center_edge, hip.lateral(), 0.05);
  EXPECT_NEAR(anatomy.hip->anterior_center_edge, hip.anterior(), 0.05);
}

std::vector<double> angles_of(const Anatomy& anatomy) {
  std::vector<double> angles;
  for (const HipAngle& angle : kHipAngles) angles.push_back((*anatomy.hip).*angle.value);
  return angles;
}

/// The mirrored hip is a left one of the same angles; moved, everything goes along. To rounding: equal rays meet equal
/// triangles.
TEST(Hip, MirroredAndMovedHipsHaveTheSameAngles) {
  MadeHip hip;
  hip.offset = {0.4, -0.7, 0.3};
  const Anatomy right = find_anatomy(bones_of(hip, 8), request_of(hip));
  const Anatomy left = find_anatomy(bones_of(hip, 8, mirror()), request_of(hip, mirror()));
  const Anatomy moved = find_anatomy(bones_of(hip, 8, motion()), request_of(hip, motion()));
  EXPECT_EQ(right.side, BodySide::Right);
  EXPECT_EQ(left.side, BodySide::Left);
  EXPECT_EQ(moved.side, BodySide::Right);
  const std::vector<double> angles = angles_of(right);
  for (const Anatomy* other : {&left, &moved}) {
    ASSERT_TRUE(other->hip);
    const std::vector<double> others = angles_of(*other);
    for (std::size_t k = 0; k < angles.size(); ++k) EXPECT_NEAR(others[k], angles[k], 1e-6) << kHipAngles[k].key;
    EXPECT_LT((other->hip->offset - right.hip->offset).norm(), 1e-7);
  }
  for (const char* name : {"pelvis", "femur"})
    EXPECT_LT((frame_called(moved, name).axes - motion().turn * frame_called(right, name).axes).norm(), 1e-9) << name;
  EXPECT_LT((frame_called(moved, "pelvis").origin - motion()(frame_called(right, "pelvis").origin)).norm(), 1e-7);
  EXPECT_LT((moved.hip->rim_normal - motion().turn * right.hip->rim_normal).norm(), 1e-8);
}

/// Without landmarks the scanner's axes: the side is where the socket opens to, in LPS if nobody says otherwise.
TEST(Hip, WithoutLandmarksTheScannersAxesAreTaken) {
  const MadeHip hip;
  const double lateral = find_anatomy(bones_of(hip, 8), request_of(hip)).hip->lateral_center_edge;
  for (const ScanAxes scan : {ScanAxes::LPS, ScanAxes::RAS})
    for (const bool is_left : {false, true}) {
      Map map = is_left ? mirror() : Map{};
      map.turn = body_axes(scan) * map.turn;  // the body's axes x, y, z lie along the scanner's
      AnatomyRequest request;
      if (scan == ScanAxes::RAS) request.scan_axes = scan;
      const Anatomy anatomy = find_anatomy(bones_of(hip, 8, map), request);
      ASSERT_TRUE(anatomy.hip);
      EXPECT_EQ(anatomy.side, is_left ? BodySide::Left : BodySide::Right);
      EXPECT_TRUE(anatomy.hip->axes_of_scanner);
      EXPECT_NEAR(anatomy.hip->lateral_center_edge, lateral, 1e-6);
      EXPECT_TRUE(anatomy.frames.empty());
      // the side alone says which axes they are
      AnatomyRequest by_side;
      by_side.side = is_left ? BodySide::Left : BodySide::Right;
      const Anatomy again = find_anatomy(bones_of(hip, 8, map), by_side);
      EXPECT_LT((again.hip->axes - anatomy.hip->axes).norm(), 1e-15);
      // and what contradicts itself is refused
      AnatomyRequest wrong;
      wrong.scan_axes = scan;
      wrong.side = is_left ? BodySide::Right : BodySide::Left;
      EXPECT_EQ(
          refused([&] { find_anatomy(bones_of(hip, 8, map), wrong); }),
          fmt::format("side: found {}, and in {} axes the socket opens to the {}, expected it to open to its own side",
                      name(*wrong.side), name(scan), name(*by_side.side)));
    }
}

/// A ball in a bowl that opens downwards is no hip that anybody can tell the side of.
TEST(Hip, ASocketThatOpensNotSidewaysNeedsLandmarks) {
  MadeHip hip;
  hip.inclination = 4;
  const Map map{body_axes(ScanAxes::LPS), {0, 0, 0}};
  const Anatomy anatomy = find_anatomy(bones_of(hip, 8, map), {});
  EXPECT_FALSE(anatomy.hip);
  EXPECT_FALSE(anatomy.side);
  ASSERT_EQ(anatomy.findings.size(), 1U);
  EXPECT_NE(anatomy.findings[0].find("not measured"), std::string::npos);
  EXPECT_TRUE(find_anatomy(bones_of(hip, 8, map), request_of(hip, map)).hip);
}

/// The bones, with a small triangle at each landmark.
std::vector<BoneRequest> bones_with_landmarks(const MadeHip& hip, const Map& map = {}) {
  std::vector<BoneRequest> bones = bones_of(hip, 8, map);
  TriangleSurface& pelvis = bones[1].surface;
  for (const Landmark& l : hip.landmarks()) {
    const int first = static_cast<int>(pelvis.points.size());
    for (const Vector3d& corner : {Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 0, 1)})
      pelvis.points.push_back(map(l.point + corner));
    pelvis.triangles.push_back({first, first + 1, first + 2});
  }
  return bones;
}

TEST(Hip, LandmarksOfTheOtherAxesAreRefused) {
  const MadeHip hip;
  const Map turned{body_axes(ScanAxes::LPS), {0, 0, 0}};
  AnatomyRequest request = request_of(hip, turned);
  for (Landmark& l : request.landmarks) l.point.head<2>() *= -1;
  const std::string fault = refused([&] { find_anatomy(bones_with_landmarks(hip, turned), request); });
  EXPECT_NE(fault.find("or more away from the bones, and 0 with x and y turned over, expected them in the bones' axes"),
            std::string::npos)
      << fault;
}

/// Landmarks in another unit: the factor is that between the units. Bones 485 + 1 + ... large: from the epicondyles to
/// the highest spine; landmarks 485.
TEST(Hip, LandmarksInAnotherUnitAreRefused) {
  const MadeHip hip;
  const std::vector<BoneRequest> bones = bones_with_landmarks(hip);
  const auto fault = [&](double written, double scale, std::size_t count = 6) {
    AnatomyRequest request = request_of(hip);
    request.landmarks.resize(count);
    request.landmark_scale = scale;
    for (Landmark& l : request.landmarks) {
      l.point *= written * scale;  // in mm they would be 1
      l.file = "folder/l.csv";
    }
    return refused([&] { find_anatomy(bones, request); });
  };
  EXPECT_EQ(fault(1, 1), "nothing was refused");
  EXPECT_EQ(fault(1e-3, 1000), "nothing was refused");
  const std::string metres = fault(1e-3, 1);
  EXPECT_EQ(metres.rfind("folder/l.csv: found landmarks 0.485 large ", 0), 0U) << metres;
  EXPECT_NE(
      metres.find(" away from the bones, which are 485 large, and 0 away if they are multiplied by 1000, expected "
                  "both in one unit: the landmarks look like m (landmark-units = m)"),
      std::string::npos)
      << metres;
  const auto says = [](const std::string& text, const std::string& what) { return text.find(what) != text.npos; };
  EXPECT_TRUE(says(fault(0.1, 1), "multiplied by 10, expected both in one unit: the landmarks look like cm"));
  EXPECT_TRUE(says(fault(1, 1000), "multiplied by 0.001, expected both in one unit: the landmarks look like mm"));
  EXPECT_TRUE(says(fault(1, 10), "multiplied by 0.1, expected both in one unit: the landmarks look like mm"));
  EXPECT_TRUE(says(fault(1e-3, 10), "multiplied by 100, expected both in one unit: the landmarks look like m"));
  EXPECT_TRUE(says(fault(1e-3, 1, 4), "the landmarks look like m"));  // the spines alone
  // 5000 times too large in mm, and more in cm and m: no unit
  EXPECT_TRUE(says(fault(5000, 1000), "expected both of one size, in one unit (landmark-units) and in the same axes"));
}

/// The first to be found fault with is not what is wrong: landmarks far from the bones are said too.
TEST(Hip, LandmarksFarFromTheBonesAreSaidWithWhatFails) {
  const MadeHip hip;
  AnatomyRequest request = request_of(hip);
  for (Landmark& l : request.landmarks) l.point.z() += 400;
  const std::string fault = refused([&] { find_anatomy(bones_with_landmarks(hip), request); });
  EXPECT_EQ(fault.rfind("side: found right, by the landmarks RMFE, RLFE, and the hip's centre on the left ", 0), 0U);
  EXPECT_NE(fault.find("; three quarters of the landmarks lie "), std::string::npos) << fault;
}

/// Epicondyles of the other leg are named, not the pelvis.
TEST(Hip, TheSideIsWhatAllSay) {
  const MadeHip hip;
  const Map left = mirror();
  AnatomyRequest request = request_of(hip, left);
  const auto fault = [&] { return refused([&] { find_anatomy(bones_with_landmarks(hip, left), request); }); };
  EXPECT_EQ(fault(), "nothing was refused");
  for (std::size_t i = 4; i < 6; ++i) request.landmarks[i].name = other_side(request.landmarks[i].name);
  EXPECT_EQ(
      fault(),
      "side: found right, by the landmarks RMFE, RLFE, and the hip's centre on the left of the middle of RASIS and "
      "LASIS, expected one side; either RMFE, RLFE are the other leg's, or right and left of the pelvis are "
      "exchanged");
  request = request_of(hip, left);
  request.side = BodySide::Right;
  EXPECT_EQ(fault(), "side: found right as given, and landmarks of the left, LMFE, LLFE, expected one side");
  request.landmarks.resize(4);
  EXPECT_EQ(fault(),
            "side: found right, as given, and the hip's centre on the left of the middle of RASIS and LASIS, expected "
            "one side; either the side is the other one, or right and left of the pelvis are exchanged");
}

/// No side in a name and no pelvis: the socket tells it, in the scanner's axes.
TEST(Hip, EpicondylesWithoutSideTakeThatOfTheSocket) {
  const MadeHip hip;
  for (const bool is_left : {false, true}) {
    Map map = is_left ? mirror() : Map{};
    map.turn = body_axes(ScanAxes::LPS) * map.turn;
    AnatomyRequest request;
    for (const Landmark& l : hip.landmarks())
      if (l.name[1] != 'A' && l.name[1] != 'P') request.landmarks.push_back({l.name.substr(1), map(l.point)});
    const Anatomy anatomy = find_anatomy(bones_of(hip, 8, map), request);
    EXPECT_EQ(anatomy.side, is_left ? BodySide::Left : BodySide::Right);
    // the frame of the femur is that of the test above it
    const Vector3d y = Vector3d(-2, 400, -15).normalized(), across = Vector3d(-4, 0, 80);
    const Vector3d z = (across - across.dot(y) * y).normalized();
    const double right = is_left ? -1 : 1;  // of the body: mirrored, the epicondyles' line runs the other way
    EXPECT_LT((frame_called(anatomy, "femur").axes.col(1) - map.turn * y).norm(), 1e-7);
    EXPECT_LT((frame_called(anatomy, "femur").axes.col(2) - right * map.turn * z).norm(), 1e-7);
    bool said = false;
    for (const std::string& finding : anatomy.findings)
      said =
          said || finding.find(fmt::format("side: {}, to which the socket opens", name(*anatomy.side))) != finding.npos;
    EXPECT_TRUE(said);
    // nothing tells it: refused
    request.hip = false;
    request.landmarks.push_back({"HJC", map(hip.center)});
    EXPECT_EQ(refused([&] { find_anatomy(bones_of(hip, 8, map), request); }).substr(0, 71),
              "landmarks of the femur: found MFE and LFE, expected their side too: R o");
  }
}

/// Front and back, right and left of the pelvis exchanged, that is turned half about the vertical: the socket opens
/// backwards by what it opens forwards, its edge behind is that in front, and the side is the other one.
TEST(Hip, ALeftHipTakenForARightOneIsAWarning) {
  const MadeHip hip;
  const double behind = hip.edge(Vector3d::UnitZ(), -Vector3d::UnitX());
  ASSERT_GT(behind, 91);
  const auto expected = [&](const Anatomy& anatomy, const std::string& axes) {
    EXPECT_NEAR(anatomy.hip->anterior_center_edge, behind, 0.1);
    return fmt::format(
        "hip: found a socket that opens backwards by {:.1f} degrees, an anterior center-edge angle of {:.1f} degrees, "
        "in "
        "axes {}, expected a socket that opens forwards and to its side, a neck that points inwards and up: as it is, "
        "a "
        "left hip may be taken for a right one, or a right one for a left; check side, landmarks and scan-axes, and "
        "look at the picture of hip-figure",
        hip.anteversion, anatomy.hip->anterior_center_edge, axes);
  };
  AnatomyRequest request;
  request.landmarks = {
      {"RASIS", {60, 0, 120}}, {"LASIS", {60, 0, -120}}, {"RPSIS", {-90, 0, 120}}, {"LPSIS", {-90, 0, -120}}};
  EXPECT_TRUE(find_anatomy(bones_of(hip, 8), request).warnings.empty());
  std::swap(request.landmarks[0].name, request.landmarks[3].name);
  std::swap(request.landmarks[1].name, request.landmarks[2].name);
  const Anatomy turned = find_anatomy(bones_of(hip, 8), request);
  EXPECT_EQ(turned.side, BodySide::Left);
  ASSERT_EQ(turned.warnings.size(), 1U);
  EXPECT_EQ(turned.warnings[0],
            expected(turned, "of the pelvis, by landmarks, side left (where the hip's centre lies in the pelvis)"));
  // the side alone, in the scanner's axes
  const Map map{body_axes(ScanAxes::LPS), {0, 0, 0}};
  AnatomyRequest by_side;
  by_side.side = BodySide::Right;
  EXPECT_TRUE(find_anatomy(bones_of(hip, 8, map), by_side).warnings.empty());
  by_side.side = BodySide::Left;
  const Anatomy wrong = find_anatomy(bones_of(hip, 8, map), by_side);
  ASSERT_EQ(wrong.warnings.size(), 1U);
  EXPECT_EQ(wrong.warnings[0],
            expected(wrong, "of the scanner, RAS (for the socket opens to the left then), side left (as given)"));
}

/// An edge beyond the horizontal in front, by the formula of these tests.
TEST(Hip, AnAnteriorEdgeBelowTheCentreIsAWarning) {
  MadeHip hip;
  hip.rim = 110;
  hip.anteversion = 5;
  ASSERT_GT(hip.anterior(), 91);
  const Anatomy anatomy = find_anatomy(bones_of(hip, 16), request_of(hip));
  ASSERT_EQ(anatomy.warnings.size(), 1U);
  EXPECT_NEAR(anatomy.hip->anterior_center_edge, hip.anterior(), 0.05);
  EXPECT_EQ(anatomy.warnings[0].rfind(fmt::format("hip: found an anterior center-edge angle of {:.1f} degrees, in axes",
                                                  anatomy.hip->anterior_center_edge),
                                      0),
            0U)
      << anatomy.warnings[0];
}

/// A tube of half the head's radius along a direction: its points lie evenly about it.
TriangleSurface with_neck(TriangleSurface head, const Vector3d& center, double radius, const Vector3d& direction) {
  const Vector3d a = direction.cross(Vector3d(0.3, -0.2, 0.9)).normalized(), b = direction.cross(a);
  const TriangleSurface tube = sheet(24, 12, [&](double u, double v) {
    const double azimuth = 2 * kPi * u;
    return Vector3d(center + radius * (0.75 + 1.5 * v) * direction +
                    0.5 * radius * (std::cos(azimuth) * a + std::sin(azimuth) * b));
  });
  const TriangleSurface neck = mend_surface(tube).surface;
  const int first = static_cast<int>(head.points.size());
  head.points.insert(head.points.end(), neck.points.begin(), neck.points.end());
  for (const auto& t : neck.triangles) head.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return head;
}

TEST(Hip, ANeckThatPointsOutwardsOrDownIsAWarning) {
  const MadeHip hip;
  const auto warnings = [&](const Vector3d& from_head) {
    std::vector<BoneRequest> bones = bones_of(hip, 8);
    bones[0].surface = with_neck(bones[0].surface, hip.center, hip.head_radius, from_head);
    const std::optional<Vector3d> neck = neck_direction(bones[0].surface, {hip.center, hip.head_radius, 0});
    EXPECT_LT((neck.value_or(Vector3d::Zero()) + from_head).norm(), 1e-9);  // an even ring's middle lies on its axis
    return find_anatomy(bones, request_of(hip)).warnings;
  };
  EXPECT_FALSE(neck_direction(hip.head(8), {hip.center, hip.head_radius, 0}));
  EXPECT_TRUE(warnings(Vector3d(-0.2, -0.7, 0.7).normalized()).empty());
  const std::vector<std::string> outwards = warnings(Vector3d(-0.2, -0.7, -0.7).normalized()),
                                 down = warnings(Vector3d(-0.2, 0.7, 0.7).normalized());
  ASSERT_EQ(outwards.size(), 1U);
  EXPECT_EQ(outwards[0].rfind("hip: found a neck of the femur that points away from the body's middle, a neck of the "
                              "femur that points away from the body's middle in the femur's frame, in axes",
                              0),
            0U)
      << outwards[0];
  ASSERT_EQ(down.size(), 1U);
  EXPECT_NE(down[0].find("a neck of the femur that points downwards"), std::string::npos) << down[0];
}

TEST(Hip, WhatIsNoHipIsNotMeasured) {
  std::vector<BoneRequest> plates(2);
  plates[0].name = "lower";
  plates[0].surface = mend_surface(square(9, 10, 0, true)).surface;
  plates[1].name = "upper";
  plates[1].surface = mend_surface(square(7, 10, 3, false)).surface;
  EXPECT_FALSE(find_anatomy(plates, {}).hip);
  AnatomyRequest asked;
  asked.socket = 0;
  asked.head = 1;
  EXPECT_EQ(
      refused([&] { find_anatomy(plates, asked); }),
      "hip: found no socket of \"lower\" about a ball of \"upper\", expected parts of spheres that face each other");
}

TEST(Hip, ASocketWithoutFossaHasNoIndex) {
  MadeHip hip;
  hip.fossa = 0.01;
  const Anatomy anatomy = find_anatomy(bones_of(hip, 8), request_of(hip));
  ASSERT_TRUE(anatomy.hip);
  EXPECT_TRUE(std::isnan(anatomy.hip->acetabular_index));
  ASSERT_EQ(anatomy.hip->missing.size(), 1U);
  EXPECT_EQ(
      anatomy.hip->missing[0],
      "acetabular index: found no end of the roof at a fossa in the coronal plane, expected the bone to leave the "
      "socket's sphere there");
  EXPECT_NEAR(anatomy.hip->lateral_center_edge, hip.lateral(), 0.1);
}

/// A groove round the socket's axis, an eighth deeper than the sphere: a narrow one is a dent, and the roof goes on to
/// the fossa; from a wide one on the roof has ended, at its outer edge.
TEST(Hip, TheRoofGoesOnBeyondADent) {
  const MadeHip hip;
  const int n = 16;
  const double ring = (hip.rim - hip.fossa) / (3 * n), outer = hip.fossa + 24 * ring;  // degrees from the axis
  const auto index_with = [&](int rings) {
    std::vector<BoneRequest> bones = bones_of(hip, n);
    for (Vector3d& x : bones[1].surface.points) {
      const Vector3d from = x - hip.center;
      const double angle = std::acos(-from.normalized().dot(hip.axis())) / kDegree;
      if (angle < outer + 0.5 * ring && angle > outer - (rings - 0.5) * ring) x = hip.center + 1.12 * from;
    }
    return find_anatomy(bones, request_of(hip)).hip->acetabular_index;
  };
  const double smooth = index_with(0);
  EXPECT_NEAR(index_with(1), smooth, 1e-6);
  // the end is where the groove's outer wall leaves the sphere, between two rings
  const auto index_to = [&](double angle) {
    MadeHip to = hip;
    to.fossa = angle;
    return -(hip.lateral() + to.roof_end(Vector3d::UnitX(), Vector3d::UnitZ())) / 2;
  };
  const double wide = index_with(6);
  EXPECT_LT(wide, index_to(outer) + 0.1);
  EXPECT_GT(wide, index_to(outer + ring) - 0.1);
  EXPECT_LT(wide, smooth - 10);
}

/// Forces and regions along a frame's axes.
TEST(Frames, NumbersAlongThemBecomeTheScans) {
  const MadeHip hip;
  BuildRequest request;
  request.bones = bones_of(hip, 8, motion());
  request.bones[0].force = {1, 2, 3};
  request.bones[0].force_frame = "pelvis";
  CartilageRequest c;
  c.region.emplace();
  c.region->point = {4, 5, 6};
  c.region->normal = {0, 1, 0};
  c.region->frame = "pelvis";
  request.cartilages = {c};
  const Anatomy anatomy = find_anatomy(request.bones, request_of(hip, motion()));
  leave_frames(request, anatomy);
  EXPECT_LT((request.bones[0].force - motion().turn * Vector3d(1, 2, 3)).norm(), 1e-12);
  EXPECT_LT((request.cartilages[0].region->point - motion()(hip.center + Vector3d(4, 5, 6))).norm(), 1e-7);
  EXPECT_LT((request.cartilages[0].region->normal - motion().turn * Vector3d::UnitY()).norm(), 1e-12);
  request.bones[0].force_frame = "pelvs";
  EXPECT_EQ(refused([&] { leave_frames(request, anatomy); }),
            "frame:pelvs: there is no frame of this name (did you mean \"pelvis\"?); the landmarks give \"pelvis\", "
            "\"femur\"");
}

// ---- files ---------------------------------------------------------------------------------------------------------

LandmarkFile read_as(const std::string& name, const std::string& text) {
  const TemporaryFolder folder;
  const std::string path = (folder.path / name).string();
  std::ofstream(path) << text;
  return read_landmarks(path);
}

TEST(LandmarkFiles, PlainAndSlicers) {
  const LandmarkFile plain = read_as("l.csv", "Name;x;y;z\nRASIS;1;2;3\n\"L ASIS\";-4e1;5;6.5\n");
  ASSERT_EQ(plain.landmarks.size(), 2U);
  EXPECT_EQ(plain.axes, "");
  EXPECT_EQ(plain.landmarks[1].name, "L ASIS");
  EXPECT_EQ(plain.landmarks[1].point, Vector3d(-40, 5, 6.5));
  const LandmarkFile table = read_as("t.csv",
                                     "label,r,a,s,defined,selected,visible,locked,description\n"
                                     "RASIS,1,2,3,1,1,1,0,\nLASIS,,,,0,1,1,0,\nHJC,4,5,6,1,1,1,0,by eye\n");
  ASSERT_EQ(table.landmarks.size(), 2U);
  EXPECT_EQ(table.axes, "RAS");
  EXPECT_EQ(table.landmarks[1].point, Vector3d(4, 5, 6));
  const std::string header = "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n";
  for (const auto& [word, axes] : {std::pair{"LPS", "LPS"}, std::pair{"0", "RAS"}}) {
    const LandmarkFile list =
        read_as("l.fcsv", fmt::format("# Markups fiducial file version = 4.13\n"
                                      "# CoordinateSystem = {}\n{}1,-19.9,13.9,29.4,0,0,0,1,1,1,0,"
                                      "RASIS,,\n",
                                      word, header));
    ASSERT_EQ(list.landmarks.size(), 1U);
    EXPECT_EQ(list.axes, axes);
    EXPECT_EQ(list.landmarks[0].name, "RASIS");
    EXPECT_EQ(list.landmarks[0].point, Vector3d(-19.9, 13.9, 29.4));
  }
}

/// As Slicer 5 saves a list of points, shortened.
std::string markups(const std::string& axes, const std::string& points) {
  return fmt::format(R"({{
    "@schema": "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/markups-schema-v1.0.3.json#",
    "markups": [
        {{
            "type": "Fiducial",
            "coordinateSystem": "{}",
            "coordinateUnits": "mm",
            "controlPoints": [
                {}
            ]
        }}
    ]
}}
)",
                     axes, points);
}

std::string control_point(const std::string& label, const std::string& position, const std::string& status) {
  return fmt::format(R"({{"id": "1", "label": "{}", "position": {}, "locked": true, "positionStatus": "{}"}})", label,
                     position, status);
}

TEST(LandmarkFiles, SlicersMarkups) {
  const std::string two = control_point("RASIS", "[-19.9, 13.9, 29.4]", "defined") + ",\n" +
                          control_point("HJC", "[0.0, 0.0, 0.0]", "undefined") + ",\n" +
                          control_point("LASIS", "[20, 1e1, 3]", "defined");
  for (const char* axes : {"LPS", "RAS"}) {
    const LandmarkFile file = read_as("l.mrk.json", markups(axes, two));
    ASSERT_EQ(file.landmarks.size(), 2U);
    EXPECT_EQ(file.axes, axes);
    EXPECT_EQ(file.landmarks[0].name, "RASIS");
    EXPECT_EQ(file.landmarks[0].point, Vector3d(-19.9, 13.9, 29.4));
    EXPECT_EQ(file.landmarks[1].point, Vector3d(20, 10, 3));
  }
}

TEST(LandmarkFiles, WhatCannotBeReadIsRefused) {
  const auto fault = [](const std::string& name, const std::string& text) {
    const std::string what = refused([&] { read_as(name, text); });
    return what.substr(what.find(name));
  };
  EXPECT_EQ(fault("l.csv", "name,x,y\nA,1,2\n"),
            "l.csv:1: found columns name, x, y, expected name (or label) and x, y, z (or l, p, s or r, a, s)");
  EXPECT_EQ(fault("l.csv", "name,x,y,z\nA,1,2,3\nB,1,nan,3\n"),
            "l.csv:3: y of \"B\": found \"nan\", expected a number with a decimal point");
  EXPECT_EQ(fault("l.mrk.json", "{}"),
            "l.mrk.json: found no \"markups\", expected a list of markups as Slicer saves it (.mrk.json), or CSV");
  const std::string point = control_point("A", "[1, 2, 3]", "defined");
  const std::string cut_off = markups("LPS", point).substr(0, 300);
  EXPECT_EQ(fault("l.mrk.json", cut_off), fmt::format("l.mrk.json:{}: found no JSON, expected the list of markups as "
                                                      "Slicer saves it: the file is damaged or cut off",
                                                      1 + std::count(cut_off.begin(), cut_off.end(), '\n')));
  EXPECT_EQ(fault("l.mrk.json", markups("IJK", point)),
            "l.mrk.json: coordinateSystem: found \"IJK\", expected \"LPS\" or \"RAS\"");
  for (const char* position : {"[1,2]", "[1,2,\"3\"]", "{}", "7", "null"})
    EXPECT_EQ(fault("l.mrk.json", markups("LPS", control_point("A", position, "defined"))),
              fmt::format("l.mrk.json: position of \"A\": found {}, expected three numbers in brackets", position));
  EXPECT_EQ(fault("l.mrk.json", R"({"markups": [{"coordinateSystem": "LPS", "coordinateUnits": "m"}]})"),
            "l.mrk.json: coordinateUnits: found \"m\", expected \"mm\": save the list in mm");
  EXPECT_EQ(fault("l.mrk.json", markups("LPS", control_point("A", "[1, 2, 1e999]", "defined"))),
            "l.mrk.json: found a number beyond 1e308, expected coordinates");
  EXPECT_EQ(fault("l.mrk.json", markups("LPS", control_point("A", "[0, 0, 0]", "undefined"))),
            "l.mrk.json: found no control point with a position, expected landmarks");
  EXPECT_EQ(fault("l.mrk.json", R"({"markups": [{"coordinateSystem": "LPS", "controlPoints": [)" + point +
                                    R"(]}, {"coordinateSystem": "RAS", "controlPoints": [)" + point + "]}]}"),
            "l.mrk.json: coordinateSystem: found both LPS and RAS, expected one; save the lists as two files");
}

/// What dea build writes is what dea run reads, to the last bit.
TEST(LandmarkFiles, FramesAsSettingsReadBackTheSame) {
  const MadeHip hip;
  const Anatomy anatomy = find_anatomy(bones_of(hip, 4, motion()), request_of(hip, motion()));
  const TemporaryFolder folder;
  const std::string path = (folder.path / "frames.xml").string();
  std::ofstream(path) << frames_as_settings(anatomy.frames);
  const Settings settings = read_settings_file(path).settings;
  ASSERT_EQ(settings.frames.size(), 2U);
  for (const AnatomicalFrame& f : anatomy.frames)
    EXPECT_LT((settings.frames.at(f.name) - f.axes).cwiseAbs().maxCoeff(), 1e-15);  // made orthonormal once more
}

}  // namespace
}  // namespace dea::test

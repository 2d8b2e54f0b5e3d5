// Joints made of surfaces: against answers on paper, and what is mended, relaxed, refused.
#include "src/build/build_joint.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>

#include "io/build/joint_feb.h"
#include "io/feb/read_feb.h"
#include "io/surfaces/read_surface.h"
#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/build/mend_surface.h"
#include "src/build/remesh.h"
#include "src/run/analysis.h"

#include "tests/analytic/concentric_spheres.h"
#include "tests/build/build_shapes.h"
#include "tests/program.h"

namespace dea::test {
namespace {

using Way = CartilageRequest::Way;

CartilageRequest cartilage(int on, Way way, double thickness = 0) {
  CartilageRequest c;
  c.bone = on;
  c.way = way;
  c.thickness = thickness;
  return c;
}

/// Part of a sphere about the pole +z, from the pole to `polar` [rad]; seen from outside or from the centre.
TriangleSurface cap(int n, double radius, double polar, bool outwards) {
  TriangleSurface s = sheet(4 * n, n, [&](double u, double v) {
    const double azimuth = 2 * kPi * u, angle = polar * (1 - v);
    return Vector3d(
        radius * Vector3d(std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth), std::cos(angle)));
  });
  return mend_surface(outwards ? s : turned_over(s)).surface;
}

Analysis solve_last(const BuiltJoint& joint, const BuiltModelSettings& model, const Settings& settings) {
  const TemporaryFolder folder;
  const std::string path = (folder.path / "joint.feb").string();
  std::ofstream(path) << joint_feb(joint, model);
  JointModel read = read_feb(path);
  AnalysisOptions options;
  options.times = {model_times(read).back()};
  return analyse(recognise(std::move(read), settings), options);
}

/// Where the request's second body comes to rest along z under a force of `load` along it: the first
/// body lined with 4 mm of cartilage above the plane that ends it at `polar`, law linear.
double rest_in_a_lining(BuildRequest request, double polar, double load) {
  request.bones[1].fixed = false;
  request.bones[1].force = {0, 0, load};
  request.bones[1].center = Vector3d::Zero();
  request.cartilages = {cartilage(0, Way::Uniform, 4)};
  GivenRegion above;
  above.kind = GivenRegion::Kind::Plane;
  above.point = {0, 0, 24 * std::cos(polar)};
  request.cartilages[0].region = above;
  BuildReport report;
  Settings settings;
  settings.law = Law::Linear;
  const Analysis analysis = solve_last(build_joint(request, report), {}, settings);
  const Equilibrium& end = analysis.states.back().equilibrium;
  EXPECT_TRUE(solved(end.outcome)) << end.message;
  for (std::size_t b = 0; b < analysis.joint.bodies.size(); ++b)
    if (analysis.joint.bodies[b].name == request.bones[1].name) return end.poses[b].center.z();
  ADD_FAILURE() << "no body " << request.bones[1].name;
  return kNaN;
}

TEST(Build, HalfOfAPlaneParallelGapIsExact) {
  BuildRequest request;
  request.bones = {bone_request("lower", square(9, 10, 0, true)), bone_request("upper", square(7, 10, 3, false))};
  for (int b : {0, 1}) {
    request.cartilages.push_back(cartilage(b, Way::HalfGap));
    request.cartilages.back().most = 4;
  }
  request.fade = 0;
  BuildReport report;
  const BuiltJoint joint = build_joint(request, report);
  ASSERT_EQ(joint.layers.size(), 2U);
  for (const BuiltLayer& layer : joint.layers) {
    for (const Vector3d& x : layer.articular) EXPECT_NEAR(x.z(), 1.5, 1e-12);  // rounding alone
    EXPECT_NEAR(area_of(layer.face()), 400, 1e-9);
  }
  EXPECT_NEAR(report.contacts.at(0).least_gap, 0, 1e-12);
}

/// Plates 0.6 apart, half the gap no less than 0.5: each of two layers of 0.5 gives way by half of 0.4, to 0.3, which
/// is told. 1.2 apart both are 0.6, and nothing is.
TEST(Build, HalfAGapThinnerThanItsLeastIsTold) {
  for (const double gap : {0.6, 1.2}) {
    BuildRequest request;
    request.bones = {bone_request("lower", square(9, 10, 0, true)), bone_request("upper", square(7, 10, gap, false))};
    for (int b : {0, 1}) request.cartilages.push_back(cartilage(b, Way::HalfGap));
    request.fade = 0;
    BuildReport report;
    const BuiltJoint joint = build_joint(request, report);
    ASSERT_EQ(joint.layers.size(), 2U);
    const bool thin = gap < 1;
    for (std::size_t l = 0; l < 2; ++l) {
      const BuiltLayer& layer = joint.layers[l];
      for (std::size_t v = 0; v < layer.articular.size(); ++v)
        EXPECT_NEAR((layer.articular[v] - layer.bone[v]).norm(), gap / 2, 1e-12);  // rounding alone
      EXPECT_EQ(report.layers[l].below_least, thin ? static_cast<int>(layer.articular.size()) : 0);
      const std::string told = fmt::format(
          "{}: {} of {} points thinner than the least thickness that was asked for, 0.5: 0.3 at the least, at (",
          layer.name, layer.articular.size(), layer.articular.size());
      EXPECT_EQ(std::count_if(report.findings.begin(), report.findings.end(),
                              [&](const std::string& f) { return f.rfind(told, 0) == 0; }),
                thin ? 1 : 0);
    }
  }
}

/// A rigid ball in a socket lined with uniform cartilage that ends at 60 degrees, law linear: on paper the force is the
/// integral of the pressure over the cap. The error of the motion falls with the square of the triangles' size.
TEST(Build, BallInALinedSocketConvergesToTheAnswerOnPaper) {
  const double polar = kPi / 3, load = 2000;
  const analytic::ConcentricSpheres paper = analytic::one_layer_socket();
  const auto force = [&](double u) {
    return 2 * kPi * 400 *
           analytic::simpson([&](double t) { return paper.pressure(t, u) * std::cos(t) * std::sin(t); }, 0, polar);
  };
  const double exact = analytic::bisect(force, load, 0, 5);
  std::vector<double> errors;
  for (const int n : {8, 16, 32}) {
    BuildRequest request;
    request.bones = {bone_request("socket", cap(n, 24, 1.25 * polar, false)), bone_request("ball", ball(n, 20))};
    errors.push_back(rest_in_a_lining(request, polar, load) / exact - 1);
    RecordProperty(fmt::format("error_{}", n), fmt::format("{:.2e}", errors.back()));
  }
  fmt::print("motion of the ball, relative error: {:.2e} {:.2e} {:.2e}\n", errors[0], errors[1], errors[2]);
  EXPECT_LT(std::abs(errors[2]), 0.01);
  EXPECT_GT(std::log2(errors[0] / errors[2]) / 2, 1.7);
}

/// The same of a roller in a lined trough, 20 mm long, up to 60 degrees to both sides: open surfaces.
TEST(Build, RollerInALinedTroughConvergesToTheAnswerOnPaper) {
  const double polar = kPi / 3, load = 2000, length = 20;
  const analytic::ConcentricSpheres paper = analytic::one_layer_socket();  // the overlap at an angle is that of circles
  const auto force = [&](double u) {
    return 2 * length * 20 * analytic::simpson([&](double t) { return paper.pressure(t, u) * std::cos(t); }, 0, polar);
  };
  const double exact = analytic::bisect(force, load, 0, 5);
  const auto tube = [](int n, double radius, double from, double to, double half, bool outwards) {
    return sheet(2 * n, n, [=](double u, double v) {
      const double angle = outwards ? to + u * (from - to) : from + u * (to - from);
      return Vector3d(radius * std::sin(angle), half * (2 * v - 1) * (outwards ? -1 : 1) * -1,
                      radius * std::cos(angle));
    });
  };
  std::vector<double> errors;
  for (const int n : {8, 16, 32}) {
    BuildRequest request;
    request.bones = {bone_request("trough", tube(n, 24, -1.25 * polar, 1.25 * polar, length / 2, false)),
                     bone_request("roller", tube(2 * n, 20, -2.5, 2.5, length, true))};
    errors.push_back(rest_in_a_lining(request, polar, load) / exact - 1);
  }
  fmt::print("motion of the roller, relative error: {:.2e} {:.2e} {:.2e}\n", errors[0], errors[1], errors[2]);
  EXPECT_LT(std::abs(errors[2]), 0.01);
  EXPECT_LT(std::abs(errors[2]), 0.5 * std::abs(errors[0]));
}

TEST(Build, SegmentedCartilageKeepsItsTriangles) {
  const TriangleSurface outer = cap(16, 22, 1.0, true);
  BuildRequest request;
  request.bones = {bone_request("ball", ball(24, 20)), bone_request("socket", cap(16, 24, 1.0, false))};
  request.cartilages = {cartilage(0, Way::Segmented)};
  request.cartilages[0].outer = turned_over(outer);  // looks into the bone: turned back
  BuildReport report;
  const BuiltJoint joint = build_joint(request, report);
  ASSERT_EQ(joint.layers[0].triangles.size(), outer.triangles.size());
  EXPECT_NEAR(area_of(joint.layers[0].face()), area_of(outer), 1e-9);
  // facets of the ball lie below it by h^2 / 8R, h = 20 * (pi/2) / 24 * sqrt(2)
  for (std::size_t v = 0; v < outer.points.size(); ++v) {
    EXPECT_NEAR(joint.layers[0].articular[v].norm(), 22, 1e-9);
    EXPECT_NEAR(joint.layers[0].bone[v].norm(), 20, 0.03);
  }
  EXPECT_EQ(report.layers[0].missed, 0);
  EXPECT_TRUE(joint.layers[1].bare);
}

/// Volume inside, by the divergence theorem.
double volume_of(const TriangleSurface& s) {
  double volume = 0;
  for (const auto& t : s.triangles) volume += area_vector(s, t).dot(s.points[at(t[0])] - s.points[0]) / 3;
  return volume;
}

/// Binary STL, which is single precision.
void write_stl(const std::string& path, const TriangleSurface& s) {
  std::ofstream file(path, std::ios::binary);
  const auto count = static_cast<std::uint32_t>(s.triangles.size());
  file << std::string(80, ' ') << std::string_view(reinterpret_cast<const char*>(&count), 4);
  for (const auto& t : s.triangles) {
    file << std::string(12, '\0');
    for (const int p : t) {
      const Eigen::Vector3f x = s.points[at(p)].cast<float>();
      file << std::string_view(reinterpret_cast<const char*>(x.data()), 12);
    }
    file << std::string(2, '\0');
  }
}

/// Triangles of a domain of shells or of a surface, by way of an STL file.
TriangleSurface through_stl(const fs::path& file, const JointModel& model, const std::vector<int>& nodes,
                            const std::vector<int>& begin) {
  TriangleSurface s;
  s.points = model.nodes;
  for (std::size_t f = 0; f + 1 < begin.size(); ++f)
    for (int k = begin[f] + 2; k < begin[f + 1]; ++k)
      s.triangles.push_back({nodes[at(begin[f])], nodes[at(k - 1)], nodes[at(k)]});
  write_stl(file.string(), s);
  return mend_surface(read_surface(file.string())).surface;
}

/// The hip of samples, its bones and articular surfaces written as STL and built again: the same pressures.
TEST(Build, AJointTakenApartAndBuiltAgainHasItsPressures) {
  const JointModel model = read_feb(std::string(DEA_SAMPLES_DIR) + "/hip/hip_walking.feb");
  const TemporaryFolder folder;
  const auto shells = [&](const std::string& name) {
    const auto d =
        std::find_if(model.domains.begin(), model.domains.end(), [&](const Domain& x) { return x.name == name; });
    std::vector<int> begin;
    for (std::size_t i = 0; i <= d->nodes.size(); i += 4) begin.push_back(static_cast<int>(i));
    return through_stl(folder.path / "bone.stl", model, d->nodes, begin);
  };
  const auto face = [&](const std::string& name) {
    const auto f =
        std::find_if(model.surfaces.begin(), model.surfaces.end(), [&](const Surface& x) { return x.name == name; });
    return through_stl(folder.path / "face.stl", model, f->nodes, f->begin);
  };
  BuildRequest request;
  request.bones = {bone_request("pelvis", shells("pelvis")), bone_request("femur", shells("femur"))};
  request.bones[1].fixed = false;
  request.bones[1].force = {432, -262, 1834};
  request.bones[1].center = Vector3d::Zero();
  request.cartilages = {cartilage(0, Way::Segmented), cartilage(1, Way::Segmented)};
  request.cartilages[0].outer = face("acetabular_articulating");
  request.cartilages[1].outer = face("femoral_articulating");
  BuildReport report;
  const BuiltJoint joint = build_joint(request, report);
  AnalysisOptions options;
  options.times = {model_times(model).back()};
  const Headline was = analyse(recognise(model), options).states.back().statistics.at(0).headline;
  const Headline is = solve_last(joint, {}, {}).states.back().statistics.at(0).headline;
  for (const HeadlineNumber& number : kHeadlineNumbers) {
    fmt::print("{}: {:+.2f} %\n", number.name, 100 * (is.*number.value / (was.*number.value) - 1));
    EXPECT_NEAR(is.*number.value, was.*number.value, 0.02 * (was.*number.value)) << number.name;
  }
}

/// The closed surface of a cartilage: its far side is taken.
TEST(Build, OfAClosedCartilageTheSideAwayFromTheBoneIsTaken) {
  TriangleSurface closed = cap(12, 22, 1.0, true);
  const TriangleSurface inner = cap(12, 20.05, 1.0, false);
  const double area = area_of(closed);
  const int first = static_cast<int>(closed.points.size());
  // the wall between the rims, point by point: both caps are made alike
  const auto neighbours = edge_neighbours(closed.triangles);
  const std::size_t count = closed.triangles.size();
  const auto beneath = [&](int p) {
    int nearest = 0;
    for (std::size_t i = 0; i < inner.points.size(); ++i)
      if ((inner.points[i].normalized() - closed.points[at(p)].normalized()).norm() <
          (inner.points[at(nearest)].normalized() - closed.points[at(p)].normalized()).norm())
        nearest = static_cast<int>(i);
    return first + nearest;
  };
  for (std::size_t t = 0; t < count; ++t)
    for (std::size_t k = 0; k < 3; ++k)
      if (neighbours[t][k] < 0) {
        const int a = closed.triangles[t][k], b = closed.triangles[t][(k + 1) % 3];
        closed.triangles.push_back({b, a, beneath(a)});
        closed.triangles.push_back({b, beneath(a), beneath(b)});
      }
  closed.points.insert(closed.points.end(), inner.points.begin(), inner.points.end());
  for (const auto& t : inner.triangles) closed.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  const MendedSurface mended = mend_surface(closed);
  ASSERT_TRUE(mended.closed());
  BuildRequest request;
  request.bones = {bone_request("ball", ball(24, 20)), bone_request("socket", cap(16, 24, 1.0, false))};
  request.cartilages = {cartilage(0, Way::Segmented)};
  request.cartilages[0].outer = mended.surface;
  BuildReport report;
  const BuiltJoint joint = build_joint(request, report);
  EXPECT_NEAR(area_of(joint.layers[0].face()), area, 1e-6 * area);
}

TEST(Build, TwoPlateausAreTwoLayersAndTwoContacts) {
  TriangleSurface lower = square(8, 8, 0, true), upper = square(20, 30, 3, false);
  for (Vector3d& x : lower.points) x.x() -= 12;
  const TriangleSurface one = lower;
  const int first = static_cast<int>(lower.points.size());
  for (Vector3d x : one.points) lower.points.push_back(x + Vector3d(24, 0, 0));
  for (const auto& t : one.triangles) lower.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  BuildRequest request;
  request.bones = {bone_request("femur", upper), bone_request("tibia", lower)};
  request.cartilages = {cartilage(0, Way::Uniform, 1), cartilage(1, Way::Uniform, 1.5)};
  BuildReport report;
  const BuiltJoint joint = build_joint(request, report);
  ASSERT_EQ(joint.contacts.size(), 2U);
  for (const BuiltContact& c : joint.contacts)
    EXPECT_LE(report.layers[at(c.primary)].quality.area, report.layers[at(c.secondary)].quality.area);
}

TEST(Build, InAGrooveNoElementIsInsideOut) {
  // a valley with a radius of 1 under 2.5 mm of cartilage: along the normals the layer would pass through itself
  const TriangleSurface valley = sheet(40, 10, [](double u, double v) {
    const double x = 20 * u - 10;
    return Vector3d(x, 10 * v - 5, std::sqrt(1 + x * x) - 1);
  });
  BuildRequest request;
  request.bones = {bone_request("valley", valley), bone_request("roller", square(10, 8, 12, false))};
  request.cartilages = {cartilage(0, Way::Uniform, 2.5)};
  request.reach = 14;
  BuildReport report;
  const BuiltJoint joint = build_joint(request, report);
  EXPECT_EQ(report.layers[0].quality.inside_out, 0);
  EXPECT_GT(report.layers[0].quality.least_jacobian, 0);
  EXPECT_GT(report.layers[0].changes.turned, 0);
}

TEST(Build, CartilageMadeHereDoesNotOverlap) {
  BuildRequest request;
  request.bones = {bone_request("lower", square(9, 10, 0, true)), bone_request("upper", square(7, 10, 3, false))};
  request.cartilages = {cartilage(0, Way::Uniform, 2), cartilage(1, Way::Uniform, 2)};
  BuildReport report;
  const BuiltJoint joint = build_joint(request, report);
  EXPECT_GT(report.contacts.at(0).least_gap, -1e-3);
  EXPECT_NEAR(report.layers[0].quality.mean_thickness, 1.5, 0.01);  // half of what is there
}

TEST(Build, AFilledRegionHasNoHoleAndAKeptOneHas) {
  // a pit of radius 3 in the lower plane, too deep to be within reach
  const TriangleSurface pit = sheet(40, 40, [](double u, double v) {
    const Vector3d x(20 * u - 10, 20 * v - 10, 0);
    return Vector3d(x - Vector3d(0, 0, x.norm() < 3 ? 12 : 0));
  });
  for (const bool fill : {true, false}) {
    BuildRequest request;
    request.bones = {bone_request("lower", pit), bone_request("upper", square(20, 10, 3, false))};
    request.cartilages = {cartilage(1, Way::Uniform, 1)};
    request.fill_holes = fill;
    request.reach = 5;
    request.rim_length = 1;
    BuildReport report;
    const BuiltJoint joint = build_joint(request, report);
    for (std::size_t l = 0; l < joint.layers.size(); ++l)
      if (!joint.layers[l].bare) {
        EXPECT_EQ(mend_surface(joint.layers[l].face()).faults.holes, fill ? 1U : 2U);  // the rim is one
      }
  }
}

TEST(Mend, FlippedDoubleDegenerateAndLooseTrianglesAreMended) {
  TriangleSurface s = ball(6, 20);
  const double volume = volume_of(mend_surface(s).surface);
  EXPECT_GT(volume, 0);
  const std::size_t triangles = s.triangles.size();
  for (std::size_t t = 0; t < triangles; t += 10) std::swap(s.triangles[t][0], s.triangles[t][1]);
  s.triangles.push_back(s.triangles[3]);
  s.triangles.push_back({0, 0, 1});
  const int p = static_cast<int>(s.points.size());
  s.points.insert(s.points.end(), {Vector3d(40, 0, 0), Vector3d(41, 0, 0), Vector3d(40, 1, 0)});
  s.triangles.push_back({p, p + 1, p + 2});
  const MendedSurface mended = mend_surface(turned_over(s));
  EXPECT_EQ(mended.faults.duplicate, 1U);
  EXPECT_EQ(mended.faults.degenerate, 1U);
  EXPECT_EQ(mended.faults.islands, 1U);
  EXPECT_EQ(mended.faults.flipped, (triangles + 9) / 10);
  EXPECT_TRUE(mended.faults.turned_inside_out);
  EXPECT_TRUE(mended.closed());
  EXPECT_EQ(mended.surface.triangles.size(), triangles);
  EXPECT_NEAR(volume_of(mended.surface), volume, 1e-9 * volume);
}

TEST(Mend, AFinAndAHoleAreNamed) {
  TriangleSurface s = mend_surface(ball(6, 20)).surface;
  s.triangles.erase(s.triangles.begin());
  s.points.push_back({0, 0, 60});
  const auto t = s.triangles[50];
  s.triangles.push_back({t[0], t[1], static_cast<int>(s.points.size()) - 1});
  const MendedSurface mended = mend_surface(s);
  EXPECT_EQ(mended.faults.non_manifold, 1U);
  EXPECT_FALSE(mended.closed());
  EXPECT_GE(mended.faults.holes, 2U);
}

TEST(Mend, AMoebiusStripHasNoOutside) {
  const MendedSurface mended = mend_surface(sheet(40, 3, [](double u, double v) {
    const double a = 2 * kPi * u, w = 3 * (v - 0.5);
    return Vector3d((10 + w * std::cos(a / 2)) * std::cos(a), (10 + w * std::cos(a / 2)) * std::sin(a),
                    w * std::sin(a / 2));
  }));
  EXPECT_TRUE(mended.faults.not_orientable);
}

TEST(Remesh, ASphereKeepsItsAreaAndGetsTheEdge) {
  const TriangleSurface s = cap(24, 20, 1.0, true), r = remeshed(s, 1.5);
  EXPECT_NEAR(mean_edge(r), 1.5, 0.25);
  EXPECT_NEAR(area_of(r), area_of(s), 0.01 * area_of(s));
  const TriangleSurface whole = mend_surface(ball(24, 20)).surface, d = decimated(whole, 1000);
  EXPECT_NEAR(static_cast<double>(d.triangles.size()), 1000, 10);
  EXPECT_NEAR(volume_of(d), volume_of(whole), 0.01 * volume_of(whole));
}

// ---------------------------------------------------------------------------------------------------------------------
// The program

Finished dea_build(const fs::path& folder, const std::string& words) {
  std::vector<std::string> all = {DEA_PROGRAM, "build"};
  std::istringstream in(words);
  for (std::string word; in >> word;) all.push_back(word);
  return run_program(folder, all, 60);
}

void write_shapes(const fs::path& folder) {
  write_stl((folder / "socket.stl").string(), cap(16, 24, 1.2, false));
  write_stl((folder / "ball.stl").string(), ball(16, 20));
}

TEST(BuildProgram, WhatItBuildsIsSolvedByRun) {
  const TemporaryFolder folder;
  write_shapes(folder.path);
  const Finished built = dea_build(folder.path,
                                   "--bone socket=socket.stl --bone ball=ball.stl --half-gap max=3,min=0.5 --force "
                                   "ball=0,0,500 -o j.feb --json j.json");
  ASSERT_EQ(built.code, 0) << built.err;
  EXPECT_NE(built.err.find("units: mm"), std::string::npos) << built.err;
  EXPECT_NE(built.err.find("ball: centre"), std::string::npos) << built.err;
  EXPECT_NE(file_text(folder.path / "j.json").find("\"schema\": \"dea.build/1\""), std::string::npos);
  const Finished solved = run_program(folder.path, {DEA_PROGRAM, "run", "j.feb", "-q"}, 60);
  EXPECT_EQ(solved.code, 0) << solved.err;
  const std::string first = file_text(folder.path / "j.feb");
  ASSERT_EQ(
      dea_build(
          folder.path,
          "--bone socket=socket.stl --bone ball=ball.stl --half-gap max=3,min=0.5 --force ball=0,0,500 -o j.feb -q")
          .code,
      0);
  EXPECT_EQ(first, file_text(folder.path / "j.feb"));
}

/// A right hip in LPS, the pelvis upright: x forwards is -y, y up is z, z to the right is -x.
void write_landmarks(const fs::path& folder) {
  std::ofstream(folder / "l.csv") << "name,x,y,z\nRASIS,-35,-60,80\nLASIS,205,-60,80\nRPSIS,40,90,82\nLPSIS,130,90,78\n"
                                     "RMFE,45,5,-400\nRLFE,-35,0,-402\n";
}

/// The force along the pelvis' axes is that in the scanner's, frames go to dea run, and the picture is there.
TEST(BuildProgram, FramesGoFromLandmarksToRun) {
  const TemporaryFolder folder;
  write_shapes(folder.path);
  write_landmarks(folder.path);
  const std::string bones = "--bone socket=socket.stl --bone ball=ball.stl --half-gap max=3,min=0.5 ";
  const Finished framed = dea_build(
      folder.path, bones +
                       "--landmarks l.csv --force ball=frame:pelvis,-10,500,-100 --frames f.xml --hip-figure h.svg "
                       "--json j.json -o framed.feb");
  ASSERT_EQ(framed.code, 0) << framed.err;
  EXPECT_NE(framed.err.find("hip: \"socket\" is the socket, \"ball\" the head"), std::string::npos) << framed.err;
  EXPECT_NE(framed.out.find("lateral center-edge angle"), std::string::npos) << framed.out;
  // the middle of the back spines is as high as the front ones: the axes are those of the scanner
  const Finished plain = dea_build(folder.path, bones + "--force ball=100,10,500 -o plain.feb -q");
  ASSERT_EQ(plain.code, 0) << plain.err;
  const auto force_lines = [&](const char* file) {
    std::string lines;
    std::istringstream in(file_text(folder.path / file));
    for (std::string line; std::getline(in, line);)
      if (line.find("force") != std::string::npos || line.find("<value") != std::string::npos) lines += line + "\n";
    return lines;
  };
  EXPECT_EQ(force_lines("framed.feb"), force_lines("plain.feb"));
  EXPECT_NE(file_text(folder.path / "j.json").find("\"side\": \"right\""), std::string::npos);
  EXPECT_EQ(file_text(folder.path / "h.svg").substr(0, 5), "<?xml");
  const auto peak = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {DEA_PROGRAM, "run", "framed.feb", "--no-xplt", "--csv", "-", "--states", "last"};
    words.insert(words.end(), more.begin(), more.end());
    const Finished solved = run_program(folder.path, words, 60);
    EXPECT_EQ(solved.code, 0) << solved.err;
    return solved;
  };
  const Finished along = peak({"--settings", "f.xml", "--rotate", "socket=frame:pelvis,x,4"}),
                 global = peak({"--rotate", "socket=0,-1,0,4"});
  EXPECT_EQ(along.out, global.out);
  EXPECT_NE(
      along.err.find("frame \"pelvis\" in the model's axes: x (0.0000, -1.0000, 0.0000), y (0.0000, 0.0000, 1.0000), "
                     "z (-1.0000, 0.0000, 0.0000)"),
      std::string::npos)
      << along.err;
  const Finished unknown =
      run_program(folder.path, {DEA_PROGRAM, "run", "framed.feb", "--rotate", "socket=frame:pelvis,x,4"}, 60);
  EXPECT_EQ(unknown.code, 2);
  EXPECT_NE(unknown.err.find("there is no frame \"pelvis\""), std::string::npos) << unknown.err;
}

TEST(BuildProgram, BadInputIsOneLine) {
  const TemporaryFolder folder;
  write_shapes(folder.path);
  const auto scaled = [&](const char* name, TriangleSurface s, double factor, const Vector3d& shift) {
    for (Vector3d& x : s.points) x = factor * x + shift;
    write_stl((folder.path / name).string(), s);
  };
  scaled("ball_m.stl", ball(16, 20), 0.001, Vector3d::Zero());
  scaled("socket_m.stl", cap(16, 24, 1.2, false), 0.001, Vector3d::Zero());
  scaled("ball_far.stl", ball(16, 20), 1, {0, 0, -1000});
  scaled("ball_in.stl", ball(16, 23), 1, {0, 0, -20});
  write_stl((folder.path / "one.stl").string(), {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}});
  std::ofstream(folder.path / "text.stl") << "not a surface\n";
  std::ofstream(folder.path / "empty.stl");
  write_landmarks(folder.path);
  const std::string rest = " --uniform socket=3 --force ball=0,0,500 -o j.feb",
                    both = "--bone socket=socket.stl --bone ball=ball.stl" + rest;
  const std::tuple<std::string, int, const char*> cases[] = {
      {"--bone socket=socket.stl --bone ball=empty.stl" + rest, 3, "empty.stl: found an empty file"},
      {"--bone socket=socket.stl --bone ball=text.stl" + rest, 3, "text.stl: found no surface that is known"},
      {"--bone socket=socket.stl --bone ball=one.stl" + rest, 3, "one.stl: found 1 triangle with area"},
      {"--bone socket=socket_m.stl --bone ball=ball_m.stl" + rest, 3,
       "these look like m; --units m says what they are"},
      {"--bone socket=socket.stl --bone ball=ball_far.stl" + rest, 3, "are the bones in one frame and unit?"},
      {"--bone socket=ball_in.stl --bone ball=ball.stl" + rest, 3, "interpenetrate"},
      {"--bone socket=socket.stl --bone ball=ball.stl --uniform socket=3 -o j.feb", 2, "no force is given"},
      {"--bone socket=socket.stl --bone ball=ball.stl --force ball=0,0,1 -o j.feb", 2, "no cartilage is given"},
      {"--bone socket=socket.stl --bone ball=ball.stl --uniform sock=3 --force ball=0,0,1 -o j.feb", 2,
       "did you mean \"socket\"?"},
      {"--bone socket=socket.stl --bone ball=ball.stl --uniform socket=-3 --force ball=0,0,1 -o j.feb", 2,
       "expected a number above 0"},
      {"--bone socket=socket.stl --bone ball=ball.stl --half-gap max=1,min=2 --force ball=0,0,1 -o j.feb", 2,
       "expected max=A,min=B with A above B"},
      {"--bone socket=socket.stl --bone ball=ball.stl" + rest + " --reach 0.1", 3, "expected one within 0.1"},
      {"--bone socket=socket.stl --bone ball=ball.stl --uniform socket=3 --force ball=0,0,500 -o no/j.feb", 4, "no"},
      {both + " --landmarks none.csv", 3, "none.csv: found no readable file"},
      {both + " --landmarks l.csv --side left", 3,
       "side: found left as given, and landmarks of the right, RMFE, RLFE, expected one side"},
      {both + " --side up", 2, "--side up: found \"up\", expected left or right"},
      {both + " --scan-axes XYZ", 2, "--scan-axes XYZ: found \"XYZ\", expected LPS or RAS"},
      {both + " --frames f.xml", 2, "--frames f.xml: found no landmarks to make frames of"},
      {both + " --flip-landmarks", 2, "--flip-landmarks: found no landmarks"},
      {both + " --hip ball", 2, "--hip ball: found \"ball\", expected two bones, SOCKET,HEAD, or none"},
      {both + " --hip socket,bal", 2, "did you mean \"ball\"?"},
      {both + " --hip ball,socket", 3, "hip: found no socket of \"ball\" about a ball of \"socket\""},
      {both + " --hip none --hip-figure h.svg", 2, "--hip-figure and --hip none: found both"},
      {both + " --hip-figure h.gif", 2, "--hip-figure h.gif: found \".gif\", expected a name that ends in"},
      {both + " --hip-figure h.svg", 3, "--hip-figure h.svg: found nothing measured of a hip"},
      {both + " --region socket=plane:frame:pelvis,0,0,0,0,1,0", 2,
       "frame:pelvis: there is no frame of this name; the landmarks give none"},
      {both + " --region socket=sphere:frame:pelvis,0,0,0", 2, "sphere:x,y,z,r or sphere:frame:NAME,x,y,z,r"},
  };
  for (const auto& [words, code, expected] : cases) {
    const Finished f = dea_build(folder.path, words + " -q");
    EXPECT_EQ(f.code, code) << words << "\n" << f.err;
    EXPECT_NE(f.err.find(expected), std::string::npos) << words << "\n" << f.err;
    EXPECT_EQ(std::count(f.err.begin(), f.err.end(), '\n'), 1) << f.err;
    EXPECT_FALSE(fs::exists(folder.path / "j.feb")) << words;
  }
}

}  // namespace
}  // namespace dea::test

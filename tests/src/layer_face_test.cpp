// Which facets of a selection slide, and what is beyond their rim: blocks whose answers are counted by hand.
#include "src/joint/layer_face.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "io/settings/settings_xml.h"
#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/joint/joint.h"
#include "src/model/element_faces.h"
#include "tests/src/test_models.h"

namespace dea::layer_face_test {

using namespace test;

/// A face that one element alone has.
struct OuterFace {
  std::vector<int> nodes;
  Vector3d center, normal;
};
using Which = std::function<bool(const OuterFace&)>;

std::vector<OuterFace> outer_faces(const JointModel& model, const Domain& d) {
  std::map<std::vector<int>, std::vector<std::vector<int>>> faces;  // sorted corners -> nodes
  const auto n = d.nodes.size() / d.element_ids.size();
  for (std::size_t e = 0; e < d.element_ids.size(); ++e)
    for (const auto& face : element_faces(d.shape)) {
      std::vector<int> nodes;
      for (int k : face) nodes.push_back(d.nodes[e * n + at(k)]);
      std::vector<int> corners(nodes.begin(), nodes.begin() + facet_corners(static_cast<int>(nodes.size())));
      std::sort(corners.begin(), corners.end());
      faces[corners].push_back(nodes);
    }
  std::vector<OuterFace> outer;
  for (const auto& entry : faces) {
    if (entry.second.size() != 1) continue;
    OuterFace f = {entry.second[0], Vector3d::Zero(), Vector3d::Zero()};
    const auto corners = entry.first.size();
    for (std::size_t k = 0; k < corners; ++k) {
      f.center += model.nodes[at(f.nodes[k])] / static_cast<double>(corners);
      const Vector3d &a = model.nodes[at(f.nodes[0])], &b = model.nodes[at(f.nodes[k])],
                     &c = model.nodes[at(f.nodes[(k + 1) % corners])];
      f.normal += (b - a).cross(c - a);
    }
    f.normal.normalize();
    outer.push_back(f);
  }
  return outer;
}

/// A layer of elements on rigid shells, domains 0 and 1.
struct Block {
  JointModel model = empty_model();
  int cartilage = -1, base = -1, plate = -1;
  Settings settings;

  Block(int nu, int nv, int elements, const Patch& bone, const Patch& articular) {
    cartilage = add_material(model, "cartilage", false);
    base = add_material(model, "base", true);
    plate = add_material(model, "plate", true);
    add_layer(model, "grid", nu, nv, elements, bone, articular, cartilage, base);
    model.surfaces.clear();
  }
  Block(const Block&) = delete;
  Block& operator=(const Block&) = delete;

  void select(const Which& which) {
    Surface s;
    s.name = "layer";
    for (const OuterFace& f : outer_faces(model, model.domains[0])) {
      if (!which(f)) continue;
      s.nodes.insert(s.nodes.end(), f.nodes.begin(), f.nodes.end());
      s.begin.push_back(static_cast<int>(s.nodes.size()));
    }
    model.surfaces = {s};
  }

  /// What is recognised, under a rigid plate far above.
  Layer recognise() {
    JointModel with_plate = model;
    const int top = add_rigid_surface(
        with_plate, "plate", 1, 1, [](double u, double v) { return Vector3d(100 * (v - 0.5), 100 * (u - 0.5), 50); },
        plate);
    add_contact(with_plate, "press", 0, top);
    for (int m : {base, plate}) fix(with_plate, m, {true, true, true, true, true, true});
    return make_joint(with_plate, settings).contacts[0].layers[0];
  }

  void remove_elements(const std::function<bool(const Vector3d&)>& which) {
    Domain& d = model.domains[0];
    Domain kept = d;
    kept.nodes.clear();
    kept.element_ids.clear();
    for (std::size_t e = 0; e < d.element_ids.size(); ++e) {
      Vector3d center = Vector3d::Zero();
      for (std::size_t k = 0; k < 8; ++k) center += model.nodes[at(d.nodes[8 * e + k])] / 8.0;
      if (which(center)) continue;
      kept.nodes.insert(kept.nodes.end(), d.nodes.begin() + static_cast<std::ptrdiff_t>(8 * e),
                        d.nodes.begin() + static_cast<std::ptrdiff_t>(8 * e + 8));
      kept.element_ids.push_back(static_cast<int>(kept.element_ids.size()) + 1);
    }
    d = kept;
  }

  /// Nodes at one place become one.
  void merge() {
    for (Domain& d : model.domains)
      for (int& node : d.nodes)
        for (int other = 0; other < node; ++other)
          if ((model.nodes[at(other)] - model.nodes[at(node)]).norm() < 1e-9) node = other;
  }

  /// Hex8 into six tet4 around a diagonal: the same way everywhere, so faces match.
  void make_tets() {
    Domain& d = model.domains[0];
    Domain tets = d;
    tets.shape = ElementShape::Tet4;
    tets.nodes.clear();
    tets.element_ids.clear();
    const int ring[] = {1, 2, 3, 7, 4, 5, 1};
    for (std::size_t e = 0; e < d.element_ids.size(); ++e)
      for (int k = 0; k < 6; ++k) {
        for (int corner : {0, ring[k], ring[k + 1], 6}) tets.nodes.push_back(d.nodes[8 * e + at(corner)]);
        tets.element_ids.push_back(static_cast<int>(tets.element_ids.size()) + 1);
      }
    d = tets;
  }

  /// Hex8 into hex20, quad4 into quad8.
  void make_quadratic() {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto found = middles.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<int>(model.nodes.size()));
      if (found.second) {
        model.nodes.push_back(0.5 * (model.nodes[at(a)] + model.nodes[at(b)]));
        model.node_ids.push_back(static_cast<int>(model.nodes.size()));
      }
      return found.first->second;
    };
    const std::vector<std::pair<int, int>> hex = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                                                  {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}},
                                           quad = {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
    for (Domain& d : model.domains) {
      const bool solid = d.shape == ElementShape::Hex8;
      const std::size_t corners = solid ? 8 : 4;
      std::vector<int> nodes;
      for (std::size_t e = 0; e < d.element_ids.size(); ++e) {
        for (std::size_t k = 0; k < corners; ++k) nodes.push_back(d.nodes[corners * e + k]);
        for (const auto& edge : solid ? hex : quad)
          nodes.push_back(middle(d.nodes[corners * e + at(edge.first)], d.nodes[corners * e + at(edge.second)]));
      }
      d.nodes = nodes;
      d.shape = solid ? ElementShape::Hex20 : ElementShape::Quad8;
    }
  }
};

Patch flat(double size, double z) {
  return [=](double u, double v) { return Vector3d(size * (u - 0.5), size * (v - 0.5), z); };
}

/// A square slab, top at z = 0.
struct Slab : Block {
  Slab(int n, double size, double thickness, int elements = 1)
      : Block(n, n, elements, flat(size, -thickness), flat(size, 0)) {}
};

bool top(const OuterFace& f) { return f.normal.z() > 0.99; }
bool side(const OuterFace& f) { return std::abs(f.normal.z()) < 0.01; }
bool everything(const OuterFace&) { return true; }

long count(const Layer& layer, FaceKind kind) {
  return std::count(layer.facet_kinds.begin(), layer.facet_kinds.end(), kind);
}

double area(const SurfaceMesh& mesh, int from = 0) {
  double sum = 0;
  for (int t = from; t < mesh.size(); ++t) sum += mesh.areas[at(t)];
  return sum;
}

double length_of(const LayerFace& face, Rim rim) {
  double sum = 0;
  for (const LayerFace::Edge& e : face.edges)
    if (e.rim == rim)
      sum += (face.mesh.corner(e.triangle, e.edge) - face.mesh.corner(e.triangle, (e.edge + 1) % 3)).norm();
  return sum;
}

void expect_rim(const Layer& layer, double free, double goes_on, double symmetry, double bonded, double beyond) {
  const RimLengths rim = rim_lengths(layer.face);
  EXPECT_NEAR(rim.free, free, 1e-9);
  EXPECT_NEAR(rim.goes_on, goes_on, 1e-9);
  EXPECT_NEAR(rim.symmetry, symmetry, 1e-9);
  EXPECT_NEAR(rim.bonded, bonded, 1e-9);
  EXPECT_NEAR(rim.area_beyond, beyond, 1e-9);
}

/// What holds of every face: it begins with the selection, its edges are those of one triangle alone, and a thickness
/// stands at every vertex.
void expect_sound(const Layer& layer) {
  const LayerFace& face = layer.face;
  ASSERT_EQ(face.pressed, layer.articular.size());
  ASSERT_EQ(face.thickness.size(), face.mesh.vertices.size());
  for (int t = 0; t < face.pressed; ++t) EXPECT_EQ(face.mesh.triangles[at(t)], layer.articular.triangles[at(t)]);
  for (std::size_t v = 0; v < layer.articular.vertices.size(); ++v)
    EXPECT_EQ(face.mesh.model_nodes[v], layer.articular.model_nodes[v]);
  std::size_t alone = 0;
  for (const auto& neighbours : face.mesh.neighbours)
    alone += at(static_cast<int>(std::count(neighbours.begin(), neighbours.end(), -1)));
  EXPECT_EQ(face.edges.size(), alone);
}

TEST(LayerFace, WholeFaceIsFreeAllRound) {
  for (const int elements : {1, 3}) {
    Slab slab(8, 8, 2, elements);
    slab.select(top);
    const Layer layer = slab.recognise();
    EXPECT_TRUE(layer.facet_kinds.empty());
    expect_sound(layer);
    expect_rim(layer, 32, 0, 0, 0, 0);
  }
}

// What nobody selected inside the face is cartilage all the same: no edge there is free.
TEST(LayerFace, ForgottenFacetsBelongToTheFace) {
  Slab slab(8, 8, 2);
  slab.select([](const OuterFace& f) { return top(f) && (f.center - Vector3d(0.5, 0.5, 0)).norm() > 0.1; });
  Layer layer = slab.recognise();
  expect_sound(layer);
  expect_rim(layer, 32, 4, 0, 0, 1);
  EXPECT_NEAR(length_of(layer.face, Rim::Free), 32, 1e-9);
  for (double t : layer.face.thickness) EXPECT_NEAR(t, 2, 1e-12);
  // L: three facets in a row and two beside the last
  slab.select([](const OuterFace& f) {
    const bool row = std::abs(f.center.y() - 0.5) < 0.1 && std::abs(f.center.x() - 0.5) < 1.1,
               foot = std::abs(f.center.x() - 1.5) < 0.1 && f.center.y() > 0.4 && f.center.y() < 2.6;
    return top(f) && !row && !foot;
  });
  layer = slab.recognise();
  expect_rim(layer, 32, 12, 0, 0, 5);
  // at the rim: an edge of the missing one is free, for there the layer ends, but it is not the selection's
  slab.select([](const OuterFace& f) { return top(f) && (f.center - Vector3d(3.5, 0.5, 0)).norm() > 0.1; });
  layer = slab.recognise();
  expect_rim(layer, 31, 3, 0, 0, 1);
  EXPECT_NEAR(length_of(layer.face, Rim::Free), 32, 1e-9);
}

TEST(LayerFace, CutOutGoesOn) {
  Slab near(10, 10, 1);  // all within reach
  near.select([](const OuterFace& f) { return top(f) && f.center.lpNorm<Eigen::Infinity>() < 3; });
  Layer layer = near.recognise();
  expect_sound(layer);
  expect_rim(layer, 0, 24, 0, 0, 64);
  EXPECT_NEAR(length_of(layer.face, Rim::Free), 40, 1e-9);

  Slab large(40, 40, 1);
  large.select([](const OuterFace& f) { return top(f) && f.center.lpNorm<Eigen::Infinity>() < 3; });
  layer = large.recognise();
  expect_sound(layer);
  const RimLengths rim = rim_lengths(layer.face);
  EXPECT_NEAR(rim.goes_on, 24, 1e-9);
  EXPECT_EQ(rim.free, 0.0);
  EXPECT_EQ(length_of(layer.face, Rim::Free), 0.0);
  EXPECT_GT(length_of(layer.face, Rim::Continues), 24);
  // beside the sides five rows, for their centres are within 5 thicknesses; at most that much at the corners
  EXPECT_GE(rim.area_beyond, 4 * 6 * 5);
  EXPECT_LE(rim.area_beyond, 16 * 16 - 6 * 6);
}

TEST(LayerFace, HoleInTheLayerIsFree) {
  Slab slab(8, 8, 1);
  slab.remove_elements([](const Vector3d& x) { return x.head<2>().lpNorm<Eigen::Infinity>() < 1; });
  slab.select(top);
  Layer layer = slab.recognise();
  expect_rim(layer, 32 + 8, 0, 0, 0, 0);
  slab.select([](const OuterFace& f) { return top(f) || side(f); });  // with the walls of hole and rim
  layer = slab.recognise();
  EXPECT_EQ(count(layer, FaceKind::SideWall), 32 + 8);
  expect_rim(layer, 32 + 8, 0, 0, 0, 0);
}

TEST(LayerFace, SideWallsAreLeftOut) {
  for (const int elements : {1, 2, 3}) {
    Slab slab(8, 8, 1, elements);
    slab.select([](const OuterFace& f) { return top(f) || side(f); });
    Layer layer = slab.recognise();
    ASSERT_EQ(layer.facet_kinds.size(), at(64 + 32 * elements));
    EXPECT_EQ(count(layer, FaceKind::SideWall), 32 * elements);
    EXPECT_EQ(count(layer, FaceKind::Open), 64);
    EXPECT_NEAR(area(layer.articular), 64, 1e-9);
    expect_sound(layer);
    expect_rim(layer, 32, 0, 0, 0, 0);
    EXPECT_EQ(layer.missed_count(), 0);
    EXPECT_NEAR(layer.min_thickness(), 1, 1e-12);

    // some of them; of those two high the upper ones, which do not reach the bone themselves
    slab.select([](const OuterFace& f) { return top(f) || (side(f) && f.center.x() > 3.9 && f.center.y() > 0); });
    layer = slab.recognise();
    EXPECT_EQ(count(layer, FaceKind::SideWall), 4 * elements);
    expect_rim(layer, 32, 0, 0, 0, 0);
    slab.select([&](const OuterFace& f) { return top(f) || (side(f) && f.center.z() > -0.5 - 1e-9); });
    layer = slab.recognise();
    EXPECT_EQ(count(layer, FaceKind::SideWall), 32 * ((elements + 1) / 2));
    EXPECT_NEAR(area(layer.articular), 64, 1e-9);
  }
}

TEST(LayerFace, SideWallsWithoutABoneOfFaces) {
  Slab slab(8, 8, 1);
  slab.settings.thickness["layer"] = 1.0;
  // held by every second node both ways, which is no face of an element
  Domain& shells = slab.model.domains[1];
  shells.nodes.clear();
  shells.element_ids.clear();
  for (int j = 0; j < 8; j += 2)
    for (int i = 0; i < 8; i += 2) {
      const int first = 9 * j + i;
      shells.nodes.insert(shells.nodes.end(), {first, first + 18, first + 20, first + 2});
      shells.element_ids.push_back(static_cast<int>(shells.element_ids.size()) + 1);
    }
  slab.select([](const OuterFace& f) { return top(f) || side(f); });
  const Layer layer = slab.recognise();
  EXPECT_EQ(count(layer, FaceKind::SideWall), 32);
  expect_rim(layer, 32, 0, 0, 0, 0);
}

TEST(LayerFace, ClosedSelections) {
  Slab thin(8, 8, 1);
  thin.select(everything);
  const Layer layer = thin.recognise();
  EXPECT_EQ(count(layer, FaceKind::SideWall), 32);
  EXPECT_EQ(count(layer, FaceKind::Bonded), 64);
  EXPECT_NEAR(area(layer.articular), 64, 1e-9);
  expect_rim(layer, 32, 0, 0, 0, 0);

  thin.settings.keep_facets = {"layer"};
  const Layer kept = thin.recognise();
  EXPECT_TRUE(kept.facet_kinds.empty());
  EXPECT_NEAR(area(kept.articular), 64 + 32 + 64, 1e-9);

  Slab wall_only(8, 8, 1);  // no articular facet at all
  wall_only.select(side);
  try {
    wall_only.recognise();
    ADD_FAILURE() << "taken as a face";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("all its facets (32) turn away"), std::string::npos) << e.what();
    EXPECT_NE(line(e.fault, command_line_wording()).find("or give --thickness \"layer=VALUE\""), std::string::npos)
        << e.what();
  }
  wall_only.settings.thickness["layer"] = 1.0;  // they are meant
  EXPECT_TRUE(wall_only.recognise().facet_kinds.empty());

  Slab thick(8, 8, 4);  // as much wall as anything: what the face is, is a guess
  thick.select(everything);
  try {
    thick.recognise();
    ADD_FAILURE() << "taken as a face";
  } catch (const InputError& e) {
    EXPECT_NE(line(e.fault, command_line_wording()).find("--keep-facets \"layer\""), std::string::npos) << e.what();
    // 8 x 8 open against 4 sides of 8 x 4, all as large
    EXPECT_NE(
        std::string(e.what()).find("leaves 64 facets, of less area (64) than the side wall (128): too little to tell"),
        std::string::npos)
        << e.what();
  }
}

// Rounded over the last r = 1 of 2 by four facets of 22.5 degrees, a wall of 1 below. What looks away by more than 60
// degrees goes with the wall; the rest is articular, selected or not.
TEST(LayerFace, RoundedRim) {
  const double r = 1, half = 5;
  const int flat_part = 8, arcs = 4, n = flat_part + 2 * arcs;
  const auto across = [=](double u) -> Eigen::Vector2d {  // place along x, height
    const int i = static_cast<int>(std::lround(u * n));
    if (i >= arcs && i <= n - arcs) return {(half - r) * (2.0 * (i - arcs) / flat_part - 1), 0};
    const int k = i < arcs ? arcs - i : i - (n - arcs);
    const double angle = kPi / 2 * k / arcs, x = half - r + r * std::sin(angle);
    return {i < arcs ? -x : x, r * (std::cos(angle) - 1)};
  };
  // the wall stands under the end of the rounding
  Block block(
      n, 10, 2, [&](double u, double v) { return Vector3d(across(u).x(), 10 * (v - 0.5), -2); },
      [&](double u, double v) { return Vector3d(across(u).x(), 10 * (v - 0.5), across(u).y()); });
  block.select([](const OuterFace& f) { return f.normal.z() > 0.01 || std::abs(f.normal.x()) > 0.99; });
  Layer layer = block.recognise();
  EXPECT_EQ(count(layer, FaceKind::Bonded), 0);
  EXPECT_EQ(layer.missed_count(), 0);
  // left out: both walls (two elements high) and the last arc, of 78.75 degrees
  EXPECT_EQ(count(layer, FaceKind::SideWall), 2 * 10 * (2 + 1));
  const double arc = 2 * std::sin(kPi / 16);  // chord
  EXPECT_NEAR(area(layer.articular), 10 * (8 + 2 * 3 * arc), 1e-9);
  expect_sound(layer);

  block.select([](const OuterFace& f) { return f.normal.z() > 0.99; });
  layer = block.recognise();
  EXPECT_TRUE(layer.facet_kinds.empty());
  expect_rim(layer, 16, 20, 0, 0, 10 * 2 * 3 * arc);
  EXPECT_NEAR(length_of(layer.face, Rim::Free), 2 * (8 + 2 * 3 * arc) + 20, 1e-9);
}

// A riser of 0.5 amid the face, hardly inclined: both its edges are known as those of a step, no others.
TEST(LayerFace, StepsAreKnown) {
  for (const double rise : {0.0, 0.01, 0.5}) {
    const int n = 9;
    const auto place = [](double u) {  // columns of 1, the fifth of 0.002
      const double column = u * 9;
      return column <= 4 ? column : column >= 5 ? column - 0.998 : 4 + 0.002 * (column - 4);
    };
    Block block(
        n, 6, 2, [&](double u, double v) { return Vector3d(place(u), 6 * v, -2); },
        [&](double u, double v) { return Vector3d(place(u), 6 * v, u * 9 > 4.5 ? rise : 0); });
    block.select([](const OuterFace& f) { return f.normal.z() > 0.5; });
    const Layer layer = block.recognise();
    double length = 0, highest = 0;
    for (const LayerFace::Edge& e : layer.face.edges)
      if (e.step > 0) {
        length +=
            (layer.face.mesh.corner(e.triangle, e.edge) - layer.face.mesh.corner(e.triangle, (e.edge + 1) % 3)).norm();
        highest = std::max(highest, e.step);
      }
    EXPECT_NEAR(length, rise > 0 ? 2 * 6 : 0, 1e-9) << rise;
    EXPECT_NEAR(highest, rise > 0 ? std::hypot(rise, 0.002) : 0, 1e-9);
    EXPECT_EQ(layer.face.bevelled, 0.0);
  }
}

// The outermost facets fall away on two sides: told from 20 to 40 degrees, and taken for a wall of this slope from 40
// on.
TEST(LayerFace, BevelsAreKnown) {
  for (const double degrees : {10.0, 19.0, 21.0, 39.0, 41.0, 64.0, 66.0, 80.0}) {
    const double drop = std::tan(degrees * kPi / 180) * 0.2;
    const auto place = [](int i) { return i == 0 ? -0.2 : i == 9 ? 7.2 : i - 1.0; };
    Block block(
        9, 6, 2, [&](double u, double v) { return Vector3d(place(static_cast<int>(std::lround(9 * u))), 6 * v, -2); },
        [&](double u, double v) {
          const int i = static_cast<int>(std::lround(9 * u));
          return Vector3d(place(i), 6 * v, i == 0 || i == 9 ? -drop : 0);
        });
    block.select([](const OuterFace& f) { return f.normal.z() > 0.9999; });
    const Layer layer = block.recognise();
    EXPECT_NEAR(layer.face.bevelled, degrees > 20 && degrees < 40 ? 12 : 0, 1e-9) << degrees;
    int walls = 0;
    for (const LayerFace::Edge& e : layer.face.edges) {
      const bool at_end = std::abs(layer.face.mesh.normals[at(e.triangle)].z() - 1) < 1e-9 &&
                          std::abs(std::abs(outward_at(layer.face.mesh, e.triangle, e.edge).x()) - 1) < 1e-9;
      if (!at_end) continue;
      ++walls;
      EXPECT_NEAR(e.wall, degrees * kPi / 180, 1e-6) << degrees;
    }
    EXPECT_EQ(walls, degrees > 40 ? 12 : 0) << degrees;
  }
}

// Cartilage that runs out to the bone, gently or at 38 degrees: its facets look at bone through the layer, so none is a
// wall although they reach down to the bone.
TEST(LayerFace, ThinWedgeIsNoWall) {
  for (const double run : {8.0, 2.56})
    for (const bool both_ends : {false, true}) {
      const double size = 16, thickness = 2;
      const int n = 25;  // facets of 0.64
      Block block(n, 4, 1, flat(size, -thickness), [&](double u, double v) {
        const double from_end = size * (both_ends ? std::min(u, 1 - u) : u);
        return Vector3d(size * (u - 0.5), size * (v - 0.5), -thickness + thickness * std::min(1.0, from_end / run));
      });
      block.merge();
      const auto articular = [](const OuterFace& f) { return f.normal.z() > 0.5; };
      block.select(articular);
      const Layer layer = block.recognise();
      EXPECT_EQ(block.model.surfaces[0].size(), n * 4);
      EXPECT_TRUE(layer.facet_kinds.empty()) << "run " << run;
      expect_sound(layer);
      const RimLengths rim = rim_lengths(layer.face);
      EXPECT_EQ(rim.area_beyond + rim.goes_on, 0.0);
      EXPECT_GT(rim.free, 2 * size);
    }
}

// A dome that runs out on all sides: the facets at its corners have three held nodes of four.
TEST(LayerFace, FeatheredDome) {
  Block block(12, 12, 1, flat(12, 0), [](double u, double v) {
    const double h = 2 * std::min(1.0, 6 * std::min({u, 1 - u, v, 1 - v}));
    return Vector3d(12 * (u - 0.5), 12 * (v - 0.5), h);
  });
  block.merge();
  block.select([](const OuterFace& f) { return f.normal.z() > 0.3; });
  const Layer layer = block.recognise();
  EXPECT_TRUE(layer.facet_kinds.empty());
  EXPECT_EQ(layer.missed_count(), 0);
  EXPECT_EQ(block.model.surfaces[0].size(), 144);
}

TEST(LayerFace, PlanesOfSymmetry) {
  Slab slab(8, 8, 1);
  for (int dof : {0, 1}) {
    FixedNodes fixed;
    fixed.xyz = {dof == 0, dof == 1, false};
    for (int i = 0; i < static_cast<int>(slab.model.nodes.size()); ++i)
      if (std::abs(slab.model.nodes[at(i)][dof] + 4) < 1e-9 && slab.model.nodes[at(i)].z() > -0.5)
        fixed.nodes.push_back(i);
    slab.model.fixed_nodes.push_back(fixed);
  }
  slab.select(top);
  Layer layer = slab.recognise();
  expect_rim(layer, 16, 0, 16, 0, 0);
  // the walls in the planes selected, too
  slab.select([](const OuterFace& f) { return top(f) || side(f); });
  layer = slab.recognise();
  EXPECT_EQ(count(layer, FaceKind::SideWall), 32);
  expect_rim(layer, 16, 0, 16, 0, 0);
  // selected away from one plane: the face goes on to it
  slab.select([](const OuterFace& f) { return top(f) && f.center.x() > -2; });
  layer = slab.recognise();
  expect_rim(layer, 8 + 6, 8, 6, 0, 16);
  EXPECT_NEAR(length_of(layer.face, Rim::Wall), 16, 1e-9);
}

// Bone that comes up into the face, at its level: the layer ends there, bonded.
TEST(LayerFace, BondedPartOfTheFace) {
  Slab slab(8, 8, 1);
  Domain cap = slab.model.domains[1];
  cap.name = "cap";
  cap.nodes.clear();
  cap.element_ids.clear();
  slab.select([](const OuterFace& f) { return top(f) && f.center.x() > 2; });  // 2 x 8
  cap.nodes = slab.model.surfaces[0].nodes;
  for (int e = 1; e <= 16; ++e) cap.element_ids.push_back(e);
  slab.model.domains.push_back(cap);
  slab.select([](const OuterFace& f) { return top(f) && f.center.x() < 2; });
  const Layer layer = slab.recognise();
  EXPECT_TRUE(layer.facet_kinds.empty());
  expect_rim(layer, 8 + 12, 0, 0, 8, 0);
}

TEST(LayerFace, OtherElements) {
  for (const bool tets : {false, true}) {
    Slab slab(8, 8, 1, 2);
    if (tets)
      slab.make_tets();
    else
      slab.make_quadratic();
    const int per_square = tets ? 2 : 1;
    slab.select(top);
    Layer layer = slab.recognise();
    EXPECT_TRUE(layer.facet_kinds.empty());
    expect_sound(layer);
    expect_rim(layer, 32, 0, 0, 0, 0);
    slab.select([](const OuterFace& f) { return top(f) || side(f); });
    layer = slab.recognise();
    EXPECT_EQ(count(layer, FaceKind::SideWall), 64 * per_square);
    expect_rim(layer, 32, 0, 0, 0, 0);
    slab.select([](const OuterFace& f) {
      return top(f) && (f.center - Vector3d(0.5, 0.5, 0)).lpNorm<Eigen::Infinity>() > 0.4;
    });
    layer = slab.recognise();
    expect_sound(layer);
    expect_rim(layer, 32, 4, 0, 0, 1);
    EXPECT_NEAR(length_of(layer.face, Rim::Free), 32, 1e-9);
    slab.select([](const OuterFace& f) { return top(f) && f.center.x() < 2; });
    layer = slab.recognise();
    expect_rim(layer, 8 + 12, 8, 0, 0, 16);
  }
}

TEST(LayerFace, BallAndSocketLoseNothing) {
  for (const int n : {6, 12}) {
    const JointModel model = concentric_spheres(n, 100, true);
    const Joint joint = make_joint(model, {});
    for (const Layer& layer : joint.contacts[0].layers) {
      EXPECT_TRUE(layer.facet_kinds.empty());
      const RimLengths rim = rim_lengths(layer.face);
      const double equator = 2 * kPi * 22;  // both faces; a polygon of 4 n sides
      EXPECT_NEAR(rim.free, equator, equator * kPi * kPi / (6 * 16 * n * n) * 1.01);
      EXPECT_EQ(rim.goes_on + rim.symmetry + rim.bonded + rim.area_beyond, 0.0);
    }
  }
}

// The answer does not depend on the facets' order, nor on where the model lies.
TEST(LayerFace, OrderAndPlaceDoNotMatter) {
  Slab slab(8, 8, 1, 2);
  const auto which = [](const OuterFace& f) {
    return (top(f) && (f.center - Vector3d(0.5, 0.5, 0)).norm() > 0.1) || (side(f) && f.center.x() > 3);
  };
  slab.select(which);
  const Layer before = slab.recognise();
  Surface& s = slab.model.surfaces[0];
  Surface reversed = s;
  reversed.nodes.clear();
  for (int f = s.size() - 1; f >= 0; --f)
    reversed.nodes.insert(reversed.nodes.end(), s.nodes.begin() + 4 * f, s.nodes.begin() + 4 * f + 4);
  s = reversed;
  const Eigen::Matrix3d turn =
      (Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()) * Eigen::AngleAxisd(1.1, Vector3d::UnitY()))
          .toRotationMatrix();
  for (Vector3d& x : slab.model.nodes) x = turn * x + Vector3d(100, -20, 3);
  const Layer after = slab.recognise();
  ASSERT_EQ(after.facet_kinds.size(), before.facet_kinds.size());
  EXPECT_TRUE(std::equal(after.facet_kinds.begin(), after.facet_kinds.end(), before.facet_kinds.rbegin()));
  const RimLengths rim = rim_lengths(before.face);
  expect_rim(after, rim.free, rim.goes_on, rim.symmetry, rim.bonded, rim.area_beyond);
  EXPECT_EQ(count(before, FaceKind::SideWall), 20);
}

// The diagonal of a rectangle is the one at its lowest node, also where rounding of its coordinates makes the other
// shorter by a millionth; a diagonal that is plainly shorter is taken.
TEST(SplitFacet, RoundingOfCoordinatesDoesNotChooseTheDiagonal) {
  const std::vector<int> quad{3, 0, 1, 2};
  const auto split = [&](const std::vector<Vector3d>& nodes) {
    const FacetTriangles triangles = split_facet(quad.data(), 4, nodes);
    return std::vector<std::array<int, 3>>(triangles.begin(), triangles.end());
  };
  const std::vector<std::array<int, 3>> at_lowest{{3, 0, 2}, {0, 1, 2}};
  for (double noise : {0.0, 1e-7, -1e-7, 3e-6, -3e-6}) {
    // Nodes 0 and 2 are opposite: noise makes their diagonal longer or shorter.
    const std::vector<Vector3d> nodes{{1 + noise, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 0}};
    EXPECT_EQ(split(nodes), at_lowest) << noise;
  }
  const std::vector<Vector3d> skewed{{1.01, -0.01, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 0}};
  const std::vector<std::array<int, 3>> shorter{{3, 0, 1}, {3, 1, 2}};
  EXPECT_EQ(split(skewed), shorter);
}

}  // namespace dea::layer_face_test

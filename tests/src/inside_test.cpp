#include "src/results/inside_fields.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/src/layer_meshes.h"

namespace dea::inside_test {

using namespace test;

// On a divided face a point keeps its place, and its height.
TEST(Inside, PlacesOnADividedFace) {
  const SurfaceMesh surface = rectangle(3, 2, 6, 4);
  const LayerMesh mesh = layer_mesh(surface, even(1), all(Rim::Free), -1, 3);
  for (const Barycentric& w : {Barycentric{0.2, 0.5, 0.3}, Barycentric{0.7, 0.1, 0.2}, Barycentric{1.0, 0.0, 0.0}})
    for (int t = 0; t < surface.size(); ++t) {
      const InsidePlace place = inside_place(mesh, t, w, 0.25);
      EXPECT_EQ(place.height, 0.25);
      EXPECT_EQ(place.triangle / 9, t);
      EXPECT_LT((position(mesh.mesh, {place.triangle, place.weights}) - position(surface, {t, w})).norm(), 1e-12);
    }
}

// Points between bone and face, and one far beside them.
TEST(Inside, PlacesOfPoints) {
  Layer layer;
  const SurfaceMesh top = rectangle(4, 4, 8, 8);
  layer.face = layer_face(top, even(2), all(Rim::Free));
  layer.bone = test::grid(4, 4, [](double u, double v) { return Vector3d(8 * u, 8 * v, -2); });
  const LayerMesh mesh = make_layer_mesh(layer.face);
  const std::vector<InsidePlace> places =
      inside_places(layer, layer.face, mesh, {{3.1, 2.2, -0.5}, {5, 5, -2}, {40, 5, -1}});
  EXPECT_NEAR(places[0].height, 0.75, 1e-12);
  EXPECT_LT((position(mesh.mesh, {places[0].triangle, places[0].weights}) - Vector3d(3.1, 2.2, 0)).norm(), 1e-12);
  EXPECT_NEAR(places[1].height, 0, 1e-12);
  EXPECT_EQ(places[2].triangle, -1);
}

// Half of a layer pressed evenly, half not at all: the numbers of the pressed half, by area.
TEST(Inside, StatisticsOnPaper) {
  const FootedLayer layer(layer_mesh(rectangle(4, 4, 8, 8), even(1), all(Rim::Wall)), {10, 0.3}, LayerFit::TwoTerms);
  InsideLayer inside;
  inside.layer = &layer.layer;
  const SurfaceMesh& mesh = layer.surface();
  const Eigen::Index n = layer.layer.mesh.nodes();
  inside.value = Eigen::MatrixXd::Zero(n, 2 + kDepthPowers);
  std::vector<InsideMeasures> states(static_cast<std::size_t>(n));
  double sum = 0, area = 0, most = 0;
  for (Eigen::Index v = 0; v < n; ++v) {
    const std::size_t i = static_cast<std::size_t>(v);
    const double x = mesh.vertices[i].x();
    states[i] = {(1 + x) / 2, 0.01 * x, -0.02 * x};
    if (x > 4.5) continue;
    inside.value(v, 0) = 1;
    sum += mesh.vertex_areas[i] * (1 + x) / 2;
    area += mesh.vertex_areas[i];
    most = std::max(most, x);
  }
  const InsideStatistics s = inside_statistics(inside, states);
  EXPECT_NEAR(s.max_shear.mean, sum / area, 1e-12);
  EXPECT_NEAR(s.max_shear.peak, (1 + most) / 2, 1e-12);
  EXPECT_NEAR(s.first_strain.peak, 0.01 * most, 1e-12);
  EXPECT_NEAR(s.third_strain.peak, -0.02 * most, 1e-12);
  EXPECT_LE(s.max_shear.p99, s.max_shear.peak);
  EXPECT_GT(s.max_shear.p99, s.max_shear.mean);
  inside.value.setZero();
  EXPECT_TRUE(std::isnan(inside_statistics(inside, states).first_strain.mean));
}

// Stress turns with the bone, Lagrange strain does not.
TEST(Inside, Turned) {
  InsideState state;
  state.stress.diagonal() << 1, 2, 3;
  state.strain.diagonal() << 4, 5, 6;
  state.normal = Vector3d::UnitX();
  Eigen::Matrix3d quarter;
  quarter << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  const InsideState after = turned(state, quarter);
  EXPECT_LT((after.stress.diagonal() - Vector3d(2, 1, 3)).norm(), 1e-14);
  EXPECT_EQ(after.strain, state.strain);
  EXPECT_LT((after.normal - Vector3d::UnitY()).norm(), 1e-14);
}

}  // namespace dea::inside_test

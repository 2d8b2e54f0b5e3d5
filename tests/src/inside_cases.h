// tests/src/inside_cases.h – layers on round and sloping bones, with a free end and with rims that lean, by finite
// elements and by the law: for the test of the inside and for the tables of docs/layer_law.md, section 8.
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "src/base/numbers.h"
#include "src/springs/layer_inside.h"
#include "tests/analytic/inside_elements.h"
#include "tests/analytic/linear_systems.h"
#include "tests/src/layer_meshes.h"

namespace dea::test {

/// Half the difference of the outer eigenvalues, the greatest, the least: by Eigen, not by `measures`.
inline InsideMeasures eigen_measures(const Eigen::Matrix3d& stress, const Eigen::Matrix3d& strain) {
  const Eigen::Vector3d s = analytic::eigenvalues(stress), e = analytic::eigenvalues(strain);
  return {0.5 * (s[2] - s[0]), e[2], e[0]};
}

/// A layer under a given pressure on its top, as elements and as the law has it. Places by s, along the top.
struct ElementCase {
  analytic::InsideElements elements;
  SurfaceMesh surface;
  Thickness thickness;
  RimAt rim = all(Rim::Wall);
  std::function<double(const Vector3d&)> s;
  double from = 0, to = 1;  ///< what is compared
};

/// Greatest errors over the greatest values in reach: pressure and shear on the base, greatest shear, first and third
/// principal strain at the height j/through.
inline std::array<double, 5> element_errors(const ElementCase& in, const analytic::SolvedElements& solved, int height) {
  const FootedLayer layer(layer_mesh(in.surface, in.thickness, in.rim), {in.elements.E, in.elements.nu},
                          LayerFit::TwoTerms);
  const InsideShape shape = inside_shape(layer.layer);
  const DepthLaws laws = make_depth_laws(in.elements.nu);
  const Eigen::VectorXd p = at_feet(layer.surface(), [&](const Vector3d& x) { return in.elements.pressure(in.s(x)); });
  const InsideLayer inside = look_inside(layer.layer, shape, laws, layer.feet, p);
  const double zeta = static_cast<double>(height) / in.elements.through;
  const std::vector<InsideState> states = states_at_height(inside, zeta, StrainMeasure::Small);
  const int columns = in.elements.along;
  std::vector<std::array<double, 5>> rows;
  std::array<double, 5> worst = {}, most = {};
  for (int c = 0; c < columns; ++c) {
    const analytic::StressStrain e = solved.at(c, height);
    const InsideMeasures m = eigen_measures(e.stress, e.strain);
    const double s = solved.s(c), d = 1e-4 * in.elements.length;
    const Eigen::Vector2d along = (in.elements.position(s + d, zeta) - in.elements.position(s - d, zeta)).normalized();
    const Vector3d n(-along.y(), 0, along.x()), t(along.x(), 0, along.y());
    rows.push_back({-n.dot(e.stress * n), t.dot(e.stress * n), m.max_shear, m.first_strain, m.third_strain});
    if (s >= in.from && s <= in.to)
      for (std::size_t k = 0; k < 5; ++k) most[k] = std::max(most[k], std::abs(rows.back()[k]));
  }
  const SurfaceMesh& mesh = layer.surface();
  for (std::size_t v = 0; v < states.size(); ++v) {
    const double s = in.s(mesh.vertices[v]), u = s / in.elements.length * columns - 0.5;
    if (s < in.from || s > in.to || u < 0 || u >= columns - 1) continue;
    const std::size_t i = static_cast<std::size_t>(u);
    const InsideMeasures m = measures(states[v]);
    const double share = u - static_cast<double>(i), shear = (1 - share) * rows[i][1] + share * rows[i + 1][1];
    const double found[] = {states[v].pressure, std::copysign(states[v].shear.norm(), shear), m.max_shear,
                            m.first_strain, m.third_strain};
    for (std::size_t k = 0; k < 5; ++k) {
      const double value = (1 - share) * rows[i][k] + share * rows[i + 1][k];
      worst[k] = std::max(worst[k], std::abs(found[k] - value) / most[k]);
    }
  }
  return worst;
}

inline double bump(double x) { return std::max(0.0, 1 - x * x); }

/// A strip with a flat top, plane strain.
inline ElementCase strip_case(double nu, double length, const Thickness& thickness,
                              const std::function<double(double)>& p, bool free_end, int along) {
  ElementCase in;
  in.elements.nu = nu;
  in.elements.position = [=](double s, double zeta) { return Eigen::Vector2d(s, -thickness({s, 0, 0}) * (1 - zeta)); };
  in.elements.pressure = p;
  in.elements.length = length;
  in.elements.mirror_last = !free_end;
  in.elements.along = along;
  const int n = along;
  in.surface = rectangle(n, 2, length, 2 * length / n);
  in.thickness = thickness;
  in.rim = [=](const Vector3d& x) { return free_end && x.x() > 0.9999 * length ? Rim::Free : Rim::Wall; };
  in.s = [](const Vector3d& x) { return x.x(); };
  in.to = length;
  return in;
}

/// A layer of t = 1 on a base that bends: `curvature` of its top, > 0 convex; a cylinder or a sphere.
inline ElementCase round_case(double nu, double curvature, bool sphere, double wide) {
  const double length = wide + 3;
  ElementCase in;
  in.elements.nu = nu;
  in.elements.axisymmetric = sphere;
  const double k = curvature;
  in.elements.position = [=](double s, double zeta) -> Eigen::Vector2d {
    const double a = s * k, below = 1 - zeta;
    if (k == 0) return {s, -below};
    return {std::sin(a) / k - below * std::sin(a), (std::cos(a) - 1) / k - below * std::cos(a)};
  };
  in.elements.pressure = [=](double s) { return bump(s / wide); };
  in.elements.length = length;
  in.elements.mirror_last = false;
  in.elements.along = static_cast<int>(length * 20);
  const auto top = in.elements.position;
  if (sphere) {
    const int n = static_cast<int>(length * 10);
    in.surface = grid(n, n, [=](double u, double v) -> Vector3d {
      const double s = length * std::hypot(u, v);
      const Eigen::Vector2d x = top(s, 1);
      if (s < 1e-12) return {0, 0, 0};
      return {x.x() * u / std::hypot(u, v), x.x() * v / std::hypot(u, v), x.y()};
    });
    in.rim = [=](const Vector3d& x) { return std::min(x.x(), x.y()) < 1e-9 ? Rim::Wall : Rim::Continues; };
  } else {
    const int n = static_cast<int>(length * 20);
    in.surface = grid(n, 2, [=](double u, double v) -> Vector3d {
      const Eigen::Vector2d x = top(length * u, 1);
      return {x.x(), v * 2 * length / n, x.y()};
    });
    in.rim = [=](const Vector3d& x) {
      return x.y() > 1e-9 && x.y() < 1.99 * length / n && x.x() > 1e-9 ? Rim::Continues : Rim::Wall;
    };
  }
  in.thickness = even(1);
  in.s = [=](const Vector3d& x) {
    const double r = sphere ? std::hypot(x.x(), x.y()) : x.x();
    return k == 0 ? r : std::atan2(r * std::abs(k), 1 + x.z() * k) / std::abs(k);
  };
  in.to = wide + 1.5;
  return in;
}

/// A strip of t = 1 with a free end whose wall leans (EdgedLayer::wall_slope), in plane strain under a given pressure.
struct RimCase {
  double nu = 0.45, degrees = 90;              ///< by which the surface turns down into the wall
  std::function<double(double)> load;          ///< pressure, of the distance from the end of the top
  int row = 0;                                 ///< of the elements' nodes, from the bone
  int along = 120, through = 14, facets = 54;  ///< elements, finer towards the end and the bone; of the law
  double slope() const { return 1 / std::tan(degrees * kPi / 180); }
  double height() const { return std::pow(static_cast<double>(row) / through, 1.6); }
  double end() const;  ///< of the top or of what is at this height, whichever is further in
};
inline constexpr double kRimLength = 9;
inline constexpr int kRimPatches = 16;
inline constexpr double kRimPatch = 0.25;
inline double RimCase::end() const { return kRimLength + std::min(0.0, (1 - height()) * slope()); }
/// Means over patches of t/4 one behind the other, from the end on. The corner at the bone is singular at a point;
/// means over patches are not.
struct RimPatches {
  std::array<double, kRimPatches> shear = {}, pressure = {};
  /// What a stretch adds, `shear` and `pressure` even on it. d: from the end, of its nearer side.
  void add(double d, double length, double of_shear, double of_pressure) {
    for (int k = 0; k < kRimPatches; ++k) {
      const double common = std::min(d + length, (k + 1) * kRimPatch) - std::max(d, k * kRimPatch);
      if (common <= 0) continue;
      shear[static_cast<std::size_t>(k)] += common / kRimPatch * of_shear;
      pressure[static_cast<std::size_t>(k)] += common / kRimPatch * of_pressure;
    }
  }
  double most_shear() const { return *std::max_element(shear.begin(), shear.end()); }
};

inline RimPatches rim_by_elements(const RimCase& in) {
  const auto top = [](double s) { return kRimLength * (1 - std::pow(1 - s / kRimLength, 1.6)); };
  analytic::InsideElements elements;
  elements.nu = in.nu;
  elements.position = [=, slope = in.slope()](double s, double zeta) -> Eigen::Vector2d {
    const double x = top(s), depth = 1 - std::pow(zeta, 1.6), beside = std::max(0.0, 1 - (kRimLength - x) / 3);
    return {x + depth * slope * beside * beside, -depth};
  };
  elements.pressure = [=](double s) { return in.load(kRimLength - top(s)); };
  elements.length = kRimLength;
  elements.mirror_last = false;
  elements.along = in.along;
  elements.through = in.through;
  const analytic::SolvedElements solved(elements);
  const double zeta = static_cast<double>(in.row) / in.through;
  RimPatches patches;
  for (int c = 0; c < in.along; ++c) {
    const double from = elements.position(kRimLength * c / in.along, zeta).x(),
                 to = elements.position(kRimLength * (c + 1) / in.along, zeta).x();
    const analytic::StressStrain e = solved.mean(c, in.row);
    patches.add(in.end() - to, to - from, eigen_measures(e.stress, e.strain).max_shear, -e.stress(2, 2));
  }
  return patches;
}

/// Linear between the vertices, as facets' means are.
inline RimPatches rim_by_law(const RimCase& in) {
  const double facet = kRimLength / in.facets;
  const SurfaceMesh surface = rectangle(in.facets, 1, kRimLength, facet);
  LayerFace face = layer_face(surface, even(1),
                              [](const Vector3d& x) { return x.x() > 0.9999 * kRimLength ? Rim::Free : Rim::Wall; });
  for (LayerFace::Edge& edge : face.edges) edge.wall = in.degrees * kPi / 180;
  const FootedLayer layer(make_layer_mesh(face), {1.0, in.nu}, LayerFit::TwoTerms);
  const InsideShape shape = inside_shape(layer.layer);
  const DepthLaws laws = make_depth_laws(in.nu);
  const InsideLayer inside =
      look_inside(layer.layer, shape, laws, layer.feet,
                  at_feet(layer.surface(), [&](const Vector3d& x) { return in.load(kRimLength - x.x()); }));
  const std::vector<InsideState> states = states_at_height(inside, in.height(), StrainMeasure::Small);
  std::vector<std::size_t> along(static_cast<std::size_t>(in.facets) + 1);
  for (std::size_t v = 0; v < states.size(); ++v)
    if (layer.surface().vertices[v].y() < 1e-9)
      along[static_cast<std::size_t>(std::lround(layer.surface().vertices[v].x() / facet))] = v;
  constexpr int kSteps = 8;
  RimPatches patches;
  for (std::size_t i = 0; i + 1 < along.size(); ++i)
    for (int k = 0; k < kSteps; ++k) {
      const InsideState &a = states[along[i]], &b = states[along[i + 1]];
      const double share = (k + 0.5) / kSteps, to = facet * (static_cast<double>(i) + (k + 1.0) / kSteps);
      patches.add(in.end() - to, facet / kSteps, (1 - share) * measures(a).max_shear + share * measures(b).max_shear,
                  (1 - share) * a.pressure + share * b.pressure);
    }
  return patches;
}

/// Pressed up to the edge, and a thickness inside of it.
struct RimLoad {
  const char* name;
  bool up_to_edge;
  double (*pressure)(double d);
};
inline constexpr RimLoad kRimLoads[] = {
    {"up to the edge, over 5 t", true, [](double d) { return std::max(0.0, 1 - d * d / 25); }},
    {"up to the edge, over 2 t", true, [](double d) { return std::max(0.0, 1 - d * d / 4); }},
    {"from t on, a bump", false, [](double d) { return std::max(0.0, 1 - (d - 3) * (d - 3) / 4); }},
    {"from t on, over 4 t", false, [](double d) { return d > 1 ? std::max(0.0, 1 - (d - 1) * (d - 1) / 16) : 0.0; }}};

}  // namespace dea::test

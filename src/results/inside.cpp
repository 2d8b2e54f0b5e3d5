#include "src/results/inside.h"

#include <algorithm>
#include <cmath>

#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/geometry/ray_caster.h"

namespace dea {

InsideMap make_inside_map(const SpringBed& bed) {
  InsideMap map;
  map.layers = bed.layers;
  if (!map.layers) return map;
  for (const int side : {0, 1}) {
    const std::optional<LayerOperator>& layer = side == bed.pair.source ? map.layers->source : map.layers->target;
    if (!layer || layer->law.terms < 2) continue;
    map.sides[side] = {&*layer, inside_shape(*layer), make_depth_laws(layer->elasticity.nu)};
  }
  return map;
}

InsideContact look_inside(const InsideMap& map, const SpringBed& bed, const SpringStates& states,
                          const Pose& source_pose, const Pose& target_pose) {
  InsideContact contact;
  SpringStates pressed = states;  // of the others nobody asks what they would press
  for (int i = 0; i < pressed.size(); ++i)
    if (!(pressed.pressure[at(i)] > 0)) pressed.triangle[at(i)] = -1;
  const Eigen::VectorXd pressure = Eigen::Map<const Eigen::VectorXd>(states.pressure.data(), states.size());
  const auto look = [&](int side) {
    const InsideMap::Side& of = map.sides[side];
    if (of.layer == nullptr) return;
    LayerFeet feet;
    if (states.size() > 0)
      feet = side == bed.pair.source
                 ? feet_on_source(*map.layers, Eigen::Map<const Eigen::VectorXd>(states.area.data(), states.size()))
                 : feet_on_target(bed, *of.layer, pressed, source_pose, target_pose,
                                  *std::max_element(states.overlap.begin(), states.overlap.end()));
    contact.sides[side] = look_inside(*of.layer, of.shape, of.laws, feet, pressure);
  };
  parallel_for(2, look);
  return contact;
}

std::vector<InsidePlace> inside_places(const Layer& layer, const LayerMesh& mesh, const std::vector<Vector3d>& points) {
  constexpr double kFar = 1.5;  // of the thickness: bone and face together are further than through the layer
  const RayCaster face(layer.face.mesh), bone(layer.bone);
  const bool no_bone = layer.bone.vertices == layer.articular.vertices;
  std::vector<InsidePlace> places(points.size());
  parallel_for(points.size(), [&](std::size_t i) {
    const Vector3d& x = points[i];
    const SurfacePoint above = face.closest(x);
    const Vector3d foot = position(layer.face.mesh, above);
    const double to_face = (foot - x).norm(), thickness = interpolate(layer.face.mesh, layer.face.thickness, above);
    if (no_bone) {
      if (thickness > 0 && to_face <= kFar * thickness)
        places[i] = inside_place(mesh, above.triangle, above.weights, std::max(0.0, 1 - to_face / thickness));
      return;
    }
    const double to_bone = (position(layer.bone, bone.closest(x)) - x).norm(), between = to_face + to_bone,
                 through = (position(layer.bone, bone.closest(foot)) - foot).norm();
    if (!(between > 0) || between > kFar * std::max(through, thickness)) return;
    places[i] = inside_place(mesh, above.triangle, above.weights, to_bone / between);
  });
  return places;
}

std::vector<InsideState> states_inside(const InsideLayer& inside, const std::vector<InsidePlace>& places,
                                       StrainMeasure measure) {
  InsideState none;
  none.normal = none.shear = Vector3d::Constant(kNaN);
  none.pressure = kNaN;
  none.stress = none.strain = Eigen::Matrix3d::Constant(kNaN);
  std::vector<InsideState> states(places.size(), none);
  parallel_for(places.size(), [&](std::size_t i) {
    if (places[i].triangle >= 0) states[i] = state_inside(inside, places[i], measure);
  });
  return states;
}

InsideState turned(InsideState state, const Eigen::Matrix3d& rotation) {
  state.normal = rotation * state.normal;
  state.shear = rotation * state.shear;
  state.stress = rotation * state.stress * rotation.transpose();
  return state;
}

InsideStatistics inside_statistics(const InsideLayer& inside, const std::vector<InsideMeasures>& measured,
                                   const std::vector<char>& among) {
  std::vector<double> shear, first, third, area;
  for (std::size_t v = 0; v < measured.size(); ++v) {
    if (!among.empty() && !among[v]) continue;
    if (!(inside.value(static_cast<Eigen::Index>(v), 0) > 0)) continue;
    const InsideMeasures& m = measured[v];
    shear.push_back(m.max_shear);
    first.push_back(m.first_strain);
    third.push_back(m.third_strain);
    area.push_back(inside.layer->mesh.mesh.vertex_areas[v]);
  }
  return {inside_distribution(shear, area, false), inside_distribution(first, area, false),
          inside_distribution(third, area, true)};
}

}  // namespace dea

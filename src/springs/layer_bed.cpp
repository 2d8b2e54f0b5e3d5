#include "src/springs/layer_bed.h"

#include <algorithm>

#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/springs/gaps.h"
#include "src/springs/spring_law.h"

namespace dea {

namespace {

/// Pressures to start from: those of the last pose, and what their rates make of the target's motion since, as seen
/// from the source.
Eigen::VectorXd pressures_to_start_from(const PressMemory& memory, const Pose& source, const Pose& target) {
  if (memory.rates.size() == 0) return memory.pressure;
  const Eigen::Matrix3d back = memory.source.rotation * source.rotation.transpose();
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(back * target.rotation * memory.target.rotation.transpose()));
  Eigen::Matrix<double, 6, 1> motion;
  motion << memory.source.center + back * (target.center - source.center) - memory.target.center,
      turn.angle() * turn.axis();
  return (memory.pressure + memory.rates * motion).cwiseMax(0.0);
}

}  // namespace

LayerFeet feet_on_target(const SpringBed& bed, const LayerOperator& target, const SpringStates& s,
                         const Pose& source_pose, const Pose& target_pose, double reach) {
  const LayerMesh& layer = target.mesh;
  const int divide2 = layer.divide * layer.divide;
  const RelativePose relative = relative_pose(source_pose, bed.source_center, target_pose, bed.target_center);
  constexpr int kChunk = 256;  // fixed, so that the result does not depend on the number of threads
  const int chunks = (s.size() + kChunk - 1) / kChunk;
  std::vector<LayerFeet> of_chunk(at(chunks));
  parallel_for(chunks, [&](int c) {
    for (int i = c * kChunk; i < std::min(s.size(), (c + 1) * kChunk); ++i) {
      const auto k = at(i);
      std::vector<SurfacePart> parts;
      if (s.triangle[k] >= 0 && s.area[k] > 0 && s.gap[k] < reach)
        parts = parts_under_spring(bed, relative, layer.mesh, s, i,
                                   s.triangle[k] * divide2 + part_at(layer.divide, s.end_weights[k]), layer.pressed);
      add_foot(of_chunk[at(c)], target, parts, parts.empty() ? 0.0 : s.area[k]);
    }
  });
  LayerFeet feet;
  for (const LayerFeet& more : of_chunk) append(feet, more);
  set_reach(feet, target);
  return feet;
}

LayerFeet feet_on_source(const LayerBed& layers, const Eigen::VectorXd& area) {
  LayerFeet feet = layers.whole;
  for (int i = 0; i < feet.size(); ++i) {
    const auto k = at(i);
    const double share = feet.area[k] > 0 ? area[i] / feet.area[k] : 0.0;
    if (share == 1.0) continue;
    for (int j = feet.begin[k]; j < feet.begin[k + 1]; ++j) feet.weight[at(j)] *= share;
    feet.volume[k] *= share;
    feet.area[k] = area[i];
  }
  set_reach(feet, *layers.source);
  return feet;
}

std::shared_ptr<const LayerBed> make_layer_bed(const ContactPair& pair) {
  const Layer &source = pair.source_layer(), &target = pair.target_layer();
  auto layers = std::make_shared<LayerBed>();
  if (!source.rigid) {
    layers->source = make_layer_operator(make_layer_mesh(source.face, pair.refine), source.elasticity, pair.layer_fit);
    layers->whole = feet_of_own_triangles(*layers->source);
  }
  if (!target.rigid)
    layers->target = make_layer_operator(make_layer_mesh(target.face, pair.refine), target.elasticity, pair.layer_fit);
  return layers;
}

namespace {

/// What a spring under pressure shows: strains of both layers, and its own stiffness.
void set_spring(const SpringBed& bed, const LayerPressure& result, int i, SpringStates& s) {
  const ContactPair& pair = bed.pair;
  const Elasticity &E_s = pair.source_layer().elasticity, &E_t = pair.target_layer().elasticity;
  const auto k = at(i);
  s.pressure[k] = result.pressure[i];
  // the layer's own shortening, whatever flows: no less than nothing, for what bulges at p > 0 is not stretched
  s.strain_source[k] = s.t_source[k] > 0 ? std::max(0.0, result.sunk_source[i] / s.t_source[k]) : 0.0;
  s.strain_target[k] = s.t_target[k] > 0 ? std::max(0.0, result.sunk_target[i] / s.t_target[k]) : 0.0;
  s.strain[k] = std::max(s.strain_source[k], s.strain_target[k]);
  const double confined =
      (s.t_source[k] > 0 ? s.t_source[k] * strain_at_pressure(Law::NeoHookean, E_s, s.pressure[k]) : 0.0) +
      (s.t_target[k] > 0 ? s.t_target[k] * strain_at_pressure(Law::NeoHookean, E_t, s.pressure[k]) : 0.0);
  s.per_overlap[k] = spring_response(bed.pair.law, E_s, E_t, s.t_source[k], s.t_target[k],
                                     confined + pair.interface_compliance * s.pressure[k], pair.interface_compliance)
                         .per_overlap;
}

/// How the overlap changes with small motions of the target relative to the source, about the target's centre: six
/// columns (E2), (E3). The target's thickness at the spring's end counts with its strain, as in a spring.
Eigen::MatrixXd overlap_rates(const SpringBed& bed, const LayerContact& contact, const LayerPressure& result,
                              const Pose& source, const Pose& target, SpringStates& s) {
  const int n = s.size();
  Eigen::MatrixXd rates = Eigen::MatrixXd::Zero(n, 6);
  for (int i = 0; i < n; ++i) {
    const auto k = at(i);
    if (!result.active[k]) continue;
    const Vector3d per_motion = overlap_rate(bed, s, i, s.strain_target[k], target);
    s.per_motion[k] = s.per_overlap[k] * per_motion;
    rates.row(i) << per_motion.transpose(), (s.end[k] - target.center).cross(per_motion).transpose();
  }
  if (s.rim.empty()) return rates;
  // Over the target's rim the foot moves in its plane, and the area that carries its pressure changes.
  Eigen::MatrixXd force_rates = Eigen::MatrixXd::Zero(n, 6);
  for (const RimSpring& rim : s.rim) {
    const int i = rim.spring;
    const auto k = at(i);
    if (!result.active[k]) continue;
    const Vector3d gradient =
        source_overlap_gradient(bed, s, i, 0.0, source) - overlap_rate(bed, s, i, s.strain_target[k], target);
    rates.row(i) += gradient.transpose() * rim.foot_rate.leftCols<6>();
    force_rates.row(i) = result.pressure[i] * rim.area_rate.head<6>().transpose();
  }
  rates -= spread(contact, force_rates);
  return rates;
}

/// The pressures' derivative by the motions that are asked for.
void set_rates(const LayerContact& contact, const LayerPressure& result, const Eigen::MatrixXd& rates,
               const PressOptions& options, const PressMemory* memory, SpringStates& s) {
  std::vector<int> columns;
  for (int m = 0; m < 6; ++m)
    if (options.motions[at(m)]) columns.push_back(m);
  if (columns.empty()) return;
  const Eigen::MatrixXd asked = rates(Eigen::all, columns);
  const Eigen::MatrixXd start =
      memory && memory->rates.size() > 0 ? Eigen::MatrixXd(memory->rates(Eigen::all, columns)) : Eigen::MatrixXd();
  s.rates(Eigen::all, columns) =
      solve_active(contact, result.active, asked, options.rate_tolerance, start, options.stop).pressure;
}

}  // namespace

void press_layers(const LayerBed& layers, const SpringBed& bed, SpringStates& s, const Pose& source, const Pose& target,
                  const PressOptions& options, PressMemory* memory) {
  const int n = s.size();
  s.rates.setZero(n, 6);
  const double deepest = *std::max_element(s.overlap.begin(), s.overlap.end());
  if (!(deepest > 0)) return;

  Eigen::VectorXd overlap = Eigen::VectorXd::Zero(n);
  LayerContact contact;
  contact.interface_compliance = bed.pair.interface_compliance;
  contact.area = Eigen::VectorXd::Zero(n);
  for (int i = 0; i < n; ++i) {
    // nothing bulges by more than it is pressed in elsewhere
    if (!(s.area[at(i)] > 0) || s.gap[at(i)] >= deepest) continue;
    overlap[i] = -s.gap[at(i)];
    contact.area[i] = s.area[at(i)];
  }
  LayerFeet source_feet, target_feet;
  if (layers.source) {
    source_feet = feet_on_source(layers, contact.area);
    contact.source.layer = &*layers.source;
    contact.source.feet = &source_feet;
  }
  if (layers.target) {
    target_feet = feet_on_target(bed, *layers.target, s, source, target, deepest);
    contact.target.layer = &*layers.target;
    contact.target.feet = &target_feet;
  }
  LayerContactOptions search;
  search.tolerance = options.tolerance;
  search.stop = options.stop;
  const LayerPressure result = solve_contact(
      contact, overlap, memory ? pressures_to_start_from(*memory, source, target) : Eigen::VectorXd(), search);
  s.complementarity = result.residual;
  s.complementary = result.converged;
  for (int i = 0; i < n; ++i)
    if (result.active[at(i)]) set_spring(bed, result, i, s);
  set_rates(contact, result, overlap_rates(bed, contact, result, source, target, s), options, memory, s);
  if (memory) *memory = {result.pressure, s.rates, source, target};
}

}  // namespace dea

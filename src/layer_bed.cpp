#include "layer_bed.h"

#include <algorithm>
#include <cmath>

namespace dea {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// What a solver above takes for a function of the pose must be smoother than its own tolerance.
constexpr double kTolerance = 1e-11;
/// The derivative only directs the next step.
constexpr double kRateTolerance = 1e-4;

/// Edges of the rim in a plane of symmetry have their mirror image beyond; elsewhere the cartilage ends there.
std::vector<Rim> source_rim(const LayerMesh& mesh, const Layer& source) {
  std::vector<Rim> rim;
  for (const RimEdge& edge : mesh.rim) {
    const auto& t = mesh.triangles[at(edge.triangle)];
    const Vector3d along = mesh.vertices[at(edge.b)] - mesh.vertices[at(edge.a)],
                   normal = (mesh.vertices[at(t[1])] - mesh.vertices[at(t[0])])
                                .cross(mesh.vertices[at(t[2])] - mesh.vertices[at(t[0])]),
                   outward = along.cross(normal).normalized();
    const int held = source.mirror[at(edge.a)] & source.mirror[at(edge.b)];
    bool wall = false;  // the surface must run into the plane, not along it
    for (int k = 0; k < 3; ++k) wall = wall || ((held >> k & 1) != 0 && std::abs(outward[k]) > 0.7);
    rim.push_back(wall ? Rim::Wall : Rim::Free);
  }
  return rim;
}

/// Beyond an edge of the source's rim the target goes on where the edge's middle, carried along the springs beside it,
/// stands well inside the target in the reference pose. (Judged anew in every pose, it would make pressures jump.)
std::vector<Rim> target_rim(const LayerBed& layers, const SpringBed& bed) {
  constexpr double kTie = 1e-6;  // edges that are as far as the target is thick are all free, whatever the rounding
  const SpringStates s = project_springs(bed, {bed.source_center, Eigen::Matrix3d::Identity()},
                                         {bed.target_center, Eigen::Matrix3d::Identity()});
  const LayerMesh& mesh = *layers.mesh;
  const std::vector<std::array<Vector3d, 2>> segments = rim_segments(bed.pair->target_layer().spring_surface());
  std::vector<Rim> rim;
  for (std::size_t k = 0; k < mesh.rim.size(); ++k) {
    const RimEdge& edge = mesh.rim[k];
    if (layers.rim[k] == Rim::Wall) {
      rim.push_back(Rim::Wall);
      continue;
    }
    const std::vector<int>& feet = mesh.triangle_feet[at(edge.triangle)];
    bool inside = !feet.empty();
    Vector3d along = Vector3d::Zero();
    double thickness = 0.0;
    for (const int f : feet) {
      inside = inside && s.triangle[at(f)] >= 0 && s.coverage[at(f)] >= 1.0;
      if (!inside) break;
      along += (s.end[at(f)] - s.foot[at(f)]) / static_cast<double>(feet.size());
      thickness = std::max(thickness, s.t_target[at(f)]);
    }
    const Vector3d middle = 0.5 * (mesh.vertices[at(edge.a)] + mesh.vertices[at(edge.b)]) + along;
    const double needed = std::max(edge.length, thickness) * (1 + kTie);
    for (std::size_t i = 0; i < segments.size() && inside; ++i)
      inside = distance_to_segment(middle, segments[i][0], segments[i][1]) > needed;
    rim.push_back(inside ? Rim::Continues : Rim::Free);
  }
  return rim;
}

/// The target's thickness at the springs' ends; where a spring meets nothing, that of the nearest triangle whose
/// springs do. Taken for nothing there, the layer's edge would jump by a triangle whenever a spring slides off the
/// target.
std::vector<double> target_thickness(const LayerMesh& mesh, const SpringStates& s) {
  std::vector<double> of_triangle(mesh.triangles.size(), 0.0);
  std::vector<int> front;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    int met = 0;
    for (const int f : mesh.triangle_feet[t]) {
      of_triangle[t] += s.t_target[at(f)];
      met += s.triangle[at(f)] >= 0;
    }
    if (met == 0) continue;
    of_triangle[t] /= met;
    front.push_back(static_cast<int>(t));
  }
  std::vector<char> known(mesh.triangles.size(), 0);
  for (const int t : front) known[at(t)] = 1;
  for (std::size_t i = 0; i < front.size(); ++i)
    for (const int next : mesh.neighbours[at(front[i])]) {
      if (next < 0 || known[at(next)]) continue;
      known[at(next)] = 1;
      of_triangle[at(next)] = of_triangle[at(front[i])];
      front.push_back(next);
    }
  std::vector<double> thickness = s.t_target;
  for (int f = 0; f < mesh.feet(); ++f)
    if (s.triangle[at(f)] < 0) thickness[at(f)] = of_triangle[at(mesh.foot_triangle[at(f)])];
  return thickness;
}

/// Pressures to start from: those of the last pose, and what their rates make of the target's motion since, as seen
/// from the source.
Eigen::VectorXd pressures_to_start_from(const LayerBed& layers, const Pose& source, const Pose& target) {
  if (layers.last_rates.size() == 0) return layers.last;
  const Eigen::Matrix3d back = layers.last_source.rotation * source.rotation.transpose();
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(back * target.rotation * layers.last_target.rotation.transpose()));
  Eigen::Matrix<double, 6, 1> motion;
  motion << layers.last_source.center + back * (target.center - source.center) - layers.last_target.center,
      turn.angle() * turn.axis();
  return (layers.last + layers.last_rates * motion).cwiseMax(0.0);
}

}  // namespace

std::shared_ptr<LayerBed> make_layer_bed(const SpringBed& bed) {
  const Layer &source = bed.pair->source_layer(), &target = bed.pair->target_layer();
  auto layers = std::make_shared<LayerBed>();
  const Springs& springs = bed.springs;
  layers->mesh = std::make_shared<const LayerMesh>(
      make_layer_mesh(source.spring_surface(), springs.surface_triangle, springs.weights));
  layers->rim = source_rim(*layers->mesh, source);
  const LayerFit fit = bed.pair->layer_fit;
  if (!source.rigid) {
    layers->source.emplace(layers->mesh, layer_law(source.elasticity, fit), layers->rim);
    std::vector<double> thickness;
    for (const auto& t : springs.corner_thickness) thickness.push_back((t[0] + t[1] + t[2]) / 3.0);
    layers->source->set_thickness(thickness);
  }
  if (!target.rigid) layers->target.emplace(layers->mesh, layer_law(target.elasticity, fit), target_rim(*layers, bed));
  return layers;
}

void press_layers(LayerBed& layers, const SpringBed& bed, SpringStates& s, const Pose& source, const Pose& target) {
  const ContactPair& pair = *bed.pair;
  const int n = s.size();
  s.rates.setZero(n, 6);
  if (std::none_of(s.overlap.begin(), s.overlap.end(), [](double overlap) { return overlap > 0; })) return;

  Eigen::VectorXd overlap = Eigen::VectorXd::Zero(n);
  LayerContact contact;
  contact.interface_compliance = pair.interface_compliance;
  contact.area = Eigen::VectorXd::Zero(n);
  for (int i = 0; i < n; ++i) {
    if (!(s.area[at(i)] > 0)) continue;
    overlap[i] = -s.gap[at(i)];
    contact.area[i] = s.area[at(i)];
  }
  if (layers.source) contact.source = &*layers.source;
  if (layers.target) {
    layers.target->set_thickness(target_thickness(*layers.mesh, s));
    contact.target = &*layers.target;
  }
  LayerContactOptions options;
  options.tolerance = kTolerance;
  const LayerSprings result =
      solve_layer_springs(contact, bed.law, pair.source_layer().elasticity, pair.target_layer().elasticity, overlap,
                          pressures_to_start_from(layers, source, target), options);
  layers.last = result.linear.pressure;
  s.complementarity = result.linear.residual;
  s.complementary = result.linear.converged;

  // How the overlap changes with small motions of the target relative to the source, about the target's centre: six
  // columns (E2), (E3). The target's thickness at the spring's end counts with its strain, as in a spring.
  Eigen::MatrixXd overlap_rates = Eigen::MatrixXd::Zero(n, 6);
  for (int i = 0; i < n; ++i) {
    const auto k = at(i);
    if (!result.linear.active[k]) continue;
    const SpringResponse& r = result.springs[k];
    s.pressure[k] = r.pressure;
    s.strain_source[k] = r.strain_source;
    s.strain_target[k] = r.strain_target;
    s.strain[k] = std::max(r.strain_source, r.strain_target);
    const Vector3d per_motion = overlap_rate(bed, s, i, r.strain_target, target);
    s.per_overlap[k] = r.per_overlap;
    s.per_motion[k] = r.per_overlap * per_motion;
    overlap_rates.row(i) << per_motion.transpose(), (s.end[k] - target.center).cross(per_motion).transpose();
  }
  // Over the target's rim the foot moves in its plane, and the area that carries its pressure changes.
  Eigen::MatrixXd force_rates = Eigen::MatrixXd::Zero(s.rim.empty() ? 0 : n, 6);
  for (const RimSpring& rim : s.rim) {
    const int i = rim.spring;
    const auto k = at(i);
    if (!result.linear.active[k]) continue;
    const Vector3d gradient =
        source_overlap_gradient(bed, s, i, 0.0, source) - overlap_rate(bed, s, i, s.strain_target[k], target);
    overlap_rates.row(i) += gradient.transpose() * rim.foot_rate.leftCols<6>();
    force_rates.row(i) = result.linear.pressure[i] * rim.area_rate.head<6>().transpose();
  }
  if (!s.rim.empty()) overlap_rates -= spread(contact, force_rates);
  ActiveRates rates = solve_active(contact, result.linear.active, overlap_rates, kRateTolerance, layers.last_rates);
  for (int i = 0; i < n; ++i) {
    const auto k = at(i);
    if (!result.linear.active[k]) continue;
    const double spring_compliance = result.spring_overlap[i] / result.linear.pressure[i];  // (L5)
    s.rates.row(i) = result.springs[k].per_overlap * spring_compliance * rates.pressure.row(i);
  }
  layers.last_rates = std::move(rates.pressure);
  layers.last_source = source;
  layers.last_target = target;
}

}  // namespace dea

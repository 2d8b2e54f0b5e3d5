#include "src/springs/layer_bed.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/springs/edge_bulge.h"
#include "src/springs/gaps.h"
#include "src/springs/spring_law.h"

namespace dea {

int BedLayer::mesh_triangle(int t, const Barycentric& w) const {
  const int divide = layer->mesh.divide, parts = divide * divide;
  if (triangle.empty()) return t * parts + part_at(divide, w);
  Barycentric turned;
  for (std::size_t k = 0; k < 3; ++k) turned[(k + turn[at(t)]) % 3] = w[k];
  return triangle[at(t)] * parts + part_at(divide, turned);
}

namespace {

std::shared_ptr<const LayerOperator> operator_of(const LayerFace& face, const ContactPair& pair,
                                                 const Elasticity& elasticity) {
  return std::make_shared<const LayerOperator>(
      make_layer_operator(make_layer_mesh(face, pair.refine), elasticity, pair.layer_fit));
}

BedLayer bed_layer(const Joint& joint, const ContactPair& pair, int side, SharedOperators& shared) {
  BedLayer of;
  const Layer& layer = pair.layers[side];
  if (layer.part >= 0) {
    const SoftPart& part = joint.parts[at(layer.part)];
    std::shared_ptr<const PartOperator>& made = shared.parts[layer.part];
    if (!made) made = make_part(joint, part);
    of.part = made;
    for (const int node : layer.articular.model_nodes) of.part_node.push_back(part.node_of(node));
    return of;
  }
  if (layer.rigid) return of;
  const LayerPlace place = place_in_shared_layer(joint, pair, side);
  if (place.layer < 0) {
    of.layer = operator_of(layer.face, pair, layer.elasticity);
    return of;
  }
  std::shared_ptr<const LayerOperator>& made = shared.layers[place.layer];
  if (!made) made = operator_of(joint.shared_layers[at(place.layer)].face, pair, layer.elasticity);
  of.layer = made;
  of.triangle = place.use->triangle;
  of.turn = place.use->turn;
  const int parts = pair.refine * pair.refine;
  of.own.assign(at(of.layer->mesh.mesh.size()), 0);
  for (const int t : of.triangle) std::fill_n(of.own.begin() + t * parts, parts, 1);
  return of;
}

/// One foot on each triangle of the contact's surface, divided as the springs are.
void add_source_feet(int triangles, LayerBed& bed) {
  const BedLayer& of = bed.source;
  const SurfaceMesh& mesh = of.layer->mesh.mesh;
  const auto parts = triangle_parts(of.layer->mesh.divide);
  for (int t = 0; t < triangles; ++t)
    for (const auto& w : parts) {
      bed.source_triangle.push_back(of.mesh_triangle(
          t,
          {(w[0][0] + w[1][0] + w[2][0]) / 3, (w[0][1] + w[1][1] + w[2][1]) / 3, (w[0][2] + w[1][2] + w[2][2]) / 3}));
      const int part = bed.source_triangle.back();
      add_foot(bed.whole, *of.layer, {{part, mesh.areas[at(part)]}}, mesh.areas[at(part)]);
    }
}

/// Per triangle: the surface ends at one of its vertices, other than in a plane of symmetry.
std::vector<char> ends_of(const SurfaceMesh& mesh) {
  std::vector<char> end(mesh.vertices.size(), 0), ends;
  for (int t = 0; t < mesh.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      if (mesh.neighbours[at(t)][at(k)] >= 0) continue;
      const int a = mesh.triangles[at(t)][at(k)], b = mesh.triangles[at(t)][at((k + 1) % 3)];
      const int planes = mesh.planes.empty() ? 0 : mesh.planes[at(a)] & mesh.planes[at(b)];
      if (!mirrored(planes, outward_at(mesh, t, k))) end[at(a)] = end[at(b)] = 1;
    }
  for (const auto& corners : mesh.triangles)
    ends.push_back(std::any_of(corners.begin(), corners.end(), [&](int v) { return end[at(v)] != 0; }));
  return ends;
}

}  // namespace

std::shared_ptr<LayerBed> make_layer_bed(const Joint& joint, const ContactPair& pair, SharedOperators& shared) {
  auto layers = std::make_shared<LayerBed>();
  layers->source = bed_layer(joint, pair, pair.source, shared);
  layers->target = bed_layer(joint, pair, 1 - pair.source, shared);
  if (layers->source.layer) add_source_feet(pair.source_layer().articular.size(), *layers);
  layers->ends = ends_of(pair.source_layer().spring_surface());
  return layers;
}

LayerFeet feet_on_target(const SpringBed& bed, const SpringStates& s, const Pose& source_pose, const Pose& target_pose,
                         double reach) {
  const BedLayer& target = bed.layers->target;
  const RelativePose relative = relative_pose(source_pose, bed.source_center, target_pose, bed.target_center);
  constexpr int kChunk = 256;  // fixed, so that the result does not depend on the number of threads
  const int chunks = (s.size() + kChunk - 1) / kChunk;
  std::vector<LayerFeet> of_chunk(at(chunks));
  parallel_for(chunks, [&](int c) {
    for (int i = c * kChunk; i < std::min(s.size(), (c + 1) * kChunk); ++i) {
      const auto k = at(i);
      std::vector<SurfacePart> parts;
      if (s.triangle[k] >= 0 && s.area[k] > 0 && s.gap[k] < reach)
        parts = parts_under_spring(bed, relative, target.layer->mesh.mesh, s, i,
                                   target.mesh_triangle(s.triangle[k], s.end_weights[k]), target.layer->mesh.pressed,
                                   target.own);
      add_foot(of_chunk[at(c)], *target.layer, parts, parts.empty() ? 0.0 : s.area[k]);
    }
  });
  LayerFeet feet;
  for (const LayerFeet& more : of_chunk) append(feet, more);
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
  return feet;
}

namespace {

/// Contacts that share layers, as one problem: where the springs of each are among all, which layers there are.
struct Together {
  const std::vector<PosedBed>& beds;
  std::vector<Eigen::Index> begin = {0};     ///< per bed: its springs; the last: how many there are
  std::vector<const LayerOperator*> layers;  ///< each once
  std::vector<const PartOperator*> parts;    ///< each once
  std::vector<std::array<int, 2>> layer_of;  ///< per bed: of source, target; -1: bare
  std::vector<BodyPair> pairs;               ///< of the beds, each once
  std::vector<Eigen::Index> pair_of;         ///< per bed

  explicit Together(const std::vector<PosedBed>& all) : beds(all), parts(parts_of(all)) {
    for (const PosedBed& b : beds) {
      begin.push_back(begin.back() + b.bed->size());
      layer_of.push_back({index_of(b.bed->layers->source), index_of(b.bed->layers->target)});
      const BodyPair bodies{b.bed->source_body, b.bed->target_body};
      const auto known = std::find(pairs.begin(), pairs.end(), bodies);
      pair_of.push_back(known - pairs.begin());
      if (known == pairs.end()) pairs.push_back(bodies);
    }
  }
  Eigen::Index springs() const { return begin.back(); }
  Eigen::Index columns() const { return 6 * static_cast<Eigen::Index>(pairs.size()); }
  /// A bed of these bodies.
  const PosedBed& bed_of(Eigen::Index pair) const {
    return beds[at(std::find(pair_of.begin(), pair_of.end(), pair) - pair_of.begin())];
  }

 private:
  int index_of(const BedLayer& of) {
    if (!of.layer) return -1;
    const auto known = std::find(layers.begin(), layers.end(), of.layer.get());
    const int index = static_cast<int>(known - layers.begin());
    if (known == layers.end()) layers.push_back(of.layer.get());
    return index;
  }
};

/// The targets' motions since the memory's pose, as seen from their sources: 6 per pair of bodies.
Eigen::VectorXd motion_since(const PressMemory& memory, const Together& all) {
  Eigen::VectorXd motion(all.columns());
  for (std::size_t m = 0; m < all.pairs.size(); ++m) {
    const PosedBed& now = all.bed_of(static_cast<Eigen::Index>(m));
    const Pose &source = memory.source[m], &target = memory.target[m];
    const Eigen::Matrix3d back = source.rotation * now.source.rotation.transpose();
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(back * now.target.rotation * target.rotation.transpose()));
    motion.segment<6>(6 * static_cast<Eigen::Index>(m))
        << source.center + back * (now.target.center - now.source.center) - target.center,
        turn.angle() * turn.axis();
  }
  return motion;
}

/// Pressures to start from: those of the last pose, and what their rates make of the motions since; without rates, as
/// much of their last change as the motion is of the last motion. `length`: of the surfaces, for turns.
Eigen::VectorXd pressures_to_start_from(const PressMemory& memory, const Eigen::VectorXd& motion, double length) {
  if (memory.pressure.size() == 0) return {};
  if (!memory.rates.isZero(0)) return memory.pressure + memory.rates * motion;
  if (memory.change.size() == 0) return memory.pressure;
  double along = 0.0, all = 0.0;
  for (Eigen::Index k = 0; k < motion.size(); ++k) {
    const double weight = k % 6 < 3 ? 1.0 : length * length;
    along += weight * motion[k] * memory.motion[k];
    all += weight * memory.motion[k] * memory.motion[k];
  }
  const double part = all > 0 ? std::clamp(along / all, 0.0, 2.0) : 0.0;
  return memory.nearly + part * memory.change;
}

/// So many feet that stand on nothing.
LayerFeet no_feet(int count) {
  LayerFeet feet;
  feet.begin.assign(at(count) + 1, 0);
  for (auto* values : {&feet.area, &feet.volume, &feet.own}) values->assign(at(count), 0.0);
  return feet;
}

/// The feet of all springs on each layer.
std::vector<LayerFeet> feet_on_layers(const Together& all, const std::vector<SpringStates>& states,
                                      const Eigen::VectorXd& area, double reach) {
  std::vector<LayerFeet> feet(all.layers.size());
  for (std::size_t b = 0; b < all.beds.size(); ++b) {
    const PosedBed& posed = all.beds[b];
    const int n = posed.bed->size();
    for (std::size_t k = 0; k < feet.size(); ++k) {
      const int layer = static_cast<int>(k);
      if (posed.active && all.layer_of[b][0] == layer)
        append(feet[k], feet_on_source(*posed.bed->layers, area.segment(all.begin[b], n)));
      else if (posed.active && all.layer_of[b][1] == layer)
        append(feet[k], feet_on_target(*posed.bed, states[b], posed.source, posed.target, reach));
      else
        append(feet[k], no_feet(n));
    }
  }
  for (std::size_t k = 0; k < feet.size(); ++k) set_reach(feet[k], *all.layers[k]);
  return feet;
}

/// The feet of all springs on each part.
std::vector<PartFeet> feet_on_parts(const Together& all, const std::vector<SpringStates>& states) {
  std::vector<PartFeet> feet(all.parts.size());
  for (std::size_t k = 0; k < feet.size(); ++k) {
    for (std::size_t b = 0; b < all.beds.size(); ++b) {
      const PosedBed& posed = all.beds[b];
      if (posed.active) {
        add_feet(*posed.bed, states[b], posed.source, posed.target, *all.parts[k], feet[k]);
      } else {
        feet[k].begin.resize(feet[k].begin.size() + at(posed.bed->size()), feet[k].begin.back());
        for (auto* values : {&feet[k].area, &feet[k].scale}) values->resize(feet[k].begin.size() - 1, 0.0);
      }
    }
    set_reach(feet[k], *all.parts[k]);
  }
  return feet;
}

/// What a spring under pressure shows: strains of both layers, and its own stiffness. `all`: its number among those of
/// all contacts.
void set_spring(const SpringBed& bed, const std::array<int, 2>& layers, const LayerPressure& result, Eigen::Index all,
                int i, SpringStates& s) {
  const ContactPair& pair = bed.pair;
  const Elasticity &E_s = pair.source_layer().elasticity, &E_t = pair.target_layer().elasticity;
  const auto k = at(i);
  s.pressure[k] = result.pressure[all];
  // the layer's own shortening, whatever flows: no less than nothing, for what bulges at p > 0 is not stretched
  const auto strain = [&](int layer, double thickness) {
    return layer >= 0 && thickness > 0 ? std::max(0.0, result.sunk[at(layer)][all] / thickness) : 0.0;
  };
  s.strain_source[k] = strain(layers[0], s.t_source[k]);
  s.strain_target[k] = strain(layers[1], s.t_target[k]);
  s.strain[k] = std::max(s.strain_source[k], s.strain_target[k]);
  const double confined =
      (s.t_source[k] > 0 ? s.t_source[k] * strain_at_pressure(Law::NeoHookean, E_s, s.pressure[k]) : 0.0) +
      (s.t_target[k] > 0 ? s.t_target[k] * strain_at_pressure(Law::NeoHookean, E_t, s.pressure[k]) : 0.0);
  s.per_overlap[k] = spring_response(bed.pair.law, E_s, E_t, s.t_source[k], s.t_target[k],
                                     confined + pair.interface_compliance * s.pressure[k], pair.interface_compliance)
                         .per_overlap;
}

/// How the overlaps change with small motions of the targets relative to their sources, about the targets' centres: six
/// columns per pair of bodies (E2), (E3). The target's thickness at the spring's end counts with its strain, as in a
/// spring.
Eigen::MatrixXd overlap_rates(const Together& all, const LayerContact& contact, const LayerPressure& result,
                              std::vector<SpringStates>& states) {
  Eigen::MatrixXd rates = Eigen::MatrixXd::Zero(all.springs(), all.columns()), force_rates;
  for (std::size_t b = 0; b < all.beds.size(); ++b) {
    const PosedBed& posed = all.beds[b];
    SpringStates& s = states[b];
    const Eigen::Index first = all.begin[b], column = 6 * all.pair_of[b];
    for (int i = 0; i < s.size(); ++i) {
      const auto k = at(i);
      if (!result.active[at(first + i)]) continue;
      const bool tie = !posed.bed->ties.empty();
      const Vector3d per_motion =
          tie ? s.per_motion[k] : overlap_rate(*posed.bed, s, i, s.strain_target[k], posed.target);
      if (!tie) s.per_motion[k] = s.per_overlap[k] * per_motion;
      rates.row(first + i).segment<6>(column) << per_motion.transpose(),
          (s.end[k] - posed.target.center).cross(per_motion).transpose();
    }
    // Over the target's rim the foot moves in its plane, and the area that carries its pressure changes.
    if (!s.rim.empty() && force_rates.size() == 0) force_rates = Eigen::MatrixXd::Zero(all.springs(), all.columns());
    for (const RimSpring& rim : s.rim) {
      const int i = rim.spring;
      const auto k = at(i);
      if (!result.active[at(first + i)]) continue;
      const Vector3d gradient = source_overlap_gradient(*posed.bed, s, i, 0.0, posed.source) -
                                overlap_rate(*posed.bed, s, i, s.strain_target[k], posed.target);
      rates.row(first + i).segment<6>(column) += gradient.transpose() * rim.foot_rate.leftCols<6>();
      force_rates.row(first + i).segment<6>(column) = result.pressure[first + i] * rim.area_rate.head<6>().transpose();
    }
  }
  if (force_rates.size() > 0) rates -= spread(contact, force_rates);
  return rates;
}

/// The pressures' derivative by the motions that are asked for; the other columns stay zero.
Eigen::MatrixXd pressure_rates(const Together& all, const LayerContact& contact, const LayerPressure& result,
                               const Eigen::MatrixXd& overlap_rates, const PressOptions& options,
                               const PressMemory* memory) {
  std::vector<Eigen::Index> columns;
  for (std::size_t m = 0; m < all.pairs.size(); ++m)
    for (std::size_t k = 0; k < 6; ++k) {
      bool asked = false;
      for (std::size_t b = 0; b < all.beds.size(); ++b)
        asked =
            asked || (all.pair_of[b] == static_cast<Eigen::Index>(m) && all.beds[b].active && all.beds[b].motions[k]);
      if (asked) columns.push_back(static_cast<Eigen::Index>(6 * m + k));
    }
  Eigen::MatrixXd rates = Eigen::MatrixXd::Zero(all.springs(), all.columns());
  if (columns.empty()) return rates;
  const Eigen::MatrixXd asked = overlap_rates(Eigen::all, columns);
  const Eigen::MatrixXd start =
      memory && memory->rates.size() > 0 ? Eigen::MatrixXd(memory->rates(Eigen::all, columns)) : Eigen::MatrixXd();
  rates(Eigen::all, columns) =
      solve_active(contact, result.active, asked, options.rate_tolerance, start, options.stop).pressure;
  return rates;
}

/// Each bed's rows: by its own bodies' motions, and by those of the others.
void share_out_rates(const Together& all, const Eigen::MatrixXd& rates, std::vector<SpringStates>& states) {
  for (std::size_t b = 0; b < all.beds.size(); ++b) {
    SpringStates& s = states[b];
    if (!all.beds[b].active) continue;
    const auto own = rates.middleRows(all.begin[b], s.size());
    s.rates = own.middleCols<6>(6 * all.pair_of[b]);
    for (std::size_t m = 0; m < all.pairs.size(); ++m) {
      const auto pair = static_cast<Eigen::Index>(m);
      if (pair == all.pair_of[b] || own.middleCols<6>(6 * pair).isZero(0.0)) continue;
      const PosedBed& other = all.bed_of(pair);
      s.cross.push_back({all.pairs[m], other.source.center, other.target.center, own.middleCols<6>(6 * pair)});
    }
  }
}

/// Pressures at these poses; with nothing of how they had changed. Rates stay.
void remember(const Together& all, const Eigen::VectorXd& pressure, PressMemory& memory) {
  memory.pressure = memory.nearly = pressure;
  memory.change = memory.motion = Eigen::VectorXd();
  memory.source.clear();
  memory.target.clear();
  memory.part_rates.clear();
  for (std::size_t m = 0; m < all.pairs.size(); ++m) {
    memory.source.push_back(all.bed_of(static_cast<Eigen::Index>(m)).source);
    memory.target.push_back(all.bed_of(static_cast<Eigen::Index>(m)).target);
  }
}

/// How the nodes of parts move as pressures do.
std::vector<Eigen::MatrixXd> part_rates(const Together& all, const std::vector<PartFeet>& feet,
                                        const Eigen::MatrixXd& rates) {
  std::vector<Eigen::MatrixXd> of_parts;
  for (std::size_t k = 0; k < feet.size(); ++k)
    of_parts.emplace_back(displacements(*all.parts[k], nodal_forces(*all.parts[k], feet[k], rates)));
  return of_parts;
}

}  // namespace

PartMotions motions_to_start_from(const std::vector<PosedBed>& beds, const PressMemory& memory) {
  const Together all(beds);
  PartMotions moved;
  if (memory.part_motion.size() != all.parts.size()) return moved;
  for (std::size_t k = 0; k < all.parts.size(); ++k) moved[all.parts[k]] = memory.part_motion[k];
  if (memory.part_rates.size() != all.parts.size()) return moved;  // nothing pressed, and no poses are remembered
  const Eigen::VectorXd motion = motion_since(memory, all);
  for (std::size_t k = 0; k < all.parts.size(); ++k) moved[all.parts[k]] += by_node(memory.part_rates[k] * motion);
  return moved;
}

bool press_layers(const std::vector<PosedBed>& beds, std::vector<SpringStates>& states, const PressOptions& options,
                  PressMemory* memory, PartMotions& moved, double& misfit) {
  const Together all(beds);
  LayerContact contact;
  contact.interface_compliance = beds.front().bed->pair.interface_compliance;
  contact.area = Eigen::VectorXd::Zero(all.springs());
  if (std::any_of(beds.begin(), beds.end(), [](const PosedBed& b) { return !b.bed->ties.empty(); })) {
    contact.own = Eigen::VectorXd::Zero(all.springs());
    contact.two_sided.assign(at(all.springs()), 0);
  }
  const std::vector<PartFeet> on_parts = feet_on_parts(all, states);
  Eigen::VectorXd overlap = Eigen::VectorXd::Zero(all.springs());  // signed, where no part had moved
  for (std::size_t k = 0; k < on_parts.size(); ++k) {
    contact.parts.push_back({all.parts[k], &on_parts[k]});
    if (const auto motion = moved.find(all.parts[k]); motion != moved.end())
      overlap += along_forces(on_parts[k], motion->second);
  }
  double deepest = 0.0;
  for (std::size_t b = 0; b < beds.size(); ++b) {
    if (!beds[b].active) continue;
    states[b].rates.setZero(states[b].size(), 6);
    for (int i = 0; i < states[b].size(); ++i) {
      double& here = overlap[all.begin[b] + i];
      here = states[b].area[at(i)] > 0 ? here - states[b].gap[at(i)] : 0.0;
      deepest = std::max(deepest, beds[b].bed->ties.empty() ? here : std::abs(here));
    }
  }
  if (!(deepest > 0)) {  // nothing presses parts that had moved: they come back, and may be met there
    const bool rest = moved.empty();
    moved.clear();
    return rest;
  }
  for (std::size_t b = 0; b < beds.size(); ++b) {
    const SpringStates& s = states[b];
    for (int i = 0; i < s.size(); ++i) {
      // nothing bulges by more than it is pressed in elsewhere
      const bool tie = !beds[b].bed->ties.empty();
      double& here = overlap[all.begin[b] + i];
      if (tie && s.area[at(i)] > 0) {
        contact.own[all.begin[b] + i] = 1 / s.per_overlap[at(i)] - contact.interface_compliance;
        contact.two_sided[at(all.begin[b] + i)] = 1;
      }
      if (s.area[at(i)] > 0 && (tie || -here < deepest))
        contact.area[all.begin[b] + i] = s.area[at(i)];
      else
        here = 0.0;
    }
    for (const FootPair& pair : beds[b].bed->layers->pairs) {
      const int first = static_cast<int>(all.begin[b]);
      contact.pairs.push_back({first + pair.i, first + pair.j, pair.compliance});
    }
  }
  const std::vector<LayerFeet> feet = feet_on_layers(all, states, contact.area, deepest);
  for (std::size_t k = 0; k < feet.size(); ++k) contact.layers.push_back({all.layers[k], &feet[k], {}});
  LayerContactOptions search;
  search.tolerance = options.tolerance;
  search.stop = options.stop;
  Eigen::VectorXd start, motion;
  if (memory && memory->pressure.size() > 0) {
    motion = motion_since(*memory, all);
    start = pressures_to_start_from(*memory, motion, std::sqrt(contact.area.sum()));
  }
  constexpr double kFits = 10.0;  // of the tolerance: the same pressures on gaps that were found anew
  if (!all.parts.empty()) search.part_of_first = 0.03;
  const LayerPressure result = solve_contact(contact, overlap, start, search);
  misfit = result.first_residual;
  const bool fits = start.size() > 0 && result.first_residual <= kFits * search.tolerance;
  if (!all.parts.empty() && !fits) {
    for (std::size_t k = 0; k < on_parts.size(); ++k)
      moved[all.parts[k]] =
          by_node(displacements(*all.parts[k], nodal_forces(*all.parts[k], on_parts[k], result.pressure)));
    remember(all, result.pressure, *memory);
    return false;
  }
  Eigen::VectorXd own;  // of feet on parts, in a spring's place
  if (!on_parts.empty()) own = local_compliance(contact);
  for (const PartFeet& on : on_parts) own += Eigen::Map<const Eigen::VectorXd>(on.scale.data(), own.size());
  for (std::size_t b = 0; b < beds.size(); ++b) {
    if (!beds[b].active) continue;
    states[b].complementarity = result.residual;
    states[b].complementary = result.converged;
    for (int i = 0; i < states[b].size(); ++i)
      if (!beds[b].bed->ties.empty())
        states[b].pressure[at(i)] = result.pressure[all.begin[b] + i];
      else if (result.active[at(all.begin[b] + i)])
        set_spring(*beds[b].bed, all.layer_of[b], result, all.begin[b] + i, i, states[b]);
    if (beds[b].bed->ties.empty() && !parts_of(*beds[b].bed).empty())  // a part has no spring: about how a foot resists
      for (int i = 0; i < states[b].size(); ++i)
        if (const double soft = own[all.begin[b] + i]; soft > 0) states[b].per_overlap[at(i)] = 1 / soft;
  }
  std::vector<std::vector<double>> flows(all.layers.size());  // of layers, when they are asked for
  std::vector<std::vector<double>> factors(beds.size());
  for (std::size_t b = 0; b < beds.size(); ++b) {
    const auto flow = [&](bool source) -> const std::vector<double>& {
      const std::size_t layer = at(all.layer_of[b][source ? 0 : 1]);
      if (flows[layer].empty()) flows[layer] = edge_flow(*all.layers[layer], feet[layer], result.pressure);
      return flows[layer];
    };
    if (beds[b].active && beds[b].bed->ties.empty()) factors[b] = press_bulges(beds[b], flow, states[b]);
  }
  const Eigen::MatrixXd rates =
      pressure_rates(all, contact, result, overlap_rates(all, contact, result, states), options, memory);
  share_out_rates(all, rates, states);
  for (std::size_t b = 0; b < beds.size(); ++b)
    for (std::size_t k = 0; k < factors[b].size(); ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      states[b].rates.row(row) *= factors[b][k];
      for (CrossRates& other : states[b].cross) other.rates.row(row) *= factors[b][k];
    }
  if (!memory) return true;
  constexpr double kShare = 0.3;  // of what closes a foot's gap alone: its neighbours press too
  Eigen::VectorXd nearly = result.pressure, change;
  for (Eigen::Index i = 0; i < nearly.size(); ++i)
    if (!result.active[at(i)]) nearly[i] = -kShare * result.apart[i];
  if (motion.size() > 0) change = nearly - memory->nearly;
  remember(all, result.pressure, *memory);
  memory->rates = rates;
  memory->part_rates = part_rates(all, on_parts, rates);
  memory->nearly = std::move(nearly);
  memory->change = std::move(change);
  memory->motion = std::move(motion);
  return true;
}

}  // namespace dea

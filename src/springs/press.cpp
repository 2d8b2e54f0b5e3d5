#include "src/springs/press.h"

#include <algorithm>

#include "src/base/fixed_point.h"
#include "src/base/numbers.h"
#include "src/springs/gaps.h"
#include "src/springs/layer_bed.h"
#include "src/springs/place.h"
#include "src/springs/spring_law.h"

namespace dea {

namespace {

/// Springs that know nothing of each other (S3-S6).
void press_each(const SpringBed& bed, SpringStates& s, const Pose& target) {
  const Layer &source_layer = bed.pair.source_layer(), &target_layer = bed.pair.target_layer();
  const bool at_bone = source_layer.springs_at == SpringsAt::Bone;
  for (int i = 0; i < s.size(); ++i) {
    const auto k = at(i);
    if (!(s.overlap[k] > 0.0)) continue;
    const SpringResponse r = spring_response(bed.pair.law, source_layer.elasticity, target_layer.elasticity,
                                             s.t_source[k], s.t_target[k], s.overlap[k], bed.pair.interface_compliance);
    s.pressure[k] = r.pressure;
    s.strain_source[k] = r.strain_source;
    s.strain_target[k] = r.strain_target;
    s.strain[k] = std::max(r.strain_source, r.strain_target);
    s.per_overlap[k] = r.per_overlap;
    s.per_motion[k] =
        r.per_overlap * overlap_rate(bed, s, i, at_bone ? r.strain_target - 1.0 : r.strain_target, target);
  }
}

std::vector<SpringStates> gaps_of(const std::vector<PosedBed>& beds) {
  std::vector<SpringStates> states(beds.size());
  for (std::size_t b = 0; b < beds.size(); ++b)
    if (beds[b].active)
      states[b] = beds[b].bed->ties.empty() ? find_gaps(*beds[b].bed, beds[b].source, beds[b].target)
                                            : tie_states(*beds[b].bed, beds[b].source, beds[b].target, *beds[b].law);
  return states;
}

Eigen::VectorXd together(const std::vector<const PartOperator*>& parts, const PartMotions& moved) {
  Eigen::Index size = 0;
  for (const PartOperator* part : parts) size += 3 * part->mesh.size();
  Eigen::VectorXd all = Eigen::VectorXd::Zero(size);
  Eigen::Index begin = 0;
  for (const PartOperator* part : parts) {
    const Eigen::Index own = 3 * part->mesh.size();
    if (const auto motion = moved.find(part); motion != moved.end())
      all.segment(begin, own) = motion->second.reshaped();
    begin += own;
  }
  return all;
}

PartMotions apart(const std::vector<const PartOperator*>& parts, const Eigen::VectorXd& all) {
  PartMotions moved;
  Eigen::Index begin = 0;
  for (const PartOperator* part : parts) {
    const Eigen::Index own = 3 * part->mesh.size();
    moved[part] = all.segment(begin, own).reshaped(part->mesh.size(), 3);
    begin += own;
  }
  return moved;
}

/// Law::Layer. What lies opposite a foot is where pressures have moved it to: gaps are found again until the pressures
/// on them are the same; what a part moves besides is linear. Without parts once is enough.
std::vector<SpringStates> press_where_parts_go(const std::vector<PosedBed>& beds, const PressOptions& options,
                                               PressMemory* memory) {
  constexpr int kMostRounds = 60, kInVain = 8;
  const std::vector<const PartOperator*> parts = parts_of(beds);
  PressMemory own;
  if (!parts.empty() && memory == nullptr) memory = &own;
  PartMotions moved;
  if (!parts.empty()) moved = motions_to_start_from(beds, *memory);
  // what presses parts unevenly for want of digits tilts their surfaces, and pushes them along what nothing resists
  constexpr double kCoarsest = 1e-6;
  PressOptions close = options;
  if (!parts.empty()) close.tolerance = std::min(options.tolerance, kCoarsest);
  std::vector<SpringStates> states;
  bool fits = false;
  FixedPoint seek;
  double best = kInfinity, last = kInfinity;
  int no_better = 0;  // rounds
  for (int round = 0; !fits && round < kMostRounds && no_better < kInVain; ++round) {
    std::vector<SpringBed> there;
    there.reserve(beds.size());
    std::vector<PosedBed> posed = beds;
    for (PosedBed& p : posed) {
      if (moved.empty() || parts_of(*p.bed).empty()) continue;
      there.push_back(with_parts_moved(*p.bed, moved));
      p.bed = &there.back();
    }
    states = gaps_of(posed);
    const Eigen::VectorXd before = together(parts, moved);
    double misfit = 0.0;
    fits = press_layers(posed, states, close, memory, moved, misfit);
    if (fits || parts.empty()) break;
    no_better = misfit < 0.7 * best ? 0 : no_better + 1;
    best = std::min(best, misfit);
    // what lies opposite changes on the way: where gaps fit worse than a round before, what was learnt misleads
    if (misfit > last) seek.forget();
    last = misfit;
    if (!moved.empty()) moved = apart(parts, seek.next(before, together(parts, moved)));
  }
  for (std::size_t b = 0; b < beds.size(); ++b) {
    if (!beds[b].active || parts.empty()) continue;
    if (!fits) {
      states[b].complementary = false;
      states[b].complementarity = best;
    }
    for (const bool target : {false, true}) {
      const BedLayer& of = target ? beds[b].bed->layers->target : beds[b].bed->layers->source;
      if (!of.part) continue;
      const auto motion = moved.find(of.part.get());
      states[b].part_motion[target] =
          motion != moved.end() ? motion->second : Eigen::MatrixX3d::Zero(of.part->mesh.size(), 3);
    }
  }
  if (parts.empty()) return states;
  memory->part_motion.clear();
  for (const PartOperator* part : parts)
    memory->part_motion.push_back(moved.count(part) > 0 ? moved[part] : Eigen::MatrixX3d::Zero(part->mesh.size(), 3));
  return states;
}

}  // namespace

SpringStates press_springs(const SpringBed& bed, const Pose& source, const Pose& target, const PressOptions& options,
                           PressMemory* memory) {
  return std::move(press_together({{&bed, source, target, options.motions}}, options, memory).front());
}

std::vector<SpringStates> press_together(const std::vector<PosedBed>& beds, const PressOptions& options,
                                         PressMemory* memory) {
  const bool layers = beds.front().bed->layers != nullptr;
  std::vector<SpringStates> states = layers ? press_where_parts_go(beds, options, memory) : gaps_of(beds);
  for (std::size_t b = 0; b < beds.size(); ++b) {
    SpringStates& s = states[b];
    if (!layers && beds[b].active) press_each(*beds[b].bed, s, beds[b].target);
    const auto bare = [&](const RimSpring& rim) { return s.pressure[at(rim.spring)] <= 0; };
    s.rim.erase(std::remove_if(s.rim.begin(), s.rim.end(), bare), s.rim.end());
    for (RimSpring& rim : s.rim) {
      if (layers) break;  // there it is part of the rates
      const auto k = at(rim.spring);
      rim.pressure_gradient =
          -s.per_motion[k] +
          s.per_overlap[k] * source_overlap_gradient(*beds[b].bed, s, rim.spring, s.strain_source[k], beds[b].source);
    }
  }
  return states;
}

SpringDepth spring_depth(const SpringStates& s) {
  SpringDepth depth;
  for (int i = 0; i < s.size(); ++i) {
    depth.through += s.too_deep[at(i)];
    depth.strained += s.strain[at(i)] > kStrainLimit;
    depth.largest = std::max(depth.largest, s.strain[at(i)]);
  }
  return depth;
}

}  // namespace dea

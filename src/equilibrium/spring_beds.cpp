#include "src/equilibrium/spring_beds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "src/base/disjoint_sets.h"
#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/springs/gaps.h"
#include "src/springs/place.h"

namespace dea {

namespace {

/// Where a contact stands among those it is pressed with: by the nodes of its surfaces.
std::array<std::vector<int>, 2> rank(const ContactPair& pair) {
  std::array<std::vector<int>, 2> nodes = {pair.source_layer().articular.model_nodes,
                                           pair.target_layer().articular.model_nodes};
  for (std::vector<int>& of : nodes) std::sort(of.begin(), of.end());
  return nodes;
}

std::vector<std::vector<int>> groups_of(const std::vector<SpringBed>& beds, const std::vector<SpringBed>& ties) {
  DisjointSets sets(beds.size());
  std::map<const void*, int> first;  // by what gives way
  for (int b = 0; b < static_cast<int>(beds.size()); ++b) {
    if (!beds[at(b)].layers) continue;
    for (const BedLayer* of : {&beds[at(b)].layers->source, &beds[at(b)].layers->target})
      for (const void* key : {static_cast<const void*>(of->layer.get()), static_cast<const void*>(of->part.get())})
        if (key != nullptr) sets.join(first.emplace(key, b).first->second, b);
  }
  for (const SpringBed& tie : ties) {  // two parts that it joins
    const std::vector<const PartOperator*> parts = parts_of(tie);
    if (parts.size() == 2) sets.join(first.at(parts[0]), first.at(parts[1]));
  }
  const std::vector<int> numbers = sets.numbers();
  std::vector<std::vector<int>> groups;
  for (int b = 0; b < static_cast<int>(beds.size()); ++b) {
    const int group = numbers[at(b)];
    if (at(group) == groups.size()) groups.emplace_back();
    groups[at(group)].push_back(b);
  }
  for (std::vector<int>& group : groups)
    if (group.size() > 1)
      std::sort(group.begin(), group.end(),
                [&](int a, int b) { return rank(beds[at(a)].pair) < rank(beds[at(b)].pair); });
  return groups;
}

}  // namespace

namespace {

/// The largest Young's modulus of a part, near enough for a scale.
double stiffest(const SoftPart& part) {
  double most = 0.0;
  for (const Matrix6d& D : part.mesh.elastic) most = std::max(most, D.diagonal().head<3>().maxCoeff());
  return most;
}

}  // namespace

double stiffest_layer(const Joint& joint) {
  double most = 0.0;
  for (const ContactPair& pair : joint.contacts)
    for (const Layer& layer : pair.layers) {
      const double E = layer.part >= 0 ? stiffest(joint.parts[at(layer.part)]) : layer.rigid ? 0.0 : layer.elasticity.E;
      most = std::max(most, E * surface_extent(layer.articular).area);
    }
  return most;
}

namespace {

/// An end of a ligament on a part: its operator and node there; none: the end is the body's own.
struct TieEnd {
  std::shared_ptr<const PartOperator> part;
  int node = -1;
};
TieEnd tie_end(const Joint& joint, const SharedOperators& shared, int model_node) {
  for (std::size_t k = 0; k < joint.parts.size() && model_node >= 0; ++k) {
    const int node = joint.parts[k].node_of(model_node);
    if (const auto made = shared.parts.find(static_cast<int>(k)); node >= 0 && made != shared.parts.end())
      return {made->second, node};
  }
  return {};
}

/// A tie between two bodies: of a part of the first, of the second, or of both.
struct DraftTie {
  PartTie tie;
  int source = -1, target = -1;  ///< bodies
  std::shared_ptr<const PartOperator> of_source, of_target;
};

/// Ligaments on parts that contacts press, and holds of those that two bodies hold.
std::vector<DraftTie> draft_ties(const Joint& joint, const SharedOperators& shared) {
  std::vector<DraftTie> ties;
  for (std::size_t i = 0; i < joint.ligaments.size(); ++i) {
    const Ligament& l = joint.ligaments[i];
    const TieEnd a = tie_end(joint, shared, l.part_node[0]), b = tie_end(joint, shared, l.part_node[1]);
    if (a.part || b.part)
      ties.push_back({{static_cast<int>(i), l.point_a, l.point_b, a.node, b.node}, l.body_a, l.body_b, a.part, b.part});
  }
  for (const auto& [k, made] : shared.parts)
    for (const PartTie& hold : part_holds(joint.parts[at(k)], *made))
      ties.push_back({hold, joint.parts[at(k)].body, joint.parts[at(k)].other, made, nullptr});
  return ties;
}

/// By the bodies and parts that they join. Bodies stand in the order of a contact between them, if there is one.
std::vector<SpringBed> tie_beds(const Joint& joint, const std::vector<SpringBed>& beds, const SharedOperators& shared) {
  std::vector<SpringBed> ties;
  double area = 0.0;
  for (const SpringBed& bed : beds) area += surface_extent(bed.pair.source_layer().articular).area;
  for (DraftTie& draft : draft_ties(joint, shared)) {
    auto& [tie, source, target, of_source, of_target] = draft;
    if (std::any_of(beds.begin(), beds.end(), [&draft](const SpringBed& bed) {
          return bed.source_body == draft.target && bed.target_body == draft.source;
        })) {
      std::swap(tie.source, tie.target);
      std::swap(tie.source_node, tie.target_node);
      std::swap(source, target);
      std::swap(of_source, of_target);
    }
    auto bed = std::find_if(ties.begin(), ties.end(), [&draft](const SpringBed& known) {
      return known.source_body == draft.source && known.target_body == draft.target &&
             known.layers->source.part == draft.of_source && known.layers->target.part == draft.of_target &&
             known.holds() == (draft.tie.ligament < 0);
    });
    if (bed == ties.end()) {
      auto layers = std::make_shared<LayerBed>();
      layers->source.part = of_source;
      layers->target.part = of_target;
      SpringBed made{{},
                     source,
                     target,
                     joint.bodies[at(source)].center_of_mass,
                     joint.bodies[at(target)].center_of_mass,
                     {},
                     RayCaster(SurfaceMesh{}),
                     {},
                     0.0,
                     0.0,
                     0.0,
                     layers,
                     {},
                     0.1 * area};
      ties.push_back(std::move(made));
      bed = ties.end() - 1;
    }
    bed->ties.push_back(tie);
  }
  return ties;
}

/// Operators of the parts that contacts press, made side by side.
SharedOperators pressed_parts(const Joint& joint) {
  std::set<int> pressed;
  for (const ContactPair& pair : joint.contacts)
    for (const Layer& layer : pair.layers)
      if (layer.part >= 0) pressed.insert(layer.part);
  const std::vector<int> parts(pressed.begin(), pressed.end());
  std::vector<std::shared_ptr<const PartOperator>> made(parts.size());
  parallel_for(parts.size(), [&](std::size_t i) { made[i] = make_part(joint, joint.parts[at(parts[i])]); });
  SharedOperators shared;
  for (std::size_t i = 0; i < parts.size(); ++i) shared.parts[parts[i]] = made[i];
  return shared;
}

}  // namespace

SpringBeds make_spring_beds(const Joint& joint, const StopFlag* stop) {
  SpringBeds beds;
  beds.least_thickness = kInfinity;
  double area = 0.0, inertia = 0.0;
  beds.reach = 0.0;
  SharedOperators shared = pressed_parts(joint);
  for (const ContactPair& pair : joint.contacts) {
    end_if_stopped(stop);
    beds.beds.push_back(place_springs(joint, pair, shared));
    for (const Layer& layer : pair.layers) {
      const SurfaceExtent extent = surface_extent(layer.articular);
      area += extent.area;
      inertia += extent.area * extent.radius_of_gyration * extent.radius_of_gyration;
      for (const Vector3d& x : layer.articular.vertices)
        beds.reach = std::max(beds.reach, (x - joint.bodies[at(layer.body)].center_of_mass).norm());
      // a feather edge must not bring the steps to a halt
      if (layer.part >= 0) beds.least_thickness = std::min(beds.least_thickness, joint.parts[at(layer.part)].depth);
      if (!layer.rigid)
        beds.least_thickness =
            std::min(beds.least_thickness, std::max(layer.min_thickness(), 0.1 * layer.mean_thickness()));
    }
  }
  // on the way pressures push parts aside: what lies opposite must not change much in a step
  beds.longest_step = (joint.parts.empty() ? 0.5 : 0.1) * beds.least_thickness;
  beds.ties = tie_beds(joint, beds.beds, shared);
  beds.groups = groups_of(beds.beds, beds.ties);
  for (const std::vector<int>& group : beds.groups) {
    beds.group_ties.emplace_back();
    for (std::size_t t = 0; t < beds.ties.size(); ++t) {
      const PartOperator* part = parts_of(beds.ties[t]).front();
      const auto presses = [&](int c) {
        const std::vector<const PartOperator*> of = parts_of(beds.beds[at(c)]);
        return std::find(of.begin(), of.end(), part) != of.end();
      };
      if (std::any_of(group.begin(), group.end(), presses)) beds.group_ties.back().push_back(static_cast<int>(t));
    }
  }
  beds.stiffest = stiffest_layer(joint);
  beds.length = area > 0 ? std::sqrt(inertia / area) : 1.0;
  return beds;
}

std::vector<PressedContact> press_group(const SpringBeds& beds, const std::vector<int>& group,
                                        const std::vector<Pose>& poses, const std::vector<Motions>& motions,
                                        const std::vector<char>& active, const PressOptions& options,
                                        PressMemory* memory, const TieLaw& law) {
  std::vector<PosedBed> posed;
  for (const int c : group) {
    const SpringBed& bed = beds.beds[at(c)];
    posed.push_back({&bed, poses[at(bed.source_body)], poses[at(bed.target_body)], motions[at(c)], active[at(c)] != 0});
  }
  const std::vector<int>& ties =
      beds.group_ties[at(std::find(beds.groups.begin(), beds.groups.end(), group) - beds.groups.begin())];
  for (const int t : ties) {
    const SpringBed& bed = beds.ties[at(t)];
    const Pose &source = poses[at(bed.source_body)], &target = poses[at(bed.target_body)];
    posed.push_back({&bed, source, target, options.motions, bed.holds() || law, &law});
  }
  std::vector<PressedContact> pressed;
  for (SpringStates& springs : press_together(posed, options, memory)) {
    const PosedBed& of = posed[pressed.size()];
    const ContactWrench wrench = !of.active              ? ContactWrench{}
                                 : !of.bed->ties.empty() ? tie_rates(springs, of.source, of.target)
                                                         : contact_wrench(springs, of.source, of.target);
    pressed.push_back({std::move(springs), wrench});
  }
  return pressed;
}

namespace {

/// Calls `add(triangle, area, force)` with what the contact presses of its side's spring surface.
template <class Add>
void for_pressed_triangles(const SpringBed& bed, const SpringStates& s, int side, const std::vector<Pose>& poses,
                           const Add& add) {
  const RelativePose relative =
      relative_pose(poses[at(bed.source_body)], bed.source_center, poses[at(bed.target_body)], bed.target_center);
  const SurfaceMesh& target = bed.target.mesh();
  for (int i = 0; i < s.size(); ++i) {
    const auto k = at(i);
    if (!(s.pressure[k] > 0) || !(s.area[k] > 0)) continue;
    if (side == bed.pair.source) {
      add(bed.springs.surface_triangle[k], s.area[k], s.pressure[k] * s.area[k]);
      continue;
    }
    const auto parts = parts_under_spring(bed, relative, target, s, i, s.triangle[k], target.size());
    double covered = 0.0;
    for (const SurfacePart& part : parts) covered += part.area;
    for (const SurfacePart& part : parts)
      if (covered > 0)
        add(part.triangle, part.share * target.areas[at(part.triangle)],
            s.pressure[k] * s.area[k] * part.area / covered);
  }
}

}  // namespace

PressedTwice pressed_twice(const Joint& joint, const SpringBeds& beds, const std::vector<SpringStates>& springs,
                           const std::vector<Pose>& poses) {
  PressedTwice worst;
  for (const SharedLayer& layer : joint.shared_layers) {
    std::vector<double> area(at(layer.pressed), 0.0), force(area);
    std::vector<std::vector<int>> contacts(area.size());
    double all = 0.0;
    for (const LayerUse& use : layer.uses)
      for_pressed_triangles(beds.beds[at(use.contact)], springs[at(use.contact)], use.side, poses,
                            [&](int triangle, double a, double f) {
                              const auto t = at(use.triangle[at(triangle)]);
                              area[t] += a;
                              force[t] += f;
                              all += f;
                              if (contacts[t].empty() || contacts[t].back() != use.contact)
                                contacts[t].push_back(use.contact);
                            });
    PressedTwice here;
    std::set<int> by;
    for (std::size_t t = 0; t < area.size(); ++t) {
      const double twice = area[t] - layer.area[t];
      if (contacts[t].size() < 2 || !(twice > 1e-6 * layer.area[t])) continue;
      here.area += twice;
      here.force += force[t] * std::min(1.0, 2 * twice / area[t]);
      by.insert(contacts[t].begin(), contacts[t].end());
    }
    here.share = all > 0 ? here.force / all : 0.0;
    here.contacts.assign(by.begin(), by.end());
    if (here.share > worst.share) worst = std::move(here);
  }
  return worst;
}

}  // namespace dea

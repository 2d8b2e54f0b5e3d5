#include "src/springs/part_bed.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "src/base/numbers.h"
#include "src/springs/gaps.h"
#include "src/springs/place.h"

namespace dea {

namespace {

/// Where the vertices of a side's surface have moved; empty: it is no part's, or has not.
std::vector<Vector3d> moved_vertices(const SurfaceMesh& mesh, const BedLayer& of, const PartMotions& moved) {
  if (!of.part) return {};
  const auto motion = moved.find(of.part.get());
  if (motion == moved.end()) return {};
  std::vector<Vector3d> vertices = mesh.vertices;
  for (std::size_t v = 0; v < vertices.size(); ++v)
    vertices[v] += motion->second.row(of.part_node[v]).transpose();
  return vertices;
}

/// A foot's forces on nodes: one part after the other.
struct FootOnNodes {
  PartFeet& feet;
  const BedLayer& of;
  const SurfaceMesh& mesh;
  /// `area` of a triangle with the mean barycentric weights `w`, pressed along `direction`.
  void add(int triangle, const Barycentric& w, const Vector3d& force) const {
    for (std::size_t c = 0; c < 3; ++c) {
      feet.node.push_back(of.part_node[at(mesh.triangles[at(triangle)][c])]);
      feet.weight.push_back(w[c] * force);
    }
  }
};

/// Mean of the barycentric weights over a part of a triangle.
Barycentric middle_of(const SurfacePart& part) {
  Barycentric sum = {0, 0, 0};
  double all = 0.0;
  for (int k = 1; k + 1 < part.corners; ++k) {  // a fan of triangles, in the plane of the first two weights
    const Barycentric &a = part.corner[0], &b = part.corner[at(k)], &c = part.corner[at(k + 1)];
    const double area = std::abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
    for (std::size_t i = 0; i < 3; ++i) sum[i] += area * (a[i] + b[i] + c[i]) / 3;
    all += area;
  }
  for (std::size_t i = 0; i < 3; ++i) sum[i] = all > 0 ? sum[i] / all : 1.0 / 3;
  return sum;
}

void end_foot(PartFeet& feet, double area, double soft) {
  feet.begin.push_back(static_cast<int>(feet.node.size()));
  feet.area.push_back(area);
  feet.scale.push_back(area > 0 ? 0.5 * soft * std::sqrt(area) : 0.0);  // a half-space under a square: 0.56 (1 - nu^2)
}

}  // namespace

std::shared_ptr<const PartOperator> make_part(const Joint& joint, const SoftPart& of) {
  std::vector<PartHold> hold;
  for (const int body : of.holder)
    hold.push_back(body < 0 ? PartHold::None : body == of.body ? PartHold::Frame : PartHold::Other);
  const Vector3d center = of.other >= 0 ? joint.bodies[at(of.other)].center_of_mass : Vector3d::Zero();
  return std::make_shared<const PartOperator>(make_part_operator(of.mesh, std::move(hold), center));
}

std::vector<const PartOperator*> parts_of(const SpringBed& bed) {
  std::vector<const PartOperator*> parts;
  if (!bed.layers) return parts;
  for (const BedLayer* of : {&bed.layers->source, &bed.layers->target})
    if (of->part && std::find(parts.begin(), parts.end(), of->part.get()) == parts.end())
      parts.push_back(of->part.get());
  return parts;
}

SpringBed with_parts_moved(const SpringBed& bed, const PartMotions& moved) {
  const std::vector<Vector3d> source =
      moved_vertices(bed.pair.source_layer().spring_surface(), bed.layers->source, moved);
  const std::vector<Vector3d> target =
      moved_vertices(bed.pair.target_layer().spring_surface(), bed.layers->target, moved);
  return with_surfaces_at(bed, source, target);
}

void add_feet(const SpringBed& bed, const SpringStates& s, const Pose& source, const Pose& target,
              const PartOperator& part, PartFeet& feet) {
  const bool on_source = bed.layers->source.part.get() == &part, on_target = bed.layers->target.part.get() == &part;
  const RelativePose relative = relative_pose(source, bed.source_center, target, bed.target_center);
  const SurfaceMesh &from = bed.pair.source_layer().spring_surface(), &to = bed.target.mesh();
  for (int i = 0; i < s.size(); ++i) {
    const auto k = at(i);
    const double area = (on_source || on_target) && s.triangle[k] >= 0 ? s.area[k] : 0.0;
    if (on_source && area > 0) {
      const int t = bed.springs.surface_triangle[k];
      const Vector3d foot = bed.source_center + source.rotation.transpose() * (s.foot[k] - source.center);
      FootOnNodes{feet, bed.layers->source, from}.add(
          t, weights_in({from.corner(t, 0), from.corner(t, 1), from.corner(t, 2)}, foot),
          -area * bed.springs.direction[k]);
    }
    if (on_target && area > 0) {
      const std::vector<SurfacePart> under = parts_under_spring(bed, relative, to, s, i, s.triangle[k], to.size());
      double covered = 0.0;
      for (const SurfacePart& p : under) covered += p.area;
      const Vector3d n = relative.rotation * bed.springs.direction[k];
      for (const SurfacePart& p : under)
        if (covered > 0)
          FootOnNodes{feet, bed.layers->target, to}.add(p.triangle, middle_of(p), area * p.area / covered * n);
    }
    end_foot(feet, area, part.softness);
  }
}

std::vector<FootPair> foot_pairs(const Springs& s, const LayerBed& layers) {
  std::vector<FootPair> pairs;
  double soft = 0.0;
  for (const BedLayer* of : {&layers.source, &layers.target}) {
    if (of->layer) return pairs;
    if (of->part) soft += of->part->softness;
  }
  if (!(soft > 0) || s.size() == 0) return pairs;
  // springs that share an edge: parts of one triangle, and of its neighbour; by where their corners are
  using Place = std::array<std::int64_t, 3>;
  std::map<std::array<Place, 2>, int> edges;
  const double grain = 1e-6 * std::sqrt(*std::min_element(s.area.begin(), s.area.end()));
  const auto place = [&](const Vector3d& x) {
    return Place{std::llround(x[0] / grain), std::llround(x[1] / grain), std::llround(x[2] / grain)};
  };
  for (int i = 0; i < s.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      Place a = place(s.triangle[at(i)][c]), b = place(s.triangle[at(i)][(c + 1) % 3]);
      if (b < a) std::swap(a, b);
      const auto known = edges.emplace(std::array<Place, 2>{a, b}, i);
      if (known.second) continue;
      const int j = known.first->second;
      const double area = 0.5 * (s.area[at(i)] + s.area[at(j)]);
      pairs.push_back({j, i, kPairCompliance * soft * area * std::sqrt(area)});
    }
  return pairs;
}

}  // namespace dea

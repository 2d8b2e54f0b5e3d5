#include "src/springs/place.h"

#include <algorithm>
#include <cassert>
#include <memory>
#include <utility>

#include "src/base/numbers.h"
#include "src/springs/layer_bed.h"
#include "src/springs/part_bed.h"

namespace dea {

namespace {

/// One spring per triangle of the source's spring surface, each divided into refine^2 equal ones.
Springs make_springs(const Layer& source, int refine) {
  assert(refine >= 1);
  const SurfaceMesh& mesh = source.spring_surface();
  Springs s;
  const auto parts = triangle_parts(refine);
  const auto part_area = 1.0 / (refine * refine);
  for (int t = 0; t < mesh.size(); ++t)
    for (const auto& w : parts) {
      std::array<Vector3d, 3> corners;
      std::array<double, 3> thickness = {0, 0, 0};
      for (std::size_t c = 0; c < 3; ++c) {
        corners[c] = position(mesh, {t, w[c]});
        thickness[c] = interpolate(mesh, source.thickness, {t, w[c]});
      }
      s.triangle.push_back(corners);
      s.foot.push_back((corners[0] + corners[1] + corners[2]) / 3.0);
      s.direction.push_back(mesh.normals[at(t)]);
      s.area.push_back(mesh.areas[at(t)] * part_area);
      s.corner_thickness.push_back(thickness);
      s.surface_triangle.push_back(t);
      s.bulge.push_back(bulge_height(
          mesh, t,
          {(w[0][0] + w[1][0] + w[2][0]) / 3, (w[0][1] + w[1][1] + w[2][1]) / 3, (w[0][2] + w[1][2] + w[2][2]) / 3}));
      s.weights.push_back(w);
    }
  return s;
}

}  // namespace

namespace {

/// What of a bed depends on where its surfaces are.
void place_target(SpringBed& bed) {
  bed.foot_radius = 0.0;
  for (int i = 0; i < bed.springs.size(); ++i)
    for (const Vector3d& corner : bed.springs.triangle[at(i)])
      bed.foot_radius = std::max(bed.foot_radius, (corner - bed.springs.foot[at(i)]).norm());
  bed.rim_distance = rim_distances(bed.target.mesh(), 4.0 * bed.foot_radius);
}

}  // namespace

SpringBed place_springs_alone(const Joint& joint, const ContactPair& pair) {
  const Layer &source = pair.source_layer(), &target = pair.target_layer();
  SpringBed bed{pair,
                source.body,
                target.body,
                joint.bodies[at(source.body)].center_of_mass,
                joint.bodies[at(target.body)].center_of_mass,
                make_springs(source, pair.refine),
                RayCaster(target.spring_surface()),
                {},
                0.0,
                target.max_thickness(),
                0.0,
                nullptr,
                {},
                0.0};
  for (const Layer& layer : pair.layers)
    if (layer.part >= 0) bed.part_depth += joint.parts[at(layer.part)].depth;
  place_target(bed);
  return bed;
}

namespace {

/// The same springs and target with the vertices of both spring surfaces elsewhere, in the bodies' reference frames;
/// empty: as they are.
SpringBed with_surfaces_at(SpringBed bed, const std::vector<Vector3d>& source, const std::vector<Vector3d>& target) {
  Layer& from = bed.pair.layers[bed.pair.source];
  if (!source.empty()) {
    SurfaceMesh& mesh = from.springs_at == SpringsAt::Bone ? from.bone : from.articular;
    mesh = with_vertices_at(std::move(mesh), source, bed.pair.facets == Facets::Flat);
    bed.springs = make_springs(from, bed.pair.refine);
  }
  if (!target.empty()) {
    Layer& to = bed.pair.layers[1 - bed.pair.source];
    bed.target = RayCaster(with_vertices_at(bed.target.mesh(), target, bed.pair.facets == Facets::Flat));
    (to.springs_at == SpringsAt::Bone ? to.bone : to.articular) = bed.target.mesh();
  }
  if (!source.empty() || !target.empty()) place_target(bed);
  return bed;
}

/// Where the vertices of a side's surface have moved; empty: it is no part's, or has not.
std::vector<Vector3d> moved_vertices(const SurfaceMesh& mesh, const BedLayer& of, const PartMotions& moved) {
  if (!of.part) return {};
  const auto motion = moved.find(of.part.get());
  if (motion == moved.end()) return {};
  std::vector<Vector3d> vertices = mesh.vertices;
  for (std::size_t v = 0; v < vertices.size(); ++v) vertices[v] += motion->second.row(of.part_node[v]).transpose();
  return vertices;
}

/// Each end that is a node of a part, where the part has moved.
std::vector<PartTie> moved_ties(const SpringBed& bed, const PartMotions& moved) {
  std::vector<PartTie> ties = bed.ties;
  const auto move = [&](const BedLayer& of, int node, Vector3d& end) {
    if (node < 0 || !of.part) return;
    if (const auto motion = moved.find(of.part.get()); motion != moved.end())
      end += motion->second.row(node).transpose();
  };
  for (PartTie& tie : ties) {
    move(bed.layers->source, tie.source_node, tie.source);
    move(bed.layers->target, tie.target_node, tie.target);
  }
  return ties;
}

}  // namespace

SpringBed with_parts_moved(const SpringBed& bed, const PartMotions& moved) {
  if (!bed.ties.empty()) {
    SpringBed there = bed;
    there.ties = moved_ties(bed, moved);
    return there;
  }
  const std::vector<Vector3d> source =
      moved_vertices(bed.pair.source_layer().spring_surface(), bed.layers->source, moved);
  const std::vector<Vector3d> target =
      moved_vertices(bed.pair.target_layer().spring_surface(), bed.layers->target, moved);
  return with_surfaces_at(bed, source, target);
}

SpringBed place_springs(const Joint& joint, const ContactPair& pair, SharedOperators& shared) {
  SpringBed bed = place_springs_alone(joint, pair);
  if (bed.pair.law == Law::Layer) {
    const std::shared_ptr<LayerBed> layers = make_layer_bed(joint, pair, shared);
    layers->pairs = foot_pairs(bed.springs, *layers);
    bed.layers = layers;
  }
  return bed;
}

}  // namespace dea

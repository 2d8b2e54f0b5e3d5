#include "src/results/fields.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/results/headline.h"
#include "src/springs/gaps.h"
#include "src/springs/part_bed.h"
#include "src/springs/place.h"
#include "src/springs/spring_law.h"

namespace dea {

namespace {

FieldMaps::LayerMap make_layer_map(const JointModel& model, const Layer& layer, const RayCaster& articular) {
  FieldMaps::LayerMap map;
  const SurfaceMesh& mesh = layer.articular;
  map.facet_area.assign(at(mesh.facets), 0.0);
  std::vector<std::vector<int>> around(mesh.vertices.size());
  for (int t = 0; t < mesh.size(); ++t) {
    map.facet_area[at(mesh.facet[at(t)])] += mesh.areas[at(t)];
    for (int v : mesh.triangles[at(t)]) {
      auto& list = around[at(v)];
      if (list.empty() || std::find(list.begin(), list.end(), mesh.facet[at(t)]) == list.end())
        list.push_back(mesh.facet[at(t)]);
    }
  }
  map.articular_vertex_facet_begin.push_back(0);
  for (const auto& list : around) {
    map.articular_vertex_facets.insert(map.articular_vertex_facets.end(), list.begin(), list.end());
    map.articular_vertex_facet_begin.push_back(static_cast<int>(map.articular_vertex_facets.size()));
  }
  map.vertex_thickness = layer.thickness;
  if (layer.rigid) {
    map.vertex_thickness.assign(mesh.vertices.size(), 0.0);
    return map;
  }
  const RayCaster bone(layer.bone);
  if (layer.springs_at == SpringsAt::Bone) {
    map.articular_to_bone.resize(mesh.vertices.size());
    map.vertex_thickness.assign(mesh.vertices.size(), 0.0);
    parallel_for(mesh.vertices.size(), [&](std::size_t v) {
      map.articular_to_bone[v] = bone.closest(mesh.vertices[v]);
      map.vertex_thickness[v] = interpolate(layer.bone, layer.thickness, map.articular_to_bone[v]);
    });
  }
  map.node_to_articular.resize(layer.region_nodes.size());
  map.node_depth.assign(layer.region_nodes.size(), 0.0);
  parallel_for(layer.region_nodes.size(), [&](std::size_t i) {
    const Vector3d& x = model.nodes[at(layer.region_nodes[i])];
    map.node_to_articular[i] = articular.closest(x);
    const double to_articular = (position(mesh, map.node_to_articular[i]) - x).norm();
    const double to_bone = (position(layer.bone, bone.closest(x)) - x).norm();
    // a node that lies far beside the articular surface (a contact surface on part of the layer) does not move with it
    const double between = to_bone + to_articular;
    double local = interpolate(mesh, map.vertex_thickness, map.node_to_articular[i]) / layer.thickness_scale;
    if (layer.thickness_given) {  // the mesh may be thicker than what is said of it
      const Vector3d foot = position(mesh, map.node_to_articular[i]);
      local = std::max(local, (position(layer.bone, bone.closest(foot)) - foot).norm());
    }
    map.node_depth[i] = between > 0 && between < 1.5 * local ? to_bone / between : 0.0;
  });
  return map;
}

/// Value per vertex from values per facet: area-weighted average of the facets around.
std::vector<double> vertex_average(const FieldMaps::LayerMap& map, const std::vector<double>& facet) {
  std::vector<double> out(map.articular_vertex_facet_begin.size() - 1, 0.0);
  for (std::size_t v = 0; v < out.size(); ++v) {
    double sum = 0.0, area = 0.0;
    for (int i = map.articular_vertex_facet_begin[v]; i < map.articular_vertex_facet_begin[v + 1]; ++i) {
      const int f = map.articular_vertex_facets[at(i)];
      sum += map.facet_area[at(f)] * facet[at(f)];
      area += map.facet_area[at(f)];
    }
    out[v] = area > 0 ? sum / area : 0.0;
  }
  return out;
}

/// Values per triangle or per vertex of one side.
struct SideValues {
  std::vector<double> pressure, overlap, strain, shortening;
  explicit SideValues(std::size_t size)
      : pressure(size, 0.0), overlap(pressure), strain(pressure), shortening(pressure) {}
  /// A share of what a spring has. `t`: the layer's thickness there.
  void add(std::size_t i, double share, double p, double overlap_there, double strain_there, double t) {
    pressure[i] += share * p;
    overlap[i] += share * overlap_there;
    strain[i] += share * strain_there;
    shortening[i] += share * strain_there * t;
  }
};

/// Averages of spring values over the triangles of the surface they stand on, area-weighted (uncovered parts count as
/// 0).
struct SpringAverages {
  SideValues source;
  std::vector<double> target_strain, target_shortening;  // the target's share
  std::vector<double> gap;                               // NaN where no spring of the triangle hit
};

SpringAverages average_springs(const SpringBed& bed, const SpringStates& s) {
  const SurfaceMesh& mesh = bed.pair.source_layer().spring_surface();
  const std::size_t n = mesh.triangles.size();
  const std::vector<double> zero(n, 0.0);
  SpringAverages a{SideValues(n), zero, zero, zero};
  std::vector<double> hit(zero);
  for (int i = 0; i < s.size(); ++i) {
    const auto k = at(i), t = at(bed.springs.surface_triangle[k]);
    const double share = s.area[k] / mesh.areas[t];
    a.source.add(t, share, s.pressure[k], s.overlap[k], s.strain_source[k], s.t_source[k]);
    a.target_strain[t] += share * s.strain_target[k];
    a.target_shortening[t] += share * s.strain_target[k] * s.t_target[k];
    if (s.triangle[k] >= 0) {  // also where the target is passed too deep: that is no gap
      a.gap[t] += bed.springs.area[k] * s.gap[k];
      hit[t] += bed.springs.area[k];
    }
  }
  for (std::size_t t = 0; t < n; ++t) a.gap[t] = hit[t] > 0 ? a.gap[t] / hit[t] : kNaN;
  return a;
}

std::vector<double> triangles_to_facets(const SurfaceMesh& mesh, const FieldMaps::LayerMap& map,
                                        const std::vector<double>& triangle) {
  std::vector<double> out(at(mesh.facets), 0.0);
  for (int t = 0; t < mesh.size(); ++t) out[at(mesh.facet[at(t)])] += mesh.areas[at(t)] * triangle[at(t)];
  for (std::size_t f = 0; f < out.size(); ++f) out[f] = map.facet_area[f] > 0 ? out[f] / map.facet_area[f] : 0.0;
  return out;
}

/// Area-weighted average of triangle values around the vertices of any mesh.
std::vector<double> triangles_to_vertices(const SurfaceMesh& mesh, const std::vector<double>& triangle) {
  std::vector<double> sum(mesh.vertices.size(), 0.0), area(mesh.vertices.size(), 0.0);
  for (int t = 0; t < mesh.size(); ++t) {
    for (int v : mesh.triangles[at(t)]) {
      sum[at(v)] += mesh.areas[at(t)] * triangle[at(t)];
      area[at(v)] += mesh.areas[at(t)];
    }
  }
  for (std::size_t v = 0; v < sum.size(); ++v) sum[v] = area[v] > 0 ? sum[v] / area[v] : 0.0;
  return sum;
}

/// Barycentric weights of the centroids of the divide^2 equal parts of a triangle.
std::vector<std::array<double, 3>> part_centroids(int divide) {
  std::vector<std::array<double, 3>> parts;
  const double third = 1.0 / 3;
  for (int i = 0; i < divide; ++i) {
    for (int j = 0; i + j < divide; ++j) {
      parts.push_back({(divide - i - j - 2 * third) / divide, (i + third) / divide, (j + third) / divide});
      if (i + j + 2 <= divide)
        parts.push_back({(divide - i - j - 4 * third) / divide, (i + 2 * third) / divide, (j + 2 * third) / divide});
    }
  }
  return parts;
}

Vector3d map_resultant(const SurfaceMesh& mesh, const std::vector<double>& facet_pressure,
                       const Eigen::Matrix3d& rotation) {
  Vector3d sum = Vector3d::Zero();
  for (int t = 0; t < mesh.size(); ++t)
    sum -= facet_pressure[at(mesh.facet[at(t)])] * mesh.areas[at(t)] * mesh.normals[at(t)];
  return rotation * sum;
}

void finish_side(SideFields& side, const SurfaceMesh& mesh, const FieldMaps::LayerMap& map, const Pose& pose) {
  side.vertex_thickness = map.vertex_thickness;
  side.contact_area = 0.0;
  for (std::size_t f = 0; f < side.pressure.size(); ++f)
    if (side.pressure[f] > 0) side.contact_area += map.facet_area[f];
  const double force = side.force.norm();
  side.resultant_factor = force > 0 ? map_resultant(mesh, side.pressure, pose.rotation).norm() / force : kNaN;
}

/// One contact at a pose: what its fields are made of. `from`, `to`, `side`: 0 or 1, of `bed.pair.layers`.
struct ContactAt {
  const SpringBed& bed;
  const FieldMaps::ContactMap& map;
  const SpringStates& states;
  const Pose &source_pose, &target_pose;
  const Layer& layer(int side) const { return bed.pair.layers[side]; }
  int source() const { return bed.pair.source; }
  int target() const { return 1 - bed.pair.source; }
  RelativePose on_target() const {
    return relative_pose(source_pose, bed.source_center, target_pose, bed.target_center);
  }
  RelativePose relative(int from) const {
    return from == source() ? on_target()
                            : relative_pose(target_pose, bed.target_center, source_pose, bed.source_center);
  }
};

/// A contact that is not active in this step: geometry only, no overlap that would show as one.
SpringStates inactive_springs(const SpringBed& bed, const Pose& source, const Pose& target) {
  SpringStates s = find_gaps(bed, source, target);
  std::fill(s.overlap.begin(), s.overlap.end(), 0.0);
  return s;
}

/// From values per triangle: of the source's articular springs, whose force its facets carry, or of the target.
void fill_side(const SurfaceMesh& mesh, const FieldMaps::LayerMap& map, const SideValues& v, SideFields& side) {
  side.pressure = triangles_to_facets(mesh, map, v.pressure);
  side.overlap = triangles_to_facets(mesh, map, v.overlap);
  side.strain = triangles_to_facets(mesh, map, v.strain);
  side.vertex_shortening = triangles_to_vertices(mesh, v.shortening);
  side.vertex_pressure = vertex_average(map, side.pressure);
}

/// Springs at the bone: closest-point projection with linear interpolation [Abraham et al. 2013, 2.4]. Returns what the
/// target shows, per articular vertex of the source: no law of the target's own overlap exists.
SideValues source_by_projection(const ContactAt& c, const SpringAverages& averages, SideFields& on_source) {
  const Layer& source = c.layer(c.source());
  const FieldMaps::LayerMap& map = c.map.layers[c.source()];
  const SurfaceMesh& bone = source.spring_surface();
  const auto project = [&](const std::vector<double>& per_triangle) {
    const std::vector<double> bone_vertex = triangles_to_vertices(bone, per_triangle);
    if (source.rigid) return bone_vertex;  // the bone surface is the articular surface
    std::vector<double> out(source.articular.vertices.size());
    for (std::size_t v = 0; v < out.size(); ++v) out[v] = interpolate(bone, bone_vertex, map.articular_to_bone[v]);
    return out;
  };
  SideValues shown(0);
  shown.pressure = project(averages.source.pressure);
  shown.overlap = project(averages.source.overlap);
  shown.strain = project(averages.target_strain);
  shown.shortening = project(averages.target_shortening);
  on_source.vertex_pressure = shown.pressure;
  on_source.vertex_shortening = project(averages.source.shortening);
  on_source.pressure = facet_average(source.articular, map.facet_area, shown.pressure);
  on_source.overlap = facet_average(source.articular, map.facet_area, shown.overlap);
  on_source.strain = facet_average(source.articular, map.facet_area, project(averages.source.strain));
  return shown;
}

/// Distance of a triangle's centroid from the closest point of the other side.
double closest_distance(const ContactAt& c, int from, const RelativePose& relative, int triangle) {
  const Vector3d x = relative.rotation * c.layer(from).articular.centroid(triangle) + relative.shift;
  const int to = 1 - from;
  return (position(c.layer(to).articular, c.map.articular[to].closest(x)) - x).norm();
}

/// Joint space along the normals of one side's own triangles, each sampled at the centroids of its parts.
struct JointSpace {
  std::vector<std::array<double, 3>> parts;  // of each triangle: barycentric weights
  std::vector<SurfacePoint> feet;            // per triangle and part: on the other side; none: no hit
  std::vector<double> gaps;                  // there; infinity: no hit
  std::vector<double> along;  // per triangle: mean of the gaps; without a hit the closest distance of its centroid
};

/// `divide`^2 parts per triangle, so that facets much coarser than the other side's miss nothing.
JointSpace joint_space(const ContactAt& c, int from, int divide) {
  const int to = 1 - from;
  const SurfaceMesh &mesh = c.layer(from).articular, &other = c.layer(to).articular;
  const RelativePose relative = c.relative(from);
  const double deep = c.layer(0).max_thickness() + c.layer(1).max_thickness();
  JointSpace space;
  space.parts = part_centroids(divide);
  const std::size_t parts = space.parts.size();
  space.feet.assign(mesh.triangles.size() * parts, SurfacePoint{});
  space.gaps.assign(space.feet.size(), kInfinity);
  space.along.resize(mesh.triangles.size());
  parallel_for(mesh.size(), [&](int i) {
    const Vector3d n = relative.rotation * mesh.normals[at(i)];
    double sum = 0.0;
    int hits = 0;
    for (std::size_t k = 0; k < parts; ++k) {
      const Vector3d x = relative.rotation * position(mesh, {i, space.parts[k]}) + relative.shift;
      const LineHit hit = c.map.articular[to].nearest_facing(x, n, -4 * deep, -deep, kInfinity);
      if (hit.point.triangle < 0) continue;
      const double gap = hit.distance - bulge_height(mesh, i, space.parts[k]) -
                         bulge_height(other, hit.point.triangle, hit.point.weights);
      space.feet[at(i) * parts + k] = hit.point;
      space.gaps[at(i) * parts + k] = gap;
      sum += gap;
      ++hits;
    }
    space.along[at(i)] = hits > 0 ? sum / hits : closest_distance(c, from, relative, i);
  });
  return space;
}

/// Joint space of the source's triangles where its springs know it already; only where none hit is the closest point
/// asked.
std::vector<double> space_of_springs(const ContactAt& c, std::vector<double> gap) {
  const RelativePose relative = c.on_target();
  parallel_for(c.layer(c.source()).articular.size(), [&](int i) {
    if (std::isnan(gap[at(i)])) gap[at(i)] = closest_distance(c, c.source(), relative, i);
  });
  return gap;
}

/// Per triangle of the target, law layer: each foot's share of every triangle that lies under it (L8).
SideValues target_by_parts(const ContactAt& c) {
  const SurfaceMesh& mesh = c.layer(c.target()).articular;
  const RelativePose relative = c.on_target();
  const SpringStates& s = c.states;
  SideValues v(mesh.triangles.size());
  for (int i = 0; i < s.size(); ++i) {
    const auto k = at(i);
    if (!(s.pressure[k] > 0) && !(s.overlap[k] > 0)) continue;
    const std::vector<SurfacePart> under = parts_under_spring(c.bed, relative, mesh, s, i, s.triangle[k], mesh.size());
    double covered = 0.0;
    for (const SurfacePart& part : under) covered += part.area;
    for (const SurfacePart& part : under) {
      const auto triangle = at(part.triangle);
      const double share = covered > 0 ? part.area / covered * s.area[k] / mesh.areas[triangle] : 0.0;
      v.add(triangle, share, s.pressure[k], s.overlap[k], s.strain_target[k], s.t_target[k]);
    }
  }
  return v;
}

/// Per triangle of the target: the source's values where the target's normals meet it.
SideValues target_by_interpolation(const ContactAt& c, const JointSpace& space, const SideValues& shown) {
  const SurfaceMesh& source = c.layer(c.source()).articular;
  SideValues v(c.layer(c.target()).articular.triangles.size());
  const double share = 1.0 / static_cast<double>(space.parts.size());
  for (std::size_t i = 0; i < space.feet.size(); ++i) {
    if (space.feet[i].triangle < 0) continue;
    const std::size_t triangle = i / space.parts.size();
    v.pressure[triangle] += share * interpolate(source, shown.pressure, space.feet[i]);
    v.overlap[triangle] += share * interpolate(source, shown.overlap, space.feet[i]);
    v.strain[triangle] += share * interpolate(source, shown.strain, space.feet[i]);
    v.shortening[triangle] += share * interpolate(source, shown.shortening, space.feet[i]);
  }
  return v;
}

/// Per triangle of the target: the law at its own overlap; nothing of the source's facets is smeared over it.
SideValues target_by_law(const ContactAt& c, const JointSpace& space) {
  const Layer &source = c.layer(c.source()), &target = c.layer(c.target());
  SideValues v(target.articular.triangles.size());
  const double share = 1.0 / static_cast<double>(space.parts.size());
  for (std::size_t i = 0; i < space.feet.size(); ++i) {
    if (space.feet[i].triangle < 0 || !(space.gaps[i] < 0)) continue;
    const std::size_t triangle = i / space.parts.size();
    const double t_s = interpolate(source.articular, source.thickness, space.feet[i]);
    const double t_t = interpolate(target.articular, target.thickness,
                                   {static_cast<int>(triangle), space.parts[i % space.parts.size()]});
    if (space.gaps[i] <= -(t_s + t_t)) continue;
    const SpringResponse r = spring_response(c.bed.pair.law, source.elasticity, target.elasticity, t_s, t_t,
                                             -space.gaps[i], c.bed.pair.interface_compliance);
    v.add(triangle, share, r.pressure, -space.gaps[i], r.strain_target, t_t);
  }
  return v;
}

/// `force`: of the contact on the target. `active`: in this step.
ContactFields fields_of_contact(const ContactAt& c, const Vector3d& force, bool active) {
  const Layer &source = c.layer(c.source()), &target = c.layer(c.target());
  ContactFields fields;
  SideFields &on_source = fields.sides[c.source()], &on_target = fields.sides[c.target()];
  on_target.force = force;
  on_source.force = -force;
  on_source.springs = true;
  const SpringAverages averages = average_springs(c.bed, c.states);
  const bool articular = source.springs_at == SpringsAt::Articular;
  SideValues shown(0);
  if (articular)
    fill_side(source.articular, c.map.layers[c.source()], averages.source, on_source);
  else
    shown = source_by_projection(c, averages, on_source);
  on_source.joint_space =
      triangles_to_facets(source.articular, c.map.layers[c.source()],
                          articular ? space_of_springs(c, averages.gap) : joint_space(c, c.source(), 1).along);

  const double ratio = std::sqrt(mean_area(target.articular)) / std::sqrt(mean_area(source.articular));
  const int divide = std::clamp(static_cast<int>(std::ceil(ratio - 0.5)), 1, 8);
  const JointSpace space = joint_space(c, c.target(), divide);
  SideValues on_triangles(target.articular.triangles.size());
  if (c.bed.pair.law == Law::Layer)
    on_triangles = target_by_parts(c);
  else if (!articular)
    on_triangles = target_by_interpolation(c, space, shown);
  else if (active)
    on_triangles = target_by_law(c, space);
  on_target.joint_space = triangles_to_facets(target.articular, c.map.layers[c.target()], space.along);
  fill_side(target.articular, c.map.layers[c.target()], on_triangles, on_target);

  finish_side(on_source, source.articular, c.map.layers[c.source()], c.source_pose);
  finish_side(on_target, target.articular, c.map.layers[c.target()], c.target_pose);
  return fields;
}

/// A contact with the surfaces of its parts where these have gone. Facets keep the areas they had, as a layer's do: the
/// map carries the force.
struct MovedContact {
  SpringBed bed;
  FieldMaps::ContactMap map;
};
MovedContact where_parts_are(const SpringBed& bed, const FieldMaps::ContactMap& map, const SpringStates& s) {
  PartMotions moved;
  for (const bool target : {false, true})
    if (const BedLayer& of = target ? bed.layers->target : bed.layers->source; of.part)
      moved[of.part.get()] = s.part_motion[target];
  MovedContact there{with_parts_moved(bed, moved), map};
  for (const int side : {0, 1}) {
    const Layer& layer = there.bed.pair.layers[side];
    if (layer.part >= 0) there.map.articular[side] = RayCaster(layer.articular);
  }
  return there;
}

/// The facets of all surfaces that press a layer.
FieldMaps::SharedMap make_shared_map(const JointModel& model, const Joint& joint, const SharedLayer& layer) {
  FieldMaps::SharedMap map;
  Surface all;
  std::map<std::vector<int>, int> numbers;  // by the facet's nodes, ascending
  all.name = layer.name;
  for (const LayerUse& use : layer.uses) {
    const Surface& surface = model.surfaces[at(joint.contacts[at(use.contact)].layers[use.side].surface)];
    map.facet.emplace_back();
    for (int f = 0; f < surface.size(); ++f) {
      const auto first = surface.nodes.begin() + surface.begin[at(f)],
                 last = surface.nodes.begin() + surface.begin[at(f + 1)];
      std::vector<int> key(first, last);
      std::sort(key.begin(), key.end());
      const auto [known, is_new] = numbers.emplace(std::move(key), static_cast<int>(numbers.size()));
      map.facet.back().push_back(known->second);
      if (!is_new) continue;
      all.nodes.insert(all.nodes.end(), first, last);
      all.begin.push_back(static_cast<int>(all.nodes.size()));
    }
  }
  map.plotted = plotted_surface(model, all);
  return map;
}

}  // namespace

FieldMaps make_field_maps(const JointModel& model, const Joint& joint) {
  FieldMaps maps;
  for (const SharedLayer& layer : joint.shared_layers) maps.shared.push_back(make_shared_map(model, joint, layer));
  for (const ContactPair& pair : joint.contacts) {
    RayCaster primary(pair.layers[0].articular), secondary(pair.layers[1].articular);
    FieldMaps::ContactMap map{
        {make_layer_map(model, pair.layers[0], primary), make_layer_map(model, pair.layers[1], secondary)},
        {std::move(primary), std::move(secondary)},
        plotted_surface(model, model.surfaces[at(pair.source_layer().surface)])};
    maps.contacts.push_back(std::move(map));
  }
  return maps;
}

std::vector<ContactFields> contact_fields(const Joint& joint, const SpringBeds& beds, const FieldMaps& maps,
                                          const Equilibrium& e) {
  std::vector<ContactFields> all;
  for (std::size_t c = 0; c < joint.contacts.size(); ++c) {
    const SpringBed& bed = beds.beds[c];
    const Pose &source = e.poses[at(bed.source_body)], &target = e.poses[at(bed.target_body)];
    const bool active = e.springs[c].size() > 0;
    const SpringStates inactive = active ? SpringStates{} : inactive_springs(bed, source, target);
    const Vector3d force = e.contact_on_target[c].head<3>();
    if (active && !parts_of(bed).empty()) {
      const MovedContact there = where_parts_are(bed, maps.contacts[c], e.springs[c]);
      all.push_back(fields_of_contact({there.bed, there.map, e.springs[c], source, target}, force, active));
      continue;
    }
    all.push_back(
        fields_of_contact({bed, maps.contacts[c], active ? e.springs[c] : inactive, source, target}, force, active));
  }
  return all;
}

const std::vector<FacetField>& facet_fields() {
  static const std::vector<FacetField> fields = {{"contact pressure", "pressure", "P", &SideFields::pressure},
                                                 {"joint space", "joint_space", "L", &SideFields::joint_space},
                                                 {"overlap", "overlap", "L", &SideFields::overlap},
                                                 {"spring strain", "strain", "", &SideFields::strain}};
  return fields;
}

const std::vector<FacetField>& inside_facet_fields() {
  using F = SideFields;
  static const std::vector<FacetField> fields = {
      {"max shear stress at the bone", "bone_max_shear_stress", "P", &F::bone_max_shear},
      {"first principal strain at the bone", "bone_first_principal_strain", "", &F::bone_first_strain},
      {"third principal strain at the bone", "bone_third_principal_strain", "", &F::bone_third_strain},
      {"max shear stress at the surface", "surface_max_shear_stress", "P", &F::surface_max_shear},
      {"first principal strain at the surface", "surface_first_principal_strain", "", &F::surface_first_strain},
      {"third principal strain at the surface", "surface_third_principal_strain", "", &F::surface_third_strain}};
  return fields;
}

SideFields added_sides(const std::vector<const SideFields*>& sides) {
  SideFields sum = *sides.front();
  const auto add = [](std::vector<double>& to, const std::vector<double>& more) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += more[i];
  };
  std::vector<const SideFields*> nearest(sum.pressure.size(), sides.front());  // per facet
  for (std::size_t i = 1; i < sides.size(); ++i) {
    const SideFields& side = *sides[i];
    for (std::size_t f = 0; f < nearest.size(); ++f) {
      const SideFields& best = *nearest[f];
      const bool harder = side.pressure[f] > best.pressure[f];
      if (harder || (side.pressure[f] == best.pressure[f] && side.joint_space[f] < best.joint_space[f]))
        nearest[f] = &side;
    }
    for (std::size_t v = 0; v < sum.vertex_shortening.size(); ++v)
      sum.vertex_shortening[v] = std::max(sum.vertex_shortening[v], side.vertex_shortening[v]);
    add(sum.pressure, side.pressure);
    add(sum.vertex_pressure, side.vertex_pressure);
    sum.force += side.force;
    sum.contact_area += side.contact_area;
    sum.springs = sum.springs || side.springs;
  }
  for (const auto& table : {facet_fields(), inside_facet_fields()})
    for (const FacetField& field : table) {
      if (field.values == &SideFields::pressure) continue;
      std::vector<double>& values = sum.*field.values;
      for (std::size_t f = 0; f < values.size(); ++f)
        if (const std::vector<double>& of_nearest = nearest[f]->*field.values; f < of_nearest.size())
          values[f] = of_nearest[f];
    }
  return sum;
}

const Eigen::MatrixX3d* part_motion(const Joint& joint, const Equilibrium& e, int part) {
  for (std::size_t c = 0; c < joint.contacts.size(); ++c)
    for (const int side : {0, 1})
      if (const Eigen::MatrixX3d& motion = e.springs[c].part_motion[at(side == joint.contacts[c].source ? 0 : 1)];
          joint.contacts[c].layers[side].part == part && motion.rows() > 0)
        return &motion;
  return nullptr;
}

std::vector<Vector3d> part_displacements(const Joint& joint, const Equilibrium& e, int part) {
  const Eigen::MatrixX3d* motion = part_motion(joint, e, part);
  if (motion == nullptr) return {};
  const SoftPart& of = joint.parts[at(part)];
  const Pose& pose = e.poses[at(of.body)];
  std::vector<Vector3d> moved;
  for (int i = 0; i < of.mesh.size(); ++i) {
    const Vector3d& x = of.mesh.nodes[at(i)];
    moved.push_back(pose.center - x +
                    pose.rotation * (x + motion->row(i).transpose() - joint.bodies[at(of.body)].center_of_mass));
  }
  return moved;
}

std::vector<Vector3d> node_displacements(const JointModel& model, const Joint& joint, const FieldMaps& maps,
                                         const Equilibrium& e, const std::vector<ContactFields>& fields, bool squash) {
  std::vector<Vector3d> u(model.nodes.size(), Vector3d::Zero());
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    const int b = joint.node_body[i];
    if (b < 0) continue;
    const Pose& pose = e.poses[at(b)];
    u[i] = pose.center + pose.rotation * (model.nodes[i] - joint.bodies[at(b)].center_of_mass) - model.nodes[i];
  }
  for (std::size_t k = 0; k < joint.parts.size(); ++k) {
    const std::vector<Vector3d> moved = part_displacements(joint, e, static_cast<int>(k));
    for (std::size_t i = 0; i < moved.size(); ++i) u[at(joint.parts[k].model_nodes[i])] = moved[i];
  }
  if (!squash) return u;
  for (std::size_t c = 0; c < joint.contacts.size(); ++c) {
    for (int side = 0; side < 2; ++side) {
      const Layer& layer = joint.contacts[c].layers[side];
      const FieldMaps::LayerMap& map = maps.contacts[c].layers[side];
      const Pose& pose = e.poses[at(layer.body)];
      for (std::size_t i = 0; i < map.node_depth.size(); ++i) {
        const SurfacePoint& p = map.node_to_articular[i];
        const double shortening = interpolate(layer.articular, fields[c].sides[side].vertex_shortening, p);
        if (shortening <= 0) continue;
        Vector3d normal = Vector3d::Zero();
        for (std::size_t k = 0; k < 3; ++k)
          normal += p.weights[k] * layer.articular.vertex_normals[at(layer.articular.triangles[at(p.triangle)][k])];
        u[at(layer.region_nodes[i])] -= map.node_depth[i] * shortening * (pose.rotation * normal.normalized());
      }
    }
  }
  return u;
}

}  // namespace dea

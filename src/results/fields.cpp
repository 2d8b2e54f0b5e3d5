#include <febiodea/results/fields.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include <febiodea/base/numbers.h>
#include <febiodea/springs/gaps.h>
#include <febiodea/springs/press.h>
#include <febiodea/springs/spring_law.h>

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
    tbb::parallel_for(std::size_t{0}, mesh.vertices.size(), [&](std::size_t v) {
      map.articular_to_bone[v] = bone.closest(mesh.vertices[v]);
      map.vertex_thickness[v] = interpolate(layer.bone, layer.thickness, map.articular_to_bone[v]);
    });
  }
  map.node_to_articular.resize(layer.region_nodes.size());
  map.node_depth.assign(layer.region_nodes.size(), 0.0);
  tbb::parallel_for(std::size_t{0}, layer.region_nodes.size(), [&](std::size_t i) {
    const Vector3d& x = model.nodes[at(layer.region_nodes[i])];
    map.node_to_articular[i] = articular.closest(x);
    const double to_articular = (position(mesh, map.node_to_articular[i]) - x).norm();
    const double to_bone = (position(layer.bone, bone.closest(x)) - x).norm();
    // a node that lies far beside the articular surface (a contact surface on part of the layer) does not move with it
    const double between = to_bone + to_articular,
                 local = interpolate(mesh, map.vertex_thickness, map.node_to_articular[i]);
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

/// Value per facet from values per vertex: mean over the facet of the linear interpolation.
std::vector<double> facet_average(const SurfaceMesh& mesh, const FieldMaps::LayerMap& map,
                                  const std::vector<double>& vertex) {
  std::vector<double> out(at(mesh.facets), 0.0);
  for (int t = 0; t < mesh.size(); ++t) {
    double mean = 0.0;
    for (int v : mesh.triangles[at(t)]) mean += vertex[at(v)] / 3.0;
    out[at(mesh.facet[at(t)])] += mesh.areas[at(t)] * mean;
  }
  for (std::size_t f = 0; f < out.size(); ++f) out[f] = map.facet_area[f] > 0 ? out[f] / map.facet_area[f] : 0.0;
  return out;
}

/// Averages of spring values over the triangles of the surface they stand on, area-weighted (uncovered parts count as
/// 0).
struct SpringAverages {
  std::vector<double> pressure, overlap, strain, shortening;  // per triangle
  std::vector<double> gap;                                    // NaN where no spring of the triangle hit
};

SpringAverages average_springs(const SpringBed& bed, const SpringStates& s) {
  const SurfaceMesh& mesh = bed.pair.source_layer().spring_surface();
  const std::size_t n = mesh.triangles.size();
  SpringAverages a;
  a.pressure.assign(n, 0.0);
  a.overlap = a.strain = a.shortening = a.pressure;
  a.gap.assign(n, 0.0);
  std::vector<double> hit(n, 0.0);
  for (int i = 0; i < s.size(); ++i) {
    const auto k = at(i), t = at(bed.springs.surface_triangle[k]);
    const double share = s.area[k] / mesh.areas[t];
    a.pressure[t] += share * s.pressure[k];
    a.overlap[t] += share * s.overlap[k];
    a.strain[t] += share * s.strain_source[k];
    a.shortening[t] += share * s.strain_source[k] * s.t_source[k];
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

double mean_facet_size(const SurfaceMesh& mesh) {
  double area = 0.0;
  for (double a : mesh.areas) area += a;
  return std::sqrt(area / std::max(1, mesh.size()));
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

}  // namespace

FieldMaps make_field_maps(const JointModel& model, const Joint& joint) {
  FieldMaps maps;
  for (const ContactPair& pair : joint.contacts) {
    RayCaster primary(pair.layers[0].articular), secondary(pair.layers[1].articular);
    FieldMaps::ContactMap map{
        {make_layer_map(model, pair.layers[0], primary), make_layer_map(model, pair.layers[1], secondary)},
        {std::move(primary), std::move(secondary)}};
    maps.contacts.push_back(std::move(map));
  }
  return maps;
}

std::vector<ContactFields> contact_fields(const Joint& joint, const SpringBeds& beds, const FieldMaps& maps,
                                          const Equilibrium& e) {
  std::vector<ContactFields> all;
  for (std::size_t c = 0; c < joint.contacts.size(); ++c) {
    const ContactPair& pair = joint.contacts[c];
    const SpringBed& bed = beds.beds[c];
    const FieldMaps::ContactMap& map = maps.contacts[c];
    const int s = pair.source, t = 1 - pair.source;
    const Layer &source = pair.layers[s], &target = pair.layers[t];
    const Pose &source_pose = e.poses[at(bed.source_body)], &target_pose = e.poses[at(bed.target_body)];
    ContactFields fields;
    SideFields &on_source = fields.sides[s], &on_target = fields.sides[t];
    on_target.force = e.contact_on_target[c].head<3>();
    on_source.force = -on_target.force;

    const bool contact_active = e.springs[c].size() > 0;
    SpringStates inactive;
    const SpringStates* states = &e.springs[c];
    if (states->size() == 0) {  // contact not active in this step: geometry only, no pressure
      inactive = press_springs(bed, source_pose, target_pose);
      std::fill(inactive.pressure.begin(), inactive.pressure.end(), 0.0);
      std::fill(inactive.overlap.begin(), inactive.overlap.end(), 0.0);
      std::fill(inactive.strain_source.begin(), inactive.strain_source.end(), 0.0);
      std::fill(inactive.strain_target.begin(), inactive.strain_target.end(), 0.0);
      states = &inactive;
    }
    const SpringAverages averages = average_springs(bed, *states);

    // The target's share of the shortening, per triangle of the source's spring surface, to be interpolated from there.
    std::vector<double> target_shortening(averages.pressure.size(), 0.0), target_strain(averages.pressure.size(), 0.0);
    for (int i = 0; i < states->size(); ++i) {
      const auto k = at(i), tri = at(bed.springs.surface_triangle[k]);
      const double share = states->area[k] / source.spring_surface().areas[tri];
      target_shortening[tri] += share * states->strain_target[k] * states->t_target[k];
      target_strain[tri] += share * states->strain_target[k];
    }

    // What the target shows is the source's where no law of the target's own overlap exists.
    const bool by_interpolation = source.springs_at == SpringsAt::Bone, by_parts = bed.law == Law::Layer;
    // Source side. Articular springs: facets carry their springs' force. Bone springs: closest-point projection with
    // linear interpolation [Abraham et al. 2013, 2.4].
    std::vector<double> v_pressure, v_overlap, v_target_strain,
        v_target_shortening;  // bone springs: per articular vertex of the source
    if (source.springs_at == SpringsAt::Articular) {
      on_source.pressure = triangles_to_facets(source.articular, map.layers[s], averages.pressure);
      on_source.overlap = triangles_to_facets(source.articular, map.layers[s], averages.overlap);
      on_source.strain = triangles_to_facets(source.articular, map.layers[s], averages.strain);
      on_source.vertex_shortening = triangles_to_vertices(source.articular, averages.shortening);
      on_source.vertex_pressure = vertex_average(map.layers[s], on_source.pressure);
    } else {
      const SurfaceMesh& bone = source.spring_surface();
      const auto project = [&](const std::vector<double>& per_triangle) {
        const std::vector<double> bone_vertex = triangles_to_vertices(bone, per_triangle);
        if (source.rigid) return bone_vertex;  // the bone surface is the articular surface
        std::vector<double> out(source.articular.vertices.size());
        for (std::size_t v = 0; v < out.size(); ++v)
          out[v] = interpolate(bone, bone_vertex, map.layers[s].articular_to_bone[v]);
        return out;
      };
      v_pressure = project(averages.pressure);
      v_overlap = project(averages.overlap);
      v_target_strain = project(target_strain);
      v_target_shortening = project(target_shortening);
      on_source.vertex_pressure = v_pressure;
      on_source.vertex_shortening = project(averages.shortening);
      on_source.pressure = facet_average(source.articular, map.layers[s], v_pressure);
      on_source.overlap = facet_average(source.articular, map.layers[s], v_overlap);
      on_source.strain = facet_average(source.articular, map.layers[s], project(averages.strain));
    }

    // Joint space: along the normals of each side's own facets to the other side; no hit: closest distance. Each
    // triangle is sampled at the centroids of `divide`^2 parts, so that facets much coarser than the other side's miss
    // nothing.
    const auto space = [&](int from, int to, const Pose& from_pose, const Pose& to_pose, int divide,
                           std::vector<SurfacePoint>* feet, std::vector<double>* gaps, std::vector<double>* along) {
      const SurfaceMesh& mesh = pair.layers[from].articular;
      const Vector3d from_center = joint.bodies[at(pair.layers[from].body)].center_of_mass,
                     to_center = joint.bodies[at(pair.layers[to].body)].center_of_mass;
      const RelativePose relative = relative_pose(from_pose, from_center, to_pose, to_center);
      const double deep = pair.layers[0].max_thickness() + pair.layers[1].max_thickness();
      const std::vector<std::array<double, 3>> parts = part_centroids(divide);
      feet->assign(mesh.triangles.size() * parts.size(), SurfacePoint{});
      gaps->assign(feet->size(), kInfinity);
      along->resize(mesh.triangles.size());
      tbb::parallel_for(0, mesh.size(), [&](int i) {
        const Vector3d n = relative.rotation * mesh.normals[at(i)];
        double sum = 0.0;
        int hits = 0;
        for (std::size_t k = 0; k < parts.size(); ++k) {
          const Vector3d x = relative.rotation * position(mesh, {i, parts[k]}) + relative.shift;
          const LineHit hit = map.articular[to].nearest_facing(x, n, -4 * deep, -deep, kInfinity);
          if (hit.point.triangle < 0) continue;
          const double gap = hit.distance - bulge_height(mesh, i, parts[k]) -
                             bulge_height(pair.layers[to].articular, hit.point.triangle, hit.point.weights);
          (*feet)[at(i) * parts.size() + k] = hit.point;
          (*gaps)[at(i) * parts.size() + k] = gap;
          sum += gap;
          ++hits;
        }
        if (hits > 0) {
          (*along)[at(i)] = sum / hits;
        } else {
          const Vector3d x = relative.rotation * mesh.centroid(i) + relative.shift;
          (*along)[at(i)] = (position(pair.layers[to].articular, map.articular[to].closest(x)) - x).norm();
        }
      });
    };
    std::vector<SurfacePoint> feet;
    std::vector<double> gaps, along;
    if (source.springs_at == SpringsAt::Articular) {
      // the springs know it already; only where none hit is the closest point asked
      along = averages.gap;
      const RelativePose relative = relative_pose(source_pose, bed.source_center, target_pose, bed.target_center);
      tbb::parallel_for(0, source.articular.size(), [&](int i) {
        if (!std::isnan(along[at(i)])) return;
        const Vector3d x = relative.rotation * source.articular.centroid(i) + relative.shift;
        along[at(i)] = (position(target.articular, map.articular[t].closest(x)) - x).norm();
      });
    } else {
      space(s, t, source_pose, target_pose, 1, &feet, &gaps, &along);
    }
    on_source.joint_space = triangles_to_facets(source.articular, map.layers[s], along);

    // Target side, where its own normals meet the source.
    const int divide = std::clamp(
        static_cast<int>(std::ceil(mean_facet_size(target.articular) / mean_facet_size(source.articular) - 0.5)), 1, 8);
    space(t, s, target_pose, source_pose, divide, &feet, &gaps, &along);
    on_target.joint_space = triangles_to_facets(target.articular, map.layers[t], along);
    const std::size_t parts = feet.size() / std::max<std::size_t>(1, target.articular.triangles.size());
    std::vector<double> pressure(target.articular.triangles.size(), 0.0), overlap = pressure, strain = pressure,
                                                                          shortening = pressure;
    const std::vector<std::array<double, 3>> samples = part_centroids(divide);
    if (by_parts) {  // each foot's share of every triangle of the target that lies under it (L8)
      const RelativePose relative = relative_pose(source_pose, bed.source_center, target_pose, bed.target_center);
      for (int i = 0; i < states->size(); ++i) {
        const auto k = at(i);
        if (!(states->pressure[k] > 0) && !(states->overlap[k] > 0)) continue;
        const std::vector<SurfacePart> under = parts_under_spring(bed, relative, target.articular, *states, i,
                                                                  states->triangle[k], target.articular.size());
        double covered = 0.0;
        for (const SurfacePart& part : under) covered += part.area;
        for (const SurfacePart& part : under) {
          const auto triangle = at(part.triangle);
          const double share =
              covered > 0 ? part.area / covered * states->area[k] / target.articular.areas[triangle] : 0.0;
          pressure[triangle] += share * states->pressure[k];
          overlap[triangle] += share * states->overlap[k];
          strain[triangle] += share * states->strain_target[k];
          shortening[triangle] += share * states->strain_target[k] * states->t_target[k];
        }
      }
    }
    for (std::size_t i = 0; i < feet.size(); ++i) {
      if (feet[i].triangle < 0 || by_parts) continue;
      const std::size_t triangle = i / parts;
      const double share = 1.0 / static_cast<double>(parts);
      if (by_interpolation) {
        pressure[triangle] += share * interpolate(source.articular, v_pressure, feet[i]);
        overlap[triangle] += share * interpolate(source.articular, v_overlap, feet[i]);
        strain[triangle] += share * interpolate(source.articular, v_target_strain, feet[i]);
        shortening[triangle] += share * interpolate(source.articular, v_target_shortening, feet[i]);
      } else if (contact_active && gaps[i] < 0) {
        // the law at the target's own overlap: nothing of the source's facets is smeared over the target's
        const double t_s = interpolate(source.articular, source.thickness, feet[i]);
        const double t_t =
            interpolate(target.articular, target.thickness, {static_cast<int>(triangle), samples[i % parts]});
        if (gaps[i] <= -(t_s + t_t)) continue;
        const SpringResponse r = spring_response(bed.law, source.elasticity, target.elasticity, t_s, t_t, -gaps[i],
                                                 pair.interface_compliance);
        pressure[triangle] += share * r.pressure;
        overlap[triangle] -= share * gaps[i];
        strain[triangle] += share * r.strain_target;
        shortening[triangle] += share * r.strain_target * t_t;
      }
    }
    on_target.pressure = triangles_to_facets(target.articular, map.layers[t], pressure);
    on_target.overlap = triangles_to_facets(target.articular, map.layers[t], overlap);
    on_target.strain = triangles_to_facets(target.articular, map.layers[t], strain);
    on_target.vertex_shortening = triangles_to_vertices(target.articular, shortening);
    on_target.vertex_pressure = vertex_average(map.layers[t], on_target.pressure);

    finish_side(on_source, source.articular, map.layers[s], source_pose);
    finish_side(on_target, target.articular, map.layers[t], target_pose);
    all.push_back(std::move(fields));
  }
  return all;
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

#include "src/build/layer_sheet.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "src/base/disjoint_sets.h"
#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/build/mend_surface.h"
#include "src/build/region.h"
#include "src/geometry/thickness.h"

namespace dea {

namespace {

using Eigen::Vector3d;
using Triangle = std::array<int, 3>;

/// Least Jacobian at the six corners of a prism, scaled by its edges: 1 for a straight prism on an equilateral
/// triangle.
double prism_jacobian(const std::array<Vector3d, 3>& bottom, const std::array<Vector3d, 3>& top) {
  const double kEquilateral = std::sqrt(3.0) / 2;
  double least = kInfinity;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3d up = top[k] - bottom[k];
    for (const auto* face : {&bottom, &top}) {
      const Vector3d a = (*face)[(k + 1) % 3] - (*face)[k], b = (*face)[(k + 2) % 3] - (*face)[k];
      const double scale = a.norm() * b.norm() * up.norm() * kEquilateral;
      least = std::min(least, scale > 0 ? a.cross(b).dot(up) / scale : 0.0);
    }
  }
  return least;
}

double column_jacobian(const BuiltLayer& layer, const Triangle& t, int elements_through, int element) {
  std::array<Vector3d, 3> bottom, top;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3d &b = layer.bone[at(t[k])], &a = layer.articular[at(t[k])];
    bottom[k] = b + (a - b) * element / elements_through;
    top[k] = b + (a - b) * (element + 1) / elements_through;
  }
  return prism_jacobian(bottom, top);
}

}  // namespace

std::vector<double> layer_thickness(const BuiltLayer& layer) {
  std::vector<double> thickness;
  for (std::size_t v = 0; v < layer.bone.size(); ++v) thickness.push_back((layer.articular[v] - layer.bone[v]).norm());
  const SurfaceMesh face = mesh_of(layer.face());
  const std::vector<double> measured = measure_thickness(face, mesh_of({layer.bone, layer.triangles})).thickness;
  for (std::size_t v = 0; v < measured.size(); ++v) thickness[at(face.model_nodes[v])] = measured[v];
  return thickness;
}

SheetQuality sheet_quality(const BuiltLayer& layer, int elements_through) {
  SheetQuality q;
  q.area = area_of(layer.face());
  q.mean_edge = mean_edge(layer.face());
  if (layer.bare) return q;
  q.least_jacobian = q.least_thickness = kInfinity;
  for (const double jacobian : prism_jacobians(layer, elements_through)) {
    q.least_jacobian = std::min(q.least_jacobian, jacobian);
    q.mean_jacobian += jacobian / static_cast<double>(layer.triangles.size()) / elements_through;
    q.inside_out += jacobian <= 0;
  }
  const std::vector<double> areas = point_areas(layer.face());
  const std::vector<double>& thickness = q.thickness = layer_thickness(layer);
  for (std::size_t v = 0; v < thickness.size(); ++v) {
    q.least_thickness = std::min(q.least_thickness, thickness[v]);
    q.most_thickness = std::max(q.most_thickness, thickness[v]);
    q.mean_thickness += thickness[v] * areas[v] / q.area;
    q.mean_line += (layer.articular[v] - layer.bone[v]).norm() * areas[v] / q.area;
  }
  return q;
}

ThinPlaces thin_places(const BuiltLayer& layer, const std::vector<double>& thickness, double least) {
  ThinPlaces thin{least, 0.0, kInfinity, {}};
  const std::vector<double> areas = point_areas(layer.face());
  double all = 0;
  for (std::size_t v = 0; v < thickness.size(); ++v) {
    all += areas[v];
    if (thickness[v] < (1 - kMuchThinned) * least) thin.part += areas[v];
    if (thickness[v] >= thin.thinnest) continue;
    thin.thinnest = thickness[v];
    thin.where = layer.articular[v];
  }
  thin.part /= all;
  return thin;
}

std::vector<double> prism_jacobians(const BuiltLayer& layer, int elements_through) {
  std::vector<double> all;
  if (layer.bare) return all;
  for (const Triangle& t : layer.triangles)
    for (int e = 0; e < elements_through; ++e) all.push_back(column_jacobian(layer, t, elements_through, e));
  return all;
}

SheetRim sheet_rim(const BuiltLayer& layer) {
  SheetRim rim;
  const TriangleSurface face = layer.face();
  const auto thickness = [&](int v) { return layer.bare ? 0.0 : (layer.articular[at(v)] - layer.bone[at(v)]).norm(); };
  DisjointSets lines(face.points.size());
  std::vector<char> on_rim(face.points.size(), 0);
  for (const auto& edge : rim_edges(face.triangles, edge_neighbours(face.triangles))) {
    const int a = edge[0], b = edge[1];
    const double length = (face.points[at(a)] - face.points[at(b)]).norm();
    rim.length += length;
    rim.thickness += length * (thickness(a) + thickness(b)) / 2;
    on_rim[at(a)] = on_rim[at(b)] = 1;
    lines.join(a, b);
  }
  for (std::size_t v = 0; v < on_rim.size(); ++v)
    rim.rims += on_rim[v] && lines.root(static_cast<int>(v)) == static_cast<int>(v);
  if (rim.length > 0) rim.thickness /= rim.length;
  return rim;
}

void fade_at_rim(std::vector<double>& thickness, const std::vector<double>& rim, double fade, double least) {
  for (std::size_t i = 0; i < thickness.size(); ++i) {
    const double s = std::min(1.0, rim[i] / fade);
    thickness[i] = std::min(thickness[i], least) + std::max(0.0, thickness[i] - least) * s * s * (3 - 2 * s);
  }
}

void fade_layer(BuiltLayer& layer, double fade, double least, int elements_through, SheetChanges& changes) {
  std::vector<double> was, thickness;
  for (std::size_t v = 0; v < layer.bone.size(); ++v) was.push_back((layer.articular[v] - layer.bone[v]).norm());
  thickness = was;
  fade_at_rim(thickness, distances_to_rim(layer.face()), fade, least);
  for (std::size_t v = 0; v < was.size(); ++v)
    layer.articular[v] = layer.bone[v] + thickness[v] / was[v] * (layer.articular[v] - layer.bone[v]);
  changes.wanted = thickness;
  make_sound(layer, {elements_through, true, nullptr, 0.0, {}}, changes);
}

BuiltLayer layer_on_bone(const TriangleSurface& region, const std::vector<Vector3d>& directions,
                         const std::vector<double>& thickness, int elements_through, SheetChanges& changes) {
  BuiltLayer layer;
  layer.triangles = region.triangles;
  layer.bone = region.points;
  for (std::size_t v = 0; v < thickness.size(); ++v)
    layer.articular.push_back(region.points[v] + thickness[v] * directions[v]);
  make_sound(layer, {elements_through, true, nullptr, 0.0, {}}, changes);
  return layer;
}

Beneath bone_beneath(const TriangleSurface& articular, const RayCaster& bone) {
  std::vector<Vector3d> inwards = point_normals(articular);
  for (Vector3d& n : inwards) n = -n;
  const std::vector<Vector3d> at_vertices = angle_weighted_normals(bone.mesh());
  const std::size_t n = articular.points.size();
  Beneath beneath{facing_gaps(articular.points, inwards, bone, kInfinity), std::vector<char>(n, 0),
                  std::vector<char>(n, 0), std::vector<double>(n, 0.0), std::vector<char>(n, 0)};
  parallel_for(n, [&](std::size_t v) {
    if (std::isfinite(beneath.thickness[v])) return;
    const double distance = signed_distance(bone, at_vertices, articular.points[v]);
    beneath.missed[v] = 1;
    beneath.beside[v] = on_open_edge(bone.mesh(), bone.closest(articular.points[v]));
    if (beneath.beside[v]) return;
    beneath.under[v] = distance < 0;
    beneath.thickness[v] = std::max(0.0, distance);
    beneath.depth[v] = std::max(0.0, -distance);
  });
  // nothing beneath, and no inside to lie in
  fill_unknown(articular, beneath.thickness, 0.0);
  return beneath;
}

BuiltLayer layer_under_surface(const TriangleSurface& articular, const Beneath& beneath, const RayCaster& bone,
                               double least, int elements_through, SheetChanges& changes) {
  const std::vector<Vector3d> normals = point_normals(articular);
  const std::vector<char> rim = rim_vertices(normals.size(), articular.triangles, edge_neighbours(articular.triangles));
  BuiltLayer layer;
  layer.triangles = articular.triangles;
  layer.articular = articular.points;
  for (std::size_t v = 0; v < normals.size(); ++v) {
    const double thickness = std::max(least, beneath.thickness[v]);
    layer.bone.push_back(articular.points[v] - thickness * normals[v]);
    changes.wanted.push_back(thickness);
    changes.change.push_back(!rim[v] && beneath.depth[v] > least ? least : 0.0);
  }
  const auto recast = [&](const Vector3d& from, const Vector3d& direction, double length) {
    const LineHit hit = bone.nearest_facing(from, direction, 0.0, 0.0, 4.0 * length, 0.2);
    const bool there = hit.point.triangle >= 0 && hit.distance > 0 && bone.within(from, 0.35 * hit.distance).empty();
    return there ? std::max(least, hit.distance) : kNaN;
  };
  make_sound(layer, {elements_through, false, &bone, least, recast}, changes);
  return layer;
}

}  // namespace dea

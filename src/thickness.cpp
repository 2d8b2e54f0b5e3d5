#include "thickness.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "ray_caster.h"

namespace dea {

namespace {

/// The same surface with its normals the other way.
SurfaceMesh flipped(SurfaceMesh mesh) {
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  for (auto& n : mesh.neighbours) std::swap(n[0], n[2]);
  for (auto& b : mesh.bulge) b = {-b[2], -b[1], -b[0]};
  for (Vector3d& n : mesh.normals) n = -n;
  for (Vector3d& n : mesh.vertex_normals) n = -n;
  return mesh;
}

}  // namespace

void measure_thickness(Layer& layer) {
  const bool from_bone = layer.springs_at == SpringsAt::Bone;
  const SurfaceMesh& from = layer.spring_surface();
  // rays leave `from` through the layer; the faces they may meet look against them
  const SurfaceMesh to = from_bone ? flipped(layer.articular) : layer.bone;
  const RayCaster caster(to);
  constexpr double kCos60 = 0.5;
  layer.thickness.assign(from.vertices.size(), 0.0);
  layer.missed.assign(from.vertices.size(), 0);
  tbb::parallel_for(std::size_t{0}, from.vertices.size(), [&](std::size_t v) {
    const Vector3d& x = from.vertices[v];
    const Vector3d direction = from_bone ? from.vertex_normals[v] : Vector3d(-from.vertex_normals[v]);
    // Where the ray meets a face, it counts if nothing lies nearer than half as far: quicker to ask than the closest
    // point, for which a layer much thicker than its facets offers many candidates. A vertex both surfaces share (a
    // feather edge) has thickness 0 by its closest point.
    const LineHit hit = caster.nearest_facing(x, direction, 0.0, 0.0, std::numeric_limits<double>::infinity(), kCos60);
    if (hit.point.triangle >= 0 && hit.distance > 0.0 && caster.within(x, 0.5 * hit.distance).empty()) {
      layer.thickness[v] = std::max(0.0, hit.distance - bulge_height(to, hit.point.triangle, hit.point.weights));
    } else {
      layer.thickness[v] = (position(to, caster.closest(x)) - x).norm();
      layer.missed[v] = layer.thickness[v] > 0.0;
    }
  });
}

}  // namespace dea

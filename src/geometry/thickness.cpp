#include "src/geometry/thickness.h"

#include <algorithm>

#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/geometry/ray_caster.h"

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

/// Per vertex a step off its planes of symmetry: a ray in such a plane runs along the very edge of the
/// bone, which the noise of coordinates has it miss. Zero elsewhere; empty: there is no such plane.
std::vector<Vector3d> steps_inside(const SurfaceMesh& mesh) {
  // Of the way to the triangles' centres: more than the noise, and the bone is as deep there.
  constexpr double kStep = 0.02;
  if (std::all_of(mesh.planes.begin(), mesh.planes.end(), [](unsigned char bits) { return bits == 0; })) return {};
  std::vector<Vector3d> steps(mesh.vertices.size(), Vector3d::Zero());
  std::vector<int> count(mesh.vertices.size(), 0);
  for (int t = 0; t < mesh.size(); ++t)
    for (const int v : mesh.triangles[at(t)]) {
      steps[at(v)] += mesh.centroid(t) - mesh.vertices[at(v)];
      ++count[at(v)];
    }
  for (std::size_t v = 0; v < steps.size(); ++v)
    for (int axis = 0; axis < 3; ++axis)
      steps[v][axis] *= count[v] > 0 && (mesh.planes[v] >> axis & 1) != 0 ? kStep / count[v] : 0.0;
  return steps;
}

/// Rays leave `from` through the layer, along (side 1) or against (-1) its normals; the faces of `to` look against
/// them.
MeasuredThickness cast(const SurfaceMesh& from, double side, const SurfaceMesh& to) {
  const RayCaster caster(to);
  const std::vector<Vector3d> inside = steps_inside(from);
  constexpr double kCos60 = 0.5;
  MeasuredThickness found;
  found.thickness.assign(from.vertices.size(), 0.0);
  found.missed.assign(from.vertices.size(), 0);
  parallel_for(from.vertices.size(), [&](std::size_t v) {
    const Vector3d& x = from.vertices[v];
    const Vector3d direction = side * from.vertex_normals[v];
    // Where the ray meets a face, it counts if nothing lies nearer than half as far: quicker to ask than the closest
    // point, for which a layer much thicker than its facets offers many candidates. A vertex both surfaces share (a
    // feather edge) has thickness 0 by its closest point.
    const auto cast_from = [&](const Vector3d& origin) {
      return caster.nearest_facing(origin, direction, 0.0, 0.0, kInfinity, kCos60);
    };
    LineHit hit = cast_from(x);
    if (hit.point.triangle < 0 && !inside.empty() && from.planes[v] != 0) hit = cast_from(x + inside[v]);
    if (hit.point.triangle >= 0 && hit.distance > 0.0 && caster.within(x, 0.5 * hit.distance).empty()) {
      found.thickness[v] = std::max(0.0, hit.distance - bulge_height(to, hit.point.triangle, hit.point.weights));
    } else {
      found.thickness[v] = (position(to, caster.closest(x)) - x).norm();
      found.missed[v] = found.thickness[v] > 0.0;
    }
  });
  return found;
}

}  // namespace

MeasuredThickness measure_thickness(const SurfaceMesh& from, const SurfaceMesh& bone) { return cast(from, -1.0, bone); }

MeasuredThickness measure_thickness_from_bone(const SurfaceMesh& bone, const SurfaceMesh& articular) {
  return cast(bone, 1.0, flipped(articular));
}

}  // namespace dea

#include "src/build/pseudonormal.h"

#include <Eigen/Geometry>
#include <cmath>

#include "src/base/numbers.h"

namespace dea {

std::vector<Vector3d> angle_weighted_normals(const SurfaceMesh& mesh) {
  std::vector<Vector3d> normals(mesh.vertices.size(), Vector3d::Zero());
  for (int t = 0; t < mesh.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Vector3d a = mesh.corner(t, (k + 1) % 3) - mesh.corner(t, k),
                     b = mesh.corner(t, (k + 2) % 3) - mesh.corner(t, k);
      normals[at(mesh.triangles[at(t)][at(k)])] += std::atan2(a.cross(b).norm(), a.dot(b)) * mesh.normals[at(t)];
    }
  return normals;
}

Vector3d pseudonormal(const SurfaceMesh& mesh, const std::vector<Vector3d>& at_vertices, const SurfacePoint& point) {
  constexpr double kNone = 1e-9;  // barycentric: on the edge
  const std::size_t t = at(point.triangle);
  int zeros = 0;
  std::size_t last_zero = 0, other = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    if (point.weights[k] < kNone) {
      ++zeros;
      last_zero = k;
    } else {
      other = k;
    }
  }
  if (zeros >= 2) return at_vertices[at(mesh.triangles[t][other])];
  if (zeros == 0) return mesh.normals[t];
  const int across = mesh.neighbours[t][(last_zero + 1) % 3];
  return across < 0 ? mesh.normals[t] : Vector3d(mesh.normals[t] + mesh.normals[at(across)]);
}

}  // namespace dea

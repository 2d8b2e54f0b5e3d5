#include "src/build/remesh.h"

#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Polygon_mesh_processing/repair_degeneracies.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#if __has_include(<CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Edge_count_stop_predicate.h>)
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Edge_count_stop_predicate.h>
#else
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#endif

#include <algorithm>
#include <vector>

#include "src/build/mend_surface.h"

namespace dea {

namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
#if __has_include(<CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Edge_count_stop_predicate.h>)
using EdgesLeft = CGAL::Surface_mesh_simplification::Edge_count_stop_predicate<Mesh>;
#else
using EdgesLeft = CGAL::Surface_mesh_simplification::Count_stop_predicate<Mesh>;  // its name before CGAL 5.6
#endif

/// The surface is a manifold: mend_surface has been over it.
Mesh to_cgal(const TriangleSurface& surface) {
  Mesh mesh;
  std::vector<Mesh::Vertex_index> vertices;
  for (const Eigen::Vector3d& x : surface.points) vertices.push_back(mesh.add_vertex({x.x(), x.y(), x.z()}));
  const auto vertex = [&](int i) { return vertices[static_cast<std::size_t>(i)]; };
  for (const auto& t : surface.triangles) mesh.add_face(vertex(t[0]), vertex(t[1]), vertex(t[2]));
  return mesh;
}

TriangleSurface from_cgal(Mesh& mesh) {
  mesh.collect_garbage();
  TriangleSurface surface;
  for (const auto v : mesh.vertices()) {
    const auto& p = mesh.point(v);
    surface.points.push_back({p.x(), p.y(), p.z()});
  }
  for (const auto f : mesh.faces()) {
    std::array<int, 3> corners{};
    std::size_t k = 0;
    for (const auto v : CGAL::vertices_around_face(mesh.halfedge(f), mesh))
      corners[k++ % 3] = static_cast<int>(v.idx());
    surface.triangles.push_back(corners);
  }
  return surface;
}

bool is_sliver(const TriangleSurface& s, const std::array<int, 3>& t) {
  constexpr double kLeastHeight = 0.0173;  // of the longest edge
  const auto point = [&](std::size_t k) { return s.points[static_cast<std::size_t>(t[k % 3])]; };
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, (point(k + 1) - point(k)).squaredNorm());
  return 2 * area_vector(s, t).norm() < kLeastHeight * longest;
}

}  // namespace

TriangleSurface without_slivers(const TriangleSurface& surface) {
  const auto& all = surface.triangles;
  if (std::none_of(all.begin(), all.end(), [&](const auto& t) { return is_sliver(surface, t); })) return surface;
  constexpr double kCap = -0.9962, kNeedle = 50;  // cosine of 175 degrees; longest edge over shortest
  Mesh mesh = to_cgal(surface);
#if CGAL_VERSION_NR < 1060000000
  pmp::experimental::remove_almost_degenerate_faces(mesh.faces(), mesh, kCap, kNeedle, 0.0);
#else
  pmp::remove_almost_degenerate_faces(mesh.faces(), mesh,
                                      pmp::parameters::cap_threshold(kCap).needle_threshold(kNeedle));
#endif
  return from_cgal(mesh);
}

TriangleSurface remeshed(const TriangleSurface& surface, double edge) {
  Mesh mesh = to_cgal(surface);
  pmp::isotropic_remeshing(mesh.faces(), edge, mesh, pmp::parameters::number_of_iterations(5).relax_constraints(true));
  return from_cgal(mesh);
}

TriangleSurface decimated(const TriangleSurface& surface, std::size_t triangles) {
  namespace sms = CGAL::Surface_mesh_simplification;
  if (surface.triangles.size() <= triangles) return surface;
  Mesh mesh = to_cgal(surface);
  sms::edge_collapse(mesh, EdgesLeft(triangles * 3 / 2));  // a closed mesh has 3/2 edges a face
  return from_cgal(mesh);
}

}  // namespace dea

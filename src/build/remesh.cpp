#include "src/build/remesh.h"

#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#if __has_include(<CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Edge_count_stop_predicate.h>)
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Edge_count_stop_predicate.h>
#else
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#endif

#include <vector>

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

}  // namespace

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

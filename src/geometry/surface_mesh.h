// src/geometry/surface_mesh.h – a triangulated surface: vertices, oriented triangles, normals, rim.
#pragma once
#include <array>
#include <vector>

#include "src/model/joint_model.h"

namespace dea {

/// Struct of arrays. Frame: global, reference configuration. The normals of an articular surface point out of
/// its layer, those of a bone surface out of the bone (into the layer).
struct SurfaceMesh {
  std::vector<int> model_nodes;               ///< per vertex: index of the model's node
  std::vector<Vector3d> vertices;             ///< per vertex: position
  std::vector<std::array<int, 3>> triangles;  ///< per triangle: vertex numbers, counter-clockwise seen from outside
  std::vector<int> facet;                     ///< per triangle: facet of the surface it was cut from
  int facets = 0;                             ///< number of facets
  std::vector<unsigned char>
      planes;  ///< per vertex: bit k set, in a plane of symmetry across axis k; empty: there is none

  // derived by finish_surface_mesh
  std::vector<Vector3d> normals;               ///< per triangle, unit
  std::vector<double> areas;                   ///< per triangle, > 0
  std::vector<Vector3d> vertex_normals;        ///< per vertex: area-weighted average, unit
  std::vector<double> vertex_areas;            ///< per vertex: a third of each triangle around it
  std::vector<std::array<int, 3>> neighbours;  ///< per triangle: triangle across edge (k, k + 1); -1: rim
  std::vector<std::array<double, 3>> bulge;    ///< per triangle and edge (k, k + 1): see bulge_height; 0 at sharp edges

  int size() const { return static_cast<int>(triangles.size()); }
  const Vector3d& corner(int triangle, int k) const {
    return vertices[static_cast<std::size_t>(
        triangles[static_cast<std::size_t>(triangle)][static_cast<std::size_t>(k)])];
  }
  Vector3d centroid(int t) const { return (corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3.0; }
};

/// Cuts the facets (node lists into `positions`, see split_facet) into triangles and derives everything else.
/// A facet of no area is left without triangles, its number is returned in `zero_area` (if given). So is a facet of no
/// nodes, without a word. `node_planes`: per position, bit k set: it lies in a plane of symmetry across axis k. An edge
/// of the rim with both ends in such a plane has the surface's mirror image beyond it: normals of vertices and bulges
/// are those of the whole surface. Empty: there is no such plane.
SurfaceMesh make_surface_mesh(const std::vector<int>& facet_begin, const std::vector<int>& facet_nodes,
                              const std::vector<Vector3d>& positions, std::vector<int>* zero_area = nullptr,
                              const std::vector<unsigned char>& node_planes = {});

/// The triangles with their normals turned, each as a facet of its own. `positions`, `node_planes`: of the model's
/// nodes.
SurfaceMesh turned_round(const SurfaceMesh& mesh, const std::vector<Vector3d>& positions,
                         const std::vector<unsigned char>& node_planes = {});

/// The same vertices and triangles, some turned over. `which`: per triangle.
SurfaceMesh with_turned(SurfaceMesh mesh, const std::vector<char>& which);

/// Height of the smooth surface that the facets stand for above a point of a triangle, along its normal (C0):
///     H(w) = sum over edges (i, j) of w_i w_j b_ij,   b_ij = (x_i - x_j) . (n_i - n_j) / 2
/// with the vertices x and the vertex normals n: the parabola through both ends that leaves them with the slopes the
/// normals ask for. Exact to O(size^4 / R^3) on a sphere, continuous across edges, 0 at vertices, 0 on plane surfaces,
/// and 0 along edges sharper than 40 degrees, which are meant to be sharp.
double bulge_height(const SurfaceMesh& mesh, int triangle, const std::array<double, 3>& weights);
/// Its gradient in the triangle's plane.
Vector3d bulge_gradient(const SurfaceMesh& mesh, int triangle, const std::array<double, 3>& weights);

/// The facets as they are: no bulge.
void flatten(SurfaceMesh& mesh);

/// The same triangles with their vertices elsewhere. `flat`: as flatten.
SurfaceMesh with_vertices_at(SurfaceMesh mesh, const std::vector<Vector3d>& vertices, bool flat);

/// Gradient in a triangle's plane of the linear interpolation of three corner values.
Vector3d linear_gradient(const SurfaceMesh& mesh, int triangle, const std::array<double, 3>& corner_values);

using Barycentric = std::array<double, 3>;
/// Of a point in the plane of a triangle that has an area.
Barycentric weights_in(const std::array<Vector3d, 3>& corners, const Vector3d& x);
/// Corners of the n^2 equal parts of a triangle, counter-clockwise, in the triangle's barycentric coordinates.
std::vector<std::array<Barycentric, 3>> triangle_parts(int n);
/// Number of the part that holds a point of the triangle.
int part_at(int n, const Barycentric& w);
/// The mesh with each triangle t cut into n^2 parts, numbers t n^2 + part. The parts lie in their triangles' planes: no
/// bulge. Vertices of the mesh come first, in their order; the others have no node of the model (-1).
SurfaceMesh divided(const SurfaceMesh& mesh, int n);

double distance_to_segment(const Vector3d& x, const Vector3d& a, const Vector3d& b);

/// Per triangle and edge (k, k + 1): the triangle across; -1: rim. At an edge of more than two triangles: none, or, if
/// `in_pairs`, the first two are neighbours, then the next two. `crowded`: counts such edges.
std::vector<std::array<int, 3>> edge_neighbours(const std::vector<std::array<int, 3>>& triangles, bool in_pairs = false,
                                                std::size_t* crowded = nullptr);
/// Per vertex: those at the other ends of its edges, each once, ascending.
std::vector<std::vector<int>> vertex_neighbours(std::size_t vertices, const std::vector<std::array<int, 3>>& triangles);
/// The vertices of the edges with no neighbour, in their triangles' direction.
std::vector<std::array<int, 2>> rim_edges(const std::vector<std::array<int, 3>>& triangles,
                                          const std::vector<std::array<int, 3>>& neighbours);
/// The ends of these edges.
std::vector<std::array<Vector3d, 2>> rim_segments(const SurfaceMesh& mesh);
/// Per vertex: is it such an end?
std::vector<char> rim_vertices(std::size_t vertices, const std::vector<std::array<int, 3>>& triangles,
                               const std::vector<std::array<int, 3>>& neighbours);
inline std::vector<char> rim_vertices(const SurfaceMesh& mesh) {
  return rim_vertices(mesh.vertices.size(), mesh.triangles, mesh.neighbours);
}

/// Per triangle a lower bound of the distance of all its points to the rim: exact enough to tell apart distances
/// up to `reach`, beyond that only known to be larger. Infinity on a closed surface.
std::vector<double> rim_distances(const SurfaceMesh& mesh, double reach);

/// Least-squares sphere through the vertices (algebraic fit, vertices weighted by their area).
struct SphereFit {
  Vector3d center = Vector3d::Zero();
  double radius = 0.0;
  double rms = 0.0;  ///< root mean square distance of the vertices from the sphere
};
SphereFit fit_sphere(const SurfaceMesh& surface);

/// Has a surface the shape of its sphere? Only then do the sphere's centre and radius mean something.
/// Uneven: its vertices lie more than a tenth of the radius from the sphere (root mean square).
/// Flat: the radius is more than ten radii of gyration, or the normals do not point along the radii; those of a plane
/// do not, though a sphere goes through the four corners of a square.
enum class Roundness { Round, Uneven, Flat };
Roundness roundness(const SurfaceMesh& surface, const SphereFit& sphere);

/// Of its triangles.
double mean_area(const SurfaceMesh& surface);

/// Centre and radius of gyration of a surface (area-weighted).
struct SurfaceExtent {
  Vector3d centroid = Vector3d::Zero();
  double radius_of_gyration = 0.0;
  double area = 0.0;
};
SurfaceExtent surface_extent(const SurfaceMesh& surface);

}  // namespace dea

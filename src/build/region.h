// src/build/region.h – the part of a bone that bears cartilage: where it faces another bone, with a smooth rim.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "src/geometry/ray_caster.h"
#include "src/geometry/triangle_surface.h"

namespace dea {

/// For rays and closest points; its vertices need not have the points' order.
SurfaceMesh mesh_of(const TriangleSurface& surface);

/// From a point to the nearest of a surface.
double distance_to(const RayCaster& surface, const Eigen::Vector3d& x);

/// Per vertex: the sum of the normals of the triangles around it, weighted by their angles there; not unit.
std::vector<Eigen::Vector3d> angle_weighted_normals(const SurfaceMesh& mesh);

/// Of a point from a surface, < 0: inside. `at_vertices`: angle_weighted_normals of its mesh.
/// The sign of (x - closest point) . pseudonormal is right on every closed surface, with sharp edges and triangles of
/// any size (Baerentzen and Aanaes 2005, 10.1109/TVCG.2005.49); normals weighted by area are not: a large triangle
/// behind an edge, such as where a scan cuts a shaft, would outweigh the small ones before it.
double signed_distance(const RayCaster& surface, const std::vector<Eigen::Vector3d>& at_vertices,
                       const Eigen::Vector3d& x);

/// A point of a surface lies on the edge of an open one: what is closest there may be beside the surface.
bool on_open_edge(const SurfaceMesh& mesh, const SurfacePoint& point);

/// Per point: the area-weighted mean of the normals around it, unit.
std::vector<Eigen::Vector3d> point_normals(const TriangleSurface& surface);

/// Per point: distance along its normal to the surface `other`, which faces it there (angle below 60 degrees), nothing
/// else of `other` lying nearer than half as far; infinite where there is none within `reach`.
std::vector<double> facing_gaps(const std::vector<Eigen::Vector3d>& points, const std::vector<Eigen::Vector3d>& normals,
                                const RayCaster& other, double reach);

/// Of each point, a third of the triangles around it.
std::vector<double> point_areas(const TriangleSurface& surface);

/// Values per point, smoothed over about this length: each step takes the mean of a point and its neighbours, of a
/// point on the edge those on the edge. Constants stay as they are, to the last bit.
std::vector<double> smoothed(const TriangleSurface& surface, std::vector<double> values, double length);

/// How a region is given in place of found.
struct GivenRegion {
  enum class Kind { Surface, Sphere, Plane };
  Kind kind = Kind::Sphere;
  TriangleSurface surface;                            ///< Surface: points of the bone that lie by it
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< Sphere: centre; Plane: a point of it
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< Plane: towards the region
  double radius = 0.0;                                ///< Sphere
  std::string frame;  ///< from whose origin and along whose axes the numbers are (leave_frames); empty: the scans'
};

struct RegionOptions {
  double reach = 6.0;                ///< gaps below belong to the region
  double rim_length = 2.0;           ///< over which the rim is smoothed
  bool fill_holes = true;            ///< those below a quarter of the region's area
  std::optional<GivenRegion> given;  ///< Surface, Sphere: in place of what is found; Plane: trims it
};

/// A region, cut out of a bone along a smooth rim.
struct BoneRegion {
  TriangleSurface surface;  ///< oriented as the bone
  int parts_left_out = 0;   ///< below a twentieth of the largest
  int holes_filled = 0;
};

/// `gaps`: of the bone's points, as facing_gaps gives them (the least of all other bones).
BoneRegion find_region(const TriangleSurface& bone, const std::vector<double>& gaps, const RegionOptions& options);

/// Values that are not finite become the mean of their finite neighbours', from those outwards; all unknown: `none`.
void fill_unknown(const TriangleSurface& surface, std::vector<double>& values, double none);

/// Per point the distance to the surface's edge; infinite without one.
std::vector<double> distances_to_rim(const TriangleSurface& surface);

}  // namespace dea

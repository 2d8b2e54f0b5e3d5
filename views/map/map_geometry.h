// views/map/map_geometry.h – a surface laid on paper: triangles, projection, what hides what, outlines and
// contours. No colours, no files.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "src/results/comparison.h"

namespace dea {

using Vector2d = Eigen::Vector2d;

/// A surface cut into triangles for drawing: quads into four about their middle, so that no diagonal is preferred.
struct MapMesh {
  std::vector<Vector3d> points;             ///< the vertices of ResultSurface::mesh, then the middles
  std::vector<std::array<int, 4>> middles;  ///< per middle: its quad's vertices
  std::vector<std::array<int, 3>> triangles;
  std::vector<int> facet;                      ///< per triangle
  std::vector<std::array<int, 3>> neighbours;  ///< per triangle: triangle across edge (k, k + 1); -1: rim
  std::vector<double> areas;                   ///< per triangle
  int size() const { return static_cast<int>(triangles.size()); }
};
MapMesh make_map_mesh(const ResultSurface& surface);
/// Values per vertex -> per point of the map; a middle has the mean of its corners.
std::vector<double> point_values(const MapMesh& mesh, const std::vector<double>& vertex_values);

/// From where a surface is seen. right, up and toward (to the viewer) are orthonormal and right-handed, global frame.
/// Unrolled: onto a plane that touches the sphere (center, radius) at its pole, seen from the articular side. Lambert's
/// azimuthal equal-area projection: angle t from the pole lies 2 R sin(t / 2) from the map's middle.
struct MapView {
  Vector3d right = Vector3d::UnitX(), up = Vector3d::UnitY(), toward = Vector3d::UnitZ();
  bool unrolled = false;
  Vector3d center = Vector3d::Zero(), pole = Vector3d::UnitZ();
  double radius = 1.0;
};
/// From where a surface is seen first. Sockets and flat surfaces along their mean normal; balls, and surfaces of which
/// more than a twentieth of the load would be out of sight, against the force they carry. `load`: per facet, 0 or more.
Vector3d default_direction(const ResultSurface& surface, const std::vector<double>& load);
/// `up`: any direction across `toward`; along it, or zero: the global z, y or x axis, the first that is across enough.
MapView view_from(const Vector3d& toward, const Vector3d& up);
/// False if the surface is no part of a sphere: radius over 10 radii of gyration, or 10 % of the radius off it (rms).
bool unroll(const ResultSurface& surface, const Vector3d& up, MapView& view);
/// Directions of the body in the global frame; anterior zero: not known. Those of `side` ("left" or "right" joint)
/// name medial and lateral; without it the body's right and left are named.
struct BodyDirections {
  Vector3d superior = Vector3d::UnitZ(), anterior = Vector3d::Zero();
  std::string side = {};
};
/// What lies beyond the map's right, top, left and bottom edge; empty: no direction of the body is near enough.
using EdgeNames = std::array<std::string, 4>;
EdgeNames edge_names(const MapView& view, const BodyDirections& body);

/// Where a point comes to lie: right, up. Lengths are the surface's.
Vector2d on_map(const MapView& view, const Vector3d& x);

/// The triangles on the map. Within one layer none covers another; layers are drawn from 0 upwards.
struct Projection {
  std::vector<Vector2d> points;
  std::vector<int> layer;      ///< -1: not drawn (seen edge-on, or torn apart at the antipode)
  std::vector<char> back;      ///< seen from the other side than most of the surface
  std::vector<double> hidden;  ///< share of the triangle behind others, 0 .. 1
  int layers = 0;
  bool from_behind = false;  ///< most of the surface is seen from its bone side
};
/// `weights`: per triangle, how much it counts for which side is the front; all 0: its area.
Projection project(const MapMesh& mesh, const MapView& view, const std::vector<double>& weights);

/// Points joined by straight lines; closed: the last one joins the first, which is not repeated.
struct Polyline {
  std::vector<Vector2d> points;
  bool closed = false;
};

/// Flags of triangles.
using TriangleMask = std::vector<char>;
TriangleMask layer_triangles(const MapMesh& mesh, const Projection& projection, int layer);

/// Outline of the union of triangles, to be filled by the non-zero rule.
std::vector<Polyline> outline(const MapMesh& mesh, const Projection& p, const TriangleMask& in);
/// Outline of where the linear interpolation of point values is `level` or more, within the triangles of the mask;
/// their values must be finite.
std::vector<Polyline> region_above(const MapMesh& mesh, const Projection& p, const TriangleMask& in,
                                   const std::vector<double>& values, double level);
/// Lines of value `level`, the higher side on their left where the surface is seen from outside.
std::vector<Polyline> contour(const MapMesh& mesh, const Projection& p, const TriangleMask& in,
                              const std::vector<double>& values, double level);
/// Rim of the surface, and where it turns its back.
std::vector<Polyline> rim(const MapMesh& mesh, const Projection& p, const TriangleMask& in);
/// Corners cut twice (Chaikin): a smooth line no farther off than a fraction of a piece. Straight lines stay.
Polyline smoothed(const Polyline& line);

/// Area where the linear interpolation is `level` or more, of all triangles with finite values.
double area_above(const MapMesh& mesh, const std::vector<double>& values, double level);

/// The edge of what nodal averages smear over the facets around: the level of point values above which there is as much
/// area as the facets with a value above 0 have. Infinite: no point is above 0. Above 0 else. `facets`: per facet of
/// the surface; `points`: per point of the map.
double edge_level(const MapMesh& mesh, const std::vector<double>& facets, const std::vector<double>& points);
/// The same where the area of these facets is known, `wanted`, and not which they are.
double level_enclosing(const MapMesh& mesh, double wanted, const std::vector<double>& points);

}  // namespace dea

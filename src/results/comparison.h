// src/results/comparison.h – two results of the same joint side by side: numbers that mean the same for both.
//
// Results are pressures per facet of a surface, whatever made them. FEA facet pressures are noisy (checkerboards), so
// every measure also exists on nodal averages, and patterns are compared on those. Places are those of the reference
// configuration throughout; areas may be those of the deformed one (with_areas_of).
#pragma once
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "src/geometry/ray_caster.h"
#include "src/geometry/surface_mesh.h"

namespace dea {

/// A surface of a result. Facet i has the slots begin[i] .. begin[i + 1].
struct ResultSurface {
  std::string name;
  std::vector<int> begin = {0};
  std::vector<int> slot_vertex;         ///< per slot: vertex of the mesh; -1: a node of facets without area only
  std::vector<Vector3d> slot_position;  ///< per slot
  SurfaceMesh mesh;
  std::vector<double> facet_areas;      ///< sum of the facet's triangles
  std::vector<Vector3d> area_vectors;   ///< the same with their normals
  std::vector<Vector3d> facet_centers;  ///< centroid
  std::vector<int> around_begin;        ///< facets around vertex v: around[around_begin[v]] to around_begin[v + 1]
  std::vector<int> around;
  int facets() const { return static_cast<int>(begin.size()) - 1; }
};
/// `nodes`: indices into `positions`, per slot.
ResultSurface make_result_surface(const std::string& name, const std::vector<int>& begin, const std::vector<int>& nodes,
                                  const std::vector<Vector3d>& positions);
/// The surface with the facet areas and area vectors of `moved`, the same facets with their nodes elsewhere. Where
/// facets and nodes are stays as it is, so that places still pair.
ResultSurface with_areas_of(ResultSurface surface, const ResultSurface& moved);

/// Some facets of a surface: one flag per facet; empty: all.
using FacetMask = std::vector<char>;

/// Per vertex the area-weighted average of the values of the facets around it.
std::vector<double> nodal_average(const ResultSurface& surface, const std::vector<double>& facet_values);
/// Per vertex its equal share of each facet around it (a quarter of a quad, a third of a triangle), of facets in `mask`
/// only.
std::vector<double> nodal_areas(const ResultSurface& surface, const FacetMask& mask = {});
/// Per facet its area, 0 outside `mask`.
std::vector<double> facet_areas(const ResultSurface& surface, const FacetMask& mask = {});
/// Per facet the mean of values given per vertex, interpolated linearly.
std::vector<double> facet_average(const SurfaceMesh& mesh, const std::vector<double>& facet_areas,
                                  const std::vector<double>& vertex_values);
inline std::vector<double> facet_average(const ResultSurface& surface, const std::vector<double>& vertex_values) {
  return facet_average(surface.mesh, surface.facet_areas, vertex_values);
}

/// How the values above a threshold are distributed; all but `area` NaN where there are none. Percentiles are
/// area-weighted (weighted_percentile in percentile.h).
struct Distribution {
  double area = 0.0;
  double peak = 0.0, p99 = 0.0, mean = 0.0;
  double p5 = 0.0, p25 = 0.0, median = 0.0, p75 = 0.0, p95 = 0.0;
  double p99_unweighted = 0.0;  ///< every value counts once, linear between ranks 0 .. n - 1 (numpy's default)
};
Distribution distribution(const std::vector<double>& values, const std::vector<double>& areas, double threshold);

/// Pressure and, from FEA, gap per facet (positive: penetration); `gap` empty: none.
struct SurfaceValues {
  std::vector<double> pressure, gap;
};

struct SurfaceMeasures {
  std::vector<Distribution> facets, nodes;               ///< per threshold as given
  Vector3d resultant = Vector3d::Zero();                 ///< sum of p A n: what this side exerts on the other
  Vector3d center_of_pressure = Vector3d::Zero();        ///< sum of p A x / sum of p A; NaN without pressure
  double mean_penetration = 0.0, max_penetration = 0.0;  ///< of the gap where p > 0 (mean: area-weighted); NaN: none
};
SurfaceMeasures measure(const ResultSurface& surface, const SurfaceValues& values,
                        const std::vector<double>& thresholds, const FacetMask& mask = {});

/// How far a contact gives way: a penalty lets surfaces penetrate by g = p / penalty, as one more spring in series
/// does. Over the facets with more than a tenth of the largest pressure: below that a facet is in contact with only
/// some of its integration points, and its mean gap is one of both kinds.
struct InterfaceCompliance {
  double compliance = 0.0;     ///< c = sum of A g / sum of A p [length per pressure]; NaN: no pressure or no gap known
  double p5 = 0.0, p95 = 0.0;  ///< percentiles of g / p, weighted by the force p A; FEBio's auto_penalty spreads them
  int facets = 0;
};
/// `gap` in FEBio's sign, positive: penetration; may be empty.
InterfaceCompliance interface_compliance(const std::vector<double>& pressure, const std::vector<double>& gap,
                                         const std::vector<double>& areas);

/// Where the vertices of one surface are on another.
struct NodeMatch {
  bool same_mesh = false;            ///< facets and their nodes pair one by one
  std::vector<int> vertices;         ///< same mesh: per vertex of `onto` that of `from`
  std::vector<SurfacePoint> points;  ///< otherwise: its closest point on `from`; triangle -1: not covered by it
  double covered = 1.0;              ///< share of the area of `onto` that `from` covers
};
/// Farther apart than the (larger) mean facet size counts as not covered: beyond that the closest point is one of the
/// rim.
NodeMatch match_nodes(const ResultSurface& onto, const ResultSurface& from);
/// Vertex values of `from` at the vertices of `onto`, interpolated linearly; NaN where not covered.
std::vector<double> carry_values(const NodeMatch& match, const ResultSurface& from,
                                 const std::vector<double>& vertex_values);

/// Pearson's correlation of a and b, weighted; NaN where one of them is constant.
double correlation(const std::vector<double>& a, const std::vector<double>& b, const std::vector<double>& weights);

/// How the pattern of a differs from that of b, over the nodes where either is above 0. NaN in `a`: left out.
struct PatternDifference {
  double correlation = 0.0;
  double rms = 0.0;          ///< area-weighted root mean square of a - b
  double mean = 0.0;         ///< area-weighted mean of a - b
  double largest = 0.0;      ///< a - b where |a - b| is largest
  std::vector<double> dice;  ///< per threshold: 2 |A and B| / (|A| + |B|) of the areas above; NaN: both empty
};
PatternDifference pattern_difference(const std::vector<double>& a, const std::vector<double>& b,
                                     const std::vector<double>& areas, const std::vector<double>& thresholds);

/// (a - b) / b in percent; 0 when equal, NaN when b is 0 otherwise.
double percent_difference(double a, double b);

/// Axis and centre of a socket or head. Axis: the area-weighted mean normal. Centre: that of the least-squares sphere;
/// of a surface too flat for one (radius over 10 radii of gyration) the centroid.
struct SurfaceFrame {
  Vector3d axis = Vector3d::Zero(), center = Vector3d::Zero();
};
SurfaceFrame surface_frame(const ResultSurface& surface);

/// Anterior (0), superior (1) and posterior (2) third of a socket as in Abraham et al. (2013): points sorted by their
/// angle about the axis, from below by way of the front, the top and the back to below again, cut into three of equally
/// many. Throws UsageError when up and anterior span no plane across the axis.
std::vector<int> third_of(const std::vector<Vector3d>& points, const SurfaceFrame& frame, const Vector3d& up,
                          const Vector3d& anterior);

/// Mean pressure against the angle between `axis` and the direction from `center` (Abraham et al. 2013, Fig. 6).
struct ProfileBin {
  double from = 0.0, to = 0.0;  ///< [degrees]
  double area = 0.0;            ///< of the facets whose centroid is in it
  double mean = 0.0;            ///< area-weighted, facets without pressure included; NaN: no facet
};
std::vector<ProfileBin> pressure_profile(const ResultSurface& surface, const std::vector<double>& facet_pressure,
                                         const Vector3d& axis, const Vector3d& center, double bin_degrees);

/// What a place has borne over time. Between states pressure is linear in time.
struct TimeSums {
  std::vector<double> peak;      ///< largest p of all states
  std::vector<double> exposure;  ///< integral of p dt
  std::vector<double> dose;      ///< integral of max(0, p - threshold) dt; empty without threshold
};
/// `values`: per state one value per place.
TimeSums over_time(const std::vector<double>& times, const std::vector<std::vector<double>>& values,
                   std::optional<double> dose_above);

/// A rigid body's position and, where known, rotation from the reference configuration.
struct BodyPose {
  std::string name;
  Vector3d position = Vector3d::Zero();
  std::optional<Eigen::Quaterniond> rotation;
};
struct PoseDifference {
  Vector3d translation = Vector3d::Zero();
  std::optional<Vector3d> rotation;  ///< rotation vector that takes b to a [rad]
};
PoseDifference pose_difference(const BodyPose& a, const BodyPose& b);

}  // namespace dea

#include "src/springs/gaps.h"

#include <algorithm>
#include <cmath>

#include "src/base/numbers.h"
#include "src/base/parallel.h"

namespace dea {

namespace {

/// Gradient of the linear thickness field in a triangle.
Vector3d thickness_gradient(const SurfaceMesh& mesh, const std::vector<double>& thickness, int t) {
  const auto& tri = mesh.triangles[at(t)];
  return linear_gradient(mesh, t, {thickness[at(tri[0])], thickness[at(tri[1])], thickness[at(tri[2])]});
}

LineHit cast(const SpringBed& bed, const Vector3d& foot, const Vector3d& n, double t_s) {
  if (bed.pair.source_layer().springs_at == SpringsAt::Bone) {
    // from bone to bone: a target bone behind the source's bone surface is too deep
    return bed.target.nearest_facing(foot, n, -2.0 * (t_s + bed.max_target_thickness), 0.0, kInfinity);
  }
  const double deep = t_s + bed.max_target_thickness + bed.part_depth;
  return bed.target.nearest_facing(foot, n, -4.0 * deep, -deep, kInfinity);
}

void set_hit(SpringStates& s, int i, const LineHit& hit) {
  s.triangle[at(i)] = hit.point.triangle;
  s.end_weights[at(i)] = hit.point.weights;
  s.gap[at(i)] = hit.point.triangle >= 0 ? hit.distance : kInfinity;  // the ray's length, made a gap at the end
  s.coverage[at(i)] = hit.point.triangle >= 0 ? 1.0 : 0.0;
}

// ---- feet over the rim ----------------------------------------------------------------------------------------------

/// The part of a foot triangle that lies over the target, where its rim cuts through.
struct Coverage {
  double fraction = 0.0;  ///< of the foot triangle's area
  double area = 0.0;
  Vector3d centroid = Vector3d::Zero();                   ///< of the covered part, in the foot triangle's plane
  Vector3d e1 = Vector3d::Zero(), e2 = Vector3d::Zero();  ///< axes of that plane
  /// d(area), d(centroid) along e1, e2: the rim sweeps over the foot triangle. Sums of v . (delta_target -
  /// delta_source) over points r, stored like forces v at r: their sum and their moment about a point.
  Vector6 area_rate = Vector6::Zero(), centroid_rate[2] = {Vector6::Zero(), Vector6::Zero()};
};

using Point2 = Eigen::Vector2d;

double cross2(const Point2& a, const Point2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Corner of a clipped triangle; `rim`: the edge that starts here is part of the target's rim.
struct ClipPoint {
  Point2 x;
  bool rim;
};

/// Clips a convex polygon (counter-clockwise) by the half plane left of a -> b, in place (Sutherland-Hodgman).
void clip(std::vector<ClipPoint>& polygon, const Point2& a, const Point2& b, std::vector<ClipPoint>& scratch) {
  scratch.clear();
  const Point2 edge = b - a;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const ClipPoint &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double dp = cross2(edge, p.x - a), dq = cross2(edge, q.x - a);
    if (dp >= 0) scratch.push_back(p);
    if ((dp > 0 && dq < 0) || (dp < 0 && dq > 0))
      scratch.push_back({p.x + dp / (dp - dq) * (q.x - p.x), dp < 0 && p.rim});
  }
  polygon.swap(scratch);
}

/// The part of the foot triangle onto which the target triangles `candidates` project along n: exact where the target
/// does not fold over itself there. Frame: any; moments about `reference`.
Coverage coverage(const SurfaceMesh& target, const std::array<Vector3d, 3>& foot, const Vector3d& n,
                  const std::vector<int>& candidates, const Vector3d& reference) {
  Coverage result;
  result.e1 = (foot[1] - foot[0]).normalized();
  result.e2 = n.cross(result.e1);
  const auto project = [&](const Vector3d& x) {
    return Point2((x - foot[0]).dot(result.e1), (x - foot[0]).dot(result.e2));
  };
  const Point2 corner[3] = {project(foot[0]), project(foot[1]), project(foot[2])};
  const double foot_area = 0.5 * cross2(corner[1] - corner[0], corner[2] - corner[0]);
  std::vector<ClipPoint> polygon, scratch;
  Point2 moment = Point2::Zero();
  for (const int t : candidates) {
    const Vector3d& m = target.normals[at(t)];
    if (!(m.dot(n) < 0)) continue;
    // seen along n the target's triangles run clockwise: take them the other way round, edges (0,2), (2,1), (1,0)
    const auto& next = target.neighbours[at(t)];
    polygon = {{project(target.corner(t, 0)), next[2] < 0},
               {project(target.corner(t, 2)), next[1] < 0},
               {project(target.corner(t, 1)), next[0] < 0}};
    for (int k = 0; k < 3 && !polygon.empty(); ++k) clip(polygon, corner[k], corner[(k + 1) % 3], scratch);
    if (polygon.size() < 3) continue;
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
      const double a = 0.5 * cross2(polygon[i].x - polygon[0].x, polygon[i + 1].x - polygon[0].x);
      result.area += a;
      moment += a * (polygon[0].x + polygon[i].x + polygon[i + 1].x) / 3.0;
    }
    // The rim moves against the foot triangle: d(integral of f) = sum over rim pieces of f v_normal ds, two Gauss
    // points each.
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      if (!polygon[i].rim) continue;
      const Point2 p = polygon[i].x, along = polygon[(i + 1) % polygon.size()].x - p;
      const Vector3d outward_times_length = along.y() * result.e1 - along.x() * result.e2;
      for (double s : {0.5 - 0.28867513459481287, 0.5 + 0.28867513459481287}) {
        const Point2 x = p + s * along;
        const Vector3d in_plane = foot[0] + x.x() * result.e1 + x.y() * result.e2;
        const Vector3d r = in_plane + n * ((target.corner(t, 0) - in_plane).dot(m) / n.dot(m));  // on the target
        const Vector3d v = 0.5 * outward_times_length;
        Vector6 rate;
        rate << v, (r - reference).cross(v);
        result.area_rate += rate;
        for (int k = 0; k < 2; ++k) result.centroid_rate[k] += x[k] * rate;
      }
    }
  }
  if (result.area <= 0 || foot_area <= 0) return {};
  moment /= result.area;
  result.centroid = foot[0] + moment.x() * result.e1 + moment.y() * result.e2;
  // d(centroid) = (d(area * centroid) - centroid d(area)) / area
  for (int k = 0; k < 2; ++k)
    result.centroid_rate[k] = (result.centroid_rate[k] - moment[k] * result.area_rate) / result.area;
  result.fraction = std::min(1.0, result.area / foot_area);
  return result;
}

/// A spring that may reach over the rim: how much of its foot triangle lies over the target, and the spring moved to
/// the middle of that part. `distance`: along n to the target hereabouts.
Coverage cover_spring(const SpringBed& bed, const RelativePose& relative, SpringStates& s, std::vector<double>& bulge,
                      int i, double distance) {
  const auto k = at(i);
  const SurfaceMesh& target = bed.target.mesh();
  const Vector3d n = relative.rotation * bed.springs.direction[k];
  std::array<Vector3d, 3> foot;
  for (std::size_t c = 0; c < 3; ++c) foot[c] = relative.rotation * bed.springs.triangle[k][c] + relative.shift;
  const Vector3d middle = (foot[0] + foot[1] + foot[2]) / 3.0;
  const std::vector<int> near_by = bed.target.within(middle + distance * n, 3.0 * bed.foot_radius);
  const Coverage covered = coverage(target, foot, n, near_by, bed.target_center);
  if (covered.fraction >= 1.0 - 1e-9) return {};
  if (covered.fraction <= 1e-9) {
    s.triangle[k] = -1;
    s.gap[k] = kInfinity;
    s.coverage[k] = 0.0;
    return {};
  }
  const std::array<double, 3> w = weights_in(foot, covered.centroid);
  const auto& t = bed.springs.corner_thickness[k];
  const double t_s = w[0] * t[0] + w[1] * t[1] + w[2] * t[2];
  const LineHit hit = cast(bed, covered.centroid, n, t_s);
  if (hit.point.triangle >= 0) {
    set_hit(s, i, hit);
    s.foot[k] = covered.centroid;
    s.t_source[k] = t_s;
    std::array<double, 3> in_surface = {0, 0, 0};
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t j = 0; j < 3; ++j) in_surface[j] += w[c] * bed.springs.weights[k][c][j];
    bulge[k] = bulge_height(bed.pair.source_layer().spring_surface(), bed.springs.surface_triangle[k], in_surface);
  } else if (s.triangle[k] < 0) {
    return {};  // a covered part so far from convex that neither its middle nor the triangle's is covered: left out
  }
  s.coverage[k] = covered.fraction;
  return covered;
}

template <class Body>
void for_each_spring(int springs, const Body& body) {
  parallel_for(springs, body, 256);
}

/// A spring that may reach over the target's rim, and how far the target is hereabouts.
struct NearRim {
  int spring;
  double distance;
};

/// Those whose ray met the target near its rim, and those beside one that hit.
std::vector<NearRim> springs_near_rim(const SpringBed& bed, const RelativePose& relative, const SpringStates& s) {
  const SurfaceMesh &source_mesh = bed.pair.source_layer().spring_surface(), &mesh = bed.target.mesh();
  const Springs& springs = bed.springs;
  std::vector<double> distance_at(source_mesh.triangles.size(), kInfinity);  // of a ray from this triangle
  for (int i = 0; i < springs.size(); ++i)
    if (s.triangle[at(i)] >= 0) distance_at[at(springs.surface_triangle[at(i)])] = s.gap[at(i)];
  const auto distance_beside = [&](int t) {
    double distance = distance_at[at(t)];
    for (int first : source_mesh.neighbours[at(t)]) {
      if (std::isfinite(distance)) return distance;
      if (first < 0) continue;
      distance = distance_at[at(first)];
      for (int second : source_mesh.neighbours[at(first)]) {
        if (std::isfinite(distance)) break;
        if (second >= 0) distance = distance_at[at(second)];
      }
    }
    return distance;
  };
  std::vector<NearRim> at_rim;
  for (int i = 0; i < springs.size(); ++i) {
    const int t = s.triangle[at(i)];
    if (t < 0) {
      const double distance = distance_beside(springs.surface_triangle[at(i)]);
      if (std::isfinite(distance)) at_rim.push_back({i, distance});
    } else {
      if (bed.rim_distance[at(t)] >= 3.0 * bed.foot_radius) continue;  // most springs: no need to know the tilt
      // the foot triangle, seen along n on a target tilted by m.n, reaches this far from q
      const double tilt = -mesh.normals[at(t)].dot(relative.rotation * springs.direction[at(i)]);
      if (bed.rim_distance[at(t)] < 1.5 * bed.foot_radius / std::max(tilt, 0.5)) at_rim.push_back({i, s.gap[at(i)]});
    }
  }
  return at_rim;
}

/// Where spring i ends, and its gap, from the ray cast before: target's frame to global.
void finish_gap(const SpringBed& bed, const RelativePose& relative, const Pose& target, double bulge, int i,
                SpringStates& s) {
  const SurfaceMesh& mesh = bed.target.mesh();
  const auto k = at(i);
  const Vector3d direction = relative.rotation * bed.springs.direction[k];
  s.direction[k] = target.rotation * direction;
  const Vector3d foot = s.foot[k];
  s.foot[k] = target.center + target.rotation * (foot - bed.target_center);
  const int t = s.triangle[k];
  if (t < 0) {
    s.end[k] = s.foot[k];
    s.normal[k] = -s.direction[k];
    return;
  }
  const double distance = s.gap[k];
  s.end[k] = target.center + target.rotation * (foot + distance * direction - bed.target_center);
  const Vector3d m = mesh.normals[at(t)];
  s.normal[k] = target.rotation * m;
  s.t_target[k] = interpolate(mesh, bed.pair.target_layer().thickness, {t, s.end_weights[k]});
  const double h = s.t_source[k] + s.t_target[k] + bed.part_depth;
  const double length = distance - bulge - bulge_height(mesh, t, s.end_weights[k]);  // between the smooth surfaces
  s.gap[k] = bed.pair.source_layer().springs_at == SpringsAt::Bone ? length - h : length;  // (S2)
  if (s.gap[k] <= -h) {
    s.too_deep[k] = 1;
    s.coverage[k] = 0.0;
    return;
  }
  s.area[k] = s.carrying[k] = s.coverage[k] * bed.springs.area[k];
  s.overlap[k] = std::max(0.0, -s.gap[k]);
}

RimSpring rim_spring(int spring, const Coverage& c, const Pose& source, const Pose& target) {
  RimSpring rim;
  rim.spring = spring;
  const Vector3d between = target.center - source.center;
  const auto functional = [&](const Vector6& f) {
    const Vector3d force = target.rotation * f.head<3>(), moment = target.rotation * f.tail<3>();
    Vector12 row;
    row << force, moment, -force, -(moment + between.cross(force));
    return row;
  };
  rim.area_rate = functional(c.area_rate);
  rim.foot_rate = (target.rotation * c.e1) * functional(c.centroid_rate[0]).transpose() +
                  (target.rotation * c.e2) * functional(c.centroid_rate[1]).transpose();
  return rim;
}

}  // namespace

SpringStates empty_states(std::size_t n) {
  SpringStates s;
  const auto resize = [n](auto&... each) { (each.resize(n), ...); };
  resize(s.triangle, s.coverage, s.foot, s.direction, s.end, s.normal, s.end_weights, s.gap, s.t_source, s.t_target,
         s.overlap, s.pressure, s.strain, s.strain_source, s.strain_target, s.per_overlap, s.area, s.carrying,
         s.too_deep);
  s.per_motion.resize(n, Vector3d::Zero());
  return s;
}

SpringStates find_gaps(const SpringBed& bed, const Pose& source, const Pose& target) {
  const Springs& springs = bed.springs;
  SpringStates s = empty_states(static_cast<std::size_t>(springs.size()));
  const RelativePose relative = relative_pose(source, bed.source_center, target, bed.target_center);
  std::vector<double> bulge = springs.bulge;
  for_each_spring(springs.size(), [&](int i) {
    const auto& t = springs.corner_thickness[at(i)];
    s.t_source[at(i)] = (t[0] + t[1] + t[2]) / 3.0;
    s.foot[at(i)] = relative.rotation * springs.foot[at(i)] + relative.shift;
    set_hit(s, i, cast(bed, s.foot[at(i)], relative.rotation * springs.direction[at(i)], s.t_source[at(i)]));
  });
  const std::vector<NearRim> at_rim = springs_near_rim(bed, relative, s);
  std::vector<Coverage> covered(at_rim.size());
  parallel_for(at_rim.size(), [&](std::size_t i) {
    covered[i] = cover_spring(bed, relative, s, bulge, at_rim[i].spring, at_rim[i].distance);
  });
  for_each_spring(springs.size(), [&](int i) { finish_gap(bed, relative, target, bulge[at(i)], i, s); });
  for (std::size_t i = 0; i < at_rim.size(); ++i)
    if (covered[i].fraction > 0 && s.area[at(at_rim[i].spring)] > 0)
      s.rim.push_back(rim_spring(at_rim[i].spring, covered[i], source, target));
  return s;
}

/// (E2), (E3) and the chain rule (E4): at the bone Delta = t_s + t_t - L, at the articular surface Delta = -g. The
/// bulge at q changes like the thickness there.
Vector3d overlap_rate(const SpringBed& bed, const SpringStates& s, int i, double strain_target, const Pose& target) {
  const auto k = at(i);
  const int t = s.triangle[k];
  const SurfaceMesh& mesh = bed.target.mesh();
  const Layer& layer = bed.pair.target_layer();
  const Vector3d& m = mesh.normals[at(t)];
  const Vector3d direction = target.rotation.transpose() * s.direction[k];
  const double mn = m.dot(direction);
  Vector3d gradient = bulge_gradient(mesh, t, s.end_weights[k]);
  if (!layer.rigid) gradient -= strain_target * thickness_gradient(mesh, layer.thickness, t);
  return target.rotation * Vector3d(-m / mn - (gradient - m * (direction.dot(gradient) / mn)));
}

Vector3d source_overlap_gradient(const SpringBed& bed, const SpringStates& s, int i, double strain_source,
                                 const Pose& source) {
  const Layer& layer = bed.pair.source_layer();
  const SurfaceMesh& mesh = layer.spring_surface();
  const int t = bed.springs.surface_triangle[at(i)];
  const Vector3d foot = bed.source_center + source.rotation.transpose() * (s.foot[at(i)] - source.center);
  Vector3d gradient =
      bulge_gradient(mesh, t, weights_in({mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)}, foot));
  if (!layer.rigid)
    gradient += ((layer.springs_at == SpringsAt::Bone ? 1.0 : 0.0) - strain_source) *
                thickness_gradient(mesh, layer.thickness, t);
  return source.rotation * gradient;
}

double covered_part(const SpringBed& bed, const RelativePose& relative, const std::array<Vector3d, 3>& triangle,
                    const Vector3d& direction, double gap) {
  std::array<Vector3d, 3> foot;
  for (std::size_t c = 0; c < 3; ++c) foot[c] = relative.rotation * triangle[c] + relative.shift;
  const Vector3d middle = (foot[0] + foot[1] + foot[2]) / 3.0, n = relative.rotation * direction;
  return coverage(bed.target.mesh(), foot, n, bed.target.within(middle + gap * n, 3.0 * bed.foot_radius),
                  bed.target_center)
      .fraction;
}

std::vector<SurfacePart> parts_under_spring(const SpringBed& bed, const RelativePose& relative,
                                            const SurfaceMesh& surface, const SpringStates& s, int i, int first,
                                            int end, const std::vector<char>& own) {
  const auto k = at(i);
  std::array<Vector3d, 3> foot;
  for (std::size_t c = 0; c < 3; ++c) foot[c] = relative.rotation * bed.springs.triangle[k][c] + relative.shift;
  std::vector<SurfacePart> parts = parts_under_foot(
      foot, bed.springs.area[k], relative.rotation * bed.springs.direction[k], surface, first, end, own);
  if (parts.empty()) parts.push_back({first, s.area[k]});
  return parts;
}

}  // namespace dea

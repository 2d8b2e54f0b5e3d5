#include <febiodea/springs/springs.h>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cassert>
#include <cmath>

#include <febiodea/base/numbers.h>
#include <febiodea/springs/layer_bed.h>

namespace dea {

Eigen::Matrix3d skew(const Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

namespace {}  // namespace

RelativePose relative_pose(const Pose& from, const Vector3d& from_center, const Pose& to, const Vector3d& to_center) {
  // x = c_f + R_f (X - C_f) = c_t + R_t (Y - C_t)  =>  Y = R_t^T R_f X + shift
  const Eigen::Matrix3d back = to.rotation.transpose();
  return {back * from.rotation, to_center + back * (from.center - to.center - from.rotation * from_center)};
}

Springs make_springs(const Layer& source, int refine) {
  assert(refine >= 1);
  const SurfaceMesh& mesh = source.spring_surface();
  Springs s;
  const auto parts = triangle_parts(refine);
  const auto part_area = 1.0 / (refine * refine);
  for (int t = 0; t < mesh.size(); ++t)
    for (const auto& w : parts) {
      std::array<Vector3d, 3> corners;
      std::array<double, 3> thickness = {0, 0, 0};
      for (std::size_t c = 0; c < 3; ++c) {
        corners[c] = position(mesh, {t, w[c]});
        thickness[c] = interpolate(mesh, source.thickness, {t, w[c]});
      }
      s.triangle.push_back(corners);
      s.foot.push_back((corners[0] + corners[1] + corners[2]) / 3.0);
      s.direction.push_back(mesh.normals[at(t)]);
      s.area.push_back(mesh.areas[at(t)] * part_area);
      s.corner_thickness.push_back(thickness);
      s.surface_triangle.push_back(t);
      s.bulge.push_back(bulge_height(
          mesh, t,
          {(w[0][0] + w[1][0] + w[2][0]) / 3, (w[0][1] + w[1][1] + w[2][1]) / 3, (w[0][2] + w[1][2] + w[2][2]) / 3}));
      s.weights.push_back(w);
    }
  return s;
}

SpringBed make_spring_bed(const Joint& joint, const ContactPair& pair) {
  const Layer &source = pair.source_layer(), &target = pair.target_layer();
  SpringBed bed{&pair,
                source.body,
                target.body,
                joint.bodies[at(source.body)].center_of_mass,
                joint.bodies[at(target.body)].center_of_mass,
                make_springs(source, pair.refine),
                RayCaster(target.spring_surface()),
                {},
                0.0,
                target.max_thickness(),
                pair.law,
                nullptr};
  for (int i = 0; i < bed.springs.size(); ++i)
    for (const Vector3d& corner : bed.springs.triangle[at(i)])
      bed.foot_radius = std::max(bed.foot_radius, (corner - bed.springs.foot[at(i)]).norm());
  bed.rim_distance = rim_distances(target.spring_surface(), 4.0 * bed.foot_radius);
  if (bed.law == Law::Layer) bed.layers = make_layer_bed(bed);
  return bed;
}

namespace {

// ---- coverage: the part of a foot triangle that lies over the target --------------------------------------------

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

/// A linear functional of the motion of the target relative to the source: sum of v . (delta_target - delta_source)(r)
/// over points r, stored like forces v at r: their sum and their moment about a point.
struct Functional {
  Vector3d force = Vector3d::Zero();
  Vector3d moment = Vector3d::Zero();
};

struct Coverage {
  double fraction = 0.0;  ///< of the foot triangle's area
  double area = 0.0;
  Vector3d centroid = Vector3d::Zero();                   ///< of the covered part, in the foot triangle's plane
  Vector3d e1 = Vector3d::Zero(), e2 = Vector3d::Zero();  ///< axes of that plane
  Functional area_rate, centroid_rate[2];  ///< d(area), d(centroid) along e1, e2: the rim sweeps over the foot triangle
};

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
        const Vector3d v = 0.5 * outward_times_length, arm = (r - reference).cross(v);
        result.area_rate.force += v;
        result.area_rate.moment += arm;
        for (int k = 0; k < 2; ++k) {
          result.centroid_rate[k].force += x[k] * v;
          result.centroid_rate[k].moment += x[k] * arm;
        }
      }
    }
  }
  if (result.area <= 0 || foot_area <= 0) return {};
  moment /= result.area;
  result.centroid = foot[0] + moment.x() * result.e1 + moment.y() * result.e2;
  // d(centroid) = (d(area * centroid) - centroid d(area)) / area
  for (int k = 0; k < 2; ++k) {
    result.centroid_rate[k].force = (result.centroid_rate[k].force - moment[k] * result.area_rate.force) / result.area;
    result.centroid_rate[k].moment =
        (result.centroid_rate[k].moment - moment[k] * result.area_rate.moment) / result.area;
  }
  result.fraction = std::min(1.0, result.area / foot_area);
  return result;
}

/// Barycentric weights of a point in the plane of a triangle.
std::array<double, 3> weights_in(const std::array<Vector3d, 3>& c, const Vector3d& x) {
  const Vector3d normal = (c[1] - c[0]).cross(c[2] - c[0]);
  const double twice2 = normal.squaredNorm();
  const double w0 = (c[1] - x).cross(c[2] - x).dot(normal) / twice2,
               w1 = (c[2] - x).cross(c[0] - x).dot(normal) / twice2;
  return {w0, w1, 1 - w0 - w1};
}

/// Gradient of the linear thickness field in a triangle.
Vector3d thickness_gradient(const SurfaceMesh& mesh, const std::vector<double>& thickness, int t) {
  const auto& tri = mesh.triangles[at(t)];
  return linear_gradient(mesh, t, {thickness[at(tri[0])], thickness[at(tri[1])], thickness[at(tri[2])]});
}

LineHit cast(const SpringBed& bed, const Vector3d& foot, const Vector3d& n, double t_s) {
  if (bed.pair->source_layer().springs_at == SpringsAt::Bone) {
    // from bone to bone: a target bone behind the source's bone surface is too deep
    return bed.target.nearest_facing(foot, n, -2.0 * (t_s + bed.max_target_thickness), 0.0, kInfinity);
  }
  const double deep = t_s + bed.max_target_thickness;
  return bed.target.nearest_facing(foot, n, -4.0 * deep, -deep, kInfinity);
}

void set_hit(SpringStates& s, int i, const LineHit& hit) {
  s.triangle[at(i)] = hit.point.triangle;
  s.end_weights[at(i)] = hit.point.weights;
  s.gap[at(i)] = hit.point.triangle >= 0 ? hit.distance : kInfinity;  // the ray's length, made a gap at the end
  s.coverage[at(i)] = hit.point.triangle >= 0 ? 1.0 : 0.0;
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
    bulge[k] = bulge_height(bed.pair->source_layer().spring_surface(), bed.springs.surface_triangle[k], in_surface);
  } else if (s.triangle[k] < 0) {
    return {};  // a covered part so far from convex that neither its middle nor the triangle's is covered: left out
  }
  s.coverage[k] = covered.fraction;
  return covered;
}

}  // namespace

/// (E2), (E3) and the chain rule (E4): at the bone Delta = t_s + t_t - L, at the articular surface Delta = -g. The
/// bulge at q changes like the thickness there.
Vector3d overlap_rate(const SpringBed& bed, const SpringStates& s, int i, double strain_target, const Pose& target) {
  const auto k = at(i);
  const int t = s.triangle[k];
  const SurfaceMesh& mesh = bed.target.mesh();
  const Layer& layer = bed.pair->target_layer();
  const Vector3d& m = mesh.normals[at(t)];
  const Vector3d direction = target.rotation.transpose() * s.direction[k];
  const double mn = m.dot(direction);
  Vector3d gradient = bulge_gradient(mesh, t, s.end_weights[k]);
  if (!layer.rigid) gradient -= strain_target * thickness_gradient(mesh, layer.thickness, t);
  return target.rotation * Vector3d(-m / mn - (gradient - m * (direction.dot(gradient) / mn)));
}

Vector3d source_overlap_gradient(const SpringBed& bed, const SpringStates& s, int i, double strain_source,
                                 const Pose& source) {
  const Layer& layer = bed.pair->source_layer();
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

std::vector<SurfacePart> parts_under_spring(const SpringBed& bed, const RelativePose& relative,
                                            const SurfaceMesh& surface, const SpringStates& s, int i, int first,
                                            int end) {
  const auto k = at(i);
  std::array<Vector3d, 3> foot;
  for (std::size_t c = 0; c < 3; ++c) foot[c] = relative.rotation * bed.springs.triangle[k][c] + relative.shift;
  std::vector<SurfacePart> parts =
      parts_under_foot(foot, bed.springs.area[k], relative.rotation * bed.springs.direction[k], surface, first, end);
  if (parts.empty()) {
    SurfacePart part;
    part.triangle = first;
    part.area = s.area[k];
    part.corners = 3;
    part.corner = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    parts.push_back(part);
  }
  return parts;
}

SpringStates project_springs(const SpringBed& bed, const Pose& source, const Pose& target,
                             const PressOptions& options) {
  const ContactPair& pair = *bed.pair;
  const Layer &source_layer = pair.source_layer(), &target_layer = pair.target_layer();
  const bool at_bone = source_layer.springs_at == SpringsAt::Bone;
  const SurfaceMesh& mesh = bed.target.mesh();
  const Springs& springs = bed.springs;
  const int n_springs = springs.size();
  const auto n = static_cast<std::size_t>(n_springs);

  SpringStates s;
  s.triangle.resize(n);
  s.coverage.resize(n);
  s.foot.resize(n);
  s.direction.resize(n);
  s.end.resize(n);
  s.normal.resize(n);
  s.end_weights.resize(n);
  s.gap.resize(n);
  s.t_source.resize(n);
  s.t_target.resize(n);
  s.overlap.resize(n);
  s.pressure.resize(n);
  s.strain.resize(n);
  s.strain_source.resize(n);
  s.strain_target.resize(n);
  s.per_overlap.resize(n);
  s.per_motion.resize(n);
  s.area.resize(n);
  s.too_deep.resize(n);

  const RelativePose relative = relative_pose(source, bed.source_center, target, bed.target_center);

  const auto parallel = [&](const auto& body) {
    tbb::parallel_for(tbb::blocked_range<int>(0, n_springs, 256), [&](const tbb::blocked_range<int>& range) {
      for (int i = range.begin(); i < range.end(); ++i) body(i);
    });
  };

  std::vector<double> bulge = springs.bulge;
  parallel([&](int i) {
    const auto& t = springs.corner_thickness[at(i)];
    s.t_source[at(i)] = (t[0] + t[1] + t[2]) / 3.0;
    s.foot[at(i)] = relative.rotation * springs.foot[at(i)] + relative.shift;
    set_hit(s, i, cast(bed, s.foot[at(i)], relative.rotation * springs.direction[at(i)], s.t_source[at(i)]));
  });

  // Springs that may reach over the target's rim: those whose ray met it near the rim, and those beside one that hit.
  const SurfaceMesh& source_mesh = source_layer.spring_surface();
  std::vector<double> distance_at(source_mesh.triangles.size(), kInfinity);  // of a ray from this triangle
  for (int i = 0; i < n_springs; ++i)
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
  std::vector<std::pair<int, double>> at_rim;  // spring, distance to the target hereabouts
  for (int i = 0; i < n_springs; ++i) {
    const int t = s.triangle[at(i)];
    if (t < 0) {
      const double distance = distance_beside(springs.surface_triangle[at(i)]);
      if (std::isfinite(distance)) at_rim.emplace_back(i, distance);
    } else {
      if (bed.rim_distance[at(t)] >= 3.0 * bed.foot_radius) continue;  // most springs: no need to know the tilt
      // the foot triangle, seen along n on a target tilted by m.n, reaches this far from q
      const double tilt = -mesh.normals[at(t)].dot(relative.rotation * springs.direction[at(i)]);
      if (bed.rim_distance[at(t)] < 1.5 * bed.foot_radius / std::max(tilt, 0.5)) at_rim.emplace_back(i, s.gap[at(i)]);
    }
  }
  std::vector<Coverage> covered(at_rim.size());
  tbb::parallel_for(std::size_t{0}, at_rim.size(), [&](std::size_t i) {
    covered[i] = cover_spring(bed, relative, s, bulge, at_rim[i].first, at_rim[i].second);
  });

  parallel([&](int i) {
    const auto k = at(i);
    const Vector3d direction = relative.rotation * springs.direction[k];
    s.direction[k] = target.rotation * direction;
    const Vector3d foot = s.foot[k];
    s.foot[k] = target.center + target.rotation * (foot - bed.target_center);
    s.area[k] = 0.0;
    s.overlap[k] = s.pressure[k] = s.strain[k] = s.strain_source[k] = s.strain_target[k] = s.per_overlap[k] = 0.0;
    s.per_motion[k].setZero();
    s.too_deep[k] = 0;
    s.t_target[k] = 0.0;
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
    s.t_target[k] = interpolate(mesh, target_layer.thickness, {t, s.end_weights[k]});
    const double h = s.t_source[k] + s.t_target[k];
    const double length = distance - bulge[k] - bulge_height(mesh, t, s.end_weights[k]);  // between the smooth surfaces
    s.gap[k] = at_bone ? length - h : length;                                             // (S2)
    if (s.gap[k] <= -h) {
      s.too_deep[k] = 1;
      s.coverage[k] = 0.0;
      return;
    }
    s.area[k] = s.coverage[k] * springs.area[k];
    const double overlap = std::max(0.0, -s.gap[k]);
    if (overlap <= 0.0) return;
    s.overlap[k] = overlap;
    if (bed.layers) return;  // the layers decide together, below
    const SpringResponse r = spring_response(bed.law, source_layer.elasticity, target_layer.elasticity, s.t_source[k],
                                             s.t_target[k], overlap, pair.interface_compliance);
    s.pressure[k] = r.pressure;
    s.strain_source[k] = r.strain_source;
    s.strain_target[k] = r.strain_target;
    s.strain[k] = std::max(r.strain_source, r.strain_target);
    s.per_overlap[k] = r.per_overlap;
    s.per_motion[k] =
        r.per_overlap * overlap_rate(bed, s, i, at_bone ? r.strain_target - 1.0 : r.strain_target, target);
  });

  for (std::size_t i = 0; i < at_rim.size(); ++i) {
    const auto k = at(at_rim[i].first);
    if (covered[i].fraction <= 0 || s.area[k] <= 0) continue;
    const Coverage& c = covered[i];
    RimSpring rim;
    rim.spring = at_rim[i].first;
    const Vector3d between = target.center - source.center;
    const auto functional = [&](const Functional& f) {
      const Vector3d force = target.rotation * f.force, moment = target.rotation * f.moment;
      Eigen::Matrix<double, 12, 1> row;
      row << force, moment, -force, -(moment + between.cross(force));
      return row;
    };
    rim.area_rate = functional(c.area_rate);
    rim.foot_rate = (target.rotation * c.e1) * functional(c.centroid_rate[0]).transpose() +
                    (target.rotation * c.e2) * functional(c.centroid_rate[1]).transpose();
    s.rim.push_back(rim);
  }

  if (bed.layers) press_layers(*bed.layers, bed, s, source, target, options);

  const auto bare = [&](const RimSpring& rim) { return s.pressure[at(rim.spring)] <= 0; };
  s.rim.erase(std::remove_if(s.rim.begin(), s.rim.end(), bare), s.rim.end());
  for (RimSpring& rim : s.rim) {
    if (bed.layers) break;  // there it is part of the rates
    const auto k = at(rim.spring);
    rim.pressure_gradient =
        -s.per_motion[k] + s.per_overlap[k] * source_overlap_gradient(bed, s, rim.spring, s.strain_source[k], source);
  }
  return s;
}

SpringDepth spring_depth(const SpringStates& s) {
  SpringDepth depth;
  for (int i = 0; i < s.size(); ++i) {
    depth.through += s.too_deep[at(i)];
    depth.strained += s.strain[at(i)] > kStrainLimit;
    depth.largest = std::max(depth.largest, s.strain[at(i)]);
  }
  return depth;
}

ContactWrench contact_wrench(const SpringStates& s, const Pose& source, const Pose& target) {
  using Vector12 = Eigen::Matrix<double, 12, 1>;
  using Matrix12 = Eigen::Matrix<double, 12, 12>;
  // Sums are made in chunks of a fixed size, added in their order: the same bits for any number of threads.
  constexpr int kChunk = 2048;
  const int chunks = (s.size() + kChunk - 1) / kChunk;
  std::vector<ContactWrench, Eigen::aligned_allocator<ContactWrench>> partial(at(chunks));
  tbb::parallel_for(0, chunks, [&](int c) {
    ContactWrench& sum = partial[at(c)];
    for (int i = c * kChunk; i < std::min(s.size(), (c + 1) * kChunk); ++i) {
      const auto k = at(i);
      if (s.area[k] <= 0 || s.pressure[k] <= 0) continue;
      const Vector3d& n = s.direction[k];
      const Vector3d arm_t = s.foot[k] - target.center, arm_s = s.foot[k] - source.center;
      Vector12 w, kappa;
      w << n, arm_t.cross(n), -n, -arm_s.cross(n);
      const Vector3d& m = s.per_motion[k];
      const Vector3d end_t = s.end[k] - target.center, end_s = s.end[k] - source.center;
      kappa << m, end_t.cross(m), -m, -end_s.cross(m);
      if (s.rates.rows() > 0) {  // of the motion relative to the source, about the target's centre
        const Vector3d a = s.rates.row(i).head<3>(), w = s.rates.row(i).tail<3>();
        kappa << a, w, -a, -w - Vector3d(target.center - source.center).cross(a);
      }
      sum.wrench += s.pressure[k] * s.area[k] * w;
      sum.derivative.noalias() += (s.area[k] * w) * kappa.transpose();
      sum.normal_force += s.pressure[k] * s.area[k];
    }
  });
  ContactWrench total;
  // Over the rim the covered area and the foot change too.
  for (const RimSpring& rim : s.rim) {
    const auto k = at(rim.spring);
    const Vector3d& n = s.direction[k];
    const Vector3d force = s.pressure[k] * s.area[k] * n;
    Vector12 w;
    w << n, (s.foot[k] - target.center).cross(n), -n, -(s.foot[k] - source.center).cross(n);
    total.derivative +=
        w * (s.pressure[k] * rim.area_rate.transpose() + s.area[k] * rim.pressure_gradient.transpose() * rim.foot_rate);
    total.derivative.block<3, 12>(3, 0) -= skew(force) * rim.foot_rate;
    total.derivative.block<3, 12>(9, 0) += skew(force) * rim.foot_rate;
  }
  for (const ContactWrench& part : partial) {
    total.wrench += part.wrench;
    total.derivative += part.derivative;
    total.normal_force += part.normal_force;
  }
  // The springs turn with the source: with F, M the force and moment on the target,
  //   dF = w_s x F,   dM = (v_s - v_t) x F - w_s-terms that sum to  (-[M]x + [F]x [c_t - c_s]x) w_s,   dM_s = w_s x
  //   M_s.
  const Vector3d F = total.wrench.segment<3>(0), M = total.wrench.segment<3>(3), M_s = total.wrench.segment<3>(9);
  Matrix12& K = total.derivative;
  K.block<3, 3>(0, 9) -= skew(F);
  K.block<3, 3>(6, 9) += skew(F);
  K.block<3, 3>(3, 6) -= skew(F);
  K.block<3, 3>(3, 0) += skew(F);
  K.block<3, 3>(3, 9) += -skew(M) + skew(F) * skew(Vector3d(target.center - source.center));
  K.block<3, 3>(9, 9) -= skew(M_s);
  return total;
}

Eigen::Matrix<double, 12, 12> closing_stiffness(const SpringBed& bed, const SpringStates& s, const Pose& source,
                                                const Pose& target, const Eigen::Matrix<double, 12, 1>& force,
                                                const std::array<bool, 12>& free) {
  using Vector12 = Eigen::Matrix<double, 12, 1>;
  const ContactPair& pair = *bed.pair;
  Eigen::Matrix<double, 12, 12> K = Eigen::Matrix<double, 12, 12>::Zero();
  std::vector<Vector12> opening(at(s.size()), Vector12::Zero());  // d(gap) of small motions
  double least_thickness = kInfinity;
  for (int i = 0; i < s.size(); ++i) {
    const auto k = at(i);
    if (s.triangle[k] < 0 || s.area[k] <= 0) continue;
    const SpringResponse r = spring_response(bed.law, pair.source_layer().elasticity, pair.target_layer().elasticity,
                                             s.t_source[k], s.t_target[k], 0.0, pair.interface_compliance);
    const Vector3d& n = s.direction[k];
    const Vector3d m = s.normal[k] / s.normal[k].dot(n);  // (E2)
    const Vector3d end_t = s.end[k] - target.center, end_s = s.end[k] - source.center;
    opening[k] << m, end_t.cross(m), -m, -end_s.cross(m);
    for (std::size_t d = 0; d < 12; ++d)
      if (!free[d]) opening[k][static_cast<Eigen::Index>(d)] = 0.0;
    K += r.per_overlap * s.area[k] * opening[k] * opening[k].transpose();
    least_thickness = std::min(least_thickness, s.t_source[k] + s.t_target[k]);
  }
  // The motion under the force; rotations in units of a length, so that singular values can be told apart.
  const double length =
      std::max(1e-300, std::sqrt(K.diagonal().segment<3>(3).sum() + K.diagonal().segment<3>(9).sum()) /
                           std::sqrt(std::max(1e-300, K.trace())));
  Vector12 scale = Vector12::Ones();
  scale.segment<3>(3).setConstant(1 / std::max(length, 1e-12));
  scale.segment<3>(9) = scale.segment<3>(3);
  Vector12 f = force;
  for (std::size_t d = 0; d < 12; ++d)
    if (!free[d]) f[static_cast<Eigen::Index>(d)] = 0.0;
  Eigen::JacobiSVD<Eigen::Matrix<double, 12, 12>> svd(scale.asDiagonal() * K * scale.asDiagonal(),
                                                      Eigen::ComputeFullU | Eigen::ComputeFullV);
  svd.setThreshold(1e-6);
  const Vector12 motion = scale.asDiagonal() * svd.solve(Vector12(scale.asDiagonal() * f));
  double way = kInfinity, fastest = 0.0;
  for (int i = 0; i < s.size(); ++i) {
    const double closing = -opening[at(i)].dot(motion);
    if (closing > 0) way = std::min(way, std::max(0.0, s.gap[at(i)]) / closing);
    fastest = std::max(fastest, closing);
  }
  // The force opens the joint: what else holds the bodies decides. Enough to keep a solver's matrix regular, no more.
  if (!std::isfinite(way) || fastest <= 0) return force.isZero() ? K : Eigen::Matrix<double, 12, 12>(1e-6 * K);
  way += 0.01 * least_thickness / fastest;
  return K / way;
}

}  // namespace dea

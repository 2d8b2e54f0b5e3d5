#include "springs.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace dea {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::size_t at(int i) { return static_cast<std::size_t>(i); }

Eigen::Matrix3d skew(const Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

}  // namespace

Springs make_springs(const Layer& source, int refine) {
  assert(refine >= 1);
  const SurfaceMesh& mesh = source.spring_surface();
  Springs s;
  const double step = 1.0 / refine;
  const auto add = [&](int t, const std::array<std::array<double, 3>, 3>& w) {
    std::array<Vector3d, 3> corners;
    std::array<double, 3> thickness = {0, 0, 0};
    for (std::size_t c = 0; c < 3; ++c) {
      corners[c] = position(mesh, {t, w[c]});
      thickness[c] = interpolate(mesh, source.thickness, {t, w[c]});
    }
    s.triangle.push_back(corners);
    s.foot.push_back((corners[0] + corners[1] + corners[2]) / 3.0);
    s.direction.push_back(mesh.normals[at(t)]);
    s.area.push_back(mesh.areas[at(t)] * step * step);
    s.corner_thickness.push_back(thickness);
    s.surface_triangle.push_back(t);
    s.weights.push_back(w);
  };
  const auto corner = [&](int i, int j) -> std::array<double, 3> { return {1.0 - (i + j) * step, i * step, j * step}; };
  for (int t = 0; t < mesh.size(); ++t) {
    if (refine == 1) {
      add(t, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}});
      continue;
    }
    for (int i = 0; i < refine; ++i) {
      for (int j = 0; i + j < refine; ++j) {
        add(t, {corner(i, j), corner(i + 1, j), corner(i, j + 1)});
        if (i + j + 2 <= refine) add(t, {corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)});
      }
    }
  }
  return s;
}

SpringBed make_spring_bed(const Joint& joint, const ContactPair& pair, const Settings& settings) {
  const Layer &source = pair.source_layer(), &target = pair.target_layer();
  SpringBed bed{&pair, source.body, target.body, joint.bodies[at(source.body)].center_of_mass,
                joint.bodies[at(target.body)].center_of_mass, make_springs(source, settings.refine),
                RayCaster(target.spring_surface()), {}, 0.0, target.max_thickness(), settings.law};
  for (int i = 0; i < bed.springs.size(); ++i)
    for (const Vector3d& corner : bed.springs.triangle[at(i)])
      bed.foot_radius = std::max(bed.foot_radius, (corner - bed.springs.foot[at(i)]).norm());
  bed.rim_distance = rim_distances(target.spring_surface(), 4.0 * bed.foot_radius);
  return bed;
}

namespace {

// ---- coverage: the part of a foot triangle that lies over the target --------------------------------------------

using Point2 = Eigen::Vector2d;

double cross2(const Point2& a, const Point2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Clips a convex polygon (counter-clockwise) by the half plane left of a -> b, in place (Sutherland-Hodgman).
void clip(std::vector<Point2>& polygon, const Point2& a, const Point2& b, std::vector<Point2>& scratch) {
  scratch.clear();
  const Point2 edge = b - a;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point2 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double dp = cross2(edge, p - a), dq = cross2(edge, q - a);
    if (dp >= 0) scratch.push_back(p);
    if ((dp > 0 && dq < 0) || (dp < 0 && dq > 0)) scratch.push_back(p + dp / (dp - dq) * (q - p));
  }
  polygon.swap(scratch);
}

struct Coverage {
  double fraction = 0.0;           ///< of the foot triangle's area
  Vector3d centroid = Vector3d::Zero();  ///< of the covered part, in the foot triangle's plane
};

/// The part of the foot triangle onto which target triangles project along n, found by walking over the target from
/// `seeds`. Exact for a target that does not fold over itself inside the foot triangle.
Coverage coverage(const SurfaceMesh& target, const std::array<Vector3d, 3>& foot, const Vector3d& n,
                  const std::vector<int>& seeds) {
  const Vector3d e1 = (foot[1] - foot[0]).normalized();
  const Vector3d e2 = n.cross(e1);
  const auto project = [&](const Vector3d& x) { return Point2((x - foot[0]).dot(e1), (x - foot[0]).dot(e2)); };
  const Point2 corner[3] = {project(foot[0]), project(foot[1]), project(foot[2])};
  const double foot_area = 0.5 * cross2(corner[1] - corner[0], corner[2] - corner[0]);
  std::vector<int> queue = seeds;
  std::sort(queue.begin(), queue.end());
  queue.erase(std::unique(queue.begin(), queue.end()), queue.end());
  std::vector<Point2> polygon, scratch;
  double area = 0.0;
  Point2 moment = Point2::Zero();
  for (std::size_t next = 0; next < queue.size() && next < 4096; ++next) {
    const int t = queue[next];
    if (!(target.normals[at(t)].dot(n) < 0)) continue;
    // seen along n the target's triangles run clockwise: take them the other way round
    polygon = {project(target.corner(t, 0)), project(target.corner(t, 2)), project(target.corner(t, 1))};
    for (int k = 0; k < 3 && !polygon.empty(); ++k) clip(polygon, corner[k], corner[(k + 1) % 3], scratch);
    if (polygon.size() < 3) continue;
    double part = 0.0;
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
      const double a = 0.5 * cross2(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
      part += a;
      moment += a * (polygon[0] + polygon[i] + polygon[i + 1]) / 3.0;
    }
    area += part;
    if (part <= 0) continue;
    for (int neighbour : target.neighbours[at(t)])
      if (neighbour >= 0 && std::find(queue.begin(), queue.end(), neighbour) == queue.end()) queue.push_back(neighbour);
  }
  Coverage result;
  if (area <= 0 || foot_area <= 0) return result;
  result.fraction = std::min(1.0, area / foot_area);
  moment /= area;
  result.centroid = foot[0] + moment.x() * e1 + moment.y() * e2;
  return result;
}

double thickness_in_triangle(const std::array<Vector3d, 3>& corners, const std::array<double, 3>& values, const Vector3d& x) {
  const Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  const double twice2 = normal.squaredNorm();
  const double w0 = (corners[1] - x).cross(corners[2] - x).dot(normal) / twice2;
  const double w1 = (corners[2] - x).cross(corners[0] - x).dot(normal) / twice2;
  return w0 * values[0] + w1 * values[1] + (1 - w0 - w1) * values[2];
}

/// Gradient of the linear thickness field in a triangle.
Vector3d thickness_gradient(const SurfaceMesh& mesh, const std::vector<double>& thickness, int t) {
  const Vector3d e1 = mesh.corner(t, 1) - mesh.corner(t, 0), e2 = mesh.corner(t, 2) - mesh.corner(t, 0);
  const Vector3d normal = e1.cross(e2);
  const auto& tri = mesh.triangles[at(t)];
  const double t0 = thickness[at(tri[0])];
  return ((thickness[at(tri[1])] - t0) * e2.cross(normal) + (thickness[at(tri[2])] - t0) * normal.cross(e1)) /
         normal.squaredNorm();
}

/// The source seen from the target's reference frame: X_target = rotation * X_source + shift.
struct RelativePose {
  Eigen::Matrix3d rotation;
  Vector3d shift;
};

LineHit cast(const SpringBed& bed, const Vector3d& foot, const Vector3d& n, double t_s) {
  if (bed.pair->source_layer().springs_at == SpringsAt::Bone) {
    // from bone to bone: a target bone behind the source's bone surface is too deep
    return bed.target.nearest_facing(foot, n, -2.0 * (t_s + bed.max_target_thickness), 0.0, kInfinity);
  }
  const double deep = t_s + bed.max_target_thickness;
  return bed.target.nearest_facing(foot, n, -4.0 * deep, -deep, kInfinity);
}

void set_hit(const SpringBed& bed, SpringStates& s, int i, const LineHit& hit) {
  s.triangle[at(i)] = hit.point.triangle;
  s.end_weights[at(i)] = hit.point.weights;
  s.gap[at(i)] = hit.point.triangle >= 0 ? hit.distance : kInfinity;  // made a gap (not a length) by finish_spring
  s.coverage[at(i)] = hit.point.triangle >= 0 ? 1.0 : 0.0;
  (void)bed;
}

/// Near the rim of the target: how much of the foot triangle lies over it, and the spring moved to the middle of that.
void cover_spring(const SpringBed& bed, const RelativePose& relative, SpringStates& s, int i) {
  const SurfaceMesh& target = bed.target.mesh();
  const Vector3d n = relative.rotation * bed.springs.direction[at(i)];
  std::array<Vector3d, 3> foot;
  std::vector<int> seeds;
  if (s.triangle[at(i)] >= 0) seeds.push_back(s.triangle[at(i)]);
  const Vector3d middle = relative.rotation * bed.springs.foot[at(i)] + relative.shift;
  LineHit any;
  for (std::size_t k = 0; k < 3; ++k) {
    foot[k] = relative.rotation * bed.springs.triangle[at(i)][k] + relative.shift;
    const Vector3d inside = foot[k] + 1e-3 * (middle - foot[k]);
    const LineHit hit = cast(bed, inside, n, bed.springs.corner_thickness[at(i)][k]);
    if (hit.point.triangle < 0) continue;
    seeds.push_back(hit.point.triangle);
    any = hit;
  }
  if (seeds.empty()) return;
  const Coverage covered = coverage(target, foot, n, seeds);
  if (covered.fraction >= 1.0 - 1e-12) return;
  if (covered.fraction <= 0.0) {
    s.triangle[at(i)] = -1;
    s.gap[at(i)] = kInfinity;
    s.coverage[at(i)] = 0.0;
    return;
  }
  const double t_s = thickness_in_triangle(foot, bed.springs.corner_thickness[at(i)], covered.centroid);
  LineHit hit = cast(bed, covered.centroid, n, t_s);
  if (hit.point.triangle < 0) {
    // a covered part that is not convex: keep the ray that met the target
    if (s.triangle[at(i)] < 0) set_hit(bed, s, i, any);
  } else {
    set_hit(bed, s, i, hit);
    s.foot[at(i)] = covered.centroid;  // target frame for now
    s.t_source[at(i)] = t_s;
  }
  s.coverage[at(i)] = covered.fraction;
}

}  // namespace

SpringStates project_springs(const SpringBed& bed, const Pose& source, const Pose& target) {
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

  // x = c_s + R_s (X - C_s) = c_t + R_t (Y - C_t)  =>  Y = R_t^T R_s X + shift
  RelativePose relative;
  relative.rotation = target.rotation.transpose() * source.rotation;
  relative.shift = bed.target_center +
                   target.rotation.transpose() * (source.center - target.center - source.rotation * bed.source_center);

  const auto parallel = [&](const auto& body) {
    tbb::parallel_for(tbb::blocked_range<int>(0, n_springs, 256), [&](const tbb::blocked_range<int>& range) {
      for (int i = range.begin(); i < range.end(); ++i) body(i);
    });
  };

  parallel([&](int i) {
    const auto& t = springs.corner_thickness[at(i)];
    s.t_source[at(i)] = (t[0] + t[1] + t[2]) / 3.0;
    s.foot[at(i)] = relative.rotation * springs.foot[at(i)] + relative.shift;
    set_hit(bed, s, i, cast(bed, s.foot[at(i)], relative.rotation * springs.direction[at(i)], s.t_source[at(i)]));
  });

  // Springs that may reach over the target's rim: those whose ray met it near the rim, and those beside a spring that hit.
  std::vector<char> triangle_hit(source_layer.spring_surface().triangles.size(), 0);
  for (int i = 0; i < n_springs; ++i)
    if (s.triangle[at(i)] >= 0) triangle_hit[at(springs.surface_triangle[at(i)])] = 1;
  const auto beside_a_hit = [&](int t) {
    if (triangle_hit[at(t)]) return true;
    for (int first : source_layer.spring_surface().neighbours[at(t)]) {
      if (first < 0) continue;
      if (triangle_hit[at(first)]) return true;
      for (int second : source_layer.spring_surface().neighbours[at(first)])
        if (second >= 0 && triangle_hit[at(second)]) return true;
    }
    return false;
  };
  parallel([&](int i) {
    const int t = s.triangle[at(i)];
    bool may_reach_over;
    if (t < 0) {
      may_reach_over = beside_a_hit(springs.surface_triangle[at(i)]);
    } else {
      // the foot triangle, seen along n on a target tilted by m.n, reaches this far from q
      const double tilt = -mesh.normals[at(t)].dot(relative.rotation * springs.direction[at(i)]);
      may_reach_over = bed.rim_distance[at(t)] < 2.0 * bed.foot_radius / std::max(tilt, 0.5);
    }
    if (may_reach_over) cover_spring(bed, relative, s, i);
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
    s.gap[k] = at_bone ? distance - h : distance;  // (S2)
    if (s.gap[k] <= -h) {
      s.too_deep[k] = 1;
      s.coverage[k] = 0.0;
      return;
    }
    s.area[k] = s.coverage[k] * springs.area[k];
    const double overlap = std::max(0.0, -s.gap[k]);
    if (overlap <= 0.0) return;
    const SpringResponse r = spring_response(bed.law, source_layer.elasticity, target_layer.elasticity, s.t_source[k],
                                             s.t_target[k], overlap);
    s.overlap[k] = overlap;
    s.pressure[k] = r.pressure;
    s.strain_source[k] = r.strain_source;
    s.strain_target[k] = r.strain_target;
    s.strain[k] = std::max(r.strain_source, r.strain_target);
    s.per_overlap[k] = r.per_overlap;
    // (E2), (E3) and the chain rule (E4): at the bone Delta = t_s + t_t - L, at the articular surface Delta = -g
    const double mn = m.dot(direction);
    const double per_t = r.per_t_target + (at_bone ? r.per_overlap : 0.0);
    Vector3d kappa = -r.per_overlap / mn * m;
    if (!target_layer.rigid) {
      const Vector3d gradient = thickness_gradient(mesh, target_layer.thickness, t);
      kappa -= per_t * (gradient - m * (direction.dot(gradient) / mn));
    }
    s.per_motion[k] = target.rotation * kappa;
  });
  return s;
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
      sum.wrench += s.pressure[k] * s.area[k] * w;
      sum.derivative.noalias() += (s.area[k] * w) * kappa.transpose();
      sum.normal_force += s.pressure[k] * s.area[k];
    }
  });
  ContactWrench total;
  for (const ContactWrench& part : partial) {
    total.wrench += part.wrench;
    total.derivative += part.derivative;
    total.normal_force += part.normal_force;
  }
  // The springs turn with the source: with F, M the force and moment on the target,
  //   dF = w_s x F,   dM = (v_s - v_t) x F - w_s-terms that sum to  (-[M]x + [F]x [c_t - c_s]x) w_s,   dM_s = w_s x M_s.
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

}  // namespace dea

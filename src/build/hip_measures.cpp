#include "src/build/hip_measures.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "src/base/decompositions.h"
#include "src/base/value_above.h"
#include "src/build/mend_surface.h"
#include "src/build/region.h"
#include "src/geometry/ray_caster.h"

namespace dea {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kOnSphere = 0.05;  // of the radius: a point of the ball, of the bowl
constexpr double kWall = 0.15;      // of the radius: what lies farther out is not the socket but what is behind its rim
constexpr double kRoof = 0.06;      // of the radius: what lies farther out is the fossa
constexpr double kDegree = 1.0 / kDegreesPerRadian;
constexpr double kStep = 0.5 * kDegree;  // of the search for an edge, before it is halved
constexpr int kDent = 6;                 // steps: what is farther out over no more is a dent in the roof, not its end

// ---- spheres -------------------------------------------------------------------------------------------------------

/// Triangles whose corners are wanted; parts below a twentieth of the largest are left out.
TriangleSurface part_with(const TriangleSurface& s, const std::vector<char>& points) {
  std::vector<char> wanted(s.triangles.size());
  for (std::size_t t = 0; t < wanted.size(); ++t)
    wanted[t] = std::all_of(s.triangles[t].begin(), s.triangles[t].end(), [&](int p) { return points[at(p)]; });
  TriangleSurface all = part_of(s, wanted);
  if (all.triangles.empty()) return all;
  const SurfaceParts parts = connected_parts(all);
  return large_parts(all, parts, 0.05 * *std::max_element(parts.area.begin(), parts.area.end()));
}

struct Fitted {
  SphereFit sphere;
  int points = 0;
};

/// From a first sphere to that of all points near it. `sense`: 1 points look away from the centre, -1 towards it.
std::optional<Fitted> grown_sphere(const TriangleSurface& bone, const std::vector<Vector3d>& normals, SphereFit sphere,
                                   double sense) {
  constexpr double kAlong = 0.8;  // cosine between normal and radius: a neck, a rim are no part of the sphere
  std::vector<char> before;
  double near = 3 * kOnSphere;
  int points = 0;
  for (int round = 0; round < 60; ++round) {
    std::vector<char> wanted(bone.points.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      const Vector3d out = bone.points[i] - sphere.center;
      const double r = out.norm();
      wanted[i] = std::abs(r - sphere.radius) < near * sphere.radius && sense * normals[i].dot(out) > kAlong * r;
    }
    const bool settled = near <= kOnSphere && wanted == before;
    const TriangleSurface part = part_with(bone, wanted);
    points = static_cast<int>(part.points.size());
    if (points < 12) return std::nullopt;
    if (settled) break;
    sphere = fit_sphere(mesh_of(part));
    before = std::move(wanted);
    near = std::max(kOnSphere, 0.8 * near);
  }
  return Fitted{sphere, points};
}

/// Points of a bone that face the other, near where they are closest.
std::vector<char> points_that_face(const TriangleSurface& bone, const std::vector<Vector3d>& normals,
                                   const RayCaster& other, double reach) {
  const std::vector<double> gaps = facing_gaps(bone.points, normals, other, reach);
  std::vector<char> facing(gaps.size());
  for (std::size_t i = 0; i < gaps.size(); ++i) facing[i] = std::isfinite(gaps[i]);
  return facing;
}

struct Face {
  SphereFit sphere;
  double sense = 0.0;  ///< mean cosine between normals and radii: near 1 a ball, near -1 a bowl
};

std::optional<Face> face_of(const TriangleSurface& bone, const std::vector<Vector3d>& normals, const RayCaster& other,
                            double reach) {
  const TriangleSurface part = part_with(bone, points_that_face(bone, normals, other, reach));
  if (part.points.size() < 12) return std::nullopt;
  Face face;
  face.sphere = fit_sphere(mesh_of(part));
  const std::vector<Vector3d> n = point_normals(part);
  for (std::size_t i = 0; i < n.size(); ++i)
    face.sense += n[i].dot((part.points[i] - face.sphere.center).normalized()) / static_cast<double>(n.size());
  if (face.sphere.rms > 0.15 * face.sphere.radius) return std::nullopt;
  return face;
}

// ---- edges ---------------------------------------------------------------------------------------------------------

/// The socket's surface as the head's centre sees it.
struct Wall {
  const RayCaster& bone;
  Vector3d eye;
  SphereFit socket;

  /// Where a ray meets the bone; farther out than the socket reaches: nowhere.
  std::optional<Vector3d> at(const Vector3d& direction) const {
    const LineHit hit = bone.nearest_facing(eye, direction, 0.0, 0.0, 3 * socket.radius);
    if (hit.point.triangle < 0 || !(hit.distance > 0)) return std::nullopt;
    const Vector3d x = eye + hit.distance * direction;
    if ((x - socket.center).norm() > (1 + kWall) * socket.radius) return std::nullopt;
    return x;
  }
};

/// Where `is` ends between `in`, at which it holds, and `out`, at which it does not: to rounding.
template <class Is>
double end_between(double in, double out, const Is& is) {
  for (int k = 0; k < 60; ++k) {
    const double middle = (in + out) / 2;
    (is(middle) ? in : out) = middle;
  }
  return in;
}

/// The largest angle in (to, from) at which `is` holds, searched downwards. nullopt: nowhere, or at `from` already.
template <class Is>
std::optional<double> outermost(double from, double to, const Is& is) {
  if (is(from)) return std::nullopt;
  for (int k = 1; from - k * kStep > to; ++k) {
    const double angle = from - k * kStep;
    if (is(angle)) return end_between(angle, angle + kStep, is);
  }
  return std::nullopt;
}

/// Directions of a half circle: along `first` at 0, `second` at 90 degrees.
Vector3d turned_from(const Vector3d& first, const Vector3d& second, double angle) {
  return std::cos(angle) * first + std::sin(angle) * second;
}

/// Any unit vector across.
Vector3d across(const Vector3d& axis) {
  Eigen::Index least = 0;
  axis.cwiseAbs().minCoeff(&least);
  return axis.cross(Vector3d::Unit(least)).normalized();
}

constexpr int kDirections = 360;

/// The rim about an axis (unit, out of the socket), counter-clockwise seen from outside.
std::vector<Vector3d> rim_about(const Wall& wall, const Vector3d& axis, const Vector3d& first) {
  std::vector<Vector3d> rim;
  for (int k = 0; k < kDirections; ++k) {
    const Vector3d out = turned_from(first, axis.cross(first), 2 * kPi * k / kDirections);
    const auto direction = [&](double angle) { return turned_from(-axis, out, angle); };
    const std::optional<double> edge =
        outermost(150 * kDegree, 0.0, [&](double angle) { return wall.at(direction(angle)).has_value(); });
    if (edge) rim.push_back(*wall.at(direction(*edge)));
  }
  return rim;
}

struct Plane {
  Vector3d point = Vector3d::Zero(), normal = Vector3d::Zero();
};

Plane plane_through(const std::vector<Vector3d>& points, const std::vector<char>& used, const Vector3d& outwards) {
  Plane plane;
  double count = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (used[i]) {
      plane.point += points[i];
      ++count;
    }
  plane.point /= count;
  Matrix3d spread = Matrix3d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i)
    if (used[i]) spread += (points[i] - plane.point) * (points[i] - plane.point).transpose();
  plane.normal = symmetric_eigen(spread).vectors.col(0).normalized();
  if (plane.normal.dot(outwards) < 0) plane.normal = -plane.normal;
  return plane;
}

/// The plane of most points: those off it by more than three times the middle distance (as a standard deviation) have
/// no say.
Plane plane_of_most(const std::vector<Vector3d>& points, const Vector3d& outwards, double size,
                    std::vector<char>& used) {
  used.assign(points.size(), 1);
  Plane plane = plane_through(points, used, outwards);
  for (int round = 0; round < 50; ++round) {
    std::vector<double> distances(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      distances[i] = std::abs((points[i] - plane.point).dot(plane.normal));
    const double limit = std::max(3 * 1.4826 * value_above(distances, 0.5), 1e-6 * size);
    std::vector<char> now(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) now[i] = distances[i] <= limit;
    if (now == used) break;
    used = now;
    plane = plane_through(points, used, outwards);
  }
  return plane;
}

/// Circle in the plane through the points of it, by least squares: |x|^2 = 2 c.x + (R^2 - |c|^2).
void fit_circle(const Plane& plane, HipMeasures& m) {
  const Vector3d a = across(plane.normal), b = plane.normal.cross(a);
  Eigen::MatrixXd rows(m.rim.size(), 3);
  Eigen::VectorXd squares(m.rim.size());
  double sum = 0, count = 0;
  Eigen::Index n = 0;
  for (std::size_t i = 0; i < m.rim.size(); ++i) {
    if (!m.rim_in_plane[i]) continue;
    const Vector3d x = m.rim[i] - plane.point;
    const Vector2d flat(x.dot(a), x.dot(b));
    rows.row(n) << 2 * flat.x(), 2 * flat.y(), 1;
    squares[n++] = flat.squaredNorm();
    sum += x.dot(plane.normal) * x.dot(plane.normal);
    ++count;
  }
  const Eigen::VectorXd circle = solve_least_norm(rows.topRows(n), squares.head(n));
  m.rim_center = plane.point + circle[0] * a + circle[1] * b;
  m.rim_radius = std::sqrt(std::max(0.0, circle[2] + circle.head<2>().squaredNorm()));
  m.rim_rms = std::sqrt(sum / count);
}

void measure_rim(const Wall& wall, const Vector3d& opening, HipMeasures& m) {
  Vector3d axis = opening;
  Plane plane;
  for (int round = 0; round < 3; ++round) {  // the directions are about the rim's own axis
    Vector3d first = m.axes.col(1) - m.axes.col(1).dot(axis) * axis;
    first = first.norm() > 1e-3 ? Vector3d(first.normalized()) : across(axis);
    m.rim = rim_about(wall, axis, first);
    if (m.rim.size() < kDirections / 2) {
      m.missing.push_back(
          fmt::format("rim plane: found the socket's edge in {} of {} directions, expected half of them", m.rim.size(),
                      kDirections));
      m.rim.clear();
      m.rim_in_plane.clear();
      return;
    }
    plane = plane_of_most(m.rim, axis, m.socket.radius, m.rim_in_plane);
    axis = plane.normal;
  }
  m.rim_normal = axis;
  fit_circle(plane, m);
  const double forwards = axis.dot(m.axes.col(0)), down = -axis.dot(m.axes.col(1)),
               lateral = lateral_sign(m.side) * axis.dot(m.axes.col(2));
  m.inclination_radiographic = std::atan2(lateral, down) * kDegreesPerRadian;
  m.anteversion_radiographic = arc_of_sine(forwards);
  m.inclination_anatomic = 90 - arc_of_sine(down);
  m.anteversion_anatomic = std::atan2(forwards, lateral) * kDegreesPerRadian;
}

// ---- sections ------------------------------------------------------------------------------------------------------

/// The surface's lines in a plane through `center`, within `reach` of it.
std::vector<std::array<Vector2d, 2>> cut_lines(const TriangleSurface& s, const HipSection& section,
                                               const Vector3d& center, double reach) {
  const Vector3d normal = section.across.cross(section.up);
  std::vector<std::array<Vector2d, 2>> lines;
  for (const auto& t : s.triangles) {
    std::array<Vector3d, 3> x;
    std::array<double, 3> side;
    double nearest = kInfinity;
    for (std::size_t k = 0; k < 3; ++k) {
      x[k] = s.points[at(t[k])] - center;
      side[k] = x[k].dot(normal);
      nearest = std::min(nearest, x[k].norm());
    }
    if (nearest > reach) continue;
    std::vector<Vector2d> ends;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      if ((side[k] > 0) == (side[next] > 0)) continue;
      const Vector3d point = x[k] + side[k] / (side[k] - side[next]) * (x[next] - x[k]);
      ends.emplace_back(point.dot(section.across), point.dot(section.up));
    }
    if (ends.size() == 2) lines.push_back({ends[0], ends[1]});
  }
  return lines;
}

/// Angle from straight up to the socket's outer edge, towards `section.across` [rad].
std::optional<double> edge_angle(const Wall& wall, const HipSection& section) {
  return outermost(150 * kDegree, -120 * kDegree,
                   [&](double angle) { return wall.at(turned_from(section.up, section.across, angle)).has_value(); });
}

/// Where a ray from inside a sphere meets it.
Vector3d on_sphere(const Vector3d& eye, const Vector3d& direction, const SphereFit& sphere) {
  const Vector3d from = eye - sphere.center;
  const double along = from.dot(direction);
  return eye + (std::sqrt(along * along - from.squaredNorm() + sphere.radius * sphere.radius) - along) * direction;
}

Vector2d in_section(const HipSection& section, const Vector3d& x) { return {x.dot(section.across), x.dot(section.up)}; }

/// From the outer edge inwards: where the roof leaves the socket's sphere for the fossa.
std::optional<double> roof_angle(const Wall& wall, const HipSection& section, double edge) {
  const auto on_roof = [&](double angle) {
    const std::optional<Vector3d> x = wall.at(turned_from(section.up, section.across, angle));
    return x && (*x - wall.socket.center).norm() <= (1 + kRoof) * wall.socket.radius;
  };
  const double last = std::max(edge - 170 * kDegree, -90 * kDegree);  // lower is no roof
  double first = edge - 0.1 * kStep;
  while (first > last && !on_roof(first)) first -= kStep;  // a rounded edge is not on the sphere
  int off = 0;                                             // steps since the roof was last met
  for (int k = 0; first - k * kStep > last; ++k) {
    const double angle = first - k * kStep;
    off = on_roof(angle) ? 0 : off + 1;
    if (off <= kDent) continue;
    double in = angle + off * kStep;
    while (!on_roof(in)) in += kStep;
    return end_between(in, in - kStep, on_roof);
  }
  return std::nullopt;
}

void measure_sections(const Wall& wall, HipMeasures& m) {
  const auto point_at = [&](const HipSection& section, double angle) {
    return in_section(section, *wall.at(turned_from(section.up, section.across, angle)) - wall.eye);
  };
  const auto no_edge = [&](const char* what, const char* plane) {
    m.missing.push_back(
        fmt::format("{}: found no outer edge of the socket in the {} plane, expected one", what, plane));
  };
  const std::optional<double> lateral = edge_angle(wall, m.coronal), anterior = edge_angle(wall, m.sagittal);
  if (anterior) {
    m.sagittal.edge = point_at(m.sagittal, *anterior);
    m.anterior_center_edge = *anterior * kDegreesPerRadian;
  } else {
    no_edge("anterior center-edge angle", "sagittal");
  }
  if (!lateral) {
    no_edge("lateral center-edge angle, acetabular index", "coronal");
    return;
  }
  m.coronal.edge = point_at(m.coronal, *lateral);
  m.lateral_center_edge = *lateral * kDegreesPerRadian;
  const std::optional<double> medial = roof_angle(wall, m.coronal, *lateral);
  if (!medial) {
    m.missing.push_back(
        "acetabular index: found no end of the roof at a fossa in the coronal plane, expected the bone to leave the "
        "socket's sphere there");
    return;
  }
  m.coronal.roof_end = in_section(
      m.coronal, on_sphere(wall.eye, turned_from(m.coronal.up, m.coronal.across, *medial), m.socket) - wall.eye);
  const Vector2d roof = *m.coronal.edge - *m.coronal.roof_end;
  m.acetabular_index = std::atan2(roof.y(), roof.x()) * kDegreesPerRadian;
}

}  // namespace

double arc_of_sine(double sine) { return std::asin(std::clamp(sine, -1.0, 1.0)) * kDegreesPerRadian; }

std::optional<BallInSocket> find_ball_in_socket(const std::vector<TriangleSurface>& bones, int socket, int ball) {
  std::vector<std::vector<Vector3d>> normals;
  std::vector<RayCaster> casters;
  for (const TriangleSurface& bone : bones) {
    normals.push_back(point_normals(bone));
    casters.emplace_back(mesh_of(bone));
  }
  std::optional<BallInSocket> best;
  for (std::size_t s = 0; s < bones.size(); ++s)
    for (std::size_t b = 0; b < bones.size(); ++b) {
      if (s == b || (socket >= 0 && s != at(socket)) || (ball >= 0 && b != at(ball))) continue;
      double nearest = kInfinity;
      const std::size_t step = 1 + bones[b].points.size() / 5000;
      for (std::size_t i = 0; i < bones[b].points.size(); i += step)
        nearest = std::min(nearest, distance_to(casters[s], bones[b].points[i]));
      const double reach = 3 * nearest + 0.03 * std::min(size_of(bones[s]), size_of(bones[b]));
      const std::optional<Face> bowl = face_of(bones[s], normals[s], casters[b], reach),
                                round = face_of(bones[b], normals[b], casters[s], reach);
      constexpr double kSense = 0.8;
      if (!bowl || !round || bowl->sense > -kSense || round->sense < kSense) continue;
      const std::optional<Fitted> of_bowl = grown_sphere(bones[s], normals[s], bowl->sphere, -1),
                                  of_ball = grown_sphere(bones[b], normals[b], round->sphere, 1);
      if (!of_bowl || !of_ball) continue;
      const double R = of_bowl->sphere.radius, r = of_ball->sphere.radius;
      if ((of_bowl->sphere.center - of_ball->sphere.center).norm() > 0.3 * R || r > 1.1 * R || r < 0.6 * R) continue;
      if (best && best->socket_points + best->ball_points >= of_bowl->points + of_ball->points) continue;
      best = BallInSocket{static_cast<int>(s), static_cast<int>(b), of_bowl->sphere,
                          of_ball->sphere,     of_bowl->points,     of_ball->points};
    }
  return best;
}

Vector3d opening_of(const TriangleSurface& bone, const SphereFit& socket) {
  const std::vector<Vector3d> normals = point_normals(bone);
  const std::vector<double> areas = point_areas(bone);
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 0; i < bone.points.size(); ++i) {
    const Vector3d in = socket.center - bone.points[i];
    if (std::abs(in.norm() - socket.radius) < 3 * kOnSphere * socket.radius && normals[i].dot(in) > 0.7 * in.norm())
      sum += areas[i] * in.normalized();
  }
  return sum.normalized();
}

std::optional<Vector3d> neck_direction(const TriangleSurface& bone, const SphereFit& head) {
  const std::vector<double> areas = point_areas(bone);
  Vector3d sum = Vector3d::Zero();
  double area = 0;
  for (std::size_t i = 0; i < bone.points.size(); ++i) {
    const Vector3d out = bone.points[i] - head.center;
    const double r = out.norm();
    if (r < 1.3 * head.radius || r > 1.6 * head.radius) continue;
    sum += areas[i] / r * out;
    area += areas[i];
  }
  constexpr double kOneSided = 0.6;  // all within a cone of 53 degrees about a neck have 0.8
  if (!(sum.norm() > kOneSided * area)) return std::nullopt;
  return -sum.normalized();
}

HipMeasures measure_hip(const TriangleSurface& socket_bone, const TriangleSurface& head_bone,
                        const BallInSocket& spheres, const Matrix3d& axes, BodySide side) {
  HipMeasures m;
  m.side = side;
  m.axes = axes;
  m.head = spheres.ball_sphere;
  m.socket = spheres.socket_sphere;
  m.head_points = spheres.ball_points;
  m.socket_points = spheres.socket_points;
  m.offset = axes.transpose() * (m.head.center - m.socket.center);
  m.offset.z() *= lateral_sign(side);
  m.coronal.across = lateral_sign(side) * axes.col(2);
  m.sagittal.across = axes.col(0);
  m.coronal.up = m.sagittal.up = axes.col(1);
  const RayCaster caster(mesh_of(socket_bone));
  const Wall wall{caster, m.head.center, m.socket};
  measure_rim(wall, opening_of(socket_bone, m.socket), m);
  measure_sections(wall, m);
  for (HipSection* section : {&m.coronal, &m.sagittal}) {
    section->socket_lines = cut_lines(socket_bone, *section, m.head.center, 2.2 * m.socket.radius);
    section->head_lines = cut_lines(head_bone, *section, m.head.center, 2.2 * m.socket.radius);
  }
  return m;
}

}  // namespace dea

#include "src/geometry/ray_caster.h"

#if DEA_EMBREE >= 4  // the version that CMake found
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <mutex>
#include <new>

#include "src/base/numbers.h"

namespace dea {

namespace {

#if DEA_EMBREE >= 4
void intersect_scene(RTCScene scene, RTCRayQueryContext* context, RTCRayHit* ray) {
  rtcInitRayQueryContext(context);
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.context = context;
  rtcIntersect1(scene, ray, &arguments);
}
#else
using RTCRayQueryContext = RTCIntersectContext;

void intersect_scene(RTCScene scene, RTCRayQueryContext* context, RTCRayHit* ray) {
  rtcInitIntersectContext(context);
  rtcIntersect1(scene, context, ray);
}
#endif

// A barycentric tolerance: a line that meets the shared edge of two triangles belongs to both.
constexpr double kEdgeTolerance = 1e-9;

struct Candidate {
  double distance;
  int triangle;
  std::array<double, 3> weights;
};

/// What the intersection callback needs and collects; Embree hands the pointer to its first member back to us.
struct LineQuery {
  RTCRayQueryContext context;  // must be first
  Vector3d origin, direction;
  double from, limit, to, min_facing;
  double best;  // smallest |distance| of a valid crossing so far
  double tolerance;
  std::vector<Candidate>* found;
};

/// Möller-Trumbore in double precision. Weights may be down to -kEdgeTolerance.
bool intersect(const SurfaceMesh& mesh, int t, const Vector3d& origin, const Vector3d& direction, double* distance,
               std::array<double, 3>* weights) {
  const Vector3d& a = mesh.corner(t, 0);
  const Vector3d e1 = mesh.corner(t, 1) - a, e2 = mesh.corner(t, 2) - a;
  const Vector3d p = direction.cross(e2);
  const double det = e1.dot(p);
  if (det == 0.0) return false;
  const Vector3d s = origin - a;
  const double u = s.dot(p) / det;
  if (!(u >= -kEdgeTolerance && u <= 1.0 + kEdgeTolerance)) return false;
  const Vector3d q = s.cross(e1);
  const double v = direction.dot(q) / det;
  if (!(v >= -kEdgeTolerance && u + v <= 1.0 + kEdgeTolerance)) return false;
  *distance = e2.dot(q) / det;
  *weights = {1.0 - u - v, u, v};
  return true;
}

/// Closest point of triangle t to x: barycentric weights and squared distance.
double closest_on_triangle(const SurfaceMesh& mesh, int t, const Vector3d& x, std::array<double, 3>* weights) {
  const Vector3d &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
  const Vector3d normal = (b - a).cross(c - a);
  const double twice2 = normal.squaredNorm();
  const double wa = (b - x).cross(c - x).dot(normal) / twice2;
  const double wb = (c - x).cross(a - x).dot(normal) / twice2;
  const double wc = 1.0 - wa - wb;
  if (wa >= 0 && wb >= 0 && wc >= 0) {
    *weights = {wa, wb, wc};
    const double d = (x - a).dot(normal);
    return d * d / twice2;
  }
  double best = kInfinity;
  for (int k = 0; k < 3; ++k) {
    const Vector3d &p = mesh.corner(t, k), &q = mesh.corner(t, (k + 1) % 3);
    const Vector3d pq = q - p;
    const double s = std::clamp((x - p).dot(pq) / pq.squaredNorm(), 0.0, 1.0);
    const double d2 = (x - (p + s * pq)).squaredNorm();
    if (d2 < best) {
      best = d2;
      *weights = {0, 0, 0};
      (*weights)[static_cast<std::size_t>(k)] = 1.0 - s;
      (*weights)[static_cast<std::size_t>((k + 1) % 3)] = s;
    }
  }
  return best;
}

RTCDevice device() {
  // One device for the process; tasks come from oneTBB inside Embree only when a large scene is built.
  static RTCDevice instance = nullptr;
  static std::once_flag made;
  std::call_once(made, [] {
    instance = rtcNewDevice(nullptr);
    if (instance == nullptr) throw std::bad_alloc();  // the next call tries again
  });
  return instance;
}

}  // namespace

struct RayCaster::Scene {
  const SurfaceMesh* mesh;
  Vector3d center;  // float coordinates are taken from here, to keep their digits
  double padding;   // boxes and starting points are moved out by this much: single precision errors stay inside
  double extent;    // no two points of the surface are farther apart than this
  RTCScene scene = nullptr;

  ~Scene() {
    if (scene) rtcReleaseScene(scene);
  }
};

namespace {

void bounds_callback(const RTCBoundsFunctionArguments* args) {
  const auto& scene = *static_cast<const RayCaster::Scene*>(args->geometryUserPtr);
  Eigen::AlignedBox3d box;
  for (int k = 0; k < 3; ++k) box.extend(scene.mesh->corner(static_cast<int>(args->primID), k));
  const Vector3d low = box.min() - (scene.center + Vector3d::Constant(scene.padding)),
                 high = box.max() - (scene.center - Vector3d::Constant(scene.padding));
  RTCBounds& b = *args->bounds_o;
  b.lower_x = static_cast<float>(low.x());
  b.lower_y = static_cast<float>(low.y());
  b.lower_z = static_cast<float>(low.z());
  b.upper_x = static_cast<float>(high.x());
  b.upper_y = static_cast<float>(high.y());
  b.upper_z = static_cast<float>(high.z());
}

void intersect_callback(const RTCIntersectFunctionNArguments* args) {
  if (!args->valid[0]) return;
  const auto& scene = *static_cast<const RayCaster::Scene*>(args->geometryUserPtr);
  auto& query = *reinterpret_cast<LineQuery*>(args->context);
  const int t = static_cast<int>(args->primID);
  if (!(scene.mesh->normals[static_cast<std::size_t>(t)].dot(query.direction) < -query.min_facing)) return;
  Candidate c;
  c.triangle = t;
  if (!intersect(*scene.mesh, t, query.origin, query.direction, &c.distance, &c.weights)) return;
  if (!(c.distance > query.from && c.distance < query.to)) return;
  query.found->push_back(c);
  if (c.distance > query.limit && std::abs(c.distance) < query.best) {
    query.best = std::abs(c.distance);
    // nothing farther along the line can be nearer to its origin
    const double far = query.best + query.tolerance - query.from + 2 * scene.padding;
    auto* ray = reinterpret_cast<RTCRayHit*>(args->rayhit);
    ray->ray.tfar = std::min(ray->ray.tfar, static_cast<float>(far * (1 + 1e-6)));
    ray->hit.geomID = args->geomID;
  }
}

struct ClosestQuery {
  const RayCaster::Scene* scene;
  Vector3d x;
  std::vector<int>* within;  // collect all triangles within `radius` instead of looking for the closest point
  double radius;
  double best2;
  double tolerance;
  SurfacePoint point;
};

bool closest_callback(RTCPointQueryFunctionArguments* args) {
  auto& query = *static_cast<ClosestQuery*>(args->userPtr);
  std::array<double, 3> weights;
  const int t = static_cast<int>(args->primID);
  const double d2 = closest_on_triangle(*query.scene->mesh, t, query.x, &weights);
  if (query.within) {
    if (d2 <= query.radius * query.radius) query.within->push_back(t);
    return false;
  }
  const double d = std::sqrt(d2), best = std::sqrt(query.best2);
  const bool tie = std::abs(d - best) <= query.tolerance;
  if (d < best - query.tolerance || (tie && t < query.point.triangle) || query.point.triangle < 0) {
    query.best2 = d2;
    query.point.triangle = t;
    query.point.weights = weights;
    args->query->radius = static_cast<float>((d + query.tolerance) * (1 + 1e-6) + 2 * query.scene->padding);
    return true;
  }
  return false;
}

}  // namespace

RayCaster::RayCaster(SurfaceMesh of) : mesh_(std::make_shared<const SurfaceMesh>(std::move(of))) {
  const SurfaceMesh& mesh = *mesh_;
  const auto scene = std::make_shared<Scene>();
  scene_ = scene;
  Scene& s = *scene;
  s.mesh = &mesh;
  Eigen::AlignedBox3d box;
  if (mesh.vertices.empty()) box.extend(Vector3d(Vector3d::Zero()));
  for (const Vector3d& x : mesh.vertices) box.extend(x);
  s.center = 0.5 * (box.min() + box.max());
  s.extent = box.diagonal().norm();
  s.padding = 4e-6 * s.extent;
  rtcGetDeviceError(device());  // what came before is not ours
  s.scene = rtcNewScene(device());
  if (s.scene == nullptr) throw std::bad_alloc();
  rtcSetSceneFlags(s.scene, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_USER);
  if (geometry == nullptr) throw std::bad_alloc();
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(mesh.size()));
  rtcSetGeometryUserData(geometry, scene.get());
  rtcSetGeometryBoundsFunction(geometry, bounds_callback, nullptr);
  rtcSetGeometryIntersectFunction(geometry, intersect_callback);
  rtcSetGeometryPointQueryFunction(geometry, closest_callback);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(s.scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(s.scene);
  // Embree does not throw. A scene of ours has one fault only, and an unfinished one must not be asked.
  if (rtcGetDeviceError(device()) != RTC_ERROR_NONE) throw std::bad_alloc();
}

LineHit RayCaster::nearest_facing(const Vector3d& origin, const Vector3d& direction, double from, double limit,
                                  double to, double min_facing) const {
  const Scene& s = *scene_;
  thread_local std::vector<Candidate> found;
  found.clear();
  LineQuery query;
  query.origin = origin;
  query.direction = direction;
  query.min_facing = min_facing;
  query.limit = limit;
  query.best = kInfinity;
  query.tolerance = 1e-9 * s.extent;
  query.found = &found;
  // The ray starts where the line enters the sphere around the surface, or at `from` if that is later: single
  // precision then never sees a length much beyond the surface's own size. tnear stays 0 (Debian's Embree insists).
  const double middle = (s.center - origin).dot(direction);
  const double reach = s.extent + 4 * s.padding;  // twice the radius of that sphere, generously
  query.from = std::max(from, middle - reach);
  query.to = std::min(to, middle + reach);
  LineHit result;
  if (!(query.from < query.to) || s.mesh->size() == 0) return result;
  // A line past that sphere meets nothing, and may start where single precision has no numbers any more.
  if (!((origin + middle * direction - s.center).norm() < reach)) return result;
  const Vector3d start = origin + (query.from - 2 * s.padding) * direction - s.center;
  RTCRayHit ray;
  ray.ray.org_x = static_cast<float>(start.x());
  ray.ray.org_y = static_cast<float>(start.y());
  ray.ray.org_z = static_cast<float>(start.z());
  ray.ray.dir_x = static_cast<float>(direction.x());
  ray.ray.dir_y = static_cast<float>(direction.y());
  ray.ray.dir_z = static_cast<float>(direction.z());
  ray.ray.tnear = 0.0f;
  ray.ray.tfar = static_cast<float>((query.to - query.from + 4 * s.padding) * (1 + 1e-6));
  ray.ray.time = 0.0f;
  ray.ray.mask = 0xffffffffu;
  ray.ray.id = 0;
  ray.ray.flags = 0;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  intersect_scene(s.scene, &query.context, &ray);

  // The nearest valid crossing, or the nearest too deep one; of those at the same place the lowest number.
  const bool any_valid = std::isfinite(query.best);
  double best = query.best;
  if (!any_valid)
    for (const Candidate& c : found) best = std::min(best, std::abs(c.distance));
  for (const Candidate& c : found) {
    if (any_valid && !(c.distance > query.limit)) continue;
    if (std::abs(c.distance) > best + query.tolerance) continue;
    if (result.point.triangle >= 0 && c.triangle > result.point.triangle) continue;
    result.point.triangle = c.triangle;
    result.point.weights = c.weights;
    result.distance = c.distance;
  }
  return result;
}

namespace {

void point_query(const RayCaster::Scene& scene, ClosestQuery& query, double radius) {
  const Vector3d local = query.x - scene.center;
  RTCPointQuery point;
  point.x = static_cast<float>(local.x());
  point.y = static_cast<float>(local.y());
  point.z = static_cast<float>(local.z());
  point.time = 0.0f;
  point.radius = static_cast<float>(radius);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(scene.scene, &point, &context, closest_callback, &query);
}

}  // namespace

SurfacePoint RayCaster::closest(const Vector3d& x) const {
  // From very far away single precision tells no triangles apart, and each would be asked: a point on the way there has
  // the same answer to the digits that are left.
  const Vector3d away = x - scene_->center;
  const double far = 1e4 * scene_->extent;
  const Vector3d from = away.norm() > far ? Vector3d(scene_->center + far * away.normalized()) : x;
  ClosestQuery query{scene_.get(), from, nullptr, 0.0, kInfinity, 1e-12 * scene_->extent, {}};
  point_query(*scene_, query, kInfinity);
  return query.point;
}

std::vector<int> RayCaster::within(const Vector3d& x, double radius) const {
  std::vector<int> found;
  ClosestQuery query{scene_.get(), x, &found, radius, kInfinity, 0.0, {}};
  point_query(*scene_, query, radius * (1 + 1e-6) + 2 * scene_->padding);
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());  // a triangle may sit in several leaves
  return found;
}

std::string ray_library_version() {
  const auto number = [](RTCDeviceProperty property) {
    return std::to_string(rtcGetDeviceProperty(device(), property));
  };
  return number(RTC_DEVICE_PROPERTY_VERSION_MAJOR) + "." + number(RTC_DEVICE_PROPERTY_VERSION_MINOR) + "." +
         number(RTC_DEVICE_PROPERTY_VERSION_PATCH);
}

Vector3d position(const SurfaceMesh& mesh, const SurfacePoint& p) {
  return p.weights[0] * mesh.corner(p.triangle, 0) + p.weights[1] * mesh.corner(p.triangle, 1) +
         p.weights[2] * mesh.corner(p.triangle, 2);
}

}  // namespace dea

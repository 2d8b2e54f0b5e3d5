// tests/build/build_shapes.h – surfaces with known shapes, for tests of dea build.
#pragma once
#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <string>

#include "src/build/build_joint.h"
#include "src/build/mend_surface.h"

namespace dea::test {

using Eigen::Vector3d;

/// nu x nv squares, each two triangles, of point(u, v) with u and v in [0, 1]; d/du x d/dv is outside.
inline TriangleSurface sheet(int nu, int nv, const std::function<Vector3d(double, double)>& point) {
  TriangleSurface s;
  for (int j = 0; j <= nv; ++j)
    for (int i = 0; i <= nu; ++i) s.points.push_back(point(static_cast<double>(i) / nu, static_cast<double>(j) / nv));
  for (int j = 0; j < nv; ++j)
    for (int i = 0; i < nu; ++i) {
      const int a = j * (nu + 1) + i, b = a + 1, c = b + nu + 1, d = a + nu + 1;
      if ((i + j) % 2 == 0) {
        s.triangles.push_back({a, b, c});
        s.triangles.push_back({a, c, d});
      } else {
        s.triangles.push_back({a, b, d});
        s.triangles.push_back({b, c, d});
      }
    }
  return s;
}

/// Square |x|, |y| <= half at height z, seen from above (up) or below.
inline TriangleSurface square(int n, double half, double z, bool up) {
  return sheet(n, n,
               [&](double u, double v) { return Vector3d(half * (2 * u - 1), half * (2 * v - 1) * (up ? 1 : -1), z); });
}

/// Sphere about the origin from the pole z > 0 down to `polar` [rad] as a cube's faces spread evenly in angle: a dome
/// of n x n squares reaching `polar` at the middle of its edges.
inline TriangleSurface dome(int n, double radius, double polar, bool outwards) {
  return sheet(n, n, [&](double u, double v) {
    const double s = outwards ? 1 : -1;
    const Vector3d x(std::tan(polar * (2 * u - 1)), s * std::tan(polar * (2 * v - 1)), 1);
    return Vector3d(radius * x.normalized());
  });
}

/// Whole sphere: n x n squares on each face of a cube.
inline TriangleSurface ball(int n, double radius) {
  TriangleSurface all;
  const Eigen::Matrix3d turns[] = {Eigen::Matrix3d::Identity(),
                                   Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitX()).toRotationMatrix(),
                                   Eigen::AngleAxisd(-M_PI / 2, Vector3d::UnitX()).toRotationMatrix(),
                                   Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitY()).toRotationMatrix(),
                                   Eigen::AngleAxisd(-M_PI / 2, Vector3d::UnitY()).toRotationMatrix(),
                                   Eigen::AngleAxisd(M_PI, Vector3d::UnitX()).toRotationMatrix()};
  const TriangleSurface face = dome(n, radius, M_PI / 4, true);
  for (const Eigen::Matrix3d& turn : turns) {
    const int first = static_cast<int>(all.points.size());
    for (const Vector3d& x : face.points) all.points.push_back(turn * x);
    for (const auto& t : face.triangles) all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  return all;
}

inline TriangleSurface turned_over(TriangleSurface s) {
  for (auto& t : s.triangles) std::swap(t[1], t[2]);
  return s;
}

/// A bone of this mended surface, as dea build makes one.
inline BoneRequest bone_request(const std::string& name, const TriangleSurface& surface) {
  const MendedSurface mended = mend_surface(surface);
  BoneRequest b;
  b.name = name;
  b.surface = mended.surface;
  b.closed = mended.closed();
  return b;
}

/// Two bones; the first has cartilage with this outer surface.
inline BuildRequest joint_request(const BoneRequest& first, const BoneRequest& second,
                                  const TriangleSurface& cartilage) {
  BuildRequest request;
  request.bones = {first, second};
  CartilageRequest c;
  c.bone = 0;
  c.outer = mend_surface(cartilage).surface;
  request.cartilages = {c};
  return request;
}

}  // namespace dea::test

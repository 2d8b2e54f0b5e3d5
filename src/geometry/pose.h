// src/geometry/pose.h – where a rigid body is, and one body as seen from another.
#pragma once
#include <Eigen/Core>

namespace dea {

/// The matrix of the cross product: skew(a) b = a x b.
inline Eigen::Matrix3d skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

/// Pose of a body: x = center + rotation * (X - center of mass in the reference).
struct Pose {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< current centre of mass
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
};

/// One body seen from another's reference frame: Y = rotation * X + shift for a point X of the one's reference.
struct RelativePose {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d shift;
};
/// `from_center`, `to_center`: reference centres of mass.
inline RelativePose relative_pose(const Pose& from, const Eigen::Vector3d& from_center, const Pose& to,
                                  const Eigen::Vector3d& to_center) {
  // x = c_f + R_f (X - C_f) = c_t + R_t (Y - C_t)  =>  Y = R_t^T R_f X + shift
  const Eigen::Matrix3d back = to.rotation.transpose();
  return {back * from.rotation, to_center + back * (from.center - to.center - from.rotation * from_center)};
}

}  // namespace dea

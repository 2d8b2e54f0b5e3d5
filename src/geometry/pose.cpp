#include "src/geometry/pose.h"

namespace dea {

using Eigen::Vector3d;

Eigen::Matrix3d skew(const Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

RelativePose relative_pose(const Pose& from, const Vector3d& from_center, const Pose& to, const Vector3d& to_center) {
  // x = c_f + R_f (X - C_f) = c_t + R_t (Y - C_t)  =>  Y = R_t^T R_f X + shift
  const Eigen::Matrix3d back = to.rotation.transpose();
  return {back * from.rotation, to_center + back * (from.center - to.center - from.rotation * from_center)};
}

}  // namespace dea

// src/base/rotations.h – rotations by vectors and by matrices of files.
#pragma once
#include <Eigen/Geometry>
#include <cmath>
#include <optional>

namespace dea {

/// Rotation by the vector w: right-handed about w, by |w| rad.
inline Eigen::Matrix3d rotation(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  if (angle < 1e-300) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
}

/// The vector w, |w| <= pi, of which R is the rotation; small ones to full relative precision.
inline Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& R) {
  Eigen::Quaterniond q(R);
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double s = q.vec().norm();
  if (s < 1e-300) return 2.0 * q.vec();
  return q.vec() * (2.0 * std::atan2(s, q.w()) / s);
}

/// What keeps a matrix from being a rotation, by more than the digits of a file leave.
struct RotationFault {
  enum class Kind { Length, Angle, Mirror } kind;
  int axis = 0, other = 0;  ///< columns: of `axis` the length is not 1; between both the angle is not right
  double value = 0.0;       ///< length, or cosine
};
std::optional<RotationFault> rotation_fault(const Eigen::Matrix3d& m);

/// The rotation nearest to a matrix that is one but for its digits.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& m);

}  // namespace dea

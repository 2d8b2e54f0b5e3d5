// src/base/rotations.h – rotations by vectors.
#pragma once
#include <Eigen/Geometry>
#include <cmath>

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

}  // namespace dea

// febiodea/base/rotations.h – rotations by vectors.
#pragma once
#include <Eigen/Geometry>

namespace dea {

/// Rotation by the vector w: right-handed about w, by |w| rad.
inline Eigen::Matrix3d rotation(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  if (angle < 1e-300) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
}

/// The vector w, |w| <= pi, of which R is the rotation.
inline Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& R) {
  const Eigen::AngleAxisd turn(R);
  return turn.angle() * turn.axis();
}

}  // namespace dea

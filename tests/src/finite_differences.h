// tests/src/finite_differences.h – the derivative of a contact's forces, by trying.
#pragma once
#include "src/springs/press.h"
#include "src/springs/springs.h"
#include "src/springs/wrench.h"

namespace dea::test {

/// Central differences of the wrench for steps of +-d (lengths and angles), columns and rows as in ContactWrench: the
/// target's motion, then the source's.
inline Eigen::Matrix<double, 12, 12> numeric_derivative(const SpringBed& bed, const Pose& source, const Pose& target,
                                                        double d) {
  Eigen::Matrix<double, 12, 12> numeric;
  for (int k = 0; k < 12; ++k) {
    Eigen::Matrix<double, 12, 1> side[2];
    for (int sign = 0; sign < 2; ++sign) {
      const double x = sign == 0 ? d : -d;
      Pose moved[2] = {target, source};
      Pose& p = moved[k / 6];
      if (k % 6 < 3)
        p.center[k % 6] += x;
      else
        p.rotation = Eigen::AngleAxisd(x, Vector3d::Unit(k % 6 - 3)).toRotationMatrix() * p.rotation;
      side[sign] = contact_wrench(press_springs(bed, moved[1], moved[0]), moved[1], moved[0]).wrench;
    }
    numeric.col(k) = (side[0] - side[1]) / (2 * d);
  }
  return numeric;
}

}  // namespace dea::test

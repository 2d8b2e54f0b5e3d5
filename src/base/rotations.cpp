#include "src/base/rotations.h"

#include "src/base/decompositions.h"

namespace dea {

std::optional<RotationFault> rotation_fault(const Eigen::Matrix3d& m) {
  using Kind = RotationFault::Kind;
  constexpr double kDigits = 1e-3;  // files have four digits or more
  for (int i = 0; i < 3; ++i)
    if (const double length = m.col(i).norm(); !(std::abs(length - 1) <= kDigits))
      return RotationFault{Kind::Length, i, i, length};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < i; ++j)
      if (const double cosine = m.col(i).dot(m.col(j)); std::abs(cosine) > kDigits)
        return RotationFault{Kind::Angle, j, i, cosine};
  if (m.determinant() < 0) return RotationFault{Kind::Mirror};
  return std::nullopt;
}

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& m) {
  const SingularValues svd = whole_svd(m);
  return svd.U * svd.V.transpose();
}

}  // namespace dea

// src/base/fixed_point.h – x = g(x) by Anderson's mixing: in fewer steps than by x = g(x) itself.
#pragma once
#include <Eigen/Core>
#include <vector>

namespace dea {

/// Anderson 1965, J ACM 12:547; as Walker and Ni 2011, SIAM J Numer Anal 49:1715, write it: the differences of the last
/// steps tell how g(x) - x changes, and of them as much is taken as leaves least of it.
class FixedPoint {
 public:
  /// The next x, from the last and what g made of it.
  Eigen::VectorXd next(const Eigen::VectorXd& x, const Eigen::VectorXd& g);
  /// Of the steps so far: g is another function.
  void forget();

 private:
  static constexpr std::size_t kSteps = 4;
  std::vector<Eigen::VectorXd> change_, of_residual_;
  Eigen::VectorXd x_, residual_;  // the last
};

}  // namespace dea

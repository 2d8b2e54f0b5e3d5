#include "src/base/fixed_point.h"

#include "src/base/decompositions.h"
#include "src/base/numbers.h"

namespace dea {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd FixedPoint::next(const VectorXd& x, const VectorXd& g) {
  const VectorXd residual = g - x;
  if (residual_.size() == residual.size()) {
    change_.push_back(x - x_);
    of_residual_.push_back(residual - residual_);
    if (change_.size() > kSteps) {
      change_.erase(change_.begin());
      of_residual_.erase(of_residual_.begin());
    }
  }
  x_ = x;
  residual_ = residual;
  if (change_.empty()) return g;
  const auto steps = static_cast<Index>(change_.size());
  MatrixXd differences(residual.size(), steps);
  for (Index i = 0; i < steps; ++i) differences.col(i) = of_residual_[at(i)];
  const VectorXd share = solve_least_norm(differences, residual);
  VectorXd mixed = g;
  for (Index i = 0; i < steps; ++i) mixed -= share[i] * (change_[at(i)] + of_residual_[at(i)]);
  return mixed;
}

void FixedPoint::forget() {
  change_.clear();
  of_residual_.clear();
  residual_ = VectorXd();
}

}  // namespace dea

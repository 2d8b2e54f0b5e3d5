#include "src/base/fixed_point.h"

#include <gtest/gtest.h>

#include <Eigen/Core>

namespace dea::fixed_point_test {
namespace {

using Eigen::VectorXd;

/// A linear g with three different slopes is known after three steps, those of 0.99 and -3 too, which x = g(x) by
/// itself would follow for a thousand steps, or away.
TEST(FixedPoint, OfALinearFunctionIsFoundInAsManyStepsAsItHasSlopes) {
  const VectorXd slope = (VectorXd(6) << 0.99, 0.5, -3, 0.99, 0.5, -3).finished(),
                 exact = (VectorXd(6) << 1, -2, 3, 4, 5, -6).finished();
  const auto g = [&](const VectorXd& x) { return VectorXd(exact + slope.cwiseProduct(x - exact)); };
  FixedPoint seek;
  VectorXd x = VectorXd::Zero(6);
  for (int step = 0; step < 4; ++step) {
    EXPECT_GT((x - exact).norm(), 1e-6) << step;
    x = seek.next(x, g(x));
  }
  EXPECT_LT((x - exact).norm(), 1e-8);
  seek.forget();
  EXPECT_LT((seek.next(x + VectorXd::Ones(6), exact) - exact).norm(), 1e-12);  // as g says, for want of steps
}

}  // namespace
}  // namespace dea::fixed_point_test

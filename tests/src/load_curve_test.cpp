#include "load_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace dea {
namespace {

using Interpolate = LoadController::Interpolate;
using Extend = LoadController::Extend;

LoadController curve(Interpolate interpolate, Extend extend, std::vector<std::array<double, 2>> points) {
  LoadController result;
  result.interpolate = interpolate;
  result.extend = extend;
  result.points = std::move(points);
  return result;
}

TEST(LoadCurve, NoPointIsZeroAndOnePointIsConstant) {
  EXPECT_EQ(value(curve(Interpolate::Linear, Extend::Repeat, {}), 3.0), 0.0);
  EXPECT_EQ(value(curve(Interpolate::Smooth, Extend::Extrapolate, {{1, 7}}), -3.0), 7.0);
}

TEST(LoadCurve, LinearGoesStraightBetweenPoints) {
  const LoadController ramp = curve(Interpolate::Linear, Extend::Constant, {{0, 0}, {2, 4}, {3, 1}});
  EXPECT_DOUBLE_EQ(value(ramp, 0.0), 0.0);
  EXPECT_DOUBLE_EQ(value(ramp, 0.5), 1.0);
  EXPECT_DOUBLE_EQ(value(ramp, 2.0), 4.0);
  EXPECT_DOUBLE_EQ(value(ramp, 2.5), 2.5);
}

TEST(LoadCurve, RepeatedTimeIsAJump) {
  const LoadController jump = curve(Interpolate::Linear, Extend::Constant, {{0, 0}, {1, 1}, {1, 5}, {2, 5}});
  EXPECT_NEAR(value(jump, 1.0 - 1e-12), 1.0, 1e-9);
  EXPECT_DOUBLE_EQ(value(jump, 1.0), 5.0);
  EXPECT_DOUBLE_EQ(value(jump, 1.5), 5.0);
}

// A step takes the value of the point ahead, except exactly at the first and last point.
TEST(LoadCurve, StepTakesTheNextPoint) {
  const LoadController steps = curve(Interpolate::Step, Extend::Constant, {{0, 1}, {1, 2}, {2, 3}});
  EXPECT_DOUBLE_EQ(value(steps, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(value(steps, 0.1), 2.0);
  EXPECT_DOUBLE_EQ(value(steps, 1.0), 3.0);
  EXPECT_DOUBLE_EQ(value(steps, 1.9), 3.0);
  EXPECT_DOUBLE_EQ(value(steps, 2.0), 3.0);
}

// With two points a line, with three the parabola t^2 through (0,0) (1,1) (2,4) (off its points: 1.5^2).
TEST(LoadCurve, SmoothIsExactForLinesAndParabolas) {
  EXPECT_DOUBLE_EQ(value(curve(Interpolate::Smooth, Extend::Constant, {{0, 0}, {2, 4}}), 0.5), 1.0);
  const LoadController square = curve(Interpolate::Smooth, Extend::Constant, {{0, 0}, {1, 1}, {2, 4}});
  EXPECT_DOUBLE_EQ(value(square, 1.5), 2.25);
  const LoadController five = curve(Interpolate::Smooth, Extend::Constant, {{0, 0}, {1, 1}, {2, 4}, {3, 9}, {5, 25}});
  for (const double t : {0.25, 1.25, 2.75, 4.5}) EXPECT_NEAR(value(five, t), t * t, 1e-13 * 25);
}

// Points 0 0 1 1 at t = 0 1 2 3. In the middle interval the left parabola is (t^2 - t)/2, the right one
// 1 - (t-2)(t-3)/2; at t = 1.5: 0.375 and 0.625, half each is 0.5; at 1.25: 0.15625 and 0.34375, blended
// 3/4 and 1/4: 0.203125. In the end intervals one parabola alone: t = 0.5 gives -0.125, t = 2.5 gives 1.125.
TEST(LoadCurve, SmoothBlendsTwoParabolas) {
  const LoadController smooth = curve(Interpolate::Smooth, Extend::Constant, {{0, 0}, {1, 0}, {2, 1}, {3, 1}});
  EXPECT_DOUBLE_EQ(value(smooth, 1.5), 0.5);
  EXPECT_DOUBLE_EQ(value(smooth, 1.25), 0.203125);
  EXPECT_DOUBLE_EQ(value(smooth, 0.5), -0.125);
  EXPECT_DOUBLE_EQ(value(smooth, 2.5), 1.125);
}

// w^3 (10 - 15 w + 6 w^2): w = 1/2 gives 1/2, w = 1/4 gives 53/512.
TEST(LoadCurve, SmoothStepFollowsItsPolynomial) {
  const LoadController step = curve(Interpolate::SmoothStep, Extend::Constant, {{1, 2}, {3, 6}});
  EXPECT_DOUBLE_EQ(value(step, 2.0), 4.0);
  EXPECT_DOUBLE_EQ(value(step, 1.5), 2.0 + 4.0 * 53.0 / 512.0);
  EXPECT_DOUBLE_EQ(value(step, 3.0), 6.0);
}

TEST(LoadCurve, ConstantHoldsTheEnds) {
  for (const Interpolate kind :
       {Interpolate::Linear, Interpolate::Step, Interpolate::Smooth, Interpolate::SmoothStep}) {
    const LoadController held = curve(kind, Extend::Constant, {{0, 1}, {1, 3}, {2, 4}});
    EXPECT_EQ(value(held, -5.0), 1.0);
    EXPECT_EQ(value(held, 9.0), 4.0);
  }
}

TEST(LoadCurve, ExtrapolateContinuesLinesAndHoldsSteps) {
  const LoadController line = curve(Interpolate::Linear, Extend::Extrapolate, {{0, 1}, {1, 3}, {2, 4}});
  EXPECT_DOUBLE_EQ(value(line, -1.0), -1.0);
  EXPECT_DOUBLE_EQ(value(line, 4.0), 6.0);
  for (const Interpolate kind : {Interpolate::Step, Interpolate::SmoothStep}) {
    const LoadController held = curve(kind, Extend::Extrapolate, {{0, 1}, {1, 3}, {2, 4}});
    EXPECT_EQ(value(held, -1.0), 1.0);
    EXPECT_EQ(value(held, 4.0), 4.0);
  }
}

// The end slope is the secant over 0.001 of the range: t^2 on [0, 2] has it over dt = 0.002. After the end
// the slope is (4 - 1.998^2)/0.002 = 3.998, before the start 0.002.
TEST(LoadCurve, ExtrapolateOfASmoothCurveUsesTheEndSecant) {
  const LoadController square = curve(Interpolate::Smooth, Extend::Extrapolate, {{0, 0}, {1, 1}, {2, 4}});
  EXPECT_NEAR(value(square, 3.0), 4.0 + 3.998, 1e-11);
  EXPECT_NEAR(value(square, -1.0), -0.002, 1e-11);
}

TEST(LoadCurve, RepeatIsPeriodic) {
  const LoadController saw = curve(Interpolate::Linear, Extend::Repeat, {{1, 0}, {3, 4}});
  EXPECT_DOUBLE_EQ(value(saw, 4.0), 2.0);   // one period late: t = 2
  EXPECT_DOUBLE_EQ(value(saw, 0.5), 3.0);   // one period early: t = 2.5
  EXPECT_DOUBLE_EQ(value(saw, 5.0), 4.0);   // a seam after the end is the last point
  EXPECT_DOUBLE_EQ(value(saw, -1.0), 0.0);  // a seam before the start is the first point
  EXPECT_DOUBLE_EQ(value(saw, 1e6), 2.0);   // far away: 1e6 = 2 + 499999 * 2
}

TEST(LoadCurve, RepeatOffsetClimbs) {
  const LoadController stairs = curve(Interpolate::Linear, Extend::RepeatOffset, {{1, 1}, {3, 5}});
  EXPECT_DOUBLE_EQ(value(stairs, 4.0), 3.0 + 4.0);
  EXPECT_DOUBLE_EQ(value(stairs, 8.0), 3.0 + 3 * 4.0);
  EXPECT_DOUBLE_EQ(value(stairs, 0.0), 3.0 - 4.0);
}

TEST(LoadCurve, WhatCannotBeEvaluatedIsALogicError) {
  LoadController math = curve(Interpolate::Linear, Extend::Constant, {{0, 0}, {1, 1}});
  math.unsupported = "type math";
  EXPECT_THROW(value(math, 0.5), std::logic_error);
  EXPECT_THROW(value(curve(Interpolate::CubicSpline, Extend::Constant, {{0, 0}, {1, 1}}), 0.5), std::logic_error);
  EXPECT_THROW(value(curve(Interpolate::C2Smooth, Extend::Constant, {{0, 0}, {1, 1}}), 5.0), std::logic_error);
}

TEST(LoadCurve, AControllerScalesTheNumberOfTheFile) {
  JointModel model;
  model.controllers.push_back(curve(Interpolate::Linear, Extend::Constant, {{0, 0}, {1, 1}}));
  EXPECT_DOUBLE_EQ(value(model, Scaled{-50.0, 0}, 0.5), -25.0);
  EXPECT_DOUBLE_EQ(value(model, Scaled{-50.0, -1}, 0.5), -50.0);
}

}  // namespace
}  // namespace dea

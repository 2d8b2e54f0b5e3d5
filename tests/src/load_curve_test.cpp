#include "src/model/load_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "src/base/error.h"

namespace dea::load_curve_test {

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

// A cubic spline through points of a cubic is that cubic; with 3 points a parabola, with 2 a line.
TEST(LoadCurve, CubicSplineIsExactForCubics) {
  const auto cubic = [](double t) { return t * t * t - 2 * t * t + 3; };
  LoadController spline = curve(Interpolate::CubicSpline, Extend::Constant, {});
  for (const double t : {0.0, 0.5, 1.5, 2.0, 3.5, 4.0, 6.0}) spline.points.push_back({t, cubic(t)});
  for (const double t : {0.1, 0.75, 1.6, 2.9, 3.7, 5.5}) EXPECT_NEAR(value(spline, t), cubic(t), 1e-11) << t;
  EXPECT_DOUBLE_EQ(value(curve(Interpolate::CubicSpline, Extend::Constant, {{0, 0}, {2, 4}}), 0.5), 1.0);
  EXPECT_NEAR(value(curve(Interpolate::CubicSpline, Extend::Constant, {{0, 0}, {1, 1}, {3, 9}}), 2.0), 4.0, 1e-12);
}

// Not a cubic: through its points; twice differentiable, and thrice at the second and the last but one (no knots
// there).
TEST(LoadCurve, CubicSplineGoesThroughItsPointsSmoothly) {
  const LoadController spline =
      curve(Interpolate::CubicSpline, Extend::Constant, {{0, 0}, {1, 2}, {2, -1}, {4, 3}, {5, 0}, {6, 1}});
  for (const auto& point : spline.points) EXPECT_NEAR(value(spline, point[0]), point[1], 1e-12);
  const double h = 1e-3;
  const auto second = [&](double t) {
    return (value(spline, t + h) - 2 * value(spline, t) + value(spline, t - h)) / (h * h);
  };
  for (const double t : {1.0, 2.0, 4.0, 5.0}) EXPECT_NEAR(second(t - h), second(t + h), 0.2) << t;
  for (const double t : {1.0, 5.0}) {
    const double before = (second(t - 2 * h) - second(t - 6 * h)) / (4 * h);
    const double after = (second(t + 6 * h) - second(t + 2 * h)) / (4 * h);
    EXPECT_NEAR(before, after, 1e-3 * std::max(1.0, std::abs(before))) << t;
  }
}

// Four control points on [0, 3]: one cubic Bezier curve; t/3 = 1/2 gives (y0 + 3 y1 + 3 y2 + y3)/8.
TEST(LoadCurve, ControlPointsPullTheCurve) {
  const LoadController four = curve(Interpolate::ControlPoints, Extend::Constant, {{0, 1}, {1, 5}, {2, -3}, {3, 2}});
  EXPECT_DOUBLE_EQ(value(four, 1.5), (1 + 15 - 9 + 2) / 8.0);
  EXPECT_DOUBLE_EQ(value(four, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(value(four, 3.0), 2.0);
  EXPECT_NEAR(value(four, 3.0 - 1e-9), 2.0, 1e-7);
  // Five: one knot in the middle, 2. There the B-splines 1, 2, 3 are 1/4, 1/2, 1/4 (knots 0 0 0 0 2 4 4 4 4).
  const LoadController five =
      curve(Interpolate::ControlPoints, Extend::Constant, {{0, 9}, {1, 4}, {2, 8}, {3, 12}, {4, 9}});
  EXPECT_DOUBLE_EQ(value(five, 2.0), 0.25 * 4 + 0.5 * 8 + 0.25 * 12);
}

// Three points: a line of least squares. (0,0) (1,2) (2,1): mean 1, slope 1/2.
TEST(LoadCurve, ApproximationIsALeastSquaresSpline) {
  const LoadController three = curve(Interpolate::Approximation, Extend::Constant, {{0, 0}, {1, 2}, {2, 1}});
  EXPECT_NEAR(value(three, 0.5), 0.75, 1e-13);
  EXPECT_NEAR(value(three, 1.5), 1.25, 1e-13);
  EXPECT_EQ(value(three, 2.0), 1.0);  // at the ends FEBio takes the point
  // A cubic is approximated exactly by 7 points: 4 coefficients.
  LoadController seven = curve(Interpolate::Approximation, Extend::Constant, {});
  for (int i = 0; i < 7; ++i) seven.points.push_back({static_cast<double>(i), static_cast<double>(i * i * i)});
  EXPECT_NEAR(value(seven, 2.5), 15.625, 1e-10);
}

TEST(LoadCurve, C2SmoothIsSmooth) {
  std::vector<std::array<double, 2>> points = {{0, 0}, {1, 0}, {2, 1}, {3, 1}};
  for (const double t : {0.5, 1.25, 2.5}) {
    EXPECT_EQ(value(curve(Interpolate::C2Smooth, Extend::Constant, points), t),
              value(curve(Interpolate::Smooth, Extend::Constant, points), t));
  }
}

// The end slope of (t/2)^3 by the secant over 0.002: (1 - 0.999^3)/0.002.
TEST(LoadCurve, SplinesExtrapolateBySecants) {
  const LoadController spline =
      curve(Interpolate::CubicSpline, Extend::Extrapolate, {{0, 0}, {0.5, 0.015625}, {1, 0.125}, {2, 1}});
  EXPECT_NEAR(value(spline, 3.0), 1 + (1 - 0.999 * 0.999 * 0.999) / 0.002, 1e-9);
}

TEST(LoadCurve, LongSplinesAreQuick) {
  LoadController spline = curve(Interpolate::CubicSpline, Extend::Constant, {});
  for (int i = 0; i <= 20000; ++i) spline.points.push_back({i * 1e-3, std::sin(i * 1e-3)});
  EXPECT_NEAR(value(spline, 7.00049), std::sin(7.00049), 1e-9);
}

LoadController expression(const std::string& text) {
  LoadController result;
  result.expression = text;
  return result;
}

// FEBio's words and order of operations: powers from the left, a sign after them, log to the base 10.
TEST(LoadCurve, ExpressionsAreReadAsFEBioDoes) {
  const std::pair<const char*, double> cases[] = {{"2*t + 1", 5.0},
                                                  {"-t^2", -4.0},
                                                  {"2^3^2", 64.0},
                                                  {"2^-1", 0.5},
                                                  {"8/2/2-1-1", 0.0},
                                                  {"log(100)+ln(e)", 3.0},
                                                  {"H(t-2) + 10*H(t-3) + 100*H(t)", 100.5},
                                                  {"step(t-2)+step(t-3)", 1.0},
                                                  {"sgn(0)+sgn(-t)", 0.0},
                                                  {"max(1,t,0) - min(3,t)", 0.0},
                                                  {"avg(1,2,6)", 3.0},
                                                  {"sin(pi*t/4)", 1.0},
                                                  {"mod(7,t)+pow(t,3)", 9.0},
                                                  {"1e-1*2.5E1", 2.5},
                                                  {"cos(\n0 )", 1.0}};
  for (const auto& c : cases) EXPECT_NEAR(value(expression(c.first), 2.0), c.second, 1e-15) << c.first;
  EXPECT_DOUBLE_EQ(constant_value("2*(1+4)"), 10.0);
}

TEST(LoadCurve, ExpressionsWithFaultsAreTold) {
  for (const char* text :
       {"", "t+", "foo(t)", "t+u", "2t", "(t", "t;t", "a=t", "t>1", "t&&1", "rint(t)", "_pi", "1,2", "t!"})
    EXPECT_NE(expression_fault(text, {"t"}), "") << text;
  EXPECT_EQ(expression_fault("t+u", {"t"}), "unknown name \"u\"");
  EXPECT_EQ(expression_fault("t*sin(t)", {"t"}), "");
  EXPECT_EQ(expression_variables("x^2 + 3*H(x) + y"), (std::vector<std::string>{"x", "y"}));
}

TEST(LoadCurve, AnExpressionWithoutValueIsRefusedWithItsPlace) {
  JointModel model;
  model.files = {"hip.feb"};
  model.controllers.push_back(expression("sqrt(t-5)"));
  model.controllers[0].id = 3;
  model.controllers[0].origin = {0, 12};
  EXPECT_DOUBLE_EQ(value(model, Scaled{2.0, 0}, 6.0), 2.0);
  try {
    value(model, Scaled{2.0, 0}, 1.5);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "hip.feb:12: load controller 3: expression \"sqrt(t-5)\" has no finite value at t = 1.5");
  }
}

// Readers ask for the fault before.
TEST(LoadCurve, AnExpressionThatIsNoneIsRefused) {
  try {
    value(expression("foo(t)"), 0.5);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).rfind("expression \"foo(t)\": ", 0), 0U) << error.what();
  }
}

TEST(LoadCurve, WhatCannotBeEvaluatedIsALogicError) {
  LoadController pid = curve(Interpolate::Linear, Extend::Constant, {{0, 0}, {1, 1}});
  pid.unsupported = "type PID";
  EXPECT_THROW(value(pid, 0.5), std::logic_error);
}

TEST(LoadCurve, AControllerScalesTheNumberOfTheFile) {
  JointModel model;
  model.controllers.push_back(curve(Interpolate::Linear, Extend::Constant, {{0, 0}, {1, 1}}));
  EXPECT_DOUBLE_EQ(value(model, Scaled{-50.0, 0}, 0.5), -25.0);
  EXPECT_DOUBLE_EQ(value(model, Scaled{-50.0, -1}, 0.5), -50.0);
}

}  // namespace dea::load_curve_test

// src/load_curve.h – the value of a load controller at a time, as FEBio evaluates it.
#pragma once
#include "joint_model.h"

namespace dea {

/// Value of a load curve at time t. Linear, step, smooth and smooth-step interpolation and all four ways
/// to extend are exact copies of FEBio's definitions (docs/formats.md); no points = 0, one point = constant.
/// Throws std::logic_error for a controller whose `unsupported` is not empty or whose interpolation is a
/// spline kind: readers refuse those first.
double value(const LoadController& curve, double t);

/// factor * controller(t), or factor alone without a controller.
double value(const JointModel& model, const Scaled& scaled, double t);

}  // namespace dea

// src/model/load_curve.h – the value of a load controller at a time, as FEBio evaluates it.
#pragma once
#include <string>
#include <vector>

#include "src/model/joint_model.h"

namespace dea {

/// Value of a load curve at time t, or of a function of anything else. All interpolations and all four ways to extend
/// are copies of FEBio's definitions (one exception in docs/formats.md); no points = 0, one point = constant. With an
/// expression, its value. Throws InputError where an expression has no finite value, std::logic_error for a controller
/// whose `unsupported` is not empty: readers refuse those first.
double value(const LoadController& curve, double t);

/// Why `expression` cannot be evaluated with these variables, "" if it can. FEBio's words: + - * / ^ (from left to
/// right), pi, e, gamma, sin, ln, log (base 10), H, sgn, step, max, ...
std::string expression_fault(const std::string& expression, const std::vector<std::string>& variables);

/// Names in an expression that are neither functions nor constants, sorted. Empty also for an expression with a fault.
std::vector<std::string> expression_variables(const std::string& expression);

/// Value of an expression without variables. Throws InputError for one with a fault or without a finite value.
double constant_value(const std::string& expression);

/// True if no controller of the model is `unsupported`: all have a value at any time.
bool controllers_have_values(const JointModel& model);

/// factor * controller(t), or factor alone without a controller. Faults of an expression with the controller's place.
double value(const JointModel& model, const Scaled& scaled, double t);

}  // namespace dea

#include "src/model/load_curve.h"

#include <fmt/format.h>
#include <muParser.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <string>

#include "src/base/decompositions.h"
#include "src/base/error.h"
#include "src/base/parse.h"

namespace dea {
namespace {

using Point = std::array<double, 2>;  // (t, value)
using Points = std::vector<Point>;
using Interpolate = LoadController::Interpolate;
using Extend = LoadController::Extend;

double line_through(const Point& a, const Point& b, double t) {
  return a[1] + (b[1] - a[1]) * (t - a[0]) / (b[0] - a[0]);
}

double parabola_through(const Point& a, const Point& b, const Point& c, double t) {
  const double wa = (c[0] - t) * (b[0] - t) / ((c[0] - a[0]) * (b[0] - a[0]));
  const double wb = (c[0] - t) * (t - a[0]) / ((c[0] - b[0]) * (b[0] - a[0]));
  const double wc = (t - b[0]) * (t - a[0]) / ((c[0] - b[0]) * (c[0] - a[0]));
  return a[1] * wa + b[1] * wb + c[1] * wc;
}

/// In an inner interval the parabolas through its left and right neighbours, blended linearly.
double smooth(const Points& points, std::size_t i, double t) {
  const std::size_t last = points.size() - 1;
  if (last == 1) return line_through(points[0], points[1], t);
  if (i == 1 || last == 2) return parabola_through(points[0], points[1], points[2], t);
  if (i == last) return parabola_through(points[i - 2], points[i - 1], points[i], t);
  const double left = parabola_through(points[i - 2], points[i - 1], points[i], t);
  const double right = parabola_through(points[i - 1], points[i], points[i + 1], t);
  return line_through({points[i - 1][0], left}, {points[i][0], right}, t);
}

// -- splines: FEBio's B-splines ------------------------------------------------------------------------

/// A B-spline of `order` (degree + 1), clamped at both ends: coefficients.size() + order knots, rising.
struct Spline {
  int order = 0;
  std::vector<double> knots;
  std::vector<double> coefficients;
};

/// Knots for as many coefficients as breakpoints: inner ones are breakpoints (even order) or halfway between them.
std::vector<double> knots_of(const std::vector<double>& breaks, int order) {
  const int count = static_cast<int>(breaks.size());
  std::vector<double> knots(at(order), breaks.front());
  const int half = order / 2;  // rounded down
  for (int i = order; i < count; ++i) {
    knots.push_back(order % 2 == 0 ? breaks[at(i - half)] : (breaks[at(i - half)] + breaks[at(i - 1 - half)]) / 2);
  }
  knots.insert(knots.end(), at(order), breaks.back());
  return knots;
}

/// The knot interval that holds t: knots[i] <= t < knots[i + 1], the last one for t at the end.
int interval_of(const Spline& spline, double t) {
  const auto first = spline.knots.begin() + spline.order;
  const auto last = spline.knots.begin() + static_cast<std::ptrdiff_t>(spline.coefficients.size());
  return static_cast<int>(std::upper_bound(first, last, t) - spline.knots.begin()) - 1;
}

/// The B-splines that are not zero at t: `order` of them, the first with the index interval - order + 1 (Cox, de Boor).
std::vector<double> basis(const Spline& spline, int interval, double t) {
  const auto knot = [&](int i) { return spline.knots[at(i)]; };
  std::vector<double> b(at(spline.order), 0.0);
  b[0] = 1.0;
  for (int degree = 1; degree < spline.order; ++degree) {
    double carried = 0.0;
    for (int k = 0; k < degree; ++k) {
      const double right = knot(interval + k + 1), left = knot(interval + k + 1 - degree);
      const double share = b[at(k)] / (right - left);
      b[at(k)] = carried + (right - t) * share;
      carried = (t - left) * share;
    }
    b[at(degree)] = carried;
  }
  return b;
}

double value_of(const Spline& spline, double t) {
  const int interval = interval_of(spline, t);
  const std::vector<double> b = basis(spline, interval, t);
  double sum = 0.0;
  for (int k = 0; k < spline.order; ++k) {
    const int entry = interval - spline.order + 1 + k;
    sum += b[at(k)] * spline.coefficients[at(entry)];
  }
  return sum;
}

/// Coefficients with the least squares of spline - points; as many coefficients as points: through the points.
void fit(Spline& spline, const Points& points) {
  const int count = static_cast<int>(spline.coefficients.size());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right(static_cast<Eigen::Index>(points.size()));
  for (std::size_t row = 0; row < points.size(); ++row) {
    const int interval = interval_of(spline, points[row][0]);
    const std::vector<double> b = basis(spline, interval, points[row][0]);
    for (int k = 0; k < spline.order; ++k) {
      entries.emplace_back(static_cast<int>(row), interval - spline.order + 1 + k, b[at(k)]);
    }
    right[static_cast<Eigen::Index>(row)] = points[row][1];
  }
  Eigen::SparseMatrix<double> A(static_cast<int>(points.size()), count);
  A.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SparseMatrix<double> normal = A.transpose() * A;
  const Eigen::VectorXd c = solve_positive_definite(normal, A.transpose() * right);
  if (c.size() == 0 || !c.allFinite()) throw InputError("the spline cannot be fitted to its points");
  std::copy(c.begin(), c.end(), spline.coefficients.begin());
}

/// The spline of a curve of at least two points, whose times rise.
Spline spline_of(const LoadController& curve) {
  const Points& points = curve.points;
  const int count = static_cast<int>(points.size());
  Spline spline;
  int coefficients = count;
  if (curve.interpolate == Interpolate::Approximation) coefficients = count / 2 + 1;
  spline.order = std::min(coefficients, 4);
  std::vector<double> breaks;
  for (int i = 0; i < coefficients; ++i) {
    const double first = points.front()[0], last = points.back()[0];
    const bool at_points = coefficients == count;
    breaks.push_back(at_points || i == coefficients - 1 ? points[at(at_points ? i : count - 1)][0]
                                                        : first + i * (last - first) / (coefficients - 1));
  }
  spline.knots = knots_of(breaks, spline.order);
  spline.coefficients.assign(at(coefficients), 0.0);
  if (curve.interpolate == Interpolate::ControlPoints) {
    for (std::size_t i = 0; i < points.size(); ++i) spline.coefficients[i] = points[i][1];
  } else {
    fit(spline, points);
  }
  return spline;
}

/// Value for t within the points; at least two of them.
double value_inside(const LoadController& curve, double t) {
  const Points& points = curve.points;
  if (t == points.front()[0]) return points.front()[1];
  if (t == points.back()[0]) return points.back()[1];
  const auto after = std::upper_bound(points.begin(), points.end(), t,
                                      [](double time, const Point& point) { return time < point[0]; });
  const std::size_t i = at(after - points.begin());  // points[i-1] <= t < points[i]
  const Point& a = points[i - 1];
  const Point& b = points[i];
  switch (curve.interpolate) {
    case Interpolate::Linear:
      return line_through(a, b, t);
    case Interpolate::Step:
      return b[1];
    case Interpolate::Smooth:
    case Interpolate::C2Smooth:  // differs from Smooth in FEBio's derivatives only
      return smooth(points, i, t);
    case Interpolate::SmoothStep: {
      const double w = (t - a[0]) / (b[0] - a[0]);
      return a[1] + (b[1] - a[1]) * w * w * w * (10 - 15 * w + 6 * w * w);
    }
    case Interpolate::CubicSpline:
    case Interpolate::ControlPoints:
    case Interpolate::Approximation:
      return value_of(spline_of(curve), t);
  }
  throw std::logic_error("a load curve of no known interpolation");
}

/// Value for t beyond the ends, held or continued.
double extrapolate(const LoadController& curve, double t) {
  const Points& points = curve.points;
  const bool before = t < points.front()[0];
  const Point& first = points.front();
  const Point& last = points.back();
  if (curve.extend == Extend::Extrapolate && curve.interpolate == Interpolate::Linear) {
    return before ? line_through(first, points[1], t) : line_through(points[points.size() - 2], last, t);
  }
  const bool held = curve.interpolate == Interpolate::Step || curve.interpolate == Interpolate::SmoothStep;
  if (curve.extend == Extend::Extrapolate && !held) {
    const double dt = 0.001 * (last[0] - first[0]);  // FEBio's end slope: a secant over 0.1% of the range
    return before ? line_through(first, {first[0] + dt, value_inside(curve, first[0] + dt)}, t)
                  : line_through({last[0] - dt, value_inside(curve, last[0] - dt)}, last, t);
  }
  return before ? first[1] : last[1];
}

// -- expressions ----------------------------------------------------------------------------------------

double add(double a, double b) { return a + b; }
double subtract(double a, double b) { return a - b; }
double multiply(double a, double b) { return a * b; }
double divide(double a, double b) { return a / b; }
double negative(double a) { return -a; }
double csc(double x) { return 1 / std::sin(x); }
double sec(double x) { return 1 / std::cos(x); }
double cot(double x) { return 1 / std::tan(x); }
double sinc(double x) { return x == 0 ? 1 : std::sin(x) / x; }
double sgn(double x) { return x < 0 ? -1 : 1; }
double heaviside(double x) { return x > 0 ? 1 : x < 0 ? 0 : 0.5; }
double unit_step(double x) { return x < 0 ? 0 : 1; }
double same(double x) { return x; }

using Function = double (*)(double);

/// Standard libraries differ in what a stream takes for a number: here neither hexadecimal digits nor inf and nan are.
int refuse_strange_number(const char* text, int* place, double* value) {
  if (text[0] == '0' && (text[1] == 'x' || text[1] == 'X')) {  // a nought; the letter is refused by itself
    *place += 1;
    *value = 0.0;
    return 1;
  }
  std::string word;
  while (std::isalnum(static_cast<unsigned char>(text[word.size()])) != 0 || text[word.size()] == '_')
    word += text[word.size()];
  word = lower_case(word);
  if (word == "inf" || word == "infinity" || word == "nan") throw mu::ParserError(mu::ecUNASSIGNABLE_TOKEN);
  return 0;
}

/// A parser that knows FEBio's words and no other.
mu::Parser febio_parser() {
  mu::Parser parser;
  parser.AddValIdent(refuse_strange_number);
  parser.ClearFun();
  parser.ClearConst();
  parser.ClearOprt();
  parser.ClearInfixOprt();
  parser.ClearPostfixOprt();
  parser.EnableBuiltInOprt(false);
  parser.DefineOprt("+", add, mu::prADD_SUB);
  parser.DefineOprt("-", subtract, mu::prADD_SUB);
  parser.DefineOprt("*", multiply, mu::prMUL_DIV);
  parser.DefineOprt("/", divide, mu::prMUL_DIV);
  parser.DefineOprt("^", static_cast<double (*)(double, double)>(std::pow), mu::prPOW, mu::oaLEFT);
  parser.DefineInfixOprt("-", negative, mu::prINFIX);
  const std::pair<const char*, Function> functions[] = {
      {"cos", std::cos},      {"sin", std::sin},   {"tan", std::tan},     {"csc", csc},        {"sec", sec},
      {"cot", cot},           {"acos", std::acos}, {"asin", std::asin},   {"atan", std::atan}, {"cosh", std::cosh},
      {"sinh", std::sinh},    {"tanh", std::tanh}, {"acosh", std::acosh}, {"ln", std::log},    {"log", std::log10},
      {"exp", std::exp},      {"sqrt", std::sqrt}, {"abs", std::fabs},    {"sgn", sgn},        {"H", heaviside},
      {"step", unit_step},    {"sinc", sinc},      {"fl", same},          {"erf", std::erf},   {"erfc", std::erfc},
      {"tgamma", std::tgamma}};
  for (const auto& function : functions) parser.DefineFun(function.first, function.second);
  const std::pair<const char*, double (*)(double, double)> of_two[] = {
      {"atan2", std::atan2}, {"pow", std::pow}, {"mod", std::fmod}};
  for (const auto& function : of_two) parser.DefineFun(function.first, function.second);
  parser.DefineFun("max", [](const double* x, int count) { return *std::max_element(x, x + count); });
  parser.DefineFun("min", [](const double* x, int count) { return *std::min_element(x, x + count); });
  parser.DefineFun("avg", [](const double* x, int count) { return std::accumulate(x, x + count, 0.0) / count; });
  parser.DefineConst("pi", std::numbers::pi);
  parser.DefineConst("e", std::numbers::e);
  parser.DefineConst("gamma", std::numbers::egamma);
  return parser;
}

/// Without white space, as FEBio reads it.
std::string packed(const std::string& expression) {
  std::string text;
  for (const char c : expression) {
    if (std::isspace(static_cast<unsigned char>(c)) == 0) text += c;
  }
  return text;
}

double evaluate(const std::string& expression, const std::string& variable, double t) {
  mu::Parser parser = febio_parser();
  double result = 0.0;
  try {
    parser.DefineVar(variable, &t);
    parser.SetExpr(packed(expression));
    result = parser.Eval();
  } catch (const mu::Parser::exception_type& error) {
    throw InputError(fmt::format("expression \"{}\": {}", expression, error.GetMsg()));
  }
  if (!std::isfinite(result))
    throw InputError(fmt::format("expression \"{}\" has no finite value at {} = {:g}", expression, variable, t));
  return result;
}

}  // namespace

std::string expression_fault(const std::string& expression, const std::vector<std::string>& variables) {
  try {
    mu::Parser parser = febio_parser();
    parser.SetExpr(packed(expression));
    for (const auto& used : parser.GetUsedVar()) {
      if (std::find(variables.begin(), variables.end(), used.first) == variables.end())
        return fmt::format("unknown name \"{}\"", used.first);
    }
    std::vector<double> values(variables.size(), 1.0);
    for (std::size_t i = 0; i < variables.size(); ++i) parser.DefineVar(variables[i], &values[i]);
    int results = 0;
    parser.Eval(results);
    if (results != 1) return fmt::format("{} values, expected one", results);
  } catch (const mu::Parser::exception_type& error) {
    return error.GetMsg();
  }
  return "";
}

std::vector<std::string> expression_variables(const std::string& expression) {
  std::vector<std::string> names;
  try {
    mu::Parser parser = febio_parser();
    parser.SetExpr(packed(expression));
    for (const auto& used : parser.GetUsedVar()) names.push_back(used.first);
  } catch (const mu::Parser::exception_type&) {
    names.clear();
  }
  return names;
}

double constant_value(const std::string& expression) {
  const std::string fault = expression_fault(expression, {});
  if (!fault.empty()) throw InputError(fmt::format("expression \"{}\": {}", expression, fault));
  return evaluate(expression, "t", 0.0);
}

double value(const LoadController& curve, double t) {
  if (!curve.unsupported.empty()) throw std::logic_error("load controller cannot be evaluated");
  if (!curve.expression.empty()) return evaluate(curve.expression, curve.variable, t);
  const Points& points = curve.points;
  if (points.empty()) return 0.0;
  if (points.size() == 1) return points.front()[1];
  const double first = points.front()[0], last = points.back()[0], period = last - first;
  if (t >= first && t <= last) return value_inside(curve, t);
  if (period <= 0) return points.front()[1];
  if (curve.extend == Extend::Constant || curve.extend == Extend::Extrapolate) return extrapolate(curve, t);

  // Repeat: shift by whole periods into [first, last]; a time at a seam takes the last point after it.
  const double periods = t < first ? -std::ceil((first - t) / period) : std::ceil((t - last) / period);
  const double inside = std::clamp(t - periods * period, first, last);
  const double offset = curve.extend == Extend::RepeatOffset ? periods * (points.back()[1] - points.front()[1]) : 0.0;
  return value_inside(curve, inside) + offset;
}

bool controllers_have_values(const JointModel& model) {
  return std::all_of(model.controllers.begin(), model.controllers.end(),
                     [](const LoadController& c) { return c.unsupported.empty(); });
}

double value(const JointModel& model, const Scaled& scaled, double t) {
  if (scaled.controller < 0) return scaled.factor;
  const LoadController& curve = model.controllers.at(at(scaled.controller));
  try {
    return scaled.factor * value(curve, t);
  } catch (const InputError& error) {
    throw fault_at(model, curve.origin, fmt::format("load controller {}: {}", curve.id, error.what()));
  }
}

}  // namespace dea

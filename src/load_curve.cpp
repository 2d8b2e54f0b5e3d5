#include "load_curve.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

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

/// Value for t within the points; at least two of them.
double value_inside(const LoadController& curve, double t) {
  const Points& points = curve.points;
  if (t == points.front()[0]) return points.front()[1];
  if (t == points.back()[0]) return points.back()[1];
  const auto after = std::upper_bound(points.begin(), points.end(), t,
                                      [](double time, const Point& point) { return time < point[0]; });
  const std::size_t i = static_cast<std::size_t>(after - points.begin());  // points[i-1] <= t < points[i]
  const Point& a = points[i - 1];
  const Point& b = points[i];
  switch (curve.interpolate) {
    case Interpolate::Linear:
      return line_through(a, b, t);
    case Interpolate::Step:
      return b[1];
    case Interpolate::Smooth:
      return smooth(points, i, t);
    case Interpolate::SmoothStep: {
      const double w = (t - a[0]) / (b[0] - a[0]);
      return a[1] + (b[1] - a[1]) * w * w * w * (10 - 15 * w + 6 * w * w);
    }
    default:
      break;
  }
  throw std::logic_error("a spline load curve cannot be evaluated");
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
  if (curve.extend == Extend::Extrapolate && curve.interpolate == Interpolate::Smooth) {
    const double dt = 0.001 * (last[0] - first[0]);  // FEBio's end slope: a secant over 0.1% of the range
    return before ? line_through(first, {first[0] + dt, value_inside(curve, first[0] + dt)}, t)
                  : line_through({last[0] - dt, value_inside(curve, last[0] - dt)}, last, t);
  }
  return before ? first[1] : last[1];
}

}  // namespace

double value(const LoadController& curve, double t) {
  const bool known = curve.interpolate == Interpolate::Linear || curve.interpolate == Interpolate::Step ||
                     curve.interpolate == Interpolate::Smooth || curve.interpolate == Interpolate::SmoothStep;
  if (!curve.unsupported.empty() || !known) throw std::logic_error("load controller cannot be evaluated");
  const Points& points = curve.points;
  if (points.empty()) return 0.0;
  if (points.size() == 1) return points.front()[1];
  const double first = points.front()[0];
  const double last = points.back()[0];
  const double period = last - first;
  if (t >= first && t <= last) return value_inside(curve, t);
  if (period <= 0) return points.front()[1];
  if (curve.extend == Extend::Constant || curve.extend == Extend::Extrapolate) return extrapolate(curve, t);

  // Repeat: shift by whole periods into [first, last]; a time at a seam takes the last point after it.
  const double periods = t < first ? -std::ceil((first - t) / period) : std::ceil((t - last) / period);
  const double inside = std::clamp(t - periods * period, first, last);
  const double offset = curve.extend == Extend::RepeatOffset ? periods * (points.back()[1] - points.front()[1]) : 0.0;
  return value_inside(curve, inside) + offset;
}

double value(const JointModel& model, const Scaled& scaled, double t) {
  if (scaled.controller < 0) return scaled.factor;
  return scaled.factor * value(model.controllers.at(static_cast<std::size_t>(scaled.controller)), t);
}

}  // namespace dea

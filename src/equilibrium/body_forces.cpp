#include "src/equilibrium/body_forces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/base/time_text.h"
#include "src/model/load_curve.h"

namespace dea {

namespace {

using Matrix3d = Eigen::Matrix3d;

/// Where a point of a body is, seen from its current centre of mass.
Vector3d arm_of(const Joint& joint, int body, const Vector3d& reference, const std::vector<Pose>& poses) {
  return poses[at(body)].rotation * (reference - joint.bodies[at(body)].center_of_mass);
}

/// Adds a force at a point of a body; `turns`: its direction is the body's.
void add_point_force(int body, const Vector3d& arm, const Vector3d& force, bool turns, BodyForces& forces) {
  forces.value.segment<3>(6 * body) += force;
  forces.value.segment<3>(6 * body + 3) += arm.cross(force);
  Matrix6 D = Matrix6::Zero();
  D.block<3, 3>(3, 3) = skew(force) * skew(arm);
  if (turns) {
    D.block<3, 3>(0, 3) = -skew(force);
    D.block<3, 3>(3, 3) -= skew(arm) * skew(force);
  }
  forces.derivative.add(body, D);
}

/// NaN where an expression has no finite value.
double value_or_nan(const LoadController& curve, double x) {
  try {
    return value(curve, x);
  } catch (const InputError&) {
    return kNaN;
  }
}

/// Slope of a curve to one side of x, and whether there is one: not where the curve jumps at x.
struct OneSided {
  double slope = 0.0;
  bool there = true;
};
OneSided side_slope(const LoadController& curve, double x, double step, double range) {
  const double here = value(curve, x), tiny = 0.01 * step;
  const double wide = (value_or_nan(curve, x + step) - here) / step,
               narrow = (value_or_nan(curve, x + tiny) - here) / tiny;
  if (!std::isfinite(wide) || !std::isfinite(narrow)) return {0.0, false};  // an expression ends near x
  const double noise = 1e-6 * (std::abs(here) + 1e-300) / range;
  if (std::abs(wide - narrow) <= 0.5 * std::max(std::abs(wide), std::abs(narrow)) + noise) return {wide, true};
  if (std::abs(narrow) > std::abs(wide)) return {0.0, false};  // grows as the step shrinks: a jump at x itself
  return {narrow, true};                                       // the wide step went over a kink or a jump
}

double curve_slope(const LoadController& curve, double x) {
  double range = std::abs(x);
  for (const auto& p : curve.points) range = std::max(range, std::abs(p[0]));
  if (!(range > 0)) range = 1.0;
  // differences of a curve given to 16 digits; a polynomial piece of degree 3 is met to 1e-6 of its slope
  const double step = 1e-6 * range;
  const OneSided up = side_slope(curve, x, step, range), down = side_slope(curve, x, -step, range);
  if (up.there && down.there) return 0.5 * (up.slope + down.slope);
  return up.there ? up.slope : down.there ? down.slope : 0.0;
}

}  // namespace

void add_line(int body_a, const Vector3d& arm_a, int body_b, const Vector3d& arm_b, const Tension& tension,
              const std::vector<Pose>& poses, BodyForces& forces) {
  const Vector3d c = poses[at(body_b)].center + arm_b - poses[at(body_a)].center - arm_a;
  const double L = c.norm();
  if (!(L > 0) || body_a == body_b) return;  // within one body nothing is pulled
  const Vector3d n = c / L, f = tension.force * n;
  const int a = 6 * body_a, b = 6 * body_b;
  forces.value.segment<3>(a) += f;
  forces.value.segment<3>(a + 3) += arm_a.cross(f);
  forces.value.segment<3>(b) -= f;
  forces.value.segment<3>(b + 3) -= arm_b.cross(f);
  const Matrix3d K = tension.force / L * (Matrix3d::Identity() - n * n.transpose()) + tension.slope * n * n.transpose();
  // dc = dv_b - [arm_b]x w_b - dv_a + [arm_a]x w_a
  Eigen::Matrix<double, 3, 12> dc;
  dc << -Matrix3d::Identity(), skew(arm_a), Matrix3d::Identity(), -skew(arm_b);
  Matrix12 D;
  D.topRows<3>() = K * dc;
  D.middleRows<3>(3) = skew(arm_a) * D.topRows<3>();
  D.middleRows<3>(6) = -D.topRows<3>();
  D.bottomRows<3>() = -skew(arm_b) * D.topRows<3>();
  D.block<3, 3>(3, 3) += skew(f) * skew(arm_a);  // (w x arm) x f
  D.block<3, 3>(9, 9) -= skew(f) * skew(arm_b);
  forces.derivative.add(body_a, body_b, D);
}

void add_turning_force(int body_a, const Vector3d& arm_a, int body_b, const Vector3d& arm_b, const Vector3d& f,
                       int turns, BodyForces& forces) {
  const int a = 6 * body_a, b = 6 * body_b;
  forces.value.segment<3>(a) += f;
  forces.value.segment<3>(a + 3) += arm_a.cross(f);
  forces.value.segment<3>(b) -= f;
  forces.value.segment<3>(b + 3) -= arm_b.cross(f);
  const Eigen::Index turned = turns == body_a ? 3 : 9;
  Matrix12 D = Matrix12::Zero();
  D.block<3, 3>(0, turned) = -skew(f);
  D.block<3, 3>(3, turned) = -skew(arm_a) * skew(f);
  D.block<3, 3>(6, turned) = skew(f);
  D.block<3, 3>(9, turned) = skew(arm_b) * skew(f);
  D.block<3, 3>(3, 3) += skew(f) * skew(arm_a);  // (w x arm) x f
  D.block<3, 3>(9, 9) -= skew(f) * skew(arm_b);
  forces.derivative.add(body_a, body_b, D);
}

void BlockMatrix::add(int a, int b, const Matrix12& value) { add(a, b, a, b, value); }

void BlockMatrix::add(int a, int b, int c, int d, const Matrix12& value) {
  blocks.push_back({a, c, value.topLeftCorner<6, 6>()});
  blocks.push_back({a, d, value.topRightCorner<6, 6>()});
  blocks.push_back({b, c, value.bottomLeftCorner<6, 6>()});
  blocks.push_back({b, d, value.bottomRightCorner<6, 6>()});
}

Eigen::MatrixXd BlockMatrix::dense(int bodies) const {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(6 * bodies, 6 * bodies);
  for (const Block& b : blocks) all.block<6, 6>(6 * b.row, 6 * b.column) += b.value;
  return all;
}

namespace {

/// What the curve of a ligament is a function of, and its derivative by the length.
struct Measure {
  double value = 0.0, per_length = 1.0;
};
Measure measure_of(const Ligament& l, double length) {
  const double elongation = length - l.free_length;
  if (l.measure == DiscreteSprings::Measure::Elongation) return {elongation, 1.0};
  const double per_length = 1.0 / l.free_length;
  return {(l.measure == DiscreteSprings::Measure::Strain ? elongation : length) * per_length, per_length};
}

double length_of(const Joint& joint, const Ligament& l, const std::vector<Pose>& poses) {
  return (poses[at(l.body_b)].center + arm_of(joint, l.body_b, l.point_b, poses) - poses[at(l.body_a)].center -
          arm_of(joint, l.body_a, l.point_a, poses))
      .norm();
}

}  // namespace

Tension tension(const Ligament& l, double length, double scale) {
  switch (l.law) {
    case Ligament::Law::Constant:
      return {scale, 0.0};
    case Ligament::Law::Linear:
      if (l.tension_only && length <= l.free_length) return {};
      return {l.stiffness * (length - l.free_length), l.stiffness};
    case Ligament::Law::Curve:
      break;
  }
  const Measure m = measure_of(l, length);
  const double force = value(*l.curve, m.value);
  return {scale * force, scale * curve_slope(*l.curve, m.value) * m.per_length};
}

std::string undefined_force(const Joint& joint, const LoadCase& load_case, const std::vector<Pose>& poses) {
  for (std::size_t i = 0; i < joint.ligaments.size(); ++i) {
    const Ligament& l = joint.ligaments[i];
    if (!load_case.ligament_active[i] || l.law != Ligament::Law::Curve || l.curve->expression.empty()) continue;
    const double length = length_of(joint, l, poses);
    if (std::isfinite(value_or_nan(*l.curve, measure_of(l, length).value))) continue;
    return fmt::format(
        "{}spring \"{}\" at time {}: its force \"{}\" has no finite value at {} = {:g} (length {:g}, free length "
        "{:g}); write it for every length, such as with max({}, 0)",
        l.where, l.name, time_text(load_case.time), l.curve->expression, l.curve->variable, measure_of(l, length).value,
        length, l.free_length, l.curve->variable);
  }
  return "";
}

double add_ligament(const Joint& joint, const Ligament& l, double scale, const std::vector<Pose>& poses,
                    BodyForces& forces) {
  const Vector3d arm_a = arm_of(joint, l.body_a, l.point_a, poses), arm_b = arm_of(joint, l.body_b, l.point_b, poses);
  const Tension t = tension(l, length_of(joint, l, poses), scale);
  if (t.force != 0.0 || t.slope != 0.0) add_line(l.body_a, arm_a, l.body_b, arm_b, t, poses, forces);
  return t.force;
}

void add_cable(const Joint& joint, const Cable& cable, double force, const std::vector<Pose>& poses,
               BodyForces& forces) {
  for (std::size_t i = 1; i < cable.points.size(); ++i) {
    const Cable::Point &a = cable.points[i - 1], &b = cable.points[i];
    add_line(a.body, arm_of(joint, a.body, a.position, poses), b.body, arm_of(joint, b.body, b.position, poses),
             {force, 0.0}, poses, forces);
  }
  const Cable::Point& last = cable.points.back();
  add_point_force(last.body, arm_of(joint, last.body, last.position, poses), force * cable.direction, false, forces);
}

double add_loads(const BodyConditions& c, int body, const Pose& pose, double length, BodyForces& forces) {
  const Matrix3d& R = pose.rotation;
  const Vector3d arm = R * c.arm, moment = R * c.follower.tail<3>();
  const Vector3d dead = c.dead.head<3>(), follower = R * c.follower.head<3>();
  const Vector3d before = forces.value.segment<3>(6 * body), turning = forces.value.segment<3>(6 * body + 3);
  double scale = 0.0;
  if (!dead.isZero(0.0)) add_point_force(body, arm, dead, false, forces);
  if (!follower.isZero(0.0)) add_point_force(body, arm, follower, true, forces);
  forces.value.segment<3>(6 * body + 3) += c.dead.tail<3>() + moment;
  if (!moment.isZero(0.0)) {
    Matrix6 D = Matrix6::Zero();
    D.block<3, 3>(3, 3) = -skew(moment);
    forces.derivative.add(body, D);
  }
  for (const PointForce& p : c.point_forces) {
    const Vector3d f = p.turns ? Vector3d(R * p.force) : p.force;
    add_point_force(body, R * p.arm, f, p.turns, forces);
    scale = std::max(scale, f.norm());
  }
  const Vector3d force = forces.value.segment<3>(6 * body) - before;
  const Vector3d total = forces.value.segment<3>(6 * body + 3) - turning;
  return std::max({scale, force.norm(), total.norm() / length});
}

}  // namespace dea

#include "src/equilibrium/motion_in_words.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>

#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/equilibrium/unknowns.h"

namespace dea {

using Eigen::VectorXd;

namespace {

/// A unit vector with three digits, and no -0.000.
std::string axis_in_words(const Vector3d& along) {
  const Vector3d unit = along.normalized();
  const auto digits = [](double x) { return std::round(1000 * x) / 1000 + 0.0; };
  return fmt::format("({:.3f}, {:.3f}, {:.3f})", digits(unit.x()), digits(unit.y()), digits(unit.z()));
}

}  // namespace

std::string direction_in_words(const Problem& problem, const Evaluation& e, const VectorXd& direction) {
  const VectorXd scaled = as_free(problem, e, direction);
  std::string text;
  for (std::size_t b = 0; b < problem.joint.bodies.size(); ++b) {
    Vector6 u = Vector6::Zero();
    for (std::size_t i = 0; i < problem.free.size(); ++i)
      if (at(problem.free[i] / 6) == b) u[problem.free[i] % 6] = scaled[static_cast<Eigen::Index>(i)];
    if (u.norm() < 0.3) continue;
    const Vector3d v = u.head<3>(), w = u.tail<3>();
    if (!text.empty()) text += " with ";
    if (w.norm() > 0.3)
      text += fmt::format("rotation of \"{}\" about {}", problem.joint.bodies[b].name, axis_in_words(w));
    if (v.norm() > 0.3)
      text += fmt::format("{} of \"{}\" along {}", w.norm() > 0.3 ? " and translation" : "translation",
                          problem.joint.bodies[b].name, axis_in_words(v));
  }
  return text.empty() ? "a combined motion" : text;
}

Travel travel(const Problem& problem, const std::vector<Pose>& from, const std::vector<Pose>& to) {
  Travel result;
  for (std::size_t b = 0; b < from.size(); ++b) {
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(to[b].rotation * from[b].rotation.transpose()));
    const Vector3d slide = to[b].center - from[b].center;
    const double turned = turn.angle() * problem.beds.length, slid = slide.norm();
    if (!(turned + slid > result.reached)) continue;
    result.reached = turned + slid;
    const std::string& name = problem.joint.bodies[b].name;
    result.words.clear();
    if (turned > 0.3 * slid)
      result.words = fmt::format("rotation of \"{}\" about ({:.3f}, {:.3f}, {:.3f}), turned {:.3g} degrees", name,
                                 turn.axis().x(), turn.axis().y(), turn.axis().z(), turn.angle() * 180.0 / kPi);
    if (slid > 0.3 * turned)
      result.words += fmt::format(
          "{}translation of \"{}\" along ({:.3f}, {:.3f}, {:.3f}), moved by {:.3g} (the model's unit of length)",
          result.words.empty() ? "" : ", and ", name, slide.x() / slid, slide.y() / slid, slide.z() / slid, slid);
  }
  return result;
}

std::string says_nothing_resists(const Problem& problem, const std::vector<Pose>& started, const Evaluation& e,
                                 const VectorXd& motion, double unbalanced) {
  const Travel gone = travel(problem, started, e.poses);
  const double cap = problem.beds.longest_step;
  return fmt::format(
      "{:.3g}% of the load acts along a motion that nothing resists: {}; no nearer to balance after {} poses;",
      100.0 * unbalanced,
      gone.reached > 2.0 * cap ? gone.words
                               : fmt::format("{}, followed for {:.3g} (the model's unit of length)",
                                             direction_in_words(problem, e, motion.normalized()), gone.reached),
      problem.casts);
}

Sentence against_free_motion() {
  return say(
      "fix one of the bodies in the model, hold this motion ({}), add what resists it, or check where the load acts",
      NamedSetting{"free"});
}

}  // namespace dea

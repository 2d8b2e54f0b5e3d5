#include <febiodea/equilibrium/equilibrium.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <febiodea/base/error.h>
#include <febiodea/base/numbers.h>
#include <febiodea/base/rotations.h>
#include <febiodea/equilibrium/approach.h>
#include <febiodea/equilibrium/motion_in_words.h>
#include <febiodea/equilibrium/newton.h>
#include <febiodea/equilibrium/separation.h>
#include <febiodea/equilibrium/unknowns.h>
#include <febiodea/springs/spring_law.h>

namespace dea {

using Eigen::VectorXd;

namespace {

/// Springs strained beyond the law's limit, or through.
int beyond_limit(const Evaluation& e) {
  int count = 0;
  for (const SpringStates& s : e.springs) {
    const SpringDepth depth = spring_depth(s);
    count += depth.strained + depth.through;
  }
  return count;
}

/// The whole search for one load case from one start.
Solution solve(Problem& problem, const std::vector<Pose>& start, const EquilibriumOptions& options) {
  problem.tolerance = tolerance_after(1.0);
  Evaluation e = evaluate(problem, start);
  if (too_deep_area(problem, e) > 0) {
    Approach out = back_out(problem, e);
    if (out.found) e = std::move(out.at);
  }
  const std::vector<Pose> poses = e.poses;
  Solution direct = newton(problem, std::move(e), options);
  const bool left_unbalanced = direct.outcome == Outcome::NoEquilibrium;
  if ((direct.outcome != Outcome::NotConverged && !left_unbalanced) || !direct.at.contact.allFinite()) return direct;
  // Continuation: what is out of balance at the start is held back and released piece by piece.
  Evaluation from =
      evaluate(problem, poses);  // a copy, kept for this rare case, would be as large as the springs' states
  const auto opens = [&](const Evaluation& e, double* left) {
    const Separation apart = separation(problem, e);
    *left = apart.left;
    return apart.left > 0.05 && apart.opening > 0.1;  // far above what facets' normals are uncertain by
  };
  double left_at_start = 0.0, left_at_end = 0.0;
  if (opens(from, &left_at_start) && opens(direct.at, &left_at_end)) {
    direct.outcome = Outcome::SurfacesApart;
    direct.message = fmt::format(
        "the load moves the surfaces apart: pressures on them, however spread, leave {:.2g} of it unbalanced",
        std::min(left_at_start, left_at_end));
    return direct;
  }
  if (left_unbalanced && beyond_limit(direct.at) == 0) return direct;
  const VectorXd all = from.residual();
  double done = 0.0, piece = 0.25;
  int iterations = direct.iterations;
  EquilibriumOptions pieces = options;
  pieces.patience = (options.patience + 1) / 2;
  int lost = 0;  // poses of pieces that failed: all together what one search may lose
  while (done < 1.0 && piece > 1.0 / 128 && lost < options.patience && problem.casts < options.max_casts) {
    const int before = problem.casts;
    const double next = std::min(1.0, done + piece);
    problem.offset = (1.0 - next) * all;
    Solution part = newton(problem, from, pieces);
    iterations += part.iterations;
    if (part.outcome == Outcome::Balanced || part.outcome == Outcome::BalancedToOneSpring) {
      done = next;
      if (done >= 1.0) {
        problem.offset.setZero();
        part.iterations = iterations;
        return part;
      }
      from = std::move(part.at);
      piece *= 1.5;
    } else {
      if (beyond_limit(part.at) > 0) break;  // more pieces would press through all the same
      lost += problem.casts - before;
      piece *= 0.5;
    }
  }
  problem.offset.setZero();
  direct.iterations = iterations;
  if (const int beyond = beyond_limit(direct.at); beyond > 0) {
    direct.outcome = Outcome::BeyondStrainLimit;
    direct.message = fmt::format(
        "no balance: {:.3g}% of the load is not carried when {} springs are strained beyond {}: the layers are too "
        "thin or "
        "too soft for it",
        100.0 * (direct.history.empty() ? 1.0 : direct.history.back()), beyond, kStrainLimit);
  } else if (const auto soft = soft_motion(problem, direct.at, scaled_residual(problem, direct.at))) {
    direct.outcome = Outcome::NoEquilibrium;
    direct.message =
        says_nothing_resists(problem, poses, direct.at, *soft, direct.history.empty() ? 1.0 : direct.history.back());
  }
  return direct;
}

void fill(Equilibrium& result, const Problem& problem, Evaluation e) {
  const VectorXd total = e.residual();
  double force2 = 0.0, moment2 = 0.0;
  bool any_force = false, any_moment = false;
  for (int dof : problem.free) {
    (dof % 6 < 3 ? any_force : any_moment) = true;
    (dof % 6 < 3 ? force2 : moment2) += total[dof] * total[dof];
  }
  result.residual_force = any_force ? std::sqrt(force2) : kNaN;
  result.residual_moment = any_moment ? std::sqrt(moment2) : kNaN;
  result.load = e.load;
  for (std::size_t b = 0; b < e.poses.size(); ++b)
    result.reaction.push_back(-(e.contact + e.ligaments + e.reactions).segment<6>(6 * static_cast<Eigen::Index>(b)));
  result.cable_force = problem.load_case.cable_force;
  if (!problem.load_case.connector_active.empty()) {
    if (problem.joined())
      result.connector_force =
          connector_forces(problem.joint, problem.load_case, e.rows, e.tangent.multipliers, e.poses);
    else  // nothing has been solved, or nothing can move
      result.connector_force.assign(problem.joint.connectors.size(), Vector6::Constant(kNaN));
    for (const Connector& c : problem.joint.connectors)
      result.connector_motion.push_back(connector_motion(problem.joint, c, e.poses));
  }
  result.poses = std::move(e.poses);
  result.springs = std::move(e.springs);
  result.contact_on_target = std::move(e.contact_on_target);
  result.ligament_force = std::move(e.ligament_force);
  result.casts = problem.casts;
  // A law stretched beyond where it means anything is no answer, however well it balances.
  int beyond = 0;
  double largest = 0.0;
  for (const SpringStates& s : result.springs) {
    const SpringDepth depth = spring_depth(s);  // a spring that is through has no strain
    beyond += depth.strained + depth.through;
    largest = std::max({largest, depth.largest, depth.through > 0 ? 1.0 : 0.0});
  }
  for (const SpringStates& s : result.springs) {
    if (s.complementary || !solved(result.outcome)) continue;
    result.outcome = Outcome::NotConverged;
    result.message = fmt::format("the layers' pressures are known to {:.1e} only", s.complementarity);
  }
  if (beyond > 0 && solved(result.outcome)) {
    result.outcome = Outcome::BeyondStrainLimit;
    result.message =
        fmt::format("{} springs are strained beyond {} (largest {}{:.3g}): the surfaces pass too far into each other",
                    beyond, kStrainLimit, largest >= 1 ? "at least " : "", largest);
  }
}

}  // namespace

std::vector<Pose> reference_poses(const Joint& joint) {
  std::vector<Pose> poses;
  for (const Body& b : joint.bodies) poses.push_back({b.center_of_mass, Eigen::Matrix3d::Identity()});
  return poses;
}

BodyForces forces_at(const Joint& joint, const SpringBeds& beds, const LoadCase& load_case,
                     const std::vector<Pose>& poses) {
  std::vector<PressMemory> memory;
  Problem problem = make_problem(joint, beds, load_case, memory);
  Evaluation e = evaluate(problem, poses);
  BodyForces forces(joint.bodies.size());
  forces.value = e.residual();
  forces.derivative = std::move(e.derivative);
  return forces;
}

Equilibrium state_at(const Joint& joint, const SpringBeds& beds, const LoadCase& load_case,
                     const std::vector<Pose>& poses, std::vector<PressMemory>* memory) {
  std::vector<PressMemory> own;
  if (const std::string fault = undefined_force(joint, load_case, poses); !fault.empty()) throw InputError(fault);
  Problem problem = make_problem(joint, beds, load_case, memory ? *memory : own);
  problem.tolerance = kGivenPoseTolerance;
  Equilibrium result;
  result.outcome = Outcome::Prescribed;
  result.message = "motion given";
  result.least_stiffness = kNaN;
  fill(result, problem, evaluate(problem, poses));
  return result;
}

Equilibrium solve_equilibrium(const Joint& joint, const SpringBeds& beds, const LoadCase& load_case,
                              const std::vector<Pose>& start, const std::vector<Pose>& step_start,
                              const EquilibriumOptions& options, std::vector<PressMemory>* memory) {
  std::vector<Pose> poses = start;
  std::vector<PressMemory> own;
  Problem problem = make_problem(joint, beds, load_case, memory ? *memory : own);
  problem.watch = &options.watch;
  for (int b = 0; b < static_cast<int>(joint.bodies.size()); ++b) {
    const BodyConditions& c = load_case.bodies[at(b)];
    Pose& pose = poses[at(b)];
    for (int k = 0; k < 3; ++k) {
      if (c.dofs[at(k)] != DofState::Prescribed) continue;
      pose.center[k] =
          (c.relative[at(k)] ? step_start[at(b)].center[k] : joint.bodies[at(b)].center_of_mass[k]) + c.value[k];
    }
    const auto prescribed = std::find(c.dofs.begin() + 3, c.dofs.end(), DofState::Prescribed);
    if (prescribed != c.dofs.end()) {
      const bool relative = c.relative[static_cast<std::size_t>(prescribed - c.dofs.begin())];
      pose.rotation = relative ? Eigen::Matrix3d(rotation(c.value.tail<3>()) * step_start[at(b)].rotation)
                               : rotation(c.value.tail<3>());
    }
    for (int k = 0; k < kDofs; ++k)
      if (c.dofs[at(k)] == DofState::Free) problem.free.push_back(6 * b + k);
  }
  problem.scale.resize(static_cast<Eigen::Index>(problem.free.size()));
  for (std::size_t i = 0; i < problem.free.size(); ++i)
    problem.scale[static_cast<Eigen::Index>(i)] = problem.free[i] % 6 < 3 ? 1.0 : beds.length;

  Equilibrium result;
  if (joint.connectors.size() > 0 && load_case.connector_active.size() == joint.connectors.size()) {
    const double size = beds.length + beds.reach;
    problem.connectors = make_groups(joint, load_case, problem.free, beds.length, size, start);
    ConnectorRow worst;
    std::vector<Pose> closed = poses;
    if (!close_connectors(joint, load_case, problem.connectors, closed, &worst)) {
      result = state_at(joint, beds, load_case, poses, &problem.memory);
      result.outcome = Outcome::NoEquilibrium;
      const Connector& c = joint.connectors[at(worst.connector)];
      result.message = fmt::format(
          "joint \"{}\" cannot be held together with the other joints and with what is fixed or prescribed: a gap of "
          "{:.3g}{} is left {} its axis {}; free a motion or take a joint out",
          c.name, std::abs(worst.gap), worst.dof < 3 ? "" : " rad", worst.dof < 3 ? "along" : "about",
          worst.dof % 3 + 1);
      return result;
    }
    poses = std::move(closed);
  }
  if (problem.free.empty()) {
    result = state_at(joint, beds, load_case, poses, &problem.memory);
    return result;
  }
  if (const std::string fault = undefined_force(joint, load_case, poses); !fault.empty()) throw InputError(fault);
  Solution s = solve(problem, poses, options);
  if (s.at.tolerance > kPressureTolerance) {  // a search that ended far from balance
    problem.tolerance = kPressureTolerance;
    s.at = evaluate(problem, std::move(s.at.poses));
  }
  result.outcome = s.outcome;
  result.message = s.message;
  result.iterations = s.iterations;
  result.history = s.history;
  result.least_stiffness = s.directions.least_stiffness;
  const bool loose = !touching(s.at);
  const VectorXd r = scaled_residual(problem, s.at);
  for (const VectorXd& v : s.directions.held) {
    // a body that is neither loaded nor touched simply stays: said once by the caller
    if (loose && s.at.load == 0.0) continue;
    const double along = s.at.load > 0 ? std::abs(v.dot(r)) / s.at.load : 0.0;
    result.held.push_back(
        direction_in_words(problem, s.at, v) +
        (along > 1e-6 ? fmt::format(" ({:.1e} of the load left along it: the facets' roughness)", along) : ""));
  }
  fill(result, problem, std::move(s.at));
  return result;
}

}  // namespace dea

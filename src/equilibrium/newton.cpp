#include <febiodea/equilibrium/newton.h>

#include <fmt/format.h>

#include <Eigen/Dense>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <febiodea/base/numbers.h>
#include <febiodea/equilibrium/approach.h>
#include <febiodea/equilibrium/motion_in_words.h>
#include <febiodea/equilibrium/unknowns.h>

namespace dea {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

namespace {

double largest_spring_force(const Evaluation& e) {
  double largest = 0.0;
  for (const SpringStates& s : e.springs)
    for (int i = 0; i < s.size(); ++i) largest = std::max(largest, s.pressure[at(i)] * s.area[at(i)]);
  return largest;
}

bool within_one_spring(const Evaluation& e, double size) {
  return size <= 0.01 * e.load && size <= largest_spring_force(e);
}

/// A residual that cannot fall below what one spring carries, because that spring jumps on and off a rim.
bool to_one_spring(const Evaluation& e, double size, Solution& solution) {
  if (!within_one_spring(e, size)) return false;
  const double one = largest_spring_force(e);
  solution.outcome = Outcome::BalancedToOneSpring;
  solution.message = fmt::format(
      "unbalanced force is {:.2e} of the load, less than one spring carries ({:.2e}); it cannot fall further on this "
      "mesh",
      size / e.load, one / e.load);
  return true;
}

/// What a search may still cost. Every pose tried is paid for, every halving of the residual earns some of it back: a
/// search that comes nearer to balance goes on, one that only travels ends.
struct Patience {
  double most = 0.0, left = 0.0;
  double best = kInfinity;  // residual / load
  int paid = 0;             // poses paid for
  int far = 0, near = 0;    // since the best: poses from iterates that saw balance beyond the next step, and others
  bool out() const { return left < 0.0; }
  /// More of `tried` poses are spent; `beyond`: in a step that was cut short.
  void pay(int tried, bool beyond) {
    (beyond ? far : near) += tried - paid;
    left -= std::min(tried - paid, 8);  // one step that is hard to find is no reason to give up
    paid = tried;
  }
  void earn(double residual) {
    constexpr double kPerHalving = 200.0;  // a ball rolling down a groove needs as many: by 7% in 20 poses
    if (!(residual < best)) return;
    if (best < kInfinity && residual > 0.0) left = std::min(most, left + kPerHalving * std::log2(best / residual));
    if (residual < 0.98 * best) far = near = 0;
    best = residual;
  }
};

constexpr int kMostStride = 8;  // steps that only slide may be so much longer

}  // namespace

Solution newton(Problem& problem, Evaluation e, const EquilibriumOptions& options) {
  Solution solution;
  const double cap = 0.5 * problem.beds.least_thickness;
  const std::vector<Pose> started = e.poses;
  int advances = 0;
  Patience patient{static_cast<double>(options.patience), static_cast<double>(options.patience)};
  patient.paid = problem.casts;
  bool beyond = false;  // balance is farther than the step from the last iterate
  int full = 0;         // steps in a row that were cut to the cap and taken
  double stride = 1.0;  // of the cap, for steps along which no spring closes by more than the cap
  VectorXd last_drift;  // over all dofs
  for (;;) {
    const VectorXd r = scaled_residual(problem, e);
    // a direction at the edge of the facets' noise must not change sides for ever
    const double patience = 1.0 + 0.1 * std::max(0, solution.iterations - 12);
    Directions d = split_stiff_from_flat(problem, e, r, patience);
    const double size = d.residual.norm();
    // what is left may be the pressures' own error
    if (e.tolerance > kPressureTolerance && size <= 100.0 * e.tolerance * e.load) {
      problem.tolerance = tolerance_after(e.load > 0 ? size / e.load : 0.0);
      if (problem.tolerance > 0.1 * e.tolerance) problem.tolerance = kPressureTolerance;
      e = evaluate(problem, std::move(e.poses));
      continue;
    }
    solution.history.push_back(e.load > 0 ? size / e.load : 0.0);
    problem.status.residual = solution.history.back();
    problem.tolerance = tolerance_after(solution.history.back());
    if (!std::isfinite(size)) {
      solution.message = "a force is no finite number at this pose";
      break;
    }
    if (size <= options.tolerance * e.load) {
      solution.outcome = Outcome::Balanced;
      solution.message = fmt::format("balanced to {:.1e} of the load in {} iterations",
                                     e.load > 0 ? size / e.load : 0.0, solution.iterations);
      solution.at = std::move(e);
      solution.directions = std::move(d);
      return solution;
    }
    patient.pay(problem.casts, beyond);
    patient.earn(solution.history.back());
    const bool loose = 3 * patient.far > patient.near;
    constexpr int kFar = 8;  // poses; a turn of 30 degrees, or a slide of half the articular surface's radius
    const bool wandered =
        loose && patient.far > kFar && travel(problem, started, e.poses).reached > 0.5 * problem.beds.length;
    if ((wandered || patient.out()) && !within_one_spring(e, size)) {
      const std::optional<VectorXd> soft = soft_motion(problem, e, r);
      if (loose || soft) {
        solution.outcome = Outcome::NoEquilibrium;
        solution.message =
            says_nothing_resists(problem, started, e, soft ? *soft : VectorXd(d.newton + d.drift), size / e.load);
      } else {
        solution.message = fmt::format(
            "unbalanced force is {:.2e} of the load after {} iterations and {} poses tried, and falls no more",
            size / e.load, solution.iterations, problem.casts);
      }
      break;
    }
    if (loose && patient.left < -0.5 * patient.most && to_one_spring(e, size, solution)) break;
    if (solution.iterations >= options.max_iterations || problem.casts >= options.max_casts) {
      if (to_one_spring(e, size, solution)) break;
      solution.message = fmt::format("unbalanced force is {:.2e} of the load after {} iterations and {} poses tried",
                                     size / e.load, solution.iterations, problem.casts);
      break;
    }
    ++solution.iterations;
    ++problem.status.iterations;

    const double drift = d.drift.norm();
    if (drift > options.tolerance * e.load && drift >= 0.5 * size) {
      // Nothing resists the load in some direction: without contact go to first touch, with contact follow it for a
      // while.
      if (!touching(e)) {
        Approach s = advances++ < 3 ? advance(problem, std::move(e), d.drift) : Approach{false, std::move(e)};
        e = std::move(s.at);
        if (s.found) continue;
        solution.outcome = Outcome::SurfacesApart;
        solution.message = fmt::format("the load moves the surfaces apart: no spring closes along it ({})",
                                       travel(problem, started, e.poses).words);
        break;
      }
      beyond = true;
      VectorXd step = d.newton;
      const double stiff = surface_motion(problem, e, step);
      if (stiff > cap) step *= cap / stiff;
      const VectorXd way = on_all_dofs(problem, e, d.drift);
      const bool same_way =
          last_drift.size() == way.size() && last_drift.dot(way) > 0.7 * last_drift.norm() * way.norm();
      full = same_way ? full + 1 : 0;
      if (!same_way) stride = 1.0;
      if (full >= 3) stride = std::min<double>(kMostStride, 2.0 * stride);
      last_drift = way;
      const VectorXd drift_step = d.drift * (cap / surface_motion(problem, e, d.drift));
      std::optional<Evaluation> next;
      for (;; stride = 1.0, full = 0) {
        const double closing = closing_motion(problem, e, drift_step);
        stride = std::max(1.0, std::min(stride, closing > 0 ? cap / closing : stride));
        auto poses = poses_after(problem, e, step + stride * drift_step);
        next.reset();
        if (poses) next = evaluate(problem, std::move(*poses));
        if (stride <= 1.0 || (next && lost_force(e, *next) < 0.5 * e.normal_force &&
                              scaled_residual(problem, *next).norm() < 4.0 * size))
          break;
      }
      if (!next) {
        solution.message =
            "a loaded motion that nothing resists ends where joints lock or a spring's force is undefined";
        break;
      }
      e = std::move(*next);
      continue;
    }
    // the next step is cut short, and not because springs close: balance is far along a motion that little resists
    const double predicted = surface_motion(problem, e, d.newton);
    beyond = predicted > cap && closing_motion(problem, e, d.newton) < 0.5 * predicted;

    // A Newton step, shortened until the residual falls; springs that lose their target count as residual.
    const auto try_step = [&](VectorXd step) -> bool {
      const double motion = surface_motion(problem, e, step);
      if (!(motion > 0) || !std::isfinite(motion)) return false;
      double most = cap;
      if (stride > 1.0) {
        const double closing = closing_motion(problem, e, step) / motion;  // per unit of motion
        most = cap * std::max(1.0, std::min(stride, closing > 0 ? 1.0 / closing : stride));
      }
      const bool cut = motion > most;
      if (cut) step *= most / motion;
      const double whole = std::min(motion, most);
      for (double length = whole; length > std::min(whole, cap) / 33.0; length *= 0.5, step *= 0.5) {
        if (problem.casts >= options.max_casts || problem.casts - patient.paid >= 2.0 * patient.most) return false;
        auto poses = poses_after(problem, e, step);
        if (!poses) continue;
        Evaluation trial = evaluate(problem, std::move(*poses));
        VectorXd trial_r = scaled_residual(problem, trial);
        if (!d.held.empty()) {
          MatrixXd left_unbalanced = d.left_unbalanced;
          if (problem.joined()) {  // the same directions, among the motions left at the new pose
            left_unbalanced = trial.tangent.basis.transpose() * (e.tangent.basis * left_unbalanced);
            const Eigen::HouseholderQR<MatrixXd> qr(left_unbalanced);
            left_unbalanced = qr.householderQ() * MatrixXd::Identity(left_unbalanced.rows(), left_unbalanced.cols());
          }
          trial_r -= left_unbalanced * (left_unbalanced.transpose() * trial_r);
        }
        if (trial_r.norm() + lost_force(e, trial) < size) {
          const bool at_once = length == whole;
          full = cut && at_once ? full + 1 : 0;
          if (full >= 3)
            stride = std::min<double>(kMostStride, 2.0 * stride);
          else if (full == 0)
            stride = 1.0;
          e = std::move(trial);
          return true;
        }
      }
      return false;
    };
    if (try_step(d.newton)) continue;
    // Regularised steps turn from Newton's direction towards the force itself.
    const Sparse K = scaled_stiffness(problem, e);
    const double stiffest = K.norm();
    Sparse one(K.rows(), K.cols());
    one.setIdentity();
    bool moved_on = false;
    for (double lambda = 1e-3; lambda <= 10.0 && !moved_on; lambda *= 10.0) {
      const Sparse regular = K + lambda * stiffest * one;
      if (K.rows() <= kDenseUnknowns) {
        moved_on = try_step(MatrixXd(regular).partialPivLu().solve(d.residual));
      } else {
        const Eigen::SparseLU<Sparse> lu(regular);
        moved_on = lu.info() == Eigen::Success && try_step(lu.solve(d.residual));
      }
    }
    if (moved_on) continue;
    patient.pay(problem.casts, beyond);
    if (patient.out() && !within_one_spring(e, size)) {
      solution.history.pop_back();  // the same iterate again, to be given up
      continue;
    }
    if (!to_one_spring(e, size, solution))
      solution.message = fmt::format(
          "unbalanced force is {:.2e} of the load after {} iterations and no step lowers it{}", size / e.load,
          solution.iterations, problem.undefined.empty() ? "" : "; steps were refused: " + problem.undefined);
    break;
  }
  solution.directions =
      split_stiff_from_flat(problem, e, scaled_residual(problem, e), 1.0 + 0.1 * std::max(0, solution.iterations - 12));
  solution.at = std::move(e);
  return solution;
}

}  // namespace dea

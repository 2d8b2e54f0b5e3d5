#include "src/equilibrium/newton.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "src/base/decompositions.h"
#include "src/base/numbers.h"
#include "src/equilibrium/approach.h"
#include "src/equilibrium/motion_in_words.h"
#include "src/equilibrium/unknowns.h"

namespace dea {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

namespace {

double largest_spring_force(const Evaluation& e) {
  double largest = 0.0;
  for (const SpringStates& s : e.springs)
    for (int i = 0; i < s.size(); ++i) largest = std::max(largest, s.force(at(i)));
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
  bool loose() const { return 3 * far > near; }
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

/// What a search learns of its stiffness. The derivative of the contacts' forces leaves out how the parts of the target
/// under a foot change as it slides, some thousandths of it; each step tells what was missing along it, for by the
/// trapezoidal rule  r(x) - r(x + s) = (K(x) + K(x + s))/2 s + E s  up to third order. E: Broyden's least change
/// (1965, Math Comp 19:577) from step to step.
struct Secant {
  VectorXd step = {}, residual = {};      // that led to the iterate, and at the iterate before it; empty: none
  MatrixXd stiffness = {}, missing = {};  // there, and E
};

/// A search under way. `cap`: no step moves a surface farther on its partner, half the least thickness.
struct Search {
  Problem& problem;
  const EquilibriumOptions& options;
  const std::vector<Pose> started;  // poses it began from
  const double cap;
  Evaluation e;  // the iterate
  Patience patient;
  Solution solution = {};
  // of the iterate
  VectorXd r = {};  // residual over the unknowns
  Directions d = {};
  double size = 0.0;       // of the part of it that is to vanish
  double most_load = 0.0;  // so far: where nothing but contact presses, it fades as the surfaces part
  // of the steps so far
  int advances = 0;          // to surfaces that did not touch
  bool passes_by = false;    // what falls meets no surface
  bool beyond = false;       // balance is farther than the step from the last iterate
  int full = 0;              // steps in a row that were cut to the cap and taken
  double stride = 1.0;       // of the cap, for steps along which no spring closes by more than the cap
  VectorXd last_drift = {};  // over all dofs
  Secant secant = {};
};

/// A direction at the edge of the facets' noise must not change sides for ever.
Directions directions_at(const Search& s, const VectorXd& r) {
  return split_stiff_from_flat(s.problem, s.e, r, 1.0 + 0.1 * std::max(0, s.solution.iterations - 12));
}

/// What is left may be the pressures' own error: then they are worked out more closely at the same poses.
bool press_more_closely(Search& s) {
  Problem& problem = s.problem;
  const double before = s.e.tolerance;
  if (!(before > kPressureTolerance && s.size <= 3.0 * before * s.e.load)) return false;
  problem.tolerance = tolerance_after(s.e.load > 0 ? s.size / s.e.load : 0.0);
  if (problem.tolerance > 0.1 * before) problem.tolerance = kPressureTolerance;
  s.e = evaluate(problem, std::move(s.e.poses));
  return true;
}

bool balanced(Search& s) {
  if (!std::isfinite(s.size)) return false;
  if (s.size > s.options.tolerance * s.e.load) {
    const bool unloaded = s.e.external.isZero(0) && s.e.ligaments.isZero(0) && s.problem.offset.isZero(0);
    if (!unloaded || !(s.size <= s.options.tolerance * s.most_load)) return false;
    s.solution.outcome = Outcome::Balanced;
    s.solution.message = s.e.load > 1e-3 * s.most_load
                             ? fmt::format("balanced to {:.1e} of the largest load on the way", s.size / s.most_load)
                             : "nothing presses the bodies together: the surfaces have parted";
    return true;
  }
  s.solution.outcome = Outcome::Balanced;
  s.solution.message = fmt::format("balanced to {:.1e} of the load", s.solution.history.back());
  s.solution.counted = true;
  return true;
}

void say_unbalanced(Search& s, const std::string& why_it_ends) {
  s.solution.message = fmt::format("unbalanced force is {:.2e} of the load{}", s.size / s.e.load, why_it_ends);
  s.solution.counted = true;
}

/// No nearer to balance for long, or so far from where it began that balance will not be near.
bool out_of_patience(Search& s) {
  s.patient.pay(s.problem.casts, s.beyond);
  s.patient.earn(s.solution.history.back());
  const bool loose = s.patient.loose();
  constexpr int kFar = 8;  // poses; a turn of 30 degrees, or a slide of half the articular surface's radius
  const bool wandered =
      loose && s.patient.far > kFar && travel(s.problem, s.started, s.e.poses).reached > 0.5 * s.problem.beds.length;
  if ((!wandered && !s.patient.out()) || within_one_spring(s.e, s.size)) return false;
  const std::optional<VectorXd> soft = soft_motion(s.problem, s.e, s.r);
  if (loose || soft) {
    s.solution.outcome = Outcome::NoEquilibrium;
    s.solution.message = says_nothing_resists(s.problem, s.started, s.e,
                                              soft ? *soft : VectorXd(s.d.newton + s.d.drift), s.size / s.e.load);
    s.solution.advice = against_free_motion();
  } else {
    say_unbalanced(s, ", and falls no more");
  }
  return true;
}

bool gives_up(Search& s) {
  if (!std::isfinite(s.size)) {
    s.solution.message = "a force is no finite number at this pose";
    return true;
  }
  if (out_of_patience(s)) return true;
  if (s.patient.loose() && s.patient.left < -0.5 * s.patient.most && to_one_spring(s.e, s.size, s.solution))
    return true;
  if (s.solution.iterations < s.options.max_iterations && s.problem.casts < s.options.max_casts) return false;
  if (!to_one_spring(s.e, s.size, s.solution)) say_unbalanced(s, "");
  return true;
}

/// Nothing resists the load in some direction, and nothing touches: to first touch. False: the search ends.
bool go_to_touch(Search& s) {
  if (s.advances++ < 3 && advance(s.problem, s.e, s.d.drift)) return true;
  if (s.d.falls) {  // past the surfaces, to hang from what holds it: is followed from the next iterate on
    s.passes_by = true;
    return true;
  }
  s.solution.outcome = Outcome::SurfacesApart;
  const std::string way = travel(s.problem, s.started, s.e.poses).words;  // empty: there was none to go
  s.solution.message = fmt::format("the load moves the surfaces apart: no spring closes along it ({})",
                                   way.empty() ? direction_in_words(s.problem, s.e, s.d.drift.normalized()) : way);
  return false;
}

/// Nothing resists the load in some direction, and to touch leads no way: along it for a while. False: the search ends.
bool follow_load(Search& s) {
  Problem& problem = s.problem;
  s.beyond = true;
  VectorXd step = s.d.newton;
  const double stiff = surface_motion(problem, s.e, step);
  if (stiff > s.cap) step *= s.cap / stiff;
  const VectorXd way = on_all_dofs(problem, s.e, s.d.drift);
  const bool same_way =
      s.last_drift.size() == way.size() && s.last_drift.dot(way) > 0.7 * s.last_drift.norm() * way.norm();
  s.full = same_way ? s.full + 1 : 0;
  if (!same_way) s.stride = 1.0;
  if (s.full >= 3) s.stride = std::min<double>(kMostStride, 2.0 * s.stride);
  s.last_drift = way;
  const VectorXd drift_step = s.d.drift * (s.cap / surface_motion(problem, s.e, s.d.drift));
  std::optional<Evaluation> next;
  for (;; s.stride = 1.0, s.full = 0) {
    const double closing = closing_motion(problem, s.e, drift_step);
    s.stride = std::max(1.0, std::min(s.stride, closing > 0 ? s.cap / closing : s.stride));
    auto poses = poses_after(problem, s.e, step + s.stride * drift_step);
    next.reset();
    if (poses) next = evaluate(problem, std::move(*poses));
    if (s.stride <= 1.0 || (next && lost_force(s.e, *next) < 0.5 * s.e.normal_force &&
                            scaled_residual(problem, *next).norm() < 4.0 * s.size))
      break;
  }
  if (!next) {
    s.solution.message = "a loaded motion that nothing resists ends where joints lock or a spring's force is undefined";
    return false;
  }
  s.e = std::move(*next);
  return true;
}

/// The gaps under pressed parts were found where these have moved: else pressures mean nothing.
bool parts_fit(const Evaluation& e) {
  return std::all_of(e.springs.begin(), e.springs.end(), [](const SpringStates& s) {
    return s.complementary || (s.part_motion[0].size() == 0 && s.part_motion[1].size() == 0);
  });
}

/// The residual at another pose without the components that are held at the iterate; springs that lost their target
/// count as residual.
double residual_at(const Search& s, const Evaluation& trial) {
  if (!parts_fit(trial)) return kInfinity;
  VectorXd r = scaled_residual(s.problem, trial);
  if (!s.d.held.empty()) {
    MatrixXd left_unbalanced = s.d.left_unbalanced;
    if (s.problem.joined()) {  // the same directions, among the motions left at the new pose
      left_unbalanced = trial.tangent.basis.transpose() * (s.e.tangent.basis * left_unbalanced);
      left_unbalanced = orthonormal_columns(left_unbalanced);
    }
    r -= left_unbalanced * (left_unbalanced.transpose() * r);
  }
  return r.norm() + lost_force(s.e, trial);
}

constexpr double kWholeOnly = 0.6;  // as `least` below: half a step is too short to be tried

/// A step, shortened until the residual falls, down to `least` of its length. False: it does not, or there are no more
/// poses to be tried.
bool shortened_step(Search& s, VectorXd step, double least = 1.0 / 33.0) {
  Problem& problem = s.problem;
  const double motion = surface_motion(problem, s.e, step);
  if (!(motion > 0) || !std::isfinite(motion)) return false;
  double most = s.cap;
  if (s.stride > 1.0) {
    const double closing = closing_motion(problem, s.e, step) / motion;  // per unit of motion
    most = s.cap * std::max(1.0, std::min(s.stride, closing > 0 ? 1.0 / closing : s.stride));
  }
  const bool cut = motion > most;
  if (cut) step *= most / motion;
  const double whole = std::min(motion, most);
  for (int halved = 0;; ++halved, step *= 0.5) {
    const double length = std::ldexp(whole, -halved);
    if (!(length > least * std::min(whole, s.cap))) break;
    if (problem.casts >= s.options.max_casts || problem.casts - s.patient.paid >= 2.0 * s.patient.most) return false;
    auto poses = poses_after(problem, s.e, step);
    if (!poses) continue;
    Evaluation trial = evaluate(problem, std::move(*poses));
    if (!(residual_at(s, trial) < s.size)) continue;
    const bool at_once = length == whole;
    s.secant.step = step;
    s.full = cut && at_once ? s.full + 1 : 0;
    if (s.full >= 3)
      s.stride = std::min<double>(kMostStride, 2.0 * s.stride);
    else if (s.full == 0)
      s.stride = 1.0;
    s.e = std::move(trial);
    return true;
  }
  return false;
}

/// What the stiffness lacks, by the residual that the last step left.
void update_secant(Search& s) {
  Secant& secant = s.secant;
  const MatrixXd K(s.d.stiffness);
  if (secant.step.size() == K.cols()) {
    const VectorXd seen = secant.residual - s.r, predicted = 0.5 * (secant.stiffness + K) * secant.step;
    if (secant.missing.size() == 0) secant.missing = MatrixXd::Zero(K.rows(), K.cols());
    const VectorXd missing = seen - predicted - secant.missing * secant.step;
    constexpr double kMost = 0.05;  // a kink, not the stiffness, where more is missing
    if (missing.norm() < kMost * predicted.norm())
      secant.missing += missing * secant.step.transpose() / secant.step.squaredNorm();
  }
  secant.stiffness = K;
  secant.residual = s.r;
  secant.step = VectorXd();
}

/// Newton's step with what the stiffness lacks.
VectorXd corrected_step(const Search& s) {
  const Secant& secant = s.secant;
  if (secant.missing.size() == 0 || s.d.left_unbalanced.cols() > 0 || s.problem.downhill) return s.d.newton;
  return solve_regular(secant.stiffness + secant.missing, s.d.residual);
}

/// Regularised steps turn from Newton's direction towards the force itself.
bool regularised_step(Search& s) {
  const Sparse& K = s.d.stiffness;
  const double stiffest = K.norm();
  Sparse one(K.rows(), K.cols());
  one.setIdentity();
  bool moved_on = false;
  for (const double lambda : {1e-3, 1e-2, 0.1, 1.0, 10.0}) {
    if (moved_on) break;
    const Sparse regular = K + lambda * stiffest * one;
    if (K.rows() <= kDenseUnknowns) {
      moved_on = shortened_step(s, solve_regular(MatrixXd(regular), s.d.residual));
    } else {
      const SparseLuFactors lu(regular);
      moved_on = lu.found() && shortened_step(s, lu.solve(s.d.residual));
    }
  }
  return moved_on;
}

/// Along what is loaded and nothing resists no surface moves on its partner: following it leads nowhere. False.
bool says_nothing_holds_them(Search& s) {
  s.solution.outcome = Outcome::NoEquilibrium;
  s.solution.message =
      fmt::format("{:.0f}% of the load moves the bodies together, none on its partner, and nothing holds them: {};",
                  100 * s.d.drift.norm() / s.e.load, direction_in_words(s.problem, s.e, s.d.drift.normalized()));
  s.solution.advice = against_free_motion();
  return false;
}

/// To the next iterate. False: the search ends.
bool go_on(Search& s) {
  ++s.solution.iterations;
  ++s.problem.status.iterations;
  const double drift = s.d.drift.norm();
  if (drift > s.options.tolerance * s.e.load && drift >= 0.5 * s.size) {
    if (moves_together(s.problem, s.e, s.d.drift)) return says_nothing_holds_them(s);
    return touching(s.e) || s.passes_by ? follow_load(s) : go_to_touch(s);
  }
  // the next step is cut short, and not because springs close: balance is far along a motion that little resists
  const double predicted = surface_motion(s.problem, s.e, s.d.newton);
  s.beyond = predicted > s.cap && closing_motion(s.problem, s.e, s.d.newton) < 0.5 * predicted;
  const VectorXd step = corrected_step(s);
  if (shortened_step(s, step)) return true;
  if (step != s.d.newton) {  // what was learned misleads
    s.secant.missing = MatrixXd();
    if (shortened_step(s, s.d.newton, kWholeOnly)) return true;
  }
  if (regularised_step(s)) return true;
  s.patient.pay(s.problem.casts, s.beyond);
  if (s.patient.out() && !within_one_spring(s.e, s.size)) {
    s.solution.history.pop_back();  // the same iterate again, to be given up
    return true;
  }
  if (!to_one_spring(s.e, s.size, s.solution))
    say_unbalanced(s, ", and no step lowers it" +
                          (s.problem.undefined.empty() ? "" : "; steps were refused: " + s.problem.undefined));
  return false;
}

}  // namespace

Solution newton(Problem& problem, Evaluation e, const EquilibriumOptions& options) {
  const std::vector<Pose> started = e.poses;
  Patience patient{static_cast<double>(options.patience), static_cast<double>(options.patience)};
  patient.paid = problem.casts;
  Search s{problem, options, started, problem.beds.longest_step, std::move(e), patient};
  for (;;) {
    s.r = scaled_residual(problem, s.e);
    s.d = directions_at(s, s.r);
    s.passes_by = s.passes_by && s.d.falls;
    s.size = s.d.residual.norm();
    s.most_load = std::max(s.most_load, s.e.load);
    if (press_more_closely(s)) continue;
    if (s.r.size() <= kDenseUnknowns && !problem.joined()) update_secant(s);
    s.solution.history.push_back(s.e.load > 0 ? s.size / s.e.load : 0.0);
    problem.status.residual = s.solution.history.back();
    problem.tolerance = tolerance_after(s.solution.history.back());
    if (balanced(s)) {
      s.solution.directions = std::move(s.d);
      break;
    }
    if (gives_up(s) || !go_on(s)) {
      s.solution.directions = directions_at(s, scaled_residual(problem, s.e));
      break;
    }
  }
  s.solution.at = std::move(s.e);
  return std::move(s.solution);
}

}  // namespace dea

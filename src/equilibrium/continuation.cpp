// The whole search for one load case from one start.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "src/base/decompositions.h"
#include "src/base/numbers.h"
#include "src/equilibrium/approach.h"
#include "src/equilibrium/motion_in_words.h"
#include "src/equilibrium/newton.h"
#include "src/equilibrium/unknowns.h"
#include "src/springs/spring_law.h"

namespace dea {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

bool faces_target(const SpringStates& s, std::size_t k) { return s.triangle[k] >= 0 && s.coverage[k] > 0; }

/// The pushes of unit spring forces on the unknowns, as columns: of `facing` springs that face their target a sample
/// that is enough to span what all can do.
MatrixXd unit_pushes(const Problem& problem, const Evaluation& e, int facing, Index unknowns) {
  constexpr int kMostColumns = 2000;
  const int stride = (facing + kMostColumns - 1) / kMostColumns;
  MatrixXd push(unknowns, (facing + stride - 1) / stride);
  Index columns = 0;
  int seen = 0;
  for (std::size_t c = 0; c < e.springs.size(); ++c) {
    const SpringStates& s = e.springs[c];
    const SpringBed& bed = problem.beds.beds[c];
    for (int i = 0; i < s.size(); ++i) {
      if (!faces_target(s, at(i)) || seen++ % stride != 0) continue;
      const Vector12 w =
          unit_wrench(s.foot[at(i)], s.direction[at(i)], e.poses[at(bed.source_body)], e.poses[at(bed.target_body)]);
      VectorXd all = VectorXd::Zero(6 * static_cast<Index>(e.poses.size()));
      all.segment<6>(6 * bed.target_body) = w.head<6>();
      all.segment<6>(6 * bed.source_body) = w.tail<6>();
      push.col(columns++) = on_unknowns(problem, e, all);
    }
  }
  push.conservativeResize(unknowns, columns);
  return push;
}

/// Moves the forces of the active columns towards their least squares solution until all of them are >= 0 there; those
/// that come to nothing are active no more.
void solve_active_columns(const MatrixXd& push, const VectorXd& load, std::vector<Index>& active, VectorXd& force) {
  for (;;) {
    const VectorXd x = solve_least_norm(push(Eigen::all, active), -load);
    double part = 1.0;
    for (std::size_t k = 0; k < active.size(); ++k) {
      const double old = force[active[k]], now = x[static_cast<Index>(k)];
      if (now <= 0) part = std::min(part, old / std::max(old - now, 1e-300));
    }
    std::vector<Index> kept;
    for (std::size_t k = 0; k < active.size(); ++k) {
      double& f = force[active[k]];
      f += part * (x[static_cast<Index>(k)] - f);
      if (f > 1e-12 * load.norm())
        kept.push_back(active[k]);
      else
        f = 0.0;
    }
    const bool ends = part >= 1.0 || kept.size() == active.size() || kept.empty();
    active = std::move(kept);
    if (ends) return;
  }
}

/// What is left of the load under the forces >= 0 that balance it best: Lawson and Hanson (1974), chapter 23.
VectorXd left_at_best(const MatrixXd& push, const VectorXd& load) {
  std::vector<Index> active;
  VectorXd force = VectorXd::Zero(push.cols()), left = load;
  for (int i = 0; i < 20 + 4 * static_cast<int>(load.size()); ++i) {
    Index best = -1;
    const double most = -(push.transpose() * left).minCoeff(&best);
    if (!(most > 1e-9 * load.norm()) || std::find(active.begin(), active.end(), best) != active.end()) break;
    active.push_back(best);
    solve_active_columns(push, load, active, force);
    left = load + push * force;
  }
  return left;
}

int springs_that_face(const Evaluation& e) {
  int facing = 0;
  for (const SpringStates& s : e.springs)
    for (int i = 0; i < s.size(); ++i) facing += faces_target(s, at(i));
  return facing;
}

/// Whether pressures at this pose could balance the opposite load: the load's sign may be wrong then.
bool opposite_load_presses(const Problem& problem, const Evaluation& e) {
  if (problem.joined()) return false;  // the joints may take the load either way
  const int facing = springs_that_face(e);
  const VectorXd load = -on_unknowns(problem, e, e.ligaments + e.external - problem.offset);
  if (facing == 0 || !(load.norm() > 0)) return false;
  return left_at_best(unit_pushes(problem, e, facing, load.size()), load).norm() < 0.05 * load.norm();
}

/// Where pressures on the surfaces, however they were spread, could not balance the load at this pose: how much of the
/// load is left at best, and whether the motion that then follows opens the contact (E8).
struct Separation {
  double left = 0.0;     // of what is to be balanced
  double opening = 0.0;  // mean over the springs of the cosine between that motion and the spring's push
};

Separation separation(const Problem& problem, const Evaluation& e) {
  const int facing = springs_that_face(e);
  const VectorXd load = on_unknowns(problem, e, e.ligaments + e.external - problem.offset);
  if (facing == 0 || !(load.norm() > 0)) return {1.0, load.norm() > 0 ? 1.0 : 0.0};
  const MatrixXd push = unit_pushes(problem, e, facing, load.size());
  const VectorXd left = left_at_best(push, load);
  Separation result;
  result.left = left.norm() / load.norm();
  if (!(left.norm() > 0)) return result;
  for (Index k = 0; k < push.cols(); ++k)
    result.opening +=
        push.col(k).dot(left) / (push.col(k).norm() * left.norm() + 1e-300) / static_cast<double>(push.cols());
  return result;
}

/// Springs strained beyond the law's limit, or through.
int beyond_limit(const Evaluation& e) {
  int count = 0;
  for (const SpringStates& s : e.springs) {
    const SpringDepth depth = spring_depth(s);
    count += depth.strained + depth.through;
  }
  return count;
}

/// What no pressures can balance at a pose, if it opens the contact; nothing: they could.
std::optional<double> opens(const Problem& problem, const Evaluation& e) {
  const Separation apart = separation(problem, e);
  // far above what facets' normals are uncertain by
  return apart.left > 0.05 && apart.opening > 0.1 ? std::optional<double>(apart.left) : std::nullopt;
}

/// What is out of balance at `from` released piece by piece. Nothing: no way was found. `iterations`: counted on.
std::optional<Solution> release(Problem& problem, Evaluation from, const EquilibriumOptions& options, int& iterations) {
  const VectorXd all = from.residual();
  double done = 0.0, piece = 0.25;
  EquilibriumOptions pieces = options;
  pieces.patience = (options.patience + 1) / 2;
  int lost = 0;  // poses of pieces that failed: all together what one search may lose
  std::optional<Solution> found;
  while (!found && piece > 1.0 / 128 && lost < options.patience && problem.casts < options.max_casts) {
    const int before = problem.casts;
    const double next = std::min(1.0, done + piece);
    problem.offset = (1.0 - next) * all;
    Solution part = newton(problem, from, pieces);
    iterations += part.iterations;
    if (part.outcome == Outcome::Balanced || part.outcome == Outcome::BalancedToOneSpring) {
      done = next;
      if (done >= 1.0) {
        part.iterations = iterations;
        found = std::move(part);
      } else {
        from = std::move(part.at);
        piece *= 1.5;
      }
    } else {
      if (beyond_limit(part.at) > 0) break;  // more pieces would press through all the same
      lost += problem.casts - before;
      piece *= 0.5;
    }
  }
  problem.offset.setZero();
  return found;
}

/// Why a search failed, where more can be said than that it did.
void explain(const Problem& problem, const std::vector<Pose>& started, Solution& failed) {
  const double unbalanced = failed.history.empty() ? 1.0 : failed.history.back();
  if (const int beyond = beyond_limit(failed.at); beyond > 0) {
    failed.outcome = Outcome::BeyondStrainLimit;
    failed.advice = {};
    failed.counted = false;
    failed.message = fmt::format(
        "no balance: {:.3g}% of the load is not carried when {} springs are strained beyond {}: the layers are too "
        "thin or too soft for it",
        100.0 * unbalanced, beyond, kStrainLimit);
  } else if (const auto soft = soft_motion(problem, failed.at, scaled_residual(problem, failed.at))) {
    failed.outcome = Outcome::NoEquilibrium;
    failed.counted = false;
    failed.message = says_nothing_resists(problem, started, failed.at, *soft, unbalanced);
    failed.advice = against_free_motion();
  }
}

/// Newton's steps seek a balance that is unstable as well, as of a body on one of the two contacts that are to carry
/// it, and go against the load then. The same search along the load, with half of the patience: most have no balance.
std::optional<Solution> followed(Problem& problem, const std::vector<Pose>& poses, EquilibriumOptions options,
                                 int iterations) {
  options.patience = options.patience / 2;
  problem.downhill = true;
  Solution found = newton(problem, evaluate(problem, poses), options);
  problem.downhill = false;
  if (!solved(found.outcome)) return std::nullopt;
  found.iterations += iterations;
  return found;
}

Solution searched_from(Problem& problem, const std::vector<Pose>& start, const EquilibriumOptions& options) {
  problem.tolerance = tolerance_after(1.0);
  Evaluation e = evaluate(problem, start);
  if (too_deep_area(problem, e) > 0) {
    Evaluation out = e;
    if (back_out(problem, out)) e = std::move(out);
  }
  const std::vector<Pose> poses = e.poses;
  Solution direct = newton(problem, std::move(e), options);
  const bool no_equilibrium = direct.outcome == Outcome::NoEquilibrium;
  const char* sign = "(the opposite load would press them together: look at its sign)";
  if (direct.outcome == Outcome::SurfacesApart && direct.advice.empty()) {
    const Evaluation at_start = evaluate(problem, poses);
    if (springs_that_face(at_start) == 0)
      direct.advice =
          "(no spring finds the opposite surface from where the bodies start: do the surfaces lie beside each other, "
          "or "
          "look the same way?)";
    else if (opposite_load_presses(problem, at_start))
      direct.advice = sign;
  }
  if ((direct.outcome != Outcome::NotConverged && !no_equilibrium) || !direct.at.contact.allFinite()) return direct;
  Evaluation from =
      evaluate(problem, poses);  // a copy, kept for this rare case, would be as large as the springs' states
  if (const std::optional<double> at_start = opens(problem, from)) {
    if (const std::optional<double> at_end = opens(problem, direct.at)) {
      direct.outcome = Outcome::SurfacesApart;
      direct.counted = false;
      direct.advice = opposite_load_presses(problem, from) ? Sentence(sign) : Sentence();
      direct.message = fmt::format(
          "the load moves the surfaces apart: pressures on them, however spread, leave {:.3g}% of it unbalanced",
          100.0 * std::min(*at_start, *at_end));
      return direct;
    }
  }
  if (no_equilibrium && beyond_limit(direct.at) == 0) {
    std::optional<Solution> found = followed(problem, poses, options, direct.iterations);
    return found ? std::move(*found) : std::move(direct);
  }
  int iterations = direct.iterations;
  if (std::optional<Solution> released = release(problem, std::move(from), options, iterations))
    return std::move(*released);
  direct.iterations = iterations;
  explain(problem, poses, direct);
  return direct;
}

}  // namespace

Solution search_from(Problem& problem, const std::vector<Pose>& start, const EquilibriumOptions& options) {
  Solution found = searched_from(problem, start, options);
  if (found.counted)
    found.message += found.outcome == Outcome::Balanced
                         ? fmt::format(" in {} iterations", found.iterations)
                         : fmt::format("; {} iterations, {} poses tried", found.iterations, problem.casts);
  return found;
}

}  // namespace dea

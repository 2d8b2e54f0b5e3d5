#include "src/equilibrium/continuation.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "src/equilibrium/approach.h"
#include "src/equilibrium/motion_in_words.h"
#include "src/equilibrium/separation.h"
#include "src/equilibrium/unknowns.h"
#include "src/springs/spring_law.h"

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
    Approach out = back_out(problem, e);
    if (out.found) e = std::move(out.at);
  }
  const std::vector<Pose> poses = e.poses;
  Solution direct = newton(problem, std::move(e), options);
  const bool no_equilibrium = direct.outcome == Outcome::NoEquilibrium;
  const char* sign = "(the opposite load would press them together: look at its sign)";
  if (direct.outcome == Outcome::SurfacesApart && direct.advice.empty()) {
    const Evaluation at_start = evaluate(problem, poses);
    if (!any_faces(at_start))
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

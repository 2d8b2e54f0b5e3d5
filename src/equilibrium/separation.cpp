#include "src/equilibrium/separation.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "src/base/decompositions.h"
#include "src/base/numbers.h"
#include "src/equilibrium/unknowns.h"

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

}  // namespace

bool any_faces(const Evaluation& e) { return springs_that_face(e) > 0; }

bool opposite_load_presses(const Problem& problem, const Evaluation& e) {
  if (problem.joined()) return false;  // the joints may take the load either way
  const int facing = springs_that_face(e);
  const VectorXd load = -on_unknowns(problem, e, e.ligaments + e.external - problem.offset);
  if (facing == 0 || !(load.norm() > 0)) return false;
  return left_at_best(unit_pushes(problem, e, facing, load.size()), load).norm() < 0.05 * load.norm();
}

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

}  // namespace dea

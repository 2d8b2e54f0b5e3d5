#include "src/equilibrium/approach.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "src/base/numbers.h"
#include "src/equilibrium/unknowns.h"

namespace dea {

using Eigen::VectorXd;

namespace {

/// By a motion of the unknowns, to first order (E2): calls `look(springs, k, change)` with the change of the gap of
/// each spring k that faces something.
template <class Look>
void for_gap_changes(const Problem& problem, const Evaluation& e, const VectorXd& motion, const Look& look) {
  const VectorXd all = on_all_dofs(problem, e, motion);
  for (std::size_t c = 0; c < e.springs.size(); ++c) {
    const SpringStates& s = e.springs[c];
    const SpringBed& bed = problem.beds.beds[c];
    const Pose &source = e.poses[at(bed.source_body)], &target = e.poses[at(bed.target_body)];
    const Vector3d v_t = all.segment<3>(6 * bed.target_body), w_t = all.segment<3>(6 * bed.target_body + 3);
    const Vector3d v_s = all.segment<3>(6 * bed.source_body), w_s = all.segment<3>(6 * bed.source_body + 3);
    for (std::size_t k = 0; k < s.gap.size(); ++k) {
      if (s.triangle[k] < 0) continue;
      const Vector3d relative = v_t + w_t.cross(s.end[k] - target.center) - v_s - w_s.cross(s.end[k] - source.center);
      look(s, k, s.normal[k].dot(relative) / s.normal[k].dot(s.direction[k]));
    }
  }
}

/// How far along `direction` (a motion of the unknowns) the first spring closes, to first order: infinity if none does.
double first_touch(const Problem& problem, const Evaluation& e, const VectorXd& direction) {
  double first = kInfinity;
  for_gap_changes(problem, e, direction, [&](const SpringStates& s, std::size_t k, double change) {
    if (s.coverage[k] > 0 && change < 0) first = std::min(first, std::max(0.0, s.gap[k]) / -change);
  });
  return first;
}

}  // namespace

double lost_force(const Evaluation& before, const Evaluation& after) {
  double lost = 0.0;
  for (std::size_t c = 0; c < before.springs.size(); ++c) {
    const SpringStates &a = before.springs[c], &b = after.springs[c];
    for (int i = 0; i < a.size(); ++i) {
      const auto k = at(i);
      if (a.pressure[k] > 0 && (b.triangle[k] < 0 || b.too_deep[k])) lost += a.force(k);
    }
  }
  return lost;
}

bool touching(const Evaluation& e) { return e.normal_force > 0.0; }

double too_deep_area(const Problem& problem, const Evaluation& e) {
  double area = 0.0;
  for (std::size_t c = 0; c < e.springs.size(); ++c)
    for (int i = 0; i < e.springs[c].size(); ++i)
      if (e.springs[c].too_deep[at(i)]) area += problem.beds.beds[c].springs.area[at(i)];
  return area;
}

double closing_motion(const Problem& problem, const Evaluation& e, const VectorXd& motion) {
  double largest = 0.0;
  for_gap_changes(problem, e, motion, [&](const SpringStates& s, std::size_t k, double change) {
    if (s.pressure[k] > 0) largest = std::max(largest, std::abs(change));
  });
  return largest;
}

bool advance(Problem& problem, Evaluation& e, VectorXd direction) {
  const double unit = surface_motion(problem, e, direction);
  if (unit <= 0) return false;
  direction /= unit;
  const double cap = problem.beds.longest_step;
  for (int i = 0; i < 20 && !touching(e); ++i) {
    const double gap = first_touch(problem, e, direction);
    if (!std::isfinite(gap)) return false;
    auto poses = poses_after(problem, e, (gap + 1e-3 * cap) * direction);
    if (!poses) break;
    const VectorXd all = on_all_dofs(problem, e, direction);
    e = evaluate(problem, std::move(*poses));
    direction = motion_at_new_pose(problem, e, all);
    if (too_deep_area(problem, e) > 0) break;
  }
  if (!touching(e)) return false;
  // The contact's force grows about like the square of the depth: a few steps bring it near the load.
  const double driving = direction.dot(scaled_residual(problem, e));
  double depth = 1e-3 * cap;
  for (int i = 0; i < 12; ++i) {
    const VectorXd contact = on_unknowns(problem, e, e.contact);
    const double resisting = -direction.dot(contact);
    const double left = direction.dot(scaled_residual(problem, e));
    if (left <= 0.3 * (left + resisting) || driving <= 0) break;
    const double ratio = resisting > 0 ? (left + resisting) / resisting : 1e4;
    const double step = std::min(cap, depth * (std::sqrt(ratio) - 1.0));
    auto poses = poses_after(problem, e, step * direction);
    if (!poses) break;
    const VectorXd all = on_all_dofs(problem, e, direction);
    Evaluation next = evaluate(problem, std::move(*poses));
    if (lost_force(e, next) > 0.5 * e.normal_force || too_deep_area(problem, next) > 0) break;
    e = std::move(next);
    direction = motion_at_new_pose(problem, e, all);
    depth += step;
  }
  return true;
}

bool back_out(Problem& problem, Evaluation& e) {
  for (int i = 0; i < 40 && too_deep_area(problem, e) > 0; ++i) {
    VectorXd push = VectorXd::Zero(6 * static_cast<Eigen::Index>(e.poses.size()));
    double depth = 0.0;
    for (std::size_t c = 0; c < e.springs.size(); ++c) {
      const SpringStates& s = e.springs[c];
      const SpringBed& bed = problem.beds.beds[c];
      for (int k = 0; k < s.size(); ++k) {
        if (!s.too_deep[at(k)]) continue;
        const Vector12 w = unit_wrench(s.foot[at(k)], bed.springs.area[at(k)] * s.direction[at(k)],
                                       e.poses[at(bed.source_body)], e.poses[at(bed.target_body)]);
        push.segment<6>(6 * bed.target_body) += w.head<6>();
        push.segment<6>(6 * bed.source_body) += w.tail<6>();
        depth = std::max(depth, -s.gap[at(k)]);
      }
    }
    const VectorXd direction = on_unknowns(problem, e, push);
    const double unit = surface_motion(problem, e, direction);
    if (unit <= 0) break;
    auto poses = poses_after(problem, e, (0.5 * depth / unit) * direction);
    if (!poses) break;
    e = evaluate(problem, std::move(*poses));
  }
  return too_deep_area(problem, e) == 0;
}

}  // namespace dea

#include <febiodea/equilibrium/separation.h>

#include <Eigen/Dense>
#include <algorithm>
#include <utility>
#include <vector>

#include <febiodea/base/numbers.h>
#include <febiodea/equilibrium/unknowns.h>

namespace dea {

using Eigen::MatrixXd;
using Eigen::VectorXd;

Separation separation(const Problem& problem, const Evaluation& e) {
  // the pushes of unit spring forces on the unknowns, as columns
  constexpr int kMostColumns = 2000;  // a sample is enough to span what all can do
  int facing = 0;
  for (const SpringStates& s : e.springs)
    for (int i = 0; i < s.size(); ++i) facing += s.triangle[at(i)] >= 0 && s.coverage[at(i)] > 0;
  const VectorXd load = on_unknowns(problem, e, e.ligaments + e.external - problem.offset);
  if (facing == 0 || !(load.norm() > 0)) return {1.0, load.norm() > 0 ? 1.0 : 0.0};
  const int stride = (facing + kMostColumns - 1) / kMostColumns;
  MatrixXd push(load.size(), (facing + stride - 1) / stride);
  Eigen::Index columns = 0;
  int seen = 0;
  for (std::size_t c = 0; c < e.springs.size(); ++c) {
    const SpringStates& s = e.springs[c];
    const SpringBed& bed = problem.beds.beds[c];
    for (int i = 0; i < s.size(); ++i) {
      if (s.triangle[at(i)] < 0 || s.coverage[at(i)] <= 0 || seen++ % stride != 0) continue;
      const Vector3d n = s.direction[at(i)];
      VectorXd all = VectorXd::Zero(6 * static_cast<Eigen::Index>(e.poses.size()));
      all.segment<3>(6 * bed.target_body) = n;
      all.segment<3>(6 * bed.target_body + 3) = (s.foot[at(i)] - e.poses[at(bed.target_body)].center).cross(n);
      all.segment<3>(6 * bed.source_body) = -n;
      all.segment<3>(6 * bed.source_body + 3) = -(s.foot[at(i)] - e.poses[at(bed.source_body)].center).cross(n);
      push.col(columns++) = on_unknowns(problem, e, all);
    }
  }
  push.conservativeResize(load.size(), columns);
  // Least squares with forces >= 0: Lawson and Hanson (1974), chapter 23
  std::vector<Eigen::Index> active;
  VectorXd force = VectorXd::Zero(columns), left = load;
  for (int i = 0; i < 20 + 4 * static_cast<int>(load.size()); ++i) {
    Eigen::Index best = -1;
    const double most = -(push.transpose() * left).minCoeff(&best);
    if (!(most > 1e-9 * load.norm()) || std::find(active.begin(), active.end(), best) != active.end()) break;
    active.push_back(best);
    for (;;) {
      MatrixXd A(load.size(), static_cast<Eigen::Index>(active.size()));
      for (std::size_t k = 0; k < active.size(); ++k) A.col(static_cast<Eigen::Index>(k)) = push.col(active[k]);
      const VectorXd x = A.completeOrthogonalDecomposition().solve(-load);
      double part = 1.0;
      for (std::size_t k = 0; k < active.size(); ++k) {
        const double old = force[active[k]], now = x[static_cast<Eigen::Index>(k)];
        if (now <= 0) part = std::min(part, old / std::max(old - now, 1e-300));
      }
      std::vector<Eigen::Index> kept;
      for (std::size_t k = 0; k < active.size(); ++k) {
        double& f = force[active[k]];
        f += part * (x[static_cast<Eigen::Index>(k)] - f);
        if (f > 1e-12 * load.norm())
          kept.push_back(active[k]);
        else
          f = 0.0;
      }
      if (part >= 1.0 || kept.size() == active.size() || kept.empty()) {
        active = std::move(kept);
        break;
      }
      active = std::move(kept);
    }
    left = load + push * force;
  }
  Separation result;
  result.left = left.norm() / load.norm();
  if (!(left.norm() > 0)) return result;
  for (Eigen::Index k = 0; k < columns; ++k)
    result.opening +=
        push.col(k).dot(left) / (push.col(k).norm() * left.norm() + 1e-300) / static_cast<double>(columns);
  return result;
}

}  // namespace dea

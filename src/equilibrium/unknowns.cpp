#include "src/equilibrium/unknowns.h"

#include <utility>

#include "src/base/numbers.h"

namespace dea {

using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

VectorXd as_free(const Problem& problem, const Evaluation& e, const VectorXd& motion) {
  return problem.joined() ? VectorXd(e.tangent.basis * motion) : motion;
}

VectorXd on_all_dofs(const Problem& problem, const Evaluation& e, const VectorXd& motion) {
  VectorXd all = VectorXd::Zero(6 * static_cast<Eigen::Index>(problem.joint.bodies.size()));
  all(problem.free) = as_free(problem, e, motion).cwiseQuotient(problem.scale);
  return all;
}

VectorXd on_unknowns(const Problem& problem, const Evaluation& e, const VectorXd& all) {
  const VectorXd r = free_part(problem, all);
  return problem.joined() ? VectorXd(e.tangent.basis.transpose() * r) : r;
}

VectorXd scaled_residual(const Problem& problem, const Evaluation& e) {
  return on_unknowns(problem, e, e.residual() - problem.offset);
}

Sparse scaled_stiffness(const Problem& problem, const Evaluation& e) {
  const auto n = static_cast<Eigen::Index>(problem.free.size());
  std::vector<int> place(6 * problem.joint.bodies.size(), -1);
  for (std::size_t i = 0; i < problem.free.size(); ++i) place[at(problem.free[i])] = static_cast<int>(i);
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(36 * e.derivative.blocks.size());
  for (const BlockMatrix::Block& block : e.derivative.blocks) {
    for (int i = 0; i < 6; ++i) {
      const int row = place[at(6 * block.row + i)];
      if (row < 0) continue;
      for (int j = 0; j < 6; ++j) {
        const int column = place[at(6 * block.column + j)];
        if (column >= 0)
          entries.emplace_back(row, column, -block.value(i, j) / (problem.scale[row] * problem.scale[column]));
      }
    }
  }
  Sparse K(n, n);
  K.setFromTriplets(entries.begin(), entries.end());
  if (problem.joined()) K = Sparse(e.tangent.basis.transpose() * K * e.tangent.basis);
  return K;
}

std::optional<std::vector<Pose>> poses_after(Problem& problem, const Evaluation& e, const VectorXd& motion) {
  std::vector<Pose> result = e.poses;
  move_bodies(result, on_all_dofs(problem, e, motion));
  for (const Pose& pose : result)
    if (!pose.center.allFinite() || !pose.rotation.allFinite()) return std::nullopt;
  if (problem.joined() && !close_connectors(problem.joint, problem.load_case, problem.connectors, result))
    return std::nullopt;
  if (std::string fault = undefined_force(problem.joint, problem.load_case, result); !fault.empty()) {
    problem.undefined = std::move(fault);
    return std::nullopt;
  }
  return result;
}

double surface_motion(const Problem& problem, const Evaluation& e, const VectorXd& motion) {
  const VectorXd all = on_all_dofs(problem, e, motion);
  double largest = 0.0;
  const auto reach = [&](const Vector3d& v, const Vector3d& w) {
    const double reached = v.norm() + w.norm() * problem.beds.reach;
    if (!(reached <= largest)) largest = reached;  // NaN stays
  };
  std::vector<char> in_contact(problem.joint.bodies.size(), 0);
  for (std::size_t c = 0; c < problem.beds.beds.size(); ++c) {
    if (!problem.load_case.contact_active[c]) continue;
    // one body as the other sees it: rows of bones may move together
    int a = problem.beds.beds[c].source_body, b = problem.beds.beds[c].target_body;
    in_contact[at(a)] = in_contact[at(b)] = 1;
    if (all.segment<6>(6 * a).isZero(0.0)) std::swap(a, b);
    const Vector3d w_b = all.segment<3>(6 * b + 3), v_a = all.segment<3>(6 * a), w_a = all.segment<3>(6 * a + 3);
    const Vector3d v_b = all.segment<3>(6 * b) + w_b.cross(e.poses[at(a)].center - e.poses[at(b)].center);
    reach(v_a - v_b, w_a - w_b);
  }
  for (std::size_t b = 0; b < in_contact.size(); ++b)
    if (!in_contact[b])
      reach(all.segment<3>(6 * static_cast<Eigen::Index>(b)), all.segment<3>(6 * static_cast<Eigen::Index>(b) + 3));
  return largest;
}

bool moves_together(const Problem& problem, const Evaluation& e, const VectorXd& motion) {
  const VectorXd all = on_all_dofs(problem, e, motion);
  double farthest = 0.0;
  for (Eigen::Index b = 0; b < all.size(); b += 6)
    farthest = std::max(farthest, all.segment<3>(b).norm() + all.segment<3>(b + 3).norm() * problem.beds.reach);
  return !(surface_motion(problem, e, motion) > 1e-6 * farthest);
}

VectorXd motion_at_new_pose(const Problem& problem, const Evaluation& e, const VectorXd& all) {
  const VectorXd free = all(problem.free).cwiseProduct(problem.scale);
  return problem.joined() ? VectorXd(e.tangent.basis.transpose() * free) : free;
}

}  // namespace dea

#include <febiodea/equilibrium/forces.h>

#include <algorithm>
#include <cmath>

#include <febiodea/base/numbers.h>
#include <febiodea/springs/press.h>
#include <febiodea/springs/wrench.h>

namespace dea {

using Eigen::VectorXd;

namespace {

constexpr double kRateTolerance = 1e-4;  // the derivative only directs the next step

}  // namespace

Problem make_problem(const Joint& joint, const SpringBeds& beds, const LoadCase& load_case,
                     std::vector<PressMemory>& memory) {
  memory.resize(beds.beds.size());
  Problem problem{joint, beds, load_case, {}, {}, {}, memory, 0, kPressureTolerance, {}, {}, {}, nullptr};
  problem.offset = VectorXd::Zero(6 * static_cast<Eigen::Index>(joint.bodies.size()));
  return problem;
}

VectorXd free_part(const Problem& problem, const VectorXd& all) {
  VectorXd r(static_cast<Eigen::Index>(problem.free.size()));
  for (std::size_t i = 0; i < problem.free.size(); ++i)
    r[static_cast<Eigen::Index>(i)] = all[problem.free[i]] / problem.scale[static_cast<Eigen::Index>(i)];
  return r;
}

namespace {

/// The relative motions of a contact's bodies that the unknowns can bring about.
Motions free_motions(const Problem& problem, const SpringBed& bed) {
  if (problem.joined()) return kAllMotions;
  Motions motions = {};
  for (const int dof : problem.free) {
    const int body = dof / 6, k = dof % 6;
    if (body != bed.source_body && body != bed.target_body) continue;
    motions[at(k)] = true;
    // the source turns about its own centre, not the target's
    if (body == bed.source_body && k >= 3) motions[0] = motions[1] = motions[2] = true;
  }
  return motions;
}

}  // namespace

Evaluation evaluate(Problem& problem, std::vector<Pose> poses) {
  const Joint& joint = problem.joint;
  const LoadCase& load_case = problem.load_case;
  const auto n = 6 * static_cast<Eigen::Index>(joint.bodies.size());
  Evaluation e;
  e.poses = std::move(poses);
  e.contact = e.reactions = VectorXd::Zero(n);
  problem.status.casts = ++problem.casts;
  if (problem.watch != nullptr && *problem.watch) (*problem.watch)(problem.status);
  for (std::size_t i = 0; i < problem.beds.beds.size(); ++i) {
    const SpringBed& bed = problem.beds.beds[i];
    if (!load_case.contact_active[i]) {
      e.springs.emplace_back();
      e.contact_on_target.push_back(Vector6::Zero());
      continue;
    }
    const Pose &source = e.poses[at(bed.source_body)], &target = e.poses[at(bed.target_body)];
    e.springs.push_back(press_springs(
        bed, source, target, {free_motions(problem, bed), problem.tolerance, kRateTolerance}, &problem.memory[i]));
    if (bed.layers) e.tolerance = problem.tolerance;
    const ContactWrench w = contact_wrench(e.springs.back(), source, target);
    e.contact.segment<6>(6 * bed.target_body) += w.wrench.head<6>();
    e.contact.segment<6>(6 * bed.source_body) += w.wrench.tail<6>();
    e.derivative.add(bed.target_body, bed.source_body, w.derivative);
    e.contact_on_target.push_back(w.wrench.head<6>());
    e.normal_force += w.normal_force;
  }
  e.load = e.normal_force;
  BodyForces inner(joint.bodies.size());
  e.ligament_force.assign(joint.ligaments.size(), 0.0);
  for (std::size_t i = 0; i < joint.ligaments.size(); ++i) {
    if (!load_case.ligament_active[i]) continue;
    const double scale = i < load_case.ligament_scale.size() ? load_case.ligament_scale[i] : 1.0;
    e.ligament_force[i] = add_ligament(joint, joint.ligaments[i], scale, e.poses, inner);
    e.load = std::max(e.load, std::abs(e.ligament_force[i]));
  }
  for (std::size_t i = 0; i < load_case.cable_force.size(); ++i) {
    if (load_case.cable_force[i] == 0.0) continue;
    add_cable(joint, joint.cables[i], load_case.cable_force[i], e.poses, inner);
    e.load = std::max(e.load, std::abs(load_case.cable_force[i]));
  }
  if (!load_case.connector_active.empty())
    e.load = std::max(e.load, add_connector_loads(joint, load_case, problem.beds.length, e.poses, inner));
  e.ligaments = inner.value;
  BodyForces outer(joint.bodies.size());
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const BodyConditions& c = load_case.bodies[b];
    const double scale = add_loads(c, static_cast<int>(b), e.poses[b], problem.beds.length, outer);
    // what pulls at a held body is no measure of the balance of the others
    if (std::count(c.dofs.begin(), c.dofs.end(), DofState::Free) > 0) e.load = std::max(e.load, scale);
  }
  e.external = outer.value;
  auto& blocks = e.derivative.blocks;
  blocks.insert(blocks.end(), inner.derivative.blocks.begin(), inner.derivative.blocks.end());
  blocks.insert(blocks.end(), outer.derivative.blocks.begin(), outer.derivative.blocks.end());
  if (problem.joined()) {
    e.rows = connector_rows(joint, load_case, e.poses);
    e.tangent = tangent_of(problem.connectors, e.rows,
                           free_part(problem, e.contact + e.ligaments + e.external - problem.offset));
    BodyForces held(joint.bodies.size());
    add_reactions(joint, e.rows, e.tangent.multipliers, e.poses, held);
    e.reactions = held.value;
    blocks.insert(blocks.end(), held.derivative.blocks.begin(), held.derivative.blocks.end());
  }
  return e;
}

double tolerance_after(double residual) {
  constexpr double kCoarsest = 1e-4;
  return std::clamp(0.01 * residual * std::min(1.0, 10.0 * residual), kPressureTolerance, kCoarsest);
}

// The unknowns at a pose: the free dofs, rotations times length; where there are connectors, the motions they leave.

}  // namespace dea

#include "src/equilibrium/forces.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "src/base/numbers.h"
#include "src/base/parallel.h"

namespace dea {

using Eigen::VectorXd;

namespace {

/// The derivative directs the next step: a share eta of it that is wrong leaves eta of the residual, so far from
/// balance it need not be known closely (Dembo, Eisenstat and Steihaug 1982, SIAM J Numer Anal 19:400). `tolerance`: of
/// the pressures, which falls as balance comes near (tolerance_after). Started from the rates at the last pose, the
/// stiffness is wrong by the square of it, but for what bulges at rims add (solve_active): near balance that is small
/// enough for motions that little resists, about a centre of mass far from the joint, and for telling whether balance
/// is stable.
double rate_tolerance(double tolerance) {
  constexpr double kFinest = 1e-2, kCoarsest = 3e-2;
  return std::clamp(std::sqrt(tolerance), kFinest, kCoarsest);
}

}  // namespace

Problem make_problem(const Joint& joint, const SpringBeds& beds, const LoadCase& load_case,
                     std::vector<PressMemory>& memory) {
  memory.resize(beds.groups.size());
  Problem problem{joint, beds, load_case, {}, {}, {}, memory, 0, kPressureTolerance, false, {}, {}, {}, nullptr};
  problem.offset = VectorXd::Zero(6 * static_cast<Eigen::Index>(joint.bodies.size()));
  return problem;
}

VectorXd free_part(const Problem& problem, const VectorXd& all) {
  return all(problem.free).cwiseQuotient(problem.scale);
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

double ligament_scale(const LoadCase& load_case, int ligament) {
  return at(ligament) < load_case.ligament_scale.size() ? load_case.ligament_scale[at(ligament)] : 1.0;
}

void add_contact_derivative(const SpringBed& bed, const ContactWrench& of, Evaluation& e) {
  e.derivative.add(bed.target_body, bed.source_body, of.derivative);
  for (const ContactWrench::Cross& other : of.cross)
    e.derivative.add(bed.target_body, bed.source_body, other.bodies.target, other.bodies.source, other.derivative);
}

/// Springs of the active contacts, and what they do to their bodies.
void press_contacts(Problem& problem, Evaluation& e) {
  const std::vector<SpringBed>& beds = problem.beds.beds;
  const std::vector<char>& active = problem.load_case.contact_active;
  e.springs.resize(beds.size());
  e.ties.resize(problem.beds.ties.size());
  e.contact_on_target.assign(beds.size(), Vector6::Zero());
  std::vector<Motions> motions;
  for (const SpringBed& bed : beds) motions.push_back(free_motions(problem, bed));
  const PressOptions options = {kAllMotions, problem.tolerance, rate_tolerance(problem.tolerance), problem.stop};
  std::vector<ContactWrench> wrenches(beds.size());
  const TieLaw law = tie_law(problem.joint, problem.load_case);
  std::vector<std::vector<PressedContact>> of_group(problem.beds.groups.size());
  parallel_for(of_group.size(), [&](std::size_t g) {
    const std::vector<int>& group = problem.beds.groups[g];
    if (std::any_of(group.begin(), group.end(), [&](int c) { return active[at(c)] != 0; }))
      of_group[g] = press_group(problem.beds, group, e.poses, motions, active, options, &problem.memory[g], law);
  });
  for (std::size_t g = 0; g < problem.beds.groups.size(); ++g) {
    const std::vector<int>& group = problem.beds.groups[g];
    std::vector<PressedContact>& pressed = of_group[g];
    if (pressed.empty()) continue;
    for (std::size_t k = 0; k < problem.beds.group_ties[g].size(); ++k) {
      const int t = problem.beds.group_ties[g][k];
      const SpringBed& tie = problem.beds.ties[at(t)];
      PressedContact& of = pressed[group.size() + k];
      add_contact_derivative(tie, of.wrench, e);
      e.ties[at(t)] = std::move(of.springs);
    }
    for (std::size_t k = 0; k < group.size(); ++k) {
      e.springs[at(group[k])] = std::move(pressed[k].springs);
      wrenches[at(group[k])] = std::move(pressed[k].wrench);
    }
  }
  for (std::size_t c = 0; c < beds.size(); ++c) {
    if (!active[c]) continue;
    const SpringBed& bed = beds[c];
    const ContactWrench& w = wrenches[c];
    if (bed.layers) e.tolerance = problem.tolerance;
    e.contact.segment<6>(6 * bed.target_body) += w.wrench.head<6>();
    e.contact.segment<6>(6 * bed.source_body) += w.wrench.tail<6>();
    add_contact_derivative(bed, w, e);
    e.contact_on_target[c] = w.wrench.head<6>();
    e.normal_force += w.normal_force;
  }
  e.load = e.normal_force;
}

/// Ligaments, cables, and the loads along the connectors' free motions.
void pull_ligaments(const Problem& problem, Evaluation& e, BodyForces& forces) {
  const Joint& joint = problem.joint;
  const LoadCase& load_case = problem.load_case;
  e.ligament_force.assign(joint.ligaments.size(), 0.0);
  std::vector<char> pulled(joint.ligaments.size(), 0);
  for (std::size_t t = 0; t < e.ties.size(); ++t) {
    const SpringBed& bed = problem.beds.ties[t];
    for (int i = 0; i < e.ties[t].size(); ++i) {
      const SpringStates& s = e.ties[t];
      const Vector3d arm_source = s.foot[at(i)] - e.poses[at(bed.source_body)].center,
                     arm_target = s.end[at(i)] - e.poses[at(bed.target_body)].center;
      if (bed.holds()) {
        const int turns = bed.layers->source.part ? bed.source_body : bed.target_body;
        add_turning_force(bed.source_body, arm_source, bed.target_body, arm_target,
                          -s.pressure[at(i)] * s.area[at(i)] * s.direction[at(i)], turns, forces);
        continue;
      }
      const auto ligament = at(bed.ties[at(i)].ligament);
      pulled[ligament] = 1;
      e.ligament_force[ligament] = s.pressure[at(i)] * s.area[at(i)];
      // the slope is in tie_rates, in series with what gives way
      add_line(bed.source_body, arm_source, bed.target_body, arm_target, {e.ligament_force[ligament], 0.0}, e.poses,
               forces);
    }
  }
  for (std::size_t i = 0; i < joint.ligaments.size(); ++i) {
    if (!load_case.ligament_active[i]) continue;
    if (!pulled[i])
      e.ligament_force[i] =
          add_ligament(joint, joint.ligaments[i], ligament_scale(load_case, static_cast<int>(i)), e.poses, forces);
    e.load = std::max(e.load, std::abs(e.ligament_force[i]));
  }
  for (std::size_t i = 0; i < load_case.cable_force.size(); ++i) {
    if (load_case.cable_force[i] == 0.0) continue;
    add_cable(joint, joint.cables[i], load_case.cable_force[i], e.poses, forces);
    e.load = std::max(e.load, std::abs(load_case.cable_force[i]));
  }
  if (!load_case.connector_active.empty())
    e.load = std::max(e.load, add_connector_loads(joint, load_case, problem.beds.length, e.poses, forces));
}

void add_external(const Problem& problem, Evaluation& e, BodyForces& forces) {
  for (std::size_t b = 0; b < problem.joint.bodies.size(); ++b) {
    const BodyConditions& c = problem.load_case.bodies[b];
    const double scale = add_loads(c, static_cast<int>(b), e.poses[b], problem.beds.length, forces);
    // what pulls at a held body is no measure of the balance of the others
    if (std::count(c.dofs.begin(), c.dofs.end(), DofState::Free) > 0) e.load = std::max(e.load, scale);
  }
}

}  // namespace

TieLaw tie_law(const Joint& joint, const LoadCase& load_case) {
  return [&](int ligament, double length) -> std::optional<Tension> {
    if (!load_case.ligament_active[at(ligament)]) return std::nullopt;
    return tension(joint.ligaments[at(ligament)], length, ligament_scale(load_case, ligament));
  };
}

Evaluation evaluate(Problem& problem, std::vector<Pose> poses) {
  const Joint& joint = problem.joint;
  const auto n = 6 * static_cast<Eigen::Index>(joint.bodies.size());
  Evaluation e;
  e.poses = std::move(poses);
  e.contact = e.reactions = VectorXd::Zero(n);
  end_if_stopped(problem.stop);
  problem.status.casts = ++problem.casts;
  if (problem.watch != nullptr && *problem.watch) (*problem.watch)(problem.status);
  press_contacts(problem, e);
  const auto add_derivative = [&](const BodyForces& of) {
    e.derivative.blocks.insert(e.derivative.blocks.end(), of.derivative.blocks.begin(), of.derivative.blocks.end());
  };
  BodyForces inner(joint.bodies.size()), outer(joint.bodies.size());
  pull_ligaments(problem, e, inner);
  e.ligaments = inner.value;
  add_external(problem, e, outer);
  e.external = outer.value;
  add_derivative(inner);
  add_derivative(outer);
  if (problem.joined()) {
    e.rows = connector_rows(joint, problem.load_case, e.poses);
    e.tangent = tangent_of(problem.connectors, e.rows,
                           free_part(problem, e.contact + e.ligaments + e.external - problem.offset));
    BodyForces held(joint.bodies.size());
    add_reactions(joint, e.rows, e.tangent.multipliers, e.poses, held);
    e.reactions = held.value;
    add_derivative(held);
    BodyForces holds(joint.bodies.size());
    add_hold_reactions(joint, e.rows, e.tangent.multipliers, holds);
    e.external += holds.value;
    add_derivative(holds);
  }
  return e;
}

double tolerance_after(double residual) {
  constexpr double kCoarsest = 1e-3;
  constexpr double kMostFall = 0.003;  // of the residual in a step
  return std::clamp(0.02 * residual * std::clamp(residual, kMostFall, 1.0), kPressureTolerance, kCoarsest);
}

}  // namespace dea

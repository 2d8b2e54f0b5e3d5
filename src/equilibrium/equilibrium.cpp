#include "src/equilibrium/equilibrium.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/equilibrium/approach.h"
#include "src/equilibrium/motion_in_words.h"
#include "src/equilibrium/newton.h"
#include "src/equilibrium/unknowns.h"
#include "src/springs/spring_law.h"

namespace dea {

using Eigen::VectorXd;

namespace {

/// A law stretched beyond where it means anything, and pressures not known well enough, are no answer, however well all
/// balances.
void judge_springs(Equilibrium& result) {
  int beyond = 0;
  double largest = 0.0;
  for (const SpringStates& s : result.springs) {
    const SpringDepth depth = spring_depth(s);  // a spring that is through has no strain
    beyond += depth.strained + depth.through;
    largest = std::max({largest, depth.largest, depth.through > 0 ? 1.0 : 0.0});
  }
  for (const SpringStates& s : result.springs) {
    if (s.complementary || !solved(result.outcome)) continue;
    result.outcome = Outcome::NotConverged;
    const bool parts = s.part_motion[0].size() > 0 || s.part_motion[1].size() > 0;
    result.message =
        parts ? fmt::format("parts do not settle: the pressures on them still change by {:.1e}", s.complementarity)
              : fmt::format("the layers' pressures are known to {:.1e} only", s.complementarity);
  }
  if (beyond > 0 && solved(result.outcome)) {
    result.outcome = Outcome::BeyondStrainLimit;
    result.message =
        fmt::format("{} springs are strained beyond {} (largest {}{:.3g}): the surfaces pass too far into each other",
                    beyond, kStrainLimit, largest >= 1 ? "at least " : "", largest);
  }
}

/// Places of a layer that two partners press at once are counted twice.
void judge_shared_layers(const Problem& problem, Equilibrium& result) {
  if (!solved(result.outcome)) return;
  const PressedTwice twice = pressed_twice(problem.joint, problem.beds, result.springs, result.poses);
  if (!(twice.share > kMostTwice)) return;
  std::vector<std::string> names;
  for (const int c : twice.contacts) names.push_back(in_quotes(problem.joint.contacts[at(c)].name));
  result.outcome = Outcome::PressedTwice;
  result.message = fmt::format(
      "contacts {} press {:.3g} of one layer at once, with {:.3g}, {:.0f}% of the force on it: their partners run "
      "through each other there, or are the same, and the load counts twice;",
      and_list(names), twice.area, twice.force, 100 * twice.share);
  result.advice = "keep the partners apart, or give each contact facets of its own";
}

/// All that is known at the poses where a search ended.
Equilibrium to_equilibrium(const Problem& problem, Evaluation e, SearchEnd end) {
  Equilibrium result;
  static_cast<SearchEnd&>(result) = std::move(end);
  const VectorXd total = e.residual();
  double force2 = 0.0, moment2 = 0.0;
  bool any_force = false, any_moment = false;
  for (int dof : problem.free) {
    (dof % 6 < 3 ? any_force : any_moment) = true;
    (dof % 6 < 3 ? force2 : moment2) += total[dof] * total[dof];
  }
  result.residual_force = any_force ? std::sqrt(force2) : kNaN;
  result.residual_moment = any_moment ? std::sqrt(moment2) : kNaN;
  for (std::size_t b = 0; b < e.poses.size(); ++b)
    result.reaction.push_back(-(e.contact + e.ligaments + e.reactions).segment<6>(6 * static_cast<Eigen::Index>(b)));
  result.cable_force = problem.load_case.cable_force;
  if (!problem.load_case.connector_active.empty()) {
    if (problem.joined())
      result.connector_force =
          connector_forces(problem.joint, problem.load_case, e.rows, e.tangent.multipliers, e.poses);
    else  // nothing has been solved, or nothing can move
      result.connector_force.assign(problem.joint.connectors.size(), Vector6::Constant(kNaN));
    for (const Connector& c : problem.joint.connectors)
      result.connector_motion.push_back(connector_motion(problem.joint, c, e.poses));
  }
  static_cast<PosedSprings&>(result) = std::move(e);
  result.casts = problem.casts;
  judge_springs(result);
  judge_shared_layers(problem, result);
  return result;
}

void find_unknowns(Problem& problem) {
  for (int b = 0; b < static_cast<int>(problem.joint.bodies.size()); ++b)
    for (int k = 0; k < kDofs; ++k)
      if (problem.load_case.bodies[at(b)].dofs[at(k)] == DofState::Free) problem.free.push_back(6 * b + k);
  problem.scale.resize(static_cast<Eigen::Index>(problem.free.size()));
  for (std::size_t i = 0; i < problem.free.size(); ++i)
    problem.scale[static_cast<Eigen::Index>(i)] = problem.free[i] % 6 < 3 ? 1.0 : problem.beds.length;
}

/// Poses at which all connectors hold, as near as can be. What stands against it; empty: nothing.
std::string close_all_connectors(Problem& problem, const std::vector<Pose>& start, std::vector<Pose>& poses) {
  const Joint& joint = problem.joint;
  const std::vector<BodyConditions>& bodies = problem.load_case.bodies;
  const bool held = std::any_of(bodies.begin(), bodies.end(), [](const auto& b) { return !b.held_points.empty(); });
  if ((joint.connectors.empty() && !held) || problem.load_case.connector_active.size() != joint.connectors.size())
    return "";
  const double size = problem.beds.length + problem.beds.reach;
  problem.connectors = make_groups(joint, problem.load_case, problem.free, problem.beds.length, size, start);
  ConnectorRow worst;
  std::vector<Pose> closed = poses;
  if (close_connectors(joint, problem.load_case, problem.connectors, closed, &worst)) {
    poses = std::move(closed);
    return "";
  }
  if (at(worst.link) >= joint.connectors.size())
    return fmt::format(
        "fixed nodes of body \"{}\" cannot stay at their place together with the joints and with what is fixed or "
        "prescribed: a gap of {:.3g} is left along {}; free a motion or take a joint out",
        joint.bodies[at(worst.link) - joint.connectors.size()].name, std::abs(worst.gap), "xyz"[worst.dof]);
  return fmt::format(
      "joint \"{}\" cannot be held together with the other joints and with what is fixed or prescribed: a gap of "
      "{:.3g}{} is left {} its axis {}; free a motion or take a joint out",
      joint.connectors[at(worst.link)].name, std::abs(worst.gap), worst.dof < 3 ? "" : " rad",
      worst.dof < 3 ? "along" : "about", worst.dof % 3 + 1);
}

/// The flat directions that were held, in words.
std::vector<std::string> held_in_words(const Problem& problem, const Solution& s) {
  std::vector<std::string> held;
  const bool loose = !touching(s.at);
  const VectorXd r = scaled_residual(problem, s.at);
  for (const VectorXd& v : s.directions.held) {
    // a body that is neither loaded nor touched simply stays: said once by the caller
    if (loose && s.at.load == 0.0) continue;
    const double along = s.at.load > 0 ? std::abs(v.dot(r)) / s.at.load : 0.0;
    held.push_back(
        direction_in_words(problem, s.at, v) +
        (along > 1e-6 ? fmt::format(" ({:.1e} of the load left along it: the facets' roughness)", along) : ""));
  }
  return held;
}

/// Contacts with one other body alone: from between two that press it a body need not be loaded itself.
bool between_bodies(const Problem& problem, int body) {
  std::set<int> others;
  for (std::size_t c = 0; c < problem.joint.contacts.size(); ++c) {
    const ContactPair& pair = problem.joint.contacts[c];
    if (!problem.load_case.contact_active[c]) continue;
    for (const int side : {0, 1})
      if (pair.layers[side].body == body) others.insert(pair.layers[1 - side].body);
  }
  return others.size() > 1;
}

/// Neither a force of the model, nor a ligament, nor a joint acts on what the body is free to do, its contact pushes it
/// where it is free to go, and most of what is out of balance is that.
bool unloaded(const Problem& problem, const Evaluation& e, int body) {
  const std::size_t b = at(body);
  const BodyConditions& conditions = problem.load_case.bodies[b];
  bool goes = false;
  double own = 0.0, all = 0.0;
  const VectorXd residual = e.residual();
  for (const int dof : problem.free)
    if (dof % 6 < 3) all += residual[dof] * residual[dof];
  for (int k = 0; k < kDofs; ++k) {
    if (conditions.dofs[at(k)] != DofState::Free) continue;
    const Eigen::Index dof = 6 * static_cast<Eigen::Index>(body) + k;
    goes = goes || (k < 3 && e.contact[dof] != 0.0);
    if (k < 3) own += residual[dof] * residual[dof];
    if (e.external[dof] != 0.0 || e.ligaments[dof] != 0.0) return false;
  }
  for (std::size_t c = 0; c < problem.load_case.connector_active.size(); ++c) {
    const Connector& connector = problem.joint.connectors[c];
    if (problem.load_case.connector_active[c] && (connector.body_a == body || connector.body_b == body)) return false;
  }
  return goes && own >= 0.5 * all && !between_bodies(problem, body);
}

/// The first such body; -1: none.
int unloaded_body(const Problem& problem, const Evaluation& e) {
  for (int b = 0; b < static_cast<int>(problem.joint.bodies.size()); ++b)
    if (unloaded(problem, e, b)) return b;
  return -1;
}

/// Where nothing loads a body, that is why it finds no balance, whatever the search has run into.
void say_unloaded(const Problem& problem, int body, Equilibrium& result) {
  std::string axes;
  for (int k = 0; k < 3; ++k)
    if (problem.load_case.bodies[at(body)].dofs[at(k)] == DofState::Free)
      axes += fmt::format("{}{}", axes.empty() ? "" : ", ", "xyz"[k]);
  const std::string& name = problem.joint.bodies[at(body)].name;
  result.message = fmt::format(
      "nothing loads body \"{}\", which is free to move along {}: the contact pushes it away and nothing pushes back;",
      name, axes);
  result.advice = say("give it a load with {} or a rigid force in the model, or hold or prescribe its motion",
                      NamedSetting{"force", name, "x,y,z"});
}

/// Where no contact acts at this time, that is why the surfaces part.
void say_inactive(const Problem& problem, Equilibrium& result) {
  const std::vector<char>& active = problem.load_case.contact_active;
  if (solved(result.outcome) || std::any_of(active.begin(), active.end(), [](char acts) { return acts != 0; })) return;
  result.message = fmt::format("no contact acts in this step: contact \"{}\" is of step {} alone;",
                               problem.joint.contacts.front().name, problem.joint.contacts.front().step + 1);
  result.advice = "let it act in all steps, or in this one too";
}

/// Whether the least stiffness is negative by more than facets leave of zero (E6b).
bool is_unstable(const Problem& problem, const Solution& s) {
  constexpr double kNeutralLength = 1e4;  // of the least thickness; facets leave longer ones, the least seen was 6e4
  return solved(s.outcome) && -s.directions.least_stiffness * kNeutralLength * problem.beds.least_thickness > s.at.load;
}

}  // namespace

Equilibrium state_at(const Joint& joint, const SpringBeds& beds, const LoadCase& load_case,
                     const std::vector<Pose>& poses, std::vector<PressMemory>* memory, const StopFlag* stop) {
  std::vector<PressMemory> own;
  if (const std::string fault = undefined_force(joint, load_case, poses); !fault.empty()) throw InputError(fault);
  Problem problem = make_problem(joint, beds, load_case, memory ? *memory : own);
  problem.tolerance = kGivenPoseTolerance;
  problem.stop = stop;
  Equilibrium result = to_equilibrium(problem, evaluate(problem, poses), {Outcome::Prescribed, "motion given"});
  result.least_stiffness = kNaN;
  return result;
}

Equilibrium solve_equilibrium(const Joint& joint, const SpringBeds& beds, const LoadCase& load_case,
                              const std::vector<Pose>& start, const std::vector<Pose>& step_start,
                              const EquilibriumOptions& options, std::vector<PressMemory>* memory) {
  std::vector<PressMemory> own;
  Problem problem = make_problem(joint, beds, load_case, memory ? *memory : own);
  problem.watch = &options.watch;
  problem.stop = options.stop;
  find_unknowns(problem);
  std::vector<Pose> poses = prescribed_poses(joint, load_case, start, step_start);
  const std::string torn = close_all_connectors(problem, start, poses);
  if (!torn.empty() || problem.free.empty()) {
    Equilibrium result = state_at(joint, beds, load_case, poses, &problem.memory, options.stop);
    if (torn.empty()) return result;
    result.outcome = Outcome::NoEquilibrium;
    result.message = torn;
    return result;
  }
  if (const std::string fault = undefined_force(joint, load_case, poses); !fault.empty()) throw InputError(fault);
  Solution s = search_from(problem, poses, options);
  if (s.at.tolerance > kPressureTolerance) {  // a search that ended far from balance
    problem.tolerance = kPressureTolerance;
    s.at = evaluate(problem, std::move(s.at.poses));
  }
  std::vector<std::string> held = held_in_words(problem, s);
  const bool unstable = is_unstable(problem, s);
  const int idle = solved(s.outcome) ? -1 : unloaded_body(problem, s.at);
  const double left = scaled_residual(problem, s.at).norm(), load = s.at.load;
  Equilibrium result = to_equilibrium(problem, std::move(s.at), s);
  constexpr double kMostLeft =
      0.05;  // what roughness leaves along a held direction is 1 %, as its moment three times that
  if (solved(result.outcome) && load > 1e-9 * problem.beds.stiffest && left > kMostLeft * load) {
    result.outcome = Outcome::NotConverged;
    result.message = fmt::format(
        "{:.0f}% of the load is left along motions that little but the facets' roughness resists", 100 * left / load);
  }
  if (idle >= 0 && result.outcome != Outcome::BeyondStrainLimit) say_unloaded(problem, idle, result);
  say_inactive(problem, result);
  result.least_stiffness = s.directions.least_stiffness;
  result.unstable = unstable;
  result.held = std::move(held);
  return result;
}

}  // namespace dea

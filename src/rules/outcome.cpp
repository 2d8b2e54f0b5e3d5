#include <algorithm>
#include <cmath>

#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/base/time_text.h"
#include "src/rules/look.h"
#include "src/rules/rules.h"

namespace dea {

namespace {

/// Neighbouring states of which the same is to be said; what they differ in is told of the last one.
struct StateRun {
  std::string what;
  Sentence detail;
  std::size_t first = 0, last = 0;  // indices of states
};

void add_state(std::vector<StateRun>& runs, const std::string& what, std::size_t index, const Sentence& detail) {
  if (!runs.empty() && runs.back().what == what && runs.back().last + 1 == index) {
    runs.back().last = index;
    runs.back().detail = detail;
  } else {
    runs.push_back({what, detail, index, index});
  }
}

Findings run_findings(const char* code, const SolvedStates& result, const std::vector<StateRun>& runs) {
  Findings found;
  for (const StateRun& run : runs)
    found.push_back({code,
                     {.time = result.states[run.last].when.time},
                     {{"what", run.what},
                      {"detail", run.detail},
                      {"from", time_text(result.states[run.first].when.time)},
                      {"states", run.last - run.first + 1}},
                     run.first == run.last ? 0 : 1});
  return found;
}

Sentence outcome_sentence(const Equilibrium& e) {
  return e.advice.empty() ? Sentence(e.message) : say("{} {}", e.message, e.advice);
}

bool touches(const StateResult& state) {
  return std::any_of(state.statistics.begin(), state.statistics.end(),
                     [](const ContactStatistics& s) { return s.springs_active > 0; });
}

/// The largest force that the tables show of a state, of contacts, bodies, ligaments and cables.
double largest_shown_force(const StateResult& state) {
  double largest = 0.0;
  const auto look_at = [&](double force) { largest = std::max(largest, std::abs(force)); };
  for (const ContactStatistics& contact : state.statistics) look_at(contact.force.norm());
  for (const Vector6& on_body : state.equilibrium.reaction) look_at(on_body.head<3>().norm());
  for (const double force : state.equilibrium.ligament_force) look_at(force);
  for (const double force : state.equilibrium.cable_force) look_at(force);
  return largest;
}

/// How far bodies are meant to turn [degrees]: the sum of all rotations that the model prescribes, of bodies and in
/// joints; a body may follow any of them.
double prescribed_turn(const Joint& joint, const Equilibrium& last) {
  double sum = 0.0;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const bool prescribed =
        std::any_of(joint.conditions.steps.begin(), joint.conditions.steps.end(), [&](const auto& step) {
          const auto& dofs = step[b].dofs;
          return std::any_of(dofs.begin() + 3, dofs.end(), [](const BodyDof& dof) { return !dof.motions.empty(); });
        });
    if (prescribed) sum += Eigen::AngleAxisd(last.poses[b].rotation).angle() * kDegreesPerRadian;
  }
  for (std::size_t c = 0; c < joint.connectors.size() && c < last.connector_motion.size(); ++c)
    for (int k = 3; k < kDofs; ++k)
      if (joint.connectors[c].motion[at(k)] == RigidJoint::Motion::Prescribed)
        sum += std::abs(last.connector_motion[c][k]) * kDegreesPerRadian;
  return sum;
}

/// Prescribed motions that bring a body through the other one: its springs see nothing, as if the surfaces were apart.
/// Asked where a contact ends, and in the last state.
const StateResult* passed_state(const Joint& joint, const SolvedStates& result, std::size_t c) {
  const auto active = [&](std::size_t state) { return result.states[state].statistics[c].springs_active > 0; };
  for (std::size_t i = 0; i < result.states.size(); ++i) {
    const StateResult& state = result.states[i];
    const bool ends = !active(i) && (i + 1 == result.states.size() || (i > 0 && active(i - 1)));
    if (ends && state.equilibrium.outcome == Outcome::Prescribed &&
        passed_through(joint, joint.contacts[c], state.equilibrium.poses))
      return &state;
  }
  return nullptr;
}

}  // namespace

std::string outcome_text(const Equilibrium& e, const Wording& wording) { return worded(outcome_sentence(e), wording); }

bool parted(const Equilibrium& e, double stiffest) {
  constexpr double kNothing = 1e-9;
  return e.outcome == Outcome::Balanced && e.load <= kNothing * stiffest;
}

Subject JudgedContact::subject(const JointModel& model, const Layer& layer) const {
  Subject with_surface = subject();
  with_surface.surface = model.surfaces[at(layer.surface)].name;
  return with_surface;
}

std::vector<JudgedContact> judged_contacts(const Joint& joint, const SolvedStates& result) {
  const StateResult& last = result.states.back();  // factors change slowly
  std::vector<JudgedContact> contacts;
  for (std::size_t c = 0; solved(last.equilibrium.outcome) && c < joint.contacts.size(); ++c)
    contacts.push_back({joint.contacts[c], last, last.statistics[c], last.fields[c]});
  return contacts;
}

std::vector<JudgedSide> judged_sides(const JointModel& model, const Joint& joint, const SolvedStates& result) {
  std::vector<JudgedSide> sides;
  for (const JudgedContact& c : judged_contacts(joint, result))
    for (int side = 0; side < 2; ++side) {
      const Layer &layer = c.pair.layers[side], &partner = c.pair.layers[1 - side];
      sides.push_back({c.statistics, c.fields.sides[side], side, layer, partner, c.subject(model, layer)});
    }
  return sides;
}

/// States that are no solution, neighbours together.
Findings no_solution(const JointModel&, const Joint&, const SolvedStates& result) {
  std::vector<StateRun> runs;
  for (std::size_t i = 0; i < result.states.size(); ++i)
    if (const Equilibrium& e = result.states[i].equilibrium; !solved(e.outcome) && e.outcome != Outcome::NoContact)
      add_state(runs, name(e.outcome), i, outcome_sentence(e));
  return run_findings("no-solution", result, runs);
}

/// States that stand on the brink.
Findings unstable_balance(const JointModel&, const Joint&, const SolvedStates& result) {
  std::vector<StateRun> runs;
  for (std::size_t i = 0; i < result.states.size(); ++i)
    if (const Equilibrium& e = result.states[i].equilibrium; e.unstable)
      add_state(runs, "the balance is unstable", i, say("least stiffness {:.3g}", e.least_stiffness));
  return run_findings("unstable-balance", result, runs);
}

Findings held_motion(const JointModel&, const Joint&, const SolvedStates& result) {
  int count = 0;
  const StateResult* last = nullptr;  // the axes turn a little from state to state: those of the last one stand for all
  for (const StateResult& state : result.states) {
    if (state.equilibrium.held.empty()) continue;
    ++count;
    last = &state;
  }
  if (last == nullptr) return {};
  return {{"motion-held",
           {.time = last->when.time},
           {{"count", count},
            {"states", result.states.size()},
            {"directions", fmt::format("{}", fmt::join(last->equilibrium.held, ", "))}}}};
}

/// Surfaces that do not touch, for nothing loads a free body; of the last such state.
Findings nothing_loads(const JointModel&, const Joint& joint, const SolvedStates& result) {
  const auto found = std::find_if(result.states.rbegin(), result.states.rend(),
                                  [](const StateResult& s) { return s.equilibrium.outcome == Outcome::NoContact; });
  if (found == result.states.rend()) return {};
  const StateResult& last = *found;
  std::vector<std::string> free;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b)
    if (b < result.free_to_move.size() && result.free_to_move[b]) free.push_back(joint.bodies[b].name);
  const bool one = free.size() == 1;
  return {{"nothing-loads",
           {.body = one ? free.front() : "", .time = last.when.time},
           {{"bodies", free},
            {"surfaces", touches(last) ? "the surfaces have parted" : "nothing touches"},
            {"give", NamedSetting{"force", one ? free.front() : "BODY", "x,y,z", "", !one}}},
           free.empty() ? 1 : 0}};
}

Findings unloaded_contact(const JointModel&, const Joint&, const SolvedStates& result) {
  const StateResult& last = result.states.back();
  const Outcome outcome = last.equilibrium.outcome;
  if (!solved(outcome) || outcome == Outcome::Prescribed || touches(last)) return {};
  return {{"contact-unloaded", {.time = last.when.time}}};
}

Findings passed_surfaces(const JointModel&, const Joint& joint, const SolvedStates& result) {
  Findings found;
  for (std::size_t c = 0; c < joint.contacts.size(); ++c)
    if (const StateResult* state = passed_state(joint, result, c))
      found.push_back({"passed-through", {.contact = joint.contacts[c].name, .time = state->when.time}});
  return found;
}

Findings never_touching(const JointModel& model, const Joint& joint, const SolvedStates& result) {
  if (result.states.back().equilibrium.outcome != Outcome::Prescribed ||
      std::any_of(result.states.begin(), result.states.end(), touches) ||
      !passed_surfaces(model, joint, result).empty())
    return {};
  return {{"never-touching"}};
}

/// Loads too small for any joint in all states: 1 kPa over the whole surface of cartilage of 10 MPa. 2.5 for 2500 N are
/// such.
Findings tiny_load(const JointModel&, const Joint& joint, const SolvedStates& result) {
  constexpr double kTiny = 1e-4;
  double load = 0.0, shown = 0.0;
  for (const StateResult& state : result.states) {
    load = std::max(load, state.equilibrium.load);
    shown = std::max(shown, largest_shown_force(state));
  }
  const double stiffest = stiffest_layer(joint);
  if (result.states.back().equilibrium.outcome != Outcome::Balanced || !(load < kTiny * stiffest)) return {};
  const double force = shown > 0 ? shown : load;
  return {{"tiny-load", {}, {{"force", force}, {"ratio", force / stiffest}}}};
}

/// Bodies that have turned far although nobody wants them to.
Findings large_turn(const JointModel&, const Joint& joint, const SolvedStates& result) {
  Findings found;
  const Equilibrium& e = result.states.back().equilibrium;
  if (!solved(e.outcome) || e.outcome == Outcome::Prescribed) return {};
  const double prescribed = prescribed_turn(joint, e);
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    if (!result.free_to_turn[b]) continue;
    const Eigen::AngleAxisd turn(e.poses[b].rotation * result.start[b].rotation.transpose());
    const double degrees = turn.angle() * kDegreesPerRadian;
    if (!(degrees > 20.0 + prescribed)) continue;
    const bool jointed = std::any_of(joint.connectors.begin(), joint.connectors.end(), [&](const Connector& c) {
      return c.body_a == static_cast<int>(b) || c.body_b == static_cast<int>(b);
    });
    found.push_back({"large-turn",
                     {.body = joint.bodies[b].name},
                     {{"degrees", degrees},
                      {"x", turn.axis().x()},
                      {"y", turn.axis().y()},
                      {"z", turn.axis().z()},
                      {"hold", NamedSetting{"free", joint.bodies[b].name, "x,y,z"}}},
                     jointed ? 1 : 0});
  }
  return found;
}

/// Bodies that have to travel as far as their surfaces are large before they meet: placed wrongly, as a rule. How far
/// the motions that are given carry a body with them is no travel of its own: the patella follows the femur.
Findings far_travel(const JointModel&, const Joint& joint, const SolvedStates& result) {
  const auto first = std::find_if(result.states.begin(), result.states.end(), [](const StateResult& s) {
    return solved(s.equilibrium.outcome) && s.equilibrium.outcome != Outcome::Prescribed;
  });
  if (first == result.states.end()) return {};
  const std::vector<Pose>& poses = first->equilibrium.poses;
  Findings found;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    if (b >= result.free_to_move.size() || !result.free_to_move[b]) continue;
    double size = 0.0;  // of its largest surface
    for (const ContactPair& pair : joint.contacts)
      for (const Layer& layer : pair.layers)
        if (layer.body == static_cast<int>(b))
          size = std::max(size, surface_extent(layer.articular).radius_of_gyration);
    const Vector3d begin = result.start[b].center;
    double carried = 0.0;
    for (std::size_t other = 0; other < poses.size(); ++other) {
      if (result.free_to_move[other]) continue;
      const Eigen::Matrix3d turn = poses[other].rotation * result.start[other].rotation.transpose();
      carried += (poses[other].center + turn * (begin - result.start[other].center) - begin).norm();
    }
    const double way = (poses[b].center - begin).norm();
    if (size > 0 && way > size + carried)
      found.push_back({"far-travel",
                       {.body = joint.bodies[b].name, .time = first->when.time},
                       {{"way", way}, {"size", size}, {"move", NamedSetting{"move", joint.bodies[b].name, "x,y,z"}}}});
  }
  return found;
}

Findings without_effect(const JointModel&, const Joint&, const SolvedStates& result) { return result.idle; }

}  // namespace dea

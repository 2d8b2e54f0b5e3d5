#include "src/run/analysis.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/base/time_text.h"
#include "src/joint/shared_ends.h"
#include "src/rules/idle_loads.h"
#include "src/rules/look.h"
#include "src/rules/rules.h"

namespace dea {

namespace {

constexpr int kLeastPatience = 5;  // poses: a warm start that is near its balance needs about four

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// From state to state: where the next one starts, and how long it is searched.
struct StateSequence {
  Start start;                    // `poses`: of the last state that was solved
  std::vector<Vector6> reaction;  // there
  std::vector<Pose> placed;       // where the bodies start
  std::vector<Vector6> step_reaction;
  std::vector<PressMemory> memory;
  EquilibriumOptions search;
  int step = 0;
};

void begin_step(StateSequence& sequence, int step, const EquilibriumOptions& options) {
  sequence.search.patience = options.patience;
  sequence.step = step;
  sequence.start.step_poses = sequence.start.poses;
  sequence.step_reaction = sequence.reaction;
}

/// A load that cannot be carried may have moved a body far away: the next state starts from the last one that was
/// solved.
void end_state(StateSequence& sequence, const Equilibrium& e, const EquilibriumOptions& options) {
  const bool balanced = e.history.empty() || e.history.back() <= 1e3 * options.tolerance;
  if (solved(e.outcome) ||
      ((e.outcome == Outcome::BeyondStrainLimit || e.outcome == Outcome::PressedTwice) && balanced)) {
    sequence.start.poses = e.poses;
    sequence.reaction = e.reaction;
  }
  // Loads that follow one without a balance start where it did: they are searched again, but not as long.
  if (solved(e.outcome))
    sequence.search.patience = options.patience;
  else if (e.outcome == Outcome::NoEquilibrium || e.outcome == Outcome::NotConverged)
    sequence.search.patience =
        std::max(std::min(kLeastPatience, sequence.search.patience), sequence.search.patience / 3);
}

LoadCase load_case_of(const JointModel& model, const Settings& settings, const Prepared& prepared,
                      const TimePoint& when, const StateSequence& sequence) {
  return when.row >= 0 ? make_row_case(model, prepared.joint, settings, when.row, sequence.start.poses,
                                       sequence.start.step_poses, &sequence.step_reaction)
                       : make_load_case(model, prepared.joint, settings, when.step, when.time, &sequence.step_reaction);
}

/// `reference`: the reference configuration is not solved.
Equilibrium solve_state(const Prepared& prepared, const LoadCase& load_case, bool reference, StateSequence& sequence) {
  return reference ? state_at(prepared.joint, prepared.beds, load_case, sequence.start.poses, &sequence.memory,
                              sequence.search.stop)
                   : solve(prepared, load_case, sequence.start, sequence.search, &sequence.memory);
}

/// Per body: is one of three dofs free? `first`: 0, to move; 3, to turn.
std::vector<char> free_bodies(const LoadCase& load_case, int first) {
  std::vector<char> free;
  for (const BodyConditions& body : load_case.bodies)
    free.push_back(std::count(body.dofs.begin() + first, body.dofs.begin() + first + 3, DofState::Free) > 0);
  return free;
}

bool any_turns(const LoadCase& load_case) {
  const std::vector<char> free = free_bodies(load_case, 3);
  return std::find(free.begin(), free.end(), 1) != free.end();
}

int last_step(const JointModel& model) { return static_cast<int>(model.steps.size()) - 1; }

/// What is held stays where the settings place it, and a body that is placed starts there; `follow`: its free dofs do
/// not.
void take_known_balance(const KnownBalance& known, bool follow, const Joint& joint, const LoadCase& load_case,
                        StateSequence& sequence) {
  const std::vector<Pose> reference = reference_poses(joint);
  std::vector<Pose>& poses = sequence.start.poses;
  for (std::size_t b = 0; b < poses.size(); ++b) {
    const Pose& placed = sequence.placed[b];
    const bool is_placed = placed.center != reference[b].center || placed.rotation != reference[b].rotation;
    if (is_placed && !follow) continue;
    poses[b] = free_part(load_case.bodies[b], poses[b], known.poses[b]);
  }
  sequence.memory = known.memory;
}

/// From `known`; where that finds no solution, or none that is stable, from where the sequence starts.
Equilibrium solve_from(const KnownBalance& known, bool follow, const Prepared& prepared, const LoadCase& load_case,
                       StateSequence& sequence) {
  const Start start = sequence.start;
  take_known_balance(known, follow, prepared.joint, load_case, sequence);
  Equilibrium found = solve_state(prepared, load_case, false, sequence);
  if (solved(found.outcome) && found.least_stiffness > 0) return found;
  sequence.start = start;
  sequence.memory.clear();
  return solve_state(prepared, load_case, false, sequence);
}

/// What is as large as the mesh goes.
void drop_fields(StateResult& state) {
  for (ContactFields& contact : state.fields)
    for (SideFields& side : contact.sides) {
      SideFields numbers;
      numbers.force = side.force;
      numbers.springs = side.springs;
      numbers.contact_area = side.contact_area;
      numbers.resultant_factor = side.resultant_factor;
      side = std::move(numbers);
    }
  for (LayerStatistics& layer : state.layers) std::vector<double>().swap(layer.pressure);
  std::vector<InsideDomain>().swap(state.inside);
  for (PartStress& part : state.parts)
    for (auto* tensors : {&part.stress, &part.strain}) std::vector<SymmetricTensor>().swap(*tensors);
  std::vector<Vector3d>().swap(state.displacements);  // "= {}" would keep the memory
}

}  // namespace

void add_fields(const Prepared& prepared, const FieldMaps& maps, const InsideMaps* inside, StateResult& state) {
  const Equilibrium& e = state.equilibrium;
  state.fields = contact_fields(prepared.joint, prepared.beds, maps, e);
  state.statistics = contact_statistics(prepared.joint, prepared.beds, maps, e, state.fields);
  state.layers = layer_statistics(prepared.joint, maps, state.fields);
  state.parts = part_stress(prepared.joint, e);
  if (inside == nullptr) return;
  InsideResults results = inside_results(*inside, prepared.joint, prepared.beds, e);
  for (std::size_t c = 0; c < results.contacts.size(); ++c)
    add_inside(prepared.joint.contacts[c], std::move(results.contacts[c]), state.fields[c], state.statistics[c]);
  state.inside = std::move(results.domains);
}

void refuse_zero_thickness(const JointModel& model, const Joint& joint, const SpringBeds& beds, const Equilibrium& e) {
  for (std::size_t c = 0; c < joint.contacts.size(); ++c) {
    const ContactPair& pair = joint.contacts[c];
    if (pair.layers[0].part >= 0 || pair.layers[1].part >= 0) continue;  // the part gives way
    const double thin = 1e-6 * (pair.layers[0].mean_thickness() + pair.layers[1].mean_thickness());
    const SpringStates& s = e.springs[c];
    for (std::size_t i = 0; i < s.gap.size(); ++i) {
      if (s.triangle[i] < 0 || s.gap[i] > 0 || s.t_source[i] + s.t_target[i] > thin) continue;
      const Layer& source = pair.source_layer();
      const SurfaceMesh& mesh = source.spring_surface();
      const int vertex = mesh.triangles[at(beds.beds[c].springs.surface_triangle[i])][0];
      const Surface& surface = model.surfaces[at(source.surface)];
      const char* parameter = pair.source == 0 ? "primary_thickness" : "secondary_thickness";
      throw fault_at(
          model, surface.origin,
          say("contact \"{}\": there is no cartilage near node {} of surface \"{}\" where the bodies meet (thickness "
              "{:.2g});",
              pair.name, model.node_ids[at(mesh.model_nodes[at(vertex)])], surface.name, s.t_source[i] + s.t_target[i]),
          say("mend the mesh or give {}",
              NamedSetting{"thickness", surface.name, "VALUE", model.contacts[at(pair.contact)].dea ? parameter : ""}));
    }
  }
}

void refuse_left_planes(const JointModel& model, const Joint& joint, const std::vector<Pose>& poses,
                        std::optional<double> time) {
  for (const ContactPair& pair : joint.contacts) {
    const std::optional<LeftPlane> left = left_plane(pair, joint.bodies, poses);
    if (!left) continue;
    const int first = pair.layers[0].body, other = left->body == first ? pair.layers[1].body : first;
    throw fault_at(
        model, pair.origin,
        say("contact \"{}\": the model ends in the plane of symmetry {}, and{} body \"{}\" has crossed it or "
            "turned out of it, by {:.3g} as seen from body \"{}\": its mirror image would do the opposite;",
            pair.name, in_words(std::vector<SymmetryPlane>{left->plane}), time ? " at time " + time_text(*time) : "",
            joint.bodies[at(left->body)].name, left->shift, joint.bodies[at(other)].name),
        say("let the bodies move along this plane and turn about {} alone, or mesh the whole joint",
            std::string(1, "xyz"[left->plane.axis])));
  }
}

Analysis analyse(const JointModel& model, const Settings& settings, const AnalysisOptions& options) {
  if (options.activity) options.activity({});
  return analyse(recognise(model, settings), options);
}

SolvedStates solve_states(const JointModel& model, const Settings& settings, const Prepared& prepared,
                          const FieldMaps& maps, const AnalysisOptions& options) {
  const Joint& joint = prepared.joint;
  const std::vector<TimePoint> times = options.times.empty() ? model_times(model) : options.times;
  const std::vector<Vector6> no_reaction(joint.bodies.size(), Vector6::Zero());
  const double stiffest = stiffest_layer(joint);
  SolvedStates solved;
  solved.start = starting_poses(model, joint, settings);
  solved.idle = idle_settings(model, joint, settings);
  if (times.back().row >= 0 || times.back().step == last_step(model)) {  // the others have no such loads
    add_once(solved.idle, idle_findings(idle_loads(model, joint, settings)));
    add_once(solved.idle, idle_model_loads(model, joint, settings));
    add_once(solved.idle, idle_load_points(model, joint, settings));
  }
  StateSequence sequence{{solved.start, solved.start}, no_reaction, solved.start, no_reaction, {}, options.equilibrium};
  Activity activity{Activity::Stage::State, 0, times.size(), {}};
  if (options.activity) {
    sequence.search.watch = [&](const SearchStatus& status) {
      if (options.equilibrium.watch) options.equilibrium.watch(status);
      activity.search = status;
      options.activity(activity);
    };
  }
  const bool only_moves = !any_starts_at_reaction(model);  // nothing but poses is left of a state that is not kept
  bool first = true;                                       // to be solved
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (times[i].step != sequence.step) begin_step(sequence, times[i].step, options.equilibrium);
    activity.index = i;
    activity.search = {};
    if (options.activity) options.activity(activity);
    StateResult state;
    state.when = times[i];
    const bool reference = i == 0 && times[i].time <= 0.0 && times[i].row < 0;
    const LoadCase load_case = load_case_of(model, settings, prepared, times[i], sequence);
    const bool keep = options.keep_state.empty() || options.keep_state[i];
    if (!keep && only_moves && motion_is_given(load_case)) {  // its contacts are not looked at, nor refused
      end_if_stopped(options.equilibrium.stop);
      sequence.start.poses = prescribed_poses(joint, load_case, sequence.start.poses, sequence.start.step_poses);
      refuse_left_planes(model, joint, sequence.start.poses, state.when.time);
      continue;
    }
    const bool one_balance = times[i].step == last_step(model) && !any_turns(load_case);
    const bool may_be_known = first && !reference && (options.follow || one_balance);
    const KnownBalance* known = may_be_known && options.known_balance ? options.known_balance() : nullptr;
    state.equilibrium = known != nullptr ? solve_from(*known, options.follow, prepared, load_case, sequence)
                                         : solve_state(prepared, load_case, reference, sequence);
    first = false;
    end_state(sequence, state.equilibrium, options.equilibrium);
    if (parted(state.equilibrium, stiffest)) {
      state.equilibrium.outcome = Outcome::NoContact;
      state.equilibrium.message = "nothing loads a free body, and nothing presses it";
    }
    refuse_zero_thickness(model, joint, prepared.beds, state.equilibrium);
    if (dea::solved(state.equilibrium.outcome))
      refuse_left_planes(model, joint, state.equilibrium.poses, state.when.time);
    end_if_stopped(options.equilibrium.stop);
    if (keep) add_fields(prepared, maps, options.inside, state);
    if (keep && options.displacements)
      state.displacements = node_displacements(model, joint, maps, state.equilibrium, state.fields, settings.squash);
    if (keep) {
      solved.free_to_turn = free_bodies(load_case, 3);
      solved.free_to_move = free_bodies(load_case, 0);
    }
    if (options.progress) options.progress(state, i, times.size());
    state.equilibrium.springs.clear();  // the bulk of the memory; fields and statistics hold what is reported
    if (!keep) continue;
    if (!options.keep_fields && !solved.states.empty()) drop_fields(solved.states.back());
    solved.states.push_back(std::move(state));
  }
  if (options.memory != nullptr) *options.memory = std::move(sequence.memory);
  return solved;
}

Analysis analyse(const Recognition& recognition, const AnalysisOptions& given) {
  throw_if_any(recognition.faults);
  const JointModel& model = recognition.model;
  double clock = now();
  if (given.activity) given.activity({Activity::Stage::Springs, 0, 0, {}});
  Prepared prepared = prepare(recognition, given.equilibrium.stop);
  Analysis analysis;
  add_once(prepared.joint.findings, given.found_before);
  analysis.maps = make_field_maps(model, prepared.joint);
  analysis.seconds_joint = recognition.seconds + now() - clock;

  clock = now();
  AnalysisOptions options = given;
  if (options.times.empty()) options.times = model_times(model);
  InsideMaps inside;
  if (recognition.settings.inside && options.inside == nullptr) {
    inside = make_inside_maps(model, recognition.settings, prepared.joint, prepared.beds);
    options.inside = &inside;
    add_once(prepared.joint.findings, inside_findings(model, prepared.joint, inside));
  }
  static_cast<SolvedStates&>(analysis) = solve_states(model, recognition.settings, prepared, analysis.maps, options);
  analysis.findings = all_findings(model, prepared.joint, analysis);
  analysis.joint = std::move(prepared.joint);
  analysis.beds = std::move(prepared.beds);
  analysis.seconds_solve = now() - clock;
  return analysis;
}

}  // namespace dea

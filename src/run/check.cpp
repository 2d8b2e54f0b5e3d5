#include "src/run/check.h"

#include <algorithm>
#include <cmath>

#include "src/base/numbers.h"
#include "src/model/load_curve.h"
#include "src/run/prepared.h"
#include "src/run/states.h"
#include "src/springs/gaps.h"
#include "src/springs/place.h"

namespace dea {

namespace {

std::vector<SpringBed> beds_alone(const Joint& joint) {
  std::vector<SpringBed> beds;
  for (const ContactPair& pair : joint.contacts) beds.push_back(place_springs_alone(joint, pair));
  return beds;
}

/// Springs of every contact at the starting poses, also of those that a step switches on later.
void check_contacts(const Recognition& recognition, const std::vector<SpringBed>& beds, JointCheck& check) {
  const Joint& joint = check.joint;
  check.start = at_start(recognition).poses;
  for (const SpringBed& bed : beds)
    check.springs.push_back(find_gaps(bed, check.start[at(bed.source_body)], check.start[at(bed.target_body)]));
  for (std::size_t c = 0; c < joint.contacts.size(); ++c) {
    ContactCheck found;
    for (int side = 0; side < 2; ++side) {
      const SurfaceMesh& surface = joint.contacts[c].layers[side].articular;
      found.sides[side].sphere = fit_sphere(surface);
      found.sides[side].area = surface_extent(surface).area;
      const Layer& layer = joint.contacts[c].layers[side];
      found.sides[side].whole_face = layer.face.mesh.size() > 0;
      if (found.sides[side].whole_face) found.sides[side].rim = rim_lengths(layer.face);
      for (FaceKind kind : layer.facet_kinds) {
        found.sides[side].side_walls += kind == FaceKind::SideWall;
        found.sides[side].bonded += kind == FaceKind::Bonded;
      }
    }
    const SpringStates& springs = check.springs[c];
    std::vector<double> gaps;
    for (int i = 0; i < springs.size(); ++i)
      if (springs.triangle[at(i)] >= 0 && springs.coverage[at(i)] > 0) gaps.push_back(springs.gap[at(i)]);
    std::sort(gaps.begin(), gaps.end());
    found.springs = springs.size();
    found.springs_hit = static_cast<int>(gaps.size());
    const auto quantile = [&](double q) {
      return gaps.empty() ? kNaN : gaps[static_cast<std::size_t>(q * static_cast<double>(gaps.size() - 1))];
    };
    found.gap_min = quantile(0.0);
    found.gap_p5 = quantile(0.05);
    found.gap_median = quantile(0.5);
    found.gap_max = quantile(1.0);
    check.contacts.push_back(found);
  }
}

/// All states that `dea run` solves, and which of them it shows.
States states_of(const JointModel& model, const Settings& settings) {
  if (row_count(settings) == 0 && !settings.skip_steps) return all_states(model_times(model, true));
  StatesAsked asked;
  asked.all = true;
  return row_states(model, settings, asked, "");
}

/// `solved`: the times of all states, those on the way too.
void check_steps(const JointModel& model, const Settings& settings, const std::vector<TimePoint>& solved,
                 JointCheck& check) {
  const std::vector<double> starts = step_starts(model);
  for (int s = 0; s < static_cast<int>(model.steps.size()); ++s) {
    StepCheck step;
    step.name = model.steps[at(s)].name;
    step.start = starts[at(s)];
    step.end = starts[at(s) + 1];
    step.step_size = model.steps[at(s)].step_size;
    for (const TimePoint& t : solved)
      if (t.step == s && t.row < 0 && t.time > 0) ++step.states;
    step.load_case = make_load_case(model, check.joint, settings, s, step.end);
    check.steps.push_back(std::move(step));
  }
}

/// The model's conditions under the tables. Settings that contradict each other were refused by the recognition.
std::optional<LoadCase> check_row(const Recognition& recognition, const Joint& joint) {
  if (row_count(recognition.settings) == 0 || !recognition.faults.empty()) return std::nullopt;
  Settings settings = recognition.settings;
  for (Vector6& load : settings.loads.load) load.setZero();
  const std::vector<Pose> start = at_start(recognition).poses;
  return make_row_case(recognition.model, joint, settings, 0, start, start);
}

/// `contacts`: how these are looked at.
template <class Contacts>
JointCheck check_joint_with(const Recognition& recognition, const Contacts& contacts) {
  const JointModel& model = recognition.model;
  JointCheck check;
  check.errors = recognition.faults;
  if (!recognition.recognised) return check;
  try {
    check.joint = recognition.joint;
    contacts(check);
    check.recognised = true;
    const States states = states_of(model, recognition.settings);
    for (std::size_t i = 0; i < states.times.size(); ++i)
      if (states.wanted[i]) check.times.push_back(states.times[i]);
    const bool own = row_count(recognition.settings) == 0 && !recognition.settings.skip_steps;
    if (own && very_many_time_steps(model)) check.joint.findings.push_back(states_thinned(model, check.times.size()));
    if (!controllers_have_values(model)) return check;
    check_steps(model, recognition.settings, states.times, check);
    check.row = check_row(recognition, check.joint);
  } catch (const InputError& found) {
    if (check.errors.empty()) check.errors.push_back(found.fault);
  }
  return check;
}

}  // namespace

JointCheck check_joint(const Recognition& recognition) {
  return check_joint_with(recognition,
                          [&](JointCheck& check) { check_contacts(recognition, beds_alone(check.joint), check); });
}

JointCheck check_joint(const Recognition& recognition, const std::vector<SpringBed>& beds) {
  return check_joint_with(recognition, [&](JointCheck& check) { check_contacts(recognition, beds, check); });
}

std::vector<ContactFields> fields_at_start(const JointCheck& check, const FieldMaps& maps) {
  Equilibrium at_start;
  at_start.poses = check.start;
  at_start.springs = check.springs;
  at_start.contact_on_target.assign(check.springs.size(), Vector6::Zero());
  SpringBeds beds;
  beds.beds = beds_alone(check.joint);
  return contact_fields(check.joint, beds, maps, at_start);
}

}  // namespace dea

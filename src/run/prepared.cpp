#include "src/run/prepared.h"

#include <algorithm>
#include <set>
#include <utility>

#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/equilibrium/forces.h"
#include "src/joint/placing.h"

namespace dea {

Prepared prepare(const Recognition& recognition, const StopFlag* stop) {
  throw_if_any(recognition.faults);
  return {recognition.joint, make_spring_beds(recognition.joint, stop)};
}

Prepared prepare(Recognition&& recognition, const StopFlag* stop) {
  throw_if_any(recognition.faults);
  Prepared prepared;
  prepared.joint = std::move(recognition.joint);
  prepared.beds = make_spring_beds(prepared.joint, stop);
  return prepared;
}

Start at_rest(const Prepared& prepared) {
  const std::vector<Pose> poses = reference_poses(prepared.joint);
  return {poses, poses};
}

Start at_start(const Recognition& r) {
  const std::vector<Pose> poses = starting_poses(r.model, r.joint, r.settings);
  return {poses, poses};
}

Pose free_part(const BodyConditions& body, const Pose& placed, const Pose& free) {
  Pose pose = placed;
  for (int k = 0; k < 3; ++k)
    if (body.dofs[at(k)] == DofState::Free) pose.center(k) = free.center(k);
  if (std::count(body.dofs.begin() + 3, body.dofs.end(), DofState::Free) > 0) pose.rotation = free.rotation;
  return pose;
}

Equilibrium solve(const Prepared& prepared, const LoadCase& load_case, const Start& start,
                  const EquilibriumOptions& options, std::vector<PressMemory>* memory) {
  return solve_equilibrium(prepared.joint, prepared.beds, load_case, start.poses, start.step_poses, options, memory);
}

namespace {

/// The steps in which contacts of a group act by themselves; one of none: all act at all times.
std::vector<int> steps_of(const Joint& joint, const std::vector<int>& group) {
  std::set<int> steps;
  for (const int c : group)
    if (joint.contacts[at(c)].step >= 0) steps.insert(joint.contacts[at(c)].step);
  if (steps.empty()) steps.insert(-1);
  return {steps.begin(), steps.end()};
}

/// Ligaments on parts, by a load case. UsageError: there are some, and no load case.
TieLaw ligament_law(const Prepared& prepared, const LoadCase* ligaments) {
  if (ligaments != nullptr) return tie_law(prepared.joint, *ligaments);
  for (const SpringBed& bed : prepared.beds.ties)
    for (const PartTie& tie : bed.ties)
      if (tie.ligament >= 0)
        throw UsageError(Fault{.place = "press",
                               .found = say("ligament \"{}\" pulls at a part that gives way;",
                                            prepared.joint.ligaments[at(tie.ligament)].name),
                               .expected = "expected the load case in which it does"});
  return {};
}

}  // namespace

Pressed press(const Prepared& prepared, const std::vector<Pose>& poses, const PressOptions& options,
              std::vector<PressMemory>* memory, const LoadCase* ligaments) {
  const SpringBeds& beds = prepared.beds;
  const Joint& joint = prepared.joint;
  const TieLaw law = ligament_law(prepared, ligaments);
  const std::size_t contacts = beds.beds.size();
  if (memory) memory->resize(beds.groups.size());
  Pressed result;
  result.on_body.assign(joint.bodies.size(), Vector6::Zero());
  result.contacts.resize(contacts);
  const auto take = [&](std::size_t c, PressedContact&& pressed) {
    const ContactWrench& wrench = pressed.wrench;
    const int target = beds.beds[c].target_body;
    PressedSprings& contact = result.contacts[c];
    contact.springs = std::move(pressed.springs);
    contact.on_target = wrench.wrench.head<6>();
    contact.on_source = wrench.wrench.tail<6>();
    contact.derivative = wrench.derivative.topLeftCorner<6, 6>();
    for (const ContactWrench::Cross& other : wrench.cross) {  // the target may be a body of these too
      if (other.bodies.target == target) contact.derivative += other.derivative.topLeftCorner<6, 6>();
      if (other.bodies.source == target) contact.derivative += other.derivative.topRightCorner<6, 6>();
    }
    contact.normal_force = wrench.normal_force;
  };
  for (std::size_t g = 0; g < beds.groups.size(); ++g) {
    const std::vector<int>& group = beds.groups[g];
    const std::vector<int> steps = steps_of(joint, group);
    for (const int step : steps) {  // those that never act together do not press each other
      std::vector<char> active(contacts, 1);
      for (const int c : group) active[at(c)] = at_same_time(joint.contacts[at(c)].step, step);
      std::vector<PressedContact> pressed =
          press_group(beds, group, poses, std::vector<Motions>(contacts, options.motions), active, options,
                      memory ? &(*memory)[g] : nullptr, law);
      for (std::size_t k = 0; k < group.size(); ++k)
        if (active[at(group[k])] && (joint.contacts[at(group[k])].step == step || step == steps.back()))
          take(at(group[k]), std::move(pressed[k]));
    }
  }
  for (std::size_t c = 0; c < contacts; ++c) {
    result.on_body[at(beds.beds[c].target_body)] += result.contacts[c].on_target;
    result.on_body[at(beds.beds[c].source_body)] += result.contacts[c].on_source;
  }
  return result;
}

PressedTwice pressed_twice(const Prepared& prepared, const Pressed& pressed, const std::vector<Pose>& poses) {
  std::vector<SpringStates> springs;
  for (const PressedSprings& contact : pressed.contacts) springs.push_back(contact.springs);
  return pressed_twice(prepared.joint, prepared.beds, springs, poses);
}

}  // namespace dea

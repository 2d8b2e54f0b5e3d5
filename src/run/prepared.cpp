#include "src/run/prepared.h"

#include <algorithm>
#include <utility>

#include "src/base/numbers.h"
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

Pressed press(const Prepared& prepared, const std::vector<Pose>& poses, const PressOptions& options,
              std::vector<PressMemory>* memory) {
  const SpringBeds& beds = prepared.beds;
  const std::size_t contacts = beds.beds.size();
  if (memory) memory->resize(beds.groups.size());
  Pressed result;
  result.on_body.assign(prepared.joint.bodies.size(), Vector6::Zero());
  result.contacts.resize(contacts);
  for (std::size_t g = 0; g < beds.groups.size(); ++g) {
    std::vector<PressedContact> group =
        press_group(beds, beds.groups[g], poses, std::vector<Motions>(contacts, options.motions),
                    std::vector<char>(contacts, 1), options, memory ? &(*memory)[g] : nullptr);
    for (std::size_t k = 0; k < group.size(); ++k) {
      const ContactWrench& wrench = group[k].wrench;
      const int target = beds.beds[at(beds.groups[g][k])].target_body;
      PressedSprings& contact = result.contacts[at(beds.groups[g][k])];
      contact.springs = std::move(group[k].springs);
      contact.on_target = wrench.wrench.head<6>();
      contact.on_source = wrench.wrench.tail<6>();
      contact.derivative = wrench.derivative.topLeftCorner<6, 6>();
      for (const ContactWrench::Cross& other : wrench.cross) {  // the target may be a body of these too
        if (other.bodies.target == target) contact.derivative += other.derivative.topLeftCorner<6, 6>();
        if (other.bodies.source == target) contact.derivative += other.derivative.topRightCorner<6, 6>();
      }
      contact.normal_force = wrench.normal_force;
    }
  }
  for (std::size_t c = 0; c < contacts; ++c) {
    result.on_body[at(beds.beds[c].target_body)] += result.contacts[c].on_target;
    result.on_body[at(beds.beds[c].source_body)] += result.contacts[c].on_source;
  }
  return result;
}

}  // namespace dea

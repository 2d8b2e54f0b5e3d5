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
  const std::vector<SpringBed>& beds = prepared.beds.beds;
  if (memory) memory->resize(beds.size());
  Pressed result;
  result.on_body.assign(prepared.joint.bodies.size(), Vector6::Zero());
  for (std::size_t c = 0; c < beds.size(); ++c) {
    PressedContact pressed = press_contact(beds[c], poses, options, memory ? &(*memory)[c] : nullptr);
    PressedSprings contact;
    contact.springs = std::move(pressed.springs);
    contact.on_target = pressed.wrench.wrench.head<6>();
    contact.on_source = pressed.wrench.wrench.tail<6>();
    contact.derivative = pressed.wrench.derivative.topLeftCorner<6, 6>();
    contact.normal_force = pressed.wrench.normal_force;
    result.on_body[at(beds[c].target_body)] += contact.on_target;
    result.on_body[at(beds[c].source_body)] += contact.on_source;
    result.contacts.push_back(std::move(contact));
  }
  return result;
}

}  // namespace dea

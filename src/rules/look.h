// src/rules/look.h – the rules that look, one function each; rules.cpp lists them with their words.
#pragma once
#include "src/base/finding.h"
#include "src/joint/joint.h"
#include "src/results/solved_states.h"

namespace dea {

// units.cpp
Findings odd_units(const JointModel& model, const Joint& joint);
Findings thick_layers(const JointModel& model, const Joint& joint);
Findings sizes_that_differ(const JointModel& model, const Joint& joint);
// thickness.cpp
Findings no_thickness(const JointModel& model, const Joint& joint);
Findings nearest_thickness(const JointModel& model, const Joint& joint);
Findings pressed_nearest_thickness(const JointModel& model, const Joint& joint, const SolvedStates& result);
// material.cpp
Findings drained_cartilage(const JointModel& model, const Joint& joint);
Findings large_strains(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings softening_material(const JointModel& model, const Joint& joint, const SolvedStates& result);
// facets.cpp
Findings long_facets(const JointModel& model, const Joint& joint);
Findings few_springs(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings crowded_force(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings smeared_map(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings narrow_contact(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings incomplete_map(const JointModel& model, const Joint& joint, const SolvedStates& result);
// edges.cpp
Findings force_at_edge(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings pressed_selection(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings pressed_bare_rim(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings cut_face(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings shear_at_edge(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings uneven_neighbours(const JointModel& model, const Joint& joint, const SolvedStates& result);
// outcome.cpp
Findings no_solution(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings unstable_balance(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings held_motion(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings nothing_loads(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings unloaded_contact(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings passed_surfaces(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings never_touching(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings tiny_load(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings large_turn(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings far_travel(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings without_effect(const JointModel& model, const Joint& joint, const SolvedStates& result);

inline Subject at_state(const ContactPair& pair, const StateResult& state) {
  return {.contact = pair.name, .time = state.when.time};
}
/// The last state, whose maps stand for all; nullptr: it is no solution, or nothing presses in it.
const StateResult* judged_state(const Joint& joint, const SolvedStates& result);
/// Nothing presses a free body, and the surfaces have parted: no forces but such as are none against the cartilage's
/// modulus.
bool parted(const Joint& joint, const StateResult& state);

}  // namespace dea

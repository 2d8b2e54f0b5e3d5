// src/rules/look.h – the rules that look, one function each; rules.cpp lists them with their words.
#pragma once
#include <optional>

#include "src/base/finding.h"
#include "src/base/unit_names.h"
#include "src/joint/joint.h"
#include "src/results/solved_states.h"

namespace dea {

// units.cpp
/// The modulus in MPa, if these units make one of it that no cartilage has; nullopt: it may be one, or the units are
/// none of FEBio's.
std::optional<double> odd_modulus(double E, const UnitNames& units);
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
Findings strained_parts(const JointModel& model, const Joint& joint, const SolvedStates& result);
// facets.cpp
Findings long_facets(const JointModel& model, const Joint& joint);
Findings few_springs(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings crowded_force(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings smeared_map(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings narrow_contact(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings incomplete_map(const JointModel& model, const Joint& joint, const SolvedStates& result);
// edges.cpp
/// What of a surface's force presses it within one mean thickness of free edges of its layer.
struct ForceAtEdges {
  double share = 0.0;
  double wall = 0.0;  ///< by how much the surface turns there into the side wall [rad], mean over this force
};
ForceAtEdges force_at_edges(const Layer& layer, const std::vector<double>& pressure);
Findings force_at_edge(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings pressed_selection(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings pressed_bare_rim(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings cut_face(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings shear_at_edge(const JointModel& model, const Joint& joint, const SolvedStates& result);
// population.cpp
Findings contacts_like_this(const JointModel& model, const Joint& joint, const SolvedStates& result);
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

/// A contact in the last state, whose maps stand for all states.
struct JudgedContact {
  const ContactPair& pair;
  const StateResult& state;
  const ContactStatistics& statistics;
  const ContactFields& fields;
  Subject subject() const { return {.contact = pair.name, .time = state.when.time}; }
  Subject subject(const JointModel& model, const Layer& layer) const;  ///< with its surface
};
/// All contacts; none where the last state is no solution.
std::vector<JudgedContact> judged_contacts(const Joint& joint, const SolvedStates& result);

/// One side of a judged contact.
struct JudgedSide {
  const ContactStatistics& statistics;  ///< of the contact
  const SideFields& fields;
  int side;
  const Layer &layer, &partner;
  Subject subject;  ///< with the layer's surface
};
std::vector<JudgedSide> judged_sides(const JointModel& model, const Joint& joint, const SolvedStates& result);

/// Does nothing load a free body, and nothing press it? No forces but such as are none against `stiffest`.
bool parted(const Equilibrium& e, double stiffest);

}  // namespace dea

// src/results/solved_states.h – what was solved of one joint under one set of loads.
#pragma once
#include <algorithm>
#include <vector>

#include "src/base/finding.h"
#include "src/equilibrium/equilibrium.h"
#include "src/equilibrium/times.h"
#include "src/results/fields.h"
#include "src/results/inside_fields.h"
#include "src/results/part_results.h"
#include "src/results/statistics.h"

namespace dea {

struct StateResult {
  TimePoint when;
  Equilibrium equilibrium;
  std::vector<ContactFields> fields;          ///< one per contact
  std::vector<ContactStatistics> statistics;  ///< one per contact
  std::vector<LayerStatistics> layers;        ///< one per shared layer of the joint
  std::vector<PartStress> parts;              ///< one per deformable part of the joint
  std::vector<Vector3d> displacements;        ///< one per model node
  std::vector<InsideDomain> inside;           ///< of deformable solid elements; empty: not asked for
};

struct SolvedStates {
  std::vector<StateResult> states;  ///< those that were kept, in order of time
  std::vector<Pose> start;          ///< per body: where it began
  std::vector<char> free_to_turn;   ///< per body: about some axis, in the last state that was kept
  std::vector<char> free_to_move;   ///< per body: along some axis, in that state
  Findings idle;                    ///< settings and loads that have no effect (rules/idle_loads.h)
};

/// Is it an answer? Of the result's states: one on the way that nothing loads does no harm, as the last it is none.
inline bool is_answer(const SolvedStates& result, const StateResult& state) {
  const Outcome outcome = state.equilibrium.outcome;
  return solved(outcome) || (outcome == Outcome::NoContact && &state != &result.states.back());
}

/// Every state is an answer.
inline bool all_solved(const SolvedStates& result) {
  return std::all_of(result.states.begin(), result.states.end(),
                     [&](const StateResult& state) { return is_answer(result, state); });
}

}  // namespace dea

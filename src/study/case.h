// src/study/case.h – what a solved case leaves: numbers, not meshes.
#pragma once
#include <string>
#include <vector>

#include "src/base/finding.h"
#include "src/equilibrium/equilibrium.h"
#include "src/results/part_results.h"
#include "src/results/statistics.h"

namespace dea {

/// Of a contact: names as `dea run` prints them.
struct CaseContact {
  std::string name, source, target;
  std::vector<std::string> parts;  ///< compartments; empty: the surface is in one piece
};

struct CaseState {
  double time = 0.0;
  Outcome outcome = Outcome::NotConverged;
  std::string message;  ///< the numbers behind the outcome
  int iterations = 0;
  double residual_force = 0.0, residual_moment = 0.0;  ///< NaN: nothing free
  std::vector<ContactStatistics> statistics;           ///< one per contact
  std::vector<LayerStatistics> layers;                 ///< one per shared layer of the joint, without its map
  std::vector<PartStress> parts;                       ///< one per part that gives way, without its elements
  std::vector<Pose> poses;                             ///< one per body
  std::vector<Vector6> reactions;                      ///< one per body (Equilibrium::reaction)
  /// Nodal pressures of the surface with springs, for maps: one list per contact, where they are kept. In single
  /// precision, as plot files hold them.
  std::vector<std::vector<float>> fields;
};

/// A surface that pressures stand on, in the reference configuration, the model's frame.
struct CaseSurface {
  std::string name;
  std::vector<Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
};

struct CaseResult {
  std::size_t number = 0;  ///< from 1
  enum class Outcome : char {
    Solved,  ///< every state that was asked for is a solution
    Failed,  ///< some state is none
    Refused  ///< `message`: why it could not be read or begun
  };
  Outcome outcome = Outcome::Refused;
  std::string message;  ///< one line; empty when solved
  Findings warnings;
  std::vector<CaseContact> contacts;
  std::vector<std::string> layers;    ///< names of layers that several contacts press
  std::vector<std::string> parts;     ///< names of those that give way
  std::vector<std::string> bodies;    ///< names; the ground among them
  std::vector<CaseSurface> surfaces;  ///< one per contact, where fields are kept: of this model's first case only
  std::vector<CaseState> states;
  double seconds = 0.0;
};

struct ReadyJoint;
struct SolvedStates;

/// Adds what is left of the states that were solved of a joint, and what is to be known of both. `keep_fields`: with
/// CaseState::fields and CaseResult::surfaces. `wording`: of outcomes.
void add_states(const ReadyJoint& joint, SolvedStates&& solved, bool keep_fields, const Wording& wording,
                CaseResult& result);

}  // namespace dea

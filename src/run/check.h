// src/run/check.h – what was recognised in a model, before anything is solved.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "src/equilibrium/equilibrium.h"
#include "src/equilibrium/load_case.h"
#include "src/equilibrium/times.h"
#include "src/results/fields.h"
#include "src/run/recognise.h"

namespace dea {

/// One side of a contact as found.
struct SideCheck {
  SphereFit sphere;         ///< least-squares sphere of the articular surface
  double area = 0.0;        ///< of the articular surface, reference
  bool whole_face = false;  ///< `rim` is known: a layer whose springs stand on the articular surface
  RimLengths rim;
  int side_walls = 0, bonded = 0;  ///< facets left out
};

/// The springs of one contact at the reference poses.
struct ContactCheck {
  SideCheck sides[2];
  int springs = 0, springs_hit = 0;                       ///< cast; of these, over the target
  double gap_min = 0.0, gap_median = 0.0, gap_max = 0.0;  ///< of those that hit; NaN: none did
  double gap_p5 = 0.0;
};

/// Conditions at the end of one step of the model's own.
struct StepCheck {
  std::string name;
  double start = 0.0, end = 0.0, step_size = 0.0;
  int states = 0;  ///< of this step that `dea run` solves, without rows of tables
  LoadCase load_case;
};

/// Everything up to the point where something failed.
struct JointCheck {
  bool recognised = false;  ///< joint, start, springs, contacts are filled
  Joint joint;
  std::vector<Pose> start;            ///< one per body: where it is placed
  std::vector<SpringStates> springs;  ///< one per contact, there: gaps, not pressures
  std::vector<ContactCheck> contacts;
  std::vector<StepCheck> steps;  ///< empty: conditions could not be made
  /// What holds, moves and loads the bodies in every row of the tables of loads and motion, without what the rows
  /// themselves say: their loads are 0, and prescribed values of the body that a table moves are those of the first
  /// row. nullopt: there are no tables, or there are errors.
  std::optional<LoadCase> row;
  std::vector<TimePoint> times;  ///< of the states that `dea run` shows: of the rows, where there are tables
  std::vector<Fault> errors;     ///< why `dea run` would refuse this model, the most basic first
};

/// Never throws InputError: what was found is in `errors`.
JointCheck check_joint(const Recognition& recognition);
/// The same with the beds that an analysis of this recognition has made.
JointCheck check_joint(const Recognition& recognition, const std::vector<SpringBed>& beds);
/// The fields of all contacts where the bodies are placed, without pressures.
std::vector<ContactFields> fields_at_start(const JointCheck& check, const FieldMaps& maps);

}  // namespace dea

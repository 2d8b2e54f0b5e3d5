// src/run/analysis.h – the whole method, from model to results: read this first.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "src/equilibrium/equilibrium.h"
#include "src/equilibrium/load_case.h"
#include "src/equilibrium/times.h"
#include "src/joint/joint.h"
#include "src/results/solved_states.h"
#include "src/run/prepared.h"
#include "src/run/recognise.h"

namespace dea {

struct Analysis : SolvedStates {
  Joint joint;
  SpringBeds beds;  ///< that were used, for whoever looks at more poses
  FieldMaps maps;
  Findings findings;           ///< all that is to be known of the joint and its results, what matters most first
  double seconds_joint = 0.0;  ///< recognition and springs
  double seconds_solve = 0.0;  ///< equilibria and fields
};

/// What an analysis is at, told when it begins; of a state also before each pose that is tried.
struct Activity {
  enum class Stage {
    Joint,    ///< recognition and thickness
    Springs,  ///< their places; law layer: the layers' matrices
    State
  };
  Stage stage = Stage::Joint;
  std::size_t index = 0, count = 0;  ///< of states
  SearchStatus search;
};

/// A solution from which the search for another may start.
struct KnownBalance {
  std::vector<Pose> poses;          ///< one per body
  std::vector<PressMemory> memory;  ///< one per group of contacts (SpringBeds)
};

struct AnalysisOptions {
  std::vector<TimePoint> times;  ///< states to solve in order; empty: model_times(model)
  std::vector<char> keep_state;  ///< per time: its result with its fields; empty: all
  bool keep_fields = true;  ///< false: of all kept states but the last, fields and displacements go once `progress` has
                            ///< seen them; SideFields keep their numbers of the whole surface
  std::function<void(const StateResult&, std::size_t index, std::size_t count)>
      progress;                                   ///< after every state; may be empty
  std::function<void(const Activity&)> activity;  ///< may be empty; changes nothing
  EquilibriumOptions equilibrium;
  Findings found_before;      ///< what the caller found as it chose the states: among Analysis::findings
  bool displacements = true;  ///< StateResult::displacements are wanted
  /// Not owned: of the same joint, whose inside is wanted with the fields; nullptr: it is not. `analyse` makes it
  /// itself where the settings ask for it.
  const InsideMaps* inside = nullptr;
  /// Not owned: from where the first state that is solved is searched, if that belongs to the last step, is not the
  /// reference, and no body is free to turn (else there may be several balances, and the search's start chooses among
  /// them). Its free dofs count, of bodies that are not placed. A state that is not solved or not stable from there is
  /// searched from the starting poses, as without it.
  std::function<const KnownBalance*()> known_balance;
  /// known_balance counts in every step, and of bodies that are free to turn or placed, too: answers follow a hand, and
  /// where there are several balances they may stay at another than a search from the start finds.
  bool follow = false;
  /// Not owned: gets where the last state's search for pressures ended, for KnownBalance::memory of the next analysis
  /// of the same joint; nullptr: it is not wanted.
  std::vector<PressMemory>* memory = nullptr;
};

/// Fills fields, statistics and, unless `inside` is null, the inside of a state whose equilibrium has its springs.
void add_fields(const Prepared& prepared, const FieldMaps& maps, const InsideMaps* inside, StateResult& state);

/// The states of options.times, each started from the one before. `prepared`: of `model` and joint_settings(settings);
/// `settings` have passed check_loading. InputError: a fault that is met while solving. Stopped:
/// options.equilibrium.stop was set. Pure: several threads may solve one joint at a time.
SolvedStates solve_states(const JointModel& model, const Settings& settings, const Prepared& prepared,
                          const FieldMaps& maps, const AnalysisOptions& options);

/// Cartilage of no thickness cannot be compressed: InputError where such surfaces meet in this state, not a division.
void refuse_zero_thickness(const JointModel& model, const Joint& joint, const SpringBeds& beds, const Equilibrium& e);

/// Half a joint is solved only where its bodies keep to its planes of symmetry: InputError where they do not.
/// `time`: told, if there is one.
void refuse_left_planes(const JointModel& model, const Joint& joint, const std::vector<Pose>& poses,
                        std::optional<double> time);

/// Joint, springs, equilibrium of every load case in order of time (each started from the one before), fields.
/// The first state (time 0) is the reference configuration, not solved, as in FEBio's plot files.
/// InputError: the recognition has faults, or one is met while solving. Stopped: options.equilibrium.stop was set.
Analysis analyse(const Recognition& recognition, const AnalysisOptions& options = {});
/// The same from the start.
Analysis analyse(const JointModel& model, const Settings& settings, const AnalysisOptions& options = {});

}  // namespace dea

// views/text/run_text.h – results as tables on the screen.
#pragma once
#include <string>
#include <vector>

#include "src/run/analysis.h"
#include "src/run/convergence.h"
#include "views/text/table.h"

namespace dea {

/// The states' contacts with the headline numbers (`details`: then all others, each named in full), then bodies,
/// ligaments and joints in the last state.
std::vector<TitledTable> run_tables(const Analysis& analysis, bool details, const UnitNames& units);
/// Units, laws and what the numbers are of, then these tables.
std::string run_text(const JointModel& model, const Analysis& analysis, bool details);

std::string converge_text(const JointModel& model, const std::vector<Convergence>& studies, int max_springs);

/// All bodies, without a ground that nothing is attached to.
std::vector<int> reported_bodies(const Joint& joint);
/// Of ligaments, then of cables; "(unnamed)", and numbered where there are several of one name: "acl", "acl (2)".
std::vector<std::string> spring_names(const Joint& joint);

/// "units: mm-N-s" or a sentence that they are the model's.
std::string units_text(const JointModel& model);
/// " mm", where units are known.
std::string unit_behind(const JointModel& model, Dimension dimension);

}  // namespace dea

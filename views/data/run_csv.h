// views/data/run_csv.h – results of a run as CSV. Undefined numbers are empty.
#pragma once
#include <string>

#include "src/run/analysis.h"

namespace dea {

/// One line per wanted state and contact, under a line of names. The words of all warnings stand in the first line
/// alone; each line has the codes of those that are of its contact, or of none.
std::string run_csv(const Analysis& analysis);

/// One line per wanted state, contact and compartment, under a line of names; contacts of surfaces in one piece have
/// none.
std::string compartments_csv(const Analysis& analysis);

/// One line per wanted state, contact, side (primary, secondary) and facet of its surface, under a line of names.
/// Facets count from 1 in the model's surface. `area` and `reference_x,y,z` (centroid): of the facet's triangles in the
/// reference configuration; `x,y,z`: that centroid moved with the surface's body, not compressed; `thickness`: mean
/// over the facet. The rest: SideFields.
std::string facets_csv(const JointModel& model, const Analysis& analysis);
/// The same in pieces: the line of names, and the lines of a state. `inside`: with the inside of layers, as has_inside
/// says of any of the states.
std::string facets_csv_names(bool inside);
std::string facets_csv_lines(const JointModel& model, const Joint& joint, const StateResult& state, bool inside);
/// Was the inside of the layers asked for, and has one of the state's contacts numbers of it?
bool has_inside(const StateResult& state);

}  // namespace dea

// app/build_standing.h – where the bones of `dea build` stand, and what frees, holds, moves and joins them: --place,
// --free, --hold, --motion, --ligaments, and the tables of --loads and --motion.
#pragma once
#include <string>
#include <vector>

#include "app/build_inputs.h"
#include "src/base/finding.h"

namespace dea {

/// The options, after those of forces: what contradicts itself or names no bone is refused before anything is read.
void add_standing(const BuildArguments& arguments, BuildInputs& inputs);

/// Reads where bones stand, and the ligaments between them. Returns what was found. Throws InputError, UsageError.
std::vector<std::string> read_placements(const BuildArguments& arguments, BuildInputs& inputs);

/// Reads the tables of loads and motion into the request, in N, mm and rad. Returns what was found. Throws InputError,
/// UsageError.
std::vector<std::string> read_loads(BuildInputs& inputs);

/// Tables of 4x4 matrices that may be in metres, against the size of the bones that were read.
Findings doubtful_matrices(const BuildInputs& inputs);

/// Forces along directions in which their bone is held or moved reach no cartilage: what is to be told of them. Throws
/// UsageError: nothing else is left.
std::vector<std::string> held_forces(const BuildRequest& request);

}  // namespace dea

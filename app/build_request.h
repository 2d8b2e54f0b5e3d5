// app/build_request.h – what `dea build` is asked for, from its options and the files they name.
#pragma once
#include <string>
#include <vector>

#include "app/build_inputs.h"

namespace dea {

/// All but the surfaces: options that contradict each other or name no bone are refused before anything is read.
BuildInputs build_inputs(const BuildArguments& arguments);

/// Reads, scales, mends and places all surfaces into the request, and reads the landmarks. Returns what was found.
/// Throws InputError.
std::vector<std::string> read_surfaces(const BuildArguments& arguments, BuildInputs& inputs);

}  // namespace dea

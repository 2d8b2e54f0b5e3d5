// febiodea/app/build_request.h – what `dea build` is asked for, from its options and the files they name.
#pragma once
#include <string>
#include <vector>

#include <febiodea/app/commands.h>
#include <febiodea/build/anatomy.h>
#include <febiodea/build/build_joint.h>
#include <febiodea/io/files/output.h>

namespace dea {

struct BuildInputs {
  BuildRequest request;
  BuiltModelSettings model;
  AnatomyRequest anatomy;
  std::vector<NamedPath> files;
  std::vector<double> load_times;  ///< of --loads, per row; empty: none
};

/// All but the surfaces: options that contradict each other or name no bone are refused before anything is read.
BuildInputs build_inputs(const BuildArguments& arguments);

/// Reads the table of loads into the request, in N. Returns what was found. Throws InputError, UsageError.
std::vector<std::string> read_loads(const BuildArguments& arguments, BuildInputs& inputs);

/// Reads, scales and mends all surfaces into the request, and reads the landmarks. Returns what was found. Throws
/// InputError.
std::vector<std::string> read_surfaces(const BuildArguments& arguments, BuildInputs& inputs);

}  // namespace dea

// io/study/study_columns.h – a study's results as columns, for programs that read few of them at a time.
#pragma once
#include <string>

namespace dea {

/// Throws UsageError: this program is made without HDF5.
void check_columns_possible();

/// Writes what a study's file holds as HDF5, in the layout of netCDF-4 (docs/studies.md): every number is the one in the
/// file. `path` is complete, or as it was before. Throws InputError, of the study; WriteError.
void write_study_columns(const std::string& study, const std::string& path);

}  // namespace dea

// app/study_reading.h – what `dea study` does beside solving, and what it tells at the end.
#pragma once
#include <string>
#include <vector>

#include "app/commands.h"
#include "io/files/output.h"
#include "io/study/read_study.h"

namespace dea {

/// "1 case", "2 cases".
std::string plural(std::size_t n, const char* word);

/// Throws UsageError: HDF5 is asked for, and this program or that place has none.
void check_columns(const StudyArguments& arguments);

/// The CSV, the columns and the page, as far as they are asked for.
std::vector<NamedPath> written_beside(const StudyArguments& arguments);

/// Writes them and tells how the study ended; the exit code. `summary`: of what was solved; empty: nothing was.
int end_study(const StudyHead& head, const StudyArguments& arguments, const std::string& summary);

/// The counts or the CSV of a file; exit code.
int read_study(const StudyArguments& arguments, const std::string& path);

/// --merge; exit code.
int merge_shards(const StudyArguments& arguments);

}  // namespace dea

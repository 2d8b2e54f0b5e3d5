// app/study_reading.h – what `dea study` does beside solving, and what it tells at the end.
#pragma once
#include <string>

#include "app/commands.h"

namespace dea {

/// "1 case", "2 cases".
std::string plural(std::size_t n, const char* word);

/// Writes the CSV that was asked for and tells how the study ended; the exit code.
int end_study(const std::string& path, const StudyArguments& arguments, const std::string& summary);

/// The counts or the CSV of a file; exit code.
int read_study(const StudyArguments& arguments, const std::string& path);

/// --merge; exit code.
int merge_shards(const StudyArguments& arguments);

}  // namespace dea

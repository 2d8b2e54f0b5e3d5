// views/study_page/study_page.h – a study as one HTML file that needs nothing else (docs/studies.md, "The
// page").
//
// All statistics are those of src/study; the page chooses among them and draws.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "views/study_page/study_maps.h"

namespace dea {

/// How options are called where one of them is at fault: by the command line's names, or by Python's.
struct StudyPageWords {
  std::string group = "--group", pair = "--pair", pair_by = "--pair-by", cycle_seconds = "--cycle-seconds";
};

struct StudyPageOptions {
  std::string group;                  ///< column whose values are groups; empty: none
  std::string pair;                   ///< "COLUMN" or "COLUMN=A,B"; empty: none
  std::string pair_by;                ///< column of `subjects` that partners share (study_pairs); empty: all
  std::optional<CaseTable> subjects;  ///< columns for group and pair (add_subjects)
  StudyMapOptions maps;
  StudyPageWords names;
  std::vector<std::string> words;  ///< the command, for the page
};

/// read_study_numbers, with the columns of a table, if there is one. Throws InputError.
StudyNumbers study_numbers_with(const std::string& study, const std::optional<CaseTable>& subjects);

/// Writes the page of a study's file, which is only read. Throws InputError, UsageError (a column that is not there),
/// WriteError. What was thinned, a line each.
std::vector<std::string> write_study_page(const std::string& path, const std::string& study,
                                          const StudyPageOptions& options);

}  // namespace dea

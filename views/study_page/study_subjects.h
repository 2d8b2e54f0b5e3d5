// views/study_page/study_subjects.h – what a table tells of a study's models, cases or values of a factor,
// such as subject, sex, side, before or after: columns that groups and pairs are made by. No case depends on them.
#pragma once
#include "src/study/plan.h"
#include "views/study_page/study_numbers.h"

namespace dea {

/// Adds the table's columns behind those of the study. One of its columns says what a row is of: "model" (a path, or as
/// much of its end as tells it from the others, without ".feb" if you like), "case_id", or a factor's name; each model,
/// case or value of the study has one row. Numbers of levels and the study's grid stay as they are. Throws InputError,
/// which names the row.
void add_subjects(const CaseTable& table, StudyNumbers& numbers);

/// Which of a table's columns says what its rows are of, and which it adds.
struct SubjectColumns {
  std::size_t key = 0;              ///< index in CaseTable::names
  std::vector<std::size_t> others;  ///< the same, of the rest
};
/// `factors`: of the study. Throws InputError: there is no column of the one or the other kind, or several keys.
SubjectColumns subject_columns(const CaseTable& table, const std::vector<Factor>& factors);

}  // namespace dea

// views/study_page/study_json.h – a study's numbers and statistics as the JSON of its page.
#pragma once
#include "views/page/page_parts.h"
#include "views/study_page/study_numbers.h"
#include "views/study_page/study_statistics.h"

namespace dea {

/// The cases whose numbers are on the page: all, or some of too many (thinned_cases).
struct ShownCases {
  std::vector<std::size_t> cases;  ///< indices in StudyNumbers::cases, rising
  std::vector<int> place;          ///< per case: its place in `cases`; -1: not shown
  bool all = true;
};
ShownCases shown_cases(const StudyNumbers& numbers);

/// "3, 7-9 and 12 more" of case numbers that rise.
std::string case_ranges(const std::vector<std::size_t>& numbers);

/// What the study is: file, options, models, factors, counts.
Json study_head_json(const StudyNumbers& numbers);
/// Cases and states that are no solution, by their reason; warnings by their text.
Json failures_json(const StudyNumbers& numbers, const std::vector<StudyWarning>& warnings);
/// Columns, places, choices, and the numbers of the shown cases.
void add_numbers(const StudyNumbers& numbers, const ShownCases& shown, Json& page, PageArrays& arrays);
/// Box-plot numbers of all cases.
Json headline_table_json(const StudyNumbers& numbers);
/// Lines of some cases over the cycle, bands of all, and of the levels of each column with few.
Json bands_json(const StudyNumbers& numbers, const ShownCases& shown, PageArrays& arrays);
Json influence_json(const StudyNumbers& numbers);
/// null: not asked for.
Json groups_json(const StudyNumbers& numbers, int column);
Json pairs_json(const StudyNumbers& numbers, const StudyPairs& pairs, const ShownCases& shown);

}  // namespace dea

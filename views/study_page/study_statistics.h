// views/study_page/study_statistics.h – what src/study says of a study's numbers: which factors matter,
// groups, pairs, bands over the cycle. Each of one statistic, at one place, of one choice of states (StudyNumbers).
#pragma once
#include <string>
#include <vector>

#include "src/study/influence.h"
#include "views/page/page_parts.h"
#include "views/study_page/study_numbers.h"

namespace dea {

/// How a study was drawn, as far as statistics depend on it.
struct StudyDesign {
  std::vector<int> numeric;           ///< columns that are numbers, those of a table too
  int saltelli = 0;                   ///< factors of a Saltelli design; 0: it is none
  std::vector<int> saltelli_columns;  ///< per factor of it: its column; -1: it does not vary
  int base = -1;                      ///< case that one-at-a-time slopes are taken about; -1: none has neighbours
  std::string no_sobol, no_slopes;    ///< why there are none
};
/// The base: of a grid the case in its middle, the lower of two; else of those from which most cases differ in one own
/// column only the one nearest the middle of all columns' values, the first of several.
StudyDesign study_design(const StudyNumbers& numbers);

/// Of one statistic, place and choice: box-plot numbers; which columns of the design it depends on; levels of a column
/// as groups, each but the first less the first; two numbers of the same cases, first less second. Undefined: null.
Json box_json(const BoxPlot& box);
Json influence_json(const StudyNumbers& numbers, const StudyDesign& design, const std::vector<double>& outputs,
                    const Bootstrap& bootstrap);
Json difference_json(const std::vector<double>& first, const std::vector<double>& second);
Json group_json(const StudyNumbers& numbers, const StudyColumn& column, const std::vector<double>& outputs);
Json pair_json(const std::vector<double>& first, const std::vector<double>& second);

/// Two levels of a column as pairs: cases that differ in nothing else. Of a table's column (study_subjects.h) nothing
/// else are all other own columns but the one that the table's rows are of, and all other columns of the table.
struct StudyPairs {
  int column = -1;
  int first = 0, second = 1;              ///< levels
  std::vector<std::array<int, 2>> cases;  ///< indices of each pair
  std::size_t alone = 0;                  ///< cases of the two levels without a partner
};
/// `text`: "COLUMN", of two levels, or "COLUMN=A,B"; numbers may be written otherwise than in the study. `by`: of a
/// table's columns partners must be alike in this one alone; empty: in all. Throws UsageError, which begins with
/// `option`, or `by_option` where `by` is at fault.
StudyPairs study_pairs(const StudyNumbers& numbers, const std::string& option, const std::string& text,
                       const std::string& by_option = "", const std::string& by = "");
/// The column of this name that varies. Throws UsageError.
int study_column(const StudyNumbers& numbers, const std::string& option, const std::string& name);

Json pair_json(const StudyPairs& pairs, const std::vector<double>& outputs);

/// The instants that cycles are shown at: the states' own times where all cases share them, else percent of each
/// cycle, linear between its states. Empty: there is no cycle.
struct StudyInstants {
  bool percent = false;
  std::vector<double> instants;
};
StudyInstants study_instants(const StudyNumbers& numbers);
/// A line per case of `cases`, over the instants; NaN where the case has no number.
std::vector<std::vector<double>> study_lines(const StudyNumbers& numbers, const StudyInstants& instants,
                                             std::size_t statistic, std::size_t place,
                                             const std::vector<std::size_t>& cases);

}  // namespace dea

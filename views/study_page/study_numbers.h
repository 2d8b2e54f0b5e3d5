// views/study_page/study_numbers.h – a study's numbers as arrays: what is asked of all cases together begins
// here.
//
// A number of a state that is no solution is NaN, whatever the file has: it is that of a failed case everywhere below.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "io/study/read_study.h"
#include "src/base/unit_names.h"

namespace dea {

/// A number that a study is looked at by.
struct StudyStatistic {
  std::string name;       ///< of the column: "headline_p99"
  std::string title;      ///< "99th percentile of pressure"
  std::string quantity;   ///< of an axis: "p99"
  std::string dimension;  ///< "pressure", "area", "force", "none"
  bool compression =
      false;  ///< below 0, and larger the farther below: the largest of all states is then the least value
};
/// p99, mean, area, peak of the headline, and the size of the contact's force ("force"): every study and every place
/// has these.
const std::vector<StudyStatistic>& headline_statistics();

/// What differs from case to case: "model", where there are several, the factors, and what a table tells of them
/// (study_subjects.h).
struct StudyColumn {
  std::string name;
  std::string of;                   ///< of a table: the column that its rows are of; empty: the study's own
  std::string dimension;            ///< of the numbers: "degrees", "length", "pressure", "force"; empty: unknown
  bool numeric = false;             ///< every value is a number
  std::vector<std::string> levels;  ///< different values; numbers rise, words in the order of cases
  std::vector<double> numbers;      ///< per level; words: 0, 1, 2, ...
  std::vector<int> level;           ///< per case: index
  /// Index of a level; numbers are compared as numbers: 8 is 8.0. -1: there is none.
  int find(const std::string& text) const;
  /// Indices of the cases of each level.
  std::vector<std::vector<std::size_t>> cases() const;
  /// Number of the level, per case.
  std::vector<double> values() const;
};

struct StudyNumbers {
  StudyHead head;
  UnitNames units;
  std::string time_name = "time";    ///< what states are counted in, by a table of loads or motion: "cycle [%]"
  std::vector<StudyCase> cases;      ///< those that are there, by their numbers
  std::vector<StudyColumn> columns;  ///< that vary: the study's own, those of a table behind them
  std::vector<StudyColumn> constant;
  bool grid =
      false;  ///< every combination of own columns' levels is a case at most once, and more than half of them are
  /// headline_statistics; with --inside those of the layers' insides that some contact has.
  std::vector<StudyStatistic> statistics;
  std::vector<StudyPlace> places;
  std::size_t states = 0;                      ///< most of any case
  bool same_times = true;                      ///< all cases have the states' times
  std::vector<double> times;                   ///< of the states, where all cases have the same
  std::vector<std::vector<double>> own_times;  ///< per case: its states' times
  std::vector<StudyState> unsolved;            ///< states that are no solution
  std::vector<char> complete;                  ///< per case: it has states, and all are solutions
  /// Per statistic and place: cases x choices(), one case after the other.
  std::vector<std::vector<std::vector<double>>> values;

  /// What may be looked at of a case: each state and, behind them where there are several, the largest of all states.
  std::size_t choices() const { return states > 1 ? states + 1 : states; }
  double value(std::size_t statistic, std::size_t place, std::size_t c, std::size_t choice) const {
    return values[statistic][place][c * choices() + choice];
  }
  /// How many of `columns` are the study's own.
  std::size_t own_columns() const;
  /// Of all cases.
  std::vector<double> outputs(std::size_t statistic, std::size_t place, std::size_t choice) const;
  /// Index of the case of this number; -1: none, as where another program has added it since.
  int case_of(double number) const;
  /// -1: there is no such column that varies.
  int column(const std::string& name) const;
};

/// Is this the word of a state that is a solution?
bool is_solution(const std::string& outcome);

/// The value of an option that the study was made with; empty: it is not there.
std::string option_of(const StudyHead& head, const std::string& option);

std::optional<double> number_in(const std::string& text);

/// A column of these values, one per case. Numbers that are equal are one level, however they are written.
StudyColumn make_column(const std::string& name, const std::vector<std::string>& texts);

/// Each path without the folders that it does not need to be told from the others: "hip.feb", or "left/hip.feb" beside
/// "right/hip.feb".
std::vector<std::string> short_names(const std::vector<std::string>& paths);

/// Fills the last of a case's choices: the largest of all its states. A state without contact, which is a solution and
/// has no pressures, does not count; NaN where a state is no solution: then no largest is known.
void add_largest(StudyNumbers& numbers);

/// Throws InputError; a study without a single case too. Units: of `--units` among the study's options, else of its
/// first model, where that is there as it was; else none are claimed.
StudyNumbers read_study_numbers(const std::string& path);

/// Flags of cases, of those that `may` be taken, such that `fits`. Of a grid every second level goes, of the factor
/// that has most of them, its ends stay, again and again: what is left is a grid. Of other studies, and where that is
/// not enough, one case in 2, 4, ... is left.
std::vector<char> thinned_cases(const StudyNumbers& numbers, const std::vector<char>& may,
                                const std::function<bool(const std::vector<char>& kept)>& fits);

}  // namespace dea

// io/tables/table_columns.h – which columns of a table are a vector, what unit their names say, and their
// numbers.
#pragma once
#include <Eigen/Core>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "io/tables/table.h"
#include "src/base/sentence.h"

namespace dea {

/// All names, "a", "b" and "c", for a message; those most like `word` first.
std::string named_columns(const NumberTable& table, const std::string& word = "");

/// A column's name without its unit, in small letters: "Fx [N]" is "fx".
std::string bare_name(const std::string& name);

/// Columns whose bare names are one of these or end in "_" and one of these.
std::vector<int> like(const NumberTable& table, const std::vector<std::string>& words);

/// Three columns by the words for their x, y, z; all -1: none of them is there. InputError: one or two of them are, or
/// several may be the same. `setting` names the columns, `what` is the vector, both for the message.
std::array<int, 3> vector_columns(const NumberTable& table, const char* setting, const char* what,
                                  const std::array<std::vector<std::string>, 3>& words);

/// Three or six columns by the names given, "Fx,Fy,Fz". UsageError: a name that is not there or stands twice, or
/// another count.
std::vector<int> given_columns(const NumberTable& table, const char* setting, const std::string& names);

/// What to do about a column whose name says this unit, in small letters: "kn", "%bw".
using UnitRemedy = std::function<Sentence(const std::string& unit)>;

/// InputError: a column, of the three from `first` on, whose name says a unit of `known` other than `expected` ("n",
/// "nm").
void refuse_other_units(const NumberTable& table, const std::vector<int>& columns, std::size_t first,
                        const std::string& expected, const std::vector<std::string>& known, const UnitRemedy& remedy);

/// Does one of the three columns from `first` on say a unit of `known`?
bool name_says_unit(const NumberTable& table, const std::vector<int>& columns, std::size_t first,
                    const std::vector<std::string>& known);

/// Units that a column's name may say.
std::vector<std::string> force_words();
std::vector<std::string> length_words();
std::vector<std::string> angle_words();
std::vector<std::string> moment_words();  ///< "nm", "nmm", ...

/// Before and behind the dash of "N-m", or of the model's system; empty: nobody knows.
std::array<std::string, 2> units_taken(const std::string& units, const std::string& first, const std::string& length);

/// The column of the rows' times; -1: there is none.
int time_column(const NumberTable& table);

/// Rising times of the rows; without a column of times: 1, 2, 3, ... InputError: they do not rise.
std::vector<double> times_of(const NumberTable& table);

/// "Fx, Fy, Fz".
std::string column_names(const NumberTable& table, const std::vector<int>& columns);

/// "loads.csv: 13 rows, time 0 to 1, columns Fx, Fy, Fz"; `columns` in words. Rows beyond those that its header counts
/// are told.
std::string table_in_words(const NumberTable& table, const std::string& columns, const std::vector<double>& times);

/// The numbers in these columns, a vector per row; zero behind the last column.
std::vector<Eigen::Matrix<double, 6, 1>> values_of(const NumberTable& table, const std::vector<int>& columns);

}  // namespace dea

// io/tables/table.h – cells or numbers in columns with names: CSV, and OpenSim's .sto and .mot.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "src/base/error.h"
#include "src/study/plan.h"

namespace dea {

template <class Cell>
struct TableOf {
  std::string path;
  bool opensim = false;                 ///< .sto or .mot: has a header that ends in "endheader"
  std::optional<bool> degrees;          ///< of its header: inDegrees=yes or no; empty: it does not say
  std::string axes;                     ///< .fcsv: LPS or RAS, as its header says; else empty
  std::optional<int> counted;           ///< rows, as its header says, where there are more of them
  int names_line = 0;                   ///< of the file, 1-based
  std::vector<std::string> names;       ///< of the columns, without white space around them
  std::vector<std::vector<Cell>> rows;  ///< as many cells each as there are names, not in quotes any more
  std::vector<int> lines;               ///< of the rows in the file, 1-based
};
using TextTable = TableOf<std::string>;
using NumberTable = TableOf<double>;

/// CSV: a line of names, then a line of cells per row, separated by commas, semicolons, tabs or spaces; lines that
/// begin with '#' and empty ones are passed over. OpenSim: what stands before "endheader", then the same with white
/// space. Slicer's .fcsv: its line "# columns = " has the names. Throws InputError ("loads.csv:12: found ..., expected
/// ...").
TextTable read_text_table(const std::string& path);

/// The same of numbers; each column has a name.
NumberTable read_table(const std::string& path);

/// The same of numbers in memory; `path` is what messages call it, and a row's line its number from 1 on. Throws
/// InputError.
NumberTable make_table(const std::string& path, const std::vector<std::string>& names,
                       const std::vector<std::vector<double>>& rows);

/// A table of cases, without the columns that R, pandas and Dakota put before the factors: rows' own names or numbers.
/// Throws InputError.
CaseTable read_case_table(const std::string& path);

/// The column of this name, whatever its letters' case; -1: none.
int find_column(const NumberTable& table, const std::string& name);

/// "loads.csv:12: ..."; line 0: "loads.csv: ..."
InputError table_fault(const std::string& path, int line, const std::string& text);

}  // namespace dea

// io/tables/text_table.h – cells in columns with names: CSV, and OpenSim's .sto and .mot.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "src/base/error.h"
#include "src/study/plan.h"

namespace dea {

struct TextTable {
  std::string path;
  bool opensim = false;                        ///< .sto or .mot: has a header that ends in "endheader"
  std::optional<bool> degrees;                 ///< of its header: inDegrees=yes or no; empty: it does not say
  std::string axes;                            ///< .fcsv: LPS or RAS, as its header says; else empty
  int names_line = 0;                          ///< of the file, 1-based
  std::vector<std::string> names;              ///< of the columns, without white space around them
  std::vector<std::vector<std::string>> rows;  ///< as many cells each as there are names, not in quotes any more
  std::vector<int> lines;                      ///< of the rows in the file, 1-based
};

/// CSV: a line of names, then a line of cells per row, separated by commas, semicolons, tabs or spaces; lines that
/// begin with '#' and empty ones are passed over. OpenSim: what stands before "endheader", then the same with white
/// space. Slicer's .fcsv: its line "# columns = " has the names. Throws InputError ("loads.csv:12: found ..., expected
/// ...").
TextTable read_text_table(const std::string& path);

/// A table of cases, without the columns that R, pandas and Dakota put before the factors: rows' own names or numbers.
/// Throws InputError.
CaseTable read_case_table(const std::string& path);

/// All of them there, different, and not all numbers, or InputError.
void check_column_names(const std::string& path, int line, const std::vector<std::string>& names);

inline constexpr const char* kNoRow = "found no row, expected at least one below the names of the columns";

/// "loads.csv:12: ..."; line 0: "loads.csv: ..."
InputError table_fault(const std::string& path, int line, const std::string& text);

}  // namespace dea

// views/text/table.h – numbers and tables for a screen.
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

#include "src/base/unit_names.h"
#include "src/results/headline.h"

namespace dea {

/// Cells under headings; columns as wide as they need, all but those of words aligned to the right. Cells
/// are shown as names are (names.h).
struct Table {
  std::vector<std::string> headings;
  std::string left;  ///< per column: 'l' for words, 'r' for numbers
  std::vector<std::vector<std::string>> rows;
};
std::string table_text(const Table& table);

/// A table and what stands over it; no headings: only the title.
struct TitledTable {
  std::string title;
  Table table;
};
/// Each after an empty line.
std::string tables_text(const std::vector<TitledTable>& tables);

/// "p99 [MPa]", where units are known.
std::string heading_of(const HeadlineNumber& number, const UnitNames& units);

/// What the headline numbers are of, in a line.
std::string headline_words();

/// Number with six digits, "-" when undefined.
std::string number_text(double x);
/// The same with four.
std::string four_digits(double x);
/// "(1, 2, 3)" with six digits.
std::string vector_text(const Eigen::Vector3d& v);

}  // namespace dea

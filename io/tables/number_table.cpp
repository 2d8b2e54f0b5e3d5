#include "io/tables/number_table.h"

#include <fmt/format.h>

#include <cmath>

#include "io/febio/febio_text.h"
#include "io/tables/text_table.h"
#include "src/base/parse.h"

namespace dea {

namespace {

std::vector<double> numbers_of(const TextTable& table, const std::vector<std::string>& words, int line) {
  std::vector<double> row;
  for (std::size_t i = 0; i < words.size(); ++i) {
    try {
      row.push_back(parse_number(words[i]));
    } catch (const BadValue&) {
      throw table_fault(table.path, line,
                        fmt::format("column {}: found {}, expected a number with a decimal point, at most 1e30",
                                    febio::quote(table.names[i]), febio::quote(words[i])));
    }
  }
  return row;
}

}  // namespace

int NumberTable::find(const std::string& name) const {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (lower_case(names[i]) == lower_case(name)) return static_cast<int>(i);
  return -1;
}

NumberTable read_table(const std::string& path) {
  TextTable text = read_text_table(path);
  check_column_names(path, text.names_line, text.names);
  NumberTable table{text.path, text.opensim, text.degrees, text.names, {}, text.lines};
  for (std::size_t i = 0; i < text.rows.size(); ++i)
    table.rows.push_back(numbers_of(text, text.rows[i], text.lines[i]));
  return table;
}

NumberTable make_table(const std::string& path, const std::vector<std::string>& names,
                       const std::vector<std::vector<double>>& rows) {
  NumberTable table;
  table.path = path;
  for (const std::string& name : names) table.names.push_back(trimmed(name));
  check_column_names(path, 0, table.names);
  for (const std::vector<double>& row : rows) {
    const int line = static_cast<int>(table.rows.size()) + 1;
    if (row.size() != names.size())
      throw table_fault(path, line,
                        fmt::format("found {} values, expected {}: one for each name", row.size(), names.size()));
    for (std::size_t i = 0; i < row.size(); ++i)
      if (!(std::abs(row[i]) <= kLargestNumber))
        throw table_fault(path, line,
                          fmt::format("column {}: found {}, expected a number of at most 1e30",
                                      febio::quote(table.names[i]), row[i]));
    table.rows.push_back(row);
    table.lines.push_back(line);
  }
  if (rows.empty()) throw table_fault(path, 0, kNoRow);
  return table;
}

}  // namespace dea

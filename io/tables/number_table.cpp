#include <febiodea/io/tables/number_table.h>

#include <fmt/format.h>

#include <febiodea/base/parse.h>
#include <febiodea/io/febio/febio_text.h>
#include <febiodea/io/tables/text_table.h>

namespace dea {

namespace {

std::vector<double> numbers_of(const TextTable& table, const std::vector<std::string>& words, int line) {
  std::vector<double> row;
  for (std::size_t i = 0; i < words.size(); ++i) {
    try {
      row.push_back(parse_number(words[i]));
    } catch (const BadValue&) {
      throw table_fault(table.path, line,
                        fmt::format("column {}: found {}, expected a number with a decimal point",
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
  if (text.names.front().empty())
    throw table_fault(path, text.names_line, "found a column without a name, expected a name for each");
  NumberTable table{text.path, text.opensim, text.degrees, text.names, {}, text.lines};
  for (std::size_t i = 0; i < text.rows.size(); ++i)
    table.rows.push_back(numbers_of(text, text.rows[i], text.lines[i]));
  return table;
}

}  // namespace dea

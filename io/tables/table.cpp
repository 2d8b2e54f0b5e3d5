#include "io/tables/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>
#include <sstream>

#include "io/febio/febio_text.h"
#include "io/files/free_memory.h"
#include "src/base/parse.h"

namespace dea {

InputError table_fault(const std::string& path, int line, const std::string& text) {
  return InputError(line > 0 ? fmt::format("{}:{}: {}", path, line, text) : fmt::format("{}: {}", path, text));
}

namespace {

/// What separates the words of a file: the first of these that its line of names holds, else white space.
char separator_of(const std::string& names) {
  for (char c : {'\t', ';', ','})
    if (names.find(c) != std::string::npos) return c;
  return ' ';
}

/// The words between separators (' ': any white space); one in quotes is not a separator.
std::vector<std::string> split_outside_quotes(const std::string& line, char separator) {
  std::vector<std::string> words(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    const bool separates = separator == ' ' ? std::isspace(static_cast<unsigned char>(c)) != 0 : c == separator;
    if (separates && !quoted)
      words.emplace_back();
    else
      words.back() += c;
  }
  if (separator == ' ') std::erase(words, "");
  return words;
}

/// Without the quotes around it; a doubled quote inside is one.
std::string unquoted(const std::string& word) {
  if (word.size() < 2 || word.front() != '"' || word.back() != '"') return word;
  std::string inside;
  for (std::size_t i = 1; i + 1 < word.size(); ++i) {
    inside += word[i];
    if (word[i] == '"' && word[i + 1] == '"' && i + 2 < word.size()) ++i;
  }
  return inside;
}

/// `least`: so many words stay, empty or not.
std::vector<std::string> words_of_line(const std::string& line, char separator, std::size_t least = 0) {
  std::vector<std::string> words;
  for (const std::string& text : split_outside_quotes(line, separator)) words.push_back(unquoted(trimmed(text)));
  while (words.size() > least && words.back().empty()) words.pop_back();  // a separator at the end of the line
  return words;
}

/// "# columns = id,x,y" of a list of markups, for the word "columns"; empty: another line.
std::string said_in_comment(const std::string& line, const std::string& word) {
  const std::size_t equals = line.find('=');
  if (line.empty() || line.front() != '#' || equals == line.npos) return "";
  return lower_case(trimmed(line.substr(1, equals - 1))) == word ? trimmed(line.substr(equals + 1)) : "";
}

std::string text_of(const std::string& path) {
  constexpr double kMemoryPerByte = 20;  // of a file: cells are short
  std::optional<std::string> text = whole_file(path, kMemoryPerByte);
  if (!text) throw InputError(fmt::format("{}: found no readable file, expected a table", path));
  if (text->rfind("\xef\xbb\xbf", 0) == 0) text->erase(0, 3);  // a byte order mark
  if (text->rfind("\xff\xfe", 0) == 0 || text->rfind("\xfe\xff", 0) == 0)
    throw InputError(fmt::format("{}: found text as UTF-16, expected UTF-8 (in a spreadsheet: CSV UTF-8)", path));
  return std::move(*text);
}

constexpr const char* kNoRow = "found no row, expected at least one below the names of the columns";

/// All of them there, different, and not all numbers, or InputError.
void check_column_names(const std::string& path, int line, const std::vector<std::string>& names) {
  std::set<std::string> seen;
  for (const std::string& name : names) {
    if (name.empty()) throw table_fault(path, line, "found a column without a name, expected a name for each");
    if (!seen.insert(lower_case(name)).second)
      throw table_fault(path, line,
                        fmt::format("found two columns named {}, expected different names", febio::quote(name)));
  }
  const bool numbers = std::all_of(names.begin(), names.end(), [](const std::string& name) {
    try {
      parse_number(name);
      return true;
    } catch (const BadValue&) {
      return false;
    }
  });
  if (numbers) throw table_fault(path, line, "found numbers, expected the names of the columns");
}

/// A word for each name. `surplus`: words beyond that have no name and are left out.
std::vector<std::string> cells_of(const TextTable& table, std::vector<std::string> words, int line, bool surplus) {
  if (surplus && words.size() > table.names.size()) words.resize(table.names.size());
  if (words.size() != table.names.size())
    throw table_fault(table.path, line,
                      fmt::format("found {} values, expected {}: one for each name in the line of names", words.size(),
                                  table.names.size()));
  return words;
}

/// `said`: rows, by the header; they are told where there are more. InputError: there are fewer.
void compare_rows(const std::string& said, int line, TextTable& table) {
  const int there = static_cast<int>(table.rows.size());
  try {
    const int counted = parse_count(said, 0, there);
    if (counted < there) table.counted = counted;
  } catch (const BadValue&) {
    throw table_fault(table.path, line,
                      fmt::format("found {} row{}, expected the {} that nRows says: is the file cut off?", there,
                                  there == 1 ? "" : "s", said));
  }
}

}  // namespace

TextTable read_text_table(const std::string& path) {
  TextTable table;
  table.path = path;
  std::istringstream in(text_of(path));
  const std::string extension = lower_case(std::filesystem::path(path).extension().string());
  table.opensim = extension == ".sto" || extension == ".mot";
  const bool markups = extension == ".fcsv";
  bool header = table.opensim;
  char separator = ',';
  int number = 0;
  std::string said_rows;
  for (std::string line; std::getline(in, line);) {
    ++number;
    line = trimmed(line);
    if (header) {
      std::string word = lower_case(line);
      word.erase(std::remove_if(word.begin(), word.end(), [](unsigned char c) { return std::isspace(c); }), word.end());
      if (word.rfind("indegrees=", 0) == 0) table.degrees = word.substr(10) == "yes";
      if (word.rfind("nrows=", 0) == 0) said_rows = word.substr(6);
      header = word != "endheader";
      continue;
    }
    if (markups) {
      const std::string axes = said_in_comment(line, "coordinatesystem"), names = said_in_comment(line, "columns");
      if (!axes.empty()) table.axes = axes == "0" ? "RAS" : axes == "1" ? "LPS" : axes;
      if (!names.empty()) line = names;
    }
    if (line.empty() || line.front() == '#') continue;
    if (table.names.empty()) {
      separator = table.opensim ? ' ' : separator_of(line);
      table.names = words_of_line(line, separator);
      table.names_line = number;
      if (table.names.empty()) table.names.emplace_back();  // separators alone
      const bool rows_have_names = table.names.size() > 1 && table.names.front().empty();
      check_column_names(path, number, {table.names.begin() + (rows_have_names ? 1 : 0), table.names.end()});
      continue;
    }
    table.rows.push_back(cells_of(table, words_of_line(line, separator, table.names.size()), number,
                                  markups));  // Slicer 5 writes two values more than it names
    table.lines.push_back(number);
  }
  if (header)
    throw table_fault(path, number, "found no line \"endheader\", expected one before the names of the columns");
  if (table.names.empty()) throw table_fault(path, number, "found no line, expected the names of the columns and rows");
  if (table.rows.empty()) throw table_fault(path, number, kNoRow);
  if (!said_rows.empty()) compare_rows(said_rows, number, table);
  return table;
}

NumberTable read_table(const std::string& path) {
  const TextTable text = read_text_table(path);
  check_column_names(path, text.names_line, text.names);
  NumberTable table{text.path,       text.opensim, text.degrees, text.axes, text.counted,
                    text.names_line, text.names,   {},           text.lines};
  for (std::size_t r = 0; r < text.rows.size(); ++r) {
    table.rows.emplace_back();
    for (std::size_t i = 0; i < text.names.size(); ++i) {
      const std::string& word = text.rows[r][i];
      try {
        table.rows.back().push_back(parse_number(word));
      } catch (const BadValue&) {
        throw table_fault(path, text.lines[r],
                          fmt::format("column {}: found {}, expected a number with a decimal point, at most 1e30",
                                      febio::quote(text.names[i]), febio::quote(word)));
      }
    }
  }
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

CaseTable read_case_table(const std::string& path) {
  const TextTable table = read_text_table(path);
  CaseTable cases{table.path, table.names_line, {}, {}, table.lines};
  const std::set<std::string> passed_over = {"", "%eval_id", "eval_id", "interface"};
  std::vector<std::size_t> columns;
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    if (passed_over.count(lower_case(table.names[i])) > 0) continue;
    columns.push_back(i);
    cases.names.push_back(table.names[i]);
  }
  for (const std::vector<std::string>& row : table.rows) {
    cases.rows.emplace_back();
    for (const std::size_t i : columns) cases.rows.back().push_back(row[i]);
  }
  return cases;
}

int find_column(const NumberTable& table, const std::string& name) {
  for (std::size_t i = 0; i < table.names.size(); ++i)
    if (lower_case(table.names[i]) == lower_case(name)) return static_cast<int>(i);
  return -1;
}

}  // namespace dea

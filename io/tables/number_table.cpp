#include <febiodea/io/tables/number_table.h>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include <febiodea/base/error.h>
#include <febiodea/base/names.h>
#include <febiodea/base/parse.h>
#include <febiodea/io/febio/febio_text.h>

namespace dea {

namespace {

InputError table_fault(const std::string& path, int line, const std::string& text) {
  return InputError(line > 0 ? fmt::format("{}:{}: {}", path, line, text) : fmt::format("{}: {}", path, text));
}

/// What separates the words of a file: the first of these that its line of names holds, else white space.
char separator_of(const std::string& names) {
  for (char c : {'\t', ';', ','})
    if (names.find(c) != std::string::npos) return c;
  return ' ';
}

std::vector<std::string> words_of_line(const std::string& line, char separator) {
  std::vector<std::string> words;
  if (separator == ' ') {
    std::istringstream in(line);
    for (std::string word; in >> word;) words.push_back(word);
    return words;
  }
  for (const std::string& text : split(line, separator)) {
    const std::string word = trimmed(text);
    const bool in_quotes = word.size() > 1 && word.front() == '"' && word.back() == '"';
    words.push_back(in_quotes ? word.substr(1, word.size() - 2) : word);
  }
  while (!words.empty() && words.back().empty()) words.pop_back();  // a separator at the end of the line
  return words;
}

std::string text_of(const std::string& path) {
  std::error_code error;
  std::ifstream in(path, std::ios::binary);
  std::ostringstream bytes;
  const bool readable = in && !std::filesystem::is_directory(path, error);
  if (readable) bytes << in.rdbuf();
  if (!readable || in.bad()) throw InputError(fmt::format("{}: found no readable file, expected a table", path));
  std::string text = bytes.str();
  if (text.rfind("\xef\xbb\xbf", 0) == 0) text.erase(0, 3);  // a byte order mark
  return text;
}

void check_names(const NumberTable& table, int line) {
  std::set<std::string> seen;
  for (const std::string& name : table.names) {
    if (name.empty()) throw table_fault(table.path, line, "found a column without a name, expected a name for each");
    if (!seen.insert(lower_case(name)).second)
      throw table_fault(table.path, line, fmt::format("found two columns named {}, expected different names", febio::quote(name)));
  }
  const bool numbers = std::all_of(table.names.begin(), table.names.end(), [](const std::string& name) {
    try {
      parse_number(name);
      return true;
    } catch (const BadValue&) {
      return false;
    }
  });
  if (numbers) throw table_fault(table.path, line, "found numbers, expected the names of the columns");
}

std::vector<double> numbers_of(const NumberTable& table, const std::vector<std::string>& words, int line) {
  if (words.size() != table.names.size())
    throw table_fault(table.path, line, fmt::format("found {} values, expected {}: one for each name in the line of names",
                                              words.size(), table.names.size()));
  std::vector<double> row;
  for (std::size_t i = 0; i < words.size(); ++i) {
    try {
      row.push_back(parse_number(words[i]));
    } catch (const BadValue&) {
      throw table_fault(table.path, line, fmt::format("column {}: found {}, expected a number with a decimal point",
                                                febio::quote(table.names[i]), febio::quote(words[i])));
    }
  }
  return row;
}

void need_rows(const NumberTable& table, int line) {
  if (table.rows.empty())
    throw table_fault(table.path, line, "found no row, expected at least one below the names of the columns");
}

}  // namespace

int NumberTable::find(const std::string& name) const {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (lower_case(names[i]) == lower_case(name)) return static_cast<int>(i);
  return -1;
}

NumberTable read_table(const std::string& path) {
  NumberTable table;
  table.path = path;
  std::istringstream in(text_of(path));
  const std::string extension = lower_case(std::filesystem::path(path).extension().string());
  table.opensim = extension == ".sto" || extension == ".mot";
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
    if (line.empty() || line.front() == '#') continue;
    if (table.names.empty()) {
      separator = table.opensim ? ' ' : separator_of(line);
      table.names = words_of_line(line, separator);
      check_names(table, number);
      continue;
    }
    table.rows.push_back(numbers_of(table, words_of_line(line, separator), number));
    table.lines.push_back(number);
  }
  if (header) throw table_fault(path, number, "found no line \"endheader\", expected one before the names of the columns");
  if (table.names.empty()) throw table_fault(path, number, "found no line, expected the names of the columns and rows");
  need_rows(table, number);
  if (!said_rows.empty() && said_rows != std::to_string(table.rows.size()))
    throw table_fault(path, number, fmt::format("found {} rows, expected the {} that nRows says: is the file cut off?",
                                                table.rows.size(), said_rows));
  return table;
}

NumberTable make_table(const std::string& path, const std::vector<std::string>& names,
                       const std::vector<std::vector<double>>& rows) {
  NumberTable table;
  table.path = path;
  for (const std::string& name : names) table.names.push_back(trimmed(name));
  check_names(table, 0);
  for (const std::vector<double>& row : rows) {
    const int line = static_cast<int>(table.rows.size()) + 1;
    if (row.size() != names.size())
      throw table_fault(path, line, fmt::format("found {} values, expected {}: one for each name", row.size(), names.size()));
    for (std::size_t i = 0; i < row.size(); ++i)
      if (!std::isfinite(row[i]))
        throw table_fault(path, line, fmt::format("column {}: found {}, expected a finite number",
                                                  febio::quote(table.names[i]), row[i]));
    table.rows.push_back(row);
    table.lines.push_back(line);
  }
  need_rows(table, 0);
  return table;
}

}  // namespace dea

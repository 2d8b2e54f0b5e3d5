#include "views/data/csv.h"

#include <fmt/format.h>

#include <cmath>

#include "src/base/names.h"
#include "src/base/parse.h"

namespace dea {

namespace {

/// Would a spreadsheet reckon with it? Numbers are none, nor lists of them.
bool is_formula(const std::string& text) {
  if (text.size() < 2 || std::string("=@+-").find(text[0]) == std::string::npos) return false;
  try {
    parse_numbers(text);
    return false;
  } catch (const BadValue&) {
    return true;
  }
}

}  // namespace

std::string csv_word(const std::string& text) {
  constexpr std::size_t kLongest = 32767;  // of a spreadsheet's cell
  std::string word = text.size() > kLongest ? shown(text) : one_line(text);
  if (is_formula(word)) word.insert(0, 1, '\'');
  if (word.find_first_of(",\"") == std::string::npos) return word;
  std::string quoted(1, '"');
  for (char c : word) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + '"';
}

std::string csv_number(double x) { return std::isfinite(x) ? fmt::format("{}", x + 0.0) : std::string(); }

}  // namespace dea

#include "views/data/csv.h"

#include <fmt/format.h>

#include <cmath>

namespace dea {

std::string csv_word(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted(1, '"');
  for (char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + '"';
}

std::string csv_number(double x) { return std::isfinite(x) ? fmt::format("{}", x + 0.0) : std::string(); }

}  // namespace dea

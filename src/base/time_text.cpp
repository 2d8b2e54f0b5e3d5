#include "src/base/time_text.h"

#include <fmt/format.h>

#include <cmath>

#include "src/base/numbers.h"
#include "src/base/parse.h"

namespace dea {

namespace {

template <class Number>
Number number_of(const std::string& text) {
  Number number = 0;
  read_number(text.data(), text.data() + text.size(), number);
  return number;
}

}  // namespace

std::string time_text(double time) {
  if (!std::isfinite(time)) return "-";
  if (time == 0) return "0";  // no -0
  // of single precision: the fewest digits that say the same number there; six are never noise
  if (static_cast<double>(static_cast<float>(time)) == time)
    for (int digits = 6; digits < 9; ++digits) {
      const std::string text = fmt::format("{:.{}g}", time, digits);
      if (number_of<float>(text) == static_cast<float>(time)) return text;
    }
  return fmt::format("{:.9g}", time);
}

double time_meant(double time) { return std::isfinite(time) ? number_of<double>(time_text(time)) : kNaN; }

}  // namespace dea

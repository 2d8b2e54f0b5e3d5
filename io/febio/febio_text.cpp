#include "io/febio/febio_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "src/base/parse.h"

namespace dea::febio {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v'; }

void skip_space(std::string_view& text) {
  std::size_t n = 0;
  while (n < text.size() && is_space(text[n])) ++n;
  text.remove_prefix(n);
}

/// White space and one plus sign, which from_chars does not take.
void skip_to_number(std::string_view& text) {
  skip_space(text);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-' && text[1] != '+') text.remove_prefix(1);
}

}  // namespace

std::string_view trim(std::string_view text) {
  skip_space(text);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

bool same_word(std::string_view a, std::string_view b) {
  return a.size() == b.size() && lower_case(std::string(a)) == lower_case(std::string(b));
}

bool one_of(std::string_view word, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(), [&](const char* candidate) { return word == candidate; });
}

bool one_of(std::string_view word, const std::vector<std::string>& words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

Number take_double(std::string_view& text, double& value) {
  skip_to_number(text);
  const char* end = text.data() + text.size();
  const auto result = read_number(text.data(), end, value);
  if (result.ec == std::errc::invalid_argument) return Number::None;
  const std::string_view digits = text.substr(0, static_cast<std::size_t>(result.ptr - text.data()));
  text.remove_prefix(digits.size());
  if (result.ec == std::errc::result_out_of_range) {
    const bool tiny = digits.find("e-") != digits.npos || digits.find("E-") != digits.npos;
    value = 0.0;
    return tiny ? Number::Ok : Number::NotFinite;
  }
  return std::abs(value) <= kLargestNumber ? Number::Ok : Number::NotFinite;  // false for NaN
}

Number take_int(std::string_view& text, int& value) {
  skip_to_number(text);
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec != std::errc()) return Number::None;
  text.remove_prefix(static_cast<std::size_t>(result.ptr - text.data()));
  return Number::Ok;
}

bool take_comma(std::string_view& text) {
  skip_space(text);
  if (text.empty() || text.front() != ',') return false;
  text.remove_prefix(1);
  return true;
}

std::optional<double> whole_double(std::string_view text) {
  double value = 0.0;
  if (take_double(text, value) != Number::Ok || !trim(text).empty()) return std::nullopt;
  return value;
}

std::optional<int> whole_int(std::string_view text) {
  int value = 0;
  if (take_int(text, value) != Number::Ok || !trim(text).empty()) return std::nullopt;
  return value;
}

std::vector<std::string> split_words(std::string_view text) { return split(std::string(text), ','); }

}  // namespace dea::febio

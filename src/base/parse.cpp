#include "src/base/parse.h"
#include "src/base/names.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>

namespace dea {

namespace {

/// The same by strtod, which takes more: white space, a plus sign, hexadecimal digits; and takes no end.
template <class Number>
std::from_chars_result by_strtod(const char* begin, const char* end, Number& number) {
  const std::string word(begin, std::find_if(begin, end, [](char c) { return c == ',' || c <= ' '; }));
  const char* digits = word.c_str() + (word[0] == '-' ? 1 : 0);
  if (*digits == '\0' || (std::isalnum(static_cast<unsigned char>(*digits)) == 0 && *digits != '.'))
    return {begin, std::errc::invalid_argument};
  char* rest = nullptr;
  Number read = 0;
  if (digits[0] == '0' && (digits[1] == 'x' || digits[1] == 'X')) {  // a nought, and then a letter
    if (digits != word.c_str()) read = -read;
    rest = const_cast<char*>(digits) + 1;
  } else {
    read = static_cast<Number>(sizeof(Number) == sizeof(float) ? std::strtof(word.c_str(), &rest)
                                                               : std::strtod(word.c_str(), &rest));
  }
  if (rest == word.c_str()) return {begin, std::errc::invalid_argument};
  const std::from_chars_result taken = {begin + (rest - word.c_str()), std::errc()};
  // beyond all numbers, or between the least one and zero
  const bool is_word = std::isalpha(static_cast<unsigned char>(*digits)) != 0;
  const char* mantissa_end =
      std::find_if(digits, static_cast<const char*>(rest), [](char c) { return c == 'e' || c == 'E'; });
  const bool is_zero = std::all_of(digits, mantissa_end, [](char c) { return c == '0' || c == '.'; });
  if (!is_word && (std::isinf(read) || (read == 0 && !is_zero))) return {taken.ptr, std::errc::result_out_of_range};
  number = read;
  return taken;
}

template <class Number>
std::from_chars_result read(const char* begin, const char* end, Number& number) {
  if constexpr (requires { std::from_chars(begin, end, number); })
    return std::from_chars(begin, end, number);
  else
    return by_strtod(begin, end, number);
}

}  // namespace

std::from_chars_result read_number(const char* begin, const char* end, double& number) {
  return read(begin, end, number);
}
std::from_chars_result read_number(const char* begin, const char* end, float& number) {
  return read(begin, end, number);
}

BadValue bad_value(const std::string& found, const std::string& expected, const std::vector<std::string>& words) {
  return BadValue(fmt::format("found \"{}\"{}, expected {}", found, did_you_mean(found, words), expected));
}

bool has_decimal_comma(const std::string& text) {
  const std::string word = trimmed(text);
  const std::size_t comma = word.find(',');
  const auto digit = [&](std::size_t at) {
    return at < word.size() && std::isdigit(static_cast<unsigned char>(word[at])) != 0;
  };
  // One comma and no point: what is parsed below has no comma, so that its refusal does not come back here.
  if (comma == std::string::npos || comma != word.rfind(',') || word.find('.') != std::string::npos) return false;
  if (comma == 0 || !digit(comma - 1) || !digit(comma + 1)) return false;
  try {
    parse_number(word.substr(0, comma) + "." + word.substr(comma + 1));
  } catch (const BadValue&) {
    return false;
  }
  return true;
}

double parse_number(const std::string& text) {
  const std::string word = trimmed(text);
  const char* begin = word.data();
  const char* end = begin + word.size();
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') ++begin;  // from_chars knows no plus sign
  double number = 0.0;
  const auto result = read_number(begin, end, number);
  const bool large =
      result.ec == std::errc::result_out_of_range || (std::isfinite(number) && std::abs(number) > kLargestNumber);
  if (large && result.ptr == end) throw bad_value(text, "a number of at most 1e30");
  if (result.ec != std::errc() || result.ptr != end || !std::isfinite(number))
    throw bad_value(text, has_decimal_comma(text) ? "a number with a decimal point" : "a number");
  return number;
}

std::vector<double> parse_numbers(const std::string& text) {
  std::vector<double> numbers;
  for (const std::string& word : split_at_commas(text)) {
    try {
      numbers.push_back(parse_number(word));
    } catch (const BadValue&) {
      throw bad_value(text, "numbers separated by commas");
    }
  }
  return numbers;
}

int parse_count(const std::string& text, int least, int most) {
  const std::string word = trimmed(text);
  int number = 0;
  const auto result = std::from_chars(word.data(), word.data() + word.size(), number);
  if (result.ec != std::errc() || result.ptr != word.data() + word.size() || number < least || number > most)
    throw bad_value(text, fmt::format("a whole number from {} to {}", least, most));
  return number;
}

Eigen::Vector3d parse_vector(const std::string& text) {
  std::vector<double> numbers;
  try {
    numbers = parse_numbers(text);
  } catch (const BadValue&) {
  }
  if (numbers.size() != 3) throw bad_value(text, "three numbers x,y,z");
  return {numbers[0], numbers[1], numbers[2]};
}

FramedText split_frame(const std::string& text) {
  const std::string word = "frame:";
  if (lower_case(text.substr(0, word.size())) != word) return {"", text};
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos) throw bad_value(text, "a comma and numbers after the frame's name: frame:NAME,...");
  const std::string frame = trimmed(text.substr(word.size(), comma - word.size()));
  if (frame.empty()) throw bad_value(text, "a frame's name after frame:");
  return {frame, text.substr(comma + 1)};
}

std::string trimmed(const std::string& text) {
  constexpr const char* kSpace = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

std::string lower_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> words(1);
  for (const char c : text) {
    if (c == separator)
      words.emplace_back();
    else
      words.back() += c;
  }
  return words;
}

std::vector<std::string> split_at_commas(const std::string& text) {
  std::vector<std::string> words = split(text, ',');
  for (std::string& word : words) word = trimmed(word);
  return words;
}

}  // namespace dea

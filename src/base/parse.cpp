#include "src/base/parse.h"
#include "src/base/names.h"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <cmath>

namespace dea {

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
  const auto result = std::from_chars(begin, end, number);
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

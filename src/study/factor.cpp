// Factors as the user writes them: "tilt: rotate pelvis=0,1,0,{-20:20:5}".
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <set>

#include "src/base/names.h"
#include "src/base/parse.h"
#include "src/model/settings_table.h"
#include "src/study/plan.h"

namespace dea {

namespace {

constexpr const char* kForm = "NAME: OPTION VALUE with one {...}, such as \"stiffness: E={8|12|16}\"";
constexpr const char* kBraces = "{START:STOP:STEP}, {a|b|c}, {uniform(a,b)}, {normal(a,b)}, {lognormal(a,b)} or {}";

/// digits * 10^exponent, exactly.
struct Decimal {
  std::int64_t digits = 0;
  int exponent = 0;
};

constexpr std::int64_t kMostDigits = 1'000'000'000'000'000'000;

BadValue no_decimal(const std::string& text) {
  return bad_value(text, "a decimal number of at most 15 digits, such as -20 or 0.25");
}

Decimal parse_decimal(const std::string& text) {
  parse_number(text);
  const std::string word = lower_case(trimmed(text));
  Decimal number;
  bool point = false;
  std::size_t i = word[0] == '-' || word[0] == '+' ? 1 : 0;
  for (; i < word.size() && word[i] != 'e'; ++i) {
    if (word[i] == '.') {
      point = true;
      continue;
    }
    if (std::isdigit(static_cast<unsigned char>(word[i])) == 0 || number.digits > kMostDigits / 1000)
      throw no_decimal(text);
    number.digits = 10 * number.digits + (word[i] - '0');
    if (point) --number.exponent;
  }
  if (i < word.size()) number.exponent += static_cast<int>(std::strtol(word.c_str() + i + 1, nullptr, 10));
  if (std::abs(number.exponent) > 30) throw no_decimal(text);
  if (word[0] == '-') number.digits = -number.digits;
  return number;
}

/// The same number with a smaller exponent.
std::int64_t digits_at(const Decimal& number, int exponent, const std::string& text) {
  std::int64_t digits = number.digits;
  for (int e = number.exponent; e > exponent && digits != 0; --e) {
    if (std::abs(digits) > kMostDigits / 10) throw bad_value(text, "numbers that differ by fewer powers of ten");
    digits *= 10;
  }
  return digits;
}

/// "-0.3": as a person would write it.
std::string decimal_text(std::int64_t digits, int exponent) {
  std::string text = std::to_string(std::abs(digits));
  if (digits != 0 && exponent > 0) text.append(static_cast<std::size_t>(exponent), '0');
  if (exponent < 0) {
    const auto after = static_cast<std::size_t>(-exponent);
    if (text.size() <= after) text.insert(0, after + 1 - text.size(), '0');
    text.insert(text.size() - after, 1, '.');
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return digits < 0 ? "-" + text : text;
}

/// START:STOP:STEP
std::vector<std::string> range_values(const std::string& text) {
  const std::vector<std::string> words = split(text, ':');
  if (words.size() != 3) throw bad_value("{" + text + "}", "START:STOP:STEP in the braces, such as {-20:20:5}");
  std::array<Decimal, 3> parts;
  std::transform(words.begin(), words.end(), parts.begin(), parse_decimal);
  const int exponent = std::min({parts[0].exponent, parts[1].exponent, parts[2].exponent});
  const std::int64_t start = digits_at(parts[0], exponent, text), stop = digits_at(parts[1], exponent, text),
                     step = digits_at(parts[2], exponent, text);
  if (step == 0) throw bad_value("{" + text + "}", "a step that is not 0");
  if ((stop - start) / step < 0 || (stop != start && (stop < start) != (step < 0)))
    throw bad_value("{" + text + "}",
                    fmt::format("a step of the other sign: from {} to {}", trimmed(words[0]), trimmed(words[1])));
  const std::int64_t count = (stop - start) / step + 1;
  if (count > kMostCases)
    throw BadValue(
        fmt::format("found {} values in {{{}}}, expected at most {}: a larger step", count, text, kMostCases));
  std::vector<std::string> values;
  values.reserve(static_cast<std::size_t>(count));
  for (std::int64_t i = 0; i < count; ++i) values.push_back(decimal_text(start + i * step, exponent));
  return values;
}

/// a|b|c
std::vector<std::string> listed_values(const std::string& text) {
  std::vector<std::string> values = split(text, '|');
  std::set<std::string> seen;
  for (std::string& value : values) {
    value = trimmed(value);
    if (value.empty()) throw bad_value("{" + text + "}", "a value on both sides of each |");
    if (!seen.insert(value).second)
      throw BadValue(fmt::format("found {} twice in {{{}}}, expected different values", value, text));
  }
  return values;
}

/// uniform(a,b), normal(a,b), lognormal(a,b)
Spread parse_spread(const std::string& text) {
  const std::size_t open = text.find('(');
  const std::string word = lower_case(trimmed(text.substr(0, open)));
  Spread spread;
  for (std::size_t kind = 1; kind < kSpreadWords.size(); ++kind)
    if (word == kSpreadWords[kind]) spread.kind = static_cast<Spread::Kind>(kind);
  if (spread.kind == Spread::Kind::None)
    throw BadValue(fmt::format("found \"{{{}}}\"{}, expected {}", text,
                               did_you_mean(word, {kSpreadWords.begin() + 1, kSpreadWords.end()}), kBraces));
  const std::string inside = text.substr(open + 1, text.size() - open - 2);
  const std::vector<double> numbers = text.back() == ')' ? parse_numbers(inside) : std::vector<double>();
  if (numbers.size() != 2) throw bad_value("{" + text + "}", fmt::format("two numbers: {{{}(a,b)}}", word));
  spread.a = numbers[0];
  spread.b = numbers[1];
  if (spread.kind == Spread::Kind::Uniform && !(spread.a < spread.b))
    throw bad_value("{" + text + "}", "the smaller number first: {uniform(least,largest)}");
  if (spread.kind != Spread::Kind::Uniform && !(spread.b > 0))
    throw bad_value("{" + text + "}", "a standard deviation > 0 as the second number");
  return spread;
}

void take_braces(Factor& factor, const std::string& text) {
  if (trimmed(text).empty()) return;
  if (text.find('|') != text.npos)
    factor.values = listed_values(text);
  else if (text.find('(') != text.npos)
    factor.spread = parse_spread(trimmed(text));
  else if (text.find(':') != text.npos)
    factor.values = range_values(text);
  else
    throw bad_value("{" + text + "}", kBraces);
}

std::string factor_name(const std::string& text) {
  std::string name = trimmed(text);
  const auto letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  const bool good = !name.empty() && letter(name[0]) && std::all_of(name.begin(), name.end(), [&](char c) {
    return letter(c) || std::isdigit(static_cast<unsigned char>(c)) != 0;
  });
  if (!good || name.size() > 60)
    throw bad_value(name, "a factor's name of letters, digits and _ before the colon: it is a column's name");
  return name;
}

const SettingOption& factor_option(const std::string& name) {
  if (const SettingOption* option = find_setting_option(name)) return *option;
  throw BadValue(fmt::format("found no setting \"{}\"{}, expected one such as E, rotate, force or thickness-scale",
                             name, did_you_mean(name, every_name(setting_options()), setting_aliases())));
}

}  // namespace

Factor parse_factor(const std::string& text) {
  const std::size_t colon = text.find(':'), open = text.find('{');
  if (colon == text.npos || open == text.npos || colon > open) throw bad_value(text, kForm);
  Factor factor;
  factor.name = factor_name(text.substr(0, colon));
  std::string rest = trimmed(text.substr(colon + 1));
  if (rest.rfind("--", 0) == 0) rest.erase(0, 2);
  const std::size_t end = std::min(rest.find_first_of("= \t{"), rest.size());
  factor.option = factor_option(rest.substr(0, end)).name;
  const bool brace = end < rest.size() && rest[end] == '{';
  rest = trimmed(rest.substr(std::min(rest.size(), brace ? end : end + 1)));
  const std::size_t from = rest.find('{'), to = rest.find('}');
  if (from == rest.npos || to == rest.npos || to < from || rest.find('{', from + 1) != rest.npos ||
      rest.find('}', to + 1) != rest.npos)
    throw bad_value(text, kForm);
  factor.before = rest.substr(0, from);
  factor.after = rest.substr(to + 1);
  take_braces(factor, rest.substr(from + 1, to - from - 1));
  return factor;
}

}  // namespace dea

#include "src/base/names.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>

namespace dea {

namespace {

char small(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

bool continues(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }

/// The character that `text` begins with. No UTF-8: one byte, and 0 for its code.
struct Character {
  std::size_t bytes = 1;
  std::uint32_t code = 0;
};

Character first_character(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text[0]);
  if (lead < 0x80) return {1, lead};
  const std::size_t bytes = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < bytes) return {};
  std::uint32_t code = lead & (0xFFu >> (bytes + 1));
  for (std::size_t i = 1; i < bytes; ++i) {
    if (!continues(text[i])) return {};
    code = code << 6 | (static_cast<unsigned char>(text[i]) & 0x3Fu);
  }
  const bool too_long = (bytes == 3 && code < 0x800) || (bytes == 4 && code < 0x10000);
  return too_long || code > 0x10FFFF || (code >= 0xD800 && code < 0xE000) ? Character{} : Character{bytes, code};
}

/// Beyond ASCII: what steers a terminal, breaks a line or turns the direction of writing.
bool steers(std::uint32_t code) {
  return code < 0xA0 || code == 0x061C || (code >= 0x200E && code <= 0x200F) || (code >= 0x2028 && code <= 0x202E) ||
         (code >= 0x2066 && code <= 0x2069);
}

/// `kept`: control characters that stay.
std::string without_control(std::string_view text, std::string_view kept) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    const Character character = first_character(text.substr(i));
    const bool plain =
        character.bytes > 1 ? !steers(character.code) : (c >= ' ' && c < 127) || kept.find(c) != std::string_view::npos;
    if (plain)
      out += text.substr(i, character.bytes);
    else if (character.bytes > 1)
      out += fmt::format("\\u{:04x}", character.code);
    else
      out += c == '\n' ? "\\n" : c == '\t' ? "\\t" : fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    i += character.bytes;
  }
  return out;
}

/// What is longer than both: the first `begin` and the last `end` bytes, without halves of UTF-8 characters.
std::string shortened(std::string_view text, std::size_t begin = 60, std::size_t end = 20) {
  if (text.size() <= begin + end) return std::string(text);
  std::size_t first = begin, last = text.size() - end;
  while (first + 3 > begin && continues(text[first])) --first;
  while (last < text.size() - end + 3 && continues(text[last])) ++last;
  return fmt::format("{}...{}", text.substr(0, first), text.substr(last));
}

/// In small letters, without - and _.
std::string bare(std::string_view word) {
  std::string letters;
  for (const char c : word)
    if (c != '-' && c != '_') letters += small(c);
  return letters;
}

/// "ee" for "e": a key pressed twice.
bool stuttered(const std::string& word, const std::string& name) {
  return name.size() == 1 && word.size() == 2 && word[0] == name[0] && word[1] == name[0];
}

/// Names are cut here: a file may hold any text, and the time is quadratic.
constexpr std::size_t kLongest = 100;

}  // namespace

std::string printable(std::string_view text) { return without_control(text, "\n\t"); }

std::string one_line(std::string_view text) { return without_control(text, ""); }

std::string shown(std::string_view name) { return one_line(shortened(name)); }

std::string in_quotes(std::string_view name) { return fmt::format("\"{}\"", shown(name)); }

std::string message_line(std::string_view message) {
  constexpr std::size_t kLong = 1000, kLongName = 400, kBegin = 3000, kEnd = 1000;
  if (message.size() <= kLong) return one_line(message);
  std::string text;
  for (std::size_t begin = 0; begin <= message.size();) {
    const std::size_t end = std::min(message.find('"', begin), message.size());
    const std::string_view between = message.substr(begin, end - begin);
    text += between.size() > kLongName ? shortened(between) : std::string(between);
    if (end < message.size()) text += '"';
    begin = end + 1;
  }
  return one_line(shortened(text, kBegin, kEnd));
}

int edit_distance(std::string_view a, std::string_view b) {
  a = a.substr(0, kLongest);
  b = b.substr(0, kLongest);
  // rows of the table of distances between the first i letters of a and the first j of b: i - 2, i - 1, i
  std::vector<int> before_last, last, row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = static_cast<int>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before_last = std::move(last);
    last = std::move(row);
    row.assign(b.size() + 1, static_cast<int>(i));
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = small(a[i - 1]) == small(b[j - 1]);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
      if (i > 1 && j > 1 && small(a[i - 1]) == small(b[j - 2]) && small(a[i - 2]) == small(b[j - 1]))
        row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row.back();
}

std::string nearest_name(std::string_view word, const std::vector<std::string>& names, Aliases aliases) {
  const std::string asked = bare(word);
  if (asked.empty()) return "";
  for (const Alias& alias : aliases) {
    if (bare(alias.word) != asked) continue;
    const auto is_meant = [&](const std::string& name) { return bare(name) == bare(alias.name); };
    const auto found = std::find_if(names.begin(), names.end(), is_meant);
    if (found != names.end()) return *found;
  }
  std::string best;
  int least = 1 + static_cast<int>(word.size()) / 5;
  for (const std::string& name : names) {
    const std::string known = bare(name);
    const int distance = edit_distance(asked, known);
    const bool other = distance >= static_cast<int>(known.size()) && !stuttered(asked, known);  // no letter in common
    if (distance > least || (distance == least && !best.empty()) || other) continue;
    least = distance;
    best = name;
  }
  return best;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& names, Aliases aliases) {
  std::string best = nearest_name(word, names, aliases);
  const std::string asked = bare(word);
  if (best.empty() && asked.size() >= 3) {
    const auto holds = [&](const std::string& name) { return bare(name).find(asked) != std::string::npos; };
    if (std::count_if(names.begin(), names.end(), holds) == 1) best = *std::find_if(names.begin(), names.end(), holds);
  }
  return best.empty() ? "" : " (did you mean " + in_quotes(best) + "?)";
}

std::string name_list(std::vector<std::string> names, std::string_view word, std::size_t most) {
  if (!word.empty() && names.size() > most && names.size() <= 10000) {  // beyond, it takes longer than anyone waits
    std::vector<std::pair<int, std::string>> by_distance;
    for (std::string& name : names) {
      const int distance = edit_distance(word, name);
      by_distance.emplace_back(distance, std::move(name));
    }
    std::stable_sort(by_distance.begin(), by_distance.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t i = 0; i < names.size(); ++i) names[i] = std::move(by_distance[i].second);
  }
  std::string text;
  for (std::size_t i = 0; i < std::min(most, names.size()); ++i) text += (i ? ", " : "") + in_quotes(names[i]);
  if (names.size() > most) text += ", ...";
  return text.empty() ? "none" : text;
}

std::string and_list(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 < words.size() ? ", " : " and ") + words[i];
  return text;
}

std::string number_list(const std::vector<int>& numbers, std::size_t most) {
  std::string text;
  for (std::size_t i = 0; i < std::min(most, numbers.size()); ++i) text += (i ? ", " : "") + std::to_string(numbers[i]);
  return numbers.size() > most ? text + ", ..." : text;
}

std::string no_such_name(const char* what, std::string_view word, const std::vector<std::string>& names) {
  return "the model has no " + std::string(what) + " of this name" + did_you_mean(word, names) + "; it has " +
         name_list(names, word);
}

std::string take_free_name(const std::string& wanted, std::set<std::string>& names) {
  std::string name = wanted;
  for (int i = 2; !names.insert(name).second; ++i) name = wanted + "_" + std::to_string(i);
  return name;
}

}  // namespace dea

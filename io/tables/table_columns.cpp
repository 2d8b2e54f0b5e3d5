#include "io/tables/table_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "io/febio/febio_text.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/parse.h"
#include "src/base/say.h"
#include "src/base/time_text.h"

namespace dea {

namespace {

/// What a column's name says in brackets: "Fx [N]" "n", "mx (N m)" "nm"; empty: nothing.
std::string unit_in_name(const std::string& name) {
  const std::size_t open = name.find_last_of("[("), close = name.find_last_of("])");
  if (open == name.npos || close == name.npos || close < open) return "";
  std::string unit;
  for (char c : lower_case(name.substr(open + 1, close - open - 1)))
    if (std::string(" -*.").find(c) == std::string::npos) unit += c;
  for (const std::string dot : {"\u00b7", "\u22c5", "\u00d7"})  // between N and m
    for (std::size_t place; (place = unit.find(dot)) != unit.npos;) unit.erase(place, dot.size());
  for (const auto& [word, meant] : std::map<std::string, std::string>{
           {"degree", "deg"}, {"degrees", "deg"}, {"°", "deg"}, {"radian", "rad"}, {"radians", "rad"}, {"µm", "um"}})
    if (unit == word) return meant;
  return unit;
}

/// "mmn" is "nmm", and "%" is "%bw" where that is expected.
bool is_unit(const std::string& unit, const std::string& expected) {
  if (unit == expected || (unit == "%" && expected == "%bw")) return true;
  for (const std::string& length : length_words())
    if (unit.starts_with(length) && unit.substr(length.size()) + length == expected) return true;
  return false;
}

/// "n" as N, "knmm" as kN mm, "%bwm" as % of body weight times m.
std::string unit_in_words(const std::string& unit) {
  constexpr std::pair<const char*, const char*> kWords[] = {
      {"%bw", "% of body weight"}, {"kn", "kN"}, {"nn", "nN"}, {"mn", "mN"}, {"n", "N"}};
  for (const auto& [start, words] : kWords) {
    if (unit.rfind(start, 0) != 0) continue;
    const std::string length = unit.substr(std::string(start).size());
    return length.empty() ? words : fmt::format("{}{}{}", words, unit[0] == '%' ? " times " : " ", length);
  }
  return unit;
}

}  // namespace

std::string named_columns(const NumberTable& table, const std::string& word) { return name_list(table.names, word); }

std::string bare_name(const std::string& name) { return lower_case(trimmed(name.substr(0, name.find_first_of("[(")))); }

std::vector<int> like(const NumberTable& table, const std::vector<std::string>& words) {
  std::vector<int> found;
  for (std::size_t i = 0; i < table.names.size(); ++i)
    for (const std::string& word : words)
      if (bare_name(table.names[i]) == word || bare_name(table.names[i]).ends_with("_" + word)) {
        found.push_back(static_cast<int>(i));
        break;
      }
  return found;
}

std::array<int, 3> vector_columns(const NumberTable& table, const char* setting, const char* what,
                                  const std::array<std::vector<std::string>, 3>& words) {
  std::array<int, 3> columns = {-1, -1, -1};
  int none = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::vector<int> found = like(table, words[k]);
    if (found.size() > 1)
      throw InputError(Fault{
          .place = table.path,
          .found = say("found {} columns that may be the {}'s {}: {};", found.size(), what, std::string(1, "xyz"[k]),
                       name_list({table.names[at(found[0])], table.names[at(found[1])]})),
          .expected = say("name them with {}", NamedSetting{setting})});
    if (found.empty())
      ++none;
    else
      columns[k] = found[0];
  }
  if (none == 1 || none == 2)
    throw InputError(Fault{.place = table.path,
                           .found = say("found not all three columns of the {} among {};", what, named_columns(table)),
                           .expected = say("name the columns with {}", NamedSetting{setting})});
  return columns;
}

std::vector<int> given_columns(const NumberTable& table, const char* setting, const std::string& names) {
  std::vector<int> columns;
  for (const std::string& name : split_at_commas(names)) {
    columns.push_back(find_column(table, name));
    if (columns.back() < 0)
      throw wrong_setting(
          setting, names,
          say("{} has no column {}{};", table.path, febio::quote(name), did_you_mean(name, table.names)),
          say("it has {}", named_columns(table, name)));
  }
  for (std::size_t k = 1; k < columns.size(); ++k)
    if (std::find(columns.begin(), columns.begin() + static_cast<long>(k), columns[k]) !=
        columns.begin() + static_cast<long>(k))
      throw wrong_setting(setting, names, say("column {} stands twice;", febio::quote(table.names[at(columns[k])])),
                          "name each once");
  if (columns.size() != 3 && columns.size() != 6)
    throw wrong_setting(setting, names, say("these are {} columns;", columns.size()), "name three, or six");
  return columns;
}

void refuse_other_units(const NumberTable& table, const std::vector<int>& columns, std::size_t first,
                        const std::string& expected, const std::vector<std::string>& known, const UnitRemedy& remedy) {
  for (std::size_t k = first; k < std::min(columns.size(), first + 3); ++k) {
    const std::string& name = table.names[at(columns[k])];
    const std::string unit = unit_in_name(name);
    if (is_unit(unit, expected) || std::find(known.begin(), known.end(), unit) == known.end()) continue;
    throw InputError(Fault{.place = table.path,
                           .found = say("column {} is taken in {}, and its name says otherwise;", febio::quote(name),
                                        unit_in_words(expected)),
                           .expected = remedy(unit)});
  }
}

bool name_says_unit(const NumberTable& table, const std::vector<int>& columns, std::size_t first,
                    const std::vector<std::string>& known) {
  for (std::size_t k = first; k < std::min(columns.size(), first + 3); ++k)
    if (std::find(known.begin(), known.end(), unit_in_name(table.names[at(columns[k])])) != known.end()) return true;
  return false;
}

// Also units that dea does not know the size of: none of them is what it takes.
std::vector<std::string> force_words() {
  return {"n", "kn", "mn", "nn", "un", "dyn", "lbf", "lb", "kgf", "kg", "kp", "n/kg", "%bw", "bw", "xbw", "%"};
}
std::vector<std::string> length_words() { return {"m", "cm", "mm", "um", "in", "inch", "ft"}; }
std::vector<std::string> angle_words() { return {"deg", "rad", "mrad", "grad", "rev", "turns"}; }

std::vector<std::string> moment_words() {
  std::vector<std::string> words;
  for (const std::string& force : force_words())
    for (const std::string& length : length_words()) {
      words.push_back(force + length);
      words.push_back(length + force);
    }
  for (const char* other : {"nm/kg", "%bwht", "bwht", "%bwh", "n", "kn", "%bw", "bw"}) words.emplace_back(other);
  return words;
}

std::array<std::string, 2> units_taken(const std::string& units, const std::string& first, const std::string& length) {
  const std::size_t dash = units.find('-');
  if (dash != units.npos) return {lower_case(units.substr(0, dash)), lower_case(units.substr(dash + 1))};
  return {lower_case(first), lower_case(length)};
}

int time_column(const NumberTable& table) {
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    const std::string name = bare_name(table.names[i]);
    if (name == "time" || name == "t" || name == "percent" || name.find("cycle") != name.npos || name == "%")
      return static_cast<int>(i);
  }
  return -1;
}

std::vector<double> times_of(const NumberTable& table) {
  const int column = time_column(table);
  std::vector<double> times;
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    times.push_back(column < 0 ? static_cast<double>(r + 1) : table.rows[r][at(column)]);
    if (r > 0 && !(times[r] > times[r - 1]))
      throw InputError(fmt::format("{}:{}: found time {} after {}, expected times that rise from row to row",
                                   table.path, table.lines[r], time_text(times[r]), time_text(times[r - 1])));
  }
  return times;
}

std::string column_names(const NumberTable& table, const std::vector<int>& columns) {
  std::string names;
  for (int c : columns) names += (names.empty() ? "" : ", ") + table.names[at(c)];
  return names;
}

std::string table_in_words(const NumberTable& table, const std::string& columns, const std::vector<double>& times) {
  const int time = time_column(table);
  const std::string first = time_text(times.front()), last = time_text(times.back());
  return fmt::format("{}: {} row{}{}, {} {}{}, {}", table.path, table.rows.size(), table.rows.size() == 1 ? "" : "s",
                     table.counted ? fmt::format(" (its header counts {}: all are read)", *table.counted) : "",
                     time < 0 ? "numbered" : fmt::format("{}", table.names[at(time)]), first,
                     table.rows.size() == 1 ? "" : " to " + last, columns);
}

std::vector<Eigen::Matrix<double, 6, 1>> values_of(const NumberTable& table, const std::vector<int>& columns) {
  std::vector<Eigen::Matrix<double, 6, 1>> values(table.rows.size(), Eigen::Matrix<double, 6, 1>::Zero());
  for (std::size_t r = 0; r < table.rows.size(); ++r)
    for (std::size_t k = 0; k < columns.size(); ++k)
      values[r][static_cast<Eigen::Index>(k)] = table.rows[r][at(columns[k])];
  return values;
}

}  // namespace dea

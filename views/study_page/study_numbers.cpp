#include "views/study_page/study_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "io/feb/read_feb.h"
#include "io/files/output.h"
#include "io/tables/read_tables.h"
#include "src/base/numbers.h"
#include "src/base/parse.h"
#include "src/equilibrium/search.h"
#include "src/results/inside_numbers.h"

namespace dea {

namespace {

constexpr const char* kForce = "force";

/// p99 of what is inside the layers: of both sides of a contact, at both ends.
std::vector<StudyStatistic> inside_statistics() {
  std::vector<StudyStatistic> all;
  for (const char* side : {"source", "target"})
    for (const InsideEnd& end : kInsideEnds)
      for (const InsideMeasure& m : kInsideMeasures) {
        const bool compression = m.value == &InsideStatistics::third_strain;
        const std::string quantity = fmt::format("{} {}, {}", m.words, end.words, side);
        std::string title = fmt::format("{} ({})", quantity, compression ? "1st percentile" : "p99");
        title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
        all.push_back({fmt::format("{}_{}_{}_p99", side, end.name, m.name), std::move(title), quantity,
                       m.stress ? "pressure" : "none", compression});
      }
  return all;
}

/// Where folders begin in a path, from its end: the file's name, then one folder more each; the whole path last.
std::vector<std::size_t> tail_starts(const std::string& path) {
  std::vector<std::size_t> starts;
  for (std::size_t i = path.size(); i > 1; --i)
    if (is_separator(path[i - 2]) && !is_separator(path[i - 1])) starts.push_back(i - 1);
  if (starts.empty() || starts.back() != 0) starts.push_back(0);
  return starts;
}

void make_columns(StudyNumbers& n) {
  std::vector<StudyColumn> all;
  std::vector<std::string> texts;
  const std::vector<std::string> models = short_names(n.head.models);
  for (const StudyCase& c : n.cases) texts.push_back(models[at(c.model)]);
  if (n.head.models.size() > 1) all.push_back(make_column("model", texts));
  for (std::size_t f = 0; f < n.head.factors.size(); ++f) {
    texts.clear();
    for (const StudyCase& c : n.cases) texts.push_back(c.values[f]);
    all.push_back(make_column(n.head.factors[f].name, texts));
  }
  for (StudyColumn& c : all) (c.levels.size() > 1 ? n.columns : n.constant).push_back(std::move(c));
}

/// Every combination at most once, and no more holes than cases.
bool is_grid(const StudyNumbers& n) {
  double product = 1.0;
  for (const StudyColumn& c : n.columns) product *= static_cast<double>(c.levels.size());
  if (n.columns.empty() || product > 2.0 * static_cast<double>(n.cases.size())) return false;
  std::vector<char> taken(static_cast<std::size_t>(product), 0);
  for (std::size_t i = 0; i < n.cases.size(); ++i) {
    std::size_t cell = 0;
    for (const StudyColumn& c : n.columns) cell = cell * c.levels.size() + at(c.level[i]);
    if (taken[cell]++ != 0) return false;
  }
  return true;
}

/// States, their times, and which are solutions: per case and state 1.
std::vector<std::vector<char>> take_states(const std::string& path, StudyNumbers& n) {
  std::vector<std::vector<char>> good(n.cases.size());
  n.own_times.resize(n.cases.size());
  for (StudyState& s : read_states(path)) {
    const int c = n.case_of(static_cast<double>(s.case_id));
    if (c < 0 || s.state < 1) continue;
    const std::size_t k = at(s.state - 1);
    good[at(c)].resize(std::max(good[at(c)].size(), k + 1), 0);
    n.own_times[at(c)].resize(good[at(c)].size(), kNaN);
    n.own_times[at(c)][k] = s.time;
    good[at(c)][k] = is_solution(s.outcome) ? 1 : 0;
    n.states = std::max(n.states, k + 1);
    if (good[at(c)][k] == 0) n.unsolved.push_back(std::move(s));
  }
  for (const std::vector<double>& times : n.own_times) {
    if (times.size() == n.states && n.times.empty()) n.times = times;
    if (!times.empty() && times.size() == n.states && times != n.times) n.same_times = false;
    if (!times.empty() && times.size() < n.states) n.same_times = false;
  }
  if (!n.same_times) n.times.clear();
  for (const std::vector<char>& states : good)
    n.complete.push_back(!states.empty() && std::count(states.begin(), states.end(), 0) == 0 ? 1 : 0);
  return good;
}

/// Of the inside those that some contact has a number of: a bone without cartilage, and law linear, have none.
void take_values(const std::string& path, const std::vector<std::vector<char>>& good, StudyNumbers& n) {
  n.statistics = headline_statistics();
  const std::size_t force = n.statistics.size() - 1;  // behind the others
  std::vector<std::string> columns, of_inside;
  for (std::size_t s = 0; s < force; ++s) columns.push_back(n.statistics[s].name);
  for (const char* axis : {"_x", "_y", "_z"}) columns.push_back(std::string(kForce) + axis);
  if (n.head.identity.inside)
    for (StudyStatistic& s : inside_statistics()) {
      of_inside.push_back(s.name);
      n.statistics.push_back(std::move(s));
    }
  StudyRows rows = read_rows(path, columns, of_inside);
  n.places = std::move(rows.places);
  n.values.assign(n.statistics.size(), std::vector(n.places.size(), std::vector(n.cases.size() * n.choices(), kNaN)));
  std::vector<char> any(n.statistics.size(), 0);
  for (std::size_t r = 0; r < rows.case_id.size(); ++r) {
    const int c = n.case_of(static_cast<double>(rows.case_id[r]));
    if (c < 0 || rows.state[r] < 1 || at(rows.state[r]) > good[at(c)].size()) continue;
    const std::size_t k = at(rows.state[r] - 1), place = at(rows.place[r]), cell = at(c) * n.choices() + k;
    if (good[at(c)][k] == 0) continue;
    const auto number = [&](std::size_t column) { return rows.numbers[column][r]; };
    for (std::size_t s = 0; s < force; ++s) n.values[s][place][cell] = number(s);
    n.values[force][place][cell] = std::hypot(number(force), number(force + 1), number(force + 2));
    for (std::size_t s = force + 1; s < n.statistics.size(); ++s) {
      n.values[s][place][cell] = number(s + 2);
      if (std::isfinite(number(s + 2))) any[s] = 1;
    }
  }
  for (std::size_t s = n.statistics.size() - 1; s > force; --s) {
    if (any[s] != 0) continue;
    n.statistics.erase(n.statistics.begin() + static_cast<std::ptrdiff_t>(s));
    n.values.erase(n.values.begin() + static_cast<std::ptrdiff_t>(s));
  }
}

/// Is it still the file that the study was made from?
bool unchanged(const StudyHead& head, const std::string& file) {
  try {
    for (const auto& [path, digest] : head.identity.inputs)
      if (path == file && file_digest(path) == digest) return true;
  } catch (const InputError&) {  // it is not there
  }
  return false;
}

std::string units_of_model(const StudyHead& head) {
  if (head.models.empty() || !unchanged(head, head.models.front())) return "";
  try {
    return read_feb(head.models.front()).units;
  } catch (const InputError&) {
    return "";
  }
}

/// Of the table of loads or motion among the options.
std::string time_name_of_table(const StudyHead& head) {
  for (const std::string& text : head.identity.options)
    for (const auto& [path, digest] : head.identity.inputs)
      if ((text.starts_with("--loads ") || text.starts_with("--motion ")) && text.find(path) != std::string::npos &&
          unchanged(head, path))
        return time_name(path);
  return "time";
}

/// What a factor's numbers are, by its option; empty: one of several things.
std::string dimension_of(const Factor& factor) {
  if (factor.option == "rotate") return factor.before.ends_with(",") && factor.after.empty() ? "degrees" : "";
  if (factor.option == "E") return "pressure";
  if (factor.option == "move" || factor.option == "thickness") return "length";
  return factor.option == "force" ? "force" : "";
}

/// Flags of levels, of each column: of the one with most that are left every second one goes, its ends stay. False: no
/// column has more than two left.
bool thin(std::vector<std::vector<char>>& levels) {
  const auto left = [](const std::vector<char>& kept) { return std::count(kept.begin(), kept.end(), 1); };
  const auto longest =
      std::max_element(levels.begin(), levels.end(), [&](const auto& a, const auto& b) { return left(a) < left(b); });
  if (longest == levels.end() || left(*longest) <= 2) return false;
  const std::ptrdiff_t last = left(*longest) - 1;
  std::ptrdiff_t i = 0;
  for (char& level : *longest)
    if (level != 0) {
      level = i % 2 == 0 || i == last;
      ++i;
    }
  return true;
}

}  // namespace

std::optional<double> number_in(const std::string& text) {
  try {
    return parse_number(text);
  } catch (const BadValue&) {
    return std::nullopt;
  }
}

StudyColumn make_column(const std::string& name, const std::vector<std::string>& texts) {
  StudyColumn c;
  c.name = name;
  std::unordered_map<std::string, int> known;
  for (const std::string& text : texts) {
    const auto [found, is_new] = known.emplace(text, static_cast<int>(c.levels.size()));
    if (is_new) c.levels.push_back(text);
    c.level.push_back(found->second);
  }
  std::vector<std::optional<double>> numbers;
  for (const std::string& text : c.levels) numbers.push_back(number_in(text));
  c.numeric =
      !numbers.empty() && std::all_of(numbers.begin(), numbers.end(), [](const auto& x) { return x.has_value(); });
  std::vector<int> order(c.levels.size()), place(c.levels.size());
  std::iota(order.begin(), order.end(), 0);
  if (c.numeric)
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return *numbers[at(a)] < *numbers[at(b)]; });
  std::vector<std::string> levels;
  for (int i : order) {
    if (!c.numeric || c.numbers.empty() || c.numbers.back() != *numbers[at(i)]) {
      c.numbers.push_back(c.numeric ? *numbers[at(i)] : static_cast<double>(levels.size()));
      levels.push_back(c.levels[at(i)]);
    }
    place[at(i)] = static_cast<int>(levels.size()) - 1;
  }
  c.levels = std::move(levels);
  for (int& level : c.level) level = place[at(level)];
  return c;
}

std::string option_of(const StudyHead& head, const std::string& option) {
  const std::string start = "--" + option + " ";
  for (const std::string& text : head.identity.options)
    if (text.starts_with(start)) return text.substr(start.size());
  return "";
}

std::vector<std::string> short_names(const std::vector<std::string>& paths) {
  std::unordered_map<std::string, int> count;  // paths that end so
  for (const std::string& path : paths)
    for (std::size_t start : tail_starts(path)) ++count[path.substr(start)];
  std::vector<std::string> names;
  for (const std::string& path : paths) {
    names.push_back(path);
    for (std::size_t start : tail_starts(path)) {
      if (count[path.substr(start)] > 1) continue;
      names.back() = path.substr(start);
      break;
    }
  }
  return names;
}

const std::vector<StudyStatistic>& headline_statistics() {
  static const std::vector<StudyStatistic> statistics = {
      {"headline_p99", "99th percentile of pressure", "p99", "pressure"},
      {"headline_mean", "Mean pressure", "mean pressure", "pressure"},
      {"headline_area", "Contact area", "contact area", "area"},
      {"headline_peak", "Peak pressure", "peak pressure", "pressure"},
      {kForce, "Contact force", "force", "force"}};  // take_values relies on this order
  return statistics;
}

int StudyColumn::find(const std::string& text) const {
  const auto found = std::find(levels.begin(), levels.end(), text);
  if (found != levels.end()) return static_cast<int>(found - levels.begin());
  const std::optional<double> x = numeric ? number_in(text) : std::nullopt;
  for (std::size_t l = 0; x && l < levels.size(); ++l)
    if (numbers[l] == *x) return static_cast<int>(l);
  return -1;
}

std::vector<std::vector<std::size_t>> StudyColumn::cases() const {
  std::vector<std::vector<std::size_t>> of_level(levels.size());
  for (std::size_t c = 0; c < level.size(); ++c) of_level[at(level[c])].push_back(c);
  return of_level;
}

std::vector<double> StudyColumn::values() const {
  std::vector<double> out;
  for (int l : level) out.push_back(numbers[at(l)]);
  return out;
}

std::vector<double> StudyNumbers::outputs(std::size_t statistic, std::size_t place, std::size_t choice) const {
  std::vector<double> out;
  for (std::size_t c = 0; c < cases.size(); ++c) out.push_back(value(statistic, place, c, choice));
  return out;
}

std::size_t StudyNumbers::own_columns() const {
  return static_cast<std::size_t>(
      std::count_if(columns.begin(), columns.end(), [](const StudyColumn& c) { return c.of.empty(); }));
}

int StudyNumbers::case_of(double number) const {
  const auto found = std::lower_bound(cases.begin(), cases.end(), number,
                                      [](const StudyCase& c, double x) { return static_cast<double>(c.number) < x; });
  return found != cases.end() && static_cast<double>(found->number) == number ? static_cast<int>(found - cases.begin())
                                                                              : -1;
}

int StudyNumbers::column(const std::string& name) const {
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (lower_case(columns[i].name) == lower_case(name)) return static_cast<int>(i);
  return -1;
}

void add_largest(StudyNumbers& n) {
  if (n.states < 2) return;
  for (std::size_t s = 0; s < n.values.size(); ++s) {
    const double sign = n.statistics[s].compression ? -1.0 : 1.0;
    for (std::vector<double>& v : n.values[s]) {
      for (std::size_t c = 0; c < n.cases.size(); ++c) {
        double& largest = v[c * n.choices() + n.states];
        largest = kNaN;
        for (std::size_t k = 0; n.complete[c] != 0 && k < n.states; ++k) {
          const double x = v[c * n.choices() + k];
          if (std::isfinite(x) && !(sign * largest >= sign * x)) largest = x;
        }
      }
    }
  }
}

bool is_solution(const std::string& outcome) {
  for (const Outcome o : {Outcome::Prescribed, Outcome::Balanced, Outcome::BalancedToOneSpring})
    if (outcome == name(o)) return solved(o);
  return false;
}

StudyNumbers read_study_numbers(const std::string& path) {
  StudyNumbers n;
  n.head = read_study_head(path);
  n.cases = read_cases(path);
  if (n.cases.empty()) throw InputError(fmt::format("{}: found a study without a single case, expected some", path));
  const std::string units = option_of(n.head, "units");
  n.units = unit_names(units.empty() ? units_of_model(n.head) : units);
  n.time_name = time_name_of_table(n.head);
  make_columns(n);
  for (const Factor& factor : n.head.factors)
    for (StudyColumn& column : n.columns)
      if (column.name == factor.name && column.numeric) column.dimension = dimension_of(factor);
  n.grid = is_grid(n);
  const std::vector<std::vector<char>> good = take_states(path, n);
  take_values(path, good, n);
  add_largest(n);
  return n;
}

std::vector<char> thinned_cases(const StudyNumbers& n, const std::vector<char>& may,
                                const std::function<bool(const std::vector<char>& kept)>& fits) {
  std::vector<char> kept = may;
  std::vector<std::vector<char>> levels;  // of each own column: is it left?
  for (std::size_t k = 0; k < n.own_columns(); ++k) levels.emplace_back(n.columns[k].levels.size(), 1);
  while (!fits(kept) && n.grid && thin(levels))
    for (std::size_t c = 0; c < may.size(); ++c) {
      kept[c] = may[c];
      for (std::size_t k = 0; k < levels.size(); ++k) kept[c] = kept[c] && levels[k][at(n.columns[k].level[c])];
    }
  const std::vector<char> before = kept;
  for (std::size_t every = 2; !fits(kept) && every <= may.size(); every *= 2) {
    std::size_t i = 0;
    for (std::size_t c = 0; c < may.size(); ++c) kept[c] = before[c] != 0 && i++ % every == 0 ? 1 : 0;
  }
  return kept;
}

}  // namespace dea

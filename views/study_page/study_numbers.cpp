#include <febiodea/views/study_page/study_numbers.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numeric>
#include <set>
#include <unordered_map>

#include <febiodea/base/numbers.h>
#include <febiodea/base/parse.h>
#include <febiodea/equilibrium/search.h>
#include <febiodea/io/feb/read_feb.h>

namespace dea {

namespace {

constexpr const char* kForce = "force";

std::optional<double> number_in(const std::string& text) {
  try {
    const double x = parse_number(text);
    return std::isfinite(x) ? std::optional<double>(x) : std::nullopt;
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
    place[at(i)] = static_cast<int>(levels.size());
    c.numbers.push_back(c.numeric ? *numbers[at(i)] : static_cast<double>(levels.size()));
    levels.push_back(c.levels[at(i)]);
  }
  c.levels = std::move(levels);
  for (int& level : c.level) level = place[at(level)];
  return c;
}

/// Without folders, where they differ without them.
std::vector<std::string> model_names(const std::vector<std::string>& paths) {
  std::vector<std::string> names;
  for (const std::string& path : paths) names.push_back(std::filesystem::path(path).filename().string());
  return std::set<std::string>(names.begin(), names.end()).size() == paths.size() ? names : paths;
}

void make_columns(StudyNumbers& n) {
  std::vector<StudyColumn> all;
  std::vector<std::string> texts;
  const std::vector<std::string> models = model_names(n.head.models);
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

/// Which case of `n` has this number; -1: none, as where another program has added it since.
class CaseIndex {
 public:
  explicit CaseIndex(const StudyNumbers& n) {
    for (std::size_t i = 0; i < n.cases.size(); ++i) index_[static_cast<std::int64_t>(n.cases[i].number)] = i;
  }
  std::ptrdiff_t of(std::int64_t number) const {
    const auto found = index_.find(number);
    return found == index_.end() ? -1 : static_cast<std::ptrdiff_t>(found->second);
  }

 private:
  std::unordered_map<std::int64_t, std::size_t> index_;
};

/// States, their times, and which are solutions: per case and state 1.
std::vector<std::vector<char>> take_states(const std::string& path, const CaseIndex& index, StudyNumbers& n) {
  std::vector<std::vector<char>> good(n.cases.size());
  n.own_times.resize(n.cases.size());
  for (StudyState& s : read_states(path)) {
    const std::ptrdiff_t c = index.of(s.case_id);
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

std::vector<std::string> columns_to_read() {
  std::vector<std::string> names;
  for (const StudyStatistic& s : study_statistics())
    if (std::string(s.name) != kForce) names.emplace_back(s.name);
  for (const char* name : {"force_x", "force_y", "force_z"}) names.emplace_back(name);
  return names;
}

void take_values(const std::string& path, const CaseIndex& index, const std::vector<std::vector<char>>& good,
                 StudyNumbers& n) {
  StudyRows rows = read_rows(path, columns_to_read());
  n.places = std::move(rows.places);
  const std::size_t count = study_statistics().size(), size = n.cases.size() * n.choices();
  n.values.assign(count, std::vector<std::vector<double>>(n.places.size(), std::vector<double>(size, kNaN)));
  for (std::size_t r = 0; r < rows.case_id.size(); ++r) {
    const std::ptrdiff_t c = index.of(rows.case_id[r]);
    if (c < 0 || rows.state[r] < 1 || at(rows.state[r]) > good[at(c)].size()) continue;
    const std::size_t k = at(rows.state[r] - 1);
    if (good[at(c)][k] == 0) continue;
    const std::size_t cell = at(c) * n.choices() + k, place = at(rows.place[r]);
    for (std::size_t s = 0; s + 1 < count; ++s) n.values[s][place][cell] = rows.numbers[s][r];
    n.values[count - 1][place][cell] =
        std::hypot(rows.numbers[count - 1][r], rows.numbers[count][r], rows.numbers[count + 1][r]);
  }
}

/// The unit system that `--units` among the options says; empty: it is not there.
std::string units_option(const StudyHead& head) {
  constexpr const char* kOption = "--units ";
  for (const std::string& text : head.identity.options)
    if (text.rfind(kOption, 0) == 0) return text.substr(std::string(kOption).size());
  return "";
}

/// Of a model that is still the file that the study was made from.
std::string units_of_model(const StudyHead& head) {
  if (head.models.empty()) return "";
  const std::string& model = head.models.front();
  try {
    for (const auto& [path, digest] : head.identity.inputs)
      if (path == model && file_digest(path) == digest) return read_feb(model).units;
  } catch (const InputError&) {  // it is not there, or cannot be read any more: no units are known
  }
  return "";
}

}  // namespace

const std::vector<StudyStatistic>& study_statistics() {
  static const std::vector<StudyStatistic> statistics = {
      {"headline_p99", "99th percentile of pressure", "p99", "pressure"},
      {"headline_mean", "Mean pressure", "mean pressure", "pressure"},
      {"headline_area", "Contact area", "contact area", "area"},
      {"headline_peak", "Peak pressure", "peak pressure", "pressure"},
      {kForce, "Contact force", "force", "force"}};
  return statistics;
}

std::vector<double> StudyColumn::values() const {
  std::vector<double> out;
  for (int l : level) out.push_back(numeric ? numbers[at(l)] : kNaN);
  return out;
}

std::vector<double> StudyNumbers::outputs(std::size_t statistic, std::size_t place, std::size_t choice) const {
  std::vector<double> out;
  for (std::size_t c = 0; c < cases.size(); ++c) out.push_back(value(statistic, place, c, choice));
  return out;
}

int StudyNumbers::column(const std::string& name) const {
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (lower_case(columns[i].name) == lower_case(name)) return static_cast<int>(i);
  return -1;
}

void add_largest(StudyNumbers& n) {
  if (n.states < 2) return;
  for (auto& of_statistic : n.values) {
    for (std::vector<double>& v : of_statistic) {
      for (std::size_t c = 0; c < n.cases.size(); ++c) {
        double& largest = v[c * n.choices() + n.states];
        largest = kNaN;
        for (std::size_t k = 0; n.complete[c] != 0 && k < n.states; ++k) {
          const double x = v[c * n.choices() + k];
          if (std::isfinite(x) && !(largest >= x)) largest = x;
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
  const std::string units = units_option(n.head);
  n.units = unit_names(units.empty() ? units_of_model(n.head) : units);
  make_columns(n);
  n.grid = is_grid(n);
  const CaseIndex index(n);
  const std::vector<std::vector<char>> good = take_states(path, index, n);
  take_values(path, index, good, n);
  add_largest(n);
  return n;
}

}  // namespace dea

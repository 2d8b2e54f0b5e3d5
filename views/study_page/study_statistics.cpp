#include "views/study_page/study_statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/parse.h"

namespace dea {

namespace {

std::string option_text(const StudyHead& head, const std::string& option) {
  const std::string start = "--" + option + " ";
  for (const std::string& text : head.identity.options)
    if (text.rfind(start, 0) == 0) return text.substr(start.size());
  return "";
}

void find_saltelli(const StudyNumbers& n, StudyDesign& design) {
  if (option_text(n.head, "sample") != "saltelli") {
    design.no_sobol = "The cases are no Saltelli design (--sample saltelli), which Sobol indices need.";
    return;
  }
  std::vector<int> columns;
  for (const Factor& f : n.head.factors)
    if (f.spread.kind != Spread::Kind::None) columns.push_back(n.column(f.name));
  const std::size_t rows = columns.size() + 2;
  std::size_t count = 0;
  try {
    count = static_cast<std::size_t>(parse_number(option_text(n.head, "count")));
  } catch (const BadValue&) {
  }
  if (columns.empty() || n.head.planned != count * rows) {
    design.no_sobol = "Sobol indices are of one sample; here it is combined with other models or values of factors.";
    return;
  }
  design.saltelli = static_cast<int>(columns.size());
  design.saltelli_columns = columns;
}

int middle_level(const StudyColumn& c) { return static_cast<int>((c.levels.size() - 1) / 2); }

/// -1: it is no case.
int middle_of_grid(const StudyNumbers& n) {
  const std::size_t own = n.own_columns();
  for (std::size_t c = 0; c < n.cases.size(); ++c) {
    std::size_t k = 0;
    while (k < own && n.columns[k].level[c] == middle_level(n.columns[k])) ++k;
    if (k == own) return static_cast<int>(c);
  }
  return -1;
}

/// Per case: how many others differ from it in one own column, and in nothing else.
std::vector<std::size_t> neighbours(const StudyNumbers& n) {
  const std::size_t own = n.own_columns();
  std::vector<std::size_t> count(n.cases.size(), 0), order(n.cases.size());
  for (std::size_t k = 0; k < own; ++k) {
    // cases that are alike in all but column k come to stand side by side, those alike in k too beside each other
    const auto differs = [&](std::size_t a, std::size_t b, bool in_k) -> int {
      for (std::size_t i = 0; i < own; ++i)
        if ((i == k) == in_k && n.columns[i].level[a] != n.columns[i].level[b])
          return n.columns[i].level[a] < n.columns[i].level[b] ? -1 : 1;
      return 0;
    };
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      const int others = differs(a, b, false);
      return others != 0 ? others < 0 : differs(a, b, true) < 0;
    });
    for (std::size_t first = 0, end = 0; first < order.size(); first = end) {
      while (end < order.size() && differs(order[first], order[end], false) == 0) ++end;
      for (std::size_t i = first, last = first; i < end; i = last) {
        while (last < end && differs(order[i], order[last], true) == 0) ++last;
        for (std::size_t c = i; c < last; ++c) count[order[c]] += (end - first) - (last - i);
      }
    }
  }
  return count;
}

/// -1: no case has a neighbour.
int best_connected(const StudyNumbers& n) {
  const std::vector<std::size_t> count = neighbours(n);
  const auto from_middle = [&](std::size_t c) {
    double sum = 0.0;
    for (std::size_t k = 0; k < n.own_columns(); ++k) {
      const StudyColumn& column = n.columns[k];
      sum += std::abs(column.level[c] - middle_level(column)) / static_cast<double>(column.levels.size());
    }
    return sum;
  };
  std::size_t best = 0;
  for (std::size_t c = 1; c < count.size(); ++c)
    if (count[c] > count[best] || (count[c] == count[best] && from_middle(c) < from_middle(best))) best = c;
  return count.empty() || count[best] == 0 ? -1 : static_cast<int>(best);
}

/// Of the study's own columns.
std::vector<std::vector<double>> column_numbers(const StudyNumbers& n) {
  std::vector<std::vector<double>> numbers;
  for (std::size_t k = 0; k < n.own_columns(); ++k) {
    numbers.emplace_back();
    for (int l : n.columns[k].level) numbers.back().push_back(n.columns[k].numbers[at(l)]);
  }
  return numbers;
}

std::vector<BaseSlope> base_slopes(const StudyNumbers& n, const StudyDesign& design,
                                   const std::vector<double>& outputs) {
  std::vector<BaseSlope> result;
  if (design.base < 0) return result;
  const std::vector<OneAtATime> all = one_at_a_time(column_numbers(n), outputs, at(design.base));
  for (int k : design.numeric) {
    if (!n.columns[at(k)].of.empty()) continue;
    const OneAtATime& one = all[at(k)];
    for (std::size_t i = 0; i < one.cases.size(); ++i) {
      if (one.cases[i] != at(design.base) || one.cases.size() < 2) continue;
      const StudyColumn& column = n.columns[at(k)];
      const double x = column.numbers[at(column.level[at(design.base)])];
      const double relative = x == 0 ? kNaN : one.slopes[i].value * x / outputs[at(design.base)];
      result.push_back({k, one.slopes[i], x, relative});
    }
  }
  return result;
}

/// Numbers that differ by no more than the search's tolerance are one number, such as the size of a force that the load
/// gives: what makes them differ is no factor.
std::vector<double> without_rounding(std::vector<double> outputs) {
  constexpr double kAlike = 1e-6;  // of the largest
  double least = kInfinity, most = -kInfinity;
  for (double x : outputs) {
    if (!std::isfinite(x)) continue;
    least = std::min(least, x);
    most = std::max(most, x);
  }
  if (!(most - least <= kAlike * std::max(std::abs(least), std::abs(most)))) return outputs;
  for (double& x : outputs)
    if (std::isfinite(x)) x = most;
  return outputs;
}

std::string level_list(const StudyColumn& c) { return name_list(c.levels, ""); }

/// Index of a level; numbers are compared as numbers: 8 is 8.0. -1: there is none.
int find_level(const StudyColumn& c, const std::string& level) {
  for (std::size_t i = 0; i < c.levels.size(); ++i)
    if (c.levels[i] == level) return static_cast<int>(i);
  if (!c.numeric) return -1;
  try {
    const double x = parse_number(level);
    for (std::size_t i = 0; i < c.levels.size(); ++i)
      if (c.numbers[i] == x) return static_cast<int>(i);
  } catch (const BadValue&) {
  }
  return -1;
}

int level_named(const StudyColumn& c, const std::string& option, const std::string& text, const std::string& level) {
  const int found = find_level(c, level);
  if (found >= 0) return found;
  throw UsageError(fmt::format("{} {}: found no value \"{}\" of {}{}, expected two of {}", option, text, level, c.name,
                               did_you_mean(level, c.levels), level_list(c)));
}

/// The comma of A,B: one that stands between two values, for a value may hold commas itself; else the first.
std::size_t comma_between_levels(const StudyColumn& c, const std::string& both) {
  const auto is_level = [&](const std::string& s) { return find_level(c, s) >= 0; };
  for (std::size_t i = both.find(','); i != std::string::npos; i = both.find(',', i + 1))
    if (is_level(both.substr(0, i)) && is_level(both.substr(i + 1))) return i;
  return both.find(',');
}

/// Columns in which partners of a pair must be alike.
std::vector<std::size_t> alike_in_pairs(const StudyNumbers& n, int column, const std::string& by_option,
                                        const std::string& by) {
  const std::string& of = n.columns[at(column)].of;
  const int only = by.empty() ? -1 : study_column(n, by_option, by);
  if (only >= 0 && (of.empty() || n.columns[at(only)].of.empty() || only == column))
    throw UsageError(
        fmt::format("{} {}: belongs to pairs by a column of the table of subjects, and is another column "
                    "of it",
                    by_option, by));
  std::vector<std::size_t> alike;
  for (std::size_t k = 0; k < n.columns.size(); ++k) {
    const StudyColumn& c = n.columns[k];
    if (static_cast<int>(k) == column) continue;
    if (c.of.empty() ? c.name != of : !of.empty() && (only < 0 || static_cast<int>(k) == only)) alike.push_back(k);
  }
  return alike;
}

}  // namespace

StudyDesign study_design(const StudyNumbers& n) {
  StudyDesign design;
  for (std::size_t i = 0; i < n.columns.size(); ++i)
    if (n.columns[i].numeric) design.numeric.push_back(static_cast<int>(i));
  find_saltelli(n, design);
  const bool drawn = std::any_of(n.head.factors.begin(), n.head.factors.end(),
                                 [](const Factor& f) { return f.spread.kind != Spread::Kind::None; });
  if (drawn) {
    design.no_slopes = "The cases are drawn: none has a neighbour for a slope by one factor.";
    return design;
  }
  design.base = n.grid ? middle_of_grid(n) : -1;
  if (design.base < 0) design.base = best_connected(n);
  if (design.base < 0) design.no_slopes = "No case has another one beside it that differs in one factor only.";
  const std::vector<std::vector<double>> numbers = column_numbers(n);
  for (std::size_t a = 0; design.base >= 0 && a < n.cases.size(); ++a) {
    if (a == at(design.base)) continue;
    if (std::all_of(numbers.begin(), numbers.end(),
                    [&](const std::vector<double>& x) { return x[a] == x[at(design.base)]; })) {
      design.base = -1;
      design.no_slopes = "Two cases have the same values in all factors: there are no slopes between them.";
    }
  }
  return design;
}

Influence influence(const StudyNumbers& n, const StudyDesign& design, const std::vector<double>& found,
                    const Bootstrap& bootstrap) {
  Influence result;
  const std::vector<double> outputs = without_rounding(found);
  std::vector<std::vector<double>> factors;
  for (int k : design.numeric) factors.push_back(n.columns[at(k)].values());
  result.regression = regression(factors, outputs);
  for (const std::vector<double>& factor : factors) result.ranks.push_back(rank_correlation(factor, outputs));
  if (design.saltelli > 0) {
    std::vector<double> in_order(n.head.planned, kNaN);
    for (std::size_t c = 0; c < n.cases.size(); ++c)
      if (n.cases[c].number >= 1 && n.cases[c].number <= in_order.size()) in_order[n.cases[c].number - 1] = outputs[c];
    result.sobol = sobol_indices(in_order, design.saltelli, bootstrap);
  }
  result.slopes = base_slopes(n, design, outputs);
  return result;
}

GroupNumbers group_numbers(const StudyColumn& column, const std::vector<double>& found) {
  const std::vector<double> outputs = without_rounding(found);
  std::vector<std::vector<double>> values(column.levels.size());
  std::vector<std::vector<std::size_t>> cases(column.levels.size());
  for (std::size_t c = 0; c < outputs.size(); ++c) {
    values[at(column.level[c])].push_back(outputs[c]);
    cases[at(column.level[c])].push_back(c);
  }
  GroupNumbers g;
  for (std::size_t l = 0; l < values.size(); ++l) {
    g.boxes.push_back(box_plot(values[l]));
    for (std::size_t& i : g.boxes.back().outliers) i = cases[l][i];
    if (l == 0) continue;
    g.differences.push_back(mean_difference(values[l], values[0]));
    g.effects.push_back(cohen_d(values[l], values[0]));
  }
  return g;
}

int study_column(const StudyNumbers& n, const std::string& option, const std::string& name) {
  const int column = n.column(name);
  if (column >= 0) return column;
  std::vector<std::string> names;
  for (const StudyColumn& c : n.columns) names.push_back(c.name);
  throw UsageError(fmt::format("{} {}: found no column \"{}\" that differs from case to case{}; there {}", option, name,
                               name, did_you_mean(name, names),
                               names.empty() ? std::string("is none") : "are " + name_list(names, name)));
}

StudyPairs study_pairs(const StudyNumbers& n, const std::string& option, const std::string& text,
                       const std::string& by_option, const std::string& by) {
  StudyPairs pairs;
  const std::size_t equals = text.find('=');
  pairs.column = study_column(n, option, text.substr(0, equals));
  const StudyColumn& column = n.columns[at(pairs.column)];
  if (equals != std::string::npos) {
    const std::string both = text.substr(equals + 1);
    const std::size_t comma = comma_between_levels(column, both);
    if (comma == std::string::npos)
      throw UsageError(fmt::format("{} {}: found one value, expected two: {}=A,B", option, text, column.name));
    pairs.first = level_named(column, option, text, both.substr(0, comma));
    pairs.second = level_named(column, option, text, both.substr(comma + 1));
  } else if (column.levels.size() != 2) {
    throw UsageError(fmt::format("{} {}: found {} values of {}, expected two: {} {}=A,B", option, text,
                                 column.levels.size(), column.name, option, column.name));
  }
  if (pairs.first == pairs.second)
    throw UsageError(fmt::format("{} {}: found the same value twice, expected two", option, text));
  const std::vector<std::size_t> alike = alike_in_pairs(n, pairs.column, by_option, by);
  std::map<std::vector<int>, std::array<int, 2>> partners;
  for (std::size_t c = 0; c < n.cases.size(); ++c) {
    const int level = column.level[c];
    if (level != pairs.first && level != pairs.second) continue;
    std::vector<int> others;
    for (std::size_t k : alike) others.push_back(n.columns[k].level[c]);
    auto& pair = partners.emplace(others, std::array<int, 2>{-1, -1}).first->second;
    int& place = pair[level == pairs.first ? 0 : 1];
    if (place >= 0)
      throw UsageError(fmt::format(
          "{} {}: found cases {} and {} with the same values, expected one case each{}", option, text,
          n.cases[at(place)].number, n.cases[c].number,
          column.of.empty() ? "" : ": another column of the table must tell who is who, such as \"subject\""));
    place = static_cast<int>(c);
  }
  for (const auto& [others, pair] : partners) {
    if (pair[0] >= 0 && pair[1] >= 0)
      pairs.cases.push_back(pair);
    else
      ++pairs.alone;
  }
  std::sort(pairs.cases.begin(), pairs.cases.end());
  if (pairs.cases.empty())
    throw UsageError(
        fmt::format("{} {}: found no two cases that differ in {} alone, expected pairs{}", option, text, column.name,
                    column.of.empty() || by_option.empty() || !by.empty()
                        ? ""
                        : fmt::format("; {} COLUMN names the one column of the table that partners share", by_option)));
  return pairs;
}

PairNumbers pair_numbers(const StudyPairs& pairs, const std::vector<double>& found) {
  const std::vector<double> outputs = without_rounding(found);
  std::vector<double> first, second;
  for (const std::array<int, 2>& pair : pairs.cases) {
    first.push_back(outputs[at(pair[0])]);
    second.push_back(outputs[at(pair[1])]);
  }
  const CompletePairs complete = complete_pairs(first, second);
  return {box_plot(complete.first), box_plot(complete.second), paired_difference(first, second),
          paired_d_z(first, second), bland_altman(first, second)};
}

StudyInstants study_instants(const StudyNumbers& n) {
  StudyInstants result;
  if (n.states < 2) return result;
  if (n.same_times) {
    result.instants = n.times;
  } else {
    result.percent = true;
    for (int i = 0; i <= 50; ++i) result.instants.push_back(2.0 * i);
  }
  for (std::size_t i = 1; i < result.instants.size(); ++i)
    if (!(result.instants[i] > result.instants[i - 1])) return {};  // two states at one time: no curve over it
  return result;
}

std::vector<std::vector<double>> study_lines(const StudyNumbers& n, const StudyInstants& at_these,
                                             std::size_t statistic, std::size_t place,
                                             const std::vector<std::size_t>& cases) {
  std::vector<std::vector<double>> lines;
  for (std::size_t c : cases) {
    const std::vector<double>& times = n.own_times[c];
    std::vector<double> values;
    for (std::size_t k = 0; k < times.size(); ++k) values.push_back(n.value(statistic, place, c, k));
    const bool rising =
        std::adjacent_find(times.begin(), times.end(), [](double a, double b) { return !(b > a); }) == times.end();
    if (times.size() < 2 || !rising)
      lines.emplace_back(at_these.instants.size(), kNaN);
    else if (at_these.percent)
      lines.push_back(at_instants(percent_of_cycle(times), values, at_these.instants));
    else
      lines.push_back(values);
  }
  return lines;
}

}  // namespace dea

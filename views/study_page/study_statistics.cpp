#include "views/study_page/study_statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/parse.h"
#include "src/study/pairs.h"

namespace dea {

namespace {

void find_saltelli(const StudyNumbers& n, StudyDesign& design) {
  if (option_of(n.head, "sample") != "saltelli") {
    design.no_sobol = "The cases are no Saltelli design (--sample saltelli), which Sobol indices need.";
    return;
  }
  std::vector<int> columns;
  for (const Factor& f : n.head.factors)
    if (f.spread.kind != Spread::Kind::None) columns.push_back(n.column(f.name));
  const std::size_t rows = columns.size() + 2;
  const auto count = static_cast<std::size_t>(number_in(option_of(n.head, "count")).value_or(0.0));
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
  for (std::size_t k = 0; k < n.own_columns(); ++k) numbers.push_back(n.columns[k].values());
  return numbers;
}

Json interval_json(const Interval& i) { return {short_number(i.low), short_number(i.high)}; }

/// About the base case, of own columns among the numeric ones, as far as they have neighbours. "relative": percent of
/// the number per percent of the factor: slope times factor over number; null: the factor is 0.
Json slopes_json(const StudyNumbers& n, const StudyDesign& design, const std::vector<double>& outputs) {
  Json j = Json::array();
  if (design.base < 0) return j;
  const std::size_t base = at(design.base);
  const std::vector<std::optional<Slope>> slopes = slopes_about(column_numbers(n), outputs, base);
  const char* kinds[] = {"none", "forward", "backward", "central"};
  for (int k : design.numeric) {
    const StudyColumn& column = n.columns[at(k)];
    if (!column.of.empty() || !slopes[at(k)]) continue;
    const Slope& slope = *slopes[at(k)];
    const double x = column.numbers[at(column.level[base])];
    j.push_back({{"column", k},
                 {"kind", kinds[static_cast<int>(slope.kind)]},
                 {"at", short_number(x)},
                 {"slope", short_number(slope.value)},
                 {"relative", short_number(x == 0 ? kNaN : slope.value * x / outputs[base])}});
  }
  return j;
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

int level_named(const StudyColumn& c, const std::string& option, const std::string& text, const std::string& level) {
  const int found = c.find(level);
  if (found >= 0) return found;
  throw UsageError(fmt::format("{} {}: found no value \"{}\" of {}{}, expected two of {}", option, text, level, c.name,
                               did_you_mean(level, c.levels), name_list(c.levels, "")));
}

/// The comma of A,B: one that stands between two values, for a value may hold commas itself; else the first.
std::size_t comma_between_levels(const StudyColumn& c, const std::string& both) {
  for (std::size_t i = both.find(','); i != std::string::npos; i = both.find(',', i + 1))
    if (c.find(both.substr(0, i)) >= 0 && c.find(both.substr(i + 1)) >= 0) return i;
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

Json box_json(const BoxPlot& b) {
  return {{"count", b.count},
          {"left_out", b.left_out},
          {"least", short_number(b.least)},
          {"low", short_number(b.lower_whisker)},
          {"q1", short_number(b.q1)},
          {"median", short_number(b.median)},
          {"q3", short_number(b.q3)},
          {"high", short_number(b.upper_whisker)},
          {"largest", short_number(b.largest)},
          {"mean", short_number(b.mean)},
          {"sd", short_number(b.standard_deviation)}};
}

Json influence_json(const StudyNumbers& n, const StudyDesign& design, const std::vector<double>& found,
                    const Bootstrap& bootstrap) {
  const std::vector<double> outputs = without_rounding(found);
  std::vector<std::vector<double>> factors;
  for (int k : design.numeric) factors.push_back(n.columns[at(k)].values());
  const Regression fit = regression(factors, outputs);
  Json j = {{"r_squared", short_number(fit.r_squared)},
            {"cases", fit.cases},
            {"left_out", fit.left_out},
            {"factors", Json::array()},
            {"sobol", nullptr}};
  for (std::size_t k = 0; k < factors.size(); ++k)
    j["factors"].push_back({{"column", design.numeric[k]},
                            {"coefficient", short_number(fit.coefficients[k])},
                            {"rho", short_number(rank_correlation(factors[k], outputs))}});
  if (design.saltelli > 0) {
    std::vector<double> in_order(n.head.planned, kNaN);
    for (std::size_t c = 0; c < n.cases.size(); ++c)
      if (n.cases[c].number >= 1 && n.cases[c].number <= in_order.size()) in_order[n.cases[c].number - 1] = outputs[c];
    j["sobol"] = Json::array();
    for (const SobolIndex& s : sobol_indices(in_order, design.saltelli, bootstrap))
      j["sobol"].push_back({{"column", design.saltelli_columns[j["sobol"].size()]},
                            {"first", short_number(s.first)},
                            {"first_interval", interval_json(s.first_interval)},
                            {"total", short_number(s.total)},
                            {"total_interval", interval_json(s.total_interval)},
                            {"rows", s.rows},
                            {"left_out", s.left_out}});
  }
  j["slopes"] = slopes_json(n, design, outputs);
  return j;
}

Json difference_json(const std::vector<double>& first, const std::vector<double>& second) {
  const MeanDifference d = mean_difference(first, second);
  return {{"count", {d.count[0], d.count[1]}},
          {"mean", short_number(d.mean)},
          {"interval", interval_json(d.interval)},
          {"d", short_number(d.effect.d)},
          {"g", short_number(d.effect.corrected)}};
}

Json group_json(const StudyNumbers& n, const StudyColumn& column, const std::vector<double>& found) {
  constexpr std::size_t kMostOutliers = 200;  // as rings
  const std::vector<double> outputs = without_rounding(found);
  const std::vector<std::vector<std::size_t>> cases = column.cases();
  std::vector<std::vector<double>> values(cases.size());
  for (std::size_t l = 0; l < cases.size(); ++l)
    for (std::size_t c : cases[l]) values[l].push_back(outputs[c]);
  Json boxes = Json::array(), differences = Json::array();
  for (std::size_t l = 0; l < values.size(); ++l) {
    const BoxPlot box = box_plot(values[l]);
    boxes.push_back(box_json(box));
    boxes.back()["outliers"] = Json::array();
    for (std::size_t i = 0; i < std::min(box.outliers.size(), kMostOutliers); ++i) {
      const std::size_t c = cases[l][box.outliers[i]];
      boxes.back()["outliers"].push_back({n.cases[c].number, short_number(found[c])});
    }
    if (l > 0) differences.push_back(difference_json(values[l], values[0]));
  }
  return {{"boxes", boxes}, {"differences", differences}};
}

Json pair_json(const std::vector<double>& first, const std::vector<double>& second) {
  const CompletePairs complete = complete_pairs(first, second);
  const PairedDifference d = paired_difference(complete);
  return {{"first", box_json(box_plot(complete.first))},
          {"second", box_json(box_plot(complete.second))},
          {"pairs", d.pairs},
          {"left_out", d.left_out},
          {"mean", short_number(d.mean)},
          {"sd", short_number(d.standard_deviation)},
          {"interval", interval_json(d.mean_interval)},
          {"median", short_number(d.median)},
          {"dz", short_number(d.effect.d)},
          {"g", short_number(d.effect.corrected)},
          {"limits", interval_json(d.limits)},
          {"lower_interval", interval_json(d.lower_limit_interval)},
          {"upper_interval", interval_json(d.upper_limit_interval)}};
}

int study_column(const StudyNumbers& n, const std::string& option, const std::string& name) {
  const int column = n.column(name);
  if (column >= 0) return column;
  const std::vector<std::string> names = every_name(n.columns);
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

Json pair_json(const StudyPairs& pairs, const std::vector<double>& found) {
  const std::vector<double> outputs = without_rounding(found);
  std::vector<double> first, second;
  for (const std::array<int, 2>& pair : pairs.cases) {
    first.push_back(outputs[at(pair[0])]);
    second.push_back(outputs[at(pair[1])]);
  }
  return pair_json(first, second);
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
  if (!rises(result.instants)) return {};  // two states at one time: no curve over it
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
    if (times.size() < 2 || !rises(times))
      lines.emplace_back(at_these.instants.size(), kNaN);
    else if (at_these.percent)
      lines.push_back(at_instants(percent_of_cycle(times), values, at_these.instants));
    else
      lines.push_back(values);
  }
  return lines;
}

}  // namespace dea

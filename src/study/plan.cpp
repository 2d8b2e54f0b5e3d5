#include "src/study/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <set>

#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/parse.h"
#include "src/base/say.h"

namespace dea {

namespace {

using Row = std::vector<std::string>;

NamedSetting setting(const char* name, const std::string& value) { return {name, "", value, "", true}; }

bool same(const std::string& a, const std::string& b) { return lower_case(a) == lower_case(b); }

/// Values of some factors that come together: rows of a table, points of a sample.
struct Rows {
  std::vector<std::size_t> factors;  ///< one per cell
  std::vector<Row> cells;
  std::vector<int> models;  ///< one per row; empty: each row is for all
};

void check_names(const std::vector<Factor>& factors) {
  std::set<std::string> seen;
  for (const Factor& f : factors) {
    if (same(f.name, "model"))
      throw UsageError("found a factor named \"model\", expected another name: it is the models' column");
    if (!seen.insert(lower_case(f.name)).second)
      throw UsageError(fmt::format("found two factors named \"{}\", expected different names", f.name));
  }
  if (factors.size() > kMostFactors)
    throw UsageError(fmt::format("found {} factors, expected at most {}", factors.size(), kMostFactors));
}

bool from_table(const Factor& f) { return f.values.empty() && f.spread.kind == Spread::Kind::None; }

/// A column's factor; -1: the model.
int column_factor(const CaseTable& table, const std::string& name, const std::vector<Factor>& factors) {
  if (same(name, "model")) return -1;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < factors.size(); ++i) {
    names.push_back(factors[i].name);
    if (!same(name, factors[i].name)) continue;
    if (from_table(factors[i])) return static_cast<int>(i);
    throw InputError(
        table.path, table.names_line,
        fmt::format("column \"{}\": this factor has values of its own, expected {{}} in its option", name));
  }
  names.emplace_back("model");
  throw InputError(
      Fault{.place = table.names_line > 0 ? fmt::format("{}:{}", table.path, table.names_line) : table.path,
            .found = say("found column \"{}\"{},", name, did_you_mean(name, names)),
            .expected = say("expected the names of factors: {}; a column that only describes models is for {}",
                            name_list(names, name), NamedSetting{"subjects"})});
}

int model_index(std::vector<std::string>& models, bool given, const std::string& name) {
  const auto found = std::find(models.begin(), models.end(), name);
  if (found != models.end()) return static_cast<int>(found - models.begin());
  if (given)
    throw BadValue(fmt::format("found \"{}\"{}, expected one of the models on the line: {}", name,
                               did_you_mean(name, models), name_list(models, name)));
  models.push_back(name);
  return static_cast<int>(models.size() - 1);
}

Rows table_rows(const CaseTable& table, const std::vector<Factor>& factors, std::vector<std::string>& models) {
  Rows out;
  std::vector<int> columns;
  std::set<int> seen;
  for (const std::string& name : table.names) {
    columns.push_back(column_factor(table, name, factors));
    if (!seen.insert(columns.back()).second)
      throw InputError(table.path, table.names_line, fmt::format("found column \"{}\" twice, expected one", name));
    if (columns.back() >= 0) out.factors.push_back(at(columns.back()));
  }
  for (std::size_t i = 0; i < factors.size(); ++i)
    if (from_table(factors[i]) && seen.count(static_cast<int>(i)) == 0)
      throw InputError(
          table.path, table.names_line,
          fmt::format("found no column \"{}\", expected one: the factor's {{}} is filled from it", factors[i].name));
  const bool given = !models.empty();
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    out.cells.emplace_back();
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const std::string& cell = table.rows[r][c];
      try {
        if (is_missing(cell)) throw bad_value(cell, "a value");
        if (columns[c] < 0)
          out.models.push_back(model_index(models, given, cell));
        else
          out.cells.back().push_back(cell);
      } catch (const BadValue& bad) {
        throw InputError(table.path, table.lines[r], fmt::format("column \"{}\": {}", table.names[c], bad.what()));
      }
    }
  }
  return out;
}

const char* word(Design design) { return word_of(design, {"sobol", "latin", "saltelli"}); }

Rows sampled_rows(const Sampling& sampling, const std::vector<Factor>& factors) {
  Rows out;
  for (std::size_t i = 0; i < factors.size(); ++i)
    if (factors[i].spread.kind != Spread::Kind::None) out.factors.push_back(i);
  const NamedSetting sample = setting("sample", word(sampling.design));
  const std::size_t least = sampling.design == Design::Saltelli ? 2 : 1;
  if (out.factors.size() < least)
    throw UsageError(Fault{
        .given = sample,
        .found = say("found {} with a spread such as {{{{uniform(8,16)}}}},",
                     out.factors.empty() ? "no factor" : "one factor"),
        .expected = least == 2 ? "expected two or more, whose parts this design tells apart" : "expected one or more"});
  const int d = static_cast<int>(out.factors.size()), most = most_dimensions(sampling.design);
  if (d > most)
    throw UsageError(Fault{.given = sample, .found = say("found {} factors, expected at most {}", d, most)});
  const std::int64_t rows =
      static_cast<std::int64_t>(sampling.count) * (sampling.design == Design::Saltelli ? d + 2 : 1);
  if (rows > kMostCases)
    throw UsageError(Fault{
        .given = sample, .found = say("makes {} cases,", rows), .expected = say("expected at most {}", kMostCases)});
  for (const std::vector<double>& point : unit_points(sampling.design, d, sampling.count, sampling.seed)) {
    out.cells.emplace_back();
    for (std::size_t k = 0; k < point.size(); ++k)
      out.cells.back().push_back(fmt::format("{:.12g}", quantile(factors[out.factors[k]].spread, point[k])));
  }
  return out;
}

/// Factors that nothing fills.
void check_sources(const PlanRequest& r) {
  if (r.table && r.sampling)
    throw UsageError(Fault{.found = say("found {} beside {}, expected one of them", setting("cases", r.table->path),
                                        setting("sample", word(r.sampling->design)))});
  for (const Factor& f : r.factors) {
    if (from_table(f) && !r.table)
      throw UsageError(Fault{
          .found = say("factor \"{}\": found {{{{}}}} in its option,", f.name),
          .expected = say("expected a table of cases ({}), or values: {{{{8|12|16}}}}", setting("cases", "FILE"))});
    if (f.spread.kind != Spread::Kind::None && !r.sampling)
      throw UsageError(
          Fault{.found = say("factor \"{}\": found a spread to draw from,", f.name),
                .expected = say("expected how: {} {}", setting("sample", "sobol"), setting("count", "N"))});
  }
}

/// Cases as a number that may be far too large.
double case_count(const Plan& plan, const Rows& rows) {
  double count = rows.models.empty() ? static_cast<double>(plan.models.size()) : 1.0;
  if (!rows.cells.empty()) count *= static_cast<double>(rows.cells.size());
  for (const Factor& f : plan.factors)
    if (!f.values.empty()) count *= static_cast<double>(f.values.size());
  return count;
}

/// All combinations of the factors' own values for one model; each with rows `first` .. `last` - 1.
void add_cases(Plan& plan, int model, const Rows& rows, std::size_t first, std::size_t last) {
  const std::size_t n = plan.factors.size();
  std::vector<std::size_t> place(n, 0);
  for (;;) {
    PlannedCase c{model, std::vector<std::string>(n)};
    for (std::size_t i = 0; i < n; ++i)
      if (!plan.factors[i].values.empty()) c.values[i] = plan.factors[i].values[place[i]];
    for (std::size_t r = first; r < last; ++r) {
      for (std::size_t k = 0; k < rows.factors.size(); ++k) c.values[rows.factors[k]] = rows.cells[r][k];
      plan.cases.push_back(c);
    }
    if (rows.cells.empty()) plan.cases.push_back(std::move(c));
    std::size_t i = n;
    while (i > 0 && (plan.factors[i - 1].values.empty() || ++place[i - 1] == plan.factors[i - 1].values.size()))
      place[--i] = 0;
    if (i == 0) return;
  }
}

}  // namespace

bool is_missing(const std::string& cell) {
  const std::string word = lower_case(trimmed(cell));
  return std::set<std::string>{"", "nan", "-nan", "na", "n/a", "inf", "-inf"}.count(word) > 0;
}

Design parse_design(const std::string& text) {
  for (const Design design : {Design::Sobol, Design::Latin, Design::Saltelli})
    if (lower_case(trimmed(text)) == word(design)) return design;
  throw bad_value(text, "sobol, latin or saltelli", {"sobol", "latin", "saltelli"});
}

Plan make_plan(PlanRequest r) {
  check_names(r.factors);
  check_sources(r);
  std::set<std::string> models;
  for (const std::string& model : r.models)
    if (!models.insert(model).second)
      throw UsageError(fmt::format("found the model {} twice, expected each once", model));
  Plan plan{std::move(r.models), std::move(r.options), std::move(r.factors), {}};
  Rows rows;
  if (r.table) rows = table_rows(*r.table, plan.factors, plan.models);
  if (r.sampling) rows = sampled_rows(*r.sampling, plan.factors);
  if (plan.models.empty())
    throw UsageError("found no model, expected at least one, or a table of cases with a column \"model\"");
  const double count = case_count(plan, rows);
  if (count > static_cast<double>(kMostCases))
    throw UsageError(
        fmt::format("found {:.15g} cases, expected at most {}: fewer values, or a sample of them", count, kMostCases));
  plan.cases.reserve(static_cast<std::size_t>(count));
  if (rows.models.empty()) {
    for (std::size_t m = 0; m < plan.models.size(); ++m)
      add_cases(plan, static_cast<int>(m), rows, 0, rows.cells.size());
  } else {
    for (std::size_t i = 0; i < rows.models.size(); ++i) add_cases(plan, rows.models[i], rows, i, i + 1);
  }
  assert(static_cast<double>(plan.cases.size()) == count);
  return plan;
}

std::vector<CaseOption> options_of(const Plan& plan, const PlannedCase& c) {
  std::vector<CaseOption> options;
  for (const PlanOption& o : plan.options) {
    if (o.factor < 0) {
      options.push_back({o.name, o.text});
      continue;
    }
    const Factor& factor = plan.factors[at(o.factor)];
    options.push_back({factor.option, factor.before + c.values[at(o.factor)] + factor.after});
  }
  return options;
}

}  // namespace dea

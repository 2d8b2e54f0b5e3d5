#include "views/study_page/study_subjects.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <optional>

#include "io/files/output.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/parse.h"

namespace dea {

namespace {

constexpr const char* kCase = "case_id";
constexpr const char* kModel = "model";

bool same_word(const std::string& a, const std::string& b) { return lower_case(a) == lower_case(b); }

/// Does a path end in this, a whole folder or name at its begin?
bool ends_in(const std::string& path, const std::string& tail) {
  if (tail.empty() || !path.ends_with(tail)) return false;
  return tail.size() == path.size() || is_separator(path[path.size() - tail.size() - 1]);
}

/// What the rows of a table are of.
struct Keys {
  std::string column;                                ///< its name in the study
  std::vector<std::string> names;                    ///< as they are told of in messages
  std::vector<int> of_case;                          ///< per case: index of its key
  std::function<int(const std::string& cell)> find;  ///< -1: none. Throws BadValue: it may be several
  bool all_known = true;                             ///< false: cases that are not there yet may have others
};

int find_model(const std::vector<std::string>& models, const std::string& cell) {
  const auto whole = std::find(models.begin(), models.end(), cell);
  if (whole != models.end()) return static_cast<int>(whole - models.begin());
  for (const std::string& tail : {cell, cell + ".feb"}) {
    std::vector<std::string> found;
    int model = -1;
    for (std::size_t i = 0; i < models.size(); ++i) {
      if (!ends_in(models[i], tail)) continue;
      found.push_back(models[i]);
      model = static_cast<int>(i);
    }
    if (found.size() > 1)
      throw BadValue(fmt::format("found \"{}\", which may be {}, expected more of its path", cell, name_list(found)));
    if (model >= 0) return model;
  }
  return -1;
}

Keys keys_of(const StudyNumbers& n, const std::string& name) {
  Keys keys;
  if (same_word(name, kModel)) {
    keys.column = kModel;
    keys.names = short_names(n.head.models);
    for (const StudyCase& c : n.cases) keys.of_case.push_back(c.model);
    keys.find = [&models = n.head.models](const std::string& cell) { return find_model(models, cell); };
    return keys;
  }
  keys.all_known = n.cases.size() == n.head.planned;
  if (same_word(name, kCase)) {
    keys.column = kCase;
    for (std::size_t c = 0; c < n.cases.size(); ++c) {
      keys.names.push_back(fmt::format("{}", n.cases[c].number));
      keys.of_case.push_back(static_cast<int>(c));
    }
    keys.find = [&n](const std::string& cell) { return n.case_of(number_in(cell).value_or(0.0)); };
    return keys;
  }
  for (const auto* columns : {&n.columns, &n.constant})
    for (const StudyColumn& c : *columns) {
      if (!c.of.empty() || !same_word(c.name, name)) continue;
      keys.column = c.name;
      keys.names = c.levels;
      keys.of_case = c.level;
      keys.find = [&c](const std::string& cell) { return c.find(cell); };
    }
  return keys;  // subject_columns lets no other name through
}

/// Per case: its row in the table.
std::vector<int> rows_of_cases(const CaseTable& t, std::size_t key, const Keys& keys) {
  const std::string& name = t.names[key];
  std::vector<int> row_of(keys.names.size(), -1);
  for (std::size_t r = 0; r < t.rows.size(); ++r) {
    const std::string& cell = t.rows[r][key];
    int found = -1;
    try {
      found = keys.find(cell);
    } catch (const BadValue& bad) {
      throw InputError(t.path, t.lines[r], fmt::format("column \"{}\": {}", name, bad.what()));
    }
    if (found < 0 && !keys.all_known) continue;
    if (found < 0)
      throw InputError(t.path, t.lines[r],
                       fmt::format("found {} \"{}\"{}, expected one of the study's: {}", name, cell,
                                   did_you_mean(cell, keys.names), name_list(keys.names, cell)));
    if (row_of[at(found)] >= 0)
      throw InputError(t.path, t.lines[r],
                       fmt::format("found {} \"{}\" as in line {}, expected one row each", name, cell,
                                   t.lines[at(row_of[at(found)])]));
    row_of[at(found)] = static_cast<int>(r);
  }
  for (std::size_t k = 0; k < row_of.size(); ++k)
    if (row_of[k] < 0)
      throw InputError(
          fmt::format("{}: found no row of {} \"{}\", expected one row each", t.path, name, keys.names[k]));
  std::vector<int> row_of_case;
  for (int k : keys.of_case) row_of_case.push_back(row_of[at(k)]);
  return row_of_case;
}

}  // namespace

SubjectColumns subject_columns(const CaseTable& t, const std::vector<Factor>& factors) {
  std::vector<std::string> keys = {kModel, kCase};
  for (const Factor& f : factors) keys.push_back(f.name);
  SubjectColumns columns;
  std::vector<std::string> found;
  for (std::size_t i = 0; i < t.names.size(); ++i) {
    if (std::none_of(keys.begin(), keys.end(), [&](const std::string& key) { return same_word(key, t.names[i]); })) {
      columns.others.push_back(i);
      continue;
    }
    columns.key = i;
    found.push_back(t.names[i]);
  }
  if (found.size() != 1)
    throw InputError(
        t.path, t.names_line,
        fmt::format("found {}, expected one column that says what a row is of: {}",
                    found.empty() ? "columns " + name_list(t.names) : "columns " + name_list(found), name_list(keys)));
  if (columns.others.empty())
    throw InputError(
        t.path, t.names_line,
        fmt::format("found no column but \"{}\", expected others, such as \"subject\" or \"sex\"", found.front()));
  return columns;
}

void add_subjects(const CaseTable& t, StudyNumbers& n) {
  const SubjectColumns columns = subject_columns(t, n.head.factors);
  const Keys keys = keys_of(n, t.names[columns.key]);
  const std::vector<int> row_of_case = rows_of_cases(t, columns.key, keys);
  for (std::size_t i : columns.others) {
    for (std::size_t r = 0; r < t.rows.size(); ++r)
      if (is_missing(t.rows[r][i]))
        throw InputError(t.path, t.lines[r],
                         fmt::format("column \"{}\": found \"{}\", expected a value", t.names[i], t.rows[r][i]));
    std::vector<std::string> texts;
    for (int r : row_of_case) texts.push_back(t.rows[at(r)][i]);
    StudyColumn column = make_column(t.names[i], texts);
    column.of = keys.column;
    (column.levels.size() > 1 ? n.columns : n.constant).push_back(std::move(column));
  }
}

}  // namespace dea

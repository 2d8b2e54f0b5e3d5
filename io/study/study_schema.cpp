#include "io/study/study_schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "src/base/error.h"
#include "src/base/parse.h"
#include "src/equilibrium/search.h"
#include "src/results/contact_numbers.h"

namespace dea {

namespace {

template <class Of>
std::string number_columns(const std::vector<NamedNumber<Of>>& numbers) {
  std::string text;
  for (const NamedNumber<Of>& n : numbers)
    text += fmt::format("  {} {},\n", quoted_name(n.name), n.count ? "INTEGER" : "REAL");
  return text;
}

template <class Of>
std::string number_names(const std::vector<NamedNumber<Of>>& numbers, const char* table = "t") {
  std::string text;
  for (const NamedNumber<Of>& n : numbers) text += fmt::format("{}.{}, ", table, quoted_name(n.name));
  return text;
}

std::string vector_columns(const std::string& name) {
  return fmt::format("  {0}_x REAL, {0}_y REAL, {0}_z REAL,\n", name);
}

// What a row of `kState` belongs to goes with it.
constexpr const char* kCase = "  case_id INTEGER NOT NULL REFERENCES cases ON DELETE CASCADE,\n";
constexpr const char* kState = "  case_id INTEGER NOT NULL,\n  state INTEGER NOT NULL,\n";
constexpr const char* kOfState = "  FOREIGN KEY (case_id, state) REFERENCES states ON DELETE CASCADE";

std::string head_tables(const std::vector<Factor>& factors) {
  std::string columns;
  for (const Factor& f : factors) columns += fmt::format(",\n  {} NUMERIC", quoted_name(f.name));
  return fmt::format(R"(
CREATE TABLE study (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE options (number INTEGER PRIMARY KEY, text TEXT NOT NULL);
CREATE TABLE inputs (number INTEGER PRIMARY KEY, path TEXT NOT NULL, digest TEXT NOT NULL);
CREATE TABLE factors (number INTEGER PRIMARY KEY, name TEXT NOT NULL, option TEXT NOT NULL, text TEXT NOT NULL,
  spread TEXT, a REAL, b REAL);
CREATE TABLE models (model_id INTEGER PRIMARY KEY, path TEXT NOT NULL);
CREATE TABLE cases (
  case_id INTEGER PRIMARY KEY,
  model_id INTEGER NOT NULL REFERENCES models,
  case_outcome TEXT NOT NULL,
  case_message TEXT,
  seconds REAL NOT NULL{});
CREATE TABLE warnings (
{}  number INTEGER NOT NULL,
  code TEXT NOT NULL,
  severity TEXT NOT NULL,
  contact TEXT,
  surface TEXT,
  body TEXT,
  time REAL,
  numbers TEXT NOT NULL,
  text TEXT NOT NULL,
  PRIMARY KEY (case_id, number)) WITHOUT ROWID;
)",
                     columns, kCase);
}

std::string result_tables() {
  return fmt::format(R"(
CREATE TABLE states (
{case_}  state INTEGER NOT NULL,
  time REAL NOT NULL,
  outcome TEXT NOT NULL,
  message TEXT,
  iterations INTEGER NOT NULL,
  residual_force REAL,
  residual_moment REAL,
  PRIMARY KEY (case_id, state)) WITHOUT ROWID;
CREATE TABLE statistics (
{state}  contact_id INTEGER NOT NULL,
  contact TEXT NOT NULL,
  source TEXT NOT NULL,
  target TEXT NOT NULL,
{contact_numbers}  PRIMARY KEY (case_id, state, contact_id),
{of_state}) WITHOUT ROWID;
CREATE TABLE parts (
{state}  contact_id INTEGER NOT NULL,
  part_id INTEGER NOT NULL,
  contact TEXT NOT NULL,
  part TEXT NOT NULL,
{part_numbers}  PRIMARY KEY (case_id, state, contact_id, part_id),
{of_state}) WITHOUT ROWID;
CREATE TABLE inside (
{state}  contact_id INTEGER NOT NULL,
{inside_numbers}  PRIMARY KEY (case_id, state, contact_id),
{of_state}) WITHOUT ROWID;
CREATE TABLE inside_parts (
{state}  contact_id INTEGER NOT NULL,
  part_id INTEGER NOT NULL,
{inside_part_numbers}  PRIMARY KEY (case_id, state, contact_id, part_id),
{of_state}) WITHOUT ROWID;
CREATE TABLE layers (
{state}  layer_id INTEGER NOT NULL,
  layer TEXT NOT NULL,
{layer_numbers}  PRIMARY KEY (case_id, state, layer_id),
{of_state}) WITHOUT ROWID;
CREATE TABLE soft_parts (
{state}  soft_part_id INTEGER NOT NULL,
  soft_part TEXT NOT NULL,
{soft_part_numbers}  PRIMARY KEY (case_id, state, soft_part_id),
{of_state}) WITHOUT ROWID;
CREATE TABLE poses (
{state}  body_id INTEGER NOT NULL,
  body TEXT NOT NULL,
{center}{rotation}{force}{moment}  PRIMARY KEY (case_id, state, body_id),
{of_state}) WITHOUT ROWID;
CREATE TABLE surfaces (
  model_id INTEGER NOT NULL REFERENCES models,
  contact TEXT NOT NULL,
  source TEXT NOT NULL,
  surface TEXT NOT NULL,
  vertices BLOB NOT NULL,
  triangles BLOB NOT NULL,
  PRIMARY KEY (model_id, contact, source));
CREATE TABLE fields (
{state}  contact_id INTEGER NOT NULL,
  pressure BLOB NOT NULL,
  PRIMARY KEY (case_id, state, contact_id),
{of_state});
)",
                     fmt::arg("case_", kCase), fmt::arg("state", kState), fmt::arg("of_state", kOfState),
                     fmt::arg("contact_numbers", number_columns(contact_numbers())),
                     fmt::arg("part_numbers", number_columns(compartment_numbers())),
                     fmt::arg("layer_numbers", number_columns(layer_numbers())),
                     fmt::arg("soft_part_numbers", number_columns(part_numbers())),
                     fmt::arg("inside_numbers", number_columns(inside_numbers())),
                     fmt::arg("inside_part_numbers", number_columns(compartment_inside_numbers())),
                     fmt::arg("center", vector_columns("center")), fmt::arg("rotation", vector_columns("rotation")),
                     fmt::arg("force", vector_columns("force")), fmt::arg("moment", vector_columns("moment")));
}

constexpr const char* kInsideOf =
    "\n  LEFT JOIN inside i ON i.case_id = t.case_id AND i.state = t.state AND i.contact_id = t.contact_id";
constexpr const char* kInsideOfParts =
    "\n  LEFT JOIN inside_parts i ON i.case_id = t.case_id AND i.state = t.state AND i.contact_id = t.contact_id AND "
    "i.part_id = t.part_id";

/// 1 where a state is a solution: those that are none have numbers too.
std::string solved_column() { return fmt::format(", coalesce({}, 0) AS solved", solved_condition("s")); }

/// "a, b, " as ", a, b".
std::string listed_last(const std::string& names) { return ", " + names.substr(0, names.size() - 2); }

std::string views(const std::vector<Factor>& factors, bool inside) {
  std::string names;
  for (const Factor& f : factors) names += fmt::format("c.{}, ", quoted_name(f.name));
  return fmt::format(
      R"(
CREATE VIEW results AS SELECT c.case_id, m.path AS model, {factors}c.case_outcome, c.case_message, s.state, s.time,
  t.contact_id, t.contact, t.source, t.target, s.outcome, s.message, s.iterations, s.residual_force, s.residual_moment,
  {contact_numbers}
  (SELECT group_concat(w.text, '; ') FROM warnings w WHERE w.case_id = c.case_id) AS warnings, c.seconds{inside}{solved},
  (SELECT replace(group_concat(DISTINCT w.code), ',', ' ') FROM warnings w WHERE w.case_id = c.case_id) AS codes
  FROM cases c JOIN models m ON m.model_id = c.model_id LEFT JOIN states s ON s.case_id = c.case_id
  LEFT JOIN statistics t ON t.case_id = s.case_id AND t.state = s.state{inside_of};
CREATE VIEW part_results AS SELECT c.case_id, m.path AS model, {factors}c.case_outcome, s.state, s.time,
  t.contact_id, t.contact, t.part_id, t.part, {part_numbers}s.outcome{inside_parts}{solved}
  FROM cases c JOIN models m ON m.model_id = c.model_id JOIN states s ON s.case_id = c.case_id
  JOIN parts t ON t.case_id = s.case_id AND t.state = s.state{inside_of_parts};
CREATE VIEW layer_results AS SELECT c.case_id, m.path AS model, {factors}c.case_outcome, s.state, s.time,
  t.layer_id, t.layer, {layer_numbers}s.outcome{solved}
  FROM cases c JOIN models m ON m.model_id = c.model_id JOIN states s ON s.case_id = c.case_id
  JOIN layers t ON t.case_id = s.case_id AND t.state = s.state;
CREATE VIEW soft_part_results AS SELECT c.case_id, m.path AS model, {factors}c.case_outcome, s.state, s.time,
  t.soft_part_id, t.soft_part, {soft_part_numbers}s.outcome{solved}
  FROM cases c JOIN models m ON m.model_id = c.model_id JOIN states s ON s.case_id = c.case_id
  JOIN soft_parts t ON t.case_id = s.case_id AND t.state = s.state;
)",
      fmt::arg("factors", names), fmt::arg("contact_numbers", number_names(contact_numbers())),
      fmt::arg("part_numbers", number_names(compartment_numbers())),
      fmt::arg("layer_numbers", number_names(layer_numbers())),
      fmt::arg("soft_part_numbers", number_names(part_numbers())),
      fmt::arg("inside", inside ? listed_last(number_names(inside_numbers(), "i")) : ""),
      fmt::arg("solved", solved_column()), fmt::arg("inside_of", inside ? kInsideOf : ""),
      fmt::arg("inside_parts", inside ? listed_last(number_names(compartment_inside_numbers(), "i")) : ""),
      fmt::arg("inside_of_parts", inside ? kInsideOfParts : ""));
}

}  // namespace

std::vector<std::string> study_tables(const Database& database) {
  std::vector<std::string> tables;
  for (Statement rows(database, "SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY rowid"); rows.step();)
    tables.push_back(rows.text(0));
  return tables;
}

std::string solved_condition(const std::string& alias) {
  std::string outcomes;
  for (int o = 0; o <= static_cast<int>(kLastOutcome); ++o)
    if (solved(static_cast<Outcome>(o)))
      outcomes += fmt::format("{}'{}'", outcomes.empty() ? "" : ", ", name(static_cast<Outcome>(o)));
  return fmt::format("{}.outcome IN ({})", alias, outcomes);
}

void check_study(const Database& d) {
  const auto number = [&](const char* pragma) {
    Statement row(d, pragma);
    return row.step() ? row.integer(0) : 0;
  };
  if (number("PRAGMA application_id") != kStudyApplication)
    throw InputError(fmt::format(
        "{}: found a database of another program, expected a study's file (dea study -o FILE.db)", d.path()));
  const std::int64_t version = number("PRAGMA user_version");
  if (version != kStudyVersion)
    throw InputError(fmt::format("{}: found dea.study/{}, expected dea.study/{}: the program that made it reads it",
                                 d.path(), version, kStudyVersion));
}

void make_study_tables(Database& database, const std::vector<Factor>& factors, bool inside) {
  database.execute(head_tables(factors));
  database.execute(result_tables());
  database.execute(views(factors, inside));
  database.execute(
      fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}", kStudyApplication, kStudyVersion));
}

bool describes_study(const std::string& table) {
  return table == "study" || table == "options" || table == "inputs" || table == "factors" || table == "models";
}

void copy_table(const Database& from, const Database& to, const std::string& table) {
  Statement rows(from, fmt::format("SELECT * FROM {}", table));
  // a surface is in every file
  Statement insert(to, insert_sql(to, table, table == "surfaces" ? "OR IGNORE" : ""));
  while (rows.step()) {
    for (int i = 0; i < rows.columns(); ++i) insert.bind(rows, i);
    insert.run();
  }
}

void check_factor_names(const std::vector<Factor>& factors) {
  Database none(":memory:", Database::For::Writing);
  make_study_tables(none, {}, true);
  std::set<std::string> taken = {"case", "parts", "layers", "soft_parts", "poses", "fields"};  // of columns
  for (const char* all :
       {"SELECT * FROM cases", "SELECT * FROM results", "SELECT * FROM part_results", "SELECT * FROM layer_results"})
    for (const std::string& name : column_names(none, all)) taken.insert(lower_case(name));
  for (const Factor& f : factors)
    if (taken.count(lower_case(f.name)) > 0)
      throw UsageError(
          fmt::format("found a factor named \"{}\", expected another name: results have a column of this one", f.name));
}

}  // namespace dea

#include "io/study/read_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "io/study/open_study.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"

namespace dea {

namespace {

/// What `get` makes of each row of a query.
template <class Get>
auto rows_of(const std::string& path, const std::string& sql, Get get) {
  return reading(path, [&](const Database& d) {
    std::vector<decltype(get(std::declval<const Statement&>()))> all;
    for (Statement row(d, sql); row.step();) all.push_back(get(row));
    return all;
  });
}

std::optional<std::string> said_if(const Database& d, const char* key) {
  Statement row(d, "SELECT value FROM study WHERE key = ?");
  row.bind(std::string(key));
  return row.step() ? std::optional<std::string>(row.text(0)) : std::nullopt;
}

std::string text_of_key(const Database& d, const char* key) {
  if (const auto text = said_if(d, key)) return *text;
  throw InputError(fmt::format("{}: found no \"{}\" in table study, expected one", d.path(), key));
}

int whole_number(const Database& d, const char* key) {
  const std::string text = text_of_key(d, key);
  try {
    return std::stoi(text);
  } catch (const std::exception&) {
    throw InputError(fmt::format("{}: found {} = \"{}\", expected a number", d.path(), key, text));
  }
}

StudyHead head_of(const Database& d) {
  StudyHead head;
  head.path = d.path();
  head.identity.version = text_of_key(d, "version");
  head.identity.shard = whole_number(d, "shard");
  head.identity.shards = whole_number(d, "shards");
  head.identity.inside = said_if(d, "inside") == "1";
  head.planned = static_cast<std::size_t>(std::max(0, whole_number(d, "cases")));
  for (Statement rows(d, "SELECT text FROM options ORDER BY number"); rows.step();)
    head.identity.options.push_back(rows.text(0));
  for (Statement rows(d, "SELECT path, digest FROM inputs ORDER BY number"); rows.step();)
    head.identity.inputs.push_back({rows.text(0), rows.text(1)});
  for (Statement rows(d, "SELECT path FROM models ORDER BY model_id"); rows.step();)
    head.models.push_back(rows.text(0));
  for (Statement rows(d, "SELECT name, option, text, spread, a, b FROM factors ORDER BY number"); rows.step();) {
    Factor f;
    f.name = rows.text(0);
    f.option = rows.text(1);
    const std::string text = rows.text(2), spread = rows.text(3);
    f.before = text.substr(0, text.find("{}"));
    f.after = text.substr(std::min(text.size(), f.before.size() + 2));
    for (std::size_t kind = 1; kind < kSpreadWords.size(); ++kind)
      if (spread == kSpreadWords[kind]) f.spread = {static_cast<Spread::Kind>(kind), rows.number(4), rows.number(5)};
    head.factors.push_back(std::move(f));
  }
  return head;
}

/// Rows may have been deleted or added by hand: what one row says of another must be there. Throws InputError: it is
/// not.
void check_whole(const Database& d) {
  const auto refuse_if_any = [&](const std::string& sql, const char* what) {
    Statement odd(d, sql + " LIMIT 1");
    if (odd.step())
      throw InputError(
          fmt::format("{}: found {} (case {}), expected the file as dea study wrote it: rows were deleted "
                      "or added since; take a copy from before, or solve the study again",
                      d.path(), what, odd.integer(0)));
  };
  refuse_if_any("SELECT case_id FROM cases WHERE model_id NOT IN (SELECT model_id FROM models)", "a case of no model");
  refuse_if_any("SELECT case_id FROM warnings WHERE case_id NOT IN (SELECT case_id FROM cases)",
                "a warning of no case");
  refuse_if_any("SELECT case_id FROM states WHERE case_id NOT IN (SELECT case_id FROM cases)", "a state of no case");
  refuse_if_any(fmt::format("SELECT case_id FROM cases WHERE case_outcome = '{}' AND case_id NOT IN "
                            "(SELECT case_id FROM states)",
                            name(CaseResult::Outcome::Solved)),
                "a solved case without states");
  refuse_if_any("SELECT case_id FROM states GROUP BY case_id HAVING count(*) <> max(state)",
                "a case that lacks a state");
  refuse_if_any("SELECT case_id FROM states WHERE (case_id, state) NOT IN (SELECT case_id, state FROM statistics)",
                "a state without contacts");
  for (const char* table : {"statistics", "poses", "parts", "fields"})
    refuse_if_any(
        fmt::format("SELECT case_id FROM {} WHERE (case_id, state) NOT IN (SELECT case_id, state FROM states)", table),
        "results of no state");
  for (const char* table : {"statistics", "fields"})
    refuse_if_any(
        fmt::format("SELECT case_id FROM {} GROUP BY case_id, state HAVING count(*) <> max(contact_id)", table),
        "a state that lacks a contact");
  refuse_if_any(
      "SELECT f.case_id FROM fields f JOIN statistics t USING (case_id, state, contact_id) JOIN cases c USING "
      "(case_id) WHERE (c.model_id, t.contact, t.source) NOT IN (SELECT model_id, contact, source FROM "
      "surfaces)",
      "a field of no surface");
}

/// Those of `a` that `b` lacks, as a list.
std::string lacking(const std::vector<std::string>& a, const std::vector<std::string>& b) {
  std::string text;
  for (const std::string& word : a)
    if (std::find(b.begin(), b.end(), word) == b.end()) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string option_difference(const std::vector<std::string>& there, const std::vector<std::string>& wanted) {
  if (there == wanted) return "";
  const std::string gone = lacking(there, wanted), added = lacking(wanted, there);
  if (gone.empty() && added.empty()) return "it was made with these options in another order";
  if (gone.empty()) return "it was made without " + added;
  return fmt::format("it was made with {}{}", gone, added.empty() ? ", which is not given now" : ", not " + added);
}

std::string input_difference(const std::vector<std::array<std::string, 2>>& there,
                             const std::vector<std::array<std::string, 2>>& wanted) {
  if (there == wanted) return "";
  std::vector<std::string> old_paths, new_paths;
  for (const auto& input : there) old_paths.push_back(input[0]);
  for (const auto& input : wanted) new_paths.push_back(input[0]);
  const std::string gone = lacking(old_paths, new_paths), added = lacking(new_paths, old_paths);
  if (!gone.empty()) return fmt::format("it was made from {}{}", gone, added.empty() ? " too" : ", not " + added);
  if (!added.empty()) return "it was made without " + added;
  for (const auto& input : wanted)
    if (std::find(there.begin(), there.end(), input) == there.end()) return input[0] + " has changed since";
  return "it was made from the same files in another order";
}

/// A cell as CSV has it.
std::string cell_text(const Statement& row, int column) {
  if (row.is_null(column) || !row.is_number(column)) return row.text(column);
  return fmt::format("{}", row.number(column) + 0.0);
}

StudyCase case_of_row(const Statement& row) {
  StudyCase c;
  c.number = static_cast<std::size_t>(row.integer(0));
  c.model = static_cast<int>(row.integer(1)) - 1;
  c.outcome = outcome_of(row.text(2));
  c.message = row.text(3);
  c.seconds = row.number(4);
  for (int i = 5; i < row.columns(); ++i) c.values.push_back(cell_text(row, i));
  return c;
}

/// Places are numbered as they come up.
using Places = std::map<std::tuple<int, std::string, std::string>, int>;

void add_rows(const Database& d, const std::string& sql, Places& places, StudyRows& rows) {
  for (Statement row(d, sql); row.step();) {
    rows.case_id.push_back(row.integer(0));
    rows.state.push_back(static_cast<int>(row.integer(1)));
    const StudyPlace found{static_cast<int>(row.integer(2)), row.text(3), row.text(4)};
    const auto [place, is_new] =
        places.insert({{found.contact_id, found.contact, found.part}, static_cast<int>(rows.places.size())});
    if (is_new) rows.places.push_back(found);
    rows.place.push_back(place->second);
    for (std::size_t i = 0; i < rows.numbers.size(); ++i)
      rows.numbers[i].push_back(row.number(static_cast<int>(i) + 5));
  }
}

/// Contacts by number and name, the whole before its compartments, which keep their order.
void sort_places(StudyRows& rows) {
  std::vector<int> order(rows.places.size()), place_of(rows.places.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int i) {
    const StudyPlace& p = rows.places[at(i)];
    return std::make_tuple(p.contact_id, p.contact, !p.part.empty());
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
  std::vector<StudyPlace> sorted;
  for (int i : order) {
    place_of[at(i)] = static_cast<int>(sorted.size());
    sorted.push_back(rows.places[at(i)]);
  }
  rows.places = std::move(sorted);
  for (int& p : rows.place) p = place_of[at(p)];
}

}  // namespace

bool is_database(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string start(15, '\0');
  in.read(start.data(), static_cast<std::streamsize>(start.size()));
  return in && start == "SQLite format 3";
}

StudyHead read_study_head(const std::string& path) {
  return reading(path, [](const Database& d) {
    StudyHead head = head_of(d);
    const std::size_t columns = column_names(d, "SELECT * FROM cases").size(), factors = head.factors.size();
    if (columns != 5 + factors)
      throw InputError(
          fmt::format("{}: found {} factors and {} columns of their values in table cases, expected as many", d.path(),
                      factors, columns - 5));
    check_whole(d);
    return head;
  });
}

std::string study_difference(const StudyHead& there, const StudyIdentity& wanted) {
  if (there.identity.version != wanted.version)
    return fmt::format("it was made by dea {}, this is dea {}", there.identity.version, wanted.version);
  const std::string options = option_difference(there.identity.options, wanted.options);
  if (!options.empty()) return options;
  const std::string inputs = input_difference(there.identity.inputs, wanted.inputs);
  if (!inputs.empty()) return inputs;
  if (there.identity.shard != wanted.shard || there.identity.shards != wanted.shards)
    return fmt::format("it is shard {} of {}, not {} of {}", there.identity.shard, there.identity.shards, wanted.shard,
                       wanted.shards);
  return "";
}

StudyCounts count_cases(const std::string& path) {
  return reading(path, [](const Database& d) {
    StudyCounts counts;
    for (Statement rows(d, "SELECT case_outcome, count(*) FROM cases GROUP BY 1"); rows.step();) {
      const CaseResult::Outcome outcome = outcome_of(rows.text(0));
      const auto n = static_cast<std::size_t>(rows.integer(1));
      (outcome == CaseResult::Outcome::Solved   ? counts.solved
       : outcome == CaseResult::Outcome::Failed ? counts.failed
                                                : counts.refused) += n;
    }
    return counts;
  });
}

StudyWarned count_warned(const std::string& path, const std::vector<std::string>& without) {
  return reading(path, [&](const Database& d) {
    std::string places;
    for (std::size_t i = 0; i < without.size(); ++i) places += i > 0 ? ", ?" : "?";
    const std::string from = fmt::format("FROM warnings WHERE code NOT IN ({})", places);
    StudyWarned warned;
    Statement count(d, "SELECT count(DISTINCT case_id) " + from),
        first(d, "SELECT case_id, text " + from + " ORDER BY case_id, number LIMIT 1");
    for (const std::string& code : without) {
      count.bind(code);
      first.bind(code);
    }
    if (count.step()) warned.cases = static_cast<std::size_t>(count.integer(0));
    if (!first.step()) return warned;
    warned.first = static_cast<std::size_t>(first.integer(0));
    warned.text = first.text(1);
    return warned;
  });
}

std::vector<std::string> warned_codes(const std::string& path) {
  return rows_of(path, "SELECT DISTINCT severity FROM warnings UNION SELECT DISTINCT code FROM warnings",
                 [](const Statement& row) { return row.text(0); });
}

std::vector<StudyCase> read_cases(const std::string& path) {
  return rows_of(path, "SELECT * FROM cases ORDER BY case_id", &case_of_row);
}

std::optional<StudyCase> first_failed(const std::string& path) {
  const auto found =
      rows_of(path, "SELECT * FROM cases WHERE case_outcome <> 'solved' ORDER BY case_id LIMIT 1", &case_of_row);
  return found.empty() ? std::nullopt : std::optional<StudyCase>(found.front());
}

void read_results(const std::string& path, const std::function<void(const std::vector<std::string>& cells)>& row) {
  reading(path, [&](const Database& d) {
    Statement rows(d, "SELECT * FROM results ORDER BY case_id, state, contact_id");
    std::vector<std::string> cells = column_names(d, "SELECT * FROM results");
    row(cells);
    while (rows.step()) {
      for (int i = 0; i < rows.columns(); ++i) cells[at(i)] = cell_text(rows, i);
      row(cells);
    }
    return 0;
  });
}

std::vector<StudySurface> read_surfaces(const std::string& path, int model) {
  return reading(path, [&](const Database& d) {
    std::vector<StudySurface> surfaces;
    Statement rows(d, "SELECT contact, source, surface, vertices, triangles FROM surfaces WHERE model_id = ?");
    rows.bind(std::int64_t{model + 1});
    while (rows.step()) {
      StudySurface s{rows.text(0), rows.text(1), {rows.text(2), {}, {}}};
      const std::vector<double> vertices = unpacked<double>(d, rows.bytes(3));
      const std::vector<std::int32_t> triangles = unpacked<std::int32_t>(d, rows.bytes(4));
      for (std::size_t i = 0; i + 2 < vertices.size(); i += 3)
        s.surface.vertices.emplace_back(vertices[i], vertices[i + 1], vertices[i + 2]);
      for (std::size_t i = 0; i + 2 < triangles.size(); i += 3)
        s.surface.triangles.push_back({triangles[i], triangles[i + 1], triangles[i + 2]});
      surfaces.push_back(std::move(s));
    }
    return surfaces;
  });
}

std::vector<StudyState> read_states(const std::string& path) {
  return rows_of(path, "SELECT case_id, state, time, outcome, message FROM states ORDER BY case_id, state",
                 [](const Statement& row) -> StudyState {
                   return {row.integer(0), static_cast<int>(row.integer(1)), row.number(2), row.text(3), row.text(4)};
                 });
}

StudyRows read_rows(const std::string& path, const std::vector<std::string>& names,
                    const std::vector<std::string>& of_inside) {
  std::string wanted, inside, no_inside;
  for (const std::string& name : names) wanted += ", t." + quoted_name(name);
  for (const std::string& name : of_inside) {
    inside += ", i." + quoted_name(name);
    no_inside += ", NULL";
  }
  return reading(path, [&](const Database& d) {
    StudyRows rows;
    rows.numbers.resize(names.size() + of_inside.size());
    Places places;
    add_rows(
        d,
        fmt::format("SELECT t.case_id, t.state, t.contact_id, t.contact, ''{}{} FROM statistics t LEFT JOIN inside i "
                    "ON i.case_id = t.case_id AND i.state = t.state AND i.contact_id = t.contact_id "
                    "ORDER BY t.case_id, t.state, t.contact_id",
                    wanted, inside),
        places, rows);
    add_rows(d,
             fmt::format("SELECT t.case_id, t.state, t.contact_id, t.contact, t.part{}{} FROM parts t "
                         "ORDER BY t.case_id, t.state, t.contact_id, t.part_id",
                         wanted, no_inside),
             places, rows);
    sort_places(rows);
    return rows;
  });
}

std::vector<StudyContact> read_contacts(const std::string& path) {
  return rows_of(path, "SELECT DISTINCT contact_id, contact, source, target FROM statistics ORDER BY 1, 2, 3, 4",
                 [](const Statement& row) -> StudyContact {
                   return {row.text(1), row.text(2), row.text(3)};
                 });
}

std::vector<StudyWarning> read_warnings(const std::string& path) {
  return rows_of(path, "SELECT case_id, code, contact, surface, body, text FROM warnings ORDER BY case_id, number",
                 [](const Statement& row) -> StudyWarning {
                   return {row.integer(0), row.text(1), row.text(2), row.text(3), row.text(4), row.text(5)};
                 });
}

std::vector<StudyFieldRow> list_fields(const std::string& path) {
  return rows_of(path,
                 "SELECT f.case_id, f.state, f.contact_id, c.model_id, s.outcome, t.contact, t.source, "
                 "t.facet_contact_area FROM fields f JOIN cases c USING (case_id) JOIN states s USING (case_id, state) "
                 "JOIN statistics t USING (case_id, state, contact_id) ORDER BY f.case_id, f.state, f.contact_id",
                 [](const Statement& row) -> StudyFieldRow {
                   return {{row.integer(0), static_cast<int>(row.integer(1)), static_cast<int>(row.integer(2))},
                           static_cast<int>(row.integer(3)) - 1,
                           row.text(4),
                           row.text(5),
                           row.text(6),
                           row.number(7)};
                 });
}

void read_fields(const std::string& path, const std::vector<StudyFieldKey>& keys,
                 const std::function<void(std::size_t, std::vector<float>&&)>& each) {
  reading(path, [&](const Database& d) {
    d.execute("BEGIN");  // one state of it
    Statement row(d, "SELECT pressure FROM fields WHERE case_id = ? AND state = ? AND contact_id = ?");
    for (std::size_t i = 0; i < keys.size(); ++i) {
      row.bind(keys[i].case_id).bind(std::int64_t{keys[i].state}).bind(std::int64_t{keys[i].contact_id});
      if (row.step()) each(i, unpacked<float>(d, row.bytes(0)));
      row.reset();
    }
    return 0;
  });
}

}  // namespace dea

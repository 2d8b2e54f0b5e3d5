#include "io/study/study_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "io/study/reading.h"

namespace dea {

namespace {

/// Places are numbered as they come up.
using Places = std::map<std::tuple<int, std::string, std::string>, int>;

void add_rows(const Database& d, const std::string& sql, Places& places, StudyRows& rows) {
  for (Statement row(d, sql); row.step();) {
    rows.case_id.push_back(row.integer(0));
    rows.state.push_back(static_cast<int>(row.integer(1)));
    const StudyPlace at{static_cast<int>(row.integer(2)), row.text(3), row.text(4)};
    const auto [place, is_new] =
        places.insert({{at.contact_id, at.contact, at.part}, static_cast<int>(rows.places.size())});
    if (is_new) rows.places.push_back(at);
    rows.place.push_back(place->second);
    for (std::size_t i = 0; i < rows.numbers.size(); ++i)
      rows.numbers[i].push_back(row.number(static_cast<int>(i) + 5));
  }
}

/// Contacts by number and name, the whole before its compartments, which keep their order.
void sort_places(StudyRows& rows) {
  std::vector<int> order(rows.places.size()), place_of(rows.places.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  const auto key = [&](int i) {
    const StudyPlace& p = rows.places[static_cast<std::size_t>(i)];
    return std::make_tuple(p.contact_id, p.contact, !p.part.empty());
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
  std::vector<StudyPlace> sorted;
  for (int i : order) {
    place_of[static_cast<std::size_t>(i)] = static_cast<int>(sorted.size());
    sorted.push_back(rows.places[static_cast<std::size_t>(i)]);
  }
  rows.places = std::move(sorted);
  for (int& p : rows.place) p = place_of[static_cast<std::size_t>(p)];
}

}  // namespace

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

#include "io/study/study_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "io/study/reading.h"

namespace dea {

namespace {

/// Numbers places as they come up.
class Places {
 public:
  explicit Places(std::vector<StudyPlace>& places) : places_(places) {}
  int of(int contact_id, std::string contact, std::string part) {
    const auto key = std::make_pair(std::make_pair(contact_id, contact), part);
    const auto found = known_.find(key);
    if (found != known_.end()) return found->second;
    places_.push_back({contact_id, std::move(contact), std::move(part)});
    return known_[key] = static_cast<int>(places_.size()) - 1;
  }

 private:
  std::vector<StudyPlace>& places_;
  std::map<std::pair<std::pair<int, std::string>, std::string>, int> known_;
};

void add_rows(const Database& d, const std::string& sql, std::size_t names, Places& places, StudyRows& rows) {
  for (Statement row(d, sql); row.step();) {
    rows.case_id.push_back(row.integer(0));
    rows.state.push_back(static_cast<int>(row.integer(1)));
    rows.place.push_back(places.of(static_cast<int>(row.integer(2)), row.text(3), row.text(4)));
    for (std::size_t i = 0; i < names; ++i) rows.numbers[i].push_back(row.number(static_cast<int>(i) + 5));
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
  return reading(path, [](const Database& d) {
    std::vector<StudyState> states;
    for (Statement row(d, "SELECT case_id, state, time, outcome, message FROM states ORDER BY case_id, state");
         row.step();)
      states.push_back({row.integer(0), static_cast<int>(row.integer(1)), row.number(2), row.text(3), row.text(4)});
    return states;
  });
}

StudyRows read_rows(const std::string& path, const std::vector<std::string>& names) {
  return reading(path, [&](const Database& d) {
    std::string wanted;
    for (const std::string& name : names) wanted += ", " + quoted_name(name);
    StudyRows rows;
    rows.numbers.resize(names.size());
    Places places(rows.places);
    add_rows(d,
             fmt::format("SELECT case_id, state, contact_id, contact, ''{} FROM statistics "
                         "ORDER BY case_id, state, contact_id",
                         wanted),
             names.size(), places, rows);
    add_rows(d,
             fmt::format("SELECT case_id, state, contact_id, contact, part{} FROM parts "
                         "ORDER BY case_id, state, contact_id, part_id",
                         wanted),
             names.size(), places, rows);
    sort_places(rows);
    return rows;
  });
}

StudyRows read_inside(const std::string& path, const std::vector<std::string>& names) {
  return reading(path, [&](const Database& d) {
    std::string wanted;
    for (const std::string& name : names) wanted += ", i." + quoted_name(name);
    StudyRows rows;
    rows.numbers.resize(names.size());
    Places places(rows.places);
    add_rows(d,
             fmt::format("SELECT i.case_id, i.state, i.contact_id, t.contact, ''{} FROM inside i JOIN statistics t "
                         "ON t.case_id = i.case_id AND t.state = i.state AND t.contact_id = i.contact_id "
                         "ORDER BY i.case_id, i.state, i.contact_id",
                         wanted),
             names.size(), places, rows);
    return rows;
  });
}

std::vector<StudyContact> read_contacts(const std::string& path) {
  return reading(path, [](const Database& d) {
    std::vector<StudyContact> contacts;
    for (Statement row(d, "SELECT DISTINCT contact_id, contact, source, target FROM statistics ORDER BY 1, 2, 3, 4");
         row.step();)
      contacts.push_back({static_cast<int>(row.integer(0)), row.text(1), row.text(2), row.text(3)});
    return contacts;
  });
}

std::vector<StudyContactArea> read_contact_areas(const std::string& path) {
  return reading(path, [](const Database& d) {
    std::vector<StudyContactArea> areas;
    for (Statement row(d,
                       "SELECT case_id, state, contact_id, contact, source, facet_contact_area FROM statistics "
                       "ORDER BY case_id, state, contact_id");
         row.step();)
      areas.push_back({row.integer(0), static_cast<int>(row.integer(1)), static_cast<int>(row.integer(2)), row.text(3),
                       row.text(4), row.number(5)});
    return areas;
  });
}

std::vector<StudyWarning> read_warnings(const std::string& path) {
  return reading(path, [](const Database& d) {
    std::vector<StudyWarning> warnings;
    for (Statement row(d, "SELECT case_id, code, contact, surface, body, text FROM warnings ORDER BY case_id, number");
         row.step();)
      warnings.push_back({row.integer(0), row.text(1), row.text(2), row.text(3), row.text(4), row.text(5)});
    return warnings;
  });
}

std::vector<StudyFieldKey> list_fields(const std::string& path) {
  return reading(path, [](const Database& d) {
    std::vector<StudyFieldKey> keys;
    for (Statement row(d, "SELECT case_id, state, contact_id FROM fields ORDER BY case_id, state, contact_id");
         row.step();)
      keys.push_back({row.integer(0), static_cast<int>(row.integer(1)), static_cast<int>(row.integer(2))});
    return keys;
  });
}

void read_fields(const std::string& path, const std::function<bool(const StudyFieldKey&)>& wanted,
                 const std::function<void(const StudyFieldKey&, std::vector<float>&&)>& each) {
  reading(path, [&](const Database& d) {
    for (Statement row(d,
                       "SELECT case_id, state, contact_id, pressure FROM fields ORDER BY case_id, state, contact_id");
         row.step();) {
      const StudyFieldKey key{row.integer(0), static_cast<int>(row.integer(1)), static_cast<int>(row.integer(2))};
      if (wanted(key)) each(key, unpacked<float>(d, row.bytes(3)));
    }
    return 0;
  });
}

}  // namespace dea

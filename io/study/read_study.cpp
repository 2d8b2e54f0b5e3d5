#include "io/study/read_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <optional>

#include "io/study/database.h"
#include "io/study/reading.h"
#include "io/study/study_schema.h"
#include "src/base/error.h"
#include "src/base/names.h"

namespace dea {

namespace {

constexpr const char* kOrder = "ORDER BY case_id, state, contact_id";

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
    for (const auto kind : {Spread::Kind::Uniform, Spread::Kind::Normal, Spread::Kind::LogNormal})
      if (spread == word_of(kind, {"", "uniform", "normal", "lognormal"}))
        f.spread = {kind, rows.number(4), rows.number(5)};
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

CaseResult::Outcome outcome_of(const std::string& word) {
  for (const auto outcome : {CaseResult::Outcome::Solved, CaseResult::Outcome::Failed})
    if (word == name(outcome)) return outcome;
  return CaseResult::Outcome::Refused;
}

/// A cell as CSV has it.
std::string cell_text(const Statement& row, int column) {
  if (row.is_null(column) || !row.is_number(column)) return row.text(column);
  const double number = row.number(column);
  return fmt::format("{}", number + 0.0);
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
    const int columns = Statement(d, "SELECT * FROM cases").columns(), factors = static_cast<int>(head.factors.size());
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

StudyWarned count_warned(const std::string& path) {
  return reading(path, [](const Database& d) {
    StudyWarned warned;
    Statement count(d, "SELECT count(DISTINCT case_id) FROM warnings");
    if (count.step()) warned.cases = static_cast<std::size_t>(count.integer(0));
    Statement first(d, "SELECT case_id, text FROM warnings ORDER BY case_id, number LIMIT 1");
    if (!first.step()) return warned;
    warned.first = static_cast<std::size_t>(first.integer(0));
    warned.text = first.text(1);
    return warned;
  });
}

std::vector<std::string> warned_codes(const std::string& path) {
  return reading(path, [](const Database& d) {
    std::vector<std::string> codes;
    for (Statement rows(d, "SELECT DISTINCT severity FROM warnings UNION SELECT DISTINCT code FROM warnings");
         rows.step();)
      codes.push_back(rows.text(0));
    return codes;
  });
}

std::vector<StudyCase> read_cases(const std::string& path, bool only_failed, std::size_t most) {
  return reading(path, [&](const Database& d) {
    std::vector<StudyCase> cases;
    const std::string sql =
        fmt::format("SELECT * FROM cases {} ORDER BY case_id", only_failed ? "WHERE case_outcome <> 'solved'" : "");
    for (Statement rows(d, sql); cases.size() < most && rows.step();) {
      StudyCase c;
      c.number = static_cast<std::size_t>(rows.integer(0));
      c.model = static_cast<int>(rows.integer(1)) - 1;
      c.outcome = outcome_of(rows.text(2));
      c.message = rows.text(3);
      c.seconds = rows.number(4);
      for (int i = 5; i < rows.columns(); ++i) c.values.push_back(cell_text(rows, i));
      cases.push_back(std::move(c));
    }
    return cases;
  });
}

StudyColumns read_columns(const std::string& path, const std::vector<std::string>& names) {
  return reading(path, [&](const Database& d) {
    std::vector<std::string> there;
    const Statement all(d, "SELECT * FROM results");
    for (int i = 0; i < all.columns(); ++i) there.push_back(all.name(i));
    std::string wanted;
    for (const std::string& name : names) {
      if (std::find(there.begin(), there.end(), name) == there.end())
        throw InputError(fmt::format("{}: found no column \"{}\"{}; results have {}", path, name,
                                     did_you_mean(name, there), name_list(there, name)));
      wanted += ", " + quoted_name(name);
    }
    StudyColumns out;
    out.numbers.resize(names.size());
    for (Statement rows(d, fmt::format("SELECT case_id, state, contact_id, contact{} FROM results {}", wanted, kOrder));
         rows.step();) {
      out.case_id.push_back(rows.integer(0));
      out.state.push_back(rows.integer(1));
      out.contact_id.push_back(rows.integer(2));
      out.contact.push_back(rows.text(3));
      for (std::size_t i = 0; i < names.size(); ++i) out.numbers[i].push_back(rows.number(static_cast<int>(i) + 4));
    }
    return out;
  });
}

void read_results(const std::string& path, const std::function<void(const std::vector<std::string>& cells)>& row) {
  reading(path, [&](const Database& d) {
    Statement rows(d, fmt::format("SELECT * FROM results {}", kOrder));
    std::vector<std::string> cells(static_cast<std::size_t>(rows.columns()));
    for (int i = 0; i < rows.columns(); ++i) cells[static_cast<std::size_t>(i)] = rows.name(i);
    row(cells);
    while (rows.step()) {
      for (int i = 0; i < rows.columns(); ++i) cells[static_cast<std::size_t>(i)] = cell_text(rows, i);
      row(cells);
    }
    return 0;
  });
}

std::vector<float> read_pressure(const std::string& path, std::size_t case_number, int state, int contact_id) {
  return reading(path, [&](const Database& d) {
    Statement row(d, "SELECT pressure FROM fields WHERE case_id = ? AND state = ? AND contact_id = ?");
    row.bind(static_cast<std::int64_t>(case_number)).bind(std::int64_t{state}).bind(std::int64_t{contact_id});
    return row.step() ? unpacked<float>(d, row.bytes(0)) : std::vector<float>();
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

}  // namespace dea

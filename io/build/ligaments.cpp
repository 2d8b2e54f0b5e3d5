#include "io/build/ligaments.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/febio/febio_text.h"
#include "io/tables/table.h"
#include "io/tables/table_columns.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/parse.h"

namespace dea {

namespace {

const std::vector<std::string> kLigamentColumns = {
    "name",         "body_a",           "x_a",   "y_a",       "z_a", "body_b", "x_b", "y_b", "z_b", "stiffness",
    "slack_length", "reference_strain", "curve", "toe_strain"};

int ligament_column(const TextTable& table, const std::string& name) {
  for (std::size_t i = 0; i < table.names.size(); ++i)
    if (bare_name(table.names[i]) == name) return static_cast<int>(i);
  return -1;
}

/// "x_a [m]", "stiffness [N/mm]". `length`: unit of the bones' files; empty: unknown.
void refuse_unit_of_ligaments(const TextTable& table, const std::string& name, const std::string& length) {
  const std::size_t open = name.find_first_of("[(");
  if (open == name.npos) return;
  const std::string bare = bare_name(name);
  const std::string unit = lower_case(trimmed(name.substr(open + 1, name.find_last_of("])") - open - 1)));
  const bool is_length = bare[0] == 'x' || bare[0] == 'y' || bare[0] == 'z' || bare == "slack_length";
  if (is_length && length.empty()) return;
  const std::string expected = is_length ? length : bare == "stiffness" ? "n" : bare.ends_with("strain") ? "-" : "";
  if (unit != expected)
    throw table_fault(table.path, table.names_line,
                      fmt::format("found the unit \"{}\" in {}, expected {}", unit, febio::quote(name),
                                  is_length             ? length + ", the unit of the bones"
                                  : bare == "stiffness" ? "N, force per strain (N/mm times the slack length)"
                                                        : "none"));
}

void check_ligament_columns(const TextTable& table, const std::string& length) {
  constexpr std::size_t kNeeded = 10;  // the first of kLigamentColumns
  const auto refuse = [&](const std::string& text) { throw table_fault(table.path, table.names_line, text); };
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    const std::string bare = bare_name(table.names[i]);
    if (std::find(kLigamentColumns.begin(), kLigamentColumns.end(), bare) == kLigamentColumns.end())
      refuse(fmt::format("found a column {}{}, expected {}", febio::quote(table.names[i]),
                         did_you_mean(bare, kLigamentColumns), fmt::join(kLigamentColumns, ", ")));
    if (ligament_column(table, bare) != static_cast<int>(i))
      refuse(fmt::format("found two columns {}, expected one", bare));
    refuse_unit_of_ligaments(table, table.names[i], length);
  }
  for (std::size_t k = 0; k < kNeeded; ++k)
    if (ligament_column(table, kLigamentColumns[k]) < 0)
      refuse(
          fmt::format("found no column {} among {}, expected it", kLigamentColumns[k], fmt::join(table.names, ", ")));
}

/// Empty: there is no such column, or nothing in it.
std::string ligament_word(const TextTable& table, std::size_t row, const std::string& name) {
  const int c = ligament_column(table, name);
  return c < 0 ? "" : trimmed(table.rows[row][at(c)]);
}

std::optional<double> ligament_number(const TextTable& table, std::size_t row, const std::string& name) {
  const std::string text = ligament_word(table, row, name);
  if (text.empty()) return std::nullopt;
  try {
    return parse_number(text);
  } catch (const BadValue&) {
    throw table_fault(table.path, table.lines[row],
                      fmt::format("{}: found {}, expected a number with a decimal point", name, febio::quote(text)));
  }
}

double needed_ligament_number(const TextTable& table, std::size_t row, const std::string& name) {
  const std::optional<double> value = ligament_number(table, row, name);
  if (!value)
    throw table_fault(table.path, table.lines[row], fmt::format("{}: found nothing, expected a number", name));
  return *value;
}

LigamentRow ligament_row(const TextTable& table, std::size_t r) {
  LigamentRow l;
  l.line = table.lines[r];
  l.name = ligament_word(table, r, "name");
  l.bone_a = ligament_word(table, r, "body_a");
  l.bone_b = ligament_word(table, r, "body_b");
  const auto refuse = [&](const std::string& text) {
    throw table_fault(table.path, l.line, fmt::format("{}: {}", l.name, text));
  };
  if (l.name.empty()) throw table_fault(table.path, l.line, "found no name, expected one for each bundle");
  const auto needed = [&](const char* name) { return needed_ligament_number(table, r, name); };
  l.point_a = {needed("x_a"), needed("y_a"), needed("z_a")};
  l.point_b = {needed("x_b"), needed("y_b"), needed("z_b")};
  l.stiffness = needed("stiffness");
  l.slack_length = ligament_number(table, r, "slack_length");
  l.reference_strain = ligament_number(table, r, "reference_strain");
  if (!(l.stiffness > 0))
    refuse(fmt::format("found a stiffness of {:g}, expected a force per strain above 0", l.stiffness));
  if (l.slack_length.has_value() == l.reference_strain.has_value())
    refuse(fmt::format("found {} slack_length and reference_strain, expected one of them",
                       l.slack_length ? "both" : "neither"));
  if (l.slack_length && !(*l.slack_length > 0))
    refuse(fmt::format("found a slack length of {:g}, expected one above 0", *l.slack_length));
  constexpr double kMostStrain = 0.5;  // more is a strain in per cent
  if (l.reference_strain && !(std::abs(*l.reference_strain) <= kMostStrain))
    refuse(fmt::format("found a reference strain of {:g}, expected -0.5 to 0.5 (5 % is 0.05)", *l.reference_strain));
  const std::string curve = lower_case(ligament_word(table, r, "curve"));
  if (!curve.empty() && curve != "blankevoort" && curve != "linear")
    refuse(fmt::format("found the curve {}, expected blankevoort or linear", febio::quote(curve)));
  const std::optional<double> toe = ligament_number(table, r, "toe_strain");
  if (curve == "linear" && toe) refuse("found a toe strain of a linear curve, expected none");
  if (toe && !(*toe > 0 && *toe <= kMostStrain))
    refuse(fmt::format("found a toe strain of {:g}, expected one above 0, up to 0.5 (6 % is 0.06)", *toe));
  l.toe_strain = curve == "linear" ? 0.0 : toe.value_or(kToeStrain);
  return l;
}

}  // namespace

std::vector<LigamentRow> read_ligaments(const std::string& path, const std::string& length) {
  const TextTable table = read_text_table(path);
  check_ligament_columns(table, length);
  std::vector<LigamentRow> ligaments;
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    ligaments.push_back(ligament_row(table, r));
    const std::string& name = ligaments.back().name;
    const auto same = [&](const LigamentRow& l) { return l.name == name; };
    if (std::count_if(ligaments.begin(), ligaments.end(), same) > 1)
      throw table_fault(path, table.lines[r],
                        fmt::format("found the name {} twice, expected a name for each bundle, such as {}_2",
                                    febio::quote(name), name));
  }
  return ligaments;
}

}  // namespace dea

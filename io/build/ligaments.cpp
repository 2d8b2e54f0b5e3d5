#include "io/build/ligaments.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/febio/febio_text.h"
#include "io/tables/table.h"
#include "io/tables/table_columns.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/parse.h"

namespace dea {

namespace {

const std::vector<std::string> kColumns = {"name",  "body_a",    "x_a", "y_a",       "z_a",          "body_b",
                                           "x_b",   "y_b",       "z_b", "stiffness", "slack_length", "reference_strain",
                                           "curve", "toe_strain"};

/// Which of its columns a table has.
class LigamentTable {
 public:
  LigamentTable(const std::string& path, const std::string& length) : table(read_text_table(path)) {
    for (std::size_t i = 0; i < table.names.size(); ++i) {
      const std::string bare = bare_name(table.names[i]);
      if (std::find(kColumns.begin(), kColumns.end(), bare) == kColumns.end())
        refuse(table.names_line, fmt::format("found a column {}{}, expected {}", febio::quote(table.names[i]),
                                             did_you_mean(bare, kColumns), fmt::join(kColumns, ", ")));
      if (column(bare) != static_cast<int>(i)) refuse(table.names_line, fmt::format("found two columns {}", bare));
      refuse_unit(table.names[i], bare, length);
    }
    for (std::size_t k = 0; k < 10; ++k)
      if (column(kColumns[k].c_str()) < 0)
        refuse(table.names_line,
               fmt::format("found no column {} among {}, expected it", kColumns[k], fmt::join(table.names, ", ")));
  }

  std::size_t rows() const { return table.rows.size(); }
  int line(std::size_t row) const { return table.lines[row]; }

  [[noreturn]] void refuse(int line, const std::string& text) const { throw table_fault(table.path, line, text); }

  /// Empty: there is no such column, or nothing in it.
  std::string word(std::size_t row, const std::string& name) const {
    const int c = column(name);
    return c < 0 ? "" : trimmed(table.rows[row][at(c)]);
  }

  std::optional<double> number(std::size_t row, const std::string& name) const {
    const std::string text = word(row, name);
    if (text.empty()) return std::nullopt;
    try {
      return parse_number(text);
    } catch (const BadValue&) {
      refuse(line(row), fmt::format("{}: found {}, expected a number with a decimal point", name, febio::quote(text)));
    }
  }

  double needed(std::size_t row, const std::string& name) const {
    const std::optional<double> value = number(row, name);
    if (!value) refuse(line(row), fmt::format("{}: found nothing, expected a number", name));
    return *value;
  }

 private:
  int column(const std::string& name) const {
    for (std::size_t i = 0; i < table.names.size(); ++i)
      if (bare_name(table.names[i]) == name) return static_cast<int>(i);
    return -1;
  }

  /// "x_a [mm]", "stiffness [N]".
  void refuse_unit(const std::string& name, const std::string& bare, const std::string& length) const {
    const std::size_t open = name.find_first_of("[(");
    if (open == name.npos) return;
    const std::string unit = lower_case(trimmed(name.substr(open + 1, name.find_last_of("])") - open - 1)));
    const bool is_length = bare[0] == 'x' || bare[0] == 'y' || bare[0] == 'z' || bare == "slack_length";
    const std::string expected = is_length ? length : bare == "stiffness" ? "n" : bare.ends_with("strain") ? "-" : "";
    if (unit != expected && !(is_length && length.empty()))
      refuse(table.names_line, fmt::format("found the unit \"{}\" in {}, expected {}", unit, febio::quote(name),
                                           is_length             ? length + ", the unit of the bones"
                                           : bare == "stiffness" ? "N, force per strain (N/mm times the slack length)"
                                                                 : "none"));
  }

  TextTable table;
};

LigamentRow row_of(const LigamentTable& table, std::size_t r) {
  LigamentRow l;
  l.line = table.line(r);
  const auto refuse = [&](const std::string& text) { table.refuse(l.line, l.name + ": " + text); };
  l.name = table.word(r, "name");
  l.bone_a = table.word(r, "body_a");
  l.bone_b = table.word(r, "body_b");
  if (l.name.empty()) table.refuse(l.line, "found no name, expected one for each bundle");
  l.point_a = {table.needed(r, "x_a"), table.needed(r, "y_a"), table.needed(r, "z_a")};
  l.point_b = {table.needed(r, "x_b"), table.needed(r, "y_b"), table.needed(r, "z_b")};
  l.stiffness = table.needed(r, "stiffness");
  l.slack_length = table.number(r, "slack_length");
  l.reference_strain = table.number(r, "reference_strain");
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
  const std::string curve = lower_case(table.word(r, "curve"));
  if (curve != "" && curve != "blankevoort" && curve != "linear")
    refuse(fmt::format("found the curve {}, expected blankevoort or linear", febio::quote(curve)));
  const std::optional<double> toe = table.number(r, "toe_strain");
  if (curve == "linear" && toe) refuse("found a toe strain of a linear curve, expected none");
  if (toe && !(*toe > 0 && *toe <= kMostStrain))
    refuse(fmt::format("found a toe strain of {:g}, expected one above 0, up to 0.5 (6 % is 0.06)", *toe));
  l.toe_strain = curve == "linear" ? 0.0 : toe.value_or(kToeStrain);
  return l;
}

}  // namespace

std::vector<LigamentRow> read_ligaments(const std::string& path, const std::string& length) {
  const LigamentTable table(path, length);
  std::vector<LigamentRow> ligaments;
  for (std::size_t r = 0; r < table.rows(); ++r) {
    ligaments.push_back(row_of(table, r));
    for (std::size_t other = 0; other < r; ++other)
      if (ligaments[other].name == ligaments[r].name)
        table.refuse(table.line(r),
                     fmt::format("found the name {} twice, expected a name for each bundle, such as {}_2",
                                 febio::quote(ligaments[r].name), ligaments[r].name));
  }
  if (ligaments.empty()) table.refuse(0, "found no row, expected one for each bundle of a ligament");
  return ligaments;
}

}  // namespace dea

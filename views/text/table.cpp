#include "views/text/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "src/base/names.h"

namespace dea {

namespace {

/// Characters on the screen: bytes that do not continue a UTF-8 character.
std::size_t width(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

}  // namespace

std::string heading_of(const HeadlineNumber& number, const UnitNames& units) {
  return with_unit(number.name, units, number.value == &Headline::area ? Dimension::Area : Dimension::Pressure);
}

std::string headline_words() {
  std::string names;
  for (const HeadlineNumber& number : kHeadlineNumbers)
    names += fmt::format("{}{}", names.empty() ? "" : ", ", number.name);
  return fmt::format("{}: above {:g} % of the load's mean pressure; area and mean within facets, p99 and peak of nodes",
                     names, 100 * kHeadlineShare);
}

std::string number_text(double x) { return std::isfinite(x) ? fmt::format("{:.6g}", x == 0.0 ? 0.0 : x) : "-"; }

std::string vector_text(const Eigen::Vector3d& v) {
  return fmt::format("({}, {}, {})", number_text(v[0]), number_text(v[1]), number_text(v[2]));
}

std::string four_digits(double x) { return std::isfinite(x) ? fmt::format("{:.4g}", x) : "-"; }

std::string table_text(const Table& of) {
  Table table = of;
  for (std::string& h : table.headings) h = shown(h);
  for (auto& row : table.rows)
    for (std::string& cell : row) cell = shown(cell);
  std::vector<std::size_t> widths;
  for (const std::string& h : table.headings) widths.push_back(width(h));
  for (const auto& row : table.rows)
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], width(row[c]));
  std::string text;
  const auto add_row = [&](const std::vector<std::string>& row) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string space(widths[c] - width(row[c]), ' ');
      if (c > 0) line += "  ";
      line += table.left[c] == 'l' ? row[c] + space : space + row[c];
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  };
  add_row(table.headings);
  for (const auto& row : table.rows) add_row(row);
  return text;
}

std::string tables_text(const std::vector<TitledTable>& tables) {
  std::string text;
  for (const TitledTable& t : tables) {
    text += "\n";
    if (!t.title.empty()) text += t.title + "\n";
    if (!t.table.headings.empty()) text += table_text(t.table);
  }
  return text;
}

}  // namespace dea

#include "views/compare/compare_inside.h"

#include <algorithm>
#include <cmath>

#include "src/results/comparison.h"

namespace dea {

namespace {

/// One measure of the compared elements.
std::vector<double> values_of(const std::vector<ElementMeasures>& elements, std::size_t measure) {
  std::vector<double> values;
  for (const ElementMeasures& e : elements) values.push_back(e[measure]);
  return values;
}

InsideDistribution distribution_of(const std::vector<double>& values, const std::vector<double>& volume, bool least) {
  if (std::any_of(values.begin(), values.end(), [](double x) { return std::isnan(x); })) return {};
  return inside_distribution(values, volume, least);
}

/// Facets that some file presses.
std::vector<char> pressed_facets(const std::vector<RowsOfFile>& files) {
  std::vector<char> pressed(files.back().pressure->size(), 0);
  for (const RowsOfFile& file : files)
    for (std::size_t f = 0; f < pressed.size(); ++f) pressed[f] |= (*file.pressure)[f] > file.above;
  return pressed;
}

/// Elements of a row in all files: what each has of them, and the reference's volumes.
struct RowInFiles {
  std::vector<std::vector<ElementMeasures>> files;
  std::vector<double> volume;
};

RowInFiles row_in_files(const std::vector<RowsOfFile>& files, InsideRow row, const std::vector<char>& pressed) {
  RowInFiles out;
  out.files.resize(files.size());
  std::vector<std::vector<ElementMeasures>> all;
  std::vector<double> volume;
  for (const RowsOfFile& of : files) {
    const RowElements elements = row_elements(*of.file, of.state, of.surface, row);
    all.push_back(row_measures(*of.file, of.state, elements));
    if (all.back().empty()) return {};
    volume = elements.volume;
  }
  for (std::size_t f = 0; f < pressed.size(); ++f) {
    const bool everywhere = std::all_of(all.begin(), all.end(), [f](const auto& m) { return !std::isnan(m[f][0]); });
    if (!pressed[f] || !everywhere) continue;
    for (std::size_t i = 0; i < all.size(); ++i) out.files[i].push_back(all[i][f]);
    out.volume.push_back(volume[f]);
  }
  return out;
}

}  // namespace

std::vector<ComparedRow> compare_inside(const std::vector<RowsOfFile>& files) {
  const std::vector<char> pressed = pressed_facets(files);
  std::vector<ComparedRow> rows;
  for (const InsideRow which : kInsideRows) {
    const RowInFiles in = row_in_files(files, which, pressed);
    if (in.volume.empty()) continue;
    ComparedRow row;
    row.row = which;
    row.elements = static_cast<int>(in.volume.size());
    for (double v : in.volume) row.volume += v;
    for (const auto& elements : in.files) {
      InsideStatistics s;
      for (std::size_t m = 0; m < 3; ++m)
        s.*kInsideMeasures[m].value = distribution_of(values_of(elements, m), in.volume, m == 2);
      row.results.push_back(s);
    }
    for (std::size_t i = 0; i + 1 < files.size(); ++i) {
      row.correlation.emplace_back();
      for (std::size_t m = 0; m < 3; ++m)
        row.correlation.back()[m] = correlation(values_of(in.files[i], m), values_of(in.files.back(), m), in.volume);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace dea

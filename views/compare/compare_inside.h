// views/compare/compare_inside.h – stress and strain of the same elements in several plot files.
#pragma once
#include <array>
#include <vector>

#include "io/results/inside_rows.h"
#include "src/results/inside_numbers.h"

namespace dea {

/// A surface of one file at its compared state.
struct RowsOfFile {
  const ResultFile* file = nullptr;
  int state = -1, surface = -1;
  const std::vector<double>* pressure = nullptr;  ///< per facet
  double above = kNaN;                            ///< facets with more are pressed (H1); NaN: none is
};

/// A row of elements under what is pressed in one of the files at least: the same elements in all.
struct ComparedRow {
  InsideRow row = InsideRow::Bone;
  int elements = 0;
  double volume = 0.0;                    ///< of them, reference
  std::vector<InsideStatistics> results;  ///< one per file, weighted by the elements' volumes; NaN: no strain known
  /// One per file but the last, in the order of kInsideMeasures: correlation with the last, weighted by volume.
  std::vector<std::array<double, 3>> correlation;
};

/// Both rows, bone first; one that not all files have is left out. The surfaces have the same facets; the last file is
/// the reference. Throws InputError.
std::vector<ComparedRow> compare_inside(const std::vector<RowsOfFile>& files);

/// A number of a file against that of the last one, in per cent.
inline double inside_percent(const ComparedRow& row, std::size_t file, const InsideMeasure& measure,
                             const InsideNumber& number) {
  return percent_difference(row.results[file].*measure.value.*number.value,
                            row.results.back().*measure.value.*number.value);
}

}  // namespace dea

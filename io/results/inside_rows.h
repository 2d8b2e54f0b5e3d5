// io/results/inside_rows.h – stress and strain of the rows of elements under a surface, from a plot file of
// whatever program.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "io/results/result_file.h"

namespace dea {

/// A row of elements under a surface: the one that the facets belong to, or the last one before the bone.
enum class InsideRow { Bone, Surface };
inline constexpr InsideRow kInsideRows[] = {InsideRow::Bone, InsideRow::Surface};
const char* name(InsideRow row);  ///< "bone", "surface"

/// Numbers of tensors that do not depend on axes, in the order of kInsideMeasures: half the difference of the greatest
/// and the least principal value of `stress`; greatest and least principal strain, NaN: the file tells of no strain.
using ElementMeasures = std::array<double, 3>;

/// Per facet of a surface the element of a row under it.
struct RowElements {
  std::vector<int> element;    ///< counted through the mesh's domains; -1: none
  std::vector<double> volume;  ///< of the element, reference; 0: none
};
/// Columns of hexes and pentas are followed to the bone; of other elements the one that has the facet is known, and
/// none at the bone.
RowElements row_elements(const ResultFile& result, int state, int surface, InsideRow row);

/// At these elements, one entry per facet; NaN: no element, or one without `stress`. Strain: the file's `Lagrange
/// strain`, else that of its `displacement` at the element's centroid (hex8, hex20, penta6, tet4, tet10).
/// Empty: no element has `stress` in this state. Throws InputError: a value that is not finite.
std::vector<ElementMeasures> row_measures(const ResultFile& result, int state, const RowElements& elements);

/// The fields that a surface has by these rows, as if they were fields of the surface: "max shear stress, row at the
/// bone".
std::string row_field_name(int measure, InsideRow row);
/// Their names, if some state of the file has `stress`.
std::vector<std::string> row_field_names(const ResultFile& result);
/// Per facet; empty: it is none of these fields, or the file has no values. NaN: no element, or a strain that is not
/// known.
std::vector<double> row_field_values(const ResultFile& result, int state, int surface, const std::string& field);
/// facet_values of a field of the surface, else row_field_values.
std::vector<double> shown_values(const ResultFile& result, int state, int surface, const std::string& field,
                                 bool undefined = false);

}  // namespace dea

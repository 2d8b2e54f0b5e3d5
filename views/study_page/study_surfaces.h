// views/study_page/study_surfaces.h – the surfaces that a study's stored pressures stand on, and the
// pressures.
#pragma once
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "src/results/comparison.h"
#include "views/map/map_geometry.h"
#include "views/study_page/study_numbers.h"

namespace dea {

/// One mesh that fields of one or more models stand on. Frame: reference configuration of the model.
struct StudySurfaceMesh {
  int contact_id = 0;
  std::string contact, source, surface;
  ResultSurface geometry;           ///< its triangles as facets
  MapMesh map;                      ///< the same, for areas and outlines
  std::vector<double> areas;        ///< per vertex: a third of each triangle around it
  std::size_t stored_vertices = 0;  ///< in the file; vertices without a triangle are left out here
};

/// A stored field: pressure per vertex of its surface's geometry.
struct StudyField {
  std::size_t c = 0;      ///< index of the case in StudyNumbers
  std::size_t state = 0;  ///< from 0
  int surface = 0;        ///< index
  int contact_id = 0;
  double contact_area = kNaN;  ///< of facets in contact
};

/// What a study keeps with `--keep fields`; states that are no solution are not among them.
struct StudyFields {
  std::vector<StudySurfaceMesh> surfaces;
  std::vector<StudyField> fields;  ///< by case, state, surface
};
/// Throws InputError: a field does not fit its surface.
StudyFields study_fields(const std::string& path, const StudyNumbers& numbers);

/// Pressures of the fields that are `wanted`, in their order.
void each_pressure(const std::string& path, const StudyNumbers& numbers, const StudyFields& fields,
                   const std::function<bool(const StudyField&)>& wanted,
                   const std::function<void(const StudyField&, std::vector<double>&&)>& each);

}  // namespace dea

// views/study_page/study_surfaces.h – the surfaces that a study's stored pressures stand on, the pressures, and parts
// of a surface as places of a study, with numbers of their own.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "src/study/regions.h"
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

/// Which regions, and what they are laid out from.
struct StudyRegionOptions : RegionLayout {
  std::optional<Vector3d> up, anterior, axis, center;  ///< axis, center: else those of surface_frame
};

/// Per vertex of a surface. Throws UsageError as the functions of study/regions.h.
Regions regions_of(const StudySurfaceMesh& surface, const StudyRegionOptions& options);

/// Adds each region of each surface as a place: p99, mean, area and peak of its nodes in contact, weighted by the
/// nodes' areas, and the size of the sum of p A n. The nodes in contact of all regions together are those of the
/// greatest pressures with the area of the contact's headline (theory.md, 6.1). States without stored fields have none.
/// Numbers of regions are of the triangles of the stored surface.
void add_regions(const std::string& path, const StudyFields& fields, const StudyRegionOptions& options,
                 StudyNumbers& numbers);

}  // namespace dea

// views/study_page/study_regions.h – parts of a surface as places of a study, with numbers of their own.
#pragma once
#include <optional>
#include <string>

#include "src/study/regions.h"
#include "views/study_page/study_surfaces.h"

namespace dea {

/// Which regions, and what they are laid out from.
struct StudyRegionOptions : RegionLayout {
  std::optional<Vector3d> up, anterior, axis, center;  ///< axis, center: else those of surface_frame
};

/// Per vertex of a surface. Throws UsageError as the functions of study/regions.h.
Regions regions_of(const StudySurfaceMesh& surface, const StudyRegionOptions& options);

/// Adds each region of each surface as a place: p99, mean, area and peak of its nodes above the threshold of the whole
/// surface's headline (theory.md, 6.1), weighted by the nodes' areas, and the size of the sum of p A n. States without
/// stored fields have none. Numbers of regions are of the triangles of the stored surface.
void add_regions(const std::string& path, const StudyFields& fields, const StudyRegionOptions& options,
                 StudyNumbers& numbers);

}  // namespace dea

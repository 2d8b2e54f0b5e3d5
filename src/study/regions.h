// src/study/regions.h – regions of a surface by where its vertices or triangles are.
//
// `points`: one per vertex, or one per triangle (its centroid). Frame: that of the surface. Points that are not finite
// are refused: UsageError.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "src/results/comparison.h"

namespace dea {

struct Regions {
  std::vector<int> index;          ///< per point: which of `names`; -1: none
  std::vector<std::string> names;  ///< of the regions
};

/// `count` equal sectors about an axis. Sector 0 begins in the direction `start`, of which only what lies across the
/// axis counts, and they go on right-handed about the axis: counter-clockwise for who looks against it. A point on the
/// border of two belongs to the second, one on the axis to none (-1). Names: "0 to 60 degrees". `axis`, `start`: of any
/// length. Throws UsageError: count < 1, no axis, a start along it.
Regions sectors(const std::vector<Vector3d>& points, const Vector3d& center, const Vector3d& axis,
                const Vector3d& start, int count);

/// Six regions of a socket: "anterior medial", "anterior lateral", "superior medial", ..., "posterior lateral". Thirds
/// are those of third_of (Abraham et al. 2013), with equally many points. Of each third the half that stands deeper in
/// the socket is medial, the half nearer its rim lateral: points sorted by the angle between the frame's axis, which
/// points out of the socket, and their direction from its centre, cut into two of equally many; the one in the middle
/// of an odd number is medial. `frame`: surface_frame of the socket. Throws UsageError as third_of.
Regions socket_regions(const std::vector<Vector3d>& points, const SurfaceFrame& frame, const Vector3d& up,
                       const Vector3d& anterior);

/// Regions by where they lie, one of these.
struct RegionLayout {
  bool thirds = false;  ///< "anterior", "superior", "posterior": third_of
  bool socket = false;  ///< socket_regions
  int sectors = 0;      ///< this many, from `up` on
  bool any() const { return thirds || socket || sectors > 0; }
  bool needs_anterior() const { return thirds || socket; }
};
Regions laid_out(const std::vector<Vector3d>& points, const SurfaceFrame& frame, const RegionLayout& layout,
                 const Vector3d& up, const Vector3d& anterior);

/// The facets of one region, where points were facets: for `measure` and `facet_areas` of comparison.h.
FacetMask region_mask(const Regions& regions, int region);

}  // namespace dea

// src/build/layer_sheet.h – a sheet of prisms between bone and articular surface.
#pragma once
#include <vector>

#include "src/build/built_joint.h"
#include "src/build/sound_columns.h"
#include "src/geometry/ray_caster.h"

namespace dea {

/// Per point of a layer its thickness as dea measures it: along the normal of the articular surface down to the bone's
/// side, or to its closest point (measure_thickness). A line through the layer that was turned is longer.
std::vector<double> layer_thickness(const BuiltLayer& layer);

/// Quality of the prisms of a sheet divided into `elements_through`.
struct SheetQuality {
  double least_jacobian = 0.0;  ///< least over all corners, scaled: 1 for a straight prism on an equilateral triangle
  double mean_jacobian = 0.0;   ///< mean of each prism's least
  int inside_out = 0;           ///< prisms with a Jacobian of zero or less at a corner
  std::vector<double> thickness;                                             ///< layer_thickness
  double least_thickness = 0.0, mean_thickness = 0.0, most_thickness = 0.0;  ///< of it
  double mean_line = 0.0;                                                    ///< length of the lines through the layer
  double area = 0.0;                                                         ///< of the articular surface
  double mean_edge = 0.0;                                                    ///< of the articular surface
};
SheetQuality sheet_quality(const BuiltLayer& layer, int elements_through);

/// Per prism its least Jacobian as above: of triangle t those at t * elements_through and behind, from the bone
/// upwards. Empty: a bare bone.
std::vector<double> prism_jacobians(const BuiltLayer& layer, int elements_through);

/// Where a layer is thinner than it was to be.
struct ThinPlaces {
  double least = 0.0;                               ///< thickness that was asked for; 0: none was
  double part = 0.0;                                ///< of the area: thinner than that by more than a tenth
  double thinnest = 0.0;                            ///< there
  Eigen::Vector3d where = Eigen::Vector3d::Zero();  ///< of the thinnest
};
/// `thickness`: layer_thickness of it.
ThinPlaces thin_places(const BuiltLayer& layer, const std::vector<double>& thickness, double least);

/// The edge of a layer, where it ends or has thinned out.
struct SheetRim {
  int rims = 0;            ///< closed lines; a hole is one
  double length = 0.0;     ///< of all
  double thickness = 0.0;  ///< mean along them
};
SheetRim sheet_rim(const BuiltLayer& layer);

/// Cartilage of this thickness (per point, > 0) on a part of a bone, along the given directions (unit, out of the
/// bone): the bone's points stay.
BuiltLayer layer_on_bone(const TriangleSurface& region, const std::vector<Eigen::Vector3d>& directions,
                         const std::vector<double>& thickness, int elements_through, SheetChanges& changes);

/// Where the bone lies beneath an articular surface.
struct Beneath {
  std::vector<double> thickness;  ///< per point, along minus the normal; where that misses: to the closest point
  std::vector<char> missed;       ///< per point: the closest point's distance
  std::vector<char> under;        ///< per point: it lies inside the bone; thickness is 0 there
  std::vector<double> depth;      ///< per point that lies inside the bone: how deep; else 0
  std::vector<char> beside;       ///< per point: beside an open bone; as thick as those around
};
Beneath bone_beneath(const TriangleSurface& articular, const RayCaster& bone);

/// Cartilage between a segmented articular surface, whose points and triangles stay where columns are sound, and the
/// bone beneath it (along the normals). Thickness below `least` is raised to it, into the bone. At the rim and where
/// the cartilage thins out that is no change; where the surface lies deeper in the bone than `least` it is one.
BuiltLayer layer_under_surface(const TriangleSurface& articular, const Beneath& beneath, const RayCaster& bone,
                               double least, int elements_through, SheetChanges& changes);

/// Thickness before a rim: whole from `fade` on, `least` (or less, where it was) at the rim, between them by the cubic
/// s^2 (3 - 2 s), which is level at both ends. `thickness`: per point; `rim`: per point its distance to the rim.
void fade_at_rim(std::vector<double>& thickness, const std::vector<double>& rim, double fade, double least);

/// The same of a layer that is there: its articular points move towards the bone. Adds to `changes` what had to give
/// way beyond that so that no element is inside out.
void fade_layer(BuiltLayer& layer, double fade, double least, int elements_through, SheetChanges& changes);

}  // namespace dea

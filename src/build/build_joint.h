// src/build/build_joint.h – bones' surfaces and what is known of their cartilage become a joint.
//
//   BuildReport report;
//   const BuiltJoint joint = build_joint(request, report);
//
// Frame: the scans'. Lengths: theirs, mm as a rule. Nothing here knows a file.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "src/base/sentence.h"
#include "src/build/built_joint.h"
#include "src/build/layer_sheet.h"
#include "src/build/region.h"

namespace dea {

struct BoneRequest : BoneLoads {
  TriangleSurface surface;  ///< mended (mend_surface)
  bool closed = true;
  std::optional<Eigen::Vector3d> center;  ///< in place of the one that is found
  std::string force_frame;  ///< along whose axes the force's numbers are (leave_frames); empty: the scans'
  bool dofs_given = false;  ///< `held` and `moved` say how it moves; else choose_dofs does, within `hold`
  DofFlags hold = {};       ///< held, whatever is chosen
};

struct CartilageRequest {
  enum class Way {
    Segmented,  ///< its outer surface: thickness down to the bone
    Uniform,    ///< one thickness
    HalfGap,    ///< half the gap between the bones, bounded
    Points      ///< a thickness at points, the nearest counts
  };
  int bone = -1;
  Way way = Way::Segmented;
  TriangleSurface outer;  ///< Segmented: mended; an open sheet, or the cartilage's closed surface
  double thickness = 0.0;
  double most = 2.0, least = 0.5;       ///< HalfGap
  std::vector<Eigen::Vector3d> places;  ///< Points
  std::vector<double> thickness_there;  ///< Points
  std::optional<GivenRegion> region;    ///< not Segmented
};

/// The thickest that is asked for; 0: segmented.
double asked_thickness(const CartilageRequest& cartilage);

struct BuildRequest {
  Wording wording = plain_wording();  ///< how findings name options
  std::vector<BoneRequest> bones;
  std::vector<CartilageRequest> cartilages;  ///< one per bone at most
  std::vector<BuiltLigament> ligaments;
  std::optional<double> reach;  ///< gaps between bones below it belong to a region; empty: 3 times the thickest layer
  double rim_length = 2.0;      ///< over which rims and thicknesses are smoothed
  std::optional<double> fade;   ///< width over which all layers thin out to their least (or a tenth) at the rim;
                                ///< empty: HalfGap rim_length, others 0
  bool fill_holes = true;
  std::optional<double> edge;  ///< remeshed to it; empty: triangles stay
  int elements_through = 2;
  std::optional<double> least_thickness;  ///< of segmented layers; empty: a tenth of the mean
  bool whole_bones = true;                ///< the bones as shells
  std::string primary;                    ///< bone whose layers are primary; empty: the smaller layer of each contact
  std::size_t most_bone_triangles = 0;    ///< bones' shells are decimated to it; 0: as they are
};

struct LayerReport {
  std::string way;  ///< in words
  int holes_filled = 0, parts_left_out = 0;
  int slivers = 0;           ///< triangles that were all but a line, merged with their neighbours
  int raised = 0;            ///< vertices with less than the least thickness
  double raised_area = 0.0;  ///< around them
  int below_least = 0;       ///< vertices of half the gap that are thinner than the least thickness that was asked for
  int missed = 0;            ///< thickness to the closest point
  int under = 0;             ///< vertices inside the bone
  int beside = 0;            ///< vertices with no bone beneath, for it is open and ends there: as thick as those around
  SheetChanges changes;
  SheetQuality quality;
  ThinPlaces thin;    ///< of segmented layers
  double fade = 0.0;  ///< width over which it thins out before its rim; 0: it ends there
  SheetRim rim;
};

struct ContactReport {
  double least_gap = 0.0;  ///< of the articular surfaces, < 0: they overlap
  double facing = 0.0;     ///< part of the primary's points that face the secondary
};

struct BuildReport {
  std::vector<std::string> findings;  ///< what was concluded, a line each
  std::vector<LayerReport> layers;    ///< as in BuiltJoint
  std::vector<ContactReport> contacts;
  double reach = 0.0;  ///< up to which gap articular surfaces face each other
};

/// Open surfaces become oriented such that they face the other bones; build_joint does that by itself.
void turn_open_bones(BuildRequest& request, BuildReport& report);

/// Throws InputError: bones far apart or inside each other, layers of one bone in one place, no region, a cartilage
/// surface that is nowhere near its bone, cartilage of which less than half can be meshed.
BuiltJoint build_joint(const BuildRequest& request, BuildReport& report);

}  // namespace dea

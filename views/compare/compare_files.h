// views/compare/compare_files.h – plot files side by side: which surfaces and states pair, and all numbers
// about them. The last file is the reference: every other one is compared with it.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "io/results/result_file.h"
#include "src/results/comparison.h"
#include "src/results/headline.h"
#include "src/study/regions.h"
#include "views/compare/compare_inside.h"

namespace dea {

/// Whose areas weigh: those of the mesh in the reference configuration, or with its nodes moved by each file's own
/// displacement at the compared state; dea's own files have their mesh's either way. Places are those of the reference
/// configuration in both.
enum class CompareAreas { Reference, Deformed };

struct CompareOptions {
  CompareAreas areas = CompareAreas::Reference;
  std::optional<double> at;           ///< time; none: the last state of each
  std::vector<std::string> surfaces;  ///< "NAME" or one name per file, "A=B"; empty: those with pressure somewhere
  std::vector<double> thresholds = {0.1, 0.5};  ///< pressures above 0
  std::vector<std::string> regions;             ///< sets of the files
  RegionLayout layout;                          ///< regions by where they lie; with up, and anterior if it needs that
  Vector3d up = Vector3d::Zero(), anterior = Vector3d::Zero();
  std::optional<double> dose_above;
  bool profile = false;
  double bin = 5.0;                      ///< [degrees]
  std::optional<Vector3d> axis, center;  ///< of profile and layout; none: the reference surface's own
};

/// What the places of a region have borne up to the compared state, of nodal averages. Of one state: NaN.
struct TimeMeasures {
  double max_peak = 0.0, mean_peak = 0.0;  ///< mean: area-weighted over nodes that ever had pressure
  double max_exposure = 0.0, mean_exposure = 0.0;
  double max_dose = 0.0, mean_dose = 0.0;  ///< NaN without threshold
};

/// The facets of a region in each file; empty: all.
struct Region {
  std::string name;
  std::vector<FacetMask> masks;
};
/// A surface of a file's state.
struct SurfaceIn {
  int number = -1;  ///< in the state's mesh
  const ResultSurface* geometry = nullptr;
};
/// The whole surface, regions that are sets of the files, those of the layout. `on`: per file. `own`: the reference
/// surface's frame, where the options have none.
std::vector<Region> make_regions(const std::vector<ResultFile>& files, const std::vector<int>& states,
                                 const std::vector<SurfaceIn>& on, const CompareOptions& options,
                                 const SurfaceFrame& own);

struct ComparedRegion {
  std::string name;                            ///< empty: the whole surface
  std::vector<Headline> headlines;             ///< one per file
  std::vector<SurfaceMeasures> results;        ///< one per file; thresholds: 0, then CompareOptions::thresholds
  std::vector<TimeMeasures> over_time;         ///< one per file
  std::vector<PatternDifference> differences;  ///< one per file but the last
  std::vector<double> facet_correlation;       ///< the same: unweighted, of all facets; NaN where meshes differ
};

/// What a file says of its whole surface at the compared state, with both areas.
struct SurfaceFacts {
  double area = 0.0;                ///< of the mesh
  double deformed_area = 0.0;       ///< NaN: the file has no displacement; dea's own: that of the mesh
  bool deforms = false;             ///< facets change their areas, by more than 1/1000: single precision is not it
  double resultant = 0.0;           ///< |sum of p A n|, areas of the mesh
  double deformed_resultant = 0.0;  ///< the same of the deformed surface; NaN: no displacement
  std::optional<Vector3d> contact_force;  ///< on the surface, as the file has it
  double carried = 1.0;                   ///< |sum of p A n| of its map on the reference's mesh over its own
  InterfaceCompliance interface;
};
/// Share of the file's own contact force that pressure times these areas is; NaN: the file has none, or no pressure.
double share_of_contact_force(const SurfaceFacts& facts, CompareAreas areas);

struct ComparedSurface {
  std::vector<std::string> names;                 ///< one per file
  std::vector<int> facets;                        ///< one per file
  std::vector<SurfaceFacts> facts;                ///< one per file
  bool asked_for = true;                          ///< false: taken by itself though a file has no pressure on it
  std::vector<char> same_mesh;                    ///< one per file but the last
  std::vector<double> covered;                    ///< the same: share of the reference's area
  std::vector<double> covered_by_reference;       ///< the same: share of its own area that the reference covers
  std::vector<ComparedRegion> regions;            ///< the whole surface first
  std::vector<std::vector<ProfileBin>> profiles;  ///< one per file; empty: not asked for
  Vector3d axis = Vector3d::Zero(), center = Vector3d::Zero();  ///< of the profiles
  std::vector<ComparedRow> inside;  ///< rows of elements; empty: not all files have their stress on one mesh
};

struct ComparedBody {
  std::string name;
  std::vector<std::optional<BodyPose>> results;            ///< one per file
  std::vector<std::optional<PoseDifference>> differences;  ///< one per file but the last
};

struct Comparison {
  CompareAreas areas = CompareAreas::Reference;
  std::vector<std::string> labels, paths;
  std::vector<int> states;         ///< the compared state of each file
  std::vector<double> times;       ///< its time
  std::vector<char> solved;        ///< is it a solution?
  std::string units;               ///< of the first file that names them
  std::vector<double> thresholds;  ///< 0 first
  std::optional<double> dose_above;
  std::vector<ComparedSurface> surfaces;
  std::vector<ComparedBody> bodies;  ///< those that more than one file has
  std::vector<std::string> warnings;
};

/// A surface in the reference configuration, with the areas that weigh. Throws InputError: no displacement to deform
/// by.
ResultSurface compared_surface(const ResultFile& file, int state, int surface, CompareAreas areas);

/// Throws InputError: no such time or surface, nothing in common, no contact pressure, no displacement for areas.
Comparison compare_files(const std::vector<ResultFile>& files, const CompareOptions& options);

/// The results' pressures on the first file's mesh, with the differences; states where the times of all files pair, or
/// only the compared one. `time_fields`: also peak, exposure and dose up to each state.
XpltFile make_compare_file(const std::vector<ResultFile>& files, const CompareOptions& options,
                           const Comparison& comparison, bool time_fields, bool compressed);

}  // namespace dea

// io/results/result_file.h – a plot file of whatever program as the plain structs of src/results/comparison.h.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "io/xplt/xplt.h"
#include "src/results/comparison.h"

namespace dea {

struct ResultFile {
  std::string path;
  std::string label;  ///< its name in tables and fields
  XpltFile xplt;      ///< at least one state
};

/// Throws InputError: not a plot file, no complete state.
ResultFile read_result(const std::string& path, const std::string& label);

/// Of a file of a newer FEBio (is_newer): its version, and how many parts of it were passed over.
std::string newer_note(const ResultFile& result);

/// The mesh that belongs to a state.
const XpltMesh& mesh_of(const ResultFile& result, int state);

/// False: the program that wrote the state had not solved it.
bool is_solution(const ResultFile& result, int state);
/// "warning: hip.xplt: the state at time 1 is no solution; do not use its numbers"
std::string no_solution_warning(const ResultFile& result, int state);
/// Of remarks, such warnings alone: what is said with -q too.
std::vector<std::string> no_solution_warnings(const std::vector<std::string>& remarks);

/// Plot files hold times in single precision.
bool same_time(double a, double b);
/// Throws InputError, with the times there are, when there is no state at `time`.
int find_state(const ResultFile& result, double time);

/// Index of a surface in the state's mesh, -1: none of this name.
int find_surface(const ResultFile& result, int state, const std::string& name);
/// In the reference configuration.
ResultSurface result_surface(const ResultFile& result, int state, int surface);
/// Three numbers per node of the mesh, the file's own `displacement` in this state; null: none.
const std::vector<float>* displacement_of(const ResultFile& result, int state);
/// With the nodes moved by the file's own `displacement` in this state; none: the file has no displacement there.
std::optional<ResultSurface> deformed_surface(const ResultFile& result, int state, int surface);

/// A scalar surface field as one value per facet (values per node or slot: their mean); empty: the surface has none in
/// this state. Throws InputError for values that are not finite (`undefined`: they become NaN) and for fields that are
/// no scalars.
std::vector<double> facet_values(const ResultFile& result, int state, int surface, const std::string& field,
                                 bool undefined = false);

/// Do dea's springs stand on the surface in this state? Files of other programs do not say so: no.
bool has_springs(const ResultFile& result, int state, int surface);

/// A vector field with one value for the whole surface; none: the surface has none in this state.
std::optional<Vector3d> surface_vector(const ResultFile& result, int state, int surface, const std::string& field);

/// Rigid bodies by the names of their materials: position from `rigid position` or else the body's axes, rotation from
/// the axes.
std::vector<BodyPose> body_poses(const ResultFile& result, int state);

/// The facets of a surface that lie in the facet set, surface or element set `name`: with all their nodes in a facet or
/// an element of it. Throws InputError: no such set, no facet in it.
FacetMask facets_in(const ResultFile& result, int state, int surface, const std::string& name);

/// Sets that facets_in takes.
std::vector<std::string> region_names(const XpltMesh& mesh);

}  // namespace dea

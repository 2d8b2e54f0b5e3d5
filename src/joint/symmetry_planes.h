// febiodea/joint/symmetry_planes.h – where a model is one half or quarter of what it stands for.
#pragma once
#include <map>
#include <string>
#include <vector>

#include <febiodea/model/joint_model.h>

namespace dea {

/// Nodes nearer to a plane than this lie in it: what rounding leaves of a plane. A thousandth of the size of the facets
/// of contact surfaces, the finest surface's mean.
double same_plane(const JointModel& model);

/// Where a deformable part ends across an axis, and nodes of it are held there.
struct PartEnd {
  int region = -1;
  SymmetryPlane plane;
  int nodes = 0;               ///< there, those that a bone holds aside
  int held = 0;                ///< of these, across the plane
  std::vector<int> forgotten;  ///< the others, where they are few: they count as held
  int instead = -1;            ///< the component in which most are held where few are across the plane; -1: not so
  int step = 0;                ///< from which on they are held
};

/// A plane of symmetry: held at half its nodes or more.
bool is_plane(const PartEnd& end);

/// The ends at which nodes are held. Per node: `region`, -1: in no deformable part; `held`, bit k: in component k;
/// `on_bone`: held by one.
std::vector<PartEnd> find_part_ends(const JointModel& model, const std::vector<int>& region,
                                    const std::vector<unsigned char>& held, const std::vector<char>& on_bone);

/// Of one contact: those of the parts that its two surfaces lie on, and those that it states itself. Sorted, each once.
std::vector<SymmetryPlane> planes_of_contact(const JointModel& model, const Contact& contact,
                                             const std::vector<int>& region,
                                             const std::map<int, std::vector<SymmetryPlane>>& of_region);

/// Adds what is not there yet, and sorts.
void add_planes(const JointModel& model, const std::vector<SymmetryPlane>& more, std::vector<SymmetryPlane>& planes);

/// Per node: bit k set, it lies in one of the planes, across axis k. Empty if there is no plane.
std::vector<unsigned char> nodes_in_planes(const JointModel& model, const std::vector<SymmetryPlane>& planes);

/// "x = 0, y = -12.5"
std::string in_words(const std::vector<SymmetryPlane>& planes);

}  // namespace dea

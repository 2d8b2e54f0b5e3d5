// src/facts/symmetry_planes.h – where a model is one half or quarter of what it stands for.
#pragma once
#include <string>
#include <vector>

#include "src/facts/node_holds.h"
#include "src/model/joint_model.h"

namespace dea {

/// Nodes nearer to a plane than this lie in it: what rounding leaves of a plane. A thousandth of the size of the facets
/// that contacts press on deformable parts, the finest surface's mean; without any, of the facets of all contacts.
/// `region`: per node, -1: in no deformable part.
double same_plane(const JointModel& model, const std::vector<int>& region);

/// Where a deformable part ends across an axis, and nodes of it are held there.
struct PartEnd {
  int region = -1;
  SymmetryPlane plane;
  bool is_plane = false;       ///< of symmetry: more than half of its nodes are held across it
  int nodes = 0;               ///< there, those that a bone holds aside
  int held = 0;                ///< of these, across the plane
  std::vector<int> forgotten;  ///< the others, where they are few: they count as held
  int instead = -1;            ///< no plane of symmetry, but held in this component; -1: not so
  std::vector<int> steps;      ///< in which a plane of symmetry is held
};

/// The ends at which nodes are held. Per node: `region`; `held`, bit k: in component k; `on_bone`: held by one.
std::vector<PartEnd> find_part_ends(const JointModel& model, const std::vector<int>& region,
                                    const NodeHolds& node_holds, const std::vector<unsigned char>& held,
                                    const std::vector<char>& on_bone, double same_plane);

/// Of one contact: those of the parts that its two surfaces lie on, and those that it states itself. Sorted, each once.
std::vector<SymmetryPlane> planes_of_contact(const JointModel& model, const Contact& contact,
                                             const std::vector<int>& region, const std::vector<PartEnd>& ends,
                                             double same_plane);

/// Adds what is not there yet, and sorts.
void add_planes(const std::vector<SymmetryPlane>& more, double same_plane, std::vector<SymmetryPlane>& planes);

/// Per node: bit k set, it lies in one of the planes, across axis k. Empty if there is no plane.
std::vector<unsigned char> nodes_in_planes(const std::vector<Vector3d>& nodes, const std::vector<SymmetryPlane>& planes,
                                           double same_plane);

/// "x = 0, y = -12.5"
std::string in_words(const std::vector<SymmetryPlane>& planes);

}  // namespace dea

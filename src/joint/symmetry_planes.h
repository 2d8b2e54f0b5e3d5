// febiodea/joint/symmetry_planes.h – where a model is one half or quarter of what it stands for.
#pragma once
#include <map>
#include <string>
#include <vector>

#include <febiodea/model/joint_model.h>

namespace dea {

/// By deformable part: planes across an axis at which it ends and is held there along that axis, at half its nodes or
/// more (those that a bone holds aside). Per node: `region`, -1: in no deformable part; `held`, bit k: in component k;
/// `on_bone`: held by one.
std::map<int, std::vector<SymmetryPlane>> find_symmetry_planes(const JointModel& model, const std::vector<int>& region,
                                                               const std::vector<unsigned char>& held,
                                                               const std::vector<char>& on_bone);

/// Of one contact: those of the parts that its two surfaces lie on, and those that it states itself. Sorted, each once.
std::vector<SymmetryPlane> planes_of_contact(const JointModel& model, const Contact& contact,
                                             const std::vector<int>& region,
                                             const std::map<int, std::vector<SymmetryPlane>>& of_region);

/// Adds what is not there yet, and sorts.
void add_planes(const JointModel& model, const std::vector<SymmetryPlane>& more, std::vector<SymmetryPlane>& planes);

/// Per node: bit k set, it lies in one of the planes, across axis k. Empty if there is no plane.
std::vector<unsigned char> nodes_in_planes(const std::vector<Vector3d>& nodes,
                                           const std::vector<SymmetryPlane>& planes);

/// "x = 0, y = -12.5"
std::string in_words(const std::vector<SymmetryPlane>& planes);

}  // namespace dea

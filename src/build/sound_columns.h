// src/build/sound_columns.h – columns of prisms between a bone and an articular surface, none of them inside out.
//
// A column has one triangle on either side. At height z of it, from 0 (bone) to 1, n(z) is the triangle's normal, as
// long as twice its area, and c_i are the lines from the bone to the surface at its corners. The Jacobian of the
// column, divided into however many prisms, is the mean of n(z) . c_i with the weights of the place in the triangle. So
// it is above zero everywhere if and only if n(z) . c_i > 0 at each corner for all z: three parabolas. Where
// neighbouring lines are parallel, n(z) . c_i does not depend on z. So a layer whose lines turn slowly is sound
// wherever the side that stays can be seen along them, however thick it is.
#pragma once
#include <functional>
#include <vector>

#include "src/build/built_joint.h"
#include "src/geometry/ray_caster.h"

namespace dea {

/// What had to give way so that every element is sound.
struct SheetChanges {
  int turned = 0;                                   ///< vertices whose direction through the layer was changed
  double most_turned = 0.0;                         ///< by how much at most [rad]
  int moved = 0;                                    ///< vertices of the side that stays which moved within it
  double most_moved = 0.0;                          ///< by how much at most [length]
  int thinned = 0;                                  ///< vertices whose thickness was changed
  double most_thinned = 0.0;                        ///< the largest change as a part of the wanted thickness there, or
                                                    ///< of half the layer's mean where it is thinner
  double mean_change = 0.0;                         ///< of the thickness, over the layer [length]
  double most_change = 0.0;                         ///< the same at most [length]
  double changed_part = 0.0;                        ///< of the area: thickness changed by more than kMuchThinned
  double area_lost = 0.0;                           ///< of columns that were left out
  double wanted_area = 0.0;                         ///< before that
  Eigen::Vector3d where = Eigen::Vector3d::Zero();  ///< of the largest change of thickness, else of direction
  std::vector<double> change;                       ///< per vertex that is left: thickness now less the wanted one
  std::vector<double> wanted;                       ///< per vertex that is left: the wanted thickness

  double lost_part() const { return wanted_area > 0 ? area_lost / wanted_area : 0.0; }
};

/// A change of thickness that a reader is to know of, as a part of the thickness, and the part of a layer's area over
/// which it matters, or that was left out.
inline constexpr double kMuchThinned = 0.1, kMuchArea = 0.01;
bool much_changed(const SheetChanges& changes);

/// How sound the column of a triangle is: the least cosine between the normal of the triangle and the lines from bone
/// to surface, at the heights where prisms meet; -1: a Jacobian is zero or less somewhere in it.
double column_soundness(const BuiltLayer& layer, const std::array<int, 3>& triangle, int elements_through);

struct SoundOptions {
  int elements_through = 2;
  bool bone_stays = true;           ///< the articular surface gives way; false: the bone side does
  const RayCaster* bone = nullptr;  ///< on which the bone side is to lie if it gives way; none: where it lay
  double least = 0.0;               ///< thickness to which the layer was raised, into the bone
  /// Of the layer along a new direction from a point of the side that stays; `length`: as it was. NaN: keeps that.
  /// Empty: keeps it everywhere.
  std::function<double(const Eigen::Vector3d& from, const Eigen::Vector3d& direction, double length)> recast;
};

/// Lets the layer give way where columns are not sound, and nowhere else: lines from bone to surface become smooth;
/// columns at the rim that are not sound are left out; points are spread within the side that stays, where it folds;
/// the layer becomes thinner; columns that are still not sound are left out. A layer that is sound stays as it is. Adds
/// to `changes`; `changes.change` and `changes.wanted` follow the vertices that are left.
void make_sound(BuiltLayer& layer, const SoundOptions& options, SheetChanges& changes);

/// The numbers of `changes` that follow from its values per vertex.
void sum_changes(const BuiltLayer& layer, SheetChanges& changes);

}  // namespace dea

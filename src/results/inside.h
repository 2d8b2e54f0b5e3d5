// src/results/inside.h – stress and strain inside the cartilage of a solved contact: at the bone, at the articular
// surface, at any point of a layer. docs/layer_law.md, section 8.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "src/joint/layer.h"
#include "src/results/inside_numbers.h"
#include "src/springs/layer_bed.h"
#include "src/springs/layer_inside.h"

namespace dea {

/// What of a contact's layers does not depend on pressures: made once, used for all states.
struct InsideMap {
  struct Side {
    const LayerOperator* layer = nullptr;  ///< owned by `layers`; null: nothing to look into
    InsideShape shape;
    DepthLaws laws;
  };
  std::shared_ptr<const LayerBed> layers;
  Side sides[2];  ///< primary, secondary
};
/// A side has no layer where it is a bare rigid surface, and no side has one where the law is not Law::Layer with
/// LayerFit::TwoTerms: only these have the fractions.
InsideMap make_inside_map(const SpringBed& bed);

/// Both layers of a contact under its pressures. Frame of each: the layer's reference configuration.
struct InsideContact {
  std::optional<InsideLayer> sides[2];  ///< primary, secondary; empty as InsideMap::Side::layer
};
/// `states`: of the bed at these poses; `map` must outlive the result. States without springs (a contact that is not
/// active) have no pressure anywhere.
InsideContact look_inside(const InsideMap& map, const SpringBed& bed, const SpringStates& states,
                          const Pose& source_pose, const Pose& target_pose);

/// Places in a layer of points of its reference configuration, such as its elements' centroids: below the closest point
/// of its face, at the height that the distances from bone and face tell; where the bone is not known, the depth below
/// the face over the thickness. Points that lie far beside the face have triangle -1.
std::vector<InsidePlace> inside_places(const Layer& layer, const LayerMesh& mesh, const std::vector<Vector3d>& points);

/// At each place; NaN throughout where a place has no triangle.
std::vector<InsideState> states_inside(const InsideLayer& inside, const std::vector<InsidePlace>& places,
                                       StrainMeasure measure);

/// As FEBio's plot files have it: stress, normal and shear in current global axes; Lagrange strain stays in the axes of
/// the reference.
InsideState turned(InsideState state, const Eigen::Matrix3d& rotation);

/// `measured`: of all vertices, at one height (states_at_height). `among`: per vertex, whether it counts; empty: all.
InsideStatistics inside_statistics(const InsideLayer& inside, const std::vector<InsideMeasures>& measured,
                                   const std::vector<char>& among = {});

}  // namespace dea

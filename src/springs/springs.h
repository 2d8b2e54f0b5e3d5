// src/springs/springs.h – the bed of springs between two facing layers, and its state at a pose: values.
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <vector>

#include "src/base/stop.h"
#include "src/geometry/pose.h"
#include "src/geometry/ray_caster.h"
#include "src/joint/joint.h"

namespace dea {

struct LayerBed;  // layer_bed.h

/// Over small motions of two bodies: the target's translation (of its centre of mass), rotation, the source's.
using Vector12 = Eigen::Matrix<double, 12, 1>;
using Matrix12 = Eigen::Matrix<double, 12, 12>;

/// The springs of one contact. Frame: the source's reference configuration.
struct Springs {
  std::vector<std::array<Vector3d, 3>> triangle;        ///< foot triangle: its share of the source surface
  std::vector<Vector3d> foot;                           ///< its centroid
  std::vector<Vector3d> direction;                      ///< unit normal of the triangle, towards the target
  std::vector<double> area;                             ///< of the triangle, > 0
  std::vector<std::array<double, 3>> corner_thickness;  ///< t_s at the corners, >= 0
  std::vector<double> bulge;          ///< height of the smooth surface above the foot (surface_mesh.h)
  std::vector<int> surface_triangle;  ///< triangle of the source's spring surface it stands on
  std::vector<std::array<std::array<double, 3>, 3>> weights;  ///< of each corner in that triangle (barycentric)
  int size() const { return static_cast<int>(foot.size()); }
};

/// Tension of a line between two points, > 0 pulls, and how it grows with their distance.
struct Tension {
  double force = 0.0;
  double slope = 0.0;
};

/// A ligament of which an end is a node of a part that nobody holds: it moves the part, and gives way with it. Or a
/// hold of a node by the second of two bodies that hold a part: a stiff spring along an axis of the part's frame.
struct PartTie {
  int ligament = -1;                                              ///< index into Joint::ligaments; -1: a hold
  Vector3d source = Vector3d::Zero(), target = Vector3d::Zero();  ///< its ends, in the bodies' reference frames
  int source_node = -1, target_node = -1;                         ///< nodes of parts; -1: the end is the body's own
  int axis = 0;                                                   ///< of a hold: 0 to 2
  double stiffness = 0.0;                                         ///< of a hold [N/mm]
};

/// Everything needed again and again at new poses. A value: pressed by several callers at a time, it never changes.
struct SpringBed {
  ContactPair pair;
  int source_body = -1, target_body = -1;
  Vector3d source_center = Vector3d::Zero(), target_center = Vector3d::Zero();  ///< reference centres of mass
  Springs springs;
  RayCaster target;                  ///< of the target's spring surface, reference frame
  std::vector<double> rim_distance;  ///< of the target's triangles
  double foot_radius = 0.0;          ///< largest distance of a foot triangle's corner from its centroid
  double max_target_thickness = 0.0;
  double part_depth = 0.0;  ///< SoftPart::depth of both sides: so much deeper a foot may stand before it is too deep
  std::shared_ptr<const LayerBed> layers;  ///< Law::Layer, else empty
  /// Not empty: the bed is no contact but the ligaments, or the holds, between two bodies that parts have to do with.
  /// They have no springs; each is one foot with this area, which stands for nothing: pressures are tensions per area.
  std::vector<PartTie> ties;
  double tie_area = 0.0;
  bool holds() const { return !ties.empty() && ties.front().ligament < 0; }  ///< all of `ties` are
  int size() const { return ties.empty() ? springs.size() : static_cast<int>(ties.size()); }
};

/// A pair of bodies that small motions are told of: the target's relative to the source.
struct BodyPair {
  int source = -1, target = -1;
  bool operator==(const BodyPair&) const = default;
};

/// How the pressures of a contact change with small motions of another one's bodies, as SpringStates::rates: where
/// both press a layer.
struct CrossRates {
  BodyPair bodies;
  Vector3d source_center = Vector3d::Zero(), target_center = Vector3d::Zero();  ///< current centres of mass
  Eigen::MatrixXd rates;                                                        ///< n x 6
};

/// A spring over the target's rim: how the covered part of its foot triangle changes with small motions.
struct RimSpring {
  int spring = -1;
  Vector12 area_rate = Vector12::Zero();  ///< d(area)
  Eigen::Matrix<double, 3, 12> foot_rate =
      Eigen::Matrix<double, 3, 12>::Zero();       ///< d(foot) in the source's frame (its plane)
  Vector3d pressure_gradient = Vector3d::Zero();  ///< of the pressure along the foot's plane; 0 where rates have it
};

/// What the springs do at one pose. One entry per spring; global frame, current configuration.
struct SpringStates {
  std::vector<int> triangle;        ///< of the target's spring surface, -1: the ray met nothing
  std::vector<double> coverage;     ///< fraction of the foot triangle that lies over the target, 0..1
  std::vector<Vector3d> foot;       ///< where the spring stands (centroid of the covered part of its triangle)
  std::vector<Vector3d> direction;  ///< n
  std::vector<Vector3d> end;        ///< q: where the ray meets the target
  std::vector<Vector3d> normal;     ///< m: target's unit normal at q, against n
  std::vector<std::array<double, 3>> end_weights;  ///< barycentric weights of q in `triangle`
  std::vector<double> gap;                         ///< signed g of (S2), > 0 apart; infinity where the ray met nothing
  std::vector<double> t_source, t_target;
  std::vector<double> overlap;   ///< Delta >= 0
  std::vector<double> pressure;  ///< >= 0
  std::vector<double> strain;    ///< the larger of the two layers' strains
  std::vector<double> strain_source, strain_target;
  std::vector<double> per_overlap;   ///< dp/dDelta
  std::vector<Vector3d> per_motion;  ///< kappa: dp = kappa . (delta_target - delta_source) at q  (E2-E4)
  std::vector<double> area;          ///< coverage * area: what the pressure acts on
  std::vector<double> carrying;      ///< area, and what bulges out over a layer's free edge and is pressed, too (L11)
  std::vector<char> too_deep;        ///< the target lies deeper under the foot than both layers are thick
  std::vector<RimSpring> rim;        ///< the springs that are covered in part and loaded
  /// Law::Layer, else empty: dp of small motions of the target relative to the source, translation and rotation about
  /// the target's current centre of mass, n x 6; takes the place of per_motion, for every pressure depends on all gaps.
  Eigen::MatrixXd rates;
  std::vector<CrossRates> cross;  ///< Law::Layer, of contacts of other bodies that press the same layers
  /// Law::Layer: residual of (L4), relative to the largest pressure; of parts that do not settle, how far pressures
  /// change from round to round.
  double complementarity = 0.0;
  bool complementary = true;      ///< Law::Layer: (L4) was solved to its tolerance
  /// Where a side is a part's surface: how its nodes have moved in its frame (nodes x 3); source, target.
  std::array<Eigen::MatrixX3d, 2> part_motion;
  int size() const { return static_cast<int>(gap.size()); }
  /// The spring's force [N].
  double force(std::size_t k) const { return pressure[k] * carrying[k]; }
};

/// Springs whose pressure means nothing.
struct SpringDepth {
  int strained = 0;      ///< beyond the law's strain limit (C1)
  int through = 0;       ///< too_deep
  double largest = 0.0;  ///< strain of those that are not
};
SpringDepth spring_depth(const SpringStates& states);

/// Small motions of the target relative to the source, along global axes: translation, rotation about the target's
/// centre of mass.
using Motions = std::array<bool, 6>;
inline constexpr Motions kAllMotions = {true, true, true, true, true, true};

/// A search for the pose takes pressures for a smooth function of it: they must be known closer than it is to be found.
inline constexpr double kPressureTolerance = 3e-10;
/// Enough where the pose is given: far below any mesh's error.
inline constexpr double kGivenPoseTolerance = 1e-7;

/// How much is asked for at a pose (Law::Layer).
struct PressOptions {
  Motions motions = kAllMotions;          ///< whose `rates`: they cost more than the pressures; the others' stay zero
  double tolerance = kPressureTolerance;  ///< of `complementarity`
  double rate_tolerance = 1e-7;           ///< of `rates`, relative
  const StopFlag* stop = nullptr;         ///< not owned; once it is set the search for pressures throws Stopped
};

/// What a search may start from: pressures at one pose, of the springs of all contacts that are pressed together, their
/// rates (springs x 6 per pair of bodies, as SpringStates::rates; zero: not asked for), the poses of these pairs, and
/// how they and the pressures had changed since the pose before. Only the time changes with it: results do not, but in
/// the last digits of the tolerance.
struct PressMemory {
  Eigen::VectorXd pressure;
  Eigen::MatrixXd rates;
  std::vector<Pose> source, target;
  Eigen::VectorXd nearly;                     ///< the pressures, and below zero what is missing for one
  Eigen::VectorXd change, motion;             ///< of `nearly`; 6 per pair; empty: there was none
  std::vector<Eigen::MatrixX3d> part_motion;  ///< of the parts that are pressed together, in their order
  std::vector<Eigen::MatrixXd> part_rates;    ///< of these, as `rates`: 3 x nodes of it, x 6 per pair; empty: unknown
};

}  // namespace dea

// src/springs.h – the bed of springs between two facing layers, and its state at a pose of the two bodies.
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <vector>

#include "foot_parts.h"
#include "joint.h"
#include "ray_caster.h"

namespace dea {

/// The matrix of the cross product: skew(a) b = a x b.
Eigen::Matrix3d skew(const Vector3d& a);

/// Pose of a body: x = center + rotation * (X - center of mass in the reference).
struct Pose {
  Vector3d center = Vector3d::Zero();  ///< current centre of mass
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
};

struct LayerBed;  // layer_bed.h

/// One body seen from another's reference frame: Y = rotation * X + shift for a point X of the one's reference.
struct RelativePose {
  Eigen::Matrix3d rotation;
  Vector3d shift;
};
/// `from_center`, `to_center`: reference centres of mass.
RelativePose relative_pose(const Pose& from, const Vector3d& from_center, const Pose& to, const Vector3d& to_center);

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

/// One spring per triangle of the source's spring surface, each divided into refine^2 equal ones.
Springs make_springs(const Layer& source, int refine);

/// Everything needed again and again at new poses.
struct SpringBed {
  const ContactPair* pair = nullptr;
  int source_body = -1, target_body = -1;
  Vector3d source_center = Vector3d::Zero(), target_center = Vector3d::Zero();  ///< reference centres of mass
  Springs springs;
  RayCaster target;                  ///< of the target's spring surface, reference frame
  std::vector<double> rim_distance;  ///< of the target's triangles
  double foot_radius = 0.0;          ///< largest distance of a foot triangle's corner from its centroid
  double max_target_thickness = 0.0;
  Law law = Law::Linear;
  std::shared_ptr<LayerBed> layers;  ///< Law::Layer, else empty
};
SpringBed make_spring_bed(const Joint& joint, const ContactPair& pair);

/// A spring over the target's rim: how the covered part of its foot triangle changes with small motions. Order of the
/// 12 unknowns as in ContactWrench.
struct RimSpring {
  int spring = -1;
  Eigen::Matrix<double, 12, 1> area_rate = Eigen::Matrix<double, 12, 1>::Zero();  ///< d(area)
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
  std::vector<char> too_deep;        ///< the target lies deeper under the foot than both layers are thick
  std::vector<RimSpring> rim;        ///< the springs that are covered in part and loaded
  /// Law::Layer, else empty: dp of small motions of the target relative to the source, translation and rotation about
  /// the target's current centre of mass, n x 6; takes the place of per_motion, for every pressure depends on all gaps.
  Eigen::MatrixXd rates;
  double complementarity = 0.0;  ///< Law::Layer: residual of (L4), relative to the largest pressure
  bool complementary = true;     ///< Law::Layer: (L4) was solved to its tolerance
  int size() const { return static_cast<int>(gap.size()); }
};

/// What of the target's triangles lies under spring i, whose ray meets the target (L8). `surface`: the target's, whole
/// or divided; `first`: its triangle that the ray meets; `end`: triangles from here on are no part of the contact.
/// Never empty: where nothing but rounding is left, all on triangle `first`.
std::vector<SurfacePart> parts_under_spring(const SpringBed& bed, const RelativePose& relative,
                                            const SurfaceMesh& surface, const SpringStates& states, int i, int first,
                                            int end);

/// kappa: d(overlap) = kappa . (delta_target - delta_source) at the end of spring i (E2), less what its rest length
/// loses by the target's thickness there, times its strain (E3). Global frame.
Vector3d overlap_rate(const SpringBed& bed, const SpringStates& states, int i, double strain_target,
                      const Pose& target);

/// How the overlap changes with the place of the spring's foot in its triangle, through the source's own bulge and
/// thickness, per length, global frame.
Vector3d source_overlap_gradient(const SpringBed& bed, const SpringStates& states, int i, double strain_source,
                                 const Pose& source);

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

/// What a solver above takes for a function of the pose must be smoother than its own tolerance.
inline constexpr double kPressureTolerance = 3e-10;
/// Enough where the pose is given: far below any mesh's error.
inline constexpr double kGivenPoseTolerance = 1e-7;

/// How much is asked for at a pose (Law::Layer).
struct PressOptions {
  Motions motions = kAllMotions;          ///< whose `rates`: they cost more than the pressures; the others' stay zero
  double tolerance = kPressureTolerance;  ///< of `complementarity`
  double rate_tolerance = 1e-7;           ///< of `rates`, relative: Newton's method with them is quadratic down to it
};

/// Casts every spring's ray at this pose (S1-S5, E2-E4). Parallel over springs; each is computed by itself, so the
/// result does not depend on the number of threads.
SpringStates project_springs(const SpringBed& bed, const Pose& source, const Pose& target,
                             const PressOptions& options = {});

/// Force and moment of the contact on target and source, about their current centres of mass, and their
/// derivative with respect to small motions (translation of the centre of mass, rotation) of both. Order of the
/// 12 unknowns: target's translation, rotation, source's translation, rotation.
struct ContactWrench {
  Eigen::Matrix<double, 12, 1> wrench = Eigen::Matrix<double, 12, 1>::Zero();
  Eigen::Matrix<double, 12, 12> derivative = Eigen::Matrix<double, 12, 12>::Zero();
  double normal_force = 0.0;  ///< sum of p A: the scale of the contact's forces
};
ContactWrench contact_wrench(const SpringStates& states, const Pose& source, const Pose& target);

/// For surfaces apart, whose springs give Newton's method nothing to go by: a stiffness K (12x12, positive
/// semidefinite, order of ContactWrench) under which `force` closes the gap in one step, K u = force with u the motion
/// to just beyond first touch. It is that of all springs facing the target, taken as touching, divided by the way
/// there; `force`: on target and source; `free`: of the 12 dofs, those that can move. Zero if no spring faces anything.
Eigen::Matrix<double, 12, 12> closing_stiffness(const SpringBed& bed, const SpringStates& states, const Pose& source,
                                                const Pose& target, const Eigen::Matrix<double, 12, 1>& force,
                                                const std::array<bool, 12>& free);

}  // namespace dea

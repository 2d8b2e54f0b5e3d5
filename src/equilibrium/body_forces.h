// src/equilibrium/body_forces.h – forces between points of bodies: ligaments, cables, loads; with their
// derivatives (E1, E7).
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

#include "src/equilibrium/load_case.h"
#include "src/joint/joint.h"
#include "src/springs/springs.h"

namespace dea {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// A matrix over 6 dofs per body as a sum of 6x6 blocks; a place may occur more than once. It stays as sparse as the
/// bodies' neighbourhood.
struct BlockMatrix {
  struct Block {
    int row = 0, column = 0;  ///< bodies
    Matrix6 value = Matrix6::Zero();
  };
  std::vector<Block> blocks;
  /// Adds value(0..5, 0..5) at (row, row), and so on: `value` over the dofs of two bodies.
  void add(int a, int b, const Matrix12& value);
  /// The same with rows over the dofs of bodies a, b, and columns over those of c, d.
  void add(int a, int b, int c, int d, const Matrix12& value);
  void add(int a, const Matrix6& value) { blocks.push_back({a, a, value}); }
  Eigen::MatrixXd dense(int bodies) const;
};

/// Forces on bodies, and how they change with small motions (translation of the centre of mass, rotation) of the
/// bodies.
struct BodyForces {
  Eigen::VectorXd value;   ///< 6 per body: force, moment about the current centre of mass; global frame
  BlockMatrix derivative;  ///< of `value`
  explicit BodyForces(std::size_t bodies) : value(Eigen::VectorXd::Zero(6 * static_cast<Eigen::Index>(bodies))) {}
};

/// Tension of a ligament at length L (distance of its points), and dT/dL. `scale`: LoadCase::ligament_scale.
/// A curve that jumps has the slope of its nearer side; one with a kink the mean of both.
Tension tension(const Ligament& ligament, double length, double scale);

/// The fault of the first ligament whose force has no finite value at these poses, with its place and what to do;
/// empty: none. Only expressions can have one.
std::string undefined_force(const Joint& joint, const LoadCase& load_case, const std::vector<Pose>& poses);

/// Adds the pull of a ligament on both of its bodies (E7); returns its tension.
double add_ligament(const Joint& joint, const Ligament& ligament, double scale, const std::vector<Pose>& poses,
                    BodyForces& forces);

/// Adds a tension along the line between points of two bodies (E7); arms are from their centres of mass, global frame.
void add_line(int body_a, const Vector3d& arm_a, int body_b, const Vector3d& arm_b, const Tension& tension,
              const std::vector<Pose>& poses, BodyForces& forces);

/// Adds a force on a point of body a, and its opposite on one of body b, whose direction turns with body `turns`, a or
/// b.
void add_turning_force(int body_a, const Vector3d& arm_a, int body_b, const Vector3d& arm_b, const Vector3d& force,
                       int turns, BodyForces& forces);

/// Adds the pulls of a cable's segments on its points, and of what lies beyond the last one.
void add_cable(const Joint& joint, const Cable& cable, double force, const std::vector<Pose>& poses,
               BodyForces& forces);

/// Adds the given loads on one body: dead and follower force (at the arm), moments, forces at points.
/// Returns the scale of the force: norms of its parts, moments by `length`.
double add_loads(const BodyConditions& conditions, int body, const Pose& pose, double length, BodyForces& forces);

}  // namespace dea

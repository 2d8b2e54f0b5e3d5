// src/springs/layer_inside.h – stress and strain inside a pressed layer, at any place and depth.
// docs/layer_law.md, section 8.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "src/springs/depth_law.h"
#include "src/springs/layer_operator.h"

namespace dea {

/// A place in a layer: below a point of the layer's mesh, along the articular normal.
struct InsidePlace {
  int triangle = -1;                ///< of LayerMesh::mesh
  Barycentric weights = {1, 0, 0};  ///< in that triangle
  double height = 0.0;              ///< zeta: above the bone, over the thickness; 0 the bone, 1 the articular surface
};
/// The same point of a layer's face as one of its mesh. `triangle`, `weights`: of LayerFace::mesh.
InsidePlace inside_place(const LayerMesh& mesh, int triangle, const Barycentric& weights, double height);

/// The state at a place. Frame: the layer's reference configuration; a surface at the place's height between bone and
/// articular surface has the normal `normal`.
struct InsideState {
  Vector3d normal = Vector3d::Zero();                ///< unit, out of the bone
  double pressure = 0.0;                             ///< on that surface [MPa]: minus the normal stress
  Vector3d shear = Vector3d::Zero();                 ///< tau [MPa]: stress * normal, along the surface
  Eigen::Matrix3d stress = Eigen::Matrix3d::Zero();  ///< Cauchy [MPa]
  Eigen::Matrix3d strain = Eigen::Matrix3d::Zero();  ///< Lagrange, (F^T F - 1)/2; at small strain the linear one
};

/// Numbers that do not depend on axes.
struct InsideMeasures {
  double max_shear = 0.0;     ///< half the difference of the greatest and the least principal stress [MPa]
  double first_strain = 0.0;  ///< greatest principal strain
  double third_strain = 0.0;  ///< least principal strain
};
InsideMeasures measures(const InsideState& state);

/// What strain means. Large: the state that has the normal stress, shear and in-plane stretch of (N4) in FEBio's
/// neo-Hookean solid; at the bone, where nothing stretches in its plane, that is exact for any strain.
enum class StrainMeasure { Large, Small };

/// What does not depend on the pressure.
struct InsideShape {
  /// Per vertex v the vertices around it, v among them, and what a unit at each of them adds to the gradient at v,
  /// along the surface [1/mm]: the gradients of the triangles around, on the line through them that fits best, at the
  /// vertex. Exact for quadratic functions on a plane.
  std::vector<int> begin, vertex;
  std::vector<Vector3d> slope;
  std::vector<std::array<Vector3d, 2>> walls;  ///< per vertex: unit normals of planes of symmetry there; zero: none
  std::vector<Vector3d> rise;                  ///< per vertex: gradient of the thickness along the surface
  std::vector<Eigen::Matrix3d> curvature;      ///< per vertex: of the normal [1/mm], > 0 convex; smoothed over 0.4 t
};
InsideShape inside_shape(const LayerOperator& layer);

/// A layer under a pressure, ready to be looked into.
struct InsideLayer {
  const LayerOperator* layer = nullptr;  ///< not owned
  const InsideShape* shape = nullptr;    ///< not owned
  const DepthLaws* laws = nullptr;       ///< not owned; of the layer's nu
  Nodal value;                           ///< vertices x (2 + kDepthPowers): p and its fractions (N3) [MPa]
  Nodal gradient;  ///< vertices x 3 (1 + kDepthPowers): of each fraction, along the surface [MPa/mm]
  Nodal spread;    ///< vertices x 6 (1 + kDepthPowers): xx yy zz xy yz zx of sym grad(t^2 grad q) [MPa]
};
/// Seven sparse solutions with the factors that are there, once per state. The law must have
/// two terms. `pressure`: per foot, >= 0.
InsideLayer look_inside(const LayerOperator& layer, const InsideShape& shape, const DepthLaws& laws,
                        const LayerFeet& feet, const Eigen::VectorXd& pressure);

/// With t and n the layer's thickness and normal, K the gradient of n, z = 1 - zeta, X = z t (K + tr K/2),
///     sigma_n = -(1 + z t tr K 2 mu/M) normal p                                                                (N4)
///     tau     = -(1 - X + X^2/6)^-1 t grad(shear p) - z (2 mu/M) sigma_n grad t
///     eps     = -B sym grad(t^2 grad(spread p)) B/(mu (1 - c t tr K/2)) - (t/mu) (sinking p) K    in the surface,
///     B = (1 - c t K)^-1,   c = 2/3 (1 + z + z^2)/(1 + z)
/// on the surface with the normal n + z grad t. The terms with K and grad t are of first order; t K counts as 0.5 at
/// most.
InsideState state_inside(const InsideLayer& inside, const InsidePlace& place, StrainMeasure measure);

/// At all vertices of the layer's mesh, at one height.
std::vector<InsideState> states_at_height(const InsideLayer& inside, double height, StrainMeasure measure);

}  // namespace dea

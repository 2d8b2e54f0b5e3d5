// src/layer_operator.h – compliance of a bonded elastic layer on a triangulated surface: from pressures on the feet to
// how far the surface sinks there, with the sideways flow that a bed of springs lacks (L3).
#pragma once
#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "layer_face.h"
#include "layer_kernel.h"

namespace dea {

/// An edge with a triangle on one side only.
struct RimEdge {
  int a = -1, b = -1;  ///< its vertices
  int triangle = -1;
  double length = 0.0;
};

/// What both layers of a contact share: the source's triangles, and the feet (foot triangles of springs) on them.
/// Frame: the source's reference configuration; nothing changes with the pose.
struct LayerMesh {
  int nodes = 0;  ///< vertices of the surface
  std::vector<Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;   ///< per triangle: its vertices
  std::vector<std::array<double, 6>> slopes;   ///< per triangle: grad N_i . grad N_j for ij = 00 11 22 01 12 20 [mm^-2]
  std::vector<std::array<int, 3>> neighbours;  ///< per triangle: across edge (k, k + 1); -1: rim
  std::vector<RimEdge> rim;                    ///< sorted by triangle
  std::vector<int> foot_triangle;              ///< per foot: triangle it lies in; feet fill every triangle
  std::vector<std::vector<int>> triangle_feet;                ///< per triangle
  std::vector<std::array<std::array<double, 3>, 3>> corners;  ///< per foot: barycentric coordinates of its corners
  std::vector<std::array<double, 3>> centroid;                ///< per foot: of its centroid, a row of G
  std::vector<double> area;                                   ///< per foot [mm^2], > 0
  int feet() const { return static_cast<int>(area.size()); }
};

/// One foot per triangle.
LayerMesh make_layer_mesh(const SurfaceMesh& surface);
/// Feet that divide the triangles: for each its triangle and the barycentric coordinates of its corners there
/// (Springs::surface_triangle, Springs::weights).
LayerMesh make_layer_mesh(const SurfaceMesh& surface, const std::vector<int>& foot_triangle,
                          const std::vector<std::array<std::array<double, 3>, 3>>& corners);

/// The compliance of one layer, as an operator. With pressures p and thicknesses t per foot, q per vertex,
///     S_k q_k = G^T D p,  S_1 r = M_t q_1,     S_k = M_t + beta_k K_t3
///     w_i = t_i ((local + edge_i) p_i + (G (weight_0 q_0 + weight_1 q_1 + square r))_i)                           (L3)
/// D = diag(A_i t_i); edge_i: (L7); M_t and K_t3: mass and stiffness matrices of linear triangles, weighted by t and
/// t^3, t constant on each foot. Symmetric in the sense of work, A_i dw_i/dp_j = A_j dw_j/dp_i, and positive definite
/// for any thickness field, because G^T D G <= M_t and the law is positive. Where no q is held and every rim edge is a
/// Wall, M sum A_i w_i = sum A_i t_i p_i to rounding: bulging moves volume but makes none.
///
/// A foot of no thickness has no layer: it does not sink, and q = 0 at the vertices around it in the first term; the
/// second takes the step for a wall, so a mesh should end where its cartilage does.
/// Serial; different operators may be used at the same time, one operator may not.
class LayerOperator {
 public:
  /// `rim`: one per edge of mesh.rim. The sparsity pattern is analysed here, once.
  LayerOperator(std::shared_ptr<const LayerMesh> mesh, const LayerLaw& law, std::vector<Rim> rim);
  ~LayerOperator();
  LayerOperator(LayerOperator&&) noexcept;
  LayerOperator& operator=(LayerOperator&&) noexcept;

  /// Assembles and factorises for these thicknesses, per foot, >= 0 [mm]: once for the source, once per pose for the
  /// target, whose thickness is the one at the springs' ends.
  void set_thickness(const std::vector<double>& thickness);

  /// Compliance of each foot for itself, t_i (local + edge_i) [mm/MPa]: what is left for short waves.
  const std::vector<double>& own() const;

  const LayerMesh& mesh() const;
  const LayerLaw& law() const;
  const std::vector<double>& thickness() const;

  /// Adds w [mm] to `sinking` for pressures [MPa], both feet x columns. `area`: the part of each foot that carries its
  /// pressure [mm^2], 0 <= area <= mesh().area; work is then measured with it, too.
  void add_sinking(const Eigen::MatrixXd& pressure, const Eigen::VectorXd& area, Eigen::MatrixXd& sinking);
  /// w for one field of pressures on whole feet.
  Eigen::VectorXd sinking(const Eigen::VectorXd& pressure);

  /// Entries of the sparse factor, for one term: what a solution costs.
  double factor_entries() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace dea

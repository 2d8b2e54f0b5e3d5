// src/springs/layer_operator.h – compliance of a bonded elastic layer on its own mesh: from pressures on the feet
// of springs to how far the surface sinks under them, with the sideways flow that a bed of springs lacks (L3, L8).
#pragma once
#include <Eigen/Core>
#include <array>
#include <vector>

#include "src/geometry/foot_parts.h"
#include "src/joint/layer_face.h"
#include "src/springs/layer_kernel.h"
#include "src/springs/sparse_factor.h"

namespace dea {

/// The mesh of a layer's flow: its face, divided. Frame: the layer's reference configuration; nothing depends on poses
/// or on who presses.
struct LayerMesh {
  struct Edge {
    int a = -1, b = -1;  ///< its vertices
    int triangle = -1;
    double length = 0.0;
    Rim rim = Rim::Free;
    double wall = 0.5 * kPi;  ///< as LayerFace::Edge has it
  };
  int divide = 1;    ///< triangle t of the face is here the triangles t divide^2 + part (triangle_parts)
  int pressed = 0;   ///< the first triangles: those of the contact surface; the others carry no pressure
  SurfaceMesh mesh;  ///< vertices, triangles, areas, neighbours
  /// Per vertex: what the flow sees of the thickness [mm], >= 0, linear in each triangle. A step of the bone is felt at
  /// the surface smeared over the thickness:  (M_1 + beta_1 K_t2) thickness = M_1 t.                             (L10)
  std::vector<double> thickness;
  std::vector<std::vector<int>> beside;  ///< per vertex: the vertices it shares an edge with
  std::vector<Edge> edges;               ///< of one triangle alone, sorted by triangle
  std::vector<double> edge_distance;     ///< per vertex: from the nearest free edge [mm]; at most kEdgeReach largest t
  std::vector<double> edge_curvature;  ///< per vertex of a free edge: in the surface [1/mm], > 0 convex (a disc's rim)
  /// The place on the free edges that is nearest to a vertex.
  struct NearestEdge {
    int edge = -1;       ///< -1: none within reach
    double along = 0.0;  ///< 0 to 1, from its a to its b
  };
  std::vector<NearestEdge> nearest_edge;  ///< per vertex
  std::vector<Vector3d> outward;          ///< per vertex: from the rim there, in the surface; unit at the edges' ends
  std::vector<double> wall_slope;         ///< per vertex: of the wall there (EdgeLaw, leaning); 0: none within reach
  int nodes() const { return static_cast<int>(mesh.vertices.size()); }
};
inline constexpr double kEdgeReach = 3.0;
/// Vertices come in an order that leaves matrices' factors sparse.
LayerMesh make_layer_mesh(const LayerFace& face, int divide = 1);

/// On what of a layer the feet stand. Per foot i, over its parts k:
///     a_ik = area,   b_ik = integral of t N,   d_i = sum over k of the integral of t                            (L8)
struct LayerFeet {
  std::vector<int> begin = {0};  ///< per foot: its range of `node`, `weight`
  std::vector<int> node;         ///< vertices of the layer's mesh
  std::vector<double> weight;    ///< b [mm^3]
  std::vector<double> area;      ///< A_i: sum of a_ik [mm^2]; 0: the foot stands on nothing and carries nothing
  std::vector<double> volume;    ///< d [mm^3]
  std::vector<double> own;  ///< compliance of the foot for itself: integral of t (local + edge's own), over A [mm/MPa]
  /// Of both factors: those that feet on the layer have to do with (set_reach); without held edges in the first.
  std::vector<int> columns[2];
  int size() const { return static_cast<int>(area.size()); }
  double thickness(int i) const {  ///< mean under the foot
    const auto k = static_cast<std::size_t>(i);
    return area[k] > 0 ? volume[k] / area[k] : 0.0;
  }
};

/// What leads the search for pressures (near_inverse.h).
struct NearLaw {
  double mass, stiffness, two;
};
inline constexpr NearLaw kNear = {0.15, 0.0105, 0.82};

/// The compliance of one layer, as an operator. For pressures p per foot, with q, r nodal and linear in each triangle,
///     S_k q_k = b p,   S_1 r = (square M_t + around B) q_1,   S_k = M_t + beta_k K_t3
///     A_i w_i = A_i own_i p_i + b_i . (weight_0 q_0 + weight_1 q_1 + r + z)                                  (L3),
///     (L8)
/// M_t and K_t3: mass and stiffness matrices weighted by t and t^3, both exact for t linear in each triangle; B: the
/// integral of t^2 along free edges. Symmetric in the sense of work, A_i dw_i/dp_j = A_j dw_j/dp_i, and positive
/// definite for any thickness field while parts of different feet do not overlap. Between walls, with whole triangles
/// pressed, M sum A_i w_i = sum d_i p_i to rounding: bulging moves volume but makes none.
///
/// At a free edge q_0 = 0, and what flows out there stretches the edge along itself (L7): per vertex v of the edge,
/// with rho the volume that flows out, row v of b p - S_0 q_0 as if v were not held, and B_v its share of B,
///     z_v = e rho_v / (beta_0 B_v),   S_0 z = 0 elsewhere,   e = straight + curved min(kappa t, 1)
/// In a hole, where e < 0, v is not held if weight_0 < 0: S_0 has beta_0 B_v / min(e/weight_0, 5) on its diagonal
/// there.
///
/// Large strain: only the confined part of the response stiffens, in series with the linear flow,
///     w = C p - B^T [t e(q)],   q = B p,   (B p)_i = own_share p_i + (1 - own_share) (b_i . q_1) / d_i (L9)
/// B^T: the adjoint of B in the sense of work. own_share (LayerLaw): 1/3; 0 for nu < 0; with one term 1, so B = 1.
///
/// Where the layer has no thickness it does not sink, and q = 0 at the vertices around in the first term.
/// A plain value, never changed once made: safe to use side by side.
struct LayerOperator {
  LayerMesh mesh;
  Elasticity elasticity;
  LayerLaw law;
  std::vector<double> edge_own;  ///< per vertex: EdgeLaw::own of the nearest free edge; empty: there is none

  SymmetricPattern pattern;
  std::array<SparseFactor, 2> factor;     ///< of S_0, S_1
  std::array<std::vector<char>, 2> held;  ///< per term and vertex: q = 0
  std::vector<double> onwards;            ///< what of q_1 drives r: square M_t and the edges' parts
  std::vector<double> mass;               ///< M_t
  /// Of N (L12), with a foot on each triangle; two terms alone.
  SparseFactor near;
  std::vector<double> beyond;  ///< sqrt(beta_1) B of the edges where the layer goes on (`fractions`)
  /// A vertex of a free edge.
  struct EdgeVertex {
    int node = -1;
    double share = 0.0;    ///< B_v
    double gained = 0.0;   ///< what the diagonal of S_0 gains where q_0 is not held
    double stretch = 0.0;  ///< where it is: z per rho, e / (beta_0 B), by what flows out (L7)
  };
  std::vector<EdgeVertex> edge_vertices;
  /// Per vertex: of these, with q_0 = 0. The factor of S_0 eliminates them last, as if they were not.
  std::vector<char> edge_held;
  EdgeLaw edge;  ///< of a vertical wall
};
LayerOperator make_layer_operator(LayerMesh mesh, const Elasticity& elasticity, LayerFit fit);

/// b p [N mm], for pressures p, feet x columns.
Nodal loads(const LayerOperator& layer, const LayerFeet& feet, const Eigen::MatrixXd& p);
/// b_i . q of one foot, for column c.
double gathered(const LayerFeet& feet, int i, const Nodal& q, Eigen::Index c);
/// The solution for a load at these columns, 0 where it is held.
Nodal solved(const SparseFactor& factor, const std::vector<char>& held, const std::vector<int>& columns, Nodal load);

/// w [mm] for pressures [MPa], both feet x columns. `softening`: per foot, the slope of e(q) at the state about which
/// (L9) is linear; null: small strain.
Eigen::MatrixXd sinking(const LayerOperator& layer, const LayerFeet& feet, const Eigen::MatrixXd& pressure,
                        const Eigen::VectorXd* softening = nullptr);
/// w by (L9). `softening`: set to the slopes of e(q).
Eigen::VectorXd large_sinking(const LayerOperator& layer, const LayerFeet& feet, const Eigen::VectorXd& pressure,
                              Eigen::VectorXd& softening);
/// Of w per pressure of the same foot, what flow has no part in [mm/MPa].
double own_compliance(const LayerOperator& layer, const LayerFeet& feet, int foot,
                      const Eigen::VectorXd* softening = nullptr);

/// What drives free edges outwards: r = rho_v / B_v at their vertices, 0 at all others [MPa]. Where q_0 is not held: as
/// if it were, which at a straight edge adds sqrt(beta_0) q_0.                                                  (L11)
std::vector<double> edge_flow(const LayerOperator& layer, const LayerFeet& feet, const Eigen::VectorXd& pressure);
/// How far a free edge moves outwards at one of its vertices, under the pressure p there [mm], < 0: inwards.
///     u = t (driven r + squeezed p)                                                                            (L11)
double edge_move(const LayerOperator& layer, int vertex, const std::vector<double>& flow, double pressure);

/// Fractions of a pressure p [MPa, per foot] at all vertices of the layer's mesh, with or without a foot [MPa]:
///     column 0: p itself, the mean around the vertex;  1: q_0;  1 + k: q_k, k = 1 .. powers,
///     S_1 q_k = M_t q_(k-1),  q_1 as in (L3)                                                                   (N3)
/// q_k is 1/(1 + beta_1 s^2)^k of p. The law must have two terms.
Eigen::MatrixXd fractions(const LayerOperator& layer, const LayerFeet& feet, const Eigen::VectorXd& pressure,
                          int powers);

/// Adds a foot on these parts, whose areas are scaled to sum up to `area`; none, or no area: a foot that stands on
/// nothing.
void add_foot(LayerFeet& feet, const LayerOperator& layer, const std::vector<SurfacePart>& parts, double area);
/// Feet one by one behind the others.
void append(LayerFeet& feet, const LayerFeet& more);
/// Finds the parts of the factors that feet with an area have to do with. Of the second term's pressure, which decays
/// like exp(-d/(0.4 t)), what lies further than 3 times the greatest thickness from all of them is left out. To be
/// called once all feet are there.
void set_reach(LayerFeet& feet, const LayerOperator& layer);
/// One foot on each pressed triangle, with its reach.
LayerFeet feet_of_own_triangles(const LayerOperator& layer);

}  // namespace dea

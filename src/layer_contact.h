// src/layer_contact.h – which feet touch and how hard, when both layers give way like elastic layers (L4).
#pragma once
#include <Eigen/Core>
#include <vector>

#include "layer_operator.h"
#include "spring_law.h"

namespace dea {

/// One or two layers on the feet of the same mesh, pressed together.
struct LayerContact {
  LayerOperator* source = nullptr;    ///< not owned; null: a rigid side, which does not give way
  LayerOperator* target = nullptr;    ///< on the source's mesh, with the thickness at the springs' ends
  Eigen::VectorXd area;               ///< per foot: the part that lies over the target [mm^2]; 0: takes no part
  double interface_compliance = 0.0;  ///< gap per P of what lies between the surfaces (S9)
  /// Per foot: linear pressure of this layer over the common one (L6); empty: 1.
  Eigen::VectorXd source_share, target_share;
};

/// w_s + w_t [mm] for common linear pressures [MPa], both feet x columns. The two layers may be computed at the same
/// time, each by itself: the result does not depend on the number of threads.
Eigen::MatrixXd sinking(const LayerContact& contact, const Eigen::MatrixXd& pressure);
/// Compliance of each foot for itself, the sum of t local over the layers [mm/MPa]: what is left for short waves.
Eigen::VectorXd local_compliance(const LayerContact& contact);

/// The part of w that forces [N] on the feet bring about by what flows sideways, without what each foot gives way for
/// itself; both feet x columns. Linear in the force, whatever area carries it.
Eigen::MatrixXd spread(const LayerContact& contact, const Eigen::MatrixXd& force);

struct LayerContactOptions {
  double tolerance = 1e-9;      ///< of `residual`: far below any mesh's error, so that a solver above sees a function
  int max_applications = 1000;  ///< of the compliance; a stop
};

struct LayerPressure {
  Eigen::VectorXd pressure;  ///< per foot: linear pressure P >= 0 [MPa]
  std::vector<char> active;  ///< per foot: touches (P > 0)
  double residual = 0.0;     ///< max |min(P_i, (w_i - overlap_i) / local_i)| over max P
  bool converged = false;
  int applications = 0;  ///< of the compliance: each costs a sparse solution per layer and term
};

/// P >= 0,  w(P) >= overlap,  P (w - overlap) = 0.                                                               (L4)
/// `overlap`: per foot, signed [mm]: minus the gap where apart, for what bulges may come to touch. `start`: pressures
/// to start from, or empty. Conjugate gradients on the feet that touch, with projections where some come to touch or
/// let go: MPRGP of Dostal and Schoeberl (2005), scaled by the local compliance; converges from any start.
LayerPressure solve_contact(const LayerContact& contact, const Eigen::VectorXd& overlap,
                            const Eigen::VectorXd& start = {}, const LayerContactOptions& options = {});

/// Derivative of (L4) with the active set held: rates of P for rates of the overlap, both feet x columns (one per
/// motion). Rows of feet that are not active are ignored and come back zero. `tolerance`: per column, relative.
/// `start`: rates to start from, or empty.
struct ActiveRates {
  Eigen::MatrixXd pressure;
  bool converged = false;
  int applications = 0;
};
ActiveRates solve_active(const LayerContact& contact, const std::vector<char>& active,
                         const Eigen::MatrixXd& overlap_rates, double tolerance = 1e-9,
                         const Eigen::MatrixXd& start = {});

/// Large strain. Each foot answers like a spring (spring_law.h) that is given the overlap
///     Delta* = P (t_s/M_s + t_t/M_t)                                                                            (L5)
/// p, e_s, e_t follow from it; long waves then give S6, small strains the linear law. With layers of different moduli
/// the strains share Delta* otherwise than in the linear law, and each layer sinks under its own linear pressure:
///     w = sum over layers l of sqrt(f_l) C_l sqrt(f_l) P,     f_l = M_l e_l / P                                 (L6)
/// symmetric, and exact for long waves; f = 1 for equal moduli and small strains. f is found by repetition.
struct LayerSprings {
  LayerPressure linear;                 ///< P; applications are the sum
  std::vector<SpringResponse> springs;  ///< per foot, at Delta*
  Eigen::VectorXd spring_overlap;       ///< Delta* [mm]
  int repetitions = 0;
};
/// `contact`: its shares are set to those of the result.
LayerSprings solve_layer_springs(LayerContact& contact, Law law, const Elasticity& source, const Elasticity& target,
                                 const Eigen::VectorXd& overlap, const Eigen::VectorXd& start = {},
                                 const LayerContactOptions& options = {});

}  // namespace dea

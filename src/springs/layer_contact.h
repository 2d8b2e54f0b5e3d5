// src/springs/layer_contact.h – which feet touch and how hard, when both layers give way like elastic layers (L4).
#pragma once
#include <Eigen/Core>
#include <vector>

#include "src/base/stop.h"
#include "src/springs/layer_operator.h"
#include "src/springs/part_operator.h"

namespace dea {

/// A layer and what of it each foot stands on: nothing of it where the foot presses other layers.
struct PressedLayer {
  const LayerOperator* layer = nullptr;  ///< not owned
  const LayerFeet* feet = nullptr;
  Eigen::VectorXd softening;  ///< per foot: slopes of e(q) about which the contact is linear (L9); empty: small strain
};

/// A part and what of it each foot presses.
struct PartUnderFeet {
  const PartOperator* part = nullptr;  ///< not owned
  const PartFeet* feet = nullptr;
};

/// Two feet side by side whose pressures differ little: of a part without a layer opposite, whose triangles are more
/// than its nodes can move by themselves. w_i gains compliance/A_i times p_i - p_j, and w_j the opposite.         (P4)
struct FootPair {
  int i = -1, j = -1;
  double compliance = 0.0;  ///< [mm^3/MPa]
};

/// Layers pressed together on the same feet: two, or one against a bare rigid surface; where contacts share layers, all
/// of these under the feet of all of them.
struct LayerContact {
  std::vector<PressedLayer> layers;  ///< each once
  std::vector<PartUnderFeet> parts;  ///< each once
  std::vector<FootPair> pairs;
  Eigen::VectorXd area;               ///< per foot: what carries its pressure [mm^2]; 0: takes no part
  Eigen::VectorXd own;                ///< per foot: stated compliance of its own [mm/MPa]; empty: none
  std::vector<char> two_sided;        ///< per foot: may pull and push; empty: none
  double interface_compliance = 0.0;  ///< gap per pressure of what lies between the surfaces (S9)
};

/// Sum of w over the layers and parts [mm] for pressures [MPa], both feet x columns, linear about the softenings. The
/// layers may be computed at the same time, each by itself: the result does not depend on the number of threads.
Eigen::MatrixXd sinking(const LayerContact& contact, const Eigen::MatrixXd& pressure);
/// Compliance of each foot for itself at small strain, the sum over the layers [mm/MPa]: what is left for short waves.
Eigen::VectorXd local_compliance(const LayerContact& contact);

/// The part of w that forces [N] on the feet bring about by what flows sideways, without what each foot gives way for
/// itself; both feet x columns. Linear in the force, whatever area carries it.
Eigen::MatrixXd spread(const LayerContact& contact, const Eigen::MatrixXd& force);

struct LayerContactOptions {
  double tolerance = 1e-9;      ///< of `residual`: far below any mesh's error, so that a solver above sees a function
  int max_applications = 2000;  ///< of the compliance; a stop
  bool large_strain = true;     ///< (L9); else w = C p
  const StopFlag* stop = nullptr;  ///< not owned; looked at before each application: Stopped
  double part_of_first = 0.0;      ///< also enough: this part of `first_residual`
};

struct LayerPressure {
  Eigen::VectorXd pressure;           ///< per foot, >= 0 [MPa]
  std::vector<Eigen::VectorXd> sunk;  ///< per layer: w of its feet [mm]
  std::vector<char> active;           ///< per foot: touches (p > 0)
  Eigen::VectorXd apart;              ///< per foot: (w - overlap) / local, by which one is apart that does not [MPa]
  double residual = 0.0;              ///< max |min(p_i, (w_i - overlap_i) / local_i)| over max p
  double first_residual = 0.0;        ///< that of the pressures it started from
  bool converged = false;
  int applications = 0;  ///< of the compliance: each costs a sparse solution per layer and matrix
};

/// p >= 0,  w(p) >= overlap,  p (w - overlap) = 0.                                                               (L4)
/// `overlap`: per foot, signed [mm]: minus the gap where apart, for what bulges may come to touch. `start`: pressures
/// to start from, or empty. Newton's method on the convex energy of (L9), each step a quadratic problem with bounds
/// that projected conjugate gradients solve, scaled by the local compliance and led by near_inverse.h. `contact`: its
/// softenings are set to those of the result.
LayerPressure solve_contact(LayerContact& contact, const Eigen::VectorXd& overlap, const Eigen::VectorXd& start = {},
                            const LayerContactOptions& options = {});

/// Derivative of (L4) with the active set held: rates of p for rates of the overlap, both feet x columns (one per
/// motion), about the contact's softenings. Rows of feet that are not active are ignored and come back zero.
/// `tolerance`: per column, relative. `start`: rates from which those to start from are mixed, or empty. From a start
/// what the rates do along the overlap rates, a stiffness, is wrong by the square of the tolerance alone, for the
/// residual has nothing along what is in them. `stop`: as in LayerContactOptions.
struct ActiveRates {
  Eigen::MatrixXd pressure;
  bool converged = false;
  int applications = 0;
};
ActiveRates solve_active(const LayerContact& contact, const std::vector<char>& active,
                         const Eigen::MatrixXd& overlap_rates, double tolerance = 1e-9,
                         const Eigen::MatrixXd& start = {}, const StopFlag* stop = nullptr);

}  // namespace dea

// src/equilibrium/flat_directions.h – motions that nothing but the roughness of the facets resists, and Newton's
// step over the others.
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <optional>
#include <vector>

#include "src/base/numbers.h"
#include "src/equilibrium/forces.h"

namespace dea {

/// Up to this many unknowns a stiffness is decomposed densely: about ten bodies; measured, above it the sparse way is
/// the faster one.
inline constexpr int kDenseUnknowns = 60;

/// The stiffness split: stiff directions to be solved, flat ones that nothing resists. Vectors over the unknowns
/// (unknowns.h).
struct Directions {
  Eigen::VectorXd newton;             ///< step over the stiff directions
  Eigen::VectorXd drift;              ///< residual along the flat directions that are loaded, and those that fall
  bool falls = false;                 ///< of negative stiffness, where the load is followed along them
  Eigen::VectorXd residual;           ///< residual without the flat directions that are held
  std::vector<Eigen::VectorXd> held;  ///< flat, and their residual about zero
  /// Orthonormal columns: the components of the residual that are not asked to vanish, one per held direction.
  Eigen::MatrixXd left_unbalanced;
  double least_stiffness = kNaN;
  Eigen::SparseMatrix<double> stiffness;  ///< that was split (scaled_stiffness)
};
/// `r`: the residual. `patience` >= 1 widens what counts as facet noise (E6), so that a direction at its edge does not
/// change sides for ever.
Directions split_stiff_from_flat(const Problem& problem, const Evaluation& e, const Eigen::VectorXd& r,
                                 double patience);

/// The part of the residual along motions that are too soft to balance it within two thicknesses, and the motion that
/// would (scaled, to first order). Nothing where the springs' stiffness answers the most of it.
std::optional<Eigen::VectorXd> soft_motion(const Problem& problem, const Evaluation& e, const Eigen::VectorXd& r);

}  // namespace dea

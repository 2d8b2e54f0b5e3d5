// src/equilibrium/facet_noise.h – how much of what a motion feels is only the roughness of the facets (E6).
#pragma once
#include <Eigen/Core>
#include <vector>

#include "src/equilibrium/forces.h"

namespace dea {

/// How much of the stiffness and of the force that a direction of motion feels is only the roughness of the facets:
/// with the normals in use against normals averaged at the vertices (E6).
struct FacetNoise {
  double stiffness = 0.0;
  double force = 0.0;
};
/// `direction`: a motion of the unknowns (unknowns.h).
FacetNoise facet_noise(const Problem& problem, const Evaluation& e, const Eigen::VectorXd& direction);

/// FacetNoise::stiffness from above for any direction, by one pass over the springs: |ab| <= (a^2 + b^2)/2 makes the
/// products of (E6) a quadratic form.
struct NoiseBound {
  std::vector<Matrix12> products, crossed;  ///< per contact: target, source

  NoiseBound(const Problem& problem, const Evaluation& e);
  double operator()(const Problem& problem, const Evaluation& e, const Eigen::VectorXd& direction) const;
};

}  // namespace dea

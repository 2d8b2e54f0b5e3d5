// src/springs/near_inverse.h – nearly the inverse of what springs that share layers make of pressures: with it the
// search for pressures takes half of the steps (docs/layer_law.md, section 4).
#pragma once
#include <vector>

#include "src/springs/layer_operator.h"

namespace dea {

/// A wave of pressure sinks B(s) times as far as the local compliance makes it. For two terms and every nu
///     B / (B - 1) = 1 + kNear.mass + kNear.stiffness s^2                                                     (L12)
/// to some percent for s > 1. So by Woodbury's identity, on the feet of one layer,
///     B^-1 = 1 - D^-1/2 b^T N^-1 b D^-1/2,   N = sum of b_i b_i^T / d_i + kNear.mass M_t + kNear.stiffness K_t3
/// nearly: one sparse solution. Of two layers each takes its share of the local compliance, and kNear.two of it: a wave
/// that the mesh of one hides from its feet is not hidden from the other's.
///
/// Adds to `inverse` what the layer takes from B^-1 = 1, times g, feet x columns, for the feet that are `asked` for: of
/// all others neither counts. `weight`: of the inner product in which B is symmetric, area times local compliance of
/// all layers; so is this, and 1 with it positive. How close it comes to the inverse changes no answer, only how soon
/// it is found. One term: nothing.
void add_near_inverse(const LayerOperator& layer, const LayerFeet& feet, const Eigen::VectorXd& weight,
                      const std::vector<char>& asked, const Eigen::MatrixXd& g, Eigen::MatrixXd& inverse);

}  // namespace dea

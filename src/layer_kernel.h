// src/layer_kernel.h – how the surface of a bonded elastic layer gives way to a wave of pressure: exactly, and as a
// rational law that a sparse matrix can follow. docs/layer_law.md derives both.
#pragma once
#include <array>

#include "spring_law.h"

namespace dea {

/// Exact response of a flat layer of thickness t, bonded to a rigid base, to a frictionless pressure p cos(kappa x) on
/// its surface: the surface sinks by w cos(kappa x) with, s = kappa t,
///     w/p = t (2 (1-nu^2) / (E s)) ((3-4nu) sinh 2s - 2s) / ((3-4nu) cosh 2s + 2s^2 + 5 - 12nu + 8nu^2)         (L1)
/// Returns w / (p t) [1/MPa]: 1/M at s = 0, 2 (1-nu^2)/(E s) for s -> infinity. Finite and accurate to rounding for
/// every s >= 0 and 0 <= nu <= 0.5.
double layer_compliance(const Elasticity& layer, double s);

/// Rational law in partial fractions that stands for (L1): LayerFit::OneTerm (L2), the first terms of the series in s,
/// one sparse solve; LayerFit::TwoTerms (L2b), which follows (L1) to short waves, two sparse solves;
///     w / (p t) = local + sum over k of weight_k / (1 + beta_k s^2),     local + sum of weight_k = 1/M          (L2)
/// OneTerm: (1 + alpha s^2) / (M (1 + beta s^2)), so local = alpha/(beta M) and weight_0 = -(alpha/beta - 1)/M, with
///     alpha - beta = nu (4nu-1) / (3 (1-nu)(1-2nu))                                         the first term of (L1)
///     nu >= 0.3:  beta = [1 - (3-4nu)(4nu^2+2nu-1)/(20 nu (4nu-1))] / (1-nu)                the second (Pade)
///     nu <  0.3:  beta = 1/(1-nu),  hence alpha = (3-4nu)/(3(1-2nu))                        (truncation)
/// TwoTerms (L2b): (1 + a1 s^2 + a2 s^4)/(M (1 + b1 s^2 + b2 s^4)) with the first term of (L1), its values at s = 0.9
/// and 3, and half its value at s = 12 for s -> infinity. Below nu = 0.3 its poles need not be real; there the law is
/// one fraction with the same limits at s = 0 and infinity and the value of (L1) at s = 2.
/// Nothing here grows without bound as nu -> 0.5. Positive for all s, which makes the operator positive definite.
struct LayerLaw {
  double local = 0.0;                     ///< compliance left for short waves [1/MPa], > 0
  int terms = 0;                          ///< 1 or 2
  std::array<double, 2> weight = {0, 0};  ///< [1/MPa], < 0 where bulging makes the layer softer
  std::array<double, 2> beta = {0, 0};    ///< > 0
  double confined = 0.0;                  ///< 1/M [1/MPa], 0 at nu = 0.5
  double operator()(double s) const {
    double w = local;
    for (std::size_t k = 0; k < static_cast<std::size_t>(terms); ++k) w += weight[k] / (1 + beta[k] * s * s);
    return w;
  }
};
LayerLaw layer_law(const Elasticity& layer, LayerFit fit);

}  // namespace dea

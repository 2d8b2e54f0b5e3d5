// src/springs/layer_kernel.h – how the surface of a bonded elastic layer gives way to a wave of pressure: exactly,
// and as a rational law that a sparse matrix can follow. docs/layer_law.md derives both.
#pragma once
#include <array>

#include "src/springs/spring_law.h"

namespace dea {

/// Exact response of a flat layer of thickness t, bonded to a rigid base, to a frictionless pressure p cos(kappa x) on
/// its surface: the surface sinks by w cos(kappa x) with, s = kappa t,
///     w/p = t (2 (1-nu^2) / (E s)) ((3-4nu) sinh 2s - 2s) / ((3-4nu) cosh 2s + 2s^2 + 5 - 12nu + 8nu^2)         (L1)
/// Returns w / (p t) [1/MPa]: 1/M at s = 0, 2 (1-nu^2)/(E s) for s -> infinity. Finite and accurate to rounding for
/// every s >= 0 and 0 <= nu <= 0.5.
double layer_compliance(const Elasticity& layer, double s);

/// Rational law in partial fractions that stands for (L1): LayerFit::OneTerm (L2), the first terms of the series in s,
/// one sparse solution; LayerFit::TwoTerms (L2b), which follows (L1) to short waves, three sparse solutions with two
/// matrices;
///     w / (p t) = local + weight_0/(1 + beta_0 s^2) + weight_1/(1 + beta_1 s^2) + square/(1 + beta_1 s^2)^2       (L2)
/// whose weights add up to 1/M at s = 0.
/// OneTerm: (1 + alpha s^2) / (M (1 + beta s^2)), so local = alpha/(beta M) and weight_0 = -(alpha/beta - 1)/M, with
///     alpha - beta = nu (4nu-1) / (3 (1-nu)(1-2nu))                                         the first term of (L1)
///     nu >= 0.3:  beta = [1 - (3-4nu)(4nu^2+2nu-1)/(20 nu (4nu-1))] / (1-nu)                the second (Pade)
///     nu <  0.3:  beta = 1/(1-nu),  hence alpha = (3-4nu)/(3(1-2nu))                        (truncation)
/// TwoTerms (L2b): beta_0 = 2, beta_1 = 0.155 for every nu; the weights give the first term of (L1) and its values at
/// s = 2 and 9. Within 1.7% of (L1) for s <= 10, 0 <= nu <= 0.5;
/// within 12% for nu < 0.
/// Nothing here grows without bound as nu -> 0.5. Positive for all s, which makes the operator positive definite.
struct LayerLaw {
  double local = 0.0;                     ///< compliance left for short waves [1/MPa], > 0
  int terms = 0;                          ///< 1 or 2
  std::array<double, 2> weight = {0, 0};  ///< [1/MPa], < 0 where bulging makes the layer softer
  double square = 0.0;                    ///< of the second fraction's square [1/MPa]; 0 with one term
  std::array<double, 2> beta = {0, 0};    ///< > 0
  double confined = 0.0;                  ///< 1/M [1/MPa], 0 at nu = 0.5
  double own_share = 1.0;                 ///< of a foot's own pressure in the one that stiffens it (L9)
  double operator()(double s) const {
    double w = local;
    for (std::size_t k = 0; k < static_cast<std::size_t>(terms); ++k) w += weight[k] / (1 + beta[k] * s * s);
    return w + square / ((1 + beta[1] * s * s) * (1 + beta[1] * s * s));
  }
  /// Upper bound of the law for all s.
  double largest() const;
};

/// What a free edge adds (L7), all [1/MPa]; zero with one term. Read off own finite elements of strips, discs and
/// holes, nu = 0.3 to 0.4999, and of strips whose wall leans (docs/layer_law.md, section 3).
struct EdgeLaw {
  double straight = 0.0, curved = 0.0;  ///< the edge's stretch: e = straight + curved min(kappa t, 1)
  double around = 0.0;                  ///< of the second term's pressure at the edge
  double own = 0.0;                     ///< t own exp(-4.5 d/t) of the foot's own pressure, d from the edge
  double goes_on = 0.0;                 ///< `around` where the layer goes on
  double driven = 0.0, squeezed = 0.0;  ///< the edge's way outwards: t (driven r + squeezed p), r: rho per B (L11)
  double unit = 0.0;                    ///< 1/E
};
inline constexpr double kEdgeDecay = 4.5;
/// Of a vertical wall.
EdgeLaw edge_law(const Elasticity& layer, LayerFit fit);
/// Slopes of walls of 120 and 40 degrees.
inline constexpr double kMostUndercut = -0.57735026918962576, kMostBevel = 1.1917535925942099;
/// Of a wall that leans. `slope`: the cotangent of the angle by which the surface turns down into it; > 0: a bevel,
/// < 0: an undercut. Beyond those of 40 and 120 degrees: as there.
EdgeLaw leaning(const EdgeLaw& vertical, double slope);
LayerLaw layer_law(const Elasticity& layer, LayerFit fit);

}  // namespace dea

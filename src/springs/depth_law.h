// src/springs/depth_law.h – what a wave of pressure on a bonded elastic layer does inside it: exactly, and by the
// fractions that the layer law solves for anyway. docs/layer_law.md, section 8, derives both.
#pragma once
#include <array>

namespace dea {

/// A flat layer of thickness t and shear modulus mu, bonded to a rigid base, under the frictionless pressure
/// p cos(kappa x); s = kappa t, zeta the height above the base over t: 0 the bone, 1 the articular surface; z out of
/// the layer's surface. Its state at zeta is
///     sigma_zz = -normal p cos,   sigma_xz = s shear p sin,
///     u_x = (t/mu) s spread p sin,   u_z = -(t/mu) sinking p cos                                              (N1)
/// For any pressure, with each function of s applied to it:
///     sigma_zz = -normal p,   tau = -t grad(shear p),   u = -(t^2/mu) grad(spread p),   u_z = -(t/mu) sinking p
struct DepthResponse {
  double normal = 0.0;   ///< 1 at s = 0
  double shear = 0.0;    ///< (1 - zeta) nu/(1-nu) at s = 0
  double spread = 0.0;   ///< nu/(1-nu) (zeta - zeta^2/2) - mu/M zeta^2/2 at s = 0
  double sinking = 0.0;  ///< zeta mu/M at s = 0
};
/// The classical solution, from four linear equations; -1 < nu <= 0.5, 0 <= zeta <= 1. For s < 0.01 its limit at s = 0.
DepthResponse depth_response(double nu, double s, double zeta);

/// Powers of the second fraction that depth takes.
inline constexpr int kDepthPowers = 6;

/// local + first/(1 + beta_0 s^2) + sum of power[k-1]/(1 + beta_1 s^2)^k, with the poles of LayerLaw's two terms.  (N2)
struct DepthFractions {
  double local = 0.0, first = 0.0;
  std::array<double, kDepthPowers> power = {};
  double operator()(double s) const;
};

/// Fractions that stand for DepthResponse at one depth: the limit at s = 0 is kept; the rest is a least-squares fit for
/// s <= 20, of s shear and of s^2 spread, which are what is felt. shear and spread have no local part: a gradient of p
/// itself would be without bound at an edge of contact.
struct DepthLaw {
  DepthFractions normal, shear, spread, sinking;
};
/// -1 < nu <= 0.5.
DepthLaw depth_law(double nu, double zeta);

/// Laws at equal steps of depth, and linear between them.
struct DepthLaws {
  static constexpr int kSteps = 32;
  std::array<DepthLaw, kSteps + 1> law;
  DepthLaw operator()(double zeta) const;  ///< zeta is taken for 0 below it, for 1 above
};
DepthLaws make_depth_laws(double nu);

}  // namespace dea

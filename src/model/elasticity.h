// src/model/elasticity.h – small-strain constants of cartilage.
#pragma once

namespace dea {

/// Small-strain constants of one layer.
struct Elasticity {
  double E = 0.0;   ///< Young's modulus [MPa]
  double nu = 0.0;  ///< Poisson's ratio, -1 < nu < 0.5
};

/// Confined (aggregate) modulus M = E (1 - nu) / ((1 + nu)(1 - 2 nu)) [MPa]: a thin layer bonded to bone cannot spread.
inline double confined_modulus(double E, double nu) { return E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)); }

}  // namespace dea

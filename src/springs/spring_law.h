// src/springs/spring_law.h – contact pressure of a spring from its overlap: one or two layers of cartilage in
// series.
#pragma once
#include "src/model/elasticity.h"
#include "src/model/settings.h"

namespace dea {

/// Strain beyond which a law continues linearly (C1); a solution that ends there is no answer.
inline constexpr double kStrainLimit = 0.9;

/// Confined response p(e) of a layer at strain e = shortening / thickness, and its slope p'(e):
///   linear        M e
///   logarithmic   -M ln(1 - e)                          (Blankevoort et al. 1991)
///   layer         as neo-Hookean: what the layers do together is in layer_contact.h
///   neo-Hookean   mu (1/J - J) - lambda ln(J)/J, J = 1 - e                         (S6)
/// All have slope M at e = 0; beyond e = 0.9 they continue linearly with value and slope (C1).
struct LayerResponse {
  double pressure = 0.0;
  double slope = 0.0;
};
LayerResponse layer_response(Law law, const Elasticity& layer, double strain);

/// The strain at which a layer carries this pressure (>= 0); inverse of layer_response.
double strain_at_pressure(Law law, const Elasticity& layer, double pressure);

/// Two layers of thickness t_s (source) and t_t (target) pressed together by `overlap` (Delta):
/// the common pressure p with e_s t_s + e_t t_t = overlap, p_s(e_s) = p_t(e_t)       (S5)
/// A layer of zero thickness drops out. overlap <= 0: everything is zero but the slopes at zero overlap.
struct SpringResponse {
  double pressure = 0.0;
  double per_overlap = 0.0;    ///< dp/dDelta at constant thicknesses
  double strain_source = 0.0;  ///< e_s
  double strain_target = 0.0;  ///< e_t
};
/// `interface_compliance`: of something between the surfaces that gives way by this much per pressure, as an FEA
/// contact's penalty does; its share of the overlap is not the layers': e_s t_s + e_t t_t + p c = overlap    (S9)
SpringResponse spring_response(Law law, const Elasticity& source, const Elasticity& target, double t_source,
                               double t_target, double overlap, double interface_compliance = 0.0);

}  // namespace dea

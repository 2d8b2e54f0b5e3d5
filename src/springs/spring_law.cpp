#include "src/springs/spring_law.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace dea {

namespace {

/// The law itself, for strains below the limit.
LayerResponse law_response(Law law, const Elasticity& layer, double e) {
  const double M = confined_modulus(layer.E, layer.nu);
  switch (law) {
    case Law::Linear:
      return {M * e, M};
    case Law::Logarithmic:
      return {-M * std::log1p(-e), M / (1 - e)};
    case Law::Layer:
    case Law::NeoHookean: {
      const double mu = layer.E / (2 * (1 + layer.nu));
      const double lambda = M - 2 * mu;
      const double J = 1 - e, log_J = std::log1p(-e);
      // dp/de = -dp/dJ
      return {mu * e * (2 - e) / J - lambda * log_J / J,  // 1/J - J without cancellation
              mu * (1 / (J * J) + 1) + lambda * (1 - log_J) / (J * J)};
    }
  }
  assert(false);
  return {};
}

}  // namespace

LayerResponse layer_response(Law law, const Elasticity& layer, double e) {
  if (law == Law::Linear || e <= kStrainLimit) return law_response(law, layer, e);
  LayerResponse at_limit = law_response(law, layer, kStrainLimit);
  at_limit.pressure += at_limit.slope * (e - kStrainLimit);
  return at_limit;
}

double strain_at_pressure(Law law, const Elasticity& layer, double p) {
  if (p <= 0) return 0.0;
  const double M = confined_modulus(layer.E, layer.nu);
  if (law == Law::Linear) return p / M;
  const LayerResponse at_limit = law_response(law, layer, kStrainLimit);
  if (p >= at_limit.pressure) return kStrainLimit + (p - at_limit.pressure) / at_limit.slope;
  if (law == Law::Logarithmic) return -std::expm1(-p / M);
  // neo-Hookean: convex and increasing, so Newton from the right falls monotonically onto the root
  double e = std::min(p / M, kStrainLimit);
  for (int i = 0; i < 60; ++i) {
    const LayerResponse r = law_response(law, layer, e);
    const double next = e - (r.pressure - p) / r.slope;
    if (std::abs(next - e) <= 1e-16 * std::max(1.0, e)) return next;
    e = next;
  }
  return e;
}

namespace {

SpringResponse layers_response(Law law, const Elasticity& source, const Elasticity& target, double t_s, double t_t,
                               double overlap) {
  SpringResponse r;
  const double h = t_s + t_t;
  if (h <= 0) return r;
  const double delta = std::max(0.0, overlap);
  const bool same = source.E == target.E && source.nu == target.nu;
  if (t_s <= 0 || t_t <= 0 || same) {
    // one layer, or two that are strained alike
    const Elasticity& layer = t_s > 0 ? source : target;
    const double e = delta / h;
    const LayerResponse p = layer_response(law, layer, e);
    r.pressure = p.pressure;
    r.per_overlap = p.slope / h;
    r.strain_source = t_s > 0 ? e : 0.0;
    r.strain_target = t_t > 0 ? e : 0.0;
    return r;
  }
  double e_s, e_t;
  if (law == Law::Linear) {
    const double M_s = confined_modulus(source.E, source.nu), M_t = confined_modulus(target.E, target.nu);
    r.pressure = delta / (t_s / M_s + t_t / M_t);
    e_s = r.pressure / M_s;
    e_t = r.pressure / M_t;
  } else {
    // e_s t_s + e_t(p_s(e_s)) t_t = delta: increasing in e_s; Newton with a bracket
    double low = 0.0, high = delta / t_s;
    e_s = delta / h;
    for (int i = 0; i < 100; ++i) {
      const LayerResponse p = layer_response(law, source, e_s);
      const double other = strain_at_pressure(law, target, p.pressure);
      const double excess = e_s * t_s + other * t_t - delta;
      (excess > 0 ? high : low) = e_s;
      const double slope = t_s + t_t * p.slope / layer_response(law, target, other).slope;
      double next = e_s - excess / slope;
      if (!(next >= low && next <= high)) next = 0.5 * (low + high);
      const bool done = std::abs(next - e_s) <= 1e-15 * std::max(1e-12, e_s);
      e_s = next;
      if (done) break;
    }
    r.pressure = layer_response(law, source, e_s).pressure;
    e_t = strain_at_pressure(law, target, r.pressure);
  }
  const double slope_s = layer_response(law, source, e_s).slope, slope_t = layer_response(law, target, e_t).slope;
  r.per_overlap = 1.0 / (t_s / slope_s + t_t / slope_t);
  r.strain_source = e_s;
  r.strain_target = e_t;
  return r;
}

}  // namespace

SpringResponse spring_response(Law law, const Elasticity& source, const Elasticity& target, double t_s, double t_t,
                               double overlap, double c) {
  if (c <= 0) return layers_response(law, source, target, t_s, t_t, overlap);
  // x + c p(x) = overlap for the layers' share x. p is convex and increasing: Newton from the right falls onto the
  // root.
  double x = overlap;
  SpringResponse r = layers_response(law, source, target, t_s, t_t, x);
  for (int i = 0; i < 60 && overlap > 0; ++i) {
    const double excess = x + c * r.pressure - overlap;
    if (std::abs(excess) <= 1e-15 * overlap) break;
    x -= excess / (1 + c * r.per_overlap);
    r = layers_response(law, source, target, t_s, t_t, x);
  }
  r.per_overlap /= 1 + c * r.per_overlap;
  return r;
}

}  // namespace dea

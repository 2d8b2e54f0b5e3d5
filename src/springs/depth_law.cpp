#include "src/springs/depth_law.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "src/base/decompositions.h"
#include "src/base/numbers.h"
#include "src/springs/layer_kernel.h"

namespace dea {

namespace {

/// The general solution for u_x = U sin, u_z = W cos, with t = mu = 1: W is a sum of exp(s(z-1)), z exp(s(z-1)),
/// exp(-sz), z exp(-sz). Rows: what each of the four adds.
struct Waves {
  Eigen::RowVector4d U, W, normal, shear;  // normal: sigma_zz; shear: sigma_xz
};
Waves waves(double nu, double s, double z) {
  const double k = 3 - 4 * nu, up = std::exp(s * (z - 1)), down = std::exp(-s * z);
  Waves w;
  w.U << -up, -(z + k / s) * up, down, (z - k / s) * down;
  w.W << up, z * up, down, z * down;
  Eigen::RowVector4d dU, dW;
  dU << -s * up, -(1 + s * z + k) * up, -s * down, (1 - s * z + k) * down;
  dW << s * up, (1 + s * z) * up, -s * down, (1 - s * z) * down;
  w.normal = 2 * dW;  // lambda div u is finite for nu -> 0.5
  w.normal[1] -= 4 * nu * up;
  w.normal[3] -= 4 * nu * down;
  w.shear = dU - s * w.W;
  return w;
}

/// The four amplitudes: no displacement at the base, unit pressure without shear on the surface.
Eigen::Vector4d amplitudes(double nu, double s) {
  const Waves base = waves(nu, s, 0), top = waves(nu, s, 1);
  Eigen::Matrix4d equations;
  equations << base.U, base.W, top.normal, top.shear;
  return solve_regular(equations, Eigen::Vector4d(0, 0, -1, 0));
}

DepthResponse response_of(double nu, double s, double z, const Eigen::Vector4d& amplitude) {
  const Waves w = waves(nu, s, z);
  return {-w.normal.dot(amplitude), w.shear.dot(amplitude) / s, w.U.dot(amplitude) / s, -w.W.dot(amplitude)};
}

DepthResponse long_wave(double nu, double z) {
  const double aside = nu / (1 - nu), m = (1 - 2 * nu) / (2 * (1 - nu));  // m = mu/M
  return {1, (1 - z) * aside, aside * (z - z * z / 2) - m * z * z / 2, z * m};
}

/// Wave numbers of the fits, denser where they are small, and what each stands for.
constexpr int kSamples = 64;
constexpr double kShortest = 20.0;
double sample(int i) { return kShortest * std::pow((i + 0.5) / kSamples, 2); }
double sample_weight(int i) {
  const double s = sample(i);
  return std::sqrt(2 * std::sqrt(s * kShortest) / kSamples / (1 + s * s));
}

/// The waves at all of them are solved once for all depths.
using Amplitudes = std::array<Eigen::Vector4d, kSamples>;
Amplitudes sample_amplitudes(double nu) {
  Amplitudes all;
  for (int i = 0; i < kSamples; ++i) all[at(i)] = amplitudes(nu, sample(i));
  return all;
}

/// Fits s^order times a function of s; `limit`: at s = 0, kept.
DepthFractions fitted(const std::array<DepthResponse, kSamples>& exact, double DepthResponse::*of, double limit,
                      int order, bool local) {
  const LayerLaw law = layer_law({1.0, 0.3}, LayerFit::TwoTerms);  // the poles are the same for every nu
  const int unknowns = kDepthPowers + local;
  Eigen::MatrixXd A(kSamples, unknowns);
  Eigen::VectorXd b(kSamples);
  for (int i = 0; i < kSamples; ++i) {
    const double s = sample(i), weight = sample_weight(i) * std::pow(s, order), first = 1 / (1 + law.beta[0] * s * s),
                 second = 1 / (1 + law.beta[1] * s * s);
    double power = 1;
    for (int k = 0; k < kDepthPowers; ++k) A(i, k) = weight * ((power *= second) - first);
    if (local) A(i, kDepthPowers) = weight * (1 - first);
    b[i] = weight * (exact[at(i)].*of - limit * first);
  }
  const Eigen::VectorXd x = solve_least_norm(A, b);
  DepthFractions out;
  out.first = limit - x.sum();
  for (int k = 0; k < kDepthPowers; ++k) out.power[at(k)] = x[k];
  if (local) out.local = x[kDepthPowers];
  return out;
}

DepthLaw fitted_law(double nu, double zeta, const Amplitudes& amplitudes) {
  std::array<DepthResponse, kSamples> exact;
  for (int i = 0; i < kSamples; ++i) exact[at(i)] = response_of(nu, sample(i), zeta, amplitudes[at(i)]);
  const DepthResponse limit = long_wave(nu, zeta);
  const bool bone = zeta <= 0, surface = zeta >= 1;
  DepthLaw law;
  if (surface)
    law.normal.local = 1;
  else
    law.normal = fitted(exact, &DepthResponse::normal, limit.normal, 0, !bone);
  if (!surface) law.shear = fitted(exact, &DepthResponse::shear, limit.shear, 1, false);
  if (!bone) {
    law.spread = fitted(exact, &DepthResponse::spread, limit.spread, 2, false);
    law.sinking = fitted(exact, &DepthResponse::sinking, limit.sinking, 0, true);
  }
  return law;
}

/// (1 - share) a + share b
DepthFractions between(const DepthFractions& a, const DepthFractions& b, double share) {
  const auto mix = [share](double x, double y) { return x + share * (y - x); };
  DepthFractions out;
  out.local = mix(a.local, b.local);
  out.first = mix(a.first, b.first);
  for (std::size_t k = 0; k < out.power.size(); ++k) out.power[k] = mix(a.power[k], b.power[k]);
  return out;
}

}  // namespace

DepthResponse depth_response(double nu, double s, double zeta) {
  assert(s >= 0 && zeta >= 0 && zeta <= 1 && nu > -1 && nu <= 0.5);
  return s < 0.01 ? long_wave(nu, zeta) : response_of(nu, s, zeta, amplitudes(nu, s));
}

double DepthFractions::operator()(double s) const {
  const LayerLaw law = layer_law({1.0, 0.3}, LayerFit::TwoTerms);
  double sum = local + first / (1 + law.beta[0] * s * s), fraction = 1;
  for (const double weight : power) sum += weight * (fraction /= 1 + law.beta[1] * s * s);
  return sum;
}

DepthLaw depth_law(double nu, double zeta) {
  assert(nu > -1 && nu <= 0.5);
  return fitted_law(nu, zeta, sample_amplitudes(nu));
}

DepthLaws make_depth_laws(double nu) {
  const Amplitudes amplitudes = sample_amplitudes(nu);
  DepthLaws laws;
  for (int i = 0; i <= DepthLaws::kSteps; ++i)
    laws.law[at(i)] = fitted_law(nu, static_cast<double>(i) / DepthLaws::kSteps, amplitudes);
  return laws;
}

DepthLaw DepthLaws::operator()(double zeta) const {
  const double place = std::clamp(zeta, 0.0, 1.0) * kSteps;
  const int i = std::min(static_cast<int>(place), kSteps - 1);
  const DepthLaw &a = law[at(i)], &b = law[at(i + 1)];
  const double share = place - i;
  return {between(a.normal, b.normal, share), between(a.shear, b.shear, share), between(a.spread, b.spread, share),
          between(a.sinking, b.sinking, share)};
}

}  // namespace dea

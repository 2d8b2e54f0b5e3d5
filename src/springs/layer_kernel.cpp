#include "src/springs/layer_kernel.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "src/base/decompositions.h"

namespace dea {

namespace {

/// sinh(x) - x for 0 <= x <= 1, without cancellation.
double sinh_minus(double x) {
  double term = x, sum = 0.0;
  for (int k = 1; k < 12; ++k) {
    term *= x * x / ((2 * k) * (2 * k + 1));
    sum += term;
  }
  return sum;
}

/// (L1) times E: a function of s and nu alone. 1 - 2 nu is kept apart: at nu = 0.5 the first term of the series is
/// gone and the next one counts.
double compliance(double nu, double s) {
  const double d = 1 - 2 * nu;  // 3 - 4 nu = 1 + 2 d
  if (s < 1e-8) return (1 + nu) * (d / (1 - nu) + nu * (4 * nu - 1) * s * s / (3 * (1 - nu) * (1 - nu)));
  const double x = 2 * s, polynomial = 2 * s * s + 5 - 12 * nu + 8 * nu * nu;
  double numerator, denominator;
  if (x < 1) {
    numerator = sinh_minus(x) + 2 * d * std::sinh(x);
    denominator = (1 + 2 * d) * std::cosh(x) + polynomial;
  } else {  // both times 2 exp(-2s)
    const double decay = std::exp(-x), decay2 = decay * decay;
    numerator = (1 + 2 * d) * (1 - decay2) - 2 * x * decay;
    denominator = (1 + 2 * d) * (1 + decay2) + 2 * polynomial * decay;
  }
  return 2 * (1 - nu * nu) / s * numerator / denominator;
}

/// (L2), times E.
LayerLaw one_term(double nu) {
  LayerLaw law;
  law.terms = 1;
  law.confined = (1 + nu) * (1 - 2 * nu) / (1 - nu);
  double beta = 1.0;
  if (nu >= 0.3) beta -= (3 - 4 * nu) * (4 * nu * nu + 2 * nu - 1) / (20 * nu * (4 * nu - 1));
  law.beta[0] = beta / (1 - nu);
  // (alpha - beta)/M, finite at nu = 0.5
  const double first = nu * (4 * nu - 1) * (1 + nu) / (3 * (1 - nu) * (1 - nu));
  law.weight[0] = -first / law.beta[0];
  law.local = law.confined - law.weight[0];
  return law;
}

/// (L2b), times E.
LayerLaw two_terms(double nu) {
  LayerLaw law;
  law.terms = 2;
  law.confined = (1 + nu) * (1 - 2 * nu) / (1 - nu);
  law.beta = {2.0, 0.155};
  const double first = nu * (4 * nu - 1) * (1 + nu) / (3 * (1 - nu) * (1 - nu));  // of s^2 in (L1), times E
  // unknowns local, weight_0, weight_1, square
  Eigen::Matrix4d equations;
  Eigen::Vector4d values;
  equations.row(0).setOnes();
  values[0] = law.confined;
  equations.row(1) << 0, -law.beta[0], -law.beta[1], -2 * law.beta[1];
  values[1] = first;
  const double matched[2] = {2.0, 9.0};
  for (int i = 0; i < 2; ++i) {
    const double s2 = matched[i] * matched[i], f = 1 / (1 + law.beta[1] * s2);
    equations.row(2 + i) << 1, 1 / (1 + law.beta[0] * s2), f, f * f;
    values[2 + i] = compliance(nu, matched[i]);
  }
  const Eigen::Vector4d x = solve_regular(equations, values);
  law.local = x[0];
  law.weight = {x[1], x[2]};
  law.square = x[3];
  // The largest share, nearly, with which (L9) is positive at any strain: local M >= own_share^2 at nu = 0, where it is
  // least. Below nothing of the foot's own is left.
  law.own_share = nu >= 0 ? 1.0 / 3 : 0.0;
  return law;
}

}  // namespace

double layer_compliance(const Elasticity& layer, double s) {
  assert(s >= 0);
  return compliance(layer.nu, s) / layer.E;
}

LayerLaw layer_law(const Elasticity& layer, LayerFit fit) {
  assert(layer.E > 0 && layer.nu > -1 && layer.nu <= 0.5);
  LayerLaw law = fit == LayerFit::OneTerm ? one_term(layer.nu) : two_terms(layer.nu);
  law.local /= layer.E;
  law.confined /= layer.E;
  law.square /= layer.E;
  for (double& w : law.weight) w /= layer.E;
  return law;
}

EdgeLaw edge_law(const Elasticity& layer, LayerFit fit) {
  EdgeLaw edge;
  if (fit == LayerFit::OneTerm) return edge;
  const double nu = std::max(0.0, layer.nu);
  edge.straight = 0.36 * nu * nu;
  edge.curved = 5.2 * nu * nu * nu;
  edge.around = 0.35;
  // An even load on a half-line sinks 0.52 t p/E deeper at its edge than the two terms have it; the shares of the other
  // two there are 1/(4 sqrt(beta_1)) and 1/sqrt(beta_0).
  const LayerLaw law = two_terms(layer.nu);
  edge.own = std::max(0.0, 0.52 - edge.around / (4 * std::sqrt(law.beta[1])) - edge.straight / std::sqrt(law.beta[0]));
  edge.goes_on = 0.5 * std::sqrt(law.beta[1]) * law.square;
  edge.unit = 1;
  edge.driven = 5.37 * nu * nu - 0.517 * nu - 0.192;
  edge.squeezed = -3.16 * nu * nu + 1.2 * nu + 0.37;
  for (double* value :
       {&edge.straight, &edge.curved, &edge.around, &edge.own, &edge.goes_on, &edge.unit, &edge.driven, &edge.squeezed})
    *value /= layer.E;
  return edge;
}

EdgeLaw leaning(const EdgeLaw& vertical, double slope) {
  slope = std::clamp(slope, kMostUndercut, kMostBevel);
  // a bevel props the edge up, at most as a layer that goes on does; an undercut lip bends
  const double bevel = std::max(0.0, slope), undercut = std::max(0.0, -slope);
  EdgeLaw edge = vertical;
  edge.straight = edge.straight * std::exp(-3.9 * slope) - 0.29 * bevel * edge.unit;
  edge.around = std::max(edge.goes_on, edge.around * std::exp(-5.2 * slope) - 0.2 * bevel * edge.unit);
  edge.own = edge.own * std::exp(-6 * bevel) + 0.85 * undercut * edge.unit;
  edge.driven *= std::exp(0.85 * undercut - 0.45 * bevel);
  edge.squeezed = (edge.squeezed + 0.2 * edge.unit) * std::exp(-2.7 * slope) - 0.2 * edge.unit;
  return edge;
}

double LayerLaw::largest() const {
  // of the second fraction and its square the greatest value for 0 <= 1/(1 + beta_1 s^2) <= 1
  double second = std::max(0.0, weight[1] + square);
  if (square < 0 && weight[1] > 0 && weight[1] < -2 * square)
    second = std::max(second, -weight[1] * weight[1] / (4 * square));
  return local + std::max(weight[0], 0.0) + second;
}

}  // namespace dea

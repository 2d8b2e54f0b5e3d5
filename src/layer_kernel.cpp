#include "layer_kernel.h"

#include <cassert>
#include <cmath>

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
  law.confined = (1 + nu) * (1 - 2 * nu) / (1 - nu);
  law.local = 0.5 * compliance(nu, 12);
  if (nu < 0.3) {
    law.terms = 1;
    law.weight[0] = law.confined - law.local;
    law.beta[0] = (law.weight[0] / (compliance(nu, 2) - law.local) - 1) / 4;
    return law;
  }
  // (1/M + a1 s^2 + local b2 s^4) = f (1 + b1 s^2 + b2 s^4) with a1 = first + b1/M, at two s: linear in b1, b2
  const double first = nu * (4 * nu - 1) * (1 + nu) / (3 * (1 - nu) * (1 - nu));
  const double s2[2] = {0.9 * 0.9, 3.0 * 3.0};
  double m[2][2], r[2];
  for (int i = 0; i < 2; ++i) {
    const double f = compliance(nu, std::sqrt(s2[i]));
    m[i][0] = s2[i] * (law.confined - f);
    m[i][1] = s2[i] * s2[i] * (law.local - f);
    r[i] = f - law.confined - first * s2[i];
  }
  const double determinant = m[0][0] * m[1][1] - m[0][1] * m[1][0];
  const double b1 = (r[0] * m[1][1] - m[0][1] * r[1]) / determinant,
               b2 = (m[0][0] * r[1] - r[0] * m[1][0]) / determinant;
  const double root = std::sqrt(b1 * b1 - 4 * b2);
  assert(root > 0 && b2 > 0);
  law.terms = 2;
  law.beta = {(b1 + root) / 2, 2 * b2 / (b1 + root)};
  // the weights sum to 1/M - local, and their sum with the betas is minus the first term
  law.weight[0] = (-first - (law.confined - law.local) * law.beta[1]) / (law.beta[0] - law.beta[1]);
  law.weight[1] = law.confined - law.local - law.weight[0];
  return law;
}

}  // namespace

double layer_compliance(const Elasticity& layer, double s) {
  assert(s >= 0);
  return compliance(layer.nu, s) / layer.E;
}

LayerLaw layer_law(const Elasticity& layer, LayerFit fit) {
  assert(layer.E > 0 && layer.nu >= 0 && layer.nu <= 0.5);
  LayerLaw law = fit == LayerFit::OneTerm ? one_term(layer.nu) : two_terms(layer.nu);
  law.local /= layer.E;
  law.confined /= layer.E;
  for (double& w : law.weight) w /= layer.E;
  return law;
}

}  // namespace dea

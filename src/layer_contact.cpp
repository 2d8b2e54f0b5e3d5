#include "layer_contact.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace dea {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

MatrixXd layer_sinking(LayerOperator* layer, const VectorXd& share, const VectorXd& area, const MatrixXd& pressure) {
  MatrixXd w = MatrixXd::Zero(pressure.rows(), pressure.cols());
  if (!layer) return w;
  if (share.size() == 0) {
    layer->add_sinking(pressure, area, w);
    return w;
  }
  const VectorXd root = share.cwiseSqrt();
  layer->add_sinking(root.asDiagonal() * pressure, area, w);
  return root.asDiagonal() * w;
}

}  // namespace

MatrixXd sinking(const LayerContact& contact, const MatrixXd& pressure) {
  MatrixXd w_s, w_t;
  tbb::parallel_invoke([&] { w_s = layer_sinking(contact.source, contact.source_share, contact.area, pressure); },
                       [&] { w_t = layer_sinking(contact.target, contact.target_share, contact.area, pressure); });
  if (contact.interface_compliance > 0) return w_s + w_t + contact.interface_compliance * pressure;
  return w_s + w_t;
}

VectorXd local_compliance(const LayerContact& contact) {
  VectorXd local = VectorXd::Zero(contact.area.size());
  const auto add = [&](const LayerOperator* layer, const VectorXd& share) {
    if (!layer) return;
    for (Index i = 0; i < local.size(); ++i) local[i] += layer->own()[at(i)] * (share.size() > 0 ? share[i] : 1.0);
  };
  add(contact.source, contact.source_share);
  add(contact.target, contact.target_share);
  for (Index i = 0; i < local.size(); ++i)
    if (local[i] > 0) local[i] += contact.interface_compliance;
  return local;
}

MatrixXd spread(const LayerContact& contact, const MatrixXd& force) {
  LayerContact whole = contact;
  whole.area = VectorXd::Ones(contact.area.size());
  return sinking(whole, force) - local_compliance(whole).asDiagonal() * force;
}

namespace {

/// The contact divided by the local compliance: B p = b with B = C/local, b = overlap/local, and the inner product
/// <u, v> = sum of A_i local_i u_i v_i in which B is symmetric. Its eigenvalues are those of law(s)/law(infinity).
struct ScaledContact {
  const LayerContact& contact;
  VectorXd local;   // 1 where there is no layer
  VectorXd weight;  // 0: takes no part
  int applications = 0;

  explicit ScaledContact(const LayerContact& c) : contact(c), local(local_compliance(c)) {
    weight = contact.area.cwiseProduct(local);
    for (Index i = 0; i < local.size(); ++i)
      if (!(local[i] > 0)) local[i] = 1;
  }
  MatrixXd apply(const MatrixXd& p) {
    ++applications;
    return local.cwiseInverse().asDiagonal() * sinking(contact, p);
  }
  double dot(const VectorXd& u, const VectorXd& v) const { return (weight.array() * u.array() * v.array()).sum(); }
  /// Upper bound of the eigenvalues of B.
  double largest() const {
    double bound = 1;
    for (const LayerOperator* layer : {contact.source, contact.target}) {
      if (layer) bound = std::max(bound, layer->law().largest() / layer->law().local);
    }
    return bound;
  }
};

/// The three parts of the gradient z = B p - b: `free` where p > 0, `chopped` where p = 0 and a pressure is missing,
/// `reduced` as much of `free` as a step of the given length can follow before p = 0.
struct Gradient {
  VectorXd free, chopped, reduced;
  void split(const ScaledContact& B, const VectorXd& p, const VectorXd& z, double step) {
    for (auto* part : {&free, &chopped, &reduced}) part->setZero(p.size());
    for (Index i = 0; i < p.size(); ++i) {
      if (!(B.weight[i] > 0)) continue;
      if (p[i] > 0) {
        free[i] = z[i];
        reduced[i] = std::min(p[i] / step, z[i]);
      } else {
        chopped[i] = std::min(z[i], 0.0);
      }
    }
  }
};

double complementarity(const ScaledContact& B, const VectorXd& p, const VectorXd& z) {
  double worst = 0;
  for (Index i = 0; i < p.size(); ++i)
    if (const double off = std::abs(std::min(p[i], z[i])); B.weight[i] > 0 && !(off <= worst)) worst = off;  // NaN, too
  const double peak = p.size() > 0 ? p.maxCoeff() : 0.0;
  return peak > 0 ? worst / peak : worst;
}

}  // namespace

LayerPressure solve_contact(const LayerContact& contact, const VectorXd& overlap, const VectorXd& start,
                            const LayerContactOptions& options) {
  ScaledContact B(contact);
  const Index n = overlap.size();
  assert(contact.area.size() == n && (start.size() == 0 || start.size() == n));
  const VectorXd b = overlap.cwiseQuotient(B.local);
  // Dostal and Schoeberl's step of expansion converges for lengths below 2 / |B|
  const double expansion = 1.9 / B.largest();
  VectorXd p = (start.size() == n ? start : b).cwiseMax(0.0);
  for (Index i = 0; i < n; ++i)
    if (!(B.weight[i] > 0)) p[i] = 0;
  VectorXd z = B.apply(p).col(0) - b;
  Gradient g;
  g.split(B, p, z, expansion);
  VectorXd d = g.free;  // direction
  LayerPressure result;
  for (;;) {
    result.residual = complementarity(B, p, z);
    if (result.residual <= options.tolerance) {  // by z as it was carried along; now as it is
      z = B.apply(p).col(0) - b;
      g.split(B, p, z, expansion);
      d = g.free;
      result.residual = complementarity(B, p, z);
      result.converged = result.residual <= 10 * options.tolerance;
    }
    if (result.converged || B.applications >= options.max_applications) break;
    const bool proportional = B.dot(g.chopped, g.chopped) <= B.dot(g.reduced, g.free);
    if (!proportional) d = g.chopped;  // let more feet touch
    const VectorXd Bd = B.apply(d).col(0);
    const double curvature = B.dot(d, Bd);
    if (!(curvature > 0)) break;  // d is nothing but rounding
    const double full = B.dot(z, d) / curvature;
    double feasible = std::numeric_limits<double>::infinity();
    for (Index i = 0; i < n; ++i)
      if (d[i] > 0) feasible = std::min(feasible, p[i] / d[i]);
    if (full <= feasible) {
      p = (p - full * d).cwiseMax(0.0);
      z -= full * Bd;
      g.split(B, p, z, expansion);
      d = proportional ? VectorXd(g.free - B.dot(g.free, Bd) / curvature * d) : g.free;
    } else {  // to the first foot that lets go, and a gradient step that may let go many
      p = (p - feasible * d).cwiseMax(0.0);
      z -= feasible * Bd;
      g.split(B, p, z, expansion);
      p = (p - expansion * g.free).cwiseMax(0.0);
      z = B.apply(p).col(0) - b;
      g.split(B, p, z, expansion);
      d = g.free;
    }
  }
  result.active.resize(at(n));
  for (Index i = 0; i < n; ++i) result.active[at(i)] = p[i] > 0;
  result.pressure = std::move(p);
  result.applications = B.applications;
  return result;
}

ActiveRates solve_active(const LayerContact& contact, const std::vector<char>& active, const MatrixXd& overlap_rates,
                         double tolerance, const MatrixXd& start) {
  constexpr int kMaxSteps = 1000;
  ScaledContact B(contact);
  const Index columns = overlap_rates.cols();
  const auto mask = [&](MatrixXd& m) {
    for (Index i = 0; i < m.rows(); ++i)
      if (!active[at(i)] || !(B.weight[i] > 0)) m.row(i).setZero();
  };
  // conjugate gradients for all columns in step: a sparse solution of several columns costs little more than one
  ActiveRates result;
  MatrixXd r = B.local.cwiseInverse().asDiagonal() * overlap_rates;
  mask(r);
  VectorXd size(columns), goal(columns);
  const auto measure = [&] {
    for (Index c = 0; c < columns; ++c) size[c] = B.dot(r.col(c), r.col(c));
  };
  measure();
  goal = (tolerance * tolerance * size).cwiseMax(1e-24 * size.maxCoeff());  // a column may be zero
  result.pressure = MatrixXd::Zero(r.rows(), columns);
  if (start.size() > 0) {
    assert(start.rows() == r.rows() && start.cols() == columns);
    result.pressure = start;
    mask(result.pressure);
    r -= B.apply(result.pressure);
    mask(r);
    measure();
  }
  MatrixXd d = r;
  while ((size.array() > goal.array()).any() && B.applications < kMaxSteps) {
    MatrixXd Bd = B.apply(d);
    mask(Bd);
    for (Index c = 0; c < columns; ++c) {
      const double curvature = B.dot(d.col(c), Bd.col(c));
      if (size[c] <= goal[c] || !(curvature > 0)) continue;
      const double step = size[c] / curvature;
      result.pressure.col(c) += step * d.col(c);
      r.col(c) -= step * Bd.col(c);
      const double next = B.dot(r.col(c), r.col(c));
      d.col(c) = r.col(c) + next / size[c] * d.col(c);
      size[c] = next;
    }
  }
  result.converged = (size.array() <= goal.array()).all();
  result.applications = B.applications;
  return result;
}

LayerSprings solve_layer_springs(LayerContact& contact, Law law, const Elasticity& source, const Elasticity& target,
                                 const VectorXd& overlap, const VectorXd& start, const LayerContactOptions& options) {
  constexpr int kMaxRepetitions = 50;
  const Index n = overlap.size();
  // a rigid side has no modulus, and takes no share
  const double M_s = contact.source ? confined_modulus(source.E, source.nu) : 1.0,
               M_t = contact.target ? confined_modulus(target.E, target.nu) : 1.0;
  const bool shares =
      law != Law::Linear && contact.source && contact.target && (source.E != target.E || source.nu != target.nu);
  contact.source_share = contact.target_share = shares ? VectorXd(VectorXd::Ones(n)) : VectorXd();
  LayerSprings result;
  result.spring_overlap.resize(n);
  result.springs.resize(at(n));
  int applications = 0;
  for (result.repetitions = 1;; ++result.repetitions) {
    result.linear = solve_contact(contact, overlap, result.repetitions == 1 ? start : result.linear.pressure, options);
    applications += result.linear.applications;
    double change = 0;
    for (Index i = 0; i < n; ++i) {
      const double t_s = contact.source ? contact.source->thickness()[at(i)] : 0.0,
                   t_t = contact.target ? contact.target->thickness()[at(i)] : 0.0, P = result.linear.pressure[i];
      result.spring_overlap[i] = P * (t_s / M_s + t_t / M_t);
      const SpringResponse& r = result.springs[at(i)] =
          spring_response(law, source, target, t_s, t_t, result.spring_overlap[i]);
      if (!shares) continue;
      if (!(P > 0)) {  // both shares go to 1 with P
        contact.source_share[i] = contact.target_share[i] = 1;
        continue;
      }
      for (auto* share : {&contact.source_share, &contact.target_share}) {
        const bool of_source = share == &contact.source_share;
        if ((of_source ? t_s : t_t) <= 0) continue;
        const double f = of_source ? M_s * r.strain_source / P : M_t * r.strain_target / P;
        change = std::max(change, std::abs(f - (*share)[i]));
        (*share)[i] = f;
      }
    }
    if (change <= 10 * options.tolerance || result.repetitions >= kMaxRepetitions) {
      result.linear.converged = result.linear.converged && change <= 10 * options.tolerance;
      break;
    }
  }
  result.linear.applications = applications;
  return result;
}

}  // namespace dea

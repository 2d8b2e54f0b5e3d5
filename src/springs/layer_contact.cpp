#include "src/springs/layer_contact.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "src/base/numbers.h"
#include "src/base/parallel.h"

namespace dea {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

MatrixXd layer_sinking(const PressedLayer& of, const MatrixXd& pressure) {
  return sinking(*of.layer, *of.feet, pressure, of.softening.size() > 0 ? &of.softening : nullptr);
}

/// Of w per pressure of the same foot, without flow.
VectorXd own_compliance(const LayerContact& contact, bool tangent) {
  VectorXd own = VectorXd::Zero(contact.area.size());
  for (const PressedLayer& of : contact.layers)
    for (Index i = 0; i < own.size(); ++i)
      own[i] += dea::own_compliance(*of.layer, *of.feet, static_cast<int>(i),
                                    tangent && of.softening.size() > 0 ? &of.softening : nullptr);
  for (Index i = 0; i < own.size(); ++i)
    if (own[i] > 0) own[i] += contact.interface_compliance;
  return own;
}

}  // namespace

MatrixXd sinking(const LayerContact& contact, const MatrixXd& pressure) {
  std::vector<MatrixXd> of_layer(contact.layers.size());
  parallel_for(of_layer.size(), [&](std::size_t k) { of_layer[k] = layer_sinking(contact.layers[k], pressure); });
  MatrixXd w = std::move(of_layer.front());
  for (std::size_t k = 1; k < of_layer.size(); ++k) w += of_layer[k];
  if (contact.interface_compliance > 0) w += contact.interface_compliance * pressure;
  return w;
}

VectorXd local_compliance(const LayerContact& contact) { return own_compliance(contact, false); }

MatrixXd spread(const LayerContact& contact, const MatrixXd& force) {
  VectorXd per_area = VectorXd::Zero(contact.area.size());
  for (Index i = 0; i < per_area.size(); ++i)
    if (contact.area[i] > 0) per_area[i] = 1 / contact.area[i];
  const MatrixXd pressure = per_area.asDiagonal() * force;
  return sinking(contact, pressure) - own_compliance(contact, true).asDiagonal() * pressure;
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
    for (const PressedLayer& of : contact.layers)
      bound = std::max(bound, of.layer->law.largest() / of.layer->law.local);
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

/// Bounded quadratic problem, by MPRGP: p >= 0 with the gradient z >= 0 and p z = 0, where z changes by B with p. `z`:
/// at the p to start from. `goal`: of the complementarity, relative.
void solve_bounded(ScaledContact& B, VectorXd& p, VectorXd z, double goal, const LayerContactOptions& options) {
  const Index n = p.size();
  // Dostal and Schoeberl's step of expansion converges for lengths below 2 / |B|
  const double expansion = 1.9 / B.largest();
  Gradient g;
  g.split(B, p, z, expansion);
  VectorXd d = g.free;  // direction
  for (;;) {
    if (complementarity(B, p, z) <= goal || B.applications >= options.max_applications) return;
    end_if_stopped(options.stop);
    const bool proportional = B.dot(g.chopped, g.chopped) <= B.dot(g.reduced, g.free);
    if (!proportional) d = g.chopped;  // let more feet touch
    const VectorXd Bd = B.apply(d).col(0);
    const double curvature = B.dot(d, Bd);
    if (!(curvature > 0)) return;  // d is nothing but rounding
    const double full = B.dot(z, d) / curvature;
    double feasible = kInfinity;
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
      const VectorXd before = p;
      p = (p - expansion * g.free).cwiseMax(0.0);
      z += B.apply(p - before).col(0);
      g.split(B, p, z, expansion);
      d = g.free;
    }
  }
}

}  // namespace

LayerPressure solve_contact(LayerContact& contact, const VectorXd& overlap, const VectorXd& start,
                            const LayerContactOptions& options) {
  constexpr int kMaxSteps = 100;
  for (PressedLayer& of : contact.layers) of.softening = VectorXd();
  ScaledContact B(contact);
  const Index n = overlap.size();
  assert(contact.area.size() == n && (start.size() == 0 || start.size() == n));
  LayerPressure result;
  VectorXd p = (start.size() == n ? start : overlap.cwiseQuotient(B.local)).cwiseMax(0.0);
  for (Index i = 0; i < n; ++i)
    if (!(B.weight[i] > 0)) p[i] = 0;
  // w by (L9), and the softenings there
  result.sunk.resize(contact.layers.size());
  const auto sink = [&](std::size_t k) {
    PressedLayer& of = contact.layers[k];
    result.sunk[k] = options.large_strain ? large_sinking(*of.layer, *of.feet, p, of.softening)
                                          : VectorXd(sinking(*of.layer, *of.feet, p).col(0));
  };
  for (int step = 0;; ++step) {
    end_if_stopped(options.stop);
    ++B.applications;
    parallel_for(result.sunk.size(), sink);
    VectorXd sunk = result.sunk.front();
    for (std::size_t k = 1; k < result.sunk.size(); ++k) sunk += result.sunk[k];
    const VectorXd z = (sunk + contact.interface_compliance * p - overlap).cwiseQuotient(B.local);
    const double before = result.residual;
    result.residual = complementarity(B, p, z);
    // solve_bounded carries its residual along: as it is, it may be a little larger
    result.converged = result.residual <= (step > 0 ? 3 : 1) * options.tolerance;
    if (result.converged || step >= kMaxSteps || B.applications >= options.max_applications) break;
    if (step > 2 && result.residual < 100 * options.tolerance && result.residual > 0.5 * before) break;  // rounding
    const bool linear = std::all_of(contact.layers.begin(), contact.layers.end(), [](const PressedLayer& of) {
      return of.softening.size() == 0 || of.softening.isZero(0.0);
    });
    // Newton's step squares the error: no need to solve it closer than that
    const double goal = linear ? options.tolerance
                               : std::max(0.3 * options.tolerance, std::min(0.1, result.residual) * result.residual);
    solve_bounded(B, p, z, goal, options);
  }
  result.active.resize(at(n));
  for (Index i = 0; i < n; ++i) result.active[at(i)] = p[i] > 0;
  result.pressure = std::move(p);
  result.applications = B.applications;
  return result;
}

ActiveRates solve_active(const LayerContact& contact, const std::vector<char>& active, const MatrixXd& overlap_rates,
                         double tolerance, const MatrixXd& start, const StopFlag* stop) {
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
    end_if_stopped(stop);
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

}  // namespace dea

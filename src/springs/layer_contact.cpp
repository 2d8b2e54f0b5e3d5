#include "src/springs/layer_contact.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <optional>
#include <utility>

#include "src/base/decompositions.h"
#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/springs/near_inverse.h"

namespace dea {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

MatrixXd layer_sinking(const PressedLayer& of, const MatrixXd& pressure) {
  return sinking(*of.layer, *of.feet, pressure, of.softening.size() > 0 ? &of.softening : nullptr);
}

MatrixXd part_sinking(const PartUnderFeet& of, const MatrixXd& pressure) {
  return sinking(*of.part, *of.feet, pressure);
}

/// (P4)
void add_pairs(const LayerContact& contact, const MatrixXd& pressure, MatrixXd& w) {
  for (const FootPair& pair : contact.pairs)
    for (const auto& of : {std::array<int, 2>{pair.i, pair.j}, std::array<int, 2>{pair.j, pair.i}})
      if (contact.area[of[0]] > 0)
        w.row(of[0]) += pair.compliance / contact.area[of[0]] * (pressure.row(of[0]) - pressure.row(of[1]));
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
  if (contact.own.size() > 0) own += contact.own;
  return own;
}

}  // namespace

MatrixXd sinking(const LayerContact& contact, const MatrixXd& pressure) {
  const std::size_t layers = contact.layers.size();
  std::vector<MatrixXd> of(layers + contact.parts.size());
  parallel_for(of.size(), [&](std::size_t k) {
    of[k] = k < layers ? layer_sinking(contact.layers[k], pressure) : part_sinking(contact.parts[k - layers], pressure);
  });
  MatrixXd w = std::move(of.front());
  for (std::size_t k = 1; k < of.size(); ++k) w += of[k];
  add_pairs(contact, pressure, w);
  if (contact.own.size() > 0) w += contact.own.asDiagonal() * pressure;
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
  double stride = 1.0;  // by which the near inverse leads too short
  MatrixXd soft;        // pressures that move parts along their softest motions: the largest eigenvalues are theirs
  VectorXd least;       // per foot: the least pressure, 0 or none

  explicit ScaledContact(const LayerContact& c) : contact(c), local(local_compliance(c)) {
    for (const PartUnderFeet& of : contact.parts)
      for (Index i = 0; i < local.size(); ++i) local[i] += of.feet->scale[at(i)];
    weight = contact.area.cwiseProduct(local);
    least = VectorXd::Zero(local.size());
    for (std::size_t i = 0; i < contact.two_sided.size(); ++i)
      if (contact.two_sided[i]) least[static_cast<Index>(i)] = -kInfinity;
    for (Index i = 0; i < local.size(); ++i)
      if (!(local[i] > 0)) local[i] = 1;
    soft.resize(local.size(), 0);
    for (const PartUnderFeet& of : contact.parts) {
      for (const Eigen::MatrixX3d& motion : of.part->soft) {
        soft.conservativeResize(Eigen::NoChange, soft.cols() + 1);
        soft.rightCols<1>() = along_forces(*of.feet, motion).cwiseQuotient(local);
      }
    }
  }
  /// Where a residual asks pressures to go, of feet that are `asked`.
  MatrixXd way(const std::vector<char>& asked, const MatrixXd& residual) const {
    MatrixXd way = residual;
    for (Index i = 0; i < way.rows(); ++i)
      if (!asked[at(i)]) way.row(i).setZero();
    for (const PressedLayer& of : contact.layers) add_near_inverse(*of.layer, *of.feet, weight, asked, residual, way);
    return way;
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

/// Parts hang on little, and what pushes them whole moves them far: eigenvalues of B along their soft motions are as
/// large as all others are small. Conjugate gradients that know these ways need no steps for them: each way is made
/// conjugate to all of them, and what the residual has along them is taken away at once (deflation; Saad, Yeung, Erhel
/// and Guyomarc'h 2000, SIAM J Sci Comput 21:1909).
class Deflation {
 public:
  /// `known`: masked ways, zero at feet that are not asked; `seen`: what B makes of them, masked.
  Deflation(const ScaledContact& B, MatrixXd known, MatrixXd seen)
      : B_(B), known_(std::move(known)), seen_(std::move(seen)) {
    energy_ = known_.transpose() * B_.weight.asDiagonal() * seen_;
  }
  /// The part of the solution for a residual that lies along the known ways: their shares.
  MatrixXd shares(const MatrixXd& residual) const {
    return solve_least_norm(energy_, known_.transpose() * B_.weight.asDiagonal() * residual);
  }
  const MatrixXd& known() const { return known_; }
  const MatrixXd& seen() const { return seen_; }
  /// The way, made conjugate to all that is known.
  void conjugate(MatrixXd& way) const {
    way -= known_ * solve_least_norm(energy_, seen_.transpose() * B_.weight.asDiagonal() * way);
  }

 private:
  const ScaledContact& B_;
  MatrixXd known_, seen_, energy_;
};

double complementarity(const ScaledContact& B, const VectorXd& p, const VectorXd& z) {
  double worst = 0;
  for (Index i = 0; i < p.size(); ++i)
    if (const double off = std::abs(B.least[i] < 0 ? z[i] : std::min(p[i], z[i])); B.weight[i] > 0 && !(off <= worst))
      worst = off;  // NaN, too
  const double peak = p.size() > 0 ? p.cwiseAbs().maxCoeff() : 0.0;
  return peak > 0 ? worst / peak : worst;
}

/// Bounded quadratic problem: p >= 0 with the gradient z >= 0 and p z = 0, where z changes by B with p. `z`: at the p
/// to start from. `goal`: of the complementarity, relative. Conjugate gradients on the feet that touch or ask to, led
/// by the near inverse; where a step would let feet go, the way is to its projection, to the least energy between. What
/// does not lead downhill is replaced by a short step along the gradient, projected: it always does.
void solve_bounded(ScaledContact& B, VectorXd& p, VectorXd z, double goal, const LayerContactOptions& options) {
  const Index n = p.size();
  std::vector<char> face(at(static_cast<int>(n)), 0), before;
  VectorXd free = VectorXd::Zero(n), d, Bd;
  std::optional<Deflation> soft;  // on the face
  double curvature = 0;           // of d; 0: there is none to be conjugate to
  double& stride = B.stride;
  while (!(complementarity(B, p, z) <= goal) && B.applications < options.max_applications) {
    end_if_stopped(options.stop);
    before = face;
    for (Index i = 0; i < n; ++i) {
      face[at(i)] = B.weight[i] > 0 && (p[i] > B.least[i] || z[i] < 0);
      free[i] = face[at(i)] ? z[i] : 0.0;
    }
    if (B.soft.cols() > 0 && (!soft || face != before)) {
      MatrixXd known = B.soft;
      const auto mask = [&](MatrixXd& m) {
        for (Index i = 0; i < n; ++i)
          if (!face[at(i)]) m.row(i).setZero();
      };
      mask(known);
      MatrixXd seen = B.apply(known);
      mask(seen);
      soft.emplace(B, std::move(known), std::move(seen));
    }
    MatrixXd ahead = B.way(face, free);
    if (soft) {
      soft->conjugate(ahead);
      ahead += soft->known() * soft->shares(free);
    }
    const VectorXd way = ahead.col(0);
    if (curvature > 0 && face == before)
      d = way - B.dot(way, Bd) / curvature * d;
    else
      d = way;
    curvature = 0;
    VectorXd step = (p - stride * d).cwiseMax(B.least) - p;  // the near inverse has the length, too
    const bool led = B.dot(free, step) < 0, whole = led && ((p - stride * d).array() >= B.least.array()).all();
    if (!led) step = (p - 1 / B.largest() * free).cwiseMax(B.least) - p;
    const VectorXd change = B.apply(step).col(0);
    const double bend = B.dot(step, change), fall = -B.dot(free, step);
    if (!(bend > 0) || !(fall > 0)) return;  // the step is nothing but rounding
    double length = fall / bend, most = kInfinity;
    for (Index i = 0; i < n; ++i)
      if (step[i] < 0) most = std::min(most, (B.least[i] - p[i]) / step[i]);
    if (whole && length <= most) {
      Bd = -change / stride;
      curvature = bend / (stride * stride);
    }
    if (led) stride *= std::clamp(length, 0.5, 2.0);
    // half of what is best lowers the energy, and so does twice as much: feet that are to let go do
    length = whole || length < 0.5 ? std::min(length, most) : 1.0;
    p = (p + length * step).cwiseMax(B.least);
    z += length * change;
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
  VectorXd p = (start.size() == n ? start : overlap.cwiseQuotient(B.local)).cwiseMax(B.least);
  for (Index i = 0; i < n; ++i)
    if (!(B.weight[i] > 0)) p[i] = 0;
  // w by (L9), and the softenings there
  const std::size_t layers = contact.layers.size();
  std::vector<VectorXd> of_part(contact.parts.size());
  result.sunk.resize(layers);
  const auto sink = [&](std::size_t k) {
    if (k >= layers) {
      of_part[k - layers] = part_sinking(contact.parts[k - layers], p).col(0);
      return;
    }
    PressedLayer& of = contact.layers[k];
    result.sunk[k] = options.large_strain ? large_sinking(*of.layer, *of.feet, p, of.softening)
                                          : VectorXd(sinking(*of.layer, *of.feet, p).col(0));
  };
  for (int step = 0;; ++step) {
    end_if_stopped(options.stop);
    ++B.applications;
    parallel_for(layers + of_part.size(), sink);
    MatrixXd sunk = MatrixXd::Zero(n, 1);
    for (const auto* all : {&result.sunk, &of_part})
      for (const VectorXd& of : *all) sunk += of;
    add_pairs(contact, p, sunk);
    if (contact.own.size() > 0) sunk.col(0) += contact.own.cwiseProduct(p);
    const VectorXd z = (sunk.col(0) + contact.interface_compliance * p - overlap).cwiseQuotient(B.local);
    result.apart = z;
    const double before = result.residual;
    result.residual = complementarity(B, p, z);
    // solve_bounded carries its residual along: as it is, it may be a little larger
    if (step == 0) result.first_residual = result.residual;
    const double tolerance = std::max(options.tolerance, options.part_of_first * result.first_residual);
    result.converged = result.residual <= (step > 0 ? 3 : 1) * tolerance;
    if (result.converged || step >= kMaxSteps || B.applications >= options.max_applications) break;
    if (step > 2 && result.residual < 100 * tolerance && result.residual > 0.5 * before) break;  // rounding
    const bool linear = std::all_of(contact.layers.begin(), contact.layers.end(), [](const PressedLayer& of) {
      return of.softening.size() == 0 || of.softening.isZero(0.0);
    });
    // Newton's step squares the error: no need to solve it closer than that
    const double goal =
        linear ? tolerance : std::max(0.3 * tolerance, 0.3 * std::min(0.1, result.residual) * result.residual);
    solve_bounded(B, p, z, goal, options);
  }
  result.active.resize(at(n));
  for (Index i = 0; i < n; ++i) result.active[at(i)] = p[i] > B.least[i] && B.weight[i] > 0;
  result.pressure = std::move(p);
  result.applications = B.applications;
  return result;
}

ActiveRates solve_active(const LayerContact& contact, const std::vector<char>& active, const MatrixXd& overlap_rates,
                         double tolerance, const MatrixXd& start, const StopFlag* stop) {
  constexpr int kMaxSteps = 1000;
  ScaledContact B(contact);
  const Index columns = overlap_rates.cols();
  std::vector<char> asked(active);
  for (Index i = 0; i < overlap_rates.rows(); ++i) asked[at(i)] = active[at(i)] && B.weight[i] > 0;
  const auto mask = [&](MatrixXd& m) {
    for (Index i = 0; i < m.rows(); ++i)
      if (!asked[at(i)]) m.row(i).setZero();
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
  std::optional<Deflation> known;  // where it starts, and parts' soft motions
  if (start.size() > 0 || B.soft.cols() > 0) {
    assert(start.size() == 0 || (start.rows() == r.rows() && start.cols() == columns));
    // the best that can be made of them, columns mixed: it leaves nothing of the residual along them, nor do later
    // steps
    MatrixXd ways(r.rows(), start.cols() + B.soft.cols());
    if (start.size() > 0) ways.leftCols(start.cols()) = start;
    ways.rightCols(B.soft.cols()) = B.soft;
    mask(ways);
    MatrixXd seen = B.apply(ways);
    mask(seen);
    known.emplace(B, std::move(ways), std::move(seen));
    const MatrixXd share = known->shares(r);
    result.pressure = known->known() * share;
    r -= known->seen() * share;
    measure();
  }
  const auto way_on = [&]() -> MatrixXd {
    MatrixXd way = B.way(asked, r);
    if (known) known->conjugate(way);
    return way;
  };
  MatrixXd way = way_on(), d = way;
  VectorXd along(columns);  // the residual's own product with the way
  for (Index c = 0; c < columns; ++c) along[c] = B.dot(r.col(c), way.col(c));
  while ((size.array() > goal.array()).any() && B.applications < kMaxSteps) {
    end_if_stopped(stop);
    MatrixXd Bd = B.apply(d);
    mask(Bd);
    bool moved = false;
    for (Index c = 0; c < columns; ++c) {
      const double curvature = B.dot(d.col(c), Bd.col(c));
      if (size[c] <= goal[c] || !(curvature > 0)) continue;
      const double step = along[c] / curvature;
      moved = moved || step != 0;
      result.pressure.col(c) += step * d.col(c);
      r.col(c) -= step * Bd.col(c);
    }
    if (!moved) break;  // nothing but rounding is left
    way = way_on();
    for (Index c = 0; c < columns; ++c) {
      if (size[c] <= goal[c]) continue;
      size[c] = B.dot(r.col(c), r.col(c));
      const double next = B.dot(r.col(c), way.col(c));
      d.col(c) = way.col(c) + next / along[c] * d.col(c);
      along[c] = next;
    }
  }
  result.converged = (size.array() <= goal.array()).all();
  result.applications = B.applications;
  return result;
}

}  // namespace dea

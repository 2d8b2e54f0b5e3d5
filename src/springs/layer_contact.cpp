#include "src/springs/layer_contact.h"

#include <Eigen/Cholesky>
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

void mask(const std::vector<char>& asked, MatrixXd& m) {
  for (Index i = 0; i < m.rows(); ++i)
    if (!asked[at(i)]) m.row(i).setZero();
}

/// The contact divided by the local compliance: B p = b with B = C/local, b = overlap/local, and the inner product
/// <u, v> = sum of A_i local_i u_i v_i in which B is symmetric. Its eigenvalues are those of law(s)/law(infinity).
struct ScaledContact {
  const LayerContact& contact;
  VectorXd local;   // 1 where there is no layer
  VectorXd weight;  // 0: takes no part
  int applications = 0;
  double stride = 1.0;  // by which the near inverse leads too short
  Nodal soft;           // V: V V^T W is nearly what of B parts do (PartOperator::soft): the largest eigenvalues
  MatrixXd taken;       // X: (1 + V V^T W)^-1 = T T*, T = 1 + V X V^T W, on the feet of `face`
  std::vector<char> face;
  static constexpr std::size_t kOther = 50;  // one foot in so many other than in `face` changes little
  VectorXd least;                            // per foot: the least pressure, 0 or none

  explicit ScaledContact(const LayerContact& c) : contact(c), local(local_compliance(c)) {
    for (const PartUnderFeet& of : contact.parts)
      for (Index i = 0; i < local.size(); ++i) local[i] += of.feet->scale[at(i)];
    weight = contact.area.cwiseProduct(local);
    least = VectorXd::Zero(local.size());
    for (std::size_t i = 0; i < contact.two_sided.size(); ++i)
      if (contact.two_sided[i]) least[static_cast<Index>(i)] = -kInfinity;
    for (Index i = 0; i < local.size(); ++i)
      if (!(local[i] > 0)) local[i] = 1;
    Index motions = 0;
    for (const PartUnderFeet& of : contact.parts) motions += of.part->soft.cols();
    soft.resize(local.size(), motions);
    motions = 0;
    for (const PartUnderFeet& of : contact.parts) {
      soft.middleCols(motions, of.part->soft.cols()) =
          local.cwiseInverse().asDiagonal() * along_forces(*of.feet, of.part->soft);
      motions += of.part->soft.cols();
    }
  }
  /// Where a residual asks pressures to go, of feet that are `asked`; it is zero at all others. With 1 + V V^T W for
  /// what parts do, and T T* its inverse: by T of the near inverse of T*.
  MatrixXd way(const std::vector<char>& asked, const MatrixXd& residual) {
    if (soft.cols() == 0) return near_way(asked, residual);
    look_at(asked);
    MatrixXd way = residual;
    add_soft(asked, taken.transpose(), way);
    way = near_way(asked, way);
    add_soft(asked, taken, way);
    return way;
  }
  /// of += V X V^T W of, of the feet that are `asked`; it is zero at all others.
  void add_soft(const std::vector<char>& asked, const MatrixXd& X, MatrixXd& of) const {
    MatrixXd along = MatrixXd::Zero(soft.cols(), of.cols());
    for (Index i = 0; i < of.rows(); ++i)
      if (asked[at(i)]) along += soft.row(i).transpose() * (weight[i] * of.row(i));
    along = X * along;
    for (Index i = 0; i < of.rows(); ++i)
      if (asked[at(i)]) of.row(i) += soft.row(i) * along;
  }
  MatrixXd near_way(const std::vector<char>& asked, const MatrixXd& residual) const {
    MatrixXd way = residual;
    for (const PressedLayer& of : contact.layers) add_near_inverse(*of.layer, *of.feet, weight, asked, residual, way);
    return way;
  }
  /// Sets `taken` for these feet, if they are not about those of the last time. With G = V^T W V = L L^T and
  /// 1 + L^T L = M M^T: X = L^-T (M^-T - 1) L^-1.
  void look_at(const std::vector<char>& asked) {
    std::size_t count = 0, other = 0;
    for (std::size_t i = 0; i < asked.size(); ++i) {
      count += asked[i];
      other += face.empty() || asked[i] != face[i];
    }
    if (kOther * other <= count) return;
    face = asked;
    const Index n = soft.cols();
    Nodal scaled(static_cast<Index>(count), n);
    Index row = 0;
    for (Index i = 0; i < weight.size(); ++i)
      if (asked[at(i)]) scaled.row(row++) = std::sqrt(weight[i]) * soft.row(i);
    MatrixXd G = MatrixXd::Zero(n, n);
    G.selfadjointView<Eigen::Lower>().rankUpdate(scaled.transpose());
    if (!(G.diagonal().maxCoeff() > 0)) {  // no part is pressed
      taken.setZero(n, n);
      return;
    }
    G.diagonal().array() += 1e-10 * G.diagonal().maxCoeff();
    const Eigen::LLT<MatrixXd> of_G(G);
    const MatrixXd L = of_G.matrixL();
    MatrixXd one = L.transpose() * L;
    one.diagonal().array() += 1;
    const Eigen::LLT<MatrixXd> of_one(one);
    MatrixXd X = of_one.matrixU().solve(MatrixXd::Identity(n, n));
    X.diagonal().array() -= 1;
    of_G.matrixU().solveInPlace(X);
    taken = of_G.matrixL().transpose().solve(X.transpose()).transpose();
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
  double curvature = 0;  // of d; 0: there is none to be conjugate to
  double& stride = B.stride;
  while (!(complementarity(B, p, z) <= goal) && B.applications < options.max_applications) {
    end_if_stopped(options.stop);
    before = face;
    for (Index i = 0; i < n; ++i) {
      face[at(i)] = B.weight[i] > 0 && (p[i] > B.least[i] || z[i] < 0);
      free[i] = face[at(i)] ? z[i] : 0.0;
    }
    const VectorXd way = B.way(face, free).col(0);
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

/// The same problem where parts are among what gives way: a foot whose pressure is cut off moves them all, so that a
/// way that is cut is none any more. The feet that touch are guessed, their pressures found, some of these are less
/// than nothing and some gaps are, and so on (primal-dual active set; Hintermueller, Ito and Kunisch 2003, SIAM J Optim
/// 13:865). It needs no more than some guesses or goes round in circles: then solve_bounded begins at the best.
void solve_by_guesses(ScaledContact& B, VectorXd& p, VectorXd& z, double goal, const LayerContactOptions& options) {
  constexpr int kInVain = 6;     // guesses
  constexpr double kPart = 0.1;  // of the residual, in the norm of what it moves, is left by the next guess
  const Index n = p.size();
  std::vector<char> face(at(static_cast<int>(n)), 0);
  VectorXd best_p = p, best_z = z;
  double best = complementarity(B, p, z);
  bool whole = true;
  for (int in_vain = 0; in_vain < kInVain && best > goal && B.applications < options.max_applications;) {
    // what was cut off moves everything: only where nothing was, gaps tell which feet come to touch
    for (Index i = 0; i < n; ++i) face[at(i)] = B.weight[i] > 0 && (p[i] > B.least[i] || (whole && z[i] < 0));
    const double enough = 0.3 * goal * p.cwiseAbs().maxCoeff();
    MatrixXd r = z, d;
    mask(face, r);
    double along = 0, first = 0;
    while (r.cwiseAbs().maxCoeff() > enough && B.applications < options.max_applications) {
      end_if_stopped(options.stop);
      const MatrixXd way = B.way(face, r);
      const double next = B.dot(r.col(0), way.col(0));
      d = along > 0 ? MatrixXd(way + next / along * d) : way;
      along = next;
      first = std::max(first, along);
      if (along < kPart * kPart * first) break;
      const VectorXd change = B.apply(d).col(0);
      const double bend = B.dot(d.col(0), change);
      if (!(bend > 0) || !(along > 0)) break;  // nothing but rounding is left
      const double length = along / bend;
      p -= length * d.col(0);
      z -= length * change;
      r = z;
      mask(face, r);
    }
    const VectorXd cut = p.cwiseMax(B.least) - p;
    whole = cut.isZero(0.0);
    if (!whole) {
      p += cut;
      z += B.apply(cut).col(0);
    }
    const double now = complementarity(B, p, z);
    if (whole) in_vain = now < 0.9 * best ? 0 : in_vain + 1;
    if (!(now < best)) continue;
    best = now;
    best_p = p;
    best_z = z;
  }
  p = best_p;
  z = best_z;
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
    VectorXd to_solve = z;
    if (B.soft.cols() > 0) solve_by_guesses(B, p, to_solve, goal, options);
    solve_bounded(B, p, std::move(to_solve), goal, options);
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
  // conjugate gradients for all columns in step: a sparse solution of several columns costs little more than one
  ActiveRates result;
  MatrixXd r = B.local.cwiseInverse().asDiagonal() * overlap_rates;
  mask(asked, r);
  VectorXd size(columns), goal(columns);
  const auto measure = [&] {
    for (Index c = 0; c < columns; ++c) size[c] = B.dot(r.col(c), r.col(c));
  };
  measure();
  goal = (tolerance * tolerance * size).cwiseMax(1e-24 * size.maxCoeff());  // a column may be zero
  result.pressure = MatrixXd::Zero(r.rows(), columns);
  MatrixXd known, seen, energy;
  if (start.size() > 0) {
    assert(start.rows() == r.rows() && start.cols() == columns);
    // the best that can be made of it, columns mixed: it leaves nothing of the residual along it
    known = start;
    mask(asked, known);
    seen = B.apply(known);
    mask(asked, seen);
    energy = known.transpose() * B.weight.asDiagonal() * seen;
    const MatrixXd share = solve_least_norm(energy, known.transpose() * B.weight.asDiagonal() * r);
    result.pressure = known * share;
    r -= seen * share;
    measure();
  }
  const auto way_on = [&]() -> MatrixXd {
    MatrixXd way = B.way(asked, r);
    if (known.cols() > 0) way -= known * solve_least_norm(energy, seen.transpose() * B.weight.asDiagonal() * way);
    return way;
  };
  MatrixXd way = way_on(), d = way;
  VectorXd along(columns);  // the residual's own product with the way
  for (Index c = 0; c < columns; ++c) along[c] = B.dot(r.col(c), way.col(c));
  while ((size.array() > goal.array()).any() && B.applications < kMaxSteps) {
    end_if_stopped(stop);
    MatrixXd Bd = B.apply(d);
    mask(asked, Bd);
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

#include "src/equilibrium/singular_parts.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "src/base/disjoint_sets.h"
#include "src/base/numbers.h"

namespace dea {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

/// Columns whose values no draw can be unlucky with: the same in every run and on every machine.
MatrixXd scattered(Index n, Index columns) {
  MatrixXd m(n, columns);
  unsigned long long state = 88172645463325252ull;
  for (Index j = 0; j < columns; ++j)
    for (Index i = 0; i < n; ++i) {
      state ^= state << 13;
      state ^= state >> 7;
      state ^= state << 17;
      m(i, j) = static_cast<double>(state >> 11) / 9007199254740992.0 - 0.5;
    }
  return m;
}

double largest_singular_value(const Sparse& K) {
  VectorXd x = scattered(K.cols(), 1).col(0);
  double size = 0.0;
  for (int i = 0; i < 30; ++i) {
    const double norm = x.norm();
    if (!(norm > 0)) return 0.0;
    x /= norm;
    const VectorXd y = K * x;
    size = y.norm();
    x = K.transpose() * y;
  }
  return size;
}

/// Unknowns in groups that no entry couples.
std::vector<std::vector<int>> coupled_groups(const Sparse& K) {
  DisjointSets coupled(at(K.rows()));
  for (int k = 0; k < K.outerSize(); ++k)
    for (Sparse::InnerIterator it(K, k); it; ++it)
      if (it.value() != 0.0) coupled.join(static_cast<int>(it.row()), static_cast<int>(it.col()));
  std::vector<int> number(at(K.rows()), -1);
  std::vector<std::vector<int>> groups;
  for (int i = 0; i < static_cast<int>(number.size()); ++i) {
    int& n = number[at(coupled.root(i))];
    if (n < 0) {
      n = static_cast<int>(groups.size());
      groups.emplace_back();
    }
    groups[at(n)].push_back(i);
  }
  return groups;
}

Sparse part_of(const Sparse& K, const std::vector<int>& group, std::vector<int>& place) {
  for (std::size_t i = 0; i < group.size(); ++i) place[at(group[i])] = static_cast<int>(i);
  std::vector<Eigen::Triplet<double>> entries;
  for (int j : group)
    for (Sparse::InnerIterator it(K, j); it; ++it)
      if (it.value() != 0.0)  // a stored zero may lead out of the group
        entries.emplace_back(place[at(it.row())], place[at(j)], it.value());
  Sparse part(static_cast<Index>(group.size()), static_cast<Index>(group.size()));
  part.setFromTriplets(entries.begin(), entries.end());
  return part;
}

/// Rising singular values: the tail of all of them that `small` accepts, and the first that it does not.
template <class Small>
SingularParts tail_of(const SingularParts& all, const Small& small) {
  Index first = all.sigma.size();
  while (first > 0 && small(all.sigma[first - 1], VectorXd(all.V.col(first - 1)))) --first;
  const Index count = all.sigma.size() - first;
  SingularParts tail;
  tail.sigma = all.sigma.tail(count).reverse();
  tail.U = all.U.rightCols(count).rowwise().reverse();
  tail.V = all.V.rightCols(count).rowwise().reverse();
  tail.largest = all.largest;
  return tail;
}

template <class Small>
SingularParts smallest_of(const Sparse& K, const Small& small, double largest, int dense_limit) {
  const Index n = K.rows();
  if (n <= dense_limit) return tail_of(all_singular_parts(MatrixXd(K)), small);
  Sparse shifted = K;
  // a matrix that is exactly singular has no factors; the shift is far below what counts as flat
  Sparse one(n, n);
  one.setIdentity();
  shifted += (1e-13 * largest) * one;
  shifted.makeCompressed();
  const SparseLuFactors lu(shifted);
  if (lu.found()) {
    for (Index count = 8; count <= n / 4 && count <= 256; count *= 2) {
      MatrixXd V = orthonormal_columns(scattered(n, count));
      VectorXd before = VectorXd::Constant(count, kInfinity);
      SingularParts found;
      bool settled = false;
      for (int i = 0; i < 60 && !settled; ++i) {
        const MatrixXd U = orthonormal_columns(lu.solve_transposed(V));
        V = orthonormal_columns(lu.solve(U));
        if (!V.allFinite()) break;
        const SingularValues svd = thin_svd(K * V);
        found.sigma = svd.sigma.reverse();
        found.U = svd.U.rowwise().reverse();
        V = V * svd.V.rowwise().reverse();
        found.V = V;
        // the lower half has to stand still; the upper half only shields it
        settled = true;
        for (Index k = 0; k < count / 2; ++k)
          settled = settled && std::abs(found.sigma[k] - before[k]) <= 1e-6 * found.sigma[k] + 1e-14 * largest;
        before = found.sigma;
      }
      if (!settled) break;
      Index accepted = 0;
      while (accepted < count / 2 && small(found.sigma[accepted], VectorXd(found.V.col(accepted)))) ++accepted;
      if (accepted == count / 2) continue;  // there may be more of them
      SingularParts result;
      result.sigma = found.sigma.head(accepted);
      result.V = found.V.leftCols(accepted);
      result.U = found.U.leftCols(accepted);
      // where sigma is rounding K v has no direction: take u from the transposed matrix instead
      if (accepted > 0) result.U = orthonormal_columns(lu.solve_transposed(result.V));
      return result;
    }
  }
  return tail_of(all_singular_parts(MatrixXd(K)), small);
}

}  // namespace

SingularParts all_singular_parts(const MatrixXd& K) {
  SingularParts parts;
  if (K.rows() == 0) return parts;
  static_cast<SingularValues&>(parts) = whole_svd(K);
  parts.largest = parts.sigma[0];
  return parts;
}

SingularParts small_singular_parts(const Sparse& K, const std::function<bool(double sigma, const VectorXd& v)>& small,
                                   int dense_limit) {
  SingularParts result;
  result.largest = largest_singular_value(K);
  std::vector<double> sigma;
  std::vector<VectorXd> u, v;
  std::vector<int> place(at(K.rows()), 0);
  for (const std::vector<int>& group : coupled_groups(K)) {
    const auto whole = [&](const VectorXd& part) {
      VectorXd all = VectorXd::Zero(K.rows());
      all(group) = part;
      return all;
    };
    const auto small_here = [&](double s, const VectorXd& part) { return small(s, whole(part)); };
    const SingularParts part = smallest_of(part_of(K, group, place), small_here, result.largest, dense_limit);
    for (Index k = 0; k < part.sigma.size(); ++k) {
      sigma.push_back(part.sigma[k]);
      u.push_back(whole(part.U.col(k)));
      v.push_back(whole(part.V.col(k)));
    }
  }
  const auto count = static_cast<Index>(sigma.size());
  result.sigma = Eigen::Map<const VectorXd>(sigma.data(), count);
  result.U.resize(K.rows(), count);
  result.V.resize(K.rows(), count);
  for (Index k = 0; k < count; ++k) {
    result.U.col(k) = u[at(k)];
    result.V.col(k) = v[at(k)];
  }
  return result;
}

double least_symmetric_eigenvalue(const Sparse& K, const MatrixXd& without, int dense_limit) {
  const Index n = K.rows();
  if (n - without.cols() <= 0) return kNaN;
  const Sparse transposed = K.transpose();
  const Sparse S = 0.5 * (K + transposed);
  if (n <= dense_limit) {
    MatrixXd basis = MatrixXd::Identity(n, n);
    if (without.cols() > 0) basis = orthogonal_basis(without).rightCols(n - without.cols()).eval();
    return symmetric_eigenvalues(basis.transpose() * (S * basis))[0];
  }
  VectorXd radius = VectorXd::Zero(n), diagonal = VectorXd::Zero(n);  // Gershgorin's discs
  for (int k = 0; k < S.outerSize(); ++k)
    for (Sparse::InnerIterator it(S, k); it; ++it)
      (it.row() == it.col() ? diagonal : radius)[it.row()] += it.row() == it.col() ? it.value() : std::abs(it.value());
  const double bottom = (diagonal - radius).minCoeff(), top = (diagonal + radius).maxCoeff();
  const double size = std::max(std::abs(bottom), std::abs(top)), tiny = 1e-10 * size;
  if (!(size > 0)) return 0.0;
  ShiftedFactors factors(S);
  const int negative = factors.eigenvalues_below(-tiny);
  if (negative < 0) return kNaN;
  if (negative == 0) {  // the one next to zero is the least
    VectorXd x = scattered(n, 1).col(0);
    double value = kNaN;
    for (int i = 0; i < 200; ++i) {
      if (without.cols() > 0) x -= without * (without.transpose() * x);
      x.normalize();
      const double before = value;
      value = x.dot(S * x);
      if (std::abs(value - before) <= 1e-6 * std::abs(value)) break;
      x = factors.solve(x);
      if (!x.allFinite()) return kNaN;
    }
    return value;
  }
  double low = std::min(bottom, -tiny), high = -tiny;
  while (high - low > 1e-3 * std::abs(low) + tiny) {
    const double middle = 0.5 * (low + high);
    const int count = factors.eigenvalues_below(middle);
    if (count < 0) return kNaN;
    (count > 0 ? high : low) = middle;
  }
  return high;
}

}  // namespace dea

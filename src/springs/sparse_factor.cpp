#include <febiodea/springs/sparse_factor.h>

#include <cholmod.h>

#include <algorithm>
#include <array>
#include <new>
#include <stdexcept>

#include <febiodea/base/numbers.h>

namespace dea {

namespace {

/// CHOLMOD's work space and objects, freed at the end of a scope.
struct Cholmod {
  cholmod_common common;
  cholmod_sparse* matrix = nullptr;
  cholmod_factor* factor = nullptr;

  Cholmod(const SymmetricPattern& pattern, const std::vector<double>* values) {
    cholmod_start(&common);
    common.print = 0;
    // Simplicial, so no BLAS and no threads: up to 200,000 unknowns it was no slower than supernodal with the reference
    // BLAS. AMD: nested dissection took longer to find than it saved.
    common.supernodal = CHOLMOD_SIMPLICIAL;
    common.nmethods = 1;
    const std::size_t n = at(pattern.size());
    matrix = cholmod_allocate_sparse(n, n, pattern.row.size(), 1, 1, -1, CHOLMOD_REAL, &common);
    check();
    std::copy(pattern.begin.begin(), pattern.begin.end(), static_cast<int*>(matrix->p));
    std::copy(pattern.row.begin(), pattern.row.end(), static_cast<int*>(matrix->i));
    double* x = static_cast<double*>(matrix->x);
    if (values)
      std::copy(values->begin(), values->end(), x);
    else
      std::fill_n(x, pattern.row.size(), 0.0);
  }
  ~Cholmod() {
    cholmod_free_factor(&factor, &common);
    cholmod_free_sparse(&matrix, &common);
    cholmod_finish(&common);
  }
  Cholmod(const Cholmod&) = delete;
  Cholmod& operator=(const Cholmod&) = delete;

  void check() const {
    if (common.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
    if (common.status < CHOLMOD_OK) throw std::runtime_error("sparse factorisation failed");
  }
};

}  // namespace

int SymmetricPattern::find(int i, int j) const {
  const int column = std::min(i, j), last = std::max(i, j);
  return static_cast<int>(std::lower_bound(row.begin() + begin[at(column)], row.begin() + begin[at(column) + 1], last) -
                          row.begin());
}

SymmetricPattern make_pattern(int size, const std::vector<std::array<int, 2>>& pairs) {
  std::vector<std::array<int, 2>> entries;  // column, row
  entries.reserve(at(size) + pairs.size());
  for (int i = 0; i < size; ++i) entries.push_back({i, i});
  for (const auto& pair : pairs) entries.push_back({std::min(pair[0], pair[1]), std::max(pair[0], pair[1])});
  std::sort(entries.begin(), entries.end());
  entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
  SymmetricPattern pattern;
  pattern.begin.assign(at(size) + 1, 0);
  for (const auto& entry : entries) {
    ++pattern.begin[at(entry[0]) + 1];
    pattern.row.push_back(entry[1]);
  }
  for (int i = 0; i < size; ++i) pattern.begin[at(i) + 1] += pattern.begin[at(i)];
  return pattern;
}

std::vector<int> sparse_order(const SymmetricPattern& pattern) {
  Cholmod c(pattern, nullptr);
  c.common.method[0].ordering = CHOLMOD_AMD;
  c.common.postorder = 1;
  c.factor = cholmod_analyze(c.matrix, &c.common);
  c.check();
  const int* unknown = static_cast<const int*>(c.factor->Perm);
  std::vector<int> place(at(pattern.size()));
  for (int k = 0; k < pattern.size(); ++k) place[at(unknown[k])] = k;
  return place;
}

void add_times(const SymmetricPattern& pattern, const std::vector<double>& values, const std::vector<int>& unknowns,
               const Nodal& x, Nodal& product) {
  const Eigen::Index columns = x.cols();
  if (columns == 1) {
    const double* from = x.data();
    double* to = product.data();
    for (const int j : unknowns) {
      const int first = pattern.begin[at(j)], end = pattern.begin[at(j) + 1];
      double sum = values[at(first)] * from[j];
      for (int s = first + 1; s < end; ++s) {
        const int i = pattern.row[at(s)];
        to[i] += values[at(s)] * from[j];
        sum += values[at(s)] * from[i];
      }
      to[j] += sum;
    }
    return;
  }
  for (const int j : unknowns)
    for (int s = pattern.begin[at(j)]; s < pattern.begin[at(j) + 1]; ++s) {
      const int i = pattern.row[at(s)];
      const double a = values[at(s)];
      for (Eigen::Index c = 0; c < columns; ++c) {
        product(i, c) += a * x(j, c);
        if (i != j) product(j, c) += a * x(i, c);
      }
    }
}

SparseFactor factorise(const SymmetricPattern& pattern, const std::vector<double>& values) {
  Cholmod c(pattern, &values);
  c.common.method[0].ordering = CHOLMOD_NATURAL;
  c.common.postorder = 0;
  c.common.final_ll = 1;
  c.factor = cholmod_analyze(c.matrix, &c.common);
  c.check();
  cholmod_factorize(c.matrix, c.factor, &c.common);
  c.check();
  if (c.common.status != CHOLMOD_OK) throw std::runtime_error("sparse factorisation: not positive definite");
  cholmod_change_factor(CHOLMOD_REAL, 1, 0, 1, 1, c.factor, &c.common);
  c.check();
  const int *begin = static_cast<const int*>(c.factor->p), *row = static_cast<const int*>(c.factor->i),
            *count = static_cast<const int*>(c.factor->nz);
  const double* value = static_cast<const double*>(c.factor->x);
  SparseFactor factor;
  factor.begin.push_back(0);
  for (int j = 0; j < pattern.size(); ++j) {
    factor.row.insert(factor.row.end(), row + begin[j], row + begin[j] + count[j]);
    factor.value.insert(factor.value.end(), value + begin[j], value + begin[j] + count[j]);
    factor.begin.push_back(static_cast<int>(factor.row.size()));
  }
  return factor;
}

std::vector<int> columns_for(const SparseFactor& factor, const std::vector<int>& unknowns) {
  std::vector<char> marked(at(factor.size()), 0);
  std::vector<int> columns;
  for (int j : unknowns)
    while (!marked[at(j)]) {  // up the elimination tree: a column's first row below the diagonal is its parent
      marked[at(j)] = 1;
      const int first = factor.begin[at(j)] + 1;
      if (first >= factor.begin[at(j) + 1]) break;
      j = factor.row[at(first)];
    }
  for (int j = 0; j < factor.size(); ++j)
    if (marked[at(j)]) columns.push_back(j);
  return columns;
}

namespace {

/// Count: columns of b, few enough for the processor's registers.
template <int Count>
void solve_in_place(const SparseFactor& L, const std::vector<int>& columns, double* b) {
  const int* row = L.row.data();
  const double* value = L.value.data();
  for (const int j : columns) {
    const int first = L.begin[at(j)], end = L.begin[at(j) + 1];
    double x[Count];
    for (int c = 0; c < Count; ++c)
      b[static_cast<std::ptrdiff_t>(j) * Count + c] = x[c] =
          b[static_cast<std::ptrdiff_t>(j) * Count + c] / value[first];
    for (int s = first + 1; s < end; ++s) {
      double* y = b + static_cast<std::ptrdiff_t>(row[s]) * Count;
      for (int c = 0; c < Count; ++c) y[c] -= value[s] * x[c];
    }
  }
  for (auto j = columns.rbegin(); j != columns.rend(); ++j) {
    const int first = L.begin[at(*j)], end = L.begin[at(*j) + 1];
    double x[Count];
    for (int c = 0; c < Count; ++c) x[c] = b[static_cast<std::ptrdiff_t>(*j) * Count + c];
    for (int s = first + 1; s < end; ++s) {
      const double* y = b + static_cast<std::ptrdiff_t>(row[s]) * Count;
      for (int c = 0; c < Count; ++c) x[c] -= value[s] * y[c];
    }
    for (int c = 0; c < Count; ++c) b[static_cast<std::ptrdiff_t>(*j) * Count + c] = x[c] / value[first];
  }
}

}  // namespace

void solve(const SparseFactor& factor, const std::vector<int>& columns, Nodal& b) {
  constexpr std::array kSolve = {solve_in_place<1>, solve_in_place<2>, solve_in_place<3>,
                                 solve_in_place<4>, solve_in_place<5>, solve_in_place<6>};
  if (b.cols() > 0 && at(b.cols()) <= kSolve.size()) return kSolve[at(b.cols()) - 1](factor, columns, b.data());
  for (Eigen::Index c = 0; c < b.cols(); ++c) {
    Nodal one = b.col(c);
    solve_in_place<1>(factor, columns, one.data());
    b.col(c) = one;
  }
}

}  // namespace dea

#include "src/springs/sparse_factor.h"

#include <cholmod.h>

#include <algorithm>
#include <array>
#include <new>
#include <stdexcept>

#include "src/base/numbers.h"

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

namespace {

/// A column of L: its rows and values, the diagonal first.
struct Entries {
  const int* row;
  const double* value;
  int count;
};

/// How many columns from j on make a panel: each leads to the next, so that the rows of all are among those of the last
/// one, and no more than a quarter of what is kept are zeros. `unknown`: of each column, one behind the other in a
/// panel. None goes on over column `ends`.
int panel_width(const std::vector<Entries>& columns, const std::vector<int>& parent, const std::vector<int>& unknown,
                int ends, int j) {
  int width = 1, kept = columns[at(j)].count, best = 1;
  while (width < SparseFactor::kWidest && parent[at(j + width - 1)] == j + width && j + width != ends &&
         unknown[at(j + width)] == unknown[at(j)] + width) {
    const int last = columns[at(j + width)].count;
    kept += last;
    ++width;
    const int stored = width * (width + 1) / 2 + width * (last - 1);
    if (4 * (stored - kept) <= stored) best = width;
  }
  return best;
}

void add_panel(const std::vector<Entries>& columns, int first, int width, SparseFactor& factor) {
  const Entries& last = columns[at(first + width - 1)];
  SparseFactor::Panel panel{first, width, static_cast<int>(factor.row.size()), last.count - 1,
                            static_cast<std::ptrdiff_t>(factor.value.size())};
  factor.row.insert(factor.row.end(), last.row + 1, last.row + last.count);
  factor.value.resize(factor.value.size() + at(width) * at(width + panel.rows), 0.0);
  double* value = factor.value.data() + panel.value;
  for (int c = 0; c < width; ++c) {
    const Entries& column = columns[at(first + c)];
    int below = 0;  // of the panel's rows
    for (int s = 0; s < column.count; ++s) {
      const int own = column.row[s] - first;
      if (own >= width)
        while (last.row[1 + below] != column.row[s]) ++below;
      value[(own < width ? own : width + below) * width + c] = own == c ? 1 / column.value[s] : column.value[s];
    }
    factor.panel_of.push_back(static_cast<int>(factor.panels.size()));
  }
  factor.panels.push_back(panel);
}

/// `unknown`: of each row and column of the pattern; those from `others` on are eliminated last.
SparseFactor factor_of(const SymmetricPattern& pattern, const std::vector<double>& values,
                       const std::vector<int>& unknown, int others) {
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
  std::vector<Entries> columns;
  std::vector<int> parent;
  for (int j = 0; j < pattern.size(); ++j) columns.push_back({row + begin[j], value + begin[j], count[j]});
  for (const Entries& column : columns) parent.push_back(column.count > 1 ? column.row[1] : -1);
  SparseFactor factor;
  for (int j = 0; j < pattern.size(); j += factor.panels.back().width)
    add_panel(columns, j, panel_width(columns, parent, unknown, others, j), factor);
  const std::vector<int> panels = std::move(factor.panel_of);
  factor.panel_of.resize(panels.size());
  factor.parent.resize(panels.size());
  for (std::size_t j = 0; j < panels.size(); ++j) {
    factor.panel_of[at(unknown[j])] = panels[j];
    factor.parent[at(unknown[j])] = parent[j] < 0 ? -1 : unknown[at(parent[j])];
  }
  for (SparseFactor::Panel& panel : factor.panels) panel.first = unknown[at(panel.first)];
  for (int& r : factor.row) r = unknown[at(r)];
  return factor;
}

}  // namespace

SparseFactor factorise(const SymmetricPattern& pattern, const std::vector<double>& values,
                       const std::vector<char>& last) {
  const int n = pattern.size();
  std::vector<int> unknown, place(at(n));  // of each column, and back
  for (const char behind : {0, 1})
    for (int v = 0; v < n; ++v)
      if ((last.empty() ? 0 : last[at(v)]) == behind) {
        place[at(v)] = static_cast<int>(unknown.size());
        unknown.push_back(v);
      }
  const int others = n - static_cast<int>(std::count(last.begin(), last.end(), 1));
  if (!std::is_sorted(unknown.begin(), unknown.end())) {
    std::vector<std::array<int, 2>> pairs;
    for (int j = 0; j < n; ++j)
      for (int s = pattern.begin[at(j)]; s < pattern.begin[at(j) + 1]; ++s)
        pairs.push_back({place[at(j)], place[at(pattern.row[at(s)])]});
    const SymmetricPattern ordered = make_pattern(n, pairs);
    std::vector<double> moved(values.size());
    for (std::size_t s = 0; s < pairs.size(); ++s) moved[at(ordered.find(pairs[s][0], pairs[s][1]))] = values[s];
    return factor_of(ordered, moved, unknown, others);
  }
  return factor_of(pattern, values, unknown, others);
}

std::vector<int> columns_for(const SparseFactor& factor, const std::vector<int>& unknowns) {
  std::vector<char> marked(at(factor.size()), 0);
  std::vector<int> columns;
  for (int j : unknowns)
    for (; j >= 0 && !marked[at(j)]; j = factor.parent[at(j)]) marked[at(j)] = 1;  // up the elimination tree
  for (int j = 0; j < factor.size(); ++j)
    if (marked[at(j)]) columns.push_back(j);
  return columns;
}

namespace {

/// Width: of the panel. Count: columns of b. Both few enough for the processor's registers.
template <int Width, int Count>
void down(const SparseFactor& L, const SparseFactor::Panel& panel, double* b) {
  const double* value = L.value.data() + panel.value;
  double* own = b + static_cast<std::ptrdiff_t>(panel.first) * Count;
  double x[Width][Count];
  bool any = false;
  for (int i = 0; i < Width * Count; ++i) any = any || own[i] != 0.0;
  if (!any) return;  // no right side leads here
  for (int c = 0; c < Width; ++c, value += Width)
    for (int k = 0; k < Count; ++k) {
      double sum = own[c * Count + k];
      for (int d = 0; d < c; ++d) sum -= value[d] * x[d][k];
      own[c * Count + k] = x[c][k] = sum * value[c];
    }
  const int* row = L.row.data() + panel.row;
  for (int i = 0; i < panel.rows; ++i, value += Width) {
    double* y = b + static_cast<std::ptrdiff_t>(row[i]) * Count;
    for (int k = 0; k < Count; ++k) {
      double sum = value[0] * x[0][k];
      for (int c = 1; c < Width; ++c) sum += value[c] * x[c][k];
      y[k] -= sum;
    }
  }
}

template <int Width, int Count>
void up(const SparseFactor& L, const SparseFactor::Panel& panel, double* b) {
  const double *diagonal = L.value.data() + panel.value, *value = diagonal + Width * Width;
  double* own = b + static_cast<std::ptrdiff_t>(panel.first) * Count;
  double x[Width][Count];
  for (int c = 0; c < Width; ++c)
    for (int k = 0; k < Count; ++k) x[c][k] = own[c * Count + k];
  const int* row = L.row.data() + panel.row;
  for (int i = 0; i < panel.rows; ++i, value += Width) {
    const double* y = b + static_cast<std::ptrdiff_t>(row[i]) * Count;
    for (int c = 0; c < Width; ++c)
      for (int k = 0; k < Count; ++k) x[c][k] -= value[c] * y[k];
  }
  for (int c = Width - 1; c >= 0; --c)
    for (int k = 0; k < Count; ++k) {
      double sum = x[c][k];
      for (int d = c + 1; d < Width; ++d) sum -= diagonal[d * Width + c] * x[d][k];
      own[c * Count + k] = x[c][k] = sum * diagonal[c * Width + c];
    }
}

/// The panels of these columns, one behind the other.
template <int Count, class Column>
void solve_panels(const SparseFactor& L, Column column, Column end, bool downwards, double* b) {
  static_assert(SparseFactor::kWidest == 4);
  constexpr std::array kDown = {down<1, Count>, down<2, Count>, down<3, Count>, down<4, Count>};
  constexpr std::array kUp = {up<1, Count>, up<2, Count>, up<3, Count>, up<4, Count>};
  int done = -1;
  for (; column != end; ++column) {  // in order, so those of a panel come one behind the other
    const int p = L.panel_of[at(*column)];
    if (p == done) continue;
    done = p;
    const SparseFactor::Panel& panel = L.panels[at(p)];
    (downwards ? kDown : kUp)[at(panel.width - 1)](L, panel, b);
  }
}

struct Halves {
  bool down, up;
};

template <int Count>
void solve_in_place(const SparseFactor& L, const std::vector<int>& columns, Halves halves, double* b) {
  if (halves.down) solve_panels<Count>(L, columns.begin(), columns.end(), true, b);
  if (halves.up) solve_panels<Count>(L, columns.rbegin(), columns.rend(), false, b);
}

void solve_halves(const SparseFactor& factor, const std::vector<int>& columns, Halves halves, Nodal& b) {
  constexpr std::array kSolve = {solve_in_place<1>, solve_in_place<2>, solve_in_place<3>,
                                 solve_in_place<4>, solve_in_place<5>, solve_in_place<6>};
  if (b.cols() > 0 && at(b.cols()) <= kSolve.size()) return kSolve[at(b.cols()) - 1](factor, columns, halves, b.data());
  for (Eigen::Index c = 0; c < b.cols(); ++c) {
    Nodal one = b.col(c);
    solve_in_place<1>(factor, columns, halves, one.data());
    b.col(c) = one;
  }
}

}  // namespace

void solve(const SparseFactor& factor, const std::vector<int>& columns, Nodal& b) {
  solve_halves(factor, columns, {true, true}, b);
}
void solve_down(const SparseFactor& factor, const std::vector<int>& columns, Nodal& b) {
  solve_halves(factor, columns, {true, false}, b);
}
void solve_up(const SparseFactor& factor, const std::vector<int>& columns, Nodal& b) {
  solve_halves(factor, columns, {false, true}, b);
}

}  // namespace dea

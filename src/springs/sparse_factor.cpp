#include "src/springs/sparse_factor.h"

#include <cholmod.h>

#include <algorithm>
#include <array>
#include <cmath>
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

  explicit Cholmod(const SymmetricPattern& pattern) {
    cholmod_start(&common);
    common.print = 0;
    // Simplicial: its other module is not free for all. AMD: nested dissection took longer to find than it saved.
    common.supernodal = CHOLMOD_SIMPLICIAL;
    common.nmethods = 1;
    const std::size_t n = at(pattern.size());
    matrix = cholmod_allocate_sparse(n, n, pattern.row.size(), 1, 1, -1, CHOLMOD_PATTERN, &common);
    check();
    std::copy(pattern.begin.begin(), pattern.begin.end(), static_cast<int*>(matrix->p));
    std::copy(pattern.row.begin(), pattern.row.end(), static_cast<int*>(matrix->i));
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
    if (common.status < CHOLMOD_OK) throw std::runtime_error("no order of the unknowns was found");
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
  Cholmod c(pattern);
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

using Rows = std::vector<std::vector<int>>;

/// Of each column of L the rows below the diagonal, ascending: those of A and those of the columns that lead to it.
Rows rows_of_factor(const SymmetricPattern& pattern) {
  const int n = pattern.size();
  Rows rows(at(n));
  std::vector<int> child(at(n), -1), sibling(at(n), -1), seen(at(n), -1), more;
  for (int j = 0; j < n; ++j) {
    int longest = child[at(j)];
    for (int c = longest; c >= 0; c = sibling[at(c)])
      if (rows[at(c)].size() > rows[at(longest)].size()) longest = c;
    std::vector<int>& own = rows[at(j)];
    if (longest >= 0) own.assign(rows[at(longest)].begin() + 1, rows[at(longest)].end());
    seen[at(j)] = j;
    for (const int i : own) seen[at(i)] = j;
    more.clear();
    const auto add = [&](int i) {
      if (seen[at(i)] != j) more.push_back(i);
      seen[at(i)] = j;
    };
    for (int s = pattern.begin[at(j)]; s < pattern.begin[at(j) + 1]; ++s) add(pattern.row[at(s)]);
    for (int c = child[at(j)]; c >= 0; c = sibling[at(c)])
      for (const int i : rows[at(c)]) add(i);
    std::sort(more.begin(), more.end());
    const auto middle = own.insert(own.end(), more.begin(), more.end());
    std::inplace_merge(own.begin(), middle, own.end());
    if (own.empty()) continue;
    sibling[at(j)] = child[at(own.front())];
    child[at(own.front())] = j;
  }
  return rows;
}

/// How many columns from j on make a panel: each leads to the next, so that the rows of all are among those of the last
/// one, and no more than a quarter of what is kept are zeros. `unknown`: of each column, one behind the other in a
/// panel. None goes on over column `ends`.
int panel_width(const Rows& rows, const std::vector<int>& unknown, int ends, int j) {
  const auto count = [&](int column) { return static_cast<int>(rows[at(column)].size()) + 1; };
  int width = 1, kept = count(j), best = 1;
  while (width < SparseFactor::kWidest && count(j + width - 1) > 1 && rows[at(j + width - 1)].front() == j + width &&
         j + width != ends && unknown[at(j + width)] == unknown[at(j)] + width) {
    const int last = count(j + width);
    kept += last;
    ++width;
    const int stored = width * (width + 1) / 2 + width * (last - 1);
    if (4 * (stored - kept) <= stored) best = width;
  }
  return best;
}

/// Room for the values of these columns, all zero.
void add_panel(const Rows& rows, int first, int width, SparseFactor& factor) {
  const std::vector<int>& last = rows[at(first + width - 1)];
  const int below = static_cast<int>(last.size());
  factor.panel_of.insert(factor.panel_of.end(), at(width), static_cast<int>(factor.panels.size()));
  factor.panels.push_back(
      {first, width, static_cast<int>(factor.row.size()), below, static_cast<std::ptrdiff_t>(factor.value.size())});
  factor.row.insert(factor.row.end(), last.begin(), last.end());
  factor.value.resize(factor.value.size() + at(width) * at(width + below), 0.0);
}

/// Takes from a panel what an earlier one, of this width, accounts for: its rows from `begin` on, of which those up to
/// `end` are the panel's own columns. `place`: of a row in the panel.
template <int Width>
void subtract(const SparseFactor& L, const SparseFactor::Panel& from, int begin, int end, const std::vector<int>& place,
              const SparseFactor::Panel& panel, double* value) {
  const int* row = L.row.data() + from.row;
  const double* below = L.value.data() + from.value + Width * Width;
  for (int i = begin; i < from.rows; ++i) {
    double* to = value + static_cast<std::ptrdiff_t>(place[at(row[i])]) * panel.width;
    const double* x = below + static_cast<std::ptrdiff_t>(i) * Width;
    for (int j = begin; j < end && j <= i; ++j) {
      const double* y = below + static_cast<std::ptrdiff_t>(j) * Width;
      double sum = x[0] * y[0];
      for (int c = 1; c < Width; ++c) sum += x[c] * y[c];
      to[row[j] - panel.first] -= sum;
    }
  }
}

/// A panel's own columns, once the earlier ones are taken from it.
void factorise_panel(const SparseFactor::Panel& panel, double* value) {
  const int width = panel.width, rows = width + panel.rows;
  for (int c = 0; c < width; ++c) {
    const double* own = value + static_cast<std::ptrdiff_t>(c) * width;
    double diagonal = own[c];
    for (int d = 0; d < c; ++d) diagonal -= own[d] * own[d];
    if (!(diagonal > 0)) throw std::runtime_error("sparse factorisation: not positive definite");
    const double inverse = 1 / std::sqrt(diagonal);
    for (int i = c + 1; i < rows; ++i) {
      double* x = value + static_cast<std::ptrdiff_t>(i) * width;
      double sum = x[c];
      for (int d = 0; d < c; ++d) sum -= x[d] * own[d];
      x[c] = sum * inverse;
    }
    value[static_cast<std::ptrdiff_t>(c) * width + c] = inverse;
  }
}

/// The values of L, panel by panel: each waits for the panels that have rows among its columns.
void fill_panels(const SymmetricPattern& pattern, const std::vector<double>& values, SparseFactor& factor) {
  static_assert(SparseFactor::kWidest == 4);
  constexpr std::array kSubtract = {subtract<1>, subtract<2>, subtract<3>, subtract<4>};
  const std::size_t count = factor.panels.size();
  std::vector<int> first(count, -1), next(count, -1), done(count, 0), place(at(pattern.size()), 0);
  const auto wait = [&](int p) {  // for the panel of its next row
    const SparseFactor::Panel& panel = factor.panels[at(p)];
    if (done[at(p)] == panel.rows) return;
    const std::size_t at_panel = at(factor.panel_of[at(factor.row[at(panel.row + done[at(p)])])]);
    next[at(p)] = first[at_panel];
    first[at_panel] = p;
  };
  for (int p = 0; p < static_cast<int>(count); ++p) {
    const SparseFactor::Panel& panel = factor.panels[at(p)];
    double* value = factor.value.data() + panel.value;
    for (int k = 0; k < panel.width; ++k) place[at(panel.first + k)] = k;
    for (int k = 0; k < panel.rows; ++k) place[at(factor.row[at(panel.row + k)])] = panel.width + k;
    for (int c = 0; c < panel.width; ++c)
      for (int s = pattern.begin[at(panel.first + c)]; s < pattern.begin[at(panel.first + c) + 1]; ++s)
        value[static_cast<std::ptrdiff_t>(place[at(pattern.row[at(s)])]) * panel.width + c] = values[at(s)];
    for (int q = first[at(p)], following; q >= 0; q = following) {
      following = next[at(q)];
      const SparseFactor::Panel& from = factor.panels[at(q)];
      int end = done[at(q)];
      while (end < from.rows && factor.row[at(from.row + end)] < panel.first + panel.width) ++end;
      kSubtract[at(from.width - 1)](factor, from, done[at(q)], end, place, panel, value);
      done[at(q)] = end;
      wait(q);
    }
    factorise_panel(panel, value);
    wait(p);
  }
}

/// `unknown`: of each row and column of the pattern; those from `others` on are eliminated last.
SparseFactor factor_of(const SymmetricPattern& pattern, const std::vector<double>& values,
                       const std::vector<int>& unknown, int others) {
  const Rows rows = rows_of_factor(pattern);
  SparseFactor factor;
  for (int j = 0; j < pattern.size(); j += factor.panels.back().width)
    add_panel(rows, j, panel_width(rows, unknown, others, j), factor);
  fill_panels(pattern, values, factor);
  const std::vector<int> panels = std::move(factor.panel_of);
  factor.panel_of.resize(panels.size());
  factor.parent.resize(panels.size());
  for (std::size_t j = 0; j < panels.size(); ++j) {
    factor.panel_of[at(unknown[j])] = panels[j];
    factor.parent[at(unknown[j])] = rows[j].empty() ? -1 : unknown[at(rows[j].front())];
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
  // from the last one, so that memory is read one way from panel to panel: large factors take half the time
  value += static_cast<std::ptrdiff_t>(panel.rows) * Width;
  for (int i = panel.rows - 1; i >= 0; --i) {
    value -= Width;
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
  const auto most = static_cast<Eigen::Index>(kSolve.size());
  if (b.cols() > 0 && b.cols() <= most) return kSolve[at(b.cols()) - 1](factor, columns, halves, b.data());
  for (Eigen::Index c = 0; c < b.cols(); c += most) {
    const Eigen::Index count = std::min(most, b.cols() - c);
    Nodal some = b.middleCols(c, count);
    kSolve[at(count) - 1](factor, columns, halves, some.data());
    b.middleCols(c, count) = some;
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

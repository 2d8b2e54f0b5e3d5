// Sparse factors against the same matrices as dense ones.
#include "src/springs/sparse_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "tests/analytic/linear_systems.h"

namespace dea::sparse_factor_test {

using Eigen::MatrixXd;

/// A grid of m x n unknowns, each with its neighbours also across one diagonal, as on a mesh of triangles: neither even
/// nor diagonally dominant by much. Numbers as in `place`, or row by row.
struct Grid {
  int m, n;
  SymmetricPattern pattern;
  std::vector<double> values;
  MatrixXd dense;

  Grid(int columns, int rows, const std::vector<int>& place = {}) : m(columns), n(rows) {
    const auto number = [&](int i, int j) {
      const int k = i + m * j;
      return place.empty() ? k : place[static_cast<std::size_t>(k)];
    };
    std::vector<std::array<int, 2>> pairs;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < m; ++i) {
        if (i + 1 < m) pairs.push_back({number(i, j), number(i + 1, j)});
        if (j + 1 < n) pairs.push_back({number(i, j + 1), number(i, j)});
        if (i + 1 < m && j + 1 < n) pairs.push_back({number(i, j), number(i + 1, j + 1)});
      }
    pairs.push_back(pairs.front());  // said twice, there once
    pattern = make_pattern(m * n, pairs);
    dense = MatrixXd::Zero(m * n, m * n);
    values.assign(static_cast<std::size_t>(pattern.entries()), 0.0);
    for (int i = 0; i < m * n; ++i) add(i, i, 0.1);
    for (std::size_t k = 0; k + 1 < pairs.size(); ++k) {  // springs between unknowns
      const double stiffness = 1 + 0.8 * std::sin(7.0 * static_cast<double>(k));
      add(pairs[k][0], pairs[k][1], -stiffness);
      for (const int i : pairs[k]) add(i, i, stiffness);
    }
  }
  void add(int i, int j, double value) {
    values[static_cast<std::size_t>(pattern.find(i, j))] += value;
    dense(i, j) += value;
    if (i != j) dense(j, i) += value;
  }
};

/// `columns` right sides that are zero but at `unknowns`.
Nodal right_sides(int size, const std::vector<int>& unknowns, int columns) {
  Nodal b = Nodal::Zero(size, columns);
  for (const int i : unknowns)
    for (int c = 0; c < columns; ++c) b(i, c) = std::sin(3.0 * i + c) + 0.1 * c;
  return b;
}

std::vector<int> all_of(int size) {
  std::vector<int> numbers;
  for (int i = 0; i < size; ++i) numbers.push_back(i);
  return numbers;
}

TEST(SparseFactor, PatternHasTheLowerTriangle) {
  const SymmetricPattern pattern = make_pattern(4, {{2, 0}, {0, 2}, {3, 1}, {3, 2}});
  EXPECT_EQ(pattern.begin, (std::vector<int>{0, 2, 4, 6, 7}));
  EXPECT_EQ(pattern.row, (std::vector<int>{0, 2, 1, 3, 2, 3, 3}));
  EXPECT_EQ(pattern.find(0, 2), 1);
  EXPECT_EQ(pattern.find(2, 0), 1);
  EXPECT_EQ(pattern.find(2, 2), 4);
}

// Cholesky's error is a small multiple of rounding times the condition, here below 220 (eigenvalues up to 22 by the
// sums of rows, least 0.1).
TEST(SparseFactor, SolvesAsTheDenseMatrixDoes) {
  for (const int columns : {1, 2, 3, 4, 6, 7, 9, 20}) {
    const Grid grid(9, 7);
    const int size = grid.pattern.size();
    const SparseFactor factor = factorise(grid.pattern, grid.values);
    ASSERT_EQ(factor.size(), size);
    const std::vector<int> every = columns_for(factor, all_of(size));
    EXPECT_EQ(every, all_of(size));
    const Nodal b = right_sides(size, every, columns);
    Nodal x = b;
    solve(factor, every, x);
    const MatrixXd exact = analytic::solve_dense(grid.dense, b);
    EXPECT_LT((x - exact).norm(), 1e-12 * exact.norm()) << columns;
  }
}

TEST(SparseFactor, IsTheFactor) {
  const Grid grid(8, 5);
  const SparseFactor factor = factorise(grid.pattern, grid.values);
  MatrixXd lower = MatrixXd::Zero(factor.size(), factor.size());
  int columns = 0;
  for (const SparseFactor::Panel& panel : factor.panels) {
    EXPECT_EQ(panel.first, columns);
    ASSERT_LE(panel.width, SparseFactor::kWidest);
    columns += panel.width;
    const double* value = factor.value.data() + panel.value;
    for (int i = 0; i < panel.width + panel.rows; ++i)
      for (int c = 0; c < panel.width; ++c, ++value) {
        const int row =
            i < panel.width ? panel.first + i : factor.row[static_cast<std::size_t>(panel.row + i - panel.width)];
        lower(row, panel.first + c) = i == c ? 1 / *value : *value;
      }
  }
  EXPECT_EQ(columns, factor.size());
  EXPECT_TRUE(lower.isLowerTriangular(0.0));
  EXPECT_LT((lower * lower.transpose() - grid.dense).norm(), 1e-14 * grid.dense.norm());
}

// Right sides that are zero but at some unknowns, solutions wanted there only: the columns those lead to give the same
// as all, and they are fewer.
TEST(SparseFactor, FewerColumnsGiveTheSameAtTheirUnknowns) {
  const Grid by_rows(15, 11);
  const Grid grid(15, 11, sparse_order(by_rows.pattern));
  const int size = grid.pattern.size();
  const SparseFactor factor = factorise(grid.pattern, grid.values);
  const std::vector<int> every = all_of(size);
  for (const std::vector<int>& unknowns : {std::vector<int>{3}, {0, 1, 2, 30, 31}, {77, 5, 40}, {size - 1}, {}}) {
    const std::vector<int> columns = columns_for(factor, unknowns);
    EXPECT_TRUE(std::is_sorted(columns.begin(), columns.end()));
    EXPECT_EQ(std::set<int>(columns.begin(), columns.end()).size(), columns.size());
    EXPECT_LT(columns.size(), every.size());
    for (const int i : unknowns) EXPECT_TRUE(std::binary_search(columns.begin(), columns.end(), i)) << i;
    for (const int right : {1, 3, 6}) {
      const Nodal b = right_sides(size, unknowns, right);
      Nodal x = b, all = b;
      solve(factor, columns, x);
      solve(factor, every, all);
      const MatrixXd exact = analytic::solve_dense(grid.dense, b);
      for (const int i : unknowns) {
        EXPECT_LT((x.row(i) - all.row(i)).norm(), 1e-14 * exact.norm()) << i;
        EXPECT_LT((x.row(i) - exact.row(i)).norm(), 1e-12 * exact.norm()) << i;
      }
    }
  }
}

// Unknowns that are eliminated last, among the others by number: the first half leaves what the others do not account
// for, the second takes them as given.
TEST(SparseFactor, TheLastAreLeftAndTaken) {
  const Grid by_rows(12, 9);
  const Grid grid(12, 9, sparse_order(by_rows.pattern));
  const int size = grid.pattern.size();
  std::vector<char> last(static_cast<std::size_t>(size), 0);
  std::vector<int> inner, outer;
  for (int i = 0; i < size; ++i) (i % 5 == 1 || i > size - 4 ? outer : inner).push_back(i);
  for (const int i : outer) last[static_cast<std::size_t>(i)] = 1;
  const SparseFactor factor = factorise(grid.pattern, grid.values, last);
  std::vector<int> columns = columns_for(factor, inner);
  std::erase_if(columns, [&](int i) { return last[static_cast<std::size_t>(i)] != 0; });
  EXPECT_EQ(columns, inner);
  const MatrixXd ii = grid.dense(inner, inner), ie = grid.dense(inner, outer);
  for (const int right : {1, 3}) {
    const Nodal b = right_sides(size, all_of(size), right);
    Nodal half = b;
    solve_down(factor, inner, half);
    const MatrixXd left =
        MatrixXd(b(outer, Eigen::all)) - ie.transpose() * analytic::solve_dense(ii, b(inner, Eigen::all));
    EXPECT_LT((half(outer, Eigen::all) - left).norm(), 1e-12 * left.norm());
    half(outer, Eigen::all) = b(outer, Eigen::all);
    solve_up(factor, inner, half);
    const MatrixXd exact = analytic::solve_dense(ii, b(inner, Eigen::all) - ie * b(outer, Eigen::all));
    EXPECT_LT((half(inner, Eigen::all) - exact).norm(), 1e-12 * exact.norm());
    EXPECT_EQ(Nodal(half(outer, Eigen::all)), Nodal(b(outer, Eigen::all)));
  }
}

// The order is a permutation, and fills less than row by row; a grid of 40 x 40 by rows has a band of 41.
TEST(SparseFactor, OrderLeavesTheFactorSparse) {
  const Grid by_rows(40, 40);
  const std::vector<int> place = sparse_order(by_rows.pattern);
  std::vector<int> ascending = place;
  std::sort(ascending.begin(), ascending.end());
  EXPECT_EQ(ascending, all_of(1600));
  const Grid ordered(40, 40, place);
  EXPECT_LT(factorise(ordered.pattern, ordered.values).value.size(),
            factorise(by_rows.pattern, by_rows.values).value.size() / 2);
}

TEST(SparseFactor, ProductIsThatOfTheMatrix) {
  const Grid grid(7, 6);
  const int size = grid.pattern.size();
  const std::vector<int> unknowns = {4, 9, 10, 11, 17, 40, 3};
  for (const int columns : {1, 4}) {
    const Nodal x = right_sides(size, unknowns, columns);
    const Nodal before = right_sides(size, all_of(size), columns);
    Nodal product = before;
    add_times(grid.pattern, grid.values, unknowns, x, product);
    const MatrixXd exact = before + grid.dense * x;
    for (const int i : unknowns) EXPECT_LT((product.row(i) - exact.row(i)).norm(), 1e-13 * exact.norm()) << i;
  }
}

TEST(SparseFactor, RefusesWhatIsNotPositiveDefinite) {
  Grid grid(4, 4);
  EXPECT_NO_THROW(factorise(grid.pattern, grid.values));
  grid.add(5, 5, -100);
  EXPECT_THROW(factorise(grid.pattern, grid.values), std::runtime_error);
}

}  // namespace dea::sparse_factor_test

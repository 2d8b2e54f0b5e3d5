// src/springs/sparse_factor.h – symmetric sparse matrices, their Cholesky factors, and solutions where only some
// unknowns matter. The only file that knows CHOLMOD is sparse_factor.cpp.
#pragma once
#include <Eigen/Core>
#include <array>
#include <vector>

namespace dea {

/// Values per unknown, unknowns x columns; a row is contiguous.
using Nodal = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Lower triangle, by columns; in each the rows ascend, so the diagonal comes first.
struct SymmetricPattern {
  std::vector<int> begin, row;
  int size() const { return static_cast<int>(begin.size()) - 1; }
  int entries() const { return static_cast<int>(row.size()); }
  int find(int i, int j) const;  ///< number of the entry of unknowns i, j, which must be there
};
/// With these entries besides the diagonal.
SymmetricPattern make_pattern(int size, const std::vector<std::array<int, 2>>& pairs);
/// An order of the unknowns that leaves the factor sparse: place[i] of unknown i.
std::vector<int> sparse_order(const SymmetricPattern& pattern);

/// Adds A x to `product`, with the values of A in the order of the pattern's entries, for an x that is zero but at
/// `unknowns` and where only these of the product matter.
void add_times(const SymmetricPattern& pattern, const std::vector<double>& values, const std::vector<int>& unknowns,
               const Nodal& x, Nodal& product);

/// A = L L^T in the order of the unknowns as they are. Columns that lead to one another are kept side by side in
/// panels: a row's number is read once for all of a panel. A plain value: safe to use side by side.
struct SparseFactor {
  static constexpr int kWidest = 4;  ///< columns of a panel: as many as stay in the processor's registers
  struct Panel {
    int first = 0, width = 0;  ///< its columns
    int row = 0, rows = 0;     ///< its rows below: where they begin in `row`, how many
    std::ptrdiff_t value = 0;  ///< where its values begin
  };
  std::vector<Panel> panels;  ///< ascending
  std::vector<int> row;
  /// Of each panel: its columns' own rows, then the rows below, each row `width` numbers. On the diagonal 1/L_jj, above
  /// it zero; a few zeros stand in rows below that not all of its columns have.
  std::vector<double> value;
  std::vector<int> panel_of;  ///< per column
  std::vector<int> parent;    ///< per column: the first row below the diagonal (the elimination tree); -1: none
  int size() const { return static_cast<int>(parent.size()); }
};
/// `last`: per unknown, eliminated behind all others, in panels of their own; their columns come out of order. Empty:
/// none. Throws std::runtime_error if A is not positive definite.
SparseFactor factorise(const SymmetricPattern& pattern, const std::vector<double>& values,
                       const std::vector<char>& last = {});

/// The columns of L that take part where right sides are zero but at `unknowns` and solutions are asked for there only:
/// these and what they lead to, ascending.
std::vector<int> columns_for(const SparseFactor& factor, const std::vector<int>& unknowns);
/// Solves A x = b in place, for these columns (columns_for): b is zero elsewhere, and x is right at the unknowns asked
/// for.
void solve(const SparseFactor& factor, const std::vector<int>& columns, Nodal& b);
/// Its two halves, b = L^-1 b and b = L^-T b, without the columns of those eliminated last. Of these the first leaves
/// what of b the others do not account for, b_e - A_ei A_ii^-1 b_i; the second takes them as given:
/// A_ii x_i = L_ii b_i - A_ie b_e.
void solve_down(const SparseFactor& factor, const std::vector<int>& columns, Nodal& b);
void solve_up(const SparseFactor& factor, const std::vector<int>& columns, Nodal& b);

}  // namespace dea

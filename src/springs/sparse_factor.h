// febiodea/springs/sparse_factor.h – symmetric sparse matrices, their Cholesky factors, and solutions where only some
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

/// A = L L^T in the order of the unknowns as they are. A plain value: safe to use side by side.
struct SparseFactor {
  std::vector<int> begin, row;  ///< L by columns, the diagonal first
  std::vector<double> value;
  int size() const { return static_cast<int>(begin.size()) - 1; }
};
/// Throws std::runtime_error if A is not positive definite.
SparseFactor factorise(const SymmetricPattern& pattern, const std::vector<double>& values);

/// The columns of L that take part where right sides are zero but at `unknowns` and solutions are asked for there only:
/// these and what they lead to, ascending.
std::vector<int> columns_for(const SparseFactor& factor, const std::vector<int>& unknowns);
/// Solves A x = b in place, for these columns (columns_for): b is zero elsewhere, and x is right at the unknowns asked
/// for.
void solve(const SparseFactor& factor, const std::vector<int>& columns, Nodal& b);

}  // namespace dea

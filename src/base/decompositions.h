// src/base/decompositions.h – matrices taken apart, by Eigen. Compiled once, in one file: each decomposition costs
// the compiler more than all else in a file that uses it.
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>

namespace dea {

/// Orthonormal columns that span those of m (n x k, k <= n, of full rank): the first k of Householder's Q.
Eigen::MatrixXd orthonormal_columns(const Eigen::MatrixXd& m);

/// Householder's whole Q (n x n): its first k columns span those of m (n x k), the others what is orthogonal to them.
Eigen::MatrixXd orthogonal_basis(const Eigen::MatrixXd& m);

/// Householder's QR with pivoting by columns: m P = Q R, Q square (n x n), R as m (n x k) with zeros below its
/// diagonal. order[i]: the column of m that became column i of m P. rank: values of R's diagonal above `threshold`
/// times its largest.
struct PivotedQr {
  Eigen::MatrixXd Q, R;
  Eigen::VectorXi order;
  Eigen::Index rank = 0;
};
PivotedQr pivoted_qr(const Eigen::MatrixXd& m, double threshold);

/// m = U diag(sigma) V^T, sigma falling, by Jacobi's rotations: exact also in the small ones; 6 ms for 60 columns, 0.2
/// s for 200.
struct SingularValues {
  Eigen::VectorXd sigma;
  Eigen::MatrixXd U, V;
};
/// U and V square.
SingularValues whole_svd(const Eigen::MatrixXd& m);
/// U and V with as many columns as there are singular values.
SingularValues thin_svd(const Eigen::MatrixXd& m);

/// Eigenvalues of a symmetric matrix, rising, and its eigenvectors as columns. Only the lower triangle is read.
struct Eigenvalues {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
Eigenvalues symmetric_eigen(const Eigen::MatrixXd& m);
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& m);
Eigen::Vector3d symmetric_eigenvalues_3(const Eigen::Matrix3d& m);  ///< in closed form: to 1e-8 of the largest

/// x of R x = b, or of R^T x = b: R square; only its upper triangle is read.
Eigen::VectorXd solve_upper(const Eigen::MatrixXd& R, const Eigen::VectorXd& b);
Eigen::VectorXd solve_upper_transposed(const Eigen::MatrixXd& R, const Eigen::VectorXd& b);

/// x of A x = b: A square and regular; A of any shape and rank, the x of least norm among those of least |A x - b|.
Eigen::VectorXd solve_regular(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
Eigen::MatrixXd solve_least_norm(const Eigen::MatrixXd& A, const Eigen::MatrixXd& b);

/// x of A x = b, A sparse, symmetric and positive definite; empty where A is not.
Eigen::VectorXd solve_positive_definite(const Eigen::SparseMatrix<double>& A, const Eigen::VectorXd& b);

/// LU factors of a square sparse matrix. A matrix that is singular to rounding has none: then solving is not allowed.
class SparseLuFactors {
 public:
  explicit SparseLuFactors(const Eigen::SparseMatrix<double>& A);
  ~SparseLuFactors();

  bool found() const;
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;             ///< A x = b, column by column
  Eigen::MatrixXd solve_transposed(const Eigen::MatrixXd& b) const;  ///< A^T x = b

 private:
  struct Factors;
  std::unique_ptr<Factors> factors_;
};

/// L D L^T of a symmetric sparse matrix S less a shift of its diagonal; S needs not be definite. One pattern for all
/// shifts.
class ShiftedFactors {
 public:
  explicit ShiftedFactors(const Eigen::SparseMatrix<double>& S);
  ~ShiftedFactors();

  /// Factorises S - shift. By Sylvester's law as many pivots are negative as eigenvalues lie below the shift: that
  /// number, or -1 where there are no factors.
  int eigenvalues_below(double shift);
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;  ///< (S - last shift) x = b

 private:
  struct Factors;
  std::unique_ptr<Factors> factors_;
};

}  // namespace dea

// tests/analytic/linear_systems.h – what the answers on paper solve, by Eigen. Compiled once, in one file: each
// decomposition costs the compiler more than all else in a test. Not the program's own (base/decompositions.h), for
// these are to be independent of it.
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace dea::analytic {

/// x of A x = b, column by column: A square and regular.
Eigen::MatrixXd solve_dense(const Eigen::MatrixXd& A, const Eigen::MatrixXd& b);
/// The same where A is sparse and symmetric.
Eigen::MatrixXd solve_symmetric(const Eigen::SparseMatrix<double>& A, const Eigen::MatrixXd& b);
/// x of least |A x - b|: A of full rank.
Eigen::VectorXd least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
/// Of a symmetric matrix, rising.
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& A);

}  // namespace dea::analytic

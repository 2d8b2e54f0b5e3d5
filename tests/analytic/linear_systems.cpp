#include "tests/analytic/linear_systems.h"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>

namespace dea::analytic {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

MatrixXd solve_dense(const MatrixXd& A, const MatrixXd& b) { return A.partialPivLu().solve(b); }

MatrixXd solve_symmetric(const Sparse& A, const MatrixXd& b) { return Eigen::SimplicialLDLT<Sparse>(A).solve(b); }

VectorXd least_squares(const MatrixXd& A, const VectorXd& b) { return A.colPivHouseholderQr().solve(b); }

VectorXd eigenvalues(const MatrixXd& A) { return Eigen::SelfAdjointEigenSolver<MatrixXd>(A).eigenvalues(); }

}  // namespace dea::analytic

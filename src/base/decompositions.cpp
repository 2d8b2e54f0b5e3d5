#include "src/base/decompositions.h"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>

namespace dea {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

MatrixXd orthonormal_columns(const MatrixXd& m) {
  const Eigen::HouseholderQR<MatrixXd> qr(m);
  return qr.householderQ() * MatrixXd::Identity(m.rows(), m.cols());
}

MatrixXd orthogonal_basis(const MatrixXd& m) {
  const Eigen::HouseholderQR<MatrixXd> qr(m);
  return qr.householderQ();
}

PivotedQr pivoted_qr(const MatrixXd& m, double threshold) {
  Eigen::ColPivHouseholderQR<MatrixXd> qr;
  qr.setThreshold(threshold);
  qr.compute(m);
  PivotedQr result;
  result.Q = qr.householderQ() * MatrixXd::Identity(m.rows(), m.rows());
  result.R = qr.matrixR().triangularView<Eigen::Upper>();
  result.order = qr.colsPermutation().indices();
  result.rank = qr.rank();
  return result;
}

SingularValues whole_svd(const MatrixXd& m) {
  const Eigen::JacobiSVD<MatrixXd> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {svd.singularValues(), svd.matrixU(), svd.matrixV()};
}

SingularValues thin_svd(const MatrixXd& m) {
  const Eigen::JacobiSVD<MatrixXd> svd(m, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return {svd.singularValues(), svd.matrixU(), svd.matrixV()};
}

Eigenvalues symmetric_eigen(const MatrixXd& m) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(m);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

VectorXd symmetric_eigenvalues(const MatrixXd& m) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(m, Eigen::EigenvaluesOnly).eigenvalues();
}

Eigen::Vector3d symmetric_eigenvalues_3(const Eigen::Matrix3d& m) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>().computeDirect(m, Eigen::EigenvaluesOnly).eigenvalues();
}

VectorXd solve_upper(const MatrixXd& R, const VectorXd& b) { return R.triangularView<Eigen::Upper>().solve(b); }

VectorXd solve_upper_transposed(const MatrixXd& R, const VectorXd& b) {
  return R.transpose().triangularView<Eigen::Lower>().solve(b);
}

VectorXd solve_regular(const MatrixXd& A, const VectorXd& b) { return A.partialPivLu().solve(b); }

MatrixXd solve_least_norm(const MatrixXd& A, const MatrixXd& b) { return A.completeOrthogonalDecomposition().solve(b); }

VectorXd solve_positive_definite(const Sparse& A, const VectorXd& b) {
  const Eigen::SimplicialLDLT<Sparse> factors(A);
  if (factors.info() != Eigen::Success) return {};
  return factors.solve(b);
}

struct SparseLuFactors::Factors {
  mutable Eigen::SparseLU<Sparse> lu;  // solving the transposed system is not const in Eigen
};
SparseLuFactors::SparseLuFactors(const Sparse& A) : factors_(std::make_unique<Factors>()) { factors_->lu.compute(A); }
SparseLuFactors::~SparseLuFactors() = default;
bool SparseLuFactors::found() const { return factors_->lu.info() == Eigen::Success; }
MatrixXd SparseLuFactors::solve(const MatrixXd& b) const { return factors_->lu.solve(b); }
MatrixXd SparseLuFactors::solve_transposed(const MatrixXd& b) const { return factors_->lu.transpose().solve(b); }

struct ShiftedFactors::Factors {
  Sparse S, one;
  Eigen::SimplicialLDLT<Sparse> ldlt;
};
ShiftedFactors::ShiftedFactors(const Sparse& S) : factors_(std::make_unique<Factors>()) {
  factors_->S = S;
  factors_->one.resize(S.rows(), S.cols());
  factors_->one.setIdentity();
  factors_->ldlt.analyzePattern(S + factors_->one);
}
ShiftedFactors::~ShiftedFactors() = default;
int ShiftedFactors::eigenvalues_below(double shift) {
  factors_->ldlt.factorize(factors_->S - shift * factors_->one);
  if (factors_->ldlt.info() != Eigen::Success) return -1;
  return static_cast<int>((factors_->ldlt.vectorD().array() < 0).count());
}
VectorXd ShiftedFactors::solve(const VectorXd& b) const { return factors_->ldlt.solve(b); }

}  // namespace dea

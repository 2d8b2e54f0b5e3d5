// src/equilibrium/singular_parts.h – the directions in which a stiffness is small.
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <functional>

#include "src/base/decompositions.h"

namespace dea {

/// Singular values and vectors of a square matrix: K v = sigma u, K^T u = sigma v. Columns of U, V are orthonormal.
/// Falling if all, rising if the smallest.
struct SingularParts : SingularValues {
  double largest = 0.0;  ///< largest singular value of the matrix (an estimate from below where not all are there)
};

/// All of them, by a dense decomposition: for up to a few hundred unknowns.
SingularParts all_singular_parts(const Eigen::MatrixXd& K);

/// The smallest ones of a sparse matrix, as many as `small` asks for: blocks of inverse iteration until the last
/// `small(sigma, v)` of a block says no. Unknowns that no entry couples are taken apart first; groups of up to
/// `dense_limit` unknowns are decomposed densely. Never fails: where the iteration finds too many, it becomes dense.
SingularParts small_singular_parts(const Eigen::SparseMatrix<double>& K,
                                   const std::function<bool(double sigma, const Eigen::VectorXd& v)>& small,
                                   int dense_limit);

/// Smallest eigenvalue of the symmetric part of K on the complement of the orthonormal columns `without`.
double least_symmetric_eigenvalue(const Eigen::SparseMatrix<double>& K, const Eigen::MatrixXd& without,
                                  int dense_limit);

}  // namespace dea

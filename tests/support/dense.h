#pragma once

#include <Eigen/SparseCore>

#include "geometry/base.h"

/// Dense linear algebra of Eigen for comparisons in tests. It is compiled once, because the
/// decompositions took up to half of the compile time of the files that used them.
namespace flexmorph::testing {

/// Returns the solution x of A x = b by LU factors with partial pivoting, for one column b or
/// several.
MatrixXd solve(const MatrixXd& A, const MatrixXd& b);
/// Returns the solution x of A x = b of a sparse positive definite A by its LDLᵀ factors.
MatrixXd solve(const Eigen::SparseMatrix<double>& A, const MatrixXd& b);
/// Returns the inverse A⁻¹ of a square matrix.
MatrixXd inverse(const MatrixXd& A);
/// Returns the number of pivots of LU factors with full pivoting above `threshold` times the
/// largest.
int rank(const MatrixXd& A, double threshold);
/// Returns the singular values of A, largest first.
VectorXd singular_values(const MatrixXd& A);
/// Returns the eigenvalues of a symmetric matrix in ascending order; only its lower triangle is
/// read.
VectorXd eigenvalues(const MatrixXd& A);

/// Eigenvalues ω² in ascending order and eigenvectors φ (columns, φᵀ M φ = 1) of K φ = ω² M φ.
struct Modes {
  VectorXd values;
  MatrixXd vectors;
};
/// Returns the modes of symmetric matrices K and M, where M is positive definite.
Modes modes(const MatrixXd& K, const MatrixXd& M);

}  // namespace flexmorph::testing
